//! Krippendorff's alpha over questions (units) and participants (raters).

/// What counts as disagreement between two of the values left < none < right.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Metric {
    /// Different is different.
    Nominal,
    /// By the number of answers that lie between, half of the ends' own: depends on the margins.
    Ordinal,
}

/// Krippendorff's alpha (2004, *Content Analysis*, chapter 11): 1 - observed / expected disagreement, from the counts
/// `[left, tie, right]` of each question. 1 in full agreement, 0 by chance, negative below.
///
/// Questions with fewer than two answers are left out, as the definition has it; different numbers of answers are fine.
/// `None` if nothing can be paired or if all answers are the same value, which leaves 0/0.
///
/// The value speaks of sides. If sides were swapped between participants, recode to configurations first.
pub fn alpha(questions: &[[u64; 3]], metric: Metric) -> Option<f64> {
    let units: Vec<[f64; 3]> = questions
        .iter()
        .filter(|unit| unit.iter().sum::<u64>() >= 2)
        .map(|unit| unit.map(|count| count as f64))
        .collect();
    let mut margins = [0.0; 3];
    units.iter().flat_map(|unit| unit.iter().enumerate()).for_each(|(v, count)| margins[v] += count);
    let n: f64 = margins.iter().sum();
    let difference = |a: usize, b: usize| match metric {
        Metric::Nominal => f64::from(a != b),
        Metric::Ordinal => {
            let between: f64 = margins[a.min(b)..=a.max(b)].iter().sum();
            (between - (margins[a] + margins[b]) / 2.0).powi(2)
        }
    };
    let (mut observed, mut expected) = (0.0, 0.0);
    for a in 0..3 {
        for b in (0..3).filter(|&b| b != a) {
            let pairs = |unit: &[f64; 3]| unit[a] * unit[b] / (unit.iter().sum::<f64>() - 1.0);
            observed += units.iter().map(pairs).sum::<f64>() * difference(a, b);
            expected += margins[a] * margins[b] * difference(a, b);
        }
    }
    (expected > 0.0).then(|| 1.0 - (n - 1.0) * observed / expected)
}

#[cfg(test)]
mod tests;
