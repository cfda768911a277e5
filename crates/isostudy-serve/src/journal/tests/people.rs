//! What people say of themselves, how many the study takes, and what is left of those who leave.

use super::*;
use crate::cameras::Track;
use isostudy_design::config::AboutTime;
use isostudy_design::forms::{AboutEntry, Answers, Quotas};

/// A study that asks for a job and an age, and lets people go back.
fn asking(forms: usize) -> FormFile {
    let question = |id: &str, answers: Answers, screens_out: Vec<u32>| AboutEntry {
        id: id.into(),
        text: format!("about_{id}"),
        answers,
        when: AboutTime::Before,
        optional: false,
        screens_out,
    };
    FormFile {
        about: vec![
            question("job", Answers::Options { count: 3, several: false }, vec![3]),
            question("age", Answers::Number { from: 0.0, to: 120.0 }, Vec::new()),
        ],
        languages: vec!["en".into(), "de".into()],
        go_back: true,
        ..file(forms)
    }
}

fn open(folder: &Path, file: &FormFile) -> Journal {
    Journal::open(folder, file, "d", Loss::Refuse).unwrap()
}

fn about(journal: &mut Journal, dealt: &Dealt, id: &str, value: &str) -> Result<Taken, Refusal> {
    journal.about(&dealt.token, id, value, 1).unwrap()
}

#[test]
fn what_people_say_of_themselves_is_on_disk_with_the_first_answer_and_apart_from_answers() {
    let folder = tempdir().unwrap();
    let mut journal = open(folder.path(), &asking(1));
    let dealt = journal.begin_in(Some("de".into()), nobody(), 1).unwrap();
    assert_eq!(about(&mut journal, &dealt, "job", "2"), Ok(Taken::Kept));
    assert_eq!(about(&mut journal, &dealt, "job", "1"), Ok(Taken::Kept));
    assert_eq!(about(&mut journal, &dealt, "age", "31.5"), Ok(Taken::Kept));
    assert_eq!(about(&mut journal, &dealt, "job", "4"), Err(Refusal::NoSuchValue));
    assert_eq!(about(&mut journal, &dealt, "name", "1"), Err(Refusal::UnknownQuestion));
    assert_eq!(journal.all_about().unwrap().len(), 0, "who only looks leaves nothing");
    first_answer(&mut journal, &dealt, 2);
    let said: About = [("age", "31.5"), ("job", "1")].map(|(id, value)| (id.into(), value.into())).into();
    assert_eq!(journal.all_about().unwrap(), [(dealt.participant.clone(), said.clone())].into());
    assert_eq!(about(&mut journal, &dealt, "job", ""), Ok(Taken::Kept), "rather not say, later");
    drop(journal);
    let journal = open(folder.path(), &asking(1));
    let kept = &journal.all_about().unwrap()[&dealt.participant];
    assert_eq!((kept["job"].as_str(), kept["age"].as_str()), ("", "31.5"));
    assert_eq!(journal.languages().unwrap()[&dealt.participant], "de");
    drop(journal);
    let answers = std::fs::read(folder.path().join("answers.sqlite")).unwrap();
    assert!(!holds(&answers, "31.5"), "apart from answers");
    let kept = kept_of(folder.path());
    assert_eq!(kept.about[&dealt.participant]["age"], "31.5");
    assert_eq!(kept.languages[&dealt.participant], "de");
}

fn kept_of(folder: &Path) -> Kept {
    kept(folder, "trial").unwrap()
}

#[test]
fn who_is_screened_out_leaves_a_number_alone() {
    let folder = tempdir().unwrap();
    let mut journal = open(folder.path(), &asking(1));
    let dealt = journal.begin(of_panel("s1"), 1).unwrap();
    assert_eq!(about(&mut journal, &dealt, "job", "3"), Ok(Taken::ScreenedOut));
    assert_eq!(journal.state(&dealt.token), Err(Refusal::UnknownToken));
    assert_eq!(journal.departures().unwrap(), Departures { screened_out: 1, ..Departures::default() });
    assert_eq!((journal.held(), journal.identities().unwrap().len()), (Held::default(), 0));
}

