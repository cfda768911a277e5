//! Distances against an oracle that knows nothing of fields: points of the analytic surface itself, and the nearest of all triangles.

use glam::{DMat3, DVec3, Vec3};
use isostudy_extract::{
    Arrangement, BoxGrid, Clustering, Cubes, DualContouring, Execution, Extractor, IsosurfacePoints, Method,
    Placement, Source, SurfaceNets, Tetrahedra, accuracy_beside, distances,
};
use isostudy_field::{Fractal, NoiseShape, StudyField, Terrain, TerrainCharacter, TerrainSettings};
use isostudy_mesh::metro::{Amount, AreaSamples, Sampling, Surface};
use isostudy_mesh::{Bounds, TriangleMesh};

const THREADS: Execution = Execution { threads: 2 };

/// A solid between planes, of which some cut others out, and perhaps within a cone.
struct Solid {
    name: &'static str,
    /// Unit normal `n` and place `d`: `n . p = d`.
    planes: Vec<(DVec3, f64)>,
    /// Half the opening, along +z from the origin down; the planes close it.
    cone: Option<f64>,
    /// Positive inside, given how far a point is inside of each plane, and of the cone.
    combined: fn(&[f64], f64) -> f64,
    turn: DMat3,
}

impl Solid {
    fn value(&self, p: DVec3) -> f64 {
        let q = self.turn.transpose() * p;
        let depths: Vec<f64> = self.planes.iter().map(|(n, d)| d - n.dot(q)).collect();
        let cone =
            self.cone.map_or(f64::INFINITY, |half| -q.z * half.sin() - q.truncate().length() * half.cos());
        (self.combined)(&depths, cone)
    }

    fn is_on(&self, p: DVec3) -> bool {
        self.value(p).abs() < 1e-9
    }

    /// A turned square lattice on each plane, and rings on the cone, all of one density; those of the surface stay.
    fn points(&self, pitch: f64) -> Vec<DVec3> {
        let mut points = Vec::new();
        let most = (2.0 / pitch) as i64;
        for (n, d) in &self.planes {
            let (u, v) = n.any_orthonormal_pair();
            let (u, v) = (u * 0.6f64.cos() + v * 0.6f64.sin(), v * 0.6f64.cos() - u * 0.6f64.sin());
            for (i, j) in (-most..most).flat_map(|i| (-most..most).map(move |j| (i, j))) {
                points.push(
                    self.turn * (*n * *d + u * (pitch * (i as f64 + 0.37)) + v * (pitch * (j as f64 + 0.71))),
                );
            }
        }
        if let Some(half) = self.cone {
            // The last ring ends at the rim.
            let slope = self.planes[0].1 / half.cos();
            let step = slope / (slope / pitch).round();
            let mut rest = 0.0;
            for ring in 0..(slope / step).round() as i64 {
                let along = step * (ring as f64 + 0.5);
                let radius = along * half.sin();
                // What is less than a point goes to the next ring.
                let wanted = std::f64::consts::TAU * radius * step / (pitch * pitch) + rest;
                rest = wanted.fract();
                for i in 0..wanted as u32 {
                    let angle = std::f64::consts::TAU * (f64::from(i) + 0.618 * ring as f64) / wanted.floor();
                    let on = DVec3::new(radius * angle.cos(), radius * angle.sin(), -along * half.cos());
                    points.push(self.turn * on);
                }
            }
        }
        points.retain(|p| self.is_on(*p));
        points
    }

    /// Where three planes meet on the surface.
    fn corners(&self) -> Vec<DVec3> {
        let mut corners = Vec::new();
        for (i, (n, d)) in self.planes.iter().enumerate() {
            for (j, (m, e)) in self.planes.iter().enumerate().skip(i + 1) {
                for (l, f) in self.planes.iter().skip(j + 1) {
                    let matrix = DMat3::from_cols(*n, *m, *l).transpose();
                    if matrix.determinant().abs() > 1e-6 {
                        corners.push(self.turn * (matrix.inverse() * DVec3::new(*d, *e, *f)));
                    }
                }
            }
        }
        corners.retain(|p| self.is_on(*p));
        corners
    }

