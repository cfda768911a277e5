//! Soup that is extracted: a ball with a seventh of its triangles left out.

use glam::Vec3;
use isostudy_extract::{BoxGrid, Execution, Extractor, Method, presets};
use isostudy_field::{Sphere, StudyField};
use isostudy_mesh::topology::topology;
use isostudy_mesh::{Bounds, TriangleMesh};
use isostudy_scattered::SoupField;

fn extracted(field: &dyn StudyField, method: &str, spacing: f32, threads: usize) -> TriangleMesh {
    let method: Method = presets().iter().find(|preset| preset.id == method).expect("a preset").method;
    let grid = BoxGrid { bounds: Bounds { min: Vec3::splat(-1.3), max: Vec3::splat(1.3) }, spacing };
    let execution = Execution { threads };
    method.extract(&mut Extractor::new(), field.into(), &grid, 0.0, &execution).unwrap().mesh
}

/// The triangles of a ball, each with corners of its own, all but every seventh.
fn soup() -> (TriangleMesh, usize) {
    let whole = extracted(&Sphere { radius: 1.0 }, "bi-relaxed", 0.21, 1);
    let mut soup = TriangleMesh::default();
    for t in (0..whole.triangles.len()).filter(|t| t % 7 != 3) {
        let first = soup.positions.len() as u32;
        soup.positions.extend(whole.corners(t));
        soup.triangles.push([first, first + 1, first + 2]);
    }
    (soup, whole.triangles.len())
}

#[test]
fn soup_with_a_seventh_left_out_is_closed() {
    let (soup, all) = soup();
    let left = all - soup.triangles.len();
    assert!((all / 7..=all / 7 + 1).contains(&left), "{left} of {all}");
    for epsilon in [0.0, 0.05] {
        let field = SoupField::try_new(&soup, Some(epsilon)).unwrap();
        assert_eq!((field.epsilon(), field.flat()), (epsilon, None));
        // Where tangent planes meet is farther off at the edges of holes.
        for (method, limit) in [("mc33", 0.04), ("dc", 0.05)] {
            let mesh = extracted(&field, method, 0.1, 1);
            let found = topology(&mesh);
            assert!(found.is_closed_manifold() || method == "dc", "{epsilon}, {method}: {found:?}");
            assert_eq!((found.components, found.boundary_edges), (1, 0), "{epsilon}, {method}");
            let off = mesh.positions.iter().map(|p| (p.length() - 1.0).abs()).fold(0.0, f32::max);
            println!("soup, epsilon {epsilon}, {method}: at most {off:.1e} of a radius off");
            assert!(off < limit, "{epsilon}, {method}: {off}");
        }
    }
}

#[test]
fn meshes_are_the_same_bytes_on_one_thread_and_on_two() {
    let (soup, _) = soup();
    let field = SoupField::try_new(&soup, None).unwrap();
    let diagonal = f64::from(field.bounds().size().length());
    assert!((field.epsilon() / diagonal - 0.01).abs() < 1e-6);
    for method in ["mc33", "dc"] {
        let [one, two] = [1, 2].map(|threads| extracted(&field, method, 0.15, threads));
        assert!(one.triangles.len() > 500 && one == two, "{method}");
    }
    let all = Bounds { min: Vec3::splat(-2.0), max: Vec3::splat(2.0) };
    assert_eq!((field.slope(all), field.range(all, 0.5)), (None, None));
}
