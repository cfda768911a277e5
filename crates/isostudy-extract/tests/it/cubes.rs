//! Marching cubes against a slow and obvious one, and what it promises of every mesh.

use std::collections::HashMap;

use crate::fields::{FAMILIES, Numbers, Volume};
use crate::survey::survey;
use glam::Vec3;
use isostudy_cells::{Cell, Triangulator};
use isostudy_extract::{
    Arrangement, BoxGrid, ChunkExtractor, ChunkSettings, Cubes, Diagonals, Execution, Extraction, Extractor,
    Faces, Grid, Method, Placement, Source, VolumeCells, VolumeCellsError, from_fn, presets, weld_chunks,
};
use isostudy_field::{Asteroid, Gyroid, Sphere, StudyField};
use isostudy_mesh::topology::topology;
use isostudy_mesh::{Bounds, TriangleMesh};

const ONE: Execution = Execution { threads: 1 };
const FACES: [Faces; 4] = [Faces::SeparateInside, Faces::JoinInside, Faces::Decider, Faces::Trilinear];
const DIAGONALS: [Diagonals; 3] = [Diagonals::Fan, Diagonals::EdgeGroups, Diagonals::Quality];

fn cubes(faces: Faces, diagonals: Diagonals) -> Method {
    Method::Cubes(Cubes::default().with_faces(faces).with_diagonals(diagonals))
}

/// All samples of a field at whole coordinates, x fastest.
fn samples(field: &dyn StudyField, counts: [usize; 3]) -> Vec<f32> {
    let [nx, ny, nz] = counts;
    let places = (0..nx * ny * nz).map(|i| [i % nx, i / nx % ny, i / nx / ny]);
    places.map(|place| field.sample(Vec3::from_array(place.map(|x| x as f32)))).collect()
}

fn grid(counts: [usize; 3]) -> BoxGrid {
    let max = Vec3::from_array(counts.map(|n| (n - 1) as f32));
    BoxGrid { bounds: Bounds { min: Vec3::ZERO, max }, spacing: 1.0 }
}

/// Marching cubes as one would write it first: all samples at hand, every vertex in a map, cell by cell.
fn obvious(values: &[f32], counts: [usize; 3], faces: Faces, isovalue: f32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let cube = Cell::cube();
    let triangulator = Triangulator::new(&cube);
    let [nx, ny, nz] = counts;
    let at = |p: [usize; 3]| values[(p[2] * ny + p[1]) * nx + p[0]];
    let corner = |p: [usize; 3], c: usize| [p[0] + (c & 1), p[1] + (c >> 1 & 1), p[2] + (c >> 2)];
    let loops = |p: [usize; 3]| {
        let values: Vec<f32> = (0..8).map(|c| at(corner(p, c))).collect();
        let inside = (0..8).fold(0, |set, c| set | u32::from(values[c] > isovalue) << c);
        let joined = match faces {
            Faces::SeparateInside => 0,
            Faces::JoinInside => !0,
            _ => cube.faces().iter().enumerate().fold(0, |set, (f, face)| {
                let d: Vec<f64> =
                    face.iter().map(|&c| f64::from(values[usize::from(c)]) - f64::from(isovalue)).collect();
                let (mut even, mut odd) = (d[0] * d[2], d[1] * d[3]);
                if d[0] <= 0.0 {
                    (even, odd) = (odd, even);
                }
                set | u32::from(even > odd) << f
            }),
        };
        cube.loops(inside, joined)
    };
    let is_cell = |p: [usize; 3]| p[0] + 1 < nx && p[1] + 1 < ny && p[2] + 1 < nz;
    let places = || (0..nx * ny * nz).map(|i| [i % nx, i / nx % ny, i / nx / ny]);
    let mut positions = Vec::new();
    let mut on_edge = HashMap::new();
    let mut in_cell = HashMap::new();
    let point = |p: [usize; 3], axis: usize| {
        let mut q = p;
        q[axis] += 1;
        let mut point = Vec3::from_array(p.map(|x| x as f32));
        point[axis] += (isovalue - at(p)) / (at(q) - at(p));
        point
    };
    for p in places() {
        for axis in 0..3 {
            let mut q = p;
            q[axis] += 1;
            if q[axis] < counts[axis] && (at(p) > isovalue) != (at(q) > isovalue) {
                on_edge.insert((p, axis), positions.len() as u32);
                positions.push(point(p, axis));
            }
        }
        if is_cell(p) {
            for polygon in loops(p).into_iter().filter(|polygon| triangulator.fan(polygon).is_none()) {
                in_cell.insert((p, polygon.clone()), positions.len() as u32);
                let places = polygon.iter().map(|&e| {
                    let [a, b] = cube.edges()[usize::from(e)].map(usize::from);
                    point(corner(p, a), (a ^ b).trailing_zeros() as usize)
                });
                positions.push(places.sum::<Vec3>() / polygon.len() as f32);
            }
        }
    }
    let mut triangles = Vec::new();
    for p in places().filter(|&p| is_cell(p)) {
        let vertex = |e: u8| {
            let [a, b] = cube.edges()[usize::from(e)].map(usize::from);
            on_edge[&(corner(p, a), (a ^ b).trailing_zeros() as usize)]
        };
        for polygon in loops(p) {
            match triangulator.fan(&polygon) {
                Some(fan) => triangles.extend(fan.into_iter().map(|t| t.map(vertex))),
                None => {
                    let n = polygon.len();
                    let centre = in_cell[&(p, polygon.clone())];
                    triangles
                        .extend((0..n).map(|i| [vertex(polygon[i]), vertex(polygon[(i + 1) % n]), centre]));
                }
            }
        }
    }
    (positions, triangles)
}

