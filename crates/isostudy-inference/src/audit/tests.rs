use super::*;
use crate::fixture;
use crate::self_test::{Defect, Design, Planted, planted};
use isostudy_design::Study;
use isostudy_design::forms::{KeyEntry, Questionnaire};
use isostudy_responses::Answer;
use isostudy_statistics::Outcome;
use std::cmp::Ordering;

fn report(reports: &[Report], probe: Probe) -> &Report {
    reports.iter().find(|report| report.probe == probe).unwrap()
}

#[test]
fn the_papers_answers() {
    let study = fixture::study();
    let answers = fixture::answers(&study);
    let ballots = crate::ballots::ballots(&study, &answers);
    let groups = crate::ballots::ballot_groups(&study, &ballots);
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
    let odd = found(Probe::OutlyingRespondent);
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
        let reports = planted(defect, Design::Latin, 3, 0).audit();
        let report = report(&reports, probe).clone();
        assert_eq!(report.finding, Finding::Found, "{report:?}");
        report.evidence
    };
    assert!(evidence(Defect::None { preferences: false, side: 8 }, Probe::Side).contains("to the left"));
    assert!(
        evidence(Defect::OutlyingRespondent, Probe::OutlyingRespondent).starts_with("respondent 8 agrees")
    );
    assert!(evidence(Defect::CopiedRows, Probe::CopiedRows).starts_with("respondents 5, 17 gave the same"));
    assert!(evidence(Defect::TurnedAnswers, Probe::SwappedKey).contains("Q2/Q2-r: mean"));
    let times = evidence(Defect::CopiedTimes, Probe::CopiedRows);
    let want = "to the millisecond, respondents 5 and 17 took the same time for 32 of 32 answers; no two of 36 people gave";
    assert!(times.starts_with(want), "{times}");
    assert!(evidence(Defect::ObjectInteraction, Probe::ObjectInteraction).contains("on object 1"));
    assert!(evidence(Defect::Separation, Probe::Separation).contains("never won"));
}

/// What is found of the key, and that no object is blamed for it.
fn of_key(planted: &Planted) -> Report {
    let reports = planted.audit();
    assert_ne!(report(&reports, Probe::ObjectInteraction).finding, Finding::Found);
    report(&reports, Probe::SwappedKey).clone()
}

#[test]
fn a_wrong_key_is_named() {
    let evidence = |defect, design| {
        let found = of_key(&planted(defect, design, 4, 0));
        assert_eq!((found.finding, found.p), (Finding::Found, None), "{found:?}");
        found.evidence
    };
    // The pair is asked again: half of a file's answers are to the question, half to its repeat.
    let file = |question| format!("{question}/{question}-r: 36 of 36 answers");
    let labelled = "answers are labelled in the other order of sides than their forms show";
    let one = format!("{labelled} ({})", file("Q2"));
    assert!(evidence(Defect::OneFile, Design::Latin).starts_with(&one));
    assert!(
        evidence(Defect::OneFile, Design::TwoMethods).starts_with(&format!("{labelled} ({})", file("Q1")))
    );
    let both = format!("{labelled} ({}, {})", file("Q2"), file("Q2"));
    assert!(evidence(Defect::BothFiles, Design::Latin).starts_with(&both));
    let shuffled = evidence(Defect::OneFile, Design::Shuffled);
    assert!(shuffled.starts_with(&one), "{shuffled}");
    let coded =
        "the sides contradict what the code name shows in 1 of 56 files (Q2/Q2-r: 36 of 36 answers to file ";
    let found = evidence(Defect::CodeName, Design::Latin);
    assert!(found.starts_with(coded) && found.contains(&one), "{found}");
}

#[test]
fn a_key_is_not_blamed_for_other_things() {
    let sound = planted(Defect::None { preferences: true, side: 0 }, Design::Latin, 4, 0);
    let turn = |answer: &mut Answer| {
        (answer.left, answer.right, answer.choice) = (answer.right, answer.left, answer.choice.swapped());
    };
    let agrees = of_key(&sound);
    assert_eq!(agrees.finding, Finding::NotFound);
    assert_eq!(agrees.evidence, "the sides are those of the forms; the two orders of 27 pairs agree");
    // Sides that somebody else dealt, whatever the forms say.
    let mut dealt_anew = sound.clone();
    let by_chance = |place: usize| (place * 7919 + place / 7 * 104_729) % 11 < 5;
    let answers = dealt_anew.responses.answers.iter_mut().enumerate();
    answers.filter(|(place, _)| by_chance(*place)).for_each(|(_, answer)| turn(answer));
    let anew = of_key(&dealt_anew);
    assert_eq!(anew.finding, Finding::NotFound, "{anew:?}");
    assert!(
        anew.evidence.starts_with("the sides are not those of the forms that the study deals"),
        "{anew:?}"
    );
    // One row that somebody typed.
    let mut typed = sound;
    typed.responses.answers.iter_mut().find(|a| a.question == 4).into_iter().for_each(turn);
    let one = of_key(&typed);
    assert_eq!(one.finding, Finding::NotFound);
    assert!(one.evidence.contains("1 single answer contradicts the forms"), "{one:?}");
}

