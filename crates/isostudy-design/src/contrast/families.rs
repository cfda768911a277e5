//! Which contrasts' p values are corrected together.

use super::{Contrast, Family};
use crate::config::{AnalysisSection, FamilyRule};

/// Name of the family of primary contrasts.
pub const PRIMARY: &str = "primary";
/// Name of the family of all other contrasts, where there is but one.
pub const WHOLE: &str = "all";

/// Contrasts whose p values are corrected together.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TestFamily {
    /// [`PRIMARY`], [`WHOLE`] or a [family's name](Contrast::family_name).
    pub name: String,
    /// Indices of the contrasts, ascending, at least one.
    pub members: Vec<usize>,
}

/// Families of correction, as a study's `[analysis]` has them; every contrast is in exactly one.
///
/// Primary contrasts are a family of their own, which comes first. The others are corrected by kind, in the order of
/// [`Family`], or all together. Names in `primary` that no contrast has are passed over; a study that was
/// [loaded](crate::Study::load) has none.
pub fn families(contrasts: &[Contrast], section: &AnalysisSection) -> Vec<TestFamily> {
    let is_primary = |contrast: &Contrast| section.primary.contains(&contrast.to_string());
    let (primary, others): (Vec<usize>, Vec<usize>) =
        (0..contrasts.len()).partition(|&i| is_primary(&contrasts[i]));
    let mut families = vec![TestFamily { name: PRIMARY.into(), members: primary }];
    match section.families {
        FamilyRule::One => families.push(TestFamily { name: WHOLE.into(), members: others }),
        FamilyRule::ByKind => {
            let mut kinds: Vec<Family> = others.iter().map(|&i| contrasts[i].family).collect();
            kinds.sort_unstable();
            kinds.dedup();
            families.extend(kinds.into_iter().map(|kind| {
                let members: Vec<usize> =
                    others.iter().copied().filter(|&i| contrasts[i].family == kind).collect();
                TestFamily { name: contrasts[members[0]].family_name.clone(), members }
            }));
        }
    }
    families.retain(|family| !family.members.is_empty());
    families
}
