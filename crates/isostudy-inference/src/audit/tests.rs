use super::evidence::*;
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

fn agreement(of: &Report) -> &Agreement {
    if let Evidence::OutlyingRespondent(seen) = &of.evidence { seen } else { panic!("{of:?}") }
}

fn copies(of: &Report) -> &Copies {
    if let Evidence::CopiedRows(seen) = &of.evidence { seen } else { panic!("{of:?}") }
}

fn seen_of_key(of: &Report) -> &Key {
    if let Evidence::SwappedKey(seen) = &of.evidence { seen } else { panic!("{of:?}") }
}

fn differences(of: &Report) -> &Differences {
    if let Evidence::ObjectInteraction(seen) = &of.evidence { seen } else { panic!("{of:?}") }
}

fn separations(of: &Report) -> &Separations {
    if let Evidence::Separation(seen) = &of.evidence { seen } else { panic!("{of:?}") }
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
    assert_eq!(side.evidence, Evidence::NotAnswerable(Reason::FewInBothOrders(BothOrders::default())));
    assert_eq!(found(Probe::SwappedKey).finding, Finding::NotAnswerable);
    let odd = found(Probe::OutlyingRespondent);
    assert_eq!(odd.finding, Finding::Found);
    // Counted apart from this program.
    let Agreement { outlying, low, high } = agreement(odd);
    let percent = |share: f64| (100.0 * share).round();
    assert_eq!(
        outlying.iter().map(|&(participant, share)| (participant, percent(share))).collect::<Vec<_>>(),
        [(15, 37.0)]
    );
    assert_eq!([*low, *high].map(percent), [64.0, 95.0]);
    let object = found(Probe::ObjectInteraction);
    assert_eq!(object.finding, Finding::Found);
    // Counted by hand: 44 against 5 of 54 on the sphere, 40 against 51 of 108 on the others.
    let differing = &differences(object).found;
    let place = |of: &Difference| (of.group == "arrangement").then(|| of.object.clone());
    assert!(differing.iter().any(|of| place(of).as_deref() == Some("sphere")), "{object:?}");
    assert_eq!(found(Probe::CopiedRows).finding, Finding::NotFound);
    assert_eq!(found(Probe::Separation).finding, Finding::NotFound);
}

#[test]
fn planted_defects_are_found_with_their_place() {
    let evidence = |defect: Defect, probe| {
        let reports = planted(defect, Design::Latin, 3, 0).audit();
        let report = report(&reports, probe).clone();
        assert_eq!(report.finding, Finding::Found, "{report:?}");
        report
    };
    let side = evidence(Defect::None { preferences: false, side: 8 }, Probe::Side);
    let Evidence::Side(Pulls { pairs: Some(pull), .. }) = side.evidence else { panic!("{side:?}") };
    assert!(pull.mean > 0.0, "{pull:?}");
    assert_eq!(agreement(&evidence(Defect::OutlyingRespondent, Probe::OutlyingRespondent)).outlying[0].0, 7);
    let copied = evidence(Defect::CopiedRows, Probe::CopiedRows);
    let Copies { times: None, answers: Some(answers) } = copies(&copied) else { panic!("{copied:?}") };
    assert_eq!((answers.same, answers.copies.as_slice()), (1, [vec![4, 16]].as_slice()));
    let turned = evidence(Defect::TurnedAnswers, Probe::SwappedKey);
    let Orders::Contradict(pairs) = &seen_of_key(&turned).orders else { panic!("{turned:?}") };
    assert!(pairs.iter().any(|of| of.questions == ["Q2", "Q2-r"]), "{turned:?}");
    let timed = evidence(Defect::CopiedTimes, Probe::CopiedRows);
    let Copies { times: Some(times), answers: Some(answers) } = copies(&timed) else { panic!("{timed:?}") };
    let twins = TimeTwins { people: [4, 16], common: 32, timed: 32 };
    assert_eq!((times.copies.as_slice(), times.untimed), ([twins].as_slice(), 0));
    assert_eq!((answers.people, answers.same), (36, 0));
    let object = evidence(Defect::ObjectInteraction, Probe::ObjectInteraction);
    assert!(differences(&object).found.iter().any(|of| of.object == "object 1"), "{object:?}");
    assert!(!separations(&evidence(Defect::Separation, Probe::Separation)).separated.is_empty());
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
        seen_of_key(&found).contradictions.clone()
    };
    // The pair is asked again: half of a file's answers are to the question, half to its repeat.
    let file = |question: &str| WrongFile {
        questions: vec![question.into(), format!("{question}-r")],
        contradicting: 36,
        answers: 36,
    };
    let one = Contradiction::Forms(vec![file("Q2")]);
    assert_eq!(evidence(Defect::OneFile, Design::Latin)[0], one);
    assert_eq!(evidence(Defect::OneFile, Design::TwoMethods)[0], Contradiction::Forms(vec![file("Q1")]));
    let both = Contradiction::Forms(vec![file("Q2"), file("Q2")]);
    assert_eq!(evidence(Defect::BothFiles, Design::Latin)[0], both);
    assert_eq!(evidence(Defect::OneFile, Design::Shuffled)[0], one);
    let found = evidence(Defect::CodeName, Design::Latin);
    let Contradiction::Codes { files: 56, wrong } = &found[0] else { panic!("{found:?}") };
    assert_eq!(wrong.iter().map(|(wrong, _)| wrong).collect::<Vec<_>>(), [&file("Q2")]);
    assert!(found.contains(&one), "{found:?}");
}

