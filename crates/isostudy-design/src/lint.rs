//! Faults of a design that can be seen before anyone answers.
//!
//! [`lint`] judges a study's forms, [`lint_stimuli`] the animations made for it. Each [`Rule`] looks for one thing; a
//! [`Fault`] says where it was found, with the numbers. A design without faults can still be a bad one: nothing is said of
//! the question's wording, of who answers, or of whether the stimuli show what they should.

mod names;
mod notices;
mod reach;
mod several;
mod stimuli;

use crate::config::{OrderRule, SideRule};
use crate::forms::{Form, Questionnaire, Role};
use crate::study::{Comparison, Study};
use std::collections::{BTreeMap, BTreeSet};

pub use notices::notices;
pub use reach::{Reach, reach};
pub use stimuli::{EXPOSURE_TOLERANCE, StimulusFacts, lint_stimuli};

/// What the linter looks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[expect(missing_docs, reason = "`Rule::meaning` says it, for programs and people alike")]
pub enum Rule {
    SideConfounded,
    SidesUnbalanced,
    AppearancesUnequal,
    ComparisonsDisconnected,
    NoControls,
    NoRepeats,
    OrderFixed,
    UntestableComparison,
    NotEnoughParticipants,
    NamesReveal,
    TextsMissing,
    StimuliDiffer,
    ModelsTooLarge,
}

impl Rule {
    /// Every rule, in the order of reports.
    pub const ALL: [Self; 13] = [
        Self::SideConfounded,
        Self::SidesUnbalanced,
        Self::AppearancesUnequal,
        Self::ComparisonsDisconnected,
        Self::NoControls,
        Self::NoRepeats,
        Self::OrderFixed,
        Self::UntestableComparison,
        Self::NotEnoughParticipants,
        Self::NamesReveal,
        Self::TextsMissing,
        Self::StimuliDiffer,
        Self::ModelsTooLarge,
    ];

    /// Its id: stable, for scripts.
    pub fn id(self) -> &'static str {
        match self {
            Self::SideConfounded => "side-confounded",
            Self::SidesUnbalanced => "sides-unbalanced",
            Self::AppearancesUnequal => "appearances-unequal",
            Self::ComparisonsDisconnected => "comparisons-disconnected",
            Self::NoControls => "no-controls",
            Self::NoRepeats => "no-repeats",
            Self::OrderFixed => "order-fixed",
            Self::UntestableComparison => "untestable-comparison",
            Self::NotEnoughParticipants => "not-enough-participants",
            Self::NamesReveal => "names-reveal",
            Self::TextsMissing => "texts-missing",
            Self::StimuliDiffer => "stimuli-differ",
            Self::ModelsTooLarge => "models-too-large",
        }
    }

    /// What it looks for, and why that is a fault.
    pub fn meaning(self) -> &'static str {
        match self {
            Self::SideConfounded => {
                "Two methods are shown on the same sides every time, or in a question every time: nothing can tell a liking for the method from a \
                 liking for the side."
            }
            Self::SidesUnbalanced => {
                "Of two methods one is on the left more often, by more than one showing, in all or in a question: a liking for a side shifts \
                 the result."
            }
            Self::AppearancesUnequal => {
                "Methods of one group, or comparisons, are shown more often than others: sums of wins then compare \
                 chances to win."
            }
            Self::ComparisonsDisconnected => {
                "Methods of one group fall into parts that are never compared with each other: no scale can hold them \
                 all."
            }
            Self::NoControls => {
                "No pair shows the same configuration twice: guessing and a liking for a side stay unseen."
            }
            Self::NoRepeats => {
                "No comparison is asked again with the sides swapped: nobody's consistency can be known."
            }
            Self::OrderFixed => {
                "Everybody is asked in the same order: what comes late is judged by tired or practised eyes."
            }
            Self::UntestableComparison => {
                "No form asks about both parts of a difference, such as one pair of methods on two objects: nobody's answers tell \
                 whether the preference depends on it."
            }
            Self::NotEnoughParticipants => {
                "Even if all planned participants agree, the exact sign-flip test with Holm's correction cannot reach \
                 analysis.level."
            }
            Self::NamesReveal => {
                "Ids, texts, file names, sizes or metadata tell participants which configuration they see."
            }
            Self::TextsMissing => {
                "A language of the page has no text for a key: participants would read another language there."
            }
            Self::StimuliDiffer => {
                "The stimuli of one comparison differ in something besides the method: frames, duration, camera, \
                 background, colours, size or exposure."
            }
            Self::ModelsTooLarge => {
                "The models of a pair take more than 2 MB: participants wait, and phones run out of memory."
            }
        }
    }

    /// What to change, as a rule; see [`Fault::remedy`].
    pub fn remedy(self) -> &'static str {
        match self {
            Self::SideConfounded | Self::SidesUnbalanced => {
                "forms.sides = \"balanced\"; where it is, as many participants as said above"
            }
            Self::AppearancesUnequal => "list every pair of a group's members on every object",
            Self::ComparisonsDisconnected => {
                "add comparisons between the parts, or make them groups of their own"
            }
            Self::NoControls => "forms.controls = 2 or more",
            Self::NoRepeats => "forms.repeats = 2 or more",
            Self::OrderFixed => "forms.order = \"latin-square\"",
            Self::UntestableComparison => "a larger forms.max_questions, or fewer comparisons",
            Self::NotEnoughParticipants => "plan more participants, or fewer comparisons",
            Self::NamesReveal => {
                "take the name out of what tells it: forms.names = \"code-names\", another question id or text, files made anew"
            }
            Self::TextsMissing => "write the texts in [forms.texts], or in a file of forms.texts_files",
            Self::StimuliDiffer => "render both with the same turntable, shading and camera",
            Self::ModelsTooLarge => {
                "fewer triangles: a larger stimulus_spacing of the object, or a decimating finish of the methods"
            }
        }
    }
}

