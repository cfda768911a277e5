//! All items of a group on one scale: where each stands, every difference, and how well the model fits.

use isostudy_inference::scale::{GroupFit, GroupScale};
use isostudy_statistics::{Difference, Omnibus, Scale, jod, preferred};
use isostudy_table::{Cell, Table};

/// `scale`, `differences` and `fit`: positions of items, differences of every two, and what the models miss.
pub(crate) fn tables(scales: &[GroupScale<'_>]) -> [Table; 3] {
    [positions(scales), differences(scales), fits(scales)]
}

fn positions(scales: &[GroupScale<'_>]) -> Table {
    let mut table = Table::new(
        "scale",
        "Items on one scale",
        &[
            ("group", "Group"),
            ("item", "Item"),
            ("reference", "Reference"),
            ("log_worth", "Log worth"),
            ("low", "from"),
            ("high", "to"),
            ("jod", "JOD"),
            ("jod_low", "from"),
            ("jod_high", "to"),
            ("preferred", "Preferred"),
            ("preferred_low", "from"),
            ("preferred_high", "to"),
            ("f", "F"),
            ("degrees", "Degrees"),
            ("p", "p of no difference"),
            ("p_adjusted", "p adjusted"),
            ("model", "Model"),
        ],
    );
    for GroupScale { group, scale, omnibus_adjusted, .. } in scales {
        let Ok(scale) = scale else { continue };
        let omnibus = scale.omnibus.ok();
        for (place, position) in scale.positions.iter().enumerate() {
            let mut row = vec![
                Cell::text(&group.name),
                Cell::text(&group.items[place]),
                Cell::text(&group.items[scale.reference]),
            ];
            row.extend(in_every_unit(position));
            let of = omnibus.filter(|_| place == 0);
            row.push(Cell::number(of.map(|of: Omnibus| of.f), 3));
            row.push(
                of.map_or(Cell::Missing, |of| Cell::text(format!("{}, {}", of.degrees[0], of.degrees[1]))),
            );
            row.push(Cell::p(of.map(|of| of.p), 5));
            row.push(Cell::p(of.and(*omnibus_adjusted), 4));
            row.push(Cell::text(model(scale)));
            table.push(row);
        }
    }
    table.notes.push(
        "Davidson's model on all answers of the group, with a bonus for a side where pairs were shown in both orders (davidson-side): \
         a liking for a side would else make worths too small. Half a win added: the answers separate items or a side, so that half a \
         win each way was added to every pair; positions are then no estimates, and have no interval. Log worth: log-odds of being preferred to the reference, ties aside. JOD: \
         just-objectionable differences, 1 where three in four prefer the one (log worth over ln 3; Perez-Ortiz and Mantiuk \
         2017). Preferred: the chance of being preferred to the reference in a decided answer. From and to: t interval at 95 % \
         with participants as clusters. F: Hotelling's test that all items are worth the same; its p \
         adjusted by Holm over the groups."
            .into(),
    );
    table
}

/// The model's name, and whether it was given half a win each way.
fn model(scale: &Scale) -> String {
    let added = if scale.fit.penalised() { ", half a win added" } else { "" };
    format!("{}{added}", scale.fit.model.code())
}

/// Log worth, JOD and chance, each with its interval.
fn in_every_unit(of: &Difference) -> Vec<Cell> {
    let units: [fn(f64) -> f64; 3] = [|log_odds| log_odds, jod, preferred];
    let ends = of.spread.map(|spread| [spread.interval.low, spread.interval.high]);
    let cells = |unit: fn(f64) -> f64| {
        let [low, high] = [0, 1].map(|end| Cell::of_sum(ends.map(|ends| unit(ends[end])), 3));
        [Cell::of_sum(Some(unit(of.log_odds)), 3), low, high]
    };
    units.into_iter().flat_map(cells).collect()
}

fn differences(scales: &[GroupScale<'_>]) -> Table {
    let mut table = Table::new(
        "differences",
        "Differences of every two items on one scale",
        &[
            ("group", "Group"),
            ("first", "First"),
            ("second", "Second"),
            ("log_odds", "Log-odds"),
            ("low", "from"),
            ("high", "to"),
            ("jod", "JOD"),
            ("jod_low", "from"),
            ("jod_high", "to"),
            ("preferred", "First preferred"),
            ("preferred_low", "from"),
            ("preferred_high", "to"),
            ("p", "p"),
            ("p_adjusted", "p adjusted"),
            ("model", "Model"),
        ],
    );
    for GroupScale { group, scale, .. } in scales {
        let Ok(scale) = scale else { continue };
        for of in &scale.differences {
            let mut row = vec![
                Cell::text(&group.name),
                Cell::text(&group.items[of.first]),
                Cell::text(&group.items[of.second]),
            ];
            row.extend(in_every_unit(of));
            row.push(Cell::p(of.spread.map(|spread| spread.p), 5));
            row.push(Cell::p(of.spread.map(|spread| spread.adjusted), 4));
            row.push(Cell::text(model(scale)));
            table.push(row);
        }
    }
    table.notes.push(
        "From the model of the table of scales, on all answers of the group, those to other pairs included; the direct tests of a pair are in the \
         table of tests. p: t test with participants as clusters; adjusted by Holm over the pairs of the group. Intervals are \
         for one difference each."
            .into(),
    );
    table
}

fn fits(scales: &[GroupScale<'_>]) -> Table {
    let mut table = Table::new(
        "fit",
        "How well models of worths reproduce the answers",
        &[
            ("group", "Group"),
            ("model", "Model"),
            ("log_likelihood", "Log-likelihood"),
            ("deviance", "Deviance"),
            ("degrees", "Degrees"),
            ("p", "p"),
            ("first", "First"),
            ("second", "Second"),
            ("first_answers", "For the first"),
            ("first_fitted", "fitted"),
            ("no_preference", "None"),
            ("no_preference_fitted", "fitted"),
            ("second_answers", "For the second"),
            ("second_fitted", "fitted"),
            ("gain", "Gain of Rao-Kupper"),
            ("gain_p", "p of gain"),
        ],
    );
    for GroupScale { group, fits, .. } in scales {
        for GroupFit { model, goodness, gain } in fits {
            for (row, pair) in goodness.pairs.iter().enumerate() {
                let once = |cell: Cell| if row == 0 { cell } else { Cell::Missing };
                let mut cells = vec![
                    Cell::text(&group.name),
                    Cell::text(model.model.code()),
                    once(Cell::Number(model.log_likelihood, 4)),
                    once(Cell::Number(goodness.deviance, 2)),
                    once(Cell::count(goodness.degrees as u64)),
                    once(Cell::p(goodness.p, 5)),
                    Cell::text(&group.items[pair.left]),
                    Cell::text(&group.items[pair.right]),
                ];
                for (answers, expected) in pair.answers.iter().zip(pair.fitted) {
                    cells.push(Cell::count(*answers as u64));
                    cells.push(Cell::Number(expected, 1));
                }
                cells.push(once(Cell::number(gain.map(|gain| gain.gain), 3)));
                cells.push(once(Cell::p(gain.and_then(|gain| gain.p), 4)));
                table.push(cells);
            }
        }
    }
    table.notes.push(
        "One row a pair; what is about the whole model stands in its first. Deviance: against a model with chances of its own \
         for every pair; its p takes all answers as independent, so it is too small where people differ. Gain: log-likelihood \
         of Rao and Kupper's model less Davidson's, with Vuong's test over participants."
            .into(),
    );
    table
}
