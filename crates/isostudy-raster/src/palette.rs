//! The colours a GIF may use, laid along the material's ramp or over the colours for numbers.

use crate::legend::{INK, PAPER};
use crate::shading::to_levels;
use crate::{Look, Shading, map_colour};

/// Up to 256 colours, red, green, blue. The number of entries is a power of two, as in a GIF.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Palette {
    colours: Vec<[u8; 3]>,
}

/// Entries for one mixture of background, line and surface; the surface has the rest.
struct Mixture {
    background: f32,
    wire: f32,
    entries: usize,
}

const fn mixture(background: f32, wire: f32, entries: usize) -> Mixture {
    Mixture { background, wire, entries }
}

/// Surface pixels first; then silhouettes, in quarters as 2 x 2 samples give them. A silhouette's colours span
/// less the less surface is in it, so fewer entries do.
const PLAIN: [Mixture; 5] = [
    mixture(1.0, 0.0, 1),
    mixture(0.0, 0.0, 170),
    mixture(0.25, 0.0, 42),
    mixture(0.50, 0.0, 28),
    mixture(0.75, 0.0, 15),
];

/// With lines over the surface, most pixels of a dense mesh are mixtures.
const LINED: [Mixture; 14] = [
    mixture(1.0, 0.0, 1),
    mixture(0.0, 1.0, 1),
    mixture(0.0, 0.0, 92),
    mixture(0.0, 0.25, 46),
    mixture(0.0, 0.50, 31),
    mixture(0.0, 0.75, 16),
    mixture(0.25, 0.0, 24),
    mixture(0.50, 0.0, 16),
    mixture(0.75, 0.0, 8),
    mixture(0.75, 0.25, 1),
    mixture(0.50, 0.50, 1),
    mixture(0.25, 0.75, 1),
    mixture(0.25, 0.25, 12),
    mixture(0.25, 0.50, 6),
];

/// Entries for colours that stand for numbers: how many of them, and each at how many levels of brightness.
struct Grid {
    background: f32,
    wire: f32,
    tints: usize,
    shades: usize,
}

const fn grid(background: f32, wire: f32, tints: usize, shades: usize) -> Grid {
    Grid { background, wire, tints, shades }
}

/// Surface first, then silhouettes. Together with background, wire and the scale's paper and ink, 256 at most.
const PLAIN_NUMBERS: [Grid; 4] =
    [grid(0.0, 0.0, 32, 6), grid(0.25, 0.0, 20, 1), grid(0.50, 0.0, 20, 1), grid(0.75, 0.0, 10, 1)];
/// With lines.
const LINED_NUMBERS: [Grid; 7] = [
    grid(0.0, 0.0, 30, 4),
    grid(0.0, 0.25, 20, 2),
    grid(0.0, 0.50, 20, 2),
    grid(0.0, 0.75, 8, 1),
    grid(0.25, 0.0, 10, 1),
    grid(0.50, 0.0, 10, 1),
    grid(0.75, 0.0, 8, 1),
];
/// Between paper and ink, both included.
const GREYS: usize = 6;

/// Points on the ramp at which its length is measured.
const RAMP_STEPS: usize = 4096;

impl Palette {
    /// The palette of a look: the same for every mesh, so turntables of one look can be paired as they are.
    ///
    /// A surface pixel's colour depends on one number, the exposure d, so the ramp gets entries at equal distances
    /// along its curve from d = -|L| to |L| (distance: the largest channel's difference). The background is exact.
    ///
    /// Error against [`render`](crate::render), default shading, in 8-bit levels over the channels of all pixels that
    /// are not background (`tests/it/palette.rs` bounds it; sphere, torus):
    ///
    /// | look, samples | mean | largest | PSNR, dB |
    /// |---|---|---|---|
    /// | smooth, 2 x 2 | 0.36, 0.39 | 4, 23 | 52.4, 51.2 |
    /// | flat, 2 x 2 | 0.36, 0.42 | 4, 21 | 52.5, 50.7 |
    /// | smooth, 1 | 0.35, 0.36 | 2, 2 | 52.7, 52.5 |
    /// | smooth, 3 x 3 | 0.45, 0.52 | 26, 26 | 46.7, 45.3 |
    /// | wireframe, 2 x 2 | 0.80, 0.81 | 4, 23 | 46.7, 46.3 |
    /// | smooth with wireframe, 2 x 2 | 0.58, 0.58 | 3, 8 | 48.8, 48.7 |
    ///
    /// A ramp colour is never off by more than 2. Errors beyond 4 sit where a bright fold ends in front of a dark
    /// one and a pixel mixes colours that are no neighbours on the ramp: 0.2 % of channels are off by more than 2.
    pub fn of_look(shading: &Shading, look: Look) -> Palette {
        Palette::of_looks(shading, &[look])
    }

