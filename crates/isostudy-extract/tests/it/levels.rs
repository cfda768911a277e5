//! Chunks of two levels round a point, in all 256 ways: closed whatever the samples, of the right shape, and nothing turned over.

use std::collections::HashMap;

use glam::Vec3;
use isostudy_extract::{
    Aabb, Arrangement, CellBox, Chunk, ChunkError, ChunkExtractor, ChunkSettings, Control, Cubes, Diagonals,
    DualContouring, Faces, Grid, LevelError, LevelExtractor, Method, Neighbours, Normals, Placement,
    ScalarField, Source, SurfaceNets, Tetrahedra, WeldError, from_fn, weld_chunks,
};
use isostudy_mesh::topology::topology;

use crate::two_levels::{
    CELLS, Octree, REACH, ball, by_position, chunks, extractor, noise, open_edges, shapes, turned_over,
    welded,
};

fn cubes(faces: Faces, diagonals: Diagonals) -> Method {
    Method::Cubes(Cubes::default().with_faces(faces).with_diagonals(diagonals))
}

const NETS: Method = Method::SurfaceNets(SurfaceNets::new());
const SMOOTHED: Method = Method::SurfaceNets(SurfaceNets::new().with_smoothing(1));
const PLANES: Method = Method::DualContouring(DualContouring::new());

const FACES: [Faces; 4] = [Faces::SeparateInside, Faces::JoinInside, Faces::Decider, Faces::Trilinear];

/// Samples that have nothing to do with each other: every pattern at every seam, closed, and a manifold.
#[test]
fn seams_of_cubes_are_closed_whatever_the_samples() {
    for (f, faces) in FACES.into_iter().enumerate() {
        let method = cubes(faces, Diagonals::Fan);
        let mut extractor = extractor(0.5, &method);
        let mut triangles = 0;
        for fine in (0..256).step_by(if f == 0 { 1 } else { 3 }) {
            for round in 0..2 {
                let field = noise(fine + 256 * (f as u32 + 4 * round), 1e6, 3.4);
                let chunks = chunks(&mut extractor, &field, fine, CELLS);
                let report = welded(&chunks);
                let faults = [report.misoriented_edges, report.collapsed_triangles, report.unused_vertices];
                assert!(faults == [0; 3] && report.is_closed_manifold(), "{faces:?} {fine:08b}: {report:?}");
                assert_eq!(open_edges(&by_position(&chunks)), 0, "{faces:?} {fine:08b}");
                triangles += chunks.iter().map(|chunk| chunk.seam).sum::<u32>();
            }
        }
        assert!(triangles > 20_000, "{triangles}");
    }
}

/// Samples of few values, among them the isovalue itself, and of no number.
#[test]
fn seams_of_odd_samples_are_closed() {
    for faces in FACES {
        let method = cubes(faces, Diagonals::Quality);
        let mut extractor = extractor(0.5, &method);
        for fine in (0..256).step_by(5) {
            let few = noise(fine, 20.0, 3.4);
            let odd = from_fn(|p| match few.sample(p) {
                v if v > 0.9 => f32::INFINITY,
                v if v < -0.75 => f32::NAN,
                v => v,
            });
            for field in [&few as &dyn ScalarField, &odd] {
                let report = welded(&chunks(&mut extractor, field, fine, CELLS));
                assert_eq!([report.boundary_edges, report.misoriented_edges], [0; 2], "{faces:?} {fine:08b}");
                assert!(report.triangles > 1000);
            }
        }
    }
}

/// One side, two sides, three sides fine, and every other way: the same surface as at one level, and nothing turned over.
#[test]
fn shapes_keep_their_topology_in_all_256_ways() {
    let method = cubes(Faces::default(), Diagonals::Fan);
    for (s, shape) in shapes().iter().enumerate() {
        let mut extractor = extractor(0.125, &method);
        let mut of_seams = 0;
        for fine in (0..256).step_by(if s == 0 { 1 } else { 3 }) {
            let chunks = chunks(&mut extractor, &*shape.field, fine, 10);
            let report = welded(&chunks);
            assert!(report.is_closed_manifold(), "{s} {fine:08b}: {report:?}");
            assert_eq!(report.euler_characteristic, shape.euler_characteristic, "{s} {fine:08b}");
            // Keys and bits say the same.
            let seen = by_position(&chunks);
            assert_eq!(open_edges(&seen), 0, "{s} {fine:08b}");
            assert_eq!(topology(&seen).euler_characteristic, shape.euler_characteristic, "{s} {fine:08b}");
            assert_eq!(turned_over(&chunks, &*shape.field), 0, "{s} {fine:08b}");
            of_seams += chunks.iter().map(|chunk| chunk.seam).sum::<u32>();
        }
        assert!(of_seams > 10_000, "{s}: {of_seams}");
    }
}

