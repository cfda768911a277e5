//! Counts of answers, and the preference factors that are made from them.

use super::{Expected, Oracle, Question, Want};
use crate::exact::t_interval;
use crate::people::Given;

/// The tables of counts and factors.
pub(super) fn expected(oracle: &Oracle<'_>) -> Vec<Expected> {
    vec![
        questions(oracle),
        groups(oracle),
        overall(oracle),
        margins(oracle),
        objects(oracle),
        arrangements(oracle),
    ]
}

fn questions(oracle: &Oracle<'_>) -> Expected {
    let columns = &[
        "object",
        "left",
        "right",
        "left_answers",
        "no_preference",
        "right_answers",
        "right_share",
        "right_share_low",
        "right_share_high",
    ];
    let mut table = Expected::new("answer_counts", &["question"], columns);
    for of in &oracle.questions {
        let counts = oracle.score(|q| q.id == of.id, |chosen| chosen == of.left);
        let [left, none, right] = counts;
        let all = left + none + right;
        let share = (all > 0).then(|| right as f64 / all as f64);
        let wilson = share.map(|p| wilson(p, all as f64));
        table.push(
            [&of.id],
            vec![
                Want::Is(of.object_name.clone()),
                Want::Is(format!("{}_{}", of.object_name, of.left)),
                Want::Is(format!("{}_{}", of.object_name, of.right)),
                Want::count(left),
                Want::count(none),
                Want::count(right),
                Want::number(share),
                Want::number(wilson.map(|ends| ends[0])),
                Want::number(wilson.map(|ends| ends[1])),
            ],
        );
    }
    table
}

/// The shares p from which p0 is 1.96 standard errors away: the roots of (p0 - p)^2 = z^2 p (1 - p) / n.
fn wilson(p0: f64, n: f64) -> [f64; 2] {
    let z2 = 1.959_963_984_540_054_f64.powi(2) / n;
    let (a, b, c) = (1.0 + z2, -(2.0 * p0 + z2), p0 * p0);
    let root = (b * b - 4.0 * a * c).max(0.0).sqrt();
    [(-b - root) / (2.0 * a), (-b + root) / (2.0 * a)].map(|end| end.clamp(0.0, 1.0))
}

/// Wins of a method, ties and answers over some questions, and how many answers could have been for it.
struct Won {
    wins: u64,
    ties: u64,
    answers: u64,
    shown: u64,
}

impl Won {
    fn of(oracle: &Oracle<'_>, method: &str, meant: impl Fn(&Question) -> bool) -> Self {
        let [wins, ties, others] = oracle.score(&meant, |chosen| chosen == method);
        let shows = |q: &Question| meant(q) && (q.left == method || q.right == method);
        let shown = oracle.score(shows, |_| true).iter().sum();
        Self { wins, ties, answers: wins + ties + others, shown }
    }

    fn factor(&self) -> f64 {
        self.wins as f64 / self.answers as f64
    }

    fn cap(&self) -> f64 {
        self.shown as f64 / self.answers as f64
    }
}

fn groups(oracle: &Oracle<'_>) -> Expected {
    let columns = &["wins", "ties", "answers", "factor", "cap", "appearances", "appearance_share"];
    let mut table = Expected::new("preference_groups", &["group", "configuration"], columns);
    for (group, members) in &oracle.groups {
        for method in members {
            let won = Won::of(oracle, method, |q| q.group == *group);
            if won.answers > 0 {
                table.push(
                    [group, method],
                    vec![
                        Want::count(won.wins),
                        Want::count(won.ties),
                        Want::count(won.answers),
                        Want::Near(won.factor()),
                        Want::Near(won.cap()),
                        Want::count(won.shown),
                        Want::number((won.shown > 0).then(|| won.wins as f64 / won.shown as f64)),
                    ],
                );
            }
        }
    }
    table
}

/// The sum of a method's factors in all groups that have it.
fn sum(oracle: &Oracle<'_>, method: &str) -> Option<f64> {
    let own = oracle.groups.iter().filter(|(_, members)| members.iter().any(|member| member == method));
    let factors: Vec<f64> = own
        .map(|(group, _)| Won::of(oracle, method, |q| q.group == *group))
        .filter(|won| won.answers > 0)
        .map(|won| won.factor())
        .collect();
    (!factors.is_empty()).then(|| factors.iter().sum())
}

fn overall(oracle: &Oracle<'_>) -> Expected {
    let mut table = Expected::new("preference_overall", &["configuration"], &["factor"]);
    for (method, sum) in sums(oracle) {
        table.push([&method], vec![Want::Near(sum)]);
    }
    table
}

