//! A convex cell: corners, and the edges and faces of their hull.

use std::fmt;

use crate::hull::{Hull, Place, hull};

/// A convex cell with corners at whole coordinates. That of a [`transition`](Self::transition) has corners within faces and edges.
///
/// Corners keep their numbers. Edges are numbered by their lower corner, then by their higher one; faces by their corners.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Cell {
    corners: Vec<Place>,
    edges: Vec<[u8; 2]>,
    faces: Vec<Vec<u8>>,
    face_edges: Vec<Vec<u8>>,
    faces_at_edge: Vec<u32>,
    faces_at_corner: Vec<u32>,
}

/// Why corners make no cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum CellError {
    /// All corners lie in one plane, or there are fewer than four.
    Flat,
    /// A corner is no corner of the hull, or there are two in one place.
    NotConvex,
    /// There are more than 12 corners, or coordinates beyond 1,000 either way.
    TooLarge,
}

impl fmt::Display for CellError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Flat => "a cell needs four corners that are not in one plane",
            Self::NotConvex => "every corner of a cell must be a corner of their convex hull",
            Self::TooLarge => "a cell has at most 12 corners, with coordinates from -1000 to 1000",
        })
    }
}

impl std::error::Error for CellError {}

const MOST_CORNERS: usize = 12;
const FARTHEST: i32 = 1000;

impl Cell {
    /// The cell with these corners.
    ///
    /// # Errors
    /// [`CellError`].
    pub fn try_new(corners: &[[i32; 3]]) -> Result<Self, CellError> {
        let is_far = |corner: &Place| corner.iter().any(|c| !(-FARTHEST..=FARTHEST).contains(c));
        if corners.len() > MOST_CORNERS || corners.iter().any(is_far) {
            return Err(CellError::TooLarge);
        }
        for (c, &corner) in corners.iter().enumerate() {
            let others = [&corners[..c], &corners[c + 1..]].concat();
            if is_in_hull(corner, &others) {
                return Err(CellError::NotConvex);
            }
        }
        let Hull::Solid(faces) = hull(corners) else { return Err(CellError::Flat) };
        Ok(Self::with_faces(corners.to_vec(), faces))
    }

    /// The cell with these faces, which are taken as given.
    fn with_faces(corners: Vec<Place>, faces: Vec<Vec<u8>>) -> Self {
        let mut edges: Vec<[u8; 2]> = faces
            .iter()
            .flat_map(|face| (0..face.len()).map(|i| side(face, i)))
            .map(|[a, b]| [a.min(b), a.max(b)])
            .collect();
        edges.sort_unstable();
        edges.dedup();
        let number = |[a, b]: [u8; 2]| {
            let edge = [a.min(b), a.max(b)];
            edges.iter().position(|&e| e == edge).expect("sides of faces are edges") as u8
        };
        let face_edges: Vec<Vec<u8>> =
            faces.iter().map(|face| (0..face.len()).map(|i| number(side(face, i))).collect()).collect();
        let faces_with = |lists: &[Vec<u8>], item: usize| {
            let has = |list: &Vec<u8>| list.contains(&(item as u8));
            lists.iter().enumerate().fold(0, |set, (f, list)| set | u32::from(has(list)) << f)
        };
        Self {
            faces_at_edge: (0..edges.len()).map(|e| faces_with(&face_edges, e)).collect(),
            faces_at_corner: (0..corners.len()).map(|c| faces_with(&faces, c)).collect(),
            corners,
            edges,
            faces,
            face_edges,
        }
    }

    /// The cube: corner `i` at `(i & 1, i >> 1 & 1, i >> 2)`.
    pub fn cube() -> Self {
        let corners: Vec<Place> = (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2]).collect();
        Self::try_new(&corners).expect("a cube is a cell")
    }

    /// The tetrahedron of the origin and the three units.
    pub fn tetrahedron() -> Self {
        Self::try_new(&[[0; 3], [1, 0, 0], [0, 1, 0], [0, 0, 1]]).expect("a tetrahedron is a cell")
    }

    /// The pyramid on a square.
    pub fn pyramid() -> Self {
        Self::try_new(&[[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0], [1, 1, 1]]).expect("a pyramid is a cell")
    }

    /// The prism on a triangle.
    pub fn wedge() -> Self {
        let corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1]];
        Self::try_new(&corners).expect("a wedge is a cell")
    }

    /// The octahedron with corners at the units and their opposites.
    pub fn octahedron() -> Self {
        let corners = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];
        Self::try_new(&corners).expect("an octahedron is a cell")
    }

    /// The cell between a square of a coarse grid and the four of the fine grid in its place, for seams of two resolutions
    /// (Lengyel 2010). Corner `i + 3 j` is `(i, j, 0)` of the fine squares, corner `9 + i + 2 j` is `(2 i, 2 j, 1)` of the coarse one.
    ///
    /// Faces 0 to 3 are the fine squares, x fastest; face 4 is the coarse one; 5 to 8 are the sides at y = 0, y = 2, x = 0 and
    /// x = 2, with five corners each. A corner of the coarse square is on the side of the fine one that it stands for: no edge
    /// between the squares is ever crossed, and no side is ever ambiguous.
    pub fn transition() -> Self {
        let fine = (0..9).map(|c| [c % 3, c / 3, 0]);
        let coarse = (0..4).map(|c| [c % 2 * 2, c / 2 * 2, 1]);
        let squares = [0, 1, 3, 4].map(|c| vec![c, c + 3, c + 4, c + 1]);
        let others: [&[u8]; 5] =
            [&[9, 10, 12, 11], &[0, 1, 2, 10, 9], &[6, 11, 12, 8, 7], &[0, 9, 11, 6, 3], &[2, 5, 8, 12, 10]];
        let faces = squares.into_iter().chain(others.map(<[u8]>::to_vec));
        Self::with_faces(fine.chain(coarse).collect(), faces.collect())
    }

    /// The corners, as given.
    pub fn corners(&self) -> &[[i32; 3]] {
        &self.corners
    }

    /// The two corners of each edge, the lower first.
    pub fn edges(&self) -> &[[u8; 2]] {
        &self.edges
    }

    /// The corners of each face, counter-clockwise seen from outside.
    pub fn faces(&self) -> &[Vec<u8>] {
        &self.faces
    }

    /// The edges of each face: edge `i` leads from its corner `i` to the next.
    pub fn face_edges(&self) -> &[Vec<u8>] {
        &self.face_edges
    }

    /// The faces that each edge is in, one bit each.
    pub fn faces_at_edge(&self) -> &[u32] {
        &self.faces_at_edge
    }

    /// The faces that each corner is in, one bit each.
    pub fn faces_at_corner(&self) -> &[u32] {
        &self.faces_at_corner
    }

    /// The edges whose ends are on different sides, one bit each. `inside` has one bit a corner.
    pub fn crossed(&self, inside: u32) -> u32 {
        let differs = |[a, b]: [u8; 2]| (inside >> a ^ inside >> b) & 1;
        self.edges.iter().enumerate().fold(0, |set, (e, &ends)| set | differs(ends) << e)
    }
}

