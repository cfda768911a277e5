//! Every figure of a study, as SVG and PNG from the same drawing.

mod answers;
mod axis;
mod bars;
mod canvas;
mod distributions;
mod draft;
mod edge_groups;
mod error;
mod forest;
mod fronts;
mod glance;
mod history;
mod legend;
mod marks;
mod meshes;
mod power;
mod prediction;
mod preferences;
mod respondents;
mod scatter;
mod stages;
mod style;
mod sweep;
mod worths;

use crate::figure::Figure;
use draft::Unfinished;
pub use edge_groups::{KindShare, TableQuality, edge_groups_figure};
pub use error::FigureError;
pub use history::history_figure;
use isostudy_inference::{Preferences, Results};
pub use power::power_figure;
use rayon::prelude::*;

pub use sweep::sweep_figures;

/// Every figure whose inputs are there, in the order of the paper's and then our own.
///
/// # Errors
/// If drawing fails, which is not to be expected.
pub fn figures(results: &Results<'_>) -> Result<Vec<Figure>, FigureError> {
    drafts(results).into_par_iter().map(Unfinished::finish).collect()
}

/// The figures that need nothing but answers: contrasts, worths and respondents.
///
/// # Errors
/// If drawing fails, which is not to be expected.
pub fn figures_of_groups(preferences: &Preferences<'_>) -> Result<Vec<Figure>, FigureError> {
    let drafts = [
        glance::contrasts(&preferences.concluded()),
        worths::draft(None, &preferences.scales),
        respondents::draft(&preferences.majorities),
    ];
    drafts.into_iter().flatten().map(Unfinished::finish).collect()
}

fn drafts(results: &Results<'_>) -> Vec<Unfinished> {
    let inputs = &results.inputs;
    let mut drafts = Vec::new();
    drafts.extend(meshes::triangles(inputs));
    drafts.extend(meshes::pass_times(inputs));
    drafts.extend(meshes::radius_ratios(inputs));
    drafts.extend(meshes::aspect_ratios(inputs));
    drafts.extend(stages::stage_times(inputs));
    drafts.extend(distributions::aspect_ratios(inputs));
    drafts.extend(fronts::draft(inputs.study, &results.decision));
    if style::has_codes(inputs.study) {
        let found = " The table of methods says what the codes stand for.";
        drafts.iter_mut().for_each(|draft| draft.caption += found);
    }
    if let Some(found) = crate::budgets::budgets(inputs) {
        drafts.iter_mut().for_each(|draft| draft.caption += &format!(" {found}"));
    }
    if let Some((answered, preferences)) = inputs.answers.zip(results.preferences.as_ref()) {
        let tally = &answered.tally;
        drafts.extend(glance::contrasts(&preferences.concluded()));
        drafts.push(answers::per_question(inputs.study, tally, answered.sides_differ()));
        drafts.push(preferences::per_object(inputs.study, tally));
        drafts.push(preferences::overall(inputs.study, tally));
        drafts.extend(worths::draft(Some(inputs.study), &preferences.scales));
        drafts.extend(respondents::draft(&preferences.majorities));
        let prediction = results.prediction.as_ref();
        drafts.extend(prediction.map(|found| prediction::draft(inputs.study, found, &answered.declared)));
    }
    drafts
}

#[cfg(test)]
mod tests;
