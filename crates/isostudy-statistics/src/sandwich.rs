//! The covariance of estimates where one participant's answers hang together.

use super::fit::WorthFit;
use super::model::{Layout, Touched};
use super::newton::{Matrix, inverse, times};
use super::pairs::Pairs;
use super::participants::{AnsweredPair, Participants};
use rayon::prelude::*;

/// The sandwich covariance with participants as clusters: m/(m-1) H^-1 (sum of s s') H^-1, where s is one participant's
/// gradient and H the information of the unpenalised answers (Liang and Zeger 1986, Biometrika 73:13).
///
/// `None` with fewer than two participants, for a penalised fit (whose gradients do not add up to zero), or if H is
/// singular.
pub fn clustered_covariance(fit: &WorthFit, participants: &Participants) -> Option<Matrix> {
    let clusters = Clusters { all: participants.sum(&participants.counts), participants, moments: None };
    clusters.covariance(fit)
}

/// Participants whose answers several models are fitted to.
pub(super) struct Clusters<'a> {
    /// Everybody's answers together.
    pub(super) all: Pairs,
    participants: &'a Participants,
    /// Row by row, the sum over participants of c c', where c is how often they gave each answer to each pair shown.
    moments: Option<Vec<f64>>,
}

impl<'a> Clusters<'a> {
    /// Adds up whatever does not depend on a model, where there are many kinds of participants: the sum of s s' is linear in
    /// the sum of c c'.
    pub(super) fn of(participants: &'a Participants) -> Self {
        let size = 3 * participants.shown().len();
        // Of many items nearly all moments would be zero.
        let moments = (participants.kinds() > size && participants.items() <= DENSE)
            .then(|| moments(participants, size));
        Self { all: participants.sum(&participants.counts), participants, moments }
    }

    /// See [`clustered_covariance`].
    pub(super) fn covariance(&self, fit: &WorthFit) -> Option<Matrix> {
        let m = self.participants.number() as f64;
        if m < 2.0 || fit.penalised() {
            return None;
        }
        let layout = Layout::of(fit.model, &self.all, fit.given_side);
        let bread = inverse(&layout.likelihood(&self.all, &fit.parameters).information)?;
        let (shown, size) = (self.participants.shown(), fit.parameters.len());
        let mut covariance = if size > DENSE {
            from_gradients(self.participants, &layout, fit, &bread)
        } else {
            // A participant's gradient adds up what each answer has: few kinds of answers, many participants.
            let of_pair = |&pair: &(usize, usize)| {
                let (touched, scores) = layout.scores(pair, &fit.parameters);
                scores.map(|score| {
                    let mut full = vec![0.0; size];
                    touched.places().iter().zip(score).for_each(|(&place, score)| full[place] = score);
                    full
                })
            };
            let influences: Vec<Vec<f64>> =
                shown.iter().flat_map(of_pair).map(|score| times(&bread, &score)).collect();
            match &self.moments {
                Some(moments) => from_moments(moments, &influences, size),
                None => from_kinds(self.participants, &influences, size),
            }
        };
        covariance.iter_mut().flatten().for_each(|cell| *cell *= m / (m - 1.0));
        Some(covariance)
    }
}

fn moments(participants: &Participants, size: usize) -> Vec<f64> {
    let mut moments = vec![0.0; size * size];
    for (answers, count) in participants.of_kinds() {
        let given: Vec<(usize, f64)> = given(answers).collect();
        for &(i, a) in &given {
            given.iter().for_each(|&(j, b)| moments[i * size + j] += count as f64 * a * b);
        }
    }
    moments
}

/// The answers that somebody gave, and how often.
fn given(answered: &[AnsweredPair]) -> impl Iterator<Item = (usize, f64)> {
    let each = answered.iter().flat_map(|of| (0..3).map(|o| (3 * of.place() + o, of.answers[o])));
    each.filter(|(_, times)| *times > 0).map(|(place, times)| (place, f64::from(times)))
}

/// With more parameters than this, few of which each answer touches, participants' gradients are added up and not what each of
/// them moves: the same sums in another order.
const DENSE: usize = 64;

/// bread (sum of s s') bread, with s the gradient of one participant, which is zero for nearly all of many parameters.
fn from_gradients(participants: &Participants, layout: &Layout, fit: &WorthFit, bread: &Matrix) -> Matrix {
    let size = fit.parameters.len();
    let scores: Vec<(Touched, [[f64; 4]; 3])> =
        participants.shown().iter().map(|&pair| layout.scores(pair, &fit.parameters)).collect();
    let mut meat = vec![vec![0.0; size]; size];
    let mut gradient = vec![0.0; size];
    let mut touched: Vec<usize> = Vec::new();
    for (answered, count) in participants.of_kinds() {
        for of in answered {
            let (own, scores) = &scores[of.place()];
            for (i, &place) in own.places().iter().enumerate() {
                touched.push(place);
                let times = of.answers.map(f64::from);
                gradient[place] += (0..3).map(|o| times[o] * scores[o][i]).sum::<f64>();
            }
        }
        touched.sort_unstable();
        touched.dedup();
        for (i, &row) in touched.iter().enumerate() {
            let own = count as f64 * gradient[row];
            touched[i..].iter().for_each(|&column| meat[row][column] += own * gradient[column]);
        }
        touched.drain(..).for_each(|place| gradient[place] = 0.0);
    }
    for row in 1..size {
        let (above, below) = meat.split_at_mut(row);
        below[0][..row].iter_mut().zip(above).for_each(|(cell, other)| *cell = other[row]);
    }
    product(&product(bread, &meat), bread)
}

