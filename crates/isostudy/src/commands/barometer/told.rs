//! Ranks and tables of a recording, in words.

use crate::outcome::Outcome;
use crate::terminal::{grouped, say};
use anyhow::{Context, Result, bail};
use clap::Args;
use isostudy_barometer::engine::Takes;
use isostudy_barometer::ranks::{Quantity, Ranking, rank};
use isostudy_barometer::recording::{About, ConformanceRow, EngineRow, Row, State, read};
use isostudy_barometer::workload::Group;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::fmt::Write;
use std::fs::File;
use std::path::{Path, PathBuf};

/// An engine that passed fewer of the workloads is not ranked: the others would be compared on too few.
const LEAST_SHARE: f64 = 0.5;
/// Draws workloads again.
const SEED: u64 = 7;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Folder of the recording
    recording: PathBuf,
    /// Only workloads of this group; may be given several times
    #[arg(long, value_name = "GROUP", value_parser = group)]
    group: Vec<Group>,
    /// Only this workload; may be given several times
    #[arg(long, value_name = "ID")]
    workload: Vec<String>,
    /// Only this engine; may be given several times
    #[arg(long, value_name = "ID")]
    engine: Vec<String>,
}

fn group(name: &str) -> Result<Group, String> {
    let names = || Group::ALL.map(Group::name).join(", ");
    Group::ALL
        .into_iter()
        .find(|group| group.name() == name)
        .ok_or_else(|| format!("the groups are {}", names()))
}

/// What lies in a folder.
pub(super) struct Recording {
    pub(super) about: About,
    pub(super) rows: Vec<Row>,
    pub(super) engines: Vec<EngineRow>,
    pub(super) conformance: Vec<ConformanceRow>,
    /// What the second check found; none where it was not run.
    pub(super) confirmed: Vec<Confirmed>,
}

/// A wrong verdict, and whether `scripts/barometer/confirm.py` finds the mesh wrong too.
#[derive(Debug, Deserialize)]
pub(super) struct Confirmed {
    workload: String,
    engine: String,
    confirmed: String,
}

/// A table for people.
pub(super) struct Table {
    pub(super) title: String,
    /// What it says, and what it does not.
    pub(super) words: String,
    pub(super) head: Vec<&'static str>,
    pub(super) rows: Vec<Vec<String>>,
}

impl Table {
    pub(super) fn markdown(&self) -> String {
        let mut text = format!("### {}\n\n{}\n\n", self.title, wrapped(&self.words));
        let line = |cells: &[String]| {
            let cells: Vec<String> = cells.iter().map(|cell| cell.replace('|', "\\|")).collect();
            format!("| {} |\n", cells.join(" | "))
        };
        text += &line(&self.head.iter().map(|&cell| cell.to_owned()).collect::<Vec<_>>());
        text += &line(&vec!["---".to_owned(); self.head.len()]);
        self.rows.iter().for_each(|row| text += &line(row));
        text
    }
}

/// In lines of a hundred characters.
pub(super) fn wrapped(words: &str) -> String {
    let mut text = String::new();
    let mut column = 0;
    for word in words.split(' ') {
        if column > 0 && column + 1 + word.chars().count() > 100 {
            text.push('\n');
            column = 0;
        } else if column > 0 {
            text.push(' ');
            column += 1;
        }
        text += word;
        column += word.chars().count();
    }
    text
}

impl Recording {
    /// # Errors
    /// If a file is missing or is no such file.
    pub(super) fn read(folder: &Path) -> Result<Self> {
        let about = folder.join("about.toml");
        let text = std::fs::read_to_string(&about).with_context(|| about.display().to_string())?;
        let found = Self {
            about: toml::from_str(&text).with_context(|| about.display().to_string())?,
            rows: rows(&folder.join("measurements.csv"))?,
            engines: rows(&folder.join("engines.csv"))?,
            conformance: rows(&folder.join("conformance.csv"))?,
            confirmed: match folder.join("confirmed.csv") {
                path if path.is_file() => rows(&path)?,
                _ => Vec::new(),
            },
        };
        if found.rows.is_empty() {
            bail!("{}: there are no measurements", folder.display());
        }
        Ok(found)
    }

    /// Ranks of engines that are given the same: samples, or a field.
    pub(super) fn ranking(&self, quantity: Quantity, takes: Takes) -> Ranking {
        let is_such = |row: &&Row| {
            self.engines.iter().any(|engine| engine.engine == row.engine && engine.takes == takes)
        };
        let rows: Vec<Row> = self.rows.iter().filter(is_such).cloned().collect();
        let noise = if quantity == Quantity::Time { self.about.noise_of_scores } else { 1.0 };
        rank(&rows, quantity, LEAST_SHARE, noise, SEED)
    }

