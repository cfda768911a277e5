//! How much memory a surface may take: `--memory`, or what the machine has; and what is known of it before a sample is read.

use crate::ALLOCATOR;
use crate::seeds;
use anyhow::{Context, Result, anyhow, bail};
use isostudy_extract::{BoxGrid, Execution, ExtractError, LabelError, Method, MethodError, VolumeCellsError};
use isostudy_field::VolumeFieldError;
use isostudy_volume::{Unread, Volume};
use std::error::Error;
use std::sync::atomic::{AtomicUsize, Ordering};

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

    /// What there is in one study.
    pub(crate) fn of_study(study: &isostudy_design::Study, machine_bytes: Option<u64>) -> Self {
        let allowed = (study.file.limits.memory_gib * (1u64 << 30) as f64) as u64;
        match machine_bytes {
            Some(machine) if machine < allowed => Self { bytes: machine, name: "this machine has" },
            _ => Self { bytes: allowed, name: "limits.memory_gib allows" },
        }
    }

    /// The samples of a volume.
    ///
    /// # Errors
    /// If they and what is made of them are more than the limit, before a sample is read; as [`isostudy_volume::read`].
    pub(crate) fn read(self, unread: Unread, needed: OfVolume) -> Result<Volume> {
        self.check(&Needs::of(Some(needed))).with_context(|| unread.path().display().to_string())?;
        Ok(unread.read(self.bytes)?)
    }

    /// Runs what makes a mesh, within the limit: every byte is counted when it is asked for, those of the samples, of the layers, of
    /// the mesh while it grows and of what finishing makes, on all threads. `before` is what was held before there was any of it.
    ///
    /// Before each layer the extractor looks whether there is more. What grows within a layer or after them all asks for its memory by
    /// `try_reserve`, and gets none beyond the limit and [`MARGIN`]. So only what is small and cannot be refused, such as a table or a
    /// thread, lies in the margin. Nothing else must run within: a large request that cannot be refused ends the process.
    ///
    /// # Errors
    /// Those of `run`; where memory was short, with the number, the limit and who sets it.
    pub(crate) fn hold<T>(self, before: Held, run: impl FnOnce() -> Result<T>) -> Result<T> {
        let held = Held::now().0.saturating_sub(before.0) as u64;
        let limit = usize::try_from(self.bytes).unwrap_or(usize::MAX).saturating_add(before.0);
        let allowed = amount(self.bytes, f64::floor);
        if ALLOCATOR.set_limit(limit.saturating_add(MARGIN)).is_err() {
            bail!(
                "{} of memory are held before there is a mesh; {} {allowed}",
                amount(held, f64::ceil),
                self.name
            );
        }
        isostudy_extract::watch_memory(|| ALLOCATOR.allocated() > LIMIT.load(Ordering::Relaxed));
        LIMIT.store(limit, Ordering::Relaxed);
        let result = run();
        LIMIT.store(usize::MAX, Ordering::Relaxed);
        ALLOCATOR.set_limit(usize::MAX).expect("more than is held");
        result.map_err(|error| {
            if !error.chain().any(is_for_want_of_memory) {
                return error;
            }
            let (held, left) = (amount(held, f64::ceil), amount(self.bytes.saturating_sub(held), f64::floor));
            anyhow!(
                "the mesh and the grid's layers need more than the {left} that are left beside {held}; {} {allowed}",
                self.name
            )
        })
    }

    /// Checks that a method goes with a grid, and that what the extractor holds of it, beside a volume, is not more.
    ///
    /// # Errors
    /// If it is, as [`check`](Self::check).
    pub(crate) fn check_method(
        self,
        method: &Method,
        grid: &BoxGrid,
        execution: &Execution,
        volume: Option<OfVolume>,
    ) -> Result<()> {
        seeds::check(method, &grid.bounds)?;
        method.check(grid)?;
        self.check(&Needs::of(volume).with(method, grid, execution)?)
    }

    /// Refuses what needs more.
    ///
    /// # Errors
    /// If it does, with what needs it, and who sets the limit.
    pub(crate) fn check(self, needs: &Needs) -> Result<()> {
        if self.admits(needs) { Ok(()) } else { bail!(self.refusal(needs)) }
    }

    /// Whether there is enough.
    pub(crate) fn admits(self, needs: &Needs) -> bool {
        needs.total() <= self.bytes
    }

    /// What is said where there is not.
    pub(crate) fn refusal(self, needs: &Needs) -> String {
        let total = amount(needs.total(), f64::ceil);
        match needs {
            Needs { volume: None, grid: Some((what, _)) } => {
                format!("{what} needs {total} of memory; {}", self.allowed())
            }
            _ => format!("{total} of memory are needed: {}; {}", needs.parts(), self.allowed()),
        }
    }

    /// `--memory allows 1.0 GiB`.
    pub(crate) fn allowed(self) -> String {
        format!("{} {}", self.name, amount(self.bytes, f64::floor))
    }
}

/// Room for what cannot be refused.
const MARGIN: usize = 24 << 20;