#[test]
fn quotas_count_who_has_finished_and_who_is_answering_and_close_the_study() {
    let folder = tempdir().unwrap();
    let mut journal = open(folder.path(), &asking(2));
    journal.limit(Quotas { per_form: None, options: vec![("job".into(), vec![2, 1, 1])] });
    let come = |journal: &mut Journal, value: &str, now_ms: i64| {
        let dealt = journal.begin(nobody(), now_ms).unwrap();
        (journal.about(&dealt.token, "job", value, now_ms).unwrap(), dealt)
    };
    let (taken, first) = come(&mut journal, "1", 1);
    assert_eq!(taken, Ok(Taken::Kept));
    // Whoever says the same again is counted once.
    assert_eq!(journal.about(&first.token, "job", "1", 1).unwrap(), Ok(Taken::Kept));
    first_answer(&mut journal, &first, 1);
    assert_eq!(come(&mut journal, "1", 2).0, Ok(Taken::Kept));
    assert_eq!(come(&mut journal, "1", 3).0, Ok(Taken::Full));
    assert_eq!(come(&mut journal, "2", 3).0, Ok(Taken::Kept));
    assert_eq!(journal.departures().unwrap().full, 1);
    // Two hours later those who were silent have given up.
    let later = GIVEN_UP_MS + 2;
    assert_eq!(come(&mut journal, "1", later).0, Ok(Taken::Kept));
    assert_eq!(come(&mut journal, "1", later).0, Ok(Taken::Kept));
    assert_eq!(come(&mut journal, "1", later).0, Ok(Taken::Full));
    // "3" is not asked; it has to be full before the study closes.
    assert_eq!(come(&mut journal, "2", later).0, Ok(Taken::Full), "who said 2 is there for a moment more");
    journal.limit(Quotas { per_form: None, options: vec![("job".into(), vec![2, 1])] });
    assert_eq!(journal.begin(nobody(), later).unwrap_err(), Refusal::Full);
}

#[test]
fn a_form_is_dealt_so_often_and_no_more() {
    let folder = tempdir().unwrap();
    let mut journal = open(folder.path(), &asking(2));
    journal.limit(Quotas { per_form: Some(2), options: Vec::new() });
    let dealt: Vec<Dealt> = (0..4).map(|now| journal.begin(nobody(), now).unwrap()).collect();
    for form in 1..=2 {
        assert_eq!(dealt.iter().filter(|one| one.form.form == form).count(), 2);
    }
    assert_eq!(journal.begin(nobody(), 5), Err(Refusal::Full));
    // A place is free again when somebody has given up or withdrawn.
    assert_eq!(journal.withdraw(&dealt[0].token[..16]).unwrap(), Ok(()));
    assert_eq!(journal.begin(nobody(), 5).unwrap().form.form, dealt[0].form.form);
    assert_eq!(journal.begin(nobody(), 5), Err(Refusal::Full));
}

