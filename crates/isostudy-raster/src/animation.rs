//! Turntables as palette indices, and pairs of them.

use crate::colour_index::ColourIndex;
use crate::colouring::Colouring;
use crate::fill::Painter;
use crate::index_table::IndexTable;
use crate::legend::legend;
use crate::level_colours::LevelColours;
use crate::nearest::Search;
use crate::samples::Samples;
use crate::surface::Surface;
use crate::{AnimationError, LightFollows, Look, Palette, RasterError, Shading, Turntable};
use isostudy_mesh::TriangleMesh;
use rayon::prelude::*;
use tiny_skia::{Pixmap, PremultipliedColorU8};

/// Indexed pictures of one size with one palette, shown one after the other, forever.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Animation {
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// Time between frames, centiseconds.
    pub delay_cs: u16,
    /// The colours of all frames.
    pub palette: Palette,
    /// `width * height` palette indices a frame, row by row from the upper left.
    pub frames: Vec<Vec<u8>>,
}

/// Draws a full turn, frames in parallel on rayon's current pool; `on_frame` is called once a finished frame, from
/// any thread and in any order. The bytes do not depend on the number of threads. Memory: the frames, and six bytes
/// a sample for each thread.
///
/// # Errors
/// As [`render`](crate::render).
pub fn turntable(
    mesh: &TriangleMesh,
    turntable: &Turntable,
    shading: &Shading,
    look: Look,
    on_frame: &(dyn Fn() + Sync),
) -> Result<Animation, RasterError> {
    turntable_in(mesh, turntable, shading, look, &Palette::of_look(shading, look), on_frame)
}

/// As [`turntable()`], in a palette that turntables of other looks may have as well: that of [`Palette::of_looks`].
///
/// # Errors
/// As [`render`](crate::render).
pub fn turntable_in(
    mesh: &TriangleMesh,
    turntable: &Turntable,
    shading: &Shading,
    look: Look,
    palette: &Palette,
    on_frame: &(dyn Fn() + Sync),
) -> Result<Animation, RasterError> {
    turntable.check()?;
    let surface = Surface::try_new(mesh, None, shading, look)?;
    let lines = look == Look::SmoothWireframe;
    let table = IndexTable::new(LevelColours::new(shading), palette, turntable.supersampling, lines);
    let frames = frames(&surface, turntable, shading, look, &|samples| table.index(samples), on_frame);
    Ok(turntable.animation(palette.clone(), frames))
}

/// As [`turntable()`], coloured by numbers, with their scale below every frame, which makes it higher. Its palette is
/// that of [`Palette::of_numbers`].
///
/// # Errors
/// As [`render_coloured`](crate::render_coloured).
pub fn turntable_coloured(
    mesh: &TriangleMesh,
    colouring: &Colouring,
    turntable: &Turntable,
    shading: &Shading,
    look: Look,
    on_frame: &(dyn Fn() + Sync),
) -> Result<Animation, RasterError> {
    turntable.check()?;
    let surface = Surface::try_new(mesh, Some(colouring), shading, look)?;
    let palette = Palette::of_numbers(shading, look);
    let index = ColourIndex::new(LevelColours::of_numbers(shading), &palette, turntable.supersampling);
    let frames = frames(&surface, turntable, shading, look, &|samples| index.index(samples), on_frame);
    Ok(turntable.animation(palette, frames).over(&legend(&colouring.scale, turntable.width)))
}

fn frames(
    surface: &Surface,
    turntable: &Turntable,
    shading: &Shading,
    look: Look,
    index: &(dyn Fn(&Samples) -> Vec<u8> + Sync),
    on_frame: &(dyn Fn() + Sync),
) -> Vec<Vec<u8>> {
    let viewport = turntable.viewport();
    let first = turntable.camera(0);
    let still = surface.lit(shading);
    (0..turntable.frames)
        .into_par_iter()
        .map_init(
            || (Painter::new(shading, look, surface.is_coloured(), &viewport), Samples::new(&viewport)),
            |(painter, samples), frame| {
                samples.clear();
                let camera = turntable.camera(frame);
                let turned = match shading.light_follows {
                    LightFollows::Scene => None,
                    LightFollows::Camera => Some(surface.lit(&shading.turned(&first, &camera))),
                };
                let lit = turned.as_ref().unwrap_or(&still);
                painter.draw(surface, lit, &camera, &viewport, samples);
                let indices = index(samples);
                on_frame();
                indices
            },
        )
        .collect()
}

impl Turntable {
    fn animation(&self, palette: Palette, frames: Vec<Vec<u8>>) -> Animation {
        let (width, height, delay_cs) = (self.width, self.height, self.frame_delay_cs());
        Animation { width, height, delay_cs, palette, frames }
    }
}

