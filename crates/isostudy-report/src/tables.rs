//! Every table of a study.

mod accuracy;
pub(crate) mod agreement;
mod answers;
pub(crate) mod attributes;
pub(crate) mod audit;
pub(crate) mod benchmark;
pub(crate) mod cases;
mod chunks;
pub(crate) mod contrasts;
mod decision;
pub(crate) mod design;
pub(crate) mod glance;
mod likings;
mod mesh_quality;
pub(crate) mod models;
mod omnibus;
mod parts;
pub(crate) mod power;
mod prediction;
pub(crate) mod preferences;
pub(crate) mod scale;
pub(crate) mod screened;
pub(crate) mod screens;
mod stored;
mod ways;

use isostudy_inference::{Preferences, Results};
use isostudy_table::Table;

/// Every table whose inputs are there.
pub fn tables(results: &Results<'_>) -> Vec<Table> {
    let inputs = &results.inputs;
    let mut tables = vec![design::methods(inputs.study), design::configurations(inputs)];
    tables.extend(design::programs(inputs));
    tables.extend(design::left_out(inputs));
    tables.extend(benchmark::benchmark(inputs));
    tables.extend(chunks::chunks(inputs));
    tables.extend(stored::stored(inputs));
    tables.extend(design::questionnaire(inputs.study));
    if let Some((answers, preferences)) = inputs.answers.zip(results.preferences.as_ref()) {
        tables.extend(answers::answers(inputs.study, &answers.responses, &answers.excluded));
        tables.push(answers::counts(inputs.study, &answers.tally, answers.sides_differ()));
        tables.extend(preferences::all(inputs.study, &answers.tally));
        tables.extend(of_preferences(preferences));
        let prediction = results.prediction.iter();
        let prediction = prediction.flat_map(|found| prediction::all(inputs.study, found));
        tables.extend(prediction.filter(|table| !table.rows.is_empty()));
    }
    tables.extend(likings::likings(results));
    tables.extend(mesh_quality::quality(inputs));
    tables.extend(mesh_quality::topology(inputs));
    tables.extend(accuracy::accuracy(inputs));
    tables.extend(decision::tables(results));
    tables
}

/// What answers alone tell: tests, models, agreement, screening. Tables without rows are left out.
pub(crate) fn of_preferences(preferences: &Preferences<'_>) -> Vec<Table> {
    let shown_ms = preferences.recorded.protocol().shown_ms;
    let mut tables: Vec<Table> = glance::contrasts(&preferences.concluded()).into_iter().collect();
    tables.push(contrasts::tests(&preferences.hypotheses, &preferences.robustness));
    tables.extend(preferences.study.map(|study| omnibus::omnibus(study, &preferences.omnibus)));
    tables.extend(models::model_tables(&preferences.models, preferences.responses.sides_recorded));
    tables.push(ways::ways(&preferences.ways, &preferences.models));
    tables.extend(scale::tables(&preferences.scales));
    tables.extend(attributes::tables(&preferences.attributed));
    tables.extend(preferences.study.map(|study| agreement::agreement(study, &preferences.agreement)));
    tables.extend([
        agreement::respondents(&preferences.respondents, preferences.excluded, shown_ms),
        screened::screened(&preferences.screened),
        audit::audit_table(&preferences.audit),
        screens::screens(&preferences.screens),
    ]);
    tables.retain(|table| !table.rows.is_empty());
    tables
}
