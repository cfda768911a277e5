//! Tables that follow from the study file alone.

use ::design::{Factor, MethodId, Study};
use table::{Cell, Table};

/// The factors that tell a method in a table: the declared ones, or what it is as a whole where these do not tell two apart.
pub(super) fn method_columns(study: &Study) -> Vec<Factor> {
    let declared: Vec<Factor> = study.declared_factors().collect();
    let mut known = Vec::new();
    let told = study.methods.iter().all(|method| {
        let new = method.levels.iter().all(Option::is_some) && !known.contains(&&method.levels);
        known.push(&method.levels);
        new
    });
    if told && !declared.is_empty() { declared } else { [declared, vec![study.method_factor()]].concat() }
}

/// A method's level, by name; empty if it has none.
pub(super) fn level(study: &Study, method: MethodId, factor: Factor) -> Cell {
    let level = study.level_of(method, factor);
    level.map_or(Cell::Missing, |level| Cell::text(&study.level(level).label))
}

/// The methods in words.
pub(super) fn methods(study: &Study) -> Table {
    let factors: Vec<Factor> = study.declared_factors().collect();
    let mut columns = vec![("id".to_owned(), "Code".to_owned()), ("method".into(), "Method".into())];
    columns.extend(factors.iter().map(|&factor| {
        let spec = study.factor(factor);
        (spec.name.clone(), spec.heading())
    }));
    let columns: Vec<(&str, &str)> = columns.iter().map(|(name, heading)| (&**name, &**heading)).collect();
    let mut table = Table::new("methods", "Methods", &columns);
    for method in &study.methods {
        let mut row = vec![Cell::text(method.id), Cell::text(&method.label)];
        row.extend(factors.iter().map(|&factor| level(study, method.id, factor)));
        table.push(row);
    }
    table
}

/// The configurations: object, method, spacings (the paper's appendix A).
pub(super) fn configurations(study: &Study) -> Table {
    let mut columns = vec![("id".to_owned(), "Id".to_owned()), ("object".into(), "Object".into())];
    let factors = method_columns(study);
    columns.extend(factors.iter().map(|&factor| {
        let spec = study.factor(factor);
        (spec.name.clone(), spec.heading())
    }));
    columns.push(("benchmark_spacing".into(), "Cube edge, benchmark".into()));
    columns.push(("stimulus_spacing".into(), "Cube edge, stimuli".into()));
    let columns: Vec<(&str, &str)> = columns.iter().map(|(name, heading)| (&**name, &**heading)).collect();
    let mut table = Table::new("configurations", "Configurations", &columns);
    for configuration in &study.configurations {
        let object = study.object(configuration);
        let mut row = vec![Cell::text(&configuration.id), Cell::text(&object.name)];
        row.extend(factors.iter().map(|&factor| level(study, configuration.id.method, factor)));
        row.push(Cell::Number(object.benchmark_spacing, 3));
        row.push(Cell::Number(object.stimulus_spacing, 3));
        table.push(row);
    }
    table
}

/// The questions: what is shown on which side (appendix C).
pub(super) fn questionnaire(study: &Study) -> Option<Table> {
    let mut table = Table::new(
        "questionnaire",
        "Questions",
        &[
            ("question", "Question"),
            ("object", "Object"),
            ("left", "Left"),
            ("right", "Right"),
            ("group", "Group"),
        ],
    );
    for comparison in &study.comparisons {
        table.push(vec![
            Cell::text(&comparison.question),
            Cell::text(&study.file.objects[comparison.object].name),
            Cell::text(&comparison.left),
            Cell::text(&comparison.right),
            Cell::text(&study.groups[comparison.group].id),
        ]);
    }
    let groups: Vec<String> = study.groups.iter().map(|g| format!("{}: {}", g.id, g.label)).collect();
    table.notes.push(format!("Groups. {}.", groups.join("; ")));
    (!table.rows.is_empty()).then_some(table)
}
