//! What probes saw, in words: for the table of probes and for the report alike.

use crate::words::{self, counted, number};
use isostudy_inference::audit::Evidence;
use isostudy_inference::audit::evidence::{
    Agreement, BothOrders, Contradiction, Copies, Difference, Differences, Key, Orders, Pulls, Reason,
    Remark, SameAnswers, SameTimes, Separations, TimeTwins, TurnedPair, WrongFile,
};

/// What a probe saw, or why nothing can be seen.
pub(crate) fn evidence(of: &Evidence) -> String {
    match of {
        Evidence::Side(pulls) => side(pulls),
        Evidence::OutlyingRespondent(agreement) => outlying_respondent(agreement),
        Evidence::CopiedRows(copies) => copied_rows(copies),
        Evidence::SwappedKey(key) => swapped_key(key),
        Evidence::ObjectInteraction(differences) => object_interaction(differences),
        Evidence::Separation(separations) => separation(separations),
        Evidence::NotAnswerable(why) => format!("not answerable here, because {}", reason(why)),
    }
}

const FEW_PAIRS: &str = "fewer than four pairs were seen in both orders of sides";

/// What was seen in both orders, and why it does not do.
fn both_orders(BothOrders { pairs, people, apart }: BothOrders) -> String {
    match (pairs, apart) {
        (0, 0) => "no pair was seen in both orders".into(),
        (0, apart) => format!("no pair was seen in both orders on one object: {}", seen_apart(apart)),
        _ => format!(
            "{} in both orders {} seen by {}, and fewer than four tell no spread",
            counted(pairs, "pair"),
            if pairs == 1 { "was" } else { "were" },
            words::people(people)
        ),
    }
}

/// That orders are apart. Where no object is named, each question counts as one.
fn seen_apart(apart: usize) -> String {
    let were = if apart == 1 { "was" } else { "were" };
    format!(
        "{} {were} seen in both orders, but each order in a question or on an object of its own",
        counted(apart, "pair")
    )
}

/// Why nothing can be seen.
pub(crate) fn reason(why: &Reason) -> String {
    match why {
        Reason::NoSides => "the file does not say which item was on which side".into(),
        Reason::FewInBothOrders(BothOrders { pairs: 0, apart: 0, .. }) => {
            "no pair was seen in both orders of sides and there are no controls: side goes with what was shown on it"
                .into()
        }
        Reason::FewInBothOrders(seen) => format!("{}; there are no controls", both_orders(*seen)),
        Reason::FewControls(counts, seen) => {
            format!("too few people answered controls, and {} ({})", both_orders(*seen), controls(*counts))
        }
        Reason::FewDeciders => {
            "fewer than five people decided ten questions on which the others have a majority".into()
        }
        Reason::FewRowsAlike => {
            "no five people answered the same ten questions on the same sides, and no times are recorded".into()
        }
        Reason::FewPairsInBothOrders { remarks, apart } => {
            let remarks: Vec<String> = remarks.iter().map(|of| format!("; {}", remark(of))).collect();
            let apart = match apart {
                0 => String::new(),
                _ => format!(" on one object ({})", seen_apart(*apart)),
            };
            format!("{FEW_PAIRS}{apart}: a wrong key looks like a preference{}", remarks.concat())
        }
        Reason::NoPairOnTwoObjects { pressing } => {
            let reason = "no two people were shown the same pair of items on more than one object";
            format!("{reason}{}", left_out(*pressing))
        }
        Reason::NothingCompared => "nothing was compared".into(),
        Reason::NothingDecided => {
            "nobody ever decided between two items, so that there are no worths".into()
        }
    }
}

/// Of many names, the first few.
fn list(names: &[String]) -> String {
    const MOST: usize = 5;
    match names.len() {
        0..=MOST => names.join(", "),
        n => format!("{} and {} more", names[..MOST].join(", "), n - MOST),
    }
}

/// The first few of many, each in words.
fn each<T>(of: &[T], words: impl Fn(&T) -> String) -> String {
    list(&of.iter().map(words).collect::<Vec<_>>())
}

fn respondents(people: &[usize]) -> String {
    let noun = if people.len() == 1 { "respondent" } else { "respondents" };
    format!("{noun} {}", each(people, |participant| (participant + 1).to_string()))
}

fn side(Pulls { pairs, controls: counts }: &Pulls) -> String {
    let pull = pairs.map(|of| {
        let towards = if of.mean >= 0.0 { "left" } else { "right" };
        format!(
            "{} seen in both orders {} {:.3} to the {towards}",
            counted(of.pairs, "pair"),
            if of.pairs == 1 { "pulls" } else { "pull" },
            of.mean.abs()
        )
    });
    let parts: Vec<String> = pull.into_iter().chain(counts.map(controls)).collect();
    parts.join("; ")
}

fn controls([left, none, right]: [u64; 3]) -> String {
    format!("controls: {left} left, {none} none, {right} right")
}

fn outlying_respondent(Agreement { outlying, low, high }: &Agreement) -> String {
    let range = format!("{:.0} to {:.0} %", 100.0 * low, 100.0 * high);
    if outlying.is_empty() {
        return format!("agreement with the others' majority is {range}");
    }
    let name = |(participant, agreement): &(usize, f64)| {
        let number = participant + 1;
        format!("respondent {number} agrees with the others' majority on {:.0} %", 100.0 * agreement)
    };
    format!("{}; everybody else on {range}", each(outlying, name))
}

fn copied_rows(Copies { times, answers }: &Copies) -> String {
    let parts: Vec<String> = times.iter().map(same_times).chain(answers.iter().map(same_answers)).collect();
    parts.join("; ")
}

