//! Answers per question: left, none and right, stacked and centred on none.

use super::canvas::{Align, BLACK, Canvas};
use super::draft::{Unfinished, canvas_with_legend};
use super::legend::Swatch;
use super::sheet::Sheet;
use super::style::{Fill, LEFT, NONE, RIGHT};
use isostudy_design::Study;
use isostudy_inference::tally::{QuestionCount, Tally};

const ROW: f64 = 21.0;
const HEADING: f64 = 30.0;
/// Room for a question's id and left configuration, and for its right configuration; on a narrow sheet they stand above the bar.
const LABELS: (f64, f64) = (180.0, 90.0);
const NARROW_ROW: f64 = 38.0;

pub(super) fn per_question(study: &Study, tally: &Tally, sides_differ: bool, sheet: Sheet) -> Unfinished {
    let blocks: Vec<(usize, Vec<usize>)> = (0..study.file.objects.len())
        .map(|o| (o, (0..study.comparisons.len()).filter(|&c| study.comparisons[c].object == o).collect()))
        .filter(|(_, questions): &(usize, Vec<usize>)| !questions.is_empty())
        .collect();
    let legend = [
        (Swatch::Area(Fill::plain(LEFT)), "left of the row preferred".to_owned()),
        (Swatch::Area(Fill::plain(NONE)), "no preference".to_owned()),
        (Swatch::Area(Fill::plain(RIGHT)), "right of the row preferred".to_owned()),
    ];
    let row = sheet.length(ROW, NARROW_ROW);
    let height = HEADING * blocks.len() as f64 + row * study.comparisons.len() as f64;
    let (mut canvas, mut y) = canvas_with_legend(sheet, &legend, height);
    let (em, width, scale) = (sheet.em(), sheet.width(), Scale::of(tally, sheet));
    for (object, questions) in blocks {
        canvas.text(&study.file.objects[object].name, (scale.centre, y + HEADING - 9.0), 12.5, Align::Middle);
        y += HEADING;
        for question in questions {
            let comparison = &study.comparisons[question];
            let (left, right) = (comparison.left.to_string(), comparison.right.to_string());
            match sheet {
                Sheet::Wide => {
                    let baseline = y + ROW / 2.0 + 4.0;
                    canvas.text(&comparison.question, (80.0, baseline), em, Align::Start);
                    canvas.text(left, (LABELS.0 - 10.0, baseline), em, Align::End);
                    canvas.text(right, (width - LABELS.1 + 10.0, baseline), em, Align::Start);
                }
                Sheet::Narrow => {
                    let baseline = y + 13.0;
                    canvas.text(
                        format!("{}: {left}", comparison.question),
                        (0.0, baseline),
                        em,
                        Align::Start,
                    );
                    canvas.text(right, (width, baseline), em, Align::End);
                }
            }
            bar(&mut canvas, &scale, tally.questions[question], (y + row - ROW + 2.0, y + row - 2.0));
            y += row;
        }
    }
    let caption = format!(
        "Answers of {} to each question, centred on no preference. The configurations stand as the study lists them{}.",
        isostudy_table::digits::counted(tally.people(), "participant"),
        match sides_differ {
            true => ", not on the side where each person saw them",
            false => ", and everybody saw them on these sides",
        }
    );
    Unfinished { name: "answers", caption, canvas }
}

/// Where zero lies and how wide an answer is.
struct Scale {
    centre: f64,
    unit: f64,
}

impl Scale {
    /// The widest bar to each side just fits.
    fn of(tally: &Tally, sheet: Sheet) -> Self {
        let reach = |side: fn(&QuestionCount) -> u64| {
            let half = |q: &QuestionCount| side(q) as f64 + q.none as f64 / 2.0;
            tally.questions.iter().map(half).fold(0.0, f64::max)
        };
        let (left, right) = (reach(|q| q.left), reach(|q| q.right));
        let labels = if sheet.is_narrow() { (0.0, 0.0) } else { LABELS };
        let unit = (sheet.width() - labels.0 - labels.1) / (left + right).max(1.0);
        Self { centre: labels.0 + left * unit, unit }
    }
}

fn bar(canvas: &mut Canvas, scale: &Scale, count: QuestionCount, (top, bottom): (f64, f64)) {
    let QuestionCount { left, none, right } = count;
    // Under the bar, so that it strikes through no number.
    canvas.line(vec![(scale.centre, top - 2.0), (scale.centre, bottom + 2.0)], BLACK, 0.5);
    // A little smaller than other numbers, where there is no need to be.
    let em = canvas.sheet().length(10.5, canvas.sheet().em());
    let mut x = scale.centre - scale.unit * (left as f64 + none as f64 / 2.0);
    for (count, colour) in [(left, LEFT), (none, NONE), (right, RIGHT)] {
        let end = x + scale.unit * count as f64;
        let fill = Fill::plain(colour);
        if count > 0 {
            fill.paint(canvas, (x, top), (end, bottom));
        }
        if count > 0 && end - x > super::canvas::text_width(&count.to_string(), em) + 4.0 {
            let at = ((x + end) / 2.0, (top + bottom) / 2.0 + 4.0);
            canvas.text_in(count.to_string(), at, em, Align::Middle, fill.ink());
        }
        x = end;
    }
}
