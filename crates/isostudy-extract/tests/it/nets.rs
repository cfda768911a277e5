//! Surface nets against counts by brute force, every pattern of two cells, marching cubes, and the numbers of other programs.

use glam::Vec3;
use isostudy_cells::Cell;
use isostudy_extract::{
    BoxGrid, ChunkExtractor, ChunkSettings, Cubes, Execution, Extractor, Method, Source, SurfaceNets,
    weld_chunks,
};
use isostudy_field::{Gyroid, StudyField};
use isostudy_mesh::topology::topology;
use isostudy_mesh::{Bounds, TriangleMesh};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

const ONE: Execution = Execution { threads: 1 };
const NETS: Method = Method::SurfaceNets(SurfaceNets::new());
const MANIFOLD: Method = Method::SurfaceNets(SurfaceNets::new().with_patches(true));

/// Samples of a box, x fastest, with steps of 1.
struct Volume {
    size: [usize; 3],
    values: Vec<f32>,
}

impl Volume {
    fn of(size: [usize; 3], mut value: impl FnMut([usize; 3]) -> f32) -> Self {
        let places = (0..size[2]).flat_map(|z| (0..size[1]).map(move |y| [y, z]));
        let places = places.flat_map(|[y, z]| (0..size[0]).map(move |x| [x, y, z]));
        Self { size, values: places.map(&mut value).collect() }
    }

    /// White noise, closed off by samples outside if wanted.
    fn noise(size: [usize; 3], seed: u64, closed: bool) -> Self {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        Self::of(size, |place| {
            let value = random.random::<f32>() - 0.5;
            let at_box = (0..3).any(|axis| place[axis] == 0 || place[axis] + 1 == size[axis]);
            if closed && at_box { -1.0 } else { value }
        })
    }

    fn at(&self, [x, y, z]: [usize; 3]) -> f32 {
        self.values[(z * self.size[1] + y) * self.size[0] + x]
    }

    fn grid(&self) -> BoxGrid {
        let max = Vec3::from_array(self.size.map(|n| (n - 1) as f32));
        BoxGrid { bounds: Bounds { min: Vec3::ZERO, max }, spacing: 1.0 }
    }

    fn mesh(&self, method: &Method) -> TriangleMesh {
        let source = Source::Samples(&self.values);
        method.extract(&mut Extractor::new(), source, &self.grid(), 0.0, &ONE).unwrap().mesh
    }

    /// Corners that are inside, one bit each.
    fn inside(&self, [x, y, z]: [usize; 3]) -> u32 {
        let corner = |c: usize| [x + (c & 1), y + (c >> 1 & 1), z + (c >> 2)];
        (0..8).fold(0, |set, c| set | u32::from(self.at(corner(c)) > 0.0) << c)
    }

    fn cells(&self) -> impl Iterator<Item = [usize; 3]> {
        let [nx, ny, nz] = self.size.map(|n| n - 1);
        (0..nx * ny * nz).map(move |i| [i % nx, i / nx % ny, i / nx / ny])
    }

    /// Crossed edges that four cells share, as the point they begin at and their axis.
    fn shared_crossings(&self) -> Vec<([usize; 3], usize)> {
        let [nx, ny, nz] = self.size;
        let points = (0..nx * ny * nz).map(|i| [i % nx, i / nx % ny, i / nx / ny]);
        let edges = points.flat_map(|point| (0..3).map(move |axis| (point, axis)));
        let is_shared = |&(point, axis): &([usize; 3], usize)| {
            let mut end = point;
            end[axis] += 1;
            let is_inner = |other: usize| 0 < point[other] && point[other] + 1 < self.size[other];
            end[axis] < self.size[axis]
                && (0..3).all(|other| other == axis || is_inner(other))
                && (self.at(point) > 0.0) != (self.at(end) > 0.0)
        };
        edges.filter(is_shared).collect()
    }
}

