//! A copy of the quick study in a folder of its own, its bunny replaced by a small solid so that nothing is fetched.

use crate::command::{Run, isostudy};
use sha2::Digest;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

pub(crate) struct Fixture {
    folder: TempDir,
    out: PathBuf,
}

/// An octahedron that fits the bunny's volume, triangles outward.
const SOLID: &str = "v 0.6 0 0\nv -0.6 0 0\nv 0 0.3 0\nv 0 -0.3 0\nv 0 0 0.4\nv 0 0 -0.4\n\
    f 1 3 5\nf 3 2 5\nf 2 4 5\nf 4 1 5\nf 3 1 6\nf 2 3 6\nf 4 2 6\nf 1 4 6\n";

impl Fixture {
    pub(crate) fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap();
        let text = fs::read_to_string(root.join("configs/quick.toml")).unwrap();
        let digest: String = sha2::Sha256::digest(SOLID).iter().map(|b| format!("{b:02x}")).collect();
        let sources = text.find("[[objects.field.sources]]").unwrap();
        let after = text.find("[turntable]").unwrap();
        let source = format!(
            "[[objects.field.sources]]\nfile = \"solid.obj\"\nsha256 = \"{digest}\"\naxes = [\"x\", \"y\", \"z\"]\n\
             scale = 1.0\noffset = [0.0, 0.0, 0.0]\n\n"
        );
        let text = format!("{}{source}{}", &text[..sources], &text[after..])
            .replace("\"../", &format!("\"{}/", root.display()))
            .replace("\"cpu/", &format!("\"{}/configs/cpu/", root.display()));
        // Whether there is a viewer depends on what was fetched.
        let (viewer, benchmark) = (text.find("[viewer]").unwrap(), text.find("[benchmark]").unwrap());
        let text = format!("{}{}", &text[..viewer], &text[benchmark..]);
        fs::write(folder.path().join("study.toml"), text).unwrap();
        fs::write(folder.path().join("solid.obj"), SOLID).unwrap();
        let out = folder.path().join("out");
        Self { folder, out }
    }

    /// The quick study asked as in configs/balanced.toml. The published answers are none to such forms, so it has no answers.
    pub(crate) fn balanced() -> Self {
        let fixture = Self::new();
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let text = fs::read_to_string(root.join("configs/balanced.toml")).unwrap();
        let forms = &text[text.find("[forms]").unwrap()..];
        fixture.edit_with(|study| format!("{}{forms}", &study[..study.find("[responses]").unwrap()]));
        fixture
    }

    pub(crate) fn folder(&self) -> &Path {
        self.folder.path()
    }

    pub(crate) fn config(&self) -> PathBuf {
        self.folder.path().join("study.toml")
    }

    pub(crate) fn out(&self) -> &Path {
        &self.out
    }

    /// `isostudy <name> study.toml --out out`.
    pub(crate) fn command(&self, name: &str) -> Command {
        let mut command = isostudy();
        command.arg(name).arg(self.config()).arg("--out").arg(self.out());
        command
    }

    /// Runs `isostudy <name> study.toml --out out` with more arguments.
    pub(crate) fn run(&self, name: &str, arguments: &[&str]) -> Run {
        Run::of(self.command(name).args(arguments))
    }

    /// As `run`, and it must end well.
    pub(crate) fn succeed(&self, name: &str, arguments: &[&str]) -> Run {
        Run::succeed(self.command(name).args(arguments))
    }

    /// Puts a shell script in ffmpeg's place; returns the PATH that finds it first.
    #[cfg(unix)]
    pub(crate) fn with_ffmpeg(&self, script: &str) -> String {
        use std::os::unix::fs::PermissionsExt;
        let program = self.folder().join("ffmpeg");
        fs::write(&program, script).unwrap();
        fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
        format!("{}:{}", self.folder().display(), std::env::var("PATH").unwrap())
    }

    /// Replaces the first occurrence in the study file.
    pub(crate) fn edit(&self, from: &str, to: &str) {
        self.edit_with(|text| {
            assert!(text.contains(from), "{from} is not in the study");
            text.replacen(from, to, 1)
        });
    }

    pub(crate) fn edit_with(&self, change: impl FnOnce(&str) -> String) {
        let text = fs::read_to_string(self.config()).unwrap();
        fs::write(self.config(), change(&text)).unwrap();
    }
}

/// Every file below a folder but the stamps, by path.
pub(crate) fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    fn collect(root: &Path, folder: &Path, found: &mut BTreeMap<String, Vec<u8>>) {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                collect(root, &path, found);
            } else {
                let name = path.strip_prefix(root).unwrap().to_str().unwrap().replace('\\', "/");
                found.insert(name, fs::read(&path).unwrap());
            }
        }
    }
    let mut found = BTreeMap::new();
    collect(folder, folder, &mut found);
    found.retain(|path, _| !path.starts_with(".stages/"));
    found
}

/// Leaves out what holds measured times or digests of such.
///
/// Of the benchmark table, the columns of times and their shares go and the counts stay.
pub(crate) fn without_measured_times(mut files: BTreeMap<String, Vec<u8>>) -> BTreeMap<String, Vec<u8>> {
    let benchmark = String::from_utf8(files["tables/benchmark.csv"].clone()).unwrap();
    let first = benchmark.lines().next().unwrap().split(',');
    let measured = |name: &str| {
        name.ends_with("_s") || ["sampling_fraction", "vertex_fraction", "geometry_fraction"].contains(&name)
    };
    let kept: Vec<bool> = first.map(|name| !measured(name)).collect();
    assert!(kept.contains(&false) && kept.iter().filter(|kept| **kept).count() > 10);
    let cut = |line: &str| -> Vec<String> {
        line.split(',').zip(&kept).filter(|(_, kept)| **kept).map(|(cell, _)| cell.to_owned()).collect()
    };
    let counts: Vec<String> = benchmark.lines().map(|line| cut(line).join(",")).collect();
    files.insert("counts".into(), counts.join("\n").into_bytes());
    if let Some(contents) = files.remove("figures/contents.json") {
        files.insert("captions".into(), captions_without_times(&contents).into_bytes());
    }
    const MEASURED: [&str; 21] = [
        "bench/",
        "data/times.",
        "index.html",
        "manifest.json",
        "report.",
        "tables/benchmark.",
        "tables/asteroid.",
        "tables/abstract.",
        "tables/choices.",
        "tables/decision.",
        "tables/fronts.",
        "tables/claims.",
        "tables/comparison.",
        "tables/contents.json",
        "tables/comparison_summary.",
        "figures/fronts.",
        "figures/pass_times.",
        "figures/stage_times.",
        "figures/fronts-narrow.",
        "figures/pass_times-narrow.",
        "figures/stage_times-narrow.",
    ];
    files.retain(|path, _| !MEASURED.iter().any(|start| path.starts_with(start)));
    files
}

/// Names and captions of the figures whose captions do not name the machine that measured times.
fn captions_without_times(contents: &[u8]) -> String {
    let figures: Vec<serde_json::Value> = serde_json::from_slice(contents).unwrap();
    let text = |figure: &serde_json::Value, key: &str| figure[key].as_str().unwrap().to_owned();
    let captions = figures.iter().map(|figure| (text(figure, "name"), text(figure, "caption")));
    let without = captions.filter(|(name, _)| !["fronts", "pass_times", "stage_times"].contains(&&**name));
    without.map(|(name, caption)| format!("{name}: {caption}\n")).collect()
}
