//! Programs that do what they must not say so by name, and the next one runs.

use crate::programs::{ask, assert_gone, first_error, hurried, planted, request};
use isostudy_program::{End, Phase, Problem, ProgramError, Request, Samples, Worker};

fn at_start(plan: &str) -> ProgramError {
    Worker::start(&planted(plan)).expect_err("it was taken for ready")
}

#[test]
fn a_good_program_is_heard_in_full() {
    let mut worker = Worker::start(&planted("good")).expect("it is ready");
    let ready = worker.ready();
    assert_eq!((&*ready.name, &*ready.version, ready.note.as_deref()), ("planted", "1.0", Some("good")));
    for _ in 0..3 {
        let answer = ask(&mut worker).expect("an answer");
        assert_eq!(
            (answer.extraction_s, answer.callback_s, answer.peak_bytes),
            (Some(1e-6), Some(0.0), Some(1000))
        );
        assert_eq!((answer.vertices, answer.triangles), (3, 1));
        assert_eq!(answer.mesh.expect("a mesh").triangles, [[0, 1, 2]]);
        let memory = answer.memory.expect("this system has /proc");
        // A Python interpreter needs more than a megabyte and less than the limit.
        assert!(memory.resident_bytes > 1 << 20 && memory.peak_bytes >= memory.resident_bytes);
        assert!(memory.peak_bytes < 200 << 20, "{memory:?}");
        let timed = worker.extract(&request()).expect("an answer without a mesh");
        assert!(timed.mesh.is_none() && timed.triangles == 1);
    }
    worker.finish().expect("it ends with its input");
}

#[test]
fn slow_pieces_and_left_out_numbers_are_no_defects() {
    for plan in ["slow-start", "piecewise"] {
        let mut worker = Worker::start(&planted(plan)).expect("it is ready");
        ask(&mut worker).expect(plan);
        worker.finish().expect(plan);
    }
    let answer = ask(&mut Worker::start(&planted("no-seconds")).expect("it is ready")).expect("an answer");
    assert_eq!((answer.extraction_s, answer.callback_s, answer.peak_bytes), (None, None, None));
}

#[test]
fn a_program_that_cannot_start_is_quoted() {
    let error = at_start("fail-at-start");
    let expected = "No module named 'nowhere'";
    assert!(
        matches!(&*error.problem, Problem::Failed { phase: Phase::Start, words } if words == expected),
        "{error}"
    );
    let error = at_start("crash-at-start");
    assert!(
        matches!(*error.problem, Problem::Ended { phase: Phase::Start, end: End::Code(1), .. }),
        "{error}"
    );
    assert_eq!(error.stderr, "a last word");
    assert!(error.to_string().contains("a last word"), "{error}");
    for (plan, words) in [("no-version", "missing field `version`"), ("no-name", "must not be empty")] {
        let error = at_start(plan);
        assert!(matches!(*error.problem, Problem::Line { phase: Phase::Start, .. }), "{error}");
        assert!(error.to_string().contains(words), "{error}");
    }
}

#[test]
fn the_end_of_much_noise_is_kept_and_no_more() {
    let error = at_start("noisy");
    assert!(error.stderr.ends_with("the very last words"), "{}", error.stderr);
    assert!(error.stderr.starts_with("a line of noise\n"), "whole lines");
    assert!(error.stderr.len() <= 4096 && error.stderr.len() > 3500, "{}", error.stderr.len());
}

#[test]
fn hangs_end_with_the_time_limit() {
    let error = Worker::start(&hurried("hang-at-start")).expect_err("it was taken for ready");
    assert!(matches!(*error.problem, Problem::TimeLimit { phase: Phase::Start, .. }), "{error}");
    let (error, worker) = first_error(&hurried("hang"));
    assert!(matches!(*error.problem, Problem::TimeLimit { phase: Phase::Request(1), .. }), "{error}");
    assert_gone(worker);
    // One that never reads its input hangs too, however much is written to it.
    let mut worker = Worker::start(&hurried("never-read")).expect("it is ready");
    let error = worker.extract(&request()).expect_err("an answer was accepted");
    assert!(matches!(*error.problem, Problem::TimeLimit { phase: Phase::Request(1), .. }), "{error}");
    assert_gone(worker);
}

#[test]
fn crashes_tell_code_or_signal() {
    let (error, worker) = first_error(&planted("crash"));
    assert!(
        matches!(*error.problem, Problem::Ended { phase: Phase::Request(1), end: End::Code(3), .. }),
        "{error}"
    );
    assert_eq!(error.stderr, "words before the end");
    assert_gone(worker);
    let (error, worker) = first_error(&planted("signal"));
    assert!(matches!(*error.problem, Problem::Ended { end: End::Signal(11), .. }), "{error}");
    assert_gone(worker);
    let (error, worker) = first_error(&planted("cut-line"));
    let expected = r#"{"id": 1, "extrac"#;
    assert!(
        matches!(&*error.problem, Problem::Ended { end: End::Code(0), rest, .. } if rest == expected),
        "{error}"
    );
    assert_gone(worker);
    let (error, worker) = first_error(&planted("close"));
    assert!(matches!(*error.problem, Problem::Ended { end: End::NotYet, .. }), "{error}");
    assert_gone(worker);
}

#[test]
fn what_a_program_says_it_cannot_do_is_no_reason_to_stop_it() {
    let (error, mut worker) = first_error(&planted("fail-once"));
    assert!(
        matches!(&*error.problem, Problem::Failed { phase: Phase::Request(1), words } if words == "out of luck")
    );
    assert!(worker.is_running());
    assert_eq!(ask(&mut worker).expect("the second request is answered").triangles, 1);
    worker.finish().expect("it ends with its input");
}

