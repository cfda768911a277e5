//! Machines as tables: one of times for each, what they are, and whether they agree.

use super::{Agreement, Fastest, MachineSays, Machines, PairOnMachines};
use isostudy_design::{ConfigurationId, Stage};
use isostudy_table::{Cell, Columns, Table};

const MS: f64 = 1e3;

/// What the machines are, a table of times for each, and two of their agreement; those without rows are left out.
pub fn machine_tables(of: &Machines) -> Vec<Table> {
    let mut tables = vec![machines(of)];
    tables.extend(of.machines.iter().map(times));
    tables.push(fastest(of));
    tables.push(agreement(of));
    tables.retain(|table| !table.rows.is_empty());
    tables
}

fn machines(of: &Machines) -> Table {
    let told = |text: Option<&str>| text.map_or(Cell::Missing, Cell::text);
    let floor = |says: &MachineSays, end: fn((f64, f64)) -> f64| {
        let range = says.statements.floor.range(Stage::Total);
        Cell::number(range.map(|range| 100.0 * end(range).exp_m1()), 1)
    };
    Columns::over(&of.machines)
        .column("machine", "Machine", |says| Cell::text(&says.name))
        .column("model", "Processor", |says| told(says.run.machine.model.as_deref()))
        .column("threads", "Hardware threads", |says| Cell::count(says.run.machine.threads.into()))
        .quantity("memory_gib", "Memory, {}", "GiB", |says| {
            let bytes = says.run.machine.memory_bytes;
            Cell::number(bytes.map(|bytes| bytes as f64 / (1u64 << 30) as f64), 1)
        })
        .column("os", "System", |says| Cell::text(&says.run.machine.os))
        .column("rounds", "Rounds", |says| Cell::count(says.run.iterations.into()))
        .quantity("floor_low_percent", "Noise floor, {}, from", "%", |says| floor(says, |range| range.0))
        .quantity("floor_high_percent", "to", "%", |says| floor(says, |range| range.1))
        .quantity("others_percent", "Others had up to, {}", "%", |says| {
            Cell::number(says.others().map(|share| 100.0 * share), 0)
        })
        .into_table("machines", "Machines that measured the study")
        .with_note(
            "The noise floor is each machine's own, from its A/A block. Others had so much of the CPU time in the busiest stretch of the run, \
             other machines on the host included.",
        )
}

fn times(says: &MachineSays) -> Table {
    let totals = says.statements.medians.iter().filter(|median| median.stage == Stage::Total);
    let floor = |id: &ConfigurationId| says.statements.floor.of_stage(Stage::Total, id);
    let mut table = Columns::over(totals)
        .column("id", "Id", |median| Cell::text(&median.id))
        .column("samples", "Samples", |median| Cell::count(median.samples as u64))
        .quantity("total_ms", "Total, {}", "ms", |median| Cell::Number(MS * median.seconds.median, 3))
        .quantity("total_low_ms", "from", "ms", |median| {
            Cell::number(median.seconds.interval.map(|i| MS * i.low), 3)
        })
        .quantity("total_high_ms", "to", "ms", |median| {
            Cell::number(median.seconds.interval.map(|i| MS * i.high), 3)
        })
        .quantity("floor_percent", "Noise floor, {}", "%", |median| {
            Cell::number(floor(&median.id).map(|floor| 100.0 * floor.exp_m1()), 1)
        })
        .into_table(&format!("times_on_{}", says.name), format!("Median times on {}", says.name));
    table.notes.extend(says.statements.warnings.clone());
    table
}

fn names(ids: &[ConfigurationId]) -> Cell {
    Cell::text(ids.iter().map(|id| id.method.to_string()).collect::<Vec<_>>().join(", "))
}

fn fastest(of: &Machines) -> Table {
    let columns = Columns::over(&of.fastest).column("object", "Object", |found| Cell::text(&found.object));
    let columns = columns.columns_of(of.machines.iter().enumerate(), |columns, (place, says)| {
        columns.column(says.name.clone(), says.name.clone(), move |found: &&Fastest| names(&found.on[place]))
    });
    columns
        .column("on_all", "On all machines", |found| names(&found.on_all))
        .into_table("machine_fastest", "Methods that may take the least time, by machine")
        .with_note(
            "No other method is faster beyond that machine's noise floor. The least median comes first.",
        )
}

fn agreement(of: &Machines) -> Table {
    let columns = Columns::over(&of.pairs).column("first", "First", |pair| Cell::text(&pair.first)).column(
        "second",
        "Second",
        |pair| Cell::text(&pair.second),
    );
    let columns = columns.columns_of(of.machines.iter().enumerate(), |columns, (place, says)| {
        let name = &says.name;
        columns
            .column(
                format!("{name}_ratio"),
                format!("second / first on {name}"),
                move |pair: &&PairOnMachines| Cell::number(pair.on[place].map(|(ratio, ..)| ratio), 3),
            )
            .column(
                format!("{name}_verdict"),
                format!("on {name} second is"),
                move |pair: &&PairOnMachines| {
                    pair.on[place].map_or(Cell::Missing, |(.., verdict)| Cell::text(verdict.label()))
                },
            )
    });
    let mut table = columns
        .column("agreement", "Machines", |pair| Cell::text(pair.agreement.label()))
        .into_table("machine_agreement", "Whether machines agree on each pair");
    table.rows.sort_by_key(|row| row.last() != Some(&Cell::text(Agreement::Contradicted.label())));
    table.with_note(
        "Each ratio is of one machine. A verdict needs an interval of 95 % beyond that machine's noise floor, and the same direction in each \
         third of its run.",
    )
}
