//! Power of a design: every number as a table for programs, contrasts by participants as one to read.

use isostudy_inference::power::{Assumptions, Power, QUESTIONS};
use isostudy_table::{Cell, Table, field};

/// The tables `power`, a row a number, and `power_by_participants`, a column a number of participants, of [`power`](isostudy_inference::power::power).
pub fn power_tables(assumptions: &Assumptions, all: &[Power]) -> [Table; 2] {
    [in_full(all), by_participants(assumptions, all)]
}

fn in_full(all: &[Power]) -> Table {
    let fields = [
        field("family", "Family", |of: &&Power| Cell::text(&of.family)),
        field("contrast", "Contrast", |of| Cell::text(&of.contrast)),
        field("scope", "Over", |of| Cell::text(&of.scope)),
        field("questions", "Questions", |of| Cell::count(of.questions as u64)),
        field("share", "Share of decided", |of| Cell::Number(of.share, 3)),
        field("participants", "Participants", |of| Cell::count(of.participants as u64)),
        field("power", "Power", |of| Cell::Number(of.power, 3)),
        field("power_error", "Monte-Carlo error", |of| Cell::Number(of.errors()[0], 4)),
        field("power_adjusted", "Power, adjusted", |of| Cell::Number(of.adjusted, 3)),
        field("power_adjusted_error", "Monte-Carlo error", |of| Cell::Number(of.errors()[1], 4)),
    ];
    Table::of("power", "Power of every contrast and question", &fields, all)
}

fn by_participants(assumptions: &Assumptions, all: &[Power]) -> Table {
    let mut columns: Vec<(String, String)> = [
        ("contrast", "Contrast"),
        ("scope", "Over"),
        ("questions", "Questions"),
        ("share", "Share of decided"),
    ]
    .map(|(name, heading)| (name.to_owned(), heading.to_owned()))
    .into();
    columns.extend(assumptions.participants.iter().map(|n| (format!("power_{n}"), format!("N = {n}"))));
    let columns: Vec<(&str, &str)> = columns.iter().map(|(name, heading)| (&**name, &**heading)).collect();
    let caption = "Power by number of participants N; in brackets with adjustment in the contrast's family";
    let mut table = Table::new("power_by_participants", caption, &columns);
    let mut rows: Vec<&[Power]> = all.chunks(assumptions.participants.len()).collect();
    rows.retain(|row| row[0].family != QUESTIONS);
    // Stable: shares of one contrast follow one another.
    rows.sort_by_key(|row| {
        all.iter().position(|p| (&p.contrast, &p.scope) == (&row[0].contrast, &row[0].scope))
    });
    for row in rows {
        let first = &row[0];
        let mut cells = vec![
            Cell::text(&first.contrast),
            Cell::text(&first.scope),
            Cell::count(first.questions as u64),
            Cell::number(Some(first.share), 2),
        ];
        cells.extend(row.iter().map(|p| Cell::text(format!("{:.2} ({:.2})", p.power, p.adjusted))));
        table.push(cells);
    }
    let level =
        all.first().map_or_else(String::new, |power| format!("{} %", (1e6 * power.level).round() / 1e4));
    let largest = all.iter().flat_map(Power::errors).fold(0.0, f64::max);
    table.notes.push(format!(
        "Exact sign-flip test over participants at {level}, two-sided; {} simulated studies a share, Monte-Carlo standard error at \
         most {largest:.3}. Assumed: in every contrast the first is chosen in this share of decided answers by a person who \
         does not deviate; differences between people have standard deviation {} logits, between objects {}; Davidson's tie \
         parameter {}. Rejections in favour of the other do not count. Objects are taken as they are: \
         what is preferred on these alone is found too. Seed {}.",
        assumptions.studies, assumptions.person_sd, assumptions.object_sd, assumptions.ties, assumptions.seed
    ));
    table
}