#[test]
fn the_last_answer_may_be_changed_and_nothing_late_undoes_it() {
    let folder = tempdir().unwrap();
    let mut journal = open(folder.path(), &asking(1));
    let dealt = journal.begin(nobody(), 1).unwrap();
    let mut send = |order: u32, stimulus: &str, choice: Choice, change: u32| {
        let answer = Answer { change, ..answer(order, stimulus, choice) };
        journal.answer(&dealt.token, &answer, 2).unwrap()
    };
    assert_eq!(send(2, "a1", Choice::L, 0), Ok(()));
    assert_eq!(send(2, "a1", Choice::R, 1), Ok(()));
    assert_eq!(send(2, "a1", Choice::Np, 2), Ok(()));
    // Sent once more, and the first ones late.
    assert_eq!(send(2, "a1", Choice::Np, 2), Ok(()));
    assert_eq!(send(2, "a1", Choice::R, 1), Ok(()));
    assert_eq!(send(2, "a1", Choice::L, 0), Ok(()));
    assert_eq!(send(2, "a1", Choice::L, 2), Err(Refusal::Answered(2)), "one change has one answer");
    // The next one arrives changed before it arrived at all.
    assert_eq!(send(3, "b1", Choice::R, 1), Ok(()));
    assert_eq!(send(3, "b1", Choice::L, 0), Ok(()));
    assert_eq!(send(2, "a1", Choice::L, 3), Err(Refusal::Answered(2)), "the last answer alone");
    assert_eq!(send(4, "c1", Choice::L, 0), Ok(()));
    journal.finish(&dealt.token, 3).unwrap().unwrap();
    let late = Answer { change: 1, ..answer(4, "c1", Choice::R) };
    assert_eq!(journal.answer(&dealt.token, &late, 4).unwrap(), Err(Refusal::Answered(4)), "it is over");
    let given = journal.given().unwrap();
    let found: Vec<(Choice, u32)> = given.iter().map(|one| (one.answer.choice, one.answer.change)).collect();
    assert_eq!(found, [(Choice::Np, 2), (Choice::R, 1), (Choice::L, 0)]);
    drop(journal);
    assert_eq!(open(folder.path(), &asking(1)).given().unwrap(), given);
    // Where nobody may go back, nothing changes.
    let folder = tempdir().unwrap();
    let mut journal = open(folder.path(), &file(1));
    let dealt = journal.begin(nobody(), 1).unwrap();
    first_answer(&mut journal, &dealt, 1);
    let change = Answer { change: 1, ..answer(2, "a1", Choice::L) };
    assert_eq!(journal.answer(&dealt.token, &change, 2).unwrap(), Err(Refusal::Answered(2)));
}

/// Two cameras, the second of which at a time.
fn turned(t_ms: i32) -> Track {
    Track { hz: 20.0, cameras: vec![0, 450, 222, 1000, t_ms, 525, 222, 1000] }
}

/// Cameras belong to one answer: there is none before it, and none of an older one after it was changed.
#[test]
fn cameras_stand_beside_the_answer_that_they_belong_to() {
    let folder = tempdir().unwrap();
    let asked = FormFile { go_back: true, ..asking(1) };
    let mut journal = open(folder.path(), &asked);
    let dealt = journal.begin(nobody(), 1).unwrap();
    let unknown = journal.track("nobody", 2, 0, &turned(1)).unwrap();
    assert_eq!(unknown, Err(Refusal::UnknownToken));
    let early = Err(Refusal::OutOfOrder { given: 2, next: 2 });
    assert_eq!(journal.track(&dealt.token, 2, 0, &turned(1)).unwrap(), early);
    first_answer(&mut journal, &dealt, 1);
    assert_eq!(journal.track(&dealt.token, 1, 0, &turned(1)).unwrap(), Err(Refusal::UnknownPlace(1)));
    let early = Err(Refusal::OutOfOrder { given: 3, next: 3 });
    assert_eq!(journal.track(&dealt.token, 3, 0, &turned(1)).unwrap(), early);
    for _ in 0..2 {
        assert_eq!(journal.track(&dealt.token, 2, 0, &turned(700)).unwrap(), Ok(()));
    }
    let kept = |journal: &Journal| journal.cameras().unwrap();
    let of = kept(&journal);
    assert_eq!((of.len(), of[0].order, of[0].track.clone()), (1, 2, turned(700)));
    assert_eq!((of[0].participant.clone(), of[0].form), (dealt.participant.clone(), dealt.form.form));
    drop(journal);
    let mut journal = open(folder.path(), &asked);
    assert_eq!(kept(&journal), of);
    // Whoever goes back and answers otherwise looks again; what comes late is of the older answer.
    let change = Answer { change: 1, ..answer(2, &dealt.form.questions[0], Choice::Np) };
    assert_eq!(journal.answer(&dealt.token, &change, 2).unwrap(), Ok(()));
    assert_eq!(kept(&journal), []);
    assert_eq!(journal.track(&dealt.token, 2, 0, &turned(700)).unwrap(), Ok(()));
    assert_eq!(kept(&journal), []);
    assert_eq!(journal.track(&dealt.token, 2, 1, &turned(900)).unwrap(), Ok(()));
    assert_eq!(kept(&journal)[0].track, turned(900));
}

