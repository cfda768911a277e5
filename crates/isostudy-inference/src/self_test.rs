//! Does the analysis find what is there, and nothing else? Tried on simulated studies whose truth is known.
//!
//! One half plants one defect at a time and counts which [probes](crate::audit) speak up. The other counts how often tests
//! reject what is true and how often intervals cover it. Study s draws from its own stream of the seed, and only whole
//! numbers are added up: the same seed gives the same counts on any number of threads, and in any number of [parts](Part).

mod defects;
mod rates;
mod studies;

pub use defects::{DESCRIPTION as PROBES_DESCRIPTION, Defect, Planted, TOO_FEW, planted};
pub use rates::{DESCRIPTION as RATES_DESCRIPTION, Rate};
pub use studies::Design;

use crate::audit::{Finding, Probe, Report};
use crate::series::{Part, Series};
use rates::rates;

/// How often a probe has to speak up on its own defect.
pub const OWN_AT_LEAST: f64 = 0.95;
/// How often it may on any other: its level, and a margin for chance in counting.
pub const OTHERS_AT_MOST: f64 = 0.02;

/// How often each probe spoke up on studies with one defect.
#[derive(Debug, Clone, PartialEq)]
pub struct Hits {
    /// How the studies were dealt.
    pub design: Design,
    /// The defect.
    pub defect: Defect,
    /// In the order of [`Probe::ALL`].
    pub found: [u64; 6],
    /// In how many studies a probe could not tell.
    pub unanswerable: [u64; 6],
    /// How many studies.
    pub studies: u64,
}

impl Hits {
    /// Counted as [`seen`] has it.
    fn of(design: Design, defect: Defect, series: &Series) -> Self {
        let counts = |begin: usize| std::array::from_fn(|probe| series.counts[begin + probe]);
        let studies = series.studies.end - series.studies.start;
        Self { design, defect, found: counts(0), unanswerable: counts(Probe::ALL.len()), studies }
    }

    /// Share of studies in which a probe spoke up.
    pub fn share(&self, probe: Probe) -> f64 {
        self.found[place(probe)] as f64 / self.studies as f64
    }

    /// Whether a probe could tell in none of these studies.
    pub fn never_answerable(&self, probe: Probe) -> bool {
        self.unanswerable[place(probe)] == self.studies
    }

    /// Whether a probe did on these studies what it has to, with [`allowance`] if they are few. A probe that says of every
    /// study that it cannot tell has not failed, nor has one that finds its own defect less often where answers are too few.
    pub fn sound(&self, probe: Probe) -> bool {
        let (own, others) = probe_limits(self.studies);
        match self.defect.probe() == Some(probe) {
            true => {
                let asked = self.defect.is_told_by(self.design) && !self.never_answerable(probe);
                !asked || self.share(probe) >= own
            }
            false => self.share(probe) <= others || self.defect.may_be_seen_by(probe),
        }
    }
}

fn place(probe: Probe) -> usize {
    Probe::ALL.iter().position(|&p| p == probe).expect("one of all")
}

/// Three standard errors of a share counted in so many studies.
pub fn allowance(share: f64, studies: u64) -> f64 {
    3.0 * (share * (1.0 - share) / studies as f64).sqrt()
}

/// From so many studies on the probes' limits are taken as they are; with fewer, chance is allowed for.
pub const FULL: u64 = 10_000;

/// How often a probe has to speak up on its own defect, and how often it may elsewhere, in so many studies.
fn probe_limits(studies: u64) -> (f64, f64) {
    if studies >= FULL {
        return (OWN_AT_LEAST, OTHERS_AT_MOST);
    }
    let own = OWN_AT_LEAST - allowance(OWN_AT_LEAST, studies);
    (own.max(0.0), (OTHERS_AT_MOST + allowance(OTHERS_AT_MOST, studies)).min(1.0))
}

/// Simulates a part of so many studies: all that [`Outcomes`] are made of.
pub fn simulated(studies: u64, seed: u64, part: Part) -> Vec<Series> {
    let mut all = probes(studies, seed, part);
    all.extend(rates(studies, seed, part));
    all
}

/// The series of [`simulated`] with nothing counted.
pub fn blank(studies: u64) -> Vec<Series> {
    let probes = rows().map(|(design, defect)| blank_probes(design, defect, studies.div_ceil(10)));
    probes.chain(rates::blank(studies)).collect()
}

/// How probes, tests and intervals did.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcomes {
    /// A row for every defect in every design.
    pub probes: Vec<Hits>,
    /// A row for every test and interval.
    pub rates: Vec<Rate>,
}

impl Outcomes {
    /// Of series as [`simulated`] makes them.
    ///
    /// # Panics
    /// If they are others.
    pub fn of(series: &[Series]) -> Self {
        let (probes, rates) = series.split_at(rows().count());
        Self {
            probes: rows().zip(probes).map(|((design, defect), of)| Hits::of(design, defect, of)).collect(),
            rates: rates::of(rates),
        }
    }

    /// Whether every probe, test and interval did as it has to.
    pub fn sound(&self) -> bool {
        let probes = self.probes.iter().all(|of| Probe::ALL.iter().all(|&probe| of.sound(probe)));
        probes && self.rates.iter().all(Rate::sound)
    }
}

/// Every design with every defect that is planted in it.
fn rows() -> impl Iterator<Item = (Design, Defect)> {
    let all = Design::ALL.into_iter().flat_map(|design| Defect::ALL.map(|defect| (design, defect)));
    all.filter(|&(design, defect)| defect.is_planted(design))
}

/// Plants every defect in every design, each in a tenth of so many studies.
fn probes(studies: u64, seed: u64, part: Part) -> Vec<Series> {
    rows().map(|(design, defect)| probes_of(design, defect, [studies.div_ceil(10), seed], part)).collect()
}

fn probes_of(design: Design, defect: Defect, [studies, seed]: [u64; 2], part: Part) -> Series {
    let one = |study: u64| seen(&planted(defect, design, seed, study).audit()).concat();
    blank_probes(design, defect, studies).count(part, one)
}

fn blank_probes(design: Design, defect: Defect, studies: u64) -> Series {
    Series::blank(format!("probes: {}: {}", design.label(), defect.label()), studies, 2 * Probe::ALL.len())
}

/// By probe, whether it spoke up, and whether it could not tell.
fn seen(reports: &[Report]) -> [[u64; 6]; 2] {
    let came_out = |finding: Finding| {
        Probe::ALL.map(|probe| u64::from(reports.iter().any(|r| r.probe == probe && r.finding == finding)))
    };
    [came_out(Finding::Found), came_out(Finding::NotAnswerable)]
}

#[cfg(test)]
mod tests;
