//! What may stand in each section of a study file.

use super::configuration;
use crate::check::{Checker, ConfigError, short};
use crate::config::{FormsSection, MOST_STEPS, Presentation, StudyFile, ThreadSweepSection, Way};
use crate::contrast::contrasts;
use crate::forms::{fewest, several};
use crate::method::is_summed;
use crate::study::{Configuration, Study};
use crate::texts::blanks;
use crate::wording::did_you_mean;
use crate::{Arrangement, MethodId};
use std::collections::BTreeSet;

/// Everything that does not need another section to judge.
pub(super) fn check_sections(c: &Checker<'_>, file: &StudyFile) -> Result<(), ConfigError> {
    if file.schema != 1 {
        return c.refuse("schema", file.schema, "this version reads schema 1");
    }
    let id = &file.study.id;
    let plain = |b: u8| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'-';
    if id.is_empty() || id.len() > 64 || !id.bytes().all(plain) {
        return c.refuse("study.id", id, "must be 1 to 64 lower-case letters, digits or hyphens");
    }
    c.positive("limits.memory_gib", file.limits.memory_gib, 1024.0)?;
    if let Some(hours) = file.limits.hours {
        c.positive("limits.hours", hours, 1000.0)?;
    }
    check_arrangements(c, file)?;

    let t = &file.turntable;
    c.count("turntable.width", t.width, 16, 4096)?;
    c.count("turntable.height", t.height, 16, 4096)?;
    c.count("turntable.frames", t.frames, 1, 3600)?;
    c.number("turntable.duration_s", t.duration_s, 0.01, 600.0)?;
    let delay_cs = t.delay_cs();
    // Browsers show a frame of 1 centisecond for 10, so that a turn would take ten times as long as everything here takes it to.
    if !(2.0..=65535.0).contains(&delay_cs) {
        return c.refuse(
            "turntable.duration_s",
            short(t.duration_s),
            format!(
                "gives each of {} frames {delay_cs} cs; a GIF holds up to 65535 cs, and browsers slow down what has less \
                 than 2: at least {} s, or fewer frames",
                t.frames,
                f64::from(t.frames) / 50.0
            ),
        );
    }
    c.number("turntable.elevation_rad", t.elevation_rad, -1.5, 1.5)?;
    c.positive("turntable.near", t.near, 1e3)?;
    c.positive("turntable.far", t.far, 1e9)?;
    if t.far <= t.near {
        let limit = format!("must be above turntable.near = {}", short(t.near));
        return c.refuse("turntable.far", short(t.far), limit);
    }
    c.count("turntable.supersampling", t.supersampling, 1, 4)?;

    let s = &file.shading;
    c.numbers("shading.light", &s.light, -10.0, 10.0)?;
    for (key, colour) in [
        ("shading.lit", &s.lit),
        ("shading.shade", &s.shade),
        ("shading.highlight", &s.highlight),
        ("shading.background", &s.background),
    ] {
        c.numbers(key, colour, 0.0, 1.0)?;
    }
    c.number("shading.ambient", s.ambient, 0.0, 1.0)?;
    c.positive("shading.error_scale", s.error_scale, 10.0)?;
    c.number("shading.crease_deg", s.crease_deg, 0.0, 180.0)?;
    c.count("stimuli.pair_scale", file.stimuli.pair_scale, 1, 4)?;
    file.viewer.as_ref().map_or(Ok(()), |viewer| viewer.check(c))?;

    let b = &file.benchmark;
    c.count("benchmark.warmup", b.warmup, 0, 10_000)?;
    c.count("benchmark.iterations", b.iterations, 1, 100_000)?;
    c.count("benchmark.short_iterations", b.short_iterations, 1, 100_000)?;
    c.count("benchmark.aa_iterations", b.aa_iterations, 0, 100_000)?;
    c.count("benchmark.threads", b.threads, 0, 1024)?;
    c.count("benchmark.chunks", b.chunks, 0, 1024)?;
    for (i, machine) in b.machines.iter().enumerate() {
        if machine.is_empty() || machine.len() > 32 || !machine.bytes().all(plain) {
            let limit = "must be 1 to 32 lower-case letters, digits or hyphens";
            return c.refuse(format!("benchmark.machines[{i}]"), machine, limit);
        }
    }
    c.distinct(|i| format!("benchmark.machines[{i}]"), &b.machines)?;
    if !b.machines.is_empty() && b.aa_iterations == 0 {
        let limit = "benchmark.machines needs a noise floor for each machine: must be at least 1";
        return c.refuse("benchmark.aa_iterations", b.aa_iterations, limit);
    }
    b.sweep.as_ref().map_or(Ok(()), |sweep| check_sweep(c, file, sweep))
}

