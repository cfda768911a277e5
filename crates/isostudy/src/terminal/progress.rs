//! What a run says while it works: a bar on a terminal, one line a step on standard error in any case.

use indicatif::{ProgressBar, ProgressStyle};
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
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
        let style = ProgressStyle::with_template("{msg:14} {wide_bar} {percent:>3} % {eta}")
            .expect("the template is a constant");
        let bar = ProgressBar::new(ticks as u64).with_style(style).with_message(name);
        Self { name, bar, items, redone: AtomicUsize::new(0), began: Instant::now() }
    }

    /// Moves the bar on.
    pub(crate) fn tick(&self, ticks: usize) {
        self.bar.inc(ticks as u64);
    }

    /// Moves the bar to so many ticks from the start, if it is not there yet.
    pub(crate) fn reach(&self, ticks: usize) {
        self.bar.inc((ticks as u64).saturating_sub(self.bar.position()));
    }

    /// What moves the bar within an item of so many ticks: to be told how much of how much is done, from any thread, in
    /// any order.
    pub(crate) fn within(&self, ticks: usize) -> impl Fn(usize, usize) + Send + Sync + use<> {
        let (bar, furthest) = (self.bar.clone(), AtomicU64::new(0));
        move |done, all| {
            let way = ticks as u64 * done as u64 / all.max(1) as u64;
            let before = furthest.fetch_max(way, Ordering::Relaxed);
            bar.inc(way.saturating_sub(before));
        }
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
            tell!("{name:14} {:>3} up to date", self.items);
        } else {
            tell!(
                "{name:14} {redone:>3} of {} made, {:.1} s",
                self.items,
                self.began.elapsed().as_secs_f64()
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bar_moves_within_an_item_whatever_the_order() {
        let step = Step::begin("test", 2, 200);
        for first in [0, 100] {
            let layers = step.within(100);
            for (done, ticks) in [(1, 25), (3, 75), (2, 75), (3, 75)] {
                layers(done, 4);
                assert_eq!(step.bar.position(), first + ticks);
            }
            step.reach(first as usize + 100);
            step.reach(first as usize);
            assert_eq!(step.bar.position(), first + 100);
        }
    }
}