/// A vertex in each crossed cell that has a quadrilateral, two triangles round each shared crossing, each with the surface's side
/// to the outside of its edge.
#[test]
fn counts_are_those_of_cells_and_crossings() {
    for (seed, closed) in (0..40).flat_map(|seed| [(seed, false), (seed, true)]) {
        let volume = Volume::noise([7, 6, 9], seed, closed);
        let mesh = volume.mesh(&NETS);
        let crossings = volume.shared_crossings();
        assert_eq!(mesh.triangles.len(), 2 * crossings.len());
        let has_one = |cell: &[usize; 3]| {
            let touches = |&(point, axis): &([usize; 3], usize)| {
                (0..3).all(|a| {
                    if a == axis { point[a] == cell[a] } else { (cell[a]..=cell[a] + 1).contains(&point[a]) }
                })
            };
            crossings.iter().any(touches)
        };
        assert_eq!(mesh.positions.len(), volume.cells().filter(has_one).count());
        let mut left = crossings;
        for pair in mesh.triangles.chunks(2) {
            // The four vertices are in the four cells round the edge: its middle is between them in two axes.
            let corners: Vec<Vec3> = pair.iter().flatten().map(|&v| mesh.positions[v as usize]).collect();
            let cells: Vec<[usize; 3]> =
                corners.iter().map(|p| p.to_array().map(|x| x.floor() as usize)).collect();
            let is_round = |&(point, axis): &([usize; 3], usize)| {
                cells.iter().all(|cell| {
                    (0..3).all(|a| {
                        if a == axis {
                            cell[a] == point[a]
                        } else {
                            point[a] - 1 == cell[a] || point[a] == cell[a]
                        }
                    })
                }) && (0..3).all(|a| a == axis || cells.iter().any(|cell| cell[a] != cells[0][a]))
            };
            let at = left.iter().position(is_round).expect("an edge of its own");
            let (point, axis) = left.swap_remove(at);
            // The two triangles together face the end that is outside.
            let area: Vec3 = pair
                .iter()
                .map(|t| t.map(|v| mesh.positions[v as usize]))
                .map(|[a, b, c]| (b - a).cross(c - a))
                .sum();
            assert_eq!(area[axis] > 0.0, volume.at(point) > 0.0, "{point:?} along {axis}");
        }
    }
}

/// A vertex is the mean of the crossings of its cell's edges, computed here in double precision.
#[test]
fn vertices_are_means_of_crossings() {
    let volume = Volume::noise([8, 8, 8], 3, true);
    let mesh = volume.mesh(&NETS);
    let cube = Cell::cube();
    let mut means = Vec::new();
    for cell in volume.cells() {
        let inside = volume.inside(cell);
        let crossed: Vec<usize> = (0..12).filter(|&e| cube.crossed(inside) >> e & 1 != 0).collect();
        if crossed.is_empty() {
            continue;
        }
        let mut sum = [0.0; 3];
        for &e in &crossed {
            let ends = cube.edges()[e].map(|c| {
                let c = usize::from(c);
                [cell[0] + (c & 1), cell[1] + (c >> 1 & 1), cell[2] + (c >> 2)]
            });
            let [a, b] = ends.map(|end| f64::from(volume.at(end)));
            (0..3).for_each(|i| {
                sum[i] += ends[0][i] as f64 + a / (a - b) * (ends[1][i] as f64 - ends[0][i] as f64);
            });
        }
        means.push(sum.map(|s| s / crossed.len() as f64));
    }
    assert_eq!(means.len(), mesh.positions.len());
    // Both go by cells in storage order. Crossings keep a small distance from the ends of their edges.
    for (mean, position) in means.iter().zip(&mesh.positions) {
        for (is, want) in position.to_array().into_iter().zip(mean) {
            assert!((f64::from(is) - want).abs() < 2e-3, "{position} {mean:?}");
        }
    }
}

/// Every pattern of the twelve corners of two neighbours, along each axis, closed off by samples outside.
#[test]
fn two_cells_of_any_pattern_make_a_manifold() {
    let (mut bad_without, mut four_sided) = (0, 0);
    for axis in 0..3 {
        for pattern in 1..4096_u32 {
            let mut long = [2; 3];
            long[axis] = 3;
            let size = long.map(|n| n + 2);
            let volume = Volume::of(size, |place| {
                let inner = place.map(|p| p.wrapping_sub(1));
                if (0..3).any(|a| inner[a] >= long[a]) {
                    return -1.0;
                }
                let bit = (inner[2] * long[1] + inner[1]) * long[0] + inner[0];
                if pattern >> bit & 1 != 0 { 1.0 } else { -1.0 }
            });
            let found = topology(&volume.mesh(&MANIFOLD));
            assert!(
                found.is_closed_manifold() && found.unused_vertices == 0,
                "{axis} {pattern:b}: {found:?}"
            );
            let plain = topology(&volume.mesh(&NETS));
            assert_eq!((plain.boundary_edges, plain.misoriented_edges), (0, 0));
            bad_without += u32::from(!plain.is_closed_manifold());
            four_sided += u32::from(plain.non_manifold_edges > 0);
        }
    }
    // The plain nets of many patterns are none: the test would see it.
    assert!(bad_without > 3 * 500 && four_sided > 0, "{bad_without} {four_sided}");
}

