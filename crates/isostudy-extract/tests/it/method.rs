//! A method as data makes the mesh of the functions it stands for, refuses what they refuse, and keeps its promises.

use crate::fields::{FAMILIES, Volume};
use crate::survey::survey;
use glam::Vec3;
use isostudy_extract::by_lattice::{ExtractSettings, Lattice, extract};
use isostudy_extract::{
    Arrangement, BoxGrid, ChunkExtractor, ChunkSettings, Clustering, ContinuedCells, Execution, ExtractError,
    Extraction, Extractor, LatticeError, Method, MethodError, Placement, Positions, Source, Tetrahedra,
    Topology, kinds, presets, weld_chunks,
};
use isostudy_field::{Sphere, StudyField};
use isostudy_mesh::{Bounds, TriangleMesh};

const BOX: Bounds = Bounds { min: Vec3::splat(-1.1), max: Vec3::new(1.1, 1.2, 1.3) };
const GRID: BoxGrid = BoxGrid { bounds: BOX, spacing: 0.23 };
const ONE: Execution = Execution { threads: 1 };

/// Every combination of settings, of those that exist and of those that do not.
fn all() -> Vec<Tetrahedra> {
    let mut found = Vec::new();
    for arrangement in Arrangement::ALL {
        for clustering in [
            Clustering::None,
            Clustering::Integrated,
            Clustering::EdgeCollapse,
            Clustering::IntegratedCollapse,
        ] {
            for topology in [Topology::Guarded, Topology::Published] {
                for positions in [Positions::Indexed, Positions::Accumulated { chunks: 3 }] {
                    for placement in [
                        Placement::MeanOfCrossings,
                        Placement::CurvatureWeighted,
                        Placement::Projected,
                        Placement::Relaxed,
                    ] {
                        for refine_crossings in [false, true] {
                            found.push(
                                Tetrahedra::new(arrangement)
                                    .with_clustering(clustering)
                                    .with_topology(topology)
                                    .with_positions(positions)
                                    .with_placement(placement)
                                    .with_refine_crossings(refine_crossings),
                            );
                        }
                    }
                }
            }
        }
    }
    found
}

fn bits(points: &[Vec3]) -> Vec<[u32; 3]> {
    points.iter().map(|p| p.to_array().map(f32::to_bits)).collect()
}

fn assert_same(left: &TriangleMesh, right: &TriangleMesh, what: &str) {
    assert_eq!(bits(&left.positions), bits(&right.positions), "{what}: positions");
    assert_eq!(bits(&left.normals), bits(&right.normals), "{what}: normals");
    assert_eq!(left.triangles, right.triangles, "{what}: triangles");
}

#[test]
fn a_method_is_the_function_with_its_settings_or_refuses_as_it_does() {
    let sphere = Sphere { radius: 1.0 };
    let (mut extractor, mut extraction) = (Extractor::new(), Extraction::default());
    let (mut made, mut refused) = (0, 0);
    for tetrahedra in all() {
        let (what, method) = (format!("{tetrahedra:?}"), Method::Tetrahedra(tetrahedra));
        let settings = ExtractSettings::default()
            .with_isovalue(0.05)
            .with_clustering(tetrahedra.clustering)
            .with_topology(tetrahedra.topology)
            .with_positions(tetrahedra.positions)
            .with_placement(tetrahedra.placement)
            .with_refine_crossings(tetrahedra.refine_crossings)
            .with_edge_clamp(tetrahedra.edge_clamp);
        let lattice = Lattice::try_new(tetrahedra.arrangement, BOX, GRID.spacing).unwrap();
        let source = Source::Study(&sphere);
        let result = method.extract_into(&mut extractor, source, &GRID, 0.05, &ONE, &mut extraction);
        match extract(&sphere, &lattice, &settings, &ONE) {
            Ok(expected) => {
                result.unwrap();
                assert_same(&extraction.mesh, &expected.mesh, &what);
                assert_eq!(extraction.counts, expected.counts, "{what}");
                assert!(extraction.mesh.triangles.len() > 100, "{what}");
                assert_eq!(method.check(&GRID), Ok(()), "{what}");
                made += 1;
            }
            Err(error) => {
                let error = MethodError::Extract(error);
                assert_eq!(result, Err(error.clone()), "{what}");
                assert_eq!(method.check(&GRID), Err(error), "{what}");
                assert_eq!(extraction.mesh, TriangleMesh::default(), "{what}");
                refused += 1;
            }
        }
        assert_eq!(method.cells(&GRID), Ok(lattice.cells()), "{what}");
        let memory = method.memory_bytes(&GRID, &ONE);
        assert_eq!(memory, Ok(lattice.memory_bytes_for(&settings, &ONE)), "{what}");
    }
    // Two arrangements have all; two have half the clusterings, and those with indexed positions only.
    assert_eq!((made, refused), (2 * 128 + 2 * 32, 2 * 96));
}

