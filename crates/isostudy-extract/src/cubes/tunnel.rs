//! Whether the trilinear interpolant joins two regions of a cell's surface through the cell, and which.
//!
//! # How
//!
//! Inside regions grow as the level falls, and meet in the cell at a critical point only. A trilinear function has at most two,
//! saddles: its second derivatives along the axes are zero, so one has a single direction in which the function rises, the other a
//! single one in which it falls. At the first inside regions meet, at the second outside regions.
//!
//! Along the three lines through a critical point that are parallel to the axes the function is constant. So a meeting point that is
//! in the cell, and on the side that meets there, joins the six points of the faces that lie before it. If these are in two
//! regions of the cell's surface, a tube runs between them. It does not matter then how a point near a face is rounded: in
//! the face before it all six are one region.
//!
//! With `d` the discriminant of the quadratic `ac - bd` over height, Cayley's hyperdeterminant of the corners, and `s`, `t` the
//! values at the critical points, `d` is `h^2 s t`, where `h` is the coefficient of `xyz`. So exactly one of the two joins
//! something if `d > 0`, which is decided without rounding, and none if `d < 0`. A tie is that of a level just above.

use std::cmp::Ordering;

use super::exact::Sum;

/// The corners of a face, in order round it, and the axes along its first and its last side.
pub(super) struct Square {
    pub(super) corners: [u8; 4],
    along: [usize; 2],
}

/// The faces of a cube, each with its lowest corner first.
pub(super) const SQUARES: [Square; 6] = {
    const fn square(across: usize, end: usize) -> Square {
        let (u, v) = ((across + 1) % 3, (across + 2) % 3);
        let low = (end << across) as u8;
        let (u_bit, v_bit) = (1 << u as u8, 1 << v as u8);
        Square { corners: [low, low | u_bit, low | u_bit | v_bit, low | v_bit], along: [u, v] }
    }
    [square(0, 0), square(0, 1), square(1, 0), square(1, 1), square(2, 0), square(2, 1)]
};

/// Two regions of the cell's surface that are joined through the cell, the lower first. `regions` has the region of each corner,
/// `is_joined` says of an ambiguous face whether its inside corners are one.
pub(super) fn joined_regions(
    values: [f32; 8],
    isovalue: f32,
    regions: &[u8; 8],
    is_joined: impl Fn(usize) -> bool,
) -> Option<[u8; 2]> {
    if !values.iter().all(|v| v.is_finite()) {
        return None;
    }
    let f = values.map(|v| f64::from(v) - f64::from(isovalue));
    let hyperdeterminant = hyperdeterminant_sign(values, isovalue, &f);
    if hyperdeterminant == Ordering::Less {
        return None;
    }
    let saddle = joining_saddle(&f, hyperdeterminant)?;
    // Rounding may not take a point that is on the level, where outside regions meet, off it.
    let largest = f.iter().fold(0.0, |largest: f64, v| largest.max(v.abs()));
    let slack = if hyperdeterminant == Ordering::Equal { 1e-12 * largest } else { 0.0 };
    let is_side = |p: [f64; 3]| {
        let value = value_at(&f, p);
        if saddle.inside { value > 0.0 } else { value <= slack }
    };
    let mut found: Option<u8> = None;
    for axis in 0..3 {
        let ends = [0.0, 1.0].map(|end| {
            let mut p = saddle.at;
            p[axis] = end;
            p
        });
        // Along the line the function is linear: with both ends on the side it is all there, even where the saddle is degenerate
        // and its place is not known well.
        if !ends.into_iter().all(is_side) {
            continue;
        }
        for number in [2 * axis, 2 * axis + 1] {
            let region = region_before(&f, saddle, &SQUARES[number], regions, is_joined(number));
            let Some(region) = region else { continue };
            match found {
                Some(other) if other != region => return Some([other.min(region), other.max(region)]),
                _ => found = Some(region),
            }
        }
    }
    None
}

fn value_at(f: &[f64; 8], [x, y, z]: [f64; 3]) -> f64 {
    let weight = |c: usize, axis: usize, p: f64| if c >> axis & 1 != 0 { p } else { 1.0 - p };
    (0..8).map(|c| f[c] * weight(c, 0, x) * weight(c, 1, y) * weight(c, 2, z)).sum()
}

/// A critical point at which regions of one side meet.
#[derive(Clone, Copy)]
struct Saddle {
    at: [f64; 3],
    inside: bool,
}

/// Coefficients of `ac - bd` over the height, highest power first.
fn quadratic(f: &[f64; 8]) -> [f64; 3] {
    let [a, b, c, d] = [[f[0], f[4]], [f[1], f[5]], [f[3], f[7]], [f[2], f[6]]];
    let rise = |line: [f64; 2]| line[1] - line[0];
    let two = rise(a) * rise(c) - rise(b) * rise(d);
    let one = (a[0] * rise(c) + c[0] * rise(a)) - (b[0] * rise(d) + d[0] * rise(b));
    [two, one, a[0] * c[0] - b[0] * d[0]]
}

