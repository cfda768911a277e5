//! Faults of finished animations.

use super::{Fault, Rule};
use crate::study::Study;

/// What can be known of an animation without knowing what it shows.
#[derive(Debug, Clone, PartialEq)]
pub struct StimulusFacts {
    /// File name.
    pub file: String,
    /// Frames.
    pub frames: u32,
    /// Duration of the loop in centiseconds.
    pub duration_cs: u32,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Colour of the background.
    pub background: [u8; 3],
    /// Camera: distance, field of view, elevation; where it is known.
    pub camera: Option<[f64; 3]>,
    /// The colours it is drawn with, in the order of its file: those of the shading, whatever is shown.
    pub palette: Vec<[u8; 3]>,
    /// Mean brightness of what is not background, 0 to 1.
    pub exposure: f64,
    /// Text in the file: comments, titles, tool names.
    pub text: Vec<String>,
}

/// Brightness by which the halves of a pair may differ, as a share of the darker one's. Not zero, since methods differ in shape:
/// by 2.3 % at most between the paper's, by 6.4 % in the same study made from coarse meshes (`configs/quick.toml`).
pub const EXPOSURE_TOLERANCE: f64 = 0.1;

/// The faults of the animations of pairs: `pairs` holds the two sides of each, with the name of the pair. Names and
/// text must not contain the id of a configuration of the study.
pub fn lint_stimuli(study: &Study, pairs: &[(String, StimulusFacts, StimulusFacts)]) -> Vec<Fault> {
    let mut faults = Vec::new();
    for (pair, left, right) in pairs {
        let mut differ = |what: &str, a: String, b: String| {
            let evidence = format!("{what}: {a} on the left, {b} on the right");
            faults.push(Fault { rule: Rule::StimuliDiffer, place: pair.clone(), evidence });
        };
        let mut compare = |what: &str, a: String, b: String| {
            if a != b {
                differ(what, a, b);
            }
        };
        compare("frames", left.frames.to_string(), right.frames.to_string());
        compare("duration", format!("{} cs", left.duration_cs), format!("{} cs", right.duration_cs));
        compare("size", format!("{:?}", left.size), format!("{:?}", right.size));
        compare("background", format!("{:?}", left.background), format!("{:?}", right.background));
        compare("camera", camera(left), camera(right));
        if let Some((a, b)) = first_difference(&left.palette, &right.palette) {
            compare("colours", a, b);
        }
        let (dark, bright) = (left.exposure.min(right.exposure), left.exposure.max(right.exposure));
        if bright > dark * (1.0 + EXPOSURE_TOLERANCE) {
            differ("exposure", format!("{:.3}", left.exposure), format!("{:.3}", right.exposure));
        }
        for facts in [left, right] {
            let told = |text: &str| {
                let id = study.configurations.iter().map(|c| c.id.to_string()).find(|id| text.contains(id));
                id.map(|id| format!("\"{text}\" names {id}"))
            };
            let texts = std::iter::once(&facts.file).chain(&facts.text);
            for evidence in texts.filter_map(|text| told(text)) {
                faults.push(Fault { rule: Rule::NamesReveal, place: facts.file.clone(), evidence });
            }
        }
    }
    faults.sort_by_key(|fault| fault.rule);
    faults.dedup();
    faults
}

fn camera(facts: &StimulusFacts) -> String {
    facts.camera.map_or_else(
        || "not known".into(),
        |[distance, field, elevation]| {
            format!("distance {distance}, field of view {field} rad, elevation {elevation} rad")
        },
    )
}

/// The first colours at one place that differ, as `#rrggbb`, and how many do.
fn first_difference(left: &[[u8; 3]], right: &[[u8; 3]]) -> Option<(String, String)> {
    let name = |colour: Option<&[u8; 3]>| {
        colour.map_or_else(|| "none".into(), |[r, g, b]| format!("#{r:02x}{g:02x}{b:02x}"))
    };
    let count = left.len().max(right.len());
    let mut differing = (0..count).filter(|&i| left.get(i) != right.get(i));
    let first = differing.next()?;
    let others = differing.count();
    let more = if others == 0 { String::new() } else { format!(" and {others} more") };
    Some((format!("{}{more}", name(left.get(first))), format!("{}{more}", name(right.get(first)))))
}
