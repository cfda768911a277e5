//! Answers as people send them, analysed with a study and without.

use crate::command::{Run, isostudy};
use crate::fixture::Fixture;
use std::path::Path;

/// Runs the command on a file of answers that no study explains.
pub(crate) fn analyse(arguments: &[&str]) -> Run {
    Run::of(isostudy().arg("analyse").args(arguments))
}

/// The study's answers in the long format, with what its forms add: two controls and two repeats with exchanged sides for
/// each, at their places, with times. Respondent 3 decides both controls, 5 contradicts both repeats, 7 is done in a tenth of
/// a second each.
fn recorded(fixture: &Fixture) -> String {
    let plain = fixture.folder().join("plain.csv");
    let answers = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../study/paper/responses.csv");
    let mut convert = isostudy();
    convert.arg("convert").arg(answers).arg("--study").arg(fixture.config());
    Run::succeed(convert.args(["--to", "long", "--out"]).arg(&plain));
    let text = std::fs::read_to_string(plain).unwrap();
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let at = |name: &str| header.iter().position(|column| *column == name).unwrap();
    let [who, question, left, right, choice] = ["participant", "question", "left", "right", "choice"].map(at);
    let (order, rt) = (at("order"), at("rt_ms"));
    let mut rows: Vec<Vec<String>> = Vec::new();
    for line in lines {
        let row: Vec<String> = line.split(',').map(str::to_owned).collect();
        let number: u32 = row[who].parse().unwrap();
        rows.push(row.clone());
        let asked = row[question].clone();
        if asked == "Q1" || asked == "Q2" {
            let mut again = row.clone();
            again.swap(left, right);
            again[question] = format!("{asked}-r");
            again[choice] = match (row[choice].as_str(), number == 5) {
                // The same side again is the other item. Whoever had no preference has one now.
                ("none", true) => "left".into(),
                (same, true) => same.into(),
                ("left", false) => "right".into(),
                ("right", false) => "left".into(),
                (other, false) => other.into(),
            };
            rows.push(again);
            let mut control = row;
            control[right] = control[left].clone();
            control[question] = format!("control-{}", &asked[1..]);
            control[choice] = if number == 3 { "left".into() } else { "none".into() };
            rows.push(control);
        }
    }
    let mut text = header.join(",");
    for (place, mut row) in rows.into_iter().enumerate() {
        row[rt] = if row[who] == "7" { "100".into() } else { "9000.5".into() };
        row[order] = (place + 1).to_string();
        text.push_str(&format!("\n{}", row.join(",")));
    }
    text + "\n"
}

/// A column of a table without quoted cells, by the first one.
fn cells(out: &Path, table: &str, column: &str) -> Vec<(String, String)> {
    let text = std::fs::read_to_string(out.join(format!("tables/{table}.csv"))).unwrap();
    let mut lines = text.lines();
    let place = lines.next().unwrap().split(',').position(|name| name == column).unwrap();
    let cell = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        (cells[0].to_owned(), cells[place].to_owned())
    };
    lines.map(cell).collect()
}

fn rules_broken(out: &Path) -> Vec<(String, String)> {
    cells(out, "respondents", "flags").into_iter().filter(|(_, flags)| !flags.is_empty()).collect()
}

#[test]
fn controls_repeats_and_times_are_screened_and_change_nothing_else() {
    let fixture = Fixture::new();
    fixture.succeed("analyse", &[]);
    let table =
        |name: &str| std::fs::read_to_string(fixture.out().join(format!("tables/{name}.csv"))).unwrap();
    let before = ["preference_groups", "answer_counts", "tests", "worths"].map(table);
    let path = fixture.folder().join("recorded.csv");
    std::fs::write(&path, recorded(&fixture)).unwrap();
    fixture.succeed("analyse", &["--responses", path.to_str().unwrap()]);
    assert_eq!(["preference_groups", "answer_counts", "tests", "worths"].map(table), before);

    let want = [("3", "controls"), ("5", "repeats"), ("7", "time"), ("16", "outlying")];
    assert_eq!(rules_broken(fixture.out()), want.map(|(who, rule)| (who.to_owned(), rule.to_owned())));
    let column = |name| cells(fixture.out(), "respondents", name);
    assert!(
        column("controls").iter().all(|(_, n)| n == "2") && column("timed").iter().all(|(_, n)| n == "31")
    );
    let rules: std::collections::BTreeSet<String> =
        cells(fixture.out(), "screened", "rule").into_iter().map(|(rule, _)| rule).collect();
    assert_eq!(rules.into_iter().collect::<Vec<_>>(), ["any", "controls", "outlying", "repeats", "time"]);
    let report = std::fs::read_to_string(fixture.out().join("report.md")).unwrap();
    for said in [
        "4 of 18 participants broke a rule of screening (1 by deciding between equals, 1 by choosing \
         otherwise when asked again, 1 by answering faster than anybody can look and 1 by answering against the others)",
        "Participant 3 broke a rule by deciding between equals: without them, ",
        "Participants 3, 5, 7, 16 broke some rule: without them, ",
        "36 controls",
        "Found: respondent 16 agrees with the others' majority",
    ] {
        assert!(report.contains(said), "{said}: {report}");
    }
}

