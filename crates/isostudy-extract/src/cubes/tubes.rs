//! Tubes between two loops of a cell.

/// What a corner of a patch is: a crossed edge, or from [`INNER`] on a vertex in the cell.
pub(super) type Corner = u8;

/// The first vertex in the cell.
pub(super) const INNER: Corner = 12;

/// Triangles of a band between two loops, both run as the surface runs them: the one forwards is the other backwards. Of all bands
/// whose rungs are allowed the one with the shortest rungs; `None` if there is none.
pub(super) fn band(
    one: &[Corner],
    other: &[Corner],
    may_join: impl Fn(Corner, Corner) -> bool,
    squared: impl Fn(Corner, Corner) -> f64,
) -> Option<Vec<[Corner; 3]>> {
    let back: Vec<Corner> = other.iter().rev().copied().collect();
    let (m, n) = (one.len(), back.len());
    let mut best: Option<(f64, Vec<[Corner; 3]>)> = None;
    for start in 0..n {
        let (a, b) = (|i: usize| one[i % m], |j: usize| back[(start + j) % n]);
        // The shortest way to the rung from i to j, and whether its last step was along the first loop.
        let mut ways = vec![vec![(f64::INFINITY, false); n + 1]; m + 1];
        for i in 0..=m {
            for j in 0..=n {
                if !may_join(a(i), b(j)) {
                    continue;
                }
                let mut way = if (i, j) == (0, 0) { (0.0, false) } else { (f64::INFINITY, false) };
                if i > 0 && ways[i - 1][j].0 < way.0 {
                    way = (ways[i - 1][j].0, true);
                }
                if j > 0 && ways[i][j - 1].0 < way.0 {
                    way = (ways[i][j - 1].0, false);
                }
                ways[i][j] = (way.0 + squared(a(i), b(j)), way.1);
            }
        }
        let length = ways[m][n].0;
        if length == f64::INFINITY || best.as_ref().is_some_and(|(shortest, _)| *shortest <= length) {
            continue;
        }
        let (mut i, mut j) = (m, n);
        let mut triangles = Vec::with_capacity(m + n);
        while (i, j) != (0, 0) {
            if ways[i][j].1 {
                i -= 1;
                triangles.push([a(i), a(i + 1), b(j)]);
            } else {
                j -= 1;
                triangles.push([b(j + 1), b(j), a(i)]);
            }
        }
        // A rung that comes twice would be an edge of four triangles.
        let mut sides: Vec<[Corner; 2]> =
            triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
        sides.sort_unstable();
        if sides.windows(2).any(|pair| pair[0] == pair[1]) {
            continue;
        }
        triangles.reverse();
        best = Some((length, triangles));
    }
    best.map(|(_, triangles)| triangles)
}
