//! How far vertices of a chunk stand back from finer neighbours, so that a transition has room.

use glam::Vec3;

use super::neighbours::{DIRECTIONS, Neighbours, number};
use crate::lattice::CellBox;
use crate::lattice::endless::Grid;
use crate::sampling::level::Level;
use crate::surface::trace::VertexKey;

/// Where the corners of a chunk's cells go: away from finer chunks by the width of a transition, and other points between corners as
/// these do. All chunks that have a corner say the same of it.
pub(super) struct Shift {
    cells: CellBox,
    grid: Grid,
    width: f64,
    neighbours: Neighbours,
    /// By the side, edge or corner of the chunk that a corner of a cell is on; -1, 0 or 1 along each axis.
    ways: [[i8; 3]; 27],
}

impl Shift {
    pub(super) fn new(cells: CellBox, grid: &Grid, neighbours: &Neighbours, width: f32) -> Self {
        let ways = DIRECTIONS.map(|on| away(neighbours, on));
        Self { cells, grid: *grid, width: f64::from(width), neighbours: *neighbours, ways }
    }

    /// On which side, edge or corner of the chunk a corner of a cell is.
    fn on(&self, corner: [i64; 3]) -> [i32; 3] {
        [0, 1, 2].map(|axis| {
            let is = |end: i32| i32::from(corner[axis] == i64::from(end));
            is(self.cells.end[axis]) - is(self.cells.start[axis])
        })
    }

    fn way(&self, corner: [i64; 3]) -> [i8; 3] {
        self.ways[number(self.on(corner))]
    }

    /// Where a vertex goes that is at `p`. In a lattice edge it goes as the edge's ends do, in a cell as its corners; but only as far as
    /// that leads along the surface, so that no ditch shows (Lengyel 2010). The field says where that is: the normals of triangles are those
    /// of their neighbourhood, and would move two vertices near each other apart.
    pub(super) fn moved(&self, key: VertexKey, p: [f32; 3], level: &Level) -> [f32; 3] {
        let (from, axis) = (key.stored(), key.direction());
        let axes: &[usize] = if axis < 3 { &[axis] } else { &[0, 1, 2] };
        let corners = 1 << axes.len();
        let corner = |c: usize| {
            let mut corner = from;
            axes.iter().enumerate().for_each(|(i, &axis)| corner[axis] += (c >> i & 1) as i64);
            corner
        };
        if (0..corners).all(|c| self.way(corner(c)) == [0; 3]) {
            return p;
        }
        let ratio = |axis: usize| {
            let [low, high] = [0, 1].map(|step| self.grid.coordinate(axis, 2 * (from[axis] + step)));
            ((f64::from(p[axis]) - low) / (high - low)).clamp(0.0, 1.0)
        };
        let mut way_of = [0.0; 3];
        for c in 0..corners {
            let part =
                |(i, &axis): (usize, &usize)| if c >> i & 1 != 0 { ratio(axis) } else { 1.0 - ratio(axis) };
            let weight: f64 = axes.iter().enumerate().map(part).product();
            let way = self.way(corner(c));
            for (axis, sum) in way_of.iter_mut().enumerate() {
                *sum += weight * self.width * self.grid.spacing() * f64::from(way[axis]);
            }
        }
        let n = level.normal(Vec3::from(p)).unwrap_or(Vec3::ZERO).to_array().map(f64::from);
        let off: f64 = (0..3).map(|axis| n[axis] * way_of[axis]).sum();
        [0, 1, 2].map(|axis| (f64::from(p[axis]) + way_of[axis] - off * n[axis]) as f32)
    }

    /// Which copy of a vertex the chunk has: 0 but on an edge of the chunk beyond which there is one of its level, with finer ones on the
    /// sides between them.
    pub(super) fn copy(&self, key: VertexKey) -> u8 {
        let (on, axis) = (self.on(key.stored()), key.direction());
        if axis > 2 {
            return 0;
        }
        let mut edge = on;
        edge[axis] = 0;
        let is_edge = edge.iter().filter(|&&d| d != 0).count() == 2;
        match is_edge && is_alone(&self.neighbours, edge) {
            true if edge[(axis + 1) % 3] > 0 => 1,
            true => 2,
            false => 0,
        }
    }
}

