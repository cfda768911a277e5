//! How far each respondent agrees with the others.

use super::axis::Axis;
use super::bars::{Bar, BarPanel, Cluster, Slot, rows_of_panels};
use super::draft::{Unfinished, canvas_with_legend};
use super::forest::{self, Block, Row};
use super::legend::Swatch;
use super::marks::Mark;
use super::sheet::Sheet;
use super::style::{Fill, LEFT};
use isostudy_inference::majorities::Majorities;
use isostudy_statistics::Screening;

/// Up to so many people have a row of their own; more are counted in steps of a twentieth.
const ROWS: usize = 60;
const STEPS: usize = 20;
const NAME: &str = "respondents";

pub(super) fn draft(majorities: &Majorities, sheet: Sheet) -> Option<Unfinished> {
    let screened: Vec<&Screening> = majorities.seen.iter().filter(|s| s.comparable > 0).collect();
    if screened.is_empty() {
        return None;
    }
    Some(if screened.len() <= ROWS { one_by_one(screened, sheet) } else { counted(&screened, sheet) })
}

const SAYS: &str = "share of a respondent's decided answers that side with the majority of the others, where they have one; half \
                    is what answering by chance gives.";

fn one_by_one(mut screened: Vec<&Screening>, sheet: Sheet) -> Unfinished {
    screened.sort_by(|a, b| {
        let share = |s: &Screening| s.agreement().unwrap_or_default();
        share(b).total_cmp(&share(a)).then(a.participant.cmp(&b.participant))
    });
    let row = |s: &&Screening| {
        let [left, none, right] = s.answers;
        let share = s.agreement();
        Row {
            label: format!("respondent {}", s.participant + 1),
            value: share,
            interval: None,
            mark: Mark::nth(0, share.is_some_and(|share| share >= 0.5)),
            remark: format!("{} of {}; left {left}, none {none}, right {right}", s.agreeing, s.comparable),
        }
    };
    let rows: Vec<Row> = screened.iter().map(row).collect();
    let blocks = [Block { heading: String::new(), rows }];
    let legend = [
        (Swatch::Mark(Mark::nth(0, true)), "with the others half the time or more".to_owned()),
        (Swatch::Mark(Mark::nth(0, false)), "less than half".to_owned()),
    ];
    let (mut canvas, top) = canvas_with_legend(sheet, &legend, forest::height(sheet, &blocks));
    forest::draw(&mut canvas, &blocks, &Axis::up_to(1.0), "agreement with the others", 0.5, top);
    Unfinished { name: NAME, caption: format!("Agreement between respondents: {SAYS}"), canvas }
}

fn counted(screened: &[&Screening], sheet: Sheet) -> Unfinished {
    let mut counts = [0_u64; STEPS];
    for share in screened.iter().filter_map(|s| s.agreement()) {
        counts[((share * STEPS as f64) as usize).min(STEPS - 1)] += 1;
    }
    let slot = |(i, &count): (usize, &u64)| Slot {
        label: format!("{:.2}", i as f64 / STEPS as f64),
        bars: vec![Bar::of(Some(count as f64), Fill::plain(LEFT), None)],
    };
    let clusters = vec![Cluster {
        label: "agreement with the others, from".into(),
        slots: counts.iter().enumerate().map(slot).collect(),
    }];
    let panel = BarPanel::from_zero("respondents", clusters);
    let canvas = rows_of_panels(sheet, &[], vec![vec![(1.0, panel)]], 340.0);
    Unfinished {
        name: NAME,
        caption: format!("Agreement between {} respondents: {SAYS}", screened.len()),
        canvas,
    }
}
