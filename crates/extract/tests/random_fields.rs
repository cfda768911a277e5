//! Properties of the unclustered surface over arbitrary samples.

mod topology;

use extract::{Arrangement, Clustering, Execution, ExtractSettings, Lattice, ScalarField, extract};
use glam::Vec3;
use mesh::Bounds;
use proptest::prelude::*;
use topology::assert_closed_manifold;

/// Noise by position, with a shell of outside points so that the surface is interior.
#[derive(Debug)]
struct Noise {
    seed: u32,
    /// Values are multiples of `1 / levels`: with few levels there are many ties and exact zeros.
    levels: u32,
    reach: f32,
}

impl ScalarField for Noise {
    fn sample(&self, p: Vec3) -> f32 {
        if p.abs().max_element() > self.reach {
            return -1.0;
        }
        let bits = p.to_array().map(f32::to_bits);
        let mixed = bits.iter().fold(self.seed ^ 0x9e37_79b9, |h, &b| {
            let h = (h ^ b).wrapping_mul(0x85eb_ca6b);
            (h ^ h >> 13).wrapping_mul(0xc2b2_ae35) ^ h >> 16
        });
        (mixed % (2 * self.levels + 1)) as f32 / self.levels as f32 - 1.0
    }
}

fn field() -> impl Strategy<Value = Noise> {
    let levels = prop_oneof![Just(1), Just(2), Just(5), Just(10_000_000)];
    (any::<u32>(), levels).prop_map(|(seed, levels)| Noise { seed, levels, reach: 2.2 })
}

fn arrangement() -> impl Strategy<Value = Arrangement> {
    prop_oneof![Just(Arrangement::BodyCentred), Just(Arrangement::SimpleCubic)]
}

fn run(field: &Noise, arrangement: Arrangement, clustering: Clustering) -> extract::Extraction {
    let bounds = Bounds { min: Vec3::splat(-4.0), max: Vec3::splat(4.0) };
    let lattice = Lattice::try_new(arrangement, bounds, 1.0).unwrap();
    let settings = ExtractSettings { clustering, ..ExtractSettings::default() };
    extract(field, &lattice, &settings, &Execution { threads: 1 }).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn unclustered_surface_is_a_closed_manifold(field in field(), arrangement in arrangement()) {
        let extraction = run(&field, arrangement, Clustering::None);
        prop_assume!(!extraction.mesh.triangles.is_empty());
        assert_closed_manifold(&extraction.mesh);
        prop_assert_eq!(extraction.counts.discarded_triangles, 0);
        prop_assert_eq!(extraction.counts.vertices, extraction.counts.crossings);
        prop_assert!(extraction.mesh.volume() > 0.0, "outward");
    }

    #[test]
    fn clustering_only_removes_triangles(field in field(), arrangement in arrangement()) {
        let plain = run(&field, arrangement, Clustering::None).counts;
        for clustering in [Clustering::Integrated, Clustering::EdgeCollapse] {
            let extraction = run(&field, arrangement, clustering);
            let counts = extraction.counts;
            prop_assert_eq!(counts.triangles + counts.discarded_triangles, plain.triangles);
            prop_assert_eq!(counts.crossings, plain.crossings);
            prop_assert!(counts.vertices <= plain.vertices);
            prop_assert!(counts.discarded_as_published >= counts.discarded_triangles);
            for &[a, b, c] in &extraction.mesh.triangles {
                prop_assert!(a != b && b != c && c != a);
                prop_assert!(u64::from(a.max(b).max(c)) < counts.vertices);
            }
        }
    }
}
