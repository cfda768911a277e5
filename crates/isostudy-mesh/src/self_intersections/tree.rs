//! Pairs of boxes that meet.

use std::ops::{ControlFlow, Range};

use glam::DVec3;

/// A box along the axes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Around {
    pub(super) low: DVec3,
    pub(super) high: DVec3,
}

impl Around {
    pub(super) fn of(points: impl IntoIterator<Item = DVec3>) -> Self {
        let nothing = Self { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };
        points.into_iter().fold(nothing, |of, p| Self { low: of.low.min(p), high: of.high.max(p) })
    }

    /// The same, larger by so much on every side.
    pub(super) fn wider(self, by: f64) -> Self {
        Self { low: self.low - by, high: self.high + by }
    }

    fn with(self, other: &Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    fn meets(&self, other: &Self) -> bool {
        self.low.cmple(other.high).all() && other.low.cmple(self.high).all()
    }
}

/// The most boxes that are not divided any further.
const LEAF: usize = 4;

/// A node of a tree: its members, and its two halves, the first right after it.
#[derive(Debug)]
struct Node {
    around: Around,
    members: Range<usize>,
    /// The node of the second half; none in a leaf.
    second: Option<usize>,
    /// Whether no two of its members are wanted.
    is_group: bool,
}

/// Boxes by halves, apart along the longest axis of the box around their middles.
pub(super) struct Tree<'a> {
    boxes: &'a [Around],
    nodes: Vec<Node>,
    members: Vec<u32>,
}

impl<'a> Tree<'a> {
    /// Of `single` boxes, of which every pair is wanted, and of `groups`, within which none is.
    pub(super) fn of(boxes: &'a [Around], single: &[u32], groups: &[Vec<u32>]) -> Self {
        let mut parts: Vec<(Around, &[u32], bool)> = groups
            .iter()
            .map(|group| (&group[..], true))
            .chain([(single, false)])
            .filter_map(|(of, is_group)| Some((around(boxes, of)?, of, is_group)))
            .collect();
        let mut tree = Self { boxes, nodes: Vec::new(), members: Vec::new() };
        if !parts.is_empty() {
            tree.add_parts(&mut parts);
        }
        tree
    }

    /// Parts by halves.
    fn add_parts(&mut self, parts: &mut [(Around, &[u32], bool)]) -> usize {
        if let [(_, members, is_group)] = parts {
            let from = self.members.len();
            self.members.extend_from_slice(members);
            let number = self.add(from..self.members.len());
            self.nodes[number].is_group = *is_group;
            return number;
        }
        let all = Around::of(parts.iter().flat_map(|(around, ..)| [around.low, around.high]));
        let axis = (all.high - all.low).max_position();
        let half = parts.len() / 2;
        let key = |of: &(Around, &[u32], bool)| (of.0.low[axis] + of.0.high[axis], of.1[0]);
        parts.sort_unstable_by(|a, b| {
            let (a, b) = (key(a), key(b));
            a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))
        });
        let (first, second) = parts.split_at_mut(half);
        let from = self.members.len();
        let number = self.divided(|tree| tree.add_parts(first), |tree| tree.add_parts(second));
        self.nodes[number].members = from..self.members.len();
        number
    }

    fn add(&mut self, members: Range<usize>) -> usize {
        let boxes = self.boxes;
        let own = &mut self.members[members.clone()];
        let twice_middle = |t: u32| boxes[t as usize].low + boxes[t as usize].high;
        let middles = Around::of(own.iter().map(|&t| twice_middle(t)));
        if members.len() <= LEAF {
            let around = around(boxes, own).expect("nobody adds none");
            self.nodes.push(Node { around, members, second: None, is_group: false });
            return self.nodes.len() - 1;
        }
        let axis = (middles.high - middles.low).max_position();
        let half = members.len() / 2;
        let key = |t: u32| twice_middle(t)[axis];
        own.select_nth_unstable_by(half, |&a, &b| key(a).total_cmp(&key(b)).then(a.cmp(&b)));
        let middle = members.start + half;
        let (first, second) = (members.start..middle, middle..members.end);
        let number = self.divided(|tree| tree.add(first), |tree| tree.add(second));
        self.nodes[number].members = members;
        number
    }

    fn divided(
        &mut self,
        first: impl FnOnce(&mut Self) -> usize,
        second: impl FnOnce(&mut Self) -> usize,
    ) -> usize {
        let number = self.nodes.len();
        let around = Around::of([]);
        self.nodes.push(Node { around, members: 0..0, second: None, is_group: false });
        let first = first(self);
        let second = second(self);
        self.nodes[number].around = self.nodes[first].around.with(&self.nodes[second].around);
        self.nodes[number].second = Some(second);
        number
    }

    /// Every pair of boxes that meet, but those of one group, until `stop`: `met` is asked of each, and `looked` before each look at a
    /// pair of nodes.
    pub(super) fn pairs(&self, visit: &mut impl Visit) -> ControlFlow<()> {
        match self.nodes.is_empty() {
            true => ControlFlow::Continue(()),
            false => self.within(0, visit),
        }
    }

    fn within(&self, number: usize, visit: &mut impl Visit) -> ControlFlow<()> {
        let node = &self.nodes[number];
        if node.is_group {
            return ControlFlow::Continue(());
        }
        if let Some(second) = node.second {
            let first = number + 1;
            self.within(first, visit)?;
            self.within(second, visit)?;
            return self.between(first, second, visit);
        }
        let own = &self.members[node.members.clone()];
        for (i, &a) in own.iter().enumerate() {
            self.leaves(&[a], &own[i + 1..], visit)?;
        }
        ControlFlow::Continue(())
    }

    fn between(&self, a: usize, b: usize, visit: &mut impl Visit) -> ControlFlow<()> {
        let [of_a, of_b] = [a, b].map(|number| &self.nodes[number]);
        visit.look()?;
        if !of_a.around.meets(&of_b.around) {
            return ControlFlow::Continue(());
        }
        match (of_a.second, of_b.second) {
            (None, None) => {
                let [of_a, of_b] = [of_a, of_b].map(|node| &self.members[node.members.clone()]);
                self.leaves(of_a, of_b, visit)
            }
            // The one with more members is divided.
            (Some(second), _) if of_b.second.is_none() || of_a.members.len() >= of_b.members.len() => {
                self.between(a + 1, b, visit)?;
                self.between(second, b, visit)
            }
            (_, Some(second)) => {
                self.between(a, b + 1, visit)?;
                self.between(a, second, visit)
            }
            (Some(_), None) => unreachable!("a node that is divided beside one that is not is divided first"),
        }
    }

    fn leaves(&self, of_a: &[u32], of_b: &[u32], visit: &mut impl Visit) -> ControlFlow<()> {
        for &a in of_a {
            for &b in of_b {
                if self.boxes[a as usize].meets(&self.boxes[b as usize]) {
                    visit.meet(a, b)?;
                }
            }
        }
        ControlFlow::Continue(())
    }
}

/// The box around some boxes.
fn around(boxes: &[Around], of: &[u32]) -> Option<Around> {
    of.iter().map(|&t| boxes[t as usize]).reduce(|a, b| a.with(&b))
}

/// Who is told of pairs, and may end the search.
pub(super) trait Visit {
    /// Before two nodes are looked at.
    fn look(&mut self) -> ControlFlow<()>;
    /// Of two boxes that meet.
    fn meet(&mut self, a: u32, b: u32) -> ControlFlow<()>;
}
