//! How often intervals cover what is true and tests reject it, counted over simulated studies.
//!
//! `cargo test --release -p isostudy-statistics coverage -- --ignored --nocapture` prints the table of docs/statistics.md.

use super::*;
use crate::{Metric, Participants, Scale, alpha_with_interval, scale};
use rayon::prelude::*;

/// Studies a line; people a study.
const STUDIES: u64 = 300;
const PEOPLE: [usize; 4] = [12, 18, 60, 300];

/// What people see of the pairs of six items on three scenes.
#[derive(Clone, Copy, Debug)]
enum Asked {
    /// Every pair on every scene.
    Everything,
    /// One of three blocks: every pair once, on a scene that changes with the pair and the block.
    ABlock,
}

/// What a participant was asked, of all that could be.
fn asked(ballots: Vec<ShownBallot>, of: Asked) -> Vec<ShownBallot> {
    let in_block =
        |b: &ShownBallot| (b.question() % 15 + b.question() / 15 + b.participant()).is_multiple_of(3);
    match of {
        Asked::Everything => ballots,
        Asked::ABlock => ballots.into_iter().filter(in_block).collect(),
    }
}

/// The log worths that a model finds in the answers of very many people, and their alpha: what intervals are to cover.
fn truth(population: &Population, plan: &Plan) -> (Vec<f64>, f64) {
    let ballots = simulate(plan, population, 100_000, &mut stream(77, 0));
    let worths = crate::fit(crate::Model::Davidson, &crate::Pairs::of(6, &ballots)).unwrap().log_worths;
    let by_item: Vec<_> = ballots.iter().map(ShownBallot::by_item).collect();
    (worths, alpha_with_interval(&by_item, Metric::Nominal).unwrap().value)
}

#[derive(Default, Clone, Copy)]
struct Counts {
    differences: f64,
    covered: f64,
    lowest: f64,
    any_rejected: f64,
    f_rejected: f64,
    chi_rejected: f64,
    penalised: f64,
    alpha: f64,
}

#[test]
#[ignore = "minutes: run by make test-long; prints a table"]
fn coverage_of_differences_and_alpha() {
    let plan = Plan::round_robin(6, 3);
    println!(
        "asked | truth | people | differences | least | any p <= 0.05 (Holm) | omnibus F | chi-square | alpha | penalised"
    );
    for worths in [vec![0.0; 6], vec![0.0, 0.4, 0.6, 1.2, 1.5, 1.7]] {
        let null = worths[5] == 0.0;
        let population = Population { worths, ..Population::indifferent(6, 0.8) };
        let (true_worths, true_alpha) = truth(&population, &plan);
        for of in [Asked::Everything, Asked::ABlock] {
            for people in PEOPLE {
                let one = |study: u64| {
                    let ballots = simulate(&plan, &population, people, &mut stream(people as u64, study));
                    let ballots = asked(ballots, of);
                    let found = scale(&Participants::of(6, &ballots), 0).unwrap();
                    let by_item: Vec<_> = ballots.iter().map(ShownBallot::by_item).collect();
                    let alpha =
                        alpha_with_interval(&by_item, Metric::Nominal).and_then(|alpha| alpha.interval);
                    (found, alpha.is_some_and(|i| i.low <= true_alpha && true_alpha <= i.high))
                };
                let all: Vec<(Scale, bool)> = (0..STUDIES).into_par_iter().map(one).collect();
                print_line(of, null, people, &all, &true_worths);
            }
        }
    }
}

fn print_line(of: Asked, null: bool, people: usize, all: &[(Scale, bool)], worths: &[f64]) {
    let mut counts = Counts::default();
    let mut of_pair = [[0.0; 2]; 15];
    for (found, alpha) in all {
        counts.alpha += f64::from(*alpha);
        counts.penalised += f64::from(found.fit.penalised());
        let mut any = false;
        for (place, d) in of_pair.iter_mut().zip(&found.differences) {
            let Some(spread) = d.spread else { continue };
            let is = worths[d.first] - worths[d.second];
            let covers = f64::from(spread.interval.low <= is && is <= spread.interval.high);
            place[0] += covers;
            place[1] += 1.0;
            counts.covered += covers;
            counts.differences += 1.0;
            any |= spread.adjusted <= 0.05;
        }
        counts.any_rejected += f64::from(any);
        if let Ok(omnibus) = found.omnibus {
            counts.f_rejected += f64::from(omnibus.p <= 0.05);
            let [free, rest] = omnibus.degrees.map(|d| d as f64);
            let wald = omnibus.f * free * (people as f64 - 1.0) / rest;
            let chi = statrs::distribution::ChiSquared::new(free).unwrap();
            counts.chi_rejected += f64::from(statrs::distribution::ContinuousCDF::sf(&chi, wald) <= 0.05);
        }
    }
    counts.lowest = of_pair.iter().map(|[covered, of]| covered / of).fold(1.0, f64::min);
    let n = all.len() as f64;
    println!(
        "{of:?} | {} | {people} | {:.3} | {:.3} | {:.3} | {:.3} | {:.3} | {:.3} | {}",
        if null { "none" } else { "worths" },
        counts.covered / counts.differences,
        counts.lowest,
        counts.any_rejected / n,
        counts.f_rejected / n,
        counts.chi_rejected / n,
        counts.alpha / n,
        counts.penalised
    );
}
