//! One picture in full colour.

use crate::fill::Painter;
use crate::level_colours::LevelColours;
use crate::samples::Samples;
use crate::surface::Surface;
use crate::{Camera, Look, RasterError, Shading, Viewport};
use mesh::TriangleMesh;
use tiny_skia::{Pixmap, PremultipliedColorU8};

/// Draws `mesh` as `camera` sees it, on one thread. Every pixel is opaque and the mean of its samples' colours,
/// rounded to the nearest 8-bit level. Both sides of a triangle are drawn, with the colour of the normal as it is.
/// A mesh without triangles gives the background.
///
/// # Errors
/// [`RasterError`] for a viewport or camera out of range, a used vertex that is not finite, an index out of range,
/// or missing normals (every look but [`Look::Flat`] takes vertex normals).
pub fn render(
    mesh: &TriangleMesh,
    camera: &Camera,
    viewport: Viewport,
    shading: &Shading,
    look: Look,
) -> Result<Pixmap, RasterError> {
    viewport.check()?;
    camera.check()?;
    let surface = Surface::try_new(mesh, shading, look)?;
    let mut samples = Samples::new(&viewport);
    Painter::new(shading, look, &viewport).draw(&surface, camera, &viewport, &mut samples);
    Ok(to_pixmap(&samples, &viewport, &LevelColours::new(shading)))
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
