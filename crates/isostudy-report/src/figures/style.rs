//! Colours and fills: told apart by lightness as well as by hue (after Okabe and Ito 2008).
//!
//! Hue and lightness tell the level of the last factor, or the family of a method in a study without factors; full, tinted or striped
//! tells the level of the factor before, or the method within its family. Stripes also tell the second stage or half of a bar. A mark's
//! shape goes with its hue, and tells methods of a family apart that has more of them than there are fillings.

use super::canvas::{BLACK, Canvas, Colour, WHITE};
use super::marks::{Filling, Mark, SHAPE_COUNT};
use super::palette::{self, DARK_INK, HUES, LIGHT_INK, tint};
pub(super) use super::palette::{GRID, IDEAL};
use isostudy_design::{MethodId, Study};
use plotters::style::RGBColor;

/// How an area is filled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Fill {
    pub(super) colour: Colour,
    pub(super) outline: Colour,
    pub(super) stripes: bool,
}

pub(super) const LEFT: Colour = RGBColor(0x00, 0x72, 0xb2);
pub(super) const NONE: Colour = RGBColor(0xdc, 0xdc, 0xdc);
pub(super) const RIGHT: Colour = RGBColor(0xe6, 0x9f, 0x00);

/// With more methods than this, their names would take more room than what is drawn.
const MOST_NAMED: usize = 8;

/// Whether figures name methods by their codes.
pub(super) fn has_codes(study: &Study) -> bool {
    study.methods.len() > MOST_NAMED
}

/// What stands under a method's bar or box: its name, or its code where there are many.
pub(super) fn name(study: &Study, method: MethodId) -> String {
    if has_codes(study) { method.to_string() } else { study.method(method).label.clone() }
}

impl Fill {
    pub(super) fn plain(colour: Colour) -> Self {
        Self { colour, outline: colour, stripes: false }
    }

    pub(super) fn striped(self) -> Self {
        Self { stripes: true, ..self }
    }

    /// Black or white, whichever stands out.
    pub(super) fn ink(self) -> Colour {
        ink_on(self.colour)
    }

    /// Fills a rectangle; nothing if it is empty.
    pub(super) fn paint(self, canvas: &mut Canvas, from: (f64, f64), to: (f64, f64)) {
        let (x0, x1) = (from.0.min(to.0), from.0.max(to.0));
        let (y0, y1) = (from.1.min(to.1), from.1.max(to.1));
        if y1 - y0 < 0.25 || x1 - x0 < 0.25 {
            return;
        }
        // An outline that is a line reaches half a pixel beyond the area, on one side: stacked areas would not be flush.
        canvas.rectangle((x0, y0), (x1, y1), self.outline);
        if self.colour == self.outline && !self.stripes {
            return;
        }
        let (inner, outer) = ((x0 + 1.0, y0 + 1.0), (x1 - 1.0, y1 - 1.0));
        if outer.0 <= inner.0 || outer.1 <= inner.1 {
            return;
        }
        canvas.rectangle(inner, outer, self.colour);
        if self.stripes {
            stripes(canvas, inner, outer, self.ink());
        }
    }
}

/// Rising diagonal stripes, cut to the rectangle.
fn stripes(canvas: &mut Canvas, from: (f64, f64), to: (f64, f64), colour: Colour) {
    const STEP: f64 = 5.0;
    let ((x0, y0), (x1, y1)) = (from, to);
    // Lines x + y = c.
    let mut c = ((x0 + y0) / STEP).ceil() * STEP;
    while c < x1 + y1 {
        let start = (c - y1).max(x0);
        let end = (c - y0).min(x1);
        if end - start > 0.5 {
            canvas.line(vec![(start, c - start), (end, c - end)], colour, 0.5);
        }
        c += STEP;
    }
}

