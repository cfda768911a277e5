//! Positions from the corner of a chunk on: it is extracted as if its cells began at the origin, and named by where they are.

use glam::Vec3;
use isostudy_field::{Aabb, Bound, ScalarField, StudyField};
use isostudy_mesh::Bounds;

use super::chunk::Chunk;
use super::world::World;
use crate::lattice::CellBox;

/// A box of cells, as far away from others as before.
pub(crate) fn moved(cells: CellBox, by: [i32; 3]) -> CellBox {
    let moved = |corner: [i32; 3]| [0, 1, 2].map(|axis| corner[axis].saturating_add(by[axis]));
    CellBox { start: moved(cells.start), end: moved(cells.end) }
}

/// The way from a corner to the origin.
pub(crate) fn back(corner: [i32; 3]) -> [i32; 3] {
    corner.map(i32::wrapping_neg)
}

/// A field as seen from a corner.
pub(crate) struct Seen<'a, F: ?Sized> {
    pub(crate) field: &'a F,
    pub(crate) corner: [f64; 3],
}

impl<F: ?Sized> Seen<'_, F> {
    /// Where a point is, in single precision as fields are asked.
    fn at(&self, p: [f32; 3]) -> [f32; 3] {
        [0, 1, 2].map(|axis| (self.corner[axis] + f64::from(p[axis])) as f32)
    }

    fn bounds(&self, bounds: Bounds) -> Bounds {
        let at = |p: Vec3| Vec3::from(self.at(p.to_array()));
        Bounds { min: at(bounds.min), max: at(bounds.max) }
    }
}

impl ScalarField for Seen<'_, dyn ScalarField + '_> {
    fn sample(&self, p: [f32; 3]) -> f32 {
        self.field.sample(self.at(p))
    }

    fn gradient(&self, p: [f32; 3]) -> Option<[f32; 3]> {
        self.field.gradient(self.at(p))
    }

    fn bound(&self, bounds: Aabb) -> Bound {
        self.field.bound(Aabb { min: self.at(bounds.min), max: self.at(bounds.max) })
    }
}

impl StudyField for Seen<'_, dyn StudyField + '_> {
    fn sample(&self, p: Vec3) -> f32 {
        self.field.sample(Vec3::from(self.at(p.to_array())))
    }

    fn slope(&self, bounds: Bounds) -> Option<f32> {
        self.field.slope(self.bounds(bounds))
    }

    fn range(&self, bounds: Bounds, value: f32) -> Option<(f32, f32)> {
        self.field.range(self.bounds(bounds), value)
    }

    fn gradient(&self, p: Vec3) -> Option<Vec3> {
        self.field.gradient(Vec3::from(self.at(p.to_array())))
    }
}

/// Names a chunk, whose cells were extracted from the origin on, by where they are. `start` is its lowest cell there.
pub(crate) fn name(chunk: &mut Chunk, level: u32, start: [i32; 3], world: World) {
    for key in &mut chunk.keys {
        // Keys of the next finer or coarser level, whose corners are corners of this one.
        let there = match key.level() {
            finer if finer < level => start.map(|i| i64::from(i) << (level - finer)),
            coarser => start.map(|i| i64::from(i) >> (coarser - level)),
        };
        *key = key.moved(there);
    }
    let corner = world.position(start);
    let at = |p: [f32; 3]| [0, 1, 2].map(|axis| (corner[axis] + f64::from(p[axis])) as f32);
    chunk.sampled = Aabb { min: at(chunk.sampled.min), max: at(chunk.sampled.max) };
    chunk.cells = moved(chunk.cells, start);
    chunk.window = moved(chunk.window, start);
    chunk.world = Some(world);
}
