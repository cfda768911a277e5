use super::*;
use crate::{Outcome, Participants, ShownBallot, Side, clustered_covariance, golden};
use proptest::prelude::*;

#[track_caller]
fn close(got: f64, want: f64, tolerance: f64) {
    assert!((got - want).abs() < tolerance, "{got} is not {want}");
}

/// Three items, every pair in both orders.
fn both_orders() -> Pairs {
    let counts = [
        (0, 1, [9., 3., 5.]),
        (1, 0, [4., 4., 8.]),
        (0, 2, [12., 2., 4.]),
        (2, 0, [3., 3., 10.]),
        (1, 2, [8., 5., 6.]),
        (2, 1, [5., 2., 9.]),
    ];
    Pairs::new(3, counts)
}

#[track_caller]
fn check(fit: &WorthFit, estimates: &[f64], errors: &[f64], log_likelihood: f64) {
    fit.parameters.iter().zip(estimates).for_each(|(got, want)| close(*got, *want, 1e-10));
    errors.iter().enumerate().for_each(|(i, want)| close(fit.covariance[i][i].sqrt(), *want, 1e-8));
    close(fit.log_likelihood, log_likelihood, 1e-9);
    assert_eq!((fit.parameters.len(), fit.penalty), (estimates.len(), Penalty::None));
}

#[test]
fn davidson_as_a_poisson_regression_in_r() {
    // R 4.2.2: glm(n ~ match + X + t + s, family = poisson), one nuisance a pair; X the worths' half credits, t the tie,
    // s = 1/2, 0, -1/2 the side. gnm 1.1-2 with GenDavidson gives the same: home.adv -0.07315209523281066,
    // tie.max -1.39632341764234291 = ln(nu / 2).
    let side = fit(Model::DavidsonSide, &both_orders()).unwrap();
    check(
        &side,
        &[-0.665_524_300_511_539_4, -1.145_019_375_032_576, -0.703_176_237_082_398, -0.073_152_095_232_810_5],
        &[0.332_563_655_448_696_9, 0.345_508_673_519_588_7, 0.258_275_911_078_007_5, 0.234_269_135_288_211_2],
        -100.433_285_994_610_5,
    );
    close(side.ln_nu.unwrap() - 2.0_f64.ln(), -1.396_323_417_642_343, 1e-10);
    let plain = fit(Model::Davidson, &both_orders()).unwrap();
    check(
        &plain,
        &[-0.664_015_842_451_607_2, -1.138_013_569_877_277, -0.703_843_663_054_271_2],
        &[0.332_353_160_089_016_6, 0.344_320_968_662_006_1, 0.258_240_863_685_804_3],
        -100.482_109_857_987_8,
    );
}

#[test]
fn davidson_as_psychotools_has_it() {
    // R, psychotools 0.7-2: btmodel(paircomp(answers, labels = c("U", "P", "I"), mscale = -1:1), ref = "U", undecided = TRUE)
    let study = golden::study();
    let fit = fit(Model::Davidson, &Pairs::of(3, &golden::clusterings(&study, None))).unwrap();
    let want = [(1.081_960_316_899_948, 0.198_009_574), (2.137_880_081_239_614, 0.228_184_016)];
    for (i, (estimate, error)) in want.into_iter().enumerate() {
        close(fit.log_worths[i + 1], estimate, 1e-8);
        close(fit.covariance[i][i].sqrt(), error, 1e-6);
    }
    close(fit.ln_nu.unwrap(), -1.462_395_353_930_313, 1e-8);
    close(fit.log_likelihood, -238.098_689_966_514_1, 1e-9);
}

#[test]
fn ties_can_hold_an_item_that_never_lost() {
    // The same regression in R converges: no separation, although item 0 never lost.
    let held = Pairs::new(3, [(0, 1, [6., 3., 0.]), (0, 2, [5., 4., 0.]), (1, 2, [4., 2., 3.])]);
    let fit = fit(Model::Davidson, &held).unwrap();
    check(
        &fit,
        &[-2.465_001_512_417_430_7, -2.615_513_770_721_105, 0.421_658_914_996_931_5],
        &[1.009_006_844_679_951, 1.031_307_961_436_057],
        -23.795_947_188_722_64,
    );
}

#[test]
fn bradley_terry_as_bradley_terry_2_has_it() {
    // R, BradleyTerry2 1.1-2: BTm(cbind(w1, w2), p1, p2), ties as half a win each.
    let fit = fit(Model::BradleyTerry, &both_orders()).unwrap();
    check(
        &fit,
        &[-0.529_783_465_923_214_3, -0.908_091_803_613_091_6],
        &[0.294_712_264_034_842, 0.301_651_073_120_763_1],
        -65.793_671_347_438_94,
    );
    assert_eq!((fit.ln_nu, fit.ln_theta, fit.side), (None, None, None));
}

