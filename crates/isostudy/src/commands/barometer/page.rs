//! The page of a recording, its tables as text, and the figure that shows speed against correctness.

use super::told::{Recording, Table, wrapped};
use crate::outcome::Outcome;
use crate::store::write_whole;
use anyhow::{Context, Result, bail};
use clap::Args;
use isostudy_barometer::engine::Takes;
use isostudy_barometer::ranks::Quantity;
use isostudy_barometer::recording::{Row, State};
use isostudy_report::{EnginePoint, barometer_figure};
use minijinja::{Environment, context};
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Folder of the recording
    recording: PathBuf,
    /// Put the tables into this page too, between its two marks `<!-- barometer -->` and `<!-- end of barometer -->`
    #[arg(long, value_name = "FILE")]
    into: Option<PathBuf>,
}

const BEGIN: &str = "<!-- barometer -->";
const END: &str = "<!-- end of barometer -->";

/// The largest page that tables are put into.
const LARGEST_PAGE: u64 = 16 << 20;
/// Ranks over fewer workloads are not shown.
const LEAST_WORKLOADS: usize = 3;

const PAGE: &str = include_str!("page.html");

/// Writes everything that is made of a recording.
///
/// # Errors
/// If it cannot be read, or a file cannot be written.
pub(super) fn run(arguments: &Arguments) -> Result<Outcome> {
    // Before anything is written.
    let into = arguments.into.as_ref().map(|path| parts(path).map(|parts| (path, parts))).transpose()?;
    write(&arguments.recording)?;
    if let Some((path, [before, after])) = into {
        let tables = std::fs::read_to_string(arguments.recording.join("tables.md"))?;
        write_whole(path, format!("{before}{BEGIN}\n\n{tables}\n{END}{after}").as_bytes())?;
    }
    Ok(Outcome::Done)
}

/// What stands before and after the two marks of a page.
fn parts(path: &Path) -> Result<[String; 2]> {
    let bytes = isostudy_foreign::bytes(path, LARGEST_PAGE).with_context(|| path.display().to_string())?;
    let text = String::from_utf8(bytes).with_context(|| path.display().to_string())?;
    let parts = text.split_once(BEGIN).and_then(|(before, rest)| Some((before, rest.split_once(END)?.1)));
    match parts {
        Some((before, after)) => Ok([before.to_owned(), after.to_owned()]),
        None => bail!("{}: there are no marks {BEGIN} and {END}", path.display()),
    }
}

/// Writes `tables.md`, `speed-and-correctness.svg` and `.png`, and `index.html`.
///
/// # Errors
/// As [`run`].
pub(super) fn write(folder: &Path) -> Result<()> {
    let recording = Recording::read(folder)?;
    let mut tables = vec![recording.conformance_table()];
    tables.extend(recording.rank_tables(LEAST_WORKLOADS));
    tables.push(recording.wrong_table());
    tables.push(recording.engine_table());
    let text: Vec<String> = tables.iter().map(Table::markdown).collect();
    write_whole(
        &folder.join("tables.md"),
        format!("{}\n\n{}", wrapped(&heading(&recording)), text.join("\n")).as_bytes(),
    )?;
    let figure = barometer_figure(&points(&recording))?;
    write_whole(&folder.join("speed-and-correctness.svg"), figure.svg.as_bytes())?;
    write_whole(&folder.join("speed-and-correctness.png"), &figure.png)?;
    let mut environment = Environment::new();
    environment.add_template("page.html", PAGE)?;
    let rows: Vec<_> = tables
        .iter()
        .map(|Table { title, words, head, rows }| context! { title, words, head, rows })
        .collect();
    let page = environment.get_template("page.html")?.render(context! {
        heading => heading(&recording),
        svg => figure.svg,
        caption => figure.caption,
        tables => rows,
    })?;
    write_whole(&folder.join("index.html"), page.as_bytes())
}

fn heading(recording: &Recording) -> String {
    let about = &recording.about;
    let date = if about.date.is_empty() { "no date" } else { &about.date };
    format!(
        "Recorded on {date}, on {} CPUs of {}, {} rounds. Each engine has one thread. Times hold for this machine.",
        about.cpus, about.cpu, about.rounds
    )
}

/// Engines that are given samples and are ranked by time.
fn points(recording: &Recording) -> Vec<EnginePoint> {
    let ranking = recording.ranking(Quantity::Time, Takes::Samples);
    let right = |engine: &str| {
        let asked = recording.rows.iter().filter(|row| row.engine == engine && row.state != State::NotAsked);
        let (right, other): (Vec<&Row>, Vec<&Row>) = asked.partition(|row| row.state == State::Right);
        let all = right.len() + other.len();
        (all > 0).then(|| right.len() as f64 / all as f64)
    };
    let ours = |engine: &str| recording.engines.iter().any(|row| row.engine == engine && row.ours);
    let point = |standing: &isostudy_barometer::ranks::Standing| {
        Some(EnginePoint {
            name: standing.engine.clone(),
            time: [standing.score, standing.low, standing.high],
            right: right(&standing.engine)?,
            ours: ours(&standing.engine),
        })
    };
    ranking.standings.iter().filter_map(point).collect()
}
