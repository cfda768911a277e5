//! The cuts fill the cube, neighbours agree, and the counts are the formulas. Streamed, the mesh is that of the stored
//! extractor to the byte, with the same counts and the same trace.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::Vec3;
use isostudy_mesh::Bounds;

use super::cut::{Cut, Step, turn};
use super::{CellStreamer, dense};
use crate::by_lattice::{ExtractSettings, Lattice};
use crate::clock::Moment;
use crate::fields::{FAMILIES, Family, Numbers, Volume};
use crate::placement::spot::tests::normal_lies_between;
use crate::slabs::Run;
use crate::source::{Request, Sampler};
use crate::surface::trace::Trace;
use crate::{Arrangement, CellBox, Clustering, Execution, ExtractError, Extraction, Placement, Topology};
use isostudy_field::{Asteroid, Beyond, Gyroid, MeshDistance, Sphere, StudyField, VolumeField};

const BOTH: [Arrangement; 2] = [Arrangement::FiveTetrahedra, Arrangement::FaceCentred];

fn request<'a>(
    source: Sampler<'a>,
    lattice: &'a Lattice,
    settings: &'a ExtractSettings,
    execution: &'a Execution,
    most_vertices: u32,
) -> Request<'a> {
    let (control, start) = (execution.into(), Moment::now());
    Request {
        source,
        lattice,
        settings,
        control,
        most_vertices,
        normals: Default::default(),
        part: None,
        start,
    }
}

fn tetrahedra_at(cut: &Cut, cell: [i8; 3]) -> impl Iterator<Item = [Step; 4]> + '_ {
    let parity = cell.iter().sum::<i8>() as usize % 2;
    let lowest = cell.map(|i| i * cut.steps_a_cell as i8);
    let moved = move |corner: Step| [0, 1, 2].map(|axis| corner[axis] + lowest[axis]);
    cut.tetrahedra[parity].iter().map(move |tetrahedron| tetrahedron.corners.map(moved))
}

#[test]
fn tetrahedra_turn_one_way_and_fill_the_cube() {
    for (arrangement, sizes) in BOTH.into_iter().zip([vec![2, 1, 1, 1, 1], vec![2; 24]]) {
        let cut = Cut::of(arrangement);
        let cube = 6 * (cut.steps_a_cell as i32).pow(3);
        for parity in 0..2 {
            let volumes: Vec<i32> = tetrahedra_at(&cut, [parity, 0, 0]).map(turn).collect();
            assert_eq!(volumes, sizes, "{arrangement:?}: one regular of a third, or all equal");
            assert_eq!(volumes.iter().sum::<i32>(), cube);
        }
    }
}

/// Each face of a tetrahedron is that of another one, turned over, or on the outside of the block, where the cubes'
/// faces are covered once.
#[test]
fn faces_meet_inside_and_between_cubes() {
    const CELLS: i8 = 3;
    for arrangement in BOTH {
        let cut = Cut::of(arrangement);
        let mut faces: BTreeSet<[Step; 3]> = BTreeSet::new();
        let cells = (0..CELLS.pow(3)).map(|i| [i % CELLS, i / CELLS % CELLS, i / CELLS.pow(2)]);
        for [o, a, b, c] in cells.flat_map(|cell| tetrahedra_at(&cut, cell).collect::<Vec<_>>()) {
            for face in [[a, b, c], [o, c, b], [o, a, c], [o, b, a]] {
                let least = (0..3).min_by_key(|&k| face[k]).unwrap();
                let turned = [0, 1, 2].map(|k| face[(k + least) % 3]);
                assert!(faces.insert(turned), "{arrangement:?}: {turned:?} twice the same way");
            }
        }
        let end = CELLS * cut.steps_a_cell as i8;
        let outside = |face: &[Step; 3]| {
            (0..3).any(|axis| [0, end].iter().any(|&side| face.iter().all(|corner| corner[axis] == side)))
        };
        for &[a, b, c] in &faces {
            assert_ne!(faces.contains(&[a, c, b]), outside(&[a, b, c]), "{arrangement:?}: {:?}", [a, b, c]);
        }
        // Each square of the outside is cut into two or four.
        let triangles_a_square = if arrangement == Arrangement::FiveTetrahedra { 2 } else { 4 };
        let count = faces.iter().filter(|face| outside(face)).count();
        assert_eq!(count, 6 * (CELLS as usize).pow(2) * triangles_a_square);
    }
}

