//! Runs that were kept: totals from one to the next.

use super::axis::Axis;
use super::draft::{Unfinished, canvas_with_legend};
use super::error::FigureError;
use super::legend::Swatch;
use super::marks::Mark;
use super::scatter::Scatter;
use super::sheet::Sheet;
use super::style;
use crate::figure::Figure;
use isostudy_timing::history::Step;

const HEIGHT: f64 = 380.0;

/// Totals over those of the first run, a line for each configuration and marks for their geometric mean; `None` of fewer than
/// two runs, which have no way between them.
///
/// # Errors
/// If drawing fails, which is not to be expected.
pub fn history_figure(steps: &[Step]) -> Result<Option<Figure>, FigureError> {
    draft(steps).map(Unfinished::finish).transpose()
}

fn draft(steps: &[Step]) -> Option<Unfinished> {
    if steps.len() < 2 {
        return None;
    }
    let mut ids: Vec<_> = steps.iter().flat_map(|step| step.ratios.keys()).collect();
    ids.sort();
    ids.dedup();
    let numbered = || (1_u32..).map(f64::from).zip(steps);
    let line = |id| numbered().filter_map(|(x, step)| Some((x, *step.ratios.get(id)?))).collect::<Vec<_>>();
    let mut lines: Vec<_> = ids.iter().map(|id| (style::IDEAL, line(id))).collect();
    let means: Vec<(f64, f64)> = numbered().filter_map(|(x, step)| Some((x, step.mean?))).collect();
    let heights = || lines.iter().flat_map(|(_, line)| line).map(|at| at.1).chain([1.0]);
    let (low, high) = (heights().fold(f64::MAX, f64::min), heights().fold(f64::MIN, f64::max));
    let mark = Mark::nth(0, true);
    lines.push((super::canvas::BLACK, means.clone()));
    let legend = [
        (Swatch::Mark(mark), "geometric mean".to_owned()),
        (Swatch::Line(style::IDEAL), "a configuration".to_owned()),
        (Swatch::Dashes, "as the first".to_owned()),
    ];
    let (mut canvas, top) = canvas_with_legend(Sheet::Wide, &legend, HEIGHT);
    let panel = Scatter {
        heading: "Median totals over those of the first run".into(),
        labels: ("run, in the order kept".into(), "over the first".into()),
        x: Axis::whole(1, steps.len() as u32),
        y: Axis::spanning(low, high),
        lines,
        dashed: Some(1.0),
        marks: means.into_iter().map(|at| (at, mark)).collect(),
        names: Vec::new(),
    };
    panel.draw(&mut canvas, (0.0, top), (Sheet::Wide.width(), top + HEIGHT));
    let caption = "Runs that were kept. Verdicts are given by isostudy bench compare, and not here.".into();
    Some(Unfinished { name: "history", caption, canvas })
}

#[cfg(test)]
mod tests {
    use super::*;
    use isostudy_timing::history::{Kept, history};

    fn kept(total: f64) -> Kept {
        let id: isostudy_design::ConfigurationId = "ss_bi".parse().unwrap();
        Kept {
            name: "main".into(),
            commit: None,
            model: None,
            rounds: 10,
            workloads: Default::default(),
            totals_s: [(id, total)].into(),
            reference_s: None,
        }
    }

    #[test]
    fn it_is_drawn_within_its_frame_where_there_is_a_way_to_draw() {
        let steps = history(&[kept(1.0), kept(1.3), kept(0.7)]);
        let draft = draft(&steps).expect("three runs");
        assert_eq!(draft.canvas.texts_outside(), Vec::<String>::new());
        assert!(history_figure(&steps[..1]).unwrap().is_none());
    }
}
