//! What the crate's front page says of odd input: an error, or a mesh with a meaning.

use glam::Vec3;
use isostudy_extract::by_lattice::{ExtractSettings, Lattice, extract};
use isostudy_extract::{Arrangement, Clustering, Execution, Extraction};
use isostudy_field::{Asteroid, Gyroid, MeshDistance, Sphere, StudyField};
use isostudy_mesh::topology::topology;
use isostudy_mesh::{Bounds, TriangleMesh};

const BOTH: [Arrangement; 2] = [Arrangement::BodyCentred, Arrangement::SimpleCubic];
const CUBE: Bounds = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };

const UNCLUSTERED: ExtractSettings = ExtractSettings::new().with_clustering(Clustering::None);

fn surface(field: &dyn StudyField, lattice: &Lattice, isovalue: f32) -> Extraction {
    let settings = ExtractSettings::default().with_isovalue(isovalue);
    extract(field, lattice, &settings, &Execution { threads: 1 }).unwrap()
}

struct With<F>(F);

impl<F: Fn(Vec3) -> f32 + Sync> StudyField for With<F> {
    fn sample(&self, p: Vec3) -> f32 {
        (self.0)(p)
    }
}

#[test]
fn an_isovalue_that_no_sample_passes_gives_an_empty_mesh() {
    let fields: [&dyn StudyField; 3] = [&Sphere::default(), &Asteroid::default(), &Gyroid::default()];
    for arrangement in BOTH {
        let lattice = Lattice::try_new(arrangement, CUBE, 0.25).unwrap();
        for field in fields {
            for isovalue in [100.0, -100.0, f32::MAX, f32::MIN] {
                let Extraction { mesh, counts, .. } = surface(field, &lattice, isovalue);
                assert!(mesh.positions.is_empty() && mesh.normals.is_empty() && mesh.triangles.is_empty());
                assert_eq!((counts.crossings, counts.cells_visited), (0, 0), "{arrangement:?} {isovalue}");
            }
        }
    }
}

/// Planes at five places along each axis, and a gyroid: open where they meet the box, and nowhere else.
#[test]
fn a_surface_through_the_boundary_is_open_there_and_only_there() {
    for arrangement in BOTH {
        let lattice = Lattice::try_new(arrangement, CUBE, 0.2).unwrap();
        let gyroid = surface(&Gyroid { frequency: 6.0 }, &lattice, 0.0).mesh;
        let planes = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| {
            let field = With(move |p: Vec3| p.dot(axis) + 0.03);
            let plane = surface(&field, &lattice, 0.0).mesh;
            // Merged vertices may lie inside the box.
            let all = extract(&field, &lattice, &UNCLUSTERED, &Execution { threads: 1 }).unwrap().mesh;
            let area: f64 = (0..all.triangles.len()).map(|t| f64::from(area(all.corners(t)))).sum();
            assert!((area - 4.0).abs() < 1e-3, "{area} of a side of 4");
            plane
        });
        for mesh in planes.iter().chain([&gyroid]) {
            let report = topology(mesh);
            assert!(report.boundary_edges > 0);
            let defects = [report.non_manifold_edges, report.misoriented_edges, report.non_manifold_vertices];
            assert_eq!(defects, [0; 3]);
            for p in &mesh.positions {
                assert!(p.abs().max_element() <= 1.0, "{p} is beyond the box");
            }
        }
        let reaches = |sign: f32, axis: usize| gyroid.positions.iter().any(|p| p[axis] * sign > 0.999);
        assert!((0..3).all(|axis| reaches(1.0, axis) && reaches(-1.0, axis)), "all six sides are met");
    }
}

fn area([a, b, c]: [Vec3; 3]) -> f32 {
    (b - a).cross(c - a).length() * 0.5
}

/// Its eight corners are outside; only a body-centred lattice has a sample in the middle.
#[test]
fn one_cell_is_a_volume() {
    let ball = Sphere { radius: 0.9 };
    for spacing in [2.0, 3.0, 1e30] {
        for (arrangement, triangles) in [(Arrangement::BodyCentred, 24), (Arrangement::SimpleCubic, 0)] {
            let lattice = Lattice::try_new(arrangement, CUBE, spacing).unwrap();
            assert_eq!(lattice.cells(), [1; 3]);
            let mesh = surface(&ball, &lattice, 0.0).mesh;
            if spacing == 2.0 {
                let all = extract(&ball, &lattice, &UNCLUSTERED, &Execution { threads: 1 }).unwrap().mesh;
                assert_eq!(all.triangles.len(), triangles, "{arrangement:?}");
            }
            assert!(mesh.positions.iter().all(|p| p.is_finite()));
        }
    }
}

