//! Why nothing was grown.

use glam::DVec3;
use thiserror::Error;

/// What is wrong, and where. Places are points of the field's coordinates.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum FrontError {
    /// The box is none.
    #[error("the box from {min:?} to {max:?} has no volume in finite numbers")]
    Box {
        /// Its smallest corner.
        min: [f32; 3],
        /// Its largest corner.
        max: [f32; 3],
    },
    /// The isovalue is no finite number.
    #[error("the isovalue {isovalue} is no finite number")]
    Isovalue {
        /// What was given.
        isovalue: f32,
    },
    /// A setting is out of its range.
    #[error("{name} = {value}: must be {allowed}")]
    Setting {
        /// Which.
        name: &'static str,
        /// What was given.
        value: f64,
        /// What is allowed.
        allowed: String,
    },
    /// A seed lies outside of the box.
    #[error("the seed at {} lies outside of the box", at(.place))]
    SeedOutside {
        /// Where.
        place: DVec3,
    },
    /// From a seed no surface is reached, or no triangle fits round it.
    #[error("from the seed at {} no surface can be begun: {reason}", at(.place))]
    Seed {
        /// Where.
        place: DVec3,
        /// Why not.
        reason: &'static str,
    },
    /// The surface has no direction.
    #[error("the field has no gradient at {}, so the surface has no direction there", at(.place))]
    NoGradient {
        /// Where.
        place: DVec3,
    },
    /// The field is no number next to the surface.
    #[error("the field is no finite number at {}, next to the surface", at(.place))]
    NoNumber {
        /// Where.
        place: DVec3,
    },
    /// The front could not be closed.
    #[error(
        "the front could not be closed at {}, where {edges} of its edges are left, with edges down to {edge}: \
         sheets or creases may lie closer together than that",
        at(.place)
    )]
    Unclosed {
        /// The middle of the first edge that is left.
        place: DVec3,
        /// How many are left in all.
        edges: usize,
        /// The shortest length that was tried there.
        edge: f64,
    },
    /// A triangle lies off the surface, as one does that cuts off a narrow neck.
    #[error("a triangle at {} lies off the surface, which may be narrower there than the edges", at(.place))]
    Astray {
        /// Its middle.
        place: DVec3,
    },
    /// Sheets of triangles meet in one vertex.
    #[error("sheets of triangles meet in one vertex at {}", at(.place))]
    Pinched {
        /// Where.
        place: DVec3,
    },
    /// More triangles than allowed.
    #[error("more than {limit} triangles; the last was to grow at {}", at(.place))]
    TooMany {
        /// The limit.
        limit: usize,
        /// The middle of an edge of the front.
        place: DVec3,
    },
}

fn at(place: &DVec3) -> String {
    format!("({}, {}, {})", place.x as f32, place.y as f32, place.z as f32)
}
