//! Agreement of participants with each other and with themselves.

use isostudy_design::Study;
use isostudy_inference::agreement::Agreement;
use isostudy_inference::screened::Respondent;
use isostudy_statistics::interval::Interval;
use isostudy_statistics::{Alpha, ChiSquareTest};
use isostudy_table::{Cell, Columns, Table};

type Row<'a> = (&'a Study, &'a Agreement);

/// All questions, then each comparison group: agreement between participants, and circular triads within.
pub(super) fn agreement(study: &Study, agreement: &[Agreement]) -> Table {
    fn circle((_, of): &Row<'_>, count: u64) -> Cell {
        if of.triads.all > 0 { Cell::count(count) } else { Cell::Missing }
    }
    fn test(row: &Row<'_>) -> Option<ChiSquareTest> {
        row.1.kendall.and_then(|found| found.test)
    }
    fn end(alpha: Option<Alpha>, end: fn(Interval) -> f64) -> Cell {
        Cell::number(alpha.and_then(|alpha| alpha.interval).map(end), 4)
    }
    let caption = "Agreement between participants, and consistency of each";
    let rows = agreement.iter().filter(|of| of.questions > 0).map(|of| (study, of));
    let table = Columns::over(rows)
        .column("scope", "Questions", |(study, of)| {
            Cell::text(of.group.map_or("all", |g| &study.groups[g].id))
        })
        .column("questions", "Number", |(_, of)| Cell::count(of.questions as u64))
        .column("alpha_nominal", "Alpha, nominal", |(_, of)| Cell::number(of.nominal.map(|a| a.value), 4))
        .column("alpha_nominal_low", "from", |(_, of)| end(of.nominal, |i| i.low))
        .column("alpha_nominal_high", "to", |(_, of)| end(of.nominal, |i| i.high))
        .column("alpha_ordinal", "Alpha, ordinal", |(_, of)| Cell::number(of.ordinal.map(|a| a.value), 4))
        .column("alpha_ordinal_low", "from", |(_, of)| end(of.ordinal, |i| i.low))
        .column("alpha_ordinal_high", "to", |(_, of)| end(of.ordinal, |i| i.high))
        .column("kendall_u", "Kendall's u", |(_, of)| Cell::number(of.kendall.map(|found| found.u), 4))
        .column("chi_square", "Chi-square", |row| Cell::number(test(row).map(|test| test.statistic), 2))
        .column("degrees", "Degrees", |row| Cell::number(test(row).map(|test| test.degrees), 2))
        .column("p", "p", |row| Cell::p(test(row).map(|test| test.p), 5))
        .column("triads", "Triads", |row| circle(row, row.1.triads.all))
        .column("decided_triads", "all three decided", |row| circle(row, row.1.triads.decided))
        .column("strict_cycles", "strict cycles", |row| circle(row, row.1.triads.strict_cycles))
        .column("weak_cycles", "weak cycles", |row| circle(row, row.1.triads.weak_cycles))
        .column("cycles_by_chance", "strict by chance", |(_, of)| {
            Cell::number((of.triads.all > 0).then(|| of.triads.cycles_by_chance()), 1)
        })
        .column("tournaments", "All decided", |row| circle(row, row.1.tournaments))
        .column("mean_zeta", "mean zeta", |(_, of)| {
            Cell::number((of.tournaments > 0).then(|| of.zetas / of.tournaments as f64), 3)
        })
        .into_table("agreement", caption);
    table.with_note(
        "Alpha: Krippendorff's, each question counted in both orientations, so that sides do not matter; 1 is full agreement, 0 \
         chance; from and to: interval at 95 % over participants, of all values that a test does not reject. No interval of alpha below four \
         questions, below 12 people per question, or if questions times one less alpha is below three: simulated coverage fails there. Kendall's u: a tie is half \
         an answer for each side; its test is without continuity correction. Triads: three items that one person compared \
         pairwise on one object; strict by chance: a quarter of those decided throughout, as answers by chance would have it. A weak cycle is two wins closed by a tie, \
         which need not be an error. Zeta: Kendall's, of whoever decided every pair of an object and group; 1 is no circle.",
    )
}

/// Answers beyond which a table of participants is printed for those alone who break a rule.
const MANY: usize = 200;

/// One row a participant: what careless answering would show in.
///
/// So many of them are `excluded` from every other table; what a question shows lasts `shown_ms`.
pub(super) fn respondents(found: &[Respondent], excluded: usize, shown_ms: Option<f64>) -> Table {
    let caption = match excluded {
        0 => "Screening of participants; nobody is left out",
        _ => "Screening of all participants, those who are left out included",
    };
    let mut table = Columns::over(found)
        .column("respondent", "Respondent", |of| Cell::count(of.seen.participant as u64 + 1))
        .column("left", "Left", |of| Cell::count(of.seen.answers[0]))
        .column("no_preference", "None", |of| Cell::count(of.seen.answers[1]))
        .column("right", "Right", |of| Cell::count(of.seen.answers[2]))
        .column("one_sidedness", "(L \u{2212} R) / (L + R)", |of| Cell::number(of.seen.one_sidedness(), 3))
        .column("longest_run", "Longest run", |of| Cell::count(of.seen.longest_run))
        .column("comparable", "Comparable", |of| Cell::count(of.seen.comparable))
        .column("agreeing", "Agreeing", |of| Cell::count(of.seen.agreeing))
        .column("agreement", "Agreement", |of| Cell::number(of.seen.agreement(), 3))
        .column("outlying_p", "p of outlying", |of| Cell::p(of.seen.outlying_p, 4))
        .column("controls", "Controls", |of| Cell::count(of.seen.controls))
        .column("controls_decided", "decided", |of| Cell::count(of.seen.controls_decided))
        .column("repeats", "Repeats", |of| Cell::count(of.seen.repeats))
        .column("repeats_opposite", "opposite", |of| Cell::count(of.seen.repeats_opposite))
        .column("timed", "Timed", |of| Cell::count(of.seen.timed))
        .quantity("time_s", "Time in {}", "s", |of| {
            Cell::number((of.seen.timed > 0).then(|| of.seen.time_ms / 1000.0), 1)
        })
        .column("flags", "Rules broken", |of| {
            Cell::text(of.flags.iter().map(|flag| flag.code()).collect::<Vec<_>>().join(" "))
        })
        .into_table("respondents", caption);
    if table.rows.len() > MANY {
        let mut flagged = table.clone();
        let mut breaks = found.iter().map(|of| !of.flags.is_empty());
        flagged.rows.retain(|_| breaks.next() == Some(true));
        flagged.caption.clear();
        table.notes.push(format!(
            "Of {} participants those who break a rule are printed, {}; the CSV has all.",
            table.rows.len(),
            flagged.rows.len()
        ));
        table.parts = vec![flagged];
    }
    table.with_note(format!(
        "Controls and repeats are counted here, and nowhere else. Agreement: share of the decided answers that side with the majority of the others' decided answers, where they have \
         one. Longest run: of one side. Repeats: the same pair again, both times decided. Rules, fixed in the program: \
         one-sided (ten decided answers or more, all on one side), controls (two or more decided, and more than half), \
         repeats (two or more for the other item, and more than half), time (all timed answers together took less than what they show lasts{}), outlying (agrees on \
         less than half, and so much less than the others that p, with Bonferroni's correction and an allowance of 5, is \
         below 0.01). Only the last has seen what was preferred: a reason to look, not to exclude.",
        shown_ms.map_or(", which nobody has said: shown_s".into(), |ms| format!(", {} s each", ms / 1000.0))
    ))
}

#[cfg(test)]
mod tests;
