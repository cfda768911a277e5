//! `isostudy extract` by dual contouring: what has edges keeps them, and what is rough gets no spikes.

use crate::command::Folder;
use glam::{DMat3, DVec3, EulerRot};
use isostudy_mesh::TriangleMesh;
use isostudy_mesh::topology::topology;

/// The mesh that was written last.
fn made(folder: &Folder) -> TriangleMesh {
    isostudy_mesh::read_ply(&*std::fs::read(folder.path("made.ply")).unwrap()).unwrap()
}

/// The spacing of the grids on which turned boxes are extracted.
const TURNED_SPACING: f64 = 2.2 / 40.0;

/// A box about the origin that no axis is parallel to.
struct TurnedBox {
    turned: DMat3,
    half: DVec3,
}

impl TurnedBox {
    fn numbered(turn: i32) -> Self {
        let angle = 0.37 + 0.71 * f64::from(turn);
        let turned = DMat3::from_euler(EulerRot::ZYX, angle, 0.6 * angle, 1.3 * angle);
        Self { turned, half: DVec3::new(0.43, 0.52 + 0.01 * f64::from(turn), 0.58) }
    }

    /// Negative inside.
    fn formula(&self) -> String {
        let side = |axis: usize| {
            let n = self.turned.col(axis);
            format!("abs(({:.9})*x + ({:.9})*y + ({:.9})*z) - {:.9}", n.x, n.y, n.z, self.half[axis])
        };
        format!("max({}, {}, {})", side(0), side(1), side(2))
    }

    /// By the signs of its place along the sides, one bit each.
    fn corner(&self, c: usize) -> DVec3 {
        let sign = |axis: usize| if c >> axis & 1 != 0 { 1.0 } else { -1.0 };
        self.turned * (self.half * DVec3::new(sign(0), sign(1), sign(2)))
    }

    fn as_mesh(&self) -> TriangleMesh {
        let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        TriangleMesh {
            positions: (0..8).map(|c| self.corner(c).as_vec3()).collect(),
            normals: Vec::new(),
            triangles: sides.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
        }
    }

    /// The farthest point of a mesh from the box, of a grid of points in each triangle; in cells.
    fn farthest(&self, mesh: &TriangleMesh) -> f64 {
        let distance = |p: DVec3| {
            let q = (self.turned.transpose() * p).abs() - self.half;
            (q.max(DVec3::ZERO).length() + q.max_element().min(0.0)).abs() / TURNED_SPACING
        };
        let points = mesh.triangles.iter().flat_map(|t| {
            let [a, b, c] = t.map(|v| mesh.positions[v as usize].as_dvec3());
            let at = move |i: i32, j: i32| a + (b - a) * f64::from(i) / 4.0 + (c - a) * f64::from(j) / 4.0;
            (0..=4).flat_map(move |i| (0..=4 - i).map(move |j| at(i, j)))
        });
        points.map(distance).fold(0.0, f64::max)
    }

    /// How far the nearest vertex is from the corner that is missed most; in cells.
    fn missed(&self, mesh: &TriangleMesh) -> f64 {
        let to = |corner: DVec3| {
            let each = mesh.positions.iter().map(|p| p.as_dvec3().distance(corner) / TURNED_SPACING);
            each.fold(f64::INFINITY, f64::min)
        };
        (0..8).map(|c| to(self.corner(c))).fold(0.0, f64::max)
    }

    /// The mean distance from points of the twelve edges, evenly by length, to a mesh; in cells. Every triangle is tried that could be nearer.
    fn edges_to(&self, mesh: &TriangleMesh) -> f64 {
        let (mut sum, mut count) = (0.0, 0);
        // Each triangle with a ball round it: what lies farther than the best so far is not looked at.
        let triangles: Vec<_> = mesh
            .triangles
            .iter()
            .map(|t| {
                let of = t.map(|v| mesh.positions[v as usize].as_dvec3());
                let centre = (of[0] + of[1] + of[2]) / 3.0;
                (centre, of.map(|p| p.distance(centre)).into_iter().fold(0.0, f64::max), of)
            })
            .collect();
        for (c, axis) in
            (0..8).flat_map(|c| (0..3).map(move |axis| (c, axis))).filter(|(c, axis)| c >> axis & 1 == 0)
        {
            let (from, to) = (self.corner(c), self.corner(c | 1 << axis));
            let points = (from.distance(to) / (0.1 * TURNED_SPACING)) as usize;
            for i in 0..points {
                let p = from.lerp(to, (i as f64 + 0.5) / points as f64);
                let mut best = f64::INFINITY;
                for (centre, radius, of) in &triangles {
                    if (best + radius).is_infinite() || p.distance_squared(*centre) < (best + radius).powi(2)
                    {
                        best = best.min(to_triangle(p, *of));
                    }
                }
                sum += best;
            }
            count += points;
        }
        sum / count as f64 / TURNED_SPACING
    }

    fn extracted(folder: &Folder, source: [&str; 2], method: &str) -> TriangleMesh {
        let bounds = "--bounds=-1.1,-1.1,-1.1,1.1,1.1,1.1";
        let [name, value] = source;
        folder.succeed(&[name, value, bounds, "--cells", "40", "--method", method, "-o", "made.ply"]);
        made(folder)
    }
}

