//! How often intervals that are printed cover alpha, counted over simulated studies of many populations.
//!
//! `cargo test --release -p isostudy-statistics printed_intervals -- --ignored --nocapture` prints the table of docs/statistics.md.

use super::*;
use crate::simulation::{davidson, draw, normal};
use rand::Rng;
use rayon::prelude::*;

/// Studies of each population.
const STUDIES: u64 = 2_000;
/// Printed in fewer studies than this share, a population says too little of what is printed.
const RARE: f64 = 0.1;

/// How questions and people differ.
#[derive(Clone, Copy, Debug)]
enum Shape {
    /// Everybody leans to one side in three questions that belong together.
    Blocks,
    /// Everybody leans to one side in each question.
    Single,
    /// Likewise in three questions, and as much as questions differ.
    Leaning,
    /// One question of three is decided.
    Skew,
    /// All questions but so many are decided.
    AllBut(usize),
}

const SHAPES: [Shape; 6] =
    [Shape::Blocks, Shape::Single, Shape::Leaning, Shape::Skew, Shape::AllBut(1), Shape::AllBut(2)];

/// The advantage of the first in each question, per unit of agreement; and standard deviations between people: of three questions
/// together, and of each.
fn pattern(shape: Shape, questions: usize) -> (Vec<f64>, [f64; 2]) {
    let ramp = |i: usize, of: usize| if of > 1 { 2.0 * i as f64 / (of - 1) as f64 - 1.0 } else { 1.0 };
    let of = |f: &dyn Fn(usize) -> f64| (0..questions).map(f).collect();
    let sides = |i: usize| if i.is_multiple_of(2) { 1.0 } else { -1.0 };
    match shape {
        Shape::Blocks => {
            let jitter = [0.15, -0.1, -0.05];
            (of(&|i| ramp(i / 3, questions.div_ceil(3)) + jitter[i % 3]), [1.1, 0.0])
        }
        Shape::Single => (of(&|i| ramp(i, questions)), [0.0, 0.8]),
        Shape::Leaning => (of(&|i| ramp(i, questions)), [1.8, 0.5]),
        Shape::Skew => (of(&|i| if i.is_multiple_of(3) { 1.0 } else { 0.1 }), [0.8, 0.0]),
        Shape::AllBut(open) => {
            (of(&|i| if i < open { 0.05 * (open - 1) as f64 } else { sides(i) }), [0.8, 0.3])
        }
    }
}

struct People {
    advantages: Vec<f64>,
    sd: [f64; 2],
    nu: f64,
}

impl People {
    /// Nominal and ordinal alpha of infinitely many.
    fn truth(&self) -> [f64; 2] {
        let crowd = Population { nu: self.nu, ..Population::indifferent(2, self.sd[0].hypot(self.sd[1])) };
        let chances: Vec<[f64; 3]> = self
            .advantages
            .iter()
            .map(|&side| Population { side, ..crowd.clone() }.chances((0, 1), 0))
            .collect();
        let n = chances.len() as f64;
        let mean = |f: &dyn Fn(&[f64; 3]) -> f64| chances.iter().map(f).sum::<f64>() / n;
        let neither = mean(&|c| c[1]);
        let end = 0.5 * (1.0 - neither);
        let nominal = 1.0
            - mean(&|c| 1.0 - c.iter().map(|p| p * p).sum::<f64>())
                / (1.0 - 2.0 * end * end - neither * neither);
        let ordinal = mean(&|c| (c[0] - c[2]).powi(2)) / (1.0 - neither);
        [nominal, ordinal]
    }

    /// With as much agreement as gives this nominal alpha; `None` if nothing does.
    fn agreeing(shape: Shape, questions: usize, nu: f64, alpha: f64) -> Option<Self> {
        let (pattern, sd) = pattern(shape, questions);
        let of = |times: f64| Self { advantages: pattern.iter().map(|p| times * p).collect(), sd, nu };
        if alpha == 0.0 {
            return Some(of(0.0));
        }
        let (mut low, mut high) = (0.0, 60.0);
        if of(high).truth()[0] < alpha {
            return None;
        }
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if of(middle).truth()[0] < alpha { low = middle } else { high = middle }
        }
        Some(of(high))
    }

    fn study(&self, people: usize, asked: Asked, stream: &mut impl Rng) -> Vec<DeclaredBallot> {
        let mut ballots = Vec::new();
        for person in 0..people {
            let mut together = 0.0;
            for (question, advantage) in self.advantages.iter().enumerate() {
                if question % 3 == 0 {
                    together = self.sd[0] * normal(stream);
                }
                let ahead = advantage + together + self.sd[1] * normal(stream);
                let preference = [Preference::First, Preference::Neither, Preference::Second]
                    [draw(davidson(ahead, self.nu), stream).index()];
                if asked.of(person, question) {
                    ballots.push(DeclaredBallot::new(person, question, [0, 1], preference));
                }
            }
        }
        ballots
    }
}

