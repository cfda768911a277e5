//! The numbers in the report's sentences.
//!
//! Where a sentence counts answers for one thing against another, the words before the counts say for which: names of values
//! in the order in which they are counted, then where. Wording apart from these names does not matter.

use super::compare::Compared;
use super::oracle::{Hypothesis, Oracle, triads};
use super::people::Pressed;
use crate::exact::Range;
use isostudy_report::report::{Block, Finding, Report};

/// What values are called, longer names first, with their letter.
const NAMES: [(&str, char); 9] = [
    ("integrated clustering with collapse", 'C'),
    ("integrated clustering", 'I'),
    ("edge collapse", 'P'),
    ("no clustering", 'U'),
    ("without clustering", 'U'),
    ("body-centred lattice", 'B'),
    ("simple cubic lattice", 'S'),
    ("lattice of five tetrahedra", 'M'),
    ("face-centred lattice", 'F'),
];

/// Holds every sentence with numbers of answers against what was answered.
pub(super) fn compare_sentences(oracle: &Oracle<'_>, hypotheses: &[Hypothesis], report: &Report) -> Compared {
    let mut compared = Compared::default();
    lead(oracle, report, &mut compared);
    for section in &report.sections {
        for block in &section.blocks {
            let Block::Finding(finding) = block else { continue };
            contrasts(oracle, hypotheses, section.id, finding, &mut compared);
            sides(oracle, &finding.text, &mut compared);
            circles(oracle, &finding.text, &mut compared);
        }
    }
    compared
}

/// The whole numbers of a text.
fn numbers(text: &str) -> Vec<u64> {
    let digits = text.split(|letter: char| !letter.is_ascii_digit());
    digits.filter_map(|digits| digits.parse().ok()).collect()
}

/// Who gave how many answers to how many questions, and how many of what was asked for are not there.
fn lead(oracle: &Oracle<'_>, report: &Report, compared: &mut Compared) {
    let people = oracle.comparisons.iter().filter(|own| !own.is_empty()).count() as u64;
    let mut questions: Vec<&str> = oracle.comparisons().map(|(question, _)| question.id.as_str()).collect();
    let answers = questions.len() as u64;
    questions.sort_unstable();
    questions.dedup();
    let Some(first) = report.lead.first().filter(|_| answers > 0) else { return };
    let found = numbers(first.split(" about ").next().unwrap_or_default());
    let want = vec![people, answers, questions.len() as u64];
    compared.check(found == want, ["report", "lead", "counts"], first, format!("{want:?}"));
}

/// One count of answers in a sentence, and the words before it.
struct Counted<'t> {
    before: &'t str,
    counts: [u64; 3],
    after: &'t str,
}

/// Every `36 answers against 10, 8 without preference` of a text.
fn counted(text: &str) -> Vec<Counted<'_>> {
    let mut all: Vec<Counted<'_>> = Vec::new();
    let mut from = 0;
    while let Some(at) = text[from..].find(" against ").map(|at| from + at) {
        let (before, rest) = (&text[..at], &text[at + " against ".len()..]);
        let stem = before.strip_suffix(" answers").or_else(|| before.strip_suffix(" answer"));
        let first = stem.and_then(|stem| stem.rsplit([' ', '(']).next()).and_then(|n| n.parse::<u64>().ok());
        let end = rest.find(" without preference");
        if let (Some(stem), Some(first), Some(end)) = (stem, first, end) {
            let mut others = rest[..end].split(", ");
            let second = others.next().and_then(|n| n.parse().ok());
            let ties = others.next().and_then(|n| if n == "none" { Some(0) } else { n.parse().ok() });
            if let (Some(second), Some(ties)) = (second, ties) {
                let start = all.last().map_or(0, |last| text.len() - last.after.len());
                let before = &stem[start.min(stem.len())..];
                all.push(Counted { before, counts: [first, ties, second], after: &rest[end..] });
            }
        }
        from = at + 1;
    }
    // What follows one is up to the next.
    for i in 1..all.len() {
        let next = all[i].before.as_ptr() as usize;
        let own = all[i - 1].after;
        let length = next.saturating_sub(own.as_ptr() as usize) + all[i].before.len();
        all[i - 1].after = &own[..length.min(own.len())];
    }
    all
}

