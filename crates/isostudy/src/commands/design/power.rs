//! `isostudy design power`: how likely a study is to find a preference. It is simulated in `isostudy_inference::power`.

use super::forms_section;
use crate::commands::given_answers::served;
use crate::commands::parts::{self, Simulation};
use crate::origin;
use crate::outcome::Outcome;
use crate::terminal::progress::Step;
use crate::terminal::{counted, say};
use crate::{answer_files, input, kept_answers, store};
use anyhow::{Context, Result, bail, ensure};
use clap::{Args, Parser};
use isostudy_design::Study;
use isostudy_inference::power::{
    Assumptions, Power, Spread, Way, blank, powers, simulated, spread_between_people,
};
use isostudy_inference::series::{Part, Series};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// The spread between people that is assumed where nothing is known of it, in logits.
const UNKNOWN: f64 = 1.0;
/// The largest number of participants.
const MOST_PEOPLE: u32 = 100_000;

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Study file with [forms], such as configs/balanced.toml
    study: PathBuf,
    /// Numbers of participants [default: from a sixth to twice of forms.participants]
    #[arg(long, value_name = "N,N", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(1..=i64::from(MOST_PEOPLE)))]
    participants: Vec<u32>,
    /// Shares of decided answers for the first of two properties
    #[arg(long, value_name = "SHARE,SHARE", value_delimiter = ',', value_parser = share, default_values_t = [0.6, 0.69, 0.77])]
    shares: Vec<f64>,
    /// Liking for the left side, in logits; 1.5 is strong
    #[arg(long, value_name = "LOGITS,LOGITS", value_delimiter = ',', value_parser = bias, allow_negative_numbers = true, default_values_t = [0.0])]
    side_bias: Vec<f64>,
    /// Spread between people: the standard deviation of their preferences, in logits [default: estimated from the study's answers; 1
    /// where there are none]
    #[arg(long, visible_alias = "person-sd", value_name = "LOGITS", value_parser = deviation)]
    spread: Option<f64>,
    /// Estimate the spread between people from these answers to the study
    #[arg(long, value_name = "RESPONSES", conflicts_with = "spread")]
    spread_of: Option<PathBuf>,
    /// Standard deviation between objects, in logits
    #[arg(long, value_name = "LOGITS", value_parser = deviation, default_value_t = 0.5)]
    object_sd: f64,
    /// Davidson's tie parameter nu: two equal items tie with chance nu / (2 + nu)
    #[arg(long, value_name = "NU", value_parser = deviation, default_value_t = 0.3)]
    ties: f64,
    /// How people are asked: pairs (left, no preference, right), forced (left, right), graded (five steps), best-of-3, best-of-4 or
    /// ratings (each of the two from 1 to 7) [default: forms.way of the study]
    #[arg(long, value_name = "WAY", value_parser = way)]
    way: Option<Way>,
    /// Studies to simulate for each share
    #[arg(long, value_name = "N", default_value_t = 2000, value_parser = clap::value_parser!(u64).range(parts::STUDIES))]
    studies: u64,
    /// Seed of the simulated studies; the same seed gives the same numbers on any number of threads
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,
    /// Simulate one part of all studies, such as 3/100 for the third of 100 parts, and write what it counted to the file --out
    #[arg(long, requires = "out", value_name = "K/N", value_parser = parts::part)]
    part: Option<Part>,
    /// Simulate nothing, and read the files of all parts in any order: what is written is what one run of all studies writes
    #[arg(
        long,
        value_name = "FILE",
        num_args = 1..,
        conflicts_with_all = ["part", "participants", "shares", "side_bias", "spread", "spread_of", "object_sd", "ties", "way", "studies", "seed"]
    )]
    merge: Vec<PathBuf>,
    /// Folder for tables and figure [default: results/<study id>-power]; with --part, the file to write
    #[arg(long, short, value_name = "PATH")]
    out: Option<PathBuf>,
}

fn is_share(value: f64) -> bool {
    value > 0.0 && value < 1.0
}

