//! Integrals against adaptive quadrature, moments against sums, gradients against differences.

use glam::{DVec3, Vec3};
use isostudy_field::StudyField;
use isostudy_mesh::TriangleMesh;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::patch::Patch;
use super::real::Point;
use super::tree::Tree;
use super::{SoupError, SoupField};

/// The weight's integral by quadrature, which knows no closed form: a triangle is cut in four until two rules agree.
fn by_quadrature(corners: [DVec3; 3], x: DVec3, squared: f64) -> f64 {
    let weight = |p: DVec3| (p.distance_squared(x) + squared).powi(-2);
    // Exact to degree 5: Strang and Fix (1973).
    let rule = |[a, b, c]: [DVec3; 3]| {
        let root = 15f64.sqrt();
        let mut sum = 0.225 * weight((a + b + c) / 3.0);
        for sign in [-1.0, 1.0] {
            let share = (6.0 + sign * root) / 21.0;
            let part = (155.0 + sign * root) / 1200.0;
            for [p, q, r] in [[a, b, c], [b, c, a], [c, a, b]] {
                sum += part * weight(share * p + share * q + (1.0 - 2.0 * share) * r);
            }
        }
        0.5 * (b - a).cross(c - a).length() * sum
    };
    let [a, b, c] = corners;
    let [ab, bc, ca] = [a.midpoint(b), b.midpoint(c), c.midpoint(a)];
    let parts = [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]];
    let (whole, halves) = (rule(corners), parts.into_iter().map(rule).sum::<f64>());
    if (whole - halves).abs() <= 1e-8 * halves {
        return halves;
    }
    parts.into_iter().map(|part| by_quadrature(part, x, squared)).sum()
}

fn integral(corners: [DVec3; 3], x: DVec3, squared: f64) -> f64 {
    Patch::of(corners).expect("a triangle").integral(Point::plain(x), squared)
}

fn triangle() -> [DVec3; 3] {
    [DVec3::new(0.1, -0.2, 0.3), DVec3::new(1.2, 0.1, -0.1), DVec3::new(0.2, 0.9, 0.4)]
}

#[test]
fn integrals_are_those_of_quadrature() {
    let corners = triangle();
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize();
    // Over the inside, over an edge, over its extension, over a corner, beside, and far away; at several heights.
    let feet = [
        [0.3, 0.4, 0.3],
        [0.5, 0.5, 0.0],
        [1.7, -0.7, 0.0],
        [1.0, 0.0, 0.0],
        [-0.2, 0.6, 0.6],
        [9.0, -3.0, -5.0],
    ];
    let mut looks = 0;
    for shares in feet {
        let foot = shares[0] * corners[0] + shares[1] * corners[1] + shares[2] * corners[2];
        for height in [0.0, 0.003, 0.1, -0.7, 4.0] {
            for epsilon in [0.01, 0.3] {
                let (x, squared) = (foot + height * normal, epsilon * epsilon);
                let found = integral(corners, x, squared);
                let want = by_quadrature(corners, x, squared);
                assert!(
                    (found - want).abs() <= 1e-7 * want,
                    "{shares:?}, {height}, {epsilon}: {found} for {want}"
                );
                looks += 1;
            }
        }
    }
    assert_eq!(looks, 60);
}

/// Beside the triangle and in its plane with next to no epsilon, where the closed form cancels.
#[test]
fn integrals_beside_a_triangle_keep_their_digits() {
    let corners = triangle();
    for shares in [
        [-0.2, 0.6, 0.6],
        [1.5, -0.5, 0.0],
        [1.4, -0.2, -0.2],
        [-0.01, 0.505, 0.505],
        [3.0, -2.0 - 1e-9, 1e-9],
    ] {
        let x = shares[0] * corners[0] + shares[1] * corners[1] + shares[2] * corners[2];
        for epsilon in [1e-6, 1e-5, 1e-4, 1e-3] {
            let squared = epsilon * epsilon;
            let found = integral(corners, x, squared);
            let want = by_quadrature(corners, x, squared);
            assert!((found - want).abs() <= 1e-7 * want, "{shares:?}, {epsilon}: {found} for {want}");
        }
    }
}

