//! Nets of labels against the net of two, counts by brute force and by numpy, and the boundary of each label.

use std::collections::HashMap;

use isostudy_extract::{
    Execution, ExtractError, Extractor, LabelError, LabelSettings, LabelSurface, LabelVolume, Method,
    SurfaceNets, VolumeCells,
};
use isostudy_mesh::{LabelledMesh, TriangleMesh};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

const ONE: Execution = Execution { threads: 1 };
const UNIT: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// Mirrored, sheared and unequal.
const ODD: [[f64; 3]; 3] = [[0.0, 0.5, 0.1], [0.75, 0.0, 0.0], [0.0, 0.2, 1.25]];

struct Labels {
    counts: [usize; 3],
    labels: Vec<u32>,
}

impl Labels {
    fn of(counts: [usize; 3], mut label: impl FnMut([usize; 3]) -> u32) -> Self {
        let [nx, ny, nz] = counts;
        let labels = (0..nx * ny * nz).map(|i| label([i % nx, i / nx % ny, i / nx / ny])).collect();
        Self { counts, labels }
    }

    /// So many labels at random, with background round them if that is wanted.
    fn noise(counts: [usize; 3], labels: u32, seed: u64, closed: bool) -> Self {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        Self::of(counts, |place| {
            let label = random.random_range(0..labels);
            let at_end = (0..3).any(|axis| place[axis] == 0 || place[axis] + 1 == counts[axis]);
            if closed && at_end { 0 } else { label }
        })
    }

    /// Three balls that meet in the middle, each of what is nearest to its centre.
    fn balls() -> Self {
        let centres = [[13.5, 14.0, 15.0], [25.0, 15.5, 16.0], [18.7, 25.0, 15.3]];
        Self::of([39, 39, 31], |place| {
            let squared =
                |centre: [f64; 3]| (0..3).map(|a| (place[a] as f64 - centre[a]).powi(2)).sum::<f64>();
            let distances = centres.map(squared);
            let nearest = (0..3).min_by(|&a, &b| distances[a].total_cmp(&distances[b])).unwrap();
            if distances[nearest] < 121.0 { [2, 5, 9][nearest] } else { 0 }
        })
    }

    fn at(&self, [x, y, z]: [usize; 3]) -> u32 {
        self.labels[(z * self.counts[1] + y) * self.counts[0] + x]
    }

    fn volume(&self) -> LabelVolume<'_> {
        LabelVolume { counts: self.counts, labels: &self.labels, origin: [0.0; 3], steps: UNIT }
    }

    fn surface(&self, settings: &LabelSettings) -> LabelSurface {
        self.volume().extract(settings, &ONE).unwrap()
    }

    /// The net of samples 1 where a label is, and 0 elsewhere.
    fn of_one(&self, label: u32, smoothing: u32, steps: [[f64; 3]; 3]) -> TriangleMesh {
        let values: Vec<f32> = self.labels.iter().map(|&of| f32::from(u8::from(of == label))).collect();
        let cells = VolumeCells { counts: self.counts, values: &values, origin: [1.0, -2.0, 3.0], steps };
        let nets = Method::SurfaceNets(SurfaceNets::default().with_smoothing(smoothing));
        cells.extract(&nets, &mut Extractor::new(), 0.5, &ONE).unwrap().mesh
    }

    /// The edges that four cells share, as the points they begin at and their axes.
    fn shared_edges(&self) -> Vec<([usize; 3], usize)> {
        let [nx, ny, nz] = self.counts;
        let points = (0..nx * ny * nz).map(|i| [i % nx, i / nx % ny, i / nx / ny]);
        let is_shared = |&(point, axis): &([usize; 3], usize)| {
            let inner = |a: usize| 0 < point[a] && point[a] + 1 < self.counts[a];
            point[axis] + 1 < self.counts[axis] && (0..3).all(|a| a == axis || inner(a))
        };
        points.flat_map(|p| (0..3).map(move |axis| (p, axis))).filter(is_shared).collect()
    }
}

/// How many triangles each side has.
fn sides(mesh: &TriangleMesh) -> HashMap<[u32; 2], u32> {
    let mut sides = HashMap::new();
    for &[a, b, c] in &mesh.triangles {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            *sides.entry([from.min(to), from.max(to)]).or_default() += 1;
        }
    }
    sides
}

/// Triangles run along each side as often one way as the other.
fn is_closed(mesh: &TriangleMesh) -> bool {
    let mut balance: HashMap<[u32; 2], i32> = HashMap::new();
    for &[a, b, c] in &mesh.triangles {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            *balance.entry([from.min(to), from.max(to)]).or_default() += if from < to { 1 } else { -1 };
        }
    }
    balance.values().all(|&balance| balance == 0)
}

