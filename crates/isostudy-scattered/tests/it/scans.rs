//! Scans of a ball and of a torus: how far the surface is from the truth, with and without a hole.

use glam::{DVec3, Vec3};
use isostudy_extract::{BoxGrid, Execution, Extraction, Extractor, presets};
use isostudy_field::StudyField;
use isostudy_mesh::Bounds;
use isostudy_mesh::topology::topology;
use isostudy_scattered::{FitSettings, Kernel, PointCloud, PointField, PointSettings, estimate_normals};

/// Points of the unit ball in a spiral, but for those that are left out.
fn ball(many: usize, keep: impl Fn(Vec3) -> bool) -> PointCloud {
    let point = |i: usize| {
        let z = 1.0 - (2 * i + 1) as f64 / many as f64;
        let (turn, r) = (2.399_963_229_728_653 * i as f64, (1.0 - z * z).sqrt());
        DVec3::new(r * libm::cos(turn), r * libm::sin(turn), z).as_vec3()
    };
    let positions: Vec<Vec3> = (0..many).map(point).filter(|&p| keep(p)).collect();
    PointCloud { normals: positions.clone(), positions, lines: Vec::new() }
}

fn fitted(cloud: &PointCloud, fit: FitSettings) -> PointField {
    PointField::try_new(cloud, &PointSettings { fit, offset: None }).unwrap()
}

fn extracted(field: &PointField, method: &str, spacing: f32, threads: usize) -> Extraction {
    let method = presets().iter().find(|preset| preset.id == method).expect("a preset").method;
    let grid = BoxGrid { bounds: Bounds { min: Vec3::splat(-1.31), max: Vec3::splat(1.31) }, spacing };
    let execution = Execution { threads };
    let study: &dyn StudyField = field;
    method.extract(&mut Extractor::new(), study.into(), &grid, 0.0, &execution).unwrap()
}

/// How far vertices are from the unit ball, at most.
fn farthest(extraction: &Extraction, keep: impl Fn(Vec3) -> bool) -> f32 {
    let away = extraction.mesh.positions.iter().filter(|p| keep(**p)).map(|p| (p.length() - 1.0).abs());
    away.fold(0.0, f32::max)
}

#[test]
fn the_surface_of_a_scan_is_near_the_ball() {
    let spacing = 0.11;
    for (kernel, limit) in [(Kernel::Biharmonic, 1e-3), (Kernel::Triharmonic, 2e-4)] {
        let field = fitted(&ball(600, |_| true), FitSettings { kernel, ..FitSettings::default() });
        assert!(field.report_at_points().largest < 1e-9);
        // Dual contouring puts vertices by gradients.
        for method in ["mc33", "dc"] {
            let extraction = extracted(&field, method, spacing, 1);
            let found = farthest(&extraction, |_| true);
            println!("{kernel:?}, {method}: vertices at most {found:.1e} of a radius off");
            // A chord of a unit ball is an eighth of its square off: along an edge of a cube, or across the cube.
            let of_cells = spacing * spacing / 8.0 * if method == "dc" { 3.0 } else { 1.0 };
            assert!(found < limit + of_cells, "{kernel:?}, {method}: {found}");
            assert!(
                topology(&extraction.mesh).is_closed_manifold() && topology(&extraction.mesh).components == 1
            );
        }
    }
}

/// The cap above z = 0.8, a tenth of the ball, was not scanned.
#[test]
fn a_hole_of_a_scan_is_filled() {
    let field = fitted(&ball(900, |p| p.z < 0.8), FitSettings::default());
    let extraction = extracted(&field, "mc33", 0.09, 1);
    let found = topology(&extraction.mesh);
    assert!(found.is_closed_manifold(), "{found:?}");
    assert_eq!((found.components, found.euler_characteristic), (1, 2));
    assert!(farthest(&extraction, |p| p.z < 0.75) < 6e-3);
    let cap = farthest(&extraction, |p| p.z >= 0.75);
    println!("hole: the cap is at most {cap:.3} of a radius off");
    assert!(cap < 0.06, "{cap}");
}

