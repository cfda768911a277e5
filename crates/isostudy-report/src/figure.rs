//! A drawn figure.

/// A figure.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// File name without extension.
    pub name: String,
    /// Caption: what is shown, and what is left out.
    pub caption: String,
    /// The drawing as SVG. Text stays text, in DejaVu Sans or what the viewer has instead.
    pub svg: String,
    /// The same drawn once more for narrow screens, 360 pixels wide, where it stands on a page.
    pub narrow: Option<String>,
    /// The drawing as PNG, 2000 pixels wide, 8-bit RGB.
    pub png: Vec<u8>,
}

impl Figure {
    /// Width and height as it is shown, in pixels: half of what the PNG has.
    pub fn size(&self) -> [u32; 2] {
        size(&self.svg)
    }

    /// The same of the drawing for narrow screens.
    pub fn narrow_size(&self) -> Option<[u32; 2]> {
        self.narrow.as_deref().map(size)
    }
}

fn size(svg: &str) -> [u32; 2] {
    let attribute = |name: &str| {
        let rest = svg.split_once(&format!("{name}=\""))?.1;
        rest.split_once('"')?.0.parse::<f64>().ok()
    };
    ["width", "height"].map(|name| attribute(name).map_or(0, |size| size.round() as u32))
}
