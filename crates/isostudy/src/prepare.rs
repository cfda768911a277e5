//! From a study's words to the extractor's: methods, grids, isovalues. The one place where `design` meets `extract`.

use crate::families::Asked;
use crate::fields::{self, Fields};
use crate::memory::Limit;
use crate::place::place;
use crate::recipe::{self, Recipe, recipe};
use crate::{seeds, study_key};
use anyhow::{Context, Result, bail};
use isostudy_design::config::{ObjectSection, ThreadSweepSection};
use isostudy_design::record::Purpose;
use isostudy_design::sweep::Chosen;
use isostudy_design::{Configuration, ConfigurationId, MethodId, Study};
use isostudy_extract::{Arrangement, BoxGrid, Execution, Method, MethodError};
use isostudy_field::StudyField;
use isostudy_finish::Step;
use isostudy_grid::Grid;
use isostudy_mesh::Bounds;
use serde::{Deserialize, Serialize};

/// At which resolution, and for what.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Wanted {
    /// At the object's own spacing for the purpose.
    For(Purpose),
    /// So many cells along the longest side of the object's volume, for this purpose.
    Cells(u32, Purpose),
    /// This spacing, for this purpose.
    Spacing(f64, Purpose),
}

impl Wanted {
    fn purpose(self) -> Purpose {
        match self {
            Self::For(purpose) | Self::Cells(_, purpose) | Self::Spacing(_, purpose) => purpose,
        }
    }

    /// The cube edge for an object.
    pub(crate) fn spacing(self, object: &ObjectSection) -> f64 {
        match self {
            Self::For(Purpose::Benchmark | Purpose::Indexed) => object.benchmark_spacing,
            Self::For(Purpose::Stimulus) => object.stimulus_spacing,
            Self::Cells(cells, _) => {
                let longest = (0..3).map(|axis| object.max[axis] - object.min[axis]).fold(0.0, f64::max);
                longest / f64::from(cells)
            }
            Self::Spacing(spacing, _) => spacing,
        }
    }
}

/// A configuration, ready to make.
#[derive(Clone)]
pub(crate) struct Prepared<'a> {
    /// Which one.
    pub(crate) id: ConfigurationId,
    /// What is sampled; inside is above the isovalue.
    pub(crate) field: &'a dyn StudyField,
    /// The value of the surface.
    pub(crate) isovalue: f32,
    /// Where the field is sampled.
    pub(crate) grid: BoxGrid,
    /// The cells of a grid, where that is the object.
    pub(crate) own_cells: Option<&'a Grid>,
    /// How the mesh comes to be.
    pub(crate) recipe: Recipe,
    /// What is done to it afterwards.
    pub(crate) finish: Vec<Step>,
}

/// Finds what a configuration needs.
///
/// # Errors
/// If its field cannot be made, or its recipe is none; the study, the key and what is allowed are named.
pub(crate) fn prepare<'a>(
    study: &Study,
    fields: &'a Fields<'_>,
    spacings: &Spacings,
    configuration: &Configuration,
    wanted: Wanted,
) -> Result<Prepared<'a>> {
    let object = study.object(configuration);
    let made = fields.get(configuration.object)?;
    let spacing = match wanted {
        Wanted::For(purpose) => spacings.of(&configuration.id, purpose),
        _ => None,
    };
    Ok(Prepared {
        id: configuration.id.clone(),
        field: &*made.field,
        isovalue: made.isovalue,
        grid: grid(object, spacing.unwrap_or_else(|| wanted.spacing(object))),
        own_cells: made.cells.as_deref(),
        recipe: recipe(study, configuration.id.method, wanted.purpose())?,
        finish: recipe::finish(study, configuration.id.method)?,
    })
}

impl<'a> Prepared<'a> {
    /// What the extractor is given; `None` for what is no extractor of ours.
    pub(crate) fn extractor(&self) -> Option<isostudy_bench::Prepared<'a>> {
        let Recipe::Extractor(method) = self.recipe else { return None };
        Some(isostudy_bench::Prepared { field: self.field, method, grid: self.grid, isovalue: self.isovalue })
    }

    /// What a family is asked, by a field that may count its calls.
    pub(crate) fn asked<'f>(&'f self, field: &'f dyn StudyField) -> Asked<'f> {
        Asked { field, grid: self.grid, isovalue: self.isovalue, own_cells: self.own_cells }
    }

    /// Cells of the grid along x, y and z: those of the method, or as many as fill the box.
    ///
    /// # Errors
    /// If the grid is none.
    pub(crate) fn cells(&self) -> Result<[u32; 3]> {
        Ok(match &self.recipe {
            Recipe::Extractor(method) => method.cells(&self.grid)?,
            Recipe::Program(_) | Recipe::Meshes(_) | Recipe::Family(_) => {
                self.grid.lattice(Arrangement::SimpleCubic)?.cells()
            }
        })
    }
}

/// Spacings that were found for methods with a budget, in place of their objects'.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct Spacings(Vec<(ConfigurationId, Purpose, f64)>);

