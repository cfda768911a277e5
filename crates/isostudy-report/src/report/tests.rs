use super::*;
use crate::fixture;
use isostudy_inference::{Answered, BallotGroup, Inputs, hypotheses};
use isostudy_responses::{Answer, Choice, Question, Responses};
use isostudy_statistics::Outcome::{self, Left, Right, Tie};
use isostudy_statistics::ShownBallot;

/// Of a study with answers and nothing else.
fn of_answers<'a>(study: &'a isostudy_design::Study, answered: &'a Answered) -> Inputs<'a> {
    Inputs {
        study,
        meshes: &[],
        bench: None,
        chunks: &[],
        stored: &[],
        answers: Some(answered),
        left_out: &[],
    }
}

/// What the paper's study says if people answered like this; the argument is participant and question.
fn said(people: usize, answer: impl Fn(usize, usize) -> Outcome) -> Vec<(&'static str, Vec<Finding>)> {
    let study = fixture::study();
    let mut answers = fixture::answers(&study);
    answers.answers.retain(|answer| (answer.participant as usize) < people);
    for of in &mut answers.answers {
        of.choice = choice(answer(of.participant as usize, of.question as usize));
    }
    let answered = Answered::of(&study, answers).unwrap();
    let inputs = of_answers(&study, &answered);
    let results = Results::of(&inputs);
    let evidence = Evidence::of_study(&results);
    let mut builder = Builder::new(&[], &[]);
    builder.preferences(&evidence);
    builder.reliance(&evidence);
    let report = builder.finish("A test".into(), &evidence, None, None);
    let findings = |s: &Section| {
        let of =
            s.blocks.iter().filter_map(|b| if let Block::Finding(f) = b { Some(f.clone()) } else { None });
        (s.id, of.collect())
    };
    report.sections.iter().map(findings).collect()
}

fn groups(answers: &[(usize, usize, usize, Outcome)]) -> Vec<BallotGroup> {
    let ballot = |&(participant, left, right, outcome)| {
        ShownBallot::new(participant, left + right - 1, [left, right], outcome)
    };
    let items = ["oak", "elm", "ash"].map(String::from).into();
    vec![BallotGroup {
        name: "trees".into(),
        items,
        ballots: answers.iter().map(ballot).collect(),
        objects: Vec::new(),
    }]
}

fn choice(outcome: Outcome) -> Choice {
    match outcome {
        Left => Choice::Left,
        Tie => Choice::NoPreference,
        Right => Choice::Right,
    }
}

/// The answers of these groups, which are about one object.
fn responses(groups: &[BallotGroup]) -> Responses {
    let mut answers = Responses { sides_recorded: true, ..Responses::default() };
    for group in groups {
        answers.items.extend(group.items.iter().cloned());
        for ballot in &group.ballots {
            let sides = [ballot.left() as u32, ballot.right() as u32];
            while answers.questions.len() <= ballot.question() {
                let id = format!("Q{}", answers.questions.len() + 1);
                answers.questions.push(Question::new(&id, "garden", &group.name, sides));
            }
            let (person, question) = (ballot.participant() as u32, ballot.question() as u32);
            answers.answers.push(Answer::new(person, question, sides, choice(ballot.outcome())));
        }
    }
    answers
}

/// The report of these groups' answers.
fn report_of(title: &str, groups: &[BallotGroup]) -> Report {
    let answers = responses(groups);
    let preferences = Preferences::without_study(&answers, groups, None);
    report_of_groups(title, &preferences, &[], &[])
}

fn texts(report: &Report, id: &str) -> Vec<String> {
    let section = report.sections.iter().find(|s| s.id == id);
    let text = |b: &Block| if let Block::Finding(f) = b { Some(f.text.clone()) } else { None };
    section.map(|s| s.blocks.iter().filter_map(text).collect()).unwrap_or_default()
}

fn of<'a>(said: &'a [(&str, Vec<Finding>)], id: &str, start: &str) -> &'a Finding {
    let section = said.iter().find(|(name, _)| *name == id).unwrap_or_else(|| panic!("no section {id}"));
    let found: Vec<&Finding> = section.1.iter().filter(|f| f.text.starts_with(start)).collect();
    assert_eq!(found.len(), 1, "{start}: {:#?}", section.1);
    found[0]
}

