// A tablet that people share, and what the researcher sees. Run by scripts/test-browser.sh.
import assert from 'node:assert/strict';
import path from 'node:path';
import test from 'node:test';
import { CHOICES, PHONE, TOKEN, all, answer, asGiven, begin, browser, open, over, questionnaire, rows, serious, tab } from './walk.mjs';

const made = questionnaire('shared', (text) => text
  .replace('[forms]', '[forms]\nlanguages = ["en", "ar"]\ntexts.ar = { title = "أي السطحين يعجبك أكثر؟", prompt = "أي السطحين يعجبك أكثر؟", none = "متساويان" }\ncontact = "Ada Lovelace"\ncompletion_withdrawn = "GONE-1"\nper_form = 3')
  .replace('\n[analysis]', '\n[[forms.about]]\nid = "vision"\nkind = "colour-vision"\nmost = [2, 0, 0, 0]\n\n[analysis]\nprimary = ["U-I"]\nstopping = { looks = [12, 24], boundary = "obrien-fleming" }'));
const see = async (page) => {
  await page.getByRole('button', { name: 'I agree, begin' }).click();
  await page.getByLabel('Rather not say').check();
  await page.getByRole('button', { name: 'Go on' }).click();
  await page.getByRole('button', { name: 'Go on' }).click();
};

/** A tablet whose two idle minutes pass in six seconds: waiting of 20 s or more takes a twentieth. */
async function hurried(address, options = PHONE) {
  const context = await browser.newContext(options);
  await context.addInitScript(() => {
    const wait = window.setTimeout;
    window.setTimeout = (act, ms, ...more) => wait(act, ms >= 20000 ? ms / 20 : ms, ...more);
  });
  return tab(context, address);
}

test('people who share a tablet follow each other, and none sees what another answered', async () => {
  const server = await made.serve('kiosk');
  const page = await open(`${server.address}?kiosk`, PHONE);
  const given = [];
  for (let person = 0; person < 2; person += 1) {
    await see(page);
    given.push(await all(page, 'mouse'));
    await page.getByText('All your answers are saved').waitFor();
    assert.deepEqual(await serious(page), []);
    await page.getByRole('button', { name: 'Next participant' }).click();
    await page.getByRole('button', { name: 'I agree, begin' }).waitFor();
    assert.equal(await page.evaluate(() => localStorage.length), 0);
  }
  await page.getByRole('button', { name: 'I do not want to take part' }).click();
  await page.getByText('GONE-1').waitFor();
  await page.getByRole('button', { name: 'Next participant' }).click();
  await page.getByRole('button', { name: 'I agree, begin' }).waitFor();
  const lines = rows(await server.export()).map(asGiven);
  assert.deepEqual([lines.slice(0, 6), lines.slice(6)], given);
  // Elsewhere the end offers nothing.
  const own = await open(server.address, PHONE);
  await see(own);
  await all(own, 'mouse');
  await own.getByText('All your answers are saved').waitFor();
  assert.equal(await own.getByRole('button', { name: 'Next participant' }).count(), 0);
  await server.stop();
});