/// Whole numbers by place, of few levels or many.
struct Noise {
    seed: u32,
    levels: u32,
}

impl StudyField for Noise {
    fn sample(&self, p: Vec3) -> f32 {
        let mut mixed =
            p.to_array().map(|x| x as i32 as u32).iter().fold(self.seed ^ 0x9e37_79b9, |h, &b| {
                let h = (h ^ b).wrapping_mul(0x85eb_ca6b);
                (h ^ h >> 13).wrapping_mul(0xc2b2_ae35) ^ h >> 16
            });
        mixed ^= mixed >> 15;
        (mixed % (2 * self.levels + 1)) as f32 - self.levels as f32
    }
}

fn bits(mesh: &TriangleMesh) -> [Vec<[u32; 3]>; 3] {
    let of = |points: &[Vec3]| points.iter().map(|p| p.to_array().map(f32::to_bits)).collect();
    [of(&mesh.positions), of(&mesh.normals), mesh.triangles.clone()]
}

#[test]
fn it_is_the_obvious_one() {
    let sizes =
        [[2, 2, 2], [5, 4, 7], [3, 9, 2], [64, 3, 3], [65, 4, 3], [66, 3, 40], [130, 3, 2], [9, 9, 70]];
    let mut extractor = Extractor::new();
    for (n, counts) in sizes.into_iter().enumerate() {
        for levels in [1, 3, 1000] {
            let field = Noise { seed: 31 * n as u32 + levels, levels };
            let values = samples(&field, counts);
            for faces in [Faces::SeparateInside, Faces::JoinInside, Faces::Decider] {
                let (positions, triangles) = obvious(&values, counts, faces, 0.25);
                let method = cubes(faces, Diagonals::Fan);
                let mut first: Option<TriangleMesh> = None;
                for (source, threads) in [
                    (Source::Samples(&values), 1),
                    (Source::Samples(&values), 3),
                    (Source::Study(&field), 1),
                    (Source::Study(&field), 2),
                ] {
                    let execution = Execution { threads };
                    let found =
                        method.extract(&mut extractor, source, &grid(counts), 0.25, &execution).unwrap();
                    assert!(found.mesh.triangles == triangles, "{counts:?} {levels} {faces:?}");
                    assert_eq!(found.mesh.positions.len(), positions.len());
                    for (is, wanted) in found.mesh.positions.iter().zip(&positions) {
                        assert!(is.distance(*wanted) < 1e-4, "{is} for {wanted}");
                    }
                    let first = first.get_or_insert_with(|| found.mesh.clone());
                    assert!(bits(first) == bits(&found.mesh));
                }
            }
        }
    }
}

