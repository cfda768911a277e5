//! The scale of colours, drawn and labelled.

use crate::colouring::Scale;
use crate::map_colour;
use crate::shading::to_levels;
use crate::text::{TextStyle, ascent, draw_text, text_width, wrap};
use tiny_skia::{Color, Pixmap, PremultipliedColorU8};

/// Behind the scale.
pub(crate) const PAPER: [u8; 3] = [255; 3];
/// Of the text and the marks.
pub(crate) const INK: [u8; 3] = [34; 3];
/// Smallest text that can be read, pixels.
const SMALLEST_PX: f32 = 8.0;

/// A strip `width` pixels wide (at least 16) with the title, the colours from the smaller number on the left to the larger
/// on the right, and the marks with their labels. Text is as high as a twenty-eighth of the width, 8 to 18 pixels.
/// Labels are moved inwards rather than cut off; those that would touch one that comes before them in
/// [`Scale::marks`] (the ends first) are left out, and so is a title with a word wider than the strip.
///
/// The strip has the colours that a surface has towards the light.
pub fn legend(scale: &Scale, width: u32) -> Pixmap {
    let width = width.max(16);
    let text_px = (width as f32 / 28.0).clamp(SMALLEST_PX, 18.0).round();
    let gap = (text_px * 0.5).round();
    let inner = width as f32 - 2.0 * gap;
    let line = (text_px * 1.2).round();
    let mut title = wrap(&scale.title, text_px, inner);
    if title.iter().any(|line| text_width(line, text_px) > inner) {
        title.clear();
    }
    let bar_y = gap + title.len() as f32 * line + (text_px * 0.2).round();
    let bar_px = (text_px * 0.8).round();
    let mark_px = (text_px * 0.3).round();
    let labels_y = bar_y + bar_px + mark_px;
    let height = labels_y + line + gap;

    let mut strip = Pixmap::new(width, height as u32).expect("a strip has a pixel");
    let [r, g, b] = PAPER;
    strip.fill(Color::from_rgba8(r, g, b, 255));
    let style = TextStyle { size_px: text_px, ink: INK };
    for (i, text) in title.iter().enumerate() {
        let left = (width as f32 - text_width(text, text_px)) * 0.5;
        let baseline = gap + i as f32 * line + ascent(text_px);
        draw_text(&mut strip, text, left.round(), baseline.round(), &style);
    }
    let (low, high) = (scale.dark.min(scale.bright), scale.dark.max(scale.bright));
    let columns = inner as u32;
    let left = gap as u32;
    for x in 0..columns {
        let value = low + (high - low) * (x as f32 + 0.5) / columns as f32;
        let colour = to_levels(map_colour(scale.place(value)));
        column(&mut strip, left + x, [bar_y, bar_y + bar_px], colour);
    }
    for (value, label) in placed(scale, [low, high], gap, inner, text_px) {
        let share = (value - low) / (high - low);
        let x = left + ((share * columns as f32) as u32).min(columns - 1);
        column(&mut strip, x, [bar_y + bar_px, labels_y], INK);
        draw_text(&mut strip, label.text, label.left, (labels_y + ascent(text_px)).round(), &style);
    }
    strip
}

/// A label and where it begins.
struct Label<'a> {
    text: &'a str,
    left: f32,
    right: f32,
}

/// The labels that have room.
fn placed<'a>(
    scale: &'a Scale,
    [low, high]: [f32; 2],
    gap: f32,
    inner: f32,
    text_px: f32,
) -> Vec<(f32, Label<'a>)> {
    let mut marks: Vec<&(f32, String)> = scale.marks.iter().filter(|m| (low..=high).contains(&m.0)).collect();
    marks.sort_by_key(|m| m.0 != low && m.0 != high);
    let mut labels: Vec<(f32, Label)> = Vec::new();
    for (value, text) in marks {
        let wide = text_width(text, text_px);
        let middle = gap + inner * (value - low) / (high - low);
        let left = (middle - 0.5 * wide).min(gap + inner - wide).max(gap).floor();
        let label = Label { text, left, right: left + wide };
        let apart = |other: &Label| label.left > other.right + gap || label.right + gap < other.left;
        if wide <= inner && labels.iter().all(|(_, other)| apart(other)) {
            labels.push((*value, label));
        }
    }
    labels
}

fn column(strip: &mut Pixmap, x: u32, [from, to]: [f32; 2], [r, g, b]: [u8; 3]) {
    let width = strip.width();
    for y in from as u32..to as u32 {
        strip.pixels_mut()[(y * width + x) as usize] =
            PremultipliedColorU8::from_rgba(r, g, b, 255).expect("opaque");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Colouring, Values};

    fn distance() -> Scale {
        Colouring::distance(Values::PerTriangle(Vec::new()), 0.1).scale
    }

    /// No ink touches the border, and there is ink where labels are.
    #[test]
    fn nothing_is_cut_off() {
        for width in [16, 48, 96, 200, 512, 2048] {
            let strip = legend(&distance(), width);
            let (w, h) = (strip.width() as usize, strip.height() as usize);
            let paper = |x: usize, y: usize| strip.pixels()[y * w + x].red() == 255;
            assert!((0..w).all(|x| paper(x, 0) && paper(x, h - 1)), "{width}: above and below");
            let is_bar =
                |y: usize| strip.pixels()[y * w + w / 2].blue() != strip.pixels()[y * w + w / 2].red();
            assert!((0..h).filter(|&y| !is_bar(y)).all(|y| paper(0, y) && paper(w - 1, y)), "{width}: sides");
            assert!(width < 96 || (0..w).any(|x| !paper(x, h - h / 5)), "{width}: labels");
        }
    }

    #[test]
    fn the_ends_are_labelled_first_and_the_larger_number_is_right() {
        let scale = distance();
        let labels = placed(&scale, [0.0, 0.1], 9.0, 494.0, 18.0);
        assert_eq!(labels.iter().map(|l| l.1.text).collect::<Vec<_>>(), ["0 (good)", "0.1 or more", "0.05"]);
        assert!(
            labels[0].1.left == 9.0 && labels[1].1.right <= 503.0 && labels[2].1.left > labels[0].1.right
        );
        let few = placed(&scale, [0.0, 0.1], 4.0, 90.0, 8.0);
        assert_eq!(few.len(), 2, "no room in the middle");
        // Bright for small distances.
        let strip = legend(&scale, 512);
        let at = |x: usize| strip.pixels()[45 * 512 + x];
        assert!(at(12).green() > 200 && at(500).green() < 60, "{:?} {:?}", at(12), at(500));
    }
}
