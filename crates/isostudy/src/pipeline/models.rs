//! Pairs as models: both meshes of a pair in one file, for participants who turn them.

use super::viewer::beside_a_page;
use super::{Meshes, Pipeline};
use crate::store::{Inputs, Stamp};
use crate::terminal::progress::Step;
use crate::{picture, source_digests};
use anyhow::{Context, Result, bail, ensure};
use isostudy_design::config::{LightFollows, Presentation, StimulusLook};
use isostudy_design::forms::Stimulus;
use isostudy_design::record::Purpose;
use isostudy_design::{Configuration, Study};
use isostudy_mesh::{TriangleMesh, corner_normals};
use isostudy_serve::page::{LibraryFile, ModelShading, model_scripts};
use rayon::prelude::*;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

const FOLDER: &str = "stimuli/models";

/// Most bytes of a pair's models.
pub(crate) const MOST_BYTES: u64 = 2_000_000;

/// Where the models of pairs are.
pub(crate) fn models_folder(results: &Path) -> PathBuf {
    results.join(FOLDER)
}

/// Files that the page needs to draw models; none for a study that shows none.
///
/// # Errors
/// If three.js is not where the study says, or is of another version.
pub(crate) fn library_of_models(study: &Study) -> Result<Vec<LibraryFile>> {
    if !shows_models(study) {
        return Ok(Vec::new());
    }
    let folder = study.file.three().context("checked when the study was read")?;
    let Some(mut files) = beside_a_page(&study.resolve(folder))? else {
        bail!(
            "{}: forms.stimulus = \"model\" needs three.js, which is not in {folder}; `make three` fetches it",
            study.path.display()
        );
    };
    files.extend(model_scripts());
    Ok(files)
}

fn shows_models(study: &Study) -> bool {
    study.file.forms.as_ref().is_some_and(|forms| forms.stimulus == Presentation::Model)
}

/// Light and colours of models; `None` for a study that shows none.
pub(super) fn shading_of_models(study: &Study) -> Option<ModelShading> {
    let section = &study.file.shading;
    let own = picture::shading(section);
    shows_models(study).then(|| ModelShading {
        light: section.light,
        follows: section.light_follows == LightFollows::Camera,
        ambient: section.ambient,
        lit: section.lit,
        shade: section.shade,
        highlight: section.highlight,
        background: section.background,
        wire: own.wire.map(f64::from),
        wire_width: f64::from(own.wire_width_px) / f64::from(study.file.turntable.height),
    })
}

impl Pipeline<'_> {
    /// Every pair that anybody is shown as models in one file; none for a study that shows none.
    ///
    /// # Errors
    /// If a mesh cannot be read, or a file not be written.
    pub(crate) fn models(&self, meshes: &Meshes) -> Result<Vec<Stamp>> {
        if !shows_models(self.study) {
            self.store.retire_untouched(|stage| !stage.starts_with("model/"))?;
            return Ok(Vec::new());
        }
        let stimuli = self.study.stimuli();
        let step = Step::begin("models", stimuli.len(), stimuli.len());
        let one = |stimulus: &Stimulus| {
            let stamp = self.model(stimulus, meshes)?;
            step.tick(1);
            step.count(stamp.redone);
            Ok(stamp)
        };
        let stamps: Vec<Stamp> = stimuli.par_iter().map(one).collect::<Result<_>>()?;
        step.end();
        Ok(stamps)
    }

    fn model(&self, stimulus: &Stimulus, meshes: &Meshes) -> Result<Stamp> {
        let Stimulus { code, shown } = stimulus;
        // Models are of ways to ask that show two.
        let [left, right] = [&shown[0], &shown[1]];
        let sides = [left, right].map(|id| self.configuration(id));
        let looks = sides.map(|side| self.study.look(side));
        let (camera, crease) = (camera(self.study, sides[0]), self.study.file.shading.crease_deg);
        let mut inputs = Inputs::of_sources(source_digests::PICTURES)
            .text("code", code)
            .value("looks", &looks)
            .value("crease", &crease)
            .value("camera", &camera);
        for side in sides {
            inputs = inputs.stamp(meshes.stamp(&side.id, Purpose::Stimulus));
        }
        self.stage(&format!("model/{left}~{right}"), inputs, |writer| {
            let read = |side: &Configuration| self.read_mesh(meshes.stamp(&side.id, Purpose::Stimulus));
            let [left, right] = [read(sides[0])?, read(sides[1])?];
            let halves = [(&left, looks[0]), (&right, looks[1])];
            writer.write(&format!("{FOLDER}/{code}.glb"), &pair(halves, crease as f32, &camera)?)
        })
    }
}

/// From where the turntable's first frame is taken: radians, and the mesh's unit of length.
fn camera(study: &Study, configuration: &Configuration) -> Value {
    let turntable = picture::turntable(&study.file.turntable, &study.object(configuration).camera);
    json!({
        // The first frame of every turn: crates/isostudy-raster/src/turntable.rs.
        "azimuth": std::f64::consts::FRAC_PI_4,
        "elevation": f64::from(turntable.eye_elevation_rad()),
        "distance": f64::from(turntable.eye_distance()),
        "middle_z": f64::from(turntable.middle_z),
        "vertical_fov_rad": f64::from(turntable.vertical_fov_rad),
    })
}

