//! Metro distances against closed forms, other programs and every kind of odd input.

use crate::shapes;
use crate::shapes::{cube, icosahedron, torus};
use isostudy_mesh::glam::{DVec3, Vec3, dvec3, vec3};
use isostudy_mesh::metro::{Amount, Deviation, MOST_SAMPLES, MetroError, Sampling, Surface, metro};
use isostudy_mesh::{MeshError, TriangleMesh};
use proptest::prelude::*;

fn samples(count: u64) -> Sampling {
    Sampling { amount: Amount::Samples(count), ..Sampling::default() }
}

fn square(side: f32, z: f32) -> TriangleMesh {
    shapes::mesh(&[[0., 0., z], [side, 0., z], [side, side, z], [0., side, z]], &[[0, 1, 2], [0, 2, 3]])
}

fn assert_near(found: f64, want: f64, tolerance: f64, what: &str) {
    assert!((found - want).abs() <= tolerance, "{what}: {found} is not {want} within {tolerance}");
}

#[test]
fn parallel_squares_are_as_far_as_they_are_apart() {
    let found = metro(&square(1.0, 0.0), &square(1.0, 0.25), &samples(1000)).unwrap();
    for way in [found.forward, found.backward] {
        assert_eq!((way.mean, way.rms, way.max), (0.25, 0.25, 0.25));
        assert_eq!((way.samples, way.density, way.vertices, way.lost_samples), (1000, 1000.0, 4, 0));
    }
    assert_eq!((found.hausdorff(), found.diagonal), (0.25, f64::sqrt(2.0)));
}

#[test]
fn a_part_is_on_the_whole_and_the_whole_is_not_on_the_part() {
    let found = metro(&square(1.0, 0.0), &square(2.0, 0.0), &samples(200_000)).unwrap();
    assert_eq!((found.forward.mean, found.forward.rms, found.forward.max), (0.0, 0.0, 0.0));
    // A quarter of the larger square is covered; two strips are 1/2 away on average and 1/3 in the mean square; in the
    // corner the mean distance from the corner of a unit square is (sqrt 2 + asinh 1) / 3, its mean square 2/3.
    let corner = (f64::sqrt(2.0) + f64::asinh(1.0)) / 3.0;
    assert_near(found.backward.mean, (1.0 + corner) / 4.0, 2e-5, "mean");
    assert_near(found.backward.rms, f64::sqrt(1.0 / 3.0), 2e-5, "RMS");
    assert_eq!(found.backward.max, f64::sqrt(2.0));
    let farthest = found.backward.farthest.unwrap();
    assert_eq!((farthest.from, farthest.to), (dvec3(2.0, 2.0, 0.0), dvec3(1.0, 1.0, 0.0)));
    assert!(farthest.at_vertex);
    assert_eq!(found.hausdorff(), f64::sqrt(2.0));
}

#[test]
fn faces_count_by_area_and_not_by_number() {
    // Half the area is 1 away, the other half 3, in a thousand pieces.
    let strips = |x: f32, n: u32, z: f32| {
        let at = |i: u32| x + i as f32 / n as f32;
        let positions: Vec<_> = (0..=n).flat_map(|i| [[at(i), 0.0, z], [at(i), 1.0, z]]).collect();
        let triangles: Vec<_> =
            (0..n).flat_map(|i| [[2 * i, 2 * i + 2, 2 * i + 1], [2 * i + 1, 2 * i + 2, 2 * i + 3]]).collect();
        shapes::mesh(&positions, &triangles)
    };
    let (mut uneven, fine) = (strips(0.0, 1, 1.0), strips(2.0, 500, 3.0));
    let shift = uneven.positions.len() as u32;
    uneven.positions.extend(&fine.positions);
    uneven.triangles.extend(fine.triangles.iter().map(|t| t.map(|v| v + shift)));
    let plane = strips(0.0, 1, 0.0).transformed(|p| p * vec3(9.0, 9.0, 1.0) - vec3(3.0, 3.0, 0.0));
    let found = metro(&uneven, &plane, &samples(1000)).unwrap().forward;
    assert_eq!((found.mean, found.max), (2.0, 3.0));
    assert_near(found.rms, f64::sqrt(5.0), 1e-12, "RMS");
}

