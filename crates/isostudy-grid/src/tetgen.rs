//! TetGen's files: points with attributes in `.node`, tetrahedra in `.ele` beside it (Si, *TetGen 1.5*, section 5.2).

use crate::arrays::{Named, choose};
use crate::cells::CellKind;
use crate::error::{Problem, shortened};
use crate::grid::{Builder, Grid};
use crate::numbers::{real, whole, words};

/// Points and their values, from a `.node` file.
pub(crate) struct Nodes {
    points: Vec<[f64; 3]>,
    values: Vec<f64>,
    /// The number of the first point, 0 or 1.
    first: i64,
}

/// Reads points, with the attribute that is asked for: they are called 1, 2 and so on.
///
/// # Errors
/// The first thing that is wrong, with its line.
pub(crate) fn nodes(bytes: &[u8], array: Option<&str>) -> Result<Nodes, Problem> {
    let mut lines = Lines { bytes, line: 0 };
    let (line, head) = lines.next().ok_or_else(|| Problem::Whole("the file has no points".to_owned()))?;
    let head = counts(line, &head, "points, dimension, attributes and markers")?;
    let [count, dimension, attributes, markers] = [0, 1, 2, 3].map(|i| head.get(i).copied());
    let count = count.unwrap_or(0);
    if dimension.is_some_and(|dimension| dimension != 3) {
        return Err(Problem::line(line, "the dimension must be 3"));
    }
    let (attributes, markers) = (attributes.unwrap_or(0), markers.unwrap_or(0));
    let attributes = usize::try_from(attributes).ok().filter(|&count| count <= 1000);
    let attributes = attributes.ok_or_else(|| Problem::line(line, "there may be at most 1000 attributes"))?;
    let names =
        (1..=attributes).map(|number| Named { name: number.to_string(), components: 1, data: number - 1 });
    let names: Vec<_> = names.collect();
    let chosen = choose(array, &names, &[])?.data;
    let mut nodes = Nodes { points: Vec::new(), values: Vec::new(), first: 0 };
    let wanted = 4 + attributes + usize::from(markers > 0);
    for number in 0..count {
        let (line, words) = lines.next().ok_or_else(|| ends(number, count, "points"))?;
        if words.len() != wanted && words.len() != wanted - usize::from(markers > 0) {
            let got = words.len();
            return Err(Problem::line(line, format!("a point has {wanted} numbers here, not {got}")));
        }
        let index = index(line, words[0])?;
        if number == 0 {
            if index != 0 && index != 1 {
                return Err(Problem::line(
                    line,
                    format!("the first point has number {index}, neither 0 nor 1"),
                ));
            }
            nodes.first = index;
        }
        in_order(line, index, nodes.first + number as i64)?;
        let at = |i: usize| number_at(line, words[i]);
        nodes.points.push([at(1)?, at(2)?, at(3)?]);
        nodes.values.push(at(4 + chosen)?);
    }
    match lines.next() {
        Some((line, _)) => {
            Err(Problem::line(line, format!("there is more than the {count} points that line 1 claims")))
        }
        None => Ok(nodes),
    }
}

/// Reads the tetrahedra between points.
///
/// # Errors
/// The first thing that is wrong, with its line or its cell.
pub(crate) fn elements(bytes: &[u8], nodes: Nodes, limit: u64) -> Result<Grid, Problem> {
    let mut lines = Lines { bytes, line: 0 };
    let (line, head) = lines.next().ok_or_else(|| Problem::Whole("the file has no tetrahedra".to_owned()))?;
    let head = counts(line, &head, "tetrahedra, points of each and attributes")?;
    let (count, of_each, attributes) =
        (head[0], head.get(1).copied().unwrap_or(4), head.get(2).copied().unwrap_or(0));
    if of_each != 4 {
        return Err(Problem::line(
            line,
            format!(
                "tetrahedra of {of_each} points are not taken, those of 4 are; tetgen without -o2 makes them"
            ),
        ));
    }
    let Nodes { points, values, first } = nodes;
    let mut builder = Builder::new(points, values, limit)?;
    for number in 0..count {
        let (line, words) = lines.next().ok_or_else(|| ends(number, count, "tetrahedra"))?;
        if words.len() as u64 != 5 + attributes {
            let (wanted, got) = (5 + attributes, words.len());
            return Err(Problem::line(line, format!("a tetrahedron has {wanted} numbers here, not {got}")));
        }
        in_order(line, index(line, words[0])?, first + number as i64)?;
        let mut of = [0; 4];
        for (point, word) in of.iter_mut().zip(&words[1..5]) {
            let named = index(line, word)?;
            let there = builder.points() as i64;
            *point =
                named.checked_sub(first).filter(|point| (0..there).contains(point)).ok_or_else(|| {
                    let last = there + first - 1;
                    Problem::line(line, format!("names point {named}, and the points are {first} to {last}"))
                })?;
        }
        builder.cell(number as usize, CellKind::Tetrahedron, of)?;
    }
    match lines.next() {
        Some((line, _)) => {
            Err(Problem::line(line, format!("there is more than the {count} tetrahedra that line 1 claims")))
        }
        None => Ok(builder.finish()),
    }
}

/// The whole numbers at the top, at least one.
fn counts(line: usize, words: &[&[u8]], what: &str) -> Result<Vec<u64>, Problem> {
    let numbers: Option<Vec<u64>> =
        words.iter().map(|word| whole(word).and_then(|number| u64::try_from(number).ok())).collect();
    // A count beyond this could not be a point's number.
    let numbers = numbers.filter(|numbers| numbers.iter().all(|&number| number <= 1 << 40));
    numbers.ok_or_else(|| Problem::line(line, format!("must be counts: {what}")))
}

fn in_order(line: usize, index: i64, wanted: i64) -> Result<(), Problem> {
    match index == wanted {
        true => Ok(()),
        false => Err(Problem::line(line, format!("number {wanted} must be here, not {index}"))),
    }
}

fn index(line: usize, word: &[u8]) -> Result<i64, Problem> {
    whole(word).ok_or_else(|| Problem::line(line, format!("`{}` is no whole number", shown(word))))
}

fn number_at(line: usize, word: &[u8]) -> Result<f64, Problem> {
    real(word).ok_or_else(|| Problem::line(line, format!("`{}` is no number", shown(word))))
}

fn ends(got: u64, wanted: u64, what: &str) -> Problem {
    Problem::Whole(format!("the file ends after {got} of {wanted} {what}"))
}

fn shown(word: &[u8]) -> String {
    shortened(&String::from_utf8_lossy(word))
}

/// The words of lines, without comments and empty lines.
struct Lines<'a> {
    bytes: &'a [u8],
    line: usize,
}

impl<'a> Lines<'a> {
    fn next(&mut self) -> Option<(usize, Vec<&'a [u8]>)> {
        while !self.bytes.is_empty() {
            let end = self.bytes.iter().position(|&byte| byte == b'\n').unwrap_or(self.bytes.len());
            let text = &self.bytes[..end];
            self.bytes = self.bytes.get(end + 1..).unwrap_or_default();
            self.line += 1;
            let comment = text.iter().position(|&byte| byte == b'#').unwrap_or(text.len());
            let words: Vec<_> = words(&text[..comment]).collect();
            if !words.is_empty() {
                return Some((self.line, words));
            }
        }
        None
    }
}
