//! Chunks of several levels from samples: what a field with these values would give, and closed whatever the samples.

use isostudy_extract::{
    CellBox, Chunk, ChunkError, ChunkSettings, Control, Cubes, DualContouring, Faces, Grid, LevelError,
    LevelExtractor, LevelWindow, Method, Neighbours, Normals, ScalarField, SurfaceNets, from_fn, weld_chunks,
};

use crate::two_levels::{
    CELLS, Octree, REACH, by_position, chunks, chunks_by, extractor, noise, open_edges, shapes, welded,
};

const SPACING: f64 = 0.5;

fn methods() -> [Method; 4] {
    [
        Method::Cubes(Cubes::new()),
        Method::Cubes(Cubes::new().with_faces(Faces::Trilinear)),
        Method::SurfaceNets(SurfaceNets::new()),
        Method::SurfaceNets(SurfaceNets::new().with_smoothing(2)),
    ]
}

/// The samples of a box of cells of a level, where those of coarser levels are those of the finest one.
fn window_of(voxel: &dyn Fn([i32; 3]) -> f32, level: u32, cells: CellBox) -> Vec<f32> {
    let range = |axis: usize| cells.start[axis]..=cells.end[axis];
    let corners = range(2).flat_map(|z| range(1).flat_map(move |y| range(0).map(move |x| [x, y, z])));
    corners.map(|corner| voxel(corner.map(|i| i << level))).collect()
}

/// A chunk from windows that have what is asked for and no more.
fn of_samples(
    extractor: &mut LevelExtractor,
    voxel: &dyn Fn([i32; 3]) -> f32,
    (level, cells, neighbours): (u32, CellBox, &Neighbours),
) -> Chunk {
    let needed = extractor.windows(level, cells, neighbours).unwrap();
    let samples: Vec<Vec<f32>> =
        needed.iter().map(|&(level, cells)| window_of(voxel, level, cells)).collect();
    let windows: Vec<LevelWindow> = needed
        .iter()
        .zip(&samples)
        .map(|(&(level, cells), samples)| LevelWindow { level, cells, samples })
        .collect();
    let mut chunk = Chunk::default();
    let control = Control::default();
    extractor.extract_samples_into(&windows, level, cells, neighbours, control, &mut chunk).unwrap();
    chunk
}

/// Samples on the finest grid, and the trilinear interpolant between them.
fn interpolated(voxel: impl Fn([i32; 3]) -> f32 + Sync) -> impl ScalarField {
    from_fn(move |p: [f32; 3]| {
        let steps = p.map(|c| f64::from(c) / SPACING);
        let low = steps.map(f64::floor);
        let ratio = [0, 1, 2].map(|axis| steps[axis] - low[axis]);
        let mut sum = 0.0;
        for c in 0..8 {
            let is_high = |axis: usize| c >> axis & 1 != 0;
            let weight = |axis: usize| if is_high(axis) { ratio[axis] } else { 1.0 - ratio[axis] };
            let weight = weight(0) * weight(1) * weight(2);
            if weight > 0.0 {
                let corner = [0, 1, 2].map(|axis| low[axis] as i32 + i32::from(is_high(axis)));
                sum += weight * f64::from(voxel(corner));
            }
        }
        sum as f32
    })
}

/// Random samples, each of its own.
fn random(seed: u32, levels: f32, reach: f32) -> impl Fn([i32; 3]) -> f32 + Sync {
    let noise = noise(seed, levels, reach);
    move |corner| noise.sample(corner.map(|i| (f64::from(i) * SPACING) as f32))
}

#[test]
fn samples_make_the_chunks_of_their_interpolant_to_the_bit() {
    for method in methods() {
        let mut extractor = extractor(SPACING, &method);
        let mut seams = 0;
        for fine in (0..256).step_by(5) {
            let voxel = random(fine, 1e6, 3.4);
            let field = interpolated(random(fine, 1e6, 3.4));
            let expected = chunks(&mut extractor, &field, fine, CELLS);
            let found = chunks_by(fine, CELLS, |level, cells, neighbours| {
                of_samples(&mut extractor, &voxel, (level, cells, neighbours))
            });
            for (found, expected) in found.iter().zip(&expected) {
                assert_eq!(found, expected, "{method:?} {fine:08b}");
                seams += found.seam;
            }
        }
        assert!(seams > 10_000, "{method:?} {seams}");
    }
}

