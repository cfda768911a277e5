//! Positions relative to a chunk's corner: as fine anywhere as near the origin.

use glam::Vec3;
use isostudy_extract::{
    Aabb, Bounds, BoxGrid, CellBox, Chunk, ChunkError, ChunkExtractor, ChunkSettings, Control, Grid,
    LevelExtractor, LevelWindow, Method, Neighbours, ScalarField, Source, WeldError, from_fn, presets,
    weld_chunks,
};

use crate::two_levels::noise;

fn method(id: &str) -> Method {
    presets().iter().find(|preset| preset.id == id).unwrap().method
}

fn relative() -> ChunkSettings {
    ChunkSettings::default().with_relative_positions(true)
}

fn moved(cells: CellBox, by: [i32; 3]) -> CellBox {
    let moved = |corner: [i32; 3]| [0, 1, 2].map(|axis| corner[axis] + by[axis]);
    CellBox { start: moved(cells.start), end: moved(cells.end) }
}

/// By a field, near the origin: the same chunk, with positions that begin at its corner.
#[test]
fn relative_chunks_are_the_same_from_their_corner_on() {
    let grid = Grid::try_new([3.0, -1.5, 0.25], 0.25).unwrap();
    let waves = from_fn(|[x, y, z]: [f32; 3]| (1.7 * x).sin() + (1.6 * y + 1.0).sin() + (1.8 * z).cos());
    for id in ["mc", "mc33", "nets", "nets-manifold", "snapmc", "si", "bi", "fu", "dc", "bi-relaxed"] {
        let method = method(id);
        let mut absolute = ChunkExtractor::try_new(&grid, &method, &ChunkSettings::default()).unwrap();
        let mut from_corner = ChunkExtractor::try_new(&grid, &method, &relative()).unwrap();
        let cells = CellBox { start: [-3, 8, 5], end: [7, 18, 15] };
        let expected = absolute.extract(&waves, cells, Control::default()).unwrap();
        let found = from_corner.extract(&waves, cells, Control::default()).unwrap();
        assert!(found.triangles.len() > 100, "{id}: {}", found.triangles.len());
        assert_eq!((&found.triangles, &found.keys), (&expected.triangles, &expected.keys), "{id}");
        assert_eq!((found.cells, found.window), (expected.cells, expected.window), "{id}");
        assert_eq!(found.triangle_cells, expected.triangle_cells, "{id}");
        let origin = found.origin();
        // Gradients by differences of a field in single precision are less certain than places of crossings.
        let most_apart = if method.promises().samples_suffice { 4e-6 } else { 1e-3 };
        assert_eq!((origin, expected.origin()), ([2.25, 0.5, 1.5], [2.25, 0.5, 1.5]));
        for (p, q) in found.positions.iter().zip(&expected.positions) {
            for axis in 0..3 {
                let apart = (f64::from(p[axis]) + origin[axis] - f64::from(q[axis])).abs();
                assert!(apart < most_apart, "{id} {p:?} {q:?}");
            }
        }
        let mut positions = Vec::new();
        found.relative_positions(&mut positions);
        assert_eq!(positions, found.positions);
        for point in [[2.3, 0.6, 1.6], [0.9, 0.6, 1.6], [5.6, 4.0, 3.0], [2.3, 9.0, 1.6]] {
            let changed = Aabb::around(point, 0.01);
            assert_eq!(found.is_touched_by(changed), expected.is_touched_by(changed), "{id} {point:?}");
        }
    }
}

/// The samples of a window, as a field has them from a corner on.
fn samples_of(field: &dyn ScalarField, window: CellBox, scale: i32) -> Vec<f32> {
    let range = |axis: usize| window.start[axis]..=window.end[axis];
    let corners = range(2).flat_map(|z| range(1).flat_map(move |y| range(0).map(move |x| [x, y, z])));
    corners.map(|corner| field.sample(corner.map(|i| (i * scale) as f32))).collect()
}

