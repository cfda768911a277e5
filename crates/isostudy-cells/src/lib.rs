//! Tables of isosurface patches in convex cells, derived by rule and never typed in.
//!
//! A [`Cell`] is known by its corners alone: its edges and faces are those of their convex hull. With a side given for each
//! corner, two rules make a patch of surface:
//!
//! - A *face rule* ([`Cell::loops`]) joins crossings face by face to arcs, and arcs to loops. A face is ambiguous where its
//!   corners change sides more than twice; there it is said whether its inside corners are joined. What a face gets depends on
//!   that face alone, so neighbours agree.
//! - The *hull rule* ([`Cell::hull_patch`]; Bhaniramka, Wenger & Crawfis 2004) takes the convex hull of what is inside or on the
//!   surface. It also knows corners on the surface itself, and so makes the tables of 3^n entries that snapping needs.
//!
//! [`Cell::divided`] is a cube at others half as large, with four squares in the place of a side; it has loops by the same rule.
//!
//! Loops become triangles by a [`Triangulator`], which draws no diagonal in a face of the cell.
//!
//! ```
//! use isostudy_cells::{Cell, Triangulator};
//!
//! let cube = Cell::cube();
//! let triangulator = Triangulator::new(&cube);
//! let triangles: usize = (0..256)
//!     .flat_map(|inside| cube.loops(inside, 0))
//!     .map(|polygon| triangulator.fan(&polygon).expect("there is one").len())
//!     .sum();
//! assert_eq!(triangles, 820);
//! ```
//!
//! # Guaranteed
//!
//! - Triangles and loops run counter-clockwise seen from outside, where inside is the corners with a bit.
//! - Every crossed edge of the cell is in one loop, once.
//! - The same cell gives the same tables on every machine.
//!
//! # Not guaranteed
//!
//! - A polygon may have no triangulation without a diagonal in a face; then there is `None`, and a vertex in the cell helps.
//! - The hull rule joins inside corners through the interior where the hull does, whatever a field does there.
//!
//! # Sources
//!
//! - P. Bhaniramka, R. Wenger, R. Crawfis: Isosurface construction in any dimension using convex hulls. IEEE TVCG 10 (2004).
//! - S. Raman, R. Wenger: Quality isosurface mesh generation using an extended marching cubes lookup table. Computer Graphics
//!   Forum 27 (2008). The tables with corners on the surface.
//! - C. A. Dietrich, C. E. Scheidegger, J. L. D. Comba, L. P. Nedel, C. T. Silva: Edge groups: an approach to understanding the
//!   mesh quality of marching methods. IEEE TVCG 14 (2008).

mod cell;
mod edge_groups;
mod hull;
mod hull_rule;
mod loops;
mod symmetry;
mod table;
mod triangulation;

pub use cell::{Cell, CellError};
pub use edge_groups::{EdgeGroup, EdgeGroups, radius_ratio};
pub use hull_rule::{Label, Point};
pub use loops::{Loops, Step};
pub use symmetry::{Symmetry, classes, classes_with_complement, symmetries};
pub use table::{Table, TableError};
pub use triangulation::{PolygonTriangles, Triangulator};
