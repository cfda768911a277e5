use super::*;
use crate::fixture;
use isostudy_inference::audit::evidence::Pull;
use isostudy_inference::audit::{Finding, Probe, audit};
use isostudy_inference::{Recorded, ballots};

#[test]
fn the_papers_answers() {
    let study = fixture::study();
    let answers = fixture::answers(&study);
    let shown = ballots::ballots(&study, &answers);
    let groups = ballots::ballot_groups(&study, &shown);
    let reports = audit(&Recorded::of_study(&study, &answers, &shown).audited(&groups));
    let said = |probe| {
        let report = reports.iter().find(|report| report.probe == probe).unwrap();
        (report.finding, evidence(&report.evidence))
    };
    let (side, why) = said(Probe::Side);
    assert_eq!(side, Finding::NotAnswerable);
    assert!(why.starts_with("not answerable here, because no pair was seen in both orders"), "{why}");
    let (_, odd) = said(Probe::OutlyingRespondent);
    // Counted apart from this program.
    assert_eq!(odd, "respondent 16 agrees with the others' majority on 37 %; everybody else on 64 to 95 %");
    let (_, object) = said(Probe::ObjectInteraction);
    assert!(object.contains("(arrangement) on sphere: mean"), "{object}");
}

fn file(question: &str) -> WrongFile {
    WrongFile { questions: vec![question.into(), format!("{question}-r")], contradicting: 36, answers: 36 }
}

fn said_of_key(contradictions: &[Contradiction], remarks: &[Remark], orders: Orders) -> String {
    evidence(&Evidence::SwappedKey(Key {
        contradictions: contradictions.to_vec(),
        remarks: remarks.to_vec(),
        orders,
    }))
}

#[test]
fn sides() {
    let said = |pairs, controls| evidence(&Evidence::Side(Pulls { pairs, controls }));
    assert_eq!(said(None, Some([0, 0, 12])), "controls: 0 left, 0 none, 12 right");
    assert_eq!(
        said(Some(Pull { pairs: 27, mean: 0.25 }), Some([5, 1, 2])),
        "27 pairs seen in both orders pull 0.250 to the left; controls: 5 left, 1 none, 2 right"
    );
    assert_eq!(
        said(Some(Pull { pairs: 1, mean: -0.5 }), None),
        "1 pair seen in both orders pulls 0.500 to the right"
    );
    assert_eq!(
        evidence(&Evidence::NotAnswerable(Reason::FewControls([1, 0, 2], BothOrders::default()))),
        "not answerable here, because too few people answered controls, and no pair was seen in both orders \
         (controls: 1 left, 0 none, 2 right)"
    );
    let few = |pairs, people, apart| reason(&Reason::FewInBothOrders(BothOrders { pairs, people, apart }));
    assert_eq!(
        few(5, 3, 0),
        "5 pairs in both orders were seen by 3 people, and fewer than four tell no spread; there are no controls"
    );
    assert_eq!(
        few(0, 0, 190),
        "no pair was seen in both orders on one object: 190 pairs were seen in both orders, but each order in a question or on an \
         object of its own; there are no controls"
    );
}

#[test]
fn a_wrong_key() {
    let agree = || Orders::Agree { pairs: 27 };
    assert_eq!(
        said_of_key(&[], &[Remark::CodesAgree { files: 56 }, Remark::FormsAgree], agree()),
        "the code names of 56 files agree with the sides; the sides are those of the forms; the two orders of 27 pairs agree"
    );
    assert_eq!(
        said_of_key(&[], &[Remark::FormsAgree, Remark::Stray { answers: 1 }], agree()),
        "the sides are those of the forms; 1 single answer contradicts the forms; the two orders of 27 pairs agree"
    );
    let forms = Contradiction::Forms(vec![file("Q2"), file("Q3")]);
    let codes = Contradiction::Codes { files: 56, wrong: vec![(file("Q2"), "k7".into())] };
    assert_eq!(
        said_of_key(&[codes, forms], &[], Orders::Few),
        "the sides contradict what the code name shows in 1 of 56 files (Q2/Q2-r: 36 of 36 answers to file k7); \
         answers are labelled in the other order of sides than their forms show (Q2/Q2-r: 36 of 36 answers, \
         Q3/Q3-r: 36 of 36 answers); whether answers were turned cannot be told, because fewer than four pairs were \
         seen in both orders of sides"
    );
    let turned = TurnedPair { questions: file("Q2").questions, means: [0.5, -0.25] };
    assert_eq!(
        said_of_key(
            &[Contradiction::OtherForm(vec![2])],
            &[Remark::Stray { answers: 2 }],
            Orders::Contradict(vec![turned])
        ),
        "the sides are those of another form than the file names for respondent 3; two orders contradict each other. \
         Q2/Q2-r: mean 0.50 for an item on the left, \u{2212}0.25 for it on the right; 2 single answers contradict the forms"
    );
    assert_eq!(
        evidence(&Evidence::NotAnswerable(Reason::FewPairsInBothOrders {
            remarks: vec![Remark::OtherStudysForms],
            apart: 0
        })),
        "not answerable here, because fewer than four pairs were seen in both orders of sides: a wrong key looks like a \
         preference; the sides are not those of the forms that the study deals"
    );
}