/// What a point of each class is joined to, by mirroring: every symmetry of its surroundings is one of its edges.
#[test]
fn edges_have_the_symmetry_of_their_point() {
    let bits = |arrangement: Arrangement| {
        let counts = Cut::of(arrangement).edges_of.map(u32::count_ones);
        counts.into_iter().filter(|&count| count > 0).collect::<Vec<_>>()
    };
    assert_eq!(bits(Arrangement::FiveTetrahedra), [18, 6], "even corners have the diagonals");
    assert_eq!(bits(Arrangement::FaceCentred), [26, 6, 6, 6, 14], "corner, face centres, cube centre");
    for arrangement in BOTH {
        let cut = Cut::of(arrangement);
        for edges in cut.edges_of {
            let steps: BTreeSet<Step> =
                (0..cut.steps.len()).filter(|d| edges >> d & 1 != 0).map(|d| cut.steps[d]).collect();
            for axis in 0..3 {
                let mirrored: BTreeSet<Step> = steps
                    .iter()
                    .map(|&step| {
                        let mut step = step;
                        step[axis] = -step[axis];
                        step
                    })
                    .collect();
                assert_eq!(steps, mirrored, "{arrangement:?}");
            }
        }
    }
}

/// Points, edges, tetrahedra, and Euler's formula for a ball.
#[test]
fn counts_are_the_formulas() {
    for arrangement in BOTH {
        let cut = Cut::of(arrangement);
        for cells in [[1i8, 1, 1], [2, 1, 3], [4, 3, 2]] {
            let max = Vec3::from_array(cells.map(f32::from));
            let lattice = Lattice::try_new(arrangement, Bounds { min: Vec3::ZERO, max }, 1.0).unwrap();
            let all: Vec<[Step; 4]> = (0..cells[2])
                .flat_map(|z| (0..cells[1]).flat_map(move |y| (0..cells[0]).map(move |x| [x, y, z])))
                .flat_map(|cell| tetrahedra_at(&cut, cell).collect::<Vec<_>>())
                .collect();
            let mut simplices: BTreeMap<usize, BTreeSet<Vec<Step>>> = BTreeMap::new();
            for tetrahedron in &all {
                for set in 1..16usize {
                    let mut corners: Vec<Step> =
                        (0..4).filter(|i| set >> i & 1 != 0).map(|i| tetrahedron[i]).collect();
                    corners.sort_unstable();
                    simplices.entry(corners.len()).or_default().insert(corners);
                }
            }
            let count = |corners: usize| simplices[&corners].len() as u64;
            assert_eq!(count(1), lattice.needed_samples(), "{arrangement:?} {cells:?} points");
            assert_eq!(count(2), lattice.needed_edges(), "{arrangement:?} {cells:?} edges");
            assert_eq!(count(4), lattice.tetrahedra(), "{arrangement:?} {cells:?} tetrahedra");
            assert_eq!(count(1) + count(3), count(2) + count(4) + 1, "a ball");
        }
    }
}

/// Both clusterings that there are, by both topologies.
fn all_settings(isovalue: f32) -> impl Iterator<Item = ExtractSettings> {
    [Clustering::None, Clustering::EdgeCollapse].into_iter().flat_map(move |clustering| {
        [Topology::Guarded, Topology::Published].map(|topology| ExtractSettings {
            isovalue,
            clustering,
            topology,
            ..ExtractSettings::default()
        })
    })
}

