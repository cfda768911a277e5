//! A slowdown that is planted, to see whether it is found: for the tests of this benchmark, and for nothing else.

use crate::allocations::AllocationCounts;
use crate::meter::thread_cpu_s;
use crate::run::PeakBytes;
use crate::stages::Timed;
use crate::worker::Measured;
use std::hint::spin_loop;
use std::time::Instant;

/// The environment variable with the share by which a measuring process is to take longer: `0.05` for 5 %.
pub const PLANTED: &str = "ISOSTUDY_PLANTED_SLOWDOWN";

/// Something to time that takes longer by a share: after each extraction it does nothing, busily, for that share of the extraction's
/// time, and the geometry stage has it. What others take of the CPU is taken from this as from the extraction: it is work of so
/// much CPU time, where that is told.
pub struct Planted<'a> {
    measured: &'a mut dyn Measured,
    share: f64,
}

impl<'a> Planted<'a> {
    /// Slows `measured` down by a share of its own time; 0 leaves it as it is.
    pub fn new(measured: &'a mut dyn Measured, share: f64) -> Self {
        Self { measured, share }
    }
}

impl Measured for Planted<'_> {
    fn time(&mut self, number: usize, threads: u32) -> Result<Timed, String> {
        let mut timed = self.measured.time(number, threads)?;
        let total = timed.stages.total();
        let work = timed.counters.cpu_s.map_or(total, |cpu| cpu.min(total));
        let began = Instant::now();
        let spent = spin(self.share * work);
        timed.stages.geometry_s += if spent > 0.0 { began.elapsed().as_secs_f64() } else { 0.0 };
        timed.counters.cpu_s = timed.counters.cpu_s.map(|cpu| cpu + spent);
        Ok(timed)
    }

    fn memory(&mut self, number: usize, threads: u32) -> Result<Option<PeakBytes>, String> {
        self.measured.memory(number, threads)
    }

    fn allocations(&mut self, number: usize) -> Result<Option<AllocationCounts>, String> {
        self.measured.allocations(number)
    }
}

/// Works for so many seconds of this thread's CPU time, or of the clock where CPU time is not told; returns how many it were.
fn spin(seconds: f64) -> f64 {
    let began = Instant::now();
    let before = thread_cpu_s();
    let spent = || match (before, thread_cpu_s()) {
        (Some(before), Some(now)) => now - before,
        _ => began.elapsed().as_secs_f64(),
    };
    if seconds <= 0.0 {
        return 0.0;
    }
    while spent() < seconds {
        spin_loop();
    }
    spent()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stages::StageSeconds;
    use isostudy_design::record::Counters;

    struct Fixed;

    impl Measured for Fixed {
        fn time(&mut self, _: usize, _: u32) -> Result<Timed, String> {
            Ok(Timed {
                stages: StageSeconds { vertex_s: 0.01, ..StageSeconds::default() },
                ..Timed::default()
            })
        }

        fn memory(&mut self, _: usize, _: u32) -> Result<Option<PeakBytes>, String> {
            Ok(None)
        }
    }

    /// Takes 10 ms, and less CPU time: others had the CPU.
    struct Waiting(Counters);

    impl Measured for Waiting {
        fn time(&mut self, number: usize, threads: u32) -> Result<Timed, String> {
            Fixed.time(number, threads).map(|timed| Timed { counters: self.0, ..timed })
        }

        fn memory(&mut self, _: usize, _: u32) -> Result<Option<PeakBytes>, String> {
            Ok(None)
        }
    }

    #[test]
    fn what_is_planted_is_there_and_nothing_is_where_none_is() {
        let planted = Planted::new(&mut Fixed, 0.2).time(0, 1).unwrap().stages;
        assert!(planted.geometry_s >= 0.002 && planted.vertex_s == 0.01, "{planted:?}");
        let counted = |share| {
            let counters = Counters { cpu_s: Some(0.004), ..Counters::default() };
            Planted::new(&mut Waiting(counters), share).time(0, 1).unwrap()
        };
        let planted = counted(0.5);
        assert!(planted.counters.cpu_s >= Some(0.006), "half of the CPU time: {planted:?}");
        assert!(planted.counters.cpu_s < Some(0.009), "not half of the time it waited: {planted:?}");
        assert_eq!(counted(0.0).counters.cpu_s, Some(0.004));
        let none = Planted::new(&mut Fixed, 0.0).time(0, 1).unwrap().stages;
        assert_eq!((none.geometry_s, none.total()), (0.0, 0.01));
    }
}
