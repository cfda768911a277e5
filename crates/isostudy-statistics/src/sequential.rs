//! Tests of answers that are looked at while people are still asked.
//!
//! Whoever tests at 5 % at each of several looks, and stops at the first that rejects, rejects a true hypothesis more often than in 5 %.
//! Group-sequential boundaries keep to the level over all looks (Pocock 1977, Biometrika 64:191; O'Brien and Fleming 1979,
//! Biometrics 35:549; Armitage, McPherson and Rowe 1969, J. R. Stat. Soc. A 132:235).

use statrs::distribution::{Continuous, ContinuousCDF, Normal};

/// What |z| must reach at a look, but for a constant factor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Boundary {
    /// As 1 / sqrt(information): hard to cross early, and the last look is nearly a test without looks.
    OBrienFleming,
    /// The same at each look.
    Pocock,
}

/// The looks that were planned, and which of them has been reached.
#[derive(Debug, Clone, PartialEq)]
pub struct Look {
    boundary: Boundary,
    /// Information at each look as a share of that at the last: ascending, above 0; the last is 1.
    information: Vec<f64>,
    /// The look that has been reached, from 0.
    reached: usize,
}

/// Densities beyond this many standard deviations are taken as 0: 1e-27 is left out.
const FARTHEST: f64 = 11.0;

impl Look {
    /// Looks at so many people, ascending, of whom so many have answered. The first look stands for fewer than it needs.
    ///
    /// # Panics
    /// Without a look, and if numbers of people are 0 or do not ascend.
    pub fn of(boundary: Boundary, people: &[u32], answered: usize) -> Self {
        let ascends = people.windows(2).all(|pair| pair[0] < pair[1]);
        assert!(people.first().is_some_and(|&first| first > 0) && ascends, "{people:?}");
        let most = f64::from(people[people.len() - 1]);
        let reached = people.iter().rposition(|&needed| needed as usize <= answered).unwrap_or(0);
        let information = people.iter().map(|&needed| f64::from(needed) / most).collect();
        Self { boundary, information, reached }
    }

    /// The look that has been reached, from 1.
    pub fn number(&self) -> usize {
        self.reached + 1
    }

    /// How many looks were planned.
    pub fn planned(&self) -> usize {
        self.information.len()
    }

    /// The repeated p value: the smallest level at which this look would have stopped the study, given p of a two-sided test of all
    /// answers so far (Jennison and Turnbull 1984, Biometrika 71:1; 2000, chapter 9). Whatever the look at which a study stops, it is
    /// at most alpha with a chance of at most alpha where the hypothesis is true and z is normal. It is never below `p`.
    pub fn repeated_p(&self, p: f64) -> f64 {
        if p >= 1.0 {
            return 1.0;
        }
        let z = -Normal::standard().inverse_cdf(p / 2.0);
        let factor = match self.boundary {
            Boundary::OBrienFleming => z * self.information[self.reached].sqrt(),
            Boundary::Pocock => z,
        };
        self.crossing(factor).max(p)
    }

    /// The level of a test at this look alone that keeps all looks to `level`: repeated p is at most `level` exactly if p is at
    /// most this.
    pub fn nominal(&self, level: f64) -> f64 {
        // Repeated p grows with p. Each step halves the room in logarithms.
        let (mut low, mut high) = (level.ln() - 40.0, level.ln());
        for _ in 0..60 {
            let middle = f64::midpoint(low, high);
            if self.repeated_p(middle.exp()) <= level {
                low = middle;
            } else {
                high = middle;
            }
        }
        low.exp()
    }

    /// What |z| must reach at a look.
    fn bound(&self, factor: f64, look: usize) -> f64 {
        match self.boundary {
            Boundary::OBrienFleming => factor / self.information[look].sqrt(),
            Boundary::Pocock => factor,
        }
    }

