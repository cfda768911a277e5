//! Many answers: near the maximum the gain that is left is below the last place of the log-likelihood.

use super::*;
use crate::ShownBallot;
use crate::simulation::{Plan, Population, simulate, stream};

/// Answers of 303 students, by pair `(first, second, [first, neither, second])`; schools Barcelona, London, Milano, Paris,
/// St. Gallen, Stockholm. Dittrich, Hatzinger and Katzenbeisser (1998, Appl. Statist. 47:511); data set `CEMS` of the R
/// package BradleyTerry2 1.1-2, added up by `aggregate(cbind(win1, win2, tied) ~ school1 + school2, CEMS$preferences, sum)`.
pub(crate) const CEMS: [(usize, usize, [f64; 3]); 15] = [
    (1, 0, [217., 19., 67.]),
    (2, 0, [104., 67., 132.]),
    (3, 0, [157., 37., 109.]),
    (4, 0, [144., 25., 134.]),
    (1, 2, [221., 26., 56.]),
    (3, 2, [121., 32., 59.]),
    (1, 3, [186., 26., 91.]),
    (1, 4, [208., 22., 73.]),
    (2, 4, [135., 28., 140.]),
    (3, 4, [165., 19., 119.]),
    (0, 5, [172., 41., 90.]),
    (1, 5, [250., 19., 34.]),
    (2, 5, [157., 46., 100.]),
    (3, 5, [203., 30., 70.]),
    (4, 5, [155., 50., 98.]),
];

/// Every order of `items` items.
fn orders(items: usize) -> Vec<Vec<usize>> {
    if items == 0 {
        return vec![Vec::new()];
    }
    let with_last = |order: Vec<usize>| {
        (0..items).map(move |place| {
            let mut longer = order.clone();
            longer.insert(place, items - 1);
            longer
        })
    };
    orders(items - 1).into_iter().flat_map(with_last).collect()
}

/// Fits with items named in every order: nothing may be called separated, and the estimates are the same to 1e-9.
#[track_caller]
fn same_in_every_order(model: Model, items: usize, pairs: &Pairs) -> WorthFit {
    let straight = fit(model, pairs).unwrap();
    for order in orders(items) {
        let renamed = pairs.pairs.iter().map(|p| (order[p.left], order[p.right], p.answers));
        let found = fit(model, &Pairs::new(items, renamed)).unwrap();
        assert_eq!(found.penalty, Penalty::None, "{model:?} {order:?}");
        let worth = |item: usize| found.log_worths[order[item]] - found.log_worths[order[0]];
        let apart = (0..items).map(|i| (worth(i) - straight.log_worths[i]).abs()).fold(0.0, f64::max);
        assert!(apart < 1e-9, "{model:?} {order:?}: {apart}");
        let error = found.standard_error(&found.covariance, order[items - 1], order[0]);
        let same = straight.standard_error(&straight.covariance, items - 1, 0);
        assert!((error - same).abs() < 1e-9 * same, "{model:?} {order:?}");
    }
    straight
}

#[test]
fn six_schools_in_all_orders_as_gnm_has_them() {
    let pairs = Pairs::new(6, CEMS);
    // R 4.2.2: glm(y ~ X + tie + pair - 1, family = poisson, control = glm.control(epsilon = 1e-16)), one row a pair and
    // outcome, X half credits; sum(y * log(fitted / n)).
    let fitted = same_in_every_order(Model::Davidson, 6, &pairs);
    let want = [
        1.209_869_512_523_161,
        -0.170_960_307_274_685,
        0.419_601_395_592_177_6,
        -0.014_610_376_044_470_66,
        -0.612_932_464_151_091_9,
    ];
    for (got, want) in fitted.log_worths[1..].iter().zip(want) {
        assert!((got - want).abs() < 1e-9, "{got} {want}");
    }
    assert!((fitted.log_likelihood + 3_964.378_119_544_812).abs() < 1e-9, "{}", fitted.log_likelihood);
    for model in [Model::RaoKupper, Model::BradleyTerry] {
        same_in_every_order(model, 6, &pairs);
    }
}

#[test]
fn thousands_and_millions_of_each_answer() {
    // The same shares of ever more answers have the same maximum.
    let one = fit(Model::Davidson, &Pairs::new(6, CEMS)).unwrap();
    for times in [7.0, 1e3, 1e6, 1e9] {
        let many = Pairs::new(6, CEMS.map(|(i, j, answers)| (i, j, answers.map(|n| n * times))));
        for model in [Model::Davidson, Model::RaoKupper, Model::BradleyTerry] {
            let fitted = fit(model, &many).unwrap();
            assert_eq!(fitted.penalty, Penalty::None, "{model:?} {times}");
            if model == Model::Davidson {
                let apart = fitted.parameters.iter().zip(&one.parameters).map(|(a, b)| (a - b).abs());
                assert!(apart.fold(0.0, f64::max) < 1e-9, "{times}");
            }
        }
    }
}

#[test]
fn ten_thousand_respondents_in_all_orders() {
    let worths = vec![0.2, 1.4, 1.0, -0.2, 1.0, 0.6];
    let plan = Plan::round_robin(6, 1);
    for side in [0.0, 0.4] {
        let population = Population { worths: worths.clone(), side, ..Population::indifferent(6, 0.8) };
        let ballots: Vec<ShownBallot> = simulate(&plan, &population, 10_000, &mut stream(3, 0));
        let pairs = Pairs::of(6, &ballots);
        for model in Model::ALL {
            same_in_every_order(model, 6, &pairs);
        }
    }
}

#[test]
fn one_answer_against_millions_is_an_estimate() {
    // Two items in closed form: ln(1e9), and a chain of such steps, farther than any bound on log-odds.
    let steep = [1e9, 0.0, 1.0];
    let chain = Pairs::new(4, [(0, 1, steep), (1, 2, steep), (2, 3, steep)]);
    for model in [Model::Davidson, Model::RaoKupper, Model::BradleyTerry] {
        let fitted = fit(model, &chain).unwrap();
        assert_eq!(fitted.penalty, Penalty::None);
        assert!((-fitted.log_worths[3] - 3.0 * 1e9_f64.ln()).abs() < 1e-8, "{model:?} {fitted:?}");
    }
}
