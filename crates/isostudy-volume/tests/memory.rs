//! Reading takes the memory that its limit says, whatever a file claims and whatever is in it.
//!
//! A binary of its own, with one test: the allocator counts for the whole process.

use std::alloc::System;
use std::fs;
use std::io::Write;

use cap::Cap;
use flate2::Compression;
use flate2::write::GzEncoder;
use isostudy_volume::Problem;

#[global_allocator]
static ALLOCATOR: Cap<System> = Cap::new(System, usize::MAX);

/// Room for buffers: those of the reader, of a block of samples and of the decompressor.
const BUFFERS: usize = 1 << 20;
/// Not a power of two, so that a vector that doubles would have more.
const SIDE: usize = 144;

/// Runs with so many more bytes than are in use.
fn within<T>(bytes: usize, run: impl FnOnce() -> T) -> T {
    ALLOCATOR.set_limit(ALLOCATOR.allocated() + bytes).unwrap();
    let result = run();
    ALLOCATOR.set_limit(usize::MAX).unwrap();
    result
}

/// Zeros, compressed.
fn zeros(bytes: usize) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    let block = vec![0; 1 << 16];
    for first in (0..bytes).step_by(block.len()) {
        encoder.write_all(&block[..block.len().min(bytes - first)]).unwrap();
    }
    encoder.finish().unwrap()
}

/// No harness: its thread allocates, and the allocator counts for the whole process.
fn main() {
    samples_take_the_memory_that_their_header_claims();
    println!("test samples_take_the_memory_that_their_header_claims ... ok");
}

fn samples_take_the_memory_that_their_header_claims() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let samples = SIDE.pow(3);
    let header = |encoding: &str, skip: i32| {
        format!(
            "NRRD0004\ntype: uchar\ndimension: 3\nsizes: {SIDE} {SIDE} {SIDE}\nencoding: {encoding}\nbyte skip: {skip}\n\n"
        )
    };
    let limit = 4 * samples;
    let read = |name: &str| {
        let path = at(name);
        within(limit + BUFFERS, || isostudy_volume::read(&path, limit as u64))
    };

    // What is there is what was claimed: raw, compressed, as text, and behind something else.
    fs::write(at("gzip.nrrd"), [header("gzip", 0).as_bytes(), &zeros(samples)].concat()).unwrap();
    fs::write(at("text.nrrd"), [header("text", 0).as_bytes(), "0 ".repeat(samples).as_bytes()].concat())
        .unwrap();
    fs::write(
        at("last.nrrd"),
        [header("raw", -1).as_bytes(), &vec![7; 20 * samples], &vec![0; samples]].concat(),
    )
    .unwrap();
    for name in ["gzip.nrrd", "text.nrrd", "last.nrrd"] {
        let volume = read(name).unwrap_or_else(|error| panic!("{error}"));
        assert!(volume.values.len() == samples && volume.values.iter().all(|&value| value == 0.0));
    }
    // More than was claimed, a hundred times.
    fs::write(at("bomb.nrrd"), [header("gzip", 0).as_bytes(), &zeros(100 * samples)].concat()).unwrap();
    assert!(matches!(*read("bomb.nrrd").unwrap_err().problem, Problem::Excess { .. }));
    // Less.
    fs::write(at("short.nrrd"), [header("gzip", 0).as_bytes(), &zeros(samples / 100)].concat()).unwrap();
    let path = at("short.nrrd");
    let problem =
        within(limit / 20 + BUFFERS, || isostudy_volume::read(&path, limit as u64)).unwrap_err().problem;
    assert!(matches!(*problem, Problem::Truncated { .. }), "{problem}");

    // A byte less is not enough, and nothing is read.
    let error = within(BUFFERS, || isostudy_volume::read(&at("gzip.nrrd"), limit as u64 - 1)).unwrap_err();
    let said = error.to_string();
    let want = "gzip.nrrd: sizes [144, 144, 144] need 11.4 MiB of memory, four bytes a sample, and the limit is 11.3 MiB";
    assert!(said.ends_with(want), "{said}");
    fs::write(at("a.nrrd"), "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 1000 1000 1000\nencoding: gzip\n\n")
        .unwrap();
    let said = within(BUFFERS, || isostudy_volume::read(&at("a.nrrd"), 1 << 30)).unwrap_err().to_string();
    assert!(said.contains("need 3.8 GiB of memory") && said.ends_with("the limit is 1.0 GiB"), "{said}");
    fs::write(
        at("a.nrrd"),
        "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4294967296 4294967296 2\nencoding: gzip\n\n",
    )
    .unwrap();
    let said = within(BUFFERS, || isostudy_volume::read(&at("a.nrrd"), 1 << 30)).unwrap_err().to_string();
    assert!(said.contains("need more memory than can be counted"), "{said}");
}
