//! A peer in a Python process of its own.

use crate::{Grid, Outcome, Peer, REACH};
use anyhow::{Context, Result, bail};
use glam::Vec3;
use mesh::TriangleMesh;
use serde::Deserialize;
use serde_json::json;
use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use tempfile::TempDir;

pub(crate) struct PythonPeer {
    name: String,
    child: Child,
    requests: Option<ChildStdin>,
    replies: BufReader<ChildStdout>,
    folder: TempDir,
    /// Field and cells of the samples in the folder.
    written: Option<(&'static str, u32)>,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Reply {
    Ready { ready: String },
    Failed { failed: String },
    Done { extraction_s: f64, callback_s: f64 },
}

impl PythonPeer {
    /// # Errors
    /// If Python or the library is not there.
    pub(crate) fn start(python: &Path, worker: &Path, library: &str) -> Result<Self> {
        let fields = format!("{DLL_PREFIX}peer_fields{DLL_SUFFIX}");
        let mut child = Command::new(python)
            .arg(worker)
            .arg(library)
            .arg(std::env::current_exe()?.with_file_name(fields))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .with_context(|| python.display().to_string())?;
        let requests = child.stdin.take();
        let replies = BufReader::new(child.stdout.take().context("its output is a pipe")?);
        let mut peer = Self {
            name: String::new(),
            child,
            requests,
            replies,
            folder: tempfile::tempdir()?,
            written: None,
        };
        match peer.reply()? {
            Reply::Ready { ready } => peer.name = ready,
            Reply::Failed { failed } => bail!("{failed}"),
            Reply::Done { .. } => bail!("unexpected answer"),
        }
        Ok(peer)
    }

    fn reply(&mut self) -> Result<Reply> {
        let mut line = String::new();
        if self.replies.read_line(&mut line)? == 0 {
            bail!("ended before it answered");
        }
        serde_json::from_str(&line).with_context(|| line)
    }

    fn samples(&mut self, grid: &Grid) -> Result<PathBuf> {
        let path = self.folder.path().join("samples.f32");
        if self.written != Some((grid.field, grid.cells)) {
            let bytes: Vec<u8> = grid.samples.iter().flat_map(|sample| sample.to_le_bytes()).collect();
            std::fs::write(&path, bytes)?;
            self.written = Some((grid.field, grid.cells));
        }
        Ok(path)
    }
}

impl Peer for PythonPeer {
    fn name(&self) -> String {
        self.name.clone()
    }

    fn process(&self) -> Option<u32> {
        Some(self.child.id())
    }

    fn extract(&mut self, grid: &Grid, with_mesh: bool) -> Result<Outcome> {
        let samples = self.samples(grid)?;
        let file = self.folder.path().join("mesh.bin");
        let n = grid.cells + 1;
        let request = json!({
            "field": grid.field,
            "samples": samples,
            "size": [n, n, n],
            "origin": [-REACH, -REACH, -REACH],
            "spacing": grid.spacing,
            "mesh": with_mesh.then_some(&file),
        });
        writeln!(self.requests.as_mut().context("it is still asked")?, "{request}")?;
        match self.reply().with_context(|| self.name.clone())? {
            Reply::Done { extraction_s, callback_s } => {
                let mesh = if with_mesh { Some(read_mesh(&std::fs::read(&file)?)?) } else { None };
                Ok(Outcome { extraction_s, sampling_s: callback_s, mesh })
            }
            Reply::Failed { failed } => bail!("{}: {failed}", self.name),
            Reply::Ready { .. } => bail!("unexpected answer"),
        }
    }
}

impl Drop for PythonPeer {
    fn drop(&mut self) {
        self.requests = None;
        let _ = self.child.wait();
    }
}

/// Two 64-bit counts, positions, triangles; little-endian.
fn read_mesh(bytes: &[u8]) -> Result<TriangleMesh> {
    let (counts, rest) = bytes.split_at_checked(16).context("a mesh file is too short")?;
    let count = |i: usize| u64::from_le_bytes(counts[8 * i..8 * i + 8].try_into().expect("8 bytes")) as usize;
    let (positions, triangles) = rest.split_at_checked(12 * count(0)).context("a mesh file is too short")?;
    let word = |bytes: &[u8], i: usize| -> [u8; 4] { bytes[4 * i..4 * i + 4].try_into().expect("4 bytes") };
    let position = |p: &[u8; 12]| Vec3::from_array([0, 1, 2].map(|i| f32::from_le_bytes(word(p, i))));
    let triangle = |t: &[u8; 12]| [0, 1, 2].map(|i| u32::from_le_bytes(word(t, i)));
    Ok(TriangleMesh {
        positions: positions.as_chunks::<12>().0.iter().map(position).collect(),
        normals: Vec::new(),
        triangles: triangles.as_chunks::<12>().0.iter().map(triangle).collect(),
    })
}
