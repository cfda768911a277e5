//! What of the analysis is a choice, and when it was made.

use crate::check::{Checker, ConfigError, short};
use crate::date::Date;
use serde::{Deserialize, Serialize};

/// Which tests are corrected together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FamilyRule {
    /// Each kind of contrast by itself, see [`Family`](crate::contrast::Family).
    #[default]
    ByKind,
    /// All contrasts of the study.
    One,
}

/// A rule of screening whose breakers the main analysis leaves out. What breaks it is defined where answers are screened.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Exclusion {
    /// Chose one side throughout.
    OneSided,
    /// Preferred one of two equal configurations.
    Controls,
    /// Chose the other configuration when asked again.
    Repeats,
    /// Answered before everything could have been seen.
    Time,
    /// Preferred what the others did not.
    Outlying,
}

impl Exclusion {
    /// The name in study files.
    pub fn code(self) -> &'static str {
        match self {
            Self::OneSided => "one-sided",
            Self::Controls => "controls",
            Self::Repeats => "repeats",
            Self::Time => "time",
            Self::Outlying => "outlying",
        }
    }
}

/// What a test must reach at a look, but for a constant factor; statistics defines it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StoppingBoundary {
    /// Hard to cross early.
    #[serde(rename = "obrien-fleming")]
    OBrienFleming,
    /// The same at each look.
    Pocock,
}

/// Which primary contrasts decide that nobody more is asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StopWhen {
    /// All of them differ.
    #[default]
    All,
    /// One of them differs.
    Any,
}

/// When a study that runs is looked at, and when it then stops.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StoppingSection {
    /// Numbers of participants who have finished, ascending; the last is that of the plan.
    pub looks: Vec<u32>,
    /// What the tests must reach.
    pub boundary: StoppingBoundary,
    /// Which contrasts decide.
    #[serde(default)]
    pub when: StopWhen,
}

/// Looks at most: more of them would cost more than they can save.
const MOST_LOOKS: usize = 10;

impl StoppingSection {
    /// Refuses looks that nobody could keep to.
    fn check(&self, c: &Checker<'_>, primary: &[String]) -> Result<(), ConfigError> {
        let looks = &self.looks;
        let refuse = |limit: &str| c.refuse("analysis.stopping.looks", format!("{looks:?}"), limit);
        if primary.is_empty() {
            return refuse("needs analysis.primary: which differences decide?");
        }
        if !(1..=MOST_LOOKS).contains(&looks.len()) {
            return refuse(&format!("must be 1 to {MOST_LOOKS} numbers of participants"));
        }
        let (first, last) = (looks[0], looks[looks.len() - 1]);
        // Closer looks tell nothing new, and cost time to compute.
        let apart = looks.windows(2).all(|pair| pair[1].saturating_sub(pair[0]) >= last.div_ceil(50));
        if first < 2 || !apart {
            return refuse("must ascend from 2 or more, each by at least 2 % of the last");
        }
        Ok(())
    }
}

/// Columns of people at most: each is a test, for which all are corrected.
const MOST_COLUMNS: usize = 20;

/// What of the analysis is a choice, and when it was made. Every key has a default.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct AnalysisSection {
    /// The day on which this section was fixed.
    pub declared: Option<Date>,
    /// The day of the first answer, where the file of answers does not say it.
    pub first_answer: Option<Date>,
    /// Whether answers were known when this section was fixed, whatever the dates say.
    pub answers_known: bool,
    /// Level of tests, after correction; 0.0001 to 0.5. Intervals are at 95 % whatever it is.
    pub level: f64,
    /// Mean score up to which two things count as liked alike; above 0, below 1.
    pub margin: f64,
    /// Which tests are corrected together.
    pub families: FamilyRule,
    /// The contrasts that matter most, such as `B-S` or `B-S within U`: a family of their own, corrected first.
    pub primary: Vec<String>,
    /// When a study that runs is looked at; without it nobody looks before its end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stopping: Option<StoppingSection>,
    /// The id of the method that stands at 0 on every scale that has it; otherwise the first of each group does.
    pub reference: Option<String>,
    /// The rules whose breakers the main analysis leaves out; empty if everybody counts.
    pub exclude: Vec<Exclusion>,
    /// A CSV file with what is known of people, by a column `participant`; otherwise that is in the file of answers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub people: Option<String>,
    /// Columns that divide people into groups, such as `expertise`, whose worths are compared.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub subgroups: Vec<String>,
    /// Columns with a number for each person, such as `age`, with which worths may go.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub covariates: Vec<String>,
}

