//! What the viewer knows of a study: its objects, methods and meshes, and the numbers of each mesh.

use super::levels::{Entry, Level};
use crate::pipeline::pictures::ShownFirst;
use isostudy_design::config::{CameraSection, ShadingSection};
use isostudy_design::record::MeshRecord;
use isostudy_design::{ConfigurationId, Study};
use serde::Serialize;

/// All of it.
#[derive(Serialize)]
pub(super) struct Catalogue<'a> {
    title: &'a str,
    objects: Vec<Object<'a>>,
    /// The object that is shown first, as on the other pages.
    first: &'a str,
    /// The two meshes that are shown first: of that object, the one that lies nearest to the isosurface and the one that lies
    /// farthest from it.
    opening: Option<&'a [ConfigurationId; 2]>,
    /// How high the eye stands at first.
    elevation_rad: f64,
    shading: &'a ShadingSection,
    /// Multiples of the spacing of the animations, from fine to coarse.
    factors: Vec<f64>,
    meshes: Vec<Mesh>,
    /// Configurations that the study left out, and why.
    left_out: Vec<(ConfigurationId, String)>,
    /// Paths of the files with meshes; equal meshes share one. Not for the page, which holds them.
    #[serde(skip)]
    pub(super) files: Vec<String>,
}

#[derive(Serialize)]
struct Object<'a> {
    id: &'a str,
    name: &'a str,
    camera: &'a CameraSection,
}

/// One configuration.
#[derive(Serialize)]
struct Mesh {
    id: ConfigurationId,
    object: String,
    label: String,
    levels: Vec<Resolution>,
}

#[derive(Serialize)]
struct Resolution {
    factor: f64,
    spacing: f64,
    /// Which of the embedded meshes.
    file: Option<usize>,
    numbers: Option<Numbers>,
    missing: Option<String>,
}

/// Names as in the study's tables.
#[derive(Serialize)]
struct Numbers {
    triangles: u64,
    vertices: u64,
    radius_ratio_mean: f64,
    min_angle_deg_min: f64,
    distance_mean: f64,
    distance_max: f64,
    distance_to_mesh_max: Option<f64>,
    normal_error_mean_deg: f64,
    normal_error_q95_deg: f64,
    euler_characteristic: i64,
    components: u64,
    boundary_edges: u64,
    non_manifold_edges: u64,
    self_intersections: Option<u64>,
}

impl<'a> Catalogue<'a> {
    /// `levels` are configuration by configuration.
    pub(super) fn of(
        study: &'a Study,
        levels: &[Level],
        left_out: &[(ConfigurationId, String)],
        shown: &'a ShownFirst,
    ) -> Self {
        let mut digests: Vec<&str> = Vec::new();
        let mut files = Vec::new();
        let mut meshes: Vec<Mesh> = Vec::new();
        for level in levels {
            let file = level.mesh_file().zip(level.mesh_digest()).map(|(path, digest)| {
                digests.iter().position(|known| *known == digest).unwrap_or_else(|| {
                    digests.push(digest);
                    files.push(path.to_owned());
                    files.len() - 1
                })
            });
            let Entry { factor, spacing, mesh, missing, .. } = &level.entry;
            let numbers = mesh.as_ref().map(Numbers::of);
            let resolution =
                Resolution { factor: *factor, spacing: *spacing, file, numbers, missing: missing.clone() };
            match meshes.last_mut().filter(|mesh| mesh.id == level.id) {
                Some(mesh) => mesh.levels.push(resolution),
                None => meshes.push(Mesh {
                    id: level.id.clone(),
                    object: level.id.object.clone(),
                    label: study.method(level.id.method).label.clone(),
                    levels: vec![resolution],
                }),
            }
        }
        let mut factors: Vec<f64> = levels.iter().map(|level| level.entry.factor).collect();
        factors.sort_by(f64::total_cmp);
        factors.dedup();
        let object = |of: &'a isostudy_design::config::ObjectSection| Object {
            id: &of.id,
            name: &of.name,
            camera: &of.camera,
        };
        Self {
            title: &study.file.study.title,
            objects: study.file.objects.iter().map(object).collect(),
            first: &study.file.objects[shown.object].id,
            opening: shown.pair.as_ref(),
            elevation_rad: study.file.turntable.elevation_rad,
            shading: &study.file.shading,
            factors,
            meshes,
            left_out: left_out.to_vec(),
            files,
        }
    }
}

impl Numbers {
    fn of(record: &MeshRecord) -> Self {
        let MeshRecord { counts, quality, topology, accuracy, .. } = record;
        Self {
            triangles: counts.triangles,
            vertices: counts.vertices,
            radius_ratio_mean: quality.radius_ratio.mean,
            min_angle_deg_min: quality.min_angle_deg.min,
            distance_mean: accuracy.distance.mean,
            distance_max: accuracy.distance.max,
            distance_to_mesh_max: accuracy.distance_to_mesh.as_ref().map(|back| back.max),
            normal_error_mean_deg: accuracy.normal_error_deg.mean,
            normal_error_q95_deg: accuracy.normal_error_deg.q95,
            euler_characteristic: topology.euler_characteristic,
            components: topology.components,
            boundary_edges: topology.boundary_edges,
            non_manifold_edges: topology.non_manifold_edges,
            self_intersections: topology.self_intersections,
        }
    }
}
