//! Value axes: where a value falls, and which values are marked.

use super::canvas::text_width;
use isostudy_table::digits::MINUS;

/// Steps that an axis is cut into, at most; a last one begun counts as a whole.
const MOST_STEPS: f64 = 7.0;

/// A value axis that runs upwards.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Axis {
    pub(super) low: f64,
    pub(super) high: f64,
    pub(super) ticks: Vec<f64>,
    logarithmic: bool,
}

impl Axis {
    /// From 0 to the first tick at or above `largest`, marked at steps of 1, 2 or 5 times a power of ten.
    pub(super) fn from_zero(largest: f64) -> Self {
        let largest = if largest > 0.0 && largest.is_finite() { largest } else { 1.0 };
        let power = 10_f64.powf((largest / MOST_STEPS).log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|s| s * power).into_iter().find(|s| largest / s <= MOST_STEPS);
        let step = step.unwrap_or(10.0 * power);
        let count = (largest / step - 1e-9).ceil() as u32;
        let ticks: Vec<f64> = (0..=count).map(|i| f64::from(i) * step).collect();
        Self { low: 0.0, high: f64::from(count) * step, ticks, logarithmic: false }
    }

    /// Round steps that cover `low` to `high`.
    pub(super) fn spanning(low: f64, high: f64) -> Self {
        let axis = Self::from_zero(high - low);
        let step = axis.ticks.get(1).copied().unwrap_or(1.0);
        let (first, last) = ((low / step + 1e-9).floor() as i64, (high / step - 1e-9).ceil() as i64);
        let ticks: Vec<f64> = (first..=last.max(first + 1)).map(|i| i as f64 * step).collect();
        Self { low: ticks[0], high: ticks[ticks.len() - 1], ticks, logarithmic: false }
    }

    /// From `low` to `high`, marked at the round steps between.
    pub(super) fn within(low: f64, high: f64) -> Self {
        let mut axis = Self::spanning(low, high);
        axis.ticks.retain(|tick| (low..=high).contains(tick));
        Self { low, high, ..axis }
    }

    /// From 0 to exactly `high`.
    pub(super) fn up_to(high: f64) -> Self {
        let mut axis = Self::from_zero(high);
        axis.ticks.retain(|tick| *tick <= high * (1.0 + 1e-9));
        axis.high = high;
        axis
    }

    /// Shares from 0 to 1, with room for a mark beyond either end.
    pub(super) fn around_shares() -> Self {
        Self { low: -0.04, high: 1.04, ..Self::up_to(1.0) }
    }

    /// Logarithmic, from 1 to `largest` or a little more, marked at 1, 1.5, 2, 3, 5, 7 and their tenfolds; over more than
    /// two decades at the tenfolds alone.
    pub(super) fn logarithmic(largest: f64) -> Self {
        let marks: &[f64] = if largest > 100.0 { &[1.0] } else { &[1.0, 1.5, 2.0, 3.0, 5.0, 7.0] };
        let mut ticks = vec![];
        let mut decade = 1.0;
        while decade <= 1e6 && ticks.last().is_none_or(|&last| last < largest) {
            for tick in marks.iter().map(|t| t * decade) {
                if ticks.last().is_none_or(|&last| last < largest) {
                    ticks.push(tick);
                }
            }
            decade *= 10.0;
        }
        let high = *ticks.last().expect("at least 1 is marked");
        Self { low: 1.0, high, ticks, logarithmic: true }
    }

    /// Logarithmic, from the tenfold below `low` to the one above `high`; over 30 times or less, from and to 1, 2 or 5 times a
    /// tenfold. There is room for a mark at either end.
    pub(super) fn decades(low: f64, high: f64) -> Self {
        const ROOM: f64 = 1.06;
        let low = if low > 0.0 && low.is_finite() { low } else { 1.0 };
        let high = if high.is_finite() { high.max(low) } else { low };
        let (first, last) = ((low / ROOM).log10().floor() as i32, (high * ROOM).log10().ceil() as i32);
        let steps: &[f64] = if high / low > 30.0 { &[1.0] } else { &[1.0, 2.0, 5.0] };
        let all =
            (first..=last.max(first + 1)).flat_map(|power| steps.iter().map(move |s| s * 10_f64.powi(power)));
        let all: Vec<f64> = all.collect();
        let begin = all.iter().rposition(|tick| *tick <= low / ROOM).unwrap_or(0);
        let end = all.iter().position(|tick| *tick >= high * ROOM).unwrap_or(all.len() - 1).max(begin + 1);
        let ticks = all[begin..=end].to_vec();
        Self { low: ticks[0], high: ticks[ticks.len() - 1], ticks, logarithmic: true }
    }

