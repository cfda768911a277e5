//! Worths by what is known of people: a row for each group of people and item, and one for each item that a number moves.

use isostudy_inference::attributes::{Attributed, ByNumber, Subgroup, Worths};
use isostudy_statistics::Coefficient;
use isostudy_table::{Cell, Columns, Table};

/// `subgroups` and `covariates`: what the worths are, and whether they differ.
pub(crate) fn tables(attributed: &[Attributed<'_>]) -> [Table; 2] {
    [subgroups(attributed), covariates(attributed)]
}

/// What is about the whole test stands in its first row.
fn test(of: &Attributed<'_>, is_first: bool) -> [Cell; 4] {
    let test = of.test.as_ref().ok().filter(|_| is_first);
    [
        Cell::number(test.map(|test| test.statistic), 3),
        test.map_or(Cell::Missing, |test| Cell::count(test.degrees as u64)),
        Cell::p(test.map(|test| test.p), 4),
        Cell::p(of.adjusted.filter(|_| is_first), 4),
    ]
}

const TEST: &str = "T: near a chi-square on so many degrees if all answers were independent, which they are not. p: share of \
                    9,999 drawn orders of the people with a T as large (fewer orders of very many people), the person as the unit; \
                    adjusted by Holm over the tests of both tables, of subgroups and of covariates.";

fn subgroups(attributed: &[Attributed<'_>]) -> Table {
    /// A test, a group of people, the place of an item, and whether it is the first row of the test.
    type Row<'a> = (&'a Attributed<'a>, &'a Subgroup<'a>, usize, bool);
    fn rows<'a>(of: &'a Attributed<'a>) -> Vec<Row<'a>> {
        let Worths::Groups(groups) = &of.worths else { return Vec::new() };
        let items = 0..of.group.items.len();
        let all = groups.iter().flat_map(|group| items.clone().map(move |item| (group, item)));
        all.enumerate().map(|(place, (group, item))| (of, group, item, place == 0)).collect()
    }
    let spread = |(_, group, item, _): &Row<'_>| {
        let scale = group.scale.as_ref().ok()?;
        scale.positions[*item].spread.map(|spread| spread.interval)
    };
    let model = |group: &Subgroup<'_>| match &group.scale {
        Ok(scale) if scale.fit.penalised() => format!("{}, half a win added", scale.fit.model.code()),
        Ok(scale) => scale.fit.model.code().to_owned(),
        Err(reason) => reason.to_string(),
    };
    let table = Columns::over(attributed.iter().flat_map(rows))
        .column("group", "Group", |(of, ..)| Cell::text(&of.group.name))
        .column("column", "People by", |(of, ..)| Cell::text(of.column))
        .column("value", "Value", |(_, group, ..)| Cell::text(group.name))
        .column("people", "People", |(_, group, ..)| Cell::count(group.people))
        .column("item", "Item", |(of, _, item, _)| Cell::text(&of.group.items[*item]))
        .column("log_worth", "Log worth", |(_, group, item, _)| {
            let scale = group.scale.as_ref().ok();
            Cell::of_sum(scale.map(|scale| scale.positions[*item].log_odds), 3)
        })
        .column("low", "from", move |row| Cell::of_sum(spread(row).map(|interval| interval.low), 3))
        .column("high", "to", move |row| Cell::of_sum(spread(row).map(|interval| interval.high), 3))
        .column("t", "T", |&(of, _, _, is_first)| test(of, is_first)[0].clone())
        .column("degrees", "Degrees", |&(of, _, _, is_first)| test(of, is_first)[1].clone())
        .column("p", "p of no difference", |&(of, _, _, is_first)| test(of, is_first)[2].clone())
        .column("p_adjusted", "p adjusted", |&(of, _, _, is_first)| test(of, is_first)[3].clone())
        .column("model", "Model", move |(_, group, ..)| Cell::text(model(group)))
        .into_table("subgroups", "Worths by groups of people");
    table.with_note(format!(
        "Each group of people by itself, on the scale of the table of scales; the first item of a group is 0. From and to: t interval at \
         95 % with participants as clusters. {TEST}"
    ))
}

fn covariates(attributed: &[Attributed<'_>]) -> Table {
    /// A test, its model, the place of an item, and whether it is the first row of the test.
    type Row<'a> = (&'a Attributed<'a>, &'a ByNumber, usize);
    fn rows<'a>(of: &'a Attributed<'a>) -> Vec<Row<'a>> {
        let Worths::Number(number) = &of.worths else { return Vec::new() };
        let Ok(number) = number.as_ref() else { return Vec::new() };
        (0..of.group.items.len()).map(|item| (of, number, item)).collect()
    }
    fn slope((_, number, item): &Row<'_>) -> Option<Coefficient> {
        (*item > 0).then(|| number.model.slope(0, *item, 0)).flatten()
    }
    let table = Columns::over(attributed.iter().flat_map(rows))
        .column("group", "Group", |(of, ..)| Cell::text(&of.group.name))
        .column("column", "Number", |(of, ..)| Cell::text(of.column))
        .column("mean", "Mean", |(_, number, _)| Cell::Number(number.mean, 3))
        .column("sd", "SD", |(_, number, _)| Cell::Number(number.sd, 3))
        .column("people", "People", |(_, number, _)| Cell::count(number.model.participants))
        .column("item", "Item", |(of, _, item)| Cell::text(&of.group.items[*item]))
        .column("log_worth", "Log worth at the mean", |(_, number, item)| {
            Cell::of_sum(Some(number.model.log_worths[*item]), 3)
        })
        .column("slope", "Change for one SD", |(_, number, item)| {
            Cell::of_sum(Some(number.model.slopes[0][*item]), 3)
        })
        .column("low", "from", |row| Cell::of_sum(slope(row).map(|of| of.interval.low), 3))
        .column("high", "to", |row| Cell::of_sum(slope(row).map(|of| of.interval.high), 3))
        .column("slope_p", "p of the change", |row| Cell::p(slope(row).map(|of| of.p), 5))
        .column("t", "T", |&(of, _, item)| test(of, item == 0)[0].clone())
        .column("degrees", "Degrees", |&(of, _, item)| test(of, item == 0)[1].clone())
        .column("p", "p of no change", |&(of, _, item)| test(of, item == 0)[2].clone())
        .column("p_adjusted", "p adjusted", |&(of, _, item)| test(of, item == 0)[3].clone())
        .into_table("covariates", "How worths change with numbers of people");
    table.with_note(format!(
        "Davidson's model in which each item's log worth changes with the number; the first item of a group is 0. Change: in log-odds over \
         the first item, for a person one standard deviation (SD) above the mean. From and to: t interval at 95 % with participants as \
         clusters, for one change each. {TEST}"
    ))
}
