//! A coarse grid of samples over the box, and where its edges cross the surface.

use glam::DVec3;
use isostudy_mesh::Bounds;

use crate::probe::Probe;

pub(crate) struct Samples {
    min: DVec3,
    pub(crate) spacing: DVec3,
    /// Points along x, y and z; at least two.
    pub(crate) counts: [usize; 3],
    values: Vec<f32>,
}

/// An edge of the grid that crosses the surface.
pub(crate) struct Crossing {
    pub(crate) inside: DVec3,
    pub(crate) outside: DVec3,
    /// By interpolation.
    pub(crate) place: DVec3,
    /// The numbers of both ends.
    pub(crate) ends: [usize; 2],
}

impl Samples {
    /// So many cells along the longest side of the box, x fastest.
    pub(crate) fn of(probe: &Probe<'_>, bounds: Bounds, cells: u32) -> Self {
        let (min, size) = (bounds.min.as_dvec3(), bounds.size().as_dvec3());
        let cells = (size / size.max_element() * f64::from(cells)).ceil().max(DVec3::ONE);
        let counts = cells.to_array().map(|n| n as usize + 1);
        let mut samples =
            Self { min, spacing: size / cells, counts, values: vec![0.0; counts.iter().product()] };
        let x: Vec<f32> = (0..counts[0]).map(|i| samples.point([i, 0, 0]).x as f32).collect();
        for (row, values) in samples.values.chunks_exact_mut(counts[0]).enumerate() {
            let at =
                min + samples.spacing * DVec3::new(0.0, (row % counts[1]) as f64, (row / counts[1]) as f64);
            probe.row(&x, at.y as f32, at.z as f32, values);
        }
        samples
    }

    fn point(&self, at: [usize; 3]) -> DVec3 {
        self.min + self.spacing * DVec3::from(at.map(|n| n as f64))
    }

    /// Every edge with ends on different sides; `NaN` is outside.
    pub(crate) fn crossings(&self) -> impl Iterator<Item = Crossing> + '_ {
        let [along_x, along_y, _] = self.counts;
        let strides = [1, along_x, along_x * along_y];
        (0..self.values.len()).flat_map(move |i| {
            let at = [i % along_x, i / along_x % along_y, i / (along_x * along_y)];
            (0..3).filter_map(move |axis| {
                if at[axis] + 1 == self.counts[axis] {
                    return None;
                }
                let j = i + strides[axis];
                let (a, b) = (self.values[i], self.values[j]);
                if (a > 0.0) == (b > 0.0) {
                    return None;
                }
                let mut beyond = at;
                beyond[axis] += 1;
                let ends = [at, beyond].map(|at| self.point(at));
                let share = f64::from(a / (a - b));
                let share = if share.is_finite() { share } else { 0.5 };
                let [inside, outside] = if a > 0.0 { [0, 1] } else { [1, 0] }.map(|of: usize| ends[of]);
                Some(Crossing { inside, outside, place: ends[0].lerp(ends[1], share), ends: [i, j] })
            })
        })
    }
}
