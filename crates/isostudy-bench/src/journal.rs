//! What a run has done so far, line by line, so that a killed run goes on in the middle of a round.

use isostudy_design::ConfigurationId;
use isostudy_design::record::{
    Allocations, BenchSample, Failure, InvalidSample, LoadWindow, PeakMemory, Resumption,
};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

/// One line of a journal: something that happened, written when it happened.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "entry", rename_all = "kebab-case")]
pub enum Entry {
    /// The first line.
    Begun {
        /// Digest of everything that the run depends on: plan, machine, code.
        key: String,
    },
    /// A measured sample.
    Sample(BenchSample),
    /// A sample of the A/A block.
    AaSample(BenchSample),
    /// What the machine did meanwhile.
    Load(LoadWindow),
    /// Peak memory of a configuration.
    Memory(PeakMemory),
    /// What a configuration asks of the allocator; its memory comes after it.
    Allocations(Allocations),
    /// The run was taken up again.
    Resumed(Resumption),
    /// A configuration failed; from here on it is left out.
    Failed(Failure),
}

impl Entry {
    /// The entry as a line of JSON, with its end.
    ///
    /// # Panics
    /// Never: the entry is plain data, and its numbers are finite.
    pub fn line(&self) -> String {
        line(self)
    }
}

pub(crate) fn line(entry: &impl Serialize) -> String {
    serde_json::to_string(entry).expect("plain data serialises") + "\n"
}

/// A journal's entries. A last line that was not written to its end is left out: the run was killed while writing it.
pub(crate) fn entries<E: DeserializeOwned>(text: &str) -> impl Iterator<Item = Result<E, JournalError>> {
    let whole = &text[..text.rfind('\n').map_or(0, |end| end + 1)];
    whole.lines().zip(1..).map(|(line, number)| {
        serde_json::from_str(line).map_err(|error| JournalError::Line { number, reason: error.to_string() })
    })
}

/// The entries of a journal after its first line, but for a last one that was not written to its end.
///
/// # Errors
/// [`JournalError`] if it belongs to another run or is damaged; nothing of it may be used then.
pub fn read_journal(text: &str, key: &str) -> Result<Vec<Entry>, JournalError> {
    let mut entries = entries(text);
    match entries.next().transpose()? {
        None => return Ok(Vec::new()),
        Some(Entry::Begun { key: found }) if found == key => {}
        Some(_) => return Err(JournalError::OtherRun),
    }
    entries.collect()
}

/// Why a journal is of no use.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum JournalError {
    /// Its key is another.
    #[error("it is of another plan, machine or version of the program")]
    OtherRun,
    /// A line is not an entry.
    #[error("line {number}: {reason}")]
    Line {
        /// Which, from 1.
        number: usize,
        /// What is wrong with it.
        reason: String,
    },
    /// A sample that no clock can have given.
    #[error("a sample of {id}: {reason}")]
    Invalid {
        /// Of which configuration.
        id: ConfigurationId,
        /// What is wrong with it.
        reason: InvalidSample,
    },
    /// Its samples are not those that the plan begins with.
    #[error("its samples do not follow the plan")]
    OtherOrder,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::tests::mock_run;

    fn entries() -> Vec<Entry> {
        let run = mock_run();
        let window = run.load[0].clone();
        let mut entries = vec![Entry::Load(window)];
        entries.extend(run.samples.into_iter().map(Entry::Sample));
        entries.extend(run.aa_samples.into_iter().map(Entry::AaSample));
        entries.extend(run.memory.into_iter().map(Entry::Memory));
        entries.extend(run.allocations.into_iter().map(Entry::Allocations));
        entries.push(Entry::Resumed(Resumption { invocation: 1, iteration: 2, place: 3 }));
        entries.push(Entry::Failed(Failure { id: "ss_bu".parse().unwrap(), reason: "no answer".into() }));
        entries
    }

    fn text(key: &str) -> String {
        let begun = Entry::Begun { key: key.into() }.line();
        entries().iter().fold(begun, |text, entry| text + &entry.line())
    }

    #[test]
    fn entries_read_back_unchanged() {
        assert_eq!(read_journal(&text("k"), "k").unwrap(), entries());
        assert_eq!(read_journal("", "k").unwrap(), []);
    }

    #[test]
    fn a_line_cut_short_is_left_out_wherever_the_cut_is() {
        let whole = text("k");
        let ends: Vec<usize> = whole.match_indices('\n').map(|(at, _)| at + 1).collect();
        for cut in 0..whole.len() {
            let lines = ends.iter().filter(|end| **end <= cut).count();
            let read = read_journal(&whole[..cut], "k").unwrap();
            assert_eq!(read, entries()[..lines.saturating_sub(1)], "cut at {cut}");
        }
    }

    #[test]
    fn another_runs_journal_is_refused() {
        assert_eq!(read_journal(&text("k"), "other"), Err(JournalError::OtherRun));
        let headless = text("k").split_once('\n').unwrap().1.to_owned();
        assert_eq!(read_journal(&headless, "k"), Err(JournalError::OtherRun));
        let damaged = text("k").replacen("others", "andere", 1);
        assert!(matches!(read_journal(&damaged, "k"), Err(JournalError::Line { number: 2, .. })));
    }
}
