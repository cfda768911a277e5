//! Methods as tables of a file: what is written is read back, and what is not known is refused by name.

use isostudy_extract::{
    Arrangement, Clustering, Continuation, ContinuedCells, Cubes, Diagonals, DualContouring, Faces, Flat,
    Macet, Method, Placement, Positions, Seeds, SnapCubes, SurfaceNets, Tetrahedra, Topology, kinds,
};
use toml::Table;

fn read(text: &str) -> Result<Method, String> {
    #[derive(serde::Deserialize)]
    struct File {
        recipe: Method,
    }
    toml::from_str::<File>(text).map(|file| file.recipe).map_err(|error| error.to_string())
}

/// Names as study files spell them, with what they mean.
const ARRANGEMENTS: [(&str, Arrangement); 4] = [
    ("body-centred", Arrangement::BodyCentred),
    ("simple-cubic", Arrangement::SimpleCubic),
    ("five-tetrahedra", Arrangement::FiveTetrahedra),
    ("face-centred", Arrangement::FaceCentred),
];
const CLUSTERINGS: [(&str, Clustering); 5] = [
    ("none", Clustering::None),
    ("integrated", Clustering::Integrated),
    ("edge-collapse", Clustering::EdgeCollapse),
    ("integrated-collapse", Clustering::IntegratedCollapse),
    ("warp", Clustering::Warp),
];
const TOPOLOGIES: [(&str, Topology); 2] =
    [("guarded", Topology::Guarded), ("published", Topology::Published)];
const PLACEMENTS: [(&str, Placement); 4] = [
    ("mean-of-crossings", Placement::MeanOfCrossings),
    ("curvature-weighted", Placement::CurvatureWeighted),
    ("projected", Placement::Projected),
    ("relaxed", Placement::Relaxed),
];
const POSITIONS: [(&str, Positions); 4] = [
    ("\"indexed\"", Positions::Indexed),
    ("\"indexed\", accumulation_chunks = 16", Positions::Indexed),
    ("\"accumulated\"", Positions::Accumulated { chunks: 1 }),
    ("\"accumulated\", accumulation_chunks = 16", Positions::Accumulated { chunks: 16 }),
];

