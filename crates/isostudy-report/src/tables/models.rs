//! Models of preference: worths with their errors, and what each model says about ties and sides.

use isostudy_inference::models::GroupModel;
use isostudy_statistics::{Penalty, WorthFit};
use isostudy_table::{Cell, Columns, Table};

/// `worths` and `models` of every group, with every model.
///
/// What a model cannot estimate has no row in `worths`, and its reason in `models`.
pub(crate) fn model_tables(found: &[GroupModel<'_>], sides_recorded: bool) -> [Table; 2] {
    let mut tables = [worths(found), models(found)];
    if !sides_recorded {
        let note = "Side: not answerable here, because the file does not say which item was on which side.";
        tables.iter_mut().for_each(|table| table.notes.insert(1, note.into()));
    }
    tables
}

fn worths(found: &[GroupModel<'_>]) -> Table {
    let rows = found.iter().flat_map(|of| {
        of.group.items.iter().zip(&of.worths).map(move |(item, worth)| (of, item.as_str(), worth))
    });
    let caption = "Worths: log-odds of being preferred to the group's first item";
    let table = Columns::over(rows)
        .column("group", "Group", |(of, ..)| Cell::text(&of.group.name))
        .column("item", "Item", |(_, item, _)| Cell::text(item))
        .column("model", "Model", |(of, ..)| Cell::text(of.model.code()))
        .column("log_worth", "Log worth", |(.., worth)| Cell::of_sum(Some(worth.log_worth), 3))
        .column("se", "SE, answers independent", |(.., worth)| Cell::Number(worth.independent_error, 3))
        .column("clustered_se", "SE, participants", |(.., worth)| Cell::number(worth.clustered_error, 3))
        .column("low", "from", |(.., worth)| Cell::of_sum(worth.interval.map(|i| i.low), 3))
        .column("high", "to", |(.., worth)| Cell::of_sum(worth.interval.map(|i| i.high), 3))
        .into_table("worths", caption);
    table.with_note(
        "SE, answers independent: from the exact information, for comparison with other programs; too small, because one \
         person's answers hang together. SE, participants: sandwich with m/(m \u{2212} 1); from and to: its t interval at 95 % on \
         m \u{2212} 1 degrees of freedom; none where the answers tell no spread between participants. Rao and Kupper's worths are on another scale: \
         compare orders.",
    )
}

fn models(found: &[GroupModel<'_>]) -> Table {
    fn fit<'a>(of: &'a GroupModel<'_>) -> Option<&'a WorthFit> {
        of.fitted.as_ref().ok()
    }
    let table = Columns::over(found)
        .column("group", "Group", |of| Cell::text(&of.group.name))
        .column("model", "Model", |of| Cell::text(of.model.code()))
        .column("log_likelihood", "Log-likelihood", |of| {
            Cell::number(fit(of).map(|fit| fit.log_likelihood), 4)
        })
        .column("ln_nu", "ln nu", |of| {
            Cell::number(fit(of).and_then(|fit| fit.ln_nu).filter(|nu| nu.is_finite()), 4)
        })
        .column("side", "Side", |of| Cell::number(of.side[0], 4))
        .column("side_se", "SE of side", |of| Cell::number(of.side[1], 4))
        .column("side_p", "p of side", |of| Cell::p(of.side_p, 4))
        .column("ln_theta", "ln theta", |of| Cell::number(fit(of).and_then(|fit| fit.ln_theta), 4))
        .column("answers", "Answers", |of| Cell::count(of.answers as u64))
        .column("penalised", "Penalised", |of| {
            Cell::text(fit(of).map_or("", |fit| if fit.penalised() { "yes" } else { "no" }))
        })
        .column("remark", "Remark", |of| Cell::text(remark(of)))
        .into_table("models", "Models of preference");
    table.with_note(
        "Log-likelihood: of the answers, without multinomial constants; Bradley and Terry's counts a tie as half a win for \
         both and is not on the others' scale. ln nu: Davidson's tie parameter, symmetric form. Side: bonus of the left \
         side in log-odds; its p by likelihood ratio, as if all answers were independent. Penalised: half a win each way \
         was added to every compared pair, because the answers separate the items or a side; the remark says which.",
    )
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