/// All ways of the streaming extractor against the dense one.
fn check(
    field: &dyn StudyField,
    lattice: &Lattice,
    all: impl Iterator<Item = ExtractSettings>,
    what: &dyn std::fmt::Debug,
) {
    for settings in all {
        let coordinates = dense::coordinates(lattice, &settings);
        let samples = dense::samples(field, &coordinates);
        let (expected, trace) = dense::extract(field, lattice, &settings);
        let calls = settings.refine_crossings || settings.placement.calls_the_field();
        let given = (!calls).then_some(Sampler::Given { values: &samples, bricks: None });
        for source in [Some(Sampler::Field(field)), given].into_iter().flatten() {
            for threads in [1, 3] {
                let (mut found, mut found_trace) = (Extraction::default(), Trace::default());
                let execution = Execution { threads };
                let kept = Some(&mut found_trace);
                let request = &request(source, lattice, &settings, &execution, u32::MAX);
                let run = Run { request, progress: None, trace: kept, extraction: &mut found };
                CellStreamer::default().extract(run).unwrap();
                let what = format!("{what:?} {:?} {settings:?} {threads} threads", lattice.arrangement());
                assert_eq!(found.counts, expected.counts, "{what}");
                let bits = |points: &[Vec3]| {
                    points.iter().map(|p| p.to_array().map(f32::to_bits)).collect::<Vec<_>>()
                };
                let (found, expected) = (&found.mesh, &expected.mesh);
                assert!(bits(&found.positions) == bits(&expected.positions), "{what}: positions");
                assert!(found.triangles == expected.triangles, "{what}: triangles");
                assert!(bits(&found.normals) == bits(&expected.normals), "{what}: normals");
                assert!(found_trace.keys == trace.keys, "{what}: keys");
                assert!(found_trace.cells == trace.cells, "{what}: cells");
            }
        }
    }
}

/// The lattice of some cells, in a box of their number.
fn lattice(arrangement: Arrangement, cells: [u32; 3]) -> Lattice {
    let max = Vec3::from_array(cells.map(|n| n as f32));
    Lattice::try_new(arrangement, Bounds { min: Vec3::ZERO, max }, 1.0).unwrap()
}

/// Surfaces through every side of the box, ties, zeros, samples that are not numbers, and windows of all that.
#[test]
fn any_samples_give_the_stored_mesh() {
    for (family, seed) in FAMILIES.into_iter().flat_map(|family| (0..6).map(move |seed| (family, seed))) {
        for arrangement in BOTH {
            let volume = Volume::random(arrangement, 6, family, seed);
            let isovalue = [0.0, 0.5, -0.5][seed as usize % 3];
            check(&volume, &volume.lattice(), all_settings(isovalue), &(family, seed));
            let mut numbers = Numbers::new(seed);
            for _ in 0..3 {
                let start: [i32; 3] = std::array::from_fn(|_| numbers.below(6) as i32);
                let end = start.map(|start| start + 1 + numbers.below((6 - start) as u64) as i32);
                let window = volume.lattice().window(CellBox { start, end }).unwrap();
                check(&volume, &window, all_settings(isovalue), &(family, seed, start, end));
            }
        }
    }
}

/// Several slabs, and rows about a word long, on the first line of which something may be left of the row before.
#[test]
fn long_lattices_give_the_stored_mesh() {
    for arrangement in BOTH {
        let steps = Cut::of(arrangement).steps_a_cell as u32;
        for (seed, [x, y, z]) in [
            [1, 1, 80],
            [3, 5, 64],
            [2, 1, 33],
            [62 / steps, 2, 40],
            [63 / steps, 2, 2],
            [64 / steps, 1, 3],
            [65 / steps, 3, 2],
            [127 / steps, 2, 2],
            [128 / steps, 2, 1],
            [130 / steps, 1, 2],
        ]
        .into_iter()
        .enumerate()
        {
            for family in [Family::White, Family::LowPassOnce, Family::Odd] {
                let volume = Volume::random(arrangement, 16, family, seed as u64);
                // Over and over, so that it fills the lattice.
                let field = Repeated(volume, 16.0);
                let settings = all_settings(0.0).filter(|s| s.clustering == Clustering::None);
                check(&field, &lattice(arrangement, [x, y, z]), settings, &(family, seed, x, y, z));
            }
        }
    }
}

