//! VTK's XML files: `.vtu`, unstructured grids, and `.vts`, curvilinear ones.
//!
//! Numbers stand in the file as text, as base64, or in an appended block that is raw or base64; either may be compressed by zlib
//! (*VTK File Formats*, Kitware; the layout of compressed blocks is that of `vtkXMLDataReader`). Appended raw bytes are no XML, so the
//! text is read up to there.

mod payload;

use std::borrow::Cow;

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

use crate::arrays::{Named, choose};
use crate::error::{Problem, shortened};
use crate::grid::{Builder, Grid};
use crate::numbers::{NumberKind, Numbers, triples};
use payload::{Layout, Payload};

/// A number array of the file.
#[derive(Clone)]
struct DataArray<'a> {
    line: usize,
    name: String,
    /// The type as it is called; only what is read must be one that is known.
    kind: String,
    payload: Option<Payload<'a>>,
}

/// A part of the grid, with points of its own.
#[derive(Default)]
struct Piece<'a> {
    line: usize,
    points_claimed: Option<u64>,
    cells_claimed: Option<u64>,
    extent: Option<[i64; 6]>,
    points: Option<DataArray<'a>>,
    on_points: Vec<Named<DataArray<'a>>>,
    on_cells: Vec<String>,
    of_cells: Vec<DataArray<'a>>,
}

/// Reads a grid.
///
/// # Errors
/// The first thing that is wrong, with its line.
pub(crate) fn read(bytes: &[u8], array: Option<&str>, limit: u64) -> Result<Grid, Problem> {
    let file = File::parse(bytes)?;
    let (mut points, mut values, mut firsts) = (Vec::new(), Vec::new(), Vec::new());
    for piece in &file.pieces {
        firsts.push(points.len() as u64);
        let count = piece.points(file.is_structured)?;
        if count == 0 {
            continue;
        }
        let of = piece.points.as_ref().ok_or_else(|| Problem::line(piece.line, "the piece has no Points"))?;
        points.extend(triples(&file.real(of, count.saturating_mul(3), limit)?));
        let chosen = choose(array, &piece.on_points, &piece.on_cells)?;
        values.extend(file.real(&chosen.data, count, limit)?);
    }
    if file.pieces.is_empty() {
        return Err(Problem::Whole("the file has no Piece, so no points".to_owned()));
    }
    if points.is_empty() {
        return Err(Problem::Whole("the file has no points".to_owned()));
    }
    let mut builder = Builder::new(points, values, limit)?;
    let mut number = 0;
    for (piece, first) in file.pieces.iter().zip(firsts) {
        match file.is_structured {
            true => builder.block(first, piece.counts()?)?,
            false => file.cells(piece, first, &mut number, &mut builder, limit)?,
        }
    }
    Ok(builder.finish())
}

impl Piece<'_> {
    /// How many points it says that it has.
    fn points(&self, is_structured: bool) -> Result<u64, Problem> {
        if !is_structured {
            let claimed = self.points_claimed;
            return claimed.ok_or_else(|| Problem::line(self.line, "the piece has no NumberOfPoints"));
        }
        let product = self.counts()?.into_iter().try_fold(1u64, u64::checked_mul);
        product.ok_or_else(|| Problem::line(self.line, "more points than can be counted"))
    }

    /// How many points lie along each axis of a curvilinear grid.
    fn counts(&self) -> Result<[u64; 3], Problem> {
        let of = self.extent.ok_or_else(|| Problem::line(self.line, "the piece has no Extent"))?;
        let count = |axis: usize| {
            let along = of[2 * axis + 1].checked_sub(of[2 * axis])?.checked_add(1)?;
            u64::try_from(along).ok()
        };
        let counts = [count(0), count(1), count(2)];
        match counts {
            [Some(x), Some(y), Some(z)] => Ok([x, y, z]),
            _ => Err(Problem::line(self.line, format!("Extent {of:?} has no points"))),
        }
    }
}

/// The whole file, its numbers not yet read.
struct File<'a> {
    is_structured: bool,
    layout: Layout<'a>,
    pieces: Vec<Piece<'a>>,
}

/// The array whose element is open.
struct Open<'a> {
    array: DataArray<'a>,
    components: usize,
    /// How deep elements are open in it: VTK writes keys there.
    depth: usize,
}

impl<'a> Open<'a> {
    /// Keeps the text that its numbers are in.
    fn take_in(&mut self, text: Cow<'a, str>) -> Result<(), Problem> {
        let (Some(Payload::Words(kept) | Payload::Base64(kept)), 0) = (&mut self.array.payload, self.depth)
        else {
            return Ok(());
        };
        let Cow::Borrowed(text) = text else { return Ok(()) };
        if text.trim_ascii().is_empty() {
            return Ok(());
        }
        if !kept.is_empty() {
            return Err(damaged(&self.array, "its numbers are in several parts"));
        }
        *kept = text.trim_ascii().as_bytes();
        Ok(())
    }
}

