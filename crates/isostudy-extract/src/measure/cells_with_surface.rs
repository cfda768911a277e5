//! Which cubes of a box may have a piece of an isosurface.

use glam::{DVec3, I64Vec3, Vec3};
use isostudy_mesh::Bounds;

use crate::measure::lines::Line;
use crate::sampling::level::Level;

/// Most cubes, a byte each; in a larger box they are larger.
const MOST: f64 = 16_777_216.0;

/// Cubes of about a spacing that fill a box.
pub(crate) struct CellsWithSurface {
    min: DVec3,
    /// Sides of a cube.
    side: DVec3,
    count: I64Vec3,
    may_have: Vec<bool>,
}

impl CellsWithSurface {
    /// By the ranges that the field knows; a field that knows none may have a surface everywhere.
    pub(crate) fn of(level: &Level, bounds: &Bounds) -> Self {
        let (min, size) = (bounds.min.as_dvec3(), bounds.max.as_dvec3() - bounds.min.as_dvec3());
        let mut side = f64::from(level.spacing);
        let along = |side: f64| (size / side).ceil().max(DVec3::ONE);
        while along(side).element_product() > MOST {
            side *= 2.0;
        }
        let count = along(side).as_i64vec3();
        let places = count.element_product() as usize;
        let mut cells = Self { min, side: size / count.as_dvec3(), count, may_have: vec![false; places] };
        cells.mark(level, I64Vec3::ZERO, count);
        cells
    }

    /// The smallest box of all that may have some; `None` if none has.
    pub(crate) fn bounds(&self) -> Option<Bounds> {
        let mut found: Option<(I64Vec3, I64Vec3)> = None;
        for (place, _) in self.may_have.iter().enumerate().filter(|(_, may)| **may) {
            let (place, [x, y, _]) = (place as i64, self.count.to_array());
            let cell = I64Vec3::new(place % x, place / x % y, place / x / y);
            let (low, high) = found.unwrap_or((cell, cell));
            found = Some((low.min(cell), high.max(cell)));
        }
        found.map(|(low, high)| self.bounds_of(low, high + 1))
    }

    /// The parts of a line, by distance from where it begins, that lie in cubes that may have some.
    pub(crate) fn parts_of(&self, line: &Line, mut part: impl FnMut(f64, f64)) {
        let from = (line.from - self.min) / self.side;
        let way = line.direction / self.side;
        let last = self.count - 1;
        let mut cell = from.floor().as_i64vec3().clamp(I64Vec3::ZERO, last);
        let step = way.signum().as_i64vec3();
        let next_side = (cell + step.max(I64Vec3::ZERO)).as_dvec3();
        let mut next = (next_side - from) / way;
        let each = way.recip().abs();
        let (mut at, mut begun) = (0.0, None);
        while at < line.length {
            let axis = next.min_position();
            let leaves = next[axis].clamp(at, line.length);
            if self.may_have[self.place(cell)] {
                begun = begun.or(Some(at));
            } else if let Some(begun) = begun.take() {
                part(begun, at);
            }
            at = leaves;
            cell[axis] += step[axis];
            next[axis] += each[axis];
            if cell[axis] < 0 || cell[axis] > last[axis] {
                break;
            }
        }
        if let Some(begun) = begun {
            part(begun, at.min(line.length));
        }
    }

    fn place(&self, cell: I64Vec3) -> usize {
        let [x, y, z] = cell.to_array().map(|along| along as usize);
        (z * self.count.y as usize + y) * self.count.x as usize + x
    }

    fn bounds_of(&self, low: I64Vec3, high: I64Vec3) -> Bounds {
        let corner = |of: I64Vec3| (self.min + self.side * of.as_dvec3()).as_vec3();
        Bounds { min: corner(low), max: corner(high) }
    }

    /// Those from `low` to before `high`, by halves.
    fn mark(&mut self, level: &Level, low: I64Vec3, high: I64Vec3) {
        let bounds = self.bounds_of(low, high);
        let isovalue = level.isovalue;
        let mut range = level.field.range(bounds, f32::NAN);
        if range.is_some_and(|(least, most)| least.is_nan() || most.is_nan()) {
            let middle: Vec3 = (bounds.min + bounds.max) * 0.5;
            range = level.field.range(bounds, level.field.sample(middle));
        }
        if range.is_some_and(|(least, most)| least > isovalue || most < isovalue) {
            return;
        }
        let size = high - low;
        if range.is_none() || size == I64Vec3::ONE {
            for z in low.z..high.z {
                for y in low.y..high.y {
                    let row = self.place(I64Vec3::new(low.x, y, z));
                    self.may_have[row..row + size.x as usize].fill(true);
                }
            }
            return;
        }
        let axis = size.max_position();
        let middle = low[axis] + size[axis] / 2;
        let (mut first, mut second) = (high, low);
        (first[axis], second[axis]) = (middle, middle);
        self.mark(level, low, first);
        self.mark(level, second, high);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::lines::Lines;
    use isostudy_field::{Sphere, StudyField};

    struct Unknown;

    impl StudyField for Unknown {
        fn sample(&self, p: Vec3) -> f32 {
            p.x
        }
    }

    fn cells(field: &dyn StudyField) -> CellsWithSurface {
        let bounds = Bounds { min: glam::vec3(-1.0, -0.9, -0.8), max: glam::vec3(1.1, 1.0, 0.9) };
        CellsWithSurface::of(&Level { field, isovalue: 0.0, spacing: 0.13 }, &bounds)
    }

    #[test]
    fn a_sphere_lies_in_few_cubes_and_an_unknown_field_in_all() {
        let all = cells(&Unknown);
        assert!(all.may_have.iter().all(|may| *may));
        let some = cells(&Sphere { radius: 0.5 });
        let share = some.may_have.iter().filter(|may| **may).count() as f64 / some.may_have.len() as f64;
        assert!(share < 0.3, "{share}");
        let bounds = some.bounds().unwrap();
        assert!(bounds.min.cmple(Vec3::splat(-0.5)).all() && bounds.min.cmpge(Vec3::splat(-0.8)).all());
        assert_eq!(cells(&Sphere { radius: 9.0 }).bounds(), None);
    }

    /// By trying many points of each line.
    #[test]
    fn parts_of_lines_are_those_in_the_cubes() {
        let cells = cells(&Sphere { radius: 0.5 });
        let bounds = cells.bounds_of(I64Vec3::ZERO, cells.count);
        let lines = Lines::through(&bounds, 500);
        for line in lines.rows().iter().flat_map(|row| lines.of(row)) {
            let mut parts = Vec::new();
            cells.parts_of(&line, |from, to| parts.push((from, to)));
            for i in 0..200 {
                let at = line.length * (f64::from(i) + 0.5) / 200.0;
                let q = (line.from + line.direction * at - cells.min) / cells.side;
                if (q - q.round()).abs().min_element() < 1e-6 {
                    continue;
                }
                let want = cells.may_have[cells.place(q.floor().as_i64vec3())];
                assert_eq!(parts.iter().any(|(from, to)| (*from..*to).contains(&at)), want, "{line:?}");
            }
        }
    }
}
