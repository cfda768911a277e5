//! The commands, one per verb: each has its arguments and its `run`.

pub(crate) mod analyse;
pub(crate) mod barometer;
pub(crate) mod bench;
pub(crate) mod bundle;
pub(crate) mod collect;
pub(crate) mod convert;
pub(crate) mod deidentify;
pub(crate) mod design;
pub(crate) mod distance;
pub(crate) mod extract;
pub(crate) mod inspect;
pub(crate) mod job;
pub(crate) mod methods;
pub(crate) mod new;
pub(crate) mod pairs;
pub(crate) mod plan;
pub(crate) mod report;
pub(crate) mod serve;
mod simulation_jobs;
pub(crate) mod study;
pub(crate) mod table;
pub(crate) mod turntable;
pub(crate) mod validate;
pub(crate) mod verify;

// What several of them share.
mod adaptive;
mod checked_study;
mod faults;
mod given_answers;
mod named;
mod object_of_study;
mod parts;
mod reading_rules;
mod source_arguments;
mod stopping;
mod study_forms;
mod study_run;
