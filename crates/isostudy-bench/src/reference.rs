//! A fixed piece of work, timed before every sample: how fast the machine is at the moment.
//!
//! It is the same in every run and shares no code with what is measured. Two runs between which its time changed ran on
//! machines that were not equally fast, whatever the reason: clock, heat, a neighbour in the same cache.

use std::hint::black_box;
use std::num::NonZeroUsize;
use std::time::{Duration, Instant};

/// Words of the table: 256 KiB, more than a first-level cache.
const WORDS: usize = 1 << 16;
/// Steps taken; about a millisecond.
const STEPS: u32 = 100_000;

/// The work and its memory.
pub struct Reference {
    table: Vec<u32>,
    threads: usize,
}

impl Reference {
    /// The work on each of so many threads at once, 0 for every core: as many as are measured, so that what wakes threads late or
    /// keeps one of them waiting is seen here as well.
    pub fn on(threads: u32) -> Self {
        let cores = || std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
        let threads = if threads == 0 { cores() } else { threads as usize };
        Self { table: (0..WORDS as u32).map(|i| i.wrapping_mul(0x9e37_79b9)).collect(), threads }
    }

    /// Does the work once on each thread and says how long it took until all had done it.
    pub fn time(&mut self) -> Duration {
        let start = Instant::now();
        std::thread::scope(|scope| {
            for _ in 1..self.threads {
                scope.spawn(|| black_box(self.work(STEPS)));
            }
            black_box(self.work(STEPS));
        });
        start.elapsed()
    }

    /// A walk through the table at random places (xorshift, Marsaglia 2003), each step waiting for the one before.
    fn work(&self, steps: u32) -> u32 {
        let mut state = 2_463_534_242_u32;
        let mut sum = 0.0_f32;
        for _ in 0..steps {
            state ^= state << 13;
            state ^= state >> 17;
            state ^= state << 5;
            let word = self.table[state as usize % WORDS];
            sum = 0.5 * sum + (word >> 8) as f32;
            state = state.wrapping_add(word | 1);
        }
        state ^ sum.to_bits()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_work_is_always_the_same() {
        assert_eq!(Reference::on(1).work(1000), Reference::on(1).work(1000));
        assert_ne!(Reference::on(1).work(1000), Reference::on(1).work(1001));
    }
}
