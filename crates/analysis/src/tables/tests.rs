use super::*;
use crate::answers::Answers;
use crate::fixture::{self, Everything};
use std::path::Path;

fn named<'a>(tables: &'a [Table], name: &str) -> &'a Table {
    tables.iter().find(|table| table.name == name).unwrap_or_else(|| panic!("no table {name}"))
}

fn header(table: &Table) -> String {
    table.to_csv().lines().next().unwrap().into()
}

#[test]
fn every_table_is_there_and_scripts_find_their_columns() {
    let all = Everything::of(fixture::study());
    let tables = tables(&all.inputs()).unwrap();
    let names: Vec<&str> = tables.iter().map(|t| t.name.as_str()).collect();
    assert_eq!(
        names,
        [
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
            "quality",
            "topology",
            "positions",
            "comparison_summary",
            "comparison",
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
    assert_eq!(named(&tables, "answers").columns.len(), 19);
}

#[test]
fn rows_of_the_scripted_tables() {
    let all = Everything::of(fixture::study());
    let tables = tables(&all.inputs()).unwrap();
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
    let times = named(&tables, "benchmark");
    assert!(times.notes[0].contains("means over 5 iterations") && times.notes[0].contains("does not match"));
}

#[test]
fn order_of_records_changes_nothing() {
    let mut all = Everything::of(fixture::study());
    let before = tables(&all.inputs()).unwrap();
    all.meshes.reverse();
    assert!(tables(&all.inputs()).unwrap() == before);
}

#[test]
fn absent_parts_leave_out_their_tables() {
    let all = Everything::of(fixture::study());
    let names = |inputs: &Inputs<'_>| -> Vec<String> {
        tables(inputs).unwrap().into_iter().map(|table| table.name).collect()
    };
    let nothing = Inputs { study: &all.study, meshes: &[], bench: None, answers: None };
    assert_eq!(names(&nothing), ["configurations", "questionnaire", "claims"]);
    let answers_only = Inputs { answers: Some(&all.answers), ..nothing };
    assert!(names(&answers_only).contains(&"preference_overall".to_owned()));
    assert!(!names(&answers_only).contains(&"benchmark".to_owned()));
    let meshes_only = Inputs { meshes: &all.meshes, ..nothing };
    let tables = tables(&meshes_only).unwrap();
    let benchmark = named(&tables, "benchmark");
    assert!(!header(benchmark).contains("vertex_s") && benchmark.printed().len() == 3);
}

#[test]
fn another_study_works_as_well() {
    let study = fixture::small_study();
    let answers = Answers::parse(b"Q17,Q8\nL,R\nNP,R\n", Path::new("small.csv"), &study).unwrap();
    let paper = fixture::study();
    let (meshes, bench) = (fixture::meshes(&paper), fixture::bench(&paper));
    let inputs = Inputs { study: &study, meshes: &meshes, bench: Some(&bench), answers: Some(&answers) };
    let tables = tables(&inputs).unwrap();
    let overall = named(&tables, "preference_overall").to_csv();
    assert_eq!(overall, "configuration,factor\nbi,0.25\nsi,0.5\n");
    assert!(!tables.iter().any(|table| ["comparison", "claims", "asteroid"].contains(&table.name.as_str())));
    assert_eq!(named(&tables, "benchmark").rows.len(), 4);
    assert!(tables.iter().all(|table| !table.rows.is_empty()));
    assert_eq!(crate::figures(&inputs).unwrap().len(), 8);
}
