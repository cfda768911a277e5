//! Chunks of a grid without an end: far from the origin and west of it, they are the chunks of a box, fit each other, and
//! say when they do not.

use crate::fields::{FAMILIES, Volume};
use crate::survey::survey;
use glam::Vec3;
use isostudy_extract::{
    Aabb, Arrangement, BoxGrid, CellBox, Chunk, ChunkError, ChunkExtractor, ChunkSettings, Clustering,
    Control, ExtractError, Grid, LatticeError, Method, Placement, Source, Tetrahedra, WeldError, from_fn,
    weld_chunks,
};
use isostudy_field::{Sphere, StudyField};
use isostudy_mesh::{Bounds, TriangleMesh};

fn method(arrangement: Arrangement, placement: Placement) -> Method {
    let clustering = match arrangement {
        Arrangement::BodyCentred | Arrangement::SimpleCubic => Clustering::Integrated,
        Arrangement::FiveTetrahedra | Arrangement::FaceCentred => Clustering::None,
    };
    Method::Tetrahedra(Tetrahedra::new(arrangement).with_clustering(clustering).with_placement(placement))
}

fn extractor(grid: &Grid, method: &Method) -> ChunkExtractor {
    ChunkExtractor::try_new(grid, method, &ChunkSettings::default()).unwrap()
}

fn bits(mesh: &TriangleMesh) -> [Vec<[u32; 3]>; 3] {
    let of = |points: &[Vec3]| points.iter().map(|p| p.to_array().map(f32::to_bits)).collect();
    [of(&mesh.positions), of(&mesh.normals), mesh.triangles.clone()]
}

/// Ids of the chunks round the origin.
fn ids(from: i32, to: i32) -> impl Iterator<Item = [i32; 3]> {
    (from..to).flat_map(move |z| (from..to).flat_map(move |y| (from..to).map(move |x| [x, y, z])))
}

/// A surface with holes and thin places, about a cell wide where it is thinnest.
fn waves([x, y, z]: [f32; 3]) -> f32 {
    (1.7 * x).sin() * (1.3 * y).cos() + (2.1 * z).sin() * (0.9 * x).cos() - 0.1
}

/// Coordinates are whole quarters, so that the box's own rule has the same bits.
#[test]
fn a_grid_without_an_end_has_the_chunks_of_a_box() {
    let corner = -16.0;
    let bounds = Bounds { min: Vec3::splat(corner), max: Vec3::splat(-corner) };
    let (boxed, grid) =
        (BoxGrid { bounds, spacing: 0.25 }, Grid::try_new([f64::from(corner); 3], 0.25).unwrap());
    let field = from_fn(waves);
    for arrangement in Arrangement::ALL {
        for placement in [Placement::MeanOfCrossings, Placement::Projected, Placement::Relaxed] {
            let method = method(arrangement, placement);
            let mut of_box = ChunkExtractor::in_box(&boxed, &method, &ChunkSettings::default()).unwrap();
            let mut of_grid = extractor(&grid, &method);
            for start in [[40, 60, 50], [70, 30, 64]] {
                let cells = CellBox { start, end: start.map(|i| i + 9) };
                let [one, other] = [
                    of_box.extract(&field, cells, Control::default()).unwrap(),
                    of_grid.extract(&field, cells, Control::default()).unwrap(),
                ];
                assert!(one.triangles.len() > 100);
                // How far vertices of one sample keep from each other goes by the farthest coordinate of a box, and by the
                // sample's own where there is none: next to nothing.
                let near = |a: &[f32; 3], b: &[f32; 3]| Vec3::from(*a).distance(Vec3::from(*b)) < 1e-4;
                let is_same = one.positions.iter().zip(&other.positions).all(|(a, b)| near(a, b))
                    && one.triangles == other.triangles;
                assert!(is_same, "{arrangement} {placement:?} {start:?}");
                assert_eq!((one.keys, one.triangle_cells), (other.keys, other.triangle_cells));
                assert_eq!((one.window, one.cells), (other.window, other.cells));
            }
        }
    }
}

