//! A line of text for each point.

use glam::Vec3;

use super::{PointCloud, PointsError, number, text};

pub(super) fn read(bytes: &[u8]) -> Result<PointCloud, PointsError> {
    let text = text(bytes);
    let mut cloud = PointCloud::default();
    // How many values each point has: 3 or 6.
    let mut before = None;
    for (line, written) in (1..).zip(text.trim_start_matches('\u{feff}').lines()) {
        let written = written.trim();
        if written.is_empty() || written.starts_with('#') || written.starts_with("//") {
            continue;
        }
        let words =
            written.split(|c: char| c.is_whitespace() || c == ',' || c == ';').filter(|w| !w.is_empty());
        let mut values = [0.0; 6];
        let mut got = 0;
        for (value, word) in values.iter_mut().zip(words) {
            *value = number(line, word)?;
            got += 1;
        }
        match before {
            _ if got != 3 && got != 6 => return Err(PointsError::Values { line, got }),
            Some(before) if got != before => return Err(PointsError::Uneven { line, got, before }),
            _ => before = Some(got),
        }
        cloud.positions.push(Vec3::from_slice(&values[..3]));
        cloud.lines.push(line as u32);
        if got == 6 {
            cloud.normals.push(Vec3::from_slice(&values[3..]));
        }
    }
    Ok(cloud)
}
