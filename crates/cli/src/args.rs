//! The command line.

use crate::source::SourceArguments;
use clap::builder::PossibleValuesParser;
use clap::{ArgGroup, Args, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;

/// Isosurface extraction methods in front of a clock, a ruler and people.
#[derive(Debug, Parser)]
#[command(name = "isostudy", version, arg_required_else_help = true, max_term_width = 100)]
#[command(after_help = "Exit codes: 0 done, 1 a check failed, 2 wrong usage or input.")]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Write a study file of one's own to begin with, each key explained
    New(crate::new::New),
    /// Do everything: meshes, animations, short benchmark, tables, figures, index.html
    Study(Run),
    /// Extract a surface from a formula, a volume or a mesh; or, given a study, the study's meshes, and measure them
    Extract(crate::surface::Extract),
    /// List the methods that have a name, what each promises, and its source
    Methods(crate::methods::Methods),
    /// Render a study's turntable animations; or, given a mesh, its own, in any look
    Turntable(crate::turning::Turn),
    /// Compose the side-by-side pairs and write the key
    Pairs(Pairs),
    /// Put together what participants get (forms and pairs, no key), and the researcher's contact sheet
    Bundle(Bundle),
    /// Put the questionnaire on the web, and keep the answers
    Serve(Serve),
    /// Join what participants downloaded from the page into one file of answers
    Collect(Collect),
    /// Write a server's answers without anything that leads to a person, with a codebook
    Deidentify(Deidentify),
    /// Time every configuration, with the study's full number of rounds
    Bench(Bench),
    /// Read the answers; print and write the preference tables and figures; or prove the analysis with --self-test
    Analyse(Analyse),
    /// Write answers in the long format or in another program's
    Convert(Convert),
    /// Write tables, figures and index.html again from the results that are there
    Report(Run),
    /// Check a study file and everything it names, without doing any work
    Validate(Validate),
    /// Extract one configuration and print what there is to know of it
    Inspect(Inspect),
    /// Measure how far two surfaces are from each other: Hausdorff, mean and RMS, both ways
    Distance(Distance),
    /// Judge a questionnaire before anyone answers, and deal its forms
    #[command(subcommand)]
    Design(Design),
}

#[derive(Debug, Subcommand)]
pub(crate) enum Design {
    /// Say what is wrong with a questionnaire; exit code 1 if anything is
    Check(Check),
    /// Write the participants' forms, and the key to them
    Forms(Run),
    /// Say how likely the study is to find a preference, by number of participants
    Power(Power),
    /// List what `design check` looks for
    Rules,
}

#[derive(Debug, Args)]
pub(crate) struct Check {
    /// Study file, such as configs/paper.toml
    pub(crate) study: PathBuf,
    /// Folder with the study's results; animations there are judged as well [default: results/<study id>]
    #[arg(long, value_name = "DIR")]
    pub(crate) results: Option<PathBuf>,
    /// Print the faults as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct Bundle {
    #[command(flatten)]
    pub(crate) run: Run,
    /// Put each pair in as H.264 video as well, by the ffmpeg on the PATH
    #[arg(long)]
    pub(crate) mp4: bool,
    /// Go on where `design check` finds faults
    #[arg(long)]
    pub(crate) with_faults: bool,
}

