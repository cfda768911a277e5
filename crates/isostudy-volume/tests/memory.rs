//! Reading takes the memory that its limit says, whatever a file claims and whatever is in it.

mod files;

use std::alloc::System;
use std::io::Write;

use cap::Cap;
use files::Folder;
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

/// One test only: the limit is the whole process's.
#[test]
fn samples_take_the_memory_that_their_header_claims() {
    let folder = Folder::new();
    let samples = SIDE.pow(3);
    let header = |encoding: &str, skip: i32| {
        format!(
            "NRRD0004\ntype: uchar\ndimension: 3\nsizes: {SIDE} {SIDE} {SIDE}\nencoding: {encoding}\nbyte skip: {skip}\n\n"
        )
    };
    let limit = 4 * samples;
    let read = |name: &str| {
        let path = folder.path(name);
        within(limit + BUFFERS, || isostudy_volume::read(&path, limit as u64))
    };

    // What is there is what was claimed: raw, compressed, as text, and behind something else.
    folder.write("gzip.nrrd", [header("gzip", 0).as_bytes(), &zeros(samples)].concat());
    folder.write("text.nrrd", [header("text", 0).as_bytes(), "0 ".repeat(samples).as_bytes()].concat());
    folder.write(
        "last.nrrd",
        [header("raw", -1).as_bytes(), &vec![7; 20 * samples], &vec![0; samples]].concat(),
    );
    for name in ["gzip.nrrd", "text.nrrd", "last.nrrd"] {
        let volume = read(name).unwrap_or_else(|error| panic!("{error}"));
        assert!(volume.values.len() == samples && volume.values.iter().all(|&value| value == 0.0));
    }
    // More than was claimed, a hundred times.
    folder.write("bomb.nrrd", [header("gzip", 0).as_bytes(), &zeros(100 * samples)].concat());
    assert!(matches!(*read("bomb.nrrd").unwrap_err().problem, Problem::Excess { .. }));
    // Less.
    folder.write("short.nrrd", [header("gzip", 0).as_bytes(), &zeros(samples / 100)].concat());
    let path = folder.path("short.nrrd");
    let problem =
        within(limit / 20 + BUFFERS, || isostudy_volume::read(&path, limit as u64)).unwrap_err().problem;
    assert!(matches!(*problem, Problem::Truncated { .. }), "{problem}");

    // A byte less is not enough, and nothing is read.
    let error =
        within(BUFFERS, || isostudy_volume::read(&folder.path("gzip.nrrd"), limit as u64 - 1)).unwrap_err();
    let said = error.to_string();
    let want = "gzip.nrrd: sizes [144, 144, 144] need 11.4 MiB of memory, four bytes a sample, and the limit is 11.3 MiB";
    assert!(said.ends_with(want), "{said}");
    folder.write("a.nrrd", "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 1000 1000 1000\nencoding: gzip\n\n");
    let said =
        within(BUFFERS, || isostudy_volume::read(&folder.path("a.nrrd"), 1 << 30)).unwrap_err().to_string();
    assert!(said.contains("need 3.8 GiB of memory") && said.ends_with("the limit is 1.0 GiB"), "{said}");
    folder.write(
        "a.nrrd",
        "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4294967296 4294967296 2\nencoding: gzip\n\n",
    );
    let said =
        within(BUFFERS, || isostudy_volume::read(&folder.path("a.nrrd"), 1 << 30)).unwrap_err().to_string();
    assert!(said.contains("need more memory than can be counted"), "{said}");
}
