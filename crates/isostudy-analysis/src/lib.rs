//! Answers to preference factors, and a study's tables and figures.
//!
//! Takes plain records from [`isostudy_design::record`] and answers that were read ([`isostudy_responses::Responses`]); gives [`isostudy_table::Table`]s that print
//! themselves as CSV, Markdown, LaTeX and HTML, and [`Figure`]s as SVG and PNG. Knows nothing of files to write, of
//! geometry or of command lines. From the counts of answers on, preference factors are exact fractions ([`Fraction`]) until they
//! are printed.
//!
//! # Guarantees
//! - The same inputs give the same bytes. Rows follow the study's order, never a hash's.
//! - Nothing is indexed by the paper's ids: any objects, methods and groups will do. Parts that are not there (no
//!   benchmark, no answers, nothing published) leave out their tables and figures.
//!
//! Tests and models of preference are in the crate [`isostudy_statistics`], over plain ballots; [`audit`] looks for defects of a study,
//! [`isostudy_statistics::simulation`] makes studies whose truth is known, and [`self_test`] tries the ones on the others.

mod answered;
pub mod audit;
mod ballots;
mod data;
mod decision;
mod figure;
mod figures;
mod fraction;
mod frames;
mod glance;
mod hypotheses;
mod inputs;
mod leave_one_out;
mod mesh_set;
mod omnibus;
mod panel;
mod paper;
pub mod power;
mod prediction;
pub mod preference;
mod published_ratio;
mod recorded;
pub mod report;
mod screens;
pub mod self_test;
mod statement;
mod tables;
mod tally;
mod without_study;
mod words;

#[cfg(test)]
mod fixture;

pub use answered::Answered;
pub use ballots::{BallotGroup, ballot_groups, ballots, declared};

pub use data::frames;
pub use figure::Figure;
pub use figures::{
    KindShare, TableQuality, edge_groups_figure, figures, figures_of_groups, history_figure, power_figure,
    sweep_figures,
};
pub use fraction::Fraction;
pub use frames::{FrameError, LongFrame, answers_frame};
pub use inputs::{AnalysisError, Inputs};
pub use panel::{PANEL_SCHEMA, Panel, StageTime};
pub use paper::{Verdict, unexplained_differences};
pub use recorded::Recorded;
pub use report::{Report, report, report_of_groups};
pub use tables::audit::audit_table;
pub use tables::contrasts::pair_tests;
pub use tables::models::model_tables;
pub use tables::power::power_tables;
pub use tables::screened::screened_pair_tests;
pub use tables::tables;
pub use tally::{QuestionCount, Tally};
pub use without_study::{answer_tables, open_groups};