/// In any grid, what is welded of small chunks is what is welded of large ones, and closed where the solid is.
#[test]
fn chunks_of_any_size_weld_to_the_same_mesh() {
    for (origin, spacing) in [([0.0; 3], 0.3), ([-7.3, 1e3, -41.7], 0.3), ([16e3, -1e4, 3.1], 1.0 / 3.0)] {
        let grid = Grid::try_new(origin, spacing).unwrap();
        let [x, y, z] = origin.map(|c| c as f32);
        let ball = from_fn(move |p: [f32; 3]| {
            let from = Vec3::from(p) - Vec3::new(x + 0.1, y - 0.2, z + 0.1);
            2.6 - from.length() + 0.4 * waves((2.0 * from).to_array())
        });
        for arrangement in Arrangement::ALL {
            for placement in [Placement::MeanOfCrossings, Placement::Projected, Placement::Relaxed] {
                let method = method(arrangement, placement);
                let mut extractor = extractor(&grid, &method);
                let mut welded = |size: u32, reach: i32| {
                    let chunks: Vec<Chunk> = ids(-reach, reach)
                        .map(|id| extractor.extract(&ball, grid.chunk(id, size), Control::default()).unwrap())
                        .collect();
                    weld_chunks(&chunks).unwrap()
                };
                let (large, small) = (welded(16, 1), welded(4, 4));
                assert!(large.triangles.len() > 1000);
                assert!(bits(&large) == bits(&small), "{arrangement} {placement:?} {origin:?}");
                let pieces = survey(large.positions.len(), &large.triangles).unwrap();
                assert!(pieces.iter().all(|piece| piece.1 == 0), "{arrangement} {placement:?}: it is open");
            }
        }
    }
}

/// Every family of samples, so that many moves are refused: the chunks of a box are the whole wherever vertices go.
#[test]
fn moved_vertices_weld_to_the_whole_whatever_the_samples() {
    let mut moved = 0;
    for (i, family) in FAMILIES.into_iter().enumerate() {
        for arrangement in Arrangement::ALL {
            let volume = Volume::random(arrangement, 9, family, i as u64);
            let volume = if i % 2 == 0 { volume.closed() } else { volume };
            let grid = BoxGrid::from(&volume.lattice());
            for placement in [Placement::Projected, Placement::Relaxed] {
                let method = method(arrangement, placement);
                let source = Source::Study(&volume);
                let mesh_by = |method: &Method| {
                    let mut extractor = isostudy_extract::Extractor::new();
                    let execution = isostudy_extract::Execution { threads: 1 };
                    method.extract(&mut extractor, source, &grid, 0.0, &execution).unwrap().mesh
                };
                let whole = mesh_by(&method);
                moved +=
                    usize::from(whole != mesh_by(&self::method(arrangement, Placement::MeanOfCrossings)));
                let mut chunks = ChunkExtractor::in_box(&grid, &method, &ChunkSettings::default()).unwrap();
                let boxes: Vec<CellBox> = chunks.grid(5).collect();
                let parts: Vec<Chunk> = boxes
                    .into_iter()
                    .map(|cells| chunks.extract(source, cells, Control::default()).unwrap())
                    .collect();
                assert_eq!(
                    bits(&weld_chunks(&parts).unwrap()),
                    bits(&whole),
                    "{family:?} {arrangement} {placement:?}"
                );
            }
        }
    }
    assert!(moved > 20, "{moved}");
}

