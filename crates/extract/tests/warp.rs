//! Warp clustering against the boundary of the published tetrahedra, its angles, and what it promises.

mod fields;

use std::collections::{HashMap, HashSet};

use extract::{
    Arrangement, BoxGrid, CellBox, ChunkExtractor, ChunkSettings, Clustering, Execution, ExtractError,
    ExtractSettings, Extractor, Lattice, Method, Placement, Positions, Source, Tetrahedra, Topology, extract,
    weld_chunks,
};
use field::{Asteroid, Sphere, StudyField};
use fields::{FAMILIES, Family, Numbers, Volume};
use glam::{DVec3, Vec3};
use mesh::{Bounds, TriangleMesh};

const ONE: Execution = Execution { threads: 1 };
const WARP: ExtractSettings = ExtractSettings {
    isovalue: 0.0,
    clustering: Clustering::Warp,
    topology: Topology::Guarded,
    positions: Positions::Indexed,
    placement: Placement::MeanOfCrossings,
    refine_crossings: false,
    edge_clamp: 0.0,
};
/// As published: of edges between two centres or two corners, and of the others.
const ALPHA: [f64; 2] = [0.24999, 0.41189];

type Place = [i32; 3];
/// A lattice edge: what names a crossing.
type Name = [Place; 2];

/// To the fourteen neighbours, in half cells.
fn offsets() -> Vec<Place> {
    let axes =
        (0..3).flat_map(|axis| [2, -2].map(|step| std::array::from_fn(|a| if a == axis { step } else { 0 })));
    let diagonals = (0..8).map(|c| std::array::from_fn(|a| if c >> a & 1 == 0 { 1 } else { -1 }));
    axes.chain(diagonals).collect()
}

fn plus(p: Place, q: Place) -> Place {
    std::array::from_fn(|a| p[a] + q[a])
}

fn alpha(offset: Place) -> f64 {
    ALPHA[usize::from(!offset.contains(&0))]
}

fn mesh_of(volume: &Volume, settings: &ExtractSettings) -> TriangleMesh {
    extract(volume, &volume.lattice(), settings, &ONE).unwrap().mesh
}

/// The rules by brute force, on a volume that is outside at its box, with no two samples alike there: names of what the boundary of the tetrahedra has.
struct Stuffing {
    volume: Volume,
    last: i32,
    /// By name, where it is.
    crossings: HashMap<Name, DVec3>,
    /// The crossing that a warped point is moved to.
    warped: HashMap<Place, Name>,
}

impl Stuffing {
    fn of(volume: Volume) -> Self {
        let last = 2 * volume.cells as i32;
        let mut this = Self { volume, last, crossings: HashMap::new(), warped: HashMap::new() };
        let range = -1..=last + 1;
        for (x, y, z) in range.clone().flat_map(|x| {
            let range = range.clone();
            range.clone().flat_map(move |y| range.clone().map(move |z| (x, y, z)))
        }) {
            let place = [x, y, z];
            let odd = place.iter().filter(|c| *c % 2 != 0).count();
            if odd == 0 || odd == 3 {
                this.look(place);
            }
        }
        this
    }

    fn value(&self, place: Place) -> f64 {
        f64::from(self.volume.sample(self.position(place).as_vec3()))
    }

    /// Outermost centres lie on the box.
    fn position(&self, place: Place) -> DVec3 {
        DVec3::from_array(place.map(|c| f64::from(c.clamp(0, self.last)) / 2.0))
    }

    fn look(&mut self, place: Place) {
        let here = self.value(place);
        let mut nearest: Option<(f64, Name)> = None;
        for offset in offsets() {
            let other = plus(place, offset);
            let there = self.value(other);
            if (here > 0.0) == (there > 0.0) {
                continue;
            }
            let share = here / (here - there);
            let name = [place.min(other), place.max(other)];
            let at = self.position(place).lerp(self.position(other), share);
            self.crossings.insert(name, at);
            if share < alpha(offset) && nearest.is_none_or(|(least, _)| share < least) {
                nearest = Some((share, name));
            }
        }
        if let Some((_, name)) = nearest {
            self.warped.insert(place, name);
        }
    }

