//! Solids between two isovalues.

use isostudy_four::{Placement, Solid, interval_volume, surface};
use isostudy_mesh::TriangleMesh;

use crate::series::{random, sampled};
use crate::topology::triangles;

fn sorted(mesh: &TriangleMesh, is_turned: bool) -> Vec<[[u32; 3]; 3]> {
    let mut found: Vec<[[u32; 3]; 3]> = (0..mesh.triangles.len())
        .map(|t| {
            let [a, b, c] = mesh.corners(t).map(|p| p.to_array().map(f32::to_bits));
            let [b, c] = if is_turned { [c, b] } else { [b, c] };
            [[a, b, c], [b, c, a], [c, a, b]].into_iter().min().unwrap()
        })
        .collect();
    found.sort_unstable();
    found
}

/// The rim is the two surfaces, and volumes are their difference.
fn check_rim(placement: &Placement, samples: &[f32], low: f32, high: f32) -> Solid {
    let solid = interval_volume(placement, samples, low, high).unwrap();
    let [outer, inner] = [low, high].map(|isovalue| surface(placement, samples, isovalue).unwrap());
    let mut both = [sorted(&outer, false), sorted(&inner, true)].concat();
    both.sort_unstable();
    assert_eq!(sorted(&solid.rim(), false), both, "{low} to {high}");
    for (triangle, ways) in triangles(&solid.tetrahedra) {
        assert!(matches!(ways, [1, 1] | [1, 0] | [0, 1]), "{triangle:?}: {ways:?}");
    }
    let difference = outer.volume() - inner.volume();
    let tolerance = 1e-5 * (1.0 + outer.volume());
    assert!((solid.volume() - difference).abs() < tolerance, "{} of {difference}", solid.volume());
    solid
}

#[test]
fn the_rim_of_a_solid_is_the_two_surfaces_and_volumes_agree() {
    for seed in 0..8 {
        let series = random([8, 7, 7], 3, 0.6, seed);
        let samples = &series.frames()[1];
        for (low, high) in [(0.0, 0.3), (0.1, 0.11), (0.0, 0.9), (0.25, 0.5)] {
            check_rim(series.placement(), samples, low, high);
        }
        // The upper surface is empty.
        check_rim(series.placement(), samples, 0.2, 5.0);
    }
}

#[test]
fn a_mirrored_lattice_has_positive_volumes() {
    let frames = random([8, 7, 7], 3, 0.6, 5).frames().to_vec();
    let steps = [[0.0, 0.5, 0.0], [0.5, 0.0, 0.0], [0.0, 0.0, 0.5]];
    let placement = Placement { counts: [8, 7, 7], origin: [1.0; 3], steps };
    assert!(placement.is_mirrored());
    assert!(check_rim(&placement, &frames[1], 0.1, 0.5).volume() > 0.0);
}

#[test]
fn a_shell_has_its_volume_to_second_order() {
    let (inner, outer) = (0.45f64, 0.83f64);
    let exact = 4.0 / 3.0 * std::f64::consts::PI * (outer.powi(3) - inner.powi(3));
    let errors: Vec<f64> = [17, 33, 65]
        .map(|n| {
            let spacing = 2.0 / (n - 1) as f64;
            let placement = Placement::even([n; 3], [-1.0; 3], spacing);
            let series = sampled(placement, 2, |[x, y, z, _]| {
                1.0 - [x, y, z].iter().map(|x| (x * spacing - 1.0).powi(2)).sum::<f64>().sqrt()
            });
            let solid =
                check_rim(&placement, &series.frames()[0], (1.0 - outer) as f32, (1.0 - inner) as f32);
            println!("{n}: {} tetrahedra, {} inside out", solid.tetrahedra.len(), solid.inverted());
            assert!(solid.values.iter().all(|v| (0.169..=0.551).contains(v)));
            (solid.volume() - exact).abs() / exact
        })
        .to_vec();
    println!("relative errors of the volume: {errors:?}");
    for pair in errors.windows(2) {
        assert!((3.4..4.6).contains(&(pair[0] / pair[1])), "order two: {errors:?}");
    }
}

#[test]
fn few_tetrahedra_are_inside_out() {
    let (mut inverted, mut total) = (0, 0);
    for seed in 0..8 {
        let series = random([10, 10, 10], 3, 0.6, seed);
        let solid = interval_volume(series.placement(), &series.frames()[1], 0.1, 0.4).unwrap();
        inverted += solid.inverted();
        total += solid.tetrahedra.len();
    }
    println!("random samples: {inverted} of {total} tetrahedra are inside out");
    assert!(100 * inverted < total, "{inverted} of {total}");
}

#[test]
fn where_all_values_are_between_the_solid_is_the_whole_lattice() {
    let placement = Placement::even([4, 5, 3], [1.0, 2.0, 3.0], 0.5);
    let samples: Vec<f32> = (0..60).map(|n| 1.0 + n as f32 / 100.0).collect();
    let solid = interval_volume(&placement, &samples, 0.5, 2.0).unwrap();
    assert_eq!(solid.positions.len(), 60);
    assert!((solid.volume() - 1.5 * 2.0 * 1.0).abs() < 1e-12, "{}", solid.volume());
    assert_eq!(solid.inverted(), 0);
    let rim = solid.rim();
    assert!(isostudy_mesh::topology::topology(&rim).is_closed_manifold());
    assert_eq!(solid.values[7], samples[7]);
}

#[test]
fn the_file_of_vtk_has_all_numbers() {
    let placement = Placement::unit([2, 2, 2]);
    let samples = [0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let solid = interval_volume(&placement, &samples, 0.25, 2.0).unwrap();
    assert_eq!((solid.positions.len(), solid.tetrahedra.len()), (4, 1));
    assert!((solid.volume() - 0.75f64.powi(3) / 6.0).abs() < 1e-12);
    let mut file = Vec::new();
    solid.write_vtk(&mut file).unwrap();
    let text = String::from_utf8(file).unwrap();
    let [a, b, c, d] = solid.tetrahedra[0];
    for line in [
        "POINTS 4 double",
        "0.25 0 0",
        "1 0 0",
        "CELLS 1 5",
        "CELL_TYPES 1",
        "10",
        "POINT_DATA 4",
        "0.25",
        "1",
    ] {
        assert!(text.lines().any(|other| other == line), "{line}: {text}");
    }
    assert!(text.contains(&format!("\n4 {a} {b} {c} {d}\n")), "{text}");
}
