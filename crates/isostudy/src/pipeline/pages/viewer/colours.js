// Colours for numbers, and the scale they are read on: the same as in the study's figures (crates/isostudy-raster/src/colour_map.rs).

const DARK = [24, 28, -52];
const BRIGHT = [90, -8, 70];
const BOW = 30;
const KNEE = 6 / 29;

/** The colour at a place from 0 (dark blue) to 1 (bright yellow); red, green, blue in 0..1. */
export function mapColour(place) {
  const t = Math.min(Math.max(place, 0), 1);
  const [l, a, b] = DARK.map((dark, i) => dark + (BRIGHT[i] - dark) * t);
  return srgb([l, a + 4 * BOW * t * (1 - t), b]);
}

/** CIELAB (D65, 2 degrees) to sRGB. */
function srgb([l, a, b]) {
  const uncube = (f) => (f > KNEE ? f ** 3 : 3 * KNEE * KNEE * (f - 4 / 29));
  const y = (l + 16) / 116;
  const [X, Y, Z] = [0.95047 * uncube(y + a / 500), uncube(y), 1.08883 * uncube(y - b / 200)];
  return [
    3.2404542 * X - 1.5371385 * Y - 0.4985314 * Z,
    -0.969266 * X + 1.8760108 * Y + 0.041556 * Z,
    0.0556434 * X - 0.2040259 * Y + 1.0572252 * Z,
  ].map((v) => Math.min(Math.max(v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055, 0), 1));
}

/** 256 colours, four bytes each. */
export function mapBytes() {
  const bytes = new Uint8Array(4 * 256);
  for (let i = 0; i < 256; i += 1) bytes.set([...mapColour(i / 255).map((v) => Math.round(255 * v)), 255], 4 * i);
  return bytes;
}

/** The smallest of 1, 2, 5 times a power of ten that is no less. */
export function roundUp(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return [1, 2, 5, 10].map((of) => of * power).find((of) => of >= value * (1 - 1e-9));
}

/** A number in few letters. */
export function short(value) {
  if (value === null || value === undefined || Number.isNaN(value)) return 'not known';
  if (Number.isInteger(value)) return value.toLocaleString('en');
  const size = Math.abs(value);
  return size < 1e-4 ? value.toExponential(1) : String(Number(value.toPrecision(3)));
}

/** Fills the legend for a mode whose scale ends at `most`. */
export function showLegend(legend, of, most) {
  legend.hidden = !of.values;
  if (!of.values) return;
  const [dark, bright] = of.good === 'large' ? [0, most] : [most, 0];
  const stops = Array.from({ length: 17 }, (_, i) => `rgb(${mapColour(i / 16).map((v) => Math.round(255 * v)).join(' ')})`);
  const unit = of.unit ?? '';
  const end = of.good === 'large' ? `${short(most)}${unit} (good)` : `${short(most)}${unit} or more`;
  const start = `0${unit} (${of.nought ?? (of.good === 'large' ? 'bad' : 'good')})`;
  legend.querySelector('.title').textContent = of.says[0].toUpperCase() + of.says.slice(1);
  // From 0 on the left, whichever end is bright.
  legend.querySelector('.scale').style.background = `linear-gradient(to right, ${(dark === 0 ? stops : stops.reverse()).join(', ')})`;
  const marks = most > 0 ? [start, `${short(most / 2)}${unit}`, end] : [`0${unit} everywhere`];
  legend.querySelector('.marks').replaceChildren(...marks.map((text) => {
    const mark = document.createElement('span');
    mark.textContent = text;
    return mark;
  }));
  legend.dataset.most = most;
  legend.dataset.bright = bright;
  legend.querySelector('.note').textContent = of.values === 'quality'
    ? 'Twice the inscribed over the circumscribed radius; 1 is equilateral. Both sides have one scale.'
    : `Both sides have one scale${of.unit ? '' : ', in the length unit of the study'}. Grey: no number is known.`;
}
