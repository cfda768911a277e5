//! Chunks of two levels round a point and of three in octrees, and what is asked of them together.

use std::collections::HashMap;

use glam::Vec3;
use isostudy_extract::{
    CellBox, Chunk, ChunkSettings, Control, Grid, LevelExtractor, Method, Neighbours, ScalarField, from_fn,
    weld_chunks,
};
use isostudy_mesh::TriangleMesh;
use isostudy_mesh::topology::{TopologyReport, topology};

/// Cells along a side of a coarse chunk.
pub(crate) const CELLS: i32 = 4;

pub(crate) fn extractor(spacing: f64, method: &Method) -> LevelExtractor {
    let grid = Grid::try_new([0.0; 3], spacing).unwrap();
    LevelExtractor::try_new(&grid, method, &ChunkSettings::default()).unwrap()
}

/// The eight chunks round the origin: one bit an octant, x fastest, says which of them are fine.
pub(crate) fn chunks(
    extractor: &mut LevelExtractor,
    field: &dyn ScalarField,
    fine: u32,
    cells: i32,
) -> Vec<Chunk> {
    chunks_by(fine, cells, |level, cells, neighbours| {
        extractor.extract(field, level, cells, neighbours, Control::default()).unwrap()
    })
}

/// The same by any means.
pub(crate) fn chunks_by(
    fine: u32,
    cells: i32,
    mut extract: impl FnMut(u32, CellBox, &Neighbours) -> Chunk,
) -> Vec<Chunk> {
    let octant = |id: [i32; 3]| (0..3).fold(0, |set, axis| set | u32::from(id[axis] >= 0) << axis);
    let level_of = |id: [i32; 3]| 1 - (fine >> octant(id) & 1);
    (0..8)
        .map(|o| {
            let id = [0, 1, 2].map(|axis| (o >> axis & 1) - 1);
            let level = level_of(id);
            let is_out = |i: i32| !(-1..1).contains(&i);
            // Nothing is beyond the eight; say it is of the same level.
            let neighbours = Neighbours::try_new(level, |d| {
                let there = [0, 1, 2].map(|axis| id[axis] + d[axis]);
                if there.into_iter().any(is_out) { level } else { level_of(there) }
            })
            .unwrap();
            let size = if level == 0 { 2 * cells } else { cells };
            let cells = CellBox { start: id.map(|i| i * size), end: id.map(|i| (i + 1) * size) };
            extract(level, cells, &neighbours)
        })
        .collect()
}

/// All triangles with vertices that are the same where their bits are; without those that lose a corner by
/// that.
pub(crate) fn by_position(chunks: &[Chunk]) -> TriangleMesh {
    let mut numbers = HashMap::new();
    let mut mesh = TriangleMesh::default();
    for chunk in chunks {
        for triangle in &chunk.triangles {
            let corners = triangle.map(|v| {
                let p = chunk.positions[v as usize];
                *numbers.entry(p.map(|c| (c + 0.0).to_bits())).or_insert_with(|| {
                    mesh.positions.push(Vec3::from(p));
                    mesh.positions.len() as u32 - 1
                })
            });
            if corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0] {
                mesh.triangles.push(corners);
            }
        }
    }
    mesh
}

/// Edges that are not run as often one way as the other.
pub(crate) fn open_edges(mesh: &TriangleMesh) -> usize {
    let mut runs: HashMap<[u32; 2], i32> = HashMap::new();
    for [a, b, c] in &mesh.triangles {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            *runs.entry([*from.min(to), *from.max(to)]).or_default() += if from < to { 1 } else { -1 };
        }
    }
    runs.values().filter(|&&run| run != 0).count()
}

pub(crate) fn welded(chunks: &[Chunk]) -> TopologyReport {
    topology(&weld_chunks(chunks).unwrap())
}

