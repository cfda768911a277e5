//! What is asked of a front.

use glam::Vec3;

/// What is grown, and how fine. `..Front::of_edge(0.05)` leaves the rest at its default.
#[derive(Debug, Clone, PartialEq)]
pub struct Front {
    /// The length of an edge in the unit of the field's coordinates; with [`Sizing::Curvature`] the greatest.
    pub edge: f64,
    /// Whether edges are shorter where the surface curves.
    pub sizing: Sizing,
    /// Where parts of the surface are begun that stay clear of the box's faces.
    pub seeds: Seeds,
    /// The most triangles at a time; growth ends with an error there, or where there are 40 for each cube of an edge's length that fits
    /// into the box.
    pub most_triangles: usize,
}

impl Front {
    /// Edges of one length, with sampled seeds.
    pub fn of_edge(edge: f64) -> Self {
        Self {
            edge,
            sizing: Sizing::Constant,
            seeds: Seeds::Sampled { cells: Seeds::CELLS },
            most_triangles: 20_000_000,
        }
    }
}

/// How long edges are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sizing {
    /// The same everywhere.
    Constant,
    /// An edge turns the normal by about `angle`, and no edge is meant to be shorter than `smallest` or longer than [`Front::edge`].
    Curvature {
        /// In the unit of the field's coordinates; above 0 and at most the edge.
        smallest: f64,
        /// In radians; above 0 and at most 1.
        angle: f64,
    },
}

/// Where parts of the surface are begun. A part that the box cuts is begun at the box's border, with any of these.
#[derive(Debug, Clone, PartialEq)]
pub enum Seeds {
    /// Points in the box, from each of which Newton's method leads to the surface.
    Points(Vec<Vec3>),
    /// Edges of a coarse grid whose ends lie on different sides.
    Sampled {
        /// Of the grid, along the longest side of the box; from 1 to 512.
        cells: u32,
    },
}

impl Seeds {
    /// So many cells unless something else is said.
    pub const CELLS: u32 = 24;
}

/// What was done.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counts {
    /// Values asked for, those for differences in place of gradients included.
    pub evaluations: u64,
    /// Gradients that the field gave.
    pub gradients: u64,
    /// Closed curves in which the surface meets the box's border.
    pub border_loops: u64,
    /// Seeds from which a part was begun.
    pub seeds: u64,
    /// Triangles that closed leftover loops.
    pub closing_triangles: u64,
    /// Places whose triangles were taken away and grown again with shorter edges.
    pub repairs: u64,
    /// How often all was begun again, because the border itself had to be finer.
    pub restarts: u64,
}
