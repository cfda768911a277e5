//! The part of a mesh that lies in an object's region.

use crate::records;
use glam::{DVec3, Vec3};
use isostudy_design::config::RegionSection;
use isostudy_design::record::RegionMeasures;
use isostudy_mesh::{Bounds, TriangleMesh};

/// Its box, in single precision as all geometry is.
pub(crate) fn bounds(region: &RegionSection) -> Bounds {
    let corner = |of: [f64; 3]| DVec3::from_array(of).as_vec3();
    Bounds { min: corner(region.min), max: corner(region.max) }
}

/// What a mesh is within a region; `accuracy` is that of points in it.
pub(crate) fn measures(
    region: &RegionSection,
    mesh: &TriangleMesh,
    accuracy: &isostudy_extract::Accuracy,
) -> RegionMeasures {
    let triangles = triangles(mesh, region).collect();
    let part = TriangleMesh { positions: mesh.positions.clone(), normals: mesh.normals.clone(), triangles };
    let area = mesh.area();
    RegionMeasures {
        name: region.name.clone(),
        triangles: part.triangles.len() as u64,
        area_share: if area > 0.0 { part.area() / area } else { 0.0 },
        quality: records::quality(&isostudy_mesh::quality::quality(&part)),
        accuracy: records::accuracy(accuracy),
        self_intersections: isostudy_mesh::self_intersections(&part).ok(),
    }
}

/// The triangles whose centroids lie in a region.
pub(crate) fn triangles<'a>(
    mesh: &'a TriangleMesh,
    region: &RegionSection,
) -> impl Iterator<Item = [u32; 3]> + 'a {
    let Bounds { min, max } = bounds(region);
    let belongs = move |t: &usize| {
        let centroid = mesh.corners(*t).map(Vec3::as_dvec3).iter().sum::<DVec3>() / 3.0;
        centroid.cmpge(min.as_dvec3()).all() && centroid.cmple(max.as_dvec3()).all()
    };
    (0..mesh.triangles.len()).filter(belongs).map(|t| mesh.triangles[t])
}

#[cfg(test)]
mod tests {
    use super::*;
    use isostudy_extract::{
        Arrangement, BoxGrid, Clustering, Cubes, Execution, Extractor, IsosurfacePoints, Method, Placement,
        Source, Tetrahedra, accuracy_beside,
    };
    use isostudy_field::{Terrain, TerrainCharacter, TerrainSettings};

    const GRID: BoxGrid = BoxGrid {
        bounds: Bounds { min: Vec3::new(-1.0, -1.0, -0.5), max: Vec3::new(1.0, 1.0, 0.5) },
        spacing: 0.02,
    };

    fn ground() -> RegionSection {
        RegionSection { name: "ground".into(), min: [-0.85, -0.85, -0.37], max: [0.85, 0.85, 0.37] }
    }

    /// Terrain as in `configs/terrain.toml`, with walls so far from the box, in widths.
    fn of(character: TerrainCharacter, margin: f64, method: &Method) -> RegionMeasures {
        let settings = TerrainSettings { margin, ..character.settings(3) };
        let field = Terrain::try_new(settings, GRID.bounds).unwrap();
        let execution = Execution { threads: 2 };
        let source = Source::Study(&field);
        let mesh = method.extract(&mut Extractor::new(), source, &GRID, 0.0, &execution).unwrap().mesh;
        let points = IsosurfacePoints::of(&field, 0.0, &GRID, Some(bounds(&ground())), &execution).unwrap();
        let accuracy = accuracy_beside(&points, &mesh, &field, 0.0, GRID.spacing, &execution).unwrap();
        measures(&ground(), &mesh, &accuracy)
    }

    fn methods() -> [Method; 2] {
        let clustering = Clustering::Integrated;
        let tetrahedra = Tetrahedra::new(Arrangement::BodyCentred).with_clustering(clustering);
        let relaxed = tetrahedra.with_placement(Placement::Relaxed);
        [Method::Cubes(Cubes::default()), Method::Tetrahedra(relaxed)]
    }

    #[test]
    fn moving_the_walls_leaves_the_ground_as_it_is() {
        for method in methods() {
            let [near, far] = [0.013, 0.02].map(|margin| of(TerrainCharacter::Hills, margin, &method));
            assert!(near.area_share != far.area_share, "the whole has other walls");
            // Points of the surface are found by halving intervals that depend on the walls: the same but for rounding.
            let to_mesh = [&near, &far].map(|of| of.accuracy.distance_to_mesh.clone().unwrap());
            let [before, after] = &to_mesh;
            assert_eq!((before.count, &before.histogram), (after.count, &after.histogram));
            for (a, b) in [(before.mean, after.mean), (before.max, after.max), (before.sd, after.sd)] {
                assert!((a - b).abs() <= 1e-6 * a, "{a} is not {b}");
            }
            let rest = |of: RegionMeasures| RegionMeasures {
                area_share: 0.0,
                accuracy: isostudy_design::record::Accuracy { distance_to_mesh: None, ..of.accuracy },
                ..of
            };
            assert_eq!(rest(near), rest(far));
        }
    }

    /// The numbers are those of an independent check, whose ground reached to the walls: it found 41 % of the area of `mc` on hills to
    /// be ground, and 44 % on cliffs. This region has `(1.7 / 1.948)^2` of a flat ground.
    #[test]
    fn hills_and_cliffs_have_the_shapes_that_were_found_elsewhere() {
        let [mc, relaxed] = methods();
        let share = (1.7f64 / 1.948).powi(2);
        for (character, ground, mean) in
            [(TerrainCharacter::Hills, 0.41, 0.925), (TerrainCharacter::Cliffs, 0.44, 0.881)]
        {
            let found = of(character, 0.013, &mc);
            assert!((found.area_share / (ground * share) - 1.0).abs() < 0.08, "{}", found.area_share);
            let ratio = found.quality.radius_ratio.mean;
            assert!((0.66..0.71).contains(&ratio), "{ratio}");
            let ratio = of(character, 0.013, &relaxed).quality.radius_ratio.mean;
            assert!((ratio - mean).abs() < 0.01, "{ratio} is not {mean}");
        }
        assert_eq!(of(TerrainCharacter::Hills, 0.013, &mc).accuracy.sharp_edges.map(|of| of.count), Some(0));
    }
}
