// Models that a participant turns, both as one: by mouse, fingers and keys. From where they were looked at is noted.

import { direction, views } from './model.js';

/** Radians that an arrow key turns. */
const TURN = Math.PI / 24;
/** What one press of + or - divides or multiplies the distance by. */
const STEP = 1.15;
/** Nearest and farthest, as multiples of the first distance. */
const NEAREST = 0.4;
const FARTHEST = 2.5;
/** Nearly straight from above or below. */
const STEEPEST = (89 * Math.PI) / 180;
/** Pixels after which a press is no tap. */
const TAP = 6;
/** Most cameras per second, and most bytes of an answer's as JSON, counted after so many: the server takes 200,000. */
const MOST_HZ = 20;
const MOST_BYTES = 180000;
const COUNTED = 500;

const between = (low, value, high) => Math.min(Math.max(value, low), high);
const tenths = (angle) => Math.round((angle * 1800) / Math.PI);

/** From where models are looked at over time; less often where it would be too much. */
function log(camera) {
  let hz = MOST_HZ;
  let noted = [];
  let last = -Infinity;
  const add = (now) => {
    const { azimuth, elevation, distance, first } = camera;
    noted.push([Math.round(now), tenths(azimuth), tenths(elevation), Math.round((1000 * distance) / first)]);
    last = now;
    if (noted.length % COUNTED === 0 && JSON.stringify(noted).length > MOST_BYTES) {
      // The first and the last one stay.
      noted = noted.filter((_, i) => i % 2 === 0 || i === noted.length - 1);
      hz /= 2;
    }
  };
  let late = 0;
  add(-Infinity);
  return {
    changed() {
      const now = performance.now();
      clearTimeout(late);
      if (now - last >= 1000 / hz) add(now);
      // Where it stands still is noted too.
      else late = setTimeout(() => add(performance.now()), last + 1000 / hz - now);
    },
    /** All, in milliseconds since `since`. */
    track(since) {
      const now = performance.now();
      clearTimeout(late);
      const at = noted[noted.length - 1].slice(1);
      const { azimuth, elevation, distance, first } = camera;
      const stands = [tenths(azimuth), tenths(elevation), Math.round((1000 * distance) / first)];
      const all = stands.every((value, i) => value === at[i]) ? noted : [...noted, [now, ...stands]];
      return { hz, cameras: all.flatMap(([time, ...rest]) => [Math.max(0, Math.round(time - since)), ...rest]) };
    },
    leave: () => clearTimeout(late),
  };
}

/**
 * Both models of a pair in `box`, which gets their pointers and keys. `redraw` is called when they are to be drawn again, `events.turned`
 * with the degrees by which they were turned so far, `events.lost` when the browser draws them no longer.
 */
export function turnable(bytes, shading, box, redraw, events) {
  const view = views(bytes, shading, events.lost);
  const { azimuth, elevation, distance } = view.start;
  const camera = { azimuth, elevation, distance, first: distance };
  const noted = log(camera);
  let turned = 0;

  function move(by) {
    const before = direction(camera);
    camera.azimuth += by.azimuth ?? 0;
    camera.elevation = between(-STEEPEST, camera.elevation + (by.elevation ?? 0), STEEPEST);
    camera.distance = between(NEAREST * distance, camera.distance * (by.distance ?? 1), FARTHEST * distance);
    turned += before.angleTo(direction(camera));
    noted.changed();
    redraw();
    events.turned((turned * 180) / Math.PI);
  }

  function reset() {
    Object.assign(camera, { azimuth, elevation, distance });
    noted.changed();
    redraw();
  }

  // One finger or the mouse turns, two fingers come nearer.
  const fingers = new Map();
  let moved = 0;
  const apart = () => {
    const [a, b] = [...fingers.values()];
    return Math.hypot(a[0] - b[0], a[1] - b[1]);
  };
  const onDown = (event) => {
    if (event.button !== 0 || event.target.closest('button')) return;
    if (fingers.size === 0) moved = 0;
    fingers.set(event.pointerId, [event.clientX, event.clientY]);
    box.setPointerCapture(event.pointerId);
  };
  const onMove = (event) => {
    const from = fingers.get(event.pointerId);
    if (!from) return;
    const [x, y] = [event.clientX - from[0], event.clientY - from[1]];
    const was = fingers.size === 2 ? apart() : 0;
    moved += Math.hypot(x, y);
    fingers.set(event.pointerId, [event.clientX, event.clientY]);
    if (fingers.size === 2 && was > 0 && apart() > 0) {
      move({ distance: was / apart() });
    } else if (fingers.size === 1 && moved >= TAP) {
      // A half turn for the width of a surface.
      const each = Math.PI / box.querySelector('.half').clientWidth;
      move({ azimuth: -x * each, elevation: y * each });
    }
  };
  const onUp = (event) => fingers.delete(event.pointerId);
  const onWheel = (event) => {
    event.preventDefault();
    if (event.deltaY !== 0) move({ distance: STEP ** Math.sign(event.deltaY) });
  };
  // Whoever turned did not tap.
  const onClick = (event) => { if (moved >= TAP && event.detail > 0 && !event.target.closest('button')) event.stopImmediatePropagation(); };
  const turns = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
  // Arrows answer, but with Shift, and while the pair has the focus.
  const onKey = (event) => {
    if (event.altKey || event.ctrlKey || event.metaKey) return;
    const [across, up] = turns[event.key] ?? [0, 0];
    if (turns[event.key]) {
      if (!event.shiftKey && document.activeElement !== box) return;
      move({ azimuth: across * TURN, elevation: up * TURN });
    } else if (event.key === '+' || event.key === '=') move({ distance: 1 / STEP });
    else if (event.key === '-') move({ distance: STEP });
    else return;
    event.preventDefault();
    event.stopPropagation();
  };
  const own = [['pointerdown', onDown], ['pointermove', onMove], ['pointerup', onUp], ['pointercancel', onUp]];
  for (const [name, heard] of own) box.addEventListener(name, heard);
  box.addEventListener('click', onClick, true);
  box.addEventListener('wheel', onWheel, { passive: false });
  document.addEventListener('keydown', onKey, true);
  box.classList.add('model');
  box.tabIndex = 0;

  return {
    canvas: view.canvas,
    draw: (width, height) => view.draw(camera, width, height),
    reset,
    turnedDeg: () => Math.round((turned * 180) / Math.PI),
    track: noted.track,
    leave() {
      noted.leave();
      view.leave();
      for (const [name, heard] of own) box.removeEventListener(name, heard);
      box.removeEventListener('click', onClick, true);
      box.removeEventListener('wheel', onWheel);
      document.removeEventListener('keydown', onKey, true);
      box.classList.remove('model');
      box.removeAttribute('tabindex');
    },
  };
}
