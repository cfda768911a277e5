//! Exports of survey tools with one row a participant: how each is known, and what of its header is the tool's own.

use crate::address;
use crate::decode::records::is_blank;
use crate::error::Fault;
use crate::format::Format;
use crate::formats::layout::{Head, is_form};
use crate::formats::layout::{Layout, Sign};
use crate::words::normalise;

/// Header of Google Forms' first column, in the languages of its users.
const TIMESTAMP: [&str; 7] = [
    "timestamp",
    "zeitstempel",
    "horodateur",
    "marca temporal",
    "tijdstempel",
    "informazioni cronologiche",
    "carimbo de data/hora",
];
/// Google Forms' columns beside it.
const GOOGLE: [&str; 18] = [
    "username",
    "email address",
    "score",
    "total score",
    "nutzername",
    "e-mail-adresse",
    "punktzahl",
    "adresse e-mail",
    "nom d'utilisateur",
    "nombre de usuario",
    "dirección de correo electrónico",
    "puntuación",
    "gebruikersnaam",
    "e-mailadres",
    "nome utente",
    "indirizzo email",
    "nome de usuário",
    "endereço de e-mail",
];
/// Microsoft Forms' columns of times, by which it is known.
const STARTED: [&str; 7] = [
    "start time",
    "startzeit",
    "heure de début",
    "hora de inicio",
    "begintijd",
    "ora di inizio",
    "hora de início",
];
const MICROSOFT: [&str; 33] = [
    "id",
    "completion time",
    "fertigstellungszeit",
    "heure de fin",
    "hora de finalización",
    "tijd van voltooien",
    "ora di completamento",
    "hora de conclusão",
    "email",
    "e-mail",
    "adresse de messagerie",
    "correo electrónico",
    "e-mailadres",
    "posta elettronica",
    "name",
    "nom",
    "nombre",
    "naam",
    "nome",
    "last modified time",
    "uhrzeit der letzten änderung",
    "zeitpunkt der letzten änderung",
    "heure de la dernière modification",
    "hora de la última modificación",
    "tijd van laatste wijziging",
    "ora ultima modifica",
    "hora da última modificação",
    "total points",
    "quiz feedback",
    "grade posted time",
    "gesamtpunktzahl",
    "total de puntos",
    "total de points",
];
const MICROSOFT_QUIZ: [&str; 6] =
    ["points - ", "feedback - ", "punkte - ", "puntos - ", "comentarios - ", "points – "];
const QUALTRICS: [&str; 24] = [
    "startdate",
    "enddate",
    "status",
    "ipaddress",
    "progress",
    "duration (in seconds)",
    "finished",
    "recordeddate",
    "responseid",
    "responseset",
    "recipientlastname",
    "recipientfirstname",
    "recipientemail",
    "externalreference",
    "externaldatareference",
    "externaldata",
    "emailaddress",
    "name",
    "locationlatitude",
    "locationlongitude",
    "locationaccuracy",
    "distributionchannel",
    "userlanguage",
    "q_recaptchascore",
];
const LIME: [(&str, &str); 12] = [
    ("id", "response id"),
    ("submitdate", "date submitted"),
    ("lastpage", "last page"),
    ("startlanguage", "start language"),
    ("seed", "seed"),
    ("token", "access code"),
    ("startdate", "date started"),
    ("datestamp", "date last action"),
    ("ipaddr", "ip address"),
    ("refurl", "referrer url"),
    ("interviewtime", "total time"),
    ("completed", "completed"),
];
const MONKEY: [&str; 11] = [
    "respondent id",
    "collector id",
    "start date",
    "end date",
    "date created",
    "date modified",
    "ip address",
    "email address",
    "first name",
    "last name",
    "custom data",
];