fn same_times(SameTimes { people, untimed, copies }: &SameTimes) -> String {
    let twins = |TimeTwins { people: [a, b], common, timed }: &TimeTwins| {
        format!("respondents {} and {} took the same time for {common} of {timed} answers", a + 1, b + 1)
    };
    let found = match copies.is_empty() {
        true => format!("no two of {people} people took the same times"),
        false => format!("to the millisecond, {}", each(copies, twins)),
    };
    match untimed {
        0 => found,
        untimed => format!("{found}; {untimed} of all have too few times to be compared"),
    }
}

fn same_answers(of: &SameAnswers) -> String {
    let SameAnswers { people, same, expected, least_expected, copies } = of;
    match same {
        0 => format!(
            "no two of {people} people gave the same answers; by chance about {} would",
            few(*expected)
        ),
        1 => format!(
            "{} gave the same answers; by chance about {} pairs would give these",
            respondents(&copies[0]),
            few(*least_expected)
        ),
        same => format!(
            "{same} pairs gave the same answers, by chance about {} would, and about {} the least probable of them: {}",
            few(*expected),
            few(*least_expected),
            each(copies, |people| respondents(people))
        ),
    }
}

fn few(expected: f64) -> String {
    match expected {
        few if few < 0.001 => "none (below 0.001)".into(),
        few if few < 10.0 => format!("{few:.3}"),
        many => format!("{many:.0}"),
    }
}

fn swapped_key(Key { contradictions, remarks, orders }: &Key) -> String {
    let mut parts: Vec<String> = contradictions.iter().map(contradiction).collect();
    let remarks = remarks.iter().map(remark);
    match orders {
        Orders::Contradict(pairs) => {
            parts.push(format!("two orders contradict each other. {}", each(pairs, turned_pair)));
            parts.extend(remarks);
        }
        Orders::Agree { pairs } => {
            parts.extend(remarks);
            parts.push(format!("the two orders of {} agree", counted(*pairs, "pair")));
        }
        Orders::Few => {
            parts.extend(remarks);
            parts.push(format!("whether answers were turned cannot be told, because {FEW_PAIRS}"));
        }
    }
    parts.join("; ")
}

fn turned_pair(TurnedPair { questions, means }: &TurnedPair) -> String {
    let [one, other] = means.map(|mean| number(mean, 2));
    format!("{}: mean {one} for an item on the left, {other} for it on the right", questions.join("/"))
}

fn contradiction(of: &Contradiction) -> String {
    match of {
        Contradiction::Codes { files, wrong } => format!(
            "the sides contradict what the code name shows in {} of {} ({})",
            wrong.len(),
            counted(*files, "file"),
            each(wrong, |(file, code)| format!("{} to file {code}", wrong_file(file)))
        ),
        Contradiction::Forms(wrong) => format!(
            "answers are labelled in the other order of sides than their forms show ({})",
            each(wrong, wrong_file)
        ),
        Contradiction::OtherForm(people) => {
            format!("the sides are those of another form than the file names for {}", respondents(people))
        }
    }
}

fn wrong_file(WrongFile { questions, contradicting, answers }: &WrongFile) -> String {
    format!("{}: {contradicting} of {}", questions.join("/"), counted(*answers as usize, "answer"))
}

fn remark(of: &Remark) -> String {
    match *of {
        Remark::CodesAgree { files } => {
            format!("the code names of {} agree with the sides", counted(files, "file"))
        }
        Remark::FormsAgree => "the sides are those of the forms".into(),
        Remark::OtherStudysForms => "the sides are not those of the forms that the study deals".into(),
        Remark::Stray { answers } => {
            let contradict = if answers == 1 { "contradicts" } else { "contradict" };
            format!("{} {contradict} the forms", counted(answers as usize, "single answer"))
        }
    }
}

fn object_interaction(of: &Differences) -> String {
    let Differences { compared, found, largest, pressing } = of;
    let comparisons = counted(*compared, "comparison");
    let seen = match (found.is_empty(), largest) {
        (false, _) => each(found, difference),
        (true, Some(largest)) => {
            format!("{comparisons}; the largest difference is {}", difference(largest))
        }
        (true, None) => format!("{comparisons}; none differs"),
    };
    format!("{seen}{}", left_out(*pressing))
}

fn difference(Difference { items, group, object, means }: &Difference) -> String {
    let [own, others] = means.map(|mean| number(mean, 2));
    format!("{} ({group}) on {object}: mean {own} against {others}", items.join("-"))
}

/// What is said of those who press one side throughout.
fn left_out(pressing: usize) -> String {
    match pressing {
        0 => String::new(),
        n => format!("; without {} pressing one side throughout", counted(n, "respondent")),
    }
}

fn separation(of: &Separations) -> String {
    let mut parts = Vec::new();
    if !of.separated.is_empty() {
        let items = "some items never won against the others: worths are penalised";
        parts.push(format!("{} {items}", within(&of.separated)));
    }
    if !of.disconnected.is_empty() {
        let items = "some items were never compared with the others: there are no worths";
        parts.push(format!("{} {items}", within(&of.disconnected)));
    }
    if !of.held_by_ties.is_empty() {
        parts.push(format!("{} ties alone keep the worths finite", within(&of.held_by_ties)));
    }
    match of.judged {
        _ if !parts.is_empty() => {}
        1 => parts.push("every item won against the others".into()),
        all => parts.push(format!("every item won against the others in all {all} groups")),
    }
    match of.undecided {
        0 => {}
        1 => parts.push("in 1 group nobody ever decided".into()),
        none => parts.push(format!("in {none} groups nobody ever decided")),
    }
    parts.join("; ")
}

/// `in group trees`, `in groups trees, cakes`.
fn within(groups: &[String]) -> String {
    format!("in {} {}", if groups.len() == 1 { "group" } else { "groups" }, list(groups))
}

#[cfg(test)]
mod tests;