/// Black or white, whichever stands out from a colour. What changes on dark paper takes inks that do.
pub(super) fn ink_on(colour: Colour) -> Colour {
    let RGBColor(r, g, b) = colour;
    let lightness = 0.299 * f64::from(r) + 0.587 * f64::from(g) + 0.114 * f64::from(b);
    match (lightness < 128.0, palette::changes(colour)) {
        (true, true) => WHITE,
        (true, false) => LIGHT_INK,
        (false, true) => BLACK,
        (false, false) => DARK_INK,
    }
}

/// How many ways of filling there are.
const FILLINGS: usize = 4;

/// Whether two factors tell all methods apart, in hues and fillings enough.
fn tells_methods(study: &Study) -> bool {
    let all: Vec<&Vec<Option<usize>>> = study.methods.iter().map(|method| &method.levels).collect();
    let fits = |levels: &[Option<usize>], most: [usize; 2]| {
        levels.iter().zip(most).all(|(level, most)| level.is_some_and(|level| level < most))
    };
    let distinct = |i: usize| !all[..i].contains(&all[i]);
    (0..all.len()).all(|i| fits(all[i], [FILLINGS, HUES.len()]) && distinct(i))
}

/// The colour of an object's marks: dark enough for white paper, and apart in lightness.
pub(super) fn object_colour(object: usize) -> Colour {
    const COLOURS: [Colour; 5] = [
        RGBColor(0x00, 0x5b, 0x8f),
        RGBColor(0xb8, 0x55, 0x00),
        RGBColor(0x22, 0x22, 0x22),
        RGBColor(0x00, 0x7a, 0x5a),
        RGBColor(0x9b, 0x3f, 0x78),
    ];
    COLOURS[object % COLOURS.len()]
}

/// How a method looks: its hue and filling, wherever it is drawn, and the shape of its mark.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Look {
    pub(super) hue: usize,
    pub(super) filling: usize,
    pub(super) shape: usize,
}

impl Look {
    /// A hue has its own shape, as long as its fillings last.
    fn of(hue: usize, filling: usize) -> Self {
        let hue = hue % HUES.len();
        Self { hue, filling: filling % FILLINGS, shape: hue }
    }
}

/// What methods have in common that look alike. Two lattices of tetrahedra are two families.
fn family(of: &isostudy_design::Method) -> (&str, Option<&str>) {
    let arrangement = of.recipe.settings.get("arrangement").and_then(|value| value.as_str());
    (&of.recipe.kind, arrangement)
}

/// Methods of one family share a hue, and its shape as long as the fillings of that last; the others of a large family have what
/// shapes and fillings are left, so that marks differ without their hues too. `None` where all methods are one family.
fn by_family(study: &Study, method: MethodId) -> Option<Look> {
    let mut families = Vec::new();
    for of in &study.methods {
        if !families.contains(&family(of)) {
            families.push(family(of));
        }
    }
    if families.len() < 2 {
        return None;
    }
    let hues: Vec<usize> = study
        .methods
        .iter()
        .map(|of| families.iter().position(|known| *known == family(of)).unwrap_or(0) % HUES.len())
        .collect();
    let mut looks: Vec<Option<Look>> = vec![None; hues.len()];
    // Those with the shape of their hue first, so that no large family takes another's.
    for shapes in [1, SHAPE_COUNT] {
        for place in 0..hues.len() {
            let hue = hues[place];
            let mut free = (0..shapes * FILLINGS)
                .map(|n| Look { shape: (hue + n / FILLINGS) % SHAPE_COUNT, ..Look::of(hue, n) });
            let is_mark = |look: &Look, of: &Look| (look.shape, look.filling) == (of.shape, of.filling);
            let is_free = |look: &Look| !looks.iter().flatten().any(|of| is_mark(look, of));
            if looks[place].is_none() {
                looks[place] = free.find(is_free);
            }
        }
    }
    // More methods than marks: hues tell them apart as far as they go.
    for place in 0..hues.len() {
        let hue = hues[place];
        let mut all = (0..SHAPE_COUNT * FILLINGS)
            .map(|n| Look { shape: (hue + n / FILLINGS) % SHAPE_COUNT, ..Look::of(hue, n) });
        let is_free = |look: &Look| !looks.iter().flatten().any(|of| of == look);
        if looks[place].is_none() {
            looks[place] = all.find(is_free).or(Some(Look::of(hue, place)));
        }
    }
    looks[study.place(method)]
}

