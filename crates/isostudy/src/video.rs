//! Pairs as videos, by an `ffmpeg` that the user has: as the paper's are, and for the web, no larger than the pairs. And videos that
//! are there, as pictures.

use crate::input;
use anyhow::{Context, Result, anyhow, bail, ensure};
use isostudy_foreign::{Child, End, Folder, Limits, Stopped};
use isostudy_raster::{Animation, Film};
use isostudy_serve::page::MediaFormat;
use std::io::Write;
use std::path::Path;
use std::process::Command;
use std::thread;
use std::time::Duration;

/// How long it may take to say what it is and can.
const TO_ANSWER: Duration = Duration::from_secs(30);
/// How long one video may take; a pair of the paper's takes seconds.
const TO_ENCODE: Duration = Duration::from_secs(3600);
/// How much it may say of what it can.
const LIST_BYTES: usize = 1 << 20;
/// How many frames a video of a study's own may have.
const MOST_FRAMES: usize = 3600;
/// The code of what cannot be started, as shells have it.
const NOT_STARTED: i32 = 127;

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

fn ffmpeg(arguments: &[&str]) -> std::io::Result<Child> {
    let limits = Limits { line_bytes: 1 << 16, memory_bytes: None };
    Child::start(Command::new("ffmpeg").args(arguments), limits, None)
}

/// Whether there is an `ffmpeg`, before any work is done.
///
/// # Errors
/// If there is none, saying what to do.
pub(crate) fn check() -> Result<()> {
    let mut version = ffmpeg(&["-version"]).context("--mp4: ffmpeg cannot be started")?;
    match version.wait(TO_ANSWER) {
        Ok(End::Code(0)) => Ok(()),
        Ok(End::Code(NOT_STARTED)) => {
            bail!("--mp4: no ffmpeg on the PATH; install it, or leave out --mp4: the GIFs need none")
        }
        Ok(end) => bail!("--mp4: `ffmpeg -version` {end}"),
        Err(_) => bail!("--mp4: `ffmpeg -version` does not end within {} s", TO_ANSWER.as_secs()),
    }
}

/// The kind that the `ffmpeg` on the PATH can make: H.264, which every browser plays, else VP9; `None` without one.
pub(crate) fn kind() -> Option<MediaFormat> {
    let mut asked = ffmpeg(&["-v", "error", "-encoders"]).ok()?;
    asked.close_input();
    let (mut known, mut size) = (Vec::new(), 0);
    let end = loop {
        match asked.listen(TO_ANSWER) {
            Ok((line, _)) if size < LIST_BYTES => {
                size += line.len();
                let line = String::from_utf8_lossy(&line);
                known.extend(line.split_whitespace().map(str::to_owned));
            }
            Err(Stopped::Ended(end, _)) => break end,
            _ => return None,
        }
    };
    let has = |name: &str| known.iter().any(|word| word == name);
    match () {
        () if end != End::Code(0) => None,
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
    let pixels = colours(animation);
    video(&moving(animation, &pixels), MediaFormat::Mp4, AS_PUBLISHED, &scaled(enlarged, "neighbor"))
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
    let pixels = colours(animation);
    video(&moving(animation, &pixels), kind, &quality.to_string(), &filter)
}

/// A film of a study's own as video of its own size; of twice that where a side is odd. It takes `duration_s`.
///
/// # Errors
/// If ffmpeg fails, with what it said.
///
/// # Panics
/// If `kind` is none of video.
pub(crate) fn of_film(film: &Film, duration_s: f64, kind: MediaFormat, quality: u32) -> Result<Vec<u8>> {
    let enlarged = if film.width.is_multiple_of(2) && film.height.is_multiple_of(2) { 1 } else { 2 };
    let moving = Moving {
        size: [film.width, film.height],
        rate: format!("{}/{}", 1000 * film.frames.len(), (1000.0 * duration_s).round()),
        frames: film.frames.len(),
        pixels: &|frame| film.frames[frame].clone(),
    };
    video(&moving, kind, &quality.to_string(), &scaled(enlarged, "neighbor+accurate_rnd+full_chroma_int"))
}

/// The frames of a video and how long it takes, by the ffmpeg and the ffprobe on the PATH. Sound is left out.
///
/// # Errors
/// If there is no ffmpeg, or it cannot read the file; if it has more than [`MOST_FRAMES`].
pub(crate) fn read(path: &Path) -> Result<Film> {
    let folder = Folder::new().context("cannot make a temporary folder")?;
    let (from, to) =
        (format!("file:{}", path.display()), folder.path().join("%06d.ppm").display().to_string());
    let most = (MOST_FRAMES + 1).to_string();
    let mut unpacking = ffmpeg(&["-v", "error", "-nostdin", "-i", &from, "-an", "-frames:v", &most, &to])
        .context("ffmpeg cannot be started")?;
    match unpacking.wait(TO_ENCODE) {
        Ok(End::Code(0)) => {}
        Ok(End::Code(NOT_STARTED)) => bail!("no ffmpeg on the PATH: it reads videos; a GIF needs none"),
        Ok(end) => bail!("ffmpeg {end}: {}", unpacking.last_words()),
        Err(_) => bail!("ffmpeg does not end within {} s", TO_ENCODE.as_secs()),
    }
    let (mut frames, mut size) = (Vec::new(), [0, 0]);
    for file in input::files_of(folder.path(), "ppm")? {
        let pixels;
        (size, pixels) = pixels_of(&input::bytes(&file)?)?;
        frames.push(pixels);
    }
    if frames.is_empty() || frames.len() > MOST_FRAMES {
        bail!("has {} frames: 1 to {MOST_FRAMES} are read", frames.len());
    }
    let [width, height] = size;
    Ok(Film { width, height, duration_s: Some(seconds(&from)?), frames })
}

/// Size and pixels of a binary PPM as ffmpeg writes it.
fn pixels_of(file: &[u8]) -> Result<([u32; 2], Vec<u8>)> {
    let mut at = 0;
    let mut word = || -> Option<&str> {
        let from = at + file.get(at..)?.iter().position(|byte| !byte.is_ascii_whitespace())?;
        let length = file[from..].iter().position(u8::is_ascii_whitespace)?;
        at = from + length;
        str::from_utf8(&file[from..at]).ok()
    };
    let head = [word(), word(), word(), word()];
    let [Some("P6"), Some(width), Some(height), Some("255")] = head else {
        bail!("ffmpeg wrote no PPM of 8 bits")
    };
    let size = [width.parse()?, height.parse()?];
    let pixels = file.get(at + 1..).unwrap_or_default();
    ensure!(
        pixels.len() as u64 == 3 * u64::from(size[0]) * u64::from(size[1]),
        "ffmpeg wrote half a picture"
    );
    Ok((size, pixels.to_vec()))
}

/// How long a video takes.
fn seconds(from: &str) -> Result<f64> {
    let words = ["-v", "error", "-show_entries", "format=duration", "-of", "csv=p=0", from];
    let limits = Limits { line_bytes: 1 << 16, memory_bytes: None };
    let mut asked = Child::start(Command::new("ffprobe").args(words), limits, None)
        .context("ffprobe cannot be started")?;
    asked.close_input();
    let (line, _) = asked.listen(TO_ANSWER).map_err(|_| anyhow!("ffprobe does not say how long it takes"))?;
    let said = String::from_utf8_lossy(&line);
    said.trim().parse().with_context(|| format!("ffprobe says it takes {:?}", said.trim()))
}

fn is_even(animation: &Animation) -> bool {
    animation.width.is_multiple_of(2) && animation.height.is_multiple_of(2)
}

/// What an animation is to ffmpeg.
fn moving<'a>(animation: &Animation, pixels: &'a (dyn Fn(usize) -> Vec<u8> + Sync)) -> Moving<'a> {
    Moving {
        size: [animation.width, animation.height],
        rate: format!("100/{}", animation.delay_cs),
        frames: animation.frames.len(),
        pixels,
    }
}

