//! Nearly raw raster data (Kindlmann, teem), versions 1 to 5, header attached or detached.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use crate::data::{self, Encoding, Layout, SampleKind, Skip};
use crate::error::{Problem, VolumeError, shortened};
use crate::header::{Data, Frame, Lines, Unread, numbers, sample_count};

/// Fields of the format's definition that say nothing of what a sample is or where it lies.
const PASSED_OVER: [&str; 19] = [
    "content",
    "number",
    "sample units",
    "sampleunits",
    "min",
    "max",
    "old min",
    "oldmin",
    "old max",
    "oldmax",
    "block size",
    "blocksize",
    "thicknesses",
    "labels",
    "units",
    "space",
    "space units",
    "space dimension",
    "measurement frame",
];

/// Which axis of a file is that of frames.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FrameAxis {
    pub(crate) frames: usize,
    /// Samples of one frame that stand together: the product of the sizes of faster axes.
    pub(crate) before: usize,
}

pub(crate) fn open(path: &Path) -> Result<Unread, VolumeError> {
    let (fields, lines) = header(path).map_err(|problem| problem.in_file(path))?;
    let (frame, layout) = fields.meaning().map_err(|problem| problem.in_file(path))?;
    Ok(Unread::new(frame, layout, path, fields.data(lines)))
}

/// The same of a file with four axes, one of which is that of frames.
pub(crate) fn open_series(path: &Path) -> Result<(Unread, FrameAxis), VolumeError> {
    let (fields, lines) = header(path).map_err(|problem| problem.in_file(path))?;
    let (frame, layout, axis) = fields.meaning_in_time().map_err(|problem| problem.in_file(path))?;
    Ok((Unread::new(frame, layout, path, fields.data(lines)), axis))
}

fn header(path: &Path) -> Result<(Fields, Lines<BufReader<File>>), Problem> {
    let mut lines = Lines::new(data::open(path)?);
    Ok((Fields::read(&mut lines)?, lines))
}

/// What the header says, as far as it matters; per-axis fields have a value an axis once `meaning` has checked them.
#[derive(Default)]
struct Fields {
    dimension: Option<usize>,
    kind: Option<SampleKind>,
    sizes: Option<Vec<u64>>,
    encoding: Option<Encoding>,
    big_endian: Option<bool>,
    spacings: Option<Vec<f64>>,
    mins: Option<Vec<f64>>,
    maxs: Option<Vec<f64>>,
    /// Whether samples stand for cells; otherwise for nodes.
    cells: Option<Vec<bool>>,
    /// What each axis is; only of a series.
    kinds: Option<Vec<String>>,
    directions: Option<Vec<Option<[f64; 3]>>>,
    space_origin: Option<[f64; 3]>,
    data_file: Option<String>,
    line_skip: u64,
    byte_skip: Option<i64>,
}

impl Fields {
    fn read<R: std::io::BufRead>(lines: &mut Lines<R>) -> Result<Self, Problem> {
        let (line, magic) = lines.next()?.unwrap_or((1, String::new()));
        let version = magic.strip_prefix("NRRD").and_then(|text| text.parse::<u32>().ok());
        match version {
            Some(1..=5) => {}
            Some(version) => {
                return Err(Problem::unsupported("NRRD version", &version.to_string(), "1 to 5 are"));
            }
            None => return Err(Problem::line(line, "the file does not start with `NRRD`")),
        }
        let mut fields = Self::default();
        let mut seen: Vec<String> = Vec::new();
        while let Some((line, text)) = lines.next()? {
            if text.is_empty() {
                // The data follows, unless it is in a file of its own.
                return Ok(fields);
            }
            if text.starts_with('#') || is_key_value(&text) {
                continue;
            }
            let Some((name, value)) = text.split_once(": ").or_else(|| text.split_once(':')) else {
                return Err(Problem::line(line, format!("`{}` is not `field: value`", shortened(&text))));
            };
            let name = name.trim().to_ascii_lowercase();
            if seen.contains(&name) {
                return Err(Problem::line(line, format!("a second field `{}`", shortened(&name))));
            }
            fields.field(line, &name, value.trim())?;
            seen.push(name);
        }
        if fields.data_file.is_none() {
            return Err(Problem::Lacks { key: "data file" });
        }
        Ok(fields)
    }

