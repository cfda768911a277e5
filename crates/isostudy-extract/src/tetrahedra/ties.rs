//! Whose a crossing is: of which end of its lattice edge.

use std::cmp::Ordering;

use crate::settings::Topology;

/// What becomes of a crossing in the very middle of its edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Ties {
    /// It belongs to both ends, as published.
    BothEnds,
    /// It belongs to the inside end, so that every crossing has one owner.
    InsideEnd,
}

impl Ties {
    pub(crate) fn of(topology: Topology) -> Self {
        match topology {
            Topology::Guarded => Self::InsideEnd,
            Topology::Published => Self::BothEnds,
        }
    }

    /// Whether a crossing belongs to this end: it is nearer to the smaller difference from the isovalue. A
    /// difference that is not a number leaves it to the inside end.
    #[inline(always)]
    pub(crate) fn is_near(self, inside: bool, here: f32, there: f32) -> bool {
        let (here, there) = (here.abs(), there.abs());
        match self {
            Self::BothEnds => here <= there || inside && there.is_nan(),
            Self::InsideEnd if inside => !matches!(there.partial_cmp(&here), Some(Ordering::Less)),
            Self::InsideEnd => here < there,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_crossing_belongs_to_an_end() {
        let values = [0.0, 0.5, 2.0, f32::INFINITY, f32::NAN];
        for outside in values {
            for inside in &values[1..4] {
                let (d_out, d_in) = (outside, -inside);
                let owners = |ties: Ties| [ties.is_near(true, d_in, d_out), ties.is_near(false, d_out, d_in)];
                let both = owners(Ties::BothEnds);
                assert!(both.contains(&true), "{outside} {inside}");
                assert_eq!(both == [true, true], outside == *inside, "a tie has both: {outside} {inside}");
                let one = owners(Ties::InsideEnd);
                assert_ne!(one[0], one[1], "{outside} {inside}");
                assert_eq!(one[0], both[0], "the inside end wins: {outside} {inside}");
            }
        }
    }
}
