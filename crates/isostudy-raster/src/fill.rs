//! Filling triangles into the sample grid, nearest first.
//!
//! Corners are snapped to 1/256 of a sample, edge functions are exact integers, and the top-left rule gives a sample
//! on a shared edge to exactly one triangle. Depth and exposure are perspective-correct. tiny-skia's own fills are
//! not used for meshes: anti-aliased, they blend every shared edge with what is behind it and leave a net of seams.

use crate::camera::View;
use crate::clip::{Bounds, Corner};
use crate::samples::{BACKGROUND, LANES, LevelScale, Samples, WIRE, coloured_levels};
use crate::surface::{Corners, Lit, Surface};
use crate::{Camera, Look, Shading, Viewport};
use glam::{Vec3, Vec4};

/// Positions are snapped to this fraction of a sample.
const SUB: i32 = 256;
/// Corners further out than this many samples from the middle of the picture are cut off.
const GUARD: f32 = 262_144.0;

/// What a fill shows, as a constant the inner loop is compiled for.
const SURFACE: u8 = 0;
const LINES: u8 = 1;
const BOTH: u8 = 2;

/// Draws surfaces of one look; holds the scratch space of a thread.
pub(crate) struct Painter {
    look: Look,
    /// Whether the surfaces are coloured by numbers.
    coloured: bool,
    scale: LevelScale,
    /// Half the line width, in 1/256 samples.
    wire_reach: f32,
    projected: Vec<Projected>,
}

/// A corner on the sample grid.
#[derive(Debug, Clone, Copy)]
struct Snapped {
    x: i32,
    y: i32,
    /// 1 / z.
    nearness: f32,
}

#[derive(Debug, Clone, Copy)]
struct Projected {
    at: Snapped,
    inside: bool,
}

impl Painter {
    pub(crate) fn new(shading: &Shading, look: Look, coloured: bool, viewport: &Viewport) -> Painter {
        Painter {
            look,
            coloured,
            scale: LevelScale::new(shading.max_exposure()),
            wire_reach: shading.wire_width_px * 0.5 * viewport.supersampling as f32 * SUB as f32,
            projected: Vec::new(),
        }
    }

    /// Draws `surface` into `samples`, which keep what they already show where it is nearer.
    pub(crate) fn draw(
        &mut self,
        surface: &Surface,
        lit: &Lit,
        camera: &Camera,
        viewport: &Viewport,
        samples: &mut Samples,
    ) {
        let view = View::new(camera, viewport);
        let bounds = Bounds { near: camera.near, far: camera.far, slope: view.slope(GUARD) };
        let mut projected = std::mem::take(&mut self.projected);
        projected.clear();
        projected.extend(surface.positions.iter().map(|&p| {
            let p = view.view_point(p);
            let inside = bounds.holds(p);
            Projected {
                at: if inside { snap(&view, p) } else { Snapped { x: 0, y: 0, nearness: 0.0 } },
                inside,
            }
        }));
        for (t, corners) in surface.triangles.iter().enumerate() {
            let drawn = surface.corners(lit, t);
            let at = corners.map(|v| projected[v as usize]);
            if at.iter().all(|p| p.inside) {
                self.fill(at.map(|p| p.at), drawn, samples);
            } else {
                let positions = corners.map(|v| view.view_point(surface.positions[v as usize]));
                self.fill_cut(positions, drawn, &view, &bounds, samples);
            }
        }
        self.projected = projected;
    }

    /// The part of a triangle that can be projected, as a fan.
    fn fill_cut(&self, at: [Vec3; 3], drawn: Corners, view: &View, bounds: &Bounds, samples: &mut Samples) {
        let Corners { exposures, places } = drawn;
        let triangle =
            [0, 1, 2].map(|i| Corner { position: at[i], exposure: exposures[i], place: places[i] });
        let polygon = bounds.cut(triangle);
        for i in 2..polygon.len() {
            let fan = [polygon[0], polygon[i - 1], polygon[i]];
            let drawn = Corners { exposures: fan.map(|c| c.exposure), places: fan.map(|c| c.place) };
            self.fill(fan.map(|c| snap(view, c.position)), drawn, samples);
        }
    }

