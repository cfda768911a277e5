//! Power of a design: every number as a table for programs, contrasts by participants as one to read.

use isostudy_inference::power::{Assumptions, Power, QUESTIONS};
use isostudy_table::{Cell, Columns, Table};

/// The tables `power`, a row a number, and `power_by_participants`, a column a number of participants, of [`power`](isostudy_inference::power::power).
pub fn power_tables(assumptions: &Assumptions, all: &[Power]) -> [Table; 2] {
    [in_full(all), by_participants(assumptions, all)]
}

fn in_full(all: &[Power]) -> Table {
    Columns::over(all)
        .column("family", "Family", |of| Cell::text(&of.family))
        .column("contrast", "Contrast", |of| Cell::text(&of.contrast))
        .column("scope", "Over", |of| Cell::text(&of.scope))
        .column("questions", "Questions", |of| Cell::count(of.questions as u64))
        .column("share", "Share of decided", |of| Cell::Number(of.share, 3))
        .column("participants", "Participants", |of| Cell::count(of.participants as u64))
        .column("power", "Power", |of| Cell::Number(of.power, 3))
        .column("power_error", "Monte-Carlo error", |of| Cell::Number(of.errors()[0], 4))
        .column("power_adjusted", "Power, adjusted", |of| Cell::Number(of.adjusted, 3))
        .column("power_adjusted_error", "Monte-Carlo error", |of| Cell::Number(of.errors()[1], 4))
        .into_table("power", "Power of every contrast and question")
}

fn by_participants(assumptions: &Assumptions, all: &[Power]) -> Table {
    let mut rows: Vec<&[Power]> = all.chunks(assumptions.participants.len()).collect();
    rows.retain(|row| row[0].family != QUESTIONS);
    // Stable: shares of one contrast follow one another.
    rows.sort_by_key(|row| {
        all.iter().position(|p| (&p.contrast, &p.scope) == (&row[0].contrast, &row[0].scope))
    });
    let caption = "Power by number of participants N; in brackets with adjustment in the contrast's family";
    let table = Columns::over(rows)
        .column("contrast", "Contrast", |row| Cell::text(&row[0].contrast))
        .column("scope", "Over", |row| Cell::text(&row[0].scope))
        .column("questions", "Questions", |row| Cell::count(row[0].questions as u64))
        .column("share", "Share of decided", |row| Cell::Number(row[0].share, 2))
        .columns_of(assumptions.participants.iter().enumerate(), |all, (i, n)| {
            all.column(format!("power_{n}"), format!("N = {n}"), |row| {
                Cell::text(format!("{:.2} ({:.2})", row[i].power, row[i].adjusted))
            })
        })
        .into_table("power_by_participants", caption);
    let level =
        all.first().map_or_else(String::new, |power| format!("{} %", (1e6 * power.level).round() / 1e4));
    let largest = all.iter().flat_map(Power::errors).fold(0.0, f64::max);
    table.with_note(format!(
        "Exact sign-flip test over participants at {level}, two-sided; {} simulated studies a share, Monte-Carlo standard error at \
         most {largest:.3}. Assumed: in every contrast the first is chosen in this share of decided answers by a person who \
         does not deviate; differences between people have standard deviation {} logits, between objects {}; Davidson's tie \
         parameter {}. Rejections in favour of the other do not count. Objects are taken as they are: \
         what is preferred on these alone is found too. Seed {}.",
        assumptions.studies, assumptions.person_sd, assumptions.object_sd, assumptions.ties, assumptions.seed
    ))
}
