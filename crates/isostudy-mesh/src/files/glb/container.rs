//! The container of binary glTF: a header, the document, the buffer.

use std::io::{self, Write};

use crate::TriangleMesh;

/// glTF has no words for this.
pub(super) fn refuse(what: String) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, what)
}

/// Refuses positions that are not finite and indices without a vertex.
pub(super) fn check(mesh: &TriangleMesh) -> io::Result<()> {
    if let Some(v) = mesh.positions.iter().position(|p| !p.is_finite()) {
        return Err(refuse(format!("vertex {v} is at {}, which glTF cannot say", mesh.positions[v])));
    }
    let vertices = mesh.positions.len();
    if let Some(t) = mesh.triangles.iter().position(|t| t.iter().any(|&v| v as usize >= vertices)) {
        return Err(refuse(format!("triangle {t} refers to a vertex beyond the last of {vertices}")));
    }
    Ok(())
}

/// Writes everything up to the first byte of the buffer, which has `bytes` bytes, a multiple of four; none for no buffer.
pub(super) fn begin(out: &mut impl Write, mut json: String, bytes: u64) -> io::Result<()> {
    // Both chunks are padded to four bytes: text with spaces.
    while !json.len().is_multiple_of(4) {
        json.push(' ');
    }
    let chunk = if bytes == 0 { 0 } else { 8 + bytes };
    let total = 12 + 8 + json.len() as u64 + chunk;
    let total = u32::try_from(total)
        .map_err(|_| refuse(format!("{total} bytes, glTF's length has 32 bits, and so has a chunk's")))?;
    out.write_all(b"glTF")?;
    out.write_all(&2u32.to_le_bytes())?;
    out.write_all(&total.to_le_bytes())?;
    out.write_all(&(json.len() as u32).to_le_bytes())?;
    out.write_all(b"JSON")?;
    out.write_all(json.as_bytes())?;
    if bytes > 0 {
        out.write_all(&(bytes as u32).to_le_bytes())?;
        out.write_all(b"BIN\0")?;
    }
    Ok(())
}
