use super::*;
use crate::fixture::{self, Everything};

/// The rows of the claims table by id.
fn rows(everything: &Everything) -> std::collections::BTreeMap<String, Vec<String>> {
    let tally = Tally::of(&everything.answers, &everything.study).unwrap();
    let table = table(&everything.inputs(), Some(&tally)).unwrap();
    table.shown_rows().into_iter().map(|row| (row[0].clone(), row)).collect()
}

#[test]
fn every_listed_claim_is_known() {
    let everything = Everything::of(fixture::study());
    assert!(everything.study.published.claims.len() > 30);
    assert_eq!(rows(&everything).len(), everything.study.published.claims.len());
}

#[test]
fn the_texts_numbers_follow_from_its_own_tables() {
    // Columns: 3 published, 4 from the published tables.
    let rows = rows(&Everything::of(fixture::study()));
    let of_tables: Vec<&Vec<String>> =
        rows.values().filter(|row| !row[3].is_empty() && !row[4].is_empty()).collect();
    assert!(of_tables.len() > 25);
    for row in of_tables.iter().filter(|row| row[0] != "arrangement_samples") {
        assert_eq!(row[3], row[4], "{row:?}");
    }
}

#[test]
fn claims_that_fail_say_why() {
    // Columns: 5 ours as published, 6 ours, 7 verdict, 8 reason.
    let rows = rows(&Everything::of(fixture::study()));
    let row = |id: &str| &rows[id];
    assert_eq!(row("discard_integrated")[5..8], ["79.53", "73.40", "differs"]);
    assert!(row("discard_integrated")[8].starts_with("over-counted by 6.12 points"));
    assert_eq!(row("discard_edge_collapse")[6..8], ["72.20", "equal"]);
    assert_eq!(row("arrangement_triangles")[5..8], ["38.96", "36.05", "differs"]);
    assert_eq!(row("simple_edges_stored")[6..8], ["206.89", "differs"]);
    assert_eq!(row("less_uniform")[4..8], ["1", "1", "0", "differs"]);
    assert_eq!(row("fewer_triangles")[4..8], ["3", "3", "3", "differs"]);
    assert_eq!(row("ratio_mean_none_max")[5..8], ["1207.37", "1209.02", "differs"]);
    assert!(row("ratio_mean_none_max")[8].starts_with("96 degenerate triangles counted as ratio 0"));
    assert_eq!(row("turntable_duration")[6..8], ["7.2", "differs"]);
    assert_eq!(row("equal_cameras")[6..8], ["3", "differs"]);
    assert_eq!(row("favourite")[6..8], ["1.062", "equal"]);
    assert_eq!(row("favourite")[8], "largest sum by object: sphere bi, asteroid si, bunny si");
    assert_eq!(row("body_centred_preference")[6..8], ["0.813", "equal"]);
    assert!(row("body_centred_preference")[8].contains("84 body-centred, 22 none, 56 simple cubic"));
    assert!(row("regular_objects")[8].contains("in this direction: 44 body-centred, 5 none, 5 simple cubic"));
    assert!(
        row("irregular_objects")[8].contains("in this direction: 40 body-centred, 17 none, 51 simple cubic")
    );
}

#[test]
fn times_are_not_judged_across_machines() {
    let mut everything = Everything::of(fixture::study());
    for sample in &mut everything.bench.samples {
        sample.geometry_s *= 1.0 + f64::from(sample.id.method.clustering.code() == 'i');
    }
    let row = &rows(&everything)["geometry_integrated"];
    assert_eq!(row[7], "not comparable");
    assert!(row[8].starts_with("opposite direction; measured on Example CPU"), "{row:?}");
}

#[test]
fn claims_about_absent_configurations_are_left_out() {
    let mut everything = Everything::of(fixture::study());
    everything.meshes.retain(|mesh| mesh.id.method.clustering.code() != 'p');
    let rows = rows(&everything);
    assert!(!rows.contains_key("discard_edge_collapse") && !rows.contains_key("less_uniform"));
    assert!(rows.contains_key("discard_integrated"));
}
