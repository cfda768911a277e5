//! Does the analysis find what is there, and nothing else? Tried on simulated studies whose truth is known.
//!
//! [`truths`] plants what people prefer, and holds every number of every table against a second computation. [`probes`] plants one defect at a time and counts which [probes](crate::audit) speak up; [`rates`] counts how often tests
//! reject what is true and how often intervals cover it. Study s draws from its own stream of the seed, and only whole
//! numbers are added up: the same seed gives the same counts on any number of threads.

mod defects;
mod rates;
mod studies;
mod truths;

pub use defects::{Defect, Planted, planted};
pub use rates::{Rate, rates};
pub use studies::Design;
pub use truths::{truths, wrong_cells};

use crate::audit::{Finding, Probe, Report};
use isostudy_table::{Cell, Table};
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
const FULL: u64 = 10_000;

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

/// Everything, as three tables, `self_test_truths`, `self_test_probes` and `self_test_rates`, and whether all is as it has to
/// be. Truths are planted in studies of one size, whatever the number of simulated ones.
pub fn self_test(studies: u64, seed: u64) -> (Vec<Table>, bool) {
    let (planted, right) = truths();
    let ([probes, rates], sound) = simulated(studies, seed);
    (vec![planted, probes, rates], right && sound)
}

/// Probes and rates.
fn simulated(studies: u64, seed: u64) -> ([Table; 2], bool) {
    let (hits, rates) = (probes(studies, seed), rates(studies, seed));
    let sound = hits.iter().all(|h| Probe::ALL.iter().all(|&p| h.sound(p))) && rates.iter().all(Rate::sound);
    ([probe_table(&hits, seed), rate_table(&rates, seed)], sound)
}

fn probe_table(hits: &[Hits], seed: u64) -> Table {
    let mut columns =
        vec![("design".to_owned(), "Design".to_owned()), ("defect".to_owned(), "Planted".to_owned())];
    columns.extend(Probe::ALL.iter().map(|p| (p.code().replace('-', "_"), p.label().to_owned())));
    columns.extend([("studies".into(), "Studies".into()), ("passed".into(), "Passed".into())]);
    let columns: Vec<(&str, &str)> = columns.iter().map(|(a, b)| (a.as_str(), b.as_str())).collect();
    let mut table =
        Table::new("self_test_probes", "Share of studies in which each probe speaks up", &columns);
    for of in hits {
        let mut row = vec![Cell::text(of.design.label()), Cell::text(of.defect.label())];
        row.extend(Probe::ALL.iter().map(|&probe| match of.never_answerable(probe) {
            true => Cell::text("not answerable"),
            false => Cell::Number(of.share(probe), 4),
        }));
        row.push(Cell::count(of.studies));
        row.push(Cell::text(verdict(Probe::ALL.iter().all(|&probe| of.sound(probe)))));
        table.push(row);
    }
    table.notes.push(format!(
        "Seed {seed}; {}. Passed: at least {OWN_AT_LEAST} on the probe's own defect, at most {OTHERS_AT_MOST} elsewhere; with three \
         standard errors of counting where a row has fewer than {FULL} studies. {}",
        defects::DESCRIPTION,
        defects::TOO_FEW
    ));
    table
}

fn rate_table(rates: &[Rate], seed: u64) -> Table {
    let mut table = Table::new(
        "self_test_rates",
        "How often tests reject what is true, and intervals cover it",
        &[
            ("method", "Method"),
            ("truth", "Truth"),
            ("counted", "Counted"),
            ("studies", "Studies"),
            ("rate", "Rate"),
            ("low", "at least"),
            ("high", "at most"),
            ("passed", "Passed"),
        ],
    );
    for rate in rates {
        table.push(vec![
            Cell::text(rate.method),
            Cell::text(&rate.truth),
            Cell::text(rate.counted()),
            Cell::count(rate.studies),
            Cell::Number(rate.share(), 4),
            Cell::number(rate.limits().map(|(low, _)| low), 4),
            Cell::number(rate.limits().map(|(_, high)| high), 4),
            Cell::text(rate.limits().map_or("for comparison", |_| verdict(rate.sound()))),
        ]);
    }
    table.notes.push(format!(
        "{} Seed {seed}. Tests at 5 % may exceed it by three standard errors of counting; intervals at 95 % have to cover \
         between 94 and 96 %, or within three standard errors of counting of 95 % if there are so few studies that these are more. Rows for comparison show what methods do that take answers as independent, or that are known to \
         fall short in small studies.",
        rates::DESCRIPTION
    ));
    table
}

fn verdict(sound: bool) -> &'static str {
    if sound { "yes" } else { "NO" }
}

#[cfg(test)]
mod tests;
