//! A model judged on objects that it was not fitted to.

use isostudy_design::Study;
use isostudy_statistics::interval::unanimous;
use isostudy_statistics::{Answer, ClusteredShare, clustered_share, regression};
use statrs::distribution::{ContinuousCDF, StudentsT};
use std::collections::{BTreeMap, BTreeSet};

/// Predictions of each object's answers from a fit to the other objects'.
#[derive(Debug, Clone)]
pub struct HeldOut {
    /// Decided answers that went to the side with the larger chance; equal chances count half.
    pub accuracy: ClusteredShare,
    /// Mean of -ln of the chance that was given to what was answered; 0 is perfect.
    pub log_loss: f64,
    /// The same for the constant: both sides alike, ties as often as in the other objects.
    pub constant_log_loss: f64,
    /// One-sided p of a t test over participants that the mean of `constant_log_loss - log_loss` is zero or less: small, the model is of
    /// use. `None` for fewer than two people, or if all gain the same.
    pub gain_p: Option<f64>,
    /// Object, decided answers foretold, decided answers.
    pub objects: Vec<(usize, f64, f64)>,
}

impl HeldOut {
    /// `covariates` by question: of the first item where the ballots are about items, of the left side where they are about
    /// sides. `None` with fewer than two objects, if a fit has no estimate, or if an outcome that a fit
    /// never saw occurs on the object left out (its loss is infinite).
    pub fn of<A: Answer>(study: &Study, covariates: &[Option<Vec<f64>>], ballots: &[A]) -> Option<Self> {
        let object = |b: &A| study.comparisons[b.question()].object;
        let used: Vec<A> = ballots.iter().filter(|b| covariates[b.question()].is_some()).copied().collect();
        let objects: BTreeSet<usize> = used.iter().map(object).collect();
        if objects.len() < 2 {
            return None;
        }
        let mut people: BTreeMap<usize, Person> = BTreeMap::new();
        let mut of_objects = Vec::new();
        for &left_out in &objects {
            let (own, others): (Vec<A>, Vec<A>) = used.iter().partition(|b| object(b) == left_out);
            let fit = regression(covariates, &others).ok()?;
            let ties = others.iter().filter(|b| b.place() == 1).count() as f64 / others.len() as f64;
            let constant = [0.5 * (1.0 - ties), ties, 0.5 * (1.0 - ties)];
            let (mut hits, mut decided) = (0.0, 0.0);
            for ballot in &own {
                let x = covariates[ballot.question()].as_ref().expect("filtered above");
                let place = ballot.place();
                let sign = (fit.log_odds(x) * (1.0 - place as f64)).partial_cmp(&0.0)?;
                let person = people.entry(ballot.participant()).or_default();
                if place != 1 {
                    let hit = 0.5 + 0.5 * f64::from(sign as i8);
                    (hits, decided) = (hits + hit, decided + 1.0);
                    (person.hits, person.decided) = (person.hits + hit, person.decided + 1.0);
                }
                person.answers += 1.0;
                person.loss -= fit.chances(x)[place].ln();
                person.constant -= constant[place].ln();
            }
            of_objects.push((left_out, hits, decided));
        }
        let people: Vec<Person> = people.into_values().collect();
        let mean = |of: fn(&Person) -> f64| {
            people.iter().map(of).sum::<f64>() / people.iter().map(|p| p.answers).sum::<f64>()
        };
        let (log_loss, constant_log_loss) = (mean(|p| p.loss), mean(|p| p.constant));
        let gains: Vec<f64> = people.iter().map(|p| (p.constant - p.loss) / p.answers).collect();
        let accuracy = clustered_share(people.iter().map(|p| (p.hits, p.decided)))?;
        let finite = log_loss.is_finite() && constant_log_loss.is_finite();
        finite.then(|| Self {
            gain_p: gain_p(&gains),
            objects: of_objects,
            accuracy,
            log_loss,
            constant_log_loss,
        })
    }
}

/// See [`HeldOut::gain_p`].
fn gain_p(gains: &[f64]) -> Option<f64> {
    if gains.len() < 2 || unanimous(gains).is_some() {
        return None;
    }
    let n = gains.len() as f64;
    let mean = gains.iter().sum::<f64>() / n;
    let variance = gains.iter().map(|gain| (gain - mean).powi(2)).sum::<f64>() / (n - 1.0);
    let t = StudentsT::new(0.0, 1.0, n - 1.0).expect("two people or more");
    Some(t.sf(mean / (variance / n).sqrt()))
}

/// One participant's sums.
#[derive(Debug, Clone, Copy, Default)]
struct Person {
    hits: f64,
    decided: f64,
    answers: f64,
    loss: f64,
    constant: f64,
}
