//! Why a benchmark stopped.

use crate::plan::Round;
use crate::stages::Stage;
use design::ConfigurationId;
use std::error::Error;

/// Why a benchmark stopped. Samples taken before are gone: half a round would favour whoever was in it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BenchError {
    /// The plan measures nothing.
    #[error("the plan has no iterations: at least 1 is needed")]
    NoIterations,
    /// There is nothing to measure.
    #[error("the plan has no configurations: at least 1 is needed")]
    NoConfigurations,
    /// A configuration is listed twice; its samples could not be told apart.
    #[error("{0} is listed twice: every configuration is timed once a round")]
    Repeated(ConfigurationId),
    /// A configuration failed; the source says how.
    #[error("{id} failed in {round}")]
    Configuration {
        /// Which configuration.
        id: ConfigurationId,
        /// When.
        round: Round,
        /// Why.
        source: Box<BenchError>,
    },
    /// What an [`Executor`](crate::Executor) ran into.
    #[error(transparent)]
    Execution(Box<dyn Error + Send + Sync>),
    /// An executor returned something that is not a duration.
    #[error("{} took {seconds} s: must be finite and not negative", .stage.label())]
    NotADuration {
        /// Which stage.
        stage: Stage,
        /// What was returned.
        seconds: f64,
    },
}
