//! A mesh held against what is known of a workload.

use std::collections::HashMap;

use isostudy_mesh::TriangleMesh;
use isostudy_mesh::glam::{DMat3, DVec3};
use isostudy_mesh::quality::quality;
use isostudy_mesh::topology::topology;
use serde::{Deserialize, Serialize};

use crate::engine::Ties;
use crate::workload::Truth;

/// A mesh may not be displaced as a whole by more than this share of a cell.
const MOST_SHIFT: f64 = 0.2;
/// The same where samples say no more than a side: the surface is known to a cell then.
const MOST_SHIFT_OF_LABELS: f64 = 0.35;
/// Neither vertices nor the middles of triangles may be farther from the interpolated surface than this share of a cell, in the mean.
const MOST_OFF: f64 = 0.25;

/// Of triangles that share no vertices, vertices so near to each other are one, in cells: cells compute the same crossing by other roundings.
pub(crate) const SAME_PLACE: f64 = 1e-6;

/// Samples as they were given.
#[derive(Debug, Clone, Copy)]
pub struct Grid<'a> {
    /// How many there are along x, y and z; at least 2 each.
    pub counts: [usize; 3],
    /// Where the first one is.
    pub origin: [f64; 3],
    /// From one to the next.
    pub spacing: [f64; 3],
    /// x fastest.
    pub values: &'a [f32],
    /// The value on the surface.
    pub isovalue: f32,
    /// Whether the values say more than a side: then a mesh lies where they are interpolated to be the isovalue.
    pub is_smooth: bool,
}

/// What can be wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// Connected pieces.
    Components,
    /// The Euler characteristic.
    Euler,
    /// Closed chains of edges with one triangle.
    Boundary,
    /// Edges with more than two triangles, and vertices where several sheets meet.
    NonManifold,
    /// Edges whose triangles face different ways.
    Misoriented,
    /// The whole surface faces the solid.
    InsideOut,
    /// Triangles on the vertices of another.
    Duplicates,
    /// Vertices more than a cell from any cell that the surface crosses.
    Far,
    /// Cells that the surface crosses, with no triangle within a cell.
    Missed,
    /// By how many cells the mesh is displaced as a whole.
    Shifted,
    /// How many cells it is from the interpolated surface, in the mean.
    Off,
    /// The volume that it encloses.
    Volume,
    /// Its area.
    Area,
}

impl Kind {
    /// As tables name it.
    pub fn words(self) -> &'static str {
        match self {
            Self::Components => "components",
            Self::Euler => "Euler characteristic",
            Self::Boundary => "boundary loops",
            Self::NonManifold => "non-manifold edges and vertices",
            Self::Misoriented => "misoriented edges",
            Self::InsideOut => "inside out",
            Self::Duplicates => "duplicate triangles",
            Self::Far => "vertices far from the surface",
            Self::Missed => "cells without their surface",
            Self::Shifted => "cells of displacement",
            Self::Off => "cells from the surface in the mean",
            Self::Volume => "volume",
            Self::Area => "area",
        }
    }
}

/// One thing that is wrong.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Fault {
    /// What.
    pub kind: Kind,
    /// How much of it the mesh has.
    pub found: f64,
    /// How much it should have.
    pub expected: f64,
    /// In how many boxes of the workload.
    pub boxes: u32,
}

/// What a mesh is worth.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Measures {
    /// Vertices that triangles have.
    pub vertices: u64,
    /// Triangles.
    pub triangles: u64,
    /// The mean radius ratio: 1 where all triangles are equilateral.
    pub radius_ratio: f64,
    /// How far the middles of triangles are from where samples are interpolated to be the isovalue, in cells; the mean over the area.
    pub off_cells: f64,
}

/// What a mesh is held to be.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Verdict {
    /// Everything that is wrong; nothing if the mesh is right.
    pub faults: Vec<Fault>,
    /// The same if it is right or wrong.
    pub measures: Measures,
}

impl Verdict {
    /// Whether nothing is wrong.
    pub fn is_right(&self) -> bool {
        self.faults.is_empty()
    }

