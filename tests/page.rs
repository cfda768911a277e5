//! What a page of HTML must be, checked without a browser.

/// Elements of HTML that have no end tag.
const VOID: [&str; 7] = ["meta", "br", "hr", "img", "input", "link", "!doctype"];

/// What is opened and not closed, or closed and not open, or quoted wrongly.
pub(crate) fn unclosed(page: &str) -> Vec<String> {
    let (mut open, mut wrong): (Vec<&str>, Vec<String>) = (Vec::new(), Vec::new());
    let mut rest = page;
    while let Some(start) = rest.find('<') {
        let Some(length) = rest[start..].find('>') else { break };
        let tag = &rest[start + 1..start + length];
        if tag.contains('<') || tag.matches('"').count() % 2 == 1 {
            wrong.push(tag.into());
        }
        let name = tag.trim_start_matches('/').split([' ', '\n', '/']).next().unwrap_or_default();
        if tag.starts_with('/') {
            if open.pop() != Some(name) {
                wrong.push(tag.into());
            }
        } else if !tag.ends_with('/') && !VOID.contains(&name) {
            open.push(name);
        }
        rest = &rest[start + length + 1..];
    }
    wrong.extend(open.into_iter().map(str::to_owned));
    wrong
}

/// Contrast of two colours, 1 to 21 (Web Content Accessibility Guidelines 2.2, relative luminance).
pub(crate) fn contrast(a: &str, b: &str) -> f64 {
    let luminance = |colour: &str| -> f64 {
        let channel = |i: usize| {
            let value = f64::from(u8::from_str_radix(&colour[2 * i..2 * i + 2], 16).unwrap()) / 255.0;
            if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
        };
        0.2126 * channel(0) + 0.7152 * channel(1) + 0.0722 * channel(2)
    };
    let (a, b) = (luminance(a), luminance(b));
    (a.max(b) + 0.05) / (a.min(b) + 0.05)
}

#[test]
fn the_checks_themselves_can_fail() {
    assert!(unclosed("<!doctype html><p a=\"b\">x<br></p>").is_empty());
    for wrong in ["<p>", "<p></b>", "<p a=\"b></p>", "</p>"] {
        assert!(!unclosed(wrong).is_empty(), "{wrong}");
    }
    assert!((contrast("000000", "ffffff") - 21.0).abs() < 1e-9);
    assert!(contrast("999999", "ffffff") < 4.5);
}
