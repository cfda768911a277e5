//! The one door for what is foreign: files that somebody names, processes that are started, and text that came out of either.
//!
//! # Files
//!
//! [`open`], [`bytes`] and [`text`] take regular files alone. A folder, a device, a pipe or a socket is [`FileProblem::NotAFile`], and
//! none of them is waited for. What is read has a limit in bytes, and text has one for its lines. Every error names the path. Of a file
//! that is larger than memory, [`Parts`] are read; it must stay as it is meanwhile.
//!
//! # Processes
//!
//! A [`Child`] is a process that answers by lines. It has limits of time, of memory and of line length, and the end of its standard
//! error is kept. What it started is ended with it: on an error, when it is dropped, and on Ctrl-C and SIGTERM. A [`Folder`] is
//! temporary, and goes in the same cases.
//!
//! A process that is killed can end nothing. So a program calls [`wrapper`] first thing. From then on it starts children through
//! itself, and the kernel kills each child when the program is gone.
//!
//! # Text
//!
//! [`shown`] and [`shown_in_a_line`] escape what would forge a terminal's or a page's text.
//!
//! # Not guaranteed
//!
//! - This is no sandbox.
//! - What a child started is known by its process group, its session, and a variable in its environment. A process that leaves all
//!   three is neither counted nor ended. If this process is killed, the kernel ends the children, and not what they started.
//! - Memory is looked at while an answer is awaited, every 50 ms. A second limit, of the kernel, keeps a leap between two looks small.
//!   Both are Linux's.

mod child;
mod file;
mod folder;
mod group;
mod interrupt;
mod lines;
mod parts;
mod processes;
mod shown;
mod tail;
mod wrapper;

pub use child::{Child, Limits, Stopped};
pub use file::{FileError, FileProblem, Kind, LINE_LIMIT_BYTES, bytes, open, text};
pub use folder::Folder;
pub use group::{End, Memory};
pub use interrupt::leave_signals_to_others;
pub use lines::Heard;
pub use parts::Parts;
pub use shown::{shown, shown_in_a_line};
pub use tail::Told;
pub use wrapper::wrapper;
