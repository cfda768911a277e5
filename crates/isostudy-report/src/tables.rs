//! Every table of a study.

mod accuracy;
pub(crate) mod agreement;
mod answers;
pub(crate) mod audit;
pub(crate) mod benchmark;
mod chunks;
pub(crate) mod contrasts;
mod decision;
pub(crate) mod design;
pub(crate) mod glance;
mod mesh_quality;
pub(crate) mod models;
mod omnibus;
pub(crate) mod power;
mod prediction;
pub(crate) mod preferences;
pub(crate) mod scale;
pub(crate) mod screened;
pub(crate) mod screens;

use isostudy_inference::answered::Answered;
use isostudy_inference::audit as probes;
use isostudy_inference::ballots::ALL_METHODS;
use isostudy_inference::glance::rows;
use isostudy_inference::inputs::Inputs;
use isostudy_inference::prediction::Prediction;
use isostudy_inference::recorded::Recorded;
use isostudy_table::Table;

/// Every table whose inputs are there, in the order of the paper's and then our own.
pub fn tables(inputs: &Inputs<'_>) -> Vec<Table> {
    let mut tables = vec![design::methods(inputs.study), design::configurations(inputs)];
    tables.extend(design::programs(inputs));
    tables.extend(design::left_out(inputs));
    tables.extend(benchmark::benchmark(inputs));
    tables.extend(chunks::chunks(inputs));
    tables.extend(design::questionnaire(inputs.study));
    if let Some(answers) = inputs.answers {
        tables.extend(answers::answers(inputs.study, &answers.responses, &answers.excluded));
        tables.push(answers::counts(inputs.study, &answers.tally, answers.sides_differ()));
        tables.extend(preferences::all(inputs.study, &answers.tally));
        tables.extend(statistics(inputs, answers));
    }
    tables.extend(mesh_quality::quality(inputs));
    tables.extend(mesh_quality::topology(inputs));
    tables.extend(accuracy::accuracy(inputs));
    tables.extend(decision::tables(inputs));
    tables
}

/// What holds up beside the factors: tests, models, agreement, screening, and what predicts preference.
fn statistics(inputs: &Inputs<'_>, answers: &Answered) -> Vec<Table> {
    let study = inputs.study;
    let Answered { shown, declared, groups, hypotheses, .. } = answers;
    let everyone = answers.everyone(study);
    // What the groups compare, all methods compare again.
    let probed = match groups.split_last() {
        Some((last, others)) if last.name == ALL_METHODS => others,
        _ => groups,
    };
    let recorded = Recorded::of_study(study, &answers.responses, &everyone);
    let (models, ([respondents, screened], audited)) = rayon::join(
        || models::model_tables(groups, answers.responses.sides_recorded),
        || {
            rayon::join(
                || {
                    let respondents = agreement::respondents(
                        recorded.ballots(),
                        &recorded.protocol(),
                        answers.excluded.len(),
                    );
                    [respondents, screened::of_study(study, answers, &recorded)]
                },
                || audit::audit_table(&probes::audit(&recorded.audited(probed))),
            )
        },
    );
    let glance = glance::contrasts(&rows(Some(study), hypotheses));
    let mut tables: Vec<Table> = glance.into_iter().collect();
    tables.extend([contrasts::study_tests(hypotheses), omnibus::omnibus(study, declared)]);
    tables.extend(models);
    tables.extend(scale::tables(&isostudy_inference::scale::scales(groups)));
    tables.push(agreement::agreement(study, declared));
    tables.extend([respondents, screened, audited, screens::screens(&answers.responses)]);
    let prediction = Prediction::of(inputs, shown, declared);
    tables.extend(prediction.iter().flat_map(|found| prediction::all(study, found)));
    tables.retain(|table| !table.rows.is_empty());
    tables
}
