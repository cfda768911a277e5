//! Tables that follow from the study file alone.

use crate::budgets::budgets;
use isostudy_design::record::Purpose;
use isostudy_design::{Configuration, Factor, MethodId, Study};
use isostudy_inference::inputs::Inputs;
use isostudy_inference::mesh_set::MeshSet;
use isostudy_table::{Cell, Columns, Table};

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
    let columns = Columns::over(&study.methods).column("id", "Code", |method| Cell::text(method.id)).column(
        "method",
        "Method",
        |method| Cell::text(&method.label),
    );
    with_factors(columns, study, study.declared_factors(), |method| method.id)
        .into_table("methods", "Methods")
}

/// A column for each factor, with the method's level.
pub(super) fn with_factors<R>(
    columns: Columns<R>,
    study: &Study,
    factors: impl IntoIterator<Item = Factor>,
    method: impl Fn(&R) -> MethodId,
) -> Columns<R> {
    columns.columns_of(factors, |all, factor| {
        let spec = study.factor(factor);
        all.column(spec.name.as_str(), spec.heading(), |row| level(study, method(row), factor))
    })
}

/// The programs that made meshes, as they call themselves; `None` where none did.
pub(super) fn programs(inputs: &Inputs<'_>) -> Option<Table> {
    let programs = inputs.study.methods.iter().filter_map(|method| {
        let mut of_method = inputs.meshes.iter().filter(|mesh| mesh.id.method == method.id);
        Some((method, of_method.find_map(|mesh| mesh.program.as_ref())?))
    });
    Columns::over(programs)
        .column("method", "Method", |(method, _)| Cell::text(&method.label))
        .column("program", "Program", |(_, made_by)| Cell::text(&made_by.name))
        .column("version", "Version", |(_, made_by)| Cell::text(&made_by.version))
        .column("note", "Note", |(_, made_by)| made_by.note.as_ref().map_or(Cell::Missing, Cell::text))
        .into_table("programs", "Programs")
        .unless_empty()
}

/// What failed; `None` if nothing did.
pub(super) fn left_out(inputs: &Inputs<'_>) -> Option<Table> {
    // What a program wrote has lines.
    let in_one_line = |why: &str| {
        why.lines().map(str::trim).filter(|line| !line.is_empty()).collect::<Vec<_>>().join(" / ")
    };
    Columns::over(inputs.left_out)
        .column("id", "Id", |(id, _)| Cell::text(id))
        .column("reason", "Reason", |(_, why)| Cell::text(in_one_line(why)))
        .into_table("left_out", "Left out")
        .with_note("These configurations failed, so that nothing here is about them.")
        .unless_empty()
}

/// The configurations: object, method, spacings (the paper's appendix A). Meshes that were there already have none; those that
/// meet a budget have what was found, once they are made.
pub(super) fn configurations(inputs: &Inputs<'_>) -> Table {
    let study = inputs.study;
    let [benchmark, stimuli] =
        [Purpose::Benchmark, Purpose::Stimulus].map(|purpose| MeshSet::of(inputs, purpose));
    let spacing = |of: &Configuration, meshes: &MeshSet<'_>, of_object: f64| match (
        meshes.get(&of.id),
        study.method(of.id.method).budget,
    ) {
        (Some(mesh), _) if !mesh.has_grid() => Cell::Missing,
        (Some(mesh), Some(_)) => Cell::Number(mesh.spacing, 5),
        (None, Some(_)) => Cell::Missing,
        (_, None) => Cell::Number(of_object, 3),
    };
    let columns = Columns::over(&study.configurations).column("id", "Id", |of| Cell::text(&of.id)).column(
        "object",
        "Object",
        |of| Cell::text(&study.object(of).name),
    );
    let mut table = with_factors(columns, study, method_columns(study), |of| of.id.method)
        .column("benchmark_spacing", "Cube edge, benchmark", |of| {
            spacing(of, &benchmark, study.object(of).benchmark_spacing)
        })
        .column("stimulus_spacing", "Cube edge, stimuli", |of| {
            spacing(of, &stimuli, study.object(of).stimulus_spacing)
        })
        .into_table("configurations", "Configurations");
    table.notes.extend(budgets(inputs));
    table
}

/// The questions: what is shown on which side (appendix C).
pub(super) fn questionnaire(study: &Study) -> Option<Table> {
    let table = Columns::over(&study.comparisons)
        .column("question", "Question", |of| Cell::text(&of.question))
        .column("object", "Object", |of| Cell::text(&study.file.objects[of.object].name))
        .column("left", "Left", |of| Cell::text(&of.left))
        .column("right", "Right", |of| Cell::text(&of.right))
        .column("group", "Group", |of| Cell::text(&study.groups[of.group].id))
        .into_table("questionnaire", "Questions");
    let groups: Vec<String> = study.groups.iter().map(|g| format!("{}: {}", g.id, g.label)).collect();
    table.with_note(format!("Groups. {}.", groups.join("; "))).unless_empty()
}