#[derive(Debug, Args)]
pub(crate) struct Serve {
    #[command(flatten)]
    pub(crate) run: Run,
    /// Folder of the answers, which are never among the results [default: answers/<study id>]
    #[arg(long, value_name = "DIR")]
    pub(crate) answers: Option<PathBuf>,
    /// Go on where `design check` finds faults
    #[arg(long)]
    pub(crate) with_faults: bool,
    /// Address to listen on; 0.0.0.0 lets others in
    #[arg(long, value_name = "IP", default_value = "127.0.0.1")]
    pub(crate) address: std::net::IpAddr,
    /// Port to listen on; 0 takes a free one
    #[arg(long, value_name = "PORT", default_value_t = 8080)]
    pub(crate) port: u16,
    /// Where participants reach the server, behind a web server on this machine or under a name, such as https://study.example.org
    #[arg(long, value_name = "URL")]
    pub(crate) public_url: Option<serve::PublicUrl>,
    /// People of one address that may begin at once, and in each further 100 seconds; 0 for any number
    #[arg(long, value_name = "N", default_value_t = serve::Limits::default().sessions_per_address)]
    pub(crate) sessions_per_address: u32,
    /// Start although the folder holds fewer answers than it did
    #[arg(long)]
    pub(crate) accept_loss: bool,
    /// What the researcher's page asks for, at least 12 characters [default: a new one, printed]
    #[arg(long, value_name = "TOKEN", env = "ISOSTUDY_ADMIN_TOKEN", hide_env_values = true)]
    pub(crate) admin_token: Option<String>,
}

#[derive(Debug, Args)]
pub(crate) struct Collect {
    /// Study file whose bundle was answered
    pub(crate) study: PathBuf,
    /// Files that the page gave, CSV or JSON
    #[arg(required = true)]
    pub(crate) downloads: Vec<PathBuf>,
    /// File to write, in the long format
    #[arg(long, short, value_name = "FILE")]
    pub(crate) out: PathBuf,
}

#[derive(Debug, Args)]
pub(crate) struct Deidentify {
    /// Study file that was served
    pub(crate) study: PathBuf,
    /// Folder of the answers [default: answers/<study id>]
    #[arg(long, value_name = "DIR")]
    pub(crate) answers: Option<PathBuf>,
    /// Folder to write answers.csv and codebook.md to
    #[arg(long, short, value_name = "DIR")]
    pub(crate) out: PathBuf,
}

#[derive(Debug, Args)]
pub(crate) struct Power {
    /// Study file with [forms], such as configs/balanced.toml
    pub(crate) study: PathBuf,
    /// Numbers of participants [default: from a sixth to twice of forms.participants]
    #[arg(long, value_name = "N,N", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(crate) participants: Vec<u32>,
    /// Shares of decided answers for the first of two properties
    #[arg(long, value_name = "SHARE,SHARE", value_delimiter = ',', value_parser = share, default_values_t = [0.6, 0.69, 0.77])]
    pub(crate) shares: Vec<f64>,
    /// Standard deviation between people, in logits
    #[arg(long, value_name = "LOGITS", value_parser = deviation, default_value_t = 1.0)]
    pub(crate) person_sd: f64,
    /// Standard deviation between objects, in logits
    #[arg(long, value_name = "LOGITS", value_parser = deviation, default_value_t = 0.5)]
    pub(crate) object_sd: f64,
    /// Davidson's tie parameter nu: two equal items tie with chance nu / (2 + nu)
    #[arg(long, value_name = "NU", value_parser = deviation, default_value_t = 0.3)]
    pub(crate) ties: f64,
    /// Studies to simulate for each share
    #[arg(long, value_name = "N", default_value_t = 2000, value_parser = clap::value_parser!(u64).range(100..=10_000_000))]
    pub(crate) studies: u64,
    /// Seed of the simulated studies; the same seed gives the same numbers on any number of threads
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Folder for tables and figure [default: results/<study id>-power]
    #[arg(long, short, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
}

fn share(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    if value > 0.0 && value < 1.0 { Ok(value) } else { Err("allowed: above 0 and below 1".into()) }
}

fn deviation(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    if (0.0..=100.0).contains(&value) { Ok(value) } else { Err("allowed: 0 to 100".into()) }
}

