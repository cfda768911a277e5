//! The triangles of every cell there can be: by signs, by what its ambiguous faces join, and by the tunnel it has.

use std::sync::OnceLock;

use isostudy_cells::{Cell, EdgeGroups, Triangulator};

use super::tubes::{Corner, INNER, band};
use super::tunnel::{SQUARES, joined_regions};
use super::{Diagonals, Faces, Rule, exact};

/// The most triangles of a patch, for room.
pub(super) const MOST_TRIANGLES: usize = 32;

/// The surface in a cell.
#[derive(Debug, Clone)]
pub(super) struct Patch {
    /// Corners are crossed edges, or from [`INNER`] on vertices in the cell.
    pub(super) triangles: Vec<[Corner; 3]>,
    /// Of each vertex in the cell, the edges whose crossings it is the mean of.
    pub(super) inner: Vec<Vec<u8>>,
    /// The edges that are crossed.
    pub(super) crossed: Vec<u8>,
    /// Polygons whose diagonals the samples may choose, where the rule says so; their triangles come after the others.
    pub(super) polygons: Vec<Vec<u8>>,
}

/// Signs, and what ambiguous faces join.
#[derive(Debug)]
struct Entry {
    /// Without a tunnel.
    plain: u16,
    /// By the regions that a tunnel joins.
    tunnels: Vec<([u8; 2], u16)>,
    /// Of each corner, the lowest corner of its region of the cell's surface.
    regions: [u8; 8],
}

/// All patches of one choice of diagonals.
pub(super) struct Patches {
    patches: Vec<Patch>,
    entries: Vec<Entry>,
    /// By signs, then by set of joined faces.
    index: Vec<[u16; 64]>,
    /// By signs, the patch without a tunnel where no ambiguous face is joined, and where all are.
    by_signs: [[u16; 256]; 2],
    /// Of each patch, how many vertices it has in the cell.
    inner: Vec<u8>,
    /// By signs, whether there is nothing to decide.
    is_plain: Vec<bool>,
    /// By signs, the ambiguous faces, numbered as [`SQUARES`] are.
    ambiguous: Vec<u8>,
    edges: [(u8, u8); 12],
    triangulator: Triangulator,
}

