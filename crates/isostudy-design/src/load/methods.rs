//! The methods of a study and the factors in which they differ, from either form that a file may write them in.

use crate::check::{Checker, ConfigError};
use crate::config::{FactorSection, LevelSection, MethodSection, StudyFile};
use crate::method::{FactorSpec, LevelSpec, Method, expand};
use crate::study::METHOD;
use crate::wording::did_you_mean;

/// What `[[methods]]` or the short form says, checked: the factors, of which the last is [`METHOD`], and the methods.
pub(super) fn methods(
    c: &Checker<'_>,
    file: &StudyFile,
) -> Result<(Vec<FactorSpec>, Vec<Method>), ConfigError> {
    let (factors, methods) = if file.methods.is_empty() { crossed(c, file)? } else { listed(c, file)? };
    Ok(with_method(factors, methods))
}

/// The declared factors, and the one that every study has.
pub(super) fn with_method(
    mut factors: Vec<FactorSpec>,
    methods: Vec<Method>,
) -> (Vec<FactorSpec>, Vec<Method>) {
    let level = |method: &Method| LevelSpec {
        code: method.id.to_string(),
        label: method.label.clone(),
        phrase: method.phrase.clone(),
        within: format!("on {}", method.phrase),
    };
    let levels = methods.iter().map(level).collect();
    factors.push(FactorSpec {
        name: METHOD.into(),
        plural: "methods".into(),
        suffix: "-method".into(),
        levels,
    });
    (factors, methods)
}

fn crossed(c: &Checker<'_>, file: &StudyFile) -> Result<(Vec<FactorSpec>, Vec<Method>), ConfigError> {
    let arrangements: Vec<String> = file.arrangements.iter().map(|a| a.label().into()).collect();
    c.distinct(|i| format!("arrangements[{i}]"), &arrangements)?;
    let clusterings: Vec<String> = file.clusterings.iter().map(|a| a.label().into()).collect();
    c.distinct(|i| format!("clusterings[{i}]"), &clusterings)?;
    if arrangements.is_empty() || clusterings.is_empty() {
        let limit = "arrangements and clusterings must list at least one each, or [[methods]] some methods";
        return c.refuse("arrangements", "[]", limit);
    }
    if !file.factors.is_empty() {
        let limit = "goes with [[methods]]; arrangements and clusterings are factors already";
        return c.refuse("factors", "[...]", limit);
    }
    let Some(section) = &file.extraction else {
        return c.refuse("extraction", "nothing", "arrangements and clusterings need [extraction]");
    };
    Ok(expand(&file.arrangements, &file.clusterings, section))
}

fn listed(c: &Checker<'_>, file: &StudyFile) -> Result<(Vec<FactorSpec>, Vec<Method>), ConfigError> {
    for (key, given) in [
        ("arrangements", !file.arrangements.is_empty()),
        ("clusterings", !file.clusterings.is_empty()),
        ("extraction", file.extraction.is_some()),
    ] {
        if given {
            let limit = "is the short form's; a study with [[methods]] says it in each recipe";
            return c.refuse(key, "[...]", limit);
        }
    }
    let ids: Vec<String> = file.methods.iter().map(|method| method.id.to_string()).collect();
    c.distinct(|i| format!("methods[{i}].id"), &ids)?;
    let labels: Vec<String> = file.methods.iter().map(|method| method.label.clone()).collect();
    c.distinct(|i| format!("methods[{i}].label"), &labels)?;
    for (i, section) in file.methods.iter().enumerate() {
        check_budget(c, file, i, section)?;
    }
    let factors = factors(c, &file.factors)?;
    let mut methods = Vec::new();
    for (i, section) in file.methods.iter().enumerate() {
        if section.label.trim().is_empty() {
            return c.refuse(format!("methods[{i}].label"), "\"\"", "must be a text");
        }
        if let Some(name) = section.levels.keys().find(|name| factors.iter().all(|of| of.name != **name)) {
            let known: Vec<&str> = factors.iter().map(|of| of.name.as_str()).collect();
            let limit = match known[..] {
                [] => "no [[factors]] are declared".to_owned(),
                _ => {
                    let meant = did_you_mean(name, known.iter().copied());
                    format!("must name declared factors: {}{meant}", known.join(", "))
                }
            };
            return c.refuse(format!("methods[{i}].levels"), name, limit);
        }
        let mut levels = Vec::new();
        for (factor, spec) in file.factors.iter().zip(&factors) {
            let Some(named) = section.levels.get(&spec.name) else {
                levels.push(None);
                continue;
            };
            let names: Vec<&str> = factor.levels.iter().map(LevelSection::name).collect();
            let Some(place) = names.iter().position(|name| name == named) else {
                let meant = did_you_mean(named, names.iter().copied());
                let limit = format!("must be a level of this factor: {}{meant}", names.join(", "));
                return c.refuse(format!("methods[{i}].levels.{}", spec.name), named, limit);
            };
            levels.push(Some(place));
        }
        methods.push(Method {
            id: section.id,
            label: section.label.clone(),
            phrase: section.label.clone(),
            recipe: section.recipe.clone(),
            budget: section.budget,
            look: section.look,
            apart: section.apart.clone(),
            levels,
        });
    }
    Ok((factors, methods))
}

