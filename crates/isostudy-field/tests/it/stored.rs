//! A field of samples that are read where they are wanted is the field of the same samples in memory, to the bit.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};

use glam::{DVec3, Vec3};
use isostudy_field::{Beyond, StoredSamples, StudyField, UnreadSamples, VolumeField, VolumeFieldError};
use isostudy_mesh::Bounds;

/// Samples in memory, read as if they were elsewhere.
struct Elsewhere {
    counts: [usize; 3],
    values: Vec<f32>,
    boxes: AtomicU64,
    is_gone: AtomicBool,
}

impl Elsewhere {
    fn new(counts: [usize; 3], values: Vec<f32>) -> Arc<Self> {
        Arc::new(Self { counts, values, boxes: AtomicU64::new(0), is_gone: AtomicBool::new(false) })
    }
}

impl StoredSamples for Elsewhere {
    fn counts(&self) -> [usize; 3] {
        self.counts
    }

    fn read_box(&self, first: [usize; 3], size: [usize; 3], values: &mut [f32]) -> Result<(), UnreadSamples> {
        self.boxes.fetch_add(1, Ordering::Relaxed);
        if self.is_gone.load(Ordering::Relaxed) {
            // As if it had been read halfway.
            values.fill(7.0);
            return Err(UnreadSamples(format!("gone at {first:?}")));
        }
        let [nx, ny, _] = self.counts;
        for (row, values) in values.chunks_exact_mut(size[0]).enumerate() {
            let (y, z) = (first[1] + row % size[1], first[2] + row / size[1]);
            values.copy_from_slice(&self.values[(z * ny + y) * nx + first[0]..][..size[0]]);
        }
        Ok(())
    }
}

/// Numbers without end.
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, end: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % end
    }

    fn share(&mut self) -> f64 {
        self.below(1 << 20) as f64 / (1 << 20) as f64
    }
}

fn samples(counts: [usize; 3], seed: u64, odd: bool) -> Vec<f32> {
    let mut numbers = Numbers(seed);
    let mut sample = || match numbers.below(60) {
        0 if odd => f32::NAN,
        1 if odd => f32::INFINITY,
        2 if odd => f32::NEG_INFINITY,
        3 if odd => 3.4e38,
        4 if odd => -3.4e38,
        _ => numbers.below(2000) as f32 / 8.0 - 100.0,
    };
    (0..counts.iter().product::<usize>()).map(|_| sample()).collect()
}

/// Straight, with other steps mirrored and exchanged, turned, sheared.
const FRAMES: [[[f64; 3]; 3]; 4] = [
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    [[0.0, -0.5, 0.0], [0.75, 0.0, 0.0], [0.0, 0.0, -2.0]],
    [[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0], [0.0, 0.0, 1.25]],
    [[1.0, 0.0, 0.0], [0.25, 1.0, 0.0], [-0.5, 0.25, 1.0]],
];

const ORIGIN: [f64; 3] = [-3.5, 2.0, 0.25];

/// The same field of samples in memory and elsewhere, of which so many bytes are kept, and as many of ranges.
fn both(
    counts: [usize; 3],
    values: &[f32],
    steps: [[f64; 3]; 3],
    beyond: Beyond,
    bytes: u64,
) -> (VolumeField, VolumeField, Arc<Elsewhere>) {
    let whole = VolumeField::try_new(counts, values.to_vec(), ORIGIN, steps, beyond).unwrap();
    let elsewhere = Elsewhere::new(counts, values.to_vec());
    let stored = VolumeField::try_stored(elsewhere.clone(), ORIGIN, steps, beyond, 2 * bytes, 2).unwrap();
    (whole, stored, elsewhere)
}

