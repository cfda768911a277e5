//! Ctrl-C and SIGTERM: children and temporary folders go before this process does.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::Child;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, Once, PoisonError};
use std::thread;

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::iterator::Signals;
use signal_hook::low_level::emulate_default_handler;

use crate::processes::Family;

/// What would be left.
struct Kept {
    families: Vec<Family>,
    folders: Vec<PathBuf>,
}

static KEPT: Mutex<Kept> = Mutex::new(Kept { families: Vec::new(), folders: Vec::new() });
static ENDS_ELSEWHERE: AtomicBool = AtomicBool::new(false);

fn kept() -> MutexGuard<'static, Kept> {
    KEPT.lock().unwrap_or_else(PoisonError::into_inner)
}

/// From now on a signal ends children and folders, and whoever else listens to signals ends this process.
pub fn leave_signals_to_others() {
    ENDS_ELSEWHERE.store(true, Ordering::Relaxed);
}

/// Starts a child and keeps it, with no moment between in which a signal would find it started and not kept.
pub(crate) fn register(start: impl FnOnce() -> io::Result<(Child, Family)>) -> io::Result<(Child, Family)> {
    listen();
    let mut kept = kept();
    let (child, family) = start()?;
    kept.families.push(family.clone());
    Ok((child, family))
}

pub(crate) fn forget(family: &Family) {
    kept().families.retain(|known| known != family);
}

pub(crate) fn register_folder(folder: &Path) {
    listen();
    kept().folders.push(folder.to_owned());
}

pub(crate) fn forget_folder(folder: &Path) {
    kept().folders.retain(|known| known != folder);
}

/// A thread that waits for the signals, from the first child or folder on. One that this process was told to ignore it goes on ignoring.
fn listen() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let ignored = ignored();
        let wanted = [SIGINT, SIGTERM].into_iter().filter(|signal| ignored >> (signal - 1) & 1 == 0);
        let Ok(mut signals) = Signals::new(wanted) else { return };
        let wait = move || {
            for signal in signals.forever() {
                // Held to the end: nobody starts another, and nobody says meanwhile that a child ended without being asked to.
                let mut kept = kept();
                kept.families.drain(..).for_each(|family| family.kill());
                kept.folders.drain(..).for_each(|folder| drop(fs::remove_dir_all(folder)));
                if !ENDS_ELSEWHERE.load(Ordering::Relaxed) {
                    let _ = emulate_default_handler(signal);
                }
            }
        };
        let _ = thread::Builder::new().name("signals".into()).spawn(wait);
    });
}

/// The signals that are ignored, one bit each.
fn ignored() -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
}
