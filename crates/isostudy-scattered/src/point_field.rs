//! The field of a scan: a spline through points, with its sides from their normals.

use std::collections::HashMap;

use glam::{DVec3, Vec3};
use isostudy_field::StudyField;
use isostudy_mesh::{Bounds, is_sound};
use thiserror::Error;

use crate::nearest_points::NearestPoints;
use crate::points::{Place, PointCloud};
use crate::polyharmonic::{FitError, FitReport, FitSettings, Polyharmonic};

/// A point beside the surface lies so many times as far from it as points from their neighbours, unless another distance is asked for.
const BESIDE: f64 = 2.0;
/// How often that distance is halved where another point is nearer, before nothing is put there.
const HALVINGS: u32 = 6;
/// How much nearer another point must be: neighbours on a bent surface are about as far.
const NEARER: f64 = 0.95;
/// Normals at one place that differ by less than this, at a length of 1, are one.
const SAME_NORMAL: f32 = 1e-3;

/// How a field is made of points.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PointSettings {
    /// The spline: its kernel, its smoothing, and how many of the points on and beside the surface are centres.
    pub fit: FitSettings,
    /// How far beside the surface values are given, in the unit of coordinates: twice the median distance between neighbours unless
    /// given.
    pub offset: Option<f64>,
}

/// Why there is no field of points. Places are those of the file.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum PointFieldError {
    /// There is no surface through so few points.
    #[error("{points} points at different places; at least 4 are needed")]
    Few {
        /// How many there are.
        points: usize,
    },
    /// Nothing says which side is inside.
    #[error("the points have no normals, so that neither side is inside")]
    NoNormals,
    /// A point cannot be computed with.
    #[error("{place}: the point is at {at}; coordinates must be numbers up to 1e18")]
    Coordinate {
        /// Where.
        place: Place,
        /// The point.
        at: Vec3,
    },
    /// A normal has no direction.
    #[error("{place}: the normal {normal} has no direction")]
    Normal {
        /// Where.
        place: Place,
        /// The normal.
        normal: Vec3,
    },
    /// Two points at one place face different ways.
    #[error("{first} and {second} are one point, at {at}, and their normals differ: {normals:?}")]
    TwoNormals {
        /// Where one stands.
        first: Place,
        /// Where the other does.
        second: Place,
        /// The point.
        at: Vec3,
        /// Both, of length 1.
        normals: [[f32; 3]; 2],
    },
    /// Points and normals lie in one plane.
    #[error("all points lie in one plane, and so do their normals")]
    Flat,
    /// A setting is out of its range.
    #[error("{0}")]
    Setting(FitError),
}

/// The field of points with normals: 0 at the points, positive inside, where no normal points. About as steep as a distance at the
/// surface; far away it is no distance.
///
/// Values are given at each point, 0, and beside it along the normal on both sides, the distance. Where another point is nearer
/// to such a place, the distance is halved, up to six times, and then the place is left out: so no value crosses another sheet.
/// A [`Polyharmonic`] goes through all of them, or through those chosen.
///
/// Points at one place with one normal count once. Points in one plane give that plane.
///
/// Source: Carr et al. (2001), section 3; the sides as in Turk & O'Brien (1999).
#[derive(Debug, Clone)]
pub struct PointField {
    spline: Polyharmonic,
    bounds: Bounds,
    offset: f64,
    repeated: usize,
    report: FitReport,
    at_points: FitReport,
}

impl PointField {
    /// Fits the spline: see [`Polyharmonic::fit`] for its cost.
    ///
    /// # Errors
    /// [`PointFieldError`], with the place in the file.
    pub fn try_new(cloud: &PointCloud, settings: &PointSettings) -> Result<Self, PointFieldError> {
        let Scan { points, normals, repeated } = Scan::of(cloud)?;
        let offset = check_offset(settings.offset)?.unwrap_or_else(|| BESIDE * usual_distance(&points));
        let (mut places, mut values) = (points.clone(), vec![0.0; points.len()]);
        let nearest = NearestPoints::new(&points);
        for (i, (&p, &normal)) in points.iter().zip(&normals).enumerate() {
            for side in [-1.0, 1.0] {
                if let Some(distance) = clear_distance(&nearest, i, p, side * normal, offset) {
                    places.push(p + side * distance * normal);
                    values.push(-side * distance);
                }
            }
        }
        let (spline, report) =
            Polyharmonic::fit(&places, &values, &settings.fit).map_err(|error| match error {
                FitError::Few { points } => PointFieldError::Few { points },
                FitError::Flat => PointFieldError::Flat,
                other => PointFieldError::Setting(other),
            })?;
        let errors = points.iter().map(|&p| spline.value(p).abs());
        let (largest, squares) =
            errors.fold((0.0, 0.0), |(largest, squares): (f64, f64), e| (largest.max(e), squares + e * e));
        let root_mean_square = (squares / points.len() as f64).sqrt();
        let at_points = FitReport { points: points.len(), largest, root_mean_square, ..report };
        let bounds = bounds_of(&points);
        Ok(Self { spline, bounds, offset, repeated, report, at_points })
    }

    /// Checks all that can be wrong with points before a spline is fitted.
    ///
    /// # Errors
    /// The same, but for [`PointFieldError::Flat`].
    pub fn check(cloud: &PointCloud, settings: &PointSettings) -> Result<(), PointFieldError> {
        check_offset(settings.offset)?;
        Scan::of(cloud).map(drop)
    }

