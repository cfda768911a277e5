//! Statistics of paired comparisons with ties, where one participant answers several questions.
//!
//! Takes answers: as they were shown ([`ShownBallot`]) where sides matter, about items ([`DeclaredBallot`]) where they do not.
//! Each function says in its signature which it takes. Knows nothing of studies, files, tables or plots.
//! `docs/statistics.md` has each statistic's formula, source, limits and a value with the call that gave it.
//!
//! # Guarantees
//! - Participants are what is independent; answers of one participant are not. [`sign_flip`] assumes nothing else.
//! - Estimates say how they were got: the level of every interval is [`LEVEL`](crate::interval::LEVEL), a penalised fit says
//!   that it is, and what a design cannot answer is an error with the reason, never a number.
//! - The order of participants and the number of threads change nothing.
//!
//! # Not guaranteed
//! - "Not significant" is not "equal": read the interval, or the test of [`equivalence`] within a declared margin.
//! - A model's independence standard errors ([`WorthFit::covariance`]) are too small for clustered answers; they are there
//!   to be compared with other programs.

mod adaptive;
mod attribute;
mod ballot;
pub mod bootstrap;
mod closeness;
mod clustered;
mod equivalence;
mod exchange;
mod first_choice;
mod fit;
mod friedman;
mod goodness;
mod graded;
mod heterogeneity;
pub mod interval;
mod kendall;
mod krippendorff;
mod model;
mod multinomial;
mod multiplicity;
mod newton;
mod order_statistics;
mod outlying;
mod pairs;
mod participants;
mod person_model;
mod power_law;
mod rank_correlation;
mod ratings;
mod regression;
mod sandwich;
mod scale;
mod score;
mod screening;
mod separation;
mod sequential;
mod share;
mod side;
mod side_bound;
mod side_separation;
mod sign_flip;
pub mod sign_test;
pub mod simulation;
mod tipping;

#[cfg(test)]
mod golden;

pub use adaptive::{Known, Shrunken, chosen_pairs, dealt_pairs, expected_information, next_pairs, shrunken};
pub use attribute::{Attribute, AttributeTest, ORDERS, attribute_test};
pub use ballot::{Answer, Ballot, DeclaredBallot, Outcome, Preference, ShownBallot};
pub use closeness::{Closeness, closeness};
pub use clustered::Coefficient;
pub use equivalence::{Equivalence, MARGIN, equivalence};
pub use exchange::{Split, exchange};
pub use first_choice::{Choice, FirstChoice, first_choice};
pub use fit::{FitError, Penalty, WorthFit, fit, fit_given_side, has_spread};
pub use friedman::{ChiSquareTest, friedman};
pub use goodness::{FittedPair, Goodness, goodness};
pub use graded::{GradedBallot, GradedFit, Link, MOST_STEPS, graded};
pub use heterogeneity::{Heterogeneity, heterogeneity};
pub use kendall::{Agreement, Triads, agreement, outcome_counts, triads, zeta, zetas};
pub use krippendorff::{Alpha, Metric, alpha, alpha_with_interval};
pub use model::Model;
pub use multiplicity::{benjamini_hochberg, holm};
pub use newton::Matrix;
pub use order_statistics::{Median, median};
pub use outlying::{Outlying, WithMajority, outlying_respondents};
pub use pairs::{Pair, Pairs};
pub use participants::Participants;
pub use person_model::{PersonModel, person_model};
pub use power_law::{PowerLaw, power_law};
pub use rank_correlation::spearman;
pub use ratings::{Rating, RatingFit, ratings};
pub use regression::{Regression, regression, regression_given_side};
pub use sandwich::clustered_covariance;
pub use scale::{Difference, NoOmnibus, Omnibus, Scale, Spread, fit_on_one_scale, jod, preferred, scale};
pub use score::{FEWEST_RESAMPLED, ScoreGroup, ScoreTest};
pub use screening::{Circumstances, Flag, Protocol, Screening, screening, screening_with};
pub use separation::{Separation, separation};
pub use sequential::{Boundary, Look};
pub use share::{ClusteredShare, clustered_share};
pub use side::{Side, SideDesign, side_design};
pub use side_bound::{SideBound, side_bound};
pub use side_separation::side_separation;
pub use sign_flip::{RATIO_LIMIT, SignFlip, sign_flip, sign_flip_of_counts};
pub use tipping::{FARTHEST_TIP, Tip, Tipping, tipping, tipping_of_difference};
