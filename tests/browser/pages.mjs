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
const HEIGHTS = { 390: 844, 1280: 900 };

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
  const context = await browser.newContext({ viewport: { width, height: HEIGHTS[width] ?? 844 }, colorScheme, ...options });
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
    const text = document.body.innerText;
    if (text.includes('`')) found.push(`a mark of Markdown: ${text.slice(text.indexOf('`') - 40, text.indexOf('`') + 40)}`);
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
        const methods = page.locator('.fit.methods').first();
        if (await methods.count()) assert.ok((await methods.boundingBox()).width > 0.8 * Math.min(width, 1160) - 40, 'the table of methods has the width');
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

for (const file of ['index.html', 'report.html']) {
  for (const width of [390, 1280]) {
    test(`the first screen of ${file} has the finding and one chart (${width} px)`, async () => {
      const page = await open(file, width, 'light');
      const height = HEIGHTS[width];
      const title = await page.locator('h1').textContent();
      const finding = await page.locator('.finding').textContent();
      assert.match(finding, /^People preferred .*\.$/);
      assert.ok((await page.title()).includes(title));
      // Nothing on the first screen is larger than the finding.
      const sizes = await page.evaluate(() => {
        const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
        const found = { finding: 0, others: 0 };
        for (let node = texts.nextNode(); node; node = texts.nextNode()) {
          const { parentElement } = node;
          if (!node.textContent.trim() || parentElement.closest('svg, script, style')) continue;
          if (parentElement.getClientRects().length === 0 || parentElement.getBoundingClientRect().top > innerHeight) continue;
          const of = parentElement.matches('.finding') ? 'finding' : 'others';
          found[of] = Math.max(found[of], parseFloat(getComputedStyle(parentElement).fontSize));
        }
        return found;
      });
      assert.ok(sizes.finding > 1.2 * sizes.others, JSON.stringify(sizes));
      const box = (of) => page.locator(of).first().evaluate((element) => element.getBoundingClientRect().toJSON());
      const [said, way, chart, pictures] = [await box('.finding'), await box('.ways a[href="#decision"]'), await box('.overview .plot'), await box('.methods')];
      assert.ok(said.bottom < way.top && way.bottom < chart.top, 'the finding, the way to the table of choices, the chart');
      assert.ok(chart.height > 100 && chart.bottom <= height, `the chart ends at ${chart.bottom} px`);
      assert.ok(pictures.top > chart.bottom, 'the methods come after the chart');
      if (width > 700) {
        const order = await page.evaluate(() => document.querySelector('.methods img').getBoundingClientRect().top < innerHeight);
        assert.ok(order, 'the picture of the methods is on the first screen');
      }
      const labels = await page.locator('dl.summary dt').allTextContents();
      assert.deepEqual(labels.filter((label) => label !== 'Times'), ['Compared', 'By whom', 'Found', 'How sure', 'Limits', 'Next']);
      await page.locator('.ways a[href="#decision"]').click();
      await page.waitForFunction(() => document.querySelector('#decision').getBoundingClientRect().top < 200);
      const table = await box('.fit.choices');
      assert.ok(table.top < height, 'the table of choices is where the way leads');
      const whole = await page.evaluate(() => document.documentElement.scrollWidth);
      assert.ok(whole <= width, `the page is ${whole} px wide`);
      const lefts = await page.evaluate(() => [...document.querySelectorAll('ul.methods li')].map((of) => {
        return of.querySelector('code').getBoundingClientRect().left - of.getBoundingClientRect().left;
      }));
      assert.equal(new Set(lefts.map(Math.round)).size, 1, `codes of methods begin at ${lefts}`);
      await page.context().close();
    });
  }

  test(`a phone shows the first of each section of ${file}, and the rest when asked`, async () => {
    const height = (page) => page.evaluate(() => document.documentElement.scrollHeight);
    const page = await open(file, 390, 'light');
    const rests = page.locator('details.rest');
    assert.ok(await rests.count() >= 2);
    assert.equal(await page.locator('details.rest[open]').count(), 0);
    const before = await height(page);
    const first = rests.first();
    await first.locator('> summary').click();
    assert.ok(await first.evaluate((of) => of.open));
    assert.ok(await height(page) > before);
    // A link into what is closed opens it.
    const last = rests.last();
    await last.evaluate((of) => { of.lastElementChild.id = 'there'; location.hash = '#there'; });
    await page.waitForFunction(() => document.querySelector('#there').closest('details').open);
    const printed = await open(file, 390, 'light');
    await printed.evaluate(() => dispatchEvent(new Event('beforeprint')));
    assert.equal(await printed.locator('details.rest:not([open])').count(), 0, 'paper shows all');
    const wide = await open(file, 1280, 'light');
    assert.equal(await wide.locator('details.rest:not([open])').count(), 0, 'a wide screen shows all');
    assert.equal(await wide.locator('details.rest > summary:visible').count(), 0);
    for (const of of [page, printed, wide]) await of.context().close();
  });

  test(`on a phone no word of ${file} is broken, and figures can be read`, async () => {
    const page = await open(file, 390, 'light');
    const broken = await page.evaluate(() => {
      const found = [];
      for (const cell of document.querySelectorAll('.fit.choices td, .fit.choices th, .fit.decision td, .fit.decision th, .methods span')) {
        if (cell.getClientRects().length === 0) continue;
        const texts = document.createTreeWalker(cell, NodeFilter.SHOW_TEXT);
        for (let node = texts.nextNode(); node; node = texts.nextNode()) {
          for (const { 0: word, index } of node.textContent.matchAll(node.parentElement.matches('.code') ? /.+/gu : /[\p{L}\p{N}_]+/gu)) {
            const range = document.createRange();
            range.setStart(node, index);
            range.setEnd(node, index + word.length);
            if (new Set([...range.getClientRects()].map(({ top }) => Math.round(top))).size > 1) found.push(word);
          }
        }
      }
      return found;
    });
    assert.deepEqual(broken, []);
    if (file === 'index.html') {
      const images = await page.evaluate(async () => {
        const all = [...document.querySelectorAll('.plot img')];
        for (const image of all) image.loading = 'eager';
        await Promise.all(all.map((image) => image.decode()));
        return all.map((image) => ({ source: image.currentSrc.split('/').pop(), scale: image.clientWidth / image.naturalWidth, natural: image.naturalWidth }));
      });
      assert.ok(images.length >= 14);
      for (const { source, scale, natural } of images) {
        // The smallest letters have 12 units: see `figures/draft.rs` of isostudy-report.
        assert.ok(source.endsWith('-narrow.svg') && natural <= 390 && 12 * scale >= 11, `${source}: ${natural} px at ${scale}`);
      }
    } else {
      const figures = await page.evaluate(() => [...document.querySelectorAll('.plot')].map((plot) => {
        for (const section of [plot.closest('details')]) if (section) section.open = true;
        const shown = [...plot.querySelectorAll('svg')].filter((svg) => svg.getClientRects().length > 0);
        const scale = shown[0].getScreenCTM().a;
        const texts = [...shown[0].querySelectorAll('text')].map((text) => scale * Number(text.getAttribute('font-size')));
        const boxes = [...shown[0].querySelectorAll('text, rect, polygon, polyline, circle')].map((of) => of.getBoundingClientRect());
        return { shown: shown.length, least: Math.min(...texts), left: Math.min(...boxes.map((of) => of.left)), right: Math.max(...boxes.map((of) => of.right)) };
      }));
      assert.ok(figures.length >= 14);
      for (const { shown, least, left, right } of figures) {
        assert.ok(shown === 1 && least >= 11 && left >= 0 && right <= 390, JSON.stringify({ shown, least, left, right }));
      }
    }
    await page.context().close();
  });
}

