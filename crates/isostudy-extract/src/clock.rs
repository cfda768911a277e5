//! The clock that stages are timed with. Where the platform has none, all times are zero.

use std::ops::Sub;
#[cfg(feature = "stage-clock")]
use std::sync::OnceLock;
use std::time::Duration;
#[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
use std::time::Instant;

/// In the place of the system's.
#[cfg(feature = "stage-clock")]
static OTHER: OnceLock<fn() -> Option<Duration>> = OnceLock::new();

/// Gives the stages of all extractions of this process another clock: [`StageTimes`](crate::StageTimes) are then differences of what it
/// returns, and of the time where it returns `None`. For who counts something else than time, a unit of it for each nanosecond, on
/// one thread. Returns whether it was the first to be given, and so the one that is asked.
#[cfg(feature = "stage-clock")]
pub fn set_stage_clock(clock: fn() -> Option<Duration>) -> bool {
    OTHER.set(clock).is_ok()
}

/// When something happened.
///
/// `std::time::Instant` compiles for `wasm32-unknown-unknown` and panics there when it is asked for the time.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Moment {
    #[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
    at: Instant,
    #[cfg(feature = "stage-clock")]
    other: Option<Duration>,
}

impl Moment {
    pub(crate) fn now() -> Self {
        Self {
            #[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
            at: Instant::now(),
            #[cfg(feature = "stage-clock")]
            other: OTHER.get().and_then(|other| other()),
        }
    }

    /// The time since then.
    pub(crate) fn elapsed(self) -> Duration {
        Self::now() - self
    }
}

/// Stages that follow each other without a gap.
pub(crate) struct Laps {
    last: Moment,
}

impl Laps {
    /// The first begins now.
    pub(crate) fn new() -> Self {
        Self { last: Moment::now() }
    }

    /// Ends a stage and begins the next: how long it took.
    pub(crate) fn lap(&mut self) -> Duration {
        let now = Moment::now();
        now - std::mem::replace(&mut self.last, now)
    }
}

impl Sub for Moment {
    type Output = Duration;

    #[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
    fn sub(self, earlier: Self) -> Duration {
        #[cfg(feature = "stage-clock")]
        if let (Some(now), Some(earlier)) = (self.other, earlier.other) {
            return now.saturating_sub(earlier);
        }
        self.at - earlier.at
    }

    #[cfg(all(target_family = "wasm", target_os = "unknown"))]
    fn sub(self, _: Self) -> Duration {
        Duration::ZERO
    }
}
