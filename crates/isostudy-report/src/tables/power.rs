//! Power of a design: every number as a table for programs, contrasts and their kinds by participants as tables to read.

use isostudy_inference::power::{Assumptions, Power, QUESTIONS, Way};
use isostudy_table::digits::number;
use isostudy_table::{Cell, Columns, Table};

/// What is commonly asked of a study.
pub(crate) const WANTED: f64 = 0.8;

/// The tables `power`, a row a number; `power_by_participants`, a column a number of participants; and `power_by_kind`, the same for
/// all contrasts of a kind, which differ by chance or by sides alone: of [`power`](isostudy_inference::power::power).
pub fn power_tables(assumptions: &Assumptions, all: &[Power]) -> [Table; 3] {
    let note = note(assumptions, all);
    let [contrasts, kinds] = [by_participants(assumptions, all), by_kind(assumptions, all)];
    [in_full(all), contrasts.with_note(note.clone()), kinds.with_note(note)]
}

/// What so many participants find at the share in the middle, by kind of contrast and liking for a side.
///
/// # Panics
/// If there is nothing about so many participants.
pub fn power_sentences(assumptions: &Assumptions, all: &[Power], participants: usize) -> Vec<String> {
    let share = assumptions.shares[assumptions.shares.len() / 2];
    let sentence = |kind: Kind<'_>| {
        let at = |value: fn(&Power) -> f64| {
            range(kind.rows.iter().filter(|of| of.participants == participants).map(|of| value(of)))
        };
        let (judged, alone) = (at(|of| of.corrected), at(|of| of.uncorrected));
        let (over, percent) = (kind.rows[0].over.as_str(), number(100.0 * share, 0));
        let correction = if kind.rows[0].family == QUESTIONS { "Benjamini and Hochberg's" } else { "Holm's" };
        let questions = match kind.rows[0].questions {
            1 => String::new(),
            many => format!(" ({many} questions)"),
        };
        let liking = match kind.rows[0].side_bias {
            0.0 => String::new(),
            side => format!(", liking of {} for the left side", number(side, 1)),
        };
        let mut first = over.chars();
        let over = first.next().into_iter().flat_map(char::to_uppercase).collect::<String>() + first.as_str();
        format!(
            "{over}{questions}{liking}: {participants} people find a share of {percent} % with probability {judged}. \
             That is after {correction} correction; without it, the probability would be {alone}."
        )
    };
    let own = |kind: &Kind<'_>| kind.rows[0].share == share;
    kinds(all).into_iter().filter(own).map(sentence).collect()
}

fn in_full(all: &[Power]) -> Table {
    Columns::over(all)
        .column("family", "Family", |of| Cell::text(&of.family))
        .column("contrast", "Contrast", |of| Cell::text(&of.contrast))
        .column("scope", "Over", |of| Cell::text(&of.scope))
        .column("questions", "Questions", |of| Cell::count(of.questions as u64))
        .column("share", "Share of decided", |of| Cell::Number(of.share, 3))
        .column("side_bias", "Liking for the left side", |of| Cell::Number(of.side_bias, 3))
        .column("participants", "Participants", |of| Cell::count(of.participants as u64))
        .column("power_corrected", "Power, corrected", |of| Cell::Number(of.corrected, 3))
        .column("power_corrected_error", "Monte-Carlo error", |of| Cell::Number(of.errors()[0], 4))
        .column("power_uncorrected", "Power, uncorrected", |of| Cell::Number(of.uncorrected, 3))
        .column("power_uncorrected_error", "Monte-Carlo error", |of| Cell::Number(of.errors()[1], 4))
        .into_table("power", "Power of every contrast and question")
}

fn by_participants(assumptions: &Assumptions, all: &[Power]) -> Table {
    let mut rows: Vec<&[Power]> = all.chunks(assumptions.participants.len()).collect();
    rows.retain(|row| row[0].family != QUESTIONS);
    // Stable: shares of one contrast follow one another.
    rows.sort_by_key(|row| {
        all.iter().position(|p| (&p.contrast, &p.scope) == (&row[0].contrast, &row[0].scope))
    });
    Columns::over(rows)
        .column("contrast", "Contrast", |row| Cell::text(&row[0].contrast))
        .column("scope", "Over", |row| Cell::text(&row[0].scope))
        .column("questions", "Questions", |row| Cell::count(row[0].questions as u64))
        .column("share", "Share of decided", |row| Cell::Number(row[0].share, 2))
        .column("side_bias", "Liking for the left side", |row| Cell::Number(row[0].side_bias, 2))
        .columns_of(assumptions.participants.iter().enumerate(), |all, (i, n)| {
            all.column(format!("power_{n}"), format!("N = {n}"), |row| Cell::Number(row[i].corrected, 2))
                .column(format!("uncorrected_{n}"), "uncorrected", |row| Cell::Number(row[i].uncorrected, 2))
        })
        .into_table("power_by_participants", "Power after correction by number of participants N")
}

