//! What the cases of a sweep say: how measures grow with the resolution, and what each value of a setting does to them.
//!
//! Rows come one after the other and are only summed. Memory depends on how many values a sweep lists, and not on how many cases
//! it has.

use isostudy_design::ConfigurationId;
use isostudy_design::config::Combine;
use isostudy_design::sweep::Sweep;
use isostudy_statistics::{PowerLaw, power_law};
use std::collections::BTreeMap;

/// What is measured of a case.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum CaseQuantity {
    /// Sample points that the grid has for the method.
    Samples,
    /// Triangles of the mesh, or of the object's region.
    Triangles,
    /// Mean distance from the mesh to the isosurface, in scene units.
    Distance,
    /// Mean distance from the isosurface to the mesh, in scene units.
    DistanceToMesh,
    /// Mean radius ratio of the triangles.
    RadiusRatio,
    /// Median time of an extraction, in seconds.
    Seconds,
}

/// What is measured of a case's mesh.
const OF_MESHES: [CaseQuantity; 5] = [
    CaseQuantity::Samples,
    CaseQuantity::Triangles,
    CaseQuantity::Distance,
    CaseQuantity::DistanceToMesh,
    CaseQuantity::RadiusRatio,
];

/// Sums over the cases of a sweep.
#[derive(Debug, Clone)]
pub struct SweepSums<'s> {
    sweep: &'s Sweep<'s>,
    /// Machines that have a time, in the order they came.
    machines: Vec<String>,
    pairs: Vec<PairSums>,
}

#[derive(Debug, Clone, Default)]
struct PairSums {
    cases: u64,
    left_out: u64,
    /// By quantity, and of times by the machine's place.
    sums: BTreeMap<(CaseQuantity, Option<usize>), Sums>,
}

#[derive(Debug, Clone, Default)]
struct Sums {
    by_cells: BTreeMap<u32, Sum>,
    /// By the place of a setting, and of its value.
    by_value: BTreeMap<(usize, usize), Sum>,
}

/// Of the logarithms of ratios to the first value.
#[derive(Debug, Clone, Copy, Default)]
struct Sum {
    cases: u64,
    /// Cases without a value above 0, which have no logarithm.
    missing: u64,
    first: f64,
    logs: f64,
}

/// What a sweep says.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepFound {
    /// Pairs of an object and a method, in the study's order.
    pub pairs: Vec<PairFound>,
    /// Means by resolution, with how they grow.
    pub lines: Vec<SweepLine>,
    /// Means by value of a setting.
    pub effects: Vec<SettingEffect>,
}

/// How many cases a pair has.
#[derive(Debug, Clone, PartialEq)]
pub struct PairFound {
    /// Which.
    pub id: ConfigurationId,
    /// Cases that were measured or tried.
    pub cases: u64,
    /// Those of them that have no mesh.
    pub left_out: u64,
}

/// A quantity of a pair against the resolution.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepLine {
    /// Which pair.
    pub id: ConfigurationId,
    /// What.
    pub quantity: CaseQuantity,
    /// Of times, the machine that measured them.
    pub machine: Option<String>,
    /// By resolution, ascending.
    pub points: Vec<Mean>,
    /// How it grows with the cells per axis: `None` where other settings change from one resolution to the next, where resolutions
    /// have unequally many cases, or where there are fewer than two.
    pub growth: Option<PowerLaw>,
}

/// The geometric mean over the cases at a resolution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mean {
    /// Cells along the longest axis.
    pub cells: u32,
    /// The mean over the cases that have a value above 0.
    pub mean: f64,
    /// How many those are.
    pub cases: u64,
    /// How many have none.
    pub missing: u64,
}

/// What a value of a setting does.
#[derive(Debug, Clone, PartialEq)]
pub struct SettingEffect {
    /// Which pair.
    pub id: ConfigurationId,
    /// What.
    pub quantity: CaseQuantity,
    /// Of times, the machine that measured them.
    pub machine: Option<String>,
    /// The setting's place in `sweep.settings`.
    pub setting: usize,
    /// The value's place among the setting's.
    pub place: usize,
    /// The geometric mean over everything else that is crossed with it.
    pub mean: f64,
    /// How many cases have a value above 0.
    pub cases: u64,
    /// How many have none.
    pub missing: u64,
}

