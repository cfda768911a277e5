//! Distances and angles that are known from geometry.

use std::collections::BTreeMap;

use glam::{Vec3, vec3};
use isostudy_extract::by_lattice::{ExtractSettings, Lattice, extract};
use isostudy_extract::{Accuracy, Arrangement, BoxGrid, DistanceError, Execution, accuracy, distances};
use isostudy_field::{Asteroid, MeshDistance, Sphere, StudyField};
use isostudy_mesh::metro::{Amount, MetroError, Sampling, Surface, metro};
use isostudy_mesh::{Bounds, MeshError, TriangleMesh};

const THREADS: Execution = Execution { threads: 2 };

/// Above the plane through the origin is outside; `steepness` is the length of the gradient.
struct HalfSpace {
    normal: Vec3,
    steepness: f32,
}

impl StudyField for HalfSpace {
    fn sample(&self, p: Vec3) -> f32 {
        -self.steepness * self.normal.dot(p)
    }
}

/// A square of side 2 in the plane through `height * normal`, with the normal tilted by `degrees`.
fn square(normal: Vec3, height: f32, degrees: f32) -> TriangleMesh {
    let (u, v) = normal.any_orthonormal_pair();
    let at = |a: f32, b: f32| normal * height + u * a + v * b;
    let tilted = normal * degrees.to_radians().cos() + u * degrees.to_radians().sin();
    TriangleMesh {
        positions: vec![at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)],
        normals: vec![tilted; 4],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
    }
}

/// A regular icosahedron subdivided `times`, all vertices at distance 1, radial normals.
fn sphere_mesh(times: u32) -> TriangleMesh {
    let g = (1.0 + 5f32.sqrt()) / 2.0;
    let mut positions: Vec<Vec3> = [[0., 1., g], [0., -1., g], [0., 1., -g], [0., -1., -g]]
        .into_iter()
        .flat_map(|[a, b, c]| [vec3(a, b, c), vec3(b, c, a), vec3(c, a, b)])
        .map(Vec3::normalize)
        .collect();
    let side = 2.0 / (g * g + 1.0).sqrt() * 1.001;
    let near = |p: &[Vec3], i: usize, j: usize| p[i].distance(p[j]) < side;
    let mut triangles = Vec::new();
    for (i, j, k) in (0..12).flat_map(|i| (0..i).flat_map(move |j| (0..j).map(move |k| (i, j, k)))) {
        if near(&positions, i, j) && near(&positions, j, k) && near(&positions, k, i) {
            let outward = (positions[j] - positions[i]).cross(positions[k] - positions[i]).dot(positions[i]);
            let [j, k] = if outward > 0.0 { [j, k] } else { [k, j] };
            triangles.push([i as u32, j as u32, k as u32]);
        }
    }
    for _ in 0..times {
        let (mut finer, mut middles) = (Vec::new(), BTreeMap::new());
        for [a, b, c] in triangles {
            let mut middle = |i: u32, j: u32| {
                *middles.entry([i.min(j), i.max(j)]).or_insert_with(|| {
                    positions.push((positions[i as usize] + positions[j as usize]).normalize());
                    positions.len() as u32 - 1
                })
            };
            let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
            finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        triangles = finer;
    }
    TriangleMesh { normals: positions.clone(), positions, triangles }
}

/// In the box from -1 to 1.
fn measure(mesh: &TriangleMesh, field: &dyn StudyField, isovalue: f32, spacing: f32) -> Accuracy {
    let bounds = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };
    let lattice = Lattice::try_new(Arrangement::SimpleCubic, bounds, spacing).unwrap();
    accuracy(mesh, field, isovalue, &BoxGrid::from(&lattice), &THREADS).unwrap()
}

#[test]
fn a_plane_is_as_far_as_it_was_moved_and_as_askew_as_it_was_tilted() {
    let normal = vec3(1.0, -2.0, 3.0).normalize();
    for steepness in [0.1, 1.0, 30.0] {
        let field = HalfSpace { normal, steepness };
        for (height, degrees) in [(0.02, 0.0), (-0.05, 10.0), (0.25, 120.0)] {
            let found = measure(&square(normal, height, degrees), &field, 0.0, 0.1);
            let want = f64::from(height.abs());
            assert_eq!((found.distance.count, found.lost_points, found.lost_vertices), (65_536, 0, 0));
            for distance in [found.distance.min, found.distance.mean, found.distance.max] {
                assert!((distance - want).abs() < 3e-6, "{distance} is not {want}");
            }
            for angle in [found.normal_error_deg.min, found.normal_error_deg.max] {
                assert!((angle - f64::from(degrees)).abs() < 0.02, "{angle} is not {degrees}");
            }
        }
    }
}

