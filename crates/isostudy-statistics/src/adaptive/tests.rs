use super::*;
use crate::simulation::{Plan, Population, simulate};
use crate::{FitError, Outcome, Participants, ShownBallot};

#[test]
fn information_as_numpy_has_it() {
    // NumPy 2.4.6: mutual information with 120 points of `hermite_e.hermegauss`.
    let cases = [
        ([0.0, 4.5, 0.3], 0.234_369_190_914_437_3),
        ([1.0, 1.0, 0.3], 0.075_304_522_426_670_62),
        ([3.0, 0.5, 0.3], 0.014_760_215_347_273_509),
        ([0.0, 0.01, 0.0], 0.001_245_338_349_777_802_6),
        ([5.0, 2.0, 0.8], 0.026_651_712_020_940_632),
        ([0.0, 1.0, 0.0], 0.093_708_961_354_412_42),
    ];
    for ([mean, variance, nu], want) in cases {
        let got = expected_information(mean, variance, nu);
        assert!((got / want - 1.0).abs() < 2e-3, "{mean} {variance} {nu}: {got} instead of {want}");
        assert!((got / expected_information(-mean, variance, nu) - 1.0).abs() < 1e-12);
    }
    assert_eq!(expected_information(0.3, 0.0, 0.3), 0.0);
}

#[test]
fn what_is_known_is_the_mode_of_the_posterior_at_the_likeliest_spread() {
    // SciPy 1.17.1: minimize(-log posterior, method="BFGS") for each spread; second derivatives by central differences; the largest
    // log posterior - 3 ln spread - ln det / 2.
    let answers = [(0, 1, [8.0, 1.0, 2.0]), (1, 2, [1.0, 1.0, 3.0]), (2, 0, [2.0, 0.0, 3.0])];
    let known = Known::of(&Pairs::new(3, answers));
    assert_eq!(known.worths_sd, 0.8);
    let near = |got: f64, want: f64| assert!((got - want).abs() < 1e-5, "{got} instead of {want}");
    let mode = [0.461_119_6, -0.566_476_0, 0.105_356_3];
    known.log_worths.iter().zip(mode).for_each(|(&got, want)| near(got, want));
    near(known.nu.ln(), -1.377_813_0);
    let covariance = [0.328_511_3, 0.167_012_6, 0.144_476_1];
    known.covariance[0].iter().zip(covariance).for_each(|(&got, want)| near(got, want));
    assert_eq!(Known::of(&Pairs::new(3, [])).worths_sd, 0.8);
}

#[test]
fn the_next_pair_is_the_one_that_tells_most() {
    // Items 0 and 1 are known to be alike, 2 and 3 too, and 4 was never shown.
    let alike = [30.0, 0.0, 30.0];
    let pairs = Pairs::new(5, [(0, 1, alike), (2, 3, alike), (0, 2, [20.0, 0.0, 2.0])]);
    let chosen = next_pairs(&pairs, 3, 10, 7);
    // After the five that are dealt, each is the one that tells most of those that are left.
    let mut known = Known::of(&pairs);
    chosen[..5].iter().for_each(|&[a, b]| known.ask(a, b));
    for (place, &[a, b]) in chosen.iter().enumerate().skip(5) {
        let told = known.tells(a, b);
        let is_asked = |a: usize, b: usize| chosen[..place].iter().any(|of| *of == [a, b] || *of == [b, a]);
        let open = (0..5).flat_map(|a| (a + 1..5).map(move |b| (a, b))).filter(|&(a, b)| !is_asked(a, b));
        let best = open.map(|(a, b)| known.tells(a, b)).fold(0.0, f64::max);
        assert!((told / best - 1.0).abs() < 1e-12, "{told} {best}");
        known.ask(a, b);
        assert!(known.tells(a, b) < told);
    }
    // What nothing is known of tells most.
    let known = Known::of(&pairs);
    assert!((0..4).all(|item| known.tells(item, 4) > known.tells(0, 1).max(known.tells(2, 3))));
}

#[test]
fn nobody_is_asked_twice_and_everything_can_be_asked() {
    let nothing = Pairs::new(6, []);
    let mut pairs = next_pairs(&nothing, 0, 99, 1);
    assert_eq!(pairs.len(), 15);
    assert_eq!(pairs, next_pairs(&nothing, 0, 99, 1));
    assert_ne!(pairs, next_pairs(&nothing, 0, 99, 2));
    assert_ne!(pairs, next_pairs(&nothing, 1, 99, 1));
    pairs.iter_mut().for_each(|pair| pair.sort_unstable());
    pairs.sort_unstable();
    pairs.dedup();
    assert_eq!(pairs.len(), 15);
}

