//! What an extraction asks of the allocator, stage by stage.
//!
//! The program's allocator counts what it is asked for. While an extraction is counted, the extractor's stages have that count for a
//! clock: once for calls and once for bytes. Nothing is timed meanwhile, and nothing is counted while anything is timed.

use isostudy_design::record::StageCounts;
use isostudy_extract::{Execution, Extraction, StageTimes};
use serde::{Deserialize, Serialize};
use std::hint::black_box;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU8, Ordering};
use std::time::Duration;

/// What an allocator was asked for since the process began.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Asked {
    /// How often, changes of size too.
    pub calls: u64,
    /// How many bytes, those that were given back too.
    pub bytes: u64,
}

/// What an extraction asked for, as in [`Allocations`](isostudy_design::record::Allocations).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "defined in `Allocations`")]
pub struct AllocationCounts {
    pub calls: StageCounts,
    pub bytes: StageCounts,
}

const NOTHING: u8 = 0;
const CALLS: u8 = 1;
const BYTES: u8 = 2;

static ALLOCATOR: OnceLock<fn() -> Asked> = OnceLock::new();
/// What the stages' clock shows.
static COUNTED: AtomicU8 = AtomicU8::new(NOTHING);

/// Says what tells how much the process's allocator was asked for. Only who has `main` knows; without it nothing is counted. The first
/// one stays.
pub fn count_allocations(asked: fn() -> Asked) {
    if ALLOCATOR.set(asked).is_ok() {
        isostudy_extract::set_stage_clock(clock);
    }
}

fn clock() -> Option<Duration> {
    let of: fn(Asked) -> u64 = match COUNTED.load(Ordering::Relaxed) {
        CALLS => |asked: Asked| asked.calls,
        BYTES => |asked: Asked| asked.bytes,
        _ => return None,
    };
    ALLOCATOR.get().map(|asked| Duration::from_nanos(of(asked())))
}

/// Extracts three times, counts in the second and the third, and says what was asked of the allocator; `None` where nobody counts. On
/// one thread, and alone in the process: counts are those of all its threads.
///
/// # Errors
/// Why it cannot be extracted.
pub(crate) fn allocations<E: std::fmt::Display>(
    extract: impl Fn(&Execution) -> Result<Extraction, E>,
) -> Result<Option<AllocationCounts>, String> {
    let Some(&asked) = ALLOCATOR.get() else { return Ok(None) };
    let run = |counted: u8| -> Result<StageTimes, String> {
        COUNTED.store(counted, Ordering::Relaxed);
        let extraction = extract(&Execution { threads: 1 });
        COUNTED.store(NOTHING, Ordering::Relaxed);
        extraction.map(|extraction| black_box(extraction).times).map_err(|error| error.to_string())
    };
    let count = |counted: u8, of: fn(Asked) -> u64| -> Result<StageCounts, String> {
        let before = of(asked());
        let times = run(counted)?;
        Ok(StageCounts { total: of(asked()) - before, ..by_stage(&times) })
    };
    // Tables that are made at first use are no extraction's own.
    run(NOTHING)?;
    let (calls, bytes) = (count(CALLS, |asked| asked.calls)?, count(BYTES, |asked| asked.bytes)?);
    Ok(Some(AllocationCounts { calls, bytes }))
}

fn by_stage(times: &StageTimes) -> StageCounts {
    let count = |time: Duration| u64::try_from(time.as_nanos()).unwrap_or(u64::MAX);
    let [allocation, sampling, vertex, geometry, clustering, normals] = crate::stages::six(times).map(count);
    StageCounts { allocation, sampling, vertex, geometry, clustering, normals, total: 0 }
}
