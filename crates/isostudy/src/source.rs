//! Where a surface comes from: a formula, a volume, a mesh, points or polygon soup; and where it is looked at.

use crate::file_samples::{FileSamples, Parts, field_bytes, stays_in_file};
use crate::memory::{Limit, OfVolume};
use crate::mesh_file;
use crate::place::place;
use crate::scattered_file::{self, WantedPoints};
use crate::seeds;
use crate::terminal::tell_once;
use anyhow::{Context, Result, bail};
use clap::ValueEnum;
use isostudy_expression::{Expression, ExpressionError};
use isostudy_extract::{BoxGrid, Execution, Method};
use isostudy_field::{
    Beyond, Holes, MeshDistance, MeshFieldError, Negated, StudyField, VolumeField, VolumeGrid, Walled,
};
use isostudy_mesh::{Bounds, repair};
use isostudy_volume::{Frame, Unread, Volume};
use serde::Serialize;
use std::path::Path;
use std::sync::Arc;

/// Cells along the longest side, where neither spacing nor cells are given.
const CELLS: u32 = 100;
/// Cubes for each sample of a volume beyond which nobody can have meant the smallest of its steps.
const CUBES_A_SAMPLE: f64 = 64.0;

/// Which side of the isovalue is solid.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Inside {
    /// Values above the isovalue, such as densities
    Above,
    /// Values below it, such as distances that are negative inside
    Below,
}

/// A field and where to look at it.
pub(crate) struct Source {
    /// Inside is above [`isovalue`](Self::isovalue), whatever was asked for.
    pub(crate) field: Box<dyn StudyField + Send>,
    pub(crate) isovalue: f32,
    /// As asked for.
    pub(crate) inside: Inside,
    pub(crate) bounds: Bounds,
    pub(crate) spacing: f32,
    /// Whether the surface must have no boundary.
    pub(crate) is_closed: bool,
    /// The formula or the file.
    pub(crate) name: String,
    /// What a volume takes of the memory.
    pub(crate) held: Option<OfVolume>,
    /// Of a volume that stays in its file.
    in_file: Option<(Arc<FileSamples>, Execution)>,
    /// What is known of its values, for a surface that is not there.
    values: String,
}

/// A volume to be extracted on its own cells.
pub(crate) struct OwnCells {
    /// The field, for measuring.
    pub(crate) source: Source,
    /// Along the volume's axes.
    pub(crate) cells: [u32; 3],
    /// Whether the grid's axes are not those of space, so that its box is not the volume.
    pub(crate) is_turned: bool,
}

/// A volume as it was read.
pub(crate) struct ReadVolume {
    field: VolumeField,
    held: OfVolume,
    in_file: Option<(Arc<FileSamples>, Execution)>,
    name: String,
}

impl ReadVolume {
    /// As asked for; the samples are shared.
    ///
    /// # Errors
    /// If it would have far more cubes than samples.
    pub(crate) fn at(&self, options: &Options) -> Result<Source> {
        options.of_volume_read(self)
    }
}

/// What is asked of a source, whoever asks.
pub(crate) struct Options {
    /// The box to look at; the source's own unless given.
    pub(crate) bounds: Option<Bounds>,
    /// Edge of the cubes.
    pub(crate) spacing: Option<f32>,
    /// The same, as the number of cubes along the longest side.
    pub(crate) cells: Option<u32>,
    pub(crate) isovalue: f32,
    /// Which side is solid; the source's custom unless given.
    pub(crate) inside: Option<Inside>,
    /// Whether the surface ends at the walls of the box.
    pub(crate) close: bool,
    /// Whether a mesh may have holes.
    pub(crate) allow_open: bool,
    /// The memory that there is.
    pub(crate) limit: Limit,
    /// What it is for, if it is for a mesh: what that holds beside a volume is known before the samples are read.
    pub(crate) method: Option<(Method, Execution)>,
    /// Whether a volume may stay in its file, if there is a method.
    pub(crate) in_file: bool,
}