    /// All tetrahedra: round each edge between two centres, the four corners round it by pairs.
    fn tetrahedra(&self) -> Vec<[Place; 4]> {
        let odd = || (-1..=self.last + 1).filter(|c| c % 2 != 0);
        let centres = odd().flat_map(move |x| odd().flat_map(move |y| odd().map(move |z| [x, y, z])));
        let centres: Vec<Place> = centres.collect();
        let mut found = Vec::new();
        for centre in centres {
            for axis in 0..3 {
                let mut other = centre;
                other[axis] += 2;
                let ring = [[1, 1], [-1, 1], [-1, -1], [1, -1]].map(|[u, v]| {
                    let mut corner = centre;
                    corner[axis] += 1;
                    corner[(axis + 1) % 3] += u;
                    corner[(axis + 2) % 3] += v;
                    corner
                });
                found.extend((0..4).map(|i| [centre, other, ring[i], ring[(i + 1) % 4]]));
            }
        }
        found
    }

    /// Triangles by their corners' names, and quadrilaterals, which have two ways to be cut.
    fn boundary(&self) -> (HashSet<[Name; 3]>, Vec<[Name; 4]>) {
        let (mut triangles, mut quadrilaterals) = (HashSet::new(), Vec::new());
        for tetrahedron in self.tetrahedra() {
            let of = |keep: &dyn Fn(bool, bool) -> bool| -> Vec<Place> {
                let corners = tetrahedron.into_iter();
                corners.filter(|p| keep(self.value(*p) > 0.0, self.warped.contains_key(p))).collect()
            };
            let inside = of(&|inside, warped| inside && !warped);
            let outside = of(&|inside, warped| !inside && !warped);
            let zero = of(&|_, warped| warped);
            let cut = |p: Place, q: Place| [p.min(q), p.max(q)];
            // There twice, it is inside the solid.
            let mut add = |mut corners: [Name; 3]| {
                corners.sort_unstable();
                if !triangles.insert(corners) {
                    triangles.remove(&corners);
                }
            };
            if zero.len() == 4 && zero.iter().all(|p| self.value(*p) > 0.0) {
                for left_out in 0..4 {
                    let face = (0..4).filter(|i| *i != left_out).map(|i| self.warped[&zero[i]]);
                    add(face.collect::<Vec<_>>().try_into().expect("a face"));
                }
            }
            let mut corners: Vec<Name> = zero.iter().map(|p| self.warped[p]).collect();
            match (&inside[..], &outside[..]) {
                ([_], _) | ([_, _], [_]) | ([_, _, _], [_]) => {
                    corners.extend(inside.iter().flat_map(|&p| outside.iter().map(move |&q| cut(p, q))));
                    add(corners.try_into().expect("a triangle"));
                }
                (&[p, q], &[r, s]) => quadrilaterals.push([cut(p, r), cut(p, s), cut(q, s), cut(q, r)]),
                _ => {}
            }
        }
        (triangles, quadrilaterals)
    }

    fn name(&self, position: Vec3) -> Name {
        let away = |at: &DVec3| at.distance_squared(position.as_dvec3());
        let nearest = self.crossings.iter().min_by(|a, b| away(a.1).total_cmp(&away(b.1))).unwrap();
        assert!(away(nearest.1) < 1e-8, "{position} is no crossing");
        *nearest.0
    }
}

