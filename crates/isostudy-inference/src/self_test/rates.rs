//! How often tests reject what is true, and intervals cover it.

use super::allowance;
use crate::series::{Part, Series};
use isostudy_statistics::bootstrap::Resampling;
use isostudy_statistics::interval::Interval;
use isostudy_statistics::simulation::{Plan, Population, simulate, stream};
use isostudy_statistics::{
    MARGIN, Model, Pairs, Participants, ScoreTest, ShownBallot, clustered_covariance, fit, friedman, holm,
    sign_test,
};

/// How the studies are, for people.
/// What the studies are whose tests and intervals are counted.
pub const DESCRIPTION: &str = "18 people; Davidson's model with tie parameter 0.3, people 1 logit apart. One contrast: \
    one pair of items, 9 questions. Three items: 3 pairs on 3 objects, sides counterbalanced.";

const PEOPLE: usize = 18;
const SD: f64 = 1.0;
const LEVEL: f64 = 0.05;
/// Resamples of the bootstrap in each simulated study.
const RESAMPLES: usize = 1000;

/// What is counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Counted {
    /// Rejections at 5 % of something true: 5 % at most.
    Rejections,
    /// Intervals at 95 % that cover the truth: 94 to 96 %.
    Coverage,
    /// Rejections by a method that is not relied on.
    RejectionsForComparison,
    /// Coverage by a method that is not relied on.
    CoverageForComparison,
}

/// How often something happened.
#[derive(Debug, Clone, PartialEq)]
pub struct Rate {
    /// The test or interval.
    pub method: &'static str,
    /// What was true.
    pub truth: String,
    /// Of how many studies.
    pub studies: u64,
    /// In how many it happened.
    pub hits: u64,
    counted: Counted,
}

impl Rate {
    /// Hits per study.
    pub fn share(&self) -> f64 {
        self.hits as f64 / self.studies as f64
    }

    /// What is counted, for people.
    pub fn counted(&self) -> &'static str {
        match self.counted {
            Counted::Rejections | Counted::RejectionsForComparison => "rejections",
            Counted::Coverage | Counted::CoverageForComparison => "coverage",
        }
    }

    /// Between what the share has to lie; `None` if it is there for comparison. Rejections may exceed 5 % by three standard
    /// errors of counting; coverage may differ from 95 % by 1 %, or by three standard errors if there are so few studies
    /// that they are more.
    pub fn limits(&self) -> Option<(f64, f64)> {
        let error = allowance(LEVEL, self.studies);
        let (low, high) = match self.counted {
            Counted::Rejections => (0.0, LEVEL + error),
            Counted::Coverage => (0.95 - error.max(0.01), 0.95 + error.max(0.01)),
            _ => return None,
        };
        Some((low.max(0.0), high.min(1.0)))
    }

    /// Whether the share lies there.
    pub fn sound(&self) -> bool {
        self.limits().is_none_or(|(low, high)| (low..=high).contains(&self.share()))
    }
}

/// Studies that have one truth, and what may happen in each.
struct Case {
    /// What is compared.
    compared: &'static str,
    truth: &'static str,
    /// What happened in a study, by its number; every study is asked the same.
    events: Box<dyn Fn(u64) -> Vec<Event> + Send + Sync>,
}