#[test]
fn an_error_says_what_is_allowed_and_leaves_nothing() {
    let sphere: &dyn StudyField = &Sphere { radius: 1.0 };
    let of = |arrangement| Method::Tetrahedra(Tetrahedra::new(arrangement));
    let error = of(Arrangement::FaceCentred).check(&GRID).unwrap_err();
    assert!(matches!(error, MethodError::Extract(ExtractError::ArrangementClustering { .. })));
    let text = error.to_string();
    assert!(text.contains("none and edge-collapse") && text.contains("body-centred"), "{text}");

    let (mut extractor, method) = (Extractor::new(), of(Arrangement::BodyCentred));
    let mut extraction = method.extract(&mut extractor, sphere.into(), &GRID, 0.0, &ONE).unwrap();
    let flat = BoxGrid { spacing: -1.0, ..GRID };
    let error = MethodError::Grid(LatticeError::Spacing { value: -1.0 });
    assert_eq!(method.check(&flat), Err(error.clone()));
    let result = method.extract_into(&mut extractor, sphere.into(), &flat, 0.0, &ONE, &mut extraction);
    assert_eq!(result, Err(error));
    assert_eq!((&extraction.mesh, extraction.counts), (&TriangleMesh::default(), Default::default()));
    assert_eq!(method.cells(&flat), Err(LatticeError::Spacing { value: -1.0 }));
}

/// The oracle is a walk along sides and round vertices that knows nothing of methods.
#[test]
fn presets_keep_the_promise_of_a_manifold_whatever_the_samples() {
    let mut promised = 0;
    for preset in presets().iter().filter(|preset| preset.method.promises().manifold) {
        assert!(preset.method.promises().closed_off_the_box);
        promised += 1;
        let arrangement = match preset.method {
            Method::Tetrahedra(Tetrahedra { arrangement, .. }) => arrangement,
            // The others are of cubes.
            _ => Arrangement::SimpleCubic,
        };
        let mut extractor = Extractor::new();
        for (family, seed) in FAMILIES.into_iter().flat_map(|family| [(family, 1), (family, 2)]) {
            for is_closed in [false, true] {
                let what = format!("{} {family:?} {seed} closed {is_closed}", preset.id);
                let volume = Volume::random(arrangement, 4, family, seed);
                let volume = if is_closed { volume.closed() } else { volume };
                let (source, grid) = (Source::Study(&volume), BoxGrid::from(&volume.lattice()));
                let mesh = preset.method.extract(&mut extractor, source, &grid, 0.0, &ONE).unwrap().mesh;
                let components = survey(mesh.positions.len(), &mesh.triangles)
                    .unwrap_or_else(|fault| panic!("{what}: {fault}"));
                let boundary_loops: u64 = components.iter().map(|component| component.1 as u64).sum();
                assert!(!is_closed || boundary_loops == 0, "{what} is open");
            }
        }
    }
    assert_eq!(promised, 28, "all but those as published");
}

