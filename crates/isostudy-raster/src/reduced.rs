//! Animations made smaller: fewer pixels, fewer frames, the same turn in the same time.

use crate::Animation;
use crate::nearest::Search;
use rayon::prelude::*;
use std::ops::Range;

/// By how much an animation is made smaller.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Reduction {
    /// Eighths of its width and of its height that are left, 1 to 8.
    pub eighths: u32,
    /// Every how many-th frame is left, from 1; each is shown so many times as long.
    pub step: u32,
}

impl Reduction {
    /// Nothing less.
    pub const NONE: Self = Self { eighths: 8, step: 1 };
}

impl Animation {
    /// A smaller animation of the same turn. Each pixel is the mean, in levels, of what it covers, in the palette's nearest
    /// colour; both halves of a pair are treated alike and never mixed. Sides are rounded to whole pixels, at least one for each
    /// half, and the width stays even. [`Reduction::NONE`] changes nothing. The bytes do not depend on the number of threads.
    ///
    /// `None` if frames would be left over at the end of the turn, or a frame's delay would not fit in a GIF.
    ///
    /// # Panics
    /// If the width is odd, so that this is no pair, or `eighths` is not 1 to 8 or `step` is 0.
    pub fn reduced(&self, reduction: Reduction) -> Option<Animation> {
        let Reduction { eighths, step } = reduction;
        assert!((1..=8).contains(&eighths) && step > 0, "no reduction: {reduction:?}");
        assert!(self.width.is_multiple_of(2), "a pair has an even width");
        let delay_cs = u16::try_from(u32::from(self.delay_cs) * step).ok()?;
        if !self.frames.len().is_multiple_of(step as usize) {
            return None;
        }
        let kept = self.frames.iter().step_by(step as usize);
        if eighths == 8 {
            return Some(Animation {
                delay_cs,
                frames: kept.cloned().collect(),
                palette: self.palette.clone(),
                ..*self
            });
        }
        let side = |pixels: u32| (pixels * eighths).div_ceil(8).max(1);
        let (half, height) = (side(self.width / 2), side(self.height));
        let columns: Vec<Covered> = {
            let own = self.width / 2;
            let left = covered(own, half);
            let right = left
                .iter()
                .map(|of| Covered { pixels: of.pixels.start + own..of.pixels.end + own, ..of.clone() });
            left.iter().cloned().chain(right.collect::<Vec<_>>()).collect()
        };
        let rows = covered(self.height, height);
        let search = Search::new(&self.palette);
        let colours: Vec<[f32; 3]> = self.palette.colours().iter().map(|c| c.map(f32::from)).collect();
        let width = self.width as usize;
        let small = |frame: &Vec<u8>| -> Vec<u8> {
            let mut pixels = Vec::with_capacity(rows.len() * columns.len());
            for row in &rows {
                for column in &columns {
                    let (mut sum, mut area) = ([0.0; 3], 0.0);
                    for y in row.pixels.clone() {
                        for x in column.pixels.clone() {
                            let share = row.share(y) * column.share(x);
                            let colour = colours[frame[y as usize * width + x as usize] as usize];
                            (0..3).for_each(|i| sum[i] += share * colour[i]);
                            area += share;
                        }
                    }
                    pixels.push(search.nearest(sum.map(|of| of / area)));
                }
            }
            pixels
        };
        let frames = kept.collect::<Vec<_>>().into_par_iter().map(small).collect();
        Some(Animation { width: 2 * half, height, delay_cs, frames, palette: self.palette.clone() })
    }
}

/// The old pixels that a new one covers.
#[derive(Clone)]
struct Covered {
    pixels: Range<u32>,
    /// How much of the first and of the last it covers.
    first: f32,
    last: f32,
}

impl Covered {
    fn share(&self, pixel: u32) -> f32 {
        let outside = if pixel == self.pixels.start { 1.0 - self.first } else { 0.0 };
        let beyond = if pixel + 1 == self.pixels.end { 1.0 - self.last } else { 0.0 };
        1.0 - outside - beyond
    }
}

/// `old` pixels in a line, evenly covered by `new` ones, which are no more.
fn covered(old: u32, new: u32) -> Vec<Covered> {
    let one = |i: u32| {
        // In units of 1 / new of an old pixel, so that nothing is rounded.
        let (from, to) = (u64::from(i) * u64::from(old), u64::from(i + 1) * u64::from(old));
        let new = u64::from(new);
        let (start, end) = (from / new, to.div_ceil(new));
        let share = |part: u64| part as f32 / new as f32;
        Covered {
            pixels: start as u32..end as u32,
            first: share(new * (start + 1) - from),
            last: share(to - new * (end - 1)),
        }
    };
    (0..new).map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Palette;

    fn grey(width: u32, height: u32, frames: Vec<Vec<u8>>) -> Animation {
        let palette = Palette::new((0..=255).map(|level| [level; 3]).collect());
        Animation { width, height, delay_cs: 3, palette, frames }
    }

    #[test]
    fn nothing_less_is_the_same() {
        let animation = grey(4, 1, vec![vec![1, 2, 3, 4], vec![9, 8, 7, 6]]);
        assert_eq!(animation.reduced(Reduction::NONE), Some(animation));
    }

    #[test]
    fn a_pixel_is_the_mean_of_what_it_covers_and_halves_do_not_mix() {
        // A half of 4 by 2 pixels becomes one of 2 by 1: means of 2 by 2.
        let frame = vec![0, 4, 100, 100, 200, 200, 8, 8, 8, 8, 100, 108, 200, 208, 8, 8];
        let small = grey(8, 2, vec![frame]).reduced(Reduction { eighths: 4, step: 1 }).unwrap();
        assert_eq!((small.width, small.height), (4, 1));
        assert_eq!(small.frames, [vec![5, 102, 202, 8]]);
        // 8 to 5 pixels of a half: each covers 1.6, by hand.
        let line: Vec<u8> = [0, 10, 20, 30, 40, 50, 60, 70].into_iter().chain([200; 8]).collect();
        let small = grey(16, 1, vec![line]).reduced(Reduction { eighths: 5, step: 1 }).unwrap();
        let mean = |parts: &[(f32, f32)]| (parts.iter().map(|(s, v)| s * v).sum::<f32>() / 1.6).round() as u8;
        let expected = [
            mean(&[(1.0, 0.0), (0.6, 10.0)]),
            mean(&[(0.4, 10.0), (1.0, 20.0), (0.2, 30.0)]),
            mean(&[(0.8, 30.0), (0.8, 40.0)]),
            mean(&[(0.2, 40.0), (1.0, 50.0), (0.4, 60.0)]),
            mean(&[(0.6, 60.0), (1.0, 70.0)]),
        ];
        assert_eq!(small.frames[0][..5], expected);
        assert_eq!(small.frames[0][5..], [200; 5]);
    }

    #[test]
    fn a_turn_takes_as_long_in_fewer_frames() {
        let animation = grey(2, 1, (0..6).map(|i| vec![i, i]).collect());
        let third = animation.reduced(Reduction { eighths: 8, step: 3 }).unwrap();
        assert_eq!((third.delay_cs, third.frames), (9, vec![vec![0, 0], vec![3, 3]]));
        assert_eq!(
            animation.reduced(Reduction { eighths: 8, step: 4 }),
            None,
            "two frames would be left over"
        );
    }
}