impl Default for AnalysisSection {
    fn default() -> Self {
        Self {
            declared: None,
            first_answer: None,
            answers_known: false,
            level: 0.05,
            margin: 0.2,
            families: FamilyRule::ByKind,
            primary: Vec::new(),
            stopping: None,
            reference: None,
            exclude: Vec::new(),
            people: None,
            subgroups: Vec::new(),
            covariates: Vec::new(),
        }
    }
}

/// Whether the choices of an analysis could have been made to fit the answers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Declaration {
    /// The study does not say when they were made.
    Undeclared,
    /// They were made on the day of the first answer at the latest.
    BeforeAnswers {
        /// The day on which they were made.
        declared: Date,
        /// The day of the first answer.
        first_answer: Date,
    },
    /// They were made when answers were known.
    AfterAnswers {
        /// The day on which they were made.
        declared: Date,
        /// The day of the first answer; `None` if the study says only that answers were known.
        first_answer: Option<Date>,
    },
    /// The study says when they were made, and nothing says when the first answer was given.
    Unknown {
        /// The day on which they were made.
        declared: Date,
    },
}

impl AnalysisSection {
    /// Holds [`declared`](Self::declared) against the first answer's day: `in_answers` is the day that the answers
    /// themselves say. Where the study says another, the earlier of the two counts.
    pub fn declaration(&self, in_answers: Option<Date>) -> Declaration {
        let Some(declared) = self.declared else { return Declaration::Undeclared };
        let first_answer = self.first_answer.into_iter().chain(in_answers).min();
        match first_answer {
            _ if self.answers_known => Declaration::AfterAnswers { declared, first_answer },
            None => Declaration::Unknown { declared },
            Some(first) if declared <= first => Declaration::BeforeAnswers { declared, first_answer: first },
            Some(_) => Declaration::AfterAnswers { declared, first_answer },
        }
    }

    /// Refuses values outside their ranges, and dates that contradict each other.
    pub(crate) fn check(&self, c: &Checker<'_>) -> Result<(), ConfigError> {
        match (self.declared, self.first_answer) {
            (None, _) if self.answers_known => {
                return c.refuse("analysis.answers_known", true, "needs analysis.declared: since when?");
            }
            (Some(declared), Some(first)) if self.answers_known && declared < first => {
                let limit = format!("before analysis.first_answer = {first} nobody knew answers");
                return c.refuse("analysis.answers_known", true, limit);
            }
            _ => {}
        }
        c.number("analysis.level", self.level, 0.0001, 0.5)?;
        if !(self.margin > 0.0 && self.margin < 1.0) {
            return c.refuse("analysis.margin", short(self.margin), "must be above 0 and below 1");
        }
        for (i, name) in self.primary.iter().enumerate() {
            let letters = name.chars().count();
            if name.trim() != name || !(1..=64).contains(&letters) || name.chars().any(char::is_control) {
                let limit = "must be the name of a contrast, such as B-S or B-S within U: 1 to 64 letters, with no \
                             space at its ends";
                return c.refuse(format!("analysis.primary[{i}]"), format!("{name:?}"), limit);
            }
        }
        c.distinct(|i| format!("analysis.primary[{i}]"), &self.primary)?;
        if let Some(stopping) = &self.stopping {
            stopping.check(c, &self.primary)?;
        }
        let rules: Vec<String> = self.exclude.iter().map(|rule| rule.code().into()).collect();
        c.distinct(|i| format!("analysis.exclude[{i}]"), &rules)?;
        self.check_people(c)
    }

    /// Columns of people, subgroups first.
    pub fn person_columns(&self) -> Vec<String> {
        self.subgroups.iter().chain(&self.covariates).cloned().collect()
    }

    fn check_people(&self, c: &Checker<'_>) -> Result<(), ConfigError> {
        let key = |i: usize| match i.checked_sub(self.subgroups.len()) {
            None => format!("analysis.subgroups[{i}]"),
            Some(i) => format!("analysis.covariates[{i}]"),
        };
        let names = self.person_columns();
        for (i, name) in names.iter().enumerate() {
            let letters = name.chars().count();
            if name.trim() != name || !(1..=64).contains(&letters) || name.chars().any(char::is_control) {
                let limit = "must be the title of a column: 1 to 64 letters, with no space at its ends";
                return c.refuse(key(i), format!("{name:?}"), limit);
            }
        }
        if names.len() > MOST_COLUMNS {
            let limit = format!("at most {MOST_COLUMNS} columns in subgroups and covariates together");
            return c.refuse("analysis.covariates", names.len(), limit);
        }
        c.distinct(key, &names)?;
        match &self.people {
            Some(path) if names.is_empty() => c.refuse(
                "analysis.people",
                format!("{path:?}"),
                "needs analysis.subgroups or analysis.covariates",
            ),
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests;