impl Spacings {
    /// What was found; `None` where the object's spacing holds.
    pub(crate) fn of(&self, id: &ConfigurationId, purpose: Purpose) -> Option<f64> {
        self.0.iter().find(|(of, for_, _)| of == id && *for_ == purpose).map(|(.., spacing)| *spacing)
    }

    /// Whether nothing was looked for.
    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Keeps what was found.
    pub(crate) fn keep(&mut self, id: ConfigurationId, purpose: Purpose, spacing: f64) {
        self.0.push((id, purpose, spacing));
    }
}

/// An object's volume, filled with cubes.
pub(crate) fn grid(object: &ObjectSection, spacing: f64) -> BoxGrid {
    BoxGrid { bounds: fields::bounds(object), spacing: spacing as f32 }
}

/// Checks that every method goes with every grid of the study, and that what the extractor holds of it fits into memory.
///
/// # Errors
/// The first that does not, naming file, key and limit.
pub(crate) fn check(study: &Study, machine_bytes: Option<u64>) -> Result<()> {
    let cores = std::thread::available_parallelism().map_or(1, |n| n.get());
    let execution = Execution { threads: cores.max(study.file.benchmark.threads as usize) };
    let check = |key: String, i: usize, id: MethodId, wanted: Wanted| -> Result<()> {
        let object = &study.file.objects[i];
        let spacing = wanted.spacing(object);
        let Recipe::Extractor(method) = recipe(study, id, wanted.purpose())? else { return Ok(()) };
        let grid = grid(object, spacing);
        if let Some(seed) = seeds::outside(&method, &grid.bounds) {
            let (key, Bounds { min, max }) = (recipe::key(study, id), grid.bounds);
            let (id, from, to) = (&object.id, place(min), place(max));
            bail!(
                "{key}.{seed}: this seed lies outside of the box of object {id}, from {from} to {to}; \
                 each seed must lie in the box of each object"
            );
        }
        // What does not go together whatever the grid is the recipe's fault.
        if let Err(error @ MethodError::Extract(_)) = method.check(&grid) {
            bail!("{}: {error}", recipe::key(study, id));
        }
        check_memory(study, i, &method, &grid, &execution, machine_bytes)
            .with_context(|| format!("{} = {spacing:?}", study_key::place(study, &key)))
    };
    for i in 0..study.file.objects.len() {
        for (purpose, name) in
            [(Purpose::Benchmark, "benchmark_spacing"), (Purpose::Stimulus, "stimulus_spacing")]
        {
            for method in &study.methods {
                check(format!("objects[{i}].{name}"), i, method.id, Wanted::For(purpose))?;
            }
        }
    }
    for (i, still) in study.file.stills.iter().enumerate() {
        let named = study.configurations.iter().find(|c| c.id == still.configuration);
        let object = named.expect("checked when the study was read").object;
        let wanted = Wanted::Spacing(still.spacing, Purpose::Stimulus);
        check(format!("stills[{i}].spacing"), object, still.configuration.method, wanted)?;
    }
    // What is coarser than an animation's mesh needs less; where a method has no such grid the viewer says so.
    let factors = study.file.viewer.iter().flat_map(|viewer| viewer.resolutions.iter().enumerate());
    for (r, &factor) in factors.filter(|(_, factor)| **factor < 1.0) {
        for (i, object) in study.file.objects.iter().enumerate() {
            for method in &study.methods {
                let wanted = Wanted::Spacing(factor * object.stimulus_spacing, Purpose::Stimulus);
                let key = format!("viewer.resolutions[{r}] = {factor:?}: spacing of objects[{i}]");
                check(key, i, method.id, wanted)?;
            }
        }
    }
    Ok(())
}

/// Checks a study's sweep: that each value makes a recipe, that each method has resolutions, and that what is held at the finest fits into
/// memory.
///
/// # Errors
/// The first that does not, naming file, key and limit.
pub(crate) fn check_cases(study: &Study, machine_bytes: Option<u64>) -> Result<()> {
    let Some(sweep) = study.sweep() else { return Ok(()) };
    let finest = sweep.section.cells.iter().copied().max().unwrap_or_default();
    let file = study.path.display();
    for pair in &sweep.pairs {
        let (id, object) = (pair.configuration.id.method, pair.configuration.object);
        let check = |study: &Study, key: &str| -> Result<()> {
            let method = match recipe(study, id, Purpose::Benchmark).with_context(|| key.to_owned())? {
                Recipe::Extractor(method) => method,
                Recipe::Meshes(_) => {
                    bail!("{key}: {id}: its meshes are there already, so it has no place in a sweep")
                }
                Recipe::Family(of) => match of.has_one_resolution() {
                    Some(on) => bail!("{key}: {id}: it works on {on}, so it has no place in a sweep"),
                    None => return Ok(()),
                },
                Recipe::Program(_) => return Ok(()),
            };
            let wanted = Wanted::Cells(finest, Purpose::Benchmark);
            let grid = grid(&study.file.objects[object], wanted.spacing(&study.file.objects[object]));
            if let Err(error @ MethodError::Extract(_)) = method.check(&grid) {
                bail!("{key}: {error}");
            }
            check_memory(study, object, &method, &grid, &Execution { threads: 1 }, machine_bytes)
                .with_context(|| format!("{key}, with {finest} cells per axis"))
        };
        check(study, &format!("{file}: sweep of {}", pair.configuration.id))?;
        for setting in pair.settings() {
            for (place, value) in sweep.extremes(setting) {
                let own = sweep.study_of(pair, &[Chosen { setting, place, value }])?;
                check(
                    &own,
                    &format!("{file}: sweep.settings[{setting}]: {} = {value}", sweep.name(setting)),
                )?;
            }
        }
    }
    Ok(())
}

