//! Where results are kept: stages that are redone only when their inputs changed, files that appear whole or not at all.
//!
//! A stage is a name, a list of inputs and a closure that writes files. When it ends, a stamp with the digest of the inputs
//! and of every file is written beside the results, in `.stages/`. The next run trusts a stamp whose digest is the same
//! and whose files are all still there and unchanged. Files and stamps are written to a temporary sibling and renamed, so a
//! run may be killed at any moment: a stage without its stamp is redone from its start.

use anyhow::{Context, Result, bail};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::borrow::Cow;
use std::collections::BTreeSet;
use std::fs::{self, File, TryLockError};
use std::io::{ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, OnceLock};
use std::time::UNIX_EPOCH;

const STAMPS: &str = ".stages";
const PARTIAL: &str = ".partial";
/// A file that another machine has not finished for so long is nobody's.
const A_DAY: std::time::Duration = std::time::Duration::from_secs(24 * 3600);
const LOCK_TRIES: u32 = 20;
const LOCK_PAUSE: std::time::Duration = std::time::Duration::from_millis(10);

/// A folder of results.
pub(crate) struct Store {
    root: PathBuf,
    force: bool,
    /// The stages that this run did or found done.
    touched: Mutex<BTreeSet<String>>,
    /// Held as long as the store is: one run at a time.
    _lock: Option<File>,
}

/// What a finished stage left behind.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Stamp {
    /// The stage's name.
    pub(crate) stage: String,
    /// Digest of its inputs.
    pub(crate) inputs: String,
    /// The files it wrote.
    pub(crate) files: Vec<FileStamp>,
    /// Files that it wrote before and may have to be removed.
    #[serde(default)]
    pub(crate) retired: Vec<String>,
    /// Whether this run made them.
    #[serde(skip)]
    pub(crate) redone: bool,
}

/// A file that a stage wrote.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct FileStamp {
    /// Relative to the store, with forward slashes.
    pub(crate) path: String,
    /// Size.
    pub(crate) bytes: u64,
    /// SHA-256 in hexadecimal.
    pub(crate) sha256: String,
    /// Modification time in nanoseconds since 1970; while it is the same the content is not read again.
    pub(crate) modified_ns: u64,
}

/// What a stage depends on: labelled texts, digested in order.
#[derive(Clone, Default)]
pub(crate) struct Inputs {
    digest: Sha256,
}

/// Writes the files of one stage.
pub(crate) struct Writer<'a> {
    root: &'a Path,
    files: Vec<FileStamp>,
}

impl Store {
    /// Opens or makes the folder, and clears away what a killed run left half-written.
    ///
    /// # Errors
    /// If the folder cannot be made, or another run holds it.
    pub(crate) fn open(root: &Path, force: bool) -> Result<Self> {
        let stamps = root.join(STAMPS);
        fs::create_dir_all(&stamps).with_context(|| format!("cannot make {}", stamps.display()))?;
        let lock = lock(&stamps.join("lock"), File::try_lock)?;
        if lock.is_some() {
            sweep(root)?;
        }
        Ok(Self { root: root.into(), force, touched: Mutex::default(), _lock: lock })
    }

    /// A folder that is neither made nor read: of what asks which stages there are.
    pub(crate) fn nowhere(root: &Path) -> Self {
        Self { root: root.into(), force: false, touched: Mutex::default(), _lock: None }
    }

    /// Opens or makes the folder beside others that work on other stages of it, on this machine or another. What a killed run left
    /// half-written stays: it may be another's that is at work.
    ///
    /// # Errors
    /// If the folder cannot be made, or a run of the whole study holds it.
    pub(crate) fn open_beside(root: &Path, force: bool) -> Result<Self> {
        let stamps = root.join(STAMPS);
        fs::create_dir_all(&stamps).with_context(|| format!("cannot make {}", stamps.display()))?;
        let lock = lock(&stamps.join("lock"), File::try_lock_shared)?;
        Ok(Self { root: root.into(), force, touched: Mutex::default(), _lock: lock })
    }

