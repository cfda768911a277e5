// The researcher's replay: both models of a question, seen from the cameras of one participant at their times.
'use strict';

(() => {
  const study = window.ISOSTUDY;
  const $ = (id) => document.getElementById(id);
  const say = (text) => { $('status').textContent = text; };
  const COLUMNS = ['participant', 'order', 'question', 'stimulus', 't_ms', 'azimuth_deg', 'elevation_deg', 'distance'];
  const [WIDTH, HEIGHT] = study.surface;

  // Cameras by participant and place, in the order of the file.
  let people = new Map();
  // What is on the screen: the models, their cameras, and the time in milliseconds.
  let shown = null;
  let at = 0;
  let playing = null;

  /** The rows of a file; a spreadsheet's quotes are none of its own. */
  function parse(text) {
    const [header, ...lines] = text.replace(/^\uFEFF/, '').trim().split(/\r?\n/).map((line) => line.split(',').map((cell) => cell.replace(/^"(.*)"$/, '$1')));
    const missing = COLUMNS.filter((name) => !header.includes(name));
    if (missing.length > 0) throw new Error(`The file has no column ${missing.join(', ')}. It has ${header.join(', ')}.`);
    const found = new Map();
    const place = Object.fromEntries(COLUMNS.map((name) => [name, header.indexOf(name)]));
    for (const cells of lines) {
      const of = (name) => cells[place[name]];
      if (!found.has(of('participant'))) found.set(of('participant'), new Map());
      const answers = found.get(of('participant'));
      if (!answers.has(of('order'))) answers.set(of('order'), { question: of('question'), stimulus: of('stimulus'), cameras: [] });
      const [time, azimuth, elevation, distance] = ['t_ms', 'azimuth_deg', 'elevation_deg', 'distance'].map((name) => Number(of(name)));
      answers.get(of('order')).cameras.push({ time, azimuth: (azimuth * Math.PI) / 180, elevation: (elevation * Math.PI) / 180, distance });
    }
    return found;
  }

  function options(select, entries) {
    select.replaceChildren(...entries.map(([value, text]) => Object.assign(document.createElement('option'), { value, textContent: text })));
  }

  /** The last camera that had been noted at a time. */
  function camera() {
    const { cameras } = shown;
    let last = 0;
    while (last + 1 < cameras.length && cameras[last + 1].time <= at) last += 1;
    return [cameras[last], last];
  }

  function draw() {
    const [seen, number] = camera();
    const { view, halves } = shown;
    const ratio = Math.min(window.devicePixelRatio, 2);
    const wide = Math.round(halves[0].clientWidth * ratio);
    const tall = Math.round((wide * HEIGHT) / WIDTH);
    view.draw({ ...seen, distance: seen.distance * view.start.distance }, wide, tall);
    halves.forEach((half, i) => {
      const canvas = half.firstElementChild;
      [canvas.width, canvas.height] = [wide, tall];
      canvas.getContext('2d').drawImage(view.canvas, i * wide, 0, wide, tall, 0, 0, wide, tall);
    });
    $('time').value = at;
    const degrees = (angle) => `${((angle * 180) / Math.PI).toFixed(1)}°`;
    $('said').textContent = `${(at / 1000).toFixed(2)} s, azimuth ${degrees(seen.azimuth)}, elevation ${degrees(seen.elevation)}, distance ${seen.distance.toFixed(3)}`;
    document.querySelector('.pair').dataset.frame = number;
  }

  function stop() {
    playing = null;
    $('play').textContent = 'Play';
  }

  function play() {
    const end = Number($('time').max);
    const from = at >= end ? 0 : at;
    const since = performance.now();
    const mine = {};
    playing = mine;
    $('play').textContent = 'Pause';
    const step = (now) => {
      if (playing !== mine) return;
      at = Math.min(from + Math.max(0, now - since), end);
      draw();
      if (at >= end) stop(); else requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }

  async function choose() {
    stop();
    const answer = people.get($('participant').value)?.get($('question').value);
    if (!answer) return;
    say('Loading the models.');
    try {
      const response = await fetch(`stimuli/${encodeURIComponent(answer.stimulus)}.glb`);
      if (!response.ok) throw new Error(`the study served here has no models ${answer.stimulus}`);
      const { views } = await import('./model.js');
      const view = views(await response.arrayBuffer(), study.shading, () => say('The browser has stopped drawing. Please load the page again.'));
      shown?.view.leave();
      $('replay').hidden = false;
      const halves = [...document.querySelectorAll('.half')];
      const width = Math.min(WIDTH, Math.floor((document.querySelector('main').clientWidth - 40) / 2));
      for (const half of halves) [half.style.width, half.style.height] = [`${width}px`, `${Math.round((width * HEIGHT) / WIDTH)}px`];
      shown = { view, halves, cameras: answer.cameras };
      at = 0;
      $('time').max = answer.cameras.at(-1).time;
      draw();
      say(`${answer.cameras.length} cameras in ${(answer.cameras.at(-1).time / 1000).toFixed(1)} s.`);
    } catch (error) {
      $('replay').hidden = true;
      say(`The models cannot be shown: ${error.message}.`);
    }
  }

  function person() {
    options($('question'), [...people.get($('participant').value)].map(([order, { question }]) => [order, question ? `${order}: ${question}` : order]));
    choose();
  }

  $('file').addEventListener('change', async () => {
    const [file] = $('file').files;
    if (!file) return;
    try {
      people = parse(await file.text());
      if (people.size === 0) throw new Error('The file has no cameras: nobody was shown models, or nobody has answered.');
      options($('participant'), [...people.keys()].map((name) => [name, name]));
      $('choice').hidden = false;
      person();
    } catch (error) {
      $('choice').hidden = true;
      say(error.message);
    }
  });
  $('participant').addEventListener('change', person);
  $('question').addEventListener('change', choose);
  $('play').addEventListener('click', () => { if (playing) stop(); else play(); });
  $('time').addEventListener('input', () => {
    stop();
    at = Number($('time').value);
    draw();
  });
})();