/// Triangle by triangle, whatever the samples. Tetrahedra are as published, and those of four points that were inside, all warped.
#[test]
fn the_mesh_is_the_boundary_of_the_tetrahedra() {
    let families = [
        Family::White,
        Family::LowPassOnce,
        Family::Spheres,
        Family::ThinShell,
        Family::Gyroid,
        Family::NoisyMagnitudes,
    ];
    let (mut warped, mut cut) = (0, 0);
    for (family, seed) in families.into_iter().flat_map(|family| [(family, 1), (family, 2), (family, 3)]) {
        let mut volume = Volume::random(Arrangement::BodyCentred, 5, family, seed).closed();
        // No two alike: of crossings that are equally near to a point, rounding would choose.
        let (last, mut numbers) = (2 * volume.cells as i32, Numbers::new(seed));
        for place in volume.places().into_iter().filter(|p| p.iter().any(|&c| c <= 0 || c >= last)) {
            volume.set(place, -0.3 - numbers.below(1 << 20) as f32 / (1 << 20) as f32);
        }
        let mesh = mesh_of(&volume, &WARP);
        let stuffing = Stuffing::of(volume);
        warped += stuffing.warped.len();
        let names: Vec<Name> = mesh.positions.iter().map(|&p| stuffing.name(p)).collect();
        let sorted = |corners: [Name; 3]| {
            let mut corners = corners;
            corners.sort_unstable();
            corners
        };
        let mut found: HashSet<[Name; 3]> = HashSet::new();
        for &triangle in &mesh.triangles {
            assert!(
                found.insert(sorted(triangle.map(|v| names[v as usize]))),
                "{family:?} {seed}: there twice"
            );
        }
        let (triangles, quadrilaterals) = stuffing.boundary();
        for [a, b, c, d] in quadrilaterals {
            let ways = [[[a, b, c], [a, c, d]], [[b, c, d], [b, d, a]]].map(|way| way.map(sorted));
            let way = ways.iter().find(|way| way.iter().all(|triangle| found.contains(triangle)));
            for triangle in way.unwrap_or_else(|| panic!("{family:?} {seed}: a quadrilateral is not there")) {
                found.remove(triangle);
            }
            cut += 1;
        }
        assert!(found == triangles, "{family:?} {seed}");
    }
    assert!(warped > 1000 && cut > 20, "{warped} {cut}");
}

/// Sides run as often one way as the other, all vertices are used, and triangles face outward.
#[test]
fn the_mesh_is_closed_whatever_the_samples() {
    let mut touching = 0;
    for (family, seed) in FAMILIES.into_iter().flat_map(|family| [(family, 4), (family, 5)]) {
        let mesh = mesh_of(&Volume::random(Arrangement::BodyCentred, 6, family, seed).closed(), &WARP);
        let mut sides: HashMap<[u32; 2], [i32; 2]> = HashMap::new();
        let mut used = vec![false; mesh.positions.len()];
        for &[a, b, c] in &mesh.triangles {
            for [from, to] in [[a, b], [b, c], [c, a]] {
                assert_ne!(from, to);
                sides.entry([from.min(to), from.max(to)]).or_default()[usize::from(from < to)] += 1;
                used[from as usize] = true;
            }
        }
        assert!(sides.values().all(|[there, back]| there == back), "{family:?} {seed}");
        assert!(used.iter().all(|used| *used), "{family:?} {seed}");
        assert!(mesh.triangles.is_empty() || mesh.volume() > 0.0, "{family:?} {seed}");
        touching += sides.values().filter(|[there, _]| *there > 1).count();
    }
    assert!(touching > 0, "no promise of a manifold is made in vain");
}

/// The tetrahedron of the lattice, in half cells.
const TETRAHEDRON: [Place; 4] = [[0, 0, 0], [2, 0, 0], [1, 1, 1], [1, -1, 1]];

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Sign {
    Inside,
    Zero,
    Outside,
}

/// A corner: where it is, and the corner of the tetrahedron that it was moved towards, if it was one.
#[derive(Clone, Copy)]
struct Corner {
    at: DVec3,
    towards: Option<usize>,
}

/// One of the ends, or between.
fn share(numbers: &mut Numbers, low: f64, high: f64) -> f64 {
    let unit = numbers.below(1 << 24) as f64 / f64::from(1 << 24);
    low + (high - low)
        * match numbers.below(4) {
            0 => 0.0,
            1 => 1.0,
            _ => unit,
        }
}

