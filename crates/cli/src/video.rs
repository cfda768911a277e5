//! Pairs as H.264 video, by an `ffmpeg` that the user has.

use anyhow::{Context, Result, bail};
use raster::Animation;
use std::io::{ErrorKind, Write};
use std::process::{Command, Stdio};

/// The paper's pairs: constant rate factor 12. Colours are converted as the tags say, which players would guess otherwise.
/// Nothing is written of time, tool or name. One thread a video: the encoder's choices, and so the bytes, depend on how many it has.
const ARGUMENTS: &[&str] = &[
    "-c:v",
    "libx264",
    "-crf",
    "12",
    "-threads",
    "1",
    "-pix_fmt",
    "yuv420p",
    "-colorspace",
    "bt709",
    "-color_primaries",
    "bt709",
    "-color_trc",
    "bt709",
    "-color_range",
    "tv",
    "-map_metadata",
    "-1",
    "-fflags",
    "+bitexact",
    "-flags:v",
    "+bitexact",
    "-movflags",
    "+faststart",
];

/// Whether there is an `ffmpeg`, before any work is done.
///
/// # Errors
/// If there is none, saying what to do.
pub(crate) fn check() -> Result<()> {
    let found = Command::new("ffmpeg").arg("-version").stdout(Stdio::null()).stderr(Stdio::null()).status();
    match found {
        Ok(status) if status.success() => Ok(()),
        Err(error) if error.kind() == ErrorKind::NotFound => {
            bail!("--mp4: no ffmpeg on the PATH; install it, or leave out --mp4: the GIFs need none")
        }
        Ok(status) => bail!("--mp4: `ffmpeg -version` ended with {status}"),
        Err(error) => Err(error).context("--mp4: ffmpeg cannot be started"),
    }
}

/// One turn of a pair that was enlarged `scale` times, as MP4 of twice the size of its turntables, as the paper's are; of the
/// pair's own where that is larger already and even, as the format wants it.
///
/// # Errors
/// If ffmpeg fails, with what it said.
pub(crate) fn mp4(animation: &Animation, scale: u32) -> Result<Vec<u8>> {
    let folder = tempfile::tempdir()?;
    // A file and not a pipe: the index of an MP4 is written when all else is known.
    let path = folder.path().join("pair.mp4");
    let size = format!("{}x{}", animation.width, animation.height);
    let even = animation.width.is_multiple_of(2) && animation.height.is_multiple_of(2);
    let enlarged = if scale > 1 && even { 1 } else { 2 };
    let filter =
        format!("scale=iw*{enlarged}:ih*{enlarged}:flags=neighbor:out_color_matrix=bt709:out_range=tv");
    let rate = format!("100/{}", animation.delay_cs);
    let mut ffmpeg = Command::new("ffmpeg")
        .args(["-v", "error", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", &size, "-r", &rate, "-i", "-"])
        .args(["-vf", &filter])
        .args(ARGUMENTS)
        .arg(&path)
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .context("ffmpeg cannot be started")?;
    let mut stdin = ffmpeg.stdin.take().expect("piped");
    let mut sent = Ok(());
    for frame in &animation.frames {
        let colours = animation.palette.colours();
        let pixels: Vec<u8> = frame.iter().flat_map(|&index| colours[usize::from(index)]).collect();
        sent = sent.and_then(|()| stdin.write_all(&pixels));
    }
    drop(stdin);
    let output = ffmpeg.wait_with_output()?;
    if !output.status.success() {
        bail!("ffmpeg ended with {}: {}", output.status, String::from_utf8_lossy(&output.stderr).trim());
    }
    sent.context("ffmpeg did not take all frames")?;
    Ok(std::fs::read(&path)?)
}
