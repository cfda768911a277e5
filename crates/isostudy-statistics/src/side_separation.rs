//! Do the answers allow a finite estimate of a liking for a side? Where everybody always takes the left, they do not.

use super::pairs::Pairs;
use super::separation::{Separation, separation};
use super::side::{Side, SideDesign, side_design};
use std::collections::HashMap;

/// The side that the answers like beyond any bound: the model with a side has no maximum, and it is the side's doing, since
/// without it there is one. `None` where the side has an estimate, where items are to blame ([`separation`]), and where
/// the design cannot tell sides from items.
///
/// With d for the side, the likelihood keeps rising in a direction (l, d, tau) under the conditions of [`separation`], with
/// l_i - l_j + d for i on the left of j. Items are to blame if d = 0 is among the directions. Otherwise:
/// with tau = 0, d can be scaled to 1 or -1, and Bellman and Ford find l; with 2 tau = 1, the d that allow an l form an
/// interval, since each circle of wins and ties asks for a d + b >= 0: circles that forbid a d narrow it down, until a d
/// is allowed or nothing is left.
pub fn side_separation(pairs: &Pairs) -> Option<Side> {
    let alone = separation(pairs);
    if matches!(alone, Separation::Separated | Separation::Disconnected)
        || side_design(pairs) == SideDesign::Confounded
    {
        return None;
    }
    let answers = Steps::of(pairs);
    let without_ties = |d: i64| answers.circle(pairs.items, Tie::Equal, d, 1).is_none().then_some(d);
    let direction = without_ties(1).or_else(|| without_ties(-1)).or_else(|| answers.allowed(pairs.items))?;
    Some(if direction > 0 { Side::Left } else { Side::Right })
}

/// How a direction treats ties.
#[derive(Clone, Copy, PartialEq)]
enum Tie {
    /// tau = 0: who tied stays equal, who won stays ahead or equal.
    Equal,
    /// 2 tau = 1: who tied is at most 1 apart, who won at least 1 ahead.
    Within,
}

/// One answer seen: l[to] <= l[from] + side d - 1, or + 1 for each way of a tie.
struct Step {
    from: usize,
    to: usize,
    /// 1 if `from` stood on the left, else -1.
    side: i64,
    win: bool,
}

struct Steps(Vec<Step>);

/// More steps than this are searched for the shortest circles first.
const FEW_STEPS: usize = 10_000;

/// A circle of answers that forbids a d: a d + b < 0.
struct Circle {
    a: i64,
    b: i64,
}

impl Steps {
    fn of(pairs: &Pairs) -> Self {
        let mut steps = Vec::new();
        for pair in &pairs.pairs {
            let (left, right) = (pair.left, pair.right);
            for (count, from, to, side, win) in [
                (pair.answers[0], left, right, 1, true),
                (pair.answers[2], right, left, -1, true),
                (pair.answers[1], left, right, 1, false),
                (pair.answers[1], right, left, -1, false),
            ] {
                steps.extend((count > 0.0).then_some(Step { from, to, side, win }));
            }
        }
        Self(steps)
    }

    /// Looks for l that goes with d = `p / q`, q above 0; a circle that forbids it, if there is none.
    fn circle(&self, items: usize, ties: Tie, p: i64, q: i64) -> Option<Circle> {
        let constant = |step: &Step| match ties {
            Tie::Equal => 0,
            Tie::Within if step.win => -1,
            Tie::Within => 1,
        };
        let cost = |step: &Step| p * step.side + q * constant(step);
        if self.0.len() > FEW_STEPS
            && let Some([there, back]) = self.there_and_back(cost)
        {
            let (a, b) = (there.side + back.side, constant(there) + constant(back));
            return Some(Circle { a, b });
        }
        let mut height = vec![0_i64; items];
        let mut last: Vec<Option<usize>> = vec![None; items];
        let mut moved = None;
        for _ in 0..=items {
            moved = None;
            for (index, step) in self.0.iter().enumerate() {
                let bound = height[step.from] + p * step.side + q * constant(step);
                if height[step.to] > bound {
                    height[step.to] = bound;
                    last[step.to] = Some(index);
                    moved = Some(step.to);
                }
            }
            moved?;
        }
        // Back along what moved last, often enough to be on the circle; then once round it.
        let back = |item: usize| last[item].map(|index| &self.0[index]).expect("moved again and again");
        let start = (0..items).fold(moved?, |at, _| back(at).from);
        let (mut at, mut circle) = (start, Circle { a: 0, b: 0 });
        loop {
            let step = back(at);
            circle.a += step.side;
            circle.b += constant(step);
            at = step.from;
            if at == start {
                return Some(circle);
            }
        }
    }

