//! Surfaces in four dimensions: the series of `--frames`, and the solid of `--between`.

use super::super::source_arguments::finite;
use super::{Arguments, format, open_edges, tell_made, write};
use crate::input;
use crate::made::with_normals;
use crate::memory::{Limit, OfVolume, amount};
use crate::outcome::Outcome;
use crate::source::Inside;
use crate::store::write_whole_by;
use crate::terminal::say;
use anyhow::{Context, Result, bail};
use isostudy_four::{FourError, Placement, Series};
use isostudy_volume::{Frame, NO_LIMIT, Volume};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Two isovalues with a comma between them.
pub(super) fn between(text: &str) -> Result<[f32; 2], String> {
    let values = text.split(',').map(finite).collect::<Result<Vec<f32>, _>>()?;
    match values[..] {
        [low, high] if low < high => Ok([low, high]),
        [low, high] => Err(format!("the first isovalue must be below the second: {low} and {high}")),
        _ => Err("two isovalues with a comma between them".into()),
    }
}

/// Extracts slices of a series, or its surface in space-time, and writes them.
///
/// # Errors
/// If a frame cannot be read or does not fit to the first, a time is outside, there is no surface, or a file cannot be written.
pub(super) fn extract(arguments: &Arguments) -> Result<Outcome> {
    let out = arguments.out.as_deref().context("-o is needed")?;
    let is_mesh = arguments.time.is_some() || arguments.times.is_some();
    if !is_mesh {
        check_vtk(out).context(
            "--frames without --time or --times: the surface in space-time is no mesh of triangles",
        )?;
    }
    let outs: Vec<PathBuf> = match arguments.times {
        Some(count) => (0..count).map(|number| numbered(out, number)).collect(),
        None => vec![out.to_owned()],
    };
    for out in outs.iter().map(PathBuf::as_path).chain(arguments.picture.as_deref()) {
        check_inputs(out, &arguments.frames)?;
    }
    let (options, limit) = (arguments.source.options(), arguments.source.limit());
    let mesh_format = if is_mesh { Some(format(arguments, out)?) } else { None };
    let isovalue = if options.inside == Some(Inside::Below) { -options.isovalue } else { options.isovalue };
    let series = read(&arguments.frames, options.inside == Some(Inside::Below), limit)?;
    let last = (series.frames().len() - 1) as f64;
    let name = names(&arguments.frames);
    let Some(mesh_format) = mesh_format else {
        limit_holds(limit, &series, series.extract_bytes(isovalue)?).with_context(|| name.clone())?;
        let space_time = series.extract(isovalue).with_context(|| name.clone())?;
        if space_time.tetrahedra.is_empty() {
            bail!("{name}: no surface at isovalue {}", options.isovalue);
        }
        write_by(out, |file| space_time.write_vtk(file))?;
        tell!("{}: {} tetrahedra in space-time", out.display(), space_time.tetrahedra.len());
        say(&out.display().to_string())?;
        return Ok(Outcome::Done);
    };
    let times: Vec<f64> = match (arguments.time, arguments.times) {
        (Some(time), _) => vec![time],
        (None, count) => {
            let count = count.context("--times is needed")?;
            (0..count).map(|number| last * f64::from(number) / f64::from(count - 1)).collect()
        }
    };
    let mut found = false;
    for (time, out) in times.into_iter().zip(&outs) {
        let bytes = series.slice_bytes(isovalue, time).with_context(|| name.clone())?;
        limit_holds(limit, &series, bytes).with_context(|| name.clone())?;
        let began = Instant::now();
        let mesh = with_normals(series.slice(isovalue, time).with_context(|| name.clone())?);
        let taken = began.elapsed();
        if mesh.triangles.is_empty() {
            tell!("{name}: no surface at isovalue {} at time {time}, no file", options.isovalue);
            continue;
        }
        found = true;
        write(arguments, out, mesh_format, &mesh)?;
        tell_made(out, mesh.triangles.len() as u64, mesh.positions.len() as u64, taken);
        if let Some(edges) = open_edges(&mesh) {
            tell!("{}: the surface is open where it leaves the frames ({edges})", out.display());
        }
        say(&out.display().to_string())?;
    }
    if !found {
        bail!("{name}: no surface at isovalue {}", options.isovalue);
    }
    Ok(Outcome::Done)
}