#[test]
fn presets_keep_their_other_promises() {
    let sphere = Sphere { radius: 1.0 };
    let mut extractor = Extractor::new();
    for preset in presets() {
        let (promises, id) = (preset.method.promises(), preset.id);
        preset.method.check(&GRID).unwrap();
        let mesh =
            preset.method.extract(&mut extractor, (&sphere as &dyn StudyField).into(), &GRID, 0.0, &ONE);
        let mesh = mesh.unwrap().mesh;
        let placed = |placement| match preset.method {
            Method::Tetrahedra(tetrahedra) => Method::Tetrahedra(tetrahedra.with_placement(placement)),
            Method::Cubes(cubes) => Method::Cubes(cubes.with_placement(placement)),
            _ => panic!("it has no placements"),
        };
        let arrangement = match preset.method {
            Method::Tetrahedra(Tetrahedra { arrangement, .. }) => arrangement,
            // The others are of cubes.
            _ => Arrangement::SimpleCubic,
        };
        let lattice = GRID.lattice(arrangement).unwrap();

        if promises.same_triangles_for_all_placements {
            for placement in [Placement::MeanOfCrossings, Placement::CurvatureWeighted, Placement::Relaxed] {
                let other = placed(placement)
                    .extract(&mut extractor, Source::Study(&sphere), &GRID, 0.0, &ONE)
                    .unwrap();
                assert_eq!(other.mesh.triangles, mesh.triangles, "{id} {placement:?}");
            }
        }
        let chunks = ChunkExtractor::in_box(&GRID, &preset.method, &ChunkSettings::default());
        assert_eq!(chunks.is_ok(), promises.chunks, "{id}");
        if let Ok(mut chunks) = chunks {
            let boxes: Vec<_> = chunks.grid(4).collect();
            let parts: Vec<_> = boxes
                .into_iter()
                .map(|cells| chunks.extract(Source::Study(&sphere), cells, &ONE).unwrap())
                .collect();
            assert!(parts.len() > 8, "{id}");
            assert_same(&weld_chunks(&parts).unwrap(), &mesh, id);
        }
        let samples = vec![1.0; lattice.stored_samples() as usize];
        let given = preset.method.extract(&mut extractor, Source::Samples(&samples), &GRID, 2.0, &ONE);
        assert_eq!(given.is_ok(), promises.samples_suffice, "{id}");
    }
}