/// Points at samples, on edges, in cells and beyond the volume.
fn points(counts: [usize; 3], steps: [[f64; 3]; 3], count: usize, seed: u64) -> Vec<Vec3> {
    let mut numbers = Numbers(seed);
    let mut point = || {
        let mut p = DVec3::from_array(ORIGIN);
        for k in 0..3 {
            let along = numbers.below(counts[k] as u64) as f64;
            let along = match numbers.below(6) {
                0..3 => along,
                3 => along + 0.5,
                4 => along + numbers.share(),
                _ => along * 1.5 - 2.0,
            };
            p += DVec3::from_array(steps[k]) * along;
        }
        p.as_vec3()
    };
    (0..count).map(|_| point()).collect()
}

#[test]
fn values_are_those_of_samples_in_memory() {
    for (number, counts) in
        [[2, 2, 2], [17, 17, 17], [18, 33, 3], [50, 7, 40], [16, 34, 20]].into_iter().enumerate()
    {
        for odd in [false, true] {
            let values = samples(counts, number as u64, odd);
            for steps in FRAMES {
                for (beyond, bytes) in
                    [(Beyond::Continued, 0), (Beyond::Falling, 50_000), (Beyond::Rising, 1 << 30)]
                {
                    let (whole, stored, _) = both(counts, &values, steps, beyond, bytes);
                    assert_eq!(stored.value_range(), whole.value_range());
                    let [whole, stored] = [whole, stored].map(|field| match beyond {
                        Beyond::Continued => field,
                        _ => field.closing_at(3.25),
                    });
                    for p in points(counts, steps, 400, 5) {
                        let [a, b] = [whole.sample(p), stored.sample(p)].map(f32::to_bits);
                        assert!(a == b, "{counts:?} {odd} {steps:?} {beyond:?} {p}");
                    }
                    // Rows, along which bricks change.
                    let end = f64::from(whole.bounds().size().x) + 2.0;
                    let x: Vec<f32> = (0..90)
                        .map(|i| whole.bounds().min.x - 1.0 + (end / 90.0) as f32 * i as f32)
                        .collect();
                    for p in points(counts, steps, 20, 6) {
                        let mut rows = [vec![0.0; 90], vec![0.0; 90]];
                        whole.sample_row(&x, p.y, p.z, &mut rows[0]);
                        stored.sample_row(&x, p.y, p.z, &mut rows[1]);
                        for (i, &x) in x.iter().enumerate() {
                            let one = whole.sample(Vec3::new(x, p.y, p.z)).to_bits();
                            assert!(
                                rows.iter().all(|row| row[i].to_bits() == one),
                                "{counts:?} {odd} {steps:?} {p} {x}"
                            );
                        }
                    }
                }
            }
        }
    }
}

/// Boxes of a volume, some of which reach beyond it.
fn boxes(counts: [usize; 3], steps: [[f64; 3]; 3], count: usize) -> Vec<Bounds> {
    let mut numbers = Numbers(4);
    let of = |corner: Vec3| {
        let size = Vec3::from_array([(); 3].map(|()| 12.0 * numbers.share() as f32));
        Bounds { min: corner, max: corner + size }
    };
    points(counts, steps, count, 8).into_iter().map(of).collect()
}

/// What is said of a box holds for all that is in it, in whatever memory.
#[test]
fn ranges_hold_the_values() {
    let counts = [50, 40, 30];
    let values = samples(counts, 9, false);
    for (steps, bytes) in FRAMES.into_iter().zip([0, 500, 2000, 1 << 20]) {
        let (_, stored, _) = both(counts, &values, steps, Beyond::Falling, bytes);
        let mut numbers = Numbers(4);
        for bounds in boxes(counts, steps, 200) {
            let (low, high) = stored.range(bounds, f32::NAN).unwrap();
            for _ in 0..30 {
                let share = Vec3::from_array([(); 3].map(|()| numbers.share() as f32));
                let value = stored.sample(bounds.min + bounds.size() * share);
                assert!(low <= value && value <= high, "{bounds:?}: {value} from {low} to {high}");
            }
        }
    }
    // And says so much that what is empty is not looked into.
    let mut flat = vec![0.0; counts.iter().product()];
    flat[0] = 1.0;
    let (_, stored, elsewhere) = both(counts, &flat, FRAMES[0], Beyond::Continued, 1 << 20);
    let at = |x: f32| Vec3::from_array(ORIGIN.map(|o| o as f32 + x));
    assert_eq!(stored.range(Bounds { min: at(4.5), max: at(12.5) }, f32::NAN), Some((0.0, 0.0)));
    assert!(stored.range(Bounds { min: at(3.5), max: at(11.5) }, f32::NAN).unwrap().1 >= 1.0);
    assert_eq!(elsewhere.boxes.load(Ordering::Relaxed), 31, "layers at a time, one of them for both threads");
}

