//! Positions of sample points, one axis at a time.

use std::collections::TryReserveError;

use glam::Vec3;

use super::{Arrangement, DIRECTIONS, DirectionSet, Lattice, Layout, Offset, PointKind, Whole, members};
use crate::memory::{collected, refilled, with_room};
use crate::settings::{ExtractSettings, Positions, Topology};

/// A last cube that the box cuts off is at least this share of the spacing thick; the one before it gives way.
const LEAST_CUBE: f32 = 0.25;

/// Where the outermost points of a lattice lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Border {
    /// Up to a cube beyond the box, as published; vertices there are flattened onto it.
    BeyondBox,
    /// On the box: the tetrahedra fill it and nothing else.
    OnBox,
}

impl Border {
    /// The published rules keep their samples, and so do positions that repeat the original's rounding.
    pub(crate) fn of(settings: &ExtractSettings) -> Self {
        match (settings.topology, settings.positions) {
            (Topology::Guarded, Positions::Indexed) => Self::OnBox,
            (Topology::Published, _) | (_, Positions::Accumulated { .. }) => Self::BeyondBox,
        }
    }
}

/// Coordinates of every sample point. An axis does not depend on the others but for the kind of the layer.
#[derive(Debug, Clone, Default)]
pub(crate) struct Coordinates {
    /// Along a row, by kind of point.
    x: [Vec<f32>; 2],
    /// Down a layer, by kind of point.
    y: [Vec<f32>; 2],
    /// Of each layer.
    z: Vec<f32>,
    /// Along each axis, the first place, and one past the last, of the points whose lattice edges are all as long as the
    /// spacing says.
    regular: [[usize; 2]; 3],
}

impl Coordinates {
    /// Where the field is sampled.
    pub(crate) fn sampled(
        lattice: &Lattice,
        layout: &Layout,
        positions: Positions,
        border: Border,
    ) -> Result<Self, TryReserveError> {
        match positions {
            Positions::Indexed => Self::indexed(lattice, layout, border),
            Positions::Accumulated { chunks } => Self::accumulated(lattice, layout, chunks as usize),
        }
    }

    /// Where crossings are measured from. The original recomputes positions here, by a formula whose rounding in z
    /// is its own; the two sets differ by a few last bits.
    pub(crate) fn measured(
        lattice: &Lattice,
        layout: &Layout,
        positions: Positions,
        border: Border,
    ) -> Result<Self, TryReserveError> {
        match positions {
            Positions::Indexed => Self::indexed(lattice, layout, border),
            Positions::Accumulated { .. } => {
                let z = axes(lattice, layout)[2];
                let layers = (0..layout.grid()[2]).map(|i| i as f32 * z.layer_step + z.first_layer);
                let others = Self::per_axis(lattice, layout, |axis, kind, i| {
                    i as f32 * axis.spacing + axis.start(kind)
                });
                Ok(Self { z: collected(layers)?, ..others? })
            }
        }
    }

    pub(crate) fn x(&self, kind: PointKind) -> &[f32] {
        &self.x[kind as usize]
    }

    pub(crate) fn y(&self, kind: PointKind) -> &[f32] {
        &self.y[kind as usize]
    }

    pub(crate) fn z(&self) -> &[f32] {
        &self.z
    }

    /// From a point to the neighbours that the lattice has, as they lie.
    pub(crate) fn ways(
        &self,
        layout: &Layout,
        point: [usize; 3],
        incident: DirectionSet,
        offsets: &[Offset; DIRECTIONS],
    ) -> [Vec3; DIRECTIONS] {
        let mut ways = [Vec3::ZERO; DIRECTIONS];
        members(incident).for_each(|d| ways[d] = self.way(layout, point, offsets[d]));
        ways
    }

