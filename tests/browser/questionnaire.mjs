// The questionnaire in a real browser: a page from a folder, the server, the researcher's page.
// Run by scripts/test-browser.sh, which sets ISOSTUDY (the program), CHROMIUM and MODULES.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import fs from 'node:fs';
import { createRequire } from 'node:module';
import os from 'node:os';
import path from 'node:path';
import test, { after, before } from 'node:test';
import { fileURLToPath, pathToFileURL } from 'node:url';

const { ISOSTUDY, CHROMIUM, MODULES } = process.env;
const require = createRequire(path.join(MODULES, 'package.json'));
const { chromium } = require('playwright-core');
const axe = fs.readFileSync(require.resolve('axe-core/axe.min.js'), 'utf8');

const root = path.resolve(path.dirname(fileURLToPath(import.meta.url)), '../..');
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'isostudy-'));
const config = path.join(folder, 'study.toml');
const out = path.join(folder, 'out');
const TOKEN = 'a-token-for-this-test';
const MOST = 6;

let browser;
const children = new Set();
before(async () => {
  const text = fs.readFileSync(path.join(root, 'configs/two-methods.toml'), 'utf8')
    .replace('width = 320', 'width = 128').replace('height = 320', 'height = 128').replace('frames = 72', 'frames = 4')
    .replace('duration_s = 5.76', 'duration_s = 0.4').replaceAll('stimulus_spacing = 0.08', 'stimulus_spacing = 0.2')
    .replace('"cpu/', `"${root}/configs/cpu/`).replace('max_questions = 6', 'max_questions = 6\npage_scale = 4\ncompletion = "C0DE-42"');
  fs.writeFileSync(config, text);
  run('bundle', config, '--out', out);
  browser = await chromium.launch({
    executablePath: CHROMIUM,
    args: ['--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync'],
  });
});
after(async () => {
  await browser?.close();
  for (const child of children) child.kill('SIGKILL');
  fs.rmSync(folder, { recursive: true });
});

function run(...words) {
  const done = spawnSync(ISOSTUDY, words, { encoding: 'utf8' });
  assert.equal(done.status, 0, done.stderr);
  return done.stdout;
}

/** A server, its answers in a folder of that name; on a free port if none is said. */
async function serve(name, port = '0') {
  const answers = path.join(folder, name);
  const child = spawn(ISOSTUDY, ['serve', config, '--out', out, '--answers', answers, '--port', port, '--admin-token', TOKEN], { stdio: ['ignore', 'ignore', 'pipe'] });
  children.add(child);
  let said = '';
  const address = await new Promise((resolve, reject) => {
    child.stderr.on('data', (data) => {
      said += data;
      const found = said.match(/questionnaire\s+(http:\S+)\n/);
      if (found) resolve(found[1]);
    });
    child.on('exit', (code) => reject(new Error(`the server ended with ${code}: ${said}`)));
  });
  const ended = new Promise((resolve) => { child.on('exit', resolve); });
  return {
    address,
    answers,
    export: async (file = 'answers.csv') => {
      const response = await fetch(`${address}api/admin/${file}`, { headers: { authorization: `Bearer ${TOKEN}` } });
      assert.equal(response.status, 200);
      return response.text();
    },
    stop: (signal = 'SIGTERM') => { child.kill(signal); return ended; },
  };
}

const rows = (csv) => {
  const [header, ...lines] = csv.trim().split(/\r?\n/).map((line) => line.split(','));
  return lines.map((cells) => Object.fromEntries(header.map((name, i) => [name, cells[i]])));
};

/** A page on which nothing goes wrong and nobody else is asked for anything, in a browser of its own. */
async function open(address, options = {}) {
  return tab(await browser.newContext({ acceptDownloads: true, ...options }), address);
}

/** One more page in a browser. */
async function tab(context, address) {
  const page = await context.newPage();
  page.on('pageerror', (error) => { throw error; });
  page.on('request', (request) => {
    const asked = new URL(request.url());
    assert.ok(['file:', 'blob:', 'data:'].includes(asked.protocol) || asked.origin === new URL(address).origin, request.url());
  });
  await page.goto(address);
  return page;
}