/// A million cells of white noise: no defect, and the Euler characteristic of marching cubes with the same faces. On each face that two
/// cells join, each of their loops becomes two.
#[test]
fn a_million_random_cells_have_no_defect() {
    let cube = Cell::cube();
    let joinable: Vec<Option<usize>> = (0..256)
        .map(|inside| {
            let loops = cube.loops(inside, 0);
            (0..6).find(|&face| {
                let edges = &cube.face_edges()[face];
                cube.ambiguous_faces(inside) >> face & 1 != 0
                    && loops.iter().any(|of| edges.iter().all(|edge| of.contains(edge)))
            })
        })
        .collect();
    let side_of = |face: usize| {
        let corners = &cube.faces()[face];
        let axis =
            (0..3).find(|axis| corners.iter().all(|c| c >> axis & 1 == corners[0] >> axis & 1)).unwrap();
        (axis, corners[0] >> axis & 1)
    };
    let mut joined_in_all = 0;
    for seed in 0..30 {
        let volume = Volume::noise([34; 3], seed, seed % 3 != 0);
        let found = topology(&volume.mesh(&MANIFOLD));
        let faults = [
            found.unused_vertices,
            found.non_manifold_edges,
            found.non_manifold_vertices,
            found.misoriented_edges,
            found.duplicate_faces,
            found.collapsed_triangles,
        ];
        assert_eq!(faults, [0; 6], "{seed}");
        if seed % 3 == 0 {
            continue;
        }
        assert_eq!(found.boundary_edges, 0);
        let joined = volume
            .cells()
            .filter(|&cell| {
                let Some(face) = joinable[volume.inside(cell) as usize] else { return false };
                let (axis, side) = side_of(face);
                if side == 0 {
                    return false;
                }
                let mut other = cell;
                other[axis] += 1;
                other[axis] + 1 < volume.size[axis]
                    && joinable[volume.inside(other) as usize].is_some_and(|face| side_of(face) == (axis, 0))
            })
            .count() as i64;
        joined_in_all += joined;
        let cubes = topology(&volume.mesh(&Method::Cubes(Cubes::default())));
        assert_eq!(found.euler_characteristic, cubes.euler_characteristic + 2 * joined, "{seed}");
    }
    assert!(joined_in_all > 100, "{joined_in_all}");
}

/// Counts by fast-surface-nets 0.2.1 and vtkSurfaceNets3D 9.7.1 on 65^3 samples of [-1, 1]^3.
#[test]
fn counts_are_those_of_other_programs() {
    struct Formula<F>(F);
    impl<F: Fn(Vec3) -> f32 + Sync> StudyField for Formula<F> {
        fn sample(&self, p: Vec3) -> f32 {
            (self.0)(p)
        }
    }
    let grid = BoxGrid { bounds: Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE }, spacing: 1.0 / 32.0 };
    let count = |field: &dyn StudyField, method: &Method| {
        let mesh =
            method.extract(&mut Extractor::new(), Source::Study(field), &grid, 0.0, &ONE).unwrap().mesh;
        let found = topology(&mesh);
        (mesh.positions.len(), mesh.triangles.len() / 2, found.non_manifold_edges, found.euler_characteristic)
    };
    let sphere = Formula(|p: Vec3| 0.8013 - p.length());
    let ring = |p: Vec3| 0.2013 - Vec3::new(p.truncate().length() - 0.5, p.z, 0.0).length();
    let cube = Formula(|p: Vec3| 0.6013 - p.abs().max_element());
    for method in [NETS, MANIFOLD] {
        assert_eq!(count(&sphere, &method), (12_464, 12_462, 0, 2));
        assert_eq!(count(&Formula(ring), &method), (5_904, 5_904, 0, 0));
        assert_eq!(count(&cube, &method), (9_128, 9_126, 0, 2));
    }
    // A gyroid that a ball cuts off has sheets that share cells. As published it is negative inside.
    let gyroid = |p: Vec3| {
        let [x, y, z] = (9.0 * p).to_array();
        let wall = (x.sin() * y.cos() + y.sin() * z.cos() + z.sin() * x.cos()) / 9.0;
        -wall.max(p.length() - 0.9017)
    };
    let gyroid = Formula(gyroid);
    let of_cubes = Method::Cubes(Cubes::default());
    let (_, _, _, primal) = count(&gyroid, &of_cubes);
    let (vertices, quads, four_sided, _) = count(&gyroid, &NETS);
    assert_eq!((vertices, quads, four_sided), (29_013, 29_184, 96));
    assert_eq!(count(&gyroid, &MANIFOLD), (29_136, 29_184, 0, -48));
    assert_eq!(primal, -48);
}