/// By samples, where single precision has steps of cells: the bits are those of the same samples at the origin.
#[test]
fn samples_have_the_same_shape_anywhere() {
    let grid = Grid::try_new([0.0; 3], 0.25).unwrap();
    let far = [1 << 28, -(1 << 27), 1 << 26];
    let noise = noise(11, 1e6, 6.0);
    let cells = CellBox { start: [-8; 3], end: [8; 3] };
    for id in ["mc33", "nets", "snapmc", "si"] {
        let method = method(id);
        let mut extractor = ChunkExtractor::try_new(&grid, &method, &relative()).unwrap();
        let window = extractor.window(cells).unwrap().unwrap();
        let samples = samples_of(&noise, window, 1);
        let mut at = |by: [i32; 3]| {
            let source = Source::Window { cells: moved(window, by), samples: &samples };
            extractor.extract(source, moved(cells, by), Control::default()).unwrap()
        };
        let (near, far_chunk) = (at([0; 3]), at(far));
        assert!(near.triangles.len() > 1_000, "{id}");
        assert_eq!(near.positions, far_chunk.positions, "{id}");
        assert_eq!((&near.normals, &near.triangles), (&far_chunk.normals, &far_chunk.triangles), "{id}");
        for (near, far_key) in near.keys.iter().zip(&far_chunk.keys) {
            let cell = [0, 1, 2].map(|axis| near.cell()[axis] + far[axis]);
            assert_eq!(far_key.cell(), cell);
        }
        assert_eq!(far_chunk.origin(), [0, 1, 2].map(|axis| 0.25 * f64::from(far[axis] - 8)));
    }
}

/// With seams between levels.
#[test]
fn seams_have_the_same_shape_anywhere() {
    let grid = Grid::try_new([0.0; 3], 0.25).unwrap();
    let far = [1 << 26, -(1 << 25), 1 << 24];
    let noise = noise(12, 1e6, 14.0);
    let cells = CellBox { start: [-4; 3], end: [4; 3] };
    for id in ["mc33", "nets"] {
        let mut extractor = LevelExtractor::try_new(&grid, &method(id), &relative()).unwrap();
        // Finer chunks to the west, coarser ones to the south.
        let level_at = |[x, y, _]: [i32; 3]| if y < 0 { 2 } else { u32::from(x >= 0) };
        let neighbours = Neighbours::try_new(1, level_at).unwrap();
        let mut at = |by: [i32; 3]| {
            let needed = extractor.windows(1, cells, &neighbours).unwrap();
            let samples: Vec<Vec<f32>> =
                needed.iter().map(|&(level, cells)| samples_of(&noise, cells, 1 << level)).collect();
            let windows: Vec<LevelWindow> = needed
                .iter()
                .zip(&samples)
                .map(|(&(level, cells), samples)| {
                    let by = by.map(|i| if level == 0 { 2 * i } else { i >> (level - 1) });
                    LevelWindow { level, cells: moved(cells, by), samples }
                })
                .collect();
            let mut chunk = Chunk::default();
            let (cells, control) = (moved(cells, by), Control::default());
            extractor.extract_samples_into(&windows, 1, cells, &neighbours, control, &mut chunk).unwrap();
            chunk
        };
        let (near, far_chunk) = (at([0; 3]), at(far));
        assert!(near.seam > 50, "{id}");
        assert_eq!(near.positions, far_chunk.positions, "{id}");
        assert_eq!((&near.normals, &near.triangles), (&far_chunk.normals, &far_chunk.triangles), "{id}");
        for (near, far_key) in near.keys.iter().zip(&far_chunk.keys) {
            let by = far.map(|i| if near.level() == 0 { 2 * i } else { i >> (near.level() - 1) });
            assert_eq!(far_key.cell(), [0, 1, 2].map(|axis| near.cell()[axis] + by[axis]));
            assert_eq!(far_key.level(), near.level());
        }
    }
}

#[test]
fn relative_positions_do_not_weld_and_need_no_box() {
    let grid = Grid::try_new([0.0; 3], 0.25).unwrap();
    let ball = from_fn(|p: [f32; 3]| 1.0 - Vec3::from(p).length());
    let mut extractor = ChunkExtractor::try_new(&grid, &method("mc"), &relative()).unwrap();
    let chunk = extractor.extract(&ball, grid.chunk([0; 3], 8), Control::default()).unwrap();
    assert_eq!(weld_chunks(&[chunk]), Err(WeldError::Relative));
    let bounds = Bounds { min: Vec3::ZERO, max: Vec3::ONE };
    let refused = ChunkExtractor::in_box(&BoxGrid { bounds, spacing: 0.1 }, &method("mc"), &relative());
    assert_eq!(refused.err(), Some(ChunkError::RelativeInBox));
}
