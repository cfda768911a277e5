// The questionnaire in other languages, read as participants read it. Run by scripts/test-browser.sh.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import test from 'node:test';
import { fileURLToPath } from 'node:url';
import { CHOICES, PHONE, answer, open, over, questionnaire, ready, rows, serious } from './walk.mjs';

const texts = path.resolve(path.dirname(fileURLToPath(import.meta.url)), '../../crates/isostudy-design/src/texts');
/** A shipped file of texts: one key and one text a line. */
const shipped = (lang) => Object.fromEntries(
  fs.readFileSync(path.join(texts, `${lang}.toml`), 'utf8').split('\n').filter((line) => /^\w+ = "/.test(line))
    .map((line) => { const [, key, quoted] = line.match(/^(\w+) = (".*")$/); return [key, JSON.parse(quoted)]; }),
);
const words = (text) => text.replace(/\{\w+\}/g, ' ').toLowerCase().match(/\p{L}{2,}/gu) ?? [];

const GERMAN = {
  title: 'Welche Fläche gefällt Ihnen besser?', prompt: 'Welche der beiden Flächen gefällt Ihnen besser?',
};
const ARABIC = { title: 'أي السطحين يعجبك أكثر؟', prompt: 'أي السطحين يعجبك أكثر؟' };
const made = await questionnaire('languages', (text) => text
  .replace(/^title = .*$/m, `title = "${GERMAN.title}"`).replace(/^prompt = .*$/m, `prompt = "${GERMAN.prompt}"`)
  .replace(/^choices = .*$/m, 'choices = ["Links", "Keine Präferenz", "Rechts"]').replace(/^(consent|instructions) = .*$/gm, '')
  .replace('[forms]', `[forms]\nlanguages = ["de", "ar"]\ntexts.ar = { title = "${ARABIC.title}", prompt = "${ARABIC.prompt}" }`));

/** Everything on the page that somebody can see or hear. */
const read = (page) => page.evaluate(() => {
  const said = [document.title, document.documentElement.lang, document.querySelector('noscript').textContent];
  for (const element of document.querySelectorAll('*')) {
    if (element.matches('script, style')) continue;
    for (const name of ['alt', 'title', 'aria-label', 'placeholder', 'value', 'download']) if (name !== 'value' || element.matches('input[type=button]')) said.push(element.getAttribute(name) ?? '');
    for (const node of element.childNodes) if (node.nodeType === Node.TEXT_NODE) said.push(node.textContent);
  }
  // Where scripts run, the markup of what is shown without them is text.
  return said.join('\n').replace(/<[^<>]*>/g, ' ');
});

/** Walks a whole form, and calls `look` with each page and its name. */
async function walk(page, spoken, look) {
  await look('consent');
  await page.getByRole('button', { name: spoken.begin }).click();
  await look('instructions');
  await page.getByRole('button', { name: spoken.go_on }).click();
  await page.locator('.half').first().waitFor();
  await page.keyboard.press('1');
  await look('too early');
  await ready(page);
  await look('practice');
  await page.getByRole('button', { name: spoken.enlarge }).click();
  await look('enlarged');
  await page.keyboard.press('Escape');
  await answer(page, 'L');
  for (const choice of CHOICES) {
    await ready(page);
    await look('a question');
    await answer(page, choice);
  }
  await page.getByText(spoken.all_saved).waitFor();
  await look('the end');
}

test('the pages of a German study hold no English word', async () => {
  const [english, german] = [shipped('en'), shipped('de')];
  // A download has the study's id in its name.
  const own = new Set(words([...Object.values(german), ...Object.values(GERMAN), 'de', 'csv', 'json', 'two-methods'].join(' ')));
  const foreign = new Set(words(Object.values(english).join(' ')).filter((word) => !own.has(word)));
  assert.ok(foreign.size > 150 && foreign.has('the') && foreign.has('answer') && foreign.has('moving'));
  const server = await made.serve('german');
  const seen = [];
  const look = (page) => async (where) => {
    const found = words(await read(page)).filter((word) => foreign.has(word));
    assert.deepEqual(found, [], where);
    seen.push(where);
  };
  const page = await open(server.address, { ...PHONE, locale: 'de-DE' });
  assert.equal(await page.evaluate(() => document.documentElement.lang), 'de');
  await page.getByRole('heading', { name: german.before }).waitFor();
  await walk(page, german, look(page));
  assert.ok(seen.length >= 11, `${seen}`);

  // What goes wrong is German too: no connection, a server that takes nothing, less motion, a study that nobody reaches.
  const other = await open(`${server.address}?lang=de`, { locale: 'en-US', reducedMotion: 'reduce' });
  assert.equal(await other.getByRole('button', { name: 'العربية' }).count(), 0, 'the address has chosen');
  await other.route('**/api/sessions', (route) => route.abort());
  await other.getByRole('button', { name: german.begin }).click();
  await other.getByText(german.unreachable).waitFor();
  await look(other)('no study');
  await other.unroute('**/api/sessions');
  await other.getByRole('button', { name: german.begin }).click();
  await other.getByRole('button', { name: german.go_on }).click();
  await other.getByText(german.less_motion).waitFor();
  await look(other)('less motion');
  await other.getByRole('button', { name: german.play }).click();
  await answer(other, 'L');
  await other.getByRole('button', { name: german.play }).click();
  await other.route('**/api/answers', (route) => route.abort());
  await answer(other, 'L');
  await other.getByText(german.no_connection).waitFor();
  await look(other)('no connection');
  await other.unroute('**/api/answers');
  await other.route('**/api/answers', (route) => route.fulfill({ status: 422, body: 'something in English' }));
  await other.getByRole('heading', { name: german.not_saved }).waitFor();
  await look(other)('not saved');
  const download = other.waitForEvent('download');
  await other.getByRole('link', { name: german.download.replace('{kind}', 'CSV') }).click();
  assert.equal(rows(fs.readFileSync(await (await download).path(), 'utf8')).length, 1);
  await server.stop();
});

test('in Arabic everything but the pair runs from right to left', async () => {
  const arabic = shipped('ar');
  const server = await made.serve('arabic');
  const page = await open(server.address, { ...PHONE, locale: 'fr-FR' });
  // Neither is French: the page begins in the study's first language, and another can be chosen.
  await page.getByRole('heading', { name: shipped('de').before }).waitFor();
  await page.getByRole('button', { name: 'العربية' }).click();
  const direction = () => page.evaluate(() => [document.documentElement.lang, document.documentElement.dir, document.title]);
  assert.deepEqual(await direction(), ['ar', 'rtl', ARABIC.title]);
  const latin = /[a-z]{2,}/i;
  await walk(page, arabic, async (where) => {
    const wide = await over(page);
    assert.ok(wide <= 0, `${where} is ${wide} px too wide`);
    assert.deepEqual(await serious(page), [], where);
    // A receipt is a number in hexadecimal digits.
    const said = (await read(page)).replaceAll(/JavaScript|\bar\b|C0DE|Deutsch|Diese Seite.*|\b[0-9a-f]{4,}\b/gi, '');
    assert.ok(!latin.test(said), `${where}: ${said.match(latin)}`);
  });
  // The session keeps its language, and the address changes it.
  await page.reload();
  await page.getByText(arabic.all_saved).waitFor();
  assert.equal((await direction())[0], 'ar');
  await page.goto(`${server.address}?lang=de`);
  await page.getByText(shipped('de').all_saved).waitFor();

  const wide = await open(`${server.address}?lang=ar`, { viewport: { width: 1000, height: 800 } });
  await wide.getByRole('button', { name: arabic.begin }).click();
  await wide.getByRole('button', { name: arabic.go_on }).click();
  await ready(wide);
  const at = async (selector) => (await wide.locator(selector).boundingBox()).x;
  const halves = await wide.locator('.half img').evaluateAll((all) => all.map((img) => [img.alt, img.closest('.half').getBoundingClientRect().x]));
  assert.ok(halves[0][0] === arabic.left_turning && halves[0][1] < halves[1][1], `${halves}`);
  assert.ok(await at('[data-choice="L"]') < await at('[data-choice="NP"]') && await at('[data-choice="NP"]') < await at('[data-choice="R"]'));
  assert.equal(await wide.locator('[data-choice="L"] span').textContent(), arabic.left);
  assert.ok(await at('.top h2') > await at('.tools'), 'the heading is on the right');
  if (process.env.PICTURES) await wide.screenshot({ path: path.join(process.env.PICTURES, 'arabic.png') });
  await server.stop();
});