/// MeshLab samples faces at random, so its mean is off by about the standard deviation over the root of their number.
fn assert_as_meshlab(found: &Deviation, [mean, rms, max_of_faces]: [f64; 3], what: &str) {
    let error = 5.0 * f64::sqrt((rms * rms - mean * mean) / 4e6);
    assert_near(found.mean, mean, error, what);
    assert_near(found.rms, rms, error, what);
    assert!(found.max >= max_of_faces - 1e-3, "{what}: max {} is below {max_of_faces}", found.max);
}

/// The values are those of MeshLab's Hausdorff filter, which is Metro's successor, as of pymeshlab 2025.7.post1:
/// `MeshSet.get_hausdorff_distance(sampledmesh=0, targetmesh=1, samplevert=False, sampleedge=False, sampleface=True,
/// samplenum=4000000, maxdist=PureValue(100))` after two `add_mesh(Mesh(positions, triangles))`: `mean`, `RMS`, `max`.
/// Maxima at vertices are VTK 9.7.2's: `vtkHausdorffDistancePointSetFilter`, `SetTargetDistanceMethodToPointToCell()`,
/// `GetRelativeDistance()`; MeshLab has the same to seven digits with `samplevert=True`.
#[test]
fn other_programs_say_the_same() {
    let sampling = samples(400_000);
    let wide = cube().transformed(|p| (p - Vec3::splat(0.5)) * 2.4);
    let found = metro(&icosahedron(), &wide, &sampling).unwrap();
    assert_as_meshlab(&found.forward, [0.187_560, 0.223_643, 0.418_034], "icosahedron to cube");
    assert_as_meshlab(&found.backward, [0.183_604, 0.220_208, 0.566_479], "cube to icosahedron");
    assert_near(found.forward.max, 0.418_033_988_749_895, 1e-6, "vertices of the icosahedron");
    assert_near(found.backward.max, 0.566_938_340_930_311, 1e-6, "corners of the cube");
    assert_near(found.diagonal, 4.156_922, 1e-6, "diagonal of the cube");

    let found = metro(&torus(48, 24), &torus(9, 5), &sampling).unwrap();
    assert_as_meshlab(&found.forward, [0.085_870, 0.104_015, 0.210_116], "torus to a coarse one");
    assert_as_meshlab(&found.backward, [0.079_658, 0.097_730, 0.208_629], "coarse torus to a fine one");
    assert_near(found.forward.max, 0.210_155_230_887_141, 1e-6, "vertices of the torus");
    assert!(found.forward.farthest.unwrap().at_vertex);
    assert!(!found.backward.farthest.unwrap().at_vertex, "its vertices are nearly on the fine torus");
    assert_near(found.backward.max, 0.208_629, 1e-3, "faces of the coarse torus");

    let moved = icosahedron().transformed(|p| p + vec3(0.4, 0.1, -0.2));
    let found = metro(&torus(24, 12), &moved, &sampling).unwrap();
    assert_as_meshlab(&found.forward, [0.540_977, 0.641_130, 1.384_285], "torus to icosahedron");
    assert_as_meshlab(&found.backward, [0.678_823, 0.847_783, 2.099_856], "icosahedron to torus");
    assert_near(found.forward.max, 1.384_562_425_095_12, 1e-6, "vertices of the torus");
    assert_near(found.backward.max, 2.099_856, 1e-3, "faces of the icosahedron");
    assert_eq!(found.hausdorff(), found.backward.max);
}

