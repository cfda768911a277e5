//! What a program is asked, and the line that asks it.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use isostudy_mesh::MeshFormat;
use serde::Serialize;

use crate::error::Problem;

/// Where the samples are.
#[derive(Debug, Clone, Copy)]
pub enum Samples<'a> {
    /// Here; they are written into the worker's folder before the clock starts.
    Values(&'a [f32]),
    /// In a file already, as [`write_samples`] writes it: for many requests of the same samples.
    File(&'a Path),
}

/// One isosurface to extract.
#[derive(Debug, Clone, Copy)]
pub struct Request<'a> {
    /// `size[0] * size[1] * size[2]` samples, x fastest. Inside is above the isovalue.
    pub samples: Samples<'a>,
    /// How many samples there are along x, y and z; at least 2 each.
    pub size: [u32; 3],
    /// Where the first sample lies.
    pub origin: [f64; 3],
    /// From one sample to the next along x, y and z, positive.
    pub spacing: [f64; 3],
    /// The value on the surface.
    pub isovalue: f64,
    /// The file to write the mesh into, with the ending `.ply` or `.obj`; `None` where only the time is wanted. A file that is
    /// there is removed first. A relative path starts from the worker's folder.
    pub mesh: Option<&'a Path>,
    /// Whether an answer without triangles is right.
    pub may_be_empty: bool,
}

/// The request as a line.
#[derive(Debug, Serialize)]
pub(crate) struct Line<'a> {
    pub(crate) id: u64,
    pub(crate) samples: &'a Path,
    pub(crate) size: [u32; 3],
    pub(crate) origin: [f64; 3],
    pub(crate) spacing: [f64; 3],
    pub(crate) isovalue: f64,
    pub(crate) mesh: Option<&'a Path>,
}

/// Writes samples as programs read them: little-endian 32-bit floats, one after the other.
///
/// # Errors
/// What the file system reports.
pub fn write_samples(path: &Path, samples: &[f32]) -> io::Result<()> {
    let mut out = BufWriter::with_capacity(1 << 20, File::create(path)?);
    for sample in samples {
        out.write_all(&sample.to_le_bytes())?;
    }
    out.flush()
}

impl Request<'_> {
    /// The last sample's place.
    pub(crate) fn far_corner(&self) -> [f64; 3] {
        [0, 1, 2].map(|a| self.origin[a] + self.spacing[a] * f64::from(self.size[a].saturating_sub(1)))
    }

    pub(crate) fn check(&self) -> Result<(), Problem> {
        let wrong = |key, reason: String| Err(Problem::Request { key, reason });
        if self.size.iter().any(|&n| n < 2) {
            return wrong("size", format!("{:?}; at least 2 samples along each axis", self.size));
        }
        if self.spacing.iter().any(|&h| !(h.is_finite() && h > 0.0)) {
            return wrong("spacing", format!("{:?}; positive and finite along each axis", self.spacing));
        }
        if !self.isovalue.is_finite() {
            return wrong("isovalue", format!("{}; a finite number", self.isovalue));
        }
        if self.origin.iter().chain(&self.far_corner()).any(|x| !x.is_finite()) {
            return wrong("origin", format!("{:?}; all samples must lie at finite places", self.origin));
        }
        let count = self.size.iter().map(|&n| u128::from(n)).product::<u128>();
        let found = match self.samples {
            Samples::Values(values) => values.len() as u128,
            Samples::File(path) => {
                let bytes = path.metadata().map_err(Problem::io(path))?.len();
                if bytes % 4 != 0 {
                    return wrong("samples", format!("{} has {bytes} bytes; four a sample", path.display()));
                }
                u128::from(bytes / 4)
            }
        };
        if found != count {
            return wrong("samples", format!("there are {found}; size {:?} needs {count}", self.size));
        }
        let ending =
            |path: &Path| path.extension().and_then(|e| e.to_str()).and_then(MeshFormat::from_extension);
        if let Some(path) = self.mesh
            && !matches!(ending(path), Some(MeshFormat::Ply | MeshFormat::Obj))
        {
            return wrong("mesh", format!("{}; the ending must be .ply or .obj", path.display()));
        }
        Ok(())
    }
}