/// Beyond this extractions end.
static LIMIT: AtomicUsize = AtomicUsize::new(usize::MAX);

/// How many bytes the process had asked for at some time.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Held(usize);

impl Held {
    pub(crate) fn now() -> Self {
        Self(ALLOCATOR.allocated())
    }
}

/// Whether an extraction has failed for want of memory.
fn is_for_want_of_memory(error: &(dyn Error + 'static)) -> bool {
    let of_mesh = |error: &ExtractError| {
        matches!(error, ExtractError::NoMemoryForMesh | ExtractError::OutOfMemory { .. })
    };
    let of_method = |error: &MethodError| matches!(error, MethodError::Extract(error) if of_mesh(error));
    let of_labels = |error: &LabelError| matches!(error, LabelError::Extract(error) if of_mesh(error));
    let of_cells =
        |error: &VolumeCellsError| matches!(error, VolumeCellsError::Extract(error) if of_method(error));
    error.downcast_ref().is_some_and(of_mesh)
        || error.downcast_ref().is_some_and(of_method)
        || error.downcast_ref().is_some_and(of_cells)
        || error.downcast_ref().is_some_and(of_labels)
        || matches!(error.downcast_ref(), Some(VolumeFieldError::OutOfMemory))
}

/// What will be held at once before there is a mesh, as far as headers and grids tell.
#[derive(Debug, Clone, Default)]
pub(crate) struct Needs {
    volume: Option<OfVolume>,
    /// What is laid over it, and its layers that are in sight.
    grid: Option<(String, u64)>,
}

/// A volume's share.
#[derive(Debug, Clone, Copy)]
pub(crate) struct OfVolume {
    counts: [usize; 3],
    /// The samples, four bytes each.
    samples: u64,
    /// Whether these are bricks of a volume that stays in its file.
    in_bricks: bool,
    /// What is made of them and kept beside them.
    beside: (&'static str, u64),
}

impl OfVolume {
    /// Samples alone.
    pub(crate) fn samples(unread: &Unread) -> Self {
        let samples = unread.memory_bytes();
        Self { counts: unread.frame().counts, samples, in_bricks: false, beside: ("", 0) }
    }

    /// So many bytes of samples of a volume that stays in its file: none, where the layers of the grid are all that is held of it.
    pub(crate) fn in_file(unread: &Unread, bytes: u64) -> Self {
        Self { samples: bytes, in_bricks: true, ..Self::samples(unread) }
    }

    /// With what is made of them and kept beside them.
    pub(crate) fn with(self, what: &'static str, bytes: u64) -> Self {
        Self { beside: (what, bytes), ..self }
    }

    /// All bytes.
    pub(crate) fn total(&self) -> u64 {
        self.samples.saturating_add(self.beside.1)
    }
}

impl Needs {
    /// Those of a volume, if there is one.
    pub(crate) fn of(volume: Option<OfVolume>) -> Self {
        Self { volume, grid: None }
    }

    /// With a method's layers of a grid.
    ///
    /// # Errors
    /// If the grid is none for the method.
    pub(crate) fn with(self, method: &Method, grid: &BoxGrid, execution: &Execution) -> Result<Self> {
        let what = match method {
            Method::Tetrahedra(of) => format!("the {} lattice", of.arrangement),
            _ => "the grid".into(),
        };
        Ok(Self { grid: Some((what, method.memory_bytes(grid, execution)?)), ..self })
    }

    pub(crate) fn total(&self) -> u64 {
        let grid = self.grid.as_ref().map_or(0, |(_, bytes)| *bytes);
        self.volume.as_ref().map_or(0, OfVolume::total).saturating_add(grid)
    }

    fn parts(&self) -> String {
        let up = |bytes| amount(bytes, f64::ceil);
        let mut parts = Vec::new();
        if let Some(OfVolume { counts: [x, y, z], samples, in_bricks, beside: (what, bytes) }) = self.volume {
            let bricks = if in_bricks { "bricks of " } else { "" };
            let of_samples = format!("{} for {bricks}{x} x {y} x {z} samples, four bytes each", up(samples));
            parts.extend((samples > 0).then_some(of_samples));
            parts.extend((bytes > 0).then(|| format!("{} for {what}", up(bytes))));
        }
        parts.extend(self.grid.as_ref().map(|(what, bytes)| format!("{} for {what}", up(*bytes))));
        parts.join(", ")
    }
}

/// `1.0 GiB`. What is needed is rounded up and what there is down, lest they look the same.
pub(crate) fn amount(bytes: u64, rounded: fn(f64) -> f64) -> String {
    let units = [(1 << 40, "TiB"), (1 << 30, "GiB"), (1 << 20, "MiB"), (1 << 10, "KiB")];
    let Some((unit, name)) = units.into_iter().find(|(unit, _)| bytes >= *unit) else {
        return format!("{bytes} bytes");
    };
    format!("{:.1} {name}", rounded(bytes as f64 / unit as f64 * 10.0) / 10.0)
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
