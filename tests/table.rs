//! `isostudy table` as a user runs it.

use crate::command::{Folder, Run};
use serde_json::Value as Json;

fn groups(folder: &Folder, more: &[&str]) -> Json {
    let said = folder.succeed(&[&["table"], more, &["--groups", "--json"]].concat());
    serde_json::from_str(&said.stdout).unwrap()
}

/// Numbers of groups, of triangles, of triangles that are paths in space, and of entries that have one.
fn census(report: &Json) -> [u64; 4] {
    let groups = report["groups"].as_array().unwrap();
    let bad = groups.iter().filter(|group| group["path"] == true);
    let sum = |key: &str| bad.clone().map(|group| group[key].as_u64().unwrap()).sum();
    [groups.len() as u64, report["triangles"].as_u64().unwrap(), sum("triangles"), sum("entries")]
}

#[test]
fn tables_have_the_known_groups() {
    let folder = Folder::new();
    assert_eq!(census(&groups(&folder, &["mc-edge-groups"])), [8, 820, 56, 28]);
    assert_eq!(census(&groups(&folder, &["hull"])), [8, 836, 80, 52]);
    // Fans take what comes.
    let [of, triangles, bad, _] = census(&groups(&folder, &["mc"]));
    assert!((of, triangles) == (8, 820) && bad > 2 * 56, "{bad}");
    // A tetrahedron has a triangle in 8 patterns and two in 6.
    for (name, of, cells) in [("bu", 4, 12), ("su", 10, 6)] {
        let report = groups(&folder, &[name]);
        let found = census(&report);
        assert_eq!((found[0], found[1], report["cells"].as_u64()), (of, 20 * cells, Some(cells)), "{name}");
    }
    let refused = Run::of(folder.isostudy().args(["table", "mc33"]));
    assert!(refused.code == Some(2) && refused.stderr.contains("samples decide"), "{}", refused.stderr);
    let refused = Run::of(folder.isostudy().args(["table", "nothing"]));
    assert!(refused.code == Some(2) && refused.stderr.contains("mc-edge-groups"), "{}", refused.stderr);
}

/// As many triangles as the extractor makes, and the bad kind among the worst: less so where diagonals avoid it.
#[test]
fn the_worst_triangles_of_a_field_are_of_the_bad_group() {
    let folder = Folder::new();
    let ball =
        ["--field", "sqrt(x^2+y^2+z^2) - 0.983", "--bounds=-1.2,-1.2,-1.2,1.2,1.2,1.2", "--spacing", "0.04"];
    let mut shares = Vec::new();
    for name in ["mc", "mc-edge-groups", "bu"] {
        let report = groups(&folder, &[&[name], &ball[..]].concat());
        let worst = &report["worst"];
        let list = |key: &str| {
            worst[key].as_array().unwrap().iter().map(|n| n.as_u64().unwrap()).collect::<Vec<u64>>()
        };
        let all = list("all_by_group");
        assert_eq!(list("by_group").iter().sum::<u64>(), 1000);
        assert_eq!(all.iter().sum::<u64>(), worst["triangles"].as_u64().unwrap());
        let extract = ["extract", "-o", "ball.ply", "--json", "--method", name];
        let said = folder.succeed(&[&extract, &ball[..]].concat());
        let mesh: Json = serde_json::from_str(&said.stdout).unwrap();
        assert_eq!(mesh["quality"]["triangles"], worst["triangles"], "{name}");
        let bad = report["groups"].as_array().unwrap().iter().zip(list("by_group"));
        shares.push(bad.filter(|(group, _)| group["path"] == true).map(|(_, n)| n).sum::<u64>());
    }
    assert!(shares[0] > 2 * shares[1], "{shares:?}");
}

/// A box for each table, and one for each kind of those that have kinds; both file formats.
#[test]
fn a_figure_shows_every_table_that_is_named() {
    let folder = Folder::new();
    let names = ["table", "mc", "mc-quality", "bu", "--groups"];
    let ball =
        ["--field", "sqrt(x^2+y^2+z^2) - 0.983", "--bounds=-1.2,-1.2,-1.2,1.2,1.2,1.2", "--spacing", "0.1"];
    folder.succeed(&[&names[..], &ball[..], &["--figure", "groups.svg"]].concat());
    let svg = folder.read("groups.svg");
    for (text, count) in [(">mc<", 2), (">mc-quality<", 1), (">bu<", 2), (">share of the worst<", 1)] {
        let flat = svg.replace(char::is_whitespace, "");
        assert_eq!(flat.matches(&text.replace(' ', "")).count(), count, "{text}");
    }
    folder.succeed(&[&names[..], &ball[..], &["--figure", "groups.png"]].concat());
    let refused = Run::of(folder.isostudy().args(names).args(ball).args(["--figure", "groups.jpg"]));
    assert!(refused.code == Some(2) && refused.stderr.contains(".png or .svg"), "{}", refused.stderr);
    let refused = Run::of(folder.isostudy().args(names));
    assert!(refused.code == Some(2) && refused.stderr.contains("--figure"), "{}", refused.stderr);
}

#[test]
fn a_table_in_a_file_is_checked() {
    let folder = Folder::new();
    let said = folder.succeed(&["table", "mc", "--json"]);
    folder.write("mine.json", &said.stdout);
    let said = folder.succeed(&["table", "mine.json"]);
    assert!(said.stdout.contains("256 entries each, 820 triangles; neighbours agree"), "{}", said.stdout);
    let report = groups(&folder, &["mine.json"]);
    assert_eq!(report["groups"], groups(&folder, &["mc"])["groups"]);
    // A hole: the triangle of one corner is gone.
    let table: Json = serde_json::from_str(&folder.read("mine.json")).unwrap();
    let mut broken = table;
    broken["entries"][1] = Json::Array(Vec::new());
    folder.write("mine.json", broken.to_string());
    let refused = Run::of(folder.isostudy().args(["table", "mine.json"]));
    assert_eq!(refused.code, Some(2));
    assert!(refused.stderr.contains("mine.json") && refused.stderr.contains("entry 1"), "{}", refused.stderr);
}