    /// The folder.
    pub(crate) fn root(&self) -> &Path {
        &self.root
    }

    /// A file for a stage to keep its progress in. No stage is named like it, and nothing removes it but its stage.
    pub(crate) fn journal(&self, name: &str) -> PathBuf {
        // Each machine that works on the folder has its own.
        self.root.join(STAMPS).join(format!("{}.{}.journal", name.replace('/', "."), host()))
    }

    /// Whether what is up to date is redone as well.
    pub(crate) fn forced(&self) -> bool {
        self.force
    }

    /// Does a stage, or finds it done.
    ///
    /// # Errors
    /// What `make` returns, or a file that cannot be written; the stage then has no stamp.
    pub(crate) fn stage(
        &self,
        name: &str,
        inputs: Inputs,
        make: impl FnOnce(&mut Writer<'_>) -> Result<()>,
    ) -> Result<Stamp> {
        let inputs = inputs.finish();
        let before = self.stamp(name);
        self.touch(name);
        if let Some(stamp) = self.fresh(before.as_ref(), &inputs)
            && !self.force
        {
            return Ok(stamp);
        }
        // The old stamp stays until the new one replaces it: killed in between, it still says which files were ours, and
        // cannot pass for fresh unless they are.
        let mut writer = Writer { root: &self.root, files: Vec::new() };
        make(&mut writer)?;
        let mut retired = Vec::new();
        if let Some(stamp) = before {
            retired.extend(stamp.files.into_iter().map(|file| file.path).chain(stamp.retired));
        }
        retired.retain(|path| !writer.files.iter().any(|file| file.path == *path));
        let stamp = Stamp { stage: name.into(), inputs, files: writer.files, retired, redone: true };
        write_whole(&self.stamp_path(name), &serde_json::to_vec_pretty(&stamp)?)?;
        Ok(stamp)
    }

    /// The stamp of a stage if it is fresh for these inputs; nothing is done.
    pub(crate) fn peek(&self, name: &str, inputs: Inputs) -> Option<Stamp> {
        let found = self.fresh(self.stamp(name).as_ref(), &inputs.finish())?;
        self.touch(name);
        Some(found)
    }

    /// The bytes of a stage's file, by the end of its path: those that the stamp says.
    ///
    /// # Errors
    /// If it cannot be read, or has other bytes: then somebody else works on the folder.
    pub(crate) fn read(&self, stamp: &Stamp, ending: &str) -> Result<Vec<u8>> {
        let path = stamp.file(ending);
        let file = stamp.files.iter().find(|file| file.path == path).context("a file of the stage")?;
        self.read_file(file)
    }

    /// The same of one file.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub(crate) fn read_file(&self, file: &FileStamp) -> Result<Vec<u8>> {
        let full = self.root.join(&file.path);
        let bytes = fs::read(&full).with_context(|| full.display().to_string())?;
        if file.sha256 != sha256(&bytes) {
            bail!(
                "{}: it was changed while it was read. Another study, or an earlier form of this one, works on this folder",
                full.display()
            );
        }
        Ok(bytes)
    }

    /// Every stage that has a stamp, by name.
    pub(crate) fn stamps(&self) -> Result<Vec<Stamp>> {
        let mut stamps = Vec::new();
        let folder = self.root.join(STAMPS);
        let unreadable = || format!("cannot read {}", folder.display());
        for entry in fs::read_dir(&folder).with_context(unreadable)? {
            let path = entry.with_context(unreadable)?.path();
            if path.extension().is_some_and(|extension| extension == "json") {
                stamps.extend(fs::read(&path).ok().and_then(|text| serde_json::from_slice(&text).ok()));
            }
        }
        stamps.sort_by(|a: &Stamp, b: &Stamp| a.stage.cmp(&b.stage));
        Ok(stamps)
    }

