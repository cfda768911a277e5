//! `isostudy turntable`: the animations of a study, or one of a mesh in a file, in any look.

use super::named::named;
use super::object_of_study::object_of_study;
use super::source_arguments::SourceArguments;
use super::study_run::{Run, Selection, with_selection};
use crate::fields::Fields;
use crate::outcome::Outcome;
use crate::picture::{self, Drawn};
use crate::store::write_whole;
use crate::terminal::say;
use crate::{error_colours, input, mesh_file};
use anyhow::{Context, Result, bail};
use clap::{Args, ValueEnum};
use isostudy_design::config::{LightFollows, Look, StimulusLook};
use isostudy_field::StudyField;
use isostudy_mesh::TriangleMesh;
use isostudy_mesh::normals::area_weighted_normals;
use isostudy_raster::{Colouring, Shading, Turntable};
use std::path::{Path, PathBuf};

/// Share of the light that comes from all sides, where nothing is said.
const AMBIENT: f32 = 0.25;
/// Distance at the end of the scale, in spacings, where nothing is said.
const ERROR_SCALE: f32 = 0.1;
const SIZE: u32 = 512;
const FRAMES: u32 = 120;
const SECONDS: f64 = 8.0;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  isostudy turntable configs/paper.toml --only ss_bi
  isostudy turntable bunny.ply -o bunny.gif --look flat
  isostudy turntable bunny.ply -o quality.gif --colour quality
  isostudy turntable ball.ply -o error.gif --colour error --field 'sqrt(x^2+y^2+z^2) - 1' --bounds=-1.2,-1.2,-1.2,1.2,1.2,1.2")]
pub(crate) struct Arguments {
    /// Study file, such as configs/paper.toml, whose configurations are rendered; or a mesh: .obj, .ply or .stl, z up
    input: PathBuf,
    /// Of a study, the folder for results [default: results/<study id>]; of a mesh, the .gif to write
    #[arg(long, short, value_name = "PATH")]
    out: Option<PathBuf>,
    /// Threads to work with; 0 takes every core. The bytes are the same with any number
    #[arg(long, default_value_t = 0, value_name = "N", value_parser = clap::value_parser!(u32).range(..=1024))]
    threads: u32,
    /// Of a study, redo what is up to date as well
    #[arg(long)]
    force: bool,
    /// Of a study, run the programs that it names as methods; they may do whatever you may do
    #[arg(long)]
    allow_programs: bool,
    /// Of a study, run programs by bubblewrap: without a network, in a folder of their own, the system read-only
    #[arg(long)]
    sandbox: bool,
    /// Of a study, only these configurations, such as ss_bi [default: all]
    #[arg(long, value_name = "ID", value_delimiter = ',')]
    only: Vec<String>,
    #[command(flatten)]
    own: OfMesh,
    #[command(
        flatten,
        next_help_heading = "The isosurface for --colour error; distances are in units of --spacing"
    )]
    source: SourceArguments,
}

