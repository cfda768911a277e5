//! A volume's surface on the volume's own cells, for methods of cubes: what other programs extract on too.

use super::super::source_arguments::SourceArguments;
use crate::memory::Held;
use crate::seeds;
use crate::source::{Inside, OwnCells, held_as_a_field};
use anyhow::{Context, Result};
use isostudy_extract::{Execution, Extraction, Extractor, Method, VolumeCells};
use isostudy_volume::Frame;
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
    let (limit, before) = (arguments.limit(), Held::now());
    let unread = isostudy_volume::open(path)?;
    let (frame, held) = (unread.frame(), held_as_a_field(&unread));
    let method = &seeds::in_steps(method, &frame).with_context(name)?;
    let Frame { counts, origin, steps, .. } = frame;
    // A flat volume has no grid to be checked; the extraction says so.
    if counts.iter().all(|&n| n > 1) {
        let grid = VolumeCells { counts, values: &[], origin, steps }.grid();
        limit.check_method(method, &grid, execution, Some(held)).with_context(name)?;
    }
    let mut volume = limit.read(unread, held)?;
    let options = arguments.options();
    let is_below = options.inside == Some(Inside::Below);
    // Inside is above for the extractor.
    if is_below {
        volume.values.iter_mut().for_each(|value| *value = -*value);
    }
    let isovalue = if is_below { -options.isovalue } else { options.isovalue };
    let cells = VolumeCells { counts, values: &volume.values, origin, steps };
    let extract = || Ok(cells.extract(method, &mut Extractor::new(), isovalue, execution)?);
    let extraction = limit.hold(before, extract).with_context(name)?;
    if is_below {
        volume.values.iter_mut().for_each(|value| *value = -*value);
    }
    let own = limit.hold(before, || options.of_own_cells(volume, path))?;
    Ok((extraction, own))
}
