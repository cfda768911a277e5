//! Every table of a study.

mod accuracy;
pub(crate) mod agreement;
mod answers;
pub(crate) mod audit;
mod benchmark;
pub(crate) mod contrasts;
mod design;
mod mesh_quality;
pub(crate) mod models;
pub(crate) mod power;
mod prediction;
pub(crate) mod preferences;
pub(crate) mod screened;

use crate::inputs::Inputs;
use crate::prediction::Prediction;
use crate::recorded::Recorded;
use crate::table::Table;
use crate::tally::Tally;
use crate::{audit as probes, ballots, claims, comparison};
use responses::Responses;

/// Every table whose inputs are there, in the order of the paper's and then our own.
pub fn tables(inputs: &Inputs<'_>) -> Vec<Table> {
    let tally = Tally::of_inputs(inputs);
    let tally = tally.as_ref();
    let mut tables = vec![design::configurations(inputs.study)];
    tables.extend(benchmark::benchmark(inputs));
    tables.extend(benchmark::asteroid(inputs));
    tables.extend(design::questionnaire(inputs.study));
    if let (Some(answers), Some(tally)) = (inputs.answers, tally) {
        tables.extend(answers::answers(inputs.study, answers));
        tables.push(answers::counts(inputs.study, tally));
        tables.extend(preferences::all(inputs.study, tally));
        tables.extend(statistics(inputs, answers));
    }
    tables.extend(mesh_quality::quality(inputs));
    tables.extend(mesh_quality::topology(inputs));
    tables.extend(accuracy::accuracy(inputs));
    tables.extend(mesh_quality::positions(inputs));
    tables.extend(comparison::tables(inputs, tally));
    tables.extend(claims::table(inputs, tally));
    tables
}

/// What holds up beside the factors: tests, models, agreement, screening, and what predicts preference.
fn statistics(inputs: &Inputs<'_>, answers: &Responses) -> Vec<Table> {
    let study = inputs.study;
    let ballots = ballots::ballots(study, answers);
    let groups = ballots::ballot_groups(study, &ballots);
    let mut tables = vec![contrasts::study_tests(study, &ballots), contrasts::omnibus(study, &ballots)];
    tables.extend(models::model_tables(&groups));
    let recorded = Recorded::of_study(study, answers, &ballots);
    tables.push(agreement::agreement(study, &ballots));
    tables.push(agreement::respondents(recorded.ballots(), &recorded.protocol()));
    tables.push(screened::of_study(study, &ballots, &recorded));
    tables.push(audit::audit_table(&probes::audit(&recorded.audited(&groups))));
    let prediction = Prediction::of(inputs, &ballots);
    tables.extend(prediction.iter().flat_map(|found| prediction::all(study, found)));
    tables.retain(|table| !table.rows.is_empty());
    tables
}

#[cfg(test)]
mod tests;
