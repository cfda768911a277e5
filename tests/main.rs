//! Tests of the whole: the command as a user runs it, and the pages and files it makes.

mod answers;
mod any_method;
mod asking;
mod bench;
mod command;
mod continuation;
mod data;
mod distance;
mod edges;
mod finish;
mod fixture;
mod football;
mod foreign;
mod gate;
mod grids;
mod http;
mod isovalues;
mod labels;
mod large_volumes;
mod memory;
mod messages;
mod named;
mod page;
mod scattered;
mod serve;
mod server;
mod study;
#[path = "../crates/isostudy-design/tests/it/page.rs"]
mod study_page;
mod surface;
mod table;
mod terrain;
mod truths;
mod turning;
mod verify;
mod viewer;
