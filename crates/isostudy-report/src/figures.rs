//! Every figure of a study, as SVG and PNG from the same drawing.

mod answers;
mod axis;
mod barometer;
mod bars;
mod canvas;
mod cases;
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
mod palette;
mod power;
mod prediction;
mod preferences;
mod respondents;
mod scatter;
mod sheet;
mod stages;
mod style;
mod sweep;
mod worths;

use crate::figure::Figure;
pub use barometer::{EnginePoint, barometer_figure};
use draft::Unfinished;
pub use edge_groups::{KindShare, TableQuality, edge_groups_figure};
pub use error::FigureError;
pub use history::history_figure;
use isostudy_inference::{Preferences, Results};
pub use power::power_figure;
use rayon::prelude::*;
use sheet::Sheet;

pub use cases::case_figures;
pub use sweep::sweep_figures;

/// What a page shows first, of whatever there is: contrasts over all answers, else the fronts of one object.
pub const OVERVIEW: &str = "overview";

/// Every figure whose inputs are there, in the order of the paper's and then our own.
///
/// # Errors
/// If drawing fails, which is not to be expected.
pub fn figures(results: &Results<'_>) -> Result<Vec<Figure>, FigureError> {
    both(|sheet| drafts(results, sheet))
}

/// The figures that need nothing but answers: contrasts, worths and respondents.
///
/// # Errors
/// If drawing fails, which is not to be expected.
pub fn figures_of_groups(preferences: &Preferences<'_>) -> Result<Vec<Figure>, FigureError> {
    both(|sheet| {
        let drafts = [
            glance::overview(&preferences.concluded(), sheet),
            glance::contrasts(&preferences.concluded(), sheet),
            worths::draft(None, &preferences.scales, sheet),
            respondents::draft(&preferences.majorities, sheet),
        ];
        drafts.into_iter().flatten().collect()
    })
}

/// Drawn on both sheets.
fn both(drafts: impl Fn(Sheet) -> Vec<Unfinished>) -> Result<Vec<Figure>, FigureError> {
    let (wide, narrow) = (drafts(Sheet::Wide), drafts(Sheet::Narrow));
    wide.into_par_iter().zip(narrow).map(|(wide, narrow)| wide.finish_with(narrow)).collect()
}

fn drafts(results: &Results<'_>, sheet: Sheet) -> Vec<Unfinished> {
    let inputs = &results.inputs;
    let mut drafts = Vec::new();
    let preferred = results.preferences.as_ref().filter(|_| inputs.answers.is_some());
    let times_decide = crate::wants::busy(inputs).is_none();
    let overview = match preferred.and_then(|found| glance::overview(&found.concluded(), sheet)) {
        Some(contrasts) => Some(contrasts),
        None => crate::telling::telling(inputs.study, inputs.meshes)
            .and_then(|of| fronts::overview(inputs.study, &results.decision, of.object, times_decide, sheet)),
    };
    drafts.extend(meshes::triangles(inputs, sheet));
    drafts.extend(meshes::pass_times(inputs, sheet));
    drafts.extend(meshes::radius_ratios(inputs, sheet));
    drafts.extend(meshes::aspect_ratios(inputs, sheet));
    drafts.extend(stages::stage_times(inputs, sheet));
    drafts.extend(distributions::aspect_ratios(inputs, sheet));
    drafts.extend(fronts::draft(inputs.study, &results.decision, sheet));
    if style::has_codes(inputs.study) {
        let found = " The table of methods says what the codes stand for.";
        drafts.iter_mut().for_each(|draft| draft.caption += found);
    }
    if let Some(found) = crate::budgets::in_short(inputs) {
        drafts.iter_mut().for_each(|draft| draft.caption += &format!(" {found}"));
    }
    if let Some(overview) = overview {
        drafts.insert(0, overview);
    }
    if let Some((answered, preferences)) = inputs.answers.zip(results.preferences.as_ref()) {
        let tally = &answered.tally;
        drafts.extend(glance::contrasts(&preferences.concluded(), sheet));
        drafts.push(answers::per_question(inputs.study, tally, answered.sides_differ(), sheet));
        drafts.push(preferences::per_object(inputs.study, tally, sheet));
        drafts.push(preferences::overall(inputs.study, tally, sheet));
        drafts.extend(worths::draft(Some(inputs.study), &preferences.scales, sheet));
        drafts.extend(respondents::draft(&preferences.majorities, sheet));
        let prediction = results.prediction.as_ref();
        drafts.extend(
            prediction.map(|found| prediction::draft(inputs.study, found, &answered.declared, sheet)),
        );
    }
    drafts
}

#[cfg(test)]
mod tests;
