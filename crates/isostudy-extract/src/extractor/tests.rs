//! Errors on the way: more vertices than may be, without making four thousand million of them.

use glam::Vec3;
use isostudy_mesh::Bounds;

use crate::by_lattice::{ExtractSettings, Lattice};
use crate::extractor::MostVertices;
use crate::{Arrangement, Clustering, Execution, ExtractError, Extraction, Extractor, Positions, Source};
use isostudy_field::Sphere;

#[test]
fn more_vertices_than_may_be_are_an_error() {
    let bounds = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };
    let lattice = Lattice::try_new(Arrangement::BodyCentred, bounds, 0.02).unwrap();
    let (sphere, settings) = (Sphere { radius: 0.8 }, ExtractSettings::default());
    for threads in [1, 2] {
        let mut extractor = Extractor::new();
        let mut run = |most| {
            extractor.most_vertices = MostVertices(most);
            extractor.extract(Source::Study(&sphere), &lattice, &settings, &Execution { threads })
        };
        let mesh = run(u32::MAX).unwrap().mesh;
        let all = mesh.positions.len() as u32;
        assert_eq!(run(all).unwrap().mesh, mesh);
        // Just one too many is seen when slabs are joined; half of them, in a slab.
        for limit in [all - 1, all / 8, 0] {
            assert_eq!(run(limit).unwrap_err(), ExtractError::TooManyVertices { limit });
        }
        assert_eq!(run(u32::MAX).unwrap().mesh, mesh, "the extractor is as good as new");
    }
}

/// Stored, a point may have several vertices, so that the limit can fall into the middle of one.
#[test]
fn more_stored_vertices_than_may_be_are_an_error() {
    let bounds = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };
    let lattice = Lattice::try_new(Arrangement::BodyCentred, bounds, 0.1).unwrap();
    let sphere = Sphere { radius: 0.8 };
    for clustering in [Clustering::Integrated, Clustering::None] {
        let positions = Positions::Accumulated { chunks: 16 };
        let settings = ExtractSettings { positions, clustering, ..ExtractSettings::default() };
        let mut extractor = Extractor::new();
        let mut run = |most| {
            extractor.most_vertices = MostVertices(most);
            extractor.extract(Source::Study(&sphere), &lattice, &settings, &Execution { threads: 1 })
        };
        let mesh = run(u32::MAX).unwrap().mesh;
        let all = mesh.positions.len() as u32;
        assert_eq!(run(all).unwrap().mesh, mesh);
        for limit in (all - 20..all).chain(0..20) {
            assert_eq!(run(limit).unwrap_err(), ExtractError::TooManyVertices { limit });
        }
    }
}

#[test]
fn after_an_error_nothing_is_left_of_the_surface_before() {
    let bounds = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };
    let lattice = Lattice::try_new(Arrangement::BodyCentred, bounds, 0.1).unwrap();
    let (sphere, settings) = (Sphere { radius: 0.8 }, ExtractSettings::default());
    let no_isovalue = ExtractSettings { isovalue: f32::NAN, ..settings };
    let (field, samples) = (Source::Study(&sphere), Source::Samples(&[0.0]));
    for threads in [1, 2] {
        let (mut extractor, mut extraction) = (Extractor::new(), Extraction::default());
        for (source, bad, most) in
            [(field, no_isovalue, u32::MAX), (samples, settings, u32::MAX), (field, settings, 9)]
        {
            let mut run = |source, settings, most| {
                extractor.most_vertices = MostVertices(most);
                extractor.extract_into(source, &lattice, &settings, &Execution { threads }, &mut extraction)
            };
            run(field, settings, u32::MAX).unwrap();
            run(source, bad, most).unwrap_err();
            assert_eq!((&extraction.mesh, extraction.counts), (&Default::default(), Default::default()));
            assert_eq!(extraction.times, Default::default());
        }
    }
}
