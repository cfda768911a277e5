//! The grid in memory: points, a value on each, and tetrahedra between them.

use glam::DVec3;

use crate::cells::{CellKind, Known, of_vtk};
use crate::error::Problem;
use crate::winding::wind_flat;

/// Bytes that a point takes in memory, with its value.
const POINT_BYTES: u64 = (size_of::<[f64; 3]>() + size_of::<f64>()) as u64;
/// Bytes that a tetrahedron takes.
const TETRAHEDRON_BYTES: u64 = size_of::<[u32; 4]>() as u64;

/// A grid of tetrahedra with a value on each of its points.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    points: Vec<[f64; 3]>,
    values: Vec<f64>,
    tetrahedra: Vec<[u32; 4]>,
    cells: Census,
}

/// The cells that a grid was made of.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Census {
    /// Those that became tetrahedra.
    pub solid: u64,
    /// Points, lines and flat faces, through which no surface goes. They are left out.
    pub flat: u64,
    /// Cells whose points are wound against the greater number of the others.
    pub turned: u64,
    /// Cells of which all that is solid has no volume, to rounding.
    pub without_volume: u64,
}

/// What is odd in a grid, and is taken nevertheless.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Oddities {
    /// Tetrahedra that are inside out, though the cells that they are parts of are not: such a cell is not convex.
    pub folded: u64,
    /// Tetrahedra with a value that is not finite. No surface goes through them.
    pub without_value: u64,
    /// Points of tetrahedra that lie on earlier ones. Cells on different points do not hang together there.
    pub twice: u64,
}

impl Grid {
    /// A grid of tetrahedra.
    ///
    /// # Errors
    /// If there are not as many values as points, a point lies beyond single precision, or a tetrahedron names a point that is not
    /// there, or one twice.
    pub fn try_new(
        points: Vec<[f64; 3]>,
        values: Vec<f64>,
        tetrahedra: Vec<[u32; 4]>,
    ) -> Result<Self, Problem> {
        for (cell, of) in tetrahedra.iter().enumerate() {
            if (0..4).any(|i| (0..i).any(|j| of[i] == of[j])) {
                return Err(Problem::cell(cell, format!("{of:?} names a point twice")));
            }
        }
        Self::of_cells(points, values, tetrahedra.iter().map(|of| (CellKind::Tetrahedron, of.as_slice())))
    }

    /// A grid of cells of several kinds, each with its points.
    ///
    /// # Errors
    /// If there are not as many values as points, a point lies beyond single precision, or a cell has not as many points as its kind, or
    /// one that is not there.
    pub fn of_cells<'a>(
        points: Vec<[f64; 3]>,
        values: Vec<f64>,
        cells: impl IntoIterator<Item = (CellKind, &'a [u32])>,
    ) -> Result<Self, Problem> {
        let mut builder = Builder::new(points, values, u64::MAX)?;
        for (number, (kind, of)) in cells.into_iter().enumerate() {
            builder.cell(number, kind, of.iter().map(|&point| i64::from(point)))?;
        }
        Ok(builder.finish())
    }

    /// Where its points lie.
    pub fn points(&self) -> &[[f64; 3]] {
        &self.points
    }

    /// The value on each point.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The points of each tetrahedron, each four different ones. Seen from the fourth, the first three are counter-clockwise: those of a
    /// cell that is wound otherwise have been turned.
    pub fn tetrahedra(&self) -> &[[u32; 4]] {
        &self.tetrahedra
    }

    /// What it was made of.
    pub fn cells(&self) -> Census {
        self.cells
    }

    /// The same grid with every value's sign turned, for solids that are below the isovalue.
    #[must_use]
    pub fn negated(mut self) -> Self {
        self.values.iter_mut().for_each(|value| *value = -*value);
        self
    }

