//! Meshes as people have them: with holes, inside out, non-manifold, with numbers that are none.

use std::f64::consts::PI;

use crate::bunny::bunny;
use glam::{DVec3, Vec3};
use isostudy_extract::by_lattice::{ExtractSettings, Lattice, extract};
use isostudy_extract::{Arrangement, Execution};
use isostudy_field::{Holes, MeshDistance, MeshFieldError, StudyField};
use isostudy_mesh::topology::topology;
use isostudy_mesh::{Bounds, MeshError, TriangleMesh, repair};
use proptest::prelude::*;

/// A cube from `low` to `low + 2`, each face cut into `n` x `n` squares, each along its diagonal; faces in the order
/// x low, x high, y low, y high, z low, z high, each `2 n n` triangles.
fn cube(low: Vec3, n: u32) -> TriangleMesh {
    let mut corners = Vec::new();
    for axis in 0..3 {
        for far in [false, true] {
            for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                let corner = |i: u32, j: u32| {
                    let mut p = Vec3::ZERO;
                    p[axis] = if far { 2.0 } else { 0.0 };
                    p[(axis + 1) % 3] = 2.0 * i as f32 / n as f32;
                    p[(axis + 2) % 3] = 2.0 * j as f32 / n as f32;
                    low + p
                };
                let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
                corners.extend(if far { [a, b, c, a, c, d] } else { [a, c, b, a, d, c] });
            }
        }
    }
    let triangles = (0..corners.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    isostudy_mesh::weld(&TriangleMesh { positions: corners, triangles, ..TriangleMesh::default() })
}

/// The cube from -1 to 1 without its lid.
fn box_without_lid(n: u32) -> TriangleMesh {
    let mut open = cube(Vec3::NEG_ONE, n);
    open.triangles.truncate((10 * n * n) as usize);
    open
}

/// The generalised winding number as a sum of solid angles over all triangles, in double precision.
fn winding_number(mesh: &TriangleMesh, p: DVec3) -> f64 {
    let angle = |t: usize| {
        let [a, b, c] = mesh.corners(t).map(|corner| corner.as_dvec3() - p);
        let (la, lb, lc) = (a.length(), b.length(), c.length());
        2.0 * a.dot(b.cross(c)).atan2(la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb)
    };
    (0..mesh.triangles.len()).map(angle).sum::<f64>() / (4.0 * PI)
}

/// The unit ball, of `12 n n` triangles.
fn ball(n: u32) -> TriangleMesh {
    cube(Vec3::NEG_ONE, n).transformed(|p| p.normalize())
}

fn joined(parts: &[TriangleMesh]) -> TriangleMesh {
    let mut all = TriangleMesh::default();
    for part in parts {
        all.triangles.extend(part.triangles.iter().map(|t| t.map(|v| v + all.positions.len() as u32)));
        all.positions.extend(&part.positions);
    }
    all
}

/// The same numbers in 0..1 for the same `i`.
fn number(i: u32) -> f32 {
    (i.wrapping_mul(2_654_435_761).wrapping_add(12_345).wrapping_mul(2_246_822_519) >> 8) as f32
        / (1u32 << 24) as f32
}

