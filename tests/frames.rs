//! `isostudy extract --frames` and `--between`, as a user runs them: one series by both routes, what is said, what is refused.

use crate::command::Folder;
use isostudy_mesh::MeshFormat;
use isostudy_mesh::topology::topology;
use std::fs;

/// Samples along each axis, and frames.
const N: usize = 7;

/// A ball that grows and shrinks, as text.
fn frame(time: usize) -> String {
    let square = |i: usize| (i as f32 - 3.0).powi(2);
    let value = |n: usize| 5.5 - square(n % N) - square(n / N % N) - square(n / N / N) - square(time);
    (0..N.pow(3)).map(|n| format!("{} ", value(n))).collect()
}

fn nrrd(sizes: &str, data: &str) -> String {
    let dimension = sizes.split(' ').count();
    format!("NRRD0004\ntype: float\ndimension: {dimension}\nsizes: {sizes}\nencoding: text\n\n{data}\n")
}

/// The series in files `f0.nrrd` to `f6.nrrd`, and in `all.nrrd`.
fn series(folder: &Folder) -> String {
    let frames: Vec<String> = (0..N).map(frame).collect();
    let names: Vec<String> = (0..N).map(|n| format!("f{n}.nrrd")).collect();
    names.iter().zip(&frames).for_each(|(name, data)| folder.write(name, nrrd("7 7 7", data)));
    folder.write("all.nrrd", nrrd("7 7 7 7", &frames.concat()));
    names.join(",")
}

#[test]
fn a_series_of_files_is_one_of_four_axes() {
    let folder = Folder::of("extract");
    let names = series(&folder);
    let slice = |frames: &str, time: &str, out: &str| {
        let said = folder.succeed(&["--frames", frames, "--isovalue", "0", "--time", time, "-o", out]);
        assert_eq!(said.stdout, format!("{out}\n"));
        fs::read(folder.path(out)).unwrap()
    };
    for time in ["3", "2.25"] {
        let bytes = slice(&names, time, "a.ply");
        assert!(bytes == slice("all.nrrd", time, "b.ply"), "{time}");
        let report = topology(&MeshFormat::Ply.read(&*bytes).unwrap());
        assert!(report.is_closed_manifold() && report.euler_characteristic == 2, "{report:?}");
    }
    let said = folder.succeed(&["--frames", "all.nrrd", "--isovalue", "0", "--times", "5", "-o", "m.ply"]);
    // There is nothing at the ends.
    assert_eq!(said.stdout, "m_0001.ply\nm_0002.ply\nm_0003.ply\n");
    assert!(said.stderr.contains("no surface at isovalue 0 at time 0, no file"), "{}", said.stderr);
    folder.succeed(&["--frames", "all.nrrd", "--isovalue", "0", "-o", "st.vtk"]);
    // A contour of time is a slice.
    folder.succeed(&["--grid", "st.vtk", "--array", "time", "--isovalue", "2.25", "-o", "contour.ply"]);
}

#[test]
fn a_solid_between_two_isovalues_is_a_grid() {
    let folder = Folder::of("extract");
    series(&folder);
    let said = folder.succeed(&["--volume", "f3.nrrd", "--between", "0,3.5", "-o", "solid.vtk"]);
    assert_eq!(said.stdout, "solid.vtk\n");
    assert!(said.stderr.contains(" tetrahedra, of volume "), "{}", said.stderr);
    folder.succeed(&["--grid", "solid.vtk", "--array", "value", "--isovalue", "1.7", "-o", "middle.ply"]);
}

#[test]
fn what_cannot_be_taken_is_told() {
    let folder = Folder::of("extract");
    let names = series(&folder);
    folder.write("small.nrrd", nrrd("6 7 7", "0 ".repeat(6 * 49).trim()));
    folder.write("nan.nrrd", nrrd("7 7 7", &frame(3).replace(" 5.5 ", " nan ")));
    folder.write("one.nrrd", nrrd("7 7 7 1", &frame(3)));
    let slice = ["--isovalue", "0", "-o", "a.ply", "--time", "1"];
    let with = |frames: &'static str| [&["--frames", frames][..], &slice].concat();
    for (arguments, want) in [
        (with("f0.nrrd"), "f0.nrrd: sizes `[7, 7, 7]` is not supported; a series in one file has four axes"),
        (with("one.nrrd"), "one.nrrd: there must be two frames or more, not 1"),
        (with("f0.nrrd,small.nrrd"), "small.nrrd: has 6 x 7 x 7 samples, and f0.nrrd has 7 x 7 x 7"),
        (with("f0.nrrd,none.nrrd"), "none.nrrd"),
        (
            with("f2.nrrd,nan.nrrd"),
            "nan.nrrd: frame 1: the sample at [3, 3, 3] is NaN; samples must be finite",
        ),
        (
            vec!["--frames", &names, "--isovalue", "0", "--time", "6.5", "-o", "a.ply"],
            "time 6.5 is outside of the series, which goes from 0 to 6",
        ),
        (vec!["--frames", &names, "--isovalue", "0", "-o", "a.ply"], "a.ply: tetrahedra are written as .vtk"),
        (
            [&["--frames", &names, "--memory", "5kB"][..], &slice].concat(),
            "of memory are needed; --memory allows",
        ),
        (
            vec!["--volume", "f3.nrrd", "--between", "3,1", "-o", "a.vtk"],
            "the first isovalue must be below the second: 3 and 1",
        ),
        (
            vec!["--volume", "f3.nrrd", "--between", "8,9", "-o", "a.vtk"],
            "f3.nrrd: nothing is between 8 and 9",
        ),
    ] {
        let said = folder.run(&arguments);
        assert_eq!(said.code, Some(2), "{arguments:?}: {}", said.stderr);
        assert!(said.stderr.contains(want), "{arguments:?}: {}", said.stderr);
        assert!(!folder.path("a.ply").exists() && !folder.path("a.vtk").exists(), "{arguments:?}");
    }
}
