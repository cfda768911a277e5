//! Structures that find the cells of a surface, against the rule itself; and extractions that leave bricks out, against those that do
//! not.

#[path = "../../../isostudy-volume/benches/isovalues"]
mod bench {
    pub(super) mod structures;
}

use std::collections::BTreeSet;

use bench::structures::{IntervalTree, KdTree, Octree, Scan, SeedSet, SpanSpace};
use glam::Vec3;
use isostudy_extract::active::{ActiveCells, ActiveError, Bricks, GridSamples};
use isostudy_extract::{
    BoxGrid, Execution, ExtractError, Extractor, Method, MethodError, Source, VolumeCells, VolumeCellsError,
    presets,
};
use isostudy_mesh::Bounds;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

#[test]
fn bricks_take_what_was_said_before_there_were_any() {
    for counts in [[2, 2, 2], [9, 10, 11], [3, 40, 17], [66, 5, 9]] {
        let values = vec![0.5; counts.iter().product()];
        let bricks = Bricks::try_new(GridSamples::try_new(counts, &values).unwrap()).unwrap();
        assert_eq!(Bricks::bytes_of(counts), bricks.bytes() as u64, "{counts:?}");
    }
}

/// By corners, one by one.
fn by_the_rule(counts: [usize; 3], values: &[f32], isovalue: f32) -> BTreeSet<u32> {
    let [nx, ny, nz] = counts;
    let mut active = BTreeSet::new();
    for z in 0..nz - 1 {
        for y in 0..ny - 1 {
            for x in 0..nx - 1 {
                let above = (0..8)
                    .filter(|c| {
                        let (i, j, k) = (x + (c & 1), y + (c >> 1 & 1), z + (c >> 2));
                        values[i + nx * (j + ny * k)] > isovalue
                    })
                    .count();
                if above != 0 && above != 8 {
                    active.insert((x + (nx - 1) * (y + (ny - 1) * z)) as u32);
                }
            }
        }
    }
    active
}

/// Values of samples, what lies between them, and what lies beyond.
fn isovalues(values: &[f32]) -> Vec<f32> {
    let mut known: Vec<f32> = values.iter().copied().filter(|v| v.is_finite()).collect();
    known.sort_by(f32::total_cmp);
    known.dedup();
    // Of many, some, the first and the last among them.
    let step = known.len() / 40 + 1;
    let last = known.last().copied();
    let mut some: Vec<f32> = known.into_iter().step_by(step).chain(last).collect();
    let between: Vec<f32> = some.windows(2).map(|pair| pair[0] + (pair[1] - pair[0]) / 2.0).collect();
    let beside: Vec<f32> = some.iter().flat_map(|v| [v.next_down(), v.next_up()]).collect();
    some.extend(between);
    some.extend(beside);
    some.extend([f32::NEG_INFINITY, f32::INFINITY, f32::NAN, f32::MIN, f32::MAX, 0.0, -0.0]);
    some
}

struct Volume {
    name: String,
    counts: [usize; 3],
    values: Vec<f32>,
}

impl Volume {
    fn new(name: &str, counts: [usize; 3], mut value: impl FnMut([usize; 3]) -> f32) -> Self {
        let [nx, ny, nz] = counts;
        let values = (0..nx * ny * nz).map(|i| value([i % nx, i / nx % ny, i / nx / ny])).collect();
        Self { name: format!("{name} {counts:?}"), counts, values }
    }

    fn samples(&self) -> GridSamples<'_> {
        GridSamples::try_new(self.counts, &self.values).unwrap()
    }
}

const SIZES: [[usize; 3]; 8] =
    [[2, 2, 2], [3, 2, 9], [9, 9, 9], [17, 8, 10], [5, 70, 3], [66, 3, 4], [10, 10, 18], [21, 20, 19]];

