//! Digs holes into the asteroid, chunk by chunk, as a game would: after each edit only the chunks that it touches are
//! extracted again. Prints the time of an edit, then checks that the chunks are still the mesh of the whole.
//!
//! `cargo run --release -p isostudy-extract --example dig -- [cells along an axis] [cells of a chunk] [edits] [arrangement]`
//!
//! `--method ID` takes any of the methods that `isostudy methods` lists and that makes chunks, in place of an arrangement. `--boxes` digs
//! boxes in place of balls: with `--method dc-clean` their walls stay sharp.

use std::time::Instant;

use glam::Vec3;
use isostudy_extract::{
    BoxGrid, Chunk, ChunkError, ChunkExtractor, ChunkSettings, Control, Execution, Extractor, Preset, Source,
    presets, weld_chunks,
};
use isostudy_field::{Asteroid, FieldCache, StudyField};
use isostudy_mesh::Bounds;
use isostudy_mesh::topology::topology;

/// A solid less the balls or boxes that were dug out of it.
struct Dug<'a> {
    solid: &'a dyn StudyField,
    holes: Vec<Hole>,
    /// No value is above this one.
    deepest: f32,
}

#[derive(Debug, Clone, Copy)]
struct Hole {
    centre: Vec3,
    /// Half the sides of a box.
    radius: f32,
    is_box: bool,
}

impl Hole {
    /// Positive outside: what is left when the hole is taken away.
    fn value(&self, p: Vec3) -> f32 {
        self.way(p - self.centre) - self.radius
    }

    /// How far a step leads away from the centre.
    fn way(&self, step: Vec3) -> f32 {
        if self.is_box { step.abs().max_element() } else { step.length() }
    }

    /// Beyond this box, digging the hole out of a field below `deepest` changes nothing, rounding included.
    fn reach(&self, deepest: f32) -> Bounds {
        let reach = Vec3::splat((self.radius + deepest) * 1.001);
        Bounds { min: self.centre - reach, max: self.centre + reach }
    }
}

/// Values farther inside than this many spacings are cut off, so that an edit changes the field near by and nowhere else.
const DEEPEST: f32 = 2.0;