/// How a mesh is shown; a study says it in its file.
#[derive(Debug, Args)]
#[command(next_help_heading = "How a mesh is shown (a study says it in [turntable] and [shading])")]
struct OfMesh {
    /// smooth, flat, smooth-wireframe, creased [default: smooth; flat with --colour]
    #[arg(long, value_name = "NAME", value_parser = named::<StimulusLook>)]
    look: Option<StimulusLook>,
    /// Colours that stand for numbers, with a scale
    #[arg(long, value_name = "NAME")]
    colour: Option<Colour>,
    /// What the light is fixed to: scene or camera [default: camera]
    #[arg(long, value_name = "NAME", value_parser = named::<LightFollows>)]
    light_follows: Option<LightFollows>,
    /// Share of the light that comes from all sides, 0 to 1 [default: 0.25]
    #[arg(long, value_name = "SHARE", value_parser = share)]
    ambient: Option<f32>,
    /// With --look creased, the degrees by which triangles turn at an edge that is drawn sharp, at least [default: 40]
    #[arg(long, value_name = "DEGREES", value_parser = crease)]
    crease_deg: Option<f32>,
    /// With --colour error, the distance at the end of the scale, in spacings [default: 0.1]
    #[arg(long, value_name = "SPACINGS", value_parser = scale)]
    error_scale: Option<f32>,
    /// Pixels on each side, without the scale of colours [default: 512]
    #[arg(long, value_name = "PIXELS", value_parser = clap::value_parser!(u32).range(16..=4096))]
    size: Option<u32>,
    /// Frames in a turn of 8 seconds [default: 120]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=400))]
    frames: Option<u32>,
    /// The isosurface for --colour error: of this object of a study; --spacing is the study's for its animations if not given
    #[arg(long, value_name = "ID", conflicts_with_all = ["field", "volume", "mesh", "points", "soup", "bounds", "cells", "isovalue", "inside", "close", "allow_open"])]
    object: Option<String>,
    /// Study that has the object
    #[arg(long, value_name = "TOML", default_value = "configs/paper.toml", requires = "object")]
    study: PathBuf,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Colour {
    /// Radius ratio of each triangle
    Quality,
    /// Distance of each triangle to the isosurface: the largest at its corners, edges' middles and centroid
    Error,
}

fn share(text: &str) -> Result<f32, String> {
    let value: f32 = text.parse().map_err(|_| "not a number".to_owned())?;
    if (0.0..=1.0).contains(&value) { Ok(value) } else { Err("allowed: 0 to 1".into()) }
}

/// An angle between triangles.
pub(crate) fn crease(text: &str) -> Result<f32, String> {
    let value: f32 = text.parse().map_err(|_| "not a number".to_owned())?;
    if (0.0..=180.0).contains(&value) { Ok(value) } else { Err("allowed: 0 to 180".into()) }
}

fn scale(text: &str) -> Result<f32, String> {
    let value: f32 = text.parse().map_err(|_| "not a number".to_owned())?;
    if value > 0.0 && value <= 10.0 { Ok(value) } else { Err("allowed: above 0, at most 10".into()) }
}

impl OfMesh {
    /// The first option that only a mesh takes.
    fn given(&self) -> Option<&'static str> {
        let Self {
            look,
            colour,
            light_follows,
            ambient,
            crease_deg,
            error_scale,
            size,
            frames,
            object,
            study: _,
        } = self;
        let options = [
            ("--look", look.is_some()),
            ("--colour", colour.is_some()),
            ("--light-follows", light_follows.is_some()),
            ("--ambient", ambient.is_some()),
            ("--crease-deg", crease_deg.is_some()),
            ("--error-scale", error_scale.is_some()),
            ("--size", size.is_some()),
            ("--frames", frames.is_some()),
            ("--object", object.is_some()),
        ];
        options.into_iter().find(|(_, given)| *given).map(|(name, _)| name)
    }
}

impl Arguments {
    /// What is asked of a study, if the input is one.
    ///
    /// # Errors
    /// If an option is for the other kind of input.
    fn of_study(&self) -> Result<Option<Selection>> {
        let input = self.input.display();
        if !self.input.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml")) {
            if self.force || !self.only.is_empty() {
                bail!("--force and --only are for a study, which {input} is not: studies are .toml");
            }
            return Ok(None);
        }
        if let Some(option) = self.own.given().or(self.source.is_given().then_some("an isosurface")) {
            bail!(
                "{option} is for a mesh; {input} is a study, whose [turntable] and [shading] say how it is shown"
            );
        }
        let (study, out) = (self.input.clone(), self.out.clone());
        let run = Run {
            study,
            out,
            force: self.force,
            threads: self.threads,
            allow_programs: self.allow_programs,
            sandbox: self.sandbox,
        };
        Ok(Some(Selection { run, only: self.only.clone() }))
    }
}

/// Renders a study's configurations, or the mesh.
///
/// # Errors
/// If the input is wrong or a file cannot be written.
pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    let Some(selection) = arguments.of_study()? else {
        turn(arguments)?;
        return Ok(Outcome::Done);
    };
    with_selection(&selection, |pipeline, only, out| {
        let meshes = pipeline.stimulus_meshes(only)?;
        pipeline.turntables(&meshes, only)?;
        say(&out.join("stimuli/turntables").display().to_string())
    })
}

