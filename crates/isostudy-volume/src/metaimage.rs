//! MetaImage (Kitware's MetaIO): `.mha`, or `.mhd` with the data in a file of its own.

use std::path::Path;

use crate::data::{self, Encoding, Layout, SampleKind, Skip};
use crate::error::{Problem, VolumeError, shortened};
use crate::header::{Data, Frame, Lines, Unread, numbers, sample_count, three};

pub(crate) fn open(path: &Path) -> Result<Unread, VolumeError> {
    let here = |problem: Problem| problem.in_file(path);
    let mut lines = Lines::new(data::open(path).map_err(here)?);
    let fields = Fields::read(&mut lines).map_err(here)?;
    let (frame, layout) = fields.meaning().map_err(here)?;
    let data = match fields.data_file.as_str() {
        "LOCAL" => Data::Here(lines.into_data()),
        name => Data::In(name.into()),
    };
    Ok(Unread::new(frame, layout, path, data))
}

const IDENTITY: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

struct Fields {
    dimensions: Option<usize>,
    sizes: Option<Vec<u64>>,
    kind: Option<SampleKind>,
    spacing: Option<[f64; 3]>,
    size: Option<[f64; 3]>,
    origin: [f64; 3],
    /// Row after row, each the direction of an axis.
    turn: [[f64; 3]; 3],
    /// What it is turned about, as far as the header says.
    turn_centre: [f64; 3],
    is_text: bool,
    big_endian: bool,
    is_compressed: bool,
    header_bytes: i64,
    data_file: String,
}

impl Fields {
    /// Reads up to `ElementDataFile`, which is the last.
    fn read<R: std::io::BufRead>(lines: &mut Lines<R>) -> Result<Self, Problem> {
        let mut fields = Self {
            dimensions: None,
            sizes: None,
            kind: None,
            spacing: None,
            size: None,
            origin: [0.0; 3],
            turn: IDENTITY,
            turn_centre: [0.0; 3],
            is_text: false,
            big_endian: false,
            is_compressed: false,
            header_bytes: 0,
            data_file: String::new(),
        };
        while let Some((line, text)) = lines.next()? {
            if text.trim().is_empty() {
                continue;
            }
            let Some((key, value)) = text.split_once('=') else {
                return Err(Problem::line(line, format!("`{}` is not `Key = value`", shortened(&text))));
            };
            fields.field(line, key.trim(), value.trim())?;
            if key.trim() == "ElementDataFile" {
                return Ok(fields);
            }
        }
        Err(Problem::Lacks { key: "ElementDataFile" })
    }

    /// Keys that say nothing of what a sample is or where it lies are passed over.
    fn field(&mut self, line: usize, key: &str, value: &str) -> Result<(), Problem> {
        let whole = |what: &str| Problem::line(line, format!("`{}` is not {what}", shortened(value)));
        let truth = || match value.to_ascii_lowercase().as_str() {
            "true" | "t" | "1" => Ok(true),
            "false" | "f" | "0" => Ok(false),
            _ => Err(whole("True or False")),
        };
        match key {
            "ObjectType" if value != "Image" => {
                return Err(Problem::unsupported("ObjectType", value, "Image is"));
            }
            "NDims" => self.dimensions = Some(value.parse().map_err(|_| whole("a number of dimensions"))?),
            "DimSize" => self.sizes = Some(numbers(line, value)?),
            "ElementType" => self.kind = Some(kind(value)?),
            "ElementNumberOfChannels" if value != "1" => {
                return Err(Problem::unsupported("ElementNumberOfChannels", value, "1 is"));
            }
            // Programs do not agree on whether the samples or what is shown of them are meant.
            "ElementToIntensityFunctionSlope" if numbers::<f64>(line, value)? != [1.0] => {
                return Err(Problem::unsupported("ElementToIntensityFunctionSlope", value, "1 is"));
            }
            "ElementToIntensityFunctionOffset" if numbers::<f64>(line, value)? != [0.0] => {
                return Err(Problem::unsupported("ElementToIntensityFunctionOffset", value, "0 is"));
            }
            "CenterOfRotation" => self.turn_centre = three(line, value)?,
            "ElementSpacing" => self.spacing = Some(three(line, value)?),
            "ElementSize" => self.size = Some(three(line, value)?),
            "Offset" | "Position" | "Origin" => self.origin = three(line, value)?,
            "TransformMatrix" | "Rotation" | "Orientation" => {
                let values: Vec<f64> = numbers(line, value)?;
                if values.len() != 9 {
                    return Err(Problem::line(line, format!("{} numbers where 9 belong", values.len())));
                }
                self.turn = [0, 3, 6].map(|k| [values[k], values[k + 1], values[k + 2]]);
            }
            "BinaryData" => self.is_text = !truth()?,
            "BinaryDataByteOrderMSB" | "ElementByteOrderMSB" => self.big_endian = truth()?,
            "CompressedData" => self.is_compressed = truth()?,
            "HeaderSize" => {
                self.header_bytes = value.parse().map_err(|_| whole("a number of bytes"))?;
                if self.header_bytes < -1 {
                    return Err(whole("a number of bytes, or -1"));
                }
            }
            "ElementDataFile" => {
                if value.is_empty() || value.starts_with("LIST") || value.contains('%') {
                    return Err(Problem::unsupported("ElementDataFile", value, "LOCAL or one file is"));
                }
                // Some programs write it in capitals, some not.
                let is_local = value.eq_ignore_ascii_case("local");
                self.data_file = if is_local { "LOCAL".to_owned() } else { value.to_owned() };
            }
            _ => {}
        }
        Ok(())
    }