/// The product of two matrices, row by row.
fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let row = |row: &Vec<f64>| {
        let mut sum = vec![0.0; b.len()];
        for (factor, other) in row.iter().zip(b) {
            sum.iter_mut().zip(other).for_each(|(sum, x)| *sum += factor * x);
        }
        sum
    };
    a.par_iter().map(row).collect()
}

fn from_moments(moments: &[f64], influences: &[Vec<f64>], parameters: usize) -> Matrix {
    let mut sum = vec![vec![0.0; parameters]; parameters];
    for (row, own) in moments.chunks_exact(influences.len()).zip(influences) {
        let mut with_all = vec![0.0; parameters];
        for (&moment, other) in row.iter().zip(influences).filter(|(moment, _)| **moment != 0.0) {
            with_all.iter_mut().zip(other).for_each(|(sum, x)| *sum += moment * x);
        }
        add_product(&mut sum, 1.0, own, &with_all);
    }
    sum
}

fn from_kinds(participants: &Participants, influences: &[Vec<f64>], parameters: usize) -> Matrix {
    let mut sum = vec![vec![0.0; parameters]; parameters];
    let mut own = vec![0.0; parameters];
    for (answers, count) in participants.of_kinds() {
        own.fill(0.0);
        for (place, times) in given(answers) {
            own.iter_mut().zip(&influences[place]).for_each(|(sum, x)| *sum += times * x);
        }
        add_product(&mut sum, count as f64, &own, &own);
    }
    sum
}

fn add_product(sum: &mut Matrix, times: f64, a: &[f64], b: &[f64]) {
    for (row, x) in sum.iter_mut().zip(a) {
        row.iter_mut().zip(b).for_each(|(cell, y)| *cell += times * x * y);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulation::{Plan, Population, simulate, stream};
    use crate::{Model, fit, golden};

    #[test]
    fn as_r_has_it() {
        // R, sandwich 3.0-2: glm(y ~ factor(answer) + x2 + x3 + t - 1, poisson) with a row an answer and outcome;
        // vcovCL(m, cluster = participant, type = "HC0", cadjust = TRUE).
        let ballots = golden::clusterings(&golden::study(), None);
        let participants = Participants::of(3, &ballots);
        assert_eq!(participants.number(), 18);
        let fitted = fit(Model::Davidson, &Pairs::of(3, &ballots)).unwrap();
        let covariance = clustered_covariance(&fitted, &participants).unwrap();
        let close = |got: f64, want: f64, by: f64| assert!((got - want).abs() < by, "{got} is not {want}");
        close(fitted.standard_error(&covariance, 1, 0), 0.409_735_500_836_181_8, 1e-9);
        close(fitted.standard_error(&covariance, 0, 2), 0.542_410_510_133_580_2, 1e-9);
        close(covariance[0][1], 0.207_142_499_724_814_55, 1e-9);
        close(covariance[2][2].sqrt(), 0.292_205_606_375_258_3, 1e-6);
        let difference = covariance[0][0] + covariance[1][1] - 2.0 * covariance[0][1];
        close(fitted.standard_error(&covariance, 2, 1), difference.sqrt(), 1e-12);
        // t(17) at 0.975 is 2.1098155778331806 (scipy.stats.t.ppf).
        let interval = fitted.clustered_interval(&covariance, 18, 2, 0);
        close(interval.high - fitted.log_worths[2], 2.109_815_577_833_180_6 * 0.542_410_510_133_580_2, 1e-8);
        assert_eq!(clustered_covariance(&fitted, &Participants::of(3, &ballots[..1])), None);
    }

    #[test]
    fn many_kinds_are_added_up_beforehand_to_the_same() {
        let plan = Plan::round_robin(3, 4);
        let ballots = simulate(&plan, &Population::indifferent(3, 0.8), 200, &mut stream(4, 0));
        let participants = Participants::of(3, &ballots);
        let clusters = Clusters::of(&participants);
        assert!(clusters.moments.is_some());
        for model in Model::ALL {
            let fitted = fit(model, &clusters.all).unwrap();
            let (one, other) = (clusters.covariance(&fitted), clustered_covariance(&fitted, &participants));
            for (a, b) in one.unwrap().iter().flatten().zip(other.unwrap().iter().flatten()) {
                assert!((a - b).abs() < 1e-12, "{model:?}: {a} {b}");
            }
        }
    }
}
