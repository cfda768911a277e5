//! What is asked, on the balanced study: six methods on three objects.

use super::*;
use std::path::Path;

/// The balanced study, asking 12 questions each and choosing.
fn adaptive() -> Study {
    let text = include_str!("../../../../configs/balanced.toml");
    let text = text.replace("[forms]", "[forms]\nadaptive = true");
    let text: String = text
        .lines()
        .map(|line| match line.split(" = ").next() {
            Some("repeats") => "repeats = 0\n".to_owned(),
            Some("controls") => "controls = 1\n".to_owned(),
            Some("max_questions") => "max_questions = 13\n".to_owned(),
            _ => format!("{line}\n"),
        })
        .collect();
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../configs/balanced.toml");
    Study::parse(&text, Path::new(path)).unwrap()
}

fn planned(study: &Study, form: usize) -> Vec<String> {
    isostudy_design::forms::Questionnaire::of(study).unwrap().file().forms[form].questions.clone()
}

/// As many questions as planned, none twice, controls where they were, and half of the comparisons as planned; other answers, other
/// questions; the same, the same.
#[test]
fn half_stays_and_nothing_is_asked_twice() {
    let study = adaptive();
    let next = NextQuestions::of(&study).unwrap();
    let codes: Vec<&str> = next.of_code.keys().map(String::as_str).collect();
    for person in 0..20 {
        let planned = planned(&study, person);
        let answered = || codes.iter().cycle().take(40 * person).enumerate();
        let outcome = |i: usize| [Outcome::Left, Outcome::Tie, Outcome::Right][(i * i + i / 7) % 3];
        let asked = next.choose(answered().map(|(i, code)| (*code, outcome(i))), &planned, person);
        assert_eq!(asked, next.choose(answered().map(|(i, code)| (*code, outcome(i))), &planned, person));
        assert_eq!(asked.len(), planned.len());
        let kept = asked.iter().zip(&planned).filter(|(a, b)| a == b).count();
        assert!(kept >= planned.len() / 2, "{kept} of {}", planned.len());
        let offers: Vec<usize> = asked.iter().filter_map(|code| Some(next.of_code.get(code)?.0)).collect();
        let once: BTreeSet<usize> = offers.iter().copied().collect();
        assert_eq!(once.len(), offers.len(), "asked twice");
        let controls = |of: &[String]| -> Vec<usize> {
            (0..of.len()).filter(|&place| !next.of_code.contains_key(&of[place])).collect()
        };
        assert_eq!(controls(&asked), controls(&planned));
    }
}

/// Where all but one pair have been answered alike a thousand times, that pair is asked about.
#[test]
fn what_nobody_knows_is_asked() {
    let study = adaptive();
    let next = NextQuestions::of(&study).unwrap();
    let unknown = next.offers[0].items;
    let known = next.of_code.iter().filter(|(_, (offer, _))| next.offers[*offer].items != unknown);
    let answered: Vec<(&str, Outcome)> = known
        .flat_map(|(code, &(offer, is_turned))| {
            let [low, high] = next.offers[offer].items;
            // The unknown two are worth about the same; all others are told apart by their place.
            let lower_wins = (low < high) != is_turned;
            (0..60).map(move |i| {
                (code.as_str(), if (i % 4 == 0) == lower_wins { Outcome::Right } else { Outcome::Left })
            })
        })
        .collect();
    let mut asked = 0;
    for person in 0..12 {
        let planned = planned(&study, person);
        let chosen = next.choose(answered.iter().copied(), &planned, person);
        let is_unknown =
            |code: &String| next.of_code.get(code).is_some_and(|of| next.offers[of.0].items == unknown);
        asked += usize::from(chosen.iter().any(is_unknown));
    }
    assert_eq!(asked, 12);
}
