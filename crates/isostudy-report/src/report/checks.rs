//! Checks of the answers: who broke a rule of screening and what the tests are without them, what probes found, and whether
//! screens mattered.

use super::evidence::Evidence;
use super::{names, screens};
use crate::evidence_of_probes;
use crate::statement::Block;
use crate::statement::{Finding, Standing};
use crate::words::{counted, list, numbers, of_all, p as p_value, people};
use isostudy_inference::Preferences;
use isostudy_inference::audit::{ALARM, Evidence as Seen, Finding as Probed, Probe, Report};
use isostudy_inference::conclusions::About;
use isostudy_inference::hypotheses::Hypothesis;
use isostudy_inference::screened::{Respondent, WithoutBreakers};
use isostudy_statistics::{Flag, Screening};

/// Tests named at most.
const NAMED: usize = 6;

pub(super) fn findings(evidence: &Evidence<'_>) -> Vec<Block> {
    let Some(preferences) = evidence.preferences else { return Vec::new() };
    let mut found = Vec::new();
    if !preferences.respondents.is_empty() {
        found.push(screened(evidence, &preferences.respondents));
    }
    let without = preferences.screened.iter().filter(|of| !of.tests.is_empty());
    found.extend(without.map(|of| without_breakers(evidence, of)));
    found.extend(preferences.audit.iter().map(|report| probed(preferences, report)));
    found.extend(screens::finding(&preferences.screens, evidence.rules().level));
    found.extend(preferences.turned.as_ref().map(screens::turning));
    found.into_iter().map(Block::Finding).collect()
}

/// Whether nobody could answer "no preference", so that controls show nothing of a person.
fn is_forced(evidence: &Evidence<'_>) -> bool {
    let forms = evidence.study.and_then(|study| study.file.forms.as_ref());
    forms.is_some_and(|forms| !forms.way.has_ties())
}

/// Something that is counted of each participant.
type Count = fn(&Screening) -> u64;

fn sum(respondents: &[Respondent], count: Count) -> u64 {
    respondents.iter().map(|of| count(&of.seen)).sum()
}

/// Answers to controls.
pub(super) fn controls(preferences: &Preferences<'_>) -> u64 {
    sum(&preferences.respondents, |seen| seen.controls)
}

/// How many broke which rule, and what was there to judge.
fn screened(evidence: &Evidence<'_>, respondents: &[Respondent]) -> Finding {
    let all = respondents.len();
    let broken = respondents.iter().filter(|of| !of.flags.is_empty()).count();
    let breakers = |rule: Flag| respondents.iter().filter(|of| of.flags.contains(&rule)).count();
    let rule = |flag: &Flag| {
        let own = breakers(*flag);
        (own > 0).then(|| format!("{own} by {}", broken_by(*flag)))
    };
    let rules: Vec<String> = Flag::ALL.iter().filter_map(rule).collect();
    let kinds: [(&str, &str, Count); 3] = [
        ("controls", "control", |seen| seen.controls),
        ("repeats", "repeat", |seen| seen.repeats),
        ("times", "timed answer", |seen| seen.timed),
    ];
    let (mut judged, mut absent) = (Vec::new(), Vec::new());
    let seen = evidence.preferences.map_or(&[][..], |of| &of.majorities.seen);
    let of = |rule: &str, number: usize| match number {
        n if n == seen.len() => rule.to_owned(),
        n => format!("{rule} of {}", counted(n, "participant")),
    };
    // The rule sees repeats and controls as well, and so may judge people whom comparisons alone do not.
    let by_comparisons = seen.iter().filter(|of| of.tells_sides() && of.answers[0] + of.answers[2] >= 10);
    match by_comparisons.count().max(breakers(Flag::OneSided)) {
        0 => absent.push("one-sidedness"),
        n => judged.push(of("one-sidedness", n)),
    }
    match seen.iter().filter(|of| of.outlying_p.is_some()).count() {
        0 => absent.push("agreement"),
        n => judged.push(of("agreement", n)),
    }
    for (name, noun, count) in kinds {
        match sum(respondents, count) {
            _ if name == "controls" && is_forced(evidence) => {}
            0 => absent.push(name),
            n => judged.push(counted(n as usize, noun)),
        }
    }
    // Who answered controls alone is no participant of any other section.
    let others = match all.saturating_sub(seen.len()) {
        0 => String::new(),
        1 => ", 1 of whom compared nothing,".into(),
        n => format!(", {n} of whom compared nothing,"),
    };
    let who = match broken {
        0 => format!("None of {}{others} broke", counted(all, "participant")),
        _ => format!("{broken} of {}{others} broke", counted(all, "participant")),
    };
    let which = if rules.is_empty() { String::new() } else { format!(" ({})", list(&rules)) };
    let mut text = format!(
        "{who} a rule of screening{which}. {}.{}",
        match evidence.excluded {
            0 => "Nobody is left out of any other part of this report".to_owned(),
            1 => "1 of them is left out of every other part of this report".to_owned(),
            n => format!("{n} of them are left out of every other part of this report"),
        },
        if judged.is_empty() { String::new() } else { format!(" Judged: {}.", list(&judged)) }
    );
    if !absent.is_empty() {
        text.push_str(&format!(" Not judged, because the answers do not tell: {}.", list(&absent)));
    }
    Finding::new(Standing::Noted, text)
}

