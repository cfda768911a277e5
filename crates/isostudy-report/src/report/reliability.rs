//! How much the answers can bear: agreement, consistency, outlying respondents, single questions.

use super::evidence::Evidence;
use super::names;
use super::told::named;
use crate::statement::Block;
use crate::statement::{Finding, Standing};
use crate::words::{counted, interval, list, number, p, percent};
use isostudy_inference::agreement::Agreement;
use isostudy_inference::hypotheses::Hypothesis;
use isostudy_inference::leave_one_out::WithoutOne;
use isostudy_statistics::{Alpha, Screening, Triads, sign_test};
use statrs::distribution::{Binomial, DiscreteCDF};

/// Names of so many people are printed at most.
const NAMED: usize = 8;

pub(super) fn findings(evidence: &Evidence<'_>) -> Vec<Block> {
    let agreement = evidence.preferences.and_then(|of| of.agreement.first());
    let mut found: Vec<Finding> =
        agreement.map(|of| unanimity(of, evidence.rules().level)).into_iter().collect();
    found.extend(agreement.and_then(|of| consistency(&of.triads, evidence.rules().level)));
    found.extend(one_by_one(evidence));
    found.extend(outlying(evidence));
    found.extend(single_questions(evidence));
    found.into_iter().map(Block::Finding).collect()
}

fn unanimity(agreement: &Agreement, level: f64) -> Finding {
    let of = |alpha: Option<Alpha>| {
        let within = alpha?.interval.map_or(String::new(), |i| format!(" ({})", interval(i, 2)));
        Some(format!("{}{within}", number(alpha?.value, 2)))
    };
    let over = counted(agreement.questions, "question");
    let mut text = match (of(agreement.nominal), of(agreement.ordinal)) {
        (Some(nominal), Some(ordinal)) => format!(
            "Krippendorff's alpha over {over} is {nominal} nominal and {ordinal} ordinal; 1 is full agreement, 0 what chance gives. In brackets: \
             95 % intervals over participants.",
        ),
        _ => format!(
            "Krippendorff's alpha over {over} has no value: nobody answered what another did, or all answers are the same.",
        ),
    };
    let kendall = agreement.kendall.and_then(|found| found.test.map(|test| (found.u, test)));
    let Some((u, test)) = kendall else { return Finding::new(Standing::Noted, text) };
    let verdict = match test.p <= level {
        true => "People agree more than chance would have it",
        false => "That people agree more than chance would have it is not shown",
    };
    text.push_str(&format!(
        " {verdict}: Kendall's u = {}, chi-square {} on {:.1} degrees of freedom, {}.",
        number(u, 2),
        number(test.statistic, 1),
        test.degrees,
        p(test.p)
    ));
    Finding::new(Standing::Noted, text)
}

fn consistency(sum: &Triads, level: f64) -> Option<Finding> {
    if sum.decided == 0 {
        return None;
    }
    let chance = Binomial::new(0.25, sum.decided).expect("a chance and a number").cdf(sum.strict_cycles);
    // One person's triads hang together, so that this is no result about people.
    let verdict = match chance <= level {
        true => "People contradict themselves less than answers by chance would",
        false => "That people contradict themselves less than answers by chance would is not shown",
    };
    let weak = match sum.weak_cycles {
        1 => "1 more is".into(),
        weak => format!("{weak} more are"),
    };
    let cycles = if sum.strict_cycles == 1 { "1 goes".into() } else { format!("{} go", sum.strict_cycles) };
    let decided = if sum.decided == 1 { "1 was".into() } else { format!("{} were", sum.decided) };
    let text = format!(
        "{verdict}: of {} of three items, {decided} decided throughout, and {cycles} in a circle; answers by chance would \
         give {} (a quarter; one-sided binomial test as if triads were independent, {}). {weak} two wins closed by no preference, which need not be a \
         contradiction.",
        counted(sum.all as usize, "triad"),
        number(sum.cycles_by_chance(), 1),
        p(chance)
    );
    Some(Finding::new(Standing::Noted, text))
}

/// Does a result hang on one person? Judged as results are: by the corrected p, with the correction done anew.
fn one_by_one(evidence: &Evidence<'_>) -> Option<Finding> {
    let level = evidence.rules().level;
    let all = evidence.preferences?.without_one.iter().map(|(i, of)| (&evidence.hypotheses[*i], of));
    let holding: Vec<(&Hypothesis, &WithoutOne)> = all.filter(|(of, _)| of.differs()).collect();
    let largest = holding.iter().map(|(_, of)| of.largest).max_by(f64::total_cmp)?;
    let fragile: Vec<String> = holding
        .iter()
        .filter(|(_, of)| of.largest > level)
        .map(|(hypothesis, of)| {
            let name = names::hypothesis(evidence, hypothesis);
            let mut people: Vec<String> =
                of.undone_by.iter().take(NAMED).map(|person| (person + 1).to_string()).collect();
            if of.undone_by.len() > NAMED {
                people.push(format!("{} more", of.undone_by.len() - NAMED));
            }
            let (who, any) = match of.undone_by.len() {
                1 => ("participant", ""),
                _ => ("participants", ", any one"),
            };
            format!("{name} ({who} {}{any}; {})", list(&people), p(of.largest))
        })
        .collect();
    let results = counted(holding.len(), "result");
    Some(match fragile.is_empty() {
        true => Finding::new(
            Standing::Holds,
            format!(
                "No result hangs on one person. With any one participant left out and the correction done anew, {} (largest \
                 corrected {}).",
                match holding.len() {
                    1 => "the one result that holds still does".into(),
                    _ => format!("each of the {results} that hold still does"),
                },
                p(largest)
            ),
        ),
        false => Finding::new(
            Standing::Open,
            format!(
                "Of the {results} that {}, {} would not hold without some one participant, the correction done anew: {}.",
                if holding.len() == 1 { "holds" } else { "hold" },
                fragile.len(),
                named(&fragile)
            ),
        ),
    })
}

