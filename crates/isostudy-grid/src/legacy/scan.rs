//! Lines of keywords, and the blocks of numbers between them.

use crate::error::{Problem, shortened};
use crate::numbers::{NumberKind, Numbers};

/// The longest line of keywords; blocks of numbers aside.
const LINE_LIMIT_BYTES: usize = 1 << 16;

/// Numbers that have been found and not been read.
pub(super) struct Block {
    /// Where it is declared.
    pub(super) line: usize,
    name: String,
    kind: NumberKind,
    /// How many numbers.
    pub(super) count: u64,
    /// Where they are in the file.
    from: usize,
    to: usize,
}

/// A place in a file.
pub(super) struct Scan<'a> {
    bytes: &'a [u8],
    at: usize,
    line: usize,
    is_binary: bool,
    has_offsets: bool,
}

impl<'a> Scan<'a> {
    /// Reads the first three lines.
    ///
    /// # Errors
    /// If they are not those of a legacy file.
    pub(super) fn begin(bytes: &'a [u8]) -> Result<Self, Problem> {
        let mut scan = Self { bytes, at: 0, line: 0, is_binary: false, has_offsets: false };
        let first = scan.raw_line().unwrap_or_default();
        let version = first.strip_prefix(b"# vtk DataFile Version ");
        let version = version
            .and_then(|version| std::str::from_utf8(version).ok()?.trim().split('.').next()?.parse().ok());
        let version: u32 = version.ok_or_else(|| {
            Problem::line(1, "the file does not begin with `# vtk DataFile Version` and a number")
        })?;
        scan.has_offsets = version >= 5;
        scan.raw_line().ok_or_else(|| Problem::Whole("the file ends within its head".to_owned()))?;
        let (line, words) =
            scan.line()?.ok_or_else(|| Problem::Whole("the file ends within its head".to_owned()))?;
        scan.is_binary = match words[0].to_ascii_uppercase().as_str() {
            "ASCII" => false,
            "BINARY" => true,
            other => {
                let other = shortened(other);
                return Err(Problem::line(line, format!("`{other}` is neither ASCII nor BINARY")));
            }
        };
        Ok(scan)
    }

    /// Whether cells are listed with offsets, as since version 5.
    pub(super) fn has_offsets(&self) -> bool {
        self.has_offsets
    }

    /// Colours are bytes, or numbers from 0 to 1 in a text.
    pub(super) fn kind_of_colours(&self) -> NumberKind {
        if self.is_binary { NumberKind::U8 } else { NumberKind::F32 }
    }

    /// The words of the next line that has any, and its number.
    ///
    /// # Errors
    /// If it is too long, or no text.
    pub(super) fn line(&mut self) -> Result<Option<(usize, Vec<String>)>, Problem> {
        while let Some(line) = self.raw_line() {
            if line.len() > LINE_LIMIT_BYTES {
                return Err(Problem::line(self.line, format!("has more than {LINE_LIMIT_BYTES} bytes")));
            }
            let text = std::str::from_utf8(line);
            let text =
                text.map_err(|_| Problem::line(self.line, "a keyword must be here, and this is no text"))?;
            let words: Vec<String> = text.split_whitespace().map(str::to_owned).collect();
            if !words.is_empty() {
                return Ok(Some((self.line, words)));
            }
        }
        Ok(None)
    }

    /// Goes over lines that describe an array, up to an empty one.
    pub(super) fn pass_over_metadata(&mut self) {
        while let Some(line) = self.raw_line() {
            if line.trim_ascii().is_empty() {
                return;
            }
        }
    }

    /// Goes over the name of a colour table, which scalars have.
    ///
    /// # Errors
    /// If what comes is no text.
    pub(super) fn pass_over_table_name(&mut self) -> Result<(), Problem> {
        let (at, line) = (self.at, self.line);
        let is_name = match self.line() {
            Ok(Some((_, words))) => words[0].eq_ignore_ascii_case("LOOKUP_TABLE"),
            _ => false,
        };
        if !is_name {
            (self.at, self.line) = (at, line);
        }
        Ok(())
    }