/// The distance from a point to a triangle: to its plane if it is over it, else to the nearest of its sides.
fn to_triangle(p: DVec3, corners: [DVec3; 3]) -> f64 {
    let [a, b, c] = corners;
    let normal = (b - a).cross(c - a);
    let sides = [(a, b), (b, c), (c, a)];
    if sides.iter().all(|(from, to)| normal.cross(*to - *from).dot(p - *from) >= 0.0) && normal.length() > 0.0
    {
        return (normal.dot(p - a) / normal.length()).abs();
    }
    let to_side = |(from, to): (DVec3, DVec3)| {
        let way = to - from;
        let share = ((p - from).dot(way) / way.length_squared()).clamp(0.0, 1.0);
        p.distance(from + way * if share.is_nan() { 0.0 } else { share })
    };
    sides.into_iter().map(to_side).fold(f64::INFINITY, f64::min)
}

/// A box is planted as a formula and as a mesh; what `--json` says of its sharp edges is what brute force says of the file that was
/// written.
#[test]
fn distances_from_sharp_edges_are_those_of_the_box() {
    let folder = Folder::of("extract");
    for turn in 0..2 {
        let wanted = TurnedBox::numbered(turn);
        let mut bytes = Vec::new();
        isostudy_mesh::write_ply(&wanted.as_mesh(), &mut bytes).unwrap();
        folder.write("box.ply", bytes);
        for source in [["--field", &*wanted.formula()], ["--mesh", "box.ply"]] {
            for method in ["mc", "dc", "bi"] {
                let [name, value] = source;
                let bounds = "--bounds=-1.1,-1.1,-1.1,1.1,1.1,1.1";
                let asked =
                    [name, value, bounds, "--cells", "40", "--method", method, "--json", "-o", "made.ply"];
                let said: serde_json::Value = serde_json::from_str(&folder.succeed(&asked).stdout).unwrap();
                let said = said["accuracy"]["sharp_edges"]["mean"].as_f64().unwrap() / TURNED_SPACING;
                let want = wanted.edges_to(&made(&folder));
                assert_eq!(method == "dc", want < 0.005, "{name} {turn} {method}: {want}");
                assert!(
                    (said - want).abs() < 0.05 * want + 0.002,
                    "{name} {turn} {method}: {said} is not {want}"
                );
            }
        }
    }
}

/// Turned boxes, as formulas and as meshes: every point of the files that come out is on the box, its corners are there, and a net of the
/// same cubes cuts them off.
#[test]
fn dual_contouring_keeps_the_edges_of_formulas_and_meshes() {
    let folder = Folder::of("extract");
    for turn in 0..6 {
        let wanted = TurnedBox::numbered(turn);
        let formula = wanted.formula();
        let mut bytes = Vec::new();
        isostudy_mesh::write_ply(&wanted.as_mesh(), &mut bytes).unwrap();
        folder.write("box.ply", bytes);
        for source in [["--field", &*formula], ["--mesh", "box.ply"]] {
            let name = source[0];
            for method in ["dc", "dc-manifold"] {
                let edges = TurnedBox::extracted(&folder, source, method);
                let found = topology(&edges);
                assert_eq!(found.boundary_edges, 0, "{name} {turn} {method}");
                assert!(found.is_closed_manifold() || method == "dc", "{name} {turn} {method}: {found:?}");
                let [farthest, missed] = [wanted.farthest(&edges), wanted.missed(&edges)];
                assert!(farthest < 0.01, "{name} {turn} {method}: {farthest} cells");
                assert!(missed < 0.005, "{name} {turn} {method}: {missed} cells");
            }
            let net = TurnedBox::extracted(&folder, source, "nets");
            assert!(wanted.farthest(&net) > 0.2, "{name} {turn}: {} cells", wanted.farthest(&net));
        }
    }
}

/// Planes of rough ground meet anywhere. The vertices of a net are in their cubes, and those of dual contouring are the same ones
/// elsewhere: no farther than the length of an edge from the cube, so less than two from the net's, and in the cube if asked.
#[test]
fn rough_ground_has_no_spikes() {
    let folder = Folder::of("extract");
    let spacing = 0.05;
    let ground = "-1.4*z - 0.35 - 0.5*fbm(x*1.5, y*1.5, 0.3, 4)";
    let extracted = |recipe: &str| {
        folder.succeed(&[
            "--field",
            ground,
            "--inside",
            "above",
            "--bounds=-1,-1,-0.5,1,1,0.5",
            "--spacing",
            "0.05",
            "--recipe",
            recipe,
            "-o",
            "made.ply",
        ]);
        made(&folder)
    };
    let net = extracted("{ kind = \"surface-nets\" }");
    let farthest = |mesh: &TriangleMesh| {
        assert_eq!(mesh.positions.len(), net.positions.len());
        let apart =
            mesh.positions.iter().zip(&net.positions).map(|(a, b)| (*a - *b).abs().max_element() / spacing);
        apart.fold(0.0, f32::max)
    };
    let sharp = farthest(&extracted("{ kind = \"dual-contouring\" }"));
    assert!(sharp > 1.0 && sharp < 2.0 + 1e-4, "{sharp}");
    let kept = farthest(&extracted("{ kind = \"dual-contouring\", in_cell = true }"));
    assert!(kept > 0.1 && kept < 1.0 + 1e-4, "{kept}");
}
