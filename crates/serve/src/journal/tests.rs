use super::*;
use tempfile::tempdir;

fn file(forms: usize) -> FormFile {
    let form = |form| FormEntry {
        form,
        training: vec!["tani".into()],
        questions: vec![format!("a{form}"), format!("b{form}"), format!("c{form}")],
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

fn answer(order: u32, stimulus: &str, choice: Choice) -> Answer {
    Answer { order, stimulus: stimulus.into(), choice, rt_ms: 1200 }
}

#[test]
fn answers_survive_and_repeats_change_nothing() {
    let folder = tempdir().unwrap();
    let mut journal = Journal::open(folder.path(), &file(2), "d").unwrap();
    let dealt = journal.begin(nobody(), 1).unwrap().unwrap();
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

    let mut journal = Journal::open(folder.path(), &file(2), "d").unwrap();
    assert_eq!(journal.given().unwrap(), before);
    assert_eq!(before.iter().map(|given| given.answer.choice).collect::<Vec<_>>(), [Choice::L, Choice::Np]);
    assert!(before.iter().all(|given| given.participant == dealt.participant && given.form == 1));
    assert_eq!(journal.answer(&token, &answer(4, "c1", Choice::R), 4).unwrap(), Ok(()));
    assert_eq!(journal.finish(&token, 5).unwrap(), Ok(()));
    let summary = journal.summary(6).unwrap();
    assert_eq!((summary.started, summary.finished, summary.answering, summary.answers), (1, 1, 0, 3));
    assert_eq!(summary.places, [(2, 1, 1200.0), (3, 1, 1200.0), (4, 1, 1200.0)]);
}

const LATE: u32 = crate::record::LONGEST_MS + 1;

#[test]
fn forms_are_dealt_evenly_even_when_people_give_up() {
    let folder = tempdir().unwrap();
    let mut journal = Journal::open(folder.path(), &file(5), "d").unwrap();
    let mut dealt = [0_u32; 5];
    for n in 0..23 {
        dealt[journal.begin(nobody(), n).unwrap().unwrap().form.form - 1] += 1;
        assert!(dealt.iter().max().unwrap() - dealt.iter().min().unwrap() <= 1);
    }
    // All but two of form 4 give up; hours later its share is dealt to others first.
    let hours = 3 * GIVEN_UP_MS;
    for person in journal.people.iter_mut().filter(|person| person.form != 4) {
        person.last_ms = hours;
    }
    let form = |journal: &mut Journal| journal.begin(nobody(), hours + 1).unwrap().unwrap().form.form;
    assert_eq!((form(&mut journal), form(&mut journal), form(&mut journal)), (4, 4, 4));
    let summary = journal.summary(hours + 2).unwrap();
    assert_eq!(summary.forms[3], [4, 3, 0]);
}

#[test]
fn a_panels_people_come_back_and_are_kept_apart() {
    let folder = tempdir().unwrap();
    let mut journal = Journal::open(folder.path(), &file(3), "d").unwrap();
    let first = journal.begin(of_panel("s1"), 1).unwrap().unwrap();
    journal.answer(&first.token, &answer(2, "a1", Choice::R), 2).unwrap().unwrap();
    let again = journal.begin(of_panel("s1"), 3).unwrap().unwrap();
    assert_eq!((&again.token, again.answered), (&first.token, 1));
    assert_ne!(journal.begin(of_panel("s2"), 4).unwrap().unwrap().token, first.token);
    for bad in ["", "a b", "x'; DROP TABLE answers", &"x".repeat(65)] {
        assert_eq!(
            journal.begin(of_panel(bad), 5).unwrap(),
            Err(Refusal::BadIdentifier("SESSION_ID")),
            "{bad}"
        );
    }
    drop(journal);
    let mut journal = Journal::open(folder.path(), &file(3), "d").unwrap();
    assert_eq!(journal.begin(of_panel("s1"), 6).unwrap().unwrap().token, first.token);
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

/// Answers in the same batch as one that fails are not acknowledged and not there; later ones are.
#[test]
fn a_failed_batch_leaves_nothing_behind() {
    let folder = tempdir().unwrap();
    let (handle, keeper) = start(Journal::open(folder.path(), &file(1), "d").unwrap());
    let runtime = tokio::runtime::Builder::new_current_thread().build().unwrap();
    let dealt = runtime.block_on(handle.change(|journal| journal.begin(nobody(), 1))).unwrap().unwrap();
    let token = dealt.token.clone();
    let fails = handle.change(move |journal| -> rusqlite::Result<()> {
        journal.answer(&token, &answer(2, "a1", Choice::L), 2)?.unwrap();
        Err(rusqlite::Error::InvalidQuery)
    });
    assert_eq!(runtime.block_on(fails), Err(Unsaved));
    assert_eq!(runtime.block_on(handle.change(|journal| journal.given())).unwrap(), []);
    let token = dealt.token;
    let kept = handle.change(move |journal| journal.answer(&token, &answer(2, "a1", Choice::R), 3));
    assert_eq!(runtime.block_on(kept), Ok(Ok(())));
    drop(handle);
    keeper.join().unwrap();
    let journal = Journal::open(folder.path(), &file(1), "d").unwrap();
    assert_eq!(journal.given().unwrap()[0].answer.choice, Choice::R);
}
