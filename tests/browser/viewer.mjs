// viewer.html of the quick study in a real browser, from a file: a laptop's window and a phone's, mouse, keyboard and touch.
// Run by scripts/test-browser.sh, which sets ISOSTUDY (the program), CHROMIUM and MODULES; PICTURES is a folder for screenshots.
// Without three.js in cache/three (scripts/fetch-three.sh) nothing is tested, which is said.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import { createRequire } from 'node:module';
import os from 'node:os';
import path from 'node:path';
import test, { after, before } from 'node:test';
import { fileURLToPath, pathToFileURL } from 'node:url';

const { ISOSTUDY, CHROMIUM, MODULES, PICTURES } = process.env;
const require = createRequire(path.join(MODULES, 'package.json'));
const { chromium } = require('playwright-core');
const axe = fs.readFileSync(require.resolve('axe-core/axe.min.js'), 'utf8');

const root = path.resolve(path.dirname(fileURLToPath(import.meta.url)), '../..');
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'isostudy-viewer-'));
const skip = fs.existsSync(path.join(root, 'cache/three/three.module.min.js')) ? false : 'three.js is not in cache/three';
if (skip) console.error(`SKIPPED: ${skip} - the viewer was not tested in a browser`);

const LAPTOP = { width: 1280, height: 720 };
const PHONE = { width: 390, height: 844 };
const MODES = ['smooth', 'creased', 'flat', 'wires', 'quality', 'distance', 'normals', 'difference'];

let browser;
before(async () => {
  if (skip) return;
  const done = spawnSync(ISOSTUDY, ['study', path.join(root, 'configs/quick.toml'), '--out', folder], { encoding: 'utf8' });
  assert.equal(done.status, 0, done.stderr);
  browser = await chromium.launch({
    executablePath: CHROMIUM,
    // WebGL without a graphics card.
    args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync'],
  });
});
after(async () => {
  await browser?.close();
  fs.rmSync(folder, { recursive: true });
});

const shown = (page) => page.locator('.stage').getAttribute('data-shown');

/** Waits until all that was asked for is drawn. */
async function ready(page) {
  await page.waitForFunction(() => document.querySelector('.stage').getAttribute('aria-busy') === 'false');
  await page.evaluate(() => new Promise((resolve) => { requestAnimationFrame(() => requestAnimationFrame(resolve)); }));
}

/** The viewer. Nothing goes wrong on it, and it asks for nothing that it does not hold. */
async function open(viewport, hash = '', options = {}, prepare = undefined) {
  const context = await browser.newContext({ viewport, ...options });
  const page = await context.newPage();
  if (prepare) await page.addInitScript(prepare);
  page.faults = [];
  page.on('pageerror', (error) => page.faults.push(error.message));
  page.on('console', (message) => { if (message.type() === 'error') page.faults.push(message.text()); });
  page.on('request', (request) => {
    const { protocol, pathname } = new URL(request.url());
    if (!['blob:', 'data:'].includes(protocol) && !pathname.endsWith('/viewer.html')) page.faults.push(request.url());
  });
  await page.goto(`${pathToFileURL(path.join(folder, 'viewer.html')).href}${hash}`);
  await ready(page);
  return page;
}

async function close(page) {
  assert.deepEqual(page.faults, []);
  await page.context().close();
}

