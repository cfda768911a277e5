mod people;

use super::*;
use tempfile::tempdir;

fn file(forms: usize) -> FormFile {
    let form = |form| FormEntry {
        form,
        training: vec!["tani".into()],
        questions: ["a", "b", "c"].map(|letter| format!("{letter}{form}")).into(),
    };
    FormFile { forms: (1..=forms).map(form).collect(), ..crate::export::tests::empty_file() }
}

fn nobody() -> Identifiers {
    Identifiers::default()
}

/// As long as a panel's identifiers are, so that no token has it by chance.
const PANELS_STUDY: &str = "61a0c5d2e8f4b7a9c3d1e6f2";

fn of_panel(session: &str) -> Identifiers {
    let of = |text: &str| Some(text.to_owned());
    Identifiers { prolific_pid: of("5f9"), study_id: of(PANELS_STUDY), session_id: of(session) }
}

/// A first answer, after which somebody is on disk.
fn first_answer(journal: &mut Journal, dealt: &Dealt, now_ms: i64) {
    let first = answer(2, &dealt.form.questions[0], Choice::R);
    assert_eq!(journal.answer(&dealt.token, &first, now_ms).unwrap(), Ok(()));
}

fn answer(order: u32, stimulus: &str, choice: Choice) -> Answer {
    Answer { order, stimulus: stimulus.into(), choice, rt_ms: 1200, screen: None, change: 0 }
}

