//! p values of several tests asked at once.

/// Holm's step-down adjustment (1979, Scand. J. Statist. 6:65): controls the chance of any false rejection within the
/// family, under any dependence. Adjusted p values in the order given, at most 1.
pub fn holm(p: &[f64]) -> Vec<f64> {
    let mut adjusted = vec![0.0; p.len()];
    let mut largest: f64 = 0.0;
    for (rank, &i) in ascending(p).iter().enumerate() {
        largest = largest.max((p.len() - rank) as f64 * p[i]).min(1.0);
        adjusted[i] = largest;
    }
    adjusted
}

/// Benjamini and Hochberg's step-up adjustment (1995, J. R. Statist. Soc. B 57:289): controls the expected share of
/// false rejections, for independent or positively dependent tests. Adjusted p values in the order given.
pub fn benjamini_hochberg(p: &[f64]) -> Vec<f64> {
    let mut adjusted = vec![0.0; p.len()];
    let mut smallest: f64 = 1.0;
    for (rank, &i) in ascending(p).iter().enumerate().rev() {
        smallest = smallest.min(p.len() as f64 / (rank + 1) as f64 * p[i]);
        adjusted[i] = smallest;
    }
    adjusted
}

fn ascending(p: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..p.len()).collect();
    order.sort_by(|&a, &b| p[a].total_cmp(&p[b]));
    order
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn as_r_adjusts() {
        // R 4.2.2: p <- c(.01,.04,.03,.005,.5,.04); p.adjust(p, "holm"); p.adjust(p, "BH")
        let p = [0.01, 0.04, 0.03, 0.005, 0.5, 0.04];
        let close = |got: Vec<f64>, want: [f64; 6]| got.iter().zip(want).all(|(g, w)| (g - w).abs() < 1e-12);
        assert!(close(holm(&p), [0.05, 0.12, 0.12, 0.03, 0.5, 0.12]), "{:?}", holm(&p));
        let got = benjamini_hochberg(&p);
        assert!(close(got.clone(), [0.03, 0.048, 0.048, 0.03, 0.5, 0.048]), "{got:?}");
        assert!(holm(&[]).is_empty() && benjamini_hochberg(&[]).is_empty());
    }

    proptest! {
        #[test]
        fn never_below_p_and_in_its_order(p in prop::collection::vec(0.0..=1.0f64, 1..12)) {
            for adjusted in [holm(&p), benjamini_hochberg(&p)] {
                for i in 0..p.len() {
                    prop_assert!(p[i] <= adjusted[i] + 1e-15 && adjusted[i] <= 1.0);
                    prop_assert!((0..p.len()).all(|j| p[i] > p[j] || adjusted[i] <= adjusted[j]));
                }
            }
            let (holm, bh) = (holm(&p), benjamini_hochberg(&p));
            prop_assert!(holm.iter().zip(&bh).all(|(holm, bh)| *bh <= holm + 1e-15));
        }
    }
}