/// The lines of places that come in order.
struct Lines<'a> {
    text: &'a [u8],
    at: usize,
    line: usize,
}

impl Lines<'_> {
    fn at(&mut self, place: u64) -> usize {
        let place = (place as usize).min(self.text.len());
        if place > self.at {
            self.line += self.text[self.at..place].iter().filter(|&&byte| byte == b'\n').count();
            self.at = place;
        }
        self.line
    }
}

/// Where the parser is.
#[derive(Clone, Copy, PartialEq)]
enum Section {
    None,
    PointData,
    CellData,
    Points,
    Cells,
}

impl<'a> File<'a> {
    fn parse(bytes: &'a [u8]) -> Result<Self, Problem> {
        let (head, appended) = payload::split(bytes)?;
        let mut reader = Reader::from_str(head);
        let mut lines = Lines { text: head.as_bytes(), at: 0, line: 1 };
        let mut file = Self { is_structured: false, layout: Layout::default(), pieces: Vec::new() };
        let (mut has_root, mut section) = (false, Section::None);
        let mut open: Option<Open<'a>> = None;
        loop {
            let line = lines.at(reader.buffer_position());
            let event = reader.read_event();
            let event = event.map_err(|error| {
                let line = lines.at(reader.error_position());
                let error: String = error.to_string().chars().take(200).collect();
                Problem::line(line, format!("this is no XML: {error}"))
            })?;
            let (tag, is_empty) = match event {
                Event::Eof => break,
                Event::Start(tag) => (tag, false),
                Event::Empty(tag) => (tag, true),
                Event::Text(text) => {
                    if let Some(open) = &mut open {
                        open.take_in(text.into_inner())?;
                    }
                    continue;
                }
                Event::End(_) => {
                    match &mut open {
                        Some(open) if open.depth > 0 => open.depth -= 1,
                        _ => open
                            .take()
                            .into_iter()
                            .for_each(|open| file.keep(open.array, open.components, section)),
                    }
                    continue;
                }
                _ => continue,
            };
            if let Some(open) = &mut open {
                open.depth += usize::from(!is_empty);
                continue;
            }
            match tag.local_name().as_ref() {
                "VTKFile" if !has_root => {
                    has_root = true;
                    file.is_structured = file.layout.of_root(&tag, line)?;
                }
                other if !has_root => {
                    let other = shortened(other);
                    return Err(Problem::line(
                        line,
                        format!("the file begins with <{other}>, not <VTKFile>"),
                    ));
                }
                "Piece" => file.pieces.push(piece(&tag, line)?),
                "PointData" => section = Section::PointData,
                "CellData" => section = Section::CellData,
                "Points" => section = Section::Points,
                "Cells" => section = Section::Cells,
                "FieldData" => section = Section::None,
                "DataArray" | "Array" => {
                    let (array, components) = data_array(&tag, line)?;
                    match is_empty {
                        true => file.keep(array, components, section),
                        false => open = Some(Open { array, components, depth: 0 }),
                    }
                }
                "AppendedData" => {
                    file.layout.of_appended(&tag, line, appended)?;
                    break;
                }
                _ => {}
            }
        }
        if let Some(open) = &open {
            return Err(damaged(&open.array, "the file ends within it"));
        }
        if !has_root {
            return Err(Problem::line(1, "the file has no <VTKFile>"));
        }
        Ok(file)
    }

    /// Puts an array where it belongs.
    fn keep(&mut self, array: DataArray<'a>, components: usize, section: Section) {
        let Some(piece) = self.pieces.last_mut() else { return };
        match section {
            Section::PointData => {
                piece.on_points.push(Named { name: array.name.clone(), components, data: array });
            }
            Section::CellData => piece.on_cells.push(array.name),
            Section::Points => piece.points = Some(array),
            Section::Cells => piece.of_cells.push(array),
            Section::None => {}
        }
    }

    /// The numbers of an array, exactly so many.
    fn real(&self, array: &DataArray<'a>, count: u64, limit: u64) -> Result<Vec<f64>, Problem> {
        Ok(self.numbers(array, count, limit)?.into_real())
    }

    fn whole(&self, array: &DataArray<'a>, count: u64, limit: u64) -> Result<Vec<i64>, Problem> {
        let whole = self.numbers(array, count, limit)?.into_whole();
        whole.ok_or_else(|| damaged(array, "its numbers must be whole"))
    }

    fn numbers(&self, array: &DataArray<'a>, count: u64, limit: u64) -> Result<Numbers, Problem> {
        let kind = match array.kind.as_str() {
            "Int8" => NumberKind::I8,
            "UInt8" => NumberKind::U8,
            "Int16" => NumberKind::I16,
            "UInt16" => NumberKind::U16,
            "Int32" => NumberKind::I32,
            "UInt32" => NumberKind::U32,
            "Int64" => NumberKind::I64,
            "UInt64" => NumberKind::U64,
            "Float32" => NumberKind::F32,
            "Float64" => NumberKind::F64,
            other => {
                let reason =
                    format!("the type `{}` is none of Int8 to UInt64, Float32 and Float64", shortened(other));
                return Err(damaged(array, reason));
            }
        };
        let payload = array
            .payload
            .as_ref()
            .ok_or_else(|| damaged(array, "its format is none of ascii, binary and appended"))?;
        self.layout.numbers(payload, kind, count, limit).map_err(|reason| damaged(array, reason))
    }

