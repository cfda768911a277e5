//! What a published number is worth beside ours.

/// How a published number compares with ours.
#[derive(Debug, Clone, PartialEq)]
pub enum Verdict {
    /// Equal in every printed digit.
    Equal,
    /// Within a stated relative or absolute tolerance, and why not equal.
    WithinTolerance {
        /// The tolerance as shown, such as `0.001` or `3 %`.
        tolerance: String,
        /// Why the numbers are not equal.
        reason: String,
    },
    /// Neither, and why; an unexplained difference says so.
    Differs {
        /// Why.
        reason: String,
    },
    /// Not the same quantity, or not measured under the same conditions.
    NotComparable {
        /// Why.
        reason: String,
    },
}

/// The reason of a difference that no rule explains.
pub(crate) const UNEXPLAINED: &str = "not explained";

impl Verdict {
    pub(crate) fn within(tolerance: impl Into<String>, reason: impl Into<String>) -> Self {
        Self::WithinTolerance { tolerance: tolerance.into(), reason: reason.into() }
    }

    pub(crate) fn differs(reason: impl Into<String>) -> Self {
        Self::Differs { reason: reason.into() }
    }

    pub(crate) fn not_comparable(reason: impl Into<String>) -> Self {
        Self::NotComparable { reason: reason.into() }
    }

    /// The verdict without its reason: `equal`, `within 3 %`, `differs` or `not comparable`.
    pub fn label(&self) -> String {
        match self {
            Self::Equal => "equal".into(),
            Self::WithinTolerance { tolerance, .. } => format!("within {tolerance}"),
            Self::Differs { .. } => "differs".into(),
            Self::NotComparable { .. } => "not comparable".into(),
        }
    }

    /// Whether the numbers differ and no rule says why.
    pub fn is_unexplained(&self) -> bool {
        matches!(self, Self::Differs { reason } if reason.starts_with(UNEXPLAINED))
    }

    /// The reason; empty for equal numbers.
    pub fn reason(&self) -> &str {
        match self {
            Self::Equal => "",
            Self::WithinTolerance { reason, .. }
            | Self::Differs { reason }
            | Self::NotComparable { reason } => reason,
        }
    }
}

/// Whether two numbers print alike with `decimals` decimals.
pub(crate) fn prints_alike(a: f64, b: f64, decimals: usize) -> bool {
    // Half a unit and a hair: a printed number has gone through a double.
    (a - b).abs() <= 0.5001 * 10_f64.powi(-(decimals as i32))
        || format!("{a:.decimals$}") == format!("{b:.decimals$}")
}

/// `|ours - published| / |published|`; infinite if only the published number is zero.
pub(crate) fn relative_difference(published: f64, ours: f64) -> f64 {
    if published == ours { 0.0 } else { (ours - published).abs() / published.abs() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn printed_digits_decide() {
        assert!(prints_alike(0.794_384_92, 0.794_384_918_8, 8));
        assert!(prints_alike(0.000124, 0.000_123_6, 6));
        assert!(!prints_alike(0.419, 0.419_75, 3));
        assert!(!prints_alike(5.809_247, 5.806_945, 6));
        assert_eq!(relative_difference(0.0, 0.0), 0.0);
        assert_eq!(relative_difference(0.0, 1.0), f64::INFINITY);
    }
}
