//! The options that name a surface: a formula, a volume, a mesh, points or polygon soup, and where to look at it.

use crate::memory::{self, Limit};
use crate::scattered_file::WantedPoints;
use crate::source::{Inside, Options, Source};
use anyhow::{Context, Result, bail};
use clap::{Args, ValueEnum};
use glam::Vec3;
use isostudy_extract::{Execution, Method};
use isostudy_mesh::Bounds;
use isostudy_scattered::{FitSettings, Kernel, PointSettings};
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub(crate) struct SourceArguments {
    /// Formula in x, y and z, such as 'sqrt(x^2+y^2+z^2) - 1'; needs --bounds
    #[arg(long, value_name = "FORMULA", requires = "bounds", allow_hyphen_values = true)]
    field: Option<String>,
    /// Volume: .nrrd, .nhdr, .mha, .mhd, or the .toml that describes raw data; needs --isovalue
    #[arg(long, value_name = "FILE", requires = "level")]
    volume: Option<PathBuf>,
    /// Triangle mesh, of which the signed distance is taken: .obj, .ply or .stl
    #[arg(long, value_name = "FILE")]
    mesh: Option<PathBuf>,
    #[command(flatten)]
    scattered: ScatteredArguments,
    /// Box to look at: smallest corner, then largest [default: that of the volume, or round the mesh, the points or the soup]
    #[arg(long, value_name = "X,Y,Z,X,Y,Z", value_parser = bounds, allow_hyphen_values = true)]
    bounds: Option<Bounds>,
    /// Edge of the lattice's cubes [default: that of the volume's samples; otherwise 100 cubes along the longest side.
    /// Methods of cubes take the volume's own cells]
    #[arg(long, value_name = "LENGTH", value_parser = spacing, allow_hyphen_values = true, conflicts_with = "cells")]
    pub(super) spacing: Option<f32>,
    /// The same, as the number of cubes along the longest side
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=16384))]
    cells: Option<u32>,
    /// Value of the surface
    #[arg(long, default_value_t = 0.0, value_parser = finite, allow_hyphen_values = true, group = "level")]
    isovalue: f32,
    /// Side of the isovalue that is inside [default: below for a formula, above for a volume, points and soup; a mesh's
    /// distance is positive inside]
    #[arg(long, value_name = "SIDE", conflicts_with = "mesh")]
    inside: Option<Inside>,
    /// Close the surface where it leaves the volume, and where the box cuts it off
    #[arg(long)]
    close: bool,
    /// Take a mesh with holes: inside is what is seen from behind in most directions
    #[arg(long, conflicts_with_all = ["field", "volume", "points", "soup"])]
    allow_open: bool,
    /// Most memory for a volume's samples, the lattice, and the mesh with what finishing it takes. Such as 500MB or 16GiB. `extract` reads
    /// parts of a raw volume that does not fit
    #[arg(long, value_name = "SIZE", default_value = memory::DEFAULT, value_parser = memory::size)]
    memory: u64,
}

impl SourceArguments {
    /// The file that is read, if it is one.
    pub(super) fn file(&self) -> Option<&Path> {
        let scattered = self.scattered.points.as_deref().or(self.scattered.soup.as_deref());
        self.volume.as_deref().or(self.mesh.as_deref()).or(scattered)
    }

    /// Whether a surface is named.
    pub(super) fn is_given(&self) -> bool {
        self.field.is_some() || self.file().is_some()
    }

    /// What memory there is for it.
    pub(super) fn limit(&self) -> Limit {
        Limit::of(self.memory)
    }

    /// The volume, where one is named and nothing says which grid it is to be sampled on, or to close its surface.
    pub(super) fn volume_alone(&self) -> Option<&Path> {
        let is_alone = self.bounds.is_none() && self.spacing.is_none() && self.cells.is_none() && !self.close;
        self.volume.as_deref().filter(|_| is_alone)
    }

    pub(super) fn options(&self) -> Options {
        Options {
            bounds: self.bounds,
            spacing: self.spacing,
            cells: self.cells,
            isovalue: self.isovalue,
            inside: self.inside,
            close: self.close,
            allow_open: self.allow_open,
            limit: self.limit(),
            method: None,
            in_file: false,
        }
    }

    /// What is asked for, if anything is. What had to be done to it is said on standard error.
    ///
    /// # Errors
    /// If it cannot be read or has no inside.
    pub(super) fn read(&self) -> Result<Option<Source>> {
        self.read_by(self.options())
    }

    /// The same for a mesh by a method. What does not fit into memory with it is refused before samples are read.
    ///
    /// # Errors
    /// The same, and if it does not fit.
    pub(super) fn read_for(&self, method: &Method, execution: &Execution) -> Result<Option<Source>> {
        self.read_by(Options { method: Some((*method, *execution)), ..self.options() })
    }

    /// The same, and a volume that does not fit stays in its file.
    ///
    /// # Errors
    /// The same.
    pub(super) fn read_in_file_for(&self, method: &Method, execution: &Execution) -> Result<Option<Source>> {
        self.read_by(Options { method: Some((*method, *execution)), in_file: true, ..self.options() })
    }

    fn read_by(&self, options: Options) -> Result<Option<Source>> {
        self.scattered.check()?;
        if let Some(formula) = &self.field {
            let bounds = self.bounds.context("--bounds is needed")?;
            return options.of_formula(formula, bounds, "--field").map(Some);
        }
        if let Some(path) = &self.volume {
            return options.of_volume(path).map(Some);
        }
        if let Some(path) = &self.scattered.points {
            return options.of_points(path, &self.scattered.wanted()).map(Some);
        }
        if let Some(path) = &self.scattered.soup {
            return options.of_soup(path, self.scattered.epsilon).map(Some);
        }
        self.mesh.as_deref().map(|path| options.of_mesh(path)).transpose()
    }
}

