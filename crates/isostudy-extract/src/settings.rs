//! What changes the mesh, and what only changes how it is computed.

use std::fmt;

use crate::builders::builders;

/// Settings that change the mesh.
#[non_exhaustive]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExtractSettings {
    /// Points with a value above this are inside.
    pub isovalue: f32,
    /// How vertices are merged.
    pub clustering: Clustering,
    /// Whether merging keeps the surface a manifold.
    pub topology: Topology,
    /// How the positions of sample points are computed.
    pub positions: Positions,
    /// Where a vertex goes.
    pub placement: Placement,
    /// Whether the field is called for the place of each crossing on its lattice edge, up to four times, instead of
    /// interpolating linearly between the samples at its ends. Which edges cross, and which end a crossing belongs to,
    /// is still the samples' affair: the triangles are the same. Needs [`Source::Field`](crate::Source).
    pub refine_crossings: bool,
    /// How far crossings are kept from sample points, as a share of their lattice edges: 0, which keeps none away, to below 0.5. One that is
    /// nearer is moved along its edge, so that unclustered triangles have an area worth the name, and the surface is off by as much. Vertices
    /// that are placed otherwise start from there.
    pub edge_clamp: f32,
}

builders! {
    ExtractSettings {
        with_isovalue: isovalue: f32,
        with_clustering: clustering: Clustering,
        with_topology: topology: Topology,
        with_positions: positions: Positions,
        with_placement: placement: Placement,
        with_refine_crossings: refine_crossings: bool,
        with_edge_clamp: edge_clamp: f32,
    }
}

impl ExtractSettings {
    /// Isovalue 0, integrated clustering, guarded topology, indexed positions, means of interpolated crossings, none of them kept away.
    pub const fn new() -> Self {
        Self {
            isovalue: 0.0,
            clustering: Clustering::Integrated,
            topology: Topology::Guarded,
            positions: Positions::Indexed,
            placement: Placement::MeanOfCrossings,
            refine_crossings: false,
            edge_clamp: 0.0,
        }
    }
}

impl Default for ExtractSettings {
    /// As [`new`](Self::new).
    fn default() -> Self {
        Self::new()
    }
}

/// How vertices are merged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Clustering {
    /// Not at all: one vertex an edge crossing.
    None,
    /// While vertices are placed: crossings that are nearest to the same sample point become one vertex, where the
    /// rules of the [`Topology`] allow (after Treece, Prager & Gee 1999).
    #[default]
    Integrated,
    /// After an unclustered mesh is made: mesh edges not longer than half the spacing are collapsed, by the rules of
    /// the [`Topology`].
    EdgeCollapse,
    /// Integrated clustering, then an edge collapse of what it leaves.
    IntegratedCollapse,
    /// The warp of isosurface stuffing (Labelle & Shewchuk 2007), for the body-centred lattice: a lattice point with a crossing nearer to
    /// it than a share of its edge, 0.24999 or 0.359, is moved to the nearest such crossing, and all crossings on its edges become one
    /// vertex there. No triangle is thin; parts thinner than a cell vanish, and sheets of surface may touch: the mesh is closed, and no
    /// manifold where they do.
    Warp,
}

impl Clustering {
    /// Whether edges are collapsed.
    pub(crate) fn collapses(self) -> bool {
        match self {
            Self::None | Self::Integrated | Self::Warp => false,
            Self::EdgeCollapse | Self::IntegratedCollapse => true,
        }
    }

    /// The same without collapsing edges.
    pub(crate) fn before_collapse(self) -> Self {
        match self {
            Self::None | Self::EdgeCollapse => Self::None,
            Self::Integrated | Self::IntegratedCollapse => Self::Integrated,
            Self::Warp => Self::Warp,
        }
    }
}

impl fmt::Display for Clustering {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::None => "none",
            Self::Integrated => "integrated",
            Self::EdgeCollapse => "edge-collapse",
            Self::IntegratedCollapse => "integrated-collapse",
            Self::Warp => "warp",
        })
    }
}

/// What merging may do to the surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Topology {
    /// Whatever the samples, the mesh is an oriented 2-manifold with the components, genus and boundary loops of the
    /// unclustered surface, and no two triangles share all vertices.
    ///
    /// Every crossing belongs to one end of its lattice edge: to the one with the smaller difference from the
    /// isovalue, and to the inside end when they are equal or a difference is not a number. Edges are collapsed
    /// shortest first, onto the midpoint or an end, whichever makes the better triangles, and only where neither the
    /// topology nor a triangle's side changes, and no triangle loses its area; vertices on the boundary stay where they
    /// are.
    ///
    /// Sample points lie on the box or in it, unless positions are accumulated, and vertices of one sample that equals
    /// the isovalue lie apart: see the crate's front page.
    #[default]
    Guarded,
    /// The published rules, to reproduce published numbers (Costen 2026). Integrated clustering joins surfaces that
    /// pass close to each other; the edge collapse, one pass in order of vertex numbers, folds fins nearly always.
    ///
    /// A crossing in the middle of its edge belongs to both ends and has two vertices, of which one is used. Crossings at
    /// a sample that equals the isovalue lie in its place. Outermost sample points lie where the spacing puts them, up
    /// to a cube beyond the box.
    Published,
}

/// Where a vertex goes. Triangles and vertex numbers are the same for all.
///
/// All but the first move a vertex away from the mean of its crossings. None turns a triangle over: where one of those
/// round a vertex would keep less than a tenth of its area, seen along its normal, the vertex stays. So do vertices on
/// the box. After an edge collapse, vertices start from where that has left them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Placement {
    /// The unweighted mean of the cluster's crossings, as published (Costen 2026).
    #[default]
    MeanOfCrossings,
    /// Their mean weighted by how sharply the surface bends at each, which draws vertices to creases (after Treece,
    /// Prager & Gee 1999, section 3.4): the weight is `tan(d / 2) cos f`, where `d` is the angle between the gradients
    /// interpolated in the two triangles beside the lattice edge in a plane through it, and `f` the angle between that
    /// plane and the mean gradient; of the two or three planes through the edge the one with the largest counts.
    CurvatureWeighted,
    /// One Newton step from the mean along the field's gradient, to the isosurface. A step longer than half the
    /// spacing, or that ends no nearer to the isovalue, is not taken. Needs [`Source::Field`](crate::Source).
    Projected,
    /// Half the way from the mean of crossings to the mean of the neighbouring vertices, across the vertex's normal,
    /// then as projected. A vertex on the mesh's boundary is projected only. Needs [`Source::Field`](crate::Source).
    Relaxed,
}

impl Placement {
    pub(crate) fn calls_the_field(self) -> bool {
        match self {
            Self::MeanOfCrossings | Self::CurvatureWeighted => false,
            Self::Projected | Self::Relaxed => true,
        }
    }
}

/// How the positions of sample points are computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Positions {
    /// From the point's index, with one rounding of the product and one of the sum.
    #[default]
    Indexed,
    /// By running addition, as the original program (Costen 2026) does: only to reproduce its published counts.
    ///
    /// The error grows along each axis; in z it starts anew in each of `chunks` runs of layers, which were the
    /// original's sampling threads: 16 in its benchmark, 8 in its window. Crossings are then measured from
    /// positions computed by a second formula that rounds differently.
    Accumulated {
        /// Runs of layers; at least 1.
        chunks: u32,
    },
}

/// Settings that only change how the mesh is computed, never the mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Execution {
    /// Threads: to sample with, or, with indexed positions, for everything. 0 takes all cores.
    pub threads: usize,
}
