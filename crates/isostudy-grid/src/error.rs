//! What can be wrong with a grid's files.

use std::path::{Path, PathBuf};

use isostudy_foreign::FileProblem;
use thiserror::Error;

/// What is wrong, and with which file.
#[derive(Debug, Error)]
#[error("{}: {problem}", .file.display())]
pub struct GridError {
    /// The file.
    pub file: PathBuf,
    /// What is wrong with it. It is in the message, hence not a source of its own.
    pub problem: Box<Problem>,
}

/// What is wrong. Lines count from 1; points and cells from 0, in the order of the file.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Problem {
    /// The file cannot be opened or read, or is larger than the limit.
    #[error(transparent)]
    File(#[from] FileProblem),
    /// The name's ending tells no format.
    #[error("known endings are .vtu, .vts, .vtk, .node and .ele")]
    Ending,
    /// The text breaks its format.
    #[error("line {line}: {reason}")]
    Line {
        /// Where.
        line: usize,
        /// What is wrong there.
        reason: String,
    },
    /// An array of numbers is damaged.
    #[error("line {line}: the array `{name}`: {reason}")]
    Array {
        /// Where it is declared.
        line: usize,
        /// Its name, cut after 40 characters.
        name: String,
        /// What is wrong with it.
        reason: String,
    },
    /// A cell that cannot be taken.
    #[error("cell {cell}: {reason}")]
    Cell {
        /// Which.
        cell: u64,
        /// Why not.
        reason: String,
    },
    /// A point that lies nowhere.
    #[error("point {point} lies at {at:?}, which is no place in single precision")]
    Point {
        /// Which.
        point: usize,
        /// Its coordinates.
        at: [f64; 3],
    },
    /// The file has something else than what it should have.
    #[error("{0}")]
    Whole(String),
    /// No array has the name.
    #[error("no array on points has the name `{asked}`{}", there_are(arrays))]
    NoArray {
        /// The name that was asked for, cut after 40 characters.
        asked: String,
        /// The names of those on points.
        arrays: Vec<String>,
    },
    /// No name was given, and there is not one array alone.
    #[error("which array shall be taken is not said{}", there_are(arrays))]
    NotNamed {
        /// The names of those on points.
        arrays: Vec<String>,
    },
    /// The array has a value per cell.
    #[error(
        "the array `{name}` has its values on cells. A surface needs values on points, between which it interpolates. \
         ParaView's filter Cell Data to Point Data makes them{}",
        there_are(arrays)
    )]
    OnCells {
        /// The array.
        name: String,
        /// The names of those on points.
        arrays: Vec<String>,
    },
    /// The array has several numbers per point.
    #[error("the array `{name}` has {components} numbers per point; a surface needs one")]
    NotScalar {
        /// The array.
        name: String,
        /// How many.
        components: usize,
    },
    /// More than may be held.
    #[error("{what} take {needed} bytes of memory, and the limit is {limit}")]
    TooLarge {
        /// What does.
        what: String,
        /// How many bytes.
        needed: u64,
        /// How many there may be.
        limit: u64,
    },
}

impl Problem {
    pub(crate) fn in_file(self, file: &Path) -> GridError {
        GridError { file: file.to_owned(), problem: Box::new(self) }
    }

    pub(crate) fn line(line: usize, reason: impl Into<String>) -> Self {
        Self::Line { line, reason: reason.into() }
    }

    pub(crate) fn cell(cell: usize, reason: impl Into<String>) -> Self {
        Self::Cell { cell: cell as u64, reason: reason.into() }
    }
}

fn there_are(arrays: &[String]) -> String {
    match arrays {
        [] => "; the file has none on points".to_owned(),
        [one] => format!("; the one on points is `{one}`"),
        _ => format!("; those on points are `{}`", arrays.join("`, `")),
    }
}

/// What a file says may be anything, and long.
pub(crate) fn shortened(text: &str) -> String {
    text.chars().take(40).collect()
}
