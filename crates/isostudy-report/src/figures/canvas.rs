//! A drawing as a list of shapes, painted alike onto SVG and PNG.
//!
//! Both come from the same shapes at the same doubled resolution, so their positions agree to half a unit. The two
//! plotters backends do not agree on text: what a font size means and where the baseline falls differ, and neither is
//! what a layout needs. Shapes therefore give the em and the baseline, and the painter translates.

use super::error::FigureError;
use super::palette;
pub(super) use super::palette::{BLACK, Colour, WHITE};
use super::sheet::Sheet;
use plotters::backend::{BitMapBackend, SVGBackend};
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::register_font;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::sync::Once;

/// Pixels a unit in the PNG, and in the SVG's view box.
const SCALE: f64 = 2.0;
/// The family as SVG viewers look for it; also the name under which the embedded font is registered.
const FAMILY: &str = "DejaVu Sans, Verdana, Helvetica, Arial, sans-serif";
static FONT: &[u8] = include_bytes!("../../../../assets/fonts/DejaVuSans.ttf");

/// Which part of a text its x belongs to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Align {
    Start,
    Middle,
    End,
}

#[derive(Debug, Clone)]
enum Shape {
    Rectangle { from: (f64, f64), to: (f64, f64), colour: Colour },
    Polygon { points: Vec<(f64, f64)>, colour: Colour },
    Line { points: Vec<(f64, f64)>, colour: Colour, width: f64 },
    Text { text: String, at: (f64, f64), em: f64, align: Align, colour: Colour, upwards: bool },
}

/// Shapes in units; the origin is the upper left corner.
#[derive(Debug, Clone)]
pub(super) struct Canvas {
    sheet: Sheet,
    width: f64,
    height: f64,
    shapes: Vec<Shape>,
}

impl Canvas {
    /// As wide as the sheet.
    pub(super) fn on(sheet: Sheet, height: f64) -> Self {
        Self { sheet, width: sheet.width(), height, shapes: Vec::new() }
    }

    pub(super) fn sheet(&self) -> Sheet {
        self.sheet
    }

    pub(super) fn rectangle(&mut self, from: (f64, f64), to: (f64, f64), colour: Colour) {
        let (x0, x1) = (from.0.min(to.0), from.0.max(to.0));
        let (y0, y1) = (from.1.min(to.1), from.1.max(to.1));
        self.shapes.push(Shape::Rectangle { from: (x0, y0), to: (x1, y1), colour });
    }

    pub(super) fn polygon(&mut self, points: Vec<(f64, f64)>, colour: Colour) {
        self.shapes.push(Shape::Polygon { points, colour });
    }

    pub(super) fn line(&mut self, points: Vec<(f64, f64)>, colour: Colour, width: f64) {
        self.shapes.push(Shape::Line { points, colour, width });
    }

    /// A horizontal line of dashes.
    pub(super) fn dashes(&mut self, from: f64, to: f64, y: f64, colour: Colour) {
        let mut x = from;
        while x < to {
            self.line(vec![(x, y), ((x + 5.0).min(to), y)], colour, 1.0);
            x += 9.0;
        }
    }

    /// Text with its baseline at `at.1`.
    pub(super) fn text(&mut self, text: impl Into<String>, at: (f64, f64), em: f64, align: Align) {
        self.text_in(text, at, em, align, BLACK);
    }

    /// Text around a middle, moved where it would reach beyond `left` or `right`.
    pub(super) fn text_within(
        &mut self,
        text: impl Into<String>,
        (middle, baseline): (f64, f64),
        (left, right): (f64, f64),
        em: f64,
    ) {
        let text = text.into();
        // Positions are rounded to half a unit.
        let half = text_width(&text, em) / 2.0 + 0.5;
        let middle = middle.min(right - half).max(left + half);
        self.text(text, (middle, baseline), em, Align::Middle);
    }

    pub(super) fn text_in(
        &mut self,
        text: impl Into<String>,
        at: (f64, f64),
        em: f64,
        align: Align,
        colour: Colour,
    ) {
        self.shapes.push(Shape::Text { text: text.into(), at, em, align, colour, upwards: false });
    }

    /// Text that reads upwards, its baseline at `at.0`, its middle at `at.1`.
    pub(super) fn text_upwards(&mut self, text: impl Into<String>, at: (f64, f64), em: f64) {
        let (text, align, colour) = (text.into(), Align::Middle, BLACK);
        self.shapes.push(Shape::Text { text, at, em, align, colour, upwards: true });
    }