const begin = async (page) => {
  await page.getByRole('button', { name: 'I agree, begin' }).click();
  await page.getByRole('button', { name: 'Go on' }).click();
};

const shown = (page) => page.locator('.pair img').evaluate((image) => image.src.match(/([a-z]+)\.gif/)[1]);
const ready = (page) => page.locator('[data-choice="L"]:not([aria-disabled])').waitFor();

/** Answers what is on the screen, and returns what it was. */
async function answer(page, choice, how = 'mouse') {
  const title = await page.locator('h2').textContent();
  await ready(page);
  const code = await shown(page);
  if (how === 'mouse') await page.locator(`[data-choice="${choice}"]`).click();
  else await page.keyboard.press(how[choice]);
  await page.waitForFunction((old) => document.querySelector('h2').textContent !== old, title);
  return { code, choice };
}

const CHOICES = ['L', 'R', 'NP', 'R', 'L', 'NP'];

async function all(page, how) {
  await answer(page, 'L', how);
  const given = [];
  for (const choice of CHOICES) given.push(await answer(page, choice, how));
  return given;
}

const asGiven = (line) => ({ code: line.stimulus, choice: line.choice });

test('a form by mouse and one by keyboard arrive as they were given', async () => {
  const server = await serve('two');
  const mouse = await open(`${server.address}?PROLIFIC_PID=5f9&STUDY_ID=61a&SESSION_ID=s1`);
  await begin(mouse);
  const first = await all(mouse, 'mouse');
  await mouse.getByText('C0DE-42').waitFor();

  const keyboard = await open(server.address);
  await keyboard.keyboard.press('Tab');
  await keyboard.keyboard.press('Enter');
  await keyboard.getByRole('button', { name: 'Go on' }).waitFor();
  await keyboard.keyboard.press('Tab');
  await keyboard.keyboard.press('Enter');
  await answer(keyboard, 'L', { L: '1' });
  const second = [];
  for (const [i, choice] of CHOICES.entries()) {
    second.push(await answer(keyboard, choice, i % 2 ? { L: '1', NP: '2', R: '3' } : { L: 'ArrowLeft', NP: 'ArrowDown', R: 'ArrowRight' }));
  }
  await keyboard.getByText('C0DE-42').waitFor();

  const lines = rows(await server.export());
  assert.equal(lines.length, 2 * MOST);
  const people = [...new Set(lines.map((line) => line.participant))];
  const of = (person) => lines.filter((line) => line.participant === person);
  assert.deepEqual(of(people[0]).map(asGiven), first);
  assert.deepEqual(of(people[1]).map(asGiven), second);
  assert.equal(new Set(people.map((person) => of(person)[0].form)).size, 2);
  assert.ok(lines.every((line) => Number(line.rt_ms) >= 400 && Number(line.rt_ms) < 60000));
  assert.ok(lines.every((line) => line.left && line.right && line.question && line.role));
  const identities = rows(await server.export('identities.csv'));
  assert.deepEqual(identities, [{ participant: people[0], PROLIFIC_PID: '5f9', STUDY_ID: '61a', SESSION_ID: 's1' }]);

  const researcher = await open(`${server.address}researcher`);
  await researcher.getByLabel('Token').fill('wrong');
  await researcher.getByRole('button', { name: 'Show' }).click();
  await researcher.getByText('missing or wrong').waitFor();
  await researcher.getByLabel('Token').fill(TOKEN);
  await researcher.getByRole('button', { name: 'Show' }).click();
  await researcher.locator('#stand').waitFor();
  assert.match(await researcher.locator('#numbers').textContent(), /began2who finished2answering now0Answers12/);
  assert.ok(!/bu|bi/.test(await researcher.locator('#stand').textContent()));
  const asked = await researcher.locator('#questions td:first-child').allTextContents();
  assert.deepEqual(asked, ['Q1', 'Q2', 'Q1-r', 'Q2-r', 'control-1', 'control-2']);
  assert.match(await researcher.locator('#minutes').getAttribute('aria-label'), /: \d+ at most, \d+ in the last/);
  const download = researcher.waitForEvent('download');
  await researcher.getByRole('button', { name: 'Download answers' }).click();
  assert.deepEqual(rows(fs.readFileSync(await (await download).path(), 'utf8')), lines);
  await server.stop();

  const shared = path.join(folder, 'shared');
  run('deidentify', config, '--answers', server.answers, '--out', shared);
  const open_set = fs.readFileSync(path.join(shared, 'answers.csv'), 'utf8');
  assert.equal(rows(open_set).length, 12);
  assert.ok(people.every((person) => !open_set.includes(person)) && !open_set.includes('5f9'));
  assert.match(fs.readFileSync(path.join(shared, 'codebook.md'), 'utf8'), /12 answers of 2 participants/);
});

