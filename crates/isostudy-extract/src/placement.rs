//! Where vertices go: from the mean of their crossings to where the settings want them.
//!
//! Both extractors place every vertex at the mean of its linearly interpolated crossings first. Everything else is a
//! target beside that, and a [`moves::Moves`] takes vertices there without turning a triangle over.

mod crossings;
mod curvature;
mod moves;
mod relaxation;
pub(crate) mod spot;
mod surroundings;
mod targets;

pub(crate) use self::crossings::{CrossingPlacer, clamped, crossing_ratio};
pub(crate) use self::moves::{MOST_PASSES, Moves, on_box};
pub(crate) use self::relaxation::{Around, relax};
pub(crate) use self::surroundings::Surroundings;
pub(crate) use self::targets::{FieldTargets, move_vertices};
use crate::extraction::ExtractError;
use crate::settings::ExtractSettings;

/// # Errors
/// [`ExtractError::PlacementNeedsField`] if the settings want to call a field and there are only samples.
pub(crate) fn check(settings: &ExtractSettings, has_field: bool) -> Result<(), ExtractError> {
    let calls = settings.refine_crossings || settings.placement.calls_the_field();
    if calls && !has_field {
        let (placement, refine_crossings) = (settings.placement, settings.refine_crossings);
        return Err(ExtractError::PlacementNeedsField { placement, refine_crossings });
    }
    Ok(())
}
