//! Every configuration's mesh, once a purpose, with its record.

use super::Pipeline;
use crate::progress::Step;
use crate::records::mesh_record;
use crate::store::{Inputs, Stamp};
use crate::{rooms, subject};
use anyhow::{Context, Result, bail};
use design::config::Positions;
use design::record::{MeshRecord, Purpose};
use design::{Configuration, ConfigurationId};
use extract::{Execution, Extraction, Extractor, Lattice};
use mesh::TriangleMesh;

/// How far a mesh moves the bar, which moves while one is extracted: a large volume takes minutes.
pub(super) const TICKS_A_MESH: usize = 1000;

/// The finished mesh stages, in the study's order.
pub(crate) struct Meshes {
    entries: Vec<(ConfigurationId, Purpose, Stamp)>,
}

impl Meshes {
    pub(crate) fn stamps(&self) -> impl Iterator<Item = &Stamp> {
        self.entries.iter().map(|(_, _, stamp)| stamp)
    }

    pub(super) fn stamp(&self, id: &ConfigurationId, purpose: Purpose) -> &Stamp {
        let same = |(i, p, _): &&(ConfigurationId, Purpose, Stamp)| i == id && *p == purpose;
        let (_, _, stamp) = self.entries.iter().find(same).expect("every selected mesh has been made");
        stamp
    }
}

impl Pipeline<'_> {
    /// The meshes of every purpose: what is measured, and what is shown.
    pub(crate) fn all_meshes(&self, only: &[ConfigurationId]) -> Result<Meshes> {
        let mut purposes = vec![Purpose::Benchmark, Purpose::Stimulus];
        if self.study.file.extraction.positions == Positions::Accumulated {
            purposes.push(Purpose::Indexed);
        }
        self.meshes(&purposes, only)
    }

    /// The meshes that animations show.
    pub(crate) fn stimulus_meshes(&self, only: &[ConfigurationId]) -> Result<Meshes> {
        self.meshes(&[Purpose::Stimulus], only)
    }

    /// Extracts and measures the configurations in `only`, or all if it is empty.
    fn meshes(&self, purposes: &[Purpose], only: &[ConfigurationId]) -> Result<Meshes> {
        let selected = self.selected(only);
        let count = selected.len() * purposes.len();
        let step = Step::begin("meshes", count, count * TICKS_A_MESH);
        let mut entries = Vec::new();
        for &purpose in purposes {
            for configuration in &selected {
                let stamp = self.mesh(configuration, purpose, &step)?;
                step.count(stamp.redone);
                entries.push((configuration.id.clone(), purpose, stamp));
                step.reach(entries.len() * TICKS_A_MESH);
            }
        }
        step.end();
        Ok(Meshes { entries })
    }

    pub(super) fn selected(&self, only: &[ConfigurationId]) -> Vec<&Configuration> {
        let wanted = |c: &&Configuration| only.is_empty() || only.contains(&c.id);
        self.study.configurations.iter().filter(wanted).collect()
    }

    fn mesh(&self, configuration: &Configuration, purpose: Purpose, step: &Step) -> Result<Stamp> {
        let object = self.study.object(configuration);
        let (spacing, _) = subject::spacing(object, purpose);
        let name = purpose_name(purpose);
        let inputs = self.extraction_inputs(configuration, purpose)?.value("spacing", &spacing);
        self.stage(&format!("mesh/{name}/{}", configuration.id), inputs, |writer| {
            let lattice = subject::lattice(object, configuration.id.method.arrangement, spacing)?;
            let extraction = self.extract(configuration, purpose, spacing, step)?;
            let accuracy = self.accuracy(configuration, &lattice, &extraction.mesh)?;
            let record = mesh_record(&configuration.id, purpose, spacing, &lattice, &extraction, &accuracy);
            // The indexed variant is only measured: nothing is rendered from it.
            if purpose != Purpose::Indexed {
                let mut ply = Vec::new();
                mesh::write_ply(&extraction.mesh, &mut ply)?;
                writer.write(&format!("meshes/{name}/{}.ply", configuration.id), &ply)?;
            }
            writer.write_json(&format!("meshes/{name}/{}.json", configuration.id), &record)
        })
    }

    /// Everything that an extraction depends on except its spacing.
    pub(super) fn extraction_inputs(
        &self,
        configuration: &Configuration,
        purpose: Purpose,
    ) -> Result<Inputs> {
        let object = self.study.object(configuration);
        Ok(Inputs::of_rooms(rooms::MESHES)
            .value("id", &configuration.id)
            .value("purpose", &purpose)
            .value("volume", &(object.min, object.max))
            .value("isovalue", &object.isovalue)
            .value("extraction", &self.study.file.extraction)
            .text("field", &subject::field_inputs(self.study, object)?))
    }

    /// Extracts one configuration at a spacing, and moves the bar meanwhile by up to [`TICKS_A_MESH`].
    pub(super) fn extract(
        &self,
        configuration: &Configuration,
        purpose: Purpose,
        spacing: f64,
        step: &Step,
    ) -> Result<Extraction> {
        let object = self.study.object(configuration);
        let lattice = subject::lattice(object, configuration.id.method.arrangement, spacing)?;
        let settings = subject::settings(self.study, configuration, purpose);
        let execution = Execution { threads: self.threads };
        let field = self.fields.get(configuration.object)?;
        let mut extractor = Extractor::new().with_progress(step.within(TICKS_A_MESH));
        let extraction = extractor.extract(field.into(), &lattice, &settings, &execution)?;
        if extraction.mesh.triangles.is_empty() {
            let why = match extraction.counts.crossings {
                0 => "every sample lies on one side",
                _ => "clustering left no triangle",
            };
            bail!(
                "{}: objects[{}]: no surface at isovalue {:?} with spacing {spacing:?}: {why}",
                self.study.path.display(),
                configuration.object,
                object.isovalue,
            );
        }
        Ok(extraction)
    }

    /// How well a configuration's mesh stands for its isosurface.
    fn accuracy(
        &self,
        configuration: &Configuration,
        lattice: &Lattice,
        mesh: &TriangleMesh,
    ) -> Result<extract::Accuracy> {
        let isovalue = self.study.object(configuration).isovalue as f32;
        let field = self.fields.get(configuration.object)?;
        let execution = Execution { threads: self.threads };
        Ok(extract::accuracy(mesh, field, isovalue, lattice, &execution)?)
    }

    /// The records of finished meshes.
    pub(super) fn mesh_records(&self, meshes: &Meshes) -> Result<Vec<MeshRecord>> {
        let read = |stamp: &Stamp| {
            let file = stamp.file(".json");
            let text = std::fs::read(self.store.root().join(file))?;
            serde_json::from_slice(&text).with_context(|| file.to_owned())
        };
        meshes.stamps().map(read).collect()
    }

    /// A finished mesh.
    pub(super) fn read_mesh(&self, stamp: &Stamp) -> Result<TriangleMesh> {
        let file = stamp.file(".ply");
        let bytes = std::fs::read(self.store.root().join(file))?;
        mesh::read_ply(bytes.as_slice()).with_context(|| file.to_owned())
    }
}

fn purpose_name(purpose: Purpose) -> &'static str {
    match purpose {
        Purpose::Benchmark => "benchmark",
        Purpose::Stimulus => "stimulus",
        Purpose::Indexed => "indexed",
    }
}