#[test]
fn a_planted_effect_holds_whoever_stands_left() {
    // Everybody takes the body-centred lattice, which stands on the left, and nobody decides on clusterings.
    let said = said(18, |_, question| if question % 9 >= 6 { Left } else { Tie });
    let found =
        of(&said, "preferences", "The body-centred lattice was preferred to the simple cubic lattice:");
    assert_eq!(found.standing, Standing::Holds);
    assert_eq!(
        found.text,
        "The body-centred lattice was preferred to the simple cubic lattice: 162 answers against 0, none without preference; 100 % \
         (81 to 100 %), adjusted p < 0.001. How large a liking for a side would undo it cannot be said: no answer went \
         the other way."
    );
    let found = of(&said, "preferences", "No clustering against edge collapse:");
    assert_eq!(found.standing, Standing::Open);
    assert!(
        found.text.contains("nobody leans either way (0 answers against 0, 108 without preference)"),
        "{}",
        found.text
    );
    let found = of(&said, "preferences", "9 of 12 comparisons on one object each are not decided:");
    assert!(
        found.text.ends_with("and 5 more. Nobody leans one way or the other on any of them."),
        "{}",
        found.text
    );
}

#[test]
fn nobody_leaning_is_said_so() {
    let said = said(18, |_, _| Tie);
    let found = said.iter().flat_map(|(_, found)| found);
    assert!(found.into_iter().all(|of| of.standing != Standing::Holds), "{said:#?}");
    of(&said, "preferences", "9 of 9 comparisons within one level each are not decided: ");
    let answers: Vec<_> = (0..18).map(|person| (person, 0, 1, Tie)).collect();
    let report = report_of("Trees", &groups(&answers));
    assert_eq!(
        texts(&report, "preferences"),
        [
            "oak against elm: nobody leans either way (0 answers against 0, 18 without preference), so no test has anything to \
          work on."
        ]
    );
}

#[test]
fn no_effect_is_open_and_says_what_remains_possible() {
    // Nine people always left, nine always right: no net, and wide intervals.
    let said = said(18, |participant, _| if participant % 2 == 0 { Left } else { Right });
    let found = of(&said, "preferences", "The body-centred lattice and the simple cubic lattice are not");
    assert_eq!(
        found.text,
        "The body-centred lattice and the simple cubic lattice are not distinguished: 81 answers against 81, none without \
         preference; 50 % (24 to 76 %), adjusted p = 1."
    );
    assert_eq!(found.standing, Standing::Open);
}

#[test]
fn small_differences_are_equal_within_the_margin() {
    // Everybody splits each contrast as evenly as nine questions allow: +1 for half the people, -1 for the other half.
    let said = said(18, |p, q| if (q + q / 9 + p) % 2 == 0 { Left } else { Right });
    let found =
        of(&said, "preferences", "The body-centred lattice and the simple cubic lattice are liked alike");
    assert_eq!(found.standing, Standing::Equal);
    assert!(found.text.contains("within the margin of 0.2: 81 answers against 81"), "{}", found.text);
}

#[test]
fn equal_counts_stand_as_in_the_table() {
    // Elm, the second, is ahead by a little: of forty answers, twelve people give 18 for oak, eight 22.
    let one = |p: usize| {
        (0..40).map(move |q| (p, 0, 1, if q < if p < 12 { 18 } else { 22 } { Left } else { Right }))
    };
    let report = report_of("Trees", &groups(&(0..20).flat_map(one).collect::<Vec<_>>()));
    let text = &texts(&report, "preferences")[0];
    assert!(
        text.contains(
            "elm and oak are liked alike, within the margin of 0.2: 408 answers against 392, none without preference;"
        ) && text.contains("without preference; 51 % (49 to 53 %)"),
        "{text}"
    );
}

#[test]
fn levels_of_a_scale_are_told_by_their_names() {
    let study = fixture::study();
    let answered = fixture::answered(&study);
    let inputs = of_answers(&study, &answered);
    let results = Results::of(&inputs);
    let text = super::report(&results, &crate::tables(&results), &[], Vec::new()).to_markdown();
    assert!(text.contains("Integrated clustering stands highest.") && !text.contains(" I stands"), "{text}");
    assert!(text.contains("si stands highest, and is not shown to differ from bi and bp."), "{text}");
}

