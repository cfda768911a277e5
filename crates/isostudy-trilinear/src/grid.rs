//! A whole grid: the pieces of its cells put together.

use crate::cell::{EDGES, oriented, regions};
use crate::samples::{Samples, SamplesError, Ties};
use crate::sets::Sets;

/// What the level set of a grid is made of.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Surface {
    /// Connected pieces, in the order of the first edge between samples that each crosses, x fastest.
    pub components: Vec<Component>,
    /// Cells with a tube in them.
    pub tunnel_cells: u64,
    /// Edges between samples that it crosses.
    pub crossed_edges: u64,
}

/// A connected piece of an oriented surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Component {
    /// 2 for a sphere, less 2 for each handle and 1 for each boundary loop.
    pub euler_characteristic: i64,
    /// Curves in which it ends at the faces of the grid.
    pub boundary_loops: u64,
}

impl Component {
    /// Handles: 0 for a sphere, 1 for a torus.
    pub fn genus(&self) -> i64 {
        (2 - self.boundary_loops as i64 - self.euler_characteristic) / 2
    }
}

impl Surface {
    /// The sum over the components.
    pub fn euler_characteristic(&self) -> i64 {
        self.components.iter().map(|component| component.euler_characteristic).sum()
    }

    /// The sum over the components.
    pub fn boundary_loops(&self) -> u64 {
        self.components.iter().map(|component| component.boundary_loops).sum()
    }

    /// The sum over the components: how many tunnels the surface has.
    pub fn genus(&self) -> i64 {
        self.components.iter().map(Component::genus).sum()
    }
}

/// The topology of the trilinear level set, which ends at the faces of the grid.
///
/// Memory is some 8 bytes for a sample and for an edge that the surface crosses.
///
/// # Errors
/// [`SamplesError::Isovalue`].
pub fn topology(samples: &Samples, isovalue: f32, ties: Ties) -> Result<Surface, SamplesError> {
    if !isovalue.is_finite() {
        return Err(SamplesError::Isovalue { value: isovalue });
    }
    let grid = Grid::new(samples, isovalue, ties);
    let mut whole = Whole::new(&grid);
    let tunnel_cells = whole.add_cells(&grid);
    whole.add_faces(&grid);
    Ok(whole.surface(&grid, tunnel_cells))
}

/// Samples, and numbers for the edges between them that are crossed.
struct Grid<'a> {
    samples: Samples<'a>,
    isovalue: f32,
    ties: Ties,
    /// By sample, how many crossed edges begin at samples before it.
    first: Vec<u32>,
    crossed: usize,
}

impl<'a> Grid<'a> {
    fn new(samples: &Samples<'a>, isovalue: f32, ties: Ties) -> Self {
        let mut grid = Self { samples: *samples, isovalue, ties, first: Vec::new(), crossed: 0 };
        let mut first = Vec::with_capacity(samples.values().len());
        for place in grid.places([0; 3]) {
            first.push(grid.crossed as u32);
            grid.crossed += (0..3).filter(|&axis| grid.is_crossed(place, axis)).count();
        }
        grid.first = first;
        grid
    }

    /// All places but the last `less` along each axis, x fastest.
    fn places(&self, less: [usize; 3]) -> impl Iterator<Item = [usize; 3]> + use<> {
        let counts = self.samples.counts();
        let [nx, ny, nz] = [0, 1, 2].map(|axis| counts[axis] - less[axis]);
        (0..nz).flat_map(move |z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])))
    }

    fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        let [nx, ny, _] = self.samples.counts();
        (z * ny + y) * nx + x
    }

    fn value(&self, place: [usize; 3]) -> f32 {
        self.samples.values()[self.index(place)]
    }

    fn is_inside(&self, place: [usize; 3]) -> bool {
        match self.ties {
            Ties::Outside => self.value(place) > self.isovalue,
            Ties::Inside => self.value(place) >= self.isovalue,
        }
    }

    fn is_crossed(&self, place: [usize; 3], axis: usize) -> bool {
        place[axis] + 1 < self.samples.counts()[axis]
            && self.is_inside(place) != self.is_inside(step(place, axis))
    }

    /// The number of a crossed edge.
    fn edge(&self, place: [usize; 3], axis: usize) -> u32 {
        let before = (0..axis).filter(|&axis| self.is_crossed(place, axis)).count() as u32;
        self.first[self.index(place)] + before
    }
}

fn step(mut place: [usize; 3], axis: usize) -> [usize; 3] {
    place[axis] += 1;
    place
}

fn corner(place: [usize; 3], corner: usize) -> [usize; 3] {
    [0, 1, 2].map(|axis| place[axis] + (corner >> axis & 1))
}

/// Crossed edges, joined by pieces of surface; and by arcs at the faces of the grid.
struct Whole {
    joined: Sets,
    at_border: Sets,
    is_at_border: Vec<bool>,
    /// What pieces, less arcs, add at an edge of theirs.
    euler: Vec<i32>,
}