#[test]
fn without_ties_every_model_is_what_choix_has() {
    // PyPI choix 0.4.1: mm_pairwise(3, decided answers, alpha=0, tol=1e-14), less the first.
    let mut decided = both_orders();
    decided.pairs.iter_mut().for_each(|pair| pair.answers[1] = 0.0);
    for model in [Model::Davidson, Model::RaoKupper, Model::BradleyTerry] {
        let fit = fit(model, &decided).unwrap();
        close(fit.log_worths[1], -0.660_795_805_670_238_2, 1e-10);
        close(fit.log_worths[2], -1.117_939_393_056_340_4, 1e-10);
    }
}

#[test]
fn rao_kupper_as_a_direct_maximum_in_r() {
    // R: nlminb on the log-likelihood written out with plogis, the study's clustering answers, items U, P, I.
    let study = golden::study();
    let fit = fit(Model::RaoKupper, &Pairs::of(3, &golden::clusterings(&study, None))).unwrap();
    close(fit.log_worths[1], 1.093_311_447_480_199, 1e-6);
    close(fit.log_worths[2], 1.973_583_048_715_374, 1e-6);
    close(fit.ln_theta.unwrap(), 0.246_849_727_862_148_5, 1e-6);
    close(fit.log_likelihood, -236.455_320_585_920_2, 1e-9);
}

#[test]
fn numbers_that_are_far_apart_do_not_hide_a_maximum() {
    // Sums of 10^8 whose difference is 4 * 10^4: the log-likelihood's rounding hides that a step gains. Python, mpmath 1.4.1 with
    // 40 digits: findroot of the gradient written out with 1 / (1 + exp(-z)), from (-1.5, -1.2, 8), and the log-likelihood
    // there; SciPy 1.17.1's optimize.root(gradient, [-1.5, -1.2, 8]) finds the same to 1e-12.
    let answers = [
        [2e3, 0.0, 3.0],
        [1e2, 5e5, 0.0],
        [8e2, 2e2, 2e3],
        [0.0, 5e2, 3.0],
        [1.0, 4.0, 0.0],
        [0.0, 6e6, 0.0],
    ];
    let fit = fit(Model::RaoKupper, &pairs_of(&answers, [0, 1, 2])).unwrap();
    assert_eq!(fit.penalty, Penalty::None);
    close(fit.log_worths[1], -1.493_532_906_598_190_9, 1e-10);
    close(fit.log_worths[2], -1.195_033_440_885_634, 1e-10);
    close(fit.ln_theta.unwrap(), 8.017_669_426_300_584, 1e-10);
    close(fit.log_likelihood, -42_847.832_141_253_82, 1e-6);
}

#[test]
fn two_items_in_closed_form() {
    // Davidson ln(36/10) = 1.2809, nu = 8 / sqrt(360) = 0.4216; Rao-Kupper, whose odds of winning are P / (1 - P):
    // ln(36 * 44 / (10 * 18)) / 2 = 1.0874, theta = sqrt(18 * 44 / (36 * 10)) = 1.4832.
    let pairs = Pairs::new(2, [(0, 1, [36., 8., 10.])]);
    let davidson = fit(Model::Davidson, &pairs).unwrap();
    close(-davidson.log_worths[1], 1.280_933_845_462_064, 1e-12);
    close(davidson.ln_nu.unwrap().exp(), 0.421_637_021_355_783_9, 1e-12);
    let threshold = fit(Model::RaoKupper, &pairs).unwrap();
    close(-threshold.log_worths[1], 1.087_375_860_742_08, 1e-12);
    close(threshold.ln_theta.unwrap().exp(), 1.483_239_697_419_133, 1e-12);
}

#[test]
fn a_given_side_is_the_estimated_one_where_it_is_the_same() {
    let estimated = fit(Model::DavidsonSide, &both_orders()).unwrap();
    let given = fit_given_side(&both_orders(), estimated.side.unwrap()).unwrap();
    assert_eq!((given.side, given.given_side), (None, estimated.side.unwrap()));
    close(given.log_likelihood, estimated.log_likelihood, 1e-12);
    given.log_worths.iter().zip(&estimated.log_worths).for_each(|(a, b)| close(*a, *b, 1e-12));
    for (left, right) in ORDERED {
        let chances = given.chances(left, right);
        close(chances.iter().sum::<f64>(), 1.0, 1e-15);
        (0..3).for_each(|o| close(chances[o], estimated.chances(left, right)[o], 1e-12));
    }
    // Rao and Kupper's of two items: the observed shares (36, 8, 10 of 54).
    let two = fit(Model::RaoKupper, &Pairs::new(2, [(0, 1, [36., 8., 10.])])).unwrap();
    two.chances(0, 1).into_iter().zip([36., 8., 10.]).for_each(|(p, n)| close(p, n / 54.0, 1e-12));
}

