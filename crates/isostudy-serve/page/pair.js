// A pair on the screen, or as many surfaces as are shown at once: all of one file, in rows, as large as there is room.
'use strict';

/**
 * Puts a pair into `box`. `file` is { kind, frames, address }; both halves come from one moving picture, so that they cannot drift
 * apart: two windows on an animation (of one address, which browsers run on one clock), or two copies of each frame of a video.
 * Models have { kind, bytes }: both are drawn by one camera, which the participant turns, and copied like the frames of a video.
 *
 * Resolves when its first frame can be seen. `changed` is called when it is laid out anew; `events` are those of models (turning.js).
 */
window.isostudyPair = async (study, text, file, box, make, changed, events) => {
  const FRAME_MS = study.loop_ms / file.frames;
  const [WIDTH, HEIGHT] = study.surface.map((pixels) => pixels * study.page_scale);
  // After so long a video whose bytes are all here is taken not to play.
  const NO_FRAME_MS = 5000;
  const isModel = file.kind === 'model';
  // Two have sides; others have numbers.
  const COUNT = { ratings: 1, 'best-of-3': 3, 'best-of-4': 4 }[study.way] ?? 2;
  const PAIR = COUNT === 2;
  const NUMBERED = COUNT > 2 ? ['first', 'second', 'third', 'fourth'].slice(0, COUNT) : [];
  const NAMES = PAIR ? [text('upper'), text('lower')] : NUMBERED.map((key) => text(key));
  const SAID = {
    turning: ['left_turning', 'right_turning', 'number_turning'],
    stopped: ['left_stopped', 'right_stopped', 'number_stopped'],
    surface: ['left_surface', 'right_surface', 'number_surface'],
  };
  const said = (i, what) => text(SAID[what][PAIR ? i : 2], { number: i + 1 });
  const isPicture = ['gif', 'png'].includes(file.kind);
  const video = isPicture || isModel ? null : make('video', { muted: true, loop: true, playsInline: true, preload: 'auto', className: 'source', 'aria-hidden': 'true' });

  const halves = Array.from({ length: COUNT }, (_, i) => {
    const moving = video || isModel ? null : make('img', { alt: said(i, file.frames === 1 ? 'surface' : 'turning'), draggable: false, hidden: true });
    if (moving) [moving.style.width, moving.style.left] = [`${100 * COUNT}%`, `${-100 * i}%`];
    const still = make('canvas', { role: 'img', 'aria-label': said(i, isPicture && file.frames > 1 ? 'stopped' : 'surface') });
    const name = make('span', { className: 'name', 'aria-hidden': 'true' }, NAMES[i] ?? '');
    return { moving, still, element: make('div', { className: 'half' }, ...(moving ? [moving] : []), still, name) };
  });

  function loaded(element, event) {
    return new Promise((resolve, reject) => {
      element.addEventListener(event, resolve, { once: true });
      element.addEventListener('error', () => reject(new Error('cannot be shown')), { once: true });
      element.src = file.address;
    });
  }

  /** Some browsers have no frame of a video before it was played. */
  async function firstFrame() {
    if (video.readyState >= 2) return;
    const there = new Promise((resolve) => { video.addEventListener('loadeddata', resolve, { once: true }); });
    const never = new Promise((_, reject) => { setTimeout(() => reject(new Error('no frame')), NO_FRAME_MS); });
    setTimeout(() => { if (video.readyState < 2) video.play().then(() => video.pause(), () => {}); }, NO_FRAME_MS / 10);
    await Promise.race([there, never]);
  }

  /** Copies what `source` shows now, a part each. */
  function draw(source, all, height) {
    const width = all / COUNT;
    halves.forEach(({ still }, i) => {
      if (still.width !== width || still.height !== height) [still.width, still.height] = [width, height];
      still.getContext('2d').drawImage(source, i * width, 0, width, height, 0, 0, width, height);
    });
  }

  // The size of each surface on the screen, in CSS pixels.
  let [surface, high] = [0, 0];
  let waits = false;
  /** Draws models at the next frame, once. */
  function redraw() {
    if (waits || surface === 0) return;
    waits = true;
    requestAnimationFrame(() => {
      waits = false;
      drawModels();
    });
  }
  function drawModels() {
    const ratio = Math.min(window.devicePixelRatio, 2);
    const [wide, tall] = [surface, high].map((pixels) => Math.max(1, Math.round(pixels * ratio)));
    model.draw(wide, tall);
    draw(model.canvas, 2 * wide, tall);
  }

  const { turnable } = isModel ? await import('./turning.js') : {};
  const model = isModel ? turnable(file.bytes, study.shading, box, redraw, events) : null;
  if (isModel) {
    box.setAttribute('role', 'group');
    box.setAttribute('aria-label', text('turn_pair'));
  }
  box.classList.toggle('enlarged', study.page_scale > 1 && !isModel);
  box.classList.toggle('several', !PAIR);
  box.classList.toggle('named', COUNT > 2);
  box.replaceChildren(...halves.map((half) => half.element), ...(video ? [video] : []));
  if (video) {
    await loaded(video, 'loadedmetadata');
    await firstFrame();
    draw(video, video.videoWidth, video.videoHeight);
  } else if (!isModel) {
    await Promise.all(halves.map((half) => loaded(half.moving, 'load')));
    const { moving } = halves[0];
    draw(moving, moving.naturalWidth, moving.naturalHeight);
  }

  let stacked = false;
  let largest = 0;
  let needed = 0;

  // Up to twice as large as they were made, smoothly; who says page_scale wants square pixels of that size, and no others.
  const MOST = study.page_scale > 1 ? 1 : 2;

  /** Lays both halves out, whichever way makes them larger; larger than MOST only if the window is theirs but for the answers. */
  function layout() {
    const whole = box.classList.contains('large');
    box.style.maxHeight = '';
    const [width, height] = [box.clientWidth, box.clientHeight];
    const most = whole ? Infinity : MOST;
    // In as many columns as make them largest; of equals the more.
    const scales = Array.from({ length: COUNT }, (_, less) => {
      const columns = COUNT - less;
      const rows = Math.ceil(COUNT / columns);
      return { columns, rows, scale: Math.min((width / columns - (PAIR ? 0 : 4)) / WIDTH, (height - 4 * (rows - 1)) / rows / HEIGHT, most) };
    });
    const { columns, rows, scale } = scales.reduce((best, one) => (one.scale > best.scale ? one : best));
    stacked = rows > 1;
    const [w, h] = [Math.max(Math.floor(WIDTH * scale), 0), Math.max(Math.floor(HEIGHT * scale), 0)];
    for (const { element } of halves) [element.style.width, element.style.height] = [`${w}px`, `${h}px`];
    box.classList.toggle('stacked', stacked && PAIR);
    if (!PAIR) box.style.gridTemplateColumns = `repeat(${columns}, ${w}px)`;
    needed = rows * h + 4 * (rows - 1);
    if (!whole) box.style.maxHeight = `${needed}px`;
    const was = surface;
    [surface, high] = [w, h];
    if (was !== w) changed(w);
    // At once, since a canvas without a picture would be seen.
    if (model && w > 0) drawModels();
    largest = Math.max(largest, w);
  }
  // What is said below may need another line.
  const squeezed = new ResizeObserver(() => { if (box.clientHeight < needed) layout(); });
  squeezed.observe(box);
  window.addEventListener('resize', layout);
  layout();

  // Frames that nobody can have seen: while moving, the browser drew nothing for more than the time of one.
  let dropped = 0;
  let drawn = null;
  let running = false;
  function tick(now) {
    if (!running) return;
    if (drawn !== null) dropped += Math.max(0, Math.floor((now - drawn) / FRAME_MS) - 1);
    drawn = now;
    if (video && video.readyState >= 2) draw(video, video.videoWidth, video.videoHeight);
    requestAnimationFrame(tick);
  }

  return {
    layout,
    /** Models: how to reset them, and from where they were looked at since a time. */
    model,
    /** Lets it turn. Rejects where the browser does not let it. */
    async play() {
      if (video) await video.play();
      if (isModel) return;
      running = true;
      drawn = null;
      for (const { moving, still } of halves) if (moving) [moving.hidden, still.hidden] = [false, true];
      requestAnimationFrame(tick);
    },
    stop() {
      running = false;
      video?.pause();
      for (const { moving, still } of halves) if (moving) [moving.hidden, still.hidden] = [true, false];
    },
    /** What is kept with an answer: how it was shown. */
    shown: () => ({
      surface_px: largest,
      layout: stacked ? 'stacked' : 'beside',
      dropped: Math.max(dropped, video?.getVideoPlaybackQuality?.().droppedVideoFrames ?? 0),
      shown_as: file.kind,
      ...(model && { turned_deg: model.turnedDeg() }),
    }),
    leave() {
      running = false;
      if (model) {
        model.leave();
        box.removeAttribute('role');
        box.removeAttribute('aria-label');
      }
      video?.pause();
      squeezed.disconnect();
      window.removeEventListener('resize', layout);
    },
  };
};
