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
