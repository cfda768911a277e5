use super::*;
use crate::fixture::{self, Everything};

fn find<'a>(all: &'a [Compared], row: &str, quantity: &str) -> &'a Compared {
    all.iter().find(|c| c.row == row && c.quantity == quantity).unwrap()
}

fn compared(everything: &Everything) -> Vec<Compared> {
    all(&everything.inputs())
}

#[test]
fn all_preference_cells_agree_and_two_are_named() {
    let all = compared(&Everything::of(fixture::study()));
    let cells: Vec<&Compared> = all.iter().filter(|c| c.source == "preferences").collect();
    assert_eq!(cells.len(), 12 + 6 + 5);
    for cell in &cells {
        assert!((cell.ours.unwrap() - cell.published).abs() <= 0.001, "{cell:?}");
    }
    let off: Vec<(&str, &str)> = cells
        .iter()
        .filter(|c| c.verdict != Verdict::Equal)
        .map(|c| (c.row.as_str(), c.verdict.reason()))
        .collect();
    assert_eq!(
        off,
        [
            ("B bi", "printed 0.419; 68/162 = 0.41975 rounds to 0.420"),
            ("su", "printed 0.339; 25/162 + 10/54 = 0.33951 rounds to 0.340"),
        ]
    );
    assert!(cells.iter().all(|c| matches!(c.verdict, Verdict::Equal | Verdict::WithinTolerance { .. })));
}

#[test]
fn known_errors_of_the_published_benchmark_are_explained() {
    let all = compared(&Everything::of(fixture::study()));
    assert_eq!(find(&all, "ss_bi", "vertices").verdict, Verdict::Equal);
    assert_eq!(find(&all, "ss_bi", "discard_fraction_as_published").verdict, Verdict::Equal);
    let reason = |row, quantity| find(&all, row, quantity).verdict.reason().to_owned();
    assert_eq!(
        reason("as_bi", "discarded_triangles"),
        "our re-run of the published count exceeds the true one by 13454: triangles counted twice when q1 = q2"
    );
    assert_eq!(reason("ss_si", "needed_samples"), "the published formula has a wrong sign");
    assert_eq!(reason("bs_sp", "needed_edges"), "the published formula has a wrong sign");
    assert!(reason("ss_su", "aspect_ratio_mean").starts_with("96 degenerate triangles counted as ratio 0"));
    assert_eq!(find(&all, "ss_su", "aspect_ratio_mean_as_published").verdict, Verdict::Equal);
    assert_eq!(find(&all, "ss_su", "aspect_ratio_sd_as_published").verdict, Verdict::Equal);
    assert_eq!(find(&all, "bs_bi", "aspect_ratio_mean_as_published").verdict.label(), "within 3 %");
    assert_eq!(reason("bs_bi", "aspect_ratio_mean_as_published"), "another bunny mesh");
    assert_eq!(find(&all, "ss_bu", "vertex_s").verdict.label(), "not comparable");
    assert!(reason("ss_bu", "vertex_s").contains("Example CPU"));
    let unexplained: Vec<&Compared> =
        all.iter().filter(|c| c.verdict.reason().contains("not explained")).collect();
    assert!(unexplained.is_empty(), "{unexplained:?}");
}

#[test]
fn an_unknown_difference_is_not_explained_away() {
    let mut everything = Everything::of(fixture::study());
    everything.meshes[0].counts.vertices += 100; // the sphere, unclustered
    let last = everything.meshes.iter_mut().find(|m| m.id.to_string() == "bs_bi").unwrap();
    last.counts.triangles = last.counts.triangles * 11 / 10;
    everything.bench.differences.clear();
    let all = compared(&everything);
    assert_eq!(find(&all, "ss_bu", "vertices").verdict, Verdict::differs("not explained: 0.197 % off"));
    assert_eq!(find(&all, "bs_bi", "triangles").verdict, Verdict::differs("another bunny mesh: 10.0 % off"));
    assert_eq!(find(&all, "ss_bu", "vertex_s").verdict, Verdict::differs("46 % off on a matching machine"));
}

#[test]
fn what_is_not_explained_is_listed() {
    let mut everything = Everything::of(fixture::study());
    let listed = |everything: &Everything| {
        crate::Paper::of(&isostudy_inference::Results::of(&everything.inputs())).unexplained_differences()
    };
    assert_eq!(listed(&everything), Vec::<String>::new());
    everything.meshes[0].counts.vertices += 100;
    let claims = &mut everything.study.published.claims;
    claims.iter_mut().find(|claim| claim.id == "favourite").unwrap().value = Some(1.2);
    let listed = listed(&everything);
    assert_eq!(listed.len(), 2, "{listed:?}");
    let vertices = "benchmark, ss_bu, vertices: 50865 published, 50965 here; not explained: 0.197 % off";
    assert_eq!(listed[0], vertices);
    assert!(listed[1].starts_with("claims, favourite, The favourite is"), "{listed:?}");
    assert!(listed[1].ends_with(": 1.200 published, 1.062 here; not explained"), "{listed:?}");
}

#[test]
fn another_resolution_is_not_compared() {
    let mut everything = Everything::of(fixture::study());
    let mesh = &mut everything.meshes[0];
    (mesh.cells, mesh.counts.vertices) = ([20, 20, 20], 2180);
    let all = compared(&everything);
    assert_eq!(
        find(&all, "ss_bu", "vertices").verdict,
        Verdict::not_comparable("this study has 20x20x20 cubes")
    );
}

#[test]
fn the_summary_adds_up() {
    let everything = Everything::of(fixture::study());
    let tables = tables("Costen", &all(&everything.inputs()));
    let counted: i64 = tables[0]
        .rows
        .iter()
        .map(|row| match row[2] {
            Cell::Count(n) => n,
            _ => panic!("a count"),
        })
        .sum();
    assert_eq!(counted as usize, tables[1].rows.len());
}
