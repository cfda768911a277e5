//! Edges collapsed, those first that change the surface least.
//!
//! Garland and Heckbert, *Surface Simplification Using Quadric Error Metrics*, SIGGRAPH 1997, with quadrics weighted by area and a
//! plane through every border edge. Beyond the paper, a collapse must leave the topology as it is, and fold no triangle.

use crate::outcome::{Finished, Stopped};
use crate::quadric::Quadric;
use crate::surface::{Surface, VertexKind};
use isostudy_mesh::TriangleMesh;
use isostudy_mesh::glam::{DVec3, Vec3};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Where decimation ends.
pub(crate) struct Decimate {
    /// Triangles to be left at most.
    pub(crate) triangles: Option<usize>,
    /// See [`crate::Step::Decimate`].
    pub(crate) error: Option<f64>,
    /// Whether vertices of borders stay where they are.
    pub(crate) lock_borders: bool,
}

/// How many times as much as the surface the plane through a border counts.
const BORDER_WEIGHT: f64 = 10.0;
/// Refused edges are tried again after one part of so many of the triangles has gone.
const RETRIED: usize = 8;
/// Where planes lie closer than this share of an edge's length, rounding would draw lots: there, shorter edges go first. Without it
/// flat ground has hubs and slivers, and most of the time goes into collapses that would fold them.
const FLATNESS: f64 = 1e-4;
/// The least cosine between a triangle's normals before and after.
const LEAST_COSINE: f64 = 0.2;
/// The least `4 sqrt(3) area / sum of squared edges` of a triangle that was better before.
const LEAST_SHAPE: f64 = 0.02;

impl Decimate {
    /// The mesh with as few triangles as asked for, or with as few as may be without exceeding the error. Topology stays: components,
    /// genus, borders and faults are what they were. Vertices at faults stay where they are.
    pub(crate) fn run(&self, mesh: &TriangleMesh) -> Finished {
        let goal = self.triangles.unwrap_or(0);
        let mut pass = Pass::of(mesh, self);
        // What was refused may go once its neighbours have changed.
        while pass.surface.triangle_count() > goal {
            pass.fill();
            if pass.collapse_until(goal) == 0 {
                break;
            }
        }
        let is_short = self.error.is_none() && pass.surface.triangle_count() > goal;
        let stopped = is_short.then(|| Stopped {
            step: "decimate",
            left: (pass.surface.triangle_count() - goal) as u64,
            what: "triangles too many",
            at: pass.surface.positions[pass.surface.first_alive()[0] as usize],
        });
        Finished { mesh: pass.surface.into_mesh(), stopped: stopped.into_iter().collect() }
    }
}

/// An edge whose collapse has this cost, unless one of its ends has changed since.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Candidate {
    /// The bits of a number from 0, which are ordered as such numbers are.
    cost: u64,
    edge: [u32; 2],
    changes: [u32; 2],
}

struct Pass<'a> {
    settings: &'a Decimate,
    surface: Surface,
    /// Coordinates are taken from here, for the precision of sums.
    origin: DVec3,
    quadrics: Vec<Quadric>,
    kinds: Vec<VertexKind>,
    /// How often a vertex has changed.
    changes: Vec<u32>,
    heap: BinaryHeap<Reverse<Candidate>>,
    around: Vec<u32>,
    scratch: [Vec<u32>; 2],
}

impl<'a> Pass<'a> {
    fn of(mesh: &TriangleMesh, settings: &'a Decimate) -> Self {
        let surface = Surface::of(mesh);
        let bounds = mesh.surface_bounds();
        let origin = bounds.map_or(DVec3::ZERO, |of| 0.5 * (of.min.as_dvec3() + of.max.as_dvec3()));
        let kinds = surface.kinds();
        let count = mesh.positions.len();
        let mut pass = Self {
            settings,
            surface,
            origin,
            quadrics: vec![Quadric::default(); count],
            kinds,
            changes: vec![0; count],
            heap: BinaryHeap::new(),
            around: Vec::new(),
            scratch: [Vec::new(), Vec::new()],
        };
        for t in 0..pass.surface.triangles.len() as u32 {
            pass.add_planes(t);
        }
        pass
    }

