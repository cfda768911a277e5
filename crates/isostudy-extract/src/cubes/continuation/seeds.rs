//! Where continuation begins: near points that are given, or where a search finds that the surface crosses a line.

use super::Continued;
use super::corners::Corners;
use crate::extraction::ExtractError;
use crate::memory::push;
use crate::wording::in_words;

/// What a visited cube is to continuation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum ContinuedCells {
    /// A cube of marching cubes: the mesh of preset `mc`, as far as it is reached.
    #[default]
    Cubes,
    /// Six tetrahedra, as in Bloomenthal's program: two cut off opposite corners, four stand round the diagonal between two others. Faces
    /// that meet are cut along one diagonal. Where a sample equals the isovalue, triangles as small as rounding may be turned over, since not
    /// every corner's faces stand as those of the other arrangements do.
    Tetrahedra,
}

/// Points that continuation begins near, 8 at most; none to search for some.
///
/// With the feature `serde` a list of points, each of three numbers.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Vec<[f32; 3]>", into = "Vec<[f32; 3]>"))]
pub struct Seeds {
    points: [[f32; 3]; Self::MOST],
    count: u8,
}

/// Why there are no such seeds.
#[derive(Debug, Clone, PartialEq)]
pub struct SeedsError {
    /// How many were given.
    pub count: usize,
    /// Whether all coordinates are finite.
    pub is_finite: bool,
}

in_words! {
    SeedsError {
        Self { count, is_finite } =>
            "seeds: {count} points{}; there must be at most {} of finite coordinates",
            if *is_finite { "" } else { ", not all finite" }, Seeds::MOST;
    }
}

impl Seeds {
    /// The most points.
    pub const MOST: usize = 8;

    /// No points: seeds are searched for.
    pub const FOUND: Self = Self { points: [[0.0; 3]; Self::MOST], count: 0 };

    /// These points.
    ///
    /// # Errors
    /// [`SeedsError`] if there are too many, or one is not finite.
    pub fn try_new(points: &[[f32; 3]]) -> Result<Self, SeedsError> {
        let is_finite = points.iter().flatten().all(|coordinate| coordinate.is_finite());
        if points.len() > Self::MOST || !is_finite {
            return Err(SeedsError { count: points.len(), is_finite });
        }
        let mut seeds = Self { count: points.len() as u8, ..Self::FOUND };
        seeds.points[..points.len()].copy_from_slice(points);
        Ok(seeds)
    }

    /// The points.
    pub fn points(&self) -> &[[f32; 3]] {
        &self.points[..usize::from(self.count)]
    }
}

impl TryFrom<Vec<[f32; 3]>> for Seeds {
    type Error = SeedsError;

    fn try_from(points: Vec<[f32; 3]>) -> Result<Self, SeedsError> {
        Self::try_new(&points)
    }
}

impl From<Seeds> for Vec<[f32; 3]> {
    fn from(seeds: Seeds) -> Self {
        seeds.points().to_vec()
    }
}

/// The cells to begin at; one may be there several times.
pub(super) fn cells(continued: &Continued, corners: &mut Corners) -> Result<Vec<[usize; 3]>, ExtractError> {
    let mut cells = Vec::new();
    let points = continued.seeds.points();
    let mut apart = continued.search as usize;
    while points.is_empty() && cells.is_empty() && apart > 0 {
        search(apart, corners, &mut cells)?;
        apart /= 2;
    }
    for &point in points {
        if let Some(cell) = near(point, corners)? {
            push(&mut cells, cell)?;
        }
    }
    Ok(cells)
}

/// The cell of a point, if the surface crosses it. Else the nearest along the lines of lattice edges through the cell's lowest corner, in
/// steps of a cell, x before y before z and up before down.
fn near(point: [f32; 3], corners: &mut Corners) -> Result<Option<[usize; 3]>, ExtractError> {
    let cells = corners.cells();
    let cell = [0, 1, 2].map(|axis| {
        let not_beyond = corners.grid.at[axis].partition_point(|&at| at <= point[axis]);
        not_beyond.saturating_sub(1).min(cells[axis] - 1)
    });
    if !matches!(corners.inside(cell)?, 0 | 255) {
        return Ok(Some(cell));
    }
    let side = corners.is_inside(cell)?;
    let longest = cells.into_iter().max().unwrap_or(0);
    for step in 1..=longest {
        for axis in 0..3 {
            let (up, down) = (cell[axis] + step, cell[axis].checked_sub(step));
            for at in [Some(up).filter(|&at| at <= cells[axis]), down].into_iter().flatten() {
                let mut there = cell;
                there[axis] = at;
                if corners.is_inside(there)? != side {
                    // The edge between this step and the one before begins at its lower end.
                    there[axis] = if at > cell[axis] { at - 1 } else { at };
                    return Ok(Some(there));
                }
            }
        }
    }
    Ok(None)
}

/// Lines of lattice edges, so many cells apart, and the last ones. On each of them a sample every so many cells, and the last one: where
/// two that follow each other are on different sides, halving finds an edge between them that the surface crosses.
fn search(apart: usize, corners: &mut Corners, found: &mut Vec<[usize; 3]>) -> Result<(), ExtractError> {
    let cells = corners.cells();
    let stops = cells.map(|n| (0..n).step_by(apart).chain([n]).collect::<Vec<usize>>());
    for &z in &stops[2] {
        for &y in &stops[1] {
            for &x in &stops[0] {
                let place = [x, y, z];
                for axis in 0..3 {
                    let along = &stops[axis];
                    let next = along.partition_point(|&stop| stop <= place[axis]);
                    let Some(&end) = along.get(next) else { continue };
                    if let Some(mut edge) = crossed_edge(place, axis, end, corners)? {
                        // A cell that has it, also at the end of the box.
                        edge.iter_mut().zip(cells).for_each(|(at, n)| *at = (*at).min(n - 1));
                        push(found, edge)?;
                    }
                }
            }
        }
    }
    Ok(())
}

/// The lower end of a crossed edge between a point and another on its line, if they are on different sides.
fn crossed_edge(
    from: [usize; 3],
    axis: usize,
    end: usize,
    corners: &mut Corners,
) -> Result<Option<[usize; 3]>, ExtractError> {
    let at = |i: usize| {
        let mut place = from;
        place[axis] = i;
        place
    };
    let side = corners.is_inside(from)?;
    if corners.is_inside(at(end))? == side {
        return Ok(None);
    }
    let (mut low, mut high) = (from[axis], end);
    while high - low > 1 {
        let middle = (low + high) / 2;
        if corners.is_inside(at(middle))? == side { low = middle } else { high = middle }
    }
    Ok(Some(at(low)))
}
