//! Every configuration's mesh at each resolution of the viewer, as compact glTF with its errors.

use crate::made::{Made, own_failure};
use crate::pipeline::meshes::TICKS_A_MESH;
use crate::pipeline::{Meshes, Pipeline};
use crate::prepare::{Prepared, Wanted};
use crate::recipe::Recipe;
use crate::records::{mesh_record, of_mesh};
use crate::store::{Stamp, Writer};
use crate::terminal::progress::Step;
use anyhow::{Context, Result};
use isostudy_design::record::{MeshRecord, Purpose};
use isostudy_design::{Configuration, ConfigurationId};
use isostudy_extract::{Execution, Extractor};
use isostudy_mesh::{CompactNumbers, Per, TriangleMesh, corner_normals};
use serde::{Deserialize, Serialize};

/// The multiple of the stimulus spacing at which the meshes of the animations are.
const AS_STIMULI: f64 = 1.0;

/// A configuration at one resolution.
pub(in crate::pipeline) struct Level {
    pub(super) id: ConfigurationId,
    /// Its files: a record, and a mesh if there is one.
    pub(super) stamp: Stamp,
    pub(super) entry: Entry,
}

/// What a level's record says.
#[derive(Serialize, Deserialize)]
pub(in crate::pipeline) struct Entry {
    schema: u32,
    /// Multiple of the spacing of the animations.
    pub(super) factor: f64,
    pub(super) spacing: f64,
    /// What the mesh is; `None` if there is none.
    pub(super) mesh: Option<MeshRecord>,
    /// Why there is none.
    pub(super) missing: Option<String>,
}

impl Level {
    /// The path of its mesh.
    pub(super) fn mesh_file(&self) -> Option<&str> {
        self.entry.mesh.as_ref().map(|_| self.stamp.file(".glb"))
    }

    /// Digest of its mesh: two that look different only in how they are drawn have the same.
    pub(super) fn mesh_digest(&self) -> Option<&str> {
        let path = self.mesh_file()?;
        self.stamp.files.iter().find(|file| file.path == path).map(|file| file.sha256.as_str())
    }
}

