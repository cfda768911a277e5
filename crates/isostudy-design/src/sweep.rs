//! The cases of a study's sweep: counted, not listed, so that a million take no memory.

use crate::check::{Checker, ConfigError};
use crate::config::{Combine, ObjectSection, SettingSection, SweepSection, check_objects};
use crate::study::{Configuration, Study};
use crate::wording::{did_you_mean, plainly};
use serde::Serialize;

/// What a study's sweep is about: each pair of an object and a method, with the lists that apply to it.
#[derive(Debug, Clone)]
pub struct Sweep<'s> {
    /// The section that says so.
    pub section: &'s SweepSection,
    /// The pairs, in the study's order.
    pub pairs: Vec<Swept<'s>>,
    study: &'s Study,
    /// Of each setting.
    values: Vec<Vec<toml::Value>>,
}

/// One object with one method.
#[derive(Debug, Clone)]
pub struct Swept<'s> {
    /// Which.
    pub configuration: &'s Configuration,
    /// How many cases there are.
    pub cases: u64,
    /// Places of the settings that apply: the object's, then the method's.
    of_object: Vec<usize>,
    of_method: Vec<usize>,
}

/// One combination of values.
#[derive(Debug, Clone, PartialEq)]
pub struct Case<'s> {
    /// Which of its pair's, from 0 on.
    pub number: u64,
    /// Cells along the longest axis of the object's volume.
    pub cells: u32,
    /// The settings that apply: the object's, then the method's.
    pub settings: Vec<Chosen<'s>>,
}

/// A value of a setting.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Chosen<'s> {
    /// The setting's place in `sweep.settings`.
    pub setting: usize,
    /// The value's place among the setting's.
    pub place: usize,
    /// The value.
    pub value: &'s toml::Value,
}

impl Study {
    /// What the study's sweep is about; `None` of a study without one.
    pub fn sweep(&self) -> Option<Sweep<'_>> {
        let section = self.file.sweep.as_ref()?;
        let values: Vec<Vec<toml::Value>> = section.settings.iter().map(SettingSection::all).collect();
        let mut sweep = Sweep { section, pairs: Vec::new(), study: self, values };
        let pairs = self.configurations.iter().filter(|of| sweep.has(of)).map(|of| sweep.pair(of)).collect();
        sweep.pairs = pairs;
        Some(sweep)
    }
}

impl<'s> Sweep<'s> {
    /// How many cases there are in all.
    pub fn cases(&self) -> u64 {
        self.pairs.iter().fold(0, |sum, pair| sum.saturating_add(pair.cases))
    }

    /// The values of a setting, by its place in `sweep.settings`.
    pub fn values(&self, setting: usize) -> &[toml::Value] {
        &self.values[setting]
    }

    /// The name of a setting in tables and columns: `object.field.seed`, `method.placement`.
    pub fn name(&self, setting: usize) -> String {
        let SettingSection { objects, key, .. } = &self.section.settings[setting];
        format!("{}.{key}", if objects.is_empty() { "method" } else { "object" })
    }

