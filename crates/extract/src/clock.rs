//! The clock that stages are timed with. Where the platform has none, all times are zero.

use std::ops::Sub;
use std::time::Duration;
#[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
use std::time::Instant;

/// When something happened.
///
/// `std::time::Instant` compiles for `wasm32-unknown-unknown` and panics there when it is asked for the time.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Moment {
    #[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
    at: Instant,
}

impl Moment {
    pub(crate) fn now() -> Self {
        Self {
            #[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
            at: Instant::now(),
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
        self.at - earlier.at
    }

    #[cfg(all(target_family = "wasm", target_os = "unknown"))]
    fn sub(self, _: Self) -> Duration {
        Duration::ZERO
    }
}
