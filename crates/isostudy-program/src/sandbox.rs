//! Programs by bubblewrap: a read-only system, a folder of their own, no network.

use std::ffi::OsString;
use std::path::Path;
use std::process::Command;
use std::sync::OnceLock;
use std::time::Duration;

use isostudy_foreign::{Child, End, Limits};

use crate::error::Problem;

const BUBBLEWRAP: &str = "bwrap";
/// How long the smallest program may take in it.
const TRIAL: Duration = Duration::from_secs(20);

/// What stands before a command: everything is there to be read, only `folder` to be written, and sockets of the system's services
/// are hidden. Processes end with the first of them.
fn confinement(folder: &Path) -> Vec<OsString> {
    let mut words: Vec<OsString> = [
        "--unshare-all",
        "--die-with-parent",
        "--cap-drop",
        "ALL",
        "--ro-bind",
        "/",
        "/",
        "--dev",
        "/dev",
        "--proc",
        "/proc",
        "--tmpfs",
        "/run",
        "--ro-bind-try",
        "/run/current-system",
        "/run/current-system",
    ]
    .map(OsString::from)
    .to_vec();
    if Path::new("/tmp/.X11-unix").is_dir() {
        words.extend(["--tmpfs", "/tmp/.X11-unix"].map(OsString::from));
    }
    for option in ["--bind", "--chdir"] {
        words.push(option.into());
        words.extend((0..if option == "--bind" { 2 } else { 1 }).map(|_| folder.into()));
    }
    words.push("--".into());
    words
}

/// A command's words, confined to a folder.
pub(crate) fn confined(words: Vec<OsString>, folder: &Path) -> Vec<OsString> {
    [vec![BUBBLEWRAP.into()], confinement(folder), words].concat()
}

/// Whether programs can be confined here, which is tried once.
///
/// # Errors
/// [`Problem::NoSandbox`] if bubblewrap is not installed, or the system does not let it.
pub(crate) fn check() -> Result<(), Problem> {
    static FOUND: OnceLock<Result<(), String>> = OnceLock::new();
    FOUND.get_or_init(trial).clone().map_err(|reason| Problem::NoSandbox { reason })
}

fn trial() -> Result<(), String> {
    let folder = isostudy_foreign::Folder::new().map_err(|error| error.to_string())?;
    let mut command = Command::new(BUBBLEWRAP);
    command.args(confinement(folder.path())).args(["sh", "-c", "exit 0"]);
    let limits = Limits { line_bytes: 4096, memory_bytes: None };
    let mut child = match Child::start(&mut command, limits, None) {
        Ok(child) => child,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Err(not_installed()),
        Err(error) => return Err(error.to_string()),
    };
    match child.wait(TRIAL) {
        Ok(End::Code(0)) => Ok(()),
        // What starts children tells so by the code that shells have for it.
        Ok(End::Code(127)) => Err(not_installed()),
        Ok(end) => Err(format!("bubblewrap {end}: {}", child.last_words())),
        Err(_) => Err(format!("bubblewrap starts nothing within {} s", TRIAL.as_secs())),
    }
}

fn not_installed() -> String {
    "bubblewrap is not installed: there is no bwrap in the folders of PATH".to_owned()
}
