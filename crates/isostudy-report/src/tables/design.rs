//! Tables that follow from the study file alone.

use crate::budgets::budgets;
use isostudy_design::record::{MadeBy, Purpose};
use isostudy_design::{Factor, MethodId, Study};
use isostudy_inference::inputs::Inputs;
use isostudy_inference::mesh_set::MeshSet;
use isostudy_table::{Cell, Table};

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

/// The programs that made meshes, as they call themselves; `None` where none did.
pub(super) fn programs(inputs: &Inputs<'_>) -> Option<Table> {
    let columns = [("method", "Method"), ("program", "Program"), ("version", "Version"), ("note", "Note")];
    let mut table = Table::new("programs", "Programs", &columns);
    for method in &inputs.study.methods {
        let mut of_method = inputs.meshes.iter().filter(|mesh| mesh.id.method == method.id);
        if let Some(MadeBy { name, version, note }) = of_method.find_map(|mesh| mesh.program.as_ref()) {
            let note = note.as_ref().map_or(Cell::Missing, Cell::text);
            table.push(vec![Cell::text(&method.label), Cell::text(name), Cell::text(version), note]);
        }
    }
    (!table.rows.is_empty()).then_some(table)
}

/// What failed; `None` if nothing did.
pub(super) fn left_out(inputs: &Inputs<'_>) -> Option<Table> {
    let mut table = Table::new("left_out", "Left out", &[("id", "Id"), ("reason", "Reason")]);
    for (id, why) in inputs.left_out {
        // What a program wrote has lines.
        let why: Vec<&str> = why.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
        table.push(vec![Cell::text(id), Cell::text(why.join(" / "))]);
    }
    table
        .notes
        .push("The programs of these configurations failed, so that nothing here is about them.".into());
    (!table.rows.is_empty()).then_some(table)
}

/// The configurations: object, method, spacings (the paper's appendix A). Meshes that were there already have none; those that
/// meet a budget have what was found, once they are made.
pub(super) fn configurations(inputs: &Inputs<'_>) -> Table {
    let study = inputs.study;
    let made = [Purpose::Benchmark, Purpose::Stimulus].map(|purpose| MeshSet::of(inputs, purpose));
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
        let budget = study.method(configuration.id.method).budget;
        for (meshes, of_object) in made.iter().zip([object.benchmark_spacing, object.stimulus_spacing]) {
            row.push(match (meshes.get(&configuration.id), budget) {
                (Some(mesh), _) if !mesh.has_grid() => Cell::Missing,
                (Some(mesh), Some(_)) => Cell::Number(mesh.spacing, 5),
                (None, Some(_)) => Cell::Missing,
                (_, None) => Cell::Number(of_object, 3),
            });
        }
        table.push(row);
    }
    table.notes.extend(budgets(inputs));
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
