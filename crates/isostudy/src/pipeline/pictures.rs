//! One picture of each method on one object: what the pages show first.

use super::measurements::Times;
use super::pages::{PictureData, caption};
use super::{Meshes, Pipeline};
use crate::source_digests;
use crate::store::{Inputs, Stamp};
use anyhow::{Context, Result};
use isostudy_design::config::FieldSection;
use isostudy_design::{Configuration, ConfigurationId, MethodId, Study};
use isostudy_inference::Results;
use isostudy_raster::{pixmap_from_png, pixmap_to_png};
use isostudy_report::{named_by_choices, telling};

/// Pictures of more methods would be too small to tell apart.
const MOST: usize = 12;

/// What pages show first: an object, and two of its meshes.
pub(super) struct ShownFirst {
    /// Its place among the study's.
    pub(super) object: usize,
    /// What the viewer opens on; `None` where no two meshes differ.
    pub(super) pair: Option<[ConfigurationId; 2]>,
    /// Methods that have a picture before others where not all have one.
    named: Vec<MethodId>,
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
        Self { object, pair: None, named: Vec::new() }
    }
}

/// Which of an object's meshes look unlike all others that the study compares: one a recipe and a look. Other cells alone make no
/// other method.
fn unlike_others<'a>(study: &Study, of_object: &[&'a Configuration]) -> Vec<&'a Configuration> {
    let is_new = |place: usize| {
        let own = study.method(of_object[place].id.method);
        let is_alike = |other: &&Configuration| {
            let other = study.method(other.id.method);
            other.recipe == own.recipe && other.look == own.look
        };
        own.apart.is_none() && (own.budget.is_none() || !of_object[..place].iter().any(is_alike))
    };
    (0..of_object.len()).filter(|&place| is_new(place)).map(|place| of_object[place]).collect()
}

/// At most [`MOST`] of them, in the study's order: those come in first whose recipe and look some choice names, then the study's first.
fn as_many_as_fit<'a>(
    study: &Study,
    all: &[&'a Configuration],
    named: &[MethodId],
) -> Vec<&'a Configuration> {
    let rank = |configuration: &Configuration| {
        let own = study.method(configuration.id.method);
        let is_own = |id: &MethodId| {
            let of = study.method(*id);
            of.recipe == own.recipe && of.look == own.look
        };
        named.iter().position(is_own).unwrap_or(named.len())
    };
    let mut places: Vec<usize> = (0..all.len()).collect();
    places.sort_by_key(|&place| (rank(all[place]), place));
    places.truncate(MOST);
    places.sort_unstable();
    places.into_iter().map(|place| all[place]).collect()
}

/// Where a method's picture is.
pub(super) fn path(configuration: &Configuration) -> String {
    format!("figures/method_{}.png", configuration.id.method)
}

impl Pipeline<'_> {
    /// What pages show first: that which is [`telling`].
    pub(super) fn shown_first(&self, meshes: &Meshes, times: &Times<'_>) -> Result<ShownFirst> {
        let found = telling(self.study, &self.mesh_records(meshes)?);
        let mut shown = match found {
            Some(found) => ShownFirst { object: found.object, pair: Some(found.pair), named: Vec::new() },
            None => ShownFirst::without_difference(self.study),
        };
        if self.qualified(&shown).len() > MOST {
            shown.named = self.named_by_choices(meshes, times)?;
        }
        Ok(shown)
    }

    /// What choices name. Without answers, so that a study shows the same pictures before people answer and after.
    fn named_by_choices(&self, meshes: &Meshes, times: &Times<'_>) -> Result<Vec<MethodId>> {
        let measurements = self.measurements(meshes, times)?;
        Ok(named_by_choices(&Results::of(&measurements.inputs(self.study, None))))
    }

    /// The configurations that would be on the pages' picture if it had room.
    fn qualified(&self, shown: &ShownFirst) -> Vec<&Configuration> {
        let of_object: Vec<&Configuration> =
            self.selected(&[]).into_iter().filter(|c| c.object == shown.object).collect();
        unlike_others(self.study, &of_object)
    }

    /// The configurations on the pages' picture.
    pub(super) fn pictured(&self, shown: &ShownFirst) -> Vec<&Configuration> {
        as_many_as_fit(self.study, &self.qualified(shown), &shown.named)
    }

    /// What stands under the pictures; `None` where there are none.
    pub(super) fn pictures_caption(&self, shown: &ShownFirst) -> Option<String> {
        let pictured = self.pictured(shown);
        let object = &self.study.object(pictured.first()?).name;
        Some(caption(object, shown.is_telling(), self.qualified(shown).len() - pictured.len()))
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
                id: configuration.id.method.to_string(),
                label: self.study.method(configuration.id.method).label.clone(),
                size: [pixmap.width(), pixmap.height()],
                png,
            })
        };
        self.pictured(shown).into_iter().map(read).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn ids(configurations: &[&Configuration]) -> Vec<String> {
        configurations.iter().map(|of| of.id.method.to_string()).collect()
    }

    #[test]
    fn of_many_methods_those_that_choices_name_have_a_picture_first() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs/terrain.toml");
        let study = Study::load(&path).unwrap();
        let of_object: Vec<&Configuration> = study.configurations.iter().filter(|c| c.object == 1).collect();
        assert_eq!(of_object.len(), 32);
        let all = unlike_others(&study, &of_object);
        // None that is only matched, and none that is set apart; all looks of a recipe.
        let want = "mc mc33 mc-edge-groups snapmc bi bi-relaxed si nets-manifold dc dc-manifold dc-adaptive dc-in-cell cms vtk-fe dc-smooth \
                    nets-smooth nets-flat mc-half nets-half";
        assert_eq!(ids(&all).join(" "), want);

        let first = as_many_as_fit(&study, &all, &[]);
        assert_eq!(ids(&first), ids(&all[..MOST]));
        // The one by which a matched method is made stands for it.
        let named = ["nets-flat", "vtk-nets", "dcc-matched"].map(|id| id.parse().unwrap());
        let shown = ids(&as_many_as_fit(&study, &all, &named));
        assert_eq!(shown.len(), MOST);
        assert!(shown.contains(&"nets-flat".into()) && shown.contains(&"dc-in-cell".into()));
        assert!(
            shown.ends_with(&["dc-in-cell".into(), "nets-flat".into()]),
            "in the study's order: {shown:?}"
        );
        assert_eq!(ids(&as_many_as_fit(&study, &all[..5], &named)), ids(&all[..5]));
    }

    #[test]
    fn a_caption_says_how_many_methods_are_left_out() {
        assert!(caption("building", true, 0).ends_with("turntable."));
        assert!(caption("building", true, 1).ends_with(" 1 more method has no picture here."));
        assert!(caption("building", true, 4).ends_with(" 4 more methods have no picture here."));
    }
}
