//! Models of paired comparison with ties: the chance of each outcome of a pair, given worths.
//!
//! Worths are on the log scale, the first item's is 0. With u = l_left - l_right:
//!
//! - **Davidson** (1970, J. Amer. Statist. Assoc. 65:317): weights e^{u/2} : nu : e^{-u/2}.
//! - **Davidson with side** (Davidson and Beaver 1977, Biometrics 33:693), symmetric form: u + delta in place of u, so
//!   left e^delta pi_l, tie nu e^{delta/2} sqrt(pi_l pi_r), right pi_r. Their own form has gamma = e^-delta and
//!   nu_o = nu e^{-delta/2}: the same model, but another nu.
//! - **Rao and Kupper** (1967, J. Amer. Statist. Assoc. 62:194): left pi_l / (pi_l + theta pi_r), right likewise, the rest
//!   ties; eta = ln theta >= 0. Its worths are on another scale than Davidson's: compare orders, not sizes.
//! - **Bradley and Terry** (1952, Biometrika 39:324): pi_l / (pi_l + pi_r), a tie counting as half a win for each.

use super::newton::Curvature;
use super::pairs::{Pair, Pairs};

/// Which model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Model {
    /// Ties have their own weight.
    Davidson,
    /// Davidson's with a bonus for the left side.
    DavidsonSide,
    /// Ties by a threshold.
    RaoKupper,
    /// Ties are half a win each.
    BradleyTerry,
}

impl Model {
    /// Every model, the primary one first.
    pub const ALL: [Self; 4] = [Self::Davidson, Self::DavidsonSide, Self::RaoKupper, Self::BradleyTerry];

    /// The name in files.
    pub fn code(self) -> &'static str {
        match self {
            Self::Davidson => "davidson",
            Self::DavidsonSide => "davidson-side",
            Self::RaoKupper => "rao-kupper",
            Self::BradleyTerry => "bradley-terry",
        }
    }
}

/// Which parameters there are, in order: worths of items 1.., the tie parameter, the side.
#[derive(Debug, Clone, Copy)]
pub(super) struct Layout {
    pub(super) model: Model,
    pub(super) items: usize,
    /// Without a single tie the tie parameter is at its limit, and is not estimated.
    pub(super) ties: bool,
    /// A bonus of the left side that is taken as known, in log-odds.
    pub(super) given_side: f64,
}

impl Layout {
    pub(super) fn of(model: Model, pairs: &Pairs, given_side: f64) -> Self {
        let ties = model != Model::BradleyTerry && pairs.ties() > 0.0;
        Self { model, items: pairs.items, ties, given_side }
    }

    /// Index of ln nu or eta.
    pub(super) fn tie(&self) -> Option<usize> {
        self.ties.then_some(self.items - 1)
    }

    /// Index of delta.
    pub(super) fn side(&self) -> Option<usize> {
        (self.model == Model::DavidsonSide).then_some(self.items - 1 + usize::from(self.ties))
    }

    pub(super) fn parameters(&self) -> usize {
        self.items - 1 + usize::from(self.ties) + usize::from(self.side().is_some())
    }

    /// Equal worths, no side; eta must start above zero.
    pub(super) fn start(&self) -> Vec<f64> {
        let mut start = vec![0.0; self.parameters()];
        if let (Model::RaoKupper, Some(tie)) = (self.model, self.tie()) {
            start[tie] = 0.5;
        }
        start
    }

    /// Log-likelihood, without the multinomial constants, and its derivatives.
    pub(super) fn likelihood(&self, pairs: &Pairs, parameters: &[f64]) -> Curvature {
        let mut sum = Curvature::zero(self.parameters());
        for pair in &pairs.pairs {
            let touched = self.touched(pair.left, pair.right);
            match (self.model, touched.tie) {
                (Model::RaoKupper, Some(tie)) => {
                    add_threshold(&mut sum, &touched, self, pair, parameters, tie)
                }
                _ => add_weights(&mut sum, &touched, self, pair, parameters),
            }
        }
        sum
    }

    /// The gradient that one answer has, for left, tie and right of a pair, by the parameters that the pair touches; zero for a
    /// tie where there was none.
    pub(super) fn scores(
        &self,
        (left, right): (usize, usize),
        parameters: &[f64],
    ) -> (Touched, [[f64; 4]; 3]) {
        let touched = self.touched(left, right);
        // By the touched parameters alone, as if there were no others.
        let own = Touched { places: [0, 1, 2, 3], ..touched };
        let mut at = [0.0; 4];
        touched.places().iter().zip(&mut at).for_each(|(&place, at)| *at = parameters[place]);
        let scores = [0, 1, 2].map(|outcome| {
            let mut answers = [0.0; 3];
            answers[outcome] = f64::from(outcome != 1 || self.ties || self.model == Model::BradleyTerry);
            let pair = Pair { left, right, answers };
            let mut sum = Curvature::zero(own.number);
            match (self.model, own.tie) {
                (Model::RaoKupper, Some(tie)) => add_threshold(&mut sum, &own, self, &pair, &at, tie),
                _ => add_weights(&mut sum, &own, self, &pair, &at),
            }
            let mut score = [0.0; 4];
            score[..own.number].copy_from_slice(&sum.gradient);
            score
        });
        (touched, scores)
    }

