//! What participants get, and what the researcher keeps: the forms, the bundle, the keys, the contact sheet.

use super::models::{add_chunk, shading_of_models};
use super::web::{LEAST_PADDING, Videos, Web};
use super::{Meshes, Pipeline};
use crate::input;
use crate::picture;
use crate::shown_files;
use crate::source_digests;
use crate::store::{FileStamp, Inputs, Stamp, sha256};
use crate::terminal::progress::Step;
use anyhow::Result;
use isostudy_design::forms::{FormFile, Questionnaire, Stimulus};
use isostudy_design::record::Purpose;
use isostudy_design::{Configuration, ConfigurationId};
use isostudy_raster::tiny_skia::Pixmap;
use isostudy_serve::page::{LibraryFile, Media, MediaFormat};
use rand_pcg::Pcg64;
use rand_pcg::rand_core::{Rng, SeedableRng};
use sha2::{Digest, Sha256};
use std::collections::HashMap;

const BUNDLE: &str = "bundle";

/// Noise after the end of a GIF, where no reader looks, or in an MP4's free space: unlike zeros it neither shows nor can be compressed.
fn pad(bytes: &mut Vec<u8>, size: usize, seed: u64, name: &str) {
    let digest: [u8; 32] = Sha256::digest(format!("padding {seed} {name}")).into();
    let from = bytes.len();
    bytes.resize(size, 0);
    Pcg64::from_seed(digest).fill_bytes(&mut bytes[from..]);
}

/// Tells one version of a study's forms from another: 16 hexadecimal digits. The same for more participants, whose forms
/// follow those of fewer.
///
/// # Errors
/// None to be expected.
pub(crate) fn forms_digest(file: &FormFile) -> Result<String> {
    let first = FormFile { forms: file.forms.iter().take(1).cloned().collect(), ..file.clone() };
    let mut digest = sha256(&serde_json::to_vec(&first)?);
    digest.truncate(16);
    Ok(digest)
}

