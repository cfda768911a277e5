//! The body: rows of values, in text or in either byte order.

use glam::Vec3;

use super::PlyError;
use super::header::{Element, Encoding, Header, Property, Scalar};
use crate::TriangleMesh;

const COORDINATES: [&str; 6] = ["x", "y", "z", "nx", "ny", "nz"];
const FACE_LISTS: [&str; 2] = ["vertex_indices", "vertex_index"];

pub(super) fn read(header: &Header, bytes: &[u8], start: usize) -> Result<TriangleMesh, PlyError> {
    let mut cursor = Cursor { bytes, at: start, encoding: header.encoding };
    let mut mesh = TriangleMesh::default();
    let mut faces = Faces::default();
    for element in &header.elements {
        match element.name.as_str() {
            "vertex" => read_vertices(element, &mut cursor, &mut mesh)?,
            "face" => read_faces(element, &mut cursor, &mut faces)?,
            _ => skip(element, &mut cursor)?,
        }
    }
    // Faces may come before the vertices they mean, so they are checked last.
    mesh.triangles = faces.into_triangles(mesh.positions.len())?;
    Ok(mesh)
}

fn read_vertices(element: &Element, cursor: &mut Cursor, mesh: &mut TriangleMesh) -> Result<(), PlyError> {
    let slots = element.properties.iter().map(coordinate).collect::<Vec<_>>();
    let has = |names: std::ops::Range<usize>| names.clone().all(|k| slots.contains(&Some(k)));
    if element.count > 0 && !has(0..3) {
        return Err(PlyError::Lacks { element: "vertex", what: "a scalar x, y or z" });
    }
    let with_normals = has(3..6);
    let rows = cursor.plausible_rows(element);
    mesh.positions.reserve(rows);
    mesh.normals.reserve(if with_normals { rows } else { 0 });
    for row in 0..element.count {
        let place = Place { element, row };
        let mut values = [0.0f32; 6];
        for (property, slot) in element.properties.iter().zip(&slots) {
            match *slot {
                Some(k) => {
                    let value = cursor.scalar(property.value, place)?;
                    values[k] = value as f32;
                    // Normals that are not used may be anything.
                    if !values[k].is_finite() && (k < 3 || with_normals) {
                        let (property, offset) = (COORDINATES[k], cursor.at);
                        return Err(PlyError::NotFinite { row, offset, property, value });
                    }
                }
                None => cursor.skip(property, place)?,
            }
        }
        mesh.positions.push(Vec3::from_slice(&values[..3]));
        if with_normals {
            mesh.normals.push(Vec3::from_slice(&values[3..]));
        }
    }
    Ok(())
}

fn coordinate(property: &Property) -> Option<usize> {
    COORDINATES.iter().position(|name| property.length.is_none() && property.name == *name)
}

/// Triangles with the row they come from, before the number of vertices is known.
#[derive(Default)]
struct Faces {
    /// Indices as written: every type fits a double exactly.
    triangles: Vec<[f64; 3]>,
    rows: Vec<u64>,
}

fn read_faces(element: &Element, cursor: &mut Cursor, faces: &mut Faces) -> Result<(), PlyError> {
    if element.count == 0 {
        return Ok(());
    }
    let is_list =
        |p: &Property| p.length.is_some() && p.value.is_integer() && FACE_LISTS.contains(&p.name.as_str());
    let list = element.properties.iter().position(is_list);
    let list = list.ok_or(PlyError::Lacks { element: "face", what: "an integer list vertex_indices" })?;
    let value = element.properties[list].value;
    for row in 0..element.count {
        let place = Place { element, row };
        for (i, property) in element.properties.iter().enumerate() {
            match property.length {
                Some(length) if i == list => {
                    let corners = cursor.list_length(length, place)?;
                    if corners < 3 {
                        let (corners, offset) = (corners as usize, cursor.at);
                        return Err(PlyError::FewCorners { row, offset, corners });
                    }
                    let first = cursor.scalar(value, place)?;
                    let mut previous = cursor.scalar(value, place)?;
                    for _ in 2..corners {
                        let next = cursor.scalar(value, place)?;
                        faces.triangles.push([first, previous, next]);
                        faces.rows.push(row);
                        previous = next;
                    }
                }
                _ => cursor.skip(property, place)?,
            }
        }
    }
    Ok(())
}

impl Faces {
    fn into_triangles(self, vertices: usize) -> Result<Vec<[u32; 3]>, PlyError> {
        for (triangle, &row) in self.triangles.iter().zip(&self.rows) {
            if let Some(&index) = triangle.iter().find(|&&v| v < 0.0 || v >= vertices as f64) {
                return Err(PlyError::IndexOutOfRange { row, index, vertices });
            }
        }
        Ok(self.triangles.into_iter().map(|t| t.map(|v| v as u32)).collect())
    }
}