test('nobody can answer before one turn', async () => {
  const page = await open(pathToFileURL(path.join(out, 'bundle/index.html')).href);
  // A turn that takes long enough for a slow machine to press keys in.
  await page.evaluate(() => { window.ISOSTUDY.loop_ms = 5000; });
  await page.getByLabel(/Your number/).fill('1');
  await begin(page);
  await page.locator('.pair img').waitFor();
  await page.keyboard.press('1');
  await page.locator('[data-choice="R"]').click({ force: true });
  assert.equal(await page.locator('#status').textContent(), 'Please watch one whole turn first.');
  await answer(page, 'L');
});

test('a reload loses nothing, nor does a server that was killed', async () => {
  const server = await serve('reload');
  const page = await open(server.address);
  await begin(page);
  await answer(page, 'L');
  const given = [await answer(page, 'R'), await answer(page, 'NP')];
  await page.reload();
  assert.match(await page.locator('h2').textContent(), /Question 3/);
  // Somebody pulls the plug; the answers wait in the browser and arrive when the server is back.
  await server.stop('SIGKILL');
  given.push(await answer(page, 'L'));
  await page.getByText('No connection').waitFor();
  const again = await serve('reload', new URL(server.address).port);
  for (const choice of CHOICES.slice(3)) given.push(await answer(page, choice));
  await page.getByText('All your answers are saved').waitFor({ timeout: 40000 });
  assert.deepEqual(rows(await again.export()).map(asGiven), given);
  await again.stop();
});

test('a folder opened as a file gives the same answers as CSV and JSON', async () => {
  const address = pathToFileURL(path.join(out, 'bundle/index.html')).href;
  const page = await open(address);
  await page.getByLabel(/Your number/).fill('3');
  await begin(page);
  const given = await all(page, 'mouse');
  const files = [];
  for (const kind of ['CSV', 'JSON']) {
    const download = page.waitForEvent('download');
    await page.getByRole('link', { name: `Download ${kind}` }).click();
    const file = path.join(folder, `given.${kind.toLowerCase()}`);
    await (await download).saveAs(file);
    files.push(file);
  }
  assert.deepEqual(rows(fs.readFileSync(files[0], 'utf8')).map(asGiven), given);
  const joined = path.join(folder, 'joined.csv');
  run('collect', config, ...files, '--out', joined);
  const lines = rows(fs.readFileSync(joined, 'utf8'));
  assert.deepEqual(lines.map(asGiven), given);
  const key = rows(fs.readFileSync(path.join(out, 'key/forms.csv'), 'utf8')).filter((line) => line.form === '3');
  assert.deepEqual(lines.map((line) => [line.order, line.left, line.right]), key.slice(1).map((line) => [line.order, line.left, line.right]));
});

test('others in the same browser are other people, and come back to where they were', async () => {
  const server = await serve('others');
  const at = (name) => `${server.address}?PROLIFIC_PID=${name}&STUDY_ID=61a&SESSION_ID=s-${name}`;
  const alice = await open(at('alice'));
  await alice.getByText('names you by an identifier').waitFor();
  await begin(alice);
  await answer(alice, 'L');
  const first = [await answer(alice, 'L'), await answer(alice, 'NP')];
  const bob = await tab(alice.context(), at('bob'));
  await begin(bob);
  assert.match(await bob.locator('h2').textContent(), /Practice 1/);
  const given = await all(bob, 'mouse');
  await alice.goto(at('alice'));
  assert.match(await alice.locator('h2').textContent(), /Question 3/);
  for (const choice of CHOICES.slice(2)) first.push(await answer(alice, choice));
  await alice.getByText('C0DE-42').waitFor();
  const lines = rows(await server.export());
  const names = Object.fromEntries(rows(await server.export('identities.csv')).map((line) => [line.PROLIFIC_PID, line.participant]));
  const of = (name) => lines.filter((line) => line.participant === names[name]).map(asGiven);
  assert.deepEqual([of('alice'), of('bob')], [first, given]);
  const nobody = await tab(alice.context(), server.address);
  await nobody.getByRole('button', { name: 'I agree, begin' }).waitFor();
  assert.equal(await nobody.getByText('names you by an identifier').count(), 0);
  await server.stop();
});

