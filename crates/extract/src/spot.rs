//! Where on their lattice edges the crossings of a sample point lie, and where a vertex made of them does.
//!
//! Both uniform extractors take these steps in this order, so that their meshes agree to the byte.

use crate::lattice::Lattice;
use crate::settings::Topology;

/// How far from its sample point a crossing is at least, in steps of `f32` at the box's farthest coordinate: enough that
/// rounding cannot put three of them in a line.
const LEAST_STEPS: f32 = 16.0;
/// The same as a share of the lattice edge is never more than this, however coarse `f32` is there.
const MOST_SHARE: f32 = 0.125;

/// How a crossing in the very place of a sample is displaced along its edge, so that vertices of one sample stay apart.
///
/// A sample that equals the isovalue is outside, and the crossings at it all lie in its place. Symbolically it lies below
/// the isovalue by less than any number. A vertex that has the place to itself stays in it; where there are several, each
/// crossing goes a little along its edge, towards the inside. How far is known from the lattice and the direction
/// alone, so that chunks, slabs and all ways of extraction agree. Directions differ, so that means of some cannot meet
/// others.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Apart {
    least: f32,
}

impl Apart {
    /// The published topology has no such rule.
    pub(crate) fn new(lattice: &Lattice, topology: Topology) -> Self {
        let bounds = lattice.bounds();
        let farthest = bounds.min.abs().max(bounds.max.abs()).max_element();
        let least = match topology {
            Topology::Guarded => {
                (LEAST_STEPS * f32::EPSILON * (farthest / lattice.spacing())).min(MOST_SHARE)
            }
            Topology::Published => f32::NEG_INFINITY,
        };
        Self { least }
    }

    /// The share of the edge in `direction` at which a crossing lies that is at `ratio`, among others of its point.
    #[inline(always)]
    pub(crate) fn ratio(self, direction: usize, ratio: f32) -> f32 {
        ratio.max(self.least * spread(direction))
    }
}

/// From 1 to 2, and no two directions' sums agree (multiples of the golden ratio).
#[inline(always)]
fn spread(direction: usize) -> f32 {
    const fn spreads() -> [f32; 32] {
        let mut spreads = [0.0; 32];
        let mut d = 0;
        while d < 32 {
            let multiple = 0.618_034 * (d + 1) as f32;
            spreads[d] = 1.0 + (multiple - multiple as u32 as f32);
            d += 1;
        }
        spreads
    }
    static SPREADS: [f32; 32] = spreads();
    SPREADS[direction % 32]
}

/// The share of its edge at which linear interpolation puts a crossing. `difference` is the isovalue less the value here.
#[inline(always)]
pub(crate) fn linear_ratio(difference: f32, here: f32, there: f32) -> f32 {
    let ratio = difference / (there - here);
    // Samples that are not numbers, or two infinities, say nothing about the place.
    if ratio.is_finite() { ratio } else { 0.5 }
}
