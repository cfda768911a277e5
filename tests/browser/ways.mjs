// Each way to ask, by mouse and by keyboard, on a phone. Run by scripts/test-browser.sh.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import test from 'node:test';
import { pathToFileURL } from 'node:url';
import { MOST, PHONE, answer, asGiven, begin, folder, open, questionnaire, ready, rows, run, serious } from './walk.mjs';

const CHOICES = 'choices = ["Left", "No preference", "Right"]';
/** The small study, asked in a way. */
const asking = (name, keys, change = (text) => text) => questionnaire(name, (text) => {
  assert.ok(text.includes(CHOICES));
  return change(text.replace(CHOICES, keys));
});
/** Four methods instead of two, and no controls. */
const several = (text) => text.replace('controls = 2', 'controls = 0').replace('arrangements = ["body-centred"]', 'arrangements = ["body-centred", "simple-cubic"]')
  .replace(/comparisons = \[[^]*?\n\]/, `comparisons = [\n${['ss', 'as'].flatMap((object, o) => [['bu', 'bi'], ['su', 'si'], ['bu', 'su'], ['bi', 'si'], ['bu', 'si'], ['bi', 'su']].map(([left, right], i) => `  { question = "Q${6 * o + i + 1}", left = "${object}_${left}", right = "${object}_${right}" },`)).join('\n')}\n]`)
  .replace('members = ["bu", "bi"]', 'members = ["bu", "bi", "su", "si"]');

/** What is said in a question: its buttons, without the names of keys. */
const buttons = (page) => page.locator('.choices button > span').allTextContents();

/** A question fits a window, and says nothing that axe calls serious. */
async function fits(page, where) {
  assert.deepEqual(await serious(page), [], where);
  const [wide, high] = await page.evaluate(() => [document.documentElement.scrollWidth - window.innerWidth, document.documentElement.scrollHeight - window.innerHeight]);
  assert.ok(wide <= 0 && high <= 0, `${where}: ${wide} px too wide, ${high} px too high`);
  for (const button of await page.locator('.choices button').all()) {
    const { width, height, within } = await button.evaluate((one) => ({
      width: one.offsetWidth, height: one.offsetHeight, within: one.scrollWidth <= one.clientWidth + 1 && one.scrollHeight <= one.clientHeight + 1,
    }));
    assert.ok(width >= 24 && height >= 36 && within, `${where}: a button of ${width} x ${height}`);
  }
}

/** One person answers a form by mouse at a server, and one by keys; both arrive as they were given. Then one from a folder. */
async function walk(made, name, codes, named, { asked = MOST, practice = 1 } = {}) {
  const answers = Array.from({ length: asked }, (_, i) => codes[(i * 3 + 1) % codes.length]);
  const keys = Object.fromEntries(codes.map((code, i) => [code, String(i + 1)]));
  const form = async (page, how) => {
    for (let i = 0; i < practice; i += 1) await answer(page, codes[0], how);
    const given = [];
    for (const choice of answers) given.push(await answer(page, choice, how));
    return given;
  };
  const server = await made.serve(name);
  const mouse = await open(server.address, PHONE);
  await begin(mouse);
  await ready(mouse);
  assert.deepEqual(await buttons(mouse), named);
  await fits(mouse, `${name}, a question`);
  const byMouse = await form(mouse, 'mouse');
  await mouse.getByText('C0DE-42').waitFor();
  const keyboard = await open(server.address, { viewport: { width: 390, height: 844 } });
  await begin(keyboard);
  await ready(keyboard);
  // A key that is no answer changes nothing.
  await keyboard.keyboard.press(String(codes.length + 1));
  assert.match(await keyboard.locator('h2').textContent(), /Practice 1/);
  const second = await form(keyboard, keys);
  await keyboard.getByText('C0DE-42').waitFor();
  const lines = rows(await server.export());
  assert.deepEqual(lines.map(asGiven), [...byMouse, ...second]);
  await server.stop();

  const page = await open(`${pathToFileURL(path.join(made.out, 'bundle/index.html')).href}?form=2`, PHONE);
  await begin(page);
  const given = await form(page, 'mouse');
  const download = page.waitForEvent('download');
  await page.getByRole('link', { name: 'Download CSV' }).click();
  const file = path.join(folder, `${name}.csv`);
  await (await download).saveAs(file);
  const joined = path.join(folder, `${name}-joined.csv`);
  run('collect', made.config, file, '--out', joined);
  assert.deepEqual(rows(fs.readFileSync(joined, 'utf8')).map(asGiven), given);
}

