//! Distances of triangles to the isosurface.

use glam::Vec3;
use isostudy_extract::by_lattice::{ExtractSettings, Lattice, extract};
use isostudy_extract::{Execution, triangle_distances};
use isostudy_field::{Sphere, StudyField};
use isostudy_mesh::{Bounds, TriangleMesh};

const ONE: Execution = Execution { threads: 1 };
const SPACING: f32 = 0.1;

/// A sphere that does not know where its surface is.
struct Searched(Sphere);

impl StudyField for Searched {
    fn sample(&self, p: Vec3) -> f32 {
        self.0.sample(p)
    }
}

fn ball() -> TriangleMesh {
    let bounds = Bounds { min: Vec3::splat(-1.2), max: Vec3::splat(1.2) };
    let lattice = Lattice::try_new(isostudy_extract::Arrangement::BodyCentred, bounds, SPACING).unwrap();
    extract(&Sphere { radius: 1.0 }, &lattice, &ExtractSettings::default(), &ONE).unwrap().mesh
}

/// The farthest of seven points, as the definition has it.
fn farthest([a, b, c]: [Vec3; 3]) -> f64 {
    let [a, b, c] = [a, b, c].map(|p| p.as_dvec3());
    let points = [a, b, c, (a + b) / 2.0, (b + c) / 2.0, (a + c) / 2.0, (a + b + c) / 3.0];
    points.into_iter().map(|p| (p.length() - 1.0).abs()).fold(0.0, f64::max)
}

#[test]
fn they_are_the_farthest_of_seven_points() {
    let mesh = ball();
    let sphere = Sphere { radius: 1.0 };
    for field in [&sphere as &dyn StudyField, &Searched(sphere)] {
        let found = triangle_distances(&mesh, field, 0.0, SPACING, &ONE).unwrap();
        assert_eq!(found.len(), mesh.triangles.len());
        for (t, found) in found.iter().enumerate() {
            let want = farthest(mesh.corners(t));
            assert!((found.unwrap() - want).abs() < 2e-6, "{t}: {found:?} is not {want}");
        }
        let threads = triangle_distances(&mesh, field, 0.0, SPACING, &Execution { threads: 3 });
        assert_eq!(threads.unwrap(), found);
    }
}

/// Corners 0.05 further out, so that is the distance but for what a triangle sags between its corners.
#[test]
fn a_sphere_that_is_too_large_is_off_by_that() {
    let mesh = ball().transformed(|p| p.normalize() * 1.05);
    let found = triangle_distances(&mesh, &Sphere { radius: 1.0 }, 0.0, SPACING, &ONE).unwrap();
    assert!(found.iter().all(|d| (d.unwrap() - 0.05).abs() < 1e-6));
}

#[test]
fn what_is_too_far_has_no_distance() {
    let far = ball().transformed(|p| p * 1.5);
    let found = triangle_distances(&far, &Searched(Sphere { radius: 1.0 }), 0.0, SPACING, &ONE).unwrap();
    assert!(found.iter().all(Option::is_none), "half a unit is five spacings");
    let known = triangle_distances(&far, &Sphere { radius: 1.0 }, 0.0, SPACING, &ONE).unwrap();
    assert!(known.iter().all(|d| d.unwrap() > 0.4));
    let nothing = TriangleMesh::default();
    assert_eq!(triangle_distances(&nothing, &Sphere { radius: 1.0 }, 0.0, SPACING, &ONE).unwrap(), []);
}
