//! The published factor against the share of wins over appearances: two scales in one sum.

use super::axis::Axis;
use super::canvas::BLACK;
use super::legend::Swatch;
use super::marks::Mark;
use super::scatter::Scatter;
use super::{Unfinished, WIDTH, canvas_with_legend};
use crate::fraction::Fraction;
use crate::preference::group_factors;
use crate::tally::Tally;
use design::Study;

const HEIGHT: f64 = 430.0;

pub(super) fn draft(study: &Study, tally: &Tally) -> Option<Unfinished> {
    let factors = group_factors(study, tally, |_| true);
    let mut caps: Vec<Fraction> = Vec::new();
    for factor in &factors {
        if !caps.contains(&factor.cap()) {
            caps.push(factor.cap());
        }
    }
    if factors.is_empty() {
        return None;
    }
    let groups_of = |cap: Fraction| -> String {
        let mut names: Vec<&str> = Vec::new();
        for factor in factors.iter().filter(|f| f.cap() == cap) {
            let id = study.groups[factor.group].id.as_str();
            if !names.contains(&id) {
                names.push(id);
            }
        }
        names.join(", ")
    };
    let entry = |(i, &cap): (usize, &Fraction)| {
        let largest = cap.to_string();
        let largest = largest.strip_suffix("/1").unwrap_or(&largest).to_owned();
        (Swatch::Mark(Mark::nth(i, true)), format!("groups {}: at most {largest}", groups_of(cap)))
    };
    let mut legend: Vec<(Swatch, String)> = caps.iter().enumerate().map(entry).collect();
    legend.push((Swatch::Line(BLACK), "what a factor of such a group can be".into()));
    let mut marks = Vec::new();
    let mut names = Vec::new();
    for (i, cap) in caps.iter().enumerate() {
        let mut own: Vec<(f64, f64, String)> = factors
            .iter()
            .filter(|f| f.cap() == *cap)
            .filter_map(|f| {
                let name = format!("{} in {}", f.method, study.groups[f.group].id);
                Some((f.share.factor().value(), f.appearance_share()?.value(), name))
            })
            .collect();
        own.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (factor, share, name) in own {
            marks.push(((factor, share), Mark::nth(i, true)));
            names.push(((factor, share), name));
        }
    }
    let panel = Scatter {
        heading: String::new(),
        labels: ("preference factor, as published".into(), "wins / appearances".into()),
        x: Axis::up_to(1.0),
        y: Axis::up_to(1.0),
        lines: caps.iter().map(|cap| (BLACK, vec![(0.0, 0.0), (cap.value(), 1.0)])).collect(),
        dashed: None,
        marks,
        names,
    };
    let (mut canvas, top) = canvas_with_legend(&legend, HEIGHT);
    panel.draw(&mut canvas, (60.0, top), (WIDTH - 120.0, top + HEIGHT));
    let caption = "Preference factors against shares: a configuration's wins over all answers to its group's questions, as published, \
                   and over the answers to those questions that show it. Lines of different slope are factors on different scales."
        .into();
    Some(Unfinished { name: "factor_share", caption, canvas })
}