fn skip(element: &Element, cursor: &mut Cursor) -> Result<(), PlyError> {
    // Rows without properties take no bytes: a lying count would spin for ever.
    if element.properties.is_empty() {
        return Ok(());
    }
    for row in 0..element.count {
        for property in &element.properties {
            cursor.skip(property, Place { element, row })?;
        }
    }
    Ok(())
}

#[derive(Clone, Copy)]
struct Place<'a> {
    element: &'a Element,
    row: u64,
}

struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
    encoding: Encoding,
}

impl Cursor<'_> {
    /// No more rows than the rest of the input can hold: in text a value takes two bytes.
    fn plausible_rows(&self, element: &Element) -> usize {
        let binary = |p: &Property| p.length.unwrap_or(p.value).size();
        let row_bytes: usize = match self.encoding {
            Encoding::Ascii => 2 * element.properties.len(),
            _ => element.properties.iter().map(binary).sum(),
        };
        let fit = (self.bytes.len() - self.at) / row_bytes.max(1);
        usize::try_from(element.count).unwrap_or(usize::MAX).min(fit + 1)
    }

    fn skip(&mut self, property: &Property, place: Place) -> Result<(), PlyError> {
        let values = match property.length {
            Some(length) => self.list_length(length, place)?,
            None => 1,
        };
        for _ in 0..values {
            self.scalar(property.value, place)?;
        }
        Ok(())
    }

    fn list_length(&mut self, kind: Scalar, place: Place) -> Result<u64, PlyError> {
        let length = self.scalar(kind, place)?;
        if length < 0.0 {
            let (element, row, offset) = (place.element.name.clone(), place.row, self.at);
            return Err(PlyError::ListLength { element, row, offset, length });
        }
        Ok(length as u64)
    }

    fn scalar(&mut self, kind: Scalar, place: Place) -> Result<f64, PlyError> {
        match self.encoding {
            Encoding::Ascii => self.text(kind, place),
            Encoding::LittleEndian => Ok(binary(kind, self.take(kind.size(), place)?, false)),
            Encoding::BigEndian => Ok(binary(kind, self.take(kind.size(), place)?, true)),
        }
    }

    fn take(&mut self, size: usize, place: Place) -> Result<&[u8], PlyError> {
        let end = self.at + size;
        let taken = self.bytes.get(self.at..end).ok_or_else(|| self.truncated(place))?;
        self.at = end;
        Ok(taken)
    }

    fn text(&mut self, kind: Scalar, place: Place) -> Result<f64, PlyError> {
        let rest = &self.bytes[self.at..];
        let start =
            rest.iter().position(|b| !b.is_ascii_whitespace()).ok_or_else(|| self.truncated(place))?;
        let length = rest[start..].iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len() - start);
        let token = String::from_utf8_lossy(&rest[start..start + length]);
        let Some(value) = parse(kind, &token) else {
            return Err(PlyError::NotANumber {
                element: place.element.name.clone(),
                row: place.row,
                offset: self.at + start,
                token: token.chars().take(40).collect(),
                kind: kind.name(),
            });
        };
        self.at += start + length;
        Ok(value)
    }

    fn truncated(&self, place: Place) -> PlyError {
        PlyError::Truncated {
            element: place.element.name.clone(),
            row: place.row,
            count: place.element.count,
            offset: self.bytes.len(),
        }
    }
}

fn parse(kind: Scalar, token: &str) -> Option<f64> {
    fn whole<T: std::str::FromStr + Into<f64>>(token: &str) -> Option<f64> {
        token.parse::<T>().ok().map(Into::into)
    }
    match kind {
        Scalar::I8 => whole::<i8>(token),
        Scalar::U8 => whole::<u8>(token),
        Scalar::I16 => whole::<i16>(token),
        Scalar::U16 => whole::<u16>(token),
        Scalar::I32 => whole::<i32>(token),
        Scalar::U32 => whole::<u32>(token),
        // Through single precision, so that text rounds once.
        Scalar::F32 => whole::<f32>(token),
        Scalar::F64 => whole::<f64>(token),
    }
}

fn binary(kind: Scalar, bytes: &[u8], big_endian: bool) -> f64 {
    let mut low_first = [0u8; 8];
    low_first[..bytes.len()].copy_from_slice(bytes);
    if big_endian {
        low_first[..bytes.len()].reverse();
    }
    let bits = u64::from_le_bytes(low_first);
    match kind {
        Scalar::I8 => f64::from(bits as u8 as i8),
        Scalar::U8 => f64::from(bits as u8),
        Scalar::I16 => f64::from(bits as u16 as i16),
        Scalar::U16 => f64::from(bits as u16),
        Scalar::I32 => f64::from(bits as u32 as i32),
        Scalar::U32 => f64::from(bits as u32),
        Scalar::F32 => f64::from(f32::from_bits(bits as u32)),
        Scalar::F64 => f64::from_bits(bits),
    }
}
