//! What a study tries beyond its objects and methods as they stand: resolutions and settings, each combination a case.

use super::whole;
use crate::check::{Checker, ConfigError};
use crate::method::MethodId;
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;

/// Resolutions and settings; every combination of them is extracted and measured.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SweepSection {
    /// Ids of objects; all where none is listed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub objects: Vec<String>,
    /// Ids of methods; all without a budget where none is listed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub methods: Vec<MethodId>,
    /// Cells along the longest axis of an object's volume, ascending.
    pub cells: Vec<u32>,
    /// What goes with what.
    #[serde(default)]
    pub combine: Combine,
    /// The most cases; a sweep of more is refused.
    #[serde(default = "SweepSection::limit", deserialize_with = "whole")]
    pub limit: u64,
    /// How many cases a job does, and how many rows a file of results has.
    #[serde(default = "SweepSection::cases_per_job", deserialize_with = "whole")]
    pub cases_per_job: u32,
    /// How often each case is timed; 0 for not.
    #[serde(default, deserialize_with = "whole")]
    pub times: u32,
    /// Whether each case has a picture.
    #[serde(default)]
    pub pictures: bool,
    /// What is varied beside the resolution.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub settings: Vec<SettingSection>,
}

/// How the lists of a sweep are combined.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Combine {
    /// Each value of a list with each of all others.
    #[default]
    Crossed,
    /// The first values of all lists, then the second ones. Lists are equally long; one of a single value goes with all.
    Listed,
}

/// A key of some objects, or of some methods' recipes, and its values.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SettingSection {
    /// Whose key it is: these objects'.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub objects: Vec<String>,
    /// Or these methods'.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub methods: Vec<MethodId>,
    /// The key, with dots between the names of tables: `field.seed` of an object, `placement` of a recipe.
    pub key: String,
    /// Its values, one by one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub values: Vec<toml::Value>,
    /// Or evenly spaced.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub range: Option<RangeSection>,
}

/// Evenly spaced numbers.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RangeSection {
    /// The first; where both ends are whole numbers, all are rounded to whole numbers.
    pub from: toml::Value,
    /// The last.
    pub to: toml::Value,
    /// How many, both ends included.
    #[serde(deserialize_with = "whole")]
    pub steps: u32,
    /// In which sense they are evenly spaced.
    #[serde(default)]
    pub scale: Scale,
}

/// In which sense numbers of a range are evenly spaced.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Scale {
    /// By the same difference.
    #[default]
    Linear,
    /// By the same ratio.
    Logarithmic,
}

impl SweepSection {
    const LIMITS: RangeInclusive<u64> = 1..=10_000_000;

    fn limit() -> u64 {
        10_000
    }

    fn cases_per_job() -> u32 {
        16
    }

    /// Whether every value may stand in a study file, without regard to objects and methods.
    pub(crate) fn check(&self, c: &Checker<'_>) -> Result<(), ConfigError> {
        if self.cells.is_empty() {
            return c.refuse("sweep.cells", "[]", "must list at least one");
        }
        for (i, &cells) in self.cells.iter().enumerate() {
            c.count(&format!("sweep.cells[{i}]"), cells, 4, 2048)?;
            // In step with other lists a resolution may come again.
            if i > 0 && self.combine == Combine::Crossed && cells <= self.cells[i - 1] {
                let limit = format!("must be above sweep.cells[{}] = {}", i - 1, self.cells[i - 1]);
                return c.refuse(format!("sweep.cells[{i}]"), cells, limit);
            }
        }
        if !Self::LIMITS.contains(&self.limit) {
            let limit = format!("must lie between {} and {}", Self::LIMITS.start(), Self::LIMITS.end());
            return c.refuse("sweep.limit", self.limit, limit);
        }
        c.count("sweep.cases_per_job", self.cases_per_job, 1, 100_000)?;
        c.count("sweep.times", self.times, 0, 100_000)?;
        for (i, setting) in self.settings.iter().enumerate() {
            setting.check(c, &format!("sweep.settings[{i}]"))?;
        }
        Ok(())
    }
}

