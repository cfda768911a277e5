//! The machine of a simulation: a [`Disk`], which SQLite uses too, a clock that is set, and chance from a seed.

use super::chance::Chance;
use super::disk::{Disk, Index};
use crate::machine::{Machine, Owned};
use sqlite_vfs::wip::{WalIndex, WalIndexLock};
use sqlite_vfs::{DatabaseHandle, LockKind, OpenAccess, OpenKind, OpenOptions, Vfs};
use std::io::{self, ErrorKind};
use std::ops::Range;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;

/// What changes from one simulation to the next. SQLite forgets no files once it was told of them, so that a thread has one
/// machine for all.
pub(super) struct State {
    pub(super) disk: Disk,
    pub(super) now_ms: i64,
    chance: Chance,
    notes: Vec<String>,
}

#[derive(Clone)]
pub(super) struct Simulated {
    state: Arc<Mutex<State>>,
    name: String,
}

impl Simulated {
    /// A machine that SQLite knows by a name of its own.
    pub(super) fn new() -> Self {
        static MACHINES: AtomicUsize = AtomicUsize::new(0);
        let name = format!("simulated-{}", MACHINES.fetch_add(1, Ordering::Relaxed));
        let state = State { disk: Disk::new(0), now_ms: 0, chance: Chance::new(0), notes: Vec::new() };
        let machine = Self { state: Arc::new(Mutex::new(state)), name };
        sqlite_vfs::register(&machine.name, machine.clone(), false).expect("SQLite takes files");
        machine
    }

    /// Begins anew, with an empty disk.
    pub(super) fn reset(&self, seed: u64) {
        let mut chance = Chance::new(seed);
        let disk = Disk::new(chance.next());
        *self.state() = State { disk, now_ms: 1_700_000_000_000, chance, notes: Vec::new() };
    }

    pub(super) fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().expect("nothing panics with it")
    }

    /// What the log was told since it was asked last.
    pub(super) fn notes(&self) -> Vec<String> {
        std::mem::take(&mut self.state().notes)
    }
}

fn text(path: &Path) -> &str {
    path.to_str().expect("paths of simulations are texts")
}

impl Machine for Simulated {
    fn now_ms(&self) -> i64 {
        self.state().now_ms
    }

    fn random(&self, bytes: &mut [u8]) {
        self.state().chance.fill(bytes);
    }

    fn note(&self, line: String) {
        self.state().notes.push(line);
    }

    fn vfs(&self) -> &str {
        &self.name
    }

    fn make_folders(&self, _: &Path) -> io::Result<()> {
        Ok(())
    }

    fn make_folder(&self, _: &Path) -> io::Result<()> {
        Ok(())
    }

    fn remove_folder(&self, path: &Path) -> io::Result<()> {
        self.state().disk.remove_below(text(path))
    }

    fn sync_folder(&self, path: &Path) -> io::Result<()> {
        self.state().disk.sync_names(text(path))
    }

    fn open(&self, path: &Path) -> io::Result<Box<dyn Owned>> {
        let inode = self.state().disk.open(text(path), true, false)?;
        Ok(Box::new(OwnedFile {
            machine: self.clone(),
            path: text(path).to_owned(),
            inode,
            taken: false.into(),
        }))
    }

    fn read(&self, path: &Path, most: u64) -> io::Result<Vec<u8>> {
        let disk = &mut self.state().disk;
        let inode = disk.open(text(path), false, false)?;
        let mut bytes = vec![0; disk.length(inode).min(most as usize)];
        disk.read(inode, 0, &mut bytes)?;
        Ok(bytes)
    }

    fn copy<'a>(&self, from: &'a Path, to: &'a Path) -> Result<(), (&'a Path, io::Error)> {
        let bytes = self.read(from, u64::MAX).map_err(|error| (from, error))?;
        let disk = &mut self.state().disk;
        let copied = disk.open(text(to), true, true).and_then(|inode| disk.write(inode, 0, &bytes));
        copied.map_err(|error| (to, error))
    }
}

struct OwnedFile {
    machine: Simulated,
    path: String,
    inode: usize,
    taken: std::sync::atomic::AtomicBool,
}

impl Owned for OwnedFile {
    fn write(&self, bytes: &[u8]) -> io::Result<()> {
        self.machine.state().disk.write(self.inode, 0, bytes)
    }

    fn sync(&self) -> io::Result<()> {
        self.machine.state().disk.sync(self.inode)
    }

    fn try_lock(&self) -> bool {
        let taken = self.machine.state().disk.take(&self.path);
        self.taken.store(taken, Ordering::Relaxed);
        taken
    }
}

impl Drop for OwnedFile {
    fn drop(&mut self) {
        if self.taken.load(Ordering::Relaxed) {
            self.machine.state().disk.give_back(&self.path);
        }
    }
}

/// A file that SQLite has open.
pub(super) struct Handle {
    machine: Simulated,
    inode: usize,
    number: u64,
    level: LockKind,
    /// The folder whose names the first sync has on disk too, as SQLite's own files do for logs and journals.
    folder: Option<String>,
}

impl Drop for Handle {
    fn drop(&mut self) {
        self.machine.state().disk.forget_handle(self.inode, self.number);
    }
}

