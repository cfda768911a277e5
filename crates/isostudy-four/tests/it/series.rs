//! Series that tests share.

use isostudy_four::{Placement, Series};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Frames of a function of lattice coordinates x, y, z, t.
pub(crate) fn sampled(placement: Placement, frames: usize, value: impl Fn([f64; 4]) -> f64) -> Series {
    let [nx, ny, nz] = placement.counts;
    let frame = |t: usize| {
        let mut samples = Vec::new();
        for z in 0..nz {
            for y in 0..ny {
                samples.extend((0..nx).map(|x| value([x, y, z, t].map(|i| i as f64)) as f32));
            }
        }
        samples
    };
    Series::try_new(placement, (0..frames).map(frame).collect()).unwrap()
}

/// A ball of `radius` samples in the middle of `n` samples along each axis and time.
pub(crate) fn ball(n: usize, radius: f64) -> Series {
    let middle = (n - 1) as f64 / 2.0;
    sampled(Placement::unit([n; 3]), n, |at| {
        radius - at.iter().map(|x| (x - middle).powi(2)).sum::<f64>().sqrt()
    })
}

/// Values at random, of which about a share is inside at 0, and none at the sides nor in the first and last frame.
pub(crate) fn random(counts: [usize; 3], frames: usize, share: f64, seed: u64) -> Series {
    let mut random = Pcg64::seed_from_u64(seed);
    let last = [counts[0] - 1, counts[1] - 1, counts[2] - 1, frames - 1];
    let numbers: Vec<f64> =
        (0..counts.iter().product::<usize>() * frames).map(|_| random.random_range(0.001..1.0)).collect();
    sampled(Placement::unit(counts), frames, |at| {
        let at = at.map(|x| x as usize);
        let number = numbers[((at[3] * counts[2] + at[2]) * counts[1] + at[1]) * counts[0] + at[0]];
        let is_rim = (0..4).any(|axis| at[axis] == 0 || at[axis] == last[axis]);
        if is_rim || number > share { -number } else { number }
    })
}
