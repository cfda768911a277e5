//! Digests the sources of every room, so that results made by other code are known to be stale, and names the commit.
//!
//! Sources, not the executable: the same sources may be linked into different executables (for tests, say), and must
//! not redo a study then.

use std::hash::Hasher;
use std::path::{Path, PathBuf};
use std::process::Command;

const ROOMS: [&str; 16] = [
    "mesh",
    "design",
    "responses",
    "field",
    "expression",
    "volume",
    "extract",
    "program",
    "raster",
    "bench",
    "statistics",
    "table",
    "timing",
    "analysis",
    "serve",
    "cli",
];

fn main() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let shared = [root.join("Cargo.lock"), root.join("assets")];
    for path in &shared {
        println!("cargo::rerun-if-changed={}", path.display());
    }
    for room in ROOMS {
        let folder = root.join("crates").join(room);
        println!("cargo::rerun-if-changed={}", folder.join("src").display());
        let mut files = Vec::new();
        // Only one room has a page, and the command's own pages are among its sources.
        let page = Some(folder.join("page")).filter(|page| page.is_dir());
        for path in shared.iter().cloned().chain([folder.join("src"), folder.join("Cargo.toml")]).chain(page)
        {
            collect(&path, &mut files);
        }
        // Arguments, progress, pages and surfaces without a study change no other result; the pages' digest is a room of its own.
        let aside = [
            "args.rs",
            "main.rs",
            "surface.rs",
            "turning.rs",
            "progress.rs",
            "page.rs",
            "index.html",
            "report.rs",
            "report.html",
        ];
        files.retain(|file| room != "cli" || !aside.iter().any(|name| file.ends_with(name)));
        files.sort();
        let mut parts = Vec::new();
        for file in files {
            parts.push(file.strip_prefix(&root).unwrap_or(&file).to_string_lossy().into_owned().into_bytes());
            parts.push(read(&file));
        }
        let parts: Vec<&[u8]> = parts.iter().map(Vec::as_slice).collect();
        println!("cargo::rustc-env=ISOSTUDY_ROOM_{}={:016x}", room.to_uppercase(), digest(&parts));
    }
    let pages = ["page/index.html", "pipeline/page.rs", "page/report.html", "pipeline/report.rs"];
    let pages = pages.map(|path| root.join("crates/cli/src").join(path));
    let text = pages.map(|path| read(&path)).concat();
    println!("cargo::rustc-env=ISOSTUDY_ROOM_PAGE={:016x}", digest(&[&text]));
    name_commit(&root);
}

/// The commit, and whether what is built has changes on top of it; empty without version control. Looked up again after a
/// commit or a change of a room, not at every build.
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

/// A source that is not there would leave its results for up to date for ever: no build without it.
fn read(path: &Path) -> Vec<u8> {
    std::fs::read(path)
        .unwrap_or_else(|error| panic!("{}, a source that is digested: {error}", path.display()))
}

fn collect(path: &Path, files: &mut Vec<PathBuf>) {
    if path.is_dir() {
        for entry in std::fs::read_dir(path).into_iter().flatten().flatten() {
            collect(&entry.path(), files);
        }
    } else {
        files.push(path.into());
    }
}

/// A fixed-key hash: nobody forges a source file here, it only has to notice change.
fn digest(parts: &[&[u8]]) -> u64 {
    #[expect(deprecated, reason = "the one hasher in std with a fixed key and a fixed algorithm")]
    let mut hasher = std::hash::SipHasher::new();
    parts.iter().for_each(|part| hasher.write(part));
    hasher.finish()
}
