//! Colours on a dark page: which of them change, and to what.
//!
//! A drawing as SVG brings a rule for each of them, so that it follows the page, in an `img` too. Programs that know no style sheets
//! keep the colours for white paper.

use super::canvas::{BLACK, Colour, WHITE};
use super::style::{self, GRID, HUES};
use plotters::style::RGBColor;

/// The paper of a dark page: that of `style.css`.
const DARK_PAPER: Colour = RGBColor(0x14, 0x18, 0x1d);

/// Each colour that changes, on white paper and on dark. What is printed on a filled area is [`style::DARK_INK`] or
/// [`style::LIGHT_INK`], which stay.
fn pairs() -> Vec<(Colour, Colour)> {
    let mut pairs = vec![
        (WHITE, DARK_PAPER),
        (BLACK, RGBColor(0xe6, 0xe9, 0xed)),
        (GRID, RGBColor(0x36, 0x3d, 0x46)),
        // Too dark for dark paper: grey, the first stage, and three objects.
        (RGBColor(0x4d, 0x4d, 0x4d), RGBColor(0xa6, 0xac, 0xb4)),
        (RGBColor(0x33, 0x33, 0x33), RGBColor(0xd2, 0xd6, 0xdb)),
        (RGBColor(0x00, 0x5b, 0x8f), RGBColor(0x4f, 0xa8, 0xe0)),
        (RGBColor(0x00, 0x7a, 0x5a), RGBColor(0x3f, 0xbf, 0x9a)),
        (RGBColor(0x9b, 0x3f, 0x78), RGBColor(0xd6, 0x85, 0xb8)),
    ];
    // A tint lies between its hue and the paper.
    let dark = |hue: Colour| pairs.iter().find(|(light, _)| *light == hue).map_or(hue, |(_, dark)| *dark);
    let tints: Vec<(Colour, Colour)> =
        HUES.iter().map(|&hue| (style::tint(hue, WHITE), style::tint(dark(hue), DARK_PAPER))).collect();
    pairs.extend(tints);
    pairs
}

/// Whether a colour is another on a dark page.
pub(super) fn changes(colour: Colour) -> bool {
    pairs().iter().any(|(light, _)| *light == colour)
}

/// An SVG with rules for those of its colours that change on a dark page.
pub(super) fn with_dark_colours(svg: String) -> String {
    let hex = |RGBColor(r, g, b): Colour| format!("#{r:02X}{g:02X}{b:02X}");
    let mut rules = String::new();
    for (light, dark) in pairs() {
        for property in ["fill", "stroke"] {
            let attribute = format!("{property}=\"{}\"", hex(light));
            if svg.contains(&attribute) {
                rules += &format!("svg.figure [{attribute}]{{{property}:{}}}", hex(dark));
            }
        }
    }
    let style = format!("<style>@media screen and (prefers-color-scheme:dark){{{rules}}}</style>");
    let Some(end) = svg.find('>') else { return svg };
    let (head, rest) = svg.split_at(end);
    format!("{} class=\"figure\">{style}{}", head, &rest[1..])
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
    fn each_colour_turns_into_one() {
        let pairs = pairs();
        for (i, (light, _)) in pairs.iter().enumerate() {
            assert!(pairs[..i].iter().all(|(other, _)| other != light), "{light:?}");
        }
    }

    #[test]
    fn what_is_drawn_stands_out_from_dark_paper() {
        let pairs = pairs();
        let dark = |of: Colour| pairs.iter().find(|(light, _)| *light == of).map_or(of, |(_, dark)| *dark);
        assert!(contrast(dark(BLACK), DARK_PAPER) >= 4.5);
        // Areas, marks and lines: the guidelines ask for 3.
        let stages = style::stages().map(|(_, fill)| fill.colour);
        let objects: Vec<Colour> = (0..5).map(style::object_colour).collect();
        for colour in
            [&HUES[..], &stages, &objects, &[style::LEFT, style::NONE, style::RIGHT, style::IDEAL]].concat()
        {
            let found = contrast(dark(colour), DARK_PAPER);
            assert!(found >= 3.0, "{colour:?}: {found}");
        }
        // What is printed on bars.
        for fill in [style::LEFT, style::NONE, style::RIGHT] {
            let found = contrast(dark(style::ink_on(fill)), dark(fill));
            assert!(found >= 4.5, "{fill:?}: {found}");
        }
    }

    #[test]
    fn a_drawing_keeps_its_colours_and_brings_the_others() {
        let svg =
            "<svg width=\"1\" height=\"1\">\n<rect fill=\"#FFFFFF\"/><text fill=\"#222222\">x</text></svg>\n";
        let with = with_dark_colours(svg.into());
        assert!(
            with.starts_with("<svg width=\"1\" height=\"1\" class=\"figure\"><style>@media screen and"),
            "{with}"
        );
        assert!(with.contains(
            "svg.figure [fill=\"#FFFFFF\"]{fill:#14181D}svg.figure [fill=\"#222222\"]{fill:#E6E9ED}}"
        ));
        assert!(
            with.contains("<rect fill=\"#FFFFFF\"/><text fill=\"#222222\">x</text>")
                && !with.contains("#DDDDDD")
        );
    }
}