fn sums(oracle: &Oracle<'_>) -> Vec<(String, f64)> {
    let methods = oracle.lattices.iter().flat_map(|lattice| {
        oracle.clusterings.iter().map(move |clustering| format!("{lattice}{clustering}"))
    });
    methods.filter_map(|method| sum(oracle, &method).map(|sum| (method, sum))).collect()
}

fn margins(oracle: &Oracle<'_>) -> Expected {
    let mut table = Expected::new("preference_margins", &["margin", "code"], &["factor"]);
    let sums = sums(oracle);
    for (kind, letters, place) in
        [("arrangement", &oracle.lattices, 0), ("clustering", &oracle.clusterings, 1)]
    {
        for letter in letters {
            let own: Vec<f64> = sums
                .iter()
                .filter(|(m, _)| m.chars().nth(place) == Some(*letter))
                .map(|(_, sum)| *sum)
                .collect();
            if !own.is_empty() {
                let mean = own.iter().sum::<f64>() / own.len() as f64;
                table.push([kind, &letter.to_string()], vec![Want::Near(mean)]);
            }
        }
    }
    table
}

fn objects(oracle: &Oracle<'_>) -> Expected {
    let columns = &["wins", "ties", "answers", "factor", "low", "high"];
    let mut table = Expected::new("preference_objects", &["object", "group", "configuration"], columns);
    for object in &oracle.objects {
        for (group, members) in &oracle.groups {
            for method in members {
                let meant = |q: &Question| q.group == *group && q.object_name == *object;
                let won = Won::of(oracle, method, meant);
                if won.answers == 0 {
                    continue;
                }
                // Each person's own factor.
                let factor = |own: &Vec<(usize, &Given)>| {
                    let own = own.iter().filter(|(q, _)| meant(&oracle.questions[*q]));
                    let won: Vec<bool> = own.map(|(_, given)| given.chosen() == Some(method)).collect();
                    let wins = won.iter().filter(|won| **won).count() as f64;
                    (!won.is_empty()).then(|| wins / won.len() as f64)
                };
                let factors: Vec<f64> = oracle.comparisons.iter().filter_map(factor).collect();
                let ends = match won.answers == factors.len() as u64 && factors.len() > 1 {
                    true => Some(score_interval(won.wins as f64, won.answers as f64)),
                    false => t_interval(&factors).map(|ends| ends.map(|end| end.clamp(0.0, won.cap()))),
                };
                table.push(
                    [object, group, method],
                    vec![
                        Want::count(won.wins),
                        Want::count(won.ties),
                        Want::count(won.answers),
                        Want::Near(won.factor()),
                        Want::number(ends.map(|ends| ends[0])),
                        Want::number(ends.map(|ends| ends[1])),
                    ],
                );
            }
        }
    }
    table
}

/// Body-centred against simple cubic where nothing else differs, wherever that was asked.
fn arrangements(oracle: &Oracle<'_>) -> Expected {
    let columns = &["body_centred", "no_preference", "simple_cubic"];
    let mut table = Expected::new("preference_arrangements", &["object", "group"], columns);
    let direct = |q: &Question| {
        let [left, right] = [&q.left, &q.right].map(|method| method.split_at(1));
        left.1 == right.1
            && [left.0, right.0].iter().all(|lattice| "bs".contains(lattice))
            && left.0 != right.0
    };
    let any_object = oracle.objects.iter().map(String::as_str).chain(["all"]);
    for object in any_object {
        for group in oracle.groups.iter().map(|(group, _)| group.as_str()).chain(["all"]) {
            let meant = |q: &Question| {
                let [here, own] =
                    [object == "all" || q.object_name == object, group == "all" || q.group == group];
                direct(q) && here && own
            };
            let [body, none, simple] = oracle.score(meant, |chosen| chosen.starts_with('b'));
            if body + none + simple > 0 {
                table.push([object, group], vec![Want::count(body), Want::count(none), Want::count(simple)]);
            }
        }
    }
    table
}

/// The shares that are at most 1.96 of their own standard errors from what was seen, by halving.
fn score_interval(wins: f64, answers: f64) -> [f64; 2] {
    let seen = wins / answers;
    let far =
        |share: f64| (seen - share).abs() > 1.959_963_984_540_054 * (share * (1.0 - share) / answers).sqrt();
    [0.0, 1.0].map(|end| {
        let (mut out, mut inside) = (end, seen);
        if !far(end) {
            return end;
        }
        for _ in 0..200 {
            let middle = 0.5 * (out + inside);
            if far(middle) { out = middle } else { inside = middle }
        }
        inside
    })
}
