//! The tables against the written rule, and the finite parts of the argument in docs/manifold.md, enumerated.
//!
//! Names as there: `p` a lattice point, `S` a strict set of its crossings, `w` another direction; V, E and T are the
//! three conditions under which clusters keep the surface.

use std::collections::BTreeSet;

use super::super::link::{BEYOND, Link};
use super::super::{Class, Guard, Partition, shapes};
use crate::lattice::{ALL_DIRECTIONS, Arrangement, DIRECTIONS, DirectionSet, Lattice, Layout, members};
use glam::Vec3;
use isostudy_mesh::Bounds;

const BOTH: [Arrangement; 2] = [Arrangement::BodyCentred, Arrangement::SimpleCubic];

/// The links of both arrangements, inside and at the boundary.
fn all_links() -> impl Iterator<Item = &'static Link> {
    BOTH.into_iter().flat_map(|arrangement| &Guard::get(arrangement).links)
}

fn is_boundary(link: &Link) -> bool {
    link.nodes() >> BEYOND & 1 == 1
}

/// The rule in the words of docs/manifold.md, on lists of offsets and nothing else.
mod written_rule {
    use crate::lattice::Offset;

    pub(super) fn joined(all: &[Offset], a: Offset, b: Offset) -> bool {
        all.contains(&[a[0] - b[0], a[1] - b[1], a[2] - b[2]])
    }

    fn connected(all: &[Offset], set: &[Offset]) -> bool {
        let mut reached = vec![set[0]];
        while let Some(&more) =
            set.iter().find(|o| !reached.contains(o) && reached.iter().any(|&r| joined(all, r, **o)))
        {
            reached.push(more);
        }
        reached.len() == set.len()
    }

    /// Neighbours of `w` in cyclic order.
    pub(super) fn ring(all: &[Offset], w: Offset) -> Vec<Offset> {
        let around: Vec<Offset> = all.iter().copied().filter(|&o| joined(all, o, w)).collect();
        let mut ring = vec![around[0]];
        while let Some(&next) =
            around.iter().find(|o| !ring.contains(o) && joined(all, *ring.last().unwrap(), **o))
        {
            ring.push(next);
        }
        assert!(ring.len() == around.len() && joined(all, ring[0], *ring.last().unwrap()));
        ring
    }

    pub(super) fn is_strict(all: &[Offset], set: &[Offset]) -> bool {
        let rest: Vec<Offset> = all.iter().copied().filter(|o| !set.contains(o)).collect();
        set.len() >= 2
            && connected(all, set)
            && rest.len() >= 3
            && connected(all, &rest)
            && rest.iter().all(|&w| {
                let covered: Vec<bool> = ring(all, w).iter().map(|o| set.contains(o)).collect();
                let changes = (0..covered.len()).filter(|&i| covered[i] != covered[(i + 1) % covered.len()]);
                changes.count() == 2 || !covered.contains(&true)
            })
    }

    /// Whether any of the seven threads is there.
    pub(super) fn has_thread(all: &[Offset], positive: &[Offset], crossing: &[Offset]) -> bool {
        positive.iter().any(|&s| !crossing.contains(&s) && ring(all, s).iter().all(|o| crossing.contains(o)))
    }
}

#[test]
fn class_and_thread_tables_follow_the_written_rule_on_all_masks() {
    for arrangement in BOTH {
        let guard = Guard::get(arrangement);
        let all = &arrangement.directions().offsets[..];
        // 100, 010, 001, 110, 101, 011, 111 of the simple cubic lattice, and their images.
        let positive = match arrangement {
            Arrangement::SimpleCubic => {
                [[2, 0, 0], [0, 2, 0], [0, 0, 2], [2, 2, 0], [2, 0, 2], [0, 2, 2], [2, 2, 2]]
            }
            _ => [[-1, 1, 1], [1, -1, 1], [1, 1, -1], [0, 0, 2], [0, 2, 0], [2, 0, 0], [1, 1, 1]],
        };
        let mut strict_by_size = [0; 15];
        for mask in 0..=ALL_DIRECTIONS {
            let set: Vec<_> = members(mask).map(|d| all[d]).collect();
            let strict = set.len() >= 2 && written_rule::is_strict(all, &set);
            strict_by_size[set.len()] += usize::from(strict);
            let expected = match set.len() {
                0 => Class::Empty,
                1 => Class::One,
                _ if strict => Class::One,
                _ => Class::Ask,
            };
            assert_eq!(guard.class(0, mask), expected, "{arrangement:?} {mask:014b}");
            let thread = written_rule::has_thread(all, &positive, &set);
            assert_eq!(guard.has_thread(mask), thread, "{arrangement:?} {mask:014b}");
            assert_eq!(guard.class(mask, 0b11), if thread { Class::Ask } else { guard.class(0, 0b11) });
        }
        assert_eq!(strict_by_size, [0, 0, 36, 84, 176, 246, 204, 140, 96, 54, 36, 24, 0, 0, 0]);
    }
}

