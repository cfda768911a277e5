//! A convex cell: corners, and the edges and faces of their hull.

use std::fmt;

use crate::hull::{Hull, Place, dot, hull, in_order, minus, normal};

/// A convex cell with corners at whole coordinates. A [divided](Self::divided) cube has corners within faces and edges.
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
    /// The corners of each face, one bit each.
    corners_of_face: Vec<u32>,
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
        in_order(&mut edges);
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
            corners_of_face: faces.iter().map(|face| face.iter().fold(0, |set, c| set | 1 << c)).collect(),
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

    /// The cube with corners at 0 and 2, some of whose edges are divided into two and some of whose sides into four squares, for seams
    /// to cubes half as large.
    ///
    /// Corner `x + 3 y + 9 z` is `(x, y, z)`; points that no face has are there too. `sides` has a bit for each side, `2 axis` for the
    /// lower one and `2 axis + 1` for the upper. `edges` has one for each edge, `4 axis`, and 1 and 2 more where it is at the upper
    /// end of the next axis and of the one after that, in cyclic order. Edges of divided sides are divided anyway.
    ///
    /// Faces go by sides. A divided side has four, its squares; another one has a face with up to eight corners.
    pub fn divided(sides: u8, edges: u16) -> Self {
        let axes = |axis: usize| [axis, (axis + 1) % 3, (axis + 2) % 3];
        let point = |place: Place| (place[0] + 3 * place[1] + 9 * place[2]) as u8;
        // A middle between two corners is there if its edge is divided.
        let is_edge_divided = |middle: Place| {
            let axis = (0..3).find(|&axis| middle[axis] == 1).expect("the middle of an edge");
            let [_, u, v] = axes(axis);
            let is_side_divided = |axis: usize| sides >> (2 * axis) >> (middle[axis] / 2) & 1 != 0;
            let number = 4 * axis + (middle[u] / 2) as usize + middle[v] as usize;
            edges >> number & 1 != 0 || is_side_divided(u) || is_side_divided(v)
        };
        let mut faces = Vec::new();
        for side in 0..6 {
            let ([axis, u, v], is_high) = (axes(side / 2), side % 2 != 0);
            // Round a square, counter-clockwise seen from above.
            let mut add = |low: [i32; 2], steps: &[[i32; 2]]| {
                let mut face: Vec<u8> = Vec::new();
                for step in steps {
                    let mut place = [0; 3];
                    (place[axis], place[u], place[v]) =
                        (if is_high { 2 } else { 0 }, low[0] + step[0], low[1] + step[1]);
                    let is_middle = place.iter().filter(|&&c| c == 1).count() == 1;
                    if sides >> side & 1 != 0 || !is_middle || is_edge_divided(place) {
                        face.push(point(place));
                    }
                }
                if !is_high {
                    face.reverse();
                }
                faces.push(face);
            };
            if sides >> side & 1 != 0 {
                for low in [[0, 0], [1, 0], [0, 1], [1, 1]] {
                    add(low, &[[0, 0], [1, 0], [1, 1], [0, 1]]);
                }
            } else {
                let round = [[0, 0], [1, 0], [2, 0], [2, 1], [2, 2], [1, 2], [0, 2], [0, 1]];
                add([0, 0], &round);
            }
        }
        Self::with_faces((0..27).map(|c| [c % 3, c / 3 % 3, c / 9]).collect(), faces)
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

    /// The corners of each face, one bit each.
    pub(crate) fn corners_of_face(&self) -> &[u32] {
        &self.corners_of_face
    }

    /// Whether the faces at an edge lie in one plane.
    pub(crate) fn is_within_side(&self, edge: usize) -> bool {
        let faces = self.faces.iter().enumerate().filter(|(f, _)| self.faces_at_edge[edge] >> f & 1 != 0);
        let mut places = faces.flat_map(|(_, face)| face.iter().map(|&c| self.corners[usize::from(c)]));
        let ends = self.edges[edge].map(|c| self.corners[usize::from(c)]);
        let normals = places.clone().map(|place| normal([ends[0], ends[1], place]));
        let across = normals.into_iter().find(|&normal| normal != [0; 3]).unwrap_or_default();
        places.all(|place| dot(across, minus(place, ends[0])) == 0)
    }

    /// The edges whose ends are on different sides, one bit each. `inside` has one bit a corner.
    pub fn crossed(&self, inside: u32) -> u64 {
        let differs = |[a, b]: [u8; 2]| u64::from((inside >> a ^ inside >> b) & 1);
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
