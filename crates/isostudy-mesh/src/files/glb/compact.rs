//! Binary glTF in few bytes: positions, normals and numbers in steps (`KHR_mesh_quantization`, Khronos 2020).

use std::fmt::Write as _;
use std::io::{self, BufWriter, Write};

use glam::{DVec3, Vec3};

use super::container::{begin, check, refuse};
use super::{ARRAY_BUFFER, BYTE, ELEMENT_ARRAY_BUFFER, UNSIGNED_BYTE, UNSIGNED_INT, UNSIGNED_SHORT};
use crate::{Bounds, TriangleMesh};

/// Steps along the longest side of the box.
const POSITION_STEPS: f64 = 65_535.0;
/// Steps of a normal's coordinate from 0 to 1.
const NORMAL_STEPS: f32 = 127.0;
/// The code of the largest number.
const LARGEST: f64 = 254.0;
/// The code of what has no number.
const NONE: u8 = 255;
/// Bytes of a vertex's position and of its normal. glTF wants multiples of four.
const POSITION_BYTES: u64 = 8;
const NORMAL_BYTES: u64 = 4;

/// What each of some numbers belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Per {
    /// One number per triangle.
    Triangle,
    /// One number per vertex.
    Vertex,
}

/// Numbers that travel with a mesh, such as distances.
#[derive(Debug, Clone, Copy)]
pub struct CompactNumbers<'a> {
    /// What they are called in the file: letters, digits and underscores.
    pub name: &'a str,
    /// What each belongs to.
    pub per: Per,
    /// The numbers, none negative; `None` where there is none.
    pub values: &'a [Option<f64>],
}

/// Writes a mesh as a binary glTF file of about half the bytes that [`write_glb`](crate::write_glb) takes, and better to
/// compress.
///
/// Positions are whole numbers from 0 to 65,535 along the longest side of the mesh's box, and the node's `translation` and
/// `scale` give coordinates back: each is off by half a step at most, and by what single precision rounds. Normals have steps of
/// 1/127. Indices have 16 bits where they fit. As with `write_glb`, coordinates keep their axes, a normal without a direction becomes +z,
/// and a mesh without triangles is a file with an empty scene.
///
/// The last vertices may be copies of others at the same places, with normals of their own, as of
/// [`CornerNormals::with_copies`](crate::CornerNormals::with_copies). `copies` has the vertex of each; none of it may be a copy. A
/// list of indices in the file, which `meshes[0].extras.copies` names by its `accessor`, leads back to normals without creases.
///
/// Numbers are no attributes, since those of triangles cannot be. Each list is an accessor of unsigned bytes, which
/// `meshes[0].extras.numbers` names with its `name`, `per` ("triangle" or "vertex") and `most`, the largest. Code 255 is no number;
/// any other is `most * (code / 254)^2`. Lists of vertices have none for copies. Steps are finer for small numbers, of which there are most where a mesh is good: the root
/// of a number is off by 1/508 of the root of `most` at most.
///
/// # Errors
/// As [`write_glb`](crate::write_glb), and [`io::ErrorKind::InvalidInput`] for a number that is negative or not finite, for a list
/// that has not one number per triangle or vertex, for a copy that is not of a vertex at its place, and for a name with other
/// characters.
pub fn write_compact_glb(
    mesh: &TriangleMesh,
    copies: &[u32],
    numbers: &[CompactNumbers<'_>],
    output: impl Write,
) -> io::Result<()> {
    check(mesh)?;
    let own = check_copies(mesh, copies)?;
    numbers.iter().try_for_each(|of| check_numbers(mesh, own, of))?;
    let mut out = BufWriter::new(output);
    let Some(bounds) = mesh.bounds().filter(|_| !mesh.triangles.is_empty()) else {
        let empty = r#"{"asset":{"version":"2.0","generator":"isostudy"},"scene":0,"scenes":[{}]}"#;
        begin(&mut out, empty.into(), 0)?;
        return out.flush();
    };
    let steps = Steps::of(&bounds);
    let layout = Layout::of(mesh, copies, numbers);
    begin(&mut out, document(mesh, numbers, &steps, &layout), layout.bytes())?;

    write_indices(mesh.triangles.as_flattened(), &layout, &mut out)?;
    for &position in &mesh.positions {
        for step in steps.whole(position) {
            out.write_all(&step.to_le_bytes())?;
        }
        out.write_all(&[0, 0])?;
    }
    for &normal in mesh.normals.iter().filter(|_| layout.with_normals) {
        let unit = normal.normalize_or(Vec3::Z).to_array();
        let [x, y, z] = unit.map(|along| (along * NORMAL_STEPS).round() as i8 as u8);
        out.write_all(&[x, y, z, 0])?;
    }
    write_indices(copies, &layout, &mut out)?;
    for of in numbers {
        let most = most(of);
        let codes: Vec<u8> = of.values.iter().map(|&value| code(value, most)).collect();
        out.write_all(&codes)?;
        pad(&mut out, codes.len() as u64)?;
    }
    out.flush()
}

fn write_indices(indices: &[u32], layout: &Layout, out: &mut impl Write) -> io::Result<()> {
    for &index in indices {
        match layout.short_indices {
            true => out.write_all(&(index as u16).to_le_bytes())?,
            false => out.write_all(&index.to_le_bytes())?,
        }
    }
    pad(out, layout.bytes_of_indices(indices.len() as u64))
}

/// How many vertices are no copies.
fn check_copies(mesh: &TriangleMesh, copies: &[u32]) -> io::Result<usize> {
    let vertices = mesh.positions.len();
    let Some(own) = vertices.checked_sub(copies.len()) else {
        return Err(refuse(format!("{} copies among {vertices} vertices", copies.len())));
    };
    let is_copy = |place: usize, of: usize| of < own && mesh.positions[own + place] == mesh.positions[of];
    match copies.iter().enumerate().find(|(place, of)| !is_copy(*place, **of as usize)) {
        Some((place, of)) => Err(refuse(format!("vertex {} is no copy of {of}", own + place))),
        None => Ok(own),
    }
}

fn check_numbers(mesh: &TriangleMesh, own: usize, of: &CompactNumbers<'_>) -> io::Result<()> {
    let CompactNumbers { name, per, values } = of;
    if name.is_empty() || !name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_') {
        return Err(refuse(format!("{name:?}: numbers are called by letters, digits and underscores")));
    }
    let (count, of_what) = match per {
        Per::Triangle => (mesh.triangles.len(), "triangles"),
        Per::Vertex => (own, "vertices"),
    };
    if values.len() != count {
        return Err(refuse(format!("{name}: {} numbers for {count} {of_what}", values.len())));
    }
    match values.iter().flatten().find(|value| !(value.is_finite() && **value >= 0.0)) {
        Some(value) => Err(refuse(format!("{name}: {value} must be finite and not negative"))),
        None => Ok(()),
    }
}

