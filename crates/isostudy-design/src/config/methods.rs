//! `[[methods]]` and `[[factors]]`: what is compared, and what it differs in.

use crate::method::{BudgetSection, MethodId, Recipe, StimulusLook};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// One method of a study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MethodSection {
    /// Its id, unique: 1 to 16 of a-z, 0-9 and hyphen, a letter first.
    pub id: MethodId,
    /// Name in tables, figures and sentences.
    pub label: String,
    /// How it makes a mesh: `kind`, and the keys of this kind. Left out where `[[stimuli.files]]` have what is shown.
    #[serde(default = "Recipe::of_files")]
    pub recipe: Recipe,
    /// What the method is an example of: names of factors to their levels.
    #[serde(default)]
    pub levels: BTreeMap<String, String>,
    /// What decides its resolution in place of the object's spacing.
    #[serde(rename = "match", skip_serializing_if = "Option::is_none")]
    pub budget: Option<BudgetSection>,
    /// How its meshes look in animations; as all do unless given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub look: Option<StimulusLook>,
    /// Why no choice names it, as that it is given less than the others; it stands in tables, figures and questions all the same.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub apart: Option<String>,
}

/// What some methods of a study differ in.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FactorSection {
    /// Its name, unique, such as `placement`: letters a-z and hyphens.
    pub name: String,
    /// Its values, at least two.
    pub levels: Vec<LevelSection>,
}

/// A value of a factor: its name alone, or with what it is called elsewhere.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum LevelSection {
    /// The name, for everything.
    Name(String),
    /// The name, and others where it does not serve.
    Spelt(SpeltLevel),
}

/// A value of a factor, with what it is called where its name does not serve.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpeltLevel {
    /// The name that methods refer to.
    pub name: String,
    /// Short, in names of contrasts; the name unless given.
    pub code: Option<String>,
    /// As a noun in sentences, such as "edge collapse"; factor and name unless given.
    pub phrase: Option<String>,
    /// Where something holds, such as "with edge collapse"; "with" and the phrase unless given.
    pub within: Option<String>,
}

impl LevelSection {
    /// The name that methods refer to.
    pub fn name(&self) -> &str {
        match self {
            Self::Name(name) => name,
            Self::Spelt(level) => &level.name,
        }
    }
}
