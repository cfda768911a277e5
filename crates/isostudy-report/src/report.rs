//! The report: what a study's answers show, what they do not, and why, in sentences made from the numbers.
//!
//! A [`Report`] is sections of paragraphs, [`Finding`]s, tables and figures, and knows nothing of files or pages. No
//! sentence is kept for a study: each is chosen by a test's conclusion and filled with its counts, so another study, or
//! answers without a study, get other sentences.

mod asked;
mod attributes;
mod checks;
mod decision;
mod declaration;
mod evidence;
mod factors;
mod finding;
mod limits;
mod machine;
mod markdown;
mod names;
mod prediction;
mod preference;
mod reliability;
mod screens;
mod sides;
mod summary;
mod tipping;
mod told;
mod ways;
mod worths;

pub use crate::standing::Standing;
pub use crate::statement::{Block, Finding, Section};

use crate::figure::Figure;
use crate::words::{capital, counted, list};
use evidence::Evidence;
use isostudy_inference::results::Decision;
use isostudy_inference::{Preferences, Results};
use isostudy_table::Table;

/// A report.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Its title.
    pub title: String,
    /// The abstract, a line each.
    pub summary: Vec<SummaryLine>,
    /// The methods in words; none of answers without a study.
    pub methods: Option<Table>,
    /// What was asked of whom.
    pub lead: Vec<String>,
    /// What limits the results, a line each.
    pub limits: Vec<String>,
    /// Its sections; none is empty.
    pub sections: Vec<Section>,
}

/// A line of the abstract.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SummaryLine {
    /// What it is about, such as `Found`.
    pub label: &'static str,
    /// The line.
    pub text: String,
}

/// The tables that the published text prints, in its order; the first ones are read at once.
const PAPER: [(&str, bool); 8] = [
    ("preference_groups", true),
    ("preference_overall", true),
    ("asteroid", true),
    ("configurations", false),
    ("benchmark", false),
    ("questionnaire", false),
    ("answers", false),
    ("comparison_summary", false),
];

/// The report of a study. `tables` and `figures` are those made from the same results; each is printed once. `published` are
/// sections of whoever knows a published text: they hold it against the results, with the tables that belong into them.
pub fn report(
    results: &Results<'_>,
    tables: &[Table],
    figures: &[Figure],
    published: Vec<Section>,
) -> Report {
    let (inputs, study) = (&results.inputs, results.inputs.study);
    let evidence = Evidence::of_study(results);
    let mut builder = Builder::new(tables, figures);
    let methods = builder.table("methods");
    builder.decision(&results.decision);
    if inputs.answers.is_some() {
        builder.preferences(&evidence);
        builder.section(
            "prediction",
            "What predicts preference",
            prediction::findings(study, results.prediction.as_ref()),
        );
        builder.add_figures(&["prediction"]);
        builder.add_tables(&["prediction", "prediction_objects", "prediction_correlations"]);
    }
    builder.add_sections(published);
    if inputs.answers.is_some() {
        builder.reliance(&evidence);
    }
    let mut paper = inputs.answers.map_or_else(Vec::new, |of| factors::findings(study, &of.tally, &evidence));
    for (name, at_once) in PAPER {
        paper.extend(builder.table(name).map(|t| if at_once { Block::Table(t) } else { Block::Folded(t) }));
    }
    paper.extend(builder.figures(&["preference_overall", "preference_objects", "answers"]));
    builder.section("tables", "Tables and figures of the study", paper);
    builder.section("machine", "Machine and timing", machine::described(inputs));
    builder.add_figures(&["pass_times", "stage_times"]);
    let title = study.file.study.title.clone();
    builder.finish(title, &evidence, Some(results), methods)
}

/// The report of answers without a study, as [`report`].
pub fn report_of_groups(
    title: &str,
    preferences: &Preferences<'_>,
    tables: &[Table],
    figures: &[Figure],
) -> Report {
    let evidence = Evidence::of(preferences);
    let mut builder = Builder::new(tables, figures);
    builder.preferences(&evidence);
    builder.reliance(&evidence);
    builder.finish(title.into(), &evidence, None, None)
}

/// What was found in a study's answers before all, in one sentence; `None` without answers.
pub fn found(results: &Results<'_>) -> Option<String> {
    told::main_sentence(results.preferences.as_ref()?, Some(results))
}

/// The same of answers without a study.
pub fn found_in_groups(preferences: &Preferences<'_>) -> Option<String> {
    told::main_sentence(preferences, None)
}

/// What was asked of whom.
fn lead(evidence: &Evidence<'_>) -> Vec<String> {
    let (people, questions) = (evidence.participants(), evidence.questions());
    let answers = evidence.shown.len();
    if answers == 0 && evidence.excluded > 0 {
        return vec![format!(
            "Nothing is said about preference: {} answered, and all broke a rule whose breakers the study leaves out.",
            counted(evidence.excluded, "participant")
        )];
    }
    if answers == 0 {
        let controls = evidence.preferences.map_or(0, checks::controls);
        return vec![match controls {
            0 => "No answers were given, so nothing is said about preference.".into(),
            _ => format!(
                "Only controls were answered, which show an item beside itself: {}. So nothing is said about preference.",
                counted(controls as usize, "answer")
            ),
        }];
    }
    let about = evidence.study.map_or(String::new(), |study| {
        let names: Vec<&str> = study.file.objects.iter().map(|o| o.name.as_str()).collect();
        format!(" about {} ({})", counted(names.len(), "object"), list(&names))
    });
    let mut lead = vec![format!(
        "{} gave {} to {}{about}.",
        capital(&counted(people, "participant")),
        counted(answers, "answer"),
        counted(questions, "question"),
    )];
    let asked = evidence.asked;
    let missing = asked.saturating_sub(answers);
    if missing > 0 {
        lead[0].push_str(&format!(
            " {missing} of the {asked} answers that were asked for {} not given; people count as far as they answered.",
            if missing == 1 { "was" } else { "were" }
        ));
    }
    if evidence.excluded > 0 {
        lead[0].push_str(&format!(
            " {} more broke a rule whose breakers the study leaves out.",
            capital(&counted(evidence.excluded, "participant"))
        ));
    }
    lead.extend(
        evidence
            .study
            .and_then(|study| asked::instruction(study))
            .map(|instruction| format!("They were asked this: {}", asked::ended(instruction))),
    );
    lead.extend(evidence.study.and_then(ways::asked));
    lead.extend(evidence.assumptions.iter().cloned());
    lead.push(
        format!(
            "One person's answers hang together, so the person is the unit of every test and interval here. A person's score \
             is the answers for the one less the answers for the other, divided by the number of that person's answers. 1 means \
             always the one, \u{2212}1 always the other. A result holds if its p, corrected for the tests of its family, is at \
             most {}.",
            evidence.rules().level
        ),
    );
    lead
}

