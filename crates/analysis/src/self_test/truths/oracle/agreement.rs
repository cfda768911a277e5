//! Agreement of people with each other, and of each with themselves.

use super::{Expected, Given, Oracle, Question, Want};
use statrs::distribution::{ChiSquared, ContinuousCDF, StudentsT};
use std::collections::BTreeMap;

pub(super) fn expected(oracle: &Oracle<'_>) -> Expected {
    let columns = &[
        "questions",
        "alpha_nominal",
        "alpha_nominal_low",
        "alpha_nominal_high",
        "alpha_ordinal",
        "alpha_ordinal_low",
        "alpha_ordinal_high",
        "kendall_u",
        "chi_square",
        "degrees",
        "p",
        "triads",
        "decided_triads",
        "strict_cycles",
        "weak_cycles",
        "cycles_by_chance",
        "tournaments",
        "mean_zeta",
    ];
    let mut table = Expected::new("agreement", &["scope"], columns);
    for group in [None].into_iter().chain(oracle.groups.iter().map(|(group, _)| Some(group))) {
        let inside = |q: &Question| group.is_none_or(|group| q.group == *group);
        let everybody = by_person(oracle, inside);
        let counts: Vec<[u64; 3]> =
            sums(&everybody).into_iter().filter(|counts| counts.iter().sum::<u64>() > 0).collect();
        if counts.is_empty() {
            continue;
        }
        let kendall = kendall(&counts);
        let test = kendall.and_then(|(_, test)| test);
        let circles = triads(oracle, inside);
        let Triads { all, decided, strict, weak, tournaments, zeta } = circles;
        let circle = |count: u64| if all > 0 { Want::count(count) } else { Want::Empty };
        let [nominal, ordinal] = [false, true].map(|ordinal| {
            let ends = jackknife(&everybody, ordinal);
            [alpha(&counts, ordinal), ends.map(|ends| ends[0]), ends.map(|ends| ends[1])].map(Want::number)
        });
        let ([nominal, nominal_low, nominal_high], [ordinal, ordinal_low, ordinal_high]) = (nominal, ordinal);
        table.push(
            [group.map_or("all", String::as_str)],
            vec![
                Want::count(counts.len() as u64),
                nominal,
                nominal_low,
                nominal_high,
                ordinal,
                ordinal_low,
                ordinal_high,
                Want::number(kendall.map(|(u, _)| u)),
                Want::number(test.map(|test| test.0)),
                Want::number(test.map(|test| test.1)),
                test.map_or(Want::Empty, |test| Want::p(test.2)),
                circle(all),
                circle(decided),
                circle(strict),
                circle(weak),
                Want::number((all > 0).then_some(decided as f64 / 4.0)),
                circle(tournaments),
                Want::number((tournaments > 0).then(|| zeta / tournaments as f64)),
            ],
        );
    }
    table
}

/// By person who answered any of the questions that are meant, and by these, the answers for the one that is listed left, for
/// none and for the other.
fn by_person(oracle: &Oracle<'_>, meant: impl Fn(&Question) -> bool) -> Vec<Vec<[u64; 3]>> {
    let of_person = |own: &Vec<(usize, &Given)>| {
        let mut counts = vec![[0; 3]; oracle.questions.len()];
        for (q, given) in own.iter().filter(|(q, _)| meant(&oracle.questions[*q])) {
            let chosen =
                given.chosen().map_or(1, |chosen| if chosen == oracle.questions[*q].left { 0 } else { 2 });
            counts[*q][chosen] += 1;
        }
        counts
    };
    let mut all: Vec<Vec<[u64; 3]>> = oracle.comparisons.iter().map(of_person).collect();
    all.retain(|own| own.iter().any(|counts| *counts != [0; 3]));
    all
}

