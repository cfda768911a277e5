// The viewer: what is chosen, and what follows from it.

import { REVISION } from 'three';
import { roundUp, short, showLegend } from 'viewer/colours.js';
import { difference } from 'viewer/difference.js';
import { listKeys, onKeys } from 'viewer/keys.js';
import * as link from 'viewer/link.js';
import { MODES, mode } from 'viewer/modes.js';
import { showNumbers } from 'viewer/numbers.js';
import { Views } from 'viewer/scene.js';
import { quality, surface } from 'viewer/surface.js';

/** The share of triangles that a scale reaches, so that a few far ones do not take all colours. */
const REACHED = 0.98;
/** How many words of a long list a line names: all meshes of a large study would fill a phone's first screen. */
const NAMED = 6;
/** A list of up to so many is named whole, as that of the modes is. */
const SHORT = 10;

const catalogue = JSON.parse(document.getElementById('catalogue').textContent);
const SIDES = ['left', 'right'];
const [stage, said, legend] = ['.stage', '.said', '.legend'].map((of) => document.querySelector(of));
const canvas = stage.querySelector('canvas');
const selects = SIDES.map((side) => document.getElementById(side));
const panes = SIDES.map((side) => document.getElementById(`${side}-view`));
const slider = document.getElementById('resolution');
const sliderSaid = document.getElementById('resolution-said');
const keys = document.getElementById('keys');
const address = document.getElementById('address');
// From coarse to fine, as the slider runs.
const factors = [...catalogue.factors].reverse();

const meshes = new Map(catalogue.meshes.map((of) => [of.id, of]));
const object = (id) => catalogue.objects.find((of) => of.id === meshes.get(id).object);
const level = (id, factor) => meshes.get(id).levels.find((of) => of.factor === factor);

const shown = initial();
/** Counts what was asked for, so that what comes late is dropped. */
let turn = 0;
/** The object that the camera was last put in front of. */
let lookedAt = null;

let views = null;
try {
  views = new Views(canvas, panes, catalogue);
} catch (error) {
  canvas.hidden = true;
  for (const pane of panes) tell(pane, 'This browser shows no meshes: WebGL 2 is missing or switched off. The numbers are beside.');
}

/** The pair that the catalogue opens on, else the first two meshes of an object; at the resolution of the animations. */
function initial() {
  const [left, right] = catalogue.opening ?? [];
  const first = meshes.get(left) ?? catalogue.meshes.find((of) => of.object === catalogue.first) ?? catalogue.meshes[0];
  const second = meshes.get(right) ?? catalogue.meshes.find((of) => of.object === first.object && of.id !== first.id) ?? first;
  const nearest = factors.reduce((a, b) => (Math.abs(Math.log(b)) < Math.abs(Math.log(a)) ? b : a));
  return { left: first.id, right: second.id, mode: 'wires', factor: nearest };
}

/** The words of a list; of a long one the first, and how many more there are. */
function firstOf(words) {
  if (words.length <= SHORT) return words.join(', ');
  return `${words.slice(0, NAMED).join(', ')} and ${words.length - NAMED} more`;
}

/** Takes what the address says, as far as it is known, and says what is not. */
function follow() {
  const asked = link.read();
  const known = {
    left: [...meshes.keys()],
    right: [...meshes.keys()],
    mode: MODES.map(({ id }) => id),
    factor: factors.map(String),
  };
  const wrong = [];
  for (const [key, value] of Object.entries(asked)) {
    if (!known[key]) wrong.push(`The address has “${key}”, which this page does not know. It knows ${Object.keys(known).join(', ')}.`);
    else if (known[key].includes(value)) shown[key] = key === 'factor' ? Number(value) : value;
    else wrong.push(`The address asks for ${key}=${value}, which this page does not have. It has ${firstOf(known[key])}.`);
  }
  address.hidden = wrong.length === 0;
  address.replaceChildren(...wrong.map((text) => Object.assign(document.createElement('p'), { textContent: text })));
}

function tell(pane, text) {
  const line = pane.querySelector('.missing');
  line.hidden = !text;
  line.textContent = text ?? '';
}

/** Shows what is chosen. */
async function show() {
  turn += 1;
  const mine = turn;
  const current = () => mine === turn;
  stage.setAttribute('aria-busy', 'true');
  link.write(shown);
  controlsShow();
  const levels = SIDES.map((side) => level(shown[side], shown.factor));
  const numbers = levels.map((of) => of.numbers && { spacing: of.spacing, ...of.numbers });
  showNumbers(document.querySelector('.numbers tbody'), numbers);
  const chosen = mode(shown.mode);
  if (!views) {
    legend.hidden = true;
    finish('');
    return;
  }
  levels.forEach((of, i) => tell(panes[i], of.file === null ? `No mesh at spacing ${short(of.spacing)}: ${of.missing}.` : null));
  const surfaces = await Promise.all(levels.map((of) => (of.file === null ? null : surface(of.file))));
  if (!current()) return;
  let lists;
  if (chosen.values === 'difference') {
    said.textContent = 'Computing the difference.';
    const [left, right] = surfaces;
    lists = [null, null];
    if (left && right) {
      lists = [await difference(left, right, current), await difference(right, left, current)];
      if (!current()) return;
      lists.forEach((list, i) => { numbers[i].difference_max = list.reduce((a, b) => Math.max(a, b), 0); });
      showNumbers(document.querySelector('.numbers tbody'), numbers);
    }
  } else {
    lists = surfaces.map((of) => of && valuesOf(of, chosen.values));
  }
  const most = chosen.most ?? scaleEnd(lists);
  showLegend(legend, chosen, most);
  surfaces.forEach((of, i) => {
    views.put(i, of);
    views.colour(i, chosen, lists[i], most);
  });
  if (lookedAt !== object(shown.left)) reset();
  views.draw();
  const compared = chosen.values === 'difference' && !surfaces.every(Boolean);
  finish(compared ? 'There is no difference to show, since one mesh is missing.' : '');
}