/// Every partition against the rule as written, on all masks of near crossings and some of far ones.
#[test]
fn partitions_follow_the_written_rule() {
    let arrangement = Arrangement::BodyCentred;
    let guard = Guard::get(arrangement);
    let all = &arrangement.directions().offsets[..];
    let strict: Vec<u16> =
        (0..=ALL_DIRECTIONS).filter(|&m| guard.class(0, m) == Class::One && m.count_ones() > 1).collect();
    let rings: Vec<u16> = (0..DIRECTIONS)
        .map(|d| {
            let ring = written_rule::ring(all, all[d]);
            (0..DIRECTIONS).filter(|&e| ring.contains(&all[e])).fold(0, |set, e| set | 1 << e)
        })
        .collect();
    for near in 0..=ALL_DIRECTIONS {
        for salt in 0..3u32 {
            let far = (u32::from(near).wrapping_mul(0x9e37_79b9).rotate_left(7 * salt + 5) >> 9) as u16;
            let crossing = near | if salt == 2 { ALL_DIRECTIONS } else { far & ALL_DIRECTIONS };
            let partition = guard.partition(crossing, near, ALL_DIRECTIONS);
            let threads =
                members(guard.positive & !crossing).map(|d| rings[d]).filter(|r| r & !crossing == 0);
            let blocked = threads.fold(0, |set, ring| set | ring);
            // Islands, by joining members step by step.
            let mut islands: Vec<u16> = members(near).map(|d| 1 << d).collect();
            let pairs = |n: usize| (0..n).flat_map(|i| (0..i).map(move |j| (i, j)));
            let touch = |a: u16, b: u16| members(a).any(|d| rings[d] & b != 0);
            while let Some((i, j)) = pairs(islands.len()).find(|&(i, j)| touch(islands[i], islands[j])) {
                islands[j] |= islands[i];
                islands.swap_remove(i);
            }
            let mut expected: BTreeSet<u16> = BTreeSet::new();
            for island in islands {
                let good = strict.iter().copied().filter(|&core| {
                    core & !island == 0
                        && core & blocked == 0
                        && members(island & !core).all(|w| rings[w] & crossing & !core != 0)
                });
                let core = good.max_by_key(|core| (core.count_ones(), std::cmp::Reverse(*core))).unwrap_or(0);
                expected.extend([core].into_iter().filter(|&core| core != 0));
                expected.extend(members(island & !core).map(|d| 1 << d));
            }
            let sets: BTreeSet<u16> = (0..partition.count)
                .map(|c| (0..DIRECTIONS).filter(|&d| partition.of[d] == c).fold(0, |set, d| set | 1 << d))
                .collect();
            assert_eq!(sets, expected, "near {near:014b} crossing {crossing:014b}");
            if guard.class(crossing, near) == Class::One {
                assert_eq!(partition.count, 1);
            }
        }
    }
}

#[test]
fn one_table_serves_both_lattices() {
    let (body, simple) = (Guard::get(Arrangement::BodyCentred), Guard::get(Arrangement::SimpleCubic));
    let image = Arrangement::SimpleCubic.directions().in_body_centred();
    let map = |set: DirectionSet| members(set).fold(0, |mapped, d| mapped | 1 << image[d]);
    for near in 0..=ALL_DIRECTIONS {
        assert_eq!(simple.class(near, near), body.class(map(near), map(near)));
        assert_eq!(simple.has_thread(near), body.has_thread(map(near)));
        let mut crossing = near;
        for step in 0..4 {
            crossing |= near.wrapping_mul(0x2f35).rotate_left(step * 3) & ALL_DIRECTIONS;
            let (a, b) = (
                simple.partition(crossing, near, ALL_DIRECTIONS),
                body.partition(map(crossing), map(near), ALL_DIRECTIONS),
            );
            for d in 0..DIRECTIONS {
                for e in 0..DIRECTIONS {
                    let same = |p: &Partition, d: usize, e: usize| p.of[d] == p.of[e];
                    assert_eq!(same(&a, d, e), same(&b, image[d] as usize, image[e] as usize));
                }
            }
        }
    }
}

