//! What a method makes of a volume: a mesh on the volume's own cells, where it takes them, and one of the interpolated samples.

use glam::Vec3;
use isostudy_extract::{Execution, Extractor, Method, Source, VolumeCells};
use isostudy_mesh::{Bounds, TriangleMesh};

use super::volume::{STRAIGHT, Sampled, Volume};

pub(super) const ONE: Execution = Execution { threads: 1 };

/// Of one method and one volume.
pub(super) struct Made<'a> {
    pub(super) method: &'a Method,
    pub(super) volume: &'a Volume,
    /// On own cells, in steps of the grid.
    pub(super) on_cells: Option<Mesh>,
    /// Of a field.
    pub(super) of_field: Option<(Sampled, Mesh)>,
}

/// A mesh and the box that it was looked for in.
pub(super) struct Mesh {
    pub(super) mesh: TriangleMesh,
    pub(super) bounds: Bounds,
    /// Edge of the lattice's cubes.
    pub(super) spacing: f32,
    /// Whether the surface stays clear of the box.
    pub(super) closed: bool,
}

impl<'a> Made<'a> {
    /// # Errors
    /// What the method refuses; it should refuse nothing.
    pub(super) fn of(method: &'a Method, volume: &'a Volume) -> Result<Self, Broken> {
        let on_cells = method.is_of_cubes().then(|| {
            let cells = own_cells(volume);
            let mesh = on_cells(method, &cells, volume.isovalue, &ONE).map_err(Broken::on_cells)?;
            let grid = cells.grid();
            Ok(Mesh { mesh, bounds: grid.bounds, spacing: grid.spacing, closed: volume.ends_outside() })
        });
        let of_field = volume.field().map(|sampled| {
            let mesh = of_field(method, &sampled, volume.isovalue, &ONE).map_err(Broken::of_field)?;
            let mesh = Mesh {
                mesh,
                bounds: sampled.grid.bounds,
                spacing: sampled.grid.spacing,
                closed: sampled.closed,
            };
            Ok((sampled, mesh))
        });
        Ok(Self { method, volume, on_cells: on_cells.transpose()?, of_field: of_field.transpose()? })
    }

    /// Asks the same of both meshes.
    pub(super) fn each(&self, keeps: impl Fn(&Mesh) -> Result<(), String>) -> Result<(), Broken> {
        self.on_cells.as_ref().map_or(Ok(()), &keeps).map_err(Broken::on_cells)?;
        self.of_field.as_ref().map_or(Ok(()), |(_, mesh)| keeps(mesh)).map_err(Broken::of_field)
    }
}

/// What is wrong, and with which of the two meshes.
#[derive(Debug)]
pub(super) struct Broken {
    pub(super) fault: String,
    pub(super) on_cells: bool,
}

impl Broken {
    pub(super) fn on_cells(fault: String) -> Self {
        Self { fault, on_cells: true }
    }

    pub(super) fn of_field(fault: String) -> Self {
        Self { fault, on_cells: false }
    }
}

/// The volume's own cells as unit cubes.
pub(super) fn own_cells(volume: &Volume) -> VolumeCells<'_> {
    VolumeCells { counts: volume.counts, values: &volume.values, origin: [0.0; 3], steps: STRAIGHT }
}

/// The mesh of a volume's cells.
pub(super) fn on_cells(
    method: &Method,
    cells: &VolumeCells,
    isovalue: f32,
    execution: &Execution,
) -> Result<TriangleMesh, String> {
    let made = cells.extract(method, &mut Extractor::new(), isovalue, execution);
    made.map(|extraction| extraction.mesh).map_err(|error| error.to_string())
}

/// The mesh of the interpolated samples.
pub(super) fn of_field(
    method: &Method,
    sampled: &Sampled,
    isovalue: f32,
    execution: &Execution,
) -> Result<TriangleMesh, String> {
    let source = Source::Study(&*sampled.field);
    let made = method.extract(&mut Extractor::new(), source, &sampled.grid, isovalue, execution);
    made.map(|extraction| extraction.mesh).map_err(|error| error.to_string())
}

/// Whether two meshes have the same bits.
pub(super) fn same(one: &TriangleMesh, other: &TriangleMesh) -> Result<(), String> {
    let bits = |points: &[Vec3]| points.iter().map(|p| p.to_array().map(f32::to_bits)).collect::<Vec<_>>();
    let differs = [
        ("triangles", one.triangles != other.triangles),
        ("positions", bits(&one.positions) != bits(&other.positions)),
        ("normals", bits(&one.normals) != bits(&other.normals)),
    ];
    match differs.iter().find(|(_, differs)| *differs) {
        Some((what, _)) => Err(format!("the {what} differ")),
        None => Ok(()),
    }
}