    /// The same of several boxes: of each kind of fault the first, and in how many boxes there is one; measures are taken together.
    pub fn add(&mut self, other: &Self) {
        for fault in &other.faults {
            match self.faults.iter_mut().find(|known| known.kind == fault.kind) {
                Some(known) => {
                    known.boxes += 1;
                }
                None => self.faults.push(*fault),
            }
        }
        let (one, two) = (self.measures, other.measures);
        let (a, b) = (one.triangles as f64, two.triangles as f64);
        let mean = |x: f64, y: f64| if a + b > 0.0 { (x * a + y * b) / (a + b) } else { 0.0 };
        self.measures = Measures {
            vertices: one.vertices + two.vertices,
            triangles: one.triangles + two.triangles,
            radius_ratio: mean(one.radius_ratio, two.radius_ratio),
            off_cells: mean(one.off_cells, two.off_cells),
        };
    }
}

/// Holds a mesh against the samples that it was made of, and against what is known of the surface. `soup` takes vertices at one place for
/// one first. Triangles that repeat a vertex then have no surface, and are left out.
///
/// # Panics
/// If a triangle's index is out of range, or the values are not as many as the counts say.
pub fn judge(mesh: &TriangleMesh, grid: &Grid, truth: &Truth, ties: Ties, soup: bool) -> Verdict {
    assert_eq!(grid.values.len(), grid.counts.iter().product::<usize>());
    let smallest = grid.spacing.into_iter().fold(f64::INFINITY, f64::min);
    let answered = mesh;
    let mut mesh = if soup { welded(mesh, smallest) } else { mesh.clone() };
    mesh.triangles.retain(|&[a, b, c]| a != b && b != c && c != a);
    let mesh = &mesh;
    let report = topology(mesh);
    let places = Places::of(grid, ties, mesh);
    let fault = |kind, found, expected| Fault { kind, found, expected, boxes: 1 };
    let counts = [
        (Kind::NonManifold, report.non_manifold_edges + report.non_manifold_vertices, 0),
        (Kind::Misoriented, report.misoriented_edges, 0),
        (Kind::Duplicates, report.duplicate_faces, 0),
        (Kind::Boundary, report.boundary_loops, truth.boundary),
        (Kind::Components, report.components, truth.components),
        (Kind::Far, places.far, 0),
        (Kind::Missed, places.missed, 0),
    ];
    let mut faults: Vec<Fault> = counts
        .into_iter()
        .filter(|(_, found, expected)| found != expected)
        .map(|(kind, found, expected)| fault(kind, found as f64, expected as f64))
        .collect();
    if report.euler_characteristic != truth.euler {
        let (found, expected) = (report.euler_characteristic as f64, truth.euler as f64);
        faults.push(fault(Kind::Euler, found, expected));
    }
    if places.facing < 0.0 {
        faults.push(fault(Kind::InsideOut, 1.0, 0.0));
    }
    if places.shift > if grid.is_smooth { MOST_SHIFT } else { MOST_SHIFT_OF_LABELS } {
        faults.push(fault(Kind::Shifted, places.shift, 0.0));
    }
    let off = places.off.max(places.off_of_vertices);
    if grid.is_smooth && off > MOST_OFF {
        faults.push(fault(Kind::Off, off, 0.0));
    }
    for (kind, found, expected) in
        [(Kind::Volume, mesh.volume(), truth.volume), (Kind::Area, mesh.area(), truth.area)]
    {
        if let Some(expected) = expected
            && (found - expected).abs() > truth.within * expected
        {
            faults.push(fault(kind, found, expected));
        }
    }
    // As it was answered: a triangle without area is one too.
    let quality = quality(answered);
    let measures = Measures {
        vertices: report.vertices,
        triangles: answered.triangles.len() as u64,
        radius_ratio: if report.triangles > 0 { quality.radius_ratio.mean } else { 0.0 },
        off_cells: places.off,
    };
    Verdict { faults, measures }
}

