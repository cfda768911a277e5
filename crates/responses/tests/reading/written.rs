//! What other programs are given.

use crate::study::{parse, plan, read, said};
use responses::{Mapping, Responses, SidesSource, Ties, WriteError};

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
            responses::write_long(&reading.responses, out).unwrap();
        });
        let again = parse(&long).unwrap();
        // The long format names the sides, whatever they were known from before.
        let want = Responses { sides: SidesSource::InFile, ..reading.responses };
        assert_eq!(again.responses, want, "{name}");
        assert!(again.report.remarks.is_empty());
    }
    let reading = read("long.csv", &Mapping::default());
    let long = text(|out| {
        responses::write_long(&reading.responses, out).unwrap();
    });
    let want = "participant,form,order,question,object,group,left,right,choice,rt_ms,role,stimulus\n\
        p1,A,2,Q1,,,a,b,left,812.5,comparison,\n";
    assert!(long.starts_with(want), "{long}");
}

#[test]
fn formulas_are_escaped_in_every_format_and_read_back() {
    let text_of = "participant,question,left,right,choice\n\"=HYPERLINK(\"\"http://x\"\")\",+Q,@a,-b,left\n'=x,+Q,@a,-b,right\n";
    let path = std::path::Path::new("x.csv");
    let reading = responses::parse(text_of.as_bytes(), path, None, &Mapping::default()).unwrap();
    let ids: Vec<&str> = reading.responses.participants.iter().map(|p| p.id.as_str()).collect();
    assert_eq!(ids, ["=HYPERLINK(\"http://x\")", "=x"]);
    let items = reading.responses.items.clone();
    let long = text(|out| {
        responses::write_long(&reading.responses, out).unwrap();
    });
    let pwcmp = text(|out| {
        responses::write_pwcmp(&reading.responses, &items, Ties::Refuse, out).unwrap();
    });
    let arenakit = text(|out| {
        responses::write_arenakit(&reading.responses, &items, out).unwrap();
    });
    for written in [&long, &pwcmp, &arenakit] {
        for cell in written.split([',', '\n', '"']) {
            assert!(!cell.starts_with(['=', '+', '-', '@']), "{written}");
        }
    }
    let again = responses::parse(long.as_bytes(), path, None, &Mapping::default()).unwrap();
    assert_eq!(said(&again), said(&reading));
}

#[test]
fn pwcmp_has_no_ties() {
    let reading = read("long.csv", &Mapping::default());
    let (answers, names) = (&reading.responses, plan().short_names().to_vec());
    let refused = responses::write_pwcmp(answers, &names, Ties::Refuse, Vec::new()).unwrap_err();
    assert!(matches!(refused, WriteError::Ties { ties: 1, .. }), "{refused}");
    let split = text(|out| {
        let written = responses::write_pwcmp(answers, &names, Ties::Split, out).unwrap();
        assert_eq!((written.rows, written.ties, written.controls), (6, 1, 1));
    });
    let want = "observer,session,scene,condition_A,condition_B,is_A_selected\np1,A,all,a,b,1\np1,A,all,a,c,1\np1,A,all,a,c,0\n\
        p1,A,all,b,c,0\np2,B,all,a,b,0\np2,B,all,b,a,1\n";
    assert_eq!(split, want);
    let dropped = responses::write_pwcmp(answers, &names, Ties::Drop, Vec::new()).unwrap();
    assert_eq!(dropped.rows, 4);
}

#[test]
fn arenakit_has_the_left_one_first() {
    let reading = read("long.csv", &Mapping::default());
    let written = text(|out| {
        responses::write_arenakit(&reading.responses, plan().short_names(), out).unwrap();
    });
    let want = "model_a,model_b,winner,item_id,voter_id\na,b,a,Q1,p1\na,c,tie,Q2,p1\nb,c,b,Q3,p1\na,b,b,Q1,p2\nb,a,a,Q1,p2\n";
    assert_eq!(written, want);
}
