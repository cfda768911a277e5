//! Answers that can be given to others.

use crate::cameras::Tracked;
use crate::export::Given;
use crate::journal::Departures;
use crate::record::Answer;
use crate::screen::Screen;
use isostudy_design::forms::FormFile;
use std::collections::BTreeMap;

/// The same answers, their participants renamed `p1`, `p2`, and so on by their names, which are random, so that neither
/// names nor order tell who came when.
pub fn deidentified(given: &[Given]) -> Vec<Given> {
    let names = names(given);
    let renamed = |given: &Given| {
        let screen = given.answer.screen.map(Screen::rounded);
        let answer = Answer { screen, ..given.answer.clone() };
        Given { participant: names[&given.participant].clone(), answer, ..*given }
    };
    let mut shared: Vec<Given> = given.iter().map(renamed).collect();
    shared.sort_by(|a, b| (&a.participant, a.answer.order).cmp(&(&b.participant, b.answer.order)));
    shared
}

/// The same cameras under the names that participants have for others.
pub fn deidentified_cameras(all: &[Tracked], names: &BTreeMap<String, String>) -> Vec<Tracked> {
    let renamed =
        |of: &Tracked| Some(Tracked { participant: names.get(&of.participant)?.clone(), ..of.clone() });
    let mut shared: Vec<Tracked> = all.iter().filter_map(renamed).collect();
    shared.sort_by(|a, b| (&a.participant, a.order).cmp(&(&b.participant, b.order)));
    shared
}

/// What the columns of `cameras.csv` mean, in Markdown.
pub const CAMERAS: &str = "
`cameras.csv` says from where participants looked at models that they turned, a row for each camera.

| column | meaning | values |
|---|---|---|
| `participant`, `form`, `order`, `question`, `stimulus` | as above | |
| `hz` | cameras per second at most, while the models were turned | 20, or less for very long answers |
| `t_ms` | time since the pair was on the screen | milliseconds |
| `azimuth_deg` | azimuth of the camera from +x to +y | degrees; beyond 180 after several turns |
| `elevation_deg` | elevation of the camera over the horizon | degrees |
| `distance` | distance of the camera from the middle | 1 at first |
";

/// What each participant is called for others.
pub fn names(given: &[Given]) -> BTreeMap<String, String> {
    let mut names: BTreeMap<String, String> =
        given.iter().map(|given| (given.participant.clone(), String::new())).collect();
    let people = names.len();
    names.values_mut().enumerate().for_each(|(place, shared)| *shared = name(place + 1, people));
    names
}

/// `p07`: of so many people, all as wide.
fn name(number: usize, people: usize) -> String {
    let width = people.to_string().len();
    format!("p{number:0width$}")
}

/// What the columns of the shared answers mean, in Markdown. The digests are of the forms when the first answer came, and now. `about` says
/// what was merged in `about.csv`, where there is one.
pub fn codebook(
    file: &FormFile,
    (then, now): (&str, &str),
    participants: usize,
    answers: usize,
    departures: Departures,
    about: Option<&str>,
) -> String {
    let kinds = file.answers();
    let texts = file.choices.iter().map(String::as_str).chain(std::iter::repeat("a step of the scale"));
    let answers_of = kinds.iter().zip(texts);
    let choices: Vec<String> =
        answers_of.map(|(of, text)| format!("`{}` {}", of.code, escaped(text))).collect();
    let changed = if then == now {
        String::new()
    } else {
        format!(
            "The study file was changed after the first answer (forms {then}): texts below are those of forms {now}.\n\n"
        )
    };
    let people = match participants {
        0 | 1 => format!("`{}`", name(1, participants)),
        _ => format!("`{}` to `{}`", name(1, participants), name(participants, participants)),
    };
    let count = |number: usize, word: &str| format!("{number} {word}{}", if number == 1 { "" } else { "s" });
    let Departures { withdrawn, screened_out, full } = departures;
    let gone = if departures == Departures::default() {
        String::new()
    } else {
        format!(
            "People of whom nothing is kept: {withdrawn} withdrew, {screened_out} were screened out, {full} came when enough \
             people had said the same of themselves.\n\n"
        )
    };
    let about = about.map_or_else(String::new, |said| format!("{}{said}\n", about_table(file)));
    format!(
        "# Codebook\n\n\
         Answers to \"{title}\" (study `{study}`, forms {now}): {answers} of {participants}, in `answers.csv`.\n\n{changed}\
         Participants are numbered at random. No name, address, panel identifier or date is in this set.\n\n{gone}\
         | column | meaning | values |\n|---|---|---|\n\
         | `participant` | who answered | {people} |\n\
         | `form` | number of the form | 1 to {forms} |\n\
         | `order` | place in the form, practice included | from 1 |\n\
         | `question` | what was compared | id of the study file, with `-r` where it was asked again; `control-1`, ... |\n\
         | `object` | what both sides show | name of the study file |\n\
         | `group` | comparison group; empty for controls | id of the study file |\n\
         {sides}\
         | `choice` | answer to \"{prompt}\" | {choices}, as shown |\n\
         | `rt_ms` | time from the pair on the screen to the answer | milliseconds; a turn takes {loop_ms} |\n\
         | `role` | why it was asked | `comparison`; `control`: the same on both sides; `repeat`: asked again, sides swapped |\n\
         | `stimulus` | code name of the animation | |\n\
         | `viewport_width`, `viewport_height` | the browser's window | CSS pixels, rounded down to whole 50 |\n\
         | `pixel_ratio` | pixels of the screen for one CSS pixel | |\n\
         | `surface_px` | largest width that each surface had | CSS pixels, rounded down to whole 50 |\n\
         | `layout` | how the surfaces stood | `beside`; `stacked`: left over right |\n\
         | `input` | what the answer was given with | `mouse`, `touch`, `pen`, `keyboard` |\n\
         | `dropped` | frames that the browser did not show | from 0 |\n\
         | `hidden_ms` | time for which the page was out of sight, within `rt_ms` | milliseconds |\n\
         | `shown_as` | as what the pair was shown | `gif`, `png`, `mp4`, `webm`, `model` |\n\
         | `turned_deg` | degrees by which the participant turned the models, there and back | from 0; empty unless models were shown |\n{about}",
        answers = count(answers, "answer"),
        choices = choices.join(", "),
        sides = if file.way.is_of_pairs() {
            "| `left`, `right` | configuration shown on that side | object, underscore, method |\n"
        } else {
            "| `shown` | configurations shown, in the order of their places | object, underscore, method; spaces between |\n"
        },
        participants = count(participants, "participant"),
        title = escaped(&file.title),
        study = file.study,
        forms = file.forms.len(),
        prompt = escaped(&file.prompt),
        loop_ms = file.loop_ms,
    )
}

