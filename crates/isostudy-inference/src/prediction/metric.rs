//! Measures of a mesh that might please people.

use crate::mesh_set::known;
use isostudy_design::record::MeshRecord;

/// How two values are set against each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Their difference.
    Difference,
    /// The natural logarithm of their ratio, for what is positive and varies by factors.
    LogRatio,
}

/// A measure, and which way is better.
#[derive(Debug)]
pub struct Metric {
    /// Name in CSV.
    pub code: &'static str,
    /// Name for people.
    pub label: &'static str,
    /// The better value in words: `higher`, `lower`, `fewer`.
    pub better: &'static str,
    larger_is_better: bool,
    /// How two values are compared.
    pub scale: Scale,
    /// The value; `None` if the mesh has none.
    pub value: fn(&MeshRecord) -> Option<f64>,
}

/// Every metric, of the object's region if it has one. Means over triangles, vertices or area, as their records say.
pub const METRICS: &[Metric] = &[
    Metric {
        code: "radius_ratio",
        label: "mean radius ratio",
        better: "higher",
        larger_is_better: true,
        scale: Scale::Difference,
        value: |m| known(&m.judged().quality.radius_ratio, |d| d.mean),
    },
    Metric {
        code: "min_angle",
        label: "mean smallest angle",
        better: "higher",
        larger_is_better: true,
        scale: Scale::Difference,
        value: |m| known(&m.judged().quality.min_angle_deg, |d| d.mean),
    },
    Metric {
        code: "published_aspect_ratio",
        label: "published aspect ratio",
        better: "lower",
        larger_is_better: false,
        scale: Scale::LogRatio,
        value: |m| known(&m.judged().quality.published_aspect_ratio, |d| d.mean),
    },
    Metric {
        code: "triangles",
        label: "triangle count",
        better: "fewer",
        larger_is_better: false,
        scale: Scale::LogRatio,
        value: |m| Some(m.judged().triangles as f64),
    },
    Metric {
        code: "normal_error",
        label: "mean shading error",
        better: "lower",
        larger_is_better: false,
        scale: Scale::LogRatio,
        value: |m| known(&m.judged().accuracy.normal_error_deg, |d| d.mean),
    },
    Metric {
        code: "distance",
        label: "mean distance to the surface",
        better: "lower",
        larger_is_better: false,
        scale: Scale::LogRatio,
        value: |m| known(&m.judged().accuracy.distance, |d| d.mean),
    },
];

impl Metric {
    /// By how much the first value is the better one: negative if it is the worse. `None` if a logarithm does not exist.
    pub fn advantage(&self, first: f64, second: f64) -> Option<f64> {
        let difference = match self.scale {
            Scale::Difference => first - second,
            Scale::LogRatio => (first / second).ln(),
        };
        let towards = if self.larger_is_better { difference } else { -difference };
        towards.is_finite().then_some(towards)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn better_is_positive() {
        let by = |code: &str, a, b| METRICS.iter().find(|m| m.code == code).unwrap().advantage(a, b);
        assert_eq!(by("radius_ratio", 0.75, 0.5), Some(0.25));
        assert_eq!(by("triangles", 100.0, 200.0), Some(2.0_f64.ln()));
        assert_eq!(by("published_aspect_ratio", 3.0, 1.5), Some(-2.0_f64.ln()));
        assert_eq!(by("triangles", 0.0, 5.0), None);
        assert_eq!(by("triangles", 0.0, 0.0), None);
    }
}