/// Where a mesh lies in its grid.
struct Places {
    far: u64,
    missed: u64,
    /// Positive if triangles mostly face falling values.
    facing: f64,
    /// Least squares over vertices of one displacement for all, in cells.
    shift: f64,
    /// The mean distance of the middles of triangles, in cells.
    off: f64,
    /// The same of vertices.
    off_of_vertices: f64,
}

impl Places {
    fn of(grid: &Grid, ties: Ties, mesh: &TriangleMesh) -> Self {
        let size = grid.counts.map(|n| n - 1);
        let cells = size.iter().product();
        let number = |[x, y, z]: [usize; 3]| (z * size[1] + y) * size[0] + x;
        let is_inside = |value: f32| match ties {
            Ties::Outside => value > grid.isovalue,
            Ties::Inside => value >= grid.isovalue,
        };
        let mut crossed = vec![false; cells];
        for z in 0..size[2] {
            for y in 0..size[1] {
                for x in 0..size[0] {
                    let corners =
                        (0..8).filter(|c| is_inside(grid.at([x + (c & 1), y + (c >> 1 & 1), z + (c >> 2)])));
                    crossed[number([x, y, z])] = !matches!(corners.count(), 0 | 8);
                }
            }
        }
        let near_crossed = grown(&crossed, size);
        let mut has_mesh = vec![false; cells];
        let mut far = 0;
        let mut is_used = vec![false; mesh.positions.len()];
        mesh.triangles.iter().flatten().for_each(|&v| is_used[v as usize] = true);
        let (mut normals, mut moved) = (DMat3::ZERO, DVec3::ZERO);
        let (mut off_of_vertices, mut measured) = (0.0, 0u64);
        for (position, _) in mesh.positions.iter().zip(&is_used).filter(|(_, is_used)| **is_used) {
            let place = grid.place(position.as_dvec3());
            let cell = grid.cell(place);
            has_mesh[number(cell)] = true;
            far += u64::from(!near_crossed[number(cell)] || !grid.has(place));
            let (value, gradient) = grid.interpolated(place, cell);
            let slope = gradient.length();
            if slope > 0.0 && slope.is_finite() {
                // Outward, in cells; and how far along it the vertex is beyond the surface.
                let (normal, beyond) = (-gradient / slope, (f64::from(grid.isovalue) - value) / slope);
                // Beyond a cell the first order says nothing.
                let beyond = beyond.clamp(-1.0, 1.0);
                normals += DMat3::from_cols(normal * normal.x, normal * normal.y, normal * normal.z);
                moved += normal * beyond;
                off_of_vertices += beyond.abs();
                measured += 1;
            }
        }
        let (mut facing, mut off, mut area_measured) = (0.0, 0.0, 0.0);
        for t in 0..mesh.triangles.len() {
            let corners = mesh.triangles[t].map(|v| grid.place(mesh.positions[v as usize].as_dvec3()));
            let centre = (corners[0] + corners[1] + corners[2]) / 3.0;
            let cell = grid.cell(centre);
            has_mesh[number(cell)] = true;
            let area = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            let (value, gradient) = grid.interpolated(centre, cell);
            let slope = gradient.length();
            if slope > 0.0 && slope.is_finite() {
                facing += area.dot(-gradient) / slope;
                off += area.length() * ((value - f64::from(grid.isovalue)) / slope).abs().min(1.0);
                area_measured += area.length();
            }
        }
        let reached = grown(&has_mesh, size);
        let missed =
            crossed.iter().zip(&reached).filter(|(crossed, reached)| **crossed && !**reached).count();
        // A little of the identity, so that a plane is moved along its normal alone.
        let count = measured.max(1) as f64;
        let damped = normals / count + DMat3::from_diagonal(DVec3::splat(1e-3));
        let shift = (damped.inverse() * (moved / count)).length();
        let off = if area_measured > 0.0 { off / area_measured } else { 0.0 };
        Self { far, missed: missed as u64, facing, shift, off, off_of_vertices: off_of_vertices / count }
    }
}

