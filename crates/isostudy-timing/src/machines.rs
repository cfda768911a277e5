//! Whether the machines that ran one study say the same of it.
//!
//! Times of two machines are never put into one ratio. Each machine judges pairs of methods by its own rounds and its own noise
//! floor; then the verdicts are held against each other.
//!
//! # Not guaranteed
//! - That machines agree says nothing of a machine that was not tried.
//! - Verdicts of a machine hold at 95 % for each pair. Of many pairs some are told by chance, so a contradiction of one pair among
//!   hundreds is weak.

mod tables;

use super::statements::{Statements, statements};
use super::{BUSY, Verdict};
use isostudy_design::record::BenchRun;
use isostudy_design::{ConfigurationId, Stage};
use isostudy_statistics::interval::Interval;

pub use tables::machine_tables;

/// What each machine says, and whether they agree.
#[derive(Debug, Clone, PartialEq)]
pub struct Machines {
    /// The machines, in the study's order.
    pub machines: Vec<MachineSays>,
    /// Pairs of configurations of one object, in the order of the first machine that has both.
    pub pairs: Vec<PairOnMachines>,
    /// For each object the configurations that may take the least time.
    pub fastest: Vec<Fastest>,
    /// Machines that are of one kind: their agreement says little. Places in [`machines`](Self::machines).
    pub alike: Vec<[usize; 2]>,
}

/// What one machine says.
#[derive(Debug, Clone, PartialEq)]
pub struct MachineSays {
    /// What the study calls it.
    pub name: String,
    /// The run.
    pub run: BenchRun,
    /// What follows from it alone.
    pub statements: Statements,
}

/// Two configurations on all machines.
#[derive(Debug, Clone, PartialEq)]
pub struct PairOnMachines {
    /// The configuration below the line.
    pub first: ConfigurationId,
    /// The configuration above the line.
    pub second: ConfigurationId,
    /// The ratio of totals, second to first, with its interval and verdict, for each machine; `None` where it has not both.
    pub on: Vec<Option<(f64, Option<Interval>, Verdict)>>,
    /// What the verdicts are together.
    pub agreement: Agreement,
}

/// What verdicts of several machines on a pair are together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Agreement {
    /// At least two machines tell which is faster, and name the same one.
    Same,
    /// Two machines tell, and name different ones.
    Contradicted,
    /// A single machine tells.
    OneTells,
    /// No machine tells.
    NoneTells,
}

/// What may take the least time on an object.
#[derive(Debug, Clone, PartialEq)]
pub struct Fastest {
    /// The object's id.
    pub object: String,
    /// For each machine the configurations that no other is told to be faster than, the least median first.
    pub on: Vec<Vec<ConfigurationId>>,
    /// Those among them that all machines have.
    pub on_all: Vec<ConfigurationId>,
}

impl Machines {
    /// Holds the runs of some machines against each other. Runs are of one plan.
    pub fn of(runs: Vec<(String, BenchRun)>) -> Self {
        let machines: Vec<MachineSays> = runs
            .into_iter()
            .map(|(name, run)| MachineSays { name, statements: statements(&run), run })
            .collect();
        let pairs = pairs(&machines);
        let fastest = fastest(&machines);
        let mut alike = Vec::new();
        for a in 0..machines.len() {
            for b in a + 1..machines.len() {
                if super::machine_differences(&machines[a].run, &machines[b].run).is_empty() {
                    alike.push([a, b]);
                }
            }
        }
        Self { machines, pairs, fastest, alike }
    }

    /// How many pairs are so.
    pub fn count(&self, agreement: Agreement) -> usize {
        self.pairs.iter().filter(|pair| pair.agreement == agreement).count()
    }
}

impl MachineSays {
    /// The largest share of the CPU time that others had in a window of the run.
    pub fn others(&self) -> Option<f64> {
        let windows = self.run.load.iter().filter(|window| window.invocation.is_some());
        windows.map(|window| window.others + window.steal).reduce(f64::max)
    }

    /// Whether others had more than a run may bear.
    pub fn is_busy(&self) -> bool {
        self.others().is_some_and(|others| others > BUSY)
    }
}

impl Agreement {
    fn of(verdicts: impl Iterator<Item = Verdict>) -> Self {
        let told: Vec<Verdict> = verdicts.filter(|verdict| *verdict != Verdict::CannotSay).collect();
        match told[..] {
            [] => Self::NoneTells,
            [_] => Self::OneTells,
            [first, ref others @ ..] if others.iter().all(|verdict| *verdict == first) => Self::Same,
            _ => Self::Contradicted,
        }
    }

    /// The word for it.
    pub fn label(self) -> &'static str {
        match self {
            Self::Same => "agree",
            Self::Contradicted => "contradict",
            Self::OneTells => "one tells",
            Self::NoneTells => "none tells",
        }
    }
}

fn pairs(machines: &[MachineSays]) -> Vec<PairOnMachines> {
    let totals =
        |says: &MachineSays| says.statements.ratios.clone().into_iter().filter(|r| r.stage == Stage::Total);
    let mut ids: Vec<[ConfigurationId; 2]> = Vec::new();
    for ratio in machines.iter().flat_map(totals) {
        let pair = [ratio.first, ratio.second];
        let turned = [pair[1].clone(), pair[0].clone()];
        if !ids.contains(&pair) && !ids.contains(&turned) {
            ids.push(pair);
        }
    }
    let pair = |[first, second]: [ConfigurationId; 2]| {
        let on: Vec<Option<(f64, Option<Interval>, Verdict)>> = machines
            .iter()
            .map(|says| {
                let found = totals(says).find(|r| r.first == first && r.second == second);
                found.map(|r| (r.ratio, r.interval, r.judgement.verdict))
            })
            .collect();
        let agreement = Agreement::of(on.iter().flatten().map(|(.., verdict)| *verdict));
        PairOnMachines { first, second, on, agreement }
    };
    ids.into_iter().map(pair).collect()
}

fn fastest(machines: &[MachineSays]) -> Vec<Fastest> {
    let mut objects: Vec<String> = Vec::new();
    for median in machines.iter().flat_map(|says| &says.statements.medians) {
        if !objects.contains(&median.id.object) {
            objects.push(median.id.object.clone());
        }
    }
    let of = |object: String| {
        let on: Vec<Vec<ConfigurationId>> =
            machines.iter().map(|says| not_beaten(&says.statements, &object)).collect();
        let mut on_all = on.first().cloned().unwrap_or_default();
        on_all.retain(|id| on.iter().all(|ids| ids.contains(id)));
        Fastest { object, on, on_all }
    };
    objects.into_iter().map(of).collect()
}

fn not_beaten(statements: &Statements, object: &str) -> Vec<ConfigurationId> {
    let totals = statements.medians.iter().filter(|of| of.stage == Stage::Total && of.id.object == object);
    let mut medians: Vec<(&ConfigurationId, f64)> = totals.map(|of| (&of.id, of.seconds.median)).collect();
    medians.sort_by(|a, b| a.1.total_cmp(&b.1));
    let is_beaten = |id: &ConfigurationId| {
        statements.ratios.iter().filter(|ratio| ratio.stage == Stage::Total).any(|ratio| {
            match ratio.judgement.verdict {
                Verdict::Faster => ratio.first == *id,
                Verdict::Slower => ratio.second == *id,
                Verdict::CannotSay => false,
            }
        })
    };
    medians.into_iter().filter(|(id, _)| !is_beaten(id)).map(|(id, _)| id.clone()).collect()
}

#[cfg(test)]
mod tests;
