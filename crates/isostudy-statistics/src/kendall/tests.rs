use super::*;
use crate::{Outcome, Preference, ShownBallot};
use proptest::prelude::*;

#[test]
fn zeta_by_hand() {
    // Three items: a circle of wins, then an order. Six items: at most 6 (36 - 4) / 24 = 8 circular triads.
    assert_eq!(zeta(&[1, 1, 1]), Some((1, 0.0)));
    assert_eq!(zeta(&[2, 1, 0]), Some((0, 1.0)));
    assert_eq!(zeta(&[3, 3, 3, 2, 2, 2]), Some((8, 0.0)));
    assert_eq!(zeta(&[5, 4, 3, 1, 1, 1]), Some((1, 0.875)));
    assert_eq!(zeta(&[2, 2, 2, 2, 2]), Some((5, 0.0)));
    assert_eq!(zeta(&[1, 0]), None);
}

#[test]
fn agreement_by_its_definition() {
    // The formulas of Kendall and Babington Smith in Python, tails by scipy.stats.chi2.sf; 10 judges, 3 items.
    let close = |got: f64, want: f64| assert!((got - want).abs() < 1e-12, "{got} is not {want}");
    let decided = agreement(&[[8, 0, 2], [7, 0, 3], [5, 0, 5]]).unwrap();
    close(decided.u, 0.081_481_481_481_481_49);
    let test = decided.test.unwrap();
    close(test.statistic, 6.968_75);
    close(test.degrees, 4.218_75);
    close(test.p, 0.154_598_159_401_993_6);
    let tied = agreement(&[[8, 1, 2], [7, 2, 2], [5, 0, 6]]).unwrap();
    close(tied.u, 0.087_878_787_878_787_89);
    close(tied.test.unwrap().p, 0.126_177_320_690_673_56);
}

#[test]
fn agreement_at_its_ends() {
    let u = |pairs: &[[u64; 3]]| agreement(pairs).unwrap().u;
    assert_eq!(u(&[[6, 0, 0], [0, 0, 6]]), 1.0);
    // Even m: -1/(m-1); odd m: -1/m.
    assert!((u(&[[3, 0, 3]]) + 0.2).abs() < 1e-15);
    assert!((u(&[[3, 0, 2]]) + 0.2).abs() < 1e-15);
    assert_eq!(agreement(&[[1, 0, 1]]).unwrap().test, None);
    assert_eq!(agreement(&[[3, 0, 3], [3, 0, 2]]), None);
    assert_eq!(agreement(&[]), None);
}

/// One participant's answers to the pairs 0-1, 1-2, 0-2.
fn three(signs: [Preference; 3]) -> Vec<DeclaredBallot> {
    three_of(0, signs)
}

fn three_of(participant: usize, signs: [Preference; 3]) -> Vec<DeclaredBallot> {
    let pairs = [(0, 1), (1, 2), (0, 2)];
    let ballot = |(i, (first, second)): (usize, (usize, usize))| {
        DeclaredBallot::new(participant, i, [first, second], signs[i])
    };
    pairs.into_iter().enumerate().map(ballot).collect()
}

#[test]
fn strict_and_weak_cycles() {
    use Preference::{First as Left, Neither as Tie, Second as Right};
    let counted = |signs| {
        let t = triads(&three(signs));
        (t.all, t.decided, t.strict_cycles, t.weak_cycles)
    };
    assert_eq!(counted([Left, Left, Left]), (1, 1, 0, 0));
    assert_eq!(counted([Left, Left, Right]), (1, 1, 1, 0));
    assert_eq!(counted([Right, Right, Left]), (1, 1, 1, 0));
    assert_eq!(counted([Left, Left, Tie]), (1, 0, 0, 1));
    assert_eq!(counted([Left, Tie, Left]), (1, 0, 0, 0));
    assert_eq!(counted([Left, Tie, Right]), (1, 0, 0, 1));
    assert_eq!(counted([Tie, Tie, Left]), (1, 0, 0, 0));
    assert_eq!(triads(&three([Left; 3])[..2]).all, 0);
}

#[test]
fn zetas_of_those_who_decided_everything() {
    use Preference::{First as Left, Neither as Tie, Second as Right};
    // An order, a circle, an order; a tie leaves the last out.
    let rows = [[Left, Left, Left], [Left, Left, Right], [Right, Left, Left], [Left, Tie, Left]];
    let all: Vec<DeclaredBallot> =
        rows.into_iter().enumerate().flat_map(|(person, signs)| three_of(person, signs)).collect();
    assert_eq!(zetas(&all), (3, 2.0));
    assert_eq!(zetas(&all[..2]), (0, 0.0));
}

#[test]
fn outcomes_are_counted_for_items_whatever_their_sides() {
    let ballot =
        |participant, left, outcome| ShownBallot::new(participant, 1, [left, 5 - left], outcome).declared(2);
    use Outcome::{Left, Right, Tie};
    let all = [
        ballot(0, 2, Left),
        ballot(1, 3, Right),
        ballot(2, 2, Tie),
        ballot(3, 2, Right),
        ballot(4, 3, Right),
    ];
    assert_eq!(outcome_counts(&all), [[0, 0, 0], [3, 1, 1]]);
}

const ALL: [Preference; 3] = [Preference::First, Preference::Neither, Preference::Second];

proptest! {
    #[test]
    fn a_quarter_of_all_tournaments_is_circular_and_sides_do_not_matter(
        outcomes in prop::collection::vec(0..3usize, 3),
        swapped in prop::collection::vec(prop::bool::ANY, 3),
    ) {
        let signs = [0, 1, 2].map(|i| ALL[outcomes[i]]);
        let straight = three(signs);
        let mut reversed = straight.clone();
        for (ballot, swap) in reversed.iter_mut().zip(swapped) {
            if swap {
                let items = [ballot.second(), ballot.first()];
                *ballot = DeclaredBallot::new(0, ballot.question(), items, ballot.preference().reversed());
            }
        }
        prop_assert_eq!(triads(&straight), triads(&reversed));
        let all = ALL.into_iter().filter(|&o| o != Preference::Neither);
        let tournaments = all.clone().flat_map(|a| all.clone().flat_map({ let all = all.clone(); move |b| all.clone().map(move |c| [a, b, c]) }));
        let sum = tournaments.map(|t| triads(&three(t))).fold(Triads::default(), Triads::and);
        prop_assert_eq!((sum.all, sum.strict_cycles), (8, 2));
    }
}
