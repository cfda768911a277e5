//! A disk in memory that fails when it is told to.
//!
//! What is written is seen by everybody at once, and is safe once it was synced. A kill takes nothing of it. When the power goes,
//! of what was not synced a part is kept: none, all, the first writes with the last one torn, or any sectors. A sector is kept
//! whole or not at all. The names of files are kept apart from their bytes: a file that was made, or removed, may be there or not
//! until its folder was synced. What was written before a sync that failed may be lost although a later sync does not fail.

use super::chance::Chance;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::io::{self, ErrorKind};
use std::sync::{Arc, Mutex, Weak};

const SECTOR: usize = 512;

/// What becomes of an operation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Fault {
    /// It fails, and does nothing.
    Error,
    /// Of a write the first sectors are written, and it fails.
    Short,
    /// From now on there is no room, for so many operations.
    Full(u64),
    /// The process ends before it. That it ends after it is the same as before the next one.
    End(End),
}

/// How a process ended that did not end by itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum End {
    Killed,
    PowerGone,
}

#[derive(Clone)]
enum Change {
    Write(usize, Vec<u8>),
    Cut(usize),
}

impl Change {
    fn apply(&self, bytes: &mut Vec<u8>) {
        self.apply_some(bytes, |_| true);
    }

    /// Of a write those sectors that are chosen.
    fn apply_some(&self, bytes: &mut Vec<u8>, mut chosen: impl FnMut(usize) -> bool) {
        match self {
            Self::Cut(length) => bytes.truncate(*length),
            Self::Write(offset, written) => {
                let mut from = *offset;
                while from < offset + written.len() {
                    let to = ((from / SECTOR + 1) * SECTOR).min(offset + written.len());
                    if chosen(from / SECTOR) {
                        bytes.resize(bytes.len().max(to), 0);
                        bytes[from..to].copy_from_slice(&written[from - offset..to - offset]);
                    }
                    from = to;
                }
            }
        }
    }
}

/// SQLite's index of a log, in memory that connections share.
pub(super) type Index = Arc<Mutex<HashMap<u32, [u8; 32768]>>>;

#[derive(Default)]
struct Inode {
    seen: Vec<u8>,
    safe: Vec<u8>,
    unsynced: Vec<Change>,
    /// By handle: locks of the database, as levels from 1.
    locks: HashMap<u64, u8>,
    /// By slot and handle: locks of the index, and whether each is the only one.
    index_locks: HashMap<(u8, u64), bool>,
    index: Weak<Mutex<HashMap<u32, [u8; 32768]>>>,
}

pub(super) struct Disk {
    chance: Chance,
    inodes: Vec<Inode>,
    seen: BTreeMap<String, usize>,
    safe: BTreeMap<String, usize>,
    /// Files that are taken by a process.
    taken: BTreeSet<String>,
    handles: u64,
    /// Operations so far.
    operations: Vec<Kind>,
    fault: Option<(u64, Fault)>,
    /// Faults that have happened: operations that failed.
    failed: u64,
    full_until: u64,
    end: Option<End>,
}

/// What an operation does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// It changes nothing: a read, an open.
    Look,
    /// It takes room.
    Write,
    /// It cuts, removes or syncs.
    Other,
}

impl Disk {
    pub(super) fn new(seed: u64) -> Self {
        Self {
            chance: Chance::new(seed),
            inodes: Vec::new(),
            seen: BTreeMap::new(),
            safe: BTreeMap::new(),
            taken: BTreeSet::new(),
            handles: 0,
            operations: Vec::new(),
            fault: None,
            failed: 0,
            full_until: 0,
            end: None,
        }
    }

    /// Has a fault happen that many operations from now, from 1, in place of one that has not happened.
    pub(super) fn arm(&mut self, ahead: u64, fault: Fault) {
        self.fault = Some((self.operations() + ahead, fault));
    }

    /// No fault will happen.
    pub(super) fn heal(&mut self) {
        self.fault = None;
        self.full_until = 0;
    }

    pub(super) fn operations(&self) -> u64 {
        self.operations.len() as u64
    }

    /// What each operation so far did.
    pub(super) fn kinds(&self) -> &[Kind] {
        &self.operations
    }

    pub(super) fn failed(&self) -> u64 {
        self.failed
    }

    pub(super) fn end(&self) -> Option<End> {
        self.end
    }

    /// Ends whatever uses it, now.
    pub(super) fn stop(&mut self, end: End) {
        self.end.get_or_insert(end);
    }

