//! A configuration's mesh, however it comes to be.

use crate::families::CannotMake;
use crate::prepare::Prepared;
use crate::recipe::Recipe;
use crate::terminal::tell_once;
use crate::{finishing, mesh_file, records, seeds};
use anyhow::{Context, Result, bail};
use glam::Vec3;
use isostudy_design::record::{Counts, MadeBy};
use isostudy_extract::{Execution, Extractor};
use isostudy_field::{Counted, FieldCache};
use isostudy_finish::Extent;
use isostudy_mesh::TriangleMesh;
use isostudy_program::{End, Problem, Program, ProgramError, Ready, Request, Samples, Worker};
use rayon::prelude::*;
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

/// A mesh, and what was counted on the way.
pub(crate) struct Made {
    pub(crate) mesh: TriangleMesh,
    pub(crate) counts: Counts,
    /// The program that made it.
    pub(crate) program: Option<MadeBy>,
}

impl Prepared<'_> {
    /// The mesh. On one thread it is also counted how often the field was called.
    ///
    /// # Errors
    /// If there is no surface; what an extractor refuses; [`ProgramError`] of a program, which names it; if a file is no mesh.
    pub(crate) fn make(&self, extractor: &mut Extractor, execution: &Execution) -> Result<Made> {
        let made = self.make_any(extractor, execution)?;
        if made.mesh.triangles.is_empty() {
            let spacing = self.grid.spacing;
            if let Some(why) = self.missed() {
                bail!("no surface was reached with spacing {spacing:?}: {why}");
            }
            let why = match made.counts.crossings {
                Some(0) => "every sample lies on one side",
                _ => "no triangle is left",
            };
            bail!("no surface with spacing {spacing:?}: {why}");
        }
        Ok(made)
    }

    /// Why given seeds reached no surface; `None` of what has no seeds.
    pub(crate) fn missed(&self) -> Option<String> {
        match &self.recipe {
            Recipe::Extractor(method) => seeds::missed(method),
            Recipe::Program(_) | Recipe::Meshes(_) | Recipe::Family(_) => None,
        }
    }

    /// The mesh, which may have no triangles if it is an extractor's or a file's. Where a finishing step could not do what was asked,
    /// it is said.
    ///
    /// # Errors
    /// As [`make`](Self::make), but for that; if a finishing step cannot be applied.
    pub(crate) fn make_any(&self, extractor: &mut Extractor, execution: &Execution) -> Result<Made> {
        let mut made = self.make_unfinished(extractor, execution)?;
        if self.finish.is_empty() {
            return Ok(made);
        }
        let finished = finishing::finish(made.mesh, &self.finish, Extent::Whole);
        let finished = finished.with_context(|| self.id.to_string())?;
        finished.stopped.iter().for_each(|stopped| tell_once(&format!("{}: finish: {stopped}", self.id)));
        made.counts = records::with_mesh(made.counts, &finished.mesh);
        made.mesh = finished.mesh;
        Ok(made)
    }

    /// The mesh after its finishing steps, for a clock. Normals are timed where they are made, with the mesh that is extracted, and not
    /// once more.
    ///
    /// # Errors
    /// If a step cannot be applied.
    pub(crate) fn finished(&self, mut mesh: TriangleMesh) -> Result<TriangleMesh> {
        mesh.normals = Vec::new();
        Ok(finishing::finish(mesh, &self.finish, Extent::Whole)?.mesh)
    }

    /// Seconds that the finishing steps take; 0 where there are none.
    ///
    /// # Errors
    /// If one cannot be applied.
    pub(crate) fn finishing_s(&self, mesh: TriangleMesh) -> Result<f64> {
        if self.finish.is_empty() {
            return Ok(0.0);
        }
        let began = Instant::now();
        black_box(self.finished(mesh)?);
        Ok(began.elapsed().as_secs_f64())
    }

    /// The same before its finishing steps.
    fn make_unfinished(&self, extractor: &mut Extractor, execution: &Execution) -> Result<Made> {
        Ok(match &self.recipe {
            Recipe::Extractor(_) => {
                let mut kept = FieldCache::default();
                let field = Counted::new(self.field, &mut kept);
                let prepared = Prepared { field: &field, ..self.clone() };
                let extraction =
                    prepared.extractor().context("an extractor")?.extract_with(extractor, execution)?;
                let counts = records::counts(&extraction.counts);
                // Slabs of several threads sample some layers twice, and no record may depend on threads.
                let is_exact = execution.threads == 1;
                let counts = if is_exact { records::with_calls(counts, &field) } else { counts };
                Made { counts, mesh: extraction.mesh, program: None }
            }
            Recipe::Program(program) => self.by_program(program)?,
            Recipe::Meshes(files) => {
                let path = files.get(&self.id.object).context("checked when the study was read")?;
                let mesh = mesh_file::read(path)?;
                mesh_file::check_lies_in(&mesh, &self.grid).with_context(|| path.display().to_string())?;
                let mesh = with_normals(mesh);
                Made { counts: records::counts_of_mesh(&mesh, None), mesh, program: None }
            }
            Recipe::Family(family) => {
                let mut kept = FieldCache::default();
                let field = Counted::new(self.field, &mut kept);
                let mesh = family.mesh(&self.asked(&field))?;
                mesh_file::check_lies_in(&mesh, &self.grid)?;
                let mut counts = records::counts_of_mesh(&mesh, None);
                if family.asks_the_field() {
                    counts = records::with_calls(counts, &field);
                }
                Made { counts, mesh, program: None }
            }
        })
    }

    fn by_program(&self, program: &Program) -> Result<Made> {
        let cells = self.cells()?;
        let mut worker = Worker::start(program)?;
        let path = worker.folder().join("mesh.ply");
        let samples = self.samples(cells);
        let answer = worker.extract(&self.request(Samples::Values(&samples), cells, Some(&path)))?;
        let Ready { name, version, note } = worker.ready().clone();
        let made_by = MadeBy { name, version, note };
        worker.finish()?;
        let mesh = with_normals(answer.mesh.context("a mesh was asked for")?);
        let counts =
            Counts { evaluations: Some(samples.len() as u64), ..records::counts_of_mesh(&mesh, Some(cells)) };
        Ok(Made { counts, mesh, program: Some(made_by) })
    }

    /// What a program is asked.
    pub(crate) fn request<'r>(
        &self,
        samples: Samples<'r>,
        cells: [u32; 3],
        mesh: Option<&'r Path>,
    ) -> Request<'r> {
        Request {
            samples,
            size: cells.map(|along| along + 1),
            origin: self.grid.bounds.min.to_array().map(f64::from),
            spacing: [f64::from(self.grid.spacing); 3],
            isovalue: f64::from(self.isovalue),
            mesh,
            may_be_empty: false,
        }
    }

    /// The field at the corners of the grid's cells, x fastest. Where the spacing does not divide the box, the last lie beyond it.
    pub(crate) fn samples(&self, cells: [u32; 3]) -> Vec<f32> {
        let (min, spacing) = (self.grid.bounds.min, self.grid.spacing);
        let [along_x, along_y, along_z] = cells.map(|along| along as usize + 1);
        let place = |start: f32, i: usize| start + i as f32 * spacing;
        let x: Vec<f32> = (0..along_x).map(|i| place(min.x, i)).collect();
        let mut samples = vec![0.0; along_x * along_y * along_z];
        samples.par_chunks_exact_mut(along_x).enumerate().for_each(|(row, values)| {
            let (y, z) = (place(min.y, row % along_y), place(min.z, row / along_y));
            self.field.sample_row(&x, y, z, values);
        });
        samples
    }
}

