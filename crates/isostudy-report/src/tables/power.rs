//! Power of a design: every number as a table for programs, contrasts by participants as one to read.

use isostudy_inference::power::{Assumptions, Power, QUESTIONS};
use isostudy_table::{Cell, Table};

/// The tables `power`, a row a number, and `power_by_participants`, a column a number of participants, of [`power`](isostudy_inference::power::power).
pub fn power_tables(assumptions: &Assumptions, all: &[Power]) -> [Table; 2] {
    [in_full(all), by_participants(assumptions, all)]
}

fn in_full(all: &[Power]) -> Table {
    let columns = [
        ("family", "Family"),
        ("contrast", "Contrast"),
        ("scope", "Over"),
        ("questions", "Questions"),
        ("share", "Share of decided"),
        ("participants", "Participants"),
        ("power", "Power"),
        ("power_error", "Monte-Carlo error"),
        ("power_adjusted", "Power, adjusted"),
        ("power_adjusted_error", "Monte-Carlo error"),
    ];
    let mut table = Table::new("power", "Power of every contrast and question", &columns);
    for power in all {
        let [error, adjusted_error] = power.errors();
        table.push(vec![
            Cell::text(&power.family),
            Cell::text(&power.contrast),
            Cell::text(&power.scope),
            Cell::count(power.questions as u64),
            Cell::number(Some(power.share), 3),
            Cell::count(power.participants as u64),
            Cell::number(Some(power.power), 3),
            Cell::number(Some(error), 4),
            Cell::number(Some(power.adjusted), 3),
            Cell::number(Some(adjusted_error), 4),
        ]);
    }
    table
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
