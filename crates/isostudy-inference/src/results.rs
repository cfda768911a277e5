//! Everything that is said of a study or of answers, computed once.

pub mod conclusions;

use crate::agreement::Agreement;
use crate::answered::Answered;
use crate::attributes::{Attributed, attributed};
use crate::audit::{self, audit};
use crate::ballots::{ALL_METHODS, BallotGroup};
use crate::decision::{Front, ObjectCandidates, Pick, candidates, fronts, picks};
use crate::glance;
use crate::hypotheses::{self, Dependence, Hypothesis, On, Robustness, Rules, Target};
use crate::inputs::Inputs;
use crate::leave_one_out::WithoutOne;
use crate::liking::Liking;
use crate::majorities::Majorities;
use crate::models::{self, GroupModel};
use crate::omnibus::{self, Omnibus};
use crate::prediction::Prediction;
use crate::recorded::Recorded;
use crate::scale::{GroupScale, scales};
use crate::screened::{self, Respondent, WithoutBreakers};
use crate::screens::{self, Compared, Turned};
use crate::sides::Sides;
use crate::tipping::Undone;
use crate::ways::{self, OfGroup};
use conclusions::{Conclusion, Conclusions};
use isostudy_design::Study;
use isostudy_design::contrast::Over;
use isostudy_responses::Responses;
use isostudy_statistics::{DeclaredBallot, ShownBallot, screening_with};
use isostudy_timing::beside_other_work;
use rayon::prelude::*;
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

/// What a study's answers, meshes and times show.
pub struct Results<'a> {
    /// What they were made from.
    pub inputs: Inputs<'a>,
    /// What the answers say; `None` without answers.
    pub preferences: Option<Preferences<'a>>,
    /// What predicts preference, where answers and meshes tell it.
    pub prediction: Option<Prediction>,
    /// Who is liked most: on all objects, then on each; empty without answers.
    pub likings: Vec<Liking>,
    /// Which method to take.
    pub decision: Decision<'a>,
    /// What was found.
    pub conclusions: Conclusions,
}

/// Whether a server chose questions by what was answered before.
fn is_adaptive(study: &Study) -> bool {
    study.file.forms.as_ref().is_some_and(|forms| forms.adaptive)
}

impl<'a> Results<'a> {
    /// Computes everything once.
    pub fn of(inputs: &Inputs<'a>) -> Self {
        let of_answers = || {
            let answered = inputs.answers?;
            let prediction = || Prediction::of(inputs, &answered.shown, &answered.declared);
            Some(rayon::join(|| Preferences::of_study(inputs.study, answered), prediction))
        };
        let of_meshes = || {
            let level = Rules::of(&inputs.study.file.analysis).level;
            let likings = inputs.answers.map_or_else(Vec::new, |of| Liking::all(inputs.study, of, level));
            let decision = Decision::of(inputs, &likings);
            (likings, decision)
        };
        let (answers, (likings, decision)) = rayon::join(of_answers, of_meshes);
        let (preferences, prediction) = answers.unzip();
        let prediction = prediction.flatten();
        let of_answers = preferences.as_ref().map_or_else(Conclusions::default, |of: &Preferences<'_>| {
            of.conclusions.clone().with(&likings, prediction.as_ref(), of.rules().level)
        });
        let is_busy = inputs.bench.is_some_and(|run| beside_other_work(run).is_some());
        let conclusions = of_answers.with_picks(&decision.picks, is_busy);
        Self { inputs: *inputs, preferences, prediction, likings, decision, conclusions }
    }
}

/// What each method costs and gives on each object, who is beaten, and who is the best at what is wanted.
pub struct Decision<'a> {
    /// The methods on each object that there is anything to choose on.
    pub objects: Vec<ObjectCandidates<'a>>,
    /// The fronts of each of these objects.
    pub fronts: Vec<Vec<Front>>,
    /// The best at each want.
    pub picks: Vec<Pick<'a>>,
}

