//! From where participants looked at models that they turned.

use isostudy_design::forms::KeyEntry;
use isostudy_table::formula::escape;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;

/// Most bytes of an answer's cameras, as JSON. The page sends fewer a second where there would be more.
pub const LARGEST: usize = 200_000;
/// Numbers of each camera.
const NUMBERS: usize = 4;
/// Cameras per second at most.
const MOST_HZ: f64 = 20.0;

/// The cameras of one answer, in the order of their times: as the page sends them, as they are kept, and in its downloads.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Track {
    /// Cameras per second at most while the models were turned; nothing was noted while they stood still.
    pub hz: f64,
    /// Four whole numbers each: milliseconds since the pair was seen; azimuth from +x to +y and elevation over the horizon, in
    /// tenths of a degree; distance from the middle, in thousandths of the first one.
    pub cameras: Vec<i32>,
}

impl Track {
    /// Whether a page can have sent it.
    pub fn is_sound(&self) -> bool {
        let each = self.cameras.chunks(NUMBERS);
        let times = each.clone().map(|camera| camera[0]);
        let is_camera = |camera: &[i32]| {
            camera.len() == NUMBERS
                && (0..=crate::screen::LONGEST_MS as i32).contains(&camera[0])
                && (-900..=900).contains(&camera[2])
                && (1..=1_000_000).contains(&camera[3])
        };
        self.hz > 0.0
            && self.hz <= MOST_HZ
            && each.clone().all(is_camera)
            && times.is_sorted()
            && !self.cameras.is_empty()
            && self.text().len() <= LARGEST
    }

    /// As JSON.
    pub(crate) fn text(&self) -> String {
        serde_json::to_string(self).expect("numbers alone")
    }

    /// Milliseconds, degrees of azimuth and elevation, and the distance as a multiple of the first one.
    pub fn cameras(&self) -> impl Iterator<Item = (i32, f64, f64, f64)> {
        let tenths = |value: i32| f64::from(value) / 10.0;
        self.cameras
            .chunks_exact(NUMBERS)
            .map(move |c| (c[0], tenths(c[1]), tenths(c[2]), f64::from(c[3]) / 1000.0))
    }
}

/// A track, and which answer's it is.
#[derive(Debug, Clone, PartialEq)]
pub struct Tracked {
    /// The participant's name in the answers.
    pub participant: String,
    /// The form's number, from 1.
    pub form: usize,
    /// Place in the form, from 1, training included.
    pub order: u32,
    /// Code name of the pair.
    pub stimulus: String,
    /// From where it was looked at.
    pub track: Track,
}

/// Columns of `cameras.csv`.
pub const HEADER: [&str; 10] = [
    "participant",
    "form",
    "order",
    "question",
    "stimulus",
    "hz",
    "t_ms",
    "azimuth_deg",
    "elevation_deg",
    "distance",
];

/// `cameras.csv`: a row for each camera. No text is a formula to a spreadsheet; numbers are as they are, the negative ones too.
pub fn csv(all: &[Tracked], key: &[KeyEntry]) -> String {
    let asked: HashMap<(usize, usize), &str> =
        key.iter().map(|entry| ((entry.form, entry.order), entry.question.as_str())).collect();
    let write = || -> Result<String, Box<dyn std::error::Error>> {
        let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(Vec::new());
        writer.write_record(HEADER)?;
        for of in all {
            let question = asked.get(&(of.form, of.order as usize)).copied().unwrap_or_default();
            let texts = [of.participant.as_str(), question, of.stimulus.as_str()];
            let [participant, question, stimulus] = texts.map(escape);
            for (t_ms, azimuth, elevation, distance) in of.track.cameras() {
                let answer = (&participant, of.form, of.order, &question, &stimulus);
                writer.serialize((answer, of.track.hz, t_ms, azimuth, elevation, distance))?;
            }
        }
        Ok(String::from_utf8(writer.into_inner()?)?)
    };
    write().expect("memory takes everything, and texts are UTF-8")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track(cameras: &[i32]) -> Track {
        Track { hz: 20.0, cameras: cameras.into() }
    }

    #[test]
    fn only_what_a_page_can_have_sent_is_sound() {
        let sound = track(&[0, 450, 222, 1000, 50, -3150, -12, 500]);
        assert!(sound.is_sound());
        assert_eq!(sound.text(), r#"{"hz":20.0,"cameras":[0,450,222,1000,50,-3150,-12,500]}"#);
        for wrong in [
            track(&[]),
            track(&[0, 450, 222]),
            track(&[50, 450, 222, 1000, 0, 450, 222, 1000]),
            track(&[-1, 450, 222, 1000]),
            track(&[0, 450, 901, 1000]),
            track(&[0, 450, 222, 0]),
            Track { hz: 21.0, ..sound.clone() },
            Track { hz: f64::NAN, ..sound.clone() },
            track(&[86_000_000, 3600, 900, 1000].repeat(10_000)),
        ] {
            assert!(!wrong.is_sound(), "{:?}", &wrong.cameras[..wrong.cameras.len().min(8)]);
        }
    }

    #[test]
    fn a_row_is_a_camera() {
        let of = |order, track| Tracked {
            participant: "ab".into(),
            form: 2,
            order,
            stimulus: "tani".into(),
            track,
        };
        let all = [of(2, track(&[0, 450, 222, 1000, 50, 465, 220, 900])), of(3, track(&[7, -31, -900, 1]))];
        assert_eq!(
            csv(&all, &[]),
            "participant,form,order,question,stimulus,hz,t_ms,azimuth_deg,elevation_deg,distance\n\
             ab,2,2,,tani,20.0,0,45.0,22.2,1.0\nab,2,2,,tani,20.0,50,46.5,22.0,0.9\nab,2,3,,tani,20.0,7,-3.1,-90.0,0.001\n"
        );
    }
}
