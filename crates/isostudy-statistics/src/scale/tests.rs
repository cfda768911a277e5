use super::*;
use crate::simulation::{Plan, Population, simulate, stream};
use crate::{Outcome, ShownBallot, golden};

/// The paper's answers about all six methods, numbered su, bu, sp, bp, bi, si.
fn six() -> Vec<ShownBallot> {
    let order = ["su", "bu", "sp", "bp", "bi", "si"];
    let study = golden::study();
    let methods = study.method_ids();
    let item = |of: usize| order.iter().position(|&method| method == methods[of].as_str()).unwrap();
    golden::ballots(&study).iter().map(|b| b.with_items([item(b.left()), item(b.right())])).collect()
}

#[track_caller]
fn close(got: f64, want: f64, tolerance: f64) {
    assert!((got - want).abs() < tolerance, "{got} is not {want}");
}

#[test]
fn six_methods_on_one_scale() {
    // R 4.2.2, sandwich 3.0-2: g <- glm(y ~ factor(answer) + X + tie - 1, poisson), X half credits; coef(g);
    // vcovCL(g, cluster = participant, type = "HC0", cadjust = TRUE). NumPy 2.4.6 and SciPy 1.17.1 for p = 2 t.sf(., 17).
    let found = scale(&Participants::of(6, &six()), 0).unwrap();
    let worths = [
        0.667_272_241_596_98,
        0.980_114_621_705_965,
        1.900_791_984_474_239,
        2.427_736_653_265_639,
        2.770_219_167_450_648,
    ];
    let errors = [
        0.300_564_628_862_847,
        0.566_245_218_278_727,
        0.489_724_006_119_358,
        0.640_634_244_976_116,
        0.694_365_269_733_348,
    ];
    let p = [
        0.040_299_785_540_994,
        0.101_577_417_357_762,
        0.001_199_242_986_143,
        0.001_463_574_741_617,
        0.000_948_398_736_816,
    ];
    for i in 0..5 {
        let position = found.positions[i + 1];
        let spread = position.spread.unwrap();
        close(position.log_odds, worths[i], 1e-9);
        close(spread.se, errors[i], 1e-9);
        close(spread.p, p[i], 1e-9);
    }
    close(found.fit.log_likelihood, -387.249_523_922_983_8, 1e-8);
    let (jods, chances) = (found.positions[5].jod(), found.positions[5].preferred());
    close(jods, 2.770_219_167_450_648 / 1.098_612_288_668_11, 1e-12);
    close(chances, 1.0 / (1.0 + (-2.770_219_167_450_648_f64).exp()), 1e-12);
    // si less bi, neither of which is the reference: (4, 5) is bi less si.
    let last = found.differences[14];
    let spread = last.spread.unwrap();
    assert_eq!((last.first, last.second, found.differences.len()), (4, 5, 15));
    close(last.log_odds, -0.342_482_514_185_009_2, 1e-9);
    close(spread.interval.low, -0.694_766_413_085_301_3, 1e-8);
    close(spread.interval.high, 0.009_801_384_715_282_913, 1e-8);
    close(spread.p, 0.055_994_935_301_145_94, 1e-9);
    // Holm over 15: the smallest p, si - sp, times 15; si - bi is the 13th, times 3.
    let smallest = found.differences.iter().find(|d| (d.first, d.second) == (2, 5)).unwrap();
    close(smallest.spread.unwrap().adjusted, 15.0 * 7.707_914_771_503_72e-5, 1e-9);
    close(spread.adjusted, 3.0 * 0.055_994_935_301_145_94, 1e-8);
    // W = w' solve(V, w) = 37.5843744; pf(W * 13 / (5 * 17), 5, 13, lower.tail = FALSE).
    let omnibus = found.omnibus.unwrap();
    assert_eq!(omnibus.degrees, [5, 13]);
    close(omnibus.f, 5.748_198_442_745_053, 1e-7);
    close(omnibus.p, 0.005_154_432_896_546_601, 1e-9);
}