/// A field that begins again after some way along each axis.
struct Repeated(Volume, f32);

impl StudyField for Repeated {
    fn sample(&self, p: Vec3) -> f32 {
        self.0.sample(p - (p / self.1).floor() * self.1)
    }
}

/// Fields that say where the surface may be: whole tiles on one side, and some that reach past the lattice.
#[test]
fn fields_with_bounds_give_the_stored_mesh() {
    let bounds = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };
    let rough = Asteroid { amplitude: 0.6, gain: 0.5, ..Asteroid::default() };
    let coarse = Lattice::try_new(Arrangement::BodyCentred, bounds, 0.1).unwrap();
    let solid =
        crate::by_lattice::extract(&rough, &coarse, &ExtractSettings::default(), &Execution { threads: 1 })
            .unwrap();
    let distance = MeshDistance::try_new(&solid.mesh).unwrap();
    let samples = |n: usize| {
        let at = |i: usize| i as f32 / (n - 1) as f32 * 2.0 - 1.0;
        (0..n * n * n).map(|i| rough.sample(Vec3::new(at(i % n), at(i / n % n), at(i / n / n)))).collect()
    };
    let step = 2.0 / 22.0;
    let steps = [[step, 0.0, 0.0], [0.0, 0.8 * step, 0.1], [0.0, 0.0, step]];
    let volume = VolumeField::try_new([23; 3], samples(23), [-1.0; 3], steps, Beyond::Falling).unwrap();
    let fields: [(&dyn StudyField, f32); 8] = [
        (&Sphere { radius: 1.0 }, 0.0),
        (&Sphere { radius: 0.8 }, 0.1),
        (&Asteroid::default(), 0.0),
        (&rough, 0.05),
        (&Gyroid::default(), 0.0),
        (&Gyroid { frequency: 20.0 }, 0.9),
        (&distance, 0.05),
        (&volume, 0.0),
    ];
    for arrangement in BOTH {
        for (i, (field, isovalue)) in fields.into_iter().enumerate() {
            // What edges collapse from is the same, which coarse lattices show as well in a fraction of the time.
            for (spacing, collapses) in [(0.05, false), (0.13, true)] {
                let all = || {
                    let wanted = if collapses { Clustering::EdgeCollapse } else { Clustering::None };
                    all_settings(isovalue).filter(move |settings| settings.clustering == wanted)
                };
                let lattice = Lattice::try_new(arrangement, bounds, spacing).unwrap();
                check(field, &lattice, all(), &(i, spacing));
                let [x, y, z] = lattice.cells().map(|n| n as i32);
                let cells = CellBox { start: [3, 0, 5], end: [x, y - 2, z - 1] };
                check(field, &lattice.window(cells).unwrap(), all(), &(i, spacing, cells));
            }
        }
    }
}

#[test]
fn every_placement_is_that_of_the_stored_mesh() {
    let bounds = Bounds { min: Vec3::NEG_ONE, max: Vec3::new(1.0, 0.9, 1.6) };
    let placements = [Placement::CurvatureWeighted, Placement::Projected, Placement::Relaxed];
    let refined = ExtractSettings { refine_crossings: true, ..ExtractSettings::default() };
    let placed = placements.map(|placement| ExtractSettings { placement, ..ExtractSettings::default() });
    let all = || {
        placed.into_iter().chain([refined]).flat_map(|settings| {
            [Clustering::None, Clustering::EdgeCollapse]
                .map(|clustering| ExtractSettings { clustering, ..settings })
        })
    };
    for arrangement in BOTH {
        let lattice = Lattice::try_new(arrangement, bounds, 0.11).unwrap();
        check(&Asteroid::default(), &lattice, all(), &"asteroid");
        check(&Gyroid::default(), &lattice, all(), &"gyroid");
    }
}