/// Means of points on a sphere are inside of it, by the square of the spacing: their mean distance from it falls to a quarter with half
/// the spacing.
#[test]
fn smooth_surfaces_converge_by_squares() {
    struct Ball;
    impl StudyField for Ball {
        fn sample(&self, p: Vec3) -> f32 {
            0.8013 - p.length()
        }
    }
    for method in [NETS, MANIFOLD] {
        let errors = [16, 32, 64, 128].map(|cells| {
            let bounds = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };
            let grid = BoxGrid { bounds, spacing: 2.0 / cells as f32 };
            let source = Source::Study(&Ball);
            let mesh = method.extract(&mut Extractor::new(), source, &grid, 0.0, &ONE).unwrap().mesh;
            let below = mesh.positions.iter().map(|p| 0.8013 - p.as_dvec3().length());
            assert!(below.clone().all(|below| below > -1e-6));
            below.sum::<f64>() / mesh.positions.len() as f64
        });
        for pair in errors.windows(2) {
            assert!((3.7..4.1).contains(&(pair[0] / pair[1])), "{errors:?}");
        }
    }
}

/// The mesh is one for any number of threads, and chunks of any size weld to it.
#[test]
fn threads_and_chunks_do_not_show() {
    let gyroid = Gyroid { frequency: 9.0 };
    let bounds = Bounds { min: Vec3::splat(-1.03), max: Vec3::new(1.1, 0.9, 2.4) };
    let grid = BoxGrid { bounds, spacing: 0.05 };
    let smoothed = [false, true].into_iter().flat_map(|patches| {
        [1, 4].map(|smoothing| {
            Method::SurfaceNets(SurfaceNets::default().with_patches(patches).with_smoothing(smoothing))
        })
    });
    for method in [NETS, MANIFOLD].into_iter().chain(smoothed) {
        let field: &dyn StudyField = &gyroid;
        let of = |threads| {
            let execution = Execution { threads };
            method.extract(&mut Extractor::new(), field.into(), &grid, 0.0, &execution).unwrap().mesh
        };
        let whole = of(1);
        assert!(whole.triangles.len() > 5_000);
        for threads in [2, 3, 5] {
            assert_eq!(of(threads), whole, "{threads}");
        }
        let mut chunks = ChunkExtractor::in_box(&grid, &method, &ChunkSettings::default()).unwrap();
        for side in [5, 16] {
            let boxes: Vec<_> = chunks.grid(side).collect();
            let parts: Vec<_> = boxes
                .into_iter()
                .map(|cells| chunks.extract(Source::Study(field), cells, &ONE).unwrap())
                .collect();
            assert_eq!(weld_chunks(&parts).unwrap(), whole, "chunks of {side}");
        }
    }
}

/// What is inside and what is outside may change places: the same vertices and triangles, turned round.
#[test]
fn turning_the_field_round_turns_the_triangles() {
    let volume = Volume::noise([12, 11, 10], 5, false);
    let turned = Volume { size: volume.size, values: volume.values.iter().map(|value| -value).collect() };
    let (mesh, other) = (volume.mesh(&NETS), turned.mesh(&NETS));
    assert_eq!(mesh.positions.len(), other.positions.len());
    for (p, q) in mesh.positions.iter().zip(&other.positions) {
        assert!(p.distance(*q) < 1e-5);
    }
    let sorted = |triangles: &[[u32; 3]]| {
        let mut sorted: Vec<[u32; 3]> = triangles.to_vec();
        sorted.iter_mut().for_each(|t| t.sort_unstable());
        sorted.sort_unstable();
        sorted
    };
    assert_eq!(sorted(&mesh.triangles), sorted(&other.triangles));
}