/** Of each pane: how many pixels are not background, how many colours there are, and the pixels as a text to compare. */
async function panes(page) {
  const found = [];
  for (const id of ['left-view', 'right-view']) {
    const png = await page.locator(`#${id}`).screenshot();
    found.push(await page.evaluate(async (base64) => {
      const picture = await createImageBitmap(await (await fetch(`data:image/png;base64,${base64}`)).blob());
      const canvas = new OffscreenCanvas(picture.width, picture.height);
      const context = canvas.getContext('2d');
      context.drawImage(picture, 0, 0);
      const { data } = context.getImageData(0, 0, picture.width, picture.height);
      // The study's background, as 8 bits.
      const background = [1, 130, 129];
      let surface = 0;
      const colours = new Set();
      let digest = 0;
      // What of the pane's width and height the surface takes, and how near it comes to an edge.
      const [low, high] = [[1, 1], [0, 0]];
      for (let i = 0; i < data.length; i += 4) {
        if (background.some((value, k) => Math.abs(data[i + k] - value) > 2)) {
          surface += 1;
          const at = [((i / 4) % picture.width) / picture.width, Math.floor(i / 4 / picture.width) / picture.height];
          // The rim is of the page, and so are the corners, which are round.
          const away = at.map((of, k) => Math.min(of, 1 - of) * [picture.width, picture.height][k]);
          const isOfPage = Math.min(...away) < 2 || Math.max(...away) < 8;
          for (const k of isOfPage ? [] : [0, 1]) [low[k], high[k]] = [Math.min(low[k], at[k]), Math.max(high[k], at[k])];
        }
        const colour = data[i] << 16 | data[i + 1] << 8 | data[i + 2];
        colours.add(colour);
        digest = (Math.imul(digest, 31) + colour) | 0;
      }
      return { share: surface / (data.length / 4), colours: colours.size, digest, low, high };
    }, png.toString('base64')));
  }
  return found;
}

const digests = async (page) => (await panes(page)).map((of) => of.digest);

/** Rows of one of the study's tables, by configuration, of the animations' meshes. */
function table(name) {
  const [header, ...lines] = fs.readFileSync(path.join(folder, `tables/${name}.csv`), 'utf8').trim().split(/\r?\n/).map((line) => line.split(','));
  const rows = lines.map((cells) => Object.fromEntries(header.map((column, i) => [column, cells[i]])));
  return Object.fromEntries(rows.filter((row) => row.purpose === 'stimulus').map((row) => [row.id, row]));
}

/** The numbers that the page shows. */
const numbers = (page) => page.locator('.numbers tbody tr').evaluateAll((rows) => Object.fromEntries(
  rows.map((row) => [row.dataset.name, [...row.querySelectorAll('td')].map((cell) => (cell.dataset.value === undefined ? cell.textContent : Number(cell.dataset.value)))]),
));

for (const [name, viewport] of [['laptop', LAPTOP], ['phone', PHONE]]) {
  test(`both panes show a surface, and each mode another picture (${name})`, { skip }, async () => {
    const page = await open(viewport, '#left=as_bu&right=as_bi');
    const seen = new Set();
    for (const [i, mode] of MODES.entries()) {
      await page.keyboard.press(String(i + 1));
      await page.waitForFunction((wanted) => document.querySelector('.stage').dataset.shown.includes(` ${wanted} `), mode);
      await ready(page);
      if (PICTURES) await page.screenshot({ path: path.join(PICTURES, `viewer-${name}-${mode}.png`) });
      const [left, right] = await panes(page);
      for (const pane of [left, right]) {
        assert.ok(pane.share > 0.15 && pane.share < 0.95, `${mode}: ${pane.share} of a pane`);
        assert.ok(pane.colours > 20, `${mode}: ${pane.colours} colours`);
      }
      assert.notEqual(left.digest, right.digest, mode);
      seen.add(left.digest);
      const values = ['quality', 'distance', 'normals', 'difference'].includes(mode);
      assert.equal(await page.locator('.legend').isVisible(), values, mode);
    }
    assert.equal(seen.size, MODES.length);
    await close(page);
  });

  for (const colorScheme of ['light', 'dark']) {
    test(`it fits, and everything has a name (${name}, ${colorScheme})`, { skip }, async () => {
      const page = await open(viewport, '#mode=distance', { colorScheme });
      assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), 'too wide');
      for (const of of ['.stage', '.legend .marks']) {
        const { top, bottom } = await page.locator(of).evaluate((box) => box.getBoundingClientRect().toJSON());
        assert.ok(top >= 0 && bottom <= viewport.height, `${of} is on the first screen: ${top} to ${bottom}`);
      }
      await page.locator('footer details').evaluateAll((all) => all.forEach((section) => { section.open = true; }));
      assert.match(await page.locator('.licence').textContent(), /MIT License[\s\S]*three\.js authors/);
      assert.match(await page.locator('.revision').textContent(), /release \d+/);
      await page.evaluate(axe);
      const { violations } = await page.evaluate(() => window.axe.run());
      assert.deepEqual(violations.map((found) => `${found.id}: ${found.nodes[0].target.join(' ')}`), []);
      await close(page);
    });
  }
}

