use super::*;
use tempfile::tempdir;

fn file(forms: usize) -> FormFile {
    let form = |form| FormEntry {
        form,
        training: vec!["tani".into()],
        questions: ["a", "b", "c"].map(|letter| format!("{letter}{form}")).into(),
    };
    FormFile {
        schema: 1,
        study: "trial".into(),
        title: "Trial".into(),
        prompt: "Which?".into(),
        choices: ["Left".into(), "None".into(), "Right".into()],
        consent: "Yes".into(),
        instructions: "Look".into(),
        loop_ms: 100,
        page_scale: 1,
        forms: (1..=forms).map(form).collect(),
    }
}

fn nobody() -> Identifiers {
    Identifiers::default()
}

fn of_panel(session: &str) -> Identifiers {
    let of = |text: &str| Some(text.to_owned());
    Identifiers { prolific_pid: of("5f9"), study_id: of("61a"), session_id: of(session) }
}

/// A first answer, after which somebody is on disk.
fn first_answer(journal: &mut Journal, dealt: &Dealt, now_ms: i64) {
    let first = answer(2, &dealt.form.questions[0], Choice::R);
    assert_eq!(journal.answer(&dealt.token, &first, now_ms).unwrap(), Ok(()));
}

fn answer(order: u32, stimulus: &str, choice: Choice) -> Answer {
    Answer { order, stimulus: stimulus.into(), choice, rt_ms: 1200 }
}

#[test]
fn answers_survive_and_repeats_change_nothing() {
    let folder = tempdir().unwrap();
    let mut journal = Journal::open(folder.path(), &file(1), "d").unwrap();
    let dealt = journal.begin(nobody(), 1).unwrap();
    assert_eq!((dealt.form.form, dealt.answered), (1, 0));
    let token = dealt.token.clone();
    let mut send = |answer: Answer| journal.answer(&token, &answer, 2).unwrap();
    assert_eq!(send(answer(3, "b1", Choice::L)), Err(Refusal::OutOfOrder { given: 3, next: 2 }));
    assert_eq!(send(answer(1, "tani", Choice::L)), Err(Refusal::UnknownPlace(1)));
    assert_eq!(send(answer(5, "x", Choice::L)), Err(Refusal::UnknownPlace(5)));
    assert_eq!(send(answer(2, "b1", Choice::L)), Err(Refusal::OtherStimulus(2)));
    let late = Answer { rt_ms: LATE, ..answer(2, "a1", Choice::L) };
    assert_eq!(send(late), Err(Refusal::TooLong));
    assert_eq!(send(answer(2, "a1", Choice::L)), Ok(()));
    assert_eq!(send(answer(2, "a1", Choice::L)), Ok(()));
    assert_eq!(send(answer(2, "a1", Choice::R)), Err(Refusal::Answered(2)));
    assert_eq!(send(answer(3, "b1", Choice::Np)), Ok(()));
    assert_eq!(journal.answer("f00", &answer(2, "a1", Choice::L), 2).unwrap(), Err(Refusal::UnknownToken));
    assert_eq!(journal.finish(&token, 3).unwrap(), Err(Refusal::Unfinished(1)));
    let before = journal.given().unwrap();
    drop(journal);

    let mut journal = Journal::open(folder.path(), &file(1), "d").unwrap();
    assert_eq!(journal.given().unwrap(), before);
    assert_eq!(journal.state(&token).unwrap(), Dealt { answered: 2, ..dealt.clone() });
    assert_eq!(journal.state("f00"), Err(Refusal::UnknownToken));
    assert_eq!(before.iter().map(|given| given.answer.choice).collect::<Vec<_>>(), [Choice::L, Choice::Np]);
    assert!(before.iter().all(|given| given.participant == dealt.participant && given.form == 1));
    assert_eq!(journal.answer(&token, &answer(4, "c1", Choice::R), 4).unwrap(), Ok(()));
    assert_eq!(journal.finish(&token, 5).unwrap(), Ok(()));
    let summary = journal.summary(6, &key(1)).unwrap();
    assert_eq!((summary.started, summary.finished, summary.answering, summary.answers), (1, 1, 0, 3));
    let each = |question: &str| (question.to_owned(), 1, 1200.0);
    assert_eq!(summary.questions, ["Q2", "Q3", "Q10"].map(each));
}

/// In every form Q10, Q2 and Q3, one place later in each.
fn key(forms: usize) -> Vec<design::forms::KeyEntry> {
    let line = |(form, place): (usize, usize)| design::forms::KeyEntry {
        form,
        order: place + 2,
        stimulus: format!("{}{form}", ["a", "b", "c"][place]),
        role: design::forms::Role::Comparison,
        question: ["Q10", "Q2", "Q3"][(place + form - 1) % 3].into(),
        object: String::new(),
        group: String::new(),
        left: String::new(),
        right: String::new(),
    };
    (1..=forms).flat_map(|form| (0..3).map(move |place| (form, place))).map(line).collect()
}