    /// The chance that |z| reaches its bound at any look, where z is the standardised sum of independent normal steps.
    fn crossing(&self, factor: f64) -> f64 {
        let normal = Normal::standard();
        let two_sided = |look: usize| 2.0 * normal.sf(self.bound(factor, look));
        let mut crossed = two_sided(0);
        // The density of the sum where no look has stopped, on Simpson's grid between the bounds.
        let mut before: Option<Grid> = None;
        for look in 1..self.information.len() {
            let (earlier, now) = (self.information[look - 1], self.information[look]);
            let (deviation, end) = ((now - earlier).sqrt(), self.bound(factor, look) * now.sqrt());
            let inner = before.take().unwrap_or_else(|| {
                let spread = earlier.sqrt();
                Grid::of(self.bound(factor, 0) * spread, spread, deviation, |x| {
                    normal.pdf(x / spread) / spread
                })
            });
            crossed +=
                inner.integral(|x| normal.sf((end - x) / deviation) + normal.sf((end + x) / deviation));
            // The next step decides how fine the grid has to be; after the last look nothing is folded.
            let Some(&next) = self.information.get(look + 1) else { break };
            let finest = deviation.min((next - now).sqrt());
            before = Some(Grid::of(end, now.sqrt(), finest, |y| {
                inner.integral(|x| normal.pdf((y - x) / deviation) / deviation)
            }));
        }
        // The sum of all looks' own chances bounds it from above, the largest of them from below.
        let own: Vec<f64> = (0..self.information.len()).map(two_sided).collect();
        let (least, most) = (own.iter().copied().fold(0.0, f64::max), own.iter().sum::<f64>());
        crossed.clamp(least, most.min(1.0))
    }
}

/// A density at evenly spaced points.
struct Grid {
    points: Vec<(f64, f64)>,
    step: f64,
}

/// Steps of a grid for each standard deviation of what it is folded with. Simpson's error is then below 1e-9.
const STEPS: f64 = 8.0;

impl Grid {
    fn of(end: f64, spread: f64, deviation: f64, density: impl Fn(f64) -> f64) -> Self {
        let end = end.min(FARTHEST * spread);
        // An even number of steps, so an odd one of points.
        let half = ((end * STEPS / deviation.min(spread)).ceil() as usize).max(8);
        let step = end / half as f64;
        let points = (0..=2 * half).map(|i| i as f64 * step - end).map(|x| (x, density(x))).collect();
        Self { points, step }
    }

