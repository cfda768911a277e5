//! What terrains promise: bounds that hold, and the character that their name says.

use glam::Vec3;
use isostudy_field::{StudyField, Terrain, TerrainCharacter, TerrainError, TerrainSettings};
use isostudy_mesh::Bounds;
use proptest::prelude::*;

const BOUNDS: Bounds = Terrain::DEFAULT_BOUNDS;

fn terrain(settings: TerrainSettings) -> Terrain {
    Terrain::try_new(settings, BOUNDS).unwrap()
}

fn of(character: TerrainCharacter, seed: u32) -> Terrain {
    terrain(character.settings(seed))
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

    /// Rows of all lengths, with lattice steps and wild ones, and what is no place.
    #[test]
    fn a_row_is_its_samples_to_the_bit(
        settings in settings(),
        start in prop::array::uniform3(-1.5f32..1.5),
        step in prop::sample::select(vec![0.0f32, 1e-4, 0.02, 0.3, 1e8]),
        count in 0usize..200,
        odd in prop::collection::vec((0usize..200, prop::sample::select(vec![f32::NAN, f32::INFINITY, -0.0])), 0..3),
    ) {
        let field = terrain(settings);
        let [x0, y, z] = start;
        let mut x: Vec<f32> = (0..count).map(|i| x0 + i as f32 * step).collect();
        for (i, value) in odd {
            if let Some(x) = x.get_mut(i) {
                *x = value;
            }
        }
        let mut values = vec![0.0; count];
        field.sample_row(&x, y, z, &mut values);
        for (&x, value) in x.iter().zip(values) {
            let alone = field.sample(Vec3::new(x, y, z));
            prop_assert_eq!(value.to_bits(), alone.to_bits(), "{} at x = {}", value, x);
        }
    }

    #[test]
    fn points_near_each_other_have_their_samples_to_the_bit(
        settings in settings(),
        points in prop::collection::vec(prop::array::uniform3(-1.5f32..1.5), 0..150),
        apart in prop::sample::select(vec![1.0f32, 0.02, 1e-4]),
    ) {
        let field = terrain(settings);
        let points: Vec<Vec3> = points.into_iter().map(|p| Vec3::splat(0.1) + apart * Vec3::from_array(p)).collect();
        let mut values = vec![0.0; points.len()];
        field.sample_near(&points, &mut values, None);
        for (&p, value) in points.iter().zip(values) {
            prop_assert_eq!(value.to_bits(), field.sample(p).to_bits(), "at {}", p);
        }
    }
}