/// The tetrahedron's corners as a warp may leave them: those on the surface anywhere on an edge, within reach.
fn moved(numbers: &mut Numbers, signs: [Sign; 4]) -> Option<[Corner; 4]> {
    let all = offsets();
    let corners = std::array::from_fn(|i| {
        let place = TETRAHEDRON[i];
        let at = DVec3::from_array(place.map(f64::from));
        if signs[i] != Sign::Zero {
            return Corner { at, towards: None };
        }
        let offset = all[numbers.below(14) as usize];
        let share = share(numbers, 0.0, alpha(offset));
        let towards = TETRAHEDRON.iter().position(|other| *other == plus(place, offset));
        Corner { at: at + DVec3::from_array(offset.map(f64::from)) * share, towards }
    });
    // A crossing is within reach of one end at most.
    let is_mutual = (0..4).any(|i| corners[i].towards.is_some_and(|j| corners[j].towards == Some(i)));
    // Ends of a crossed edge are on different sides: those that moved were, too.
    let is_possible = (0..16).any(|inside: u32| {
        (0..4).all(|i| {
            let side = inside >> i & 1 != 0;
            let as_said = match signs[i] {
                Sign::Inside => side,
                Sign::Outside => !side,
                Sign::Zero => true,
            };
            as_said && corners[i].towards.is_none_or(|j| side != (inside >> j & 1 != 0))
        })
    });
    (!is_mutual && is_possible).then_some(corners)
}

/// The crossing between two corners that were not moved: within reach of neither.
fn cut(numbers: &mut Numbers, corners: &[Corner; 4], p: usize, q: usize) -> DVec3 {
    let offset: Place = std::array::from_fn(|a| TETRAHEDRON[q][a] - TETRAHEDRON[p][a]);
    let least = alpha(offset);
    corners[p].at.lerp(corners[q].at, share(numbers, least, 1.0 - least))
}

fn all_signs() -> impl Iterator<Item = [Sign; 4]> {
    (0..81).map(|n| {
        std::array::from_fn(|i| [Sign::Inside, Sign::Zero, Sign::Outside][n / 3usize.pow(i as u32) % 3])
    })
}

fn of(signs: [Sign; 4], sign: Sign) -> Vec<usize> {
    (0..4).filter(|&i| signs[i] == sign).collect()
}

/// Smallest and largest dihedral angle, degrees.
fn dihedral_angles(t: [DVec3; 4]) -> [f64; 2] {
    let mut range = [180.0f64, 0.0f64];
    for (i, j) in (0..4).flat_map(|i| (i + 1..4).map(move |j| (i, j))) {
        let others: Vec<usize> = (0..4).filter(|k| ![i, j].contains(k)).collect();
        let along = (t[j] - t[i]).normalize_or_zero();
        let across = |k: usize| (t[k] - t[i]).reject_from(along);
        let angle = across(others[0]).angle_between(across(others[1])).to_degrees();
        range = [range[0].min(angle), range[1].max(angle)];
    }
    range
}

/// Of all tetrahedra that the published method makes without cutting quadrilaterals: those of one corner inside, and those of no corner
/// outside.
fn worst_dihedral_angles(samples: u64, seed: u64) -> [f64; 2] {
    let mut numbers = Numbers::new(seed);
    let mut worst = [180.0f64, 0.0f64];
    for signs in all_signs() {
        let (inside, outside) = (of(signs, Sign::Inside), of(signs, Sign::Outside));
        if !(inside.len() == 1 || !inside.is_empty() && outside.is_empty()) {
            continue;
        }
        for _ in 0..samples {
            let Some(corners) = moved(&mut numbers, signs) else { continue };
            let mut at = corners.map(|corner| corner.at);
            for &q in &outside {
                at[q] = cut(&mut numbers, &corners, inside[0], q);
            }
            let [least, most] = dihedral_angles(at);
            worst = [worst[0].min(least), worst[1].max(most)];
        }
    }
    worst
}

