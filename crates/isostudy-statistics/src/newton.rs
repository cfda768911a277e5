//! Newton's method on a concave log-likelihood, and the small dense algebra it needs.

use rayon::prelude::*;

/// A square matrix by rows.
pub type Matrix = Vec<Vec<f64>>;

/// A log-likelihood at one point.
#[derive(Debug, Clone)]
pub(super) struct Curvature {
    /// The log-likelihood.
    pub(super) value: f64,
    /// Its gradient.
    pub(super) gradient: Vec<f64>,
    /// Minus its matrix of second derivatives.
    pub(super) information: Matrix,
}

impl Curvature {
    /// Zero in `parameters` dimensions.
    pub(super) fn zero(parameters: usize) -> Self {
        let information = vec![vec![0.0; parameters]; parameters];
        Self { value: 0.0, gradient: vec![0.0; parameters], information }
    }
}

/// The maximum, and the inverse of the information there: the covariance of the estimates.
pub(super) struct Maximum {
    pub(super) at: Vec<f64>,
    pub(super) covariance: Matrix,
}

/// How often to step at most. A maximum at log-odds u is some u / 2 steps away, and the last few double the digits.
const MOST_STEPS: usize = 400;
/// How far to go in one step, in log-odds: farther off, the curvature is nothing like here.
const LONGEST: f64 = 3.0;
/// By how much of its size a sum of many logarithms may be lower through rounding alone.
const ROUNDING: f64 = 16.0 * f64::EPSILON;
/// The least part of a step that is tried.
const LEAST: f64 = 1e-9;
/// The step, beside the parameter, from which one step more leaves rounding alone.
const SHORT: f64 = 1e-6;
/// With more parameters than this, steps are solved for without the inverse of the information, and rows of inverses are shared
/// out among threads.
const DENSE: usize = 64;

/// Climbs from `start` until the gain left, g' H^-1 g, is below what the log-likelihood's size lets anyone see or below
/// 1e-13, and the step is short; then takes one step more: the convergence being quadratic, what is left is rounding.
///
/// A step's part is chosen [by the value](by_value). Where numbers of answers are far apart, the value is a small difference of
/// large sums: its rounding is more than its size tells, and hides that a step gains. Where that leads nowhere, the parts
/// are chosen [by the slope](by_slope), whose sums are small close to the maximum.
///
/// `None` if the information is singular or there is no maximum. Towards infinity the gain left falls as well, but every
/// step stays as long as the last: it is the step that tells.
pub(super) fn maximise(start: Vec<f64>, likelihood: impl Fn(&[f64]) -> Curvature) -> Option<Maximum> {
    climb(start.clone(), &likelihood, by_value).or_else(|| climb(start, &likelihood, by_slope))
}

/// What part of a step to go, and the likelihood there; `None` if there is no such part.
type Part = fn(&[f64], &Curvature, &dyn Fn(f64) -> Curvature) -> Option<(f64, Curvature)>;

fn climb(start: Vec<f64>, likelihood: impl Fn(&[f64]) -> Curvature, part: Part) -> Option<Maximum> {
    let mut at = start;
    let mut here = likelihood(&at);
    for _ in 0..MOST_STEPS {
        let mut step = match at.len() <= DENSE {
            true => times(&inverse(&here.information)?, &here.gradient),
            false => solved(&here.information, &here.gradient)?,
        };
        let gain: f64 = step.iter().zip(&here.gradient).map(|(s, g)| s * g).sum();
        let longest = step.iter().map(|s| s.abs()).fold(0.0, f64::max);
        step.iter_mut().for_each(|s| *s /= (longest / LONGEST).max(1.0));
        let forward = |part: f64| -> Vec<f64> { at.iter().zip(&step).map(|(a, s)| a + part * s).collect() };
        let short = at.iter().zip(&step).all(|(a, s)| s.abs() <= SHORT * (1.0 + a.abs()));
        if short && gain < unseen(&here).max(1e-13) {
            at = forward(1.0);
            let covariance = inverse(&likelihood(&at).information)?;
            return Some(Maximum { at, covariance });
        }
        let (part, next) = part(&step, &here, &|part| likelihood(&forward(part)))?;
        at = forward(part);
        here = next;
    }
    None
}

/// By how much the log-likelihood may be lower through rounding alone.
fn unseen(here: &Curvature) -> f64 {
    ROUNDING * here.value.abs()
}

/// 1, 1/2, 1/4 and so on.
fn halves() -> impl Iterator<Item = f64> {
    std::iter::successors(Some(1.0), |part| Some(0.5 * part)).take_while(|&part| part >= LEAST)
}

