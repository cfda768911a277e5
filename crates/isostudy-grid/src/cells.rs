//! Cells of several kinds, cut into tetrahedra.
//!
//! A cell is cut by pulling its vertex with the smallest number: each of its faces that does not have this vertex becomes triangles,
//! and each triangle with the vertex a tetrahedron. A face of four vertices is cut from its own smallest vertex. So two cells cut the
//! face that they share alike, whatever kinds they are. Dompierre and others (*How to Subdivide Pyramids, Prisms and Hexahedra into
//! Tetrahedra*, IMR 1999) show that such faces always fit.

/// A kind of cell that is cut into tetrahedra.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CellKind {
    /// Four points.
    Tetrahedron,
    /// Eight points of a box along the axes, x fastest.
    Voxel,
    /// Eight points: a face of four in cyclic order, then the opposite one.
    Hexahedron,
    /// Six points: a triangle, then the opposite one.
    Wedge,
    /// Five points: a face of four in cyclic order, then the apex.
    Pyramid,
}

/// What a file's cell is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Known {
    Solid(CellKind),
    /// It has no volume, so no surface goes through it: points, lines, flat faces.
    Flat,
    /// What it is called, if it is anything.
    Refused(&'static str),
}

impl CellKind {
    /// How many points it has.
    pub fn points(self) -> usize {
        match self {
            Self::Tetrahedron => 4,
            Self::Pyramid => 5,
            Self::Wedge => 6,
            Self::Voxel | Self::Hexahedron => 8,
        }
    }

    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Tetrahedron => "tetrahedron",
            Self::Voxel => "voxel",
            Self::Hexahedron => "hexahedron",
            Self::Wedge => "wedge",
            Self::Pyramid => "pyramid",
        }
    }

    /// Its faces, each with its vertices in cyclic order, counter-clockwise seen from outside where the points are in VTK's order.
    fn faces(self) -> &'static [&'static [usize]] {
        match self {
            Self::Tetrahedron => &[&[1, 2, 3], &[0, 3, 2], &[0, 1, 3], &[0, 2, 1]],
            Self::Voxel => {
                &[&[0, 2, 3, 1], &[4, 5, 7, 6], &[0, 1, 5, 4], &[2, 6, 7, 3], &[0, 4, 6, 2], &[1, 3, 7, 5]]
            }
            Self::Hexahedron => {
                &[&[0, 3, 2, 1], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]]
            }
            // The base alone has another order than that of a hexahedron.
            Self::Wedge => &[&[0, 1, 2], &[3, 5, 4], &[0, 3, 4, 1], &[1, 4, 5, 2], &[2, 5, 3, 0]],
            Self::Pyramid => &[&[0, 3, 2, 1], &[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4]],
        }
    }

    /// Cuts a cell into tetrahedra, which are appended. All are wound one way: where the points are in VTK's order, the first three of a
    /// tetrahedron are counter-clockwise seen from the fourth. Those with a point twice are left out: a cell that names a point twice is
    /// one of fewer corners, and is cut as that.
    ///
    /// # Panics
    /// If the number of points is not that of the kind.
    pub fn cut(self, points: &[u32], tetrahedra: &mut Vec<[u32; 4]>) {
        assert_eq!(points.len(), self.points());
        let mut keep = |of: [u32; 4]| {
            let is_twice = (0..4).any(|i| (0..i).any(|j| of[i] == of[j]));
            if !is_twice {
                tetrahedra.push(of);
            }
        };
        if self == Self::Tetrahedron {
            return keep([points[0], points[1], points[2], points[3]]);
        }
        let apex = points.iter().copied().min().expect("a cell has points");
        for face in self.faces() {
            if face.iter().any(|&i| points[i] == apex) {
                continue;
            }
            let smallest = (0..face.len()).min_by_key(|&i| points[face[i]]).expect("a face has points");
            let at = |i: usize| points[face[(smallest + i) % face.len()]];
            (1..face.len() - 1).for_each(|i| keep([apex, at(0), at(i), at(i + 1)]));
        }
    }
}

/// The kind of a number that VTK gives cells (`vtkCellType.h`).
pub(crate) fn of_vtk(number: i64) -> Known {
    Known::Refused(match number {
        0..=9 => return Known::Flat,
        10 => return Known::Solid(CellKind::Tetrahedron),
        11 => return Known::Solid(CellKind::Voxel),
        12 => return Known::Solid(CellKind::Hexahedron),
        13 => return Known::Solid(CellKind::Wedge),
        14 => return Known::Solid(CellKind::Pyramid),
        15 => "pentagonal prism",
        16 => "hexagonal prism",
        21..=23 | 28 | 30 | 34..=36 => return Known::Flat,
        24 => "quadratic tetrahedron",
        25 | 33 => "quadratic hexahedron",
        26 | 31 => "quadratic wedge",
        27 | 37 => "quadratic pyramid",
        29 => "triquadratic hexahedron",
        32 => "biquadratic quadratic wedge",
        41 => "convex point set",
        42 => "polyhedron",
        51..=67 => "parametric or higher-order cell",
        68..=70 => return Known::Flat,
        71 | 78 => "Lagrange or Bezier tetrahedron",
        72 | 79 => "Lagrange or Bezier hexahedron",
        73 | 80 => "Lagrange or Bezier wedge",
        74 | 81 => "Lagrange or Bezier pyramid",
        75..=77 => return Known::Flat,
        _ => "cell of an unknown type",
    })
}
