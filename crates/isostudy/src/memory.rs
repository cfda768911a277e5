//! How much memory a surface may take: `--memory`, or what the machine has.

use anyhow::{Error, Result};
use isostudy_volume::{Problem, VolumeError};

/// What `--memory` is where it is not given.
pub(crate) const DEFAULT: &str = "4GiB";

const UNITS: [(&str, u64); 8] = [
    ("kb", 1000),
    ("mb", 1_000_000),
    ("gb", 1_000_000_000),
    ("tb", 1_000_000_000_000),
    ("kib", 1 << 10),
    ("mib", 1 << 20),
    ("gib", 1 << 30),
    ("tib", 1 << 40),
];

/// A limit, and who sets it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Limit {
    pub(crate) bytes: u64,
    /// As in "... allows 1.0 GiB".
    pub(crate) name: &'static str,
}

impl Limit {
    /// What was asked for, or what the machine has if that is less.
    pub(crate) fn of(asked: u64) -> Self {
        match isostudy_bench::read_machine().memory_bytes {
            Some(machine) if machine < asked => Self { bytes: machine, name: "this machine has" },
            _ => Self { bytes: asked, name: "--memory allows" },
        }
    }

    /// A volume.
    ///
    /// # Errors
    /// As [`isostudy_volume::read`]; if it is for want of memory, with what sets the limit.
    pub(crate) fn read(self, path: &std::path::Path) -> Result<isostudy_volume::Volume> {
        isostudy_volume::read(path, self.bytes).map_err(|error: VolumeError| match *error.problem {
            Problem::TooManySamples { .. } => Error::msg(format!("{error}: {} no more", self.name)),
            _ => error.into(),
        })
    }
}

/// Bytes, from `4GiB`, `500 MB` or a number of bytes.
pub(crate) fn size(text: &str) -> Result<u64, String> {
    let lower = text.trim().to_ascii_lowercase();
    let number_ends = lower.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(lower.len());
    let (number, unit) = lower.split_at(number_ends);
    let factor = match unit {
        "" | "b" => Some(1),
        _ => UNITS.iter().find(|(name, _)| *name == unit).map(|&(_, factor)| factor),
    };
    let bytes = number.trim().parse::<f64>().ok().zip(factor).map(|(number, factor)| number * factor as f64);
    match bytes {
        Some(bytes) if (1.0..u64::MAX as f64).contains(&bytes) => Ok(bytes as u64),
        _ => Err(format!("`{text}` is not an amount of memory such as 4GiB, 500MB or 4096")),
    }
}

#[cfg(test)]
mod tests {
    use super::size;

    #[test]
    fn sizes_have_the_usual_units() {
        for (text, bytes) in [
            ("1", 1),
            ("4096", 4096),
            ("500MB", 500_000_000),
            ("1.5 kB", 1500),
            ("4GiB", 4 << 30),
            (" 2 gib ", 2 << 30),
            ("0.5TiB", 1 << 39),
            ("7b", 7),
        ] {
            assert_eq!(size(text), Ok(bytes), "{text}");
        }
        for text in ["", "lots", "GiB", "-1GiB", "0", "4 GiBs", "1e30", "nan", "inf", "4G iB", "0.2"] {
            assert!(size(text).is_err_and(|said| said.contains("such as 4GiB")), "{text}");
        }
    }
}