/// Of two labels the net is the net of the samples 0 and 1, to the byte, smoothed or not, in any space.
#[test]
fn two_labels_have_the_net_of_two_samples() {
    for (seed, smoothing) in [(1, 0), (2, 0), (3, 1), (4, 7)] {
        for steps in [UNIT, ODD] {
            for closed in [true, false] {
                let noise = Labels::noise([9, 8, 11], 2, seed, closed);
                let settings = LabelSettings::default().with_smoothing(smoothing);
                let volume = LabelVolume { origin: [1.0, -2.0, 3.0], steps, ..noise.volume() };
                let LabelledMesh { mesh, sides } = volume.extract(&settings, &ONE).unwrap().labelled;
                let net = noise.of_one(1, smoothing, steps);
                assert_eq!((&mesh.positions, &mesh.triangles), (&net.positions, &net.triangles));
                assert!(sides.iter().all(|sides| *sides == [1, 0]));
                assert!(!closed || steps == UNIT || mesh.volume() > 0.0, "mirrored, and not inside out");
            }
        }
    }
}

/// Two triangles with the labels of its ends for each shared edge whose ends differ, and a vertex for each cell with such an edge.
#[test]
fn triangles_are_those_of_edges_whose_ends_differ() {
    for seed in 0..20 {
        let noise = Labels::noise([6, 7, 8], 2 + seed as u32 % 4, seed, seed % 2 == 0);
        let LabelSurface { labelled: LabelledMesh { mesh, sides }, crossings, .. } =
            noise.surface(&LabelSettings::default());
        let mut pairs: HashMap<[u32; 2], usize> = HashMap::new();
        let mut cells = std::collections::HashSet::new();
        for (point, axis) in noise.shared_edges() {
            let mut end = point;
            end[axis] += 1;
            let (from, to) = (noise.at(point), noise.at(end));
            if from == to {
                continue;
            }
            *pairs.entry([from.max(to), from.min(to)]).or_default() += 2;
            for back in 0..4 {
                let mut cell = point;
                cell[(axis + 1) % 3] -= back & 1;
                cell[(axis + 2) % 3] -= back >> 1;
                cells.insert(cell);
            }
        }
        let mut found: HashMap<[u32; 2], usize> = HashMap::new();
        sides.iter().for_each(|&pair| *found.entry(pair).or_default() += 1);
        assert_eq!(found, pairs);
        assert_eq!(mesh.positions.len(), cells.len());
        assert!(mesh.positions.iter().all(|p| cells.contains(&p.to_array().map(|x| x.floor() as usize))));
        assert!(crossings as usize >= mesh.triangles.len() / 2);
    }
}

/// numpy 1.24, `x, y, z = np.meshgrid(np.arange(20), np.arange(17), np.arange(23), indexing="ij")`,
/// `L = (x*x + 3*y*y + 5*z*z + x*y) // 40 % 5`: differing ends along each axis, all and without those in the faces of the box; cells at
/// such edges; `np.bincount(L.ravel())`.
#[test]
fn counts_are_those_of_numpy() {
    let volume =
        Labels::of([20, 17, 23], |[x, y, z]| ((x * x + 3 * y * y + 5 * z * z + x * y) / 40 % 5) as u32);
    let LabelSurface { labelled, counts, crossings } = volume.surface(&LabelSettings::default());
    assert_eq!((crossings, labelled.mesh.triangles.len()), (16_902, 2 * 13_687));
    assert_eq!(labelled.mesh.positions.len(), 6_642);
    let samples: Vec<u64> = counts.iter().map(|of| of.samples).collect();
    assert_eq!(samples, [1608, 1586, 1576, 1565, 1485]);
    assert!(counts.iter().map(|of| of.label).eq(0..5));
    // With background beyond the box every edge into it differs, but those from label 0.
    let closed = volume.surface(&LabelSettings::default().with_close(true));
    let [nx, ny, nz] = volume.counts;
    let outer = |axis: usize, far: bool| {
        let n = volume.counts[axis];
        let of = (0..nx * ny * nz).map(|i| [i % nx, i / nx % ny, i / nx / ny]);
        of.filter(|p| p[axis] == if far { n - 1 } else { 0 } && volume.at(*p) != 0).count()
    };
    let outer: usize = (0..3).map(|axis| outer(axis, false) + outer(axis, true)).sum();
    assert_eq!(closed.labelled.mesh.triangles.len(), 2 * (16_902 + outer));
}

