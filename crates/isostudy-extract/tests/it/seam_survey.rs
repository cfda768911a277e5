//! Shapes and random levels, and what is wrong at the seams between them: shared by tests and `examples/seams.rs`.

use glam::{Mat3, Vec3};
use isostudy_extract::{Chunk, Control, LevelExtractor, Neighbours, ScalarField, from_fn, weld_chunks};
use isostudy_mesh::TriangleMesh;
use isostudy_mesh::self_intersections;

/// Edge of a coarse cell. Those of level 0 are half as long.
pub(crate) const CELL: f32 = 0.25;
/// Coarse chunks along a side of the world, and cells along a side of a chunk.
const CHUNKS: i32 = 6;
const CELLS: u32 = 4;

/// SplitMix64.
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x1234_5678_9abc_def0)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    pub(crate) fn within(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * ((self.next() >> 40) as f32 / (1 << 24) as f32)
    }

    fn turn(&mut self) -> Mat3 {
        let direction = |random: &mut Self| loop {
            let v = Vec3::from_array([0; 3].map(|_| random.within(-1.0, 1.0)));
            if (0.1..1.0).contains(&v.length()) {
                return v.normalize();
            }
        };
        let x = direction(self);
        let y = loop {
            if let Some(y) = direction(self).reject_from(x).try_normalize() {
                break y;
            }
        };
        Mat3::from_cols(x, y, x.cross(y))
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Ball,
    Torus,
    Gyroid,
    /// A ball whose radius is from one coarse cell to four.
    SmallBall,
}

pub(crate) const RESOLVED: [Kind; 3] = [Kind::Ball, Kind::Torus, Kind::Gyroid];

/// A shape somewhere. Radii of curvature are more than four coarse cells, but of small balls.
pub(crate) fn shape(kind: Kind, random: &mut Random) -> Box<dyn ScalarField> {
    let turn = random.turn();
    let middle = Vec3::from_array([0; 3].map(|_| random.within(-4.0, 4.0) * CELL));
    let place = move |p: [f32; 3]| turn * (Vec3::from(p) - middle);
    match kind {
        Kind::Ball | Kind::SmallBall => {
            let cells = if kind == Kind::Ball { [4.1, 8.0] } else { [1.0, 4.0] };
            let radius = random.within(cells[0], cells[1]) * CELL;
            Box::new(from_fn(move |p| radius - place(p).length()))
        }
        Kind::Torus => {
            let tube = random.within(4.1, 5.0) * CELL;
            let ring = random.within(2.1, 2.4) * tube;
            Box::new(from_fn(move |p| {
                let p = place(p);
                tube - (p.truncate().length() - ring).hypot(p.z)
            }))
        }
        Kind::Gyroid => {
            let length = random.within(4.1, 6.0) * CELL;
            Box::new(from_fn(move |p| {
                let q = place(p) / length;
                length * (q.x.sin() * q.y.cos() + q.y.sin() * q.z.cos() + q.z.sin() * q.x.cos())
            }))
        }
    }
}

