//! Meshes that do not hold what was told of them, or cannot be drawn.

use crate::programs::{ask, first_error, planted, request};
use isostudy_program::{Problem, Request, Worker};

#[test]
fn broken_meshes_are_errors_after_which_the_program_may_be_asked_again() {
    for (plan, words) in [
        ("index", "face 0: vertex 3 of 3"),
        ("nan", "vertex 1"),
        ("cut-mesh", "face 0"),
        ("no-mesh", "told 1 triangles and wrote none"),
        ("pipe", "not a file"),
        ("large-mesh", "1073741824 bytes"),
    ] {
        let (error, mut worker) = first_error(&planted(plan));
        assert!(matches!(*error.problem, Problem::Mesh { .. }), "{plan}: {error}");
        let said = error.to_string();
        assert!(said.contains(words) && said.contains("mesh.ply"), "{plan}: {said}");
        assert!(worker.is_running(), "{plan}");
        worker.extract(&request()).expect("without a mesh there is nothing wrong");
    }
}

#[test]
fn a_mesh_has_as_many_triangles_as_were_told() {
    let (error, _) = first_error(&planted("other-counts"));
    assert!(matches!(*error.problem, Problem::Counts { what: "triangles", told: 2, found: 1 }), "{error}");
}

#[test]
fn an_empty_mesh_is_right_only_where_the_request_says_so() {
    let (error, mut worker) = first_error(&planted("no-triangles"));
    assert!(matches!(*error.problem, Problem::Empty { id: 1 }), "{error}");
    let empty = Request { may_be_empty: true, ..request() };
    assert_eq!(worker.extract(&empty).expect("no triangles are right").triangles, 0);
}

#[test]
fn a_mesh_lies_where_its_samples_do() {
    let (error, mut worker) = first_error(&planted("in-cells"));
    let found = matches!(*error.problem, Problem::Outside { vertex: 1, position: [20.0, 0.0, 0.0], .. });
    assert!(found, "{error}");
    // One cell beyond the last sample is allowed: with cells of 19 the vertex at 20 is within 19 + 19.
    let wide = Request { mesh: Some("mesh.ply".as_ref()), spacing: [19.0; 3], ..request() };
    worker.extract(&wide).expect("now it is near enough");
    let narrow = Request { spacing: [9.9; 3], ..wide };
    assert!(matches!(*worker.extract(&narrow).expect_err("20 > 19.8").problem, Problem::Outside { .. }));
}

#[test]
fn a_mesh_of_an_earlier_request_is_not_taken_for_this_ones() {
    let mut worker = Worker::start(&planted("no-mesh")).expect("it is ready");
    let stale = worker.folder().join("mesh.ply");
    std::fs::write(&stale, "left over").expect("a file");
    let error = ask(&mut worker).expect_err("a mesh was found");
    assert!(error.to_string().contains("wrote none") && !stale.exists(), "{error}");
}
