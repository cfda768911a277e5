//! What every triangle of a mesh is worth: ratios, angles and areas.

use glam::{DVec3, Vec3};

use crate::TriangleMesh;
use crate::distribution::{Bins, Distribution};

/// The measures of one triangle, computed in double precision from single-precision corners.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TriangleQuality {
    /// Area, in squared units of the coordinates; 0 for a degenerate triangle.
    pub area: f64,
    /// The shape, or `None` for a degenerate triangle: zero area, an edge of length zero, or corners that are
    /// not finite.
    pub shape: Option<TriangleShape>,
}

/// The scale-free measures of a triangle that has a shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TriangleShape {
    /// Longer over shorter of the *two* edges that meet at the first corner, at least 1. The third edge does not
    /// count, so the value depends on which corner comes first, and an isosceles sliver can score 1
    /// (Costen 2026; published as "aspect ratio").
    pub published_aspect_ratio: f64,
    /// Longest over shortest of the three edges, at least 1.
    pub edge_ratio: f64,
    /// Twice the inscribed over the circumscribed radius, in 0..=1; 1 for an equilateral triangle.
    pub radius_ratio: f64,
    /// Smallest angle, degrees, in 0..=60.
    pub min_angle_deg: f64,
    /// Largest angle, degrees, in 60..=180.
    pub max_angle_deg: f64,
}

/// The quality of all triangles of a mesh.
///
/// The five ratios and angles cover the triangles that have a shape, `triangles - degenerate` of them; the area
/// covers every triangle, a degenerate one with its 0. Nothing here is ever NaN or infinite.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct QualityReport {
    /// Triangles in the mesh.
    pub triangles: u64,
    /// Triangles of zero area, with a zero-length edge or with corners that are not finite.
    pub degenerate: u64,
    /// See [`TriangleShape::published_aspect_ratio`].
    pub published_aspect_ratio: Distribution,
    /// See [`TriangleShape::edge_ratio`].
    pub edge_ratio: Distribution,
    /// See [`TriangleShape::radius_ratio`].
    pub radius_ratio: Distribution,
    /// See [`TriangleShape::min_angle_deg`].
    pub min_angle_deg: Distribution,
    /// See [`TriangleShape::max_angle_deg`].
    pub max_angle_deg: Distribution,
    /// Areas; the histogram runs from 0 to the largest.
    pub area: Distribution,
    /// Length of the shortest edge of all triangles whose corners are finite; 0 if there are none.
    pub shortest_edge: f64,
}

/// Histogram ranges are the same for every mesh, so that two meshes can be laid over each other; only the area,
/// which has a unit, scales with its largest value.
const RATIO_BINS: Bins = Bins { low: 1.0, high: 4.0, count: 60 };
const RADIUS_RATIO_BINS: Bins = Bins { low: 0.0, high: 1.0, count: 50 };
const MIN_ANGLE_BINS: Bins = Bins { low: 0.0, high: 60.0, count: 60 };
const MAX_ANGLE_BINS: Bins = Bins { low: 60.0, high: 180.0, count: 60 };
const AREA_BINS: usize = 50;

/// Measures every triangle of `mesh`.
///
/// # Panics
/// If a triangle's index is out of range.
pub fn quality(mesh: &TriangleMesh) -> QualityReport {
    let measured: Vec<TriangleQuality> =
        (0..mesh.triangles.len()).map(|t| TriangleQuality::of(mesh.corners(t))).collect();
    let shapes: Vec<TriangleShape> = measured.iter().filter_map(|m| m.shape).collect();
    let over_shapes = |measure: fn(&TriangleShape) -> f64, bins| {
        Distribution::of(shapes.iter().map(measure).collect(), bins)
    };
    let areas: Vec<f64> = measured.iter().map(|m| m.area).collect();
    let largest = areas.iter().copied().fold(0.0, f64::max);
    QualityReport {
        triangles: measured.len() as u64,
        degenerate: (measured.len() - shapes.len()) as u64,
        published_aspect_ratio: over_shapes(|s| s.published_aspect_ratio, RATIO_BINS),
        edge_ratio: over_shapes(|s| s.edge_ratio, RATIO_BINS),
        radius_ratio: over_shapes(|s| s.radius_ratio, RADIUS_RATIO_BINS),
        min_angle_deg: over_shapes(|s| s.min_angle_deg, MIN_ANGLE_BINS),
        max_angle_deg: over_shapes(|s| s.max_angle_deg, MAX_ANGLE_BINS),
        area: Distribution::of(areas, Bins { low: 0.0, high: largest, count: AREA_BINS }),
        shortest_edge: shortest_edge(mesh),
    }
}