/// What not every arrangement has.
fn check_arrangements(c: &Checker<'_>, file: &StudyFile) -> Result<(), ConfigError> {
    for (i, &arrangement) in file.arrangements.iter().enumerate() {
        let key = format!("arrangements[{i}]");
        if let Some(&clustering) = file.clusterings.iter().find(|&&c| !arrangement.supports(c)) {
            let limit = format!(
                "has no clustering \"{}\", which clusterings lists; it goes with none and edge-collapse",
                clustering.label()
            );
            return c.refuse(key, arrangement.label(), limit);
        }
        let is_published = matches!(arrangement, Arrangement::BodyCentred | Arrangement::SimpleCubic);
        let summed = file.extraction.as_ref().is_some_and(is_summed);
        if !is_published && summed {
            return c.refuse(key, arrangement.label(), "needs extraction.positions = \"indexed\"");
        }
    }
    Ok(())
}

fn check_sweep(c: &Checker<'_>, file: &StudyFile, sweep: &ThreadSweepSection) -> Result<(), ConfigError> {
    let known: Vec<&str> = file.objects.iter().map(|object| object.id.as_str()).collect();
    if sweep.objects.is_empty() {
        return c.refuse("benchmark.sweep.objects", "[]", "must list at least one object");
    }
    for (i, object) in sweep.objects.iter().enumerate() {
        if !known.contains(&object.as_str()) {
            let meant = did_you_mean(object, known.iter().copied());
            let limit = format!("must be an object of this study: {}{meant}", known.join(", "));
            return c.refuse(format!("benchmark.sweep.objects[{i}]"), object, limit);
        }
    }
    c.distinct(|i| format!("benchmark.sweep.objects[{i}]"), &sweep.objects)?;
    for (name, values, low, high) in [("cells", &sweep.cells, 4, 2048), ("threads", &sweep.threads, 1, 1024)]
    {
        let key = |i: usize| format!("benchmark.sweep.{name}[{i}]");
        if values.is_empty() {
            return c.refuse(format!("benchmark.sweep.{name}"), "[]", "must list at least one");
        }
        for (i, &value) in values.iter().enumerate() {
            c.count(&key(i), value, low, high)?;
            if i > 0 && value <= values[i - 1] {
                return c.refuse(key(i), value, format!("must be above {} = {}", key(i - 1), values[i - 1]));
            }
        }
    }
    c.count("benchmark.sweep.iterations", sweep.iterations, 1, 100_000)
}

pub(super) fn check_stills(
    c: &Checker<'_>,
    file: &StudyFile,
    configurations: &[Configuration],
) -> Result<(), ConfigError> {
    let ids: Vec<String> = file.stills.iter().map(|still| still.id.clone()).collect();
    c.distinct(|i| format!("stills[{i}].id"), &ids)?;
    for (i, still) in file.stills.iter().enumerate() {
        let key = |name: &str| format!("stills[{i}].{name}");
        let plain = |b: u8| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_';
        if still.id.is_empty() || !still.id.bytes().all(plain) {
            return c.refuse(key("id"), &still.id, "must be lower-case letters, digits or underscores");
        }
        configuration(c, &key("configuration"), &still.configuration, configurations)?;
        c.length(&key("spacing"), still.spacing, 1e6)?;
        if still.looks.is_empty() {
            return c.refuse(key("looks"), "[]", "must list at least one look");
        }
    }
    Ok(())
}

/// Texts of answers: as many as the way to ask has.
fn check_choices(
    c: &Checker<'_>,
    forms: &FormsSection,
    key: &str,
    texts: Option<&Vec<String>>,
) -> Result<(), ConfigError> {
    let Some(texts) = texts else { return Ok(()) };
    let way = forms.way.code();
    if forms.way == Way::Ratings || (forms.way.is_best() && key != "forms.choices") {
        let limit = format!("must be left out: forms.way = \"{way}\" has no such texts");
        return c.refuse(key, format!("{texts:?}"), limit);
    }
    let wanted = forms.way.answers_of(forms.steps, forms.none).len();
    if texts.len() != wanted {
        let limit = format!("must be {wanted} texts: forms.way = \"{way}\" has as many answers");
        return c.refuse(key, format!("{texts:?}"), limit);
    }
    c.texts(key, texts)
}

/// What is needed where a server chooses questions: answers to pairs, of which none is asked about twice.
fn check_adaptive(c: &Checker<'_>, forms: &FormsSection) -> Result<(), ConfigError> {
    if !matches!(forms.way, Way::Pairs | Way::Forced) {
        let limit =
            format!("goes with forms.way = \"pairs\" and \"forced\", and not \"{}\"", forms.way.code());
        return c.refuse("forms.adaptive", "true", limit);
    }
    if forms.repeats > 0 {
        return c.refuse(
            "forms.repeats",
            forms.repeats,
            "must be 0 with forms.adaptive: nothing is asked twice",
        );
    }
    Ok(())
}

