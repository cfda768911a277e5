//! Every contrast in one row: what a reader sees at a glance, as a figure and as a table.
//!
//! A contrast of two things is turned towards the one that more answers prefer over all objects, and so are its parts: rows
//! of the same two things can be compared.

use crate::hypotheses::{Hypothesis, On, Target};
use isostudy_design::contrast::Over;
use isostudy_design::{Level, Study};
use isostudy_statistics::interval::Interval;

/// One contrast.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// The hypothesis, by its place.
    pub hypothesis: usize,
    /// What is compared, the one that more answers prefer over all objects first: `integrated clustering`, `no clustering`.
    pub things: [String; 2],
    /// Where, without a space before it; empty for all answers.
    pub place: String,
    /// Whether it is over all answers that compare the two.
    pub is_whole: bool,
    /// Whether it is the difference of two shares, not a share.
    pub is_difference: bool,
    /// Answers for the first, without preference, for the second; a difference has none.
    pub answers: Option<[u64; 3]>,
    /// People who lean to the first, to neither, to the second.
    pub people: [u64; 3],
    /// The mean over people of the share of answers for the first, ties as halves, 0 to 1; the difference of two such shares,
    /// -1 to 1.
    pub share: f64,
    /// Its 95 % interval over people.
    pub interval: Option<Interval>,
    /// The sign-flip p, adjusted within its family.
    pub adjusted: f64,
}

impl Row {
    /// What is compared: `integrated clustering over no clustering`.
    pub fn pair(&self) -> String {
        self.things.join(" over ")
    }

    /// Whether more answers prefer the second: a part may go against the whole.
    pub fn is_against(&self) -> bool {
        !self.is_difference && self.share < 0.5
    }

    /// What is compared, and where.
    pub fn name(&self) -> String {
        let name = match self.place.as_str() {
            "" => self.pair(),
            place => format!("{}, {place}", self.pair()),
        };
        let mut letters = name.chars();
        letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
    }
}

/// The contrasts that were tested, the pooled ones of two things first and their parts after them; differences last.
pub fn rows(study: Option<&Study>, hypotheses: &[Hypothesis]) -> Vec<Row> {
    let is_contrast = |(_, h): &(usize, &Hypothesis)| h.is_tested() && !h.is_question();
    let tested: Vec<(usize, &Hypothesis)> = hypotheses.iter().enumerate().filter(is_contrast).collect();
    let mut pairs: Vec<(String, String)> = Vec::new();
    for (_, hypothesis) in &tested {
        let key = key(hypothesis);
        if !pairs.contains(&key) {
            pairs.push(key);
        }
    }
    let mut rows = Vec::new();
    for differences in [false, true] {
        for pair in &pairs {
            let own = || tested.iter().filter(|(_, h)| key(h) == *pair);
            let turned =
                own().find(|(_, h)| !h.is_difference()).is_some_and(|(_, whole)| whole.test.mean < 0.0);
            let mut parts: Vec<&(usize, &Hypothesis)> =
                own().filter(|(_, h)| h.is_difference() == differences).collect();
            parts.sort_by_key(|(_, h)| !is_whole(h));
            rows.extend(parts.into_iter().filter_map(|&(place, of)| row(study, place, of, turned)));
        }
    }
    rows
}

/// What tells two things that are compared from any other two.
fn key(hypothesis: &Hypothesis) -> (String, String) {
    let group = match &hypothesis.target {
        Target::Items { group, .. } => group.clone(),
        _ => String::new(),
    };
    (group, hypothesis.contrast.clone())
}

fn is_whole(hypothesis: &Hypothesis) -> bool {
    match &hypothesis.target {
        Target::Contrast { over, .. } => *over == Over::All,
        Target::Items { on, .. } => *on == On::All,
        Target::Question(_) => false,
    }
}