/// A step is halved only while it makes the log-likelihood lower by more than rounding: close to the maximum of thousands
/// of answers the gain left is less than one unit in the last place of the value, and no step can look like a gain.
fn by_value(_: &[f64], here: &Curvature, after: &dyn Fn(f64) -> Curvature) -> Option<(f64, Curvature)> {
    let lowest = here.value - unseen(here);
    halves().map(|part| (part, after(part))).find(|(_, there)| there.value >= lowest)
}

/// A step is halved only while the slope along it turns to less than minus half of what it was: the log-likelihood is concave,
/// so that this is far beyond the maximum.
fn by_slope(step: &[f64], here: &Curvature, after: &dyn Fn(f64) -> Curvature) -> Option<(f64, Curvature)> {
    let slope = |of: &Curvature| step.iter().zip(&of.gradient).map(|(s, g)| s * g).sum::<f64>();
    let lowest = -0.5 * slope(here);
    let good = |there: &Curvature| there.value.is_finite() && slope(there) >= lowest;
    halves().map(|part| (part, after(part))).find(|(_, there)| good(there))
}

/// Cholesky's lower factor of a symmetric positive definite matrix; `None` if it is not one.
pub(super) fn factor(matrix: &Matrix) -> Option<Matrix> {
    let n = matrix.len();
    let mut factor = vec![vec![0.0; n]; n];
    for i in 0..n {
        for j in 0..=i {
            let sum: f64 = (0..j).map(|k| factor[i][k] * factor[j][k]).sum();
            let rest = matrix[i][j] - sum;
            if i != j {
                factor[i][j] = rest / factor[j][j];
            } else if rest > 1e-11 * matrix[i][i].abs() && rest > 0.0 {
                factor[i][i] = rest.sqrt();
            } else {
                return None;
            }
        }
    }
    Some(factor)
}

/// ln of the determinant of a symmetric positive definite matrix; `None` if it is not one.
pub(super) fn ln_determinant(matrix: &Matrix) -> Option<f64> {
    let factor = factor(matrix)?;
    Some((0..matrix.len()).map(|i| 2.0 * factor[i][i].ln()).sum())
}

/// The inverse of a symmetric positive definite matrix by Cholesky's factors; `None` if it is not one.
pub(super) fn inverse(matrix: &Matrix) -> Option<Matrix> {
    let n = matrix.len();
    let factor = factor(matrix)?;
    let across = transposed(&factor);
    let row = |row: usize| {
        let mut x = vec![0.0; n];
        x[row] = 1.0;
        substitute(&factor, &across, &mut x, row);
        x
    };
    // Symmetric: its columns are its rows.
    match n <= DENSE {
        true => Some((0..n).map(row).collect()),
        false => Some((0..n).into_par_iter().map(row).collect()),
    }
}

/// The x with matrix x = right for a symmetric positive definite matrix; `None` if it is not one.
fn solved(matrix: &Matrix, right: &[f64]) -> Option<Vec<f64>> {
    let factor = factor(matrix)?;
    let mut x = right.to_vec();
    substitute(&factor, &transposed(&factor), &mut x, 0);
    Some(x)
}

fn transposed(matrix: &Matrix) -> Matrix {
    let n = matrix.len();
    (0..n).map(|i| matrix.iter().map(|row| row[i]).collect()).collect()
}

/// Forward and back through Cholesky's lower factor and its transpose; what comes before `first` is zero.
fn substitute(factor: &Matrix, across: &Matrix, x: &mut [f64], first: usize) {
    let n = x.len();
    for i in first..n {
        let sum: f64 = (first..i).map(|k| factor[i][k] * x[k]).sum();
        x[i] = (x[i] - sum) / factor[i][i];
    }
    for i in (0..n).rev() {
        let sum: f64 = (i + 1..n).map(|k| across[i][k] * x[k]).sum();
        x[i] = (x[i] - sum) / factor[i][i];
    }
}

/// Matrix times vector.
pub(super) fn times(matrix: &Matrix, vector: &[f64]) -> Vec<f64> {
    matrix.iter().map(|row| row.iter().zip(vector).map(|(a, b)| a * b).sum()).collect()
}

/// a' M b.
pub(super) fn quadratic(a: &[f64], matrix: &Matrix, b: &[f64]) -> f64 {
    a.iter().zip(times(matrix, b)).map(|(x, y)| x * y).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverts_and_refuses() {
        let matrix = vec![vec![4.0, 2.0, 0.6], vec![2.0, 3.0, 0.4], vec![0.6, 0.4, 2.0]];
        let inverted = inverse(&matrix).unwrap();
        for (i, row) in matrix.iter().enumerate() {
            let unit = times(&inverted, row);
            assert!(unit.iter().enumerate().all(|(j, x)| (x - f64::from(i == j)).abs() < 1e-14), "{unit:?}");
        }
        assert_eq!(inverse(&vec![vec![1.0, 1.0], vec![1.0, 1.0]]), None);
        assert_eq!(inverse(&vec![vec![-1.0]]), None);
    }
}