#[test]
fn many_points_are_fitted_by_some_and_the_error_is_told() {
    let cloud = ball(2500, |_| true);
    let mut before = f64::INFINITY;
    for most_centres in [150, 600] {
        let field = fitted(&cloud, FitSettings { most_centres, ..FitSettings::default() });
        let (all, at_points) = (field.report(), field.report_at_points());
        assert_eq!((all.points, all.centres, at_points.points), (7500, most_centres, 2500));
        assert!(at_points.largest <= all.largest && at_points.root_mean_square <= at_points.largest);
        assert!(at_points.largest < 0.5 * before, "{at_points:?}");
        // The field is about as steep as a distance, so what is left is about how far the surface is off.
        let off = farthest(&extracted(&field, "mc33", 0.11, 1), |_| true);
        assert!(f64::from(off) < 1.5 * at_points.largest + 2e-3, "{off}: {at_points:?}");
        println!(
            "{most_centres} centres of 7500: {:.1e} at points, surface {off:.1e} off",
            at_points.largest
        );
        before = at_points.largest;
    }
}

#[test]
fn meshes_are_the_same_bytes_on_one_thread_and_on_two() {
    let field = fitted(&ball(300, |p| p.x < 0.7), FitSettings::default());
    let again = fitted(&ball(300, |p| p.x < 0.7), FitSettings::default());
    for method in ["mc33", "dc", "bi"] {
        let [one, two] =
            [(&field, 1), (&again, 2)].map(|(field, threads)| extracted(field, method, 0.13, threads).mesh);
        assert!(one.triangles.len() > 500 && one == two, "{method}");
    }
}

#[test]
fn rows_are_samples_and_gradients_point_inward() {
    let field = fitted(&ball(200, |_| true), FitSettings::default());
    let x: Vec<f32> = (0..50).map(|i| 0.05 * i as f32 - 1.2).collect();
    let mut values = vec![0.0; x.len()];
    for (y, z) in [(0.1, 0.3), (f32::NAN, 0.0), (0.0, 2e18)] {
        field.sample_row(&x, y, z, &mut values);
        for (&x, &value) in x.iter().zip(&values) {
            assert_eq!(value.to_bits(), field.sample(Vec3::new(x, y, z)).to_bits());
        }
    }
    assert!(values.iter().all(|value| value.is_nan()));
    assert_eq!(field.gradient(Vec3::NAN), None);
    let cloud = ball(77, |_| true);
    for &p in &cloud.positions {
        let gradient = field.gradient(p).unwrap();
        assert!((gradient + p).length() < 0.15, "{gradient} at {p}");
    }
    // Nothing is said of boxes.
    let all = Bounds { min: Vec3::splat(-2.0), max: Vec3::splat(2.0) };
    assert_eq!((field.slope(all), field.range(all, 0.5)), (None, None));
}

/// Two sheets so close that values beside one would lie beyond the other.
#[test]
fn sheets_that_are_close_keep_apart() {
    let mut cloud = PointCloud::default();
    for (i, j) in (0..16).flat_map(|i| (0..16).map(move |j| (i, j))) {
        let [x, y] = [i, j].map(|k| k as f32 / 7.5 - 1.0);
        for side in [-1.0, 1.0] {
            cloud.positions.push(Vec3::new(x, y, side * 0.03));
            cloud.normals.push(Vec3::Z * side);
        }
    }
    let field = fitted(&cloud, FitSettings::default());
    assert!(field.offset() > 0.06, "{}", field.offset());
    for i in 0..40 {
        let (x, y) = (0.9 * libm::cosf(i as f32), 0.9 * libm::sinf(1.7 * i as f32));
        let at = |z: f32| field.sample(Vec3::new(x, y, z));
        assert!(at(0.0) > 0.005 && at(0.06) < 0.0 && at(-0.06) < 0.0 && at(0.2) < 0.0, "{x}, {y}");
    }
}

#[test]
fn a_scan_without_normals_has_the_same_surface() {
    let cloud = ball(600, |p| p.z < 0.9);
    let bare = PointCloud { normals: Vec::new(), ..cloud.clone() };
    let field = fitted(&estimate_normals(&bare), FitSettings::default());
    let extraction = extracted(&field, "mc33", 0.11, 1);
    assert!(topology(&extraction.mesh).is_closed_manifold() && topology(&extraction.mesh).components == 1);
    assert!(farthest(&extraction, |p| p.z < 0.8) < 0.012);
    assert!(extraction.mesh.volume() > 4.0);
}
