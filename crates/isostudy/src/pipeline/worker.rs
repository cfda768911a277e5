//! Measuring processes: the command line that starts one, the run that drives it, and what it does itself.

use super::Pipeline;
use crate::fields::Fields;
use crate::input;
use crate::measured::{Clock, asked};
use crate::prepare::{Prepared, Spacings, Wanted, prepare};
use crate::recipe::{self, Recipe, recipe};
use crate::store::{sha256, write_whole};
use crate::terminal::progress::Step;
use crate::terminal::tell_once;
use anyhow::{Context, Result, bail};
use clap::Args;
use isostudy_bench::{BenchError, Entry, PLANTED, Plan, Planted, ProcessExecutor};
use isostudy_design::config::ThreadSweepSection;
use isostudy_design::machine::Machine;
use isostudy_design::record::{BenchRun, Failure, Purpose};
use isostudy_design::{Configuration, ConfigurationId, Study};
use isostudy_foreign::Folder;
use std::fs::{File, TryLockError};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What a measuring process is told, as options of `isostudy bench worker`: written by [`Invocation::command`], read by clap.
#[derive(Debug, PartialEq, Args)]
pub(crate) struct Invocation {
    study: PathBuf,
    /// Digest that the study file must have
    #[arg(long)]
    sha256: String,
    #[arg(long)]
    threads: u32,
    #[arg(long)]
    pin: bool,
    /// The study's sweep at so many cells per axis, instead of its benchmark
    #[arg(long)]
    cells: Option<u32>,
    /// Configurations that failed or were not asked for, and are not counted
    #[arg(long)]
    without: Vec<String>,
    /// A case of the study's own sweep: the places of its pair, and its number. --cells has its resolution
    #[arg(long, num_args = 2, value_names = ["PAIR", "NUMBER"])]
    case: Option<Vec<u64>>,
    /// Spacings that were found for methods with a budget
    #[arg(long)]
    spacings: Option<PathBuf>,
    /// Whether programs run in a sandbox
    #[arg(long)]
    sandbox: bool,
}

impl Invocation {
    /// The command that starts the process.
    pub(super) fn command(&self, program: &Path) -> Command {
        let mut command = Command::new(program);
        command.args(["bench", "worker"]).arg(&self.study);
        command.args(["--sha256", &self.sha256, "--threads", &self.threads.to_string()]);
        command.args(self.pin.then_some("--pin"));
        if let Some(cells) = self.cells {
            command.args(["--cells", &cells.to_string()]);
        }
        if let Some(case) = &self.case {
            command.arg("--case").args(case.iter().map(u64::to_string));
        }
        for id in &self.without {
            command.args(["--without", id]);
        }
        if let Some(spacings) = &self.spacings {
            command.arg("--spacings").arg(spacings);
        }
        // Not said if it is not so: an isostudy of before does not know the word.
        command.args(self.sandbox.then_some("--sandbox"));
        command
    }
}

/// What one run measures: the configurations of a plan, in processes of their own.
pub(super) struct Measurement<'a> {
    pub(super) plan: &'a Plan,
    /// In the order that the measuring process counts them.
    pub(super) configurations: Vec<&'a Configuration>,
    /// Cells per axis of a sweep; `None` for the benchmark's own spacing.
    pub(super) cells: Option<u32>,
    /// The place of a pair and the number of a case, where the only configuration is a case of the study's own sweep.
    pub(super) case: Option<(usize, u64)>,
}

impl Measurement<'_> {
    fn ids(&self) -> Vec<ConfigurationId> {
        self.configurations.iter().map(|configuration| configuration.id.clone()).collect()
    }
}

