//! What other programs are given.

use crate::study::{fault, only_unknown, parse, plan, read, said};
use isostudy_responses::{Fault, Mapping, Responses, SidesSource, Ties, WriteError};

fn text(write: impl FnOnce(&mut Vec<u8>)) -> String {
    let mut out = Vec::new();
    write(&mut out);
    String::from_utf8(out).unwrap()
}

#[test]
fn the_long_format_comes_back_as_it_was() {
    for name in ["table_ids.csv", "long.csv", "qualtrics.csv", "microsoft.xlsx"] {
        let reading = read(name, &Mapping::default());
        let long = text(|out| {
            isostudy_responses::write_long(&reading.responses, out).unwrap();
        });
        let again = parse(&long).unwrap();
        // The long format names the sides, whatever they were known from before.
        let want = Responses { sides: SidesSource::InFile, ..reading.responses };
        assert_eq!(again.responses, want, "{name}");
        assert!(again.report.remarks.is_empty());
    }
    let reading = read("long.csv", &Mapping::default());
    let long = text(|out| {
        isostudy_responses::write_long(&reading.responses, out).unwrap();
    });
    let want = "participant,form,order,question,object,group,left,right,choice,rt_ms,role,stimulus\n\
        p1,A,2,Q1,,,a,b,left,812.5,comparison,\n";
    assert!(long.starts_with(want), "{long}");
}

#[test]
fn screens_come_back_and_what_is_none_is_listed() {
    let header = "participant,question,left,right,choice,viewport_width,pixel_ratio,input,dropped,shown_as\n";
    let text_of = format!(
        "{header}p,q,a,b,left,390,2.625,touch,0,mp4\np,r,a,b,left,,,,,\np,s,a,b,left,wide,1,mouth,2,gif\n"
    );
    let path = std::path::Path::new("x.csv");
    let read =
        |text: &str| isostudy_responses::parse(text.as_bytes(), path, None, &Mapping::default()).unwrap();
    let reading = read(&text_of);
    let said: Vec<_> = reading
        .responses
        .answers
        .iter()
        .map(|answer| {
            reading.responses.screen(answer).map(|s| (s.viewport_width, s.input, s.dropped, s.shown_as))
        })
        .collect();
    let first = (Some(390.0), Some("touch"), Some(0.0), Some("mp4"));
    assert_eq!(said, [Some(first), None, Some((None, None, Some(2.0), Some("gif")))]);
    let rejected: Vec<(u64, &str)> =
        reading.report.remarks.iter().map(|r| (r.row, r.action.as_str())).collect();
    assert_eq!(rejected.len(), 2, "{rejected:?}");
    assert!(rejected.iter().all(|(row, _)| *row == 4) && rejected[1].1.contains("keyboard"), "{rejected:?}");
    let long = text(|out| {
        isostudy_responses::write_long(&reading.responses, out).unwrap();
    });
    assert_eq!(read(&long).responses, reading.responses);
}

#[test]
fn formulas_are_escaped_in_every_format_and_read_back() {
    let text_of = "participant,question,left,right,choice\n\"=HYPERLINK(\"\"http://x\"\")\",+Q,@a,-b,left\n'=x,+Q,@a,-b,right\n";
    let path = std::path::Path::new("x.csv");
    let reading = isostudy_responses::parse(text_of.as_bytes(), path, None, &Mapping::default()).unwrap();
    let ids: Vec<&str> = reading.responses.participants.iter().map(|p| p.id.as_str()).collect();
    assert_eq!(ids, ["=HYPERLINK(\"http://x\")", "=x"]);
    let items = reading.responses.items.clone();
    let long = text(|out| {
        isostudy_responses::write_long(&reading.responses, out).unwrap();
    });
    let pwcmp = text(|out| {
        isostudy_responses::write_pwcmp(&reading.responses, &items, Ties::Refuse, out).unwrap();
    });
    let arenakit = text(|out| {
        isostudy_responses::write_arenakit(&reading.responses, &items, out).unwrap();
    });
    for written in [&long, &pwcmp, &arenakit] {
        for cell in written.split([',', '\n', '"']) {
            assert!(!cell.starts_with(['=', '+', '-', '@']), "{written}");
        }
    }
    let again = isostudy_responses::parse(long.as_bytes(), path, None, &Mapping::default()).unwrap();
    assert_eq!(said(&again), said(&reading));
}