/// The largest number; 0 of none.
fn most(of: &CompactNumbers<'_>) -> f64 {
    of.values.iter().flatten().copied().fold(0.0, f64::max)
}

fn code(value: Option<f64>, most: f64) -> u8 {
    match value {
        None => NONE,
        Some(_) if most == 0.0 => 0,
        Some(value) => (LARGEST * (value / most).sqrt()).round() as u8,
    }
}

/// From coordinates to whole steps.
struct Steps {
    origin: Vec3,
    length: f64,
}

impl Steps {
    fn of(bounds: &Bounds) -> Self {
        let longest = f64::from(bounds.size().max_element());
        // All vertices in one place: any length will do.
        let length = if longest > 0.0 { longest / POSITION_STEPS } else { 1.0 };
        Self { origin: bounds.min, length }
    }

    fn whole(&self, position: Vec3) -> [u16; 3] {
        let along: DVec3 = (position.as_dvec3() - self.origin.as_dvec3()) / self.length;
        along.to_array().map(|steps| steps.round().clamp(0.0, POSITION_STEPS) as u16)
    }
}

/// Indices, positions, normals, what copies are of, then each list of numbers, all padded to four bytes.
struct Layout {
    short_indices: bool,
    indices: u64,
    vertices: u64,
    with_normals: bool,
    copies: u64,
    numbers: Vec<u64>,
}

