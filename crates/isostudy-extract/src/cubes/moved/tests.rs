//! Our reading of Macet: the triangles of its table, better shaped, and what that costs.

use glam::Vec3;
use isostudy_extract::{
    BoxGrid, Cubes, Diagonals, Execution, Extraction, Extractor, Macet, Method, MethodError, Source, accuracy,
};
use isostudy_field::{Asteroid, Gyroid, Sphere, StudyField};
use isostudy_mesh::quality::quality;
use isostudy_mesh::{Bounds, TriangleMesh};

const ONE: Execution = Execution { threads: 1 };

/// The test signal of Marschner and Lobb (1994).
struct Ripples;

impl StudyField for Ripples {
    fn sample(&self, p: Vec3) -> f32 {
        use std::f32::consts::{FRAC_PI_2, TAU};
        let ripple = (TAU * 6.0 * (FRAC_PI_2 * p.truncate().length()).cos()).cos();
        (1.0 - (FRAC_PI_2 * p.z).sin() + 0.25 * (1.0 + ripple)) / 2.5 - 0.5
    }
}

struct Case {
    name: &'static str,
    field: Box<dyn StudyField>,
    spacing: f32,
}

fn cases() -> Vec<Case> {
    let of = |name, field: Box<dyn StudyField>, spacing| Case { name, field, spacing };
    vec![
        of("sphere", Box::new(Sphere { radius: 1.0 }), 0.05),
        of("asteroid", Box::<Asteroid>::default(), 0.03),
        of("gyroid", Box::new(Gyroid { frequency: 9.0 }), 0.03),
        of("Marschner-Lobb", Box::new(Ripples), 0.02),
    ]
}

fn grid(spacing: f32) -> BoxGrid {
    BoxGrid { bounds: Bounds { min: Vec3::splat(-1.1), max: Vec3::splat(1.1) }, spacing }
}

fn run(method: Method, case: &Case, threads: usize) -> Extraction {
    let execution = Execution { threads };
    method
        .extract(&mut Extractor::new(), Source::Study(&*case.field), &grid(case.spacing), 0.0, &execution)
        .unwrap()
}

fn table() -> Method {
    Method::Cubes(Cubes { diagonals: Diagonals::EdgeGroups, ..Cubes::default() })
}

#[test]
fn triangles_are_those_of_its_table_on_any_number_of_threads() {
    for case in cases() {
        let one = run(Method::Macet(Macet::default()), &case, 1).mesh;
        assert_eq!(one.triangles, run(table(), &case, 1).mesh.triangles, "{}", case.name);
        assert!(one == run(Method::Macet(Macet::default()), &case, 3).mesh, "{}", case.name);
    }
}

/// Without moves it is the table's mesh to the byte.
#[test]
fn without_pull_and_steps_it_is_marching_cubes() {
    struct Linear;
    impl StudyField for Linear {
        fn sample(&self, p: Vec3) -> f32 {
            0.13 - p.dot(Vec3::new(0.3, 0.7, 0.2))
        }
    }
    let case = Case { name: "plane", field: Box::new(Linear), spacing: 0.2 };
    let still = Macet { pull: 0.0, steps: 0, ..Macet::default() };
    let (moved, plain) = (run(Method::Macet(still), &case, 1).mesh, run(table(), &case, 1).mesh);
    // Crossings of a plane are on it already.
    let far = moved.positions.iter().zip(&plain.positions).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
    assert!(moved.triangles == plain.triangles && far < 1e-5, "{far}");
    assert!(!plain.triangles.is_empty());
}

/// Smallest and largest angle, and smallest radius ratio, of the triangles that have no vertex on the box: those that have are cut
/// off there.
fn worst(mesh: &TriangleMesh) -> [f64; 3] {
    let is_free = |v: u32| mesh.positions[v as usize].abs().max_element() < 1.0999;
    let triangles = mesh.triangles.iter().copied().filter(|triangle| triangle.iter().all(|&v| is_free(v)));
    let part = TriangleMesh { triangles: triangles.collect(), ..mesh.clone() };
    let quality = quality(&part);
    [quality.min_angle_deg.min, quality.max_angle_deg.max, quality.radius_ratio.min]
}

/// The published band, 17 to 21 degrees and ratios from 0.43, is of other volumes. Here it is met in angle on the sphere alone; what
/// is demanded is what is reached on surfaces that bend within a cell, with the distances that it costs.
#[test]
fn triangles_are_far_better_and_no_farther_from_the_surface_on_average() {
    for case in cases() {
        let (plain, moved) =
            (run(table(), &case, 1).mesh, run(Method::Macet(Macet::default()), &case, 1).mesh);
        let of = |mesh: &TriangleMesh| accuracy(mesh, &*case.field, 0.0, &grid(case.spacing), &ONE).unwrap();
        let (before, after) = (of(&plain), of(&moved));
        let ([from, _, _], [angle, most, ratio]) = (worst(&plain), worst(&moved));
        let twentieth = quality(&moved).min_angle_deg.q05;
        let in_spacings = |distance: f64| distance / f64::from(case.spacing);
        println!(
            "{}: smallest angle {from:.3} to {angle:.2}, largest {most:.1}, ratio {ratio:.3}; 5 % below {twentieth:.1}; \
             distance mean {:.4} to {:.4}, largest {:.3} to {:.3} spacings",
            case.name,
            in_spacings(before.distance.mean),
            in_spacings(after.distance.mean),
            in_spacings(before.hausdorff()),
            in_spacings(after.hausdorff()),
        );
        assert!(from < 0.5 && angle > 8.0 && most < 160.0 && ratio > 0.07, "{}", case.name);
        assert!(twentieth > 27.0, "{}", case.name);
        assert!(after.distance.mean < before.distance.mean, "{}", case.name);
        if case.name == "sphere" {
            assert!(angle > 17.0 && after.hausdorff() < before.hausdorff());
        }
    }
}

#[test]
fn what_is_no_way_to_move_is_refused() {
    let grid = grid(0.2);
    for bad in [
        Macet { pull: -0.1, ..Macet::default() },
        Macet { share: 1.5, ..Macet::default() },
        Macet { pull: f32::NAN, ..Macet::default() },
        Macet { steps: 65, ..Macet::default() },
    ] {
        let error = Method::Macet(bad).check(&grid).unwrap_err();
        assert!(
            matches!(error, MethodError::Setting { key: "pull", .. })
                && error.to_string().contains("from 0 to 1"),
            "{error}"
        );
    }
    let samples = vec![0.0; 12 * 12 * 12];
    let made = Method::Macet(Macet::default()).extract(
        &mut Extractor::new(),
        Source::Samples(&samples),
        &grid,
        0.0,
        &ONE,
    );
    assert_eq!(made.unwrap_err(), MethodError::NeedsField);
}
