//! Kendall's coefficients for paired comparisons: consistency of one participant, agreement of several.

use super::ballot::DeclaredBallot;
use super::friedman::ChiSquareTest;

/// Consistency of a complete tournament without ties (Kendall and Babington Smith 1940, Biometrika 31:324), from the
/// number of wins of each of n items: circular triads T = n(n-1)(2n-1)/12 - sum a^2 / 2, and zeta = 1 - T / T_max with
/// T_max = n(n^2-1)/24 for odd n, n(n^2-4)/24 for even n. `(T, zeta)`; `None` below three items.
///
/// # Panics
/// If the wins do not add up to n(n-1)/2: the tournament was not complete.
pub fn zeta(wins: &[u64]) -> Option<(u64, f64)> {
    let n = wins.len() as u64;
    if n < 3 {
        return None;
    }
    assert_eq!(wins.iter().sum::<u64>(), n * (n - 1) / 2, "not a complete tournament");
    let squares: u64 = wins.iter().map(|a| a * a).sum();
    let circular = (n * (n - 1) * (2 * n - 1) / 6 - squares) / 2;
    let most = if n % 2 == 1 { n * (n * n - 1) / 24 } else { n * (n * n - 4) / 24 };
    Some((circular, 1.0 - circular as f64 / most as f64))
}

/// Kendall's coefficient of agreement and its test.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Agreement {
    /// u: 1 in full agreement, about 0 by chance, at least -1/(m-1) for even m and -1/m for odd m.
    pub u: f64,
    /// Chi-square test of no agreement; `None` for two judges or fewer.
    pub test: Option<ChiSquareTest>,
}

/// Kendall's u over judges who all answered the same pairs (Kendall and Babington Smith 1940, section 13).
///
/// `pairs` holds, for each pair, the answers `[first, neither, second]` of `m` judges. u = 2 S / (P C(m,2)) - 1 with P pairs
/// and S = sum of C(a, 2) over both sides, a tie counting as half an answer for each; C(a, 2) = a(a-1)/2 for halves too.
/// The test: chi2 = 4/(m-2) (S - P C(m,2) (m-3) / (2(m-2))) on P m(m-1)/(m-2)^2 degrees of freedom, without continuity
/// correction. It holds for decided answers; ties make it conservative.
///
/// `None` without pairs, with fewer than two judges, or if the pairs do not have the same number of answers.
pub fn agreement(pairs: &[[u64; 3]]) -> Option<Agreement> {
    let judges: u64 = pairs.first()?.iter().sum();
    if judges < 2 || pairs.iter().any(|pair| pair.iter().sum::<u64>() != judges) {
        return None;
    }
    let choose_two = |a: f64| a * (a - 1.0) / 2.0;
    let (m, all) = (judges as f64, pairs.len() as f64 * choose_two(judges as f64));
    let side = |own: u64, ties: u64| choose_two(own as f64 + ties as f64 / 2.0);
    let s: f64 = pairs.iter().map(|&[left, ties, right]| side(left, ties) + side(right, ties)).sum();
    let test = (judges > 2).then(|| {
        let statistic = 4.0 / (m - 2.0) * (s - 0.5 * all * (m - 3.0) / (m - 2.0));
        ChiSquareTest::new(statistic, pairs.len() as f64 * m * (m - 1.0) / ((m - 2.0) * (m - 2.0)))
    });
    Some(Agreement { u: 2.0 * s / all - 1.0, test })
}

/// Answers to three items compared pairwise, all answered by one participant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Triads {
    /// How many.
    pub all: u64,
    /// Those without a tie.
    pub decided: u64,
    /// Decided and circular: A over B, B over C, C over A. 1 in 4 for answers by chance.
    pub strict_cycles: u64,
    /// Two wins round the circle closed by a tie: A over B, B over C, C equal to A. Not an error in itself, since
    /// indifference need not be transitive.
    pub weak_cycles: u64,
}

