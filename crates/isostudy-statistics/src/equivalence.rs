//! Is a difference small enough to call it none? "Not significant" does not say so.

use crate::interval::{chance_of_unanimity, unanimous};
use statrs::distribution::{ContinuousCDF, StudentsT};

/// The margin of a study that declares none, for mean scores, which run from -1 to 1: a mean within 0.2 of zero means that, of
/// a hundred answers, fewer than 60 go one way and more than 40 the other.
pub const MARGIN: f64 = 0.2;

/// Two one-sided tests (Schuirmann 1987, J. Pharmacokinet. Biopharm. 15:657).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Equivalence {
    /// The mean is asked to lie within plus and minus this.
    pub margin: f64,
    /// The larger p of the two: below 0.05 exactly if the 90 % t interval lies inside the margin. Where all scores are the
    /// same there is no t, and it is the greatest chance of that with a mean at the margin.
    pub p: f64,
}

/// Tests whether the mean of one score a participant, between -`reach` and `reach`, lies within `margin` of zero: t over
/// participants, m - 1 degrees of freedom. `None` for fewer than two participants.
pub fn equivalence(scores: &[f64], margin: f64, reach: f64) -> Option<Equivalence> {
    if scores.len() < 2 {
        return None;
    }
    let m = scores.len() as f64;
    let mean = scores.iter().sum::<f64>() / m;
    let variance = scores.iter().map(|s| (s - mean) * (s - mean)).sum::<f64>() / (m - 1.0);
    let room = margin - mean.abs();
    let p = match unanimous(scores) {
        Some(_) if room <= 0.0 => 1.0,
        Some(score) => chance_of_unanimity(score.abs(), scores.len(), margin, reach),
        None => StudentsT::new(0.0, 1.0, m - 1.0).expect("m - 1 > 0").sf(room / (variance / m).sqrt()),
    };
    Some(Equivalence { margin, p })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_scipy_has_it() {
        // SciPy 1.17.1, ttest_1samp: x = [.1, -.2, .3, 0, .1, -.1, .05]; the larger p of popmean -.2, alternative
        // "greater", and popmean .2, alternative "less".
        let scores = [0.1, -0.2, 0.3, 0.0, 0.1, -0.1, 0.05];
        let test = equivalence(&scores, MARGIN, 1.0).unwrap();
        assert!((test.p - 0.017_393_486_936_827_105).abs() < 1e-10, "{test:?}");
        let negative = scores.map(|s| -s);
        assert!((equivalence(&negative, MARGIN, 1.0).unwrap().p - test.p).abs() < 1e-12);
        // The 90 % interval touches the margin exactly where p is 0.05.
        assert!(equivalence(&scores, 0.1, 1.0).unwrap().p > 0.05);
        assert!(equivalence(&scores.map(|s| s + 1.0), MARGIN, 1.0).unwrap().p > 0.99);
    }

    #[test]
    fn without_spread() {
        // Nobody of m has a preference: 0.8^m, if one in five were all for one side.
        assert!((equivalence(&[0.0; 4], MARGIN, 1.0).unwrap().p - 0.8_f64.powi(4)).abs() < 1e-15);
        assert!((equivalence(&[-0.1; 30], MARGIN, 1.0).unwrap().p - (0.8_f64 / 0.9).powi(30)).abs() < 1e-12);
        assert_eq!(equivalence(&[0.5; 4], MARGIN, 1.0).unwrap().p, 1.0);
        assert_eq!(equivalence(&[0.5], MARGIN, 1.0), None);
    }
}