    /// Removes the stages that this run had no use for: what an earlier form of the study left. Their files go with
    /// [`Store::remove_retired`].
    pub(crate) fn retire_untouched(&self, keep: impl Fn(&str) -> bool) -> Result<()> {
        let touched = self.touched.lock().expect("no thread panics with the lock").clone();
        for mut stamp in self.stamps()? {
            if !touched.contains(&stamp.stage) && !keep(&stamp.stage) {
                stamp.retired.extend(stamp.files.drain(..).map(|file| file.path));
                stamp.inputs.clear();
                write_whole(&self.stamp_path(&stamp.stage), &serde_json::to_vec_pretty(&stamp)?)?;
            }
        }
        Ok(())
    }

    /// Removes files that stages wrote once and no stage writes now. Not done stage by stage, since what one stage no
    /// longer writes another may: code names move from pair to pair when a study changes.
    pub(crate) fn remove_retired(&self) -> Result<()> {
        let stamps = self.stamps()?;
        let written = |path: &str| stamps.iter().flat_map(|stamp| &stamp.files).any(|file| file.path == path);
        for mut stamp in stamps.iter().filter(|stamp| !stamp.retired.is_empty()).cloned() {
            for path in stamp.retired.drain(..).filter(|path| !written(path)) {
                remove_if_there(&self.root.join(path))?;
            }
            let path = self.stamp_path(&stamp.stage);
            if stamp.files.is_empty() {
                remove_if_there(&path)?;
            } else {
                write_whole(&path, &serde_json::to_vec_pretty(&stamp)?)?;
            }
        }
        Ok(())
    }

    fn touch(&self, name: &str) {
        self.touched.lock().expect("no thread panics with the lock").insert(name.into());
    }

    fn stamp_path(&self, name: &str) -> PathBuf {
        self.root.join(STAMPS).join(format!("{}.json", name.replace('/', ".")))
    }

    fn stamp(&self, name: &str) -> Option<Stamp> {
        let text = fs::read(self.stamp_path(name)).ok()?;
        serde_json::from_slice(&text).ok()
    }

    fn fresh(&self, stamp: Option<&Stamp>, inputs: &str) -> Option<Stamp> {
        let stamp = stamp?;
        let whole = stamp.inputs == inputs && stamp.files.iter().all(|file| self.unchanged(file));
        whole.then(|| stamp.clone())
    }

    fn unchanged(&self, file: &FileStamp) -> bool {
        let path = self.root.join(&file.path);
        let Ok(metadata) = fs::metadata(&path) else { return false };
        metadata.len() == file.bytes
            && (modified_ns(&metadata) == file.modified_ns
                || fs::read(&path).is_ok_and(|bytes| sha256(&bytes) == file.sha256))
    }
}

impl Inputs {
    /// Starts from the sources of the crates that make the files.
    pub(crate) fn of_sources(digests: &[&str]) -> Self {
        digests.iter().fold(Self::default(), |inputs, digest| inputs.text("sources", digest))
    }

    /// Adds a text.
    pub(crate) fn text(mut self, label: &str, text: &str) -> Self {
        // Lengths first, so that no two lists of inputs read the same.
        self.digest.update(format!("{}:{label}{}:", label.len(), text.len()));
        self.digest.update(text);
        self
    }

    /// Adds any plain value, through its JSON.
    pub(crate) fn value(self, label: &str, value: &impl Serialize) -> Self {
        let json = serde_json::to_string(value).expect("plain data serialises");
        self.text(label, &json)
    }

    /// Adds the files that another stage left.
    pub(crate) fn stamp(self, stamp: &Stamp) -> Self {
        stamp.files.iter().fold(self, |inputs, file| inputs.text(&file.path, &file.sha256))
    }

    /// The digest.
    pub(crate) fn finish(self) -> String {
        hexadecimal(&self.digest.finalize())
    }
}

