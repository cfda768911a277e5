//! Which chunks are to be seen from a place, and at which level: fine near by, coarse far away.

use std::collections::HashSet;

use isostudy_extract::Grid;

/// Levels, the finest of which has cells of a metre.
pub(crate) const LEVELS: u32 = 4;
/// Cells along a side of a chunk of any level.
pub(crate) const CHUNK: u32 = 16;
/// Chunks of the coarsest level that are seen to every side, and up and down.
pub(crate) const SIGHT: [i32; 3] = [3, 3, 1];
/// A chunk is divided that is nearer than so many of its sides. With 1 or more, levels of neighbours differ by one at most.
const NEAR: f32 = 1.5;

/// A chunk: its level, and its place among those of the level.
pub(crate) type Id = (u32, [i32; 3]);

/// What is to be seen from a place.
#[derive(Default)]
pub(crate) struct View {
    /// The chunk of the coarsest level that has the camera.
    pub(crate) root: [i32; 3],
    pub(crate) wanted: Vec<Id>,
    /// What the camera is too near for.
    divided: HashSet<Id>,
}

impl View {
    /// From a place in a world whose levels have these grids.
    pub(crate) fn from(grids: &[Grid], camera: [f32; 3]) -> Self {
        let top = LEVELS - 1;
        let root = grids[top as usize].chunk_at(camera, CHUNK);
        let mut view = Self { root, ..Self::default() };
        let mut open: Vec<Id> = Vec::new();
        for z in -SIGHT[2]..=SIGHT[2] {
            for y in -SIGHT[1]..=SIGHT[1] {
                open.extend((-SIGHT[0]..=SIGHT[0]).map(|x| (top, [root[0] + x, root[1] + y, z])));
            }
        }
        while let Some((level, id)) = open.pop() {
            if level == 0 || !is_near(&grids[level as usize], id, camera) {
                view.wanted.push((level, id));
                continue;
            }
            view.divided.insert((level, id));
            let part = |o: i32| [0, 1, 2].map(|axis| 2 * id[axis] + (o >> axis & 1));
            open.extend((0..8).map(|o| (level - 1, part(o))));
        }
        view
    }

    /// The level of what touches a chunk in a direction; its own beyond what is seen.
    pub(crate) fn level_at(&self, (level, id): Id, direction: [i32; 3]) -> u32 {
        let there = [0, 1, 2].map(|axis| id[axis] + direction[axis]);
        let at = |level_there: u32| (level_there, there.map(|i| i >> (level_there - level)));
        let (_, root) = at(LEVELS - 1);
        let from = [root[0] - self.root[0], root[1] - self.root[1], root[2]];
        if (0..3).any(|axis| from[axis].abs() > SIGHT[axis]) {
            return level;
        }
        let divided = (level..LEVELS).rev().take_while(|&l| self.divided.contains(&at(l))).count() as u32;
        LEVELS - 1 - divided
    }
}

/// Whether a camera is too near for a chunk as it is.
fn is_near(grid: &Grid, id: [i32; 3], camera: [f32; 3]) -> bool {
    let bounds = grid.bounds(grid.chunk(id, CHUNK));
    let away = (0..3).map(|axis| {
        let [low, high] = [bounds.min[axis], bounds.max[axis]];
        (camera[axis].clamp(low, high) - camera[axis]).abs()
    });
    away.fold(0.0, f32::max) < NEAR * (bounds.max[0] - bounds.min[0])
}
