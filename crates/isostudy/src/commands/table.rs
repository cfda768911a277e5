//! `isostudy table`: a table of triangles by signs, checked, and how good its triangles can be.

mod figure;
mod file;
mod places;

use super::source_arguments::SourceArguments;
use crate::outcome::Outcome;
use crate::terminal::say;
use anyhow::{Context, Result, bail};
use clap::{Args, ValueHint};
use isostudy_cells::{Cell, EdgeGroups, Table, radius_ratio};
use isostudy_extract::presets;
use places::Part;
use serde::Serialize;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// The version of the JSON.
const SCHEMA: u32 = 1;
/// How many of the worst triangles of a field are looked at.
const WORST: usize = 1000;

#[derive(Debug, Args)]
#[command(after_help = "\
A table says for each set of corners inside which triangles a cell has, by the edges that their corners lie on. It is checked: crossed
edges and no others are used, the surface ends in the faces alone, and cells that share a face agree on it. Exit code 2 says that it is none.

A file is JSON: { \"corners\": [[x, y, z], ...], \"entries\": [...] }. Entry number i is that of the corners whose bits i has; it is a list of
triangles, a triangle three edges, an edge two corners. Without corners it is the cube, corner i at (i & 1, i >> 1 & 1, i >> 2).

Examples:
  isostudy table mc --groups
  isostudy table bu --groups --field 'sqrt(x^2+y^2+z^2) - 1' --bounds=-1.2,-1.2,-1.2,1.2,1.2,1.2 --spacing 0.05
  isostudy table mc-edge-groups --json > table.json
  isostudy table mc mc-edge-groups mc-quality hull su bu --groups --figure groups.png")]
pub(crate) struct Arguments {
    /// A method by its name (`isostudy methods`); hull, the table by convex hulls; or a file that ends in .json
    /// With --figure several, and methods without a table too
    #[arg(value_name = "NAME", required = true, num_args = 1.., value_hint = ValueHint::FilePath)]
    tables: Vec<String>,
    /// Print the kinds of triangles by which edges their corners lie on, and how well shaped each is; of a surface, how many of its
    /// worst 1,000 triangles are of each
    #[arg(long)]
    groups: bool,
    /// Print JSON: the table, or with --groups that
    #[arg(long)]
    json: bool,
    /// Draw box plots, .png or .svg, of how good the triangles of each table are, and of which kinds the worst 1,000 are; over eight
    /// surfaces of our own, or of the one that is given
    #[arg(long, value_name = "FILE", requires = "groups", conflicts_with = "json")]
    figure: Option<PathBuf>,
    #[command(flatten)]
    source: SourceArguments,
}

/// Reads, checks and prints.
///
/// # Errors
/// If there is no such table, or it is none; if the surface cannot be read.
pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    if arguments.source.is_given() && !arguments.groups {
        bail!("--field, --volume, --mesh, --points and --soup are for --groups");
    }
    if let Some(path) = &arguments.figure {
        figure::write(&arguments.tables, arguments.source.read()?, arguments.source.limit(), path)?;
        say(&path.display().to_string())?;
        return Ok(Outcome::Done);
    }
    let [name] = &arguments.tables[..] else { bail!("several names are for --figure") };
    let tables =
        tables_of(name)?.with_context(|| format!("{name}: samples decide its triangles, not signs alone"))?;
    let text = match (arguments.groups, arguments.json) {
        (false, true) => file::write(&tables)?,
        (false, false) => summary(name, &tables),
        (true, is_json) => {
            let report = Report::new(name, arguments, &tables)?;
            if is_json { serde_json::to_string_pretty(&report)? } else { report.to_text(&tables) }
        }
    };
    say(text.trim_end())?;
    Ok(Outcome::Done)
}

/// The tables of a name: one, or those of a lattice's tetrahedra; `None` of a method that decides by samples.
fn tables_of(name: &str) -> Result<Option<Vec<Table>>> {
    if name.ends_with(".json") {
        return Ok(Some(vec![file::read(Path::new(name))?]));
    }
    if name == "hull" {
        return Ok(Some(vec![Table::by_hull(Cell::cube())]));
    }
    let with_tables = || presets().iter().filter(|preset| !preset.method.tables().is_empty());
    match presets().iter().find(|preset| preset.id == name) {
        Some(preset) => Ok(Some(preset.method.tables()).filter(|tables| !tables.is_empty())),
        None => {
            let known: Vec<&str> = with_tables().map(|preset| preset.id).collect();
            bail!("{name}: allowed: hull, a file that ends in .json, {}", known.join(", "))
        }
    }
}

fn summary(name: &str, tables: &[Table]) -> String {
    let [first, ..] = tables else { unreachable!("a name has a table") };
    let cells = if tables.len() == 1 { "one cell".into() } else { format!("{} cells", tables.len()) };
    format!(
        "{name}: {cells} of {} corners and {} edges, {} entries each, {} triangles; neighbours agree",
        first.cell().corners().len(),
        first.cell().edges().len(),
        first.entries().len(),
        triangles(tables).count(),
    )
}

fn triangles(tables: &[Table]) -> impl Iterator<Item = [u8; 3]> {
    tables.iter().flat_map(|table| table.entries().iter().flatten().copied())
}