/// All ways of extracting and all threads give one mesh, also where cells have tunnels and samples choose the diagonals.
#[test]
fn threads_and_sources_do_not_show() {
    let (asteroid, gyroid) = (Asteroid::default(), Gyroid { frequency: 14.0 });
    let bounds = Bounds { min: Vec3::splat(-1.0), max: Vec3::new(1.0, 0.93, 1.21) };
    let box_grid = BoxGrid { bounds, spacing: 0.05 };
    let mut extractor = Extractor::new();
    for faces in FACES {
        for diagonals in DIAGONALS {
            let method = cubes(faces, diagonals);
            for field in [&asteroid as &dyn StudyField, &gyroid, &Plain(&asteroid)] {
                let run = |extractor: &mut Extractor, threads| {
                    method.extract(extractor, field.into(), &box_grid, 0.0, &Execution { threads }).unwrap()
                };
                let one = run(&mut extractor, 1);
                assert!(one.counts.triangles > 2000);
                for threads in [2, 5] {
                    let other = run(&mut extractor, threads);
                    assert_eq!(other.counts, one.counts);
                    assert!(bits(&other.mesh) == bits(&one.mesh), "{faces:?} {diagonals:?} {threads}");
                }
            }
            // A field that says nothing of itself is sampled everywhere.
            let run = |field: &dyn StudyField| {
                method.extract(&mut Extractor::new(), field.into(), &box_grid, 0.0, &ONE).unwrap().mesh
            };
            assert!(bits(&run(&asteroid)) == bits(&run(&Plain(&asteroid))));
        }
    }
}

/// A field without bounds.
struct Plain<'a>(&'a dyn StudyField);

impl StudyField for Plain<'_> {
    fn sample(&self, p: Vec3) -> f32 {
        self.0.sample(p)
    }
}

/// The oracle is a walk along sides and round vertices that knows nothing of methods.
#[test]
fn every_mesh_is_an_oriented_manifold_closed_off_the_box() {
    let mut extractor = Extractor::new();
    for (family, seed) in FAMILIES.into_iter().flat_map(|family| [1, 2, 3, 4].map(|seed| (family, seed))) {
        for is_closed in [false, true] {
            let volume = Volume::random(Arrangement::SimpleCubic, 6, family, seed);
            let volume = if is_closed { volume.closed() } else { volume };
            let lattice = BoxGrid::from(&volume.lattice());
            for faces in FACES {
                for diagonals in DIAGONALS {
                    let what = format!("{family:?} {seed} {is_closed} {faces:?} {diagonals:?}");
                    let method = cubes(faces, diagonals);
                    let source = Source::Study(&volume);
                    let mesh = method.extract(&mut extractor, source, &lattice, 0.0, &ONE).unwrap().mesh;
                    let components = survey(mesh.positions.len(), &mesh.triangles)
                        .unwrap_or_else(|fault| panic!("{what}: {fault}"));
                    let loops: u64 = components.iter().map(|component| component.1 as u64).sum();
                    assert!(!is_closed || loops == 0, "{what} is open");
                    let report = topology(&mesh);
                    let faults = [
                        report.non_manifold_edges,
                        report.misoriented_edges,
                        report.non_manifold_vertices,
                        report.duplicate_faces,
                        report.collapsed_triangles,
                        report.unused_vertices,
                    ];
                    assert_eq!(faults, [0; 6], "{what}");
                    let box_of = Bounds { min: Vec3::ZERO, max: Vec3::splat(6.0) };
                    let is_in = |p: &Vec3| p.cmpge(box_of.min).all() && p.cmple(box_of.max).all();
                    assert!(mesh.positions.iter().all(is_in), "{what}");
                }
            }
        }
    }
}

#[test]
fn chunks_weld_to_the_whole() {
    let mut numbers = Numbers::new(5);
    let volumes = FAMILIES.map(|family| Volume::random(Arrangement::SimpleCubic, 9, family, 1));
    let asteroid = Asteroid::default();
    let round = BoxGrid { bounds: Bounds { min: Vec3::splat(-1.0), max: Vec3::splat(1.07) }, spacing: 0.1 };
    let fields = volumes.iter().map(|volume| (volume as &dyn StudyField, grid([10; 3])));
    let fields: Vec<_> = fields.chain([(&asteroid as &dyn StudyField, round)]).collect();
    for (field, grid) in fields {
        for faces in FACES {
            let diagonals = DIAGONALS[numbers.below(3) as usize];
            let method = cubes(faces, diagonals);
            let whole = method.extract(&mut Extractor::new(), field.into(), &grid, 0.0, &ONE);
            let mut extractor = ChunkExtractor::in_box(&grid, &method, &ChunkSettings::default()).unwrap();
            for size in [1 + numbers.below(4) as u32, 7] {
                let boxes: Vec<_> = extractor.grid(size).collect();
                let mut parts: Vec<_> =
                    boxes.into_iter().map(|cells| extractor.extract(field, cells, &ONE).unwrap()).collect();
                parts.reverse();
                for part in &parts {
                    assert!(part.keys.is_sorted() && part.triangle_cells.is_sorted());
                }
                let welded = weld_chunks(&parts).unwrap();
                assert!(
                    bits(&welded) == bits(&whole.as_ref().unwrap().mesh),
                    "{faces:?} {diagonals:?} {size}"
                );
            }
        }
    }
}

