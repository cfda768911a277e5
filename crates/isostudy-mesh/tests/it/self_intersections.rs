//! Pairs of triangles that pass through each other: counted by hand, by all pairs, and none where there are none.

use isostudy_mesh::glam::{Mat3, Vec3};
use isostudy_mesh::{MOST_INTERSECTIONS, MeshError, TriangleMesh, self_intersections};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

fn soup(triangles: &[[Vec3; 3]]) -> TriangleMesh {
    TriangleMesh {
        positions: triangles.concat(),
        normals: Vec::new(),
        triangles: (0..triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
    }
}

fn count(triangles: &[[Vec3; 3]]) -> u64 {
    self_intersections(&soup(triangles)).unwrap()
}

/// A ball of triangles, by halving the sides of an octahedron's.
fn ball(halvings: u32) -> Vec<[Vec3; 3]> {
    let mut triangles: Vec<[Vec3; 3]> = Vec::new();
    for octant in 0..8 {
        let [x, y, z] = [0, 1, 2].map(|axis| if octant >> axis & 1 == 0 { 1.0_f32 } else { -1.0 });
        let [a, b, c] = [Vec3::X * x, Vec3::Y * y, Vec3::Z * z];
        triangles.push(if x * y * z > 0.0 { [a, b, c] } else { [a, c, b] });
    }
    for _ in 0..halvings {
        triangles = triangles
            .into_iter()
            .flat_map(|[a, b, c]| {
                let [ab, bc, ca] = [a + b, b + c, c + a].map(Vec3::normalize);
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    triangles
}

#[test]
fn pairs_by_hand() {
    let p = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
    let floor = [p(0.0, 0.0, 0.0), p(4.0, 0.0, 0.0), p(0.0, 4.0, 0.0)];
    for (name, other, want) in [
        ("through it", [p(1.0, 1.0, -1.0), p(1.0, 1.0, 1.0), p(9.0, 9.0, 1.0)], 1),
        ("above it", [p(1.0, 1.0, 0.5), p(1.0, 2.0, 1.0), p(9.0, 9.0, 1.0)], 0),
        ("beside it", [p(4.0, 4.0, -1.0), p(4.0, 4.0, 1.0), p(5.0, 5.0, 0.0)], 0),
        ("a corner on it", [p(1.0, 1.0, 0.0), p(1.0, 2.0, 1.0), p(2.0, 1.0, 1.0)], 1),
        ("a corner in common", [p(0.0, 0.0, 0.0), p(-1.0, 0.0, 1.0), p(0.0, -1.0, 1.0)], 0),
        ("a corner in common, and through it", [p(0.0, 0.0, 0.0), p(1.0, 1.0, -1.0), p(1.0, 1.0, 1.0)], 1),
        ("a side in common", [p(0.0, 0.0, 0.0), p(4.0, 0.0, 0.0), p(0.0, 0.0, 4.0)], 0),
        ("a side in common, flat, beside", [p(0.0, 0.0, 0.0), p(4.0, 0.0, 0.0), p(0.0, -4.0, 0.0)], 0),
        ("a side in common, flat, on it", [p(0.0, 0.0, 0.0), p(4.0, 0.0, 0.0), p(3.0, 3.0, 0.0)], 1),
        ("the same", [p(4.0, 0.0, 0.0), p(0.0, 0.0, 0.0), p(0.0, 4.0, 0.0)], 1),
        ("within it, flat", [p(1.0, 1.0, 0.0), p(1.5, 1.0, 0.0), p(1.0, 1.5, 0.0)], 1),
        ("part of a side in common", [p(1.0, 0.0, 0.0), p(3.0, 0.0, 0.0), p(2.0, 0.0, 3.0)], 1),
        ("without area", [p(1.0, 1.0, -1.0), p(1.0, 1.0, 1.0), p(1.0, 1.0, 1.0)], 0),
    ] {
        assert_eq!(count(&[floor, other]), want, "{name}");
        assert_eq!(count(&[other, floor]), want, "{name}");
        // Vertices at one place are one, with one number or two.
        let welded = isostudy_mesh::weld(&soup(&[floor, other]));
        if welded.triangles.len() == 2 {
            assert_eq!(self_intersections(&welded), Ok(want), "{name}");
        }
    }
}

#[test]
fn closed_surfaces_have_none_and_their_crossings_are_counted() {
    let one = ball(4);
    assert_eq!(count(&one), 0);
    assert_eq!(self_intersections(&isostudy_mesh::weld(&soup(&one))), Ok(0));
    // Turned by a little, so that nothing touches by chance: two spheres meet in a circle, whose length is known.
    let turn = Mat3::from_rotation_x(0.3) * Mat3::from_rotation_y(0.5);
    let other: Vec<[Vec3; 3]> =
        one.iter().map(|t| t.map(|p| turn * p + Vec3::new(0.9, 0.37, 0.11))).collect();
    let both = [&one[..], &other].concat();
    let pairs = count(&both);
    // The circle crosses each mesh about so many times; each crossing into another triangle begins a new pair.
    let radius = (1.0 - 0.25 * Vec3::new(0.9, 0.37, 0.11).length_squared()).sqrt();
    let edge = one.iter().map(|t| t[0].distance(t[1])).sum::<f32>() / one.len() as f32;
    let rough = 2.0 * std::f32::consts::TAU * radius / edge;
    assert!((0.7 * rough..3.0 * rough).contains(&(pairs as f32)), "{pairs}, roughly {rough}");
    // Apart again there are none.
    let far: Vec<[Vec3; 3]> = other.iter().map(|t| t.map(|p| p + Vec3::splat(3.0))).collect();
    assert_eq!(count(&[&one[..], &far].concat()), 0);
}

/// As many as pairs that meet when each is looked at alone.
#[test]
fn the_tree_finds_every_pair() {
    let mut random = Pcg64Mcg::seed_from_u64(2);
    for size in [0.05, 0.3, 2.0] {
        let mut point =
            |size: f32| Vec3::from_array(std::array::from_fn(|_| (random.random::<f32>() - 0.5) * size));
        let mut triangles: Vec<[Vec3; 3]> = (0..150)
            .map(|_| {
                let a = point(1.0);
                [a, a + point(size), a + point(size)]
            })
            .collect();
        // Some share corners and sides.
        for t in 0..50 {
            triangles[t + 50][0] = triangles[t][1];
            let [a, _, c] = triangles[t];
            triangles[t + 100][..2].copy_from_slice(&[c, a]);
        }
        let one_by_one: u64 = (0..triangles.len())
            .flat_map(|i| (0..i).map(move |j| (i, j)))
            .map(|(i, j)| count(&[triangles[i], triangles[j]]))
            .sum();
        assert_eq!(count(&triangles), one_by_one);
        assert!(one_by_one > 0);
    }
}

#[test]
fn what_is_no_mesh_is_refused() {
    let mut broken = soup(&ball(0));
    broken.triangles[3] = [0, 1, 99];
    assert!(matches!(self_intersections(&broken), Err(MeshError::IndexOutOfRange { .. })));
    broken.triangles.clear();
    assert!(self_intersections(&broken).is_err());
}

/// By looking at every pair alone: no tree, no fan, no book.
fn one_by_one(triangles: &[[Vec3; 3]]) -> u64 {
    let pairs = (0..triangles.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
    pairs.map(|(i, j)| count(&[triangles[i], triangles[j]])).sum()
}

/// Round one corner, round one side, long and thin, lying on each other, and all of that in one soup: as many as pair by pair.
#[test]
fn fans_books_slivers_and_sheets_are_counted_as_pair_by_pair() {
    let mut random = Pcg64Mcg::seed_from_u64(7);
    let mut seen = [0; 5];
    for round in 0..40 {
        // A coarse lattice of places makes ties: corners on sides, sides on planes, triangles twice.
        let places = if round % 2 == 0 { 5.0 } else { 4096.0 };
        let mut point =
            || Vec3::from_array(std::array::from_fn(|_| (random.random::<f32>() * places).floor() / places));
        let [apex, end] = [point(), point()];
        let fan: Vec<[Vec3; 3]> = (0..70).map(|_| [point(), apex, point()]).collect();
        let book: Vec<[Vec3; 3]> = (0..70).map(|_| [end, point(), apex]).collect();
        let slivers: Vec<[Vec3; 3]> = (0..70)
            .map(|_| {
                let [a, b] = [point(), point()];
                [a, b, b + 0.001 * (point() - b)]
            })
            .collect();
        let sheets: Vec<[Vec3; 3]> = (0..70)
            .map(|i| [point(), point(), point()].map(|p| Vec3::new(p.x, p.y, (i % 2) as f32)))
            .collect();
        let all = [&fan[..30], &book[..40], &slivers[..30], &sheets[..30], &fan[..5]].concat();
        for (kind, triangles) in [fan, book, slivers, sheets, all].into_iter().enumerate() {
            let found = count(&triangles);
            assert_eq!(found, one_by_one(&triangles), "round {round}, kind {kind}");
            seen[kind] += found;
        }
    }
    assert!(seen.iter().all(|pairs| *pairs > 100), "{seen:?}");
}

/// Each would take minutes or hours if all pairs of boxes that meet were looked at.
#[test]
fn what_meets_in_boxes_alone_takes_no_time() {
    let ring = |i: u32, of: u32| {
        let (sin, cos) = (std::f32::consts::TAU * i as f32 / of as f32).sin_cos();
        Vec3::new(cos, sin, 0.0)
    };
    let side = |i: u32, of: u32| [ring(i, of), ring((i + 1) % of, of)];
    let cone = |tip: Vec3, of: u32| (0..of).map(move |i| [side(i, of)[0], side(i, of)[1], tip]);
    let of = 64_000;
    let one: Vec<[Vec3; 3]> = cone(Vec3::Z, of).collect();
    assert_eq!(count(&one), 0);
    // Through its middle, a triangle that crosses both sides, of a width that is known.
    let across = [Vec3::new(-3.0, 0.1, 0.5), Vec3::new(3.0, 0.1, 0.5), Vec3::new(0.0, 9.0, 0.5)];
    let crossed = count(&[&one[..], &[across]].concat());
    // The cone's circle at this height has a radius of one half; above y = .1 lies this share of it.
    let share = 1.0 - 2.0 * f64::asin(0.2) / std::f64::consts::PI;
    assert!((crossed as f64 / (0.5 * f64::from(of) * share) - 1.0).abs() < 1e-3, "{crossed}");
    // Pages of a book, of which none lies on another; and each twice.
    let spine = [Vec3::new(0.0, 0.0, -1.0), Vec3::new(0.1, 0.0, 1.0)];
    let book: Vec<[Vec3; 3]> = (0..of).map(|i| [spine[0], spine[1], 2.0 * ring(i, of)]).collect();
    assert_eq!(count(&book), 0);
    assert_eq!(count(&[&book[..], &book].concat()), u64::from(of));
    let equal = vec![[Vec3::ZERO, Vec3::X, Vec3::Y]; 300_000];
    assert_eq!(count(&equal), MOST_INTERSECTIONS);
}

/// Long triangles side by side along the diagonal, that boxes along the axes cannot tell apart: the search ends and says so.
#[test]
fn a_search_without_end_is_given_up() {
    let diagonal = Vec3::ONE;
    let slivers: Vec<[Vec3; 3]> = (0..60_000)
        .map(|i| {
            let from = Vec3::new(1.0, -1.0, 0.0) * (1e-6 * i as f32);
            [from, from + diagonal, from + diagonal + Vec3::new(1e-7, -1e-7, 0.0)]
        })
        .collect();
    let error = self_intersections(&soup(&slivers)).unwrap_err();
    assert!(matches!(error, MeshError::Entangled { .. }), "{error:?}");
}
