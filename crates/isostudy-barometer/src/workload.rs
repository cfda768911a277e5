//! What engines are asked for, and what is known of it.

use serde::{Deserialize, Serialize};

/// Workloads of one kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Group {
    /// Shapes that an expert would name.
    Curated,
    /// From a user's report.
    Reported,
    /// Where extractors differ or fail.
    Hard,
    /// One surface on grids of growing size.
    Grown,
    /// Many small grids, one after the other.
    Chunks,
}

impl Group {
    /// All, in the order of tables.
    pub const ALL: [Self; 5] = [Self::Curated, Self::Reported, Self::Hard, Self::Grown, Self::Chunks];

    /// As files and tables name it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Curated => "curated",
            Self::Reported => "reported",
            Self::Hard => "hard",
            Self::Grown => "grown",
            Self::Chunks => "chunks",
        }
    }
}

/// What is done to samples before anybody sees them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Quantised {
    /// Rounded to 256 values over their range.
    #[serde(rename = "8-bit")]
    EightBit,
    /// 1 above the isovalue and 0 elsewhere; the isovalue is a half then.
    Binary,
    /// Rounded to whole numbers, so that many samples equal the isovalue if it is one.
    Whole,
}

impl Quantised {
    /// Changes samples, and says which isovalue goes with them.
    pub fn apply(self, samples: &mut [f32], isovalue: f32) -> f32 {
        match self {
            Self::EightBit => {
                let low = samples.iter().copied().fold(f32::INFINITY, f32::min);
                let high = samples.iter().copied().fold(f32::NEG_INFINITY, f32::max);
                let step = (high - low) / 255.0;
                if step > 0.0 {
                    samples.iter_mut().for_each(|value| *value = ((*value - low) / step).round());
                    // Between two of the values, as a threshold of a scanner's numbers is.
                    return ((isovalue - low) / step).floor() + 0.5;
                }
                isovalue
            }
            Self::Binary => {
                samples.iter_mut().for_each(|value| *value = f32::from(u8::from(*value > isovalue)));
                0.5
            }
            Self::Whole => {
                samples.iter_mut().for_each(|value| *value = value.round());
                isovalue
            }
        }
    }
}

/// What is known of the surface.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Truth {
    /// Connected pieces.
    pub components: u64,
    /// Summed over them.
    pub euler: i64,
    /// Closed curves in which the surface ends, all of them at the sides of the box.
    #[serde(default)]
    pub boundary: u64,
    /// What it encloses, in the box's units.
    pub volume: Option<f64>,
    /// Its area, in the box's units.
    pub area: Option<f64>,
    /// How far volume and area may be off, as a share; a twentieth if nothing is said.
    #[serde(default = "a_twentieth")]
    pub within: f64,
}

fn a_twentieth() -> f64 {
    0.05
}

/// One thing to extract.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Workload {
    /// As tables and commands name it.
    pub id: String,
    /// In a few words.
    pub name: String,
    /// Why it is there.
    pub says: String,
    /// Which surface it is of, where several workloads are of one: intervals take them for one. The id if nothing is said.
    pub surface: Option<String>,
    /// The public thread that it came from.
    pub thread: Option<String>,
    /// The field, in x, y and z, as `isostudy extract --formula` has it.
    pub formula: Option<String>,
    /// In place of a formula, a volume that a script fetches, from the file's folder on.
    pub volume: Option<String>,
    /// In place of both, the distance to a closed mesh that a script fetches, positive inside.
    pub mesh: Option<String>,
    /// In place of all, samples by chance, each from -1 to 1, one layer of -1 round them.
    pub random: Option<u64>,
    /// The first sample's place; of a volume, its own.
    #[serde(default)]
    pub min: [f64; 3],
    /// The last sample's place.
    #[serde(default)]
    pub max: [f64; 3],
    /// How many samples there are along x, y and z; of a volume, its own.
    #[serde(default)]
    pub samples: [u32; 3],
    /// The value on the surface. Inside is above it.
    #[serde(default)]
    pub isovalue: f32,
    /// What is done to the samples.
    pub quantised: Option<Quantised>,
    /// Into so many boxes along x, y and z it is cut; neighbours share a layer of samples. `samples` are those of each box.
    #[serde(default = "one")]
    pub boxes: [u32; 3],
    /// Added to each place after sampling: far from the origin single precision is coarse.
    #[serde(default)]
    pub offset: [f64; 3],
    /// Whether it belongs to the quick run.
    #[serde(default)]
    pub quick: bool,
    /// Whether memory is measured on it, in a process that is started for it.
    #[serde(default)]
    pub memory: bool,
    /// What is known of it.
    pub truth: Truth,
}

fn one() -> [u32; 3] {
    [1; 3]
}

/// The workloads of a file.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    group: Group,
    workloads: Vec<Workload>,
}

