//! Exports of questionnaires in, validated answers out.
//!
//! [`read`] takes a file as people have it (a study's own table, the long format, or the export of a survey tool) and gives
//! [`Responses`], one value an answer, with a [`Report`] of how the file was understood and of every cell that was
//! repaired or rejected. What the file does not say is declared by a [`Plan`] (the questions) and a [`Mapping`] (positions,
//! words, policies). [`write_long`] and its neighbours write
//! answers again.
//!
//! # Sides
//! An answer has the sides that the participant saw. A file names them, or has the code names or form numbers from which a study
//! knows them. Without any of these it is read only where everybody was shown the listed sides, and refused otherwise: see
//! [`SidesSource`], which [`Responses`] and [`Report`] carry.
//!
//! # Guarantees
//! - No input panics; what is wrong is an error that names file, row and column.
//! - Nothing is dropped silently and nothing is guessed: every cell that is not taken as it stands is in the report, and where two
//!   readings fit, the error shows both.

mod address;
mod asked;
mod choice;
mod collect;
mod decode;
mod error;
mod format;
mod formats;
mod mapping;
mod name;
mod natural;
mod person_columns;
mod plan;
mod read;
mod report;
mod screen;
mod several;
mod shown;
mod sides;
mod value;
mod words;
mod write;

pub use choice::{Choice, Step};
pub use collect::MOST_COUNTED;
pub use decode::archive::LARGEST_ARCHIVE;
pub use error::{Fault, ReadError, UnknownCell};
pub use format::Format;
pub use formats::long::{LONG_COLUMNS, LONG_NEEDED};
pub use mapping::{Duplicates, Mapping, MappingError, Unknown};
pub use name::LONGEST_NAME;
pub use person_columns::{PersonColumns, PersonColumnsError, parse_person_columns, read_person_columns};
pub use plan::{Plan, PlannedPair};
pub use read::{LARGEST_FILE, Reading, parse, read};
pub use report::{Kind, Remark, Report};
pub use screen::{SCREEN_COLUMNS, Screen, ScreenId};
pub use several::{SHOWN_COLUMN, read_several};
pub use sides::SidesSource;
pub use value::{
    Answer, Judged, Participant, PersonColumn, Question, Responses, StimulusId, UnknownStimuli, Verdict,
};
pub use words::{Words, normalise};
pub use write::{
    LONG_WRITTEN, LONG_WRITTEN_WITH_SCREENS, Ties, WriteError, Written, write_arenakit, write_long,
    write_pwcmp,
};