/// Two people asked in different orders: the medians are of questions, not of places.
#[test]
fn times_are_told_by_question() {
    let folder = tempdir().unwrap();
    let mut journal = Journal::open(folder.path(), &file(2), "d").unwrap();
    let key = key(2);
    for now in 0..2 {
        let dealt = journal.begin(nobody(), now).unwrap();
        for (order, stimulus) in (2..).zip(&dealt.form.questions) {
            let asked = key.iter().find(|line| line.stimulus == *stimulus).unwrap();
            let number: u32 = asked.question[1..].parse().unwrap();
            let given =
                Answer { rt_ms: 1000 * number + 100 * now as u32, ..answer(order, stimulus, Choice::L) };
            journal.answer(&dealt.token, &given, now).unwrap().unwrap();
        }
    }
    let of = |(question, median): (&str, f64)| (question.to_owned(), 2, median);
    let expected = [("Q2", 2050.0), ("Q3", 3050.0), ("Q10", 10050.0)].map(of);
    assert_eq!(journal.summary(2, &key).unwrap().questions, expected);
}

const LATE: u32 = crate::record::LONGEST_MS + 1;

#[test]
fn forms_are_dealt_evenly_even_when_people_give_up() {
    let folder = tempdir().unwrap();
    let mut journal = Journal::open(folder.path(), &file(5), "d").unwrap();
    let mut dealt = [0_u32; 5];
    for n in 0..23 {
        let one = journal.begin(nobody(), n).unwrap();
        dealt[one.form.form - 1] += 1;
        assert!(dealt.iter().max().unwrap() - dealt.iter().min().unwrap() <= 1);
        first_answer(&mut journal, &one, n);
    }
    // All of form 4 give up; hours later its share is dealt to others first.
    let hours = 3 * GIVEN_UP_MS;
    for person in journal.people.iter_mut().filter(|person| person.form != 4) {
        person.last_ms = hours;
    }
    let form = |journal: &mut Journal| journal.begin(nobody(), hours + 1).unwrap().form.form;
    let again: Vec<usize> = (0..15).map(|_| form(&mut journal)).collect();
    // The other forms have four or five each.
    assert_eq!(again[..4], [4, 4, 4, 4]);
    let forms = journal.summary(hours + 2, &[]).unwrap().forms;
    let live: Vec<usize> = forms.iter().map(|form| form[1]).collect();
    assert!(live.iter().max().unwrap() - live.iter().min().unwrap() <= 1, "{live:?}");
}

#[test]
fn a_panels_people_come_back_and_are_kept_apart() {
    let folder = tempdir().unwrap();
    let mut journal = Journal::open(folder.path(), &file(3), "d").unwrap();
    let first = journal.begin(of_panel("s1"), 1).unwrap();
    assert_eq!(journal.begin(of_panel("s1"), 1).unwrap(), first, "before the first answer too");
    first_answer(&mut journal, &first, 2);
    let again = journal.begin(of_panel("s1"), 3).unwrap();
    assert_eq!((&again.token, again.answered), (&first.token, 1));
    let second = journal.begin(of_panel("s2"), 4).unwrap();
    assert_ne!(second.token, first.token);
    assert_eq!(journal.identities().unwrap().len(), 1, "who has answered nothing is not written down");
    first_answer(&mut journal, &second, 5);
    for bad in ["", "a b", "x'; DROP TABLE answers", &"x".repeat(65)] {
        assert_eq!(journal.begin(of_panel(bad), 5), Err(Refusal::BadIdentifier("SESSION_ID")), "{bad}");
    }
    drop(journal);
    let mut journal = Journal::open(folder.path(), &file(3), "d").unwrap();
    assert_eq!(journal.begin(of_panel("s1"), 6).unwrap().token, first.token);
    assert_eq!(journal.identities().unwrap().len(), 2);
    drop(journal);
    let bytes = std::fs::read(folder.path().join("answers.sqlite")).unwrap();
    assert!(!bytes.windows(3).any(|window| window == b"61a"), "identifiers are in a file of their own");
}

#[test]
fn one_process_and_one_study_at_a_time() {
    let folder = tempdir().unwrap();
    let journal = Journal::open(folder.path(), &file(1), "d").unwrap();
    assert!(matches!(Journal::open(folder.path(), &file(1), "d"), Err(JournalError::InUse { .. })));
    drop(journal);
    assert!(matches!(Journal::open(folder.path(), &file(1), "e"), Err(JournalError::OtherStudy { .. })));
}

/// Forms are numbered in the order of a study file's Latin square; who was dealt which must not tell who came first.
#[test]
fn forms_do_not_tell_who_came_when() {
    let first = || {
        let folder = tempdir().unwrap();
        let mut journal = Journal::open(folder.path(), &file(50), "d").unwrap();
        (0..50).map(|now| journal.begin(nobody(), now).unwrap().form.form).collect::<Vec<_>>()
    };
    let (one, other) = (first(), first());
    let sorted = |forms: &[usize]| {
        let mut forms = forms.to_vec();
        forms.sort_unstable();
        forms
    };
    assert!(sorted(&one) == sorted(&other) && sorted(&one) == (1..=50).collect::<Vec<_>>());
    assert_ne!(one, other, "the same by chance once in 50! times");
}

