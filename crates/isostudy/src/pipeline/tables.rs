//! Tables, figures and the report, from records, timings and answers.

use super::formats::{write_figure, write_table};
use super::measurements::Times;
use super::pages::{Abstract, PictureData, fits, write_report};
use super::pictures::ShownFirst;
use super::{Meshes, Pipeline};
use crate::kept_answers::{self, Waiting};
use crate::source_digests;
use crate::store::{Inputs, Stamp, Store, Writer, sha256_of_file};
use crate::terminal::counted;
use crate::terminal::progress::Step;
use anyhow::{Context, Result};
use isostudy_design::Study;
use isostudy_design::config::ResponsesSection;
use isostudy_design::sweep::Sweep;
use isostudy_inference::cases::SweepFound;
use isostudy_inference::tally::QuestionCount;
use isostudy_inference::{Answered, BallotGroup, Many, Preferences, Results};
use isostudy_paper::Paper;
use isostudy_report::statement::Section;
use isostudy_report::{Figure, LongFrame, OVERVIEW, Report};
use isostudy_responses::Reading;
use isostudy_table::Table;
use isostudy_timing::machines::{Machines, machine_tables};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

impl Pipeline<'_> {
    /// Every table and figure of the study.
    pub(super) fn tables(
        &self,
        meshes: &Meshes,
        times: &Times<'_>,
        pictures: &[Stamp],
        (shown, swept): (&ShownFirst, Option<String>),
    ) -> Result<Stamp> {
        let step = Step::begin("tables", 1, 1);
        let mut inputs = study_inputs(self.study)?;
        for stamp in meshes.stamps().chain(times.stamps()).chain(pictures) {
            inputs = inputs.stamp(stamp);
        }
        let left_out = self.left_out();
        let waiting = kept_answers::waiting(self.study);
        let (runs, missing) = self.machine_runs()?;
        inputs = inputs
            .value("left out", &left_out)
            .value("sweep", &swept)
            .value("machines that are missing", &missing);
        for (name, stamp) in &runs {
            inputs = inputs.text("machine", name).stamp(stamp);
        }
        inputs = inputs.value("waiting", &waiting.as_ref().map(|of| (of.answers, of.people)));
        let stamp = self.store.stage("tables", inputs, |writer| {
            let answers = crate::answer_files::of_study(self.study)?;
            let answers = answers.and_then(|reading| Answered::of(self.study, reading.responses));
            let measurements = self.measurements(meshes, times)?;
            let results = Results::of(&measurements.inputs(self.study, answers.as_ref()));
            let paper = Paper::of(&results);
            let gallery = Some(waiting.as_ref().map(|of| Unread::of(self.study, of)));
            let (pictures, caption) = (self.read_pictures(shown)?, self.pictures_caption(shown));
            let sweep = self.sweep.as_ref().zip(self.sweep_found()?);
            let machines = runs.iter().map(|(name, stamp)| Ok((name.clone(), self.bench_run(stamp)?)));
            let machines = machines.collect::<Result<Vec<_>>>()?;
            let machines = (!machines.is_empty()).then(|| (Machines::of(machines), &missing[..]));
            let more = More { sweep, machines };
            write(writer, &results, &paper, (&pictures, caption.as_deref()), (gallery, more))?;
            writer.write_json(UNEXPLAINED, &paper.unexplained_differences())
        })?;
        step.count(stamp.redone);
        step.end();
        Ok(stamp)
    }

    /// Every table and figure of a study of which nothing is measured but answers.
    pub(super) fn tables_of_answers(&self) -> Result<Stamp> {
        let step = Step::begin("tables", 1, 1);
        let waiting = kept_answers::waiting(self.study);
        let inputs =
            study_inputs(self.study)?.value("waiting", &waiting.as_ref().map(|of| (of.answers, of.people)));
        let stamp = self.store.stage("tables", inputs, |writer| {
            let answers = crate::answer_files::of_study(self.study)?;
            let answers = answers.and_then(|reading| Answered::of(self.study, reading.responses));
            let results = Results::of(&answers_alone(self.study, answers.as_ref()));
            let paper = Paper::of(&results);
            let gallery = Some(waiting.as_ref().map(|of| Unread::of(self.study, of)));
            write(writer, &results, &paper, (&[], None), (gallery, More::default()))?;
            writer.write_json(UNEXPLAINED, &paper.unexplained_differences())
        })?;
        step.count(stamp.redone);
        step.end();
        Ok(stamp)
    }

    /// The published numbers that ours differ from without a known reason, as the tables stage found them.
    pub(super) fn unexplained(&self) -> Result<Vec<String>> {
        let path = self.store.root().join(UNEXPLAINED);
        let text = std::fs::read(&path).with_context(|| path.display().to_string())?;
        Ok(serde_json::from_slice(&text)?)
    }
}