    /// One of a pair's cases. The method's settings change first, then the cells, then the object's settings, so that what is found of
    /// an object serves the cases that follow.
    ///
    /// # Panics
    /// If the pair has fewer.
    pub fn case(&self, pair: &Swept<'_>, number: u64) -> Case<'_> {
        assert!(number < pair.cases, "case {number} of {}", pair.cases);
        let settings = pair.of_object.iter().chain(&pair.of_method).copied();
        let cells = &self.section.cells;
        let mut places: Vec<usize> = Vec::new();
        let mut left = number;
        let mut digit = |length: usize| match self.section.combine {
            Combine::Listed => {
                if length == 1 {
                    0
                } else {
                    number as usize
                }
            }
            Combine::Crossed => {
                let place = (left % length as u64) as usize;
                left /= length as u64;
                place
            }
        };
        places.extend(pair.of_method.iter().rev().map(|&setting| digit(self.values[setting].len())));
        let cells = cells[digit(cells.len())];
        places.extend(pair.of_object.iter().rev().map(|&setting| digit(self.values[setting].len())));
        let chosen = |(setting, &place): (usize, &usize)| Chosen {
            setting,
            place,
            value: &self.values[setting][place],
        };
        Case { number, cells, settings: settings.zip(places.iter().rev()).map(chosen).collect() }
    }

    /// The study with some settings of a pair in place of its own, such as those of a case.
    ///
    /// # Errors
    /// If the object cannot be with them, naming the setting. A recipe is read by whoever makes meshes.
    pub fn study_of(&self, pair: &Swept<'_>, settings: &[Chosen<'_>]) -> Result<Study, ConfigError> {
        let c = Checker { file: &self.study.path };
        let mut study = self.study.clone();
        // What it varies is said.
        study.file.sweep = None;
        let object = pair.configuration.object;
        for chosen in settings {
            let section = &self.section.settings[chosen.setting];
            let refuse = |limit: String| -> Result<Study, ConfigError> {
                let at = if section.range.is_some() {
                    "range".into()
                } else {
                    format!("values[{}]", chosen.place)
                };
                c.refuse(format!("sweep.settings[{}].{at}", chosen.setting), chosen.value, limit)
            };
            if !section.methods.is_empty() {
                let id = pair.configuration.id.method;
                let method =
                    study.methods.iter_mut().find(|method| method.id == id).expect("the study's own");
                if let Err(limit) = set(&mut method.recipe.settings, &section.key, chosen.value) {
                    return refuse(limit);
                }
                continue;
            }
            let mut keys = match toml::Table::try_from(&study.file.objects[object]) {
                Ok(keys) => keys,
                Err(error) => return refuse(plainly(error.to_string().trim_end())),
            };
            if let Err(limit) = set(&mut keys, &section.key, chosen.value) {
                return refuse(limit);
            }
            let changed: Result<ObjectSection, toml::de::Error> = keys.try_into();
            match changed {
                Ok(changed) => study.file.objects[object] = changed,
                Err(error) => {
                    let why = plainly(error.to_string().trim_end());
                    return refuse(format!("as {} of objects[{object}]: {why}", section.key));
                }
            }
            if let Err(error) = check_objects(&c, &study.file.objects) {
                return match error {
                    ConfigError::Value { key, value, limit, .. } => {
                        refuse(format!("gives {key} = {value}, which {limit}"))
                    }
                    other => Err(other),
                };
            }
        }
        Ok(study)
    }

    /// The values of a setting that have to be tried by themselves: of a range its ends, between which all others lie.
    pub fn extremes(&self, setting: usize) -> impl Iterator<Item = (usize, &toml::Value)> {
        let is_range = self.section.settings[setting].range.is_some();
        let last = self.values[setting].len() - 1;
        self.values[setting]
            .iter()
            .enumerate()
            .filter(move |(place, _)| !is_range || [0, last].contains(place))
    }

    fn has(&self, configuration: &Configuration) -> bool {
        let SweepSection { objects, methods, .. } = self.section;
        let method = configuration.id.method;
        (objects.is_empty() || objects.contains(&configuration.id.object))
            && match methods.is_empty() {
                true => self.study.method(method).budget.is_none(),
                false => methods.contains(&method),
            }
    }

    fn pair(&self, configuration: &'s Configuration) -> Swept<'s> {
        let places = |applies: &dyn Fn(&SettingSection) -> bool| -> Vec<usize> {
            let settings = self.section.settings.iter().enumerate();
            settings.filter(|(_, setting)| applies(setting)).map(|(place, _)| place).collect()
        };
        let of_object = places(&|setting| setting.objects.contains(&configuration.id.object));
        let of_method = places(&|setting| setting.methods.contains(&configuration.id.method));
        let settings = of_object.iter().chain(&of_method).map(|&setting| self.values[setting].len());
        let lengths = settings.chain([self.section.cells.len()]).map(|length| length as u64);
        let cases = match self.section.combine {
            Combine::Crossed => lengths.fold(1, u64::saturating_mul),
            Combine::Listed => lengths.max().unwrap_or(1),
        };
        Swept { configuration, cases, of_object, of_method }
    }

    /// The lists that apply to a pair: their key in the study file, and how long they are.
    fn lists(&self, pair: &Swept<'_>) -> Vec<(String, usize)> {
        let settings = pair.of_object.iter().chain(&pair.of_method);
        let of = |&setting: &usize| (format!("sweep.settings[{setting}]"), self.values[setting].len());
        std::iter::once(("sweep.cells".into(), self.section.cells.len())).chain(settings.map(of)).collect()
    }
}

impl Swept<'_> {
    /// How many of a case's settings are the object's; they come first.
    pub fn settings_of_object(&self) -> usize {
        self.of_object.len()
    }

    /// Places of the settings that apply, in `sweep.settings`: the object's, then the method's.
    pub fn settings(&self) -> impl Iterator<Item = usize> {
        self.of_object.iter().chain(&self.of_method).copied()
    }
}