    /// Fields that say nothing of what a sample is or where it lies are passed over; what is none is refused.
    fn field(&mut self, line: usize, name: &str, value: &str) -> Result<(), Problem> {
        let whole = |what: &str| Problem::line(line, format!("`{}` is not {what}", shortened(value)));
        match name {
            "dimension" => self.dimension = Some(value.parse().map_err(|_| whole("a dimension"))?),
            "type" => self.kind = Some(kind(value)?),
            "sizes" => self.sizes = Some(numbers(line, value)?),
            "encoding" => self.encoding = Some(encoding(value)?),
            "endian" => {
                self.big_endian = Some(match value.to_ascii_lowercase().as_str() {
                    "little" => false,
                    "big" => true,
                    _ => return Err(whole("`little` or `big`")),
                });
            }
            "spacings" => self.spacings = Some(numbers(line, value)?),
            "axis mins" | "axismins" => self.mins = Some(numbers(line, value)?),
            "axis maxs" | "axismaxs" => self.maxs = Some(numbers(line, value)?),
            "centers" | "centerings" => {
                let cells = value.split_ascii_whitespace().map(|word| word != "node");
                self.cells = Some(cells.collect());
            }
            "kinds" => {
                let kinds = value.split_ascii_whitespace().map(str::to_ascii_lowercase);
                self.kinds = Some(kinds.collect());
            }
            "space dimension" if value != "3" => {
                return Err(Problem::unsupported("space dimension", value, "3 is"));
            }
            "space directions" => self.directions = Some(directions(line, value)?),
            "space origin" => match directions(line, value)?[..] {
                [Some(origin)] => self.space_origin = Some(origin),
                _ => return Err(whole("one vector")),
            },
            "data file" | "datafile" => {
                if value.starts_with("LIST") || value.contains('%') {
                    return Err(Problem::unsupported("data file", value, "one file is"));
                }
                self.data_file = Some(value.to_owned());
            }
            "line skip" | "lineskip" => {
                self.line_skip = value.parse().map_err(|_| whole("a number of lines"))?
            }
            "byte skip" | "byteskip" => {
                let bytes: i64 = value.parse().map_err(|_| whole("a number of bytes"))?;
                if bytes < -1 {
                    return Err(whole("a number of bytes, or -1"));
                }
                self.byte_skip = Some(bytes);
            }
            // A misspelt `spacings` would put the volume elsewhere without a word.
            _ if !PASSED_OVER.contains(&name) => {
                return Err(Problem::line(line, format!("`{}` is no field of NRRD", shortened(name))));
            }
            _ => {}
        }
        Ok(())
    }

    fn data(self, lines: Lines<BufReader<File>>) -> Data {
        match self.data_file {
            Some(name) => Data::In(name.into()),
            None => Data::Here(lines.into_data()),
        }
    }

    /// What it all means together.
    fn meaning(&self) -> Result<(Frame, Layout), Problem> {
        let sizes = self.checked_sizes()?;
        let samples = sample_count(sizes)?;
        let Ok::<[usize; 3], _>(spatial) = self.long_axes(sizes, 3).try_into() else {
            return Err(Problem::unsupported("sizes", &format!("{sizes:?}"), "three axes longer than 1 are"));
        };
        let frame = self.frame(spatial, sizes)?;
        frame.check()?;
        Ok((frame, self.layout(samples)?))
    }

    /// The same of four axes: three of space, and the place of that of frames among them.
    fn meaning_in_time(&self) -> Result<(Frame, Layout, FrameAxis), Problem> {
        let sizes = self.checked_sizes()?;
        let samples = sample_count(sizes)?;
        let Ok::<[usize; 4], _>(axes) = self.long_axes(sizes, 4).try_into() else {
            return Err(Problem::unsupported(
                "sizes",
                &format!("{sizes:?}"),
                "a series in one file has four axes",
            ));
        };
        let time = self.axis_of_frames(axes)?;
        let mut spatial = axes.into_iter().filter(|&axis| axis != time);
        let frame = self.frame([0; 3].map(|_| spatial.next().expect("three are left")), sizes)?;
        frame.check()?;
        let before = sizes[..time].iter().product::<u64>() as usize;
        Ok((frame, self.layout(samples)?, FrameAxis { frames: sizes[time] as usize, before }))
    }