/// Smallest and largest plane angle of the triangles of the surface, whichever way quadrilaterals are cut.
fn worst_plane_angles(samples: u64, seed: u64) -> [f64; 2] {
    let mut numbers = Numbers::new(seed);
    let mut worst = [180.0f64, 0.0f64];
    for signs in all_signs() {
        let [inside, zero, outside] = [Sign::Inside, Sign::Zero, Sign::Outside].map(|sign| of(signs, sign));
        let count = zero.len() + inside.len() * outside.len();
        if inside.is_empty() || count < 3 {
            continue;
        }
        for _ in 0..samples {
            let Some(corners) = moved(&mut numbers, signs) else { continue };
            let mut at: Vec<DVec3> = zero.iter().map(|&i| corners[i].at).collect();
            for &p in &inside {
                at.extend(outside.iter().map(|&q| cut(&mut numbers, &corners, p, q)));
            }
            // Two by two they stand in rows: the third and fourth corner change places.
            let ways: &[[usize; 3]] =
                if count == 3 { &[[0, 1, 2]] } else { &[[0, 1, 3], [0, 3, 2], [1, 3, 2], [1, 2, 0]] };
            for way in ways {
                let [a, b, c] = way.map(|i| at[i]);
                for angle in
                    [(b - a).angle_between(c - a), (c - b).angle_between(a - b), (a - c).angle_between(b - c)]
                {
                    worst = [worst[0].min(angle.to_degrees()), worst[1].max(angle.to_degrees())];
                }
            }
        }
    }
    worst
}

/// One tetrahedron with all neighbours of its corners, each with a sample: what the program sees of it.
struct Samples {
    places: Vec<Place>,
    values: Vec<f64>,
}

impl Samples {
    fn random(numbers: &mut Numbers) -> Self {
        let mut places = TETRAHEDRON.to_vec();
        for (corner, offset) in
            TETRAHEDRON.into_iter().flat_map(|c| offsets().into_iter().map(move |o| (c, o)))
        {
            let place = plus(corner, offset);
            if !places.contains(&place) {
                places.push(place);
            }
        }
        let values =
            places.iter().map(|_| numbers.below(1 << 24) as f64 / f64::from(1 << 23) - 1.0).collect();
        Self { places, values }
    }

    fn value(&self, place: Place) -> f64 {
        self.values[self.places.iter().position(|p| *p == place).expect("a neighbour")]
    }

    /// The tetrahedron's angles, its corners moved as published, one after the other: a corner that was moved lies on the surface, and
    /// its edges have no crossings any more. Without an order all are moved at once, as the extractor does. None where the tetrahedron
    /// has a quadrilateral, or nothing inside.
    fn dihedral_angles(&self, order: Option<[usize; 4]>) -> Option<[f64; 2]> {
        let at = |place: Place| DVec3::from_array(place.map(f64::from));
        let crossing = |p: Place, q: Place| {
            let (here, there) = (self.value(p), self.value(q));
            ((here > 0.0) != (there > 0.0)).then(|| here / (here - there))
        };
        let mut warped: [Option<DVec3>; 4] = [None; 4];
        for i in order.unwrap_or([0, 1, 2, 3]) {
            let place = TETRAHEDRON[i];
            let reached = offsets().into_iter().filter_map(|offset| {
                let other = plus(place, offset);
                let is_on_surface =
                    TETRAHEDRON.iter().zip(&warped).any(|(p, at)| *p == other && at.is_some());
                let share = crossing(place, other).filter(|_| order.is_none() || !is_on_surface)?;
                (share < alpha(offset)).then_some((share, offset))
            });
            let nearest = reached.min_by(|a, b| a.0.total_cmp(&b.0));
            warped[i] = nearest.map(|(share, offset)| at(place) + at(offset) * share);
        }
        let is_inside = |i: usize| self.value(TETRAHEDRON[i]) > 0.0;
        let of = |inside: bool| (0..4).filter(move |&i| warped[i].is_none() && is_inside(i) == inside);
        let (inside, outside): (Vec<usize>, Vec<usize>) = (of(true).collect(), of(false).collect());
        if !(inside.len() == 1 || !inside.is_empty() && outside.is_empty()) {
            return None;
        }
        let mut corners: [DVec3; 4] = std::array::from_fn(|i| warped[i].unwrap_or(at(TETRAHEDRON[i])));
        for &q in &outside {
            let (from, to) = (TETRAHEDRON[inside[0]], TETRAHEDRON[q]);
            corners[q] = at(from).lerp(at(to), crossing(from, to).expect("they are on two sides"));
        }
        Some(dihedral_angles(corners))
    }
}

