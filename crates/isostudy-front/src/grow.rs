//! The driver: border, seeds, steps, repairs, and what is checked at the end.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::DVec3;
use isostudy_field::StudyField;
use isostudy_mesh::{Bounds, TriangleMesh};

use crate::error::FrontError;
use crate::patch::Patch;
use crate::probe::{Foot, Miss, Probe};
use crate::samples::Samples;
use crate::settings::{Counts, Front, Seeds, Sizing};
use crate::sizes::{Guide, Sizes};
use crate::step::{ACUTE, Growth, Step, faces};
use crate::{border, holes};

/// How often the length is halved at one place.
const HALVINGS: i32 = 4;
/// How many places are repaired between two beginnings.
const REPAIRS: u64 = 60;
/// How many rounds of repairs may go by without fewer faulty places than ever before.
const MOST_ROUNDS: u32 = 6;
/// The most triangles per cube of an edge's length.
const MOST_IN_CELL: f64 = 40.0;
/// How often all is begun again with a finer border.
const RESTARTS: u64 = 3;
/// A loop that extends farther, in edges, is repaired piece by piece.
const MOST_EXTENT: f64 = 4.0;
/// A triangle is tried if normals of its corners have a smaller cosine.
const BENT: f64 = 0.75;
/// Between samples on the box's faces, in edges.
const BORDER_STEP: f64 = 0.5;
/// Directions in which a first triangle is tried.
const TURNS: u32 = 6;

/// A mesh, and what was done for it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Grown {
    /// With normals: the field's own at each vertex, outward. Without triangles if no surface was found.
    pub mesh: TriangleMesh,
    /// What was done.
    pub counts: Counts,
}

/// Grows triangles over the isosurface in a box. The mesh is open where the surface leaves the box, with vertices on the box's faces.
///
/// Inside is above the isovalue, and `NaN` is outside. Works on one thread.
///
/// # Errors
/// [`FrontError`], with the place. There is no mesh that is not closed or no manifold.
pub fn grow(
    field: &dyn StudyField,
    bounds: Bounds,
    isovalue: f32,
    settings: &Front,
) -> Result<Grown, FrontError> {
    settings.check(bounds, isovalue)?;
    let probe = Probe::new(field, isovalue, settings.edge);
    let cells = match (&settings.seeds, settings.sizing) {
        (Seeds::Sampled { cells }, _) => Some(*cells),
        (Seeds::Points(_), Sizing::Curvature { .. }) => Some(Seeds::CELLS),
        (Seeds::Points(_), Sizing::Constant) => None,
    };
    let samples = cells.map(|cells| Samples::of(&probe, bounds, cells));
    let guide = match (settings.sizing, &samples) {
        (Sizing::Curvature { smallest, angle }, Some(samples)) => {
            Some(Guide::of(samples, &probe, bounds, settings.edge, smallest, angle))
        }
        _ => None,
    };
    let smallest = match settings.sizing {
        Sizing::Curvature { smallest, .. } => smallest,
        Sizing::Constant => settings.edge,
    };
    let sizes = Sizes::new(settings.edge, guide);
    let least = smallest * 0.5_f64.powi(HALVINGS);
    // No surface whose sheets are an edge apart has more.
    let cells = (bounds.size().as_dvec3() / settings.edge + 1.0).element_product();
    let most = MOST_IN_CELL * cells * (settings.edge / smallest).powi(2);
    let most_triangles = settings.most_triangles.min(most as usize);
    let patch = Patch::new(bounds, settings.edge);
    let counts = Counts::default();
    let mut grower = Grower {
        probe: &probe,
        samples,
        settings,
        bounds,
        sizes,
        least,
        most_triangles,
        patch,
        tried: 0,
        border: 0,
        waiting: Waiting::default(),
        counts,
    };
    while !grower.attempt()? {
        grower.counts.restarts += 1;
        grower.patch = Patch::new(bounds, settings.edge);
        grower.waiting = Waiting::default();
        grower.tried = 0;
    }
    Ok(grower.grown())
}