test('after two idle minutes the page returns to its start, and loses nothing', async () => {
  const server = await made.serve('idle');
  const page = await hurried(`${server.address}?kiosk`);
  // Nobody is waited for at the start.
  await page.waitForTimeout(7000);
  assert.equal(await page.getByRole('alertdialog').count(), 0);
  await page.getByRole('button', { name: 'العربية' }).click();
  await page.getByRole('alertdialog').waitFor();
  assert.deepEqual(await serious(page), []);
  await page.getByRole('button', { name: 'I agree, begin' }).waitFor();
  assert.equal(await page.evaluate(() => document.documentElement.dir), 'ltr', 'the next one begins in the first language');

  await see(page);
  await answer(page, 'L');
  const first = await answer(page, 'R');
  await page.getByRole('alertdialog').waitFor();
  if (process.env.PICTURES) await page.screenshot({ path: path.join(process.env.PICTURES, 'idle.png') });
  // A key says that somebody is there, and answers nothing.
  await page.keyboard.press('1');
  await page.getByRole('alertdialog').waitFor({ state: 'hidden' });
  assert.match(await page.locator('h2').first().textContent(), /Question 2/);
  // Without a connection: the answer waits on the tablet, and the next one begins.
  await page.route('**/api/{answers,finish}', (route) => route.abort());
  const second = await answer(page, 'NP');
  await page.getByRole('alertdialog').waitFor();
  await page.getByRole('button', { name: 'I agree, begin' }).waitFor();
  assert.deepEqual(rows(await server.export()).map(asGiven), [first]);
  await page.unroute('**/api/{answers,finish}');
  await see(page);
  assert.match(await page.locator('h2').first().textContent(), /Practice 1/);
  for (let tries = 0; tries < 100 && rows(await server.export()).length < 2; tries += 1) await page.waitForTimeout(200);
  assert.deepEqual(rows(await server.export()).map(asGiven), [first, second]);
  // A tablet that is switched off in between sends it as well.
  await answer(page, 'L');
  await page.route('**/api/{answers,finish}', (route) => route.abort());
  const third = await answer(page, 'L');
  await page.getByRole('alertdialog').waitFor();
  await page.getByRole('button', { name: 'I agree, begin' }).waitFor();
  await page.close();
  const later = await tab(page.context(), `${server.address}?kiosk`);
  await later.getByRole('button', { name: 'I agree, begin' }).waitFor();
  for (let tries = 0; tries < 100 && rows(await server.export()).length < 3; tries += 1) await later.waitForTimeout(200);
  assert.deepEqual(rows(await server.export()).map(asGiven), [first, second, third]);
  assert.equal(await later.evaluate(() => localStorage.length), 0);
  await server.stop();
});

test('the researcher sees how far the study is, and nothing of what was chosen', async () => {
  const server = await made.serve('stand');
  const one = await open(server.address, PHONE);
  await one.getByRole('button', { name: 'I agree, begin' }).click();
  await one.getByLabel('As most people do').check();
  await one.getByRole('button', { name: 'Go on' }).click();
  await one.getByRole('button', { name: 'Go on' }).click();
  await all(one, 'mouse');
  await one.getByText('All your answers are saved').waitFor();
  const two = await open(server.address, PHONE);
  await see(two);
  await answer(two, 'L');
  await answer(two, CHOICES[0]);
  await two.waitForFunction(() => Object.values(localStorage).some((text) => JSON.parse(text).answers?.[0]?.saved));
  for (const options of [PHONE, { viewport: { width: 1280, height: 900 } }]) {
    const page = await open(`${server.address}researcher`, options);
    await page.getByLabel('Token').fill(TOKEN);
    await page.getByRole('button', { name: 'Show' }).click();
    await page.locator('#stand').waitFor();
    await page.getByText('Which of two surfaces do you like better?').waitFor();
    const numbers = await page.locator('#numbers').textContent();
    assert.match(numbers, /finished1 of 24 planned.*began2who have begun and not finished1.*two minutes2Answers7/s);
    assert.match(numbers, /Participants per form0 to 1, at most 3Median time from beginning to end\d+\.\d minExpected end, at the pace of the last 24 hours\d/);
    assert.equal(await page.locator('#stopping').textContent(), 'The study declared 2 looks at 12, 24 participants who finished. The first look has not been reached.');
    assert.deepEqual(await page.locator('#options td').allTextContents(), ['How well do you tell colours apart?', 'As most people do', '1', '2']);
    assert.equal(await page.locator('#leaving').isHidden(), true);
    assert.deepEqual(await serious(page), []);
    const wide = await over(page);
    assert.ok(wide <= 0, `${wide} px too wide`);
    if (process.env.PICTURES) await page.screenshot({ path: path.join(process.env.PICTURES, `researcher-${options.viewport.width}.png`), fullPage: true });
  }
  await server.stop();
});
