//! From a study's words to the rasteriser's, and figures of still pictures. The one place where `design` meets `raster`.

use anyhow::Result;
use base64::Engine;
use isostudy_design::config::{
    CameraSection, LightFollows, Look, ShadingSection, StimulusLook, TurntableSection,
};
use isostudy_mesh::TriangleMesh;
use isostudy_raster::tiny_skia::{Color, Pixmap, PixmapPaint, Transform};
use isostudy_raster::{Animation, Colouring, Palette, Panel, Shading, Sheet, Turntable, Viewport};

/// A figure as a picture and as a scalable page with the pictures in it and captions as text.
pub(crate) struct StillSheet {
    pub(crate) png: Vec<u8>,
    pub(crate) svg: String,
}

pub(crate) fn turntable(section: &TurntableSection, camera: &CameraSection) -> Turntable {
    Turntable {
        width: section.width,
        height: section.height,
        frames: section.frames,
        duration_s: section.duration_s,
        middle_z: camera.middle_z as f32,
        distance: camera.distance as f32,
        elevation_rad: section.elevation_rad as f32,
        vertical_fov_rad: camera.vertical_fov_rad as f32,
        near: section.near as f32,
        far: section.far as f32,
        supersampling: section.supersampling,
    }
}

pub(crate) fn shading(section: &ShadingSection) -> Shading {
    let colour = |c: [f64; 3]| c.map(|x| x as f32);
    Shading {
        light: colour(section.light),
        lit: colour(section.lit),
        shade: colour(section.shade),
        highlight: colour(section.highlight),
        background: colour(section.background),
        light_follows: light_follows(section.light_follows),
        ambient: section.ambient as f32,
        crease_deg: section.crease_deg as f32,
        ..Shading::default()
    }
}

/// The rasteriser's word for what the light is fixed to.
pub(crate) fn light_follows(follows: LightFollows) -> isostudy_raster::LightFollows {
    match follows {
        LightFollows::Scene => isostudy_raster::LightFollows::Scene,
        LightFollows::Camera => isostudy_raster::LightFollows::Camera,
    }
}

/// A look as the rasteriser takes it.
pub(crate) struct Drawn {
    look: isostudy_raster::Look,
    /// What colours the mesh, if it is not its material.
    colouring: Option<Colouring>,
}

impl Drawn {
    /// What `look` is for a mesh; `error` gives the colours of [`Look::Error`] and is asked for nothing else. Numbers
    /// of triangles are shown on flat ones, so that each can be told from its neighbours.
    ///
    /// # Errors
    /// What `error` returns.
    pub(crate) fn new(
        mesh: &TriangleMesh,
        look: Look,
        error: impl FnOnce() -> Result<Colouring>,
    ) -> Result<Self> {
        let colouring = match look {
            Look::Smooth | Look::Flat | Look::Wireframe | Look::SmoothWireframe | Look::Creased => None,
            Look::Quality => Some(Colouring::radius_ratio(mesh)),
            Look::Error => Some(error()?),
        };
        Ok(Self { look: raster_look(look), colouring })
    }

    /// With numbers, if any, in another look.
    pub(crate) fn with_look(self, look: Look) -> Self {
        Self { look: raster_look(look), ..self }
    }

    /// One turn, with the scale of numbers below.
    ///
    /// # Errors
    /// If the rasteriser refuses mesh or camera.
    pub(crate) fn turned(
        &self,
        mesh: &TriangleMesh,
        turntable: &Turntable,
        shading: &Shading,
    ) -> Result<Animation> {
        Ok(match &self.colouring {
            None => isostudy_raster::turntable(mesh, turntable, shading, self.look, &|| ())?,
            Some(colouring) => {
                isostudy_raster::turntable_coloured(mesh, colouring, turntable, shading, self.look, &|| ())?
            }
        })
    }

    /// The first frame.
    ///
    /// # Errors
    /// If the rasteriser refuses mesh or camera.
    pub(crate) fn first_frame(
        &self,
        mesh: &TriangleMesh,
        turntable: &Turntable,
        shading: &Shading,
    ) -> Result<Pixmap> {
        Ok(self.still(mesh, turntable, shading)?.0)
    }

    /// The first frame, and the scale of numbers that belongs below it.
    fn still(
        &self,
        mesh: &TriangleMesh,
        turntable: &Turntable,
        shading: &Shading,
    ) -> Result<(Pixmap, Option<Pixmap>)> {
        let (camera, viewport) = (turntable.camera(0), turntable.viewport());
        Ok(match &self.colouring {
            None => (isostudy_raster::render(mesh, &camera, viewport, shading, self.look)?, None),
            Some(colouring) => (
                isostudy_raster::render_coloured(mesh, colouring, &camera, viewport, shading, self.look)?,
                Some(isostudy_raster::legend(&colouring.scale, turntable.width)),
            ),
        })
    }
}

