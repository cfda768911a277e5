//! Does the analysis find what is there, and nothing else? Tried on simulated studies whose truth is known.
//!
//! [`probes`] plants one defect at a time and counts which [probes](crate::audit) speak up; [`rates`] counts how often tests
//! reject what is true and how often intervals cover it. Study s draws from its own stream of the seed, and only whole
//! numbers are added up: the same seed gives the same counts on any number of threads.

mod defects;
mod rates;
mod studies;

pub use defects::{DESCRIPTION as PROBES_DESCRIPTION, Defect, Planted, TOO_FEW, planted};
pub use rates::{DESCRIPTION as RATES_DESCRIPTION, Rate, rates};
pub use studies::Design;

use crate::audit::{Finding, Probe, Report};
use rayon::prelude::*;

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

/// Plants every defect in every design, each in a tenth of so many studies.
pub fn probes(studies: u64, seed: u64) -> Vec<Hits> {
    let rows = Design::ALL.into_iter().flat_map(|design| Defect::ALL.map(|defect| (design, defect)));
    rows.filter(|&(design, defect)| defect.is_planted(design))
        .map(|(design, defect)| probes_of(design, defect, studies.div_ceil(10), seed))
        .collect()
}

fn probes_of(design: Design, defect: Defect, studies: u64, seed: u64) -> Hits {
    let one = |study: u64| seen(&planted(defect, design, seed, study).audit());
    let add = |a: [[u64; 6]; 2], b: [[u64; 6]; 2]| [0, 1].map(|k| std::array::from_fn(|i| a[k][i] + b[k][i]));
    let [found, unanswerable] = (0..studies).into_par_iter().map(one).reduce(|| [[0; 6]; 2], add);
    Hits { design, defect, found, unanswerable, studies }
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