impl Writer<'_> {
    /// Writes one file, `path` relative to the store.
    /// In what people read, what a terminal or a page would obey is escaped: words may come from any file.
    pub(crate) fn write(&mut self, path: &str, bytes: &[u8]) -> Result<()> {
        let full = self.root.join(path);
        let shown = shown_bytes(path, bytes);
        let bytes = &*shown;
        let file = write_whole_by(&full, |file| file.write_all(bytes))?;
        // Of the file that was written: another may have its name by now.
        let metadata = file.metadata().with_context(|| format!("cannot read {}", full.display()))?;
        self.files.push(FileStamp {
            path: path.into(),
            bytes: metadata.len(),
            sha256: sha256(bytes),
            modified_ns: modified_ns(&metadata),
        });
        Ok(())
    }

    /// Writes one file as JSON.
    pub(crate) fn write_json(&mut self, path: &str, value: &impl Serialize) -> Result<()> {
        let mut bytes = serde_json::to_vec_pretty(value)?;
        bytes.push(b'\n');
        self.write(path, &bytes)
    }
}

impl Stamp {
    /// The file of a stage whose path ends like this.
    ///
    /// # Panics
    /// If the stage writes no such file.
    pub(crate) fn file(&self, ending: &str) -> &str {
        let file = self.files.iter().find(|file| file.path.ends_with(ending));
        &file.unwrap_or_else(|| panic!("{} writes no {ending}", self.stage)).path
    }
}

/// Takes the lock, or `None` where the folder cannot be written and so no other run can either, or where its file system has none.
fn lock(path: &Path, take: impl Fn(&File) -> Result<(), TryLockError>) -> Result<Option<File>> {
    // Opened and not made anew: what is held is the file. Where locks are those of POSIX, a shared one takes a file that can be read.
    let file = match File::options().create(true).truncate(false).read(true).write(true).open(path) {
        Ok(file) => file,
        Err(error) if matches!(error.kind(), ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem) => {
            return Ok(None);
        }
        Err(error) => return Err(error).with_context(|| format!("cannot make {}", path.display())),
    };
    // A child that is being started has our files for a moment, and a lock that was just given up with them.
    for _ in 0..LOCK_TRIES {
        match take(&file) {
            Ok(()) => return Ok(Some(file)),
            Err(TryLockError::WouldBlock) => std::thread::sleep(LOCK_PAUSE),
            // The file system has no locks, or nobody who keeps them.
            Err(TryLockError::Error(_)) => return Ok(None),
        }
    }
    bail!("{} says that another run is at work there", path.display())
}

/// SHA-256 in hexadecimal.
pub(crate) fn sha256(bytes: &[u8]) -> String {
    hexadecimal(&Sha256::digest(bytes))
}

/// The same of parts one after the other.
pub(crate) fn sha256_of(parts: impl IntoIterator<Item = impl AsRef<[u8]>>) -> String {
    let mut digest = Sha256::new();
    parts.into_iter().for_each(|part| digest.update(part));
    hexadecimal(&digest.finalize())
}

