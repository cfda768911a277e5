//! A panel of grouped, stacked bars.

use super::axis::Axis;
use super::canvas::{Align, BLACK, Canvas, WHITE, text_width};
use super::legend;
use super::style::{Fill, GRID};
use isostudy_statistics::interval::Interval;

/// One bar: segments from the bottom up.
#[derive(Debug, Clone, Default)]
pub(super) struct Bar {
    pub(super) segments: Vec<(f64, Fill)>,
    /// Marked with a diamond.
    pub(super) published: Option<f64>,
    pub(super) interval: Option<Interval>,
    /// Printed over the bar.
    pub(super) label: Option<String>,
}

impl Bar {
    pub(super) fn of(value: Option<f64>, fill: Fill, published: Option<f64>) -> Self {
        Self { segments: value.map(|v| (v, fill)).into_iter().collect(), published, ..Self::default() }
    }

    pub(super) fn top(&self) -> f64 {
        self.segments.iter().map(|(value, _)| value).sum()
    }
}

/// Bars that share a label, side by side.
#[derive(Debug, Clone)]
pub(super) struct Slot {
    pub(super) label: String,
    pub(super) bars: Vec<Bar>,
}

/// Slots that share a label, set apart from others.
#[derive(Debug, Clone)]
pub(super) struct Cluster {
    pub(super) label: String,
    pub(super) slots: Vec<Slot>,
}

/// A panel.
#[derive(Debug, Clone)]
pub(super) struct BarPanel {
    pub(super) heading: String,
    pub(super) axis_label: String,
    pub(super) axis: Axis,
    pub(super) clusters: Vec<Cluster>,
    /// Bars that run out of the axis are broken and carry their value.
    pub(super) broken: bool,
    /// A dashed line at the largest value possible.
    pub(super) cap: Option<f64>,
}

const EM: f64 = 11.0;
/// Room for what stands round the plot.
const LEFT: f64 = 80.0;
const RIGHT: f64 = 10.0;
const TOP: f64 = 40.0;
const BOTTOM: f64 = 40.0;

/// The largest value that any bar of these shows, published marks and intervals included.
pub(super) fn largest(clusters: &[Cluster]) -> f64 {
    let bars = clusters.iter().flat_map(|c| &c.slots).flat_map(|s| &s.bars);
    let of = |bar: &Bar| {
        let interval = bar.interval.map_or(0.0, |i| i.high);
        bar.top().max(bar.published.unwrap_or(0.0)).max(interval)
    };
    bars.map(of).fold(0.0, f64::max)
}

impl BarPanel {
    /// One without a heading, whose bars end within the axis.
    pub(super) fn of(axis_label: &str, axis: Axis, clusters: Vec<Cluster>) -> Self {
        let (heading, axis_label) = (String::new(), axis_label.into());
        Self { heading, axis_label, axis, clusters, broken: false, cap: None }
    }

    /// One that reaches from zero to the largest bar.
    pub(super) fn from_zero(axis_label: &str, clusters: Vec<Cluster>) -> Self {
        Self::of(axis_label, Axis::from_zero(largest(&clusters)), clusters)
    }

    /// Draws the panel into a rectangle. Labels that are wider than what they are of read upwards.
    pub(super) fn draw(&self, canvas: &mut Canvas, from: (f64, f64), to: (f64, f64)) {
        let (left, right) = (from.0 + LEFT, to.0 - RIGHT);
        let upwards = self.label_room(right - left);
        let (top, bottom) = (from.1 + TOP, to.1 - BOTTOM - upwards);
        frame(canvas, &self.axis, &self.axis_label, (left, right), (bottom, top));
        if !self.heading.is_empty() {
            canvas.text(&self.heading, ((left + right) / 2.0, from.1 + 19.0), 12.5, Align::Middle);
        }
        let (wide, unit) = self.unit(right - left);
        let mut x = (left + right) / 2.0 - unit * wide / 2.0 + 0.8 * unit;
        for cluster in &self.clusters {
            let start = x;
            for slot in &cluster.slots {
                let slot_start = x;
                for bar in &slot.bars {
                    self.bar(canvas, bar, (x, x + unit), (bottom, top));
                    x += unit;
                }
                let middle = (slot_start + x) / 2.0;
                if upwards > 0.0 {
                    let down = bottom + 8.0 + text_width(&slot.label, EM) / 2.0;
                    canvas.text_upwards(&slot.label, (middle + 0.36 * EM, down), EM);
                } else {
                    canvas.text(&slot.label, (middle, bottom + 14.0), EM, Align::Middle);
                }
                x += 0.35 * unit;
            }
            x -= 0.35 * unit;
            canvas.text(&cluster.label, ((start + x) / 2.0, bottom + upwards + 31.0), 12.0, Align::Middle);
            x += 1.6 * unit;
        }
        if let Some(cap) = self.cap {
            canvas.dashes(left, right, self.axis.place(cap, bottom, top), BLACK);
        }
        canvas.line(vec![(left, bottom), (right, bottom)], BLACK, 1.0);
    }