#[test]
fn the_reference_and_the_order_of_items_change_nothing_else() {
    let ballots = six();
    let found = scale(&Participants::of(6, &ballots), 0).unwrap();
    let other = scale(&Participants::of(6, &ballots), 4).unwrap();
    assert_eq!((&found.differences, found.omnibus), (&other.differences, other.omnibus));
    assert_eq!(other.positions[4], Difference { first: 4, second: 4, log_odds: 0.0, spread: None });
    assert_eq!(other.positions[5].log_odds, -found.differences[14].log_odds);
    let turned: Vec<ShownBallot> =
        ballots.iter().map(|b| b.with_items([5 - b.left(), 5 - b.right()])).collect();
    let turned = scale(&Participants::of(6, &turned), 5).unwrap();
    for (a, b) in found.positions.iter().zip(turned.positions.iter().rev()) {
        close(a.log_odds, b.log_odds, 1e-9);
        if let (Some(a), Some(b)) = (a.spread, b.spread) {
            close(a.se, b.se, 1e-9);
            close(a.adjusted, b.adjusted, 1e-9);
        }
    }
    close(found.omnibus.unwrap().p, turned.omnibus.unwrap().p, 1e-9);
}

#[test]
fn three_in_four_is_one_jod() {
    close(jod(3.0_f64.ln()), 1.0, 1e-15);
    close(preferred(3.0_f64.ln()), 0.75, 1e-15);
    assert_eq!((jod(0.0), preferred(0.0)), (0.0, 0.5));
}

#[test]
fn what_cannot_be_tested_says_why() {
    let plan = Plan::round_robin(4, 3);
    let few = simulate(&plan, &Population::indifferent(4, 0.5), 3, &mut stream(1, 0));
    let found = scale(&Participants::of(4, &few), 0).unwrap();
    assert_eq!(found.omnibus, Err(NoOmnibus::Participants { participants: 3, items: 4 }));
    assert!(found.differences.iter().all(|d| d.spread.is_some()));
    let answer = |p, left, right, outcome| ShownBallot::new(p, 0, [left, right], outcome);
    let separated: Vec<ShownBallot> = (0..9).map(|p| answer(p, 0, 1, Outcome::Left)).collect();
    let found = scale(&Participants::of(2, &separated), 0).unwrap();
    assert_eq!((found.omnibus, found.differences[0].spread), (Err(NoOmnibus::Separated), None));
    // Everybody answers both ways alike: nobody differs from anybody.
    let alike = (0..9).flat_map(|p| [answer(p, 0, 1, Outcome::Left), answer(p, 0, 1, Outcome::Right)]);
    let found = scale(&Participants::of(2, &alike.collect::<Vec<_>>()), 0).unwrap();
    assert_eq!((found.omnibus, found.differences[0].spread), (Err(NoOmnibus::NoSpread), None));
    let apart = [answer(0, 0, 1, Outcome::Left), answer(0, 2, 3, Outcome::Left)];
    assert_eq!(scale(&Participants::of(4, &apart), 0), Err(FitError::Disconnected));
}

#[test]
fn a_liking_for_a_side_does_not_make_differences_small() {
    // Nobody differs from anybody, so that nothing else makes them small.
    let plan = Plan::round_robin(3, 4);
    let population = Population { worths: vec![0.0, 0.5, 1.0], side: 2.5, ..Population::indifferent(3, 0.0) };
    let participants = Participants::of(3, &simulate(&plan, &population, 2000, &mut stream(9, 0)));
    let found = scale(&participants, 0).unwrap();
    assert_eq!(found.fit.model, Model::DavidsonSide);
    for (position, worth) in found.positions.iter().zip([0.0, 0.5, 1.0]) {
        close(position.log_odds, worth, 0.05);
    }
    let plain = fit(Model::Davidson, &participants.sum(&participants.counts)).unwrap();
    assert!(plain.log_worths[2] < 0.6, "{:?}", plain.log_worths);
    // Sides as listed tell no side.
    let listed = Plan { counterbalanced: false, ..plan };
    let participants = Participants::of(3, &simulate(&listed, &population, 50, &mut stream(9, 0)));
    assert_eq!(scale(&participants, 0).unwrap().fit.model, Model::Davidson);
}