#[derive(Clone, Copy, Debug)]
enum Asked {
    Everything,
    AThird,
}

impl Asked {
    fn of(self, person: usize, question: usize) -> bool {
        match self {
            Self::Everything => true,
            Self::AThird => (person + question).is_multiple_of(3),
        }
    }
}

/// What came of a population's studies by one metric.
struct Row {
    population: String,
    printed: f64,
    covered: f64,
}

fn rows(people: usize, asked: Asked, target: f64) -> Vec<Row> {
    let mut rows = Vec::new();
    for shape in SHAPES {
        for questions in [4, 9, 27] {
            for nu in [0.0, 0.6] {
                let Some(crowd) = People::agreeing(shape, questions, nu, target) else { continue };
                // Without ties both metrics are one.
                let metrics: &[Metric] =
                    if nu == 0.0 { &[Metric::Nominal] } else { &[Metric::Nominal, Metric::Ordinal] };
                let truth = crowd.truth();
                let seed = (people * 1000 + questions * 10 + rows.len() * 100_000) as u64;
                let one = |study: u64| -> [f64; 4] {
                    let ballots = crowd.study(people, asked, &mut stream(seed, study));
                    let mut seen = [0.0; 4];
                    for (m, &metric) in metrics.iter().enumerate() {
                        let found = alpha_with_interval(&ballots, metric).and_then(|a| a.interval);
                        if let Some(interval) = found {
                            seen[2 * m] = 1.0;
                            seen[2 * m + 1] =
                                f64::from(interval.low <= truth[m] && truth[m] <= interval.high);
                        }
                    }
                    seen
                };
                let all: Vec<[f64; 4]> = (0..STUDIES).into_par_iter().map(one).collect();
                for (m, metric) in metrics.iter().enumerate() {
                    let sum = |i: usize| all.iter().map(|seen| seen[i]).sum::<f64>();
                    let population = format!("{shape:?} {questions} questions, ties {nu}, {metric:?}");
                    rows.push(Row { population, printed: sum(2 * m), covered: sum(2 * m + 1) });
                }
            }
        }
    }
    rows
}

#[test]
#[ignore = "minutes: run by make test-long; prints a table"]
fn printed_intervals_cover() {
    println!("| asked | people | alpha | populations | printed | covered | least to most |");
    let mut wrong = Vec::new();
    for (asked, people) in [
        (Asked::Everything, 12),
        (Asked::Everything, 18),
        (Asked::Everything, 60),
        (Asked::Everything, 300),
        (Asked::AThird, 12),
        (Asked::AThird, 18),
        (Asked::AThird, 60),
        (Asked::AThird, 300),
    ] {
        for target in [0.0, 0.05, 0.2, 0.5, 0.8] {
            let rows = rows(people, asked, target);
            let studies = STUDIES as f64;
            let printed = rows.iter().map(|row| row.printed).sum::<f64>() / (studies * rows.len() as f64);
            let often: Vec<&Row> = rows.iter().filter(|row| row.printed >= RARE * studies).collect();
            let shares: Vec<f64> = often.iter().map(|row| row.covered / row.printed).collect();
            let mean = shares.iter().sum::<f64>() / shares.len() as f64;
            let [least, most] = [f64::min, f64::max].map(|of| shares.iter().copied().reduce(of));
            println!(
                "| {asked:?} | {people} | {target} | {} of {} | {printed:.2} | {mean:.3} | {:.3} to {:.3} |",
                often.len(),
                rows.len(),
                least.unwrap_or(f64::NAN),
                most.unwrap_or(f64::NAN)
            );
            for (row, share) in often.iter().zip(&shares) {
                // By chance: 3.5 standard errors, in a thousand populations.
                let chance = 3.5 * (0.05 * 0.95 / row.printed).sqrt();
                if (share - 0.95).abs() > 0.02 + chance {
                    wrong.push(format!("{asked:?} {people} {target} {}: {share:.3}", row.population));
                }
            }
            if !often.is_empty() && !(0.93..=0.97).contains(&mean) {
                wrong.push(format!("{asked:?} {people} {target}: {mean:.3} on average"));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
