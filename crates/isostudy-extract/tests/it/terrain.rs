//! Surfaces of terrains: closed, sound, of the topology that their name says, and the same with fewer samples.

use glam::Vec3;
use isostudy_extract::by_lattice::{ExtractSettings, Lattice, extract};
use isostudy_extract::{Arrangement, Clustering, Execution};
use isostudy_field::{StudyField, Terrain, TerrainCharacter, TerrainSettings};
use isostudy_mesh::topology::topology;
use isostudy_mesh::{Bounds, TriangleMesh};
use std::sync::atomic::{AtomicUsize, Ordering};

const BOUNDS: Bounds = Terrain::DEFAULT_BOUNDS;

fn terrain(settings: TerrainSettings) -> Terrain {
    Terrain::try_new(settings, BOUNDS).unwrap()
}

fn of(character: TerrainCharacter, seed: u32) -> Terrain {
    terrain(character.settings(seed))
}

fn mesh_of(field: &dyn StudyField, bounds: Bounds, arrangement: Arrangement, cells: u32) -> TriangleMesh {
    let lattice = Lattice::try_new(arrangement, bounds, bounds.spacing_of_cells(cells)).unwrap();
    let clustering =
        if arrangement.supports(Clustering::Integrated) { Clustering::Integrated } else { Clustering::None };
    let settings = ExtractSettings::default().with_clustering(clustering);
    extract(field, &lattice, &settings, &Execution { threads: 1 }).unwrap().mesh
}

#[test]
fn characters_have_the_topology_of_their_names() {
    for seed in 1..4 {
        let hills =
            topology(&mesh_of(&of(TerrainCharacter::Hills, seed), BOUNDS, Arrangement::BodyCentred, 50));
        assert_eq!((hills.components, hills.euler_characteristic), (1, 2), "hills {seed}");
        // Each handle takes two from the characteristic of its component, which otherwise has two.
        let caves =
            topology(&mesh_of(&of(TerrainCharacter::Caves, seed), BOUNDS, Arrangement::BodyCentred, 50));
        let handles = caves.components as i64 - caves.euler_characteristic / 2;
        assert!(handles > 20, "caves {seed}: {handles} handles");
    }
    // Small shifts turn the ground without tearing it.
    let whole =
        TerrainSettings { overhang: 0.0225, overhang_period: 0.18, ..TerrainCharacter::Cliffs.settings(2) };
    let whole = TerrainSettings { ground: 0.25, relief: 0.2, ..whole };
    let mesh = mesh_of(&terrain(whole), BOUNDS, Arrangement::BodyCentred, 120);
    assert_eq!((topology(&mesh).components, topology(&mesh).euler_characteristic), (1, 2));
}

#[test]
fn closed_terrains_have_no_boundary_on_any_lattice() {
    for character in TerrainCharacter::ALL {
        for seed in 1..4 {
            let field = of(character, seed);
            for arrangement in Arrangement::ALL {
                for (cells, margin) in [(9, 0.0), (17, 0.06), (26, 0.01)] {
                    let field = terrain(TerrainSettings { margin, ..*field.settings() });
                    let report = topology(&mesh_of(&field, BOUNDS, arrangement, cells));
                    assert!(report.triangles > 100, "{character} {seed} {arrangement} {cells}");
                    assert_eq!(
                        (report.boundary_edges, report.non_manifold_edges),
                        (0, 0),
                        "{character} {seed} {arrangement} {cells}"
                    );
                    assert!(report.is_closed_manifold(), "{character} {seed} {arrangement} {cells}");
                }
            }
        }
        // And open where it is asked to be.
        let open = terrain(TerrainSettings { closed: false, ..character.settings(1) });
        let report = topology(&mesh_of(&open, BOUNDS, Arrangement::BodyCentred, 30));
        assert!(report.boundary_edges > 100 && report.non_manifold_edges == 0, "{character}");
    }
}

#[test]
fn walls_stand_at_the_margin() {
    let settings = TerrainSettings { margin: 0.05, ..TerrainSettings::default() };
    let mesh = mesh_of(&terrain(settings), BOUNDS, Arrangement::BodyCentred, 50);
    let (low, high) = mesh
        .positions
        .iter()
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)));
    // A width is 2.
    for (found, wanted) in [(low.x, -0.9), (low.y, -0.9), (low.z, -0.4), (high.x, 0.9), (high.y, 0.9)] {
        assert!((found - wanted).abs() < 1e-5, "{found} for {wanted}");
    }
    assert!((-0.4..0.4).contains(&high.z));
}

/// Counts samples, and tells of bounds or does not.
struct Watched<'a> {
    field: &'a Terrain,
    tells: bool,
    samples: AtomicUsize,
}

impl StudyField for Watched<'_> {
    fn sample(&self, p: Vec3) -> f32 {
        self.samples.fetch_add(1, Ordering::Relaxed);
        self.field.sample(p)
    }

    fn range(&self, bounds: Bounds, value: f32) -> Option<(f32, f32)> {
        if self.tells { self.field.range(bounds, value) } else { None }
    }

    fn slope(&self, bounds: Bounds) -> Option<f32> {
        if self.tells { self.field.slope(bounds) } else { None }
    }
}

#[test]
fn pruning_saves_samples_and_changes_no_byte() {
    for (character, share) in
        [(TerrainCharacter::Hills, 0.25), (TerrainCharacter::Cliffs, 0.45), (TerrainCharacter::Caves, 0.6)]
    {
        for closed in [true, false] {
            let field = terrain(TerrainSettings { closed, ..character.settings(7) });
            for arrangement in [Arrangement::BodyCentred, Arrangement::SimpleCubic] {
                let mut found = Vec::new();
                for tells in [false, true] {
                    let watched = Watched { field: &field, tells, samples: AtomicUsize::new(0) };
                    let mesh = mesh_of(&watched, BOUNDS, arrangement, 80);
                    found.push((mesh, watched.samples.into_inner()));
                }
                let [plain, pruned] = [&found[0], &found[1]];
                assert_eq!(plain.0, pruned.0, "{character} {arrangement}");
                println!("{character} {closed} {arrangement}: {} of {}", pruned.1, plain.1);
                assert!(
                    (pruned.1 as f64) < share * plain.1 as f64,
                    "{character}: {} of {}",
                    pruned.1,
                    plain.1
                );
            }
        }
    }
}

#[test]
fn threads_and_clusterings_do_not_matter() {
    let field = of(TerrainCharacter::Caves, 3);
    let lattice = Lattice::try_new(Arrangement::BodyCentred, BOUNDS, 0.04).unwrap();
    for clustering in [Clustering::None, Clustering::Integrated] {
        let settings = ExtractSettings::default().with_clustering(clustering);
        let [one, two] =
            [1, 2].map(|threads| extract(&field, &lattice, &settings, &Execution { threads }).unwrap().mesh);
        assert_eq!(one, two);
    }
}
