//! Numbers in words: p values, intervals, counts, lists.

use isostudy_statistics::interval::Interval;
pub use isostudy_table::digits::{counted, number};
use std::collections::BTreeSet;

/// Below this a p value is not printed in digits; the tables have them.
const LEAST_P: f64 = 1e-3;

/// `p = 0.0094`: two digits that count, no more; `p < 0.001` below that.
pub fn p(p: f64) -> String {
    match p {
        p if p < LEAST_P => "p < 0.001".into(),
        p if p > 0.995 => "p = 1".into(),
        p => {
            let decimals = (1.0 - p.log10().floor()).clamp(2.0, 7.0) as usize;
            format!("p = {p:.decimals$}")
        }
    }
}

/// `0.06 to 0.29`.
pub fn interval(interval: Interval, decimals: usize) -> String {
    format!("{} to {}", number(interval.low, decimals), number(interval.high, decimals))
}

/// `+12.07 %`.
pub fn change(percent: f64) -> String {
    let text = number(percent, 2);
    if text.starts_with('\u{2212}') { format!("{text} %") } else { format!("+{text} %") }
}

/// `1 person`, `26 people`.
pub fn people(number: usize) -> String {
    if number == 1 { "1 person".into() } else { format!("{number} people") }
}

/// `0 of 1 contrast holds`, `1 of 3 contrasts holds`, `2 of 3 contrasts hold`: of so many things, how many do it.
pub fn of_all(some: usize, all: usize, noun: &str, [one, more]: [&str; 2]) -> String {
    let verb = if some == 1 || all == 1 { one } else { more };
    format!("{some} of {} {verb}", counted(all, noun))
}

/// `26,144`.
pub fn whole(count: u64) -> String {
    let digits = count.to_string();
    let groups: Vec<&str> =
        digits.as_bytes().rchunks(3).rev().map(|g| std::str::from_utf8(g).expect("digits")).collect();
    groups.join(",")
}

/// `73 %`.
pub fn percent(share: f64) -> String {
    format!("{} %", number(100.0 * share, 0))
}

/// `66 to 81 %`, cut to what is possible.
pub fn percents(interval: Interval) -> String {
    let end = |x: f64| number(100.0 * x.clamp(0.0, 1.0), 0);
    format!("{} to {} %", end(interval.low), end(interval.high))
}

/// `a, b and c`.
pub fn list<T: AsRef<str>>(items: &[T]) -> String {
    match items {
        [] => String::new(),
        [only] => only.as_ref().into(),
        [rest @ .., last] => {
            let rest: Vec<&str> = rest.iter().map(AsRef::as_ref).collect();
            format!("{} and {}", rest.join(", "), last.as_ref())
        }
    }
}

/// With its first letter upper case.
pub fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

/// `36 answers against 10, 8 without preference`.
pub fn against([first, ties, second]: [u64; 3]) -> String {
    let ties = if ties == 0 { "none".into() } else { ties.to_string() };
    let answers = if first == 1 { "answer" } else { "answers" };
    format!("{first} {answers} against {second}, {ties} without preference")
}

/// Numbers from 1, the first ten of them.
pub fn numbers(people: &BTreeSet<usize>, between: &str) -> String {
    const MOST: usize = 10;
    let first: Vec<String> = people.iter().take(MOST).map(|p| (p + 1).to_string()).collect();
    let more = people.len().saturating_sub(MOST);
    if more > 0 { format!("{} and {more} more", first.join(between)) } else { first.join(between) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        let ps = [0.8243, 0.0094, 0.000_33, 4.58e-5, 1e-9, 1.0, 0.0501, 0.049].map(p);
        let want = [
            "p = 0.82",
            "p = 0.0094",
            "p < 0.001",
            "p < 0.001",
            "p < 0.001",
            "p = 1",
            "p = 0.050",
            "p = 0.049",
        ];
        assert_eq!(ps, want);
        assert_eq!(list(&["a", "b", "c"]), "a, b and c");
        assert_eq!((list::<&str>(&[]), list(&["a"])), (String::new(), "a".into()));
        assert_eq!(against([1, 0, 5]), "1 answer against 5, none without preference");
        assert_eq!(percents(Interval { low: 0.661, high: 1.2 }), "66 to 100 %");
        assert_eq!(capital("über"), "Über");
        let hold = |some, all| of_all(some, all, "contrast", ["holds", "hold"]);
        assert_eq!(
            [(0, 1), (1, 1), (0, 3), (1, 3), (2, 3)].map(|(some, all)| hold(some, all)),
            [
                "0 of 1 contrast holds",
                "1 of 1 contrast holds",
                "0 of 3 contrasts hold",
                "1 of 3 contrasts holds",
                "2 of 3 contrasts hold"
            ]
        );
        assert_eq!(
            (change(12.066), change(-1.96), change(-0.001)),
            ("+12.07 %".into(), "\u{2212}1.96 %".into(), "+0.00 %".into())
        );
        assert_eq!([0, 999, 1000, 1_026_144].map(whole), ["0", "999", "1,000", "1,026,144"]);
    }
}
