//! Worths where each is drawn from one normal distribution: what is known of them while answers come in, and estimates in the end.
//!
//! Davidson's likelihood with a bonus for a side times the normal density of each worth, its spread by the largest marginal likelihood
//! (Laplace's approximation). Worths that few answers tell of are drawn together, as far as the others are alike: "empirical Bayes"
//! (Morris 1983, J. Amer. Statist. Assoc. 78:47). Unlike the likelihood alone, that is right also where earlier answers decided
//! which pairs were asked.

use crate::clustered::{Coefficient, Estimates};
use crate::fit::FitError;
use crate::newton::{Curvature, Matrix, ln_determinant, maximise};
use crate::pairs::Pairs;
use crate::participants::Participants;
use crate::separation::{Separation, separation};
use crate::simulation::davidson;

/// What is known of worths.
#[derive(Debug, Clone, PartialEq)]
pub struct Known {
    /// The likeliest log worths; their mean is near 0.
    pub log_worths: Vec<f64>,
    /// Their covariance.
    pub covariance: Matrix,
    /// Davidson's tie parameter.
    pub nu: f64,
    /// Standard deviation of the worths, one of 0.05, 0.1, 0.2 and so on to 3.2.
    pub worths_sd: f64,
}

/// Standard deviations that are tried, each twice the one before.
const SPREADS: [f64; 7] = [0.05, 0.1, 0.2, 0.4, 0.8, 1.6, 3.2];
/// Where the search begins: before anybody answered, it also ends there.
const FIRST: usize = 4;
/// ln nu and its standard deviation before any answer. Without a tie so far, few are expected.
const LN_NU: (f64, f64) = (-1.2, 1.0);
/// Standard deviation of the side's bonus before any answer, in log-odds.
const SIDE_SD: f64 = 1.0;

/// The mode of the posterior at one spread of worths: parameters are all worths, ln nu, side.
struct Mode {
    at: Vec<f64>,
    covariance: Matrix,
    /// ln of the marginal likelihood, but for what all spreads have.
    marginal: f64,
}

/// The precision of the prior of a parameter, and its mean.
fn prior(items: usize, place: usize, spread: f64) -> (f64, f64) {
    match place {
        item if item < items => (spread.powi(-2), 0.0),
        tie if tie == items => (LN_NU.1.powi(-2), LN_NU.0),
        _ => (SIDE_SD.powi(-2), 0.0),
    }
}

/// Adds answers to a log-likelihood.
fn add(sum: &mut Curvature, pairs: &Pairs, at: &[f64]) {
    let (tie, side) = (pairs.items, pairs.items + 1);
    let nu = at[tie].exp();
    for pair in &pairs.pairs {
        let chances = davidson(at[pair.left] - at[pair.right] + at[side], nu);
        let n: f64 = pair.answers.iter().sum();
        let counted = pair.answers.iter().zip(chances).filter(|(count, _)| **count > 0.0);
        sum.value += counted.map(|(count, chance)| count * chance.ln()).sum::<f64>();
        let mean = 0.5 * (chances[0] - chances[2]);
        let slope = 0.5 * (pair.answers[0] - pair.answers[2]) - n * mean;
        let curve = n * (0.25 * (chances[0] + chances[2]) - mean * mean);
        let both = -n * chances[1] * mean;
        let parts = [(pair.left, 1.0), (pair.right, -1.0), (side, 1.0)];
        for (i, x) in parts {
            sum.gradient[i] += slope * x;
            parts.into_iter().for_each(|(j, y)| sum.information[i][j] += curve * x * y);
            sum.information[i][tie] += both * x;
            sum.information[tie][i] += both * x;
        }
        sum.gradient[tie] += pair.answers[1] - n * chances[1];
        sum.information[tie][tie] += n * chances[1] * (1.0 - chances[1]);
    }
}

fn mode(pairs: &Pairs, spread: f64, start: Vec<f64>) -> Mode {
    let size = pairs.items + 2;
    let posterior = |at: &[f64]| {
        let mut sum = Curvature::zero(size);
        for (place, value) in at.iter().enumerate() {
            let (precision, mean) = prior(pairs.items, place, spread);
            let off = value - mean;
            sum.value -= 0.5 * precision * off * off;
            sum.gradient[place] = -precision * off;
            sum.information[place][place] = precision;
        }
        add(&mut sum, pairs, at);
        sum
    };
    // The priors make it strictly concave, with a maximum whatever the answers.
    let found = maximise(start, posterior).expect("a maximum");
    let here = posterior(&found.at);
    let determinant = ln_determinant(&here.information).expect("positive definite");
    let marginal = here.value - pairs.items as f64 * spread.ln() - 0.5 * determinant;
    Mode { at: found.at, covariance: found.covariance, marginal }
}

