use super::*;
use crate::fixture;
use isostudy_inference::BallotGroup;
use isostudy_inference::hypotheses;
use isostudy_inference::omnibus::{self, Asked};
use isostudy_statistics::{DeclaredBallot, Outcome, ShownBallot};

fn table_of(hypotheses: &[Hypothesis]) -> Table {
    tests(hypotheses, &Robustness::of(hypotheses))
}

fn rows(table: &Table, start: &str) -> Vec<String> {
    table.to_csv().lines().filter(|line| line.starts_with(start)).map(str::to_owned).collect()
}

#[test]
fn the_papers_tests() {
    let study = fixture::study();
    let table = table_of(&fixture::answered(&study).hypotheses);
    assert_eq!(table.rows.len(), 4 + 9 + 3 + 9 + 6 + 3 + 9 + 27);
    let header = table.columns.iter().map(|c| c.name.as_str()).collect::<Vec<_>>();
    let header = &header;
    let shown = |start: &[&str]| {
        let cells = table.shown_rows();
        let found: Vec<Vec<String>> =
            cells.into_iter().filter(|row| row.iter().zip(start).all(|(a, b)| a == b)).collect();
        assert_eq!(found.len(), 1, "{start:?}");
        move |name: &str| found[0][header.iter().position(|h| *h == name).unwrap()].clone()
    };
    // docs/statistics.md.
    let overall = shown(&["pooled", "B-S", "all"]);
    let want = [
        ("first", "84"),
        ("no_preference", "22"),
        ("second", "56"),
        ("net", "28"),
        ("participants", "18"),
        ("p_sign_flip", "0.00940"),
        ("mean", "0.173"),
        ("low", "0.056"),
        ("high", "0.290"),
        ("p_without_one_low", "0.0063"),
        ("p_without_one_high", "0.0188"),
        ("p_binomial", "0.0222"),
        ("p_trinomial", ""),
    ];
    want.iter().for_each(|(name, want)| assert_eq!(overall(name), *want, "{name}"));
    let holm = [("U-I", "within B", "0.0027"), ("P-I", "within S", "0.0003"), ("B-S", "within U", "0.0282")];
    holm.iter().for_each(|(c, scope, p)| assert_eq!(shown(&["groups", c, scope])("p_adjusted"), *p));
    // The means are 0.722 on the sphere and -0.167 on the asteroid; on the bunny -0.037, and asteroid less bunny has p = 0.44
    // (computed apart from this program).
    let sphere = shown(&["object-pairs", "B-S", "sphere - asteroid"]);
    assert_eq!((sphere("mean"), sphere("first")), ("0.889".into(), String::new()));
    let others = shown(&["object-pairs", "B-S", "asteroid - bunny"]);
    assert_eq!(others("p_sign_flip"), "0.43878");
    assert_eq!(shown(&["interactions", "U-I", "B - S"])("conclusion"), "open");
    // Q7: 16 left, 1 none, 1 right; one answer a person, so the sign flip is the binomial test of 16 against 1.
    let question = shown(&["questions", "bu-su", "Q7"]);
    assert_eq!(question("p_sign_flip"), format!("{:.5}", 36.0 / 131_072.0));
    assert_eq!((question("net"), question("adjustment")), ("15".into(), "Benjamini-Hochberg".into()));
}

#[test]
fn who_stops_early_tells_nothing_about_differences() {
    // Half of the people stop before the last object, which is the bunny: a taste is not a change of taste.
    let study = fixture::study();
    let answered = fixture::answered(&study);
    let last = study.file.objects.len() - 1;
    let stops = |b: &&DeclaredBallot| b.participant() < 9 || study.comparisons[b.question()].object != last;
    let kept: Vec<DeclaredBallot> = answered.declared.iter().filter(stops).copied().collect();
    let tested = |contrast: &str, scope: &str| {
        let all = hypotheses::of_contrasts(&study, &kept, None).into_iter();
        all.filter(|h| h.contrast == contrast && h.scope == scope).map(|h| h.test).next().unwrap()
    };
    // Everybody counts overall and between lattices, each with the objects of their own; on the bunny those who saw it.
    assert_eq!(tested("B-S", "all").participants(), 18);
    assert_eq!(tested("U-I", "B - S").participants(), 18);
    assert_eq!(tested("B-S", "sphere - bunny").participants(), 9);
    assert_eq!(tested("B-S", "sphere - asteroid").participants(), 18);
    let complete: Vec<DeclaredBallot> = kept.iter().filter(|b| b.participant() < 9).copied().collect();
    let by_object = |ballots: &[DeclaredBallot]| {
        let all = omnibus::tests(&study, ballots).into_iter();
        all.filter(|of| matches!(of.asked, Asked::ByObject(_))).map(|of| of.test).collect::<Vec<_>>()
    };
    assert_eq!(by_object(&kept), by_object(&complete));
}

#[test]
fn every_compared_pair_is_tested_whatever_the_side() {
    let ballot = |participant, left, right, outcome| ShownBallot::new(participant, 0, [left, right], outcome);
    use Outcome::{Left, Right, Tie};
    let group = BallotGroup {
        name: "g".into(),
        items: ["a", "b", "c"].map(String::from).into(),
        ballots: vec![
            ballot(0, 0, 1, Left),
            ballot(1, 1, 0, Right),
            ballot(2, 0, 1, Tie),
            ballot(3, 1, 0, Right),
            ballot(0, 2, 1, Left),
        ],
        objects: Vec::new(),
    };
    let table = table_of(&hypotheses::of_groups(&[group]));
    // Differences 1, 1, 0, 1: two of eight patterns. scipy.stats.t.interval(.95, 3, mean, sem) of them: -0.0456, 1.5456, which no mean score reaches.
    let row = table.shown_rows().into_iter().next().unwrap();
    let want = [
        "g",
        "a-b",
        "all",
        "3",
        "1",
        "0",
        "3",
        "4",
        "0.25000",
        "0.5000",
        "Holm",
        "0.5000",
        "0.750",
        "\u{2212}0.046",
        "1.000",
    ];
    assert_eq!(row[..15], want);
    assert_eq!(rows(&table, "g,b-c").len(), 1);
    assert!(rows(&table, "g,a-c").is_empty());
    assert!(table_of(&[]).rows.is_empty());
}
