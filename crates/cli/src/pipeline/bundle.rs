//! What participants get, and what the researcher keeps: the forms, the bundle, the keys, the contact sheet.

use super::{Meshes, Pipeline};
use crate::picture;
use crate::progress::Step;
use crate::rooms;
use crate::store::{Inputs, Stamp};
use anyhow::Result;
use design::ConfigurationId;
use design::forms::{Questionnaire, Stimulus};
use design::record::Purpose;
use raster::tiny_skia::Pixmap;
use std::collections::HashMap;

const BUNDLE: &str = "bundle";

impl Pipeline<'_> {
    /// The participants' forms, and the key to them, kept apart like the key to the stimuli. `None` for a study that asks
    /// nobody.
    pub(crate) fn forms(&self) -> Result<Option<Stamp>> {
        let Some(questionnaire) = Questionnaire::of(self.study) else { return Ok(None) };
        let inputs = Inputs::of_rooms(rooms::KEYS).value("study", &self.study.file);
        let stamp = self.store.stage("forms", inputs, |writer| {
            writer.write_json("forms/forms.json", &questionnaire.file())?;
            let mut key = csv::Writer::from_writer(Vec::new());
            for line in questionnaire.key() {
                key.serialize(line)?;
            }
            writer.write("key/forms.csv", &key.into_inner()?)
        })?;
        Ok(Some(stamp))
    }

    /// The folder for participants: the forms and every pair, and nothing that tells what a pair shows. All animations are
    /// made the same size, with zeros after the end of the file, since a smoother surface compresses better.
    pub(crate) fn bundle(&self, forms: &Stamp, pairs: &[Stamp]) -> Result<Stamp> {
        let step = Step::begin("bundle", 1, pairs.len());
        let mut inputs = Inputs::of_rooms(rooms::KEYS).stamp(forms);
        for stamp in pairs {
            inputs = inputs.stamp(stamp);
        }
        let stamp = self.stage(BUNDLE, inputs, |writer| {
            let root = self.store.root();
            let mut files: Vec<_> = pairs.iter().flat_map(|stamp| &stamp.files).collect();
            // In the order of names, so that times of modification tell nothing either.
            files.sort_by(|a, b| a.path.cmp(&b.path));
            let size = files.iter().map(|file| file.bytes).max().unwrap_or(0) as usize;
            for file in files {
                let mut bytes = std::fs::read(root.join(&file.path))?;
                bytes.resize(size, 0);
                let name = file.path.rsplit('/').next().unwrap_or(&file.path);
                writer.write(&format!("{BUNDLE}/stimuli/{name}"), &bytes)?;
                step.tick(1);
            }
            writer
                .write(&format!("{BUNDLE}/forms.json"), &std::fs::read(root.join(forms.file("forms.json")))?)
        })?;
        step.count(stamp.redone);
        step.end();
        Ok(stamp)
    }

    /// Every pair with its code name and what it shows, on one page: for the researcher.
    pub(crate) fn contact_sheet(&self, meshes: &Meshes) -> Result<Stamp> {
        const HALF_PX: u32 = 128;
        let stimuli = self.study.stimuli();
        let mut inputs = Inputs::of_rooms(rooms::PICTURES).value("study", &self.study.file);
        for configuration in &self.study.configurations {
            inputs = inputs.stamp(meshes.stamp(&configuration.id, Purpose::Stimulus));
        }
        self.stage("contact_sheet", inputs, |writer| {
            let mut halves: HashMap<&ConfigurationId, Pixmap> = HashMap::new();
            for configuration in &self.study.configurations {
                let mesh = self.read_mesh(meshes.stamp(&configuration.id, Purpose::Stimulus))?;
                let camera = &self.study.object(configuration).camera;
                let settings = picture::turntable(&self.study.file.turntable, camera);
                let shading = picture::shading(&self.study.file.shading);
                halves.insert(&configuration.id, picture::thumbnail(&mesh, &settings, &shading, HALF_PX)?);
            }
            let question = |s: &Stimulus| {
                let shows = |c: &&design::Comparison| {
                    (&c.left, &c.right) == (&s.left, &s.right) || (&c.left, &c.right) == (&s.right, &s.left)
                };
                self.study.comparisons.iter().find(shows).map_or("control", |c| c.question.as_str())
            };
            let pairs: Vec<(String, Pixmap)> = stimuli
                .iter()
                .map(|s| {
                    let label = format!("{}\n{}: {} | {}", s.code, question(s), s.left, s.right);
                    (label, picture::side_by_side(&halves[&s.left], &halves[&s.right]))
                })
                .collect();
            writer.write(
                "key/contact_sheet.png",
                &picture::contact_sheet(&pairs, &self.study.file.study.title)?,
            )
        })
    }
}