/// Every family of samples, so that many moves are refused.
#[test]
fn moved_vertices_weld_to_the_whole() {
    for (family, faces) in FAMILIES.into_iter().zip(FACES.into_iter().cycle()) {
        let volume = Volume::random(Arrangement::SimpleCubic, 9, family, 3);
        let grid = BoxGrid::from(&volume.lattice());
        for placement in [Placement::Projected, Placement::Relaxed] {
            let method = Method::Cubes(Cubes::default().with_faces(faces).with_placement(placement));
            assert!(method.promises().chunks);
            let source = Source::Study(&volume);
            let whole = method.extract(&mut Extractor::new(), source, &grid, 0.0, &ONE).unwrap().mesh;
            let mut extractor = ChunkExtractor::in_box(&grid, &method, &ChunkSettings::default()).unwrap();
            let boxes: Vec<_> = extractor.grid(5).collect();
            let parts: Vec<_> =
                boxes.into_iter().map(|cells| extractor.extract(source, cells, &ONE).unwrap()).collect();
            assert!(
                bits(&weld_chunks(&parts).unwrap()) == bits(&whole),
                "{family:?} {faces:?} {placement:?}"
            );
        }
    }
}

/// In grids without an end, also far away, what is welded of small chunks is what is welded of large ones, and closed.
#[test]
fn chunks_of_any_size_weld_to_the_same_mesh() {
    for (origin, spacing) in [([0.0; 3], 0.3), ([-7.3, 1e3, -41.7], 0.3), ([16e3, -1e4, 3.1], 1.0 / 3.0)] {
        let grid = Grid::try_new(origin, spacing).unwrap();
        let centre = Vec3::from_array(origin.map(|x| x as f32)) + Vec3::new(0.1, -0.2, 0.1);
        let ball = from_fn(move |p: [f32; 3]| {
            let from = Vec3::from(p) - centre;
            2.6 - from.length() + 0.4 * (5.0 * from.x).sin() * (4.0 * from.y).cos() * (6.0 * from.z).sin()
        });
        for (faces, diagonals) in FACES.into_iter().zip(DIAGONALS.into_iter().cycle()) {
            let method = cubes(faces, diagonals);
            let mut extractor = ChunkExtractor::try_new(&grid, &method, &ChunkSettings::default()).unwrap();
            let mut welded = |size: u32, reach: i32| {
                let ids = (0..(2 * reach).pow(3)).map(|i| {
                    let n = 2 * reach;
                    [i % n - reach, i / n % n - reach, i / n / n - reach]
                });
                let chunks: Vec<_> =
                    ids.map(|id| extractor.extract(&ball, grid.chunk(id, size), &ONE).unwrap()).collect();
                weld_chunks(&chunks).unwrap()
            };
            let (large, small) = (welded(16, 1), welded(4, 4));
            assert!(large.triangles.len() > 1000);
            assert!(bits(&large) == bits(&small), "{faces:?} {diagonals:?} {origin:?}");
            let pieces = survey(large.positions.len(), &large.triangles).unwrap();
            assert!(pieces.iter().all(|piece| piece.1 == 0), "{faces:?}: it is open");
        }
    }
}

/// Samples of the window, or of more than that, in place of the field.
#[test]
fn a_window_of_samples_gives_the_chunk_of_the_field() {
    let grid = Grid::try_new([0.5, -3.0, 12.0], 0.25).unwrap();
    let wave = from_fn(|[x, y, z]: [f32; 3]| (3.0 * x).sin() + (2.0 * y).cos() - (z - 12.0).sin());
    for faces in FACES {
        let method = cubes(faces, Diagonals::Fan);
        let mut extractor = ChunkExtractor::try_new(&grid, &method, &ChunkSettings::default()).unwrap();
        let cells = grid.chunk([-1, 0, 2], 8);
        let of_field = extractor.extract(&wave, cells, &ONE).unwrap();
        assert!(of_field.triangles.len() > 50);
        let window = extractor.window(cells).unwrap().unwrap();
        let [start, end] = [window.start.map(|i| i - 1), window.end.map(|i| i + 3)];
        for given in [window, isostudy_extract::CellBox { start, end }] {
            let mut samples = Vec::new();
            extractor.layout(given).unwrap().fill(&wave, &mut samples);
            let of_samples =
                extractor.extract(Source::Window { cells: given, samples: &samples }, cells, &ONE).unwrap();
            assert_eq!(of_samples, of_field, "{faces:?}");
        }
    }
}