struct Grower<'a> {
    probe: &'a Probe<'a>,
    samples: Option<Samples>,
    settings: &'a Front,
    bounds: Bounds,
    sizes: Sizes,
    least: f64,
    most_triangles: usize,
    patch: Patch,
    /// So many triangles, the first, were tried by [`astray`](Self::astray).
    tried: usize,
    /// So many vertices, the first, lie on the border.
    border: usize,
    waiting: Waiting,
    counts: Counts,
}

/// Edges of the front, those with an acute angle first, then the oldest.
#[derive(Default)]
struct Waiting {
    edges: BinaryHeap<Reverse<(bool, u64, u32, u32)>>,
    pushed: u64,
}

/// An edge that nothing fits, and why.
struct Stuck {
    edge: [u32; 2],
    blame: Option<Miss>,
}

impl Grower<'_> {
    /// Grows all. Whether it is done; if not, the border must be finer.
    fn attempt(&mut self) -> Result<bool, FrontError> {
        let step =
            self.sizes.at(0.5 * (self.bounds.min + self.bounds.max).as_dvec3()).max(self.settings.edge);
        let step = BORDER_STEP * step * 0.5_f64.powi(self.counts.restarts as i32);
        let loops =
            border::loops(self.probe, self.bounds, &self.sizes, step).map_err(|miss| self.missed(miss))?;
        self.counts.border_loops = loops.len() as u64;
        for curve in loops {
            let vertices: Vec<u32> = curve.into_iter().map(|foot| self.patch.add_vertex(foot)).collect();
            for (i, &v) in vertices.iter().enumerate() {
                self.patch.add_border(v, vertices[(i + 1) % vertices.len()]);
            }
        }
        self.border = self.patch.places.len();
        self.counts.seeds = 0;
        let mut is_done = self.close()?;
        match &self.settings.seeds {
            Seeds::Points(points) => {
                for &point in points {
                    is_done = is_done && self.grow_from_point(point.as_dvec3())?;
                }
            }
            Seeds::Sampled { .. } => {
                let crossings: Vec<_> = self.samples.iter().flat_map(Samples::crossings).collect();
                for of in crossings {
                    let outward = (of.outside - of.inside).normalize_or_zero();
                    if !is_done || self.is_covered(Foot { place: of.place, normal: outward }, 0.2) {
                        continue;
                    }
                    let foot = self.probe.between(of.inside, of.outside).map_err(|miss| self.missed(miss))?;
                    if !self.is_covered(foot, 0.3) {
                        is_done = self.grow_from(foot)?;
                    }
                }
            }
        }
        Ok(is_done)
    }

    fn grow_from_point(&mut self, place: DVec3) -> Result<bool, FrontError> {
        let reach = self.bounds.size().as_dvec3().length();
        let foot = match self.probe.project(place, reach) {
            Ok(foot) => foot,
            Err(Miss::Far) => {
                return Err(FrontError::Seed {
                    place,
                    reason: "Newton's method reaches no surface from there",
                });
            }
            Err(miss) => return Err(self.missed(miss)),
        };
        let (min, max) = (self.bounds.min.as_dvec3(), self.bounds.max.as_dvec3());
        if foot.place != foot.place.clamp(min, max) {
            return Err(FrontError::Seed { place, reason: "Newton's method leaves the box from there" });
        }
        if self.is_covered(foot, 0.3) { Ok(true) } else { self.grow_from(foot) }
    }

    /// Whether the mesh has a vertex of the same sheet near a point.
    fn is_covered(&self, foot: Foot, least: f64) -> bool {
        let radius = 1.2 * self.sizes.at(foot.place);
        let mut is_covered = false;
        self.patch.near.each(foot.place, radius, |v| {
            let of = self.patch.foot(v);
            let way = of.place - foot.place;
            is_covered |= way.length() < radius
                && of.normal.dot(foot.normal) > least
                && way.dot(of.normal).abs() < 0.6 * way.length() + 0.1 * radius;
        });
        is_covered
    }

    /// A first triangle round a seed, and all that grows from it.
    fn grow_from(&mut self, seed: Foot) -> Result<bool, FrontError> {
        let mut edge = self.sizes.at(seed.place);
        let corners = loop {
            match self.first_triangle(seed, edge) {
                Ok(corners) => break corners,
                Err(_) if 0.5 * edge >= self.least => edge = self.sizes.halve(seed.place, 0.0),
                // The surface touches the border there, and has nothing inside of the box.
                Err(_) if self.to_border(seed.place) < 1e-2 * self.least => return Ok(true),
                Err(Some(miss)) => return Err(self.missed(miss)),
                Err(None) => {
                    let reason = "no triangle fits round it; the part may be smaller than the shortest edge";
                    return Err(FrontError::Seed { place: seed.place, reason });
                }
            }
        };
        self.counts.seeds += 1;
        let corners = corners.map(|foot| self.patch.add_vertex(foot));
        self.patch.add_triangle(corners);
        self.wait_round(corners);
        self.close()
    }

    /// A triangle with a corner at the seed. If there is none, what the field has to do with it.
    fn first_triangle(&self, seed: Foot, edge: f64) -> Result<[Foot; 3], Option<Miss>> {
        let u = seed.normal.any_orthonormal_vector();
        let v = seed.normal.cross(u);
        let (min, max) = (self.bounds.min.as_dvec3(), self.bounds.max.as_dvec3());
        let mut blame = None;
        for turn in 0..TURNS {
            let corner = |sixths: u32| {
                let angle = f64::from(turn + sixths) * std::f64::consts::TAU / f64::from(TURNS);
                self.probe.project(seed.place + edge * (u * angle.cos() + v * angle.sin()), 0.5 * edge)
            };
            let (second, third) = match (corner(0), corner(1)) {
                (Ok(second), Ok(third)) => (second, third),
                (Err(miss), _) | (_, Err(miss)) => {
                    blame = blame.or(Some(miss).filter(|miss| *miss != Miss::Far));
                    continue;
                }
            };
            let fits = |foot: Foot| {
                foot.place == foot.place.clamp(min, max)
                    && !self.is_covered(foot, 0.3)
                    && foot.normal.dot(seed.normal) > 0.5
            };
            if fits(second) && fits(third) && faces([seed, second, third], 0.5) {
                return Ok([seed, second, third]);
            }
        }
        Err(blame)
    }

    /// Grows until no edge of the front is left, with repairs where edges are stuck. Whether it is done; if not, the border must be finer.
    fn close(&mut self) -> Result<bool, FrontError> {
        for [a, b] in self.patch.front() {
            self.wait(a, b);
        }
        let (mut fewest, mut rounds) = (usize::MAX, 0);
        loop {
            let stuck = self.advance()?;
            self.counts.closing_triangles += holes::close(&mut self.patch, |_| false);
            let mut places = self.faulty();
            if places.is_empty() {
                places = self.astray();
            }
            if places.is_empty() {
                return Ok(true);
            }
            // Repairs that only move the fault elsewhere end.
            (fewest, rounds) = if places.len() < fewest { (places.len(), 0) } else { (fewest, rounds + 1) };
            let may_repair = rounds < MOST_ROUNDS;
            let mut is_repaired = false;
            for &(centre, extent) in places.iter().filter(|_| may_repair) {
                let size = self.sizes.at(centre);
                if 0.5 * size < self.least || self.counts.repairs >= REPAIRS * (self.counts.restarts + 1) {
                    continue;
                }
                let is_at_border = self.is_at_border(centre, size);
                self.sizes.halve(centre, extent);
                self.counts.repairs += 1;
                if is_at_border && self.counts.restarts < RESTARTS {
                    return Ok(false);
                }
                self.patch.remove_round(centre, extent + 1.5 * size);
                is_repaired = true;
            }
            if !is_repaired {
                let was_closed = self.patch.front().is_empty() && self.patch.pinched().is_none();
                self.counts.closing_triangles += holes::close(&mut self.patch, |_| true);
                return match (self.faulty().first(), places.first()) {
                    (Some(&(place, _)), _) => Err(self.failure(place, self.sizes.at(place), &stuck)),
                    (None, Some(&(place, _))) if was_closed => Err(FrontError::Astray { place }),
                    _ => Ok(true),
                };
            }
            for [a, b] in self.patch.front() {
                self.wait(a, b);
            }
        }
    }

    /// Where the front is still open, and where sheets meet in a vertex: places, and how far they extend.
    fn faulty(&self) -> Vec<(DVec3, f64)> {
        let of_loop = |corners: Vec<u32>| {
            let places = corners.iter().map(|&v| self.patch.place(v));
            let centre = places.clone().sum::<DVec3>() / corners.len() as f64;
            let extent = places.map(|p| p.distance(centre)).fold(0.0, f64::max);
            let edge = self.sizes.at(centre);
            if extent < MOST_EXTENT * edge { (centre, extent) } else { (self.patch.place(corners[0]), edge) }
        };
        let mut places: Vec<_> = holes::loops(&self.patch).into_iter().map(of_loop).collect();
        if places.is_empty() {
            places.extend(self.patch.front().first().map(|of| (self.patch.place(of[0]), self.settings.edge)));
            places.extend(self.patch.pinched().map(|v| (self.patch.place(v), 0.0)));
        }
        places
    }

    /// Triangles since the last call that lie off the surface, as those do that cut off a neck or bridge a gap: their middles, and how
    /// far they extend. Those whose corners' normals agree are not tried.
    fn astray(&mut self) -> Vec<(DVec3, f64)> {
        let (new, after) = self.patch.since(self.tried);
        self.tried = after;
        let is_bent = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| self.patch.normal(v));
            a.dot(b).min(b.dot(c)).min(c.dot(a)) < BENT
        };
        let mut places = Vec::new();
        for t in new.into_iter().filter(is_bent) {
            let corners = t.map(|v| self.patch.foot(v));
            let [a, b, c] = corners.map(|corner| corner.place);
            let (middle, normal) = ((a + b + c) / 3.0, (b - a).cross(c - a).normalize_or_zero());
            let extent = a.distance(middle).max(b.distance(middle)).max(c.distance(middle));
            let is_sliver = (b - a).cross(c - a).length() < 0.2 * extent * extent;
            let foot = self.probe.project(middle, 0.65 * extent);
            if !is_sliver && !foot.is_ok_and(|foot| foot.normal.dot(normal) > 0.35) {
                places.push((middle, extent));
            }
        }
        places
    }

    /// Whether a vertex of the border is near, or the border itself very near, where a curve may have been missed.
    fn is_at_border(&self, p: DVec3, size: f64) -> bool {
        let mut is_at = self.to_border(p) < 0.1 * size;
        self.patch.near.each(p, 2.0 * size, |v| {
            is_at |= (v as usize) < self.border && self.patch.place(v).distance(p) < 2.0 * size;
        });
        is_at
    }

    fn to_border(&self, p: DVec3) -> f64 {
        let (min, max) = (self.bounds.min.as_dvec3(), self.bounds.max.as_dvec3());
        (p - min).min(max - p).min_element()
    }

    /// Steps until no edge waits. Those that nothing fits are left.
    fn advance(&mut self) -> Result<Vec<Stuck>, FrontError> {
        let mut stuck: Vec<Stuck> = Vec::new();
        while let Some(Reverse((_, _, a, b))) = self.waiting.edges.pop() {
            if !self.patch.is_front(a, b) {
                continue;
            }
            if self.patch.triangle_count() >= self.most_triangles {
                let place = 0.5 * (self.patch.place(a) + self.patch.place(b));
                return Err(FrontError::TooMany { limit: self.most_triangles, place });
            }
            let c = match self.step().grow(a, b) {
                Growth::Point(foot) => self.patch.add_vertex(foot),
                Growth::Vertex(c) => c,
                Growth::Nothing(blame) => {
                    stuck.push(Stuck { edge: [a, b], blame });
                    continue;
                }
            };
            self.patch.add_triangle([a, b, c]);
            self.wait_round([a, b, c]);
        }
        Ok(stuck)
    }

    fn step(&self) -> Step<'_> {
        Step { probe: self.probe, patch: &self.patch, sizes: &self.sizes, bounds: self.bounds }
    }

    /// Lets the front's edges at three corners wait, whose angles may have changed.
    fn wait_round(&mut self, corners: [u32; 3]) {
        for v in corners {
            for i in 0..self.patch.out[v as usize].len() {
                self.wait(v, self.patch.out[v as usize][i]);
            }
            for i in 0..self.patch.into[v as usize].len() {
                self.wait(self.patch.into[v as usize][i], v);
            }
        }
    }

    fn wait(&mut self, a: u32, b: u32) {
        let (at_a, at_b) = self.step().free_angles(a, b);
        self.waiting.pushed += 1;
        self.waiting.edges.push(Reverse((at_a.min(at_b) >= ACUTE, self.waiting.pushed, a, b)));
    }

    fn failure(&self, place: DVec3, edge: f64, stuck: &[Stuck]) -> FrontError {
        let front = self.patch.front();
        let left = stuck.iter().filter(|of| front.contains(&of.edge));
        match left.filter_map(|of| of.blame).next() {
            Some(miss) => self.missed(miss),
            None if front.is_empty() => FrontError::Pinched { place },
            None => FrontError::Unclosed { place, edges: front.len(), edge },
        }
    }

    fn missed(&self, miss: Miss) -> FrontError {
        match miss {
            Miss::NoNumber(place) => FrontError::NoNumber { place },
            Miss::Flat(place) => FrontError::NoGradient { place },
            Miss::Far => FrontError::Seed { place: DVec3::NAN, reason: "Newton's method does not arrive" },
        }
    }

    /// The mesh, with the vertices that triangles use.
    fn grown(mut self) -> Grown {
        let mut numbers = vec![u32::MAX; self.patch.places.len()];
        let mut mesh = TriangleMesh::default();
        for corners in self.patch.triangles() {
            mesh.triangles.push(corners.map(|v| {
                let number = &mut numbers[v as usize];
                if *number == u32::MAX {
                    *number = mesh.positions.len() as u32;
                    mesh.positions.push(self.patch.place(v).as_vec3());
                    mesh.normals.push(self.patch.normal(v).as_vec3());
                }
                *number
            }));
        }
        self.counts.evaluations = self.probe.values();
        self.counts.gradients = self.probe.gradients();
        Grown { mesh, counts: self.counts }
    }
}