#[test]
fn pwcmp_has_no_ties() {
    let reading = read("long.csv", &Mapping::default());
    let (answers, names) = (&reading.responses, plan().short_names().to_vec());
    let refused = isostudy_responses::write_pwcmp(answers, &names, Ties::Refuse, Vec::new()).unwrap_err();
    assert!(matches!(refused, WriteError::Ties { ties: 1, .. }), "{refused}");
    let split = text(|out| {
        let written = isostudy_responses::write_pwcmp(answers, &names, Ties::Split, out).unwrap();
        assert_eq!((written.rows, written.ties, written.controls), (6, 1, 1));
    });
    let want = "observer,session,scene,condition_A,condition_B,is_A_selected\np1,A,all,a,b,1\np1,A,all,a,c,1\np1,A,all,a,c,0\n\
        p1,A,all,b,c,0\np2,B,all,a,b,0\np2,B,all,b,a,1\n";
    assert_eq!(split, want);
    let dropped = isostudy_responses::write_pwcmp(answers, &names, Ties::Drop, Vec::new()).unwrap();
    assert_eq!(dropped.rows, 4);
}

#[test]
fn arenakit_has_the_left_one_first() {
    let reading = read("long.csv", &Mapping::default());
    let written = text(|out| {
        isostudy_responses::write_arenakit(&reading.responses, plan().short_names(), out).unwrap();
    });
    let want = "model_a,model_b,winner,item_id,voter_id\na,b,a,Q1,p1\na,c,tie,Q2,p1\nb,c,b,Q3,p1\na,b,b,Q1,p2\nb,a,a,Q1,p2\n";
    assert_eq!(written, want);
}

/// The forms of a study, answered by pressing left throughout.
fn pressed_left(study: &isostudy_design::Study) -> isostudy_responses::Reading {
    let mut text =
        "participant,form,order,question,object,group,left,right,choice,role,stimulus\n".to_owned();
    for line in crate::sides::key(study) {
        let isostudy_design::forms::KeyEntry {
            form,
            order,
            stimulus,
            role,
            question,
            object,
            group,
            left,
            right,
            ..
        } = line;
        let role = format!("{role:?}").to_lowercase();
        let line = format!(
            "p{form},{form},{order},{question},{object},{group},{left},{right},L,{role},{stimulus}\n"
        );
        text += &line;
    }
    crate::sides::read(&text, study).unwrap()
}

