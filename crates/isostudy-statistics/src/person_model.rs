//! Davidson's model with covariates of people: how much more an item is worth to somebody with one unit more of something.
//!
//! To a person with covariates z an item is worth l + b'z, each item with a b of its own: u = l_left - l_right +
//! (b_left - b_right)'z + side, and the outcomes have the weights e^{u/2} : nu : e^{-u/2} (Davidson 1970; subject covariates of
//! Dittrich, Hatzinger and Katzenbeisser 1998, Appl. Statist. 47:511). Without a tie among the answers it is Bradley and
//! Terry's model. The bonus for a side is there where pairs were shown in both orders.

use super::ballot::ShownBallot;
use super::clustered::{Coefficient, Estimates, sandwich};
use super::fit::FitError;
use super::newton::{Curvature, Matrix, inverse, maximise, quadratic};
use super::pairs::Pairs;
use super::scale::{NoOmnibus, Omnibus, fit_on_one_scale};
use super::simulation::davidson;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};
use std::collections::BTreeMap;

/// Estimates of the model.
#[derive(Debug, Clone, PartialEq)]
pub struct PersonModel {
    /// Log worths to somebody whose covariates are all 0; the first item's is 0.
    pub log_worths: Vec<f64>,
    /// By covariate and item, log-odds over the first item for one unit more; the first item's is 0.
    pub slopes: Vec<Vec<f64>>,
    /// ln nu, or `None` without a tie.
    pub ln_nu: Option<f64>,
    /// The left side's bonus in log-odds, where pairs were shown in both orders.
    pub side: Option<f64>,
    /// Log-likelihood of the answers, without multinomial constants.
    pub log_likelihood: f64,
    /// Inverse of the information: right if all answers were independent. Parameters are the worths of items 1.., their slopes covariate
    /// by covariate, then ln nu and side.
    pub covariance: Matrix,
    /// Sandwich covariance with participants as clusters (Liang and Zeger 1986); `None` with fewer than two of them.
    pub clustered: Option<Matrix>,
    /// People whose covariates are known, and who compared two items.
    pub participants: u64,
}

/// One pair as somebody with these covariates saw it: the parameters that u has, with their factors; and answers.
struct Row {
    parts: Vec<(usize, f64)>,
    answers: [f64; 3],
}

/// Which parameters there are.
struct Places {
    items: usize,
    covariates: usize,
    tie: Option<usize>,
    side: Option<usize>,
    size: usize,
}

impl Places {
    /// Parameters of u, and their factors.
    fn parts(&self, left: usize, right: usize, covariates: &[f64]) -> Vec<(usize, f64)> {
        let mut parts = Vec::with_capacity(2 * covariates.len() + 3);
        for (item, sign) in [(left, 1.0), (right, -1.0)].into_iter().filter(|(item, _)| *item > 0) {
            parts.push((item - 1, sign));
            for (k, z) in covariates.iter().enumerate() {
                parts.push(((k + 1) * (self.items - 1) + item - 1, sign * z));
            }
        }
        parts.extend(self.side.map(|side| (side, 1.0)));
        parts
    }

    /// Adds answers `[left, tie, right]` of one row.
    fn add(&self, sum: &mut Curvature, row: &Row, at: &[f64]) {
        let u: f64 = row.parts.iter().map(|&(place, x)| x * at[place]).sum();
        let [left, mut ties, right] = row.answers;
        if self.tie.is_none() {
            ties = 0.0;
        }
        let chances = davidson(u, self.tie.map_or(0.0, |tie| at[tie].exp()));
        let n = left + ties + right;
        let counted = [left, ties, right].into_iter().zip(chances).filter(|(count, _)| *count > 0.0);
        sum.value += counted.map(|(count, chance)| count * chance.ln()).sum::<f64>();
        let mean = 0.5 * (chances[0] - chances[2]);
        let slope = 0.5 * (left - right) - n * mean;
        let curve = n * (0.25 * (chances[0] + chances[2]) - mean * mean);
        for &(i, x) in &row.parts {
            sum.gradient[i] += slope * x;
            row.parts.iter().for_each(|&(j, y)| sum.information[i][j] += curve * x * y);
        }
        if let Some(tie) = self.tie {
            sum.gradient[tie] += ties - n * chances[1];
            sum.information[tie][tie] += n * chances[1] * (1.0 - chances[1]);
            for &(i, x) in &row.parts {
                let both = -n * chances[1] * mean * x;
                sum.information[i][tie] += both;
                sum.information[tie][i] += both;
            }
        }
    }

