//! Tables that follow from the study file alone.

use crate::table::{Cell, Table};
use ::design::Study;

/// The configurations: object, arrangement, clustering, spacings (the paper's appendix A).
pub(super) fn configurations(study: &Study) -> Table {
    let mut table = Table::new(
        "configurations",
        "Configurations",
        &[
            ("id", "Id"),
            ("object", "Object"),
            ("arrangement", "Arrangement"),
            ("clustering", "Clustering"),
            ("benchmark_spacing", "Cube edge, benchmark"),
            ("stimulus_spacing", "Cube edge, stimuli"),
        ],
    );
    for configuration in &study.configurations {
        let object = study.object(configuration);
        table.push(vec![
            Cell::text(&configuration.id),
            Cell::text(&object.name),
            Cell::text(configuration.id.method.arrangement.label()),
            Cell::text(configuration.id.method.clustering.label()),
            Cell::Number(object.benchmark_spacing, 3),
            Cell::Number(object.stimulus_spacing, 3),
        ]);
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
