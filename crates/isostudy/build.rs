//! Digests the sources of every crate, so that results made by other code are known to be stale, and names the commit.
//!
//! Sources, not the executable: the same sources may be linked into different executables (for tests, say), and must
//! not redo a study then.

use std::hash::Hasher;
use std::path::{Path, PathBuf};
use std::process::Command;

const CRATES: [&str; 24] = [
    "mesh",
    "cells",
    "design",
    "responses",
    "field",
    "foreign",
    "expression",
    "volume",
    "grid",
    "scattered",
    "extract",
    "trilinear",
    "finish",
    "program",
    "raster",
    "bench",
    "statistics",
    "table",
    "timing",
    "inference",
    "report",
    "paper",
    "serve",
    "cli",
];

/// The pages that people read: a digest of their own.
const PAGES: &str = "pipeline/pages";
/// Modules of the command that change no result: what is asked, what is said meanwhile, and how it ended.
const ASIDE: [&str; 8] = ["main", "commands", "consent", "help", "outcome", "paths", "terminal", "work_time"];

fn main() {
    let root = Path::new(&std::env::var("CARGO_MANIFEST_DIR").expect("cargo says where the package is"))
        .join("../..");
    let shared = [root.join("Cargo.lock"), root.join("assets")];
    for name in CRATES {
        let folder = root.join("crates").join(match name {
            "cli" => "isostudy".to_owned(),
            library => format!("isostudy-{library}"),
        });
        // Only one crate has a page.
        let page = Some(folder.join("page")).filter(|page| page.is_dir());
        let own = [folder.join("src"), folder.join("Cargo.toml")].into_iter().chain(page);
        let mut files = Vec::new();
        for path in shared.iter().cloned().chain(own) {
            println!("cargo::rerun-if-changed={}", path.display());
            files.extend(files_at(&path));
        }
        if name == "cli" {
            let src = folder.join("src");
            let mut pages = take_module(&mut files, &src, PAGES);
            // The pages have its words.
            pages.push(root.join("docs/glossary.md"));
            ASIDE.iter().for_each(|module| drop(take_module(&mut files, &src, module)));
            name_digest("page", &root, pages);
        }
        name_digest(name, &root, files);
    }
    name_commit(&root);
}

/// Takes a module's files out of a list: `x.rs` and all in `x`.
fn take_module(files: &mut Vec<PathBuf>, src: &Path, module: &str) -> Vec<PathBuf> {
    let (file, folder) = (src.join(module).with_extension("rs"), src.join(module));
    let taken: Vec<PathBuf> =
        files.extract_if(.., |path| *path == file || path.starts_with(&folder)).collect();
    assert!(!taken.is_empty(), "{module}: there is no such module; it has moved, and this list must follow");
    taken
}

/// The digest of sources, by their paths from the root and their contents, as an environment variable of the build.
fn name_digest(name: &str, root: &Path, mut files: Vec<PathBuf>) {
    files.sort();
    let mut parts = Vec::new();
    for file in files {
        parts.push(file.strip_prefix(root).unwrap_or(&file).to_string_lossy().into_owned().into_bytes());
        parts.push(read(&file));
    }
    let parts: Vec<&[u8]> = parts.iter().map(Vec::as_slice).collect();
    println!("cargo::rustc-env=ISOSTUDY_SOURCES_{}={:016x}", name.to_uppercase(), digest(&parts));
}

/// The commit, and whether what is built has changes on top of it; empty without version control. Looked up again after a
/// commit or a change of a crate, not at every build.
fn name_commit(root: &Path) {
    let git = |arguments: &[&str]| -> Option<String> {
        let output = Command::new("git").arg("-C").arg(root).args(arguments).output().ok()?;
        output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
    };
    let commit = git(&["rev-parse", "HEAD"]).unwrap_or_default();
    let built = ["crates", "assets", "Cargo.toml", "Cargo.lock"];
    let changes = git(&[&["status", "--porcelain", "--"], &built[..]].concat());
    let dirty = changes
        .filter(|_| !commit.is_empty())
        .map_or("", |changes| if changes.is_empty() { "no" } else { "yes" });
    println!("cargo::rustc-env=ISOSTUDY_COMMIT={commit}");
    println!("cargo::rustc-env=ISOSTUDY_DIRTY={dirty}");
    // Every commit and checkout writes here. A file that is not there would make every build start over.
    if let Some(log) =
        git(&["rev-parse", "--git-path", "logs/HEAD"]).map(|log| root.join(log)).filter(|log| log.is_file())
    {
        println!("cargo::rerun-if-changed={}", log.display());
    }
}

/// A source that cannot be read would leave its results for up to date for ever: no build without it.
fn read(path: &Path) -> Vec<u8> {
    std::fs::read(path).unwrap_or_else(|error| unreadable(path, &error))
}

/// Every file at or below a path.
fn files_at(path: &Path) -> Vec<PathBuf> {
    if !path.is_dir() {
        return vec![path.into()];
    }
    let entries = std::fs::read_dir(path).unwrap_or_else(|error| unreadable(path, &error));
    let below = |entry: std::io::Result<std::fs::DirEntry>| {
        files_at(&entry.unwrap_or_else(|error| unreadable(path, &error)).path())
    };
    entries.flat_map(below).collect()
}

fn unreadable(path: &Path, error: &std::io::Error) -> ! {
    panic!("{}, a source that is digested: {error}", path.display())
}

/// A fixed-key hash: nobody forges a source file here, it only has to notice change.
fn digest(parts: &[&[u8]]) -> u64 {
    #[expect(deprecated, reason = "the one hasher in std with a fixed key and a fixed algorithm")]
    let mut hasher = std::hash::SipHasher::new();
    parts.iter().for_each(|part| hasher.write(part));
    hasher.finish()
}