#[test]
fn too_few_people_are_told_what_they_could_have_shown() {
    let said = said(3, |_, _| Left);
    let found = of(&said, "preferences", "9 of 9 comparisons within one level each are not decided: ");
    assert_eq!(found.standing, Standing::TooFew);
    assert!(
        found.text.ends_with(
            "At most 3 participants lean one way or the other, and no outcome of fewer than 6 is significant."
        ),
        "{}",
        found.text
    );
    // A few are told one by one.
    let answers: Vec<_> = (0..3).map(|person| (person, 0, 1, Left)).collect();
    let report = report_of("Trees", &groups(&answers));
    assert_eq!(
        texts(&report, "preferences"),
        [
            "oak against elm is not decided: 3 answers against 0, none without preference. No outcome of so few people who lean \
             one way or the other is significant (smallest possible p = 0.25)."
        ]
    );
}

#[test]
fn answers_without_a_study() {
    // Ten people, oak over elm over ash but for one who never chooses; sides exchanged for half of them.
    let mut answers = Vec::new();
    for person in 0..10 {
        for (a, b) in [(0, 1), (1, 2), (0, 2)] {
            let chosen = if person == 9 { Tie } else { Left };
            answers.push(match person % 2 {
                0 => (person, a, b, chosen),
                _ => (person, b, a, chosen.swapped()),
            });
        }
    }
    let report = report_of("Trees", &groups(&answers));
    assert_eq!(report.lead[0], "10 participants gave 30 answers to 3 questions.");
    assert_eq!(
        texts(&report, "preferences")[0],
        "oak was preferred to elm: 9 answers against 0, 1 without preference; 95 % (84 to 100 %), adjusted p = 0.012."
    );
    // Pairs in both orders: the side can be asked about; but the answers separate the items, so nothing is estimated.
    let side = "Over all questions 15 answers went left, 12 right and 3 to neither.";
    assert!(texts(&report, "bearing").iter().any(|text| text == side));
    assert!(report.to_markdown().starts_with("# Trees\n\n- **Compared:** 3 items: ash, elm and oak.\n"));
    let titled = report_of("<b> [x](y) *\n# z", &groups(&answers));
    assert!(
        titled.to_markdown().starts_with("# &lt;b> \\[x\\](y) \\* # z\n\n- **Compared:**"),
        "a title is no mark-up"
    );
}

#[test]
fn names_of_items_stay_as_they_are() {
    // Two items that differ in their first letter's case alone.
    let answers: Vec<_> = (0..8).map(|person| (person, 0, 1, Left)).collect();
    let mut groups = groups(&answers);
    groups[0].items = ["\u{e9}clair", "\u{c9}clair"].map(String::from).into();
    let report = report_of("Cakes", &groups);
    let text = &texts(&report, "preferences")[0];
    assert!(text.starts_with("\u{e9}clair was preferred to \u{c9}clair: 8 answers against 0"), "{text}");
}

#[test]
fn no_answers_at_all() {
    let report = report_of("Nothing", &[]);
    assert_eq!(report.lead, ["No answers were given, so nothing is said about preference."]);
    assert!(report.sections.is_empty());
    let mut answers = Responses { items: vec!["oak".into()], ..Responses::default() };
    answers.questions.push(Question::new("C1", "garden", "trees", [0, 0]));
    answers.answers = (0..2).map(|person| Answer::new(person, 0, [0, 0], Choice::Left)).collect();
    let preferences = Preferences::without_study(&answers, &[], None);
    let report = report_of_groups("Controls", &preferences, &[], &[]);
    assert_eq!(
        report.lead,
        [
            "Only controls were answered, which show an item beside itself: 2 answers. So nothing is said about preference."
        ]
    );
    let small = fixture::small_study();
    let inputs = Inputs {
        study: &small,
        meshes: &[],
        bench: None,
        chunks: &[],
        stored: &[],
        answers: None,
        left_out: &[],
    };
    let results = Results::of(&inputs);
    let report = super::report(&results, &crate::tables(&results), &[], Vec::new());
    assert_eq!(report.sections.iter().map(|s| s.id).collect::<Vec<_>>(), ["tables"]);
}

