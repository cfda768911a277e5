//! One picture of each method on one object: what the pages show first.

use super::Pipeline;
use super::pages::PictureData;
use crate::source_digests;
use crate::store::{Inputs, Stamp};
use anyhow::{Context, Result};
use isostudy_design::config::FieldSection;
use isostudy_design::{Configuration, Study};
use isostudy_raster::{pixmap_from_png, pixmap_to_png};

/// Pictures of more methods would be too small to tell apart.
const MOST: usize = 12;

/// The object that is shown: the first that is no sphere, on which methods look too much alike.
pub(super) fn object(study: &Study) -> usize {
    let round = |field: &FieldSection| matches!(field, FieldSection::Sphere { .. });
    study.file.objects.iter().position(|object| !round(&object.field)).unwrap_or(0)
}

/// Where a method's picture is.
pub(super) fn path(configuration: &Configuration) -> String {
    format!("figures/method_{}.png", configuration.id.method)
}

impl Pipeline<'_> {
    /// The configurations on the pages' picture; none of a study with too many methods. A method whose cells alone differ from those
    /// of an earlier one is not among them.
    pub(super) fn pictured(&self) -> Vec<&Configuration> {
        let object = object(self.study);
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
    pub(super) fn pictures(&self, turntables: &[Stamp]) -> Result<Vec<Stamp>> {
        let pictured = self.pictured();
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
    pub(super) fn read_pictures(&self) -> Result<Vec<PictureData>> {
        let read = |configuration: &Configuration| {
            let path = path(configuration);
            let png = std::fs::read(self.store.root().join(&path)).with_context(|| path.clone())?;
            let pixmap = pixmap_from_png(&png).with_context(|| path.clone())?;
            Ok(PictureData {
                object: self.study.object(configuration).name.clone(),
                label: self.study.method(configuration.id.method).label.clone(),
                size: [pixmap.width(), pixmap.height()],
                png,
            })
        };
        self.pictured().into_iter().map(read).collect()
    }
}
