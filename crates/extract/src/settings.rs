//! What changes the mesh, and what only changes how it is computed.

/// Settings that change the mesh.
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
}

impl Default for ExtractSettings {
    /// Isovalue 0, integrated clustering, guarded topology, indexed positions.
    fn default() -> Self {
        Self {
            isovalue: 0.0,
            clustering: Clustering::Integrated,
            topology: Topology::Guarded,
            positions: Positions::Indexed,
        }
    }
}

/// How vertices are merged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
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
}

/// What merging may do to the surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Topology {
    /// Whatever the samples, the mesh is an oriented 2-manifold with the components, genus and boundary loops of the
    /// unclustered surface, and no two triangles share all vertices.
    ///
    /// Every crossing belongs to one end of its lattice edge: to the one with the smaller difference from the
    /// isovalue, and to the inside end when they are equal or a difference is not a number. Edges are collapsed
    /// shortest first, onto the midpoint or an end, whichever makes the better triangles, and only where neither the
    /// topology nor a triangle's side changes; vertices on the boundary stay where they are.
    #[default]
    Guarded,
    /// The published rules, to reproduce published numbers (Costen 2026). Integrated clustering joins surfaces that
    /// pass close to each other; the edge collapse, one pass in order of vertex numbers, folds fins nearly always.
    ///
    /// A crossing in the middle of its edge belongs to both ends and has two vertices, of which one is used.
    Published,
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