impl Whole {
    fn new(grid: &Grid) -> Self {
        Self {
            joined: Sets::new(grid.crossed),
            at_border: Sets::new(grid.crossed),
            is_at_border: vec![false; grid.crossed],
            euler: vec![0; grid.crossed],
        }
    }

    /// Adds the pieces of all cells; returns how many have a tube.
    fn add_cells(&mut self, grid: &Grid) -> u64 {
        let mut tunnels = 0;
        for place in grid.places([1; 3]) {
            let inside: [bool; 8] = std::array::from_fn(|c| grid.is_inside(corner(place, c)));
            if inside.iter().all(|&side| side == inside[0]) {
                continue;
            }
            let values = std::array::from_fn(|c| grid.value(corner(place, c)));
            let (values, isovalue) = oriented(values, grid.isovalue, grid.ties);
            let regions = regions(values, isovalue);
            // Of each piece the regions on either side, and an edge; of each loop the same.
            let mut pieces: Vec<([u8; 2], u32)> = Vec::with_capacity(4);
            let mut loops: Vec<([u8; 2], u32)> = Vec::with_capacity(4);
            for [a, b] in EDGES.into_iter().filter(|&[a, b]| inside[a] != inside[b]) {
                let [a, b] = if inside[a] { [a, b] } else { [b, a] };
                let edge = grid.edge(corner(place, a.min(b)), (a ^ b).trailing_zeros() as usize);
                let piece = [regions.in_solid[a], regions.in_solid[b]];
                match pieces.iter().find(|(known, _)| *known == piece) {
                    Some(&(_, known)) => self.joined.join(known, edge),
                    None => {
                        pieces.push((piece, edge));
                        self.euler[edge as usize] += 2;
                    }
                }
                let around = [regions.on_surface[a], regions.on_surface[b]];
                if !loops.iter().any(|(known, _)| *known == around) {
                    loops.push((around, edge));
                    self.euler[edge as usize] -= 1;
                }
            }
            tunnels += u64::from(loops.len() > pieces.len());
        }
        tunnels
    }

    /// Adds the arcs of all faces.
    fn add_faces(&mut self, grid: &Grid) {
        for across in 0..3 {
            let [u, v] = [(across + 1) % 3, (across + 2) % 3];
            let mut less = [1; 3];
            less[across] = 0;
            let last = grid.samples.counts()[across] - 1;
            for place in grid.places(less) {
                let round = [place, step(place, u), step(step(place, u), v), step(place, v)];
                let inside = round.map(|place| grid.is_inside(place));
                // From each corner to the next.
                let edge = |k: usize| match k {
                    0 => grid.edge(round[0], u),
                    1 => grid.edge(round[1], v),
                    2 => grid.edge(round[3], u),
                    _ => grid.edge(round[0], v),
                };
                let crossed: Vec<usize> = (0..4).filter(|&k| inside[k] != inside[(k + 1) % 4]).collect();
                let arcs: &[[usize; 2]] = match crossed[..] {
                    [k, l] => &[[k, l]],
                    [_, _, _, _] if self.cuts_off(grid, round, inside) => &[[3, 0], [1, 2]],
                    [_, _, _, _] => &[[0, 1], [2, 3]],
                    _ => &[],
                };
                for arc in arcs {
                    let [k, l] = arc.map(edge);
                    self.euler[k as usize] -= 1;
                    if place[across] == 0 || place[across] == last {
                        self.at_border.join(k, l);
                        self.is_at_border[k as usize] = true;
                        self.is_at_border[l as usize] = true;
                    }
                }
            }
        }
    }

    /// Whether the arcs of an ambiguous face cut off the first and the third corner.
    fn cuts_off(&self, grid: &Grid, round: [[usize; 3]; 4], inside: [bool; 4]) -> bool {
        // A cell with the face at its top and bottom has its regions.
        let [a, b, c, d] = round.map(|place| grid.value(place));
        let (values, isovalue) = oriented([a, b, d, c, a, b, d, c], grid.isovalue, grid.ties);
        let regions = regions(values, isovalue).on_surface;
        let first_is_joined = regions[0] == regions[3];
        debug_assert_ne!(first_is_joined, regions[1] == regions[2], "{inside:?}");
        !first_is_joined
    }

    fn surface(mut self, grid: &Grid, tunnel_cells: u64) -> Surface {
        const NONE: u32 = u32::MAX;
        let mut number = vec![NONE; grid.crossed];
        let mut components: Vec<Component> = Vec::new();
        for edge in 0..grid.crossed as u32 {
            let root = self.joined.root(edge) as usize;
            if number[root] == NONE {
                number[root] = components.len() as u32;
                components.push(Component::default());
            }
            let component = &mut components[number[root] as usize];
            component.euler_characteristic += 1 + i64::from(self.euler[edge as usize]);
            let begins_loop = self.is_at_border[edge as usize] && self.at_border.root(edge) == edge;
            component.boundary_loops += u64::from(begins_loop);
        }
        Surface { components, tunnel_cells, crossed_edges: grid.crossed as u64 }
    }
}
