//! Macet as a method: our reading of it.

use super::{Family, Method, MethodError, Preset, Promises};
use crate::builders::builders;
use crate::cubes::{Diagonals, EdgeMoves, Faces, Rule};
use crate::extractor::Way;

const TURNED: &str = "our reading of Macet, Dietrich et al. 2009; table of Dietrich et al. 2008";

/// By name.
pub(super) const PRESETS: &[Preset] = &[
    Preset {
        id: "macet",
        label: "marching cubes, edges turned",
        method: Method::Macet(Macet {
            faces: Faces::SeparateInside,
            diagonals: Diagonals::EdgeGroups,
            pull: 1.0,
            steps: 4,
            share: 1.0,
        }),
        source: TURNED,
    },
];

/// Marching cubes whose edges are turned square to the surface before they are cut (Macet: Dietrich, Scheidegger, Schreiner, Comba,
/// Nedel & Silva 2009). Triangles are those of the table; vertices go where they make good ones.
///
/// What is published is the idea: cuts are best where edges stand square on the surface, in steps along the gradient and along the
/// tangent plane by turns, and away from the ends of edges. Step, number and displacement are not; here they are settings. A vertex
/// begins near the middle of its edge. It goes along the gradient to the surface, then in the tangent plane towards where it began,
/// and so on; at the end it is the surface's nearest point. No step turns a triangle over.
///
/// With the feature `serde` the keys are those of the fields, all with defaults.
#[non_exhaustive]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct Macet {
    /// What ambiguous faces and cells get.
    pub faces: Faces,
    /// How polygons become triangles.
    pub diagonals: Diagonals,
    /// Where on its edge a vertex begins: at 0 at the crossing, at 1 in the middle.
    pub pull: f32,
    /// How many pairs of steps there are: one along the gradient, one along the tangent plane. At most 64.
    pub steps: u32,
    /// The share of the way in the tangent plane that a step takes: 0 to 1.
    pub share: f32,
}

builders! {
    Macet {
        with_faces: faces: Faces,
        with_diagonals: diagonals: Diagonals,
        with_pull: pull: f32,
        with_steps: steps: u32,
        with_share: share: f32,
    }
}

impl Macet {
    /// The table of edge groups, and eight steps, as in Unified Macet.
    pub const fn new() -> Self {
        Self {
            faces: Faces::SeparateInside,
            diagonals: Diagonals::EdgeGroups,
            pull: 1.0,
            steps: 4,
            share: 1.0,
        }
    }
}

impl Default for Macet {
    /// As [`new`](Self::new).
    fn default() -> Self {
        Self::new()
    }
}

const MOST_STEPS: u32 = 64;

impl Macet {
    fn table(&self) -> Rule {
        Rule { faces: self.faces, diagonals: self.diagonals }
    }
}

impl Family for Macet {
    fn way(&self) -> Option<Way> {
        let moves = EdgeMoves { pull: self.pull, steps: self.steps, share: self.share };
        Some(Way::Moved { rule: self.table(), moves })
    }

    fn promises(&self) -> Promises {
        Promises {
            manifold: true,
            closed_off_the_box: true,
            no_intersections: false,
            same_triangles_for_all_placements: false,
            chunks: false,
            samples_suffice: false,
        }
    }

    fn check_own(&self) -> Result<(), MethodError> {
        let is_share = |value: f32| (0.0..=1.0).contains(&value);
        let Self { pull, steps, share, .. } = *self;
        if is_share(pull) && is_share(share) && steps <= MOST_STEPS {
            return Ok(());
        }
        // They are one setting in three numbers: how vertices go.
        let value = format!("{pull:?}, steps = {steps}, share = {share:?}");
        let allowed = "pull and share must be from 0 to 1, steps at most 64";
        Err(MethodError::Setting { key: "pull", value, allowed })
    }

    fn rule(&self) -> Option<Rule> {
        Some(self.table())
    }

    fn calls_the_field_always(&self) -> bool {
        true
    }
}
