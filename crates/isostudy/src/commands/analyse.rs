//! `isostudy analyse`: tables and figures of answers, of a study or without one.

mod self_test;

use super::given_answers::served;
use super::reading_rules::ReadingRules;
use crate::origin;
use crate::outcome::Outcome;
use crate::store::{self, Store};
use crate::terminal::say;
use crate::{answer_files, input, kept_answers, manifest, pipeline};
use anyhow::{Context, Result, bail};
use clap::Args;
use isostudy_design::Published;
use pipeline::Said;
use self_test::SelfTest;
use std::path::{Path, PathBuf};

/// Rows of a table that is printed; of a longer one its file is named.
const LONGEST: usize = 20;

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[arg(required_unless_present = "self_test", help = analysed())]
    input: Option<PathBuf>,
    /// Answers to read instead of the study's own: its table, the long format, or a questionnaire's export
    #[arg(long, value_name = "FILE")]
    responses: Option<PathBuf>,
    #[command(flatten)]
    reading: ReadingRules,
    /// Folder for tables and figures [default: results/<study id>-answers, or results/<file name>-answers]
    #[arg(long, short, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    self_test: SelfTest,
}

/// What may be analysed, with the columns that are read.
fn analysed() -> String {
    let (needed, others) = isostudy_responses::LONG_COLUMNS.split_at(isostudy_responses::LONG_NEEDED);
    format!(
        "Study file, such as configs/paper.toml, or a file of answers without a study: columns {} and optionally {}. A row with \
         a count stands for so many people, whom it does not name",
        needed.join(", "),
        others.join(", ")
    )
}

/// Reads the answers, writes tables, figures and report, and prints the tables of preferences; or proves itself.
///
/// # Errors
/// If the answers cannot be read or a file cannot be written.
pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    if arguments.self_test.self_test {
        return self_test::run(&arguments.self_test, arguments.out.as_deref());
    }
    analyse(arguments)?;
    Ok(Outcome::Done)
}

/// A study file ends in `.toml`; anything else is a file of answers.
fn analyse(arguments: &Arguments) -> Result<()> {
    let input = arguments.input.as_deref().context("no study file")?;
    let is_study = input.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml"));
    if !is_study {
        return analyse_without_study(arguments, input);
    }
    let mut study = input::study(input)?;
    if arguments.responses.is_some() {
        // Published numbers are about the answers that were published.
        study.published = Published::default();
        study.responses.clone_from(&arguments.responses);
    }
    let folder = kept_answers::folder(&study, None);
    if study.responses.is_none() {
        study.responses = served(&study, &folder)?;
    }
    study.file.responses = Some(arguments.reading.section(Some(&study))?);
    let no_answers = || {
        let (file, folder) = (input.display(), folder.display());
        format!(
            "{file} names no responses, and {folder} has no answers of `isostudy serve`; give --responses"
        )
    };
    let reading = answer_files::of_study(&study)?.with_context(no_answers)?;
    answer_files::announce(&reading.report);
    let folder = || Path::new("results").join(format!("{}-answers", study.file.study.id));
    let out = arguments.out.clone().unwrap_or_else(folder);
    let store = Store::open(&out, false)?;
    origin::claim(&out, &study.path)?;
    let said = pipeline::write_answers_only(&study, reading, &store)?;
    store.remove_retired()?;
    manifest::write(&manifest::Origin::of(&study)?, &store)?;
    print(&said, |name| name.starts_with("preference_"), &out)
}

/// The tables that are short, then what was found, and the file to open.
fn print(said: &Said, is_told: impl Fn(&str) -> bool, out: &Path) -> Result<()> {
    for table in said.tables.iter().filter(|table| is_told(&table.name)) {
        match table.rows.len() {
            0..=LONGEST => say(&table.to_markdown())?,
            rows => {
                say(&format!("{rows} rows: {}", out.join(format!("tables/{}.md", table.name)).display()))?
            }
        }
    }
    said.found.iter().try_for_each(|sentence| say(sentence))?;
    say(&out.join("report.html").display().to_string())
}

fn analyse_without_study(arguments: &Arguments, path: &Path) -> Result<()> {
    if arguments.responses.is_some() {
        bail!(
            "--responses belongs to a study, and {} is none: its name does not end in .toml",
            path.display()
        );
    }
    let section = arguments.reading.section(None)?;
    let (reading, _) = answer_files::without_study(path, &section)?;
    answer_files::announce(&reading.report);
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let folder = || Path::new("results").join(format!("{name}-answers"));
    let out = arguments.out.clone().unwrap_or_else(folder);
    let store = Store::open(&out, false)?;
    origin::claim(&out, path)?;
    let said = pipeline::write_without_study(path, &section, &reading, &store)?;
    store.remove_retired()?;
    let digest = store::sha256(&input::bytes(path)?);
    manifest::write(
        &manifest::Origin { name: &name, sha256: digest, seed: None, inputs: Default::default() },
        &store,
    )?;
    print(&said, |name| ["tests", "worths"].contains(&name), &out)
}
