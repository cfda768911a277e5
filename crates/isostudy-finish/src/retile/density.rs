//! How close points shall lie, triangle by triangle.

use super::Density;
use crate::surface::Surface;

/// By how much lengths between points may differ from those at the mean curvature.
const MOST: f64 = 3.0;
/// How often curvatures are averaged with those of neighbours: those of single vertices are noise.
const ROUNDS: usize = 4;

/// Points for each unit of area, in a unit of its own.
pub(crate) fn of_triangles(surface: &Surface, by: Density) -> Vec<f64> {
    match by {
        Density::Area => vec![1.0; surface.triangles.len()],
        Density::Curvature => by_curvature(surface),
    }
}

/// Turk has points push as far as the radius of curvature, within limits; so lengths are as that radius.
fn by_curvature(surface: &Surface) -> Vec<f64> {
    let curvature = curvatures(surface);
    let weights: Vec<f64> = areas(surface);
    let total: f64 = weights.iter().sum();
    let mean = curvature.iter().zip(&weights).map(|(of, area)| of * area).sum::<f64>() / total;
    let of_vertex = |v: u32| {
        let relative = curvature[v as usize] / mean;
        // A surface that bends nowhere has no mean to compare with.
        let length = if relative.is_finite() { (1.0 / relative).clamp(1.0 / MOST, MOST) } else { 1.0 };
        1.0 / (length * length)
    };
    surface.triangles.iter().map(|corners| corners.iter().map(|&v| of_vertex(v)).sum::<f64>() / 3.0).collect()
}

/// A third of the area of the triangles at each vertex.
fn areas(surface: &Surface) -> Vec<f64> {
    let mut areas = vec![0.0; surface.positions.len()];
    for (t, corners) in (0..).zip(&surface.triangles) {
        let third = surface.area_vector(t).length() / 6.0;
        corners.iter().for_each(|&v| areas[v as usize] += third);
    }
    areas
}

/// Of each vertex, half the sum of the sizes of both principal curvatures, by the angles at its edges (Cohen-Steiner and Morvan 2003),
/// averaged over neighbours.
fn curvatures(surface: &Surface) -> Vec<f64> {
    let areas = areas(surface);
    let mut bends = vec![0.0; surface.positions.len()];
    for (t, corners) in (0..).zip(&surface.triangles) {
        for k in 0..3 {
            let [u, v] = [corners[k], corners[(k + 1) % 3]];
            let Some((other, _)) = surface.triangle_along(v, u).filter(|_| u < v) else { continue };
            let (a, b) = (surface.area_vector(t), surface.area_vector(other));
            let angle = a.cross(b).length().atan2(a.dot(b));
            let length = surface.position(u).distance(surface.position(v));
            // Half of the edge belongs to each end, and half of the angle to each curvature.
            [u, v].iter().for_each(|&w| bends[w as usize] += 0.25 * angle * length);
        }
    }
    let mut areas = areas;
    let mut around = Vec::new();
    for _ in 0..ROUNDS {
        let (mut next_bends, mut next_areas) = (bends.clone(), areas.clone());
        for v in 0..surface.positions.len() as u32 {
            surface.neighbours(v, &mut around);
            for &w in &around {
                next_bends[v as usize] += bends[w as usize];
                next_areas[v as usize] += areas[w as usize];
            }
            let count = around.len() as f64 + 1.0;
            next_bends[v as usize] /= count;
            next_areas[v as usize] /= count;
        }
        (bends, areas) = (next_bends, next_areas);
    }
    bends.iter().zip(&areas).map(|(bend, area)| if *area > 0.0 { bend / area } else { 0.0 }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::{icosphere, sheet};

    #[test]
    fn a_sphere_bends_by_its_radius_and_a_sheet_not_at_all() {
        // Both principal curvatures are 1: half their sum is 1.
        let found = curvatures(&Surface::of(&icosphere(5)));
        assert!(found.iter().all(|of| (of - 1.0).abs() < 0.1), "{found:?}");
        assert!(curvatures(&Surface::of(&sheet(5))).iter().all(|of| *of == 0.0));
        let even = of_triangles(&Surface::of(&sheet(5)), Density::Curvature);
        assert!(even.iter().all(|of| *of == 1.0));
    }
}