#[test]
fn a_key_is_not_blamed_for_other_things() {
    let sound = planted(Defect::None { preferences: true, side: 0 }, Design::Latin, 4, 0);
    let turn = |answer: &mut Answer| {
        (answer.left, answer.right, answer.choice) = (answer.right, answer.left, answer.choice.swapped());
    };
    let agrees = of_key(&sound);
    assert_eq!(agrees.finding, Finding::NotFound);
    let sides = Key {
        contradictions: Vec::new(),
        remarks: vec![Remark::FormsAgree],
        orders: Orders::Agree { pairs: 27 },
    };
    assert_eq!(*seen_of_key(&agrees), sides);
    // Sides that somebody else dealt, whatever the forms say.
    let mut dealt_anew = sound.clone();
    let by_chance = |place: usize| (place * 7919 + place / 7 * 104_729) % 11 < 5;
    let answers = dealt_anew.responses.answers.iter_mut().enumerate();
    answers.filter(|(place, _)| by_chance(*place)).for_each(|(_, answer)| turn(answer));
    let anew = of_key(&dealt_anew);
    assert_eq!(anew.finding, Finding::NotFound, "{anew:?}");
    assert_eq!(seen_of_key(&anew).remarks, [Remark::OtherStudysForms], "{anew:?}");
    // One row that somebody typed.
    let mut typed = sound;
    typed.responses.answers.iter_mut().find(|a| a.question == 4).into_iter().for_each(turn);
    let one = of_key(&typed);
    assert_eq!(one.finding, Finding::NotFound);
    assert!(seen_of_key(&one).remarks.contains(&Remark::Stray { answers: 1 }), "{one:?}");
}

#[test]
fn a_form_that_the_file_misnames_is_found() {
    let mut sound = planted(Defect::None { preferences: true, side: 0 }, Design::Latin, 4, 0);
    assert_eq!(of_key(&sound).finding, Finding::NotFound);
    // Forms 3 and 4 show the sides the other way round from each other.
    sound.responses.participants[2].form = Some("4".into());
    let found = of_key(&sound);
    assert_eq!((found.finding, found.p), (Finding::Found, None));
    assert_eq!(seen_of_key(&found).contradictions[0], Contradiction::OtherForm(vec![2]));
    assert!(!seen_of_key(&found).remarks.contains(&Remark::FormsAgree), "{found:?}");
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
    assert_eq!(super::copies::probe(&ballots, &[]).finding, Finding::NotFound);
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
    let both = Key {
        contradictions: Vec::new(),
        remarks: vec![Remark::CodesAgree { files: 56 }, Remark::FormsAgree],
        orders: Orders::Agree { pairs: 27 },
    };
    assert_eq!((sound.finding, seen_of_key(&sound)), (Finding::NotFound, &both));
    let rows = file(true);
    let (wrong, object) = found(&rows);
    assert_eq!((wrong.finding, object), (Finding::Found, Finding::NotFound), "{wrong:?}");
    let by_forms = |of: &Contradiction| matches!(of, Contradiction::Forms(wrong) if wrong[0].questions[0].starts_with("Q1"));
    assert!(seen_of_key(&wrong).contradictions.iter().any(by_forms), "{wrong:?}");
    let without_codes = rows.lines().map(|row| row.rsplit_once(',').unwrap().0.to_owned() + "\n");
    let (wrong, object) = found(&without_codes.collect::<String>());
    assert_eq!((wrong.finding, object), (Finding::Found, Finding::NotFound), "{wrong:?}");
}

