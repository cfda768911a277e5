//! Whether it matters on what screen people answered: exact tests of who or what was on one kind of screen against the rest.
//!
//! What belongs to a person's device divides people. Each person's share of answers is above, at or below the median of all
//! those people; if the device makes no difference, any of them could have had it, so that the number above less the number
//! below among those who had it is a draw without replacement ([`exchange`], one draw of people). What changes from answer to
//! answer divides each person's answers, and is a draw within each person ([`exchange`], a draw each). In both the person is
//! the unit, however much one person's answers hang together.

use isostudy_responses::{Answer, Choice, Responses, Screen};
use isostudy_statistics::{Split, exchange, holm};
use std::collections::{BTreeMap, BTreeSet};

/// Something that screens differ in.
#[derive(Debug, Clone, Copy)]
pub struct Condition {
    /// Its name in tables.
    pub name: &'static str,
    /// What one part of the answers was given on, and what the others.
    pub parts: [&'static str; 2],
    /// Whether it belongs to a person's device.
    of_person: bool,
    /// Whether an answer is of the first part; `None` where that was not recorded.
    first: fn(&Screen) -> Option<bool>,
}

/// Narrowest window, in CSS pixels, of what is no phone held upright.
const NARROW_PX: f32 = 600.0;
/// Surfaces below this many CSS pixels show little of facets.
const SMALL_PX: f32 = 300.0;
/// Screens of phones and of newer laptops have this many pixels for one of CSS.
const DENSE: f32 = 2.0;

/// Name of the condition that only studies with models have.
const MODELS: &str = "models";

/// All that are recorded.
pub const CONDITIONS: [Condition; 10] = [
    Condition {
        name: "window",
        parts: ["narrower than 600 px", "wider"],
        of_person: true,
        first: |screen| Some(screen.viewport_width? < NARROW_PX),
    },
    Condition {
        name: "surface",
        parts: ["narrower than 300 px", "wider"],
        of_person: true,
        first: |screen| Some(screen.surface_px? < SMALL_PX),
    },
    Condition {
        name: "pixel ratio",
        parts: ["2 or more", "below 2"],
        of_person: true,
        first: |screen| Some(screen.pixel_ratio? >= DENSE),
    },
    Condition {
        name: "layout",
        parts: ["stacked", "side by side"],
        of_person: true,
        first: |screen| Some(screen.layout? == "stacked"),
    },
    Condition {
        name: "input",
        parts: ["touch", "mouse, pen or keys"],
        of_person: true,
        first: |screen| Some(screen.input? == "touch"),
    },
    Condition {
        name: "shown as",
        parts: ["video", "animation"],
        of_person: true,
        first: |screen| match screen.shown_as? {
            "model" => None,
            kind => Some(kind != "gif"),
        },
    },
    Condition {
        name: MODELS,
        parts: ["models", "animation or video"],
        of_person: true,
        first: |screen| Some(screen.shown_as? == "model"),
    },
    Condition {
        name: "dropped frames",
        parts: ["some", "none"],
        of_person: false,
        first: |screen| Some(screen.dropped? > 0.0),
    },
    Condition {
        name: "out of sight",
        parts: ["for a time", "never"],
        of_person: false,
        first: |screen| Some(screen.hidden_ms? > 0.0),
    },
    Condition {
        name: "turning",
        parts: ["models turned", "not turned"],
        of_person: false,
        first: |screen| Some(screen.turned_deg? > 0.0),
    },
];

/// How far people turned models, over the answers to comparisons.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turned {
    /// People who were shown models.
    pub people: usize,
    /// Their answers.
    pub answers: usize,
    /// Those of them before which the models were turned.
    pub turned: usize,
    /// Lower quartile, median and upper quartile of the degrees of those that were turned, there and back; `None` of none.
    pub quartiles_deg: Option<[f64; 3]>,
}

