//! Volumes whose samples do not fit into memory: they stay in their file, and parts of them are read.

use crate::memory::{Limit, Needs, OfVolume, amount};
use crate::seeds;
use crate::terminal::tell_once;
use anyhow::{Result, anyhow, bail};
use isostudy_extract::{BoxGrid, Execution, Method, Positions};
use isostudy_field::{StoredSamples, UnreadSamples};
use isostudy_volume::{Stored, Unread};
use std::num::NonZeroUsize;
use std::sync::OnceLock;

/// Which parts of a volume are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Parts {
    /// Layers, one after the other: by what takes the samples themselves.
    Layers,
    /// Bricks, some of which are kept: by what interpolates between samples.
    Bricks,
}

/// A volume that is to stay in its file.
#[derive(Debug)]
pub(crate) struct InFile {
    pub(crate) held: OfVolume,
    /// On no more threads than there is memory for.
    pub(crate) execution: Execution,
    /// What is said once the file is open.
    said: String,
}

/// The share of what there is that a field may take of a volume in a file: bricks of its samples, and their ranges.
const SHARE_OF_FIELD: u64 = 3;

/// How many bytes that is.
pub(crate) fn field_bytes(limit: Limit) -> u64 {
    limit.bytes / SHARE_OF_FIELD
}

/// Whether a volume has to stay in its file for a method's mesh, since not all of its samples fit. `whole` is what they take
/// with what is kept beside them, and `in_file` what is kept of such parts.
///
/// # Errors
/// If the method does not go with the grid, or the parts do not fit either; if the file has no parts that can be read.
pub(crate) fn stays_in_file(
    limit: Limit,
    unread: &Unread,
    (whole, in_file): (OfVolume, OfVolume),
    parts: Parts,
    (method, grid, execution): (&Method, &BoxGrid, &Execution),
) -> Result<Option<InFile>> {
    seeds::check(method, &grid.bounds)?;
    method.check(grid)?;
    let needs = |held, execution: &Execution| Needs::of(Some(held)).with(method, grid, execution);
    let of_whole = needs(whole, execution)?;
    if limit.admits(&of_whole) {
        return Ok(None);
    }
    if !unread.is_raw() {
        bail!(
            "{}. If the file is raw, and not compressed, only parts of it are in memory: write it so",
            limit.refusal(&of_whole)
        );
    }
    let asked = threads(execution);
    // Each thread has layers of its own. The mesh needs memory too.
    let fits =
        |threads| -> Result<bool> { Ok(needs(in_file, &Execution { threads })?.total() <= limit.bytes / 2) };
    let mut threads = asked;
    while threads > 1 && !fits(threads)? {
        threads -= 1;
    }
    let execution = Execution { threads };
    let of_parts = needs(in_file, &execution)?;
    if !limit.admits(&of_parts) {
        let advice = if streams(method) { "" } else { KEEPS_ALL };
        bail!("{}{advice}", limit.refusal(&of_parts));
    }
    let on = if threads < asked { format!(", on {threads} of {asked} threads") } else { String::new() };
    let what = match parts {
        Parts::Layers => "layers",
        Parts::Bricks => "bricks",
    };
    let said = format!(
        "{}: with all samples in memory, {} are needed, and {}: {what} of them are read from the file{on}",
        unread.path().display(),
        amount(of_whole.total(), f64::ceil),
        limit.allowed(),
    );
    Ok(Some(InFile { held: in_file, execution, said }))
}

/// What is said of a method that has all of the lattice in memory.
const KEEPS_ALL: &str = ". This method keeps all points of its lattice. Of a volume that is larger than memory take one that \
                         keeps a few layers, such as mc, mc33, nets, nets-manifold, snapmc, bi or si";

/// Whether a method keeps a few layers of its lattice.
fn streams(method: &Method) -> bool {
    !matches!(method, Method::Tetrahedra(of) if of.positions != Positions::Indexed)
}

/// How many threads are asked for.
fn threads(execution: &Execution) -> usize {
    match execution.threads {
        0 => std::thread::available_parallelism().map_or(1, NonZeroUsize::get),
        threads => threads,
    }
}

/// The samples of a file. After the first error no part is read: parts before and after it would not belong together.
#[derive(Debug)]
pub(crate) struct FileSamples {
    stored: Stored,
    /// What is wrong, with file and place.
    fault: OnceLock<String>,
}

impl FileSamples {
    /// Opens the file, and says so.
    ///
    /// # Errors
    /// If it is not there, or not as long as its header says.
    pub(crate) fn open(unread: Unread, of: &InFile) -> Result<Self> {
        let stored = unread.stored()?;
        tell_once(&of.said);
        Ok(Self { stored, fault: OnceLock::new() })
    }

    /// What is made of the samples, if all of them could be read.
    ///
    /// # Errors
    /// If the file was changed or could not be read, whatever came of it; else those of `made`.
    pub(crate) fn vouch<T>(&self, made: Result<T>) -> Result<T> {
        match self.fault.get() {
            Some(fault) => Err(anyhow!(fault.clone())),
            None => made,
        }
    }
}

impl StoredSamples for FileSamples {
    fn counts(&self) -> [usize; 3] {
        self.stored.frame().counts
    }

    fn read_box(&self, first: [usize; 3], size: [usize; 3], values: &mut [f32]) -> Result<(), UnreadSamples> {
        let fault = match self.fault.get() {
            Some(fault) => fault,
            None => match self.stored.read_box(first, size, values) {
                Ok(()) => return Ok(()),
                Err(error) => self.fault.get_or_init(|| error.to_string()),
            },
        };
        Err(UnreadSamples(fault.clone()))
    }
}