/// How a method looks: by its levels, else by its family, else by place. No two of up to 32 methods of a study have all in common.
pub(super) fn look(study: &Study, method: MethodId) -> Look {
    let level = |factor| study.level_of(method, factor).map(|level| level.index);
    let crossed = match study.declared_factors().collect::<Vec<_>>()[..] {
        [outer, inner] if tells_methods(study) => level(outer).zip(level(inner)),
        _ => None,
    };
    let crossed = crossed.map(|(filling, hue)| Look::of(hue, filling));
    let place = study.place(method);
    crossed.or_else(|| by_family(study, method)).unwrap_or_else(|| Look::of(place, place / HUES.len()))
}

/// The mark of a method.
pub(super) fn mark(study: &Study, method: MethodId) -> Mark {
    let Look { filling, shape, .. } = look(study, method);
    Mark::of(shape, [Filling::Full, Filling::Hollow, Filling::Dotted, Filling::Holed][filling])
}

/// The fill of a method.
pub(super) fn method(study: &Study, method: MethodId) -> Fill {
    let Look { hue, filling, .. } = look(study, method);
    let colour = HUES[hue];
    match filling {
        0 => Fill::plain(colour),
        1 => Fill { colour: tint(colour, WHITE), outline: colour, stripes: false },
        2 => Fill { colour: tint(colour, WHITE), outline: colour, stripes: true },
        _ => Fill::plain(colour).striped(),
    }
}

/// The fills of the five stages, in their order.
pub(super) fn stages() -> [(&'static str, Fill); 5] {
    [
        ("allocation", Fill::plain(RGBColor(0x33, 0x33, 0x33))),
        ("sampling", Fill::plain(RGBColor(0x56, 0xb4, 0xe9))),
        ("vertex", Fill::plain(RGBColor(0xe6, 0x9f, 0x00))),
        ("geometry", Fill::plain(RGBColor(0x00, 0x72, 0xb2)).striped()),
        ("normals", Fill::plain(RGBColor(0xcc, 0x79, 0xa7))),
    ]
}

/// The fill of what finishes a mesh, after the stages.
pub(super) fn finishing() -> (&'static str, Fill) {
    ("finishing", Fill::plain(RGBColor(0x00, 0x9e, 0x73)).striped())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn luminance(RGBColor(r, g, b): Colour) -> f64 {
        let channel = |c: u8| {
            let c = f64::from(c) / 255.0;
            if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        };
        0.2126 * channel(r) + 0.7152 * channel(g) + 0.0722 * channel(b)
    }

    /// As in the Web Content Accessibility Guidelines.
    fn contrast(a: Colour, b: Colour) -> f64 {
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn what_is_drawn_stands_out_from_dark_paper() {
        let dark = palette::on_dark;
        assert!(contrast(dark(BLACK), palette::DARK_PAPER) >= 4.5);
        // Areas, marks and lines: the guidelines ask for 3.
        let stages: Vec<Colour> =
            stages().into_iter().chain([finishing()]).map(|(_, fill)| fill.colour).collect();
        let objects: Vec<Colour> = (0..5).map(object_colour).collect();
        for colour in [&HUES[..], &stages, &objects, &[LEFT, NONE, RIGHT, IDEAL]].concat() {
            let found = contrast(dark(colour), palette::DARK_PAPER);
            assert!(found >= 3.0, "{colour:?}: {found}");
        }
        // What is printed on bars.
        for fill in [LEFT, NONE, RIGHT] {
            let found = contrast(dark(ink_on(fill)), dark(fill));
            assert!(found >= 4.5, "{fill:?}: {found}");
        }
    }
}