/// How far people turned models; `None` where nobody was shown any.
pub fn turned(answers: &Responses) -> Option<Turned> {
    let asked = |answer: &&Answer| answers.questions[answer.question as usize].is_comparison();
    let degrees =
        |answer: &Answer| Some((answer.participant, f64::from(answers.screen(answer)?.turned_deg?)));
    let shown: Vec<(u32, f64)> = answers.answers.iter().filter(asked).filter_map(degrees).collect();
    if shown.is_empty() {
        return None;
    }
    let people: BTreeSet<u32> = shown.iter().map(|(person, _)| *person).collect();
    let mut far: Vec<f64> =
        shown.iter().map(|(_, degrees)| *degrees).filter(|degrees| *degrees > 0.0).collect();
    far.sort_by(f64::total_cmp);
    let quartile = |quarter: usize| {
        // Between the two nearest in the order, in proportion: the seventh definition of Hyndman and Fan (1996).
        let (place, rest) = ((far.len() - 1) * quarter / 4, (far.len() - 1) * quarter % 4);
        let next = far[(place + 1).min(far.len() - 1)];
        far[place] + (next - far[place]) * rest as f64 / 4.0
    };
    Some(Turned {
        people: people.len(),
        answers: shown.len(),
        turned: far.len(),
        quartiles_deg: (!far.is_empty()).then(|| [1, 2, 3].map(quartile)),
    })
}

/// What is compared between the parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// Answers without preference.
    Ties,
    /// Answers like those of most others to the question.
    Agreement,
}

impl Measure {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Ties, Self::Agreement];

    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ties => "no preference",
            Self::Agreement => "as most others",
        }
    }
}

/// One test.
#[derive(Debug, Clone)]
pub struct Compared {
    /// What divides the answers.
    pub condition: Condition,
    /// What is compared.
    pub measure: Measure,
    /// People of each part; where answers of each person are divided, people with answers of that part.
    pub people: [usize; 2],
    /// Answers of each part.
    pub answers: [usize; 2],
    /// Share of them of which the measure speaks.
    pub shares: [Option<f64>; 2],
    /// Two-sided; `None` where there is nothing to compare.
    pub p: Option<f64>,
    /// The same by Holm, over all that are tested.
    pub adjusted: Option<f64>,
}

/// An answer to a comparison: whose, on what, and what the measures say of it: 1 for it, -1 against it, 0 neither.
struct Judged {
    participant: u32,
    screen: Screen,
    ties: i64,
    agreement: i64,
}

impl Judged {
    fn of(&self, measure: Measure) -> i64 {
        match measure {
            Measure::Ties => self.ties,
            Measure::Agreement => self.agreement,
        }
    }
}

/// Every test that the recorded screens allow; empty where none was recorded. Answers to controls and repeats are left out.
pub fn compared(answers: &Responses) -> Vec<Compared> {
    let judged = judged(answers);
    let mut found: Vec<Compared> = CONDITIONS
        .iter()
        .flat_map(|condition| Measure::ALL.map(|measure| compare(&judged, *condition, measure)))
        .filter(|of| of.answers.iter().sum::<usize>() > 0)
        // Of a study without models there is nothing to say about them.
        .filter(|of| of.condition.name != MODELS || of.answers[0] > 0)
        .collect();
    let p: Vec<f64> = found.iter().filter_map(|of| of.p).collect();
    let mut adjusted = holm(&p).into_iter();
    for of in &mut found {
        of.adjusted = of.p.and_then(|_| adjusted.next());
    }
    found
}

fn judged(answers: &Responses) -> Vec<Judged> {
    let asked = |answer: &&Answer| answers.questions[answer.question as usize].is_comparison();
    // For the item that the question declares first less for the other.
    let sign = |answer: &Answer| match answers.declared_choice(answer) {
        Choice::Left => 1_i64,
        Choice::NoPreference => 0,
        Choice::Right => -1,
    };
    let mut net: BTreeMap<u32, i64> = BTreeMap::new();
    for answer in answers.answers.iter().filter(asked) {
        *net.entry(answer.question).or_insert(0) += sign(answer);
    }
    let judge = |answer: &Answer| {
        let own = sign(answer);
        Some(Judged {
            participant: answer.participant,
            screen: *answers.screen(answer)?,
            ties: if own == 0 { 1 } else { -1 },
            agreement: own * (net[&answer.question] - own).signum(),
        })
    };
    answers.answers.iter().filter(asked).filter_map(judge).collect()
}

