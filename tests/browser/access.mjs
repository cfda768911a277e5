// The whole way as people meet it who have a phone, a slow line, large text, no pointer and no wish for motion, in German and in Arabic.
// Run by scripts/test-browser.sh.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import test from 'node:test';
import { fileURLToPath } from 'node:url';
import { CHOICES, PHONE, asGiven, browser, over, questionnaire, rows, serious, shown } from './walk.mjs';

const texts = path.resolve(path.dirname(fileURLToPath(import.meta.url)), '../../crates/isostudy-design/src/texts');
const shipped = (lang) => Object.fromEntries(
  fs.readFileSync(path.join(texts, `${lang}.toml`), 'utf8').split('\n').filter((line) => /^\w+ = "/.test(line))
    .map((line) => { const [, key, quoted] = line.match(/^(\w+) = (".*")$/); return [key, JSON.parse(quoted)]; }),
);

const OWN = {
  de: { title: 'Welche Fläche gefällt Ihnen besser?', prompt: 'Welche der beiden Flächen gefällt Ihnen besser?', tools: 'Welche Werkzeuge benutzen Sie?', options: ['Bleistifte', 'Pinsel'], age: 'Wie alt sind Sie?', careful: 'Bitte wählen Sie hier 2.', ends: ['niedrig', 'hoch'] },
  ar: { title: 'أي السطحين يعجبك أكثر؟', prompt: 'أي السطحين يعجبك أكثر؟', tools: 'ما الأدوات التي تستخدمها؟', options: ['أقلام', 'فرش'], age: 'كم عمرك؟', careful: 'اختر 2 هنا من فضلك.', ends: ['منخفض', 'مرتفع'] },
};
const { de, ar } = OWN;
const KEYS = `languages = ["de", "ar"]
contact = "Ada Lovelace, ada@university.example"
ethics = "17"
least_age = 18
retention_days = 365
comment = true
go_back = true
[forms.texts.ar]
title = "${ar.title}"
prompt = "${ar.prompt}"
about_tools = "${ar.tools}"
about_tools_1 = "${ar.options[0]}"
about_tools_2 = "${ar.options[1]}"
about_age = "${ar.age}"
about_careful = "${ar.careful}"
about_careful_low = "${ar.ends[0]}"
about_careful_high = "${ar.ends[1]}"
`;
const ABOUT = `
[[forms.about]]
id = "vision"
kind = "colour-vision"
[[forms.about]]
id = "tools"
kind = "multiple"
ask = "${de.tools}"
options = ["${de.options[0]}", "${de.options[1]}"]
[[forms.about]]
id = "age"
kind = "number"
ask = "${de.age}"
from = 18
to = 99
[[forms.about]]
id = "careful"
kind = "scale"
ask = "${de.careful}"
ends = ["${de.ends[0]}", "${de.ends[1]}"]
when = "after"
expects = 2
`;
const made = questionnaire('access', (text) => text
  .replace(/^title = .*$/m, `title = "${de.title}"`).replace(/^prompt = .*$/m, `prompt = "${de.prompt}"`)
  .replace(/^choices = .*$/m, 'choices = ["Links", "Keine Präferenz", "Rechts"]').replace(/^(consent|instructions) = .*$/gm, '')
  // Tables follow the keys of [forms].
  .replace('\n# What of the analysis', `\n${KEYS}${ABOUT}\n# What of the analysis`));

/** On the line of many phones: 1.5 Mbit/s, a tenth of a second. */
async function slow(address, lang) {
  const context = await browser.newContext({ ...PHONE, reducedMotion: 'reduce', locale: lang === 'de' ? 'de-DE' : 'ar-EG' });
  await context.addInitScript(() => {
    document.addEventListener('DOMContentLoaded', () => { document.documentElement.style.fontSize = '200%'; });
  });
  const blank = await context.newPage();
  const line = await context.newCDPSession(blank);
  const speed = 1.5e6 / 8;
  await line.send('Network.enable');
  await line.send('Network.emulateNetworkConditions', { offline: false, latency: 100, downloadThroughput: speed, uploadThroughput: speed });
  blank.on('pageerror', (error) => { throw error; });
  await blank.goto(address);
  return blank;
}

/** Presses Tab until something has the focus that says this, and returns it. */
async function reach(page, says, key = 'Tab') {
  const at = () => page.evaluate(() => {
    const on = document.activeElement;
    // Between the last and the first there is the page itself.
    return on === document.body ? '' : (on.closest('label') ?? on).textContent || on.getAttribute('aria-label') || on.tagName;
  });
  for (let tabs = 0; tabs < 40; tabs += 1) {
    await page.keyboard.press(key);
    if ((await at()).includes(says)) return;
  }
  assert.fail(`${says} cannot be reached`);
}
const press = async (page, says, key = 'Enter') => {
  await reach(page, says);
  await page.keyboard.press(key);
};

for (const lang of ['de', 'ar']) {
  test(`${lang}: by keyboard on a phone, at 1.5 Mbit/s, with less motion and text of twice the size`, async () => {
    const [spoken, own] = [shipped(lang), OWN[lang]];
    const server = await made.serve(`access-${lang}`);
    const page = await slow(`${server.address}?lang=${lang}`, lang);
    const look = async (where) => {
      assert.deepEqual(await serious(page), [], where);
      const state = await page.evaluate(() => ({
        lang: document.documentElement.lang,
        covered: [...document.querySelectorAll('#view > *')].filter((one) => one.getBoundingClientRect().bottom > document.getElementById('status').getBoundingClientRect().top + 1).map((one) => one.className),
        cut: [...document.querySelectorAll('button, legend, h1, h2, p, label, a')].filter((one) => one.offsetParent !== null && one.scrollWidth > one.clientWidth + 1 && getComputedStyle(one).display !== 'inline').map((one) => one.textContent),
      }));
      assert.equal(state.lang, lang);
      const wide = await over(page);
      assert.ok(wide <= 0, `${where} is ${wide} px too wide`);
      assert.deepEqual(state.cut, [], `${where}: text is cut`);
      assert.deepEqual(state.covered, [], `${where}: something is covered`);
      if (process.env.PICTURES) await page.screenshot({ path: path.join(process.env.PICTURES, `${lang}-${where.replaceAll(' ', '-')}.png`) });
    };
    await page.getByRole('heading', { name: spoken.before }).waitFor();
    await look('consent');
    await press(page, spoken.begin);
    await page.getByText(spoken.colour_vision, { exact: true }).waitFor();
    await look('a choice');
    await press(page, spoken.colour_vision_1, 'Space');
    await page.keyboard.press('Enter');
    await page.getByText(own.tools).waitFor();
    await look('several choices');
    await press(page, own.options[0], 'Space');
    await press(page, own.options[1], 'Space');
    await page.keyboard.press('Enter');
    await page.getByText(own.age).waitFor();
    await look('a number');
    await page.keyboard.press('Tab');
    await page.keyboard.type('31');
    await page.keyboard.press('Enter');
    await page.getByRole('heading', { name: spoken.what_to_do }).waitFor();
    await look('instructions');
    await press(page, spoken.go_on);

    const judge = async (choice, where) => {
      await page.getByText(spoken.less_motion).waitFor();
      await look(where);
      const [code, title] = [await shown(page), await page.locator('h2').textContent()];
      await press(page, spoken.play);
      await page.locator('[data-choice="L"]:not([aria-disabled])').waitFor();
      await page.keyboard.press({ L: '1', NP: '2', R: '3' }[choice]);
      await page.waitForFunction((old) => document.querySelector('h2').textContent !== old, title);
      return { code, choice };
    };
    await judge('L', 'practice');
    const given = [await judge(CHOICES[0], 'a question')];
    await page.getByText(spoken.less_motion).waitFor();
    await press(page, spoken.back);
    await page.getByRole('heading', { name: spoken.question.replace('{number}', '1') }).waitFor();
    given[0] = await judge('NP', 'a question again');
    for (const choice of CHOICES.slice(1)) given.push(await judge(choice, 'a question'));

    await page.getByText(own.careful).waitFor();
    await look('a scale');
    await reach(page, '1');
    await page.keyboard.press('ArrowDown');
    await page.keyboard.press('Enter');
    await page.getByText(spoken.comment, { exact: true }).waitFor();
    await look('a comment');
    await page.keyboard.press('Tab');
    await page.keyboard.type('words');
    await press(page, spoken.go_on);
    await page.getByText(spoken.all_saved).waitFor();
    await look('the end');

    const lines = rows(await server.export());
    assert.deepEqual(lines.map(asGiven), given);
    const [said] = rows(await server.export('about.csv'));
    assert.deepEqual([said.age, said.careful, said.attention, said.comment], ['31', '2', '1 of 1', 'words']);
    await server.stop();
  });
}