/// The mesh with vertices that are at most so far apart as one: each is the first that is near.
pub(crate) fn welded(mesh: &TriangleMesh, spacing: f64) -> TriangleMesh {
    let largest = mesh.positions.iter().map(|p| p.abs().max_element()).fold(0.0, f32::max);
    // Far from the origin, neighbours in single precision are farther apart than that.
    let within = (SAME_PLACE * spacing).max(2.0 * f64::from(largest) * f64::from(f32::EPSILON));
    let mut bins: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
    let mut found = TriangleMesh::default();
    let mut numbers = Vec::with_capacity(mesh.positions.len());
    for &position in &mesh.positions {
        let bin = (position.as_dvec3() / within).floor().to_array().map(|x| x as i64);
        let near = (0..27).find_map(|i: i64| {
            let beside = [bin[0] + i % 3 - 1, bin[1] + i / 3 % 3 - 1, bin[2] + i / 9 - 1];
            let is_near =
                |&&v: &&u32| found.positions[v as usize].as_dvec3().distance(position.as_dvec3()) <= within;
            bins.get(&beside)?.iter().find(is_near).copied()
        });
        numbers.push(near.unwrap_or_else(|| {
            let new = found.positions.len() as u32;
            found.positions.push(position);
            bins.entry(bin).or_default().push(new);
            new
        }));
    }
    found.triangles = mesh.triangles.iter().map(|triangle| triangle.map(|v| numbers[v as usize])).collect();
    found
}

/// The same with all neighbours.
fn grown(of: &[bool], size: [usize; 3]) -> Vec<bool> {
    let mut found = of.to_vec();
    let strides = [1, size[0], size[0] * size[1]];
    for axis in 0..3 {
        let before = found.clone();
        for (i, found) in found.iter_mut().enumerate() {
            let along = i / strides[axis] % size[axis];
            *found |= along > 0 && before[i - strides[axis]];
            *found |= along + 1 < size[axis] && before[i + strides[axis]];
        }
    }
    found
}

