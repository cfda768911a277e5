//! A study, checked and ready to work from: its parts, and what can be looked up in it.

mod methods;

pub use methods::METHOD;

use crate::check::Checker;
use crate::config::{ObjectSection, ShownFileKind, StimulusLook, StudyFile};
use crate::machine::CpuProfile;
use crate::method::{ConfigurationId, FactorSpec, Method, MethodId};
use crate::published::{BenchmarkRow, Claim, PreferenceCell};
use crate::texts::Texts;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// A study: its file, checked, with everything derived from it.
#[derive(Debug, Clone)]
pub struct Study {
    /// The file it was read from.
    pub path: PathBuf,
    /// SHA-256 of the file's text, lower-case hexadecimal: what was declared, and not changed since.
    pub sha256: String,
    /// What the file says, checked.
    pub file: StudyFile,
    /// What the methods differ in: the declared factors, then the one that every study has, [`METHOD`].
    pub factors: Vec<FactorSpec>,
    /// What is compared, in the file's order.
    pub methods: Vec<Method>,
    /// Every object with every method, in the file's order.
    pub configurations: Vec<Configuration>,
    /// The questions, in the file's order.
    pub comparisons: Vec<Comparison>,
    /// The comparison groups, in the file's order.
    pub groups: Vec<Group>,
    /// The CPU the benchmark is meant for.
    pub target: CpuProfile,
    /// The responses, resolved; the file is there.
    pub responses: Option<PathBuf>,
    /// What is known of people, resolved; the file is there.
    pub people: Option<PathBuf>,
    /// Published numbers; empty for a new study.
    pub published: Published,
    /// The study's own texts of the participant's page by language and key.
    pub texts: BTreeMap<String, Texts>,
}

/// One object with one method.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Configuration {
    /// Its id.
    pub id: ConfigurationId,
    /// Index of its object in `file.objects`.
    pub object: usize,
}

/// One question: two configurations of one object, side by side.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Comparison {
    /// The question's id.
    pub question: String,
    /// Index of the object in `file.objects`.
    pub object: usize,
    /// Index in `groups`; every comparison is in exactly one.
    pub group: usize,
    /// Shown on the left.
    pub left: ConfigurationId,
    /// Shown on the right.
    pub right: ConfigurationId,
}

/// A comparison group: the comparisons whose methods are both members.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Group {
    /// Short id.
    pub id: String,
    /// Name in tables and figures.
    pub label: String,
    /// The methods compared.
    pub members: Vec<MethodId>,
    /// Indices into `comparisons`.
    pub comparisons: Vec<usize>,
}

/// Published numbers to compare with.
#[derive(Debug, Clone, Default)]
pub struct Published {
    /// Where they were published.
    pub source: String,
    /// Benchmark rows.
    pub benchmark: Vec<BenchmarkRow>,
    /// Preference factors.
    pub preferences: Vec<PreferenceCell>,
    /// Claims in the text.
    pub claims: Vec<Claim>,
}

impl Study {
    /// The object of a configuration.
    pub fn object(&self, configuration: &Configuration) -> &ObjectSection {
        &self.file.objects[configuration.object]
    }

    /// What the study's own files show; `None` of a study that makes meshes.
    pub fn shown_files(&self) -> Option<ShownFileKind> {
        self.file.stimuli.shown_files()
    }

    /// Whether people are shown films of the study's own.
    pub fn shows_films(&self) -> bool {
        self.shown_files() == Some(ShownFileKind::Film)
    }

    /// Whether an earlier method makes the same meshes, so that this one differs in its look alone.
    pub fn is_repeated(&self, method: MethodId) -> bool {
        let of = self.method(method);
        let earlier = self.methods.iter().take_while(|other| other.id != method);
        earlier.into_iter().any(|other| other.recipe == of.recipe && other.budget == of.budget)
    }

    /// How a configuration's animation shows it. One look for all, until methods have their own.
    pub fn look(&self, configuration: &Configuration) -> StimulusLook {
        self.method(configuration.id.method).look.unwrap_or(self.file.turntable.look)
    }

    /// The looks of all configurations, each once.
    pub fn looks(&self) -> Vec<StimulusLook> {
        let mut looks = Vec::new();
        for look in self.configurations.iter().map(|configuration| self.look(configuration)) {
            if !looks.contains(&look) {
                looks.push(look);
            }
        }
        looks
    }

    /// The ids of the methods, in the file's order.
    pub fn method_ids(&self) -> Vec<MethodId> {
        self.methods.iter().map(|method| method.id).collect()
    }

    /// A path written in the study file, resolved against the file's folder.
    pub fn resolve(&self, written: &str) -> PathBuf {
        Checker { file: &self.path }.resolve(written)
    }
}
