//! The methods of each object, with what is known of them.

use super::Estimate;
use crate::inputs::Inputs;
use crate::liking::{Liking, Top};
use crate::mesh_set::{MeshSet, known};
use isostudy_design::config::ObjectSection;
use isostudy_design::record::{BenchRun, Distribution, MeshRecord, Purpose, StoredTimes};
use isostudy_design::{ConfigurationId, Method, MethodId, Stage};
use isostudy_statistics::interval::LEVEL;
use isostudy_statistics::median;
use isostudy_timing::{ASSUMED_NOISE, NoiseFloor};

/// How many standard errors a mean may be off at 95 %.
const NORMAL_QUANTILE: f64 = 1.959_963_984_540_054;

/// The least error that is told apart, in cube edges. A method that is exact but for rounding would be a million times as good as the
/// next, and an error of 0 has no place on a logarithmic axis.
pub const LEAST_ERROR: f64 = 1e-4;

/// An object and the methods that can be taken for it, in the study's order.
pub struct ObjectCandidates<'a> {
    /// The object.
    pub object: &'a ObjectSection,
    /// The methods on it.
    pub candidates: Vec<Candidate<'a>>,
    /// The most liked on it, where that is known.
    pub most_liked: Option<Top>,
    /// Which of every two methods was shown to be liked more on it: the one, then the other.
    pub liked_more: Vec<[MethodId; 2]>,
}

/// A method on one object, at the benchmark spacing or what its budget made of it.
pub struct Candidate<'a> {
    /// The method.
    pub method: &'a Method,
    /// Its mesh.
    pub mesh: &'a MeshRecord,
    /// Median seconds from the field to the mesh, normals left out.
    pub time_s: Option<Estimate>,
    /// Seconds to extract each chunk.
    pub chunks: Option<Each>,
    /// Seconds to extract again what each edit touches.
    pub edits: Option<Each>,
    /// Times from stored samples.
    pub stored: Option<Stored>,
    /// Bytes that extraction takes beside the field.
    pub memory: Option<u64>,
    /// Mean distance from the mesh to the isosurface or back, whichever is larger, in edges of the object's benchmark cubes: one
    /// unit for all methods of the object. At least [`LEAST_ERROR`].
    pub error: Option<Estimate>,
    /// Mean distance from the isosurface's sharp edges to the mesh, in the same unit; `None` if it has none.
    pub sharp_edges: Option<Estimate>,
    /// Its log worth on this object less the mean of all methods', in log-odds: see [`Liking`].
    pub preference: Option<Estimate>,
}

/// Times from samples that are stored.
pub struct Stored {
    /// Median seconds to the mesh, normals left out.
    pub whole_s: Option<Estimate>,
    /// Seconds to extract each chunk.
    pub chunks: Option<Each>,
    /// Seconds to extract again what each edit touches.
    pub edits: Option<Each>,
}

impl Stored {
    fn of(times: &StoredTimes, noise: Option<f64>) -> Self {
        let whole = median(times.whole_s.clone(), LEVEL);
        Self {
            whole_s: whole.map(|of| beyond_noise(Estimate::within(of.median, of.interval), noise)),
            chunks: Each::of(per_chunk(times.timed, &times.chunk_s), noise),
            edits: Each::of(times.edit_s.clone(), noise),
        }
    }
}

/// Times of the same pieces of work, one after the other, and their median.
pub struct Each {
    times_s: Vec<f64>,
    /// The logarithm by which two runs may differ.
    noise: f64,
    /// Median in seconds.
    pub median_s: Estimate,
}

impl Each {
    fn of(times_s: Vec<f64>, noise: Option<f64>) -> Option<Self> {
        let found = median(times_s.clone(), LEVEL)?;
        Some(Self {
            times_s,
            noise: noise.unwrap_or(ASSUMED_NOISE),
            median_s: Estimate::within(found.median, found.interval),
        })
    }

    /// Whether the median ratio of a piece's two times may be 1 in another run; `None` where there are more pieces of one than of the
    /// other, so that they are not the same.
    pub fn may_equal(&self, other: &Self) -> Option<bool> {
        if self.times_s.len() != other.times_s.len() {
            return None;
        }
        let ratios = self.times_s.iter().zip(&other.times_s).map(|(a, b)| a / b).collect();
        let found = median(ratios, LEVEL)?;
        let of = Estimate::within(found.median, found.interval);
        let noise = self.noise.max(other.noise).exp();
        Some(of.low <= noise && 1.0 / noise <= of.high)
    }
}

impl ObjectCandidates<'_> {
    /// Whether the error of a method is the least that is told apart.
    pub fn has_least_error(&self) -> bool {
        self.candidates.iter().any(|of| of.error.is_some_and(|error| error.value <= LEAST_ERROR))
    }
}

impl Candidate<'_> {
    /// The code of the method.
    pub fn id(&self) -> MethodId {
        self.method.id
    }

    /// The number of triangles, of the object's region if it has one, as all that is judged here but times and topology.
    pub fn triangles(&self) -> Estimate {
        Estimate::exact(self.mesh.judged().triangles as f64)
    }

    /// Whether the mesh has the components and the Euler characteristic of the trilinear interpolant of its samples, as far as that was
    /// counted.
    pub fn has_right_topology(&self) -> bool {
        let own = &self.mesh.topology;
        self.mesh.trilinear.as_ref().is_some_and(|truth| {
            own.components == truth.components && own.euler_characteristic == truth.euler_characteristic
        })
    }

    /// Whether nothing is wrong with the mesh as a surface: no edge or vertex at which it is no manifold, no folded or doubled
    /// triangle, no two that pass through each other, as far as all of that was counted. A border is no fault here: the object may
    /// end at its box.
    pub fn is_faultless(&self) -> bool {
        let t = &self.mesh.topology;
        let counts = [t.non_manifold_edges, t.non_manifold_vertices, t.folded_faces, t.duplicate_faces];
        counts == [0; 4] && self.mesh.judged().self_intersections == Some(0)
    }
}