#[test]
fn links_are_spheres_and_those_of_the_lattice() {
    for arrangement in BOTH {
        let links = &Guard::get(arrangement).links;
        assert_eq!(links.len(), if arrangement == Arrangement::BodyCentred { 33 } else { 27 });
        // Points with the same lattice edges have the same triangles: the edges are enough to know.
        let normal = |triangles: &[[u8; 3]]| {
            let turned =
                triangles.iter().map(|&[a, b, c]| [[a, b, c], [b, c, a], [c, a, b]].into_iter().min());
            turned.collect::<BTreeSet<_>>()
        };
        let at_points: Vec<_> = shapes::triangles_at_points(arrangement).into_values().collect();
        for triangles in &at_points {
            let present = triangles.iter().flatten().fold(0u16, |set, d| set | 1 << d);
            let same = at_points
                .iter()
                .filter(|other| other.iter().flatten().fold(0u16, |set, d| set | 1 << d) == present);
            assert!(same.into_iter().all(|other| normal(other) == normal(triangles)));
        }
        for link in links {
            for w in members(link.present()) {
                let ring = link.ring_in_order(w).len();
                let open = link.ring(w) >> BEYOND & 1 == 1;
                assert!(if open { (3..=6).contains(&ring) } else { ring == 4 || ring == 6 }, "{ring}");
            }
            let nodes = members(link.nodes()).count();
            let degrees: usize = members(link.nodes()).map(|w| link.ring(w).count_ones() as usize).sum();
            let rings: usize = members(link.nodes())
                .map(|w| {
                    let ring = link.ring_in_order(w);
                    let set = ring.iter().fold(0u16, |set, u| set | 1 << u);
                    assert_eq!((ring.len(), set), (set.count_ones() as usize, link.ring(w)), "one ring");
                    assert!(ring.len() >= 3);
                    ring.len()
                })
                .sum();
            assert!(link.is_connected_for_tests(link.nodes()));
            // Every edge is in two triangles, and V - E + T = 2: a sphere.
            assert_eq!(6 * nodes + 2 * rings, 3 * degrees + 12, "{:014b}", link.present());
        }
        // The lattice says the same, at each of its points.
        for cells in [1.0, 2.0, 3.0] {
            let bounds = Bounds { min: Vec3::ZERO, max: Vec3::splat(cells) };
            let layout = Layout::new(&Lattice::try_new(arrangement, bounds, 1.0).unwrap());
            let mut seen = BTreeSet::new();
            for z in 0..layout.grid()[2] {
                let kind = layout.kind(z);
                let [nx, ny] = layout.used(kind);
                for (x, y) in (0..nx).flat_map(|x| (0..ny).map(move |y| (x, y))) {
                    seen.insert(layout.incident(kind, [x, y, z]));
                }
            }
            // A centre outside the box on two axes has no lattice edge.
            seen.remove(&0);
            assert!(seen.iter().all(|present| links.iter().any(|link| link.present() == *present)));
            assert!(cells == 1.0 || seen.len() == links.len());
        }
    }
}

/// V: a cluster is a disc, and meets the boundary of the surface in one arc or not at all.
#[test]
fn strict_sets_are_discs() {
    for link in all_links() {
        for set in link.strict_sets() {
            let within = |w: usize| link.ring(w) & set;
            let joins: u32 = members(set).map(|w| within(w).count_ones()).sum::<u32>() / 2;
            let triangles = members(set)
                .map(|w| {
                    let ring = link.ring_in_order(w);
                    (0..ring.len())
                        .filter(|&i| set >> ring[i] & 1 == 1 && set >> ring[(i + 1) % ring.len()] & 1 == 1)
                        .count() as u32
                })
                .sum::<u32>()
                / 3;
            assert_eq!(set.count_ones() + triangles, joins + 1, "{set:014b}");
            if is_boundary(link) {
                let rim = link.ring_in_order(BEYOND as usize);
                let arcs = (0..rim.len())
                    .filter(|&i| set >> rim[i] & 1 == 1 && set >> rim[(i + 1) % rim.len()] & 1 == 0)
                    .count();
                assert!(arcs == 1 || set & link.ring(BEYOND as usize) == 0);
            }
        }
    }
}

