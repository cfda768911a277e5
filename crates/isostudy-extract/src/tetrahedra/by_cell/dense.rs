//! The same extractor with the samples and sides of all points in memory, for the tests to compare with.

use glam::Vec3;
use isostudy_mesh::TriangleMesh;

use super::cut::{Cut, Step};
use super::grid::is_regular;
use super::points::{Placer, Record};
use crate::execution::control::Threads;
use crate::extraction::{Counts, Extraction};
use crate::lattice::tetrahedra::{CASES, Case};
use crate::lattice::{Border, Lattice};
use crate::sampling::level::Level;
use crate::settings::ExtractSettings;
use crate::slabs::Vertices;
use crate::slabs::finish::finish;
use crate::surface::normals::vertex_normals;
use crate::surface::trace::{Trace, VertexKey};
use crate::surface::triangulation::Triangulation;
use crate::tetrahedra::ties::Ties;
use isostudy_field::StudyField;

/// What [`super::extract`] gives, and the trace.
pub(super) fn extract(
    field: &dyn StudyField,
    lattice: &Lattice,
    settings: &ExtractSettings,
) -> (Extraction, Trace) {
    let cut = Cut::of(lattice.arrangement());
    let coordinates = coordinates(lattice, settings);
    let samples = samples(field, &coordinates);
    let sides = samples.iter().map(|value| settings.isovalue - value < 0.0).collect();
    let grid = lattice.stored_grid().map(|n| n as usize);
    let mut points = Points { lattice, cut: &cut, grid, sides, records: vec![None; samples.len()] };
    let level = Level { field, isovalue: settings.isovalue, spacing: lattice.spacing() };
    let mut vertices = points.place(&samples, &coordinates, settings, level);
    let mut trace = Trace { keys: vertices.keys.take().unwrap(), ..Trace::default() };
    let mut surface = triangulate(&points, &mut trace);
    let Vertices { mut positions, targets, .. } = vertices;
    finish(Some(level), lattice, settings, Threads::Here, &targets, &mut positions, &mut surface).unwrap();
    let normals = vertex_normals(&positions, &surface.triangles).unwrap();
    let mesh = TriangleMesh { positions, normals, triangles: std::mem::take(&mut surface.triangles) };
    let counts = Counts::of(lattice, &mesh, &surface, vertices.crossing_ends / 2);
    (Extraction { mesh, counts, ..Extraction::default() }, trace)
}

/// Where stored points are, along each axis.
pub(super) fn coordinates(lattice: &Lattice, settings: &ExtractSettings) -> [Vec<f32>; 3] {
    let mut at = Default::default();
    lattice.refit_in_line(Border::of(settings), &mut at).unwrap();
    at
}

/// As [`crate::Source::Samples`] has them.
pub(super) fn samples(field: &dyn StudyField, [x, y, z]: &[Vec<f32>; 3]) -> Vec<f32> {
    let mut samples = vec![0.0; x.len() * y.len() * z.len()];
    for (i, row) in samples.chunks_exact_mut(x.len()).enumerate() {
        field.sample_row(x, y[i % y.len()], z[i / y.len()], row);
    }
    samples
}

/// All points of the lattice, and what is known of those with a crossing.
struct Points<'a> {
    lattice: &'a Lattice,
    cut: &'a Cut,
    grid: [usize; 3],
    sides: Vec<bool>,
    records: Vec<Option<Record>>,
}

impl Points<'_> {
    /// The place of a point in storage.
    fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.grid[1] + y) * self.grid[0] + x
    }

    fn neighbour(&self, place: [usize; 3], step: Step) -> Option<usize> {
        let there = [0, 1, 2].map(|axis| place[axis].wrapping_add_signed(isize::from(step[axis])));
        (0..3).all(|axis| there[axis] < self.grid[axis]).then(|| self.index(there))
    }

    /// Places a vertex on every crossing, point by point.
    fn place(
        &mut self,
        samples: &[f32],
        coordinates: &[Vec<f32>; 3],
        settings: &ExtractSettings,
        level: Level,
    ) -> Vertices {
        let mut vertices = Vertices { keys: Some(Vec::new()), ..Vertices::default() };
        let placer = Placer::new(self.lattice, self.cut, settings, Some(level));
        let ties = Ties::of(settings.topology);
        let border = Border::of(settings);
        let at = |place: [usize; 3]| Vec3::from_array([0, 1, 2].map(|axis| coordinates[axis][place[axis]]));
        let [nx, ny, nz] = self.grid;
        for place in (0..nx * ny * nz).map(|i| [i % nx, i / nx % ny, i / nx / ny]) {
            let point = self.index(place);
            let here = settings.isovalue - samples[point];
            let edges = self.cut.edges_of[self.cut.class(self.lattice.stored(place))];
            let mut record = Record { first: vertices.positions.len() as u32, near: 0 };
            for (direction, &step) in self.cut.steps.iter().enumerate().filter(|(d, _)| edges >> d & 1 != 0) {
                let neighbour = self.neighbour(place, step);
                let differs = |neighbour: &usize| self.sides[*neighbour] != self.sides[point];
                let Some(neighbour) = neighbour.filter(differs) else { continue };
                vertices.crossing_ends += 1;
                if ties.is_near(self.sides[point], here, settings.isovalue - samples[neighbour]) {
                    record.near |= 1 << direction;
                    let values = [samples[point], samples[neighbour]];
                    let from = at(place);
                    let is_regular = is_regular(self.lattice, self.cut, border, place);
                    let there =
                        [0, 1, 2].map(|axis| place[axis].wrapping_add_signed(isize::from(step[axis])));
                    let way = if is_regular { placer.edges[direction] } else { at(there) - from };
                    placer.place(from, (direction, way), values, &mut vertices).unwrap();
                    let key =
                        VertexKey::new(self.lattice.arrangement(), self.lattice.stored(place), direction);
                    vertices.keys.as_mut().unwrap().push(key);
                }
            }
            self.records[point] = Some(record);
        }
        vertices
    }
}

/// Walks the cells in storage order and skips those whose points are all on one side.
fn triangulate(points: &Points, trace: &mut Trace) -> Triangulation {
    let mut result = Triangulation::default();
    let Points { cut, lattice, .. } = points;
    let [nx, ny, nz] = lattice.cells().map(|n| n as usize);
    let origin = lattice.origin().iter().sum::<i32>() as usize;
    for [x, y, z] in (0..nx * ny * nz).map(|i| [i % nx, i / nx % ny, i / nx / ny]) {
        let at = |corner: Step| {
            points.index([0, 1, 2].map(|axis| [x, y, z][axis] * cut.steps_a_cell + corner[axis] as usize))
        };
        let inside = cut.corners.iter().filter(|&&corner| points.sides[at(corner)]).count();
        if inside == 0 || inside == cut.corners.len() {
            continue;
        }
        result.cells_visited += 1;
        for tetrahedron in &cut.tetrahedra[(origin + x + y + z) % 2] {
            result.tetrahedra_evaluated += 1;
            let corners = tetrahedron.corners.map(at);
            let case = (0..4).fold(0, |case, i| case | usize::from(points.sides[corners[i]]) << i);
            if CASES[case] != Case::Empty {
                result.add(CASES[case], |edge| {
                    let edge = &tetrahedron.edges[usize::from(edge)];
                    let of = |end: u8| points.records[corners[usize::from(end)]].unwrap();
                    of(edge.from).vertex(edge.direction).or_else(|| of(edge.to).vertex(edge.back)).unwrap()
                });
            }
        }
        trace.close_cell(lattice.cell_number([x, y, z]), result.triangles.len()).unwrap();
    }
    result
}
