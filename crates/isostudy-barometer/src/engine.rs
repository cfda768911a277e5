//! Who extracts.

use serde::{Deserialize, Serialize};

/// On which side of the surface a sample is that equals the isovalue.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Ties {
    /// As if it were below.
    Outside,
    /// As if it were above.
    Inside,
}

impl From<Ties> for isostudy_trilinear::Ties {
    fn from(ties: Ties) -> Self {
        match ties {
            Ties::Outside => Self::Outside,
            Ties::Inside => Self::Inside,
        }
    }
}

/// What an engine is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Takes {
    /// The samples.
    Samples,
    /// A function, which interpolates the samples. Times of such engines are never compared with times of others.
    Field,
}

/// Which grids an engine takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Grids {
    /// All.
    #[default]
    All,
    /// With the same step along each axis.
    EqualSteps,
    /// With the same step and as many samples along each axis.
    Cubes,
}

impl Grids {
    /// Whether a grid is among them.
    pub fn contain(self, counts: [usize; 3], spacing: [f64; 3]) -> bool {
        let is_equal = spacing.iter().all(|step| (step / spacing[0] - 1.0).abs() < 1e-6);
        match self {
            Self::All => true,
            Self::EqualSteps => is_equal,
            Self::Cubes => is_equal && counts.iter().all(|&count| count == counts[0]),
        }
    }
}

/// An extractor, as its adapter's table says.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Engine {
    /// As tables and commands name it.
    pub id: String,
    /// As its makers call it.
    pub name: String,
    /// An SPDX expression.
    pub license: String,
    /// Where it comes from, such as `pip: vtk==9.7.2`.
    pub install: String,
    /// The program and its arguments, from the file's folder on.
    pub command: Vec<String>,
    /// What it is given.
    pub takes: Takes,
    /// Where it has samples that equal the isovalue.
    pub ties: Ties,
    /// Whether it closes the surface at the sides of the box.
    #[serde(default)]
    pub closes: bool,
    /// What grids it takes; all, if nothing is said.
    #[serde(default)]
    pub grids: Grids,
    /// Whether triangles share no vertices, so that those at one place are taken for one before it is judged.
    #[serde(default)]
    pub soup: bool,
    /// What kind of method it is.
    pub family: String,
    /// Whether the makers of the barometer make it.
    #[serde(default)]
    pub ours: bool,
    /// Whether it belongs to the quick run.
    #[serde(default)]
    pub quick: bool,
}

/// An extractor that could not be had.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Absent {
    /// As tables name it.
    pub id: String,
    /// As its makers call it.
    pub name: String,
    /// Why, in a sentence.
    pub why: String,
}

/// The engines of a file, and those that are absent.
#[derive(Debug, Clone, Default, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Engines {
    /// Those that there are.
    #[serde(default)]
    pub engines: Vec<Engine>,
    /// Those that there are not.
    #[serde(default)]
    pub absent: Vec<Absent>,
}

/// Reads a file of engines.
///
/// # Errors
/// If it is no TOML, has other keys, or names an engine twice.
pub fn read(text: &str) -> Result<Engines, String> {
    let found: Engines = toml::from_str(text).map_err(|error| error.to_string())?;
    for (i, engine) in found.engines.iter().enumerate() {
        if found.engines[..i].iter().any(|other| other.id == engine.id) {
            return Err(format!("engine {}: the id is there twice", engine.id));
        }
        if engine.command.is_empty() {
            return Err(format!("engine {}: the command is empty", engine.id));
        }
    }
    Ok(found)
}