    fn likelihood<'a>(&self, rows: impl IntoIterator<Item = &'a Row>, at: &[f64]) -> Curvature {
        let mut sum = Curvature::zero(self.size);
        rows.into_iter().for_each(|row| self.add(&mut sum, row, at));
        sum
    }
}

/// Fits the model. `covariates[participant]` are those of a person, as many for everybody; people without them are left out.
///
/// Joint maximum likelihood by Newton's method; estimates to about 1e-9 of a covariate's own unit.
///
/// # Errors
/// As [`fit`](crate::fit()) without covariates. [`FitError::Nothing`] without a covariate or anybody who has them,
/// [`FitError::Collinear`] where nobody differs in one or it is a sum of others, and [`FitError::NoMaximum`] where worths need a
/// penalty or covariates foretell the answers of some pair without exception.
pub fn person_model(
    items: usize,
    ballots: &[ShownBallot],
    covariates: &[Option<Vec<f64>>],
) -> Result<PersonModel, FitError> {
    let of = |participant: usize| covariates.get(participant).and_then(Option::as_ref);
    let is_used = |b: &&ShownBallot| b.left() != b.right() && of(b.participant()).is_some();
    let used: Vec<&ShownBallot> = ballots.iter().filter(is_used).collect();
    let width = covariates.iter().flatten().map(Vec::len).next().unwrap_or(0);
    if width == 0 {
        return Err(FitError::Nothing);
    }
    let pairs = Pairs::of(items, used.iter().copied());
    let common = fit_on_one_scale(&pairs)?;
    if common.penalised() {
        return Err(FitError::NoMaximum);
    }
    let worths = (items - 1) * (width + 1);
    let tie = (pairs.ties() > 0.0).then_some(worths);
    let after = worths + usize::from(tie.is_some());
    let side = common.side.map(|_| after);
    let size = after + usize::from(side.is_some());
    let places = Places { items, covariates: width, tie, side, size };

    // In units of their own size around their own middle, so that years and milliseconds are both well conditioned.
    let own: BTreeMap<usize, &Vec<f64>> =
        used.iter().map(|b| b.participant()).filter_map(|p| Some((p, of(p)?))).collect();
    let people = own.len() as f64;
    let middle: Vec<f64> = (0..width).map(|k| own.values().map(|z| z[k]).sum::<f64>() / people).collect();
    let far = |k: usize| own.values().map(|z| (z[k] - middle[k]).abs()).fold(0.0, f64::max);
    let unit: Vec<f64> = (0..width).map(far).collect();
    let noise = |k: usize| 1e-12 * middle[k].abs();
    if (0..width).any(|k| unit[k] <= noise(k)) {
        return Err(FitError::Collinear);
    }
    let scaled = |z: &[f64]| -> Vec<f64> { (0..width).map(|k| (z[k] - middle[k]) / unit[k]).collect() };
    let mut by_person: BTreeMap<usize, BTreeMap<(usize, usize), [f64; 3]>> = BTreeMap::new();
    for ballot in &used {
        let of_person = by_person.entry(ballot.participant()).or_default();
        of_person.entry((ballot.left(), ballot.right())).or_default()[ballot.outcome().index()] += 1.0;
    }
    let rows_of = |(participant, answers): (&usize, &BTreeMap<(usize, usize), [f64; 3]>)| -> Vec<Row> {
        let z = scaled(own[participant]);
        let row = |(&(left, right), &answers): (&(usize, usize), &[f64; 3])| Row {
            parts: places.parts(left, right, &z),
            answers,
        };
        answers.iter().map(row).collect()
    };
    let rows: Vec<Vec<Row>> = by_person.iter().map(rows_of).collect();

    let likelihood = |at: &[f64]| places.likelihood(rows.iter().flatten(), at);
    inverse(&likelihood(&vec![0.0; size]).information).ok_or(FitError::Collinear)?;
    let maximum = maximise(vec![0.0; size], likelihood).ok_or(FitError::NoMaximum)?;
    let at = maximum.at;
    let clustered =
        sandwich(&maximum.covariance, rows.iter().map(|own| places.likelihood(own, &at).gradient));
    let back = Back { places: &places, middle: &middle, unit: &unit };
    let log_likelihood = places.likelihood(rows.iter().flatten(), &at).value;
    let at_own = back.values(&at);
    let with_first = |own: &[f64]| std::iter::once(0.0).chain(own.iter().copied()).collect::<Vec<f64>>();
    let of_items = |k: usize| with_first(&at_own[k * (items - 1)..(k + 1) * (items - 1)]);
    Ok(PersonModel {
        log_worths: of_items(0),
        slopes: (1..=width).map(of_items).collect(),
        ln_nu: tie.map(|tie| at[tie]),
        side: side.map(|side| at[side]),
        log_likelihood,
        covariance: back.covariance(&maximum.covariance),
        clustered: clustered.map(|clustered| back.covariance(&clustered)),
        participants: own.len() as u64,
    })
}

