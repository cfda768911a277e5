//! What a folder of the barometer gives: workloads with their samples, and engines.

use crate::mesh_file;
use anyhow::{Context, Result, bail};
use glam::Vec3;
use isostudy_barometer::Grid;
use isostudy_barometer::engine::{self, Engines};
use isostudy_barometer::workload::{self, Group, Quantised, Workload};
use isostudy_expression::Expression;
use isostudy_field::{MeshDistance, StudyField};
use isostudy_mesh::repair::closed_solid;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// The file of engines in such a folder.
pub(super) const ENGINES: &str = "engines.toml";

/// The largest volume.
const MOST_BYTES: u64 = 2 << 30;

/// Workloads in the order in which they are asked for, and engines.
pub(super) struct Given {
    pub(super) folder: PathBuf,
    pub(super) workloads: Vec<(Group, Workload)>,
    pub(super) engines: Engines,
}

/// Samples of a box, and where it is.
pub(super) struct Sampled {
    pub(super) counts: [usize; 3],
    pub(super) origin: [f64; 3],
    pub(super) spacing: [f64; 3],
    pub(super) values: Vec<f32>,
    pub(super) isovalue: f32,
    pub(super) is_smooth: bool,
}

impl Sampled {
    pub(super) fn grid(&self) -> Grid<'_> {
        let Self { counts, origin, spacing, ref values, isovalue, is_smooth } = *self;
        Grid { counts, origin, spacing, values, isovalue, is_smooth }
    }
}

/// Reads every file of workloads, and that of engines.
///
/// # Errors
/// The file and what is wrong in it.
pub(super) fn read(folder: &Path) -> Result<Given> {
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .with_context(|| folder.display().to_string())?
        .map(|entry| Ok(entry?.path()))
        .collect::<std::io::Result<_>>()?;
    files.retain(|path| path.extension().is_some_and(|ending| ending == "toml"));
    files.sort();
    let mut given = Given { folder: folder.to_owned(), workloads: Vec::new(), engines: Engines::default() };
    for path in files {
        let text = std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
        if path.file_name().is_some_and(|name| name == ENGINES) {
            given.engines = engine::read(&text)
                .map_err(anyhow::Error::msg)
                .with_context(|| path.display().to_string())?;
            continue;
        }
        for (group, workload) in workload::read(&text).with_context(|| path.display().to_string())? {
            if given.workloads.iter().any(|(_, other)| other.id == workload.id) {
                bail!("{}: workload {} is there twice", path.display(), workload.id);
            }
            given.workloads.push((group, workload));
        }
    }
    if given.workloads.is_empty() {
        bail!("{}: there are no workloads", folder.display());
    }
    // What a program keeps from before is small then.
    let size = |of: &Workload| of.samples.iter().map(|&n| u64::from(n)).product::<u64>();
    given.workloads.sort_by_key(|(_, workload)| size(workload));
    Ok(given)
}

impl Given {
    /// The file of a workload that was not fetched.
    pub(super) fn missing(&self, workload: &Workload) -> Option<PathBuf> {
        let file = workload.volume.as_ref().or(workload.mesh.as_ref())?;
        Some(self.folder.join(file)).filter(|path| !path.is_file())
    }
}

/// The samples of each box of a workload.
///
/// # Errors
/// If its formula is none, or its file cannot be read.
pub(super) fn sampled(folder: &Path, workload: &Workload) -> Result<Vec<Sampled>> {
    let mut boxes = match (&workload.formula, &workload.volume, workload.random) {
        (Some(formula), _, _) => of_formula(formula, workload)?,
        (_, Some(file), _) => vec![of_volume(&folder.join(file), workload)?],
        (_, _, None) => {
            let path = folder.join(workload.mesh.as_deref().unwrap_or_default());
            let solid = closed_solid(&mesh_file::read(&path)?).with_context(|| path.display().to_string())?;
            let field = MeshDistance::try_new(&solid).with_context(|| path.display().to_string())?;
            of_field(&field, workload)
        }
        (_, _, Some(seed)) => vec![by_chance(seed, workload)],
    };
    for of in &mut boxes {
        if let Some(quantised) = workload.quantised {
            of.isovalue = quantised.apply(&mut of.values, of.isovalue);
            of.is_smooth = quantised == Quantised::EightBit;
        }
        of.origin = [0, 1, 2].map(|axis| of.origin[axis] + workload.offset[axis]);
    }
    Ok(boxes)
}