test('a server that knows nothing of a session is not answered on', async () => {
  const server = await serve('known');
  const page = await open(server.address);
  await begin(page);
  await answer(page, 'L');
  await answer(page, 'R');
  await page.waitForFunction(() => Object.values(localStorage).some((text) => JSON.parse(text).answers?.[0]?.saved));
  await server.stop();
  const other = await serve('unknown', new URL(server.address).port);
  await ready(page);
  await page.keyboard.press('1');
  await page.getByText('does not know this session any more').waitFor();
  const download = page.waitForEvent('download');
  await page.getByRole('link', { name: 'Download CSV' }).click();
  assert.equal(rows(fs.readFileSync(await (await download).path(), 'utf8')).length, 2);
  await begin(page);
  const given = await all(page, 'mouse');
  await page.getByText('All your answers are saved').waitFor();
  assert.deepEqual(rows(await other.export()).map(asGiven), given);
  await other.stop();
});

test('what may pass is tried again, and what the server will never take ends the questions', async () => {
  const server = await serve('passing');
  const page = await open(server.address);
  const failing = [408, 500, 404, 403, 429];
  await page.route('**/api/{answers,finish}', (route) => {
    const status = Math.random() < 0.5 ? failing.pop() : undefined;
    return status ? route.fulfill({ status, body: 'no' }) : route.continue();
  });
  await begin(page);
  const given = await all(page, 'mouse');
  await page.getByText('All your answers are saved').waitFor({ timeout: 60000 });
  assert.deepEqual(rows(await server.export()).map(asGiven), given);
  // The last request as well.
  let late = 2;
  const last = await open(server.address);
  await last.route('**/api/finish', (route) => {
    late -= 1;
    return late >= 0 ? route.fulfill({ status: 408, body: '' }) : route.continue();
  });
  await begin(last);
  await all(last, 'mouse');
  await last.getByText('C0DE-42').waitFor({ timeout: 30000 });

  const refused = await open(server.address);
  await begin(refused);
  await answer(refused, 'L');
  await refused.route('**/api/answers', (route) => route.fulfill({ status: 422, headers: { 'isostudy-refusal': 'other-stimulus' }, body: 'place 2 of this form shows another pair' }));
  await ready(refused);
  await refused.keyboard.press('3');
  await refused.getByRole('heading', { name: 'could not be saved' }).waitFor();
  // Clocks and keys of the question that followed are gone.
  await refused.waitForTimeout(600);
  await refused.keyboard.press('1');
  assert.match(await refused.locator('#view').textContent(), /place 2 of this form shows another pair/);
  assert.equal(await refused.locator('#status').textContent(), '');
  const download = refused.waitForEvent('download');
  await refused.getByRole('link', { name: 'Download JSON' }).click();
  assert.equal(JSON.parse(fs.readFileSync(await (await download).path(), 'utf8')).answers.length, 1);
  await refused.unroute('**/api/answers');
  await refused.getByRole('button', { name: 'Try again' }).click();
  await refused.getByRole('heading', { name: 'Question 2' }).waitFor();
  await server.stop();
});

test('a question left open for days is answered and holds nothing up', async () => {
  const server = await serve('late');
  const context = await browser.newContext();
  await context.addInitScript(() => {
    const now = performance.now.bind(performance);
    window.later = 0;
    performance.now = () => now() + window.later;
  });
  const page = await tab(context, server.address);
  await begin(page);
  await answer(page, 'L');
  await ready(page);
  await page.evaluate(() => { window.later = 2 * 86400000; });
  for (const choice of CHOICES) await answer(page, choice);
  await page.getByText('C0DE-42').waitFor();
  const times = rows(await server.export()).map((line) => Number(line.rt_ms));
  assert.ok(times.length === MOST && times[0] === 86400000 && times[1] < 60000, `${times}`);
  await server.stop();
});

