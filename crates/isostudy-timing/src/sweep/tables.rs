//! A sweep as tables.

use super::budgets::Cost;
use super::{FIT_FROM, Growth, Point, Quantity, SpeedUp, Sweep};
use crate::BUSY;
use crate::stage_columns::with_stages;
use isostudy_statistics::interval::Interval;
use isostudy_table::{Cell, Columns, Table};

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
    let end = |growth: &Growth, end: fn(Interval) -> f64| Cell::number(growth.law.interval.map(end), 3);
    let mut table = Columns::over(&sweep.growth)
        .column("id", "Id", |growth| Cell::text(&growth.id))
        .column("threads", "Threads", |growth| Cell::count(growth.threads.into()))
        .column("quantity", "Quantity", |growth| Cell::text(name(growth.quantity)))
        .column("exponent", "Exponent", |growth| Cell::Number(growth.law.exponent, 3))
        .column("low", "from", |growth| end(growth, |i| i.low))
        .column("high", "to", |growth| end(growth, |i| i.high))
        .column("points", "Points", |growth| Cell::count(growth.law.points as u64))
        .into_table("sweep_exponents", "How cost grows with the cells per axis");
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
    let mut ids: Vec<_> = own.iter().map(|growth| &growth.id).collect();
    ids.dedup();
    let mut columns = Columns::over(&ids).column("id", "Id", |id| Cell::text(id));
    for quantity in &quantities {
        columns = columns.column(quantity, quantity, |id| {
            let found = own.iter().find(|growth| growth.id == ***id && name(growth.quantity) == *quantity);
            found.map_or(Cell::Missing, |growth| {
                let half = growth.law.interval.map(|i| (i.high - i.low) / 2.0);
                let spread = half.map_or(String::new(), |half| format!(" \u{b1} {half:.2}"));
                Cell::text(format!("{:.2}{spread}", growth.law.exponent))
            })
        });
    }
    let noun = if threads == 1 { "thread" } else { "threads" };
    columns.into_table("sweep_exponents", format!("On {threads} {noun}"))
}

fn speed_ups(sweep: &Sweep) -> Table {
    let fewest = sweep.points.iter().map(|point| point.threads).min().unwrap_or(1);
    let end = |found: &SpeedUp, end: fn(Interval) -> f64| Cell::number(found.interval.map(end), 2);
    let efficiency = |found: &SpeedUp| found.ratio * f64::from(fewest) / f64::from(found.threads);
    let table = Columns::over(&sweep.speed_ups)
        .column("id", "Id", |found| Cell::text(&found.id))
        .column("cells", "Cells", |found| Cell::count(found.cells.into()))
        .column("threads", "Threads", |found| Cell::count(found.threads.into()))
        .column("speed_up", "Speed-up", |found| Cell::Number(found.ratio, 2))
        .column("low", "from", |found| end(found, |i| i.low))
        .column("high", "to", |found| end(found, |i| i.high))
        .column("efficiency", "Efficiency", |found| Cell::Number(efficiency(found), 2))
        .into_table("sweep_speed_up", "What more threads are worth");
    table.with_note(format!(
        "Median time on {fewest} over median time on so many threads; intervals from both medians' order statistics, at 95 % for all \
         configurations of a resolution together, where the rounds suffice for that. Efficiency is the speed-up over the share of threads."
    ))
}

fn budgets(sweep: &Sweep) -> Table {
    let cost = |cost: Cost| match cost {
        Cost::Triangles(triangles) => format!("{triangles:.0} triangles"),
        Cost::Seconds(seconds) => format!("{:.2} ms", MS * seconds),
    };
    let ranked = sweep
        .budgets
        .iter()
        .flat_map(|budget| (1..).zip(&budget.methods).map(move |(rank, best)| (budget, rank, best)));
    let table = Columns::over(ranked)
        .column("object", "Object", |(budget, ..)| Cell::text(&budget.object))
        .column("cost", "For", |(budget, ..)| Cell::text(cost(budget.cost)))
        .column("rank", "Rank", |(_, rank, _)| Cell::count(*rank))
        .column("method", "Method", |(.., best)| Cell::text(best.method))
        .column("radius_ratio_mean", "Mean radius ratio", |(.., best)| Cell::Number(best.radius_ratio, 4))
        .column("cells", "Cells", |(.., best)| Cell::Number(best.cells, 0))
        .column("triangles", "Triangles", |(.., best)| Cell::Number(best.triangles, 0))
        .into_table("sweep_quality", "The most regular triangles for a cost");
    table.with_note(
        "Each method at the resolution that the cost buys it, interpolated between measured ones; the cost is the middle, on \
         logarithms, of what all methods of the object reach. Times are those on the fewest threads.",
    )
}

fn points(sweep: &Sweep) -> Table {
    let end = |point: &Point, end: fn(Interval) -> f64| {
        Cell::number(point.total_s.interval.map(|i| MS * end(i)), 3)
    };
    let each = |point: &Point, count: u64| {
        Cell::number((count > 0).then(|| 1e9 * point.total_s.median / count as f64), 1)
    };
    let columns = Columns::over(&sweep.points)
        .column("id", "Id", |point| Cell::text(&point.id))
        .column("cells", "Cells", |point| Cell::count(point.cells.into()))
        .column("threads", "Threads", |point| Cell::count(point.threads.into()))
        .column("samples", "Sample points", |point| Cell::count(point.samples))
        .column("vertices", "Vertices", |point| Cell::count(point.vertices))
        .column("triangles", "Triangles", |point| Cell::count(point.triangles))
        .column("radius_ratio_mean", "Mean radius ratio", |point| Cell::number(point.radius_ratio, 4))
        .quantity("total_ms", "Total, {}", "ms", |point| Cell::Number(MS * point.total_s.median, 3))
        .quantity("total_low_ms", "from", "ms", |point| end(point, |i| i.low))
        .quantity("total_high_ms", "to", "ms", |point| end(point, |i| i.high));
    with_stages(columns, |point, stage| point.stages_s[stage])
        .column("ns_per_sample", "ns a sample point", |point| each(point, point.samples))
        .column("ns_per_triangle", "ns a triangle", |point| each(point, point.triangles))
        .quantity("memory_mib", "Memory, {}", "MiB", |point| {
            Cell::number(point.memory_bytes.map(|bytes| bytes as f64 / f64::from(1 << 20)), 2)
        })
        .into_table("sweep", "Every resolution and thread count")
}
