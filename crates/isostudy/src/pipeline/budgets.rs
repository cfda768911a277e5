//! Budgets: the spacing at which a method gives as many triangles or samples, or takes as much time, as another.

use super::Pipeline;
use super::meshes::purpose_name;
use crate::prepare::{self, Wanted};
use crate::recipe::Recipe;
use crate::region;
use crate::terminal::progress::Step;
use anyhow::{Context, Result, bail};
use isostudy_design::config::{BudgetSection, Quantity};
use isostudy_design::record::Purpose;
use isostudy_design::{Configuration, ConfigurationId};
use isostudy_extract::{Execution, Extractor};
use serde::{Deserialize, Serialize};
use std::time::Instant;

/// How many spacings are tried for one mesh by bisection.
const MOST_STEPS: u32 = 24;
/// Counts jump where one more cell fits into the box, and may jump past what is wanted: then so many spacings more are tried, up to
/// this factor finer and coarser.
const MORE_STEPS: u32 = 96;
const AROUND: f64 = 1.2;
/// Extractions of which the median is taken where time is matched.
const ROUNDS: usize = 5;

/// A spacing, and what it gave.
type Tried = (f64, f64);

/// What was found for one configuration.
#[derive(Debug, Serialize, Deserialize)]
struct Found {
    schema: u32,
    id: ConfigurationId,
    /// Whose mesh is matched.
    of: ConfigurationId,
    /// In what: triangles, samples, time.
    what: String,
    /// What the other has; seconds of time.
    wanted: f64,
    /// What this has at the spacing.
    found: f64,
    spacing: f64,
    /// Spacings that were tried.
    steps: u32,
}

