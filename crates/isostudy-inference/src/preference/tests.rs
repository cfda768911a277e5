use super::*;
use crate::fixture;
use proptest::prelude::*;

fn counted(study: &Study) -> Tally {
    Tally::of(&fixture::answers(study), study)
}

#[test]
fn the_twelve_group_factors() {
    // Wins, ties and answers, inverted from the published table and counted anew in numpy.
    let study = fixture::study();
    let want = [
        ("B", "bu", 17, 19, 162),
        ("B", "bi", 68, 19, 162),
        ("B", "bp", 58, 19, 162),
        ("S", "su", 25, 8, 162),
        ("S", "si", 91, 8, 162),
        ("S", "sp", 38, 8, 162),
        ("U", "su", 10, 8, 54),
        ("U", "bu", 36, 8, 54),
        ("I", "si", 27, 7, 54),
        ("I", "bi", 20, 7, 54),
        ("P", "sp", 19, 7, 54),
        ("P", "bp", 28, 7, 54),
    ];
    let factors = group_factors(&study, &counted(&study), |_| true);
    let got: Vec<_> = factors
        .iter()
        .map(|f| {
            let Share { wins, ties, answers } = f.share;
            (study.groups[f.group].id.clone(), f.method.to_string(), wins, ties, answers)
        })
        .collect();
    assert_eq!(got, want.map(|(g, m, w, t, a)| (g.to_owned(), m.to_owned(), w, t, a)));
    assert!(factors[..6].iter().all(|f| f.cap() == Fraction::new(2, 3)));
    assert!(factors[6..].iter().all(|f| f.cap() == Fraction::new(1, 1)));
    assert_eq!(factors[0].appearance_share(), Some(Fraction::new(17, 108)));
}

#[test]
fn the_six_sums_and_five_margins() {
    let study = fixture::study();
    let sums = overall(&study, &group_factors(&study, &counted(&study), |_| true));
    let want =
        [("bu", 17, 36), ("bi", 68, 20), ("bp", 58, 28), ("su", 25, 10), ("si", 91, 27), ("sp", 38, 19)];
    for ((method, sum), (id, clustering, arrangement)) in sums.iter().zip(want) {
        assert_eq!(method.to_string(), id);
        assert_eq!(*sum, Fraction::new(clustering, 162) + Fraction::new(arrangement, 54));
    }
    assert_eq!(sums.len(), 6);
    let margins: Vec<(&str, i128)> = margins(&study, &sums)
        .iter()
        .map(|(m, mean)| (study.level(*m).code.as_str(), mean.rounded(4)))
        .collect();
    assert_eq!(margins, [("B", 8128), ("S", 6626), ("U", 5556), ("I", 9259), ("P", 7315)]);
}

#[test]
fn wins_per_object() {
    // Added up by hand from the wins per question as published; the rest to 54 are ties.
    let study = fixture::study();
    let tally = counted(&study);
    let names: Vec<&str> = study.file.objects.iter().map(|o| o.name.as_str()).collect();
    assert_eq!(names, ["sphere", "asteroid", "bunny"]);
    let want = [
        ([4, 28, 15, 12, 35, 6], [7, 1]),
        ([8, 19, 21, 6, 28, 18], [6, 2]),
        ([5, 21, 22, 7, 28, 14], [6, 5]),
    ];
    for (object, (wins, ties)) in want.iter().enumerate() {
        let factors = group_factors(&study, &tally, |o| o == object);
        let got: Vec<u64> = factors[..6].iter().map(|f| f.share.wins).collect();
        assert_eq!(got, wins);
        assert_eq!([factors[0].share.ties, factors[3].share.ties], *ties);
        assert!(factors[..6].iter().all(|f| f.share.answers == 54));
        assert!(factors[6..].iter().all(|f| f.share.answers == 18));
    }
}

#[test]
fn pooled_sides_and_pairs() {
    let study = fixture::study();
    let tally = counted(&study);
    let sum = |of: fn(&crate::QuestionCount) -> u64| tally.questions.iter().map(of).sum::<u64>();
    assert_eq!((sum(|q| q.left), sum(|q| q.none), sum(|q| q.right)), (144, 49, 293));
    // Counted by hand: first / none / second, pooled over objects.
    let pair = |left: &str, right: &str| {
        let shown = |c: &isostudy_design::Comparison| {
            c.left.method.to_string() == left && c.right.method.to_string() == right
        };
        let counts = study.comparisons.iter().zip(&tally.questions).filter(|(c, _)| shown(c));
        counts.fold((0, 0, 0), |(l, n, r), (_, q)| (l + q.left, n + q.none, r + q.right))
    };
    assert_eq!((pair("bu", "bi"), pair("su", "si")), ((7, 1, 46), (7, 1, 46)));
    assert_eq!((pair("bu", "bp"), pair("su", "sp")), ((10, 1, 43), (18, 1, 35)));
    assert_eq!((pair("bp", "bi"), pair("sp", "si")), ((15, 17, 22), (3, 6, 45)));
}

/// CSV with questions and respondents in the given orders.
fn csv(study: &Study, answers: &[Vec<u8>], questions: &[usize], people: &[usize]) -> String {
    let codes = ["L", "NP", "R"];
    let header: Vec<&str> = questions.iter().map(|&q| study.comparisons[q].question.as_str()).collect();
    let row = |&person: &usize| {
        questions.iter().map(|&q| codes[answers[person][q] as usize]).collect::<Vec<_>>().join(",")
    };
    let rows: Vec<String> = people.iter().map(row).collect();
    format!("{}\n{}\n", header.join(","), rows.join("\n"))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]
    #[test]
    fn shares_add_up_and_order_changes_nothing(
        answers in prop::collection::vec(prop::collection::vec(0..3u8, 27), 1..6),
        questions in Just((0..27).collect::<Vec<usize>>()).prop_shuffle(),
        turn in 0..6usize,
    ) {
        let study = fixture::study();
        let mut people: Vec<usize> = (0..answers.len()).collect();
        let straight: Vec<usize> = (0..27).collect();
        let read = |text: String| {
            Tally::of(&fixture::parse(&text, &study), &study)
        };
        let tally = read(csv(&study, &answers, &straight, &people));
        people.rotate_left(turn % answers.len());
        let permuted = read(csv(&study, &answers, &questions, &people));
        let factors = group_factors(&study, &tally, |_| true);
        prop_assert_eq!(&factors, &group_factors(&study, &permuted, |_| true));
        prop_assert_eq!(&tally.questions, &permuted.questions);
        for group in 0..study.groups.len() {
            let of: Vec<&GroupFactor> = factors.iter().filter(|f| f.group == group).collect();
            let wins: u64 = of.iter().map(|f| f.share.wins).sum();
            prop_assert_eq!(wins + of[0].share.ties, of[0].share.answers);
            for factor in of {
                let value = factor.share.factor().value();
                prop_assert!((0.0..=factor.cap().value()).contains(&value));
            }
        }
    }
}
