//! Boundaries of labels in chunks: what is extracted box by box is what is extracted at once.

use isostudy_extract::{
    CellBox, Execution, LabelChunk, LabelError, LabelSettings, LabelVolume, WeldError, weld_label_chunks,
};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

const ONE: Execution = Execution { threads: 1 };

/// Noise of so many labels, or blobs of them.
fn labels(counts: [usize; 3], kinds: u32, seed: u64) -> Vec<u32> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let middles: Vec<([f32; 3], u32)> = (0..9)
        .map(|_| (counts.map(|n| random.random::<f32>() * n as f32), random.random_range(0..kinds)))
        .collect();
    let total: usize = counts.iter().product();
    let of = |i: usize| {
        let place = [i % counts[0], i / counts[0] % counts[1], i / counts[0] / counts[1]];
        let apart =
            |of: &[f32; 3]| -> f32 { (0..3).map(|axis| (of[axis] - place[axis] as f32).powi(2)).sum() };
        let nearest = middles.iter().min_by(|a, b| apart(&a.0).total_cmp(&apart(&b.0)));
        nearest.map_or(0, |(_, label)| *label)
    };
    if seed.is_multiple_of(2) {
        return (0..total).map(|_| random.random_range(0..kinds)).collect();
    }
    (0..total).map(of).collect()
}

fn volume(counts: [usize; 3], labels: &[u32]) -> LabelVolume<'_> {
    let steps = [[0.7, 0.1, 0.0], [-0.2, 1.1, 0.05], [0.0, 0.3, 0.9]];
    LabelVolume { counts, labels, origin: [10.0, -3.0, 0.25], steps }
}

/// Boxes that fill the cells, cut at random places.
fn boxes(all: CellBox, random: &mut Pcg64Mcg) -> Vec<CellBox> {
    let cuts = [0, 1, 2].map(|axis| {
        let (start, end) = (all.start[axis], all.end[axis]);
        let mut cuts: Vec<i32> =
            (0..2).map(|_| random.random_range(start..end)).chain([start, end]).collect();
        cuts.sort_unstable();
        cuts.dedup();
        cuts
    });
    let pairs = |axis: usize| cuts[axis].windows(2).map(|pair| [pair[0], pair[1]]).collect::<Vec<_>>();
    let mut found = Vec::new();
    for z in pairs(2) {
        for y in pairs(1) {
            for x in pairs(0) {
                found.push(CellBox { start: [x[0], y[0], z[0]], end: [x[1], y[1], z[1]] });
            }
        }
    }
    found
}

#[test]
fn chunks_weld_to_the_whole() {
    let mut random = Pcg64Mcg::seed_from_u64(5);
    for seed in 0..24 {
        let counts = [[7, 9, 6], [12, 5, 8], [2, 2, 2], [16, 3, 11]][seed as usize % 4];
        let labels = labels(counts, 2 + seed as u32 % 4, seed);
        let volume = volume(counts, &labels);
        for smoothing in [0, 1, 3] {
            for close in [false, true] {
                let settings = LabelSettings::default()
                    .with_smoothing(smoothing)
                    .with_close(close)
                    .with_only(if seed.is_multiple_of(3) { &[] } else { &[1] });
                let Ok(whole) = volume.extract(&settings, &ONE) else { continue };
                let border = i32::from(close);
                let all = CellBox { start: [-border; 3], end: counts.map(|n| n as i32 - 1 + border) };
                let mut chunks: Vec<LabelChunk> = boxes(all, &mut random)
                    .into_iter()
                    .map(|cells| volume.extract_chunk(&settings, cells).unwrap())
                    .collect();
                chunks.reverse();
                let welded = weld_label_chunks(&chunks).unwrap();
                assert_eq!(welded, whole.labelled, "{seed}, {smoothing}, {close}");
            }
        }
    }
}

/// After an edit, the chunks within a cell of it are enough.
#[test]
fn an_edit_is_for_the_chunks_beside_it() {
    let counts = [25; 3];
    let mut labels = labels(counts, 4, 1);
    let cells = |start: [i32; 3]| CellBox { start, end: start.map(|i| i + 8) };
    let all: Vec<CellBox> = (0..27).map(|i| cells([i % 3 * 8, i / 3 % 3 * 8, i / 9 * 8])).collect();
    let settings = LabelSettings::default();
    let of = |labels: &[u32], cells: CellBox| volume(counts, labels).extract_chunk(&settings, cells).unwrap();
    let mut chunks: Vec<LabelChunk> = all.iter().map(|&cells| of(&labels, cells)).collect();
    let at = [8, 12, 20];
    labels[(at[2] * 25 + at[1]) * 25 + at[0]] += 1;
    let mut again = 0;
    for (chunk, &cells) in chunks.iter_mut().zip(&all) {
        let is_beside = |axis: usize| (cells.start[axis] - 1..=cells.end[axis]).contains(&(at[axis] as i32));
        if (0..3).all(is_beside) {
            *chunk = of(&labels, cells);
            again += 1;
        } else {
            assert_eq!(*chunk, of(&labels, cells));
        }
    }
    assert_eq!(again, 2);
    let whole = volume(counts, &labels).extract(&settings, &ONE).unwrap().labelled;
    assert_eq!(weld_label_chunks(&chunks).unwrap(), whole);
}

#[test]
fn what_does_not_fit_is_named() {
    let counts = [9; 3];
    let labels = labels(counts, 3, 1);
    let settings = LabelSettings::default();
    let extract = |cells| volume(counts, &labels).extract_chunk(&settings, cells);
    for (start, end) in [([0; 3], [9; 3]), ([-1, 0, 0], [3; 3]), ([3; 3], [3; 3])] {
        let error = extract(CellBox { start, end }).unwrap_err();
        assert!(matches!(error, LabelError::Beyond { .. }), "{error}");
        assert!(error.to_string().contains("[0, 0, 0] to [8, 8, 8]"), "{error}");
    }
    let one = extract(CellBox { start: [0; 3], end: [5; 3] }).unwrap();
    let other = extract(CellBox { start: [4; 3], end: [8; 3] }).unwrap();
    assert_eq!(weld_label_chunks(&[one, other]), Err(WeldError::Overlap { cell: [4; 3] }));
    // A chunk that was not extracted again after an edit has a vertex in another place.
    let halves = [[0, 4], [4, 8]].map(|[from, to]| CellBox { start: [from, 0, 0], end: [to, 8, 8] });
    let mut edited = labels.clone();
    let old = volume(counts, &labels).extract_chunk(&settings, halves[0]).unwrap();
    for z in 0..9 {
        edited[(z * 9 + 4) * 9 + 4] = 7;
    }
    let new = volume(counts, &edited).extract_chunk(&settings, halves[1]).unwrap();
    assert!(matches!(weld_label_chunks(&[old, new]), Err(WeldError::Mismatch(_))));
}
