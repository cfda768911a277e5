//! `isostudy extract --isovalues`: several surfaces of one volume, which is read once and whose ranges are found once.

use super::super::source_arguments::finite;
use super::own_cells::Layers;
use super::{Arguments, open_edges};
use crate::file_samples::{FileSamples, InFile, Parts, stays_in_file};
use crate::memory::{Held, OfVolume};
use crate::outcome::Outcome;
use crate::source::{Inside, Options, values_of_samples};
use crate::store::write_whole_by;
use crate::terminal::{counted, say};
use crate::{input, mesh_file, seeds};
use anyhow::{Context, Result, bail};
use isostudy_extract::active::{ActiveCells, Bricks};
use isostudy_extract::{Execution, Extraction, Extractor, Method, VolumeCells};
use isostudy_field::StudyField;
use isostudy_mesh::MeshFormat;
use isostudy_volume::{Frame, Unread};
use serde::Serialize;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Where an isovalue goes in a file's name.
const PLACE: &str = "{isovalue}";
/// The most isovalues of a run: each is a file.
const MOST: usize = 10_000;

/// Different isovalues, in the order asked for.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Isovalues(Vec<f32>);

impl Isovalues {
    /// Numbers, and ranges `FROM:TO:COUNT` of so many numbers with both ends among them, with commas between.
    ///
    /// # Errors
    /// If something else is there, an isovalue twice, or more than there may be.
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        let mut all = Vec::new();
        for item in text.split(',') {
            match item.split(':').collect::<Vec<_>>()[..] {
                [value] => all.push(finite(value)?),
                [from, to, count] => all.extend(range(finite(from)?, finite(to)?, count)?),
                _ => return Err(format!("`{item}` is neither a number nor a range FROM:TO:COUNT")),
            }
            if all.len() > MOST {
                return Err(format!("more than {MOST} isovalues"));
            }
        }
        let mut sorted = all.clone();
        sorted.sort_by(f32::total_cmp);
        match sorted.windows(2).find(|pair| pair[0] == pair[1]) {
            Some(pair) => Err(format!("{} is there twice", pair[1])),
            None => Ok(Self(all)),
        }
    }

    /// Extracts, writes and reports them one by one.
    ///
    /// # Errors
    /// If the volume cannot be read, has none of the surfaces, or a file cannot be written.
    pub(super) fn extract(&self, arguments: &Arguments, out: &Path) -> Result<Outcome> {
        let path = arguments.source.file().context("--isovalues needs --volume")?;
        let (name, method) = (out.to_string_lossy(), arguments.method());
        if !name.contains(PLACE) {
            bail!("-o {name}: {PLACE} must stand where each isovalue goes, as in 'skull-{PLACE}.ply'");
        }
        let format = mesh_file::format_to_write(out).with_context(|| name.to_string())?;
        for &isovalue in &self.0 {
            let out = named(&name, isovalue);
            if input::is_same(path, &out) {
                bail!("{}: is the input; it would be written over", out.display());
            }
        }
        let none = match seeds::missed(&method) {
            Some(_) => "no surface reached from the seeds, no file",
            None => "no surface, no file",
        };
        let files = Files { name: &name, format, is_json: arguments.json, none };
        let execution = Execution { threads: arguments.threads as usize };
        let sweep = Sweep { isovalues: &self.0, arguments, path, method, execution, files };
        let (ranges, surfaces, values) =
            match arguments.source.volume_alone().filter(|_| method.is_of_cubes()) {
                Some(_) => sweep.on_own_cells()?,
                None => sweep.on_a_grid()?,
            };
        if surfaces.iter().all(|surface| surface.file.is_none()) {
            let all = counted(self.0.len() as u64, "isovalue");
            match seeds::missed(&method) {
                Some(why) => bail!("no surface was reached at any of {all}: {why}{values}"),
                None => bail!("no surface at any of {all}{values}"),
            }
        }
        if arguments.json {
            let report =
                Report { schema: 1, source: path.display().to_string(), ranges, surfaces: &surfaces };
            say(&serde_json::to_string_pretty(&report)?)?;
        }
        let is_sound = surfaces.iter().all(|surface| surface.is_sound);
        Ok(if is_sound { Outcome::Done } else { Outcome::CheckFailed })
    }
}

fn range(from: f32, to: f32, count: &str) -> Result<impl Iterator<Item = f32>, String> {
    let number: usize =
        count.trim().parse().map_err(|_| format!("`{count}` is not a number of isovalues"))?;
    if !(2..=MOST).contains(&number) {
        return Err(format!("a range has 2 to {MOST} isovalues, not {number}"));
    }
    let (from, to) = (f64::from(from), f64::from(to));
    Ok((0..number).map(move |i| (from + (to - from) * (i as f64 / (number - 1) as f64)) as f32))
}

/// A file's name with an isovalue in it.
fn named(name: &str, isovalue: f32) -> PathBuf {
    name.replace(PLACE, &isovalue.to_string()).into()
}

