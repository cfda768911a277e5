//! Every configuration's mesh, once a purpose, with its record.

use super::Pipeline;
use crate::made::Made;
use crate::memory::Limit;
use crate::prepare::{Prepared, Wanted};
use crate::records::{mesh_record, of_mesh};
use crate::store::{Inputs, Stamp, sha256};
use crate::terminal::progress::Step;
use crate::trilinear_truth::trilinear_truth;
use crate::{input, recipe, shown_files, source_digests};
use anyhow::{Context, Result};
use isostudy_design::record::{MeshRecord, Purpose};
use isostudy_design::{Configuration, ConfigurationId};
use isostudy_extract::{Execution, Extractor};
use isostudy_mesh::TriangleMesh;

/// How far a mesh moves the bar, which moves while one is extracted: a large volume takes minutes.
pub(super) const TICKS_A_MESH: usize = 1000;

/// The finished mesh stages, in the study's order.
pub(crate) struct Meshes {
    entries: Vec<(ConfigurationId, Purpose, Stamp)>,
}

impl Meshes {
    /// Those of a study that shows films.
    pub(super) fn none() -> Self {
        Self { entries: Vec::new() }
    }

    pub(super) fn of(entries: Vec<(ConfigurationId, Purpose, Stamp)>) -> Self {
        Self { entries }
    }

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
        if recipe::sums_positions(self.study)? {
            purposes.push(Purpose::Indexed);
        }
        self.meshes(&purposes, only)
    }

    /// The meshes that animations show.
    pub(crate) fn stimulus_meshes(&self, only: &[ConfigurationId]) -> Result<Meshes> {
        if self.study.shown_files().is_some() {
            return self.shown_meshes(only);
        }
        self.meshes(&[Purpose::Stimulus], only)
    }

    /// Extracts and measures the configurations in `only`, or all if it is empty.
    pub(super) fn meshes(&self, purposes: &[Purpose], only: &[ConfigurationId]) -> Result<Meshes> {
        self.budgets(purposes, only)?;
        let selected = self.selected(only);
        let count = selected.len() * purposes.len();
        let step = Step::begin("meshes", count, count * TICKS_A_MESH);
        let (mut entries, mut reached) = (Vec::new(), 0);
        // Object by object: what is found of an isosurface serves all of its meshes.
        for object in 0..self.study.file.objects.len() {
            let of_object = || selected.iter().filter(move |configuration| configuration.object == object);
            for (&purpose, configuration) in
                purposes.iter().flat_map(|purpose| of_object().map(move |of| (purpose, of)))
            {
                reached += TICKS_A_MESH;
                // What a program did once it does again.
                if self.has_failed(&configuration.id) {
                    step.count_failed();
                    continue;
                }
                match self.mesh(configuration, purpose, &step) {
                    Ok(stamp) => {
                        step.count(stamp.redone);
                        entries.push((configuration.id.clone(), purpose, stamp));
                    }
                    Err(error) => {
                        self.fail(&configuration.id, error)?;
                        step.count_failed();
                    }
                }
                step.reach(reached);
            }
        }
        entries.retain(|(id, ..)| !self.has_failed(id));
        entries.sort_by_key(|(_, purpose, _)| purposes.iter().position(|of| of == purpose));
        step.end();
        Ok(Meshes { entries })
    }

    /// Those that are asked for and have not failed.
    pub(super) fn selected(&self, only: &[ConfigurationId]) -> Vec<&Configuration> {
        let wanted =
            |c: &&Configuration| (only.is_empty() || only.contains(&c.id)) && !self.has_failed(&c.id);
        self.study.configurations.iter().filter(wanted).collect()
    }

    fn mesh(&self, configuration: &Configuration, purpose: Purpose, step: &Step) -> Result<Stamp> {
        let name = purpose_name(purpose);
        let object = self.study.object(configuration);
        let found = self.spacings().of(&configuration.id, purpose);
        let spacing = found.unwrap_or_else(|| Wanted::For(purpose).spacing(object));
        let inputs = self
            .extraction_inputs(configuration, purpose)?
            .value("spacing", &spacing)
            .value("object's spacing", &Wanted::For(purpose).spacing(object));
        self.stage(&format!("mesh/{name}/{}", configuration.id), inputs, |writer| {
            let prepared = self.prepare(configuration, Wanted::For(purpose))?;
            // On one thread, so that calls of the field are counted.
            let execution = Execution { threads: 1 };
            let made = self.make(configuration, &prepared, &execution, step)?;
            let spacings = [spacing, Wanted::For(purpose).spacing(object)];
            let (mesh, record) = self.measured(configuration, purpose, &prepared, made, spacings)?;
            // The indexed variant is only measured: nothing is rendered from it.
            if purpose != Purpose::Indexed {
                let mut ply = Vec::new();
                isostudy_mesh::write_ply(&mesh, &mut ply)?;
                writer.write(&format!("meshes/{name}/{}.ply", configuration.id), &ply)?;
            }
            writer.write_json(&format!("meshes/{name}/{}.json", configuration.id), &record)
        })
    }

    /// What is measured of a mesh that was made with the first of the spacings. The isosurface's points are those of the second.
    pub(super) fn measured(
        &self,
        configuration: &Configuration,
        purpose: Purpose,
        prepared: &Prepared<'_>,
        made: Made,
        [spacing, own]: [f64; 2],
    ) -> Result<(TriangleMesh, MeshRecord)> {
        let Made { mesh, counts, program } = made;
        let cells = prepared.cells()?;
        let limit = Limit::of_study(self.study, isostudy_bench::read_machine().memory_bytes);
        // What is measured of the mesh alone takes one thread.
        let (accuracy, (alone, trilinear)) = rayon::join(
            || self.accuracy(configuration.object, own, prepared, &mesh),
            || (of_mesh(&mesh), trilinear_truth(prepared, cells, limit)),
        );
        let (accuracy, region) = accuracy?;
        let measures = (&accuracy, region);
        let mut record = mesh_record(&configuration.id, purpose, spacing, cells, counts, alone, measures);
        record.trilinear = trilinear;
        record.program = program;
        Ok((mesh, record))
    }

    /// Everything that an extraction depends on except its spacing.
    pub(super) fn extraction_inputs(
        &self,
        configuration: &Configuration,
        purpose: Purpose,
    ) -> Result<Inputs> {
        if self.study.shown_files().is_some() {
            let inputs = Inputs::of_sources(source_digests::MESHES).value("id", &configuration.id);
            // All of an object are placed as one.
            return self.of_object(configuration).into_iter().try_fold(inputs, |inputs, of| {
                Ok(inputs.text("file", &sha256(&input::bytes(&shown_files::path(self.study, of)?)?)))
            });
        }
        let object = self.study.object(configuration);
        Ok(Inputs::of_sources(source_digests::MESHES)
            .value("id", &configuration.id)
            .value("purpose", &purpose)
            .value("volume", &(object.min, object.max))
            .value("isovalue", &object.isovalue)
            .value("region", &object.region)
            .value("recipe", &self.study.method(configuration.id.method).recipe)
            .value("recipe files", &recipe::inputs(self.study, configuration.id.method)?)
            .text("field", self.fields.inputs(configuration.object)?))
    }

    /// Makes the mesh of one configuration, and moves the bar meanwhile by up to [`TICKS_A_MESH`].
    pub(super) fn make(
        &self,
        configuration: &Configuration,
        prepared: &Prepared<'_>,
        execution: &Execution,
        step: &Step,
    ) -> Result<Made> {
        let mut extractor = Extractor::new().with_progress(step.within(TICKS_A_MESH));
        let place = || {
            let isovalue = self.study.object(configuration).isovalue;
            let file = self.study.path.display();
            format!("{file}: objects[{}] with isovalue {isovalue:?}", configuration.object)
        };
        prepared.make(&mut extractor, execution).with_context(place)
    }

    /// The records of finished meshes.
    pub(super) fn mesh_records(&self, meshes: &Meshes) -> Result<Vec<MeshRecord>> {
        let read = |stamp: &Stamp| {
            let text = self.store.read(stamp, ".json")?;
            serde_json::from_slice(&text).with_context(|| stamp.file(".json").to_owned())
        };
        meshes.stamps().map(read).collect()
    }

    /// A finished mesh.
    pub(super) fn read_mesh(&self, stamp: &Stamp) -> Result<TriangleMesh> {
        let bytes = self.store.read(stamp, ".ply")?;
        isostudy_mesh::read_ply(bytes.as_slice()).with_context(|| stamp.file(".ply").to_owned())
    }
}

pub(super) fn purpose_name(purpose: Purpose) -> &'static str {
    match purpose {
        Purpose::Benchmark => "benchmark",
        Purpose::Stimulus => "stimulus",
        Purpose::Indexed => "indexed",
    }
}
