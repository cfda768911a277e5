//! The seeds of continuation that somebody gave: whether they lie where a surface is looked for, and what is said if they meet none.

use crate::place::place;
use anyhow::{Result, bail};
use glam::{DMat3, DVec3, Vec3};
use isostudy_extract::{Method, Seeds};
use isostudy_mesh::Bounds;
use isostudy_volume::Frame;

/// How far beyond a volume's samples a seed may be, in steps: the volume's own meshes have vertices there by rounding.
const ROUNDING: f64 = 1e-3;

/// The seeds that somebody gave; none where they are searched for, and none of other methods.
fn given(method: &Method) -> &[[f32; 3]] {
    match method {
        Method::Continuation(of) => of.seeds.points(),
        _ => &[],
    }
}

/// As a study file has it, with its number: `seeds[1] = [7.0, 7.0, 7.0]`.
fn named(i: usize, seed: [f32; 3]) -> String {
    format!("seeds[{i}] = {}", place(Vec3::from_array(seed)))
}

/// The first seed outside of a box, as text.
pub(crate) fn outside(method: &Method, bounds: &Bounds) -> Option<String> {
    let is_outside =
        |seed: &[f32; 3]| (0..3).any(|axis| !(bounds.min[axis]..=bounds.max[axis]).contains(&seed[axis]));
    let (i, seed) = given(method).iter().enumerate().find(|(_, seed)| is_outside(seed))?;
    Some(named(i, *seed))
}

/// Checks that given seeds lie in the box: the extractor would begin at the nearest cell of it.
///
/// # Errors
/// The first seed that does not.
pub(crate) fn check(method: &Method, bounds: &Bounds) -> Result<()> {
    let Some(seed) = outside(method, bounds) else { return Ok(()) };
    let Bounds { min, max } = bounds;
    bail!("{seed}: this seed lies outside of the box, from {} to {}", place(*min), place(*max))
}

/// The method for a volume's own cells, where the extractor counts in steps from sample to sample: given seeds are in space.
///
/// # Errors
/// If a seed lies outside of the samples.
pub(crate) fn in_steps(method: &Method, volume: &Frame) -> Result<Method> {
    let Method::Continuation(continuation) = method else { return Ok(*method) };
    let steps = DMat3::from_cols_array_2d(&volume.steps);
    // Where steps span no space the extractor says so.
    if given(method).is_empty() || steps.determinant() == 0.0 {
        return Ok(*method);
    }
    let (back, origin) = (steps.inverse(), DVec3::from_array(volume.origin));
    let last = DVec3::from_array(volume.counts.map(|n| n.saturating_sub(1) as f64));
    let mut points = Vec::new();
    for (i, &seed) in given(method).iter().enumerate() {
        let at = back * (Vec3::from_array(seed).as_dvec3() - origin);
        let kept = at.clamp(DVec3::ZERO, last);
        if !(at - kept).abs().cmple(DVec3::splat(ROUNDING)).all() {
            bail!("{}: this seed lies outside of the volume's samples", named(i, seed));
        }
        points.push(kept.as_vec3().to_array());
    }
    Ok(Method::Continuation((*continuation).with_seeds(Seeds::try_new(&points)?)))
}

/// Why a method with given seeds reached no surface; `None` of methods that find every surface.
pub(crate) fn missed(method: &Method) -> Option<String> {
    let seeds: Vec<String> = given(method).iter().map(|&seed| place(Vec3::from_array(seed))).collect();
    (!seeds.is_empty()).then(|| {
        format!(
            "the walk from seeds = [{}] met none; move them next to the surface, or leave `seeds` out",
            seeds.join(", ")
        )
    })
}
