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