test('who must choose has two answers', async () => {
  const made = asking('forced', 'way = "forced"');
  await walk(made, 'forced', ['L', 'R'], ['Top', 'Bottom']);
  const page = await open(`${pathToFileURL(path.join(made.out, 'bundle/index.html')).href}?form=3`, { viewport: { width: 1280, height: 800 } });
  await page.getByRole('button', { name: 'I agree, begin' }).click();
  await page.getByText('the keys 1 and 2, or the arrows').waitFor();
  await page.getByRole('button', { name: 'Go on' }).click();
  await ready(page);
  assert.deepEqual(await buttons(page), ['Left', 'Right']);
  // Down points to no answer.
  await page.keyboard.press('ArrowDown');
  assert.match(await page.locator('h2').textContent(), /Practice 1/);
  await answer(page, 'R', { R: 'ArrowRight' });
});

test('five steps have five buttons, in words of the study and of each language', async () => {
  const words = ['A lot left', 'Left', 'Same', 'Right', 'A lot right'];
  const own = asking('graded', `way = "graded"\nchoices = ${JSON.stringify(words)}`);
  await walk(own, 'graded', ['LL', 'L', 'NP', 'R', 'RR'], words);
  const languages = ['en', 'de', 'fr', 'es', 'ja', 'ar'];
  const texts = languages.slice(1).map((lang) => `${lang} = { title = "x", prompt = "y" }`).join(', ');
  const shipped = asking('shipped', `way = "graded"\nlanguages = ${JSON.stringify(languages)}\ntexts = { ${texts} }`);
  for (const viewport of [PHONE.viewport, { width: 844, height: 390 }]) {
    for (const lang of languages) {
      const page = await open(`${pathToFileURL(path.join(shipped.out, 'bundle/index.html')).href}?form=1&lang=${lang}`, { ...PHONE, viewport });
      await page.locator('button.main').click();
      await page.locator('button.main').click();
      await ready(page);
      if (lang === 'en') assert.equal((await buttons(page))[0], `${viewport.width < 400 ? 'Top' : 'Left'} much better`);
      await fits(page, `five steps in ${lang}, ${viewport.width} px wide`);
      await page.context().close();
    }
  }
});

test('one surface at a time is rated on a scale', async () => {
  const made = asking('ratings', 'way = "ratings"\nsteps = 5\nends = ["awful", "splendid"]', (text) => several(text).replace('max_questions = 6', 'max_questions = 10'));
  const codes = ['1', '2', '3', '4', '5'];
  await walk(made, 'ratings', codes, codes, { asked: 10, practice: 2 });
  const page = await open(`${pathToFileURL(path.join(made.out, 'bundle/index.html')).href}?form=3`, { viewport: { width: 1280, height: 800 } });
  await page.getByRole('button', { name: 'I agree, begin' }).click();
  await page.getByText('say how much you like it').waitFor();
  await page.getByRole('button', { name: 'Go on' }).click();
  await ready(page);
  await page.getByText('splendid', { exact: true }).waitFor();
  await page.getByRole('button', { name: '1, awful' }).waitFor();
  assert.equal(await page.locator('.half').count(), 1);
  await fits(page, 'a rating on a large screen');
});

test('the best of three or four that turn in step is taken, or none', async () => {
  for (const places of [3, 4]) {
    const made = asking(`best-${places}`, `way = "best-of-${places}"\nnone = true`, several);
    const codes = [...['1', '2', '3', '4'].slice(0, places), 'NP'];
    const named = [...['First', 'Second', 'Third', 'Fourth'].slice(0, places), 'None of them'];
    const [{ questions }] = JSON.parse(fs.readFileSync(path.join(made.out, 'bundle/forms.json'), 'utf8')).forms;
    await walk(made, `best-${places}`, codes, named, { asked: questions.length });
    for (const viewport of [{ width: 1280, height: 800 }, { width: 844, height: 390 }]) {
      const page = await open(`${pathToFileURL(path.join(made.out, 'bundle/index.html')).href}?form=1`, { viewport });
      await begin(page);
      await ready(page);
      assert.equal(await page.locator('.half').count(), places);
      await fits(page, `${places} surfaces on ${viewport.width} px`);
      await page.context().close();
    }
  }
});
