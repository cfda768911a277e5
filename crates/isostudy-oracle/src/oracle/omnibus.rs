//! Friedman's tests: are the values of a factor liked alike, and does a preference depend on anything?

use super::{Expected, Given, Oracle, Want};
use crate::exact::{Ratio, holm, ratio};
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// By person, a score in each column; none where nothing of it was answered.
type Rows = Vec<Vec<Option<Ratio>>>;

pub(super) fn expected(oracle: &Oracle<'_>) -> Expected {
    let columns = &["chi_square", "degrees", "p", "p_adjusted", "participants"];
    let mut table = Expected::new("omnibus", &["question", "scores"], columns);
    let [mut by_other, mut by_object] = [Vec::new(), Vec::new()];
    for factor in ["clustering", "arrangement", "method"] {
        let other = if factor == "clustering" { "arrangement" } else { "clustering" };
        let levels = levels(oracle, factor);
        if factor != "method" && levels.len() > 2 {
            let scores = format!("wins minus losses of each {factor}");
            add(&mut table, vec![(factor.into(), scores, wins_minus_losses(oracle, factor, &levels))]);
        }
        for pair in pairs(oracle, factor) {
            let minus = format!("{} minus {}", label(factor, &pair[0]), label(factor, &pair[1]));
            let others = by(oracle, factor, &pair, |q| {
                oracle.questions[q].compared.within.clone().unwrap_or_default()
            });
            if factor != "method" && others.first().is_some_and(|row| row.len() > 2) {
                by_other.push((format!("{factor} x {other}"), format!("{minus}, by {other}"), others));
            }
            let objects = by(oracle, factor, &pair, |q| oracle.questions[q].object_name.clone());
            by_object.push((format!("object x {factor}"), format!("{minus}, by object"), objects));
        }
    }
    add(&mut table, by_other);
    add(&mut table, by_object);
    table
}

/// By pair of values, p of the test over objects, corrected.
pub(super) fn by_object(oracle: &Oracle<'_>) -> Vec<([String; 2], f64)> {
    let mut asked = Vec::new();
    for factor in ["clustering", "arrangement", "method"] {
        for pair in pairs(oracle, factor) {
            let rows = by(oracle, factor, &pair, |q| oracle.questions[q].object_name.clone());
            let complete: Vec<Vec<Ratio>> =
                rows.into_iter().filter_map(|row| row.into_iter().collect()).collect();
            asked.extend(friedman(&complete).map(|(.., p)| (pair, p)));
        }
    }
    let adjusted = holm(&asked.iter().map(|(_, p)| *p).collect::<Vec<_>>());
    asked.into_iter().zip(adjusted).map(|((pair, _), p)| (pair, p)).collect()
}

/// Adds tests that are corrected together.
fn add(table: &mut Expected, asked: Vec<(String, String, Rows)>) {
    let tested = asked.into_iter().filter_map(|(question, scores, rows)| {
        let complete: Vec<Vec<Ratio>> =
            rows.into_iter().filter_map(|row| row.into_iter().collect()).collect();
        Some((question, scores, friedman(&complete)?, complete.len()))
    });
    let tested: Vec<_> = tested.collect();
    let adjusted = holm(&tested.iter().map(|(.., (_, _, p), _)| *p).collect::<Vec<_>>());
    for ((question, scores, (statistic, degrees, p), people), adjusted) in tested.into_iter().zip(adjusted) {
        let cells = vec![
            Want::Near(statistic),
            Want::Near(degrees),
            Want::p(p),
            Want::p(adjusted),
            Want::count(people as u64),
        ];
        table.push([&question, &scores], cells);
    }
}

/// Conover's form, in which ties need no correction: (k - 1) times the squares between columns over all squares of ranks.
fn friedman(rows: &[Vec<Ratio>]) -> Option<(f64, f64, f64)> {
    let k = rows.first()?.len();
    let ranks = |row: &Vec<Ratio>| -> Vec<f64> {
        let below = |a: Ratio, b: Ratio| a.0 * b.1 < b.0 * a.1;
        let rank = |own: &Ratio| {
            let lower = row.iter().filter(|other| below(**other, *own)).count() as f64;
            let same = row.iter().filter(|other| *other == own).count() as f64;
            lower + (same + 1.0) / 2.0
        };
        row.iter().map(rank).collect()
    };
    let ranks: Vec<Vec<f64>> = rows.iter().map(ranks).collect();
    let (n, middle) = (rows.len() as f64, (k as f64 + 1.0) / 2.0);
    let within: f64 = ranks.iter().flatten().map(|rank| (rank - middle).powi(2)).sum();
    let between: f64 =
        (0..k).map(|j| ranks.iter().map(|row| row[j]).sum::<f64>() / n - middle).map(|d| n * d * d).sum();
    let degrees = k as f64 - 1.0;
    (k > 1 && within > 0.0).then(|| {
        let statistic = n * degrees * between / within;
        (statistic, degrees, ChiSquared::new(degrees).expect("two columns or more").sf(statistic))
    })
}

