//! Agreement of participants with each other and with themselves.

use isostudy_design::Study;
use isostudy_inference::agreement::Agreement;
use isostudy_inference::screened::Respondent;
use isostudy_table::{Cell, Table};

/// All questions, then each comparison group: agreement between participants, and circular triads within.
pub(super) fn agreement(study: &Study, agreement: &[Agreement]) -> Table {
    let mut table = Table::new(
        "agreement",
        "Agreement between participants, and consistency of each",
        &[
            ("scope", "Questions"),
            ("questions", "Number"),
            ("alpha_nominal", "Alpha, nominal"),
            ("alpha_nominal_low", "from"),
            ("alpha_nominal_high", "to"),
            ("alpha_ordinal", "Alpha, ordinal"),
            ("alpha_ordinal_low", "from"),
            ("alpha_ordinal_high", "to"),
            ("kendall_u", "Kendall's u"),
            ("chi_square", "Chi-square"),
            ("degrees", "Degrees"),
            ("p", "p"),
            ("triads", "Triads"),
            ("decided_triads", "all three decided"),
            ("strict_cycles", "strict cycles"),
            ("weak_cycles", "weak cycles"),
            ("cycles_by_chance", "strict by chance"),
            ("tournaments", "All decided"),
            ("mean_zeta", "mean zeta"),
        ],
    );
    for of in agreement.iter().filter(|of| of.questions > 0) {
        let [nominal, ordinal] = [of.nominal, of.ordinal];
        let test = of.kendall.and_then(|found| found.test);
        let (circles, tournaments) = (of.triads, of.tournaments);
        let circle = |count: u64| if circles.all > 0 { Cell::count(count) } else { Cell::Missing };
        table.push(vec![
            Cell::text(of.group.map_or("all", |g| &study.groups[g].id)),
            Cell::count(of.questions as u64),
            Cell::number(nominal.map(|alpha| alpha.value), 4),
            Cell::number(nominal.and_then(|alpha| alpha.interval).map(|i| i.low), 4),
            Cell::number(nominal.and_then(|alpha| alpha.interval).map(|i| i.high), 4),
            Cell::number(ordinal.map(|alpha| alpha.value), 4),
            Cell::number(ordinal.and_then(|alpha| alpha.interval).map(|i| i.low), 4),
            Cell::number(ordinal.and_then(|alpha| alpha.interval).map(|i| i.high), 4),
            Cell::number(of.kendall.map(|found| found.u), 4),
            Cell::number(test.map(|test| test.statistic), 2),
            Cell::number(test.map(|test| test.degrees), 2),
            Cell::p(test.map(|test| test.p), 5),
            circle(circles.all),
            circle(circles.decided),
            circle(circles.strict_cycles),
            circle(circles.weak_cycles),
            Cell::number((circles.all > 0).then(|| circles.cycles_by_chance()), 1),
            circle(tournaments),
            Cell::number((tournaments > 0).then(|| of.zetas / tournaments as f64), 3),
        ]);
    }
    table.notes.push(
        "Alpha: Krippendorff's, each question counted in both orientations, so that sides do not matter; 1 is full agreement, 0 \
         chance; from and to: interval at 95 % over participants, of all values that a test does not reject. No interval of alpha below four \
         questions, below 12 people per question, or if questions times one less alpha is below three: simulated coverage fails there. Kendall's u: a tie is half \
         an answer for each side; its test is without continuity correction. Triads: three items that one person compared \
         pairwise on one object; strict by chance: a quarter of those decided throughout, as answers by chance would have it. A weak cycle is two wins closed by a tie, \
         which need not be an error. Zeta: Kendall's, of whoever decided every pair of an object and group; 1 is no circle."
            .into(),
    );
    table
}

/// Answers beyond which a table of participants is printed for those alone who break a rule.
const MANY: usize = 200;

/// One row a participant: what careless answering would show in.
///
/// So many of them are `excluded` from every other table; what a question shows lasts `shown_ms`.
pub(super) fn respondents(found: &[Respondent], excluded: usize, shown_ms: Option<f64>) -> Table {
    let mut table = Table::new(
        "respondents",
        match excluded {
            0 => "Screening of participants; nobody is left out",
            _ => "Screening of all participants, those who are left out included",
        },
        &[
            ("respondent", "Respondent"),
            ("left", "Left"),
            ("no_preference", "None"),
            ("right", "Right"),
            ("one_sidedness", "(L \u{2212} R) / (L + R)"),
            ("longest_run", "Longest run"),
            ("comparable", "Comparable"),
            ("agreeing", "Agreeing"),
            ("agreement", "Agreement"),
            ("outlying_p", "p of outlying"),
            ("controls", "Controls"),
            ("controls_decided", "decided"),
            ("repeats", "Repeats"),
            ("repeats_opposite", "opposite"),
            ("timed", "Timed"),
            ("time_s", "Time in s"),
            ("flags", "Rules broken"),
        ],
    );
    let mut flagged = table.clone();
    for Respondent { seen, flags } in found {
        let [left, none, right] = seen.answers;
        let row = vec![
            Cell::count(seen.participant as u64 + 1),
            Cell::count(left),
            Cell::count(none),
            Cell::count(right),
            Cell::number(seen.one_sidedness(), 3),
            Cell::count(seen.longest_run),
            Cell::count(seen.comparable),
            Cell::count(seen.agreeing),
            Cell::number(seen.agreement(), 3),
            Cell::p(seen.outlying_p, 4),
            Cell::count(seen.controls),
            Cell::count(seen.controls_decided),
            Cell::count(seen.repeats),
            Cell::count(seen.repeats_opposite),
            Cell::count(seen.timed),
            Cell::number((seen.timed > 0).then(|| seen.time_ms / 1000.0), 1),
            Cell::text(flags.iter().map(|flag| flag.code()).collect::<Vec<_>>().join(" ")),
        ];
        if !flags.is_empty() {
            flagged.push(row.clone());
        }
        table.push(row);
    }
    if table.rows.len() > MANY {
        table.notes.push(format!(
            "Of {} participants those who break a rule are printed, {}; the CSV has all.",
            table.rows.len(),
            flagged.rows.len()
        ));
        flagged.caption = String::new();
        table.parts = vec![flagged];
    }
    table.notes.push(format!(
        "Controls and repeats are counted here, and nowhere else. Agreement: share of the decided answers that side with the majority of the others' decided answers, where they have \
         one. Longest run: of one side. Repeats: the same pair again, both times decided. Rules, fixed in the program: \
         one-sided (ten decided answers or more, all on one side), controls (two or more decided, and more than half), \
         repeats (two or more for the other item, and more than half), time (all timed answers together took less than what they show lasts{}), outlying (agrees on \
         less than half, and so much less than the others that p, with Bonferroni's correction and an allowance of 5, is \
         below 0.01). Only the last has seen what was preferred: a reason to look, not to exclude.",
        shown_ms.map_or(", which nobody has said: shown_s".into(), |ms| format!(", {} s each", ms / 1000.0))
    ));
    table
}

#[cfg(test)]
mod tests;
