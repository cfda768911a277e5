//! A study, read from its file, checked, and ready to work from.

mod checks;
mod methods;

pub use methods::METHOD;

use crate::check::{Checker, ConfigError};
use crate::code_names;
use crate::config::{ObjectSection, ResponsesSection, StimulusLook, StudyFile};
use crate::forms::Questionnaire;
use crate::machine::CpuProfile;
use crate::method::{ConfigurationId, FactorSpec, Method, MethodId};
use crate::published::{BenchmarkRow, Claim, PreferenceCell};
use checks::{check_forms, check_objects, check_primary, check_sections, check_stills};
use serde::de::DeserializeOwned;
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};

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
    /// Published numbers; empty for a new study.
    pub published: Published,
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
    /// Reads and checks a study file and the tables it names.
    ///
    /// Relative paths in the file are taken from the file's own folder.
    ///
    /// # Errors
    /// The first thing that is wrong, naming the file, the key and what is allowed. Nothing has been written then.
    pub fn load(path: &Path) -> Result<Self, ConfigError> {
        let text = std::fs::read_to_string(path)
            .map_err(|source| ConfigError::Read { file: path.into(), source })?;
        Self::parse(&text, path)
    }

    /// As [`Study::load`], from text; `path` names it in errors and anchors relative paths.
    ///
    /// # Errors
    /// As for [`Study::load`].
    pub fn parse(text: &str, path: &Path) -> Result<Self, ConfigError> {
        Self::checked(text, path, None)
    }

    /// As [`Study::parse`], of a study that is in no file: nothing is read, and the CPU is `target`, whatever the text says.
    ///
    /// # Errors
    /// As for [`Study::load`], with `study.toml` as the file; and if the text names files.
    pub fn in_memory(text: &str, target: CpuProfile) -> Result<Self, ConfigError> {
        Self::checked(text, Path::new("study.toml"), Some(target))
    }

    fn checked(text: &str, path: &Path, target: Option<CpuProfile>) -> Result<Self, ConfigError> {
        let file: StudyFile = parse_toml(text, path)?;
        let checker = Checker { file: path };
        check_sections(&checker, &file)?;
        check_objects(&checker, &file.objects)?;
        let (factors, methods) = methods::methods(&checker, &file)?;
        let configurations = cross(&file, &methods);
        let mut groups = groups(&checker, &file, &methods)?;
        let comparisons = comparisons(&checker, &file, &configurations, &mut groups)?;
        check_stills(&checker, &file, &configurations)?;
        check_forms(&checker, &file, &configurations)?;
        file.analysis.check(&checker)?;

        let target = match target {
            Some(target) => target,
            None => CpuProfile::load(&checker.existing("benchmark.target", &file.benchmark.target)?)?,
        };
        let responses = match &file.responses {
            Some(ResponsesSection { file: Some(written), .. }) => {
                Some(checker.existing("responses.file", written)?)
            }
            _ => None,
        };
        if file.responses.as_ref().is_some_and(|responses| !responses.pairs.is_empty()) {
            let limit = "the study's comparisons are its questions";
            return checker.refuse("responses.pairs", "[...]", limit);
        }
        let published = match &file.published {
            None => Published::default(),
            Some(section) => Published {
                source: section.source.clone(),
                benchmark: published_table(&checker, "published.benchmark", &section.benchmark)?,
                preferences: published_table(&checker, "published.preferences", &section.preferences)?,
                claims: published_table(&checker, "published.claims", &section.claims)?,
            },
        };
        let study = Self {
            path: path.into(),
            sha256: Sha256::digest(text).iter().map(|byte| format!("{byte:02x}")).collect(),
            factors,
            methods,
            configurations,
            comparisons,
            groups,
            target,
            responses,
            published,
            file,
        };
        check_primary(&checker, &study)?;
        Ok(study)
    }

    /// The object of a configuration.
    pub fn object(&self, configuration: &Configuration) -> &ObjectSection {
        &self.file.objects[configuration.object]
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

    /// Every pair, left and right, that is shown to anybody: the comparisons as listed, then what else the forms need.
    pub(crate) fn pairs(&self) -> Vec<(ConfigurationId, ConfigurationId)> {
        let as_listed = || self.comparisons.iter().map(|c| (c.left.clone(), c.right.clone())).collect();
        Questionnaire::of(self).map_or_else(as_listed, |questionnaire| questionnaire.pairs())
    }

    /// Code names: one a configuration, then one a pair, in the order of [`Study::stimuli`].
    pub fn code_names(&self) -> (Vec<String>, Vec<String>) {
        let count = self.configurations.len() + self.pairs().len();
        let mut names = crate::code_names::draw(self.file.study.seed, count);
        let pairs = names.split_off(self.configurations.len());
        (names, pairs)
    }
}