#[test]
fn a_sphere_is_a_sphere() {
    let sphere: &dyn StudyField = &Sphere { radius: 1.0 };
    let round =
        |spacing| BoxGrid { bounds: Bounds { min: Vec3::splat(-1.13), max: Vec3::splat(1.13) }, spacing };
    let volume = 4.0 / 3.0 * std::f64::consts::PI;
    for faces in FACES {
        for diagonals in DIAGONALS {
            let method = cubes(faces, diagonals);
            let mut errors = Vec::new();
            for spacing in [0.1, 0.05] {
                let Extraction { mesh, counts, .. } =
                    method.extract(&mut Extractor::new(), sphere.into(), &round(spacing), 0.0, &ONE).unwrap();
                let report = topology(&mesh);
                assert!(report.is_closed_manifold());
                assert_eq!((report.components, report.euler_characteristic), (1, 2));
                assert_eq!(
                    (counts.vertices, counts.crossings),
                    (mesh.positions.len() as u64, counts.vertices)
                );
                assert_eq!(counts.tetrahedra, None);
                let outward = |(p, n): (&Vec3, &Vec3)| p.normalize().dot(*n) > 0.95;
                assert!(mesh.positions.iter().zip(&mesh.normals).all(outward));
                errors.push(volume - mesh.volume());
            }
            // Inscribed, so too small, by a share that falls with the square of the spacing.
            assert!(errors.iter().all(|error| *error > 0.0), "{errors:?}");
            assert!((3.5..4.6).contains(&(errors[0] / errors[1])), "{errors:?}");
        }
    }
}

/// Placements move vertices nearer to the surface and change no triangle.
#[test]
fn placements_change_positions_only() {
    let sphere: &dyn StudyField = &Sphere { radius: 1.0 };
    let bounds = Bounds { min: Vec3::splat(-1.13), max: Vec3::splat(1.13) };
    let grid = BoxGrid { bounds, spacing: 0.2 };
    let run = |placement, refine_crossings, threads| {
        let method = Cubes::default()
            .with_placement(placement)
            .with_refine_crossings(refine_crossings)
            .with_faces(Faces::Trilinear);
        Method::Cubes(method)
            .extract(&mut Extractor::new(), sphere.into(), &grid, 0.0, &Execution { threads })
            .unwrap()
            .mesh
    };
    let off = |mesh: &TriangleMesh| {
        let off = mesh.positions.iter().map(|p| f64::from((p.length() - 1.0).abs()));
        off.sum::<f64>() / mesh.positions.len() as f64
    };
    let plain = run(Placement::MeanOfCrossings, false, 1);
    for (placement, refine) in [
        (Placement::MeanOfCrossings, true),
        (Placement::Projected, false),
        (Placement::Relaxed, false),
        (Placement::CurvatureWeighted, false),
    ] {
        let moved = run(placement, refine, 1);
        assert_eq!(moved.triangles, plain.triangles);
        assert!(bits(&run(placement, refine, 3)) == bits(&moved));
        match placement {
            Placement::CurvatureWeighted => assert!(off(&moved) < 1.01 * off(&plain)),
            _ => assert!(off(&moved) < 0.1 * off(&plain), "{placement:?}: {} {}", off(&moved), off(&plain)),
        }
    }
}