/// Steps computed here in double precision: two cells are linked where the face between them has a crossing. No vertex leaves its cell,
/// and quadrilaterals stay those that they were.
#[test]
fn smoothing_goes_half_the_way_to_linked_cells() {
    let volume = Volume::noise([9, 8, 10], 4, true);
    let plain = volume.mesh(&NETS);
    let cells: Vec<[usize; 3]> =
        plain.positions.iter().map(|p| p.to_array().map(|x| x.floor() as usize)).collect();
    let crossings = volume.shared_crossings();
    // Off the box every crossed edge of a face has a quadrilateral.
    let is_linked = |a: [usize; 3], b: [usize; 3]| {
        let steps = [0, 1, 2].map(|axis| a[axis].abs_diff(b[axis]));
        steps.iter().sum::<usize>() == 1
            && crossings.iter().any(|&(point, axis)| {
                [a, b]
                    .iter()
                    .all(|cell| (0..3).all(|i| point[i] == cell[i] || (i != axis && point[i] == cell[i] + 1)))
            })
    };
    let links: Vec<Vec<usize>> = cells
        .iter()
        .map(|&a| (0..cells.len()).filter(|&other| is_linked(a, cells[other])).collect())
        .collect();
    let mut wanted: Vec<[f64; 3]> = plain.positions.iter().map(|p| p.to_array().map(f64::from)).collect();
    let quads = |mesh: &TriangleMesh| -> Vec<Vec<u32>> {
        let of = |pair: &[[u32; 3]]| {
            let mut all = pair.concat();
            all.sort_unstable();
            all.dedup();
            all
        };
        mesh.triangles.chunks(2).map(of).collect()
    };
    let mut at_sides = 0;
    for steps in 1..=6 {
        let before = wanted.clone();
        for (v, place) in wanted.iter_mut().enumerate() {
            for axis in 0..3 {
                let mean =
                    links[v].iter().map(|&other| before[other][axis]).sum::<f64>() / links[v].len() as f64;
                let low = cells[v][axis] as f64;
                place[axis] = f64::midpoint(before[v][axis], mean).clamp(low, low + 1.0);
            }
        }
        let mesh = volume.mesh(&Method::SurfaceNets(SurfaceNets::default().with_smoothing(steps)));
        for (p, want) in mesh.positions.iter().zip(&wanted) {
            let is_there =
                p.to_array().iter().zip(want).all(|(is, want)| (f64::from(*is) - want).abs() < 1e-4);
            assert!(is_there, "{steps}: {p} {want:?}");
        }
        for (p, cell) in mesh.positions.iter().zip(&cells) {
            for (x, low) in p.to_array().iter().zip(cell) {
                let beyond = x - *low as f32;
                assert!((0.0..=1.0).contains(&beyond));
                at_sides += u32::from(beyond == 0.0 || beyond == 1.0);
            }
        }
        assert_eq!(quads(&mesh), quads(&plain));
        // Each is cut along its shorter diagonal.
        for pair in mesh.triangles.chunks(2) {
            let shared: Vec<u32> = pair[0].iter().copied().filter(|v| pair[1].contains(v)).collect();
            let others: Vec<u32> = pair.concat().into_iter().filter(|v| !shared.contains(v)).collect();
            let long =
                |of: &[u32]| mesh.positions[of[0] as usize].distance_squared(mesh.positions[of[1] as usize]);
            assert!(long(&shared) <= long(&others) && shared.len() == 2);
        }
    }
    assert!(at_sides > 0, "none was held back");
}

/// A ball of samples that say only in or out comes out in steps; smoothing takes them out. Its Euler characteristic stays.
#[test]
fn smoothing_takes_the_steps_out_of_labels() {
    let (size, radius) = (41, 15.3);
    let ball = Volume::of([size; 3], |place| {
        let square: f32 = place.iter().map(|&i| (i as f32 - 20.2) * (i as f32 - 20.2)).sum();
        if square < radius * radius { 1.0 } else { -1.0 }
    });
    let errors = [0, 2, 8].map(|smoothing| {
        let mesh = ball
            .mesh(&Method::SurfaceNets(SurfaceNets::default().with_patches(true).with_smoothing(smoothing)));
        let found = topology(&mesh);
        assert!(found.is_closed_manifold() && found.euler_characteristic == 2);
        let facing = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| mesh.positions[v as usize] - Vec3::splat(20.2));
            f64::from((b - a).cross(c - a).normalize().dot((a + b + c).normalize()))
        };
        mesh.triangles.iter().map(|t| 1.0 - facing(t)).sum::<f64>() / mesh.triangles.len() as f64
    });
    assert!(errors[1] < 0.4 * errors[0] && errors[2] < 0.5 * errors[1], "{errors:?}");
}

#[test]
fn more_smoothing_than_there_may_be_is_refused() {
    for (smoothing, is_allowed) in [(64, true), (65, false), (u32::MAX, false)] {
        let method = Method::SurfaceNets(SurfaceNets::default().with_smoothing(smoothing));
        let grid = Volume::noise([5; 3], 1, true).grid();
        assert_eq!(method.check(&grid).is_ok(), is_allowed);
        let chunks = ChunkExtractor::in_box(&grid, &method, &ChunkSettings::default());
        assert_eq!(chunks.is_ok(), is_allowed);
        if let Err(error) = chunks {
            assert_eq!(error.to_string(), format!("smoothing = {smoothing}: must be from 0 to 64, steps"));
        }
    }
}