/// One turn of a mesh as people are shown it, in its look, with the colours that all `looks` of the study have in common:
/// any two of its turntables make a pair.
///
/// # Errors
/// If the rasteriser refuses mesh or camera.
pub(crate) fn stimulus(
    mesh: &TriangleMesh,
    turntable: &Turntable,
    shading: &Shading,
    look: StimulusLook,
    looks: &[StimulusLook],
    on_frame: &(dyn Fn() + Sync),
) -> Result<Animation> {
    let looks: Vec<isostudy_raster::Look> = looks.iter().map(|&look| raster_look(look.into())).collect();
    let palette = Palette::of_looks(shading, &looks);
    Ok(isostudy_raster::turntable_in(mesh, turntable, shading, raster_look(look.into()), &palette, on_frame)?)
}

/// The first frame of the turntable in several looks, side by side.
///
/// # Errors
/// If the rasteriser refuses mesh or camera.
pub(crate) fn still_sheet(
    mesh: &TriangleMesh,
    turntable: &Turntable,
    shading: &Shading,
    looks: &[(Look, Drawn)],
) -> Result<StillSheet> {
    let mut pictures = Vec::new();
    for (i, (look, drawn)) in looks.iter().enumerate() {
        let label = format!("({}) {}", char::from(b'a' + (i % 26) as u8), look.label());
        pictures.push((drawn.still(mesh, turntable, shading)?, label));
    }
    // All as high as the highest, so that they stand in one line.
    let room = pictures.iter().filter_map(|((_, scale), _)| scale.as_ref()).map(Pixmap::height).max();
    let pictures: Vec<(Pixmap, String)> = pictures
        .into_iter()
        .map(|((picture, scale), label)| match room {
            None => (picture, label),
            Some(room) => (with_room_below(&picture, scale.as_ref(), room), label),
        })
        .collect();
    let panels: Vec<Panel<'_>> = pictures.iter().map(|(picture, label)| Panel { picture, label }).collect();
    let sheet = Sheet { columns: looks.len(), ..Sheet::default() };
    let png = isostudy_raster::pixmap_to_png(&isostudy_raster::panels(&panels, &sheet)?);
    Ok(StillSheet { png, svg: svg(&panels) })
}

/// The first frame of a turntable, its longer side `side_px` long.
///
/// # Errors
/// If the rasteriser refuses mesh or camera.
pub(crate) fn thumbnail(
    mesh: &TriangleMesh,
    turntable: &Turntable,
    shading: &Shading,
    look: StimulusLook,
    side_px: u32,
) -> Result<Pixmap> {
    let longer = f64::from(turntable.width.max(turntable.height));
    let shrunk = |pixels: u32| (f64::from(pixels * side_px) / longer).round().max(1.0) as u32;
    let (width, height) = (shrunk(turntable.width), shrunk(turntable.height));
    let viewport = Viewport { width, height, ..turntable.viewport() };
    Ok(isostudy_raster::render(mesh, &turntable.camera(0), viewport, shading, raster_look(look.into()))?)
}

/// A picture over `room` pixels of white paper, on which the scale lies, if there is one.
fn with_room_below(picture: &Pixmap, scale: Option<&Pixmap>, room: u32) -> Pixmap {
    let mut both = Pixmap::new(picture.width(), picture.height() + room).expect("a picture has pixels");
    both.fill(Color::WHITE);
    let (paint, still) = (PixmapPaint::default(), Transform::identity());
    both.draw_pixmap(0, 0, picture.as_ref(), &paint, still, None);
    if let Some(scale) = scale {
        both.draw_pixmap(0, picture.height() as i32, scale.as_ref(), &paint, still, None);
    }
    both
}

/// Two pictures of one size, edge to edge.
pub(crate) fn in_a_row(all: &[&Pixmap]) -> Pixmap {
    let width = all.iter().map(|one| one.width()).sum();
    let height = all.iter().map(|one| one.height()).max().unwrap_or(0);
    let mut row = Pixmap::new(width, height).expect("pictures have pixels");
    let (paint, still) = (PixmapPaint::default(), Transform::identity());
    let mut left = 0;
    for one in all {
        row.draw_pixmap(left, 0, one.as_ref(), &paint, still, None);
        left += one.width() as i32;
    }
    row
}

/// Labelled pictures in rows, as a PNG.
///
/// # Errors
/// If the sheet would be larger than a picture can be.
pub(crate) fn contact_sheet(pictures: &[(String, Pixmap)], title: &str) -> Result<Vec<u8>> {
    let panels: Vec<Panel<'_>> = pictures.iter().map(|(label, picture)| Panel { picture, label }).collect();
    let sheet = Sheet { columns: 6, title: Some(title.into()), text_px: 15.0, ..Sheet::default() };
    Ok(isostudy_raster::pixmap_to_png(&isostudy_raster::panels(&panels, &sheet)?))
}