impl Front {
    fn check(&self, bounds: Bounds, isovalue: f32) -> Result<(), FrontError> {
        let (min, max) = (bounds.min, bounds.max);
        if !(min.is_finite() && max.is_finite() && min.cmplt(max).all() && (max - min).is_finite()) {
            return Err(FrontError::Box { min: min.into(), max: max.into() });
        }
        if !isovalue.is_finite() {
            return Err(FrontError::Isovalue { isovalue });
        }
        let wrong = |name, value, allowed: String| Err(FrontError::Setting { name, value, allowed });
        let longest = f64::from(bounds.size().max_element());
        if !(self.edge > 0.0 && self.edge <= longest) {
            return wrong(
                "edge",
                self.edge,
                format!("above 0 and at most {longest}, the longest side of the box"),
            );
        }
        let finest = longest * 1e-5;
        if self.edge < finest {
            return wrong("edge", self.edge, format!("at least {finest}, a hundred-thousandth of the box"));
        }
        if let Sizing::Curvature { smallest, angle } = self.sizing {
            if !(smallest >= finest && smallest <= self.edge) {
                return wrong(
                    "smallest",
                    smallest,
                    format!("at least {finest} and at most the edge, {}", self.edge),
                );
            }
            if !(angle > 0.0 && angle <= 1.0) {
                return wrong("angle", angle, "above 0 and at most 1 radian".into());
            }
        }
        match &self.seeds {
            Seeds::Sampled { cells } if !(1..=512).contains(cells) => {
                wrong("cells", f64::from(*cells), "from 1 to 512".into())
            }
            Seeds::Points(points) => match points.iter().find(|&&p| !(p.cmpge(min) & p.cmple(max)).all()) {
                Some(p) => Err(FrontError::SeedOutside { place: p.as_dvec3() }),
                None => Ok(()),
            },
            Seeds::Sampled { .. } => Ok(()),
        }
    }
}