    fn way(&self, layout: &Layout, [x, y, z]: [usize; 3], offset: Offset) -> Vec3 {
        let kind = layout.kind(z);
        let [along, rows, layers] = layout.hop(kind, offset);
        let [to_x, to_y, to_z] = [(x, along), (y, rows), (z, layers)]
            .map(|(from, step)| from.checked_add_signed(step).expect("a point of the lattice"));
        let there = layout.kind(to_z);
        Vec3::new(
            self.x(there)[to_x] - self.x(kind)[x],
            self.y(there)[to_y] - self.y(kind)[y],
            self.z[to_z] - self.z[z],
        )
    }

    /// Whether all lattice edges of a point are as long as the spacing says: always but next to the box, where points lie
    /// on it.
    #[inline]
    pub(crate) fn is_regular(&self, point: [usize; 3]) -> bool {
        (0..3).all(|axis| self.is_regular_along(axis, point[axis]))
    }

    /// The same as far as one axis goes.
    #[inline]
    pub(crate) fn is_regular_along(&self, axis: usize, i: usize) -> bool {
        (self.regular[axis][0]..self.regular[axis][1]).contains(&i)
    }

    /// `min + n * spacing`, `n` whole for corners and half for centres: one rounding of the product, one of the sum,
    /// and nothing carried along. With a border on the box, none beyond it ([`Lattice::coordinate`]).
    fn indexed(lattice: &Lattice, layout: &Layout, border: Border) -> Result<Self, TryReserveError> {
        let mut coordinates = Self::default();
        coordinates.refit(lattice, layout, border)?;
        Ok(coordinates)
    }

    /// Makes them those of another lattice, by the same rule. What is large enough stays.
    pub(crate) fn refit(
        &mut self,
        lattice: &Lattice,
        layout: &Layout,
        border: Border,
    ) -> Result<(), TryReserveError> {
        self.fill(lattice, layout, |axis, kind, i| {
            let i = axis.origin + i as i64;
            let halves = match kind {
                PointKind::Centre => 2 * i - 1,
                PointKind::Corner => 2 * i,
            };
            lattice.coordinate(axis.number, halves, border)
        })?;
        self.regular = axes(lattice, layout).map(|axis| {
            let Some((first, end)) = lattice.regular_points(axis.number, border) else {
                return [0, usize::MAX];
            };
            let place = |i: i64| i.saturating_sub(axis.origin).max(0) as usize;
            match axis.number {
                2 => [place(first), place(end)].map(|i| i * axis.layers_a_cell),
                _ => [place(first), place(end)],
            }
        });
        Ok(())
    }

    /// Running addition along each axis; z starts anew in every chunk of layers, one a sampling thread of the
    /// original. Chunks are `layers / chunks` long and the last takes the remainder.
    fn accumulated(lattice: &Lattice, layout: &Layout, chunks: usize) -> Result<Self, TryReserveError> {
        let axes = axes(lattice, layout);
        let running = |axis: Axis, n: usize| {
            both_kinds(|kind| {
                let mut position = axis.start(kind);
                collected((0..n).map(|_| {
                    let here = position;
                    position += axis.spacing;
                    here
                }))
            })
        };
        let [nx, ny, layers] = layout.grid();
        // With more chunks than layers, the last chunk has them all.
        let chunks = if chunks > layers { 1 } else { chunks };
        let each = layers / chunks;
        let mut z = with_room(layers)?;
        for chunk in 0..chunks {
            let first = each * chunk;
            let last = if chunk + 1 == chunks { layers } else { first + each };
            let mut position = axes[2].first_layer + first as f32 * axes[2].layer_step;
            for _ in first..last {
                z.push(position);
                position += axes[2].layer_step;
            }
        }
        let (x, y) = (running(axes[0], nx)?, running(axes[1], ny)?);
        Ok(Self { x, y, z, regular: ALL_REGULAR })
    }

    fn per_axis(
        lattice: &Lattice,
        layout: &Layout,
        at: impl Fn(Axis, PointKind, usize) -> f32,
    ) -> Result<Self, TryReserveError> {
        let mut coordinates = Self::default();
        coordinates.fill(lattice, layout, at)?;
        Ok(Self { regular: ALL_REGULAR, ..coordinates })
    }

