//! What people are shown of a study's own files in place of turntables.

use super::web::Web;
use super::{Meshes, Pipeline};
use crate::store::{Inputs, Stamp};
use crate::terminal::progress::Step;
use crate::{input, shown_files, source_digests, video};
use anyhow::{Context, Result, bail};
use isostudy_design::config::ShownFile;
use isostudy_design::forms::{FormFile, Stimulus};
use isostudy_design::record::Purpose;
use isostudy_design::{Configuration, ConfigurationId};
use isostudy_raster::Film;
use isostudy_serve::page::MediaFormat;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

const PAIRS: &str = "stimuli/pairs";
const VIDEOS: &str = "stimuli/web";
pub(super) const FACTS: &str = "key/films.json";

/// What all films of a study have in common.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct FilmFacts {
    pub(super) size: [u32; 2],
    pub(super) frames: u32,
}

/// What people are shown, and of what it was made.
pub(crate) struct Shown {
    /// None where films are shown.
    pub(crate) meshes: Meshes,
    /// With the key at the end.
    pub(crate) turntables: Vec<Stamp>,
    pub(crate) pairs: Vec<Stamp>,
}

impl Pipeline<'_> {
    /// Everything that people are shown, from meshes or from files.
    ///
    /// # Errors
    /// If something cannot be read or made.
    pub(crate) fn shown(&self) -> Result<Shown> {
        if self.study.shows_films() {
            let films = self.films()?;
            let pairs = self.film_pairs(&films)?;
            return Ok(Shown { meshes: Meshes::none(), turntables: vec![films, self.key()?], pairs });
        }
        let meshes = self.stimulus_meshes(&[])?;
        let turntables = self.turntables(&meshes, &[])?;
        let pairs = self.pairs(&turntables)?;
        Ok(Shown { meshes, turntables, pairs })
    }

    /// Reads every film once, and holds that any two go side by side.
    pub(super) fn films(&self) -> Result<Stamp> {
        let all = &self.study.configurations;
        let step = Step::begin("films", 1, all.len());
        let mut inputs = Inputs::of_sources(source_digests::PICTURES)
            .value("duration", &self.study.file.stimuli.duration_s);
        for (file, digest) in shown_files::digests(self.study)? {
            inputs = inputs.text(&file, &digest);
        }
        let stamp = self.stage("films", inputs, |writer| {
            let facts = |of: &Configuration| {
                let film = shown_files::film(self.study, of)?;
                step.tick(1);
                Ok(FilmFacts { size: [film.width, film.height], frames: film.frames.len() as u32 })
            };
            let facts: Vec<FilmFacts> = all.par_iter().map(facts).collect::<Result<_>>()?;
            let first = facts.first().context("checked when the study was read")?;
            if let Some((of, own)) = all.iter().zip(&facts).find(|(_, own)| *own != first) {
                let said = |of: &Configuration, FilmFacts { size: [width, height], frames }: FilmFacts| {
                    let path = shown_files::path(self.study, of)?;
                    Ok::<_, anyhow::Error>(format!(
                        "{} has {width} x {height} pixels and {frames} frames",
                        path.display()
                    ))
                };
                bail!("{}; {}: all have to be alike", said(&all[0], *first)?, said(of, *own)?);
            }
            writer.write_json(FACTS, first)
        })?;
        step.count(stamp.redone);
        step.end();
        Ok(stamp)
    }

    /// What all films have in common, as [`films`](Self::films) found it.
    pub(super) fn film_facts(&self) -> Result<FilmFacts> {
        let text = input::bytes(&self.store.root().join(FACTS))?;
        serde_json::from_slice(&text).context(FACTS)
    }

    /// Every pair that anybody is shown, and whatever else is shown at once: still pictures as PNG, films as GIF.
    fn film_pairs(&self, films: &Stamp) -> Result<Vec<Stamp>> {
        let stimuli = self.study.stimuli();
        let step = Step::begin("pairs", stimuli.len(), stimuli.len());
        let one = |stimulus: &Stimulus| {
            let stamp = self.film_pair(stimulus, films)?;
            step.tick(1);
            step.count(stamp.redone);
            Ok(stamp)
        };
        let stamps = stimuli.par_iter().map(one).collect::<Result<_>>()?;
        step.end();
        Ok(stamps)
    }

    pub(super) fn film_pair(&self, stimulus: &Stimulus, films: &Stamp) -> Result<Stamp> {
        let code = &stimulus.code;
        let inputs = Inputs::of_sources(source_digests::PICTURES).stamp(films).text("code", code);
        self.stage(&pair_stage(stimulus), inputs, |writer| {
            let row = self.row(stimulus)?;
            let ending = self.pair_ending();
            let bytes = match ending {
                "png" => row.to_png()?,
                _ => row.to_gif(self.study.file.stimuli.duration_s)?,
            };
            writer.write(&format!("{PAIRS}/{code}.{ending}"), &bytes)
        })
    }

    /// The films of a stimulus, side by side.
    fn row(&self, stimulus: &Stimulus) -> Result<Film> {
        let films = stimulus.shown.iter().map(|id| shown_files::film(self.study, self.configuration(id)));
        let films = films.collect::<Result<Vec<Film>>>()?;
        Film::in_a_row(&films)?.context("something is shown")
    }

    /// The kinds of files that a page shows, with their frames, and where they are. Films become videos where ffmpeg is; then their GIFs
    /// are for browsers that play none.
    ///
    /// # Errors
    /// If a file is larger than `forms.web_mb` allows.
    pub(super) fn films_for_web(&self, forms: &FormFile, pairs: &[Stamp]) -> Result<Web> {
        let FilmFacts { frames, .. } = self.film_facts()?;
        let room = self.room_for_web(forms)?;
        let largest = |stamps: &[Stamp]| {
            stamps.iter().flat_map(|stamp| &stamp.files).map(|file| file.bytes).max().unwrap_or(0)
        };
        let fits = |bytes: u64, kind: MediaFormat| {
            if bytes <= room {
                return Ok(());
            }
            bail!(
                "{}: a pair has {bytes} bytes as {}, and by forms.web_mb none may have more than {room}: allow more, or give smaller \
                 files",
                self.study.path.display(),
                kind.ending()
            );
        };
        let as_it_is = if self.pair_ending() == "png" { MediaFormat::Png } else { MediaFormat::Gif };
        let Some(kind) = video::kind().filter(|_| frames > 1) else {
            fits(largest(pairs), as_it_is)?;
            return Ok(Web { stamps: pairs.to_vec(), kinds: vec![(as_it_is, frames)] });
        };
        let stimuli = self.study.stimuli();
        let step = Step::begin("web", 1, stimuli.len());
        let mut inputs =
            Inputs::of_sources(source_digests::PICTURES).value("kind", &kind).value("room", &room);
        for pair in pairs {
            inputs = inputs.stamp(pair);
        }
        let stamp = self.stage("web", inputs, |writer| {
            for quality in video::QUALITIES {
                let one = |stimulus: &Stimulus| {
                    let row = self.row(stimulus)?;
                    let bytes = video::of_film(&row, self.study.file.stimuli.duration_s, kind, quality)?;
                    step.tick(1);
                    Ok((format!("{VIDEOS}/{}.{}", stimulus.code, kind.ending()), bytes))
                };
                let made: Vec<(String, Vec<u8>)> = stimuli.par_iter().map(one).collect::<Result<_>>()?;
                let most = made.iter().map(|(_, bytes)| bytes.len() as u64).max().unwrap_or(0);
                if most <= room {
                    return made.iter().try_for_each(|(path, bytes)| writer.write(path, bytes));
                }
                if quality == video::QUALITIES[video::QUALITIES.len() - 1] {
                    fits(most, kind)?;
                }
            }
            Ok(())
        })?;
        step.count(stamp.redone);
        step.end();
        let kinds = vec![(kind, frames), (MediaFormat::Gif, frames)];
        Ok(Web { stamps: [&[stamp], pairs].concat(), kinds })
    }

    /// The mesh of a configuration from the study's own file, placed as all of its object.
    pub(super) fn shown_mesh(&self, configuration: &Configuration) -> Result<Stamp> {
        let of_object = self.of_object(configuration);
        let inputs = self.extraction_inputs(configuration, Purpose::Stimulus)?;
        self.stage(&format!("mesh/stimulus/{}", configuration.id), inputs, |writer| {
            let meshes = shown_files::meshes(self.study, &of_object)?;
            let own = of_object.iter().position(|of| *of == configuration).context("its own")?;
            let mut ply = Vec::new();
            isostudy_mesh::write_ply(&meshes[own], &mut ply)?;
            writer.write(&format!("meshes/stimulus/{}.ply", configuration.id), &ply)
        })
    }

    /// The configurations of the same object.
    pub(super) fn of_object(&self, configuration: &Configuration) -> Vec<&Configuration> {
        self.study.configurations.iter().filter(|of| of.object == configuration.object).collect()
    }

    /// The meshes of the configurations in `only`, or of all if it is empty, from the study's own files.
    ///
    /// # Errors
    /// If the files are no meshes, or one cannot be read.
    pub(super) fn shown_meshes(&self, only: &[ConfigurationId]) -> Result<Meshes> {
        if self.study.shows_films() {
            bail!("{}: the study shows pictures, and has no meshes", self.study.path.display());
        }
        let all = self.selected(only);
        let step = Step::begin("meshes", all.len(), all.len());
        let mut entries = Vec::new();
        for configuration in all {
            let stamp = self.shown_mesh(configuration)?;
            step.tick(1);
            step.count(stamp.redone);
            entries.push((configuration.id.clone(), Purpose::Stimulus, stamp));
        }
        step.end();
        Ok(Meshes::of(entries))
    }

    /// Width and height of one side of a pair before it is enlarged, in pixels.
    ///
    /// # Errors
    /// If the study's films have not been read yet.
    pub(super) fn shown_size(&self) -> Result<[u32; 2]> {
        let turntable = &self.study.file.turntable;
        if self.study.shows_films() {
            Ok(self.film_facts()?.size)
        } else {
            Ok([turntable.width, turntable.height])
        }
    }

    /// What names of pairs end with: still pictures stay what they are.
    pub(super) fn pair_ending(&self) -> &'static str {
        let is_still = |shown: &ShownFile| shown.file.to_lowercase().ends_with(".png");
        let files = &self.study.file.stimuli.files;
        if !files.is_empty() && files.iter().all(is_still) { "png" } else { "gif" }
    }

    pub(super) fn configuration(&self, id: &ConfigurationId) -> &Configuration {
        let found = self.study.configurations.iter().find(|of| of.id == *id);
        found.expect("what is shown is of the study")
    }
}

/// The stage of a stimulus.
pub(super) fn pair_stage(stimulus: &Stimulus) -> String {
    let names: Vec<String> = stimulus.shown.iter().map(ToString::to_string).collect();
    format!("pair/{}", names.join("~"))
}