/// With room for them the ranges are those of samples in memory, whatever the number of threads that find them.
#[test]
fn ranges_are_those_of_samples_in_memory() {
    for (counts, threads) in [([50, 40, 30], 1), ([9, 40, 31], 2), ([7, 50, 33], 3), ([20, 20, 9], 7)] {
        for odd in [false, true] {
            let values = samples(counts, 9, odd);
            for steps in FRAMES {
                let elsewhere = Elsewhere::new(counts, values.clone());
                let whole =
                    VolumeField::try_new(counts, values.clone(), ORIGIN, steps, Beyond::Falling).unwrap();
                let stored =
                    VolumeField::try_stored(elsewhere, ORIGIN, steps, Beyond::Falling, 1 << 20, threads)
                        .unwrap();
                for bounds in boxes(counts, steps, 300) {
                    let [a, b] = [&whole, &stored].map(|field| field.range(bounds, f32::NAN));
                    assert_eq!(a, b, "{counts:?} {odd} {threads} {bounds:?}");
                }
            }
        }
    }
}

/// Of little memory ranges are those of larger blocks.
#[test]
fn ranges_take_no_more_than_half_of_the_memory() {
    let grid = VolumeField::try_new([2; 3], vec![0.0; 8], ORIGIN, FRAMES[0], Beyond::Continued).unwrap();
    assert_eq!(grid.grid().stored_bytes(1 << 20), [32, 8]);
    let grid = |counts| isostudy_field::VolumeGrid::try_new(counts, ORIGIN, FRAMES[0]).unwrap();
    let large = grid([2048; 3]);
    for (memory, edge) in [(4u64 << 30, 4), (2 << 30, 8), (100 << 20, 16), (50 << 20, 16), (10 << 20, 32)] {
        let [bricks, ranges] = large.stored_bytes(memory);
        let smallest = 8 * (2048u64 / edge).pow(3);
        assert!((smallest..smallest * 8 / 7 + 8 * 64).contains(&ranges), "{memory}: {ranges}");
        assert!(bricks <= memory / 2 && bricks > memory / 2 - (17 * 17 * 17 * 4 * 8), "{memory}: {bricks}");
    }
}

#[test]
fn any_number_of_threads_reads_the_same() {
    let counts = [70, 40, 50];
    let values = samples(counts, 3, true);
    // Room for one brick, for a few, for all.
    for bytes in [0, 17 * 17 * 17 * 4 * 5, 1 << 24] {
        let (whole, stored, _) = both(counts, &values, FRAMES[2], Beyond::Continued, bytes);
        let faults = Mutex::new(Vec::new());
        std::thread::scope(|scope| {
            for thread in 0..4 {
                let (whole, stored, faults) = (&whole, &stored, &faults);
                scope.spawn(move || {
                    for p in points(counts, FRAMES[2], 3000, thread) {
                        if whole.sample(p).to_bits() != stored.sample(p).to_bits() {
                            faults.lock().unwrap().push(p);
                        }
                    }
                });
            }
        });
        assert_eq!(faults.into_inner().unwrap(), [Vec3::ZERO; 0], "{bytes} bytes");
    }
}

