//! Where on their lattice edges the crossings of a sample point lie, and where a vertex made of them does.
//!
//! Both uniform extractors take these steps in this order, so that their meshes agree to the byte.

use glam::Vec3;

use crate::lattice::{DIRECTIONS, Lattice};
use crate::settings::Topology;

/// How far from its sample point a crossing is at least, in steps of `f32` at the box's farthest coordinate: enough that
/// rounding cannot put three of them in a line.
const LEAST_STEPS: f32 = 16.0;
/// The same as a share of the lattice edge is never more than this, however coarse `f32` is there.
const MOST_SHARE: f32 = 0.125;

/// What other vertices a crossing's sample point has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Company {
    /// None, but the crossing's own.
    Alone,
    /// One for each of its crossings.
    Singles,
    /// Some of several crossings.
    Merged,
}

impl Company {
    #[inline]
    pub(crate) fn of(vertices: usize, crossings: u32) -> Self {
        match vertices {
            0 | 1 => Self::Alone,
            _ if vertices == crossings as usize => Self::Singles,
            _ => Self::Merged,
        }
    }
}

/// How a crossing in the very place of a sample is displaced along its edge, so that vertices of one sample stay apart.
///
/// A sample that equals the isovalue is outside, and the crossings at it all lie in its place. Symbolically it lies below
/// the isovalue by less than any number. A vertex that has the place to itself stays in it; where there are several, each
/// crossing goes a little along its edge, towards the inside. How far is known from the lattice and the direction
/// alone, so that chunks, slabs and all ways of extraction agree.
///
/// Crossings that are vertices each go by the same share of their edges. Three of a tetrahedron then make its face in
/// small. On all four arrangements the normal of such a face lies between its edges, so that in a linear field it is not
/// turned over, cubes that the box cuts thin aside. With merged ones among them directions differ, so that the mean of some cannot meet the line of others.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Apart {
    least: f32,
    /// The same for all, as the settings want it.
    clamp: f32,
    /// Of a lattice without a box.
    spacing: Option<f32>,
}

impl Apart {
    /// The published topology has no such rule.
    pub(crate) fn new(lattice: &Lattice, topology: Topology) -> Self {
        let clamp = f32::NEG_INFINITY;
        let spacing = lattice.spacing();
        match topology {
            Topology::Guarded if lattice.is_endless() => {
                Self { least: MOST_SHARE, clamp, spacing: Some(spacing) }
            }
            Topology::Guarded => {
                let bounds = lattice.bounds();
                let farthest = bounds.min.abs().max(bounds.max.abs()).max_element();
                Self { least: share(farthest, spacing), clamp, spacing: None }
            }
            Topology::Published => Self { least: f32::NEG_INFINITY, clamp, spacing: None },
        }
    }

    /// The same with no crossing nearer than a share of its edge, if that is above 0.
    pub(crate) fn clamped(self, share: f32) -> Self {
        if share > 0.0 { Self { clamp: share, ..self } } else { self }
    }

    /// For a sample point: where there is no box with a farthest coordinate, it is the point's own that counts.
    #[inline]
    pub(crate) fn at(self, point: Vec3) -> Self {
        match self.spacing {
            Some(spacing) => {
                let least = share(point.abs().max_element() + spacing, spacing);
                Self { least, spacing: None, ..self }
            }
            None => self,
        }
    }

    /// The same for any sample point, where there is a box.
    #[inline(always)]
    pub(crate) fn everywhere(self) -> Option<Self> {
        self.spacing.is_none().then_some(self)
    }

    /// The share of the edge in `direction` at which a crossing lies that linear interpolation puts at `ratio`.
    #[inline(always)]
    pub(crate) fn ratio(self, company: Company, direction: usize, ratio: f32) -> f32 {
        let ratio = match company {
            Company::Alone => ratio,
            Company::Singles => ratio.max(self.least),
            Company::Merged => ratio.max(self.least * SPREAD[direction % DIRECTIONS]),
        };
        ratio.max(self.clamp).min(1.0 - self.clamp)
    }
}

fn share(farthest: f32, spacing: f32) -> f32 {
    (LEAST_STEPS * f32::EPSILON * (farthest / spacing)).min(MOST_SHARE)
}

/// From 1 to 2, and generic: the parts of the golden ratio's multiples beyond whole numbers.
static SPREAD: [f32; DIRECTIONS] = {
    let mut spread = [0.0; DIRECTIONS];
    let mut d = 0;
    while d < DIRECTIONS {
        let multiple = 0.618_034 * (d + 1) as f32;
        spread[d] = 1.0 + (multiple - multiple as u32 as f32);
        d += 1;
    }
    spread
};

/// The share of its edge at which linear interpolation puts a crossing. `difference` is the isovalue less the value here.
#[inline(always)]
pub(crate) fn linear_ratio(difference: f32, here: f32, there: f32) -> f32 {
    let ratio = difference / (there - here);
    // Samples that are not numbers, or two infinities, say nothing about the place.
    if ratio.is_finite() { ratio } else { 0.5 }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::lattice::Arrangement;
    use crate::lattice::tetrahedra::spokes;
    use glam::{DMat3, DVec3};
    use isostudy_mesh::Bounds;

    /// Whether the normal of the face of three edges' far ends is a sum of the edges, none of them taken away.
    pub(crate) fn normal_lies_between(edges: [DVec3; 3]) -> bool {
        let [a, b, c] = edges;
        let normal = DMat3::from_cols(a, b, c).transpose().inverse() * DVec3::ONE;
        (DMat3::from_cols(a, b, c).inverse() * normal).cmpge(DVec3::splat(-1e-12)).all()
    }

    #[test]
    fn a_small_face_at_a_sample_faces_where_the_tetrahedron_does() {
        for arrangement in [Arrangement::BodyCentred, Arrangement::SimpleCubic] {
            let offsets = &arrangement.directions().offsets;
            for tetrahedron in spokes(arrangement).iter().flat_map(|spoke| &spoke.ring) {
                let others =
                    tetrahedron.corners.map(|d| DVec3::from_array(offsets[usize::from(d)].map(f64::from)));
                let corners = [DVec3::ZERO, others[0], others[1], others[2]];
                for from in 0..4 {
                    let edges = [1, 2, 3].map(|k| corners[(from + k) % 4] - corners[from]);
                    assert!(normal_lies_between(edges), "{arrangement} {corners:?}");
                }
            }
        }
    }

    #[test]
    fn a_displacement_is_small_and_can_be_told_from_none() {
        for (min, max, spacing) in
            [(-1.0, 1.0, 0.04), (-1.0, 1.0, 0.004), (999.0, 1001.0, 0.1), (0.0, 3.0, 1.0)]
        {
            let bounds = Bounds { min: glam::Vec3::splat(min), max: glam::Vec3::splat(max) };
            let lattice = Lattice::try_new(Arrangement::BodyCentred, bounds, spacing).unwrap();
            let apart = Apart::new(&lattice, Topology::Guarded);
            for company in [Company::Singles, Company::Merged] {
                for direction in 0..DIRECTIONS {
                    let way = apart.ratio(company, direction, 0.0) * spacing;
                    let steps = way / (max * f32::EPSILON);
                    assert!((15.0..=33.0).contains(&steps), "{steps}");
                    assert_eq!(apart.ratio(company, direction, 0.4), 0.4);
                }
            }
            assert_eq!(apart.ratio(Company::Alone, 0, 0.0), 0.0);
            let published = Apart::new(&lattice, Topology::Published);
            assert_eq!(published.ratio(Company::Singles, 0, 0.0), 0.0);
        }
    }
}