/// The smallest and the largest angle that samples were driven to, a few at a time, from many starts.
fn driven_dihedral_angles(starts: u32, steps: u32, seed: u64, in_order: bool) -> [f64; 2] {
    let mut numbers = Numbers::new(seed);
    let mut worst = [180.0f64, 0.0f64];
    for start in 0..starts {
        let end = start as usize % 2;
        let badness = |angles: [f64; 2]| if end == 0 { -angles[0] } else { angles[1] };
        let mut samples = Samples::random(&mut numbers);
        let mut order = [0, 1, 2, 3];
        for i in (1..4).rev() {
            order.swap(i, numbers.below(i as u64 + 1) as usize);
        }
        let order = in_order.then_some(order);
        let mut now = samples.dihedral_angles(order);
        for step in 0..steps {
            let before = samples.values.clone();
            // Ever smaller, now a sample anew.
            let scale = 0.5f64.powi((10 * step / steps) as i32);
            for _ in 0..1 + numbers.below(3) {
                let which = numbers.below(samples.values.len() as u64) as usize;
                let unit = numbers.below(1 << 24) as f64 / f64::from(1 << 23) - 1.0;
                let value = samples.values[which];
                samples.values[which] = match numbers.below(4) {
                    0 => unit,
                    1 => -value,
                    2 => value * (1.0 + scale * unit),
                    _ => value + scale * unit,
                };
            }
            let then = samples.dihedral_angles(order);
            match (now, then) {
                (None, _) => now = then,
                (Some(old), Some(new)) if badness(new) >= badness(old) => now = then,
                _ => samples.values = before,
            }
        }
        if let Some([least, most]) = now {
            worst = [worst[0].min(least), worst[1].max(most)];
        }
    }
    worst
}

/// Found by sampling: just beyond what millions of samples gave. Labelle and Shewchuk (2007) state 10.7 and 164.8 degrees, and this pair
/// of shares is given for them. They cut quadrilaterals by a rule of their own, so tetrahedra with such are left out here. The others have
/// smaller angles all the same: see below.
const DIHEDRAL: [f64; 2] = [9.31, 161.7];
/// The same of the triangles.
const PLANE: [f64; 2] = [7.5, 159.0];

#[test]
fn dihedral_angles_are_bounded() {
    let [least, most] = worst_dihedral_angles(20_000, 1);
    assert!(least > DIHEDRAL[0] && most < DIHEDRAL[1], "{least} {most}");
    // The samples are adversarial.
    assert!(least < DIHEDRAL[0] + 1.0 && most > DIHEDRAL[1] - 3.0, "{least} {most}");
}

/// No artefact of corners that move without regard to each other: there are samples for which the published steps, in their order, end
/// at these very angles.
#[test]
fn samples_reach_the_bounds_of_dihedral_angles() {
    for in_order in [false, true] {
        let [least, most] = driven_dihedral_angles(80, 6_000, 5, in_order);
        assert!(least > DIHEDRAL[0] && most < DIHEDRAL[1], "{least} {most}");
        assert!(least < 9.4 && most > 161.3, "{least} {most}");
    }
}

/// One tetrahedron by hand: a corner inside that stays, and three that move by all that they may, one of them towards another.
#[test]
fn a_tetrahedron_has_a_smaller_angle_than_published() {
    let short = 0.411_889;
    let moves: [Place; 3] = [[-1, 1, 1], [1, 1, 1], [-1, -1, -1]];
    let mut corners = TETRAHEDRON.map(|place| DVec3::from_array(place.map(f64::from)));
    for (corner, offset) in corners.iter_mut().zip(moves) {
        *corner += short * DVec3::from_array(offset.map(f64::from));
    }
    // Samples for which it comes to be, the third corner moved before the first. All others are next to 0: crossings are next to them,
    // and out of reach of the corners.
    let mut samples = Samples::random(&mut Numbers::new(0));
    samples.values.fill(1e-3);
    let mut set = |place: Place, value: f64| {
        let at = samples.places.iter().position(|p| *p == place).unwrap();
        samples.values[at] = value;
    };
    // Crossings at 0.411889 of the way: towards (-1, 1, 1), from (1, 1, 1) to the first corner, and from the second to (3, 1, 1).
    let beyond = (1.0 - short) / short;
    set([0, 0, 0], -1.0);
    set([1, 1, 1], 1.0 / beyond);
    set([-1, 1, 1], beyond);
    set([2, 0, 0], 1.0);
    set([3, 1, 1], -beyond);
    set([1, -1, 1], 1.0);
    let [least, most] = dihedral_angles(corners);
    assert!((least - 9.3175).abs() < 1e-3 && (most - 160.838).abs() < 1e-2, "{least} {most}");
    let [found, _] = samples.dihedral_angles(Some([2, 0, 1, 3])).unwrap();
    assert!((found - least).abs() < 1e-6, "{found} {least}");
}