impl<'a> Decision<'a> {
    fn of(inputs: &Inputs<'a>, likings: &[Liking]) -> Self {
        let objects = candidates(inputs, likings);
        // Beside other work nothing is said that times decide.
        let is_busy = inputs.bench.is_some_and(|run| beside_other_work(run).is_some());
        let is_told = |front: &Front| !is_busy || !front.axes.is_of_times();
        let fronts = objects.iter().map(|of| fronts(of).into_iter().filter(is_told).collect()).collect();
        Self { picks: picks(&objects), fronts, objects }
    }

    /// Each object with its fronts.
    pub fn each(&self) -> impl Iterator<Item = (&ObjectCandidates<'a>, &[Front])> {
        self.objects.iter().zip(self.fronts.iter().map(Vec::as_slice))
    }
}

/// What answers alone say, with a study or without one.
pub struct Preferences<'a> {
    /// The study, if there is one.
    pub study: Option<&'a Study>,
    /// Every answer as it was read.
    pub responses: &'a Responses,
    /// How many people are left out, by a rule that the study declares.
    pub excluded: usize,
    /// Answers to comparisons on the sides that people saw.
    pub shown: Cow<'a, [ShownBallot]>,
    /// The same answers, about items.
    pub declared: Cow<'a, [DeclaredBallot]>,
    /// The items that are compared with one another.
    pub groups: &'a [BallotGroup],
    /// Every contrast, then every question.
    pub hypotheses: Cow<'a, [Hypothesis]>,
    /// What else is known of each hypothesis.
    pub robustness: Vec<Robustness>,
    /// Every contrast in a row.
    pub contrasts: Vec<glance::Row>,
    /// Friedman's tests; none without a study.
    pub omnibus: Vec<Omnibus>,
    /// Every model of every group.
    pub models: Vec<GroupModel<'a>>,
    /// The items of each group on one scale.
    pub scales: Vec<GroupScale<'a>>,
    /// Models of the way in which people were asked, where answers say more than which of two was chosen.
    pub ways: Vec<OfGroup<'a>>,
    /// How far people agree about all questions, then about each group of a study's.
    pub agreement: Vec<Agreement>,
    /// Everything that was answered, and how.
    pub recorded: Recorded<'a>,
    /// Every hypothesis that was tested, by its place, with each participant in turn left out; single questions are left out.
    pub without_one: Vec<(usize, WithoutOne)>,
    /// What a liking for a side means for each hypothesis that holds; `None` for others, and where the file does not say what stood
    /// on which side.
    undone: Vec<Option<Undone>>,
    /// What the design says about sides; `None` where the file does not say what stood where.
    pub sides: Option<Sides<'a>>,
    /// Who answers with the others and who against them.
    pub majorities: Majorities,
    /// What was seen of everybody.
    pub respondents: Vec<Respondent>,
    /// The tests without those who broke a rule.
    pub screened: Vec<WithoutBreakers>,
    /// What the probes found.
    pub audit: Vec<audit::Report>,
    /// Answers by the screen that they were given on.
    pub screens: Vec<Compared>,
    /// How far people turned models, where they were shown any.
    pub turned: Option<Turned>,
    /// Whether worths go with what is known of people; none where the study names no column of them.
    pub attributed: Vec<Attributed<'a>>,
    /// What was found.
    pub conclusions: Conclusions,
}

impl<'a> Preferences<'a> {
    /// Of a study's answers.
    pub fn of_study(study: &'a Study, answered: &'a Answered) -> Self {
        // What the groups compare, all methods compare again.
        let groups = &answered.groups[..];
        let probed = match groups.split_last() {
            Some((last, others)) if last.name == ALL_METHODS => others,
            _ => groups,
        };
        let base = Base {
            study: Some(study),
            responses: &answered.responses,
            excluded: answered.excluded.len(),
            leaves_out: &answered.excluded,
            shown: Cow::Borrowed(&answered.shown),
            declared: Cow::Borrowed(&answered.declared),
            groups,
            hypotheses: Cow::Borrowed(&answered.hypotheses),
            recorded: Recorded::of_study(study, &answered.responses, answered.everyone(study)),
        };
        base.computed(probed, |respondents| screened::of_study(study, answered, respondents))
    }