function finish(text) {
  said.textContent = text;
  stage.dataset.shown = [shown.left, shown.right, shown.mode, shown.factor].join(' ');
  stage.setAttribute('aria-busy', 'false');
}

function valuesOf(of, values) {
  if (values === 'quality') of.quality ??= quality(of);
  return values ? of[values] : null;
}

/** Where the scale of both lists ends. */
function scaleEnd(lists) {
  const ends = lists.filter(Boolean).map((list) => {
    const sorted = list.filter((value) => !Number.isNaN(value)).sort();
    return sorted[Math.floor(REACHED * (sorted.length - 1))] ?? 0;
  });
  const end = Math.max(0, ...ends);
  return end > 0 ? roundUp(end) : 0;
}

/** Sets the controls to what is chosen. */
function controlsShow() {
  SIDES.forEach((side, i) => { selects[i].value = shown[side]; });
  document.querySelector(`.modes input[value="${shown.mode}"]`).checked = true;
  slider.value = factors.indexOf(shown.factor);
  const what = shown.factor === 1 ? 'spacing of the animations' : `${shown.factor} times the spacing of the animations`;
  sliderSaid.title = what;
  sliderSaid.textContent = shown.factor === 1 ? 'as animated' : `${shown.factor} × spacing`;
  slider.setAttribute('aria-valuetext', what);
}

function choose(changes) {
  Object.assign(shown, changes);
  show().catch(report);
}

function report(error) {
  finish(`The meshes could not be shown: ${error.message}`);
  throw error;
}

function reset() {
  lookedAt = object(shown.left);
  views?.look(lookedAt);
}

function toggleHelp() {
  if (keys.open) keys.close();
  else keys.showModal();
}

function chooseFiner(steps) {
  const place = factors.indexOf(shown.factor) + steps;
  if (factors[place] !== undefined) choose({ factor: factors[place] });
}

// The controls.
for (const select of selects) {
  for (const of of catalogue.objects) {
    const group = document.createElement('optgroup');
    group.label = of.name;
    for (const { id, label } of catalogue.meshes.filter((mesh) => mesh.object === of.id)) {
      group.append(new Option(`${of.name}: ${label}`, id));
    }
    if (group.children.length) select.append(group);
  }
}
selects[0].addEventListener('change', () => {
  const left = selects[0].value;
  const { object: to } = meshes.get(left);
  const right = meshes.get(shown.right);
  // The right side follows to another object, by the same method if it has it.
  const same = catalogue.meshes.find((of) => of.object === to && of.label === right.label);
  choose(right.object === to || !same ? { left } : { left, right: same.id });
});
selects[1].addEventListener('change', () => choose({ right: selects[1].value }));
for (const { id, label, says } of MODES) {
  const input = Object.assign(document.createElement('input'), { type: 'radio', name: 'mode', value: id });
  input.addEventListener('change', () => choose({ mode: id }));
  const text = Object.assign(document.createElement('span'), { textContent: label, title: says });
  const item = document.createElement('label');
  item.append(input, text);
  document.querySelector('.modes').append(item);
}
slider.max = factors.length - 1;
slider.disabled = factors.length < 2;
slider.addEventListener('input', () => choose({ factor: factors[Number(slider.value)] }));
document.getElementById('reset').addEventListener('click', reset);
document.getElementById('help').addEventListener('click', toggleHelp);
document.getElementById('close-keys').addEventListener('click', toggleHelp);
document.querySelector('.choices').addEventListener('submit', (event) => event.preventDefault());
listKeys(keys.querySelector('dl'));
onKeys({
  turn: (right, up) => views?.turn(right, up),
  nearer: (steps) => views?.nearer(steps),
  mode: (place) => choose({ mode: MODES[place].id }),
  finer: chooseFiner,
  reset,
  help: toggleHelp,
});
window.addEventListener('hashchange', () => {
  follow();
  choose({});
});
document.querySelector('.revision').textContent = ` (release ${REVISION})`;
for (const [id, why] of catalogue.left_out) {
  document.querySelector('.left-out').append(Object.assign(document.createElement('li'), { textContent: `${id} was left out: ${why}` }));
}

follow();
show().catch(report);