/// E, a cluster and a crossing by itself: they meet in one path, of which at most one end is on the boundary.
#[test]
fn a_cluster_meets_a_crossing_in_one_path() {
    for link in all_links() {
        for set in link.strict_sets() {
            for w in members(link.present() & !set) {
                // The crossing on the lattice edge (p, w): the path runs along the ring of w. It has both ends on
                // the boundary if that ring is covered up to the node beyond.
                assert!(set & link.ring(w) != link.ring(w) & ALL_DIRECTIONS, "{set:014b} round {w}");
                // The crossing on a lattice edge (w, o) of the link. Only diagonals lead there if neither w nor o is
                // in the cluster; they start from the two directions that face the edge.
                for o in members(link.ring(w) & link.present() & !set) {
                    let ring = link.ring_in_order(w);
                    let at = ring.iter().position(|&u| u as usize == o).unwrap();
                    let facing = [ring[(at + 1) % ring.len()], ring[(at + ring.len() - 1) % ring.len()]];
                    assert!(facing.iter().any(|&z| set >> z & 1 == 0), "{set:014b} at {w} {o}");
                }
            }
        }
    }
}

/// The surface round one lattice edge (p, q), with ring points 0..k, closed inside the volume and open at its
/// boundary, and clusters P at p and Q at q.
struct RoundAnEdge {
    k: usize,
    closed: bool,
    /// Ring points on the side of p; bit k for q itself.
    with_p: usize,
    /// Which way each four-sided piece is cut.
    diagonals: usize,
    in_p: BTreeSet<Crossing>,
    in_q: BTreeSet<Crossing>,
}

/// A lattice edge by its ends: ring points, then p, then q.
type Crossing = (usize, usize);

impl RoundAnEdge {
    fn triangles(&self) -> Vec<[Crossing; 3]> {
        let (p, q) = (self.k, self.k + 1);
        let is_with_p = |v: usize| {
            v == p || if v == q { self.with_p >> self.k & 1 == 1 } else { self.with_p >> v & 1 == 1 }
        };
        let edge = |a: usize, b: usize| (a.min(b), a.max(b));
        let mut triangles = Vec::new();
        for i in 0..self.k - usize::from(!self.closed) {
            let corners = [p, q, i, (i + 1) % self.k];
            let (here, there): (Vec<usize>, Vec<usize>) = corners.into_iter().partition(|&v| is_with_p(v));
            match (&here[..], &there[..]) {
                (&[a], &[b, c, d]) | (&[b, c, d], &[a]) => {
                    triangles.push([edge(a, b), edge(a, c), edge(a, d)])
                }
                (&[a, b], &[c, d]) => {
                    let quad = [edge(a, c), edge(a, d), edge(b, d), edge(b, c)];
                    let turn = self.diagonals >> i & 1;
                    triangles.push([quad[turn], quad[turn + 1], quad[turn + 2]]);
                    triangles.push([quad[turn], quad[turn + 2], quad[(turn + 3) % 4]]);
                }
                _ => {}
            }
        }
        triangles
    }

    /// Whether P and Q meet in one path, of which at most one end is on the boundary, or not at all.
    fn holds(&self) -> bool {
        let triangles = self.triangles();
        let contact = |a: Crossing, b: Crossing| {
            (self.in_p.contains(&a) && self.in_q.contains(&b)
                || self.in_p.contains(&b) && self.in_q.contains(&a))
            .then_some((a.min(b), a.max(b)))
        };
        let contacts = |t: &[Crossing; 3]| -> Vec<_> {
            [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])]
                .into_iter()
                .filter_map(|(a, b)| contact(a, b))
                .collect()
        };
        let edges: BTreeSet<_> = triangles.iter().flat_map(contacts).collect();
        let links: Vec<_> = triangles.iter().map(contacts).filter(|c| c.len() == 2).collect();
        // Components, by the links between edges; a path has one edge more than links.
        let mut reached: BTreeSet<_> = edges.iter().take(1).copied().collect();
        while let Some(more) = links.iter().find(|l| reached.contains(&l[0]) != reached.contains(&l[1])) {
            reached.extend(more.iter().copied());
        }
        let on_boundary = |edge: &(Crossing, Crossing)| {
            // In one triangle only, and on a lattice triangle (p, q, first or last).
            let corners: BTreeSet<usize> = [edge.0.0, edge.0.1, edge.1.0, edge.1.1].into_iter().collect();
            !self.closed
                && corners.len() == 3
                && (corners.contains(&0) || corners.contains(&(self.k - 1)))
                && corners.contains(&self.k)
                && corners.contains(&(self.k + 1))
        };
        edges.is_empty()
            || reached.len() == edges.len()
                && links.len() + 1 == edges.len()
                && edges.iter().filter(|edge| on_boundary(edge)).count() <= 1
    }
}

