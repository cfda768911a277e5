//! Results as tables, figures, sentences and frames.
//!
//! Each is a renderer of what [`isostudy_inference`] computed, and none reads another: [`isostudy_table::Table`]s print themselves as
//! CSV, Markdown, LaTeX and HTML, [`Figure`]s are SVG and PNG from one drawing, a [`Report`] is sections of sentences, tables and
//! figures, and a [`LongFrame`] is what tables summarise, row by row. Knows nothing of files to write or of command lines.
//!
//! A [`LongFrame`] is behind the feature `frames`.
//!
//! # Guarantees
//! - The same results give the same bytes.

mod budgets;
mod cases;
#[cfg(feature = "frames")]
mod data;
mod distribution;
mod evidence_of_probes;
mod figure;
mod figures;
#[cfg(feature = "frames")]
mod frames;
mod machines;
mod many;
mod panel;
#[cfg(feature = "frames")]
mod parquet_text;
pub mod region;
pub mod report;
mod self_test;
mod standing;
pub mod statement;
mod tables;
mod telling;
mod wants;
mod without_study;
pub mod words;

#[cfg(test)]
#[path = "../../isostudy-inference/src/fixture.rs"]
pub mod fixture;

// The fixture makes these.
#[cfg(test)]
use isostudy_inference::{Answered, Inputs};

pub use cases::sweep_section;
#[cfg(feature = "frames")]
pub use data::frames;
pub use figure::Figure;
pub use figures::{
    EnginePoint, FigureError, KindShare, OVERVIEW, TableQuality, barometer_figure, case_figures,
    edge_groups_figure, figures, figures_of_groups, history_figure, power_figure, sweep_figures,
};
#[cfg(feature = "frames")]
pub use frames::{
    CaseMesh, CaseTimes, FrameError, LongFrame, MeasuredCase, TimedCase, answers_frame, case_meshes,
    case_times, machine_name, measured_cases, timed_cases,
};
pub use machines::machines_section;
pub use many::{found_in_many, many_tables, pairs_csv, report_of_many, told_of_many};
pub use panel::{PANEL_SCHEMA, Panel, StageTime};
#[cfg(feature = "frames")]
pub use parquet_text::{PARQUET_MARK, ParquetError, parquet_as_csv};
pub use report::{Report, found, found_in_groups, report, report_of_groups};
pub use self_test::self_test_tables;
pub use tables::benchmark::of_objects as benchmark_of_objects;
pub use tables::cases::case_tables;
pub use tables::power::{power_sentences, power_tables};
pub use tables::tables;
pub use telling::{Telling, telling};
pub use wants::named_by_choices;
pub use without_study::answer_tables;
