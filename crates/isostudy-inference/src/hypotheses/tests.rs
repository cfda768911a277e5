//! Costen's 486 answers, tested, against numbers that were computed apart from this program, each to its printed digit.

use super::*;
use crate::fixture;
use isostudy_statistics::interval::Interval;
use isostudy_statistics::sign_test;

fn tested(name: &str, scope: &str) -> ScoreTest {
    let study = fixture::study();
    let all = of_contrasts(&study, &fixture::answered(&study).declared, None);
    let found: Vec<_> = all.into_iter().filter(|h| h.contrast == name && h.scope == scope).collect();
    assert_eq!(found.len(), 1, "{name} {scope}");
    found[0].test.clone()
}

#[track_caller]
fn prints(value: f64, want: &str) {
    let decimals = want.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    assert_eq!(format!("{value:.decimals$}"), want, "{value}");
}

#[test]
fn counts() {
    let cases = [
        ("U-I", "within B", [7, 1, 46]),
        ("U-I", "within S", [7, 1, 46]),
        ("U-P", "within B", [10, 1, 43]),
        ("U-P", "within S", [18, 1, 35]),
        ("P-I", "within B", [15, 17, 22]),
        ("P-I", "within S", [3, 6, 45]),
        ("B-S", "within U", [36, 8, 10]),
        ("B-S", "within I", [20, 7, 27]),
        ("B-S", "within P", [28, 7, 19]),
        ("B-S", "all", [84, 22, 56]),
        ("B-S", "sphere", [44, 5, 5]),
    ];
    for (name, scope, counts) in cases {
        assert_eq!(tested(name, scope).counts, Some(counts), "{name} {scope}");
    }
}

#[test]
fn sign_flip_of_the_pooled_contrasts() {
    let cases =
        [("B-S", 28, "0.00940"), ("U-I", -78, "0.00033"), ("U-P", -50, "0.00259"), ("P-I", -49, "0.00009")];
    for (name, net, p) in cases {
        let test = tested(name, "all");
        let [first, _, second] = test.counts.unwrap();
        assert_eq!(first as i64 - second as i64, net);
        prints(test.sign_flip.p(), p);
    }
    prints(sign_test::binomial(84, 56), "0.0222");
}

#[test]
fn sign_flip_of_arrangements_within_clusterings() {
    for (scope, p) in [("within U", "0.00563"), ("within I", "0.30530"), ("within P", "0.29755")] {
        prints(tested("B-S", scope).sign_flip.p(), p);
    }
}

#[test]
fn mean_score_with_its_interval() {
    let test = tested("B-S", "all");
    let Interval { low, high } = test.interval.unwrap();
    prints(test.mean, "0.173");
    prints(low, "0.056");
    prints(high, "0.290");
}

#[test]
fn holm_over_the_nine_group_contrasts() {
    let study = fixture::study();
    let all = of_contrasts(&study, &fixture::answered(&study).declared, None);
    let own: Vec<&Hypothesis> = all.iter().filter(|h| h.family == "groups").collect();
    let names: Vec<String> = own.iter().map(|h| format!("{} {}", h.contrast, h.scope)).collect();
    let adjusted: Vec<f64> = own.iter().map(|h| h.adjusted).collect();
    assert_eq!(own.len(), 9);
    let want = [
        ("U-I within B", "0.0027"),
        ("U-P within B", "0.0071"),
        ("P-I within B", "0.8243"),
        ("U-I within S", "0.0044"),
        ("U-P within S", "0.2381"),
        ("P-I within S", "0.0003"),
        ("B-S within U", "0.0282"),
        ("B-S within I", "0.8243"),
        ("B-S within P", "0.8243"),
    ];
    for (name, p) in want {
        prints(adjusted[names.iter().position(|n| n == name).unwrap()], p);
    }
}

#[test]
fn leave_one_out_range() {
    let p = tested("B-S", "all").leave_one_out();
    prints(p.iter().copied().fold(1.0, f64::min), "0.0063");
    prints(p.iter().copied().fold(0.0, f64::max), "0.0188");
}

#[test]
fn corrections_over_all_tests_leave_eleven_of_fourteen() {
    // The 25 contrasts of the paper's own families, Holm over all of them, computed apart: these three are lost.
    let study = fixture::study();
    let all = of_contrasts(&study, &fixture::answered(&study).declared, None);
    assert!(all.iter().all(|h| h.adjusted_over_all.unwrap() >= h.adjusted));
    let of = |name: &str, scope: &str| {
        all.iter().find(|h| h.contrast == name && h.scope == scope).unwrap().adjusted_over_all.unwrap()
    };
    assert!(of("B-S", "all") > 0.05 && of("B-S", "within U") > 0.05 && of("U-I", "all") < 0.05);
}

#[test]
fn what_a_study_declares_decides() {
    let rules = "[analysis]\ndeclared = \"2026-11-21\"\nlevel = 0.01\nmargin = 0.3\nfamilies = \"one\"\nprimary = [\"B-S\"]\n";
    let text = std::fs::read_to_string(fixture::paper_path()).unwrap();
    let own = text.split("[analysis]").nth(1).map(|rest| {
        let end = rest.find("\n[").map_or(rest.len(), |at| at + 1);
        format!("[analysis]{}", &rest[..end])
    });
    let study = fixture::study_with(&[(&own.expect("the paper's study has the section"), rules)]);
    let all = of_contrasts(&study, &fixture::answered(&study).declared, None);
    assert_eq!((all[0].family.as_str(), all[0].contrast.as_str(), all[0].family_size), ("primary", "B-S", 1));
    // Alone in its family: p as it is.
    prints(all[0].adjusted, "0.00940");
    assert!(all[1..].iter().all(|h| h.family != "primary" && h.family_size == all.len() - 1));
    assert_eq!((all[0].rules.level, all[0].rules.margin), (0.01, 0.3));
    assert!(all[0].differs());
}