/// The columns of `about.csv`.
fn about_table(file: &FormFile) -> String {
    let texts = file.spoken().into_iter().next().map(|first| first.texts).unwrap_or_default();
    let mut table = String::from(
        "\n`about.csv` has what people said about themselves.\n\n| column | question |\n|---|---|\n",
    );
    for question in file.about.iter().filter(|question| !question.is_free()) {
        let asked = texts.get(&question.text).map_or_else(String::new, |text| escaped(text));
        table += &format!("| `{}` | {asked} |\n", question.id);
    }
    table + "\n"
}

/// Without what Markdown would read as mark-up, as a table's row or as HTML.
fn escaped(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '\\' | '|' | '_' | '*' | '`' | '[' | ']' => plain.extend(['\\', letter]),
            '&' => plain.push_str("&amp;"),
            '<' => plain.push_str("&lt;"),
            '\n' | '\r' => plain.push(' '),
            _ => plain.push(letter),
        }
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::Choice;
    use isostudy_design::config::Way;

    #[test]
    fn neither_names_nor_order_tell_who_came_when() {
        let given = |participant: &str, order| Given {
            participant: participant.into(),
            form: 1,
            answer: Answer {
                order,
                stimulus: "tani".into(),
                choice: Choice::L,
                rt_ms: 900,
                screen: None,
                change: 0,
            },
        };
        let shared = deidentified(&[given("c0", 1), given("c0", 2), given("0a", 1), given("77", 1)]);
        let found: Vec<(&str, u32)> =
            shared.iter().map(|g| (g.participant.as_str(), g.answer.order)).collect();
        assert_eq!(found, [("p1", 1), ("p2", 1), ("p3", 1), ("p3", 2)]);
        assert!(shared.iter().all(|g| g.form == 1 && g.answer.rt_ms == 900));
    }

    #[test]
    fn cameras_are_renamed_as_answers_are() {
        let of = |participant: &str, order| Tracked {
            participant: participant.into(),
            form: 1,
            order,
            stimulus: "tani".into(),
            track: crate::cameras::Track { hz: 20.0, cameras: vec![0, 450, 222, 1000] },
        };
        let names = [("c0", "p2"), ("0a", "p1")].map(|(name, shared)| (name.to_owned(), shared.to_owned()));
        let shared =
            deidentified_cameras(&[of("c0", 2), of("0a", 3), of("c0", 1), of("zz", 1)], &names.into());
        let found: Vec<(&str, u32)> = shared.iter().map(|of| (of.participant.as_str(), of.order)).collect();
        assert_eq!(found, [("p1", 3), ("p2", 1), ("p2", 2)]);
    }

    fn file() -> FormFile {
        FormFile {
            title: "<script> & *stars*".into(),
            prompt: "Which\nof two?".into(),
            choices: ["Left | a", "[None](http://example.org)", "Right"].map(Into::into).into(),
            ..crate::export::tests::empty_file()
        }
    }

    #[test]
    fn the_codebook_names_the_participants_that_are_there() {
        for people in [1, 9, 36] {
            let given: Vec<Given> = (0..people)
                .map(|person| Given {
                    participant: format!("{person:03}"),
                    form: 1,
                    answer: Answer {
                        order: 1,
                        stimulus: "tani".into(),
                        choice: Choice::L,
                        rt_ms: 900,
                        screen: None,
                        change: 0,
                    },
                })
                .collect();
            let shared = deidentified(&given);
            let [first, last] = [shared.first(), shared.last()].map(|of| &of.unwrap().participant);
            let said = if first == last { format!("`{first}`") } else { format!("`{first}` to `{last}`") };
            let text = codebook(&file(), ("d", "d"), people, people, Departures::default(), None);
            assert!(text.contains(&format!("| who answered | {said} |")), "{text}");
        }
    }

    #[test]
    fn a_text_of_the_study_is_no_mark_up() {
        let text = codebook(&file(), ("d", "d"), 1, 1, Departures::default(), None);
        assert!(text.contains("&lt;script> &amp; \\*stars\\*"), "{text}");
        assert!(text.contains("Left \\| a, `NP` \\[None\\](http://example.org), `R` Right"), "{text}");
        assert!(text.contains("answer to \"Which of two?\""), "{text}");
        let forced = FormFile { way: Way::Forced, choices: vec!["This".into(), "That".into()], ..file() };
        let text = codebook(&forced, ("d", "d"), 1, 1, Departures::default(), None);
        assert!(text.contains("| `L` This, `R` That, as shown |"), "{text}");
    }
}
