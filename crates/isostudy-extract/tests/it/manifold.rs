//! The guarantee: whatever the samples, guarded extraction gives a manifold with the components, genus and boundary
//! loops of the unclustered surface.
//!
//! Each volume is extracted with every clustering. The unclustered surface is checked first, then the others against
//! it, by this file's own survey and by the `mesh` crate's checker. `cargo test --release -p isostudy-extract -- --ignored`
//! runs the long form.

use crate::fields::{FAMILIES, Family, Volume, image};
use crate::survey::{Component, survey};
use isostudy_extract::by_lattice::{ExtractSettings, extract};
use isostudy_extract::{Arrangement, Clustering, Counts, Execution, Extraction, Topology};
use isostudy_mesh::topology::topology;
use rayon::prelude::*;

const ARRANGEMENTS: [Arrangement; 2] = [Arrangement::BodyCentred, Arrangement::SimpleCubic];
const MERGING: [Clustering; 3] =
    [Clustering::Integrated, Clustering::EdgeCollapse, Clustering::IntegratedCollapse];

fn run(volume: &Volume, clustering: Clustering, topology: Topology) -> Extraction {
    let settings = ExtractSettings::default().with_clustering(clustering).with_topology(topology);
    extract(volume, &volume.lattice(), &settings, &Execution { threads: 1 }).unwrap()
}

/// The components of a guarded mesh, after both checkers have found nothing wrong, and its counts.
fn components(volume: &Volume, clustering: Clustering) -> Result<(Vec<Component>, Counts), String> {
    let Extraction { mesh, counts, .. } = run(volume, clustering, Topology::Guarded);
    let found = survey(mesh.positions.len(), &mesh.triangles)?;
    let report = topology(&mesh);
    let faults = [
        report.unused_vertices,
        report.collapsed_triangles,
        report.non_manifold_edges,
        report.misoriented_edges,
        report.non_manifold_vertices,
        report.duplicate_faces,
    ];
    if faults != [0; 6] {
        return Err(format!("{report:?}"));
    }
    let sums = (
        found.len() as u64,
        found.iter().map(|c| c.0).sum::<i64>(),
        found.iter().map(|c| c.1).sum::<usize>() as u64,
    );
    assert_eq!(sums, (report.components, report.euler_characteristic, report.boundary_loops));
    Ok((found, counts))
}

/// The components of the unclustered surface, which all clusterings must keep.
fn check(volume: &Volume, closed: bool, what: &str) -> Vec<Component> {
    let (plain, of_plain) =
        components(volume, Clustering::None).unwrap_or_else(|fault| panic!("{what}: {fault}"));
    assert_eq!((of_plain.vertices, of_plain.discarded_triangles), (of_plain.crossings, 0), "{what}");
    assert!(!closed || plain.iter().all(|component| component.1 == 0), "{what} is open");
    for clustering in MERGING {
        let (merged, counts) =
            components(volume, clustering).unwrap_or_else(|fault| panic!("{what} {clustering:?}: {fault}"));
        assert_eq!(merged, plain, "{what} {clustering:?}");
        // Clustering only takes away.
        assert_eq!(
            counts.triangles + counts.discarded_triangles,
            of_plain.triangles,
            "{what} {clustering:?}"
        );
        let as_published = counts.tetrahedra.unwrap().discarded_as_published;
        assert!(as_published >= counts.discarded_triangles, "{what} {clustering:?}");
        assert!(counts.vertices <= of_plain.vertices && counts.crossings == of_plain.crossings, "{what}");
    }
    plain
}

/// Returns how many volumes were checked.
fn sweep(cells: usize, seeds: std::ops::Range<u64>) -> usize {
    let volumes: Vec<_> = seeds
        .flat_map(|seed| FAMILIES.into_iter().map(move |family| (family, seed)))
        .flat_map(|(family, seed)| ARRANGEMENTS.map(|arrangement| (family, seed, arrangement)))
        .collect();
    volumes.par_iter().for_each(|&(family, seed, arrangement)| {
        let what = format!("{family:?} seed {seed} {arrangement:?} {cells} cells");
        let volume = Volume::random(arrangement, cells, family, seed);
        check(&volume, false, &format!("open {what}"));
        let closed = volume.closed();
        check(&closed, true, &format!("closed {what}"));
        if family != Family::Odd {
            let mesh = run(&closed, Clustering::None, Topology::Guarded).mesh;
            assert!(mesh.triangles.is_empty() || mesh.volume() > 0.0, "{what} faces inward");
        }
    });
    2 * volumes.len()
}

#[test]
fn random_volumes() {
    assert_eq!(sweep(4, 0..12) + sweep(2, 0..12) + sweep(1, 0..12), 2160);
}

#[test]
#[ignore = "minutes: run by make test-long"]
fn ten_thousand_random_volumes_and_more() {
    let checked = [(5, 0..400), (3, 0..400), (1, 0..400), (9, 0..40), (16, 0..4)]
        .into_iter()
        .map(|(cells, seeds)| sweep(cells, seeds.start + 1000..seeds.end + 1000))
        .sum::<usize>();
    println!("{checked} volumes, {} meshes", 4 * checked);
    assert!(checked > 10_000);
}

/// A point inside, at `[0, 0, 0]`, others by their place on the simple cubic lattice, and a value for the rest.
struct Pattern {
    name: &'static str,
    samples: Vec<([i32; 3], f32)>,
    rest: f32,
    /// Euler characteristic of each component.
    characteristics: &'static [i64],
}