fn holds(bytes: &[u8], text: &str) -> bool {
    bytes.windows(text.len()).any(|window| window == text.as_bytes())
}

/// Whether a file of a folder holds a text.
fn is_left(folder: &Path, text: &str) -> Vec<PathBuf> {
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    files.filter(|path| holds(&std::fs::read(path).unwrap(), text)).collect()
}

/// Forty people answer; one of them has everything deleted, while the server runs and is not stopped.
#[test]
fn of_who_withdraws_nothing_is_left_in_any_file() {
    let folder = tempdir().unwrap();
    let (handle, keeper) = start(open(folder.path(), &asking(4)));
    let runtime = tokio::runtime::Builder::new_current_thread().build().unwrap();
    let screen = crate::screen::Screen {
        viewport_width: 31_415,
        viewport_height: 844,
        pixel_ratio: 2.0,
        surface_px: 266,
        layout: crate::screen::Layout::Stacked,
        input: crate::screen::Input::Touch,
        dropped: 0,
        hidden_ms: 0,
        shown_as: crate::screen::ShownAs::Gif,
        turned_deg: None,
    };
    let come = |session: &'static str, age: &'static str, width: u32| {
        let work = handle.change(move |journal| {
            let dealt = journal.begin_in(Some("de".into()), of_panel(session), 1).unwrap();
            journal.about(&dealt.token, "age", age, 1)?.unwrap();
            for (order, stimulus) in (2..).zip(&dealt.form.questions) {
                let screen = Some(crate::screen::Screen { viewport_width: width, ..screen });
                journal
                    .answer(&dealt.token, &Answer { screen, ..answer(order, stimulus, Choice::R) }, 2)?
                    .unwrap();
                journal.track(&dealt.token, order, 0, &turned(27_000_000 + width as i32))?.unwrap();
            }
            journal.about(&dealt.token, "age", age, 1)?.unwrap();
            Ok(dealt)
        });
        runtime.block_on(work).unwrap()
    };
    let others: Vec<Dealt> = ["a", "b", "c"].map(|session| come(session, "44", 1000)).into();
    let gone = come("session-of-who-left", "31.41592", 31_415);
    let more: Vec<Dealt> = ["d", "e"].map(|session| come(session, "45", 1000)).into();
    let traces =
        [gone.participant.as_str(), &gone.token, "session-of-who-left", "31.41592", "31415", "27031415"];
    for trace in traces {
        assert!(!is_left(folder.path(), trace).is_empty(), "{trace} was there");
    }
    let receipt = gone.token.as_bytes()[..16].chunks(4).map(|part| std::str::from_utf8(part).unwrap());
    let receipt = receipt.collect::<Vec<_>>().join(" - ").to_uppercase();
    assert_eq!(runtime.block_on(handle.change(move |journal| journal.withdraw(&receipt))).unwrap(), Ok(()));
    for trace in traces {
        assert_eq!(is_left(folder.path(), trace), [""; 0].map(PathBuf::from), "{trace} is there");
    }
    let again = gone.token[..16].to_owned();
    let again = runtime.block_on(handle.change(move |journal| journal.withdraw(&again))).unwrap();
    assert_eq!(again, Err(Refusal::UnknownToken));
    let token = gone.token.clone();
    assert_eq!(
        runtime.block_on(handle.change(move |j| Ok(j.state(&token)))).unwrap(),
        Err(Refusal::UnknownToken)
    );
    // Others are as they were, in memory and in every export, and one is counted.
    for other in others.iter().chain(&more) {
        let token = other.token.clone();
        let state =
            runtime.block_on(handle.change(move |journal| Ok(journal.state(&token)))).unwrap().unwrap();
        assert_eq!((&state.participant, state.answered), (&other.participant, 3));
    }
    let exports = runtime.block_on(handle.read(|journal| {
        Ok((
            journal.given()?,
            journal.identities()?,
            journal.all_about()?,
            journal.languages()?,
            journal.departures()?,
            journal.cameras()?,
        ))
    }));
    let (given, identities, about, languages, departures, cameras) = exports.unwrap();
    assert_eq!(cameras.len(), 15);
    assert_eq!((given.len(), identities.len(), about.len(), languages.len()), (15, 5, 5, 5));
    assert!(given.iter().all(|one| one.participant != gone.participant));
    assert_eq!(departures.withdrawn, 1);
    let text = crate::shown::json(&asking(4), "d", &given, &[], &languages, departures);
    assert!(!text.contains(&gone.participant) && text.contains("\"withdrawn\": 1"), "{text}");
    drop(handle);
    keeper.join().unwrap();
    // Whoever starts the server again misses nothing.
    let journal = open(folder.path(), &asking(4));
    assert_eq!(journal.held(), Held { answers: 15, participants: 5, identities: 5 });
}