    /// Of answers that no study explains; `groups` are their [`open_groups`](crate::open_groups()), `shown_s` is how long what a
    /// question shows lasts, in seconds.
    pub fn without_study(responses: &'a Responses, groups: &'a [BallotGroup], shown_s: Option<f64>) -> Self {
        let shown: Vec<ShownBallot> = groups.iter().flat_map(|group| group.ballots.iter().copied()).collect();
        let base = Base {
            study: None,
            responses,
            excluded: 0,
            leaves_out: &NOBODY,
            declared: shown.iter().map(ShownBallot::by_item).collect(),
            shown: Cow::Owned(shown),
            groups,
            hypotheses: Cow::Owned(hypotheses::of_groups(groups)),
            recorded: Recorded::without_study(responses, shown_s),
        };
        base.computed(groups, |respondents| screened::of_groups(groups, respondents))
    }

    /// What decides conclusions.
    pub fn rules(&self) -> Rules {
        self.study.map_or_else(Rules::default, |study| Rules::of(&study.file.analysis))
    }

    /// What shows that a preference over several objects depends on the object; `None` of one on one object, of a difference, and
    /// where nothing shows it.
    pub fn dependence(&self, of: &Hypothesis) -> Option<Dependence<'_>> {
        let level = of.rules.level;
        match &of.target {
            Target::Contrast { levels, over: Over::All | Over::Within(_) } => {
                hypotheses::depends_on_object(&self.hypotheses, &self.omnibus, *levels, level)
            }
            Target::Items { group, on: On::All, .. } => {
                let between = self.hypotheses.iter().filter(|other| {
                    let same = matches!(&other.target, Target::Items { group: own, on: On::Difference(_), .. } if own == group);
                    same && other.contrast == of.contrast && other.adjusted <= level
                });
                let clearest = between.min_by(|a, b| a.test.sign_flip.ln_p.total_cmp(&b.test.sign_flip.ln_p));
                clearest.map(Dependence::Difference)
            }
            _ => None,
        }
    }

    /// Every contrast in a row, with what was found of it.
    pub fn concluded(&self) -> Vec<(&glance::Row, &Conclusion)> {
        self.contrasts.iter().zip(self.conclusions.of_contrasts()).collect()
    }

    /// Whether the probes found that people favour a side.
    pub fn is_side_favoured(&self) -> bool {
        self.audit.iter().any(finds_side)
    }

    /// How large a liking for a side would undo a hypothesis that holds; `None` where sides cannot have made it.
    pub fn undone(&self, hypothesis: &Hypothesis) -> Option<Undone> {
        let place = self.hypotheses.iter().position(|of| of.is_about_the_same(hypothesis))?;
        self.undone[place]
    }
}

/// Whether a probe found that people favour a side.
fn finds_side(of: &audit::Report) -> bool {
    (of.probe, of.finding) == (audit::Probe::Side, audit::Finding::Found)
}

/// What the rest is computed from.
struct Base<'a> {
    study: Option<&'a Study>,
    responses: &'a Responses,
    excluded: usize,
    /// Who that is.
    leaves_out: &'a BTreeSet<usize>,
    shown: Cow<'a, [ShownBallot]>,
    declared: Cow<'a, [DeclaredBallot]>,
    groups: &'a [BallotGroup],
    hypotheses: Cow<'a, [Hypothesis]>,
    recorded: Recorded<'a>,
}

/// Without a study nobody is left out.
static NOBODY: BTreeSet<usize> = BTreeSet::new();

