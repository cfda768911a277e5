//! Pairs as videos for the web, by an `ffmpeg` that the user has: no larger than the pairs, and as good as there is room for.

use anyhow::{Context, Result, bail};
use raster::Animation;
use serve::page::Kind;
use std::io::Write;
use std::process::{Command, Stdio};

/// Constant rate factors, best first. At the first nothing is to be seen; at the last facets begin to blur.
pub(crate) const QUALITIES: [u32; 7] = [16, 18, 20, 22, 24, 27, 30];

/// What every video has: colours converted as the tags say, which players would guess otherwise, and as exactly as 8 bits
/// hold; nothing of time, tool or name. One thread a video: the encoder's choices, and so the bytes, depend on how many it has.
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

/// The kind that the `ffmpeg` on the PATH can make: H.264, which every browser plays, else VP9; `None` without one.
pub(crate) fn kind() -> Option<Kind> {
    let asked =
        Command::new("ffmpeg").args(["-v", "error", "-encoders"]).stderr(Stdio::null()).output().ok()?;
    let known = String::from_utf8_lossy(&asked.stdout).into_owned();
    let has = |name: &str| known.split_whitespace().any(|word| word == name);
    match () {
        () if !asked.status.success() => None,
        () if has("libx264") => Some(Kind::Mp4),
        () if has("libvpx-vp9") => Some(Kind::WebM),
        () => None,
    }
}

/// One turn of a pair as video of its own size; of twice that where a side is odd, which the format does not hold.
///
/// # Errors
/// If ffmpeg fails, with what it said.
///
/// # Panics
/// If `kind` is none of video.
pub(crate) fn encoded(animation: &Animation, kind: Kind, quality: u32) -> Result<Vec<u8>> {
    let folder = tempfile::tempdir()?;
    // A file and not a pipe: the index is written when all else is known.
    let path = folder.path().join(format!("pair.{}", kind.ending()));
    let size = format!("{}x{}", animation.width, animation.height);
    let even = animation.width.is_multiple_of(2) && animation.height.is_multiple_of(2);
    let enlarged = if even { 1 } else { 2 };
    let filter = format!(
        "scale=iw*{enlarged}:ih*{enlarged}:flags=neighbor+accurate_rnd+full_chroma_int:out_color_matrix=bt709:out_range=tv"
    );
    let rate = format!("100/{}", animation.delay_cs);
    let quality = quality.to_string();
    let own: &[&str] = match kind {
        Kind::Mp4 => &["-c:v", "libx264", "-crf", &quality, "-movflags", "+faststart"],
        Kind::WebM => {
            &["-c:v", "libvpx-vp9", "-b:v", "0", "-crf", &quality, "-cpu-used", "3", "-row-mt", "0"]
        }
        Kind::Gif => panic!("an animation is no video"),
    };
    let mut ffmpeg = Command::new("ffmpeg")
        .args(["-v", "error", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", &size, "-r", &rate, "-i", "-"])
        .args(["-vf", &filter])
        .args(own)
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