#[test]
fn the_same_without_a_study() {
    let fixture = Fixture::new();
    let path = fixture.folder().join("recorded.csv");
    std::fs::write(&path, recorded(&fixture)).unwrap();
    let mapping = fixture.folder().join("mapping.toml");
    std::fs::write(&mapping, "shown_s = 4.0\n").unwrap();
    let out = fixture.folder().join("answers");
    let [path, mapping, folder] = [&path, &mapping, &out].map(|path| path.to_str().unwrap());
    let run = analyse(&[path, "--mapping", mapping, "--out", folder]);
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    let broken = rules_broken(&out);
    for (who, rule) in [("3", "controls"), ("5", "repeats"), ("7", "time")] {
        assert!(broken.contains(&(who.to_owned(), rule.to_owned())), "{broken:?}");
    }
    let audit = std::fs::read_to_string(out.join("tables/audit.csv")).unwrap();
    assert_eq!(audit.lines().count(), 7);
    let report = std::fs::read_to_string(out.join("report.md")).unwrap();
    assert!(
        report.contains("## How far the answers can be relied on")
            && report.contains("Participant 7 broke a rule by answering faster than anybody can look")
    );
    std::fs::write(mapping, "shown_s = -4.0\n").unwrap();
    let run = analyse(&[path, "--mapping", mapping, "--out", folder]);
    assert!(run.code == Some(2) && run.stderr.contains("shown_s = -4"), "{}", run.stderr);
}

#[test]
fn help_names_every_format_and_column() {
    let help = |command: &str| {
        let text = Run::succeed(isostudy().args([command, "--help"])).stdout;
        text.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    let (analyse, convert) = (help("analyse"), help("convert"));
    for help in [&analyse, &convert] {
        assert!(help.contains(&isostudy_responses::Format::names()), "{help}");
    }
    for column in isostudy_responses::LONG_COLUMNS {
        let named = [", ", " ", ". "].iter().any(|end| analyse.contains(&format!(" {column}{end}")));
        assert!(named, "{column}: {analyse}");
    }
    assert!(convert.contains(&format!("long: {}", isostudy_responses::LONG_WRITTEN.join(", "))), "{convert}");
}

#[test]
fn what_is_written_for_pwcmp_is_read_again() {
    let fixture = Fixture::new();
    let answers = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../study/paper/responses.csv");
    let file = |name: &str| fixture.folder().join(name);
    let convert = |from: &Path, more: &[&str], to: &Path| {
        let mut command = isostudy();
        command.arg("convert").arg(from).arg("--study").arg(fixture.config()).args(more).arg("--out").arg(to);
        let run = Run::of(&mut command);
        (run.code == Some(0), run.stderr)
    };
    let (split, again, straight) = (file("split.csv"), file("again.csv"), file("straight.csv"));
    let (done, said) = convert(&answers, &["--to", "pwcmp"], &split);
    assert!(!done && said.contains("give `--ties split` or `--ties drop`"), "{said}");
    for (from, more, to) in [
        (&answers, &["--to", "pwcmp", "--ties", "split"][..], &split),
        (&split, &["--to", "arenakit"], &again),
        (&answers, &["--to", "arenakit"], &straight),
    ] {
        let (done, said) = convert(from, more, to);
        assert!(done, "{said}");
    }
    assert_eq!(std::fs::read_to_string(again).unwrap(), std::fs::read_to_string(straight).unwrap());
}

/// What is published of the paper's answers is what these sources make of them.
#[test]
fn published_tables_are_those_of_the_answers() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let published = root.join("results/published/tables");
    let fixture = Fixture::new();
    let out = fixture.folder().join("analysed");
    let mut command = isostudy();
    Run::succeed(command.arg("analyse").arg(root.join("configs/paper.toml")).arg("--out").arg(&out));
    for name in ["contrasts", "preference_groups", "preference_overall", "preference_margins", "tests"] {
        let read = |folder: &Path| std::fs::read_to_string(folder.join(format!("{name}.csv"))).unwrap();
        let (before, now) = (read(&published), read(&out.join("tables")));
        assert!(before.lines().count() > 2, "{name}");
        assert_eq!(before, now, "{name}: scripts/publish-results.sh renews what is published");
    }
}