/// One sample inside, 2; `others` are -1.
fn one_inside(name: &'static str, others: &[[i32; 3]]) -> Pattern {
    let samples = [([0; 3], 2.0)].into_iter().chain(others.iter().map(|&at| (at, -1.0))).collect();
    Pattern { name, samples, rest: -9.0, characteristics: &[2] }
}

/// The counterexamples to other rules, of the two analyses in docs/manifold.md.
fn counterexamples() -> Vec<Pattern> {
    let inside = |value: f32, points: &[[i32; 3]]| points.iter().map(|&at| (at, value)).collect::<Vec<_>>();
    let neighbours = [-1, 1].map(|way| {
        [[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0], [1, 0, 1], [0, 1, 1], [1, 1, 1]]
            .map(|step: [i32; 3]| step.map(|c| c * way))
    });
    let neighbours = neighbours.concat();
    // One point of value 1, some neighbours at -3 and the rest at -0.5: only the first are near.
    let near_three = [[1, 0, 0], [0, 1, 0], [1, 1, 1]];
    let far_three = [[1, 0, 0], [1, 1, 0], [0, 1, 0]];
    let split = |name, near: &dyn Fn([i32; 3]) -> bool| Pattern {
        name,
        samples: [([0; 3], 1.0)]
            .into_iter()
            .chain(neighbours.iter().map(|&at| (at, if near(at) { -3.0 } else { -0.5 })))
            .collect(),
        rest: -0.5,
        characteristics: &[2],
    };
    vec![
        one_inside("eleven near", &[[0, -1, -1], [0, 0, -1], [0, 1, 0]]),
        one_inside("eight near", &[[-1, 0, -1], [-1, -1, 0], [0, -1, 0], [-1, 0, 0], [1, 0, 0], [0, 0, 1]]),
        one_inside(
            "eight near, flat",
            &[[0, -1, -1], [0, 0, -1], [1, 1, 0], [1, 0, 1], [0, 1, 1], [1, 1, 1]],
        ),
        one_inside("thirteen near", &[[-1, 0, 0]]),
        one_inside("doubled triangle", &[[1, 0, 0], [1, 0, 1]]),
        Pattern { name: "lone point", samples: vec![([0; 3], 1.0)], rest: -9.0, characteristics: &[2] },
        Pattern {
            name: "handle",
            samples: [
                inside(2.0, &[[0, 0, 0], [1, 1, 0], [0, 1, 1], [1, 2, 1]]),
                inside(-1.0, &[[0, 1, 0], [1, 1, 1]]),
            ]
            .concat(),
            rest: -9.0,
            characteristics: &[0],
        },
        split("three near", &|at| near_three.contains(&at)),
        split("three far", &|at| !far_three.contains(&at)),
        Pattern {
            name: "two clusters, each harmless",
            samples: inside(1.0, &[[0, 0, 0], [1, 1, 0], [1, 1, 1], [0, 0, -1]]),
            rest: -3.0,
            characteristics: &[2],
        },
    ]
}

impl Pattern {
    /// With `[0, 0, 0]` at a place in half cells, and all signs turned over if asked for.
    fn volume(&self, arrangement: Arrangement, cells: usize, place: [i32; 3], sign: f32) -> Volume {
        let mut volume = Volume::filled(arrangement, cells, sign * self.rest);
        for &(at, value) in &self.samples {
            let step = image(arrangement, at);
            volume.set([0, 1, 2].map(|axis| place[axis] + step[axis]), sign * value);
        }
        volume
    }
}

#[test]
fn counterexamples_inside_the_volume() {
    for pattern in counterexamples() {
        for arrangement in ARRANGEMENTS {
            let volume = pattern.volume(arrangement, 8, [8; 3], 1.0);
            let found = check(&volume, true, &format!("{} {arrangement:?}", pattern.name));
            let characteristics: Vec<i64> = found.iter().map(|component| component.0).collect();
            assert_eq!(characteristics, pattern.characteristics, "{} {arrangement:?}", pattern.name);
            let turned = pattern.volume(arrangement, 8, [8; 3], -1.0);
            check(&turned, false, &format!("turned {} {arrangement:?}", pattern.name));
        }
    }
}

#[test]
fn counterexamples_cut_by_the_boundary() {
    for pattern in counterexamples() {
        for arrangement in ARRANGEMENTS {
            for cells in [1, 2, 3] {
                for place in Volume::filled(arrangement, cells, 0.0).places() {
                    for sign in [1.0, -1.0] {
                        let what = format!("{} {arrangement:?} {cells} cells at {place:?}", pattern.name);
                        check(&pattern.volume(arrangement, cells, place, sign), false, &what);
                    }
                }
            }
        }
    }
}

/// The checks can fail: the published rules break nearly all of the same volumes.
#[test]
fn published_rules_fail_the_same_checks() {
    for arrangement in ARRANGEMENTS {
        let broken = |family, clustering| {
            let fails = |&seed: &u64| {
                let volume = Volume::random(arrangement, 5, family, seed).closed();
                let mesh = run(&volume, clustering, Topology::Published).mesh;
                survey(mesh.positions.len(), &mesh.triangles).is_err()
            };
            (0..20).filter(fails).count()
        };
        for clustering in MERGING {
            assert!(broken(Family::White, clustering) >= 18, "{arrangement:?} {clustering:?}");
            assert!(broken(Family::LowPassOnce, clustering) >= 15, "{arrangement:?} {clustering:?}");
        }
    }
}