fn check_budget(
    c: &Checker<'_>,
    file: &StudyFile,
    i: usize,
    section: &MethodSection,
) -> Result<(), ConfigError> {
    let Some(budget) = section.budget else { return Ok(()) };
    let key = || format!("methods[{i}].match.{}", budget.quantity.names()[0]);
    c.number(&format!("methods[{i}].match.within"), budget.within, 0.0001, 0.5)?;
    let limit = match file.methods.iter().find(|other| other.id == budget.of) {
        Some(other) if other.id == section.id => "must name another method of this study",
        Some(other) if other.budget.is_some() => "must name a method that has no match of its own",
        Some(_) => return Ok(()),
        None => {
            let known: Vec<&str> = file.methods.iter().map(|other| other.id.as_str()).collect();
            let meant = did_you_mean(budget.of.as_str(), known.iter().copied());
            let limit = format!("must name a method of this study: {}{meant}", known.join(", "));
            return c.refuse(key(), budget.of, limit);
        }
    };
    c.refuse(key(), budget.of, limit)
}

fn factors(c: &Checker<'_>, sections: &[FactorSection]) -> Result<Vec<FactorSpec>, ConfigError> {
    let names: Vec<String> = sections.iter().map(|section| section.name.clone()).collect();
    c.distinct(|i| format!("factors[{i}].name"), &names)?;
    let mut factors = Vec::new();
    for (i, section) in sections.iter().enumerate() {
        let plain = |b: u8| b.is_ascii_lowercase() || b == b'-';
        let name = &section.name;
        if !name.starts_with(|first: char| first.is_ascii_lowercase()) || !name.bytes().all(plain) {
            return c.refuse(format!("factors[{i}].name"), name, "must be letters a-z and hyphens");
        }
        if [METHOD, "object", "all"].contains(&name.as_str()) {
            return c.refuse(format!("factors[{i}].name"), name, "is a name of the program's own");
        }
        if section.levels.len() < 2 {
            return c.refuse(format!("factors[{i}].levels"), "[...]", "must list at least two");
        }
        let levels: Vec<LevelSpec> = section.levels.iter().map(|level| spelt(name, level)).collect();
        let named = |key: &str, text: fn(&LevelSpec) -> &String| -> Result<(), ConfigError> {
            let texts: Vec<String> = levels.iter().map(|level| text(level).clone()).collect();
            if let Some(j) = texts.iter().position(|text| text.trim().is_empty()) {
                return c.refuse(format!("factors[{i}].levels[{j}].{key}"), "\"\"", "must be a text");
            }
            c.distinct(|j| format!("factors[{i}].levels[{j}].{key}"), &texts)
        };
        named("name", |level| &level.label)?;
        named("code", |level| &level.code)?;
        let taken = |level: &LevelSpec| {
            let others = factors.iter().flat_map(|of: &FactorSpec| &of.levels);
            others.into_iter().any(|other| other.code == level.code)
        };
        if let Some(j) = levels.iter().position(taken) {
            let limit = "is another factor's level too; give it a code of its own, { name = \"...\", code = \"...\" }";
            return c.refuse(format!("factors[{i}].levels[{j}]"), &levels[j].code, limit);
        }
        factors.push(FactorSpec {
            name: name.clone(),
            plural: format!("{name}s"),
            suffix: format!("-{name}"),
            levels,
        });
    }
    Ok(factors)
}

fn spelt(factor: &str, level: &LevelSection) -> LevelSpec {
    let name = level.name();
    let (code, phrase, within) = match level {
        LevelSection::Name(_) => (None, None, None),
        LevelSection::Spelt(level) => (level.code.clone(), level.phrase.clone(), level.within.clone()),
    };
    let phrase = phrase.unwrap_or_else(|| format!("{name} {factor}"));
    LevelSpec {
        code: code.unwrap_or_else(|| name.into()),
        label: name.into(),
        within: within.unwrap_or_else(|| format!("with {phrase}")),
        phrase,
    }
}
