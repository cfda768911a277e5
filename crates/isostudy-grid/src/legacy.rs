//! VTK's legacy files, `.vtk`: unstructured and curvilinear grids, as text or big-endian bytes (*VTK File Formats*, Kitware).

mod scan;

use crate::arrays::{Named, choose};
use crate::error::{Problem, shortened};
use crate::grid::{Builder, Grid};
use crate::numbers::triples;
use scan::{Block, Scan};

/// What has been read up to a keyword.
#[derive(Default)]
struct File {
    kind: Option<Dataset>,
    dimensions: Option<[u64; 3]>,
    points: Option<Block>,
    cells: Option<Cells>,
    types: Option<Block>,
    on_points: Vec<Named<Block>>,
    on_cells: Vec<String>,
}

#[derive(Clone, Copy, PartialEq)]
enum Dataset {
    Unstructured,
    Structured,
}

/// How a file lists the points of its cells.
enum Cells {
    /// Each cell has its number of points before them.
    Counted { cells: u64, list: Block },
    /// Where each cell begins in the list of points; one more for the end. Since version 5.
    Offsets { offsets: Block, connectivity: Block },
}

/// What following arrays are on.
#[derive(Clone, Copy, PartialEq)]
enum On {
    Nothing,
    Points(u64),
    Cells(u64),
}

/// Reads a grid.
///
/// # Errors
/// The first thing that is wrong, with its line.
pub(crate) fn read(bytes: &[u8], array: Option<&str>, limit: u64) -> Result<Grid, Problem> {
    let mut scan = Scan::begin(bytes)?;
    let file = File::scan(&mut scan)?;
    let kind = file.kind.ok_or_else(|| Problem::Whole("the file has no DATASET".to_owned()))?;
    let lacks = |what: &str| Problem::Whole(format!("the file has no {what}"));
    let points = file.points.as_ref().ok_or_else(|| lacks("POINTS"))?;
    let count = points.count / 3;
    if count == 0 {
        return Err(lacks("points"));
    }
    let chosen = choose(array, &file.on_points, &file.on_cells)?;
    if chosen.data.count != count {
        let (line, name, got) = (chosen.data.line, shortened(&chosen.name), chosen.data.count);
        return Err(Problem::Array {
            line,
            name,
            reason: format!("it has {got} numbers, and must have {count}"),
        });
    }
    let values = scan.real(&chosen.data)?;
    let mut builder = Builder::new(triples(&scan.real(points)?), values, limit)?;
    match kind {
        Dataset::Structured => {
            let counts = file.dimensions.ok_or_else(|| lacks("DIMENSIONS"))?;
            let product = counts.into_iter().try_fold(1u64, u64::checked_mul);
            if product != Some(count) {
                return Err(Problem::Whole(format!("DIMENSIONS {counts:?} do not go with {count} points")));
            }
            builder.block(0, counts)?;
        }
        Dataset::Unstructured => {
            let cells = file.cells.as_ref().ok_or_else(|| lacks("CELLS"))?;
            let types = file.types.as_ref().ok_or_else(|| lacks("CELL_TYPES"))?;
            cells.add_to(&mut builder, &scan, types)?;
        }
    }
    Ok(builder.finish())
}