/// Forty people, oak over elm on one object and elm over oak on the other.
fn opposite_on_two_objects() -> Vec<BallotGroup> {
    let ballot =
        |person: usize, question: usize, outcome| ShownBallot::new(person, question, [0, 1], outcome);
    let both = (0..40).flat_map(|person| [ballot(person, 0, Left), ballot(person, 1, Right)]);
    // Two people are of another mind on one of them, so that scores differ.
    let ballots = both
        .map(|b| if b.participant() < 2 && b.question() == 0 { ballot(b.participant(), 0, Tie) } else { b });
    vec![BallotGroup {
        name: "trees".into(),
        items: ["oak", "elm"].map(String::from).into(),
        ballots: ballots.collect(),
        objects: ["garden", "street"].map(String::from).into(),
    }]
}

#[test]
fn opposite_preferences_are_not_liked_alike_without_a_study_either() {
    let groups = opposite_on_two_objects();
    let report = report_of("Trees", &groups);
    // 38 people score 0 and two -1/2: the mean is -0.025.
    let all = texts(&report, "preferences").join("\n");
    assert!(!all.contains("are liked alike, ") && all.contains("It depends on the object"), "{all}");
    let starts = [
        "How much elm is preferred to oak differs. On garden: 0 answers against 38, 2 without preference. On street: 40 answers \
         against 0",
        "oak was preferred to elm on garden",
        "elm was preferred to oak on street",
    ];
    let preferences = texts(&report, "preferences");
    for start in starts {
        assert!(preferences.iter().any(|text| text.starts_with(start)), "{preferences:#?}");
    }
    let tested = hypotheses::of_groups(&groups);
    let table = crate::tables::contrasts::tests(&tested, &hypotheses::Robustness::of(&tested));
    let rows: Vec<String> = table.shown_rows().iter().map(|row| row[..3].join(" ")).collect();
    let want = [
        "trees oak-elm all",
        "trees on objects oak-elm garden",
        "trees on objects oak-elm street",
        "trees between objects oak-elm garden \u{2212} street",
    ];
    assert_eq!(rows.iter().map(|row| row.replace(" - ", " \u{2212} ")).collect::<Vec<_>>(), want);
}

#[test]
fn items_that_differ_by_rounding_stand_alike() {
    // Everybody takes the left, and every pair is shown in both orders: nothing differs.
    let answers: Vec<_> = (0..12)
        .flat_map(|person| [(0, 1), (1, 2), (0, 2)].map(|pair| (person, pair)))
        .flat_map(|(person, (a, b))| [(person, a, b, Left), (person, b, a, Left)])
        .collect();
    let report = report_of("Trees", &groups(&answers));
    let worths = texts(&report, "worths").join("\n");
    assert!(worths.contains("no difference was shown") && !worths.contains("highest"), "{worths}");
}

#[test]
fn a_liking_for_a_side_is_no_equality() {
    // Forty people give as many answers for the one as for the other; ten of them are once undecided, so that somebody leans. Some
    // press what stands on the left, others choose twice by what is shown and twice against it.
    let people = |chosen: [Outcome; 4]| {
        let mut answers = Vec::new();
        for person in 0..40 {
            for (question, (a, b)) in [(0, 1), (1, 0), (0, 1), (1, 0)].into_iter().enumerate() {
                let is_undecided = person % 4 == 0 && question == person / 4 % 4;
                answers.push((person, a, b, if is_undecided { Tie } else { chosen[question] }));
            }
        }
        groups(&answers)
    };
    let of_items = report_of("Trees", &people([Left, Right, Right, Left]));
    let holds = texts(&of_items, "preferences").join("\n");
    assert!(holds.contains("liked alike, within the margin"), "{holds}");
    let of_sides = report_of("Trees", &people([Left; 4]));
    let open = texts(&of_sides, "preferences").join("\n");
    assert!(!open.contains("are liked alike, within"));
    assert!(
        open.contains("The mean lies within the margin") && open.contains("People favour a side"),
        "{open}"
    );
    let found = of_sides.summary.iter().find(|line| line.label == "Found").unwrap();
    assert!(found.text.contains("People favour a side"), "{}", found.text);
}