#[test]
fn isovalue_moves_the_surface() {
    let field = HalfSpace { normal: Vec3::Z, steepness: 2.0 };
    // -2 z = 0.06 at z = -0.03.
    let found = measure(&square(Vec3::Z, 0.0, 0.0), &field, 0.06, 0.1);
    assert!((found.distance.mean - 0.03).abs() < 1e-6);
}

#[test]
fn faces_of_a_sphere_sag() {
    // One triangle of an icosahedron inscribed in the unit sphere is 1 - 0.794654 from it in the middle (its inradius);
    // a fine one of side s with circumradius R = s / sqrt 3 is R^2 / 2 there and R^2 / 4 on average, to first order:
    // the mean of |p - c|^2 over an equilateral triangle is R^2 / 4.
    let coarse = measure(&sphere_mesh(0), &Sphere::default(), 0.0, 0.3);
    assert!((coarse.distance.max - (1.0 - 0.794_654)).abs() < 2e-4, "{}", coarse.distance.max);
    let fine = sphere_mesh(4);
    let squared_radii: f64 = (0..fine.triangles.len())
        .map(|t| {
            let [a, b, c] = fine.corners(t).map(|p| p.as_dvec3());
            // Over a triangle the squared distance from the circle through its corners averages
            // R^2 - |c - g|^2 - (|ab|^2 + |bc|^2 + |ca|^2) / 36, and R^2 = |c - g|^2 + (the same sum) / 9.
            let sides = a.distance_squared(b) + b.distance_squared(c) + c.distance_squared(a);
            (sides / 9.0 - sides / 36.0) / 2.0
        })
        .sum();
    let want = squared_radii / fine.triangles.len() as f64;
    let found = measure(&fine, &Sphere::default(), 0.0, 0.05);
    assert!((found.distance.mean / want - 1.0).abs() < 0.02, "{} is not {want}", found.distance.mean);
    assert!(found.normal_error_deg.max < 0.02, "radial normals: {}", found.normal_error_deg.max);
}

#[test]
fn a_shifted_sphere_is_off_by_the_mean_cosine() {
    // |cos| averages 1/2 over a sphere, and the sagitta is small against the shift.
    let mut mesh = sphere_mesh(5);
    mesh.positions.iter_mut().for_each(|p| *p += Vec3::X * 0.02);
    let found = measure(&mesh, &Sphere::default(), 0.0, 0.05);
    assert!((found.distance.mean - 0.01).abs() < 2e-4, "{}", found.distance.mean);
    assert!((found.distance.max - 0.02).abs() < 4e-4, "{}", found.distance.max);
    // The radial direction turns by the shift across it: at most asin(0.02).
    assert!((found.normal_error_deg.max - 0.02f64.asin().to_degrees()).abs() < 0.03);
}

#[test]
fn distance_fields_and_noise_lose_no_point() {
    let cube = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };
    let solid = MeshDistance::try_new(&sphere_mesh(3)).unwrap();
    let fields: [(&dyn StudyField, f64); 2] = [(&solid, 0.03), (&Asteroid::default(), 0.1)];
    for (field, within) in fields {
        for arrangement in [Arrangement::BodyCentred, Arrangement::SimpleCubic] {
            let lattice = Lattice::try_new(arrangement, cube, 0.1).unwrap();
            let mesh = extract(field, &lattice, &ExtractSettings::default(), &THREADS).unwrap().mesh;
            let found = measure(&mesh, field, 0.0, 0.1);
            assert_eq!((found.lost_points, found.lost_vertices), (0, 0));
            assert!(found.distance.mean < within * 0.1, "{}", found.distance.mean);
            assert_eq!(
                found,
                accuracy(&mesh, field, 0.0, &BoxGrid::from(&lattice), &Execution { threads: 1 }).unwrap()
            );
        }
    }
}