fn sums(people: &[Vec<[u64; 3]>]) -> Vec<[u64; 3]> {
    let mut sums = vec![[0; 3]; people.first().map_or(0, Vec::len)];
    for own in people {
        sums.iter_mut().zip(own).for_each(|(sum, own)| (0..3).for_each(|i| sum[i] += own[i]));
    }
    sums
}

/// The ends of alpha's interval: each person left out in turn, a t quantile of the standard error of that.
fn jackknife(people: &[Vec<[u64; 3]>], ordinal: bool) -> Option<[f64; 2]> {
    let all = sums(people);
    let without = |own: &Vec<[u64; 3]>| {
        let rest: Vec<[u64; 3]> =
            all.iter().zip(own).map(|(sum, own)| [0, 1, 2].map(|i| sum[i] - own[i])).collect();
        alpha(&rest, ordinal)
    };
    let left_out: Vec<f64> = people.iter().map(without).collect::<Option<_>>()?;
    let m = left_out.len() as f64;
    let mean = left_out.iter().sum::<f64>() / m;
    let error = ((m - 1.0) / m * left_out.iter().map(|x| (x - mean).powi(2)).sum::<f64>()).sqrt();
    // Where leaving anybody out changes nothing nobody knows how people differ.
    if m < 3.0 || error < 1e-12 {
        return None;
    }
    let half = StudentsT::new(0.0, 1.0, m - 1.0).expect("three people or more").inverse_cdf(0.975) * error;
    let value = alpha(&all, ordinal)?;
    Some([value - half, value + half].map(|end| end.clamp(-1.0, 1.0)))
}

/// Krippendorff's, by its coincidences: values are the two items and neither, and which of them is named first says nothing,
/// so that every question counts in both orders. Ordinal: neither stands between the two, and values are as far apart as there
/// are answers from the middle of the one to the middle of the other.
fn alpha(counts: &[[u64; 3]], ordinal: bool) -> Option<f64> {
    let mut coincidences = [[0.0; 3]; 3];
    for counts in counts.iter().filter(|counts| counts.iter().sum::<u64>() > 1) {
        let [a, t, b] = counts.map(|count| count as f64);
        for unit in [[a, t, b], [b, t, a]] {
            for (i, row) in coincidences.iter_mut().enumerate() {
                for (j, cell) in row.iter_mut().enumerate() {
                    let pairs = unit[i] * (unit[j] - f64::from(u8::from(i == j)));
                    *cell += pairs / (a + t + b - 1.0);
                }
            }
        }
    }
    let margins = coincidences.map(|row| row.iter().sum::<f64>());
    let all: f64 = margins.iter().sum();
    let apart = |i: usize, j: usize| match (ordinal, i.abs_diff(j)) {
        (_, 0) => 0.0,
        (false, _) => 1.0,
        (true, 1) => (0.5 * (margins[i] + margins[j])).powi(2),
        (true, _) => (0.5 * (margins[0] + margins[2]) + margins[1]).powi(2),
    };
    let pairs = || (0..3).flat_map(|i| (0..3).map(move |j| (i, j)));
    let seen: f64 = pairs().map(|(i, j)| coincidences[i][j] * apart(i, j)).sum();
    let by_chance: f64 =
        pairs().map(|(i, j)| margins[i] * margins[j] * apart(i, j)).sum::<f64>() / (all - 1.0);
    (all > 0.0 && by_chance > 1e-9).then(|| 1.0 - seen / by_chance)
}

/// Chi-square, its degrees of freedom and p.
type Test = (f64, f64, f64);