/// Puts sections together, and knows which tables and figures have not been printed.
struct Builder {
    tables: Vec<Table>,
    figures: Vec<Figure>,
    sections: Vec<Section>,
}

impl Builder {
    fn new(tables: &[Table], figures: &[Figure]) -> Self {
        Self { tables: tables.to_vec(), figures: figures.to_vec(), sections: Vec::new() }
    }

    fn table(&mut self, name: &str) -> Option<Table> {
        let place = self.tables.iter().position(|table| table.name == name)?;
        Some(self.tables.remove(place))
    }

    fn figures(&mut self, names: &[&str]) -> Vec<Block> {
        let mut taken = Vec::new();
        for name in names {
            if let Some(place) = self.figures.iter().position(|figure| figure.name == *name) {
                taken.push(Block::Figure(self.figures.remove(place)));
            }
        }
        taken
    }

    fn section(&mut self, id: &'static str, heading: &'static str, blocks: Vec<Block>) {
        self.sections.push(Section { id, heading, blocks });
    }

    /// Finished sections; the tables in them are printed.
    fn add_sections(&mut self, sections: Vec<Section>) {
        for block in sections.iter().flat_map(|section| &section.blocks) {
            if let Block::Table(printed) | Block::Folded(printed) = block {
                self.tables.retain(|table| table.name != printed.name);
            }
        }
        self.sections.extend(sections);
    }

    /// Figures at the end of the last section.
    fn add_figures(&mut self, names: &[&str]) {
        let figures = self.figures(names);
        self.sections.last_mut().expect("a section to add to").blocks.extend(figures);
    }

    /// Folded tables at the end of the last section.
    fn add_tables(&mut self, names: &[&str]) {
        for name in names {
            if let Some(table) = self.table(name) {
                self.sections.last_mut().expect("a section to add to").blocks.push(Block::Folded(table));
            }
        }
    }

    /// Which method to take; nothing where there are none to choose from.
    fn decision(&mut self, found: &Decision<'_>) {
        let tables = ["choices", "decision"].map(|name| self.table(name).map(Block::Table));
        let mut blocks: Vec<Block> = tables.into_iter().flatten().collect();
        blocks.extend(self.figures(&["fronts"]));
        blocks.extend(decision::fronts_in_words(found));
        blocks.extend(self.table("fronts").map(Block::Folded));
        self.section("decision", "Which method to take", blocks);
    }

    /// What answers alone can tell.
    fn preferences(&mut self, evidence: &Evidence<'_>) {
        if evidence.shown.is_empty() {
            return;
        }
        let mut scale = self.figures(&["worths"]);
        scale.extend(worths::findings(evidence));
        scale.extend(ways::findings(evidence));
        if let Some(preferences) = evidence.preferences {
            let found = attributes::findings(&preferences.attributed, evidence.rules().level);
            scale.extend(found.into_iter().map(Block::Finding));
        }
        self.section("worths", "How much each is liked, on one scale", scale);
        self.add_tables(&[
            "scale",
            "differences",
            "subgroups",
            "covariates",
            "ways",
            "fit",
            "worths",
            "models",
        ]);
        let mut glance = self.figures(&["contrasts"]);
        glance.extend(preference::findings(evidence));
        self.section("preferences", "What was preferred to what", glance);
        self.add_tables(&["contrasts", "tests", "omnibus"]);
    }

    /// How far answers can be relied on, and what they cannot answer.
    fn reliance(&mut self, evidence: &Evidence<'_>) {
        if evidence.shown.is_empty() {
            return;
        }
        let parts = [reliability::findings, checks::findings, sides::findings, declaration::findings];
        self.section(
            "bearing",
            "How far the answers can be relied on",
            parts.iter().flat_map(|of| of(evidence)).collect(),
        );
        self.add_figures(&["respondents"]);
        self.add_tables(&["agreement", "answer_counts"]);
        self.add_tables(&["audit", "screened", "screens", "respondents"]);
    }

    fn finish(
        mut self,
        title: String,
        evidence: &Evidence<'_>,
        results: Option<&Results<'_>>,
        methods: Option<Table>,
    ) -> Report {
        let lead = lead(evidence);
        let rest = self.figures.drain(..).map(Block::Figure);
        let rest: Vec<Block> = rest.chain(self.tables.drain(..).map(Block::Folded)).collect();
        self.section("appendix", "All other figures and tables", rest);
        self.sections.retain(|section| !section.blocks.is_empty());
        Report {
            title,
            summary: summary::lines(evidence, results),
            methods,
            lead,
            limits: limits::all(evidence),
            sections: self.sections,
        }
    }
}

#[cfg(test)]
mod tests;
