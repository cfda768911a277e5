//! Do the answers allow finite estimates? If not, the likelihood has no maximum and any printed worth is an artefact.

use super::pairs::Pairs;

/// Whether worths can be estimated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Separation {
    /// The strict wins link every item to every other in both directions: finite and unique estimates, whatever the
    /// model and however ties count.
    None,
    /// Some set of items never won strictly against the rest, but ties hold the Davidson model's estimates in place: they
    /// are finite. (Dropping ties, they would not be.)
    HeldByTies,
    /// Some set of items never won against the rest, and no finite estimate exists.
    Separated,
    /// Some items were never compared, not even through others: no model can place them on one scale.
    Disconnected,
}

/// Judges the wins and ties of `pairs`.
///
/// Strong connection of the strict-win graph is Ford's condition (1957, Amer. Math. Monthly 64:28) and suffices.
/// It is not necessary with ties and more than two items. The likelihood keeps rising in a direction (l, tau = ln nu)
/// only if every answer seen is the likeliest of its pair in that direction: l_i - l_j >= max(0, 2 tau) where i beat j,
/// |l_i - l_j| <= 2 tau where they tied. With 2 tau = 0 that asks for two sets without wins of one over the other and
/// without ties between; with 2 tau = 1, for a potential that falls by at least 1 over each win and moves by at most 1
/// over each tie, found by Bellman and Ford. Two items that tie, one of which never wins, have such a potential.
pub fn separation(pairs: &Pairs) -> Separation {
    let (mut wins, mut ties) = (Vec::new(), Vec::new());
    for pair in &pairs.pairs {
        let [left, tie, right] = pair.answers;
        wins.extend((left > 0.0).then_some((pair.left, pair.right)));
        wins.extend((right > 0.0).then_some((pair.right, pair.left)));
        ties.extend((tie > 0.0).then_some((pair.left, pair.right)));
    }
    let back = |edges: &[(usize, usize)]| edges.iter().map(|&(i, j)| (j, i)).collect::<Vec<_>>();
    let both_ways = [ties.clone(), back(&ties)].concat();
    let any_answer = [wins.clone(), back(&wins), both_ways.clone()].concat();
    if !strongly_connected(pairs.items, &any_answer) {
        return Separation::Disconnected;
    }
    if strongly_connected(pairs.items, &wins) {
        return Separation::None;
    }
    let wins_and_ties = [wins.clone(), both_ways.clone()].concat();
    let rises = potential_exists(pairs.items, &wins, &both_ways);
    match strongly_connected(pairs.items, &wins_and_ties) && !rises {
        true => Separation::HeldByTies,
        false => Separation::Separated,
    }
}

fn strongly_connected(items: usize, edges: &[(usize, usize)]) -> bool {
    let reaches_all = |forward: bool| {
        let mut ends: Vec<(usize, usize)> =
            edges.iter().map(|&(i, j)| if forward { (i, j) } else { (j, i) }).collect();
        ends.sort_unstable();
        let mut seen = vec![false; items];
        let mut open = vec![0];
        while let Some(at) = open.pop() {
            if std::mem::replace(&mut seen[at], true) {
                continue;
            }
            let of =
                ends.partition_point(|&(from, _)| from < at)..ends.partition_point(|&(from, _)| from <= at);
            open.extend(ends[of].iter().map(|&(_, to)| to).filter(|&to| !seen[to]));
        }
        seen.into_iter().all(|seen| seen)
    };
    items < 2 || (reaches_all(true) && reaches_all(false))
}

/// Is there l with l_j <= l_i - 1 for every win (i, j), and l_i <= l_j + 1 for every tie, given in both directions?
fn potential_exists(items: usize, wins: &[(usize, usize)], ties: &[(usize, usize)]) -> bool {
    let mut potential = vec![0_i64; items];
    for _ in 0..=items {
        let mut moved = false;
        let bounds = wins.iter().map(|&e| (e, -1)).chain(ties.iter().map(|&e| (e, 1)));
        for ((from, to), step) in bounds {
            if potential[to] > potential[from] + step {
                potential[to] = potential[from] + step;
                moved = true;
            }
        }
        if !moved {
            return true;
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judged(items: usize, answers: &[(usize, usize, [u8; 3])]) -> Separation {
        separation(&Pairs::new(items, answers.iter().map(|&(i, j, a)| (i, j, a.map(f64::from)))))
    }

    #[test]
    fn two_items() {
        assert_eq!(judged(2, &[(0, 1, [36, 8, 10])]), Separation::None);
        assert_eq!(judged(2, &[(0, 1, [36, 8, 0])]), Separation::Separated);
        assert_eq!(judged(2, &[(0, 1, [36, 0, 0]), (1, 0, [0, 0, 5])]), Separation::Separated);
        assert_eq!(judged(2, &[(0, 1, [36, 0, 0]), (1, 0, [1, 0, 5])]), Separation::None);
        assert_eq!(judged(2, &[(0, 1, [0, 9, 0])]), Separation::Separated);
    }

    #[test]
    fn three_items() {
        let chain = [(0, 1, [5, 0, 4]), (1, 2, [3, 0, 2])];
        assert_eq!(judged(3, &chain), Separation::None);
        assert_eq!(judged(3, &chain[..1]), Separation::Disconnected);
        // Item 0 never loses. R's gnm with GenDavidson converges on this: see `fit::tests`.
        let held = [(0, 1, [6, 3, 0]), (0, 2, [5, 4, 0]), (1, 2, [4, 2, 3])];
        assert_eq!(judged(3, &held), Separation::HeldByTies);
        let without_ties = held.map(|(i, j, [l, _, r])| (i, j, [l, 0, r]));
        assert_eq!(judged(3, &without_ties), Separation::Separated);
        // A strict order with ties between neighbours only: the potential 2, 1, 0 exists.
        assert_eq!(judged(3, &[(0, 1, [6, 3, 0]), (1, 2, [5, 4, 0])]), Separation::Separated);
    }
}
