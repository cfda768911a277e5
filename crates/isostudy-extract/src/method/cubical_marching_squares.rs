//! Cubical marching squares as a method.

use super::{Family, Method, MethodError, Preset, Promises};
use crate::builders::builders;
use crate::cubes::{Creases, Diagonals, Faces, Rule};
use crate::extractor::Way;

/// By name.
pub(super) const PRESETS: &[Preset] = &[Preset {
    id: "cms",
    label: "cubical marching squares",
    method: Method::CubicalMarchingSquares(CubicalMarchingSquares { crease_deg: DEFAULT }),
    source: "Ho, Wu, Chen, Chuang & Ouhyoung 2005, on a uniform grid; faces by signs",
}];

const DEFAULT: f32 = 20.0;

/// Marching cubes with vertices where the surface has creases: in faces between cubes, where the tangents of two crossings meet, and within
/// cubes, where tangent planes meet (cubical marching squares; Ho, Wu, Chen, Chuang & Ouhyoung 2005). Edges and corners stay sharp, and
/// no triangle leaves its cube.
///
/// Crossings are roots of the field on their edges. Normals are the field's own gradients where it has some, else central differences.
/// Three things are other than published: cubes have one size, faces that can be cut in two ways are decided by signs, and where two
/// sheets of surface cross a cube, or a face, creases are cut off as by marching cubes.
///
/// With the feature `serde` the keys are those of the fields, all with defaults.
#[non_exhaustive]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct CubicalMarchingSquares {
    /// Normals of a face or cube that are farther apart have a crease between them, in degrees: above 0, up to 180.
    pub crease_deg: f32,
}

builders! {
    CubicalMarchingSquares {
        with_crease_deg: crease_deg: f32,
    }
}

impl CubicalMarchingSquares {
    /// As [`Default`].
    pub const fn new() -> Self {
        Self { crease_deg: DEFAULT }
    }
}

impl Default for CubicalMarchingSquares {
    /// As [`new`](Self::new).
    fn default() -> Self {
        Self::new()
    }
}

impl Family for CubicalMarchingSquares {
    fn way(&self) -> Option<Way> {
        let rule = Rule { faces: Faces::SeparateInside, diagonals: Diagonals::Fan };
        Some(Way::Creased { rule, creases: Creases { crease_deg: self.crease_deg } })
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
        let (deg, allowed) = (self.crease_deg, "must be above 0 and at most 180, degrees");
        MethodError::unless(deg > 0.0 && deg <= 180.0, "crease_deg", deg, allowed)
    }

    fn calls_the_field_always(&self) -> bool {
        true
    }
}
