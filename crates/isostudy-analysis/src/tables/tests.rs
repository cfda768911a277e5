use super::*;
use crate::fixture::{self, Everything};
use isostudy_table::Cell;

fn named<'a>(tables: &'a [Table], name: &str) -> &'a Table {
    tables.iter().find(|table| table.name == name).unwrap_or_else(|| panic!("no table {name}"))
}

fn header(table: &Table) -> String {
    table.to_csv().lines().next().unwrap().into()
}

#[test]
fn every_table_is_there_and_scripts_find_their_columns() {
    let all = Everything::of(fixture::study());
    let tables = tables(&all.inputs());
    let names: Vec<&str> = tables.iter().map(|t| t.name.as_str()).collect();
    assert_eq!(
        names,
        [
            "methods",
            "configurations",
            "benchmark",
            "asteroid",
            "questionnaire",
            "answers",
            "answer_counts",
            "preference_groups",
            "preference_overall",
            "preference_margins",
            "preference_objects",
            "preference_arrangements",
            "contrasts",
            "tests",
            "omnibus",
            "worths",
            "models",
            "scale",
            "differences",
            "fit",
            "agreement",
            "respondents",
            "screened",
            "audit",
            "prediction",
            "prediction_joint",
            "prediction_objects",
            "prediction_correlations",
            "quality",
            "topology",
            "accuracy",
            "choices",
            "decision",
            "fronts",
            "positions",
            "comparison_summary",
            "comparison",
            "benchmark_beside",
            "claims",
        ]
    );
    assert!(
        header(named(&tables, "preference_groups"))
            .starts_with("group,configuration,wins,ties,answers,factor")
    );
    assert_eq!(header(named(&tables, "preference_overall")), "configuration,factor");
    let benchmark = header(named(&tables, "benchmark"));
    assert!(benchmark.starts_with("id,"));
    for column in ["vertices", "triangles", "tetrahedra_evaluated"] {
        assert!(benchmark.split(',').any(|name| name == column), "{column}");
    }
    assert_eq!(named(&tables, "configurations").rows.len(), 18);
    assert_eq!(named(&tables, "benchmark").printed().len(), 4);
    assert_eq!(named(&tables, "asteroid").rows.len(), 6);
    assert_eq!(named(&tables, "quality").rows.len(), 36);
    assert_eq!(named(&tables, "accuracy").rows.len(), 54);
    assert_eq!(named(&tables, "answers").columns.len(), 19);
}

#[test]
fn rows_of_the_scripted_tables() {
    let all = Everything::of(fixture::study());
    let tables = tables(&all.inputs());
    let groups = named(&tables, "preference_groups").to_csv();
    let first: Vec<&str> = groups.lines().nth(2).unwrap().split(',').take(6).collect();
    assert_eq!(first, ["B", "bi", "68", "19", "162", "0.41975308641975306"]);
    let overall = named(&tables, "preference_overall").to_csv();
    assert_eq!(overall.lines().count(), 7);
    assert!(overall.contains("\nsu,0.33950617283950"), "{overall}");
    let printed = named(&tables, "preference_overall").to_markdown();
    assert!(printed.contains("| simple cubic | 0.340 | 1.062 | 0.586 | 0.663 |"), "{printed}");
    assert!(printed.contains("| mean | 0.556 | 0.926 | 0.731 |  |"), "{printed}");
    let questionnaire = named(&tables, "questionnaire").to_csv();
    assert!(questionnaire.contains("\nQ27,asteroid,as_bp,as_sp,P\n"), "{questionnaire}");
    let counts = named(&tables, "answer_counts").to_csv();
    assert!(counts.contains("\nQ7,sphere,ss_bu,ss_su,16,1,1,"), "{counts}");
    let positions = named(&tables, "positions").to_csv();
    assert!(positions.contains("\nss_bi,13605,13606,27200,27200,8,8,"), "{positions}");
    // 2e-4 at a spacing of 0.04.
    let accuracy = named(&tables, "accuracy").to_csv();
    assert!(accuracy.contains("\nas_bi,benchmark,0.04,0.005,"), "{accuracy}");
    let times = named(&tables, "benchmark");
    assert!(times.notes[0].contains("means over 5 iterations") && times.notes[0].contains("does not match"));
}