    /// The smallest box that holds every point.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// How far beside the surface values were given, where no other point is near.
    pub fn offset(&self) -> f64 {
        self.offset
    }

    /// Points that were left out, because one was there already with the same normal.
    pub fn repeated(&self) -> usize {
        self.repeated
    }

    /// How good the fit is over all places with a value, on the surface and beside it.
    pub fn report(&self) -> FitReport {
        self.report
    }

    /// How good it is at the points alone: there, the error is about the distance to the surface.
    pub fn report_at_points(&self) -> FitReport {
        self.at_points
    }
}

impl StudyField for PointField {
    /// `NaN`, which counts as outside, where `p` is beyond the limit for coordinates or no point at all.
    fn sample(&self, p: Vec3) -> f32 {
        if is_sound(p) { self.spline.value(p.as_dvec3()) as f32 } else { f32::NAN }
    }

    fn sample_row(&self, x: &[f32], y: f32, z: f32, values: &mut [f32]) {
        if !x.iter().all(|&x| is_sound(Vec3::new(x, y, z))) {
            values.iter_mut().zip(x).for_each(|(value, &x)| *value = self.sample(Vec3::new(x, y, z)));
            return;
        }
        let x: Vec<f64> = x.iter().map(|&x| f64::from(x)).collect();
        let mut row = vec![0.0; x.len()];
        self.spline.row(&x, f64::from(y), f64::from(z), &mut row);
        values.iter_mut().zip(row).for_each(|(value, sum)| *value = sum as f32);
    }

    fn gradient(&self, p: Vec3) -> Option<Vec3> {
        let gradient = is_sound(p).then(|| self.spline.gradient(p.as_dvec3()).as_vec3());
        gradient.filter(|gradient| gradient.is_finite() && *gradient != Vec3::ZERO)
    }
}

/// The points of a file, each place once, with normals of length 1.
struct Scan {
    points: Vec<DVec3>,
    normals: Vec<DVec3>,
    repeated: usize,
}

impl Scan {
    fn of(cloud: &PointCloud) -> Result<Self, PointFieldError> {
        if let Some(i) = cloud.positions.iter().position(|&p| !is_sound(p)) {
            return Err(PointFieldError::Coordinate { place: cloud.place(i), at: cloud.positions[i] });
        }
        if cloud.normals.len() != cloud.positions.len() || cloud.positions.is_empty() {
            return Err(match cloud.positions.len() {
                points @ 0..4 => PointFieldError::Few { points },
                _ => PointFieldError::NoNormals,
            });
        }
        let mut scan = Self { points: Vec::new(), normals: Vec::new(), repeated: 0 };
        let mut first_at: HashMap<[u32; 3], usize> = HashMap::new();
        for (i, (&p, &written)) in cloud.positions.iter().zip(&cloud.normals).enumerate() {
            let place = cloud.place(i);
            let normal = written.as_dvec3().try_normalize();
            let normal = normal.ok_or(PointFieldError::Normal { place, normal: written })?;
            // Zero has two signs.
            let bits = (p + 0.0).to_array().map(f32::to_bits);
            let Some(&first) = first_at.get(&bits) else {
                first_at.insert(bits, i);
                scan.points.push(p.as_dvec3());
                scan.normals.push(normal);
                continue;
            };
            let earlier = cloud.normals[first].as_dvec3().normalize();
            if (earlier - normal).length() > f64::from(SAME_NORMAL) {
                let normals = [earlier, normal].map(|normal| normal.as_vec3().to_array());
                return Err(PointFieldError::TwoNormals {
                    first: cloud.place(first),
                    second: place,
                    at: p,
                    normals,
                });
            }
            scan.repeated += 1;
        }
        match scan.points.len() {
            points @ 0..4 => Err(PointFieldError::Few { points }),
            _ => Ok(scan),
        }
    }
}

fn check_offset(offset: Option<f64>) -> Result<Option<f64>, PointFieldError> {
    match offset {
        Some(value) if !(value > 0.0 && value.is_finite()) => {
            let (name, allowed) = ("offset", "above 0 and finite");
            Err(PointFieldError::Setting(FitError::Setting { name, allowed, value }))
        }
        other => Ok(other),
    }
}

/// The median distance to the nearest other point.
fn usual_distance(points: &[DVec3]) -> f64 {
    let nearest = NearestPoints::new(points);
    let mut squared: Vec<f64> = points.iter().map(|&p| nearest.nearest(p, 2)[1].0).collect();
    squared.sort_unstable_by(f64::total_cmp);
    squared[squared.len() / 2].sqrt()
}

/// How far from the point `i` one can go along a direction so that no other point is clearly nearer.
fn clear_distance(
    nearest: &NearestPoints<'_>,
    i: usize,
    p: DVec3,
    direction: DVec3,
    offset: f64,
) -> Option<f64> {
    let mut distances = (0..=HALVINGS).map(|times| offset / f64::from(1 << times));
    distances.find(|&distance| {
        let (squared, found) = nearest.nearest(p + distance * direction, 1)[0];
        found as usize == i || squared.sqrt() >= NEARER * distance
    })
}

fn bounds_of(points: &[DVec3]) -> Bounds {
    let ends = points.iter().map(|p| p.as_vec3());
    let (min, max) =
        ends.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
    Bounds { min, max }
}