/// Values and objects that a text names, in order; objects by name.
fn named(oracle: &Oracle<'_>, text: &str) -> Vec<String> {
    let text = text.to_lowercase();
    let (mut found, mut at) = (Vec::new(), 0);
    while at < text.len() {
        let rest = &text[at..];
        let value = NAMES.iter().find(|(name, _)| rest.starts_with(name));
        let object = oracle.objects.iter().find(|object| {
            let tail = rest.strip_prefix("on the ").and_then(|rest| rest.strip_prefix(object.as_str()));
            tail.is_some_and(|tail| !tail.starts_with(|letter: char| letter.is_alphanumeric()))
        });
        match (value, object) {
            (Some((name, letter)), _) => {
                found.push(letter.to_string());
                at += name.len();
            }
            (_, Some(object)) => {
                found.push(object.clone());
                at += "on the ".len() + object.len();
            }
            _ => at += rest.chars().next().map_or(1, char::len_utf8),
        }
    }
    found
}

/// Which hypothesis a list of names is about: two values and a scope.
fn meant(names: &[String]) -> Option<([String; 2], String)> {
    let lattice = |name: &str| ["B", "S", "M", "F"].contains(&name);
    let clustering = |name: &str| ["U", "I", "P", "C"].contains(&name);
    let pair = |a: &str, b: &str| [a.to_owned(), b.to_owned()];
    let texts: Vec<&str> = names.iter().map(String::as_str).collect();
    let (levels, rest) = match texts[..] {
        // Methods are a clustering on a lattice each.
        [a, b, c, d, ref rest @ ..] if clustering(a) && lattice(b) && clustering(c) && lattice(d) => {
            let method = |clustering: &str, lattice: &str| format!("{lattice}{clustering}").to_lowercase();
            ([method(a, b), method(c, d)], rest)
        }
        // The means of two lattices, and what the one has.
        [a, b, c] if lattice(a) && lattice(b) && c == a => (pair(a, b), &[][..]),
        [a, b, c] if lattice(a) && lattice(b) && c == b => (pair(b, a), &[][..]),
        [a, b, ref rest @ ..] => (pair(a, b), rest),
        _ => return None,
    };
    match rest {
        [] => Some((levels, "all".into())),
        [one] if lattice(one) || clustering(one) => Some((levels, format!("within {one}"))),
        [object] => Some((levels, (*object).into())),
        _ => None,
    }
}

fn contrasts(
    oracle: &Oracle<'_>,
    hypotheses: &[Hypothesis],
    section: &str,
    finding: &Finding,
    compared: &mut Compared,
) {
    let mut first: Option<[String; 2]> = None;
    let mut scopes = Vec::new();
    let find = |levels: &[String; 2], scope: &str| {
        let [a, b] = levels;
        hypotheses.iter().find(|of| {
            of.scope == scope
                && (of.levels == *levels || of.levels == [b.clone(), a.clone()])
                && of.family != "questions"
        })
    };
    for said in counted(&finding.text) {
        let mut names = named(oracle, said.before);
        // The second of two places has the values of the first.
        if let (Some([a, b]), true) = (&first, names.len() == 1) {
            names.splice(0..0, [a, b].map(|level: &String| level.clone()));
        }
        let row = format!("{section}: {}", finding.text);
        let Some((levels, scope)) = meant(&names) else {
            compared.check(false, ["report", &row, "names"], format!("{names:?}"), "two values and a scope");
            continue;
        };
        // What is the same hypothesis as a wider one is told as that.
        let Some(of) = find(&levels, &scope) else {
            compared.check(false, ["report", &row, "contrast"], format!("{names:?}"), "a contrast");
            continue;
        };
        let turned = of.levels != levels;
        let counts = of.counts.map(|[a, t, b]| if turned { [b, t, a] } else { [a, t, b] });
        compared.check(
            counts == Some(said.counts),
            ["report", &row, "counts"],
            format!("{:?}", said.counts),
            format!("{counts:?}"),
        );
        first.get_or_insert(levels);
        scopes.push(scope.trim_start_matches("within ").to_owned());
        if !finding.text.starts_with("How much") && section == "preferences" {
            tested(of, said.after, &row, compared);
            standing(of, finding, &row, compared);
        }
    }
    // Of a difference the test is at the end.
    if let (true, Some(levels), [a, b]) = (finding.text.starts_with("How much"), &first, &scopes[..])
        && let Some(of) = find(levels, &format!("{a} - {b}"))
    {
        let row = format!("{section}: {}", finding.text);
        tested(of, &finding.text, &row, compared);
        // That the parts are about other things is said with it.
        let is_told = |said: &str| said.starts_with("differs") || said == "parts about other things";
        let holds = of.conclusion().is_none_or(is_told);
        compared.check(holds, ["report", &row, "standing"], "holds", format!("{:?}", of.conclusion()));
    }
}