/// One sample in the middle of a solid block that is not a number is outside: a bubble. One beyond all numbers has its
/// crossings on the other end; both meshes are closed manifolds with finite vertices.
#[test]
fn samples_that_are_no_numbers_are_outside() {
    for arrangement in BOTH {
        let lattice = Lattice::try_new(arrangement, CUBE, 0.25).unwrap();
        let block = |odd: f32| {
            With(move |p: Vec3| match p {
                Vec3::ZERO => odd,
                _ if p.abs().max_element() < 0.9 => 1.0,
                _ => -1.0,
            })
        };
        let whole = surface(&block(1.0), &lattice, 0.0).mesh;
        for odd in [f32::NAN, f32::NEG_INFINITY] {
            let mesh = surface(&block(odd), &lattice, 0.0).mesh;
            let report = topology(&mesh);
            assert!(report.is_closed_manifold(), "{odd} {arrangement:?}: {report:?}");
            assert!(mesh.positions.len() > whole.positions.len(), "{odd} makes a bubble");
            assert!(mesh.volume() < whole.volume());
            assert!(mesh.positions.iter().all(|p| p.is_finite()));
        }
        assert_eq!(surface(&block(f32::INFINITY), &lattice, 0.0).mesh, whole, "infinite is inside");
    }
}

/// A ball far out, where sample points are off by a seventh of the spacing and more: a field that offers a bound has the
/// mesh of one that does not.
#[test]
fn bounds_hold_where_positions_are_coarse() {
    #[derive(Clone, Copy)]
    struct Far(bool);
    const MIDDLE: Vec3 = Vec3::new(1e5, -1e5, 2e5);
    impl StudyField for Far {
        fn sample(&self, p: Vec3) -> f32 {
            0.8 - (p - MIDDLE).length()
        }
        fn slope(&self, _: Bounds) -> Option<f32> {
            self.0.then_some(1.0)
        }
    }
    let bounds = Bounds { min: MIDDLE - 1.0, max: MIDDLE + 1.0 };
    for arrangement in BOTH {
        for spacing in [0.1, 0.05, 0.013] {
            let lattice = Lattice::try_new(arrangement, bounds, spacing).unwrap();
            let (with, without) = (surface(&Far(true), &lattice, 0.0), surface(&Far(false), &lattice, 0.0));
            assert!(with.mesh == without.mesh && with.counts == without.counts, "{arrangement:?} {spacing}");
            assert!(with.counts.triangles > 100);
        }
    }
}

/// A field without its bounds.
struct Plain<'a>(&'a dyn StudyField);

impl StudyField for Plain<'_> {
    fn sample(&self, p: Vec3) -> f32 {
        self.0.sample(p)
    }
}

/// Pieces of planets, whose values are off by a few per cent of the spacing, and things so small or large that squares of
/// coordinates are not numbers to rely on.
#[test]
fn bounds_hold_where_values_are_coarse() {
    let diagonal = Vec3::ONE / 3.0f32.sqrt();
    let cases = [
        (1e5, diagonal * 1e5, 12.0, 0.3),
        (1e6, diagonal * 1e6, 40.0, 1.0),
        (1e6, diagonal * 1e6, 160.0, 4.0),
        (1e-22, Vec3::ZERO, 1.1e-22, 1e-23),
        (1e-20, Vec3::ZERO, 1.1e-20, 1e-21),
        (1e20, Vec3::ZERO, 1.1e20, 1e19),
    ];
    for (radius, middle, reach, spacing) in cases {
        let bounds = Bounds { min: middle - reach, max: middle + reach };
        let lumpy = Asteroid { radius, amplitude: 0.1 * radius, ..Asteroid::default() };
        for arrangement in BOTH {
            let lattice = Lattice::try_new(arrangement, bounds, spacing).unwrap();
            for field in [&Sphere { radius } as &dyn StudyField, &lumpy] {
                let (with, without) = (surface(field, &lattice, 0.0), surface(&Plain(field), &lattice, 0.0));
                assert!(
                    with.mesh == without.mesh && with.counts == without.counts,
                    "{arrangement:?} {radius}"
                );
            }
        }
    }
}

/// The distance to a block whose triangles are a million times as wide as a cell and more.
#[test]
fn bounds_hold_beside_large_triangles() {
    let size = 1e6;
    let block = Bounds { min: Vec3::new(-size, -0.9 * size, -size), max: Vec3::new(size, size, 0.0) };
    let corner = |i: usize| {
        let pick = |axis: usize| if i >> axis & 1 == 0 { block.min[axis] } else { block.max[axis] };
        Vec3::new(pick(0), pick(1), pick(2))
    };
    let triangles = [
        [0, 2, 1],
        [1, 2, 3],
        [4, 5, 6],
        [5, 7, 6],
        [0, 1, 4],
        [1, 5, 4],
        [2, 6, 3],
        [3, 6, 7],
        [0, 4, 2],
        [2, 4, 6],
        [1, 3, 5],
        [3, 7, 5],
    ];
    let mesh = TriangleMesh {
        positions: (0..8).map(corner).collect(),
        normals: Vec::new(),
        triangles: triangles.to_vec(),
    };
    let field = MeshDistance::try_new(&mesh).unwrap();
    for (middle, spacing) in [(0.0, 0.1), (0.0, 0.5), (1234.5, 1.0)] {
        let middle = Vec3::new(middle, middle, 0.0);
        let bounds = Bounds { min: middle - 15.3 * spacing, max: middle + 15.3 * spacing };
        for arrangement in BOTH {
            let lattice = Lattice::try_new(arrangement, bounds, spacing).unwrap();
            let (with, without) = (surface(&field, &lattice, 0.0), surface(&Plain(&field), &lattice, 0.0));
            assert!(with.mesh == without.mesh && with.counts == without.counts, "{arrangement:?} {spacing}");
            assert!(with.counts.triangles > 100);
        }
    }
}
