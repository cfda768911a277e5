//! What a terrain is like.

use std::error::Error;
use std::fmt;
use std::str::FromStr;

use crate::fractal::MOST_OCTAVES;

/// Settings of a [`Terrain`](super::Terrain). Plain data; [`check`](Self::check) says what is allowed.
///
/// All lengths are in *widths*: shares of the longer horizontal side of the terrain's bounds. So a terrain looks the same in
/// bounds of any size. `z` is up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TerrainSettings {
    /// Which terrain of its kind.
    pub seed: u32,
    /// Mean height of the ground over the lower face of the bounds, in widths; 0 to 10.
    pub ground: f64,
    /// The most by which the ground rises above its mean height or sinks below it, in widths; 0 to 10.
    pub relief: f64,
    /// The size of the largest hills, in widths: the edge of the noise's cells; 0.001 to 100.
    pub period: f64,
    /// Octaves of the relief's noise, each half the size of the one before; 1 to 16.
    pub octaves: u32,
    /// Amplitude ratio of an octave to the one before; 0 to 1.
    pub gain: f64,
    /// How much of the relief is ridged noise, sharp crests between smooth hollows; 0 to 1.
    pub ridged: f64,
    /// How much of it is billowed noise, round bumps between creases; 0 to 1, with `ridged` at most 1. The rest is plain.
    pub billowed: f64,
    /// Height of a terrace, in widths; 0 for none, or 0.001 to 10. Between its treads the ground is steeper.
    pub terrace: f64,
    /// The most by which noise in three dimensions shifts the ground along x and along y, in widths; 0 to 1. Another height
    /// has another shift, so cliffs lean over. The ground stays in one piece while `overhang` is below 0.13
    /// `overhang_period`.
    pub overhang: f64,
    /// The size of overhangs along the ground, in widths: the edge of that noise's cells, which are half as high; 0.001 to
    /// 100.
    pub overhang_period: f64,
    /// How much of the rock is hollowed out, as a share of its volume: caves, and arches where they come out; 0 to 0.5. Met to
    /// within a quarter on average over seeds.
    pub caves: f64,
    /// The distance from cave to cave, in widths: the edge of that noise's cells; 0.001 to 100.
    pub cave_period: f64,
    /// Whether the solid ends at walls, [`margin`](Self::margin) inside all faces of the bounds, so that its surface is
    /// closed. Without walls the rock goes on below and at the sides, and the ground at all heights.
    pub closed: bool,
    /// How far the walls are from the faces of the bounds, in widths; 0 to 0.25. With indexed positions and guarded topology 0
    /// is enough to close the surface; more leaves samples in the air, and the walls are met exactly.
    pub margin: f64,
}

/// The settings that have a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TerrainCharacter {
    /// Smooth hills: no vertical line meets the ground twice.
    Hills,
    /// Terraced cliffs that lean over, with an arch here and there.
    Cliffs,
    /// Rough ground over a maze of caves, with arches.
    Caves,
}

impl TerrainCharacter {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Hills, Self::Cliffs, Self::Caves];

    /// The settings, closed.
    pub fn settings(self, seed: u32) -> TerrainSettings {
        let hills = TerrainSettings {
            seed,
            ground: 0.23,
            relief: 0.22,
            period: 0.3,
            octaves: 3,
            gain: 0.3,
            ridged: 0.0,
            billowed: 0.0,
            terrace: 0.0,
            overhang: 0.0,
            overhang_period: 0.25,
            caves: 0.0,
            cave_period: 0.25,
            closed: true,
            margin: 0.01,
        };
        match self {
            Self::Hills => hills,
            Self::Cliffs => TerrainSettings {
                ground: 0.24,
                relief: 0.4,
                period: 0.5,
                octaves: 5,
                gain: 0.35,
                ridged: 0.3,
                terrace: 0.1,
                overhang: 0.045,
                overhang_period: 0.28,
                ..hills
            },
            Self::Caves => TerrainSettings {
                ground: 0.3,
                relief: 0.18,
                period: 0.4,
                octaves: 5,
                gain: 0.4,
                ridged: 0.3,
                billowed: 0.3,
                overhang: 0.03,
                overhang_period: 0.2,
                caves: 0.13,
                cave_period: 0.24,
                ..hills
            },
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Hills => "hills",
            Self::Cliffs => "cliffs",
            Self::Caves => "caves",
        }
    }
}

