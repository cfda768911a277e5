//! The executor that really extracts.

use crate::error::BenchError;
use crate::run::Executor;
use crate::stages::StageSeconds;
use design::ConfigurationId;
use extract::{Execution, ExtractSettings, Lattice, ScalarField, StageTimes, extract};
use std::hint::black_box;

/// A configuration, ready to extract.
pub struct Subject<'a> {
    /// Its id.
    pub id: ConfigurationId,
    /// What is sampled.
    pub field: &'a dyn ScalarField,
    /// Where it is sampled.
    pub lattice: Lattice,
    /// Isovalue, clustering, positions.
    pub settings: ExtractSettings,
}

/// Extracts the subjects it was given, by index.
pub struct ExtractExecutor<'a> {
    subjects: &'a [Subject<'a>],
    threads: u32,
}

impl<'a> ExtractExecutor<'a> {
    /// An executor whose sampling stage takes `threads` threads; 0 takes every core, as in [`Execution`].
    pub fn new(subjects: &'a [Subject<'a>], threads: u32) -> Self {
        Self { subjects, threads }
    }
}

impl Executor for ExtractExecutor<'_> {
    /// Extracts one subject and drops the mesh; dropping is not in any stage.
    ///
    /// # Errors
    /// What [`extract()`] refuses.
    ///
    /// # Panics
    /// If there is no such subject.
    fn execute(&mut self, subject: usize) -> Result<StageSeconds, BenchError> {
        let subject = &self.subjects[subject];
        let execution = Execution { threads: self.threads as usize };
        let extraction = extract(subject.field, &subject.lattice, &subject.settings, &execution)
            .map_err(|error| BenchError::Execution(Box::new(error)))?;
        Ok(seconds(&black_box(extraction).times))
    }
}

fn seconds(times: &StageTimes) -> StageSeconds {
    StageSeconds {
        allocation_s: times.allocation.as_secs_f64(),
        sampling_s: times.sampling.as_secs_f64(),
        vertex_s: times.vertex.as_secs_f64(),
        geometry_s: times.geometry.as_secs_f64(),
        normals_s: times.normals.as_secs_f64(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use extract::{Arrangement, Positions, Sphere};
    use glam::Vec3;
    use mesh::Bounds;
    use std::time::Duration;

    fn sphere(settings: ExtractSettings) -> Subject<'static> {
        let bounds = Bounds { min: Vec3::splat(-1.1), max: Vec3::splat(1.1) };
        Subject {
            id: "ss_bi".parse().unwrap(),
            field: &Sphere { radius: 1.0 },
            lattice: Lattice::try_new(Arrangement::BodyCentred, bounds, 0.5).unwrap(),
            settings,
        }
    }

    #[test]
    fn each_stage_goes_where_it_belongs() {
        let ms = Duration::from_millis;
        let times = StageTimes {
            allocation: ms(1),
            sampling: ms(20),
            vertex: ms(300),
            geometry: ms(4000),
            normals: ms(50000),
        };
        let stages = seconds(&times);
        let expected = StageSeconds {
            allocation_s: 0.001,
            sampling_s: 0.02,
            vertex_s: 0.3,
            geometry_s: 4.0,
            normals_s: 50.0,
        };
        assert_eq!(stages, expected);
        assert!((stages.total() - times.total().as_secs_f64()).abs() < 1e-9);
    }

    #[test]
    fn a_subject_is_extracted() {
        let subjects = [sphere(ExtractSettings::default())];
        let stages = ExtractExecutor::new(&subjects, 1).execute(0).unwrap();
        assert!(stages.by_stage().iter().all(|(_, seconds)| *seconds >= 0.0), "{stages:?}");
    }

    #[test]
    fn what_extract_refuses_is_passed_on() {
        let positions = Positions::Accumulated { chunks: 0 };
        let subjects = [sphere(ExtractSettings { positions, ..Default::default() })];
        let error = ExtractExecutor::new(&subjects, 1).execute(0).unwrap_err();
        assert!(error.to_string().contains("chunk"), "{error}");
    }
}