/// Binary glTF with `KHR_mesh_quantization`: two nodes, the left one first, each with a mesh as [`write_compact_glb`] writes it, and
/// the look in `meshes[].extras.look`; the camera is `scenes[0].extras.camera`.
///
/// [`write_compact_glb`]: isostudy_mesh::write_compact_glb
fn pair(halves: [(&TriangleMesh, StimulusLook); 2], crease_deg: f32, camera: &Value) -> Result<Vec<u8>> {
    let (mut nodes, mut meshes, mut accessors, mut views) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let mut buffer: Vec<u8> = Vec::new();
    let moved = |value: &Value, by: usize| json!(value.as_u64().unwrap_or(0) + by as u64);
    for (mesh, look) in halves {
        let mut bytes = Vec::new();
        let creased = (look == StimulusLook::Creased).then(|| corner_normals(mesh, crease_deg).split(mesh));
        isostudy_mesh::write_compact_glb(creased.as_ref().unwrap_or(mesh), &[], &[], &mut bytes)?;
        let (mut own, binary) = chunks(&bytes)?;
        let (first_view, first_accessor) = (views.len(), accessors.len());
        // A mesh without triangles is a node without a mesh.
        let Some(mut node) = own["nodes"].get(0).cloned() else {
            nodes.push(json!({}));
            continue;
        };
        node["mesh"] = json!(meshes.len());
        nodes.push(node);
        let primitive = &mut own["meshes"][0]["primitives"][0];
        for name in ["POSITION", "NORMAL"] {
            ensure!(primitive["attributes"][name].is_u64(), "a stimulus has no normals");
            primitive["attributes"][name] = moved(&primitive["attributes"][name], first_accessor);
        }
        primitive["indices"] = moved(&primitive["indices"], first_accessor);
        meshes.push(json!({"primitives": [primitive.clone()], "extras": {"look": look}}));
        for mut accessor in list(&mut own["accessors"]) {
            accessor["bufferView"] = moved(&accessor["bufferView"], first_view);
            accessors.push(accessor);
        }
        for mut view in list(&mut own["bufferViews"]) {
            view["byteOffset"] = moved(&view["byteOffset"], buffer.len());
            views.push(view);
        }
        buffer.extend(binary);
    }
    let mut file = json!({
        "asset": {"version": "2.0", "generator": "isostudy"},
        "extensionsUsed": ["KHR_mesh_quantization"],
        "extensionsRequired": ["KHR_mesh_quantization"],
        "scene": 0,
        "scenes": [{"nodes": [0, 1], "extras": {"camera": camera}}],
        "nodes": nodes,
    });
    if !meshes.is_empty() {
        file["materials"] = json!([{"doubleSided": true, "pbrMetallicRoughness": {"metallicFactor": 0}}]);
        file["meshes"] = json!(meshes);
        file["accessors"] = json!(accessors);
        file["bufferViews"] = json!(views);
        file["buffers"] = json!([{"byteLength": buffer.len()}]);
    }
    let mut text = serde_json::to_vec(&file)?;
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut glb = Vec::new();
    glb.extend(b"glTF");
    glb.extend(2u32.to_le_bytes());
    glb.extend(0u32.to_le_bytes());
    add_chunk(&mut glb, *b"JSON", &text)?;
    add_chunk(&mut glb, *b"BIN\0", &buffer)?;
    Ok(glb)
}

fn list(value: &mut Value) -> Vec<Value> {
    value.as_array_mut().map(std::mem::take).unwrap_or_default()
}

/// Adds a chunk to a binary glTF file, whose head then tells the new length. Readers pass over chunks of types that they do not
/// know.
pub(super) fn add_chunk(glb: &mut Vec<u8>, kind: [u8; 4], content: &[u8]) -> Result<()> {
    glb.extend(u32::try_from(content.len())?.to_le_bytes());
    glb.extend(kind);
    glb.extend(content);
    let length = u32::try_from(glb.len())?.to_le_bytes();
    glb[8..12].copy_from_slice(&length);
    Ok(())
}