/// Where a study is read from and written to.
#[derive(Debug, Clone, Args)]
pub(crate) struct Run {
    /// Study file, such as configs/paper.toml
    pub(crate) study: PathBuf,
    /// Folder for results [default: results/<study id>]
    #[arg(long, short, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Redo what is up to date as well
    #[arg(long)]
    pub(crate) force: bool,
    /// Threads to work with; 0 takes every core. Meshes and pictures are the same bytes with any number; timings
    /// take the study's own
    #[arg(long, default_value_t = 0, value_name = "N", value_parser = clap::value_parser!(u32).range(..=1024))]
    pub(crate) threads: u32,
    /// Run the programs that the study names as methods; they may do whatever you may do
    #[arg(long)]
    pub(crate) allow_programs: bool,
}

/// Some of a study's configurations.
#[derive(Debug, Args)]
pub(crate) struct Selection {
    #[command(flatten)]
    pub(crate) run: Run,
    /// Only these configurations, such as ss_bi [default: all]
    #[arg(long, value_name = "ID", value_delimiter = ',')]
    pub(crate) only: Vec<String>,
}

#[derive(Debug, Args)]
pub(crate) struct Pairs {
    #[command(flatten)]
    pub(crate) run: Run,
    /// Write each pair as H.264 video as well, twice the size, by the ffmpeg on the PATH
    #[arg(long)]
    pub(crate) mp4: bool,
}

#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub(crate) struct Bench {
    #[command(subcommand)]
    pub(crate) verb: Option<BenchVerb>,
    #[command(flatten)]
    pub(crate) run: Option<Run>,
    /// Take the short plan of `isostudy study` instead: no A/A block, no memory; a full run that is up to date stands for it
    #[arg(long)]
    pub(crate) short: bool,
}

#[derive(Debug, Subcommand)]
pub(crate) enum BenchVerb {
    /// Say of every configuration whether it is faster in B than in A; exit 1 if one is slower beyond both limits
    Compare(Compare),
    /// Measure the study's [benchmark.sweep]: every resolution on every number of threads; tables and figures
    Sweep(Run),
    /// Make a run of a published table of means, so that it can stand beside a run of ours
    Import(Import),
    /// Measure what is asked on standard input; `isostudy bench` starts this
    #[command(hide = true)]
    Worker(Worker),
}

#[derive(Debug, Args)]
pub(crate) struct Compare {
    /// Results folder, or a run.json in it: what B is compared with
    pub(crate) a: PathBuf,
    /// Results folder, or a run.json in it
    pub(crate) b: PathBuf,
    /// A slower configuration is a regression beyond this share of its time in A ...
    ///
    /// What is within the noise is never told, however small the share: the column "Told from" says how large that is.
    #[arg(long, default_value_t = 0.05, value_name = "SHARE", value_parser = not_negative)]
    pub(crate) relative: f64,
    /// ... and beyond this many seconds
    #[arg(long, default_value_t = 0.0001, value_name = "SECONDS", value_parser = not_negative)]
    pub(crate) absolute: f64,
    /// Compare runs of machines that differ, in their settings too; every heading and verdict then says so
    #[arg(long)]
    pub(crate) across_machines: bool,
    /// What to print
    #[arg(long, default_value = "markdown")]
    pub(crate) format: Format,
}

/// How a table is printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Format {
    Markdown,
    Csv,
    Latex,
    Json,
}

#[derive(Debug, Args)]
pub(crate) struct Import {
    /// Table with the columns of study/paper/published_benchmark.csv
    pub(crate) table: PathBuf,
    /// Where to write the run
    #[arg(long, short, value_name = "FILE")]
    pub(crate) out: PathBuf,
    /// Where the table is from
    #[arg(long, default_value = "Costen (2026)", value_parser = clap::builder::NonEmptyStringValueParser::new())]
    pub(crate) source: String,
    /// The machine it was measured on [default: the paper's, as configs/cpu/i7-11700.toml has it]
    #[arg(long, value_name = "TOML")]
    pub(crate) machine: Option<PathBuf>,
    /// How many rounds each mean is of
    #[arg(long, default_value_t = 100, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) iterations: u32,
    /// How many threads sampled
    #[arg(long, default_value_t = 16, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) threads: u32,
}