/// What those need who do not ask about pairs, without what needs the study's configurations.
fn check_several(c: &Checker<'_>, forms: &FormsSection) -> Result<(), ConfigError> {
    if forms.controls > 0 {
        let limit = format!("must be 0: forms.way = \"{}\" shows nothing beside itself", forms.way.code());
        return c.refuse("forms.controls", forms.controls, limit);
    }
    if forms.max_questions <= forms.repeats {
        let limit = format!("must be below forms.max_questions = {}", forms.max_questions);
        return c.refuse("forms.repeats", forms.repeats, limit);
    }
    Ok(())
}

/// What those need who do not ask about pairs.
pub(super) fn check_shown(c: &Checker<'_>, study: &Study) -> Result<(), ConfigError> {
    let Some(forms) = study.file.forms.as_ref().filter(|forms| !forms.way.is_of_pairs()) else {
        return Ok(());
    };
    let Some((least, object)) = fewest(study) else { return Ok(()) };
    if least < forms.way.shown() {
        let id = &study.file.objects[object].id;
        let limit = format!("needs as many methods on each object; the comparisons have {least} on {id}");
        return c.refuse("forms.way", forms.way.code(), limit);
    }
    let room = forms.max_questions - forms.repeats;
    let asked = u32::try_from(several(study, forms.way)).unwrap_or(u32::MAX);
    let smallest = asked / asked.div_ceil(room).max(1);
    if forms.repeats > smallest {
        let limit = format!("a form has {smallest} questions that can be repeated");
        return c.refuse("forms.repeats", forms.repeats, limit);
    }
    Ok(())
}

pub(super) fn check_forms(
    c: &Checker<'_>,
    file: &StudyFile,
    configurations: &[Configuration],
) -> Result<(), ConfigError> {
    let Some(forms) = &file.forms else { return Ok(()) };
    if file.comparisons.is_empty() {
        return c.refuse("comparisons", "[]", "[forms] needs something to ask: must list at least one");
    }
    let comparisons = u32::try_from(file.comparisons.len()).unwrap_or(u32::MAX);
    c.count("forms.participants", forms.participants, 1, 100_000)?;
    c.count("forms.controls", forms.controls, 0, configurations.len() as u32)?;
    c.count("forms.max_questions", forms.max_questions, forms.controls + 1, 10_000)?;
    if !forms.way.is_of_pairs() {
        check_several(c, forms)?;
    }
    // The smallest block must hold what is repeated in it.
    let holds = |repeats: u32| match (forms.max_questions - forms.controls).checked_sub(repeats) {
        None | Some(0) => false,
        Some(room) => comparisons / comparisons.div_ceil(room).max(1) >= repeats,
    };
    if forms.way.is_of_pairs() && !holds(forms.repeats) {
        let most = (0..forms.repeats).rev().find(|&repeats| holds(repeats)).unwrap_or(0);
        let limit = format!("with forms.max_questions = {} at most {most} fit", forms.max_questions);
        return c.refuse("forms.repeats", forms.repeats, limit);
    }
    if forms.adaptive {
        check_adaptive(c, forms)?;
    }
    c.text("forms.prompt", &forms.prompt, "must say what is asked about each pair")?;
    check_choices(c, forms, "forms.choices", Some(&forms.choices).filter(|texts| !texts.is_empty()))?;
    c.text("forms.consent", &forms.consent, "must be a text")?;
    c.text("forms.instructions", &forms.instructions, "must be a text")?;
    c.count("forms.page_scale", forms.page_scale, 1, 4)?;
    c.count("forms.web_mb", forms.web_mb, 1, 100_000)?;
    if let Some(folder) = forms.three.as_ref().filter(|folder| folder.trim().is_empty()) {
        return c.refuse("forms.three", folder, "must name a folder");
    }
    if forms.stimulus == Presentation::Model && file.three().is_none() {
        let limit = "needs forms.three, the folder where `make three` puts the library that draws models";
        return c.refuse("forms.stimulus", "model", limit);
    }
    if forms.stimulus == Presentation::Model && !forms.way.is_of_pairs() {
        let limit = "shows two surfaces, and forms.way does not ask about two";
        return c.refuse("forms.stimulus", "model", limit);
    }
    if let Some(least) = forms.min_surface_px {
        c.count("forms.min_surface_px", least, 16, 4096)?;
    }
    check_choices(c, forms, "forms.choices_stacked", forms.choices_stacked.as_ref())?;
    c.count("forms.steps", forms.steps, 2, MOST_STEPS)?;
    if let Some(ends) = &forms.ends {
        c.texts("forms.ends", ends)?;
    }
    for (key, completion) in [
        ("forms.completion", &forms.completion),
        ("forms.completion_withdrawn", &forms.completion_withdrawn),
        ("forms.completion_screened", &forms.completion_screened),
        ("forms.completion_full", &forms.completion_full),
    ] {
        completion.as_ref().map_or(Ok(()), |completion| check_completion(c, key, completion, forms))?;
    }
    for (key, text) in [("forms.contact", &forms.contact), ("forms.ethics", &forms.ethics)] {
        text.as_ref().map_or(Ok(()), |text| c.text(key, text, "must be a text"))?;
    }
    if let Some(age) = forms.least_age {
        c.count("forms.least_age", age, 1, 120)?;
    }
    if let Some(days) = forms.retention_days {
        c.count("forms.retention_days", days, 1, 36_500)?;
    }
    if let Some(most) = forms.per_form {
        c.count("forms.per_form", most, 1, 100_000)?;
    }
    c.count("forms.training", forms.training.len() as u32, 0, 100)?;
    for (i, pair) in file.forms.iter().flat_map(|forms| &forms.training).enumerate() {
        for (name, id) in [("left", &pair.left), ("right", &pair.right)] {
            configuration(c, &format!("forms.training[{i}].{name}"), id, configurations)?;
        }
        if pair.left.object != pair.right.object {
            let limit = format!("must show the same object as the left side, {}", pair.left);
            return c.refuse(format!("forms.training[{i}].right"), &pair.right, limit);
        }
    }
    Ok(())
}

