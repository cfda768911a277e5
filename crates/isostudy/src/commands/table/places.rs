//! Where the triangles of tables lie on a field.

use crate::memory::Limit;
use crate::source::Source;
use anyhow::{Result, bail};
use glam::Vec3;
use isostudy_cells::{Cell, EdgeGroups, Table};

/// A table, and the groups of its triangles by those of another cell of its shape.
pub(super) struct Part<'a> {
    table: &'a Table,
    groups: &'a EdgeGroups,
    /// The other cell's edge of each edge.
    edges: Vec<u8>,
}

impl<'a> Part<'a> {
    /// A table whose cell has the shape of another; `None` if it has not.
    pub(super) fn new(table: &'a Table, shape: &Cell, groups: &'a EdgeGroups) -> Option<Self> {
        let to = onto(table.cell(), shape)?;
        let number = |&[a, b]: &[u8; 2]| {
            let [a, b] = [a, b].map(|c| to[usize::from(c)]);
            shape.edges().iter().position(|&e| e == [a.min(b), a.max(b)]).map(|e| e as u8)
        };
        let edges = table.cell().edges().iter().map(number).collect::<Option<_>>()?;
        Some(Self { table, groups, edges })
    }

    pub(super) fn table(&self) -> &'a Table {
        self.table
    }

    /// The group of a triangle of the table.
    pub(super) fn group(&self, triangle: [u8; 3]) -> usize {
        let triangle = triangle.map(|e| self.edges[usize::from(e)]);
        self.groups.number(triangle).expect("no triangle of a table lies in a face")
    }
}

/// The corners that each corner of a cell is taken to by a motion or a reflection.
fn onto(cell: &Cell, shape: &Cell) -> Option<Vec<u8>> {
    fn extend(from: &[[i32; 3]], to: &[[i32; 3]], found: &mut Vec<u8>) -> bool {
        let next = found.len();
        if next == from.len() {
            return true;
        }
        (0..to.len()).any(|candidate| {
            let fits = |before: usize| {
                let image = usize::from(found[before]);
                image != candidate && squared(from[before], from[next]) == squared(to[image], to[candidate])
            };
            if !(0..next).all(fits) {
                return false;
            }
            found.push(candidate as u8);
            let is_found = extend(from, to, found);
            if !is_found {
                found.pop();
            }
            is_found
        })
    }
    let (from, to) = (cell.corners(), shape.corners());
    let mut found = Vec::new();
    (from.len() == to.len() && extend(from, to, &mut found)).then_some(found)
}

fn squared(a: [i32; 3], b: [i32; 3]) -> i32 {
    (0..3).map(|i| (a[i] - b[i]).pow(2)).sum()
}

/// Calls `visit` with the corners and the group of each triangle of a source's surface. Each cube of the source's grid has the cells of
/// all parts: a cube's as it is, tetrahedra's in half cubes. Lattice points beyond the box are not there.
///
/// # Errors
/// If samples need more memory than there is.
pub(super) fn for_each_triangle(
    source: &Source,
    limit: Limit,
    parts: &[Part],
    mut visit: impl FnMut([[f64; 3]; 3], usize),
) -> Result<()> {
    let spacing = f64::from(source.spacing);
    let size =
        source.bounds.size().to_array().map(|side| ((f64::from(side) / spacing).ceil() as usize).max(1));
    // Points in half cubes.
    let points = size.map(|n| 2 * n + 1);
    let bytes =
        points.iter().fold(size_of::<Option<f32>>() as u64, |bytes, &n| bytes.saturating_mul(n as u64));
    if bytes.saturating_add(source.held.map_or(0, |volume| volume.total())) > limit.bytes {
        bail!("the samples need {} MiB, more than {}", bytes >> 20, limit.name);
    }
    let mut values: Vec<Option<f32>> = vec![None; points.iter().product()];
    let place = |p: [usize; 3]| {
        let min = source.bounds.min.to_array();
        [0, 1, 2].map(|axis| f64::from(min[axis]) + 0.5 * spacing * p[axis] as f64)
    };
    let mut value = |p: [usize; 3]| {
        let slot = &mut values[(p[2] * points[1] + p[1]) * points[0] + p[0]];
        let of = || source.field.sample(Vec3::from_array(place(p).map(|x| x as f32))) - source.isovalue;
        f64::from(*slot.get_or_insert_with(of))
    };
    let scale = if parts.iter().all(|part| part.table.cell().corners().len() == 8) { 2 } else { 1 };
    let cubes = (0..size.iter().product::<usize>())
        .map(|i| [i % size[0], i / size[0] % size[1], i / size[0] / size[1]]);
    for cube in cubes {
        for part in parts {
            let cell = part.table.cell();
            let corner = |offset: &[i32; 3]| {
                let mut at = [0; 3];
                for axis in 0..3 {
                    let x = 2 * cube[axis] as i64 + i64::from(scale * offset[axis]);
                    at[axis] = usize::try_from(x).ok().filter(|&x| x < points[axis])?;
                }
                Some(at)
            };
            let Some(corners) = cell.corners().iter().map(corner).collect::<Option<Vec<_>>>() else {
                continue;
            };
            let samples: Vec<f64> = corners.iter().map(|&p| value(p)).collect();
            let inside = samples.iter().enumerate().fold(0, |set, (c, &v)| set | u32::from(v > 0.0) << c);
            for &triangle in part.table.triangles(inside) {
                let point = |e: u8| {
                    let [a, b] = cell.edges()[usize::from(e)].map(usize::from);
                    let share = samples[a] / (samples[a] - samples[b]);
                    let [from, to] = [a, b].map(|c| place(corners[c]));
                    [0, 1, 2].map(|axis| from[axis] + (to[axis] - from[axis]) * share)
                };
                visit(triangle.map(point), part.group(triangle));
            }
        }
    }
    Ok(())
}