impl Animation {
    /// `self` on the left, `right` on the right, edge to edge; indices are copied, nothing is drawn again.
    ///
    /// # Errors
    /// [`AnimationError::Mismatch`] unless both have the same size, number of frames, delay and palette.
    pub fn side_by_side(&self, right: &Animation) -> Result<Animation, AnimationError> {
        self.check_pairs_with(right)?;
        let width = self.width as usize;
        let frames = self
            .frames
            .par_iter()
            .zip(&right.frames)
            .map(|(a, b)| {
                let mut both = Vec::with_capacity(a.len() + b.len());
                for (left_row, right_row) in a.chunks_exact(width).zip(b.chunks_exact(width)) {
                    both.extend_from_slice(left_row);
                    both.extend_from_slice(right_row);
                }
                both
            })
            .collect();
        Ok(Animation { width: self.width * 2, frames, palette: self.palette.clone(), ..*self })
    }

    /// All of them side by side from left to right, edge to edge; `None` of none.
    ///
    /// # Errors
    /// As [`side_by_side`](Self::side_by_side).
    pub fn in_a_row(all: &[Animation]) -> Result<Option<Animation>, AnimationError> {
        let Some((first, others)) = all.split_first() else { return Ok(None) };
        others.iter().try_for_each(|other| first.check_pairs_with(other))?;
        let frames: Vec<&[Vec<u8>]> = all.iter().map(|one| &one.frames[..]).collect();
        let frames = frames_in_a_row(&frames, first.width as usize);
        let width = first.width * all.len() as u32;
        Ok(Some(Animation { width, frames, palette: first.palette.clone(), ..*first }))
    }

    /// Every pixel as `factor` by `factor` pixels (nearest neighbour).
    ///
    /// # Panics
    /// If `factor` is 0.
    pub fn scaled(&self, factor: u32) -> Animation {
        assert!(factor > 0, "scaled by 0");
        let (width, factor_len) = (self.width as usize, factor as usize);
        let scale = |frame: &Vec<u8>| {
            let mut scaled = Vec::with_capacity(frame.len() * factor_len * factor_len);
            for row in frame.chunks_exact(width) {
                let from = scaled.len();
                scaled.extend(row.iter().flat_map(|&index| std::iter::repeat_n(index, factor_len)));
                let wide = from..scaled.len();
                (1..factor).for_each(|_| scaled.extend_from_within(wide.clone()));
            }
            scaled
        };
        Animation {
            width: self.width * factor,
            height: self.height * factor,
            frames: self.frames.par_iter().map(scale).collect(),
            palette: self.palette.clone(),
            ..*self
        }
    }

    /// With `strip` below every frame, in the palette's nearest colours.
    fn over(mut self, strip: &Pixmap) -> Animation {
        debug_assert_eq!(self.width, strip.width(), "a strip as wide as the frames");
        let search = Search::new(&self.palette);
        let colour = |p: &PremultipliedColorU8| [p.red(), p.green(), p.blue()].map(f32::from);
        let rows: Vec<u8> = strip.pixels().iter().map(|p| search.nearest(colour(p))).collect();
        self.height += strip.height();
        self.frames.iter_mut().for_each(|frame| frame.extend_from_slice(&rows));
        self
    }

    /// Frame `frame` in colour, opaque.
    ///
    /// # Panics
    /// If there is no such frame, or it holds an index beyond the palette.
    pub fn picture(&self, frame: usize) -> Pixmap {
        let mut pixmap = Pixmap::new(self.width, self.height).expect("a frame has a pixel");
        for (pixel, &index) in pixmap.pixels_mut().iter_mut().zip(&self.frames[frame]) {
            let [r, g, b] = self.palette.colours()[index as usize];
            *pixel = PremultipliedColorU8::from_rgba(r, g, b, 255).expect("opaque");
        }
        pixmap
    }

    fn check_pairs_with(&self, right: &Animation) -> Result<(), AnimationError> {
        let same = |what, left: u64, right: u64| match left == right {
            true => Ok(()),
            false => Err(AnimationError::Mismatch { what, left, right }),
        };
        same("width", self.width as u64, right.width as u64)?;
        same("height", self.height as u64, right.height as u64)?;
        same("number of frames", self.frames.len() as u64, right.frames.len() as u64)?;
        same("delay in centiseconds", self.delay_cs as u64, right.delay_cs as u64)?;
        let (a, b) = (self.palette.colours(), right.palette.colours());
        same("palette length", a.len() as u64, b.len() as u64)?;
        match (0..a.len()).find(|&i| a[i] != b[i]) {
            None => Ok(()),
            Some(i) => {
                same("palette (first colour that differs, 0xRRGGBB in decimal)", packed(a[i]), packed(b[i]))
            }
        }
    }
}

/// Frame by frame what several show, side by side from left to right. A row of each has `row_bytes`; all have as many rows and frames.
pub(crate) fn frames_in_a_row(all: &[&[Vec<u8>]], row_bytes: usize) -> Vec<Vec<u8>> {
    let frame = |number: usize| {
        let bytes = all[0][number].len();
        let mut joined = Vec::with_capacity(all.len() * bytes);
        for from in (0..bytes).step_by(row_bytes) {
            all.iter().for_each(|frames| joined.extend_from_slice(&frames[number][from..][..row_bytes]));
        }
        joined
    };
    (0..all[0].len()).into_par_iter().map(frame).collect()
}

fn packed([r, g, b]: [u8; 3]) -> u64 {
    u64::from_be_bytes([0, 0, 0, 0, 0, r, g, b])
}
