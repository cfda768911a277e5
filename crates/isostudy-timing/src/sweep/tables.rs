//! A sweep as tables.

use super::budgets::Cost;
use super::{FIT_FROM, Growth, Quantity, Sweep};
use crate::BUSY;
use isostudy_table::{Cell, Table};

const MS: f64 = 1e3;

/// Points, exponents, speed-ups, and what is the most regular for a cost; empty ones are left out.
pub fn sweep_tables(sweep: &Sweep) -> Vec<Table> {
    let mut tables = vec![exponents(sweep), speed_ups(sweep), budgets(sweep), points(sweep)];
    tables.retain(|table| !table.rows.is_empty());
    tables
}

fn name(quantity: Quantity) -> String {
    match quantity {
        Quantity::Time(stage) => stage.label().into(),
        Quantity::Memory => "memory".into(),
        Quantity::Triangles => "triangles".into(),
        Quantity::Samples => "sample points".into(),
    }
}

fn exponents(sweep: &Sweep) -> Table {
    let columns = [
        ("id", "Id"),
        ("threads", "Threads"),
        ("quantity", "Quantity"),
        ("exponent", "Exponent"),
        ("low", "from"),
        ("high", "to"),
        ("points", "Points"),
    ];
    let mut table = Table::new("sweep_exponents", "How cost grows with the cells per axis", &columns);
    for growth in &sweep.growth {
        let end = |end: fn(isostudy_statistics::interval::Interval) -> f64| {
            Cell::number(growth.law.interval.map(end), 3)
        };
        table.push(vec![
            Cell::text(&growth.id),
            Cell::count(growth.threads.into()),
            Cell::text(name(growth.quantity)),
            Cell::Number(growth.law.exponent, 3),
            end(|i| i.low),
            end(|i| i.high),
            Cell::count(growth.law.points as u64),
        ]);
    }
    let mut threads: Vec<u32> = sweep.growth.iter().map(|growth| growth.threads).collect();
    threads.dedup();
    threads.sort_unstable();
    threads.dedup();
    for threads in threads {
        let own: Vec<&Growth> = sweep.growth.iter().filter(|growth| growth.threads == threads).collect();
        table.parts.push(exponents_of(threads, &own));
    }
    table.notes.push(format!(
        "A quantity grows as cells per axis to this power, from {FIT_FROM} cells on; 95 % t intervals of the slope on \
         logarithms, which tell how far the points are from a power law. A body has cells\u{b3} sample points and its surface \
         cells\u{b2} triangles. Clustering is the edge collapse; memory is what extraction had resident at most."
    ));
    table.notes.extend(sweep.others.filter(|others| *others > BUSY).map(|others| {
        format!(
            "This machine was not quiet: others had up to {:.0} % of the CPU time. Times, their exponents and speed-ups are \
             worth little; counts, memory and regularity are not touched.",
            100.0 * others
        )
    }));
    table
}

/// One row a configuration, one column a quantity.
fn exponents_of(threads: u32, own: &[&Growth]) -> Table {
    let mut quantities: Vec<String> = Vec::new();
    for growth in own {
        let name = name(growth.quantity);
        if !quantities.contains(&name) {
            quantities.push(name);
        }
    }
    let mut columns = vec![("id", "Id")];
    columns.extend(quantities.iter().map(|name| (name.as_str(), name.as_str())));
    let noun = if threads == 1 { "thread" } else { "threads" };
    let mut table = Table::new("sweep_exponents", format!("On {threads} {noun}"), &columns);
    let mut ids: Vec<_> = own.iter().map(|growth| &growth.id).collect();
    ids.dedup();
    for id in ids {
        let mut row = vec![Cell::text(id)];
        row.extend(quantities.iter().map(|wanted| {
            let found = own.iter().find(|growth| growth.id == *id && name(growth.quantity) == *wanted);
            found.map_or(Cell::Missing, |growth| {
                let half = growth.law.interval.map(|i| (i.high - i.low) / 2.0);
                let spread = half.map_or(String::new(), |half| format!(" \u{b1} {half:.2}"));
                Cell::text(format!("{:.2}{spread}", growth.law.exponent))
            })
        }));
        table.push(row);
    }
    table
}