/// What is printed as JSON.
#[derive(Serialize)]
struct Report<'a> {
    schema: u32,
    source: String,
    /// Ranges of bricks, where the cells are the volume's own.
    ranges: Option<Ranges>,
    surfaces: &'a [Surface],
}

/// What was made once for all isovalues.
#[derive(Serialize)]
struct Ranges {
    build_s: f64,
    bytes: usize,
}

/// One surface.
#[derive(Serialize)]
struct Surface {
    isovalue: f32,
    /// None where there is no triangle.
    file: Option<String>,
    triangles: u64,
    cells_visited: u64,
    /// Wall-clock time to find the sides of the samples, seconds.
    search_s: f64,
    /// All other time of the extraction.
    triangles_s: f64,
    /// Whether it is closed, if it was to be.
    #[serde(skip)]
    is_sound: bool,
}

/// Where surfaces go.
struct Files<'a> {
    name: &'a str,
    format: MeshFormat,
    is_json: bool,
    /// What to say where there is no triangle.
    none: &'static str,
}

/// Several isovalues of a volume.
struct Sweep<'a> {
    isovalues: &'a [f32],
    arguments: &'a Arguments,
    path: &'a Path,
    method: Method,
    execution: Execution,
    files: Files<'a>,
}

/// What was made once, the surfaces, and what is known of the samples.
type Swept = (Option<Ranges>, Vec<Surface>, String);

impl Sweep<'_> {
    fn options(&self, isovalue: f32) -> Options {
        Options { isovalue, ..self.arguments.source.options() }
    }

    fn on_own_cells(&self) -> Result<Swept> {
        let name = || self.path.display().to_string();
        let (limit, before) = (self.arguments.source.limit(), Held::now());
        let unread = isostudy_volume::open(self.path)?;
        let Frame { counts, origin, steps, .. } = unread.frame();
        let method = seeds::in_steps(&self.method, &unread.frame()).with_context(name)?;
        let held = OfVolume::samples(&unread).with("the ranges of their bricks", Bricks::bytes_of(counts));
        if counts.iter().all(|&n| n > 1) {
            let grid = VolumeCells { counts, values: &[], origin, steps }.grid();
            let both = (held, OfVolume::in_file(&unread, 0));
            let asked = (&method, &grid, &self.execution);
            let in_file = stays_in_file(limit, &unread, both, Parts::Layers, asked).with_context(name)?;
            if let Some(in_file) = in_file {
                return self.on_own_cells_in_file(unread, &in_file, &method);
            }
        }
        let mut volume = limit.read(unread, held)?;
        let values = values_of_samples(&volume.values);
        let is_below = self.options(0.0).inside == Some(Inside::Below);
        // Inside is above for the extractor.
        if is_below {
            volume.values.iter_mut().for_each(|value| *value = -*value);
        }
        let cells = VolumeCells { counts, values: &volume.values, origin, steps };
        let began = Instant::now();
        let bricks = cells.bricks().with_context(name)?;
        let ranges = Ranges { build_s: began.elapsed().as_secs_f64(), bytes: ActiveCells::bytes(&bricks) };
        let mut extractor = Extractor::new();
        let surfaces = self.isovalues.iter().map(|&isovalue| {
            let level = if is_below { -isovalue } else { isovalue };
            let extract =
                || Ok(cells.extract_by_bricks(&bricks, &method, &mut extractor, level, &self.execution)?);
            let extraction = limit.hold(before, extract).with_context(name)?;
            self.files.keep(isovalue, &extraction, false)
        });
        let surfaces = surfaces.collect::<Result<_>>()?;
        Ok((Some(ranges), surfaces, values))
    }

    /// The same of a volume that stays in its file: it is read once for each isovalue, since no ranges of it are kept.
    fn on_own_cells_in_file(&self, unread: Unread, in_file: &InFile, method: &Method) -> Result<Swept> {
        let name = || self.path.display().to_string();
        let (limit, before, options) = (self.arguments.source.limit(), Held::now(), self.options(0.0));
        let frame = unread.frame();
        let Frame { counts, origin, steps, .. } = frame;
        let (samples, execution) = (Arc::new(FileSamples::open(unread, in_file)?), &in_file.execution);
        let layers = Layers { samples: &samples, is_below: options.inside == Some(Inside::Below) };
        let cells = VolumeCells { counts, values: &[], origin, steps };
        let mut extractor = Extractor::new();
        let surfaces = self.isovalues.iter().map(|&isovalue| {
            let level = if layers.is_below { -isovalue } else { isovalue };
            let extract = || Ok(cells.extract_stored(&layers, method, &mut extractor, level, execution)?);
            let extraction = samples.vouch(limit.hold(before, extract).with_context(name))?;
            self.files.keep(isovalue, &extraction, false)
        });
        let surfaces = surfaces.collect::<Result<Vec<_>>>()?;
        let mut values = String::new();
        if surfaces.iter().all(|surface| surface.file.is_none()) {
            let own = options.of_own_cells_in_file(&samples, &frame, execution, &name())?;
            own.source.values().clone_into(&mut values);
        }
        Ok((None, surfaces, values))
    }

    fn on_a_grid(&self) -> Result<Swept> {
        let (before, asked) = (Held::now(), Some((self.method, self.execution)));
        let options = Options { method: asked, in_file: true, ..self.options(0.0) };
        let read = options.read_volume(self.path)?;
        let mut extractor = Extractor::new();
        let mut values = String::new();
        let surfaces = self.isovalues.iter().map(|&isovalue| {
            let options = self.options(isovalue);
            let source = read.at(&options)?;
            let grid = source.grid();
            let field: &dyn StudyField = &*source.field;
            let execution = source.execution(&self.execution);
            let extract = || {
                let level = source.isovalue;
                Ok(self.method.extract(&mut extractor, field.into(), &grid, level, &execution)?)
            };
            let extraction = source.vouch(options.limit.hold(before, extract))?;
            source.values().clone_into(&mut values);
            self.files.keep(isovalue, &extraction, source.is_closed)
        });
        let surfaces = surfaces.collect::<Result<_>>()?;
        Ok((None, surfaces, values))
    }
}

