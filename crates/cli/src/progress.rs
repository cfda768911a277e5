//! What a run says while it works: a bar on a terminal, one line a step on standard error in any case.

use indicatif::{ProgressBar, ProgressStyle};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// One step of a run over a known number of items.
pub(crate) struct Step {
    name: &'static str,
    bar: ProgressBar,
    items: usize,
    redone: AtomicUsize,
    began: Instant,
}

impl Step {
    /// Begins a step. The bar shows on a terminal only.
    pub(crate) fn begin(name: &'static str, items: usize, ticks: usize) -> Self {
        let style = ProgressStyle::with_template("{msg:14} {wide_bar} {pos}/{len} {eta}")
            .expect("the template is a constant");
        let bar = ProgressBar::new(ticks as u64).with_style(style).with_message(name);
        Self { name, bar, items, redone: AtomicUsize::new(0), began: Instant::now() }
    }

    /// Moves the bar on.
    pub(crate) fn tick(&self, ticks: usize) {
        self.bar.inc(ticks as u64);
    }

    /// Sets the bar, whose length is known only now.
    pub(crate) fn set(&self, done: u64, all: u64) {
        self.bar.set_length(all);
        self.bar.set_position(done);
    }

    /// Counts an item that was not up to date.
    pub(crate) fn count(&self, redone: bool) {
        self.redone.fetch_add(usize::from(redone), Ordering::Relaxed);
    }

    /// Counts all items at once.
    pub(crate) fn count_all(&self, redone: bool) {
        self.redone.store(if redone { self.items } else { 0 }, Ordering::Relaxed);
    }

    /// Ends the step and says what was done.
    pub(crate) fn end(self) {
        self.bar.finish_and_clear();
        let (name, redone) = (self.name, self.redone.into_inner());
        if redone == 0 {
            eprintln!("{name:14} {:>3} up to date", self.items);
        } else {
            eprintln!(
                "{name:14} {redone:>3} of {} made, {:.1} s",
                self.items,
                self.began.elapsed().as_secs_f64()
            );
        }
    }
}
