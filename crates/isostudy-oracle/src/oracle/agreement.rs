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
            let ends = ends(&everybody, ordinal);
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

/// The ends of alpha's interval: the odds that a test of them rejects. None where few people answered, or few disagree.
fn ends(people: &[Vec<[u64; 3]>], ordinal: bool) -> Option<[f64; 2]> {
    let all = sums(people);
    let value = alpha(&all, ordinal)?;
    let total = |counts: &[u64; 3]| counts.iter().sum::<u64>();
    let questions: Vec<usize> = (0..all.len()).filter(|&q| total(&all[q]) > 1).collect();
    let n = questions.len() as f64;
    let answered =
        people.iter().map(|own| questions.iter().filter(|&&q| total(&own[q]) > 0).count()).sum::<usize>();
    let per_question = answered as f64 / n;
    if n < 4.0 || per_question < 12.0 || n * (1.0 - value) < 3.0 {
        return None;
    }
    // What one answer less to a question does, on average over its answers.
    let mean_effect = |q: usize| {
        let of_answer = |i: usize| {
            let mut rest = all.clone();
            rest[q][i] -= 1;
            Some(all[q][i] as f64 * (alpha(&rest, ordinal)? - value))
        };
        let sum = (0..3).filter(|&i| all[q][i] > 0).map(of_answer).sum::<Option<f64>>()?;
        Some(sum / total(&all[q]).max(1) as f64)
    };
    let effects: Vec<f64> = (0..all.len()).map(mean_effect).collect::<Option<_>>()?;
    let without = |own: &Vec<[u64; 3]>| {
        let rest: Vec<[u64; 3]> =
            all.iter().zip(own).map(|(sum, own)| [0, 1, 2].map(|i| sum[i] - own[i])).collect();
        let expected: f64 = own.iter().zip(&effects).map(|(own, effect)| total(own) as f64 * effect).sum();
        Some(alpha(&rest, ordinal)? - expected)
    };
    let left_out: Vec<f64> = people.iter().map(without).collect::<Option<_>>()?;
    let m = left_out.len() as f64;
    let middle = left_out.iter().sum::<f64>() / m;
    let squares = left_out.iter().map(|x| (x - middle).powi(2)).sum::<f64>();
    let of_alpha = squares * (1.0 - 1.0 / per_question);
    let (own, free) = (own_pairs(&all, ordinal), deviations(people, &all, ordinal));
    let odds = |alpha: f64| alpha / (1.0 - alpha);
    // The chance of an estimate below another if the odds are x.
    let chance = |estimate: f64, x: f64| {
        let positive = x.max(0.0);
        let mean = positive + own;
        let parts = [
            2.0 * own * own / free,
            of_alpha / (1.0 - value).powi(4) * positive / (odds(value) + own).max(1e-9),
        ];
        let variance = parts[0] + parts[1];
        let degrees = variance.powi(2)
            / (parts[0].powi(2) / ((m - 1.0) * free) + parts[1].powi(2) / (per_question - 1.0));
        let h = variance / mean.powi(2) / 9.0;
        let z = (((odds(estimate) + own - (x - positive)) / mean).cbrt() - (1.0 - h)) / h.sqrt();
        StudentsT::new(0.0, 1.0, degrees).expect("two degrees or more").cdf(z)
    };
    let halved = |mut not: f64, mut is: f64, rejected: &dyn Fn(f64) -> bool| {
        for _ in 0..120 {
            let x = 0.5 * (not + is);
            *(if rejected(x) { &mut is } else { &mut not }) = x;
        }
        is / (1.0 + is)
    };
    let low = match chance(value, -0.5) >= 0.975 {
        true => halved(odds(value), -0.5, &|x| chance(value, x) >= 0.975),
        false => -1.0,
    };
    // Only estimates that are printed are compared, and half of the chance that the lower end leaves is used.
    let too_low = |x: f64| {
        let printed = chance(1.0 - 3.0 / n, x);
        chance(value, x) <= 0.0375 * printed - (printed - 0.975).max(0.0) / 2.0
    };
    let steps = (0..).map(|step| (odds(value) + 1.0) * 1.002_f64.powi(step) - 1.0);
    let high = steps.take_while(|x| *x < 999.0).find(|x| too_low(*x));
    let high = high.map_or(1.0, |x| halved((x + 1.0) / 1.002 - 1.0, x, &too_low));
    Some([low, high])
}

