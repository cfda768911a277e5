//! Positions of sample points, one axis at a time.

use std::collections::TryReserveError;

use super::{Lattice, Layout, PointKind};
use crate::memory::{collected, with_room};
use crate::settings::Positions;

/// Coordinates of every sample point. An axis does not depend on the others but for the kind of the layer.
#[derive(Debug, Clone)]
pub(crate) struct Coordinates {
    /// Along a row, by kind of point.
    x: [Vec<f32>; 2],
    /// Down a layer, by kind of point.
    y: [Vec<f32>; 2],
    /// Of each layer.
    z: Vec<f32>,
}

impl Coordinates {
    /// Where the field is sampled.
    pub(crate) fn sampled(
        lattice: &Lattice,
        layout: &Layout,
        positions: Positions,
    ) -> Result<Self, TryReserveError> {
        match positions {
            Positions::Indexed => Self::indexed(lattice, layout),
            Positions::Accumulated { chunks } => Self::accumulated(lattice, layout, chunks as usize),
        }
    }

    /// Where crossings are measured from. The original recomputes positions here, by a formula whose rounding in z
    /// is its own; the two sets differ by a few last bits.
    pub(crate) fn measured(
        lattice: &Lattice,
        layout: &Layout,
        positions: Positions,
    ) -> Result<Self, TryReserveError> {
        match positions {
            Positions::Indexed => Self::indexed(lattice, layout),
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

    /// `min + n * spacing`, `n` whole for corners and half for centres: one rounding of the product, one of the sum,
    /// and nothing carried along.
    fn indexed(lattice: &Lattice, layout: &Layout) -> Result<Self, TryReserveError> {
        Self::per_axis(lattice, layout, |axis, kind, i| {
            let i = axis.origin + i;
            let cells = match kind {
                PointKind::Centre => i as f32 - 0.5,
                PointKind::Corner => i as f32,
            };
            axis.min + cells * axis.spacing
        })
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
        Ok(Self { x: running(axes[0], nx)?, y: running(axes[1], ny)?, z })
    }

    fn per_axis(
        lattice: &Lattice,
        layout: &Layout,
        at: impl Fn(Axis, PointKind, usize) -> f32,
    ) -> Result<Self, TryReserveError> {
        let [x, y, z] = axes(lattice, layout);
        let [nx, ny, nz] = layout.grid();
        let line = |axis: Axis, n: usize| both_kinds(|kind| collected((0..n).map(|i| at(axis, kind, i))));
        let layer = |i: usize| at(z, layout.kind(i), i / z.layers_a_cell);
        Ok(Self { x: line(x, nx)?, y: line(y, ny)?, z: collected((0..nz).map(layer))? })
    }
}

/// By kind of point.
fn both_kinds<T, E>(of: impl Fn(PointKind) -> Result<T, E>) -> Result<[T; 2], E> {
    Ok([of(PointKind::Centre)?, of(PointKind::Corner)?])
}

/// What fixes the coordinates along an axis.
#[derive(Debug, Clone, Copy)]
struct Axis {
    min: f32,
    spacing: f32,
    /// The first cell of a window; positions by addition have none.
    origin: usize,
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
    [0, 1, 2].map(|axis| {
        let (min, origin) = (min[axis], lattice.origin()[axis] as usize);
        if half_layers {
            let half = spacing / 2.0;
            Axis { min, spacing, origin, first_layer: min - half, layer_step: half, layers_a_cell: 2 }
        } else {
            Axis { min, spacing, origin, first_layer: min, layer_step: spacing, layers_a_cell: 1 }
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::Arrangement;
    use glam::Vec3;
    use mesh::Bounds;

    fn evaluation() -> (Lattice, Layout) {
        let bounds = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };
        let lattice = Lattice::try_new(Arrangement::BodyCentred, bounds, 0.04).unwrap();
        let layout = Layout::new(&lattice);
        (lattice, layout)
    }

    #[test]
    fn indexed_corners_end_on_the_box_and_hold_the_origin() {
        let (lattice, layout) = evaluation();
        let coordinates = Coordinates::sampled(&lattice, &layout, Positions::Indexed).unwrap();
        let corners = coordinates.x(PointKind::Corner);
        assert_eq!((corners[0], corners[25], corners[50]), (-1.0, 0.0, 1.0));
        assert_eq!((coordinates.z()[1], coordinates.z()[51], coordinates.z()[101]), (-1.0, 0.0, 1.0));
        assert_eq!(coordinates.y(PointKind::Centre)[0], -1.02);
    }

    #[test]
    fn accumulation_drifts_and_restarts_with_each_chunk() {
        let (lattice, layout) = evaluation();
        let one = Coordinates::sampled(&lattice, &layout, Positions::Accumulated { chunks: 1 }).unwrap();
        let many = Coordinates::sampled(&lattice, &layout, Positions::Accumulated { chunks: 16 }).unwrap();
        let exact = Coordinates::sampled(&lattice, &layout, Positions::Indexed).unwrap();
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
        let many = Coordinates::sampled(&lattice, &layout, Positions::Accumulated { chunks: 1000 }).unwrap();
        let one = Coordinates::sampled(&lattice, &layout, Positions::Accumulated { chunks: 1 }).unwrap();
        assert_eq!(many.z(), one.z());
    }
}