#[test]
fn whoever_only_looks_leaves_nothing_and_takes_no_place() {
    let folder = tempdir().unwrap();
    let mut journal = Journal::open(folder.path(), &file(3), "d").unwrap();
    for now in 0..30_000 {
        journal.begin(nobody(), now).unwrap();
    }
    assert!(journal.waiting.iter().count() <= 10_000 && journal.people.is_empty());
    let dealt = journal.begin(of_panel("s1"), 30_001).unwrap();
    assert_eq!(journal.finish(&dealt.token, 30_002).unwrap(), Err(Refusal::Unfinished(3)));
    let wrong = answer(2, "x", Choice::L);
    assert_eq!(journal.answer(&dealt.token, &wrong, 30_002).unwrap(), Err(Refusal::OtherStimulus(2)));
    assert!(journal.people.is_empty() && journal.identities().unwrap().is_empty());
    first_answer(&mut journal, &dealt, 30_003);
    assert_eq!((journal.people.len(), journal.given().unwrap().len()), (1, 1));
    assert_eq!(journal.state(&dealt.token).unwrap().answered, 1);
}

/// The digest is of the forms whatever their number, so more may be planned while people answer, and not fewer than were dealt.
#[test]
fn more_participants_may_be_planned_later() {
    let folder = tempdir().unwrap();
    let mut journal = Journal::open(folder.path(), &file(3), "d").unwrap();
    for now in 0..3 {
        let dealt = journal.begin(nobody(), now).unwrap();
        first_answer(&mut journal, &dealt, now);
    }
    drop(journal);
    let mut journal = Journal::open(folder.path(), &file(5), "d").unwrap();
    assert_eq!(journal.given().unwrap().len(), 3);
    assert!(journal.begin(nobody(), 4).unwrap().form.form > 3);
    drop(journal);
    let fewer = Journal::open(folder.path(), &file(2), "d").map(|_| ()).unwrap_err();
    assert!(matches!(fewer, JournalError::FewerForms { form: 3, planned: 2, .. }), "{fewer}");
}

#[test]
fn answers_can_be_read_while_a_server_has_them_and_by_nobody_else() {
    use std::os::unix::fs::PermissionsExt;
    let above = tempdir().unwrap();
    let folder = above.path().join("answers/trial");
    let mut journal = Journal::open(&folder, &file(1), "d").unwrap();
    let dealt = journal.begin(of_panel("s1"), 1).unwrap();
    first_answer(&mut journal, &dealt, 2);
    let found = kept(&folder, "trial").unwrap();
    assert_eq!((found.digest.as_str(), found.given), ("d", journal.given().unwrap()));
    let second = answer(3, "b1", Choice::L);
    assert_eq!(journal.answer(&dealt.token, &second, 3).unwrap(), Ok(()));
    assert_eq!(kept(&folder, "trial").unwrap().given.len(), 2);
    assert!(matches!(kept(&folder, "other"), Err(JournalError::OtherStudy { .. })));
    let mode = |path: &Path| std::fs::metadata(path).unwrap().permissions().mode() & 0o777;
    assert_eq!((mode(&folder), mode(folder.parent().unwrap())), (0o700, 0o700));
    let mut names = Vec::new();
    for entry in std::fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        assert_eq!(mode(&path), 0o600, "{}", path.display());
        names.push(path.file_name().unwrap().to_string_lossy().into_owned());
    }
    assert!(names.iter().any(|name| name == "answers.sqlite-wal"), "{names:?}");
}

/// Answers in the same batch as one that fails are not acknowledged and not there; later ones are.
#[test]
fn a_failed_batch_leaves_nothing_behind() {
    let folder = tempdir().unwrap();
    let (handle, keeper) = start(Journal::open(folder.path(), &file(1), "d").unwrap());
    let runtime = tokio::runtime::Builder::new_current_thread().build().unwrap();
    let dealt =
        runtime.block_on(handle.change(|journal| Ok(journal.begin(of_panel("s"), 1)))).unwrap().unwrap();
    let token = dealt.token.clone();
    let fails = handle.change(move |journal| -> rusqlite::Result<()> {
        journal.answer(&token, &answer(2, "a1", Choice::L), 2)?.unwrap();
        Err(rusqlite::Error::InvalidQuery)
    });
    assert_eq!(runtime.block_on(fails), Err(Unsaved));
    assert_eq!(runtime.block_on(handle.change(|journal| journal.given())).unwrap(), []);
    let again = runtime.block_on(handle.change(|journal| Ok(journal.begin(of_panel("s"), 1)))).unwrap();
    assert_eq!(again.unwrap().token, dealt.token, "whoever sent it is still known");
    let token = dealt.token;
    let kept = handle.change(move |journal| journal.answer(&token, &answer(2, "a1", Choice::R), 3));
    assert_eq!(runtime.block_on(kept), Ok(Ok(())));
    drop(handle);
    keeper.join().unwrap();
    let journal = Journal::open(folder.path(), &file(1), "d").unwrap();
    assert_eq!(journal.given().unwrap()[0].answer.choice, Choice::R);
}
