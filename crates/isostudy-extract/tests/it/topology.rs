//! What the tests ask about a mesh's connections, computed plainly and apart from the crates' own code.

use std::collections::HashMap;

use isostudy_mesh::TriangleMesh;

pub(crate) fn directed_sides(mesh: &TriangleMesh) -> impl Iterator<Item = (u32, u32)> + '_ {
    mesh.triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)])
}

/// Every directed side occurs once and so does its opposite; the triangles round each vertex form one fan.
pub(crate) fn assert_closed_manifold(mesh: &TriangleMesh) {
    let mut sides: HashMap<(u32, u32), u32> = HashMap::new();
    // From a vertex: around it, the side opposite leads from one neighbour to the next.
    let mut around: HashMap<u32, HashMap<u32, u32>> = HashMap::new();
    for side in directed_sides(mesh) {
        *sides.entry(side).or_default() += 1;
    }
    for (&(a, b), &count) in &sides {
        assert_eq!(count, 1, "side {a} {b} is used twice");
        assert!(sides.contains_key(&(b, a)), "side {a} {b} is open");
    }
    for &[a, b, c] in &mesh.triangles {
        for (centre, from, to) in [(a, b, c), (b, c, a), (c, a, b)] {
            around.entry(centre).or_default().insert(from, to);
        }
    }
    for (centre, next) in around {
        let start = *next.keys().next().unwrap();
        let mut at = next[&start];
        let mut steps = 1;
        while at != start {
            at = next[&at];
            steps += 1;
        }
        assert_eq!(steps, next.len(), "vertex {centre} has more than one fan");
    }
}
