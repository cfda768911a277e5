use super::*;
use crate::fixture::{self, Everything};
use isostudy_design::record::BenchSample;

/// The rows of the claims table by id.
fn rows(everything: &Everything) -> std::collections::BTreeMap<String, Vec<String>> {
    let table = table(&everything.study, "Costen", &all(&Numbers::of(&everything.inputs()))).unwrap();
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
    assert!(
        row("discard_integrated")[8]
            .starts_with("our re-run of the published count exceeds the true one by 6.12 points: ")
    );
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
    everything.bench = fixture::bench_of(&everything.study, 9);
    for sample in &mut everything.bench.samples {
        sample.geometry_s *=
            1.0 + f64::from(crate::fixture::crossed(sample.id.method).clustering.code() == 'i');
    }
    let row = |everything: &Everything| rows(everything)["geometry_integrated"].clone();
    let alone = row(&everything);
    assert_eq!(alone[7], "not comparable");
    let want = "opposite direction (95 % interval over rounds 94.85 to 98.36 %, noise up to 9.81 points, assumed for want of an A/A \
                block); measured on Example CPU";
    assert!(alone[8].starts_with(want), "{alone:?}");
    // The same rounds in another process: as little noise as rounds let one see.
    let again = everything.bench.samples.iter().cloned();
    everything.bench.aa_samples = again.map(|sample| BenchSample { invocation: 1, ..sample }).collect();
    let want = "opposite direction (95 % interval over rounds 94.85 to 98.36 %, noise up to 0.00 points); measured on";
    assert!(row(&everything)[8].starts_with(want), "{:?}", row(&everything));
    // Processes that differ by a factor of four: no direction is left.
    everything.bench.aa_samples.iter_mut().for_each(|sample| sample.geometry_s *= 4.0);
    assert!(row(&everything)[8].starts_with("no change measurable here"), "{:?}", row(&everything));
}

#[test]
fn noise_has_no_direction() {
    let mut everything = Everything::of(fixture::study());
    everything.bench = fixture::bench_of(&everything.study, 9);
    // As fast with as without, but for unrest that leans to the published side.
    for sample in &mut everything.bench.samples {
        let merged = crate::fixture::crossed(sample.id.method).clustering.code() == 'i';
        let lean = if sample.iteration % 2 == 0 { 0.94 } else { 1.05 };
        sample.geometry_s = if merged { 0.01 * lean } else { 0.01 };
    }
    let reason = |everything: &Everything| rows(everything)["geometry_integrated"][8].clone();
    // Changes of -6 and 5 % in turn: the second of nine is -6, the eighth 5.
    let again = everything.bench.samples.iter().cloned();
    everything.bench.aa_samples = again.map(|sample| BenchSample { invocation: 1, ..sample }).collect();
    let want = "no change measurable here (95 % interval over rounds -6.00 to 5.00 %, noise up to 0.00 points); measured on";
    assert!(reason(&everything).starts_with(want), "{}", reason(&everything));
    // A round that lacks a case is no mean over the same cases.
    everything.bench.samples.retain(|s| s.iteration == 0 || s.place != 1);
    let want = "too few rounds to tell a change from noise; measured on";
    assert!(reason(&everything).starts_with(want), "{}", reason(&everything));
}

#[test]
fn reason_and_remark_are_told_apart() {
    let mut everything = Everything::of(fixture::study());
    let claims = &mut everything.study.published.claims;
    claims.iter_mut().find(|claim| claim.id == "body_centred_preference").unwrap().value = Some(0.9);
    let row = &rows(&everything)["body_centred_preference"];
    assert!(row[8].starts_with("not explained; the sum counts ties"), "{row:?}");
    assert!(rows(&everything)["favourite"][8].starts_with("largest"), "no reason, no semicolon");
}

/// The benchmark mesh of a configuration.
fn mesh<'a>(everything: &'a mut Everything, id: &str) -> &'a mut isostudy_design::record::MeshRecord {
    everything.meshes.iter_mut().find(|mesh| mesh.id.to_string() == id).unwrap()
}

#[test]
fn an_extreme_is_explained_by_what_holds_it() {
    let mut everything = Everything::of(fixture::study());
    let quality = &mut mesh(&mut everything, "ss_bu").quality;
    quality.degenerate = 500; // not the extreme's
    assert!(rows(&everything)["ratio_mean_none_max"][8].starts_with("96 degenerate triangles"));
    // The sphere without degenerate triangles, 1 % off: neither a bunny nor a sine explains it.
    let quality = &mut mesh(&mut everything, "ss_su").quality;
    quality.degenerate = 0;
    quality.published_aspect_ratio.mean = 1.01 * 1_207.366_565;
    assert_eq!(rows(&everything)["ratio_mean_none_max"][7..9], ["differs", "not explained"]);
    // The bunny may take over from the asteroid.
    mesh(&mut everything, "bs_bu").quality.published_aspect_ratio.mean = 5.08;
    let row = &rows(&everything)["ratio_mean_none_min"];
    let want = "another bunny mesh; led by a few slivers; held by bs_bu, in the published tables by as_bu";
    assert_eq!(row[6..9], ["5.08", "differs", want]);
}

#[test]
fn means_are_explained_by_the_objects_that_moved() {
    let reason = |id: &str| {
        let mut everything = Everything::of(fixture::study());
        let counts = &mut mesh(&mut everything, id).counts;
        let own = counts.tetrahedra.as_mut().unwrap();
        own.discarded_as_published = own.discarded_as_published * 97 / 100;
        counts.discarded_triangles = Some(own.discarded_as_published);
        rows(&everything)["discard_edge_collapse"][7..9].to_vec()
    };
    assert_eq!(reason("bs_bp"), ["within 3 %", "another bunny mesh"]);
    assert_eq!(reason("as_bp"), ["within 3 %", "another mathematics library"]);
    assert_eq!(reason("ss_bp"), ["differs", "not explained"]);
}

#[test]
fn claims_about_absent_configurations_are_left_out() {
    let mut everything = Everything::of(fixture::study());
    everything.meshes.retain(|mesh| crate::fixture::crossed(mesh.id.method).clustering.code() != 'p');
    let rows = rows(&everything);
    assert!(!rows.contains_key("discard_edge_collapse") && !rows.contains_key("less_uniform"));
    assert!(rows.contains_key("discard_integrated"));
}
