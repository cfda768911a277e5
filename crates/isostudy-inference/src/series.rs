//! Series of simulated studies, whole or in parts: what each part counts, and how the parts add up.
//!
//! Every simulated study draws from a stream of its own number ([`isostudy_statistics::simulation::stream`]), so it is the same in
//! whatever part it is. Only whole numbers are counted. So the counts of all parts, in any order, add up to those of one run.

use rayon::prelude::*;
use std::ops::Range;

/// One of the parts that every series of a simulation is cut into.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Part {
    of: u64,
    number: u64,
}

impl Part {
    /// Everything.
    pub const WHOLE: Self = Self { of: 1, number: 1 };
    /// The largest number of parts.
    pub const MOST: u64 = 10_000;

    /// Part `number` of `of`, counted from 1; `None` if there is no such part, or there are more than [`Part::MOST`].
    pub fn new(number: u64, of: u64) -> Option<Self> {
        (1 <= number && number <= of && of <= Self::MOST).then_some(Self { of, number })
    }

    /// Which part it is, from 1.
    pub fn number(self) -> u64 {
        self.number
    }

    /// How many parts there are.
    pub fn of(self) -> u64 {
        self.of
    }

    /// Its own of so many studies, counted from 0. Every study is in one part, and parts differ by one study at most.
    pub fn studies(self, all: u64) -> Range<u64> {
        // In 128 bits no product is too large, and a quotient is `all` at most.
        let begin = |parts: u64| (u128::from(all) * u128::from(parts) / u128::from(self.of)) as u64;
        begin(self.number - 1)..begin(self.number)
    }
}

/// What was counted over studies of one series, which have one truth.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Series {
    /// What is simulated.
    pub name: String,
    /// How many studies the series has in all parts.
    pub all: u64,
    /// Which of them were simulated.
    pub studies: Range<u64>,
    /// In how many of these each of several things happened.
    pub counts: Vec<u64>,
}

impl Series {
    /// A whole series of so many studies, in which nothing has happened yet of so many things.
    pub(crate) fn blank(name: String, all: u64, things: usize) -> Self {
        Self { name, all, studies: 0..all, counts: vec![0; things] }
    }

    /// Simulates a part of a blank series. `happened` says of each thing whether it happened in a study, 1 or 0.
    pub(crate) fn count(self, part: Part, happened: impl Fn(u64) -> Vec<u64> + Sync) -> Self {
        let (studies, things) = (part.studies(self.all), self.counts.len());
        let add = |mut sum: Vec<u64>, more: Vec<u64>| {
            sum.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
            sum
        };
        let counts = studies.clone().into_par_iter().map(&happened).reduce(|| vec![0; things], add);
        Self { studies, counts, ..self }
    }

    /// Whether it is this part of a series that is otherwise like `blank`.
    fn is_part(&self, part: Part, blank: &Self) -> bool {
        let studies = part.studies(blank.all);
        let most = studies.end - studies.start;
        (&self.name, self.all, &self.studies) == (&blank.name, blank.all, &studies)
            && self.counts.len() == blank.counts.len()
            && self.counts.iter().all(|&count| count <= most)
    }
}

/// Why parts do not add up to a whole. Numbers are places in the list of parts, from 0.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Unfit {
    /// Two are cut into different numbers of parts.
    Cuts([usize; 2]),
    /// Two are the same part.
    Twice([usize; 2]),
    /// One does not hold what its part has to.
    Contents(usize),
    /// These parts, counted from 1, are not among them.
    Missing(Vec<u64>),
}

/// The whole of parts in any order: the counts that one run has. `blank` is all series of the simulation with nothing counted.
///
/// # Errors
/// If a part is missing, is there twice, or is of another simulation.
pub fn whole(blank: Vec<Series>, parts: &[(Part, Vec<Series>)]) -> Result<Vec<Series>, Unfit> {
    let Some(&(first, _)) = parts.first() else { return Err(Unfit::Missing(vec![1])) };
    let mut place_of = vec![None; first.of as usize];
    for (place, (part, _)) in parts.iter().enumerate() {
        if part.of != first.of {
            return Err(Unfit::Cuts([0, place]));
        }
        if let Some(before) = place_of[part.number as usize - 1].replace(place) {
            return Err(Unfit::Twice([before, place]));
        }
    }
    let is_whole = |(part, series): &(Part, Vec<Series>)| {
        series.len() == blank.len() && series.iter().zip(&blank).all(|(own, blank)| own.is_part(*part, blank))
    };
    if let Some(place) = parts.iter().position(|part| !is_whole(part)) {
        return Err(Unfit::Contents(place));
    }
    let missing: Vec<u64> =
        (1..=first.of).filter(|&number| place_of[number as usize - 1].is_none()).collect();
    if !missing.is_empty() {
        return Err(Unfit::Missing(missing));
    }
    let mut sum = blank;
    for (_, series) in parts {
        for (sum, own) in sum.iter_mut().zip(series) {
            sum.counts.iter_mut().zip(&own.counts).for_each(|(sum, own)| *sum += own);
        }
    }
    Ok(sum)
}

#[cfg(test)]
mod tests;