    /// What it all means together.
    fn meaning(&self) -> Result<(Frame, Layout), Problem> {
        if let Some(dimensions) = self.dimensions.filter(|&n| n != 3) {
            return Err(Problem::unsupported("NDims", &dimensions.to_string(), "3 is"));
        }
        let sizes = self.sizes.as_ref().ok_or(Problem::Lacks { key: "DimSize" })?;
        let kind = self.kind.ok_or(Problem::Lacks { key: "ElementType" })?;
        let &[x, y, z] = &sizes[..] else {
            return Err(Problem::unsupported("DimSize", &format!("{sizes:?}"), "three sizes are"));
        };
        let samples = sample_count(sizes)?;
        let counts = [x as usize, y as usize, z as usize];
        // Nor on whether the offset is that of the first sample or of the centre then.
        if self.turn != IDENTITY && self.turn_centre != [0.0; 3] {
            let value = format!("{:?}", self.turn_centre);
            return Err(Problem::unsupported("CenterOfRotation", &value, "0 0 0 with turned axes is"));
        }
        let spacing = self.spacing.or(self.size).unwrap_or([1.0; 3]);
        let mut steps = self.turn;
        for (step, spacing) in steps.iter_mut().zip(spacing) {
            *step = step.map(|v| v * spacing);
        }
        let frame = Frame { counts, origin: self.origin, steps };
        frame.check()?;
        let encoding = match (self.is_text, self.is_compressed) {
            (true, true) => {
                return Err(Problem::unsupported("CompressedData", "of text", "of binary data it is"));
            }
            (true, false) => Encoding::Text,
            (false, true) => Encoding::Zlib,
            (false, false) => Encoding::Raw,
        };
        let bytes = match self.header_bytes {
            -1 if encoding == Encoding::Raw => None,
            bytes if bytes == 0 || encoding == Encoding::Raw => Some(bytes.unsigned_abs()),
            bytes => {
                return Err(Problem::unsupported("HeaderSize", &bytes.to_string(), "with raw data it is"));
            }
        };
        let skip = Skip { lines: 0, bytes };
        Ok((frame, Layout { kind, big_endian: self.big_endian, encoding, skip, samples }))
    }
}

fn kind(name: &str) -> Result<SampleKind, Problem> {
    Ok(match name {
        "MET_CHAR" => SampleKind::I8,
        "MET_UCHAR" => SampleKind::U8,
        "MET_SHORT" => SampleKind::I16,
        "MET_USHORT" => SampleKind::U16,
        "MET_INT" => SampleKind::I32,
        "MET_UINT" => SampleKind::U32,
        "MET_FLOAT" => SampleKind::F32,
        "MET_DOUBLE" => SampleKind::F64,
        _ => {
            let supported = "MET_CHAR to MET_UINT, MET_FLOAT and MET_DOUBLE are";
            return Err(Problem::unsupported("ElementType", name, supported));
        }
    })
}