    /// Adds the plane of a triangle to its corners, and to those of its border edges the plane that stands on it there.
    fn add_planes(&mut self, t: u32) {
        let corners = self.surface.triangles[t as usize];
        let places = self.surface.corners(t).map(|p| p - self.origin);
        let area_vector = self.surface.area_vector(t);
        let Some(normal) = area_vector.try_normalize() else { return };
        let area = 0.5 * area_vector.length();
        let plane = Quadric::of_plane(normal, places[0], area, area);
        for v in corners {
            self.quadrics[v as usize] = self.quadrics[v as usize].plus(&plane);
        }
        for k in 0..3 {
            let [u, v] = [corners[k], corners[(k + 1) % 3]];
            let is_border = self.surface.triangles_of_edge(u, v).count() == 1;
            let along = places[(k + 1) % 3] - places[k];
            let Some(across) = along.cross(normal).try_normalize().filter(|_| is_border) else { continue };
            let weight = BORDER_WEIGHT * along.length_squared();
            let plane = Quadric::of_plane(across, places[k], weight, 0.0);
            for v in [u, v] {
                self.quadrics[v as usize] = self.quadrics[v as usize].plus(&plane);
            }
        }
    }

    /// Puts all edges into the heap.
    fn fill(&mut self) {
        let mut edges = Vec::new();
        for (t, &corners) in (0..).zip(&self.surface.triangles) {
            if self.surface.is_alive(t) {
                edges.extend([0, 1, 2].map(|k| ordered(corners[k], corners[(k + 1) % 3])));
            }
        }
        edges.sort_unstable();
        edges.dedup();
        let candidates = edges.into_iter().filter_map(|edge| self.candidate(edge)).map(Reverse);
        self.heap = candidates.collect::<Vec<_>>().into();
    }

    fn is_locked(&self, v: u32) -> bool {
        match self.kinds[v as usize] {
            VertexKind::Singular | VertexKind::Unused => true,
            VertexKind::Border => self.settings.lock_borders,
            VertexKind::Inner => false,
        }
    }

    /// An edge with its cost; `None` if it may never be collapsed.
    fn candidate(&self, edge: [u32; 2]) -> Option<Candidate> {
        let is_singular = |v: u32| self.kinds[v as usize] == VertexKind::Singular;
        if edge.iter().any(|&v| is_singular(v)) || edge.iter().all(|&v| self.is_locked(v)) {
            return None;
        }
        let (place, quadric) = self.place(edge);
        let p = place.as_dvec3() - self.origin;
        if self.settings.error.is_some_and(|error| quadric.distance_at(p) > error) {
            return None;
        }
        let changes = edge.map(|v| self.changes[v as usize]);
        let [a, b] = edge.map(|v| self.surface.position(v));
        let cost = quadric.at(p) + FLATNESS * FLATNESS * quadric.area() * a.distance_squared(b);
        Some(Candidate { cost: cost.to_bits(), edge, changes })
    }

    /// Where the vertex lies that an edge is collapsed to.
    fn place(&self, edge: [u32; 2]) -> (Vec3, Quadric) {
        let [u, v] = edge;
        let quadric = self.quadrics[u as usize].plus(&self.quadrics[v as usize]);
        let [p, q] = edge.map(|v| self.surface.positions[v as usize]);
        if self.is_locked(u) {
            return (p, quadric);
        }
        if self.is_locked(v) {
            return (q, quadric);
        }
        // Off a border the surface must not draw its edge inwards.
        let on_border = |v: u32| self.kinds[v as usize] == VertexKind::Border;
        let near = match (on_border(u), on_border(v)) {
            (true, false) => p.as_dvec3(),
            (false, true) => q.as_dvec3(),
            _ => 0.5 * (p.as_dvec3() + q.as_dvec3()),
        };
        ((quadric.minimum(near - self.origin) + self.origin).as_vec3(), quadric)
    }

