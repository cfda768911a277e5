//! The components of a mesh, each with what the surface's have.

use std::collections::BTreeMap;

use isostudy_mesh::TriangleMesh;

use crate::grid::Component;
use crate::sets::Sets;

/// The components of a mesh, by shared vertices, in the order of their lowest vertices. Triangles that repeat a vertex, and
/// vertices without a triangle, are left out. Where a vertex has more than two boundary edges its loops are one.
pub(crate) fn components(mesh: &TriangleMesh) -> Vec<Component> {
    let proper = || mesh.triangles.iter().filter(|[a, b, c]| a != b && b != c && c != a);
    let mut joined = Sets::new(mesh.positions.len());
    let mut used = vec![false; mesh.positions.len()];
    let mut sides: Vec<[u32; 2]> = Vec::with_capacity(3 * mesh.triangles.len());
    for &[a, b, c] in proper() {
        joined.join(a, b);
        joined.join(a, c);
        for [from, to] in [[a, b], [b, c], [c, a]] {
            used[from as usize] = true;
            sides.push([from.min(to), from.max(to)]);
        }
    }
    let mut found: BTreeMap<u32, Component> = BTreeMap::new();
    let mut at = |found: &mut BTreeMap<u32, Component>, v: u32, euler: i64, loops: u64| {
        let component = found.entry(joined.root(v)).or_default();
        component.euler_characteristic += euler;
        component.boundary_loops += loops;
    };
    for v in (0..used.len()).filter(|&v| used[v]) {
        at(&mut found, v as u32, 1, 0);
    }
    for &[a, ..] in proper() {
        at(&mut found, a, 1, 0);
    }
    sides.sort_unstable();
    let mut rims = Sets::new(mesh.positions.len());
    let mut on_rim = Vec::new();
    for same in sides.chunk_by(|a, b| a == b) {
        let [a, b] = same[0];
        at(&mut found, a, -1, 0);
        if same.len() == 1 {
            rims.join(a, b);
            on_rim.extend([a, b]);
        }
    }
    on_rim.sort_unstable();
    on_rim.dedup();
    for v in on_rim {
        if rims.root(v) == v {
            at(&mut found, v, 0, 1);
        }
    }
    found.into_values().collect()
}