    /// A process may use it again.
    pub(super) fn restart(&mut self) {
        self.taken.clear();
        for inode in &mut self.inodes {
            inode.locks.clear();
            inode.index_locks.clear();
            inode.index = Weak::new();
        }
        if self.end.take() == Some(End::PowerGone) {
            let mut inodes = std::mem::take(&mut self.inodes);
            inodes.iter_mut().for_each(|inode| self.lose(inode));
            self.inodes = inodes;
            let names: BTreeSet<String> = self.seen.keys().chain(self.safe.keys()).cloned().collect();
            for name in names {
                let from = if self.chance.percent(50) { &self.seen } else { &self.safe };
                match from.get(&name).copied() {
                    Some(inode) => drop(self.safe.insert(name, inode)),
                    None => drop(self.safe.remove(&name)),
                }
            }
            self.seen = self.safe.clone();
        }
    }

    fn lose(&mut self, inode: &mut Inode) {
        let changes = std::mem::take(&mut inode.unsynced);
        let safe = &mut inode.safe;
        match self.chance.below(4) {
            0 => {}
            1 => changes.iter().for_each(|change| change.apply(safe)),
            2 => {
                let whole = self.chance.below(changes.len() + 1);
                changes[..whole].iter().for_each(|change| change.apply(safe));
                if let Some(torn) = changes.get(whole) {
                    let mut kept = self.chance.below(10);
                    torn.apply_some(safe, |_| {
                        kept = kept.saturating_sub(1);
                        kept > 0
                    });
                }
            }
            _ => {
                for change in &changes {
                    if matches!(change, Change::Write(..)) || self.chance.percent(50) {
                        change.apply_some(safe, |_| self.chance.percent(50));
                    }
                }
            }
        }
        inode.seen.clone_from(safe);
    }

    /// Counts an operation, which `apply` does, and has it fail if that is its fate.
    fn operate<T>(
        &mut self,
        kind: Kind,
        apply: impl FnOnce(&mut Self, bool) -> io::Result<T>,
    ) -> io::Result<T> {
        if self.end.is_some() {
            return Err(ErrorKind::BrokenPipe.into());
        }
        self.operations.push(kind);
        let number = self.operations();
        let fate = self.fault.take_if(|(at, _)| *at == number).map(|(_, fault)| fault);
        if let Some(Fault::Full(operations)) = fate {
            self.full_until = number + operations;
        }
        if kind == Kind::Write && number < self.full_until {
            self.failed += 1;
            // By this the trait of SQLite's files tells a full disk.
            return Err(ErrorKind::WriteZero.into());
        }
        match fate {
            None | Some(Fault::Full(_)) => apply(self, true),
            Some(fault) => {
                self.failed += 1;
                match fault {
                    Fault::Short if kind == Kind::Write => drop(apply(self, false)),
                    Fault::End(end) => self.end = Some(end),
                    _ => {}
                }
                Err(io::Error::other("as the simulation wants"))
            }
        }
    }

    pub(super) fn exists(&self, path: &str) -> bool {
        self.seen.contains_key(path)
    }

    /// Opens a file; makes it if it may.
    pub(super) fn open(&mut self, path: &str, create: bool, must_be_new: bool) -> io::Result<usize> {
        let there = self.exists(path);
        let kind = if create && !there { Kind::Write } else { Kind::Look };
        self.operate(kind, |disk, _| match disk.seen.get(path) {
            Some(_) if must_be_new => Err(ErrorKind::AlreadyExists.into()),
            Some(&inode) => Ok(inode),
            None if create => {
                disk.inodes.push(Inode::default());
                let inode = disk.inodes.len() - 1;
                disk.seen.insert(path.to_owned(), inode);
                Ok(inode)
            }
            None => Err(ErrorKind::NotFound.into()),
        })
    }

    pub(super) fn remove(&mut self, path: &str, synced: bool) -> io::Result<()> {
        self.operate(Kind::Other, |disk, _| {
            disk.seen.remove(path).ok_or(ErrorKind::NotFound)?;
            if synced {
                disk.safe.remove(path);
            }
            Ok(())
        })
    }

    /// Removes all files below a folder.
    pub(super) fn remove_below(&mut self, folder: &str) -> io::Result<()> {
        self.operate(Kind::Other, |disk, _| {
            disk.seen.retain(|path, _| !path.starts_with(folder));
            Ok(())
        })
    }

    /// Has the names of a folder's files on disk.
    pub(super) fn sync_names(&mut self, folder: &str) -> io::Result<()> {
        self.operate(Kind::Other, |disk, _| {
            disk.safe.retain(|path, _| !path.starts_with(folder));
            disk.safe.extend(
                disk.seen.iter().filter(|(path, _)| path.starts_with(folder)).map(|(p, i)| (p.clone(), *i)),
            );
            Ok(())
        })
    }