    /// A palette that turntables of several looks have in common, so that they can be paired: that of the look with
    /// lines, if there is one, which has fewer entries for surfaces (off by 3 at most where the others' is by 2).
    pub fn of_looks(shading: &Shading, looks: &[Look]) -> Palette {
        let mixtures: &[Mixture] = if looks.contains(&Look::SmoothWireframe) { &LINED } else { &PLAIN };
        let ramp = ramp(shading);
        let mut colours = Vec::with_capacity(256);
        for m in mixtures {
            let surface = 1.0 - m.background - m.wire;
            let entries = evenly(&ramp, m.entries).map(|colour| {
                to_levels([0, 1, 2].map(|c| {
                    m.background * shading.background[c] + m.wire * shading.wire[c] + surface * colour[c]
                }))
            });
            colours.extend(entries);
        }
        Palette::new(colours)
    }

    /// The palette of turntables that are coloured by numbers, with paper and ink of the scale below them: the same for
    /// every mesh and every scale. Colours and their levels of brightness lie evenly. The background is exact; other
    /// pixels are off by 1.5 8-bit levels on average, 1.7 with lines (`tests/it/looks.rs` bounds it).
    pub fn of_numbers(shading: &Shading, look: Look) -> Palette {
        let grids: &[Grid] = match look {
            Look::Smooth | Look::Flat | Look::Wireframe | Look::Creased => &PLAIN_NUMBERS,
            Look::SmoothWireframe => &LINED_NUMBERS,
        };
        let share = |i: usize, count: usize| (i as f32 + 0.5) / count as f32;
        let grey = |i: usize| {
            let ink = i as f32 / (GREYS - 1) as f32;
            let of = |c: usize| ink * INK[c] as f32 + (1.0 - ink) * PAPER[c] as f32;
            [0, 1, 2].map(|c| (of(c) + 0.5) as u8)
        };
        let mut colours = vec![to_levels(shading.background), to_levels(shading.wire)];
        colours.extend((0..GREYS).map(grey));
        let (darkest, brightest) =
            (shading.brightness(-shading.max_exposure()), shading.brightness(shading.max_exposure()));
        for g in grids {
            let surface = 1.0 - g.background - g.wire;
            for tint in 0..g.tints {
                // The ends are exact: whatever lies beyond the scale has their colours.
                let colour = map_colour(tint as f32 / (g.tints - 1) as f32);
                for shade in 0..g.shades {
                    let brightness = darkest + (brightest - darkest) * share(shade, g.shades);
                    colours.push(to_levels([0, 1, 2].map(|c| {
                        g.background * shading.background[c]
                            + g.wire * shading.wire[c]
                            + surface * brightness * colour[c]
                    })));
                }
            }
        }
        Palette::new(colours)
    }

    /// A palette of these colours, padded with black to a power of two.
    ///
    /// # Panics
    /// With no colour or more than 256.
    pub fn new(mut colours: Vec<[u8; 3]>) -> Palette {
        assert!((1..=256).contains(&colours.len()), "a palette of {} colours", colours.len());
        colours.resize(colours.len().next_power_of_two().max(2), [0; 3]);
        Palette { colours }
    }

    /// The colours by index.
    pub fn colours(&self) -> &[[u8; 3]] {
        &self.colours
    }
}

/// Colours from d = -|L| to |L|, with the length of the curve up to each, in channel units.
fn ramp(shading: &Shading) -> Vec<(f32, [f32; 3])> {
    let max = shading.max_exposure();
    let mut length = 0.0;
    let mut last = shading.colour(-max);
    (0..=RAMP_STEPS)
        .map(|i| {
            let colour = shading.colour(max * (2.0 * i as f32 / RAMP_STEPS as f32 - 1.0));
            length += (0..3).map(|c| (colour[c] - last[c]).abs()).fold(0.0, f32::max);
            last = colour;
            (length, colour)
        })
        .collect()
}

/// `count` colours in the middle of as many equal lengths of the ramp.
fn evenly(ramp: &[(f32, [f32; 3])], count: usize) -> impl Iterator<Item = [f32; 3]> {
    let total = ramp[ramp.len() - 1].0;
    (0..count).map(move |i| {
        let wanted = total * (i as f32 + 0.5) / count as f32;
        ramp[ramp.partition_point(|&(length, _)| length < wanted).min(ramp.len() - 1)].1
    })
}
