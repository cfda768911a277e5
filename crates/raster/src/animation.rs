//! Turntables as palette indices, and pairs of them.

use crate::fill::Painter;
use crate::index_table::IndexTable;
use crate::level_colours::LevelColours;
use crate::samples::Samples;
use crate::surface::Surface;
use crate::{AnimationError, Look, Palette, RasterError, Shading, Turntable};
use mesh::TriangleMesh;
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
    turntable.check()?;
    let viewport = turntable.viewport();
    let surface = Surface::try_new(mesh, shading, look)?;
    let palette = Palette::of_look(shading, look);
    let lines = look == Look::SmoothWireframe;
    let table = IndexTable::new(LevelColours::new(shading), &palette, viewport.supersampling, lines);
    let frames = (0..turntable.frames)
        .into_par_iter()
        .map_init(
            || (Painter::new(shading, look, &viewport), Samples::new(&viewport)),
            |(painter, samples), frame| {
                samples.clear();
                painter.draw(&surface, &turntable.camera(frame), &viewport, samples);
                let indices = table.index(samples);
                on_frame();
                indices
            },
        )
        .collect();
    Ok(Animation {
        width: turntable.width,
        height: turntable.height,
        delay_cs: turntable.frame_delay_cs(),
        palette,
        frames,
    })
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

fn packed([r, g, b]: [u8; 3]) -> u64 {
    u64::from_be_bytes([0, 0, 0, 0, 0, r, g, b])
}