/// Which way a corner goes that is on a side, an edge or a corner of a chunk: from the finer chunks that touch it, along each axis. Chunks of
/// the level that touch it and are connected by sides go the same way; one that is coarser keeps it.
fn away(neighbours: &Neighbours, on: [i32; 3]) -> [i8; 3] {
    // Of the up to eight chunks at the corner, one bit an axis: whether it is beyond.
    let is_beyond = |set: usize, axis: usize| set >> axis & 1 != 0;
    let is_there = |set: usize| (0..3).all(|axis| on[axis] != 0 || !is_beyond(set, axis));
    let step =
        |set: usize| neighbours.step([0, 1, 2].map(|axis| if is_beyond(set, axis) { on[axis] } else { 0 }));
    let all = || (0..8).filter(|&set| is_there(set));
    if all().any(|set| step(set) > 0) || all().all(|set| step(set) == 0) {
        return [0; 3];
    }
    // By sets, one bit each, until there are no more.
    let (mut connected, mut before) = (1_u8, 0);
    while connected != before {
        before = connected;
        let touches = |set: usize| (0..3).any(|axis| before >> (set ^ 1 << axis) & 1 != 0);
        let found = all().filter(|&set| step(set) == 0 && touches(set));
        connected = found.fold(before, |found, set| found | 1 << set);
    }
    [0, 1, 2].map(|axis| {
        // The chunk itself is on the lower side of its upper sides.
        let place = |set: usize| if is_beyond(set, axis) { on[axis] } else { -on[axis] };
        all().filter(|set| connected >> set & 1 != 0).map(place).sum::<i32>().signum() as i8
    })
}

/// Whether chunks of the level meet in an edge of a chunk, with finer ones on both sides of it.
fn is_alone(neighbours: &Neighbours, edge: [i32; 3]) -> bool {
    let mut sides = (0..3).filter(|&axis| edge[axis] != 0).map(|axis| {
        let mut side = [0; 3];
        side[axis] = edge[axis];
        side
    });
    sides.all(|side| neighbours.step(side) < 0) && neighbours.step(edge) == 0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Neighbours of a chunk in a world where `step` says it of each octant round the corner above the chunk.
    fn round(step: impl Fn([i32; 3]) -> u32) -> Neighbours {
        Neighbours::try_new(1, |d| step(d.map(|d| d.max(0)))).unwrap()
    }

    #[test]
    fn corners_go_away_from_finer_chunks() {
        let east = round(|[x, _, _]| 1 - x as u32);
        assert_eq!(away(&east, [1, 0, 0]), [-1, 0, 0]);
        assert_eq!(away(&east, [1, 1, 1]), [-1, 0, 0]);
        assert_eq!(away(&east, [-1, 0, 0]), [0; 3]);
        // The chunk pokes into finer ones; and is round a finer one.
        let alone = round(|d| u32::from(d == [0; 3]));
        assert_eq!(away(&alone, [1, 1, 1]), [-1, -1, -1]);
        assert_eq!(away(&alone, [1, 0, 1]), [-1, 0, -1]);
        let hole = round(|d| u32::from(d != [1, 1, 1]));
        assert_eq!(away(&hole, [1, 1, 1]), [-1, -1, -1]);
        assert_eq!(away(&hole, [1, 1, 0]), [0; 3]);
        let column = round(|[x, y, _]| u32::from([x, y] != [1, 0]));
        assert_eq!(away(&column, [1, 1, 0]), [-1, 1, 0]);
        // Two that meet in an edge go apart.
        let crossed = round(|[x, y, _]| u32::from(x == y));
        assert_eq!(away(&crossed, [1, 1, 0]), [-1, -1, 0]);
        // A coarser one keeps the corner.
        let kept = Neighbours::try_new(1, |[x, y, _]| {
            if x > 0 {
                0
            } else if y > 0 {
                2
            } else {
                1
            }
        })
        .unwrap();
        assert_eq!((away(&kept, [1, 1, 0]), away(&kept, [1, 0, 0])), ([0; 3], [-1, 0, 0]));
    }
}