fn compare(judged: &[Judged], condition: Condition, measure: Measure) -> Compared {
    // By person, what the measure says of the answers of each part.
    let mut by_person: BTreeMap<u32, [Vec<i64>; 2]> = BTreeMap::new();
    for answer in judged {
        if let Some(first) = (condition.first)(&answer.screen) {
            by_person.entry(answer.participant).or_default()[usize::from(!first)].push(answer.of(measure));
        }
    }
    let people: Vec<[Vec<i64>; 2]> = by_person
        .into_values()
        .map(|parts| if condition.of_person { whole(parts) } else { parts })
        .filter(|parts| parts.iter().any(|part| !part.is_empty()))
        .collect();
    let of_part = |part: usize| people.iter().map(move |parts| &parts[part]);
    let parts = [0, 1];
    let answers = parts.map(|part| of_part(part).map(Vec::len).sum::<usize>());
    let shares = parts.map(|part| {
        let with = of_part(part).flatten().filter(|&&said| said > 0).count();
        (answers[part] > 0).then(|| with as f64 / answers[part] as f64)
    });
    let splits: Vec<Split> = if condition.of_person { vec![of_people(&people)] } else { within(&people) };
    let compares = |split: &Split| {
        let [own, all] = [split.own, split.all].map(|counts| counts.iter().sum::<u64>());
        own > 0 && own < all
    };
    Compared {
        condition,
        measure,
        people: parts.map(|part| of_part(part).filter(|answers| !answers.is_empty()).count()),
        answers,
        shares,
        p: splits.iter().any(compares).then(|| exchange(&splits)),
        adjusted: None,
    }
}

/// A person's answers as those of the part that most of them are of; of nobody's where there are as many of each.
fn whole([first, second]: [Vec<i64>; 2]) -> [Vec<i64>; 2] {
    match first.len().cmp(&second.len()) {
        std::cmp::Ordering::Greater => [[first, second].concat(), Vec::new()],
        std::cmp::Ordering::Equal => [Vec::new(), Vec::new()],
        std::cmp::Ordering::Less => [Vec::new(), [first, second].concat()],
    }
}

/// People above, at and below the median of all of them: those of the first part, and all.
fn of_people(people: &[[Vec<i64>; 2]]) -> Split {
    // Sums and numbers are small whole numbers, so that equal means are equal to the bit.
    let mean = |parts: &[Vec<i64>; 2]| {
        let all = parts.iter().flatten();
        all.clone().sum::<i64>() as f64 / all.count() as f64
    };
    let means: Vec<f64> = people.iter().map(mean).collect();
    let mut sorted = means.clone();
    sorted.sort_by(f64::total_cmp);
    let Some(last) = sorted.len().checked_sub(1) else { return Split::default() };
    // The one in the middle, or the mean of the two.
    let median = (sorted[last / 2] + sorted[last.div_ceil(2)]) / 2.0;
    let mut split = Split::default();
    for (parts, mean) in people.iter().zip(means) {
        let place = 1 - usize::from(mean > median) + usize::from(mean < median);
        split.all[place] += 1;
        split.own[place] += u64::from(!parts[0].is_empty());
    }
    split
}