impl File {
    /// Finds all arrays. Their numbers are read later, and only where they are wanted.
    fn scan(scan: &mut Scan<'_>) -> Result<Self, Problem> {
        let mut file = Self::default();
        let mut on = On::Nothing;
        while let Some((line, words)) = scan.line()? {
            let keyword = words[0].to_ascii_uppercase();
            if file.kind.is_none() && keyword != "DATASET" && keyword != "FIELD" {
                return Err(Problem::line(
                    line,
                    format!("`{}` is here, and DATASET must be", shortened(&words[0])),
                ));
            }
            match keyword.as_str() {
                "DATASET" => file.kind = Some(dataset(line, words.get(1))?),
                "DIMENSIONS" => {
                    let counts = scan::counts::<3>(line, &words)?;
                    file.dimensions = Some(counts);
                }
                "POINTS" => {
                    let [count] = scan::counts::<1>(line, &words)?;
                    let kind = scan::kind(line, words.get(2))?;
                    file.points = Some(scan.block(line, "POINTS", kind, scan::times(line, count, 3)?)?);
                }
                "CELLS" => file.cells = Some(Cells::scan(scan, line, &words)?),
                "CELL_TYPES" => {
                    let [count] = scan::counts::<1>(line, &words)?;
                    file.types = Some(scan.block(line, "CELL_TYPES", scan::int(), count)?);
                }
                "POINT_DATA" => on = On::Points(scan::counts::<1>(line, &words)?[0]),
                "CELL_DATA" => on = On::Cells(scan::counts::<1>(line, &words)?[0]),
                "METADATA" => scan.pass_over_metadata(),
                "FIELD" => {
                    let count = scan::count(line, words.get(2))?;
                    for _ in 0..count {
                        file.field(scan, on)?;
                    }
                }
                _ => file.attribute(scan, line, &keyword, &words, on)?,
            }
        }
        Ok(file)
    }

    /// An array of a field: its name, and its size.
    fn field(&mut self, scan: &mut Scan<'_>, on: On) -> Result<(), Problem> {
        let mut next = scan.line()?;
        // What describes the array before may stand between.
        while next.as_ref().is_some_and(|(_, words)| words[0].eq_ignore_ascii_case("METADATA")) {
            scan.pass_over_metadata();
            next = scan.line()?;
        }
        let (line, words) = next.ok_or_else(|| Problem::Whole("the file ends within a FIELD".to_owned()))?;
        let [components, tuples] = scan::counts::<2>(line, &words)?;
        let name = scan::decoded(&words[0]);
        let count = scan::times(line, components, tuples)?;
        let of_type = words.get(3).map(String::as_str).unwrap_or_default();
        if of_type.eq_ignore_ascii_case("string") || of_type.eq_ignore_ascii_case("bit") {
            return scan.pass_over(line, &name, of_type, count);
        }
        let block = scan.block(line, &name, scan::kind(line, words.get(3))?, count)?;
        self.keep(name, components, block, on);
        Ok(())
    }

    /// An array with a keyword of its own.
    fn attribute(
        &mut self,
        scan: &mut Scan<'_>,
        line: usize,
        keyword: &str,
        words: &[String],
        on: On,
    ) -> Result<(), Problem> {
        let name = || scan::decoded(words.get(1).map(String::as_str).unwrap_or_default());
        let tuples = match on {
            On::Points(count) | On::Cells(count) => count,
            On::Nothing => 0,
        };
        let (kind, components) = match keyword {
            "SCALARS" => {
                let components = match words.get(3) {
                    Some(_) => scan::count(line, words.get(3))?,
                    None => 1,
                };
                let kind = scan::kind(line, words.get(2))?;
                scan.pass_over_table_name()?;
                (kind, components)
            }
            "VECTORS" | "NORMALS" => (scan::kind(line, words.get(2))?, 3),
            "TENSORS" => (scan::kind(line, words.get(2))?, 9),
            "TENSORS6" => (scan::kind(line, words.get(2))?, 6),
            "TEXTURE_COORDINATES" => (scan::kind(line, words.get(3))?, scan::count(line, words.get(2))?),
            "GLOBAL_IDS" | "PEDIGREE_IDS" | "EDGE_FLAGS" => (scan::kind(line, words.get(2))?, 1),
            "COLOR_SCALARS" => (scan.kind_of_colours(), scan::count(line, words.get(2))?),
            "LOOKUP_TABLE" => {
                let count = scan::times(line, scan::count(line, words.get(2))?, 4)?;
                return scan.block(line, "LOOKUP_TABLE", scan.kind_of_colours(), count).map(|_| ());
            }
            _ => {
                let keyword = shortened(keyword);
                return Err(Problem::line(line, format!("`{keyword}` is no keyword of a grid with values")));
            }
        };
        let block = scan.block(line, &name(), kind, scan::times(line, components, tuples)?)?;
        self.keep(name(), components, block, on);
        Ok(())
    }

