//! The study file, key by key. Every key here is documented in `docs/study-file.md` with unit, range and default.
//!
//! These types mirror the file and nothing else: paths are as written (relative to the file's own folder), numbers
//! are unchecked. [`crate::Study::load`] turns them into something to work from.

mod about;
mod analysis;
mod field;
mod forms;
mod methods;
mod objects;
mod pictures;
mod responses;
mod stimuli;
mod sweep;
mod viewer;
mod way;

pub use crate::method::{BudgetSection, Quantity, StimulusLook};
pub use about::{AboutKind, AboutSection, AboutTime};
pub use analysis::{
    AnalysisSection, Declaration, Exclusion, FamilyRule, StopWhen, StoppingBoundary, StoppingSection,
};
pub use field::{FieldSection, Inside, MeshSourceSection, PointKernel, PointNormals};
pub use forms::{FormsSection, OrderRule, Panel, Presentation, ShownNames, SideRule, TrainingSection};
pub(crate) use forms::{is_english_alone, is_false, is_steps, languages, steps};
pub use methods::{FactorSection, LevelSection, MethodSection, SpeltLevel};
pub(crate) use objects::check_objects;
pub use objects::{CameraSection, ObjectSection, RegionSection};
pub use pictures::{LightFollows, Look, ShadingSection, StillSection, TurntableSection};
pub use responses::{PairSection, ResponsesSection, SynonymsSection};
pub(crate) use stimuli::{STIMULI_SECONDS, STIMULUS_FILMS, STIMULUS_MESHES};
pub use stimuli::{ShownFile, ShownFileKind, StimuliSection};
pub use sweep::{Combine, RangeSection, Scale, SettingSection, SweepSection};
pub use viewer::ViewerSection;
pub use way::{AnswerKind, Way};
pub(crate) use way::{ENDS, MOST_STEPS};

use crate::method::{Arrangement, Clustering, ConfigurationId, MethodId};
use serde::{Deserialize, Serialize};

/// The whole study file.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StudyFile {
    /// Version of this layout; 1.
    #[serde(deserialize_with = "whole")]
    pub schema: u32,
    /// What the study is called, and its seed.
    pub study: StudySection,
    /// What a run may use.
    pub limits: LimitsSection,
    /// Keys that the recipes of arrangements crossed with clusterings have in common.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub extraction: Option<toml::Table>,
    /// The objects whose surfaces are extracted.
    pub objects: Vec<ObjectSection>,
    /// Arrangements to cross with the clusterings: the short form of methods.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub arrangements: Vec<Arrangement>,
    /// Clusterings to cross with the arrangements.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub clusterings: Vec<Clustering>,
    /// The methods, one by one, where they are no crossing.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub methods: Vec<MethodSection>,
    /// What listed methods differ in.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub factors: Vec<FactorSection>,
    /// How the animations are taken.
    pub turntable: TurntableSection,
    /// How surfaces are coloured.
    pub shading: ShadingSection,
    /// How stimuli are made from turntables.
    pub stimuli: StimuliSection,
    /// Still pictures of single configurations.
    #[serde(default)]
    pub stills: Vec<StillSection>,
    /// The page that shows any two meshes side by side; leave out for a study without one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub viewer: Option<ViewerSection>,
    /// What is timed, and how often.
    pub benchmark: BenchmarkSection,
    /// Resolutions and settings that are tried beyond objects and methods as they stand; leave out for a study without.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sweep: Option<SweepSection>,
    /// The questions: what is shown on which side; none for a study of meshes and times alone.
    #[serde(default)]
    pub comparisons: Vec<ComparisonSection>,
    /// Comparison groups over which preference factors are computed.
    #[serde(default)]
    pub groups: Vec<GroupSection>,
    /// How the questions are put to people; leave out for a study that asks nobody.
    pub forms: Option<FormsSection>,
    /// The answers to analyse; leave out for a study that has none yet.
    pub responses: Option<ResponsesSection>,
    /// What of the analysis is a choice, and when it was made.
    #[serde(default)]
    pub analysis: AnalysisSection,
    /// Published numbers to compare with; leave out for a new study.
    pub published: Option<PublishedSection>,
}

impl StudyFile {
    /// Folder with the library that draws models, as the file writes it: that of the forms, else that of the viewer.
    pub fn three(&self) -> Option<&str> {
        let of_forms = self.forms.as_ref().and_then(|forms| forms.three.as_deref());
        of_forms.or_else(|| self.viewer.as_ref().map(|viewer| viewer.three.as_str()))
    }
}

