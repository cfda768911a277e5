//! Digests the sources of every room, so that results made by other code are known to be stale.
//!
//! Sources, not the executable: the same sources may be linked into different executables (for tests, say), and must
//! not redo a study then.

use std::hash::Hasher;
use std::path::{Path, PathBuf};

const ROOMS: [&str; 7] = ["mesh", "design", "extract", "raster", "bench", "analysis", "cli"];

fn main() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let shared = [root.join("Cargo.lock"), root.join("assets")];
    for path in &shared {
        println!("cargo::rerun-if-changed={}", path.display());
    }
    for room in ROOMS {
        let folder = root.join("crates").join(room);
        println!("cargo::rerun-if-changed={}", folder.join("src").display());
        // A fixed-key hash: nobody forges a source file here, it only has to notice change.
        #[expect(deprecated, reason = "the one hasher in std with a fixed key and a fixed algorithm")]
        let mut hasher = std::hash::SipHasher::new();
        let mut files = Vec::new();
        for path in shared.iter().cloned().chain([folder.join("src"), folder.join("Cargo.toml")]) {
            collect(&path, &mut files);
        }
        files.sort();
        for file in files {
            let name = file.strip_prefix(&root).unwrap_or(&file).to_string_lossy().into_owned();
            hasher.write(name.as_bytes());
            hasher.write(&std::fs::read(&file).unwrap_or_default());
        }
        println!("cargo::rustc-env=ISOSTUDY_ROOM_{}={:016x}", room.to_uppercase(), hasher.finish());
    }
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
