// Pairs as models that participants turn, in a real browser: gestures, the log of cameras, fallbacks, the replay.
// Run by scripts/test-browser.sh, which sets ISOSTUDY (the program), CHROMIUM and MODULES. Without three.js there is nothing to test.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import http from 'node:http';
import { createRequire } from 'node:module';
import path from 'node:path';
import test, { after } from 'node:test';
import { PHONE, TOKEN, answer, begin, folder, open, questionnaire, ready, root, rows, run, serious, tab } from './walk.mjs';

const THREE = path.join(root, 'cache/three');
const skip = fs.existsSync(path.join(THREE, 'three.module.min.js')) ? false : 'three.js is not there: make three';
const { chromium } = createRequire(path.join(process.env.MODULES, 'package.json'))('playwright-core');

/** A browser that draws models, by software. */
const drawing = await chromium.launch({
  executablePath: process.env.CHROMIUM,
  args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync'],
});
after(() => drawing.close());

/** The small study with models; `look` is that of its turntables. Looks show coarse meshes unequally bright, which is a fault. */
function models(name, look = 'smooth') {
  return questionnaire(name, (text) => text
    .replace('[forms]', `[forms]\nstimulus = "model"\nthree = "${THREE}"\ngo_back = true`)
    .replace('[turntable]', `[turntable]\nlook = "${look}"`)
    .replace('page_scale = 4', 'page_scale = 1').replace('width = 128', 'width = 256').replace('height = 128', 'height = 256')
    .replace('duration_s = 0.4', 'duration_s = 3.0'), ...(look === 'smooth' ? [] : ['--with-faults']));
}
const made = skip ? null : models('models');

/** A page in a browser that draws, in which the test finds every canvas that draws models. */
async function draws(address, options = {}) {
  const context = await drawing.newContext({ acceptDownloads: true, viewport: { width: 1280, height: 900 }, ...options });
  await context.addInitScript(() => {
    window.drawing = [];
    const own = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function getContext(kind, ...rest) {
      const context = own.call(this, kind, ...rest);
      if (kind === 'webgl2' && context && !window.drawing.includes(context)) window.drawing.push(context);
      return context;
    };
  });
  return tab(context, address);
}

const half = (page) => page.locator('.pair .half canvas').first();
/** The left surface, as 64 x 64 grey levels, and the mean difference of two. */
const picture = (page) => half(page).evaluate((canvas) => {
  const small = Object.assign(document.createElement('canvas'), { width: 64, height: 64 });
  const context = small.getContext('2d');
  context.drawImage(canvas, 0, 0, 64, 64);
  return Array.from(context.getImageData(0, 0, 64, 64).data);
});
const apart = (a, b) => a.reduce((sum, level, i) => sum + Math.abs(level - b[i]), 0) / a.length;
const cameras = async (server) => rows(await server.export('cameras.csv')).map((row) => ({ ...row, t: Number(row.t_ms), azimuth: Number(row.azimuth_deg), elevation: Number(row.elevation_deg), distance: Number(row.distance) }));
/** The cameras of a place, which come after its answer. */
async function logged(server, order) {
  for (let tries = 0; tries < 100; tries += 1) {
    const own = (await cameras(server)).filter((row) => row.order === order);
    if (own.length > 0) return own;
    await new Promise((resolve) => { setTimeout(resolve, 100); });
  }
  return [];
}
const near = (found, expected, by, what) => assert.ok(Math.abs(found - expected) <= by, `${what}: ${found} is not ${expected}`);

/** Waits until both surfaces of a new pair are drawn. */
async function drawn(page) {
  await page.locator('.pair.model .half canvas').first().waitFor();
  await page.waitForFunction(() => document.querySelector('.tools button:not(.soon)') !== null);
}

/** Drags the left surface by so many pixels, in steps. */
async function drag(page, dx, dy) {
  const box = await half(page).boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  for (let i = 1; i <= 10; i += 1) {
    await page.mouse.move(x + (dx * i) / 10, y + (dy * i) / 10);
    await page.waitForTimeout(30);
  }
  await page.mouse.up();
  return box.width;
}