#[test]
fn a_form_that_the_file_misnames_is_found() {
    let mut sound = planted(Defect::None { preferences: true, side: 0 }, Design::Latin, 4, 0);
    assert_eq!(of_key(&sound).finding, Finding::NotFound);
    // Forms 3 and 4 show the sides the other way round from each other.
    sound.responses.participants[2].form = Some("4".into());
    let found = of_key(&sound);
    assert_eq!((found.finding, found.p), (Finding::Found, None));
    let want = "the sides are those of another form than the file names for respondent 3";
    assert!(found.evidence.starts_with(want), "{found:?}");
    assert!(!found.evidence.contains("the sides are those of the forms;"), "{found:?}");
}

#[test]
fn who_presses_one_button_is_no_copy() {
    let report_of = |study| {
        let reports = planted(Defect::PressingLeft, Design::Latin, 3, study).audit();
        report(&reports, Probe::CopiedRows).clone()
    };
    let found = (0..20).filter(|&study| report_of(study).finding == Finding::Found).count();
    assert_eq!(found, 0);
    // Unanimous people give the same rows by what they all think, and six who press left change nothing about it.
    let ballot = |person: usize, question: usize| {
        let outcome = if person < 6 || question.is_multiple_of(2) { Outcome::Left } else { Outcome::Right };
        isostudy_statistics::ShownBallot::new(person, question, [0, 1], outcome)
    };
    let ballots: Vec<_> =
        (0..36).flat_map(|person| (0..27).map(move |question| ballot(person, question))).collect();
    assert_eq!(copies::probe(&ballots, &[]).finding, Finding::NotFound);
}

#[test]
fn one_person_shows_nothing() {
    let mut one = planted(Defect::None { preferences: true, side: 0 }, Design::Latin, 4, 0);
    one.responses.answers.retain(|answer| answer.participant == 0);
    one.responses.participants.truncate(1);
    let reports = one.audit();
    for probe in [Probe::Side, Probe::ObjectInteraction] {
        assert_eq!(report(&reports, probe).finding, Finding::NotAnswerable, "{:?}", report(&reports, probe));
    }
}

#[test]
fn form_numbers_decide_where_sides_do_not() {
    // Of two pairs one is labelled the other way round throughout: each form fits as well as its mirror image.
    let mut both = planted(Defect::BothFiles, Design::TwoMethods, 4, 0);
    assert_eq!(of_key(&both).finding, Finding::Found);
    both.responses.participants.iter_mut().for_each(|participant| participant.form = None);
    assert_eq!(report(&both.audit(), Probe::SwappedKey).finding, Finding::NotAnswerable);
}