/// The JSON and the bytes of a file that [`write_compact_glb`](isostudy_mesh::write_compact_glb) wrote.
fn chunks(glb: &[u8]) -> Result<(Value, &[u8])> {
    let length = u32::from_le_bytes(glb[12..16].try_into()?) as usize;
    let (text, rest) = glb[20..].split_at(length);
    Ok((serde_json::from_slice(text)?, rest.get(8..).unwrap_or_default()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// Four triangles of a pyramid, `high` above the plane.
    fn pyramid(high: f32) -> TriangleMesh {
        let positions = vec![
            Vec3::new(-1.0, -1.0, 0.0),
            Vec3::new(1.0, -1.0, 0.0),
            Vec3::new(1.0, 1.0, 0.0),
            Vec3::new(-1.0, 1.0, 0.0),
            Vec3::new(0.25, 0.125, high),
        ];
        let normals = positions.iter().map(|p| (*p + Vec3::Z).normalize()).collect();
        TriangleMesh { positions, normals, triangles: vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]] }
    }

    /// Positions and normals of a node's mesh, corner by corner, as a reader of glTF finds them.
    fn corners(file: &Value, binary: &[u8], node: usize) -> Vec<([f64; 3], [f64; 3])> {
        let node = &file["nodes"][node];
        let number = |value: &Value| value.as_u64().unwrap_or(0) as usize;
        let primitive = &file["meshes"][number(&node["mesh"])]["primitives"][0];
        let start = |accessor: &Value| {
            let accessor = &file["accessors"][number(accessor)];
            let view = &file["bufferViews"][number(&accessor["bufferView"])];
            (number(&view["byteOffset"]), number(&view["byteStride"]), number(&accessor["count"]))
        };
        let (indices, _, count) = start(&primitive["indices"]);
        let (positions, stride, _) = start(&primitive["attributes"]["POSITION"]);
        let (normals, normal_stride, _) = start(&primitive["attributes"]["NORMAL"]);
        let short = |at: usize| u16::from_le_bytes([binary[at], binary[at + 1]]);
        let corner = |i: usize| {
            let vertex = usize::from(short(indices + 2 * i));
            let axes = [0, 1, 2];
            let position = axes.map(|k| {
                let step = f64::from(short(positions + vertex * stride + 2 * k));
                step * node["scale"][k].as_f64().unwrap() + node["translation"][k].as_f64().unwrap()
            });
            let normal = axes.map(|k| f64::from(binary[normals + vertex * normal_stride + k] as i8) / 127.0);
            (position, normal)
        };
        (0..count).map(corner).collect()
    }

    /// Both meshes come back, the left one first, within half a step of 1/65,535 of the longest side, and normals within half a step of
    /// 1/127; and the file names nothing.
    #[test]
    fn both_meshes_come_back_within_half_a_step() {
        let (left, right) = (pyramid(1.0), pyramid(3.0));
        let looks = [StimulusLook::Smooth, StimulusLook::Flat];
        let glb = pair([(&left, looks[0]), (&right, looks[1])], 40.0, &json!({"distance": 2.0})).unwrap();
        assert_eq!(u32::from_le_bytes(glb[8..12].try_into().unwrap()) as usize, glb.len());
        let (file, binary) = chunks(&glb).unwrap();
        assert_eq!(file["scenes"][0]["extras"]["camera"]["distance"], 2.0);
        for (node, mesh) in [&left, &right].into_iter().enumerate() {
            let look = if node == 0 { "smooth" } else { "flat" };
            assert_eq!(file["meshes"][node]["extras"], json!({"look": look}));
            let longest = mesh.bounds().unwrap().size().max_element();
            let found = corners(&file, binary, node);
            assert_eq!(found.len(), 12);
            for (vertex, (position, normal)) in mesh.triangles.as_flattened().iter().zip(found) {
                let vertex = *vertex as usize;
                for k in 0..3 {
                    let off = (position[k] - f64::from(mesh.positions[vertex][k])).abs();
                    assert!(off <= 0.5001 * f64::from(longest) / 65_535.0, "{off}");
                    let off = (normal[k] - f64::from(mesh.normals[vertex][k])).abs();
                    assert!(off <= 0.5001 / 127.0, "{off}");
                }
            }
        }
        let mut names: Vec<&String> = file.as_object().unwrap().keys().collect();
        names.sort();
        assert!(
            !names.contains(&&"extras".to_owned()) && file["nodes"][0].get("name").is_none(),
            "{names:?}"
        );
    }

    /// A crease has corners with normals of their own: no corner of the pyramid is smooth.
    #[test]
    fn creases_are_in_the_file() {
        let mesh = pyramid(3.0);
        let looks = [StimulusLook::Creased, StimulusLook::Smooth];
        let glb = pair([(&mesh, looks[0]), (&mesh, looks[1])], 40.0, &json!({})).unwrap();
        let (file, binary) = chunks(&glb).unwrap();
        let apex = |node: usize| {
            let of = corners(&file, binary, node);
            [2, 5, 8, 11].map(|corner| of[corner].1.map(|along| (1000.0 * along) as i64))
        };
        assert!(apex(1).iter().all(|normal| *normal == apex(1)[0]));
        assert!(apex(0).iter().all(|normal| apex(0).iter().filter(|other| *other == normal).count() == 1));
    }

    #[test]
    fn a_mesh_without_triangles_is_an_empty_half() {
        let empty = TriangleMesh::default();
        let mesh = pyramid(1.0);
        let look = StimulusLook::Smooth;
        let glb = pair([(&empty, look), (&mesh, look)], 40.0, &json!({})).unwrap();
        let (file, binary) = chunks(&glb).unwrap();
        assert_eq!((&file["nodes"][0], file["nodes"][1]["mesh"].as_u64()), (&json!({}), Some(0)));
        assert_eq!(corners(&file, binary, 1).len(), 12);
    }
}