test('mouse, wheel, keys and the button turn both models, and the log says how far', { skip }, async () => {
  const server = await made.serve('desktop');
  const page = await draws(server.address);
  await page.getByText('How you turn the surfaces is kept').waitFor();
  await page.getByRole('button', { name: 'I agree, begin' }).click();
  await page.getByText('Drag to turn both surfaces').waitFor();
  await page.getByRole('button', { name: 'Go on' }).click();
  // Practice is not logged. It can be answered after the time of a turn, without turning.
  await drawn(page);
  await page.keyboard.press('1');
  assert.match(await page.locator('#status').textContent(), /Please turn the surfaces first/);
  await answer(page, 'L');

  // By mouse: a drag is no tap, and a quarter of a turn opens the answers at once.
  await drawn(page);
  const before = await picture(page);
  const right = () => page.locator('.pair .half canvas').nth(1).evaluate((canvas) => canvas.toDataURL());
  const rightBefore = await right();
  // Where no graphics card draws, the next frame may take a while, and a drag may come before the surfaces are in their place.
  // A sphere of many triangles changes by less than one grey level as it turns; what stands still, by none.
  const turned = async () => apart(before, await picture(page)) > 0.1 && rightBefore !== await right();
  let width = 0;
  for (let drags = 0; drags < 5 && !await turned(); drags += 1) {
    width = await drag(page, 200, 60);
    assert.equal(await page.locator('.pair.large').count(), 0);
    for (let tries = 0; tries < 50 && !await turned(); tries += 1) await page.waitForTimeout(100);
  }
  assert.ok(await turned(), 'both have turned');
  assert.deepEqual(await serious(page), []);
  await answer(page, 'R');
  const first = await logged(server, '2');
  assert.equal(first[0].t, 0);
  near(first[0].azimuth, 45, 0.05, 'first azimuth');
  const elevation = first[0].elevation;
  // The first steps up to a tap's length turn nothing.
  near(first.at(-1).azimuth, 45 - (200 * 180) / width, (21 * 180) / width, 'azimuth after the drag');
  near(first.at(-1).elevation, elevation + (60 * 180) / width, (8 * 180) / width, 'elevation after the drag');
  assert.ok(first.every((row) => row.distance === 1 && row.hz === '20.0' && row.question !== ''));
  assert.ok(first.slice(2).every((row, i) => row.t - first[i + 1].t >= 45), 'at most twenty a second');
  assert.ok(first.length >= 5 && first.length <= 16, `${first.length}`);

  // By keys: with Shift anywhere, without while the pair has the focus; arrows answer otherwise.
  await drawn(page);
  await page.keyboard.press('Shift+ArrowRight');
  await page.keyboard.press('Shift+ArrowUp');
  await page.locator('.pair').focus();
  for (let i = 0; i < 3; i += 1) await page.keyboard.press('ArrowRight');
  await page.keyboard.press('+');
  await page.keyboard.press('+');
  await page.keyboard.press('-');
  const title = await page.locator('h2').textContent();
  await ready(page);
  await page.locator('h2').focus();
  await page.keyboard.press('ArrowLeft');
  await page.waitForFunction((old) => document.querySelector('h2').textContent !== old, title);
  const second = await logged(server, '3');
  near(second.at(-1).azimuth, 45 + 4 * 7.5, 0.11, 'azimuth by keys');
  near(second.at(-1).elevation, elevation + 7.5, 0.11, 'elevation by keys');
  near(second.at(-1).distance, 1 / 1.15, 0.001, 'distance by keys');

  // By wheel, within limits; and back by the button.
  await drawn(page);
  const start = await picture(page);
  const box = await half(page).boundingBox();
  await page.mouse.move(box.x + 20, box.y + 20);
  for (let i = 0; i < 12; i += 1) await page.mouse.wheel(0, -100);
  await page.waitForTimeout(200);
  await page.getByRole('button', { name: 'Reset' }).click();
  for (let tries = 0; tries < 100 && apart(start, await picture(page)) >= 0.01; tries += 1) await page.waitForTimeout(100);
  assert.ok(apart(start, await picture(page)) < 0.01, 'as it was');
  await answer(page, 'NP');
  const third = await logged(server, '4');
  near(Math.min(...third.map((row) => row.distance)), 0.4, 0.0005, 'nearest');
  assert.deepEqual([third.at(-1).distance, third.at(-1).azimuth], [1, 45]);

  // Going back and answering otherwise replaces the cameras of that answer.
  await page.getByRole('button', { name: 'Back' }).click();
  await drawn(page);
  await drag(page, -150, 0);
  await answer(page, 'L');
  const latest = () => logged(server, '4');
  for (let tries = 0; tries < 100 && (await latest()).at(-1).azimuth <= 90; tries += 1) await page.waitForTimeout(100);
  const again = await latest();
  assert.ok(again.every((row) => row.distance === 1) && again.at(-1).azimuth > 90, JSON.stringify(again.at(-1)));

  const lines = rows(await server.export());
  assert.deepEqual(lines.map((line) => line.shown_as), ['model', 'model', 'model']);
  near(Number(lines[1].turned_deg), 4 * 7.5, 7.5, 'degrees by keys');
  assert.ok(Number(lines[0].turned_deg) > 60 && lines.every((line) => line.dropped === '0'));
  const csv = path.join(folder, 'desktop-shared');
  run('deidentify', made.config, '--answers', server.answers, '--out', csv);
  const shared = rows(fs.readFileSync(path.join(csv, 'cameras.csv'), 'utf8'));
  assert.ok(shared.length > 0 && shared.every((row) => row.participant === 'p1'));
  assert.match(fs.readFileSync(path.join(csv, 'codebook.md'), 'utf8'), /`azimuth_deg`/);

  // Whoever withdraws takes the cameras along.
  await page.getByRole('button', { name: 'Stop' }).click();
  await page.getByRole('button', { name: 'Stop and delete my answers' }).click();
  await page.getByText('Your answers are deleted').waitFor();
  assert.deepEqual(await cameras(server), []);
  await server.stop();
});

