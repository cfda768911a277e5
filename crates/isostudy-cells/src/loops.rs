//! Face rules: where the surface crosses the faces of a cell, and the loops that the crossings make round it.

use crate::cell::Cell;

impl Cell {
    /// The faces whose corners change sides more than twice, one bit each: there the surface has a choice.
    pub fn ambiguous_faces(&self, inside: u32) -> u32 {
        let is_ambiguous = |face: &Vec<u8>| {
            let n = face.len();
            let is_inside = |i: usize| inside >> face[i % n] & 1 != 0;
            (0..n).filter(|&i| is_inside(i) != is_inside(i + 1)).count() > 2
        };
        self.faces().iter().enumerate().fold(0, |set, (f, face)| set | u32::from(is_ambiguous(face)) << f)
    }

    /// The arcs of a face, each from one of its edges to another, with the inside on the left seen from outside the cell.
    ///
    /// With `joined`, inside corners of an ambiguous face are one region of it, otherwise as many as there are runs of them.
    pub fn arcs(&self, face: usize, inside: u32, joined: bool) -> Vec<[u8; 2]> {
        let (corners, edges) = (&self.faces()[face], &self.face_edges()[face]);
        let n = corners.len();
        let is_inside = |i: usize| inside >> corners[i % n] & 1 != 0;
        // An edge where a run of inside corners begins, and the one where that run, or the one before it, ends.
        let begins = (0..n).filter(|&i| !is_inside(i) && is_inside(i + 1));
        let ends = |i: usize| is_inside(i) && !is_inside(i + 1);
        begins
            .map(|begin| {
                let ahead = (begin + 1..begin + n).find(|&i| ends(i)).expect("a run ends");
                let behind = (begin + 1..begin + n).rev().find(|&i| ends(i)).expect("a run ends");
                let end = if joined { behind } else { ahead };
                [edges[begin], edges[end % n]]
            })
            .collect()
    }

    /// The loops of crossed edges round the cell, counter-clockwise seen from outside the surface, each beginning with its
    /// lowest edge, in order. `joined` has one bit a face; those of unambiguous faces do nothing.
    pub fn loops(&self, inside: u32, joined: u32) -> Vec<Vec<u8>> {
        let mut next = vec![None; self.edges().len()];
        for face in 0..self.faces().len() {
            for [from, to] in self.arcs(face, inside, joined >> face & 1 != 0) {
                next[usize::from(from)] = Some(to);
            }
        }
        let mut loops = Vec::new();
        for first in 0..next.len() {
            let mut polygon = Vec::new();
            let mut edge = first as u8;
            while let Some(following) = next[usize::from(edge)].take() {
                polygon.push(edge);
                edge = following;
            }
            if !polygon.is_empty() {
                loops.push(polygon);
            }
        }
        loops
    }
}
