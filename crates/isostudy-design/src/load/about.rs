//! Questions about the person, checked.

use crate::check::{Checker, ConfigError, short};
use crate::config::{AboutKind, AboutSection, AboutTime, FormsSection};
use crate::forms::COMMENT;

/// Most questions about a person: who is asked more gives up.
const MOST: usize = 50;

/// # Errors
/// The first question that cannot be asked as it is.
pub(super) fn check(c: &Checker<'_>, forms: &FormsSection) -> Result<(), ConfigError> {
    if forms.about.len() > MOST {
        return c.refuse("forms.about", forms.about.len(), format!("at most {MOST} questions"));
    }
    let ids: Vec<String> = forms.about.iter().map(|about| about.id.clone()).collect();
    c.distinct(|i| format!("forms.about[{i}].id"), &ids)?;
    for (i, about) in forms.about.iter().enumerate() {
        let key = |name: &str| format!("forms.about[{i}].{name}");
        let plain = |b: u8| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'-';
        let begins = about.id.bytes().next().is_some_and(|b| b.is_ascii_lowercase());
        if !begins || !about.id.bytes().all(plain) || about.id.len() > 32 {
            let limit = "1 to 32 lower-case letters, digits and hyphens, a letter first";
            return c.refuse(key("id"), &about.id, limit);
        }
        if [COMMENT, "participant", "attention"].contains(&about.id.as_str()) {
            return c.refuse(key("id"), &about.id, "is the name of another column");
        }
        check_words(c, about, &key)?;
        check_range(c, about, &key)?;
        check_chosen(c, about, &key)?;
        if about.kind == AboutKind::Text && !forms.free_text {
            let limit = "takes words that can name the person; forms.free_text = true allows it";
            return c.refuse(key("kind"), "text", limit);
        }
    }
    Ok(())
}

fn is_shipped(about: &AboutSection) -> bool {
    matches!(about.kind, AboutKind::ColourVision | AboutKind::ScreenSize)
}

fn has_options(about: &AboutSection) -> bool {
    matches!(about.kind, AboutKind::Single | AboutKind::Multiple)
}

fn check_words(
    c: &Checker<'_>,
    about: &AboutSection,
    key: &dyn Fn(&str) -> String,
) -> Result<(), ConfigError> {
    match &about.ask {
        Some(_) if is_shipped(about) => {
            return c.refuse(
                key("ask"),
                "\"...\"",
                "this kind has its own question; [forms.texts] can change it",
            );
        }
        Some(ask) => c.text(&key("ask"), ask, "must be a question")?,
        None if is_shipped(about) => {}
        None => return c.refuse(key("ask"), "nothing", "must be a question"),
    }
    match (has_options(about), about.options.len()) {
        (true, 2..=50) => c.texts(&key("options"), &about.options),
        (true, count) => c.refuse(key("options"), format!("{count} texts"), "must list 2 to 50"),
        (false, 0) => Ok(()),
        (false, count) => c.refuse(key("options"), format!("{count} texts"), "this kind has none"),
    }
}

fn check_range(
    c: &Checker<'_>,
    about: &AboutSection,
    key: &dyn Fn(&str) -> String,
) -> Result<(), ConfigError> {
    let (is_number, is_scale) = (about.kind == AboutKind::Number, about.kind == AboutKind::Scale);
    for (name, given) in [("from", about.from), ("to", about.to)] {
        match given {
            Some(value) if !is_number && !is_scale => {
                return c.refuse(key(name), short(value), "this kind has none");
            }
            Some(value) => {
                c.number(
                    &key(name),
                    value,
                    if is_scale { 0.0 } else { -1e9 },
                    if is_scale { 100.0 } else { 1e9 },
                )?;
                if is_scale && value.fract() != 0.0 {
                    return c.refuse(key(name), short(value), "must be a whole step");
                }
            }
            None if is_number => {
                return c.refuse(key(name), "nothing", "a number needs both ends of its range");
            }
            None => {}
        }
    }
    let (from, to) = (about.from.unwrap_or(1.0), about.to.unwrap_or(7.0));
    if from >= to {
        return c.refuse(key("to"), short(to), format!("must be above {} = {}", key("from"), short(from)));
    }
    if is_scale && to - from > 20.0 {
        return c.refuse(key("to"), short(to), "at most 21 steps");
    }
    match &about.ends {
        Some(ends) if is_scale => c.texts(&key("ends"), ends),
        Some(_) => c.refuse(key("ends"), "[...]", "a scale alone has ends"),
        None if is_scale => {
            c.refuse(key("ends"), "nothing", "must say what the first and the last step mean")
        }
        None => Ok(()),
    }
}

/// What options do, by their numbers.
fn check_chosen(
    c: &Checker<'_>,
    about: &AboutSection,
    key: &dyn Fn(&str) -> String,
) -> Result<(), ConfigError> {
    let count = if is_shipped(about) { 4 } else { about.options.len() as u32 };
    if let Some(expected) = about.expects {
        let scale = [about.from.unwrap_or(1.0), about.to.unwrap_or(7.0)].map(|end| end as u32);
        match about.kind {
            AboutKind::Scale => c.count(&key("expects"), expected, scale[0], scale[1])?,
            _ if count > 0 => c.count(&key("expects"), expected, 1, count)?,
            _ => return c.refuse(key("expects"), expected, "this kind has no options"),
        }
    }
    for (i, &option) in about.screens_out.iter().enumerate() {
        if count == 0 {
            return c.refuse(key("screens_out"), option, "this kind has no options");
        }
        c.count(&format!("{}[{i}]", key("screens_out")), option, 1, count)?;
    }
    if !about.most.is_empty() && about.most.len() != count as usize {
        let limit = format!("must have a number for each of the {count} options");
        return c.refuse(key("most"), format!("{} numbers", about.most.len()), limit);
    }
    for (i, &most) in about.most.iter().enumerate() {
        c.count(&format!("{}[{i}]", key("most")), most, 0, 100_000)?;
    }
    if about.when == AboutTime::After && !(about.screens_out.is_empty() && about.most.is_empty()) {
        return c.refuse(key("when"), "after", "who is not wanted is told before the first pair");
    }
    Ok(())
}