    /// The drawing as SVG text.
    pub(super) fn to_svg(&self, name: &str) -> Result<String, FigureError> {
        let mut svg = String::new();
        {
            let root = SVGBackend::with_string(&mut svg, self.pixels()).into_drawing_area();
            self.paint(&root, &SVG_TEXT).map_err(|message| drawing_error(name, message))?;
        }
        // Same view box, shown at half its size.
        let (w, h) = self.pixels();
        let half = format!("<svg width=\"{}\" height=\"{}\"", self.width, self.height);
        let svg = svg.replacen(&format!("<svg width=\"{w}\" height=\"{h}\""), &half, 1);
        Ok(palette::with_dark_colours(svg))
    }

    /// The drawing as a PNG file's bytes, 8-bit RGB.
    pub(super) fn to_png(&self, name: &str) -> Result<Vec<u8>, FigureError> {
        let (w, h) = self.pixels();
        let mut pixels = vec![0xff; w as usize * h as usize * 3];
        {
            let root = BitMapBackend::with_buffer(&mut pixels, (w, h)).into_drawing_area();
            self.paint(&root, &PNG_TEXT).map_err(|message| drawing_error(name, message))?;
        }
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, w, h);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        let mut writer = encoder.write_header().map_err(|error| drawing_error(name, error.to_string()))?;
        writer.write_image_data(&pixels).map_err(|error| drawing_error(name, error.to_string()))?;
        writer.finish().map_err(|error| drawing_error(name, error.to_string()))?;
        Ok(bytes)
    }

    fn pixels(&self) -> (u32, u32) {
        ((self.width * SCALE).round() as u32, (self.height * SCALE).round() as u32)
    }

    fn paint<DB: DrawingBackend>(
        &self,
        root: &DrawingArea<DB, Shift>,
        backend_text: &BackendText,
    ) -> Result<(), String> {
        register();
        root.fill(&WHITE).map_err(|error| error.to_string())?;
        for shape in &self.shapes {
            paint_shape(root, shape, backend_text)?;
        }
        root.present().map_err(|error| error.to_string())
    }
}

/// How a backend reads a font size and a position anchored at the top.
struct BackendText {
    /// Its font size for an em of 1.
    size: f64,
    /// From the position to the baseline, for an em of 1.
    baseline: f64,
}

/// plotters-svg writes `size / 1.24` and `dy="0.76em"`.
const SVG_TEXT: BackendText = BackendText { size: 1.24, baseline: 0.76 };
/// plotters scales the font's ascent + descent (DejaVu Sans: 1.164 em) to the size, and puts the baseline half a size
/// down.
const PNG_TEXT: BackendText = BackendText { size: 1.164, baseline: 0.582 };

fn paint_shape<DB: DrawingBackend>(
    root: &DrawingArea<DB, Shift>,
    shape: &Shape,
    backend_text: &BackendText,
) -> Result<(), String> {
    let pixel = |v: f64| (v * SCALE).round() as i32;
    let point = |&(x, y): &(f64, f64)| (pixel(x), pixel(y));
    let drawn = match shape {
        Shape::Rectangle { from, to, colour } => {
            let corners = [point(from), point(to)];
            root.draw(&plotters::element::Rectangle::new(corners, colour.filled()))
        }
        Shape::Polygon { points, colour } => {
            root.draw(&plotters::element::Polygon::new(points.iter().map(point).collect::<Vec<_>>(), *colour))
        }
        Shape::Line { points, colour, width } => {
            let style = colour.stroke_width((width * SCALE).round().max(1.0) as u32);
            root.draw(&PathElement::new(points.iter().map(point).collect::<Vec<_>>(), style))
        }
        Shape::Text { text, at, em, align, colour, upwards } => {
            let h = match align {
                Align::Start => HPos::Left,
                Align::Middle => HPos::Center,
                Align::End => HPos::Right,
            };
            let font =
                FontDesc::new(FontFamily::Name(FAMILY), em * SCALE * backend_text.size, FontStyle::Normal);
            let font = if *upwards { font.transform(FontTransform::Rotate270) } else { font };
            let style = TextStyle::from(font).color(colour).pos(Pos::new(h, VPos::Top));
            let up = em * backend_text.baseline;
            let at = if *upwards { (at.0 - up, at.1) } else { (at.0, at.1 - up) };
            root.draw(&Text::new(text.as_str(), point(&at), style))
        }
    };
    drawn.map_err(|error| error.to_string())
}

/// Width of a text in units.
pub(super) fn text_width(text: &str, em: f64) -> f64 {
    register();
    let measured_at = 100.0;
    let font = FontDesc::new(FontFamily::Name(FAMILY), measured_at * PNG_TEXT.size, FontStyle::Normal);
    let (width, _) = font.box_size(text).expect("the font is registered");
    f64::from(width) * em / measured_at
}

