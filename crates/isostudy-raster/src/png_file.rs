//! Pictures as PNG files.

use crate::PanelError;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder, ImageFormat};
use tiny_skia::{Pixmap, PremultipliedColorU8};

/// A PNG of red, green and blue without alpha: what is transparent in `pixmap` comes out over black. No metadata;
/// the same picture gives the same bytes.
///
/// # Panics
/// Only if writing to memory fails, which the coder has no other reason for than lack of memory.
pub fn pixmap_to_png(pixmap: &Pixmap) -> Vec<u8> {
    let rgb: Vec<u8> = pixmap.pixels().iter().flat_map(|p| [p.red(), p.green(), p.blue()]).collect();
    let mut png = Vec::new();
    PngEncoder::new(&mut png)
        .write_image(&rgb, pixmap.width(), pixmap.height(), ExtendedColorType::Rgb8)
        .expect("a PNG in memory");
    png
}

/// The picture in a PNG, opaque; alpha is dropped.
///
/// # Errors
/// [`PanelError::Png`] when `png` is not a PNG.
pub fn pixmap_from_png(png: &[u8]) -> Result<Pixmap, PanelError> {
    let rgb = image::load_from_memory_with_format(png, ImageFormat::Png)?.into_rgb8();
    let (width, height) = rgb.dimensions();
    let too_large = PanelError::TooLarge { width: width as u64, height: height as u64 };
    let mut pixmap = Pixmap::new(width, height).ok_or(too_large)?;
    for (to, from) in pixmap.pixels_mut().iter_mut().zip(rgb.pixels()) {
        let [r, g, b] = from.0;
        *to = PremultipliedColorU8::from_rgba(r, g, b, 255).expect("opaque");
    }
    Ok(pixmap)
}