#[test]
fn the_way_back_is_that_from_the_isosurface() {
    // The plane z = 0.04 fills the box as the square at 0.1 does.
    let field = HalfSpace { normal: Vec3::Z, steepness: 0.5 };
    let found = measure(&square(Vec3::Z, 0.1, 0.0), &field, -0.02, 0.08);
    // Lines are sent for so many, and cross as often as they do.
    assert!((found.distance_to_mesh.count as f64 / 131_072.0 - 1.0).abs() < 0.05);
    for distance in [found.distance_to_mesh.min, found.distance_to_mesh.max, found.hausdorff()] {
        assert!((distance - 0.06).abs() < 1e-6, "{distance}");
    }
    // Of a sphere of radius 0.8 without its lower half, the way to the surface is short and the way back is not: from
    // the pole to the rim.
    let whole = sphere_mesh(5);
    let is_above = |t: &&[u32; 3]| t.iter().any(|&v| whole.positions[v as usize].z > 0.0);
    let above: Vec<[u32; 3]> = whole.triangles.iter().filter(is_above).copied().collect();
    let half = whole.transformed(|p| vec3(p.x, p.y, p.z.max(0.0)).normalize_or(Vec3::X) * 0.8);
    let half = TriangleMesh { triangles: above, ..half };
    for field in [&Sphere { radius: 0.8 } as &dyn StudyField, &Ball { radius: 0.8 }] {
        let found = measure(&half, field, 0.0, 0.05);
        assert!(found.distance.max < 3e-4, "{}", found.distance.max);
        assert!((found.distance_to_mesh.max - 0.8 * 2f64.sqrt()).abs() < 0.03);
        assert_eq!(found.hausdorff(), found.distance_to_mesh.max);
        // Half the area is covered. On the rest, heights are uniform by Archimedes, and a point at height -z of the
        // unit sphere is the chord of the angle asin(z) from the rim.
        let steps = 100_000;
        let chord = |z: f64| (2.0 - 2.0 * (1.0 - z * z).sqrt()).sqrt();
        let mean = (0..steps).map(|i| 0.8 * chord((f64::from(i) + 0.5) / f64::from(steps))).sum::<f64>();
        let want = 0.5 * mean / f64::from(steps);
        assert!(
            (found.distance_to_mesh.mean / want - 1.0).abs() < 0.02,
            "{} is not {want}",
            found.distance_to_mesh.mean
        );
    }
}

/// The same function as a sphere's field that knows nothing of spheres.
struct Ball {
    radius: f32,
}

impl StudyField for Ball {
    fn sample(&self, p: Vec3) -> f32 {
        self.radius - p.length()
    }
}

#[test]
fn a_field_that_knows_its_surface_gives_what_a_search_gives_and_more() {
    let lattice =
        Lattice::try_new(Arrangement::BodyCentred, Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE }, 0.1)
            .unwrap();
    let (known, searched) = (Sphere { radius: 0.8 }, Ball { radius: 0.8 });
    let mesh = extract(&known, &lattice, &ExtractSettings::default(), &THREADS).unwrap().mesh;
    let [a, b] = [&known as &dyn StudyField, &searched]
        .map(|f| accuracy(&mesh, f, 0.0, &BoxGrid::from(&lattice), &THREADS).unwrap());
    for (a, b) in [
        (a.distance.mean, b.distance.mean),
        (a.distance.max, b.distance.max),
        (a.distance_to_mesh.max, b.distance_to_mesh.max),
    ] {
        assert!((a - b).abs() < 2e-6, "{a} is not {b}");
    }
    // Beyond three spacings: Negated stands for fields that pass on what another knows.
    let small = sphere_mesh(4).transformed(|p| p * 0.4);
    let far = measure(&small, &isostudy_field::Negated(known), 0.0, 0.1);
    assert_eq!((far.lost_points, measure(&small, &searched, 0.0, 0.1).lost_points), (0, 65_536));
    assert!((far.distance.min - 0.4).abs() < 1e-3 && (far.distance.max - 0.4).abs() < 1e-3);
}