/// Against a surface that is no mesh: the sphere through the icosahedron's corners, by a formula.
#[test]
fn an_icosahedron_is_as_far_from_its_sphere_as_its_inradius_says() {
    let centre = DVec3::ZERO;
    let radius = f64::from(icosahedron().positions[0].length());
    let sphere = |p: DVec3, _: Option<(DVec3, f64)>| {
        let position = p.normalize_or(DVec3::X) * radius;
        Some(isostudy_mesh::metro::Foot { position, distance: p.distance(position) })
    };
    let surface = Surface::try_new(&icosahedron()).unwrap();
    let found = surface.deviation_by(&samples(100_000), sphere).unwrap();
    // Edge 2: inradius phi^2 / sqrt 3.
    let golden = (1.0 + f64::sqrt(5.0)) / 2.0;
    let inradius = golden * golden / f64::sqrt(3.0);
    assert_near(found.max, radius - inradius, 1e-4, "the middle of a face");
    assert_near(found.farthest.unwrap().from.distance(centre), inradius, 1e-4, "where it is");
    // The mean square of (R - r): R^2 - 2 R mean(r) + mean(r^2), where mean(r^2) = inradius^2 + circumradius^2 / 4 of
    // the face, whose circumradius is 2 / sqrt 3, and mean(r) follows from the mean distance.
    let mean_r = radius - found.mean;
    let mean_square = inradius * inradius + 1.0 / 3.0;
    let want = (radius * radius - 2.0 * radius * mean_r + mean_square).sqrt();
    assert_near(found.rms, want, 1e-4, "RMS");
}

#[test]
fn what_cannot_be_known_is_counted_and_left_out() {
    let surface = Surface::try_new(&square(1.0, 0.0)).unwrap();
    let left = |p: DVec3, _: Option<(DVec3, f64)>| {
        (p.x < 0.5).then_some(isostudy_mesh::metro::Foot { position: p, distance: 2.0 })
    };
    let found = surface.deviation_by(&samples(10_000), left).unwrap();
    assert!((4_950..=5_050).contains(&found.lost_samples), "{}", found.lost_samples);
    assert_eq!((found.mean, found.rms, found.max, found.lost_vertices), (2.0, 2.0, 2.0, 2));
    let none = surface.deviation_by(&samples(10), |_, _| None).unwrap();
    assert_eq!((none.mean, none.rms, none.max, none.lost_samples), (0.0, 0.0, 0.0, 10));
    assert!(none.farthest.is_none());
}

#[test]
fn threads_change_nothing_and_seeds_change_the_places() {
    let (a, b) = (torus(24, 12), torus(9, 5));
    let run = |threads: usize, seed: u64| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let sampling = Sampling { amount: Amount::Density(2_000.0), seed };
        pool.install(|| metro(&a, &b, &sampling)).unwrap()
    };
    let one = run(1, 7);
    assert_eq!(one.forward.samples, (Surface::try_new(&a).unwrap().area() * 2_000.0).ceil() as u64);
    for threads in [2, 3, 8] {
        assert_eq!(run(threads, 7), one);
    }
    let other = run(1, 8);
    assert_ne!(other.forward.mean, one.forward.mean);
    assert_near(other.forward.mean, one.forward.mean, 1e-4, "another seed");
}

#[test]
fn a_surface_is_on_itself_wherever_it_is() {
    for offset in [0.0, 1000.0] {
        let mesh = torus(24, 12).transformed(|p| p + Vec3::splat(offset));
        let found = metro(&mesh, &mesh, &samples(20_000)).unwrap();
        // Which triangle is nearest is decided in single precision.
        assert!(found.hausdorff() <= 1e-6 * f64::from(offset + 3.0), "{}", found.hausdorff());
    }
}

#[test]
fn odd_meshes_are_errors_or_have_a_meaning() {
    let good = square(1.0, 0.0);
    let refused = |mesh: &TriangleMesh| Surface::try_new(mesh).unwrap_err();
    assert_eq!(refused(&TriangleMesh::default()), MetroError::Mesh(MeshError::Empty));
    assert_eq!(
        refused(&TriangleMesh { triangles: Vec::new(), ..good.clone() }),
        MetroError::Mesh(MeshError::Empty)
    );
    let mut bad = good.clone();
    bad.triangles[1][2] = 4;
    assert_eq!(
        refused(&bad),
        MetroError::Mesh(MeshError::IndexOutOfRange { triangle: 1, index: 4, vertices: 4 })
    );
    for odd in [f32::NAN, f32::INFINITY, -2e18] {
        let mut bad = good.clone();
        bad.positions[3].y = odd;
        let MetroError::Mesh(MeshError::Coordinate { vertex: 3, position }) = refused(&bad) else {
            panic!("{odd}")
        };
        assert_eq!(position.y.to_bits(), odd.to_bits());
        // No part of the surface as long as no triangle uses it.
        bad.triangles.pop();
        assert_eq!(Surface::try_new(&bad).unwrap().area(), 0.5);
    }
    let line = shapes::mesh(&[[0., 0., 0.], [1., 0., 0.], [3., 0., 0.]], &[[0, 1, 2], [0, 0, 1]]);
    assert_eq!(refused(&line), MetroError::NoArea { triangles: 2 });
}