#[test]
fn statistics_of_nothing_are_missing() {
    let mut all = Everything::of(fixture::study());
    for mesh in all.meshes.iter_mut().filter(|mesh| mesh.id.to_string() == "bs_bi") {
        let quality = &mut mesh.quality;
        for of in [
            &mut quality.published_aspect_ratio,
            &mut quality.edge_ratio,
            &mut quality.radius_ratio,
            &mut quality.min_angle_deg,
            &mut quality.max_angle_deg,
            &mut quality.area,
        ] {
            (of.count, of.mean, of.sd, of.min, of.max) = (0, 0.0, 0.0, 0.0, 0.0);
            (of.q05, of.q25, of.median, of.q75, of.q95) = (0.0, 0.0, 0.0, 0.0, 0.0);
        }
    }
    let is_shape = |name: &str| ["ratio_", "angle_", "area_"].iter().any(|of| name.contains(of));
    let mut missing = 0;
    for table in &tables(&all.inputs()) {
        let numbers = table.name == "comparison";
        let of_mesh = |row: &&Vec<Cell>| {
            row[usize::from(numbers)].in_full() == "bs_bi" && (!numbers || is_shape(&row[2].in_full()))
        };
        for row in table.rows.iter().filter(of_mesh) {
            let columns = table.columns.iter().zip(row);
            for (column, cell) in columns.filter(|(column, _)| match &*table.name {
                "comparison" => column.name == "ours",
                "benchmark_beside" => column.name.starts_with("ours_") && is_shape(&column.name),
                _ => is_shape(&column.name),
            }) {
                assert_eq!(*cell, Cell::Missing, "{}, {}", table.name, column.name);
                missing += 1;
            }
        }
    }
    // Benchmark: 4; quality: 9 of 6 at two spacings; positions: 2 twice; comparison: 6; side by side: 6 and 2 put right.
    assert_eq!(missing, 4 + 2 * 9 * 6 + 2 * 2 + 6 + 8);
    assert!(crate::unexplained_differences(&all.inputs()).is_empty());
}

#[test]
fn intervals_stay_within_what_is_possible() {
    let all = Everything::of(fixture::study());
    let tables = tables(&all.inputs());
    let caps: std::collections::BTreeMap<(String, String), f64> = named(&tables, "preference_groups")
        .rows
        .iter()
        .map(|row| ((row[0].in_full(), row[1].in_full()), row[6].in_full().parse().unwrap()))
        .collect();
    let (mut at_zero, mut at_cap) = (0, 0);
    for row in &named(&tables, "preference_objects").rows {
        let cap = caps[&(row[1].in_full(), row[2].in_full())];
        let [factor, low, high] = [6, 7, 8].map(|i| row[i].in_full().parse::<f64>().unwrap());
        assert!(0.0 <= low && low <= factor && factor <= high && high <= cap, "{row:?}");
        at_zero += u32::from(low == 0.0);
        at_cap += u32::from(high == cap);
    }
    assert!(at_zero > 0 && at_cap > 0, "some would pass without the cut");
}

#[test]
fn latex_names_its_packages_and_breaks_long_tables() {
    let all = Everything::of(fixture::study());
    for table in tables(&all.inputs()) {
        let latex = table.to_latex();
        let needs = latex.lines().next().unwrap();
        for (package, used) in
            [("array", "\\arraybackslash"), ("longtable", "{longtable}"), ("lscape", "{landscape}")]
        {
            assert_eq!(needs.contains(package), latex.contains(used), "{}: {package}", table.name);
        }
        let rows: usize = table.printed().iter().map(|part| part.rows.len()).sum();
        assert!(rows <= 35 || needs.contains("longtable"), "{}", table.name);
        let many = table.printed().iter().any(|part| part.columns.len() > 7);
        assert!(!many || latex.contains("\\setlength{\\tabcolsep}"), "{}", table.name);
    }
}

#[test]
fn order_of_records_changes_nothing() {
    let mut all = Everything::of(fixture::study());
    let before = tables(&all.inputs());
    all.meshes.reverse();
    assert!(tables(&all.inputs()) == before);
}

#[test]
fn absent_parts_leave_out_their_tables() {
    let all = Everything::of(fixture::study());
    let names =
        |inputs: &Inputs<'_>| -> Vec<String> { tables(inputs).into_iter().map(|table| table.name).collect() };
    let nothing =
        Inputs { study: &all.study, meshes: &[], bench: None, chunks: &[], answers: None, left_out: &[] };
    assert_eq!(names(&nothing), ["methods", "configurations", "questionnaire", "claims"]);
    let answers_only = Inputs { answers: Some(&all.answers), ..nothing };
    assert!(names(&answers_only).contains(&"preference_overall".to_owned()));
    assert!(!names(&answers_only).contains(&"benchmark".to_owned()));
    let meshes_only = Inputs { meshes: &all.meshes, ..nothing };
    let tables = tables(&meshes_only);
    let benchmark = named(&tables, "benchmark");
    assert!(!header(benchmark).contains("vertex_s") && benchmark.printed().len() == 3);
}

#[test]
fn another_study_works_as_well() {
    let study = fixture::small_study();
    let answers = Answered::of(&study, fixture::parse("Q17,Q8\nL,R\nNP,R\n", &study)).unwrap();
    let paper = fixture::study();
    let (meshes, bench) = (fixture::meshes(&paper), fixture::bench(&paper));
    let inputs = Inputs {
        study: &study,
        meshes: &meshes,
        bench: Some(&bench),
        chunks: &[],
        answers: Some(&answers),
        left_out: &[],
    };
    let tables = tables(&inputs);
    let overall = named(&tables, "preference_overall").to_csv();
    assert_eq!(overall, "configuration,factor\nbi,0.25\nsi,0.5\n");
    assert!(!tables.iter().any(|table| ["comparison", "claims", "asteroid"].contains(&table.name.as_str())));
    assert_eq!(named(&tables, "benchmark").rows.len(), 4);
    assert!(tables.iter().all(|table| !table.rows.is_empty()));
    assert_eq!(crate::figures(&inputs).unwrap().len(), 14);
}