#[test]
fn plane_angles_are_bounded() {
    let [least, most] = worst_plane_angles(20_000, 3);
    assert!(least > PLANE[0] && most < PLANE[1], "{least} {most}");
    assert!(least < PLANE[0] + 1.5 && most > PLANE[1] - 4.0, "{least} {most}");
}

#[test]
#[ignore = "half a minute: run by make test-long"]
fn angles_are_bounded_in_many_samples() {
    let (dihedral, plane) = (worst_dihedral_angles(400_000, 2), worst_plane_angles(400_000, 4));
    println!("dihedral angles {dihedral:?}, plane angles {plane:?}");
    assert!(dihedral[0] > DIHEDRAL[0] && dihedral[1] < DIHEDRAL[1]);
    assert!(plane[0] > PLANE[0] && plane[1] < PLANE[1]);
}

fn plane_angles(mesh: &TriangleMesh) -> [f64; 2] {
    let mut worst = [180.0f64, 0.0f64];
    for t in 0..mesh.triangles.len() {
        let [a, b, c] = mesh.corners(t).map(|p| p.as_dvec3());
        for angle in
            [(b - a).angle_between(c - a), (c - b).angle_between(a - b), (a - c).angle_between(b - c)]
        {
            worst = [worst[0].min(angle.to_degrees()), worst[1].max(angle.to_degrees())];
        }
    }
    worst
}

/// Of noise too: away from the box, where the lattice is not thinner.
#[test]
fn whole_meshes_keep_to_the_bounds() {
    let mut worst = [180.0f64, 0.0f64];
    for seed in 0..60 {
        let family = [Family::White, Family::NoisyMagnitudes, Family::LowPassOnce][seed as usize % 3];
        let mut volume = Volume::random(Arrangement::BodyCentred, 8, family, seed).closed();
        // The lattice's edges are whole only one cell off the box.
        for place in volume.places() {
            if place.iter().any(|&c| c <= 2 || c >= 14) {
                volume.set(place, -1.0);
            }
        }
        let [least, most] = plane_angles(&mesh_of(&volume, &WARP));
        worst = [worst[0].min(least), worst[1].max(most)];
    }
    assert!(worst[0] > PLANE[0] && worst[1] < PLANE[1], "{worst:?}");
}

#[test]
fn smooth_surfaces_keep_their_topology_and_lose_no_more_than_a_net() {
    for radius in [0.8f32, 0.83, 0.9] {
        let bounds = Bounds { min: Vec3::splat(-1.0), max: Vec3::splat(1.0) };
        let lattice = Lattice::try_new(Arrangement::BodyCentred, bounds, 0.05).unwrap();
        let sphere = Sphere { radius };
        let mesh = extract(&sphere, &lattice, &WARP, &ONE).unwrap().mesh;
        assert!(mesh::topology::topology(&mesh).is_closed_manifold());
        let volume = 4.0 / 3.0 * std::f64::consts::PI * f64::from(radius).powi(3);
        assert!((mesh.volume() / volume - 1.0).abs() < 0.003, "{}", mesh.volume() / volume);
        // Every vertex is a crossing, so it is as near to the sphere as those are.
        let away = mesh.positions.iter().map(|p| (p.length() - radius).abs()).fold(0.0, f32::max);
        assert!(away < 0.0005, "{away}");
        let relaxed = ExtractSettings { placement: Placement::Relaxed, ..WARP };
        let moved = extract(&sphere, &lattice, &relaxed, &ONE).unwrap().mesh;
        assert_eq!(moved.triangles, mesh.triangles);
        let ratio = |mesh: &TriangleMesh| mesh::quality::quality(mesh).radius_ratio.mean;
        assert!(ratio(&moved) > ratio(&mesh) + 0.01, "{} {}", ratio(&mesh), ratio(&moved));
    }
}

