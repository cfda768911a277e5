//! From cube to cube.

use super::Map;
use super::corners::Corners;
use crate::execution::control::Control;
use crate::extraction::ExtractError;
use crate::memory::with_room;

/// The corners of a cell's lower and upper faces along each axis, as bits; corner `x + 2 y + 4 z`.
const FACES: [[u8; 2]; 3] = [[0x55, 0xaa], [0x33, 0xcc], [0x0f, 0xf0]];
/// Cells between two looks at whether somebody has called it off.
const PATIENCE: usize = 1 << 10;

/// A cell that the surface crosses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Visited {
    /// Its place in storage order.
    pub(super) number: u64,
    /// Its corners that are inside, as bits.
    pub(super) inside: u8,
}

/// All cells that are reached from the seeds through faces with corners on both sides, in storage order. Seeds that the surface does not
/// cross reach none.
pub(super) fn reached(
    seeds: &[[usize; 3]],
    corners: &mut Corners,
    control: Control,
) -> Result<Vec<Visited>, ExtractError> {
    let all = corners.cells();
    let mut visited: Map<u8> = Map::default();
    let mut left: Vec<[usize; 3]> = Vec::new();
    for &seed in seeds {
        enter(seed, &mut visited, &mut left, corners)?;
    }
    let mut since = 0;
    while let Some(cell) = left.pop() {
        since += 1;
        if since % PATIENCE == 0 {
            control.check()?;
        }
        let inside = visited[&corners.number(cell)];
        for (axis, sides) in FACES.iter().enumerate() {
            for (side, &face) in sides.iter().enumerate() {
                let is_crossed = inside & face != 0 && inside & face != face;
                let mut next = cell;
                match side {
                    0 if is_crossed && cell[axis] > 0 => next[axis] -= 1,
                    1 if is_crossed && cell[axis] + 1 < all[axis] => next[axis] += 1,
                    _ => continue,
                }
                enter(next, &mut visited, &mut left, corners)?;
            }
        }
    }
    let mut cells = with_room(visited.len())?;
    cells.extend(visited.into_iter().map(|(number, inside)| Visited { number, inside }));
    cells.sort_unstable();
    Ok(cells)
}

/// Notes a cell that the surface crosses, if it was not yet.
fn enter(
    cell: [usize; 3],
    visited: &mut Map<u8>,
    left: &mut Vec<[usize; 3]>,
    corners: &mut Corners,
) -> Result<(), ExtractError> {
    let number = corners.number(cell);
    if visited.contains_key(&number) {
        return Ok(());
    }
    let inside = corners.inside(cell)?;
    if !matches!(inside, 0 | 255) {
        visited.try_reserve(1)?;
        left.try_reserve(1)?;
        visited.insert(number, inside);
        left.push(cell);
    }
    Ok(())
}