test('on a phone one finger turns and two come nearer', { skip }, async () => {
  const server = await made.serve('phone');
  const page = await draws(server.address, PHONE);
  await begin(page);
  await answer(page, 'L');
  await drawn(page);
  const session = await page.context().newCDPSession(page);
  const touch = (type, points) => session.send('Input.dispatchTouchEvent', { type, touchPoints: points.map(([x, y], id) => ({ x, y, id })) });
  const box = await half(page).boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await touch('touchStart', [[x, y]]);
  for (let i = 1; i <= 8; i += 1) {
    await touch('touchMove', [[x, y + 10 * i]]);
    await page.waitForTimeout(30);
  }
  await touch('touchEnd', []);
  await touch('touchStart', [[x - 20, y], [x + 20, y]]);
  for (let i = 1; i <= 8; i += 1) {
    await touch('touchMove', [[x - 20 - 3 * i, y], [x + 20 + 3 * i, y]]);
    await page.waitForTimeout(30);
  }
  await touch('touchEnd', []);
  assert.equal(await page.evaluate(() => window.scrollY), 0);
  assert.deepEqual(await serious(page), []);
  await answer(page, 'L');
  const seen = await logged(server, '2');
  const turned = seen.filter((row) => row.distance === 1).at(-1);
  assert.ok(turned.elevation > seen[0].elevation + 10 && Math.abs(turned.azimuth - 45) < 0.2, JSON.stringify(turned));
  near(seen.at(-1).distance, 40 / 88, 0.04, 'distance by two fingers');
  const [line] = rows(await server.export());
  assert.deepEqual([line.shown_as, line.input, line.layout], ['model', 'mouse', 'stacked']);
  await server.stop();
});