    /// The axis that has no direction where the others have one; that of the kind `time`, or `list`; the last one.
    fn axis_of_frames(&self, axes: [usize; 4]) -> Result<usize, Problem> {
        let alone = |is: &dyn Fn(usize) -> bool| {
            let mut found = axes.into_iter().filter(|&axis| is(axis));
            found.next().filter(|_| found.next().is_none())
        };
        let kind =
            |axis: usize| self.kinds.as_ref().and_then(|kinds| kinds.get(axis)).map_or("???", String::as_str);
        let axis = alone(&|axis| self.directions.as_ref().is_some_and(|d| d[axis].is_none()))
            .or_else(|| alone(&|axis| kind(axis) == "time"))
            .or_else(|| alone(&|axis| kind(axis) == "list"))
            .unwrap_or(axes[3]);
        match kind(axis) {
            "time" | "list" | "domain" | "space" | "none" | "???" => Ok(axis),
            // Colours and vectors are no frames.
            kind => Err(Problem::unsupported("kinds", kind, "`time` or `list` is, for the axis of frames")),
        }
    }

    /// The sizes, of which there are as many as axes, like of all that is said per axis.
    fn checked_sizes(&self) -> Result<&[u64], Problem> {
        let dimension = self.dimension.ok_or(Problem::Lacks { key: "dimension" })?;
        let sizes = self.sizes.as_ref().ok_or(Problem::Lacks { key: "sizes" })?;
        self.kind.ok_or(Problem::Lacks { key: "type" })?;
        self.encoding.ok_or(Problem::Lacks { key: "encoding" })?;
        let axes = |key: &'static str, count: Option<usize>| match count {
            Some(count) if count != dimension => {
                let value = format!("{count} values for {dimension} axes");
                Err(Problem::unsupported(key, &value, "one an axis is"))
            }
            _ => Ok(()),
        };
        axes("sizes", Some(sizes.len()))?;
        axes("spacings", self.spacings.as_ref().map(Vec::len))?;
        axes("axis mins", self.mins.as_ref().map(Vec::len))?;
        axes("axis maxs", self.maxs.as_ref().map(Vec::len))?;
        axes("centers", self.cells.as_ref().map(Vec::len))?;
        axes("space directions", self.directions.as_ref().map(Vec::len))?;
        Ok(sizes)
    }

    /// The axes, without further ones than `wanted` along which nothing is: those without a direction go first.
    fn long_axes(&self, sizes: &[u64], wanted: usize) -> Vec<usize> {
        let mut long: Vec<usize> = (0..sizes.len()).collect();
        while long.len() > wanted {
            let without = |&i: &usize| self.directions.as_ref().is_some_and(|d| d[i].is_none());
            let empty = |&&i: &&usize| sizes[i] == 1;
            let first = long.iter().filter(empty).find(|i| without(i)).or_else(|| long.iter().find(empty));
            let Some(&gone) = first else { break };
            long.retain(|&i| i != gone);
        }
        long
    }

    fn layout(&self, samples: u64) -> Result<Layout, Problem> {
        let kind = self.kind.ok_or(Problem::Lacks { key: "type" })?;
        let encoding = self.encoding.ok_or(Problem::Lacks { key: "encoding" })?;
        if kind.bytes() > 1 && self.big_endian.is_none() && encoding != Encoding::Text {
            return Err(Problem::Lacks { key: "endian" });
        }
        let bytes = match self.byte_skip.unwrap_or(0) {
            -1 if encoding == Encoding::Raw => None,
            -1 => return Err(Problem::unsupported("byte skip", "-1", "with raw encoding it is")),
            bytes => Some(bytes.unsigned_abs()),
        };
        if encoding == Encoding::Text && bytes != Some(0) {
            return Err(Problem::unsupported("byte skip", "with text", "`line skip` is"));
        }
        let skip = Skip { lines: self.line_skip, bytes };
        Ok(Layout { kind, big_endian: self.big_endian.unwrap_or(false), encoding, skip, samples })
    }

    /// The directions where they are given; otherwise the axes' own spacings, and their minima or zero.
    fn frame(&self, spatial: [usize; 3], sizes: &[u64]) -> Result<Frame, Problem> {
        let counts = spatial.map(|i| sizes[i] as usize);
        if let Some(directions) = &self.directions {
            let mut steps = [[0.0; 3]; 3];
            for (step, &axis) in steps.iter_mut().zip(&spatial) {
                *step = directions[axis].ok_or_else(|| {
                    Problem::unsupported("space directions", "none", "a vector for each long axis is")
                })?;
            }
            return Ok(Frame { counts, origin: self.space_origin.unwrap_or_default(), steps });
        }
        let (mut origin, mut spacing) = ([0.0; 3], [1.0; 3]);
        for (k, &axis) in spatial.iter().enumerate() {
            let of = |values: &Option<Vec<f64>>| values.as_ref().map(|v| v[axis]).filter(|v| !v.is_nan());
            let is_cell = self.cells.as_ref().is_none_or(|cells| cells[axis]);
            let gaps = if is_cell { counts[k] } else { counts[k] - 1 }.max(1) as f64;
            let (min, max) = (of(&self.mins), of(&self.maxs));
            let across = min.zip(max).map(|(min, max)| (max - min) / gaps);
            spacing[k] = of(&self.spacings).or(across).unwrap_or(1.0);
            // A cell's sample lies in its middle.
            let into = if is_cell { 0.5 * spacing[k] } else { 0.0 };
            origin[k] = min.map_or(0.0, |min| min + into);
        }
        Ok(Frame::diagonal(counts, self.space_origin.unwrap_or(origin), spacing))
    }
}

