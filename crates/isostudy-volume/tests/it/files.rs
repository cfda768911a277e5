//! Volumes written by hand, in every way that is read.

use std::io::Write;
use std::path::{Path, PathBuf};

use flate2::Compression;
use flate2::write::{GzEncoder, ZlibEncoder};
use isostudy_volume::{Volume, VolumeError};

pub(crate) const TYPES: [&str; 8] = ["i8", "u8", "i16", "u16", "i32", "u32", "f32", "f64"];
pub(crate) const COUNTS: [usize; 3] = [4, 3, 2];

/// Different numbers that fit every type, and are negative where the type has such.
pub(crate) fn values(kind: &str) -> Vec<f32> {
    let sign = if kind.starts_with('u') { 1.0 } else { -1.0 };
    (0..24).map(|i| if i % 3 == 0 { sign * 5.0 * i as f32 } else { i as f32 }).collect()
}

pub(crate) fn bytes(kind: &str, big_endian: bool) -> Vec<u8> {
    let mut all = Vec::new();
    for v in values(kind) {
        let mut bytes = match kind {
            "i8" => (v as i8).to_le_bytes().to_vec(),
            "u8" => (v as u8).to_le_bytes().to_vec(),
            "i16" => (v as i16).to_le_bytes().to_vec(),
            "u16" => (v as u16).to_le_bytes().to_vec(),
            "i32" => (v as i32).to_le_bytes().to_vec(),
            "u32" => (v as u32).to_le_bytes().to_vec(),
            "f32" => v.to_le_bytes().to_vec(),
            _ => f64::from(v).to_le_bytes().to_vec(),
        };
        if big_endian {
            bytes.reverse();
        }
        all.extend(bytes);
    }
    all
}

pub(crate) fn encoded(bytes: &[u8], encoding: &str, kind: &str) -> Vec<u8> {
    match encoding {
        "gzip" => {
            let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
            encoder.write_all(bytes).unwrap();
            encoder.finish().unwrap()
        }
        "zlib" => {
            let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
            encoder.write_all(bytes).unwrap();
            encoder.finish().unwrap()
        }
        "hex" => bytes.iter().map(|b| format!("{b:02X}\n")).collect::<String>().into_bytes(),
        "text" => values(kind).iter().map(|v| format!("{v} ")).collect::<String>().into_bytes(),
        _ => bytes.to_vec(),
    }
}

pub(crate) fn nrrd_type(kind: &str) -> &'static str {
    match kind {
        "i8" => "signed char",
        "u8" => "uint8_t",
        "i16" => "short",
        "u16" => "unsigned short",
        "i32" => "int32",
        "u32" => "uint",
        "f32" => "float",
        _ => "double",
    }
}

pub(crate) fn meta_type(kind: &str) -> &'static str {
    ["MET_CHAR", "MET_UCHAR", "MET_SHORT", "MET_USHORT", "MET_INT", "MET_UINT", "MET_FLOAT", "MET_DOUBLE"]
        [TYPES.iter().position(|k| *k == kind).unwrap()]
}

pub(crate) fn nrrd_header(kind: &str, encoding: &str, big_endian: bool) -> String {
    format!(
        "NRRD0004\n# made by hand\ntype: {}\ndimension: 3\nspace: left-posterior-superior\nsizes: 4 3 2\n\
         space directions: (0,2,0) (-0.5, 0, 0) (0,0,3)\nkinds: domain domain domain\nendian: {}\nencoding: {encoding}\n\
         space origin: (1,-2,3)\nkey:=value: of no field\n",
        nrrd_type(kind),
        if big_endian { "big" } else { "little" },
    )
}

pub(crate) fn meta_header(kind: &str, encoding: &str, big_endian: bool) -> String {
    let (binary, compressed) = (encoding != "text", encoding == "zlib");
    format!(
        "ObjectType = Image\nNDims = 3\nBinaryData = {}\nBinaryDataByteOrderMSB = {}\nCompressedData = {}\n\
         TransformMatrix = 0 1 0 -1 0 0 0 0 1\nOffset = 1 -2 3\nElementSpacing = 2 0.5 3\nDimSize = 4 3 2\n\
         ElementType = {}\n",
        if binary { "True" } else { "False" },
        if big_endian { "True" } else { "False" },
        if compressed { "True" } else { "False" },
        meta_type(kind),
    )
}

/// What the headers above say.
pub(crate) fn wanted(kind: &str) -> Volume {
    Volume {
        counts: COUNTS,
        origin: [1.0, -2.0, 3.0],
        steps: [[0.0, 2.0, 0.0], [-0.5, 0.0, 0.0], [0.0, 0.0, 3.0]],
        values: values(kind),
    }
}

pub(crate) struct Folder(tempfile::TempDir);

impl Folder {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), bytes).unwrap();
    }

    pub(crate) fn read(&self, name: &str) -> Result<Volume, VolumeError> {
        isostudy_volume::read(&self.path(name), isostudy_volume::NO_LIMIT)
    }

    /// The message without the folder.
    pub(crate) fn refusal(&self, name: &str) -> String {
        let folder = format!("{}{}", self.0.path().display(), std::path::MAIN_SEPARATOR);
        self.read(name).unwrap_err().to_string().replace(&folder, "")
    }

    pub(crate) fn as_path(&self) -> &Path {
        self.0.path()
    }
}