    pub(super) fn length(&self, inode: usize) -> usize {
        self.inodes[inode].seen.len()
    }

    /// Fills a part of a buffer, and tells how much.
    pub(super) fn read(&mut self, inode: usize, offset: usize, to: &mut [u8]) -> io::Result<usize> {
        self.operate(Kind::Look, |disk, _| {
            let from = disk.inodes[inode].seen.get(offset..).unwrap_or_default();
            let count = from.len().min(to.len());
            to[..count].copy_from_slice(&from[..count]);
            Ok(count)
        })
    }

    pub(super) fn write(&mut self, inode: usize, offset: usize, bytes: &[u8]) -> io::Result<()> {
        self.operate(Kind::Write, |disk, whole| {
            let end = offset + bytes.len();
            let short = ((offset + end) / 2 / SECTOR * SECTOR).max(offset) - offset;
            let written = if whole { bytes } else { &bytes[..short] };
            disk.change(inode, Change::Write(offset, written.to_vec()));
            Ok(())
        })
    }

    pub(super) fn cut(&mut self, inode: usize, length: usize) -> io::Result<()> {
        self.operate(Kind::Other, |disk, _| {
            disk.change(inode, Change::Cut(length));
            Ok(())
        })
    }

    fn change(&mut self, inode: usize, change: Change) {
        let inode = &mut self.inodes[inode];
        change.apply(&mut inode.seen);
        inode.unsynced.push(change);
    }

    pub(super) fn sync(&mut self, inode: usize) -> io::Result<()> {
        let synced = self.operate(Kind::Other, |disk, _| {
            let Inode { safe, unsynced, .. } = &mut disk.inodes[inode];
            unsynced.drain(..).for_each(|change| change.apply(safe));
            Ok(())
        });
        if synced.is_err() && self.end.is_none() && self.chance.percent(50) {
            self.inodes[inode].unsynced.clear();
        }
        synced
    }

    pub(super) fn handle(&mut self) -> u64 {
        self.handles += 1;
        self.handles
    }

    /// Takes a file for a process, or finds that another one has it.
    pub(super) fn take(&mut self, path: &str) -> bool {
        self.taken.insert(path.to_owned())
    }

    pub(super) fn give_back(&mut self, path: &str) {
        self.taken.remove(path);
    }

    /// Changes a handle's lock of a database to a level: 1 shared, 2 reserved, 3 pending, 4 the only one.
    pub(super) fn lock(&mut self, inode: usize, handle: u64, level: u8) -> bool {
        let locks = &mut self.inodes[inode].locks;
        let others =
            locks.iter().filter(|(of, _)| **of != handle).map(|(_, level)| *level).max().unwrap_or(0);
        let allowed = match level {
            0 => true,
            1 => others < 3,
            2 | 3 => others < 2,
            _ => others == 0,
        };
        if allowed {
            locks.insert(handle, level);
        }
        allowed
    }

    pub(super) fn unlock(&mut self, inode: usize, handle: u64, level: u8) {
        self.inodes[inode].locks.insert(handle, level);
    }

    /// The highest lock of a database.
    pub(super) fn highest_lock(&self, inode: usize) -> u8 {
        self.inodes[inode].locks.values().copied().max().unwrap_or(0)
    }

    pub(super) fn forget_handle(&mut self, inode: usize, handle: u64) {
        let inode = &mut self.inodes[inode];
        inode.locks.remove(&handle);
        inode.index_locks.retain(|(_, of), _| *of != handle);
    }

    pub(super) fn index(&mut self, inode: usize) -> Index {
        let inode = &mut self.inodes[inode];
        inode.index.upgrade().unwrap_or_else(|| {
            let index = Index::default();
            inode.index = Arc::downgrade(&index);
            index
        })
    }

    /// Takes slots of an index, shared or alone, or lets go of them.
    pub(super) fn lock_index(
        &mut self,
        inode: usize,
        handle: u64,
        slots: std::ops::Range<u8>,
        alone: Option<bool>,
    ) -> bool {
        let locks = &mut self.inodes[inode].index_locks;
        let Some(alone) = alone else {
            locks.retain(|(slot, of), _| *of != handle || !slots.contains(slot));
            return true;
        };
        let hinders = |(&(slot, of), &only): (&(u8, u64), &bool)| {
            of != handle && slots.contains(&slot) && (alone || only)
        };
        if locks.iter().any(hinders) {
            return false;
        }
        locks.extend(slots.map(|slot| ((slot, handle), alone)));
        true
    }
}