/// The p of the sign-flip test, corrected.
fn tested(of: &Hypothesis, text: &str, row: &str, compared: &mut Compared) {
    let measured = ["%), adjusted p ", " %, adjusted p ", "The difference holds (adjusted p "];
    let Some((_, said)) = measured.iter().find_map(|before| text.split_once(before)) else { return };
    let said =
        said.split([';', ',', ')']).next().and_then(|said| said.split(". ").next()).unwrap_or_default();
    compared.check(
        is_rounded(said, of.adjusted),
        ["report", row, "p corrected"],
        said,
        format!("{:?}", of.adjusted),
    );
}

/// Whether `p = 0.0094` is this number, rounded.
fn is_rounded(said: &str, want: Range) -> bool {
    let digits: String = said
        .chars()
        .skip_while(|letter| !letter.is_ascii_digit())
        .take_while(|letter| letter.is_ascii_digit() || *letter == '.')
        .collect();
    let digits = digits.trim_end_matches('.');
    let Ok(number) = digits.parse::<f64>() else { return false };
    if said.contains('<') {
        return want.low < number;
    }
    let decimals = digits.split('.').nth(1).map_or(0, str::len);
    // What is nearly certain is printed as 1.
    let half = if digits == "1" { 0.005 } else { 0.5001 * 10.0_f64.powi(-(decimals as i32)) };
    (want.low - half..=want.high + half).contains(&number)
}

/// Whether a statement stands as its test has it.
fn standing(of: &Hypothesis, finding: &Finding, row: &str, compared: &mut Compared) {
    let Some(conclusion) = of.conclusion() else { return };
    let want: &[&str] = match conclusion {
        "too few" => &["too few"],
        "differs" | "differs, within the margin" => &["holds"],
        "equal within the margin" => &["equal"],
        "parts about other things" => &["not answerable"],
        _ => &["open"],
    };
    let got = finding.standing.label();
    compared.check(want.contains(&got), ["report", row, "standing"], got, want.join(" or "));
}

/// How many answers went to either side, as people saw them.
fn sides(oracle: &Oracle<'_>, text: &str, compared: &mut Compared) {
    let Some(at) = text.find(" went left, ") else { return };
    let start =
        text[..at].trim_end_matches(" answers").trim_end_matches(" answer").rfind(' ').map_or(0, |i| i + 1);
    let end = text[at..].find(" to neither").map_or(text.len(), |end| at + end);
    let found = numbers(&text[start..end]);
    let count =
        |pressed: Pressed| oracle.comparisons().filter(|(_, given)| given.pressed == pressed).count() as u64;
    let want = vec![count(Pressed::Left), count(Pressed::Right), count(Pressed::Neither)];
    compared.check(found == want, ["report", text, "sides"], format!("{found:?}"), format!("{want:?}"));
}

/// How many triads go in a circle.
fn circles(oracle: &Oracle<'_>, text: &str, compared: &mut Compared) {
    let Some((_, rest)) = text.split_once(": of ").filter(|(_, rest)| rest.contains("triad")) else { return };
    let found: Vec<u64> = numbers(rest).into_iter().take(3).collect();
    let own = triads(oracle, |_| true);
    let want = vec![own.all, own.decided, own.strict];
    compared.check(found == want, ["report", text, "triads"], format!("{found:?}"), format!("{want:?}"));
}
