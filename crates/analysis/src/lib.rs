//! Answers to preference factors, and a study's tables and figures.
//!
//! Takes plain records from [`design::record`] and a file of answers ([`read_answers`]); gives [`Table`]s that print
//! themselves as CSV, Markdown, LaTeX and HTML, and [`Figure`]s as SVG and PNG. Knows nothing of files to write, of
//! geometry or of command lines. polars does the table verbs (read, unpivot, join, count); from the counts on,
//! preference factors are exact fractions ([`Fraction`]) until they are printed.
//!
//! # Guarantees
//! - The same inputs give the same bytes. Rows follow the study's order, never a hash's.
//! - Nothing is indexed by the paper's ids: any objects, methods and groups will do. Parts that are not there (no
//!   benchmark, no answers, nothing published) leave out their tables and figures.
//!
//! Tests and models of preference are in [`statistics`], over plain ballots.

mod answers;
mod answers_error;
mod ballots;
mod claims;
mod comparison;
mod figures;
mod fraction;
mod inputs;
pub mod interval;
mod mesh_set;
pub mod preference;
mod published_ratio;
mod stage_times;
pub mod statistics;
mod table;
mod tables;
mod tally;
pub mod timing;
mod verdict;

#[cfg(test)]
mod fixture;

pub use answers::{Answers, Choice, read_answers};
pub use answers_error::AnswersError;
pub use ballots::{BallotGroup, ballot_groups, ballots};
pub use comparison::unexplained_differences;
pub use figures::{Figure, figures};
pub use fraction::Fraction;
pub use inputs::{AnalysisError, Inputs};
pub use table::{Cell, Column, Table};
pub use tables::contrasts::pair_tests;
pub use tables::models::model_tables;
pub use tables::tables;
pub use tally::{QuestionCount, Tally};
pub use verdict::Verdict;