    pub(super) fn name(&self, engine: &str) -> String {
        let row = self.engines.iter().find(|row| row.engine == engine);
        let name = row.map_or(engine, |row| row.name.as_str());
        if row.is_some_and(|row| row.ours) { format!("{name} *") } else { name.to_owned() }
    }

    /// Whether the second check found what the first one found; `None` where it was not run.
    fn is_confirmed(&self, workload: &str, engine: &str) -> Option<bool> {
        let of = self.confirmed.iter().find(|of| of.workload == workload && of.engine == engine)?;
        Some(of.confirmed == "yes")
    }

    fn counts(&self, engine: &str, state: State) -> usize {
        self.rows.iter().filter(|row| row.engine == engine && row.state == state).count()
    }

    /// A table of ranks; `None` where nothing can be ranked.
    fn rank_table(&self, quantity: Quantity, takes: Takes, least: usize) -> Option<Table> {
        let ranking = self.ranking(quantity, takes);
        if ranking.standings.len() < 2 || ranking.workloads.len() < least {
            return None;
        }
        let given = match takes {
            Takes::Samples => "engines that are given samples",
            Takes::Field => "engines that call a function, which interpolates the samples",
        };
        let count = ranking.workloads.len();
        let mut words = format!(
            "1 would be the best on each workload. Scores are geometric means over the {count} workloads that all of these engines passed. \
             Intervals are at 95 % over surfaces. Engines that are not distinguished share a rank, and so do all between them. *Behind* says \
             behind how many engines one is shown to be."
        );
        if quantity == Quantity::Time {
            let [low, high] = self.about.noise;
            _ = write!(
                words,
                " One engine in two processes differed by {low:.2} to {high:.2} on nine of ten workloads. Engines whose scores differ by less than \
                 {:.3} are not distinguished, since its two scores may.",
                self.about.noise_of_scores
            );
        }
        if quantity == Quantity::ErrorAtEqualTriangles {
            words += " Of labels there is none. It is the mean distance from the middles of triangles to the interpolated surface, times the triangles.";
        }
        if !ranking.left_out.is_empty() {
            let names: Vec<String> = ranking
                .left_out
                .iter()
                .map(|(engine, passed)| format!("{} ({passed})", self.name(engine)))
                .collect();
            _ = write!(words, " Passed too few to be ranked: {}.", names.join(", "));
        }
        Some(Table {
            title: format!("By {}, {given}", quantity.words()),
            words,
            head: vec!["rank", "engine", "behind", "score", "95 %"],
            rows: ranking
                .standings
                .iter()
                .map(|of| {
                    vec![
                        of.rank.to_string(),
                        self.name(&of.engine),
                        ranking.told.iter().filter(|(_, worse)| *worse == of.engine).count().to_string(),
                        format!("{:.2}", of.score),
                        format!("{:.2} to {:.2}", of.low, of.high),
                    ]
                })
                .collect(),
        })
    }

    /// Who passed how many workloads, and how many random grids.
    pub(super) fn conformance_table(&self) -> Table {
        let share = |part: u64, all: u64| match all {
            0 => String::new(),
            _ => format!("{:.2} %", 100.0 * part as f64 / all as f64),
        };
        let mut engines: Vec<&EngineRow> = self.engines.iter().filter(|engine| engine.ran).collect();
        engines.sort_by_key(|engine| {
            let counts = |state| self.counts(&engine.engine, state);
            (std::cmp::Reverse(counts(State::Right)), counts(State::Wrong), engine.name.clone())
        });
        let rows = engines.iter().map(|engine| {
            let id = engine.engine.as_str();
            let wrong = self.rows.iter().filter(|row| row.engine == id && row.state == State::Wrong);
            let (confirmed, open): (Vec<&Row>, Vec<&Row>) =
                wrong.partition(|row| self.is_confirmed(&row.workload, id) == Some(true));
            let mut cells = vec![self.name(id), self.counts(id, State::Right).to_string()];
            cells.extend([confirmed.len(), open.len()].map(|count| count.to_string()));
            cells.extend([State::Failed, State::NotAsked].map(|state| self.counts(id, state).to_string()));
            let found = self.conformance.iter().find(|row| row.engine == id);
            match found.filter(|row| row.grids > 0) {
                Some(row) if self.is_confirmed("random-grids", id) != Some(false) => {
                    cells.push(grouped(row.grids));
                    let parts = [row.same_topology, row.closed_manifold, row.right];
                    cells.extend(parts.map(|part| share(part, row.grids)));
                }
                Some(row) => {
                    let words = ["not confirmed".into(), String::new(), String::new()];
                    cells.extend([vec![grouped(row.grids)], words.to_vec()].concat());
                }
                None => cells.extend(["none".into(), String::new(), String::new(), String::new()]),
            }
            cells
        });
        let (grids, tunnels) = (grouped(self.about.grids), grouped(self.about.grids_with_tunnels));
        Table {
            title: "Who is right".into(),
            words: format!(
                "The first columns count workloads. *Right* and *wrong* are meshes; a wrong one is *unconfirmed* until a second check finds the same. \
                 *Failed* is an answer without a mesh. The last columns are of random grids of 4 x 4 x 4 samples, of which there are {grids}. An engine \
                 gets as many as it can do in 20 s. *Topology* is the share with the exact topology of the trilinear interpolant. *Closed manifold* is \
                 the share whose mesh is one, and *both* has both. {tunnels} grids have a cell with a tunnel. A method that does not promise this \
                 topology is not wrong to lack it. The makers of the barometer make the engines with an asterisk."
            ),
            head: vec![
                "engine",
                "right",
                "wrong",
                "unconfirmed",
                "failed",
                "not asked",
                "grids",
                "topology",
                "closed manifold",
                "both",
            ],
            rows: rows.collect(),
        }
    }