    fn keep(&mut self, name: String, components: u64, block: Block, on: On) {
        match on {
            On::Points(_) => {
                let components = usize::try_from(components).unwrap_or(usize::MAX);
                self.on_points.push(Named { name, components, data: block });
            }
            On::Cells(_) => self.on_cells.push(name),
            // Of the grid as a whole, such as its time.
            On::Nothing => {}
        }
    }
}

fn dataset(line: usize, word: Option<&String>) -> Result<Dataset, Problem> {
    let word = word.map(|word| word.to_ascii_uppercase()).unwrap_or_default();
    match word.as_str() {
        "UNSTRUCTURED_GRID" => Ok(Dataset::Unstructured),
        "STRUCTURED_GRID" => Ok(Dataset::Structured),
        other => {
            let other = shortened(other);
            Err(Problem::line(
                line,
                format!("DATASET {other} is not supported; UNSTRUCTURED_GRID and STRUCTURED_GRID are"),
            ))
        }
    }
}

impl Cells {
    fn scan(scan: &mut Scan<'_>, line: usize, words: &[String]) -> Result<Self, Problem> {
        let [first, second] = scan::counts::<2>(line, words)?;
        if !scan.has_offsets() {
            return Ok(Self::Counted { cells: first, list: scan.block(line, "CELLS", scan::int(), second)? });
        }
        let mut part = |keyword: &str, count: u64| -> Result<Block, Problem> {
            let next = scan.line()?;
            match next {
                Some((line, words)) if words[0].eq_ignore_ascii_case(keyword) => {
                    scan.block(line, keyword, scan::kind(line, words.get(1))?, count)
                }
                Some((line, words)) => Err(Problem::line(
                    line,
                    format!("`{}` is here, and {keyword} must be", shortened(&words[0])),
                )),
                None => Err(Problem::Whole(format!("the file ends before {keyword}"))),
            }
        };
        Ok(Self::Offsets { offsets: part("OFFSETS", first)?, connectivity: part("CONNECTIVITY", second)? })
    }

    /// Adds all cells.
    fn add_to(&self, builder: &mut Builder, scan: &Scan<'_>, types: &Block) -> Result<(), Problem> {
        let there = builder.points() as u64;
        let cells = match self {
            Self::Counted { cells, .. } => *cells,
            Self::Offsets { offsets, .. } => offsets.count.saturating_sub(1),
        };
        if types.count != cells {
            let line = types.line;
            return Err(Problem::line(line, format!("there are {} types for {cells} cells", types.count)));
        }
        let types = scan.whole(types)?;
        match self {
            Self::Counted { list, .. } => {
                let list = scan.whole(list)?;
                let mut rest = list.as_slice();
                for (number, &kind) in types.iter().enumerate() {
                    let of = rest
                        .split_first()
                        .and_then(|(&count, after)| after.split_at_checked(usize::try_from(count).ok()?));
                    let (of, after) = of.ok_or_else(|| {
                        Problem::cell(number, "the list of CELLS ends before its points".to_owned())
                    })?;
                    builder.vtk_cell(number, kind, of, 0, there)?;
                    rest = after;
                }
                if !rest.is_empty() {
                    let over = rest.len();
                    return Err(Problem::Whole(format!(
                        "CELLS has {over} numbers more than its {cells} cells"
                    )));
                }
            }
            Self::Offsets { offsets, connectivity } => {
                let (offsets, connectivity) = (scan.whole(offsets)?, scan.whole(connectivity)?);
                for (number, (pair, &kind)) in offsets.windows(2).zip(&types).enumerate() {
                    let range = usize::try_from(pair[0]).ok().zip(usize::try_from(pair[1]).ok());
                    let of = range.and_then(|(from, to)| connectivity.get(from..to));
                    let of = of.ok_or_else(|| {
                        let (from, to, there) = (pair[0], pair[1], connectivity.len());
                        Problem::cell(
                            number,
                            format!("its points are {from} to {to} of the {there} in CONNECTIVITY"),
                        )
                    })?;
                    builder.vtk_cell(number, kind, of, 0, there)?;
                }
            }
        }
        Ok(())
    }
}
