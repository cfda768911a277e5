//! Does anything differ at all, and does a preference depend on anything? Friedman's tests over participants.

use isostudy_design::contrast::{Contrast, Over, contrasts};
use isostudy_design::{Factor, Level, MethodId, Study};
use isostudy_statistics::{ChiSquareTest, DeclaredBallot, friedman, holm};

/// What Friedman's test is asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Asked {
    /// Are the values of a factor liked alike?
    Levels(Factor),
    /// Does the preference between two values depend on another factor?
    ByOther([Level; 2], Factor),
    /// Does the preference between two values depend on the object?
    ByObject([Level; 2]),
}

/// One test.
#[derive(Debug, Clone)]
pub struct Omnibus {
    /// What is asked.
    pub asked: Asked,
    /// The test.
    pub test: ChiSquareTest,
    /// p by Holm over the tests that ask the same of other levels.
    pub adjusted: f64,
    /// How many participants are ranked.
    pub participants: usize,
}

/// Every test that the questions allow: what was not asked has no column, and fewer than two columns no test.
///
/// A participant's score in a column is the mean over the answers there; ranked are those with an answer in every column.
pub fn tests(study: &Study, ballots: &[DeclaredBallot]) -> Vec<Omnibus> {
    let mut found = Vec::new();
    let mut add = |asked: Vec<(Asked, Vec<Vec<f64>>)>| {
        let mut alike: Vec<Omnibus> = asked
            .into_iter()
            .filter_map(|(asked, rows)| {
                let (test, participants) = (friedman(&rows)?, rows.len());
                Some(Omnibus { asked, test, adjusted: test.p, participants })
            })
            .collect();
        let adjusted = holm(&alike.iter().map(|of| of.test.p).collect::<Vec<_>>());
        alike.iter_mut().zip(adjusted).for_each(|(of, p)| of.adjusted = p);
        found.extend(alike);
    };
    let pooled: Vec<Contrast> = contrasts(study).into_iter().filter(|c| c.over == Over::All).collect();
    // Two values are what a contrast compares already.
    let several = |factor: Factor| {
        let levels = levels_of(&pooled, factor);
        (levels.len() > 2).then_some((factor, levels))
    };
    for (factor, levels) in study.declared_factors().rev().filter_map(several) {
        add(vec![(Asked::Levels(factor), wins_less_losses(study, ballots, factor, &levels))]);
    }
    let by_other = pooled.iter().flat_map(|contrast| {
        let own = contrast.levels[0].factor;
        let others =
            study.declared_factors().filter(move |other| own != study.method_factor() && *other != own);
        others.map(|other| {
            let level = |q: usize| study.level_of(study.comparisons[q].left.method, other);
            (Asked::ByOther(contrast.levels, other), by(contrast, ballots, level))
        })
    });
    // Of two values the difference is a contrast of its own.
    add(by_other.filter(|(_, rows)| rows.first().is_some_and(|row| row.len() > 2)).collect());
    let by_object = |contrast: &Contrast| {
        (Asked::ByObject(contrast.levels), by(contrast, ballots, |q| Some(study.comparisons[q].object)))
    };
    add(pooled.iter().map(by_object).collect());
    found
}

/// The test that shows that the preference between two values depends on the object; `None` if it does not.
pub fn depends_on_object(tests: &[Omnibus], levels: [Level; 2], level: f64) -> Option<&Omnibus> {
    tests.iter().find(|of| of.asked == Asked::ByObject(levels)).filter(|of| of.adjusted <= level)
}

/// The values of a factor that questions compare, in the order in which they are asked.
fn levels_of(pooled: &[Contrast], factor: Factor) -> Vec<Level> {
    let mut levels: Vec<Level> = Vec::new();
    for level in pooled.iter().flat_map(|contrast| contrast.levels).filter(|level| level.factor == factor) {
        if !levels.contains(&level) {
            levels.push(level);
        }
    }
    levels
}

/// By participant, the mean of +1 for each win and -1 for each loss of each value of a factor, everything else equal.
fn wins_less_losses(
    study: &Study,
    ballots: &[DeclaredBallot],
    factor: Factor,
    levels: &[Level],
) -> Vec<Vec<f64>> {
    let pair = |ballot: &DeclaredBallot| {
        let comparison = &study.comparisons[ballot.question()];
        let (first, second) = (comparison.left.method, comparison.right.method);
        let place = |method: MethodId| {
            study.level_of(method, factor).and_then(|level| levels.iter().position(|&of| of == level))
        };
        if study.difference(first, second) == factor { place(first).zip(place(second)) } else { None }
    };
    let mut columns = Columns::of(levels.len());
    for ballot in ballots {
        if let Some((first, second)) = pair(ballot) {
            columns.add(ballot.participant(), first, ballot.preference().sign());
            columns.add(ballot.participant(), second, -ballot.preference().sign());
        }
    }
    columns.complete()
}

/// By participant, the mean score of a contrast in each of the columns that its questions have.
fn by<K: PartialEq>(
    contrast: &Contrast,
    ballots: &[DeclaredBallot],
    column: impl Fn(usize) -> Option<K>,
) -> Vec<Vec<f64>> {
    let mut keys: Vec<K> = Vec::new();
    let mut place: Vec<Option<(usize, i64)>> = Vec::new();
    for (&question, &sign) in &contrast.parts[0] {
        let Some(key) = column(question) else { continue };
        let at = keys.iter().position(|known| *known == key).unwrap_or_else(|| {
            keys.push(key);
            keys.len() - 1
        });
        place.resize(place.len().max(question + 1), None);
        place[question] = Some((at, sign));
    }
    let mut columns = Columns::of(keys.len());
    for ballot in ballots {
        if let Some((at, sign)) = place.get(ballot.question()).copied().flatten() {
            columns.add(ballot.participant(), at, sign * ballot.preference().sign());
        }
    }
    columns.complete()
}

/// Sums and numbers of answers by participant and column.
struct Columns {
    width: usize,
    cells: Vec<(i64, i64)>,
}

impl Columns {
    fn of(width: usize) -> Self {
        Self { width, cells: Vec::new() }
    }

    fn add(&mut self, participant: usize, column: usize, sign: i64) {
        let place = participant * self.width + column;
        if place >= self.cells.len() {
            self.cells.resize((participant + 1) * self.width, (0, 0));
        }
        let (sum, answers) = self.cells[place];
        self.cells[place] = (sum + sign, answers + 1);
    }

    /// The means of whoever has an answer in every column: what was not answered is not zero.
    fn complete(&self) -> Vec<Vec<f64>> {
        let rows = self.cells.chunks_exact(self.width.max(1));
        let complete = rows.filter(|row| row.iter().all(|&(_, answers)| answers > 0));
        complete.map(|row| row.iter().map(|&(sum, n)| sum as f64 / n as f64).collect()).collect()
    }
}