    /// Whole numbers, a little room on both sides; every one marked while they are few.
    pub(super) fn whole(low: u32, high: u32) -> Self {
        let step = (high - low).div_ceil(8).max(1) as usize;
        let ticks = (low..=high).step_by(step).map(f64::from).collect();
        let room = 0.1 * f64::from((high - low).max(1));
        Self { low: f64::from(low) - room, high: f64::from(high) + room, ticks, logarithmic: false }
    }

    /// Values between the marks of a logarithmic axis, tenths of the first decade and as many of the others; none of a linear one.
    pub(super) fn minor(&self) -> Vec<f64> {
        if !self.logarithmic {
            return Vec::new();
        }
        let mut ticks = Vec::new();
        let mut decade = 10_f64.powf(self.low.log10().floor());
        while decade < self.high {
            ticks.extend((10..100).map(|tenth| decade * f64::from(tenth) / 10.0));
            decade *= 10.0;
        }
        ticks.retain(|tick| (self.low..=self.high).contains(tick));
        if ticks.len() > 45 {
            // Whole steps alone.
            ticks.retain(|tick| {
                let digit = tick / 10_f64.powf(tick.log10().floor());
                (digit - digit.round()).abs() < 1e-6
            });
        }
        ticks
    }

    /// Where a value falls between the axis's bottom and top; cut to both.
    pub(super) fn place(&self, value: f64, bottom: f64, top: f64) -> f64 {
        let value = value.clamp(self.low, self.high);
        let share = if self.logarithmic {
            (value / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        };
        bottom + share * (top - bottom)
    }

    /// The labels of an axis that runs from `left` to `right`, each with where its middle is: every one, or every second, third and
    /// so on, such that none touches the next.
    pub(super) fn labels_between(&self, left: f64, right: f64, em: f64) -> Vec<(f64, String)> {
        let all: Vec<(f64, String)> = self
            .ticks
            .iter()
            .zip(self.labels())
            .map(|(&tick, text)| (self.place(tick, left, right), text))
            .collect();
        let half = |text: &str| text_width(text, em) / 2.0;
        let fits = |step: &usize| {
            let kept: Vec<&(f64, String)> = all.iter().step_by(*step).collect();
            kept.windows(2).all(|two| two[0].0 + half(&two[0].1) + 0.6 * em <= two[1].0 - half(&two[1].1))
        };
        let step = (1..=all.len().max(1)).find(fits).unwrap_or(1);
        all.into_iter().step_by(step).collect()
    }

    /// The marks' labels: just the decimals they need, thousands set apart.
    pub(super) fn labels(&self) -> Vec<String> {
        let needs = |&tick: &f64| (0..6).find(|&d| round(tick, d) == round(tick, 9)).unwrap_or(6);
        if self.logarithmic {
            let short = |t: &f64| match *t {
                t if t >= 1e6 => format!("{} M", number(t / 1e6, 0)),
                t => number(t, needs(&t)),
            };
            return self.ticks.iter().map(short).collect();
        }
        let decimals = self.ticks.iter().map(needs).max().unwrap_or(0);
        self.ticks.iter().map(|&tick| number(tick, decimals)).collect()
    }
}

fn round(value: f64, decimals: usize) -> f64 {
    let unit = 10_f64.powi(decimals as i32);
    (value * unit).round() / unit
}

/// A number with so many decimals and a true minus sign, thousands set apart by commas.
pub(super) fn number(value: f64, decimals: usize) -> String {
    let text = isostudy_table::digits::number(value, decimals);
    let (whole, rest) =
        text.split_once('.').map_or((text.as_str(), String::new()), |(w, r)| (w, format!(".{r}")));
    let digits = whole.trim_start_matches(MINUS);
    let mut out = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i) % 3 == 0 {
            out.push(',');
        }
        out.push(digit);
    }
    let sign = &whole[..whole.len() - digits.len()];
    format!("{sign}{out}{rest}")
}

