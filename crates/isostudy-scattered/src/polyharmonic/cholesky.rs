//! The Cholesky factor of a symmetric positive definite matrix that grows by rows.

/// Rows that are worked on at once, so that each row of the factor is read once for all of them.
pub(super) const BLOCK: usize = 4;

/// A row that is as good as a sum of others leaves less than this of its diagonal.
const DEPENDENT: f64 = 1e-13;

/// The lower factor `L` with `L L^T` the matrix, its rows one after another.
#[derive(Default)]
pub(super) struct Cholesky {
    rows: Vec<f64>,
    len: usize,
}

impl Cholesky {
    /// How many rows there are.
    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// Makes room, so that growing copies nothing.
    pub(super) fn reserve(&mut self, rows: usize) {
        self.rows.reserve((rows * (rows + 1) / 2).saturating_sub(self.rows.len()));
    }

    /// Appends up to [`BLOCK`] rows of the matrix: row `b` holds its entries with all rows before the block, then those with the
    /// block's own rows up to itself. Says which were taken; one that is as good as a sum of rows before is not.
    pub(super) fn append(&mut self, block: &mut [Vec<f64>; BLOCK], many: usize) -> [bool; BLOCK] {
        let before = self.len;
        for j in 0..before {
            let row = self.row(j);
            let (row, diagonal) = (&row[..j], row[j]);
            let dots = dots(row, block);
            for (new, dot) in block.iter_mut().zip(dots) {
                new[j] = (new[j] - dot) / diagonal;
            }
        }
        let mut taken = [false; BLOCK];
        let mut kept: Vec<usize> = Vec::new();
        for b in 0..many {
            let diagonal = block[b][before + b];
            let mut row = block[b][..before].to_vec();
            for (place, &earlier) in kept.iter().enumerate() {
                let other = self.row(before + place);
                let entry = block[b][before + earlier] - dot(&other[..row.len()], &row);
                row.push(entry / other[before + place]);
            }
            let pivot = diagonal - dot(&row, &row);
            // Also if it is not a number.
            if pivot > DEPENDENT * diagonal {
                row.push(pivot.sqrt());
                self.rows.extend(row);
                self.len += 1;
                kept.push(b);
                taken[b] = true;
            }
        }
        taken
    }

    /// The solution for one right-hand side.
    pub(super) fn solve(&self, mut right: Vec<f64>) -> Vec<f64> {
        for i in 0..self.len {
            let row = self.row(i);
            right[i] = (right[i] - dot(&row[..i], &right[..i])) / row[i];
        }
        for i in (0..self.len).rev() {
            let row = self.row(i);
            let value = right[i] / row[i];
            right[i] = value;
            right[..i].iter_mut().zip(row).for_each(|(other, entry)| *other -= value * entry);
        }
        right
    }

    fn row(&self, i: usize) -> &[f64] {
        let start = i * (i + 1) / 2;
        &self.rows[start..=start + i]
    }
}

/// Sums of fixed lanes, in a fixed order: fast, and the same on every machine.
const LANES: usize = 4;

fn dot(a: &[f64], b: &[f64]) -> f64 {
    let b = &b[..a.len()];
    let mut lanes = [0.0; LANES];
    let (chunks, rest) = a.as_chunks::<LANES>();
    let (others, other_rest) = b.as_chunks::<LANES>();
    for (a, b) in chunks.iter().zip(others) {
        (0..LANES).for_each(|k| lanes[k] += a[k] * b[k]);
    }
    sum(lanes) + rest.iter().zip(other_rest).fold(0.0, |sum, (a, b)| sum + a * b)
}

fn dots(a: &[f64], block: &[Vec<f64>; BLOCK]) -> [f64; BLOCK] {
    let rows = block.each_ref().map(|row| &row[..a.len()]);
    let mut lanes = [[0.0; LANES]; BLOCK];
    let (chunks, rest) = a.as_chunks::<LANES>();
    for (at, a) in chunks.iter().enumerate() {
        for (lanes, row) in lanes.iter_mut().zip(rows) {
            let b = &row[LANES * at..LANES * at + LANES];
            (0..LANES).for_each(|k| lanes[k] += a[k] * b[k]);
        }
    }
    let start = LANES * chunks.len();
    let mut dots = lanes.map(sum);
    for (dot, row) in dots.iter_mut().zip(rows) {
        *dot += rest.iter().zip(&row[start..]).fold(0.0, |sum, (a, b)| sum + a * b);
    }
    dots
}

fn sum(lanes: [f64; LANES]) -> f64 {
    (lanes[0] + lanes[1]) + (lanes[2] + lanes[3])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of the matrix `min(i, j) + 1`, whose factor is ones and whose inverse has second differences, with one row twice.
    #[test]
    fn rows_are_appended_and_those_that_depend_on_others_are_not() {
        let mut factor = Cholesky::default();
        let mut taken = Vec::new();
        let levels = [1.0, 2.0, 3.0, 3.0, 4.0, 5.0, 6.0];
        for block in levels.chunks(BLOCK) {
            let known: Vec<f64> = taken.clone();
            let mut rows: [Vec<f64>; BLOCK] = std::array::from_fn(|b| {
                let level = block.get(b).copied().unwrap_or(0.0);
                known
                    .iter()
                    .chain(&block[..(b + 1).min(block.len())])
                    .map(|&other: &f64| other.min(level))
                    .collect()
            });
            for row in &mut rows {
                row.resize(known.len() + BLOCK, 0.0);
            }
            let is_taken = factor.append(&mut rows, block.len());
            taken.extend(block.iter().zip(is_taken).filter(|(_, taken)| *taken).map(|(level, _)| *level));
        }
        assert_eq!(taken, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        assert_eq!(factor.len(), 6);
        let right = vec![1.0, 2.0, 3.0, 4.0, 5.0, 5.0];
        let found = factor.solve(right.clone());
        for (i, value) in right.iter().enumerate() {
            let product: f64 = (0..6).map(|j| (i.min(j) + 1) as f64 * found[j]).sum();
            assert!((product - value).abs() < 1e-12, "{i}: {product}");
        }
    }
}