    /// Collapses edges until so few triangles are left, or no edge is. Returns how many were. What is refused is tried again each time
    /// an eighth of the triangles has gone, and when nothing else is left, for its neighbours may have changed.
    fn collapse_until(&mut self, goal: usize) -> usize {
        let mut collapsed = 0;
        let mut refused = Vec::new();
        let mut again_below = self.surface.triangle_count() / RETRIED * (RETRIED - 1);
        let mut collapsed_before = 0;
        while self.surface.triangle_count() > goal {
            if self.surface.triangle_count() < again_below {
                again_below = self.surface.triangle_count() / RETRIED * (RETRIED - 1);
                self.heap.extend(refused.drain(..));
            }
            let Some(Reverse(candidate)) = self.heap.pop() else {
                if collapsed == collapsed_before {
                    break;
                }
                collapsed_before = collapsed;
                self.heap.extend(refused.drain(..));
                continue;
            };
            let Candidate { edge, changes, .. } = candidate;
            if edge.map(|v| self.changes[v as usize]) != changes {
                continue;
            }
            let (place, quadric) = self.place(edge);
            if self.surface.may_collapse(edge[0], edge[1], &self.kinds, &mut self.scratch)
                && self.folds_none(edge, place)
            {
                self.collapse(edge, place, quadric);
                collapsed += 1;
            } else {
                refused.push(Reverse(candidate));
            }
        }
        collapsed
    }

    /// Whether the triangles that stay keep their side and some shape.
    fn folds_none(&self, [u, v]: [u32; 2], place: Vec3) -> bool {
        let to = place.as_dvec3();
        let stays = |moved: u32, other: u32| {
            self.surface.triangles_at(moved).all(|(t, _)| {
                let corners = self.surface.triangles[t as usize];
                if corners.contains(&other) {
                    return true;
                }
                let (before, after) =
                    (self.surface.area_vector(t), self.surface.area_vector_with(t, moved, to));
                let lengths = before.length() * after.length();
                // What had no area but that of rounding had no side.
                if is_rounding(self.surface.corners(t), before) {
                    return true;
                }
                if before.dot(after) <= LEAST_COSINE * lengths {
                    return false;
                }
                let shape =
                    shape(corners.map(|w| if w == moved { to } else { self.surface.position(w) }), after);
                shape >= LEAST_SHAPE || shape >= self::shape(self.surface.corners(t), before)
            })
        };
        stays(u, v) && stays(v, u)
    }

    fn collapse(&mut self, edge: [u32; 2], place: Vec3, quadric: Quadric) {
        // What is locked keeps its number too.
        let [u, v] = if self.is_locked(edge[1]) { [edge[1], edge[0]] } else { edge };
        self.surface.collapse(u, v, place);
        self.quadrics[u as usize] = quadric;
        if self.kinds[v as usize] == VertexKind::Border {
            self.kinds[u as usize] = VertexKind::Border;
        }
        self.kinds[v as usize] = VertexKind::Unused;
        self.changes[u as usize] += 1;
        self.changes[v as usize] += 1;
        let mut around = std::mem::take(&mut self.around);
        self.surface.neighbours(u, &mut around);
        for &w in &around {
            self.heap.extend(self.candidate(ordered(u, w)).map(Reverse));
        }
        self.around = around;
    }
}

/// Whether a triangle is no higher than single precision lets its corners lie off their places.
fn is_rounding(corners: [DVec3; 3], area_vector: DVec3) -> bool {
    let [a, b, c] = corners;
    let farthest = corners.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
    area_vector.length() <= 4.0 * f64::from(f32::EPSILON) * farthest * longest
}

/// `4 sqrt(3) area / sum of squared edges`: 1 of an equilateral triangle, 0 without area.
pub(crate) fn shape([a, b, c]: [DVec3; 3], area_vector: DVec3) -> f64 {
    let squares = a.distance_squared(b) + b.distance_squared(c) + c.distance_squared(a);
    if squares > 0.0 { 2.0 * 3f64.sqrt() * area_vector.length() / squares } else { 0.0 }
}

