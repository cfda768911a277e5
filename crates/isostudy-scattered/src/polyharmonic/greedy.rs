//! Which of many points are centres.

use super::system::System;

/// Centres that are chosen for lying far apart, as a share of all.
const FIRST: usize = 8;
/// A round of choosing adds so many times the centres that there are.
const GROWTH: f64 = 0.5;

/// Chooses up to so many centres: some that lie far apart, then those with the largest errors, in rounds.
///
/// Within a round, centres keep a distance that shrinks as their number grows: one error often shows at many neighbours, and one
/// centre mends it.
pub(super) fn choose(system: &mut System<'_>, most: usize) {
    let mut is_tried = vec![false; system.points.len()];
    let mut chosen = far_apart(system, (most / FIRST).max(4));
    while !chosen.is_empty() {
        system.append(&chosen);
        system.solve();
        chosen.iter().for_each(|&i| is_tried[i] = true);
        let wanted = (GROWTH * system.len() as f64) as usize;
        chosen = worst(system, &is_tried, wanted.min(most - system.len()));
    }
}

/// Points far from all chosen before, each the farthest; the anchors count as chosen.
fn far_apart(system: &System<'_>, many: usize) -> Vec<usize> {
    let points = system.points;
    let mut distances = vec![f64::INFINITY; points.len()];
    let mut chosen: Vec<usize> = (0..points.len()).filter(|&i| system.is_anchor(i)).collect();
    let mut next = 0;
    while chosen.len() < many {
        if let Some(&last) = chosen.get(next) {
            next += 1;
            for (distance, p) in distances.iter_mut().zip(points) {
                *distance = distance.min(p.distance_squared(points[last]));
            }
            if next < chosen.len() {
                continue;
            }
        }
        let best = distances
            .iter()
            .enumerate()
            .fold((0, 0.0), |best, (i, &d)| if d > best.1 { (i, d) } else { best });
        if best.1 == 0.0 {
            break;
        }
        chosen.push(best.0);
    }
    chosen
}

/// The points with the largest errors, the worst first.
fn worst(system: &System<'_>, is_tried: &[bool], wanted: usize) -> Vec<usize> {
    let spline = system.spline();
    let points = system.points;
    let error = |i: usize| (spline.value(points[i]) - system.values[i]).abs();
    let mut errors: Vec<(f64, usize)> = (0..points.len())
        .filter(|&i| !is_tried[i] && !system.is_anchor(i))
        .map(|i| (error(i), i))
        .filter(|(error, _)| *error > 0.0)
        .collect();
    errors.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let (low, high) = points.iter().fold((points[0], points[0]), |(low, high), &p| (low.min(p), high.max(p)));
    let apart = 0.5 * (high - low).length() / ((system.len() + wanted) as f64).sqrt();
    let mut chosen: Vec<usize> = Vec::new();
    let mut passed = Vec::new();
    for &(_, i) in &errors {
        if chosen.len() == wanted {
            break;
        }
        let is_near = chosen.iter().any(|&other| points[i].distance_squared(points[other]) < apart * apart);
        if is_near { passed.push(i) } else { chosen.push(i) }
    }
    let missing = wanted - chosen.len();
    chosen.extend(passed.into_iter().take(missing));
    chosen
}
