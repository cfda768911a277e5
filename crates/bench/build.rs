//! Tells the crate which compiler builds it: a benchmark's machine record names it, and may start no process itself.

use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=RUSTC");
    let variable = |name: &str| std::env::var(name).unwrap_or_else(|_| "unknown".into());
    let version = Command::new(variable("RUSTC")).arg("--version").output();
    let version = match &version {
        Ok(output) if output.status.success() => String::from_utf8_lossy(&output.stdout).trim().to_owned(),
        _ => "rustc of unknown version".to_owned(),
    };
    // The profile, not this crate's opt-level: profiles here give other crates levels of their own.
    println!("cargo::rustc-env=BENCH_COMPILER={version}, {} build", variable("PROFILE"));
}
