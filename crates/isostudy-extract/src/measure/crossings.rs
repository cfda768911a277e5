//! Points of an isosurface, evenly in its area: where straight lines cross it.

use glam::{DVec3, Vec3};
use isostudy_mesh::Bounds;

use crate::execution::threads::mapped;
use crate::measure::cells_with_surface::CellsWithSurface;
use crate::measure::lines::{Line, Lines};
use crate::sampling::bracket::Bracket;
use crate::sampling::level::Level;

/// Samples along a line, in spacings.
const STEP: f64 = 0.25;
/// So often a step is halved where the line crosses, and where it may cross there and back: to a two-thousandth of a spacing. Near a
/// sharp edge lines cross twice in a short way; with sixteenths of a step, distances to meshes that round edges were 4 % too small.
const HALVINGS_ACROSS: u32 = 4;
const HALVINGS: u32 = 9;
/// How much steeper than the samples nearby the field may be between two of them.
const STEEPER: f64 = 1.5;
/// A crossing is known to this fraction of the spacing.
const TOLERANCE: f64 = 1e-5;
/// Steps of the root search; the Illinois rule converges in far fewer.
const MOST_STEPS: usize = 40;
/// Lines of the first look; most lines, if they are not fewer than so many per point; and most where none has crossed yet.
const FIRST: f64 = 4_096.0;
const MOST: f64 = 1_048_576.0;
const PER_POINT: f64 = 16.0;
const MOST_WITHOUT: f64 = 65_536.0;
/// Fewer crossings say little of the area.
const FEW: f64 = 64.0;

/// Points of an isosurface, each for the same share of its area.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Crossings {
    pub(crate) points: Vec<DVec3>,
    /// The area that each of them stands for.
    pub(crate) area_each: f64,
}

/// Points within the box; as many as are wanted, or a few percent more or less, as long as a million lines or
/// sixteen per point suffice. `wanted` gets
/// the area. Pieces that no line finds have no points: those that are far smaller than a spacing.
///
/// The same points on any number of threads; to be called within [`on_threads`](crate::execution::threads::on_threads).
pub(crate) fn crossings(level: &Level, bounds: &Bounds, wanted: impl Fn(f64) -> f64) -> Crossings {
    let cells = CellsWithSurface::of(level, bounds);
    let Some(bounds) = cells.bounds() else { return Crossings::default() };
    let mut count = FIRST;
    loop {
        let lines = Lines::through(&bounds, count as usize);
        let per_row = mapped(&lines.rows(), |row| {
            let mut points = Vec::new();
            let mut samples = Samples::default();
            lines.of(row).for_each(|line| along(level, &cells, &line, &mut samples, &mut points));
            points
        });
        let points = per_row.concat();
        let (found, area_each) = (points.len() as f64, lines.area_per_crossing());
        let wanted = wanted(found * area_each);
        let most = if found == 0.0 { MOST_WITHOUT } else { MOST.max(PER_POINT * wanted) };
        if found >= 0.95 * wanted && found >= FEW || count >= most {
            return Crossings { points, area_each };
        }
        let factor = if found < FEW { 16.0 } else { wanted / found };
        count = (count * factor).min(most);
    }
}

/// Points of a line, and the field's differences from the isovalue there.
#[derive(Default)]
struct Samples {
    points: Vec<Vec3>,
    differences: Vec<f32>,
}

impl Samples {
    /// Fills them with the ends of so many steps.
    fn fill(&mut self, level: &Level, steps: usize, at: impl Fn(f64) -> Vec3) {
        self.points.clear();
        self.points.extend((0..=steps).map(|step| at(step as f64)));
        self.differences.resize(steps + 1, 0.0);
        level.field.sample_near(&self.points, &mut self.differences, None);
        self.differences.iter_mut().for_each(|value| *value -= level.isovalue);
    }
}

/// All crossings along a line.
fn along(
    level: &Level,
    cells: &CellsWithSurface,
    line: &Line,
    samples: &mut Samples,
    points: &mut Vec<DVec3>,
) {
    let at = |way: f64| (line.from + line.direction * way).as_vec3();
    let value = |way: f64| f64::from(level.difference(at(way)));
    cells.parts_of(line, |from, to| {
        let steps = ((to - from) / (STEP * f64::from(level.spacing))).ceil().max(1.0);
        let length = (to - from) / steps;
        let place = |step: f64| from + step * length;
        samples.fill(level, steps as usize, |step| at(place(step)));
        let found = |step: u64| samples.differences.get(step as usize).copied().map(f64::from);
        let mut before = None::<f64>;
        for step in 1..=steps as u64 {
            let [low, high] = [step - 1, step].map(|step| found(step).unwrap_or(f64::NAN));
            // The steepest of this step and its neighbours.
            let rises = [
                before.map(|before| low - before),
                Some(high - low),
                found(step + 1).map(|after| after - high),
            ];
            let steepness = rises.into_iter().flatten().map(|rise| rise.abs() / length).fold(0.0, f64::max);
            let ends = [(place(step as f64 - 1.0), low), (place(step as f64), high)];
            between(&value, ends, steepness, HALVINGS, &mut |ends| {
                points.extend(
                    root(&value, ends, TOLERANCE * f64::from(level.spacing)).map(|way| at(way).as_dvec3()),
                );
            });
            before = Some(low);
        }
    });
}

/// Parts of a line at whose ends sides differ, looked for by halves where the field could reach zero.
fn between(
    value: &impl Fn(f64) -> f64,
    [low, high]: [(f64, f64); 2],
    steepness: f64,
    halvings: u32,
    found: &mut impl FnMut([(f64, f64); 2]),
) {
    let crosses = (low.1 > 0.0) != (high.1 > 0.0);
    // There and back: the field would have to change by both values.
    let may_cross = low.1.abs() + high.1.abs() < STEEPER * steepness * (high.0 - low.0);
    if halvings == 0 || !(crosses || may_cross) || crosses && halvings <= HALVINGS - HALVINGS_ACROSS {
        if crosses {
            found([low, high]);
        }
        return;
    }
    let middle = 0.5 * (low.0 + high.0);
    let middle = (middle, value(middle));
    let half = 0.5 * (high.0 - low.0);
    let steepest = |rise: f64| rise.abs() / half;
    let steepness = steepness.max(steepest(middle.1 - low.1)).max(steepest(high.1 - middle.1));
    between(value, [low, middle], steepness, halvings - 1, found);
    between(value, [middle, high], steepness, halvings - 1, found);
}

/// `None` where the field is no number.
fn root(value: &impl Fn(f64) -> f64, [low, high]: [(f64, f64); 2], tolerance: f64) -> Option<f64> {
    if low.1.is_nan() || high.1.is_nan() {
        return None;
    }
    let (mut bracket, mut last) = (Bracket::new(low, high), f64::INFINITY);
    for _ in 0..MOST_STEPS {
        let way = bracket.guess();
        if (way - last).abs() <= tolerance || bracket.width() <= tolerance {
            return Some(way);
        }
        let there = value(way);
        if there.is_nan() {
            return None;
        }
        bracket.narrow(way, there);
        last = way;
    }
    Some(bracket.guess())
}
