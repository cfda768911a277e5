//! Turned and intersecting triangles at the seams between levels, of shapes that are resolved and of small ones.
//!
//! `cargo run --release -p isostudy-extract --example seams -- 200`: so many worlds of each shape and method. The tables of
//! `docs/lod.md` are its output.

#![allow(dead_code, reason = "the tests use what this example does not")]

#[path = "../tests/it/seam_survey.rs"]
mod seam_survey;

use isostudy_extract::{ChunkSettings, Cubes, DualContouring, Grid, LevelExtractor, Method, SurfaceNets};
use seam_survey::{CELL, Found, Kind, RESOLVED, Random, shape, survey, world};

fn main() {
    let worlds: u64 = std::env::args().nth(1).and_then(|n| n.parse().ok()).unwrap_or(200);
    let nets = Method::SurfaceNets(SurfaceNets::default());
    let dc = DualContouring::default();
    let all = [
        ("mc", Method::Cubes(Cubes::default())),
        ("nets", nets),
        ("dc", Method::DualContouring(dc.with_in_cell(false))),
        ("dc in cells", Method::DualContouring(dc.with_in_cell(true))),
    ];
    println!(
        "| method | shape | worlds | seam triangles | turned | of these, seen by the fine level alone | worlds with a turned one | other triangles turned | intersecting pairs | the most in a world | worlds with a pair |"
    );
    println!("|---|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|");
    for (name, method) in all {
        let grid = Grid::try_new([0.0; 3], f64::from(CELL) / 2.0).unwrap();
        let mut extractor = LevelExtractor::try_new(&grid, &method, &ChunkSettings::default()).unwrap();
        for kind in RESOLVED.into_iter().chain([Kind::SmallBall]) {
            let mut sum = Found::default();
            for seed in 0..worlds {
                let mut random = Random::new(seed);
                let field = shape(kind, &mut random);
                let chunks = world(&mut extractor, &*field, &mut random);
                sum.add(survey(&chunks, &*field, true));
            }
            println!(
                "| `{name}` | {kind:?} | {} | {} | {} | {} | {} | {} | {} | {} | {} |",
                sum.worlds,
                sum.seam,
                sum.turned,
                sum.missed,
                sum.worlds_turned,
                sum.own_turned,
                sum.pairs,
                sum.most_pairs,
                sum.worlds_crossing
            );
        }
    }
}
