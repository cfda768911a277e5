//! Why a benchmark stopped.

use crate::journal::JournalError;
use crate::plan::Round;
use isostudy_design::ConfigurationId;
use isostudy_design::record::InvalidSample;
use std::error::Error;

/// Why a benchmark stopped. Samples taken before are in the journal, if one was kept.
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
    /// Nothing is left to measure; the source says how the last one failed.
    #[error("every configuration failed, {id} last")]
    AllFailed {
        /// Which configuration was the last.
        id: ConfigurationId,
        /// Why.
        source: Box<BenchError>,
    },
    /// A published table is empty.
    #[error("the table has no rows")]
    NoRows,
    /// A row of a published table.
    #[error("the row of {id}: {reason}")]
    Row {
        /// Which configuration's.
        id: ConfigurationId,
        /// What is wrong with it.
        reason: InvalidSample,
    },
    /// What was recorded before cannot be gone on from.
    #[error("the journal cannot be used")]
    Journal(#[from] JournalError),
    /// An entry could not be recorded.
    #[error("cannot write the journal")]
    Record(#[source] std::io::Error),
    /// The process that measures could not be started or asked.
    #[error("the measuring process: {0}")]
    Process(String),
    /// What an [`Executor`](crate::Executor) ran into.
    #[error(transparent)]
    Execution(Box<dyn Error + Send + Sync>),
    /// An executor returned times that no clock gives.
    #[error(transparent)]
    Invalid(#[from] InvalidSample),
}