impl Grid<'_> {
    fn at(&self, [x, y, z]: [usize; 3]) -> f32 {
        self.values[(z * self.counts[1] + y) * self.counts[0] + x]
    }

    /// In cells from the first sample on.
    fn place(&self, position: DVec3) -> DVec3 {
        (position - DVec3::from_array(self.origin)) / DVec3::from_array(self.spacing)
    }

    /// The cell of a place; the nearest one of a place beyond.
    fn cell(&self, place: DVec3) -> [usize; 3] {
        [0, 1, 2].map(|axis| (place[axis].max(0.0) as usize).min(self.counts[axis] - 2))
    }

    /// Whether a place is in the box, or at most a cell beyond it, where some methods close the surface.
    fn has(&self, place: DVec3) -> bool {
        (0..3).all(|axis| (-1.0..=self.counts[axis] as f64).contains(&place[axis]))
    }

    /// What samples round a cell are interpolated to be, trilinear, and the gradient per cell.
    fn interpolated(&self, place: DVec3, cell: [usize; 3]) -> (f64, DVec3) {
        let share = [0, 1, 2].map(|axis| (place[axis] - cell[axis] as f64).clamp(0.0, 1.0));
        let corner = |c: usize| f64::from(self.at([0, 1, 2].map(|axis| cell[axis] + (c >> axis & 1))));
        let (mut value, mut gradient) = (0.0, DVec3::ZERO);
        for c in 0..8 {
            let weight = |axis: usize| if c >> axis & 1 == 1 { share[axis] } else { 1.0 - share[axis] };
            let [x, y, z] = [weight(0), weight(1), weight(2)];
            let of = corner(c);
            value += of * x * y * z;
            let sign = |axis: usize| if c >> axis & 1 == 1 { of } else { -of };
            gradient += DVec3::new(sign(0) * y * z, sign(1) * x * z, sign(2) * x * y);
        }
        (value, gradient)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isostudy_mesh::glam::Vec3;

    const N: usize = 24;

    /// A ball, its cells cut into six tetrahedra each: an extractor of 40 lines that shares nothing with those that are judged.
    fn ball(at: [f64; 3]) -> (Vec<f32>, TriangleMesh) {
        let centre = DVec3::from_array(at);
        let place = |i: usize| DVec3::new((i % N) as f64, (i / N % N) as f64, (i / N / N) as f64);
        let values: Vec<f32> = (0..N.pow(3)).map(|i| (8.3 - place(i).distance(centre)) as f32).collect();
        let mut mesh = TriangleMesh::default();
        let mut crossings: HashMap<[usize; 2], u32> = HashMap::new();
        let mut vertex = |mesh: &mut TriangleMesh, a: usize, b: usize| {
            let key = [a.min(b), a.max(b)];
            *crossings.entry(key).or_insert_with(|| {
                let [va, vb] = key.map(|i| f64::from(values[i]));
                mesh.positions.push(place(key[0]).lerp(place(key[1]), va / (va - vb)).as_vec3());
                mesh.positions.len() as u32 - 1
            })
        };
        let steps = [1, N, N * N];
        for cell in (0..N.pow(3)).filter(|i| [i % N, i / N % N, i / N / N].iter().all(|&i| i + 1 < N)) {
            for [a, b, c] in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
                let far = cell + steps.iter().sum::<usize>();
                let corners = [cell, cell + steps[a], cell + steps[a] + steps[b], far];
                debug_assert_eq!(corners[2] + steps[c], far);
                let (inside, outside): (Vec<usize>, Vec<usize>) =
                    corners.into_iter().partition(|&corner| values[corner] > 0.0);
                let edges: Vec<(usize, usize)> = match (&inside[..], &outside[..]) {
                    (&[i], &[o, p, q]) => vec![(i, o), (i, p), (i, q)],
                    (&[i, j], &[o, p]) => vec![(i, o), (i, p), (j, p), (j, o)],
                    (&[i, j, k], &[o]) => vec![(i, o), (j, o), (k, o)],
                    _ => continue,
                };
                let polygon: Vec<u32> = edges.iter().map(|&(i, o)| vertex(&mut mesh, i, o)).collect();
                // By the middles of edges, since where the crossings are the polygon may have next to no area.
                let middle = |&(i, o): &(usize, usize)| place(i).midpoint(place(o));
                let p: Vec<DVec3> = edges.iter().map(middle).collect();
                let mean = |of: &[usize]| of.iter().map(|&i| place(i)).sum::<DVec3>() / of.len() as f64;
                let area: DVec3 = (1..p.len() - 1).map(|t| (p[t] - p[0]).cross(p[t + 1] - p[0])).sum();
                let is_outward = area.dot(mean(&outside) - mean(&inside)) > 0.0;
                for t in 1..polygon.len() - 1 {
                    let [u, v, w] = [polygon[0], polygon[t], polygon[t + 1]];
                    mesh.triangles.push(if is_outward { [u, v, w] } else { [u, w, v] });
                }
            }
        }
        (values, mesh)
    }

    const TRUTH: Truth =
        Truth { components: 1, euler: 2, boundary: 0, volume: Some(2395.0), area: Some(865.7), within: 0.03 };

    fn kinds(mesh: &TriangleMesh, soup: bool) -> Vec<Kind> {
        let (values, _) = ball([11.4, 11.7, 11.2]);
        let grid = Grid {
            counts: [N; 3],
            origin: [0.0; 3],
            spacing: [1.0; 3],
            values: &values,
            isovalue: 0.0,
            is_smooth: true,
        };
        let verdict = judge(mesh, &grid, &TRUTH, Ties::Outside, soup);
        verdict.faults.iter().map(|fault| fault.kind).collect()
    }

    fn right() -> TriangleMesh {
        ball([11.4, 11.7, 11.2]).1
    }

    #[test]
    fn a_right_mesh_has_no_fault() {
        assert_eq!(kinds(&right(), false), []);
    }

    #[test]
    fn a_lost_triangle_is_found() {
        let mut mesh = right();
        mesh.triangles.remove(77);
        assert!(kinds(&mesh, false).contains(&Kind::Boundary));
    }

    #[test]
    fn one_flipped_case_is_found() {
        let mut mesh = right();
        mesh.triangles[5].swap(0, 1);
        assert!(kinds(&mesh, false).contains(&Kind::Misoriented));
        let mut mesh = right();
        mesh.triangles.iter_mut().for_each(|triangle| triangle.swap(0, 1));
        assert!(kinds(&mesh, false).contains(&Kind::InsideOut));
    }

    #[test]
    fn an_open_seam_is_found() {
        // East of a plane, vertices of their own.
        let mut mesh = right();
        let east = |mesh: &TriangleMesh, v: u32| mesh.positions[v as usize].x > 12.0;
        let mut own: HashMap<u32, u32> = HashMap::new();
        for t in 0..mesh.triangles.len() {
            if mesh.triangles[t].iter().all(|&v| east(&mesh, v)) {
                for corner in 0..3 {
                    let v = mesh.triangles[t][corner];
                    let new = *own.entry(v).or_insert_with(|| {
                        mesh.positions.push(mesh.positions[v as usize]);
                        mesh.positions.len() as u32 - 1
                    });
                    mesh.triangles[t][corner] = new;
                }
            }
        }
        assert!(kinds(&mesh, false).contains(&Kind::Boundary));
        // As soup it is closed: places are the same.
        assert_eq!(kinds(&mesh, true), []);
    }

    #[test]
    fn half_a_cell_of_displacement_is_found() {
        for by in [[0.5, 0.0, 0.0], [0.0, -0.5, 0.0], [0.3, 0.3, 0.3]] {
            let mut mesh = right();
            mesh.positions.iter_mut().for_each(|p| *p += Vec3::from_array(by));
            assert!(kinds(&mesh, false).contains(&Kind::Shifted), "{by:?}");
        }
        let mut mesh = right();
        mesh.positions.iter_mut().for_each(|p| *p += Vec3::splat(4.0));
        assert!(kinds(&mesh, false).contains(&Kind::Far));
    }

    /// Still a ball, of the right topology: vertices by chance half a cell off, or all of them outward.
    #[test]
    fn vertices_off_the_surface_are_found() {
        let mut mesh = right();
        for (v, p) in mesh.positions.iter_mut().enumerate() {
            let by = |axis: usize| ((v * 37 + axis * 11) % 19) as f32 / 9.0 - 1.0;
            *p += 0.6 * Vec3::new(by(0), by(1), by(2));
        }
        assert!(kinds(&mesh, false).contains(&Kind::Off));
        let mut mesh = right();
        let centre = Vec3::new(11.4, 11.7, 11.2);
        mesh.positions.iter_mut().for_each(|p| *p += 0.5 * (*p - centre).normalize());
        assert!(kinds(&mesh, false).contains(&Kind::Off));
        let mut mesh = right();
        let outward = (mesh.positions[3] - centre).normalize();
        mesh.positions[3] += 3.0 * outward;
        assert_eq!(kinds(&mesh, false), [Kind::Far]);
    }

    #[test]
    fn a_wrong_size_and_exchanged_axes_are_found() {
        let mut mesh = right();
        mesh.positions.iter_mut().for_each(|p| *p = (*p - 11.4) * 0.97 + 11.4);
        assert!(kinds(&mesh, false).contains(&Kind::Volume));
        let mut mesh = right();
        mesh.positions.iter_mut().for_each(|p| p.z *= 0.5);
        assert!(kinds(&mesh, false).contains(&Kind::Missed));
        assert!(kinds(&TriangleMesh::default(), false).contains(&Kind::Missed));
    }

    #[test]
    fn soup_is_welded_by_place() {
        let mesh = right();
        let mut soup = TriangleMesh::default();
        for triangle in &mesh.triangles {
            let first = soup.positions.len() as u32;
            // As another cell rounds it.
            let nudge = Vec3::splat((first % 2) as f32 * 1e-6);
            soup.positions.extend(triangle.map(|v| mesh.positions[v as usize] + nudge));
            soup.triangles.push([first, first + 1, first + 2]);
        }
        assert!(kinds(&soup, false).contains(&Kind::Components));
        assert_eq!(kinds(&soup, true), []);
    }
}
