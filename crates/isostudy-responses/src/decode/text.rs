//! From bytes to text: encodings and separators.

use crate::decode::records::{Record, Records};
use crate::error::Fault;
use encoding_rs::{UTF_16BE, UTF_16LE, WINDOWS_1252};
use std::borrow::Cow;

/// Decodes a file's bytes: by byte-order mark, else UTF-16 by its zero bytes, else UTF-8, else Windows-1252. Returns the
/// text without the mark, and which rule fired.
///
/// # Errors
/// [`Fault::Encoding`] with the row, where text that announces an encoding does not keep to it.
pub(crate) fn decode(bytes: &[u8]) -> Result<(Cow<'_, str>, &'static str), Fault> {
    if let Some(rest) = bytes.strip_prefix(b"\xef\xbb\xbf") {
        return utf8(rest).map(|text| (text, "UTF-8 by its byte-order mark"));
    }
    if let Some(rest) = bytes.strip_prefix(b"\xff\xfe") {
        return utf16(UTF_16LE, rest).map(|text| (text, "UTF-16, little end first, by its byte-order mark"));
    }
    if let Some(rest) = bytes.strip_prefix(b"\xfe\xff") {
        return utf16(UTF_16BE, rest).map(|text| (text, "UTF-16, big end first, by its byte-order mark"));
    }
    // Every second byte of Western text in UTF-16 is zero, and no byte of it in UTF-8; and its first line ends as lines do in
    // UTF-16, which those of a damaged file in UTF-8 do not.
    let feed = bytes.iter().position(|&byte| byte == b'\n');
    let ends_line = |offset: usize| feed.is_none_or(|at| at % 2 == offset && bytes.get(at ^ 1) == Some(&0));
    let head = &bytes[..bytes.len().min(1 << 12) & !1];
    let zeros = |offset: usize| head.iter().skip(offset).step_by(2).filter(|&&byte| byte == 0).count();
    let (even, odd, most) = (zeros(0), zeros(1), head.len() / 4);
    if head.len() >= 4 && odd > most && even < odd / 8 && ends_line(0) {
        return utf16(UTF_16LE, bytes).map(|text| (text, "UTF-16, little end first, by its zero bytes"));
    }
    if head.len() >= 4 && even > most && odd < even / 8 && ends_line(1) {
        return utf16(UTF_16BE, bytes).map(|text| (text, "UTF-16, big end first, by its zero bytes"));
    }
    if let Ok(text) = std::str::from_utf8(bytes) {
        return Ok((Cow::Borrowed(text), "UTF-8, which it keeps to"));
    }
    let (text, _) = WINDOWS_1252.decode_without_bom_handling(bytes);
    Ok((text, "Windows-1252, since it is not UTF-8"))
}

fn utf8(bytes: &[u8]) -> Result<Cow<'_, str>, Fault> {
    std::str::from_utf8(bytes).map(Cow::Borrowed).map_err(|error| {
        let row = 1 + bytes[..error.valid_up_to()].iter().filter(|&&byte| byte == b'\n').count() as u64;
        Fault::Encoding { encoding: "UTF-8", row }
    })
}

fn utf16<'a>(encoding: &'static encoding_rs::Encoding, bytes: &'a [u8]) -> Result<Cow<'a, str>, Fault> {
    match encoding.decode_without_bom_handling(bytes) {
        (text, false) => Ok(text),
        (text, true) => {
            let valid = text.split('\u{fffd}').next().unwrap_or("");
            let row = 1 + valid.bytes().filter(|&byte| byte == b'\n').count() as u64;
            Err(Fault::Encoding { encoding: encoding.name(), row })
        }
    }
}

