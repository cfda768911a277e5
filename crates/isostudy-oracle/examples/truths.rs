//! Plants every truth in every design, compares every number with a second computation, and prints how it went.
//!
//! `cargo run --release --locked -p isostudy-oracle --example truths`; every cell that is wrong goes to stderr.

use std::process::ExitCode;

fn main() -> ExitCode {
    let (table, right) = isostudy_oracle::truths();
    println!("{}", table.to_markdown());
    if right {
        return ExitCode::SUCCESS;
    }
    isostudy_oracle::wrong_cells().iter().for_each(|line| eprintln!("{line}"));
    ExitCode::FAILURE
}
