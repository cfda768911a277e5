//! Sheets that lie nearer to each other than an edge is long.

use crate::shapes::{cube, grown, sound};
use isostudy_field::from_fn;
use isostudy_front::{Front, FrontError};

/// The mesh is right, or an error names a place in the box.
#[test]
fn a_thin_plate_is_right_or_refused() {
    let mut right = 0;
    for thickness in [0.3, 0.2, 0.1, 0.05, 0.025] {
        // A rounded plate.
        let plate = from_fn(move |[x, y, z]: [f32; 3]| {
            let (x, y) = ((x.abs() - 0.6).max(0.0), (y.abs() - 0.6).max(0.0));
            0.5 * thickness - (x * x + y * y + z * z).sqrt()
        });
        match grown(&plate, cube(1.0), &Front::of_edge(0.1)) {
            Ok(made) => {
                let report = sound(&made.mesh, cube(1.0));
                assert_eq!((report.euler_characteristic, report.components), (2, 1), "{thickness}");
                assert_eq!(report.boundary_edges, 0);
                right += 1;
            }
            Err(
                FrontError::Unclosed { place, .. }
                | FrontError::Pinched { place }
                | FrontError::Astray { place },
            ) => {
                assert!(place.abs().max_element() < 1.0 && thickness < 0.1, "{thickness}: {place}");
            }
            Err(other) => panic!("{thickness}: {other}"),
        }
    }
    assert!(right >= 3, "{right}");
}

#[test]
fn a_narrow_gap_is_not_bridged() {
    for gap in [0.2, 0.1, 0.05, 0.02, 0.005] {
        let field = from_fn(move |[x, y, z]: [f32; 3]| {
            let ball = |cx: f32| 0.4 - ((x - cx).powi(2) + y * y + z * z).sqrt();
            ball(-0.4 - 0.5 * gap).max(ball(0.4 + 0.5 * gap))
        });
        let made = grown(&field, cube(1.0), &Front::of_edge(0.1)).unwrap();
        let report = sound(&made.mesh, cube(1.0));
        assert_eq!((report.euler_characteristic, report.components), (4, 2), "{gap}");
    }
}

#[test]
fn a_narrow_hollow_shell_has_two_surfaces() {
    for thickness in [0.1, 0.05, 0.02] {
        let field = from_fn(move |[x, y, z]: [f32; 3]| {
            0.5 * thickness - ((x * x + y * y + z * z).sqrt() - 0.7).abs()
        });
        let made = grown(&field, cube(1.0), &Front::of_edge(0.1)).unwrap();
        let report = sound(&made.mesh, cube(1.0));
        assert_eq!((report.euler_characteristic, report.components), (4, 2), "{thickness}");
        assert!(made.mesh.volume() > 0.0);
    }
}