#[test]
fn a_wrong_key_is_found_in_the_file_that_people_have() {
    let path = fixture::paper_path().with_file_name("balanced.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    let bunny = text.split("[objects.field]").nth(1).unwrap().split("[turntable]").next().unwrap();
    let text =
        text.replace(&format!("[objects.field]{bunny}"), "field = { kind = \"sphere\", radius = 0.4 }\n\n");
    let study = Study::parse(&text, &path).unwrap();
    let key = Questionnaire::of(&study).unwrap().key();
    let file = |wrong: bool| {
        let mut rows = "participant,form,order,question,left,right,choice,stimulus\n".to_owned();
        for entry in key.iter().filter(|entry| entry.role != isostudy_design::forms::Role::Training) {
            let KeyEntry { form, order, question, left, right, stimulus, .. } = entry;
            let worth = |id: &str| "pi u".find(&id[4..]).unwrap_or(9);
            let choice = match worth(left).cmp(&worth(right)) {
                Ordering::Less => "right",
                Ordering::Equal => "none",
                Ordering::Greater => "left",
            };
            let turned = wrong && (left.as_str(), right.as_str()) == ("ss_bu", "ss_bi");
            let (left, right) = if turned { (right, left) } else { (left, right) };
            rows += &format!("p{form},{form},{order},{question},{left},{right},{choice},{stimulus}\n");
        }
        rows
    };
    let found = |rows: &str| {
        let answers = fixture::parse(rows, &study);
        let shown = crate::ballots::ballots(&study, &answers);
        let groups = crate::ballots::ballot_groups(&study, &shown);
        let reports = audit(&crate::Recorded::of_study(&study, &answers, &shown).audited(&groups));
        (report(&reports, Probe::SwappedKey).clone(), report(&reports, Probe::ObjectInteraction).finding)
    };
    let (sound, _) = found(&file(false));
    let both = "the code names of 56 files agree with the sides; the sides are those of the forms; the two orders of 27 pairs agree";
    assert_eq!((sound.finding, sound.evidence.as_str()), (Finding::NotFound, both));
    let rows = file(true);
    let (wrong, object) = found(&rows);
    assert_eq!((wrong.finding, object), (Finding::Found, Finding::NotFound), "{wrong:?}");
    assert!(wrong.evidence.contains("show (Q1"), "{wrong:?}");
    let without_codes = rows.lines().map(|row| row.rsplit_once(',').unwrap().0.to_owned() + "\n");
    let (wrong, object) = found(&without_codes.collect::<String>());
    assert_eq!((wrong.finding, object), (Finding::Found, Finding::NotFound), "{wrong:?}");
}

#[test]
fn times_that_everybody_has_are_no_copies() {
    let sound = planted(Defect::None { preferences: true, side: 0 }, Design::FourMethods, 9, 0);
    let copies = |change: &dyn Fn(&mut Answer)| {
        let mut changed = sound.clone();
        changed.responses.answers.iter_mut().for_each(change);
        report(&changed.audit(), Probe::CopiedRows).clone()
    };
    let own = copies(&|_| {});
    assert!(own.evidence.starts_with("no two of 36 people took the same times; "), "{own:?}");
    for found in [
        // Whole seconds; one time for all; half of the people without a time, written as 0.
        copies(&|a| a.rt_ms = a.rt_ms.map(|t| 1000.0 * (t / 1000.0).round())),
        copies(&|a| a.rt_ms = Some(1500.0)),
        copies(&|a| a.rt_ms = a.rt_ms.filter(|_| a.participant % 2 == 0).or(Some(0.0))),
    ] {
        assert_eq!(found.finding, Finding::NotFound, "{found:?}");
    }
}

#[test]
fn nearly_all_times_make_a_copy() {
    let with_others = |others: usize| {
        let mut copied = planted(Defect::CopiedTimes, Design::FourMethods, 9, 0);
        let own = copied.responses.answers.iter_mut().filter(|a| a.participant == 16);
        own.take(others).for_each(|a| a.rt_ms = a.rt_ms.map(|t| t + 1.0));
        report(&copied.audit(), Probe::CopiedRows).clone()
    };
    let found = with_others(3);
    assert_eq!(found.finding, Finding::Found);
    assert!(
        found.evidence.contains("respondents 5 and 17 took the same time for 13 of 16 answers"),
        "{found:?}"
    );
    assert_eq!(with_others(4).finding, Finding::NotFound);
}

#[test]
fn one_hypothesis_is_tested_once() {
    // Of two objects, "on the one" is "on the other": six pairs of four methods are six comparisons, not twelve.
    let sound = Defect::None { preferences: true, side: 0 };
    let compared = |design| {
        let reports = planted(sound, design, 4, 0).audit();
        report(&reports, Probe::ObjectInteraction).evidence.split(';').next().unwrap().to_owned()
    };
    assert_eq!(compared(Design::FourMethods), "6 comparisons");
    assert_eq!(compared(Design::TwoMethods), "1 comparison");
    // Nine pairs in groups, three of clusterings and one of lattices over groups; three objects.
    assert_eq!(compared(Design::Latin), "39 comparisons");
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
        circumstances: &[],
        dealt: None,
    };
    let reports = audit(&audited);
    let side = report(&reports, Probe::Side);
    assert_eq!((side.finding, side.p), (Finding::Found, Some(2.0 / 4096.0)));
    assert_eq!(side.evidence, "controls: 0 left, 0 none, 12 right");
    // Nothing else can be said.
    assert!(reports.iter().filter(|r| r.probe != Probe::Side).all(|r| r.finding == Finding::NotAnswerable));
}

/// Four people who all press left on a pair in both orders: an exact test of four cannot be below 1/8, and of twelve not below 2^-11.
#[test]
fn people_who_do_not_differ_show_no_more_than_their_number() {
    let p = |people: usize| {
        let sides = |person: usize, question: usize| {
            if (person + question).is_multiple_of(2) { [0, 1] } else { [1, 0] }
        };
        let shown = |person| {
            move |question| ShownBallot::new(person, question, sides(person, question), Outcome::Left)
        };
        let ballots: Vec<ShownBallot> = (0..people).flat_map(|person| (0..2).map(shown(person))).collect();
        let names = ["Q1".to_owned(), "Q2".to_owned()];
        let objects = ["sphere".to_owned(), "bunny".to_owned()];
        let audited = Audited {
            ballots: &ballots,
            groups: &[],
            scenes: &[0, 1],
            questions: &names,
            objects: &objects,
            sides_recorded: true,
            circumstances: &[],
            dealt: None,
        };
        report(&audit(&audited), Probe::Side).clone()
    };
    assert_eq!(p(4).p, Some(0.125));
    assert_ne!(p(4).finding, Finding::Found);
    assert_eq!((p(12).finding, p(12).p), (Finding::Found, Some(2.0_f64.powi(-11))));
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
        circumstances: &[],
        dealt: None,
    };
    assert!(audit(&audited).iter().all(|r| r.finding == Finding::NotAnswerable));
}

#[test]
fn without_a_decision_there_are_no_worths_to_be_penalised() {
    let group = |name: &str, outcomes: &[Outcome]| BallotGroup {
        name: name.into(),
        items: ["a", "b"].map(String::from).into(),
        ballots: outcomes.iter().enumerate().map(|(i, &o)| ShownBallot::new(i, 0, [0, 1], o)).collect(),
        objects: Vec::new(),
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
