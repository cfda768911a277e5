//! Stage times, the most memory used, and a digest of one extraction with the guarded edge collapse.
//! Arguments: arrangement, cells along an axis, threads, field (`asteroid` or `volume`, a grid of samples of it as fine
//! as the lattice).

use glam::Vec3;
use isostudy_extract::by_lattice::{ExtractSettings, Lattice, extract};
use isostudy_extract::{Arrangement, Clustering, Execution};
use isostudy_field::{Asteroid, Beyond, StudyField, VolumeField};
use isostudy_mesh::{Bounds, TriangleMesh};

const BOX: Bounds = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };

/// An asteroid's values at `cells + 1` points along each axis.
fn volume(cells: u32) -> Result<VolumeField, Box<dyn std::error::Error>> {
    let n = cells as usize + 1;
    let step = 2.0 / f64::from(cells);
    let at = |i: usize| (f64::from(i as u32) * step - 1.0) as f32;
    let x: Vec<f32> = (0..n).map(at).collect();
    let mut values = vec![0.0; n * n * n];
    for (i, row) in values.chunks_exact_mut(n).enumerate() {
        Asteroid::default().sample_row(&x, at(i % n), at(i / n), row);
    }
    let steps = [[step, 0.0, 0.0], [0.0, step, 0.0], [0.0, 0.0, step]];
    Ok(VolumeField::try_new([n; 3], values, [-1.0; 3], steps, Beyond::Continued)?)
}

/// Of all positions, normals and triangles, to tell whether two meshes have the same bytes (FNV-1a).
fn digest(mesh: &TriangleMesh) -> u64 {
    let points = mesh.positions.iter().chain(&mesh.normals).flat_map(|p| p.to_array().map(f32::to_bits));
    let words = points.chain(mesh.triangles.iter().copied().flatten());
    words.fold(0xcbf2_9ce4_8422_2325, |hash, word| (hash ^ u64::from(word)).wrapping_mul(0x0100_0000_01b3))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [arrangement, cells, threads, field] = &arguments[..] else {
        return Err("arguments: arrangement, cells, threads, field".into());
    };
    let (cells, threads): (u32, usize) = (cells.parse()?, threads.parse()?);
    let arrangement = Arrangement::ALL.into_iter().find(|a| a.to_string() == *arrangement);
    let arrangement = arrangement.ok_or("no such arrangement")?;
    let field: Box<dyn StudyField> = match field.as_str() {
        "volume" => Box::new(volume(cells)?),
        _ => Box::new(Asteroid::default()),
    };
    let lattice = Lattice::try_new(arrangement, BOX, 2.0 / cells as f32)?;
    let settings = ExtractSettings::default().with_clustering(Clustering::EdgeCollapse);
    let extraction = extract(&*field, &lattice, &settings, &Execution { threads })?;
    let (counts, times) = (extraction.counts, extraction.times);
    let s = |time: std::time::Duration| time.as_secs_f64();
    println!(
        "{arrangement} {cells}: {:.2} s (allocation {:.2}, sampling {:.2}, vertex {:.2}, geometry {:.2}, collapse \
         {:.2}, normals {:.2}); {} triangles of {}, {:016x}",
        s(times.total()),
        s(times.allocation),
        s(times.sampling),
        s(times.vertex),
        s(times.geometry),
        s(times.clustering),
        s(times.normals),
        counts.triangles,
        counts.triangles + counts.discarded_triangles,
        digest(&extraction.mesh)
    );
    let status = std::fs::read_to_string("/proc/self/status")?;
    println!("{}", status.lines().find(|line| line.starts_with("VmHWM")).unwrap_or("no VmHWM"));
    Ok(())
}
