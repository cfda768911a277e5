//! A panel of grouped, stacked bars.

use super::axis::Axis;
use super::canvas::{Align, BLACK, Canvas, WHITE, text_width};
use super::draft::canvas_with_legend;
use super::legend::{self, Swatch};
use super::sheet::Sheet;
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

/// Room for what stands round the plot.
const RIGHT: f64 = 10.0;
const TOP: f64 = 40.0;
const BOTTOM: f64 = 40.0;
/// How high a plot is on a narrow sheet, and where a wide one has a panel an object.
const PLOT: f64 = 200.0;
/// From one label that reads upwards to the next, in ems: a line of the font, from ascenders to descenders.
pub(super) const PITCH: f64 = 1.17;
/// What a bar is wide at least where panels stand side by side, as the ends of its whisker are.
const LEAST_BAR: f64 = 8.0;

/// Room for an axis and what it is called.
pub(super) fn room_for_labels(sheet: Sheet, axis: &Axis) -> f64 {
    let widest = axis.labels().iter().map(|text| text_width(text, sheet.em())).fold(0.0, f64::max);
    sheet.length(80.0, widest + 32.0)
}

/// A canvas with a legend and rows of panels, each with its share of the width. On a narrow sheet they stand one below the other, and
/// on a wide one as few side by side as leave their labels room.
pub(super) fn rows_of_panels(
    sheet: Sheet,
    legend: &[(Swatch, String)],
    rows: Vec<Vec<(f64, BarPanel)>>,
    row: f64,
) -> Canvas {
    let width = sheet.width();
    let has_room =
        |panels: &[(f64, BarPanel)]| panels.iter().all(|(share, of)| !of.labels_touch(sheet, share * width));
    let mut placed: Vec<(f64, Vec<(f64, BarPanel)>)> = Vec::new();
    for panels in rows {
        if !sheet.is_narrow() && has_room(&panels) {
            placed.push((row, panels));
            continue;
        }
        let parts = panels.into_iter().flat_map(|(_, panel)| panel.in_parts(sheet, width));
        placed.extend(in_rows(sheet, parts.collect()));
    }
    let (mut canvas, mut y) =
        canvas_with_legend(sheet, legend, placed.iter().map(|(height, _)| height).sum());
    for (height, panels) in placed {
        let mut x = 0.0;
        for (share, panel) in panels {
            let right = x + share * width;
            panel.draw(&mut canvas, (x, y), (right, y + height));
            x = right;
        }
        y += height;
    }
    canvas
}

