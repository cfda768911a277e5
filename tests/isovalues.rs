//! `isostudy extract --isovalues`: the files are those of one isovalue after another, and each line tells what was found.

use crate::command::Folder;

/// Noise of whole numbers, with steps of unequal lengths.
fn volume(folder: &Folder, name: &str, directions: &str) {
    let sizes = [21, 18, 12];
    let mut state = 7u32;
    let samples: Vec<String> = (0..sizes.iter().product())
        .map(|_| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 28).to_string()
        })
        .collect();
    let header = format!(
        "NRRD0004\ntype: short\ndimension: 3\nsizes: 21 18 12\nencoding: text\nspace dimension: 3\n\
         space directions: {directions}\nspace origin: (1,2,3)\n\n"
    );
    folder.write(name, header + &samples.join(" ") + "\n");
}

const UNEQUAL: &str = "(1,0,0) (0,1.5,0) (0,0,2)";
const TURNED: &str = "(0.6,0.8,0) (-0.8,0.6,0) (0,0,1)";

#[test]
fn files_are_those_of_one_isovalue_each() {
    let folder = Folder::of("extract");
    volume(&folder, "noise.nrrd", UNEQUAL);
    volume(&folder, "turned.nrrd", TURNED);
    let bytes = |name: &str| std::fs::read(folder.path(name)).unwrap();
    // Samples are 0 to 15: on them and between them.
    let isovalues = ["5", "7", "9", "7.5"];
    let options: [&[&str]; 8] = [
        &["--method", "mc"],
        &["--method", "snapmc", "--threads", "3"],
        &["--method", "nets-manifold"],
        &["--method", "mc33", "--inside", "below"],
        &["--method", "mc", "--close"],
        &["--method", "mc", "--spacing", "0.8"],
        &["--method", "bi"],
        &["--method", "dc", "--inside", "below", "--close"],
    ];
    for (file, options) in
        ["noise.nrrd", "turned.nrrd"].iter().flat_map(|file| options.iter().map(move |of| (file, of)))
    {
        let all = ["--volume", file, "--isovalues", "5:9:3,7.5", "-o", "all-{isovalue}.ply"];
        let said = folder.succeed(&[&all[..], *options].concat()).stdout;
        let lines: Vec<&str> = said.lines().collect();
        assert_eq!(lines.len(), isovalues.len(), "{said}");
        for (isovalue, line) in isovalues.iter().zip(lines) {
            let level = format!("--isovalue={isovalue}");
            folder.succeed(&[&["--volume", file, &level, "-o", "one.ply"], *options].concat());
            let name = format!("all-{isovalue}.ply");
            assert_eq!(bytes(&name), bytes("one.ply"), "{file} {options:?} {isovalue}");
            for part in
                [&format!("{name}: "), " triangles, ", " cells visited, search ", " ms, triangles ", " ms"]
            {
                assert!(line.contains(part), "{line}: {part}");
            }
        }
    }
}

#[test]
fn programs_are_told_the_same_in_json() {
    let folder = Folder::of("extract");
    volume(&folder, "noise.nrrd", UNEQUAL);
    let options = ["--method", "mc", "-o", "a-{isovalue}.ply", "--json"];
    let said =
        folder.succeed(&[&["--volume", "noise.nrrd", "--isovalues", "7.5,15,-3"], &options[..]].concat());
    let report: serde_json::Value = serde_json::from_str(&said.stdout).unwrap();
    let surfaces = report["surfaces"].as_array().unwrap();
    assert!(report["ranges"]["bytes"].as_u64().unwrap() > 0 && surfaces.len() == 3);
    assert_eq!(surfaces[0]["file"], "a-7.5.ply");
    assert!(surfaces[0]["triangles"].as_u64().unwrap() > 1000);
    assert!(surfaces[0]["cells_visited"].as_u64().unwrap() > 1000);
    // No sample is above the greatest, and none is at or below what is below the least.
    for surface in &surfaces[1..] {
        assert!(surface["file"].is_null() && surface["triangles"] == 0 && surface["cells_visited"] == 0);
    }
    assert!(!folder.path("a-15.ply").exists() && !folder.path("a--3.ply").exists());
}

#[test]
fn what_cannot_be_is_refused() {
    let folder = Folder::of("extract");
    volume(&folder, "noise.nrrd", UNEQUAL);
    let refused = |more: &[&str], said: &str| {
        let run = folder.run(&[&["--volume", "noise.nrrd"], more].concat());
        assert!(run.code == Some(2) && run.stderr.contains(said), "{more:?}: {}", run.stderr);
    };
    refused(&["--isovalues", "1,2", "-o", "a.ply"], "{isovalue} must stand where each isovalue goes");
    refused(&["--isovalues", "1,2", "-o", "a-{isovalue}.png"], "known endings");
    refused(&["--isovalues", "1,1", "-o", "a-{isovalue}.ply"], "1 is there twice");
    refused(
        &["--isovalues", "99,-99", "-o", "a-{isovalue}.ply"],
        "no surface at any of 2 isovalues; the volume's samples run from 0 to 15",
    );
    refused(&["--isovalues", "1", "--isovalue", "2", "-o", "a-{isovalue}.ply"], "cannot be used with");
    refused(&["--isovalues", "1", "--quality", "-o", "a-{isovalue}.ply"], "cannot be used with");
    refused(&["-o", "a.ply"], "--isovalue");
}