for (const [name, viewport] of [['laptop', LAPTOP], ['phone', PHONE]]) {
  test(`it opens on the pair that differs most, as large as the panes allow (${name})`, { skip }, async () => {
    const page = await open(viewport, '', { hasTouch: name === 'phone', isMobile: name === 'phone' });
    const [left, right] = (await shown(page)).split(' ');
    const distances = Object.values(table('accuracy')).map(({ id, distance_mean: mean }) => [id, Number(mean)]);
    const spread = (object) => {
      const own = distances.filter(([id]) => id.startsWith(object)).sort((a, b) => a[1] - b[1]);
      return { difference: own.at(-1)[1] - own[0][1], pair: [own[0][0], own.at(-1)[0]] };
    };
    const widest = ['ss_', 'as_', 'bs_'].map(spread).sort((a, b) => b.difference - a.difference)[0];
    assert.deepEqual([left, right], widest.pair);
    await page.keyboard.press('1');
    await ready(page);
    const found = await panes(page);
    const reached = found.map(({ low, high }) => Math.max(high[0] - low[0], high[1] - low[1]));
    assert.ok(Math.max(...reached) > 0.9 && Math.min(...reached) > 0.8, `${reached} of the panes`);
    for (const { low, high } of found) assert.ok(Math.min(...low) > 0.01 && Math.max(...high) < 0.99, `${low} to ${high}`);
    await close(page);
  });
}

test('numbers are those of the tables', { skip }, async () => {
  const tables = Object.fromEntries(['quality', 'accuracy', 'topology'].map((name) => [name, table(name)]));
  for (const [left, right] of [['ss_bu', 'bs_sp'], ['as_si', 'ss_bi']]) {
    const page = await open(LAPTOP, `#left=${left}&right=${right}`);
    const found = await numbers(page);
    let compared = 0;
    for (const [row, [from, column]] of Object.entries({
      spacing: ['accuracy', 'spacing'],
      triangles: ['quality', 'triangles'],
      vertices: ['topology', 'vertices'],
      radius_ratio_mean: ['quality', 'radius_ratio_mean'],
      min_angle_deg_min: ['quality', 'min_angle_deg_min'],
      distance_mean: ['accuracy', 'distance_mean'],
      distance_max: ['accuracy', 'distance_max'],
      distance_to_mesh_max: ['accuracy', 'distance_to_mesh_max'],
      normal_error_mean_deg: ['accuracy', 'normal_error_mean_deg'],
      normal_error_q95_deg: ['accuracy', 'normal_error_q95_deg'],
      euler_characteristic: ['topology', 'euler_characteristic'],
      components: ['topology', 'components'],
      boundary_edges: ['topology', 'boundary_edges'],
      non_manifold_edges: ['topology', 'non_manifold_edges'],
    })) {
      for (const [side, id] of [left, right].entries()) {
        const spacing = Number(tables.accuracy[id].spacing);
        // The table has distances in spacings, the page lengths.
        const wanted = Number(tables[from][id][column]) * (column.startsWith('distance') ? spacing : 1);
        assert.ok(Math.abs(found[row][side] - wanted) <= 1e-12 * Math.abs(wanted), `${id}: ${row} is ${found[row][side]}, not ${wanted}`);
        compared += 1;
      }
    }
    assert.equal(compared, 28);
    await close(page);
  }
});