/// A text in lines that are no wider than `room`, unless a word is.
pub(super) fn wrapped(text: &str, em: f64, room: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ') {
        match lines.last_mut() {
            Some(line) if text_width(&format!("{line} {word}"), em) <= room => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.into()),
        }
    }
    lines
}

fn register() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        assert!(register_font(FAMILY, FontStyle::Normal, FONT).is_ok(), "the embedded font is a font");
    });
}

fn drawing_error(figure: &str, message: String) -> FigureError {
    FigureError::Drawing { figure: figure.into(), message }
}

#[cfg(test)]
impl Canvas {
    /// The smallest letters on it.
    pub(super) fn least_em(&self) -> f64 {
        let em = |shape: &Shape| match shape {
            Shape::Text { em, .. } => *em,
            _ => f64::INFINITY,
        };
        self.shapes.iter().map(em).fold(f64::INFINITY, f64::min)
    }

    /// How far shapes reach to the left and to the right.
    pub(super) fn reach(&self) -> [f64; 2] {
        let ends = |shape: &Shape| match shape {
            Shape::Rectangle { from, to, .. } => vec![from.0, to.0],
            Shape::Polygon { points, .. } | Shape::Line { points, .. } => {
                points.iter().map(|at| at.0).collect()
            }
            Shape::Text { .. } => Vec::new(),
        };
        let all = self.shapes.iter().flat_map(ends);
        all.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
    }

    /// Two texts one of which stands on the other, both upright or both reading upwards.
    pub(super) fn texts_on_texts(&self) -> Vec<(String, String)> {
        let room = |shape: &Shape| {
            let Shape::Text { text, at, em, align, upwards, .. } = shape else { return None };
            let width = text_width(text, *em);
            let start = match align {
                Align::Start => 0.0,
                Align::Middle => -width / 2.0,
                Align::End => -width,
            };
            // Letters without descenders: those of a line above may touch its room.
            let high = 0.7 * em;
            let room = match upwards {
                true => [at.0 - high, at.0, at.1 + start, at.1 + start + width],
                false => [at.0 + start, at.0 + start + width, at.1 - high, at.1],
            };
            Some((text.clone(), room))
        };
        let all: Vec<(String, [f64; 4])> = self.shapes.iter().filter_map(room).collect();
        let mut found = Vec::new();
        for (i, (one, a)) in all.iter().enumerate() {
            for (other, b) in &all[i + 1..] {
                if a[0] < b[1] && b[0] < a[1] && a[2] < b[3] && b[2] < a[3] {
                    found.push((one.clone(), other.clone()));
                }
            }
        }
        found
    }

    /// Pairs of texts that read upwards beside each other, the lines of which overlap: from ascenders to descenders.
    pub(super) fn lines_on_lines(&self) -> Vec<(String, String)> {
        let room = |shape: &Shape| {
            let Shape::Text { text, at, em, upwards: true, .. } = shape else { return None };
            let half = text_width(text, *em) / 2.0;
            Some((text.clone(), [at.0 - 0.93 * em, at.0 + 0.24 * em, at.1 - half, at.1 + half]))
        };
        let all: Vec<(String, [f64; 4])> = self.shapes.iter().filter_map(room).collect();
        let overlap = |a: [f64; 4], b: [f64; 4]| a[0] < b[1] && b[0] < a[1] && a[2] < b[3] && b[2] < a[3];
        let pairs =
            all.iter().enumerate().flat_map(|(i, one)| all[i + 1..].iter().map(move |two| (one, two)));
        pairs
            .filter(|(one, two)| overlap(one.1, two.1))
            .map(|(one, two)| (one.0.clone(), two.0.clone()))
            .collect()
    }

    /// Texts that stick out of the drawing on any side.
    pub(super) fn texts_outside(&self) -> Vec<String> {
        let sticks_out = |shape: &Shape| {
            let Shape::Text { text, at, em, align, upwards, .. } = shape else { return None };
            let width = text_width(text, *em);
            let start = match align {
                Align::Start => 0.0,
                Align::Middle => -width / 2.0,
                Align::End => -width,
            };
            let inside = if *upwards {
                at.0 - 0.76 * em >= 0.0 && at.1 + start >= 0.0 && at.1 - start <= self.height
            } else {
                at.0 + start >= 0.0 && at.0 + start + width <= self.width && at.1 <= self.height
            };
            (!inside).then(|| text.clone())
        };
        self.shapes.iter().filter_map(sticks_out).collect()
    }
}
