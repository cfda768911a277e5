//! What examples that time extraction from samples in memory share.

use isostudy_extract::Arrangement;
use isostudy_extract::by_lattice::Lattice;
use isostudy_field::StudyField;

/// The field at all points of the lattice, in storage order.
pub(crate) fn samples(field: &dyn StudyField, lattice: &Lattice) -> Vec<f32> {
    let [x, y, z] = lattice.cells().map(|n| n as usize);
    let (min, h) = (lattice.bounds().min, lattice.spacing());
    let body = lattice.arrangement() == Arrangement::BodyCentred;
    let (nx, ny, nz) = if body { (x + 2, y + 2, 2 * z + 3) } else { (x + 1, y + 1, z + 1) };
    let mut values = vec![0.0; nx * ny * nz];
    for (k, layer) in values.chunks_mut(nx * ny).enumerate() {
        let offset = if body && k % 2 == 0 { -0.5 } else { 0.0 };
        let place = |i: usize| i as f32 + offset;
        let xs: Vec<f32> = (0..nx).map(|i| min.x + place(i) * h).collect();
        let pz = min.z + place(if body { k / 2 } else { k }) * h;
        for (j, row) in layer.chunks_mut(nx).enumerate() {
            field.sample_row(&xs, min.y + place(j) * h, pz, row);
        }
    }
    values
}

/// Time this thread has run, which other work on the machine does not add to.
pub(crate) fn cpu_ms() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").expect("Linux");
    text.split(' ').next().and_then(|ns| ns.parse::<f64>().ok()).expect("a number") / 1e6
}