impl Options {
    /// A formula in a box; `key` is where it stands, for errors.
    ///
    /// # Errors
    /// If it is none.
    pub(crate) fn of_formula(&self, formula: &str, bounds: Bounds, key: &str) -> Result<Source> {
        let field: Expression = formula.parse().map_err(|error: ExpressionError| {
            let shown = error.excerpt(formula);
            anyhow::Error::new(error).context(format!("{key} '{shown}'"))
        })?;
        let source = self.of_field(Box::new(field), Inside::Below, bounds, formula);
        Ok(if self.close { source.closed() } else { source })
    }

    /// A field with its custom of which side is solid, its box and its name, where nothing else is asked for.
    pub(crate) fn of_field(
        &self,
        field: Box<dyn StudyField + Send>,
        inside: Inside,
        bounds: Bounds,
        name: &str,
    ) -> Source {
        let inside = self.inside.unwrap_or(inside);
        let (field, isovalue): (Box<dyn StudyField + Send>, f32) = match inside {
            Inside::Above => (field, self.isovalue),
            Inside::Below => (Box::new(Negated(field)), -self.isovalue),
        };
        let bounds = self.bounds.unwrap_or(bounds);
        let spacing = self.spacing.unwrap_or_else(|| bounds.spacing_of_cells(self.cells.unwrap_or(CELLS)));
        let (name, values) = (name.to_owned(), String::new());
        let (is_closed, held, in_file) = (false, None, None);
        Source { field, isovalue, inside, bounds, spacing, is_closed, name, held, in_file, values }
    }

    /// A volume in a file.
    ///
    /// # Errors
    /// If it cannot be read, is too large, or is none.
    pub(crate) fn of_volume(&self, path: &Path) -> Result<Source> {
        self.read_volume(path)?.at(self)
    }

    /// A volume in a file, to be looked at with several isovalues.
    ///
    /// # Errors
    /// If it cannot be read, is too large, or is none.
    pub(crate) fn read_volume(&self, path: &Path) -> Result<ReadVolume> {
        let name = || path.display().to_string();
        let unread = isostudy_volume::open(path)?;
        let whole = held_as_a_field(&unread);
        let Frame { counts, origin, steps, .. } = unread.frame();
        let grid = VolumeGrid::try_new(counts, origin, steps).with_context(name)?;
        let over = self.grid_over(&grid, &name())?;
        let place = || format!("{}, {}", name(), place_of(&over));
        let in_file = match &self.method {
            Some((method, execution)) if self.in_file => {
                let in_file = held_in_bricks(&unread, &grid, self.limit);
                let asked = (method, &over, execution);
                stays_in_file(self.limit, &unread, (whole, in_file), Parts::Bricks, asked)
                    .with_context(place)?
            }
            Some((method, execution)) => {
                self.limit.check_method(method, &over, execution, Some(whole)).with_context(place)?;
                None
            }
            None => None,
        };
        let (field, held, in_file) = match in_file {
            None => {
                let Volume { values, .. } = self.limit.read(unread, whole)?;
                let field = VolumeField::try_new(counts, values, origin, steps, Beyond::Continued);
                (field.with_context(name)?, whole, None)
            }
            Some(in_file) => {
                let samples = Arc::new(FileSamples::open(unread, &in_file)?);
                let (held, execution) = (in_file.held, in_file.execution);
                let field = self.of_file_samples(&samples, (origin, steps), &execution, &name())?;
                (field, held, Some((samples, execution)))
            }
        };
        if !field.is_axis_aligned() && !self.close {
            let name = path.display();
            tell_once(&format!(
                "{name}: the grid is turned against the axes; the surface is closed where it leaves it"
            ));
        }
        Ok(ReadVolume { field, held, in_file, name: name() })
    }