fn raster_look(look: Look) -> isostudy_raster::Look {
    match look {
        Look::Smooth => isostudy_raster::Look::Smooth,
        Look::Flat | Look::Quality | Look::Error => isostudy_raster::Look::Flat,
        Look::Wireframe => isostudy_raster::Look::Wireframe,
        Look::SmoothWireframe => isostudy_raster::Look::SmoothWireframe,
        Look::Creased => isostudy_raster::Look::Creased,
    }
}

/// A shaded surface has no better scalable form than its pixels; the captions have.
fn svg(panels: &[Panel<'_>]) -> String {
    const GAP: u32 = 12;
    const TEXT: u32 = 18;
    let (w, h) = panels.first().map_or((0, 0), |p| (p.picture.width(), p.picture.height()));
    let width = panels.len() as u32 * (w + GAP) + GAP;
    let height = h + 3 * GAP + TEXT;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
         height=\"{height}\">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n"
    );
    for (i, panel) in panels.iter().enumerate() {
        let x = GAP + i as u32 * (w + GAP);
        let png =
            base64::engine::general_purpose::STANDARD.encode(isostudy_raster::pixmap_to_png(panel.picture));
        svg += &format!(
            "<image x=\"{x}\" y=\"{GAP}\" width=\"{w}\" height=\"{h}\" href=\"data:image/png;base64,{png}\"/>\n\
             <text x=\"{}\" y=\"{}\" font-family=\"DejaVu Sans, sans-serif\" font-size=\"{TEXT}\" \
             text-anchor=\"middle\" fill=\"#222\">{}</text>\n",
            x + w / 2,
            GAP + h + GAP + TEXT,
            panel.label,
        );
    }
    svg + "</svg>\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fields::Fields;
    use crate::{prepare, recipe};
    use isostudy_design::Study;
    use isostudy_design::record::Purpose;
    use isostudy_extract::{Execution, Extractor};
    use isostudy_mesh::corner_normals;
    use std::path::Path;

    /// In all frames of the terrain study, by projecting the vertices: the box round each object takes at least half of the frame, and
    /// nothing is cut off. The small study has the same cameras.
    #[test]
    fn terrain_fills_its_frames() {
        let configs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs");
        let study = Study::load(&configs.join("terrain.toml")).unwrap();
        let small = Study::load(&configs.join("terrain-quick.toml")).unwrap();
        let fields = Fields::new(&study);
        for (index, object) in study.file.objects.iter().enumerate() {
            let camera = |of: &CameraSection| [of.distance, of.vertical_fov_rad, of.middle_z];
            assert_eq!(camera(&object.camera), camera(&small.file.objects[index].camera));
            let turn = turntable(&study.file.turntable, &object.camera);
            let made = fields.get(index).unwrap();
            for id in ["mc", "dc-in-cell"] {
                let id = id.parse().unwrap();
                let recipe::Recipe::Extractor(method) =
                    recipe::recipe(&study, id, Purpose::Stimulus).unwrap()
                else {
                    panic!("{id} is a program")
                };
                let grid = prepare::grid(object, object.stimulus_spacing);
                let field: &dyn isostudy_field::StudyField = &*made.field;
                let extraction = method
                    .extract(
                        &mut Extractor::new(),
                        field.into(),
                        &grid,
                        made.isovalue,
                        &Execution { threads: 1 },
                    )
                    .unwrap();
                let mesh = extraction.mesh;
                let viewport = turn.viewport();
                let mut least = f32::MAX;
                for frame in 0..turn.frames {
                    let camera = turn.camera(frame);
                    let (mut low, mut high) = ([f32::MAX; 2], [f32::MIN; 2]);
                    for &position in &mesh.positions {
                        let (at, _) = camera.project(position, &viewport).expect("between the planes");
                        low = [0, 1].map(|k| low[k].min(at[k]));
                        high = [0, 1].map(|k| high[k].max(at[k]));
                    }
                    let size = [viewport.width, viewport.height].map(|side| side as f32);
                    assert!(low.iter().all(|v| *v > 1.0), "{}, {id}, {frame}: {low:?}", object.id);
                    assert!(
                        (0..2).all(|k| high[k] < size[k] - 1.0),
                        "{}, {id}, {frame}: {high:?}",
                        object.id
                    );
                    least = least.min((high[0] - low[0]) * (high[1] - low[1]) / (size[0] * size[1]));
                }
                let mut creased = corner_normals(&mesh, study.file.shading.crease_deg as f32).copies;
                creased.dedup();
                let share = 100.0 * creased.len() as f64 / mesh.positions.len() as f64;
                println!(
                    "{}, {id}: at least {:.0} % of a frame; {share:.0} % of vertices at creases",
                    object.name,
                    100.0 * least
                );
                assert!(least >= 0.5, "{}, {id}: {least}", object.id);
            }
        }
    }
}