#[test]
fn answers_survive_and_repeats_change_nothing() {
    let folder = tempdir().unwrap();
    let mut journal = Journal::open(folder.path(), &file(1), "d", Loss::Refuse).unwrap();
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

    let mut journal = Journal::open(folder.path(), &file(1), "d", Loss::Refuse).unwrap();
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
fn key(forms: usize) -> Vec<isostudy_design::forms::KeyEntry> {
    let line = |(form, place): (usize, usize)| isostudy_design::forms::KeyEntry {
        form,
        order: place + 2,
        stimulus: format!("{}{form}", ["a", "b", "c"][place]),
        role: isostudy_design::forms::Role::Comparison,
        question: ["Q10", "Q2", "Q3"][(place + form - 1) % 3].into(),
        object: String::new(),
        group: String::new(),
        left: String::new(),
        right: String::new(),
        shown: String::new(),
    };
    (1..=forms).flat_map(|form| (0..3).map(move |place| (form, place))).map(line).collect()
}

/// Two people asked in different orders: the medians are of questions, not of places.
#[test]
fn times_are_told_by_question() {
    let folder = tempdir().unwrap();
    let mut journal = Journal::open(folder.path(), &file(2), "d", Loss::Refuse).unwrap();
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

const LATE: u32 = crate::screen::LONGEST_MS + 1;

#[test]
fn forms_are_dealt_evenly_even_when_people_give_up() {
    let folder = tempdir().unwrap();
    let mut journal = Journal::open(folder.path(), &file(5), "d", Loss::Refuse).unwrap();
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
    let mut journal = Journal::open(folder.path(), &file(3), "d", Loss::Refuse).unwrap();
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
    let mut journal = Journal::open(folder.path(), &file(3), "d", Loss::Refuse).unwrap();
    assert_eq!(journal.begin(of_panel("s1"), 6).unwrap().token, first.token);
    assert_eq!(journal.identities().unwrap().len(), 2);
    drop(journal);
    let bytes = std::fs::read(folder.path().join("answers.sqlite")).unwrap();
    assert!(
        !bytes.windows(PANELS_STUDY.len()).any(|window| window == PANELS_STUDY.as_bytes()),
        "identifiers are in a file of their own"
    );
}

#[test]
fn one_process_and_one_study_at_a_time() {
    let folder = tempdir().unwrap();
    let journal = Journal::open(folder.path(), &file(1), "d", Loss::Refuse).unwrap();
    assert!(matches!(
        Journal::open(folder.path(), &file(1), "d", Loss::Refuse),
        Err(JournalError::InUse { .. })
    ));
    drop(journal);
    assert!(matches!(
        Journal::open(folder.path(), &file(1), "e", Loss::Refuse),
        Err(JournalError::OtherStudy { .. })
    ));
}

/// Forms are numbered in the order of a study file's Latin square; who was dealt which must not tell who came first.
#[test]
fn forms_do_not_tell_who_came_when() {
    let first = || {
        let folder = tempdir().unwrap();
        let mut journal = Journal::open(folder.path(), &file(50), "d", Loss::Refuse).unwrap();
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
    let mut journal = Journal::open(folder.path(), &file(3), "d", Loss::Refuse).unwrap();
    let early = journal.begin(nobody(), 0).unwrap();
    for now in 0..12_000 {
        journal.begin(nobody(), now).unwrap();
    }
    assert!(journal.people.is_empty());
    first_answer(&mut journal, &early, 12_000);
    assert_eq!(journal.people.len(), 1, "whoever came first is not forgotten for those who came later");
    let dealt = journal.begin(of_panel("s1"), 30_001).unwrap();
    assert_eq!(journal.finish(&dealt.token, 30_002).unwrap(), Err(Refusal::Unfinished(3)));
    let wrong = answer(2, "x", Choice::L);
    assert_eq!(journal.answer(&dealt.token, &wrong, 30_002).unwrap(), Err(Refusal::OtherStimulus(2)));
    assert!(journal.people.len() == 1 && journal.identities().unwrap().is_empty());
    first_answer(&mut journal, &dealt, 30_003);
    assert_eq!((journal.people.len(), journal.given().unwrap().len()), (2, 2));
    assert_eq!(journal.state(&dealt.token).unwrap().answered, 1);
}

/// The digest is of the forms whatever their number, so more may be planned while people answer, and not fewer than were dealt.
#[test]
fn more_participants_may_be_planned_later() {
    let folder = tempdir().unwrap();
    let mut journal = Journal::open(folder.path(), &file(3), "d", Loss::Refuse).unwrap();
    for now in 0..3 {
        let dealt = journal.begin(nobody(), now).unwrap();
        first_answer(&mut journal, &dealt, now);
    }
    drop(journal);
    let mut journal = Journal::open(folder.path(), &file(5), "d", Loss::Refuse).unwrap();
    assert_eq!(journal.given().unwrap().len(), 3);
    assert!(journal.begin(nobody(), 4).unwrap().form.form > 3);
    drop(journal);
    let fewer = Journal::open(folder.path(), &file(2), "d", Loss::Refuse).map(|_| ()).unwrap_err();
    assert!(matches!(fewer, JournalError::FewerForms { form: 3, planned: 2, .. }), "{fewer}");
}

/// What a server leaves behind that is killed after so many people gave one answer each; every second is of a panel.
fn killed(people: usize) -> tempfile::TempDir {
    let folder = tempdir().unwrap();
    let (handle, keeper) = start(Journal::open(folder.path(), &file(1), "d", Loss::Refuse).unwrap());
    let runtime = tokio::runtime::Builder::new_current_thread().build().unwrap();
    for person in 0..people {
        let change = handle.change(move |journal| {
            let identifiers = if person % 2 == 0 { nobody() } else { of_panel(&format!("s{person}")) };
            let dealt = journal.begin(identifiers, 1).unwrap();
            journal.answer(&dealt.token, &answer(2, "a1", Choice::L), 2)
        });
        runtime.block_on(change).unwrap().unwrap();
    }
    let image = tempdir().unwrap();
    for entry in std::fs::read_dir(folder.path()).unwrap() {
        let path = entry.unwrap().path();
        std::fs::copy(&path, image.path().join(path.file_name().unwrap())).unwrap();
    }
    drop(handle);
    keeper.join().unwrap();
    image
}

#[test]
fn answers_can_be_read_while_a_server_has_them_and_by_nobody_else() {
    use std::os::unix::fs::PermissionsExt;
    let above = tempdir().unwrap();
    let folder = above.path().join("answers/trial");
    let mut journal = Journal::open(&folder, &file(1), "d", Loss::Refuse).unwrap();
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
    let (handle, keeper) = start(Journal::open(folder.path(), &file(1), "d", Loss::Refuse).unwrap());
    let runtime = tokio::runtime::Builder::new_current_thread().build().unwrap();
    let dealt =
        runtime.block_on(handle.change(|journal| Ok(journal.begin(of_panel("s"), 1)))).unwrap().unwrap();
    let token = dealt.token.clone();
    let fails = handle.change(move |journal| -> rusqlite::Result<()> {
        journal.answer(&token, &answer(2, "a1", Choice::L), 2)?.unwrap();
        Err(rusqlite::Error::InvalidQuery)
    });
    assert_eq!(runtime.block_on(fails), Err(Unsaved::Disk));
    assert_eq!(runtime.block_on(handle.change(|journal| journal.given())).unwrap(), []);
    let known = runtime.block_on(handle.change(|journal| journal.identities())).unwrap();
    assert_eq!(known, [], "nobody's identifiers are kept without an answer");
    let again = runtime.block_on(handle.change(|journal| Ok(journal.begin(of_panel("s"), 1)))).unwrap();
    assert_eq!(again.unwrap().token, dealt.token, "whoever sent it is still known");
    let token = dealt.token;
    let kept = handle.change(move |journal| journal.answer(&token, &answer(2, "a1", Choice::R), 3));
    assert_eq!(runtime.block_on(kept), Ok(Ok(())));
    drop(handle);
    keeper.join().unwrap();
    let journal = Journal::open(folder.path(), &file(1), "d", Loss::Refuse).unwrap();
    assert_eq!(journal.given().unwrap()[0].answer.choice, Choice::R);
}

/// SQLite starts without a word on a database whose log was removed or cut.
#[test]
fn lost_answers_are_noticed_at_the_start() {
    type Damage = fn(&Path);
    let damages: [(&str, Damage); 7] = [
        ("log removed", |folder| std::fs::remove_file(folder.join("answers.sqlite-wal")).unwrap()),
        ("log cut in half", |folder| {
            let log =
                std::fs::OpenOptions::new().write(true).open(folder.join("answers.sqlite-wal")).unwrap();
            log.set_len(log.metadata().unwrap().len() / 2).unwrap();
        }),
        ("log overwritten", |folder| {
            let mut log = std::fs::read(folder.join("answers.sqlite-wal")).unwrap();
            let middle = log.len() / 2;
            log[middle..middle + 64].fill(b'x');
            std::fs::write(folder.join("answers.sqlite-wal"), log).unwrap();
        }),
        ("database removed", |folder| std::fs::remove_file(folder.join("answers.sqlite")).unwrap()),
        ("database emptied", |folder| std::fs::write(folder.join("answers.sqlite"), "").unwrap()),
        ("identities removed", |folder| {
            std::fs::remove_file(folder.join("identities.sqlite")).unwrap();
            std::fs::remove_file(folder.join("identities.sqlite-wal")).unwrap();
        }),
        ("count overwritten", |folder| std::fs::write(folder.join("count"), "many").unwrap()),
    ];
    let open = |folder: &Path, loss| Journal::open(folder, &file(1), "d", loss);
    let whole = killed(30);
    assert_eq!(
        open(whole.path(), Loss::Refuse).unwrap().held(),
        Held { answers: 30, participants: 30, identities: 15 }
    );
    for (what, damage) in damages {
        let folder = killed(30);
        damage(folder.path());
        let log = || std::fs::read(folder.path().join("answers.sqlite-wal")).unwrap_or_default();
        let before = log();
        for _ in 0..2 {
            let refused = open(folder.path(), Loss::Refuse).map(|journal| journal.held()).unwrap_err();
            assert!(
                matches!(refused, JournalError::Lost { .. } | JournalError::Damaged { .. }),
                "{what}: {refused}"
            );
            assert!(refused.to_string().contains("--accept-loss"), "{what}: {refused}");
        }
        assert!(before.is_empty() || log() == before, "{what}: the log is left as it is");
        let held = open(folder.path(), Loss::Accept).unwrap().held();
        assert_eq!(
            open(folder.path(), Loss::Refuse).unwrap().held(),
            held,
            "{what}: what is left is counted anew"
        );
    }
}

/// A folder from before there was a count, and one whose server was killed before it wrote it.
#[test]
fn more_than_was_counted_is_no_loss() {
    let folder = killed(3);
    std::fs::remove_file(folder.path().join("count")).unwrap();
    assert_eq!(Journal::open(folder.path(), &file(1), "d", Loss::Refuse).unwrap().held().answers, 3);
    let mut seal = seal::Seal::open(&System, folder.path()).unwrap();
    seal.write(Held { answers: 2, participants: 2, identities: 0 }).unwrap();
    assert_eq!(Journal::open(folder.path(), &file(1), "d", Loss::Refuse).unwrap().held().answers, 3);
}

/// A kill between the two commits leaves identifiers without an answer.
#[test]
fn identifiers_without_an_answer_are_removed() {
    let folder = killed(4);
    let add = || {
        let database = Connection::open(folder.path().join("identities.sqlite")).unwrap();
        database.execute("INSERT INTO identities VALUES ('f00', '5f9', ?1, 's9')", [PANELS_STUDY]).unwrap();
    };
    let known = |loss| {
        let journal = Journal::open(folder.path(), &file(1), "d", loss).unwrap();
        journal.identities().unwrap().len()
    };
    add();
    assert_eq!(known(Loss::Refuse), 2);
    add();
    std::fs::remove_file(folder.path().join("answers.sqlite")).unwrap();
    assert_eq!(known(Loss::Accept), 3, "after a loss they are all that is left of somebody");
}

/// Removed, put back, and replaced by a copy while the server runs.
#[test]
fn a_folder_that_is_gone_takes_no_answers() {
    let above = tempdir().unwrap();
    let [folder, aside] = ["answers", "aside"].map(|name| above.path().join(name));
    let (handle, keeper) = start(Journal::open(&folder, &file(1), "d", Loss::Refuse).unwrap());
    let runtime = tokio::runtime::Builder::new_current_thread().build().unwrap();
    let look = || runtime.block_on(handle.change(|journal| journal.given().map(|given| given.len())));
    assert_eq!(look(), Ok(0));
    std::fs::rename(&folder, &aside).unwrap();
    assert_eq!(look(), Err(Unsaved::Missing));
    std::fs::rename(&aside, &folder).unwrap();
    assert_eq!(look(), Ok(0));
    for name in ["answers.sqlite", "answers.sqlite-wal", "identities.sqlite", "identities.sqlite-wal", "lock"]
    {
        let [there, gone] = [folder.join(name), above.path().join("gone")];
        std::fs::rename(&there, &gone).unwrap();
        assert_eq!(look(), Err(Unsaved::Missing), "{name} removed");
        std::fs::copy(&gone, &there).unwrap();
        assert_eq!(look(), Err(Unsaved::Missing), "{name} replaced");
        std::fs::rename(&gone, &there).unwrap();
        assert_eq!(look(), Ok(0), "{name} back");
    }
    drop(handle);
    keeper.join().unwrap();
}

#[test]
fn whoever_waits_for_the_threads_end_learns_of_it() {
    let folder = tempdir().unwrap();
    let (handle, mut keeper) = start(Journal::open(folder.path(), &file(1), "d", Loss::Refuse).unwrap());
    let runtime = tokio::runtime::Builder::new_current_thread().build().unwrap();
    let wrong = handle.change(|_| -> rusqlite::Result<()> { panic!("as this test wants") });
    assert_eq!(runtime.block_on(wrong), Err(Unsaved::Disk));
    runtime.block_on(keeper.ended());
    assert!(matches!(keeper.join(), Err(JournalError::Ended)));
}

/// Where nothing can be written SQLite reads no log; root can write everywhere, so the copy is looked at by itself too.
#[test]
fn answers_are_read_where_nothing_can_be_written() {
    use std::os::unix::fs::PermissionsExt;
    let folder = killed(5);
    std::fs::remove_file(folder.path().join("answers.sqlite-shm")).unwrap();
    let copied = copy::Copied::of(&System, folder.path(), &[files::ANSWERS]).unwrap();
    let path = copied.folder().to_owned();
    assert_eq!(kept(&path, "trial").unwrap().given.len(), 5, "the log is copied too");
    assert!(!path.join("identities.sqlite").exists());
    drop(copied);
    assert!(!path.exists());

    let mode = |path: &Path, mode| std::fs::set_permissions(path, PermissionsExt::from_mode(mode)).unwrap();
    let paths: Vec<PathBuf> =
        std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.iter().for_each(|path| mode(path, 0o400));
    mode(folder.path(), 0o500);
    let found = kept(folder.path(), "trial").map(|kept| kept.given.len());
    mode(folder.path(), 0o700);
    assert_eq!(found.unwrap(), 5);
}

/// Every file of a folder, by name, to the byte.
fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<_> = entries
        .map(|path| (path.file_name().unwrap().to_string_lossy().into_owned(), std::fs::read(&path).unwrap()))
        .collect();
    files.sort();
    files
}

/// What is left may be all that can be saved.
#[test]
fn a_refused_start_leaves_every_file_as_it_is() {
    let overwrite = |folder: &Path, name: &str| {
        let mut bytes = std::fs::read(folder.join(name)).unwrap();
        let middle = bytes.len() / 2;
        bytes[middle..middle + 64].fill(b'x');
        std::fs::write(folder.join(name), bytes).unwrap();
    };
    let remove = |folder: &Path, names: &[&str]| {
        names.iter().for_each(|name| drop(std::fs::remove_file(folder.join(name))));
    };
    for what in
        ["log damaged", "log gone", "identities gone", "database gone", "shared memory gone", "other study"]
    {
        let folder = killed(30);
        let folder = folder.path();
        let mut digest = "d";
        match what {
            "log damaged" => overwrite(folder, "answers.sqlite-wal"),
            "log gone" => remove(folder, &["answers.sqlite-wal", "answers.sqlite-shm"]),
            "identities gone" => {
                remove(folder, &["identities.sqlite", "identities.sqlite-wal", "identities.sqlite-shm"]);
            }
            "database gone" => remove(folder, &["answers.sqlite", "answers.sqlite-shm"]),
            "shared memory gone" => {
                overwrite(folder, "answers.sqlite-wal");
                remove(folder, &["answers.sqlite-shm", "identities.sqlite-shm"]);
            }
            _ => {
                digest = "e";
                remove(folder, &["count"]);
            }
        }
        let before = contents(folder);
        for _ in 0..2 {
            assert!(Journal::open(folder, &file(1), digest, Loss::Refuse).is_err(), "{what}");
            let after = contents(folder);
            let names = |files: &[(String, Vec<u8>)]| {
                files.iter().map(|(name, bytes)| format!("{name} {}", bytes.len())).collect::<Vec<_>>()
            };
            assert_eq!(names(&after), names(&before), "{what}");
            assert!(after == before, "{what}: bytes differ");
        }
    }
}

/// The researcher's way to the answers stays open; whoever answers is told that nothing is saved.
#[test]
fn answers_are_read_while_their_folder_is_gone() {
    for gone in ["", "identities.sqlite", "count"] {
        let above = tempdir().unwrap();
        let folder = above.path().join("answers");
        let (handle, keeper) = start(Journal::open(&folder, &file(1), "d", Loss::Refuse).unwrap());
        let runtime = tokio::runtime::Builder::new_current_thread().build().unwrap();
        let answered = handle.change(|journal| {
            let dealt = journal.begin(of_panel("s1"), 1).unwrap();
            journal.answer(&dealt.token, &answer(2, "a1", Choice::L), 2)
        });
        runtime.block_on(answered).unwrap().unwrap();
        if gone.is_empty() {
            std::fs::remove_dir_all(&folder).unwrap();
        } else {
            std::fs::remove_file(folder.join(gone)).unwrap();
        }
        let begun = runtime.block_on(handle.change(|journal| Ok(journal.begin(nobody(), 3))));
        assert_eq!(begun.map(drop), Err(Unsaved::Missing), "{gone}");
        assert_eq!(runtime.block_on(handle.read(|journal| journal.given())).unwrap().len(), 1, "{gone}");
        assert_eq!(runtime.block_on(handle.read(|journal| journal.identities())).unwrap().len(), 1, "{gone}");
        drop(handle);
        let ended = keeper.join().unwrap_err();
        assert!(matches!(ended, JournalError::Gone { .. }), "{gone}: {ended}");
    }
}

#[test]
fn answers_without_a_count_are_told() {
    let uncounted =
        |folder: &Path| Journal::open(folder, &file(1), "d", Loss::Refuse).unwrap().is_uncounted();
    assert!(!uncounted(tempdir().unwrap().path()), "nothing is there yet");
    let folder = killed(3);
    assert!(!uncounted(folder.path()));
    std::fs::remove_file(folder.path().join("count")).unwrap();
    assert!(uncounted(folder.path()));
    assert!(!uncounted(folder.path()), "it was written anew");
}

/// A pipe would be waited for without end.
#[test]
fn what_is_no_file_is_refused() {
    for name in ["count", "lock", "answers.sqlite", "answers.sqlite-wal", "identities.sqlite"] {
        for kind in ["fifo", "device"] {
            let folder = tempdir().unwrap();
            let path = folder.path().join(name);
            if kind == "fifo" {
                assert!(std::process::Command::new("mkfifo").arg(&path).status().unwrap().success());
            } else {
                std::os::unix::fs::symlink("/dev/null", &path).unwrap();
            }
            let (say, said) = std::sync::mpsc::channel();
            let opened = folder.path().to_owned();
            std::thread::spawn(move || {
                let opened = Journal::open(&opened, &file(1), "d", Loss::Refuse);
                drop(say.send(opened.map(drop).map_err(|error| error.to_string())));
            });
            let said = said.recv_timeout(std::time::Duration::from_secs(10)).expect("it does not wait");
            let expected = format!("{}: not a file", path.display());
            assert_eq!(said, Err(expected), "{name} {kind}");
        }
    }
    let folder = tempdir().unwrap();
    let path = folder.path().join("answers");
    std::fs::write(&path, "").unwrap();
    let said = Journal::open(&path, &file(1), "d", Loss::Refuse).map(drop).unwrap_err().to_string();
    assert_eq!(said, format!("{}: not a folder", path.display()));
}

#[test]
fn a_folder_from_before_screens_were_kept_is_read_and_written_to() {
    use crate::screen::{Input, Layout, Screen, ShownAs};
    let screen = Screen {
        viewport_width: 390,
        viewport_height: 844,
        pixel_ratio: 2.625,
        surface_px: 266,
        layout: Layout::Stacked,
        input: Input::Touch,
        dropped: 2,
        hidden_ms: 70,
        shown_as: ShownAs::Gif,
        turned_deg: None,
    };
    let folder = tempdir().unwrap();
    let mut journal = Journal::open(folder.path(), &file(1), "d", Loss::Refuse).unwrap();
    let dealt = journal.begin(nobody(), 1).unwrap();
    first_answer(&mut journal, &dealt, 2);
    drop(journal);
    let database = rusqlite::Connection::open(folder.path().join("answers.sqlite")).unwrap();
    database.execute_batch("DROP TABLE screens").unwrap();
    drop(database);

    assert_eq!(kept(folder.path(), "trial").unwrap().given[0].answer.screen, None);
    let mut journal = Journal::open(folder.path(), &file(1), "d", Loss::Refuse).unwrap();
    let next = Answer { screen: Some(screen), ..answer(3, "b1", Choice::L) };
    for _ in 0..2 {
        assert_eq!(journal.answer(&dealt.token, &next, 3).unwrap(), Ok(()));
    }
    drop(journal);
    let kept = kept(folder.path(), "trial").unwrap().given;
    assert_eq!(kept.iter().map(|given| given.answer.screen).collect::<Vec<_>>(), [None, Some(screen)]);
}

impl Journal {
    /// Merges logs into their databases after so many pages, in place of 1000.
    pub(crate) fn merge_log_after(&self, pages: u32) {
        for database in [&self.answers, &self.identities] {
            database.pragma_update(None, "wal_autocheckpoint", pages).unwrap();
        }
    }
}

/// What was chosen for somebody outlives the server, and is gone with the person. Nothing is chosen again for who is there.
#[test]
fn what_was_chosen_stays_with_the_person_and_goes_with_the_person() {
    let folder = tempdir().unwrap();
    let open = || Journal::open(folder.path(), &file(1), "d", Loss::Refuse).unwrap();
    // As many have begun as its words say.
    let chooser = || {
        let choose = |others: &[Asked<'_>], planned: &FormEntry, before: usize| {
            let answered: usize = others.iter().map(|(_, choices)| choices.len()).sum();
            let questions = ["x", "y", "z"].map(|letter| format!("{letter}{before}{answered}")).into();
            FormEntry { questions, ..planned.clone() }
        };
        Chooser(Arc::new(choose))
    };
    let mut journal = open();
    journal.choose_by(chooser());
    let first = journal.begin(nobody(), 1).unwrap();
    assert_eq!(
        (&first.form.questions[..], &first.form.training[..]),
        (&["x00", "y00", "z00"].map(String::from)[..], &["tani".to_owned()][..])
    );
    // What the form plans is no question of this person.
    let planned = answer(2, "a1", Choice::L);
    assert_eq!(journal.answer(&first.token, &planned, 2).unwrap(), Err(Refusal::OtherStimulus(2)));
    first_answer(&mut journal, &first, 2);
    let second = journal.begin(nobody(), 3).unwrap();
    assert_eq!(second.form.questions[0], "x11");
    first_answer(&mut journal, &second, 4);
    drop(journal);

    let mut journal = open();
    assert_eq!(journal.state(&first.token).unwrap().form, first.form);
    assert_eq!(journal.state(&second.token).unwrap().form, second.form);
    let next = answer(3, "y00", Choice::Np);
    assert_eq!(journal.answer(&first.token, &next, 5).unwrap(), Ok(()));
    assert_eq!(journal.withdraw(&first.token[..16]).unwrap(), Ok(()));
    let left: Vec<String> = journal
        .answers
        .prepare("SELECT questions FROM chosen")
        .unwrap()
        .query_map([], |row| row.get(0))
        .unwrap()
        .collect::<rusqlite::Result<_>>()
        .unwrap();
    assert_eq!(left, [r#"["x11","y11","z11"]"#]);
    assert_eq!(journal.state(&second.token).unwrap().form, second.form);
}
