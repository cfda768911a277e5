//! Keeping a process on some of its CPUs, so that it does not wander between them while it is timed.

/// Pins the calling thread, and the threads that it starts from now on, to as many of the CPUs it may use as `threads`
/// says, distinct cores first; 0 takes them all. Returns the CPUs, or `None` where the system cannot do this or refuses:
/// the run then goes on unpinned, and its record says so.
pub fn pin(threads: u32) -> Option<Vec<u32>> {
    imp::pin(threads)
}

#[cfg(target_os = "linux")]
mod imp {
    use rustix::thread::{CpuSet, sched_getaffinity, sched_setaffinity};

    pub(super) fn pin(threads: u32) -> Option<Vec<u32>> {
        let allowed = sched_getaffinity(None).ok()?;
        let cpus: Vec<u32> =
            (0..CpuSet::MAX_CPU as u32).filter(|cpu| allowed.is_set(*cpu as usize)).collect();
        let chosen = super::choose(&cpus, threads, crate::linux::siblings);
        let mut set = CpuSet::new();
        chosen.iter().for_each(|cpu| set.set(*cpu as usize));
        sched_setaffinity(None, &set).ok()?;
        Some(chosen)
    }
}

#[cfg(not(target_os = "linux"))]
mod imp {
    pub(super) fn pin(_: u32) -> Option<Vec<u32>> {
        None
    }
}

/// The first CPU of each core, then the others, cut to the number asked for and sorted.
#[cfg(any(target_os = "linux", test))]
fn choose(allowed: &[u32], threads: u32, siblings: impl Fn(u32) -> Option<String>) -> Vec<u32> {
    if threads == 0 {
        return allowed.to_vec();
    }
    let mut cores = std::collections::HashSet::new();
    let (first, second): (Vec<u32>, Vec<u32>) =
        allowed.iter().partition(|cpu| siblings(**cpu).is_none_or(|core| cores.insert(core)));
    let mut chosen: Vec<u32> = first.into_iter().chain(second).take(threads as usize).collect();
    chosen.sort_unstable();
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cores_come_before_their_second_threads() {
        // Four cores of two threads: 0 and 1 are one core, and so on.
        let pairs = |cpu: u32| Some(format!("{}-{}", cpu / 2 * 2, cpu / 2 * 2 + 1));
        let all: Vec<u32> = (0..8).collect();
        assert_eq!(choose(&all, 3, pairs), [0, 2, 4]);
        assert_eq!(choose(&all, 5, pairs), [0, 1, 2, 4, 6]);
        assert_eq!(choose(&all, 0, pairs), all);
        assert_eq!(choose(&[1, 3, 5], 9, pairs), [1, 3, 5], "no more than there are");
        assert_eq!(choose(&[4, 5], 1, |_| None), [4], "unknown siblings are cores of their own");
    }
}
