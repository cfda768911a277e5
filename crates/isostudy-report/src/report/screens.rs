//! Whether it mattered on what screens people answered.

use crate::statement::{Finding, Standing};
use crate::words::{counted, list, p as p_value};
use isostudy_inference::screens::{Compared, Turned};

/// `level` is that of tests, after correction.
pub(super) fn finding(compared: &[Compared], level: f64) -> Option<Finding> {
    if compared.is_empty() {
        return None;
    }
    let (tested, others): (Vec<&Compared>, Vec<&Compared>) = compared.iter().partition(|of| of.p.is_some());
    let mut alike: Vec<&str> = others.iter().map(|of| of.condition.name).collect();
    alike.dedup();
    let adjusted = |of: &Compared| of.adjusted.unwrap_or(1.0);
    let percent =
        |share: Option<f64>| share.map_or_else(String::new, |share| format!("{:.0} %", 100.0 * share));
    let mut said = match tested.iter().map(|of| adjusted(of)).min_by(f64::total_cmp) {
        None => {
            "Everybody answered on the same kind of screen, as far as was recorded, so nothing is compared."
                .to_owned()
        }
        Some(least) => {
            let one = |of: &&Compared| {
                let ([first, second], measure) = (of.condition.parts, of.measure.name());
                let [share, other] = of.shares.map(percent);
                format!(
                    "{} ({measure}: {first} against {second}: {}; \"{measure}\" {share} against {other}, {})",
                    of.condition.name,
                    counted(of.people.iter().sum(), "participant"),
                    p_value(adjusted(of)),
                )
            };
            let differ: Vec<String> = tested.iter().filter(|of| adjusted(of) <= level).map(one).collect();
            let tests = counted(tested.len(), "test");
            match differ.is_empty() {
                true => format!(
                    "Answers do not differ demonstrably by the screen that they were given on: none of {tests}, of answers \
                     without preference and of answers like most others\u{2019}, holds after correction (smallest corrected \
                     {}). That is no proof that screens do not matter.",
                    p_value(least)
                ),
                false => format!(
                    "Answers differ by the screen that they were given on, in {} of {tests} after correction: {}. Screens were \
                     not assigned: people who have them may differ in other things.",
                    differ.len(),
                    list(&differ)
                ),
            }
        }
    };
    if !alike.is_empty() && !tested.is_empty() {
        said.push_str(&format!(" Not tested, since all answers are of one part: {}.", list(&alike)));
    }
    Some(Finding::new(Standing::Noted, said))
}

/// How far people turned the models that they were shown. Whether it changed what they chose is a row of the table.
pub(super) fn turning(turned: &Turned) -> Finding {
    let Turned { people, answers, turned, quartiles_deg } = turned;
    let (people, answers) = (counted(*people, "participant"), counted(*answers, "answer"));
    let before = format!("Models were shown to {people}, who turned them before {turned} of {answers}");
    let said = match quartiles_deg {
        None => format!("{before}."),
        Some([low, median, high]) => {
            format!("{before}, by a median of {median:.0} degrees (quartiles {low:.0} and {high:.0}).")
        }
    };
    Finding::new(Standing::Noted, said)
}

#[cfg(test)]
mod tests {
    use super::*;
    use isostudy_inference::screens::compared;

    /// Ten people, half of them on phones, who decide or do not by their number.
    fn said(undecided: impl Fn(usize) -> bool) -> String {
        let row = |person: usize, question: usize| {
            let (choice, width) =
                (if undecided(person) { "none" } else { "left" }, if person < 5 { 390 } else { 1280 });
            format!("p{person},q{question},a,b,{choice},{width},touch\n")
        };
        let rows: String =
            (0..10).flat_map(|person| (0..4).map(move |q| (person, q))).map(|(p, q)| row(p, q)).collect();
        let text = format!("participant,question,left,right,choice,viewport_width,input\n{rows}");
        let path = std::path::Path::new("answers.csv");
        let read =
            isostudy_responses::parse(text.as_bytes(), path, None, &isostudy_responses::Mapping::default())
                .unwrap();
        finding(&compared(&read.responses), 0.05).unwrap().text
    }

    #[test]
    fn how_far_people_turned_is_said() {
        let of =
            |turned, quartiles_deg| turning(&Turned { people: 2, answers: 4, turned, quartiles_deg }).text;
        assert_eq!(
            of(3, Some([45.0, 60.0, 75.0])),
            "Models were shown to 2 participants, who turned them before 3 of 4 answers, by a median of 60 degrees (quartiles \
             45 and 75)."
        );
        assert_eq!(
            of(0, None),
            "Models were shown to 2 participants, who turned them before 0 of 4 answers."
        );
    }

    #[test]
    fn a_difference_is_named_and_none_is_no_proof() {
        // Corrected p: twice 2 / 252.
        let differs = said(|person| person < 5);
        assert!(
            differs.contains("in 2 of 2 tests") && differs.contains("\"no preference\" 100 % against 0 %"),
            "{differs}"
        );
        assert!(differs.contains("Not tested, since all answers are of one part: input."), "{differs}");
        let alike = said(|person| person % 2 == 0);
        assert!(alike.contains("none of 2 tests") && alike.contains("no proof"), "{alike}");
        assert!(finding(&[], 0.05).is_none());
    }
}