/// A code, or an address that may repeat what the panel said in the address of the page.
fn check_completion(
    c: &Checker<'_>,
    key: &str,
    completion: &str,
    forms: &FormsSection,
) -> Result<(), ConfigError> {
    let code = completion.chars().all(|letter| letter.is_ascii_alphanumeric() || letter == '-');
    if completion.is_empty() || completion.len() > 500 || !(code || completion.starts_with("https://")) {
        return c.refuse(key, completion, "letters, digits and hyphens, or an https:// address; up to 500");
    }
    let names = forms.panel.names();
    match blanks(completion).into_iter().find(|blank| !names.contains(&Some(blank))) {
        None => Ok(()),
        Some(blank) => {
            let mut known: Vec<&str> = names.into_iter().flatten().collect();
            known.dedup();
            let limit = format!("has {{{blank}}}, and forms.panel knows {{{}}}", known.join("}, {"));
            c.refuse(key, completion, limit)
        }
    }
}

/// Whether the study has the contrasts that it calls primary.
pub(super) fn check_primary(c: &Checker<'_>, study: &Study) -> Result<(), ConfigError> {
    let primary = &study.file.analysis.primary;
    if primary.is_empty() {
        return Ok(());
    }
    let known: Vec<String> = contrasts(study).iter().map(ToString::to_string).collect();
    match primary.iter().position(|name| !known.contains(name)) {
        None => Ok(()),
        Some(i) => {
            let meant = did_you_mean(&primary[i], known.iter().map(String::as_str));
            let all = known.join(", ");
            let limit = match &*meant {
                "" => format!("is not a contrast of this study, which has: {all}"),
                meant => format!("is not a contrast of this study{meant} It has: {all}"),
            };
            c.refuse(format!("analysis.primary[{i}]"), &primary[i], limit)
        }
    }
}

/// Whether the last look of a stopping rule is at all participants of the plan.
pub(super) fn check_stopping(c: &Checker<'_>, study: &Study) -> Result<(), ConfigError> {
    let Some(stopping) = &study.file.analysis.stopping else { return Ok(()) };
    let Some(forms) = &study.file.forms else {
        return c.refuse(
            "analysis.stopping",
            format!("{:?}", stopping.looks),
            "needs [forms]: who is asked?",
        );
    };
    match stopping.looks.last() {
        Some(&last) if last == forms.participants => Ok(()),
        _ => {
            let limit = format!("must end with forms.participants = {}", forms.participants);
            c.refuse("analysis.stopping.looks", format!("{:?}", stopping.looks), limit)
        }
    }
}

/// Whether the study compares the method that its analysis calls the reference.
pub(super) fn check_reference(c: &Checker<'_>, study: &Study) -> Result<(), ConfigError> {
    let Some(reference) = &study.file.analysis.reference else { return Ok(()) };
    let sides =
        study.comparisons.iter().flat_map(|comparison| [comparison.left.method, comparison.right.method]);
    let compared: BTreeSet<MethodId> = sides.collect();
    if compared.iter().any(|method| method.as_str() == reference) {
        return Ok(());
    }
    let known: Vec<&str> = compared.iter().map(MethodId::as_str).collect();
    let meant = did_you_mean(reference, known.iter().copied());
    let limit = format!("is not a method that this study compares, which are: {}{meant}", known.join(", "));
    c.refuse("analysis.reference", reference, limit)
}