#[derive(Serialize)]
struct Report {
    schema: u32,
    table: String,
    cells: usize,
    triangles: usize,
    groups: Vec<GroupRow>,
    /// Where a surface was given.
    #[serde(skip_serializing_if = "Option::is_none")]
    worst: Option<Worst>,
}

#[derive(Serialize)]
struct GroupRow {
    /// Triples of edges that are this kind, and one of them by the corners of its edges.
    triples: usize,
    example: [[u8; 2]; 3],
    /// End to end and not in one plane: group 2 of Dietrich et al.
    path: bool,
    /// Radius ratio over places of the corners along their edges: least, mean, greatest.
    radius_ratio: [f64; 3],
    below_0_1: f64,
    below_0_3: f64,
    /// Triangles of this kind in the table, and the entries that have one.
    triangles: usize,
    entries: usize,
}

/// The triangles of a surface with the smallest radius ratios.
#[derive(Serialize)]
struct Worst {
    source: String,
    triangles: u64,
    looked_at: usize,
    /// The greatest radius ratio among them.
    up_to: f64,
    /// By group.
    by_group: Vec<usize>,
    /// All triangles, by group.
    all_by_group: Vec<u64>,
}

impl Report {
    fn new(name: &str, arguments: &Arguments, tables: &[Table]) -> Result<Self> {
        let [first, ..] = tables else { unreachable!("a name has a table") };
        let groups = EdgeGroups::new(first.cell());
        let parts = parts(tables, &groups)?;
        let edge = |e: u8| first.cell().edges()[usize::from(e)];
        let row = |(number, group): (usize, &isostudy_cells::EdgeGroup)| {
            let of_entries = parts.iter().flat_map(|part| {
                part.table()
                    .entries()
                    .iter()
                    .map(|entry| entry.iter().filter(|&&triangle| part.group(triangle) == number).count())
            });
            let of_entries: Vec<usize> = of_entries.collect();
            GroupRow {
                triples: group.triples,
                example: group.example.map(edge),
                path: group.is_path,
                radius_ratio: group.quality,
                below_0_1: group.below[0],
                below_0_3: group.below[1],
                triangles: of_entries.iter().sum(),
                entries: of_entries.iter().filter(|&&count| count > 0).count(),
            }
        };
        Ok(Self {
            schema: SCHEMA,
            table: name.to_owned(),
            cells: tables.len(),
            triangles: triangles(tables).count(),
            groups: groups.all().iter().enumerate().map(row).collect(),
            worst: worst(arguments, &parts, groups.all().len())?,
        })
    }

    fn to_text(&self, tables: &[Table]) -> String {
        let mut text = summary(&self.table, tables);
        text.push_str("\n\n       radius ratio of its triangles, corners anywhere      in the table\n");
        text.push_str("triples   least    mean    most    <0.1    <0.3   triangles entries  edges\n");
        for (g, group) in self.groups.iter().enumerate() {
            let [least, mean, most] = group.radius_ratio;
            let GroupRow { triples, below_0_1, below_0_3, triangles, entries, .. } = group;
            let edges = group.example.map(|[a, b]| format!("{a}-{b}")).join(" ");
            let path = if group.path { ", a path in space" } else { "" };
            _ = write!(
                text,
                "{triples:>7} {least:>7.3} {mean:>7.3} {most:>7.3} {below_0_1:>7.3} {below_0_3:>7.3} {triangles:>11} {entries:>7}  \
                 {edges}{path}"
            );
            if let Some(worst) = &self.worst {
                let (worst, all) = (worst.by_group[g], worst.all_by_group[g]);
                _ = write!(text, "; {worst} of the worst, {all} of all");
            }
            text.push('\n');
        }
        if let Some(Worst { source, triangles, looked_at, up_to, .. }) = &self.worst {
            _ = write!(
                text,
                "\n{source}: of {triangles} triangles the worst {looked_at} have radius ratios up to {up_to:.4}"
            );
        }
        text
    }
}

/// Tables with the groups of the first one's cell.
fn parts<'a>(tables: &'a [Table], groups: &'a EdgeGroups) -> Result<Vec<Part<'a>>> {
    let parts = tables.iter().map(|table| Part::new(table, tables[0].cell(), groups));
    parts.collect::<Option<_>>().context("its cells are not of one shape")
}

/// The worst triangles of a surface, if one is given.
fn worst(arguments: &Arguments, parts: &[Part], groups: usize) -> Result<Option<Worst>> {
    let Some(source) = arguments.source.read()? else { return Ok(None) };
    let mut all: Vec<(f64, usize)> = Vec::new();
    places::for_each_triangle(&source, arguments.source.limit(), parts, |corners, group| {
        all.push((radius_ratio(corners), group));
    })
    .with_context(|| source.place())?;
    if all.is_empty() {
        bail!(source.no_surface());
    }
    let mut all_by_group = vec![0; groups];
    all.iter().for_each(|&(_, group)| all_by_group[group] += 1);
    let triangles = all.len() as u64;
    all.sort_by(|a, b| a.partial_cmp(b).expect("ratios are numbers"));
    all.truncate(WORST);
    let mut by_group = vec![0; groups];
    all.iter().for_each(|&(_, group)| by_group[group] += 1);
    let up_to = all.last().map_or(0.0, |&(ratio, _)| ratio);
    Ok(Some(Worst {
        source: source.name.clone(),
        triangles,
        looked_at: all.len(),
        up_to,
        by_group,
        all_by_group,
    }))
}
