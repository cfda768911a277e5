//! A root between two points: regula falsi with the Illinois rule (Dowell & Jarratt 1971).

/// Two points of a line, and a function's values there, of different signs.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bracket {
    /// Place and value, the latter lightened by the Illinois rule.
    low: (f64, f64),
    high: (f64, f64),
    /// Whether the root was last found above or below the guess.
    last: Option<bool>,
}

impl Bracket {
    /// `low.0 < high.0`, and exactly one of the values is above zero.
    pub(crate) fn new(low: (f64, f64), high: (f64, f64)) -> Self {
        Self { low, high, last: None }
    }

    /// Where a straight line has its root: an end whose value is zero, or else the middle where that is not strictly
    /// between.
    pub(crate) fn guess(&self) -> f64 {
        let (low, high) = (self.low, self.high);
        if low.1 == 0.0 || high.1 == 0.0 {
            return if low.1 == 0.0 { low.0 } else { high.0 };
        }
        let guess = low.0 + (high.0 - low.0) * (low.1 / (low.1 - high.1));
        if guess > low.0 && guess < high.0 { guess } else { 0.5 * (low.0 + high.0) }
    }

    /// Cuts off what lies on one side of `place`, where the value is `value`, a number.
    pub(crate) fn narrow(&mut self, place: f64, value: f64) {
        let above = (value > 0.0) == (self.low.1 > 0.0);
        let again = self.last.replace(above) == Some(above);
        let (near, far) =
            if above { (&mut self.low, &mut self.high) } else { (&mut self.high, &mut self.low) };
        *near = (place, value);
        // The same end twice in a row is too heavy.
        if again {
            far.1 *= 0.5;
        }
    }

    pub(crate) fn width(&self) -> f64 {
        self.high.0 - self.low.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn converges_in_few_steps_from_either_side() {
        let root = 0.3f64;
        for sign in [1.0, -1.0] {
            let f = |x: f64| sign * (x.powi(3) - root.powi(3));
            let mut bracket = Bracket::new((0.0, f(0.0)), (1.0, f(1.0)));
            for _ in 0..12 {
                let guess = bracket.guess();
                bracket.narrow(guess, f(guess));
            }
            assert!((bracket.guess() - root).abs() < 1e-9, "{}", bracket.guess());
        }
    }

    #[test]
    fn a_root_that_is_hit_stays() {
        for sign in [1.0, -1.0] {
            let f = |x: f64| sign * (x - 0.25);
            let mut bracket = Bracket::new((0.0, f(0.0)), (1.0, f(1.0)));
            for _ in 0..3 {
                assert_eq!(bracket.guess(), 0.25);
                bracket.narrow(0.25, 0.0);
            }
        }
    }

    #[test]
    fn infinite_values_are_halved_away() {
        let f = |x: f64| if x < 0.25 { f64::NEG_INFINITY } else { f64::INFINITY };
        let mut bracket = Bracket::new((0.0, f(0.0)), (1.0, f(1.0)));
        for _ in 0..30 {
            let guess = bracket.guess();
            bracket.narrow(guess, f(guess));
        }
        assert!(bracket.width() < 1e-8 && (bracket.guess() - 0.25).abs() < 1e-8);
    }
}
