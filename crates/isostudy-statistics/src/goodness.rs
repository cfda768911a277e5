//! Does a model of worths reproduce the answers? Its deviance, and the answers beside those it expects.

use super::fit::WorthFit;
use super::friedman::ChiSquareTest;
use super::model::Model;
use super::pairs::{Pair, Pairs};

/// What was answered to one pair, and what the model expects.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FittedPair {
    /// Item on the left; of a model without sides, the one with the lower number.
    pub left: usize,
    /// The other item.
    pub right: usize,
    /// Answers for the left item, for neither, for the right.
    pub answers: [f64; 3],
    /// As many answers, shared out as the model has it.
    pub fitted: [f64; 3],
}

/// A model's fit to the answers.
#[derive(Debug, Clone, PartialEq)]
pub struct Goodness {
    /// Twice the log-likelihood that is missing to the saturated model, which has chances of its own for every pair.
    pub deviance: f64,
    /// Free chances of the pairs less parameters of the model.
    pub degrees: usize,
    /// P(chi-square >= deviance), as if all answers were independent; `None` without degrees of freedom. People who differ
    /// from each other make it too small, and so do expected numbers below about 5 doubtful.
    pub p: Option<f64>,
    /// Every compared pair.
    pub pairs: Vec<FittedPair>,
}

/// The deviance of a fitted model, 2 sum n ln(n / expected) over the answers of every pair (Agresti 2013, *Categorical Data
/// Analysis*, sections 4.5 and 11.6), on as many degrees of freedom as the pairs' free chances (two each, or one where
/// nobody ever answered neither) outnumber the parameters.
///
/// A model without a side sees both orders of a pair as one; with a side, estimated or given, each order is a pair of its own.
///
/// `pairs` are those that were fitted. `None` for a penalised fit, and for Bradley and Terry's model where there are ties,
/// which it has no chances for.
pub fn goodness(fit: &WorthFit, pairs: &Pairs) -> Option<Goodness> {
    if fit.penalised() || (fit.model == Model::BradleyTerry && pairs.ties() > 0.0) {
        return None;
    }
    let sides_matter = fit.side.is_some() || fit.given_side != 0.0;
    let named = |pair: &Pair| match sides_matter || pair.left < pair.right {
        true => (pair.left, pair.right, pair.answers),
        false => {
            let [left, tie, right] = pair.answers;
            (pair.right, pair.left, [right, tie, left])
        }
    };
    let cells = Pairs::new(pairs.items, pairs.pairs.iter().map(named));
    let fitted: Vec<FittedPair> = cells.pairs.iter().map(|pair| expected(fit, pair)).collect();
    let free = fitted.len() * if pairs.ties() > 0.0 { 2 } else { 1 };
    let degrees = free - fit.parameters.len();
    let missing = |(n, expected): (f64, f64)| if n > 0.0 { 2.0 * n * (n / expected).ln() } else { 0.0 };
    let of_pair = |pair: &FittedPair| pair.answers.into_iter().zip(pair.fitted).map(missing).sum::<f64>();
    // Saturated, it is zero but for rounding.
    let deviance = fitted.iter().map(of_pair).sum::<f64>().max(0.0);
    let p = (degrees > 0).then(|| ChiSquareTest::new(deviance, degrees as f64).p);
    Some(Goodness { deviance, degrees, p, pairs: fitted })
}

