//! Counters of the CPU, where the kernel lets a process count its own: instructions, cache misses, wrong predictions.
//!
//! Each is opened once, by the thread that extracts, counts on in the threads that it starts, and is read before and after an
//! extraction. A machine without them (a virtual one, mostly) and a kernel that forbids it (`perf_event_paranoid`) count nothing.

/// What was counted until now; `None` where it is not.
pub(crate) type Counts = [Option<u64>; 3];

/// Instructions, references that the last cache did not have, branches that were predicted wrongly; outside the kernel.
pub(crate) fn counts() -> Counts {
    imp::counts()
}

#[cfg(target_os = "linux")]
mod imp {
    use super::Counts;
    use perf_event::events::{Event, Hardware};
    use perf_event::{Builder, Counter};
    use std::cell::RefCell;

    const EVENTS: [Hardware; 3] = [Hardware::INSTRUCTIONS, Hardware::CACHE_MISSES, Hardware::BRANCH_MISSES];

    thread_local! {
        static COUNTERS: RefCell<[Option<Counter>; 3]> = RefCell::new(EVENTS.map(opened));
    }

    pub(super) fn counts() -> Counts {
        COUNTERS.with_borrow_mut(|counters| counters.each_mut().map(|counter| counter.as_mut()?.read().ok()))
    }

    /// Counts on from here; `None` if the machine or its kernel does not let it.
    pub(super) fn opened(event: impl Event) -> Option<Counter> {
        let mut counter = Builder::new(event).inherit(true).build().ok()?;
        counter.enable().ok()?;
        Some(counter)
    }

    #[cfg(test)]
    mod tests {
        use super::*;
        use perf_event::events::Software;
        use std::hint::black_box;

        /// What a virtual machine has too: page faults. 40 MiB, which no allocator keeps for later, are touched by a thread that has ended when they are read.
        #[test]
        fn threads_that_are_started_later_count() {
            let Some(mut counter) = opened(Software::PAGE_FAULTS) else {
                return eprintln!("skipped: this kernel does not let a process count");
            };
            let before = counter.read().unwrap();
            std::thread::spawn(|| black_box(vec![1_u8; 40 << 20]).len()).join().unwrap();
            let faults = counter.read().unwrap() - before;
            assert!(faults >= 8, "{faults}");
        }
    }
}

#[cfg(not(target_os = "linux"))]
mod imp {
    pub(super) fn counts() -> super::Counts {
        [None; 3]
    }
}
