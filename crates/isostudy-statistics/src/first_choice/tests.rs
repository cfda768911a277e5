use super::*;
use crate::{Model, Outcome, Pairs, ShownBallot, fit, golden};

#[track_caller]
fn close(got: f64, want: f64, by: f64) {
    assert!((got - want).abs() < by * want.abs().max(1.0), "{got} instead of {want}");
}

/// Ten people who take one of three or four of five items, by a formula that R computes too.
fn choices() -> Vec<Choice> {
    let mut choices = Vec::new();
    for p in 0..10 {
        for q in 0..6 {
            let drop = (p + q) % 5;
            let other = (drop + 1 + q % 2) % 5;
            let is_shown = |item: &usize| *item != other && (*item != drop || q == 5);
            let shown: Vec<usize> = (0..5).filter(is_shown).collect();
            let liking = |item: usize| item + (p * 7 + q * 11 + item * (p + 3 * q + 2) * 3) % 9;
            let taken = shown.iter().copied().rev().max_by_key(|&item| liking(item)).unwrap();
            choices.push(Choice { participant: p, shown, taken });
        }
    }
    choices
}

#[test]
fn three_or_four_things_as_r_has_them() {
    // R 4.2.2, survival 3.5-3: clogit(y ~ x1 + x2 + x3 + x4 + strata(id)); with cluster(p), method = "efron", robust errors times
    // sqrt(10 / 9).
    let found = first_choice(5, &choices()).unwrap();
    let worths = [-0.029_667_432_319_1, 1.740_320_819_177_6, 2.464_369_127_365_4, 3.338_655_849_339_8];
    let errors = [1.005_404_347_209, 0.779_151_335_934, 0.784_552_326_139, 0.792_750_366_935];
    let clustered = [0.768_612_897_406, 0.835_356_701_623, 0.632_339_039_426, 0.794_251_247_700];
    for item in 1..5 {
        close(found.log_worths[item], worths[item - 1], 1e-8);
        close(found.covariance[item - 1][item - 1].sqrt(), errors[item - 1], 1e-7);
        close(found.difference(item, 0).unwrap().se, clustered[item - 1], 1e-7);
    }
    close(found.log_likelihood, -42.206_955_304_3, 1e-10);
    let difference = found.difference(3, 1).unwrap();
    close(difference.estimate, 2.494_036_559_684, 1e-8);
    close(difference.se, 0.704_798_665_651, 1e-7);
    assert_eq!(found.participants, 10);
}

#[test]
fn of_two_things_it_is_bradley_and_terrys_model() {
    let mut ballots = golden::clusterings(&golden::study(), None);
    ballots.retain(|b| b.outcome() != Outcome::Tie);
    let choice = |b: &ShownBallot| Choice {
        participant: b.participant(),
        shown: vec![b.left(), b.right()],
        taken: if b.outcome() == Outcome::Left { b.left() } else { b.right() },
    };
    let mut choices: Vec<Choice> = ballots.iter().map(choice).collect();
    choices.reverse();
    let [got, want] = [first_choice(3, &choices).unwrap().log_worths, {
        fit(Model::BradleyTerry, &Pairs::of(3, &ballots)).unwrap().log_worths
    }];
    got.into_iter().zip(want).for_each(|(got, want)| close(got, want, 1e-9));
}

#[test]
fn what_has_no_estimate_says_so() {
    let of = |shown: &[usize], taken| Choice { participant: 0, shown: shown.to_vec(), taken };
    let says = |items: usize, choices: &[Choice]| first_choice(items, choices).map(|_| ());
    assert_eq!(says(3, &[]), Err(FitError::Nothing));
    assert_eq!(says(3, &[of(&[0, 1, 2], 0), of(&[0, 1, 2], 1)]), Err(FitError::NoMaximum));
    assert_eq!(says(4, &[of(&[0, 1, 2], 0), of(&[0, 1, 2], 1)]), Err(FitError::Disconnected));
    let circle = [of(&[0, 1], 0), of(&[1, 2], 1), of(&[2, 0], 2)];
    assert_eq!(says(3, &circle), Ok(()));
}
