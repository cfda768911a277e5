//! Slices of space-time at one time.

use isostudy_four::{Placement, Series, surface};
use isostudy_mesh::TriangleMesh;
use isostudy_mesh::topology::topology;

use crate::series::{ball, random, sampled};

fn bits(mesh: &TriangleMesh) -> (Vec<[u32; 3]>, &[[u32; 3]]) {
    (mesh.positions.iter().map(|p| p.to_array().map(f32::to_bits)).collect(), &mesh.triangles)
}

fn check_frames(series: &Series, isovalue: f32, what: &str) {
    let space_time = series.extract(isovalue).unwrap();
    for (number, samples) in series.frames().iter().enumerate() {
        let frame = surface(series.placement(), samples, isovalue).unwrap();
        let time = number as f64;
        assert_eq!(bits(&space_time.slice(time).unwrap()), bits(&frame), "{what}, frame {number}");
        assert_eq!(bits(&series.slice(isovalue, time).unwrap()), bits(&frame), "{what}, frame {number}");
        // The tetrahedra before the frame have the same triangles as those after it.
        if number > 0 {
            let two = vec![series.frames()[number - 1].clone(), samples.clone()];
            let before = Series::try_new(*series.placement(), two).unwrap();
            assert_eq!(bits(&before.slice(isovalue, 1.0).unwrap()), bits(&frame), "{what}, before {number}");
        }
    }
}

#[test]
fn slices_at_whole_frames_are_the_meshes_of_the_frames_to_the_bit() {
    for seed in 0..6 {
        check_frames(&random([7, 6, 5], 5, 0.5, seed), 0.0, &format!("seed {seed}"));
        // The surface is open at sides and ends at other isovalues.
        check_frames(&random([5, 4, 6], 3, 0.5, seed), -0.4, &format!("open, seed {seed}"));
    }
    check_frames(&ball(10, 3.7), 0.0, "ball");
    // A radius of whole samples: values that equal the isovalue.
    check_frames(
        &sampled(Placement::unit([9; 3]), 9, |at| 9.0 - at.iter().map(|x| (x - 4.0).powi(2)).sum::<f64>()),
        0.0,
        "ties",
    );
    let mirrored = Placement {
        counts: [6, 6, 6],
        origin: [3.0, 1.0, -2.0],
        steps: [[-0.5, 0.1, 0.0], [0.0, 0.7, 0.2], [0.1, 0.0, 0.9]],
    };
    assert!(mirrored.is_mirrored());
    let frames = random([6, 6, 6], 4, 0.5, 77).frames().to_vec();
    check_frames(&Series::try_new(mirrored, frames).unwrap(), 0.0, "mirrored");
}

#[test]
fn slices_of_random_samples_are_closed_manifolds_at_any_time() {
    for seed in 0..6 {
        let series = random([7, 7, 6], 5, [0.5, 0.25, 0.75][seed as usize % 3], 40 + seed);
        let space_time = series.extract(0.0).unwrap();
        for time in [0.3, 0.999_999, 1.0, 1.25, 2.0, 2.5, 2.5000001, 3.0, 3.75] {
            let mesh = space_time.slice(time).unwrap();
            if mesh.triangles.is_empty() {
                continue;
            }
            let report = topology(&mesh);
            assert!(report.is_closed_manifold(), "seed {seed}, time {time}: {report:?}");
            assert!(mesh.volume() > 0.0, "seed {seed}, time {time}");
            assert_eq!(mesh, series.slice(0.0, time).unwrap(), "seed {seed}, time {time}");
        }
    }
}

#[test]
fn slices_of_a_ball_are_spheres_to_second_order() {
    let radius = 0.8f64;
    let time_of = |share: f64, n: usize| share * (n - 1) as f64;
    // Shares of the time that are no whole frame, and the last one is.
    for share in [0.26, 0.47, 0.63, 0.5] {
        let exact = (radius * radius - (2.0 * share - 1.0f64).powi(2)).sqrt();
        let errors: Vec<[f64; 2]> = [17, 33, 65]
            .map(|n| {
                let spacing = 2.0 / (n - 1) as f64;
                let placement = Placement::even([n; 3], [-1.0; 3], spacing);
                let series = sampled(placement, n, |at| {
                    radius - at.iter().map(|x| (x * spacing - 1.0).powi(2)).sum::<f64>().sqrt()
                });
                let mesh = series.slice(0.0, time_of(share, n)).unwrap();
                let report = topology(&mesh);
                assert!(report.is_closed_manifold() && report.euler_characteristic == 2, "{report:?}");
                let off = |p: &isostudy_mesh::glam::Vec3| (f64::from(p.length()) - exact).abs();
                let farthest = mesh.positions.iter().map(off).fold(0.0, f64::max);
                let volume = 4.0 / 3.0 * std::f64::consts::PI * exact.powi(3);
                [farthest, (mesh.volume() - volume).abs() / volume]
            })
            .to_vec();
        println!("share {share}: farthest vertex, relative error of the volume: {errors:?}");
        for pair in errors.windows(2) {
            assert!(pair[0][0] / pair[1][0] > 2.5, "share {share}: {errors:?}");
        }
        // A factor of 16 over two halvings, and a little room.
        assert!(errors[0][0] / errors[2][0] > 10.0, "share {share}: {errors:?}");
        assert!(errors[0][1] / errors[2][1] > 10.0, "share {share}: {errors:?}");
    }
}

#[test]
fn the_volume_of_a_solid_that_moves_evenly_is_that_between_its_frames() {
    // A slab that moves along x by half a sample a frame: exact at all times, since values are linear.
    let series = sampled(Placement::unit([12, 4, 4]), 5, |[x, _, _, t]| x - 2.25 - 0.5 * t);
    for time in [0.0, 0.4, 1.0, 2.7, 4.0] {
        let mesh = series.slice(0.0, time).unwrap();
        for p in &mesh.positions {
            assert!((f64::from(p.x) - 2.25 - 0.5 * time).abs() < 1e-6, "{p} at {time}");
        }
        assert!((mesh.area() - 9.0).abs() < 1e-5, "{}", mesh.area());
        // It faces lower values.
        let [a, b, c] = mesh.corners(0);
        assert!((b - a).cross(c - a).x < 0.0);
    }
}
