//! Meshes by parts: the whole, and the object's region if it has one.

use isostudy_design::record::{Judged, MeshRecord, Purpose};
use isostudy_inference::inputs::Inputs;
use isostudy_inference::mesh_set::MeshSet;

/// What the column of parts says.
pub(super) const PART: &str =
    "Part: the whole mesh, or the triangles and points in the object's region, which decide.";

/// The measures of a mesh, or of its part in the region.
pub(super) struct Part<'a> {
    pub(super) purpose: Purpose,
    pub(super) mesh: &'a MeshRecord,
    pub(super) judged: Judged<'a>,
}

impl Part<'_> {
    /// In its column.
    pub(super) fn name(&self) -> &str {
        self.judged.region.unwrap_or("whole")
    }

    /// The share of the area; `None` of the whole.
    pub(super) fn area_share(&self) -> Option<f64> {
        self.judged.region.and(self.mesh.region.as_ref()).map(|of| of.area_share)
    }
}

/// The meshes of each purpose in the study's order, the whole before its region.
pub(super) fn parts<'a>(inputs: &Inputs<'a>, purposes: &[Purpose]) -> Vec<Part<'a>> {
    let of_mesh = |purpose, mesh: &'a MeshRecord| {
        let region = mesh.region.is_some().then(|| mesh.judged());
        std::iter::once(mesh.whole()).chain(region).map(move |judged| Part { purpose, mesh, judged })
    };
    let of = |&purpose: &Purpose| {
        let meshes: Vec<&MeshRecord> =
            MeshSet::of(inputs, purpose).in_order().map(|(_, mesh)| mesh).collect();
        meshes.into_iter().flat_map(move |mesh| of_mesh(purpose, mesh))
    };
    purposes.iter().flat_map(of).collect()
}
