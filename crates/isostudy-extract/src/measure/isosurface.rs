//! The isosurface that a mesh is measured against.

use glam::{DVec3, Vec3};
use isostudy_mesh::Bounds;
use isostudy_mesh::metro::{AreaSamples, Foot};

use crate::execution::threads::mapped;
use crate::extraction::ExtractError;
use crate::extractor::extract;
use crate::lattice::Arrangement;
use crate::lattice::BoxGrid;
use crate::measure::crossings::{Crossings, crossings};
use crate::measure::sharp_edges;
use crate::sampling::level::Level;
use crate::settings::{Clustering, Execution, ExtractSettings};
use isostudy_field::StudyField;

/// How far a surface is looked for, in spacings.
pub(crate) const REACH: f32 = 3.0;
/// Most places where a sharp edge is looked for; of more, every second, third and so on.
const MOST_SUSPECTS: usize = 32_768;
/// The spacing, in spacings, of the lattice on which the isosurface is looked for: finer, and with other points.
const FINER: f32 = 0.75;

/// Where a field has an isovalue in the box of a lattice, as triangles that lie on it or close to it.
pub(crate) struct Isosurface<'a> {
    /// The field as it is, which may know its isosurface.
    field: &'a dyn StudyField,
    /// The field as it is sampled.
    level: Level<'a>,
    /// Where points are wanted.
    bounds: Bounds,
    pub(crate) triangles: Vec<[Vec3; 3]>,
    /// Where sharp edges are looked for, if the triangles are not the isosurface itself.
    suspects: Vec<[Vec3; 2]>,
    is_exact: bool,
}

impl<'a> Isosurface<'a> {
    /// The field's own triangles, or else those of an extraction on a body-centred lattice with three quarters of the
    /// spacing. `level` is the field's; points are wanted `within` a part of the grid's box.
    pub(crate) fn new(
        field: &'a dyn StudyField,
        level: Level<'a>,
        grid: &BoxGrid,
        within: &Bounds,
        execution: &Execution,
    ) -> Result<Self, ExtractError> {
        let (bounds, isovalue) = (*within, level.isovalue);
        if let Some(triangles) = field.isosurface_triangles(isovalue) {
            let (triangles, suspects) = (triangles.to_vec(), Vec::new());
            return Ok(Self { field, level, bounds, triangles, suspects, is_exact: true });
        }
        // Where there are too many points for the finer lattice, that of the grid has to do.
        let finer =
            BoxGrid { bounds: grid.bounds, spacing: FINER * grid.spacing }.lattice(Arrangement::BodyCentred);
        let finer = finer.or_else(|_| grid.lattice(Arrangement::SimpleCubic))?;
        let clustering = Clustering::Integrated;
        let settings = ExtractSettings { isovalue, clustering, ..ExtractSettings::default() };
        let found = extract(field, &finer, &settings, execution)?.mesh;
        let triangles = (0..found.triangles.len()).map(|t| found.corners(t)).collect();
        let suspects = sharp_edges::suspects(&found);
        Ok(Self { field, level, bounds, triangles, suspects, is_exact: false })
    }

    /// The nearest point of the isosurface, if the field knows it, or where the gradient leads within [`REACH`].
    pub(crate) fn foot(&self, p: DVec3) -> Option<Foot> {
        foot(self.field, &self.level, p)
    }

    /// Points of the isosurface within the box, each for the same share of its area: of triangles that are the isosurface, else
    /// where lines cross it. `wanted` gets the area.
    ///
    /// Not where an extraction is: it rounds edges, and a third of what a mesh leaves out is near them.
    pub(crate) fn points(&self, wanted: impl Fn(f64) -> f64, seed: u64) -> Crossings {
        if !self.is_exact {
            return crossings(&self.level, &self.bounds, wanted);
        }
        let area = AreaSamples::new(&self.triangles, 1, seed).area();
        let samples = AreaSamples::new(&self.triangles, wanted(area).ceil() as u64, seed);
        let points: Vec<DVec3> = samples.points(0..samples.count()).filter(|p| self.has_in_box(p)).collect();
        Crossings { points, area_each: area / samples.count().max(1) as f64 }
    }

    /// Whether the triangles are the isosurface itself.
    pub(crate) fn is_exact(&self) -> bool {
        self.is_exact
    }

    /// `p`, if it is in the box.
    pub(crate) fn in_box(&self, p: DVec3) -> Option<DVec3> {
        self.has_in_box(&p).then_some(p)
    }

    /// The point of the isosurface that a point of the triangles stands for; `None` if it is outside the box.
    pub(crate) fn point(&self, p: DVec3) -> Option<DVec3> {
        let on_surface = if self.is_exact { p } else { self.foot(p)?.position };
        self.in_box(on_surface)
    }

    /// Points of the sharp edges within the box: of triangles that are the isosurface, half a spacing of their length apart; else
    /// one where an edge of the extraction passes from one side of the sharp edge to the other, of at most [`MOST_SUSPECTS`].
    pub(crate) fn sharp_edges(&self) -> Vec<DVec3> {
        let (level, reach) = (&self.level, REACH * self.level.spacing);
        let mut points = if self.is_exact {
            sharp_edges::of_triangles(&self.triangles, &self.bounds, 0.5 * f64::from(level.spacing))
        } else {
            // What begins outside may still end within.
            let near = |[a, b]: &&[Vec3; 2]| {
                let slack = level.spacing;
                a.max(*b).cmpge(self.bounds.min - slack).all()
                    && a.min(*b).cmple(self.bounds.max + slack).all()
            };
            let suspects: Vec<[Vec3; 2]> = self.suspects.iter().filter(near).copied().collect();
            let every = suspects.len().div_ceil(MOST_SUSPECTS).max(1);
            let suspects: Vec<[Vec3; 2]> = suspects.into_iter().step_by(every).collect();
            let found = mapped(&suspects, |&ends| sharp_edges::between(level, ends, reach));
            found.into_iter().flatten().collect()
        };
        points.retain(|p| self.has_in_box(p));
        points
    }

    /// Up to rounding.
    fn has_in_box(&self, p: &DVec3) -> bool {
        let (min, max) = (self.bounds.min.as_dvec3(), self.bounds.max.as_dvec3());
        let slack = 1e-6 * (max - min);
        p.cmpge(min - slack).all() && p.cmple(max + slack).all()
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