/// The mean radius ratio grows from fans to edge groups to quality; the sum per cell is what quality makes largest.
#[test]
fn diagonals_make_better_triangles() {
    let asteroid = Asteroid::default();
    let bounds = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };
    let mut means = Vec::new();
    for diagonals in DIAGONALS {
        let method = cubes(Faces::SeparateInside, diagonals);
        let grid = BoxGrid { bounds, spacing: 0.04 };
        let source = Source::Study(&asteroid);
        let mesh = method.extract(&mut Extractor::new(), source, &grid, 0.0, &ONE).unwrap().mesh;
        let corners = |t: usize| mesh.corners(t).map(|p| p.to_array().map(f64::from));
        let sum: f64 = (0..mesh.triangles.len()).map(|t| isostudy_cells::radius_ratio(corners(t))).sum();
        means.push((sum / mesh.triangles.len() as f64, mesh.triangles.len()));
    }
    assert!(means[0].0 < means[1].0 && means[1].0 < means[2].0, "{means:?}");
    assert!(means.iter().all(|(_, triangles)| *triangles == means[0].1));
}

/// A plane through samples: every vertex lies within a few steps of single precision of it, and no triangle is without area.
#[test]
fn samples_on_the_level_make_no_empty_triangles() {
    struct Steps;
    impl StudyField for Steps {
        fn sample(&self, p: Vec3) -> f32 {
            (p.x + p.y + p.z).floor() - 7.0
        }
    }
    for faces in FACES {
        let mesh = cubes(faces, Diagonals::Fan)
            .extract(&mut Extractor::new(), Source::Study(&Steps), &grid([7; 3]), 0.0, &ONE)
            .unwrap()
            .mesh;
        assert!(mesh.positions.len() > 50);
        for p in &mesh.positions {
            assert!((p.element_sum() - 7.0).abs() < 1e-4);
        }
        for t in &mesh.triangles {
            let [a, b, c] = t.map(|v| mesh.positions[v as usize].as_dvec3());
            let normal = (b - a).cross(c - a);
            assert!(normal.length() > 0.0);
            assert!(normal.normalize().dot(glam::DVec3::splat(-1.0)) > 0.5, "it faces down");
        }
    }
}

/// Turned, mirrored, sheared and unequal steps: the same triangles, in space, facing outward.
#[test]
fn a_volume_has_its_own_cells_whatever_its_steps() {
    let counts = [9, 8, 11];
    let ball = |p: [usize; 3]| {
        let centre = [4.0, 3.5, 5.0];
        3.0 - (0..3).map(|k| (p[k] as f32 - centre[k]).powi(2)).sum::<f32>().sqrt()
    };
    let places = (0..counts.iter().product()).map(|i: usize| [i % 9, i / 9 % 8, i / 72]);
    let values: Vec<f32> = places.map(ball).collect();
    let unit = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let turned = [[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0], [0.0, 0.0, 2.5]];
    let mirrored = [[-0.5, 0.0, 0.0], [0.0, 1.0, 0.0], [0.1, 0.0, 1.0]];
    let run = |steps, origin| {
        let volume = VolumeCells { counts, values: &values, origin, steps };
        let method = cubes(Faces::Trilinear, Diagonals::EdgeGroups);
        volume.extract(&method, &mut Extractor::new(), 0.0, &ONE).unwrap().mesh
    };
    let plain = run(unit, [0.0; 3]);
    for (steps, determinant) in [(turned, 2.5), (mirrored, 0.5)] {
        let mesh = run(steps, [10.0, -3.0, 0.5]);
        assert_eq!(mesh.triangles.len(), plain.triangles.len());
        assert!(topology(&mesh).is_closed_manifold());
        let ratio = mesh.volume() / plain.volume();
        assert!((ratio - determinant).abs() < 1e-4, "{ratio}");
        for (a, b) in mesh.positions.iter().zip(&plain.positions) {
            let wanted: Vec<f64> = (0..3)
                .map(|k| [10.0, -3.0, 0.5][k] + (0..3).map(|j| steps[j][k] * f64::from(b[j])).sum::<f64>())
                .collect();
            assert!((0..3).all(|k| (f64::from(a[k]) - wanted[k]).abs() < 1e-5));
        }
    }
    let flat = VolumeCells { counts, values: &values, origin: [0.0; 3], steps: [unit[0], unit[0], unit[2]] };
    let method = cubes(Faces::Decider, Diagonals::Fan);
    let error = flat.extract(&method, &mut Extractor::new(), 0.0, &ONE).unwrap_err();
    assert!(matches!(error, VolumeCellsError::Steps { .. }));
    let other = presets().iter().find(|preset| preset.id == "bi").unwrap().method;
    let whole = VolumeCells { steps: unit, ..flat };
    let error = whole.extract(&other, &mut Extractor::new(), 0.0, &ONE).unwrap_err();
    assert_eq!(error, VolumeCellsError::Method);
}