/// The same of a file, which may be larger than memory should hold.
///
/// # Errors
/// If it is no file or cannot be read. The path is named.
pub(crate) fn sha256_of_file(path: &Path) -> Result<String> {
    let mut file = isostudy_foreign::open(path)?;
    let (mut digest, mut part) = (Sha256::new(), vec![0; 1 << 16]);
    loop {
        match file.read(&mut part).with_context(|| path.display().to_string())? {
            0 => return Ok(hexadecimal(&digest.finalize())),
            read => digest.update(&part[..read]),
        }
    }
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Writes a file so that it is there whole or not at all.
pub(crate) fn write_whole(path: &Path, bytes: &[u8]) -> Result<()> {
    write_whole_by(path, |file| file.write_all(bytes)).map(drop)
}

/// The same of what `write` writes, which need not be in memory; returns the file.
pub(crate) fn write_whole_by(
    path: &Path,
    write: impl FnOnce(&mut File) -> std::io::Result<()>,
) -> Result<File> {
    let folder = path.parent().unwrap_or(Path::new("."));
    fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    let all = || -> std::io::Result<File> {
        // Its errors name the temporary file, which nobody asked for.
        let mut partial = partial_file().tempfile_in(folder).map_err(|error| error.kind())?;
        write(partial.as_file_mut())?;
        Ok(partial.persist(path)?)
    };
    all().with_context(|| format!("cannot write {}", path.display()))
}

/// The same as [`write_whole`] where nothing is yet.
///
/// # Errors
/// If something is there, which stays as it is; if it cannot be written.
pub(crate) fn write_new(path: &Path, bytes: &[u8]) -> Result<()> {
    let folder = path.parent().unwrap_or(Path::new("."));
    fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    let all = || -> std::io::Result<()> {
        let mut partial = partial_file().tempfile_in(folder).map_err(|error| error.kind())?;
        partial.write_all(bytes)?;
        partial.persist_noclobber(path)?;
        Ok(())
    };
    all().with_context(|| format!("cannot write {}", path.display()))
}

/// What this machine is called, as a part of the names of files.
fn host() -> &'static str {
    static HOST: OnceLock<String> = OnceLock::new();
    HOST.get_or_init(|| {
        let told = fs::read_to_string("/proc/sys/kernel/hostname").ok();
        let named = || ["HOSTNAME", "COMPUTERNAME"].iter().find_map(|name| std::env::var(name).ok());
        let name = told.or_else(named).unwrap_or_default();
        let plain = |letter: char| if letter.is_ascii_alphanumeric() { letter } else { '-' };
        name.trim().chars().map(plain).collect()
    })
}

/// How the names of this machine's half-written files begin.
fn partial_prefix() -> &'static str {
    static PREFIX: OnceLock<String> = OnceLock::new();
    PREFIX.get_or_init(|| format!(".{}.", host()))
}

/// A temporary file becomes a result, so it gets a result's permissions, not its owner's alone.
fn partial_file() -> tempfile::Builder<'static, 'static> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(partial_prefix()).suffix(PARTIAL);
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder
}

pub(crate) fn remove_if_there(path: &Path) -> Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => {
            Err(error).with_context(|| format!("cannot remove {}", path.display()))
        }
        _ => Ok(()),
    }
}

fn sweep(folder: &Path) -> Result<()> {
    for entry in fs::read_dir(folder).with_context(|| format!("cannot read {}", folder.display()))? {
        let path = entry.with_context(|| format!("cannot read {}", folder.display()))?.path();
        if path.is_dir() {
            sweep(&path)?;
        } else if path.to_string_lossy().ends_with(PARTIAL) && !is_at_work_elsewhere(&path) {
            remove_if_there(&path)?;
        }
    }
    Ok(())
}

/// Whether another machine may be writing it: no lock of that machine is seen where locks are a node's own.
fn is_at_work_elsewhere(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let has_host = name.trim_start_matches('.').trim_end_matches(PARTIAL).contains('.');
    let age = fs::metadata(path).and_then(|metadata| metadata.modified()).ok();
    let is_young = age.and_then(|time| time.elapsed().ok()).is_none_or(|age| age < A_DAY);
    has_host && !name.starts_with(partial_prefix()) && is_young
}

/// Endings of texts that people read. JSON and programs of pages are read by programs.
const READ_BY_PEOPLE: [&str; 6] = ["csv", "html", "md", "svg", "tex", "txt"];

fn shown_bytes<'b>(path: &str, bytes: &'b [u8]) -> Cow<'b, [u8]> {
    let ending = Path::new(path).extension().unwrap_or_default();
    let text = Some(bytes).filter(|_| READ_BY_PEOPLE.iter().any(|known| ending == *known));
    match text.and_then(|bytes| std::str::from_utf8(bytes).ok()).map(isostudy_foreign::shown) {
        Some(Cow::Owned(text)) => Cow::Owned(text.into_bytes()),
        _ => Cow::Borrowed(bytes),
    }
}

