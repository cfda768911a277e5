//! The spread between people, from answers that they gave: for planning whom to ask next.

use crate::answered::Answered;
use crate::ballots::widest;
use isostudy_design::Study;
use isostudy_responses::Responses;
use isostudy_statistics::{FitError, Heterogeneity, Participants, heterogeneity};

/// The spread between the people who answered, and how many they are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// Its estimate.
    pub of: Heterogeneity,
    /// People with an answer about the items of the estimate.
    pub people: u64,
}

/// Of the items with the most answers, as the conclusions of the same answers have it. Whoever the study leaves out is left out.
///
/// # Errors
/// As [`heterogeneity`]; [`FitError::Nothing`] where nobody answered a comparison.
pub fn spread_between_people(study: &Study, responses: Responses) -> Result<Spread, FitError> {
    let answered = Answered::of(study, responses).ok_or(FitError::Nothing)?;
    let group = widest(&answered.groups).ok_or(FitError::Nothing)?;
    let participants = Participants::of(group.items.len(), &group.ballots);
    Ok(Spread { of: heterogeneity(&participants)?, people: participants.number() })
}