fn ordered(u: u32, v: u32) -> [u32; 2] {
    [u.min(v), u.max(v)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::{cube, icosphere, sheet, torus};
    use isostudy_mesh::metro::{Amount, Sampling, metro};
    use isostudy_mesh::quality::quality;
    use isostudy_mesh::topology::topology;

    fn to(triangles: usize) -> Decimate {
        Decimate { triangles: Some(triangles), error: None, lock_borders: false }
    }

    fn within(error: f64) -> Decimate {
        Decimate { triangles: None, error: Some(error), lock_borders: false }
    }

    fn hausdorff(a: &TriangleMesh, b: &TriangleMesh) -> f64 {
        metro(a, b, &Sampling { amount: Amount::Samples(20_000), seed: 1 }).unwrap().hausdorff()
    }

    #[test]
    fn a_cube_becomes_twelve_triangles_with_its_corners() {
        let found = to(12).run(&cube(8));
        assert_eq!(found.stopped, []);
        assert_eq!((found.mesh.positions.len(), found.mesh.triangles.len()), (8, 12));
        assert!(topology(&found.mesh).is_closed_manifold());
        for p in &found.mesh.positions {
            assert!(p.to_array().iter().all(|c| c.abs().min((c - 1.0).abs()) < 1e-5), "{p}");
        }
        assert!((found.mesh.volume() - 1.0).abs() < 1e-5);
        // No error is enough for it as well.
        assert_eq!(within(1e-6).run(&cube(8)).mesh.triangles.len(), 12);
    }

    #[test]
    fn a_budget_is_met_and_topology_stays() {
        for (mesh, budgets) in [(icosphere(4), [1024, 200, 50, 4]), (torus(0.4, 60, 24), [1440, 300, 80, 30])]
        {
            let before = topology(&mesh);
            let mut errors = Vec::new();
            for budget in budgets {
                let found = to(budget).run(&mesh).mesh;
                let after = topology(&found);
                assert!(found.triangles.len() <= budget && found.triangles.len() >= budget - 1, "{budget}");
                assert!(after.is_closed_manifold());
                assert_eq!(after.euler_characteristic, before.euler_characteristic);
                assert_eq!(after.components, 1);
                errors.push(hausdorff(&found, &mesh));
            }
            assert!(
                errors.windows(2).all(|pair| pair[0] < pair[1]),
                "fewer triangles, more error: {errors:?}"
            );
        }
    }

    /// No cost tells edges of a flat sheet apart: short ones go first, so that no vertex becomes a hub.
    #[test]
    fn flat_ground_keeps_round_triangles() {
        let mut flat = sheet(60);
        flat.positions
            .iter_mut()
            .for_each(|p| *p = Vec3::new(0.8 * p.x - 0.6 * p.y, 0.6 * p.x + 0.8 * p.y, 0.3));
        let found = to(flat.triangles.len() / 4).run(&flat).mesh;
        let mut around = vec![0; found.positions.len()];
        found.triangles.iter().flatten().for_each(|&v| around[v as usize] += 1);
        assert!(around.iter().all(|&count| count <= 16), "{:?}", around.iter().max());
        assert!(quality(&found).radius_ratio.mean > 0.7, "{}", quality(&found).radius_ratio.mean);
    }

    #[test]
    fn fewer_than_the_topology_needs_is_not_reached() {
        // A torus needs seven vertices and fourteen triangles (Moebius and Csaszar).
        let found = to(4).run(&torus(0.4, 24, 12));
        let after = topology(&found.mesh);
        assert!(after.is_closed_manifold() && after.euler_characteristic == 0);
        let [stopped] = found.stopped[..] else { panic!("four are too few") };
        assert_eq!(stopped.left, found.mesh.triangles.len() as u64 - 4);
        assert!(found.mesh.triangles.len() >= 14);
    }

    #[test]
    fn a_sphere_is_approximated_to_second_order() {
        // A sphere of n equal triangles of area 4 pi / n has a sagitta of e^2 / 6 where e^2 = 4 / sqrt 3 of that area: 4.84 / n.
        let mesh = icosphere(6);
        for budget in [512, 2048] {
            let found = to(budget).run(&mesh).mesh;
            let error = hausdorff(&found, &mesh) * budget as f64 / 4.84;
            assert!(error < 2.5, "{error} of the error of equal triangles");
            assert!(quality(&found).radius_ratio.mean > 0.8);
        }
    }

    #[test]
    fn more_error_leaves_fewer_triangles() {
        let mesh = icosphere(5);
        let mut last = mesh.triangles.len();
        for error in [3e-4, 1e-3, 1e-2] {
            let found = within(error).run(&mesh);
            assert_eq!(found.stopped, [], "an error is no budget");
            assert!(found.mesh.triangles.len() < last);
            // A root mean square over planes; the largest distance is a small multiple.
            assert!(hausdorff(&found.mesh, &mesh) < 6.0 * error);
            last = found.mesh.triangles.len();
        }
    }

    #[test]
    fn borders_stay_where_they_are_or_keep_their_line() {
        let mut bumpy = sheet(20);
        for p in &mut bumpy.positions {
            p.z = 0.1 * (9.0 * p.x).sin() * (7.0 * p.y).cos();
        }
        let is_border = |p: &Vec3| [p.x, p.y].iter().any(|c| *c == 0.0 || *c == 1.0);
        let before: Vec<Vec3> = bumpy.positions.iter().copied().filter(is_border).collect();
        let locked = Decimate { triangles: Some(200), error: None, lock_borders: true }.run(&bumpy).mesh;
        let after: Vec<Vec3> = locked.positions.iter().copied().filter(is_border).collect();
        assert_eq!(after, before);
        assert!(locked.triangles.len() <= 200);
        let free = to(60).run(&sheet(20)).mesh;
        assert!((free.area() - 1.0).abs() < 1e-5, "a square stays a square: {}", free.area());
        assert_eq!(topology(&free).boundary_loops, 1);
        assert_eq!(to(2).run(&sheet(20)).mesh.positions.len(), 4);
    }

    #[test]
    fn chunks_fit_each_other_afterwards() {
        let whole = icosphere(4);
        let part = |is_upper: bool| TriangleMesh {
            triangles: (0..whole.triangles.len())
                .filter(|&t| (whole.corners(t).iter().map(|p| p.z).sum::<f32>() > 0.0) == is_upper)
                .map(|t| whole.triangles[t])
                .collect(),
            ..whole.clone()
        };
        let of_chunks = [true, false].map(|is_upper| {
            Decimate { triangles: Some(300), error: None, lock_borders: true }.run(&part(is_upper)).mesh
        });
        let mut both = of_chunks[0].clone();
        let first = both.positions.len() as u32;
        both.positions.extend(&of_chunks[1].positions);
        both.triangles.extend(of_chunks[1].triangles.iter().map(|t| t.map(|v| first + v)));
        let welded = isostudy_mesh::weld(&both);
        assert!(topology(&welded).is_closed_manifold());
        assert!(welded.triangles.len() <= 600);
    }

    #[test]
    fn faults_stay_and_do_not_spread() {
        // Two spheres that touch in a vertex, and one with a fin.
        let sphere = icosphere(3);
        let mut touching = sphere.clone();
        let first = touching.positions.len() as u32;
        touching.positions.extend(sphere.positions.iter().map(|&p| p + 2.0 * Vec3::X));
        touching.triangles.extend(sphere.triangles.iter().map(|t| t.map(|v| first + v)));
        let mut touching = isostudy_mesh::weld(&touching);
        let [a, b, _] = touching.triangles[5];
        touching.positions.push(Vec3::splat(3.0));
        touching.triangles.push([a, b, touching.positions.len() as u32 - 1]);
        let (before, found) = (topology(&touching), to(100).run(&touching).mesh);
        let after = topology(&found);
        assert_eq!(before.non_manifold_vertices, 1);
        assert_eq!(before.non_manifold_edges, 1);
        let kept = |of: &isostudy_mesh::topology::TopologyReport| {
            let faults = [of.non_manifold_vertices, of.non_manifold_edges, of.boundary_edges];
            (faults, of.components, of.euler_characteristic)
        };
        assert_eq!(kept(&after), kept(&before));
        assert!(found.triangles.len() <= 100);
    }

    #[test]
    fn no_triangle_turns_over() {
        let found = to(500).run(&icosphere(5)).mesh;
        for t in 0..found.triangles.len() {
            let [a, b, c] = found.corners(t);
            assert!((b - a).cross(c - a).dot(a + b + c) > 0.0, "triangle {t} faces inwards");
        }
    }
}