    /// A field of samples in a file, all of which are read once.
    ///
    /// # Errors
    /// If they cannot be read, or are no field.
    fn of_file_samples(
        &self,
        samples: &Arc<FileSamples>,
        (origin, steps): ([f64; 3], [[f64; 3]; 3]),
        execution: &Execution,
        name: &str,
    ) -> Result<VolumeField> {
        let (of, bytes) = (Arc::clone(samples), field_bytes(self.limit));
        let field = VolumeField::try_stored(of, origin, steps, Beyond::Continued, bytes, execution.threads);
        samples.vouch(field.with_context(|| name.to_owned()))
    }

    fn of_volume_read(&self, volume: &ReadVolume) -> Result<Source> {
        let ReadVolume { field, held, in_file, name } = volume;
        let mut field = field.clone();
        let BoxGrid { bounds, spacing } = self.grid_over(field.grid(), name)?;
        let beyond = match self.inside {
            Some(Inside::Below) => Beyond::Rising,
            _ => Beyond::Falling,
        };
        // A box cannot cut off what leaves a turned volume.
        let is_turned = !field.is_axis_aligned();
        if self.close || is_turned {
            field = field.with_beyond(beyond).closing_at(self.isovalue);
        }
        let values = values_of(&field);
        let source = self.of_field(Box::new(field), Inside::Above, bounds, name);
        let (held, in_file) = (Some(*held), in_file.clone());
        let mut source = Source { spacing, values, held, in_file, ..source };
        if self.close || is_turned && self.bounds.is_none() {
            source = source.closed();
        }
        Ok(source)
    }

    /// Where a volume is looked at, and how finely.
    fn grid_over(&self, grid: &VolumeGrid, name: &str) -> Result<BoxGrid> {
        // A box cannot cut off what leaves a turned volume.
        let is_closed = self.close || !grid.is_axis_aligned();
        let own = if is_closed { grid.closing_bounds() } else { grid.bounds() };
        let bounds = self.bounds.unwrap_or(own);
        let spacing = match (self.spacing, self.cells) {
            (Some(spacing), _) => spacing,
            (None, Some(cells)) => bounds.spacing_of_cells(cells),
            (None, None) => grid.spacing(),
        };
        if self.spacing.is_none() && self.cells.is_none() {
            let samples: usize = grid.counts().iter().product();
            let sides = bounds.size().to_array();
            let cubes: f64 = sides.map(|side| f64::from(side / spacing)).iter().product();
            if cubes > CUBES_A_SAMPLE * samples as f64 {
                bail!(
                    "{name}: cubes as small as its smallest step, {spacing:?}, would be {cubes:.1e} for {samples} samples; \
                     --spacing or --cells says how many are wanted"
                );
            }
        }
        Ok(BoxGrid { bounds, spacing })
    }

    /// A volume that is extracted on its own cells: as it is, open where the surface leaves it.
    ///
    /// # Errors
    /// If it is no field.
    pub(crate) fn of_own_cells(&self, volume: Volume, path: &Path) -> Result<OwnCells> {
        let name = path.display().to_string();
        let Volume { counts, values, origin, steps } = volume;
        let field = VolumeField::try_new(counts, values, origin, steps, Beyond::Continued)
            .with_context(|| name.clone())?;
        Ok(self.of_own_field(field, steps, &name))
    }

    /// The same of a volume that stays in its file, all samples of which are read once more.
    ///
    /// # Errors
    /// The same, and if the samples cannot be read.
    pub(crate) fn of_own_cells_in_file(
        &self,
        samples: &Arc<FileSamples>,
        frame: &Frame,
        execution: &Execution,
        name: &str,
    ) -> Result<OwnCells> {
        let field = self.of_file_samples(samples, (frame.origin, frame.steps), execution, name)?;
        let mut own = self.of_own_field(field, frame.steps, name);
        own.source.in_file = Some((Arc::clone(samples), *execution));
        Ok(own)
    }

    fn of_own_field(&self, field: VolumeField, steps: [[f64; 3]; 3], name: &str) -> OwnCells {
        let (bounds, is_turned) = (field.bounds(), !field.is_axis_aligned());
        let (values, cells) = (values_of(&field), field.grid().counts().map(|n| n as u32 - 1));
        let source = self.of_field(Box::new(field), Inside::Above, bounds, name);
        // The edge of a cube as large as a cell.
        let spacing = glam::DMat3::from_cols_array_2d(&steps).determinant().abs().cbrt() as f32;
        OwnCells { source: Source { spacing, values, ..source }, cells, is_turned }
    }

