//! Answers, meshes and times to results and conclusions.
//!
//! Takes plain records from [`isostudy_design::record`] and answers that were read ([`isostudy_responses::Responses`]), and computes
//! everything that is said of them once, as types: [`Results`]. Knows no table, no plot and no prose. From the counts of answers on,
//! preference factors are exact fractions ([`Fraction`]) until somebody prints them.
//!
//! # Guarantees
//! - The same inputs give the same results. Rows follow the study's order, never a hash's.
//! - Nothing is indexed by a paper's ids: any objects, methods and groups will do. Parts that are not there (no benchmark, no
//!   answers) leave out what depends on them.
//!
//! Tests and models of preference are in the crate [`isostudy_statistics`], over plain ballots; [`audit`] looks for defects of a
//! study, [`isostudy_statistics::simulation`] makes studies whose truth is known, and [`self_test`] tries the ones on the others.

pub mod agreement;
pub mod answered;
pub mod attributes;
pub mod audit;
pub mod ballots;
pub mod cases;
pub mod decision;
pub mod fraction;
pub mod glance;
pub mod hypotheses;
pub mod inputs;
pub mod leave_one_out;
pub mod liking;
pub mod looks;
pub mod majorities;
pub mod many;
pub mod mesh_set;
pub mod models;
mod next;
pub mod omnibus;
pub mod open_groups;
pub mod power;
pub mod prediction;
pub mod preference;
pub mod published_ratio;
pub mod recorded;
pub mod results;
pub mod scale;
pub mod screened;
pub mod screens;
pub mod self_test;
pub mod series;
pub mod sides;
pub mod tally;
pub mod tipping;
pub mod ways;

#[cfg(test)]
pub mod fixture;

pub use answered::Answered;
pub use ballots::BallotGroup;
pub use fraction::Fraction;
pub use inputs::Inputs;
pub use isostudy_statistics::Outcome;
pub use liking::Liking;
pub use many::{MANY_ANSWERS, MANY_ITEMS, Many, is_many};
pub use next::NextQuestions;
pub use open_groups::open_groups;
pub use recorded::Recorded;
pub use results::conclusions::{self, Conclusions};
pub use results::{Preferences, Results};
pub use tally::{QuestionCount, Tally};