test('two tabs of one participant give one form', async () => {
  const server = await serve('tabs');
  for (const address of [server.address, `${pathToFileURL(path.join(out, 'bundle/index.html')).href}?form=2`]) {
    const one = await open(address);
    await begin(one);
    await answer(one, 'L');
    const two = await tab(one.context(), address);
    const given = [];
    for (const [i, choice] of CHOICES.entries()) {
      const [here, there] = i % 2 ? [two, one] : [one, two];
      // The other tab shows what this one does.
      await there.getByRole('heading', { name: `Question ${i + 1}` }).waitFor();
      await here.bringToFront();
      given.push(await answer(here, choice));
    }
    for (const page of [one, two]) await page.getByRole('heading', { name: 'Thank you' }).waitFor();
    if (address === server.address) {
      assert.deepEqual(rows(await server.export()).map(asGiven), given);
    } else {
      const download = two.waitForEvent('download');
      await two.getByRole('link', { name: 'Download CSV' }).click();
      assert.deepEqual(rows(fs.readFileSync(await (await download).path(), 'utf8')).map(asGiven), given);
    }
  }
  await server.stop();
});

test('a place that was answered otherwise in another browser is left as it was', async () => {
  const server = await serve('elsewhere');
  const address = `${server.address}?PROLIFIC_PID=5f9&STUDY_ID=61a&SESSION_ID=s1`;
  const [here, there] = [await open(address), await open(address)];
  for (const page of [here, there]) {
    await begin(page);
    await answer(page, 'L');
  }
  const given = [await answer(here, 'L'), await answer(here, 'NP')];
  await answer(there, 'R');
  await there.getByRole('heading', { name: 'Question 3' }).waitFor();
  for (const choice of CHOICES.slice(2)) given.push(await answer(there, choice));
  await there.getByText('C0DE-42').waitFor();
  assert.deepEqual(rows(await server.export()).map(asGiven), given);
  await here.reload();
  assert.match(await here.locator('h2').textContent(), /Question 3/);
  await answer(here, 'R');
  await here.getByText('C0DE-42').waitFor();
  assert.deepEqual(rows(await server.export()).map(asGiven), given);
  await server.stop();
});

test('a number in the address is of the first participant alone', async () => {
  const page = await open(`${pathToFileURL(path.join(out, 'bundle/index.html')).href}?form=3`);
  assert.equal(await page.getByLabel(/Your number/).isVisible(), false);
  await begin(page);
  await all(page, 'mouse');
  page.on('dialog', (dialog) => dialog.accept());
  await page.getByRole('button', { name: 'Next participant' }).click();
  await page.getByLabel(/Your number/).fill('4');
  await begin(page);
  assert.equal(await page.evaluate(() => JSON.parse(Object.values(localStorage)[0]).form.form), 4);
});

test('reduced motion stands still until it is played', async () => {
  const page = await open(pathToFileURL(path.join(out, 'bundle/index.html')).href, { reducedMotion: 'reduce' });
  await page.getByLabel(/Your number/).fill('1');
  await begin(page);
  await page.getByRole('button', { name: 'Play' }).waitFor();
  await page.waitForTimeout(700);
  assert.equal(await page.locator('.pair img').isVisible(), false);
  await page.keyboard.press('1');
  await page.getByText('Please play one whole turn first.').waitFor();
  await page.getByRole('button', { name: 'Play' }).click();
  await answer(page, 'L');
});

