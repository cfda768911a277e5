//! Crossings kept away from sample points: how far, by which methods, and what it leaves as it is.

use crate::fields::{Family, Volume};
use glam::Vec3;
use isostudy_extract::{
    Arrangement, BoxGrid, CellBox, ChunkExtractor, ChunkSettings, Clustering, Cubes, Execution, ExtractError,
    Extractor, Method, MethodError, Placement, Source, SurfaceNets, Tetrahedra, weld_chunks,
};
use isostudy_mesh::TriangleMesh;

const ONE: Execution = Execution { threads: 1 };
const FAMILIES: [Family; 5] =
    [Family::White, Family::FiveLevels, Family::Spheres, Family::NoisyMagnitudes, Family::LowPassOnce];

fn tetrahedra(arrangement: Arrangement, clustering: Clustering, edge_clamp: f32) -> Method {
    Method::Tetrahedra(Tetrahedra::new(arrangement).with_clustering(clustering).with_edge_clamp(edge_clamp))
}

fn mesh_of(volume: &Volume, method: &Method) -> TriangleMesh {
    let grid = BoxGrid::from(&volume.lattice());
    method.extract(&mut Extractor::new(), Source::Study(volume), &grid, 0.0, &ONE).unwrap().mesh
}

fn volume(arrangement: Arrangement, family: Family) -> Volume {
    Volume::random(arrangement, 6, family, 3).closed()
}

/// How far a point is from the nearest end of the lattice edge that it lies on, as a share of the edge. Edges are between points at whole
/// and half cells, and straight. Of cubes they run along the axes.
fn share_of_cube_edge(p: Vec3) -> f32 {
    let off = (p - p.round()).abs();
    assert!(off.to_array().iter().filter(|&&c| c > 0.0).count() <= 1, "{p} is on no edge");
    off.max_element()
}

/// Of the body-centred lattice, whose edges run along the axes or diagonals from corners (whole numbers) or centres (whole and a half).
fn share_of_body_centred_edge(p: Vec3) -> f32 {
    let ends = |shift: f32| p - (p - shift).round() - shift;
    let is_on = |way: Vec3| {
        let sizes = way.abs().to_array();
        let largest = way.abs().max_element();
        let along_axis = sizes.iter().filter(|&&c| c > 1e-5).count() <= 1;
        let diagonal = sizes.iter().all(|&c| (c - largest).abs() < 1e-5);
        if along_axis {
            Some(largest)
        } else if diagonal {
            Some(2.0 * largest)
        } else {
            None
        }
    };
    let shares = [0.0, 0.5].into_iter().filter_map(|shift| is_on(ends(shift)));
    shares.fold(f32::INFINITY, f32::min)
}

#[test]
fn no_crossing_is_nearer_to_a_sample_point() {
    for clamp in [0.1, 0.25, 0.49] {
        for family in FAMILIES {
            let simple = volume(Arrangement::SimpleCubic, family);
            let cubes =
                |edge_clamp| mesh_of(&simple, &Method::Cubes(Cubes::default().with_edge_clamp(edge_clamp)));
            let (mesh, plain) = (cubes(clamp), cubes(0.0));
            assert_eq!(mesh.triangles, plain.triangles, "{family:?}");
            for (p, before) in mesh.positions.iter().zip(&plain.positions) {
                let (share, before_share) = (share_of_cube_edge(*p), share_of_cube_edge(*before));
                assert!(share > clamp - 1e-5, "{family:?} {p}: {share}");
                // Where it was far enough it stays, to the bit.
                assert!(before_share < clamp + 1e-5 || p == before, "{p} {before}");
            }
            let body = volume(Arrangement::BodyCentred, family);
            let of = |edge_clamp| {
                mesh_of(&body, &tetrahedra(Arrangement::BodyCentred, Clustering::None, edge_clamp))
            };
            let (mesh, plain) = (of(clamp), of(0.0));
            assert_eq!(mesh.triangles, plain.triangles, "{family:?}");
            for (p, before) in mesh.positions.iter().zip(&plain.positions) {
                // Next to the box edges are shorter.
                let is_inner = p.min_element() > 0.5 && p.max_element() < 5.5;
                let share = share_of_body_centred_edge(*p);
                assert!(!is_inner || share > clamp - 1e-4, "{family:?} {p}: {share}");
                assert!(share_of_body_centred_edge(*before) < clamp + 1e-4 || p == before || !is_inner);
            }
        }
    }
}