fn shortest_edge(mesh: &TriangleMesh) -> f64 {
    let corners = (0..mesh.triangles.len()).map(|t| mesh.corners(t));
    let finite = corners.filter(|corners| corners.iter().all(|p| p.is_finite()));
    let edges = finite.flat_map(|corners| {
        let [a, b, c] = corners.map(|p| p.as_dvec3());
        [a.distance(b), b.distance(c), c.distance(a)]
    });
    edges.reduce(f64::min).unwrap_or(0.0)
}

impl TriangleQuality {
    /// Measures one triangle. Only the published aspect ratio depends on the order of the corners.
    pub fn of(corners: [Vec3; 3]) -> Self {
        if !corners.iter().all(|p| p.is_finite()) {
            return Self { area: 0.0, shape: None };
        }
        let [a, b, c] = corners.map(|p| p.as_dvec3());
        // lengths[k] is the edge opposite corner k.
        let lengths = [b.distance(c), c.distance(a), a.distance(b)];
        let area = 0.5 * (b - a).cross(c - a).length();
        if area == 0.0 || lengths.contains(&0.0) {
            return Self { area: 0.0, shape: None };
        }
        let [opposite, ca, ab] = lengths;
        let (shortest, longest) = (opposite.min(ca).min(ab), opposite.max(ca).max(ab));
        let half_perimeter = 0.5 * (opposite + ca + ab);
        let inscribed = area / half_perimeter;
        // Grouped so that neither the product of the lengths nor that of the areas can leave the range.
        let circumscribed = opposite * (ca * ab / (4.0 * area));
        let angles = [angle_deg(a, b, c), angle_deg(b, c, a), angle_deg(c, a, b)];
        Self {
            area,
            shape: Some(TriangleShape {
                published_aspect_ratio: ab.max(ca) / ab.min(ca),
                edge_ratio: longest / shortest,
                radius_ratio: (2.0 * inscribed / circumscribed).min(1.0),
                min_angle_deg: angles.into_iter().fold(180.0, f64::min),
                max_angle_deg: angles.into_iter().fold(0.0, f64::max),
            }),
        }
    }
}