    /// Adds the cells of a piece whose points begin at `first`.
    fn cells(
        &self,
        piece: &Piece<'a>,
        first: u64,
        number: &mut usize,
        builder: &mut Builder,
        limit: u64,
    ) -> Result<(), Problem> {
        let claimed = piece.cells_claimed;
        let claimed = claimed.ok_or_else(|| Problem::line(piece.line, "the piece has no NumberOfCells"))?;
        if claimed == 0 {
            return Ok(());
        }
        let array = |name: &str| {
            let found = piece.of_cells.iter().find(|array| array.name == name);
            found.ok_or_else(|| {
                Problem::line(piece.line, format!("the cells of the piece have no array `{name}`"))
            })
        };
        let (types, of_offsets, of_connectivity) =
            (array("types")?, array("offsets")?, array("connectivity")?);
        let types = self.whole(types, claimed, limit)?;
        let offsets = self.whole(of_offsets, claimed, limit)?;
        let end = offsets.last().copied().and_then(|end| u64::try_from(end).ok());
        let end = end.ok_or_else(|| damaged(of_offsets, "its last number is negative"))?;
        let connectivity = self.whole(of_connectivity, end, limit)?;
        let points = piece.points(false)?;
        let mut from = 0;
        for (&kind, &to) in types.iter().zip(&offsets) {
            let of = usize::try_from(to).ok().and_then(|to| connectivity.get(from..to));
            let of = of.ok_or_else(|| {
                Problem::cell(
                    *number,
                    format!(
                        "its points end at {to} in `connectivity`, and begin at {from} of {}",
                        connectivity.len()
                    ),
                )
            })?;
            from = to as usize;
            builder.vtk_cell(*number, kind, of, first, points)?;
            *number += 1;
        }
        Ok(())
    }
}

fn damaged(array: &DataArray<'_>, reason: impl Into<String>) -> Problem {
    Problem::Array { line: array.line, name: shortened(&array.name), reason: reason.into() }
}

/// The value of an attribute.
fn attribute(tag: &BytesStart<'_>, name: &str) -> Option<String> {
    let found = tag.attributes().flatten().find(|found| found.key.as_ref() == name)?;
    quick_xml::escape::unescape(&found.value).ok().map(Cow::into_owned)
}

/// An attribute that is a whole number, if it is there.
fn count(tag: &BytesStart<'_>, name: &str, line: usize) -> Result<Option<u64>, Problem> {
    let Some(text) = attribute(tag, name) else { return Ok(None) };
    let number = text.trim().parse().ok();
    number
        .map(Some)
        .ok_or_else(|| Problem::line(line, format!("{name}=\"{}\" is no count", shortened(&text))))
}

fn piece<'a>(tag: &BytesStart<'_>, line: usize) -> Result<Piece<'a>, Problem> {
    let extent = match attribute(tag, "Extent") {
        None => None,
        Some(text) => {
            let numbers: Option<Vec<i64>> = text.split_whitespace().map(|word| word.parse().ok()).collect();
            let extent = numbers.and_then(|numbers| <[i64; 6]>::try_from(numbers).ok());
            let extent = extent.ok_or_else(|| {
                Problem::line(line, format!("Extent=\"{}\" is not six whole numbers", shortened(&text)))
            })?;
            Some(extent)
        }
    };
    let (points_claimed, cells_claimed) =
        (count(tag, "NumberOfPoints", line)?, count(tag, "NumberOfCells", line)?);
    Ok(Piece { line, points_claimed, cells_claimed, extent, ..Piece::default() })
}

/// An array as its tag describes it, and its numbers per point or cell.
fn data_array<'a>(tag: &BytesStart<'_>, line: usize) -> Result<(DataArray<'a>, usize), Problem> {
    let name = attribute(tag, "Name").unwrap_or_default();
    let components = count(tag, "NumberOfComponents", line)?.unwrap_or(1);
    let payload = match attribute(tag, "format").as_deref() {
        Some("ascii") => Some(Payload::Words(&[])),
        Some("binary") => Some(Payload::Base64(&[])),
        Some("appended") => {
            let offset = count(tag, "offset", line)?;
            let offset = offset.ok_or_else(|| {
                Problem::line(line, format!("the appended array `{}` has no offset", shortened(&name)))
            })?;
            Some(Payload::Appended(offset))
        }
        _ => None,
    };
    let kind = attribute(tag, "type").unwrap_or_default();
    Ok((DataArray { line, name, kind, payload }, components as usize))
}