/// Which separator splits the text: the declared one, that of a first line `sep=;`, or the one of `,` `;` tab that
/// makes rows of most and equally many cells. Also the text after such a first line, and the rule.
///
/// # Errors
/// [`Fault::Separators`] if two of them fit equally well.
pub(crate) fn separator(text: &str, declared: Option<u8>) -> Result<(u8, &str, &'static str), Fault> {
    let (line, rest) = text.split_once('\n').unwrap_or((text, ""));
    if let [b's' | b'S', b'e' | b'E', b'p' | b'P', b'=', own @ (b',' | b';' | b'\t' | b'|')] =
        line.trim_end_matches('\r').as_bytes()
    {
        return Ok((declared.unwrap_or(*own), rest, "named by the first line"));
    }
    if let Some(declared) = declared {
        return Ok((declared, text, "declared"));
    }
    const ROWS: usize = 20;
    let width = |separator: u8| {
        let (mut records, mut record) = (Records::new(text, separator), Record::default());
        let mut widths = Vec::new();
        while widths.len() < ROWS && records.read(&mut record).unwrap_or(false) {
            if !record.is_blank() {
                widths.push(record.cells.len());
            }
        }
        let first = widths.first().copied().unwrap_or(0);
        (widths.iter().all(|&width| width == first), first)
    };
    // Even rows beat uneven ones, then the wider header wins.
    let fits = |separator: u8| {
        let (even, width) = width(separator);
        (width > 1, even, width)
    };
    let mut found = [b',', b';', b'\t'].map(|separator| (fits(separator), separator));
    found.sort_unstable_by(|a, b| b.cmp(a));
    let [(best, separator), (second, other), _] = found;
    if best == second && best.0 {
        let (first, second) = (separator.min(other).into(), separator.max(other).into());
        return Err(Fault::Separators { first, second, cells: best.2 });
    }
    Ok((separator, text, if best.0 { "the one that splits rows evenly" } else { "none: one column" }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn encodings_are_told_by_mark_zeros_and_validity() {
        let text = "Täglich,✓\n";
        let wide = |end: fn(u16) -> [u8; 2]| text.encode_utf16().flat_map(end).collect::<Vec<u8>>();
        let (little, big) = (wide(u16::to_le_bytes), wide(u16::to_be_bytes));
        for bytes in [
            text.as_bytes().to_vec(),
            [b"\xef\xbb\xbf", text.as_bytes()].concat(),
            [b"\xff\xfe", little.as_slice()].concat(),
            [b"\xfe\xff", big.as_slice()].concat(),
            little,
            big,
        ] {
            assert_eq!(decode(&bytes).unwrap().0, text, "{bytes:?}");
        }
        assert_eq!(decode(b"T\xe4glich \x80\n").unwrap().0, "Täglich €\n");
        assert_eq!(decode(b"").unwrap().0, "");
        // A header in UTF-8 over a cell full of zero bytes.
        let damaged = [b"name,choice\n".as_slice(), &b"x\0".repeat(40)].concat();
        assert_eq!(decode(&damaged).unwrap().1, "UTF-8, which it keeps to");
        let broken = decode(b"\xef\xbb\xbfa\nb\xff\n").unwrap_err();
        assert_eq!(broken, Fault::Encoding { encoding: "UTF-8", row: 2 });
        let lone = decode(b"\xff\xfea\0\n\0\x00\xd8x\0").unwrap_err();
        assert_eq!(lone, Fault::Encoding { encoding: "UTF-16LE", row: 2 });
    }

    #[test]
    fn separators_are_counted_outside_quotes() {
        let found = |text: &str| separator(text, None).map(|(byte, ..)| byte as char);
        assert_eq!(found("\"a;b;c\",d\n1,2\n"), Ok(','));
        assert_eq!(found("Id;\"Left, or right?\"\n1;Left\n"), Ok(';'));
        assert_eq!(found("Id;Which, of these, is it?\n1;Left\n"), Ok(';'));
        assert_eq!(found("a\tb\n1\t2\n"), Ok('\t'));
        assert_eq!(found("sep=;\na;b\n"), Ok(';'));
        assert!(matches!(found("a,b;c\n1,2;3\n"), Err(Fault::Separators { cells: 2, .. })));
        assert_eq!(separator("sep=;\na;b\n", None).unwrap().1, "a;b\n");
    }
}