/// Over the whole plane the integral is pi over the square of the height.
#[test]
fn a_large_triangle_is_a_plane() {
    let corners = [DVec3::new(-4e4, -3e4, 0.0), DVec3::new(4e4, -3e4, 0.0), DVec3::new(0.0, 5e4, 0.0)];
    for (height, epsilon) in [(0.5, 0.0), (0.3, 0.4), (1e-3, 0.0)] {
        let found = integral(corners, DVec3::new(1.0, 2.0, height), epsilon * epsilon);
        let want = std::f64::consts::PI / (height * height + epsilon * epsilon);
        assert!((found / want - 1.0).abs() < 1e-8, "{found} for {want}");
    }
}

/// An octahedron cut finely and pushed onto a ball, without its neighbourhoods.
fn ball(cuts: u32, keep: impl Fn(Vec3) -> bool) -> TriangleMesh {
    let mut mesh = TriangleMesh::default();
    for octant in 0..8 {
        let sign = |bit: u32| if octant >> bit & 1 == 0 { 1.0 } else { -1.0 };
        let signs = Vec3::new(sign(0), sign(1), sign(2));
        let at = |i: u32, j: u32| {
            let p = Vec3::new(i as f32, j as f32, (cuts - i - j) as f32);
            (p * signs).normalize()
        };
        let mut push = |mut corners: [Vec3; 3]| {
            let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            if normal.dot(corners[0]) < 0.0 {
                corners.swap(1, 2);
            }
            if keep((corners[0] + corners[1] + corners[2]) / 3.0) {
                let first = mesh.positions.len() as u32;
                mesh.positions.extend(corners);
                mesh.triangles.push([first, first + 1, first + 2]);
            }
        };
        for i in 0..cuts {
            for j in 0..cuts - i {
                push([at(i, j), at(i + 1, j), at(i, j + 1)]);
                if i + j + 1 < cuts {
                    push([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
                }
            }
        }
    }
    mesh
}

fn places(many: usize, seed: u64) -> Vec<DVec3> {
    let mut random = Pcg64::seed_from_u64(seed);
    (0..many).map(|_| DVec3::from_array(std::array::from_fn(|_| random.random_range(-1.5..1.5)))).collect()
}

#[test]
fn moments_stand_for_what_is_far() {
    let mesh = ball(12, |_| true);
    let patches =
        (0..mesh.triangles.len()).map(|t| Patch::of(mesh.corners(t).map(|p| p.as_dvec3())).unwrap());
    let tree = Tree::new(patches.collect());
    for squared in [1e-8, 0.01] {
        let mut worst = 0.0f64;
        for x in places(300, 7) {
            let fast = tree.sums(Point::plain(x), squared);
            let slow = tree.sums_of_all(Point::plain(x), squared);
            worst = worst.max((fast.distances / fast.weights - slow.distances / slow.weights).abs());
            assert!((fast.weights / slow.weights - 1.0).abs() < 2e-2, "{x}");
        }
        assert!(worst < 4e-3, "{worst}");
        println!("moments: at most {worst:.1e} of a radius off");
    }
}

#[test]
fn gradients_are_those_of_the_values() {
    let field = SoupField::try_new(&ball(6, |p| p.z < 0.5), Some(0.05)).unwrap();
    let mut looks = 0;
    for x in places(200, 3) {
        let gradient = field.value(Point::with_gradient(x)).gradient;
        let step = 1e-6;
        let differences = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| {
            let at = |side: f64| field.value(Point::plain(x + side * step * axis));
            (at(1.0) - at(-1.0)) / (2.0 * step)
        });
        let off = (gradient - DVec3::from_array(differences)).length();
        // A step may cross the distance from which moments stand for a group.
        looks += usize::from(off < 1e-6 * (1.0 + gradient.length()));
    }
    assert!(looks > 190, "{looks} of 200");
}

#[test]
fn triangles_of_one_plane_give_it() {
    // x + 2 y - 2 z = 3, of normal (1, 2, -2) / 3; triangles of all sizes.
    let (normal, along, across) =
        (DVec3::new(1.0, 2.0, -2.0) / 3.0, DVec3::new(2.0, 1.0, 2.0) / 3.0, DVec3::new(-2.0, 2.0, 1.0) / 3.0);
    let mut mesh = TriangleMesh::default();
    for (i, pair) in places(120, 11).chunks(3).enumerate() {
        let corners: Vec<Vec3> =
            pair.iter().map(|p| (normal + p.x * along + p.y * across).as_vec3()).collect();
        let first = 3 * i as u32;
        let turn = (corners[1] - corners[0]).cross(corners[2] - corners[0]).as_dvec3().dot(normal) > 0.0;
        mesh.positions.extend(corners);
        mesh.triangles.push(if turn { [first, first + 1, first + 2] } else { [first, first + 2, first + 1] });
    }
    for epsilon in [0.0, 0.02, 5.0] {
        let field = SoupField::try_new(&mesh, Some(epsilon)).unwrap();
        for x in places(200, 13) {
            let want = 1.0 - normal.dot(x);
            let found = field.value(Point::plain(x));
            assert!((found - want).abs() < 5e-6, "{found} for {want}");
            let gradient = field.value(Point::with_gradient(x)).gradient;
            assert!((gradient + normal).length() < 1e-4, "{gradient}");
        }
    }
}

#[test]
fn a_field_without_epsilon_goes_through_its_triangles() {
    let mesh = ball(5, |p| p.x < 0.8);
    let field = SoupField::try_new(&mesh, Some(0.0)).unwrap();
    for t in 0..mesh.triangles.len() {
        let [a, b, c] = mesh.corners(t);
        let middle = (a + b + c) / 3.0;
        assert!(field.sample(middle).abs() < 1e-5, "{t}: {}", field.sample(middle));
        let normal = (b - a).cross(c - a).normalize();
        assert!(field.sample(middle + 0.02 * normal) < 0.0 && field.sample(middle - 0.02 * normal) > 0.0);
        let gradient = field.gradient(middle).unwrap();
        assert!((gradient + normal).length() < 1e-2, "{t}: {gradient} for {normal}");
    }
}

#[test]
fn flat_and_odd_triangles_are_left_out_or_refused() {
    let mut mesh = ball(2, |_| true);
    let many = mesh.triangles.len();
    let whole = SoupField::try_new(&mesh, Some(0.1)).unwrap();
    assert_eq!(whole.flat(), None);
    mesh.triangles.insert(3, [0, 1, 1]);
    let first = mesh.positions.len() as u32;
    mesh.positions.extend([Vec3::ZERO, Vec3::splat(0.25), Vec3::splat(0.5)]);
    mesh.triangles.push([first, first + 1, first + 2]);
    let field = SoupField::try_new(&mesh, Some(0.1)).unwrap();
    let flat = field.flat().unwrap();
    assert_eq!((flat.many, flat.first, mesh.triangles.len()), (2, 3, many + 2));
    for p in places(50, 17) {
        assert_eq!(field.sample(p.as_vec3()).to_bits(), whole.sample(p.as_vec3()).to_bits());
    }
    mesh.triangles = vec![[0, 1, 1], [2, 2, 2]];
    assert_eq!(SoupField::try_new(&mesh, None).unwrap_err(), SoupError::Flat { triangles: 2 });
    for odd in [-0.1, f64::NAN, f64::INFINITY] {
        assert!(matches!(SoupField::try_new(&ball(1, |_| true), Some(odd)), Err(SoupError::Epsilon(_))));
    }
    let none = TriangleMesh::default();
    assert_eq!(SoupField::try_new(&none, None).unwrap_err().to_string(), "the mesh has no triangles");
    assert!(
        whole.sample(Vec3::new(f32::NAN, 0.0, 0.0)).is_nan() && whole.gradient(Vec3::splat(2e18)).is_none()
    );
}