/// One thing that may happen in a study: what it is called, how it counts, and whether it did; `None` if this study was not
/// asked.
type Event = (&'static str, Counted, Option<bool>);

impl Case {
    /// Two numbers for each event: studies that were asked, and those where it happened.
    fn blank(&self, studies: u64) -> Series {
        let things = 2 * (self.events)(0).len();
        Series::blank(format!("rates: {}: {}", self.compared, self.truth), studies, things)
    }

    fn count(&self, studies: u64, part: Part) -> Series {
        let happened = |(_, _, of): Event| [of.is_some(), of == Some(true)].map(u64::from);
        self.blank(studies).count(part, |study| (self.events)(study).into_iter().flat_map(happened).collect())
    }

    fn rates(&self, series: &Series) -> Vec<Rate> {
        let rate = |((method, counted, _), counts): (Event, &[u64])| Rate {
            method,
            truth: self.truth.into(),
            studies: counts[0],
            hits: counts[1],
            counted,
        };
        (self.events)(0).into_iter().zip(series.counts.chunks(2)).map(rate).collect()
    }
}

fn cases(seed: u64) -> [Case; 5] {
    [
        one_contrast(seed, 0.0, "no preference"),
        one_contrast(seed, 0.8, "0.8 logits apart"),
        at_the_margin(seed),
        three_items(seed, [0.0; 3], "no preference"),
        three_items(seed, [0.0, 0.5, 1.0], "items 0, 0.5, 1 logits"),
    ]
}

/// Counts everything over a part of so many studies.
pub(super) fn rates(studies: u64, seed: u64, part: Part) -> Vec<Series> {
    cases(seed).iter().map(|case| case.count(studies, part)).collect()
}

/// The same with nothing counted.
pub(super) fn blank(studies: u64) -> Vec<Series> {
    cases(0).iter().map(|case| case.blank(studies)).collect()
}

/// The rates of what [`rates`] counted.
pub(super) fn of(series: &[Series]) -> Vec<Rate> {
    cases(0).iter().zip(series).flat_map(|(case, series)| case.rates(series)).collect()
}

fn pair(by: f64) -> Population {
    Population { worths: vec![by, 0.0], ..Population::indifferent(2, SD) }
}

fn contrast(ballots: &[ShownBallot]) -> ScoreTest {
    ScoreTest::of(ballots.iter().map(|b| (b.participant(), b.declared(0).preference().sign())))
}

fn covers(interval: Interval, truth: f64) -> bool {
    interval.low <= truth && truth <= interval.high
}

fn one_contrast(seed: u64, by: f64, truth: &'static str) -> Case {
    use Counted::{Coverage, Rejections, RejectionsForComparison};
    let (plan, population) = (Plan::round_robin(2, 9), pair(by));
    let [first, _, second] = population.chances((0, 1), 0);
    let score = first - second;
    let events = move |study: u64| {
        let ballots = simulate(&plan, &population, PEOPLE, &mut stream(seed, study));
        let test = contrast(&ballots);
        let resampling = Resampling { resamples: RESAMPLES, seed: study };
        let studentised = Some(test.studentised(resampling).is_some_and(|of| covers(of.interval, score)));
        let mut events = vec![
            ("mean score, t interval", Coverage, test.interval.map(|i| covers(i, score))),
            ("mean score, studentised bootstrap", Coverage, studentised),
        ];
        if by == 0.0 {
            let [a, _, b] = test.counts.expect("one weight for all");
            let few = |questions: usize| {
                let own: Vec<ShownBallot> =
                    ballots.iter().filter(|b| b.question() < questions).copied().collect();
                contrast(&own)
            };
            let single = few(1);
            let [left, none, right] = single.counts.expect("one weight for all");
            let rejects = |p: f64| Some(p <= LEVEL);
            events.extend([
                ("sign-flip, 9 questions", Rejections, rejects(test.sign_flip.p())),
                ("sign-flip, 3 questions", Rejections, rejects(few(3).sign_flip.p())),
                ("sign-flip, 1 question", Rejections, rejects(single.sign_flip.p())),
                ("trinomial, 1 question", Rejections, rejects(sign_test::trinomial(left, none, right))),
                ("binomial over all answers", RejectionsForComparison, rejects(sign_test::binomial(a, b))),
            ]);
        }
        events
    };
    Case { compared: "one contrast", truth, events: Box::new(events) }
}

/// Two one-sided tests where the mean score is the margin itself, which is not within it.
fn at_the_margin(seed: u64) -> Case {
    let score = |by: f64| {
        let [first, _, second] = pair(by).chances((0, 1), 0);
        first - second
    };
    let (mut low, mut high) = (0.0, 4.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if score(middle) < MARGIN { low = middle } else { high = middle }
    }
    let (plan, population) = (Plan::round_robin(2, 9), pair(low));
    let events = move |study: u64| {
        let ballots = simulate(&plan, &population, PEOPLE, &mut stream(seed, study));
        let p = contrast(&ballots).equivalence(MARGIN).map(|test| test.p <= LEVEL);
        vec![("equivalence, two one-sided t tests", Counted::Rejections, p)]
    };
    Case { compared: "one contrast", truth: "mean score at the margin, 0.2", events: Box::new(events) }
}

fn three_items(seed: u64, worths: [f64; 3], truth: &'static str) -> Case {
    use Counted::{Coverage, CoverageForComparison, Rejections, RejectionsForComparison};
    let plan = Plan::round_robin(3, 3);
    let population = Population { worths: worths.to_vec(), ..Population::indifferent(3, SD) };
    let pairs = [(0, 1), (0, 2), (1, 2)];
    let chances = pairs.map(|(left, right)| (left, right, population.chances((left, right), 0)));
    // What Davidson's model says of everybody at once; people differ, so it is not the worths that each starts from.
    let worth = fit(Model::Davidson, &Pairs::new(3, chances)).expect("all chances above zero").log_worths[2];
    let events = move |study: u64| {
        let ballots = simulate(&plan, &population, PEOPLE, &mut stream(seed, study));
        let participants = Participants::of(3, &ballots);
        let fitted = fit(Model::Davidson, &Pairs::of(3, &ballots)).ok().filter(|fit| !fit.penalised());
        let sandwich = fitted.as_ref().and_then(|fit| Some((fit, clustered_covariance(fit, &participants)?)));
        let t =
            sandwich.map(|(fit, s)| covers(fit.clustered_interval(&s, participants.number(), 2, 0), worth));
        let naive = fitted.as_ref().map(|fit| {
            let half = 1.96 * fit.standard_error(&fit.covariance, 2, 0);
            (fit.log_worths[2] - worth).abs() <= half
        });
        let mut events = vec![
            ("Davidson worth, sandwich and t", Coverage, t),
            ("Davidson worth, answers independent", CoverageForComparison, naive),
        ];
        if worths == [0.0; 3] {
            let p = pairs.map(|(i, j)| {
                let about_both = |b: &&ShownBallot| [(i, j), (j, i)].contains(&(b.left(), b.right()));
                let own = ballots.iter().filter(about_both).map(|b| b.declared(i));
                ScoreTest::of(own.map(|b| (b.participant(), b.preference().sign()))).sign_flip.p()
            });
            let any = holm(&p).into_iter().any(|p| p <= LEVEL);
            let mut scores = vec![vec![0.0; 3]; PEOPLE];
            for ballot in &ballots {
                scores[ballot.participant()][ballot.left()] += ballot.outcome().sign() as f64;
                scores[ballot.participant()][ballot.right()] -= ballot.outcome().sign() as f64;
            }
            let pairs = Pairs::of(3, &ballots);
            let side = [Model::DavidsonSide, Model::Davidson].map(|model| fit(model, &pairs).ok());
            let ratio = match &side {
                [Some(with), Some(without)] => {
                    Some(2.0 * (with.log_likelihood - without.log_likelihood) >= 3.841_458_820_694_124)
                }
                _ => None,
            };
            events.extend([
                ("sign-flip, any of 3 pairs after Holm", Rejections, Some(any)),
                ("Friedman", Rejections, friedman(&scores).map(|test| test.p <= LEVEL)),
                ("side by likelihood ratio, answers independent", RejectionsForComparison, ratio),
            ]);
        }
        events
    };
    Case { compared: "three items", truth, events: Box::new(events) }
}