fn volumes() -> Vec<Volume> {
    let mut random = Pcg64Mcg::seed_from_u64(3);
    let mut all = Vec::new();
    for counts in SIZES {
        all.push(Volume::new("noise", counts, |_| random.random_range(-1.0..1.0)));
        for levels in [2, 3, 7] {
            all.push(Volume::new("levels", counts, |_| random.random_range(0..levels) as f32));
        }
        // Terraces: wide plateaus, and steps between them.
        let centre = counts.map(|n| n as f32 * 0.43);
        let away = |p: [usize; 3]| (0..3).map(|k| (p[k] as f32 - centre[k]).powi(2)).sum::<f32>().sqrt();
        all.push(Volume::new("terraces", counts, |p| (away(p) / 2.5).floor()));
        all.push(Volume::new("ball", counts, |p| 3.0 - away(p)));
        all.push(Volume::new("constant", counts, |_| 2.5));
        all.push(Volume::new("checkers", counts, |p| (p.iter().sum::<usize>() % 2) as f32));
        all.push(Volume::new("spike", counts, |p| f32::from(p == [counts[0] / 2, 1, counts[2] - 1])));
        all.push(Volume::new("ramp", counts, |p| (p[0] + 2 * p[1]) as f32));
        all.push(Volume::new("both zeros", counts, |_| [0.0, -0.0, 1.0][random.random_range(0..3)]));
        let odd = [0.0, 1.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
        all.push(Volume::new("no numbers", counts, |_| odd[random.random_range(0..odd.len())]));
        all.push(Volume::new("NaN", counts, |_| f32::NAN));
    }
    all
}

#[test]
fn every_structure_finds_the_active_cells_and_no_other() {
    let mut found = Vec::new();
    for volume in volumes() {
        let samples = volume.samples();
        let structures: [(&str, Box<dyn ActiveCells + '_>); 7] = [
            ("scan", Box::new(Scan::new(samples))),
            ("bricks", Box::new(Bricks::try_new(samples).unwrap())),
            ("octree", Box::new(Octree::try_new(samples).unwrap())),
            ("span space", Box::new(SpanSpace::try_new(samples).unwrap())),
            ("k-d tree", Box::new(KdTree::try_new(samples).unwrap())),
            ("interval tree", Box::new(IntervalTree::try_new(samples).unwrap())),
            ("seeds", Box::new(SeedSet::try_new(samples).unwrap())),
        ];
        for isovalue in isovalues(&volume.values) {
            let expected = by_the_rule(volume.counts, &volume.values, isovalue);
            for (name, structure) in &structures {
                structure.find(isovalue, &mut found);
                let set: BTreeSet<u32> = found.iter().copied().collect();
                assert_eq!(
                    set.len(),
                    found.len(),
                    "{name} names a cell twice: {} at {isovalue}",
                    volume.name
                );
                assert_eq!(set, expected, "{name}: {} at {isovalue}", volume.name);
            }
        }
    }
}

/// Wilhelms and Van Gelder's: less than a sixth of a node for each cell, whatever the sizes; a seventh at powers of two.
#[test]
fn the_octree_has_a_node_for_seven_cells() {
    for (cells, share) in [(64, 0.1429), (65, 0.152), (100, 0.1432), (129, 0.1474)] {
        let values = vec![0.0; (cells + 1usize).pow(3)];
        let octree = Octree::try_new(GridSamples::try_new([cells + 1; 3], &values).unwrap()).unwrap();
        let found = octree.nodes() as f64 / cells.pow(3) as f64;
        assert!((found - share).abs() < 1e-3, "{cells}: {found}");
    }
}

/// Most cells leave what they are active at to the next ones.
#[test]
fn seeds_are_fewer_than_cells_where_the_samples_are_smooth() {
    let volume = Volume::new("ball", [40; 3], |p| (0..3).map(|k| (p[k] as f32 - 19.3).powi(2)).sum());
    let cells = 39usize.pow(3);
    let seeds = SeedSet::try_new(volume.samples()).unwrap().seeds();
    assert!(seeds > 0 && seeds < cells / 3, "{seeds} of {cells}");
}

#[test]
fn what_is_no_grid_is_refused() {
    let error = |counts, samples| GridSamples::try_new(counts, &vec![0.0; samples]).unwrap_err();
    for (counts, samples) in [([2, 2, 2], 7), ([1, 4, 4], 16), ([0, 2, 2], 0), ([usize::MAX, 2, 2], 8)] {
        assert_eq!(error(counts, samples), ActiveError::Counts { counts, samples });
    }
}

fn all_methods() -> impl Iterator<Item = (&'static str, Method)> {
    presets().iter().map(|preset| (preset.id, preset.method))
}

/// The mesh, and every count, on one thread and on three.
#[test]
fn bricks_leave_the_mesh_as_it_is() {
    let steps = [[1.0, 0.0, 0.0], [0.0, 1.5, 0.0], [0.25, 0.0, 2.0]];
    let mut methods = 0;
    for (id, method) in all_methods().filter(|(_, method)| method.is_of_cubes()) {
        methods += 1;
        for volume in volumes().iter().filter(|volume| volume.counts.iter().product::<usize>() > 1000) {
            let cells =
                VolumeCells { counts: volume.counts, values: &volume.values, origin: [1.0; 3], steps };
            let bricks = cells.bricks().unwrap();
            for isovalue in [0.0, 1.0, 0.5, -3.0, 2.5] {
                let mut extractor = Extractor::new();
                let plain =
                    cells.extract(&method, &mut extractor, isovalue, &Execution { threads: 1 }).unwrap();
                for threads in [1, 3] {
                    let execution = Execution { threads };
                    let found = cells
                        .extract_by_bricks(&bricks, &method, &mut extractor, isovalue, &execution)
                        .unwrap();
                    let what = format!("{id}: {} at {isovalue}, {threads} threads", volume.name);
                    assert_eq!(found.counts, plain.counts, "{what}");
                    assert_eq!(found.mesh.triangles, plain.mesh.triangles, "{what}");
                    let bits = |points: &[Vec3]| -> Vec<[u32; 3]> {
                        points.iter().map(|p| p.to_array().map(f32::to_bits)).collect()
                    };
                    assert_eq!(bits(&found.mesh.positions), bits(&plain.mesh.positions), "{what}");
                    assert_eq!(bits(&found.mesh.normals), bits(&plain.mesh.normals), "{what}");
                }
            }
        }
    }
    assert!(methods >= 7);
}

/// The extractor looks for triangles in the active cells and in no other.
#[test]
fn cells_visited_are_the_active_ones() {
    let mc = all_methods().find(|(id, _)| *id == "mc").unwrap().1;
    for volume in volumes() {
        let cells = VolumeCells {
            counts: volume.counts,
            values: &volume.values,
            origin: [0.0; 3],
            steps: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        };
        let bricks = cells.bricks().unwrap();
        for isovalue in [0.0, 0.5, 1.0, 2.5] {
            let execution = Execution { threads: 1 };
            let found =
                cells.extract_by_bricks(&bricks, &mc, &mut Extractor::new(), isovalue, &execution).unwrap();
            let active = by_the_rule(volume.counts, &volume.values, isovalue).len();
            assert_eq!(found.counts.cells_visited, active as u64, "{} at {isovalue}", volume.name);
        }
    }
}

#[test]
fn bricks_of_other_samples_are_refused_and_other_lattices_do_without() {
    let volume = Volume::new("ball", [9, 8, 7], |p| 3.0 - (p[0] as f32 - 4.2).hypot(p[1] as f32 - 3.3));
    let bricks = Bricks::try_new(volume.samples()).unwrap();
    let max = Vec3::from_array([8.0, 7.0, 6.0]);
    let grid = BoxGrid { bounds: Bounds { min: Vec3::ZERO, max }, spacing: 1.0 };
    let execution = Execution { threads: 1 };
    let su = all_methods().find(|(id, _)| *id == "su").unwrap().1;
    let mesh = |source| su.extract(&mut Extractor::new(), source, &grid, 0.0, &execution).unwrap().mesh;
    let (by_bricks, plain) = (mesh(Source::Bricks(&bricks)), mesh(Source::Samples(&volume.values)));
    assert!(!plain.triangles.is_empty());
    assert_eq!((by_bricks.triangles, by_bricks.positions), (plain.triangles, plain.positions));

    let other = Volume::new("other", [9, 7, 8], |_| 0.0);
    let cells = VolumeCells {
        counts: other.counts,
        values: &other.values,
        origin: [0.0; 3],
        steps: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    };
    let mc = all_methods().find(|(id, _)| *id == "mc").unwrap().1;
    let error = cells.extract_by_bricks(&bricks, &mc, &mut Extractor::new(), 0.0, &execution).unwrap_err();
    let expected = ExtractError::BrickCounts { given: [9, 8, 7], wanted: [9, 7, 8] };
    assert_eq!(error, VolumeCellsError::Extract(MethodError::Extract(expected)));
}