/// How far two values are apart, up to a factor that all distances share.
fn apart(i: usize, j: usize, ordinal: bool) -> f64 {
    let steps = i.abs_diff(j) as f64;
    if ordinal { steps * steps } else { steps.min(1.0) }
}

/// The share of the disagreement between different answers that goes if each is paired with itself as well.
fn own_pairs(counts: &[[u64; 3]], ordinal: bool) -> f64 {
    let [mut different, mut with_own] = [0.0; 2];
    for counts in counts.iter().map(|counts| counts.map(|count| count as f64)) {
        let n: f64 = counts.iter().sum();
        if n >= 2.0 {
            let pairs =
                |i: usize| (0..3).map(move |j| counts[i] * counts[j] * apart(i, j, ordinal)).sum::<f64>();
            let disagreement: f64 = (0..3).map(pairs).sum();
            different += disagreement / (n - 1.0);
            with_own += disagreement / n;
        }
    }
    1.0 - with_own / different
}

/// How many independent deviations the shares of the questions have: of each person a list of how they move them, of these lists the
/// covariance, and of that the trace squared over the trace of the square.
fn deviations(people: &[Vec<[u64; 3]>], all: &[[u64; 3]], ordinal: bool) -> f64 {
    let asked: Vec<usize> = (0..all.len()).filter(|&q| all[q].iter().sum::<u64>() >= 2).collect();
    let answers = |q: usize| all[q].iter().sum::<u64>() as f64;
    let root: Vec<f64> = asked.iter().map(|&q| answers(q).sqrt()).collect();
    let total: f64 = asked.iter().map(|&q| answers(q)).sum();
    // Of values of the three answers: how a person's answers to a question are above what all people give it.
    let above = |own: &[[u64; 3]], values: [f64; 3]| -> Vec<f64> {
        let sum = |counts: [u64; 3]| (0..3).map(|i| counts[i] as f64 * values[i]).sum::<f64>();
        let of = |q: usize| sum(own[q]) - own[q].iter().sum::<u64>() as f64 * sum(all[q]) / answers(q);
        asked.iter().zip(&root).map(|(&q, root)| of(q) / root).collect()
    };
    let moves = |own: &Vec<[u64; 3]>| {
        let mut list = above(own, [1.0, 0.0, -1.0]);
        if !ordinal {
            let neither = above(own, [0.0, 1.0, 0.0]);
            let mean: f64 = neither.iter().zip(&root).map(|(x, root)| x * root).sum::<f64>() / total;
            list.extend(neither.iter().zip(&root).map(|(x, root)| 3.0_f64.sqrt() * (x - mean * root)));
        }
        list
    };
    let lists: Vec<Vec<f64>> = people.iter().map(moves).collect();
    let (n, size) = (lists.len() as f64, lists[0].len());
    let covariance = |a: usize, b: usize| lists.iter().map(|list| list[a] * list[b]).sum::<f64>() / (n - 1.0);
    let trace: f64 = (0..size).map(|a| covariance(a, a)).sum();
    let square: f64 =
        (0..size).flat_map(|a| (0..size).map(move |b| (a, b))).map(|(a, b)| covariance(a, b).powi(2)).sum();
    let lengths = |list: &Vec<f64>| list.iter().map(|x| x * x).sum::<f64>().powi(2);
    let fourth = lists.iter().map(lengths).sum::<f64>() / (n - 1.0);
    let unbiased = (n - 1.0) / (n * (n - 2.0) * (n - 3.0))
        * ((n - 1.0) * (n - 2.0) * square + trace * trace - n * fourth);
    let free = trace * trace / unbiased;
    if unbiased > 0.0 { free.clamp(1.0, size as f64) } else { size as f64 }
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
pub(crate) struct Triads {
    pub(crate) all: u64,
    pub(crate) decided: u64,
    pub(crate) strict: u64,
    weak: u64,
    /// Who decided every pair, and the sum of their zeta.
    tournaments: u64,
    zeta: f64,
}

/// Three methods that one person compared with one another on one object, in one group.
pub(crate) fn triads(oracle: &Oracle<'_>, inside: impl Fn(&Question) -> bool) -> Triads {
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