    /// Finds the numbers that come next, and goes on behind them.
    ///
    /// # Errors
    /// If the file ends before the last.
    pub(super) fn block(
        &mut self,
        line: usize,
        name: &str,
        kind: NumberKind,
        count: u64,
    ) -> Result<Block, Problem> {
        let from = self.at;
        let short = |got: u64| Problem::Array {
            line,
            name: shortened(name),
            reason: format!("the file ends after {got} of {count} numbers"),
        };
        if self.is_binary {
            let there = (self.bytes.len() - from) as u64;
            let bytes = count.checked_mul(kind.bytes() as u64).filter(|&bytes| bytes <= there);
            let bytes = bytes.ok_or_else(|| short(there / kind.bytes() as u64))?;
            self.go_to(from + bytes as usize);
        } else {
            for got in 0..count {
                let word = self.word().ok_or_else(|| short(got))?;
                // A keyword among the numbers: there are fewer than is claimed. `nan` and `inf` are numbers.
                if word[0].is_ascii_alphabetic() && crate::numbers::real(word).is_none() {
                    let word = shortened(&String::from_utf8_lossy(word));
                    let (name, reason) = (shortened(name), format!("number {got} of {count} is `{word}`"));
                    return Err(Problem::Array { line, name, reason });
                }
            }
        }
        Ok(Block { line, name: name.to_owned(), kind, count, from, to: self.at })
    }

    /// Goes over what is not read: texts, and single bits.
    ///
    /// # Errors
    /// If the file ends before the last, or it is one of texts in bytes.
    pub(super) fn pass_over(
        &mut self,
        line: usize,
        name: &str,
        kind: &str,
        count: u64,
    ) -> Result<(), Problem> {
        let short =
            || Problem::Array { line, name: shortened(name), reason: "the file ends within it".to_owned() };
        match (kind.eq_ignore_ascii_case("bit"), self.is_binary) {
            (true, true) => {
                let bytes = usize::try_from(count.div_ceil(8)).ok();
                let end =
                    bytes.and_then(|bytes| self.at.checked_add(bytes)).filter(|&end| end <= self.bytes.len());
                self.go_to(end.ok_or_else(short)?);
            }
            (true, false) => {
                for _ in 0..count {
                    self.word().ok_or_else(short)?;
                }
            }
            (false, false) => {
                for _ in 0..count {
                    self.raw_line().ok_or_else(short)?;
                }
            }
            (false, true) => {
                let reason = "texts are not supported in a BINARY file".to_owned();
                return Err(Problem::Array { line, name: shortened(name), reason });
            }
        }
        Ok(())
    }

    /// The numbers of a block.
    ///
    /// # Errors
    /// If a word is none.
    pub(super) fn real(&self, block: &Block) -> Result<Vec<f64>, Problem> {
        Ok(self.numbers(block)?.into_real())
    }

    /// The same of whole ones.
    ///
    /// # Errors
    /// The same, and if they are not whole.
    pub(super) fn whole(&self, block: &Block) -> Result<Vec<i64>, Problem> {
        let whole = self.numbers(block)?.into_whole();
        whole.ok_or_else(|| block.damaged("its numbers must be whole"))
    }

    fn numbers(&self, block: &Block) -> Result<Numbers, Problem> {
        let bytes = &self.bytes[block.from..block.to];
        if self.is_binary {
            return Ok(block.kind.of_bytes(bytes, true));
        }
        let numbers = block.kind.of_words(crate::numbers::words(bytes), block.count);
        numbers.map_err(|(place, word)| {
            let word = shortened(&String::from_utf8_lossy(word));
            block.damaged(format!("number {place} is `{word}`"))
        })
    }

