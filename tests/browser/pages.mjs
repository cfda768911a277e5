// index.html and report.html of the quick study in a real browser: widths of a phone, a laptop and a large screen, light and dark.
// Run by scripts/test-browser.sh, which sets ISOSTUDY (the program), CHROMIUM and MODULES; PAGES is a folder of results to test instead.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import { createRequire } from 'node:module';
import os from 'node:os';
import path from 'node:path';
import test, { after, before } from 'node:test';
import { fileURLToPath, pathToFileURL } from 'node:url';

const { ISOSTUDY, CHROMIUM, MODULES, PAGES, PICTURES } = process.env;
const require = createRequire(path.join(MODULES, 'package.json'));
const { chromium } = require('playwright-core');
const axe = fs.readFileSync(require.resolve('axe-core/axe.min.js'), 'utf8');

const root = path.resolve(path.dirname(fileURLToPath(import.meta.url)), '../..');
const folder = PAGES ?? fs.mkdtempSync(path.join(os.tmpdir(), 'isostudy-pages-'));
const WIDTHS = [390, 1280, 1920];

let browser;
before(async () => {
  if (!PAGES) {
    const done = spawnSync(ISOSTUDY, ['study', path.join(root, 'configs/quick.toml'), '--out', folder], { encoding: 'utf8' });
    assert.equal(done.status, 0, done.stderr);
  }
  browser = await chromium.launch({
    executablePath: CHROMIUM,
    args: ['--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync'],
  });
});
after(async () => {
  await browser?.close();
  if (!PAGES) fs.rmSync(folder, { recursive: true });
});

/** A page of the study. Nothing goes wrong on it, and it asks for nothing but its own files. */
async function open(file, width, colorScheme, options = {}) {
  const context = await browser.newContext({ viewport: { width, height: 844 }, colorScheme, ...options });
  const page = await context.newPage();
  page.on('pageerror', (error) => { throw error; });
  page.on('request', (request) => assert.ok(['file:', 'data:'].includes(new URL(request.url()).protocol), request.url()));
  await page.goto(pathToFileURL(path.join(folder, file)).href);
  return page;
}

/** Everything that is open must fit, be told in words, and have no violation. Returns what does not, a line each. */
async function faults(page, rules = {}) {
  const measured = await page.evaluate(() => {
    const found = [];
    const name = (element) => `${element.tagName.toLowerCase()}.${element.getAttribute('class') ?? ''}: ${element.textContent.trim().slice(0, 40)}`;
    const shown = (element) => element.getClientRects().length > 0;
    const region = (element) => element.closest('[role="region"][tabindex="0"][aria-label]:not([aria-label=""])');
    if (document.documentElement.scrollWidth > innerWidth) found.push(`too wide: the page by ${document.documentElement.scrollWidth - innerWidth} px`);
    for (const element of document.body.querySelectorAll('*')) {
      if (!shown(element) || element.closest('svg')) continue;
      const own = region(element);
      if (element.getBoundingClientRect().right > innerWidth + 0.5 && !own) found.push(`too wide: ${name(element)}`);
      const scrolls = getComputedStyle(element).overflowX !== 'visible' && element.scrollWidth > element.clientWidth + 1;
      if (scrolls && own !== element && !['INPUT', 'HTML', 'BODY'].includes(element.tagName)) found.push(`too wide inside: ${name(element)}`);
    }
    for (const cell of document.querySelectorAll('td.verdict')) {
      if (!shown(cell)) {
        if (!cell.closest('details:not([open])')) found.push(`verdict not seen: ${name(cell)}`);
        continue;
      }
      const box = cell.getBoundingClientRect();
      const words = document.createRange();
      words.selectNodeContents(cell);
      const text = words.getBoundingClientRect();
      const inside = box.left >= 0 && box.right <= innerWidth && text.width > 0 && text.right <= box.right + 0.5;
      if (!inside || region(cell) || cell.textContent.trim() === '') found.push(`verdict not seen: ${name(cell)}`);
    }
    for (const image of document.querySelectorAll('img')) {
      if (!image.alt.trim()) found.push(`no label: img ${image.getAttribute('src')?.slice(0, 60)}`);
      if (!image.getAttribute('width') || !image.getAttribute('height')) found.push(`no size: img ${image.alt.slice(0, 40)}`);
    }
    for (const drawing of document.querySelectorAll('svg')) {
      const labelled = drawing.closest('[role="img"][aria-label]');
      if (!labelled?.getAttribute('aria-label').trim()) found.push('no label: svg');
    }
    return found;
  });
  // The rows of a table are of one kind; of thousands of them a few are enough to judge.
  await page.evaluate(() => {
    for (const body of document.querySelectorAll('tbody')) [...body.rows].slice(4).forEach((row) => row.remove());
    document.querySelectorAll('.plot svg > *, dl.words > :nth-child(n+9)').forEach((element) => element.remove());
  });
  await page.evaluate(axe);
  const { violations } = await page.evaluate((run) => window.axe.run(document, run), rules);
  return [...measured, ...violations.map((found) => `axe: ${found.id}: ${found.nodes[0].target.join(' ')}`)];
}

const openAll = (page) => page.evaluate(() => document.querySelectorAll('details').forEach((section) => { section.open = true; }));

