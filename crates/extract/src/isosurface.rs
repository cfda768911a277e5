//! The isosurface that a mesh is measured against.

use glam::{DVec3, Vec3};
use mesh::Bounds;
use mesh::metro::Foot;

use crate::box_grid::BoxGrid;
use crate::extraction::ExtractError;
use crate::extractor::extract;
use crate::lattice::Arrangement;
use crate::level::Level;
use crate::settings::{Clustering, Execution, ExtractSettings};
use field::StudyField;

/// How far a surface is looked for, in spacings.
pub(crate) const REACH: f32 = 3.0;
/// The spacing, in spacings, of the lattice on which the isosurface is looked for: finer, and with other points.
const FINER: f32 = 0.75;

/// Where a field has an isovalue in the box of a lattice, as triangles that lie on it or close to it.
pub(crate) struct Isosurface<'a> {
    /// The field as it is, which may know its isosurface.
    field: &'a dyn StudyField,
    /// The field as it is sampled.
    level: Level<'a>,
    bounds: Bounds,
    pub(crate) triangles: Vec<[Vec3; 3]>,
    is_exact: bool,
}

impl<'a> Isosurface<'a> {
    /// The field's own triangles, or else those of an extraction on a body-centred lattice with three quarters of the
    /// spacing. `level` is the field's.
    pub(crate) fn new(
        field: &'a dyn StudyField,
        level: Level<'a>,
        grid: &BoxGrid,
        execution: &Execution,
    ) -> Result<Self, ExtractError> {
        let (bounds, isovalue) = (grid.bounds, level.isovalue);
        if let Some(triangles) = field.isosurface_triangles(isovalue) {
            return Ok(Self { field, level, bounds, triangles: triangles.to_vec(), is_exact: true });
        }
        // Where there are too many points for the finer lattice, that of the grid has to do.
        let finer = BoxGrid { bounds, spacing: FINER * grid.spacing }.lattice(Arrangement::BodyCentred);
        let finer = finer.or_else(|_| grid.lattice(Arrangement::SimpleCubic))?;
        let clustering = Clustering::Integrated;
        let settings = ExtractSettings { isovalue, clustering, ..ExtractSettings::default() };
        let found = extract(field, &finer, &settings, execution)?.mesh;
        let triangles = (0..found.triangles.len()).map(|t| found.corners(t)).collect();
        Ok(Self { field, level, bounds, triangles, is_exact: false })
    }

    /// The nearest point of the isosurface, if the field knows it, or where the gradient leads within [`REACH`].
    pub(crate) fn foot(&self, p: DVec3) -> Option<Foot> {
        foot(self.field, &self.level, p)
    }

    /// The point of the isosurface that a point of the triangles stands for; `None` if it is outside the box.
    pub(crate) fn point(&self, p: DVec3) -> Option<DVec3> {
        let on_surface = if self.is_exact { p } else { self.foot(p)?.position };
        let (min, max) = (self.bounds.min.as_dvec3(), self.bounds.max.as_dvec3());
        // Up to rounding.
        let slack = 1e-6 * (max - min);
        let is_inside = on_surface.cmpge(min - slack).all() && on_surface.cmple(max + slack).all();
        is_inside.then_some(on_surface)
    }
}

/// The nearest point of the isosurface of `field`, if it knows that, or where the gradient leads within [`REACH`].
/// `level` is the field's.
pub(crate) fn foot(field: &dyn StudyField, level: &Level, p: DVec3) -> Option<Foot> {
    field.nearest_on_isosurface(p, level.isovalue).or_else(|| {
        let foot = level.foot(p.as_vec3(), REACH * level.spacing)?;
        Some(Foot { position: foot.position.as_dvec3(), distance: foot.distance })
    })
}
