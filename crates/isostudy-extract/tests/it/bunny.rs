//! The evaluation's bunny as the studies in `configs/` place it, for tests, benches and examples.

use std::fs::File;
use std::path::Path;

use glam::Vec3;
use isostudy_mesh::{Bounds, TriangleMesh, read_obj, read_ply, repair};

/// The studies' volume.
#[allow(dead_code, reason = "not every test file uses it")]
pub(crate) const BOX: Bounds = Bounds { min: Vec3::new(-0.7, -0.4, -0.5), max: Vec3::new(0.8, 0.4, 0.6) };

/// The bunny as a closed solid in the evaluation's scene, or `None` where going without it was asked for.
///
/// Axes (x, y, z) -> (x, -z, y). Scale and offset were fitted: they put the bounds where the published output has them
/// and the published counts within 1.6 %. Debian's file is Stanford's, centred on its bounds and scaled to a width of 2.
pub(crate) fn bunny() -> Option<TriangleMesh> {
    let cache = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cache");
    let (scan, scale, offset) = if let Ok(file) = File::open(cache.join("bunny.ply")) {
        (read_ply(file).unwrap(), 6.35, Vec3::new(0.104, 0.002, -0.617))
    } else if let Ok(file) = File::open(cache.join("bunny.obj")) {
        (read_obj(file).unwrap(), 0.494_344, Vec3::new(-0.002_937, 0.011_76, 0.082_479))
    } else {
        // A test that quietly checks nothing is worse than none: going without has to be asked for.
        let without = std::env::var_os("ISOSTUDY_WITHOUT_BUNNY").is_some();
        assert!(
            without,
            "no bunny in cache/: run `make bunny`, or set ISOSTUDY_WITHOUT_BUNNY=1 to go without"
        );
        return None;
    };
    let solid = repair::closed_solid(&scan).unwrap();
    Some(solid.transformed(|p| Vec3::new(p.x, -p.z, p.y) * scale + offset))
}
