//! The numbers of each case, from the published benchmark or from ours, under one roof.

use crate::comparison::benchmark::{Cause, cause};
use crate::verdict::relative_difference;
use isostudy_design::published::BenchmarkRow;
use isostudy_design::record::{MeshRecord, Purpose};
use isostudy_design::{Arrangement, Clustering, ConfigurationId, Crossed};
use isostudy_inference::inputs::Inputs;
use isostudy_inference::mesh_set::MeshSet;
use isostudy_timing::stage_times::StageTimes;

/// Published numbers are known to about this.
const PRINTED: f64 = 1e-6;

/// A number of one configuration, and where each side keeps it.
#[derive(Clone, Copy)]
pub(crate) struct Measure {
    pub(crate) published: fn(&BenchmarkRow) -> f64,
    pub(crate) ours: Ours,
}

/// Where our side keeps it.
#[derive(Clone, Copy)]
pub(crate) enum Ours {
    Mesh(fn(&MeshRecord) -> f64),
    /// Of the triangles' shapes: nothing if there is no triangle.
    Shape(fn(&MeshRecord) -> Option<f64>),
    Times(fn(&StageTimes) -> f64),
}

/// Two configurations, each an object and a method.
pub(crate) type Pair = [(usize, Crossed); 2];

/// Whose numbers.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Side {
    Published,
    Ours,
    /// Ours, with the times of one round of the benchmark alone.
    Round(u32),
}

/// Looks numbers up.
pub(crate) struct Numbers<'a> {
    pub(crate) inputs: Inputs<'a>,
    meshes: MeshSet<'a>,
}

impl<'a> Numbers<'a> {
    pub(crate) fn of(inputs: &Inputs<'a>) -> Self {
        Self::of_purpose(inputs, Purpose::Benchmark)
    }

    /// With the meshes of another purpose.
    pub(crate) fn of_purpose(inputs: &Inputs<'a>, purpose: Purpose) -> Self {
        Self { inputs: *inputs, meshes: MeshSet::of(inputs, purpose) }
    }

    pub(crate) fn get(&self, side: Side, measure: Measure, object: usize, method: Crossed) -> Option<f64> {
        let id = self.id(object, method);
        match (side, measure.ours) {
            (Side::Published, _) => {
                let rows = &self.inputs.study.published.benchmark;
                rows.iter().find(|row| row.id == id).map(measure.published)
            }
            (_, Ours::Mesh(of)) => self.meshes.get(&id).map(of),
            (_, Ours::Shape(of)) => self.meshes.get(&id).and_then(of),
            (_, Ours::Times(of)) => {
                let run = self.inputs.bench?;
                let times = match side {
                    Side::Round(round) => StageTimes::of_round(run, &id, round),
                    _ => StageTimes::of(run, &id),
                };
                times.map(|times| of(&times))
            }
        }
    }

    /// Objects crossed with arrangements: the text's six cases.
    pub(crate) fn lattice_cases(&self) -> Vec<(usize, Arrangement)> {
        let file = &self.inputs.study.file;
        let with = |object| file.arrangements.iter().map(move |&arrangement| (object, arrangement));
        (0..file.objects.len()).flat_map(with).collect()
    }

    /// Objects crossed with some clusterings.
    pub(crate) fn clustering_cases(&self, of: &[Clustering]) -> Vec<(usize, Clustering)> {
        let known = &self.inputs.study.file.clusterings;
        let of: Vec<Clustering> = of.iter().copied().filter(|c| known.contains(c)).collect();
        let objects = 0..self.inputs.study.file.objects.len();
        objects.flat_map(|object| of.iter().map(move |&c| (object, c)).collect::<Vec<_>>()).collect()
    }

    /// One clustering and another, in every lattice case.
    pub(crate) fn clustering_pairs(&self, top: Clustering, bottom: Clustering) -> Vec<Pair> {
        let pair = |(object, arrangement)| {
            [top, bottom].map(|clustering| (object, Crossed { arrangement, clustering }))
        };
        self.lattice_cases().into_iter().map(pair).collect()
    }

    /// Body-centred and simple cubic, for every object and some clusterings.
    pub(crate) fn arrangement_pairs(&self, of: &[Clustering]) -> Vec<Pair> {
        let pair = |(object, clustering)| {
            [Arrangement::BodyCentred, Arrangement::SimpleCubic]
                .map(|arrangement| (object, Crossed { arrangement, clustering }))
        };
        self.clustering_cases(of).into_iter().map(pair).collect()
    }

    /// `measure` of the first over that of the second, for every pair that has both.
    pub(crate) fn ratios(&self, side: Side, measure: Measure, pairs: &[Pair]) -> Vec<f64> {
        let get = |(object, method): (usize, Crossed)| self.get(side, measure, object, method);
        pairs.iter().filter_map(|&[top, bottom]| Some(get(top)? / get(bottom)?)).collect()
    }

    /// `measure` of body-centred over that of simple cubic, for every object and some clusterings.
    pub(crate) fn over_arrangement(&self, side: Side, measure: Measure, of: &[Clustering]) -> Vec<f64> {
        self.ratios(side, measure, &self.arrangement_pairs(of))
    }

    /// `measure` of one clustering in every lattice case.
    pub(crate) fn each(&self, side: Side, measure: Measure, clustering: Clustering) -> Vec<f64> {
        self.each_case(side, measure, clustering).into_iter().map(|(.., value)| value).collect()
    }

    /// The same, with the object and the method of each.
    pub(crate) fn each_case(
        &self,
        side: Side,
        measure: Measure,
        clustering: Clustering,
    ) -> Vec<(usize, Crossed, f64)> {
        let get = |(object, arrangement): (usize, Arrangement)| {
            let method = Crossed { arrangement, clustering };
            Some((object, method, self.get(side, measure, object, method)?))
        };
        self.lattice_cases().into_iter().filter_map(get).collect()
    }

    /// What may move an object's numbers; `None` if nothing may.
    pub(crate) fn cause(&self, object: usize) -> Option<Cause> {
        cause(&self.inputs.study.file.objects[object].field)
    }

    /// What moves `measure` with these clusterings: the causes of the objects on which it is not the published one.
    /// `None` if there are none, or one of these objects has no cause.
    pub(crate) fn causes(&self, measure: Measure, of: &[Clustering]) -> Option<String> {
        let mut causes: Vec<&str> = Vec::new();
        for &clustering in of {
            for (object, method, ours) in self.each_case(Side::Ours, measure, clustering) {
                let published = self.get(Side::Published, measure, object, method);
                if published.is_none_or(|published| relative_difference(published, ours) <= PRINTED) {
                    continue;
                }
                let cause = self.cause(object)?.short;
                if !causes.contains(&cause) {
                    causes.push(cause);
                }
            }
        }
        (!causes.is_empty()).then(|| causes.join(", "))
    }

    /// What an object is called.
    pub(crate) fn object_name(&self, object: usize) -> &str {
        &self.inputs.study.file.objects[object].name
    }

    /// The id of a configuration.
    pub(crate) fn id(&self, object: usize, method: Crossed) -> ConfigurationId {
        ConfigurationId { object: self.inputs.study.file.objects[object].id.clone(), method: method.id() }
    }
}

/// Arithmetic mean; `None` of nothing.
pub(crate) fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// Mean of ratios as a change in per cent.
pub(crate) fn mean_change(ratios: &[f64]) -> Option<f64> {
    mean(ratios).map(|ratio| 100.0 * (ratio - 1.0))
}
