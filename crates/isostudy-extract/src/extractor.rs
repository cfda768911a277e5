//! The extractor: which of the ways a surface is extracted in, and the buffers that stay.

#[cfg(test)]
mod tests;
mod ways;

use isostudy_field::{FieldCache, Plain, StudyField, Watched};

use crate::clock::Moment;
use crate::execution::control::Control;
use crate::extraction::{ExtractError, Extraction, check};
use crate::lattice::{CellBox, Lattice, Part};
use crate::placement;
use crate::settings::{Execution, ExtractSettings, Positions};
use crate::slabs::Progress;
use crate::slabs::{Run, threads_and_slabs};
use crate::source::{NormalsOf, Request, Sampler, Source};
use crate::surface::trace::Trace;
#[cfg(feature = "tetrahedra")]
use crate::tetrahedra::{by_cell::CellStreamer, dense, streamed::Streamer};
use ways::CubeStreamer;
pub(crate) use ways::Way;

/// An extractor that keeps its buffers, for one surface after another.
///
/// With indexed positions it streams: memory grows with a layer of the lattice and with the mesh. From the second
/// volume of a size on, with one thread, unless edges are collapsed or vertices placed otherwise than at the mean of
/// interpolated crossings, [`extract_into`](Self::extract_into) allocates nothing, as long as the surface does not
/// outgrow those before it; an `Asteroid` of `isostudy_field` other than the one before has its tables made again.
///
/// ```
/// use isostudy_extract::by_lattice::{ExtractSettings, Lattice};
/// use isostudy_extract::{Arrangement, Execution, Extraction, Extractor};
/// use isostudy_field::{StudyField, Sphere};
/// # use glam::Vec3;
/// # use isostudy_mesh::Bounds;
/// # let bounds = Bounds { min: Vec3::splat(-1.1), max: Vec3::splat(1.1) };
/// let lattice = Lattice::try_new(Arrangement::BodyCentred, bounds, 0.1)?;
/// let mut extractor = Extractor::new();
/// let mut extraction = Extraction::default();
/// for radius in [0.8, 0.9, 1.0] {
///     let sphere: &dyn StudyField = &Sphere { radius };
///     let (settings, execution) = (ExtractSettings::default(), Execution { threads: 1 });
///     extractor.extract_into(sphere.into(), &lattice, &settings, &execution, &mut extraction)?;
///     assert_eq!(extraction.counts.vertices * 2, extraction.counts.triangles + 4);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Default)]
pub struct Extractor {
    #[cfg(feature = "tetrahedra")]
    streamer: Streamer,
    #[cfg(feature = "tetrahedra")]
    cell_streamer: CellStreamer,
    cube_streamer: CubeStreamer,
    kept: FieldCache,
    progress: Option<Box<Progress>>,
    /// Where the last mesh came from, if `traced`.
    pub(crate) trace: Trace,
    pub(crate) traced: bool,
    /// What normals are made of.
    pub(crate) normals: NormalsOf,
    /// The cells whose triangles are wanted, of the whole lattice, where not all are. Those that cannot leave others out make more.
    pub(crate) wanted: Option<CellBox>,
    pub(crate) most_vertices: MostVertices,
}

/// How many vertices a mesh may have.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MostVertices(pub(crate) u32);

impl Default for MostVertices {
    /// What a 32-bit index can name.
    fn default() -> Self {
        Self(u32::MAX)
    }
}

impl Extractor {
    /// An extractor without buffers yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Calls `progress` with the layers done and the layers there are, from any of the threads, while extracting.
    /// Does not apply to accumulated positions.
    pub fn with_progress(mut self, progress: impl Fn(usize, usize) + Send + Sync + 'static) -> Self {
        self.progress = Some(Box::new(progress));
        self
    }