impl Pipeline<'_> {
    /// The participants' forms, and the key to them, kept apart like the key to the stimuli. `None` for a study that asks
    /// nobody.
    pub(crate) fn forms(&self) -> Result<Option<Stamp>> {
        let Some(questionnaire) = Questionnaire::of(self.study) else { return Ok(None) };
        let inputs = Inputs::of_sources(source_digests::KEYS).value("study", &self.study.file);
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

    /// The folder for participants: the page, the forms and every pair, and nothing that tells what a pair shows. All files of a
    /// kind are made the same size, since a smoother surface compresses better. `models` are the pairs as models, where they are shown,
    /// with the `library` that draws them. Returns what a participant loads, too.
    pub(crate) fn bundle(
        &self,
        forms: &Stamp,
        pairs: &[Stamp],
        (models, library): (&[Stamp], &[LibraryFile]),
        videos: Videos,
    ) -> Result<Media> {
        let text = input::bytes(&self.store.root().join(forms.file("forms.json")))?;
        let file: FormFile = serde_json::from_slice(&text)?;
        let Web { stamps: mut shown, mut kinds } = self.web(&file, pairs, videos)?;
        if !models.is_empty() {
            shown.extend_from_slice(models);
            kinds.insert(0, (MediaFormat::Model, self.study.file.turntable.frames));
        }
        let ends = |file: &&FileStamp, kind: MediaFormat| file.path.ends_with(&format!(".{}", kind.ending()));
        let size = |kind: MediaFormat| {
            let of_kind = shown.iter().flat_map(|stamp| &stamp.files).filter(|file| ends(file, kind));
            of_kind.map(|file| file.bytes).max().unwrap_or(0) as usize + LEAST_PADDING
        };
        let media = Media {
            kinds: kinds.iter().map(|&(kind, frames)| (kind, size(kind) as u64, frames)).collect(),
            surface: self.surface()?,
            shading: shading_of_models(self.study),
        };
        let step = Step::begin("bundle", 1, shown.len());
        let seed = self.study.file.study.seed;
        let mut inputs = Inputs::of_sources(source_digests::BUNDLES)
            .value("seed", &seed)
            .value("kinds", &kinds)
            .stamp(forms);
        for stamp in &shown {
            inputs = inputs.stamp(stamp);
        }
        if let Some(shading) = &media.shading {
            inputs = inputs.value("shading", shading);
        }
        for LibraryFile { name, content, .. } in library {
            inputs = inputs.text(name, &sha256(content.as_bytes()));
        }
        let stamp = self.stage(BUNDLE, inputs, |writer| {
            let root = self.store.root();
            let mut files = Vec::new();
            for file in shown.iter().flat_map(|stamp| &stamp.files) {
                let name = file.path.rsplit('/').next().unwrap_or(&file.path);
                let kind = kinds.iter().map(|&(kind, _)| kind).find(|&kind| ends(&file, kind));
                files.extend(kind.map(|kind| (name, kind, file)));
            }
            // In the order of names, so that times of modification tell nothing either.
            files.sort_by_key(|&(name, _, _)| name);
            for (name, kind, file) in files {
                let mut bytes = input::bytes(&root.join(&file.path))?;
                let size = size(kind);
                match kind {
                    MediaFormat::Mp4 => {
                        // A box that says it is free space: as long as what follows, its own eight bytes included.
                        bytes.extend(u32::try_from(size - bytes.len())?.to_be_bytes());
                        bytes.extend(b"free");
                    }
                    MediaFormat::WebM => {
                        // An element that says it is void, with its length in eight bytes, the first of which says so.
                        let length = (size - bytes.len() - 9) as u64;
                        bytes.push(0xec);
                        bytes.extend((length | 1 << 56).to_be_bytes());
                    }
                    MediaFormat::Gif | MediaFormat::Png => {}
                    MediaFormat::Model => {
                        // A chunk that no reader knows, with its length and its type in eight bytes.
                        let mut noise = Vec::new();
                        pad(&mut noise, size - bytes.len() - 8, seed, &file.path);
                        add_chunk(&mut bytes, *b"FREE", &noise)?;
                    }
                }
                pad(&mut bytes, size, seed, &file.path);
                writer.write(&format!("{BUNDLE}/stimuli/{name}"), &bytes)?;
                step.tick(1);
            }
            writer.write(&format!("{BUNDLE}/forms.json"), &text)?;
            let script = isostudy_serve::page::forms_js(&file, &forms_digest(&file)?, &media, None);
            writer.write(&format!("{BUNDLE}/forms.js"), script.as_bytes())?;
            let index = isostudy_serve::page::index(&file);
            writer.write(&format!("{BUNDLE}/index.html"), index.as_bytes())?;
            for LibraryFile { name, content, .. } in library {
                writer.write(&format!("{BUNDLE}/{name}"), content.as_bytes())?;
            }
            for (name, _, content) in isostudy_serve::page::FILES {
                writer.write(&format!("{BUNDLE}/{name}"), content.as_bytes())?;
            }
            Ok(())
        })?;
        step.count(stamp.redone);
        step.end();
        Ok(media)
    }

    /// Width and height of what stands on one side of a pair, in pixels.
    fn surface(&self) -> Result<[u32; 2]> {
        let scale = if self.study.shows_films() { 1 } else { self.study.file.stimuli.pair_scale };
        Ok(self.shown_size()?.map(|pixels| pixels * scale))
    }

    /// One side of pairs, its longer side `side_px` long.
    fn half(&self, configuration: &Configuration, meshes: &Meshes, side_px: u32) -> Result<Pixmap> {
        if self.study.shows_films() {
            return Ok(shown_files::film(self.study, configuration)?.thumbnail(side_px)?);
        }
        let mesh = self.read_mesh(meshes.stamp(&configuration.id, Purpose::Stimulus))?;
        let camera = &self.study.object(configuration).camera;
        let settings = picture::turntable(&self.study.file.turntable, camera);
        let shading = picture::shading(&self.study.file.shading);
        picture::thumbnail(&mesh, &settings, &shading, self.study.look(configuration), side_px)
    }

    /// Every pair with its code name and what it shows, on one page: for the researcher.
    pub(crate) fn contact_sheet(&self, meshes: &Meshes) -> Result<Stamp> {
        const HALF_PX: u32 = 128;
        let stimuli = self.study.stimuli();
        let mut inputs = Inputs::of_sources(source_digests::PICTURES).value("study", &self.study.file);
        for (file, digest) in shown_files::digests(self.study)? {
            inputs = inputs.text(&file, &digest);
        }
        for stamp in meshes.stamps() {
            inputs = inputs.stamp(stamp);
        }
        self.stage("contact_sheet", inputs, |writer| {
            let mut halves: HashMap<&ConfigurationId, Pixmap> = HashMap::new();
            for configuration in &self.study.configurations {
                halves.insert(&configuration.id, self.half(configuration, meshes, HALF_PX)?);
            }
            let question = |s: &Stimulus| {
                let Some([left, right]) = s.pair() else { return "shown" };
                let shows = |c: &&isostudy_design::Comparison| {
                    (&c.left, &c.right) == (left, right) || (&c.left, &c.right) == (right, left)
                };
                self.study
                    .comparisons
                    .iter()
                    .find(shows)
                    .map_or(if left == right { "control" } else { "training" }, |c| c.question.as_str())
            };
            let pairs: Vec<(String, Pixmap)> = stimuli
                .iter()
                .map(|s| {
                    let names: Vec<String> = s.shown.iter().map(ToString::to_string).collect();
                    let label = format!("{}\n{}: {}", s.code, question(s), names.join(" | "));
                    (label, picture::in_a_row(&s.shown.iter().map(|id| &halves[id]).collect::<Vec<_>>()))
                })
                .collect();
            writer.write(
                "key/contact_sheet.png",
                &picture::contact_sheet(&pairs, &self.study.file.study.title)?,
            )
        })
    }
}
