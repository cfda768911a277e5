//! Every table of a study and its report, with those of the paper among them.

use super::*;
use crate::fixture::{self, Everything};
use isostudy_report::Report;
use isostudy_table::Cell;

fn tables(inputs: &Inputs<'_>) -> Vec<Table> {
    of_results(&Results::of(inputs))
}

fn of_results(results: &Results<'_>) -> Vec<Table> {
    let mut tables = isostudy_report::tables(results);
    Paper::of(results).add_tables(&mut tables);
    tables
}

fn texts(report: &Report, id: &str) -> Vec<String> {
    let section = report.sections.iter().find(|s| s.id == id);
    let text = |b: &Block| if let Block::Finding(f) = b { Some(f.text.clone()) } else { None };
    section.map(|s| s.blocks.iter().filter_map(text).collect()).unwrap_or_default()
}

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
            "likings",
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
    assert!(Paper::of(&Results::of(&all.inputs())).unexplained_differences().is_empty());
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
    let nothing = Inputs {
        study: &all.study,
        meshes: &[],
        bench: None,
        chunks: &[],
        stored: &[],
        answers: None,
        left_out: &[],
    };
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
        stored: &[],
        answers: Some(&answers),
        left_out: &[],
    };
    let tables = tables(&inputs);
    let overall = named(&tables, "preference_overall").to_csv();
    assert_eq!(overall, "configuration,factor\nbi,0.25\nsi,0.5\n");
    assert!(!tables.iter().any(|table| ["comparison", "claims", "asteroid"].contains(&table.name.as_str())));
    assert_eq!(named(&tables, "benchmark").rows.len(), 4);
    assert!(tables.iter().all(|table| !table.rows.is_empty()));
    assert_eq!(isostudy_report::figures(&Results::of(&inputs)).unwrap().len(), 15);
}

#[test]
fn the_papers_answers() {
    let all = Everything::of(fixture::study());
    let inputs = all.inputs();
    let results = Results::of(&inputs);
    let tables = of_results(&results);
    let figures = isostudy_report::figures(&results).unwrap();
    let published = Paper::of(&results).published(&tables);
    let report = isostudy_report::report(&results, &tables, &figures, published);
    let ids: Vec<&str> = report.sections.iter().map(|s| s.id).collect();
    let want = [
        "decision",
        "worths",
        "preferences",
        "prediction",
        "published",
        "bearing",
        "tables",
        "machine",
        "appendix",
    ];
    assert_eq!(ids, want);
    assert_eq!(
        report.lead[0],
        "18 participants gave 486 answers to 27 questions about 3 objects (sphere, asteroid and bunny)."
    );
    // The numbers are those of docs/statistics.md.
    let preferences = texts(&report, "preferences");
    let told = [
        "Integrated clustering was preferred to edge collapse: 67 answers against 18, 23 without preference; 73 % (65 to 80 %), \
         adjusted p < 0.001. A liking for the right side of 0.86 log-odds (70 % between equals) would undo it. It depends on the object \
         (adjusted p = 0.0064).",
        "The body-centred lattice was preferred to the simple cubic lattice: 84 answers against 56, 22 without preference; 59 % (53 to \
         65 %), adjusted p = 0.0094. With one correction over all tests it does not hold (p = 0.22). A liking for the left side of 0.11 \
         log-odds (53 % between equals) would undo it. It depends on the object (adjusted p < 0.001). Without the sphere it is not shown \
         (p = 0.30).",
        "Integrated clustering and edge collapse on the body-centred lattice are not distinguished: 22 answers against 15, 17 without \
         preference; 56 % (46 to 67 %), adjusted p = 0.82. It depends on the object (adjusted p = 0.0064).",
        "How much the body-centred lattice is preferred to the simple cubic lattice differs. On the sphere: 44 answers against 5, 5 \
         without preference. On the asteroid: 18 answers against 27, 9 without preference. The difference holds (adjusted p < 0.001). No \
         liking for a side up to 5 log-odds would undo it.",
    ];
    for text in told {
        assert!(preferences.iter().any(|own| own == text), "{text}\n{preferences:#?}");
    }
    // What takes most is in tables, for which a report has no words.
    let words = report.to_markdown().split_whitespace().count();
    assert!(words <= 15_000, "{words}");
    let factors = texts(&report, "tables");
    assert!(
        factors[1].ends_with(
            "143/162 on the body-centred lattice (19 ties) and 154/162 on the simple cubic lattice (8 ties)."
        ),
        "{factors:#?}"
    );
    assert!(factors[2].contains("Of the difference of 0.150, \u{2212}0.023 comes from ties"), "{factors:#?}");
    assert!(
        factors[3].ends_with("the largest sum goes to bi on the sphere and si on the asteroid and bunny."),
        "{factors:#?}"
    );
    let checks = texts(&report, "bearing");
    let bearing = checks.join("\n");
    assert!(
        bearing.contains("No clustering and the body-centred lattice always stood on the left")
            && bearing.contains("144 answers went left, 293 right and 49 to neither"),
        "{bearing}"
    );
    assert!(bearing.contains("Participant 16 (10 of 27, 37 %) answers against the majority of the others more often than with it; everybody else sides with it in 64 to 95 %."), "{bearing}");
    assert!(
        bearing.contains("of 108 triads of three items, 82 were decided throughout, and 5 go in a circle"),
        "{bearing}"
    );
    assert!(
        bearing.contains("1 of 18 participants broke a rule of screening (1 by answering against the others). Nobody is left out")
            && bearing
                .contains("Judged: agreement. Not judged, because the answers do not tell: one-sidedness, controls, repeats and times."),
        "{checks:#?}"
    );
    assert!(
        bearing.contains(
            "Participant 16 broke a rule by answering against the others: without them, 2 of 43 tests are decided otherwise. "
        ),
        "{checks:#?}"
    );
    assert!(checks.iter().any(|text| text
        == "Does anybody answer against the others? Found: respondent 16 agrees with the others' majority on 37 %; everybody \
            else on 64 to 95 % (p = 0.0067)."), "{checks:#?}");
    // Every table and figure is printed once.
    let mut printed = 0;
    for block in report.sections.iter().flat_map(|s| &s.blocks) {
        printed += usize::from(matches!(block, Block::Table(_) | Block::Folded(_) | Block::Figure(_)));
    }
    printed += usize::from(report.methods.is_some());
    assert_eq!(printed, tables.len() + figures.len());
    // What stands before everything else.
    let labels: Vec<&str> = report.summary.iter().map(|line| line.label).collect();
    assert_eq!(labels, ["Compared", "By whom", "Found", "How sure", "Limits", "Next"]);
    let line = |label: &str| &report.summary.iter().find(|line| line.label == label).unwrap().text;
    assert!(line("Found").starts_with("People preferred integrated clustering over no clustering (86 %). "));
    let screened = "1 of 18 people broke a rule of screening. Without them, 1 of 43 contrasts becomes undecided with fewer people and \
                    1 holds only then.";
    assert!(line("Found").contains(screened), "{}", line("Found"));
    // By the scale; a question showed that bi and si differ on the sphere.
    let liked =
        "Most liked over all objects: si (simple cubic, integrated), not shown to differ from bi and bp.";
    assert!(line("Found").contains(liked), "{}", line("Found"));
    assert!(line("Found").contains("Most liked on the sphere: bi (body-centred, integrated)."));
    assert!(line("How sure").starts_with("21 of 43 contrasts hold at the level of 0.05"));
    assert!(line("Limits").starts_with("No pair was shown with its sides exchanged"));
    assert!(report.limits.iter().any(|limit| limit.starts_with("Display: the source files do not say")));
}
