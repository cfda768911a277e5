//! `isostudy analyse`: tables and figures of answers, of a study or without one.

mod self_test;

use super::given_answers::served;
use super::reading_rules::ReadingRules;
use crate::origin;
use crate::outcome::Outcome;
use crate::store::{self, Store};
use crate::terminal::{counted, say};
use crate::{answer_files, input, kept_answers, manifest, pipeline};
use anyhow::{Context, Result, bail};
use clap::Args;
use isostudy_design::Published;
use isostudy_table::Table;
use pipeline::Said;
use self_test::SelfTest;
use std::path::{Path, PathBuf};

/// Lines that are printed before the last two, which are what was found and the file to open; of a table that is too long the file is
/// named.
const MOST_LINES: usize = 28;

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[arg(required_unless_present = "self_test", help = analysed())]
    input: Option<PathBuf>,
    /// Answers to read instead of the study's own: its table, the long format, or a questionnaire's export
    #[arg(long, value_name = "FILE")]
    responses: Option<PathBuf>,
    #[command(flatten)]
    reading: ReadingRules,
    /// Folder for tables and figures [default: results/<study id>-answers, or results/<file name>-answers]; with --part, the file to write
    #[arg(long, short, value_name = "PATH")]
    out: Option<PathBuf>,
    /// Count answers without a study as many, however few they are: factors, worths and tests of pairs alone
    #[arg(long, conflicts_with_all = ["responses", "self_test"])]
    many: bool,
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
    if arguments.many {
        bail!("--many is for answers without a study, and {} is a study", input.display());
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
    let told: Vec<&Table> = said.tables.iter().filter(|table| is_told(&table.name)).collect();
    // With a line between them.
    let printed: Vec<String> =
        told.iter().map(|table| format!("{}\n", table.to_markdown().trim_end())).collect();
    let fits = fitting(&printed.iter().map(|text| 1 + text.lines().count()).collect::<Vec<_>>());
    for ((table, text), fits) in told.iter().zip(&printed).zip(fits) {
        match fits {
            true => say(text)?,
            false => {
                let path = out.join(format!("tables/{}.md", table.name));
                say(&format!("{}, {}: {}", table.caption, rows(table.rows.len()), path.display()))?;
            }
        }
    }
    say(said.found.as_deref().unwrap_or("No answers are left to say anything about."))?;
    say(&out.join("report.html").display().to_string())
}

fn rows(number: usize) -> String {
    counted(number as u64, "row")
}

/// Which of so many texts of so many lines are printed, so that they and a line for each of the others are [`MOST_LINES`] at most.
/// The shortest are printed first, so that most are.
fn fitting(lines: &[usize]) -> Vec<bool> {
    let mut left = MOST_LINES.saturating_sub(lines.len());
    let mut fits = vec![false; lines.len()];
    let mut order: Vec<usize> = (0..lines.len()).collect();
    order.sort_by_key(|&place| lines[place]);
    for place in order {
        let more = lines[place].saturating_sub(1);
        fits[place] = more <= left;
        left -= if fits[place] { more } else { 0 };
    }
    fits
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
    let said = pipeline::write_without_study(path, &section, reading, arguments.many, &store)?;
    store.remove_retired()?;
    let digest = store::sha256_of_file(path)?;
    manifest::write(
        &manifest::Origin { name: &name, sha256: digest, seed: None, inputs: Default::default() },
        &store,
    )?;
    print(&said, |name| ["tests", "worths"].contains(&name), &out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_printed_fits() {
        assert_eq!(fitting(&[12, 20, 9, 8]), [false, false, true, true]);
        assert_eq!(fitting(&[28]), [true]);
        assert_eq!(fitting(&[29]), [false]);
        for lines in [&[12, 20, 9, 8][..], &[14, 14], &[27, 2], &[0, 0, 28]] {
            let printed = lines.iter().zip(fitting(lines)).map(|(own, fits)| if fits { *own } else { 1 });
            assert!(printed.sum::<usize>() <= MOST_LINES, "{lines:?}");
        }
    }
}
