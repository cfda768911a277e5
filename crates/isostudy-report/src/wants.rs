//! What somebody may want of a mesh, in words.

use isostudy_inference::decision::Goal;

/// The words for a purpose.
pub(crate) struct Words {
    /// Names its column.
    pub(crate) name: &'static str,
    /// The column's heading.
    pub(crate) heading: &'static str,
    /// Its number with its unit, `{}` for the number.
    pub(crate) unit: &'static str,
    /// After *You want*.
    pub(crate) phrase: &'static str,
    /// What the number is, with `{}` for it.
    pub(crate) says: &'static str,
}

/// What a purpose is called.
pub(crate) fn words(goal: Goal) -> Words {
    let [name, heading, unit, phrase, says] = match goal {
        Goal::Preferred => [
            "preferred",
            "most liked",
            "{}",
            "the look that people chose most",
            "mean score {}, from \u{2212}1 to 1",
        ],
        Goal::Fastest => ["fastest", "shortest time", "{} ms", "the shortest time", "{} ms"],
        Goal::Chunk => ["chunk", "shortest chunk", "{} ms", "the shortest time for a chunk", "{} ms"],
        Goal::Edit => ["edit", "shortest edit", "{} ms", "the shortest time for an edit, in chunks", "{} ms"],
        Goal::Closest => ["closest", "smallest mean error", "{}", "the smallest mean error", "{} cube edges"],
        Goal::ClosestPerTriangle => [
            "closest_per_triangle",
            "the same with as many triangles",
            "{}",
            "the smallest mean error with as many triangles",
            "{} cube edges",
        ],
        Goal::SharpEdges => [
            "edges",
            "sharp edges kept",
            "{}",
            "sharp edges kept: the smallest mean error at them",
            "{} cube edges",
        ],
        Goal::Regular => {
            ["regular", "most regular triangles", "{}", "the most regular triangles", "mean radius ratio {}"]
        }
        Goal::Faultless => {
            ["faultless", "no fault, soonest", "{} ms", "a manifold without intersections, soonest", "{} ms"]
        }
        Goal::Topology => [
            "topology",
            "no fault and the samples' topology, soonest",
            "{} ms",
            "the topology of the interpolated samples and no fault, soonest",
            "{} ms",
        ],
    };
    Words { name, heading, unit, phrase, says }
}
