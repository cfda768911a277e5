//! Claims about how the animations were made, checked against the study file.

use super::Finding;
use crate::verdict::Verdict;
use isostudy_design::Study;
use isostudy_design::published::Claim;

pub(super) fn find(study: &Study, claim: &Claim) -> Option<Finding> {
    match claim.id.as_str() {
        "turntable_duration" => turntable_duration(study, claim.value?),
        "equal_cameras" => equal_cameras(study),
        _ => None,
    }
}

/// A GIF's delay is a whole number of centiseconds.
fn turntable_duration(study: &Study, published_s: f64) -> Option<Finding> {
    let turntable = &study.file.turntable;
    let frames = f64::from(turntable.frames);
    let delay_cs = (100.0 * turntable.duration_s / frames).floor();
    let real_s = delay_cs * frames / 100.0;
    let verdict = match real_s == published_s {
        true => Verdict::Equal,
        false => Verdict::differs(format!(
            "a frame lasts a whole number of centiseconds: {} frames of {delay_cs} cs",
            turntable.frames
        )),
    };
    let (as_published, ours) = (Some(turntable.duration_s), Some(real_s));
    Some(Finding { as_published, ..Finding::of(ours, 1, verdict) })
}

fn equal_cameras(study: &Study) -> Option<Finding> {
    let mut cameras: Vec<(f64, f64)> = Vec::new();
    for object in &study.file.objects {
        let camera = (object.camera.distance, object.camera.vertical_fov_rad);
        if !cameras.contains(&camera) {
            cameras.push(camera);
        }
    }
    let verdict = match cameras.len() {
        1 => Verdict::Equal,
        n => Verdict::differs(format!("equal within an object; {n} different cameras across objects")),
    };
    let ours = Some(cameras.len() as f64);
    Some(Finding::of(ours, 0, verdict))
}