/// Checks a study's sweep: what it names is there, no key is varied twice, there are no more cases than its limit, and each object can be
/// with each value by itself.
pub(crate) fn check(c: &Checker<'_>, study: &Study) -> Result<(), ConfigError> {
    let Some(section) = &study.file.sweep else { return Ok(()) };
    section.check(c)?;
    check_names(c, study, section)?;
    let sweep = study.sweep().expect("it has one");
    for pair in &sweep.pairs {
        check_pair(c, &sweep, pair)?;
    }
    let cases = sweep.cases();
    if cases > section.limit {
        let limit = format!("sweep.limit allows {}", section.limit);
        return c.refuse("sweep", format!("{cases} cases"), limit);
    }
    for (place, setting) in section.settings.iter().enumerate() {
        let applies = |pair: &&Swept<'_>| pair.settings().any(|of| of == place);
        let mut pairs = sweep.pairs.iter().filter(applies).peekable();
        if pairs.peek().is_none() {
            let limit = "applies to nothing that is swept";
            return c.refuse(format!("sweep.settings[{place}].key"), &setting.key, limit);
        }
        // Once for each object or method: settings of one are the same beside all others.
        let mut seen = Vec::new();
        for pair in pairs {
            let id = &pair.configuration.id;
            let whose = if setting.methods.is_empty() { id.object.clone() } else { id.method.to_string() };
            if seen.contains(&whose) {
                continue;
            }
            seen.push(whose);
            for (at, value) in sweep.extremes(place) {
                sweep.study_of(pair, &[Chosen { setting: place, place: at, value }])?;
            }
        }
    }
    Ok(())
}

fn check_names(c: &Checker<'_>, study: &Study, section: &SweepSection) -> Result<(), ConfigError> {
    let objects: Vec<&str> = study.file.objects.iter().map(|object| object.id.as_str()).collect();
    let methods: Vec<&str> = study.methods.iter().map(|method| method.id.as_str()).collect();
    let known = |key: String, what: &str, known: &[&str], given: &[String]| {
        c.distinct(|i| format!("{key}[{i}]"), given)?;
        match given.iter().position(|id| !known.contains(&id.as_str())) {
            None => Ok(()),
            Some(i) => {
                let meant = did_you_mean(&given[i], known.iter().copied());
                let limit = format!("must be {what} of this study: {}{meant}", known.join(", "));
                c.refuse(format!("{key}[{i}]"), &given[i], limit)
            }
        }
    };
    let text = |ids: &[crate::MethodId]| -> Vec<String> { ids.iter().map(ToString::to_string).collect() };
    known("sweep.objects".into(), "an object", &objects, &section.objects)?;
    known("sweep.methods".into(), "a method", &methods, &text(&section.methods))?;
    for (i, setting) in section.settings.iter().enumerate() {
        known(format!("sweep.settings[{i}].objects"), "an object", &objects, &setting.objects)?;
        known(format!("sweep.settings[{i}].methods"), "a method", &methods, &text(&setting.methods))?;
    }
    match section.methods.iter().position(|&id| study.method(id).budget.is_some()) {
        None => Ok(()),
        Some(i) => {
            let limit = "has a match, which decides its resolution; a sweep decides that itself";
            c.refuse(format!("sweep.methods[{i}]"), section.methods[i], limit)
        }
    }
}

fn check_pair(c: &Checker<'_>, sweep: &Sweep<'_>, pair: &Swept<'_>) -> Result<(), ConfigError> {
    let lists = sweep.lists(pair);
    if sweep.section.combine == Combine::Listed
        && let Some((key, length)) = lists.iter().find(|(_, length)| *length > 1)
        && let Some((other, of)) = lists.iter().find(|(_, of)| *of > 1 && of != length)
    {
        let limit =
            format!("needs as many values as {key}, which has {length}, since sweep.combine is \"listed\"");
        return c.refuse(other, format!("{of} values"), limit);
    }
    for (of, settings) in [("object", &pair.of_object), ("method", &pair.of_method)] {
        for (i, &setting) in settings.iter().enumerate() {
            let key = &sweep.section.settings[setting].key;
            let same = settings[..i].iter().find(|&&other| sweep.section.settings[other].key == *key);
            if let Some(other) = same {
                let id = &pair.configuration.id;
                let whose = if of == "object" { id.object.clone() } else { id.method.to_string() };
                let limit = format!("is varied by sweep.settings[{other}] too, of {of} {whose}");
                return c.refuse(format!("sweep.settings[{setting}].key"), key, limit);
            }
        }
    }
    Ok(())
}

/// Sets a key of a table, or of one within it.
fn set(table: &mut toml::Table, key: &str, value: &toml::Value) -> Result<(), String> {
    match key.split_once('.') {
        None => {
            table.insert(key.into(), value.clone());
            Ok(())
        }
        Some((first, rest)) => match table.get_mut(first) {
            Some(toml::Value::Table(within)) => set(within, rest, value),
            Some(_) => Err(format!("{first} is no table, so there is no {key}")),
            None => Err(format!("there is no {first}, so there is no {key}")),
        },
    }
}

#[cfg(test)]
mod tests;