    /// The nearest point of the surface: at the foot on a plane, on a line of two, in a corner of three, or on the cone.
    fn distance(&self, corners: &[DVec3], p: DVec3) -> f64 {
        let mut nearest = f64::INFINITY;
        let mut look = |q: DVec3| {
            if self.is_on(q) {
                nearest = nearest.min(p.distance(q));
            }
        };
        let local = self.turn.transpose() * p;
        let planes = &self.planes;
        for (i, (n, d)) in planes.iter().enumerate() {
            look(self.turn * (local - *n * (n.dot(local) - d)));
            for (m, e) in planes.iter().skip(i + 1) {
                let cosine = n.dot(*m);
                let (a, b) = (d - n.dot(local), e - m.dot(local));
                let way = (*n * (a - cosine * b) + *m * (b - cosine * a)) / (1.0 - cosine * cosine);
                look(self.turn * (local + way));
            }
        }
        corners.iter().for_each(|&corner| look(corner));
        if let Some(half) = self.cone {
            let radial = local.truncate().length();
            let side = glam::DVec2::new(half.sin(), -half.cos());
            let outward = local.truncate() / radial;
            let on = |along: f64| {
                let at = side * along.max(0.0);
                self.turn * DVec3::new(outward.x * at.x, outward.y * at.x, at.y)
            };
            look(on(side.dot(glam::DVec2::new(radial, local.z))));
            for (n, d) in planes {
                // The rim.
                look(on(d / (n.z * side.y)));
            }
        }
        nearest
    }
}

impl StudyField for Solid {
    fn sample(&self, p: Vec3) -> f32 {
        self.value(p.as_dvec3()) as f32
    }
}

fn cuboid(min: [f64; 3], max: [f64; 3]) -> Vec<(DVec3, f64)> {
    (0..3).flat_map(|k| [(DVec3::AXES[k], max[k]), (-DVec3::AXES[k], -min[k])]).collect()
}

fn least(of: &[f64]) -> f64 {
    of.iter().copied().fold(f64::INFINITY, f64::min)
}

fn solids() -> [Solid; 4] {
    let turn = DMat3::from_rotation_z(0.3) * DMat3::from_rotation_x(0.7);
    let edge = |degrees: f64| (DVec3::new(degrees.to_radians().cos(), 0.0, degrees.to_radians().sin()), 0.0);
    let wedge = [edge(105.0), edge(-105.0), (DVec3::Y, 0.7), (-DVec3::Y, 0.65), (DVec3::X, 0.75)];
    let rooms = [
        cuboid([-0.8, -0.7, -0.6], [0.75, 0.72, 0.55]),
        cuboid([-0.6, -0.5, -0.42], [0.5, 0.55, 0.4]),
        cuboid([0.4, -0.2, -0.42], [0.9, 0.23, 0.13]),
    ];
    [
        Solid {
            name: "box",
            planes: cuboid([-0.6013, -0.5217, -0.7031], [0.6013, 0.5217, 0.7031]),
            cone: None,
            combined: |planes, _| least(planes),
            turn,
        },
        Solid {
            name: "wedge",
            planes: wedge.to_vec(),
            cone: None,
            combined: |planes, _| least(planes),
            turn,
        },
        Solid {
            name: "cone",
            planes: vec![(-DVec3::Z, 0.9)],
            cone: Some(0.5),
            combined: |planes, cone| least(planes).min(cone),
            turn,
        },
        Solid {
            name: "room",
            planes: rooms.concat(),
            cone: None,
            combined: |planes, _| least(&planes[..6]).min(-least(&planes[6..12]).max(least(&planes[12..]))),
            turn,
        },
    ]
}

fn grid(cells: u16) -> BoxGrid {
    // No plane of a solid lies on the grid's.
    let bounds = Bounds { min: Vec3::splat(-1.1), max: Vec3::splat(1.1) };
    BoxGrid { bounds, spacing: 2.2 / f32::from(cells) }
}