test('what colours the sphere is what a sphere has', { skip }, async () => {
  const page = await open(LAPTOP, '#left=ss_bu&right=ss_bi');
  const found = await page.evaluate(async () => {
    const { surface, quality } = await import('viewer/surface.js');
    const catalogue = JSON.parse(document.getElementById('catalogue').textContent);
    const of = catalogue.meshes.find(({ id }) => id === 'ss_bi').levels.find(({ factor }) => factor === 1);
    const mesh = await surface(of.file);
    const { positions: p, normals: n, triangles } = mesh;
    const most = Math.max(...mesh.distance);
    let [worst, away] = [0, 0];
    for (let t = 0; t < triangles.length / 3; t += 1) {
      const corners = [0, 1, 2].map((k) => [0, 1, 2].map((axis) => p[3 * triangles[3 * t + k] + axis]));
      let farthest = 0;
      for (const weights of [[1, 0, 0], [0, 1, 0], [0, 0, 1], [0.5, 0.5, 0], [0.5, 0, 0.5], [0, 0.5, 0.5], [1 / 3, 1 / 3, 1 / 3]]) {
        const at = [0, 1, 2].map((axis) => weights.reduce((sum, weight, k) => sum + weight * corners[k][axis], 0));
        farthest = Math.max(farthest, Math.abs(Math.hypot(...at) - 1));
      }
      // Half a step of the root of the distance, and half a step of a position.
      worst = Math.max(worst, Math.abs(Math.sqrt(farthest) - Math.sqrt(mesh.distance[t])) / Math.sqrt(most));
    }
    for (let v = 0; v < p.length / 3; v += 1) {
      const [position, normal] = [p, n].map((list) => [...list.subarray(3 * v, 3 * v + 3)]);
      const cosine = position.reduce((sum, value, axis) => sum + value * normal[axis], 0) / (Math.hypot(...position) * Math.hypot(...normal));
      const angle = (Math.acos(Math.min(cosine, 1)) * 180) / Math.PI;
      away = Math.max(away, Math.abs(angle - mesh.angle[v]));
    }
    const ratios = quality(mesh);
    return { worst, away, mean: ratios.reduce((a, b) => a + b) / ratios.length, wanted: of.numbers.radius_ratio_mean, count: ratios.length, triangles: of.numbers.triangles };
  });
  assert.ok(found.worst < 1 / 508 + 0.005, `distances are off by ${found.worst}`);
  // Normals have steps of 1/127, so half a degree.
  assert.ok(found.away < 0.6, `angles are off by ${found.away} degrees`);
  assert.ok(Math.abs(found.mean - found.wanted) < 1e-3, `${found.mean} is not ${found.wanted}`);
  assert.equal(found.count, found.triangles);
  await close(page);
});

