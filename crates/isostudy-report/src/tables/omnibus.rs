//! The table of Friedman's tests.

use isostudy_design::{Level, Study};
use isostudy_inference::omnibus::{Asked, Omnibus};
use isostudy_table::{Cell, Columns, Table};

/// The question, and the scores that it is asked of.
fn asked(study: &Study, asked: Asked) -> [String; 2] {
    let minus = |[a, b]: [Level; 2]| format!("{} minus {}", study.level(a).label, study.level(b).label);
    let name = |levels: [Level; 2]| study.factor(levels[0].factor).name.as_str();
    match asked {
        Asked::Levels(factor) => {
            let name = &study.factor(factor).name;
            [name.clone(), format!("wins minus losses of each {name}")]
        }
        Asked::ByOther(levels, other) => {
            let other = &study.factor(other).name;
            [format!("{} x {other}", name(levels)), format!("{}, by {other}", minus(levels))]
        }
        Asked::ByObject(levels) => {
            [format!("object x {}", name(levels)), format!("{}, by object", minus(levels))]
        }
    }
}

/// Friedman's tests: does anything differ at all?
pub(super) fn omnibus(study: &Study, tests: &[Omnibus]) -> Table {
    let caption = "Does anything differ? Friedman's tests over participants";
    let table = Columns::over(tests.iter().map(|of| (study, of)))
        .column("question", "Question", |(study, of)| Cell::text(asked(study, of.asked)[0].as_str()))
        .column("scores", "Scores", |(study, of)| Cell::text(asked(study, of.asked)[1].as_str()))
        .column("chi_square", "Chi-square", |(_, of)| Cell::Number(of.test.statistic, 3))
        .column("degrees", "Degrees", |(_, of)| Cell::Number(of.test.degrees, 0))
        .column("p", "p", |(_, of)| Cell::P(of.test.p, 5))
        .column("p_adjusted", "p adjusted", |(_, of)| Cell::P(of.adjusted, 5))
        .column("participants", "Participants", |(_, of)| Cell::count(of.participants as u64))
        .into_table("omnibus", caption);
    table.with_note(
        "Chi-square approximation with correction for ties. The blocks are the participants who answered something of each \
         column; a score is the mean of their answers there. p adjusted: Holm over the rows that ask the same of other pairs.",
    )
}

#[cfg(test)]
mod tests_of_the_paper {
    use super::*;
    use crate::fixture;

    #[test]
    fn does_anything_differ() {
        let study = fixture::study();
        let table =
            omnibus(&study, &isostudy_inference::omnibus::tests(&study, &fixture::answered(&study).declared));
        // SciPy 1.17.1 friedmanchisquare on the same sums: Q = 23.690; 9.9692, p 0.006842; 19.9062, p 0.00004758.
        let shown: Vec<String> = table
            .shown_rows()
            .iter()
            .map(|row| [&row[0], &row[1], &row[2], &row[3], &row[4], &row[6]].map(String::as_str).join(" "))
            .collect();
        for want in [
            "clustering wins minus losses of each clustering 23.690 2 < 0.00001 18",
            "arrangement x clustering body-centred minus simple cubic, by clustering 9.969 2 0.00684 18",
            "object x arrangement body-centred minus simple cubic, by object 19.906 2 0.00005 18",
        ] {
            assert!(shown.iter().any(|row| row == want), "{want}\n{shown:#?}");
        }
        // And the three pairs of clusterings by object.
        assert_eq!(shown.len(), 6);
    }
}
