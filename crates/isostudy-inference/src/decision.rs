//! Which method to take: what each costs and gives on each object, who is beaten in both, and who is the best at what is wanted.
//!
//! Nothing here weighs time against error. A front leaves out what nobody should take; a want names one quantity and takes the best
//! in it. Who is not told apart from the best is named beside it, or taken in its place: see [`Want`].

mod candidate;
mod estimate;
mod fronts;
mod wants;

pub use candidate::{Candidate, Each, LEAST_ERROR, ObjectCandidates, candidates, noise};
pub use estimate::Estimate;
pub use fronts::{Axes, Front, FrontPoint, Standing, fronts};
pub use wants::{Cost, Goal, Pick, Want, picks};

#[cfg(test)]
mod tests;