#[test]
fn a_window_of_samples_gives_the_chunk_of_the_field() {
    let grid = Grid::try_new([-3.0, 0.0, 5.0], 0.25).unwrap();
    let field = from_fn(waves);
    for arrangement in Arrangement::ALL {
        let method = method(arrangement, Placement::MeanOfCrossings);
        let mut extractor = extractor(&grid, &method);
        let cells = CellBox { start: [-5, -3, 2], end: [3, 6, 9] };
        let called = extractor.extract(&field, cells, Control::default()).unwrap();
        assert!(called.triangles.len() > 100);
        let window = extractor.window(cells).unwrap().unwrap();
        assert_eq!(Some(window), method.window(cells));
        // The window, and one that goes farther on some sides.
        let larger = CellBox {
            start: window.start.map(|i| i - 1),
            end: [window.end[0], window.end[1] + 3, window.end[2]],
        };
        for given in [window, larger] {
            let layout = extractor.layout(given).unwrap();
            let mut samples = Vec::new();
            layout.fill(&field, &mut samples);
            assert_eq!(samples.len(), layout.len());
            let source = Source::Window { cells: given, samples: &samples };
            let chunk = extractor.extract(source, cells, Control::default()).unwrap();
            assert_eq!(chunk, called, "{arrangement}");
            // Each sample is the field's at its place, and found there.
            for (i, &sample) in samples.iter().enumerate() {
                if let (Some(p), Some(point)) = (layout.position(i), layout.point(i)) {
                    assert_eq!((layout.index(point), sample), (Some(i), waves(p)));
                    let place =
                        [0, 1, 2].map(|axis| (grid.origin()[axis] + point[axis] as f64 * 0.125) as f32);
                    assert_eq!(place, p);
                }
            }
            assert_eq!((layout.point(samples.len()), layout.index([1 << 40; 3])), (None, None));
        }
        let given = CellBox { end: window.end.map(|i| i - 1), ..window };
        let samples = vec![0.0; extractor.layout(given).unwrap().len()];
        let refused = |source: Source, extractor: &mut ChunkExtractor| {
            extractor.extract(source, cells, Control::default()).unwrap_err()
        };
        let error = refused(Source::Window { cells: given, samples: &samples }, &mut extractor);
        assert_eq!(error, ChunkError::Window { given, wanted: window });
        let error = refused(Source::Window { cells: window, samples: &samples }, &mut extractor);
        let wanted = extractor.layout(window).unwrap().len() as u64;
        let few = ExtractError::SampleCount { given: samples.len() as u64, wanted };
        assert_eq!(error, ChunkError::Extract(few));
        assert_eq!(refused(Source::Samples(&samples), &mut extractor), ChunkError::EndlessSamples);
    }
}

fn chunk_at(grid: &Grid, start: i32, field: &dyn StudyField) -> Chunk {
    let cells = CellBox { start: [start, 0, 0], end: [start + 8, 8, 8] };
    extractor(grid, &method(Arrangement::BodyCentred, Placement::MeanOfCrossings))
        .extract(field, cells, Control::default())
        .unwrap()
}

#[test]
fn chunks_of_two_worlds_do_not_weld() {
    let here = Grid::try_new([0.0; 3], 1.0).unwrap();
    let ball = Sphere { radius: 6.5 };
    let chunk = chunk_at(&here, 0, &ball);
    assert!(!chunk.triangles.is_empty());
    let others = [Grid::try_new([500.0, 0.0, 0.0], 1.0), Grid::try_new([0.0; 3], 2.0)];
    for other in others.map(Result::unwrap) {
        // Of cells that the first one does not have, so that no cell is there twice.
        let error = weld_chunks([&chunk, &chunk_at(&other, 8, &ball)]).unwrap_err();
        let WeldError::Worlds { worlds } = &error else { panic!("{error}") };
        assert_eq!((worlds[0].grid(), worlds[1].grid()), (Some(&here), Some(&other)));
        let told = error.to_string();
        for part in
            [format!("cells of {} from {:?}", here.spacing(), here.origin()), format!("{:?}", other.origin())]
        {
            assert!(told.contains(&part), "{told}");
        }
    }
    let method = method(Arrangement::SimpleCubic, Placement::MeanOfCrossings);
    let cells = CellBox { start: [8, 0, 0], end: [16, 8, 8] };
    let cubic = extractor(&here, &method).extract(&ball, cells, Control::default()).unwrap();
    assert!(matches!(weld_chunks([&chunk, &cubic]), Err(WeldError::Worlds { .. })));
    assert!(cubic.is_of(&here, &method) && !chunk.is_of(&here, &method));
    let settings = ChunkSettings::default().with_isovalue(0.5);
    let method = *chunk.world().unwrap().method();
    let mut extractor = ChunkExtractor::try_new(&here, &method, &settings).unwrap();
    let raised = extractor.extract(&ball, cells, Control::default()).unwrap();
    assert!(matches!(weld_chunks([&chunk, &raised]), Err(WeldError::Worlds { .. })));
    // One that was never extracted is of none.
    assert_eq!(weld_chunks([&chunk, &Chunk::default()]).unwrap().triangles, chunk.triangles);
}