    /// The parameters that a pair touches.
    fn touched(&self, left: usize, right: usize) -> Touched {
        let mut touched = Touched { number: 0, places: [0; 4], x: [0.0; 4], tie: None };
        let worths = if left < right { [(left, 1.0), (right, -1.0)] } else { [(right, -1.0), (left, 1.0)] };
        worths.into_iter().filter(|(item, _)| *item > 0).for_each(|(item, x)| touched.push(item - 1, x));
        if let Some(tie) = self.tie() {
            touched.tie = Some(touched.number);
            touched.push(tie, 0.0);
        }
        self.side().into_iter().for_each(|side| touched.push(side, 1.0));
        touched
    }
}

/// The parameters that a pair touches, of which there are four at most, ascending: a thousand items have a thousand parameters.
#[derive(Debug, Clone, Copy)]
pub(super) struct Touched {
    number: usize,
    places: [usize; 4],
    /// Derivative of l_left - l_right + delta by each of them.
    x: [f64; 4],
    /// Which of them is the tie parameter.
    tie: Option<usize>,
}

impl Touched {
    fn push(&mut self, place: usize, x: f64) {
        (self.places[self.number], self.x[self.number]) = (place, x);
        self.number += 1;
    }

    /// Their places among all parameters.
    pub(super) fn places(&self) -> &[usize] {
        &self.places[..self.number]
    }

    /// A sum over them of factors and their values among all parameters.
    fn dot(&self, factors: &[f64; 4], parameters: &[f64]) -> f64 {
        self.places().iter().zip(factors).map(|(&place, factor)| factor * parameters[place]).sum()
    }
}

/// Davidson and Bradley-Terry, as [`add_log_linear`] has them.
fn add_weights(sum: &mut Curvature, touched: &Touched, layout: &Layout, pair: &Pair, parameters: &[f64]) {
    let [left, ties, right] = pair.answers;
    let mut features = [touched.x.map(|x| 0.5 * x), touched.x.map(|x| -(0.5 * x)), [0.0; 4]];
    let mut counts = [left, right, ties];
    let outcomes = match touched.tie {
        Some(tie) => {
            features[2][tie] = 1.0;
            3
        }
        None => {
            counts[..2].iter_mut().for_each(|count| *count += 0.5 * ties);
            2
        }
    };
    let (features, counts) = (&features[..outcomes], &counts[..outcomes]);
    let mut logs = [0.0; 3];
    logs.iter_mut().zip(features).for_each(|(log, feature)| *log = touched.dot(feature, parameters));
    logs[0] += 0.5 * layout.given_side;
    logs[1] -= 0.5 * layout.given_side;
    let likeliest = (0..outcomes).fold(0, |best, k| if logs[k] > logs[best] { k } else { best });
    let behind = logs.map(|log| log - logs[likeliest]);
    let others = (0..outcomes).filter(|&k| k != likeliest);
    let total = others.map(|k| behind[k].exp()).sum::<f64>().ln_1p();
    let n: f64 = counts.iter().sum();
    let chances = behind.map(|behind| (behind - total).exp());
    for (k, feature) in features.iter().enumerate() {
        let mut from_mean = [0.0; 4];
        for (i, from_mean) in from_mean[..touched.number].iter_mut().enumerate() {
            *from_mean = features.iter().zip(&chances).map(|(other, p)| p * (feature[i] - other[i])).sum();
        }
        sum.value += counts[k] * (behind[k] - total);
        for (i, &row) in touched.places().iter().enumerate() {
            sum.gradient[row] += counts[k] * from_mean[i];
            for (j, &column) in touched.places().iter().enumerate() {
                sum.information[row][column] += n * chances[k] * from_mean[i] * from_mean[j];
            }
        }
    }
}

