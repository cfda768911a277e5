//! Models of preference: worths with their errors, and what each model says about ties and sides.

use isostudy_inference::ballots::BallotGroup;
use isostudy_statistics::{
    FitError, Model, Pairs, Participants, Penalty, Separation, SideDesign, WorthFit, clustered_covariance,
    fit, separation, side_design,
};
use isostudy_table::{Cell, Table};
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// `worths` and `models` of every group, with every model.
///
/// What a model cannot estimate has no row in `worths`, and its reason in `models`. Nothing but ballots is needed, so that
/// answers without a study file have the same tables.
///
/// Without `sides_recorded` nobody knows what stood on which side, and there is no model with a side.
pub fn model_tables(groups: &[BallotGroup], sides_recorded: bool) -> [Table; 2] {
    let (mut worths, mut models) = (empty_worths(), empty_models());
    if !sides_recorded {
        let note = "Side: not answerable here, because the file does not say which item was on which side.";
        worths.notes.push(note.into());
        models.notes.push(note.into());
    }
    for group in groups {
        let items = group.items.len();
        let pairs = Pairs::of(items, &group.ballots);
        let participants = Participants::of(items, &group.ballots);
        let plain = fit(Model::Davidson, &pairs).ok();
        for model in Model::ALL.into_iter().filter(|&model| sides_recorded || model != Model::DavidsonSide) {
            let fitted = fit(model, &pairs);
            models.push(model_row(group, &pairs, model, fitted.as_ref(), plain.as_ref()));
            if let Ok(fitted) = &fitted {
                add_worths(&mut worths, group, fitted, &participants);
            }
        }
    }
    [worths, models]
}

fn empty_worths() -> Table {
    let mut table = Table::new(
        "worths",
        "Worths: log-odds of being preferred to the group's first item",
        &[
            ("group", "Group"),
            ("item", "Item"),
            ("model", "Model"),
            ("log_worth", "Log worth"),
            ("se", "SE, answers independent"),
            ("clustered_se", "SE, participants"),
            ("low", "from"),
            ("high", "to"),
        ],
    );
    table.notes.push(
        "SE, answers independent: from the exact information, for comparison with other programs; too small, because one \
         person's answers hang together. SE, participants: sandwich with m/(m \u{2212} 1); from and to: its t interval at 95 % on \
         m \u{2212} 1 degrees of freedom; none where the answers tell no spread between participants. Rao and Kupper's worths are on another scale: \
         compare orders."
            .into(),
    );
    table
}

fn add_worths(table: &mut Table, group: &BallotGroup, fitted: &WorthFit, participants: &Participants) {
    let clustered = clustered_covariance(fitted, participants);
    for (item, name) in group.items.iter().enumerate() {
        let estimated = item > 0;
        let sandwich = clustered.as_ref().filter(|_| estimated);
        let found = sandwich.and_then(|s| fitted.clustered_error(s, participants.number(), item));
        let error = if estimated { found.map(|(error, _)| error) } else { Some(0.0) };
        table.push(vec![
            Cell::text(&group.name),
            Cell::text(name),
            Cell::text(fitted.model.code()),
            Cell::of_sum(Some(fitted.log_worths[item]), 3),
            Cell::Number(fitted.standard_error(&fitted.covariance, item, 0), 3),
            Cell::number(clustered.as_ref().and(error), 3),
            Cell::of_sum(found.map(|(_, i)| i.low), 3),
            Cell::of_sum(found.map(|(_, i)| i.high), 3),
        ]);
    }
}

fn empty_models() -> Table {
    let mut table = Table::new(
        "models",
        "Models of preference",
        &[
            ("group", "Group"),
            ("model", "Model"),
            ("log_likelihood", "Log-likelihood"),
            ("ln_nu", "ln nu"),
            ("side", "Side"),
            ("side_se", "SE of side"),
            ("side_p", "p of side"),
            ("ln_theta", "ln theta"),
            ("answers", "Answers"),
            ("penalised", "Penalised"),
            ("remark", "Remark"),
        ],
    );
    table.notes.push(
        "Log-likelihood: of the answers, without multinomial constants; Bradley and Terry's counts a tie as half a win for \
         both and is not on the others' scale. ln nu: Davidson's tie parameter, symmetric form. Side: bonus of the left \
         side in log-odds; its p by likelihood ratio, as if all answers were independent. Penalised: half a win each way \
         was added to every compared pair, because the answers separate the items or a side; the remark says which."
            .into(),
    );
    table
}

fn model_row(
    group: &BallotGroup,
    pairs: &Pairs,
    model: Model,
    fitted: Result<&WorthFit, &FitError>,
    plain: Option<&WorthFit>,
) -> Vec<Cell> {
    let of = fitted.ok();
    // Without a bound there is nothing to estimate, whatever half a win makes of it.
    let side = of.filter(|fit| fit.penalty != Penalty::SideSeparated);
    let side_index = |fit: &WorthFit| fit.side.map(|_| fit.parameters.len() - 1);
    let side_error = side.and_then(|fit| side_index(fit).map(|i| fit.covariance[i][i].sqrt()));
    let ratio = match (of, plain) {
        (Some(fit), Some(plain)) if fit.side.is_some() && !fit.penalised() && !plain.penalised() => {
            Some(2.0 * (fit.log_likelihood - plain.log_likelihood).max(0.0))
        }
        _ => None,
    };
    let one = ChiSquared::new(1.0).expect("one degree of freedom");
    let remark = match fitted {
        Err(error) => error.to_string(),
        Ok(fit) => remark(fit, pairs),
    };
    vec![
        Cell::text(&group.name),
        Cell::text(model.code()),
        Cell::number(of.map(|fit| fit.log_likelihood), 4),
        Cell::number(of.and_then(|fit| fit.ln_nu).filter(|nu| nu.is_finite()), 4),
        Cell::number(side.and_then(|fit| fit.side), 4),
        Cell::number(side_error, 4),
        Cell::p(ratio.map(|ratio| one.sf(ratio)), 4),
        Cell::number(of.and_then(|fit| fit.ln_theta), 4),
        Cell::count(pairs.answers() as u64),
        Cell::text(of.map_or("", |fit| if fit.penalised() { "yes" } else { "no" })),
        Cell::text(remark),
    ]
}

fn remark(fit: &WorthFit, pairs: &Pairs) -> String {
    let mut remarks = Vec::new();
    match fit.penalty {
        Penalty::ItemsSeparated => {
            remarks.push("some items never won against the others: half a win each way added");
        }
        Penalty::SideSeparated => {
            remarks.push("the answers put no bound on the liking for a side: half a win each way added");
        }
        Penalty::None if separation(pairs) == Separation::HeldByTies => {
            remarks.push("some items never won against the others: ties alone keep the estimates finite");
        }
        Penalty::None => {}
    }
    if fit.ln_nu == Some(f64::NEG_INFINITY) || fit.ln_theta == Some(0.0) {
        remarks.push("no ties");
    }
    if fit.model == Model::DavidsonSide && side_design(pairs) == SideDesign::ThroughAdditivity {
        remarks.push("no pair was shown in both orders: side is told from worth only if worths are additive");
    }
    remarks.join("; ")
}

#[cfg(test)]
mod tests;