test('the nearest triangle is the nearest of all', { skip }, async () => {
  const page = await open(LAPTOP);
  const worst = await page.evaluate(async () => {
    const { Nearest, squaredDistance } = await import('viewer/nearest.js');
    const { surface } = await import('viewer/surface.js');
    let state = 7;
    const random = () => {
      state = (Math.imul(state, 1103515245) + 12345) >>> 0;
      return (state >>> 8) / 2 ** 24;
    };
    let most = 0;
    for (const file of [0, 3, 14]) {
      const grid = new Nearest(await surface(file));
      for (let i = 0; i < 300; i += 1) {
        // Near, inside, and far outside of the grid.
        const p = [0, 1, 2].map(() => (random() - 0.5) * [1.5, 3, 12][i % 3]);
        let all = Infinity;
        for (let t = 0; t < grid.corners.length / 9; t += 1) all = Math.min(all, squaredDistance(grid.corners, 9 * t, ...p));
        most = Math.max(most, Math.abs(grid.distance(...p) - Math.sqrt(all)));
      }
    }
    return most;
  });
  assert.equal(worst, 0);
  const byHand = await page.evaluate(async () => {
    const { squaredDistance } = await import('viewer/nearest.js');
    const triangle = [0, 0, 0, 4, 0, 0, 0, 3, 0];
    const points = [[1, 1, 5], [2, -1, 1], [-1, -1, 0], [6, -1, 0], [5, 5.5, 1], [0, 4, -2]];
    const flat = [0, 0, 0, 4, 0, 0, 2, 0, 0];
    return [...points.map((p) => squaredDistance(triangle, 0, ...p)), squaredDistance(flat, 0, 1, 2, 3), squaredDistance([1, 1, 1, 1, 1, 1, 1, 1, 1], 0, 1, 1, 3)];
  });
  // Over the inside, an edge, corners, beyond the hypotenuse at right angles from its middle, and triangles without area.
  [25, 2, 2, 5, 26, 5, 13, 4].forEach((wanted, i) => assert.ok(Math.abs(byHand[i] - wanted) < 1e-12, `${i}: ${byHand[i]} is not ${wanted}`));
  await close(page);
});

test('a mesh does not differ from itself, and a sphere differs from a finer one by what it lacks', { skip }, async () => {
  const page = await open(LAPTOP, '#left=ss_bi&right=ss_bi&mode=difference');
  const same = await numbers(page);
  assert.deepEqual(same.difference_max, [0, 0]);
  await page.selectOption('#right', 'ss_bu');
  await page.waitForFunction(() => document.querySelector('.stage').dataset.shown.startsWith('ss_bi ss_bu difference'));
  const [left, right] = (await numbers(page)).difference_max;
  const { distance_max: [coarse, fine] } = await numbers(page);
  // Each is at most as far from the other as both are from the sphere together; distances are sampled, hence the margin.
  for (const most of [left, right]) assert.ok(most > 0 && most <= 1.1 * (coarse + fine), `${most}`);
  await close(page);
});

test('the keyboard does everything', { skip }, async () => {
  const page = await open(LAPTOP, '#left=as_bu&right=as_bi&mode=smooth');
  const start = await digests(page);
  const press = async (key) => {
    await page.keyboard.press(key);
    await ready(page);
    return digests(page);
  };
  for (const key of ['ArrowLeft', 'ArrowRight', 'ArrowUp', 'ArrowDown', '+', '-']) {
    const changed = await press(key);
    assert.ok(changed[0] !== start[0] && changed[1] !== start[1], `${key} turns or moves both`);
    assert.deepEqual(await press('r'), start, `r undoes ${key}`);
  }
  const triangles = async () => (await numbers(page)).triangles;
  const fine = await triangles();
  await press('[');
  const coarse = await triangles();
  assert.ok(coarse[0] < fine[0] && coarse[1] < fine[1]);
  assert.match(await page.locator('#resolution-said').textContent(), /2 × spacing/);
  await press('[');
  assert.deepEqual(await triangles(), coarse, 'there is nothing coarser');
  await press(']');
  assert.deepEqual(await triangles(), fine);

  await page.keyboard.press('?');
  const dialog = page.locator('#keys');
  assert.ok(await dialog.isVisible() && (await dialog.locator('kbd').count()) >= 10);
  await page.evaluate(axe);
  const { violations } = await page.evaluate(() => window.axe.run(document.querySelector('#keys')));
  assert.deepEqual(violations.map((found) => found.id), []);
  await page.keyboard.press('Escape');
  assert.ok(!(await dialog.isVisible()));

  // A control keeps its own keys, and every control can be reached.
  await page.focus('#resolution');
  await page.keyboard.press('ArrowLeft');
  await ready(page);
  assert.deepEqual(await triangles(), coarse);
  const reached = new Set();
  await page.evaluate(() => document.activeElement.blur());
  for (let i = 0; i < 14; i += 1) {
    await page.keyboard.press('Tab');
    reached.add(await page.evaluate(() => document.activeElement.id || document.activeElement.name || document.activeElement.tagName));
  }
  for (const name of ['A', 'mode', 'resolution', 'reset', 'help', 'CANVAS', 'left', 'right', 'SUMMARY']) assert.ok(reached.has(name), `${name} of ${[...reached]}`);
  await close(page);
});

