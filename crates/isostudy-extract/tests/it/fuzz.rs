//! Random volumes through every method, against what the method promises. A volume that breaks a promise is shrunk, and printed as a
//! file to run.

mod files;
mod made;
mod promises;
mod shrink;
pub(crate) mod volume;

use isostudy_extract::{DualContouring, Macet, Method, Preset, presets};
use proptest::prelude::*;
use proptest::test_runner::{TestError, TestRunner};
use rayon::prelude::*;

use made::{Broken, Made};
use promises::{PROMISES, Promise, is_said};
use shrink::Volumes;
use volume::Volume;

/// The first promise that the method breaks.
fn broken(method: &Method, volume: &Volume, promises: &[Promise]) -> Option<(&'static str, Broken)> {
    let made = match Made::of(method, volume) {
        Ok(made) => made,
        Err(broken) => return Some(("an answer", broken)),
    };
    let made_by = promises.iter().filter(|promise| (promise.is_made_by)(method));
    made_by.into_iter().find_map(|promise| Some((promise.name, (promise.holds)(&made).err()?)))
}

/// The smallest volume that breaks a promise, of so many that are tried.
fn smallest(method: &Method, promises: &[Promise], volumes: u32) -> Option<Volume> {
    let config = ProptestConfig {
        cases: volumes,
        max_shrink_iters: 100_000,
        failure_persistence: None,
        ..ProptestConfig::default()
    };
    let keeps = |volume: Volume| match broken(method, &volume, promises) {
        None => Ok(()),
        Some((promise, broken)) => Err(TestCaseError::fail(format!("{promise}: {}", broken.fault))),
    };
    match TestRunner::new(config).run(&Volumes, keeps) {
        Ok(()) => None,
        Err(TestError::Fail(_, volume)) => Some(volume),
        Err(TestError::Abort(reason)) => panic!("{reason}"),
    }
}

/// What a method makes of a volume that breaks a promise, and how to run it.
fn report(Preset { id, method, .. }: &Preset, volume: &Volume) -> String {
    let again = std::panic::catch_unwind(|| broken(method, volume, &PROMISES));
    let (promise, Broken { fault, on_cells }) = match again {
        Ok(Some(broken)) => broken,
        Ok(None) => ("the same answer each time", Broken::of_field("it was another".to_owned())),
        Err(_) => ("no panic", Broken::of_field("it panics".to_owned())),
    };
    files::report(volume, id, promise, &fault, on_cells)
}

/// So many volumes, the same ones for every method.
fn sweep(volumes: u32) {
    let failed: Vec<String> = presets()
        .par_iter()
        .filter_map(|preset| Some(report(preset, &smallest(&preset.method, &PROMISES, volumes)?)))
        .collect();
    assert!(failed.is_empty(), "{} methods of {}\n\n{}", failed.len(), presets().len(), failed.join("\n\n"));
}

#[test]
fn random_volumes_break_no_promise() {
    sweep(250);
}

#[test]
#[ignore = "minutes: run by make test-long"]
fn twenty_thousand_random_volumes_break_no_promise() {
    sweep(20_000);
}

/// `ISOSTUDY_VOLUME=file` runs a file that a failure left; without it one is written and read.
#[test]
fn the_volume_in_a_file() {
    let of_id = |id: &str| presets().iter().find(|preset| preset.id == id).expect("a method of that name");
    if let Ok(path) = std::env::var("ISOSTUDY_VOLUME") {
        let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"));
        let (volume, id) = files::read(&text).expect("a file that a failure left");
        let found = broken(&of_id(&id).method, &volume, &PROMISES);
        let found =
            found.map(|(promise, broken)| format!("{id} breaks a promise: {promise}: {}", broken.fault));
        assert_eq!(found, None);
        return;
    }
    for seed in 0..500 {
        let volume = Volume::random(seed);
        let written = files::text(&volume, "mc33", "closed off the box");
        let (read, id) = files::read(&written).expect("what was written");
        assert_eq!((id.as_str(), files::text(&read, "mc33", "closed off the box")), ("mc33", written));
        let bits = |values: &[f32]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        assert_eq!((read.counts, bits(&read.values)), (volume.counts, bits(&volume.values)), "{seed}");
    }
}

/// Dual contouring that promises no intersections, with cells that stay and with merged ones.
fn clean(volumes: u32) {
    for tolerance in [0.0, 0.02, 0.3, 2.0] {
        let clean = DualContouring::new().with_patches(true).with_in_cell(true).with_clean(true);
        let method = Method::DualContouring(clean.with_tolerance(tolerance));
        let found = smallest(&method, &PROMISES, volumes);
        let told = found.as_ref().and_then(|volume| broken(&method, volume, &PROMISES));
        assert!(
            found.is_none(),
            "{tolerance}: {:?} {found:?}",
            told.map(|(promise, of)| (promise, of.fault))
        );
    }
}

#[test]
fn clean_nets_break_no_promise() {
    clean(500);
}

#[test]
#[ignore = "minutes: run by make test-long"]
fn ten_thousand_clean_nets_break_no_promise() {
    clean(10_000);
}

#[test]
fn every_promise_is_in_a_document_and_is_made_by_some_method() {
    for promise in &PROMISES {
        assert!(is_said(promise.source), "{}: {:?}", promise.name, promise.source);
        assert!(presets().iter().any(|preset| (promise.is_made_by)(&preset.method)), "{}", promise.name);
    }
}

/// Surface nets promise no manifold. Held against that they fail, and the volume that is left cannot lose a plane of samples.
#[test]
fn what_breaks_is_shrunk_until_no_plane_can_go() {
    let nets = presets().iter().find(|preset| preset.id == "nets").expect("a method of that name").method;
    let manifold = PROMISES.into_iter().find(|promise| {
        (promise.is_made_by)(&Method::Macet(Macet::default())) && !(promise.is_made_by)(&nets)
    });
    let asked =
        [Promise { is_made_by: |_| true, ..manifold.expect("a promise of one and not of the other") }];
    let volume = smallest(&nets, &asked, 250).expect("sheets that share a vertex");
    assert!(broken(&nets, &volume, &asked).is_some());
    let planes = (0..3).flat_map(|axis| (0..volume.counts[axis]).map(move |plane| (axis, plane)));
    for (axis, plane) in planes {
        let smaller = volume.without(axis, plane);
        assert!(
            smaller.is_none_or(|smaller| broken(&nets, &smaller, &asked).is_none()),
            "{volume:?} {axis} {plane}"
        );
    }
    assert_eq!((volume.isovalue, volume.steps), (0.0, volume::STRAIGHT));
    assert!(volume.values.iter().all(|value| [-1.0, 0.0, 1.0].contains(value)), "{volume:?}");
}
