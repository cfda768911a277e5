//! Polytopes cut into simplices by pulling: each to its first vertex.
//!
//! The first vertex is joined to all simplices of the facets that do not have it. A face of the polytope is so cut by its own first
//! vertex. What a face gets therefore depends on the order of its own vertices alone, and neighbours agree.

/// Adds the simplices of a facet of a polytope. Facets are sets of vertices, one bit each; `facets` has all of them, and `of` is one.
/// `dimension` is that of the facet.
pub(crate) fn pull(of: u32, facets: &[u32], dimension: u32, simplices: &mut Vec<Vec<u8>>) {
    cut(of, facets, dimension, &mut Vec::new(), simplices);
}

fn cut(face: u32, siblings: &[u32], dimension: u32, apexes: &mut Vec<u8>, simplices: &mut Vec<Vec<u8>>) {
    if dimension == 1 {
        debug_assert_eq!(face.count_ones(), 2, "a side has two ends");
        let mut simplex = apexes.clone();
        simplex.extend((0..32).filter(|v| face >> v & 1 != 0));
        simplices.push(simplex);
        return;
    }
    // No three vertices of a convex polytope are in a line: as many as these span a face of the face.
    let faces: Vec<u32> = siblings
        .iter()
        .filter(|&&sibling| sibling != face)
        .map(|sibling| sibling & face)
        .filter(|common| common.count_ones() >= dimension)
        .collect();
    let first = face.trailing_zeros() as u8;
    apexes.push(first);
    for &opposite in faces.iter().filter(|opposite| *opposite >> first & 1 == 0) {
        cut(opposite, &faces, dimension - 1, apexes, simplices);
    }
    apexes.pop();
}
