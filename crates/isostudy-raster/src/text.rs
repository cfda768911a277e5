//! Lines of text in a pixmap. tiny-skia has none.

use ab_glyph::{Font, FontRef, Glyph, PxScale, ScaleFont, point};
use tiny_skia::{Pixmap, PremultipliedColorU8};

/// DejaVu Sans, `assets/fonts/DejaVuSans.ttf`; licence beside it. Pictures look alike on every machine.
pub const FONT: &[u8] = include_bytes!("../../../assets/fonts/DejaVuSans.ttf");

/// How text is set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TextStyle {
    /// Pixels from the font's ascent to its descent; capitals are about 0.63 of it.
    pub size_px: f32,
    /// Red, green, blue.
    pub ink: [u8; 3],
}

/// Width of one line in pixels, kerning included.
pub fn text_width(text: &str, size_px: f32) -> f32 {
    line(text, size_px).1
}

/// Pixels from a line's top to its baseline.
pub(crate) fn ascent(size_px: f32) -> f32 {
    font().as_scaled(PxScale::from(size_px)).ascent()
}

/// Draws one line with its left end at `x` and its baseline at `y` (pixels from the upper left corner), over what
/// is there; what falls outside is cut off. Characters the font lacks show as a box.
pub fn draw_text(pixmap: &mut Pixmap, text: &str, x: f32, y: f32, style: &TextStyle) {
    let font = font();
    let (width, height) = (pixmap.width() as i32, pixmap.height() as i32);
    for mut glyph in line(text, style.size_px).0 {
        glyph.position += point(x, y);
        let Some(outline) = font.outline_glyph(glyph) else { continue };
        let corner = outline.px_bounds().min;
        outline.draw(|dx, dy, coverage| {
            let (px, py) = (corner.x as i32 + dx as i32, corner.y as i32 + dy as i32);
            if (0..width).contains(&px) && (0..height).contains(&py) {
                let pixel = &mut pixmap.pixels_mut()[(py * width + px) as usize];
                *pixel = blend(*pixel, style.ink, coverage.clamp(0.0, 1.0));
            }
        });
    }
}

/// `text` in lines of at most `width` pixels, broken between words; a word that is wider has a line to itself.
pub(crate) fn wrap(text: &str, size_px: f32, width: f32) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for paragraph in text.lines() {
        lines.push(String::new());
        for word in paragraph.split_whitespace() {
            let last = lines.last_mut().expect("just pushed");
            let joined = if last.is_empty() { word.to_string() } else { format!("{last} {word}") };
            if last.is_empty() || text_width(&joined, size_px) <= width {
                *last = joined;
            } else {
                lines.push(word.to_string());
            }
        }
    }
    lines
}

fn font() -> FontRef<'static> {
    FontRef::try_from_slice(FONT).expect("the font in the repository is a font")
}

/// Glyphs from the origin, and the width.
fn line(text: &str, size_px: f32) -> (Vec<Glyph>, f32) {
    let font = font();
    let scaled = font.as_scaled(PxScale::from(size_px));
    let (mut glyphs, mut x, mut last) = (Vec::new(), 0.0, None);
    for c in text.chars() {
        let id = scaled.glyph_id(c);
        x += last.map_or(0.0, |last| scaled.kern(last, id));
        glyphs.push(id.with_scale_and_position(PxScale::from(size_px), point(x, 0.0)));
        x += scaled.h_advance(id);
        last = Some(id);
    }
    (glyphs, x)
}

fn blend(under: PremultipliedColorU8, ink: [u8; 3], coverage: f32) -> PremultipliedColorU8 {
    let over = |ink: u8, under: u8| (ink as f32 * coverage + under as f32 * (1.0 - coverage) + 0.5) as u8;
    let alpha = over(255, under.alpha());
    let [r, g, b] = [over(ink[0], under.red()), over(ink[1], under.green()), over(ink[2], under.blue())];
    PremultipliedColorU8::from_rgba(r.min(alpha), g.min(alpha), b.min(alpha), alpha).expect("at most alpha")
}
