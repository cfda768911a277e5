//! The dense extractor: the original's way, with all samples and edge records of the lattice in memory.
//!
//! It serves accumulated positions, and is what the streaming one is compared with.

pub(crate) mod edges;
pub(crate) mod sampling;
pub(crate) mod sides;
pub(crate) mod triangles;
pub(crate) mod vertices;

use isostudy_mesh::TriangleMesh;

use self::sampling::sample;
use crate::clock::Laps;
use crate::execution::control::Control;
use crate::extraction::{Counts, ExtractError, Extraction, StageTimes, check};
use crate::lattice::{Border, Coordinates, Lattice, Layout};
use crate::placement::CrossingPlacer;
use crate::sampling::level::Level;
use crate::settings::ExtractSettings;
use crate::slabs::finish::finish;
use crate::surface::normals::vertex_normals;
use crate::tetrahedra::dense::edges::EdgeTable;
use crate::tetrahedra::dense::sides::Sides;
use crate::tetrahedra::dense::triangles::triangulate;
use crate::tetrahedra::dense::vertices::VertexStage;
use isostudy_field::{FieldCache, StudyField};

/// The stages in order, timed and counted. At most `most_vertices` may come of it.
pub(crate) fn extract(
    field: &dyn StudyField,
    lattice: &Lattice,
    settings: &ExtractSettings,
    control: Control,
    most_vertices: u32,
) -> Result<Extraction, ExtractError> {
    check(settings, lattice.arrangement())?;
    let mut clock = Laps::new();

    let layout = Layout::new(lattice);
    reserve(lattice)?;
    let mut samples = vec![0.0; layout.len()];
    let mut sides = Sides::new(&layout);
    let mut edges = EdgeTable::new(layout.len());
    let allocation = clock.lap();

    let mut kept = FieldCache::default();
    let field = field.prepared(&mut kept).unwrap_or(field);
    let coordinates = Coordinates::sampled(lattice, &layout, settings.positions, Border::of(settings))?;
    sample(field, &layout, &coordinates, control, &mut samples)?;
    let sampling = clock.lap();

    let level = Level { field, isovalue: settings.isovalue, spacing: lattice.spacing() };
    let placer = CrossingPlacer::new(lattice, settings, Some(level));
    let stage = VertexStage::new(lattice, &samples, settings, placer.as_ref(), &mut sides, &mut edges);
    let (mut positions, targets, crossings) = stage.run(&layout, most_vertices)?;
    let vertex = clock.lap();

    let mut surface = triangulate(lattice, &layout, &sides, &edges)?;
    let collapsing =
        finish(Some(level), lattice, settings, control.threads, &targets, &mut positions, &mut surface)?;
    let clustering = collapsing.unwrap_or_default();
    let geometry = clock.lap() - clustering;

    let normals = vertex_normals(&positions, &surface.triangles)?;
    let times = StageTimes { allocation, sampling, vertex, geometry, clustering, normals: clock.lap() };

    let mesh = TriangleMesh { positions, normals, triangles: std::mem::take(&mut surface.triangles) };
    let counts = Counts::of(lattice, &mesh, &surface, crossings);
    Ok(Extraction { mesh, counts, times })
}

/// Asks for the memory once and gives it back, so that a lattice beyond the machine is an error and not an abort.
/// Filling a vector that reserved fallibly would write all of it; zeroed memory is not written before it is used.
fn reserve(lattice: &Lattice) -> Result<(), ExtractError> {
    let bytes = lattice.memory_bytes();
    let error = ExtractError::OutOfMemory { bytes };
    let length = usize::try_from(bytes).map_err(|_| error.clone())?;
    Vec::<u8>::new().try_reserve_exact(length).map_err(|_| error)
}
