//! Does one participant answer unlike the others?

use statrs::distribution::{ContinuousCDF, StudentsT};

/// Comparable answers below which nobody is judged.
const FEWEST_ANSWERS: u64 = 10;
/// Participants below which nobody is judged.
const FEWEST_PEOPLE: usize = 5;

/// What chance makes of the smallest share is trusted within this factor: shares of a few dozen answers are skewed.
const ALLOWANCE: f64 = 5.0;

/// How often one participant agrees with the others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WithMajority {
    /// The participant.
    pub participant: usize,
    /// Decided answers of questions whose majority among the others is decided.
    pub comparable: u64,
    /// How many of these agree with that majority.
    pub agreeing: u64,
}

/// How far one participant's agreement lies below the others'.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outlying {
    /// The participant.
    pub participant: usize,
    /// Share of comparable answers that agree with the others' majority.
    pub agreement: f64,
    /// One-sided p, times the number of people judged (Bonferroni) and an allowance of 5 for skewness, at most 1; 1 for
    /// whoever agrees on half or more.
    pub p: f64,
}

/// Judges everyone with ten comparable answers or more, least likely first: the share of agreement against mean and
/// standard deviation of the others', as t on m - 2 degrees of freedom (an externally studentised residual; Cook and
/// Weisberg 1982, section 2.2). Empty for fewer than five people.
///
/// Nobody who agrees with the majority on half of the answers or more is outlying, however alike the others are.
pub fn outlying_respondents(screened: &[WithMajority]) -> Vec<Outlying> {
    let judged: Vec<&WithMajority> = screened.iter().filter(|s| s.comparable >= FEWEST_ANSWERS).collect();
    if judged.len() < FEWEST_PEOPLE {
        return Vec::new();
    }
    let all: Vec<f64> = judged.iter().map(|s| s.agreeing as f64 / s.comparable as f64).collect();
    let m = all.len() as f64;
    let (sum, squares) = all.iter().fold((0.0, 0.0), |(sum, squares), x| (sum + x, squares + x * x));
    let t = StudentsT::new(0.0, 1.0, m - 2.0).expect("five people or more");
    let judge = |(s, &agreement): (&&WithMajority, &f64)| {
        let others = (sum - agreement) / (m - 1.0);
        let p = if agreement < 0.5 && agreement < others {
            let rest = squares - agreement * agreement - (m - 1.0) * others * others;
            let variance = (rest / (m - 2.0)).max(0.0);
            let residual = (agreement - others) / (variance * (1.0 + 1.0 / (m - 1.0))).sqrt();
            (ALLOWANCE * m * t.cdf(residual)).min(1.0)
        } else {
            1.0
        };
        Outlying { participant: s.participant, agreement, p }
    };
    let mut found: Vec<Outlying> = judged.iter().zip(&all).map(judge).collect();
    found.sort_by(|a, b| a.p.total_cmp(&b.p).then(a.participant.cmp(&b.participant)));
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Screening, golden, screening};

    #[test]
    fn the_papers_respondent_sixteen() {
        let study = golden::study();
        let outlying = outlying_respondents(
            &screening(&golden::ballots(&study)).iter().map(Screening::with_majority).collect::<Vec<_>>(),
        );
        assert_eq!((outlying.len(), outlying[0].participant), (18, 15));
        assert!(outlying[0].p < 0.01 && outlying[1].p == 1.0, "{outlying:?}");
    }

    #[test]
    fn as_scipy_has_it() {
        // NumPy and SciPy 1.17.1: x = .2 against o = (.9, .75, .85, .8):
        // 5 * 5 * t.cdf((x - o.mean()) / (o.std(ddof=1) * sqrt(5 / 4)), 3).
        let seen = |(participant, agreeing)| WithMajority { participant, agreeing, comparable: 20 };
        let all: Vec<WithMajority> = [18, 15, 17, 16, 4].into_iter().enumerate().map(seen).collect();
        let outlying = outlying_respondents(&all);
        assert_eq!((outlying[0].participant, outlying[0].agreement), (4, 0.2));
        assert!((outlying[0].p - 0.040_487_963_456_805_2).abs() < 1e-12, "{outlying:?}");
        assert!(outlying[1..].iter().all(|o| o.p == 1.0));
        assert!(outlying_respondents(&all[..4]).is_empty());
    }
}