/// Panels in rows, as many side by side as have room, each row as high as the longest of its labels needs.
fn in_rows(sheet: Sheet, panels: Vec<BarPanel>) -> Vec<(f64, Vec<(f64, BarPanel)>)> {
    let width = sheet.width();
    let fits = |columns: &usize| {
        let width = width / *columns as f64;
        let has_room = |of: &BarPanel| {
            !of.labels_touch(sheet, width) && of.unit(of.plot_width(sheet, width)).1 >= LEAST_BAR
        };
        panels.iter().all(has_room)
    };
    let most = sheet.columns(panels.len());
    let columns = (2..=most).rev().find(fits).unwrap_or(1);
    // As evenly as they go.
    let columns = panels.len().div_ceil(panels.len().div_ceil(columns).max(1)).max(1);
    let share = 1.0 / columns as f64;
    let row = |panels: &[BarPanel]| {
        let labels = panels.iter().map(|of| of.label_room(sheet, share * width)).fold(0.0, f64::max);
        (TOP + PLOT + BOTTOM + labels, panels.iter().map(|of| (share, of.clone())).collect())
    };
    panels.chunks(columns).map(row).collect()
}

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
        let sheet = canvas.sheet();
        let em = sheet.em();
        let (left, right) = (from.0 + room_for_labels(sheet, &self.axis), to.0 - RIGHT);
        let upwards = self.label_room(sheet, to.0 - from.0);
        let (top, bottom) = (from.1 + TOP, to.1 - BOTTOM - upwards);
        frame(canvas, &self.axis, &self.axis_label, (left, right), (bottom, top));
        if !self.heading.is_empty() {
            let at = ((left + right) / 2.0, from.1 + 19.0);
            canvas.text_within(&self.heading, at, (from.0, to.0), 12.5);
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
                    let down = bottom + 8.0 + text_width(&slot.label, em) / 2.0;
                    canvas.text_upwards(&slot.label, (middle + 0.36 * em, down), em);
                } else {
                    canvas.text(&slot.label, (middle, bottom + 14.0), em, Align::Middle);
                }
                x += 0.35 * unit;
            }
            x -= 0.35 * unit;
            let at = ((start + x) / 2.0, bottom + upwards + 31.0);
            canvas.text_within(&cluster.label, at, (from.0, to.0), sheet.large_em());
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

    /// What labels take below the plot beyond one line: their length where they read upwards, else nothing. `width` is the panel's.
    fn label_room(&self, sheet: Sheet, width: f64) -> f64 {
        let em = sheet.em();
        let (_, unit) = self.unit(self.plot_width(sheet, width));
        let slots = || self.clusters.iter().flat_map(|c| &c.slots);
        let wide = |slot: &Slot| text_width(&slot.label, em) > unit * (slot.bars.len() as f64 + 0.3);
        if !slots().any(wide) {
            return 0.0;
        }
        slots().map(|slot| text_width(&slot.label, em)).fold(0.0, f64::max)
    }

    fn plot_width(&self, sheet: Sheet, width: f64) -> f64 {
        width - room_for_labels(sheet, &self.axis) - RIGHT
    }

    /// Whether labels below the plot would stand on each other if they read upwards. `width` is the panel's.
    fn labels_touch(&self, sheet: Sheet, width: f64) -> bool {
        let (_, unit) = self.unit(self.plot_width(sheet, width));
        let mut slots = self.clusters.iter().flat_map(|c| &c.slots);
        slots.any(|slot| unit * (slot.bars.len() as f64 + 0.35) < PITCH * sheet.em())
    }

    /// The panel, or its clusters in panels of their own on the same axis, or parts of clusters: such that labels below the plot do
    /// not touch.
    fn in_parts(self, sheet: Sheet, width: f64) -> Vec<Self> {
        let touch = |panel: &Self| panel.labels_touch(sheet, width);
        if !touch(&self) {
            return vec![self];
        }
        let parts = |count: usize| -> Vec<Self> {
            let part = |cluster: &Cluster, slots: &[Slot]| Self {
                clusters: vec![Cluster { label: cluster.label.clone(), slots: slots.to_vec() }],
                ..self.clone()
            };
            let of_cluster = |cluster: &Cluster| -> Vec<Self> {
                let most = cluster.slots.len().div_ceil(count).max(1);
                cluster.slots.chunks(most).map(|slots| part(cluster, slots)).collect()
            };
            self.clusters.iter().flat_map(of_cluster).collect()
        };
        let most = self.clusters.iter().map(|cluster| cluster.slots.len()).max().unwrap_or(1).max(1);
        (1..=most).map(parts).find(|parts| !parts.iter().any(touch)).unwrap_or_else(|| vec![self])
    }

    fn bar(&self, canvas: &mut Canvas, bar: &Bar, (x0, x1): (f64, f64), (bottom, top): (f64, f64)) {
        let em = canvas.sheet().em();
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
            let em = canvas.sheet().length(em - 1.0, em);
            let wide = text_width(&value, em);
            // Beside each other they would be one number.
            if wide > x1 - x0 + 2.0 {
                canvas.text_upwards(value, (middle + 0.36 * em, top - 5.0 - wide / 2.0), em);
            } else {
                canvas.text(value, (middle, top - 5.0), em, Align::Middle);
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
            canvas.text(label, (middle, over - 6.0), em, Align::Middle);
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
    let em = canvas.sheet().em();
    let mut widest: f64 = 0.0;
    for (&tick, text) in axis.ticks.iter().zip(axis.labels()) {
        let y = axis.place(tick, bottom, top);
        canvas.line(vec![(left, y), (right, y)], GRID, 0.5);
        widest = widest.max(text_width(&text, em));
        canvas.text(text, (left - 6.0, y + 0.36 * em), em, Align::End);
    }
    if !label.is_empty() {
        canvas.text_upwards(label, (left - widest - 13.0, (bottom + top) / 2.0), canvas.sheet().large_em());
    }
}