/// What the study is called, and its seed.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StudySection {
    /// Folder name under `results/`: lower-case letters, digits and hyphens.
    pub id: String,
    /// One line for headings.
    pub title: String,
    /// Seed of code names and of the benchmark's order.
    #[serde(deserialize_with = "whole")]
    pub seed: u64,
}

/// What a run may use.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LimitsSection {
    /// Most memory that one extraction may need, in GiB.
    pub memory_gib: f64,
    /// Most time that making, measuring and timing the meshes may take by an estimate; [`HOURS`](Self::HOURS) unless given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hours: Option<f64>,
}

impl LimitsSection {
    /// The default of `hours`: a spacing by mistake is found out, and what is meant to take longer says so.
    pub const HOURS: f64 = 1.0;
}

/// What is timed, and how often.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BenchmarkSection {
    /// Rounds run and thrown away at the start of every measuring process.
    #[serde(deserialize_with = "whole")]
    pub warmup: u32,
    /// Rounds of `isostudy bench`.
    #[serde(deserialize_with = "whole")]
    pub iterations: u32,
    /// Rounds of the short plan that `isostudy study` takes.
    #[serde(deserialize_with = "whole")]
    pub short_iterations: u32,
    /// Rounds of `isostudy bench` measured once more, for the noise floor.
    #[serde(default, deserialize_with = "whole")]
    pub aa_iterations: u32,
    /// Whether the run is kept on as many CPUs as it has threads.
    #[serde(default)]
    pub pin: bool,
    /// Threads in the sampling stage; 0 takes every core.
    #[serde(deserialize_with = "whole")]
    pub threads: u32,
    /// Cells along a side of the chunks that are timed one by one; 0 times none.
    #[serde(default, deserialize_with = "whole")]
    pub chunks: u32,
    /// Whether every method is timed once more from stored samples: whole, and chunk by chunk where `chunks` asks for that.
    #[serde(default)]
    pub stored: bool,
    /// Whether the short plan measures peak memory too, as the full one does.
    #[serde(default)]
    pub memory: bool,
    /// TOML file that describes the CPU the numbers are meant for.
    pub target: String,
    /// What other machines are called that measure the study too; each is a job of its own.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub machines: Vec<String>,
    /// What `isostudy bench sweep` measures; leave out for a study that sweeps nothing.
    pub sweep: Option<ThreadSweepSection>,
}

/// Resolutions and thread counts, each of which is measured with each.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ThreadSweepSection {
    /// Ids of the objects.
    pub objects: Vec<String>,
    /// Cells along the longest axis of an object's volume, ascending.
    pub cells: Vec<u32>,
    /// Threads, ascending.
    pub threads: Vec<u32>,
    /// Rounds for each resolution and thread count.
    #[serde(deserialize_with = "whole")]
    pub iterations: u32,
}

/// One question: what is shown on which side.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ComparisonSection {
    /// The question's id, unique; the column in the responses.
    pub question: String,
    /// Shown on the left.
    pub left: ConfigurationId,
    /// Shown on the right.
    pub right: ConfigurationId,
}

/// A comparison group.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GroupSection {
    /// Short id, unique.
    pub id: String,
    /// Name in tables and figures.
    pub label: String,
    /// Methods whose comparisons among each other make up the group.
    pub members: Vec<MethodId>,
}

/// Published numbers to compare with.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PublishedSection {
    /// Where they were published.
    pub source: String,
    /// Benchmark rows; columns as in [`crate::published::BenchmarkRow`].
    pub benchmark: Option<String>,
    /// Preference factors; columns as in [`crate::published::PreferenceCell`].
    pub preferences: Option<String>,
    /// Claims in the text; columns as in [`crate::published::Claim`].
    pub claims: Option<String>,
}

/// A whole number, refused with the range its type holds; the checks narrow it further.
fn whole<'de, D: serde::Deserializer<'de>, T: TryFrom<i64>>(deserializer: D) -> Result<T, D::Error> {
    let number = i64::deserialize(deserializer)?;
    T::try_from(number).map_err(|_| {
        let digits = 8 * size_of::<T>();
        serde::de::Error::custom(format!("{number} is not a whole number from 0 to 2^{} - 1", digits.min(63)))
    })
}

/// As [`whole`], of a key that may be left out.
fn perhaps_whole<'de, D: serde::Deserializer<'de>, T: TryFrom<i64>>(
    deserializer: D,
) -> Result<Option<T>, D::Error> {
    whole(deserializer).map(Some)
}
