//! Colours on a dark page: which of them change, and to what.
//!
//! A drawing as SVG brings a rule for each of them, so that it follows the page, in an `img` too. Programs that know no style sheets
//! keep the colours for white paper.

use plotters::style::RGBColor;

pub(super) type Colour = RGBColor;

/// Ink and paper.
pub(super) const BLACK: Colour = RGBColor(0x22, 0x22, 0x22);
pub(super) const WHITE: Colour = RGBColor(0xff, 0xff, 0xff);
/// What is printed on an area whose colour is the same on white and on dark paper. Not quite black and white, so that they stay
/// too, unlike ink and paper.
pub(super) const DARK_INK: Colour = RGBColor(0x1c, 0x1c, 0x1c);
pub(super) const LIGHT_INK: Colour = RGBColor(0xfd, 0xfd, 0xfd);
/// What is hoped for, under what was measured.
pub(super) const IDEAL: Colour = RGBColor(0x99, 0x99, 0x99);
pub(super) const GRID: Colour = RGBColor(0xdd, 0xdd, 0xdd);

/// Hues of levels, by place: grey, orange, blue, green, purple, sky blue, vermilion. As many as marks have shapes.
pub(super) const HUES: [Colour; 7] = [
    RGBColor(0x4d, 0x4d, 0x4d),
    RGBColor(0xe6, 0x9f, 0x00),
    RGBColor(0x00, 0x72, 0xb2),
    RGBColor(0x00, 0x9e, 0x73),
    RGBColor(0xcc, 0x79, 0xa7),
    RGBColor(0x56, 0xb4, 0xe9),
    RGBColor(0xd5, 0x5e, 0x00),
];

/// The paper of a dark page: that of `style.css`.
pub(super) const DARK_PAPER: Colour = RGBColor(0x14, 0x18, 0x1d);

/// Each colour that changes, on white paper and on dark. What is printed on a filled area is [`DARK_INK`] or
/// [`LIGHT_INK`], which stay.
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
        HUES.iter().map(|&hue| (tint(hue, WHITE), tint(dark(hue), DARK_PAPER))).collect();
    pairs.extend(tints);
    pairs
}

/// What a colour is on a dark page.
#[cfg(test)]
pub(super) fn on_dark(colour: Colour) -> Colour {
    pairs().into_iter().find(|(light, _)| *light == colour).map_or(colour, |(_, dark)| dark)
}

/// Whether a colour is another on a dark page.
pub(super) fn changes(colour: Colour) -> bool {
    pairs().iter().any(|(light, _)| *light == colour)
}

/// A colour that lets the paper through.
pub(super) fn tint(colour: Colour, paper: Colour) -> Colour {
    let mixed = |c: u8, paper: u8| (f64::from(c) * 0.38 + f64::from(paper) * 0.62).round() as u8;
    RGBColor(mixed(colour.0, paper.0), mixed(colour.1, paper.1), mixed(colour.2, paper.2))
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

    #[test]
    fn each_colour_turns_into_one() {
        let pairs = pairs();
        for (i, (light, _)) in pairs.iter().enumerate() {
            assert!(pairs[..i].iter().all(|(other, _)| other != light), "{light:?}");
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