/// Something wrong, and where.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault {
    /// Which rule found it.
    pub rule: Rule,
    /// Where: a group, two methods, a family, a question, a file, a key.
    pub place: String,
    /// The numbers.
    pub evidence: String,
}

impl Fault {
    /// What to change here.
    pub fn remedy(&self) -> &'static str {
        match (self.rule, self.place.as_str()) {
            (Rule::NamesReveal, "forms.names") => "forms.names = \"code-names\"",
            (Rule::NamesReveal, place) if place.starts_with("question ") => "give the question another id",
            (Rule::NamesReveal, place) if place.starts_with("forms.") || place.starts_with("study.") => {
                "say it without the names of methods and configurations"
            }
            (Rule::NamesReveal, _) => {
                "make the files anew with `isostudy bundle`, and change nothing in them"
            }
            (rule, _) => rule.remedy(),
        }
    }
}

/// The faults of a study's forms, in the order of [`Rule::ALL`]. None for a study that asks nobody.
pub fn lint(study: &Study) -> Vec<Fault> {
    let (Some(section), Some(questionnaire)) = (&study.file.forms, Questionnaire::of(study)) else {
        return Vec::new();
    };
    let forms = questionnaire.planned();
    let mut faults = Vec::new();
    if section.way.is_of_pairs() {
        let showings = Showings::of(study, &forms);
        let even = (section.sides == SideRule::Balanced).then_some(2 * questionnaire.blocks());
        faults.extend(showings.sides(study, even));
        faults.extend(showings.appearances(study));
        faults.extend(showings.connections(study));
    } else {
        faults.extend(several::faults(study, section.way, &forms));
    }
    let mut none = |rule: Rule, key: &str, count: u32, role: Role| {
        if forms.iter().any(|form| form.trials.iter().all(|trial| trial.role != role)) {
            let evidence = format!("{key} = {count}, in forms of {} questions", questionnaire.questions(0));
            faults.push(Fault { rule, place: key.into(), evidence });
        }
    };
    if section.way.is_of_pairs() {
        none(Rule::NoControls, "forms.controls", section.controls, Role::Control);
    }
    none(Rule::NoRepeats, "forms.repeats", section.repeats, Role::Repeat);
    if section.order == OrderRule::AsListed && forms.len() > 1 {
        let evidence = format!("{} forms, one order", forms.len());
        faults.push(Fault { rule: Rule::OrderFixed, place: "forms.order".into(), evidence });
    }
    faults.extend(reach::faults(study, section.participants as usize));
    faults.extend(names::names(study, section));
    for (lang, keys) in questionnaire.file().missing_texts() {
        let evidence = format!("no text for {}", keys.join(", "));
        faults.push(Fault { rule: Rule::TextsMissing, place: format!("forms.texts.{lang}"), evidence });
    }
    faults
}

/// A group, and two of its methods by their places in the study, the lower first.
type MethodPair = (usize, usize, usize);

fn method_pair(study: &Study, comparison: &Comparison) -> MethodPair {
    let (left, right) = (study.place(comparison.left.method), study.place(comparison.right.method));
    (comparison.group, left.min(right), left.max(right))
}

/// What is wrong with having been shown so often one way and the other: one showing cannot be on both sides.
fn side_rule([one, other]: [u64; 2]) -> Option<Rule> {
    match (one.min(other), one.abs_diff(other)) {
        (_, 0 | 1) => None,
        (0, _) => Some(Rule::SideConfounded),
        _ => Some(Rule::SidesUnbalanced),
    }
}

/// How often what was shown, over all planned forms. Comparisons only: controls and repeats are there to check answers.
struct Showings<'a> {
    study: &'a Study,
    /// For each pair: how often its lower method was on the left and on the right.
    sides: BTreeMap<MethodPair, [u64; 2]>,
    /// For each comparison: how often it was shown as listed and swapped.
    comparisons: Vec<[u64; 2]>,
}

impl<'a> Showings<'a> {
    fn of(study: &'a Study, forms: &[Form]) -> Self {
        let comparisons = vec![[0; 2]; study.comparisons.len()];
        let mut showings = Self { study, sides: BTreeMap::new(), comparisons };
        for form in forms {
            for trial in &form.trials {
                let (Role::Comparison, Some(comparison)) = (trial.role, trial.comparison) else { continue };
                let Some([left, _]) = trial.pair() else { continue };
                let pair = method_pair(study, &study.comparisons[comparison]);
                showings.sides.entry(pair).or_default()[usize::from(study.place(left.method) != pair.1)] += 1;
                let swapped = *left != study.comparisons[comparison].left;
                showings.comparisons[comparison][usize::from(swapped)] += 1;
            }
        }
        showings
    }