impl SettingSection {
    fn check(&self, c: &Checker<'_>, key: &str) -> Result<(), ConfigError> {
        if self.objects.is_empty() == self.methods.is_empty() {
            let limit = "needs objects or methods whose key it is, and not both";
            return c.refuse(format!("{key}.key"), &self.key, limit);
        }
        let names: Vec<&str> = self.key.split('.').collect();
        if names.iter().any(|name| name.is_empty()) {
            let limit = "must be the name of a key, with dots between tables, such as \"field.seed\"";
            return c.refuse(format!("{key}.key"), format!("{:?}", self.key), limit);
        }
        let taken: &[&str] = match self.objects.is_empty() {
            true => &["kind"],
            false => &["id", "name", "benchmark_spacing", "stimulus_spacing"],
        };
        if taken.contains(&names[0]) {
            let limit = match names[0] {
                "benchmark_spacing" | "stimulus_spacing" => "is not varied: sweep.cells has the resolutions",
                _ => "is not varied: list another object or method",
            };
            return c.refuse(format!("{key}.key"), &self.key, limit);
        }
        match &self.range {
            Some(_) if !self.values.is_empty() => {
                c.refuse(format!("{key}.range"), "{...}", "goes without values")
            }
            Some(range) => range.check(c, &format!("{key}.range")),
            None if self.values.is_empty() => {
                c.refuse(format!("{key}.values"), "[]", "must list at least one, or a range be given")
            }
            None => self.check_values(c, key),
        }
    }

    fn check_values(&self, c: &Checker<'_>, key: &str) -> Result<(), ConfigError> {
        let written: Vec<String> = self.values.iter().map(ToString::to_string).collect();
        let kind = |value: &toml::Value| match value {
            toml::Value::Integer(_) | toml::Value::Float(_) => "number",
            other => other.type_str(),
        };
        for (i, value) in self.values.iter().enumerate() {
            if kind(value) != kind(&self.values[0]) {
                let limit = format!("must be of one kind with {key}.values[0] = {}", written[0]);
                return c.refuse(format!("{key}.values[{i}]"), &written[i], limit);
            }
        }
        Ok(())
    }

    /// Its values, one by one.
    pub(crate) fn all(&self) -> Vec<toml::Value> {
        self.range.as_ref().map_or_else(|| self.values.clone(), RangeSection::all)
    }
}

impl RangeSection {
    fn check(&self, c: &Checker<'_>, key: &str) -> Result<(), ConfigError> {
        for (name, value) in [("from", &self.from), ("to", &self.to)] {
            let Some(number) = number(value) else {
                return c.refuse(format!("{key}.{name}"), value, "must be a number");
            };
            c.number(&format!("{key}.{name}"), number, -1e9, 1e9)?;
            if self.scale == Scale::Logarithmic {
                c.positive(&format!("{key}.{name}"), number, 1e9)?;
            }
        }
        c.count(&format!("{key}.steps"), self.steps, 2, 100_000)?;
        let values = self.all();
        match (1..values.len()).find(|&i| values[i] == values[i - 1]) {
            None => Ok(()),
            Some(i) => {
                let limit = format!("gives {} twice: fewer steps, or ends that lie further apart", values[i]);
                c.refuse(format!("{key}.steps"), self.steps, limit)
            }
        }
    }

    fn all(&self) -> Vec<toml::Value> {
        let is_whole = self.from.is_integer() && self.to.is_integer();
        let [from, to] = [&self.from, &self.to].map(|end| number(end).unwrap_or(f64::NAN));
        let last = f64::from(self.steps.max(2) - 1);
        let value = |step: u32| {
            let share = f64::from(step) / last;
            let value = match self.scale {
                // The ends are met exactly.
                _ if step == 0 => from,
                _ if f64::from(step) == last => to,
                Scale::Linear => from + share * (to - from),
                Scale::Logarithmic => from * (to / from).powf(share),
            };
            match is_whole {
                true => toml::Value::Integer(value.round() as i64),
                // What is left of rounding, such as 0.30000000000000004, is nobody's choice.
                false => toml::Value::Float(rounded(value)),
            }
        };
        (0..self.steps).map(value).collect()
    }
}

/// To 12 digits.
fn rounded(value: f64) -> f64 {
    format!("{value:.11e}").parse().unwrap_or(value)
}

fn number(value: &toml::Value) -> Option<f64> {
    match value {
        toml::Value::Integer(number) => Some(*number as f64),
        toml::Value::Float(number) => Some(*number),
        _ => None,
    }
}
