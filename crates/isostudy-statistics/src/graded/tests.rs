use super::*;
use crate::{Model, ShownBallot, fit, golden};

#[track_caller]
fn close(got: f64, want: f64, by: f64) {
    assert!((got - want).abs() < by * want.abs().max(1.0), "{got} instead of {want}");
}

/// Twelve people about the six pairs of four items, in five steps, by a formula that R computes too: later items are better, every
/// other person sees sides exchanged, and every third likes the left.
fn five_steps() -> Vec<GradedBallot> {
    let mut ballots = Vec::new();
    for p in 0..12_usize {
        for (i, j) in [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)] {
            let (i, j): (usize, usize) = (i, j);
            let z = (p * 31 + i * 17 + j * 13 + p * i * 7 + p * j * 5) % 10 + 3 * (j - i);
            let mut step: i8 = match z {
                0..4 => 2,
                4..6 => 1,
                6..8 => 0,
                8..12 => -1,
                _ => -2,
            };
            let mut sides = [i, j];
            if p % 2 == 1 {
                (step, sides) = (-step, [j, i]);
            }
            if p % 3 == 0 {
                step = (step + 1).min(2);
            }
            ballots.push(GradedBallot { participant: p, left: sides[0], right: sides[1], step });
        }
    }
    ballots
}

#[test]
fn adjacent_categories_as_r_has_them() {
    // R 4.2.2: glm(y ~ X + t0 + t2 + side + factor(id) - 1, poisson) with a row per answer and step o, X half of o for the item on the
    // left less that on the right, t0 and t2 for steps of that size, side o / 2; vcovCL(m, cluster = p, type = "HC0", cadjust = TRUE).
    let found = graded(Link::Adjacent, 4, &five_steps()).unwrap();
    let worths = [1.518_983_022_431, 3.068_037_056_214, 3.870_304_665_245];
    let errors = [0.336_619_048_793, 0.606_415_828_294, 0.684_402_024_689];
    for item in 1..4 {
        close(found.log_worths[item], worths[item - 1], 1e-9);
        // R takes the weights of its last step but one.
        close(found.difference(item, 0).unwrap().se, errors[item - 1], 1e-7);
    }
    assert_eq!(found.steps.iter().map(|(size, _)| *size).collect::<Vec<_>>(), [0, 2]);
    close(found.steps[0].1, 0.881_550_212_803, 1e-9);
    close(found.steps[1].1, -0.922_922_038_574, 1e-9);
    close(found.side.unwrap(), 0.785_717_419_112, 1e-9);
    close(found.covariance[5][5].sqrt(), 0.295_430_058_549, 1e-6);
    close(found.log_likelihood, -83.765_687_745_8, 1e-10);
    let difference = found.difference(2, 1).unwrap();
    close(difference.estimate, 1.549_054_033_783, 1e-9);
    close(difference.se, 0.684_842_307_052, 1e-7);
    assert_eq!(found.participants, 12);
}

#[test]
fn cumulative_links_as_r_has_them() {
    // R 4.2.2, ordinal 2022.11-16: clm(Y ~ x1 + x2 + x3, threshold = "symmetric"), x the item on the left less that on the right;
    // side -(central.1 + central.2) / 2, first cut (central.2 - central.1) / 2, second that + spacing.1.
    let found = graded(Link::Cumulative, 4, &five_steps()).unwrap();
    let worths = [1.162_748_200_03, 2.717_667_734_58, 3.265_000_581_18];
    let errors = [0.414_644_448_464, 0.500_997_510_853, 0.526_989_889_183];
    for item in 1..4 {
        close(found.log_worths[item], worths[item - 1], 1e-7);
        close(found.covariance[item - 1][item - 1].sqrt(), errors[item - 1], 1e-6);
    }
    close(found.side.unwrap(), (1.694_330_822_23 - 0.286_269_798_55) / 2.0, 1e-7);
    let first = (1.694_330_822_23 + 0.286_269_798_55) / 2.0;
    assert_eq!(found.steps.iter().map(|(size, _)| *size).collect::<Vec<_>>(), [1, 2]);
    close(found.steps[0].1, first, 1e-7);
    close(found.steps[1].1, first + 1.460_699_409_75, 1e-7);
    close(found.log_likelihood, -83.829_920_727_4, 1e-10);
}

/// The same answers as steps.
fn steps(ballots: &[ShownBallot]) -> Vec<GradedBallot> {
    let step = |b: &ShownBallot| GradedBallot {
        participant: b.participant(),
        left: b.left(),
        right: b.right(),
        step: b.outcome().sign() as i8,
    };
    ballots.iter().map(step).collect()
}

