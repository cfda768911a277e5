//! Vertices of cubes against the exact crossing, in whole numbers: four units in the last place, wherever the grid is.

use isostudy_extract::{
    CellBox, ChunkExtractor, ChunkSettings, Control, Cubes, Faces, Grid, Method, ScalarField, from_fn,
};

/// Samples that have nothing to do with each other, by the nearest lattice point.
fn noise(seed: u32, grid: Grid, levels: f32) -> impl ScalarField {
    let [origin, spacing] = [grid.origin(), [grid.spacing(); 3]];
    from_fn(move |p: [f32; 3]| {
        let mut hash = seed.wrapping_mul(0x9e37_79b9);
        for axis in 0..3 {
            let i = ((f64::from(p[axis]) - origin[axis]) / spacing[axis]).round() as i32;
            hash = (hash ^ i as u32).wrapping_mul(0x85eb_ca6b);
            hash = (hash ^ hash >> 13).wrapping_mul(0xc2b2_ae35);
            hash ^= hash >> 16;
        }
        let unit = (hash >> 8) as f32 / (1 << 24) as f32;
        // Few levels: many samples equal the isovalue. Else numbers of very different sizes.
        let size = if levels > 0.0 { 1.0 } else { 0.5f32.powi((hash & 15) as i32) };
        let unit = if levels > 0.0 { (unit * levels).floor() / levels } else { unit };
        (unit - 0.5) * size
    })
}

/// A number of single precision as `m * 2^e`.
fn parts(x: f32) -> (i128, i32) {
    let bits = x.to_bits();
    let exponent = (bits >> 23 & 255) as i32;
    let mantissa = i128::from(bits & 0x7f_ffff) | if exponent > 0 { 1 << 23 } else { 0 };
    (if x < 0.0 { -mantissa } else { mantissa }, exponent.max(1) - 150)
}

/// All as whole numbers of one unit.
fn whole<const N: usize>(numbers: [f32; N]) -> ([i128; N], i32) {
    let unit = numbers.iter().filter(|x| **x != 0.0).map(|x| parts(*x).1).min().unwrap_or(0);
    let one = |x: f32| if x == 0.0 { 0 } else { parts(x).0 << (parts(x).1 - unit) };
    (numbers.map(one), unit)
}

/// How many units in the last place a coordinate is from the exact crossing of an edge, rounded up. The unit is that of the crossing,
/// and less than a cell from zero that of the edge's length.
fn units_off(at: f32, [from, to]: [f32; 2], [here, there]: [f32; 2]) -> i128 {
    let ([at_, from_, to_], place) = whole([at, from, to]);
    let ([here_, there_], _) = whole([here, there]);
    // The isovalue is 0: the crossing is `from - (to - from) * here / (there - here)`.
    let off = ((at_ - from_) * (there_ - here_) + (to_ - from_) * here_).abs();
    let size = from.abs().min(to.abs()).max(to - from);
    let last = parts(size).1 - place;
    let (over, under) = if last >= 0 { (1i128 << last, 1) } else { (1, 1i128 << -last) };
    let unit = over * (there_ - here_).abs();
    (off * under + unit - 1) / unit
}

#[test]
fn crossings_are_exact_to_four_units_in_the_last_place() {
    let (mut checked, mut worst) = (0, 0);
    // No lattice point is so near to zero that whole numbers of its unit overflow.
    let offsets = [[0.0; 3], [-3.71, 0.33, 11.17], [1e3, -1e3, 7.3], [1e5, -1e5, 1e5], [1e6, -1e6, 3e5]];
    for (o, origin) in offsets.into_iter().enumerate() {
        for (s, spacing) in [1.0, 0.25, 0.3, 2.7].into_iter().enumerate() {
            // Not where a cell is but a few numbers wide.
            if spacing < 1.0 && o == 4 {
                continue;
            }
            let grid = Grid::try_new(origin, spacing).unwrap();
            for (faces, levels) in [(Faces::default(), 0.0), (Faces::Trilinear, 4.0), (Faces::Decider, 64.0)]
            {
                let method = Method::Cubes(Cubes::default().with_faces(faces));
                let field = noise((4 * o + s) as u32, grid, levels);
                let mut extractor =
                    ChunkExtractor::try_new(&grid, &method, &ChunkSettings::default()).unwrap();
                let cells = CellBox { start: [-3, -4, -2], end: [5, 4, 5] };
                let chunk = extractor.extract(&field, cells, Control::default()).unwrap();
                assert!(chunk.positions.len() > 500);
                let point = |corner: [i32; 3]| grid.position(corner).map(|c| c as f32);
                for (key, p) in chunk.keys.iter().zip(&chunk.positions) {
                    // The last bits are the edge's axis; vertices of tunnels have more, and are no crossings.
                    let axis = (key.number() & 31) as usize;
                    if axis > 2 {
                        continue;
                    }
                    let from = key.cell();
                    let low = point(from);
                    assert!((0..3).all(|other| other == axis || p[other] == low[other]));
                    let mut to = from;
                    to[axis] += 1;
                    let high = point(to);
                    assert!(low[axis] < p[axis] && p[axis] < high[axis], "{p:?} is on a lattice point");
                    let values = [field.sample(low), field.sample(high)];
                    let units = units_off(p[axis], [low[axis], high[axis]], values);
                    assert!(units <= 4, "{origin:?} {spacing}: {p:?} on {low:?} to {high:?}, {units} units");
                    (checked, worst) = (checked + 1, worst.max(units));
                }
            }
        }
    }
    assert!(checked > 40_000 && worst > 1, "{checked} {worst}");
}

/// Far from the origin, a chunk whose grid begins at its own corner has the shape of one at the origin: to the bit, if the field's samples
/// are those. The field is asked for its place in double precision.
#[test]
fn a_chunk_relative_to_its_corner_has_its_shape_anywhere() {
    // Hills that depend on where they are only by the whole chunk, so that the shape is known.
    let hills = |[x, y, z]: [f64; 3]| {
        (3.0 * (0.196_349_540_849_362_07 * x).sin() - 0.3 * (y - 11.0) * (y - 11.0) / 32.0 + 9.3 - z) as f32
    };
    let grid = Grid::try_new([0.0; 3], 0.25).unwrap();
    let method = Method::Cubes(Cubes::default());
    let mut extractor = ChunkExtractor::try_new(&grid, &method, &ChunkSettings::default()).unwrap();
    let mut relative = |corner: [f64; 3]| {
        let field = from_fn(move |p: [f32; 3]| {
            let [x, y, z] = [0, 1, 2].map(|axis| f64::from(p[axis]) + corner[axis]);
            hills([x, y - corner[1], z - corner[2]])
        });
        extractor.extract(&field, grid.chunk([0, 0, 0], 64), Control::default()).unwrap()
    };
    let here = relative([0.0; 3]);
    assert!(here.triangles.len() > 1000);
    for corner in [[1_000_000.0 - 1_000_000.0 % 32.0, 64.0, -1e6], [-32.0 * 31_250.0, 1e6, 1e6]] {
        let there = relative(corner);
        assert_eq!(there.triangles, here.triangles);
        for (p, q) in there.positions.iter().zip(&here.positions) {
            // Two units in the last place, which far from the corner is that of the place in the chunk.
            let near =
                |axis: usize| (p[axis] - q[axis]).abs() <= 2.0 * f32::EPSILON * p[axis].abs().max(0.25);
            assert!((0..3).all(near), "{p:?} {q:?}");
        }
    }
}