/// Three levels, with all the ways in which they meet.
#[test]
fn octrees_of_three_levels_are_closed() {
    let mut met = 0;
    for seed in 0..40 {
        let octree = Octree::random(seed);
        met += usize::from((0..3).all(|level| octree.leaves.iter().any(|leaf| leaf.0 == level)));
        let of_cubes = cubes(FACES[seed as usize % 4], Diagonals::Fan);
        let moved = Method::Cubes(Cubes::default().with_placement(Placement::Relaxed));
        for method in [of_cubes, moved].into_iter().take(if seed < 4 { 2 } else { 1 }) {
            let mut extractor = extractor(0.25, &method);
            let reach = 4.0 * 0.25 * REACH as f32 - 1.1;
            let chunks = octree.chunks(&mut extractor, &noise(seed, 1e6, reach), 4);
            let mesh = weld_chunks(&chunks).unwrap();
            assert!(mesh.triangles.len() > 1_000);
            assert_eq!(open_edges(&mesh), 0, "{seed} {method:?}");
            assert!(topology(&mesh).is_closed_manifold(), "{seed} {method:?}");
            let ball = ball(3.2, [0.2, 0.03, -0.3]);
            let chunks = octree.chunks(&mut extractor, &ball, 4);
            let report = welded(&chunks);
            assert!(report.is_closed_manifold(), "{seed} {method:?}: {report:?}");
            assert_eq!(report.euler_characteristic, 2, "{seed} {method:?}");
            assert_eq!(open_edges(&by_position(&chunks)), 0, "{seed} {method:?}");
        }
    }
    assert!(met > 20, "{met}");
}

/// Without other levels it is a chunk of its level's grid.
#[test]
fn a_chunk_among_its_own_level_is_that_of_the_grid() {
    let method = cubes(Faces::Trilinear, Diagonals::EdgeGroups);
    let settings = ChunkSettings::default().with_normals(Normals::Field).with_isovalue(0.1);
    let grid = Grid::try_new([3.0, -7.5, 1e3], 0.3).unwrap();
    let mut levels = LevelExtractor::try_new(&grid, &method, &settings).unwrap();
    for level in 0..4 {
        let coarse = grid.coarser(level).unwrap();
        for (corner, same) in
            [[0, 0, 0], [5, -3, 7], [1 << 20, 4, -9]].into_iter().map(|c| (c, c.map(|i| i << level)))
        {
            assert_eq!(coarse.position(corner), grid.position(same));
        }
        let cell = 0.3 * (1 << level) as f32;
        let field = ball(3.5 * cell, [3.0 + 4.0 * cell, -7.5 + 4.0 * cell, 1e3 + 6.0 * cell]);
        let cells = CellBox { start: [-2, 0, 1], end: [9, 7, 12] };
        let plain = ChunkExtractor::try_new(&coarse, &method, &settings)
            .unwrap()
            .extract(&field, cells, Control::default())
            .unwrap();
        let chunk = levels.extract(&field, level, cells, &Neighbours::SAME, Control::default()).unwrap();
        assert!(plain.triangles.len() > 10);
        assert_eq!((chunk.level, chunk.seam), (level, 0));
        assert_eq!(
            (chunk.positions, chunk.normals, chunk.triangles),
            (plain.positions, plain.normals, plain.triangles)
        );
    }
}

/// What is said not to matter does not, and what is said to matter can.
#[test]
fn neighbours_that_are_seen_alike_make_the_same_chunk() {
    let of_cubes = cubes(Faces::default(), Diagonals::Fan);
    let field = noise(5, 1e6, 9.0);
    let cells = CellBox { start: [-4; 3], end: [4; 3] };
    for method in [of_cubes, NETS, SMOOTHED, PLANES] {
        let mut extractor = extractor(0.5, &method);
        let mut known: HashMap<Neighbours, Chunk> = HashMap::new();
        for seed in 0..300u32 {
            let hash = |i: u32| {
                (seed.wrapping_mul(0x9e37_79b9) ^ i.wrapping_mul(0x85eb_ca6b)).wrapping_mul(0xc2b2_ae35) >> 20
            };
            let mut i = 0;
            let neighbours = Neighbours::try_new(3, |_| {
                i += 1;
                // Mostly of one kind, so that some are alike.
                match hash(i) % 16 {
                    0 => 2,
                    1 => 4,
                    _ if seed % 3 == 0 => 4,
                    _ => 3,
                }
            })
            .unwrap();
            let seen = extractor.seen(&neighbours);
            let chunk = extractor.extract(&field, 3, cells, &neighbours, Control::default()).unwrap();
            let of_seen = extractor.extract(&field, 3, cells, &seen, Control::default()).unwrap();
            assert!(of_seen == chunk && extractor.seen(&seen) == seen);
            assert_eq!(*known.entry(seen).or_insert_with(|| chunk.clone()), chunk);
        }
        assert!((10..299).contains(&known.len()), "{}", known.len());
    }
}