#[test]
fn what_cannot_be_answered_says_why() {
    let two = |answers| Pairs::new(2, [(0, 1, answers)]);
    assert_eq!(fit(Model::Davidson, &two([0., 0., 0.])), Err(FitError::Nothing));
    assert_eq!(fit(Model::Davidson, &two([0., 7., 0.])), Err(FitError::OnlyTies));
    assert_eq!(fit(Model::Davidson, &Pairs::new(3, [(0, 1, [4., 1., 3.])])), Err(FitError::Disconnected));
    let confounded = fit(Model::DavidsonSide, &two([36., 8., 10.])).unwrap_err();
    assert!(
        confounded.to_string().starts_with("not answerable here, because no pair was shown in both orders")
    );
}

#[test]
fn separated_answers_get_half_a_win_each_way() {
    let two = [0, 1].map(|participant| ShownBallot::new(participant, 0, [0, 1], Outcome::Left));
    for model in [Model::Davidson, Model::RaoKupper, Model::BradleyTerry] {
        let fit = fit(model, &Pairs::new(2, [(0, 1, [7., 0., 0.])])).unwrap();
        assert_eq!(fit.penalty, Penalty::ItemsSeparated, "{model:?}");
        // No tie: all three are ln(7.5 / 0.5), and the answers themselves have probability (15/16)^7.
        close(-fit.log_worths[1], 15.0_f64.ln(), 1e-12);
        close(fit.log_likelihood, 7.0 * (15.0_f64 / 16.0).ln(), 1e-12);
        assert_eq!(clustered_covariance(&fit, &Participants::of(2, &two)), None);
    }
    let tied = fit(Model::Davidson, &Pairs::new(2, [(0, 1, [7., 2., 0.])])).unwrap();
    close(-tied.log_worths[1], 15.0_f64.ln(), 1e-12);
    close(tied.ln_nu.unwrap(), (2.0 / (7.5_f64 * 0.5).sqrt()).ln(), 1e-12);
    // A tie is half a win for both, so Bradley-Terry needs no penalty: 8 to 1.
    let halves = fit(Model::BradleyTerry, &Pairs::new(2, [(0, 1, [7., 2., 0.])])).unwrap();
    assert!(!halves.penalised());
    close(-halves.log_worths[1], 8.0_f64.ln(), 1e-12);
}

#[test]
fn a_side_without_bound_is_not_an_item_that_never_won() {
    // Everybody takes the left, and each item wins half of its showings.
    let left = ORDERED.map(|(l, r)| (l, r, [6.0, 0.0, 0.0]));
    let pairs = Pairs::new(3, left);
    let with_side = fit(Model::DavidsonSide, &pairs).unwrap();
    assert_eq!((with_side.penalty, side_separation(&pairs)), (Penalty::SideSeparated, Some(Side::Left)));
    let plain = fit(Model::Davidson, &pairs).unwrap();
    assert_eq!(plain.penalty, Penalty::None);
    assert!(plain.log_worths.iter().all(|worth| worth.abs() < 1e-12), "{plain:?}");
    // One answer to the right can be the item's doing. With one in both orders of a pair the side has an estimate.
    let but = |others: &[(usize, usize)]| {
        Pairs::new(3, left.map(|(l, r, [n, ..])| (l, r, [n, 0.0, f64::from(others.contains(&(l, r)))])))
    };
    assert_eq!(fit(Model::DavidsonSide, &but(&[(2, 0)])).unwrap().penalty, Penalty::SideSeparated);
    let both = fit(Model::DavidsonSide, &but(&[(2, 0), (0, 2)])).unwrap();
    assert!(both.penalty == Penalty::None && both.side.unwrap() > 2.0, "{both:?}");
}

fn any_answers() -> impl Strategy<Value = Vec<[f64; 3]>> {
    prop::collection::vec([1..9u8, 0..6u8, 1..9u8].prop_map(|a| a.map(f64::from)), 6)
}