impl Vfs for Simulated {
    type Handle = Handle;

    fn open(&self, path: &str, options: OpenOptions) -> io::Result<Handle> {
        let disk = &mut self.state().disk;
        let create = matches!(options.access, OpenAccess::Create | OpenAccess::CreateNew);
        let inode = disk.open(path, create, options.access == OpenAccess::CreateNew)?;
        let log = matches!(options.kind, OpenKind::Wal | OpenKind::MainJournal | OpenKind::SuperJournal);
        let folder = path.rsplit_once('/').filter(|_| create && log).map(|(folder, _)| format!("{folder}/"));
        Ok(Handle { machine: self.clone(), inode, number: disk.handle(), level: LockKind::None, folder })
    }

    fn delete(&self, path: &str) -> io::Result<()> {
        // SQLite asks for the folder to be synced after a journal, which is a commit, and not after a log.
        self.state().disk.remove(path, path.ends_with("-journal"))
    }

    fn exists(&self, path: &str) -> io::Result<bool> {
        Ok(self.state().disk.exists(path))
    }

    fn temporary_name(&self) -> String {
        format!("/temporary/{}", self.state().disk.handle())
    }

    fn random(&self, bytes: &mut [i8]) {
        let chance = &mut self.state().chance;
        bytes.iter_mut().for_each(|byte| *byte = chance.next() as i8);
    }

    fn sleep(&self, duration: Duration) -> Duration {
        duration
    }
}

impl DatabaseHandle for Handle {
    type WalIndex = SharedIndex;

    fn size(&self) -> io::Result<u64> {
        Ok(self.machine.state().disk.length(self.inode) as u64)
    }

    fn read_exact_at(&mut self, to: &mut [u8], offset: u64) -> io::Result<()> {
        let count = self.machine.state().disk.read(self.inode, offset as usize, to)?;
        to[count..].fill(0);
        if count < to.len() { Err(ErrorKind::UnexpectedEof.into()) } else { Ok(()) }
    }

    fn write_all_at(&mut self, bytes: &[u8], offset: u64) -> io::Result<()> {
        self.machine.state().disk.write(self.inode, offset as usize, bytes)
    }

    fn sync(&mut self, _: bool) -> io::Result<()> {
        let disk = &mut self.machine.state().disk;
        disk.sync(self.inode)?;
        self.folder.take().map_or(Ok(()), |folder| disk.sync_names(&folder))
    }

    fn set_len(&mut self, length: u64) -> io::Result<()> {
        let disk = &mut self.machine.state().disk;
        // To a hint of how long a file will be, SQLite's own files do nothing.
        if length as usize >= disk.length(self.inode) {
            Ok(())
        } else {
            disk.cut(self.inode, length as usize)
        }
    }

    fn lock(&mut self, level: LockKind) -> io::Result<bool> {
        let locked = self.machine.state().disk.lock(self.inode, self.number, level as u8);
        if locked {
            self.level = level;
        }
        Ok(locked)
    }

    fn unlock(&mut self, level: LockKind) -> io::Result<bool> {
        self.machine.state().disk.unlock(self.inode, self.number, level as u8);
        self.level = level;
        Ok(true)
    }

    fn reserved(&mut self) -> io::Result<bool> {
        Ok(self.machine.state().disk.highest_lock(self.inode) >= LockKind::Reserved as u8)
    }

    fn current_lock(&self) -> io::Result<LockKind> {
        Ok(self.level)
    }

    fn wal_index(&self, _: bool) -> io::Result<SharedIndex> {
        let regions = self.machine.state().disk.index(self.inode);
        Ok(SharedIndex { machine: self.machine.clone(), inode: self.inode, number: self.number, regions })
    }
}

/// SQLite's index of a log.
pub(super) struct SharedIndex {
    machine: Simulated,
    inode: usize,
    number: u64,
    regions: Index,
}

impl SharedIndex {
    fn region<T>(&self, region: u32, work: impl FnOnce(&mut [u8; 32768]) -> T) -> T {
        let mut regions = self.regions.lock().expect("nothing panics with it");
        work(regions.entry(region).or_insert([0; 32768]))
    }
}

impl WalIndex for SharedIndex {
    fn map(&mut self, region: u32) -> io::Result<[u8; 32768]> {
        Ok(self.region(region, |shared| *shared))
    }

    fn lock(&mut self, slots: Range<u8>, lock: WalIndexLock) -> io::Result<bool> {
        let alone = match lock {
            WalIndexLock::None => None,
            WalIndexLock::Shared => Some(false),
            WalIndexLock::Exclusive => Some(true),
        };
        Ok(self.machine.state().disk.lock_index(self.inode, self.number, slots, alone))
    }

    fn delete(self) -> io::Result<()> {
        self.regions.lock().expect("nothing panics with it").clear();
        Ok(())
    }

    fn pull(&mut self, region: u32, data: &mut [u8; 32768]) -> io::Result<()> {
        self.region(region, |shared| *data = *shared);
        Ok(())
    }

    fn push(&mut self, region: u32, data: &[u8; 32768]) -> io::Result<()> {
        self.region(region, |shared| *shared = *data);
        Ok(())
    }
}