#[test]
fn presets_have_names_of_their_own() {
    for (i, preset) in presets().iter().enumerate() {
        let id = preset.id;
        assert!((2..=16).contains(&id.len()) && id.starts_with(|c: char| c.is_ascii_lowercase()), "{id}");
        assert!(id.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-'), "{id}");
        for other in &presets()[..i] {
            assert!(other.id != id && other.label != preset.label && other.method != preset.method, "{id}");
        }
        assert!(!preset.source.is_empty());
        // The letters and the words name what the method is.
        let method = match preset.method {
            Method::Tetrahedra(method) => method,
            Method::Cubes(_) => {
                assert!(id.starts_with("mc") && preset.label.starts_with("marching cubes"), "{id}");
                continue;
            }
            Method::SnapCubes(_) => {
                assert!(
                    id.starts_with("snapmc") && preset.label.starts_with("marching cubes, snapped"),
                    "{id}"
                );
                continue;
            }
            Method::SurfaceNets(nets) => {
                assert!(preset.label.starts_with("surface nets"), "{id}");
                assert_eq!(id, if nets.patches { "nets-manifold" } else { "nets" });
                continue;
            }
            Method::DualContouring(nets) => {
                assert!(preset.label.starts_with("dual contouring"), "{id}");
                let name = match (nets.patches, nets.in_cell) {
                    (true, true) if nets.clean => "dc-clean",
                    (true, true) => "dc-in-cell",
                    (true, false) => "dc-manifold",
                    _ => "dc",
                };
                assert_eq!(id, name);
                continue;
            }
            Method::Continuation(continuation) => {
                let [name, label] = match continuation.cells {
                    ContinuedCells::Cubes => ["continued", "continuation, cubes"],
                    ContinuedCells::Tetrahedra => ["continued-tetra", "continuation, tetrahedra"],
                };
                assert_eq!((id, preset.label), (name, label));
                continue;
            }
            Method::Macet(_) => {
                assert!(id.starts_with("macet") && preset.label.starts_with("marching cubes, edges"), "{id}");
                continue;
            }
            // What every kind has, `every_kind_names_its_presets` asks.
            _ => continue,
        };
        let mut letters = id.chars();
        let arrangement = match letters.next() {
            Some('b') => (Arrangement::BodyCentred, "body-centred"),
            Some('s') => (Arrangement::SimpleCubic, "simple cubic"),
            Some('m') => (Arrangement::FiveTetrahedra, "five tetrahedra"),
            _ => (Arrangement::FaceCentred, "face-centred"),
        };
        let clustering = match letters.next() {
            Some('u') => (Clustering::None, "none"),
            Some('i') => (Clustering::Integrated, "integrated"),
            Some('p') => (Clustering::EdgeCollapse, "edge collapse"),
            Some('w') => (Clustering::Warp, "warp"),
            _ => (Clustering::IntegratedCollapse, "integrated + collapse"),
        };
        assert_eq!((method.arrangement, method.clustering), (arrangement.0, clustering.0), "{id}");
        let (plain, rest) = (format!("{}, {}", arrangement.1, clustering.1), letters.as_str());
        let (ending, placement, topology) = match rest {
            "" => ("", Placement::MeanOfCrossings, Topology::Guarded),
            "-projected" => (", projected", Placement::Projected, Topology::Guarded),
            "-relaxed" => (", relaxed", Placement::Relaxed, Topology::Guarded),
            "-published" => (", as published", Placement::MeanOfCrossings, Topology::Published),
            _ => panic!("{id}"),
        };
        assert_eq!((method.placement, method.topology), (placement, topology), "{id}");
        assert_eq!(preset.label, format!("{plain}{ending}"));
    }
    let is_plain = |id: &str| id.len() == 2 && !["mc", "dc"].contains(&id);
    let plain = presets().iter().filter(|preset| is_plain(preset.id)).count();
    assert_eq!(plain, Arrangement::ALL.iter().map(|&a| supported(a)).sum::<usize>());
}

/// Presets stand kind by kind, those for comparison last; those of a kind begin alike, in name and in words.
#[test]
fn every_kind_names_its_presets() {
    let mut names = Vec::new();
    for kind in kinds() {
        assert!(!names.contains(&kind.name), "{}", kind.name);
        names.push(kind.name);
        let first = kind.presets.first().expect("a kind has a preset");
        let word = |label: &str| label.split([' ', ',']).next().map(str::to_owned);
        for preset in kind.presets {
            assert_eq!(preset.method.kind(), kind.name, "{}", preset.id);
            assert!(kind.name == "tetrahedra" || preset.id.starts_with(first.id), "{}", preset.id);
            assert!(kind.name == "tetrahedra" || word(preset.label) == word(first.label), "{}", preset.label);
        }
    }
    let in_order = |compared: bool| {
        let all = kinds().iter().flat_map(|kind| kind.presets);
        all.filter(move |preset| preset.method.is_for_comparison() == compared).map(|preset| preset.id)
    };
    let listed: Vec<&str> = presets().iter().map(|preset| preset.id).collect();
    assert_eq!(listed, in_order(false).chain(in_order(true)).collect::<Vec<_>>());
}

fn supported(arrangement: Arrangement) -> usize {
    match arrangement {
        Arrangement::BodyCentred => 5,
        Arrangement::SimpleCubic => 4,
        Arrangement::FiveTetrahedra | Arrangement::FaceCentred => 2,
    }
}

/// What says that corners suffice takes them and makes the mesh of the field; what does not is refused them.
#[test]
fn corners_suffice_for_the_methods_that_say_so() {
    let field = Sphere { radius: 0.8 };
    let cubes = presets().iter().find(|preset| preset.id == "mc").unwrap().method;
    let samples = cubes.corner_samples(&field, &GRID).unwrap().unwrap().values;
    let mut of_corners = Vec::new();
    for preset in presets() {
        let extract =
            |source: Source<'_>| preset.method.extract(&mut Extractor::new(), source, &GRID, 0.0, &ONE);
        let from_samples = extract(Source::Samples(&samples));
        if preset.method.is_of_corners() {
            of_corners.push(preset.id);
            let (from_field, from_samples) =
                (extract((&field as &dyn StudyField).into()).unwrap(), from_samples.unwrap());
            assert!(!from_field.mesh.triangles.is_empty());
            assert_same(&from_field.mesh, &from_samples.mesh, preset.id);
        } else {
            assert!(from_samples.is_err(), "{} takes corners", preset.id);
        }
    }
    for id in ["mc", "mc33", "mc-edge-groups", "snapmc", "nets", "nets-manifold", "si"] {
        assert!(of_corners.contains(&id), "{id}: {of_corners:?}");
    }
    for id in ["bi", "bi-relaxed", "dc", "dc-in-cell"] {
        assert!(!of_corners.contains(&id), "{id}");
    }
}