/// What is known of a study without meshes and times.
fn answers_alone<'a>(study: &'a Study, answers: Option<&'a Answered>) -> isostudy_inference::Inputs<'a> {
    isostudy_inference::Inputs {
        study,
        meshes: &[],
        bench: None,
        chunks: &[],
        stored: &[],
        answers,
        left_out: &[],
    }
}

/// The preference tables and figures alone, into a folder of their own, with how the answers were read.
///
/// # Errors
/// If the files cannot be written.
pub(crate) fn write_answers_only(study: &Study, reading: Reading, store: &Store) -> Result<Said> {
    let answers = Answered::of(study, reading.responses);
    let results = Results::of(&answers_alone(study, answers.as_ref()));
    let paper = Paper::of(&results);
    store.stage("answers", study_inputs(study)?, |writer| {
        writer.write(READING, reading.report.to_csv().as_bytes())?;
        write(writer, &results, &paper, (&[], None), (None, More::default()))
    })?;
    Ok(Said { tables: all_tables(&results, &paper), found: isostudy_report::found(&results) })
}

/// What a terminal is told of answers.
pub(crate) struct Said {
    pub(crate) tables: Vec<Table>,
    /// What was found before all, in one sentence; `None` where no answers are left.
    pub(crate) found: Option<String>,
}

/// Tables, figures and report of answers without a study, into a folder of their own, with how the answers were read.
///
/// # Errors
/// If the files cannot be written.
pub(crate) fn write_without_study(
    path: &Path,
    section: &ResponsesSection,
    mut reading: Reading,
    always_many: bool,
    store: &Store,
) -> Result<Said> {
    let inputs = Inputs::of_sources(source_digests::TABLES)
        .value("mapping", section)
        .value("many", &always_many)
        .text("responses", &sha256_of_file(path)?);
    let items = &reading.responses.items;
    if let Some(reference) = section.reference.as_ref().filter(|reference| !items.contains(reference)) {
        anyhow::bail!("reference = {reference:?}: no item has this name; there are {}", items.join(", "));
    }
    let groups = isostudy_inference::open_groups(&reading.responses, section.reference.as_deref());
    if always_many || isostudy_inference::is_many(&reading.responses, &groups) {
        // They are in the groups now, and there may be millions.
        reading.responses.answers = Vec::new();
        reading.responses.participants = Vec::new();
        return write_many(path, &reading, &groups, inputs, store);
    }
    let preferences = Preferences::without_study(&reading.responses, &groups, section.shown_s);
    let tables = isostudy_report::answer_tables(&preferences);
    let title = path.file_name().unwrap_or_default().to_string_lossy();
    store.stage("answers", inputs, |writer| {
        writer.write(READING, reading.report.to_csv().as_bytes())?;
        write_tables(writer, &tables)?;
        let figures = isostudy_report::figures_of_groups(&preferences).context("figures")?;
        write_figures(writer, &figures)?;
        write_frames(writer, &[isostudy_report::answers_frame(&reading.responses)])?;
        let (overview, figures) = with_overview(figures);
        let report = isostudy_report::report_of_groups(&title, &preferences, &tables, &figures);
        write_report(writer, &report, overview.as_ref(), (&[], None), false)
    })?;
    Ok(Said { found: isostudy_report::found_in_groups(&preferences), tables })
}