impl Patches {
    /// Those of a rule, made when they are first asked for.
    pub(super) fn get(rule: Rule) -> &'static Self {
        static PATCHES: [OnceLock<Patches>; 3] = [const { OnceLock::new() }; 3];
        PATCHES[rule.diagonals as usize].get_or_init(|| Self::new(rule.diagonals))
    }

    fn new(diagonals: Diagonals) -> Self {
        let cube = Cell::cube();
        let triangulator = Triangulator::new(&cube);
        // The cell's number of each of the squares.
        let face_of: [usize; 6] = std::array::from_fn(|s| {
            let mut wanted = SQUARES[s].corners;
            wanted.sort_unstable();
            let is_it = |face: &Vec<u8>| {
                let mut corners = face.clone();
                corners.sort_unstable();
                corners == wanted
            };
            cube.faces().iter().position(is_it).expect("squares are faces")
        });
        let groups = (diagonals == Diagonals::EdgeGroups).then(|| EdgeGroups::new(&cube));
        let maker = Maker { cube: &cube, triangulator: &triangulator, groups, diagonals };
        let mut made = Self {
            patches: Vec::new(),
            entries: Vec::new(),
            index: vec![[0; 64]; 256],
            by_signs: [[0; 256]; 2],
            inner: Vec::new(),
            is_plain: Vec::new(),
            ambiguous: Vec::new(),
            edges: std::array::from_fn(|e| {
                let [low, high] = cube.edges()[e];
                (low, (low ^ high).trailing_zeros() as u8)
            }),
            triangulator: triangulator.clone(),
        };
        for inside in 0..256 {
            let faces = cube.ambiguous_faces(inside);
            let ambiguous: u8 = (0..6).fold(0, |set, s| set | (faces >> face_of[s] & 1) << s) as u8;
            made.ambiguous.push(ambiguous);
            for joined in 0..64u8 {
                if joined & !ambiguous != 0 {
                    continue;
                }
                let of_cell = (0..6).fold(0, |set, s| set | u32::from(joined >> s & 1) << face_of[s]);
                let loops = cube.loops(inside, of_cell);
                let regions = regions(&cube, inside, of_cell);
                let sides_of = |polygon: &[u8]| {
                    let [a, b] = cube.edges()[usize::from(polygon[0])].map(|c| regions[usize::from(c)]);
                    [a, b]
                };
                let mut entry =
                    Entry { plain: made.add(maker.patch(&loops, None)), tunnels: Vec::new(), regions };
                for one in 0..loops.len() {
                    for other in one + 1..loops.len() {
                        let (p, q) = (sides_of(&loops[one]), sides_of(&loops[other]));
                        // The tube has one region on its other side, between the two it joins.
                        let Some(&common) = p.iter().find(|region| q.contains(region)) else { continue };
                        let [a, b] = [p, q].map(|r| if r[0] == common { r[1] } else { r[0] });
                        let patch = made.add(maker.patch(&loops, Some([one, other])));
                        entry.tunnels.push(([a.min(b), a.max(b)], patch));
                    }
                }
                made.index[inside as usize][usize::from(joined)] = made.entries.len() as u16;
                made.entries.push(entry);
            }
            let all = usize::from(ambiguous);
            let index = made.index[inside as usize];
            made.is_plain.push(all == 0 && made.entries[usize::from(index[0])].tunnels.is_empty());
            let plain = [0, all].map(|joined| made.entries[usize::from(index[joined])].plain);
            (made.by_signs[0][inside as usize], made.by_signs[1][inside as usize]) = (plain[0], plain[1]);
        }
        made
    }

    fn add(&mut self, patch: Patch) -> u16 {
        self.inner.push(patch.inner.len() as u8);
        self.patches.push(patch);
        (self.patches.len() - 1) as u16
    }

    /// The triangles of all patterns where signs decide them, by corners inside; `None` where samples do, or need a vertex in a cell.
    pub(super) fn by_signs(&self, faces: Faces) -> Option<Vec<Vec<[u8; 3]>>> {
        let is_decided = matches!(faces, Faces::SeparateInside | Faces::JoinInside);
        let patch = |inside| self.at(self.choose(faces, inside, 0.0, || unreachable!("signs say all")));
        let is_whole = |patch: &Patch| patch.polygons.is_empty() && patch.inner.is_empty();
        (is_decided && (0..=255).all(|inside| is_whole(patch(inside))))
            .then(|| (0..=255).map(|inside| patch(inside).triangles.clone()).collect())
    }

    pub(super) fn at(&self, number: u16) -> &Patch {
        &self.patches[usize::from(number)]
    }

    /// How many vertices a patch has in the cell.
    #[inline]
    pub(super) fn inner(&self, number: u16) -> u8 {
        self.inner[usize::from(number)]
    }

    /// The corner that an edge begins at, and its axis.
    #[inline]
    pub(super) fn edge(&self, edge: u8) -> (u8, u8) {
        self.edges[usize::from(edge)]
    }

    pub(super) fn triangulator(&self) -> &Triangulator {
        &self.triangulator
    }

    /// The patch of a cell. `values` are asked for where signs do not say everything.
    #[inline]
    pub(super) fn choose(
        &self,
        faces: Faces,
        inside: u8,
        isovalue: f32,
        values: impl FnOnce() -> [f32; 8],
    ) -> u16 {
        let [apart, joined] = [0, 1].map(|all| self.by_signs[all][usize::from(inside)]);
        match faces {
            Faces::SeparateInside => apart,
            Faces::JoinInside => joined,
            Faces::Decider if self.ambiguous[usize::from(inside)] == 0 => apart,
            Faces::Trilinear if self.is_plain[usize::from(inside)] => apart,
            Faces::Decider | Faces::Trilinear => self.decide(faces, inside, isovalue, values()),
        }
    }

    #[inline(never)]
    fn decide(&self, faces: Faces, inside: u8, isovalue: f32, values: [f32; 8]) -> u16 {
        let ambiguous = self.ambiguous[usize::from(inside)];
        let mut joined = 0;
        for (s, square) in SQUARES.iter().enumerate().filter(|(s, _)| ambiguous >> s & 1 != 0) {
            let [a, b, c, d] = square.corners;
            let round = if inside >> a & 1 != 0 { [a, b, c, d] } else { [b, c, d, a] };
            let is_joined = exact::is_joined(round.map(|c| values[usize::from(c)]), isovalue);
            joined |= usize::from(is_joined) << s;
        }
        let entry = &self.entries[usize::from(self.index[usize::from(inside)][joined])];
        if faces == Faces::Decider || entry.tunnels.is_empty() {
            return entry.plain;
        }
        let tunnel = joined_regions(values, isovalue, &entry.regions, |s| joined >> s & 1 != 0);
        let known = |regions: [u8; 2]| entry.tunnels.iter().find(|(r, _)| *r == regions);
        tunnel.and_then(known).map_or(entry.plain, |&(_, patch)| patch)
    }
}

