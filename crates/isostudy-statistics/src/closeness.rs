//! Which of two models is closer to the answers? More likelihood alone does not tell: it may be a few people's.

use super::fit::WorthFit;
use super::participants::{AnsweredPair, Participants};
use statrs::distribution::{ContinuousCDF, StudentsT};

/// How much closer one model is than another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Closeness {
    /// Log-likelihood of the first less that of the second, on the same answers.
    pub gain: f64,
    /// Two-sided p of t = gain / its standard error over participants, on m - 1 degrees of freedom; `None` where all
    /// participants gain alike.
    pub p: Option<f64>,
}

/// Vuong's test (1989, Econometrica 57:307) of two fitted models with equally many parameters, neither of which
/// is a case of the other, such as Davidson's and Rao and Kupper's; participants are the observations.
///
/// `None` for fewer than two participants, for a penalised fit, and for models that do not give every answer a chance
/// (Bradley and Terry's, where there are ties).
pub fn closeness(first: &WorthFit, second: &WorthFit, participants: &Participants) -> Option<Closeness> {
    let m = participants.number() as f64;
    if m < 2.0 || first.penalised() || second.penalised() {
        return None;
    }
    let log_ratio = |&(left, right): &(usize, usize)| {
        let [own, other] = [first, second].map(|fit| fit.chances(left, right));
        [0, 1, 2].map(|o| (own[o] / other[o]).ln())
    };
    let ratios: Vec<[f64; 3]> = participants.shown().iter().map(log_ratio).collect();
    let gain_of = |answered: &[AnsweredPair]| -> f64 {
        let given = |of: &AnsweredPair| -> f64 {
            let (counts, ratios) = (of.answers, ratios[of.place()]);
            let given = (0..3).filter(|&o| counts[o] > 0);
            given.map(|o| f64::from(counts[o]) * ratios[o]).sum()
        };
        answered.iter().map(given).sum()
    };
    let gains: Vec<(f64, f64)> =
        participants.of_kinds().map(|(answers, count)| (gain_of(answers), count as f64)).collect();
    let gain: f64 = gains.iter().map(|(gain, count)| gain * count).sum();
    let squares: f64 = gains.iter().map(|(own, count)| count * (own - gain / m).powi(2)).sum();
    let error = (m / (m - 1.0) * squares).sqrt();
    let t = StudentsT::new(0.0, 1.0, m - 1.0).expect("two participants or more");
    let p = (error > 1e-9).then(|| 2.0 * t.cdf(-(gain / error).abs()));
    gain.is_finite().then_some(Closeness { gain, p })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Model, Pairs, fit, golden};
    use isostudy_design::Arrangement;

    #[test]
    fn rao_kupper_fits_the_papers_clusterings_better() {
        let study = golden::study();
        // NumPy 2.4.6 and SciPy 1.17.1: d the participants' differences of log chances at both maxima (Rao-Kupper's by
        // scipy.optimize.minimize(method="BFGS", gtol=1e-10)): sum(d), 2 * t.sf(abs(sum(d)) / sqrt(18 * var(d, ddof=1)), 17).
        for (of, gain, p) in
            [(Some(Arrangement::BodyCentred), 2.695_803_5, 0.080_756_15), (None, 1.643_369_4, 0.279_541_32)]
        {
            let ballots = golden::clusterings(&study, of);
            let (pairs, participants) = (Pairs::of(3, &ballots), Participants::of(3, &ballots));
            let [rao_kupper, davidson] =
                [Model::RaoKupper, Model::Davidson].map(|model| fit(model, &pairs).unwrap());
            let found = closeness(&rao_kupper, &davidson, &participants).unwrap();
            assert!((found.gain - (rao_kupper.log_likelihood - davidson.log_likelihood)).abs() < 1e-9);
            assert!((found.gain - gain).abs() < 1e-6, "{found:?}");
            assert!((found.p.unwrap() - p).abs() < 1e-5, "{found:?}");
            let turned = closeness(&davidson, &rao_kupper, &participants).unwrap();
            assert!((turned.gain + found.gain).abs() < 1e-12);
            assert!((turned.p.unwrap() - found.p.unwrap()).abs() < 1e-12);
            let ties = fit(Model::BradleyTerry, &pairs).unwrap();
            assert_eq!(closeness(&ties, &davidson, &participants), None);
        }
    }

    #[test]
    fn saturated_models_are_equally_close() {
        let ballots = golden::clusterings(&golden::study(), None);
        let two: Vec<_> = ballots.into_iter().filter(|b| b.left() != 2 && b.right() != 2).collect();
        let (pairs, participants) = (Pairs::of(2, &two), Participants::of(2, &two));
        let [a, b] = [Model::RaoKupper, Model::Davidson].map(|model| fit(model, &pairs).unwrap());
        let found = closeness(&a, &b, &participants).unwrap();
        assert!(found.gain.abs() < 1e-9 && found.p.is_none(), "{found:?}");
    }
}
