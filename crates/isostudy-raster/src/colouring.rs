//! Numbers that colour a mesh, and the scale they are read on.

use crate::RasterError;
use isostudy_mesh::TriangleMesh;
use isostudy_mesh::quality::TriangleQuality;

/// A number for each triangle or for each vertex.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// As many as triangles; each has one colour.
    PerTriangle(Vec<f32>),
    /// As many as vertices; interpolated.
    PerVertex(Vec<f32>),
}

/// Which number has which colour of [`map_colour`](crate::map_colour), and what is written by the scale.
#[derive(Debug, Clone, PartialEq)]
pub struct Scale {
    /// What is shown, with its unit.
    pub title: String,
    /// The number at the dark end. It may be above or below [`bright`](Self::bright).
    pub dark: f32,
    /// The number at the bright end.
    pub bright: f32,
    /// Numbers that are marked, and what is written there.
    pub marks: Vec<(f32, String)>,
}

/// What colours a mesh instead of its material.
#[derive(Debug, Clone, PartialEq)]
pub struct Colouring {
    /// The numbers; infinite ones have the colour of an end.
    pub values: Values,
    /// How they are shown.
    pub scale: Scale,
}

impl Colouring {
    /// The radius ratio of each triangle (twice the inscribed over the circumscribed radius), dark for 0 (bad) and
    /// bright for 1 (equilateral). A triangle without a shape has 0.
    ///
    /// # Panics
    /// If an index is out of range.
    pub fn radius_ratio(mesh: &TriangleMesh) -> Colouring {
        let ratio = |t| TriangleQuality::of(mesh.corners(t)).shape.map_or(0.0, |s| s.radius_ratio as f32);
        let values = Values::PerTriangle((0..mesh.triangles.len()).map(ratio).collect());
        let marks = [(0.0, "0 (bad)"), (0.5, "0.5"), (1.0, "1 (good)")];
        let scale = Scale {
            title: "radius ratio of triangles".into(),
            dark: 0.0,
            bright: 1.0,
            marks: marks.map(|(at, text)| (at, text.to_owned())).to_vec(),
        };
        Colouring { values, scale }
    }

    /// Distances to the isosurface in spacings, bright for 0 (good) and dark for `most` (bad) and all beyond.
    pub fn distance(values: Values, most: f32) -> Colouring {
        let marks = vec![
            (0.0, "0 (good)".to_owned()),
            (0.5 * most, format!("{}", 0.5 * most)),
            (most, format!("{most} or more")),
        ];
        let title = "distance to the isosurface, in spacings".into();
        Colouring { values, scale: Scale { title, dark: most, bright: 0.0, marks } }
    }

    /// The places of the numbers on the scale, 0 (dark) to 1 (bright).
    pub(crate) fn places(&self, mesh: &TriangleMesh) -> Result<Values, RasterError> {
        let Scale { dark, bright, .. } = self.scale;
        if !(dark.is_finite() && bright.is_finite()) || dark == bright {
            let allowed = "finite, and not the one at the bright end";
            return Err(RasterError::Setting {
                setting: "number at the dark end",
                value: dark as f64,
                allowed,
            });
        }
        let placed = |values: &[f32], of, count| {
            if values.len() != count {
                return Err(RasterError::Values { values: values.len(), of, count });
            }
            match values.iter().position(|v| v.is_nan()) {
                Some(index) => Err(RasterError::NoNumber { of, index }),
                None => Ok(values.iter().map(|&v| self.scale.place(v)).collect()),
            }
        };
        match &self.values {
            Values::PerTriangle(v) => placed(v, "triangle", mesh.triangles.len()).map(Values::PerTriangle),
            Values::PerVertex(v) => placed(v, "vertex", mesh.positions.len()).map(Values::PerVertex),
        }
    }
}

impl Scale {
    /// Where `value` lies from the dark (0) to the bright end (1); what is beyond an end is at it.
    pub fn place(&self, value: f32) -> f32 {
        ((value - self.dark) / (self.bright - self.dark)).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_run_either_way_and_end() {
        let scale = |dark, bright| Scale { title: String::new(), dark, bright, marks: Vec::new() };
        assert_eq!(
            [-1.0, 0.0, 0.25, 1.0, f32::INFINITY].map(|v| scale(0.0, 1.0).place(v)),
            [0.0, 0.0, 0.25, 1.0, 1.0]
        );
        assert_eq!([-1.0, 0.0, 0.5, 2.0, 9.0].map(|v| scale(2.0, 0.0).place(v)), [1.0, 1.0, 0.75, 0.0, 0.0]);
        assert_eq!(scale(-1.0, 1.0).place(0.0), 0.5, "signed");
    }

    #[test]
    fn numbers_that_do_not_fit_are_refused() {
        let mesh = TriangleMesh {
            positions: vec![glam::Vec3::ZERO, glam::Vec3::X, glam::Vec3::Y],
            triangles: vec![[0, 1, 2]],
            ..TriangleMesh::default()
        };
        let error = |values| Colouring::distance(values, 0.1).places(&mesh).unwrap_err();
        let few = RasterError::Values { values: 2, of: "vertex", count: 3 };
        assert_eq!(error(Values::PerVertex(vec![0.0; 2])), few);
        assert_eq!(
            error(Values::PerTriangle(vec![f32::NAN])),
            RasterError::NoNumber { of: "triangle", index: 0 }
        );
        let without = Colouring::distance(Values::PerTriangle(vec![0.0]), 0.0).places(&mesh);
        assert!(matches!(without, Err(RasterError::Setting { .. })));
    }
}