for (const file of ['index.html', 'report.html']) {
  for (const width of WIDTHS) {
    for (const scheme of ['light', 'dark']) {
      test(`${file} at ${width} px, ${scheme}`, async () => {
        const page = await open(file, width, scheme);
        if (PICTURES) await page.screenshot({ path: path.join(PICTURES, `${file}-${width}-${scheme}.png`) });
        const verdicts = await page.locator('td.verdict').count();
        assert.ok(verdicts > 40, `${verdicts} verdicts`);
        await openAll(page);
        assert.deepEqual(await faults(page), []);
        assert.ok(await page.locator('img').count() >= 6, 'the methods are shown');
        await page.context().close();
      });
    }
  }
}

test('who asks for dark gets dark, and who asks for no motion gets none', async () => {
  const colour = (page) => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  const [light, dark] = [await open('report.html', 1280, 'light'), await open('report.html', 1280, 'dark')];
  assert.equal(await colour(light), 'rgb(255, 255, 255)');
  assert.ok((await colour(dark)).match(/\d+/g).every((part) => Number(part) < 60));
  const motion = (page) => page.evaluate(() => getComputedStyle(document.documentElement).scrollBehavior);
  const still = await open('report.html', 1280, 'light', { reducedMotion: 'reduce' });
  assert.deepEqual([await motion(light), await motion(still)], ['smooth', 'auto']);
  for (const page of [light, dark, still]) await page.context().close();
});

test('the first screen says what was compared and what came out', async () => {
  for (const file of ['index.html', 'report.html']) {
    const page = await open(file, 1280, 'light');
    const said = await page.locator('dl.summary dt').allTextContents();
    assert.deepEqual(said, ['Compared', 'By whom', 'Found', 'How sure', 'Limits', 'Next']);
    const bottom = await page.locator('dl.summary').evaluate((list) => list.getBoundingClientRect().bottom);
    assert.ok(bottom < 844, `${file}: the abstract ends at ${bottom} px`);
    const order = await page.evaluate(() => {
      const picture = document.querySelector('.methods img').getBoundingClientRect();
      return picture.top < document.querySelector('nav').getBoundingClientRect().top && picture.top < innerHeight;
    });
    assert.ok(order, 'the picture of the methods is on the first screen');
    await page.context().close();
  }
});

test('tables can be found by a word and opened together', async () => {
  for (const file of ['index.html', 'report.html']) {
    const page = await open(file, 1280, 'light');
    const tables = page.locator('details.data');
    const all = await tables.count();
    assert.ok(all > 15);
    await page.getByRole('button', { name: 'Open all tables' }).click();
    assert.equal(await page.locator('details.data[open]').count(), all);
    await page.getByLabel('Find in the tables').fill('edge collapse');
    const seen = await page.locator('details.data:not([hidden])').count();
    assert.ok(seen > 0 && seen < all, `${seen} of ${all}`);
    assert.equal(await page.locator('.tools output').textContent(), `${seen} of ${all} tables`);
    const rows = await page.locator('details.data:not([hidden]) tbody tr:not([hidden])').allTextContents();
    const named = await page.locator('details.data:not([hidden]) summary').allTextContents();
    assert.ok(rows.length > 0 && !named.some((name) => name.includes('edge collapse')) && rows.every((row) => row.toLowerCase().includes('edge collapse')));
    await page.getByLabel('Find in the tables').fill('');
    assert.equal(await page.locator('details.data[hidden], tr[hidden]').count(), 0);
    await page.getByRole('button', { name: 'Close all tables' }).click();
    assert.equal(await page.locator('details.data[open]').count(), 0);
    await page.context().close();
  }
});

// Each kind of fault, planted: a check that cannot fail is none.
for (const [kind, start, plant] of [
  ['a box wider than its page', 'too wide: ', () => { document.querySelector('dl.summary').style.minWidth = '2400px'; }],
  ['a table that scrolls unseen', 'too wide inside: ', () => { Object.assign(document.querySelector('.fit').style, { width: '200px', overflowX: 'hidden', whiteSpace: 'nowrap' }); }],
  ['a verdict beyond the edge', 'verdict not seen: ', () => { Object.assign(document.querySelector('.fit').style, { transform: 'translateX(-900px)' }); }],
  ['a verdict in a region that scrolls', 'verdict not seen: ', () => { Object.assign(document.querySelector('.fit'), { role: 'region', tabIndex: 0, ariaLabel: 'x' }); }],
  ['a picture without a label', 'no label: img', () => { document.querySelector('.methods img').alt = ''; }],
  ['a drawing without a label', 'no label: svg', () => { document.querySelectorAll('[role="img"]').forEach((of) => of.removeAttribute('aria-label')); }],
  ['a picture without a size', 'no size: ', () => { document.querySelector('.methods img').removeAttribute('width'); }],
  ['a button without a name', 'axe: button-name', () => { document.body.querySelector('main').append(document.createElement('button')); }],
  ['words that hardly stand out', 'axe: color-contrast', () => { document.querySelector('dl.summary dd').style.color = '#bbb'; }],
]) {
  test(`the check speaks up at ${kind}`, async () => {
    const page = await open('report.html', 1280, 'light');
    await page.evaluate(plant);
    const found = await faults(page);
    assert.ok(found.some((fault) => fault.startsWith(start)), found.join('\n'));
    await page.context().close();
  });
}