fn is_deviation(value: f64) -> bool {
    (0.0..=100.0).contains(&value)
}

fn is_bias(value: f64) -> bool {
    (-20.0..=20.0).contains(&value)
}

fn share(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    if is_share(value) {
        Ok(value)
    } else {
        Err("allowed: above 0 and below 1, such as 0.69 for 69 %".into())
    }
}

fn deviation(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    if is_deviation(value) { Ok(value) } else { Err("allowed: 0 to 100".into()) }
}

fn way(text: &str) -> Result<Way, String> {
    let known = || Way::ALL.map(Way::code).join(", ");
    Way::of_code(text).ok_or_else(|| format!("allowed: {}", known()))
}

fn bias(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    if is_bias(value) { Ok(value) } else { Err("allowed: -20 to 20".into()) }
}

/// In the order in which they are given, each once.
fn distinct(values: &[f64]) -> Vec<f64> {
    let mut distinct: Vec<f64> = Vec::new();
    values.iter().for_each(|value| {
        if !distinct.contains(value) {
            distinct.push(*value);
        }
    });
    distinct
}

/// The planned number where it is simulated, else the largest.
fn participants_told(numbers: &[usize], planned: usize) -> usize {
    numbers.iter().copied().find(|&n| n == planned).or(numbers.last().copied()).unwrap_or(planned)
}

/// The spread between people that is assumed, in logits; says on standard error where it comes from.
fn spread(arguments: &Arguments, study: &Study) -> Result<f64> {
    if let Some(given) = arguments.spread {
        return Ok(given);
    }
    let mut study = study.clone();
    if let Some(path) = &arguments.spread_of {
        study.responses = Some(path.clone());
    } else if study.responses.is_none() {
        study.responses = served(&study, &kept_answers::folder(&study, None))?;
    }
    let Some(path) = study.responses.clone() else {
        tell!(
            "spread between people: {UNKNOWN} logits are assumed, since there are no answers to estimate it from"
        );
        return Ok(UNKNOWN);
    };
    let path = path.display();
    let reading = answer_files::of_study(&study)?.expect("responses are named");
    match spread_between_people(&study, reading.responses) {
        Ok(Spread { of, people }) => {
            let (sd, [low, high]) = (of.sd, [of.interval.low, of.interval.high]);
            tell!(
                "spread between people: {sd:.2} logits ({low:.2} to {high:.2}), estimated from the answers of {} in {path}; \
                 --spread {high:.2} plans for the upper end",
                counted(people, "participant")
            );
            Ok(sd)
        }
        Err(reason) if arguments.spread_of.is_some() => {
            bail!("{path}: the spread between people is {reason}")
        }
        Err(reason) => {
            tell!("{path}: the spread between people is {reason}; {UNKNOWN} logits are assumed");
            Ok(UNKNOWN)
        }
    }
}

/// What is assumed, as the files of parts have it: named like the arguments.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Simulated {
    participants: Vec<usize>,
    shares: Vec<f64>,
    side_bias: Vec<f64>,
    spread: f64,
    object_sd: f64,
    ties: f64,
    /// The code of a [`Way`]; files of pairs, and older ones, have none.
    #[serde(default = "pairs", skip_serializing_if = "is_pairs")]
    way: String,
    studies: u64,
    seed: u64,
}

fn pairs() -> String {
    Way::Pairs.code().into()
}

fn is_pairs(way: &str) -> bool {
    way == Way::Pairs.code()
}

impl From<Assumptions> for Simulated {
    fn from(of: Assumptions) -> Self {
        Self {
            participants: of.participants,
            shares: of.shares,
            side_bias: of.side_biases,
            spread: of.person_sd,
            object_sd: of.object_sd,
            ties: of.ties,
            way: of.way.code().into(),
            studies: of.studies,
            seed: of.seed,
        }
    }
}

