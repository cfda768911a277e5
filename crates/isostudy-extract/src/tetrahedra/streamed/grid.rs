//! What streaming needs to know about its lattice, worked out once.

use std::collections::TryReserveError;

use glam::{Vec3, Vec3A};
use isostudy_mesh::Bounds;

use crate::lattice::tetrahedra::deciding_edges;
use crate::lattice::tetrahedra::{Spoke, spokes};
use crate::lattice::{
    Border, Coordinates, DIRECTIONS, DirectionSet, Directions, Lattice, Layout, PointKind, Uniform, members,
};
use crate::sampling::tiles::Points;
use crate::settings::Positions;

/// The most rows that a point and its neighbours lie in.
pub(super) const LINES: usize = 9;

/// The lattice as the passes see it.
#[derive(Debug, Clone)]
pub(super) struct UniformGrid {
    pub(super) lattice: Lattice,
    pub(super) border: Border,
    pub(super) layout: Layout,
    pub(super) coordinates: Coordinates,
    pub(super) directions: &'static Directions,
    /// Points a row, rows a layer, layers, as stored.
    pub(super) size: [usize; 3],
    /// Words of sign bits a row.
    pub(super) words: usize,
    /// No neighbour is more layers away.
    pub(super) reach: usize,
    /// From a point to its neighbours in space.
    pub(super) edges: [Vec3A; 16],
    /// The box.
    pub(super) low: Vec3A,
    pub(super) high: Vec3A,
    /// By kind of point.
    pub(super) neighbourhoods: [Neighbourhood; 2],
    /// Round which lattice edges at a cell's base point its tetrahedra stand.
    pub(super) spokes: Vec<Spoke>,
    /// Edges at the base point that tell whether the surface meets the cell.
    pub(super) deciding: DirectionSet,
    /// From cell numbers to row and column of the base point.
    pub(super) base_offset: usize,
}

/// The rows in which the neighbours of a point lie.
#[derive(Debug, Clone, Default)]
pub(super) struct Neighbourhood {
    /// Rows and layers away; the point's own row comes first.
    pub(super) lines: Vec<[isize; 2]>,
    /// For each direction, the number of the line, and -1, 0 or 1 along it.
    pub(super) line: [usize; DIRECTIONS],
    pub(super) shift: [isize; DIRECTIONS],
    /// For each direction, how to get the sign bits of the neighbours of a word of points: from which of the words
    /// before and at it to start, and how far that is shifted.
    pub(super) funnel: [(usize, u32); DIRECTIONS],
}

impl UniformGrid {
    pub(super) fn new(lattice: &Lattice, border: Border) -> Result<Self, TryReserveError> {
        let layout = Layout::new(lattice);
        let directions = lattice.arrangement().directions();
        let neighbourhood = |kind| Neighbourhood::new(&layout, kind, directions);
        let (reach, base_offset) = match lattice.arrangement().expect_uniform() {
            Uniform::BodyCentred => (2, 1),
            Uniform::SimpleCubic => (1, 0),
        };
        Ok(Self {
            coordinates: Coordinates::sampled(lattice, &layout, Positions::Indexed, border)?,
            directions,
            size: layout.grid(),
            words: layout.grid()[0].div_ceil(64),
            reach,
            edges: edges(lattice),
            low: lattice.bounds().min.into(),
            high: lattice.bounds().max.into(),
            neighbourhoods: [PointKind::Centre, PointKind::Corner].map(neighbourhood),
            spokes: spokes(lattice.arrangement()),
            deciding: deciding_edges(lattice.arrangement()),
            base_offset,
            layout,
            lattice: lattice.clone(),
            border,
        })
    }

    /// Makes it that of another lattice of the same arrangement. What is large enough stays.
    pub(super) fn refit(&mut self, lattice: &Lattice, border: Border) -> Result<(), TryReserveError> {
        self.layout = Layout::new(lattice);
        self.coordinates.refit(lattice, &self.layout, border)?;
        self.size = self.layout.grid();
        self.words = self.size[0].div_ceil(64);
        self.edges = edges(lattice);
        (self.low, self.high) = (lattice.bounds().min.into(), lattice.bounds().max.into());
        (self.lattice, self.border) = (lattice.clone(), border);
        Ok(())
    }

    /// Slots that a ring of layers needs for a point and all its neighbours.
    pub(super) fn slots(&self) -> usize {
        2 * self.reach + 1
    }

    pub(super) fn layer_len(&self) -> usize {
        self.size[0] * self.size[1]
    }

