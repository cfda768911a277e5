//! A volume as a file that `isostudy extract --volume` reads, and that can be read again with what it is about.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use super::volume::Volume;

/// A volume in NRRD, in words.
pub(super) fn text(volume: &Volume, method: &str, promise: &str) -> String {
    let Volume { counts: [nx, ny, nz], ref values, origin, steps, isovalue, chunk, fine } = *volume;
    let vector = |[x, y, z]: [f64; 3]| format!("({x:?},{y:?},{z:?})");
    let [x, y, z] = steps.map(vector);
    let mut text = format!(
        "NRRD0004\ntype: float\ndimension: 3\nsizes: {nx} {ny} {nz}\nencoding: text\nspace dimension: 3\n\
         space directions: {x} {y} {z}\nspace origin: {}\nisovalue:={isovalue:?}\nmethod:={method}\nchunk:={chunk}\n\
         fine:={fine}\npromise:={promise}\n\n",
        vector(origin)
    );
    for (i, row) in values.chunks(nx).enumerate() {
        if i > 0 && i % ny == 0 {
            text.push('\n');
        }
        let row: Vec<String> = row.iter().map(|value| format!("{value:?}")).collect();
        _ = writeln!(text, "{}", row.join(" "));
    }
    text
}

/// The volume and the method of such a file; `None` if it is another.
pub(super) fn read(text: &str) -> Option<(Volume, String)> {
    let (header, samples) = text.split_once("\n\n")?;
    let of = |key: &str| header.lines().find_map(|line| line.strip_prefix(key)).map(str::trim);
    let vectors = |key: &str| -> Option<Vec<[f64; 3]>> {
        let parsed = of(key)?.split_whitespace().map(|vector| {
            let numbers = vector.trim_matches(['(', ')']).split(',').map(str::parse);
            numbers.collect::<Result<Vec<f64>, _>>().ok()?.try_into().ok()
        });
        parsed.collect()
    };
    let counts: Result<Vec<usize>, _> = of("sizes: ")?.split_whitespace().map(str::parse).collect();
    let values: Result<Vec<f32>, _> = samples.split_whitespace().map(str::parse).collect();
    let volume = Volume {
        counts: counts.ok()?.try_into().ok()?,
        values: values.ok()?,
        origin: *vectors("space origin: ")?.first()?,
        steps: vectors("space directions: ")?.try_into().ok()?,
        isovalue: of("isovalue:=")?.parse().ok()?,
        chunk: of("chunk:=")?.parse().ok()?,
        fine: of("fine:=")?.parse().ok()?,
    };
    Some((volume, of("method:=")?.to_owned()))
}

/// Writes a failing volume beside the build, and says how to run it.
pub(super) fn report(volume: &Volume, method: &str, promise: &str, fault: &str, on_cells: bool) -> String {
    let path = path(method);
    std::fs::write(&path, text(volume, method, promise)).expect("the folder of the tests can be written to");
    let (file, isovalue) = (path.display(), volume.isovalue);
    // Methods of cubes take the volume's own cells unless a spacing is given.
    let spacing = match volume.interpolated() {
        Some(field) if !on_cells => format!(" --spacing {:?}", field.spacing()),
        _ => String::new(),
    };
    format!(
        "{method} breaks a promise: {promise}\n  {fault}\n  the smallest volume found, {:?} samples at the isovalue {isovalue:?}: {file}\n  \
         isostudy extract --volume {file} --isovalue={isovalue:?} --method {method}{spacing} --quality -o {method}.ply\n  \
         ISOSTUDY_VOLUME={file} cargo test --release --locked -p isostudy-extract --test it fuzz::the_volume_in_a_file",
        volume.counts
    )
}

fn path(method: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{method}.nrrd"))
}
