//! Turntables, pairs and GIF files.

use crate::shapes;
use image::AnimationDecoder;
use image::codecs::gif::GifDecoder;
use isostudy_raster::{Animation, AnimationError, Look, Palette, Shading, Turntable, turntable};
use std::io::Cursor;
use std::sync::atomic::{AtomicUsize, Ordering};

fn settings() -> Turntable {
    Turntable { width: 48, height: 40, frames: 5, duration_s: 0.34, ..Turntable::default() }
}

fn animation(look: Look) -> Animation {
    turntable(&shapes::torus(0.7, 0.3, 20, 10), &settings(), &Shading::default(), look, &|| ()).unwrap()
}

fn gif(animation: &Animation) -> Vec<u8> {
    let mut file = Vec::new();
    animation.write_gif(&mut file).unwrap();
    file
}

#[test]
fn another_decoder_sees_the_same_pixels_delay_and_endless_loop() {
    for look in [Look::Smooth, Look::SmoothWireframe] {
        let animation = animation(look);
        let decoder = GifDecoder::new(Cursor::new(gif(&animation))).unwrap();
        assert!(matches!(decoder.loop_count(), image::metadata::LoopCount::Infinite));
        let frames = decoder.into_frames().collect_frames().unwrap();
        assert_eq!(frames.len(), 5);
        for (i, frame) in frames.iter().enumerate() {
            assert_eq!(frame.delay().numer_denom_ms(), (60, 1));
            assert_eq!(frame.buffer().as_raw().as_slice(), animation.picture(i).data());
        }
    }
}

#[test]
fn reading_back_gives_what_was_written() {
    let animation = animation(Look::Smooth);
    assert_eq!(animation.delay_cs, 6);
    assert_eq!(Animation::read_gif(&gif(&animation)[..]).unwrap(), animation);
    let few = Animation {
        width: 2,
        height: 1,
        delay_cs: 1,
        palette: Palette::new(vec![[1, 2, 3], [4, 5, 6], [7, 8, 9]]),
        frames: vec![vec![0, 2]],
    };
    assert_eq!(Animation::read_gif(&gif(&few)[..]).unwrap(), few);
}

#[test]
fn files_hold_one_palette_and_nothing_to_read() {
    let file = gif(&animation(Look::Smooth));
    let mut decoder = gif::DecodeOptions::new().read_info(&file[..]).unwrap();
    assert_eq!(decoder.global_palette().unwrap().len(), 768);
    assert_eq!((decoder.xmp_metadata(), decoder.icc_profile()), (None, None));
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        assert!(frame.palette.is_none() && frame.transparent.is_none());
    }
    // Walk the blocks: only the loop extension, graphic controls and images.
    let (mut at, mut labels) = (13 + 768, Vec::new());
    let skip_blocks = |mut at: usize| {
        while file[at] != 0 {
            at += file[at] as usize + 1;
        }
        at + 1
    };
    loop {
        match file[at] {
            0x21 => {
                labels.push(file[at + 1]);
                at = skip_blocks(at + 2);
            }
            0x2C => at = skip_blocks(at + 11),
            other => {
                assert_eq!((other, at + 1), (0x3B, file.len()));
                break;
            }
        }
    }
    assert_eq!(labels, [0xFF, 0xF9, 0xF9, 0xF9, 0xF9, 0xF9]);
}

#[test]
fn the_halves_of_a_pair_are_the_turntables() {
    let (left, right) = (animation(Look::Smooth), animation(Look::Flat));
    assert_ne!(left.frames, right.frames);
    let read = |animation: &Animation| Animation::read_gif(&gif(animation)[..]).unwrap();
    let pair = read(&read(&left).side_by_side(&read(&right)).unwrap());
    assert_eq!((pair.width, pair.height, pair.delay_cs, pair.frames.len()), (96, 40, 6, 5));
    for (f, frame) in pair.frames.iter().enumerate() {
        for (y, row) in frame.chunks_exact(96).enumerate() {
            assert_eq!(row[..48], left.frames[f][y * 48..][..48]);
            assert_eq!(row[48..], right.frames[f][y * 48..][..48]);
        }
    }
}