/// A change in a box that a chunk says it is not touched by leaves it as it is, seams and all.
#[test]
fn edits_beyond_a_chunk_and_its_seams_leave_it() {
    // Smoothing looks farther, so its holes are farther apart.
    let of_cubes = cubes(Faces::default(), Diagonals::Fan);
    for (method, apart) in [(of_cubes, 2.0), (NETS, 2.0), (SMOOTHED, 2.6)] {
        let mut extractor = extractor(0.5, &method);
        let level_at = |[x, y, z]: [i32; 3]| {
            if x < 0 {
                2
            } else if y < 0 || z > 0 {
                0
            } else {
                1
            }
        };
        let neighbours =
            Neighbours::try_new(1, |d| if d[0] < 0 && d != [-1, 0, 0] { 1 } else { level_at(d) }).unwrap();
        let cells = CellBox { start: [-4; 3], end: [4; 3] };
        let before = noise(1, 1e6, 9.0);
        let chunk = extractor.extract(&before, 1, cells, &neighbours, Control::default()).unwrap();
        assert!(chunk.seam > 100);
        let (mut touched, mut changed) = (0, 0);
        for i in 0..729 {
            let lowest = [i % 9, i / 9 % 9, i / 81].map(|n| apart * (n - 4) as f32 - 1.3);
            let hole = Aabb { min: lowest, max: lowest.map(|c| c + 1.1) };
            let after = from_fn(|p: [f32; 3]| {
                let is_in = (0..3).all(|a| (hole.min[a]..=hole.max[a]).contains(&p[a]));
                if is_in { -before.sample(p) } else { before.sample(p) }
            });
            let again = extractor.extract(&after, 1, cells, &neighbours, Control::default()).unwrap();
            touched += usize::from(chunk.is_touched_by(hole));
            changed += usize::from(again != chunk);
            assert!(again == chunk || chunk.is_touched_by(hole), "{method:?} {hole:?}");
        }
        assert!(changed > 100 && touched < 700, "{changed} {touched}");
    }
}

#[test]
fn what_cannot_be_done_is_an_error() {
    let grid = Grid::try_new([0.0; 3], 1.0).unwrap();
    let of = |method: &Method| LevelExtractor::try_new(&grid, method, &ChunkSettings::default()).map(drop);
    let method = cubes(Faces::default(), Diagonals::Fan);
    let tetrahedra = Method::Tetrahedra(Tetrahedra::new(Arrangement::BodyCentred));
    assert_eq!(of(&tetrahedra), Err(LevelError::Method));
    let steep = Neighbours::try_new(2, |d| if d == [0, 1, 0] { 0 } else { 2 });
    assert_eq!(steep, Err(LevelError::Step { direction: [0, 1, 0], levels: [2, 0] }));
    assert!(Neighbours::try_new(2, |d| if d == [1, 1, 1] { 0 } else { 2 }).is_ok());

    let mut extractor = extractor(1.0, &method);
    let field = noise(0, 9.0, 9.0);
    let cells = CellBox { start: [0; 3], end: [4; 3] };
    let finer = Neighbours::try_new(1, |_| 0).unwrap();
    let mut chunk = extractor.extract(&field, 1, cells, &finer, Control::default()).unwrap();
    let error = extractor.extract_into(&field, 0, cells, &finer, Control::default(), &mut chunk);
    assert_eq!((error, &chunk), (Err(LevelError::Finest), &Chunk::default()));
    let mut refused = |source: Source, level, cells| {
        extractor.extract(source, level, cells, &Neighbours::SAME, Control::default()).unwrap_err()
    };
    assert_eq!(refused(Source::Samples(&[]), 1, cells), LevelError::NeedsField);
    assert_eq!(refused(Source::Field(&field), 99, cells), LevelError::Level { level: 99 });
    let empty = CellBox::default();
    assert!(matches!(refused(Source::Field(&field), 1, empty), LevelError::Chunk(ChunkError::Cells { .. })));
    let mut nets = LevelExtractor::try_new(&grid, &NETS, &ChunkSettings::default()).unwrap();
    let coarser = Neighbours::try_new(1, |_| 2).unwrap();
    let odd = CellBox { start: [1, 0, 0], ..cells };
    assert_eq!(
        nets.extract(&field, 1, odd, &coarser, Control::default()),
        Err(LevelError::Odd { cells: odd })
    );
    let patches = Method::SurfaceNets(SurfaceNets::default().with_patches(true));
    assert_eq!(of(&patches), Err(LevelError::Method));
    let wrong = Method::DualContouring(DualContouring::default().with_truncation(f32::NAN));
    assert!(matches!(of(&wrong), Err(LevelError::Chunk(ChunkError::Settings(_)))));
    // Twice the numbers are beyond i32.
    let far = CellBox { start: [i32::MAX - 5000, 0, 0], end: [i32::MAX - 4990, 4, 4] };
    let error = extractor.extract(&field, 1, far, &finer, Control::default()).unwrap_err();
    assert!(matches!(error, LevelError::Chunk(ChunkError::Cells { .. })), "{error}");
    let other = LevelExtractor::try_new(&grid, &method, &ChunkSettings::default().with_isovalue(0.5))
        .unwrap()
        .extract(&field, 1, cells, &finer, Control::default())
        .unwrap();
    let one = extractor.extract(&field, 1, cells, &finer, Control::default()).unwrap();
    assert!(matches!(weld_chunks([&one, &other]), Err(WeldError::Worlds { .. })));
    assert!(matches!(weld_chunks([&one, &one]), Err(WeldError::Overlap { .. })));
}