fn side(face: &[u8], i: usize) -> [u8; 2] {
    [face[i], face[(i + 1) % face.len()]]
}

/// Whether a point lies in the hull of others: a few, so every simplex of them is tried.
fn is_in_hull(p: Place, others: &[Place]) -> bool {
    let moved: Vec<[i64; 3]> = others.iter().map(|o| [0, 1, 2].map(|i| i64::from(o[i] - p[i]))).collect();
    let det = |a: [i64; 3], b: [i64; 3], c: [i64; 3]| {
        a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
    };
    // By Caratheodory's theorem a point of the hull is in a tetrahedron, a triangle, a segment or a point of it.
    let n = moved.len();
    let zero = [0i64; 3];
    let opposite = |a: [i64; 3], b: [i64; 3]| {
        let parallel = (0..3).all(|i| a[i] * b[(i + 1) % 3] == a[(i + 1) % 3] * b[i]);
        parallel && (0..3).map(|i| a[i] * b[i]).sum::<i64>() <= 0
    };
    for i in 0..n {
        if moved[i] == zero {
            return true;
        }
        for j in i + 1..n {
            if opposite(moved[i], moved[j]) {
                return true;
            }
            for k in j + 1..n {
                let [a, b, c] = [moved[i], moved[j], moved[k]];
                if det(a, b, c) == 0 && is_in_flat_triangle([a, b, c]) {
                    return true;
                }
                for &d in &moved[k + 1..] {
                    let parts = [det(a, b, c), -det(a, b, d), det(a, c, d), -det(b, c, d)];
                    let whole: i64 = parts.iter().sum();
                    if whole != 0 && parts.iter().all(|part| part * whole.signum() >= 0) {
                        return true;
                    }
                }
            }
        }
    }
    false
}

/// Whether the origin lies in a triangle whose plane it is in.
fn is_in_flat_triangle([a, b, c]: [[i64; 3]; 3]) -> bool {
    let cross = |a: [i64; 3], b: [i64; 3]| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let parts = [cross(a, b), cross(b, c), cross(c, a)];
    let whole: [i64; 3] = [0, 1, 2].map(|i| parts.iter().map(|part| part[i]).sum());
    whole != [0; 3] && parts.iter().all(|part| (0..3).map(|i| part[i] * whole[i]).sum::<i64>() >= 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_have_the_edges_and_faces_of_their_shapes() {
        for (cell, corners, edges, faces) in [
            (Cell::cube(), 8, 12, 6),
            (Cell::tetrahedron(), 4, 6, 4),
            (Cell::pyramid(), 5, 8, 5),
            (Cell::wedge(), 6, 9, 5),
            (Cell::octahedron(), 6, 12, 8),
        ] {
            assert_eq!(
                (cell.corners().len(), cell.edges().len(), cell.faces().len()),
                (corners, edges, faces)
            );
            assert!(cell.faces_at_edge().iter().all(|faces| faces.count_ones() == 2));
        }
    }

    #[test]
    fn what_is_no_cell_is_refused() {
        let square = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]];
        assert_eq!(Cell::try_new(&square), Err(CellError::Flat));
        let mut cube: Vec<[i32; 3]> = Cell::cube().corners().iter().map(|c| c.map(|x| 2 * x)).collect();
        for extra in [[1, 1, 1], [1, 0, 0], [1, 1, 0], [2, 2, 2]] {
            cube.push(extra);
            assert_eq!(Cell::try_new(&cube), Err(CellError::NotConvex), "{extra:?}");
            cube.pop();
        }
        assert!(Cell::try_new(&cube).is_ok());
        cube[0] = [-2000, 0, 0];
        assert_eq!(Cell::try_new(&cube), Err(CellError::TooLarge));
    }
}