#[test]
fn times_that_everybody_has_are_no_copies() {
    let sound = planted(Defect::None { preferences: true, side: 0 }, Design::FourMethods, 9, 0);
    let changed = |change: &dyn Fn(&mut Answer)| {
        let mut changed = sound.clone();
        changed.responses.answers.iter_mut().for_each(change);
        report(&changed.audit(), Probe::CopiedRows).clone()
    };
    let own = changed(&|_| {});
    let none = SameTimes { people: 36, untimed: 0, copies: Vec::new() };
    assert_eq!(copies(&own).times.as_ref(), Some(&none));
    assert!(copies(&own).answers.is_some(), "{own:?}");
    for found in [
        // Whole seconds; one time for all; half of the people without a time, written as 0.
        changed(&|a| a.rt_ms = a.rt_ms.map(|t| 1000.0 * (t / 1000.0).round())),
        changed(&|a| a.rt_ms = Some(1500.0)),
        changed(&|a| a.rt_ms = a.rt_ms.filter(|_| a.participant % 2 == 0).or(Some(0.0))),
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
    let twins = TimeTwins { people: [4, 16], common: 13, timed: 16 };
    assert!(copies(&found).times.as_ref().is_some_and(|of| of.copies.contains(&twins)), "{found:?}");
    assert_eq!(with_others(4).finding, Finding::NotFound);
}

#[test]
fn one_hypothesis_is_tested_once() {
    // Of two objects, "on the one" is "on the other": six pairs of four methods are six comparisons, not twelve.
    let sound = Defect::None { preferences: true, side: 0 };
    let compared = |design| {
        let reports = planted(sound, design, 4, 0).audit();
        let seen = differences(report(&reports, Probe::ObjectInteraction));
        // Nothing is found, and so the number of comparisons is what is said.
        assert!(seen.found.is_empty(), "{seen:?}");
        seen.compared
    };
    assert_eq!(compared(Design::FourMethods), 6);
    assert_eq!(compared(Design::TwoMethods), 1);
    // Nine pairs in groups, three of clusterings and one of lattices over groups; three objects.
    assert_eq!(compared(Design::Latin), 39);
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
    assert_eq!(side.evidence, Evidence::Side(Pulls { pairs: None, controls: Some([0, 0, 12]) }));
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

/// Everybody presses left on one pair of so many, in both orders, and has no preference elsewhere: all have the same pull, without spread.
#[test]
fn a_pull_below_one_answer_in_twenty_is_none() {
    let of = |pairs: usize| {
        let shown = |person: usize, pair: usize| {
            let sides = if person.is_multiple_of(2) { [0, 1] } else { [1, 0] };
            let outcome = if pair == 0 { Outcome::Left } else { Outcome::Tie };
            ShownBallot::new(person, pair, sides, outcome)
        };
        let ballots: Vec<ShownBallot> =
            (0..12).flat_map(|person| (0..pairs).map(move |pair| shown(person, pair))).collect();
        let names: Vec<String> = (0..pairs).map(|pair| format!("Q{pair}")).collect();
        let scenes: Vec<usize> = (0..pairs).collect();
        let audited = Audited {
            ballots: &ballots,
            groups: &[],
            scenes: &scenes,
            questions: &names,
            objects: &names,
            sides_recorded: true,
            circumstances: &[],
            dealt: None,
        };
        report(&audit(&audited), Probe::Side).finding
    };
    assert_eq!(of(10), Finding::Found);
    assert_eq!(of(25), Finding::NotFound);
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
    assert_eq!(found.evidence, Evidence::NotAnswerable(Reason::NothingDecided));
    let found = separated(std::slice::from_ref(&both));
    let every_item_won = Separations {
        separated: Vec::new(),
        disconnected: Vec::new(),
        held_by_ties: Vec::new(),
        judged: 1,
        undecided: 0,
    };
    assert_eq!((found.finding, separations(&found)), (Finding::NotFound, &every_item_won));
    let found = separated(&[none, both, group("one", &[Outcome::Left])]);
    assert_eq!(found.finding, Finding::Found);
    let one = Separations { separated: vec!["one".into()], judged: 2, undecided: 1, ..every_item_won };
    assert_eq!(*separations(&found), one);
}