#[test]
fn a_mesh_as_field_is_measured_both_ways_as_two_meshes_are() {
    let source = sphere_mesh(2).transformed(|p| p * vec3(0.9, 0.6, 0.8));
    let field = MeshDistance::try_new(&source).unwrap();
    let same = measure(&source, &field, 0.0, 0.1);
    assert!(same.hausdorff() < 1e-7, "{}", same.hausdorff());
    let lattice =
        Lattice::try_new(Arrangement::BodyCentred, Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE }, 0.1)
            .unwrap();
    let mesh = extract(&field, &lattice, &ExtractSettings::default(), &THREADS).unwrap().mesh;
    let found = accuracy(&mesh, &field, 0.0, &BoxGrid::from(&lattice), &THREADS).unwrap();
    let sampling = Sampling { amount: Amount::Samples(200_000), seed: 5 };
    let want = metro(&mesh, &source, &sampling).unwrap();
    let ways = [(65_536, found.distance, want.forward), (131_072, found.distance_to_mesh, want.backward)];
    for (count, found, want) in ways {
        assert_eq!(found.count, count);
        assert!((found.mean / want.mean - 1.0).abs() < 0.02, "{} is not {}", found.mean, want.mean);
        assert!((found.rms() / want.rms - 1.0).abs() < 0.02, "{} is not {}", found.rms(), want.rms);
        assert!(found.max <= want.max + 1e-6, "{} is above {}", found.max, want.max);
    }
}

#[test]
fn distances_name_the_places() {
    // The sphere without what is beyond x = 0.6: from the missing pole to the rim at x = 0.6.
    let whole = sphere_mesh(5).transformed(|p| p * 0.8);
    let is_kept = |t: &&[u32; 3]| t.iter().all(|&v| whole.positions[v as usize].x <= 0.6);
    let cut = TriangleMesh {
        triangles: whole.triangles.iter().filter(is_kept).copied().collect(),
        ..whole.clone()
    };
    let bounds = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };
    let lattice = Lattice::try_new(Arrangement::SimpleCubic, bounds, 0.05).unwrap();
    let sampling = Sampling { amount: Amount::Samples(20_000), seed: 3 };
    let surface = Surface::try_new(&cut).unwrap();
    for field in [&Sphere { radius: 0.8 } as &dyn StudyField, &Ball { radius: 0.8 }] {
        let run = |threads| {
            distances(&surface, field, 0.0, &BoxGrid::from(&lattice), &sampling, &Execution { threads })
                .unwrap()
        };
        let found = run(1);
        assert!(found.forward.max < 3e-4 && found.forward.lost_samples == 0);
        // To the rim at x = 0.6. Triangles end up to an edge, 0.03, before it; the next sample to the pole may be 0.02 off.
        let want = f64::sqrt(2.0 * 0.8 * (0.8 - 0.6));
        assert!((-0.02..0.03).contains(&(found.backward.max - want)), "{}", found.backward.max);
        let farthest = found.backward.farthest.unwrap();
        assert!(farthest.from.distance(glam::dvec3(0.8, 0.0, 0.0)) < 0.05, "{}", farthest.from);
        assert!((farthest.from.length() - 0.8).abs() < 1e-6, "moved to the isosurface");
        assert!((farthest.to.x - 0.59).abs() < 0.03, "{}", farthest.to);
        assert!((found.diagonal - 1.6 * f64::sqrt(3.0)).abs() < 0.01);
        assert_eq!(run(2), found);
    }
    let nothing =
        distances(&surface, &Sphere { radius: 0.8 }, 0.9, &BoxGrid::from(&lattice), &sampling, &THREADS);
    assert_eq!(nothing, Err(DistanceError::Isosurface(MetroError::Mesh(MeshError::Empty))));
}

#[test]
fn what_cannot_be_measured_is_counted() {
    let far = square(Vec3::Z, 0.5, 0.0);
    let field = HalfSpace { normal: Vec3::Z, steepness: 1.0 };
    let found = measure(&far, &field, 0.0, 0.1);
    assert_eq!((found.distance.count, found.lost_points), (0, 65_536), "beyond three spacings");
    assert_eq!((found.normal_error_deg.count, found.lost_vertices), (0, 4));
    struct Nowhere;
    impl StudyField for Nowhere {
        fn sample(&self, _: Vec3) -> f32 {
            f32::NAN
        }
    }
    assert_eq!(measure(&far, &Nowhere, 0.0, 0.1).lost_points, 65_536);
    let mut flat = square(Vec3::Z, 0.01, 0.0);
    flat.normals[1] = Vec3::ZERO;
    assert_eq!(measure(&flat, &field, 0.0, 0.1).lost_vertices, 1, "no normal");
    let none = measure(&TriangleMesh::default(), &field, 0.0, 0.1);
    assert_eq!((none.distance.count, none.distance_to_mesh.count, none.lost_points), (0, 0, 0), "no mesh");
}