/// Checks every grid of a sweep of times, as [`check`].
///
/// # Errors
/// The first that cannot be filled or does not fit, naming file, key and limit.
pub(crate) fn check_thread_sweep(
    study: &Study,
    section: &ThreadSweepSection,
    machine_bytes: Option<u64>,
) -> Result<()> {
    let threads = section.threads.iter().copied().max().unwrap_or(1) as usize;
    for (i, &cells) in section.cells.iter().enumerate() {
        let objects = study.file.objects.iter().enumerate();
        for (place, object) in objects.filter(|(_, object)| section.objects.contains(&object.id)) {
            let wanted = Wanted::Cells(cells, Purpose::Indexed);
            for of in &study.methods {
                let Recipe::Extractor(method) = recipe(study, of.id, Purpose::Indexed)? else { continue };
                let grid = grid(object, wanted.spacing(object));
                check_memory(study, place, &method, &grid, &Execution { threads }, machine_bytes)
                    .with_context(|| {
                        format!("{}: benchmark.sweep.cells[{i}] = {cells}", study.path.display())
                    })?;
            }
        }
    }
    Ok(())
}

/// Checks that a method goes with a grid of an object, and that what the extractor holds of it, beside the object's volume, fits into
/// what the study allows and the machine has.
///
/// # Errors
/// If it does not, naming the limit.
pub(crate) fn check_memory(
    study: &Study,
    object: usize,
    method: &Method,
    grid: &BoxGrid,
    execution: &Execution,
    machine_bytes: Option<u64>,
) -> Result<()> {
    let volume = fields::volume(study, object)?;
    Limit::of_study(study, machine_bytes).check_method(method, grid, execution, volume)
}

#[cfg(test)]
mod tests {
    use super::*;
    use isostudy_extract::{Placement, Positions, Tetrahedra, Topology};
    use std::path::Path;

    /// The paper's file with one passage replaced.
    fn paper_with(from: &str, to: &str) -> Result<Tetrahedra> {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs/paper.toml");
        let text = std::fs::read_to_string(&path)?;
        assert!(text.contains(from), "{from} is not in {}", path.display());
        let study = Study::parse(&text.replacen(from, to, 1), &path)?;
        let Recipe::Extractor(Method::Tetrahedra(of)) =
            recipe(&study, study.methods[0].id, Purpose::Benchmark)?
        else {
            bail!("no tetrahedra");
        };
        Ok(of)
    }

    #[test]
    fn what_is_left_out_has_the_extractors_default() {
        let topology = |to| paper_with("topology = \"published\"", to).unwrap().topology;
        assert_eq!(
            (topology("topology = \"published\""), topology("")),
            (Topology::Published, Topology::Guarded)
        );
        let positions = |to| paper_with("accumulation_chunks = 16", to).unwrap().positions;
        assert_eq!(positions("accumulation_chunks = 16"), Positions::Accumulated { chunks: 16 });
        assert_eq!(positions(""), Positions::Accumulated { chunks: 1 });
        let placement = |to| paper_with("placement = \"mean-of-crossings\"", to).unwrap().placement;
        assert_eq!(
            (placement(""), placement("placement = \"relaxed\"")),
            (Placement::MeanOfCrossings, Placement::Relaxed)
        );
        // Chunks say nothing where positions follow from indices.
        let indexed = paper_with("positions = \"accumulated\"", "positions = \"indexed\"").unwrap();
        assert_eq!(indexed.positions, Positions::Indexed);
    }

    #[test]
    fn what_no_recipe_has_is_refused_with_what_there_is() {
        let told = |from, to| format!("{:#}", paper_with(from, to).unwrap_err());
        let error = told("placement = \"mean-of-crossings\"", "placement = \"nearest\"");
        for part in [
            "paper.toml: line 59: extraction",
            "nearest",
            "mean-of-crossings",
            "curvature-weighted",
            "relaxed",
        ] {
            assert!(error.contains(part), "{error}");
        }
        let error = told("refine_crossings = false", "refine_crossings = 4");
        assert!(error.contains("4") && error.contains("boolean"), "{error}");
        let error = told("refine_crossings = false", "refine_crossing = false");
        assert!(error.contains("refine_crossing") && error.contains("refine_crossings"), "{error}");
    }
}
