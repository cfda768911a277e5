//! A volume's surface on the volume's own cells, for methods of cubes: what other programs extract on too.

use super::super::source_arguments::SourceArguments;
use super::quality_report::Cells;
use crate::file_samples::{FileSamples, InFile, Parts, stays_in_file};
use crate::memory::{Held, OfVolume};
use crate::seeds;
use crate::source::{Inside, OwnCells, Source, held_as_a_field};
use anyhow::{Context, Result};
use isostudy_extract::{Execution, Extraction, Extractor, Method, StoredSamples, UnreadSamples, VolumeCells};
use isostudy_field::VolumeGrid;
use isostudy_volume::{Frame, Unread};
use std::path::Path;
use std::sync::Arc;

/// A surface on a volume's own cells.
pub(super) struct OfOwnCells {
    pub(super) extraction: Extraction,
    /// What it is measured against. `None` where the volume stays in its file and nothing is to be measured: it would be read once more.
    pub(super) source: Option<Source>,
    pub(super) cells: Cells,
}

/// Extracts it.
///
/// # Errors
/// If the volume cannot be read or has no cells, or memory does not suffice.
pub(super) fn extract(
    arguments: &SourceArguments,
    path: &Path,
    method: &Method,
    execution: &Execution,
    is_measured: bool,
) -> Result<OfOwnCells> {
    let name = || path.display().to_string();
    let (limit, before) = (arguments.limit(), Held::now());
    let unread = isostudy_volume::open(path)?;
    let (frame, held) = (unread.frame(), held_as_a_field(&unread));
    let method = &seeds::in_steps(method, &frame).with_context(name)?;
    let Frame { counts, origin, steps, .. } = frame;
    // A flat volume has no grid to be checked; the extraction says so.
    if counts.iter().all(|&n| n > 1) {
        let grid = VolumeCells { counts, values: &[], origin, steps }.grid();
        // The layers that are read are those of the grid.
        let held = (held, OfVolume::in_file(&unread, 0));
        let asked = (method, &grid, execution);
        if let Some(in_file) = stays_in_file(limit, &unread, held, Parts::Layers, asked).with_context(name)? {
            return extract_in_file(arguments, unread, &in_file, method, is_measured);
        }
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
    let OwnCells { source, cells, is_turned } = limit.hold(before, || options.of_own_cells(volume, path))?;
    Ok(OfOwnCells { extraction, source: Some(source), cells: Cells::Own { counts: cells, is_turned } })
}

/// The same of a volume that stays in its file.
fn extract_in_file(
    arguments: &SourceArguments,
    unread: Unread,
    in_file: &InFile,
    method: &Method,
    is_measured: bool,
) -> Result<OfOwnCells> {
    let (limit, before, options) = (arguments.limit(), Held::now(), arguments.options());
    let (name, frame) = (unread.path().display().to_string(), unread.frame());
    let Frame { counts, origin, steps, .. } = frame;
    let (samples, execution) = (Arc::new(FileSamples::open(unread, in_file)?), &in_file.execution);
    let layers = Layers { samples: &samples, is_below: options.inside == Some(Inside::Below) };
    let isovalue = if layers.is_below { -options.isovalue } else { options.isovalue };
    let cells = VolumeCells { counts, values: &[], origin, steps };
    let extract = || Ok(cells.extract_stored(&layers, method, &mut Extractor::new(), isovalue, execution)?);
    let extraction = samples.vouch(limit.hold(before, extract).with_context(|| name.clone()))?;
    let mut source = None;
    if is_measured || extraction.mesh.triangles.is_empty() {
        source = Some(options.of_own_cells_in_file(&samples, &frame, execution, &name)?.source);
    }
    let is_turned = !VolumeGrid::try_new(counts, origin, steps).with_context(|| name)?.is_axis_aligned();
    let cells = Cells::Own { counts: counts.map(|n| n as u32 - 1), is_turned };
    Ok(OfOwnCells { extraction, source, cells })
}

/// The layers of a volume in a file, as the extractor takes them: inside is above.
pub(super) struct Layers<'a> {
    pub(super) samples: &'a FileSamples,
    pub(super) is_below: bool,
}

impl StoredSamples for Layers<'_> {
    fn counts(&self) -> [usize; 3] {
        self.samples.counts()
    }

    fn read_box(&self, first: [usize; 3], size: [usize; 3], values: &mut [f32]) -> Result<(), UnreadSamples> {
        self.samples.read_box(first, size, values)?;
        if self.is_below {
            values.iter_mut().for_each(|value| *value = -*value);
        }
        Ok(())
    }
}
