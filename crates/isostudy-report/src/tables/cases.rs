//! A sweep as tables: exponents, means by resolution, means by value of a setting, and how many cases there are.

use isostudy_design::sweep::Sweep;
use isostudy_inference::cases::{CaseQuantity, Mean, SweepFound, SweepLine};
use isostudy_statistics::interval::Interval;
use isostudy_table::{Cell, Columns, Table};

/// The tables of a sweep; those without rows are left out.
pub fn case_tables(sweep: &Sweep<'_>, found: &SweepFound) -> Vec<Table> {
    let mut tables = vec![exponents(found), resolutions(found), settings(sweep, found), cases(found)];
    tables.retain(|table| !table.rows.is_empty());
    tables
}

pub(crate) fn quantity_name(quantity: CaseQuantity) -> &'static str {
    match quantity {
        CaseQuantity::Samples => "sample points",
        CaseQuantity::Triangles => "triangles",
        CaseQuantity::Distance => "distance to the isosurface",
        CaseQuantity::DistanceToMesh => "distance to the mesh",
        CaseQuantity::RadiusRatio => "radius ratio",
        CaseQuantity::Seconds => "time in seconds",
    }
}

fn machine(name: &Option<String>) -> Cell {
    name.as_ref().map_or(Cell::Missing, Cell::text)
}

/// To three digits.
fn three_digits(value: f64) -> Cell {
    let decimals = if value > 0.0 { (2.0 - value.log10().floor()).clamp(0.0, 12.0) } else { 0.0 };
    Cell::Number(value, decimals as usize)
}

fn exponents(found: &SweepFound) -> Table {
    let end = |line: &SweepLine, end: fn(Interval) -> f64| {
        Cell::number(line.growth.and_then(|law| law.interval).map(end), 3)
    };
    let fitted: Vec<&SweepLine> = found.lines.iter().filter(|line| line.growth.is_some()).collect();
    let has_machines = fitted.iter().any(|line| line.machine.is_some());
    Columns::over(fitted)
        .column("id", "Id", |line| Cell::text(&line.id))
        .column("quantity", "Quantity", |line| Cell::text(quantity_name(line.quantity)))
        .columns_if(has_machines, |columns| columns.column("machine", "Machine", |line| machine(&line.machine)))
        .column("exponent", "Exponent", |line| Cell::number(line.growth.map(|law| law.exponent), 3))
        .column("low", "from", |line| end(line, |i| i.low))
        .column("high", "to", |line| end(line, |i| i.high))
        .column("resolutions", "Resolutions", |line| Cell::count(line.points.len() as u64))
        .into_table("sweep_exponents", "How measures grow with the cells per axis")
        .with_note(
            "A measure grows as cells per axis to this power. 95 % t intervals of the slope on logarithms tell how far the points are from a \
             power law. Each point is the geometric mean over all settings at a resolution. There is no exponent where a case is missing, or \
             where a listed sweep changes other settings with the resolution.",
        )
}

fn resolutions(found: &SweepFound) -> Table {
    let points = found.lines.iter().flat_map(|line| line.points.iter().map(move |point| (line, point)));
    let rows: Vec<(&SweepLine, &Mean)> = points.collect();
    let has_machines = rows.iter().any(|(line, _)| line.machine.is_some());
    Columns::over(rows)
        .column("id", "Id", |(line, _)| Cell::text(&line.id))
        .column("quantity", "Quantity", |(line, _)| Cell::text(quantity_name(line.quantity)))
        .columns_if(has_machines, |columns| {
            columns.column("machine", "Machine", |(line, _)| machine(&line.machine))
        })
        .column("cells", "Cells per axis", |(_, point)| Cell::count(point.cells.into()))
        .column("mean", "Geometric mean", |(_, point)| three_digits(point.mean))
        .column("cases", "Cases", |(_, point)| Cell::count(point.cases))
        .column("missing", "Without a value", |(_, point)| Cell::count(point.missing))
        .into_table("sweep_resolutions", "Means at each resolution")
        .with_note("Distances are in scene units. Cases without a value above 0 have no logarithm, and are not in the mean.")
}

fn settings(sweep: &Sweep<'_>, found: &SweepFound) -> Table {
    let has_machines = found.effects.iter().any(|effect| effect.machine.is_some());
    Columns::over(&found.effects)
        .column("id", "Id", |effect| Cell::text(&effect.id))
        .column("setting", "Setting", |effect| Cell::text(sweep.name(effect.setting)))
        .column("value", "Value", |effect| Cell::text(&sweep.values(effect.setting)[effect.place]))
        .column("quantity", "Quantity", |effect| Cell::text(quantity_name(effect.quantity)))
        .columns_if(has_machines, |columns| {
            columns.column("machine", "Machine", |effect| machine(&effect.machine))
        })
        .column("mean", "Geometric mean", |effect| three_digits(effect.mean))
        .column("cases", "Cases", |effect| Cell::count(effect.cases))
        .column("missing", "Without a value", |effect| Cell::count(effect.missing))
        .into_table("sweep_settings", "Means at each value of a setting")
        .with_note(
            "The mean is over all resolutions and all other settings, which are the same for each value. Where cases have no value, means \
             of other cases stand side by side.",
        )
}

fn cases(found: &SweepFound) -> Table {
    Columns::over(&found.pairs)
        .column("id", "Id", |pair| Cell::text(&pair.id))
        .column("cases", "Cases", |pair| Cell::count(pair.cases))
        .column("left_out", "Without a mesh", |pair| Cell::count(pair.left_out))
        .into_table("sweep_cases", "Cases of each object and method")
        .with_note("The column left_out of the files in sweep/meshes says why a case has no mesh.")
}
