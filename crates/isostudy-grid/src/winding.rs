//! Which way tetrahedra without volume are wound: as their neighbours say.

use std::collections::HashMap;

/// Winds flat tetrahedra, by their numbers, so that each goes with a neighbour over a face, and that with its own, up to one that has a
/// volume. So the surface that goes through them faces one way. Those that reach none stay as they are.
pub(crate) fn wind_flat(tetrahedra: &mut [[u32; 4]], flat: &[u32]) {
    // The flat tetrahedra at a face, each with whether it has the face in its sorted order.
    let mut at_face: HashMap<[u32; 3], Vec<(u32, bool)>> = HashMap::new();
    for &number in flat {
        for (face, is_even) in faces(tetrahedra[number as usize]) {
            at_face.entry(face).or_default().push((number, is_even));
        }
    }
    // What is known of each: whether it is to be turned.
    let mut known: HashMap<u32, Option<bool>> = flat.iter().map(|&number| (number, None)).collect();
    let mut waiting: Vec<(u32, bool)> = Vec::new();
    for (number, of) in (0..).zip(tetrahedra.iter()) {
        if !known.contains_key(&number) {
            tell_neighbours(*of, false, &at_face, &mut known, &mut waiting);
        }
    }
    while let Some((number, is_turned)) = waiting.pop() {
        tell_neighbours(tetrahedra[number as usize], is_turned, &at_face, &mut known, &mut waiting);
    }
    for (&number, &is_turned) in &known {
        if is_turned == Some(true) {
            tetrahedra[number as usize].swap(2, 3);
        }
    }
}

/// Says to the flat neighbours of a tetrahedron, where nobody has, whether they are to be turned.
fn tell_neighbours(
    of: [u32; 4],
    is_turned: bool,
    at_face: &HashMap<[u32; 3], Vec<(u32, bool)>>,
    known: &mut HashMap<u32, Option<bool>>,
    waiting: &mut Vec<(u32, bool)>,
) {
    for (face, is_even) in faces(of) {
        for &(other, other_is_even) in at_face.get(&face).into_iter().flatten() {
            let of_other = known.get_mut(&other).expect("it is flat");
            if of_other.is_none() {
                // Neighbours have their face in opposite orders.
                let turn_other = is_turned ^ (is_even == other_is_even);
                *of_other = Some(turn_other);
                waiting.push((other, turn_other));
            }
        }
    }
}

/// The faces of a tetrahedron, sorted, each with whether it takes an even number of swaps to sort it as the tetrahedron winds it.
fn faces(of: [u32; 4]) -> [([u32; 3], bool); 4] {
    [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]].map(|face: [usize; 3]| {
        let mut face = face.map(|i| of[i]);
        let mut is_even = true;
        for [i, j] in [[0, 1], [1, 2], [0, 1]] {
            if face[i] > face[j] {
                face.swap(i, j);
                is_even = !is_even;
            }
        }
        (face, is_even)
    })
}