    /// What is wrong, where.
    pub(super) fn wrong_table(&self) -> Table {
        let wrong: Vec<&Row> = self.rows.iter().filter(|row| row.state == State::Wrong).collect();
        let confirmed: Vec<&Row> = wrong
            .iter()
            .copied()
            .filter(|row| self.is_confirmed(&row.workload, &row.engine) == Some(true))
            .collect();
        let failed = self.rows.iter().filter(|row| row.state == State::Failed);
        let words = if self.confirmed.is_empty() {
            "The second check has not run: `scripts/barometer/confirm.py RECORDING`, then `isostudy barometer report RECORDING`. Answers that \
             were no mesh are below."
                .to_owned()
        } else {
            format!(
                "Of {} wrong verdicts, {} were confirmed by a second check that shares no code with the first. These are below, with answers \
                 that were no mesh. `scripts/barometer/confirm.py RECORDING WORKLOAD ENGINE` shows each.",
                wrong.len(),
                confirmed.len()
            )
        };
        let rows = confirmed.into_iter().chain(failed);
        Table {
            title: "What is wrong".into(),
            words,
            head: vec!["workload", "engine", "what"],
            rows: rows
                .map(|row| vec![row.workload.clone(), self.name(&row.engine), row.faults.clone()])
                .collect(),
        }
    }

    /// Who was asked, and who could not be had.
    pub(super) fn engine_table(&self) -> Table {
        let rows = self.engines.iter().map(|engine| {
            let state = if engine.ran {
                engine.version.clone()
            } else {
                format!("could not be had: {}", engine.note)
            };
            vec![
                self.name(&engine.engine),
                state,
                engine.license.clone(),
                engine.family.clone(),
                engine.install.clone(),
            ]
        });
        Table {
            title: "Engines".into(),
            words: "Versions are those that the running programs told.".into(),
            head: vec!["engine", "version", "licence", "method", "from"],
            rows: rows.collect(),
        }
    }

    /// All tables of ranks over so many workloads at least.
    pub(super) fn rank_tables(&self, least: usize) -> Vec<Table> {
        let mut tables = Vec::new();
        for takes in [Takes::Samples, Takes::Field] {
            tables.extend(
                Quantity::ALL.into_iter().filter_map(|quantity| self.rank_table(quantity, takes, least)),
            );
        }
        tables
    }
}

fn rows<T: DeserializeOwned>(path: &Path) -> Result<Vec<T>> {
    let file = File::open(path).with_context(|| path.display().to_string())?;
    read(file).with_context(|| path.display().to_string())
}

/// Prints ranks of what was chosen.
///
/// # Errors
/// If the recording cannot be read, or has nothing of what was chosen.
pub(super) fn run(arguments: &Arguments) -> Result<Outcome> {
    let mut recording = Recording::read(&arguments.recording)?;
    let groups = &arguments.group;
    let chosen = |ids: &[String], id: &String| ids.is_empty() || ids.contains(id);
    for (what, ids, has) in [
        (
            "workload",
            &arguments.workload,
            &(|id: &str| recording.rows.iter().any(|row| row.workload == id)) as &dyn Fn(&str) -> bool,
        ),
        ("engine", &arguments.engine, &|id: &str| recording.rows.iter().any(|row| row.engine == id)),
    ] {
        if let Some(id) = ids.iter().find(|id| !has(id)) {
            bail!("{}: there is no {what} {id}", arguments.recording.display());
        }
    }
    recording.rows.retain(|row| {
        (groups.is_empty() || groups.contains(&row.group))
            && chosen(&arguments.workload, &row.workload)
            && chosen(&arguments.engine, &row.engine)
    });
    let tables = recording.rank_tables(1);
    if tables.is_empty() {
        bail!("{}: no workload was passed by all that were chosen", arguments.recording.display());
    }
    for table in tables {
        say(&table.markdown())?;
    }
    Ok(Outcome::Done)
}