fn modified_ns(metadata: &fs::Metadata) -> u64 {
    let since_1970 = metadata.modified().ok().and_then(|time| time.duration_since(UNIX_EPOCH).ok());
    since_1970.map_or(0, |time| time.as_nanos() as u64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    struct Fixture {
        folder: tempfile::TempDir,
        made: Cell<u32>,
    }

    impl Fixture {
        fn new() -> Self {
            Self { folder: tempfile::tempdir().unwrap(), made: Cell::new(0) }
        }

        fn run(&self, force: bool, input: &str, file: &str) -> Stamp {
            let store = Store::open(self.folder.path(), force).unwrap();
            let make = |writer: &mut Writer<'_>| {
                self.made.set(self.made.get() + 1);
                writer.write(file, input.as_bytes())
            };
            let stamp = store.stage("a/b", Inputs::default().text("input", input), make).unwrap();
            store.remove_retired().unwrap();
            stamp
        }
    }

    #[test]
    fn a_stage_is_redone_only_when_something_changed() {
        let fixture = Fixture::new();
        assert!(fixture.run(false, "one", "x/file").redone);
        assert!(!fixture.run(false, "one", "x/file").redone);
        assert!(fixture.run(false, "two", "x/file").redone, "inputs changed");
        assert!(fixture.run(true, "two", "x/file").redone, "forced");
        let file = fixture.folder.path().join("x/file");
        fs::write(&file, "two").unwrap();
        assert!(!fixture.run(false, "two", "x/file").redone, "touched, same content");
        fs::write(&file, "2wo").unwrap();
        assert!(fixture.run(false, "two", "x/file").redone, "content changed");
        fs::remove_file(&file).unwrap();
        assert!(fixture.run(false, "two", "x/file").redone, "file gone");
        assert_eq!(fs::read_to_string(&file).unwrap(), "two");
    }

    #[test]
    fn files_that_a_stage_no_longer_writes_go() {
        let fixture = Fixture::new();
        fixture.run(false, "one", "old");
        fixture.run(false, "two", "new");
        assert!(!fixture.folder.path().join("old").exists());
        assert!(fixture.folder.path().join("new").exists());
    }

    #[test]
    fn a_failed_stage_is_redone_and_half_written_files_are_swept() {
        let fixture = Fixture::new();
        fixture.run(false, "one", "file");
        {
            let store = Store::open(fixture.folder.path(), false).unwrap();
            let inputs = Inputs::default().text("input", "two");
            let half_done = |writer: &mut Writer<'_>| {
                writer.write("file", b"two")?;
                bail!("no")
            };
            assert!(store.stage("a/b", inputs, half_done).is_err());
        }
        fs::write(fixture.folder.path().join(".file.partial"), "half").unwrap();
        assert!(fixture.run(false, "one", "file").redone);
        assert!(!fixture.folder.path().join(".file.partial").exists());
    }

    #[test]
    fn what_another_machine_writes_stays_for_a_day() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let own = format!("{}abc{PARTIAL}", partial_prefix());
        for name in [own.as_str(), ".another-node.abc.partial", ".another-node.old.partial"] {
            fs::write(path(name), "half").unwrap();
        }
        let old = File::options().write(true).open(path(".another-node.old.partial")).unwrap();
        old.set_modified(std::time::SystemTime::now() - 2 * A_DAY).unwrap();
        drop(Store::open(folder.path(), false).unwrap());
        assert!(!path(&own).exists() && !path(".another-node.old.partial").exists());
        assert!(path(".another-node.abc.partial").exists());
    }

    #[test]
    fn one_run_at_a_time() {
        let fixture = Fixture::new();
        let _held = Store::open(fixture.folder.path(), false).unwrap();
        assert!(Store::open(fixture.folder.path(), false).is_err());
    }

    #[test]
    fn inputs_do_not_run_together() {
        let digest = |parts: [(&str, &str); 2]| {
            parts.iter().fold(Inputs::default(), |inputs, (l, t)| inputs.text(l, t)).finish()
        };
        assert_ne!(digest([("a", "bc"), ("d", "e")]), digest([("a", "b"), ("cd", "e")]));
    }
}