/// With few values, of which one is the isovalue, and with some that are no numbers.
#[test]
fn seams_of_samples_are_closed_whatever_the_samples() {
    for method in methods() {
        let mut extractor = extractor(SPACING, &method);
        for fine in (0..256).step_by(3) {
            let few = random(fine, 20.0, 3.4);
            let odd = |corner| match few(corner) {
                v if v > 0.9 => f32::INFINITY,
                v if v < -0.75 => f32::NAN,
                v => v,
            };
            let chunks = chunks_by(fine, CELLS, |level, cells, neighbours| {
                of_samples(&mut extractor, &odd, (level, cells, neighbours))
            });
            let mesh = weld_chunks(&chunks).unwrap();
            assert!(mesh.triangles.len() > 1_000);
            assert_eq!(open_edges(&mesh), 0, "{method:?} {fine:08b}");
            assert_eq!(open_edges(&by_position(&chunks)), 0, "{method:?} {fine:08b}");
        }
    }
}

#[test]
fn shapes_of_samples_keep_their_topology() {
    for (s, shape) in shapes().iter().enumerate() {
        let voxel = |corner: [i32; 3]| shape.field.sample(corner.map(|i| i as f32 * 0.125));
        for method in methods() {
            let mut extractor = extractor(0.125, &method);
            for fine in (0..256).step_by(37) {
                let chunks = chunks_by(fine, 10, |level, cells, neighbours| {
                    of_samples(&mut extractor, &voxel, (level, cells, neighbours))
                });
                let report = welded(&chunks);
                assert_eq!(open_edges(&by_position(&chunks)), 0, "{method:?} {s} {fine:08b}");
                assert_eq!(
                    report.euler_characteristic, shape.euler_characteristic,
                    "{method:?} {s} {fine:08b}"
                );
            }
        }
    }
}

/// Three levels, from windows of each or from one window of the finest level for all chunks.
#[test]
fn coarser_levels_follow_from_the_finest() {
    for seed in 0..5 {
        let octree = Octree::random(seed);
        for method in methods() {
            let mut extractor = extractor(SPACING, &method);
            let voxel = random(seed, 1e6, (4.0 * SPACING as f32) * REACH as f32 - 1.1);
            let all = CellBox { start: [-4 * REACH - 40; 3], end: [4 * REACH + 40; 3] };
            let samples = window_of(&voxel, 0, all);
            let whole = [LevelWindow { level: 0, cells: all, samples: &samples }];
            let mut chunks = Vec::new();
            octree.chunks_by(4, |level, cells, neighbours| {
                let exact = of_samples(&mut extractor, &voxel, (level, cells, neighbours));
                let mut derived = Chunk::default();
                let control = Control::default();
                extractor
                    .extract_samples_into(&whole, level, cells, neighbours, control, &mut derived)
                    .unwrap();
                assert_eq!(derived, exact, "{method:?} {seed} {level}");
                chunks.push(exact.clone());
                exact
            });
            assert!(chunks.iter().map(|chunk| chunk.seam).sum::<u32>() > 300);
            assert_eq!(open_edges(&weld_chunks(&chunks).unwrap()), 0, "{method:?} {seed}");
        }
    }
}

/// A payload is the same in all chunks that have a vertex, across levels.
#[test]
fn payloads_agree_at_seams() {
    for method in methods() {
        let mut extractor = extractor(SPACING, &method);
        let voxel = random(7, 1e6, 3.4);
        let chunks = chunks_by(0b0110_1001, CELLS, |level, cells, neighbours| {
            of_samples(&mut extractor, &voxel, (level, cells, neighbours))
        });
        let mut known = std::collections::HashMap::new();
        let (mut shared, mut materials) = (0, Vec::new());
        for chunk in &chunks {
            chunk.payload(
                |level, [low, high]| {
                    let ends = [low, high].map(|corner| corner.map(|i| i << level));
                    ends.into_iter().find(|&corner| voxel(corner) > 0.0).unwrap_or(ends[0])
                },
                &mut materials,
            );
            assert_eq!(materials.len(), chunk.positions.len());
            for (v, (key, material)) in chunk.keys.iter().zip(&materials).enumerate() {
                if let Some(before) = known.insert(*key, *material) {
                    assert_eq!(before, *material);
                    shared += 1;
                }
                // The vertex lies between its corners.
                let [low, high] = chunk.corners_of(v);
                let size = SPACING * f64::from(1 << key.level());
                for axis in 0..3 {
                    let p = f64::from(chunk.positions[v][axis]) / size;
                    let (low, high) = (f64::from(low[axis]), f64::from(high[axis]));
                    assert!(low - 1e-4 <= p && p <= high + 1e-4, "{method:?} {key:?} {p} {low} {high}");
                }
            }
        }
        assert!(shared > 100, "{method:?} {shared}");
    }
}