test('figures are dark on a dark page, and their words stand out', async () => {
  const luminance = (channels) => {
    const [r, g, b] = channels.map((c) => (c / 255 <= 0.04045 ? c / 255 / 12.92 : ((c / 255 + 0.055) / 1.055) ** 2.4));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const contrast = (a, b) => {
    const [low, high] = [luminance(a), luminance(b)].sort((x, y) => x - y);
    return (high + 0.05) / (low + 0.05);
  };
  const channels = (colour) => colour.match(/\d+/g).slice(0, 3).map(Number);
  for (const scheme of ['light', 'dark']) {
    const report = await open('report.html', 1280, scheme);
    const paper = channels(await report.evaluate(() => getComputedStyle(document.body).backgroundColor));
    const drawn = await report.evaluate(() => [...document.querySelectorAll('.plot .wide svg')].map((svg) => {
      const fill = (of) => getComputedStyle(of).fill;
      const [under, ...others] = svg.querySelectorAll('rect');
      // What is printed on bars is judged by `palette.rs` of isostudy-report.
      const boxes = others.map((of) => of.getBoundingClientRect());
      const isOnBar = (text) => {
        const { left, right, top, bottom } = text.getBoundingClientRect();
        return boxes.some((box) => box.left < right && left < box.right && box.top < bottom && top < box.bottom);
      };
      return { paper: fill(under), texts: [...svg.querySelectorAll('text')].filter((text) => !isOnBar(text)).map(fill) };
    }));
    assert.ok(drawn.length >= 14);
    let texts = 0;
    for (const figure of drawn) {
      assert.deepEqual(channels(figure.paper), paper, scheme);
      for (const text of figure.texts) assert.ok(contrast(channels(text), paper) >= 4.5, `${text} in ${scheme}`);
      texts += figure.texts.length;
    }
    assert.ok(texts > 200, `${texts}`);
    await report.context().close();
    // In an img, too.
    const index = await open('index.html', 1280, scheme);
    const image = index.locator('.overview img');
    await image.evaluate((of) => of.decode());
    const corner = await index.evaluate(async (base64) => {
      const picture = await createImageBitmap(await (await fetch(`data:image/png;base64,${base64}`)).blob());
      const context = new OffscreenCanvas(picture.width, picture.height).getContext('2d');
      context.drawImage(picture, 0, 0);
      return [...context.getImageData(2, 2, 1, 1).data].slice(0, 3);
    }, (await image.screenshot()).toString('base64'));
    assert.deepEqual(corner, paper, scheme);
    await index.context().close();
  }
});

test('pairs are loaded when a section is opened, and begin together', async () => {
  const page = await open('index.html', 1280, 'light');
  const section = page.locator('#pairs ~ details').first();
  assert.equal(await section.locator('img[src]').count(), 0);
  const begun = await section.evaluate((details) => new Promise((resolve) => {
    const images = details.querySelectorAll('img');
    const observer = new MutationObserver((changes) => {
      const set = changes.filter(({ attributeName }) => attributeName === 'src').length;
      if (set > 0) resolve([set, images.length]);
    });
    observer.observe(details, { attributes: true, subtree: true });
    details.open = true;
  }));
  assert.ok(begun[0] === begun[1] && begun[0] >= 3, `${begun[0]} of ${begun[1]} begin at once`);
  const captions = await section.locator('figcaption').allTextContents();
  for (const caption of captions) assert.match(caption, /^Question \d+, .+ \(left\) beside .+: \d+ left, \d+ right, \d+ no preference \w+_\w+ \| \w+_\w+$/);
  assert.equal(await page.locator('#turntables ~ details').first().locator('img[src]').count(), 0);
  await page.context().close();
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