/// How a rule is broken.
fn broken_by(flag: Flag) -> &'static str {
    match flag {
        Flag::OneSided => "choosing one side throughout",
        Flag::Controls => "deciding between equals",
        Flag::Repeats => "choosing otherwise when asked again",
        Flag::Time => "answering faster than anybody can look",
        Flag::Outlying => "answering against the others",
    }
}

/// In short, what is decided otherwise without those who broke a rule of screening, of so many people. A study in which
/// everybody broke one has nobody left to compare with.
pub(super) fn without_them(of: &WithoutBreakers, all: usize) -> String {
    let broken = of.people.len();
    if !of.leaves_somebody() {
        let who = match broken == all {
            true if all == 2 => "Both people".into(),
            true => format!("All {}", people(all)),
            false => format!("{broken} of {}", people(all)),
        };
        return format!("{who} broke a rule of screening, so that nobody is left to compare them with.");
    }
    let changes = of.changes();
    let kinds = [
        (&changes.turned, ["holds", "hold"], "in the other direction"),
        (&changes.undecided, ["becomes", "become"], "undecided with fewer people"),
        (&changes.decided, ["holds", "hold"], "only then"),
    ];
    let mut parts: Vec<String> = Vec::new();
    for (tested, [one, more], how) in kinds.into_iter().filter(|(tested, ..)| !tested.is_empty()) {
        let does = match parts.is_empty() {
            true => of_all(tested.len(), of.tests.len(), "contrast", [one, more]),
            false => format!("{} {}", tested.len(), if tested.len() == 1 { one } else { more }),
        };
        parts.push(format!("{does} {how}"));
    }
    if parts.is_empty() {
        parts.push(format!("none of {} is decided otherwise", counted(of.tests.len(), "contrast")));
    }
    format!("{broken} of {} broke a rule of screening. Without them, {}.", people(all), list(&parts))
}

/// The tests that are decided otherwise without those who broke a rule.
fn without_breakers(evidence: &Evidence<'_>, of: &WithoutBreakers) -> Finding {
    let noun = if of.people.len() == 1 { "Participant" } else { "Participants" };
    let own = numbers(&of.people, ", ");
    let rule = of.rule.map_or("some rule".into(), |flag| format!("a rule by {}", broken_by(flag)));
    let who = format!("{noun} {own} broke {rule}");
    if !of.leaves_somebody() {
        let text = format!("{who}. Nobody is left without them, so nothing is compared.");
        return Finding::new(Standing::Noted, text);
    }
    let changes = of.changes();
    let name = |tested: &&Hypothesis| names::hypothesis(evidence, tested);
    let part = |what: &str, tested: &[&Hypothesis]| {
        let mut named: Vec<String> = tested.iter().take(NAMED).map(name).collect();
        if tested.len() > NAMED {
            named.push(format!("{} more", tested.len() - NAMED));
        }
        (!tested.is_empty()).then(|| format!(" {what}: {}.", list(&named)))
    };
    let parts = [
        part("In the other direction", &changes.turned),
        part("Undecided with fewer people", &changes.undecided),
        part("Decided only then", &changes.decided),
    ];
    let tests = counted(of.tests.len(), "test");
    let outcome = match changes.number() {
        0 => format!("none of {tests} is decided otherwise"),
        n => format!("{n} of {tests} {} decided otherwise", if n == 1 { "is" } else { "are" }),
    };
    let parts: String = parts.into_iter().flatten().collect();
    Finding::new(Standing::Noted, format!("{who}: without them, {outcome}.{parts}"))
}

/// What a probe found. One that found nothing says at which level, since contrasts have another.
fn probed(preferences: &Preferences<'_>, report: &Report) -> Finding {
    let Report { probe, finding, p, evidence } = report;
    let question = probe.question();
    if let Seen::NotAnswerable(why) = evidence {
        let text = format!("{question} Not answerable here, because {}.", evidence_of_probes::reason(why));
        return Finding::new(Standing::NotAnswerable, text);
    }
    let depends = || preferences.conclusions.all.iter().any(|of| matches!(of.about, About::Object(_)));
    let word = match finding {
        Probed::Found => "Found".into(),
        _ if p.is_none() => "Not found".into(),
        _ if *probe == Probe::ObjectInteraction && depends() => {
            format!(
                "The contrasts above say that they do. No comparison alone shows it at the level of {ALARM}"
            )
        }
        _ => format!("Not found at the level of {ALARM}"),
    };
    let p = p.map_or(String::new(), |p| format!(" ({})", p_value(p)));
    Finding::new(
        Standing::Noted,
        format!("{question} {word}: {}{p}.", evidence_of_probes::evidence(evidence)),
    )
}