impl Pipeline<'_> {
    /// The meshes that the viewer shows, configuration by configuration, from fine to coarse. At a spacing of which a method
    /// makes no mesh, there is a reason in its place.
    pub(in crate::pipeline) fn levels_of(
        &self,
        meshes: &Meshes,
        selected: &[&Configuration],
        factors: &[f64],
    ) -> Result<Vec<Level>> {
        let count = selected.len() * factors.len();
        let step = Step::begin("viewer meshes", count, count * TICKS_A_MESH);
        let mut levels = Vec::new();
        for configuration in selected {
            for &factor in factors {
                let level = self.level(configuration, factor, meshes, &step)?;
                step.count(level.stamp.redone);
                levels.push(level);
                step.reach(levels.len() * TICKS_A_MESH);
            }
        }
        step.end();
        Ok(levels)
    }

    fn level(
        &self,
        configuration: &Configuration,
        factor: f64,
        meshes: &Meshes,
        step: &Step,
    ) -> Result<Level> {
        let (id, object) = (&configuration.id, self.study.object(configuration));
        let found = self.spacings().of(id, Purpose::Stimulus);
        let stimulus = found.unwrap_or_else(|| Wanted::For(Purpose::Stimulus).spacing(object));
        let (spacing, finished) = (stimulus * factor, meshes.stamp(id, Purpose::Stimulus));
        let inputs = self
            .extraction_inputs(configuration, Purpose::Stimulus)?
            .value("spacing", &spacing)
            .value("crease", &self.study.file.shading.crease_deg)
            .stamp(finished);
        let path = format!("viewer/{id}_{factor}");
        let stamp = self.stage(&format!("viewer/{id}/{factor}"), inputs, |writer| {
            let wanted = Wanted::Spacing(spacing, Purpose::Stimulus);
            let prepared = self.prepare(configuration, wanted)?;
            let mut entry = Entry { schema: 1, factor, spacing, mesh: None, missing: None };
            if factor == AS_STIMULI {
                entry.mesh = Some(serde_json::from_slice(&self.store.read(finished, ".json")?)?);
                self.write_level(&prepared, &self.read_mesh(finished)?, &path, writer)?;
            } else {
                match self.at_another_spacing(configuration, &prepared, step)? {
                    Err(why) => entry.missing = Some(why),
                    Ok(Made { mesh, counts, program }) => {
                        let own = Wanted::For(Purpose::Stimulus).spacing(object) * factor;
                        let (accuracy, region) =
                            self.accuracy(configuration.object, own, &prepared, &mesh)?;
                        let cells = prepared.cells()?;
                        let purpose = Purpose::Stimulus;
                        let measures = (&accuracy, region);
                        let record =
                            mesh_record(id, purpose, spacing, cells, counts, of_mesh(&mesh), measures);
                        entry.mesh = Some(MeshRecord { program, ..record });
                        self.write_level(&prepared, &mesh, &path, writer)?;
                    }
                }
            }
            writer.write_json(&format!("{path}.json"), &entry)
        })?;
        let text = self.store.read(&stamp, ".json")?;
        let entry = serde_json::from_slice(&text).with_context(|| stamp.file(".json").to_owned())?;
        Ok(Level { id: id.clone(), stamp, entry })
    }

    /// The mesh, or why there is none: what is no fault of the study at a spacing that only the viewer asks for.
    fn at_another_spacing(
        &self,
        configuration: &Configuration,
        prepared: &Prepared<'_>,
        step: &Step,
    ) -> Result<Result<Made, String>> {
        match &prepared.recipe {
            Recipe::Meshes(_) => return Ok(Err("its meshes are files of one resolution".into())),
            Recipe::Extractor(method) => {
                if let Err(refused) = method.check(&prepared.grid) {
                    return Ok(Err(refused.to_string()));
                }
            }
            Recipe::Family(of) => {
                if let Some(what) = of.has_one_resolution() {
                    return Ok(Err(format!("{what} have one resolution")));
                }
            }
            Recipe::Program(_) => {}
        }
        let mut extractor = Extractor::new().with_progress(step.within(TICKS_A_MESH));
        // On one thread, so that calls of the field are counted: no record may depend on threads.
        match prepared.make_any(&mut extractor, &Execution { threads: 1 }) {
            Ok(made) if made.mesh.triangles.is_empty() => Ok(Err(match prepared.missed() {
                Some(why) => format!("no surface was reached: {why}"),
                None => "there is no surface".into(),
            })),
            Ok(made) => Ok(Ok(made)),
            Err(error) => match own_failure(&error) {
                Some(failed) => Ok(Err(failed)),
                None => Err(error.context(configuration.id.to_string())),
            },
        }
    }

    fn write_level(
        &self,
        prepared: &Prepared<'_>,
        mesh: &TriangleMesh,
        path: &str,
        writer: &mut Writer<'_>,
    ) -> Result<()> {
        let Prepared { field, isovalue, grid, .. } = prepared;
        let execution = Execution { threads: self.threads };
        let distances =
            isostudy_extract::triangle_distances(mesh, *field, *isovalue, grid.spacing, &execution)?;
        let mut angles =
            isostudy_extract::normal_errors_deg(mesh, *field, *isovalue, grid.spacing, &execution)?;
        angles.resize(mesh.positions.len(), None);
        let corners = corner_normals(mesh, self.study.file.shading.crease_deg as f32);
        let mut bytes = Vec::new();
        let numbers = [
            CompactNumbers { name: "distance", per: Per::Triangle, values: &distances },
            CompactNumbers { name: "normal_error_deg", per: Per::Vertex, values: &angles },
        ];
        isostudy_mesh::write_compact_glb(&corners.with_copies(mesh), &corners.copies, &numbers, &mut bytes)?;
        writer.write(&format!("{path}.glb"), &bytes)
    }
}
