use super::*;

/// Everybody once.
const ALL: [u64; 7] = [1; 7];

const SCORES: [f64; 7] = [0.1, 0.7, 0.3, 0.2, 0.9, -0.2, 0.15];

#[test]
fn percentile_near_scipys_bootstrap() {
    // scipy.stats.bootstrap((x,), np.mean, n_resamples=200000, method="percentile", rng=default_rng(1)): 0.0643 to 0.5714.
    let resampling = Resampling { resamples: 40_000, seed: 7 };
    let BootstrapInterval { interval, without_estimate } =
        percentile(&ALL, resampling, |w| mean(&SCORES, w)).unwrap();
    assert!((interval.low - 0.0643).abs() < 0.01 && (interval.high - 0.5714).abs() < 0.01, "{interval:?}");
    assert_eq!(without_estimate, 0);
}

#[test]
fn the_same_for_any_number_of_threads() {
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            percentile(&ALL, Resampling { resamples: 500, seed: 3 }, |w| mean(&SCORES, w)).unwrap()
        })
    };
    assert_eq!(run(1), run(2));
    let other = percentile(&ALL, Resampling { resamples: 500, seed: 4 }, |w| mean(&SCORES, w)).unwrap();
    assert_ne!(run(1), other);
}

#[test]
fn studentised_of_a_mean_by_enumeration() {
    // Two scores: a resample is one of four; where both draws are the same, the error is 0 and there is no pivot. The
    // others repeat the sample itself: every pivot is 0, and the interval shrinks to the mean.
    let scores = [0.0, 1.0];
    let resampling = Resampling { resamples: 4000, seed: 1 };
    let statistic = |weights: &[u64]| mean_and_error(&scores, weights);
    match studentised(&[1, 1], resampling, statistic) {
        Some(found) => {
            assert_eq!((found.interval.low, found.interval.high), (0.5, 0.5));
            assert!(found.without_estimate <= 2000);
        }
        // A shade more than half had no error.
        None => assert!(replicates(&[1, 1], resampling, |w| (w[0] == w[1]).then_some(())).len() < 2000),
    }
    assert_eq!(studentised(&[1, 1], resampling, |_| Some((1.0, 0.0))), None);
}

#[test]
fn studentised_is_close_to_t_for_even_scores() {
    let scores: Vec<f64> = (0..40).map(|i| f64::from(i % 10) / 10.0).collect();
    let found =
        studentised(&[1; 40], Resampling { resamples: 20_000, seed: 5 }, |d| mean_and_error(&scores, d))
            .unwrap();
    let t = crate::interval::t_over_respondents(&scores).unwrap();
    assert!(
        (found.interval.low - t.low).abs() < 0.01 && (found.interval.high - t.high).abs() < 0.01,
        "{found:?} {t:?}"
    );
    let shifted: Vec<f64> = scores.iter().map(|score| -score).collect();
    let other =
        studentised(&[1; 40], Resampling { resamples: 20_000, seed: 5 }, |d| mean_and_error(&shifted, d))
            .unwrap();
    assert!((found.interval.low + other.interval.high).abs() < 1e-12);
}

#[test]
fn resamples_without_an_estimate_are_counted() {
    assert_eq!(percentile(&ALL, Resampling::default(), |_| None), None);
    let without = |weights: &[u64]| mean_and_error(&SCORES, weights).filter(|_| weights[0] > 0);
    let found = studentised(&ALL, Resampling { resamples: 10_000, seed: 2 }, without).unwrap();
    // (6/7)^7 = 0.3399 of the resamples miss one given participant.
    assert!((found.without_estimate as f64 / 10_000.0 - 0.3399).abs() < 0.02, "{found:?}");
}

#[test]
fn kinds_of_participants_are_participants() {
    // Twice the same scores: as two of each kind, and as fourteen single people. Other draws, the same distribution.
    let twice: Vec<f64> = SCORES.iter().chain(&SCORES).copied().collect();
    let (values, counts) = kinds(&twice);
    assert_eq!((values.len(), counts.as_slice()), (7, [2; 7].as_slice()));
    let resampling = Resampling { resamples: 40_000, seed: 9 };
    let of = |values: &[f64], counts: &[u64]| {
        percentile(counts, resampling, |w| mean(values, w)).unwrap().interval
    };
    let (kinds, people) = (of(&values, &counts), of(&twice, &[1; 14]));
    assert!((kinds.low - people.low).abs() < 0.006 && (kinds.high - people.high).abs() < 0.006);
    let (_, error) = mean_and_error(&values, &counts).unwrap();
    // numpy.std(twice, ddof=1) / sqrt(14)
    assert!((error - mean_and_error(&twice, &[1; 14]).unwrap().1).abs() < 1e-15);
}