fn few_answers() -> impl Strategy<Value = Vec<[f64; 3]>> {
    prop::collection::vec([0..3u8, 0..3u8, 0..3u8].prop_map(|a| a.map(f64::from)), 6)
}

/// Up to eight times powers of ten up to 10^6.
fn far_apart() -> impl Strategy<Value = Vec<[f64; 3]>> {
    let number = || (0..9u8, 0..7i32).prop_map(|(n, power)| f64::from(n) * 10_f64.powi(power));
    prop::collection::vec([number(), number(), number()], 6)
}

const ORDERED: [(usize, usize); 6] = [(0, 1), (1, 0), (0, 2), (2, 0), (1, 2), (2, 1)];

fn pairs_of(answers: &[[f64; 3]], label: [usize; 3]) -> Pairs {
    Pairs::new(3, ORDERED.iter().zip(answers).map(|(&(l, r), &a)| (label[l], label[r], a)))
}

fn labels_do_not_matter(answers: &[[f64; 3]]) -> Result<(), TestCaseError> {
    for model in Model::ALL {
        let straight = fit(model, &pairs_of(answers, [0, 1, 2])).unwrap();
        let turned = fit(model, &pairs_of(answers, [2, 0, 1])).unwrap();
        prop_assert!((straight.log_likelihood - turned.log_likelihood).abs() < 1e-9);
        for (i, j) in ORDERED {
            let label = [2, 0, 1];
            let a = straight.log_worths[i] - straight.log_worths[j];
            let b = turned.log_worths[label[i]] - turned.log_worths[label[j]];
            prop_assert!((a - b).abs() < 1e-8);
            let error = |fit: &WorthFit, i, j| fit.standard_error(&fit.covariance, i, j);
            prop_assert!((error(&straight, i, j) - error(&turned, label[i], label[j])).abs() < 1e-8);
        }
    }
    Ok(())
}

fn swapping_sides_turns_the_side_effect_alone(answers: &[[f64; 3]]) -> Result<(), TestCaseError> {
    let swapped = Pairs::new(3, ORDERED.iter().zip(answers).map(|(&(l, r), &[a, t, b])| (r, l, [b, t, a])));
    for model in Model::ALL {
        let straight = fit(model, &pairs_of(answers, [0, 1, 2])).unwrap();
        let turned = fit(model, &swapped).unwrap();
        prop_assert!(straight.log_worths.iter().zip(&turned.log_worths).all(|(a, b)| (a - b).abs() < 1e-8));
        prop_assert!((straight.side.unwrap_or(0.0) + turned.side.unwrap_or(0.0)).abs() < 1e-8);
    }
    Ok(())
}

fn a_win_more_raises_the_winner(answers: &[[f64; 3]], pair: usize) -> Result<(), TestCaseError> {
    let mut more = answers.to_vec();
    more[pair][0] += 1.0;
    let (left, right) = ORDERED[pair];
    for model in [Model::Davidson, Model::RaoKupper, Model::BradleyTerry] {
        let difference = |answers: &[[f64; 3]]| {
            let fit = fit(model, &pairs_of(answers, [0, 1, 2])).unwrap();
            fit.log_worths[left] - fit.log_worths[right]
        };
        prop_assert!(difference(&more) > difference(answers));
    }
    Ok(())
}

fn separation_is_judged_as_the_climb_finds_it(
    answers: &[[f64; 3]],
    sparse: usize,
) -> Result<(), TestCaseError> {
    let kept: Vec<[f64; 3]> =
        answers.iter().enumerate().map(|(i, &a)| if i % sparse == 0 { a } else { [0.0; 3] }).collect();
    let pairs = pairs_of(&kept, [0, 1, 2]);
    let judged = separation(&pairs);
    prop_assume!(judged != Separation::Disconnected && pairs.ties() < pairs.answers());
    for model in [Model::Davidson, Model::RaoKupper] {
        let found = estimate(Layout::of(model, &pairs, 0.0), &pairs, &pairs, Penalty::None).is_some();
        prop_assert_eq!(found, judged != Separation::Separated, "{:?} {:?}", model, judged);
    }
    if side_design(&pairs).objection().is_none() {
        let found =
            estimate(Layout::of(Model::DavidsonSide, &pairs, 0.0), &pairs, &pairs, Penalty::None).is_some();
        let side = side_separation(&pairs);
        prop_assert_eq!(found, judged != Separation::Separated && side.is_none(), "{:?} {:?}", side, judged);
    }
    Ok(())
}

