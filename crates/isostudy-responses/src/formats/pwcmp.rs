//! pwcmp's comparisons: one row an answer, `observer, session, scene, condition_A, condition_B, is_A_selected`.
//!
//! The format names no questions: a question is a scene with a pair. It does not say which condition was on the left, so sides
//! are not recorded. The session is the form where every observer has one alone, and the study, if it is known, dealt forms
//! of these numbers. There are no ties: where an observer has one won and
//! one lost row with the same conditions, scene and session, both are one answer without preference, as
//! [`Ties::Split`](crate::Ties::Split) writes it. Source: M. Perez-Ortiz and R. Mantiuk, "A practical guide and
//! software for analysing pairwise comparison experiments" (2017), and the examples of their pwcmp.

use crate::collect::Ids;
use crate::decode::source::Source;
use crate::error::Fault;
use crate::format::Format;
use crate::formats::layout::{Head, Header};
use crate::formats::long::{self, Columns};
use crate::mapping::Mapping;
use crate::plan::Plan;
use crate::report::{Kind, Report};
use crate::value::Responses;
use std::collections::HashMap;

/// Names of the column with the answer.
pub(crate) const SELECTED: [&str; 2] = ["is_a_selected", "selected_a"];
const COLUMNS: [&str; 7] =
    ["observer", "session", "scene", "condition_a", "condition_b", SELECTED[0], SELECTED[1]];
/// The session that is written where there are no forms.
const ONLY_SESSION: &str = "1";

/// Reads every row under the header.
///
/// # Errors
/// See [`Fault`].
pub(crate) fn read(
    source: &Source<'_>,
    head: &Head,
    plan: Option<&Plan>,
    mapping: &Mapping,
    report: &mut Report,
) -> Result<Responses, Fault> {
    let header = Header::of(Format::Pwcmp, head);
    let declared = mapping.participant(header.cells.len())?;
    let participant = declared.map_or_else(|| header.needed(&["observer"]), Ok)?;
    header.note_others(Some(participant), &COLUMNS, report);
    let session = header.find(&["session"]);
    let form = match session {
        None => None,
        Some(session) => {
            let found = sessions(source, header.row, participant, session, plan)?;
            if let Some(action) = found.action() {
                report.cell(Kind::Noted, header.row, session, &header.cells[session], action);
            }
            (found == Sessions::Forms).then_some(session)
        }
    };
    report.column_rule = match form {
        Some(_) => "questions by scene and pair, sessions as forms".into(),
        None => "questions by scene and pair".into(),
    };
    let columns = Columns {
        participant: Some(participant),
        sides: Some((header.needed(&["condition_A"])?, header.needed(&["condition_B"])?)),
        choice: header.find(&SELECTED).ok_or_else(|| header.missing("the header has no is_A_selected"))?,
        object: header.find(&["scene"]),
        form,
        session,
        ..Columns::default()
    };
    let mut own = mapping.clone();
    let [first, second] = ["1", "0"].map(|word| [word.to_owned()]);
    own.words.declare([&first, &[], &second]).expect("two words");
    let rule = long::Rule {
        sides_recorded: false,
        ordered: false,
        split_ties: true,
        ids: Ids::MadeUp,
        ..long::Rule::LONG
    };
    long::read_columns(source, &header, columns, rule, plan, &own, report)
}

/// What sessions say.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Sessions {
    /// Nothing: there is one, with the name that is written where there are no forms.
    Only,
    /// Each observer's form.
    Forms,
    /// When an observer answered.
    Several,
    /// Something else than the forms that the study dealt.
    Foreign,
}

impl Sessions {
    /// Why they are not read, where they say something.
    fn action(self) -> Option<&'static str> {
        match self {
            Self::Only | Self::Forms => None,
            Self::Several => Some("observers have several sessions: not read as forms"),
            Self::Foreign => Some("no form of the study has such a number: not read as forms"),
        }
    }
}

fn sessions(
    source: &Source<'_>,
    header: u64,
    observer: usize,
    session: usize,
    plan: Option<&Plan>,
) -> Result<Sessions, Fault> {
    let mut of: HashMap<String, String> = HashMap::new();
    let (mut several, mut only, mut foreign) = (false, true, false);
    let dealt = plan.filter(|plan| plan.forms() > 0);
    source.each(|record| {
        if record.row > header && !record.is_blank() {
            let session = crate::decode::records::trim(record.cell(session));
            only &= session == ONLY_SESSION;
            foreign |= dealt.is_some_and(|plan| plan.sheet(session).is_none());
            match of.get(record.cell(observer)) {
                Some(first) => several |= first != session,
                None => drop(of.insert(record.cell(observer).to_owned(), session.to_owned())),
            }
        }
        Ok(())
    })?;
    Ok(match (several, only) {
        (true, _) => Sessions::Several,
        (false, true) => Sessions::Only,
        (false, false) if foreign => Sessions::Foreign,
        (false, false) => Sessions::Forms,
    })
}
