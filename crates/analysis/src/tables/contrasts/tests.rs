use super::*;
use crate::ballots::ballots;
use crate::fixture;
use statistics::Outcome;

fn rows(table: &Table, start: &str) -> Vec<String> {
    table.to_csv().lines().filter(|line| line.starts_with(start)).map(str::to_owned).collect()
}

#[test]
fn the_papers_tests() {
    let study = fixture::study();
    let table = study_tests(&fixture::answered(&study).hypotheses);
    assert_eq!(table.rows.len(), 4 + 9 + 3 + 9 + 27);
    let header = table.columns.iter().map(|c| c.name.as_str()).collect::<Vec<_>>();
    let header = &header;
    let shown = |start: &[&str]| {
        let cells = table.shown_rows();
        let found: Vec<Vec<String>> =
            cells.into_iter().filter(|row| row.iter().zip(start).all(|(a, b)| a == b)).collect();
        assert_eq!(found.len(), 1, "{start:?}");
        move |name: &str| found[0][header.iter().position(|h| *h == name).unwrap()].clone()
    };
    // STATISTICS 3.12.
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
    let sphere = shown(&["interactions", "B-S", "sphere - others"]);
    assert_eq!((sphere("p_sign_flip"), sphere("first")), ("0.00005".into(), String::new()));
    // The difference of the means 0.722 on the sphere and -0.102 elsewhere: -2 to 2.
    assert_eq!([sphere("mean"), sphere("low"), sphere("high")], ["0.824", "0.563", "1.085"]);
    assert_eq!(shown(&["interactions", "U-I", "B - S"])("conclusion"), "open");
    // Q7: 16 left, 1 none, 1 right; one answer a person, so the sign flip is the binomial test of 16 against 1.
    let question = shown(&["questions", "bu-su", "Q7"]);
    assert_eq!(question("p_sign_flip"), format!("{:.5}", 36.0 / 131_072.0));
    assert_eq!((question("net"), question("adjustment")), ("15".into(), "Benjamini-Hochberg".into()));
}

#[test]
fn does_anything_differ() {
    let study = fixture::study();
    let table = omnibus(&study, &ballots(&study, &fixture::answers(&study)));
    // SciPy 1.17.1 friedmanchisquare on the same sums: Q = 23.690; 9.9692, p 0.006842; 19.9062, p 0.00004758.
    assert_eq!(
        table.shown_rows().iter().map(|row| row[2..].join(" ")).collect::<Vec<_>>(),
        ["23.690 2 0.00001 18", "9.969 2 0.00684 18", "19.906 2 0.00005 18"]
    );
}

#[test]
fn who_stops_early_tells_nothing_about_differences() {
    // Half of the people stop before the last object, which is the bunny: a taste is not a change of taste.
    let study = fixture::study();
    let answered = fixture::answered(&study);
    let last = study.file.objects.len() - 1;
    let stops = |b: &&ShownBallot| b.participant() < 9 || study.comparisons[b.question()].object != last;
    let kept: Vec<ShownBallot> = answered.ballots.iter().filter(stops).copied().collect();
    let complete: Vec<ShownBallot> = kept.iter().filter(|b| b.participant() < 9).copied().collect();
    let interactions = |ballots: &[ShownBallot]| {
        let all = hypotheses::of_study(&study, ballots).into_iter().filter(|h| h.family == "interactions");
        all.map(|h| (h.contrast, h.scope, h.test)).collect::<Vec<_>>()
    };
    assert_eq!(interactions(&kept), interactions(&complete));
    assert!(interactions(&kept).iter().all(|(_, _, test)| test.participants() == 9));
    assert_eq!(omnibus(&study, &kept).rows, omnibus(&study, &complete).rows);
    // What is no difference counts them.
    let overall = |ballots: &[ShownBallot]| hypotheses::of_study(&study, ballots)[0].test.participants();
    assert_eq!((overall(&kept), overall(&complete)), (18, 9));
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
    };
    let table = pair_tests(&[group]);
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
        "0.750",
        "\u{2212}0.046",
        "1.000",
    ];
    assert_eq!(row[..14], want);
    assert_eq!(rows(&table, "g,b-c").len(), 1);
    assert!(rows(&table, "g,a-c").is_empty());
    assert!(pair_tests(&[]).rows.is_empty());
}