    fn name(&self, &(group, a, b): &MethodPair) -> String {
        let [a, b] = [a, b].map(|method| self.study.methods[method].id);
        format!("{a} against {b} in group {}", self.study.groups[group].id)
    }

    /// Sides over a pair's questions together, and within each: single questions and objects are tested too. One fault a
    /// pair, the graver. A multiple of `even` participants makes sides even, if the forms balance them at all.
    fn sides(&self, study: &Study, even: Option<usize>) -> Vec<Fault> {
        let mut faults = Vec::new();
        for (pair, &counts) in &self.sides {
            let of = self.comparisons.iter().zip(&study.comparisons);
            let own = of.filter(|(_, comparison)| method_pair(study, comparison) == *pair);
            let questions: Vec<(&str, Option<Rule>)> =
                own.map(|(&counts, comparison)| (comparison.question.as_str(), side_rule(counts))).collect();
            let Some(rule) = questions.iter().filter_map(|(_, rule)| *rule).chain(side_rule(counts)).min()
            else {
                continue;
            };
            let [left, right] = counts;
            let mut evidence =
                format!("{} on the left {left} times, on the right {right} times", study.methods[pair.1].id);
            let found: Vec<&str> =
                questions.iter().filter(|(_, of)| *of == Some(rule)).map(|(q, _)| *q).collect();
            if side_rule(counts) != Some(rule) {
                let how =
                    if rule == Rule::SideConfounded { "always the same side" } else { "one side more often" };
                evidence += &format!("; {how} in {}", found.join(" "));
            }
            if let Some(even) = even {
                evidence += &format!("; a multiple of {even} participants makes them even");
            }
            faults.push(Fault { rule, place: self.name(pair), evidence });
        }
        faults.sort_by_key(|fault| fault.rule);
        faults
    }

    fn appearances(&self, study: &Study) -> Vec<Fault> {
        let mut faults = Vec::new();
        let mut judge = |place: String, what: &str, counts: &BTreeMap<String, u64>, allowed: u64| {
            let least = counts.iter().min_by_key(|(_, count)| **count);
            let most = counts.iter().rev().max_by_key(|(_, count)| **count);
            if let (Some((rare, low)), Some((common, high))) = (least, most)
                && high - low > allowed
            {
                let evidence = format!("{what} {common} {high} times, {rare} {low} times");
                faults.push(Fault { rule: Rule::AppearancesUnequal, place, evidence });
            }
        };
        let by_question = study.comparisons.iter().map(|c| c.question.clone());
        let counts = by_question.zip(self.comparisons.iter().map(|[a, b]| a + b)).collect();
        judge("comparisons".into(), "question", &counts, 1);
        for group in &study.groups {
            // By design, not by showing: showings of single comparisons are judged above.
            let mut counts: BTreeMap<String, u64> = BTreeMap::new();
            // An object that the group is not asked about at all is none on which its methods' sums of wins are compared.
            let is_asked =
                |object: usize| group.comparisons.iter().any(|&c| study.comparisons[c].object == object);
            for (_, object) in study.file.objects.iter().enumerate().filter(|(place, _)| is_asked(*place)) {
                for method in &group.members {
                    counts.insert(format!("{}_{method}", object.id), 0);
                }
            }
            for &comparison in &group.comparisons {
                let of = &study.comparisons[comparison];
                [&of.left, &of.right].iter().for_each(|id| *counts.entry(id.to_string()).or_default() += 1);
            }
            judge(format!("group {}", group.id), "asked about", &counts, 0);
        }
        faults
    }

    fn connections(&self, study: &Study) -> Vec<Fault> {
        let mut faults = Vec::new();
        for (g, group) in study.groups.iter().enumerate() {
            let mut parts: Vec<BTreeSet<usize>> =
                group.members.iter().map(|&member| [study.place(member)].into()).collect();
            for (_, a, b) in self.sides.keys().filter(|(of, _, _)| *of == g) {
                let (joined, mut apart): (Vec<_>, Vec<_>) =
                    parts.into_iter().partition(|part| part.contains(a) || part.contains(b));
                apart.push(joined.into_iter().flatten().collect());
                parts = apart;
            }
            if parts.len() > 1 {
                let list = |part: &BTreeSet<usize>| {
                    let ids = part.iter().map(|&place| study.methods[place].id.to_string());
                    ids.collect::<Vec<_>>().join(" ")
                };
                let evidence = format!(
                    "{} parts: {}",
                    parts.len(),
                    parts.iter().map(list).collect::<Vec<_>>().join(" | ")
                );
                faults.push(Fault {
                    rule: Rule::ComparisonsDisconnected,
                    place: format!("group {}", group.id),
                    evidence,
                });
            }
        }
        faults
    }
}

#[cfg(test)]
mod tests;
