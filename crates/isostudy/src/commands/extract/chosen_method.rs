//! A method on the command line: by its name, or by the recipe that a study file would have for it.

use crate::recipe::{StudyKind, no_kind};
use isostudy_design::wording::{nearest, plainly};
use isostudy_extract::{Method, kinds, presets};
use serde::{Deserialize, Serialize};
use toml::de::ValueDeserializer;

/// A method as reports name it.
#[derive(Debug, Serialize)]
pub(super) struct Described {
    /// The name of the preset that it is, if it is one.
    id: Option<&'static str>,
    /// The same in words.
    label: Option<&'static str>,
    /// What a study file says of it, defaults written out.
    recipe: Method,
}

impl Described {
    /// Looks for the preset that makes the same meshes.
    pub(super) fn of(method: Method) -> Self {
        let preset = presets().iter().find(|preset| preset.method == method);
        Self { id: preset.map(|of| of.id), label: preset.map(|of| of.label), recipe: method }
    }

    /// The name, or else the recipe.
    ///
    /// # Errors
    /// If the recipe cannot be written as TOML, which each can.
    pub(super) fn to_text(&self) -> Result<String, toml::ser::Error> {
        match (self.id, self.label) {
            (Some(id), Some(label)) => Ok(format!("{id}: {label}")),
            _ => Ok(toml::Value::try_from(self.recipe)?.to_string()),
        }
    }
}

/// The method of a preset's id.
///
/// # Errors
/// If no preset has it, with the nearest name.
pub(super) fn preset(id: &str) -> Result<Method, String> {
    let found = presets().iter().find(|preset| preset.id == id);
    found.map(|preset| preset.method).ok_or_else(|| {
        let meant = meant(id).map_or_else(String::new, |other| format!("; did you mean {other}?"));
        match &*meant {
            "" => {
                "no method has this name, as bi-relaxed and mc are; `isostudy methods --all` lists all".into()
            }
            meant => format!("no method has this name{meant} `isostudy methods` lists all"),
        }
    })
}

/// The preset whose id, or else whose label, is nearest to a name.
fn meant(name: &str) -> Option<&'static str> {
    let of_label = || {
        let label = nearest(name, presets().iter().map(|preset| preset.label))?;
        presets().iter().find(|preset| preset.label == label).map(|preset| preset.id)
    };
    nearest(name, presets().iter().map(|preset| preset.id)).or_else(of_label)
}

/// The method of a recipe, an inline table as in a study file.
///
/// # Errors
/// If it is no TOML, no table, or of a kind that goes with studies alone; if a key or a value is unknown, with those that are known.
pub(super) fn recipe(text: &str) -> Result<Method, String> {
    if presets().iter().any(|preset| preset.id == text) {
        return Err(format!("is the name of a method: give --method {text}"));
    }
    let value = ValueDeserializer::parse(text).and_then(toml::Value::deserialize);
    let value = value.map_err(|error| error.to_string().trim_end().to_owned())?;
    let toml::Value::Table(table) = &value else {
        return Err(
            "must be a table, such as { kind = \"tetrahedra\", arrangement = \"body-centred\" }".into()
        );
    };
    let kind = match table.get("kind") {
        Some(toml::Value::String(kind)) => kind.as_str(),
        Some(other) => return Err(format!("kind = {other}: allowed: {}", known_kinds())),
        None => return Err(format!("kind is missing; allowed: {}", known_kinds())),
    };
    if let Some(of) = StudyKind::of(kind) {
        return Err(format!("kind = \"{kind}\": {}; allowed here: {}", why_not(of), known_kinds()));
    }
    if kinds().iter().all(|known| known.name != kind) {
        return Err(no_kind(kind, false));
    }
    if table.contains_key(crate::finishing::KEY) {
        return Err("finish is for studies; give --finish STEP:KEY=VALUE,... beside the recipe".into());
    }
    // Errors in values do not say their key, for what has a kind is read twice.
    let known = Method::deserialize(value.clone()).map_err(|error| plainly(error.message()));
    known.map_err(|error| match guilty(table) {
        Some((key, value)) => format!("{key} = {value}: {error}"),
        None => error,
    })
}

/// The kinds that go without a study.
fn known_kinds() -> String {
    kinds().iter().map(|kind| format!("\"{}\"", kind.name)).collect::<Vec<_>>().join(", ")
}

/// Why a study alone can have recipes of a kind.
fn why_not(kind: StudyKind) -> &'static str {
    match kind {
        StudyKind::Program => {
            "programs are methods of a study, in whose folder they are found and by whose limits they are held; \
             see `isostudy study`"
        }
        StudyKind::Meshes => {
            "finished meshes belong to the objects of a study; what is extracted here is none of them. \
             See `isostudy study`"
        }
        StudyKind::Family(of) => of.why_in_studies,
    }
}

/// The one key whose removal mends a recipe, or whose value alone is wrong.
fn guilty(table: &toml::Table) -> Option<(&String, &toml::Value)> {
    let mended = |key: &str| {
        let mut rest = table.clone();
        rest.remove(key);
        Method::deserialize(toml::Value::Table(rest)).is_ok()
    };
    table.iter().find(|(key, _)| mended(key))
}

#[cfg(test)]
mod tests {
    use super::*;
    use isostudy_extract::{Arrangement, Placement, Tetrahedra};

    #[test]
    fn a_recipe_has_the_defaults_of_the_library() {
        let text = "{ kind = \"tetrahedra\", arrangement = \"body-centred\", placement = \"relaxed\" }";
        let relaxed = Tetrahedra::new(Arrangement::BodyCentred).with_placement(Placement::Relaxed);
        assert_eq!(recipe(text), Ok(Method::Tetrahedra(relaxed)));
        assert_eq!(preset("bi-relaxed"), recipe(text));
    }

    #[test]
    fn what_is_described_is_read_again() {
        for preset in presets() {
            let described = Described::of(preset.method);
            assert_eq!((described.id, described.label), (Some(preset.id), Some(preset.label)));
            assert_eq!(described.to_text().unwrap(), format!("{}: {}", preset.id, preset.label));
            assert_eq!(
                recipe(&toml::Value::try_from(described.recipe).unwrap().to_string()),
                Ok(preset.method)
            );
        }
        let own = Tetrahedra::new(Arrangement::SimpleCubic).with_refine_crossings(true);
        let described = Described::of(Method::Tetrahedra(own));
        assert_eq!((described.id, described.label), (None, None));
        assert_eq!(recipe(&described.to_text().unwrap()), Ok(Method::Tetrahedra(own)));
    }
}