    pub(super) fn neighbourhood(&self, kind: PointKind) -> &Neighbourhood {
        &self.neighbourhoods[kind as usize]
    }

    /// The layer of cells whose base points lie in `layer`, if any.
    pub(super) fn cells_of(&self, layer: usize) -> Option<usize> {
        let z = match self.lattice.arrangement().expect_uniform() {
            Uniform::BodyCentred => (layer / 2).checked_sub(1).filter(|_| layer.is_multiple_of(2))?,
            Uniform::SimpleCubic => layer,
        };
        (z < self.lattice.cells()[2] as usize).then_some(z)
    }

    /// The edges at the points of a row that belong to the lattice: at the first, between, and at the last.
    pub(super) fn incident(&self, kind: PointKind, row: usize, layer: usize) -> [DirectionSet; 3] {
        let last = self.layout.used(kind)[0] - 1;
        [0, 1.min(last), last].map(|column| self.layout.incident(kind, [column, row, layer]))
    }

    /// The layer of each line round a layer; where there is none, the layer itself.
    pub(super) fn layers(&self, kind: PointKind, layer: usize) -> [usize; LINES] {
        let mut result = [layer; LINES];
        for (line, &[_, layers]) in result.iter_mut().zip(&self.neighbourhood(kind).lines) {
            *line = Some(layer.wrapping_add_signed(layers)).filter(|&z| z < self.size[2]).unwrap_or(layer);
        }
        result
    }

    /// For each line round a row, the line whose layer it is in, and its row; where there is no such row, the row
    /// itself, whose points are never reached from there.
    #[inline]
    pub(super) fn rows(
        &self,
        kind: PointKind,
        row: usize,
        layer: usize,
        layers: &[usize; LINES],
    ) -> [(usize, usize); LINES] {
        let mut result = [(0, row); LINES];
        for (i, &[rows, away]) in self.neighbourhood(kind).lines.iter().enumerate() {
            let y = row.wrapping_add_signed(rows);
            let is_there = y < self.size[1] && (away == 0 || layers[i % LINES] != layer);
            if is_there {
                result[i % LINES] = (i, y);
            }
        }
        result
    }
}

/// Columns and rows of a tile, and cells in the height of a brick.
pub(super) const TILE: usize = 2;

impl Points for UniformGrid {
    fn size(&self) -> [usize; 3] {
        self.size
    }

    fn side(&self) -> usize {
        TILE
    }

    fn depth(&self) -> usize {
        match self.lattice.arrangement().expect_uniform() {
            Uniform::BodyCentred => 2 * TILE,
            Uniform::SimpleCubic => TILE,
        }
    }

    fn spacing(&self) -> f32 {
        self.lattice.spacing()
    }

    fn bounds(&self, columns: [usize; 2], rows: [usize; 2], layers: [usize; 2]) -> Bounds {
        // Centres are half a cell lower than corners.
        let lowest = match self.lattice.arrangement().expect_uniform() {
            Uniform::BodyCentred => PointKind::Centre,
            Uniform::SimpleCubic => PointKind::Corner,
        };
        let [min, max] = [(0, lowest), (1, PointKind::Corner)].map(|(end, kind)| {
            let (x, y) = (self.coordinates.x(kind)[columns[end]], self.coordinates.y(kind)[rows[end]]);
            Vec3::new(x, y, self.coordinates.z()[layers[end]])
        });
        Bounds { min, max }
    }
}

fn edges(lattice: &Lattice) -> [Vec3A; 16] {
    let (half, offsets) = (lattice.spacing() / 2.0, &lattice.arrangement().directions().offsets);
    std::array::from_fn(|d| Vec3A::from_array(offsets[d % DIRECTIONS].map(f32::from)) * half)
}

impl Neighbourhood {
    fn new(layout: &Layout, kind: PointKind, directions: &Directions) -> Self {
        let mut result = Self { lines: vec![[0, 0]], ..Self::default() };
        for direction in members((1 << DIRECTIONS) - 1) {
            let [shift, rows, layers] = layout.hop(kind, directions.offsets[direction]);
            let known = result.lines.iter().position(|&line| line == [rows, layers]);
            result.line[direction] = known.unwrap_or(result.lines.len());
            result.shift[direction] = shift;
            result.funnel[direction] = match shift {
                -1 => (0, 63),
                0 => (1, 0),
                _ => (1, 1),
            };
            if known.is_none() {
                result.lines.push([rows, layers]);
            }
        }
        assert!(result.lines.len() <= LINES, "a neighbourhood has at most {LINES} rows");
        result
    }
}
