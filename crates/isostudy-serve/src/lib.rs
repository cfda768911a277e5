//! Puts a study's forms to people: the questionnaire's page, and a server that keeps their answers.
//!
//! The page is the same from a folder, from any static host and from the server ([`page`]). The server is a study's
//! [`FormFile`](isostudy_design::forms::FormFile) and a folder of stimuli put on a socket ([`serve`]); what it is told it writes into two
//! SQLite files, answers and identifiers apart ([`journal`]). The key that tells what a code name shows is used in one place,
//! [`export`], and nothing of it is ever sent to participants.
//!
//! # Guaranteed
//!
//! - An answer is acknowledged after it was committed and synced to disk, never before. Sent again, it changes nothing.
//! - Whoever begins gets one of the forms with the fewest participants, by chance, not counting those who gave up.
//! - Nothing is written down of those who have answered nothing.
//! - The server goes on or ends, and says which: without a log, on a full disk, and with its folder gone. Fewer answers than there
//!   were are noticed at the start.
//! - What one client costs is bounded, in memory, in connections and in sessions; nobody who has begun is forgotten for others.
//! - No address, agent or other trace of a participant is kept but the identifiers of a panel, which are in a file of their own.

pub mod anonymity;
pub mod cameras;
mod completions;
pub mod deidentify;
pub mod download;
pub mod export;
pub mod journal;
mod log;
mod machine;
pub mod page;
pub mod people;
pub mod record;
pub mod screen;
mod server;
pub mod shown;

pub use completions::Completions;
pub use journal::{Asked, Chooser, random_hex};
pub use server::{Judge, Limits, NoPublicUrl, PublicUrl, Rule, SHORTEST_TOKEN, ServeError, Settings, serve};