/// The boundary of a label is that of its own two-label net, seen apart: closed, and with four triangles at a side exactly where it
/// crosses a face between cells by turns.
#[test]
fn the_boundary_of_each_label_is_closed() {
    let noise = Labels::noise([10, 9, 11], 4, 5, true);
    let balls = Labels::balls();
    let tried = [(&balls, [2, 5, 9], 0, false), (&balls, [2, 5, 9], 6, false), (&noise, [1, 2, 3], 0, true)];
    for (volume, labels, smoothing, crosses_by_turns) in tried {
        let surface = volume.surface(&LabelSettings::default().with_smoothing(smoothing));
        for label in labels {
            let boundary = surface.labelled.boundary_of(label);
            assert!(is_closed(&boundary), "{label}");
            let [nx, ny, nz] = volume.counts;
            let by_turns = |axis: usize, [x, y, z]: [usize; 3]| {
                let corner = |i: usize, j: usize| {
                    let mut place = [x, y, z];
                    place[(axis + 1) % 3] += i;
                    place[(axis + 2) % 3] += j;
                    volume.at(place) == label
                };
                let [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                a == c && b == d && a != b
            };
            let inner = (0..3)
                .flat_map(|axis| (0..nx * ny * nz).map(move |i| (axis, [i % nx, i / nx % ny, i / nx / ny])));
            let has_face = |axis: usize, p: [usize; 3]| {
                0 < p[axis]
                    && p[axis] + 1 < volume.counts[axis]
                    && p[(axis + 1) % 3] + 1 < volume.counts[(axis + 1) % 3]
                    && p[(axis + 2) % 3] + 1 < volume.counts[(axis + 2) % 3]
            };
            let expected = inner.filter(|&(axis, p)| has_face(axis, p) && by_turns(axis, p)).count();
            let counted = sides(&boundary);
            assert!(counted.values().all(|&n| n == 2 || n == 4), "{label}");
            assert_eq!(counted.values().filter(|&&n| n == 4).count(), expected, "{label}");
            assert_eq!(expected > 0, crosses_by_turns, "{label}");
        }
    }
}

/// What a label encloses is as much as its samples, but for half a step at a rounded edge. The bound is four hundredths.
#[test]
fn volumes_are_those_of_samples() {
    let balls = Labels::balls();
    for smoothing in [0, 4] {
        let surface = balls.surface(&LabelSettings::default().with_smoothing(smoothing));
        let mut sum = 0.0;
        for of in &surface.counts {
            let volume = surface.labelled.boundary_of(of.label).volume();
            sum += volume;
            if of.label > 0 {
                let share = volume / of.samples as f64;
                assert!((0.96..1.0).contains(&share), "label {}: {share}", of.label);
            }
        }
        assert!(sum.abs() < 1e-2, "each boundary is counted from both sides: {sum}");
    }
    // A block of 4 samples by 6 by 8 in cells of another size: vertices of its faces lie half a step beyond the samples.
    let block =
        Labels::of([8, 10, 12], |p| u32::from((0..3).all(|a| p[a] >= 2 && p[a] + 2 < [8, 10, 12][a])));
    let volume = LabelVolume { steps: [[2.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 0.5]], ..block.volume() };
    let surface = volume.extract(&LabelSettings::default(), &ONE).unwrap();
    let bounds = surface.labelled.mesh.bounds().unwrap();
    assert_eq!(bounds.size().to_array(), [4.0 * 2.0, 6.0 * 3.0, 8.0 * 0.5]);
    let volume = surface.labelled.boundary_of(1).volume();
    assert!((0.9 * 576.0..576.0).contains(&volume), "{volume}");
}

/// Other names for the labels give the same vertices and triangles; only which side is inside follows the names.
#[test]
fn names_do_not_matter() {
    let names = [0, 700, 3, 41];
    let noise = Labels::noise([9, 9, 9], 4, 8, false);
    let renamed =
        Labels { counts: noise.counts, labels: noise.labels.iter().map(|&l| names[l as usize]).collect() };
    for smoothing in [0, 3] {
        let settings = LabelSettings::default().with_smoothing(smoothing);
        let [before, after] = [&noise, &renamed].map(|of| of.surface(&settings).labelled);
        assert_eq!(before.mesh.positions, after.mesh.positions);
        let turned = |t: [u32; 3]| {
            let least = (0..3).min_by_key(|&i| t[i]).unwrap();
            [t[least], t[(least + 1) % 3], t[(least + 2) % 3]]
        };
        for pair in 0..before.sides.len() / 2 {
            let [mut want, mut found] =
                [&before, &after].map(|of| [of.mesh.triangles[2 * pair], of.mesh.triangles[2 * pair + 1]]);
            let [inside, outside] = before.sides[2 * pair].map(|label| names[label as usize]);
            assert_eq!(after.sides[2 * pair], [inside.max(outside), inside.min(outside)]);
            if inside < outside {
                want = want.map(|[a, b, c]| [a, c, b]);
            }
            want = want.map(turned);
            found = found.map(turned);
            want.sort_unstable();
            found.sort_unstable();
            assert_eq!(found, want);
        }
    }
}

/// Labels that are not chosen are background.
#[test]
fn chosen_labels_are_bounded_by_themselves() {
    let noise = Labels::noise([9, 8, 7], 4, 11, true);
    let of_two = noise.surface(&LabelSettings::default().with_only(&[2]));
    let net = noise.of_one(2, 0, UNIT);
    assert_eq!(of_two.labelled.mesh.triangles, net.triangles);
    assert!(of_two.labelled.sides.iter().all(|sides| *sides == [2, 0]));
    let some = noise.surface(&LabelSettings::default().with_only(&[3, 1]));
    assert_eq!(some.labelled.pairs(), [[1, 0], [3, 0], [3, 1]]);
    assert!(some.counts.iter().map(|of| of.label).eq([0, 1, 3]));
}

/// With background beyond the volume all boundaries are closed, half a step beyond the last samples.
#[test]
fn boundaries_are_closed_if_that_is_wanted() {
    let noise = Labels::noise([5, 6, 7], 4, 13, false);
    let surface =
        |close| noise.surface(&LabelSettings::default().with_close(close).with_smoothing(2)).labelled;
    let (open, closed) = (surface(false), surface(true));
    assert!(
        (1..4).all(|label| is_closed(&closed.boundary_of(label)) && !is_closed(&open.boundary_of(label)))
    );
    let bounds = closed.mesh.bounds().unwrap();
    assert!(bounds.min.min_element() > -1.0 && bounds.min.max_element() < 0.0, "{bounds:?}");
    // One label alone has a boundary then.
    let full = Labels::of([3, 4, 5], |_| 6);
    let block = full.surface(&LabelSettings::default().with_close(true)).labelled;
    assert_eq!(block.mesh.triangles.len(), 2 * 2 * (3 * 4 + 4 * 5 + 5 * 3));
    assert_eq!(block.mesh.bounds().unwrap().size().to_array(), [3.0, 4.0, 5.0]);
}

#[test]
fn threads_change_nothing() {
    let noise = Labels::noise([30, 30, 30], 5, 17, false);
    let settings = LabelSettings::default().with_smoothing(5).with_close(true);
    let of = |threads| noise.volume().extract(&settings, &Execution { threads }).unwrap();
    assert!(of(1) == of(3) && of(1) == of(2));
}

#[test]
fn what_is_no_segmentation_is_refused() {
    let noise = Labels::noise([4, 4, 4], 3, 1, false);
    let error = |volume: &LabelVolume, settings: &LabelSettings| volume.extract(settings, &ONE).unwrap_err();
    let all = LabelSettings::default();
    let alone = Labels::of([4, 4, 4], |_| 7);
    assert_eq!(error(&alone.volume(), &all), LabelError::Alone { label: 7 });
    let nothing = Labels::of([4, 4, 4], |_| 0);
    let close = all.with_close(true);
    assert_eq!(error(&nothing.volume(), &close), LabelError::Alone { label: 0 });
    let absent = error(&noise.volume(), &all.with_only(&[1, 9]));
    assert_eq!(absent.to_string(), "no sample has the label 9; labels are 0, 1, 2");
    assert_eq!(error(&noise.volume(), &all.with_only(&[0])), LabelError::Background);
    let smoothing = all.with_smoothing(65);
    assert_eq!(error(&noise.volume(), &smoothing), LabelError::Smoothing { smoothing: 65 });
    let densities = Labels::of([70, 50, 40], |[x, y, z]| ((z * 50 + y) * 70 + x) as u32 / 2);
    assert_eq!(error(&densities.volume(), &all), LabelError::TooMany);
    let many = Labels::of([70, 50, 40], |[x, y, z]| ((z * 50 + y) * 70 + x) as u32 / 3);
    let said = error(&many.volume(), &all.with_only(&[99_999])).to_string();
    assert!(said.ends_with("10, 11, 46655 more"), "{said}");
    let flat = LabelVolume { counts: [64, 1, 1], ..noise.volume() };
    assert_eq!(error(&flat, &all), LabelError::Flat { counts: [64, 1, 1] });
    let few = LabelVolume { counts: [4, 4, 5], ..noise.volume() };
    assert_eq!(error(&few, &all), LabelError::Count { given: 64, counts: [4, 4, 5] });
    let steps = [UNIT[0], UNIT[0], UNIT[2]];
    assert!(matches!(error(&LabelVolume { steps, ..noise.volume() }, &all), LabelError::Steps { .. }));
    let stop = std::sync::atomic::AtomicBool::new(true);
    let cancelled = noise.volume().extract(&all, isostudy_extract::Control::default().with_cancel(&stop));
    assert_eq!(cancelled, Err(LabelError::Extract(ExtractError::Cancelled)));
}
