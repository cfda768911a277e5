//! Straight lines through a box, spread evenly over places and directions.
//!
//! A surface is crossed by such lines as often everywhere, whichever way it faces: by `1 / 2` of their density per unit of
//! area (Cauchy & Crofton; Santalo 1976, *Integral Geometry and Geometric Probability*, 14.2). Sharp edges and corners are no
//! exception, and no extraction is asked.

use std::f64::consts::TAU;

use glam::{DMat3, DVec3};
use isostudy_mesh::Bounds;

/// Directions, spread evenly over the half sphere. With so many, planes of all directions are crossed equally often within 1.6 %.
const DIRECTIONS: usize = 64;
/// Turns by this much fall evenly (the golden ratio's), for one number and for two (the root of `x^3 = x + 1`; Roberts 2018).
const TURN: f64 = 0.618_033_988_749_895;
const SHIFT: [f64; 2] = [0.754_877_666_246_693, 0.569_840_290_998_053];
/// Directions and lattices do not lie along the axes, as walls do.
const ASKEW: [f64; 3] = [0.377, 0.721, 1.093];

/// One line's part within the box: where it enters, and a unit direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Line {
    pub(crate) from: DVec3,
    pub(crate) direction: DVec3,
    pub(crate) length: f64,
}

/// Parallel lines: a square lattice of them for each direction.
pub(crate) struct Lines {
    bounds: [DVec3; 2],
    /// How far neighbours in one direction are apart.
    pitch: f64,
}

/// One row of a lattice of parallel lines.
pub(crate) struct Row {
    /// Which direction.
    of: usize,
    /// Which row of its lattice.
    row: i64,
}

impl Lines {
    /// About so many lines through a box that is not flat.
    pub(crate) fn through(bounds: &Bounds, count: usize) -> Self {
        let bounds = [bounds.min.as_dvec3(), bounds.max.as_dvec3()];
        let size = bounds[1] - bounds[0];
        // Its mean projection is a quarter of its surface.
        let projection = 0.5 * (size.x * size.y + size.y * size.z + size.z * size.x);
        Self { bounds, pitch: (DIRECTIONS as f64 * projection / count as f64).sqrt() }
    }

    /// The area that each crossing stands for.
    pub(crate) fn area_per_crossing(&self) -> f64 {
        2.0 * self.pitch * self.pitch / DIRECTIONS as f64
    }

    /// All rows.
    pub(crate) fn rows(&self) -> Vec<Row> {
        let of_direction = |of: usize| {
            let axes = axes(of);
            let [low, high] = self.extent(axes.y_axis, shift(of)[1]);
            (low..=high).map(move |row| Row { of, row })
        };
        (0..DIRECTIONS).flat_map(of_direction).collect()
    }

    /// The lines of a row that pass through the box.
    pub(crate) fn of(&self, row: &Row) -> impl Iterator<Item = Line> {
        let (axes, [along, across]) = (axes(row.of), shift(row.of));
        let [low, high] = self.extent(axes.x_axis, along);
        let row = axes.y_axis * (self.pitch * (row.row as f64 + across));
        (low..=high).filter_map(move |place| {
            let foot = row + axes.x_axis * (self.pitch * (place as f64 + along));
            self.clipped(foot, axes.z_axis)
        })
    }

    /// The first and the last place of a lattice along an axis.
    fn extent(&self, axis: DVec3, shift: f64) -> [i64; 2] {
        let [min, max] = self.bounds;
        let (middle, half) = (axis.dot(0.5 * (min + max)), axis.abs().dot(0.5 * (max - min)));
        let place = |at: f64| at / self.pitch - shift;
        [place(middle - half).ceil() as i64, place(middle + half).floor() as i64]
    }

    fn clipped(&self, foot: DVec3, direction: DVec3) -> Option<Line> {
        let [a, b] = self.bounds.map(|corner| (corner - foot) / direction);
        let (enters, leaves) = (a.min(b).max_element(), a.max(b).min_element());
        (enters < leaves).then(|| Line {
            from: foot + direction * enters,
            direction,
            length: leaves - enters,
        })
    }
}

/// The plane of a direction's lattice, and the direction as the third axis.
fn axes(of: usize) -> DMat3 {
    let z = (of as f64 + 0.5) / DIRECTIONS as f64;
    let turned = DMat3::from_rotation_z(TAU * TURN * of as f64) * DMat3::from_rotation_y(z.acos());
    let [x, y, w] = ASKEW;
    DMat3::from_rotation_x(x)
        * DMat3::from_rotation_y(y)
        * turned
        * DMat3::from_rotation_z(w + TAU * TURN * of as f64)
}

/// Where a direction's lattice begins, in pitches.
fn shift(of: usize) -> [f64; 2] {
    SHIFT.map(|step| (0.5 + step * (of as f64 + 1.0)).fract())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The oracle is the formula for convex bodies: lines hit a plane of area 1 as often as `|cos|` of the angle between says.
    #[test]
    fn planes_of_all_directions_are_crossed_equally_often() {
        let mut worst = 0f64;
        for i in 0..2_000 {
            let z = (f64::from(i) + 0.5) / 2_000.0;
            let normal =
                DMat3::from_rotation_z(2.4 * f64::from(i)) * DMat3::from_rotation_y(z.acos()) * DVec3::Z;
            let seen = (0..DIRECTIONS).map(|of| axes(of).z_axis.dot(normal).abs()).sum::<f64>();
            worst = worst.max((2.0 * seen / DIRECTIONS as f64 - 1.0).abs());
        }
        assert!(worst < 0.016, "{worst}");
    }

    #[test]
    fn lines_end_on_the_box_and_their_number_is_about_that_asked_for() {
        let bounds = Bounds { min: glam::vec3(-1.0, 0.0, 2.0), max: glam::vec3(1.0, 0.5, 2.75) };
        let lines = Lines::through(&bounds, 100_000);
        let all: Vec<Line> = lines.rows().iter().flat_map(|row| lines.of(row)).collect();
        assert!((all.len() as f64 / 1e5 - 1.0).abs() < 0.01, "{}", all.len());
        let [min, max] = lines.bounds;
        for line in &all {
            for end in [line.from, line.from + line.direction * line.length] {
                let inside = (end - min).min(max - end).min_element();
                assert!(inside.abs() < 1e-12 && (line.direction.length() - 1.0).abs() < 1e-12);
            }
        }
        // The volume is that of all lines' lengths, each with its square.
        let share = lines.pitch * lines.pitch / DIRECTIONS as f64;
        let volume: f64 = all.iter().map(|line| line.length * share).sum();
        assert!((volume / 0.75 - 1.0).abs() < 1e-3, "{volume}");
    }
}