/// Noise of its own at every point, outside beyond a box.
pub(crate) fn noise(seed: u32, levels: f32, reach: f32) -> impl ScalarField {
    from_fn(move |p: [f32; 3]| {
        if p.iter().any(|c| c.abs() > reach) {
            return -1.0;
        }
        let mut hash = seed.wrapping_mul(0x9e37_79b9);
        for c in p {
            hash = (hash ^ (c + 0.0).to_bits()).wrapping_mul(0x85eb_ca6b);
            hash = (hash ^ hash >> 13).wrapping_mul(0xc2b2_ae35);
            hash ^= hash >> 16;
        }
        ((hash >> 8) as f32 / (1 << 24) as f32 * levels).floor() / levels * 2.0 - 0.9
    })
}

/// How many triangles face the inside, as the field's slope at their middles has it.
pub(crate) fn turned_over(chunks: &[Chunk], field: &dyn ScalarField) -> usize {
    let slope = |p: Vec3| {
        let along = |axis: Vec3| {
            let value = |way: f32| field.sample((p + axis * way).to_array());
            value(1e-2) - value(-1e-2)
        };
        Vec3::from_array(Vec3::AXES.map(along))
    };
    let is_turned = |chunk: &Chunk, triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|v| Vec3::from(chunk.positions[v as usize]));
        // A triangle without area faces nowhere.
        (b - a).cross(c - a).dot(slope((a + b + c) / 3.0)) > 1e-9
    };
    let turned = |chunk: &Chunk| chunk.triangles.iter().filter(|triangle| is_turned(chunk, triangle)).count();
    chunks.iter().map(turned).sum()
}

pub(crate) fn ball(radius: f32, centre: [f32; 3]) -> impl ScalarField {
    from_fn(move |p: [f32; 3]| radius - Vec3::from(p).distance(Vec3::from(centre)))
}

/// A field with what its surface must be, wherever the levels are.
pub(crate) struct Shape {
    pub(crate) field: Box<dyn ScalarField>,
    pub(crate) euler_characteristic: i64,
    /// Whether it is a ball, or nearly one.
    pub(crate) is_round: bool,
}

pub(crate) fn shapes() -> Vec<Shape> {
    let shape = |field: Box<dyn ScalarField>, euler_characteristic, is_round| Shape {
        field,
        euler_characteristic,
        is_round,
    };
    let torus = from_fn(|[x, y, z]: [f32; 3]| {
        let [x, y, z] = [x + 0.05, 0.8 * y + 0.6 * z - 0.02, 0.8 * z - 0.6 * y + 0.03];
        0.75 - (x.hypot(y) - 1.45).hypot(z)
    });
    // Hills with walls and a floor.
    let hills = from_fn(|[x, y, z]: [f32; 3]| {
        let height = 0.4 * (1.9 * x + 0.3).sin() * (1.6 * y).cos() + 0.1 * (3.1 * x - y).sin() + 0.05 - z;
        height.min(2.05 - x.abs().max(y.abs())).min(z + 2.05)
    });
    // A gyroid that a ball cuts off, and a ball with its bumps.
    let wall = |p: [f32; 3], scale: f32| {
        let [x, y, z] = p.map(|c| scale * c + 0.2);
        x.sin() * y.cos() + y.sin() * z.cos() + z.sin() * x.cos()
    };
    let gyroid = from_fn(move |p| 0.4 * wall(p, 2.4) + 0.1 - (Vec3::from(p).length() / 1.95).powi(6));
    let bumps = from_fn(move |p| 1.7 - Vec3::from(p).length() + 0.2 * wall(p, 2.0));
    vec![
        shape(Box::new(ball(1.52, [0.03, -0.11, 0.07])), 2, true),
        shape(Box::new(ball(1.5, [0.0; 3])), 2, true),
        shape(Box::new(ball(1.3, [0.4, -0.2, 0.1])), 2, true),
        shape(Box::new(torus), 0, false),
        shape(Box::new(hills), 2, false),
        shape(Box::new(gyroid), -2, false),
        shape(Box::new(bumps), 2, true),
    ]
}

