//! Studies, from outside.

mod page;
mod study_file;
