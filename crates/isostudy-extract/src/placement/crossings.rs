//! Vertices of clusters from their crossings, when the plain mean of interpolated ones will not do.

use glam::{DVec3, Vec3};
use isostudy_mesh::Bounds;

use super::curvature::Planes;
use super::surroundings::Surroundings;
use crate::lattice::{DIRECTIONS, DirectionSet, Lattice, members};
use crate::sampling::bracket::Bracket;
use crate::sampling::level::Level;
use crate::settings::{ExtractSettings, Placement};

/// Calls of the field for one crossing, at most.
const MOST_CALLS: usize = 4;
/// A crossing is known to this share of its lattice edge.
const TOLERANCE: f64 = 1e-4;

/// Places the vertices of clusters.
#[derive(Clone, Copy)]
pub(crate) struct CrossingPlacer<'a> {
    /// To find roots with.
    level: Option<Level<'a>>,
    /// To weigh crossings with.
    planes: Option<&'static Planes>,
    edges: [DVec3; DIRECTIONS],
    bounds: Bounds,
    clamp: f32,
}

impl<'a> CrossingPlacer<'a> {
    /// `None` where the settings ask for the plain mean.
    pub(crate) fn new(
        lattice: &Lattice,
        settings: &ExtractSettings,
        level: Option<Level<'a>>,
    ) -> Option<Self> {
        let level = level.filter(|_| settings.refine_crossings);
        let planes =
            (settings.placement == Placement::CurvatureWeighted).then(|| Planes::get(lattice.arrangement()));
        if level.is_none() && planes.is_none() {
            return None;
        }
        let half = f64::from(lattice.spacing()) / 2.0;
        let offsets = &lattice.arrangement().directions().offsets;
        let edges = offsets.map(|offset| DVec3::from_array(offset.map(f64::from)) * half);
        Some(Self { level, planes, edges, bounds: lattice.bounds(), clamp: settings.edge_clamp })
    }

    /// Whether neighbours on the same side are looked at, or crossings alone.
    pub(crate) fn reads_neighbours(&self) -> bool {
        self.planes.is_some()
    }

    /// The mean of a cluster's crossings, weighted if the settings say so, clamped to the box.
    pub(crate) fn place(&self, around: &Surroundings, cluster: DirectionSet) -> Vec3 {
        let crossings = || members(cluster).map(|d| self.edge(around, d) * self.ratio(around, d));
        let mean = || crossings().sum::<DVec3>() / f64::from(cluster.count_ones());
        let offset = match self.planes.filter(|_| cluster.count_ones() > 1) {
            None => mean(),
            Some(planes) => {
                let weights = || members(cluster).map(|d| planes.weight(around, d));
                let total: f64 = weights().sum();
                let sum: DVec3 = crossings().zip(weights()).map(|(offset, weight)| offset * weight).sum();
                // Flat all round, or not known everywhere.
                if total.is_finite() && total > 0.0 { sum / total } else { mean() }
            }
        };
        let place = (around.position.as_dvec3() + offset).as_vec3();
        place.clamp(self.bounds.min, self.bounds.max)
    }

    /// How far along its edge a crossing is.
    fn ratio(&self, around: &Surroundings, direction: usize) -> f64 {
        let ends = [around.difference, around.neighbours[direction]];
        clamped(crossing_ratio(self.level, around.position, self.edge(around, direction), ends), self.clamp)
    }

    fn edge(&self, around: &Surroundings, direction: usize) -> DVec3 {
        around.ways.map_or(self.edges[direction], |ways| ways[direction].as_dvec3())
    }
}

/// The same, kept away from the ends as the settings want it.
pub(crate) fn clamped(ratio: f64, clamp: f32) -> f64 {
    let least = f64::from(clamp);
    if least > 0.0 { ratio.clamp(least, 1.0 - least) } else { ratio }
}

/// How far along its lattice edge a crossing is: by linear interpolation, and with a `level` then by regula falsi.
/// Strictly between the ends if it was there to begin with. `ends` are the differences from the isovalue.
pub(crate) fn crossing_ratio(level: Option<Level>, from: Vec3, edge: DVec3, ends: [f32; 2]) -> f64 {
    let ends = ends.map(f64::from);
    let linear = ends[0] / (ends[0] - ends[1]);
    if !linear.is_finite() {
        return 0.5;
    }
    let Some(level) = level.filter(|_| linear > 0.0 && linear < 1.0) else { return linear };
    let from = from.as_dvec3();
    let mut bracket = Bracket::new((0.0, ends[0]), (1.0, ends[1]));
    let mut ratio = linear;
    for _ in 0..MOST_CALLS {
        let there = f64::from(level.difference((from + edge * ratio).as_vec3()));
        if !there.is_finite() {
            return linear;
        }
        bracket.narrow(ratio, there);
        let before = std::mem::replace(&mut ratio, bracket.guess());
        if (ratio - before).abs() <= TOLERANCE {
            break;
        }
    }
    ratio
}
