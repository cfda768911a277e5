//! Animations and still pictures of the meshes, and the key to their names.

use super::films::pair_stage;
use super::meshes::TICKS_A_MESH;
use super::{Meshes, Pipeline};
use crate::picture::{self, Drawn};
use crate::prepare::Wanted;
use crate::store::{Inputs, Stamp};
use crate::terminal::progress::Step;
use crate::{error_colours, source_digests, video};
use anyhow::{Context, Result, bail};
use isostudy_design::config::{Look, StillSection};
use isostudy_design::forms::Stimulus;
use isostudy_design::record::Purpose;
use isostudy_design::{Comparison, Configuration, ConfigurationId, Study};
use isostudy_extract::Execution;
use isostudy_raster::Animation;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;

const TURNTABLES: &str = "stimuli/turntables";
const PAIRS: &str = "stimuli/pairs";

/// What a turntable was made with: beside the key, since it is of a configuration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct MadeWith {
    /// Distance, vertical field of view and elevation of the camera.
    pub(crate) camera: [f64; 3],
    /// Digest of everything in the study file that the animation depends on.
    settings: String,
}

impl MadeWith {
    /// What the study asks for.
    pub(crate) fn of(study: &Study, configuration: &Configuration) -> Self {
        let (object, file) = (study.object(configuration), &study.file);
        let camera = [object.camera.distance, object.camera.vertical_fov_rad, file.turntable.elevation_rad];
        let mut settings = Inputs::default()
            .value("object", object)
            .value("recipe", &study.method(configuration.id.method).recipe)
            .value("turntable", &file.turntable)
            .value("shading", &file.shading)
            .value("look", &study.look(configuration))
            .finish();
        settings.truncate(16);
        Self { camera, settings }
    }

    /// Where it is written down.
    pub(crate) fn file(id: &ConfigurationId) -> String {
        format!("key/cameras/{id}.json")
    }
}

