//! How much a folder held when it was last written to: `count`, a small file beside the databases. SQLite cannot know that a
//! file of its own is gone or was cut; this tells.

use crate::machine::{Machine, Owned};
use std::fmt;
use std::io;
use std::path::Path;

pub(super) const NAME: &str = "count";

/// How much there is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Held {
    /// Answers.
    pub answers: u64,
    /// Participants who gave them.
    pub participants: u64,
    /// Participants of whom a panel's identifiers are kept.
    pub identities: u64,
}

impl Held {
    /// Whether any of it is less than it was.
    pub(super) fn lacks(&self, before: &Self) -> bool {
        self.answers < before.answers
            || self.participants < before.participants
            || self.identities < before.identities
    }
}

impl fmt::Display for Held {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let counted =
            |number: u64, word: &str| format!("{number} {word}{}", if number == 1 { "" } else { "s" });
        write!(f, "{} of {}", counted(self.answers, "answer"), counted(self.participants, "participant"))?;
        match self.identities {
            0 => Ok(()),
            known => write!(f, ", {known} of them with identifiers"),
        }
    }
}

/// What the file said.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Sealed {
    /// Nothing: the folder is new, or older than this file.
    Nothing,
    /// So much.
    Held(Held),
    /// Something else than was written.
    Damaged,
}

impl Sealed {
    /// Reads the file, and leaves it as it is.
    pub(super) fn read(machine: &dyn Machine, folder: &Path) -> io::Result<Self> {
        // As much as is ever written, and one byte more.
        let longest = line(&Held::default()).len() as u64 + 1;
        match machine.read(&folder.join(NAME), longest) {
            Ok(text) => Ok(parse(&text)),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Self::Nothing),
            Err(error) => Err(error),
        }
    }
}

/// The open file.
pub(super) struct Seal {
    file: Box<dyn Owned>,
    written: Option<Held>,
}

impl Seal {
    /// Opens the file, which is made if it is not there.
    pub(super) fn open(machine: &dyn Machine, folder: &Path) -> io::Result<Self> {
        Ok(Self { file: machine.open(&folder.join(NAME))?, written: None })
    }

    /// Writes what there is over what was there, if it changed. What is written was committed before, so a file that is older than
    /// the databases after a loss of power claims less than they hold, and never more.
    pub(super) fn write(&mut self, held: Held) -> io::Result<()> {
        if self.written != Some(held) {
            // All lines are of one length and in one sector of a disk: the line is the old one or the new one.
            self.file.write(line(&held).as_bytes())?;
            self.written = Some(held);
        }
        Ok(())
    }

    /// What to write before a commit that leaves `held`, where any of it is less than what was written.
    pub(super) fn less(&self, held: Held) -> Option<Held> {
        let before = self.written.filter(|before| held.lacks(before))?;
        Some(Held {
            answers: before.answers.min(held.answers),
            participants: before.participants.min(held.participants),
            identities: before.identities.min(held.identities),
        })
    }

    /// Has it on disk too.
    pub(super) fn sync(&self) -> io::Result<()> {
        self.file.sync()
    }
}

fn line(held: &Held) -> String {
    let Held { answers, participants, identities } = held;
    let text = format!("isostudy 1 {answers:020} {participants:020} {identities:020}");
    let check = checksum(text.as_bytes());
    format!("{text} {check:016x}\n")
}

fn parse(text: &[u8]) -> Sealed {
    if text.is_empty() {
        return Sealed::Nothing;
    }
    let words: Vec<&str> =
        std::str::from_utf8(text).map_or_else(|_| Vec::new(), |text| text.split(' ').collect());
    let number = |place: usize| words.get(place).and_then(|word| word.parse().ok());
    let found = || Some(Held { answers: number(2)?, participants: number(3)?, identities: number(4)? });
    found().filter(|held| line(held).as_bytes() == text).map_or(Sealed::Damaged, Sealed::Held)
}

/// FNV-1a of 64 bits: nobody forges the file, only damage has to be noticed.
fn checksum(bytes: &[u8]) -> u64 {
    bytes
        .iter()
        .fold(0xcbf2_9ce4_8422_2325, |sum, &byte| (sum ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::System;

    /// The values of the authors' test suite (draft-eastlake-fnv, appendix C).
    #[test]
    fn the_checksum_is_fnv() {
        let expected =
            [("", 0xcbf2_9ce4_8422_2325), ("a", 0xaf63_dc4c_8601_ec8c), ("foobar", 0x8594_4171_f739_67e8)];
        assert!(expected.iter().all(|(text, sum)| checksum(text.as_bytes()) == *sum));
    }

    #[test]
    fn a_changed_byte_is_noticed() {
        let held = Held { answers: 30, participants: 5, identities: 1 };
        let whole = line(&held).into_bytes();
        assert_eq!(parse(&whole), Sealed::Held(held));
        assert_eq!(parse(b""), Sealed::Nothing);
        for at in 0..whole.len() {
            let mut other = whole.clone();
            other[at] ^= 1;
            assert_eq!(parse(&other), Sealed::Damaged, "byte {at}");
            assert_eq!(parse(&whole[..at.max(1)]), Sealed::Damaged, "{at} bytes");
        }
        assert_eq!(parse(&[&whole[..], b" "].concat()), Sealed::Damaged);
    }

    #[test]
    fn what_was_written_last_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let read = || Sealed::read(&System, folder.path()).unwrap();
        assert_eq!(read(), Sealed::Nothing);
        let mut seal = Seal::open(&System, folder.path()).unwrap();
        assert_eq!(read(), Sealed::Nothing);
        for answers in [1, 100_000, 7] {
            seal.write(Held { answers, participants: 1, identities: 0 }).unwrap();
        }
        assert_eq!(read(), Sealed::Held(Held { answers: 7, participants: 1, identities: 0 }));
    }
}
