use super::*;

/// Everybody once.
const ALL: [u64; 7] = [1; 7];

const SCORES: [f64; 7] = [0.1, 0.7, 0.3, 0.2, 0.9, -0.2, 0.15];

#[test]
fn bca_ends_as_numpy_and_scipy_have_them() {
    // z0 = norm.ppf((sum(rep < est) + sum(rep == est) / 2) / 20), a = sum(d^3) / (6 sum(d^2)^1.5), d = mean(jk) - jk;
    // numpy.quantile(rep, norm.cdf(z0 + (z0 + z) / (1 - a (z0 + z)))) for z = norm.ppf([.025, .975]).
    let replicates = [
        0.12, 0.5, 0.31, 0.44, 0.27, 0.38, 0.61, 0.2, 0.33, 0.29, 0.41, 0.36, 0.47, 0.05, 0.55, 0.31, 0.31,
        0.4, 0.22, 0.35,
    ];
    let others = |out: usize| (0..7).map(|i| u64::from(i != out)).collect::<Vec<_>>();
    let jackknife: Vec<(f64, u64)> = (0..7).map(|out| (mean(&SCORES, &others(out)).unwrap(), 1)).collect();
    let interval = bca_interval(replicates.to_vec(), 2.15 / 7.0, &jackknife).unwrap();
    assert!((interval.low - 0.052_877_122_492_613_64).abs() < 1e-9, "{interval:?}");
    assert!((interval.high - 0.465_189_215_521_738).abs() < 1e-9, "{interval:?}");
    assert_eq!(bca_interval(vec![0.5; 9], 0.2, &jackknife), None);
}

#[test]
fn bca_near_scipys_bootstrap() {
    // scipy.stats.bootstrap((x,), np.mean, n_resamples=200000, method="BCa", rng=default_rng(1)): 0.0786 to 0.6000.
    let resampling = Resampling { resamples: 40_000, seed: 7 };
    let BootstrapInterval { interval, without_estimate } =
        bca(&ALL, resampling, |w| mean(&SCORES, w)).unwrap();
    assert!((interval.low - 0.0786).abs() < 0.01 && (interval.high - 0.6).abs() < 0.01, "{interval:?}");
    assert_eq!(without_estimate, 0);
}

#[test]
fn the_same_for_any_number_of_threads() {
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| bca(&ALL, Resampling { resamples: 500, seed: 3 }, |w| mean(&SCORES, w)).unwrap())
    };
    assert_eq!(run(1), run(2));
    let other = bca(&ALL, Resampling { resamples: 500, seed: 4 }, |w| mean(&SCORES, w)).unwrap();
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
    let picky = |weights: &[u64]| mean(&SCORES, weights).filter(|_| weights[0] > 0);
    // The jackknife leaves participant 0 out once, and has no value there.
    assert_eq!(bca(&ALL, Resampling::default(), picky), None);
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
    let of = |values: &[f64], counts: &[u64]| bca(counts, resampling, |w| mean(values, w)).unwrap().interval;
    let (kinds, people) = (of(&values, &counts), of(&twice, &[1; 14]));
    assert!((kinds.low - people.low).abs() < 0.006 && (kinds.high - people.high).abs() < 0.006);
    let (_, error) = mean_and_error(&values, &counts).unwrap();
    // numpy.std(twice, ddof=1) / sqrt(14)
    assert!((error - mean_and_error(&twice, &[1; 14]).unwrap().1).abs() < 1e-15);
    let two = |w: &[u64]| mean(&values, w).map(|m| vec![m, -m]);
    let each = bca_each(&counts, resampling, two).unwrap();
    assert_eq!(each[0].unwrap().interval, kinds);
    let mirrored = each[1].unwrap().interval;
    assert!((mirrored.low + kinds.high).abs() < 1e-4 && (mirrored.high + kinds.low).abs() < 1e-4);
}