    /// The panel's width in bars, and the width of a bar. A bar is 1, the gap in a cluster 0.35, the gap between clusters 1.6.
    fn unit(&self, room: f64) -> (f64, f64) {
        let slots_wide = |c: &Cluster| {
            let bars: usize = c.slots.iter().map(|s| s.bars.len()).sum();
            bars as f64 + 0.35 * c.slots.len().saturating_sub(1) as f64
        };
        let wide: f64 = self.clusters.iter().map(slots_wide).sum::<f64>() + 1.6 * self.clusters.len() as f64;
        (wide, (room / wide).min(84.0))
    }

    /// What labels take below the plot beyond one line: their length where they read upwards, else nothing.
    fn label_room(&self, room: f64) -> f64 {
        let (_, unit) = self.unit(room);
        let slots = || self.clusters.iter().flat_map(|c| &c.slots);
        let wide = |slot: &Slot| text_width(&slot.label, EM) > unit * (slot.bars.len() as f64 + 0.3);
        if !slots().any(wide) {
            return 0.0;
        }
        slots().map(|slot| text_width(&slot.label, EM)).fold(0.0, f64::max)
    }

    fn bar(&self, canvas: &mut Canvas, bar: &Bar, (x0, x1): (f64, f64), (bottom, top): (f64, f64)) {
        let (x0, x1) = (x0 + 1.0, x1 - 1.0);
        let middle = (x0 + x1) / 2.0;
        let mut reached = 0.0;
        for &(value, fill) in &bar.segments {
            let y0 = self.axis.place(reached, bottom, top);
            reached += value;
            fill.paint(canvas, (x0, y0), (x1, self.axis.place(reached, bottom, top)));
        }
        let mut over = self.axis.place(reached, bottom, top);
        if self.broken && reached > self.axis.high {
            tear(canvas, (x0, x1), top + 14.0);
            let value = super::axis::short(reached);
            let wide = text_width(&value, EM - 1.0);
            // Beside each other they would be one number.
            if wide > x1 - x0 + 2.0 {
                canvas.text_upwards(value, (middle + 0.36 * EM, top - 5.0 - wide / 2.0), EM - 1.0);
            } else {
                canvas.text(value, (middle, top - 5.0), EM - 1.0, Align::Middle);
            }
        }
        if let Some(Interval { low, high }) = bar.interval {
            let (y0, y1) = (self.axis.place(low, bottom, top), self.axis.place(high, bottom, top));
            legend::whisker(canvas, middle, y0, y1);
            over = over.min(y1);
        }
        if let Some(published) = bar.published.filter(|p| *p <= self.axis.high) {
            let y = self.axis.place(published, bottom, top);
            legend::diamond(canvas, (middle, y));
            over = over.min(y - 3.0);
        }
        if let Some(label) = &bar.label {
            canvas.text(label, (middle, over - 6.0), EM, Align::Middle);
        }
    }
}

/// A white band across a bar that is longer than the axis.
fn tear(canvas: &mut Canvas, (x0, x1): (f64, f64), y: f64) {
    let slope = 5.0;
    let band = vec![(x0 - 2.0, y), (x1 + 2.0, y - slope), (x1 + 2.0, y - slope + 4.0), (x0 - 2.0, y + 4.0)];
    canvas.polygon(band, WHITE);
    for shift in [0.0, 4.0] {
        canvas.line(vec![(x0 - 2.0, y + shift), (x1 + 2.0, y - slope + shift)], BLACK, 0.5);
    }
}

/// Grid lines, their labels and the axis's name, for a plot between `left`..`right` and `bottom`..`top`.
pub(super) fn frame(
    canvas: &mut Canvas,
    axis: &Axis,
    label: &str,
    (left, right): (f64, f64),
    (bottom, top): (f64, f64),
) {
    let mut widest: f64 = 0.0;
    for (&tick, text) in axis.ticks.iter().zip(axis.labels()) {
        let y = axis.place(tick, bottom, top);
        canvas.line(vec![(left, y), (right, y)], GRID, 0.5);
        widest = widest.max(text_width(&text, EM));
        canvas.text(text, (left - 6.0, y + 0.36 * EM), EM, Align::End);
    }
    if !label.is_empty() {
        canvas.text_upwards(label, (left - widest - 13.0, (bottom + top) / 2.0), 12.0);
    }
}
