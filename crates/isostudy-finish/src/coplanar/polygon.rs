//! A polygon with holes cut into triangles.

use std::collections::HashMap;

type Point = [f64; 2];

/// How far the areas of outlines and triangles may differ, as a share.
const SAME_AREA: f64 = 1e-6;

/// The triangles of a polygon with holes, counter-clockwise, by the fewest: vertices less two, and two more for each hole. `loops` have the
/// polygon to their left, and `flat` gives the place of a vertex. `area` is what was there before. `None` if the loops are not the
/// outlines of a polygon of about this area, as far as rounding tells. What is within `slack` of a line is on it.
pub(crate) fn triangulate(
    loops: &[Vec<u32>],
    flat: impl Fn(u32) -> Point,
    area: f64,
    slack: f64,
) -> Option<Vec<[u32; 3]>> {
    if loops.is_empty() || loops.iter().any(|of| of.len() < 3) {
        return None;
    }
    let mut places: HashMap<u32, Point> = HashMap::new();
    for &v in loops.iter().flatten() {
        places.insert(v, flat(v));
    }
    let at = |v: u32| places[&v];
    let areas: Vec<f64> = loops.iter().map(|of| area_of(of, &at)).collect();
    // One outline goes round the others.
    let outer = areas.iter().position(|area| *area > 0.0)?;
    let total: f64 = areas.iter().sum();
    if areas.iter().filter(|area| **area > 0.0).count() != 1 || total <= 0.0 {
        return None;
    }
    // A straight part that was taken out moves the outline by its tolerance at most; what is lost beyond a third is another polygon.
    if (total - area).abs() > total.max(area) / 3.0 {
        return None;
    }
    let holes: Vec<&Vec<u32>> = (0..loops.len()).filter(|&i| i != outer).map(|i| &loops[i]).collect();
    let ring = bridged(&loops[outer], holes, &at, slack)?;
    // Without slack corners that are thin by themselves can be cut as well.
    let triangles = clip_ears(ring.clone(), &at, slack).or_else(|| clip_ears(ring, &at, 0.0))?;
    let covered: f64 = triangles.iter().map(|&[a, b, c]| 0.5 * turn(at(a), at(b), at(c))).sum();
    if (covered - total).abs() > SAME_AREA * total {
        return None;
    }
    Some(improved(triangles, &at))
}