#[test]
fn halves_that_differ_are_refused() {
    let left = animation(Look::Smooth);
    let refused = |right: Animation| match left.side_by_side(&right).unwrap_err() {
        AnimationError::Mismatch { what, .. } => what,
        other => panic!("{other}"),
    };
    assert_eq!(refused(Animation { width: 47, ..left.clone() }), "width");
    assert_eq!(refused(Animation { height: 39, ..left.clone() }), "height");
    assert_eq!(refused(Animation { delay_cs: 7, ..left.clone() }), "delay in centiseconds");
    assert_eq!(refused(Animation { frames: left.frames[1..].to_vec(), ..left.clone() }), "number of frames");
    assert!(refused(animation(Look::SmoothWireframe)).starts_with("palette"));
}

#[test]
fn scaling_repeats_pixels() {
    let small = Animation {
        width: 2,
        height: 2,
        delay_cs: 6,
        palette: Palette::new(vec![[0; 3], [9; 3], [18; 3], [27; 3]]),
        frames: vec![vec![0, 1, 2, 3]],
    };
    let large = small.scaled(2);
    assert_eq!((large.width, large.height), (4, 4));
    assert_eq!(large.frames, [[0, 0, 1, 1, 0, 0, 1, 1, 2, 2, 3, 3, 2, 2, 3, 3]]);
    assert_eq!(small.scaled(1), small);
}

#[test]
fn threads_do_not_change_a_byte() {
    let mesh = shapes::sphere(1.0, 20);
    let draw = |threads| {
        let calls = AtomicUsize::new(0);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let file = pool.install(|| {
            let count = || {
                calls.fetch_add(1, Ordering::Relaxed);
            };
            gif(&turntable(&mesh, &settings(), &Shading::default(), Look::Smooth, &count).unwrap())
        });
        assert_eq!(calls.into_inner(), 5, "called once a frame");
        file
    };
    let one = draw(1);
    assert!(draw(2) == one && draw(5) == one);
}

#[test]
fn foreign_and_damaged_files_are_typed_errors() {
    let read = |file: &[u8]| Animation::read_gif(file).unwrap_err();
    let file = gif(&animation(Look::Smooth));
    assert!(matches!(read(&file[..file.len() / 2]), AnimationError::Decode(_)));
    assert!(matches!(read(b"not a GIF"), AnimationError::Decode(_)));
    let foreign = |edit: &dyn Fn(&mut gif::Frame)| {
        let mut file = Vec::new();
        let mut encoder = gif::Encoder::new(&mut file, 2, 2, &[0; 12]).unwrap();
        let mut frame = gif::Frame::from_indexed_pixels(2, 2, vec![0, 1, 2, 3], None);
        encoder.write_frame(&frame).unwrap();
        edit(&mut frame);
        encoder.write_frame(&frame).unwrap();
        drop(encoder);
        Animation::read_gif(&file[..]).err()
    };
    assert!(foreign(&|_| ()).is_none());
    let edits: [&dyn Fn(&mut gif::Frame); 4] = [
        &|f| (f.width, f.buffer) = (1, vec![0, 1].into()),
        &|f| f.palette = Some(vec![0; 12]),
        &|f| f.transparent = Some(0),
        &|f| f.delay = 3,
    ];
    for edit in edits {
        assert!(matches!(foreign(edit), Some(AnimationError::Foreign { frame: Some(1), .. })));
    }
    let wide = Animation { width: 70_000, height: 1, frames: vec![], ..animation(Look::Flat) };
    assert!(matches!(wide.write_gif(std::io::sink()), Err(AnimationError::Size { pixels: 70_000 })));
}