/// Points and polygon soup, and how a field is made of them.
#[derive(Debug, Args)]
struct ScatteredArguments {
    /// Points with normals, such as a scan, through which a smooth surface goes: .ply, .xyz or .obj
    #[arg(long, value_name = "FILE")]
    points: Option<PathBuf>,
    /// Where the points' normals come from [default: given]
    #[arg(long, value_name = "NAME", requires = "points")]
    normals: Option<Normals>,
    /// How a centre of the points' spline acts at a distance [default: biharmonic]
    #[arg(long, value_name = "NAME", requires = "points")]
    kernel: Option<PointKernel>,
    /// How far beside the points values are given [default: twice the median distance between neighbours]
    #[arg(long, value_name = "LENGTH", value_parser = length, requires = "points", allow_hyphen_values = true)]
    offset: Option<f64>,
    /// Above 0 the surface passes by the points and is smoother; in the unit of the kernel [default: 0]
    #[arg(long, value_name = "NUMBER", value_parser = not_negative, requires = "points", allow_hyphen_values = true)]
    smoothing: Option<f64>,
    /// The most centres of the points' spline, 4 to 10000: of more places with a value, those with the largest errors [default: 3000]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(4..=10_000), requires = "points")]
    centres: Option<u32>,
    /// Triangles that need not hang together, near which the surface is: .obj, .ply or .stl
    #[arg(long, value_name = "FILE")]
    soup: Option<PathBuf>,
    /// The distance within which the triangles of soup are blended; 0 goes through them [default: 1 % of the diagonal of their box]
    #[arg(long, value_name = "LENGTH", value_parser = not_negative, requires = "soup", allow_hyphen_values = true)]
    epsilon: Option<f64>,
}

impl ScatteredArguments {
    /// clap asks for what an argument requires only where nothing else conflicts with that.
    ///
    /// # Errors
    /// If an argument has nothing to be about, naming both.
    fn check(&self) -> Result<()> {
        let of_points = [
            ("normals", self.normals.is_some()),
            ("kernel", self.kernel.is_some()),
            ("offset", self.offset.is_some()),
            ("smoothing", self.smoothing.is_some()),
            ("centres", self.centres.is_some()),
        ];
        let misplaced = of_points.iter().find(|(_, is_given)| *is_given && self.points.is_none());
        if let Some((name, _)) = misplaced {
            bail!("--{name} is for --points");
        }
        if self.epsilon.is_some() && self.soup.is_none() {
            bail!("--epsilon is for --soup");
        }
        Ok(())
    }
}

/// Where the normals of points come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Normals {
    /// From the file
    Given,
    /// From the planes of neighbours
    Estimated,
}

/// How a centre of a spline acts at a distance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum PointKernel {
    /// -r
    Biharmonic,
    /// r^3, which is smoother
    Triharmonic,
}

impl ScatteredArguments {
    fn wanted(&self) -> WantedPoints {
        let kernel = match self.kernel {
            Some(PointKernel::Triharmonic) => Kernel::Triharmonic,
            Some(PointKernel::Biharmonic) | None => Kernel::Biharmonic,
        };
        let mut fit = FitSettings { kernel, ..FitSettings::default() };
        fit.smoothing = self.smoothing.unwrap_or(fit.smoothing);
        fit.most_centres = self.centres.map_or(fit.most_centres, |centres| centres as usize);
        WantedPoints {
            are_normals_estimated: self.normals == Some(Normals::Estimated),
            settings: PointSettings { fit, offset: self.offset },
        }
    }
}

fn length(text: &str) -> Result<f64, String> {
    let value = not_negative(text)?;
    if value > 0.0 { Ok(value) } else { Err("allowed: above 0, at most 1e6".into()) }
}

fn not_negative(text: &str) -> Result<f64, String> {
    let value: f64 = text.trim().parse().map_err(|_| format!("`{text}` is not a number"))?;
    if (0.0..=1e6).contains(&value) { Ok(value) } else { Err("allowed: 0 to 1e6".into()) }
}

fn number(text: &str) -> Result<f32, String> {
    text.trim().parse().map_err(|_| format!("`{text}` is not a number"))
}

pub(super) fn finite(text: &str) -> Result<f32, String> {
    let value = number(text)?;
    if value.is_finite() { Ok(value) } else { Err(format!("isovalue must be finite, not {value}")) }
}

fn spacing(text: &str) -> Result<f32, String> {
    let value = number(text)?;
    let is_valid = value > 0.0 && value.is_finite();
    if is_valid { Ok(value) } else { Err(format!("spacing must be positive and finite, not {value:?}")) }
}

fn bounds(text: &str) -> Result<Bounds, String> {
    let numbers = text.split(',').map(number).collect::<Result<Vec<f32>, _>>()?;
    let [a, b, c, d, e, f] = numbers[..] else {
        return Err(
            "six numbers with commas between them: x,y,z of the smallest corner, then of the largest".into(),
        );
    };
    for (axis, min, max) in [("x", a, d), ("y", b, e), ("z", c, f)] {
        if !(min.is_finite() && max.is_finite() && min < max) {
            return Err(format!(
                "bounds along {axis} must be finite with min below max, not {min:?} to {max:?}"
            ));
        }
    }
    Ok(Bounds { min: Vec3::new(a, b, c), max: Vec3::new(d, e, f) })
}