fn of_formula(formula: &str, workload: &Workload) -> Result<Vec<Sampled>> {
    let field: Expression = formula.parse().with_context(|| format!("formula {formula:?}"))?;
    Ok(of_field(&field, workload))
}

fn of_field(field: &(impl StudyField + ?Sized), workload: &Workload) -> Vec<Sampled> {
    let [bx, by, bz] = workload.boxes;
    let places = (0..bz).flat_map(|z| (0..by).flat_map(move |y| (0..bx).map(move |x| [x, y, z])));
    let spacing = workload.spacing();
    let counts = workload.samples.map(|n| n as usize);
    places
        .map(|place| {
            let origin = [0, 1, 2].map(|axis| {
                let steps = f64::from(place[axis]) * f64::from(workload.samples[axis] - 1);
                workload.min[axis] + steps * spacing[axis]
            });
            let at = |axis: usize, i: usize| (origin[axis] + i as f64 * spacing[axis]) as f32;
            let x: Vec<f32> = (0..counts[0]).map(|i| at(0, i)).collect();
            let mut values = vec![0.0; counts.iter().product()];
            values.par_chunks_mut(counts[0] * counts[1]).enumerate().for_each(|(k, layer)| {
                for (j, row) in layer.chunks_mut(counts[0]).enumerate() {
                    field.sample_row(&x, at(1, j), at(2, k), row);
                }
            });
            Sampled { counts, origin, spacing, values, isovalue: workload.isovalue, is_smooth: true }
        })
        .collect()
}

fn of_volume(path: &Path, workload: &Workload) -> Result<Sampled> {
    let volume = isostudy_volume::read(path, MOST_BYTES)?;
    let at = |axis: usize| Vec3::from(volume.steps[axis].map(|x| x as f32)).length();
    Ok(Sampled {
        counts: volume.counts,
        origin: [0.0; 3],
        spacing: [0, 1, 2].map(|axis| f64::from(at(axis))),
        values: volume.values,
        isovalue: workload.isovalue,
        is_smooth: true,
    })
}

fn by_chance(seed: u64, workload: &Workload) -> Sampled {
    let counts = workload.samples.map(|n| n as usize);
    let mut random = Pcg64::seed_from_u64(seed);
    let mut values = vec![-1.0; counts.iter().product()];
    for (i, value) in values.iter_mut().enumerate() {
        let place = [i % counts[0], i / counts[0] % counts[1], i / counts[0] / counts[1]];
        if (0..3).all(|axis| place[axis] > 0 && place[axis] + 1 < counts[axis]) {
            *value = random.random_range(-1.0f32..1.0);
        }
    }
    let isovalue = workload.isovalue;
    Sampled { counts, origin: workload.min, spacing: workload.spacing(), values, isovalue, is_smooth: true }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isostudy_trilinear::{Samples, Ties, topology};

    /// The truth that a file states is that of the trilinear interpolant of its samples, which is counted exactly without a mesh. So the
    /// samples resolve what the formula says, and no number is mistyped. Large grids and fetched volumes are for the run itself.
    #[test]
    fn stated_truths_are_those_of_the_samples() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs/barometer");
        let given = read(&folder).unwrap();
        let mut groups = [0; 5];
        let mut wrong = Vec::new();
        for (group, workload) in &given.workloads {
            groups[*group as usize] += 1;
            let size: u32 = workload.samples.iter().product();
            if size > 100 * 100 * 100 {
                continue;
            }
            if given.missing(workload).is_some() {
                continue;
            }
            let mut found = (0, 0, 0);
            for of in sampled(&folder, workload).unwrap() {
                // NaN is outside, as everywhere here.
                let values: Vec<f32> = of.values.iter().map(|v| if v.is_nan() { -1.0 } else { *v }).collect();
                let samples = Samples::try_new(of.counts, &values).unwrap();
                let surface = topology(&samples, of.isovalue, Ties::Outside).unwrap();
                found.0 += surface.components.len() as u64;
                found.1 += surface.euler_characteristic();
                found.2 += surface.boundary_loops();
            }
            let truth = &workload.truth;
            let stated = (truth.components, truth.euler, truth.boundary);
            if found != stated {
                wrong.push(format!("{}: found {found:?}, stated {stated:?}", workload.id));
            }
        }
        assert!(wrong.is_empty(), "{}", wrong.join("\n"));
        assert_eq!(groups, [12, 10, 16, 14, 8]);
    }
}