fn expected(fit: &WorthFit, pair: &Pair) -> FittedPair {
    let answers: f64 = pair.answers.iter().sum();
    let fitted = fit.chances(pair.left, pair.right).map(|chance| chance * answers);
    FittedPair { left: pair.left, right: pair.right, answers: pair.answers, fitted }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::large::CEMS;
    use crate::{fit, fit_given_side, golden};
    use isostudy_design::Arrangement;

    fn of(model: Model, pairs: &Pairs) -> Goodness {
        goodness(&fit(model, pairs).unwrap(), pairs).unwrap()
    }

    #[track_caller]
    fn deviance(found: &Goodness, want: f64, degrees: usize, p: f64) {
        assert!((found.deviance - want).abs() < 1e-8, "{found:?}");
        assert_eq!(found.degrees, degrees);
        assert!((found.p.unwrap() / p - 1.0).abs() < 1e-6, "{found:?}");
    }

    #[test]
    fn the_papers_deviances_as_numpy_has_them() {
        // NumPy 2.4.6: 2 * sum(n * log(n / expected)) at the maximum of a Newton climb; SciPy 1.17.1: chi2.sf(deviance, df).
        let study = golden::study();
        let clusterings = |of| Pairs::of(3, &golden::clusterings(&study, of));
        let body_centred = of(Model::Davidson, &clusterings(Some(Arrangement::BodyCentred)));
        deviance(&body_centred, 23.125_918_007_339_422, 3, 3.801_457_634_679_421e-5);
        let simple_cubic = of(Model::Davidson, &clusterings(Some(Arrangement::SimpleCubic)));
        deviance(&simple_cubic, 11.205_114_345_940_903, 3, 0.010_666_908_545_082_612);
        let pooled = of(Model::Davidson, &clusterings(None));
        deviance(&pooled, 31.589_183_356_043_982, 3, 6.387_826_639_150_724e-7);
        let all = of(Model::Davidson, &Pairs::of(6, &golden::ballots(&study)));
        deviance(&all, 50.991_983_985_577_505, 12, 9.345_321_374_631_367e-7);
        // Items U, P, I: the ties sit where the two clusterings meet.
        let last = body_centred.pairs[2];
        assert_eq!((last.left, last.right, last.answers), (1, 2, [15.0, 17.0, 22.0]));
        for (got, want) in
            last.fitted.into_iter().zip([19.123_974_584_265_1, 7.852_819_351_707_2, 27.023_206_064_027_7])
        {
            assert!((got - want).abs() < 1e-6, "{got} is not {want}");
        }
        let smallest = body_centred.pairs.iter().flat_map(|pair| pair.fitted).fold(f64::INFINITY, f64::min);
        assert!((smallest - 5.252_128_416_2).abs() < 1e-6);
    }

    #[test]
    fn residual_deviance_as_r_has_it() {
        // R 4.2.2: deviance(m), df.residual(m) of the glm in `fit::large`.
        deviance(
            &of(Model::Davidson, &Pairs::new(6, CEMS)),
            77.282_243_902_686_77,
            24,
            1.639_021_428_559_405_2e-7,
        );
    }

    #[test]
    fn both_orders_are_one_pair_unless_sides_matter() {
        let orders = Pairs::new(2, [(0, 1, [9., 3., 5.]), (1, 0, [4., 4., 8.])]);
        // Two items are saturated, whichever model; with a side there is one chance to spare.
        let plain = of(Model::Davidson, &orders);
        assert_eq!((plain.degrees, plain.p, plain.pairs[0].answers), (0, None, [17., 7., 9.]));
        assert!(plain.deviance < 1e-12 && of(Model::RaoKupper, &orders).deviance < 1e-12);
        let with_side = of(Model::DavidsonSide, &orders);
        assert_eq!((with_side.degrees, with_side.pairs.len()), (1, 2));
        let given = goodness(&fit_given_side(&orders, 0.0).unwrap(), &orders).unwrap();
        assert_eq!(given, plain);
        // What the side's estimate takes, the given side takes too.
        let estimate = fit(Model::DavidsonSide, &orders).unwrap().side.unwrap();
        let given = goodness(&fit_given_side(&orders, estimate).unwrap(), &orders).unwrap();
        assert!((given.deviance - with_side.deviance).abs() < 1e-12 && given.degrees == 2);
    }

    #[test]
    fn what_has_no_chances_has_no_deviance() {
        let ties = Pairs::new(2, [(0, 1, [9., 3., 5.])]);
        assert_eq!(goodness(&fit(Model::BradleyTerry, &ties).unwrap(), &ties), None);
        let separated = Pairs::new(2, [(0, 1, [9., 0., 0.])]);
        assert_eq!(goodness(&fit(Model::Davidson, &separated).unwrap(), &separated), None);
        // Without a tie each pair has one free chance: three pairs, two worths.
        let decided = Pairs::new(3, [(0, 1, [9., 0., 5.]), (1, 2, [8., 0., 4.]), (0, 2, [7., 0., 6.])]);
        for model in [Model::Davidson, Model::RaoKupper, Model::BradleyTerry] {
            assert_eq!(of(model, &decided).degrees, 1, "{model:?}");
        }
    }
}
