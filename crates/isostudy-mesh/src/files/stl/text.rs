//! STL in words: `solid`, then `facet normal .. outer loop vertex .. vertex .. vertex .. endloop endfacet`, `endsolid`.

use glam::Vec3;

use super::StlError;

/// How far into a file the first facet is looked for: titles can be long.
const SEARCHED: usize = 4096;

/// Whether the file starts as text does. Binary titles start with `solid` as well, so a facet has to follow, or the
/// end of the solid.
pub(super) fn is_text(bytes: &[u8]) -> bool {
    let start = bytes.trim_ascii_start();
    let head = start[..start.len().min(SEARCHED)].to_ascii_lowercase();
    let has = |word: &[u8]| head.windows(word.len()).any(|w| w == word);
    head.starts_with(b"solid") && (has(b"facet") || has(b"endsolid"))
}

/// The corners of all facets of all solids, three a facet.
pub(super) fn read(bytes: &[u8]) -> Result<Vec<Vec3>, StlError> {
    let mut words = Words { bytes, at: 0, line: 1 };
    let mut corners = Vec::new();
    while let Some((word, line)) = words.next() {
        match word.to_ascii_lowercase().as_str() {
            // The rest of the line is a name, which may be any word.
            "solid" | "endsolid" => words.skip_line(),
            "facet" => facet(&mut words, &mut corners)?,
            _ => return Err(unexpected(line, &word, "`solid`, `facet` or `endsolid`")),
        }
    }
    Ok(corners)
}

fn facet(words: &mut Words, corners: &mut Vec<Vec3>) -> Result<(), StlError> {
    words.expect("normal", "`normal`")?;
    for _ in 0..3 {
        // Never used, and often `nan` for a facet without area.
        let (word, line) = words.next_or_end();
        if word.parse::<f32>().is_err() {
            return Err(unexpected(line, &word, "a number"));
        }
    }
    words.expect("outer", "`outer`")?;
    words.expect("loop", "`loop`")?;
    for _ in 0..3 {
        words.expect("vertex", "`vertex`, three to a facet,")?;
        let mut p = [0.0; 3];
        for value in &mut p {
            let (word, line) = words.next_or_end();
            let number = word.parse::<f32>().ok().filter(|v| v.is_finite());
            *value = number.ok_or_else(|| unexpected(line, &word, "a finite single-precision number"))?;
        }
        corners.push(Vec3::from(p));
    }
    words.expect("endloop", "`endloop` after three vertices")?;
    words.expect("endfacet", "`endfacet`")
}

fn unexpected(line: usize, token: &str, wanted: &'static str) -> StlError {
    StlError::Unexpected { line, token: token.chars().take(40).collect(), wanted }
}

/// Words with the line they are in. Lines end in LF, CR LF or CR.
struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
    line: usize,
}

impl Words<'_> {
    fn next(&mut self) -> Option<(String, usize)> {
        while self.peek()?.is_ascii_whitespace() {
            self.step();
        }
        let rest = &self.bytes[self.at..];
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.at += length;
        Some((String::from_utf8_lossy(&rest[..length]).into_owned(), self.line))
    }

    /// An empty word at the end of the file.
    fn next_or_end(&mut self) -> (String, usize) {
        self.next().unwrap_or_else(|| (String::new(), self.line))
    }

    fn expect(&mut self, word: &str, wanted: &'static str) -> Result<(), StlError> {
        let (found, line) = self.next_or_end();
        if found.eq_ignore_ascii_case(word) { Ok(()) } else { Err(unexpected(line, &found, wanted)) }
    }

    fn skip_line(&mut self) {
        while self.peek().is_some_and(|byte| !matches!(byte, b'\n' | b'\r')) {
            self.at += 1;
        }
    }

    fn peek(&self) -> Option<u8> {
        self.bytes.get(self.at).copied()
    }

    /// Over one byte of white space.
    fn step(&mut self) {
        let (byte, next) = (self.bytes[self.at], self.bytes.get(self.at + 1));
        self.line += usize::from(byte == b'\n' || (byte == b'\r' && next != Some(&b'\n')));
        self.at += 1;
    }
}
