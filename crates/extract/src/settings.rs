//! What changes the mesh, and what only changes how it is computed.

/// Settings that change the mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExtractSettings {
    /// Points with a value above this are inside.
    pub isovalue: f32,
    /// How vertices are merged.
    pub clustering: Clustering,
    /// How the positions of sample points are computed.
    pub positions: Positions,
}

impl Default for ExtractSettings {
    /// Isovalue 0, integrated clustering, indexed positions.
    fn default() -> Self {
        Self { isovalue: 0.0, clustering: Clustering::Integrated, positions: Positions::Indexed }
    }
}

/// How vertices are merged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Clustering {
    /// Not at all: one vertex an edge crossing.
    None,
    /// While vertices are placed: the crossings nearest to one sample point become one vertex, where its published
    /// rules allow (Treece, Prager & Gee 1999; Costen 2026).
    #[default]
    Integrated,
    /// After an unclustered mesh is made: every mesh edge not longer than half the spacing is collapsed to its
    /// midpoint, in one pass (Costen 2026).
    EdgeCollapse,
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
    /// Threads to sample with; 0 takes all cores.
    pub threads: usize,
}