#[test]
fn odd_fields_have_the_stored_mesh() {
    struct Constant(f32);
    impl StudyField for Constant {
        fn sample(&self, _: Vec3) -> f32 {
            self.0
        }
    }
    for arrangement in BOTH {
        for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, 1.0] {
            for isovalue in [0.0, 1.0, f32::MAX, f32::MIN] {
                check(
                    &Constant(value),
                    &lattice(arrangement, [3, 4, 20]),
                    all_settings(isovalue),
                    &(value, isovalue),
                );
            }
        }
    }
}

/// Counts samples.
struct Counting<F>(F, AtomicUsize);

impl<F: StudyField> StudyField for Counting<F> {
    fn sample(&self, p: Vec3) -> f32 {
        self.1.fetch_add(1, Ordering::Relaxed);
        self.0.sample(p)
    }

    fn slope(&self, bounds: Bounds) -> Option<f32> {
        self.0.slope(bounds)
    }
}

#[test]
fn far_from_the_surface_nothing_is_sampled() {
    let bounds = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };
    for arrangement in BOTH {
        let lattice = Lattice::try_new(arrangement, bounds, 2.0 / 96.0).unwrap();
        let settings = ExtractSettings { clustering: Clustering::None, ..ExtractSettings::default() };
        let taken = |field: &Counting<Sphere>| {
            crate::by_lattice::extract(field, &lattice, &settings, &Execution { threads: 1 }).unwrap();
            field.1.load(Ordering::Relaxed) as f64 / lattice.needed_samples() as f64
        };
        let taken = taken(&Counting(Sphere { radius: 0.8 }, AtomicUsize::new(0)));
        assert!(taken < 0.12, "{arrangement:?}: {taken} of all points");
    }
}

#[test]
fn more_vertices_than_may_be_are_an_error() {
    let bounds = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };
    let settings = ExtractSettings { clustering: Clustering::None, ..ExtractSettings::default() };
    for arrangement in BOTH {
        let lattice = Lattice::try_new(arrangement, bounds, 0.05).unwrap();
        for threads in [1, 2] {
            let run = |most| {
                let (mut found, execution) = (Extraction::default(), Execution { threads });
                let source = Sampler::Field(&Sphere { radius: 0.8 });
                let request = &request(source, &lattice, &settings, &execution, most);
                let run = Run { request, progress: None, trace: None, extraction: &mut found };
                CellStreamer::default().extract(run)?;
                Ok(found.mesh.positions.len() as u32)
            };
            let all = run(u32::MAX).unwrap();
            assert_eq!(run(all), Ok(all));
            for limit in [all - 1, all / 8, 0] {
                assert_eq!(run(limit), Err(ExtractError::TooManyVertices { limit }));
            }
        }
    }
}

/// So that a sample that equals the isovalue turns no triangle over ([`crate::placement::spot::Apart`]).
#[test]
fn normals_of_faces_lie_between_the_edges_that_lead_there() {
    for arrangement in BOTH {
        let cut = Cut::of(arrangement);
        for corners in (0..2).flat_map(|parity| tetrahedra_at(&cut, [parity, 0, 0]).collect::<Vec<_>>()) {
            let corners = corners.map(|corner| glam::DVec3::from_array(corner.map(f64::from)));
            for from in 0..4 {
                let edges = [1, 2, 3].map(|k| corners[(from + k) % 4] - corners[from]);
                assert!(normal_lies_between(edges), "{arrangement} {corners:?}");
            }
        }
    }
}