#[test]
fn a_triangle_without_area_counts_by_its_corners_and_as_a_target() {
    // A square and a needle that stands on it.
    let mut pin = square(1.0, 0.0);
    pin.positions.push(vec3(0.0, 0.0, 5.0));
    pin.triangles.push([0, 4, 4]);
    let found = metro(&pin, &square(1.0, 0.0), &samples(1000)).unwrap();
    assert_eq!((found.forward.mean, found.forward.max, found.backward.max), (0.0, 5.0, 0.0));
    let beside = square(1.0, 0.0).transformed(|p| vec3(-2.0 - p.x * 1e-6, p.y * 1e-6, 4.0 + p.z));
    let found = metro(&beside, &pin, &samples(1000)).unwrap().forward;
    assert_near(found.mean, 2.0, 1e-5, "to the needle, not to the square");
}

#[test]
fn amounts_have_limits() {
    let surface = Surface::try_new(&square(2.0, 0.0)).unwrap();
    let refused = |amount| {
        let sampling = Sampling { amount, seed: 1 };
        surface.deviation_from(&surface, &sampling).unwrap_err()
    };
    for density in [0.0, -1.0, f64::INFINITY] {
        assert_eq!(refused(Amount::Density(density)), MetroError::Density { density });
    }
    assert!(matches!(refused(Amount::Density(f64::NAN)), MetroError::Density { .. }));
    assert_eq!(refused(Amount::Samples(0)), MetroError::SampleCount { samples: 0.0, area: 4.0 });
    assert_eq!(refused(Amount::Density(1e9)), MetroError::SampleCount { samples: 4e9, area: 4.0 });
    let more = MOST_SAMPLES + 1;
    assert_eq!(refused(Amount::Samples(more)), MetroError::SampleCount { samples: more as f64, area: 4.0 });
    // Less than one sample on the whole surface is one.
    let sampling = Sampling { amount: Amount::Density(1e-9), seed: 1 };
    assert_eq!(surface.deviation_from(&surface, &sampling).unwrap().samples, 1);
}

proptest! {
    /// Against every triangle of random soups: distances, maxima and their places are what a search through all says.
    #[test]
    fn soups(
        a in prop::collection::vec(prop::array::uniform9(-1.0..1.0f32), 1..12),
        b in prop::collection::vec(prop::array::uniform9(-1.0..1.0f32), 1..40),
        seed: u64,
    ) {
        let soup = |triangles: &[[f32; 9]]| {
            let positions: Vec<[f32; 3]> = triangles.iter().flat_map(|t| [0, 3, 6].map(|i| [t[i], t[i + 1], t[i + 2]])).collect();
            let triangles: Vec<[u32; 3]> = (0..triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
            shapes::mesh(&positions, &triangles)
        };
        let (first, second) = (soup(&a), soup(&b));
        let surface = Surface::try_new(&first).unwrap();
        // One surface a triangle: the nearest of all is the nearest.
        let single: Vec<Surface> = b.iter().map(|t| Surface::try_new(&soup(&[*t])).unwrap()).collect();
        let sampling = Sampling { amount: Amount::Samples(200), seed };
        let all = surface.deviation_by(&sampling, |p, _| {
            let feet = single.iter().map(|triangle| triangle.nearest(p, f64::INFINITY));
            feet.min_by(|x, y| x.distance.total_cmp(&y.distance))
        }).unwrap();
        let found = surface.deviation_from(&Surface::try_new(&second).unwrap(), &sampling).unwrap();
        prop_assert!((found.mean - all.mean).abs() < 1e-6 && (found.max - all.max).abs() < 1e-6);
        let farthest = found.farthest.unwrap();
        prop_assert!((farthest.from.distance(farthest.to) - found.max).abs() < 1e-12);
        prop_assert!(found.mean <= found.rms + 1e-15 && found.rms <= found.max + 1e-15);
    }
}