impl Pipeline<'_> {
    /// Measures, in measuring processes that this program starts of itself. What a killed run left in the journal is not
    /// measured again.
    ///
    /// # Errors
    /// If a process cannot be started or refuses, or the journal cannot be written.
    pub(super) fn run(
        &self,
        of: &Measurement<'_>,
        machine: Machine,
        journal: &Path,
        key: &str,
        step: &Step,
        enough: &dyn Fn(&BenchRun) -> bool,
    ) -> Result<BenchRun> {
        let plan = of.plan;
        let done = self.take_up(journal, key, of)?;
        let lines: String = [Entry::Begun { key: key.into() }].iter().chain(&done).map(Entry::line).collect();
        write_whole(journal, lines.as_bytes())?;
        let mut file =
            File::options().append(true).open(journal).with_context(|| journal.display().to_string())?;
        // Two at once would put their entries between each other's.
        if matches!(file.try_lock(), Err(TryLockError::WouldBlock)) {
            bail!("{}: another isostudy of this machine measures the same at this moment", journal.display());
        }
        let program = std::env::current_exe().context("cannot find this program to start it again")?;
        let (_folder, spacings) = self.spacings_file()?;
        let mut invocation = self.invocation([plan.threads, u32::from(plan.pin)], &of.ids(), &spacings)?;
        invocation.cells = of.cells;
        if let Some((pair, number)) = of.case {
            invocation.case = Some(vec![pair as u64, number]);
            invocation.without = Vec::new();
        }
        let worker = || invocation.command(&program);
        let mut record = |entry: &Entry| file.write_all(entry.line().as_bytes());
        let may_fail = |number: usize| is_program(self.study, of.configurations[number]);
        let mut executor = ProcessExecutor::new(&worker).leaving_out(&may_fail).telling(tell_once);
        let on_turn = &mut |done, all| step.set(done, all);
        let ids = of.ids();
        Ok(isostudy_bench::run_until(plan, &ids, &mut executor, machine, done, &mut record, on_turn, enough)?)
    }

    /// Spacings that were found, in a file that measuring processes read.
    pub(super) fn spacings_file(&self) -> Result<(Folder, PathBuf)> {
        let folder = Folder::new().context("cannot make a temporary folder")?;
        let path = folder.path().join("spacings.json");
        write_whole(&path, &serde_json::to_vec(&*self.spacings())?)?;
        Ok((folder, path))
    }

    /// What a process that measures these configurations is told.
    pub(super) fn invocation(
        &self,
        [threads, pin]: [u32; 2],
        ids: &[ConfigurationId],
        spacings: &Path,
    ) -> Result<Invocation> {
        let left_out = timed(self.study)?.into_iter().map(|c| &c.id).filter(|id| !ids.contains(id));
        Ok(Invocation {
            study: self.study.path.clone(),
            sha256: sha256(&input::bytes(&self.study.path)?),
            threads,
            pin: pin > 0,
            cells: None,
            case: None,
            without: left_out.map(ToString::to_string).collect(),
            spacings: Some(spacings.to_owned()),
            sandbox: recipe::uses_sandbox(),
        })
    }

    /// Goes on without what a run left out.
    pub(super) fn leave_out_failed(&self, failed: &[Failure]) {
        for failure in failed.iter().filter(|failure| !self.has_failed(&failure.id)) {
            self.leave_out(&failure.id, format!("timings: {}", failure.reason));
        }
    }

    /// What a killed run of the same plan, machine and code left behind.
    fn take_up(&self, journal: &Path, key: &str, of: &Measurement<'_>) -> Result<Vec<Entry>> {
        let Ok(text) = std::fs::read_to_string(journal) else { return Ok(Vec::new()) };
        if self.store.forced() {
            tell!("timings: begun anew, as --force says; an unfinished run is not gone on with");
            return Ok(Vec::new());
        }
        let read = isostudy_bench::read_journal(&text, key).map_err(BenchError::from);
        match read.and_then(|done| isostudy_bench::check_journal(of.plan, &of.ids(), &done).map(|()| done)) {
            Ok(done) => {
                if !done.is_empty() {
                    tell!("timings: an unfinished run is gone on with ({} entries)", done.len());
                }
                Ok(done)
            }
            Err(error) => {
                let error = anyhow::Error::from(error);
                tell!("timings: begun anew; {} is not gone on from: {error:#}", journal.display());
                Ok(Vec::new())
            }
        }
    }
}

/// The configurations that can be timed: all but those whose meshes are there.
pub(super) fn timed(study: &Study) -> Result<Vec<&Configuration>> {
    let mut timed = Vec::new();
    // Another look is the same work once more.
    let is_work = |configuration: &&Configuration| !study.is_repeated(configuration.id.method);
    for configuration in study.configurations.iter().filter(is_work) {
        match recipe(study, configuration.id.method, Purpose::Benchmark)? {
            Recipe::Meshes(_) => {}
            Recipe::Extractor(_) | Recipe::Program(_) | Recipe::Family(_) => {
                timed.push(configuration);
            }
        }
    }
    Ok(timed)
}

/// Whether somebody else's program makes it. That may crash at any time, and is no reason to lose what the others did.
pub(super) fn is_program(study: &Study, configuration: &Configuration) -> bool {
    let recipe = recipe(study, configuration.id.method, Purpose::Benchmark);
    matches!(recipe, Ok(Recipe::Program(_)))
}

/// The configurations that a study's sweep is about: those of its objects that have a time at any resolution.
pub(super) fn swept<'s>(study: &'s Study, section: &ThreadSweepSection) -> Result<Vec<&'s Configuration>> {
    let mut swept = Vec::new();
    for configuration in timed(study)? {
        let recipe = recipe(study, configuration.id.method, Purpose::Indexed)?;
        let is_fixed = matches!(recipe, Recipe::Family(of) if of.has_one_resolution().is_some());
        if section.objects.contains(&configuration.id.object) && !is_fixed {
            swept.push(configuration);
        }
    }
    Ok(swept)
}