    fn fill(
        &mut self,
        lattice: &Lattice,
        layout: &Layout,
        at: impl Fn(Axis, PointKind, usize) -> f32,
    ) -> Result<(), TryReserveError> {
        let [x, y, z] = axes(lattice, layout);
        let [nx, ny, nz] = layout.grid();
        for kind in [PointKind::Centre, PointKind::Corner] {
            refilled(&mut self.x[kind as usize], (0..nx).map(|i| at(x, kind, i)))?;
            refilled(&mut self.y[kind as usize], (0..ny).map(|i| at(y, kind, i)))?;
        }
        refilled(&mut self.z, (0..nz).map(|i| at(z, layout.kind(i), i / z.layers_a_cell)))
    }
}

/// Nothing is next to the box.
const ALL_REGULAR: [[usize; 2]; 3] = [[0, usize::MAX]; 3];

impl Lattice {
    /// Where stored points are along each axis, of a lattice whose rows stand in line, in vectors that are there. What is large enough
    /// stays.
    pub(crate) fn refit_in_line(
        &self,
        border: Border,
        at: &mut [Vec<f32>; 3],
    ) -> Result<(), TryReserveError> {
        let halves_a_step = if self.arrangement == Arrangement::FaceCentred { 1 } else { 2 };
        let (first, grid) = (self.first_stored(), self.stored_grid());
        for (axis, at) in at.iter_mut().enumerate() {
            let place = |i: u32| self.coordinate(axis, (first[axis] + i64::from(i)) * halves_a_step, border);
            refilled(at, (0..grid[axis]).map(place))?;
        }
        Ok(())
    }

    /// Of the point so many half cells along an axis of the whole lattice.
    pub(crate) fn coordinate(&self, axis: usize, halves: i64, border: Border) -> f32 {
        match (self.whole, border) {
            (Whole::Endless(grid), _) => grid.coordinate(axis, halves) as f32,
            (Whole::Box(_), Border::BeyondBox) => {
                self.bounds.min[axis] + (halves as f32 * 0.5) * self.spacing
            }
            (Whole::Box(cells), Border::OnBox) => self.coordinate_on_box(axis, cells[axis], halves),
        }
    }

    /// Of the point so many half cells along an axis of the whole lattice: `min + halves / 2 * spacing`, and nothing
    /// outside of the box. Outermost points lie on it; where the spacing does not divide the box, the last cube is
    /// thinner.
    fn coordinate_on_box(&self, axis: usize, cells: u32, halves: i64) -> f32 {
        let (min, max, spacing) = (self.bounds.min[axis], self.bounds.max[axis], self.spacing);
        let cells = i64::from(cells);
        let even = |halves: i64| min + (halves as f32 * 0.5) * spacing;
        let corner = |i: i64| match cells - i {
            _ if i <= 0 => min,
            ..=0 => max,
            1 => even(2 * i).min(max - LEAST_CUBE * spacing),
            _ => even(2 * i),
        };
        if halves <= 0 {
            min
        } else if halves >= 2 * cells {
            max
        } else if halves % 2 == 0 {
            corner(halves / 2)
        } else if halves + 1 == 2 * cells {
            even(halves).min(0.5 * corner(cells - 1) + 0.5 * max)
        } else {
            even(halves)
        }
    }

    /// Corners, or centres, of the whole lattice along an axis whose neighbours are where the spacing says: from the first
    /// up to, without, the end. `None` where that holds for all.
    pub(crate) fn regular_points(&self, axis: usize, border: Border) -> Option<(i64, i64)> {
        match (self.whole, border) {
            (Whole::Endless(_), _) | (_, Border::BeyondBox) => None,
            (Whole::Box(cells), Border::OnBox) => Some((2, (i64::from(cells[axis]) - 2).max(0))),
        }
    }
}

/// By kind of point.
fn both_kinds<T, E>(of: impl Fn(PointKind) -> Result<T, E>) -> Result<[T; 2], E> {
    Ok([of(PointKind::Centre)?, of(PointKind::Corner)?])
}