/// Chunks of two levels, each coarse one divided or not at random.
pub(crate) fn world(
    extractor: &mut LevelExtractor,
    field: &dyn ScalarField,
    random: &mut Random,
) -> Vec<Chunk> {
    let share = random.within(0.2, 0.8);
    let is_fine: Vec<bool> = (0..CHUNKS.pow(3)).map(|_| random.within(0.0, 1.0) < share).collect();
    // Of a place in fine chunks; beyond the world it is the one that is asked from.
    let level_at = |[x, y, z]: [i32; 3], own: u32| {
        let id = [x, y, z].map(|i| (i >> 1) + CHUNKS / 2);
        let is_in = id.iter().all(|i| (0..CHUNKS).contains(i));
        if is_in { u32::from(!is_fine[((id[2] * CHUNKS + id[1]) * CHUNKS + id[0]) as usize]) } else { own }
    };
    let grid = *extractor.grid();
    let mut chunks = Vec::new();
    let all = (0..CHUNKS.pow(3))
        .map(|i| [i % CHUNKS, i / CHUNKS % CHUNKS, i / CHUNKS / CHUNKS].map(|i| i - CHUNKS / 2));
    for coarse in all {
        let low = coarse.map(|i| 2 * i);
        let level = level_at(low, 1);
        let ids: Vec<[i32; 3]> = match level {
            1 => vec![coarse],
            _ => (0..8).map(|o| [0, 1, 2].map(|axis| low[axis] + (o >> axis & 1))).collect(),
        };
        for id in ids {
            let neighbours = Neighbours::try_new(level, |d| {
                let size = 1 << level;
                let ranges = [0, 1, 2].map(|axis| match d[axis] {
                    -1 => (id[axis] * size - 1)..(id[axis] * size),
                    1 => ((id[axis] + 1) * size)..((id[axis] + 1) * size + 1),
                    _ => (id[axis] * size)..((id[axis] + 1) * size),
                });
                let [x, y, z] = ranges;
                let places = z.flat_map(|z| {
                    let x = x.clone();
                    y.clone().flat_map(move |y| x.clone().map(move |x| [x, y, z]))
                });
                places.map(|place| level_at(place, level)).min().unwrap_or(level)
            })
            .unwrap();
            let cells = grid.coarser(level).unwrap().chunk(id, CELLS);
            chunks.push(extractor.extract(field, level, cells, &neighbours, Control::default()).unwrap());
        }
    }
    chunks
}

/// What was found in one world or in many.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Found {
    pub(crate) worlds: u32,
    pub(crate) seam: u64,
    /// Of seams, facing the inside.
    pub(crate) turned: u64,
    /// Of these, of pieces that only the fine level sees: all corners are of the fine level.
    pub(crate) missed: u64,
    /// Of the chunks' own triangles, facing the inside.
    pub(crate) own_turned: u64,
    /// Pairs of triangles that intersect, in the whole mesh.
    pub(crate) pairs: u64,
    pub(crate) worlds_turned: u32,
    pub(crate) worlds_crossing: u32,
    pub(crate) most_pairs: u64,
}

impl Found {
    pub(crate) fn add(&mut self, other: Self) {
        self.worlds += other.worlds;
        self.seam += other.seam;
        self.turned += other.turned;
        self.missed += other.missed;
        self.own_turned += other.own_turned;
        self.pairs += other.pairs;
        self.worlds_turned += other.worlds_turned;
        self.worlds_crossing += other.worlds_crossing;
        self.most_pairs = self.most_pairs.max(other.most_pairs);
    }
}

/// How the slope at a triangle's middle goes with the direction that it faces: 1 where it faces the inside squarely. 0 without area.
pub(crate) fn inward([a, b, c]: [Vec3; 3], field: &dyn ScalarField) -> f32 {
    let middle = (a + b + c) / 3.0;
    let slope = Vec3::from_array(Vec3::AXES.map(|axis| {
        let value = |way: f32| field.sample((middle + axis * way * CELL).to_array());
        value(0.02) - value(-0.02)
    }));
    let normal = (b - a).cross(c - a);
    if normal.length() < 1e-8 * CELL * CELL {
        return 0.0;
    }
    normal.normalize().dot(slope.normalize_or_zero())
}

pub(crate) fn survey(chunks: &[Chunk], field: &dyn ScalarField, with_pairs: bool) -> Found {
    let mut found = Found { worlds: 1, ..Found::default() };
    for chunk in chunks {
        let own = chunk.triangles.len() - chunk.seam as usize;
        for (t, triangle) in chunk.triangles.iter().enumerate() {
            let corners = triangle.map(|v| Vec3::from(chunk.positions[v as usize]));
            let is_turned = u64::from(inward(corners, field) > 0.0);
            if t < own {
                found.own_turned += is_turned;
                continue;
            }
            let is_fine = triangle.iter().all(|&v| chunk.keys[v as usize].level() < chunk.level);
            found.seam += 1;
            found.turned += is_turned;
            found.missed += if is_fine { is_turned } else { 0 };
        }
    }
    if with_pairs {
        let mesh: TriangleMesh = weld_chunks(chunks).unwrap();
        found.pairs = self_intersections(&mesh).unwrap();
    }
    found.most_pairs = found.pairs;
    found.worlds_turned = u32::from(found.turned > 0);
    found.worlds_crossing = u32::from(found.pairs > 0);
    found
}