    /// Extracts a surface by marching tetrahedra, as [`extract`](crate::by_lattice::extract).
    ///
    /// # Errors
    /// As [`extract_into`](Self::extract_into).
    #[cfg(feature = "tetrahedra")]
    pub fn extract<'c>(
        &mut self,
        source: Source,
        lattice: &Lattice,
        settings: &ExtractSettings,
        control: impl Into<Control<'c>>,
    ) -> Result<Extraction, ExtractError> {
        let mut extraction = Extraction::default();
        self.extract_into(source, lattice, settings, control, &mut extraction)?;
        Ok(extraction)
    }

    /// Extracts a surface by marching tetrahedra into `extraction`, whose vectors are used again. After an error it is empty.
    ///
    /// # Errors
    /// As [`extract`](crate::by_lattice::extract); [`ExtractError::Cancelled`]; [`ExtractError::SampleCount`] when given samples are not as many as the
    /// lattice has, [`ExtractError::SamplesAccumulated`] when they come with accumulated positions,
    /// [`ExtractError::PlacementNeedsField`] when they come with a placement that calls the field.
    #[cfg(feature = "tetrahedra")]
    pub fn extract_into<'c>(
        &mut self,
        source: Source,
        lattice: &Lattice,
        settings: &ExtractSettings,
        control: impl Into<Control<'c>>,
        extraction: &mut Extraction,
    ) -> Result<(), ExtractError> {
        self.extract_by(None, source, lattice, settings, control.into(), extraction)
    }

    /// The same, where there is a way by cubes: on the points of a simple cubic lattice, as corners of cubes that are not cut any
    /// further.
    pub(crate) fn extract_by(
        &mut self,
        way: Option<Way>,
        source: Source,
        lattice: &Lattice,
        settings: &ExtractSettings,
        control: Control,
        extraction: &mut Extraction,
    ) -> Result<(), ExtractError> {
        let result = self.try_extract_into(source, lattice, settings, way, control, extraction);
        if result.is_err() {
            extraction.clear();
        }
        result
    }

    fn try_extract_into(
        &mut self,
        source: Source,
        lattice: &Lattice,
        settings: &ExtractSettings,
        cubes: Option<Way>,
        control: Control,
        extraction: &mut Extraction,
    ) -> Result<(), ExtractError> {
        check(settings, lattice.arrangement())?;
        let given = match source {
            Source::Field(field) => {
                placement::check(settings, true)?;
                // In debug builds somebody looks whether it keeps its promises.
                return if cfg!(debug_assertions) {
                    self.of_field(&Watched::new(field), lattice, settings, cubes, control, extraction)
                } else {
                    self.of_field(&Plain(field), lattice, settings, cubes, control, extraction)
                };
            }
            Source::Study(field) => {
                placement::check(settings, true)?;
                return self.of_field(field, lattice, settings, cubes, control, extraction);
            }
            Source::Samples(samples) => Sampler::Given { values: samples, bricks: None },
            Source::Stored(samples) => {
                let (given, wanted) = (samples.counts(), lattice.stored_grid().map(|n| n as usize));
                if given != wanted {
                    return Err(ExtractError::StoredCounts { given, wanted });
                }
                Sampler::Stored(samples)
            }
            Source::Bricks(bricks) => {
                let (given, wanted) = (bricks.samples().counts(), lattice.stored_grid().map(|n| n as usize));
                if given != wanted {
                    return Err(ExtractError::BrickCounts { given, wanted });
                }
                Sampler::Given { values: bricks.samples().values(), bricks: Some(bricks) }
            }
            Source::Window { cells, samples } => {
                let wanted = lattice.cell_box();
                if cells != wanted {
                    return Err(ExtractError::Window { given: cells, wanted });
                }
                Sampler::Given { values: samples, bricks: None }
            }
        };
        placement::check(settings, false)?;
        if let Sampler::Given { values, .. } = given {
            let (given, wanted) = (values.len() as u64, lattice.stored_samples());
            if given != wanted {
                return Err(ExtractError::SampleCount { given, wanted });
            }
        }
        if settings.positions != Positions::Indexed {
            return Err(ExtractError::SamplesAccumulated);
        }
        let start = Moment::now();
        self.stream((given, start), lattice, settings, cubes, control, extraction)
    }

    fn of_field(
        &mut self,
        field: &dyn StudyField,
        lattice: &Lattice,
        settings: &ExtractSettings,
        cubes: Option<Way>,
        control: Control,
        extraction: &mut Extraction,
    ) -> Result<(), ExtractError> {
        #[cfg(feature = "tetrahedra")]
        if settings.positions != Positions::Indexed {
            *extraction = dense::extract(field, lattice, settings, control, self.most_vertices.0)?;
            return Ok(());
        }
        let start = Moment::now();
        let mut kept = std::mem::take(&mut self.kept);
        let source = Sampler::Field(field.prepared(&mut kept).unwrap_or(field));
        let result = self.stream((source, start), lattice, settings, cubes, control, extraction);
        self.kept = kept;
        result
    }

    /// Where the last mesh came from, if that was asked for.
    pub(crate) fn trace(&self) -> Option<&Trace> {
        self.traced.then_some(&self.trace)
    }

    fn stream(
        &mut self,
        (source, start): (Sampler, Moment),
        lattice: &Lattice,
        settings: &ExtractSettings,
        cubes: Option<Way>,
        control: Control,
        extraction: &mut Extraction,
    ) -> Result<(), ExtractError> {
        let most_vertices = self.most_vertices.0;
        let (normals, part) = (self.normals, self.wanted.map(|cells| Part::of(lattice, cells)));
        let request = Request { source, lattice, settings, control, most_vertices, normals, part, start };
        let trace = self.traced.then_some(&mut self.trace);
        let run = Run { request: &request, progress: self.progress.as_deref(), trace, extraction };
        match cubes {
            Some(way) => self.cube_streamer.extract(way, run),
            #[cfg(feature = "tetrahedra")]
            None if lattice.arrangement().uniform().is_some() => self.streamer.extract(run),
            #[cfg(feature = "tetrahedra")]
            None => self.cell_streamer.extract(run),
            #[cfg(not(feature = "tetrahedra"))]
            None => unreachable!("all families but tetrahedra are made of cubes"),
        }
    }
}

/// Extracts the surface where `field` has the isovalue.
///
/// The mesh depends on the field, the lattice and the settings, never on `execution`, to the byte. See the crate's
/// front page for what it is and what it is not.
///
/// # Errors
/// [`ExtractError`] if the settings are not valid, memory or threads are not to be had, or there are too many
/// vertices.
#[cfg(feature = "tetrahedra")]
pub fn extract(
    field: &dyn StudyField,
    lattice: &Lattice,
    settings: &ExtractSettings,
    execution: &Execution,
) -> Result<Extraction, ExtractError> {
    Extractor::new().extract(Source::Study(field), lattice, settings, execution)
}

impl Lattice {
    /// What [`extract`](crate::by_lattice::extract) holds of the lattice at a time with these settings:
    /// [`memory_bytes`](Self::memory_bytes) or [`streaming_bytes`](Self::streaming_bytes). The mesh comes on top.
    pub fn memory_bytes_for(&self, settings: &ExtractSettings, execution: &Execution) -> u64 {
        self.memory_bytes_on(settings, Control::from(execution).threads.count())
    }

    /// The same on so many threads.
    pub(crate) fn memory_bytes_on(&self, settings: &ExtractSettings, threads: usize) -> u64 {
        match settings.positions {
            Positions::Indexed => {
                let layers = self.stored_grid()[2] as usize;
                self.streaming_bytes(threads_and_slabs(threads, layers).0 as u64)
            }
            Positions::Accumulated { .. } => self.memory_bytes(),
        }
    }
}
