//! Colours for numbers: dark to bright.

/// Lightness, green to red, blue to yellow (CIELAB, D65) at the dark end: blue.
const DARK: [f64; 3] = [24.0, 28.0, -52.0];
/// The same at the bright end: yellow.
const BRIGHT: [f64; 3] = [90.0, -8.0, 70.0];
/// How far the middle lies towards red: away from the teal that turntables have behind them, and from grey.
const BOW: f64 = 30.0;

/// The colour at `place`, from 0 (dark blue) over purple and salmon to 1 (bright yellow); what lies beyond has the
/// colour of the end. Red, green, blue in 0..1 (sRGB).
///
/// `lab(t) = dark + (bright - dark) t`, with `4 bow t (1 - t)` added to a*: lightness and the blue-yellow axis both
/// rise evenly, so the order of colours is seen by the colour-blind (the red-green axis may be missing) and in print
/// without colour. That a map should be even in both is from Nuñez, Anderton and Renslow (2018), "Optimizing
/// colormaps with consideration for color vision deficiency", PLoS ONE 13(7); the numbers are ours. CIELAB to sRGB is
/// by CIE 15 and IEC 61966-2-1. Every colour on the way can be shown.
pub fn map_colour(place: f32) -> [f32; 3] {
    let t = f64::from(place.clamp(0.0, 1.0));
    let [l, a, b] = [0, 1, 2].map(|i| DARK[i] + (BRIGHT[i] - DARK[i]) * t);
    srgb([l, a + 4.0 * BOW * t * (1.0 - t), b]).map(|v| v as f32)
}

/// CIELAB (D65, 2 degrees) to sRGB.
fn srgb([l, a, b]: [f64; 3]) -> [f64; 3] {
    const KNEE: f64 = 6.0 / 29.0;
    let uncube = |f: f64| if f > KNEE { f * f * f } else { 3.0 * KNEE * KNEE * (f - 4.0 / 29.0) };
    let y = (l + 16.0) / 116.0;
    let [x, y, z] = [0.95047 * uncube(y + a / 500.0), uncube(y), 1.08883 * uncube(y - b / 200.0)];
    let linear = [
        3.2404542 * x - 1.5371385 * y - 0.4985314 * z,
        -0.9692660 * x + 1.8760108 * y + 0.0415560 * z,
        0.0556434 * x - 0.2040259 * y + 1.0572252 * z,
    ];
    // Not the platform's power: the same bytes on every machine.
    linear.map(|v| {
        if v <= 0.0031308 { 12.92 * v } else { 1.055 * libm::pow(v, 1.0 / 2.4) - 0.055 }.clamp(0.0, 1.0)
    })
}
