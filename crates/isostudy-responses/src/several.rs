//! Answers of people who did not compare two: ratings, and the best of several.
//!
//! Their file is the long format with a column `shown` in place of `left` and `right`: the ids of the configurations, with spaces
//! between, in the order of their places. Answers about two items follow from it: of two configurations of one comparison the one that
//! somebody rated higher, or the one that was taken of a set in which both stood. So everything that is said of pairs can be said.

use crate::choice::Choice;
use crate::error::{Fault, ReadError, shorten};
use crate::format::Format;
use crate::name;
use crate::plan::Plan;
use crate::read::{LARGEST_FILE, Reading};
use crate::report::Report;
use crate::sides::SidesSource;
use crate::value::{Answer, Judged, Participant, Responses, Verdict};
use isostudy_design::Study;
use isostudy_design::forms::Role;
use isostudy_table::formula::unescape;
use std::collections::{BTreeMap, HashMap};
use std::path::Path;

/// The column of what was shown.
pub const SHOWN_COLUMN: &str = "shown";

/// The columns that are needed.
const NEEDED: [&str; 6] = ["participant", "order", "question", SHOWN_COLUMN, "choice", "role"];

/// Reads answers to a study that does not ask about pairs.
///
/// # Errors
/// As [`read`](crate::read()): what is wrong, with file, row and column.
pub fn read_several(path: &Path, study: &Study) -> Result<Reading, ReadError> {
    let failed = |source| ReadError::File { file: path.into(), source };
    let bytes = isostudy_foreign::bytes(path, LARGEST_FILE).map_err(|error| failed(error.into()))?;
    let mut report = Report {
        file: path.into(),
        format: Format::Long,
        format_rule: format!("the study does not ask about pairs; needs {}", NEEDED.join(", ")),
        text_rule: "UTF-8".into(),
        column_rule: "columns by their names".into(),
        sides: SidesSource::NoSides,
        remarks: Vec::new(),
    };
    let text = String::from_utf8_lossy(&bytes);
    match responses(text.trim_start_matches('\u{feff}'), study, &mut report) {
        Ok(responses) => Ok(Reading { responses, report }),
        Err(fault) => Err(ReadError::Content { file: path.into(), fault: Box::new(fault) }),
    }
}

/// A row of the file, by the names of its columns.
struct Row<'a> {
    number: u64,
    places: &'a HashMap<String, usize>,
    cells: &'a csv::StringRecord,
}

impl Row<'_> {
    fn cell(&self, name: &str) -> &str {
        let cell = self.places.get(name).and_then(|&place| self.cells.get(place)).unwrap_or("");
        unescape(cell.trim())
    }

    fn refuse(&self, name: &str, limit: impl Into<String>) -> Fault {
        Fault::Cell {
            row: self.number,
            column: self.places.get(name).map_or(0, |place| place + 1),
            name: name.to_owned(),
            cell: shorten(self.cell(name)),
            limit: limit.into(),
        }
    }
}

