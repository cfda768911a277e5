//! From a pixel's samples to its palette index.
//!
//! A pixel whose surface samples lie close together is looked up by how many of its samples are surface and line
//! and by the mean level. Only pixels across a fold, where a mean level would stand for a colour that is not
//! there, have their colours averaged and searched for.

use crate::Palette;
use crate::level_colours::LevelColours;
use crate::nearest::Search;
use crate::samples::{BACKGROUND, Samples, TOP_LEVEL, WIRE};

/// Levels that share an entry of the table: half an 8-bit colour level at most.
const LEVELS_A_BUCKET: usize = 4;
const BUCKETS: usize = (TOP_LEVEL as usize + 1) / LEVELS_A_BUCKET;
/// Largest difference of levels in a pixel that is looked up by their mean; 0.05 in d by default.
const CLOSE: f32 = 400.0;

/// Palette indices for pixels of `supersampling` squared samples.
pub(crate) struct IndexTable {
    supersampling: usize,
    /// Rows by number of surface samples, then of line samples; a row has [`BUCKETS`] entries.
    rows: Vec<Vec<u8>>,
    search: Search,
    colours: LevelColours,
}

impl IndexTable {
    pub(crate) fn new(
        colours: LevelColours,
        palette: &Palette,
        supersampling: u32,
        lines: bool,
    ) -> IndexTable {
        let n = (supersampling * supersampling) as usize;
        let search = Search::new(palette);
        let mut rows = vec![Vec::new(); (n + 1) * (n + 1)];
        for surface in 0..=n {
            for wire in 0..=if lines { n - surface } else { 0 } {
                let entry = |bucket: usize| {
                    let middle = colours.of((bucket * LEVELS_A_BUCKET + LEVELS_A_BUCKET / 2) as f32);
                    let (line, back) = (colours.of(WIRE), colours.of(BACKGROUND));
                    let sum = [0, 1, 2].map(|c| {
                        surface as f32 * middle[c]
                            + wire as f32 * line[c]
                            + (n - surface - wire) as f32 * back[c]
                    });
                    search.nearest(sum.map(|v| v / n as f32))
                };
                rows[surface * (n + 1) + wire] = match surface {
                    0 => vec![entry(0)],
                    _ => (0..BUCKETS).map(entry).collect(),
                };
            }
        }
        IndexTable { supersampling: supersampling as usize, rows, search, colours }
    }

    /// The picture as palette indices, row by row.
    pub(crate) fn index(&self, samples: &Samples) -> Vec<u8> {
        match self.supersampling {
            1 => self.index_by::<1>(samples),
            2 => self.index_by::<2>(samples),
            3 => self.index_by::<3>(samples),
            4 => self.index_by::<4>(samples),
            5 => self.index_by::<5>(samples),
            6 => self.index_by::<6>(samples),
            7 => self.index_by::<7>(samples),
            _ => self.index_by::<8>(samples),
        }
    }

    fn index_by<const S: usize>(&self, samples: &Samples) -> Vec<u8> {
        let width = samples.width / S;
        let background = self.rows[0][0];
        let mut indices = vec![background; width * (samples.height / S)];
        let [columns, rows] = samples.touched_pixels(S);
        let all_surface = &self.rows[S * S * (S * S + 1)][..];
        for y in rows {
            let out = &mut indices[y * width..][columns.clone()];
            let lines: [&[f32]; S] = std::array::from_fn(|i| {
                &samples.level[(y * S + i) * samples.stride..][columns.start * S..][..out.len() * S]
            });
            for (x, index) in out.iter_mut().enumerate() {
                let (mut sum, mut least, mut most) = (0.0f32, f32::MAX, 0.0f32);
                for line in lines {
                    for &level in &line[x * S..x * S + S] {
                        sum += level;
                        least = least.min(level);
                        most = most.max(level);
                    }
                }
                if most == BACKGROUND {
                    continue;
                }
                *index = if least > BACKGROUND && most <= TOP_LEVEL && most - least <= CLOSE {
                    all_surface[sum as usize / (S * S * LEVELS_A_BUCKET)]
                } else {
                    self.mixed(lines.iter().flat_map(|line| line[x * S..x * S + S].iter().copied()), S * S)
                };
            }
        }
        indices
    }

    /// A pixel that is not all surface, or across a fold.
    fn mixed(&self, levels: impl Iterator<Item = f32> + Clone, n: usize) -> u8 {
        let (mut surface, mut wire, mut sum, mut least, mut most) = (0, 0, 0.0f32, f32::MAX, 0.0f32);
        for level in levels.clone() {
            match level {
                BACKGROUND => {}
                WIRE => wire += 1,
                _ => {
                    surface += 1;
                    sum += level;
                    least = least.min(level);
                    most = most.max(level);
                }
            }
        }
        let row = &self.rows[surface * (n + 1) + wire];
        if surface == 0 {
            row[0]
        } else if most - least <= CLOSE {
            row[sum as usize / (surface * LEVELS_A_BUCKET)]
        } else {
            let mut all = [BACKGROUND; 64];
            all.iter_mut().zip(levels).for_each(|(to, from)| *to = from);
            self.search.nearest(self.colours.mean(&all[..n]))
        }
    }
}
