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
            match (self.model, self.tie()) {
                (Model::RaoKupper, Some(tie)) => self.add_threshold(&mut sum, pair, parameters, tie),
                _ => self.add_weights(&mut sum, pair, parameters),
            }
        }
        sum
    }

    /// The gradient that one answer has, for left, tie and right of a pair; zero for a tie where there was none.
    pub(super) fn scores(&self, (left, right): (usize, usize), parameters: &[f64]) -> [Vec<f64>; 3] {
        [0, 1, 2].map(|outcome| {
            let mut answers = [0.0; 3];
            answers[outcome] = f64::from(outcome != 1 || self.ties || self.model == Model::BradleyTerry);
            let one = Pairs { items: self.items, pairs: vec![Pair { left, right, answers }] };
            self.likelihood(&one, parameters).gradient
        })
    }

    /// Derivative of l_left - l_right + delta by the parameters.
    fn difference(&self, pair: &Pair) -> Vec<f64> {
        let mut x = vec![0.0; self.parameters()];
        if pair.left > 0 {
            x[pair.left - 1] = 1.0;
        }
        if pair.right > 0 {
            x[pair.right - 1] = -1.0;
        }
        if let Some(side) = self.side() {
            x[side] = 1.0;
        }
        x
    }

    /// Davidson and Bradley-Terry.
    fn add_weights(&self, sum: &mut Curvature, pair: &Pair, parameters: &[f64]) {
        let x = self.difference(pair);
        add_log_linear(sum, &x, self.given_side, self.tie(), pair.answers, parameters);
    }

    /// Rao and Kupper: a logistic cut in three at -eta and eta.
    fn add_threshold(&self, sum: &mut Curvature, pair: &Pair, parameters: &[f64], tie: usize) {
        let x = self.difference(pair);
        let u = self.given_side + x.iter().zip(parameters).map(|(x, p)| x * p).sum::<f64>();
        let eta = parameters[tie];
        let towards = |sign: f64| {
            let mut d: Vec<f64> = x.iter().map(|x| sign * x).collect();
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
            for i in 0..x.len() {
                sum.gradient[i] += count * rest * d[i];
                for j in 0..x.len() {
                    sum.information[i][j] += count * chance * rest * d[i] * d[j];
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
        for i in 0..x.len() {
            let free = if i == tie { 2.0 * (1.0 + 1.0 / growth) } else { 0.0 };
            sum.gradient[i] += ties * (free + ra * da[i] + rb * db[i]);
            for j in 0..x.len() {
                let curved = fa * ra * da[i] * da[j] + fb * rb * db[i] * db[j];
                // d2/d eta2 of ln(e^{2 eta} - 1) = -4 e^{2 eta} / (e^{2 eta} - 1)^2.
                let free = if i == tie && j == tie { 4.0 * (growth + 1.0) / (growth * growth) } else { 0.0 };
                sum.information[i][j] += ties * (curved + free);
            }
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