/// What in the first rows speaks for a survey tool.
pub(crate) fn mark(format: Format, head: &Head) -> Option<String> {
    let header: Vec<String> = head[0].1.iter().map(|title| normalise(title)).collect();
    let first = header.first().map_or("", String::as_str);
    let has = |title: &str| header.iter().any(|own| own == title);
    match format {
        Format::GoogleForms => {
            TIMESTAMP.contains(&first).then(|| format!("the first header is \"{}\"", head[0].1[0]))
        }
        Format::MicrosoftForms => {
            let started = header.iter().position(|own| STARTED.contains(&own.as_str()));
            started
                .filter(|_| first == "id")
                .map(|column| format!("the headers begin with ID and \"{}\"", head[0].1[column]))
        }
        Format::Qualtrics if import_row(head).is_some() => {
            Some("the third row holds {\"ImportId\":...}".into())
        }
        Format::Qualtrics => {
            (legacy_qualtrics(head)).then(|| "two header rows with ResponseID in the second".into())
        }
        Format::LimeSurvey => {
            let both = |a: &str, b: &str| {
                header.iter().any(|own| lime(own, a)) && header.iter().any(|own| lime(own, b))
            };
            let codes = both("submitdate", "lastpage") || both("lastpage", "startlanguage");
            codes.then(|| "the headers have submitdate, lastpage or startlanguage".into())
        }
        Format::SurveyMonkey => (first == "respondent id" && has("collector id"))
            .then(|| "the headers begin with Respondent ID and Collector ID".into()),
        Format::RedCap => (first == "record_id").then(|| "the first header is record_id".into()),
        Format::JsPsych => (has("trial_type") && has("trial_index"))
            .then(|| "the headers have trial_type and trial_index".into()),
        Format::WebMushra => (has("session_test_id") && has("choice_answer"))
            .then(|| "the headers have session_test_id and choice_answer".into()),
        Format::Arenakit => ["model_a", "model_b", "winner"]
            .into_iter()
            .all(has)
            .then(|| "the headers have model_a, model_b and winner".into()),
        Format::Pwcmp => {
            (has("condition_a") && has("condition_b") && crate::formats::pwcmp::SELECTED.into_iter().any(has))
                .then(|| "the headers have condition_A, condition_B and is_A_selected".into())
        }
        Format::Table | Format::Long | Format::Jatos => None,
    }
}

/// The layout of a survey tool's export, whether its marks are there or the format is declared.
///
/// # Errors
/// If a declared format lacks the header rows that it must have.
pub(crate) fn layout(format: Format, head: &Head) -> Result<Layout, Fault> {
    let mut layout = match format {
        Format::GoogleForms => google(head),
        Format::MicrosoftForms => microsoft(head),
        Format::Qualtrics => qualtrics(head)?,
        Format::LimeSurvey => lime_survey(head),
        Format::SurveyMonkey => survey_monkey(head),
        Format::RedCap => red_cap(head),
        _ => return Ok(crate::formats::layout::own_table(head)),
    };
    let address = |column: &usize| layout.titles[*column].iter().any(|title| address::is_title(title));
    layout.addresses = (0..layout.titles.len()).filter(address).collect();
    // Forms are no tool's own: people are asked for the number, or it is in the link to the survey.
    layout.form =
        (0..layout.titles.len()).find(|&column| layout.titles[column].iter().any(|title| is_form(title)));
    layout.aside.extend(layout.form);
    Ok(layout)
}

fn one_header(head: &Head, own: impl Fn(usize, &str) -> bool) -> Layout {
    let (row, header) = &head[0];
    let mut layout = Layout::of_header(*row, header);
    let aside = |column: &usize| own(*column, &normalise(&header[*column]));
    layout.aside = (0..header.len()).filter(aside).collect();
    layout
}

fn google(head: &Head) -> Layout {
    let mut layout = one_header(head, |column, title| {
        let scored = title.ends_with(" [score]") || title.ends_with(" [feedback]");
        column == 0 || GOOGLE.contains(&title) || scored
    });
    layout.time = Some(0);
    layout
}

fn microsoft(head: &Head) -> Layout {
    let mut layout = one_header(head, |_, title| {
        let quiz = MICROSOFT_QUIZ.iter().any(|start| title.starts_with(start));
        MICROSOFT.contains(&title) || STARTED.contains(&title) || quiz
    });
    layout.participant = (normalise(layout.title(0)) == "id").then_some(0);
    layout.time = head[0].1.iter().position(|title| STARTED.contains(&normalise(title).as_str()));
    layout
}

/// The row whose cells are `{"ImportId":...}`.
fn import_row(head: &Head) -> Option<usize> {
    let import = |cell: &String| normalise(cell).starts_with("{\"importid\"");
    (1..head.len()).find(|&i| head[i].1.iter().all(|cell| import(cell) || is_blank(cell)))
}

fn legacy_qualtrics(head: &Head) -> bool {
    let [(_, first), (_, second), ..] = head else { return false };
    let has = |row: &[String], name: &str| row.iter().any(|cell| normalise(cell) == name);
    has(second, "responseid") && has(first, "v1") || has(first, "responseid") && has(second, "response id")
}

