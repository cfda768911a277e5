//! Studies, from outside.

mod messages;
mod page;
mod study_file;
