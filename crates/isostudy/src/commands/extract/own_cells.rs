//! A volume's surface on the volume's own cells, for methods of cubes: what other programs extract on too.

use super::super::source_arguments::SourceArguments;
use crate::source::{Inside, OwnCells};
use crate::{prepare, seeds};
use anyhow::{Context, Result};
use isostudy_extract::{Execution, Extraction, Extractor, Method, VolumeCells};
use std::path::Path;

/// The surface, and what it is measured against.
///
/// # Errors
/// If the volume cannot be read or has no cells, or memory does not suffice.
pub(super) fn extract(
    arguments: &SourceArguments,
    path: &Path,
    method: &Method,
    execution: &Execution,
) -> Result<(Extraction, OwnCells)> {
    let name = || path.display().to_string();
    let limit = arguments.limit();
    let mut volume = limit.read(path)?;
    let options = arguments.options();
    let is_below = options.inside == Some(Inside::Below);
    // Inside is above for the extractor.
    if is_below {
        volume.values.iter_mut().for_each(|value| *value = -*value);
    }
    let isovalue = if is_below { -options.isovalue } else { options.isovalue };
    let method = &seeds::in_steps(method, &volume).with_context(name)?;
    let held = (size_of::<f32>() * volume.values.len()) as u64;
    let isostudy_volume::Volume { counts, values, origin, steps } = &volume;
    let cells = VolumeCells { counts: *counts, values, origin: *origin, steps: *steps };
    // A flat volume has no grid to be checked; the extraction says so.
    if counts.iter().all(|&n| n > 1) {
        prepare::check_limit(method, &cells.grid(), execution, held, limit).with_context(name)?;
    }
    let extraction = cells.extract(method, &mut Extractor::new(), isovalue, execution).with_context(name)?;
    if is_below {
        volume.values.iter_mut().for_each(|value| *value = -*value);
    }
    Ok((extraction, options.of_own_cells(volume, path)?))
}