impl Sum {
    fn add(&mut self, value: Option<f64>) {
        match value.filter(|value| *value > 0.0 && value.is_finite()) {
            Some(value) => {
                // Of the ratio to the first: equal values have themselves as their mean, to the bit.
                if self.cases == 0 {
                    self.first = value;
                }
                self.cases += 1;
                self.logs += (value / self.first).ln();
            }
            None => self.missing += 1,
        }
    }

    fn mean(&self) -> Option<f64> {
        (self.cases > 0).then(|| self.first * (self.logs / self.cases as f64).exp())
    }
}

impl<'s> SweepSums<'s> {
    /// Of no case yet.
    pub fn new(sweep: &'s Sweep<'s>) -> Self {
        Self { sweep, machines: Vec::new(), pairs: vec![PairSums::default(); sweep.pairs.len()] }
    }

    /// Adds a case's mesh, by the places of its pair and its number; no measures where it has none.
    pub fn add(&mut self, pair: usize, number: u64, measures: Option<&[(CaseQuantity, Option<f64>)]>) {
        self.pairs[pair].cases += 1;
        match measures {
            Some(measures) => {
                for &(quantity, value) in measures {
                    self.add_value(pair, number, (quantity, None), value);
                }
            }
            None => {
                self.pairs[pair].left_out += 1;
                // Means of what is left are not comparable from one resolution to the next.
                for quantity in OF_MESHES {
                    self.add_value(pair, number, (quantity, None), None);
                }
            }
        }
    }

    /// Adds a case's median time in seconds on a machine; `None` where it could not be timed, or has no mesh.
    pub fn add_time(&mut self, pair: usize, number: u64, machine: &str, seconds: Option<f64>) {
        let place = self.machines.iter().position(|known| known == machine).unwrap_or_else(|| {
            self.machines.push(machine.to_owned());
            self.machines.len() - 1
        });
        self.add_value(pair, number, (CaseQuantity::Seconds, Some(place)), seconds);
    }

    fn add_value(&mut self, pair: usize, number: u64, of: (CaseQuantity, Option<usize>), value: Option<f64>) {
        let case = self.sweep.case(&self.sweep.pairs[pair], number);
        let sums = self.pairs[pair].sums.entry(of).or_default();
        sums.by_cells.entry(case.cells).or_default().add(value);
        if self.sweep.section.combine == Combine::Crossed {
            for chosen in case.settings {
                sums.by_value.entry((chosen.setting, chosen.place)).or_default().add(value);
            }
        }
    }

    /// What all cases together say.
    pub fn found(&self) -> SweepFound {
        let mut found = SweepFound { pairs: Vec::new(), lines: Vec::new(), effects: Vec::new() };
        for (pair, sums) in self.sweep.pairs.iter().zip(&self.pairs) {
            let id = &pair.configuration.id;
            found.pairs.push(PairFound { id: id.clone(), cases: sums.cases, left_out: sums.left_out });
            let is_confounded = self.sweep.section.combine == Combine::Listed
                && pair.settings().any(|setting| self.sweep.values(setting).len() > 1);
            for (&(quantity, machine), sums) in &sums.sums {
                let machine = machine.map(|place| self.machines[place].clone());
                let points = sums.points();
                // A ratio is no size.
                let has_power = !is_confounded && quantity != CaseQuantity::RadiusRatio;
                let growth = if has_power { growth(&points) } else { None };
                let varied = |&setting: &usize| self.sweep.values(setting).len() > 1;
                for setting in pair.settings().filter(varied) {
                    let values = sums.by_value.range((setting, 0)..=(setting, usize::MAX));
                    found.effects.extend(values.filter_map(|(&(setting, place), sum)| {
                        Some(SettingEffect {
                            id: id.clone(),
                            quantity,
                            machine: machine.clone(),
                            setting,
                            place,
                            mean: sum.mean()?,
                            cases: sum.cases,
                            missing: sum.missing,
                        })
                    }));
                }
                found.lines.push(SweepLine { id: id.clone(), quantity, machine, points, growth });
            }
        }
        found
    }
}

impl Sums {
    fn points(&self) -> Vec<Mean> {
        let point = |(&cells, sum): (&u32, &Sum)| {
            Some(Mean { cells, mean: sum.mean()?, cases: sum.cases, missing: sum.missing })
        };
        self.by_cells.iter().filter_map(point).collect()
    }
}