/// Somebody reads an older state while answers are deleted: it is tried again until nothing is left.
#[test]
fn a_reader_delays_what_is_scrubbed_and_no_more() {
    let folder = tempdir().unwrap();
    let mut journal = open(folder.path(), &asking(1));
    let dealt = journal.begin(of_panel("session-of-who-left"), 1).unwrap();
    first_answer(&mut journal, &dealt, 1);
    let reader = Connection::open(folder.path().join("answers.sqlite")).unwrap();
    let moment = reader.unchecked_transaction().unwrap();
    let count: i64 = moment.query_row("SELECT count(*) FROM answers", [], |row| row.get(0)).unwrap();
    assert_eq!(count, 1);
    assert_eq!(journal.withdraw(&dealt.token[..16]).unwrap(), Ok(()));
    assert!(!journal.scrub().unwrap(), "the reader still sees it");
    drop(moment);
    drop(reader);
    assert!(journal.scrub().unwrap());
    for trace in [&dealt.participant, &dealt.token, "session-of-who-left"] {
        assert_eq!(is_left(folder.path(), trace), [""; 0].map(PathBuf::from), "{trace}");
    }
}

/// A server that is killed right after a deletion was committed: `count` says no more than is there, and the next start scrubs.
#[test]
fn what_was_deleted_is_not_taken_for_lost() {
    let folder = tempdir().unwrap();
    let mut journal = open(folder.path(), &asking(1));
    let dealt: Vec<Dealt> = ["s1", "s2"].map(|session| journal.begin(of_panel(session), 1).unwrap()).into();
    dealt.iter().for_each(|one| first_answer(&mut journal, one, 1));
    journal.seal().unwrap();
    journal.answers.execute_batch("BEGIN IMMEDIATE").unwrap();
    assert_eq!(journal.withdraw(&dealt[0].token[..16]).unwrap(), Ok(()));
    journal.seal_less().unwrap();
    let sealed = Sealed::read(&System, folder.path()).unwrap();
    assert_eq!(sealed, Sealed::Held(Held { answers: 1, participants: 1, identities: 1 }));
    journal.identities.execute_batch("COMMIT").unwrap();
    journal.answers.execute_batch("COMMIT").unwrap();
    // Killed here.
    std::mem::forget(journal.answers);
    std::mem::forget(journal.identities);
    drop(journal._lock);
    let journal = open(folder.path(), &asking(1));
    assert_eq!(journal.held(), Held { answers: 1, participants: 1, identities: 1 });
    drop(journal);
    assert_eq!(is_left(folder.path(), &dealt[0].participant), [""; 0].map(PathBuf::from));
}
