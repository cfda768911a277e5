use super::*;
use crate::fixture;
use crate::self_test::{Defect, planted};
use statistics::Outcome;

fn report(reports: &[Report], probe: Probe) -> &Report {
    reports.iter().find(|report| report.probe == probe).unwrap()
}

#[test]
fn the_papers_answers() {
    let study = fixture::study();
    let answers = fixture::answers(&study);
    let ballots = crate::ballots(&study, &answers);
    let groups = crate::ballot_groups(&study, &ballots);
    let reports = audit(&crate::Recorded::of_study(&study, &answers, &ballots).audited(&groups));
    let found = |probe| report(&reports, probe);
    assert_eq!(reports.len(), Probe::ALL.len());
    let side = found(Probe::Side);
    assert_eq!(side.finding, Finding::NotAnswerable);
    assert!(
        side.evidence.starts_with("not answerable here, because no pair was seen in both orders"),
        "{side:?}"
    );
    assert_eq!(found(Probe::SwappedKey).finding, Finding::NotAnswerable);
    let odd = found(Probe::OddRespondent);
    assert_eq!(odd.finding, Finding::Found);
    // Counted apart from this program.
    assert_eq!(
        odd.evidence,
        "respondent 16 agrees with the others' majority on 37 %; everybody else on 64 to 95 %"
    );
    let object = found(Probe::ObjectInteraction);
    assert_eq!(object.finding, Finding::Found);
    // Counted by hand: 44 against 5 of 54 on the sphere, 40 against 51 of 108 on the others.
    assert!(object.evidence.contains("(arrangement) on sphere: mean"), "{object:?}");
    assert_eq!(found(Probe::CopiedRows).finding, Finding::NotFound);
    assert_eq!(found(Probe::Separation).finding, Finding::NotFound);
}

#[test]
fn planted_defects_are_found_with_their_place() {
    let evidence = |defect: Defect, probe| {
        let reports = planted(defect, 3, 0).audit();
        let report = report(&reports, probe).clone();
        assert_eq!(report.finding, Finding::Found, "{report:?}");
        report.evidence
    };
    assert!(evidence(Defect::SideBias, Probe::Side).contains("to the left"));
    assert!(evidence(Defect::OddRespondent, Probe::OddRespondent).starts_with("respondent 8 agrees"));
    assert!(evidence(Defect::CopiedRows, Probe::CopiedRows).starts_with("respondents 5, 17 gave the same"));
    assert!(evidence(Defect::SwappedKey, Probe::SwappedKey).contains("Q3:"));
    assert!(evidence(Defect::ObjectInteraction, Probe::ObjectInteraction).contains("on object 1"));
    assert!(evidence(Defect::Separation, Probe::Separation).contains("never won"));
}

#[test]
fn a_side_is_seen_in_controls_alone() {
    let control = |participant, outcome| ShownBallot::new(participant, 0, [1, 1], outcome);
    let shown = |participant| ShownBallot::new(participant, 1, [0, 1], Outcome::Tie);
    let mut ballots: Vec<ShownBallot> =
        (0..12).map(|participant| control(participant, Outcome::Right)).collect();
    ballots.extend((0..12).map(shown));
    let names = ["Q1".to_owned(), "Q2".to_owned()];
    let objects = ["all".to_owned()];
    let audited = Audited {
        ballots: &ballots,
        groups: &[],
        scenes: &[0, 0],
        questions: &names,
        objects: &objects,
        sides_recorded: true,
    };
    let reports = audit(&audited);
    let side = report(&reports, Probe::Side);
    assert_eq!((side.finding, side.p), (Finding::Found, Some(2.0 / 4096.0)));
    assert_eq!(side.evidence, "controls: 0 left, 0 none, 12 right");
    // Nothing else can be said.
    assert!(reports.iter().filter(|r| r.probe != Probe::Side).all(|r| r.finding == Finding::NotAnswerable));
}

#[test]
fn nothing_was_answered() {
    let audited = Audited {
        ballots: &[],
        groups: &[],
        scenes: &[],
        questions: &[],
        objects: &[],
        sides_recorded: true,
    };
    assert!(audit(&audited).iter().all(|r| r.finding == Finding::NotAnswerable));
}

#[test]
fn without_a_decision_there_are_no_worths_to_be_penalised() {
    let group = |name: &str, outcomes: &[Outcome]| BallotGroup {
        name: name.into(),
        items: ["a", "b"].map(String::from).into(),
        ballots: outcomes.iter().enumerate().map(|(i, &o)| ShownBallot::new(i, 0, [0, 1], o)).collect(),
    };
    let (none, both) = (group("none", &[Outcome::Tie; 3]), group("both", &[Outcome::Left, Outcome::Right]));
    let found = separated(std::slice::from_ref(&none));
    assert_eq!(found.finding, Finding::NotAnswerable);
    assert!(found.evidence.contains("nobody ever decided between two items"), "{found:?}");
    let found = separated(std::slice::from_ref(&both));
    let found = (found.finding, found.evidence);
    assert_eq!(found, (Finding::NotFound, "every item won against the others".into()));
    let found = separated(&[none, both, group("one", &[Outcome::Left])]);
    assert_eq!(found.finding, Finding::Found);
    assert_eq!(
        found.evidence,
        "in group one some items never won against the others: worths are penalised; in 1 group nobody ever decided"
    );
}