impl<'a> Base<'a> {
    /// `probed` are the groups that probes look at.
    fn computed(
        self,
        probed: &[BallotGroup],
        without: impl Fn(&[Respondent]) -> Vec<WithoutBreakers> + Sync,
    ) -> Preferences<'a> {
        let Self { study, responses, excluded, leaves_out, shown, declared, groups, hypotheses, recorded } =
            self;
        let people = || {
            let protocol = recorded.protocol();
            let seen = screening_with(recorded.ballots(), &protocol);
            let respondents = Respondent::all(seen, &protocol);
            let screened = without(&respondents);
            (respondents, screened)
        };
        let tested = || {
            let majorities = || Majorities::of(study, &shown, &declared, groups, &hypotheses);
            let undone = |of: &Hypothesis| {
                let holds = responses.sides_recorded && of.differs() && !of.is_question();
                holds.then(|| Undone::of(study, &shown, groups, of)).flatten()
            };
            rayon::join(
                || (WithoutOne::of_tested(&hypotheses), majorities()),
                || (Robustness::of(&hypotheses), hypotheses.par_iter().map(undone).collect()),
            )
        };
        let sides = || responses.sides_recorded.then(|| Sides::of(&shown, groups));
        let models = || models::of_groups(groups, responses.sides_recorded);
        let ((models, (scales, sides)), ((respondents, screened), (audit, tested))) = rayon::join(
            || rayon::join(models, || (scales(groups), sides())),
            || rayon::join(people, || rayon::join(|| audit(&recorded.audited(probed)), tested)),
        );
        let ((without_one, majorities), (robustness, undone)) = tested;
        let mut hypotheses = hypotheses;
        if audit.iter().any(finds_side) {
            let on_one_side = sides.as_ref().is_some_and(Sides::go_with_items);
            hypotheses.to_mut().iter_mut().for_each(|of| of.mark_side(on_one_side));
        }
        let agreement = match study {
            Some(study) => of_study(study, &declared),
            None => vec![of_groups(groups, &recorded, &declared)],
        };
        let mut found = Preferences {
            conclusions: Conclusions::default(),
            contrasts: glance::rows(study, &hypotheses),
            omnibus: study.map_or_else(Vec::new, |study| omnibus::tests(study, &declared)),
            screens: screens::compared(responses),
            turned: screens::turned(responses),
            attributed: attributed(study, responses, groups),
            study,
            responses,
            excluded,
            shown,
            declared,
            groups,
            hypotheses,
            robustness,
            models,
            scales,
            ways: match study.filter(|_| !responses.judged.is_empty()) {
                Some(study) => ways::of_judged(study, responses, leaves_out, groups),
                None if study.is_some_and(is_adaptive) => ways::of_adaptive(groups),
                None => ways::of_steps(groups),
            },
            agreement,
            recorded,
            without_one,
            undone,
            sides,
            majorities,
            respondents,
            screened,
            audit,
        };
        found.conclusions = Conclusions::of(&found);
        found
    }
}

/// All questions, then each comparison group.
fn of_study(study: &Study, ballots: &[DeclaredBallot]) -> Vec<Agreement> {
    let scope = |question: usize| {
        let comparison = &study.comparisons[question];
        comparison.object * study.groups.len() + comparison.group
    };
    let of_group = |group: Option<usize>| {
        let inside = |b: &&DeclaredBallot| group.is_none_or(|g| study.comparisons[b.question()].group == g);
        let own: Vec<DeclaredBallot> = ballots.iter().filter(inside).copied().collect();
        Agreement::of(&own, group, scope)
    };
    std::iter::once(None).chain((0..study.groups.len()).map(Some)).map(of_group).collect()
}

/// All questions; one person's answers about different objects are no tournament.
fn of_groups(groups: &[BallotGroup], recorded: &Recorded<'_>, ballots: &[DeclaredBallot]) -> Agreement {
    let protocol = recorded.protocol();
    let mut group_of: BTreeMap<usize, usize> = BTreeMap::new();
    for (g, group) in groups.iter().enumerate() {
        group_of.extend(group.ballots.iter().map(|ballot| (ballot.question(), g)));
    }
    let scope = |question: usize| protocol.scenes[question] * groups.len() + group_of[&question];
    Agreement::of(ballots, None, scope)
}
