//! What terrains promise: bounds that hold, closed surfaces, and the character that their name says.

use extract::{Arrangement, Clustering, Execution, ExtractSettings, Lattice, extract};
use field::{ScalarField, Terrain, TerrainCharacter, TerrainError, TerrainSettings};
use glam::Vec3;
use mesh::topology::topology;
use mesh::{Bounds, TriangleMesh};
use proptest::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

const BOUNDS: Bounds = Terrain::DEFAULT_BOUNDS;

fn terrain(settings: TerrainSettings) -> Terrain {
    Terrain::try_new(settings, BOUNDS).unwrap()
}

fn of(character: TerrainCharacter, seed: u32) -> Terrain {
    terrain(character.settings(seed))
}

fn mesh_of(field: &dyn ScalarField, bounds: Bounds, arrangement: Arrangement, cells: u32) -> TriangleMesh {
    let lattice = Lattice::try_new(arrangement, bounds, bounds.spacing_of_cells(cells)).unwrap();
    let clustering =
        if arrangement.supports(Clustering::Integrated) { Clustering::Integrated } else { Clustering::None };
    let settings = ExtractSettings { clustering, ..ExtractSettings::default() };
    extract(field, &lattice, &settings, &Execution { threads: 1 }).unwrap().mesh
}

/// How often vertical lines meet the ground between the walls, in finer steps than any feature has; the most of them.
fn most_crossings(terrain: &Terrain) -> usize {
    let width = terrain.bounds().size().x;
    let along = |x: f32, y: f32| {
        let sides: Vec<bool> = (0..500)
            .map(|i| terrain.sample(Vec3::new(x, y, -0.5 + 0.03 * width + i as f32 * 0.0018)) > 0.0)
            .collect();
        sides.windows(2).filter(|pair| pair[0] != pair[1]).count()
    };
    let at = |i: usize| -0.9 + 1.8 * i as f32 / 30.0;
    (0..31 * 31).map(|i| along(at(i % 31), at(i / 31))).max().unwrap()
}

#[test]
fn hills_are_met_once_and_cliffs_lean_over() {
    for seed in 1..4 {
        assert_eq!(most_crossings(&of(TerrainCharacter::Hills, seed)), 1, "hills {seed}");
        assert!(most_crossings(&of(TerrainCharacter::Cliffs, seed)) >= 3, "cliffs {seed}");
        let upright = TerrainSettings { overhang: 0.0, ..TerrainCharacter::Cliffs.settings(seed) };
        assert_eq!(most_crossings(&terrain(upright)), 1, "cliffs without overhangs {seed}");
    }
}

#[test]
fn characters_have_the_topology_of_their_names() {
    for seed in 1..4 {
        let hills =
            topology(&mesh_of(&of(TerrainCharacter::Hills, seed), BOUNDS, Arrangement::BodyCentred, 50));
        assert_eq!((hills.components, hills.euler_characteristic), (1, 2), "hills {seed}");
        // Each handle takes two from the characteristic of its component, which otherwise has two.
        let caves =
            topology(&mesh_of(&of(TerrainCharacter::Caves, seed), BOUNDS, Arrangement::BodyCentred, 50));
        let handles = caves.components as i64 - caves.euler_characteristic / 2;
        assert!(handles > 20, "caves {seed}: {handles} handles");
    }
    // Small shifts turn the ground without tearing it.
    let whole =
        TerrainSettings { overhang: 0.0225, overhang_period: 0.18, ..TerrainCharacter::Cliffs.settings(2) };
    let whole = TerrainSettings { ground: 0.25, relief: 0.2, ..whole };
    let mesh = mesh_of(&terrain(whole), BOUNDS, Arrangement::BodyCentred, 160);
    assert_eq!((topology(&mesh).components, topology(&mesh).euler_characteristic), (1, 2));
}

#[test]
fn closed_terrains_have_no_boundary_on_any_lattice() {
    for character in TerrainCharacter::ALL {
        for seed in 1..4 {
            let field = of(character, seed);
            for arrangement in Arrangement::ALL {
                for (cells, margin) in [(9, 0.0), (17, 0.06), (26, 0.01)] {
                    let field = terrain(TerrainSettings { margin, ..*field.settings() });
                    let report = topology(&mesh_of(&field, BOUNDS, arrangement, cells));
                    assert!(report.triangles > 100, "{character} {seed} {arrangement} {cells}");
                    assert_eq!(
                        (report.boundary_edges, report.non_manifold_edges),
                        (0, 0),
                        "{character} {seed} {arrangement} {cells}"
                    );
                    assert!(report.is_closed_manifold(), "{character} {seed} {arrangement} {cells}");
                }
            }
        }
        // And open where it is asked to be.
        let open = terrain(TerrainSettings { closed: false, ..character.settings(1) });
        let report = topology(&mesh_of(&open, BOUNDS, Arrangement::BodyCentred, 30));
        assert!(report.boundary_edges > 100 && report.non_manifold_edges == 0, "{character}");
    }
}

