//! Models of preference: worths with their errors, and what each model says about ties and sides.

use isostudy_inference::models::GroupModel;
use isostudy_statistics::Penalty;
use isostudy_table::{Cell, Table};

/// `worths` and `models` of every group, with every model.
///
/// What a model cannot estimate has no row in `worths`, and its reason in `models`.
pub(super) fn model_tables(found: &[GroupModel<'_>], sides_recorded: bool) -> [Table; 2] {
    let (mut worths, mut models) = (empty_worths(), empty_models());
    if !sides_recorded {
        let note = "Side: not answerable here, because the file does not say which item was on which side.";
        worths.notes.push(note.into());
        models.notes.push(note.into());
    }
    for of in found {
        models.push(model_row(of));
        add_worths(&mut worths, of);
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

fn add_worths(table: &mut Table, of: &GroupModel<'_>) {
    for (name, worth) in of.group.items.iter().zip(&of.worths) {
        table.push(vec![
            Cell::text(&of.group.name),
            Cell::text(name),
            Cell::text(of.model.code()),
            Cell::of_sum(Some(worth.log_worth), 3),
            Cell::Number(worth.independent_error, 3),
            Cell::number(worth.clustered_error, 3),
            Cell::of_sum(worth.interval.map(|i| i.low), 3),
            Cell::of_sum(worth.interval.map(|i| i.high), 3),
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

fn model_row(of: &GroupModel<'_>) -> Vec<Cell> {
    let fitted = of.fitted.as_ref().ok();
    let [side, side_error] = of.side;
    vec![
        Cell::text(&of.group.name),
        Cell::text(of.model.code()),
        Cell::number(fitted.map(|fit| fit.log_likelihood), 4),
        Cell::number(fitted.and_then(|fit| fit.ln_nu).filter(|nu| nu.is_finite()), 4),
        Cell::number(side, 4),
        Cell::number(side_error, 4),
        Cell::p(of.side_p, 4),
        Cell::number(fitted.and_then(|fit| fit.ln_theta), 4),
        Cell::count(of.answers as u64),
        Cell::text(fitted.map_or("", |fit| if fit.penalised() { "yes" } else { "no" })),
        Cell::text(remark(of)),
    ]
}

fn remark(of: &GroupModel<'_>) -> String {
    let fit = match &of.fitted {
        Err(error) => return error.to_string(),
        Ok(fit) => fit,
    };
    let mut remarks = Vec::new();
    match fit.penalty {
        Penalty::ItemsSeparated => {
            remarks.push("some items never won against the others: half a win each way added");
        }
        Penalty::SideSeparated => {
            remarks.push("the answers put no bound on the liking for a side: half a win each way added");
        }
        Penalty::None if of.held_by_ties => {
            remarks.push("some items never won against the others: ties alone keep the estimates finite");
        }
        Penalty::None => {}
    }
    if fit.ln_nu == Some(f64::NEG_INFINITY) || fit.ln_theta == Some(0.0) {
        remarks.push("no ties");
    }
    if of.through_additivity {
        remarks.push("no pair was shown in both orders: side is told from worth only if worths are additive");
    }
    remarks.join("; ")
}

#[cfg(test)]
mod tests;
