//! Pictures in a grid with captions: figures and contact sheets.

use crate::PanelError;
use crate::text::{TextStyle, ascent, draw_text, text_width, wrap};
use tiny_skia::{Color, Pixmap, PixmapPaint, Transform};

/// One picture and what is written by it. An empty label takes no room unless a neighbour in the row has one.
#[derive(Debug, Clone, Copy)]
pub struct Panel<'a> {
    /// The picture.
    pub picture: &'a Pixmap,
    /// The caption; broken between words to the width of the column, and at line breaks.
    pub label: &'a str,
}

/// Which side of a picture its caption is on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Caption {
    /// Below the picture.
    Under,
    /// Above the picture.
    Above,
}

/// How panels are laid out. Lengths in pixels.
#[derive(Debug, Clone, PartialEq)]
pub struct Sheet {
    /// Pictures in a row.
    pub columns: usize,
    /// Written above everything, a quarter larger than captions.
    pub title: Option<String>,
    /// Side of the captions.
    pub caption: Caption,
    /// Size of captions, ascent to descent.
    pub text_px: f32,
    /// Space between pictures and round the sheet.
    pub gap_px: u32,
    /// Colour of the sheet.
    pub paper: [u8; 3],
    /// Colour of the text.
    pub ink: [u8; 3],
}

impl Default for Sheet {
    fn default() -> Self {
        Sheet {
            columns: 3,
            title: None,
            caption: Caption::Under,
            text_px: 18.0,
            gap_px: 12,
            paper: [255; 3],
            ink: [34; 3],
        }
    }
}

/// Lays `panels` out row by row, left to right. Every column is as wide as the widest picture, every row as high as
/// its highest picture and longest caption; pictures and captions are centred in their column. Pixels of pictures
/// are copied as they are.
///
/// # Errors
/// [`PanelError::Empty`] without panels or columns, [`PanelError::TooLarge`] beyond 65535 pixels on a side.
pub fn panels(panels: &[Panel<'_>], sheet: &Sheet) -> Result<Pixmap, PanelError> {
    if panels.is_empty() || sheet.columns == 0 {
        return Err(PanelError::Empty { panels: panels.len(), columns: sheet.columns });
    }
    let column_px = panels.iter().map(|p| p.picture.width()).max().unwrap_or(0);
    let columns = sheet.columns.min(panels.len());
    let width = columns as u64 * (column_px as u64 + sheet.gap_px as u64) + sheet.gap_px as u64;

    let title_px = sheet.text_px * 1.25;
    let inner_px = width.saturating_sub(2 * sheet.gap_px as u64) as f32;
    let title = Lines::new(sheet.title.as_deref().unwrap_or(""), title_px, inner_px);
    let rows: Vec<Row> = panels.chunks(columns).map(|row| Row::new(row, sheet, column_px)).collect();
    let gaps = (rows.len() as u64 + 1) * sheet.gap_px as u64;
    let title_room = if title.lines.is_empty() { 0 } else { title.height() as u64 + sheet.gap_px as u64 };
    let height = gaps + title_room + rows.iter().map(|r| (r.picture_px + r.caption_px) as u64).sum::<u64>();
    if width > 65535 || height > 65535 {
        return Err(PanelError::TooLarge { width, height });
    }
    let mut page = Pixmap::new(width as u32, height as u32).ok_or(PanelError::TooLarge { width, height })?;
    let [r, g, b] = sheet.paper;
    page.fill(Color::from_rgba8(r, g, b, 255));

    let mut y = sheet.gap_px;
    title.draw(&mut page, sheet, sheet.gap_px as f32, y as f32, inner_px);
    y += title_room as u32;
    for row in rows {
        row.draw(&mut page, sheet, column_px, y);
        y += row.picture_px + row.caption_px + sheet.gap_px;
    }
    Ok(page)
}

struct Row<'a> {
    panels: &'a [Panel<'a>],
    captions: Vec<Lines>,
    picture_px: u32,
    caption_px: u32,
}

impl<'a> Row<'a> {
    fn new(panels: &'a [Panel<'a>], sheet: &Sheet, column_px: u32) -> Row<'a> {
        let captions: Vec<Lines> =
            panels.iter().map(|p| Lines::new(p.label, sheet.text_px, column_px as f32)).collect();
        Row {
            panels,
            picture_px: panels.iter().map(|p| p.picture.height()).max().unwrap_or(0),
            caption_px: captions.iter().map(Lines::height).max().unwrap_or(0),
            captions,
        }
    }

    fn draw(&self, page: &mut Pixmap, sheet: &Sheet, column_px: u32, y: u32) {
        let (pictures_y, captions_y) = match sheet.caption {
            Caption::Under => (y, y + self.picture_px),
            Caption::Above => (y + self.caption_px, y),
        };
        for (i, (panel, caption)) in self.panels.iter().zip(&self.captions).enumerate() {
            let x = sheet.gap_px + i as u32 * (column_px + sheet.gap_px);
            let picture_x = x + (column_px - panel.picture.width()) / 2;
            let picture_y = pictures_y + (self.picture_px - panel.picture.height()) / 2;
            let at = (picture_x as i32, picture_y as i32);
            page.draw_pixmap(
                at.0,
                at.1,
                panel.picture.as_ref(),
                &PixmapPaint::default(),
                Transform::identity(),
                None,
            );
            caption.draw(page, sheet, x as f32, captions_y as f32, column_px as f32);
        }
    }
}

/// Wrapped text.
struct Lines {
    lines: Vec<String>,
    size_px: f32,
}

impl Lines {
    fn new(text: &str, size_px: f32, width: f32) -> Lines {
        Lines { lines: wrap(text, size_px, width), size_px }
    }

    /// Line height 1.15, and a third of a line above.
    fn height(&self) -> u32 {
        match self.lines.len() {
            0 => 0,
            n => ((n as f32 * 1.15 + 0.3) * self.size_px).ceil() as u32,
        }
    }

    /// Centred in `width` pixels from `x`, downwards from `y`.
    fn draw(&self, page: &mut Pixmap, sheet: &Sheet, x: f32, y: f32, width: f32) {
        let style = TextStyle { size_px: self.size_px, ink: sheet.ink };
        for (i, line) in self.lines.iter().enumerate() {
            let left = x + ((width - text_width(line, self.size_px)) * 0.5).max(0.0);
            let baseline = y + (0.2 + i as f32 * 1.15) * self.size_px + ascent(self.size_px);
            draw_text(page, line, left.round(), baseline.round(), &style);
        }
    }
}