/// Two fields whose normals differ at the seam, and positions do not.
#[test]
fn a_mismatch_names_the_vertex_the_chunks_and_both_normals() {
    let grid = Grid::try_new([0.0; 3], 1.0).unwrap();
    struct Roof(f32);
    impl StudyField for Roof {
        fn sample(&self, p: Vec3) -> f32 {
            4.3 - p.z - self.0 * (p.x - 9.0).max(0.0)
        }
    }
    let (flat, bent) = (chunk_at(&grid, 0, &Roof(0.0)), chunk_at(&grid, 8, &Roof(0.5)));
    let error = weld_chunks([&flat, &bent]).unwrap_err();
    let WeldError::Mismatch(found) = &error else { panic!("{error}") };
    assert_eq!(found.chunks, [flat.cells, bent.cells]);
    assert_eq!(found.positions[0], found.positions[1]);
    assert_ne!(found.normals[0], found.normals[1]);
    assert!(flat.keys.contains(&found.key) && bent.keys.contains(&found.key));
    let told = error.to_string();
    for part in [
        format!("{:?}", found.normals[0]),
        format!("{:?}", found.normals[1]),
        format!("{:#x}", found.key.number()),
    ] {
        assert!(told.contains(&part), "{told}");
    }
}

/// Every chunk that looks at a point is named, and no other.
#[test]
fn touched_chunks_are_those_that_look_there() {
    let grid = Grid::try_new([0.7, -3.0, 11.0], 0.3).unwrap();
    let plane = from_fn(|[_, _, z]| 11.2 - z);
    for arrangement in Arrangement::ALL {
        let method = method(arrangement, Placement::MeanOfCrossings);
        let mut extractor = extractor(&grid, &method);
        let chunks: Vec<([i32; 3], Chunk)> = ids(-3, 4)
            .map(|id| (id, extractor.extract(&plane, grid.chunk(id, 5), Control::default()).unwrap()))
            .collect();
        for (centre, radius) in
            [([0.7, -3.0, 11.0], 0.0), ([1.1, -2.4, 11.9], 0.2), ([2.2, -4.4, 10.0], 0.751)]
        {
            let changed = Aabb::around(centre, radius);
            let named: Vec<[i32; 3]> = grid.touched(changed, 5, &method).unwrap().collect();
            let looking: Vec<[i32; 3]> =
                chunks.iter().filter(|(_, chunk)| chunk.is_touched_by(changed)).map(|(id, _)| *id).collect();
            assert_eq!(named, looking, "{arrangement} {changed:?}");
            assert!(named.contains(&grid.chunk_at(centre, 5)));
        }
    }
}

#[test]
fn a_chunk_knows_its_place() {
    let grid = Grid::try_new([-100.0, 0.0, 0.0], 0.5).unwrap();
    let ball = from_fn(|p: [f32; 3]| 3.0 - Vec3::from(p).distance(Vec3::new(-104.0, 2.0, 2.0)));
    let method = method(Arrangement::BodyCentred, Placement::MeanOfCrossings);
    let cells = CellBox { start: [-20, -4, -4], end: [4, 12, 12] };
    let chunk = extractor(&grid, &method).extract(&ball, cells, Control::default()).unwrap();
    assert_eq!(chunk.origin(), [-110.0, -2.0, -2.0]);
    let bounds = chunk.bounds().unwrap();
    for axis in 0..3 {
        let along = || chunk.positions.iter().map(|p| p[axis]);
        assert_eq!(along().fold(f32::INFINITY, f32::min), bounds.min[axis]);
        assert_eq!(along().fold(f32::NEG_INFINITY, f32::max), bounds.max[axis]);
        assert!((bounds.max[axis] - bounds.min[axis] - 6.0).abs() < 0.1);
    }
    let mut relative = Vec::new();
    chunk.relative_positions(&mut relative);
    assert!(relative.iter().zip(&chunk.positions).all(|(near, far)| {
        (0..3).all(|axis| (f64::from(near[axis]) + chunk.origin()[axis] - f64::from(far[axis])).abs() < 1e-5)
    }));
    let mut indices = Vec::new();
    chunk.indices_u16(&mut indices).unwrap();
    assert!(indices.iter().map(|&i| u32::from(i)).eq(chunk.triangles.iter().flatten().copied()));
    // Each triangle lies in its cell, or half a cell beyond: tetrahedra join the centres of neighbours.
    for (t, triangle) in chunk.triangles.iter().enumerate() {
        let cell = chunk.cell_of(t);
        assert!(chunk.cells.contains(cell));
        let low = grid.position(cell);
        for &v in triangle {
            for (p, low) in chunk.positions[v as usize].iter().zip(low) {
                let along = f64::from(*p) - low;
                assert!((-0.5..=1.0).contains(&along), "{along}");
            }
        }
    }
    assert!(chunk.keys.iter().all(|key| chunk.window.contains(key.cell())));
    let empty = extractor(&grid, &method).extract(&from_fn(|_| -1.0), cells, Control::default()).unwrap();
    assert_eq!((empty.bounds(), empty.origin()), (None, chunk.origin()));
}