#[test]
fn walls_stand_at_the_margin() {
    let settings = TerrainSettings { margin: 0.05, ..TerrainSettings::default() };
    let mesh = mesh_of(&terrain(settings), BOUNDS, Arrangement::BodyCentred, 50);
    let (low, high) = mesh
        .positions
        .iter()
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)));
    // A width is 2.
    for (found, wanted) in [(low.x, -0.9), (low.y, -0.9), (low.z, -0.4), (high.x, 0.9), (high.y, 0.9)] {
        assert!((found - wanted).abs() < 1e-5, "{found} for {wanted}");
    }
    assert!((-0.4..0.4).contains(&high.z));
}

/// Shares of space between the walls and well below the ground.
#[test]
fn caves_take_the_share_they_are_asked_for() {
    for share in [0.05, 0.1, 0.2] {
        let (mut hollow, mut all) = (0, 0);
        for seed in 1..9 {
            let settings = TerrainSettings {
                ground: 10.0,
                closed: false,
                caves: share,
                cave_period: 0.1,
                ..TerrainCharacter::Caves.settings(seed)
            };
            let field = terrain(settings);
            for i in 0..30 * 30 * 30 {
                let at = Vec3::new((i % 30) as f32, (i / 30 % 30) as f32, (i / 900) as f32) / 30.0;
                hollow += usize::from(field.sample(BOUNDS.min + at * BOUNDS.size()) <= 0.0);
                all += 1;
            }
        }
        let found = hollow as f64 / all as f64;
        println!("{share}: {found}");
        assert!((0.75..1.25).contains(&(found / share)), "{share}: {found}");
    }
}

/// Counts samples, and tells of bounds or does not.
struct Watched<'a> {
    field: &'a Terrain,
    tells: bool,
    samples: AtomicUsize,
}

impl ScalarField for Watched<'_> {
    fn sample(&self, p: Vec3) -> f32 {
        self.samples.fetch_add(1, Ordering::Relaxed);
        self.field.sample(p)
    }

    fn range(&self, bounds: Bounds, value: f32) -> Option<(f32, f32)> {
        if self.tells { self.field.range(bounds, value) } else { None }
    }

    fn slope(&self, bounds: Bounds) -> Option<f32> {
        if self.tells { self.field.slope(bounds) } else { None }
    }
}

#[test]
fn pruning_saves_samples_and_changes_no_byte() {
    for (character, share) in
        [(TerrainCharacter::Hills, 0.2), (TerrainCharacter::Cliffs, 0.4), (TerrainCharacter::Caves, 0.5)]
    {
        for closed in [true, false] {
            let field = terrain(TerrainSettings { closed, ..character.settings(7) });
            for arrangement in [Arrangement::BodyCentred, Arrangement::SimpleCubic] {
                let mut found = Vec::new();
                for tells in [false, true] {
                    let watched = Watched { field: &field, tells, samples: AtomicUsize::new(0) };
                    let mesh = mesh_of(&watched, BOUNDS, arrangement, 100);
                    found.push((mesh, watched.samples.into_inner()));
                }
                let [plain, pruned] = [&found[0], &found[1]];
                assert_eq!(plain.0, pruned.0, "{character} {arrangement}");
                println!("{character} {closed} {arrangement}: {} of {}", pruned.1, plain.1);
                assert!(
                    (pruned.1 as f64) < share * plain.1 as f64,
                    "{character}: {} of {}",
                    pruned.1,
                    plain.1
                );
            }
        }
    }
}

#[test]
fn threads_and_clusterings_do_not_matter() {
    let field = of(TerrainCharacter::Caves, 3);
    let lattice = Lattice::try_new(Arrangement::BodyCentred, BOUNDS, 0.04).unwrap();
    for clustering in [Clustering::None, Clustering::Integrated] {
        let settings = ExtractSettings { clustering, ..ExtractSettings::default() };
        let [one, two] =
            [1, 2].map(|threads| extract(&field, &lattice, &settings, &Execution { threads }).unwrap().mesh);
        assert_eq!(one, two);
    }
}

#[test]
fn a_larger_box_has_the_same_terrain() {
    let settings = TerrainCharacter::Caves.settings(5);
    let scaled = Bounds { min: BOUNDS.min * 8.0, max: BOUNDS.max * 8.0 };
    let (small, large) = (terrain(settings), Terrain::try_new(settings, scaled).unwrap());
    for i in 0..1000 {
        let t = i as f32;
        let p = Vec3::new((t * 0.37).sin(), (t * 0.71).cos(), (t * 0.13).sin() * 0.5);
        assert_eq!((small.sample(p) * 8.0).to_bits(), large.sample(p * 8.0).to_bits());
    }
}

