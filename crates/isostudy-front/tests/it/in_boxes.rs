//! Surfaces that the box cuts.

use crate::shapes::{cube, grown, sound, torus};
use isostudy_extract::{BoxGrid, Execution, Extractor, presets};
use isostudy_field::{Gyroid, Sphere, StudyField, Terrain, TerrainCharacter, TerrainSettings};
use isostudy_front::{Front, FrontError, grow};
use isostudy_mesh::glam::Vec3;
use isostudy_mesh::topology::topology;
use isostudy_mesh::{Bounds, quality::quality};

/// The Euler characteristic and the number of border loops of marching cubes' mesh.
fn of_cubes(field: &dyn StudyField, bounds: Bounds, spacing: f32) -> (i64, u64) {
    let method = presets().iter().find(|preset| preset.id == "mc33").unwrap().method;
    let grid = BoxGrid { bounds, spacing };
    let made = method.extract(&mut Extractor::new(), field.into(), &grid, 0.0, &Execution { threads: 1 });
    let report = topology(&made.unwrap().mesh);
    (report.euler_characteristic, report.boundary_loops)
}

#[test]
fn a_ball_in_a_smaller_box_has_six_holes() {
    for edge in [0.2, 0.1, 0.05] {
        let mesh = grow(&Sphere { radius: 1.0 }, cube(0.8), 0.0, &Front::of_edge(edge)).unwrap().mesh;
        let report = sound(&mesh, cube(0.8));
        assert_eq!((report.euler_characteristic, report.boundary_loops, report.components), (-4, 6, 1));
        // Every vertex lies on the ball, those of the border too.
        assert!(mesh.positions.iter().all(|p| (p.length() - 1.0).abs() < 1e-4));
    }
}

#[test]
fn a_torus_that_is_cut_twice_is_two_tubes() {
    let bounds = Bounds { min: Vec3::new(-1.2, -0.4, -1.2), max: Vec3::new(1.2, 0.4, 1.2) };
    let mesh = grown(&torus(0.7, 0.25), bounds, &Front::of_edge(0.08)).unwrap().mesh;
    let report = sound(&mesh, bounds);
    assert_eq!((report.euler_characteristic, report.boundary_loops, report.components), (0, 4, 2));
}

#[test]
fn the_gyroid_is_that_of_marching_cubes() {
    let gyroid = Gyroid::default();
    for bounds in [cube(0.93), cube(0.77)] {
        let (characteristic, _) = of_cubes(&gyroid, bounds, 0.02);
        for edge in [0.1, 0.07, 0.05] {
            let mesh = grow(&gyroid, bounds, 0.0, &Front::of_edge(edge)).unwrap().mesh;
            let report = sound(&mesh, bounds);
            assert_eq!((report.euler_characteristic, report.components), (characteristic, 1), "{edge}");
            assert!(quality(&mesh).min_angle_deg.min > 3.0, "{edge}: {:?}", quality(&mesh).min_angle_deg.min);
        }
    }
}

/// Here its surface meets corners and edges of the box: marching cubes has zeros among its samples, and another topology there.
#[test]
fn a_gyroid_that_touches_corners_of_the_box_is_sound() {
    for edge in [0.1, 0.07, 0.05] {
        let mesh = grow(&Gyroid::default(), cube(1.0), 0.0, &Front::of_edge(edge)).unwrap().mesh;
        assert_eq!(sound(&mesh, cube(1.0)).euler_characteristic, -199, "{edge}");
    }
}

#[test]
fn open_ground_is_a_disc() {
    let bounds = Bounds { min: Vec3::new(-1.0, -1.0, -0.5), max: Vec3::new(1.0, 1.0, 0.5) };
    for seed in 0..4 {
        let settings = TerrainSettings { closed: false, ..TerrainCharacter::Hills.settings(seed) };
        let field = Terrain::try_new(settings, bounds).unwrap();
        let expected = of_cubes(&field, bounds, 0.02);
        for edge in [0.1, 0.05] {
            let mesh = grow(&field, bounds, 0.0, &Front::of_edge(edge)).unwrap().mesh;
            let report = sound(&mesh, bounds);
            assert_eq!((report.euler_characteristic, report.boundary_loops), expected, "{seed} {edge}");
        }
    }
}

/// The study's own ground stands on walls, whose edges are sharp. It is right, or refused with a place.
#[test]
fn closed_ground_is_right_or_refused() {
    let bounds = Bounds { min: Vec3::new(-1.0, -1.0, -0.5), max: Vec3::new(1.0, 1.0, 0.5) };
    // What is refused takes its time; caves take 20 seconds.
    let cases =
        [(TerrainCharacter::Hills, 0.1), (TerrainCharacter::Hills, 0.05), (TerrainCharacter::Cliffs, 0.1)];
    for (character, edge) in cases {
        // As in configs/terrain.toml.
        let settings = TerrainSettings { margin: 0.013, ..character.settings(3) };
        let field = Terrain::try_new(settings, bounds).unwrap();
        match grow(&field, bounds, 0.0, &Front::of_edge(edge)) {
            Ok(made) => {
                let report = sound(&made.mesh, bounds);
                assert_eq!(report.boundary_edges, 0);
                assert_eq!(report.euler_characteristic, of_cubes(&field, bounds, 0.02).0, "{edge}");
            }
            Err(
                FrontError::Unclosed { place, .. }
                | FrontError::Pinched { place }
                | FrontError::Astray { place }
                | FrontError::TooMany { place, .. },
            ) => assert!(place.abs().max_element() <= 1.0, "{place}"),
            Err(other) => panic!("{other}"),
        }
    }
}