/// The study of a case, by the places that a measuring process is told.
///
/// # Errors
/// If the study has no such case.
fn study_of_case(study: &Study, pair: usize, number: u64) -> Result<(Study, Configuration)> {
    let sweep = study.sweep().with_context(|| format!("{}: there is no [sweep]", study.path.display()))?;
    let of = sweep.pairs.get(pair).filter(|of| number < of.cases).context("there is no such case")?;
    let case = sweep.case(of, number);
    Ok((sweep.study_of(of, &case.settings)?, of.configuration.clone()))
}

/// The measuring process: answers requests on standard input until there are no more.
///
/// # Errors
/// If the study was changed meanwhile, or a request cannot be read or answered.
pub(crate) fn measure(invocation: &Invocation) -> Result<()> {
    isostudy_bench::count_allocations(asked);
    let pinned = if invocation.pin { isostudy_bench::pin(invocation.threads) } else { None };
    recipe::use_sandbox(invocation.sandbox);
    let study = input::study(&invocation.study)?;
    if sha256(&input::bytes(&study.path)?) != invocation.sha256 {
        bail!("{} was changed while the benchmark ran", study.path.display());
    }
    let case = match invocation.case.as_deref() {
        Some(&[pair, number]) => Some(study_of_case(&study, usize::try_from(pair)?, number)?),
        _ => None,
    };
    let study = case.as_ref().map_or(&study, |(study, _)| study);
    let fields = Fields::new(study);
    let (mut configurations, purpose) = match (&case, invocation.cells, &study.file.benchmark.sweep) {
        (Some((_, configuration)), ..) => (vec![configuration], Purpose::Benchmark),
        (None, Some(_), Some(section)) => (swept(study, section)?, Purpose::Indexed),
        (None, Some(_), None) => bail!("{}: there is no [benchmark.sweep]", study.path.display()),
        (None, None, _) => (timed(study)?, Purpose::Benchmark),
    };
    configurations.retain(|configuration| !invocation.without.contains(&configuration.id.to_string()));
    let spacings: Spacings = match &invocation.spacings {
        Some(path) => {
            serde_json::from_slice(&input::bytes(path)?).with_context(|| path.display().to_string())?
        }
        None => Spacings::default(),
    };
    let prepared = |number: usize| -> Result<Prepared<'_>, String> {
        let configuration = *configurations.get(number).ok_or("there is no such configuration")?;
        let wanted = match invocation.cells {
            Some(cells) => Wanted::Cells(cells, purpose),
            None => Wanted::For(purpose),
        };
        prepare(study, &fields, &spacings, configuration, wanted).map_err(|error| format!("{error:#}"))
    };
    let (requests, replies) = (std::io::stdin().lock(), std::io::stdout().lock());
    let mut clock = Clock::new(prepared);
    let mut planted = Planted::new(&mut clock, planted_share()?);
    Ok(isostudy_bench::serve(requests, replies, pinned, invocation.threads, &mut planted)?)
}

/// By how much this process is to be slower than it is, to see whether that is found; 0 but in tests of the benchmark itself.
fn planted_share() -> Result<f64> {
    let Ok(text) = std::env::var(PLANTED) else { return Ok(0.0) };
    let share: Option<f64> = text.parse().ok().filter(|share: &f64| (0.0..=100.0).contains(share));
    share.with_context(|| format!("{PLANTED} = {text}: must be a share from 0 to 100, such as 0.05"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        invocation: Invocation,
    }

    #[test]
    fn what_a_process_is_told_is_what_it_reads() {
        let least = Invocation {
            study: "a study.toml".into(),
            sha256: "00ff".into(),
            threads: 3,
            pin: false,
            cells: None,
            case: None,
            without: Vec::new(),
            spacings: None,
            sandbox: false,
        };
        let most = Invocation {
            study: "study.toml".into(),
            sha256: "ab".into(),
            threads: 1,
            pin: true,
            cells: Some(50),
            case: Some(vec![3, 1_000_000]),
            without: vec!["ss_bi".into(), "as_fp".into()],
            spacings: Some("spacings.json".into()),
            sandbox: true,
        };
        for invocation in [least, most] {
            let command = invocation.command(Path::new("isostudy"));
            let words: Vec<_> = command.get_args().collect();
            assert_eq!(words[..2], ["bench", "worker"]);
            assert_eq!(Line::parse_from(&words[1..]).invocation, invocation);
        }
    }
}
