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
    failed: AtomicUsize,
    began: Instant,
}

impl Step {
    /// Begins a step. The bar shows on a terminal only.
    pub(crate) fn begin(name: &'static str, items: usize, ticks: usize) -> Self {
        let style = ProgressStyle::with_template("{msg:14} {wide_bar} {percent:>3} % {eta}")
            .expect("the template is a constant");
        let bar = ProgressBar::new(ticks as u64).with_style(style).with_message(name);
        Self {
            name,
            bar,
            items,
            redone: AtomicUsize::new(0),
            failed: AtomicUsize::new(0),
            began: Instant::now(),
        }
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

    /// Counts an item that failed, and is neither made nor up to date.
    pub(crate) fn count_failed(&self) {
        self.failed.fetch_add(1, Ordering::Relaxed);
    }

    /// Counts all items at once.
    pub(crate) fn count_all(&self, redone: bool) {
        self.redone.store(if redone { self.items } else { 0 }, Ordering::Relaxed);
    }

    /// Ends the step and says what was done.
    pub(crate) fn end(self) {
        self.bar.finish_and_clear();
        tell!("{}", self.summary(self.began.elapsed().as_secs_f64()));
    }
}

impl Step {
    fn summary(&self, seconds: f64) -> String {
        let [redone, failed] = [&self.redone, &self.failed].map(|count| count.load(Ordering::Relaxed));
        let (name, items) = (self.name, self.items);
        let others = if failed == 0 { String::new() } else { format!(", {failed} failed") };
        match () {
            () if redone > 0 => format!("{name:14} {redone:>3} of {items} made{others}, {seconds:.1} s"),
            () if failed > 0 && failed >= items => format!("{name:14} {failed:>3} failed"),
            () => format!("{name:14} {:>3} up to date{others}", items - failed),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_failed_is_not_up_to_date() {
        let said = |redone: usize, failed: usize| {
            let step = Step::begin("meshes", 3, 0);
            (0..redone).for_each(|_| step.count(true));
            (0..failed).for_each(|_| step.count_failed());
            step.summary(1.0)
        };
        assert_eq!(said(0, 0), "meshes           3 up to date");
        assert_eq!(said(0, 2), "meshes           1 up to date, 2 failed");
        assert_eq!(said(0, 3), "meshes           3 failed");
        assert_eq!(said(2, 1), "meshes           2 of 3 made, 1 failed, 1.0 s");
        assert_eq!(said(3, 0), "meshes           3 of 3 made, 1.0 s");
    }

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