    /// Two steps, from an item to another and back, that cost less than nothing. Of many answers some are such a circle, and to look
    /// for longer ones takes as many rounds as there are items.
    fn there_and_back(&self, cost: impl Fn(&Step) -> i64) -> Option<[&Step; 2]> {
        let mut cheapest: HashMap<(usize, usize), &Step> = HashMap::new();
        for step in &self.0 {
            let known = cheapest.entry((step.from, step.to)).or_insert(step);
            if cost(step) < cost(known) {
                *known = step;
            }
        }
        self.0.iter().find_map(|step| {
            let there = *cheapest.get(&(step.from, step.to))?;
            let back = *cheapest.get(&(step.to, step.from))?;
            (cost(there) + cost(back) < 0).then_some([there, back])
        })
    }

    /// The sign of a d that is allowed with 2 tau = 1.
    fn allowed(&self, items: usize) -> Option<i64> {
        // As fractions (p, q); nothing is known at first.
        let mut low: Option<(i64, i64)> = None;
        let mut high: Option<(i64, i64)> = None;
        let mut tried = (0, 1);
        loop {
            let Some(Circle { a, b }) = self.circle(items, Tie::Within, tried.0, tried.1) else {
                return Some(tried.0.signum());
            };
            match a {
                0 => return None,
                a if a > 0 => low = Some((-b, a)),
                a => high = Some((b, -a)),
            }
            if let (Some((p, q)), Some((r, s))) = (low, high)
                && p * s > r * q
            {
                return None;
            }
            tried = if a > 0 { low? } else { high? };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judged(items: usize, answers: &[(usize, usize, [u8; 3])]) -> Option<Side> {
        side_separation(&Pairs::new(items, answers.iter().map(|&(i, j, a)| (i, j, a.map(f64::from)))))
    }

    #[test]
    fn always_one_side() {
        assert_eq!(judged(2, &[(0, 1, [9, 0, 0]), (1, 0, [9, 0, 0])]), Some(Side::Left));
        assert_eq!(judged(2, &[(0, 1, [0, 0, 9]), (1, 0, [0, 3, 9])]), Some(Side::Right));
        // Ties with the wins: the left and neither, never the right.
        assert_eq!(judged(2, &[(0, 1, [9, 2, 0]), (1, 0, [9, 5, 0])]), Some(Side::Left));
        assert_eq!(judged(2, &[(0, 1, [9, 0, 0]), (1, 0, [9, 0, 1])]), Some(Side::Left));
        assert_eq!(judged(2, &[(0, 1, [9, 0, 1]), (1, 0, [9, 0, 1])]), None);
        // Always the left of three items, but for one answer that a worth explains.
        let three =
            [(0, 1, [9, 0, 0]), (1, 0, [8, 0, 1]), (0, 2, [9, 0, 0]), (2, 0, [9, 0, 0]), (1, 2, [5, 0, 0])];
        assert_eq!(judged(3, &three), Some(Side::Left));
    }

    #[test]
    fn many_answers_are_judged_as_few() {
        let all = |answers: [u8; 3]| {
            let pairs: Vec<(usize, usize, [u8; 3])> = (0..120)
                .flat_map(|i| (0..120).filter(move |&j| j != i).map(move |j| (i, j, answers)))
                .collect();
            assert!(3 * pairs.len() > FEW_STEPS);
            judged(120, &pairs)
        };
        assert_eq!(all([9, 1, 0]), Some(Side::Left));
        assert_eq!(all([0, 1, 9]), Some(Side::Right));
        assert_eq!(all([9, 0, 0]), Some(Side::Left));
        assert_eq!(all([9, 1, 2]), None);
    }

    #[test]
    fn items_are_not_a_side() {
        // One item always wins, on either side; and sides that the design cannot tell from items.
        assert_eq!(judged(2, &[(0, 1, [9, 0, 0]), (1, 0, [0, 0, 9])]), None);
        assert_eq!(judged(2, &[(0, 1, [36, 8, 10])]), None);
        assert_eq!(judged(3, &[(0, 1, [5, 0, 4])]), None);
    }
}
