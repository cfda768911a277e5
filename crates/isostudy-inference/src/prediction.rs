//! What predicts preference? People's choices against measures of the meshes that they were shown.
//!
//! For each [`Metric`]: how often the item with the better value was chosen, and a model of choice on the difference,
//! judged on objects that it was not fitted to. Intervals and sign-flip tests are clustered on participants, so they speak of
//! other people before the same pairs. [`Relabelled`] speaks of other methods. A metric [holds](MetricPrediction::holds) if both
//! tests do. Nothing here speaks of other objects beyond what leaving one out shows.

mod better;
mod held_out;
mod metric;
mod relabelled;

pub use better::Better;
pub use held_out::HeldOut;
pub use metric::{METRICS, Metric, Scale};
pub use relabelled::Relabelled;

use crate::inputs::Inputs;
use crate::mesh_set::MeshSet;
use isostudy_design::Study;
use isostudy_design::record::Purpose;
use isostudy_statistics::{Coefficient, DeclaredBallot, FitError, ShownBallot, holm, regression, spearman};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// One metric over the study's questions.
#[derive(Debug, Clone)]
pub struct MetricPrediction {
    /// The metric.
    pub metric: &'static Metric,
    /// The advantage of each question's first item, which the study lists on the left, see [`Metric::advantage`]; `None`
    /// without values or answers.
    pub advantages: Vec<Option<f64>>,
    /// Root mean square of the advantages: the unit of the coefficient.
    pub unit: f64,
    /// How often the better item was chosen.
    pub better: Better,
    /// Of the answers to pairs with a better and a worse value, how many were given with the better one on the right.
    pub better_right: u64,
    /// How many such answers there are.
    pub showings: u64,
    /// The sign-flip p, adjusted by Holm over the metrics.
    pub adjusted: f64,
    /// Whether other orders of the methods go with the answers as well; `None` for fewer than three methods.
    pub relabelled: Option<Relabelled>,
    /// Log-odds of being chosen for one `unit` of advantage.
    pub coefficient: Result<Coefficient, FitError>,
    /// Predictions of each object from the others.
    pub held_out: Option<HeldOut>,
    /// The p of a gain on objects left out, by Holm over the metrics that have one.
    pub gain_adjusted: Option<f64>,
}

/// All metrics, and what they have to be read against.
#[derive(Debug, Clone)]
pub struct Prediction {
    /// Metrics with a difference in at least one question.
    pub metrics: Vec<MetricPrediction>,
    /// Spearman's correlation of the metrics' advantages, each pair taken in both orders; by the order of `metrics`.
    pub correlations: Vec<Vec<Option<f64>>>,
    /// All metrics in one model, by the order of `metrics`.
    pub joint: Result<Vec<Coefficient>, FitError>,
    /// The joint model, each object from the others.
    pub joint_held_out: Option<HeldOut>,
    /// No metric: which side something stood on, and nothing else.
    pub side_held_out: Option<HeldOut>,
    /// Questions with answers and values.
    pub pairs: usize,
    /// Meshes in these.
    pub meshes: usize,
    /// Differences between them that do not follow from others: meshes less connected sets of them.
    pub independent: usize,
    /// Objects in these.
    pub objects: usize,
}

impl Prediction {
    /// From the same answers, as they were shown and as the study declares them. `None` without answers to questions whose
    /// meshes were measured.
    pub fn of(inputs: &Inputs<'_>, shown: &[ShownBallot], declared: &[DeclaredBallot]) -> Option<Self> {
        let study = inputs.study;
        let meshes = MeshSet::of(inputs, Purpose::Stimulus);
        let answered: BTreeSet<usize> = declared.iter().map(|ballot| ballot.question()).collect();
        let mut metrics = Vec::new();
        for metric in METRICS {
            let advantage = |(q, c): (usize, &isostudy_design::Comparison)| {
                let value = |id| meshes.get(id).and_then(metric.value);
                let known = metric.advantage(value(&c.left)?, value(&c.right)?)?;
                answered.contains(&q).then_some(known)
            };
            let advantages: Vec<Option<f64>> = study.comparisons.iter().enumerate().map(advantage).collect();
            if advantages.iter().flatten().any(|advantage| *advantage != 0.0) {
                metrics.push(MetricPrediction::of(metric, advantages, study, (shown, declared)));
            }
        }
        let shown_methods: Vec<([usize; 2], usize)> = study
            .comparisons
            .iter()
            .map(|c| ([&c.left, &c.right].map(|id| study.place(id.method)), c.object))
            .collect();
        let methods = study.method_ids();
        let answers = relabelled::Answers::of(methods.len(), &shown_methods, declared);
        metrics.par_iter_mut().for_each(|of| {
            let value = |object: usize, method| meshes.at(object, methods[method]).and_then(of.metric.value);
            let advantage =
                |[a, b]: [usize; 2], object| of.metric.advantage(value(object, a)?, value(object, b)?);
            of.relabelled = answers.relabelled(&advantage);
        });
        adjust(&mut metrics);
        let complete = |q: usize| {
            metrics.iter().map(|m| m.advantages[q].map(|a| a / m.unit)).collect::<Option<Vec<f64>>>()
        };
        let joint: Vec<Option<Vec<f64>>> = (0..study.comparisons.len()).map(complete).collect();
        let side: Vec<Option<Vec<f64>>> = joint.iter().map(|x| x.as_ref().map(|_| vec![1.0])).collect();
        let coefficients = regression(&joint, declared).and_then(|fit| {
            (0..metrics.len())
                .map(|i| fit.coefficient(i))
                .collect::<Option<Vec<_>>>()
                .ok_or(FitError::Nothing)
        });
        let used: Vec<usize> = (0..joint.len()).filter(|&q| joint[q].is_some()).collect();
        let (meshes, independent) = independent_differences(study, &used);
        let objects: BTreeSet<usize> = used.iter().map(|&q| study.comparisons[q].object).collect();
        (!metrics.is_empty()).then(|| Self {
            correlations: correlations(&metrics),
            joint: coefficients,
            joint_held_out: HeldOut::of(study, &joint, declared),
            side_held_out: HeldOut::of(study, &side, shown),
            pairs: used.len(),
            meshes,
            independent,
            objects: objects.len(),
            metrics,
        })
    }
}