impl Pipeline<'_> {
    /// Finds the spacing of every configuration in `only`, or of all if it is empty, whose method has a budget, for some purposes.
    ///
    /// # Errors
    /// If no spacing meets one; what an extractor refuses.
    pub(crate) fn budgets(&self, purposes: &[Purpose], only: &[ConfigurationId]) -> Result<()> {
        let with_budget = |c: &&Configuration| {
            (only.is_empty() || only.contains(&c.id)) && self.study.method(c.id.method).budget.is_some()
        };
        let asked: Vec<&Configuration> = self.study.configurations.iter().filter(with_budget).collect();
        if asked.is_empty() {
            return Ok(());
        }
        let step = Step::begin("budgets", asked.len() * purposes.len(), asked.len() * purposes.len());
        for &purpose in purposes {
            for configuration in &asked {
                if let Err(error) = self.budget(configuration, purpose, &step) {
                    self.fail(&configuration.id, error)?;
                }
                step.tick(1);
            }
        }
        step.end();
        Ok(())
    }

    fn budget(&self, configuration: &Configuration, purpose: Purpose, step: &Step) -> Result<()> {
        let budget = self.study.method(configuration.id.method).budget.context("it has one")?;
        let of = ConfigurationId { object: configuration.id.object.clone(), method: budget.of };
        let reference = self.study.configurations.iter().find(|c| c.id == of);
        let reference = reference.context("methods are crossed with objects")?;
        let inputs = self
            .extraction_inputs(configuration, purpose)?
            .value("budget", &budget)
            .value("spacing", &Wanted::For(purpose).spacing(self.study.object(configuration)))
            .text("of", &self.extraction_inputs(reference, purpose)?.finish());
        let name = format!("budget/{}/{}", purpose_name(purpose), configuration.id);
        let file = format!("budgets/{}/{}.json", purpose_name(purpose), configuration.id);
        let stamp = self.stage(&name, inputs, |writer| {
            let found = self.search(configuration, reference, budget, purpose)?;
            writer.write_json(&file, &found)
        })?;
        step.count(stamp.redone);
        let text = self.store.read(&stamp, ".json")?;
        let found: Found = serde_json::from_slice(&text).with_context(|| file.clone())?;
        self.keep_spacing(found.id, purpose, found.spacing);
        Ok(())
    }

    /// Bisection over spacings, each guessed from how counts grow: with the square of the resolution, or its cube.
    fn search(
        &self,
        configuration: &Configuration,
        reference: &Configuration,
        budget: BudgetSection,
        purpose: Purpose,
    ) -> Result<Found> {
        let start = Wanted::For(purpose).spacing(self.study.object(configuration));
        let wanted = self.measure(reference, budget, Wanted::Spacing(start, purpose))?;
        let within = budget.within;
        let power = match budget.quantity {
            Quantity::Triangles | Quantity::Time => 2.0,
            Quantity::Samples => 3.0,
        };
        let [key, what] = budget.quantity.names();
        // The finest spacing that gives too little, and the coarsest that gives too much.
        let (mut coarse, mut fine): (Option<Tried>, Option<Tried>) = (None, None);
        let mut spacing = start;
        for steps in 1..=MOST_STEPS + MORE_STEPS {
            let found = self.measure(configuration, budget, Wanted::Spacing(spacing, purpose))?;
            if (found - wanted).abs() <= within * wanted {
                return Ok(Found {
                    schema: 1,
                    id: configuration.id.clone(),
                    of: reference.id.clone(),
                    what: what.into(),
                    wanted,
                    found,
                    spacing,
                    steps,
                });
            }
            if steps >= MOST_STEPS {
                // From the middle outwards, finer and coarser in turn.
                let middle = coarse.or(fine).map_or(start, |(at, _)| at);
                let (far, side) = ((steps - MOST_STEPS) / 2 + 1, if steps % 2 == 0 { 1.0 } else { -1.0 });
                spacing = middle * AROUND.powf(side * 2.0 * f64::from(far) / f64::from(MORE_STEPS));
                continue;
            }
            let side = if found < wanted { &mut coarse } else { &mut fine };
            *side = Some((spacing, found));
            let guess = spacing * (found.max(1e-9) / wanted).powf(1.0 / power).clamp(0.1, 10.0);
            spacing = match (fine, coarse) {
                (Some((low, _)), Some((high, _))) if guess <= low || guess >= high || steps % 3 == 0 => {
                    (low * high).sqrt()
                }
                _ => guess,
            };
        }
        let nearest = [coarse, fine].into_iter().flatten();
        let nearest: Vec<String> = nearest.map(|(s, found)| format!("{found} at {s:?}")).collect();
        let i = self.study.place(configuration.id.method);
        bail!(
            "{}: methods[{i}].match.{key} = {}: no spacing gives {} {wanted} {what} to {} %: {}",
            self.study.path.display(),
            budget.of,
            configuration.id,
            100.0 * within,
            nearest.join(", ")
        )
    }

    fn measure(&self, configuration: &Configuration, budget: BudgetSection, wanted: Wanted) -> Result<f64> {
        let prepared = self.prepare(configuration, wanted)?;
        if let Recipe::Extractor(method) = &prepared.recipe {
            let execution = Execution { threads: self.threads };
            let machine = isostudy_bench::read_machine().memory_bytes;
            prepare::check_memory(
                self.study,
                configuration.object,
                method,
                &prepared.grid,
                &execution,
                machine,
            )
            .with_context(|| format!("{} with spacing {:?}", configuration.id, prepared.grid.spacing))?;
        }
        if budget.quantity == Quantity::Time {
            let mut seconds = Vec::new();
            // One thread, as engines extract; the first is for warming up.
            for _ in 0..=ROUNDS {
                let begun = Instant::now();
                prepared.make(&mut Extractor::new(), &Execution { threads: 1 })?;
                seconds.push(begun.elapsed().as_secs_f64());
            }
            seconds.remove(0);
            seconds.sort_by(f64::total_cmp);
            return Ok(seconds[ROUNDS / 2]);
        }
        let made = prepared.make(&mut Extractor::new(), &Execution { threads: self.threads })?;
        match budget.quantity {
            Quantity::Samples => Ok(made.counts.samples.context("checked when the study was read")? as f64),
            // As many where it is judged, whatever the block's walls take.
            _ => match &self.study.object(configuration).region {
                Some(region) => Ok(region::triangles(&made.mesh, region).count() as f64),
                None => Ok(made.counts.triangles as f64),
            },
        }
    }
}
