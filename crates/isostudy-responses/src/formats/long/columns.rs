//! The columns of files with one row an answer.

use crate::collect::Ids;
use crate::decode::records::is_blank;
use crate::error::Fault;
use crate::formats::layout::Header;
use crate::plan::Plan;
use crate::report::{Kind, Report};
use crate::screen::SCREEN_COLUMNS;
use crate::sides::SidesSource;
use crate::words::normalise;

/// Columns of an answer and of what was asked.
const OF_ANSWERS: [&str; 14] = [
    "participant",
    "question",
    "left",
    "right",
    "choice",
    "object",
    "group",
    "form",
    "order",
    "rt_ms",
    "role",
    "stimulus",
    "count",
    "sides_unknown",
];
/// Columns that the long format may have; others are noted and not read.
pub const LONG_COLUMNS: [&str; OF_ANSWERS.len() + SCREEN_COLUMNS.len()] =
    joined(&OF_ANSWERS, &SCREEN_COLUMNS);

/// Two lists of names as one.
///
/// # Panics
/// If there are not as many.
pub(crate) const fn joined<const N: usize>(
    first: &[&'static str],
    second: &[&'static str],
) -> [&'static str; N] {
    assert!(first.len() + second.len() == N, "as many as both have");
    let mut names = [""; N];
    let mut place = 0;
    while place < N {
        names[place] = if place < first.len() { first[place] } else { second[place - first.len()] };
        place += 1;
    }
    names
}

/// How many of them, from the first on, a file needs that has neither a study nor a `count`.
pub const LONG_NEEDED: usize = 5;

/// Where the columns of a file with one row an answer are.
#[derive(Debug, Clone, Default)]
pub(crate) struct Columns {
    /// Who answered; where there is none, everybody is somebody else.
    pub(crate) participant: Option<usize>,
    /// The participant's column counts trials instead, and starts again with each participant.
    pub(crate) restarts: bool,
    /// The question; where there is none, it follows from the pair.
    pub(crate) question: Option<usize>,
    /// Both sides, or what the study shows.
    pub(crate) sides: Option<(usize, usize)>,
    pub(crate) choice: usize,
    pub(crate) object: Option<usize>,
    pub(crate) group: Option<usize>,
    pub(crate) form: Option<usize>,
    pub(crate) order: Option<usize>,
    pub(crate) rt_ms: Option<usize>,
    /// Why it was asked, as forms say it.
    pub(crate) role: Option<usize>,
    /// The code name of what was shown.
    pub(crate) stimulus: Option<usize>,
    /// How many people gave this answer.
    pub(crate) count: Option<usize>,
    /// Says that left and right are the order of two names, and no sides: it is there if they are not known.
    pub(crate) sides_unknown: Option<usize>,
    /// When somebody answered; it only tells repeats from split ties.
    pub(crate) session: Option<usize>,
    /// On what it was given.
    pub(crate) screen: [Option<usize>; SCREEN_COLUMNS.len()],
}

/// What differs between formats with one row an answer.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rule {
    /// Whether left and right are sides.
    pub(crate) sides_recorded: bool,
    /// Whether cells were protected from spreadsheets.
    pub(crate) escaped: bool,
    /// Whether every row is an answer; otherwise those with a question.
    pub(crate) every_row: bool,
    /// Whether there is a column for the place in the session.
    pub(crate) ordered: bool,
    /// Whether a won and a lost row are a tie.
    pub(crate) split_ties: bool,
    /// What an id means where there is no study.
    pub(crate) ids: Ids,
}

impl Rule {
    /// Of the long format where questions are named.
    pub(crate) const LONG: Self = Self {
        sides_recorded: true,
        escaped: true,
        every_row: true,
        ordered: true,
        split_ties: false,
        ids: Ids::OnePair,
    };
}

impl Columns {
    pub(super) fn of(header: &Header<'_>, with_plan: bool, report: &mut Report) -> Result<Self, Fault> {
        let mut at = [None; LONG_COLUMNS.len()];
        for (column, title) in header.cells.iter().enumerate() {
            match LONG_COLUMNS.iter().position(|name| *name == normalise(title)) {
                Some(name) => {
                    if let Some(first) = at[name].replace(column) {
                        let name = LONG_COLUMNS[name].into();
                        return Err(Fault::DuplicateColumn { column: column + 1, first: first + 1, name });
                    }
                }
                None if is_blank(title) => {}
                None => report.cell(
                    Kind::Noted,
                    header.row,
                    column,
                    title,
                    "not a column of this format: not read",
                ),
            }
        }
        let column =
            |name: &str| at[LONG_COLUMNS.iter().position(|of| *of == name).expect("a column of the format")];
        let needed = |name: &str| column(name).ok_or_else(|| Fault::MissingColumn { name: name.into() });
        if column("count").is_none() {
            needed("participant")?;
        }
        if with_plan {
            needed("question")?;
        }
        let sides = match (column("left"), column("right")) {
            (None, None) if with_plan => None,
            _ => Some((needed("left")?, needed("right")?)),
        };
        Ok(Self {
            participant: column("participant"),
            question: column("question"),
            sides,
            choice: needed("choice")?,
            object: column("object"),
            group: column("group"),
            form: column("form"),
            order: column("order"),
            rt_ms: column("rt_ms"),
            role: column("role"),
            stimulus: column("stimulus"),
            count: column("count"),
            sides_unknown: column("sides_unknown"),
            screen: SCREEN_COLUMNS.map(column),
            ..Self::default()
        })
    }

    /// How sides are known.
    ///
    /// # Errors
    /// If they are not.
    pub(super) fn source(&self, rule: Rule, plan: Option<&Plan>, row: u64) -> Result<SidesSource, Fault> {
        match (self.sides, plan) {
            _ if !rule.sides_recorded || self.sides_unknown.is_some() => Ok(SidesSource::Unknown),
            (Some(_), _) => Ok(SidesSource::InFile),
            (None, Some(plan)) if plan.shows_listed_sides() => Ok(SidesSource::AsListed),
            (None, Some(plan)) if self.stimulus.is_some() && plan.has_codes() => {
                Ok(SidesSource::FromCodeNames)
            }
            (None, Some(_)) if self.form.is_some() => Ok(SidesSource::FromForms),
            (None, _) => Err(Fault::NoSides { row }),
        }
    }
}