    /// The least and the greatest value on the points of tetrahedra, those that are not finite aside; `None` without any.
    pub fn value_range(&self) -> Option<[f64; 2]> {
        let used = self.tetrahedra.iter().flatten().map(|&point| self.values[point as usize]);
        let range = used
            .filter(|value| value.is_finite())
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)]);
        (range[0] <= range[1]).then_some(range)
    }

    /// The smallest and the largest corner of the tetrahedra; `None` without any.
    pub fn bounds(&self) -> Option<[DVec3; 2]> {
        let mut used = self.tetrahedra.iter().flatten().map(|&point| self.point(point));
        let first = used.next()?;
        Some(used.fold([first; 2], |[min, max], p| [min.min(p), max.max(p)]))
    }

    /// What is odd in it.
    pub fn oddities(&self) -> Oddities {
        let mut odd = Oddities::default();
        let mut is_used = vec![false; self.points.len()];
        for of in &self.tetrahedra {
            of.iter().for_each(|&point| is_used[point as usize] = true);
            let (volume, rounding) = self.six_volumes(*of);
            odd.folded += u64::from(volume < -rounding);
            odd.without_value += u64::from(of.iter().any(|&point| !self.values[point as usize].is_finite()));
        }
        // Zeros of both signs are one place.
        let used = self.points.iter().zip(&is_used).filter(|(_, is_used)| **is_used);
        let mut places: Vec<[u64; 3]> = used.map(|(at, _)| at.map(|x| (x + 0.0).to_bits())).collect();
        places.sort_unstable();
        odd.twice = places.windows(2).filter(|pair| pair[0] == pair[1]).count() as u64;
        odd
    }

    pub(crate) fn point(&self, point: u32) -> DVec3 {
        DVec3::from_array(self.points[point as usize])
    }

    /// Six times the volume of a tetrahedron, positive if it is wound as all should be; and what of it may be rounding.
    fn six_volumes(&self, of: [u32; 4]) -> (f64, f64) {
        let [a, b, c, d] = of.map(|point| self.point(point));
        let [ab, ac, ad] = [b - a, c - a, d - a];
        let largest = a.abs().max(b.abs()).max(c.abs()).max(d.abs()).max_element();
        let edge = ab.abs().max(ac.abs()).max(ad.abs()).max_element();
        (ab.cross(ac).dot(ad), 16.0 * f64::EPSILON * edge * edge * largest.max(edge))
    }
}

/// A grid whose cells come one by one.
pub(crate) struct Builder {
    grid: Grid,
    limit: u64,
    /// The points of a cell, kept for its memory.
    of_cell: Vec<u32>,
    /// Cells by how their points are wound.
    wound: [u64; 2],
    /// Tetrahedra of cells without volume.
    flat: Vec<u32>,
}

impl Builder {
    /// # Errors
    /// As [`Grid::try_new`]; if it takes more than the limit, in bytes.
    pub(crate) fn new(points: Vec<[f64; 3]>, values: Vec<f64>, limit: u64) -> Result<Self, Problem> {
        if points.len() != values.len() {
            return Err(Problem::Whole(format!("{} values are on {} points", values.len(), points.len())));
        }
        if points.len() > u32::MAX as usize {
            return Err(Problem::Whole(format!("there are {} points, more than 2^32 - 1", points.len())));
        }
        let is_place = |at: &[f64; 3]| at.iter().all(|x| x.abs() <= f64::from(f32::MAX));
        if let Some(point) = points.iter().position(|at| !is_place(at)) {
            return Err(Problem::Point { point, at: points[point] });
        }
        let grid = Grid { points, values, tetrahedra: Vec::new(), cells: Census::default() };
        Ok(Self { grid, limit, of_cell: Vec::new(), wound: [0; 2], flat: Vec::new() })
    }

    pub(crate) fn points(&self) -> usize {
        self.grid.points.len()
    }

