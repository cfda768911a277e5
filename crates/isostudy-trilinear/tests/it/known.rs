//! The oracle against surfaces that are known, and against refinement.

use isostudy_trilinear::{
    CellTopology, Component, Samples, SamplesError, Surface, Ties, cell_topology, topology,
};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

fn surface(counts: [usize; 3], values: &[f32], isovalue: f32) -> Surface {
    topology(&Samples::try_new(counts, values).unwrap(), isovalue, Ties::Outside).unwrap()
}

fn sampled(n: usize, half: f64, field: impl Fn([f64; 3]) -> f64) -> Vec<f32> {
    let at = |i: usize| (i as f64 / (n - 1) as f64 * 2.0 - 1.0) * half;
    (0..n * n * n).map(|i| field([at(i % n), at(i / n % n), at(i / n / n)]) as f32).collect()
}

fn ball([x, y, z]: [f64; 3]) -> f64 {
    1.0 - (x * x + y * y + z * z).sqrt()
}

fn torus([x, y, z]: [f64; 3]) -> f64 {
    let ring = (x * x + y * y).sqrt() - 1.0;
    0.4 - (ring * ring + z * z).sqrt()
}

const SPHERE: Component = Component { euler_characteristic: 2, boundary_loops: 0 };
const TORUS: Component = Component { euler_characteristic: 0, boundary_loops: 0 };

#[test]
fn a_sphere_a_torus_and_balls_are_what_they_are() {
    for n in [9, 16, 23] {
        assert_eq!(surface([n; 3], &sampled(n, 1.5, ball), 0.0).components, [SPHERE]);
        let found = surface([n; 3], &sampled(n, 1.7, torus), 0.0);
        assert_eq!((found.components.as_slice(), found.genus()), (&[TORUS][..], 1));
    }
    for balls in 1..=4usize {
        let row = sampled(41, 5.0, |[x, y, z]| {
            let centre = |k: usize| 2.4 * k as f64 - 3.6;
            (0..balls).map(|k| ball([x - centre(k), y, z])).fold(-1.0, f64::max)
        });
        let found = surface([41; 3], &row, 0.0);
        assert_eq!(found.components, vec![SPHERE; balls]);
        assert_eq!(found.euler_characteristic(), 2 * balls as i64);
    }
}

#[test]
fn a_surface_ends_at_the_faces_of_the_grid() {
    let plane = sampled(6, 1.0, |[x, y, z]| x + 0.3 * y - 0.2 * z + 0.05);
    let disc = Component { euler_characteristic: 1, boundary_loops: 1 };
    assert_eq!(surface([6; 3], &plane, 0.0).components, [disc]);
    let tube = sampled(12, 1.0, |[x, y, _]| 0.6 - (x * x + y * y).sqrt());
    let tube = surface([12; 3], &tube, 0.0);
    assert_eq!(tube.components, [Component { euler_characteristic: 0, boundary_loops: 2 }]);
    assert_eq!(tube.genus(), 0);
    // A ball at a corner of the grid, and one half beyond a face.
    for centre in [[1.0, 1.0, 1.0], [1.0, 0.1, 0.0]] {
        let values =
            sampled(12, 1.0, |p| 0.6 - (0..3).map(|k| (p[k] - centre[k]).powi(2)).sum::<f64>().sqrt());
        assert_eq!(surface([12; 3], &values, 0.0).components, [disc], "{centre:?}");
    }
    let nested = sampled(21, 1.0, |p| 0.25 - (ball(p) - 0.5).abs());
    let shell = surface([21; 3], &nested, 0.0);
    assert_eq!(shell.components, [SPHERE, SPHERE]);
}

/// A single cell with a tunnel, grown into a closed grid: published single cells, corner values x fastest (Custodio, Etiene, Pesco &
/// Silva 2013, figure 7 and algorithm 1): two loops, one piece.
#[test]
fn published_tunnel_cells_have_a_tunnel() {
    let figure_7 = [-0.6468, 0.2591, 0.2156, -0.1222, -0.3586, 0.8845, -0.0026, -0.0953];
    let algorithm_1 = [0.226, -0.5913, -0.0936, 0.2511, 0.989, -0.1631, -0.9798, 0.2859];
    for values in [figure_7, algorithm_1] {
        let wanted = CellTopology { loops: 2, pieces: 1, tunnels: 1 };
        for ties in [Ties::Outside, Ties::Inside] {
            assert_eq!(cell_topology(values, 0.0, ties), wanted);
            assert_eq!(cell_topology(values.map(|v| -v), 0.0, ties), wanted);
        }
        // Turned about all axes and mirrored it stays what it is.
        for order in ORDERS {
            for flip in 0..8 {
                let turned = std::array::from_fn(|c| {
                    let place = (0..3).fold(0, |p, axis| p | ((c ^ flip) >> axis & 1) << order[axis]);
                    values[place]
                });
                assert_eq!(cell_topology(turned, 0.0, Ties::Outside), wanted);
            }
        }
    }
}