#[test]
fn what_is_no_window_is_refused() {
    let mut extractor = extractor(SPACING, &methods()[0]);
    let voxel = random(1, 1e6, 3.4);
    let cells = CellBox { start: [0; 3], end: [4; 3] };
    let neighbours = Neighbours::try_new(1, |[x, _, _]| if x < 0 { 0 } else { 1 }).unwrap();
    let needed = extractor.windows(1, cells, &neighbours).unwrap();
    // The four directions to the west that are sides or edges between other sides: one box is round the side.
    assert_eq!(needed[0], (1, CellBox { start: [-3; 3], end: [7; 3] }));
    assert!(needed[1..].contains(&(0, CellBox { start: [-3; 3], end: [3, 11, 11] })));
    let samples: Vec<Vec<f32>> =
        needed.iter().map(|&(level, cells)| window_of(&voxel, level, cells)).collect();
    let windows: Vec<LevelWindow> = needed
        .iter()
        .zip(&samples)
        .map(|(&(level, cells), samples)| LevelWindow { level, cells, samples })
        .collect();
    let mut run = |windows: &[LevelWindow], neighbours: &Neighbours, level: u32| {
        let mut chunk = Chunk::default();
        extractor
            .extract_samples_into(windows, level, cells, neighbours, Control::default(), &mut chunk)
            .map(|()| chunk.triangles.len())
    };
    assert!(run(&windows, &neighbours, 1).unwrap() > 50);
    // Each of them is needed, unless another one has it.
    assert_eq!(run(&windows[..1], &neighbours, 1), Err(LevelError::Missing { level: 0, cells: needed[1].1 }));
    let missing = LevelError::Missing { level: 1, cells: needed[0].1 };
    assert_eq!(run(&windows[1..], &neighbours, 1), Err(missing));
    let short = [LevelWindow { samples: &samples[0][1..], ..windows[0] }];
    let error = LevelError::Samples { level: 1, given: 11 * 11 * 11 - 1, wanted: 11 * 11 * 11 };
    assert_eq!(run(&short, &Neighbours::SAME, 1), Err(error));
    // A coarse sample that is another one than the fine one in its place: at corner (0, 2, 2).
    let mut other = samples[0].clone();
    other[(5 * 11 + 5) * 11 + 3] += 1.0;
    let mut changed = windows.clone();
    changed[0].samples = &other;
    let fine = voxel([0, 4, 4]);
    assert_eq!(
        run(&changed, &neighbours, 1),
        Err(LevelError::Disagree { levels: [0, 1], corner: [0, 2, 2], samples: [fine, fine + 1.0] })
    );
    let finer = Neighbours::try_new(1, |_| 0).unwrap();
    assert_eq!(run(&windows, &finer, 0), Err(LevelError::Finest));

    // What needs a field says so.
    let grid = Grid::try_new([0.0; 3], SPACING).unwrap();
    let dc = Method::DualContouring(DualContouring::new());
    let by_field = ChunkSettings::default().with_normals(Normals::Field);
    for (method, settings) in [(dc, ChunkSettings::default()), (methods()[0], by_field)] {
        let mut extractor = LevelExtractor::try_new(&grid, &method, &settings).unwrap();
        let samples = window_of(&voxel, 0, CellBox { start: [-9; 3], end: [9; 3] });
        let window =
            [LevelWindow { level: 0, cells: CellBox { start: [-9; 3], end: [9; 3] }, samples: &samples }];
        let mut chunk = Chunk::default();
        let control = Control::default();
        let error = extractor
            .extract_samples_into(&window, 0, cells, &Neighbours::SAME, control, &mut chunk)
            .unwrap_err();
        assert!(matches!(error, LevelError::Chunk(ChunkError::Settings(_) | ChunkError::NormalsNeedField)));
    }
}