    /// The distance to a mesh in a file.
    ///
    /// # Errors
    /// If it cannot be read, or has no inside.
    pub(crate) fn of_mesh(&self, path: &Path) -> Result<Source> {
        let (field, tight) = mesh_field(path, self.allow_open)?;
        // Room for a few cubes, and for what is thickened.
        let room = 0.05 * tight.size().max_element() - self.isovalue.min(0.0);
        let mut source =
            self.of_field(Box::new(field), Inside::Above, tight.grown(room), &path.display().to_string());
        source.values = format!("; the mesh reaches from {} to {}", place(tight.min), place(tight.max));
        Ok(if self.close { source.closed() } else { source })
    }

    /// The spline through points in a file.
    ///
    /// # Errors
    /// If they cannot be read, or make no surface.
    pub(crate) fn of_points(&self, path: &Path, wanted: &WantedPoints) -> Result<Source> {
        let field = scattered_file::points(path, wanted)?;
        let tight = field.bounds();
        Ok(self.of_scattered(Box::new(field), tight, path, "points"))
    }

    /// The field of triangles in a file that need not hang together.
    ///
    /// # Errors
    /// If they cannot be read, or all are flat.
    pub(crate) fn of_soup(&self, path: &Path, epsilon: Option<f64>) -> Result<Source> {
        let field = scattered_file::soup(path, epsilon)?;
        let tight = field.bounds();
        Ok(self.of_scattered(Box::new(field), tight, path, "triangles"))
    }

    fn of_scattered(
        &self,
        field: Box<dyn StudyField + Send>,
        tight: Bounds,
        path: &Path,
        what: &str,
    ) -> Source {
        // Room for a surface that bulges where nothing is given.
        let room = 0.1 * tight.size().max_element() + self.isovalue.abs();
        let mut source = self.of_field(field, Inside::Above, tight.grown(room), &path.display().to_string());
        source.values = format!("; the {what} reach from {} to {}", place(tight.min), place(tight.max));
        if self.close { source.closed() } else { source }
    }
}

/// What a volume takes as a field: its samples, and the ranges of their bricks.
pub(crate) fn held_as_a_field(unread: &Unread) -> OfVolume {
    let Frame { counts, origin, steps, .. } = unread.frame();
    // What is no field has no ranges.
    let ranges = VolumeGrid::try_new(counts, origin, steps).map_or(0, |grid| grid.range_bytes());
    OfVolume::samples(unread).with("the ranges of their bricks", ranges)
}

/// What a volume that stays in its file takes as a field: bricks of its samples, and their ranges.
fn held_in_bricks(unread: &Unread, grid: &VolumeGrid, limit: Limit) -> OfVolume {
    let [bricks, ranges] = grid.stored_bytes(field_bytes(limit));
    OfVolume::in_file(unread, bricks).with("the ranges of their bricks", ranges)
}

/// What is known of a volume's values, for a surface that is not there.
fn values_of(field: &VolumeField) -> String {
    let (low, high) = field.value_range();
    run_from(low, high)
}