fn row(study: Option<&Study>, number: usize, hypothesis: &Hypothesis, turned: bool) -> Option<Row> {
    let test = &hypothesis.test;
    let ([mut first, mut second], place) = match (&hypothesis.target, study) {
        (Target::Contrast { levels, over }, Some(study)) => {
            (levels.map(|l| phrase(study, l)), place(study, *over))
        }
        (Target::Items { group, first, second, on }, _) => {
            let on = match on {
                On::All => String::new(),
                On::Object(object) => format!("on {object}"),
                On::Difference([one, other]) => format!("{one} rather than {other}"),
            };
            let place: Vec<String> =
                [on, format!("group {group}")].into_iter().filter(|part| !part.is_empty()).collect();
            ([first.clone(), second.clone()], place.join(", "))
        }
        _ => return None,
    };
    let is_difference = hypothesis.is_difference();
    let (mut answers, mut people, mut mean) = (test.counts, test.people(), test.mean);
    let mut interval = test.interval.map(|i| i.cut(-test.reach, test.reach));
    if turned {
        std::mem::swap(&mut first, &mut second);
        answers.iter_mut().for_each(|counts| counts.reverse());
        people.reverse();
        mean = -mean;
        interval = interval.map(|i| Interval { low: -i.high, high: -i.low });
    }
    // What is left of a mean score below rounding is zero; a share of it would print as 0.499999.
    let share = |score: f64| {
        let score = if score.abs() < 1e-12 { 0.0 } else { score };
        if is_difference { score / 2.0 } else { (1.0 + score) / 2.0 }
    };
    Some(Row {
        hypothesis: number,
        things: [first, second],
        place,
        is_whole: is_whole(hypothesis),
        is_difference,
        answers: answers.filter(|_| !is_difference),
        people,
        share: share(mean),
        interval: interval.map(|i| Interval { low: share(i.low), high: share(i.high) }),
        adjusted: hypothesis.adjusted,
    })
}

fn phrase(study: &Study, level: Level) -> String {
    study.level(level).phrase.clone()
}

fn place(study: &Study, over: Over) -> String {
    let object = |o: usize| study.file.objects[o].name.as_str();
    match over {
        Over::All => String::new(),
        Over::Within(level) => study.level(level).within.clone(),
        Over::Object(o) => format!("on the {}", object(o)),
        Over::Difference(a, b) => {
            let [a, b] = [a, b].map(|level| match study.level(level).label.as_str() {
                // "none" says nothing without its factor.
                "none" => study.level(level).phrase.clone(),
                label => label.to_owned(),
            });
            format!("{a} rather than {b}")
        }
        Over::ObjectDifference(a, b) => format!("{} rather than {}", object(a), object(b)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture;

    /// Counted from the published answers by hand: 92 for integrated clustering, 14 for none, 2 for neither.
    #[test]
    fn a_row_is_turned_towards_what_is_preferred() {
        let study = fixture::study();
        let rows = rows(Some(&study), &fixture::answered(&study).hypotheses);
        assert_eq!(rows.len(), 43);
        let of = |name: &str| {
            let found: Vec<&Row> = rows.iter().filter(|row| row.name() == name).collect();
            assert_eq!(found.len(), 1, "{name}");
            found[0]
        };
        let whole = of("Integrated clustering over no clustering");
        assert_eq!(whole.answers, Some([92, 2, 14]));
        // One person is one observation, and all have as many answers.
        assert!((whole.share - (92.0 + 1.0) / 108.0).abs() < 1e-12);
        assert_eq!(whole.people.iter().sum::<u64>(), 18);
        let answered = fixture::answered(&study);
        assert!(answered.hypotheses[whole.hypothesis].differs());
        let part = of("Edge collapse over no clustering, on the bunny");
        assert_eq!(part.answers, Some([28, 0, 8]));
        assert!(part.share > 0.5 && part.interval.unwrap().low > 0.5);
        assert!(!answered.hypotheses[part.hypothesis].differs());
        let against = of("The body-centred lattice over the simple cubic lattice, on the asteroid");
        assert_eq!(against.answers, Some([18, 9, 27]));
        assert!(against.share < 0.5 && against.interval.unwrap().high > 0.5);
        let difference =
            of("The body-centred lattice over the simple cubic lattice, sphere rather than bunny");
        let [sphere, bunny] = ["on the sphere", "on the bunny"].map(|place| {
            of(&format!("The body-centred lattice over the simple cubic lattice, {place}")).share
        });
        assert!((difference.share - (sphere - bunny)).abs() < 1e-12 && difference.answers.is_none());
    }

    #[test]
    fn turning_every_answer_round_changes_the_name_and_nothing_else() {
        let study = fixture::study();
        let mut answers = fixture::answers(&study);
        let before = rows(Some(&study), &crate::Answered::of(&study, answers.clone()).unwrap().hypotheses);
        for answer in &mut answers.answers {
            use isostudy_responses::Choice::*;
            answer.choice = match answer.choice {
                Left => Right,
                Right => Left,
                other => other,
            };
        }
        let after = rows(Some(&study), &crate::Answered::of(&study, answers).unwrap().hypotheses);
        for (one, other) in before.iter().zip(&after) {
            let [first, second] = &one.things;
            assert_eq!(other.pair(), format!("{second} over {first}"));
            assert_eq!((one.answers, one.people), (other.answers, other.people), "{}", one.name());
            assert!((one.share - other.share).abs() < 1e-12 && one.adjusted == other.adjusted);
        }
    }
}
