//! Whether worths go with something about people: by the groups that they belong to, and by numbers.
//!
//! Each group of items is tested with each column that the study names. The p is by permutation of people
//! ([`attribute_test`]), corrected by Holm over all tests here. What the worths are in each group of people, and how much a number
//! moves them, is told beside it.

use crate::ballots::BallotGroup;
use isostudy_design::Study;
use isostudy_responses::{PersonColumn, Responses};
use isostudy_statistics::{
    Attribute, AttributeTest, FitError, Participants, PersonModel, Scale, ShownBallot, attribute_test, holm,
    person_model, scale,
};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// A column of people, and what worths have to do with it.
pub struct Attributed<'a> {
    /// The items.
    pub group: &'a BallotGroup,
    /// Title of the column.
    pub column: &'a str,
    /// Whether worths go with it, or why that cannot be told.
    pub test: Result<AttributeTest, NoTest>,
    /// p after Holm's correction over all tests.
    pub adjusted: Option<f64>,
    /// What worths there are.
    pub worths: Worths<'a>,
}

/// Why there is no test.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoTest {
    /// The model has no estimate.
    Fit(FitError),
    /// The column has a value that is no number.
    NoNumber,
    /// Everybody of whom it is known has the same value, or nobody's is known.
    OneGroup,
    /// The column has so many different values, which are more than [`MOST_GROUPS`].
    ManyGroups(usize),
}

/// Worths by a column.
pub enum Worths<'a> {
    /// Of each group of people, in the order of their names.
    Groups(Vec<Subgroup<'a>>),
    /// As a number changes them.
    Number(Box<Result<ByNumber, NoTest>>),
}

/// People with one value of a column.
pub struct Subgroup<'a> {
    /// The value.
    pub name: &'a str,
    /// How many of them compared the items.
    pub people: u64,
    /// Their worths, or why there are none.
    pub scale: Result<Scale, FitError>,
}

/// A number of people in the model of worths.
pub struct ByNumber {
    /// Its mean over the people who compared the items.
    pub mean: f64,
    /// Its standard deviation over them.
    pub sd: f64,
    /// The model; its covariate is the number in standard deviations around the mean.
    pub model: PersonModel,
}

/// Groups of people at most.
pub const MOST_GROUPS: usize = 20;

/// Every test of a study that names columns; none otherwise. Columns that divide people come before numbers.
pub fn attributed<'a>(
    study: Option<&Study>,
    responses: &'a Responses,
    groups: &'a [BallotGroup],
) -> Vec<Attributed<'a>> {
    let Some(study) = study else { return Vec::new() };
    let subgroups = &study.file.analysis.subgroups;
    let of = |group: &'a BallotGroup| {
        let columns = responses.people.par_iter();
        columns.map(move |column| match subgroups.contains(&column.name) {
            true => by_group(group, column),
            false => by_number(group, column),
        })
    };
    let mut found: Vec<Attributed<'a>> = groups.par_iter().flat_map(of).collect();
    let tested: Vec<usize> = (0..found.len()).filter(|&i| found[i].test.is_ok()).collect();
    let p: Vec<f64> = tested.iter().filter_map(|&i| found[i].test.as_ref().ok()).map(|test| test.p).collect();
    tested.into_iter().zip(holm(&p)).for_each(|(i, p)| found[i].adjusted = Some(p));
    found
}

fn by_group<'a>(group: &'a BallotGroup, column: &'a PersonColumn) -> Attributed<'a> {
    let mut ballots: BTreeMap<&str, Vec<ShownBallot>> = BTreeMap::new();
    for ballot in &group.ballots {
        if let Some(value) = column.values[ballot.participant()].as_deref() {
            ballots.entry(value).or_default().push(*ballot);
        }
    }
    let place = |value: &str| ballots.keys().position(|name| *name == value);
    let test = match ballots.len() {
        0 | 1 => Err(NoTest::OneGroup),
        many if many > MOST_GROUPS => Err(NoTest::ManyGroups(many)),
        _ => {
            let own = column.values.iter().map(|value| value.as_deref().and_then(place)).collect();
            attribute_test(group.items.len(), &group.ballots, &Attribute::Group(own)).map_err(NoTest::Fit)
        }
    };
    let subgroup = |(&name, own): (&&'a str, &Vec<ShownBallot>)| {
        let participants = Participants::of(group.items.len(), own);
        Subgroup { name, people: participants.number(), scale: scale(&participants, 0) }
    };
    let told = if ballots.len() > MOST_GROUPS { Vec::new() } else { ballots.iter().map(subgroup).collect() };
    Attributed { group, column: &column.name, test, adjusted: None, worths: Worths::Groups(told) }
}

fn by_number<'a>(group: &'a BallotGroup, column: &'a PersonColumn) -> Attributed<'a> {
    let numbers: Option<Vec<Option<f64>>> =
        column.values.iter().map(|value| number(value.as_deref())).collect();
    let untold = |reason: NoTest| Attributed {
        group,
        column: &column.name,
        test: Err(reason),
        adjusted: None,
        worths: Worths::Number(Box::new(Err(reason))),
    };
    let Some(numbers) = numbers else { return untold(NoTest::NoNumber) };
    // Around the mean of those who compared these items, each once.
    let who = group.ballots.iter().filter(|b| b.left() != b.right()).map(ShownBallot::participant);
    let mut people: Vec<usize> = who.filter(|&participant| numbers[participant].is_some()).collect();
    people.sort_unstable();
    people.dedup();
    let own: Vec<f64> = people.iter().filter_map(|&participant| numbers[participant]).collect();
    let mean = own.iter().sum::<f64>() / own.len() as f64;
    let sd = (own.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (own.len() as f64 - 1.0)).sqrt();
    if own.len() < 2 || own.iter().all(|x| *x == own[0]) {
        return untold(NoTest::OneGroup);
    }
    let in_sd: Vec<Option<Vec<f64>>> = numbers.iter().map(|x| x.map(|x| vec![(x - mean) / sd])).collect();
    let model = person_model(group.items.len(), &group.ballots, &in_sd).map_err(NoTest::Fit);
    let test = attribute_test(group.items.len(), &group.ballots, &Attribute::Number(numbers));
    Attributed {
        group,
        column: &column.name,
        test: test.map_err(NoTest::Fit),
        adjusted: None,
        worths: Worths::Number(Box::new(model.map(|model| ByNumber { mean, sd, model }))),
    }
}

/// A number in a cell, with a decimal point or comma; nothing in an empty cell. `None` if it is no number.
fn number(cell: Option<&str>) -> Option<Option<f64>> {
    let Some(cell) = cell else { return Some(None) };
    let number: f64 = cell.parse().or_else(|_| cell.replacen(',', ".", 1).parse()).ok()?;
    number.is_finite().then_some(Some(number))
}

#[cfg(test)]
mod tests;