#[test]
fn who_is_left_out_is_left_out_everywhere() {
    let mut study = fixture::study();
    study.file.analysis.exclude = vec![isostudy_design::config::Exclusion::Outlying];
    let answered = Answered::of(&study, fixture::answers(&study)).unwrap();
    let inputs = of_answers(&study, &answered);
    let results = Results::of(&inputs);
    let (tables, figures) = (crate::tables(&results), crate::figures(&results).unwrap());
    let named = |name: &str| tables.iter().find(|table| table.name == name).unwrap();
    let columns: Vec<&str> = named("answers").columns.iter().map(|column| column.name.as_str()).collect();
    assert!(columns.len() == 18 && !columns.contains(&"respondent_16"), "{columns:?}");
    assert_eq!(named("respondents").rows.len(), 18);
    let answers = figures.iter().find(|figure| figure.name == "answers").unwrap();
    assert!(answers.caption.starts_with("Answers of 17 participants"), "{}", answers.caption);
    let text = report(&results, &tables, &figures, Vec::new()).to_markdown();
    for wrong in ["nobody is left out", "Nobody is left out", "is with everybody", "18 participants gave"] {
        assert!(!text.contains(wrong), "{wrong}");
    }
    assert!(text.contains("17 participants gave 459 answers"), "{text}");
    // A rule that takes everybody.
    study.file.analysis.exclude = vec![isostudy_design::config::Exclusion::Time];
    let mut hasty = fixture::answers(&study);
    hasty.answers.iter_mut().for_each(|answer| answer.rt_ms = Some(10.0));
    let answered = Answered::of(&study, hasty).unwrap();
    let inputs = of_answers(&study, &answered);
    let results = Results::of(&inputs);
    let lead = report(&results, &crate::tables(&results), &[], Vec::new()).lead;
    assert_eq!(
        lead,
        [
            "Nothing is said about preference: 18 participants answered, and all broke a rule whose breakers the study leaves out."
        ]
    );
}

fn found(report: &Report) -> &str {
    &report.summary.iter().find(|line| line.label == "Found").unwrap().text
}

/// Twelve answers of each person: every pair of trees in both orders, twice.
fn twelve(
    people: std::ops::Range<usize>,
    answer: fn(usize, usize) -> Outcome,
) -> Vec<(usize, usize, usize, Outcome)> {
    let pairs = [(0, 1), (1, 2), (0, 2), (0, 1), (1, 2), (0, 2)];
    let both = |person| pairs.into_iter().flat_map(move |(a, b)| [(person, a, b), (person, b, a)]);
    people.flat_map(both).map(|(person, a, b)| (person, a, b, answer(a, b))).collect()
}

#[test]
fn nobody_left_is_no_comparison() {
    let report = report_of("Trees", &groups(&twelve(0..6, |_, _| Left)));
    let said = found(&report);
    assert!(
        said.contains("All 6 people broke a rule of screening, so that nobody is left to compare them with.")
            && !said.contains("Without"),
        "{said}"
    );
    let checks = texts(&report, "bearing").join("\n");
    assert!(
        checks.contains("Nobody is left without them, so nothing is compared.")
            && !checks.contains("decided otherwise"),
        "{checks}"
    );
}

#[test]
fn two_people_are_both_and_one_is_one() {
    let said = |people| found(&report_of("Trees", &groups(&twelve(0..people, |_, _| Left)))).to_owned();
    let two = said(2);
    assert!(two.contains("Both people broke a rule of screening, so that nobody is left"), "{two}");
    let one = said(1);
    assert!(one.contains("All 1 person broke a rule of screening, so that nobody is left"), "{one}");
}

#[test]
fn equal_pairs_are_told_apart_from_each_other() {
    // On each pair of trees ten people give nineteen of forty answers for the first, and ten twenty-one.
    let pairs = [(0, 1), (1, 2), (0, 2)];
    let of = |person: usize| {
        let first = if person < 10 { 19 } else { 21 };
        let half = move |place: usize| if place < first { Left } else { Right };
        pairs.into_iter().flat_map(move |(a, b)| (0..40).map(move |place| (person, a, b, half(place))))
    };
    let said = found(&report_of("Trees", &groups(&(0..20).flat_map(of).collect::<Vec<_>>()))).to_owned();
    let equal = "Within the margin people like these alike: oak and elm; oak and ash; elm and ash.";
    assert!(said.contains(equal) && !said.contains("No preference"), "{said}");
}