/// The pairs of values of a factor that are compared, as first listed.
fn pairs(oracle: &Oracle<'_>, factor: &str) -> Vec<[String; 2]> {
    let mut pairs: Vec<[String; 2]> = Vec::new();
    for of in oracle.questions.iter().map(|question| &question.compared).filter(|of| of.factor == factor) {
        let [a, b] = &of.levels;
        if !pairs.iter().any(|[x, y]| [x, y] == [a, b] || [y, x] == [a, b]) {
            pairs.push(of.levels.clone());
        }
    }
    pairs
}

/// The values of a factor that are compared.
fn levels(oracle: &Oracle<'_>, factor: &str) -> Vec<String> {
    let mut levels: Vec<String> = pairs(oracle, factor).into_iter().flatten().collect();
    levels.sort_unstable();
    levels.dedup();
    levels
}

fn label(factor: &str, code: &str) -> String {
    let lattice = |letter: &str| match letter {
        "B" => "body-centred",
        "S" => "simple cubic",
        "M" => "five tetrahedra",
        _ => "face-centred",
    };
    let clustering = |letter: &str| match letter {
        "U" => "none",
        "I" => "integrated",
        "P" => "edge collapse",
        _ => "integrated + collapse",
    };
    let upper = code.to_uppercase();
    match factor {
        "arrangement" => lattice(&upper).into(),
        "clustering" => clustering(&upper).into(),
        _ => format!("{}, {}", lattice(&upper[..1]), clustering(&upper[1..])),
    }
}

/// A mean that grows: net and number of answers.
fn mean(cells: &[(i128, i128)]) -> Vec<Option<Ratio>> {
    cells.iter().map(|&(net, answers)| (answers > 0).then(|| ratio(net, answers))).collect()
}

fn wins_minus_losses(oracle: &Oracle<'_>, factor: &str, levels: &[String]) -> Rows {
    let of_person = |own: &Vec<(usize, &Given)>| {
        let mut cells = vec![(0, 0); levels.len()];
        for (q, given) in own {
            let question = &oracle.questions[*q];
            if question.compared.factor != factor {
                continue;
            }
            for (level, method) in question.compared.levels.iter().zip([&question.left, &question.right]) {
                let cell =
                    &mut cells[levels.iter().position(|of| of == level).expect("a value that is compared")];
                cell.0 += given.chosen().map_or(0, |chosen| if chosen == method { 1 } else { -1 });
                cell.1 += 1;
            }
        }
        mean(&cells)
    };
    oracle.comparisons.iter().map(of_person).collect()
}

/// One pair of values, in columns.
fn by(oracle: &Oracle<'_>, factor: &str, pair: &[String; 2], column: impl Fn(usize) -> String) -> Rows {
    let sign = |q: usize| match &oracle.questions[q].compared {
        of if of.factor != factor => None,
        of if of.levels == *pair => Some(1),
        of if [&of.levels[1], &of.levels[0]] == [&pair[0], &pair[1]] => Some(-1),
        _ => None,
    };
    let signs: Vec<Option<i128>> = (0..oracle.questions.len()).map(sign).collect();
    let mut names: Vec<String> = (0..signs.len()).filter(|&q| signs[q].is_some()).map(&column).collect();
    names.sort_unstable();
    names.dedup();
    let place = |q: usize| names.iter().position(|name| *name == column(q)).unwrap_or(0);
    let places: Vec<usize> = (0..signs.len()).map(place).collect();
    let of_person = |own: &Vec<(usize, &Given)>| {
        let mut cells = vec![(0, 0); names.len()];
        for &(q, given) in own {
            let Some(sign) = signs[q] else { continue };
            let left = &oracle.questions[q].left;
            cells[places[q]].0 +=
                sign * given.chosen().map_or(0, |chosen| if chosen == left { 1 } else { -1 });
            cells[places[q]].1 += 1;
        }
        mean(&cells)
    };
    oracle.comparisons.iter().map(of_person).collect()
}
