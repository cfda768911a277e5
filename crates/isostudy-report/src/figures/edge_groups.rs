//! Tables of triangles in cells: how good their triangles are on some surfaces, and of which kinds the worst are.

use super::axis::Axis;
use super::bars::frame;
use super::canvas::{Align, BLACK, Canvas, text_width};
use super::distributions::draw_box;
use super::draft::{Unfinished, canvas_with_legend};
use super::error::FigureError;
use super::legend::Swatch;
use super::sheet::Sheet;
use super::style::{Fill, LEFT, RIGHT};
use crate::figure::Figure;

const ROW: f64 = 360.0;
const PER_ROW: usize = 3;
const EM: f64 = 11.0;

/// A table of triangles, and what it makes of some surfaces.
#[derive(Debug, Clone, PartialEq)]
pub struct TableQuality {
    /// What the table is called.
    pub name: String,
    /// Radius ratios of the triangles of all surfaces, from 0 to 1.
    pub ratios: Vec<f64>,
    /// The kinds of its triangles. None where samples have a say in which triangles there are.
    pub kinds: Vec<KindShare>,
}

/// A kind of triangles by the edges of the cell that their corners lie on.
#[derive(Debug, Clone, PartialEq)]
pub struct KindShare {
    /// In few words.
    pub label: String,
    /// Whether it is the kind to be avoided.
    pub is_bad: bool,
    /// Of each surface, the share of its worst triangles that are of this kind, from 0 to 1.
    pub shares: Vec<f64>,
}

/// Box plots: the radius ratios of each table's triangles; and by kind of triangle, the shares of the worst `worst` over `surfaces`.
///
/// # Errors
/// If drawing fails, which is not to be expected.
pub fn edge_groups_figure(
    tables: &[TableQuality],
    surfaces: &[String],
    worst: usize,
) -> Result<Figure, FigureError> {
    draft(tables, surfaces, worst).finish()
}

fn draft(tables: &[TableQuality], surfaces: &[String], worst: usize) -> Unfinished {
    let with_kinds: Vec<&TableQuality> = tables.iter().filter(|table| !table.kinds.is_empty()).collect();
    let rows: Vec<&[&TableQuality]> = with_kinds.chunks(PER_ROW).collect();
    let (good, bad) = (Fill::plain(LEFT), Fill::plain(RIGHT));
    let legend = [
        (Swatch::Area(good), "a kind of triangle".to_owned()),
        (Swatch::Area(bad), "a kind whose edges are a path in space".to_owned()),
    ];
    let (mut canvas, top) = canvas_with_legend(Sheet::Wide, &legend, ROW * (1 + rows.len()) as f64);
    let boxes = tables.iter().map(|table| (table.name.as_str(), &table.ratios[..], good)).collect();
    let panel =
        Panel { heading: "all triangles".into(), label: "radius ratio", boxes, whiskers: [0.05, 0.95] };
    panel.draw(&mut canvas, (0.0, top), (Sheet::Wide.width(), top + ROW));
    for (row, tables) in rows.into_iter().enumerate() {
        let (y, width) = (top + ROW * (1 + row) as f64, Sheet::Wide.width() / PER_ROW as f64);
        for (column, table) in tables.iter().enumerate() {
            let x = width * column as f64;
            let fill = |kind: &KindShare| if kind.is_bad { bad } else { good };
            let boxes =
                table.kinds.iter().map(|kind| (kind.label.as_str(), &kind.shares[..], fill(kind))).collect();
            let label = if column == 0 { "share of the worst" } else { "" };
            let panel = Panel { heading: table.name.clone(), label, boxes, whiskers: [0.0, 1.0] };
            panel.draw(&mut canvas, (x, y), (x + width, y + ROW));
        }
    }
    let caption = format!(
        "Triangles on {}. Above: radius ratios of all triangles of these surfaces; boxes: quartiles and median; whiskers: 5 % and 95 %. \
         Below: of which kinds the worst {worst} triangles of a surface are; boxes: quartiles and median over the surfaces; whiskers: \
         least and most. A kind is named after three of the cell's edges that have such a triangle, each by its two corners.",
        surfaces.join(", ")
    );
    Unfinished { name: "edge-groups", caption, canvas }
}

