//! Pairs as H.264 video, by an `ffmpeg` that the user has.

use anyhow::{Context, Result, bail};
use raster::Animation;
use std::io::{ErrorKind, Write};
use std::process::{Command, Stdio};

/// The paper's pairs: twice the size, nearest neighbour, constant rate factor 12. Nothing is written of time, tool or
/// name.
const ARGUMENTS: &[&str] = &[
    "-vf",
    "scale=iw*2:ih*2:flags=neighbor",
    "-c:v",
    "libx264",
    "-crf",
    "12",
    "-pix_fmt",
    "yuv420p",
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

/// One turn of the animation as MP4.
///
/// # Errors
/// If ffmpeg fails, with what it said.
pub(crate) fn mp4(animation: &Animation) -> Result<Vec<u8>> {
    let folder = tempfile::tempdir()?;
    // A file and not a pipe: the index of an MP4 is written when all else is known.
    let path = folder.path().join("pair.mp4");
    let size = format!("{}x{}", animation.width, animation.height);
    let rate = format!("100/{}", animation.delay_cs);
    let mut ffmpeg = Command::new("ffmpeg")
        .args(["-v", "error", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", &size, "-r", &rate, "-i", "-"])
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
