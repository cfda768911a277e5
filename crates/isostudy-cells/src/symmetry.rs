//! Symmetries of a cell in any number of dimensions, and how many of its labellings are the same up to them.

/// A way to put a cell onto itself.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Symmetry {
    /// The corner that each corner is taken to.
    pub to: Vec<u8>,
    /// Whether it is a rotation, and no reflection.
    pub is_rotation: bool,
}

/// All ways to take points with whole coordinates onto each other that keep distances.
///
/// # Panics
/// If the points do not span their space, or are more than 255.
pub fn symmetries(points: &[Vec<i32>]) -> Vec<Symmetry> {
    assert!(points.len() <= 255, "corners are numbered in a byte");
    let frame = frame(points);
    let orientation = volume(points, &frame);
    let mut found = Vec::new();
    extend(points, &mut Vec::new(), &mut |to| {
        let image: Vec<usize> = frame.iter().map(|&p| usize::from(to[p])).collect();
        let is_rotation = (volume(points, &image) > 0) == (orientation > 0);
        found.push(Symmetry { to: to.to_vec(), is_rotation });
    });
    found
}

/// How many labellings of the corners with `labels` labels there are up to the given symmetries, which must be a group: by
/// Burnside's lemma, the mean number of labellings that a symmetry leaves as they are.
pub fn classes(group: &[&Symmetry], labels: u64) -> u64 {
    let fixed: u64 = group.iter().map(|symmetry| labels.pow(cycles(symmetry).len() as u32)).sum();
    fixed / group.len() as u64
}

/// The same for two labels, where exchanging them does not count either.
pub fn classes_with_complement(group: &[&Symmetry]) -> u64 {
    let exchanged = |symmetry: &Symmetry| {
        let cycles = cycles(symmetry);
        // Along a cycle labels alternate, so that its length must be even.
        if cycles.iter().all(|length| length % 2 == 0) { 1 << cycles.len() } else { 0 }
    };
    let fixed: u64 = group.iter().map(|symmetry| exchanged(symmetry)).sum();
    (classes(group, 2) * group.len() as u64 + fixed) / (2 * group.len() as u64)
}

/// The lengths of the cycles.
fn cycles(symmetry: &Symmetry) -> Vec<usize> {
    let mut seen = vec![false; symmetry.to.len()];
    let mut lengths = Vec::new();
    for first in 0..seen.len() {
        let (mut point, mut length) = (first, 0);
        while !std::mem::replace(&mut seen[point], true) {
            point = usize::from(symmetry.to[point]);
            length += 1;
        }
        if length > 0 {
            lengths.push(length);
        }
    }
    lengths
}

/// Corner by corner, wherever distances to those before are kept.
fn extend(points: &[Vec<i32>], to: &mut Vec<u8>, found: &mut impl FnMut(&[u8])) {
    let next = to.len();
    if next == points.len() {
        return found(to);
    }
    for candidate in 0..points.len() {
        let fits = |before: usize| {
            let image = usize::from(to[before]);
            image != candidate
                && squared(&points[before], &points[next]) == squared(&points[image], &points[candidate])
        };
        if (0..next).all(fits) {
            to.push(candidate as u8);
            extend(points, to, found);
            to.pop();
        }
    }
}

fn squared(a: &[i32], b: &[i32]) -> i64 {
    a.iter().zip(b).map(|(a, b)| i64::from(a - b).pow(2)).sum()
}

/// Points that span the space: a simplex.
fn frame(points: &[Vec<i32>]) -> Vec<usize> {
    fn search(points: &[Vec<i32>], chosen: &mut Vec<usize>, wanted: usize) -> bool {
        if chosen.len() == wanted {
            return volume(points, chosen) != 0;
        }
        let first = chosen.last().map_or(0, |&p| p + 1);
        (first..points.len()).any(|p| {
            chosen.push(p);
            let found = search(points, chosen, wanted);
            if !found {
                chosen.pop();
            }
            found
        })
    }
    let mut chosen = Vec::new();
    assert!(search(points, &mut chosen, points[0].len() + 1), "the points span their space");
    chosen
}

/// The volume of a simplex, times a factorial, with its orientation.
fn volume(points: &[Vec<i32>], simplex: &[usize]) -> i64 {
    fn determinant(rows: &[Vec<i64>]) -> i64 {
        if rows.is_empty() {
            return 1;
        }
        (0..rows.len())
            .map(|column| {
                let without = |row: &Vec<i64>| {
                    row.iter().enumerate().filter(|(c, _)| *c != column).map(|(_, v)| *v).collect()
                };
                let minor: Vec<Vec<i64>> = rows[1..].iter().map(without).collect();
                let sign = if column % 2 == 0 { 1 } else { -1 };
                sign * rows[0][column] * determinant(&minor)
            })
            .sum()
    }
    let difference = |p: usize| {
        points[p].iter().zip(&points[simplex[0]]).map(|(a, b)| i64::from(a - b)).collect::<Vec<_>>()
    };
    determinant(&simplex[1..].iter().map(|&p| difference(p)).collect::<Vec<_>>())
}