/// A value in about three digits, for a label over a bar.
pub(super) fn short(value: f64) -> String {
    let decimals = if value >= 100.0 {
        0
    } else if value >= 10.0 {
        1
    } else {
        2
    };
    number(value, decimals)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_cover() {
        let axis = Axis::from_zero(101_720.0);
        assert_eq!(axis.labels(), ["0", "20,000", "40,000", "60,000", "80,000", "100,000", "120,000"]);
        assert_eq!(Axis::from_zero(0.87).labels(), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(Axis::from_zero(0.0).high, 1.0);
        assert_eq!(Axis::up_to(10.0).ticks, [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]);
        assert_eq!(Axis::logarithmic(4.0).labels(), ["1", "1.5", "2", "3", "5"]);
        assert_eq!(Axis::logarithmic(2000.0).labels(), ["1", "10", "100", "1,000", "10,000"]);
        assert_eq!(Axis::spanning(-0.42, 1.02).labels(), ["\u{2212}0.5", "0.0", "0.5", "1.0", "1.5"]);
        assert_eq!(Axis::spanning(0.0, 0.0).ticks.len(), 2);
        assert_eq!(Axis::decades(0.03, 450.0).labels(), ["0.01", "0.1", "1", "10", "100", "1,000"]);
        assert_eq!(Axis::decades(0.7, 4.1).labels(), ["0.5", "1", "2", "5"]);
        assert_eq!(Axis::decades(2e5, 3e7).labels(), ["100,000", "1 M", "10 M", "100 M"]);
        assert_eq!(Axis::decades(1.0, 1.0).labels(), ["0.5", "1", "2"], "room for a mark at either end");
        assert_eq!(Axis::decades(1.1, 4.9).labels(), ["1", "2", "5", "10"]);
        let decades = Axis::decades(0.01, 100.0);
        assert!((decades.place(1.0, 100.0, 0.0) - 50.0).abs() < 1e-9);
        assert_eq!(Axis::whole(1, 4).labels(), ["1", "2", "3", "4"]);
    }

    #[test]
    fn no_label_touches_the_next() {
        let texts = |axis: &Axis, width: f64| {
            axis.labels_between(0.0, width, 11.0).into_iter().map(|(_, text)| text).collect::<Vec<_>>()
        };
        let triangles = Axis::from_zero(101_720.0);
        assert_eq!(texts(&triangles, 500.0).len(), 7);
        // A third of a page.
        assert_eq!(texts(&triangles, 227.0), ["0", "40,000", "80,000", "120,000"]);
        assert_eq!(texts(&triangles, 20.0), ["0"]);
        let places = triangles.labels_between(0.0, 227.0, 11.0);
        for two in places.windows(2) {
            let [(a, left), (b, right)] = two else { unreachable!() };
            assert!(a + text_width(left, 11.0) / 2.0 < b - text_width(right, 11.0) / 2.0);
        }
    }

    #[test]
    fn an_axis_ends_where_it_is_told_to() {
        let axis = Axis::within(-1.04, 1.1);
        assert_eq!((axis.low, axis.high), (-1.04, 1.1));
        assert_eq!(axis.labels(), ["\u{2212}1.0", "\u{2212}0.5", "0.0", "0.5", "1.0"]);
    }

    #[test]
    fn values_beyond_the_axis_stop_at_its_ends() {
        let axis = Axis::up_to(10.0);
        assert_eq!(axis.place(5.0, 100.0, 0.0), 50.0);
        assert_eq!(axis.place(775.0, 100.0, 0.0), 0.0);
        assert_eq!(Axis::logarithmic(9.0).place(0.0, 100.0, 0.0), 100.0);
        assert_eq!((short(775.93), short(24.65), short(1.304)), ("776".into(), "24.6".into(), "1.30".into()));
    }
}
