//! All items of a group on one scale: where each stands, every difference, and how well the model fits.

use isostudy_inference::scale::{GroupFit, GroupScale};
use isostudy_statistics::interval::Interval;
use isostudy_statistics::{Difference, FittedPair, Omnibus, Scale, jod, preferred};
use isostudy_table::{Cell, Columns, Table};

/// `scale`, `differences` and `fit`: positions of items, differences of every two, and what the models miss.
pub(crate) fn tables(scales: &[GroupScale<'_>]) -> [Table; 3] {
    [positions(scales), differences(scales), fits(scales)]
}

/// A difference in log-odds, as it is shown: itself, in JOD, and as a chance.
const UNITS: [fn(f64) -> f64; 3] = [|log_odds| log_odds, jod, preferred];

/// In one of the units.
fn value(of: &Difference, unit: usize) -> Cell {
    Cell::of_sum(Some(UNITS[unit](of.log_odds)), 3)
}

/// The lower end of its interval, or the upper one.
fn end(of: &Difference, unit: usize, end: fn(Interval) -> f64) -> Cell {
    Cell::of_sum(of.spread.map(|spread| UNITS[unit](end(spread.interval))), 3)
}

fn positions(scales: &[GroupScale<'_>]) -> Table {
    /// A group, its scale, and the place of an item.
    type Row<'a> = (&'a GroupScale<'a>, &'a Scale, usize);
    fn at<'a>((_, scale, place): &Row<'a>) -> &'a Difference {
        &scale.positions[*place]
    }
    /// Stands in the first row alone.
    fn omnibus((_, scale, place): &Row<'_>) -> Option<Omnibus> {
        scale.omnibus.ok().filter(|_| *place == 0)
    }
    let rows = scales.iter().filter_map(|of| Some((of, of.scale.as_ref().ok()?)));
    let rows = rows.flat_map(|(of, scale)| (0..scale.positions.len()).map(move |place| (of, scale, place)));
    let table = Columns::over(rows)
        .column("group", "Group", |(of, ..)| Cell::text(&of.group.name))
        .column("item", "Item", |(of, _, place)| Cell::text(&of.group.items[*place]))
        .column("reference", "Reference", |(of, scale, _)| Cell::text(&of.group.items[scale.reference]))
        .column("log_worth", "Log worth", |row| value(at(row), 0))
        .column("low", "from", |row| end(at(row), 0, |i| i.low))
        .column("high", "to", |row| end(at(row), 0, |i| i.high))
        .column("jod", "JOD", |row| value(at(row), 1))
        .column("jod_low", "from", |row| end(at(row), 1, |i| i.low))
        .column("jod_high", "to", |row| end(at(row), 1, |i| i.high))
        .column("preferred", "Preferred", |row| value(at(row), 2))
        .column("preferred_low", "from", |row| end(at(row), 2, |i| i.low))
        .column("preferred_high", "to", |row| end(at(row), 2, |i| i.high))
        .column("f", "F", |row| Cell::number(omnibus(row).map(|of| of.f), 3))
        .column("degrees", "Degrees", |row| {
            omnibus(row)
                .map_or(Cell::Missing, |of| Cell::text(format!("{}, {}", of.degrees[0], of.degrees[1])))
        })
        .column("p", "p of no difference", |row| Cell::p(omnibus(row).map(|of| of.p), 5))
        .column("p_adjusted", "p adjusted", |row| Cell::p(omnibus(row).and(row.0.omnibus_adjusted), 4))
        .column("model", "Model", |(_, scale, _)| Cell::text(model(scale)))
        .into_table("scale", "Items on one scale");
    table.with_note(
        "Davidson's model on all answers of the group, with a bonus for a side where pairs were shown in both orders (davidson-side): \
         a liking for a side would else make worths too small. Half a win added: the answers separate items or a side, so that half a \
         win each way was added to every pair; positions are then no estimates, and have no interval. Log worth: log-odds of being preferred to the reference, ties aside. JOD: \
         just-objectionable differences, 1 where three in four prefer the one (log worth over ln 3; Perez-Ortiz and Mantiuk \
         2017). Preferred: the chance of being preferred to the reference in a decided answer. From and to: t interval at 95 % \
         with participants as clusters. F: Hotelling's test that all items are worth the same; its p \
         adjusted by Holm over the groups.",
    )
}

/// The model's name, and whether it was given half a win each way.
fn model(scale: &Scale) -> String {
    let added = if scale.fit.penalised() { ", half a win added" } else { "" };
    format!("{}{added}", scale.fit.model.code())
}