/// Who answers against the others, and what the results are without them.
fn outlying(evidence: &Evidence<'_>) -> Vec<Finding> {
    let Some(majorities) = evidence.preferences.map(|of| &of.majorities) else { return Vec::new() };
    let [outlying, others] = majorities.judged();
    let range = |of: &[(&Screening, f64)]| {
        let shares = of.iter().map(|(_, share)| *share);
        let (low, high) = (shares.clone().fold(1.0, f64::min), shares.fold(0.0, f64::max));
        format!("{} to {}", percent(low).trim_end_matches(" %"), percent(high))
    };
    if outlying.is_empty() && others.is_empty() {
        return Vec::new();
    }
    if outlying.is_empty() {
        let text = format!(
            "Nobody stands out: every participant's decided answers side with the majority of the others' in {} of the \
             questions that have one.",
            range(&others)
        );
        return vec![Finding::new(Standing::Noted, text)];
    }
    // Where most are, the majorities are by an answer or two, and tell nobody apart.
    if outlying.len() > others.len() {
        let text = format!(
            "Agreement tells nobody apart: {} of {} side with the majority of the others less often than against it, so majorities \
             are thin.",
            outlying.len(),
            counted(outlying.len() + others.len(), "participant")
        );
        return vec![Finding::new(Standing::Noted, text)];
    }
    let one = |(s, share): &(&Screening, f64)| {
        format!("{} ({} of {}, {})", s.participant + 1, s.agreeing, s.comparable, percent(*share))
    };
    let mut names: Vec<String> = outlying.iter().take(NAMED).map(one).collect();
    if outlying.len() > NAMED {
        names.push(format!("{} more", outlying.len() - NAMED));
    }
    let who = if outlying.len() == 1 { "Participant" } else { "Participants" };
    let verb = if outlying.len() == 1 { "answers" } else { "answer" };
    let rest = match others.is_empty() {
        true => String::new(),
        false => format!("; everybody else sides with it in {}", range(&others)),
    };
    let text = format!(
        "{who} {} {verb} against the majority of the others more often than with it{rest}. This was seen after the outcome: a \
         reason to look, not to exclude.",
        list(&names)
    );
    let mut found = vec![Finding::new(Standing::Noted, text)];
    found.push(without(evidence, &majorities.without_outlying, outlying.len()));
    found
}

/// What the tests are without so many people.
fn without(evidence: &Evidence<'_>, again: &[(usize, Hypothesis)], left_out: usize) -> Finding {
    let changed: Vec<String> = again
        .iter()
        .map(|(i, without)| (&evidence.hypotheses[*i], without))
        .filter(|(with, without)| with.differs() != without.differs())
        .map(|(with, without)| {
            let becomes = if without.differs() { "then holds" } else { "no longer holds" };
            format!(
                "{} {becomes} (corrected {}, before {})",
                names::hypothesis(evidence, with),
                p(without.adjusted),
                p(with.adjusted)
            )
        })
        .collect();
    let whom = if left_out == 1 { "this participant" } else { "these participants" };
    let tests = counted(again.len(), "test");
    let text = match changed.is_empty() {
        _ if again.is_empty() => format!("Without {whom} there is nothing to test."),
        true => format!("Without {whom}, none of the {tests} comes out otherwise."),
        false => format!(
            "Without {whom}, {} of the {tests} {} out otherwise: {}. Everything else in this report is with {}.",
            changed.len(),
            if changed.len() == 1 { "comes" } else { "come" },
            list(&changed),
            if left_out == 1 { "that person" } else { "them" }
        ),
    };
    Finding::new(Standing::Noted, text)
}

fn single_questions(evidence: &Evidence<'_>) -> Option<Finding> {
    let all: Vec<&Hypothesis> = evidence.hypotheses.iter().filter(|h| h.is_question()).collect();
    let holding: Vec<&str> = all.iter().filter(|h| h.differs()).map(|h| h.scope.as_str()).collect();
    let asked = all.iter().filter(|h| h.test.participants() > 0).count();
    let bare = |h: &&&Hypothesis| match h.test.counts {
        Some([a, _, b]) => sign_test::binomial(a, b) <= h.rules.level,
        None => false,
    };
    let names = match holding.is_empty() {
        true => String::new(),
        false => format!(": {}", list(&holding)),
    };
    (asked > 0).then(|| {
        let text = format!(
            "Of {}, {} a preference by Benjamini and Hochberg's correction of the sign tests{names}. {} would without \
             correction. These are exploratory.",
            counted(asked, "single question"),
            match holding.len() {
                1 => "1 shows".into(),
                n => format!("{n} show"),
            },
            all.iter().filter(bare).count()
        );
        Finding::new(Standing::Noted, text)
    })
}
