//! One picture of each method on one object: what the pages show first.

use super::pages::PictureData;
use super::{Meshes, Pipeline};
use crate::source_digests;
use crate::store::{Inputs, Stamp};
use anyhow::{Context, Result};
use isostudy_design::config::FieldSection;
use isostudy_design::{Configuration, ConfigurationId, Study};
use isostudy_raster::{pixmap_from_png, pixmap_to_png};
use isostudy_report::telling;

/// Pictures of more methods would be too small to tell apart.
const MOST: usize = 12;

/// What pages show first: an object, and two of its meshes.
pub(super) struct ShownFirst {
    /// Its place among the study's.
    pub(super) object: usize,
    /// What the viewer opens on; `None` where no two meshes differ.
    pub(super) pair: Option<[ConfigurationId; 2]>,
}

impl ShownFirst {
    /// Whether methods differ most on this object, so that it was not taken for want of another.
    pub(super) fn is_telling(&self) -> bool {
        self.pair.is_some()
    }

    /// Where no two meshes differ: the first object that is no sphere, on which methods look too much alike.
    fn without_difference(study: &Study) -> Self {
        let round = |field: &FieldSection| matches!(field, FieldSection::Sphere { .. });
        let object = study.file.objects.iter().position(|object| !round(&object.field)).unwrap_or(0);
        Self { object, pair: None }
    }
}

/// Where a method's picture is.
pub(super) fn path(configuration: &Configuration) -> String {
    format!("figures/method_{}.png", configuration.id.method)
}

impl Pipeline<'_> {
    /// What pages show first: that which is [`telling`].
    pub(super) fn shown_first(&self, meshes: &Meshes) -> Result<ShownFirst> {
        let found = telling(self.study, &self.mesh_records(meshes)?);
        Ok(match found {
            Some(found) => ShownFirst { object: found.object, pair: Some(found.pair) },
            None => ShownFirst::without_difference(self.study),
        })
    }

    /// The configurations on the pages' picture; none of a study with too many methods. A method whose cells alone differ from those
    /// of an earlier one is not among them.
    pub(super) fn pictured(&self, shown: &ShownFirst) -> Vec<&Configuration> {
        let object = shown.object;
        let study = self.study;
        let is_new = |c: &&Configuration| {
            let own = study.method(c.id.method);
            let mut earlier = study.methods.iter().take_while(|other| other.id != own.id);
            own.budget.is_none() || !earlier.any(|other| other.recipe == own.recipe)
        };
        let of_object = self.selected(&[]).into_iter().filter(|c| c.object == object);
        let shown: Vec<&Configuration> = of_object.filter(is_new).collect();
        if shown.len() > MOST { Vec::new() } else { shown }
    }

    /// Takes the first frame of each turntable of one object. `turntables` are in the order of the configurations.
    pub(super) fn pictures(&self, turntables: &[Stamp], shown: &ShownFirst) -> Result<Vec<Stamp>> {
        let pictured = self.pictured(shown);
        let one = |(configuration, turntable): (&Configuration, &Stamp)| {
            let inputs = Inputs::of_sources(source_digests::PICTURES).stamp(turntable);
            self.store.stage(&format!("method_picture/{}", configuration.id), inputs, |writer| {
                let frame = self.read_animation(turntable)?.picture(0);
                writer.write(&path(configuration), &pixmap_to_png(&frame))
            })
        };
        let all = self.selected(&[]).into_iter().zip(turntables);
        all.filter(|(configuration, _)| pictured.contains(configuration)).map(one).collect()
    }

    /// The pictures that were made.
    pub(super) fn read_pictures(&self, shown: &ShownFirst) -> Result<Vec<PictureData>> {
        let read = |configuration: &Configuration| {
            let path = path(configuration);
            let png = std::fs::read(self.store.root().join(&path)).with_context(|| path.clone())?;
            let pixmap = pixmap_from_png(&png).with_context(|| path.clone())?;
            Ok(PictureData {
                object: self.study.object(configuration).name.clone(),
                is_telling: shown.is_telling(),
                id: configuration.id.method.to_string(),
                label: self.study.method(configuration.id.method).label.clone(),
                size: [pixmap.width(), pixmap.height()],
                png,
            })
        };
        self.pictured(shown).into_iter().map(read).collect()
    }
}