/// Bricks that were asked for last are still there; what is kept has a limit.
#[test]
fn bricks_are_read_again_only_when_others_took_their_place() {
    let counts = [65, 65, 65];
    let values = samples(counts, 3, false);
    let brick = 17 * 17 * 17 * 4;
    let read = |bytes: u64, order: &dyn Fn(usize) -> usize| {
        let (_, stored, elsewhere) = both(counts, &values, FRAMES[0], Beyond::Continued, bytes);
        let before = elsewhere.boxes.load(Ordering::Relaxed);
        assert_eq!(before, 66, "one of the layers for both threads");
        for i in 0..640 {
            let brick = order(i);
            let at = [brick % 4, brick / 4 % 4, brick / 16].map(|b| 16.0 * b as f32 + 3.5);
            stored.sample(Vec3::from_array(ORIGIN.map(|o| o as f32)) + Vec3::from_array(at));
        }
        (elsewhere.boxes.load(Ordering::Relaxed) - before, stored.grid().stored_bytes(2 * bytes)[0])
    };
    // One after the other: each once, whatever there is room for.
    for bytes in [0, brick, 20 * brick, 1 << 30] {
        let (boxes, held) = read(bytes, &|i| i / 10);
        assert_eq!(boxes, 64);
        assert!(held <= bytes.max(brick) && held.is_multiple_of(brick), "{held} of {bytes}");
    }
    // By turns between two: room for two is enough, room for one is not.
    assert_eq!(read(2 * brick, &|i| 5 + i % 2).0, 2);
    assert_eq!(read(brick, &|i| 5 + i % 2).0, 640);
    // Round and round: the one that was asked for longest ago goes.
    assert_eq!(read(3 * brick, &|i| i % 3).0, 3);
    // The first time all four, three in each of 105 more turns of six, and two of the last four.
    assert_eq!(read(3 * brick, &|i| [0, 1, 0, 2, 0, 3][i % 6]).0, 4 + 105 * 3 + 2);
    assert_eq!(read(1 << 30, &|i| i / 10).1, 64 * brick);
}

#[test]
fn what_cannot_be_read_is_an_error_or_no_number() {
    let counts = [40, 20, 20];
    let values = samples(counts, 1, false);
    let (_, stored, elsewhere) = both(counts, &values, FRAMES[0], Beyond::Continued, 0);
    elsewhere.is_gone.store(true, Ordering::Relaxed);
    let at = Vec3::from_array(ORIGIN.map(|o| o as f32 + 3.5));
    assert!(stored.sample(at).is_nan());
    let error = VolumeField::try_stored(elsewhere, ORIGIN, FRAMES[0], Beyond::Continued, 0, 1).unwrap_err();
    assert_eq!(error, VolumeFieldError::Unread(UnreadSamples("gone at [0, 0, 0]".into())));
    assert_eq!(error.to_string(), "gone at [0, 0, 0]");
}

#[test]
fn stored_samples_are_refused_as_those_in_memory() {
    let make = |counts: [usize; 3], value: f32, steps| {
        let elsewhere = Elsewhere::new(counts, vec![value; counts.iter().product()]);
        VolumeField::try_stored(elsewhere, ORIGIN, steps, Beyond::Continued, 0, 1).map(|_| ()).unwrap_err()
    };
    assert_eq!(make([4, 1, 4], 0.0, FRAMES[0]), VolumeFieldError::Flat { counts: [4, 1, 4] });
    assert!(matches!(make([4, 0, 4], 0.0, FRAMES[0]), VolumeFieldError::Counts { .. }));
    assert!(matches!(make([4, 4, 4], 0.0, [[1.0, 0.0, 0.0]; 3]), VolumeFieldError::Steps { .. }));
    assert_eq!(make([4, 4, 4], f32::NAN, FRAMES[0]), VolumeFieldError::NoNumbers);
}