fn methods() -> [(&'static str, Method); 5] {
    let tetrahedra = Tetrahedra::new(Arrangement::BodyCentred).with_clustering(Clustering::Integrated);
    let relaxed = tetrahedra.with_placement(Placement::Relaxed);
    [
        ("mc", Method::Cubes(Cubes::default())),
        ("nets", Method::SurfaceNets(SurfaceNets::default())),
        ("bi", Method::Tetrahedra(tetrahedra)),
        ("bi-relaxed", Method::Tetrahedra(relaxed)),
        ("dc", Method::DualContouring(DualContouring::default())),
    ]
}

fn extracted(method: &Method, field: &dyn StudyField, grid: &BoxGrid) -> TriangleMesh {
    method.extract(&mut Extractor::new(), Source::Study(field), grid, 0.0, &THREADS).unwrap().mesh
}

/// The nearest triangle of all that come within `reach` of a point, found in boxes of that size.
struct Brute {
    reach: f64,
    boxes: std::collections::HashMap<[i64; 3], Vec<[DVec3; 3]>>,
}

impl Brute {
    fn new(mesh: &TriangleMesh, reach: f64) -> Self {
        let mut boxes = std::collections::HashMap::<[i64; 3], Vec<[DVec3; 3]>>::new();
        for t in 0..mesh.triangles.len() {
            let corners = mesh.corners(t).map(Vec3::as_dvec3);
            let [a, b, c] = corners;
            let low = ((a.min(b).min(c) - reach) / reach).floor().as_i64vec3();
            let high = ((a.max(b).max(c) + reach) / reach).floor().as_i64vec3();
            for z in low.z..=high.z {
                for y in low.y..=high.y {
                    for x in low.x..=high.x {
                        boxes.entry([x, y, z]).or_default().push(corners);
                    }
                }
            }
        }
        Self { reach, boxes }
    }

    fn distance(&self, p: DVec3) -> f64 {
        let near = self.boxes.get(&(p / self.reach).floor().as_i64vec3().to_array());
        let found = near.into_iter().flatten().map(|t| to_triangle(p, *t)).fold(f64::INFINITY, f64::min);
        assert!(found <= self.reach, "{p} is {found} from the mesh");
        found
    }
}

/// On the face, or else on the nearest side.
fn to_triangle(p: DVec3, corners: [DVec3; 3]) -> f64 {
    let [a, b, c] = corners;
    let normal = (b - a).cross(c - a);
    let sides = [(a, b), (b, c), (c, a)];
    let within = sides.iter().all(|(from, to)| (*to - *from).cross(p - *from).dot(normal) >= 0.0);
    if within && normal.length() > 0.0 {
        return (p - a).dot(normal.normalize()).abs();
    }
    let to_side = |(from, to): &(DVec3, DVec3)| {
        let way = *to - *from;
        let along = ((p - *from).dot(way) / way.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        p.distance(*from + way * along)
    };
    sides.iter().map(to_side).fold(f64::INFINITY, f64::min)
}

fn mean(of: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = of.len() as f64;
    of.sum::<f64>() / count
}

/// Within a share; of what hardly leaves the surface, within that share of a hundredth of a cell.
fn assert_near(what: &str, found: f64, want: f64, spacing: f64, share: f64) {
    let near = share * want.max(0.01 * spacing);
    let (found, want, near) = (found / spacing, want / spacing, near / spacing);
    println!("{what}: {found:.5} for {want:.5} cells ({:+.1} %)", 100.0 * (found / want - 1.0));
    assert!((found - want).abs() <= near, "{what}: {found} is not {want} cells");
}

#[test]
fn both_ways_are_what_the_analytic_surface_says() {
    for (solid, cells) in solids().iter().flat_map(|solid| [(solid, 40), (solid, 23)]) {
        let grid = grid(cells);
        let spacing = f64::from(grid.spacing);
        let (points, corners) = (solid.points(0.125 * spacing), solid.corners());
        let isosurface = IsosurfacePoints::of(solid, 0.0, &grid, None, &THREADS).unwrap();
        for (name, method) in methods() {
            let what = format!("{} at {cells} cells, {name}", solid.name);
            let mesh = extracted(&method, solid, &grid);
            let found = accuracy_beside(&isosurface, &mesh, solid, 0.0, grid.spacing, &THREADS).unwrap();
            let brute = Brute::new(&mesh, 3.0 * spacing);
            let back = mean(points.iter().map(|&p| brute.distance(p)));
            assert_near(&format!("{what}: to the mesh"), found.distance_to_mesh.mean, back, spacing, 0.02);
            let triangles: Vec<[Vec3; 3]> = (0..mesh.triangles.len()).map(|t| mesh.corners(t)).collect();
            let on_mesh = AreaSamples::new(&triangles, 40_000, 77);
            let on_mesh: Vec<DVec3> = on_mesh.points(0..40_000).collect();
            let there = mean(on_mesh.iter().map(|&p| solid.distance(&corners, p)));
            assert_near(&format!("{what}: to the surface"), found.distance.mean, there, spacing, 0.02);
            // Beyond the tip of a cone, where dual contouring may go, no gradient leads back.
            assert!(found.lost_points * 500 < found.distance.count, "{what}: {}", found.lost_points);
        }
    }
}

/// What the command prints of two surfaces comes from as true points.
#[test]
fn distances_have_the_same_points() {
    let [solid, ..] = solids();
    let grid = grid(30);
    let mesh = extracted(&Method::Cubes(Cubes::default()), &solid, &grid);
    let sampling = Sampling { amount: Amount::Samples(100_000), seed: 1 };
    let surface = Surface::try_new(&mesh).unwrap();
    let run = |threads| distances(&surface, &solid, 0.0, &grid, &sampling, &Execution { threads }).unwrap();
    let found = run(1);
    assert_eq!(found, run(2));
    let spacing = f64::from(grid.spacing);
    let (points, brute) = (solid.points(0.125 * spacing), Brute::new(&mesh, 3.0 * spacing));
    let back: Vec<f64> = points.iter().map(|&p| brute.distance(p)).collect();
    assert_near("mean", found.backward.mean, mean(back.iter().copied()), spacing, 0.02);
    let rms = mean(back.iter().map(|d| d * d)).sqrt();
    assert_near("rms", found.backward.rms, rms, spacing, 0.02);
    let area: f64 = 8.0 * (0.6013 * 0.5217 + 0.5217 * 0.7031 + 0.7031 * 0.6013);
    let samples = found.backward.samples as f64;
    assert!((samples / 1e5 - 1.0).abs() < 0.06, "{samples}");
    assert!((samples / found.backward.density / area - 1.0).abs() < 0.005, "the area");
}

/// Rock with a ground of noise, a room in it, and walls: `configs/terrain.toml` has it as a formula.
fn building(p: Vec3) -> f32 {
    let fractal = Fractal::new(NoiseShape::Plain, 4, 0.5, 0);
    let noise = fractal.value(DVec3::new(f64::from(p.x) * 1.5, f64::from(p.y) * 1.5, 0.3)) as f32;
    let ground = -1.4 * p.z - 0.35 - 0.5 * noise;
    let [u, v, w] = [(0.9 * p.x + 0.4359 * p.y) / 1.2, 0.9 * p.y - 0.4359 * p.x, p.z + 0.1];
    let room = 0.45 - u.abs().max(v.abs()).max(w.abs());
    ground.max(room).min((0.97 - p.x.abs().max(p.y.abs())).min(p.z + 0.47))
}

struct Building;

impl StudyField for Building {
    fn sample(&self, p: Vec3) -> f32 {
        building(p)
    }
}

/// Hills, and a building in rock: against the area of a four times finer mesh that keeps edges.
#[test]
fn terrain_is_as_far_as_a_finer_mesh_says() {
    let bounds = Bounds { min: Vec3::new(-1.0, -1.0, -0.5), max: Vec3::new(1.0, 1.0, 0.5) };
    let settings = TerrainSettings { margin: 0.013, ..TerrainCharacter::Hills.settings(3) };
    let hills = Terrain::try_new(settings, bounds).unwrap();
    let fields: [(&str, &dyn StudyField); 2] = [("hills", &hills), ("building", &Building)];
    for (place, field) in fields {
        let grid = BoxGrid { bounds, spacing: 0.05 };
        let finer = BoxGrid { bounds, spacing: 0.05 / 4.0 };
        let [.., (_, keeps_edges)] = methods();
        let reference = Surface::try_new(&extracted(&keeps_edges, field, &finer)).unwrap();
        let sampling = Sampling { amount: Amount::Samples(100_000), seed: 9 };
        let isosurface = IsosurfacePoints::of(field, 0.0, &grid, None, &THREADS).unwrap();
        for (name, method) in methods() {
            let mesh = extracted(&method, field, &grid);
            let found = accuracy_beside(&isosurface, &mesh, field, 0.0, grid.spacing, &THREADS).unwrap();
            let mesh = Surface::try_new(&mesh).unwrap();
            let back = reference.deviation_from(&mesh, &sampling).unwrap();
            let there = mesh.deviation_from(&reference, &sampling).unwrap();
            let what = format!("{place}, {name}");
            let spacing = f64::from(grid.spacing);
            assert_near(
                &format!("{what}: to the mesh"),
                found.distance_to_mesh.mean,
                back.mean,
                spacing,
                0.03,
            );
            // Along the gradient it is not to the nearest point.
            assert_near(&format!("{what}: to the surface"), found.distance.mean, there.mean, spacing, 0.03);
        }
    }
}
