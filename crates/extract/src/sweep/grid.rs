//! What a sweep needs to know about its lattice, worked out once.

use glam::Vec3;

use crate::lattice::{
    Arrangement, Coordinates, DIRECTIONS, DirectionSet, Directions, Lattice, Layout, PointKind, members,
};
use crate::settings::Positions;
use crate::tetrahedra::{Spoke, spokes};
use crate::triangles::deciding_edges;

/// The most rows that a point and its neighbours lie in.
pub(super) const LINES: usize = 9;
/// The most layers that a point and its neighbours lie in.
const MOST_LAYERS: usize = 5;

/// The lattice as the passes see it.
#[derive(Debug, Clone)]
pub(super) struct Grid {
    pub(super) lattice: Lattice,
    pub(super) layout: Layout,
    pub(super) coordinates: Coordinates,
    pub(super) directions: &'static Directions,
    /// Points a row, rows a layer, layers, as stored.
    pub(super) size: [usize; 3],
    /// Words of sign bits a row.
    pub(super) words: usize,
    /// No neighbour is more layers away.
    pub(super) reach: usize,
    /// The length of the longest lattice edge, in cells.
    pub(super) longest_edge: f32,
    /// From a point to its neighbours in space.
    pub(super) edges: [Vec3; DIRECTIONS],
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
}

impl Grid {
    pub(super) fn new(lattice: &Lattice) -> Self {
        let layout = Layout::new(lattice);
        let directions = lattice.arrangement().directions();
        let half = lattice.spacing() / 2.0;
        let neighbourhood = |kind| Neighbourhood::new(&layout, kind, directions);
        let (reach, base_offset, longest_edge) = match lattice.arrangement() {
            Arrangement::BodyCentred => (2, 1, 1.0),
            Arrangement::SimpleCubic => (1, 0, 3f32.sqrt()),
        };
        Self {
            coordinates: Coordinates::sampled(lattice, &layout, Positions::Indexed),
            directions,
            size: layout.grid(),
            words: layout.grid()[0].div_ceil(64),
            reach,
            edges: directions.offsets.map(|[x, y, z]| Vec3::from_array([x, y, z].map(f32::from)) * half),
            neighbourhoods: [PointKind::Centre, PointKind::Corner].map(neighbourhood),
            spokes: spokes(lattice.arrangement()),
            deciding: deciding_edges(lattice.arrangement()),
            base_offset,
            longest_edge,
            layout,
            lattice: lattice.clone(),
        }
    }

    /// Slots that a ring of layers needs for a point and all its neighbours.
    pub(super) fn slots(&self) -> usize {
        let slots = 2 * self.reach + 1;
        debug_assert!(slots <= MOST_LAYERS);
        slots
    }

    pub(super) fn layer_len(&self) -> usize {
        self.size[0] * self.size[1]
    }

    pub(super) fn neighbourhood(&self, kind: PointKind) -> &Neighbourhood {
        &self.neighbourhoods[kind as usize]
    }

    /// The layer of cells whose base points lie in `layer`, if any.
    pub(super) fn cells_of(&self, layer: usize) -> Option<usize> {
        let z = match self.lattice.arrangement() {
            Arrangement::BodyCentred => (layer / 2).checked_sub(1).filter(|_| layer.is_multiple_of(2))?,
            Arrangement::SimpleCubic => layer,
        };
        (z < self.lattice.cells()[2] as usize).then_some(z)
    }

    /// The edges at the points of a row that belong to the lattice: at the first, between, and at the last.
    pub(super) fn incident(&self, kind: PointKind, row: usize, layer: usize) -> [DirectionSet; 3] {
        let last = self.layout.used(kind)[0] - 1;
        [0, 1.min(last), last].map(|column| self.layout.incident(kind, [column, row, layer]))
    }

    /// The row and layer of each line round a row; where there is none, the row itself, whose points are never
    /// reached from there.
    #[inline]
    pub(super) fn lines(&self, kind: PointKind, row: usize, layer: usize) -> [[usize; 2]; LINES] {
        let mut lines = [[row, layer]; LINES];
        for (line, &[rows, layers]) in lines.iter_mut().zip(&self.neighbourhood(kind).lines) {
            let (y, z) = (row.wrapping_add_signed(rows), layer.wrapping_add_signed(layers));
            if y < self.size[1] && z < self.size[2] {
                *line = [y, z];
            }
        }
        lines
    }
}

impl Neighbourhood {
    fn new(layout: &Layout, kind: PointKind, directions: &Directions) -> Self {
        let mut result = Self { lines: vec![[0, 0]], ..Self::default() };
        for direction in members((1 << DIRECTIONS) - 1) {
            let [shift, rows, layers] = layout.hop(kind, directions.offsets[direction]);
            let known = result.lines.iter().position(|&line| line == [rows, layers]);
            result.line[direction] = known.unwrap_or(result.lines.len());
            result.shift[direction] = shift;
            if known.is_none() {
                result.lines.push([rows, layers]);
            }
        }
        assert!(result.lines.len() <= LINES, "a neighbourhood has at most {LINES} rows");
        result
    }
}