    /// The next line, without its end.
    fn raw_line(&mut self) -> Option<&'a [u8]> {
        let rest = &self.bytes[self.at..];
        if rest.is_empty() {
            return None;
        }
        let end = rest.iter().position(|&byte| byte == b'\n').unwrap_or(rest.len());
        self.at += (end + 1).min(rest.len());
        self.line += 1;
        Some(&rest[..end])
    }

    /// The next word, which is not empty.
    fn word(&mut self) -> Option<&'a [u8]> {
        let rest = &self.bytes[self.at..];
        let start = rest.iter().position(|byte| !byte.is_ascii_whitespace())?;
        let length = rest[start..].iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len() - start);
        self.go_to(self.at + start + length);
        Some(&rest[start..start + length])
    }

    /// Goes to a later place. Lines are counted, in bytes too: so a place in the file is one in any editor.
    fn go_to(&mut self, at: usize) {
        self.line += self.bytes[self.at..at].iter().filter(|&&byte| byte == b'\n').count();
        self.at = at;
    }
}

impl Block {
    fn damaged(&self, reason: impl Into<String>) -> Problem {
        Problem::Array { line: self.line, name: shortened(&self.name), reason: reason.into() }
    }
}

/// So many counts behind a keyword.
///
/// # Errors
/// If there are fewer, or one is none.
pub(super) fn counts<const N: usize>(line: usize, words: &[String]) -> Result<[u64; N], Problem> {
    let mut counts = [0; N];
    for (i, count) in counts.iter_mut().enumerate() {
        *count = self::count(line, words.get(i + 1))?;
    }
    Ok(counts)
}

/// # Errors
/// If a word is no count.
pub(super) fn count(line: usize, word: Option<&String>) -> Result<u64, Problem> {
    let word = word.map(String::as_str).unwrap_or_default();
    word.parse()
        .map_err(|_| Problem::line(line, format!("`{}` is here, and a count must be", shortened(word))))
}

/// # Errors
/// If the product is beyond what can be counted.
pub(super) fn times(line: usize, a: u64, b: u64) -> Result<u64, Problem> {
    a.checked_mul(b)
        .ok_or_else(|| Problem::line(line, format!("{a} times {b} numbers are more than can be counted")))
}

/// What lists and types of cells are.
pub(super) fn int() -> NumberKind {
    NumberKind::I32
}

/// # Errors
/// If a word is no type of numbers.
pub(super) fn kind(line: usize, word: Option<&String>) -> Result<NumberKind, Problem> {
    let word = word.map(|word| word.to_ascii_lowercase()).unwrap_or_default();
    Ok(match word.as_str() {
        "char" | "signed_char" => NumberKind::I8,
        "unsigned_char" => NumberKind::U8,
        "short" => NumberKind::I16,
        "unsigned_short" => NumberKind::U16,
        // VTK writes its own type of numbers of points with 32 bits here.
        "int" | "vtkidtype" => NumberKind::I32,
        "unsigned_int" => NumberKind::U32,
        "long" | "vtktypeint64" => NumberKind::I64,
        "unsigned_long" | "vtktypeuint64" => NumberKind::U64,
        "float" => NumberKind::F32,
        "double" => NumberKind::F64,
        other => {
            let other = shortened(other);
            return Err(Problem::line(
                line,
                format!("`{other}` is no type of numbers; int, float and double are some"),
            ));
        }
    })
}

/// A name as it was before it was written: blanks and signs are `%20` and the like.
pub(super) fn decoded(name: &str) -> String {
    let mut bytes = Vec::new();
    let mut rest = name.as_bytes();
    while let Some((&first, after)) = rest.split_first() {
        let hex = after.get(..2).and_then(|two| std::str::from_utf8(two).ok());
        let code = hex.filter(|_| first == b'%').and_then(|two| u8::from_str_radix(two, 16).ok());
        bytes.push(code.unwrap_or(first));
        rest = &after[if code.is_some() { 2 } else { 0 }..];
    }
    String::from_utf8_lossy(&bytes).into_owned()
}
