//! Animations and still pictures of the meshes, and the key to their names.

use super::meshes::TICKS_A_MESH;
use super::{Meshes, Pipeline};
use crate::picture;
use crate::progress::Step;
use crate::store::{Inputs, Stamp};
use crate::{rooms, video};
use anyhow::{Context, Result};
use design::config::{CameraSection, StillSection, TurntableSection};
use design::forms::Stimulus;
use design::record::Purpose;
use design::{Comparison, Configuration, ConfigurationId};
use raster::{Animation, Look};
use rayon::prelude::*;
use std::collections::HashMap;

const TURNTABLES: &str = "stimuli/turntables";
const PAIRS: &str = "stimuli/pairs";

/// Distance, vertical field of view and elevation of a turntable's camera.
fn camera(camera: &CameraSection, turntable: &TurntableSection) -> [f64; 3] {
    [camera.distance, camera.vertical_fov_rad, turntable.elevation_rad]
}

/// Where it is written which camera a turntable was made with: with the key, since it is of a configuration.
pub(crate) fn camera_file(id: &ConfigurationId) -> String {
    format!("key/cameras/{id}.json")
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

    fn turntable(
        &self,
        configuration: &Configuration,
        code: &str,
        meshes: &Meshes,
        step: &Step,
    ) -> Result<Stamp> {
        let object = self.study.object(configuration);
        let mesh = meshes.stamp(&configuration.id, Purpose::Stimulus);
        let inputs = Inputs::of_rooms(rooms::PICTURES)
            .stamp(mesh)
            .text("code", code)
            .value("camera", &object.camera)
            .value("turntable", &self.study.file.turntable)
            .value("shading", &self.study.file.shading);
        let stamp = self.stage(&format!("turntable/{}", configuration.id), inputs, |writer| {
            let settings = picture::turntable(&self.study.file.turntable, &object.camera);
            let shading = picture::shading(&self.study.file.shading);
            let mesh = self.read_mesh(mesh)?;
            let animation = raster::turntable(&mesh, &settings, &shading, Look::Smooth, &|| step.tick(1))?;
            let mut gif = Vec::new();
            animation.write_gif(&mut gif)?;
            writer.write(&format!("{TURNTABLES}/{code}.gif"), &gif)?;
            let seen = camera(&object.camera, &self.study.file.turntable);
            writer.write_json(&camera_file(&configuration.id), &seen)
        })?;
        Ok(stamp)
    }

    /// Composes every pair that anybody is shown from two finished turntables.
    pub(crate) fn pairs(&self, turntables: &[Stamp]) -> Result<Vec<Stamp>> {
        let stimuli = self.study.stimuli();
        let by_id: HashMap<&ConfigurationId, &Stamp> =
            self.study.configurations.iter().map(|c| &c.id).zip(turntables).collect();
        let step = Step::begin("pairs", stimuli.len(), stimuli.len());
        let one = |stimulus: &Stimulus| {
            let stamp = self.pair(stimulus, by_id[&stimulus.left], by_id[&stimulus.right])?;
            step.tick(1);
            step.count(stamp.redone);
            Ok(stamp)
        };
        let stamps: Vec<Stamp> = stimuli.par_iter().map(one).collect::<Result<_>>()?;
        step.end();
        Ok(stamps)
    }

    fn pair(&self, stimulus: &Stimulus, left: &Stamp, right: &Stamp) -> Result<Stamp> {
        let Stimulus { code, left: left_id, right: right_id } = stimulus;
        let scale = self.study.file.stimuli.pair_scale;
        let inputs = Inputs::of_rooms(rooms::PICTURES)
            .stamp(left)
            .stamp(right)
            .text("code", code)
            .value("scale", &scale);
        self.stage(&format!("pair/{left_id}~{right_id}"), inputs, |writer| {
            let (left, right) = (self.read_animation(left)?, self.read_animation(right)?);
            let mut gif = Vec::new();
            left.side_by_side(&right)?.scaled(scale).write_gif(&mut gif)?;
            writer.write(&format!("{PAIRS}/{code}.gif"), &gif)
        })
    }

    /// Every pair as a video beside it, one after the other: ffmpeg takes all cores by itself.
    pub(crate) fn videos(&self, pairs: &[Stamp]) -> Result<Vec<Stamp>> {
        let step = Step::begin("videos", pairs.len(), pairs.len());
        let mut stamps = Vec::new();
        for pair in pairs {
            let name = format!("video/{}", pair.stage.trim_start_matches("pair/"));
            let path = pair.file(".gif").replace(".gif", ".mp4");
            let inputs = Inputs::of_rooms(rooms::PICTURES).stamp(pair);
            let stamp = self.stage(&name, inputs, |writer| {
                let scale = self.study.file.stimuli.pair_scale;
                writer.write(&path, &video::mp4(&self.read_animation(pair)?, scale)?)
            })?;
            step.tick(1);
            step.count(stamp.redone);
            stamps.push(stamp);
        }
        step.end();
        Ok(stamps)
    }

    fn read_animation(&self, stamp: &Stamp) -> Result<Animation> {
        let file = stamp.file(".gif");
        let bytes = std::fs::read(self.store.root().join(file))?;
        Animation::read_gif(bytes.as_slice()).with_context(|| file.to_owned())
    }

    /// The key is kept apart from the stimuli. Sizes and times of the stimuli still tell; those of the bundle do not.
    fn key(&self) -> Result<Stamp> {
        let (turntables, _) = self.study.code_names();
        let mut key = String::from("file,question,left,right\n");
        for (configuration, code) in self.study.configurations.iter().zip(&turntables) {
            key += &format!("{TURNTABLES}/{code}.gif,,{},\n", configuration.id);
        }
        for Stimulus { code, left, right } in self.study.stimuli() {
            let shows = |c: &&Comparison| {
                (&c.left, &c.right) == (&left, &right) || (&c.left, &c.right) == (&right, &left)
            };
            let question = self.study.comparisons.iter().find(shows).map_or("", |c| c.question.as_str());
            key += &format!("{PAIRS}/{code}.gif,{question},{left},{right}\n");
        }
        let inputs = Inputs::of_rooms(rooms::KEYS).text("key", &key);
        self.store.stage("key", inputs, |writer| writer.write("key/stimuli.csv", key.as_bytes()))
    }

    /// The figures of still pictures.
    pub(crate) fn stills(&self) -> Result<Vec<Stamp>> {
        let stills = &self.study.file.stills;
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

    fn still(&self, still: &StillSection, step: &Step) -> Result<Stamp> {
        let named = self.study.configurations.iter().find(|c| c.id == still.configuration);
        let configuration = named.expect("checked when the study was read");
        let object = self.study.object(configuration);
        let inputs = self
            .extraction_inputs(configuration, Purpose::Stimulus)?
            .text("room", &rooms::PICTURES.concat())
            .value("still", still)
            .value("camera", &object.camera)
            .value("turntable", &self.study.file.turntable)
            .value("shading", &self.study.file.shading);
        self.stage(&format!("still/{}", still.id), inputs, |writer| {
            let mesh = self.extract(configuration, Purpose::Stimulus, still.spacing, step)?.mesh;
            let settings = picture::turntable(&self.study.file.turntable, &object.camera);
            let shading = picture::shading(&self.study.file.shading);
            let sheet = picture::still_sheet(&mesh, &settings, &shading, &still.looks)?;
            writer.write(&format!("figures/{}.png", still.id), &sheet.png)?;
            writer.write(&format!("figures/{}.svg", still.id), sheet.svg.as_bytes())
        })
    }
}