    /// Adds a cell, by its number in the file.
    ///
    /// # Errors
    /// If it has not as many points as its kind, or one that is not there; if memory is beyond the limit.
    pub(crate) fn cell(
        &mut self,
        cell: usize,
        kind: CellKind,
        points: impl IntoIterator<Item = i64>,
    ) -> Result<(), Problem> {
        let there = self.grid.points.len();
        self.of_cell.clear();
        for point in points {
            let known = u32::try_from(point).ok().filter(|&point| (point as usize) < there);
            self.of_cell.push(known.ok_or_else(|| no_point(cell, point, there as u64))?);
        }
        let (got, wanted) = (self.of_cell.len(), kind.points());
        if got != wanted {
            return Err(Problem::cell(cell, format!("a {} has {wanted} points, not {got}", kind.name())));
        }
        let before = self.grid.tetrahedra.len();
        kind.cut(&self.of_cell, &mut self.grid.tetrahedra);
        self.wind(before);
        self.grid.cells.solid += 1;
        if self.grid.tetrahedra.len() > u32::MAX as usize {
            return Err(Problem::cell(cell, "there are more tetrahedra up to here than 2^32 - 1"));
        }
        let needed = there as u64 * POINT_BYTES + self.grid.tetrahedra.len() as u64 * TETRAHEDRON_BYTES;
        if needed > self.limit {
            let what = format!("the first {} cells", self.grid.cells.solid);
            return Err(Problem::TooLarge { what, needed, limit: self.limit });
        }
        Ok(())
    }

    /// Winds the tetrahedra of a cell as all are to be. The cell's volume decides, and not their own: cells of a curvilinear grid need not be
    /// convex, and some of their tetrahedra may be inside out. If these were turned alone, the surface would face both ways.
    fn wind(&mut self, from: usize) {
        let (mut volume, mut rounding) = (0.0, 0.0);
        for of in &self.grid.tetrahedra[from..] {
            let (more, of_it) = self.grid.six_volumes(*of);
            volume += more;
            rounding += of_it;
        }
        match volume {
            volume if volume > rounding => self.wound[0] += 1,
            volume if volume < -rounding => {
                self.wound[1] += 1;
                self.grid.tetrahedra[from..].iter_mut().for_each(|of| of.swap(2, 3));
            }
            _ => {
                self.grid.cells.without_volume += 1;
                self.flat.extend(from as u32..self.grid.tetrahedra.len() as u32);
            }
        }
    }

    /// Adds a cell by VTK's number of its type, of a piece with so many points from `first` on. What has no volume is counted.
    ///
    /// # Errors
    /// As [`cell`](Self::cell); if it is of a type that is not taken.
    pub(crate) fn vtk_cell(
        &mut self,
        number: usize,
        kind: i64,
        points: &[i64],
        first: u64,
        there: u64,
    ) -> Result<(), Problem> {
        match of_vtk(kind) {
            Known::Solid(of) => {
                // A point of another piece is none of this one.
                if let Some(point) = points.iter().find(|&&point| point < 0 || point as u64 >= there) {
                    return Err(no_point(number, *point, there));
                }
                self.cell(number, of, points.iter().map(|point| point + first as i64))
            }
            Known::Flat => {
                self.grid.cells.flat += 1;
                Ok(())
            }
            Known::Refused(name) => Err(Problem::cell(
                number,
                format!(
                    "is a {name} (type {kind}). Tetrahedra, voxels, hexahedra, wedges and pyramids are taken; \
                     ParaView's filter Tetrahedralize makes them"
                ),
            )),
        }
    }

    /// Adds the cells between the points of a curvilinear grid, x fastest, of which `counts` lie along each axis from `first` on.
    ///
    /// # Errors
    /// If memory is beyond the limit.
    pub(crate) fn block(&mut self, first: u64, counts: [u64; 3]) -> Result<(), Problem> {
        let [x, y, z] = counts;
        let at = |i: u64, j: u64, k: u64| (first + i + x * (j + y * k)) as i64;
        let mut cell = self.grid.cells.solid as usize;
        for k in 1..z {
            for j in 1..y {
                for i in 1..x {
                    let layer = |k| [at(i - 1, j - 1, k), at(i, j - 1, k), at(i, j, k), at(i - 1, j, k)];
                    let points = layer(k - 1).into_iter().chain(layer(k));
                    self.cell(cell, CellKind::Hexahedron, points)?;
                    cell += 1;
                }
            }
        }
        Ok(())
    }

    pub(crate) fn finish(mut self) -> Grid {
        self.grid.cells.turned = self.wound[0].min(self.wound[1]);
        if !self.flat.is_empty() {
            wind_flat(&mut self.grid.tetrahedra, &self.flat);
        }
        self.grid
    }
}

fn no_point(cell: usize, point: i64, there: u64) -> Problem {
    Problem::cell(cell, format!("names point {point}, and the points are 0 to {}", there as i64 - 1))
}
