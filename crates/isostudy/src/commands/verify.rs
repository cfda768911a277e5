//! `isostudy verify`: whether a mesh has the topology of a volume's level set.

use crate::memory::{self, Limit, Needs, OfVolume};
use crate::mesh_file;
use crate::outcome::Outcome;
use crate::terminal::say;
use anyhow::{Context, Result};
use clap::{Args, ValueEnum};
use isostudy_mesh::weld;
use isostudy_trilinear::{Samples, Summary, Verdict, verify};
use serde::Serialize;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// The version of the JSON.
const SCHEMA: u32 = 1;

#[derive(Debug, Args)]
#[command(after_help = "\
The trilinear interpolant of the samples decides: components, Euler characteristic, tunnels and boundary loops of its level set are
counted exactly, without a mesh. Exit code 1 says that the mesh is another surface, or none.

Examples:
  isostudy verify head.ply --volume head.nrrd --isovalue 300.5
  isostudy verify vtk.stl --volume head.nrrd --isovalue 300 --ties inside --weld --json")]
pub(crate) struct Arguments {
    /// Mesh, made by any program: .obj, .ply or .stl
    mesh: PathBuf,
    /// Volume that it was made of: .nrrd, .nhdr, .mha, .mhd, or the .toml that describes raw data
    #[arg(long, value_name = "FILE")]
    volume: PathBuf,
    /// Value of the surface
    #[arg(long, value_name = "VALUE", allow_hyphen_values = true)]
    isovalue: f32,
    /// Side of a sample that equals the isovalue; inside is above it. VTK has such samples inside
    #[arg(long, value_name = "SIDE", default_value = "outside")]
    ties: Ties,
    /// Take vertices at the same coordinates for one, where triangles do not share theirs
    #[arg(long)]
    weld: bool,
    /// Most memory for the volume's samples and what is kept beside each. Such as 500MB or 16GiB
    #[arg(long, value_name = "SIZE", default_value = memory::DEFAULT, value_parser = memory::size)]
    memory: u64,
    /// Print JSON instead
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Ties {
    Outside,
    Inside,
}

impl From<Ties> for isostudy_trilinear::Ties {
    fn from(ties: Ties) -> Self {
        match ties {
            Ties::Outside => Self::Outside,
            Ties::Inside => Self::Inside,
        }
    }
}

#[derive(Serialize)]
struct Report<'a> {
    schema: u32,
    mesh: &'a Path,
    volume: &'a Path,
    isovalue: f32,
    right: bool,
    #[serde(flatten)]
    verdict: &'a Verdict,
}

/// Compares and prints.
///
/// # Errors
/// If mesh or volume cannot be read, or a sample is infinite or not a number.
pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    // Of the samples' size a header tells, before the mesh is read.
    let unread = isostudy_volume::open(&arguments.volume)?;
    let held = OfVolume::samples(&unread).with("the numbers of their edges", unread.memory_bytes());
    let limit = Limit::of(arguments.memory);
    limit.check(&Needs::of(Some(held))).with_context(|| arguments.volume.display().to_string())?;
    let mesh = mesh_file::read(&arguments.mesh)?;
    let mesh = if arguments.weld { weld(&mesh) } else { mesh };
    let volume = limit.read(unread, held)?;
    let verdict = || -> Result<Verdict> {
        let samples = Samples::try_new(volume.counts, &volume.values)?;
        Ok(verify(&mesh, &samples, arguments.isovalue, arguments.ties.into())?)
    };
    let verdict = &verdict().with_context(|| arguments.volume.display().to_string())?;
    let right = verdict.is_right();
    let Arguments { mesh, volume, isovalue, .. } = arguments;
    let report = Report { schema: SCHEMA, mesh, volume, isovalue: *isovalue, right, verdict };
    say(&if arguments.json { serde_json::to_string_pretty(&report)? } else { text(&report) })?;
    Ok(Outcome::of_check(right))
}

fn text(report: &Report) -> String {
    let Verdict { found, expected, tunnel_cells, findings, .. } = report.verdict;
    type Row = (&'static str, fn(&Summary) -> i64);
    let rows: [Row; 4] = [
        ("components", |summary| summary.components as i64),
        ("Euler characteristic", |summary| summary.euler_characteristic),
        ("boundary loops", |summary| summary.boundary_loops as i64),
        ("tunnels", |summary| summary.genus),
    ];
    let mut text = format!("{:<22}{:>12}{:>12}\n", "", "mesh", "samples");
    for (name, of) in rows {
        _ = writeln!(text, "{name:<22}{:>12}{:>12}", of(found), of(expected));
    }
    _ = writeln!(text, "cells with a tunnel   {:>12}{tunnel_cells:>12}", "");
    for finding in findings {
        _ = writeln!(text, "wrong: {} {}, should be {}", finding.found, finding.fault, finding.expected);
    }
    text.push_str(if report.right { "right" } else { "wrong" });
    text
}