fn only_separation_is_penalised_whatever_the_numbers(answers: &[[f64; 3]]) -> Result<(), TestCaseError> {
    let pairs = pairs_of(answers, [0, 1, 2]);
    let judged = separation(&pairs);
    prop_assume!(judged != Separation::Disconnected && pairs.ties() < pairs.answers());
    for model in [Model::Davidson, Model::RaoKupper] {
        let fit = fit(model, &pairs);
        let items = judged == Separation::Separated;
        prop_assert_eq!(fit.as_ref().map(|fit| fit.penalised()), Ok(items), "{:?} {:?}", model, fit);
    }
    for left in [-5.0, 0.3, 5.0] {
        let given = fit_given_side(&pairs, left).map(|fit| fit.penalised());
        prop_assert_eq!(given, Ok(judged == Separation::Separated), "{}", left);
    }
    if side_design(&pairs).objection().is_none() {
        prop_assert!(fit(Model::DavidsonSide, &pairs).is_ok());
    }
    Ok(())
}

fn parameters_match_the_sufficient_statistics(answers: &[[f64; 3]]) -> Result<(), TestCaseError> {
    // At Davidson's maximum the expected number of ties is the number of ties.
    let pairs = pairs_of(answers, [0, 1, 2]);
    let fit = fit(Model::Davidson, &pairs).unwrap();
    let expected: f64 = pairs
        .pairs
        .iter()
        .map(|pair| {
            let half = 0.5 * (fit.log_worths[pair.left] - fit.log_worths[pair.right]);
            let nu = fit.ln_nu.unwrap().exp();
            pair.answers.iter().sum::<f64>() * nu / (half.exp() + nu + (-half).exp())
        })
        .sum();
    prop_assert!((expected - pairs.ties()).abs() < 1e-8);
    Ok(())
}

mod drawn {
    use super::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]

        #[test]
        fn labels_do_not_matter(answers in any_answers()) {
            super::labels_do_not_matter(&answers)?;
        }

        #[test]
        fn swapping_sides_turns_the_side_effect_alone(answers in any_answers()) {
            super::swapping_sides_turns_the_side_effect_alone(&answers)?;
        }

        #[test]
        fn a_win_more_raises_the_winner(answers in any_answers(), pair in 0..6usize) {
            super::a_win_more_raises_the_winner(&answers, pair)?;
        }

        #[test]
        fn separation_is_judged_as_the_climb_finds_it(answers in few_answers(), sparse in 1..4usize) {
            super::separation_is_judged_as_the_climb_finds_it(&answers, sparse)?;
        }

        #[test]
        fn only_separation_is_penalised_whatever_the_numbers(answers in far_apart()) {
            super::only_separation_is_penalised_whatever_the_numbers(&answers)?;
        }

        #[test]
        fn parameters_match_the_sufficient_statistics(answers in any_answers()) {
            super::parameters_match_the_sufficient_statistics(&answers)?;
        }
    }
}

/// `make test-long`, with another seed each time.
mod drawn_at_length {
    use super::*;

    proptest! {
        #![proptest_config(ProptestConfig { max_global_rejects: u32::MAX, ..ProptestConfig::with_cases(100_000) })]

        #[test]
        #[ignore = "100,000 draws: seconds to minutes"]
        fn labels_do_not_matter(answers in any_answers()) {
            super::labels_do_not_matter(&answers)?;
        }

        #[test]
        #[ignore = "100,000 draws: seconds to minutes"]
        fn swapping_sides_turns_the_side_effect_alone(answers in any_answers()) {
            super::swapping_sides_turns_the_side_effect_alone(&answers)?;
        }

        #[test]
        #[ignore = "100,000 draws: seconds to minutes"]
        fn a_win_more_raises_the_winner(answers in any_answers(), pair in 0..6usize) {
            super::a_win_more_raises_the_winner(&answers, pair)?;
        }

        #[test]
        #[ignore = "100,000 draws: seconds to minutes"]
        fn separation_is_judged_as_the_climb_finds_it(answers in few_answers(), sparse in 1..4usize) {
            super::separation_is_judged_as_the_climb_finds_it(&answers, sparse)?;
        }

        #[test]
        #[ignore = "100,000 draws: seconds to minutes"]
        fn only_separation_is_penalised_whatever_the_numbers(answers in far_apart()) {
            super::only_separation_is_penalised_whatever_the_numbers(&answers)?;
        }

        #[test]
        #[ignore = "100,000 draws: seconds to minutes"]
        fn parameters_match_the_sufficient_statistics(answers in any_answers()) {
            super::parameters_match_the_sufficient_statistics(&answers)?;
        }
    }
}