const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [1, 0, 2], [0, 2, 1], [2, 1, 0]];

#[test]
fn two_opposite_corners_are_joined_as_the_middle_says() {
    // Faces separate; the value in the middle is the mean.
    let cell = |low: f32| std::array::from_fn(|c| if c == 0 || c == 7 { 1.0 } else { low });
    // (1 + 3 low) / 4 at the middle of the diagonal; faces join at low > 0 only.
    for (low, tunnels) in [(-1.0, 0), (-0.5, 0), (-0.34, 0), (-0.33, 1), (-0.2, 1), (-0.01, 1)] {
        let found = cell_topology(cell(low), 0.0, Ties::Outside);
        assert_eq!((found.loops, found.tunnels), (2, tunnels), "{low}");
    }
}

#[test]
fn ties_are_a_level_nearby() {
    // A face whose saddle is on the level: raised it parts what is inside, lowered it joins it.
    let cell = [1.0, -1.0, -1.0, 1.0, -1.0, -1.0, -1.0, -1.0];
    assert_eq!(cell_topology(cell, 0.0, Ties::Outside).loops, 2);
    assert_eq!(cell_topology(cell, 0.0, Ties::Inside).loops, 1);
    // A ball whose centre alone reaches the level, and a hole that does.
    let mut values = vec![0.0; 27];
    values[13] = 1.0;
    assert_eq!(surface([3; 3], &values, 1.0).components, []);
    let samples = Samples::try_new([3; 3], &values).unwrap();
    assert_eq!(topology(&samples, 1.0, Ties::Inside).unwrap().components, [SPHERE]);
    assert_eq!(topology(&samples, 0.0, Ties::Inside).unwrap().components, []);
    assert_eq!(topology(&samples, 0.0, Ties::Outside).unwrap().components, [SPHERE]);
}

/// The same as a level just above, whenever that level is exact: values are whole, so nothing happens between 0 and 1/1000.
#[test]
fn a_tie_outside_is_a_level_just_above() {
    let mut random = Pcg64Mcg::seed_from_u64(4);
    for _ in 0..3000 {
        let values: Vec<f32> = (0..64).map(|_| random.random_range(-2..=2) as f32).collect();
        let samples = Samples::try_new([4; 3], &values).unwrap();
        let at = |isovalue, ties| topology(&samples, isovalue, ties).unwrap().components;
        let kinds = |mut components: Vec<Component>| {
            components.sort_unstable();
            components
        };
        assert_eq!(kinds(at(0.0, Ties::Outside)), kinds(at(1e-3, Ties::Outside)));
        assert_eq!(kinds(at(0.0, Ties::Inside)), kinds(at(-1e-3, Ties::Outside)));
    }
}

#[test]
fn what_is_no_volume_is_refused() {
    assert!(matches!(Samples::try_new([2, 2, 3], &[0.0; 8]), Err(SamplesError::Counts { .. })));
    assert!(matches!(Samples::try_new([1, 2, 4], &[0.0; 8]), Err(SamplesError::Flat { .. })));
    let mut values = [0.0; 8];
    values[6] = f32::NAN;
    let error = Samples::try_new([2; 3], &values).unwrap_err();
    assert!(matches!(error, SamplesError::NotFinite { place: [0, 1, 1], .. }), "{error}");
    let samples = Samples::try_new([2; 3], &[0.0; 8]).unwrap();
    assert!(matches!(topology(&samples, f32::INFINITY, Ties::Outside), Err(SamplesError::Isovalue { .. })));
}

/// Large and small numbers in one cell take the long way, and the same cell scaled the short one.
#[test]
fn scale_does_not_matter() {
    let mut random = Pcg64Mcg::seed_from_u64(9);
    for _ in 0..5000 {
        let values: [f32; 8] = std::array::from_fn(|_| random.random_range(-500..500) as f32);
        let whole = cell_topology(values, 0.0, Ties::Outside);
        for scale in [2f32.powi(100), 2f32.powi(-130)] {
            assert_eq!(cell_topology(values.map(|v| v * scale), 0.0, Ties::Outside), whole);
        }
        // One of them a hair off: a level nearby, but 100 bits long.
        let mut near = values;
        near[0] += if near[0] == 0.0 { 0.0 } else { near[0].signum() * 1e-4 };
        let shifted = cell_topology(near, 1e-30, Ties::Outside);
        assert!(shifted.tunnels <= 1 && shifted.loops <= 4);
    }
}