/// Extracts the solid between two isovalues, and writes it.
///
/// # Errors
/// If the volume cannot be read, nothing is between the isovalues, or the file cannot be written.
pub(super) fn extract_between(arguments: &Arguments, out: &Path, [low, high]: [f32; 2]) -> Result<Outcome> {
    let path = arguments.source.file().context("--between needs --volume")?;
    check_vtk(out)?;
    check_inputs(out, &[path.to_owned()])?;
    let limit = arguments.source.limit();
    let unread = isostudy_volume::open(path)?;
    let needed = OfVolume::samples(&unread);
    let held = needed.total();
    let Volume { counts, origin, steps, values } = limit.read(unread, needed)?;
    let placement = Placement { counts, origin, steps };
    let name = || path.display().to_string();
    let bytes = isostudy_four::interval_bytes(&placement, &values, low, high).with_context(name)?;
    fits(limit, held, bytes).with_context(name)?;
    let solid = isostudy_four::interval_volume(&placement, &values, low, high).with_context(name)?;
    if solid.tetrahedra.is_empty() {
        bail!("{}: nothing is between {low} and {high}", path.display());
    }
    write_by(out, |file| solid.write_vtk(file))?;
    let (count, inverted) = (solid.tetrahedra.len(), solid.inverted());
    tell!("{}: {count} tetrahedra, of volume {}; {inverted} are inside out", out.display(), solid.volume());
    say(&out.display().to_string())?;
    Ok(Outcome::Done)
}

/// The series of these files, or of the one with four axes. Where inside is below, samples are turned round.
fn read(paths: &[PathBuf], is_turned: bool, limit: Limit) -> Result<Series> {
    let (frame, mut frames) = match paths {
        [path] => {
            let unread = isostudy_volume::open_series(path)?;
            let frame = unread.frame();
            (frame, unread.read(limit.bytes)?.frames)
        }
        _ => read_each(paths, limit)?,
    };
    if is_turned {
        frames.iter_mut().flatten().for_each(|value| *value = -*value);
    }
    let placement = Placement { counts: frame.counts, origin: frame.origin, steps: frame.steps };
    Series::try_new(placement, frames).map_err(|error| {
        let path = match error {
            FourError::NotFinite { frame, .. } | FourError::Samples { frame, .. } => paths.get(frame),
            _ => None,
        };
        let path = path.or(paths.first()).map(|path| path.display().to_string()).unwrap_or_default();
        anyhow::Error::from(error).context(path)
    })
}

fn read_each(paths: &[PathBuf], limit: Limit) -> Result<(Frame, Vec<Vec<f32>>)> {
    let unread = paths.iter().map(|path| isostudy_volume::open(path)).collect::<Result<Vec<_>, _>>()?;
    let first = unread.first().context("--frames needs a file")?.frame();
    let mut needed = 0u64;
    for (path, unread) in paths.iter().zip(&unread) {
        let frame = unread.frame();
        if frame.counts != first.counts {
            let [one, other] = [frame, first].map(|frame| frame.counts.map(|n| n.to_string()).join(" x "));
            bail!("{}: has {one} samples, and {} has {other}", path.display(), paths[0].display());
        }
        if frame != first {
            bail!("{}: its samples lie elsewhere than those of {}", path.display(), paths[0].display());
        }
        needed = needed.saturating_add(unread.memory_bytes());
    }
    fits(limit, 0, needed).with_context(|| names(paths))?;
    let read = unread.into_iter().map(|unread| Ok(unread.read(NO_LIMIT)?.values));
    Ok((first, read.collect::<Result<Vec<_>>>()?))
}

fn limit_holds(limit: Limit, series: &Series, bytes: u64) -> Result<()> {
    let samples = series.placement().samples() as u64 * series.frames().len() as u64;
    fits(limit, samples * isostudy_volume::SAMPLE_BYTES, bytes)
}

/// What is held and what is asked for are within the limit.
fn fits(limit: Limit, held: u64, bytes: u64) -> Result<()> {
    let needed = held.saturating_add(bytes);
    if needed > limit.bytes {
        bail!("{} of memory are needed; {}", amount(needed, f64::ceil), limit.allowed());
    }
    Ok(())
}

fn check_vtk(out: &Path) -> Result<()> {
    if !out.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("vtk")) {
        bail!("{}: tetrahedra are written as .vtk", out.display());
    }
    Ok(())
}

fn check_inputs(out: &Path, inputs: &[PathBuf]) -> Result<()> {
    if inputs.iter().any(|input| input::is_same(input, out)) {
        bail!("{}: is the input; it would be written over", out.display());
    }
    Ok(())
}

fn write_by(out: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<()> {
    write_whole_by(out, |file| {
        let mut buffered = BufWriter::new(file);
        write(&mut buffered)?;
        buffered.flush()
    })?;
    Ok(())
}

/// `mesh_0012.ply` of `mesh.ply`.
fn numbered(out: &Path, number: u32) -> PathBuf {
    let [stem, ending] =
        [out.file_stem(), out.extension()].map(|part| part.unwrap_or_default().to_string_lossy());
    out.with_file_name(format!("{stem}_{number:04}.{ending}"))
}

fn names(paths: &[PathBuf]) -> String {
    match paths {
        [first, .., last] => format!("{} to {}", first.display(), last.display()),
        _ => paths.iter().map(|path| path.display().to_string()).collect(),
    }
}
