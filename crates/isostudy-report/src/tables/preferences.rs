//! The preference factors: per group, overall, margins, and per object.

use isostudy_design::{Level, MethodId, Study};
use isostudy_inference::preference::{self, GroupFactor, interval};
use isostudy_inference::tally::Tally;
use isostudy_table::{Cell, Columns, Table};

pub(super) fn all(study: &Study, tally: &Tally) -> Vec<Table> {
    let factors = preference::group_factors(study, tally, |_| true);
    let mut tables = vec![groups(study, &factors), overall(study, &factors), margins(study, &factors)];
    tables.push(objects(study, tally));
    tables.retain(|table| !table.rows.is_empty());
    tables
}

fn groups(study: &Study, factors: &[GroupFactor]) -> Table {
    let table = Columns::over(factors)
        .column("group", "Group", |of| Cell::text(&study.groups[of.group].id))
        .column("configuration", "Configuration", |of| Cell::text(of.method))
        .column("wins", "Wins", |of| Cell::count(of.share.wins))
        .column("ties", "Ties", |of| Cell::count(of.share.ties))
        .column("answers", "Answers", |of| Cell::count(of.share.answers))
        .column("factor", "Factor", |of| Cell::Number(of.share.factor().value(), 3))
        .column("cap", "Largest possible", |of| Cell::Number(of.cap().value(), 3))
        .column("appearances", "Appearances", |of| Cell::count(of.appearances))
        .column("appearance_share", "Wins / appearances", |of| {
            Cell::number(of.appearance_share().map(|share| share.value()), 3)
        })
        .into_table("preference_groups", "Preference factors per comparison group");
    table.with_note(
        "Factor: wins over all answers to the group's questions. Ties: the group's answers without preference. A \
         configuration that is shown in only some of its group's questions cannot reach 1, so factors of groups of \
         different size are not on one scale. Wins over appearances have the same limits, but not the same opponents, so they are \
         no scale either. Worths are on one scale: see that table.",
    )
}

fn overall(study: &Study, factors: &[GroupFactor]) -> Table {
    let overall = preference::overall(study, factors);
    let mut table = Columns::over(&overall)
        .column("configuration", "Configuration", |(method, _)| Cell::text(method))
        .column("factor", "Sum of factors", |(_, sum)| Cell::Number(sum.value(), 3))
        .into_table("preference_overall", "Overall preference: sums of group factors");
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
    let margin =
        |of: Level| Cell::number(margins.iter().find(|(m, _)| *m == of).map(|(_, mean)| mean.value()), 3);
    let has = |method: MethodId, level: Level| study.level_of(method, level.factor) == Some(level);
    let both = |row: Level, column: Level| {
        let found = overall.iter().find(|(method, _)| has(*method, row) && has(*method, column));
        Cell::number(found.map(|(_, sum)| sum.value()), 3)
    };
    let label = |level: &Option<Level>| Cell::text(level.map_or("mean", |level| &study.level(level).label));
    // `None` is the mean's row.
    let table = Columns::over(study.levels(down).into_iter().map(Some).chain([None]))
        .column(first.name.as_str(), first.heading(), label)
        .columns_of(study.levels(across), |all, column| {
            let label = study.level(column).label.as_str();
            all.column(label, label, |row| row.map_or_else(|| margin(column), |row| both(row, column)))
        })
        .column("mean", "mean", |row| row.map_or(Cell::Missing, margin))
        .into_table("preference_overall", "");
    Some(table)
}

fn margins(study: &Study, factors: &[GroupFactor]) -> Table {
    Columns::over(preference::margins(study, &preference::overall(study, factors)))
        .column("margin", "Mean over", |(level, _)| Cell::text(&study.factor(level.factor).name))
        .column("code", "Code", |(level, _)| Cell::text(study.level(*level).code.to_lowercase()))
        .column("label", "Methods", |(level, _)| Cell::text(&study.level(*level).label))
        .column("factor", "Mean of sums", |(_, mean)| Cell::Number(mean.value(), 3))
        .into_table("preference_margins", "Means of overall preference")
}

fn objects(study: &Study, tally: &Tally) -> Table {
    let rows = study.file.objects.iter().enumerate().flat_map(|(o, object)| {
        let factors = preference::group_factors(study, tally, |other| other == o).into_iter();
        factors.map(move |of| (object, interval(tally, &of, o), of))
    });
    let table = Columns::over(rows)
        .column("object", "Object", |(object, ..)| Cell::text(&object.name))
        .column("group", "Group", |(.., of)| Cell::text(&study.groups[of.group].id))
        .column("configuration", "Configuration", |(.., of)| Cell::text(of.method))
        .column("wins", "Wins", |(.., of)| Cell::count(of.share.wins))
        .column("ties", "Ties", |(.., of)| Cell::count(of.share.ties))
        .column("answers", "Answers", |(.., of)| Cell::count(of.share.answers))
        .column("factor", "Factor", |(.., of)| Cell::Number(of.share.factor().value(), 3))
        .column("low", "from", |(_, interval, _)| Cell::number(interval.map(|i| i.low), 3))
        .column("high", "to", |(_, interval, _)| Cell::number(interval.map(|i| i.high), 3))
        .into_table("preference_objects", "Preference factors per object");
    table.with_note(
        "From and to: interval at 95 % over respondents, each person's factor counting as one observation. Wilson's where \
         each gave one answer, else the t interval, cut at 0 and at the largest possible factor.",
    )
}