for (const look of ['smooth', 'flat', 'smooth-wireframe', 'creased']) {
  test(`models begin as the turntable's first frame: ${look}`, { skip }, async () => {
    const study = look === 'smooth' ? made : models(`models-${look}`, look);
    const server = await study.serve(`look-${look}`);
    const page = await draws(server.address);
    await begin(page);
    await drawn(page);
    const code = await page.locator('.pair').getAttribute('data-code');
    const differences = await page.evaluate(async (address) => {
      const image = new Image();
      image.src = address;
      await image.decode();
      const [width, height] = [image.naturalWidth / 2, image.naturalHeight];
      return [...document.querySelectorAll('.half canvas')].map((canvas, side) => {
        const [own, theirs] = [0, 1].map((which) => {
          const copy = Object.assign(document.createElement('canvas'), { width, height });
          const context = copy.getContext('2d');
          if (which === 0) context.drawImage(canvas, 0, 0, width, height);
          else context.drawImage(image, side * width, 0, width, height, 0, 0, width, height);
          return context.getImageData(0, 0, width, height).data;
        });
        let sum = 0;
        let far = 0;
        for (let i = 0; i < own.length; i += 4) {
          const off = (Math.abs(own[i] - theirs[i]) + Math.abs(own[i + 1] - theirs[i + 1]) + Math.abs(own[i + 2] - theirs[i + 2])) / 3;
          sum += off;
          far += off > 40 ? 1 : 0;
        }
        const spread = new Set(Array.from(theirs.filter((_, i) => i % 4 === 0))).size;
        return { mean: sum / (own.length / 4), far: far / (own.length / 4), spread };
      });
    }, `${server.address}stimuli/${code}.gif`);
    for (const { mean, far, spread } of differences) {
      assert.ok(spread > 20, 'the turntable shows something');
      // Rims and edges are resolved otherwise, and GIFs have 256 colours.
      const [most, some] = look === 'smooth-wireframe' ? [8, 0.08] : [2.5, 0.02];
      assert.ok(mean < most && far < some, `${look}: mean difference ${mean} of 255, ${100 * far} % far off`);
    }
    if (process.env.PICTURES) await page.screenshot({ path: path.join(process.env.PICTURES, `model-${look}.png`) });
    await server.stop();
  });
}

test('without WebGL, and when the browser takes it away, turntables are shown', { skip }, async () => {
  const server = await made.serve('fallback');
  const none = await open(server.address);
  await none.addInitScript(() => { HTMLCanvasElement.prototype.getContext = ((own) => function get(kind, ...rest) { return kind === 'webgl2' ? null : own.call(this, kind, ...rest); })(HTMLCanvasElement.prototype.getContext); });
  await none.goto(server.address);
  await begin(none);
  await answer(none, 'L');
  await none.locator('.pair img').first().waitFor();
  await answer(none, 'R');

  const page = await draws(server.address);
  await begin(page);
  await answer(page, 'L');
  await drawn(page);
  await drag(page, 150, 0);
  await page.evaluate(() => window.drawing.at(-1).getExtension('WEBGL_lose_context').loseContext());
  await page.locator('.pair img').first().waitFor();
  assert.equal(await page.locator('.pair.model').count(), 0);
  assert.equal(await page.getByRole('button', { name: 'Reset' }).count(), 0);
  await answer(page, 'R');
  await answer(page, 'NP');
  const lines = rows(await server.export());
  assert.deepEqual(lines.map((line) => [line.shown_as, line.turned_deg]), Array(3).fill(['gif', '']));
  assert.deepEqual(await cameras(server), []);
  await server.stop();
});