/// Corners by region of the cell's surface.
fn regions(cube: &Cell, inside: u32, joined: u32) -> [u8; 8] {
    let mut regions: [u8; 8] = std::array::from_fn(|c| c as u8);
    let is_inside = |c: u8| inside >> c & 1 != 0;
    let mut join = |a: u8, b: u8| {
        let [a, b] = [a, b].map(|c| regions[usize::from(c)]);
        regions.iter_mut().filter(|r| **r == a.max(b)).for_each(|r| *r = a.min(b));
    };
    for &[a, b] in cube.edges() {
        if is_inside(a) == is_inside(b) {
            join(a, b);
        }
    }
    let ambiguous = cube.ambiguous_faces(inside);
    for (f, face) in cube.faces().iter().enumerate().filter(|(f, _)| ambiguous >> f & 1 != 0) {
        let first = usize::from(is_inside(face[0]) != (joined >> f & 1 != 0));
        join(face[first], face[first + 2]);
    }
    regions
}

/// Makes patches.
struct Maker<'a> {
    cube: &'a Cell,
    triangulator: &'a Triangulator,
    groups: Option<EdgeGroups>,
    diagonals: Diagonals,
}

impl Maker<'_> {
    /// A disc on each loop, but for two that a tube joins.
    fn patch(&self, loops: &[Vec<u8>], tube: Option<[usize; 2]>) -> Patch {
        let mut patch =
            Patch { triangles: Vec::new(), inner: Vec::new(), crossed: Vec::new(), polygons: Vec::new() };
        patch.crossed = loops.iter().flatten().copied().collect();
        patch.crossed.sort_unstable();
        if let Some([one, other]) = tube {
            self.tube(&loops[one], &loops[other], &mut patch);
        }
        let in_tube = |l: usize| tube.is_some_and(|tube| tube.contains(&l));
        for (_, polygon) in loops.iter().enumerate().filter(|(l, _)| !in_tube(*l)) {
            let triangles = match (&self.groups, self.diagonals) {
                (Some(groups), _) => self.triangulator.cheapest(polygon, |t| cost(groups, t)),
                (None, _) => self.triangulator.fan(polygon),
            };
            match triangles {
                Some(_) if self.diagonals == Diagonals::Quality && polygon.len() > 3 => {
                    patch.polygons.push(polygon.clone());
                }
                Some(triangles) => patch.triangles.extend(triangles),
                None => {
                    // Every diagonal lies in a face: a vertex in the cell instead.
                    let centre = INNER + patch.inner.len() as u8;
                    patch.inner.push(polygon.clone());
                    let n = polygon.len();
                    patch.triangles.extend((0..n).map(|i| [polygon[i], polygon[(i + 1) % n], centre]));
                }
            }
        }
        patch
    }

    /// A band between the loops; where each has a rung in a face, two bands with a ring of vertices in the cell between them.
    fn tube(&self, one: &[u8], other: &[u8], patch: &mut Patch) {
        let squared = |a: u8, b: u8| self.squared(&[a], &[b]);
        let may_join = |a: u8, b: u8| self.triangulator.may_join(a, b);
        if let Some(triangles) = band(one, other, may_join, squared) {
            patch.triangles.extend(triangles);
            return;
        }
        // Three thirds of each loop, which run opposite ways, put together as near as may be.
        let third = |polygon: &[u8], k: usize| {
            let n = polygon.len();
            polygon[k * n / 3..(k + 1) * n / 3].to_vec()
        };
        let ahead: Vec<Vec<u8>> = (0..3).map(|k| third(one, k)).collect();
        let shifted = |shift: usize| {
            let mut back: Vec<u8> = other.iter().rev().copied().collect();
            back.rotate_left(shift);
            (0..3).map(|k| third(&back, k)).collect::<Vec<_>>()
        };
        let apart = |back: &[Vec<u8>]| (0..3).map(|k| self.squared(&ahead[k], &back[k])).sum::<f64>();
        let back = (0..other.len())
            .map(shifted)
            .min_by(|p, q| apart(p).total_cmp(&apart(q)))
            .expect("a loop has corners");
        let first = INNER + patch.inner.len() as u8;
        patch.inner.extend((0..3).map(|k| [&ahead[k][..], &back[k][..]].concat()));
        let ring: Vec<u8> = (first..first + 3).collect();
        let backwards: Vec<u8> = ring.iter().rev().copied().collect();
        let inner = patch.inner.clone();
        let members = |c: u8| match c.checked_sub(INNER) {
            Some(vertex) => inner[usize::from(vertex)].clone(),
            None => vec![c],
        };
        let squared = |a: u8, b: u8| self.squared(&members(a), &members(b));
        // Seen from the first loop the ring runs against it, seen from the second against that.
        for (polygon, ring) in [(one, &backwards), (other, &ring)] {
            let triangles = band(polygon, ring, |_, _| true, squared);
            patch.triangles.extend(triangles.expect("no rung to a vertex in the cell lies in a face"));
        }
    }

    /// The squared distance between the means of edges' middles.
    fn squared(&self, one: &[u8], other: &[u8]) -> f64 {
        let mean = |edges: &[u8], axis: usize| {
            let ends = edges.iter().flat_map(|&e| self.cube.edges()[usize::from(e)]);
            ends.map(|c| f64::from(self.cube.corners()[usize::from(c)][axis])).sum::<f64>()
                / (2 * edges.len()) as f64
        };
        (0..3).map(|axis| mean(one, axis) - mean(other, axis)).map(|d| d * d).sum()
    }
}