#[derive(Debug, Args)]
pub(crate) struct Worker {
    pub(crate) study: PathBuf,
    /// Digest that the study file must have
    #[arg(long)]
    pub(crate) sha256: String,
    #[arg(long)]
    pub(crate) threads: u32,
    #[arg(long)]
    pub(crate) pin: bool,
    /// The study's sweep at so many cells per axis, instead of its benchmark
    #[arg(long)]
    pub(crate) cells: Option<u32>,
    /// Configurations that failed and are not counted
    #[arg(long)]
    pub(crate) without: Vec<String>,
    /// Spacings that were found for methods with a budget
    #[arg(long)]
    pub(crate) spacings: Option<PathBuf>,
}

/// A number that is finite and not negative.
fn not_negative(text: &str) -> Result<f64, String> {
    let number: f64 = text.parse().map_err(|_| "is not a number".to_owned())?;
    if number.is_finite() && number >= 0.0 {
        Ok(number)
    } else {
        Err("must be finite and not negative".into())
    }
}

#[derive(Debug, Args)]
pub(crate) struct Analyse {
    #[arg(required_unless_present = "self_test", help = analysed())]
    pub(crate) input: Option<PathBuf>,
    /// Answers to read instead of the study's own: its table, the long format, or a questionnaire's export
    #[arg(long, value_name = "FILE")]
    pub(crate) responses: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) reading: ReadingRules,
    /// Folder for tables and figures [default: results/<study id>-answers, or results/<file name>-answers]
    #[arg(long, short, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) self_test: SelfTest,
}

#[derive(Debug, Args)]
pub(crate) struct SelfTest {
    /// Read no answers: simulate studies with a known truth, and show that each probe finds its own defect and no other, that
    /// tests reject and intervals cover as they should
    #[arg(long, conflicts_with_all = ["input", "responses"])]
    pub(crate) self_test: bool,
    /// Studies to simulate for each line
    #[arg(long, requires = "self_test", default_value_t = 10_000, value_name = "N", value_parser = clap::value_parser!(u64).range(100..=10_000_000))]
    pub(crate) studies: u64,
    /// Seed of the simulated studies; the same seed gives the same tables on any number of threads
    #[arg(long, requires = "self_test", default_value_t = 1, value_name = "SEED")]
    pub(crate) seed: u64,
    /// Threads to simulate with; 0 takes every core
    #[arg(long, requires = "self_test", default_value_t = 0, value_name = "N", value_parser = clap::value_parser!(u32).range(..=1024))]
    pub(crate) threads: u32,
}

/// What may be analysed, with the columns that are read.
fn analysed() -> String {
    let (needed, others) = responses::LONG_COLUMNS.split_at(responses::LONG_NEEDED);
    format!(
        "Study file, such as configs/paper.toml, or a file of answers without a study: columns {} and optionally {}. A row with \
         a count stands for so many people, whom it does not name",
        needed.join(", "),
        others.join(", ")
    )
}