test('the mouse turns both meshes, moves nearer and shifts', { skip }, async () => {
  const page = await open(LAPTOP, '#left=as_bu&right=as_bi');
  const box = await page.locator('#right-view').boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  let last = await digests(page);
  const changes = async (what) => {
    await ready(page);
    const now = await digests(page);
    assert.ok(now[0] !== last[0] && now[1] !== last[1], what);
    last = now;
  };
  for (const button of ['left', 'right']) {
    await page.mouse.move(x, y);
    await page.mouse.down({ button });
    await page.mouse.move(x + 60, y + 25, { steps: 4 });
    await page.mouse.up({ button });
    await changes(`dragged with the ${button} button`);
  }
  await page.mouse.wheel(0, -240);
  await changes('wheel');
  await close(page);
});

test('fingers turn both meshes and move nearer, and the page stays where it is', { skip }, async () => {
  const page = await open(PHONE, '#left=as_bu&right=as_bi', { hasTouch: true, isMobile: true });
  const device = await page.context().newCDPSession(page);
  const box = await page.locator('#left-view').boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  const touch = (type, ...points) => device.send('Input.dispatchTouchEvent', { type, touchPoints: points.map(([px, py], id) => ({ x: px, y: py, id })) });
  let last = await digests(page);
  const changes = async (what) => {
    await ready(page);
    const now = await digests(page);
    assert.ok(now[0] !== last[0] && now[1] !== last[1], what);
    last = now;
    assert.equal(await page.evaluate(() => scrollY), 0, what);
  };
  await touch('touchStart', [x, y]);
  for (let step = 1; step <= 5; step += 1) await touch('touchMove', [x + 12 * step, y - 8 * step]);
  await touch('touchEnd');
  await changes('one finger');
  await touch('touchStart', [x - 20, y], [x + 20, y]);
  for (let step = 1; step <= 5; step += 1) await touch('touchMove', [x - 20 - 8 * step, y], [x + 20 + 8 * step, y]);
  await touch('touchEnd');
  await changes('two fingers');
  await page.locator('.modes label').nth(4).tap();
  await page.waitForFunction(() => document.querySelector('.stage').dataset.shown.includes(' quality '));
  await changes('a mode by a tap');
  // Controls are large enough for a finger.
  await page.locator('#help').tap();
  const small = await page.locator('.modes label, .choices button, .choices input[type="range"], select, summary, header a, dialog button').evaluateAll((all) => all
    .map((of) => [of.id || of.textContent, of.getBoundingClientRect().toJSON()])
    .filter(([, { width, height }]) => width < 44 || height < 44));
  assert.deepEqual(small, []);
  await page.locator('#close-keys').tap();
  // A finger that moves up scrolls the page, and turns nothing.
  last = await digests(page);
  await touch('touchStart', [x, y]);
  for (let step = 1; step <= 10; step += 1) await touch('touchMove', [x, y - 20 * step]);
  await touch('touchEnd');
  await page.waitForFunction(() => scrollY > 100);
  await page.evaluate(() => scrollTo(0, 0));
  await ready(page);
  assert.deepEqual(await digests(page), last);
  await close(page);
});