/// The candidates of every object that has any. A method that differs from an earlier one in its look alone is none, nor is one that
/// the study sets apart.
pub fn candidates<'a>(inputs: &Inputs<'a>, likings: &[Liking]) -> Vec<ObjectCandidates<'a>> {
    let study = inputs.study;
    let meshes = MeshSet::of(inputs, Purpose::Benchmark);
    let noise = inputs.bench.map(NoiseFloor::of);
    let is_compared = |method: &&Method| method.apart.is_none() && !study.is_repeated(method.id);
    let methods: Vec<&Method> = study.methods.iter().filter(is_compared).collect();
    let of_object = |(place, object): (usize, &'a ObjectSection)| {
        let liking = likings.iter().find(|of| of.object == Some(place));
        let candidate = |method: &&'a Method| {
            let mesh = meshes.at(place, method.id)?;
            let unit = object.benchmark_spacing;
            let id = ConfigurationId { object: object.id.clone(), method: method.id };
            let chunks = inputs.chunks.iter().find(|times| times.id == id);
            let stored = inputs.stored.iter().find(|times| times.id == id);
            Some(Candidate {
                method,
                mesh,
                time_s: inputs.bench.zip(noise.as_ref()).and_then(|(run, noise)| time(run, noise, &id)),
                chunks: chunks.and_then(|times| {
                    Each::of(per_chunk(times.timed, &times.chunk_s), of_total(noise.as_ref(), &id))
                }),
                edits: chunks.and_then(|times| Each::of(times.edit_s.clone(), of_total(noise.as_ref(), &id))),
                stored: stored.map(|times| Stored::of(times, of_total(noise.as_ref(), &id))),
                memory: inputs
                    .bench
                    .and_then(|run| run.memory.iter().find(|peak| peak.id == id)?.of_extraction()),
                error: error(mesh, unit),
                sharp_edges: mesh
                    .judged()
                    .accuracy
                    .sharp_edges
                    .as_ref()
                    .and_then(mean)
                    .map(|mean| mean.per(unit)),
                preference: liking
                    .and_then(|of| of.worth(method.id))
                    .map(|(worth, interval)| Estimate::within(worth, interval)),
            })
        };
        ObjectCandidates {
            object,
            candidates: methods.iter().filter_map(candidate).collect(),
            most_liked: liking.and_then(|of| of.top.clone()),
            liked_more: liking.map_or_else(Vec::new, Liking::shown),
        }
    };
    let all = study.file.objects.iter().enumerate().map(of_object);
    all.filter(|of| !of.candidates.is_empty()).collect()
}

/// The median of the run's times. What other runs may differ by is in its ends: two times of which neither interval is beyond the other
/// may change places in another run.
fn time(run: &BenchRun, noise: &NoiseFloor, id: &ConfigurationId) -> Option<Estimate> {
    let own = run.samples.iter().filter(|sample| sample.id == *id);
    let found = median(own.map(|sample| sample.total_s - sample.normals_s).collect(), LEVEL)?;
    let within = Estimate::within(found.median, found.interval);
    Some(beyond_noise(within, of_total(Some(noise), id)))
}

/// The logarithm by which two runs of a configuration differ in their time, where that is known.
fn of_total(noise: Option<&NoiseFloor>, id: &ConfigurationId) -> Option<f64> {
    noise.and_then(|noise| noise.of_stage(Stage::Total, id))
}

/// A time whose ends are farther apart by what runs differ by.
fn beyond_noise(time: Estimate, noise: Option<f64>) -> Estimate {
    let half = (noise.unwrap_or(ASSUMED_NOISE) / 2.0).exp();
    Estimate { value: time.value, low: time.low / half, high: time.high * half }
}

/// By how much runs of one program differ: the smallest and the largest share of a time among the run's configurations, and whether an
/// A/A block tells it or it is assumed.
pub fn noise(run: &BenchRun) -> ([f64; 2], bool) {
    let known = NoiseFloor::of(run).range(Stage::Total);
    let (low, high) = known.unwrap_or((ASSUMED_NOISE, ASSUMED_NOISE));
    ([low, high].map(|log| log.exp() - 1.0), known.is_some())
}

/// Of each chunk the median of its rounds.
fn per_chunk(chunks: u64, times_s: &[f64]) -> Vec<f64> {
    let count = chunks as usize;
    let of = |chunk| median(times_s.iter().copied().skip(chunk).step_by(count).collect(), LEVEL);
    (0..count).filter_map(of).map(|of| of.median).collect()
}

fn error(mesh: &MeshRecord, unit: f64) -> Option<Estimate> {
    let of = mesh.judged().accuracy;
    let there = mean(&of.distance)?;
    let back = mean(of.distance_to_mesh.as_ref()?)?;
    let larger = if back.value > there.value { back } else { there };
    Some(larger.per(unit).at_least(LEAST_ERROR))
}

fn mean(of: &Distribution) -> Option<Estimate> {
    let mean = known(of, |of| of.mean)?;
    let half = NORMAL_QUANTILE * of.sd / (of.count as f64).sqrt();
    Some(Estimate { value: mean, low: mean - half, high: mean + half })
}