/// How a file of answers is read, where that differs from what the study declares.
#[derive(Debug, Clone, Args)]
pub(crate) struct ReadingRules {
    /// Format of the answers [default: detected]
    #[arg(long, value_name = "NAME", value_parser = PossibleValuesParser::new(responses::Format::ALL.map(responses::Format::name)))]
    pub(crate) format: Option<String>,
    /// TOML file with the keys of a study's [responses]: question columns, synonyms, pairs
    #[arg(long, value_name = "FILE")]
    pub(crate) mapping: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct Convert {
    /// File of answers in any format that is read
    pub(crate) input: PathBuf,
    /// Format to write
    #[arg(long, value_name = "FORMAT")]
    pub(crate) to: Target,
    /// File to write
    #[arg(long, short, value_name = "FILE")]
    pub(crate) out: PathBuf,
    /// Study whose questions were asked; needed where columns are questions
    #[arg(long, value_name = "TOML")]
    pub(crate) study: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) reading: ReadingRules,
    /// For pwcmp, which has no ties: refuse, write one win each way, or leave them out
    #[arg(long, value_name = "RULE", default_value = "refuse")]
    pub(crate) ties: TieRule,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Target {
    #[value(help = responses::LONG_WRITTEN.join(", "))]
    Long,
    /// model_a, model_b, winner, item_id, voter_id
    Arenakit,
    /// observer, session, scene, condition_A, condition_B, is_A_selected
    Pwcmp,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum TieRule {
    Refuse,
    Split,
    Drop,
}

#[derive(Debug, Args)]
pub(crate) struct Inspect {
    /// Configuration, such as ss_bi
    pub(crate) id: String,
    /// Cells along the longest axis of the volume [default: those of the benchmark]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    pub(crate) resolution: Option<u32>,
    /// Study that has the configuration
    #[arg(long, value_name = "TOML", default_value = "configs/paper.toml")]
    pub(crate) study: PathBuf,
    /// Extractions to take the median time of, after one of warm-up
    #[arg(long, value_name = "N", default_value_t = 11, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(crate) iterations: u32,
    /// Threads in the sampling stage; 0 takes every core
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(..=1024))]
    pub(crate) threads: u32,
    /// Print JSON instead
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
#[command(group(ArgGroup::new("second").args(["b", "field", "volume", "mesh", "object"]).required(true)))]
#[command(
    override_usage = "isostudy distance [OPTIONS] <A> <B|--field <FORMULA>|--volume <FILE>|--mesh <FILE>|--object <ID>>"
)]
#[command(after_help = "\
Examples:
  isostudy distance coarse.ply fine.ply
  isostudy distance ball.ply --field 'sqrt(x^2+y^2+z^2) - 1' --bounds=-1.2,-1.2,-1.2,1.2,1.2,1.2
  isostudy distance head.ply --volume head.nrrd --isovalue 300.5
  isostudy distance bunny.ply --object bs --study configs/paper.toml")]
pub(crate) struct Distance {
    /// Mesh: .obj, .ply or .stl
    pub(crate) a: PathBuf,
    /// Mesh to compare it with. The diagonal of its bounding box, or of the isosurface's, is the yardstick
    #[arg(conflicts_with_all = ["bounds", "spacing", "cells", "isovalue", "inside", "close", "allow_open", "memory"])]
    pub(crate) b: Option<PathBuf>,
    /// The isosurface of this object of a study instead; --spacing is the study's for its benchmark if not given
    #[arg(long, value_name = "ID", conflicts_with_all = ["bounds", "cells", "isovalue", "inside", "close", "allow_open"])]
    pub(crate) object: Option<String>,
    /// Study that has the object
    #[arg(long, value_name = "TOML", default_value = "configs/paper.toml", requires = "object")]
    pub(crate) study: PathBuf,
    /// Samples on each surface, spread over its area; its vertices come on top
    #[arg(long, value_name = "N", default_value_t = 1_000_000, value_parser = clap::value_parser!(u64).range(1..=mesh::metro::MOST_SAMPLES))]
    pub(crate) samples: u64,
    /// Samples per unit of area, instead of a number for each surface
    #[arg(long, value_name = "N", conflicts_with = "samples")]
    pub(crate) density: Option<f64>,
    /// Seed of the samples' places; the same seed gives the same numbers on any number of threads
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Threads to work with; 0 takes every core
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(..=1024))]
    pub(crate) threads: u32,
    /// Print JSON instead
    #[arg(long)]
    pub(crate) json: bool,
    #[command(
        flatten,
        next_help_heading = "An isosurface to compare it with instead; the spacing sets how closely it is looked at"
    )]
    pub(crate) source: SourceArguments,
}

#[derive(Debug, Args)]
pub(crate) struct Validate {
    /// Study file, such as configs/paper.toml
    pub(crate) study: PathBuf,
}