#[test]
fn lines_that_are_no_answers_are_quoted() {
    for (plan, quote) in [
        ("garbage", "Extracting 1 of 1 ... done"),
        ("list", "[1, 2]"),
        ("no-id", "missing field `id`"),
        ("other-key", "unknown field `extraction_sec`, expected one of"),
        ("negative-bytes", "-1"),
        ("nan-seconds", "NaN"),
    ] {
        let (error, worker) = first_error(&planted(plan));
        assert!(matches!(*error.problem, Problem::Line { phase: Phase::Request(1), .. }), "{plan}: {error}");
        assert!(error.to_string().contains(quote), "{plan}: {error}");
        assert_gone(worker);
    }
}

#[test]
fn seconds_that_cannot_be_are_refused() {
    for (plan, expected, seconds) in [
        ("negative-seconds", "extraction_s", -0.001),
        ("zero-seconds", "extraction_s", 0.0),
        ("milliseconds", "extraction_s", 20.0),
        // Each of them fits, both do not.
        ("both-seconds", "callback_s", 0.5),
    ] {
        let (error, worker) = first_error(&planted(plan));
        let found = matches!(*error.problem, Problem::Seconds { key, value, .. } if key == expected && value == seconds);
        assert!(found, "{plan}: {error}");
        assert_gone(worker);
    }
}

#[test]
fn long_lines_are_cut_off() {
    for plan in ["huge-line", "no-line"] {
        let (error, worker) = first_error(&planted(plan));
        assert!(
            matches!(&*error.problem, Problem::LineTooLong { start, .. } if start.len() == 100),
            "{plan}: {error}"
        );
        assert!(error.to_string().len() < 1000);
        assert_gone(worker);
    }
}

#[test]
fn answers_to_other_requests_are_refused() {
    let (error, worker) = first_error(&planted("other-id"));
    assert!(matches!(*error.problem, Problem::WrongId { phase: Phase::Request(1), got: 7 }), "{error}");
    assert_gone(worker);
}

#[test]
fn a_second_answer_is_found_at_the_next_request_or_at_the_end() {
    // Either it is there before the next request is made, or it is taken for an answer to that one.
    let mut worker = Worker::start(&planted("twice")).expect("it is ready");
    ask(&mut worker).expect("the first answer is good");
    let error = ask(&mut worker).expect_err("the second is not");
    assert!(matches!(*error.problem, Problem::Unasked { .. } | Problem::WrongId { got: 1, .. }), "{error}");
    assert_gone(worker);

    let mut worker = Worker::start(&planted("twice")).expect("it is ready");
    ask(&mut worker).expect("the first answer is good");
    let error = worker.finish().expect_err("more was said");
    assert!(matches!(*error.problem, Problem::Unasked { .. }), "{error}");
}

#[test]
fn an_answer_ahead_of_its_request_is_refused() {
    let mut worker = Worker::start(&planted("ahead")).expect("it is ready");
    ask(&mut worker).expect("the first answer is good");
    // Both came in one piece; now the second has been read as well.
    std::thread::sleep(std::time::Duration::from_millis(200));
    let error = ask(&mut worker).expect_err("the second was not asked for");
    assert!(matches!(*error.problem, Problem::Unasked { .. }), "{error}");
    assert_gone(worker);
}

#[test]
fn a_program_that_has_ended_in_between_is_an_error_of_the_next_request() {
    let mut worker = Worker::start(&planted("good")).expect("it is ready");
    ask(&mut worker).expect("an answer");
    let pid = rustix::process::Pid::from_raw(worker.process() as i32).expect("a process");
    rustix::process::kill_process(pid, rustix::process::Signal::TERM).expect("it is there");
    let error = ask(&mut worker).expect_err("it was gone");
    assert!(matches!(*error.problem, Problem::Ended { end: End::Signal(15), .. }), "{error}");
    assert_gone(worker);
}

#[test]
fn the_end_of_input_is_the_end_of_a_program() {
    let worker = Worker::start(&hurried("no-end")).expect("it is ready");
    let error = worker.finish().expect_err("it went on");
    assert!(matches!(*error.problem, Problem::NotEnded { .. }), "{error}");
    let worker = Worker::start(&planted("bad-end")).expect("it is ready");
    let error = worker.finish().expect_err("its code is 4");
    assert!(
        matches!(*error.problem, Problem::Ended { phase: Phase::Finish, end: End::Code(4), .. }),
        "{error}"
    );
}

#[test]
fn requests_that_make_no_sense_do_not_reach_the_program() {
    let mut worker = Worker::start(&planted("good")).expect("it is ready");
    let file = worker.folder().join("cut.f32");
    std::fs::write(&file, [0; 31]).expect("a file");
    let base = request();
    let ending = std::path::Path::new("mesh.stl");
    for (key, wrong) in [
        ("samples", Request { samples: Samples::Values(&[0.0; 7]), ..base }),
        ("samples", Request { samples: Samples::File(&file), ..base }),
        ("size", Request { size: [8, 1, 1], ..base }),
        ("samples", Request { size: [u32::MAX; 3], ..base }),
        ("spacing", Request { spacing: [1.0, 0.0, 1.0], ..base }),
        ("spacing", Request { spacing: [1.0, 1.0, f64::NAN], ..base }),
        ("origin", Request { origin: [f64::INFINITY, 0.0, 0.0], ..base }),
        ("isovalue", Request { isovalue: f64::NAN, ..base }),
        ("mesh", Request { mesh: Some(ending), ..base }),
    ] {
        let error = worker.extract(&wrong).expect_err(key);
        assert!(
            matches!(*error.problem, Problem::Request { key: found, .. } if found == key),
            "{key}: {error}"
        );
    }
    assert_eq!(ask(&mut worker).expect("it is still asked").triangles, 1);
}