fn qualtrics(head: &Head) -> Result<Layout, Fault> {
    let last = match import_row(head) {
        Some(last) => last,
        None if head.len() > 1 => 1,
        None => {
            let missing = "a second header row".into();
            return Err(Fault::NotThatFormat { format: Format::Qualtrics, row: head[0].0 + 1, missing });
        }
    };
    let mut layout = Layout::of_header(head[last].0, &head[0].1);
    for (column, titles) in layout.titles.iter_mut().enumerate() {
        titles.extend(head[1..=last].iter().filter_map(|(_, row)| row.get(column).cloned()));
    }
    let plain = |title: &str| {
        normalise(title).replace("response id", "responseid").replace("response type", "status")
    };
    let is = |column: usize, name: &str| layout.titles[column].iter().any(|title| plain(title) == name);
    let find = |name: &str| (0..layout.titles.len()).find(|&column| is(column, name));
    let (participant, status, finished) = (find("responseid"), find("status"), find("finished"));
    let time = find("startdate");
    let imported = last == 2;
    let mut orders = Vec::new();
    let mut aside = Vec::new();
    for (column, titles) in layout.titles.iter().enumerate() {
        let field = normalise(&titles[0]);
        let import = titles.get(2).map_or(String::new(), |import| normalise(import));
        let timing = ["first click", "last click", "page submit", "click count"]
            .iter()
            .any(|end| field.ends_with(end));
        let legacy = field.strip_prefix('v').is_some_and(|number| number.parse::<u32>().is_ok());
        if field.ends_with("_do") || field.contains("_do_") {
            orders.push(column);
            aside.push(column);
        } else if QUALTRICS.iter().any(|name| is(column, name)) || timing || (!imported && legacy) {
            aside.push(column);
        } else if imported && !import.contains("\"qid") && !is_blank(&import) {
            // Embedded data, and whatever else is no question.
            aside.push(column);
        }
    }
    let preview =
        |cell: &str| ["survey preview", "survey test", "1", "2"].contains(&normalise(cell).as_str());
    let open = |cell: &str| ["false", "0"].contains(&normalise(cell).as_str());
    layout.preview =
        status.map(|column| Sign { column, says: preview, what: "a preview or test" }).into_iter().collect();
    layout.unfinished =
        finished.map(|column| Sign { column, says: open, what: "not finished" }).into_iter().collect();
    (layout.participant, layout.time, layout.aside, layout.orders) = (participant, time, aside, orders);
    Ok(layout)
}

/// Whether a LimeSurvey header is this column of its own: the code, the English text, or the code and any text.
fn lime(title: &str, code: &str) -> bool {
    let title = title.strip_prefix("x.u.feff.").unwrap_or(title);
    let text = LIME.iter().find(|(own, _)| *own == code).map_or("", |(_, text)| text);
    title == code
        || title == text
        || title.strip_prefix(code).is_some_and(|rest| rest.starts_with(['.', ':']))
}

fn lime_survey(head: &Head) -> Layout {
    let header: Vec<String> = head[0].1.iter().map(|title| normalise(title)).collect();
    let timing = |title: &str| {
        let group =
            title.strip_prefix("grouptime").is_some_and(|rest| rest.bytes().all(|b| b.is_ascii_digit()));
        let question = title
            .strip_suffix("time")
            .is_some_and(|code| !code.is_empty() && header.iter().any(|own| own == code));
        group || question
    };
    let mut layout =
        one_header(head, |_, title| LIME.iter().any(|(code, _)| lime(title, code)) || timing(title));
    layout.participant = header.iter().position(|title| lime(title, "id"));
    // Not submitdate, which is one and the same day in 1980 where no dates are kept.
    let at = |code: &str| header.iter().position(|title| lime(title, code));
    layout.time = at("startdate").or_else(|| at("datestamp"));
    let submitted = header.iter().position(|title| lime(title, "submitdate"));
    let sign = |column| Sign { column, says: is_blank, what: "not submitted" };
    layout.unfinished = submitted.map(sign).into_iter().collect();
    layout
}

fn survey_monkey(head: &Head) -> Layout {
    let own = |title: &str| {
        MONKEY.iter().any(|name| title == *name || (*name == "custom data" && title.starts_with(name)))
    };
    let mut layout = one_header(head, |_, title| own(title));
    let at = |name: &str| head[0].1.iter().position(|title| normalise(title) == name);
    (layout.participant, layout.time) = (at("respondent id"), at("start date"));
    // Under the tool's own columns the second header row is empty.
    if let Some((row, second)) = head.get(1).filter(|(_, row)| row.first().is_none_or(|cell| is_blank(cell)))
    {
        layout.last_header_row = *row;
        let mut title = String::new();
        for (column, titles) in layout.titles.iter_mut().enumerate() {
            if is_blank(&titles[0]) {
                titles[0].clone_from(&title)
            } else {
                title.clone_from(&titles[0])
            }
            titles.push(second.get(column).cloned().unwrap_or_default());
        }
    }
    layout
}

fn red_cap(head: &Head) -> Layout {
    let own = |title: &str| {
        title.starts_with("redcap_") || title.ends_with("_complete") || title.ends_with("_timestamp")
    };
    let mut layout = one_header(head, |column, title| column == 0 || own(title));
    layout.participant = Some(0);
    let open = |cell: &str| ["0", "1", "incomplete", "unverified"].contains(&normalise(cell).as_str());
    let complete = |column: &usize| normalise(layout.title(*column)).ends_with("_complete");
    let columns = (0..layout.titles.len()).filter(complete);
    layout.unfinished = columns.map(|column| Sign { column, says: open, what: "not complete" }).collect();
    layout
}
