//! Face rules: where the surface crosses the faces of a cell, and the loops that the crossings make round it.

use crate::cell::Cell;

/// More edges than any cell has: a cube with all sides divided has 48.
const MOST_EDGES: usize = 64;
const NONE: u8 = u8::MAX;

/// The loops of crossed edges round a cell, in room that is used again.
#[derive(Debug, Clone, Default)]
pub struct Loops {
    steps: Vec<Step>,
    /// Where each loop ends.
    ends: Vec<usize>,
}

/// A crossed edge of a loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Step {
    /// Its number.
    pub edge: u8,
    /// The face that the arc from it to the next is in.
    pub face: u8,
}

impl Loops {
    /// The loops, each counter-clockwise seen from outside the surface and beginning with its lowest edge, in order.
    pub fn iter(&self) -> impl Iterator<Item = &[Step]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| &self.steps[start..end])
    }
}

impl Cell {
    /// The faces whose corners change sides more than twice, one bit each: there the surface has a choice.
    pub fn ambiguous_faces(&self, inside: u32) -> u32 {
        let is_ambiguous = |face: &[u8]| {
            let n = face.len();
            let is_inside = |i: usize| inside >> face[i % n] & 1 != 0;
            (0..n).filter(|&i| is_inside(i) != is_inside(i + 1)).count() > 2
        };
        self.crossed_faces(inside).fold(0, |set, f| set | u32::from(is_ambiguous(&self.faces()[f])) << f)
    }

    /// The faces with corners on both sides.
    fn crossed_faces(&self, inside: u32) -> impl Iterator<Item = usize> {
        let is_crossed = move |corners: u32| !matches!(inside & corners, 0) && inside & corners != corners;
        self.corners_of_face()
            .iter()
            .enumerate()
            .filter(move |&(_, &corners)| is_crossed(corners))
            .map(|(f, _)| f)
    }

    /// Hands out the arcs of a face; see [`arcs`](Self::arcs).
    fn each_arc(&self, face: usize, inside: u32, joined: bool, mut take: impl FnMut([u8; 2])) {
        let (corners, edges) = (&self.faces()[face], &self.face_edges()[face]);
        let n = corners.len();
        let is_inside = |i: usize| inside >> corners[i % n] & 1 != 0;
        // An edge where a run of inside corners begins, and the one where that run, or the one before it, ends.
        let ends = |i: usize| is_inside(i) && !is_inside(i + 1);
        for begin in (0..n).filter(|&i| !is_inside(i) && is_inside(i + 1)) {
            let mut ahead = begin + 1..begin + n;
            let end = if joined { ahead.rfind(|&i| ends(i)) } else { ahead.find(|&i| ends(i)) };
            take([edges[begin], edges[end.expect("a run ends") % n]]);
        }
    }

    /// The arcs of a face, each from one of its edges to another, with the inside on the left seen from outside the cell.
    ///
    /// With `joined`, inside corners of an ambiguous face are one region of it, otherwise as many as there are runs of them.
    pub fn arcs(&self, face: usize, inside: u32, joined: bool) -> Vec<[u8; 2]> {
        let mut arcs = Vec::new();
        self.each_arc(face, inside, joined, |arc| arcs.push(arc));
        arcs
    }

    /// The loops of crossed edges round the cell, counter-clockwise seen from outside the surface, each beginning with its
    /// lowest edge, in order. `joined` has one bit a face; those of unambiguous faces do nothing.
    pub fn loops(&self, inside: u32, joined: u32) -> Vec<Vec<u8>> {
        let mut loops = Loops::default();
        self.find_loops(inside, joined, &mut loops);
        loops.iter().map(|steps| steps.iter().map(|step| step.edge).collect()).collect()
    }

    /// The same into `loops`, which are used again.
    pub fn find_loops(&self, inside: u32, joined: u32, loops: &mut Loops) {
        let mut next = [Step { edge: NONE, face: NONE }; MOST_EDGES];
        for face in self.crossed_faces(inside) {
            self.each_arc(face, inside, joined >> face & 1 != 0, |[from, to]| {
                next[usize::from(from)] = Step { edge: to, face: face as u8 };
            });
        }
        let Loops { steps, ends } = loops;
        steps.clear();
        ends.clear();
        for first in 0..self.edges().len() {
            let mut edge = first as u8;
            while next[usize::from(edge)].edge != NONE {
                let Step { edge: following, face } = next[usize::from(edge)];
                next[usize::from(edge)].edge = NONE;
                steps.push(Step { edge, face });
                edge = following;
            }
            if steps.len() > ends.last().copied().unwrap_or(0) {
                ends.push(steps.len());
            }
        }
    }
}