impl fmt::Display for TerrainCharacter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for TerrainCharacter {
    type Err = TerrainError;

    fn from_str(name: &str) -> Result<Self, TerrainError> {
        Self::ALL
            .into_iter()
            .find(|character| character.name() == name)
            .ok_or_else(|| TerrainError::Character { name: name.chars().take(40).collect() })
    }
}

impl Default for TerrainSettings {
    /// Hills, seed 1.
    fn default() -> Self {
        TerrainCharacter::Hills.settings(1)
    }
}

/// Why there is no such terrain.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum TerrainError {
    /// A name that no character has.
    Character {
        /// What was asked for, cut after 40 characters.
        name: String,
    },
    /// A setting out of its range.
    Setting {
        /// The field of [`TerrainSettings`].
        key: &'static str,
        /// What it is.
        value: f64,
        /// What it may be.
        allowed: &'static str,
    },
    /// Bounds without a size, or not finite.
    Bounds,
}

impl fmt::Display for TerrainError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Character { name } => {
                write!(f, "no terrain is called `{name}`; hills, cliffs and caves are")
            }
            Self::Setting { key, value, allowed } => write!(f, "`{key}` = {value}: it has to be {allowed}"),
            Self::Bounds => f.write_str(
                "the bounds of a terrain have to be finite, each side longer than 0 and no longer than 1e18",
            ),
        }
    }
}

impl Error for TerrainError {}

impl TerrainSettings {
    /// Whether all settings are in their ranges.
    ///
    /// # Errors
    /// [`TerrainError::Setting`] for the first that is not.
    pub fn check(&self) -> Result<(), TerrainError> {
        let octaves = f64::from(self.octaves);
        let (size, is_terrace) = (|v| (0.001..=100.0).contains(&v), (0.001..=10.0).contains(&self.terrace));
        let [height, share] = [10.0, 1.0].map(|most| move |v| (0.0..=most).contains(&v));
        let rules = [
            ("ground", self.ground, height(self.ground), "0 to 10"),
            ("relief", self.relief, height(self.relief), "0 to 10"),
            ("period", self.period, size(self.period), "0.001 to 100"),
            ("octaves", octaves, (1..=MOST_OCTAVES).contains(&self.octaves), "1 to 16"),
            ("gain", self.gain, share(self.gain), "0 to 1"),
            ("ridged", self.ridged, share(self.ridged), "0 to 1"),
            (
                "billowed",
                self.billowed,
                share(self.billowed) && self.ridged + self.billowed <= 1.0,
                "0 to 1, and at most 1 with `ridged`",
            ),
            ("terrace", self.terrace, self.terrace == 0.0 || is_terrace, "0, or 0.001 to 10"),
            ("overhang", self.overhang, share(self.overhang), "0 to 1"),
            ("overhang_period", self.overhang_period, size(self.overhang_period), "0.001 to 100"),
            ("caves", self.caves, (0.0..=0.5).contains(&self.caves), "0 to 0.5"),
            ("cave_period", self.cave_period, size(self.cave_period), "0.001 to 100"),
            ("margin", self.margin, (0.0..=0.25).contains(&self.margin), "0 to 0.25"),
        ];
        match rules.into_iter().find(|(_, _, is_allowed, _)| !is_allowed) {
            Some((key, value, _, allowed)) => Err(TerrainError::Setting { key, value, allowed }),
            None => Ok(()),
        }
    }
}
