//! Times that two rows have in common to the millisecond. People do not repeat one another's times; files that were merged
//! twice do.

use super::{ALLOWANCE, Rows, pairs};
use crate::audit::ALARM;
use crate::audit::evidence::{SameTimes, TimeTwins};
use rayon::prelude::*;
use std::collections::{BTreeSet, HashMap};
use std::ops::Range;

/// Different times in common below which nothing is said.
const FEWEST_TIMES: usize = 3;
/// Of the answers that both timed, this share has to agree: nearly all.
const NEARLY_ALL: f64 = 0.8;

/// What was seen of times.
#[derive(Debug)]
pub(super) struct Seen {
    /// The least p of two rows, times the number of pairs and three times over; 1 if no two have nearly all times in common.
    pub(super) p: f64,
    /// Who has times in common.
    pub(super) same: SameTimes,
}

/// Two rows, by place among the people, with the questions that both timed and the times in common.
struct Twins {
    people: [u32; 2],
    timed: usize,
    common: Vec<Timed>,
}

/// A question and its time in milliseconds; longer ones than 49 days are as long as that.
type Timed = (u32, u32);

/// Every two people with nearly all times in common; `None` unless two people have enough times.
///
/// The chance that somebody else takes one's time is the share of those who do, the two left out and one added. A row's is the
/// product over its different times, which a time that is given again and again, as for what was never answered, adds
/// to once.
pub(super) fn look(rows: &Rows) -> Option<Seen> {
    let timed: Vec<Vec<Timed>> = rows.people.iter().map(|of| times(rows, of)).collect();
    // A time that is given again and again, as for what was never measured, tells no row from another.
    let different = |times: &&Vec<Timed>| times.iter().map(|(_, time)| time).collect::<BTreeSet<_>>().len();
    let people = timed.iter().filter(|times| different(times) >= FEWEST_TIMES).count();
    if people < 2 {
        return None;
    }
    let twins: Vec<Twins> = candidates(&timed).into_iter().filter_map(|of| twins(&timed, of)).collect();
    let mut shared: HashMap<Timed, u64> =
        twins.iter().flat_map(|of| of.common.iter().map(|&time| (time, 0))).collect();
    if !shared.is_empty() {
        for time in timed.iter().flatten() {
            shared.entry(*time).and_modify(|n| *n += 1);
        }
    }
    let same = SameTimes { people, untimed: timed.len() - people, copies: Vec::new() };
    let mut seen = Seen { p: 1.0, same };
    for Twins { people: [a, b], timed, common } in twins {
        let chance = |time: &Timed| (shared[time].saturating_sub(2) + 1) as f64 / people as f64;
        let row: f64 = common.iter().map(chance).product();
        let which: f64 = (0..timed - common.len()).map(|i| (timed - i) as f64 / (i + 1) as f64).product();
        let p = (ALLOWANCE * pairs(people) * which * row).min(1.0);
        seen.p = seen.p.min(p);
        if p < ALARM {
            let people = [a, b].map(|of| rows.participant(&rows.people[of as usize]));
            seen.same.copies.push(TimeTwins { people, common: common.len(), timed });
        }
    }
    Some(seen)
}

/// A person's times by question, each question once.
fn times(rows: &Rows, of: &Range<usize>) -> Vec<Timed> {
    let Some(known) = rows.circumstances.get(of.clone()) else { return Vec::new() };
    let time = |(ballot, known): (&isostudy_statistics::ShownBallot, &isostudy_statistics::Circumstances)| {
        Some((ballot.question() as u32, known.rt_ms?.round() as u32))
    };
    let mut times: Vec<Timed> = rows.ballots[of.clone()].iter().zip(known).filter_map(time).collect();
    times.dedup_by_key(|(question, _)| *question);
    times
}

/// Pairs of people who took the same times for two questions on end. Where many did, neighbours alone: who has nearly all
/// times in common is found by the others.
fn candidates(timed: &[Vec<Timed>]) -> BTreeSet<[u32; 2]> {
    let keys = |(person, times): (usize, &Vec<Timed>)| -> Vec<([Timed; 2], u32)> {
        times.windows(2).map(|two| ([two[0], two[1]], person as u32)).collect()
    };
    let mut keys: Vec<([Timed; 2], u32)> = timed.par_iter().enumerate().flat_map_iter(keys).collect();
    keys.par_sort_unstable();
    keys.windows(2).filter(|two| two[0].0 == two[1].0).map(|two| [two[0].1, two[1].1]).collect()
}

fn twins(timed: &[Vec<Timed>], people: [u32; 2]) -> Option<Twins> {
    let [a, b] = people.map(|of| &timed[of as usize]);
    let other: HashMap<u32, u32> = b.iter().copied().collect();
    let both: Vec<(Timed, u32)> =
        a.iter().filter_map(|&(question, time)| Some(((question, time), *other.get(&question)?))).collect();
    let common: Vec<Timed> =
        both.iter().filter(|((_, time), other)| time == other).map(|(time, _)| *time).collect();
    let enough = common.len() as f64 >= NEARLY_ALL * both.len() as f64;
    // Each time once, however often it was taken.
    let mut different = common.clone();
    different.sort_unstable_by_key(|&(question, time)| (time, question));
    different.dedup_by_key(|(_, time)| *time);
    let found = enough && different.len() >= FEWEST_TIMES;
    let again = common.len() - different.len();
    found.then(|| Twins { people, timed: both.len() - again, common: different })
}