/// An octree of chunks round the origin: its leaves by level and id. Units are chunks of level 0.
pub(crate) struct Octree {
    pub(crate) leaves: Vec<(u32, [i32; 3])>,
    /// Of each unit, its leaf's level.
    levels: HashMap<[i32; 3], u32>,
}

pub(crate) const REACH: i32 = 4;

impl Octree {
    /// Chunks of level 2, 2 by 2 by 2 of them, divided at random, and further until neighbours differ by one.
    pub(crate) fn random(seed: u32) -> Self {
        let mut state = seed.wrapping_mul(0x9e37_79b9) | 1;
        let mut leaves: Vec<(u32, [i32; 3])> =
            (0..8).map(|o| (2, [0, 1, 2].map(|a| (o >> a & 1) - 1))).collect();
        let divide = |leaves: &mut Vec<(u32, [i32; 3])>, i: usize| {
            let (level, id) = leaves.swap_remove(i);
            leaves.extend((0..8).map(|o| (level - 1, [0, 1, 2].map(|a| 2 * id[a] + (o >> a & 1)))));
        };
        for _ in 0..6 {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let i = (state >> 8) as usize % leaves.len();
            if leaves[i].0 > 0 {
                divide(&mut leaves, i);
            }
        }
        loop {
            let octree = Self::of(leaves.clone());
            let is_steep = |&(level, id): &(u32, [i32; 3])| {
                directions().any(|d| octree.level_at((level, id), d) + 1 < level)
            };
            let Some(i) = leaves.iter().position(is_steep) else { return octree };
            divide(&mut leaves, i);
        }
    }

    fn of(leaves: Vec<(u32, [i32; 3])>) -> Self {
        let mut levels = HashMap::new();
        for &(level, id) in &leaves {
            let size = 1 << level;
            for i in 0..size * size * size {
                let offset = [i % size, i / size % size, i / size / size];
                levels.insert([0, 1, 2].map(|a| id[a] * size + offset[a]), level);
            }
        }
        Self { leaves, levels }
    }

    /// The finest level that touches a leaf in a direction; its own beyond the octree.
    fn level_at(&self, (level, id): (u32, [i32; 3]), direction: [i32; 3]) -> u32 {
        let size = 1 << level;
        let range = |a: usize| match direction[a] {
            -1 => id[a] * size - 1..id[a] * size,
            1 => (id[a] + 1) * size..(id[a] + 1) * size + 1,
            _ => id[a] * size..(id[a] + 1) * size,
        };
        let units = range(2).flat_map(|z| range(1).flat_map(move |y| range(0).map(move |x| [x, y, z])));
        units.filter_map(|unit| self.levels.get(&unit).copied()).min().unwrap_or(level)
    }

    pub(crate) fn chunks(
        &self,
        extractor: &mut LevelExtractor,
        field: &dyn ScalarField,
        cells: u32,
    ) -> Vec<Chunk> {
        self.chunks_by(cells, |level, cells, neighbours| {
            extractor.extract(field, level, cells, neighbours, Control::default()).unwrap()
        })
    }

    /// The same by any means.
    pub(crate) fn chunks_by(
        &self,
        cells: u32,
        mut extract: impl FnMut(u32, CellBox, &Neighbours) -> Chunk,
    ) -> Vec<Chunk> {
        let grid = Grid::try_new([0.0; 3], 1.0).unwrap();
        let one = |&(level, id): &(u32, [i32; 3])| {
            let neighbours = Neighbours::try_new(level, |d| self.level_at((level, id), d)).unwrap();
            extract(level, grid.chunk(id, cells), &neighbours)
        };
        self.leaves.iter().map(one).collect()
    }
}

pub(crate) fn directions() -> impl Iterator<Item = [i32; 3]> {
    (0..27).map(|i| [i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1]).filter(|&d| d != [0; 3])
}
