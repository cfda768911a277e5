//! Whether colours for numbers can be told apart and put in order, by everybody.

use isostudy_raster::{Look, Palette, Shading, map_colour};

/// CIELAB of an sRGB colour (D65), from the definitions: IEC 61966-2-1 and CIE 15.
fn lab(colour: [f32; 3]) -> [f64; 3] {
    let [r, g, b] = colour.map(|v| {
        let v = f64::from(v);
        if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
    });
    let xyz = [
        (0.4124564 * r + 0.3575761 * g + 0.1804375 * b) / 0.95047,
        0.2126729 * r + 0.7151522 * g + 0.0721750 * b,
        (0.0193339 * r + 0.1191920 * g + 0.9503041 * b) / 1.08883,
    ];
    let [x, y, z] = xyz.map(|t| {
        let knee: f64 = 6.0 / 29.0;
        if t > knee.powi(3) { t.cbrt() } else { t / (3.0 * knee * knee) + 4.0 / 29.0 }
    });
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// The colours of an 8-bit picture.
fn steps(count: usize) -> Vec<[f32; 3]> {
    (0..=count).map(|i| map_colour(i as f32 / count as f32).map(|v| (v * 255.0).round() / 255.0)).collect()
}

#[test]
fn lightness_rises_evenly_from_end_to_end() {
    let lightness: Vec<f64> = steps(64).into_iter().map(|c| lab(c)[0]).collect();
    let even = (lightness[64] - lightness[0]) / 64.0;
    assert!(even * 64.0 > 60.0, "from {} to {}", lightness[0], lightness[64]);
    for pair in lightness.windows(2) {
        let step = pair[1] - pair[0];
        assert!((step - even).abs() < 0.5, "a step of {step}, the mean is {even}");
    }
}

/// Who lacks the red-green axis still has lightness and the blue-yellow axis: both rise, so no two colours are alike.
#[test]
fn without_red_and_green_the_order_remains() {
    let seen: Vec<[f64; 2]> = steps(64).into_iter().map(lab).map(|[l, _, b]| [l, b]).collect();
    for pair in seen.windows(2) {
        assert!(pair[1][0] > pair[0][0] && pair[1][1] > pair[0][1], "{pair:?}");
        let apart = (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
        assert!(apart > 1.0, "{apart}");
    }
}

/// Nothing was cut off to fit: a channel that is at its limit for a while would show.
#[test]
fn no_channel_leaves_its_range() {
    let at_limit = |c: usize| steps(200).iter().filter(|colour| colour[c] <= 0.0 || colour[c] >= 1.0).count();
    assert_eq!([0, 1, 2].map(at_limit), [0, 0, 0]);
    assert_eq!(map_colour(-1.0), map_colour(0.0));
    assert_eq!(map_colour(7.0), map_colour(1.0));
}

/// In the palette too, colours of one brightness are in order of lightness.
#[test]
fn palettes_hold_at_most_256_colours_and_cover_the_scale() {
    let even = Shading { ambient: 1.0, ..Shading::default() };
    for look in [Look::Smooth, Look::SmoothWireframe] {
        for shading in [Shading::default(), even] {
            let palette = Palette::of_numbers(&shading, look);
            assert_eq!(palette.colours().len(), 256);
            assert_eq!(palette.colours()[0], [1, 130, 129]);
        }
        // Brightness 1: every colour of the scale has an entry that looks like it.
        let palette = Palette::of_numbers(&even, look);
        for colour in steps(100) {
            let wanted = lab(colour);
            let off = |entry: &[u8; 3]| {
                let found = lab(entry.map(|v| f32::from(v) / 255.0));
                (0..3).map(|i| (found[i] - wanted[i]).powi(2)).sum::<f64>().sqrt()
            };
            let nearest = palette.colours().iter().map(off).fold(f64::MAX, f64::min);
            assert!(nearest < 6.0, "{look:?}: {colour:?} is off by {nearest}");
        }
    }
}
