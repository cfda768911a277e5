//! The choices that marching cubes leaves open.

/// What becomes of a face whose corners are inside and outside by turns, and of a cell whose surface may have a tunnel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Faces {
    /// Inside corners are apart (Lorensen & Cline 1987 with faces that agree, as in VTK): 820 triangles in 256 patterns.
    #[default]
    SeparateInside,
    /// Inside corners are joined.
    JoinInside,
    /// As the bilinear interpolant of the face has it: the asymptotic decider (Nielson & Hamann 1991).
    Decider,
    /// As the trilinear interpolant of the cell has it, on its faces and inside: every loop and every tunnel is there, none more
    /// (Chernyaev 1995 gave the cases; here they are decided by the saddles of the interpolant).
    Trilinear,
}

impl Faces {
    /// Whether a cell's triangles depend on samples without a crossing of their own.
    pub(crate) fn reads_all_corners(self) -> bool {
        match self {
            Self::SeparateInside | Self::JoinInside | Self::Decider => false,
            Self::Trilinear => true,
        }
    }
}

/// What becomes of a piece of surface in the face between two cells that have nothing else at that face. Snapping makes such pieces
/// where the surface has two sides less than a cell apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Flat {
    /// Each of the cells has it, facing into itself, as published: two triangles in one place, which stand for both sides.
    #[default]
    Both,
    /// Neither has it; nor has a cell at the box, beyond which nothing is inside.
    Neither,
}

/// How polygons become triangles. No diagonal ever lies in a face of the cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Diagonals {
    /// All from one corner, the first from which that can be.
    #[default]
    Fan,
    /// With as few triangles as can be of the one kind that is often bad (Dietrich et al. 2008), of such the best on average:
    /// from a table, so as fast as fans.
    EdgeGroups,
    /// So that the sum of the triangles' radius ratios is largest, cell by cell.
    Quality,
}