impl Layout {
    fn of(mesh: &TriangleMesh, copies: &[u32], numbers: &[CompactNumbers<'_>]) -> Self {
        Self {
            // The largest index of a type restarts primitives.
            short_indices: mesh.positions.len() <= usize::from(u16::MAX),
            indices: 3 * mesh.triangles.len() as u64,
            vertices: mesh.positions.len() as u64,
            with_normals: mesh.normals.len() == mesh.positions.len(),
            copies: copies.len() as u64,
            numbers: numbers.iter().map(|of| of.values.len() as u64).collect(),
        }
    }

    fn bytes_of_indices(&self, count: u64) -> u64 {
        count * if self.short_indices { 2 } else { 4 }
    }

    /// Bytes of each part, without padding.
    fn parts(&self) -> Vec<u64> {
        let mut parts = vec![self.bytes_of_indices(self.indices), POSITION_BYTES * self.vertices];
        parts.extend(self.with_normals.then_some(NORMAL_BYTES * self.vertices));
        parts.extend((self.copies > 0).then(|| self.bytes_of_indices(self.copies)));
        parts.extend(&self.numbers);
        parts
    }

    fn bytes(&self) -> u64 {
        self.parts().iter().map(|part| part.next_multiple_of(4)).sum()
    }
}

/// Zeros after a part of so many bytes.
fn pad(out: &mut impl Write, bytes: u64) -> io::Result<()> {
    out.write_all(&[0; 3][..(bytes.next_multiple_of(4) - bytes) as usize])
}

/// The JSON. It holds numbers and plain words only, so nothing in it needs escaping.
fn document(mesh: &TriangleMesh, numbers: &[CompactNumbers<'_>], steps: &Steps, layout: &Layout) -> String {
    let Layout { indices, vertices, with_normals, copies, .. } = layout;
    let whole: Vec<[u16; 3]> = mesh.positions.iter().map(|&p| steps.whole(p)).collect();
    let ends = |end: fn(u16, u16) -> u16| {
        let all = |a: [u16; 3], b: &[u16; 3]| [0, 1, 2].map(|axis| end(a[axis], b[axis]));
        let [x, y, z] = whole.iter().fold(whole[0], all);
        format!("[{x},{y},{z}]")
    };
    let (low, high) = (ends(u16::min), ends(u16::max));
    // In double precision, whose decimals are those of the single-precision number exactly.
    let (DVec3 { x, y, z }, s) = (steps.origin.as_dvec3(), steps.length);
    let index_type = if layout.short_indices { UNSIGNED_SHORT } else { UNSIGNED_INT };
    let normal = if *with_normals { r#","NORMAL":2"# } else { "" };
    let copies_at = 2 + u32::from(*with_normals);
    let first = copies_at + u32::from(*copies > 0);
    let mut named: Vec<String> = Vec::new();
    let mut accessors = String::new();
    if *with_normals {
        let _ = write!(
            accessors,
            r#",{{"bufferView":2,"componentType":{BYTE},"normalized":true,"count":{vertices},"type":"VEC3"}}"#
        );
    }
    let mut of_copies = String::new();
    if *copies > 0 {
        let _ = write!(
            accessors,
            r#",{{"bufferView":{copies_at},"componentType":{index_type},"count":{copies},"type":"SCALAR"}}"#
        );
        of_copies = format!(r#","copies":{{"accessor":{copies_at}}}"#);
    }
    for (accessor, of) in (first..).zip(numbers) {
        let per = match of.per {
            Per::Triangle => "triangle",
            Per::Vertex => "vertex",
        };
        let (name, most, count) = (of.name, most(of), of.values.len());
        named.push(format!(r#"{{"name":"{name}","per":"{per}","accessor":{accessor},"most":{most}}}"#));
        let _ = write!(
            accessors,
            r#",{{"bufferView":{accessor},"componentType":{UNSIGNED_BYTE},"count":{count},"type":"SCALAR"}}"#
        );
    }
    let mut views = Vec::new();
    let mut start = 0;
    for (place, bytes) in layout.parts().into_iter().enumerate() {
        let more = match place {
            0 => format!(r#","target":{ELEMENT_ARRAY_BUFFER}"#),
            1 => format!(r#","byteStride":{POSITION_BYTES},"target":{ARRAY_BUFFER}"#),
            2 if *with_normals => format!(r#","byteStride":{NORMAL_BYTES},"target":{ARRAY_BUFFER}"#),
            _ => String::new(),
        };
        views.push(format!(r#"{{"buffer":0,"byteOffset":{start},"byteLength":{bytes}{more}}}"#));
        start += bytes.next_multiple_of(4);
    }
    // Two sided, so that an open surface has a back.
    format!(
        r#"{{"asset":{{"version":"2.0","generator":"isostudy"}},"extensionsUsed":["KHR_mesh_quantization"],"extensionsRequired":["KHR_mesh_quantization"],"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0,"translation":[{x},{y},{z}],"scale":[{s},{s},{s}]}}],"materials":[{{"doubleSided":true,"pbrMetallicRoughness":{{"metallicFactor":0}}}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":1{normal}}},"indices":0,"material":0}}],"extras":{{"numbers":[{}]{of_copies}}}}}],"accessors":[{{"bufferView":0,"componentType":{index_type},"count":{indices},"type":"SCALAR"}},{{"bufferView":1,"componentType":{UNSIGNED_SHORT},"count":{vertices},"type":"VEC3","min":{low},"max":{high}}}{accessors}],"bufferViews":[{}],"buffers":[{{"byteLength":{start}}}]}}"#,
        named.join(","),
        views.join(","),
    )
}