fn responses(text: &str, study: &Study, report: &mut Report) -> Result<Responses, Fault> {
    let plan = Plan::of_study(study);
    let items: HashMap<&str, u32> = plan.items().iter().map(String::as_str).zip(0..).collect();
    let forms =
        study.file.forms.as_ref().map(|forms| (forms.way, forms.way.answers_of(forms.steps, forms.none)));
    let (way, answers) = forms.unwrap_or_default();
    let codes: Vec<&str> = answers.iter().map(|of| of.code).collect();
    let mut reader = csv::ReaderBuilder::new().flexible(true).from_reader(text.as_bytes());
    let header = reader.headers().cloned().unwrap_or_default();
    let places: HashMap<String, usize> =
        header.iter().enumerate().map(|(place, name)| (name.trim().to_lowercase(), place)).collect();
    let missing: Vec<&str> = NEEDED.into_iter().filter(|name| !places.contains_key(*name)).collect();
    if !missing.is_empty() {
        let missing = format!("the header needs {}, and lacks {}", NEEDED.join(", "), missing.join(", "));
        return Err(Fault::NotThatFormat { format: Format::Long, row: 1, missing });
    }
    let mut people: Vec<Participant> = Vec::new();
    let mut known: HashMap<String, u32> = HashMap::new();
    let mut judged: Vec<Judged> = Vec::new();
    let mut seen: HashMap<(u32, u32), u64> = HashMap::new();
    for (record, number) in reader.records().zip(2..) {
        let cells = record.map_err(|_| Fault::CellCount { row: number, expected: header.len(), found: 0 })?;
        if cells.iter().all(|cell| cell.trim().is_empty()) {
            continue;
        }
        if cells.len() != header.len() {
            return Err(Fault::CellCount { row: number, expected: header.len(), found: cells.len() });
        }
        let row = Row { number, places: &places, cells: &cells };
        let is_repeat = match row.cell("role") {
            "comparison" => false,
            "repeat" => true,
            "training" => continue,
            _ => return Err(row.refuse("role", "must be comparison, repeat or training")),
        };
        let id = row.cell("participant");
        if id.is_empty() || name::is_too_long(id) {
            return Err(row.refuse("participant", name::limit()));
        }
        let form = Some(row.cell("form")).filter(|form| !form.is_empty()).map(str::to_owned);
        let participant = *known.entry(id.to_owned()).or_insert_with(|| {
            people.push(Participant { id: id.to_owned(), form });
            people.len() as u32 - 1
        });
        let order: u32 =
            row.cell("order").parse().map_err(|_| row.refuse("order", "must be a whole number"))?;
        if let Some(&first) = seen.get(&(participant, order)) {
            return Err(
                row.refuse("order", format!("row {first} has an answer of this person at this place"))
            );
        }
        seen.insert((participant, order), number);
        let shown: Option<Vec<u32>> =
            row.cell(SHOWN_COLUMN).split_whitespace().map(|id| items.get(id).copied()).collect();
        let shown = shown.filter(|shown| shown.len() == way.shown());
        let Some(shown) = shown else {
            let limit = format!("must be {} of the study's configurations, with spaces between", way.shown());
            return Err(row.refuse(SHOWN_COLUMN, limit));
        };
        let choice = row.cell("choice");
        if !codes.contains(&choice) {
            return Err(row.refuse("choice", format!("must be one of {}", codes.join(", "))));
        }
        let verdict = match (choice.parse::<u8>(), shown.len()) {
            (Ok(step), 1) => Verdict::Rated(step),
            (Ok(place), _) => Verdict::Taken(shown.get(usize::from(place) - 1).copied()),
            (Err(_), _) => Verdict::Taken(None),
        };
        judged.push(Judged { participant, shown, verdict, is_repeat, order });
    }
    if judged.iter().all(|of| of.is_repeat) {
        return Err(Fault::NoAnswers { row: 1 + judged.len() as u64 });
    }
    report.column_rule = format!("columns by their names; what was shown by \"{SHOWN_COLUMN}\"");
    Ok(Responses {
        participants: people,
        questions: plan.questions().to_vec(),
        items: plan.items().to_vec(),
        answers: of_pairs(&plan, &judged),
        sides_recorded: false,
        sides: SidesSource::NoSides,
        judged,
        ..Responses::default()
    })
}

/// Answers to comparisons, as they follow from what was judged: person by person, in the order of the comparisons. Repeats check answers
/// and are left out; so is "none of them", which says nothing of two.
fn of_pairs(plan: &Plan, judged: &[Judged]) -> Vec<Answer> {
    let mut people: BTreeMap<u32, Vec<&Judged>> = BTreeMap::new();
    for of in judged.iter().filter(|of| !of.is_repeat) {
        people.entry(of.participant).or_default().push(of);
    }
    let mut answers = Vec::new();
    for (participant, own) in people {
        let rated: HashMap<u32, u8> = own
            .iter()
            .filter_map(|of| match of.verdict {
                Verdict::Rated(step) => Some((of.shown[0], step)),
                Verdict::Taken(_) => None,
            })
            .collect();
        for (question, asked) in (0..).zip(plan.questions()).filter(|(_, of)| of.role == Role::Comparison) {
            let sides = [asked.left, asked.right];
            if let (Some(left), Some(right)) = (rated.get(&asked.left), rated.get(&asked.right)) {
                let choice = match left.cmp(right) {
                    std::cmp::Ordering::Greater => Choice::Left,
                    std::cmp::Ordering::Equal => Choice::NoPreference,
                    std::cmp::Ordering::Less => Choice::Right,
                };
                answers.push(Answer::new(participant, question, sides, choice));
            }
            for of in own.iter().filter(|of| sides.iter().all(|side| of.shown.contains(side))) {
                let choice = match of.verdict {
                    Verdict::Taken(Some(taken)) if taken == asked.left => Choice::Left,
                    Verdict::Taken(Some(taken)) if taken == asked.right => Choice::Right,
                    _ => continue,
                };
                let answer = Answer::new(participant, question, sides, choice);
                answers.push(Answer { order: Some(of.order), ..answer });
            }
        }
    }
    answers
}