fn differences(scales: &[GroupScale<'_>]) -> Table {
    let rows = scales.iter().filter_map(|of| Some((of, of.scale.as_ref().ok()?)));
    let rows = rows.flat_map(|(of, scale)| scale.differences.iter().map(move |pair| (of, scale, pair)));
    let table = Columns::over(rows)
        .column("group", "Group", |(of, ..)| Cell::text(&of.group.name))
        .column("first", "First", |(of, _, pair)| Cell::text(&of.group.items[pair.first]))
        .column("second", "Second", |(of, _, pair)| Cell::text(&of.group.items[pair.second]))
        .column("log_odds", "Log-odds", |(.., of)| value(of, 0))
        .column("low", "from", |(.., of)| end(of, 0, |i| i.low))
        .column("high", "to", |(.., of)| end(of, 0, |i| i.high))
        .column("jod", "JOD", |(.., of)| value(of, 1))
        .column("jod_low", "from", |(.., of)| end(of, 1, |i| i.low))
        .column("jod_high", "to", |(.., of)| end(of, 1, |i| i.high))
        .column("preferred", "First preferred", |(.., of)| value(of, 2))
        .column("preferred_low", "from", |(.., of)| end(of, 2, |i| i.low))
        .column("preferred_high", "to", |(.., of)| end(of, 2, |i| i.high))
        .column("p", "p", |(.., of)| Cell::p(of.spread.map(|spread| spread.p), 5))
        .column("p_adjusted", "p adjusted", |(.., of)| Cell::p(of.spread.map(|spread| spread.adjusted), 4))
        .column("model", "Model", |(_, scale, _)| Cell::text(model(scale)))
        .into_table("differences", "Differences of every two items on one scale");
    table.with_note(
        "From the model of the table of scales, on all answers of the group, those to other pairs included; the direct tests of a pair are in the \
         table of tests. p: t test with participants as clusters; adjusted by Holm over the pairs of the group. Intervals are \
         for one difference each.",
    )
}

fn fits(scales: &[GroupScale<'_>]) -> Table {
    /// A group, a model of it, and the place of a pair.
    type Row<'a> = (&'a GroupScale<'a>, &'a GroupFit, usize);
    fn pair<'a>((_, of, place): &Row<'a>) -> &'a FittedPair {
        &of.goodness.pairs[*place]
    }
    /// What is about the whole model stands in its first row.
    fn once((_, of, place): &Row<'_>, cell: fn(&GroupFit) -> Cell) -> Cell {
        if *place == 0 { cell(of) } else { Cell::Missing }
    }
    let rows = scales.iter().flat_map(|of| of.fits.iter().map(move |fit| (of, fit)));
    let rows = rows.flat_map(|(of, fit)| (0..fit.goodness.pairs.len()).map(move |place| (of, fit, place)));
    let caption = "How well models of worths reproduce the answers";
    let table = Columns::over(rows)
        .column("group", "Group", |(of, ..)| Cell::text(&of.group.name))
        .column("model", "Model", |(_, of, _)| Cell::text(of.model.model.code()))
        .column("log_likelihood", "Log-likelihood", |row| {
            once(row, |of| Cell::Number(of.model.log_likelihood, 4))
        })
        .column("deviance", "Deviance", |row| once(row, |of| Cell::Number(of.goodness.deviance, 2)))
        .column("degrees", "Degrees", |row| once(row, |of| Cell::count(of.goodness.degrees as u64)))
        .column("p", "p", |row| once(row, |of| Cell::p(of.goodness.p, 5)))
        .column("first", "First", |row| Cell::text(&row.0.group.items[pair(row).left]))
        .column("second", "Second", |row| Cell::text(&row.0.group.items[pair(row).right]))
        .column("first_answers", "For the first", |row| Cell::count(pair(row).answers[0] as u64))
        .column("first_fitted", "fitted", |row| Cell::Number(pair(row).fitted[0], 1))
        .column("no_preference", "None", |row| Cell::count(pair(row).answers[1] as u64))
        .column("no_preference_fitted", "fitted", |row| Cell::Number(pair(row).fitted[1], 1))
        .column("second_answers", "For the second", |row| Cell::count(pair(row).answers[2] as u64))
        .column("second_fitted", "fitted", |row| Cell::Number(pair(row).fitted[2], 1))
        .column("gain", "Gain of Rao-Kupper", |row| {
            once(row, |of| Cell::number(of.gain.map(|gain| gain.gain), 3))
        })
        .column("gain_p", "p of gain", |row| once(row, |of| Cell::p(of.gain.and_then(|gain| gain.p), 4)))
        .into_table("fit", caption);
    table.with_note(
        "One row a pair; what is about the whole model stands in its first. Deviance: against a model with chances of its own \
         for every pair; its p takes all answers as independent, so it is too small where people differ. Gain: log-likelihood \
         of Rao and Kupper's model less Davidson's, with Vuong's test over participants.",
    )
}
