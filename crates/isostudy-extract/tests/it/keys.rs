//! Chunks without keys of vertices and cells of triangles: the same otherwise, and refused by what needs keys.

use glam::Vec3;
use isostudy_extract::{
    Arrangement, BoxGrid, CellBox, Chunk, ChunkError, ChunkExtractor, ChunkSettings, Clustering, Control,
    Grid, LevelError, LevelExtractor, Method, Normals, ScalarField, Source, SurfaceNets, Tetrahedra,
    WeldError, from_fn, presets, weld_chunks,
};
use isostudy_mesh::Bounds;

use crate::two_levels::noise;

fn methods() -> impl Iterator<Item = Method> {
    let smoothed = [false, true]
        .map(|patches| Method::SurfaceNets(SurfaceNets::default().with_smoothing(2).with_patches(patches)));
    presets().iter().map(|preset| preset.method).filter(|method| method.promises().chunks).chain(smoothed)
}

fn same_but_for_keys(found: &Chunk, expected: &Chunk, what: &str) {
    assert!(found.triangles.len() > 50 && !expected.keys.is_empty(), "{what}");
    assert!(found.keys.is_empty() && found.triangle_cells.is_empty(), "{what}");
    assert_eq!(found.positions, expected.positions, "{what}");
    assert_eq!(found.normals, expected.normals, "{what}");
    assert_eq!(found.triangles, expected.triangles, "{what}");
    assert_eq!(
        (found.cells, found.window, found.bounds()),
        (expected.cells, expected.window, expected.bounds()),
        "{what}"
    );
}

/// Of noise, whose cells have all patterns there are, with all kinds of normals that a method has.
#[test]
fn chunks_without_keys_are_the_same_otherwise() {
    let noise = noise(5, 8.0, 40.0);
    let waves = from_fn(|[x, y, z]: [f32; 3]| (0.7 * x).sin() + (0.6 * y + 1.0).sin() + (0.8 * z).cos());
    let grid = Grid::try_new([0.0; 3], 1.0).unwrap();
    let mut compared = [0; 4];
    for method in methods() {
        for (kind, normals) in
            [Normals::Triangles, Normals::Field, Normals::Samples, Normals::None].into_iter().enumerate()
        {
            let settings = ChunkSettings::default().with_isovalue(0.1).with_normals(normals);
            let Ok(mut with) = ChunkExtractor::try_new(&grid, &method, &settings) else { continue };
            let mut without = ChunkExtractor::try_new(&grid, &method, &settings.with_keys(false)).unwrap();
            let fields: &[&dyn ScalarField] =
                if method.promises().samples_suffice { &[&noise, &waves] } else { &[&waves] };
            for field in fields {
                // A chunk with a surface, one after it in the same buffers, and one of another size.
                for (start, size) in [([0, 0, 0], 9), ([-7, 3, 2], 9), ([5, -9, -4], 7)] {
                    let cells = CellBox { start, end: start.map(|i| i + size) };
                    let what = format!("{method:?} {normals:?} {start:?}");
                    let window = with.window(cells).unwrap().unwrap();
                    let mut samples = Vec::new();
                    with.layout(window).unwrap().fill(*field, &mut samples);
                    let source = match normals {
                        Normals::Samples => Source::Window { cells: window, samples: &samples },
                        _ => Source::Field(*field),
                    };
                    let expected = with.extract(source, cells, Control::default()).unwrap();
                    let found = without.extract(source, cells, Control::default()).unwrap();
                    same_but_for_keys(&found, &expected, &what);
                    compared[kind] += 1;
                }
            }
        }
    }
    assert!(compared[0] > 60 && compared[1] > 60 && compared[2] >= 24 && compared[3] > 60, "{compared:?}");
}

/// In a box, at its corners and with edges that collapse.
#[test]
fn chunks_of_a_box_without_keys_are_the_same_otherwise() {
    let waves = from_fn(|[x, y, z]: [f32; 3]| (2.7 * x).sin() + (2.6 * y + 1.0).sin() + (2.8 * z).cos());
    let bounds = Bounds { min: Vec3::splat(-1.5), max: Vec3::splat(1.5) };
    let grid = BoxGrid { bounds, spacing: 0.17 };
    let collapsed = Arrangement::BodyCentred;
    let collapsed = Method::Tetrahedra(Tetrahedra::new(collapsed).with_clustering(Clustering::EdgeCollapse));
    for method in methods().chain([collapsed]) {
        let settings = ChunkSettings::default();
        let mut with = ChunkExtractor::in_box(&grid, &method, &settings).unwrap();
        let mut without = ChunkExtractor::in_box(&grid, &method, &settings.with_keys(false)).unwrap();
        for cells in with.grid(10) {
            let expected = with.extract(&waves, cells, Control::default()).unwrap();
            let found = without.extract(&waves, cells, Control::default()).unwrap();
            if expected.triangles.len() > 50 {
                same_but_for_keys(&found, &expected, &format!("{method:?} {cells:?}"));
            }
        }
    }
}

#[test]
fn what_needs_keys_is_refused_without() {
    let grid = Grid::try_new([0.0; 3], 1.0).unwrap();
    let settings = ChunkSettings::default().with_keys(false);
    let method = Method::SurfaceNets(SurfaceNets::default());
    let refused = LevelExtractor::try_new(&grid, &method, &settings).map(|_| ());
    assert_eq!(refused, Err(LevelError::Chunk(ChunkError::LevelsNeedKeys)));

    let ball = from_fn(|[x, y, z]| 3.1 - (x * x + y * y + z * z).sqrt());
    let mut extractor = ChunkExtractor::try_new(&grid, &method, &settings).unwrap();
    let chunk = extractor.extract(&ball, grid.chunk([0; 3], 8), Control::default()).unwrap();
    assert!(!chunk.triangles.is_empty());
    assert_eq!(weld_chunks([&chunk]), Err(WeldError::NoKeys));
    let mut payload = vec![1];
    chunk.payload(|_, _| 1, &mut payload);
    assert!(payload.is_empty());
    assert!(chunk.world().unwrap().to_string().ends_with(" without keys"), "{}", chunk.world().unwrap());
}
