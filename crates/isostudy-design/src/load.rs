//! From a study's file to a [`Study`]: reading, checking, and everything derived.

mod about;
mod checks;
mod methods;
mod shown_files;
mod texts;

use crate::check::{Checker, ConfigError};
use crate::code_names;
use crate::config::{ResponsesSection, StudyFile, check_objects};
use crate::machine::CpuProfile;
use crate::method::{ConfigurationId, Method};
use crate::read::{parse_toml, read_table};
use crate::study::{Comparison, Configuration, Group, Published, Study};
use crate::wording::did_you_mean;
use checks::{
    check_forms, check_primary, check_reference, check_sections, check_shown, check_stills, check_stopping,
};
use serde::de::DeserializeOwned;
use sha2::{Digest, Sha256};
use shown_files::{check_shown_files, completed};
use std::collections::BTreeMap;
use std::path::Path;

impl Study {
    /// Reads and checks a study file and the tables it names.
    ///
    /// Relative paths in the file are taken from the file's own folder.
    ///
    /// # Errors
    /// The first thing that is wrong, naming the file, the key and what is allowed. Nothing has been written then.
    pub fn load(path: &Path) -> Result<Self, ConfigError> {
        let text = crate::read::text(path)?;
        Self::parse(&text, path)
    }

    /// As [`Study::load`], from text; `path` names it in errors and anchors relative paths.
    ///
    /// # Errors
    /// As for [`Study::load`].
    pub fn parse(text: &str, path: &Path) -> Result<Self, ConfigError> {
        Self::checked(text, path, None).map_err(|error| error.placed(text))
    }

    /// As [`Study::parse`], of a study that is in no file: nothing is read, and the CPU is `target`, whatever the text says.
    ///
    /// # Errors
    /// As for [`Study::load`], with `study.toml` as the file; and if the text names files.
    pub fn in_memory(text: &str, target: CpuProfile) -> Result<Self, ConfigError> {
        Self::checked(text, Path::new("study.toml"), Some(target)).map_err(|error| error.placed(text))
    }

    /// As [`Study::parse`], for a CPU that is given, whatever the text says.
    ///
    /// # Errors
    /// As for [`Study::load`].
    pub fn for_cpu(text: &str, path: &Path, target: CpuProfile) -> Result<Self, ConfigError> {
        Self::checked(text, path, Some(target)).map_err(|error| error.placed(text))
    }

    fn checked(text: &str, path: &Path, target: Option<CpuProfile>) -> Result<Self, ConfigError> {
        let checker = Checker { file: path };
        let file: StudyFile = parse_toml(&completed(&checker, text)?, path)?;
        check_sections(&checker, &file)?;
        check_objects(&checker, &file.objects)?;
        let (factors, methods) = methods::methods(&checker, &file)?;
        let configurations = cross(&file, &methods);
        let mut groups = groups(&checker, &file, &methods)?;
        let comparisons = comparisons(&checker, &file, &configurations, &mut groups)?;
        check_shown_files(&checker, &file, &configurations)?;
        check_stills(&checker, &file, &configurations)?;
        check_forms(&checker, &file, &configurations)?;
        file.forms.as_ref().map_or(Ok(()), |forms| about::check(&checker, forms))?;
        file.analysis.check(&checker)?;

        let target = match target {
            Some(target) => target,
            None if file.stimuli.shown_files().is_some() => CpuProfile::any(),
            None => CpuProfile::load(&checker.existing("benchmark.target", &file.benchmark.target)?)?,
        };
        let responses = match &file.responses {
            Some(ResponsesSection { file: Some(written), .. }) => {
                Some(checker.existing("responses.file", written)?)
            }
            _ => None,
        };
        let people = file.analysis.people.as_ref();
        let people = people.map(|written| checker.existing("analysis.people", written)).transpose()?;
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
        let texts = file.forms.as_ref().map_or(Ok(BTreeMap::new()), |forms| texts::own(&checker, forms))?;
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
            people,
            published,
            texts,
            file,
        };
        check_primary(&checker, &study)?;
        check_stopping(&checker, &study)?;
        check_reference(&checker, &study)?;
        check_shown(&checker, &study)?;
        crate::sweep::check(&checker, &study)?;
        Ok(study)
    }
}

fn published_table<T: DeserializeOwned>(
    c: &Checker<'_>,
    key: &str,
    written: &Option<String>,
) -> Result<Vec<T>, ConfigError> {
    written.as_ref().map_or(Ok(Vec::new()), |written| read_table(&c.existing(key, written)?))
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
            let known: Vec<&str> = methods.iter().map(|of| of.id.as_str()).collect();
            let limit = unknown("is not a method of this study", group.members[j].as_str(), &known);
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
        let object = configuration(c, &key("left"), &section.left, configurations)?.object;
        if configuration(c, &key("right"), &section.right, configurations)?.object != object {
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
            (None, _) => {
                return c.refuse(
                    key("question"),
                    &section.question,
                    format!("no group has {pair}; list both in the members of one of [[groups]]"),
                );
            }
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

/// The configuration with this id.
fn configuration<'a>(
    c: &Checker<'_>,
    key: &str,
    id: &ConfigurationId,
    all: &'a [Configuration],
) -> Result<&'a Configuration, ConfigError> {
    match all.iter().find(|configuration| configuration.id == *id) {
        Some(configuration) => Ok(configuration),
        None => c.refuse(key, id, unknown_configuration(id, all)),
    }
}

/// Which part of an id the study lacks: the object, the method, or both.
fn unknown_configuration(id: &ConfigurationId, all: &[Configuration]) -> String {
    let mut objects: Vec<&str> = all.iter().map(|of| of.id.object.as_str()).collect();
    let mut methods: Vec<&str> = all.iter().map(|of| of.id.method.as_str()).collect();
    objects.dedup();
    methods.sort_unstable();
    methods.dedup();
    let ids: Vec<String> = all.iter().map(|of| of.id.to_string()).collect();
    let meant = did_you_mean(&id.to_string(), ids.iter().map(String::as_str));
    let lacks =
        |what: &str, known: &[&str]| format!("no {what} of this study, which has {}", known.join(", "));
    match (objects.contains(&id.object.as_str()), methods.contains(&id.method.as_str())) {
        (false, true) => format!("{} is {}{meant}", id.object, lacks("object", &objects)),
        (true, false) => format!("{} is {}{meant}", id.method, lacks("method", &methods)),
        _ => format!(
            "{} is {}; {} is {}{meant}",
            id.object,
            lacks("object", &objects),
            id.method,
            lacks("method", &methods)
        ),
    }
}

/// What is wrong with a word, the words that there are, and the nearest of them.
fn unknown(what: &str, word: &str, known: &[&str]) -> String {
    format!("{what}, which has {}{}", known.join(", "), did_you_mean(word, known.iter().copied()))
}

#[cfg(test)]
pub(crate) mod tests;