/// First the bad kind, then the expected quality.
fn cost(groups: &EdgeGroups, triangle: [u8; 3]) -> f64 {
    let bad = if groups.is_path(triangle) { 100.0 } else { 0.0 };
    bad + 1.0 - groups.expected_quality(triangle)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    const ALL: [Diagonals; 3] = [Diagonals::Fan, Diagonals::EdgeGroups, Diagonals::Quality];

    fn patches(diagonals: Diagonals) -> &'static Patches {
        Patches::get(Rule { faces: Faces::Trilinear, diagonals })
    }

    /// Every patch with the signs and the joined faces that it is for.
    fn each(diagonals: Diagonals, mut check: impl FnMut(u32, u32, &Patch, bool)) {
        let made = patches(diagonals);
        let cube = Cell::cube();
        for inside in 0..256u32 {
            for joined in
                (0..64usize).filter(|joined| joined & !usize::from(made.ambiguous[inside as usize]) == 0)
            {
                let faces = SQUARES.iter().enumerate().filter(|(s, _)| joined >> s & 1 != 0);
                let of_cell = faces.fold(0, |set, (_, square)| {
                    let is_it = |face: &Vec<u8>| square.corners.iter().all(|c| face.contains(c));
                    set | 1 << cube.faces().iter().position(is_it).unwrap()
                });
                let entry = &made.entries[usize::from(made.index[inside as usize][joined])];
                check(inside, of_cell, made.at(entry.plain), false);
                for &(_, patch) in &entry.tunnels {
                    check(inside, of_cell, made.at(patch), true);
                }
            }
        }
    }

    /// A patch is a manifold whose rim is the arcs in the faces, and neither an edge nor a triangle of its inside lies in a face.
    #[test]
    fn patches_fill_their_loops() {
        let cube = Cell::cube();
        for diagonals in ALL {
            each(diagonals, |inside, joined, patch, has_tube| {
                let mut triangles = patch.triangles.clone();
                for polygon in &patch.polygons {
                    triangles.extend(patches(diagonals).triangulator.fan(polygon).unwrap());
                }
                assert!(triangles.len() <= MOST_TRIANGLES);
                let sides: Vec<[u8; 2]> =
                    triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
                let set: BTreeSet<[u8; 2]> = sides.iter().copied().collect();
                assert_eq!(set.len(), sides.len(), "a side is run twice the same way");
                let rim: BTreeSet<[u8; 2]> =
                    set.iter().copied().filter(|&[a, b]| !set.contains(&[b, a])).collect();
                let arcs: BTreeSet<[u8; 2]> =
                    (0..6).flat_map(|face| cube.arcs(face, inside, joined >> face & 1 != 0)).collect();
                assert_eq!(rim, arcs);
                for &[a, b] in set.difference(&rim) {
                    let is_inner = a >= INNER || b >= INNER;
                    let faces = |e: u8| cube.faces_at_edge()[usize::from(e)];
                    assert!(is_inner || faces(a) & faces(b) == 0, "{inside:08b} {joined:06b}: {a} {b}");
                }
                // Euler characteristic: a disc a loop, and a tube for two of them.
                let loops = cube.loops(inside, joined).len() as i32;
                let points = patch.crossed.len() + patch.inner.len();
                let edges = (sides.len() + rim.len()) / 2;
                let euler = points as i32 - edges as i32 + triangles.len() as i32;
                assert_eq!(euler, loops - 2 * i32::from(has_tube), "{inside:08b} {joined:06b}");
                // Round a vertex in the cell the triangles are one ring.
                for v in 0..patch.inner.len() as u8 {
                    let spokes = sides.iter().filter(|[from, _]| *from == INNER + v).count();
                    assert!(spokes >= 3);
                }
            });
        }
    }

    #[test]
    fn the_tables_have_the_known_numbers_of_triangles() {
        let groups = EdgeGroups::new(&Cell::cube());
        for (diagonals, bad) in [(Diagonals::Fan, None), (Diagonals::EdgeGroups, Some(56))] {
            let made = patches(diagonals);
            for faces in [Faces::SeparateInside, Faces::JoinInside] {
                let of =
                    |inside: u8| made.at(made.choose(faces, inside, 0.0, || panic!("no sample is needed")));
                let all: Vec<[u8; 3]> = (0..=255).flat_map(|inside| of(inside).triangles.clone()).collect();
                assert_eq!(all.len(), 820);
                assert!((0..=255).all(|inside| of(inside).inner.is_empty()));
                if let Some(bad) = bad {
                    assert_eq!(all.into_iter().filter(|&t| groups.is_path(t)).count(), bad);
                }
            }
        }
    }
}