/// Reads the mesh, draws one turn and writes it.
///
/// # Errors
/// If the mesh or the isosurface cannot be had, or the file not be written.
fn turn(arguments: &Arguments) -> Result<()> {
    let (path, own) = (&arguments.input, &arguments.own);
    let out = arguments.out.as_deref().context("-o is needed: the .gif to write")?;
    if !out.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("gif")) {
        bail!("{}: animations are .gif", out.display());
    }
    for file in [Some(path.as_path()), arguments.source.file()].into_iter().flatten() {
        if input::is_same(file, out) {
            bail!("{}: is the input; it would be written over", out.display());
        }
    }
    let needs_surface = own.colour == Some(Colour::Error);
    if !needs_surface && (own.object.is_some() || own.error_scale.is_some() || arguments.source.is_given()) {
        bail!("an isosurface and --error-scale are for --colour error");
    }
    if own.crease_deg.is_some() && own.look != Some(StimulusLook::Creased) {
        bail!("--crease-deg is for --look creased");
    }
    let mut mesh = mesh_file::read(path)?;
    if mesh.normals.len() != mesh.positions.len() {
        mesh.normals = area_weighted_normals(&mesh.positions, &mesh.triangles);
    }
    let look = match own.colour {
        None => own.look.unwrap_or_default().into(),
        Some(Colour::Quality) => Look::Quality,
        Some(Colour::Error) => Look::Error,
    };
    let mut drawn = Drawn::new(&mesh, look, || error_colouring(arguments, &mesh))?;
    if let Some(look) = own.look {
        drawn = drawn.with_look(look.into());
    }
    let turntable = framed(&mut mesh, path, own)?;
    let shading = Shading::default();
    let shading = Shading {
        light_follows: picture::light_follows(own.light_follows.unwrap_or(LightFollows::Camera)),
        ambient: own.ambient.unwrap_or(AMBIENT),
        crease_deg: own.crease_deg.unwrap_or(shading.crease_deg),
        ..shading
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(arguments.threads as usize).build()?;
    let gif = pool.install(|| -> Result<Vec<u8>> {
        let mut gif = Vec::new();
        drawn.turned(&mesh, &turntable, &shading)?.write_gif(&mut gif)?;
        Ok(gif)
    });
    write_whole(out, &gif.with_context(|| path.display().to_string())?)?;
    say(&out.display().to_string())
}

/// A turn round the mesh, which is moved so that its middle is at the origin.
fn framed(mesh: &mut TriangleMesh, path: &Path, own: &OfMesh) -> Result<Turntable> {
    let bounds = mesh.surface_bounds().with_context(|| format!("{}: has no triangles", path.display()))?;
    let middle = (bounds.min + bounds.max) * 0.5;
    let radius = bounds.size().length() * 0.5;
    if !(radius > 0.0 && radius.is_finite()) {
        bail!("{}: has no extent that can be drawn", path.display());
    }
    mesh.positions.iter_mut().for_each(|p| *p -= middle);
    Ok(Turntable {
        width: own.size.unwrap_or(SIZE),
        height: own.size.unwrap_or(SIZE),
        frames: own.frames.unwrap_or(FRAMES),
        duration_s: SECONDS,
        ..Turntable::around(radius)
    })
}

/// Distances to the isosurface of a study's object, a formula, a volume or another mesh.
fn error_colouring(arguments: &Arguments, mesh: &TriangleMesh) -> Result<Colouring> {
    let (own, threads) = (&arguments.own, arguments.threads as usize);
    let most = own.error_scale.unwrap_or(ERROR_SCALE);
    if let Some(id) = &own.object {
        let study = input::study(&own.study)?;
        let index = object_of_study(&study, id)?;
        let object = &study.file.objects[index];
        let spacing = arguments.source.spacing.unwrap_or(object.stimulus_spacing as f32);
        let fields = Fields::new(&study);
        let made = fields.get(index)?;
        let field: &dyn StudyField = &*made.field;
        return error_colours::of(mesh, (field, made.isovalue, spacing), most, threads);
    }
    let source = arguments.source.read()?;
    let source = source.context(
        "--colour error: an isosurface is needed to be far from: --object, --field, --volume or --mesh",
    )?;
    let field: &dyn StudyField = &*source.field;
    error_colours::of(mesh, (field, source.isovalue, source.spacing), most, threads)
}