#[test]
fn too_many_vertices_for_16_bits_are_an_error() {
    let mut chunk = Chunk::default();
    chunk.positions = vec![[0.0; 3]; 1 << 16];
    chunk.triangles = vec![[65533, 65534, 65535]];
    let mut indices = vec![7; 9];
    chunk.indices_u16(&mut indices).unwrap();
    assert_eq!(indices, [65533, 65534, 65535]);
    chunk.positions.push([0.0; 3]);
    assert_eq!(chunk.indices_u16(&mut indices).unwrap_err().vertices, 65537);
    assert!(indices.is_empty());
}

#[test]
fn what_has_no_place_is_refused() {
    let grid = Grid::try_new([0.0; 3], 1.0).unwrap();
    let method = method(Arrangement::SimpleCubic, Placement::MeanOfCrossings);
    let mut extractor = extractor(&grid, &method);
    let ball = from_fn(|_| 1.0);
    let mut refused = |start: [i32; 3], end: [i32; 3]| {
        extractor.extract(&ball, CellBox { start, end }, Control::default()).unwrap_err()
    };
    for (start, end) in
        [([0; 3], [0, 1, 1]), ([i32::MIN; 3], [0; 3]), ([i32::MAX - 2; 3], [i32::MAX; 3]), ([5; 3], [-5; 3])]
    {
        assert!(matches!(refused(start, end), ChunkError::Cells { .. }), "{start:?}");
    }
    let error = refused([-1_000_000; 3], [1_000_000; 3]);
    assert!(
        matches!(error, ChunkError::Extract(ExtractError::Grid(LatticeError::TooManySamples { .. }))),
        "{error}"
    );
    let huge = Grid::try_new([3e38; 3], 1e37).unwrap();
    let mut extractor = ChunkExtractor::try_new(&huge, &method, &ChunkSettings::default()).unwrap();
    let error = extractor.extract(&ball, huge.chunk([0; 3], 8), Control::default()).unwrap_err();
    assert!(
        matches!(error, ChunkError::Extract(ExtractError::Grid(LatticeError::OutOfRange { .. }))),
        "{error}"
    );
    let collapse = Tetrahedra::new(Arrangement::SimpleCubic).with_clustering(Clustering::EdgeCollapse);
    let error = ChunkExtractor::try_new(&grid, &Method::Tetrahedra(collapse), &ChunkSettings::default());
    assert_eq!(error.err(), Some(ChunkError::EndlessCollapse));
}

/// A terrain 2 million units to the west, deep down, and the same at the origin: whole numbers of cells apart.
#[test]
fn chunks_far_away_are_those_at_home() {
    let home = Grid::try_new([0.0; 3], 1.0).unwrap();
    let far = [-2_000_000, 64, -1_000_000];
    let away = from_fn(move |p: [f32; 3]| waves([0, 1, 2].map(|axis| 0.25 * (p[axis] - far[axis] as f32))));
    let near = from_fn(|p: [f32; 3]| waves(p.map(|c| 0.25 * c)));
    for arrangement in Arrangement::ALL {
        let mut extractor = extractor(&home, &method(arrangement, Placement::MeanOfCrossings));
        let cells = CellBox { start: [-6; 3], end: [6; 3] };
        let there = CellBox { start: [0, 1, 2].map(|i| far[i] - 6), end: [0, 1, 2].map(|i| far[i] + 6) };
        let one = extractor.extract(&near, cells, Control::default()).unwrap();
        let other = extractor.extract(&away, there, Control::default()).unwrap();
        assert!(one.triangles.len() > 200);
        assert_eq!(
            (&one.triangles, &one.triangle_cells),
            (&other.triangles, &other.triangle_cells),
            "{arrangement}"
        );
        for (key, there) in one.keys.iter().zip(&other.keys) {
            assert_eq!([0, 1, 2].map(|i| key.cell()[i] + far[i]), there.cell());
        }
    }
}