    #[inline]
    fn fill(&self, at: [Snapped; 3], drawn: Corners, samples: &mut Samples) {
        let (x, y) = (at.map(|c| c.x), at.map(|c| c.y));
        let (x0, x1) = (x[0].min(x[1]).min(x[2]), x[0].max(x[1]).max(x[2]));
        let (y0, y1) = (y[0].min(y[1]).min(y[2]), y[0].max(y[1]).max(y[2]));
        let columns = centres(x0, x1, samples.width);
        let rows = centres(y0, y1, samples.height);
        if columns[0] >= columns[1] || rows[0] >= rows[1] {
            return;
        }
        let span = Span { columns, rows };
        match (self.look, self.coloured) {
            (Look::Smooth | Look::Flat | Look::Creased, false) => {
                self.scan::<SURFACE, false>(at, drawn, span, samples)
            }
            (Look::Smooth | Look::Flat | Look::Creased, true) => {
                self.scan::<SURFACE, true>(at, drawn, span, samples)
            }
            (Look::Wireframe, false) => self.scan::<LINES, false>(at, drawn, span, samples),
            (Look::Wireframe, true) => self.scan::<LINES, true>(at, drawn, span, samples),
            (Look::SmoothWireframe, false) => self.scan::<BOTH, false>(at, drawn, span, samples),
            (Look::SmoothWireframe, true) => self.scan::<BOTH, true>(at, drawn, span, samples),
        }
    }

    #[inline]
    fn scan<const WHAT: u8, const COLOURED: bool>(
        &self,
        mut at: [Snapped; 3],
        drawn: Corners,
        span: Span,
        samples: &mut Samples,
    ) {
        let Corners { exposures: mut d, mut places } = drawn;
        let double_area = match edge(at[0], at[1], at[2].x, at[2].y) {
            0 => return,
            // Both sides are drawn: only the order on the screen is turned.
            area if area < 0 => {
                at.swap(1, 2);
                d.swap(1, 2);
                places.swap(1, 2);
                -area
            }
            area => area,
        };
        let Span { columns, rows } = span;
        samples.touch(columns, rows);

        // Edge i lies opposite corner i; its function over the double area is that corner's share.
        let edges = [(at[1], at[2]), (at[2], at[0]), (at[0], at[1])];
        let start = [columns[0], rows[0]].map(|s| s as i32 * SUB + SUB / 2);
        let mut w = edges.map(|(a, b)| edge(a, b, start[0], start[1]));
        let step_x = edges.map(|(a, b)| (a.y - b.y) as i64 * SUB as i64);
        let step_y = edges.map(|(a, b)| (b.x - a.x) as i64 * SUB as i64);
        let least = edges.map(|(a, b)| if is_top_left(a, b) { 0 } else { 1 });

        let per_step = step_x.map(|step| 1.0 / step as f64);
        let share = 1.0 / double_area as f32;
        let near = Along::new(at.map(|c| c.nearness), step_x, share);
        let over = Along::new([0, 1, 2].map(|i| d[i] * at[i].nearness), step_x, share);
        let place = Along::new([0, 1, 2].map(|i| places[i] * at[i].nearness), step_x, share);
        let away = match WHAT {
            SURFACE => [0.0; 3],
            _ => edges.map(|(a, b)| 1.0 / ((b.x - a.x) as f32).hypot((b.y - a.y) as f32)),
        };

        let across = (columns[1] - columns[0]) as f64;
        for row in rows[0]..rows[1] {
            let [mut from, mut to] = [0, across as i64];
            for i in 0..3 {
                [from, to] = between_edges([from, to], w[i] - least[i], step_x[i], per_step[i], across);
            }
            if from < to {
                let at_start = [0, 1, 2].map(|i| (w[i] + from * step_x[i]) as f32);
                let (near_start, over_start) = (near.at(at_start), over.at(at_start));
                let place_start = if COLOURED { place.at(at_start) } else { 0.0 };
                let first = row * samples.stride + columns[0] + from as usize;
                let length = (to - from) as usize;
                let reach = length.next_multiple_of(LANES);
                let (nearness, _) = samples.nearness[first..first + reach].as_chunks_mut::<LANES>();
                let (level, _) = samples.level[first..first + reach].as_chunks_mut::<LANES>();
                let mut k = Vec4::new(0.0, 1.0, 2.0, 3.0);
                for (nearest, shown) in nearness.iter_mut().zip(level) {
                    let here = near_start + k * near.step;
                    let there = Vec4::from_array(*nearest);
                    let wins = here.cmpgt(there) & k.cmplt(Vec4::splat(length as f32));
                    if wins.any() {
                        let mut surface = self.scale.levels((over_start + k * over.step) / here);
                        if COLOURED {
                            surface = coloured_levels(surface, (place_start + k * place.step) / here);
                        }
                        let seen = if WHAT == SURFACE {
                            surface
                        } else {
                            let distance = |i: usize| (at_start[i] + k * step_x[i] as f32) * away[i];
                            let nearest_edge = distance(0).min(distance(1)).min(distance(2));
                            let on_line = nearest_edge.cmplt(Vec4::splat(self.wire_reach));
                            match WHAT {
                                LINES => Vec4::select(on_line, surface, Vec4::splat(BACKGROUND)),
                                _ => Vec4::select(on_line, Vec4::splat(WIRE), surface),
                            }
                        };
                        *nearest = Vec4::select(wins, here, there).to_array();
                        *shown = Vec4::select(wins, seen, Vec4::from_array(*shown)).to_array();
                    }
                    k += LANES as f32;
                }
            }
            w = [0, 1, 2].map(|i| w[i] + step_y[i]);
        }
    }
}