/// Why a file has no workloads.
#[derive(Debug, thiserror::Error)]
pub enum WorkloadError {
    /// No TOML, or other keys.
    #[error("{0}")]
    File(#[from] toml::de::Error),
    /// A workload that cannot be asked for.
    #[error("workload {id}: {reason}")]
    Workload {
        /// Which.
        id: String,
        /// Why.
        reason: &'static str,
    },
}

impl Workload {
    fn check(&self, group: Group) -> Result<(), &'static str> {
        let letters = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
        if self.id.is_empty() || !self.id.chars().all(letters) {
            return Err("an id has small letters, digits and hyphens");
        }
        let sources =
            [self.formula.is_some(), self.volume.is_some(), self.mesh.is_some(), self.random.is_some()];
        if sources.iter().filter(|&&is| is).count() != 1 {
            return Err("one of formula, volume, mesh and random must be there");
        }
        if self.thread.is_some() != (group == Group::Reported) {
            return Err("a thread is for the group reported, where each workload has one");
        }
        if self.volume.is_none() {
            if self.samples.iter().any(|&n| !(2..=1024).contains(&n)) {
                return Err("samples must be from 2 to 1024 along each axis");
            }
            if !(0..3).all(|axis| self.min[axis] < self.max[axis] && self.max[axis].is_finite()) {
                return Err("min must be below max along each axis");
            }
        }
        if self.boxes.contains(&0) || (self.boxes != [1; 3] && self.formula.is_none()) {
            return Err("boxes must be 1 or more along each axis, and more than 1 of a formula alone");
        }
        let positive = |of: Option<f64>| of.is_none_or(|value| value > 0.0 && value.is_finite());
        if !positive(self.truth.volume) || !positive(self.truth.area) || !positive(Some(self.truth.within)) {
            return Err("volume, area and within must be above 0");
        }
        Ok(())
    }

    /// How far apart samples are along each axis.
    pub fn spacing(&self) -> [f64; 3] {
        [0, 1, 2].map(|axis| {
            let steps = f64::from(self.boxes[axis]) * f64::from(self.samples[axis] - 1);
            (self.max[axis] - self.min[axis]) / steps
        })
    }
}

/// Reads the workloads of a file, with their group.
///
/// # Errors
/// [`WorkloadError`], which names the workload.
pub fn read(text: &str) -> Result<Vec<(Group, Workload)>, WorkloadError> {
    let File { group, workloads } = toml::from_str(text)?;
    for workload in &workloads {
        workload
            .check(group)
            .map_err(|reason| WorkloadError::Workload { id: workload.id.clone(), reason })?;
    }
    Ok(workloads.into_iter().map(|workload| (group, workload)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    const BALL: &str = r#"
        id = "ball"
        name = "a ball"
        says = "it is round"
        formula = "1 - sqrt(x*x + y*y + z*z)"
        min = [-2, -2, -2]
        max = [2, 2, 2]
        samples = [21, 21, 41]
        truth = { components = 1, euler = 2, volume = 4.18 }
    "#;

    fn file(group: &str, more: &str) -> String {
        format!("group = \"{group}\"\n[[workloads]]\n{BALL}\n{more}")
    }

    #[test]
    fn a_workload_is_read() {
        let (group, ball) = read(&file("curated", "")).unwrap().remove(0);
        assert_eq!(
            (group, ball.boxes, ball.truth.boundary, ball.truth.within),
            (Group::Curated, [1; 3], 0, 0.05)
        );
        assert_eq!(ball.spacing(), [0.2, 0.2, 0.1]);
    }

    #[test]
    fn mistakes_are_named() {
        for (group, more, word) in [
            ("curated", "thread = 'x'", "thread"),
            ("reported", "", "thread"),
            ("curated", "random = 1", "one of formula"),
            ("curated", "boxes = [0, 1, 1]", "boxes"),
            ("curated", "isovalues = 3", "isovalues"),
        ] {
            let error = read(&file(group, more)).unwrap_err().to_string();
            assert!(error.contains(word), "{error}");
        }
        assert!(read(&file("curated", "").replace("\"ball\"", "\"Ball\"")).is_err());
        assert!(read(&file("curated", "").replace("21, 41", "21, 1")).is_err());
        assert!(read(&file("curated", "").replace("max = [2", "max = [-2")).is_err());
    }

    #[test]
    fn quantised_samples_go_with_their_isovalue() {
        let mut samples = [-1.0, 0.0, 0.1, 4.1];
        let isovalue = Quantised::EightBit.apply(&mut samples, 0.05);
        assert_eq!((samples[0], samples[3]), (0.0, 255.0));
        assert!(samples[1] < isovalue && isovalue < samples[2], "{samples:?} {isovalue}");
        let mut samples = [-1.0, 0.0, 0.1, 4.1];
        assert_eq!(Quantised::Binary.apply(&mut samples, 0.0), 0.5);
        assert_eq!(samples, [0.0, 0.0, 1.0, 1.0]);
    }
}