/// Means of other cases are not comparable, so all resolutions must have the same ones.
fn growth(points: &[Mean]) -> Option<PowerLaw> {
    let first = points.first()?;
    if points.iter().any(|point| point.cases != first.cases || point.missing > 0) {
        return None;
    }
    power_law(&points.iter().map(|point| (f64::from(point.cells), point.mean)).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture;
    use isostudy_design::Study;
    use isostudy_design::config::{SettingSection, SweepSection};

    fn swept(combine: &str) -> Study {
        let mut study = fixture::study();
        let text = format!("cells = [8, 16, 32]\nobjects = [\"ss\"]\ncombine = \"{combine}\"");
        let mut section: SweepSection = toml::from_str(&text).unwrap();
        let setting: SettingSection =
            toml::from_str("methods = [\"bi\"]\nkey = \"edge_clamp\"\nvalues = [0.0, 0.1, 0.2]").unwrap();
        section.settings.push(setting);
        study.file.sweep = Some(section);
        study
    }

    /// 3 cells^-2, times 1, 2 and 4 for the setting's values.
    fn planted(cells: u32, place: usize) -> f64 {
        3.0 * f64::from(cells).powi(-2) * f64::from(1 << place)
    }

    fn filled<'s>(sweep: &'s Sweep<'s>, left_out: Option<u64>) -> SweepFound {
        let mut sums = SweepSums::new(sweep);
        for (place, pair) in sweep.pairs.iter().enumerate() {
            for number in 0..pair.cases {
                let case = sweep.case(pair, number);
                let value = case.settings.first().map_or(0, |chosen| chosen.place);
                let measures = [(CaseQuantity::Distance, Some(planted(case.cells, value)))];
                let is_left_out = pair.cases == 9 && left_out == Some(number);
                sums.add(place, number, (!is_left_out).then_some(&measures));
                sums.add_time(place, number, "a machine", Some(f64::from(case.cells)));
            }
        }
        sums.found()
    }

    #[test]
    fn planted_exponents_and_effects_come_out() {
        let study = swept("crossed");
        let sweep = study.sweep().unwrap();
        let found = filled(&sweep, None);
        let bi = found.pairs.iter().position(|pair| pair.id.to_string() == "ss_bi").unwrap();
        assert_eq!((found.pairs[bi].cases, found.pairs[bi].left_out), (9, 0));
        for line in &found.lines {
            let law = line.growth.unwrap();
            let want = if line.quantity == CaseQuantity::Distance { -2.0 } else { 1.0 };
            assert!((law.exponent - want).abs() < 1e-12, "{line:?}");
            assert_eq!(line.machine.is_some(), line.quantity == CaseQuantity::Seconds);
        }
        let line = found.lines.iter().find(|line| line.id.to_string() == "ss_bi").unwrap();
        // The geometric mean of 1, 2 and 4 is 2.
        assert!((line.points[1].mean - 2.0 * planted(16, 0)).abs() < 1e-15);
        let effects: Vec<&SettingEffect> =
            found.effects.iter().filter(|of| of.quantity == CaseQuantity::Distance).collect();
        assert_eq!(effects.len(), 3);
        assert!((effects[2].mean / effects[0].mean - 4.0).abs() < 1e-12);
    }

    #[test]
    fn what_is_missing_or_confounded_has_no_exponent() {
        let study = swept("crossed");
        let sweep = study.sweep().unwrap();
        let found = filled(&sweep, Some(4));
        let pair = found.pairs.iter().find(|pair| pair.id.to_string() == "ss_bi").unwrap();
        assert_eq!((pair.cases, pair.left_out), (9, 1));
        let line = |found: &SweepFound, id: &str| {
            let of = |line: &&SweepLine| line.id.to_string() == id && line.quantity == CaseQuantity::Distance;
            found.lines.iter().find(of).unwrap().clone()
        };
        assert_eq!(line(&found, "ss_bi").growth, None);
        assert_eq!(line(&found, "ss_bi").points.iter().map(|point| point.missing).sum::<u64>(), 1);
        assert!(line(&found, "ss_bu").growth.is_some());
        let study = swept("listed");
        let sweep = study.sweep().unwrap();
        let found = filled(&sweep, None);
        assert_eq!(line(&found, "ss_bi").growth, None);
        assert!(line(&found, "ss_bu").growth.is_some());
        assert_eq!(found.effects, []);
    }
}
