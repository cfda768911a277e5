//! `isostudy turntable` with a mesh, as a user runs it.

use crate::command::{Folder, Run};
use isostudy_raster::Animation;

/// An animation that was made with these arguments.
fn made(folder: &Folder, arguments: &[&str]) -> Animation {
    let small = ["--size", "96", "--frames", "8", "-o", "out.gif"];
    assert_eq!(folder.succeed(&[arguments, &small].concat()).stdout, "out.gif\n");
    Animation::read_gif(&std::fs::read(folder.path("out.gif")).unwrap()[..]).unwrap()
}

fn refused(folder: &Folder, arguments: &[&str], says: &str) {
    let Run { code, stderr, .. } = folder.run(arguments);
    assert_eq!(code, Some(2), "{arguments:?}: {stderr}");
    assert!(stderr.contains(says), "{arguments:?}: {stderr}");
}

const BALL: &str = "sqrt((x-5)^2+y^2+z^2) - 1";
const BOX: &str = "--bounds=3.8,-1.2,-1.2,6.2,1.2,1.2";

/// A ball that is not in the middle of the scene, and one that is half a spacing larger.
fn write_balls(folder: &Folder) {
    for (name, formula) in [("ball.ply", BALL), ("large.obj", "sqrt((x-5)^2+y^2+z^2) - 1.05")] {
        let arguments = ["extract", "--field", formula, BOX, "--spacing", "0.1", "-o", name];
        Run::succeed(folder.isostudy().args(arguments));
    }
}

/// The commonest colour inside the middle quarter of the first frame.
fn middle(animation: &Animation) -> [u8; 3] {
    let (mut counts, width) = ([0u32; 256], animation.width as usize);
    for y in width * 3 / 8..width * 5 / 8 {
        for x in width * 3 / 8..width * 5 / 8 {
            counts[usize::from(animation.frames[0][y * width + x])] += 1;
        }
    }
    let most = (0..256).max_by_key(|&i| counts[i]).unwrap();
    animation.palette.colours()[most]
}

#[test]
fn a_mesh_turns_in_every_look_wherever_it_lies() {
    let folder = Folder::of("turntable");
    write_balls(&folder);
    let smooth = made(&folder, &["ball.ply"]);
    assert_eq!((smooth.width, smooth.height, smooth.frames.len(), smooth.delay_cs), (96, 96, 8, 100));
    // It fills most of the picture, and stays clear of the border.
    let background = smooth.frames[0][0];
    for frame in &smooth.frames {
        let covered = frame.iter().filter(|&&index| index != background).count();
        assert!((1800..6000).contains(&covered), "{covered}");
        assert!(frame[..96].iter().all(|&index| index == background));
    }
    let flat = made(&folder, &["ball.ply", "--look", "flat"]);
    assert_eq!(flat.palette, smooth.palette);
    assert_ne!(flat.frames, smooth.frames);
    assert_ne!(made(&folder, &["ball.ply", "--look", "smooth-wireframe"]).palette, smooth.palette);
    // The camera's light falls from the same side on every frame, the scene's does not.
    let dark = |animation: &Animation| -> Vec<usize> {
        let is_dark = |&&index: &&u8| {
            let [r, g, _] = animation.palette.colours()[usize::from(index)];
            index != background && r < 90 && g < 90
        };
        animation.frames.iter().map(|frame| frame.iter().filter(is_dark).count()).collect()
    };
    let scene = dark(&made(&folder, &["ball.ply", "--light-follows", "scene", "--ambient", "0"]));
    let camera = dark(&made(&folder, &["ball.ply", "--ambient", "0"]));
    let range = |counts: &[usize]| counts.iter().max().unwrap() - counts.iter().min().unwrap();
    assert!(range(&scene) > 10 * range(&camera).max(1), "{scene:?} {camera:?}");
    let one = made(&folder, &["ball.ply", "--threads", "1"]);
    assert_eq!(one, smooth);
}

#[test]
fn colours_stand_for_numbers_and_have_a_scale() {
    let folder = Folder::of("turntable");
    write_balls(&folder);
    let quality = made(&folder, &["ball.ply", "--colour", "quality", "--ambient", "1"]);
    assert!(quality.height > 110, "{}", quality.height);
    let error = |mesh: &str, more: &[&str]| {
        let surface = [mesh, "--colour", "error", "--ambient", "1", "--field", BALL, BOX, "--spacing", "0.1"];
        middle(&made(&folder, &[&surface[..], more].concat()))
    };
    // Half a spacing off: beyond the default scale, in the middle of one to 1.
    let near = |found: [u8; 3], place: f32| {
        let want = isostudy_raster::map_colour(place).map(|v| (v * 255.0) as u8);
        assert!((0..3).all(|c| found[c].abs_diff(want[c]) < 14), "{found:?} is not {want:?}");
    };
    near(error("large.obj", &[]), 0.0);
    near(error("large.obj", &["--error-scale", "1"]), 0.5);
    near(error("ball.ply", &["--error-scale", "1"]), 1.0);
}

#[test]
fn options_are_for_a_mesh_or_for_a_study() {
    let folder = Folder::of("turntable");
    write_balls(&folder);
    refused(&folder, &["ball.ply"], "-o is needed");
    refused(&folder, &["ball.ply", "-o", "ball.ply"], "animations are .gif");
    refused(&folder, &["ball.ply", "-o", "a.gif", "--force"], "are for a study");
    refused(&folder, &["ball.ply", "-o", "a.gif", "--look", "shiny"], "`smooth`, `flat`, `smooth-wireframe`");
    refused(&folder, &["ball.ply", "-o", "a.gif", "--ambient", "2"], "allowed: 0 to 1");
    refused(&folder, &["ball.ply", "-o", "a.gif", "--colour", "error"], "an isosurface is needed");
    refused(&folder, &["ball.ply", "-o", "a.gif", "--error-scale", "1"], "for --colour error");
    refused(&folder, &["study.toml", "--look", "flat"], "--look is for a mesh; study.toml is a study");
    let empty = ["empty.obj", "-o", "a.gif"];
    folder.write("empty.obj", "v 0 0 0\n");
    refused(&folder, &empty, "empty.obj");
    assert!(!folder.path("a.gif").exists());
}
