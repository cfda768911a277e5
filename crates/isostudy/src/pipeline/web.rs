//! Pairs small enough for the web: as they are where they fit `forms.web_mb`, else as videos, with smaller animations for
//! browsers that play none.

use super::Pipeline;
use crate::store::{Inputs, Stamp};
use crate::terminal::progress::Step;
use crate::{source_digests, video};
use anyhow::{Context, Result, bail};
use isostudy_design::forms::FormFile;
use isostudy_raster::{Animation, Reduction};
use isostudy_serve::page::MediaFormat;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

const FOLDER: &str = "stimuli/web";
const CHOSEN: &str = "key/web.json";

/// What is left of an animation, least loss first: where two are as large, the one with more pixels, since facets are what
/// people look at.
const REDUCTIONS: [Reduction; 11] = [
    Reduction::NONE,
    reduction(6, 1),
    reduction(8, 2),
    reduction(6, 2),
    reduction(5, 2),
    reduction(4, 2),
    reduction(4, 3),
    reduction(3, 2),
    reduction(3, 3),
    reduction(3, 4),
    reduction(2, 4),
];

const fn reduction(eighths: u32, step: u32) -> Reduction {
    Reduction { eighths, step }
}

/// So that the largest file, too, ends like the others.
pub(super) const LEAST_PADDING: usize = 64;

/// Videos beside the animations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Videos {
    /// Where the animations as they are do not fit.
    Needed,
    /// In any case.
    Always,
    /// Those of this kind that were made before, as long as they show the pairs; else where they are needed. So a machine without
    /// ffmpeg serves what another one has made.
    Made(MediaFormat),
}

/// What was chosen.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Chosen {
    /// Eighths of width and height that are left of the animations, and every how many-th frame.
    eighths: u32,
    step: u32,
    /// Constant rate factor of the videos; `None` where there are none.
    quality: Option<u32>,
}

/// A file's name and its bytes.
type File = (String, Vec<u8>);

/// The files for the web.
pub(crate) struct Web {
    /// Where they are.
    pub(crate) stamps: Vec<Stamp>,
    /// Each kind with its frames a turn.
    pub(crate) kinds: Vec<(MediaFormat, u32)>,
}