#[test]
fn every_combination_is_read_and_comes_back() {
    for (a, arrangement) in ARRANGEMENTS {
        for (c, clustering) in CLUSTERINGS {
            for (t, topology) in TOPOLOGIES {
                for (p, placement) in PLACEMENTS {
                    for (q, positions) in POSITIONS {
                        for refine_crossings in [false, true] {
                            let text = format!(
                                "recipe = {{ kind = \"tetrahedra\", arrangement = \"{a}\", clustering = \"{c}\", \
                                 topology = \"{t}\", placement = \"{p}\", positions = {q}, \
                                 refine_crossings = {refine_crossings} }}"
                            );
                            let expected = Method::Tetrahedra(
                                Tetrahedra::new(arrangement)
                                    .with_clustering(clustering)
                                    .with_topology(topology)
                                    .with_positions(positions)
                                    .with_placement(placement)
                                    .with_refine_crossings(refine_crossings),
                            );
                            assert_eq!(read(&text), Ok(expected), "{text}");
                            let written = Table::try_from(expected).unwrap();
                            assert_eq!(written["kind"].as_str(), Some("tetrahedra"));
                            assert_eq!(written.clone().try_into(), Ok(expected), "{written}");
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn keys_left_out_are_the_librarys_defaults() {
    let text = r#"recipe = { kind = "tetrahedra", arrangement = "body-centred", clustering = "integrated", placement = "relaxed" }"#;
    let relaxed = Tetrahedra::new(Arrangement::BodyCentred).with_placement(Placement::Relaxed);
    assert_eq!(read(text), Ok(Method::Tetrahedra(relaxed)));
    let least = r#"recipe = { kind = "tetrahedra", arrangement = "simple-cubic" }"#;
    assert_eq!(read(least), Ok(Method::Tetrahedra(Tetrahedra::new(Arrangement::SimpleCubic))));
}

#[test]
fn what_is_not_known_is_refused_by_name() {
    for (text, names) in [
        (
            r#"kind = "tetrahedra", arrangement = "body-centred", clustring = "none""#,
            ["clustring", "clustering"],
        ),
        (r#"kind = "tetrahedra", arrangement = "body-centered""#, ["body-centered", "body-centred"]),
        (
            r#"kind = "tetrahedra", arrangement = "simple-cubic", clustering = "some""#,
            ["some", "edge-collapse"],
        ),
        (r#"kind = "tetrahedra", arrangement = "simple-cubic", topology = "free""#, ["free", "guarded"]),
        (
            r#"kind = "tetrahedra", arrangement = "simple-cubic", placement = "mean""#,
            ["mean", "mean-of-crossings"],
        ),
        (
            r#"kind = "tetrahedra", arrangement = "simple-cubic", positions = "summed""#,
            ["summed", "accumulated"],
        ),
        (r#"kind = "tetrahedra""#, ["missing", "arrangement"]),
        (r#"kind = "octahedra", arrangement = "simple-cubic""#, ["octahedra", "tetrahedra"]),
        (r#"arrangement = "simple-cubic""#, ["missing", "kind"]),
    ] {
        let error = read(&format!("recipe = {{ {text} }}")).unwrap_err();
        for name in names {
            assert!(error.lines().last().is_some_and(|line| line.contains(name)), "{text}: {error}");
        }
    }
}

#[test]
fn snapped_cubes_are_read_and_written() {
    for (flat, word) in [(Flat::Both, "both"), (Flat::Neither, "neither")] {
        let wanted = Method::SnapCubes(SnapCubes::default().with_gamma(0.25).with_flat(flat));
        let keys = format!(r#"recipe = {{ kind = "snap-cubes", gamma = 0.25, flat = "{word}" }}"#);
        assert_eq!(read(&keys), Ok(wanted));
        assert_eq!(toml::from_str::<Method>(&toml::to_string(&wanted).unwrap()).unwrap(), wanted);
    }
    let published = Method::SnapCubes(SnapCubes::default().with_gamma(0.3).with_flat(Flat::Both));
    assert_eq!(read(r#"recipe = { kind = "snap-cubes" }"#), Ok(published));
    let error = read(r#"recipe = { kind = "snap-cubes", faces = "decider" }"#).unwrap_err();
    assert!(error.contains("faces") && error.contains("gamma"), "{error}");
}

#[test]
fn macet_is_read_and_written() {
    let wanted = Macet::default().with_faces(Faces::Decider).with_pull(0.5).with_steps(7).with_share(0.25);
    let keys = r#"recipe = { kind = "macet", faces = "decider", pull = 0.5, steps = 7, share = 0.25 }"#;
    assert_eq!(read(keys), Ok(Method::Macet(wanted)));
    let text = toml::to_string(&Method::Macet(wanted)).unwrap();
    assert_eq!(toml::from_str::<Method>(&text).unwrap(), Method::Macet(wanted));
    assert_eq!(Macet::default().diagonals, Diagonals::EdgeGroups);
    assert!(read(r#"recipe = { kind = "macet", gamma = 0.3 }"#).unwrap_err().contains("gamma"));
}

#[test]
fn surface_nets_are_read_and_written() {
    let wanted = Method::SurfaceNets(SurfaceNets::default().with_patches(true).with_smoothing(8));
    assert_eq!(read(r#"recipe = { kind = "surface-nets", patches = true, smoothing = 8 }"#), Ok(wanted));
    assert_eq!(toml::from_str::<Method>(&toml::to_string(&wanted).unwrap()).unwrap(), wanted);
    assert_eq!(
        read(r#"recipe = { kind = "surface-nets" }"#),
        Ok(Method::SurfaceNets(SurfaceNets::default()))
    );
    let error = read(r#"recipe = { kind = "surface-nets", smoothing = -1 }"#).unwrap_err();
    assert!(error.contains("-1"), "{error}");
    let error = read(r#"recipe = { kind = "surface-nets", smooth = 1 }"#).unwrap_err();
    assert!(error.contains("smooth") && error.contains("smoothing"), "{error}");
}

#[test]
fn dual_contouring_is_read_and_written() {
    let wanted = DualContouring::default()
        .with_patches(true)
        .with_truncation(0.01)
        .with_in_cell(true)
        .with_tolerance(0.25);
    let keys = r#"recipe = { kind = "dual-contouring", patches = true, truncation = 0.01, in_cell = true, tolerance = 0.25 }"#;
    assert_eq!(read(keys), Ok(Method::DualContouring(wanted)));
    let text = toml::to_string(&Method::DualContouring(wanted)).unwrap();
    assert_eq!(toml::from_str::<Method>(&text).unwrap(), Method::DualContouring(wanted));
    assert_eq!(DualContouring::default().tolerance, 0.0);
    let error = read(r#"recipe = { kind = "dual-contouring", smoothing = 1 }"#).unwrap_err();
    assert!(error.contains("smoothing") && error.contains("tolerance"), "{error}");
}

#[test]
fn continuation_is_read_and_written() {
    let seeds = Seeds::try_new(&[[0.0, 0.5, -1.0], [2.0, 0.0, 0.0]]).unwrap();
    let wanted = Method::Continuation(
        Continuation::default().with_cells(ContinuedCells::Tetrahedra).with_seeds(seeds).with_search(4),
    );
    let keys = r#"recipe = { kind = "continuation", cells = "tetrahedra", seeds = [[0, 0.5, -1], [2, 0, 0]], search = 4 }"#;
    assert_eq!(read(keys), Ok(wanted));
    assert_eq!(toml::from_str::<Method>(&toml::to_string(&wanted).unwrap()).unwrap(), wanted);
    let plain = Method::Continuation(Continuation::default());
    assert_eq!(read(r#"recipe = { kind = "continuation" }"#), Ok(plain));
    assert_eq!(toml::from_str::<Method>(&toml::to_string(&plain).unwrap()).unwrap(), plain);
    for (text, names) in [
        (r#"seeds = [[0, 0]]"#, ["3", "seeds"]),
        (r#"seeds = [[inf, 0, 0]]"#, ["finite", "at most 8"]),
        (r#"cells = "spheres""#, ["spheres", "tetrahedra"]),
        (r#"faces = "decider""#, ["faces", "search"]),
    ] {
        let error = read(&format!(r#"recipe = {{ kind = "continuation", {text} }}"#)).unwrap_err();
        assert!(names.iter().all(|name| error.contains(name)), "{text}: {error}");
    }
}

#[test]
fn cubes_are_read_and_written() {
    let all = [Faces::SeparateInside, Faces::JoinInside, Faces::Decider, Faces::Trilinear];
    let words = ["separate-inside", "join-inside", "decider", "trilinear"];
    for (faces, word) in all.into_iter().zip(words) {
        for (diagonals, diagonal) in
            [(Diagonals::Fan, "fan"), (Diagonals::EdgeGroups, "edge-groups"), (Diagonals::Quality, "quality")]
        {
            let wanted = Method::Cubes(
                Cubes::default()
                    .with_faces(faces)
                    .with_diagonals(diagonals)
                    .with_placement(Placement::Projected)
                    .with_refine_crossings(true),
            );
            let keys = format!(
                r#"kind = "cubes", faces = "{word}", diagonals = "{diagonal}", placement = "projected", refine_crossings = true"#
            );
            assert_eq!(read(&format!("recipe = {{ {keys} }}")), Ok(wanted));
            let text = toml::to_string(&wanted).unwrap();
            assert_eq!(toml::from_str::<Method>(&text).unwrap(), wanted, "{text}");
        }
    }
    assert_eq!(read(r#"recipe = { kind = "cubes" }"#), Ok(Method::Cubes(Cubes::default())));
    for (text, names) in [
        (r#"kind = "cubes", face = "decider""#, ["face", "faces"]),
        (r#"kind = "cubes", faces = "asymptotic""#, ["asymptotic", "decider"]),
        (r#"kind = "cubes", diagonals = "best""#, ["best", "quality"]),
        (r#"kind = "cubes", arrangement = "simple-cubic""#, ["arrangement", "diagonals"]),
    ] {
        let error = read(&format!("recipe = {{ {text} }}")).unwrap_err();
        for name in names {
            assert!(error.lines().last().is_some_and(|line| line.contains(name)), "{text}: {error}");
        }
    }
}

/// Whatever the family: its kind is the registry's, its keys are written out, each may be left out but for `arrangement`, and no
/// other is known.
#[test]
fn every_kind_is_read_by_its_name_and_refuses_keys_of_others() {
    for kind in kinds() {
        for preset in kind.presets {
            let written = Table::try_from(preset.method).unwrap();
            assert_eq!(written["kind"].as_str(), Some(kind.name), "{}", preset.id);
            assert_eq!(written.clone().try_into(), Ok(preset.method), "{}", preset.id);
            for key in written.keys().filter(|key| !["kind", "arrangement"].contains(&key.as_str())) {
                let mut without = written.clone();
                without.remove(key);
                assert!(without.try_into::<Method>().is_ok(), "{} without {key}", preset.id);
            }
            let mut with = written.clone();
            with.insert("colour".into(), 1.into());
            let error = with.try_into::<Method>().unwrap_err().to_string();
            assert!(error.contains("colour"), "{}: {error}", preset.id);
        }
        let unknown = read("recipe = { kind = \"octahedra\" }").unwrap_err();
        assert!(unknown.contains(&format!("`{}`", kind.name)), "{unknown}");
    }
}