#[test]
fn what_turns_round_is_not_what_fewer_people_leave_undecided() {
    // Who looks prefers the elm; forty press the left, where the oak stands most often.
    let mut answers: Vec<_> =
        (0..8).flat_map(|person| vec![(person, 0, 1, Right), (person, 1, 0, Left)]).collect();
    for person in 8..48 {
        answers.extend((0..11).map(|_| (person, 0, 1, Left)));
        answers.push((person, 1, 0, Left));
    }
    let report = report_of("Trees", &groups(&answers));
    let said = found(&report);
    assert!(
        said.contains(
            "40 of 48 people broke a rule of screening. Without them, 1 of 1 contrast holds in the other direction."
        ),
        "{said}"
    );
    // Here everybody agrees, and six of the twelve are not needed for what they say.
    let mut answers = twelve(0..4, |a, b| if a < b { Left } else { Right });
    for person in 4..10 {
        answers.extend((0..11).map(|_| (person, 0, 1, Left)));
        answers.push((person, 1, 0, Left));
    }
    let report = report_of("Trees", &groups(&answers));
    let said = found(&report);
    assert!(
        said.contains(
            "6 of 10 people broke a rule of screening. Without them, 1 of 3 contrasts becomes undecided with fewer people."
        ),
        "{said}"
    );
    let checks = texts(&report, "bearing").join("\n");
    assert!(checks.contains("1 of 3 tests is decided otherwise. Undecided with fewer people: "), "{checks}");
}

#[test]
fn orders_that_few_saw_are_counted_and_not_denied() {
    let report = report_of("Trees", &groups(&twelve(0..3, |a, b| if a < b { Left } else { Right })));
    let text = report.to_markdown();
    assert!(!text.contains("no pair was") && !text.contains("No pair was"), "{text}");
    let checks = texts(&report, "bearing").join("\n");
    assert!(
        checks.contains(
            "because 3 pairs in both orders were seen by 3 people, and fewer than four tell no spread"
        ),
        "{checks}"
    );
    assert!(text.contains("Sides: 3 of 3 pairs were shown in both orders."), "{text}");
}

#[test]
fn answers_that_all_agree_name_nobody_and_say_why() {
    let agreeing = |choice: fn(usize, usize) -> Outcome| {
        let groups = groups(&twelve(0..6, choice));
        found(&report_of("Trees", &groups)).to_owned()
    };
    let why = "The most liked is not named, because some items never won against the others and nothing bounds the worths.";
    let always = agreeing(|a, b| if a < b { Left } else { Right });
    assert!(always.contains(why), "{always}");
    // Whoever stands left wins as often as not: there is a scale.
    let sides = agreeing(|_, _| Left);
    assert!(!sides.contains(why), "{sides}");
}

#[test]
fn the_main_finding_is_one_sentence() {
    let groups = groups(&twelve(0..12, |a, b| if a < b { Left } else { Right }));
    let answers = responses(&groups);
    let preferences = Preferences::without_study(&answers, &groups, None);
    let told = found_in_groups(&preferences).unwrap();
    assert!(told.starts_with("People preferred ") && told.ends_with('.'), "{told}");
    assert!(!told.trim_end_matches('.').contains(". "), "{told}");
}

/// Every pair stood on one side alone, and everybody pressed right, beside two of the same too: what is said first is the side.
#[test]
fn where_the_side_may_have_made_everything_it_is_told_first() {
    let asked = [(0, 0), (0, 1), (1, 2), (0, 2), (1, 1)];
    let of_person = |person| {
        let places = asked.into_iter().enumerate();
        places.map(move |(question, (left, right))| ShownBallot::new(person, question, [left, right], Right))
    };
    let mut groups = groups(&[]);
    groups[0].ballots = (0..12).flat_map(of_person).collect();
    let report = report_of("Trees", &groups);
    let said = found(&report);
    assert!(said.starts_with("People favour a side"), "{said}");
}

/// Five people who mostly agree would pass a test by the spread between them; no outcome of five is significant.
#[test]
fn five_people_show_no_difference_on_a_scale() {
    let mostly = |people| {
        let mut answers = twelve(0..people, |left, right| if left < right { Left } else { Right });
        // Upsets bound the worths; people have different numbers of them, so that there is a spread.
        for person in 0..people {
            for place in 0..=person % 3 {
                let of = &mut answers[12 * person + (5 * place + 7 * person) % 12];
                of.3 = if of.3 == Left { Right } else { Left };
            }
        }
        found(&report_of("Trees", &groups(&answers))).to_owned()
    };
    assert!(!mostly(5).contains("On one scale"), "{}", mostly(5));
    assert!(mostly(20).contains("On one scale"), "{}", mostly(20));
}