test('cameras are in the JSON of a page without a server of ours, and collect writes them', { skip }, async () => {
  const bundle = path.join(made.out, 'bundle');
  const types = { html: 'text/html', js: 'text/javascript', css: 'text/css', gif: 'image/gif', glb: 'model/gltf-binary' };
  const host = http.createServer((request, response) => {
    const file = path.join(bundle, new URL(request.url, 'http://x').pathname.replace(/\/$/, '/index.html'));
    if (!fs.existsSync(file)) {
      response.writeHead(404).end();
      return;
    }
    response.writeHead(200, { 'content-type': types[file.split('.').at(-1)] ?? 'text/plain' }).end(fs.readFileSync(file));
  }).listen(0, '127.0.0.1');
  await new Promise((resolve) => { host.once('listening', resolve); });
  const page = await draws(`http://127.0.0.1:${host.address().port}/?form=2`);
  await begin(page);
  for (const [i, choice] of ['L', 'L', 'R', 'NP', 'R', 'L', 'NP'].entries()) {
    await drawn(page);
    if (i > 0) await page.keyboard.press('Shift+ArrowRight');
    await answer(page, choice);
  }
  const download = page.waitForEvent('download');
  await page.getByRole('link', { name: 'Download JSON' }).click();
  const downloads = path.join(folder, 'downloads');
  fs.mkdirSync(downloads);
  await (await download).saveAs(path.join(downloads, 'one.json'));
  const { answers } = JSON.parse(fs.readFileSync(path.join(downloads, 'one.json'), 'utf8'));
  assert.equal(answers.length, 6);
  assert.ok(answers.every(({ track }) => track.hz === 20 && track.cameras.length === 8));
  const [out, seen] = ['collected.csv', 'collected-cameras.csv'].map((name) => path.join(folder, name));
  run('collect', made.config, downloads, '--out', out, '--cameras', seen);
  const found = rows(fs.readFileSync(seen, 'utf8'));
  assert.equal(found.length, 12);
  assert.ok(found.filter((_, i) => i % 2 === 1).every((row) => row.azimuth_deg === '52.5'));
  assert.ok(rows(fs.readFileSync(out, 'utf8')).every((row) => row.turned_deg !== '' && row.shown_as === 'model'));
  host.close();
});

test('the replay shows what was seen', { skip }, async () => {
  const server = await made.serve('replay');
  const page = await draws(server.address);
  await begin(page);
  await answer(page, 'L');
  await drawn(page);
  await drag(page, 120, 40);
  await page.keyboard.press('+');
  await page.waitForTimeout(200);
  const atEnd = await picture(page);
  await answer(page, 'R');
  const kept = await logged(server, '2');
  const file = path.join(folder, 'cameras.csv');
  fs.writeFileSync(file, await server.export('cameras.csv'));

  const replay = await draws(`${server.address}replay`);
  await replay.locator('#file').setInputFiles(path.join(root, 'README.md'));
  await replay.getByText('The file has no column').waitFor();
  await replay.locator('#file').setInputFiles(file);
  await replay.getByText(/cameras in/).waitFor();
  assert.deepEqual(await serious(replay), []);
  const atStart = await picture(replay);
  await replay.getByRole('button', { name: 'Play' }).click();
  await replay.waitForFunction((last) => document.querySelector('.pair').dataset.frame === String(last), kept.length - 1, { timeout: 60000 });
  const last = kept.at(-1);
  assert.ok((await replay.locator('#said').textContent()).includes(`azimuth ${last.azimuth.toFixed(1)}°, elevation ${last.elevation.toFixed(1)}°, distance ${last.distance.toFixed(3)}`));
  const shown = await picture(replay);
  assert.ok(apart(shown, atEnd) < 1.5, `what was seen: ${apart(shown, atEnd)}`);
  assert.ok(apart(shown, atStart) > 1.5, 'and it has moved');
  const researcher = await draws(`${server.address}researcher`);
  await researcher.getByLabel('Token').fill(TOKEN);
  await researcher.getByRole('button', { name: 'Show' }).click();
  const download = researcher.waitForEvent('download');
  await researcher.getByRole('button', { name: 'Download cameras' }).click();
  assert.equal(fs.readFileSync(await (await download).path(), 'utf8'), fs.readFileSync(file, 'utf8'));
  await server.stop();
});