/// Each person's answers of the first part, and all.
fn within(people: &[[Vec<i64>; 2]]) -> Vec<Split> {
    let count = |said: &[i64]| {
        let mut counts = [0; 3];
        said.iter().for_each(|&said| counts[(1 - said) as usize] += 1);
        counts
    };
    people
        .iter()
        .map(|[first, second]| Split { own: count(first), all: count(&[&first[..], second].concat()) })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_pcg::Pcg64;
    use rand_pcg::rand_core::{Rng, SeedableRng};

    const LONG: &str = "participant,question,left,right,choice,viewport_width,pixel_ratio,dropped,input";

    fn read(rows: &[String]) -> Responses {
        let text = format!("{LONG}\n{}\n", rows.join("\n"));
        let path = std::path::Path::new("answers.csv");
        isostudy_responses::parse(text.as_bytes(), path, None, &isostudy_responses::Mapping::default())
            .unwrap()
            .responses
    }

    fn find(found: &[Compared], name: &str, measure: Measure) -> Compared {
        let of = |of: &&Compared| of.condition.name == name && of.measure == measure;
        found.iter().find(of).unwrap().clone()
    }

    #[test]
    fn people_with_phones_who_decide_less_are_found_exactly() {
        // Five on phones never decide, five on desks always do: by counting, 2 of C(10, 5) = 252 divisions are as uneven.
        let row = |person: usize, question: usize| {
            let (choice, width) = if person < 5 { ("none", 390) } else { ("left", 1280) };
            format!("p{person},q{question},a,b,{choice},{width},1,0,mouse")
        };
        let rows: Vec<String> = (0..10).flat_map(|person| (0..4).map(move |q| row(person, q))).collect();
        let found = compared(&read(&rows));
        let ties = find(&found, "window", Measure::Ties);
        assert_eq!((ties.people, ties.answers), ([5, 5], [20, 20]));
        assert_eq!(ties.shares, [Some(1.0), Some(0.0)]);
        assert!((ties.p.unwrap() - 2.0 / 252.0).abs() < 1e-12, "{:?}", ties.p);
        // Everybody had a mouse: nothing to compare.
        let input = find(&found, "input", Measure::Ties);
        assert_eq!((input.people, input.p, input.adjusted), ([0, 10], None, None));
        // Who decides agrees with those who do, who does not with nobody: as uneven.
        let agreement = find(&found, "window", Measure::Agreement);
        assert!((agreement.p.unwrap() - 2.0 / 252.0).abs() < 1e-12);
        // Two tests are made, and corrected together.
        assert_eq!(found.iter().filter(|of| of.p.is_some()).count(), 2);
        assert!((ties.adjusted.unwrap() - 4.0 / 252.0).abs() < 1e-12);
    }

    #[test]
    fn dropped_frames_are_compared_within_each_person() {
        // Three people; of four answers each the one with dropped frames is the one without preference. By counting, each
        // draws it with chance 1 / 4, so all three with 1 / 64; all three another one, which is nearer, is less far.
        let row = |person: usize, question: usize| {
            let (choice, dropped) = if question == person { ("none", 7) } else { ("left", 0) };
            format!("p{person},q{question},a,b,{choice},1280,1,{dropped},mouse")
        };
        let rows: Vec<String> = (0..3).flat_map(|person| (0..4).map(move |q| row(person, q))).collect();
        let ties = find(&compared(&read(&rows)), "dropped frames", Measure::Ties);
        assert_eq!((ties.people, ties.answers), ([3, 3], [3, 9]));
        assert!((ties.p.unwrap() - 1.0 / 64.0).abs() < 1e-12, "{:?}", ties.p);
    }

    #[test]
    fn a_person_with_two_screens_is_of_the_one_of_most_answers() {
        let row = |question: usize, width: u32| format!("p,q{question},a,b,left,{width},1,0,mouse");
        let of = |widths: &[u32]| {
            let rows: Vec<String> = widths.iter().enumerate().map(|(q, &width)| row(q, width)).collect();
            let found = find(&compared(&read(&rows)), "pixel ratio", Measure::Ties);
            let window = compared(&read(&rows)).into_iter().find(|of| of.condition.name == "window");
            (found.people, window.map(|window| (window.people, window.answers)))
        };
        assert_eq!(of(&[390, 390, 1280]), ([0, 1], Some(([1, 0], [3, 0]))));
        assert_eq!(of(&[390, 1280]), ([0, 1], None));
    }

    /// Forty people answer twelve questions, and turn the models before half of the answers. `sees` is the chance to choose
    /// the better side, after turning and without.
    fn of_turners(seed: u64, sees: [f64; 2]) -> Vec<Compared> {
        let mut chance = Pcg64::seed_from_u64(seed);
        let mut below = |share: f64| ((chance.next_u64() >> 11) as f64) < share * (1u64 << 53) as f64;
        let mut text = "participant,question,left,right,choice,shown_as,turned_deg\n".to_owned();
        for (person, question) in (0..40).flat_map(|person| (0..12).map(move |question| (person, question))) {
            let is_turned = below(0.5);
            let choice = if below(sees[usize::from(!is_turned)]) { "left" } else { "right" };
            let degrees = if is_turned { 120 + person } else { 0 };
            text.push_str(&format!("p{person},q{question},a,b,{choice},model,{degrees}\n"));
        }
        let path = std::path::Path::new("answers.csv");
        let read =
            isostudy_responses::parse(text.as_bytes(), path, None, &isostudy_responses::Mapping::default());
        compared(&read.unwrap().responses)
    }

    #[test]
    fn turning_that_changes_the_choice_comes_out_and_turning_that_does_not_rarely_does() {
        let p = |found: &[Compared]| find(found, "turning", Measure::Agreement).p.unwrap();
        // Who turns sees the difference in nine of ten, who does not guesses.
        for seed in 0..20 {
            let found = of_turners(seed, [0.9, 0.5]);
            let agreement = find(&found, "turning", Measure::Agreement);
            assert!(
                agreement.p.unwrap() < 1e-6 && agreement.shares[0] > agreement.shares[1],
                "{agreement:?}"
            );
            assert_eq!(agreement.people, [40, 40]);
        }
        // Turning changes nothing: an exact test at 0.05 errs in no more than 5 of 100, here of 200, with three standard errors.
        let wrong = (0..200).filter(|seed| p(&of_turners(1000 + seed, [0.7, 0.7])) <= 0.05).count();
        assert!(wrong <= 10 + 9, "{wrong} of 200");
        assert!(wrong > 0, "a test that never errs finds nothing");
    }

    #[test]
    fn how_far_people_turned_is_of_those_who_turned() {
        let text = "participant,question,left,right,choice,shown_as,turned_deg\np,q1,a,b,left,model,90\n\
                    p,q2,a,b,left,model,0\np,q3,a,b,left,gif,\nr,q1,a,b,left,model,30\nr,q2,a,b,left,model,60\n";
        let path = std::path::Path::new("answers.csv");
        let read =
            isostudy_responses::parse(text.as_bytes(), path, None, &isostudy_responses::Mapping::default());
        let responses = read.unwrap().responses;
        let expected = Turned { people: 2, answers: 4, turned: 3, quartiles_deg: Some([45.0, 60.0, 75.0]) };
        assert_eq!(turned(&responses), Some(expected));
        // A person is of the kind of most answers: the one animation goes with the person's models.
        let found = compared(&responses);
        assert!(found.iter().any(|of| of.condition.name == "models" && of.answers == [5, 0]));
        assert!(turned(&read_none()).is_none());
    }

    fn read_none() -> Responses {
        read(&["p,q,a,b,left,1280,1,0,mouse".into()])
    }

    #[test]
    fn nothing_is_said_of_files_without_screens() {
        let path = std::path::Path::new("answers.csv");
        let text = "participant,question,left,right,choice\np,q,a,b,left\n";
        let read =
            isostudy_responses::parse(text.as_bytes(), path, None, &isostudy_responses::Mapping::default())
                .unwrap();
        assert!(read.responses.screens.is_empty() && compared(&read.responses).is_empty());
    }
}