/// Boxes of cells weld to the whole, to the byte.
#[test]
fn chunks_weld_to_the_whole() {
    for (family, seed) in FAMILIES.into_iter().flat_map(|family| [(family, 0), (family, 1)]) {
        for placement in [Placement::MeanOfCrossings, Placement::Relaxed] {
            let volume = Volume::random(Arrangement::BodyCentred, 11, family, seed);
            let volume = if seed == 0 { volume.closed() } else { volume };
            let settings = ExtractSettings { placement, ..WARP };
            if placement == Placement::Relaxed && !matches!(family, Family::Spheres | Family::Gyroid) {
                continue;
            }
            let whole = mesh_of(&volume, &settings);
            let method = Method::Tetrahedra(Tetrahedra::with(Arrangement::BodyCentred, &settings));
            let grid = BoxGrid::from(&volume.lattice());
            let mut chunks = ChunkExtractor::in_box(&grid, &method, &ChunkSettings::default()).unwrap();
            let boxes: Vec<CellBox> = chunks.grid(4).collect();
            let parts: Vec<_> = boxes
                .into_iter()
                .map(|cells| chunks.extract(Source::Study(&volume), cells, &ONE).unwrap())
                .collect();
            let welded = weld_chunks(&parts).unwrap_or_else(|error| panic!("{family:?} {seed}: {error}"));
            assert!(welded == whole || has_nan(&whole), "{family:?} {seed} {placement:?}");
        }
    }
}

fn has_nan(mesh: &TriangleMesh) -> bool {
    mesh.positions.iter().chain(&mesh.normals).any(|v| v.is_nan())
}

#[test]
fn threads_and_buffers_change_nothing() {
    let bounds = Bounds { min: Vec3::splat(-1.0), max: Vec3::splat(1.0) };
    let lattice = Lattice::try_new(Arrangement::BodyCentred, bounds, 0.04).unwrap();
    let asteroid: &dyn StudyField = &Asteroid::default();
    let one = extract(asteroid, &lattice, &WARP, &ONE).unwrap();
    assert!(
        one.counts.vertices as usize == one.mesh.positions.len() && one.times.clustering > Default::default()
    );
    let unclustered = ExtractSettings { clustering: Clustering::None, ..WARP };
    let all = extract(asteroid, &lattice, &unclustered, &ONE).unwrap().counts;
    assert_eq!(one.counts.triangles + one.counts.discarded_triangles, all.triangles);
    assert_eq!(one.counts.crossings, all.crossings);
    let mut extractor = Extractor::new();
    for threads in [2, 3, 1] {
        let mesh = extractor.extract(asteroid.into(), &lattice, &WARP, &Execution { threads }).unwrap().mesh;
        assert!(mesh == one.mesh, "{threads}");
    }
}

#[test]
fn what_a_warp_does_not_know_is_refused() {
    let bounds = Bounds { min: Vec3::splat(-1.0), max: Vec3::splat(1.0) };
    let error = |arrangement, settings: ExtractSettings| {
        let lattice = Lattice::try_new(arrangement, bounds, 0.5).unwrap();
        extract(&Sphere { radius: 0.7 }, &lattice, &settings, &ONE).unwrap_err()
    };
    for arrangement in [Arrangement::SimpleCubic, Arrangement::FiveTetrahedra, Arrangement::FaceCentred] {
        assert_eq!(
            error(arrangement, WARP),
            ExtractError::ArrangementClustering { arrangement, clustering: Clustering::Warp }
        );
    }
    for (settings, with) in [
        (ExtractSettings { topology: Topology::Published, ..WARP }, "published topology"),
        (
            ExtractSettings { positions: Positions::Accumulated { chunks: 1 }, ..WARP },
            "accumulated positions",
        ),
        (ExtractSettings { placement: Placement::CurvatureWeighted, ..WARP }, "curvature-weighted placement"),
        (ExtractSettings { refine_crossings: true, ..WARP }, "refined crossings"),
    ] {
        assert_eq!(error(Arrangement::BodyCentred, settings), ExtractError::Warp { with });
    }
}
