//! Tells the crate how it is built: a benchmark's machine record names compiler, flags and target.

use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    for name in ["RUSTC", "CARGO_ENCODED_RUSTFLAGS"] {
        println!("cargo::rerun-if-env-changed={name}");
    }
    let variable = |name: &str| std::env::var(name).unwrap_or_else(|_| "unknown".into());
    let version = Command::new(variable("RUSTC")).arg("--version").output();
    let version = match &version {
        Ok(output) if output.status.success() => String::from_utf8_lossy(&output.stdout).trim().to_owned(),
        _ => "rustc of unknown version".to_owned(),
    };
    let flags = std::env::var("CARGO_ENCODED_RUSTFLAGS").unwrap_or_default();
    let flags: Vec<&str> = flags.split('\x1f').filter(|flag| !flag.is_empty()).collect();
    // `-Ctarget-cpu=x` is one flag, `-C target-cpu=x` two; the last one counts.
    let named = flags
        .iter()
        .rev()
        .find_map(|flag| flag.strip_prefix("-C").unwrap_or(flag).strip_prefix("target-cpu="));
    let default = if variable("CARGO_CFG_TARGET_ARCH") == "x86_64" { "x86-64" } else { "generic" };
    println!("cargo::rustc-env=BENCH_COMPILER={version}");
    println!("cargo::rustc-env=BENCH_PROFILE={}", variable("PROFILE"));
    println!("cargo::rustc-env=BENCH_OPT_LEVEL={}", variable("OPT_LEVEL"));
    println!("cargo::rustc-env=BENCH_RUSTFLAGS={}", flags.join(" "));
    println!("cargo::rustc-env=BENCH_TARGET_CPU={}", named.unwrap_or(default));
}