/// Every triangle for itself, each corner moved by up to `by` along each axis.
fn shaken(mesh: &TriangleMesh, by: f32) -> TriangleMesh {
    let corners = (0..mesh.triangles.len()).flat_map(|t| mesh.corners(t));
    let shake = |i: u32| Vec3::new(number(3 * i), number(3 * i + 1), number(3 * i + 2)) * 2.0 - 1.0;
    let positions: Vec<Vec3> = corners.zip(0..).map(|(p, i)| p + by * shake(i)).collect();
    let triangles = (0..positions.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    TriangleMesh { positions, triangles, ..TriangleMesh::default() }
}

fn any(mesh: &TriangleMesh, holes: Holes) -> Result<MeshDistance, MeshFieldError> {
    MeshDistance::try_from_any(mesh, holes)
}

#[test]
fn the_winding_number_is_the_sum_of_all_solid_angles() {
    let open = box_without_lid(4);
    let field = any(&open, Holes::Span).unwrap();
    // Places in the plane of the lid and on the lines of its cone are among them; the walls are not.
    for (i, j, k) in (0..9).flat_map(|i| (0..9).flat_map(move |j| (0..13).map(move |k| (i, j, k)))) {
        let p = Vec3::new(0.25 * i as f32 - 1.0, 0.25 * j as f32 - 1.0, 0.25 * k as f32 - 0.75);
        if p.x.abs() == 1.0 || p.y.abs() == 1.0 {
            continue;
        }
        let (got, want) = (field.winding_number(p), winding_number(&open, p.as_dvec3()));
        assert!((got - want).abs() < 1e-5, "{p}: {got}, not {want}");
    }
    // Half of all directions miss the box from the middle of where its lid would be, but for the walls' share.
    let middle = field.winding_number(Vec3::Z);
    assert!((middle - 0.5).abs() < 1e-5, "{middle}");
}

#[test]
fn a_sheet_spans_the_hole() {
    let field = any(&box_without_lid(6), Holes::Span).unwrap();
    let bounds = Bounds { min: Vec3::splat(-1.33), max: Vec3::splat(1.37) };
    for arrangement in [Arrangement::BodyCentred, Arrangement::SimpleCubic] {
        let lattice = Lattice::try_new(arrangement, bounds, 0.1).unwrap();
        let surface =
            extract(&field, &lattice, &ExtractSettings::default(), &Execution::default()).unwrap().mesh;
        let report = topology(&surface);
        assert!(report.is_closed_manifold() && report.euler_characteristic == 2 && report.components == 1);
        assert!((surface.volume() - 8.0).abs() < 0.2, "{}", surface.volume());
        // The sheet is level with the rim, and as smooth as the walls.
        let top = surface.bounds().unwrap().max.z;
        assert!((top - 1.0).abs() < 0.05, "{top}");
        assert!(surface.area() < 24.5, "{}", surface.area());
    }
}

/// The far parts of long loops are expanded, and there are thousands of loops in a soup.
#[test]
fn the_winding_number_is_near_the_sum_where_loops_are_many_or_long() {
    let mut half = ball(16);
    for (t, triangle) in half.triangles.iter_mut().enumerate() {
        if number(t as u32) < 0.5 {
            triangle.swap(0, 1);
        }
    }
    for mesh in [box_without_lid(40), half, shaken(&ball(12), 1e-3), shaken(&ball(3), 0.2)] {
        let field = MeshDistance::try_from_any(&mesh, Holes::Span);
        let (mesh, field) = match field {
            Ok(field) => (mesh, field),
            Err(_) => (repair::flip(&mesh), any(&repair::flip(&mesh), Holes::Span).unwrap()),
        };
        for i in 0..500 {
            let p = Vec3::new(number(7 * i), number(7 * i + 1), number(7 * i + 2)) * 3.0 - 1.5;
            let (got, want) = (field.winding_number(p), winding_number(&mesh, p.as_dvec3()));
            assert!((got - want).abs() < 1e-3, "{p}: {got}, not {want}");
        }
    }
}

#[test]
fn a_mesh_with_holes_faces_outward_or_inward() {
    let mut hemisphere = ball(8);
    hemisphere.triangles.retain(|t| t.iter().map(|&v| hemisphere.positions[v as usize].z).sum::<f32>() > 0.0);
    let far_away = |mesh: &TriangleMesh| mesh.transformed(|p| p + Vec3::new(-300.0, 500.0, 40.0));
    for (mesh, inside) in [
        (hemisphere.clone(), Vec3::Z * 0.5),
        (shaken(&ball(6), 1e-6), Vec3::ZERO),
        (shaken(&ball(6), 1e-2), Vec3::ZERO),
        (box_without_lid(3), Vec3::ZERO),
    ] {
        for (mesh, inside) in
            [(far_away(&mesh), inside + far_away(&mesh).positions[0] - mesh.positions[0]), (mesh, inside)]
        {
            let field = any(&mesh, Holes::Span).unwrap();
            assert!(field.sample(inside) > 0.1, "{}", field.sample(inside));
            let inward = any(&repair::flip(&mesh), Holes::Span).unwrap_err();
            assert!(matches!(inward, MeshFieldError::InsideOut { volume } if volume < -0.1), "{inward}");
        }
    }
    // A sheet has no inside, flat as it is or shaken by little.
    let mut sheet = cube(Vec3::ZERO, 4);
    sheet.triangles.truncate(32);
    for mesh in [sheet.clone(), shaken(&sheet, 1e-7), sheet.transformed(|p| p + 7.0)] {
        for mesh in [repair::flip(&mesh), mesh] {
            assert!(matches!(any(&mesh, Holes::Span), Err(MeshFieldError::Flat { volume, area })
                if volume.abs() < 1e-5 && (area - 4.0).abs() < 1e-3));
        }
    }
    // And so has one with a back.
    let both = isostudy_mesh::weld(&joined(&[sheet.clone(), repair::flip(&sheet)]));
    assert!(matches!(any(&both, Holes::Refuse), Err(MeshFieldError::Flat { .. })));
}

/// Samples on the walls of either box inside the other, and on a wall that two boxes share.
#[test]
fn inner_walls_do_not_tear_the_solid() {
    let block = |low: Vec3, size: Vec3| cube(Vec3::ZERO, 2).transformed(|p| low + p * 0.5 * size);
    let overlapping =
        [block(Vec3::ZERO, Vec3::ONE), block(Vec3::new(0.5, 0.25, 0.25), Vec3::new(1.0, 0.5, 0.5))];
    let touching = [block(Vec3::ZERO, Vec3::ONE), block(Vec3::X, Vec3::ONE)];
    let corner = [block(Vec3::ZERO, Vec3::ONE), block(Vec3::splat(0.5), Vec3::ONE)];
    let box_around = Bounds { min: Vec3::NEG_ONE, max: Vec3::splat(2.0) };
    for (parts, volume) in [(overlapping, 1.125), (touching, 2.0), (corner, 1.875)] {
        let field = any(&joined(&parts), Holes::Refuse).unwrap();
        for arrangement in [Arrangement::SimpleCubic, Arrangement::BodyCentred] {
            let lattice = Lattice::try_new(arrangement, box_around, 0.125).unwrap();
            let surface =
                extract(&field, &lattice, &ExtractSettings::default(), &Execution::default()).unwrap().mesh;
            let report = topology(&surface);
            assert!(report.is_closed_manifold(), "{report:?}");
            assert_eq!((report.components, report.euler_characteristic), (1, 2), "{arrangement:?}");
            assert!((surface.volume() - volume).abs() < 0.1, "{arrangement:?}: {}", surface.volume());
        }
        // The outer surface is at zero, and so is the seam where two outer surfaces meet.
        assert_eq!(field.sample(Vec3::new(0.25, 0.0, 0.25)), 0.0);
    }
    let field =
        any(&joined(&[block(Vec3::ZERO, Vec3::ONE), block(Vec3::splat(0.5), Vec3::ONE)]), Holes::Refuse)
            .unwrap();
    assert_eq!(field.sample(Vec3::new(1.0, 0.5, 0.75)), 0.0);
    assert_eq!(field.sample(Vec3::new(0.5, 0.75, 0.75)), f32::MIN_POSITIVE);
    // In a row as alone.
    let mut row = [0.0; 17];
    let x: Vec<f32> = (0..17).map(|i| 0.125 * i as f32 - 0.25).collect();
    field.sample_row(&x, 0.75, 0.75, &mut row);
    assert!(x.iter().zip(row).all(|(&x, value)| value == field.sample(Vec3::new(x, 0.75, 0.75))));
}

#[test]
fn parts_that_face_inward_and_enclose_nothing_are_found() {
    let at = |mesh: &TriangleMesh, x: f32, scale: f32| mesh.transformed(|p| p * scale + Vec3::X * x);
    let (out, inward) = (ball(4), repair::flip(&ball(4)));
    let mut open = at(&inward, 9.0, 1.0);
    open.triangles.truncate(180);
    let parts = [
        at(&out, 0.0, 2.0),
        // A cavity, an island in it, and a box that overlaps the ball.
        at(&inward, 0.0, 1.0),
        at(&out, 0.0, 0.5),
        at(&out, 2.0, 0.7),
        at(&inward, 5.0, 0.8),
        open,
    ];
    let mesh = joined(&parts);
    let found = any(&mesh, Holes::Span).unwrap().inward_parts(&mesh);
    assert_eq!(
        found.iter().map(|part| (part.part, part.parts, part.triangles)).collect::<Vec<_>>(),
        [(4, 6, 192), (5, 6, 180)]
    );
    let bounds = found[0].bounds;
    assert!((bounds.min.x - 4.2).abs() < 1e-5 && (bounds.max.x - 5.8).abs() < 1e-5, "{bounds:?}");
    assert_eq!(any(&joined(&parts[..4]), Holes::Refuse).unwrap().inward_parts(&joined(&parts[..4])), []);
}

#[test]
fn what_is_wrong_says_where() {
    let open = box_without_lid(2);
    let error = any(&open, Holes::Refuse).unwrap_err();
    assert_eq!(
        error,
        MeshFieldError::Open { edges: 8, rings: 1, longest: 8, centre: Vec3::Z, radius: 2f32.sqrt() }
    );
    // One triangle the wrong way round: its three edges are run twice one way.
    let mut turned = cube(Vec3::ZERO, 1);
    turned.triangles[3].swap(0, 1);
    assert!(matches!(any(&turned, Holes::Refuse), Err(MeshFieldError::Open { edges: 6, rings: 1, .. })));
    let mut not_a_number = cube(Vec3::ZERO, 1);
    not_a_number.positions[5].y = f32::NAN;
    assert!(matches!(
        any(&not_a_number, Holes::Span),
        Err(MeshFieldError::Mesh(MeshError::Coordinate { vertex: 5, .. }))
    ));
    let mut beyond = cube(Vec3::ZERO, 1);
    beyond.triangles[7][2] = 8;
    let want = MeshFieldError::Mesh(MeshError::IndexOutOfRange { triangle: 7, index: 8, vertices: 8 });
    assert_eq!(any(&beyond, Holes::Span).unwrap_err(), want);
    let inward = repair::flip(&cube(Vec3::ZERO, 2));
    assert!(
        matches!(any(&inward, Holes::Refuse), Err(MeshFieldError::InsideOut { volume }) if volume < -7.99)
    );
    assert!(any(&repair::flip(&inward), Holes::Refuse).is_ok());
    assert!(matches!(any(&repair::flip(&open), Holes::Span), Err(MeshFieldError::InsideOut { .. })));
    let flat = TriangleMesh { triangles: vec![[0, 0, 1]], ..cube(Vec3::ZERO, 1) };
    assert_eq!(any(&flat, Holes::Span).unwrap_err(), MeshFieldError::Mesh(MeshError::Empty));
}

/// Two cubes that share an edge, one that overlaps them, and a triangle without area: every edge is run as often one way as
/// the other.
#[test]
fn what_is_closed_need_not_be_a_manifold() {
    let mut both = cube(Vec3::ZERO, 1);
    for low in [Vec3::new(2.0, 2.0, 0.0), Vec3::new(1.0, 0.5, -0.5)] {
        let next = cube(low, 1);
        both.triangles.extend(next.triangles.iter().map(|t| t.map(|v| v + both.positions.len() as u32)));
        both.positions.extend(next.positions);
    }
    let mut both = isostudy_mesh::weld(&both);
    both.triangles.push([0, 1, 1]);
    assert!(topology(&both).non_manifold_edges == 1 && MeshDistance::try_new(&both).is_err());
    let field = any(&both, Holes::Refuse).unwrap();
    for (p, winding, value) in [
        ([0.5, 1.0, 1.8], 1.0, 0.2),
        ([3.4, 3.4, 1.0], 1.0, 0.6),
        ([1.0, 3.0, 1.0], 0.0, -0.5),
        ([1.5, 1.5, 1.0], 2.0, 0.5),
    ] {
        let p = Vec3::from(p);
        assert_eq!(field.winding_number(p), winding);
        assert!((field.sample(p) - value).abs() < 1e-6, "{p}: {}", field.sample(p));
    }
}

/// The scan with its five holes against the mended one, of which only the sheets differ.
#[test]
fn the_bunny_with_its_holes_is_the_bunny() {
    let Some(closed) = bunny() else { return };
    // Closing holes adds one vertex a hole, at the end, and its triangles.
    let mut open = closed.clone();
    open.triangles.truncate(closed.triangles.len() - 200);
    let (whole, spanned) = (any(&closed, Holes::Refuse).unwrap(), any(&open, Holes::Span).unwrap());
    let Err(MeshFieldError::Open { rings, .. }) = any(&open, Holes::Refuse) else { panic!("it has holes") };
    assert!(rings >= 1);
    let bounds = closed.bounds().unwrap();
    let (mut differ, mut count) = (0, 0);
    for i in 0..30_000u32 {
        let part = |k: u32| (i.wrapping_mul(k) >> 8) as f32 / (1u32 << 24) as f32;
        let p = bounds.min
            + bounds.size() * Vec3::new(part(2_654_435_761), part(2_246_822_519), part(3_266_489_917));
        differ += usize::from(whole.sample(p) != spanned.sample(p));
        count += usize::from(spanned.sample(p) > 0.0);
    }
    assert!(count > 3_000 && differ < 300, "{count} inside, {differ} of 30,000 differ");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// What is promised of a box holds in it, near holes and far from them.
    #[test]
    fn the_slope_is_kept(
        centre in prop::array::uniform3(-4.0f32..4.0),
        size in 0.01f32..2.0,
        parts in prop::collection::vec((prop::array::uniform3(0.0f32..1.0), prop::array::uniform3(0.0f32..1.0)), 20),
    ) {
        let field = any(&box_without_lid(2), Holes::Span).unwrap();
        let low = Vec3::from(centre) - size * 0.5;
        let bounds = Bounds { min: low, max: low + size };
        if let Some(slope) = field.slope(bounds) {
            for (a, b) in parts {
                let (p, q) = (low + Vec3::from(a) * size, low + Vec3::from(b) * size);
                let change = (field.sample(p) - field.sample(q)).abs();
                prop_assert!(change <= slope * p.distance(q) + 1e-4, "{p} {q} {change}");
            }
        }
    }
}
