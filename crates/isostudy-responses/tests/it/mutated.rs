//! Exports damaged in every way: no panic, and what is read all the same is sound.

use isostudy_responses::{Duplicates, Mapping, Reading, Unknown};
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::io::{Cursor, Read, Write};
use std::path::Path;

/// What breaks readers.
const TOKENS: [&[u8]; 33] = [
    b"\"",
    b"\"\"",
    b",",
    b";",
    b"\t",
    b"\n",
    b"\r\n",
    b"\r",
    b"\0",
    b"=1+1",
    b"'",
    b" *",
    b"\xef\xbb\xbf",
    b"\xff\xfe",
    b"\xc2\xa0",
    b"Left",
    b"none",
    b"Q1",
    b"Q2",
    b"a",
    b"NA",
    b"count",
    b"repeat",
    b"-1",
    b"99999999999999999999",
    b"1e400",
    b"nan",
    b"{\"ImportId\":\"QID1\"}",
    b"[",
    b"}",
    b"</c>",
    b"<c r=\"XFD1048576\"><v>1</v></c>",
    b"&#x110000;",
];

fn exports() -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/exports");
    let mut paths: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths.iter().map(|path| std::fs::read(path).unwrap()).collect()
}

/// Changes a few places of some bytes.
fn mutate(bytes: &mut Vec<u8>, others: &[Vec<u8>], random: &mut Pcg64) {
    for _ in 0..random.random_range(1..=6) {
        let at = random.random_range(0..=bytes.len());
        let end = (at + random.random_range(0..=40)).min(bytes.len());
        match random.random_range(0..9) {
            0 if at < bytes.len() => bytes[at] ^= 1 << random.random_range(0..8),
            1 if at < bytes.len() => bytes[at] = random.random(),
            2 => drop(bytes.drain(at..end)),
            3 | 4 => {
                let token = TOKENS[random.random_range(0..TOKENS.len())];
                drop(bytes.splice(at..at, token.iter().copied()));
            }
            5 => {
                let copy = bytes[at..end].to_vec();
                drop(bytes.splice(at..at, copy));
            }
            6 => bytes.truncate(at),
            7 => {
                // A line again, or a line from somewhere else.
                let from = &others[random.random_range(0..others.len())];
                let lines: Vec<&[u8]> = from.split_inclusive(|&byte| byte == b'\n').collect();
                let line = lines[random.random_range(0..lines.len())].to_vec();
                drop(bytes.splice(at..at, line));
            }
            _ => {
                let (a, b) = (random.random_range(0..=bytes.len()), random.random_range(0..=bytes.len()));
                bytes[a.min(b)..a.max(b)].reverse();
            }
        }
    }
}

/// Changes one part of a zip file and packs it anew, so that the change gets past its checksum.
fn mutate_inside(bytes: &[u8], others: &[Vec<u8>], random: &mut Pcg64) -> Option<Vec<u8>> {
    let mut from = zip::ZipArchive::new(Cursor::new(bytes)).ok()?;
    let mut to = zip::ZipWriter::new(Cursor::new(Vec::new()));
    let changed = random.random_range(0..from.len());
    for i in 0..from.len() {
        let mut part = from.by_index(i).ok()?;
        let mut content = Vec::new();
        part.read_to_end(&mut content).ok()?;
        if i == changed {
            mutate(&mut content, others, random);
        }
        let stored =
            zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
        to.start_file(part.name().ok()?.into_owned(), stored).ok()?;
        to.write_all(&content).ok()?;
    }
    Some(to.finish().ok()?.into_inner())
}

/// Every index is in range, every participant has answered, and the long format says the same again.
fn check(reading: &Reading) {
    let answers = &reading.responses;
    let mut answered = vec![false; answers.participants.len()];
    for answer in &answers.answers {
        answered[answer.participant as usize] = true;
        let question = &answers.questions[answer.question as usize];
        let [mut asked, mut shown] = [[question.left, question.right], [answer.left, answer.right]];
        asked.sort_unstable();
        shown.sort_unstable();
        assert_eq!(asked, shown);
        assert!(answer.rt_ms.is_none_or(|time| time.is_finite() && time >= 0.0));
    }
    assert!(answered.iter().all(|&answered| answered));
    assert!(answers.questions.iter().all(|q| q.left.max(q.right) < answers.items.len() as u32));
    assert!(!reading.report.to_string().is_empty() && !reading.report.to_csv().is_empty());
    let mut long = Vec::new();
    isostudy_responses::write_long(answers, &mut long).unwrap();
    let again = isostudy_responses::parse(&long, Path::new("long.csv"), None, &Mapping::default());
    let again = again.unwrap_or_else(|error| panic!("{error}\n{}", String::from_utf8_lossy(&long)));
    assert_eq!(crate::study::said(&again), crate::study::said(reading));
}

fn run(cases: u64, seed: u64) -> u64 {
    let exports = exports();
    let plan = crate::study::plan();
    let lenient = Mapping { unknown: Unknown::LeaveOut, duplicates: Duplicates::Last, ..Mapping::default() };
    // Exports with codes say nothing without.
    let coded = Mapping {
        unknown: Unknown::LeaveOut,
        duplicates: Duplicates::First,
        ..crate::study::synonyms("1", "2", "3")
    };
    let mut random = Pcg64::seed_from_u64(seed);
    let mut read = 0;
    for case in 0..cases {
        let mut bytes = exports[random.random_range(0..exports.len())].clone();
        let inside = bytes.starts_with(b"PK") && random.random_range(0..4) > 0;
        match inside.then(|| mutate_inside(&bytes, &exports, &mut random)).flatten() {
            Some(changed) => bytes = changed,
            None => mutate(&mut bytes, &exports, &mut random),
        }
        let plan = (case % 8 != 0).then_some(&plan);
        let mapping = match case % 4 {
            0 | 2 => &lenient,
            1 => &coded,
            _ => &Mapping::default(),
        };
        let parsed = std::panic::catch_unwind(|| {
            let reading = isostudy_responses::parse(&bytes, Path::new("x"), plan, mapping);
            reading.as_ref().map(check).map_err(|error| assert!(!error.to_string().is_empty())).is_ok()
        });
        read += match parsed {
            Ok(sound) => u64::from(sound),
            Err(_) => panic!("case {case} of seed {seed}: {:?}", String::from_utf8_lossy(&bytes)),
        };
    }
    read
}

#[test]
fn thousands_of_damaged_exports() {
    let read = run(4_000, 1);
    // Some damage leaves a file that says something; most does not.
    assert!((400..3_600).contains(&read), "{read} were read");
}

/// A million, in eight parts that differ by their seed.
#[test]
#[ignore = "minutes: run by make test-long"]
fn a_million_damaged_exports() {
    let parts = std::thread::available_parallelism().map_or(1, |n| n.get() as u64).min(8);
    let read: u64 = std::thread::scope(|scope| {
        let part = |part: u64| {
            scope.spawn(move || (part..8).step_by(parts as usize).map(|p| run(125_000, 100 + p)).sum::<u64>())
        };
        (0..parts).map(part).collect::<Vec<_>>().into_iter().map(|thread| thread.join().unwrap()).sum()
    });
    assert!((100_000..900_000).contains(&read), "{read} were read");
}

#[test]
fn random_bytes_are_refused_or_read() {
    let mut random = Pcg64::seed_from_u64(5);
    for length in 0..2_000 {
        let mut bytes = vec![0; length % 300];
        random.fill_bytes(&mut bytes);
        let _ = isostudy_responses::parse(
            &bytes,
            Path::new("x"),
            Some(&crate::study::plan()),
            &Mapping::default(),
        );
    }
}
