//! How well meshes stand for their isosurfaces: points of an isosurface are found once, and equal meshes are measured once.

use super::Pipeline;
use crate::prepare::Prepared;
use crate::region;
use crate::store::sha256;
use anyhow::Result;
use isostudy_design::record::RegionMeasures;
use isostudy_extract::{Accuracy, BoxGrid, Execution, ExtractError, IsosurfacePoints, accuracy_beside};
use isostudy_mesh::{Bounds, TriangleMesh};
use std::sync::PoisonError;

/// Of the whole mesh, and what it is in the object's region, if it has one.
pub(super) type Measured = (Accuracy, Option<RegionMeasures>);

/// What was found of the object that a mesh was last measured for.
#[derive(Default)]
pub(super) struct Accuracies {
    object: usize,
    /// For each of the object's own spacings: all methods share them, at whatever spacing they met a budget.
    isosurfaces: Vec<(On, IsosurfacePoints)>,
    measured: Vec<(OfMesh, Measured)>,
}

/// An isovalue, a grid and the region that is judged.
type On = (f32, BoxGrid, Option<Bounds>);
/// The digest of a mesh's PLY file, the isovalue, its grid, and the spacing of the isosurface's points.
type OfMesh = (String, f32, BoxGrid, f32);

impl Accuracies {
    /// Those of the object before go.
    fn turn_to(&mut self, object: usize) {
        if self.object != object {
            *self = Self { object, ..Self::default() };
        }
    }

    fn isosurface(
        &mut self,
        on: On,
        find: impl FnOnce() -> Result<IsosurfacePoints, ExtractError>,
    ) -> Result<&IsosurfacePoints, ExtractError> {
        let place = match self.isosurfaces.iter().position(|(known, _)| *known == on) {
            Some(place) => place,
            None => {
                self.isosurfaces.push((on, find()?));
                self.isosurfaces.len() - 1
            }
        };
        Ok(&self.isosurfaces[place].1)
    }
}

impl Pipeline<'_> {
    /// How well an object's mesh stands for its isosurface, and what it is in the object's region. The
    /// isosurface's points are those of the object's `own` spacing.
    pub(super) fn accuracy(
        &self,
        object: usize,
        own: f64,
        prepared: &Prepared<'_>,
        mesh: &TriangleMesh,
    ) -> Result<Measured> {
        let Prepared { field, grid, isovalue, .. } = prepared;
        let execution = Execution { threads: self.threads };
        let points_on = BoxGrid { spacing: own as f32, ..*grid };
        let mut kept = self.accuracies.lock().unwrap_or_else(PoisonError::into_inner);
        kept.turn_to(object);
        let mut ply = Vec::new();
        isostudy_mesh::write_ply(mesh, &mut ply)?;
        let key = (sha256(&ply), *isovalue, *grid, points_on.spacing);
        if let Some((_, measured)) = kept.measured.iter().find(|(known, _)| *known == key) {
            return Ok(measured.clone());
        }
        let mut of = |region: Option<Bounds>| {
            let find = || IsosurfacePoints::of(*field, *isovalue, &points_on, region, &execution);
            let points = kept.isosurface((*isovalue, points_on, region), find)?;
            accuracy_beside(points, mesh, *field, *isovalue, grid.spacing, &execution)
        };
        let whole = of(None)?;
        let region = self.study.file.objects[object].region.as_ref();
        let within = region.map(|at| Ok(region::measures(at, mesh, &of(Some(region::bounds(at)))?)));
        let measured = (whole, within.transpose().map_err(|error: ExtractError| error)?);
        kept.measured.push((key, measured.clone()));
        Ok(measured)
    }
}