/// The vertex of a net is the mean of crossings that were kept away, computed here in double precision.
#[test]
fn nets_have_means_of_crossings_that_were_kept_away() {
    let clamp = 0.3;
    for family in [Family::White, Family::Spheres] {
        let simple = volume(Arrangement::SimpleCubic, family);
        let nets = Method::SurfaceNets(SurfaceNets::default().with_edge_clamp(clamp));
        let value = |p: Vec3| f64::from(isostudy_field::StudyField::sample(&simple, p));
        for p in &mesh_of(&simple, &nets).positions {
            let low = p.floor();
            let (mut sum, mut count) = (glam::DVec3::ZERO, 0.0);
            for (corner, axis) in
                (0..8).flat_map(|c| (0..3).map(move |axis| (c, axis))).filter(|(c, axis)| c >> axis & 1 == 0)
            {
                let from =
                    low + Vec3::new((corner & 1) as f32, (corner >> 1 & 1) as f32, (corner >> 2) as f32);
                let to = from + Vec3::AXES[axis];
                let [here, there] = [value(from), value(to)];
                if (here > 0.0) != (there > 0.0) {
                    let share = (here / (here - there)).clamp(f64::from(clamp), 1.0 - f64::from(clamp));
                    sum += from.as_dvec3().lerp(to.as_dvec3(), share);
                    count += 1.0;
                }
            }
            assert!((sum / count).distance(p.as_dvec3()) < 1e-5, "{family:?} {p}");
        }
    }
}

/// Chunks weld to the whole, and the settings that move vertices start from where they were kept.
#[test]
fn chunks_weld_to_the_whole() {
    let methods = [
        (
            Arrangement::SimpleCubic,
            Method::Cubes(Cubes::default().with_edge_clamp(0.2).with_placement(Placement::Projected)),
        ),
        (
            Arrangement::SimpleCubic,
            Method::SurfaceNets(
                SurfaceNets::default().with_patches(true).with_smoothing(1).with_edge_clamp(0.2),
            ),
        ),
        (Arrangement::BodyCentred, tetrahedra(Arrangement::BodyCentred, Clustering::Integrated, 0.2)),
        (Arrangement::FaceCentred, tetrahedra(Arrangement::FaceCentred, Clustering::None, 0.2)),
    ];
    for (arrangement, method) in methods {
        let volume = Volume::random(arrangement, 9, Family::Spheres, 5);
        let whole = mesh_of(&volume, &method);
        let grid = BoxGrid::from(&volume.lattice());
        let mut chunks = ChunkExtractor::in_box(&grid, &method, &ChunkSettings::default()).unwrap();
        let boxes: Vec<CellBox> = chunks.grid(4).collect();
        let parts: Vec<_> = boxes
            .into_iter()
            .map(|cells| chunks.extract(Source::Study(&volume), cells, &ONE).unwrap())
            .collect();
        assert!(weld_chunks(&parts).unwrap() == whole, "{method:?}");
        let execution = Execution { threads: 3 };
        let again =
            method.extract(&mut Extractor::new(), Source::Study(&volume), &grid, 0.0, &execution).unwrap();
        assert!(again.mesh == whole, "{method:?}");
    }
}

/// By how far a crossing is moved at most, so may the surface be; the worst triangles are better.
#[test]
fn triangles_are_better_and_distances_worse() {
    let bounds = isostudy_mesh::Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };
    let grid = BoxGrid { bounds, spacing: 0.05 };
    let ball = isostudy_field::Sphere { radius: 0.8 };
    let of = |edge_clamp| {
        let method = Method::Cubes(Cubes::default().with_edge_clamp(edge_clamp));
        let mesh =
            method.extract(&mut Extractor::new(), Source::Study(&ball), &grid, 0.0, &ONE).unwrap().mesh;
        let away = mesh.positions.iter().map(|p| (p.length() - 0.8).abs() / 0.05).fold(0.0, f32::max);
        (isostudy_mesh::quality::quality(&mesh).min_angle_deg.min, away)
    };
    let (plain, kept) = (of(0.0), of(0.2));
    assert!(kept.0 > plain.0 + 5.0, "{plain:?} {kept:?}");
    assert!(plain.1 < 0.01 && kept.1 > 0.1 && kept.1 < 0.2001, "{plain:?} {kept:?}");
}

#[test]
fn half_of_an_edge_is_too_much() {
    let volume = volume(Arrangement::SimpleCubic, Family::Spheres);
    let grid = BoxGrid::from(&volume.lattice());
    for edge_clamp in [0.5, -0.1, f32::NAN, f32::INFINITY] {
        for method in [
            Method::Cubes(Cubes::default().with_edge_clamp(edge_clamp)),
            Method::SurfaceNets(SurfaceNets::default().with_edge_clamp(edge_clamp)),
            tetrahedra(Arrangement::SimpleCubic, Clustering::Integrated, edge_clamp),
        ] {
            let error = method.check(&grid).unwrap_err();
            let said = error.to_string();
            assert!(matches!(error, MethodError::Extract(ExtractError::EdgeClamp { .. })), "{said}");
            assert!(said.contains("must be 0 or more and below 0.5"), "{said}");
        }
    }
    let warp = tetrahedra(Arrangement::BodyCentred, Clustering::Warp, 0.1);
    let warped = MethodError::Extract(ExtractError::Warp { with: "an edge_clamp" });
    assert_eq!(warp.check(&grid), Err(warped));
}