impl Pipeline<'_> {
    /// Pairs, each kind in files of at most `forms.web_mb` for one participant.
    ///
    /// # Errors
    /// If ffmpeg fails, or a file cannot be read or written.
    pub(crate) fn web(&self, forms: &FormFile, pairs: &[Stamp], videos: Videos) -> Result<Web> {
        if self.study.shows_films() {
            return self.films_for_web(forms, pairs);
        }
        let frames = self.study.file.turntable.frames;
        let section = self.study.file.forms.as_ref().context("no [forms] section")?;
        let room = self.room_for_web(forms)?;
        let bytes = |stamp: &Stamp| stamp.files.iter().map(|file| file.bytes).max().unwrap_or(0);
        let fits = pairs.iter().all(|pair| bytes(pair) <= room);
        if fits && videos == Videos::Needed {
            self.store.retire_untouched(|stage| stage != "web")?;
            return Ok(Web { stamps: pairs.to_vec(), kinds: vec![(MediaFormat::Gif, frames)] });
        }
        let kind = if let Videos::Made(kind) = videos { Some(kind) } else { video::kind() };
        let inputs = || {
            let inputs =
                Inputs::of_sources(source_digests::PICTURES).value("room", &room).value("kind", &kind);
            pairs.iter().fold(inputs, |inputs, pair| inputs.stamp(pair))
        };
        if matches!(videos, Videos::Made(_)) && self.store.peek("web", inputs()).is_none() {
            return self.web(forms, pairs, Videos::Needed);
        }
        let step = Step::begin("web", 1, 2 * pairs.len());
        let stamp = self.stage("web", inputs(), |writer| {
            // What compresses worst is tried first.
            let mut order: Vec<&Stamp> = pairs.iter().collect();
            order.sort_by_key(|pair| std::cmp::Reverse(bytes(pair)));
            let (reduction, animations) = if fits {
                (Reduction::NONE, None)
            } else {
                self.smallest_loss(&order, &REDUCTIONS, room, &step, |animation, &reduction| {
                    let Some(small) = animation.reduced(reduction) else { return Ok(None) };
                    let mut gif = Vec::new();
                    small.write_gif(&mut gif)?;
                    Ok(Some(gif))
                })
                .map(|(reduction, files)| (reduction, Some(files)))?
            };
            let quality = match kind {
                None => None,
                Some(kind) => {
                    let encode = |animation: &Animation, quality: &u32| {
                        video::for_web(animation, kind, *quality).map(Some)
                    };
                    let (quality, files) =
                        self.smallest_loss(&order, &video::QUALITIES, room, &step, encode)?;
                    for (code, bytes) in files {
                        writer.write(&format!("{FOLDER}/{code}.{}", kind.ending()), &bytes)?;
                    }
                    Some(quality)
                }
            };
            for (code, bytes) in animations.into_iter().flatten() {
                writer.write(&format!("{FOLDER}/{code}.gif"), &bytes)?;
            }
            let Reduction { eighths, step } = reduction;
            writer.write_json(CHOSEN, &Chosen { eighths, step, quality })
        })?;
        step.count(stamp.redone);
        step.end();
        let text = std::fs::read(self.store.root().join(CHOSEN)).context(CHOSEN)?;
        let chosen: Chosen = serde_json::from_slice(&text).context(CHOSEN)?;
        tell_choice(&chosen, kind, section.web_mb);
        let mut kinds: Vec<(MediaFormat, u32)> = kind.map(|kind| (kind, frames)).into_iter().collect();
        kinds.push((MediaFormat::Gif, frames / chosen.step));
        let as_they_are = if fits { pairs } else { &[] };
        Ok(Web { stamps: [&[stamp], as_they_are].concat(), kinds })
    }

    /// Most bytes of a pair, so that one participant loads at most `forms.web_mb`.
    pub(super) fn room_for_web(&self, forms: &FormFile) -> Result<u64> {
        let section = self.study.file.forms.as_ref().context("no [forms] section")?;
        let shown =
            forms.forms.iter().map(|form| form.training.len() + form.questions.len()).max().unwrap_or(1);
        let room = u64::from(section.web_mb) * 1_000_000 / shown as u64;
        Ok(room.saturating_sub(LEAST_PADDING as u64))
    }

    /// Every pair made smaller in the first way in which all fit. `order` begins with what is largest. `None` from `make` is a way
    /// that cannot be gone.
    fn smallest_loss<W: Clone + Sync>(
        &self,
        order: &[&Stamp],
        ways: &[W],
        room: u64,
        step: &Step,
        make: impl Fn(&Animation, &W) -> Result<Option<Vec<u8>>> + Sync,
    ) -> Result<(W, Vec<File>)> {
        let largest = order.first().context("no pairs")?;
        let first = self.read_animation(largest)?;
        let small = |bytes: &[u8]| bytes.len() as u64 <= room;
        for way in ways {
            match make(&first, way)? {
                Some(probe) if small(&probe) => {}
                _ => continue,
            }
            let one = |pair: &&Stamp| {
                let file = pair.file(".gif");
                let name = file.rsplit('/').next().unwrap_or(file).trim_end_matches(".gif");
                let made = make(&self.read_animation(pair)?, way)?.context("frames of one number")?;
                step.tick(1);
                Ok((name.to_owned(), made))
            };
            let files: Vec<File> = order.par_iter().map(one).collect::<Result<_>>()?;
            if files.iter().all(|(_, bytes)| small(bytes)) {
                return Ok((way.clone(), files));
            }
        }
        bail!(
            "{}: no pair may have more than {room} bytes by forms.web_mb, and they cannot be made so small: allow more, or take \
             fewer frames or a smaller size in [turntable]",
            self.study.path.display()
        )
    }
}

fn tell_choice(chosen: &Chosen, kind: Option<MediaFormat>, web_mb: u32) {
    let Chosen { eighths, step, quality } = *chosen;
    if let (Some(kind), Some(quality)) = (kind, quality) {
        tell!("{} with constant rate factor {quality}", kind.ending());
    }
    if (eighths, step) != (8, 1) {
        let why = match kind {
            Some(_) => "for browsers that play no such video",
            None => "an ffmpeg on the PATH would make videos as large as the pairs",
        };
        tell!(
            "gif with {eighths}/8 of width and height and 1/{step} of the frames, to stay within forms.web_mb = {web_mb}; {why}"
        );
    }
}
