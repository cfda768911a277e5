//! Turntables of triangle meshes: camera, depth buffer, looks, palette, GIF, pairs and labelled sheets.
//!
//! ```text
//! TriangleMesh ── surface ──┐
//! Turntable ── camera ──────┼── fill ── samples ──┬── still ──────── Pixmap ── panels ── PNG
//! Shading, Look ────────────┤                     └── palette index ─ Animation ── pair ── GIF
//! Colouring ────────────────┘
//! ```
//!
//! A still is full colour ([`render`]); an animation is palette indices from the start ([`turntable()`]), so that
//! pairs are put together from finished turntables without drawing or quantising anything twice.
//!
//! A [`Film`] is of pictures that were made elsewhere.
//!
//! A surface shows its material, or, with a [`Colouring`], numbers of its triangles or vertices on a labelled [`Scale`].
//!
//! # Guarantees
//! - Fills are watertight: a sample on an edge shared by two triangles is drawn exactly once (top-left rule on
//!   coordinates snapped to 1/256 of a sample).
//! - The same input gives the same bytes with any number of threads, on any machine.
//! - Turntables of one [`Shading`] and one [`Look`] share one palette; those of several looks can
//!   ([`Palette::of_looks`]).
//! - Files carry pixels, delay and loop flag: no comment, no time, no name.
//!
//! # Non-guarantees
//! - Out of scope: textures, shadows, transparency, gamma-correct blending (colours go to the 8-bit frame as the
//!   shader's numbers, as in the dissertation's animations).

mod animation;
mod camera;
mod clip;
mod colour_index;
mod colour_map;
mod colouring;
mod error;
mod fill;
mod film;
mod gif_file;
mod index_table;
mod legend;
mod level_colours;
mod nearest;
mod palette;
mod panels;
mod png_file;
mod reduced;
mod samples;
mod shading;
mod still;
mod surface;
mod text;
mod turntable;

pub use animation::{Animation, turntable, turntable_coloured, turntable_in};
pub use camera::{Camera, Viewport};
pub use colour_map::map_colour;
pub use colouring::{Colouring, Scale, Values};
pub use error::{AnimationError, FilmError, PanelError, RasterError};
pub use film::Film;
pub use gif_file::gif_texts;
pub use legend::legend;
pub use palette::Palette;
pub use panels::{Caption, Panel, Sheet, panels};
pub use png_file::{pixmap_from_png, pixmap_to_png};
pub use reduced::Reduction;
pub use shading::{LightFollows, Look, Shading};
pub use still::{render, render_coloured};
pub use text::{FONT, TextStyle, draw_text, text_width};
pub use tiny_skia;
pub use turntable::Turntable;