/// Tables and report of more answers, or about more items, than everything is computed for.
fn write_many(
    path: &Path,
    reading: &Reading,
    groups: &[BallotGroup],
    inputs: Inputs,
    store: &Store,
) -> Result<Said> {
    let responses = &reading.responses;
    let many = Many::of(groups, responses.sides_recorded);
    let tables = isostudy_report::many_tables(&many, responses.sides_recorded);
    let title = path.file_name().unwrap_or_default().to_string_lossy();
    store.stage("answers", inputs, |writer| {
        writer.write(READING, reading.report.to_csv().as_bytes())?;
        writer.write("tables/pairs.csv", isostudy_report::pairs_csv(&many).as_bytes())?;
        write_tables(writer, &tables)?;
        let report = isostudy_report::report_of_many(&title, &many, &tables, responses.assumptions());
        write_report(writer, &report, None, (&[], None), false)
    })?;
    tell!("{}", isostudy_report::told_of_many(&many));
    Ok(Said { found: Some(isostudy_report::found_in_many(&many)), tables })
}

/// What the page needs to know of a table: `tables/contents.json` lists these.
#[derive(Serialize, Deserialize)]
pub(super) struct TableEntry {
    pub(super) name: String,
    pub(super) caption: String,
    pub(super) html: String,
    /// Whether it is set to fit the page.
    pub(super) fits: bool,
}

/// What the page needs to know of a figure: `figures/contents.json` lists these.
#[derive(Serialize, Deserialize)]
pub(super) struct FigureEntry {
    pub(super) name: String,
    pub(super) caption: String,
    /// Size as shown, in pixels.
    pub(super) width: u32,
    pub(super) height: u32,
    /// The same of the drawing for narrow screens, `NAME-narrow.svg`.
    pub(super) narrow: Option<[u32; 2]>,
}

/// How the answers to a question fell out, with the sides as the study lists them: `tables/votes.json` has each question's.
#[derive(Serialize, Deserialize)]
pub(super) struct Votes {
    pub(super) left: u64,
    pub(super) none: u64,
    pub(super) right: u64,
}

/// Cells and rows of the answers that were not taken as they stand.
const READING: &str = "tables/reading.csv";
const UNEXPLAINED: &str = "tables/unexplained.json";
pub(super) const TABLE_CONTENTS: &str = "tables/contents.json";
/// What the report says first.
pub(super) const ABSTRACT: &str = "tables/abstract.json";
/// The votes on each pair, where there are answers.
pub(super) const VOTES: &str = "tables/votes.json";
pub(super) const FIGURE_CONTENTS: &str = "figures/contents.json";

/// Lines of the abstract about answers that are there and were not read.
struct Unread {
    by_whom: String,
    next: String,
}

impl Unread {
    fn of(study: &Study, Waiting { answers, people, folder }: &Waiting) -> Self {
        let answers = counted(*answers as u64, "answer");
        let people = if *people == 1 { "1 person".to_owned() } else { format!("{people} people") };
        let (file, id) = (study.path.display(), &study.file.study.id);
        Self {
            by_whom: format!(
                "{} holds {answers} of {people}, which this page has not read.",
                folder.display()
            ),
            next: format!(
                "Run isostudy analyse {file}. It reads the answers and writes results/{id}-answers/report.html."
            ),
        }
    }

    /// In place of what the report says where there are no answers.
    fn say_in(self, report: &mut Report) {
        for line in &mut report.summary {
            match line.label {
                "By whom" => line.text.clone_from(&self.by_whom),
                "Next" => line.text.clone_from(&self.next),
                _ => {}
            }
        }
    }
}

/// What the report has beside the results of answers, meshes and times.
#[derive(Default)]
struct More<'a> {
    /// What the cases of a sweep say.
    sweep: Option<(&'a Sweep<'a>, SweepFound)>,
    /// What several machines say, and which have not measured the study.
    machines: Option<(Machines, &'a [String])>,
}

impl More<'_> {
    /// Sections of the report, with their tables and figures.
    fn sections(&self, study: &Study) -> Result<(Vec<Section>, Vec<Table>, Vec<Figure>)> {
        let (mut sections, mut tables, mut figures) = (Vec::new(), Vec::new(), Vec::new());
        if let Some((machines, missing)) = &self.machines {
            tables = machine_tables(machines);
            sections.push(isostudy_report::machines_section(machines, missing, &tables));
        }
        if let Some((sweep, found)) = &self.sweep {
            let own = isostudy_report::case_tables(sweep, found);
            figures = isostudy_report::case_figures(study, found).context("figures")?;
            sections.push(isostudy_report::sweep_section(found, &own, &figures));
            tables.extend(own);
        }
        Ok((sections, tables, figures))
    }
}