impl StudyField for Dug<'_> {
    fn sample(&self, p: Vec3) -> f32 {
        self.holes.iter().fold(self.solid.sample(p).min(self.deepest), |value, hole| value.min(hole.value(p)))
    }

    /// So that the solid's own way of sampling a row is used, and only holes that can matter to it.
    fn sample_row(&self, x: &[f32], y: f32, z: f32, values: &mut [f32]) {
        self.solid.sample_row(x, y, z, values);
        values.iter_mut().for_each(|value| *value = value.min(self.deepest));
        let (Some(&first), Some(&last)) = (x.first(), x.last()) else { return };
        for hole in &self.holes {
            let near = hole.centre.clamp(Vec3::new(first, y, z), Vec3::new(last, y, z));
            if hole.value(near) < self.deepest {
                for (value, &x) in values.iter_mut().zip(x) {
                    *value = value.min(hole.value(Vec3::new(x, y, z)));
                }
            }
        }
    }

    /// A distance changes as fast as one walks.
    fn slope(&self, bounds: Bounds) -> Option<f32> {
        self.solid.slope(bounds).map(|slope| slope.max(1.0))
    }

    /// The least of all, so that chunks in the air or deep inside take no samples.
    fn range(&self, bounds: Bounds, value: f32) -> Option<(f32, f32)> {
        let (low, high) =
            self.solid.range(bounds, f32::NAN).filter(|range| !range.0.is_nan()).or_else(|| {
                let centre = (bounds.min + bounds.max) * 0.5;
                // The solid's own value there: the one that is known is after digging.
                self.solid.range(bounds, if value.is_nan() { value } else { self.solid.sample(centre) })
            })?;
        let cut = (low.min(self.deepest), high.min(self.deepest));
        Some(self.holes.iter().fold(cut, |(low, high), hole| {
            let near = hole.centre.clamp(bounds.min, bounds.max);
            let far = (hole.centre - bounds.min).abs().max((hole.centre - bounds.max).abs());
            let rounding = 1e-5;
            (low.min(hole.value(near) - rounding), high.min(hole.way(far) - hole.radius + rounding))
        }))
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let is_box = std::env::args().any(|argument| argument == "--boxes");
    let (method, mut arguments) =
        method_and_numbers(std::env::args().skip(1).filter(|argument| argument != "--boxes"))?;
    let mut number = |default: u32| arguments.next().map_or(Ok(default), |text| text.parse());
    let (cells, chunk_cells, edits) = (number(128)?, number(16)?, number(100)?);
    let method = match (method, arguments.next()) {
        (Some(id), None) => preset(&id)?,
        (None, arrangement) => preset(of_arrangement(arrangement.as_deref())?)?,
        (Some(_), Some(word)) => {
            return Err(format!("{word}: give --method or an arrangement, not both").into());
        }
    };
    let bounds = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };
    let grid = BoxGrid { bounds, spacing: 2.0 / cells as f32 };
    let control = Control::default();

    let (asteroid, mut kept) = (Asteroid::default(), FieldCache::default());
    let solid = asteroid.prepared(&mut kept).unwrap_or(&asteroid);
    let mut field = Dug { solid, holes: Vec::new(), deepest: DEEPEST * grid.spacing };
    let mut extractor = ChunkExtractor::in_box(&grid, &method.method, &ChunkSettings::default()).map_err(
        |error| match error {
            ChunkError::Method | ChunkError::Accumulated | ChunkError::Placement { .. } => {
                format!("{} cannot be dug chunk by chunk: {error}", method.id)
            }
            error => format!("{}: {error}", method.id),
        },
    )?;
    let boxes: Vec<_> = extractor.grid(chunk_cells).collect();
    let start = Instant::now();
    let mut chunks: Vec<Chunk> = Vec::new();
    for &cells in &boxes {
        chunks.push(extractor.extract(Source::Study(&field), cells, control)?);
    }
    let with_surface = chunks.iter().filter(|chunk| !chunk.triangles.is_empty()).count();
    println!(
        "{cells}^3 cells, {} ({}): {} chunks of {chunk_cells}^3 cells, {with_surface} with surface, in {:.0} ms",
        method.id,
        method.label,
        chunks.len(),
        start.elapsed().as_secs_f64() * 1e3
    );

    let (mut of_edit, mut of_chunk, mut touched) = (Vec::new(), Vec::new(), 0);
    for edit in 0..edits {
        let hole = Hole { centre: on_surface(solid, edit), radius: 0.06, is_box };
        field.holes.push(hole);
        let changed = hole.reach(field.deepest);
        let start = Instant::now();
        for chunk in chunks.iter_mut().filter(|chunk| chunk.is_touched_by(changed)) {
            let start = Instant::now();
            // Of all holes only those near by, so that old edits cost nothing.
            let near = |hole: &&Hole| chunk.is_touched_by(hole.reach(field.deepest));
            let holes = field.holes.iter().filter(near).copied().collect();
            let local = Dug { holes, ..field };
            let cells = chunk.cells;
            extractor.extract_into(Source::Study(&local), cells, control, chunk)?;
            of_chunk.push(start.elapsed().as_secs_f64() * 1e3);
            touched += 1;
        }
        of_edit.push(start.elapsed().as_secs_f64() * 1e3);
    }
    for (what, times) in [("edit", &mut of_edit), ("chunk", &mut of_chunk)] {
        times.sort_unstable_by(f64::total_cmp);
        if let (Some(median), Some(longest)) = (times.get(times.len() / 2), times.last()) {
            println!("time per {what}: median {median:.2} ms, longest {longest:.2} ms");
        }
    }
    println!("chunks per edit: {:.1}", f64::from(touched) / f64::from(edits.max(1)));

    let start = Instant::now();
    let execution = Execution { threads: 1 };
    let whole =
        method.method.extract(&mut Extractor::new(), Source::Study(&field), &grid, 0.0, &execution)?.mesh;
    println!(
        "the whole anew: {:.0} ms, {} triangles",
        start.elapsed().as_secs_f64() * 1e3,
        whole.triangles.len()
    );
    let start = Instant::now();
    let welded = weld_chunks(&chunks)?;
    println!("welding all chunks: {:.0} ms", start.elapsed().as_secs_f64() * 1e3);
    let open = topology(&welded).boundary_edges;
    println!("open edges: {open}");
    if open != 0 {
        return Err("the welded chunks are open, and the asteroid does not reach the box".into());
    }
    if welded != whole {
        return Err("the welded chunks are not the mesh of the whole".into());
    }
    println!("the welded chunks are the mesh of the whole");
    Ok(())
}

/// The id after `--method`, wherever it stands, and the other arguments.
fn method_and_numbers(
    mut arguments: impl Iterator<Item = String>,
) -> Result<(Option<String>, std::vec::IntoIter<String>), String> {
    let (mut method, mut others) = (None, Vec::new());
    while let Some(argument) = arguments.next() {
        if argument == "--method" {
            method = Some(arguments.next().ok_or("--method: the id of a method must follow")?);
        } else if argument.starts_with("--") {
            return Err(format!("{argument}: there is no such option"));
        } else {
            others.push(argument);
        }
    }
    Ok((method, others.into_iter()))
}

/// The id of the preset that an arrangement stands for.
fn of_arrangement(name: Option<&str>) -> Result<&'static str, String> {
    match name {
        None | Some("body-centred") => Ok("bi"),
        Some("simple-cubic") => Ok("si"),
        Some("five-tetrahedra") => Ok("mu"),
        Some("face-centred") => Ok("fu"),
        Some(other) => Err(format!("no arrangement {other}")),
    }
}

fn preset(id: &str) -> Result<&'static Preset, String> {
    presets().iter().find(|preset| preset.id == id).ok_or_else(|| {
        let ids: Vec<&str> = presets().iter().map(|preset| preset.id).collect();
        format!("no method {id}; there are {}", ids.join(", "))
    })
}

/// A place on the solid's surface, by bisection in one of many directions (Fibonacci's spiral).
fn on_surface(solid: &dyn StudyField, edit: u32) -> Vec3 {
    let z = 1.0 - 2.0 * ((edit as f32 + 0.5) * 0.618_034).fract();
    let (sin, cos) = (edit as f32 * 2.399_963).sin_cos();
    let direction = Vec3::new(cos, sin, 0.0) * (1.0 - z * z).sqrt() + Vec3::Z * z;
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..20 {
        let middle = (low + high) * 0.5;
        if solid.sample(direction * middle) > 0.0 { low = middle } else { high = middle }
    }
    direction * low
}
