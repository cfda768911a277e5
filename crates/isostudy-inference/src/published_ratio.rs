//! The published aspect ratio's moments as the original program takes them.
//!
//! It counts a degenerate triangle with ratio 0. Found from its two outliers: the sphere's unclustered means and
//! standard deviations agree to 2 parts in 10^8 this way, and to no more than 2 in 10^3 when they are left out.

use isostudy_design::record::Quality;

/// Mean with degenerate triangles counted as 0; `None` if no triangle has a ratio.
pub fn mean(quality: &Quality) -> Option<f64> {
    Some(share(quality)? * quality.published_aspect_ratio.mean)
}

/// Population standard deviation with degenerate triangles counted as 0; `None` if no triangle has a ratio.
pub fn sd(quality: &Quality) -> Option<f64> {
    let share = share(quality)?;
    let (m, s) = (quality.published_aspect_ratio.mean, quality.published_aspect_ratio.sd);
    // E[x^2] - E[x]^2 over all triangles, rearranged so that nothing cancels.
    Some((share * (s * s + m * m * (1.0 - share))).sqrt())
}

/// The share of triangles that have a ratio; `None` if none has.
fn share(quality: &Quality) -> Option<f64> {
    let with = quality.published_aspect_ratio.count as f64;
    (with > 0.0).then(|| with / (with + quality.degenerate as f64))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture;

    #[test]
    fn zeros_join_the_moments() {
        // ss_bu as extracted: 240 degenerate of 101,720; published 775.931408 and 12057.925607.
        let mut quality = fixture::meshes(&fixture::study())[0].quality.clone();
        quality.degenerate = 240;
        let ratio = &mut quality.published_aspect_ratio;
        (ratio.count, ratio.mean, ratio.sd) = (101_480, 777.766_472_612_467_4, 12_072.116_314_429_564);
        let moments = |quality: &Quality| (mean(quality).unwrap(), sd(quality).unwrap());
        let (as_published, sd_as_published) = moments(&quality);
        assert!((as_published - 775.931_408).abs() < 2e-5, "{as_published}");
        assert!((sd_as_published - 12_057.925_607).abs() < 3e-4, "{sd_as_published}");
        quality.degenerate = 0;
        assert_eq!(moments(&quality), (777.766_472_612_467_4, 12_072.116_314_429_564));
        quality.published_aspect_ratio.count = 0;
        assert_eq!((mean(&quality), sd(&quality)), (None, None));
    }
}