pub(crate) fn parse_toml<T: DeserializeOwned>(text: &str, path: &Path) -> Result<T, ConfigError> {
    toml::from_str(text).map_err(|error| ConfigError::Syntax {
        file: path.into(),
        message: error.to_string().trim_end().to_owned(),
    })
}

fn published_table<T: DeserializeOwned>(
    c: &Checker<'_>,
    key: &str,
    written: &Option<String>,
) -> Result<Vec<T>, ConfigError> {
    written.as_ref().map_or(Ok(Vec::new()), |written| read_table(&c.existing(key, written)?))
}

pub(crate) fn read_table<T: DeserializeOwned>(path: &Path) -> Result<Vec<T>, ConfigError> {
    let table_error =
        |error: csv::Error| ConfigError::Table { file: path.into(), message: error.to_string() };
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_path(path).map_err(table_error)?;
    reader.deserialize().collect::<Result<_, _>>().map_err(table_error)
}

fn cross(file: &StudyFile, methods: &[Method]) -> Vec<Configuration> {
    let mut configurations = Vec::new();
    for (object, section) in file.objects.iter().enumerate() {
        for method in methods {
            let id = ConfigurationId { object: section.id.clone(), method: method.id };
            configurations.push(Configuration { id, object });
        }
    }
    configurations
}

fn groups(c: &Checker<'_>, file: &StudyFile, methods: &[Method]) -> Result<Vec<Group>, ConfigError> {
    let ids: Vec<String> = file.groups.iter().map(|g| g.id.clone()).collect();
    c.distinct(|i| format!("groups[{i}].id"), &ids)?;
    for (i, group) in file.groups.iter().enumerate() {
        let members: Vec<String> = group.members.iter().map(ToString::to_string).collect();
        c.distinct(|j| format!("groups[{i}].members[{j}]"), &members)?;
        if members.len() < 2 {
            return c.refuse(format!("groups[{i}].members"), members.join(", "), "must list at least two");
        }
        if let Some(j) = group.members.iter().position(|member| methods.iter().all(|of| of.id != *member)) {
            let limit = "is not a method of this study";
            return c.refuse(format!("groups[{i}].members[{j}]"), group.members[j], limit);
        }
    }
    let group = |section: &crate::config::GroupSection| Group {
        id: section.id.clone(),
        label: section.label.clone(),
        members: section.members.clone(),
        comparisons: Vec::new(),
    };
    Ok(file.groups.iter().map(group).collect())
}

fn comparisons(
    c: &Checker<'_>,
    file: &StudyFile,
    configurations: &[Configuration],
    groups: &mut [Group],
) -> Result<Vec<Comparison>, ConfigError> {
    let questions: Vec<String> = file.comparisons.iter().map(|q| q.question.clone()).collect();
    c.distinct(|i| format!("comparisons[{i}].question"), &questions)?;
    let mut comparisons = Vec::new();
    for (i, section) in file.comparisons.iter().enumerate() {
        let key = |name: &str| format!("comparisons[{i}].{name}");
        let find = |name: &str, id: &ConfigurationId| match configurations
            .iter()
            .find(|configuration| configuration.id == *id)
        {
            Some(configuration) => Ok(configuration.object),
            None => c.refuse(key(name), id, "is not a configuration of this study"),
        };
        let object = find("left", &section.left)?;
        if find("right", &section.right)? != object {
            let limit = format!("must show the same object as the left side, {}", section.left);
            return c.refuse(key("right"), &section.right, limit);
        }
        if section.left == section.right {
            return c.refuse(key("right"), &section.right, "must differ from the left side");
        }
        let holds = |group: &Group| {
            group.members.contains(&section.left.method) && group.members.contains(&section.right.method)
        };
        let mut held_by = (0..groups.len()).filter(|&g| holds(&groups[g]));
        let (group, second) = (held_by.next(), held_by.next());
        let pair = format!("{} against {}", section.left.method, section.right.method);
        let group = match (group, second) {
            (Some(group), None) => group,
            (None, _) => return c.refuse(key("question"), &section.question, format!("no group has {pair}")),
            (Some(first), Some(second)) => {
                let limit = format!(
                    "{pair} is in groups {} and {}; it may be in one",
                    groups[first].id, groups[second].id
                );
                return c.refuse(key("question"), &section.question, limit);
            }
        };
        groups[group].comparisons.push(i);
        comparisons.push(Comparison {
            question: section.question.clone(),
            object,
            group,
            left: section.left.clone(),
            right: section.right.clone(),
        });
    }
    // Each may be shown both ways round and has a code name; so has each configuration, with itself as a control.
    if 2 * (configurations.len() + comparisons.len()) > code_names::LIMIT {
        let limit = format!("configurations and comparisons: at most {}", code_names::LIMIT / 2);
        return c.refuse("comparisons", comparisons.len(), limit);
    }
    Ok(comparisons)
}

#[cfg(test)]
pub(crate) mod tests;