/// An N^3 grid with -1 round it and values from -1 to 1 inside, as Etiene et al. (2012) test with.
fn random_grid(n: usize, random: &mut Pcg64Mcg) -> Vec<f32> {
    let is_border = |i: usize| [i % n, i / n % n, i / n / n].iter().any(|&x| x == 0 || x == n - 1);
    (0..n * n * n).map(|i| if is_border(i) { -1.0 } else { random.random_range(-1.0..1.0) }).collect()
}

/// Components and Euler characteristic of the surface by brute force: the trilinear function sampled `factor` times as finely, its
/// positive points as part of Kuhn's triangulation.
fn refined(n: usize, values: &[f32], factor: usize) -> (usize, i64) {
    let m = (n - 1) * factor + 1;
    let value = |p: [usize; 3]| {
        let cell = p.map(|x| (x / factor).min(n - 2));
        let share: [f64; 3] = std::array::from_fn(|k| (p[k] - cell[k] * factor) as f64 / factor as f64);
        (0..8)
            .map(|c| {
                let at: [usize; 3] = std::array::from_fn(|k| cell[k] + (c >> k & 1));
                let weight: f64 =
                    (0..3).map(|k| if c >> k & 1 != 0 { share[k] } else { 1.0 - share[k] }).product();
                weight * f64::from(values[(at[2] * n + at[1]) * n + at[0]])
            })
            .sum::<f64>()
    };
    let place = |i: usize| [i % m, i / m % m, i / m / m];
    let index = |p: [usize; 3]| (p[2] * m + p[1]) * m + p[0];
    let inside: Vec<bool> = (0..m * m * m).map(|i| value(place(i)) > 0.0).collect();
    let mut parent: Vec<u32> = (0..inside.len() as u32).collect();
    fn root(parent: &mut [u32], mut i: u32) -> u32 {
        while parent[i as usize] != i {
            parent[i as usize] = parent[parent[i as usize] as usize];
            i = parent[i as usize];
        }
        i
    }
    // Chains of steps from a point: each subset once, ascending, makes the simplices that start there.
    let steps: Vec<[usize; 3]> = (1..8).map(|c| [c & 1, c >> 1 & 1, c >> 2]).collect();
    let mut chi = 0i64;
    for i in 0..inside.len() {
        let p = place(i);
        let far = |s: usize| -> Option<usize> {
            let q: [usize; 3] = std::array::from_fn(|k| p[k] + steps[s][k]);
            (q.iter().all(|&x| x < m)).then(|| index(q))
        };
        for s in 0..7 {
            if let Some(q) = far(s).filter(|&q| inside[q] == inside[i]) {
                let (a, b) = (root(&mut parent, i as u32), root(&mut parent, q as u32));
                parent[a.max(b) as usize] = a.min(b);
            }
        }
        if !inside[i] {
            continue;
        }
        chi += 1;
        let is_in = |s: usize| far(s).is_some_and(|q| inside[q]);
        let below = |s: usize, t: usize| s != t && (s + 1) & (t + 1) == s + 1;
        for s in (0..7).filter(|&s| is_in(s)) {
            chi -= 1;
            for t in (0..7).filter(|&t| below(s, t) && is_in(t)) {
                chi += 1;
                chi -= (0..7).filter(|&u| below(t, u) && is_in(u)).count() as i64;
            }
        }
    }
    let regions = (0..inside.len() as u32).filter(|&i| parent[i as usize] == i).count();
    // The border is on one side, so every component of the surface parts one more region; its characteristic is twice the solid's.
    (regions - 1, 2 * chi)
}

#[test]
fn refinement_agrees() {
    let mut random = Pcg64Mcg::seed_from_u64(2026);
    let (mut tunnels, mut plain) = (0, 0);
    while tunnels < 20 || plain < 12 {
        let values = random_grid(4, &mut random);
        let found = surface([4; 3], &values, 0.0);
        let count = if found.tunnel_cells > 0 { &mut tunnels } else { &mut plain };
        if *count >= 20 {
            continue;
        }
        *count += 1;
        let wanted = (found.components.len(), found.euler_characteristic());
        // Necks thinner than the refined grid need a finer one.
        let agrees = [12, 25, 50, 80].into_iter().any(|factor| refined(4, &values, factor) == wanted);
        assert!(agrees, "{wanted:?} for {values:?}");
    }
}

#[test]
fn closed_surfaces_have_even_characteristics() {
    let mut random = Pcg64Mcg::seed_from_u64(77);
    let mut tunnels = 0;
    for _ in 0..3000 {
        let found = surface([5; 3], &random_grid(5, &mut random), 0.0);
        tunnels += usize::from(found.tunnel_cells > 0);
        for component in &found.components {
            assert_eq!(component.boundary_loops, 0);
            assert_eq!(component.euler_characteristic % 2, 0);
            assert!(component.genus() >= 0, "{component:?}");
        }
    }
    // 116 of 3,000 with another generator.
    assert!((80..160).contains(&tunnels), "{tunnels}");
}
