//! Angles of warp clustering: of one tetrahedron driven to the worst, and of whole meshes. `scripts/warp-angles.py` computes the bounds apart.

use crate::fields::{Family, Numbers, Volume};
use crate::warp_rules::{Place, WARP, alpha, mesh_of, offsets, plus};
use glam::DVec3;
use isostudy_extract::Arrangement;
use isostudy_mesh::TriangleMesh;

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

/// Of all tetrahedra that are cut without a quadrilateral: those of one corner inside, and those of no corner outside.
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

/// Smallest and largest angle of the triangles that some corners make: whichever way a quadrilateral is cut. Two by two the corners of one
/// stand in rows, so the third and fourth change places.
fn surface_angles(at: &[DVec3]) -> [f64; 2] {
    let ways: &[[usize; 3]] =
        if at.len() == 3 { &[[0, 1, 2]] } else { &[[0, 1, 3], [0, 3, 2], [1, 3, 2], [1, 2, 0]] };
    let mut range = [180.0f64, 0.0f64];
    for way in ways {
        let [a, b, c] = way.map(|i| at[i]);
        for angle in
            [(b - a).angle_between(c - a), (c - b).angle_between(a - b), (a - c).angle_between(b - c)]
        {
            range = [range[0].min(angle.to_degrees()), range[1].max(angle.to_degrees())];
        }
    }
    range
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
            let [least, most] = surface_angles(&at);
            worst = [worst[0].min(least), worst[1].max(most)];
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

    /// The tetrahedron's angles, its corners moved as the extractor moves them: all at once. Those between its faces, or of the surface's
    /// triangles. None where there are none, and between faces where it has a quadrilateral.
    fn angles(&self, kind: Angles) -> Option<[f64; 2]> {
        let at = |place: Place| DVec3::from_array(place.map(f64::from));
        let crossing = |p: Place, q: Place| {
            let (here, there) = (self.value(p), self.value(q));
            ((here > 0.0) != (there > 0.0)).then(|| here / (here - there))
        };
        let warped: [Option<DVec3>; 4] = TETRAHEDRON.map(|place| {
            let reached = offsets().into_iter().filter_map(|offset| {
                let share = crossing(place, plus(place, offset))?;
                (share < alpha(offset)).then_some((share, offset))
            });
            let nearest = reached.min_by(|a, b| a.0.total_cmp(&b.0));
            nearest.map(|(share, offset)| at(place) + at(offset) * share)
        });
        let is_inside = |i: usize| self.value(TETRAHEDRON[i]) > 0.0;
        let of = |inside: bool| (0..4).filter(move |&i| warped[i].is_none() && is_inside(i) == inside);
        let (inside, outside): (Vec<usize>, Vec<usize>) = (of(true).collect(), of(false).collect());
        let cut = |p: usize, q: usize| {
            let (from, to) = (TETRAHEDRON[p], TETRAHEDRON[q]);
            at(from).lerp(at(to), crossing(from, to).expect("they are on two sides"))
        };
        match kind {
            Angles::Dihedral => {
                if !(inside.len() == 1 || !inside.is_empty() && outside.is_empty()) {
                    return None;
                }
                let mut corners: [DVec3; 4] =
                    std::array::from_fn(|i| warped[i].unwrap_or(at(TETRAHEDRON[i])));
                outside.iter().for_each(|&q| corners[q] = cut(inside[0], q));
                Some(dihedral_angles(corners))
            }
            Angles::Surface => {
                let mut corners: Vec<DVec3> = warped.into_iter().flatten().collect();
                corners.extend(inside.iter().flat_map(|&p| outside.iter().map(move |&q| cut(p, q))));
                (!inside.is_empty() && corners.len() > 2).then(|| surface_angles(&corners))
            }
        }
    }
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Angles {
    Dihedral,
    Surface,
}

/// The smallest and the largest angle that samples were driven to, a few at a time, from many starts.
fn driven(kind: Angles, starts: u32, steps: u32, seed: u64) -> [f64; 2] {
    let mut numbers = Numbers::new(seed);
    let mut worst = [180.0f64, 0.0f64];
    for start in 0..starts {
        let end = start as usize % 2;
        let badness = |angles: [f64; 2]| if end == 0 { -angles[0] } else { angles[1] };
        let mut samples = Samples::random(&mut numbers);
        let mut now = samples.angles(kind);
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
            let then = samples.angles(kind);
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

/// Just beyond what corners, samples and `scripts/warp-angles.py` were driven to: 11.3096 and 155.7254 degrees.
const DIHEDRAL: [f64; 2] = [11.309, 155.726];
/// The same of the triangles: 13.0689 and 145.1886.
const PLANE: [f64; 2] = [13.068, 145.189];

#[test]
fn dihedral_angles_are_bounded() {
    let [least, most] = worst_dihedral_angles(20_000, 1);
    assert!(least > DIHEDRAL[0] && most < DIHEDRAL[1], "{least} {most}");
    // The corners are adversarial.
    assert!(least < DIHEDRAL[0] + 1.0 && most > DIHEDRAL[1] - 3.0, "{least} {most}");
}

/// No artefact of corners that move without regard to each other: there are samples that come near these very angles.
#[test]
fn samples_are_driven_to_the_bounds() {
    for (kind, bounds, near) in [(Angles::Dihedral, DIHEDRAL, 0.3), (Angles::Surface, PLANE, 0.8)] {
        let [least, most] = driven(kind, 80, 6_000, 5);
        println!("{kind:?} {least} {most}");
        assert!(least > bounds[0] && most < bounds[1], "{kind:?} {least} {most}");
        assert!(least < bounds[0] + near && most > bounds[1] - near, "{kind:?} {least} {most}");
    }
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
    for (kind, bounds) in [(Angles::Dihedral, DIHEDRAL), (Angles::Surface, PLANE)] {
        let found = driven(kind, 400, 20_000, 6);
        println!("driven: {kind:?} {found:?}");
        assert!(found[0] > bounds[0] && found[1] < bounds[1]);
    }
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
