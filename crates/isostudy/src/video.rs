//! Pairs as videos, by an `ffmpeg` that the user has: as the paper's are, and for the web, no larger than the pairs.

use anyhow::{Context, Result, bail};
use isostudy_raster::Animation;
use isostudy_serve::page::MediaFormat;
use std::io::{ErrorKind, Write};
use std::process::{Command, Stdio};

/// Constant rate factors for the web, best first. At the first nothing is to be seen; at the last facets begin to blur.
pub(crate) const QUALITIES: [u32; 7] = [16, 18, 20, 22, 24, 27, 30];
/// The constant rate factor of the paper's pairs.
const AS_PUBLISHED: &str = "12";

/// What every video has: colours converted as the tags say, which players would guess otherwise; nothing of time, tool or name.
/// One thread a video: the encoder's choices, and so the bytes, depend on how many it has.
const ARGUMENTS: &[&str] = &[
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

/// The kind that the `ffmpeg` on the PATH can make: H.264, which every browser plays, else VP9; `None` without one.
pub(crate) fn kind() -> Option<MediaFormat> {
    let asked =
        Command::new("ffmpeg").args(["-v", "error", "-encoders"]).stderr(Stdio::null()).output().ok()?;
    let known = String::from_utf8_lossy(&asked.stdout).into_owned();
    let has = |name: &str| known.split_whitespace().any(|word| word == name);
    match () {
        () if !asked.status.success() => None,
        () if has("libx264") => Some(MediaFormat::Mp4),
        () if has("libvpx-vp9") => Some(MediaFormat::WebM),
        () => None,
    }
}

/// One turn of a pair that was enlarged `scale` times, as MP4 of twice the size of its turntables, as the paper's are; of the
/// pair's own where that is larger already and even, as the format wants it.
///
/// # Errors
/// If ffmpeg fails, with what it said.
pub(crate) fn mp4(animation: &Animation, scale: u32) -> Result<Vec<u8>> {
    let enlarged = if scale > 1 && is_even(animation) { 1 } else { 2 };
    video(animation, MediaFormat::Mp4, AS_PUBLISHED, &scaled(enlarged, "neighbor"))
}

/// One turn of a pair as video of its own size; of twice that where a side is odd, which the format does not hold. Colours are as exact as 8
/// bits hold.
///
/// # Errors
/// If ffmpeg fails, with what it said.
///
/// # Panics
/// If `kind` is none of video.
pub(crate) fn for_web(animation: &Animation, kind: MediaFormat, quality: u32) -> Result<Vec<u8>> {
    let enlarged = if is_even(animation) { 1 } else { 2 };
    let filter = scaled(enlarged, "neighbor+accurate_rnd+full_chroma_int");
    video(animation, kind, &quality.to_string(), &filter)
}

fn is_even(animation: &Animation) -> bool {
    animation.width.is_multiple_of(2) && animation.height.is_multiple_of(2)
}

fn scaled(times: u32, flags: &str) -> String {
    format!("scale=iw*{times}:ih*{times}:flags={flags}:out_color_matrix=bt709:out_range=tv")
}

fn video(animation: &Animation, kind: MediaFormat, quality: &str, filter: &str) -> Result<Vec<u8>> {
    let folder = tempfile::tempdir()?;
    // A file and not a pipe: the index is written when all else is known.
    let path = folder.path().join(format!("pair.{}", kind.ending()));
    let size = format!("{}x{}", animation.width, animation.height);
    let rate = format!("100/{}", animation.delay_cs);
    let codec: &[&str] = match kind {
        MediaFormat::Mp4 => &["-c:v", "libx264", "-crf", quality, "-movflags", "+faststart"],
        MediaFormat::WebM => {
            &["-c:v", "libvpx-vp9", "-b:v", "0", "-crf", quality, "-cpu-used", "3", "-row-mt", "0"]
        }
        MediaFormat::Gif => panic!("an animation is no video"),
    };
    let mut ffmpeg = Command::new("ffmpeg")
        .args(["-v", "error", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", &size, "-r", &rate, "-i", "-"])
        .args(["-vf", filter])
        .args(codec)
        .args(ARGUMENTS)
        .arg(&path)
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .context("ffmpeg cannot be started")?;
    let mut stdin = ffmpeg.stdin.take().expect("piped");
    let colours = animation.palette.colours();
    let mut sent = Ok(());
    for frame in &animation.frames {
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