/// Twice the area of a triangle, above 0 where it turns left.
fn turn([ax, ay]: Point, [bx, by]: Point, [cx, cy]: Point) -> f64 {
    (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
}

fn area_of(ring: &[u32], at: &impl Fn(u32) -> Point) -> f64 {
    let origin = at(ring[0]);
    ring.windows(2).map(|pair| 0.5 * turn(origin, at(pair[0]), at(pair[1]))).sum()
}

/// One ring that runs into each hole and back by the same edge: the shortest that crosses and touches nothing.
fn bridged(
    outer: &[u32],
    mut holes: Vec<&Vec<u32>>,
    at: &impl Fn(u32) -> Point,
    slack: f64,
) -> Option<Vec<u32>> {
    let mut ring = outer.to_vec();
    while !holes.is_empty() {
        let mut bridges = Vec::new();
        for (h, hole) in holes.iter().enumerate() {
            for (i, &u) in ring.iter().enumerate() {
                bridges.extend(hole.iter().enumerate().map(|(j, &v)| (distance(at(u), at(v)), [h, i, j])));
            }
        }
        bridges.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let is_clear = |[h, i, j]: [usize; 3]| {
            let (u, v) = (ring[i], holes[h][j]);
            let rings = || std::iter::once(&ring).chain(holes.iter().copied());
            opens_to(&ring, i, at(v), at)
                && opens_to(holes[h], j, at(u), at)
                && rings().all(|of| !meets(of, [u, v], at, slack))
        };
        let (_, [h, i, j]) = bridges.into_iter().find(|(_, bridge)| is_clear(*bridge))?;
        let hole = holes.remove(h);
        let mut into: Vec<u32> = (0..=hole.len()).map(|k| hole[(j + k) % hole.len()]).collect();
        into.push(ring[i]);
        ring.splice(i + 1..i + 1, into);
    }
    Some(ring)
}

fn distance(a: Point, b: Point) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Whether the corner at a place of a ring, which has the polygon to its left, is open towards a point.
fn opens_to(ring: &[u32], i: usize, p: Point, at: &impl Fn(u32) -> Point) -> bool {
    let n = ring.len();
    let (before, here, next) = (at(ring[(i + n - 1) % n]), at(ring[i]), at(ring[(i + 1) % n]));
    let (left, right) = (turn(before, here, p) > 0.0, turn(here, next, p) > 0.0);
    if turn(before, here, next) > 0.0 { left && right } else { left || right }
}

/// Whether a segment between two vertices crosses or touches a ring elsewhere.
fn meets(ring: &[u32], ends: [u32; 2], at: &impl Fn(u32) -> Point, slack: f64) -> bool {
    let [p, q] = ends.map(at);
    let length = distance(p, q);
    let touches = |v: u32| {
        let s = at(v);
        let along = ((s[0] - p[0]) * (q[0] - p[0]) + (s[1] - p[1]) * (q[1] - p[1])) / length;
        !ends.contains(&v)
            && turn(p, q, s).abs() <= slack * length
            && (-slack..=length + slack).contains(&along)
    };
    let crosses = |u: u32, v: u32| {
        let (a, b) = (at(u), at(v));
        let is_apart = |x: f64, y: f64| (x > 0.0 && y < 0.0) || (x < 0.0 && y > 0.0);
        !ends.contains(&u)
            && !ends.contains(&v)
            && is_apart(turn(p, q, a), turn(p, q, b))
            && is_apart(turn(a, b, p), turn(a, b, q))
    };
    (0..ring.len()).any(|i| touches(ring[i]) || crosses(ring[i], ring[(i + 1) % ring.len()]))
}

/// Cuts ears off a ring until it is none (Meisters 1975).
fn clip_ears(mut ring: Vec<u32>, at: &impl Fn(u32) -> Point, slack: f64) -> Option<Vec<[u32; 3]>> {
    let mut triangles = Vec::with_capacity(ring.len() - 2);
    let mut i = 0;
    let mut refused = 0;
    while ring.len() > 3 {
        let n = ring.len();
        if refused == n {
            return None;
        }
        i %= n;
        let corners = [ring[(i + n - 1) % n], ring[i], ring[(i + 1) % n]];
        if is_ear(&ring, corners, at, slack) {
            triangles.push(corners);
            ring.remove(i);
            refused = 0;
        } else {
            refused += 1;
        }
        // Not twice in a row beside each other, which would make fans of thin triangles.
        i += 1;
    }
    let [a, b, c] = ring[..] else { return None };
    triangles.push([a, b, c]);
    (turn(at(a), at(b), at(c)) > 0.0).then_some(triangles)
}

/// Whether a corner can be cut off: nothing lies in its triangle or, as far as the slack tells, on its sides.
fn is_ear(ring: &[u32], [a, b, c]: [u32; 3], at: &impl Fn(u32) -> Point, slack: f64) -> bool {
    let [p, q, r] = [a, b, c].map(at);
    let sides = [(p, q), (q, r), (r, p)].map(|(from, to)| (from, to, slack * distance(from, to)));
    let longest = sides.iter().map(|side| side.2).fold(0.0, f64::max);
    if turn(p, q, r) <= longest {
        return false;
    }
    ring.iter().filter(|v| ![a, b, c].contains(v)).all(|&v| {
        let s = at(v);
        sides.iter().any(|&(from, to, slack)| turn(from, to, s) < -slack)
    })
}

/// Most passes over all edges; each makes the least angles larger.
const MOST_PASSES: usize = 20;

/// Flips diagonals until the triangles are those of Delaunay within the outline (Lawson 1977).
fn improved(mut triangles: Vec<[u32; 3]>, at: &impl Fn(u32) -> Point) -> Vec<[u32; 3]> {
    for _ in 0..MOST_PASSES {
        let mut along: HashMap<[u32; 2], usize> = HashMap::new();
        let mut is_twice = false;
        for (t, &[a, b, c]) in triangles.iter().enumerate() {
            for edge in [[a, b], [b, c], [c, a]] {
                is_twice |= along.insert(edge, t).is_some();
            }
        }
        // Both sides of a bridge to a hole can make an edge twice; its triangles are right as they are.
        if is_twice {
            return triangles;
        }
        let mut is_changed = vec![false; triangles.len()];
        let mut flips = 0;
        for t in 0..triangles.len() {
            for k in 0..3 {
                let [u, v, w] = [0, 1, 2].map(|i| triangles[t][(k + i) % 3]);
                let Some(&other) = along.get(&[v, u]) else { continue };
                if is_changed[t] || is_changed[other] || other == t {
                    continue;
                }
                let Some(&x) = triangles[other].iter().find(|&&x| x != u && x != v) else { continue };
                if along.contains_key(&[w, x]) || along.contains_key(&[x, w]) || x == w {
                    continue;
                }
                if is_better(at(u), at(v), at(w), at(x)) {
                    triangles[t] = [x, w, u];
                    triangles[other] = [w, x, v];
                    is_changed[t] = true;
                    is_changed[other] = true;
                    // The new edge must not be made once more in this pass.
                    along.insert([w, x], other);
                    along.insert([x, w], t);
                    flips += 1;
                }
            }
        }
        if flips == 0 {
            break;
        }
    }
    triangles
}

/// Whether the diagonal from `w` to `x` is better than the edge from `u` to `v`, with `w` to its left and `x` to its right.
fn is_better(u: Point, v: Point, w: Point, x: Point) -> bool {
    if turn(x, w, u) <= 0.0 || turn(w, x, v) <= 0.0 {
        return false;
    }
    // The angles opposite an edge of Delaunay's sum up to 180 degrees at most: the sine of the sum is then not below 0.
    let cot = |a: Point, b: Point, c: Point| {
        let (p, q) = ([a[0] - c[0], a[1] - c[1]], [b[0] - c[0], b[1] - c[1]]);
        (p[0] * q[0] + p[1] * q[1], turn(c, a, b))
    };
    let ((cos_w, sin_w), (cos_x, sin_x)) = (cot(u, v, w), cot(v, u, x));
    let sine = sin_w * cos_x + cos_w * sin_x;
    sine < -1e-12 * (sin_w.hypot(cos_w) * sin_x.hypot(cos_x))
}