impl Files<'_> {
    /// Writes a surface, if there is one, and says what it is.
    fn keep(&self, isovalue: f32, extraction: &Extraction, is_to_be_closed: bool) -> Result<Surface> {
        let Extraction { mesh, counts, times } = extraction;
        let seconds = |time: Duration| time.as_secs_f64();
        let mut surface = Surface {
            isovalue,
            file: None,
            triangles: counts.triangles,
            cells_visited: counts.cells_visited,
            search_s: seconds(times.sampling),
            triangles_s: seconds(times.total() - times.sampling),
            is_sound: true,
        };
        let found = if is_to_be_closed { open_edges(mesh) } else { None };
        if !mesh.triangles.is_empty() {
            let out = named(self.name, isovalue);
            write_whole_by(&out, |file| {
                let mut buffered = BufWriter::new(file);
                self.format.write(mesh, &mut buffered)?;
                buffered.flush()
            })?;
            surface.file = Some(out.display().to_string());
        }
        if !self.is_json {
            say(&surface.to_line(self.none))?;
        }
        if let (Some(found), Some(file)) = (found, &surface.file) {
            tell!("isostudy: {file}: the surface was to be closed and has {found}");
            surface.is_sound = false;
        }
        Ok(surface)
    }
}

impl Surface {
    fn to_line(&self, none: &str) -> String {
        let what = match &self.file {
            Some(file) => format!("{file}: {}", counted(self.triangles, "triangle")),
            None => format!("isovalue {}: {none}", self.isovalue),
        };
        let [search, rest] = [self.search_s, self.triangles_s].map(|time| 1e3 * time);
        let cells = counted(self.cells_visited, "cell");
        format!("{what}, {cells} visited, search {search:.2} ms, triangles {rest:.2} ms")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> Result<Vec<f32>, String> {
        Isovalues::parse(text).map(|isovalues| isovalues.0)
    }

    #[test]
    fn a_list_has_numbers_and_ranges_with_both_ends() {
        assert_eq!(parsed("300.5"), Ok(vec![300.5]));
        assert_eq!(parsed("3, -1,2"), Ok(vec![3.0, -1.0, 2.0]));
        assert_eq!(parsed("0:1:5"), Ok(vec![0.0, 0.25, 0.5, 0.75, 1.0]));
        assert_eq!(parsed("10:-10:3,7"), Ok(vec![10.0, 0.0, -10.0, 7.0]));
        let hundred = parsed("-0.1:0.7:100").unwrap();
        assert_eq!((hundred.len(), hundred[0], hundred[99]), (100, -0.1, 0.7));
    }

    #[test]
    fn what_is_no_list_is_refused_with_what_there_is() {
        for (text, said) in [
            ("", "is not a number"),
            ("1,,2", "is not a number"),
            ("bone", "`bone` is not a number"),
            ("inf", "finite"),
            ("nan", "finite"),
            ("1:2", "FROM:TO:COUNT"),
            ("1:2:3:4", "FROM:TO:COUNT"),
            ("1:2:one", "`one` is not a number of isovalues"),
            ("1:2:1", "2 to 10000"),
            ("1:2:10001", "2 to 10000"),
            ("0:1:10000,2", "more than 10000"),
            ("5,1,5", "5 is there twice"),
            ("0,-0", "0 is there twice"),
            ("2:2:2", "2 is there twice"),
        ] {
            let error = parsed(text).unwrap_err();
            assert!(error.contains(said), "{text}: {error}");
        }
    }

    #[test]
    fn names_have_the_shortest_number_that_is_the_isovalue() {
        let name = |isovalue| named("out/skull-{isovalue}.ply", isovalue).display().to_string();
        assert_eq!(name(300.5), "out/skull-300.5.ply");
        assert_eq!(name(-1000.0), "out/skull--1000.ply");
        assert_eq!(name(0.1), "out/skull-0.1.ply");
    }
}