    /// Simpson's rule.
    fn integral(&self, of: impl Fn(f64) -> f64) -> f64 {
        let last = self.points.len() - 1;
        let weight = |i: usize| match i {
            0 => 1.0,
            i if i == last => 1.0,
            i if i % 2 == 1 => 4.0,
            _ => 2.0,
        };
        let sum: f64 =
            self.points.iter().enumerate().map(|(i, &(x, density))| weight(i) * density * of(x)).sum();
        sum * self.step / 3.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulation::stream;
    use rand::RngExt;

    fn even(boundary: Boundary, looks: u32, reached: usize) -> Look {
        let people: Vec<u32> = (1..=looks).map(|look| 10 * look).collect();
        Look::of(boundary, &people, 10 * reached)
    }

    fn near(ours: f64, theirs: f64, within: f64) {
        assert!((ours - theirs).abs() <= within, "{ours} {theirs}");
    }

    /// Jennison and Turnbull (2000), tables 2.1 and 2.3: constants at two-sided 5 % and evenly spaced looks.
    #[test]
    fn published_constants_cross_in_five_per_cent() {
        for (looks, pocock, obrien_fleming) in
            [(2, 2.178, 1.977), (3, 2.289, 2.004), (4, 2.361, 2.024), (5, 2.413, 2.040), (10, 2.555, 2.087)]
        {
            // The constants have three digits.
            near(even(Boundary::Pocock, looks, 1).crossing(pocock), 0.05, 2e-4);
            near(even(Boundary::OBrienFleming, looks, 1).crossing(obrien_fleming), 0.05, 2e-4);
        }
    }

    #[test]
    fn one_look_changes_nothing() {
        for p in [1e-300, 1e-20, 0.003, 0.05, 0.7, 1.0] {
            let repeated = Look::of(Boundary::Pocock, &[24], 24).repeated_p(p);
            assert!((repeated / p - 1.0).abs() < 1e-9, "{repeated} {p}");
        }
    }

    #[test]
    fn the_nominal_level_is_where_repeated_p_is_the_level() {
        for boundary in [Boundary::Pocock, Boundary::OBrienFleming] {
            for reached in 1..=4 {
                let look = even(boundary, 4, reached);
                let nominal = look.nominal(0.05);
                near(look.repeated_p(nominal), 0.05, 1e-9);
            }
        }
        // Pocock's is the same at each look; 2.361 standard deviations of four.
        near(even(Boundary::Pocock, 4, 2).nominal(0.05), 0.0182, 1e-4);
        // 2.024 * sqrt(4 / k).
        for (reached, nominal) in [(1, 0.000_052), (2, 0.0042), (3, 0.0194), (4, 0.0430)] {
            near(even(Boundary::OBrienFleming, 4, reached).nominal(0.05), nominal, 1e-4);
        }
    }

    #[test]
    fn looks_that_need_more_people_are_not_reached() {
        let at = |answered| Look::of(Boundary::Pocock, &[10, 20, 40], answered).number();
        assert_eq!([0, 9, 10, 19, 20, 39, 40, 90].map(at), [1, 1, 1, 1, 2, 2, 3, 3]);
    }

    /// `1 - multivariate_normal(cov=...).cdf(c, lower_limit=-c)` of SciPy 1.x, with `sqrt(n_i / n_j)` as correlations.
    #[test]
    fn repeated_p_is_scipys() {
        let at = |boundary, people: &[u32], answered, p| Look::of(boundary, people, answered).repeated_p(p);
        near(at(Boundary::Pocock, &[8, 12], 8, 2.0 / 256.0), 0.012_911_48, 1e-6);
        near(at(Boundary::OBrienFleming, &[8, 12], 8, 2.0 / 256.0), 0.032_563_31, 1e-6);
        near(at(Boundary::OBrienFleming, &[12, 20, 45, 60], 20, 0.01), 0.164_188_9, 2e-5);
        near(at(Boundary::Pocock, &[12, 20, 45, 60], 45, 0.01), 0.029_697_0, 2e-5);
    }

    /// Repeated p grows with p, is never below it, and never above the sum of the looks' own chances.
    #[test]
    fn repeated_p_is_in_order() {
        for boundary in [Boundary::Pocock, Boundary::OBrienFleming] {
            for reached in 1..=3 {
                let look = Look::of(boundary, &[7, 30, 31], [7, 30, 31][reached - 1]);
                let mut before = 0.0;
                for exponent in (0..60).rev() {
                    let p = 10.0_f64.powf(-f64::from(exponent) / 3.0);
                    let repeated = look.repeated_p(p);
                    assert!(
                        repeated >= p && repeated >= before && repeated <= 1.0,
                        "{p} {repeated} {before}"
                    );
                    before = repeated;
                }
            }
        }
    }

    /// Walks without a drift, looked at unevenly: whoever stops at the first look with a repeated p of 5 % or less does so in 5 %, and
    /// in much more with p itself.
    #[test]
    fn stopping_keeps_to_the_level() {
        let people = [12, 20, 45, 60];
        let normal = Normal::standard();
        for boundary in [Boundary::Pocock, Boundary::OBrienFleming] {
            let nominal: Vec<f64> =
                people.iter().map(|&n| Look::of(boundary, &people, n as usize).nominal(0.05)).collect();
            let walks = 40_000;
            let (mut stopped, mut naive) = (0, 0);
            let mut random = stream(20_261_127, 0);
            for _ in 0..walks {
                let (mut sum, mut done, mut early, mut late) = (0.0, 0, false, false);
                for (&n, &level) in people.iter().zip(&nominal) {
                    let step = f64::from(n - done).sqrt();
                    sum += step * normal.inverse_cdf(random.random::<f64>());
                    done = n;
                    let p = 2.0 * normal.sf(f64::abs(sum) / f64::from(n).sqrt());
                    early |= p <= level;
                    late |= p <= 0.05;
                }
                stopped += i32::from(early);
                naive += i32::from(late);
            }
            // Four standard errors.
            near(f64::from(stopped) / f64::from(walks), 0.05, 0.0044);
            assert!(f64::from(naive) / f64::from(walks) > 0.1, "{naive}");
        }
    }
}
