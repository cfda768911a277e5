//! The preference factors: per group, overall, margins, and per object.

use isostudy_design::{Factor, Level, MethodId, Study};
use isostudy_inference::preference::{self, GroupFactor, interval};
use isostudy_inference::tally::Tally;
use isostudy_table::{Cell, Column, Table};

pub(super) fn all(study: &Study, tally: &Tally) -> Vec<Table> {
    let factors = preference::group_factors(study, tally, |_| true);
    let mut tables = vec![groups(study, &factors), overall(study, &factors), margins(study, &factors)];
    tables.push(objects(study, tally));
    tables.retain(|table| !table.rows.is_empty());
    tables
}

fn groups(study: &Study, factors: &[GroupFactor]) -> Table {
    let mut table = Table::new(
        "preference_groups",
        "Preference factors per comparison group",
        &[
            ("group", "Group"),
            ("configuration", "Configuration"),
            ("wins", "Wins"),
            ("ties", "Ties"),
            ("answers", "Answers"),
            ("factor", "Factor"),
            ("cap", "Largest possible"),
            ("appearances", "Appearances"),
            ("appearance_share", "Wins / appearances"),
        ],
    );
    for factor in factors {
        table.push(vec![
            Cell::text(&study.groups[factor.group].id),
            Cell::text(factor.method),
            Cell::count(factor.share.wins),
            Cell::count(factor.share.ties),
            Cell::count(factor.share.answers),
            Cell::Number(factor.share.factor().value(), 3),
            Cell::Number(factor.cap().value(), 3),
            Cell::count(factor.appearances),
            Cell::number(factor.appearance_share().map(|share| share.value()), 3),
        ]);
    }
    table.notes.push(
        "Factor: wins over all answers to the group's questions. Ties: the group's answers without preference. A \
         configuration that is shown in only some of its group's questions cannot reach 1, so factors of groups of \
         different size are not on one scale; wins over appearances are."
            .into(),
    );
    table
}

fn overall(study: &Study, factors: &[GroupFactor]) -> Table {
    let overall = preference::overall(study, factors);
    let mut table = Table::new(
        "preference_overall",
        "Overall preference: sums of group factors",
        &[("configuration", "Configuration"), ("factor", "Sum of factors")],
    );
    for &(method, sum) in &overall {
        table.push(vec![Cell::text(method), Cell::Number(sum.value(), 3)]);
    }
    table.parts.extend(grid(study, &overall));
    let mut note = "A sum adds factors of different scale.".to_owned();
    if let Some([outer, inner]) = preference::two_factors(study) {
        let of_one_level =
            |group: &&isostudy_design::Group| preference::shared(study, group, outer).is_some();
        if study.groups.iter().filter(of_one_level).count() > 1 {
            let [outer, inner] = [outer, inner].map(|factor| &study.factor(factor).name);
            note.push_str(&format!(
                " The {inner} groups' part of {} {outer}'s mean is the same for any outcome but for ties, so it says nothing \
                 about {outer}s.",
                preference::article(outer)
            ));
        }
    }
    table.notes.push(note);
    table
}

/// The paper's arrangement of a study whose methods have two factors: the levels of the first down, those of the second across,
/// means at the ends.
fn grid(study: &Study, overall: &[(MethodId, isostudy_inference::fraction::Fraction)]) -> Option<Table> {
    let [down, across] = preference::two_factors(study)?;
    let margins = preference::margins(study, overall);
    let first = study.factor(down);
    let mut table = Table::new("preference_overall", "", &[(&*first.name, &*first.heading())]);
    let heading = |text: &str| Column { name: text.into(), heading: text.into() };
    table.columns.extend(study.factor(across).levels.iter().map(|level| heading(&level.label)));
    table.columns.push(heading("mean"));
    let margin = |of: Level| margins.iter().find(|(m, _)| *m == of).map(|(_, mean)| mean.value());
    let has = |method: MethodId, factor: Factor, level: Level| study.level_of(method, factor) == Some(level);
    for row_level in study.levels(down) {
        let mut row = vec![Cell::text(&study.level(row_level).label)];
        for level in study.levels(across) {
            let of = |(m, _): &&(MethodId, _)| has(*m, down, row_level) && has(*m, across, level);
            row.push(Cell::number(overall.iter().find(of).map(|(_, sum)| sum.value()), 3));
        }
        row.push(Cell::number(margin(row_level), 3));
        table.push(row);
    }
    let mut row = vec![Cell::text("mean")];
    row.extend(study.levels(across).into_iter().map(|level| Cell::number(margin(level), 3)));
    row.push(Cell::Missing);
    table.push(row);
    Some(table)
}

fn margins(study: &Study, factors: &[GroupFactor]) -> Table {
    let mut table = Table::new(
        "preference_margins",
        "Means of overall preference",
        &[("margin", "Mean over"), ("code", "Code"), ("label", "Methods"), ("factor", "Mean of sums")],
    );
    for (level, mean) in preference::margins(study, &preference::overall(study, factors)) {
        table.push(vec![
            Cell::text(&study.factor(level.factor).name),
            Cell::text(study.level(level).code.to_lowercase()),
            Cell::text(&study.level(level).label),
            Cell::Number(mean.value(), 3),
        ]);
    }
    table
}

fn objects(study: &Study, tally: &Tally) -> Table {
    let mut table = Table::new(
        "preference_objects",
        "Preference factors per object",
        &[
            ("object", "Object"),
            ("group", "Group"),
            ("configuration", "Configuration"),
            ("wins", "Wins"),
            ("ties", "Ties"),
            ("answers", "Answers"),
            ("factor", "Factor"),
            ("low", "from"),
            ("high", "to"),
        ],
    );
    for (o, object) in study.file.objects.iter().enumerate() {
        for factor in preference::group_factors(study, tally, |other| other == o) {
            let interval = interval(tally, &factor, o);
            table.push(vec![
                Cell::text(&object.name),
                Cell::text(&study.groups[factor.group].id),
                Cell::text(factor.method),
                Cell::count(factor.share.wins),
                Cell::count(factor.share.ties),
                Cell::count(factor.share.answers),
                Cell::Number(factor.share.factor().value(), 3),
                Cell::number(interval.map(|i| i.low), 3),
                Cell::number(interval.map(|i| i.high), 3),
            ]);
        }
    }
    table.notes.push(
        "From and to: interval at 95 % over respondents, each person's factor counting as one observation. Wilson's where \
         each gave one answer, else the t interval, cut at 0 and at the largest possible factor."
            .into(),
    );
    table
}