/// A value given at the corners, along a row.
#[derive(Debug, Clone, Copy)]
struct Along {
    first: f32,
    /// From the first corner's value to the second's and third's, a unit of their edge functions.
    second: f32,
    third: f32,
    /// From one sample to the next.
    step: f32,
}

impl Along {
    #[inline]
    fn new(corners: [f32; 3], step_x: [i64; 3], share: f32) -> Along {
        let (second, third) = ((corners[1] - corners[0]) * share, (corners[2] - corners[0]) * share);
        Along { first: corners[0], second, third, step: step_x[1] as f32 * second + step_x[2] as f32 * third }
    }

    #[inline]
    fn at(&self, w: [f32; 3]) -> f32 {
        self.first + w[1] * self.second + w[2] * self.third
    }
}

/// The part of `from..to` where `w + k step >= 0`, exactly; `from` is at least 0, `to` at most `columns`, and
/// `per_step` is 1 / step.
#[inline]
fn between_edges([from, to]: [i64; 2], w: i64, step: i64, per_step: f64, columns: f64) -> [i64; 2] {
    if step == 0 {
        return if w >= 0 { [from, to] } else { [to, to] };
    }
    let crossing = -w as f64 * per_step;
    let crossing = if crossing > -1.0 { crossing } else { -1.0 };
    let crossing = if crossing < columns { crossing } else { columns };
    // At 2^52 the last bit of a double is worth 1: adding 3/2 of it rounds, and leaves the integer in the low bits.
    // What was rounded is one of the two integers round the true crossing; the exact function there says which.
    let k = (crossing + 6_755_399_441_055_744.0).to_bits() as i32 as i64;
    let inside = w + k * step >= 0;
    if step > 0 { [from.max(k + !inside as i64), to] } else { [from, to.min(k + inside as i64)] }
}

/// The samples whose centres a triangle's box holds, half-open.
#[derive(Debug, Clone, Copy)]
struct Span {
    columns: [usize; 2],
    rows: [usize; 2],
}

/// Half-open range of sample indices below `count` with centres in `from..=to` (1/256 samples).
#[inline]
fn centres(from: i32, to: i32, count: usize) -> [usize; 2] {
    let first = (from + SUB / 2 - 1) >> SUB.trailing_zeros();
    let last = (to - SUB / 2) >> SUB.trailing_zeros();
    [first.max(0) as usize, (last + 1).clamp(0, count as i32) as usize]
}

/// With y down and the inside at positive edge values: a left edge goes up, a top edge goes right.
#[inline]
fn is_top_left(a: Snapped, b: Snapped) -> bool {
    b.y < a.y || (b.y == a.y && b.x > a.x)
}

#[inline]
fn snap(view: &View, p: Vec3) -> Snapped {
    let [x, y] = view.sample_position(p).map(|v| nearest(v * SUB as f32));
    Snapped { x, y, nearness: 1.0 / p.z }
}

/// Rounds half up. `f32::round` is a library call without SSE 4.1, and showed in the profile.
#[inline]
fn nearest(v: f32) -> i32 {
    let v = v + 0.5;
    let cut = v as i32;
    cut - (v < cut as f32) as i32
}

/// Twice the area of `a`, `b`, `(x, y)`: positive when clockwise on the screen. Exact: snapped coordinates stay below
/// 2^27 by [`GUARD`].
#[inline]
fn edge(a: Snapped, b: Snapped, x: i32, y: i32) -> i64 {
    (b.x - a.x) as i64 * (y - a.y) as i64 - (b.y - a.y) as i64 * (x - a.x) as i64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_are_those_of_a_walk() {
        for step in -9i64..=9 {
            for w in -70i64..=70 {
                let walked: Vec<i64> = (0..6).filter(|k| w + k * step >= 0).collect();
                let [from, to] = between_edges([0, 6], w, step, 1.0 / step as f64, 6.0);
                let spanned: Vec<i64> = (from..to).collect();
                assert_eq!(spanned, walked, "w = {w}, step = {step}");
            }
        }
    }

    #[test]
    fn rounding_is_to_the_nearest() {
        for (v, expected) in [(0.4, 0), (0.5, 1), (-0.5, 0), (-0.6, -1), (-1.5, -1), (7.0, 7)] {
            assert_eq!(nearest(v), expected, "{v}");
        }
    }
}