/// A and B stand on other sides on the one object than on the other, so that a liking for the left would make the difference. NumPy
/// 2.4.6 and SciPy 1.17.1 find 0.24503 on the same answers: brentq of the end of the clustered t interval, Davidson's model with that
/// liking given and its sandwich written anew.
#[test]
fn how_much_liking_for_a_side_would_undo_a_difference_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let mut text = String::from("participant,question,object,group,left,right,choice\n");
    for p in 0..24 {
        for (object, sides, [least, most]) in [("hill", "A,B", [7, 8]), ("cave", "B,A", [5, 7])] {
            for k in 0..3 {
                let choice = match ((7 * p + 4 * k) * (p + 1)) % 11 {
                    h if h < least => "left",
                    h if h < most => "none",
                    _ => "right",
                };
                text.push_str(&format!("p{p},{object}{k},{object},g,{sides},{choice}\n"));
            }
        }
    }
    let (answers, out) = (folder.path().join("answers.csv"), folder.path().join("out"));
    std::fs::write(&answers, text).unwrap();
    let run = analyse(&[answers.to_str().unwrap(), "--out", out.to_str().unwrap()]);
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    let report = std::fs::read_to_string(out.join("report.md")).unwrap();
    let line = report.lines().find(|line| line.contains("How much A is preferred to B differs.")).unwrap();
    assert!(line.contains("On hill: 48 answers against 20, 4 without preference"), "{line}");
    assert!(line.contains("A liking for the left side of 0.25 log-odds"), "{line}");
}

/// Naming a reference moves the zero of every scale that has it, and nothing that is tested or counted.
#[test]
fn a_studys_reference_stands_at_zero_and_changes_nothing_else() {
    let fixture = Fixture::new();
    fixture.succeed("analyse", &[]);
    let table =
        |name: &str| std::fs::read_to_string(fixture.out().join(format!("tables/{name}.csv"))).unwrap();
    let unmoved = ["contrasts", "tests", "preference_groups", "agreement"];
    let before = unmoved.map(table);
    let worths = || -> std::collections::BTreeMap<(String, String), (String, f64)> {
        let text = table("scale");
        let rows = text.lines().skip(1).map(|line| {
            let cells: Vec<&str> = line.split(',').map(|cell| cell.trim_matches('"')).collect();
            ((cells[0].into(), cells[1].into()), (cells[2].into(), cells[3].parse().unwrap()))
        });
        rows.collect()
    };
    let first = worths();
    let config = std::fs::read_to_string(fixture.config()).unwrap();
    assert!(!config.contains("[analysis]"));
    std::fs::write(fixture.config(), config + "\n[analysis]\nreference = \"si\"\n").unwrap();
    fixture.succeed("analyse", &[]);
    assert_eq!(unmoved.map(table), before);
    let moved = worths();
    assert_eq!(moved.len(), first.len());
    // si, where a group has it; of factors, its levels; elsewhere the first in the study's order.
    for (group, reference) in [
        ("S", "si"),
        ("I", "si"),
        ("all", "si"),
        ("clustering", "I"),
        ("arrangement", "S"),
        ("B", "bu"),
        ("P", "sp"),
    ] {
        let of = |worths: &std::collections::BTreeMap<_, (String, f64)>, item: &str| {
            worths[&(group.to_owned(), item.to_owned())].1
        };
        let own: Vec<&(String, String)> = moved.keys().filter(|(of, _)| of == group).collect();
        assert!(own.len() >= 2, "{group}");
        for (_, item) in own {
            assert_eq!(moved[&(group.to_owned(), item.clone())].0, reference, "{group} {item}");
            let want = of(&first, item) - of(&first, reference);
            assert!((of(&moved, item) - want).abs() < 1e-8, "{group} {item}: {} {want}", of(&moved, item));
        }
    }
}