/// Contrasts of a family that have as many questions, at one share and one liking for a side.
struct Kind<'a> {
    rows: Vec<&'a Power>,
}

fn kinds(all: &[Power]) -> Vec<Kind<'_>> {
    let is_one = |a: &Power, b: &Power| {
        (&a.over, a.questions, a.share, a.side_bias) == (&b.over, b.questions, b.share, b.side_bias)
    };
    let mut kinds: Vec<Kind<'_>> = Vec::new();
    for power in all {
        match kinds.iter_mut().find(|kind| is_one(kind.rows[0], power)) {
            Some(kind) => kind.rows.push(power),
            None => kinds.push(Kind { rows: vec![power] }),
        }
    }
    // Stable: shares and sides of one kind follow one another.
    let first = |kind: &Kind<'_>| {
        all.iter().position(|p| (&p.over, p.questions) == (&kind.rows[0].over, kind.rows[0].questions))
    };
    kinds.sort_by_key(first);
    kinds
}

fn by_kind(assumptions: &Assumptions, all: &[Power]) -> Table {
    let numbers = &assumptions.participants;
    let at = |kind: &Kind<'_>, n: usize| -> Vec<f64> {
        kind.rows.iter().filter(|of| of.participants == n).map(|of| of.corrected).collect()
    };
    let enough = |kind: &Kind<'_>| {
        let is_enough = |n: &&usize| at(kind, **n).into_iter().all(|power| power >= WANTED);
        numbers.iter().find(is_enough).map_or_else(
            || format!("more than {}", numbers.last().copied().unwrap_or(0)),
            ToString::to_string,
        )
    };
    Columns::over(kinds(all))
        .column("over", "Over", |kind| Cell::text(&kind.rows[0].over))
        .column("questions", "Questions", |kind| Cell::count(kind.rows[0].questions as u64))
        .column("tests", "Tests", |kind| Cell::count((kind.rows.len() / numbers.len()) as u64))
        .column("share", "Share of decided", |kind| Cell::Number(kind.rows[0].share, 2))
        .column("side_bias", "Liking for the left side", |kind| Cell::Number(kind.rows[0].side_bias, 2))
        .columns_of(numbers, |all, &n| {
            all.column(format!("power_{n}"), format!("N = {n}"), |kind| Cell::text(range(at(kind, n))))
        })
        .column("enough", format!("N for {WANTED}"), |kind| Cell::text(enough(kind)))
        .into_table(
            "power_by_kind",
            "Power after correction by number of participants N, from the least contrast to the most",
        )
}

/// From the least to the most, with two digits; once if they are the same.
fn range(powers: impl IntoIterator<Item = f64>) -> String {
    let (low, high) = powers
        .into_iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), power| (low.min(power), high.max(power)));
    let [low, high] = [low, high].map(|power| format!("{power:.2}"));
    if low == high { low } else { format!("{low} to {high}") }
}

fn note(assumptions: &Assumptions, all: &[Power]) -> String {
    let level =
        all.first().map_or_else(String::new, |power| format!("{} %", (1e6 * power.level).round() / 1e4));
    let largest = all.iter().flat_map(Power::errors).fold(0.0, f64::max);
    let chance = if assumptions.shares.contains(&0.5) {
        " At a share of 0.5 there is nothing to find: the number is how often a test finds something nevertheless."
    } else {
        ""
    };
    let asked = asked(assumptions.way);
    format!(
        "Exact sign-flip test over participants at {level}, two-sided. Power is after the correction of the analysis: Holm's in each \
         family, Benjamini and Hochberg's over questions. There are {} simulated studies a share, and the Monte-Carlo standard error is at \
         most {largest:.3}. Assumed: in every contrast the first is chosen in this share of decided answers by a person who \
         does not deviate. Differences between people have standard deviation {} logits, between objects {}. Davidson's tie \
         parameter is {}. A liking for the left side is in logits as well. Rejections in favour of the other do not count. Objects are \
         taken as they are: what is preferred on these alone is found too. Nobody is excluded.{asked}{chance} Seed {}.",
        assumptions.studies,
        number(assumptions.person_sd, 2),
        number(assumptions.object_sd, 2),
        number(assumptions.ties, 2),
        assumptions.seed
    )
}

/// How people are asked, where it is not the way of the questionnaire.
fn asked(way: Way) -> &'static str {
    match way {
        Way::Pairs => "",
        Way::Forced => {
            " Asked: left or right, without \u{201c}no preference\u{201d}; the tie parameter has no part in it."
        }
        Way::Graded => {
            " Asked: five steps from much better on the left to much better on the right; a score is the mean of 2, 1, 0, \u{2212}1 and \u{2212}2."
        }
        Way::BestOfThree => {
            " Asked: the best of three, the third liked like the second; an answer counts where one of the two is taken."
        }
        Way::BestOfFour => {
            " Asked: the best of four, two of them liked like the second; an answer counts where one of the two is taken."
        }
        Way::Ratings => {
            " Asked: a rating from 1 to 7 of each of the two; a score is the mean of their differences."
        }
    }
}
