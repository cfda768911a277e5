//! Pictures and films from files of one's own, in full colour, and rows of them.

use crate::FilmError;
use crate::animation::frames_in_a_row;
use gif::{Encoder, Frame, Repeat};
use image::codecs::gif::GifDecoder;
use image::imageops::{self, FilterType};
use image::{AnimationDecoder, ImageFormat, Rgb, RgbImage, RgbaImage};
use rayon::prelude::*;
use std::io::Cursor;
use tiny_skia::{Pixmap, PremultipliedColorU8};

/// The most bytes of pixels that a file may unfold to.
const MOST_BYTES: u64 = 4 << 30;
/// How finely colours of a GIF are chosen where a frame has more than 256 of them: 1 is finest, 30 fastest.
const SPEED: i32 = 5;

/// Pictures of one size in full colour: one of a still picture, more of a film.
#[derive(Debug, Clone, PartialEq)]
pub struct Film {
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// Seconds that the film takes; `None` of a still picture.
    pub duration_s: Option<f64>,
    /// Red, green and blue of each pixel, row by row from the upper left, a frame each.
    pub frames: Vec<Vec<u8>>,
}

impl Film {
    /// A still picture from a PNG. What is transparent lies on white.
    ///
    /// # Errors
    /// [`FilmError::Image`] for what is no PNG.
    pub fn from_png(bytes: &[u8]) -> Result<Self, FilmError> {
        let picture = image::load_from_memory_with_format(bytes, ImageFormat::Png)?.into_rgba8();
        let (width, height) = picture.dimensions();
        Ok(Self { width, height, duration_s: None, frames: vec![on_white(&picture)] })
    }

    /// The frames of a GIF, whole, with the times that it gives them; of one frame, a still picture. What is transparent lies on white.
    ///
    /// # Errors
    /// [`FilmError::Image`] for what is no GIF; [`FilmError::Large`] for one that unfolds to more than 4 GiB.
    pub fn from_gif(bytes: &[u8]) -> Result<Self, FilmError> {
        let (mut frames, mut size, mut ms) = (Vec::new(), None, 0.0);
        for frame in GifDecoder::new(Cursor::new(bytes))?.into_frames() {
            let frame = frame?;
            let (numerator, denominator) = frame.delay().numer_denom_ms();
            ms += f64::from(numerator) / f64::from(denominator.max(1));
            let picture = frame.into_buffer();
            let [width, height] = *size.get_or_insert_with(|| [picture.width(), picture.height()]);
            frames.push(on_white(&picture));
            let unfolded = 3 * u64::from(width) * u64::from(height) * frames.len() as u64;
            if unfolded > MOST_BYTES {
                return Err(FilmError::Large { most: MOST_BYTES });
            }
        }
        let [width, height] = size.ok_or(FilmError::Empty)?;
        let duration_s = (frames.len() > 1).then_some(ms / 1000.0);
        Ok(Self { width, height, duration_s, frames })
    }

    /// All of them side by side from left to right, edge to edge; `None` of none. The first one's length is that of all.
    ///
    /// # Errors
    /// [`FilmError::Mismatch`] unless all have the same size and number of frames.
    pub fn in_a_row(all: &[Film]) -> Result<Option<Film>, FilmError> {
        let Some((first, others)) = all.split_first() else { return Ok(None) };
        others.iter().try_for_each(|other| first.check_goes_with(other))?;
        let frames: Vec<&[Vec<u8>]> = all.iter().map(|one| &one.frames[..]).collect();
        let frames = frames_in_a_row(&frames, 3 * first.width as usize);
        Ok(Some(Film { width: first.width * all.len() as u32, frames, ..*first }))
    }

    /// Whether another stands beside it.
    ///
    /// # Errors
    /// [`FilmError::Mismatch`] unless both have the same size and number of frames.
    pub fn check_goes_with(&self, other: &Film) -> Result<(), FilmError> {
        for (what, own, other) in [
            ("width", self.width as usize, other.width as usize),
            ("height", self.height as usize, other.height as usize),
            ("number of frames", self.frames.len(), other.frames.len()),
        ] {
            if own != other {
                return Err(FilmError::Mismatch { what, own, other });
            }
        }
        Ok(())
    }

    /// The first frame as a PNG without metadata; the same picture gives the same bytes.
    ///
    /// # Errors
    /// [`FilmError::Empty`] of no frame.
    pub fn to_png(&self) -> Result<Vec<u8>, FilmError> {
        Ok(crate::pixmap_to_png(&self.picture()?))
    }

    /// A GIF that loops forever and takes `duration_s`, each frame with up to 256 colours of its own; without metadata. The same film gives
    /// the same bytes.
    ///
    /// # Errors
    /// [`FilmError::Encode`] where a side does not fit in 16 bits.
    pub fn to_gif(&self, duration_s: f64) -> Result<Vec<u8>, FilmError> {
        let side = |pixels: u32| u16::try_from(pixels).map_err(|_| FilmError::Large { most: 65_535 });
        let (width, height) = (side(self.width)?, side(self.height)?);
        // Whole hundredths of a second, which add up to the whole.
        let ends =
            |frame: usize| (100.0 * duration_s * frame as f64 / self.frames.len() as f64).round() as u64;
        let compressed = |(number, pixels): (usize, &Vec<u8>)| {
            let mut frame = Frame::from_rgb_speed(width, height, pixels, SPEED);
            frame.delay = u16::try_from(ends(number + 1) - ends(number)).unwrap_or(u16::MAX);
            frame.make_lzw_pre_encoded();
            frame
        };
        let frames: Vec<Frame<'_>> = self.frames.par_iter().enumerate().map(compressed).collect();
        let mut encoder = Encoder::new(Vec::new(), width, height, &[])?;
        encoder.set_repeat(Repeat::Infinite)?;
        for frame in &frames {
            encoder.write_lzw_pre_encoded_frame(frame)?;
        }
        Ok(encoder.into_inner()?)
    }