/// Every p by Holm over the metrics that have one.
fn adjust(metrics: &mut [MetricPrediction]) {
    fn over(
        metrics: &mut [MetricPrediction],
        p: impl Fn(&MetricPrediction) -> Option<f64>,
        set: impl Fn(&mut MetricPrediction, f64),
    ) {
        let tested: Vec<(usize, f64)> =
            metrics.iter().enumerate().filter_map(|(i, of)| Some((i, p(of)?))).collect();
        let adjusted = holm(&tested.iter().map(|&(_, p)| p).collect::<Vec<_>>());
        tested.into_iter().zip(adjusted).for_each(|((i, _), p)| set(&mut metrics[i], p));
    }
    over(metrics, |of| Some(of.better.test.sign_flip.p()), |of, p| of.adjusted = p);
    over(
        metrics,
        |of| of.relabelled.map(|of| of.p),
        |of, p| {
            of.relabelled.iter_mut().for_each(|of| of.adjusted = p);
        },
    );
    over(metrics, |of| of.held_out.as_ref()?.gain_p, |of, p| of.gain_adjusted = Some(p));
}

impl MetricPrediction {
    /// Whether it goes with preference, or against it, before other people and among other methods: both p, after Holm's
    /// correction over the metrics, are at most `level`.
    pub fn holds(&self, level: f64) -> bool {
        self.adjusted <= level && self.relabelled.is_some_and(|of| of.adjusted <= level)
    }

    /// Whether it foretells objects that it was not fitted to: it holds, and the one-sided p of its gain, after Holm's correction
    /// over the metrics, is at most half of `level`.
    pub fn foretells(&self, level: f64) -> bool {
        self.holds(level) && self.gain_adjusted.is_some_and(|p| p <= level / 2.0)
    }

    fn of(
        metric: &'static Metric,
        advantages: Vec<Option<f64>>,
        study: &Study,
        (shown, declared): (&[ShownBallot], &[DeclaredBallot]),
    ) -> Self {
        let known: Vec<f64> = advantages.iter().flatten().copied().collect();
        let unit = (known.iter().map(|a| a * a).sum::<f64>() / known.len() as f64).sqrt();
        let x: Vec<Option<Vec<f64>>> = advantages.iter().map(|a| a.map(|a| vec![a / unit])).collect();
        let coefficient =
            regression(&x, declared).and_then(|fit| fit.coefficient(0).ok_or(FitError::Nothing));
        // Whether the better one stood on the right, of each answer to a pair with a better one.
        let right: Vec<bool> = shown
            .iter()
            .zip(declared)
            .filter_map(|(shown, declared)| {
                let advantage = advantages[shown.question()].filter(|advantage| *advantage != 0.0)?;
                Some((advantage > 0.0) == (declared.first() == shown.right()))
            })
            .collect();
        Self {
            better: Better::of(&advantages, declared),
            better_right: right.iter().filter(|right| **right).count() as u64,
            showings: right.len() as u64,
            held_out: HeldOut::of(study, &x, declared),
            adjusted: 1.0,
            relabelled: None,
            gain_adjusted: None,
            metric,
            unit,
            advantages,
            coefficient,
        }
    }
}

/// Taken in both orders, so that what happened to be on the left does not matter.
fn correlations(metrics: &[MetricPrediction]) -> Vec<Vec<Option<f64>>> {
    let between = |a: &MetricPrediction, b: &MetricPrediction| {
        let both = a.advantages.iter().zip(&b.advantages).filter_map(|(a, b)| a.zip(*b));
        let (a, b): (Vec<f64>, Vec<f64>) = both.flat_map(|(a, b)| [(a, b), (-a, -b)]).unzip();
        spearman(&a, &b)
    };
    metrics.iter().map(|a| metrics.iter().map(|b| between(a, b)).collect()).collect()
}

/// How many meshes the questions show, and how many of their differences do not follow from others.
fn independent_differences(study: &Study, questions: &[usize]) -> (usize, usize) {
    let mut set: BTreeMap<String, usize> = BTreeMap::new();
    let mut joined = 0;
    for &q in questions {
        let [left, right] = [&study.comparisons[q].left, &study.comparisons[q].right].map(|id| {
            let next = set.len();
            *set.entry(id.to_string()).or_insert(next)
        });
        if left != right {
            joined += 1;
            set.values_mut().filter(|of| **of == right).for_each(|of| *of = left);
        }
    }
    (set.len(), joined)
}

#[cfg(test)]
mod tests;
