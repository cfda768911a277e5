//! Which chunks a change of the field can change.

use isostudy_field::Aabb;

use crate::lattice::Arrangement;
use crate::lattice::endless::{Grid, GridError, check};
use crate::method::Method;

impl Grid {
    /// The chunks of so many cells a side that can be other ones when the field has changed in a box and nowhere else:
    /// those that look at samples in it, by id, x fastest.
    ///
    /// The grid is that of one level, whose chunks have no seams: chunks of a [`LevelExtractor`](crate::LevelExtractor) look farther where
    /// neighbours are of another level, and each says itself whether it is [touched](crate::Chunk::is_touched_by).
    ///
    /// The box is that of all points whose *value* changes. To dig a ball out of a distance with `min(solid, ball)`
    /// changes values everywhere outside of the ball that are greater than the distance to it: cut the field off a few
    /// cells inside the solid, as `examples/dig.rs` does.
    ///
    /// # Errors
    /// [`GridError::Bounds`]; [`GridError::NoWindow`] for a method whose chunks look farther than a known window.
    ///
    /// # Panics
    /// If `cells` is 0.
    pub fn touched(
        &self,
        changed: Aabb,
        cells: u32,
        method: &Method,
    ) -> Result<impl Iterator<Item = [i32; 3]> + use<>, GridError> {
        check(&changed)?;
        let halo = i64::from(method.family().halo().ok_or(GridError::NoWindow)?);
        let size = i64::from(cells);
        // Body-centred lattices have centres half a cell beyond their cells.
        let beyond = i64::from(method.family().arrangement() == Arrangement::BodyCentred);
        let from_cell = self.cell_at(changed.min).map(|cell| i64::from(cell) - halo - 2);
        let to_cell = self.cell_at(changed.max).map(|cell| i64::from(cell) + halo + 2);
        let of = move |cell: i64| cell.div_euclid(size) as i32;
        let grid = *self;
        let axis = move |axis: usize| {
            (of(from_cell[axis])..=of(to_cell[axis])).filter(move |&id| {
                let (start, end) = (i64::from(id) * size - halo, (i64::from(id) + 1) * size + halo);
                let low = grid.coordinate(axis, 2 * start - beyond) as f32;
                let high = grid.coordinate(axis, 2 * end + beyond) as f32;
                low <= changed.max[axis] && high >= changed.min[axis]
            })
        };
        Ok(axis(2).flat_map(move |z| axis(1).flat_map(move |y| axis(0).map(move |x| [x, y, z]))))
    }
}