/// Whoever draws a mesh needs normals.
pub(crate) fn with_normals(mut mesh: TriangleMesh) -> TriangleMesh {
    if mesh.normals.len() != mesh.positions.len() {
        mesh.normals = isostudy_mesh::normals::area_weighted_normals(&mesh.positions, &mesh.triangles);
        // A vertex without a triangle, or with such as cancel out, points anywhere.
        mesh.normals.iter_mut().filter(|normal| !normal.is_finite()).for_each(|normal| *normal = Vec3::Z);
    }
    mesh
}

/// Whether it would fail so once more: not where a program was killed, ran out of what the machine has, or was slow.
pub(crate) fn fails_again(error: &anyhow::Error) -> bool {
    let of_program = |error: &ProgramError| {
        !matches!(
            *error.problem,
            Problem::Ended { end: End::Signal(_), .. }
                | Problem::Io { .. }
                | Problem::Start(_)
                | Problem::TimeLimit { .. }
                | Problem::NotEnded { .. }
        )
    };
    error.chain().any(|cause| {
        cause.downcast_ref().is_some_and(of_program) || cause.downcast_ref::<CannotMake>().is_some()
    })
}

/// What a program or a family could not do, if that is why something failed: the other methods then go on.
pub(crate) fn own_failure(error: &anyhow::Error) -> Option<String> {
    error.chain().find_map(|cause| {
        let of_program = cause.downcast_ref::<ProgramError>().map(ToString::to_string);
        of_program.or_else(|| cause.downcast_ref::<CannotMake>().map(ToString::to_string))
    })
}