/// Every participant's triads among ballots of one scope (one object, one group), added up.
///
/// A pair that one participant answered more than once is taken at one of its ballots.
pub fn triads(ballots: &[DeclaredBallot]) -> Triads {
    let mut triads = Triads::default();
    for of in tournaments(ballots) {
        for a in 0..of.items {
            for b in a + 1..of.items {
                for c in b + 1..of.items {
                    if let [Some(x), Some(y), Some(z)] = [of.sign(a, b), of.sign(b, c), of.sign(c, a)] {
                        triads.add([x, y, z]);
                    }
                }
            }
        }
    }
    triads
}

/// [`zeta`] of every participant who decided every pair of the scope's items: how many, and the sum.
pub fn zetas(ballots: &[DeclaredBallot]) -> (u64, f64) {
    let wins = |of: &Tournament| -> Option<Vec<u64>> {
        let of_item = |a: usize| {
            let won = |b: usize| of.sign(a, b).filter(|&sign| sign != 0).map(|sign| u64::from(sign > 0));
            (0..of.items).filter(|&b| b != a).map(won).sum::<Option<u64>>()
        };
        (0..of.items).map(of_item).collect()
    };
    let all = tournaments(ballots).filter_map(|of| zeta(&wins(&of)?));
    all.fold((0, 0.0), |(n, sum), (_, zeta)| (n + 1, sum + zeta))
}

/// One participant's answers about the items of a scope, which are numbered anew.
struct Tournament {
    items: usize,
    /// By item and item: 1 for the first, 0 for a tie, -1 for the second.
    signs: Vec<Option<i64>>,
}

impl Tournament {
    fn sign(&self, a: usize, b: usize) -> Option<i64> {
        self.signs[a * self.items + b]
    }
}

fn tournaments(ballots: &[DeclaredBallot]) -> impl Iterator<Item = Tournament> {
    let mut items: Vec<usize> = Vec::new();
    for item in ballots.iter().flat_map(|b| [b.first(), b.second()]) {
        if let Err(place) = items.binary_search(&item) {
            items.insert(place, item);
        }
    }
    let mut sorted = ballots.to_vec();
    sorted.sort_unstable();
    let of_participant = move |of: &[DeclaredBallot]| {
        let place = |item: usize| items.binary_search(&item).expect("collected above");
        let mut signs = vec![None; items.len() * items.len()];
        for ballot in of {
            let (first, second) = (place(ballot.first()), place(ballot.second()));
            let sign = ballot.preference().sign();
            signs[first * items.len() + second] = Some(sign);
            signs[second * items.len() + first] = Some(-sign);
        }
        Tournament { items: items.len(), signs }
    };
    let all: Vec<Tournament> =
        sorted.chunk_by(|a, b| a.participant() == b.participant()).map(of_participant).collect();
    all.into_iter()
}

impl Triads {
    /// Counts one triad, given its signs round the circle.
    fn add(&mut self, round: [i64; 3]) {
        let ties = round.iter().filter(|&&sign| sign == 0).count();
        let sum: i64 = round.iter().sum();
        self.all += 1;
        self.decided += u64::from(ties == 0);
        self.strict_cycles += u64::from(sum.abs() == 3);
        self.weak_cycles += u64::from(ties == 1 && sum.abs() == 2);
    }

    /// Strict cycles to be expected if the decided triads had been decided by chance: a quarter of them.
    pub fn cycles_by_chance(self) -> f64 {
        self.decided as f64 / 4.0
    }

    /// Adds another scope's triads.
    pub fn and(self, other: Self) -> Self {
        Self {
            all: self.all + other.all,
            decided: self.decided + other.decided,
            strict_cycles: self.strict_cycles + other.strict_cycles,
            weak_cycles: self.weak_cycles + other.weak_cycles,
        }
    }
}

/// How often each question's first item, neither and the second were chosen; questions from 0 to the largest in the ballots.
pub fn outcome_counts(ballots: &[DeclaredBallot]) -> Vec<[u64; 3]> {
    let questions = ballots.iter().map(|ballot| ballot.question() + 1).max().unwrap_or(0);
    let mut counts = vec![[0; 3]; questions];
    for ballot in ballots {
        counts[ballot.question()][ballot.preference().index()] += 1;
    }
    counts
}

#[cfg(test)]
mod tests;