    /// The first frame.
    ///
    /// # Errors
    /// [`FilmError::Empty`] of no frame.
    pub fn picture(&self) -> Result<Pixmap, FilmError> {
        pixmap(self.first()?)
    }

    /// The first frame, its longer side `side_px` long.
    ///
    /// # Errors
    /// [`FilmError::Empty`] of no frame.
    pub fn thumbnail(&self, side_px: u32) -> Result<Pixmap, FilmError> {
        let longer = f64::from(self.width.max(self.height));
        let shrunk = |pixels: u32| (f64::from(pixels) * f64::from(side_px) / longer).round().max(1.0) as u32;
        pixmap(imageops::resize(
            &self.first()?,
            shrunk(self.width),
            shrunk(self.height),
            FilterType::Triangle,
        ))
    }

    fn first(&self) -> Result<RgbImage, FilmError> {
        let pixels = self.frames.first().ok_or(FilmError::Empty)?;
        RgbImage::from_raw(self.width, self.height, pixels.clone()).ok_or(FilmError::Empty)
    }
}

fn pixmap(picture: RgbImage) -> Result<Pixmap, FilmError> {
    let mut pixmap = Pixmap::new(picture.width(), picture.height()).ok_or(FilmError::Empty)?;
    for (to, Rgb([r, g, b])) in pixmap.pixels_mut().iter_mut().zip(picture.pixels()) {
        *to = PremultipliedColorU8::from_rgba(*r, *g, *b, 255).expect("opaque");
    }
    Ok(pixmap)
}

fn on_white(picture: &RgbaImage) -> Vec<u8> {
    let over = |of: u8, alpha: u8| {
        let (of, alpha) = (u32::from(of), u32::from(alpha));
        ((of * alpha + 255 * (255 - alpha) + 127) / 255) as u8
    };
    picture.pixels().flat_map(|pixel| [0, 1, 2].map(|k| over(pixel.0[k], pixel.0[3]))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two frames of four colours, of which none is grey.
    fn film() -> Film {
        let frame = |from: u8| (0..12).flat_map(|i| [from + 20 * (i % 4), 200, 30]).collect();
        Film { width: 4, height: 3, duration_s: Some(0.25), frames: vec![frame(0), frame(90)] }
    }

    #[test]
    fn a_film_of_few_colours_comes_back_from_a_gif_as_it_was() {
        let film = film();
        let bytes = film.to_gif(0.25).unwrap();
        assert_eq!(Film::from_gif(&bytes).unwrap(), film);
        assert_eq!(bytes, film.to_gif(0.25).unwrap());
        assert_eq!(crate::gif_texts(&bytes), Vec::<String>::new());
    }

    #[test]
    fn frames_take_the_whole_time_whatever_their_number() {
        for frames in [2, 3, 7, 24] {
            let film = Film { frames: vec![vec![9; 36]; frames], ..film() };
            let read = Film::from_gif(&film.to_gif(2.0).unwrap()).unwrap();
            assert!((read.duration_s.unwrap() - 2.0).abs() < 1e-9, "{frames}");
        }
    }

    #[test]
    fn a_picture_comes_back_from_a_png_and_glass_lies_on_white() {
        let still = Film { frames: film().frames[..1].to_vec(), duration_s: None, ..film() };
        assert_eq!(Film::from_png(&still.to_png().unwrap()).unwrap(), still);
        let mut glass = Vec::new();
        let picture = RgbaImage::from_pixel(2, 1, image::Rgba([255, 0, 0, 51]));
        picture.write_to(&mut Cursor::new(&mut glass), ImageFormat::Png).unwrap();
        assert_eq!(Film::from_png(&glass).unwrap().frames, [[255, 204, 204, 255, 204, 204]]);
    }

    #[test]
    fn a_row_has_each_where_it_stands_and_others_are_refused() {
        let (left, mut right) = (film(), film());
        right.frames.reverse();
        let row = Film::in_a_row(&[left.clone(), right.clone()]).unwrap().unwrap();
        assert_eq!((row.width, row.height, row.frames.len()), (8, 3, 2));
        for (number, frame) in row.frames.iter().enumerate() {
            for (y, pixels) in frame.chunks_exact(24).enumerate() {
                assert_eq!(pixels[..12], left.frames[number][12 * y..][..12]);
                assert_eq!(pixels[12..], right.frames[number][12 * y..][..12]);
            }
        }
        right.frames.pop();
        let refused = Film::in_a_row(&[left, right]).unwrap_err().to_string();
        assert_eq!(refused, "number of frames: 2 and 1");
    }

    #[test]
    fn what_is_no_picture_is_refused() {
        let bytes = film().to_gif(1.0).unwrap();
        for cut in 0..bytes.len() {
            let _ = Film::from_gif(&bytes[..cut]);
        }
        assert!(Film::from_gif(b"GIF89a").is_err());
        assert!(Film::from_png(b"\x89PNG").is_err());
    }
}