impl From<Simulated> for Assumptions {
    fn from(of: Simulated) -> Self {
        Self {
            participants: of.participants,
            shares: of.shares,
            side_biases: of.side_bias,
            person_sd: of.spread,
            object_sd: of.object_sd,
            ties: of.ties,
            way: Way::of_code(&of.way).unwrap_or_default(),
            studies: of.studies,
            seed: of.seed,
        }
    }
}

impl Simulated {
    /// A file may say what no argument may.
    fn check(&self) -> Result<()> {
        let numbers = &self.participants;
        ensure!(
            !numbers.is_empty()
                && numbers.is_sorted_by(|a, b| a < b)
                && numbers.iter().all(|number| (1..=MOST_PEOPLE as usize).contains(number)),
            "participants: allowed: numbers from 1 to {MOST_PEOPLE} that ascend"
        );
        ensure!(Way::of_code(&self.way).is_some(), "way: allowed: {}", Way::ALL.map(Way::code).join(", "));
        let (least, most) = parts::STUDIES.into_inner();
        ensure!(parts::STUDIES.contains(&self.studies), "studies: allowed: {least} to {most}");
        ensure!(
            !self.shares.is_empty() && self.shares.iter().all(|&share| is_share(share)),
            "shares: allowed: above 0 and below 1"
        );
        ensure!(
            !self.side_bias.is_empty() && self.side_bias.iter().all(|&bias| is_bias(bias)),
            "side_bias: allowed: -20 to 20"
        );
        let deviations = [self.spread, self.object_sd, self.ties];
        ensure!(deviations.into_iter().all(is_deviation), "spread, object_sd, ties: allowed: 0 to 100");
        Ok(())
    }
}

/// What the arguments and the study say is assumed.
fn assumptions(arguments: &Arguments, study: &Study, planned: usize) -> Result<Assumptions> {
    let mut participants: Vec<usize> = arguments.participants.iter().map(|&n| n as usize).collect();
    if participants.is_empty() {
        // In twelfths of the plan: from a sixth to twice.
        participants = [2, 4, 6, 8, 12, 16, 24].map(|twelfths| (planned * twelfths).div_ceil(12)).into();
    }
    participants.sort_unstable();
    participants.dedup();
    let asked = Way::of_code(forms_section(study)?.way.code()).unwrap_or_default();
    Ok(Assumptions {
        participants,
        shares: distinct(&arguments.shares),
        side_biases: distinct(&arguments.side_bias),
        person_sd: spread(arguments, study)?,
        object_sd: arguments.object_sd,
        ties: arguments.ties,
        way: arguments.way.unwrap_or(asked),
        studies: arguments.studies,
        seed: arguments.seed,
    })
}

/// Simulates a part of the studies, and says how far it is.
fn series(study: &Study, assumptions: &Assumptions, part: Part) -> Result<Vec<Series>> {
    let cases = assumptions.shares.len() * assumptions.side_biases.len();
    let own = part.studies(assumptions.studies);
    let studies = cases * (own.end - own.start) as usize;
    let step = Step::begin("studies", studies, studies);
    let found = simulated(study, assumptions, part, &|| step.tick(1));
    step.count_all(true);
    step.end();
    found.with_context(|| nothing(study))
}

fn nothing(study: &Study) -> String {
    format!("{}: there is no comparison to simulate", study.path.display())
}

/// What was assumed in all parts, and what they counted.
fn merged(
    simulation: &Simulation<'_>,
    study: &Study,
    paths: &[PathBuf],
) -> Result<(Assumptions, Vec<Series>)> {
    let parts = simulation.read(paths)?;
    let assumptions = parts.arguments(Simulated::check)?.into();
    let blank = blank(study, &assumptions).with_context(|| nothing(study))?;
    Ok((assumptions, parts.whole(blank)?))
}

/// The arguments that hold where only a study is given.
#[derive(Debug, Parser)]
struct Defaults {
    #[command(flatten)]
    arguments: Arguments,
}

