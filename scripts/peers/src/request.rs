//! A request's line, its samples, and where they lie.

use isostudy_mesh::glam::Vec3;
use serde::Deserialize;
use std::path::PathBuf;

#[derive(Deserialize)]
pub(crate) struct Request {
    pub(crate) id: u64,
    samples: PathBuf,
    pub(crate) size: [u32; 3],
    origin: [f64; 3],
    spacing: [f64; 3],
    pub(crate) isovalue: f64,
    pub(crate) mesh: Option<PathBuf>,
}

impl Request {
    pub(crate) fn read_samples(&self) -> Result<Vec<f32>, String> {
        let bytes =
            std::fs::read(&self.samples).map_err(|error| format!("{}: {error}", self.samples.display()))?;
        let samples: Vec<f32> =
            bytes.as_chunks::<4>().0.iter().map(|four| f32::from_le_bytes(*four)).collect();
        let count = self.size.iter().map(|&n| n as usize).product::<usize>();
        if samples.len() == count {
            Ok(samples)
        } else {
            Err(format!("{} samples, not {count}", samples.len()))
        }
    }

    /// Cells along each side, for crates that know cubes of cells alone.
    pub(crate) fn cells_of_a_cube(&self) -> Result<u32, String> {
        let [x, y, z] = self.size;
        if x == y && y == z {
            Ok(x - 1)
        } else {
            Err(format!("it extracts from cubes of cells alone, not from {:?} samples", self.size))
        }
    }

    /// The isovalue less each sample, for crates where inside is negative.
    pub(crate) fn negate(&self, samples: &[f32], negated: &mut Vec<f32>) {
        negated.clear();
        negated.extend(samples.iter().map(|&sample| (self.isovalue - f64::from(sample)) as f32));
    }

    /// A place in cells, in the samples' space.
    pub(crate) fn place(&self, [x, y, z]: [f32; 3]) -> Vec3 {
        let at = |a: usize, cells: f32| (self.origin[a] + self.spacing[a] * f64::from(cells)) as f32;
        Vec3::new(at(0, x), at(1, y), at(2, z))
    }
}