/// Rao and Kupper: a logistic cut in three at -eta and eta.
fn add_threshold(
    sum: &mut Curvature,
    touched: &Touched,
    layout: &Layout,
    pair: &Pair,
    parameters: &[f64],
    tie: usize,
) {
    let (x, places) = (&touched.x, touched.places());
    let u = layout.given_side + touched.dot(x, parameters);
    let eta = parameters[places[tie]];
    let towards = |sign: f64| {
        let mut d = x.map(|x| sign * x);
        d[tie] = -1.0;
        d
    };
    let [left, ties, right] = pair.answers;
    let cuts = [(left, u - eta, towards(1.0)), (right, -u - eta, towards(-1.0))];
    let logistic = |z: f64| 1.0 / (1.0 + (-z).exp());
    for (count, z, d) in &cuts {
        // 1 less a chance is the logistic of the opposite: nothing cancels.
        let (chance, rest) = (logistic(*z), logistic(-z));
        sum.value -= count * softplus(-z);
        for (i, &row) in places.iter().enumerate() {
            sum.gradient[row] += count * rest * d[i];
            for (j, &column) in places.iter().enumerate() {
                sum.information[row][column] += count * chance * rest * d[i] * d[j];
            }
        }
    }
    if ties == 0.0 {
        return;
    }
    // P(tie) = 1 - F(u - eta) - F(-u - eta), factored so that nothing cancels: (e^{2 eta} - 1) F(u - eta) F(-u - eta).
    let [(_, a, da), (_, b, db)] = &cuts;
    let ([fa, fb], [ra, rb]) = ([*a, *b].map(logistic), [-a, -b].map(logistic));
    if eta <= 0.0 {
        sum.value = f64::NEG_INFINITY;
        return;
    }
    let growth = (2.0 * eta).exp_m1();
    sum.value += ties * (growth.ln() - softplus(-a) - softplus(-b));
    for (i, &row) in places.iter().enumerate() {
        let free = if i == tie { 2.0 * (1.0 + 1.0 / growth) } else { 0.0 };
        sum.gradient[row] += ties * (free + ra * da[i] + rb * db[i]);
        for (j, &column) in places.iter().enumerate() {
            let curved = fa * ra * da[i] * da[j] + fb * rb * db[i] * db[j];
            // d2/d eta2 of ln(e^{2 eta} - 1) = -4 e^{2 eta} / (e^{2 eta} - 1)^2.
            let free = if i == tie && j == tie { 4.0 * (growth + 1.0) / (growth * growth) } else { 0.0 };
            sum.information[row][column] += ties * (curved + free);
        }
    }
}

/// ln(1 + e^z), also where e^z is beyond any double.
fn softplus(z: f64) -> f64 {
    z.max(0.0) + (-z.abs()).exp().ln_1p()
}

/// Adds answers `[left, tie, right]` with weights e^{u/2} : nu : e^{-u/2}, u = x'parameters + given and ln nu the parameter at
/// `tie`: an exponential family, so the information is n times a covariance. Without `tie` there is no third outcome, and a
/// tie counts as half an answer for each side.
pub(super) fn add_log_linear(
    sum: &mut Curvature,
    x: &[f64],
    given: f64,
    tie: Option<usize>,
    answers: [f64; 3],
    parameters: &[f64],
) {
    let half: Vec<f64> = x.iter().map(|x| 0.5 * x).collect();
    let negative: Vec<f64> = half.iter().map(|x| -x).collect();
    let [left, ties, right] = answers;
    let (mut features, mut counts) = (vec![half, negative], vec![left, right]);
    match tie {
        Some(index) => {
            let mut tie = vec![0.0; x.len()];
            tie[index] = 1.0;
            features.push(tie);
            counts.push(ties);
        }
        None => counts.iter_mut().for_each(|count| *count += 0.5 * ties),
    }
    let dot = |feature: &Vec<f64>| -> f64 { feature.iter().zip(parameters).map(|(f, p)| f * p).sum() };
    let mut logs: Vec<f64> = features.iter().map(dot).collect();
    logs[0] += 0.5 * given;
    logs[1] -= 0.5 * given;
    // Beside the likeliest outcome, whose own chance is then 1 less what is small: a thousand million answers of it make
    // every digit of its logarithm count.
    let likeliest = (0..logs.len()).fold(0, |best, k| if logs[k] > logs[best] { k } else { best });
    let behind: Vec<f64> = logs.iter().map(|log| log - logs[likeliest]).collect();
    let others = (0..logs.len()).filter(|&k| k != likeliest);
    let total = others.map(|k| behind[k].exp()).sum::<f64>().ln_1p();
    let n: f64 = counts.iter().sum();
    let chances: Vec<f64> = behind.iter().map(|log| (log - total).exp()).collect();
    for (k, feature) in features.iter().enumerate() {
        // A feature less its mean, as a sum of differences: where one chance is nearly 1, a difference of sums would be lost.
        let from_mean: Vec<f64> = (0..x.len())
            .map(|i| features.iter().zip(&chances).map(|(other, p)| p * (feature[i] - other[i])).sum())
            .collect();
        sum.value += counts[k] * (behind[k] - total);
        for i in 0..x.len() {
            sum.gradient[i] += counts[k] * from_mean[i];
            for j in 0..x.len() {
                sum.information[i][j] += n * chances[k] * from_mean[i] * from_mean[j];
            }
        }
    }
}
