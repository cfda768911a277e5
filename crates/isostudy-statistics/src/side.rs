//! Can a design tell a preference for a side from a preference for an item? Known before anyone answers.

use super::pairs::Pairs;
use std::collections::HashSet;

/// A side of what was shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Side {
    /// The left.
    Left,
    /// The right.
    Right,
}

/// What a design says about sides.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SideDesign {
    /// Some pair was shown in both orders: the side effect is seen directly.
    Counterbalanced,
    /// No pair was shown in both orders, but the worths would have to contradict each other round a circle for a side
    /// effect to hide: it can be estimated as far as worths are additive, and no further.
    ThroughAdditivity,
    /// Worths exist that imitate a side effect exactly: every item on the left is one step above its partner.
    Confounded,
}

impl SideDesign {
    /// Why a side effect cannot be estimated; `None` if it can.
    pub fn objection(self) -> Option<&'static str> {
        (self == Self::Confounded).then_some(
            "not answerable here, because no pair was shown in both orders and each item's side goes with its worth",
        )
    }
}

/// Judges the pairs that were shown, whatever the answers.
///
/// The side term enters each pair as l_left - l_right + delta (Davidson and Beaver 1977, Biometrics 33:693). It is
/// confounded exactly if some l has l_left - l_right = 1 on every pair shown, which a walk over the pairs decides.
pub fn side_design(pairs: &Pairs) -> SideDesign {
    let shown: HashSet<(usize, usize)> = pairs.pairs.iter().map(|p| (p.left, p.right)).collect();
    if pairs.pairs.iter().any(|pair| shown.contains(&(pair.right, pair.left))) {
        return SideDesign::Counterbalanced;
    }
    let mut height: Vec<Option<i64>> = vec![None; pairs.items];
    for start in 0..pairs.items {
        let mut open = if height[start].is_none() { vec![(start, 0)] } else { Vec::new() };
        while let Some((item, at)) = open.pop() {
            match height[item] {
                Some(known) if known != at => return SideDesign::ThroughAdditivity,
                Some(_) => continue,
                None => height[item] = Some(at),
            }
            for pair in &pairs.pairs {
                if pair.left == item {
                    open.push((pair.right, at - 1));
                } else if pair.right == item {
                    open.push((pair.left, at + 1));
                }
            }
        }
    }
    SideDesign::Confounded
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judged(items: usize, shown: &[(usize, usize)]) -> SideDesign {
        side_design(&Pairs::new(items, shown.iter().map(|&(l, r)| (l, r, [1.0, 0.0, 1.0]))))
    }

    #[test]
    fn two_items_and_the_original_triad() {
        assert_eq!(judged(2, &[(0, 1)]), SideDesign::Confounded);
        assert!(judged(2, &[(1, 0)]).objection().unwrap().starts_with("not answerable here, because"));
        assert_eq!(judged(2, &[(0, 1), (1, 0)]), SideDesign::Counterbalanced);
        // U left of I and P, P left of I: one step down cannot equal two.
        assert_eq!(judged(3, &[(0, 1), (0, 2), (2, 1)]), SideDesign::ThroughAdditivity);
        assert_eq!(judged(3, &[(0, 1), (1, 2), (2, 0)]), SideDesign::ThroughAdditivity);
        // A star, and two unconnected pairs: nothing to contradict.
        assert_eq!(judged(4, &[(0, 1), (0, 2), (0, 3)]), SideDesign::Confounded);
        assert_eq!(judged(4, &[(0, 1), (2, 3)]), SideDesign::Confounded);
        assert!(judged(3, &[(0, 1), (0, 2), (2, 1)]).objection().is_none());
    }
}