fn speed_ups(sweep: &Sweep) -> Table {
    let columns = [
        ("id", "Id"),
        ("cells", "Cells"),
        ("threads", "Threads"),
        ("speed_up", "Speed-up"),
        ("low", "from"),
        ("high", "to"),
        ("efficiency", "Efficiency"),
    ];
    let mut table = Table::new("sweep_speed_up", "What more threads are worth", &columns);
    let fewest = sweep.points.iter().map(|point| point.threads).min().unwrap_or(1);
    for found in &sweep.speed_ups {
        let end = |end: fn(isostudy_statistics::interval::Interval) -> f64| {
            Cell::number(found.interval.map(end), 2)
        };
        table.push(vec![
            Cell::text(&found.id),
            Cell::count(found.cells.into()),
            Cell::count(found.threads.into()),
            Cell::Number(found.ratio, 2),
            end(|i| i.low),
            end(|i| i.high),
            Cell::Number(found.ratio * f64::from(fewest) / f64::from(found.threads), 2),
        ]);
    }
    table.notes.push(format!(
        "Median time on {fewest} over median time on so many threads; intervals from both medians' order statistics, at 95 % for all \
         configurations of a resolution together, where the rounds suffice for that. Efficiency is the speed-up over the share of threads."
    ));
    table
}

fn budgets(sweep: &Sweep) -> Table {
    let columns = [
        ("object", "Object"),
        ("cost", "For"),
        ("rank", "Rank"),
        ("method", "Method"),
        ("radius_ratio_mean", "Mean radius ratio"),
        ("cells", "Cells"),
        ("triangles", "Triangles"),
    ];
    let mut table = Table::new("sweep_quality", "The most regular triangles for a cost", &columns);
    for budget in &sweep.budgets {
        let cost = match budget.cost {
            Cost::Triangles(triangles) => format!("{triangles:.0} triangles"),
            Cost::Seconds(seconds) => format!("{:.2} ms", MS * seconds),
        };
        for (rank, best) in (1..).zip(&budget.methods) {
            table.push(vec![
                Cell::text(&budget.object),
                Cell::text(&cost),
                Cell::count(rank),
                Cell::text(best.method),
                Cell::Number(best.radius_ratio, 4),
                Cell::Number(best.cells, 0),
                Cell::Number(best.triangles, 0),
            ]);
        }
    }
    table.notes.push(
        "Each method at the resolution that the cost buys it, interpolated between measured ones; the cost is the middle, on \
         logarithms, of what all methods of the object reach. Times are those on the fewest threads."
            .into(),
    );
    table
}

fn points(sweep: &Sweep) -> Table {
    let mut columns = vec![
        ("id", "Id"),
        ("cells", "Cells"),
        ("threads", "Threads"),
        ("samples", "Sample points"),
        ("vertices", "Vertices"),
        ("triangles", "Triangles"),
        ("radius_ratio_mean", "Mean radius ratio"),
        ("total_ms", "Total, ms"),
        ("total_low_ms", "from"),
        ("total_high_ms", "to"),
    ];
    columns.extend([
        ("allocation_ms", "Allocation"),
        ("sampling_ms", "Sampling"),
        ("vertex_ms", "Vertex"),
        ("geometry_ms", "Geometry"),
        ("clustering_ms", "Clustering"),
        ("normals_ms", "Normals"),
        ("ns_per_sample", "ns a sample point"),
        ("ns_per_triangle", "ns a triangle"),
        ("memory_mib", "Memory, MiB"),
    ]);
    let mut table = Table::new("sweep", "Every resolution and thread count", &columns);
    for point in &sweep.points {
        let total = point.total_s;
        let end = |end: fn(isostudy_statistics::interval::Interval) -> f64| {
            Cell::number(total.interval.map(|i| MS * end(i)), 3)
        };
        let each = |count: u64| Cell::number((count > 0).then(|| 1e9 * total.median / count as f64), 1);
        let mut row = vec![
            Cell::text(&point.id),
            Cell::count(point.cells.into()),
            Cell::count(point.threads.into()),
            Cell::count(point.samples),
            Cell::count(point.vertices),
            Cell::count(point.triangles),
            Cell::number(point.radius_ratio, 4),
            Cell::Number(MS * total.median, 3),
            end(|i| i.low),
            end(|i| i.high),
        ];
        row.extend(point.stages_s.map(|seconds| Cell::Number(MS * seconds, 3)));
        row.extend([each(point.samples), each(point.triangles)]);
        row.push(Cell::number(point.memory_bytes.map(|bytes| bytes as f64 / f64::from(1 << 20)), 2));
        table.push(row);
    }
    table
}