/// Contiguous runs of ring points, the empty one and all included.
fn runs(k: usize, closed: bool) -> Vec<usize> {
    (0..1 << k)
        .filter(|set: &usize| {
            let starts = (0..k).filter(|&i| {
                let before = if i > 0 {
                    set >> (i - 1) & 1
                } else if closed {
                    set >> (k - 1) & 1
                } else {
                    0
                };
                set >> i & 1 == 1 && before == 0
            });
            starts.count() <= 1
        })
        .collect()
}

/// E, two clusters, over all lengths of ring, sides of its points, runs and diagonals.
#[test]
fn clusters_meet_in_one_path() {
    let (mut tried, mut full_rings) = (0, 0);
    // Body-centred rings at the boundary have 2 or 3 points and more, simple cubic ones 2 to 4.
    for (k, closed) in [(4, true), (6, true), (2, false), (3, false), (4, false), (5, false)] {
        let all = (1 << k) - 1;
        let (p, q) = (k, k + 1);
        let spokes =
            |end: usize, set: usize| (0..k).filter(move |i| set >> i & 1 == 1).map(move |i| (i, end));
        for (with_p, diagonals) in (0..2 << k).flat_map(|w| (0..1usize << k).map(move |d| (w, d))) {
            let same_side = with_p >> k & 1 == 1;
            // Crossings of p, and of q, on the ring.
            let (from_p, from_q) = (all & !with_p, if same_side { all & !with_p } else { all & with_p });
            for a in (0..=all).filter(|a| a & !from_p == 0) {
                for b in runs(k, closed).into_iter().filter(|b| b & !from_q == 0) {
                    let clusters = |middle: Option<usize>| RoundAnEdge {
                        k,
                        closed,
                        with_p,
                        diagonals,
                        in_p: spokes(p, a).chain((middle == Some(p)).then_some((p, q))).collect(),
                        in_q: spokes(q, b).chain((middle == Some(q)).then_some((p, q))).collect(),
                    };
                    let a_is_run = runs(k, closed).contains(&a);
                    if same_side {
                        if !a_is_run {
                            continue;
                        }
                        // (c) and, at the boundary, the lemma above: not the whole ring. Thread rule: the whole ring
                        // may be on the other side, but then one of the two clusters stays away from it.
                        let covers = |set: usize| set == all;
                        if covers(a) || covers(b) {
                            continue;
                        }
                        let thread = closed && from_p == all && a != 0 && b != 0;
                        full_rings += u32::from(thread && !clusters(None).holds());
                        assert!(thread || clusters(None).holds(), "{k} {closed} {with_p:b} {a:b} {b:b}");
                    } else {
                        // The crossing (p, q) belongs to p, to its cluster or by itself; (c) at q. The cluster that
                        // it is in may cover its ring in any way.
                        if b != all {
                            assert!(clusters(Some(p)).holds(), "{k} {closed} {with_p:b} {a:b} {b:b}");
                        }
                        // By itself: (c) at p too, and (d): a crossing of p on the ring is left out, inside.
                        if a_is_run && a != all && b != all && (!closed || from_p & !a != 0 || a == 0) {
                            assert!(clusters(None).holds(), "alone: {k} {closed} {with_p:b} {a:b} {b:b}");
                        }
                    }
                    tried += 1;
                }
            }
        }
    }
    assert!(tried > 10_000 && full_rings > 0, "{tried} {full_rings}: without the thread rule it fails");
}

/// T: a closed component round one lattice point has four vertices or more. Round two points there are 26 crossings
/// and more, round three 36: too many for three clusters of eleven.
#[test]
fn a_lone_point_keeps_four_vertices() {
    for arrangement in BOTH {
        for near in 0..=ALL_DIRECTIONS {
            let partition = Guard::get(arrangement).partition(ALL_DIRECTIONS, near, ALL_DIRECTIONS);
            // What is not near is by itself: its other end sees no other crossing of this component.
            assert!(u32::from(partition.count) + 14 - near.count_ones() >= 4, "{near:014b}");
        }
        let links = arrangement.directions().links;
        // Any three points have at most three lattice edges between them, two have one: 14n - 2e crossings.
        assert!(links.iter().all(|l| l.count_ones() >= 4));
        let largest = Guard::get(arrangement)
            .links
            .iter()
            .flat_map(|link| link.strict_sets().into_iter().map(|set| set.count_ones()).max());
        assert_eq!(largest.max(), Some(11));
    }
}