/// From scaled covariates back to their own units: l = l' - sum b' middle / unit, b = b' / unit.
struct Back<'a> {
    places: &'a Places,
    middle: &'a [f64],
    unit: &'a [f64],
}

impl Back<'_> {
    fn values(&self, at: &[f64]) -> Vec<f64> {
        let free = self.places.items - 1;
        let mut values = at.to_vec();
        for item in 0..free {
            for k in 0..self.places.covariates {
                let place = (k + 1) * free + item;
                values[place] = at[place] / self.unit[k];
                values[item] -= values[place] * self.middle[k];
            }
        }
        values
    }

    /// J C J', with J the linear map of [`values`](Self::values).
    fn covariance(&self, covariance: &Matrix) -> Matrix {
        let rows: Matrix = covariance.iter().map(|row| self.values(row)).collect();
        let size = rows.len();
        let columns: Matrix = (0..size).map(|j| rows.iter().map(|row| row[j]).collect()).collect();
        columns.iter().map(|column| self.values(column)).collect()
    }
}

impl PersonModel {
    /// How much one unit more of a covariate moves an item over another, in log-odds: t interval and p with participants as clusters on
    /// m - 1 degrees of freedom. `None` with fewer than two people, or where they tell no spread.
    ///
    /// # Panics
    /// If there is no such covariate or item.
    pub fn slope(&self, covariate: usize, item: usize, other: usize) -> Option<Coefficient> {
        let of = Estimates {
            independent: &self.covariance,
            clustered: self.clustered.as_ref(),
            participants: self.participants,
        };
        of.difference(&self.slopes[covariate], self.places(covariate).start, item, other)
    }

    /// Whether a covariate moves any worth: Hotelling's test on its slopes, as [`Scale`](crate::Scale) has it for worths.
    ///
    /// # Errors
    /// See [`NoOmnibus`].
    ///
    /// # Panics
    /// If there is no such covariate.
    pub fn omnibus(&self, covariate: usize) -> Result<Omnibus, NoOmnibus> {
        let items = self.log_worths.len();
        let places = self.places(covariate);
        let (free, m) = (items as u64 - 1, self.participants);
        let rest = (m + 1).saturating_sub(items as u64);
        let none = NoOmnibus::Participants { participants: m, items };
        let clustered = self.clustered.as_ref().filter(|_| rest > 0).ok_or(none)?;
        let own: Matrix = clustered[places.clone()].iter().map(|row| row[places.clone()].to_vec()).collect();
        let slopes = &self.slopes[covariate][1..];
        let precision = inverse(&own).ok_or(NoOmnibus::NoSpread)?;
        let f = quadratic(slopes, &precision, slopes) * rest as f64 / (free as f64 * (m as f64 - 1.0));
        let of_f = FisherSnedecor::new(free as f64, rest as f64).expect("degrees above zero");
        Ok(Omnibus { f, degrees: [free, rest], p: of_f.sf(f) })
    }

    /// The parameters of a covariate.
    fn places(&self, covariate: usize) -> std::ops::Range<usize> {
        let free = self.log_worths.len() - 1;
        (covariate + 1) * free..(covariate + 2) * free
    }
}

#[cfg(test)]
mod tests;
