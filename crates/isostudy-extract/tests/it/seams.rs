//! Seams of marching cubes between random levels: nothing faces the inside, and nothing intersects.

use isostudy_extract::{ChunkSettings, Cubes, Grid, LevelExtractor, Method};

use crate::seam_survey::{CELL, Found, Kind, RESOLVED, Random, shape, survey, world};

/// The seed that `make test-long` draws anew.
fn seed() -> u64 {
    std::env::var("PROPTEST_RNG_SEED").ok().and_then(|text| text.parse().ok()).unwrap_or(0)
}

/// What is found in some of the worlds of a kind of shape that a seed has.
fn found(kind: Kind, worlds: std::ops::Range<u64>, with_pairs: bool) -> Found {
    let grid = Grid::try_new([0.0; 3], f64::from(CELL) / 2.0).unwrap();
    let method = Method::Cubes(Cubes::default());
    let mut extractor = LevelExtractor::try_new(&grid, &method, &ChunkSettings::default()).unwrap();
    let mut sum = Found::default();
    for number in worlds {
        let mut random = Random::new((seed() << 20) + number);
        let field = shape(kind, &mut random);
        let chunks = world(&mut extractor, &*field, &mut random);
        let found = survey(&chunks, &*field, with_pairs);
        let is_right = !RESOLVED.contains(&kind) || (found.turned == 0 && found.pairs == 0);
        assert!(is_right, "{kind:?}, seed {}, world {number}: {found:?}", seed());
        sum.add(found);
    }
    sum
}

#[test]
fn seams_between_random_levels_face_the_outside() {
    for kind in RESOLVED {
        let sum = found(kind, 0..200, true);
        assert!(sum.seam > 100_000 && sum.own_turned == 0, "{kind:?}: {sum:?}");
    }
    // Of what is not resolved, few triangles are turned.
    let sum = found(Kind::SmallBall, 0..200, true);
    assert!(sum.seam > 10_000 && sum.turned * 1_000 <= sum.seam && sum.pairs * 1_000 <= sum.seam, "{sum:?}");
}

#[test]
#[ignore = "minutes: run by make test-long"]
fn seams_between_ten_thousand_random_levels_face_the_outside() {
    std::thread::scope(|scope| {
        for part in 0..4 {
            scope.spawn(move || {
                for kind in RESOLVED {
                    let sum = found(kind, 2_500 * part..2_500 * (part + 1), false);
                    assert!(sum.seam > 1_000_000, "{kind:?}: {sum:?}");
                }
            });
        }
    });
}