/// Red, green and blue of a frame.
fn colours(animation: &Animation) -> impl Fn(usize) -> Vec<u8> + Sync {
    let colours = animation.palette.colours();
    move |frame| animation.frames[frame].iter().flat_map(|&index| colours[usize::from(index)]).collect()
}

/// Pictures that ffmpeg makes a video of.
struct Moving<'a> {
    size: [u32; 2],
    /// Frames a second, as ffmpeg takes it.
    rate: String,
    frames: usize,
    /// Red, green and blue of a frame.
    pixels: &'a (dyn Fn(usize) -> Vec<u8> + Sync),
}

fn scaled(times: u32, flags: &str) -> String {
    format!("scale=iw*{times}:ih*{times}:flags={flags}:out_color_matrix=bt709:out_range=tv")
}

fn video(moving: &Moving<'_>, kind: MediaFormat, quality: &str, filter: &str) -> Result<Vec<u8>> {
    let folder = Folder::new().context("cannot make a temporary folder")?;
    // A file and not a pipe: the index is written when all else is known.
    let path = folder.path().join(format!("pair.{}", kind.ending()));
    let size = format!("{}x{}", moving.size[0], moving.size[1]);
    let codec: &[&str] = match kind {
        MediaFormat::Mp4 => &["-c:v", "libx264", "-crf", quality, "-movflags", "+faststart"],
        MediaFormat::WebM => {
            &["-c:v", "libvpx-vp9", "-b:v", "0", "-crf", quality, "-cpu-used", "3", "-row-mt", "0"]
        }
        MediaFormat::Gif | MediaFormat::Png | MediaFormat::Model => panic!("no video"),
    };
    let path_word = path.display().to_string();
    let input =
        ["-v", "error", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", &size, "-r", &moving.rate, "-i", "-"];
    let words = [&input[..], &["-vf", filter], codec, ARGUMENTS, &[&path_word]].concat();
    let mut ffmpeg = ffmpeg(&words).context("ffmpeg cannot be started")?;
    let mut stdin = ffmpeg.take_input().context("ffmpeg has no input")?;
    // By a thread, which ends when ffmpeg does: one that reads nothing would be waited for.
    let (sent, ended) = thread::scope(|scope| {
        let sending = scope
            .spawn(move || (0..moving.frames).try_for_each(|frame| stdin.write_all(&(moving.pixels)(frame))));
        let ended = ffmpeg.wait(TO_ENCODE);
        ffmpeg.kill();
        (sending.join(), ended)
    });
    match ended {
        Ok(End::Code(0)) => {}
        Ok(end) => bail!("ffmpeg {end}: {}", ffmpeg.last_words()),
        Err(_) => bail!("ffmpeg does not end within {} s", TO_ENCODE.as_secs()),
    }
    sent.expect("nothing panics there").context("ffmpeg did not take all frames")?;
    input::bytes(&path)
}
