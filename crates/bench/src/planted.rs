//! A slowdown that is planted, to see whether it is found: for the tests of this benchmark, and for nothing else.

use crate::run::PeakBytes;
use crate::stages::Timed;
use crate::worker::Measured;
use std::hint::spin_loop;
use std::time::{Duration, Instant};

/// The environment variable with the share by which a measuring process is to take longer: `0.05` for 5 %.
pub const PLANTED: &str = "ISOSTUDY_PLANTED_SLOWDOWN";

/// Something to time that takes longer by a share: after each extraction it does nothing, busily, for that share of the extraction's
/// time, and the geometry stage has it.
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
        let spent = spin(Duration::from_secs_f64(self.share * timed.stages.total()));
        timed.stages.geometry_s += spent;
        timed.counters.cpu_s = timed.counters.cpu_s.map(|cpu| cpu + spent);
        Ok(timed)
    }

    fn memory(&mut self, number: usize, threads: u32) -> Result<Option<PeakBytes>, String> {
        self.measured.memory(number, threads)
    }
}

/// Seconds that went by: at least as long as asked.
fn spin(duration: Duration) -> f64 {
    let began = Instant::now();
    while !duration.is_zero() && began.elapsed() < duration {
        spin_loop();
    }
    if duration.is_zero() { 0.0 } else { began.elapsed().as_secs_f64() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stages::StageSeconds;

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

    #[test]
    fn what_is_planted_is_there_and_nothing_is_where_none_is() {
        let planted = Planted::new(&mut Fixed, 0.2).time(0, 1).unwrap().stages;
        assert!(planted.geometry_s >= 0.002 && planted.vertex_s == 0.01, "{planted:?}");
        let none = Planted::new(&mut Fixed, 0.0).time(0, 1).unwrap().stages;
        assert_eq!((none.geometry_s, none.total()), (0.0, 0.01));
    }
}