/// The mode at the likeliest spread, which the marginal likelihood has one of.
fn likeliest(pairs: &Pairs) -> (Mode, f64) {
    let mut place = FIRST;
    let mut start = vec![0.0; pairs.items + 2];
    start[pairs.items] = LN_NU.0;
    let mut best = mode(pairs, SPREADS[place], start);
    for up in [true, false] {
        let start = place;
        loop {
            let next = if up { place + 1 } else { place.wrapping_sub(1) };
            let Some(&spread) = SPREADS.get(next) else { break };
            let other = mode(pairs, spread, best.at.clone());
            // Equally likely ones, such as all are without an answer, are none.
            if other.marginal <= best.marginal + 1e-9 {
                break;
            }
            (place, best) = (next, other);
        }
        if place != start {
            break;
        }
    }
    (best, SPREADS[place])
}

impl Known {
    /// What these answers tell, of two items or more.
    pub fn of(pairs: &Pairs) -> Self {
        let (mode, worths_sd) = likeliest(pairs);
        let items = pairs.items;
        Self {
            nu: mode.at[items].exp(),
            log_worths: mode.at[..items].to_vec(),
            covariance: mode.covariance[..items].iter().map(|row| row[..items].to_vec()).collect(),
            worths_sd,
        }
    }
}

/// Estimates that are drawn together.
#[derive(Debug, Clone, PartialEq)]
pub struct Shrunken {
    /// Log worths; their mean is near 0.
    pub log_worths: Vec<f64>,
    /// ln of Davidson's tie parameter.
    pub ln_nu: f64,
    /// The left side's bonus in log-odds.
    pub side: f64,
    /// Standard deviation of the worths, as [`Known::worths_sd`].
    pub worths_sd: f64,
    /// What is not known of all worths, ln nu and side: C (M + P) C, C the inverse curvature of likelihood and priors, M the
    /// covariance of people's gradients added up, P the priors' precision. With M the information it would be C, the posterior's.
    pub covariance: Matrix,
    /// C, as if all answers were independent.
    pub independent: Matrix,
    /// How many participants answered.
    pub participants: u64,
}

/// Worths drawn together, with participants as clusters.
///
/// # Errors
/// [`FitError::Nothing`] with fewer than two items or people, and [`FitError::Disconnected`] where items were never compared, not even
/// through others. Items that never won have estimates: the others tell how far away they can be.
pub fn shrunken(participants: &Participants) -> Result<Shrunken, FitError> {
    let items = participants.items();
    let m = participants.number() as f64;
    if items < 2 || m < 2.0 {
        return Err(FitError::Nothing);
    }
    let pairs = participants.sum(&participants.counts);
    if separation(&pairs) == Separation::Disconnected {
        return Err(FitError::Disconnected);
    }
    let (Mode { at, covariance: inverse, .. }, worths_sd) = likeliest(&pairs);
    let size = items + 2;
    let mut middle: Matrix = vec![vec![0.0; size]; size];
    for (place, row) in middle.iter_mut().enumerate() {
        row[place] = prior(items, place, worths_sd).0;
    }
    for (kind, &people) in participants.counts.iter().enumerate() {
        let mut own = Curvature::zero(size);
        add(&mut own, &participants.of_kind(kind), &at);
        let weight = people as f64 * m / (m - 1.0);
        for i in (0..size).filter(|&i| own.gradient[i] != 0.0) {
            (0..size).for_each(|j| middle[i][j] += weight * own.gradient[i] * own.gradient[j]);
        }
    }
    Ok(Shrunken {
        covariance: product(&product(&inverse, &middle), &inverse),
        independent: inverse,
        log_worths: at[..items].to_vec(),
        ln_nu: at[items],
        side: at[items + 1],
        worths_sd,
        participants: participants.number(),
    })
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let row = |row: &Vec<f64>| {
        let mut sum = vec![0.0; b.len()];
        for (factor, other) in row.iter().zip(b) {
            sum.iter_mut().zip(other).for_each(|(sum, x)| *sum += factor * x);
        }
        sum
    };
    a.iter().map(row).collect()
}

impl Shrunken {
    /// How much more an item is worth than another, t interval and p on m - 1 degrees of freedom. `None` if the answers tell no
    /// spread.
    ///
    /// # Panics
    /// If there is no such item.
    pub fn difference(&self, item: usize, other: usize) -> Option<Coefficient> {
        let of = Estimates {
            independent: &self.independent,
            clustered: Some(&self.covariance),
            participants: self.participants,
        };
        of.combined(self.log_worths[item] - self.log_worths[other], &[(item, 1.0), (other, -1.0)])
    }
}
