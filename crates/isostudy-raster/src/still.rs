//! One picture in full colour.

use crate::colouring::Colouring;
use crate::fill::Painter;
use crate::level_colours::LevelColours;
use crate::samples::Samples;
use crate::surface::Surface;
use crate::{Camera, Look, RasterError, Shading, Viewport};
use isostudy_mesh::TriangleMesh;
use tiny_skia::{Pixmap, PremultipliedColorU8};

/// Draws `mesh` as `camera` sees it, on one thread. Every pixel is opaque and the mean of its samples' colours,
/// rounded to the nearest 8-bit level. Both sides of a triangle are drawn, with the colour of the normal as it is.
/// A mesh without triangles gives the background.
///
/// # Errors
/// [`RasterError`] for a viewport or camera out of range, a used vertex that is not finite, an index out of range,
/// an ambient light or a crease angle out of range, or missing normals (every look but [`Look::Flat`] takes vertex normals).
pub fn render(
    mesh: &TriangleMesh,
    camera: &Camera,
    viewport: Viewport,
    shading: &Shading,
    look: Look,
) -> Result<Pixmap, RasterError> {
    draw(mesh, None, camera, viewport, shading, look)
}

/// As [`render`], coloured by numbers: each sample has the colour of its number, darkened where the surface turns away
/// from the light, to no less than 0.8 of it. The scale is not in it; [`legend`](crate::legend()) draws it.
///
/// # Errors
/// As [`render`], and [`RasterError`] for numbers that are not as many as what they are for, or NaN.
pub fn render_coloured(
    mesh: &TriangleMesh,
    colouring: &Colouring,
    camera: &Camera,
    viewport: Viewport,
    shading: &Shading,
    look: Look,
) -> Result<Pixmap, RasterError> {
    draw(mesh, Some(colouring), camera, viewport, shading, look)
}

fn draw(
    mesh: &TriangleMesh,
    colouring: Option<&Colouring>,
    camera: &Camera,
    viewport: Viewport,
    shading: &Shading,
    look: Look,
) -> Result<Pixmap, RasterError> {
    viewport.check()?;
    camera.check()?;
    let surface = Surface::try_new(mesh, colouring, shading, look)?;
    let mut samples = Samples::new(&viewport);
    let mut painter = Painter::new(shading, look, surface.is_coloured(), &viewport);
    painter.draw(&surface, &surface.lit(shading), camera, &viewport, &mut samples);
    let colours = match colouring {
        None => LevelColours::new(shading),
        Some(_) => LevelColours::of_numbers(shading),
    };
    Ok(to_pixmap(&samples, &viewport, &colours))
}

fn to_pixmap(samples: &Samples, viewport: &Viewport, colours: &LevelColours) -> Pixmap {
    let Viewport { width, height, supersampling } = *viewport;
    let mut pixmap = Pixmap::new(width, height).expect("a checked viewport has a pixel");
    let s = supersampling as usize;
    let mut levels = Vec::with_capacity(s * s);
    for (i, pixel) in pixmap.pixels_mut().iter_mut().enumerate() {
        let (x, y) = (i % width as usize, i / width as usize);
        levels.clear();
        for row in 0..s {
            let from = (y * s + row) * samples.stride + x * s;
            levels.extend_from_slice(&samples.level[from..from + s]);
        }
        let [r, g, b] = colours.mean(&levels).map(|v| (v + 0.5) as u8);
        *pixel = PremultipliedColorU8::from_rgba(r, g, b, 255).expect("opaque");
    }
    pixmap
}