#[test]
fn three_steps_are_davidsons_and_rao_and_kuppers_models() {
    let ballots = golden::clusterings(&golden::study(), None);
    for (link, model) in [(Link::Adjacent, Model::Davidson), (Link::Cumulative, Model::RaoKupper)] {
        let want = fit(model, &Pairs::of(3, &ballots)).unwrap();
        let got = graded(link, 3, &steps(&ballots)).unwrap();
        (0..3).for_each(|item| close(got.log_worths[item], want.log_worths[item], 1e-9));
        close(got.steps[0].1, want.ln_nu.or(want.ln_theta).unwrap(), 1e-8);
        close(got.log_likelihood, want.log_likelihood, 1e-11);
        for i in 0..3 {
            (0..3).for_each(|j| close(got.covariance[i][j], want.covariance[i][j], 1e-8));
        }
    }
}

/// Seven baseball teams in 1987, home and away (Agresti 2002, *Categorical Data Analysis*, section 10.6; `baseball` of the R package
/// BradleyTerry2): wins of the home team and of the other, Milwaukee, Detroit, Toronto, New York, Boston, Cleveland and Baltimore at home
/// to the others in this order.
const BASEBALL: [[[usize; 2]; 6]; 7] = [
    [[4, 3], [4, 2], [4, 3], [6, 1], [4, 2], [6, 0]],
    [[3, 3], [4, 2], [4, 3], [6, 0], [6, 1], [4, 3]],
    [[2, 5], [4, 3], [2, 4], [4, 3], [4, 2], [6, 0]],
    [[3, 3], [5, 1], [2, 5], [4, 3], [4, 2], [6, 1]],
    [[5, 1], [2, 5], [3, 3], [4, 2], [5, 2], [6, 0]],
    [[2, 5], [3, 3], [3, 4], [4, 3], [4, 2], [2, 4]],
    [[2, 5], [1, 5], [1, 6], [2, 4], [1, 6], [3, 4]],
];

#[test]
fn forced_choice_is_bradley_and_terrys_model_as_r_has_it() {
    // R 4.2.2, BradleyTerry2 1.1-2: BTm(cbind(home.wins, away.wins), home.team, away.team, ~ team + at.home, id = "team"), Baltimore 0.
    // Baltimore is item 0 here, and the others follow in the order above.
    let item = |place: usize| (place + 1) % 7;
    let mut ballots = Vec::new();
    for (home, rows) in BASEBALL.iter().enumerate() {
        for (away, wins) in (0..7).filter(|&away| away != home).zip(rows) {
            for (step, &times) in [1, -1].into_iter().zip(wins) {
                let one = GradedBallot { participant: 0, left: item(home), right: item(away), step };
                ballots.extend(std::iter::repeat_n(one, times));
            }
        }
    }
    ballots.iter_mut().enumerate().for_each(|(game, ballot)| ballot.participant = game);
    let worths = [
        1.619_554_993_578,
        1.475_357_213_586,
        1.327_110_398_072,
        1.281_340_403_276,
        1.143_802_653_297,
        0.704_694_456_900,
    ];
    for link in [Link::Adjacent, Link::Cumulative] {
        let found = graded(link, 7, &ballots).unwrap();
        worths.into_iter().zip(&found.log_worths[1..]).for_each(|(want, &got)| close(got, want, 1e-8));
        close(found.side.unwrap(), 0.302_260_655_528, 1e-8);
        close(found.covariance[0][0].sqrt(), 0.347_365_306_113, 1e-6);
        close(found.covariance[6][6].sqrt(), 0.130_943_642_532, 1e-6);
        assert!(found.steps.is_empty());
    }
}

#[test]
fn steps_that_nobody_gave_and_the_order_of_answers_change_nothing() {
    let mut ballots = five_steps();
    let want = graded(Link::Adjacent, 4, &ballots).unwrap();
    ballots.reverse();
    assert_eq!(graded(Link::Adjacent, 4, &ballots).unwrap(), want);
    // Steps of 2 as steps of 7: to the second link, which knows only their order, they are the same.
    let wide = |b: &GradedBallot| GradedBallot {
        step: if b.step.abs() == 2 { b.step / 2 * 7 } else { b.step },
        ..*b
    };
    let wider: Vec<GradedBallot> = ballots.iter().map(wide).collect();
    let [one, other] = [&ballots, &wider].map(|of| graded(Link::Cumulative, 4, of).unwrap());
    assert_eq!(one.log_worths, other.log_worths);
    assert!(graded(Link::Adjacent, 4, &wider).unwrap().log_worths[3] < want.log_worths[3]);
}

#[test]
fn what_has_no_estimate_says_so() {
    let of = |step| GradedBallot { participant: 0, left: 0, right: 1, step };
    for link in [Link::Adjacent, Link::Cumulative] {
        let says = |items: usize, ballots: &[GradedBallot]| graded(link, items, ballots).map(|_| ());
        assert_eq!(says(2, &[]), Err(FitError::Nothing));
        assert_eq!(says(2, &[of(0), of(0)]), Err(FitError::OnlyTies));
        assert_eq!(says(2, &[of(2), of(1)]), Err(FitError::NoMaximum));
        assert_eq!(says(3, &[of(2), of(-1)]), Err(FitError::Disconnected));
        assert_eq!(says(2, &[of(2), of(-1)]), Ok(()));
    }
}