/// The angle at `apex`, by `atan2`, which keeps its accuracy near 0 and 180 degrees.
fn angle_deg(apex: DVec3, b: DVec3, c: DVec3) -> f64 {
    let (u, v) = (b - apex, c - apex);
    u.cross(v).length().atan2(u.dot(v)).to_degrees()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn shape(corners: [[f32; 3]; 3]) -> TriangleShape {
        TriangleQuality::of(corners.map(Vec3::from)).shape.expect("not degenerate")
    }

    fn near(got: f64, want: f64) {
        assert!((got - want).abs() < 1e-12 * want.max(1.0), "{got} is not {want}");
    }

    #[test]
    fn equilateral_is_the_ideal_of_every_measure() {
        // Corners of a cube's diagonal section: exactly equilateral in single precision, side sqrt 2.
        let corners = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let s = shape(corners);
        for got in [s.published_aspect_ratio, s.edge_ratio, s.radius_ratio] {
            near(got, 1.0);
        }
        near(s.min_angle_deg, 60.0);
        near(s.max_angle_deg, 60.0);
        near(TriangleQuality::of(corners.map(Vec3::from)).area, 3f64.sqrt() / 2.0);
    }

    #[test]
    fn three_four_five_by_hand() {
        // r_in = 1, R_circ = 5/2.
        let corners = [[0.0, 0.0, 7.0], [3.0, 0.0, 7.0], [0.0, 4.0, 7.0]];
        let s = shape(corners);
        near(s.published_aspect_ratio, 4.0 / 3.0);
        near(s.edge_ratio, 5.0 / 3.0);
        near(s.radius_ratio, 0.8);
        near(s.min_angle_deg, 0.75f64.atan().to_degrees());
        near(s.max_angle_deg, 90.0);
        near(TriangleQuality::of(corners.map(Vec3::from)).area, 6.0);
    }

    #[test]
    fn published_ratio_depends_on_the_first_corner() {
        let (a, b, c) = ([0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0]);
        near(shape([a, b, c]).published_aspect_ratio, 4.0 / 3.0);
        near(shape([b, c, a]).published_aspect_ratio, 5.0 / 3.0);
        near(shape([c, a, b]).published_aspect_ratio, 5.0 / 4.0);
        // An isosceles sliver scores 1 from its apex, and does not deserve it.
        let sliver = shape([[0.0, 0.0, 0.0], [1.0, 0.001, 0.0], [1.0, -0.001, 0.0]]);
        near(sliver.published_aspect_ratio, 1.0);
        assert!(sliver.edge_ratio > 499.0 && sliver.radius_ratio < 0.01 && sliver.min_angle_deg < 0.12);
    }

    #[test]
    fn degenerate_triangles_are_counted_apart() {
        let mesh = TriangleMesh {
            positions: [
                [0.0, 0.0, 0.0],
                [1.0, 0.0, 0.0],
                [2.0, 0.0, 0.0],
                [0.0, 1.0, 0.0],
                [0.0, f32::NAN, 0.0],
            ]
            .map(Vec3::from)
            .to_vec(),
            // sound, collinear, repeated index, not finite
            triangles: vec![[0, 1, 3], [0, 1, 2], [0, 0, 3], [0, 1, 4]],
            ..TriangleMesh::default()
        };
        let report = quality(&mesh);
        assert_eq!((report.triangles, report.degenerate), (4, 3));
        assert_eq!((report.edge_ratio.count, report.area.count), (1, 4));
        near(report.edge_ratio.max, 2f64.sqrt());
        near(report.area.mean, 0.125);
        near(report.shortest_edge, 0.0);
        assert_eq!(report.area.histogram.counts.iter().sum::<u64>(), 4);
        assert_eq!(
            quality(&TriangleMesh::default()),
            QualityReport {
                published_aspect_ratio: Distribution::of(vec![], RATIO_BINS),
                edge_ratio: Distribution::of(vec![], RATIO_BINS),
                radius_ratio: Distribution::of(vec![], RADIUS_RATIO_BINS),
                min_angle_deg: Distribution::of(vec![], MIN_ANGLE_BINS),
                max_angle_deg: Distribution::of(vec![], MAX_ANGLE_BINS),
                area: Distribution::of(vec![], Bins { low: 0.0, high: 0.0, count: AREA_BINS }),
                ..QualityReport::default()
            }
        );
    }

    #[test]
    fn the_shortest_edge_is_of_all_triangles() {
        let positions =
            [[0., 0., 0.], [3., 0., 0.], [0., 4., 0.], [0., 0., 0.25], [f32::NAN; 3]].map(Vec3::from);
        let mut mesh = TriangleMesh {
            positions: positions.to_vec(),
            triangles: vec![[0, 1, 2], [1, 2, 4]],
            ..TriangleMesh::default()
        };
        near(quality(&mesh).shortest_edge, 3.0);
        mesh.triangles.push([3, 1, 0]);
        near(quality(&mesh).shortest_edge, 0.25);
    }

    proptest! {
        /// Any bit pattern, subnormal and enormous numbers among them.
        #[test]
        fn every_measure_stays_finite_and_in_range(bits in prop::array::uniform9(any::<u32>())) {
            let f = bits.map(f32::from_bits);
            let corners = [[f[0], f[1], f[2]], [f[3], f[4], f[5]], [f[6], f[7], f[8]]].map(Vec3::from);
            let q = TriangleQuality::of(corners);
            prop_assert!(q.area.is_finite());
            if let Some(s) = q.shape {
                prop_assert!(s.published_aspect_ratio >= 1.0 && s.published_aspect_ratio <= s.edge_ratio);
                prop_assert!(s.edge_ratio.is_finite());
                prop_assert!((0.0..=1.0).contains(&s.radius_ratio));
                prop_assert!((0.0..=60.000_001).contains(&s.min_angle_deg));
                prop_assert!((59.999_999..=180.0).contains(&s.max_angle_deg));
            }
        }
    }
}