#[test]
fn copies() {
    let times = |people, untimed, copies| Some(SameTimes { people, untimed, copies });
    let answers = |same, copies: &[&[usize]]| {
        let copies = copies.iter().map(|people| people.to_vec()).collect();
        Some(SameAnswers { people: 36, same, expected: 0.0001, least_expected: 0.0123, copies })
    };
    let said = |times, answers| evidence(&Evidence::CopiedRows(Copies { times, answers }));
    let twins = TimeTwins { people: [4, 16], common: 32, timed: 32 };
    assert_eq!(
        said(times(36, 0, vec![twins]), answers(0, &[])),
        "to the millisecond, respondents 5 and 17 took the same time for 32 of 32 answers; no two of 36 people gave the \
         same answers; by chance about none (below 0.001) would"
    );
    assert_eq!(
        said(times(30, 6, Vec::new()), None),
        "no two of 30 people took the same times; 6 of all have too few times to be compared"
    );
    assert_eq!(
        said(None, answers(1, &[&[4, 16]])),
        "respondents 5, 17 gave the same answers; by chance about 0.012 pairs would give these"
    );
    assert_eq!(
        said(None, answers(22, &[&[0, 1], &[2, 3, 4, 5, 6, 7, 8]])),
        "22 pairs gave the same answers, by chance about none (below 0.001) would, and about 0.012 the least probable of \
         them: respondents 1, 2, respondents 3, 4, 5, 6, 7 and 2 more"
    );
}

#[test]
fn objects() {
    let difference = |means| Difference {
        items: ["a".into(), "b".into()],
        group: "trees".into(),
        object: "sphere".into(),
        means,
    };
    let said = |compared, found, largest, pressing| {
        evidence(&Evidence::ObjectInteraction(Differences { compared, found, largest, pressing }))
    };
    let one = difference([0.5, -0.25]);
    assert_eq!(
        said(6, vec![one.clone()], Some(one.clone()), 2),
        "a-b (trees) on sphere: mean 0.50 against \u{2212}0.25; without 2 respondents pressing one side throughout"
    );
    assert_eq!(
        said(6, Vec::new(), Some(one), 0),
        "6 comparisons; the largest difference is a-b (trees) on sphere: mean 0.50 against \u{2212}0.25"
    );
    assert_eq!(said(1, Vec::new(), None, 0), "1 comparison; none differs");
}

#[test]
fn worths() {
    let sound = Separations {
        separated: Vec::new(),
        disconnected: Vec::new(),
        held_by_ties: Vec::new(),
        judged: 1,
        undecided: 0,
    };
    let said = |of: Separations| evidence(&Evidence::Separation(of));
    assert_eq!(said(sound.clone()), "every item won against the others");
    assert_eq!(
        said(Separations { judged: 3, undecided: 2, ..sound.clone() }),
        "every item won against the others in all 3 groups; in 2 groups nobody ever decided"
    );
    assert_eq!(
        said(Separations { separated: vec!["one".into()], judged: 2, undecided: 1, ..sound.clone() }),
        "in group one some items never won against the others: worths are penalised; in 1 group nobody ever decided"
    );
    let apart = Separations {
        disconnected: vec!["trees".into(), "cakes".into()],
        held_by_ties: vec!["ties".into()],
        judged: 3,
        ..sound
    };
    assert_eq!(
        said(apart),
        "in groups trees, cakes some items were never compared with the others: there are no worths; in group ties ties \
         alone keep the worths finite"
    );
    let none = Evidence::NotAnswerable(Reason::NothingDecided);
    assert!(evidence(&none).contains("nobody ever decided between two items"));
}