fn hyperdeterminant_sign(values: [f32; 8], isovalue: f32, f: &[f64; 8]) -> Ordering {
    let [two, one, zero] = quadratic(f);
    let value = one * one - 4.0 * two * zero;
    // Each coefficient is a sum of products of two corners' magnitudes at most, each once or twice.
    let sizes = f.map(f64::abs);
    let size = |p: [usize; 2], q: [usize; 2]| (sizes[p[0]] + sizes[p[1]]) * (sizes[q[0]] + sizes[q[1]]);
    let bound = 2.0 * (size([0, 4], [3, 7]) + size([1, 5], [2, 6]));
    if value.abs() > 1e-13 * bound * bound {
        return if value > 0.0 { Ordering::Greater } else { Ordering::Less };
    }
    let f = values.map(|v| Sum::difference(v, isovalue));
    let lines = [[&f[0], &f[4]], [&f[1], &f[5]], [&f[3], &f[7]], [&f[2], &f[6]]];
    let rises = lines.map(|[low, high]| high.minus(low));
    let [a, b, c, d] = [0, 1, 2, 3].map(|i| (lines[i][0], &rises[i]));
    let two = a.1.times(c.1).minus(&b.1.times(d.1));
    let one = a.0.times(c.1).plus(&c.0.times(a.1)).minus(&b.0.times(d.1).plus(&d.0.times(b.1)));
    let zero = a.0.times(c.0).minus(&b.0.times(d.0));
    let product = two.times(&zero);
    let twice = product.plus(&product);
    one.times(&one).minus(&twice.plus(&twice)).sign()
}

/// The critical point in the cell that joins what meets there, if there is one.
fn joining_saddle(f: &[f64; 8], hyperdeterminant: Ordering) -> Option<Saddle> {
    let [two, one, zero] = quadratic(f);
    // The mixed derivative in x and y, over the height.
    let bent = |z: usize| f[4 * z] - f[4 * z + 1] - f[4 * z + 2] + f[4 * z + 3];
    let (low, rise) = (bent(0), bent(1) - bent(0));
    // Where the saddle value of a slice, (ac - bd) over that, has no slope.
    let (a, b, c) = (two * rise, 2.0 * two * low, one * low - zero * rise);
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 || discriminant.is_nan() {
        return None;
    }
    let q = -0.5 * (b + discriminant.sqrt().copysign(b));
    let heights = match q {
        0.0 if c != 0.0 => return None,
        0.0 => [0.0, f64::NAN],
        _ => [q / a, c / q],
    };
    let saddles = heights.map(|z| critical(f, z));
    let value = |saddle: &Option<(Saddle, f64)>| saddle.map_or(0.0, |(_, value)| value);
    // Where both are, they have one sign; the larger is not mistaken.
    let all_inside = match &saddles {
        [Some(_), Some(_)] => {
            let [s, t] = [value(&saddles[0]), value(&saddles[1])];
            (if s.abs() > t.abs() { s } else { t }) > 0.0
        }
        [Some((saddle, _)), None] | [None, Some((saddle, _))] => saddle.inside,
        [None, None] => return None,
    };
    // On the level itself: outside regions meet just below a raised level, inside ones do not.
    if hyperdeterminant == Ordering::Equal && all_inside {
        return None;
    }
    let is_in_cell = |saddle: &Saddle| saddle.at.iter().all(|x| (0.0..=1.0).contains(x));
    saddles.into_iter().flatten().map(|(saddle, _)| saddle).find(|s| s.inside == all_inside && is_in_cell(s))
}

/// The critical point at a height, which side meets there, and its value.
fn critical(f: &[f64; 8], z: f64) -> Option<(Saddle, f64)> {
    let at = |c: usize| f[c] * (1.0 - z) + f[c + 4] * z;
    let [a, b, d, c] = [0, 1, 2, 3].map(at);
    let bent = a - b - d + c;
    let (x, y) = ((a - d) / bent, (a - b) / bent);
    if ![x, y, z].iter().all(|p| p.is_finite()) {
        return None;
    }
    // The other mixed derivatives there.
    let mixed = |p: [usize; 4]| f[p[0]] - f[p[1]] - f[p[2]] + f[p[3]];
    let in_yz = mixed([0, 2, 4, 6]) * (1.0 - x) + mixed([1, 3, 5, 7]) * x;
    let in_xz = mixed([0, 1, 4, 5]) * (1.0 - y) + mixed([2, 3, 6, 7]) * y;
    // The product of the second derivatives' eigenvalues is twice this; their sum is zero.
    let turn = bent * in_yz * in_xz;
    let value = a + (b - a) * x + (d - a) * y + bent * x * y;
    Some((Saddle { at: [x, y, z], inside: turn > 0.0 }, value))
}

/// The region that the point of a face before a saddle is in.
fn region_before(
    f: &[f64; 8],
    saddle: Saddle,
    square: &Square,
    regions: &[u8; 8],
    inside_is_joined: bool,
) -> Option<u8> {
    let is_side = |c: u8| (f[usize::from(c)] > 0.0) == saddle.inside;
    let corners = square.corners;
    let first = corners.iter().position(|&c| is_side(c))?;
    let opposite = corners[(first + 2) % 4];
    let is_ambiguous =
        is_side(opposite) && !is_side(corners[(first + 1) % 4]) && !is_side(corners[(first + 3) % 4]);
    if !is_ambiguous || inside_is_joined == saddle.inside {
        return Some(regions[usize::from(corners[first])]);
    }
    // Two regions, on either side of the face's own saddle along both axes.
    let [a, b, c, d] = corners.map(|c| f[usize::from(c)]);
    let bent = a - b - d + c;
    let middle = [(a - d) / bent, (a - b) / bent];
    let beyond = [0, 1].map(|k| saddle.at[square.along[k]] - middle[k]);
    let axis = usize::from(beyond[1].abs() > beyond[0].abs());
    let is_high = |c: u8| c >> square.along[axis] & 1 != 0;
    let corner = if is_high(corners[first]) == (beyond[axis] > 0.0) { corners[first] } else { opposite };
    Some(regions[usize::from(corner)])
}