#[test]
fn every_pair_is_dealt_equally_often() {
    // Five people who are dealt three of fifteen each make one pack.
    let mut dealt: Vec<[usize; 2]> = (0..10).flat_map(|person| dealt_pairs(6, person, 3, 9)).collect();
    assert_eq!(dealt.len(), 30);
    let turned = dealt.iter().filter(|[a, b]| a > b).count();
    assert!((5..=25).contains(&turned), "{turned}");
    dealt.iter_mut().for_each(|pair| pair.sort_unstable());
    for pack in dealt.chunks_mut(15) {
        pack.sort_unstable();
        assert!(pack.windows(2).all(|two| two[0] < two[1]), "{pack:?}");
    }
    // Across the end of a pack nobody is dealt a pair twice.
    for person in 0..20 {
        let mut own = dealt_pairs(4, person, 5, 2);
        own.iter_mut().for_each(|pair| pair.sort_unstable());
        own.sort_unstable();
        assert!(own.windows(2).all(|two| two[0] < two[1]));
    }
}

/// One study: everybody's pairs are chosen after the answers of all before them.
fn adaptive(population: &Population, people: usize, asked: usize, seed: u64) -> Vec<ShownBallot> {
    let items = population.worths.len();
    let mut random = stream(seed, 0);
    let mut ballots: Vec<ShownBallot> = Vec::with_capacity(people * asked);
    for person in 0..people {
        let chosen = next_pairs(&Pairs::of(items, &ballots), person, asked, seed);
        ballots.extend(of_person(population, person, &chosen, &mut random));
    }
    ballots
}

/// The answers of somebody who is shown these pairs.
fn of_person(
    population: &Population,
    person: usize,
    pairs: &[[usize; 2]],
    random: &mut impl rand::Rng,
) -> Vec<ShownBallot> {
    let shown = |&[left, right]: &[usize; 2]| crate::simulation::Shown { left, right, scene: 0 };
    let plan = Plan {
        items: population.worths.len(),
        questions: pairs.iter().map(shown).collect(),
        counterbalanced: false,
    };
    let own = simulate(&plan, population, 1, random);
    own.iter().map(|ballot| ballot.with_participant(person)).collect()
}

#[test]
fn adaptive_studies_do_not_depend_on_threads_and_ask_what_is_close() {
    let worths = vec![-3.0, -2.5, 0.0, 0.4, 2.8, 3.1];
    let population = Population { worths: worths.clone(), ..Population::indifferent(6, 0.5) };
    let ballots = adaptive(&population, 30, 6, 11);
    assert_eq!(ballots.len(), 180);
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    assert_eq!(one.install(|| adaptive(&population, 30, 6, 11)), ballots);
    let apart = |b: &ShownBallot| (worths[b.left()] - worths[b.right()]).abs();
    // The second half of each person's, of people in the second half. Of all 15 pairs the mean is 3.1.
    let chosen: Vec<f64> = ballots[90..].chunks(6).flat_map(|own| own[3..].iter().map(apart)).collect();
    let mean = chosen.iter().sum::<f64>() / chosen.len() as f64;
    assert!(mean < 2.0, "{mean}");
    assert!(ballots.iter().any(|b| b.outcome() == Outcome::Tie));
}

#[test]
fn many_answers_are_drawn_together_no_more() {
    // With 2,000 people the estimates are those of the likelihood, and so are their errors.
    let worths = vec![0.0, 0.4, 0.6, 1.2];
    let population = Population { worths, side: 0.3, ..Population::indifferent(4, 0.8) };
    let ballots = simulate(&Plan::round_robin(4, 2), &population, 2_000, &mut stream(3, 0));
    let participants = Participants::of(4, &ballots);
    let found = shrunken(&participants).unwrap();
    let scale = crate::scale(&participants, 0).unwrap();
    for item in 1..4 {
        let (got, want) = (found.difference(item, 0).unwrap(), scale.positions[item]);
        assert!((got.estimate - want.log_odds).abs() < 0.01, "{got:?} {want:?}");
        assert!((got.se / want.spread.unwrap().se - 1.0).abs() < 0.02, "{got:?} {want:?}");
    }
    assert!((found.side - scale.fit.side.unwrap()).abs() < 0.01);
    // What never won has an estimate all the same.
    let won = |b: &ShownBallot| if b.left() == 3 { Outcome::Left } else { Outcome::Right };
    let always: Vec<ShownBallot> = ballots[..120]
        .iter()
        .map(|b| if b.left().max(b.right()) == 3 { b.with_outcome(won(b)) } else { *b })
        .collect();
    let found = shrunken(&Participants::of(4, &always)).unwrap();
    assert!(found.log_worths[3] > 1.0 && found.difference(3, 0).unwrap().p < 0.01);
    assert_eq!(shrunken(&Participants::of(4, &ballots[..12])).map(|_| ()), Err(FitError::Nothing));
    assert_eq!(shrunken(&Participants::of(5, &ballots)).map(|_| ()), Err(FitError::Disconnected));
}

mod measured;
