//! Polytopes cut into simplices by pulling: each to its first vertex.
//!
//! The first vertex is joined to all simplices of the facets that do not have it. A face of the polytope is so cut by its own first
//! vertex. What a face gets therefore depends on the order of its own vertices alone, and neighbours agree.

/// Adds the simplices of a facet of a polytope of `D` dimensions. Facets are sets of vertices, one bit each; `facets` has all of them, and
/// `of` is one.
pub(crate) fn pull<const D: usize>(of: u32, facets: &[u32], simplices: &mut Vec<[u8; D]>) {
    cut(of, facets, D as u32 - 1, &mut [0; D], simplices);
}

/// The first vertices of `simplex` are there already.
fn cut<const D: usize>(
    face: u32,
    siblings: &[u32],
    dimension: u32,
    simplex: &mut [u8; D],
    simplices: &mut Vec<[u8; D]>,
) {
    let first = face.trailing_zeros() as u8;
    simplex[D - 1 - dimension as usize] = first;
    if dimension == 1 {
        debug_assert_eq!(face.count_ones(), 2, "a side has two ends");
        simplex[D - 1] = 31 - face.leading_zeros() as u8;
        simplices.push(*simplex);
        return;
    }
    // No three vertices of a convex polytope are in a line: as many as these span a face of the face.
    let faces: Vec<u32> = siblings
        .iter()
        .filter(|&&sibling| sibling != face)
        .map(|sibling| sibling & face)
        .filter(|common| common.count_ones() >= dimension)
        .collect();
    for &opposite in faces.iter().filter(|opposite| *opposite >> first & 1 == 0) {
        cut(opposite, &faces, dimension - 1, simplex, simplices);
    }
}