impl Pipeline<'_> {
    /// Renders the configurations in `only`, or all if it is empty, and writes the key to their code names. The last
    /// stamp is the key's.
    pub(crate) fn turntables(&self, meshes: &Meshes, only: &[ConfigurationId]) -> Result<Vec<Stamp>> {
        let (codes, _) = self.study.code_names();
        let selected = self.selected(only);
        let frames = self.study.file.turntable.frames as usize;
        let step = Step::begin("turntables", selected.len(), selected.len() * frames);
        let mut stamps = Vec::new();
        for configuration in selected {
            let place = self.study.configurations.iter().position(|c| c == configuration);
            let code = &codes[place.expect("selected from the study's own")];
            let stamp = self.turntable(configuration, code, meshes, &step)?;
            step.count(stamp.redone);
            stamps.push(stamp);
        }
        step.end();
        stamps.push(self.key()?);
        Ok(stamps)
    }

    pub(super) fn turntable(
        &self,
        configuration: &Configuration,
        code: &str,
        meshes: &Meshes,
        step: &Step,
    ) -> Result<Stamp> {
        let object = self.study.object(configuration);
        let mesh = meshes.stamp(&configuration.id, Purpose::Stimulus);
        let inputs = Inputs::of_sources(source_digests::PICTURES)
            .stamp(mesh)
            .text("code", code)
            .value("settings", &MadeWith::of(self.study, configuration))
            .value("looks", &self.study.looks());
        let stamp = self.stage(&format!("turntable/{}", configuration.id), inputs, |writer| {
            let settings = picture::turntable(&self.study.file.turntable, &object.camera);
            let shading = picture::shading(&self.study.file.shading);
            let mesh = self.read_mesh(mesh)?;
            let (look, looks) = (self.study.look(configuration), self.study.looks());
            let on_frame = || step.tick(1);
            let animation = picture::stimulus(&mesh, &settings, &shading, look, &looks, &on_frame)?;
            let mut gif = Vec::new();
            animation.write_gif(&mut gif)?;
            writer.write(&format!("{TURNTABLES}/{code}.gif"), &gif)?;
            writer.write_json(&MadeWith::file(&configuration.id), &MadeWith::of(self.study, configuration))
        })?;
        Ok(stamp)
    }

    /// Composes every pair that anybody is shown from two finished turntables.
    pub(crate) fn pairs(&self, turntables: &[Stamp]) -> Result<Vec<Stamp>> {
        let shown = |of: &Stimulus| of.shown.iter().all(|id| !self.has_failed(id));
        let stimuli: Vec<Stimulus> = self.study.stimuli().into_iter().filter(shown).collect();
        let by_id: HashMap<&ConfigurationId, &Stamp> =
            self.selected(&[]).into_iter().map(|c| &c.id).zip(turntables).collect();
        let step = Step::begin("pairs", stimuli.len(), stimuli.len());
        let one = |stimulus: &Stimulus| {
            let turntables: Vec<&Stamp> = stimulus.shown.iter().map(|id| by_id[id]).collect();
            let stamp = self.pair(stimulus, &turntables)?;
            step.tick(1);
            step.count(stamp.redone);
            Ok(stamp)
        };
        let stamps: Vec<Stamp> = stimuli.par_iter().map(one).collect::<Result<_>>()?;
        step.end();
        Ok(stamps)
    }

    pub(super) fn pair(&self, stimulus: &Stimulus, turntables: &[&Stamp]) -> Result<Stamp> {
        let code = &stimulus.code;
        let scale = self.study.file.stimuli.pair_scale;
        let inputs = Inputs::of_sources(source_digests::PICTURES);
        let inputs = turntables.iter().fold(inputs, |inputs, turntable| inputs.stamp(turntable));
        let inputs = inputs.text("code", code).value("scale", &scale);
        self.stage(&pair_stage(stimulus), inputs, |writer| {
            let turned = turntables.iter().map(|turntable| self.read_animation(turntable));
            let turned = turned.collect::<Result<Vec<Animation>>>()?;
            let row = Animation::in_a_row(&turned)?.context("something is shown")?;
            let mut gif = Vec::new();
            row.scaled(scale).write_gif(&mut gif)?;
            writer.write(&format!("{PAIRS}/{code}.gif"), &gif)
        })
    }

    /// Every pair as a video beside it.
    pub(crate) fn videos(&self, pairs: &[Stamp]) -> Result<Vec<Stamp>> {
        if self.study.shows_films() {
            bail!(
                "{}: the study shows films; `isostudy bundle` makes videos of them",
                self.study.path.display()
            );
        }
        let step = Step::begin("videos", pairs.len(), pairs.len());
        let one = |pair: &Stamp| {
            let (name, path, inputs) = Self::video(pair);
            let stamp = self.stage(&name, inputs, |writer| {
                let scale = self.study.file.stimuli.pair_scale;
                writer.write(&path, &video::mp4(&self.read_animation(pair)?, scale)?)
            })?;
            step.tick(1);
            step.count(stamp.redone);
            Ok(stamp)
        };
        let stamps = pairs.par_iter().map(one).collect::<Result<_>>()?;
        step.end();
        Ok(stamps)
    }

    /// The videos that are there and show what the pairs do; nothing is made. Others go: their names may be those of other
    /// pairs by now.
    pub(crate) fn finished_videos(&self, pairs: &[Stamp]) -> Result<Vec<Stamp>> {
        // Those of films are made with the bundle.
        let pairs = if self.study.shows_films() { &[] } else { pairs };
        let found = |pair: &Stamp| {
            let (name, _, inputs) = Self::video(pair);
            self.store.peek(&name, inputs)
        };
        let finished = pairs.iter().filter_map(found).collect();
        self.store.retire_untouched(|stage| !stage.starts_with("video/"))?;
        Ok(finished)
    }

    /// Name, path and inputs of a pair's video.
    fn video(pair: &Stamp) -> (String, String, Inputs) {
        let name = format!("video/{}", pair.stage.trim_start_matches("pair/"));
        (
            name,
            pair.file(".gif").replace(".gif", ".mp4"),
            Inputs::of_sources(source_digests::PICTURES).stamp(pair),
        )
    }

    pub(super) fn read_animation(&self, stamp: &Stamp) -> Result<Animation> {
        let bytes = self.store.read(stamp, ".gif")?;
        Animation::read_gif(bytes.as_slice()).with_context(|| stamp.file(".gif").to_owned())
    }

    /// The key is kept apart from the stimuli. Sizes and times of the stimuli still tell; those of the bundle do not.
    pub(super) fn key(&self) -> Result<Stamp> {
        let (turntables, _) = self.study.code_names();
        let mut key = String::from("file,question,left,right\n");
        let ending = self.pair_ending();
        let has_turntables = !self.study.shows_films();
        for (configuration, code) in
            self.study.configurations.iter().zip(&turntables).filter(|_| has_turntables)
        {
            key += &format!("{TURNTABLES}/{code}.gif,,{},\n", configuration.id);
        }
        for stimulus in self.study.stimuli() {
            let code = &stimulus.code;
            let Some([left, right]) = stimulus.pair() else {
                // In the place of the left one all that is shown, in order.
                let names: Vec<String> = stimulus.shown.iter().map(ToString::to_string).collect();
                key += &format!("{PAIRS}/{code}.{ending},,{},\n", names.join(" "));
                continue;
            };
            let shows = |c: &&Comparison| {
                (&c.left, &c.right) == (left, right) || (&c.left, &c.right) == (right, left)
            };
            let question = self.study.comparisons.iter().find(shows).map_or("", |c| c.question.as_str());
            key += &format!("{PAIRS}/{code}.{ending},{question},{left},{right}\n");
        }
        let inputs = Inputs::of_sources(source_digests::KEYS).text("key", &key);
        self.store.stage("key", inputs, |writer| writer.write("key/stimuli.csv", key.as_bytes()))
    }

    /// The figures of still pictures.
    pub(crate) fn stills(&self) -> Result<Vec<Stamp>> {
        let made = |still: &&StillSection| !self.has_failed(&still.configuration);
        let stills: Vec<&StillSection> = self.study.file.stills.iter().filter(made).collect();
        let step = Step::begin("stills", stills.len(), stills.len() * TICKS_A_MESH);
        let mut stamps = Vec::new();
        for still in stills {
            let stamp = self.still(still, &step)?;
            step.count(stamp.redone);
            stamps.push(stamp);
            step.reach(stamps.len() * TICKS_A_MESH);
        }
        step.end();
        Ok(stamps)
    }

    pub(super) fn still(&self, still: &StillSection, step: &Step) -> Result<Stamp> {
        let named = self.study.configurations.iter().find(|c| c.id == still.configuration);
        let configuration = named.expect("checked when the study was read");
        let object = self.study.object(configuration);
        let inputs = self
            .extraction_inputs(configuration, Purpose::Stimulus)?
            .text("sources", &source_digests::PICTURES.concat())
            .value("still", still)
            .value("camera", &object.camera)
            .value("turntable", &self.study.file.turntable)
            .value("shading", &self.study.file.shading);
        self.stage(&format!("still/{}", still.id), inputs, |writer| {
            let wanted = Wanted::Spacing(still.spacing, Purpose::Stimulus);
            let prepared = self.prepare(configuration, wanted)?;
            let execution = Execution { threads: self.threads };
            let mesh = self.make(configuration, &prepared, &execution, step)?.mesh;
            let settings = picture::turntable(&self.study.file.turntable, &object.camera);
            let shading = picture::shading(&self.study.file.shading);
            let error = || {
                let most = self.study.file.shading.error_scale as f32;
                let surface = (prepared.field, prepared.isovalue, still.spacing as f32);
                error_colours::of(&mesh, surface, most, self.threads)
            };
            let drawn = |&look: &Look| Ok((look, Drawn::new(&mesh, look, error)?));
            let looks = still.looks.iter().map(drawn).collect::<Result<Vec<_>>>()?;
            let sheet = picture::still_sheet(&mesh, &settings, &shading, &looks)?;
            writer.write(&format!("figures/{}.png", still.id), &sheet.png)?;
            writer.write(&format!("figures/{}.svg", still.id), sheet.svg.as_bytes())?;
            // A look that is listed twice is one file.
            let turning = looks
                .iter()
                .enumerate()
                .filter(|(i, (look, _))| still.turntable && !still.looks[..*i].contains(look));
            for (_, (look, drawn)) in turning {
                let mut gif = Vec::new();
                drawn.turned(&mesh, &settings, &shading)?.write_gif(&mut gif)?;
                writer.write(&format!("figures/{}_{}.gif", still.id, look.name()), &gif)?;
            }
            Ok(())
        })
    }
}
