use super::*;
use crate::fixture;
use isostudy_statistics::Outcome;
use isostudy_statistics::simulation::{davidson, draw, normal, stream};

/// Log worths of the truth; the paper's design shows each method beside others of its own choice.
const TRUTH: [(&str, f64); 6] =
    [("bi", 1.5), ("bp", 1.4), ("si", 1.0), ("bu", 0.8), ("sp", -1.0), ("su", -1.5)];

fn worth(method: MethodId) -> f64 {
    TRUTH.iter().find(|(id, _)| *id == method.as_str()).unwrap().1
}

/// The paper's questionnaire, answered by so many people of that taste, who differ by `sd`; as a file that is read.
fn planted(study: &Study, people: usize, sd: f64, seed: u64) -> Answered {
    let random = &mut stream(seed, 7);
    let header: Vec<String> = study.comparisons.iter().map(|c| c.question.clone()).collect();
    let mut text = header.join(",") + "\n";
    let methods = study.method_ids();
    for _ in 0..people {
        let own: Vec<f64> = methods.iter().map(|_| sd / std::f64::consts::SQRT_2 * normal(random)).collect();
        let at = |method: MethodId| worth(method) + own[study.place(method)];
        let cells: Vec<&str> = study
            .comparisons
            .iter()
            .map(|c| match draw(davidson(at(c.left.method) - at(c.right.method), 0.3), random) {
                Outcome::Left => "L",
                Outcome::Tie => "NP",
                Outcome::Right => "R",
            })
            .collect();
        text += &(cells.join(",") + "\n");
    }
    Answered::of(study, fixture::parse(&text, study)).unwrap()
}

/// In the share of showings won, `si` beats `bi` here nearly always: it stands beside weaker others.
#[test]
fn the_most_liked_is_the_truth_or_named_beside_it() {
    let study = fixture::study();
    let (mut right, mut missed) = (0, 0);
    for seed in 0..40 {
        let answered = planted(&study, 36, 0.6, seed);
        let likings = Liking::all(&study, &answered, 0.05);
        assert_eq!(likings.len(), 1 + study.file.objects.len());
        let top = likings[0].top.as_ref().unwrap();
        right += usize::from(top.best.as_str() == "bi");
        missed += usize::from(top.best.as_str() != "bi" && top.alike.iter().all(|of| of.as_str() != "bi"));
        // Nobody would take these two for the best.
        assert!(top.alike.iter().all(|of| !["sp", "su"].contains(&of.as_str())), "{top:?}");
    }
    // bi and bp are .1 apart.
    assert!(right >= 20, "{right} of 40");
    assert_eq!(missed, 0);
}

/// On the sphere, question 8 asked bi against si, 12 : 4 : 2 people, and holds: nobody may say that they are not told apart.
#[test]
fn whom_a_question_told_apart_is_not_called_alike() {
    let study = fixture::study();
    let answered = fixture::answered(&study);
    let likings = Liking::all(&study, &answered, 0.05);
    let sphere = likings.iter().find(|of| of.object == Some(0)).unwrap();
    let top = sphere.top.as_ref().unwrap();
    assert_eq!(top.best.as_str(), "bi", "{top:?}");
    assert!(top.alike.iter().all(|of| of.as_str() != "si"), "{top:?}");
}

/// Worths less their mean: they add up to zero, and the interval of two items is half of that of their difference.
#[test]
fn worths_are_about_the_mean_of_all() {
    let study = fixture::study();
    let likings = Liking::all(&study, &planted(&study, 36, 0.6, 1), 0.05);
    for of in &likings {
        let worths = of.worths.as_ref().unwrap();
        assert!(worths.iter().map(|(worth, _)| worth).sum::<f64>().abs() < 1e-9);
        let inside = |(worth, interval): &(f64, Option<Interval>)| {
            interval.is_none_or(|of| of.low < *worth && *worth < of.high)
        };
        assert!(worths.iter().all(inside), "{worths:?}");
    }
    let two: Vec<ShownBallot> = (0..30)
        .map(|i| {
            ShownBallot::new(i / 3, i % 3, [0, 1], if i % 4 == 0 { Outcome::Right } else { Outcome::Left })
        })
        .collect();
    let participants = Participants::of(2, &two);
    let scale = scale(&participants, 0).unwrap();
    let found = centred(&scale, &participants);
    let difference = scale.differences[0];
    let [half, whole] = [found[0].1.unwrap(), difference.spread.unwrap().interval];
    assert!((found[0].0 - 0.5 * difference.log_odds).abs() < 1e-12);
    assert!((half.high - half.low - 0.5 * (whole.high - whole.low)).abs() < 1e-9);
}

#[test]
fn the_set_with_more_than_half_of_the_items_is_the_one_that_is_judged() {
    let of = |items: &[usize], pairs: &[[usize; 2]]| {
        let mut set = most_joined(items, &pairs.iter().copied().collect());
        set.sort_unstable();
        set
    };
    assert_eq!(of(&[2, 3, 5, 7, 9], &[[9, 2], [5, 9], [3, 7]]), [2, 5, 9]);
    assert_eq!(of(&[2, 3, 5, 7, 9], &[[3, 2], [5, 9], [7, 5]]), [5, 7, 9]);
    // Joined by a chain that is given backwards.
    assert_eq!(of(&[1, 2, 3, 4], &[[3, 4], [2, 3], [1, 2]]), [1, 2, 3, 4]);
    // Halves: neither is the study's scale.
    assert_eq!(of(&[1, 2, 3, 4], &[[1, 2], [3, 4]]), [1, 2, 3, 4]);
}