/// `gallery` says whether an `index.html` will stand beside the report, and what it has to say of answers that were not read.
fn write(
    writer: &mut Writer<'_>,
    results: &Results<'_>,
    paper: &Paper<'_>,
    pictures: (&[PictureData], Option<&str>),
    (gallery, more): (Option<Option<Unread>>, More<'_>),
) -> Result<()> {
    let tables = all_tables(results, paper);
    let figures = isostudy_report::figures(results).context("figures")?;
    let (sections, more_tables, more_figures) = more.sections(results.inputs.study)?;
    write_tables(writer, &[&tables[..], &more_tables].concat())?;
    write_figures(writer, &[&figures[..], &more_figures].concat())?;
    let (overview, others) = with_overview(figures);
    let mut report = isostudy_report::report(results, &tables, &others, paper.published(&tables));
    report.sections.extend(sections);
    let has_gallery = gallery.is_some();
    if let Some(unread) = gallery.flatten() {
        unread.say_in(&mut report);
    }
    write_report(writer, &report, overview.as_ref(), pictures, has_gallery)?;
    if has_gallery {
        writer.write_json(ABSTRACT, &Abstract::of(&report))?;
        writer.write_json(VOTES, &votes(results))?;
    }
    write_frames(writer, &isostudy_report::frames(&results.inputs))
}

/// What the pages show before all else, and the other figures, which have their places in the report.
fn with_overview(figures: Vec<Figure>) -> (Option<Figure>, Vec<Figure>) {
    let (overview, others): (Vec<Figure>, Vec<Figure>) =
        figures.into_iter().partition(|figure| figure.name == OVERVIEW);
    (overview.into_iter().next(), others)
}

/// By question; empty without answers.
fn votes(results: &Results<'_>) -> BTreeMap<String, Votes> {
    let Some(answered) = results.inputs.answers else { return BTreeMap::new() };
    let counts = results.inputs.study.comparisons.iter().zip(&answered.tally.questions);
    let of = |count: &QuestionCount| Votes { left: count.left, none: count.none, right: count.right };
    counts.map(|(comparison, count)| (comparison.question.clone(), of(count))).collect()
}

/// The tables of a study, with those of the paper among them.
fn all_tables(results: &Results<'_>, paper: &Paper<'_>) -> Vec<Table> {
    let mut tables = isostudy_report::tables(results);
    paper.add_tables(&mut tables);
    tables
}

/// What tables summarise, row by row, for other programs.
fn write_frames(writer: &mut Writer<'_>, frames: &[LongFrame]) -> Result<()> {
    for frame in frames {
        writer.write(&format!("data/{}.parquet", frame.name), &frame.to_parquet()?)?;
    }
    Ok(())
}

fn write_figures(writer: &mut Writer<'_>, figures: &[Figure]) -> Result<()> {
    let mut entries = Vec::new();
    for figure in figures {
        write_figure(writer, "figures", figure)?;
        let [width, height] = figure.size();
        let (name, caption) = (figure.name.clone(), figure.caption.clone());
        entries.push(FigureEntry { name, caption, width, height, narrow: figure.narrow_size() });
    }
    writer.write_json(FIGURE_CONTENTS, &entries)
}

fn write_tables(writer: &mut Writer<'_>, tables: &[Table]) -> Result<()> {
    let mut entries = Vec::new();
    for table in tables {
        write_table(writer, "tables", table)?;
        let (name, caption) = (table.name.clone(), table.caption.clone());
        let fits = fits(&name);
        let html = if fits { table.to_html_cards() } else { table.to_html() };
        entries.push(TableEntry { name, caption, html, fits });
    }
    writer.write_json(TABLE_CONTENTS, &entries)
}

/// The study file, its answers and its published numbers.
pub(super) fn study_inputs(study: &Study) -> Result<Inputs> {
    let published = &study.published;
    let mut inputs = Inputs::of_sources(source_digests::TABLES)
        .value("study", &study.file)
        .value("benchmark", &published.benchmark)
        .value("preferences", &published.preferences)
        .value("claims", &published.claims);
    if let Some(path) = &study.responses {
        inputs = inputs.text("responses", &sha256_of_file(path)?);
    }
    if let Some(path) = &study.people {
        inputs = inputs.text("people", &sha256_of_file(path)?);
    }
    Ok(inputs)
}
