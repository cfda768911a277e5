//! What choosing pairs does to errors, intervals and tests: counted over simulated studies.
//!
//! `cargo test --release -p isostudy-statistics measured -- --ignored --nocapture` prints the table of docs/adaptive.md.

use super::*;
use crate::{Coefficient, Model, Scale, fit, scale};
use rayon::prelude::*;
use statrs::distribution::{ContinuousCDF, Normal};

/// Studies of each case.
const STUDIES: u64 = 40;

/// How the pairs of a study come about.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Design {
    /// All of them are dealt.
    Balanced,
    /// Half of them are.
    Adaptive,
}

#[derive(Clone, Copy, Debug)]
struct Case {
    items: usize,
    people: usize,
    asked: usize,
    /// Standard deviation of the items' log worths.
    spread: f64,
    /// Standard deviation between people.
    sd: f64,
}

impl Case {
    /// Normal quantiles times the spread, each of two items, so that there are differences that are none.
    fn population(self) -> Population {
        let levels = self.items / 2;
        let quantile = |i: usize| Normal::standard().inverse_cdf((i as f64 + 0.5) / levels as f64);
        let worths = (0..self.items).map(|item| self.spread * quantile(item % levels)).collect();
        Population { worths, ..Population::indifferent(self.items, self.sd) }
    }

    /// The worths that Davidson's model finds in everybody's answers to every pair: people who differ make them smaller.
    fn truth(self) -> Vec<f64> {
        let population = self.population();
        let all = (0..self.items).flat_map(|a| (0..self.items).filter(move |&b| b != a).map(move |b| (a, b)));
        // Chances themselves in place of counts: no simulation is as exact.
        let answers = all.map(|(a, b)| (a, b, population.chances((a, b), 0).map(|p| 1e4 * p)));
        fit(Model::Davidson, &Pairs::new(self.items, answers)).unwrap().log_worths
    }

    fn study(self, design: Design, number: u64) -> Vec<ShownBallot> {
        let population = self.population();
        if design == Design::Adaptive {
            return adaptive(&population, self.people, self.asked, 1_000 + number);
        }
        let mut random = stream(5_000, number);
        let dealt = |person| dealt_pairs(self.items, person, self.asked, 5_000 + number);
        (0..self.people)
            .flat_map(|person| of_person(&population, person, &dealt(person), &mut random))
            .collect()
    }
}

/// Of one way to estimate: sums over studies.
#[derive(Default, Clone, Copy, Debug)]
struct Found {
    studies: f64,
    /// Mean square error of worths around their mean.
    error: f64,
    /// Share of differences whose interval covers them.
    covered: f64,
    /// Share of differences that are none with p of 5 % or less.
    rejected: f64,
}

impl Found {
    fn of(worths: &[f64], truth: &[f64], difference: impl Fn(usize, usize) -> Option<Coefficient>) -> Self {
        let items = truth.len();
        let mean = |of: &[f64]| of.iter().sum::<f64>() / items as f64;
        let (own, want) = (mean(worths), mean(truth));
        let off = worths.iter().zip(truth).map(|(got, t)| (got - own - t + want).powi(2));
        let mut found = Self { studies: 1.0, error: off.sum::<f64>() / items as f64, ..Self::default() };
        let (mut all, mut none) = (0.0, 0.0);
        for (a, b) in (0..items).flat_map(|a| (a + 1..items).map(move |b| (a, b))) {
            let Some(of) = difference(a, b) else { continue };
            let t = truth[a] - truth[b];
            all += 1.0;
            found.covered += f64::from(u8::from(of.interval.low <= t && t <= of.interval.high));
            if t.abs() < 1e-6 {
                none += 1.0;
                found.rejected += f64::from(u8::from(of.p <= 0.05));
            }
        }
        (found.covered, found.rejected) = (found.covered / all, found.rejected / none);
        found
    }

    fn plus(self, other: Self) -> Self {
        Self {
            studies: self.studies + other.studies,
            error: self.error + other.error,
            covered: self.covered + other.covered,
            rejected: self.rejected + other.rejected,
        }
    }

    fn mean(self) -> Self {
        let n = self.studies;
        Self {
            error: (self.error / n).sqrt(),
            covered: self.covered / n,
            rejected: self.rejected / n,
            ..self
        }
    }
}

/// By the likelihood alone, and drawn together. Studies in which items are separated have no estimate of the first kind.
fn judge(case: Case, design: Design, truth: &[f64], number: u64) -> [Found; 2] {
    let participants = Participants::of(case.items, &case.study(design, number));
    let by_likelihood = |of: &Scale| {
        let differences = &of.differences;
        let place = |a: usize, b: usize| differences.iter().position(|d| (d.first, d.second) == (a, b));
        Found::of(&of.fit.log_worths, truth, |a, b| {
            let of = differences[place(a, b)?];
            let spread = of.spread?;
            Some(Coefficient { estimate: of.log_odds, se: spread.se, interval: spread.interval, p: spread.p })
        })
    };
    let alone = scale(&participants, 0).ok().filter(|of| !of.fit.penalised());
    let together = shrunken(&participants).unwrap();
    [
        alone.as_ref().map_or(Found::default(), by_likelihood),
        Found::of(&together.log_worths, truth, |a, b| together.difference(a, b)),
    ]
}

fn all(case: Case, design: Design, studies: u64) -> [Found; 2] {
    let truth = case.truth();
    let each: Vec<[Found; 2]> =
        (0..studies).into_par_iter().map(|number| judge(case, design, &truth, number)).collect();
    let sum = |sum: [Found; 2], of: [Found; 2]| [sum[0].plus(of[0]), sum[1].plus(of[1])];
    each.into_iter().fold([Found::default(); 2], sum).map(Found::mean)
}

#[test]
fn a_small_study_covers_and_keeps_its_level() {
    // 100 studies of 24 people about 8 items, 10 of 28 pairs each. Differences within a study hang together: standard errors of the
    // shares are about 0.01, and 0.015 of the four differences that are none.
    let case = Case { items: 8, people: 24, asked: 10, spread: 2.0, sd: 0.8 };
    let [alone, together] = all(case, Design::Adaptive, 100);
    assert!((0.91..=0.985).contains(&together.covered), "{together:?}");
    assert!((0.005..=0.095).contains(&together.rejected), "{together:?}");
    assert!(together.error < alone.error, "{alone:?} {together:?}");
    // Where nothing differs, nothing is made up.
    let [_, none] = all(Case { spread: 0.0, ..case }, Design::Adaptive, 50);
    assert!(none.rejected < 0.06 && none.error < 0.2, "{none:?}");
}

#[test]
#[ignore = "minutes: run by make test-long; prints a table"]
fn thirty_six_items_measured() {
    println!(
        "spread | people differ | design | answers | alone: error, covered, none rejected, studies | together: the same"
    );
    for (spread, sd) in [(2.0, 0.8), (3.0, 0.8), (0.0, 0.8), (1.0, 0.8), (3.0, 0.0)] {
        for (design, asked) in
            [(Design::Balanced, 42), (Design::Balanced, 21), (Design::Adaptive, 21), (Design::Adaptive, 42)]
        {
            let case = Case { items: 36, people: 60, asked, spread, sd };
            let found = all(case, design, STUDIES);
            let told = found
                .map(|of| format!("{:.3} {:.3} {:.3} {}", of.error, of.covered, of.rejected, of.studies));
            println!("{spread} | {sd} | {design:?} | {} | {}", case.people * asked, told.join(" | "));
        }
    }
}
