//! Animations as GIF files.

use crate::{Animation, AnimationError, Palette};
use gif::{ColorOutput, DecodeOptions, DisposalMethod, Encoder, Frame, Repeat};
use rayon::prelude::*;
use std::borrow::Cow;
use std::io::{Read, Write};

impl Animation {
    /// Writes a GIF that loops forever: one global palette, every frame whole, no comment, no metadata. The same
    /// animation gives the same bytes. Frames are compressed in parallel on rayon's current pool.
    ///
    /// Whole frames on purpose: cropping to what changed saved 2 % of a turntable's size and no time, and would
    /// cost pairs their plain copy of rows.
    ///
    /// # Errors
    /// [`AnimationError::Size`] when a side does not fit in 16 bits; [`AnimationError::Encode`] when writing fails.
    ///
    /// # Panics
    /// If a frame does not hold `width * height` indices.
    pub fn write_gif(&self, writer: impl Write) -> Result<(), AnimationError> {
        let side = |pixels: u32| match u16::try_from(pixels) {
            Ok(side) if side > 0 => Ok(side),
            _ => Err(AnimationError::Size { pixels: pixels as u64 }),
        };
        let (width, height) = (side(self.width)?, side(self.height)?);
        let frames: Vec<Frame> =
            self.frames.par_iter().map(|f| compress(f, self.delay_cs, width, height)).collect();
        let mut encoder = Encoder::new(writer, width, height, self.palette.colours().as_flattened())?;
        encoder.set_repeat(Repeat::Infinite)?;
        for frame in &frames {
            encoder.write_lzw_pre_encoded_frame(frame)?;
        }
        encoder.into_inner()?.flush().map_err(gif::EncodingError::from)?;
        Ok(())
    }

    /// Reads what [`Animation::write_gif`] wrote, index by index: reading a turntable back gives the animation that
    /// was written.
    ///
    /// # Errors
    /// [`AnimationError::Decode`] for a damaged file, [`AnimationError::Foreign`] for a GIF without a global
    /// palette or with frames that are partial, transparent, differently timed or coloured by themselves.
    pub fn read_gif(reader: impl Read) -> Result<Animation, AnimationError> {
        let mut options = DecodeOptions::new();
        options.set_color_output(ColorOutput::Indexed);
        let mut decoder = options.read_info(reader)?;
        let foreign = |reason, frame| AnimationError::Foreign { reason, frame };
        let (width, height) = (decoder.width(), decoder.height());
        let colours = decoder.global_palette().ok_or(foreign("no global palette", None))?;
        let (colours, _) = colours.as_chunks::<3>();
        let palette = Palette::new(colours.to_vec());
        let used = palette.colours().len();

        let mut frames = Vec::new();
        let mut delay_cs = None;
        while let Some(frame) = decoder.next_frame_info()? {
            let at = Some(frames.len());
            if (frame.left, frame.top, frame.width, frame.height) != (0, 0, width, height) {
                return Err(foreign("a partial frame", at));
            }
            if frame.palette.is_some() || frame.transparent.is_some() {
                return Err(foreign("a palette or transparency of its own", at));
            }
            if *delay_cs.get_or_insert(frame.delay) != frame.delay {
                return Err(foreign("another delay than the first frame's", at));
            }
            let mut indices = vec![0; decoder.buffer_size()];
            decoder.read_into_buffer(&mut indices)?;
            if used < 256 && indices.iter().any(|&i| i as usize >= used) {
                return Err(foreign("an index beyond the palette", at));
            }
            frames.push(indices);
        }
        let delay_cs = delay_cs.ok_or(foreign("no frame", None))?;
        Ok(Animation { width: width as u32, height: height as u32, delay_cs, palette, frames })
    }
}

/// A frame ready to be written.
fn compress(indices: &[u8], delay: u16, width: u16, height: u16) -> Frame<'_> {
    assert_eq!(indices.len(), width as usize * height as usize, "indices in a frame");
    let dispose = DisposalMethod::Keep;
    let buffer = Cow::Borrowed(indices);
    let mut frame = Frame { delay, dispose, width, height, buffer, ..Frame::default() };
    frame.make_lzw_pre_encoded();
    frame
}

/// What a GIF says besides pictures: comments, plain text, names of applications other than the loop's, one a block, in
/// the order of the file. A damaged file is read as far as it goes.
pub fn gif_texts(bytes: &[u8]) -> Vec<String> {
    let mut texts = Vec::new();
    let colours = |packed: u8| if packed & 0x80 == 0 { 0 } else { 3 << ((packed & 7) + 1) };
    let mut walk = || -> Option<()> {
        let mut at = 13 + colours(*bytes.get(10)?);
        // A block is a row of sub-blocks, each with its length before it, up to an empty one.
        let block = |mut at: usize| -> Option<(Vec<u8>, usize)> {
            let mut content = Vec::new();
            loop {
                let length = usize::from(*bytes.get(at)?);
                content.extend(bytes.get(at + 1..at + 1 + length)?);
                at += 1 + length;
                if length == 0 {
                    return Some((content, at));
                }
            }
        };
        loop {
            match *bytes.get(at)? {
                0x21 => {
                    let label = *bytes.get(at + 1)?;
                    let (content, next) = block(at + 2)?;
                    at = next;
                    let timing = label == 0xf9;
                    let the_loop = label == 0xff && content.starts_with(b"NETSCAPE2.0");
                    if !timing && !the_loop {
                        texts.push(String::from_utf8_lossy(&content).into_owned());
                    }
                }
                0x2c => (_, at) = block(at + 11 + colours(*bytes.get(at + 9)?))?,
                _ => return None,
            }
        }
    };
    walk();
    texts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn our_files_say_nothing_and_comments_are_found() {
        let palette = Palette::new(vec![[0, 0, 0], [255, 255, 255]]);
        let frames = (0..3).map(|f| (0..1200).map(|i| u8::from(i % 7 == f)).collect()).collect();
        let animation = Animation { width: 40, height: 30, delay_cs: 6, palette, frames };
        let mut file = Vec::new();
        animation.write_gif(&mut file).unwrap();
        assert_eq!(gif_texts(&file), Vec::<String>::new());
        // A comment before the trailer.
        let end = file.len() - 1;
        assert_eq!(file[end], 0x3b);
        file.splice(end..end, *b"\x21\xfe\x05ss_bi\x00");
        assert_eq!(gif_texts(&file), ["ss_bi"]);
        assert_eq!(Animation::read_gif(file.as_slice()).unwrap(), animation, "a comment changes no picture");
        for cut in 0..file.len() {
            assert!(gif_texts(&file[..cut]).len() <= 1, "no panic on a damaged file");
        }
    }
}