test('accessible, and fit for a phone', async () => {
  const server = await serve('phone');
  for (const viewport of [{ width: 360, height: 640 }, { width: 1280, height: 800 }]) {
    const page = await open(server.address, { viewport });
    const judge = async (where) => {
      await page.evaluate(axe);
      const { violations } = await page.evaluate(() => window.axe.run());
      const serious = violations.filter((found) => ['serious', 'critical'].includes(found.impact));
      assert.deepEqual(serious.map((found) => `${where}: ${found.id}: ${found.help}`), []);
      const wide = await page.evaluate(() => document.documentElement.scrollWidth - window.innerWidth);
      assert.ok(wide <= 0, `${where} is ${wide} px too wide`);
    };
    await judge('consent');
    await page.getByRole('button', { name: 'I agree, begin' }).click();
    await judge('instructions');
    await page.getByRole('button', { name: 'Go on' }).click();
    await judge('a locked question');
    await ready(page);
    await judge('an open question');
    const low = await page.locator('[data-choice="R"]').evaluate((button) => button.getBoundingClientRect().bottom);
    assert.ok(low <= viewport.height, 'the answers are on the screen');
    if (process.env.PICTURES) await page.screenshot({ path: path.join(process.env.PICTURES, `question-${viewport.width}.png`) });
    await all(page, 'mouse');
    await page.getByText('All your answers are saved').waitFor();
    await judge('the end');
  }
  const page = await open(`${server.address}researcher`);
  await page.getByLabel('Token').fill(TOKEN);
  await page.getByRole('button', { name: 'Show' }).click();
  await page.locator('#stand').waitFor();
  await page.evaluate(axe);
  const { violations } = await page.evaluate(() => window.axe.run());
  assert.deepEqual(violations.filter((found) => ['serious', 'critical'].includes(found.impact)).map((found) => found.id), []);
  if (process.env.PICTURES) await page.screenshot({ path: path.join(process.env.PICTURES, 'researcher.png'), fullPage: true });
  await server.stop();
});

test('pair and answers fit the window, and the arrow down answers only where they do', async () => {
  const address = `${pathToFileURL(path.join(out, 'bundle/index.html')).href}?form=1`;
  const sizes = [[1366, 625], [1280, 600], [1024, 700], [1920, 1080], [667, 375], [375, 667], [360, 640], [320, 568], [568, 320]];
  for (const [width, height] of sizes) {
    const page = await open(address, { viewport: { width, height } });
    await begin(page);
    await ready(page);
    const box = await page.locator('.choices').boundingBox();
    assert.ok(box.y >= 0 && box.y + box.height <= height, `answers end at ${box.y + box.height} of ${width} x ${height}`);
    const picture = await page.locator('.pair img').boundingBox();
    assert.ok(picture.height >= 80 && picture.y + picture.height <= box.y, `${picture.height} px of picture at ${width} x ${height}`);
    if (process.env.PICTURES) await page.screenshot({ path: path.join(process.env.PICTURES, `fit-${width}x${height}.png`) });
    await answer(page, 'NP', { NP: 'ArrowDown' });
    await page.context().close();
  }
  const page = await open(address, { viewport: { width: 320, height: 180 } });
  await begin(page);
  await ready(page);
  await page.keyboard.press('ArrowDown');
  assert.match(await page.locator('h2').textContent(), /Practice 1/);
  await page.waitForFunction(() => window.scrollY > 0);
  await page.locator('.choices').scrollIntoViewIfNeeded();
  await page.evaluate(() => window.scrollTo(0, document.body.scrollHeight));
  await answer(page, 'NP', { NP: 'ArrowDown' });
});

test('three robots with known preferences, and the analysis finds them', async () => {
  const server = await serve('robots');
  const key = new Map(rows(fs.readFileSync(path.join(out, 'key/stimuli.csv'), 'utf8')).map((line) => [path.basename(line.file, '.gif'), line]));
  await Promise.all([0, 1, 2].map(async () => {
    const page = await open(server.address);
    await begin(page);
    for (let i = 0; i <= MOST; i += 1) {
      await ready(page);
      const { left, right } = key.get(await shown(page));
      await answer(page, left === right ? 'NP' : left.endsWith('bi') ? 'L' : 'R');
    }
    await page.getByText('All your answers are saved').waitFor();
  }));
  const answers = path.join(folder, 'robots.csv');
  fs.writeFileSync(answers, await server.export());
  await server.stop();
  const result = path.join(folder, 'robots');
  run('analyse', config, '--responses', answers, '--out', result);
  const groups = rows(fs.readFileSync(path.join(result, 'tables/preference_groups.csv'), 'utf8'));
  const wins = Object.fromEntries(groups.map((line) => [line.configuration, [line.wins, line.answers]]));
  assert.deepEqual(wins, { bu: ['0', '6'], bi: ['6', '6'] });
});