/// Vertices of seams are those of one of the levels, and others as near to the surface.
#[test]
fn vertices_of_seams_are_near_the_surface() {
    let method = cubes(Faces::default(), Diagonals::Fan);
    let field = ball(1.52, [0.03, -0.11, 0.07]);
    for fine in (0..256).step_by(5) {
        let chunks = chunks(&mut extractor(0.125, &method), &field, fine, 10);
        for chunk in &chunks {
            // The middle of a chord of h is h^2 / 8 r below a ball of radius r. With cells of 0.25 that is 0.0051.
            assert!(chunk.positions.iter().all(|&p| field.sample(p).abs() < 0.0052), "{fine:08b}");
        }
    }
}

/// Triangles by the crate transvoxel 2.0.0 of eight blocks of side 8, those in the west with 8 cells a side and those in the east with 16:
/// without transition cells, and with them. Its transition cells have the crossings of both levels, and thus two triangles more for each
/// coarse crossing between the levels, which are counted here from the field.
#[test]
fn counts_are_those_of_another_program() {
    let sphere = |[x, y, z]: [f32; 3]| 5.03 - Vec3::new(x, y, z).length();
    let bumpy = move |[x, y, z]: [f32; 3]| {
        sphere([x, y, z]) + 0.8 * (1.7 * x).sin() * (1.3 * y).cos() * (1.9 * z).sin()
    };
    let (sphere, bumpy) = (from_fn(sphere), from_fn(bumpy));
    let method = cubes(Faces::default(), Diagonals::Fan);
    let mut extractor = extractor(0.5, &method);
    for (field, without, with) in [(&sphere as &dyn ScalarField, 2_432, 2_560), (&bumpy, 2_896, 3_024)] {
        let is_inside = |y: i32, z: i32| field.sample([0.0, y as f32, z as f32]) > 0.0;
        let crossings = |[dy, dz]: [i32; 2]| {
            let all = (-8..8).flat_map(|y| (-8..8).map(move |z| [y, z]));
            all.filter(|&[y, z]| is_inside(y, z) != is_inside(y + dy, z + dz)).count()
        };
        let coarse = crossings([0, 1]) + crossings([1, 0]);
        let chunks = chunks(&mut extractor, field, 0b1010_1010, 8);
        let all: usize = chunks.iter().map(|chunk| chunk.triangles.len()).sum();
        let mut alone = 0;
        for chunk in &chunks {
            let same = Neighbours::SAME;
            let chunk =
                extractor.extract(field, chunk.level, chunk.cells, &same, Control::default()).unwrap();
            assert_eq!(chunk.seam, 0);
            alone += chunk.triangles.len();
        }
        assert_eq!([alone, all + 2 * coarse], [without, with]);
        let mut apart = chunks;
        for chunk in &mut apart {
            chunk.triangles.truncate(chunk.triangles.len() - chunk.seam as usize);
        }
        assert!(open_edges(&by_position(&apart)) > 0);
    }
}