/// `key:=value`, for which there is no meaning; a field's `: ` comes first if there is one.
fn is_key_value(text: &str) -> bool {
    match (text.find(":="), text.find(": ")) {
        (Some(pair), Some(field)) => pair < field,
        (pair, _) => pair.is_some(),
    }
}

/// `(x,y,z)` or `none`, separated by white space; there may be spaces in the brackets.
fn directions(line: usize, text: &str) -> Result<Vec<Option<[f64; 3]>>, Problem> {
    let wrong = || Problem::line(line, format!("`{}` are not vectors `(x,y,z)` or `none`", shortened(text)));
    let mut found = Vec::new();
    let mut rest = text.trim();
    while !rest.is_empty() {
        if let Some(after) = rest.strip_prefix("none") {
            found.push(None);
            rest = after.trim_start();
            continue;
        }
        let (inside, after) = rest.strip_prefix('(').and_then(|r| r.split_once(')')).ok_or_else(wrong)?;
        let values: Result<Vec<f64>, _> = inside.split(',').map(|word| word.trim().parse()).collect();
        let vector: [f64; 3] = values.map_err(|_| wrong())?.try_into().map_err(|_| wrong())?;
        found.push(Some(vector));
        rest = after.trim_start();
    }
    Ok(found)
}

fn kind(name: &str) -> Result<SampleKind, Problem> {
    Ok(match name {
        "signed char" | "int8" | "int8_t" => SampleKind::I8,
        "uchar" | "unsigned char" | "uint8" | "uint8_t" => SampleKind::U8,
        "short" | "short int" | "signed short" | "signed short int" | "int16" | "int16_t" => SampleKind::I16,
        "ushort" | "unsigned short" | "unsigned short int" | "uint16" | "uint16_t" => SampleKind::U16,
        "int" | "signed int" | "int32" | "int32_t" => SampleKind::I32,
        "uint" | "unsigned int" | "uint32" | "uint32_t" => SampleKind::U32,
        "float" => SampleKind::F32,
        "double" => SampleKind::F64,
        _ => {
            return Err(Problem::unsupported(
                "type",
                name,
                "8- to 32-bit whole numbers, float and double are",
            ));
        }
    })
}

fn encoding(name: &str) -> Result<Encoding, Problem> {
    Ok(match name.to_ascii_lowercase().as_str() {
        "raw" => Encoding::Raw,
        "txt" | "text" | "ascii" => Encoding::Text,
        "hex" => Encoding::Hex,
        "gz" | "gzip" => Encoding::Gzip,
        _ => return Err(Problem::unsupported("encoding", name, "raw, gzip, text and hex are")),
    })
}