/// The same of samples that are no field; those that are not finite aside.
pub(crate) fn values_of_samples(values: &[f32]) -> String {
    let finite = values.iter().copied().filter(|v| v.is_finite());
    let (low, high) = finite.fold((f32::INFINITY, f32::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    run_from(low, high)
}

fn run_from(low: f32, high: f32) -> String {
    format!("; the volume's samples run from {low} to {high}")
}

/// The distance field of the mesh in a file, and the box of its triangles.
fn mesh_field(path: &Path, allow_open: bool) -> Result<(MeshDistance, Bounds)> {
    let name = path.display();
    let mut mesh = mesh_file::read(path)?;
    let mut holes = Holes::Refuse;
    let mut is_welded = false;
    loop {
        let error = match MeshDistance::try_from_any(&mesh, holes) {
            Ok(field) => {
                for part in field.inward_parts(&mesh) {
                    let (min, max) = (place(part.bounds.min), place(part.bounds.max));
                    tell_once(&format!(
                        "{name}: part {} of {}, from {min} to {max}, faces inward and lies in no other: it is left out",
                        part.part + 1,
                        part.parts
                    ));
                }
                let bounds = mesh.surface_bounds().context("the mesh has no triangles")?;
                return Ok((field, bounds));
            }
            Err(error) => error,
        };
        match error {
            MeshFieldError::Open { .. } if !is_welded => {
                let before = mesh.positions.len();
                mesh = isostudy_mesh::weld(&mesh);
                is_welded = true;
                if mesh.positions.len() < before {
                    let places = mesh.positions.len();
                    tell_once(&format!("{name}: {before} vertices at {places} places joined"));
                }
            }
            MeshFieldError::Open { .. } if allow_open => {
                tell_once(&format!("{name}: {error}"));
                holes = Holes::Span;
            }
            MeshFieldError::Open { .. } => bail!("{name}: {error}; --allow-open takes it nevertheless"),
            MeshFieldError::InsideOut { volume } if volume < 0.0 => {
                tell_once(&format!("{name}: its triangles face inward: turned round"));
                mesh = repair::flip(&mesh);
            }
            error => return Err(error).with_context(|| name.to_string()),
        }
    }
}

/// Box and spacing, for people.
fn place_of(BoxGrid { bounds, spacing }: &BoxGrid) -> String {
    format!("from {} to {} with spacing {spacing:?}", place(bounds.min), place(bounds.max))
}

impl Source {
    /// The same, cut off by the walls of its box: whatever leaves it has a surface there.
    fn closed(self) -> Self {
        let field = Box::new(Walled::new(self.field, self.bounds, self.isovalue));
        Self { field, is_closed: true, ..self }
    }

    /// On which threads, where somebody asks for some: on no more than a volume leaves memory for that stays in its file.
    pub(crate) fn execution(&self, asked: &Execution) -> Execution {
        self.in_file.as_ref().map_or(*asked, |(_, execution)| *execution)
    }

    /// What was made of the field, if all samples that it was made of could be read.
    ///
    /// # Errors
    /// If the volume stays in its file, and that was changed or could not be read; else those of `made`.
    pub(crate) fn vouch<T>(&self, made: Result<T>) -> Result<T> {
        match &self.in_file {
            Some((samples, _)) => samples.vouch(made),
            None => made,
        }
    }

    /// Where to look at it.
    pub(crate) fn grid(&self) -> BoxGrid {
        BoxGrid { bounds: self.bounds, spacing: self.spacing }
    }

    /// Box and spacing, for people.
    pub(crate) fn place(&self) -> String {
        place_of(&self.grid())
    }

    /// What is known of its values, as the end of a sentence.
    pub(crate) fn values(&self) -> &str {
        &self.values
    }

    /// The isovalue as asked for.
    pub(crate) fn asked_isovalue(&self) -> f32 {
        match self.inside {
            Inside::Above => self.isovalue,
            Inside::Below => -self.isovalue,
        }
    }

    /// What to say where no surface is found.
    pub(crate) fn no_surface(&self) -> String {
        self.nothing("no surface", "every sample lies on one side")
    }

    /// The same of a method, which may have begun at seeds.
    pub(crate) fn no_surface_of(&self, method: &Method) -> String {
        match seeds::missed(method) {
            Some(why) => self.nothing("no surface was reached", &why),
            None => self.no_surface(),
        }
    }

    fn nothing(&self, what: &str, why: &str) -> String {
        format!(
            "{what} at isovalue {} from {} to {} with spacing {:?}: {why}{}",
            self.asked_isovalue(),
            place(self.bounds.min),
            place(self.bounds.max),
            self.spacing,
            self.values
        )
    }
}