/// What is assumed where nothing but the study is given.
///
/// # Errors
/// If the study has no forms, or its answers cannot be read.
pub(in crate::commands) fn default_assumptions(study: &Study) -> Result<Assumptions> {
    let words = [Path::new("power").as_os_str(), study.path.as_os_str()];
    let planned = forms_section(study)?.participants as usize;
    assumptions(&Defaults::parse_from(words).arguments, study, planned)
}

fn simulation(study: &Study) -> Simulation<'_> {
    Simulation { command: "design power", study: Some(study) }
}

/// Assumptions as files of parts have them, for digests.
pub(in crate::commands) fn assumed(assumptions: &Assumptions) -> impl Serialize + use<> {
    Simulated::from(assumptions.clone())
}

/// The file that `--part` writes.
///
/// # Errors
/// As [`run`].
pub(in crate::commands) fn part_file(
    study: &Study,
    assumptions: &Assumptions,
    part: Part,
) -> Result<Vec<u8>> {
    let series = series(study, assumptions, part)?;
    simulation(study).file(&assumed(assumptions), part, &series)
}

/// The files that `--merge` writes of all parts.
///
/// # Errors
/// As [`run`].
pub(in crate::commands) fn files_of_parts(
    study: &Study,
    paths: &[PathBuf],
) -> Result<Vec<(String, Vec<u8>)>> {
    let (assumptions, series) = merged(&simulation(study), study, paths)?;
    files(&assumptions, &found(study, &assumptions, &series)?)
}

fn found(study: &Study, assumptions: &Assumptions, series: &[Series]) -> Result<Vec<Power>> {
    let found = powers(study, assumptions, series).unwrap_or_default();
    ensure!(!found.is_empty(), nothing(study));
    Ok(found)
}

/// The figure and the tables.
fn files(assumptions: &Assumptions, found: &[Power]) -> Result<Vec<(String, Vec<u8>)>> {
    let figure = isostudy_report::power_figure(assumptions, found)?;
    let mut files =
        vec![("power.svg".to_owned(), figure.svg.into_bytes()), ("power.png".to_owned(), figure.png)];
    for table in isostudy_report::power_tables(assumptions, found) {
        files.push((format!("{}.csv", table.name), table.to_csv().into_bytes()));
        files.push((format!("{}.md", table.name), table.to_markdown().into_bytes()));
    }
    Ok(files)
}

/// Prints and writes how likely the study is to find a preference; or writes what a part of the simulation counted.
///
/// # Errors
/// If the study cannot be read or has no forms, a part cannot be read or is none of this simulation, or a file cannot be written.
pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    let study = input::study(&arguments.study)?;
    let planned = forms_section(&study)?.participants as usize;
    let simulation = simulation(&study);
    let (assumptions, series) = if arguments.merge.is_empty() {
        let assumptions = assumptions(arguments, &study, planned)?;
        let series = series(&study, &assumptions, arguments.part.unwrap_or(Part::WHOLE))?;
        if let (Some(part), Some(out)) = (arguments.part, &arguments.out) {
            say(&simulation.write(out, &Simulated::from(assumptions), part, &series)?)?;
            return Ok(Outcome::Done);
        }
        (assumptions, series)
    } else {
        merged(&simulation, &study, &arguments.merge)?
    };
    let found = found(&study, &assumptions, &series)?;
    let tables = isostudy_report::power_tables(&assumptions, &found);
    let folder = || Path::new("results").join(format!("{}-power", study.file.study.id));
    let out = arguments.out.clone().unwrap_or_else(folder);
    std::fs::create_dir_all(&out).with_context(|| out.display().to_string())?;
    origin::claim(&out, &study.path)?;
    for (name, bytes) in files(&assumptions, &found)? {
        store::write_whole(&out.join(name), &bytes)?;
    }
    say(&tables[2].to_markdown())?;
    let told = participants_told(&assumptions.participants, planned);
    for sentence in isostudy_report::power_sentences(&assumptions, &found, told) {
        say(&sentence)?;
    }
    say(&out.display().to_string())?;
    Ok(Outcome::Done)
}