test('an address leads to a view, and a view has an address', { skip }, async () => {
  const page = await open(LAPTOP, '#left=bs_si&right=bs_bp&mode=normals&factor=2');
  assert.equal(await shown(page), 'bs_si bs_bp normals 2');
  assert.deepEqual(await page.locator('select').evaluateAll((all) => all.map((of) => of.value)), ['bs_si', 'bs_bp']);
  // The right side follows the left to another object, by the same method.
  await page.selectOption('#left', 'ss_su');
  await page.waitForFunction(() => document.querySelector('.stage').dataset.shown === 'ss_su ss_bp normals 2');
  await page.locator('.modes label').nth(2).click();
  await page.waitForFunction(() => document.querySelector('.stage').dataset.shown === 'ss_su ss_bp flat 2');
  assert.equal(new URL(page.url()).hash, '#left=ss_su&right=ss_bp&mode=flat&factor=2');
  await page.evaluate(() => { location.hash = '#left=as_bi&right=nothing&mode=quality&factor=99'; });
  await page.waitForFunction(() => document.querySelector('.stage').dataset.shown === 'as_bi ss_bp quality 2');
  const told = await page.locator('#address p').allTextContents();
  assert.ok(told.length === 2 && told[0].includes('right=nothing') && told[1].includes('factor=99'), told.join('\n'));
  await close(page);
});

test('a bad address says what is bad, and what there is', { skip }, async () => {
  for (const viewport of [LAPTOP, PHONE]) {
    const page = await open(viewport, '#left=zz&colour=red');
    assert.ok(await page.locator('#address').isVisible());
    const [unknown, key] = await page.locator('#address p').allTextContents();
    assert.ok(unknown.includes('left=zz'), unknown);
    // The first six of 18 meshes: all those of a large study would fill a phone's first screen.
    assert.ok(unknown.endsWith('It has ss_bu, ss_bi, ss_bp, ss_su, ss_si, ss_sp and 12 more.'), unknown);
    assert.ok(key.includes('“colour”') && key.includes('left, right, mode, factor'), key);
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), 'too wide');
    // A short list is named whole.
    await page.evaluate(() => { location.hash = '#mode=zz'; });
    await page.waitForFunction(() => document.querySelector('#address').textContent.includes('mode=zz'));
    const modes = await page.locator('#address p').textContent();
    for (const mode of MODES) assert.ok(modes.includes(mode), modes);
    // What follows is good again.
    await page.evaluate(() => { location.hash = '#left=as_bi'; });
    await page.waitForFunction(() => document.querySelector('#address').hidden);
    await close(page);
  }
});

test('without WebGL the page says so, and has its numbers', { skip }, async () => {
  const page = await open(LAPTOP, '#left=as_bu&right=as_bi', {}, () => {
    HTMLCanvasElement.prototype.getContext = () => null;
  });
  const told = await page.locator('.missing').allTextContents();
  assert.ok(told.length === 2 && told.every((text) => text.includes('WebGL')), told.join());
  const { triangles } = await numbers(page);
  const { as_bu: left, as_bi: right } = table('quality');
  const wanted = [left, right].map((row) => Number(row.triangles));
  assert.deepEqual(triangles, wanted);
  await page.selectOption('#left', 'as_bi');
  await page.waitForFunction(() => document.querySelector('.stage').dataset.shown.startsWith('as_bi as_bi'));
  assert.deepEqual((await numbers(page)).triangles, [wanted[1], wanted[1]]);
  // The library says so too.
  page.faults = page.faults.filter((fault) => !fault.includes('WebGL'));
  await close(page);
});

test('the study links to it', { skip }, async () => {
  const context = await browser.newContext({ viewport: LAPTOP });
  const page = await context.newPage();
  await page.goto(pathToFileURL(path.join(folder, 'index.html')).href);
  await page.locator('a[href="viewer.html"]').click();
  await ready(page);
  assert.equal(await page.locator('h1').textContent(), 'Any two meshes side by side');
  await page.locator('a[href="index.html"]').click();
  assert.match(await page.locator('h1').textContent(), /quick study/);
  await context.close();
});
