//! Would another assignment of the metric's values to the methods go with preference as well? The exact permutation test over
//! methods (Fisher 1935; Pesarin and Salmaso 2010, section 1.9).
//!
//! The sign-flip test asks about other people before the same methods. With six methods there are few values, and any order of
//! them may agree with what people like. Here people's answers stay, and whole methods exchange their values on every object: if
//! a metric has nothing to do with preference, every exchange is as likely as what was seen. So this p speaks of methods.

use isostudy_statistics::DeclaredBallot;
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_pcg::Pcg64;

/// Of up to so many methods every order is tried: 5,040 of seven.
const ALL_ORDERS: usize = 7;
/// Of more methods so many orders are drawn.
const DRAWN: usize = 9_999;
const SEED: u64 = 0x6d65_7468_6f64_7300;
/// Sums of whole numbers over whole numbers: what is nearer than this is equal.
const ALIKE: f64 = 1e-12;

/// What relabelling gives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Relabelled {
    /// Two-sided p: the share of orders that go with the answers, either way, as well as the true one or better.
    pub p: f64,
    /// How many orders were tried, the true one included.
    pub orders: usize,
    /// Whether these are all.
    pub is_exact: bool,
    /// p by Holm over the metrics.
    pub adjusted: f64,
}

/// The answers of a study by question: both methods, and answers for the first, for neither and for the second.
pub(super) struct Answers {
    questions: Vec<([usize; 2], usize, i64, u64)>,
    methods: usize,
}

impl Answers {
    /// `shown` gives each question's methods and object.
    pub(super) fn of(methods: usize, shown: &[([usize; 2], usize)], ballots: &[DeclaredBallot]) -> Self {
        let mut sums = vec![(0, 0); shown.len()];
        for ballot in ballots {
            let (net, answers) = &mut sums[ballot.question()];
            *net += ballot.preference().sign();
            *answers += 1;
        }
        let asked = shown.iter().zip(sums).filter(|(_, (_, answers))| *answers > 0);
        let questions = asked.map(|(&(of, object), (net, answers))| (of, object, net, answers)).collect();
        Self { questions, methods }
    }

    /// The test. `advantage` gives the first method's over the second's on an object. `None` where fewer than three methods differ.
    pub(super) fn relabelled(
        &self,
        advantage: &dyn Fn([usize; 2], usize) -> Option<f64>,
    ) -> Option<Relabelled> {
        // Only those that are compared have values to exchange.
        let is_shown = |method: &usize| self.questions.iter().any(|(of, ..)| of.contains(method));
        let compared: Vec<usize> = (0..self.methods).filter(is_shown).collect();
        if compared.len() < 3 {
            return None;
        }
        let place = |method: usize| compared.iter().position(|&of| of == method).expect("compared");
        let objects = self.questions.iter().map(|(_, object, ..)| object + 1).max()?;
        let n = compared.len();
        // Which of two methods is better on an object: 1, 0 or -1; `None` where a value is missing.
        let sign = |object: usize, a: usize, b: usize| {
            advantage([compared[a], compared[b]], object)
                .map(|of| of.partial_cmp(&0.0).map_or(0, |o| o as i64))
        };
        let signs: Vec<Option<i64>> =
            (0..objects * n * n).map(|i| sign(i / (n * n), i / n % n, i % n)).collect();
        let questions: Vec<(usize, usize, usize, i64, u64)> = self
            .questions
            .iter()
            .map(|&([a, b], object, net, answers)| (object, place(a), place(b), net, answers))
            .collect();
        let statistic = |order: &[usize]| {
            let (mut net, mut answers) = (0, 0);
            for &(object, a, b, own, count) in &questions {
                if let Some(sign) = signs[(object * n + order[a]) * n + order[b]].filter(|sign| *sign != 0) {
                    net += sign * own;
                    answers += count;
                }
            }
            if answers == 0 { 0.0 } else { (net as f64 / answers as f64).abs() }
        };
        let mut order: Vec<usize> = (0..n).collect();
        let least = statistic(&order) - ALIKE;
        let (mut as_good, mut orders) = (0, 0);
        let is_exact = n <= ALL_ORDERS;
        if is_exact {
            each_order(&mut order, n, &mut |order| {
                orders += 1;
                as_good += usize::from(statistic(order) >= least);
            });
        } else {
            (as_good, orders) = (1, 1 + DRAWN);
            let mut random = Pcg64::seed_from_u64(SEED);
            for _ in 0..DRAWN {
                order.shuffle(&mut random);
                as_good += usize::from(statistic(&order) >= least);
            }
        }
        let p = as_good as f64 / orders as f64;
        Some(Relabelled { p, orders, is_exact, adjusted: p })
    }
}

/// Every order of the first `n` (Heap 1963).
fn each_order(order: &mut [usize], n: usize, of: &mut dyn FnMut(&[usize])) {
    if n <= 1 {
        return of(order);
    }
    for i in 0..n {
        each_order(order, n - 1, of);
        if i + 1 < n {
            order.swap(if n.is_multiple_of(2) { i } else { 0 }, n - 1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isostudy_statistics::Preference;
    use std::collections::BTreeSet;

    #[test]
    fn every_order_comes_once() {
        let mut seen = BTreeSet::new();
        each_order(&mut (0..6).collect::<Vec<_>>(), 6, &mut |order| {
            seen.insert(order.to_vec());
        });
        assert_eq!(seen.len(), 720);
    }

    /// Three methods in a row, and everybody prefers the later of two: of six orders the true one and its opposite go with all.
    #[test]
    fn three_methods_by_hand() {
        let shown = [([0, 1], 0), ([1, 2], 0), ([0, 2], 0)];
        let ballots: Vec<DeclaredBallot> =
            (0..12).map(|i| DeclaredBallot::new(i / 3, i % 3, shown[i % 3].0, Preference::Second)).collect();
        let values = [1.0, 2.0, 4.0];
        let answers = Answers::of(3, &shown, &ballots);
        let found = answers.relabelled(&|[a, b], _| Some(values[a] - values[b])).unwrap();
        assert_eq!((found.orders, found.is_exact), (6, true));
        assert!((found.p - 2.0 / 6.0).abs() < 1e-15, "{found:?}");
        // Values that are all equal go with nothing, whatever their order.
        assert_eq!(answers.relabelled(&|_, _| Some(0.0)).unwrap().p, 1.0);
        // Two methods have no other order.
        assert_eq!(Answers::of(3, &shown[..1], &ballots[..1]).relabelled(&|_, _| Some(1.0)), None);
    }
}