/// Kendall's u, and its test: chi-square, degrees and p.
fn kendall(counts: &[[u64; 3]]) -> Option<(f64, Option<Test>)> {
    let judges: u64 = counts[0].iter().sum();
    if judges < 2 || counts.iter().any(|own| own.iter().sum::<u64>() != judges) {
        return None;
    }
    let (m, pairs) = (judges as f64, counts.len() as f64);
    let of_two = |n: f64| n * (n - 1.0) / 2.0;
    // Pairs of judges who agree; whoever has no preference is half a judge for each.
    let agreeing: f64 = counts
        .iter()
        .map(|&[a, t, b]| of_two(a as f64 + t as f64 / 2.0) + of_two(b as f64 + t as f64 / 2.0))
        .sum();
    let test = (judges > 2).then(|| {
        let statistic = 4.0 / (m - 2.0) * (agreeing - 0.5 * pairs * of_two(m) * (m - 3.0) / (m - 2.0));
        let degrees = pairs * m * (m - 1.0) / (m - 2.0).powi(2);
        let p = ChiSquared::new(degrees).expect("degrees above zero").sf(statistic.max(0.0));
        (statistic, degrees, p)
    });
    Some((2.0 * agreeing / (pairs * of_two(m)) - 1.0, test))
}

#[derive(Default)]
pub(in crate::self_test::truths) struct Triads {
    pub(in crate::self_test::truths) all: u64,
    pub(in crate::self_test::truths) decided: u64,
    pub(in crate::self_test::truths) strict: u64,
    weak: u64,
    /// Who decided every pair, and the sum of their zeta.
    tournaments: u64,
    zeta: f64,
}

/// Three methods that one person compared with one another on one object, in one group.
pub(in crate::self_test::truths) fn triads(
    oracle: &Oracle<'_>,
    inside: impl Fn(&Question) -> bool,
) -> Triads {
    let mut found = Triads::default();
    for object in &oracle.objects {
        for (group, members) in &oracle.groups {
            let here = |q: &Question| q.object_name == *object && q.group == *group && inside(q);
            for own in &oracle.comparisons {
                let own = own.iter().filter(|(q, _)| here(&oracle.questions[*q])).map(|(_, given)| *given);
                add(&mut found, members, &own.collect::<Vec<_>>());
            }
        }
    }
    found
}

fn add(found: &mut Triads, members: &[String], own: &[&Given]) {
    let mut chosen: BTreeMap<[&str; 2], Option<&str>> = BTreeMap::new();
    for given in own {
        chosen.insert([given.left(), given.right()], given.chosen());
        chosen.insert([given.right(), given.left()], given.chosen());
    }
    let between = |i: usize, j: usize| chosen.get(&[members[i].as_str(), members[j].as_str()]).copied();
    for i in 0..members.len() {
        for j in i + 1..members.len() {
            for k in j + 1..members.len() {
                let [Some(a), Some(b), Some(c)] = [between(i, j), between(j, k), between(k, i)] else {
                    continue;
                };
                // How often somebody wins along i, j, k, i, and how often against.
                let along =
                    [(a, i), (b, j), (c, k)].iter().filter(|(won, at)| *won == Some(&members[*at])).count();
                let ties = [a, b, c].iter().filter(|won| won.is_none()).count();
                let against = 3 - ties - along;
                found.all += 1;
                found.decided += u64::from(ties == 0);
                found.strict += u64::from(along == 3 || against == 3);
                found.weak += u64::from(ties == 1 && (along == 2 || against == 2));
            }
        }
    }
    let n = members.len();
    let wins = |i: usize| (0..n).filter(|&j| between(i, j) == Some(Some(members[i].as_str()))).count();
    let all_decided = (0..n).all(|i| (0..n).all(|j| i == j || matches!(between(i, j), Some(Some(_)))));
    if n > 2 && all_decided {
        // Circles are what is left of all triads once those with an item that beats both others are taken off.
        let of_two = |n: usize| (n * n.saturating_sub(1) / 2) as f64;
        let circles = (n * (n - 1) * (n - 2) / 6) as f64 - (0..n).map(|i| of_two(wins(i))).sum::<f64>();
        let most = if n % 2 == 1 { n * (n * n - 1) / 24 } else { n * (n * n - 4) / 24 };
        found.tournaments += 1;
        found.zeta += 1.0 - circles / most as f64;
    }
}