/// Boxes side by side on one axis from 0 to 1, each with its name below.
struct Panel<'a> {
    heading: String,
    label: &'a str,
    boxes: Vec<(&'a str, &'a [f64], Fill)>,
    /// The shares of the values below the ends of the whiskers.
    whiskers: [f64; 2],
}

impl Panel<'_> {
    fn draw(self, canvas: &mut Canvas, from: (f64, f64), to: (f64, f64)) {
        let axis = Axis::up_to(1.0);
        let (left, right) = (from.0 + 70.0, to.0 - 10.0);
        let pitch = (right - left) / self.boxes.len().max(1) as f64;
        let longest = self.boxes.iter().map(|(name, ..)| text_width(name, EM)).fold(0.0, f64::max);
        let is_upright = longest + 8.0 > pitch;
        let below = if is_upright { longest } else { EM };
        let (top, bottom) = (from.1 + 34.0, to.1 - 26.0 - below);
        frame(canvas, &axis, self.label, (left, right), (bottom, top));
        canvas.text(self.heading, ((left + right) / 2.0, from.1 + 20.0), 12.0, Align::Middle);
        let half = (0.32 * pitch).min(24.0);
        for (i, (name, values, fill)) in self.boxes.into_iter().enumerate() {
            let x = left + pitch * (i as f64 + 0.5);
            if is_upright {
                canvas.text_upwards(name, (x + 4.0, bottom + 8.0 + text_width(name, EM) / 2.0), EM);
            } else {
                canvas.text(name, (x, bottom + 8.0 + EM), EM, Align::Middle);
            }
            let mut sorted = values.to_vec();
            sorted.sort_by(f64::total_cmp);
            let [low, high] = self.whiskers;
            if let Some(heights) = quantiles(&sorted, [low, 0.25, 0.5, 0.75, high]) {
                draw_box(canvas, (x, half), heights.map(|value| axis.place(value, bottom, top)), fill);
            }
        }
        canvas.line(vec![(left, bottom), (right, bottom)], BLACK, 1.0);
    }
}

/// Interpolated between the sorted values; `None` of none.
fn quantiles(sorted: &[f64], levels: [f64; 5]) -> Option<[f64; 5]> {
    let last = sorted.len().checked_sub(1)?;
    Some(levels.map(|level| {
        let at = level * last as f64;
        let (low, high) = (sorted[at.floor() as usize], sorted[at.ceil() as usize]);
        low + (high - low) * at.fract()
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_r() {
        // quantile(c(1, 2, 4, 8), c(0, .25, .5, .75, 1)), type 7.
        assert_eq!(
            quantiles(&[1.0, 2.0, 4.0, 8.0], [0.0, 0.25, 0.5, 0.75, 1.0]),
            Some([1.0, 1.75, 3.0, 5.0, 8.0])
        );
        assert_eq!(quantiles(&[], [0.0; 5]), None);
    }

    #[test]
    fn no_label_leaves_the_drawing() {
        let kind = |label: &str, is_bad| KindShare { label: label.into(), is_bad, shares: vec![0.1, 0.4] };
        let kinds = |n: usize| (0..n).map(|i| kind("0-1 1-13 10-14", i == 1)).collect();
        let table =
            |name: &str, n| TableQuality { name: name.into(), ratios: vec![0.2, 0.9], kinds: kinds(n) };
        let tables = [
            table("mc", 8),
            table("a-table-of-sixteen", 8),
            table("without", 0),
            table("su", 10),
            table("bu", 4),
        ];
        let drawn = draft(&tables, &["a sphere".into()], 1000);
        assert_eq!(drawn.canvas.texts_outside(), Vec::<String>::new());
        // Names, kinds, and of the first panel of each row the axis.
        let svg = drawn.canvas.to_svg("edge-groups").unwrap();
        assert_eq!(svg.matches("0-1 1-13 10-14").count(), 8 + 8 + 10 + 4);
        assert_eq!(svg.matches("share of the worst").count(), 2);
        assert!(svg.contains("without"));
    }
}
