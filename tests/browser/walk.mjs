// What tests of the questionnaire share: studies, servers, browsers, and people who answer.
// scripts/test-browser.sh sets ISOSTUDY (the program), CHROMIUM and MODULES.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import fs from 'node:fs';
import { createRequire } from 'node:module';
import os from 'node:os';
import path from 'node:path';
import { after } from 'node:test';
import { fileURLToPath } from 'node:url';

const { ISOSTUDY, CHROMIUM, MODULES } = process.env;
const require = createRequire(path.join(MODULES, 'package.json'));
const { chromium } = require('playwright-core');
const axe = fs.readFileSync(require.resolve('axe-core/axe.min.js'), 'utf8');

export const root = path.resolve(path.dirname(fileURLToPath(import.meta.url)), '../..');
/** Of one file of tests, gone after it. */
export const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'isostudy-'));
export const TOKEN = 'a-token-for-this-test';
/** Questions of a form, and what is answered to them after the practice. */
export const MOST = 6;
export const CHOICES = ['L', 'R', 'NP', 'R', 'L', 'NP'];
export const PHONE = { viewport: { width: 390, height: 844 }, deviceScaleFactor: 3, hasTouch: true, isMobile: true };

export const browser = await chromium.launch({
  executablePath: CHROMIUM,
  args: ['--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync'],
});
const children = new Set();
after(async () => {
  await browser.close();
  for (const child of children) child.kill('SIGKILL');
  fs.rmSync(folder, { recursive: true });
});

export function run(...words) {
  const done = spawnSync(ISOSTUDY, words, { encoding: 'utf8' });
  assert.equal(done.status, 0, done.stderr);
  return done.stdout;
}

/** A server of a bundled study, its answers in a folder of that name; on a free port if none is said. */
export async function serve({ config, out, words = [] }, name, port = '0') {
  const answers = path.join(folder, name);
  const child = spawn(ISOSTUDY, ['serve', config, '--out', out, '--answers', answers, '--port', port, '--admin-token', TOKEN, ...words], { stdio: ['ignore', 'ignore', 'pipe'] });
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
    said: () => said,
    export: async (file = 'answers.csv') => {
      const response = await fetch(`${address}api/admin/${file}`, { headers: { authorization: `Bearer ${TOKEN}` } });
      assert.equal(response.status, 200);
      return response.text();
    },
    stop: (signal = 'SIGTERM') => { child.kill(signal); return ended; },
  };
}

/** The small study of two methods, changed, and bundled under this name with more words. Its animations are small and quick. */
export function questionnaire(name, change = (text) => text, ...words) {
  const study = { config: path.join(folder, `${name}.toml`), out: path.join(folder, `${name}-results`), words };
  const text = fs.readFileSync(path.join(root, 'configs/two-methods.toml'), 'utf8')
    .replace('width = 320', 'width = 128').replace('height = 320', 'height = 128').replace('frames = 72', 'frames = 4')
    .replace('duration_s = 5.76', 'duration_s = 0.4').replaceAll('stimulus_spacing = 0.08', 'stimulus_spacing = 0.2')
    .replace('"cpu/', `"${root}/configs/cpu/`).replace('max_questions = 6', 'max_questions = 6\npage_scale = 4\ncompletion = "C0DE-42"');
  fs.writeFileSync(study.config, change(text));
  run('bundle', study.config, '--out', study.out, ...words);
  return { ...study, serve: (...words) => serve(study, ...words) };
}

export const rows = (csv) => {
  const [header, ...lines] = csv.trim().split(/\r?\n/).map((line) => line.split(','));
  return lines.map((cells) => Object.fromEntries(header.map((name, i) => [name, cells[i]])));
};
export const asGiven = (line) => ({ code: line.stimulus, choice: line.choice });

/** A page on which nothing goes wrong and nobody else is asked for anything, in a browser of its own. */
export async function open(address, options = {}) {
  return tab(await browser.newContext({ acceptDownloads: true, ...options }), address);
}

/** One more page in a browser. */
export async function tab(context, address) {
  const page = await context.newPage();
  page.on('pageerror', (error) => { throw error; });
  page.on('request', (request) => {
    const asked = new URL(request.url());
    assert.ok(['file:', 'blob:', 'data:'].includes(asked.protocol) || asked.origin === new URL(address).origin, request.url());
  });
  await page.goto(address);
  return page;
}

export const begin = async (page) => {
  await page.getByRole('button', { name: 'I agree, begin' }).click();
  await page.getByRole('button', { name: 'Go on' }).click();
};
export const shown = (page) => page.locator('.pair').getAttribute('data-code');
export const ready = (page) => page.locator('.choices button:not([aria-disabled])').first().waitFor();

/** Answers the pair on the screen, and returns what it was. */
export async function answer(page, choice, how = 'mouse') {
  const title = await page.locator('h2').textContent();
  await ready(page);
  const code = await shown(page);
  if (how === 'mouse') await page.locator(`[data-choice="${choice}"]`).click();
  else await page.keyboard.press(how[choice]);
  await page.waitForFunction((old) => document.querySelector('h2').textContent !== old, title);
  return { code, choice };
}

/** Answers the practice and all questions, and returns the latter. */
export async function all(page, how) {
  await answer(page, 'L', how);
  const given = [];
  for (const choice of CHOICES) given.push(await answer(page, choice, how));
  return given;
}

/** Pixels by which a page is too wide. A phone's window grows with the page, so the screen is what counts. */
export const over = (page) => page.evaluate((width) => document.documentElement.scrollWidth - width, page.viewportSize().width);

/** What axe calls serious on a page. */
export async function serious(page) {
  await page.evaluate(axe);
  const { violations } = await page.evaluate(() => window.axe.run());
  return violations.filter((found) => ['serious', 'critical'].includes(found.impact)).map((found) => `${found.id}: ${found.help}`);
}
