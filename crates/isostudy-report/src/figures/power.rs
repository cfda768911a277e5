//! Power against the number of participants: a panel per share and liking for a side, a line for all contrasts of a family with as many
//! questions.

use super::axis::Axis;
use super::canvas::BLACK;
use super::draft::{Unfinished, canvas_with_legend};
use super::error::FigureError;
use super::legend::Swatch;
use super::marks::Mark;
use super::scatter::Scatter;
use super::sheet::Sheet;
use crate::figure::Figure;
use crate::tables::power::WANTED;
use isostudy_inference::power::{Assumptions, Power};

const ROW: f64 = 320.0;
const PER_ROW: usize = 3;

/// The figure `power`.
///
/// # Errors
/// If drawing fails, which is not to be expected.
pub fn power_figure(assumptions: &Assumptions, all: &[Power]) -> Result<Figure, FigureError> {
    let mut kinds: Vec<(&str, usize)> = Vec::new();
    for power in all {
        if !kinds.contains(&(power.over.as_str(), power.questions)) {
            kinds.push((power.over.as_str(), power.questions));
        }
    }
    let plural = |n: usize| if n == 1 { "question" } else { "questions" };
    let mut legend: Vec<(Swatch, String)> = Vec::new();
    for (i, (over, questions)) in kinds.iter().enumerate() {
        let name = format!("{}: {questions} {}", over, plural(*questions));
        legend.push((Swatch::Mark(Mark::nth(i, true)), name));
    }
    legend.push((Swatch::Mark(Mark::nth(0, false)), "hollow: not corrected".into()));
    legend.push((Swatch::Dashes, format!("power {WANTED}")));
    let panels: Vec<[f64; 2]> = assumptions
        .side_biases
        .iter()
        .flat_map(|&side| assumptions.shares.iter().map(move |&share| [share, side]))
        .collect();
    let per_row = assumptions.shares.len().clamp(1, PER_ROW);
    let rows: Vec<&[[f64; 2]]> = panels.chunks(per_row).collect();
    let (mut canvas, top) = canvas_with_legend(Sheet::Wide, &legend, ROW * rows.len() as f64);
    for (r, row) in rows.iter().enumerate() {
        let (width, y) = (Sheet::Wide.width() / per_row as f64, top + ROW * r as f64);
        for (i, &at) in row.iter().enumerate() {
            let x = width * i as f64;
            panel(assumptions, all, at, &kinds).draw(&mut canvas, (x, y), (x + width, y + ROW));
        }
    }
    let caption = "Chance that the exact sign-flip test finds a preference that is there, by number of participants: mean over the \
                   contrasts of a family that have as many questions. Lines and filled marks are after the correction for all tests \
                   of the family, as a study is judged. Hollow marks are of each test by itself."
        .into();
    Unfinished { name: "power", caption, canvas }.finish()
}

fn panel(
    assumptions: &Assumptions,
    all: &[Power],
    [share, side_bias]: [f64; 2],
    kinds: &[(&str, usize)],
) -> Scatter {
    let (mut lines, mut marks) = (Vec::new(), Vec::new());
    for (i, &(over, questions)) in kinds.iter().enumerate() {
        let mean = |n: usize, value: fn(&Power) -> f64| {
            let of_kind = |p: &&Power| {
                (p.over.as_str(), p.questions, p.participants) == (over, questions, n)
                    && (p.share, p.side_bias) == (share, side_bias)
            };
            let found: Vec<f64> = all.iter().filter(of_kind).map(value).collect();
            (n as f64, found.iter().sum::<f64>() / found.len() as f64)
        };
        let numbers = &assumptions.participants;
        marks.extend(numbers.iter().map(|&n| (mean(n, |p| p.uncorrected), Mark::nth(i, false))));
        let line: Vec<(f64, f64)> = numbers.iter().map(|&n| mean(n, |p| p.corrected)).collect();
        marks.extend(line.iter().map(|&at| (at, Mark::nth(i, true))));
        lines.push((BLACK, line));
    }
    let side = if side_bias == 0.0 { String::new() } else { format!(", left liked by {side_bias}") };
    let most = assumptions.participants.last().copied().unwrap_or(1);
    Scatter {
        heading: format!("{:.0} % of decided answers for one{side}", share * 100.0),
        labels: ("participants".into(), "power".into()),
        x: Axis::from_zero(most as f64),
        y: Axis::up_to(1.0),
        lines,
        dashed: Some(WANTED),
        marks,
        names: Vec::new(),
    }
}