/// What fixes the coordinates along an axis.
#[derive(Debug, Clone, Copy)]
struct Axis {
    /// 0 to 2.
    number: usize,
    min: f32,
    spacing: f32,
    /// The first cell of a window; positions by addition have none.
    origin: i64,
    /// Of layer 0, were this axis z.
    first_layer: f32,
    layer_step: f32,
    layers_a_cell: usize,
}

impl Axis {
    fn start(&self, kind: PointKind) -> f32 {
        match kind {
            PointKind::Centre => self.min - self.spacing / 2.0,
            PointKind::Corner => self.min,
        }
    }
}

fn axes(lattice: &Lattice, layout: &Layout) -> [Axis; 3] {
    let spacing = lattice.spacing();
    let half_layers = layout.kind(0) == PointKind::Centre;
    let min = lattice.bounds().min.to_array();
    [0, 1, 2].map(|number| {
        let (min, origin) = (min[number], i64::from(lattice.origin()[number]));
        if half_layers {
            let half = spacing / 2.0;
            Axis { number, min, spacing, origin, first_layer: min - half, layer_step: half, layers_a_cell: 2 }
        } else {
            Axis { number, min, spacing, origin, first_layer: min, layer_step: spacing, layers_a_cell: 1 }
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::Arrangement;
    use glam::Vec3;
    use isostudy_mesh::Bounds;

    fn evaluation() -> (Lattice, Layout) {
        let bounds = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };
        let lattice = Lattice::try_new(Arrangement::BodyCentred, bounds, 0.04).unwrap();
        let layout = Layout::new(&lattice);
        (lattice, layout)
    }

    #[test]
    fn indexed_corners_end_on_the_box_and_hold_the_origin() {
        let (lattice, layout) = evaluation();
        let coordinates =
            Coordinates::sampled(&lattice, &layout, Positions::Indexed, Border::BeyondBox).unwrap();
        let corners = coordinates.x(PointKind::Corner);
        assert_eq!((corners[0], corners[25], corners[50]), (-1.0, 0.0, 1.0));
        assert_eq!((coordinates.z()[1], coordinates.z()[51], coordinates.z()[101]), (-1.0, 0.0, 1.0));
        assert_eq!(coordinates.y(PointKind::Centre)[0], -1.02);
    }

    #[test]
    fn accumulation_drifts_and_restarts_with_each_chunk() {
        let (lattice, layout) = evaluation();
        let one =
            Coordinates::sampled(&lattice, &layout, Positions::Accumulated { chunks: 1 }, Border::BeyondBox)
                .unwrap();
        let many =
            Coordinates::sampled(&lattice, &layout, Positions::Accumulated { chunks: 16 }, Border::BeyondBox)
                .unwrap();
        let exact = Coordinates::sampled(&lattice, &layout, Positions::Indexed, Border::BeyondBox).unwrap();
        assert_eq!(many.z().len(), 103);
        assert_ne!(one.z(), many.z());
        let drift =
            |c: &Coordinates| c.z().iter().zip(exact.z()).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(drift(&many) < drift(&one) && drift(&one) < 1e-4, "{} {}", drift(&many), drift(&one));
        assert_eq!(one.x(PointKind::Corner), many.x(PointKind::Corner));
        assert_ne!(one.x(PointKind::Corner)[25], 0.0, "the original never hits the origin");
    }

    #[test]
    fn more_chunks_than_layers_leave_all_to_the_last() {
        let (lattice, layout) = evaluation();
        let many = Coordinates::sampled(
            &lattice,
            &layout,
            Positions::Accumulated { chunks: 1000 },
            Border::BeyondBox,
        )
        .unwrap();
        let one =
            Coordinates::sampled(&lattice, &layout, Positions::Accumulated { chunks: 1 }, Border::BeyondBox)
                .unwrap();
        assert_eq!(many.z(), one.z());
    }
}
