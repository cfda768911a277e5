//! What careless answering would show in, person by person, with controls and repeats.

use super::{Expected, Given, Oracle, Want};
use crate::people::Pressed;
use isostudy_design::forms::Role;
use std::collections::BTreeMap;

pub(super) fn expected(oracle: &Oracle<'_>) -> Expected {
    let columns = &[
        "left",
        "no_preference",
        "right",
        "one_sidedness",
        "longest_run",
        "comparable",
        "agreeing",
        "agreement",
        "controls",
        "controls_decided",
        "repeats",
        "repeats_opposite",
        "timed",
        "time_s",
        "flags",
    ];
    let mut table = Expected::new("respondents", &["respondent"], columns);
    let mut people: BTreeMap<usize, Vec<&Given>> = BTreeMap::new();
    oracle.given.iter().for_each(|given| people.entry(given.person).or_default().push(given));
    let majorities = majorities(oracle.given);
    let both_orders = both_orders(oracle.given);
    for (number, own) in (1..).zip(people.values()) {
        let control = |given: &&&Given| given.shown.role == Role::Control;
        let [mut left, mut none, mut right] = [0_u64; 3];
        for given in own.iter().filter(|given| !control(given)) {
            *match given.pressed {
                Pressed::Left => &mut left,
                Pressed::Neither => &mut none,
                Pressed::Right => &mut right,
            } += 1;
        }
        let controls = own.iter().filter(control).count() as u64;
        let decided =
            own.iter().filter(control).filter(|given| given.pressed != Pressed::Neither).count() as u64;
        let (repeats, opposite) = repeats(own);
        let (comparable, agreeing) = agreeing(own, &majorities);
        let time: u64 = own.iter().map(|given| u64::from(given.rt_ms)).sum();
        let rules = [
            ("one-sided", both_orders && left + right >= 10 && left.min(right) == 0),
            ("controls", decided >= 2 && 2 * decided > controls),
            ("repeats", opposite >= 2 && 2 * opposite > repeats),
            ("time", time < own.len() as u64 * u64::from(oracle.turn_ms)),
        ];
        // Who is odd is judged against everybody else's spread, which is not computed again here.
        let broken: Vec<&str> = rules.iter().filter(|(_, broken)| *broken).map(|(rule, _)| *rule).collect();
        table.push(
            [&number.to_string()],
            vec![
                Want::count(left),
                Want::count(none),
                Want::count(right),
                Want::number(
                    (left + right > 0).then(|| (left as f64 - right as f64) / (left + right) as f64),
                ),
                Want::count(longest_run(own)),
                Want::count(comparable),
                Want::count(agreeing),
                Want::number((comparable > 0).then(|| agreeing as f64 / comparable as f64)),
                Want::count(controls),
                Want::count(decided),
                Want::count(repeats),
                Want::count(opposite),
                Want::count(own.len() as u64),
                Want::Near(time as f64 / 1000.0),
                Want::Flags(broken.join(" ")),
            ],
        );
    }
    table
}

/// Whether any pair was seen in both orders: sides cannot be judged otherwise.
fn both_orders(given: &[Given]) -> bool {
    let shown: std::collections::BTreeSet<[&str; 2]> =
        given.iter().map(|given| [given.shown.left.as_str(), given.shown.right.as_str()]).collect();
    shown.iter().any(|[left, right]| left != right && shown.contains(&[*right, *left]))
}

/// The longest run of one side, in the order in which it was shown.
fn longest_run(own: &[&Given]) -> u64 {
    let mut own = own.to_vec();
    own.sort_by_key(|given| given.shown.order);
    let runs = own.chunk_by(|a, b| a.pressed == b.pressed);
    runs.filter(|run| run[0].pressed != Pressed::Neither).map(|run| run.len() as u64).max().unwrap_or(0)
}

/// By question, how many more chose the method with the earlier letters than the other; controls have none.
fn majorities(given: &[Given]) -> BTreeMap<&str, i64> {
    let mut majorities = BTreeMap::new();
    for given in given.iter().filter(|given| given.shown.role != Role::Control) {
        *majorities.entry(given.shown.question.as_str()).or_default() += sign(given);
    }
    majorities
}

fn sign(given: &Given) -> i64 {
    let earlier = given.left().min(given.right());
    given.chosen().map_or(0, |chosen| if chosen == earlier { 1 } else { -1 })
}

/// How many decided answers there are on which the others have a majority, and how many side with it.
fn agreeing(own: &[&Given], majorities: &BTreeMap<&str, i64>) -> (u64, u64) {
    let decided = own.iter().filter(|given| given.shown.role != Role::Control && sign(given) != 0);
    let others = decided.map(|given| (sign(given), majorities[given.shown.question.as_str()] - sign(given)));
    let comparable: Vec<(i64, i64)> = others.filter(|(_, others)| *others != 0).collect();
    let agreeing = comparable.iter().filter(|(own, others)| own.signum() == others.signum());
    (comparable.len() as u64, agreeing.count() as u64)
}

/// Comparisons that were asked again and decided both times, and how many of them otherwise.
fn repeats(own: &[&Given]) -> (u64, u64) {
    let (mut repeats, mut opposite) = (0, 0);
    for again in own.iter().filter(|given| given.shown.role == Role::Repeat) {
        let first = own.iter().find(|given| format!("{}-r", given.shown.question) == again.shown.question);
        if let Some((a, b)) = first.and_then(|first| first.chosen().zip(again.chosen())) {
            repeats += 1;
            opposite += u64::from(a != b);
        }
    }
    (repeats, opposite)
}