#[cfg(test)]
mod tests {
    use super::*;
    use isostudy_design::config::Way;

    fn study(way: Way) -> Study {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs/balanced.toml");
        let text = std::fs::read_to_string(&path).unwrap();
        let mut study = Study::parse(&text, &path).unwrap();
        let forms = study.file.forms.as_mut().unwrap();
        (forms.way, forms.controls, forms.none) = (way, 0, true);
        study
    }

    fn read(text: &str, way: Way) -> Result<Responses, String> {
        let mut report = Report {
            file: "answers.csv".into(),
            format: Format::Long,
            format_rule: String::new(),
            text_rule: String::new(),
            column_rule: String::new(),
            sides: SidesSource::NoSides,
            remarks: Vec::new(),
        };
        responses(text, &study(way), &mut report).map_err(|fault| fault.to_string())
    }

    const HEADER: &str = "participant,form,order,question,object,group,shown,choice,rt_ms,role,stimulus\n";

    fn said(of: &Responses) -> Vec<(String, &'static str)> {
        let one = |answer: &Answer| (of.questions[answer.question as usize].id.clone(), answer.choice.name());
        of.answers.iter().map(one).collect()
    }

    #[test]
    fn of_two_ratings_follows_which_is_liked_better() {
        let text = format!(
            "{HEADER}a,1,2,rating-1,sphere,,ss_bu,3,900,comparison,tani\na,1,3,rating-2,sphere,,ss_bi,7,900,comparison,zeti\n\
             a,1,4,rating-3,sphere,,ss_bp,3,900,comparison,tuni\na,1,5,rating-1-r,sphere,,ss_bu,6,900,repeat,tani\n"
        );
        let found = read(&text, Way::Ratings).unwrap();
        let want = [("Q1", "right"), ("Q2", "none"), ("Q3", "right")].map(|(id, name)| (id.to_owned(), name));
        assert_eq!(said(&found), want);
        assert_eq!((found.judged.len(), found.judged[3].is_repeat), (4, true));
        assert!(found.judged[1].verdict == Verdict::Rated(7) && !found.sides_recorded);
    }

    #[test]
    fn of_several_what_was_taken_is_liked_better_than_each_other() {
        let text = format!(
            "{HEADER}a,1,2,set-1,sphere,,ss_bu ss_bi ss_bp,2,900,comparison,tani\n\
             a,1,3,set-2,sphere,,ss_bp ss_su ss_bu,NP,900,comparison,zeti\n\
             b,2,2,set-1,sphere,,ss_bi ss_bp ss_bu,3,900,comparison,tani\n"
        );
        let found = read(&text, Way::BestOfThree).unwrap();
        let want = [("Q1", "right"), ("Q3", "right"), ("Q1", "left"), ("Q2", "left")];
        assert_eq!(said(&found), want.map(|(id, name)| (id.to_owned(), name)));
        assert_eq!(found.judged[1].verdict, Verdict::Taken(None));
    }

    #[test]
    fn what_is_no_answer_says_where() {
        let wrong = |row: &str, way| read(&format!("{HEADER}{row}\n"), way).unwrap_err();
        for (row, told) in [
            (
                "a,1,2,set-1,sphere,,ss_bu ss_bi,1,900,comparison,tani",
                "must be 3 of the study's configurations",
            ),
            ("a,1,2,set-1,sphere,,ss_bu ss_bi ss_xx,1,900,comparison,tani", "must be 3 of the study's"),
            ("a,1,2,set-1,sphere,,ss_bu ss_bi ss_bp,4,900,comparison,tani", "must be one of 1, 2, 3, NP"),
            ("a,1,x,set-1,sphere,,ss_bu ss_bi ss_bp,1,900,comparison,tani", "must be a whole number"),
            ("a,1,2,set-1,sphere,,ss_bu ss_bi ss_bp,1,900,control,tani", "must be comparison, repeat"),
            ("a,1,2,set-1", "4"),
        ] {
            let error = wrong(row, Way::BestOfThree);
            assert!(error.contains(told) && error.contains('2'), "{row}: {error}");
        }
        let twice =
            "a,1,2,rating-1,sphere,,ss_bu,3,9,comparison,t\na,1,2,rating-2,sphere,,ss_bi,3,9,comparison,u";
        assert!(wrong(twice, Way::Ratings).contains("row 2 has an answer"), "{}", wrong(twice, Way::Ratings));
        assert!(read("a,b\n1,2\n", Way::Ratings).unwrap_err().contains("lacks participant"));
        assert!(read(HEADER, Way::Ratings).unwrap_err().contains("no answers"));
    }
}