#[test]
fn seeds_differ_and_what_is_no_place_has_no_value() {
    let [a, b] = [1, 2].map(|seed| of(TerrainCharacter::Hills, seed));
    let differing = (0..100).filter(|&i| {
        let p = Vec3::new(i as f32 * 0.017 - 0.83, 0.21, -0.1);
        (a.sample(p) - b.sample(p)).abs() > 1e-3
    });
    assert!(differing.count() > 90);
    for p in [Vec3::NAN, Vec3::new(0.0, f32::INFINITY, 0.0), Vec3::new(0.0, 0.0, f32::NAN)] {
        assert!(of(TerrainCharacter::Caves, 1).sample(p).is_nan(), "{p}");
    }
}

#[test]
fn errors_name_the_setting_and_what_is_allowed() {
    let base = TerrainSettings::default();
    let message = |settings| Terrain::try_new(settings, BOUNDS).unwrap_err().to_string();
    for (settings, wanted) in [
        (TerrainSettings { octaves: 17, ..base }, "`octaves` = 17: it has to be 1 to 16"),
        (TerrainSettings { gain: f64::NAN, ..base }, "`gain` = NaN: it has to be 0 to 1"),
        (TerrainSettings { period: 0.0, ..base }, "`period` = 0: it has to be 0.001 to 100"),
        (TerrainSettings { caves: 0.6, ..base }, "`caves` = 0.6: it has to be 0 to 0.5"),
        (
            TerrainSettings { ridged: 0.6, billowed: 0.5, ..base },
            "`billowed` = 0.5: it has to be 0 to 1, and at most 1 with `ridged`",
        ),
        (
            TerrainSettings { terrace: 1e-9, ..base },
            "`terrace` = 0.000000001: it has to be 0, or 0.001 to 10",
        ),
        (TerrainSettings { margin: -0.1, ..base }, "`margin` = -0.1: it has to be 0 to 0.25"),
    ] {
        assert_eq!(message(settings), wanted);
    }
    for bounds in [
        Bounds { min: Vec3::ONE, max: Vec3::ONE },
        Bounds { min: Vec3::ZERO, max: Vec3::new(1.0, -1.0, 1.0) },
        Bounds { min: Vec3::ZERO, max: Vec3::INFINITY },
        Bounds { min: Vec3::NAN, max: Vec3::ONE },
    ] {
        assert_eq!(Terrain::try_new(base, bounds).unwrap_err(), TerrainError::Bounds);
    }
    let unknown = "dunes".parse::<TerrainCharacter>().unwrap_err().to_string();
    assert_eq!(unknown, "no terrain is called `dunes`; hills, cliffs and caves are");
    for character in TerrainCharacter::ALL {
        assert_eq!(character.to_string().parse::<TerrainCharacter>(), Ok(character));
        assert_eq!(character.settings(4).check(), Ok(()));
    }
}

fn settings() -> impl Strategy<Value = TerrainSettings> {
    let shares = prop::array::uniform4(0.0..=1.0f64);
    let lengths = prop::array::uniform3(0.05..1.0f64);
    let others = (0.0..0.5f64, 0.0..0.3f64, 0.0..0.3f64, 0.0..0.1f64);
    let switches = (any::<u32>(), 1u32..7, any::<bool>(), any::<bool>(), any::<bool>());
    (shares, lengths, others, switches).prop_map(|(shares, lengths, others, switches)| TerrainSettings {
        seed: switches.0,
        ground: 0.2 + 0.1 * shares[3],
        relief: others.0,
        period: lengths[0],
        octaves: switches.1,
        gain: shares[0],
        ridged: shares[1],
        billowed: (1.0 - shares[1]) * shares[2],
        terrace: if switches.2 { 0.02 + others.1 } else { 0.0 },
        overhang: if switches.3 { others.2 } else { 0.0 },
        overhang_period: lengths[1],
        caves: if switches.4 { others.1 } else { 0.0 },
        cave_period: lengths[2],
        closed: shares[0] < 0.5,
        margin: others.3,
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn values_stay_in_range_and_below_the_slope(
        settings in settings(),
        low in prop::array::uniform3(-1.2f32..1.0),
        size in prop::array::uniform3(0.0f32..1.0),
        scale in prop::sample::select(vec![0.001f32, 0.03, 0.3, 2.0]),
        parts in prop::collection::vec(prop::array::uniform3(0.0f32..=1.0), 12),
    ) {
        let field = terrain(settings);
        let bounds = Bounds { min: Vec3::from(low), max: Vec3::from(low) + Vec3::from(size) * scale };
        let (least, most) = field.range(bounds, f32::NAN).unwrap();
        let slope = f64::from(field.slope(bounds).unwrap());
        let mut before: Option<(Vec3, f32)> = None;
        for part in parts {
            let p = (bounds.min + Vec3::from(part) * bounds.size()).clamp(bounds.min, bounds.max);
            let value = field.sample(p);
            prop_assert!(least <= value && value <= most, "{value} at {p} is not in {least}..{most}");
            if let Some((q, other)) = before {
                let change = f64::from((value - other).abs());
                let rounding = 1e-5 * f64::from(value.abs().max(other.abs()));
                prop_assert!(change <= slope * p.as_dvec3().distance(q.as_dvec3()) + rounding, "{p} {q}");
            }
            before = Some((p, value));
        }
    }
}