fn open(text: &str) -> isostudy_responses::Reading {
    isostudy_responses::parse(text.as_bytes(), std::path::Path::new("x.csv"), None, &Mapping::default())
        .unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn other_programs_get_comparisons_alone() {
    for (name, all, comparisons) in
        [("balanced.toml", 36 * 32, 36 * 27), ("two-methods.toml", 24 * 6, 24 * 2)]
    {
        let study = crate::sides::study(name, &[]);
        let (reading, names) =
            (pressed_left(&study), isostudy_responses::Plan::of_study(&study).short_names().to_vec());
        let answers = &reading.responses;
        assert_eq!(answers.answers.len(), all);
        for text in [
            text(|out| {
                isostudy_responses::write_arenakit(answers, &names, out).unwrap();
            }),
            text(|out| {
                isostudy_responses::write_pwcmp(answers, &names, Ties::Refuse, out).unwrap();
            }),
        ] {
            assert_eq!(text.lines().count(), 1 + comparisons, "{name}");
        }
        let written = isostudy_responses::write_arenakit(answers, &names, Vec::new()).unwrap();
        assert_eq!(
            (written.rows, written.controls + written.repeats),
            (comparisons as u64, (all - comparisons) as u64)
        );
        assert!(written.controls > 0 && written.repeats > 0);
        // The long format has everything, and says what is what.
        let long =
            text(|out| assert_eq!(isostudy_responses::write_long(answers, out).unwrap().rows, all as u64));
        let again = open(&long);
        assert_eq!(said(&again), said(&reading));
        let question = |reading: &isostudy_responses::Reading, i: usize| {
            let question = &reading.responses.questions[reading.responses.answers[i].question as usize];
            let isostudy_responses::Question { id, object, group, role, .. } = question.clone();
            (id, object, group, role)
        };
        assert!((0..all).all(|i| question(&again, i) == question(&reading, i)));
        assert_eq!(crate::sides::read(&long, &study).unwrap().responses, *answers);
    }
}

#[test]
fn groups_come_back() {
    let text_of =
        "participant,question,object,group,left,right,choice\np,q1,o,g1,A,B,left\np,q2,o,g2,A,C,left\n";
    let reading = open(text_of);
    let long = text(|out| {
        isostudy_responses::write_long(&reading.responses, out).unwrap();
    });
    assert_eq!(open(&long).responses, reading.responses);
    assert_eq!(reading.responses.questions[1].group, "g2");
}

#[test]
fn arenakit_comes_back_with_a_study_and_without() {
    let study = crate::sides::study("two-methods.toml", &[]);
    let (reading, names) =
        (pressed_left(&study), isostudy_responses::Plan::of_study(&study).short_names().to_vec());
    let arena = text(|out| {
        isostudy_responses::write_arenakit(&reading.responses, &names, out).unwrap();
    });
    let again = crate::sides::read(&arena, &study).unwrap();
    let comparisons: Vec<String> = said(&reading)
        .into_iter()
        .filter(|said| !said.contains("-r ") && !said.contains("control"))
        .collect();
    assert_eq!(said(&again), comparisons);
    assert!(again.responses.sides_recorded);
    // Without the study, items are methods, and the second time it is written as the first time.
    let alone = open(&arena);
    assert_eq!(said(&alone).len(), comparisons.len());
    let items = alone.responses.items.clone();
    assert_eq!(
        text(|out| {
            isostudy_responses::write_arenakit(&alone.responses, &items, out).unwrap();
        }),
        arena
    );

    // What several pairs are compared on is their object; who is not named is somebody else.
    let bare = open(
        "model_a,model_b,winner,item_id,turn\nm1,m10,model_a,poem,1\nm2,m1,tie,poem,1\nm1,m10,right,song,2\n",
    );
    assert_eq!(bare.responses.items, ["m1", "m2", "m10"]);
    assert_eq!(said(&bare), ["row 2 poem: m1-m10 m1<m10", "row 3 poem: m2-m1 m2=m1", "row 4 song m1>m10"]);
    let objects: Vec<&str> = bare.responses.questions.iter().map(|q| q.object.as_str()).collect();
    assert_eq!(objects, ["poem", "poem", ""]);
    let plain = open("model_a,model_b,winner\nm1,m10,a\nm10,m1,draw\n");
    assert_eq!(said(&plain), ["row 2 m1-m10 m1<m10", "row 3 m1-m10 m10=m1"]);
    let bad = isostudy_responses::parse(
        b"model_a,model_b,winner\nm1,m10,tie (bothbad)\n",
        std::path::Path::new("x"),
        None,
        &Mapping::default(),
    );
    assert_eq!(only_unknown(&fault(bad.unwrap_err())).3, "tie (bothbad)");
}

#[test]
fn pwcmp_comes_back_without_sides() {
    let study = crate::sides::study("two-methods.toml", &[]);
    let (reading, names) =
        (pressed_left(&study), isostudy_responses::Plan::of_study(&study).short_names().to_vec());
    let pwcmp = text(|out| {
        isostudy_responses::write_pwcmp(&reading.responses, &names, Ties::Refuse, out).unwrap();
    });
    let again = crate::sides::read(&pwcmp, &study).unwrap();
    let comparisons: Vec<String> = said(&reading)
        .into_iter()
        .filter(|said| !said.contains("-r ") && !said.contains("control"))
        .collect();
    assert_eq!(said(&again), comparisons);
    let forms = |reading: &isostudy_responses::Reading| -> Vec<Option<String>> {
        reading.responses.participants.iter().map(|person| person.form.clone()).collect()
    };
    assert_eq!(forms(&again), forms(&reading));
    // Which condition was on the left the format does not say.
    assert!(!again.responses.sides_recorded);
    let alone = open(&pwcmp);
    let items = alone.responses.items.clone();
    assert_eq!(
        text(|out| {
            isostudy_responses::write_pwcmp(&alone.responses, &items, Ties::Refuse, out).unwrap();
        }),
        pwcmp
    );

    let text_of = "observer,session,scene,condition_A,condition_B,selected_A\n1,1,Window,T,F,1\n1,2,Hall,F,T,0\n2,1,Hall,T,F,0\n";
    let several = open(text_of);
    assert_eq!(said(&several), ["1 Window: F-T T<F", "1 Hall: F-T F>T", "2 Hall: F-T T>F"]);
    assert_eq!(crate::study::remarks(&several), ["1:2 noted"]);
    let other = crate::sides::read(&text_of.replace("Window", "Sphere"), &study).unwrap_err();
    assert_eq!(other, Fault::NoSuchPair { row: 2, found: "T and F on Sphere".into() });
}

#[test]
fn split_ties_come_back_as_one_answer_each() {
    let study = crate::sides::study("two-methods.toml", &[]);
    let (mut reading, names) =
        (pressed_left(&study), isostudy_responses::Plan::of_study(&study).short_names().to_vec());
    for (answer, i) in reading.responses.answers.iter_mut().zip(0..) {
        answer.choice = isostudy_responses::Choice::ALL[i % 3];
    }
    let split = text(|out| {
        isostudy_responses::write_pwcmp(&reading.responses, &names, Ties::Split, out).unwrap();
    });
    let comparisons: Vec<String> = said(&reading)
        .into_iter()
        .filter(|said| !said.contains("-r ") && !said.contains("control"))
        .collect();
    let ties = comparisons.iter().filter(|said| said.contains('=')).count();
    assert!(ties > 5 && split.lines().count() == 1 + comparisons.len() + ties);
    let again = crate::sides::read(&split, &study).unwrap();
    assert_eq!(said(&again), comparisons);
    let [remark] = &crate::study::remarks(&again)[..] else { panic!("{:?}", again.report.remarks) };
    assert!(remark.ends_with(&format!(" {}", ties - 1)), "{remark}");
    // Nor does the order of rows matter.
    let mut rows: Vec<&str> = split.lines().skip(1).collect();
    rows.sort_unstable();
    let sorted = format!("{}\n{}\n", split.lines().next().unwrap(), rows.join("\n"));
    let mut of_sorted = said(&crate::sides::read(&sorted, &study).unwrap());
    let mut comparisons = comparisons;
    of_sorted.sort_unstable();
    comparisons.sort_unstable();
    assert_eq!(of_sorted, comparisons);
}

#[test]
fn only_a_won_and_a_lost_row_of_one_session_are_a_tie() {
    let of = |rows: &[&str]| {
        let header = "observer,session,scene,condition_A,condition_B,is_A_selected";
        let text = format!("{header}\n{}\n", rows.join("\n"));
        crate::study::open(&text)
    };
    let tie = of(&["p,1,Hall,T,F,1", "q,1,Hall,T,F,1", "p,1,Hall,T,F,0"]).unwrap();
    assert_eq!(said(&tie), ["p Hall: F-T T=F", "q Hall: F-T T<F"]);
    assert_eq!(crate::study::remarks(&tie), ["2 noted 4"]);
    // Another scene, or the other condition first, is another showing.
    let two = of(&["p,1,Hall,T,F,1", "p,1,Sea,T,F,0", "p,1,Hall,F,T,1"]).unwrap();
    assert_eq!(said(&two), ["p Hall: F-T T<F", "p Sea: F-T T>F", "p Hall: F-T F<T"]);
    // What was said again, or in another session, is no half of a tie. There is no `order` to tell such rows apart.
    for rows in [
        &["p,1,Hall,T,F,1", "p,1,Hall,T,F,1"][..],
        &["p,1,Hall,T,F,1", "p,1,Hall,T,F,0", "p,1,Hall,T,F,0"],
        &["p,1,Hall,T,F,1", "p,2,Hall,T,F,0"],
    ] {
        let [participant, question] = ["p", "Hall: F-T"].map(str::to_owned);
        let again = Fault::DuplicateAnswer { row: 3, first: 2, participant, question, ordered: false };
        assert_eq!(of(rows).unwrap_err(), again);
    }
}
