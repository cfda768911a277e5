// The questionnaire in a real browser: a page from a folder, the server, the researcher's page.
// Run by scripts/test-browser.sh, which sets ISOSTUDY (the program), CHROMIUM and MODULES.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import path from 'node:path';
import test from 'node:test';
import { pathToFileURL } from 'node:url';
import { CHOICES, MOST, PHONE, TOKEN, all, answer, asGiven, begin, browser, folder, open, over, questionnaire, ready, rows, run, serious, serve as serving, shown, tab } from './walk.mjs';

const made = questionnaire('study');
const { config, out } = made;
/** A server of that study, or of another one that was bundled. */
const serve = (name, port = '0', of = made) => serving(of, name, port);

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
  assert.match(await researcher.locator('#numbers').textContent(), /finished2 of \d+ plannedwho began2who have begun and not finished0who answered in the last two minutes2Answers12/);
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
  await page.locator('.pair img').first().waitFor();
  await page.keyboard.press('1');
  await page.locator('[data-choice="R"]').click({ force: true });
  assert.equal(await page.locator('#status').textContent(), 'Please watch it to the end first.');
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
  assert.match(await refused.locator('#view').textContent(), /Tell them this word: other-stimulus/);
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
  // Said before anybody does something wrong.
  await page.getByText('Your device asks for less motion. Press Play').waitFor();
  await page.waitForTimeout(700);
  assert.equal(await page.locator('.pair img').first().isVisible(), false);
  assert.equal(await page.locator('.pair canvas').first().isVisible(), true);
  await page.keyboard.press('1');
  await page.getByText('Please play it to the end first.').waitFor();
  await page.getByRole('button', { name: 'Play' }).click();
  await answer(page, 'L');
});

test('accessible, and fit for a phone', async () => {
  const server = await serve('phone');
  for (const viewport of [{ width: 360, height: 640 }, { width: 1280, height: 800 }]) {
    const page = await open(server.address, { viewport });
    const judge = async (where) => {
      assert.deepEqual(await serious(page), [], where);
      const wide = await over(page);
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
  assert.deepEqual(await serious(page), []);
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
    for (const half of await page.locator('.half').all()) {
      const picture = await half.boundingBox();
      assert.ok(picture.height >= 80 && picture.y + picture.height <= box.y, `${picture.height} px of picture at ${width} x ${height}`);
    }
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

/** Where both surfaces are. */
async function surfaces(page) {
  const boxes = [];
  for (const half of await page.locator('.half').all()) boxes.push(await half.boundingBox());
  return boxes;
}

test('on a phone the surfaces stand one over the other, as large as it allows, and a tap enlarges both', async () => {
  const server = await serve('small');
  const page = await open(server.address, PHONE);
  assert.equal(await page.getByText(/the keys 1, 2 and 3/).count(), 0);
  await page.getByRole('button', { name: 'I agree, begin' }).tap();
  assert.equal(await page.getByText(/the keys 1, 2 and 3/).count(), 0);
  await page.getByRole('button', { name: 'Go on' }).tap();
  await ready(page);
  const [top, bottom] = await surfaces(page);
  assert.ok(top.x === bottom.x && bottom.y >= top.y + top.height, 'one over the other');
  assert.ok(top.width >= 280 && top.width === bottom.width && top.height === bottom.height, `${top.width} px`);
  const answers = await page.locator('.choices').boundingBox();
  assert.ok(bottom.y + bottom.height <= answers.y && answers.y + answers.height <= 844);
  assert.deepEqual(await page.locator('.choices button').allTextContents(), ['Top', 'No preference', 'Bottom']);
  assert.deepEqual(await page.locator('.name').allTextContents(), ['Top', 'Bottom']);
  await page.locator('.half').first().tap();
  const large = await surfaces(page);
  // The answers stay where they can be given.
  assert.ok(large.every((half) => half.width > top.width + 40 && half.width <= 390), `${large[0].width} px after ${top.width}`);
  const below = await page.locator('.choices').boundingBox();
  assert.ok(large[1].y + large[1].height <= below.y && below.y + below.height <= 844, `answers at ${below.y}`);
  if (process.env.PICTURES) await page.screenshot({ path: path.join(process.env.PICTURES, 'phone-large.png') });
  await page.getByRole('button', { name: 'Smaller' }).tap();
  assert.deepEqual(await surfaces(page), [top, bottom]);
  if (process.env.PICTURES) await page.screenshot({ path: path.join(process.env.PICTURES, 'phone.png') });
  await page.locator('[data-choice="L"]').tap();
  await page.getByRole('heading', { name: 'Question 1' }).waitFor();
  assert.equal(await page.locator('#progress-text').textContent(), '1 of 6');
  await ready(page);
  const upper = await shown(page);
  await page.locator('[data-choice="L"]').tap();
  await page.getByRole('heading', { name: 'Question 2' }).waitFor();
  // Turned, it lies side by side again.
  await page.setViewportSize({ width: 844, height: 390 });
  await ready(page);
  const [left, right] = await surfaces(page);
  assert.ok(left.y === right.y && right.x >= left.x + left.width - 1, 'side by side');
  await page.locator('[data-choice="NP"]').tap();
  await page.getByRole('heading', { name: 'Question 3' }).waitFor();
  await page.waitForFunction(() => Object.values(localStorage).some((text) => JSON.parse(text).answers?.[1]?.saved));
  const lines = rows(await server.export());
  assert.deepEqual(asGiven(lines[0]), { code: upper, choice: 'L' }, 'the upper surface is the left half');
  const screen = ({ viewport_width, viewport_height, pixel_ratio, layout, input, shown_as }) => [viewport_width, viewport_height, pixel_ratio, layout, input, shown_as];
  assert.deepEqual(lines.map(screen), [['390', '844', '3', 'stacked', 'touch', 'gif'], ['844', '390', '3', 'beside', 'touch', 'gif']]);
  assert.equal(lines[0].surface_px, String(top.width));
  await server.stop();
});

test('in a wide window a pair is up to twice as large as it was made, smoothly, and enlarged it leaves the answers', async () => {
  const plain = questionnaire('plain', (text) => text.replace('page_scale = 4', 'page_scale = 1').replace('width = 128', 'width = 320').replace('height = 128', 'height = 320'));
  const server = await serve('wide', '0', plain);
  const page = await open(server.address, { viewport: { width: 1280, height: 900 } });
  await begin(page);
  await ready(page);
  const usual = await surfaces(page);
  assert.ok(usual.every((half) => half.width >= 560 && half.width <= 640), `${usual[0].width} px of at most 640`);
  assert.equal(await page.locator('.half img').first().evaluate((img) => getComputedStyle(img).imageRendering), 'auto');
  const choices = page.locator('.choices');
  const inside = async () => {
    const [left] = await surfaces(page);
    const box = await choices.boundingBox();
    assert.ok(left.y >= 0 && left.y + left.height <= box.y && box.y + box.height <= 900, `${left.y + left.height}, ${box.y}`);
  };
  await inside();
  if (process.env.PICTURES) await page.screenshot({ path: path.join(process.env.PICTURES, 'wide.png') });
  // As large as they were made for and no larger, however large the window.
  await page.setViewportSize({ width: 2560, height: 1600 });
  await page.waitForFunction(() => document.querySelector('.half').clientWidth === 640);
  await page.setViewportSize({ width: 1280, height: 900 });
  await page.waitForFunction((width) => document.querySelector('.half').clientWidth === width, usual[0].width);
  await page.getByRole('button', { name: 'Enlarge' }).click();
  const large = await surfaces(page);
  assert.ok(large[0].width > usual[0].width, `${large[0].width} px after ${usual[0].width}`);
  await inside();
  if (process.env.PICTURES) await page.screenshot({ path: path.join(process.env.PICTURES, 'wide-large.png') });
  await page.locator('[data-choice="R"]').click();
  await page.getByRole('heading', { name: 'Question 1' }).waitFor();
  await ready(page);
  assert.deepEqual(await surfaces(page), usual, 'the next pair begins as usual');
  await server.stop();
});

test('both halves of an animation show one frame of it', async () => {
  const server = await serve('together');
  const page = await open(server.address, PHONE);
  await begin(page);
  // A control: both halves are the same all the time, if they are of one moment.
  const key = new Map(rows(fs.readFileSync(path.join(out, 'key/stimuli.csv'), 'utf8')).map((line) => [path.basename(line.file, '.gif'), line]));
  let seen = 0;
  for (let i = 0; i <= MOST; i += 1) {
    await ready(page);
    const { left, right } = key.get(await shown(page));
    for (let shot = 0; left === right && shot < 5; shot += 1) {
      await page.evaluate(() => document.querySelectorAll('.name').forEach((name) => { name.style.display = 'none'; }));
      const picture = await page.screenshot();
      const [a, b] = (await surfaces(page)).map((box) => ({ ...box }));
      const same = await page.evaluate(async ({ picture, a, b }) => {
        const image = new Image();
        image.src = `data:image/png;base64,${picture}`;
        await image.decode();
        const pixels = (box) => {
          const canvas = new OffscreenCanvas(box.width * 3, box.height * 3).getContext('2d');
          canvas.drawImage(image, -box.x * 3, -box.y * 3);
          return canvas.getImageData(0, 0, box.width * 3, box.height * 3).data;
        };
        const [one, two] = [pixels(a), pixels(b)];
        return one.reduce((sum, level, i) => sum + Math.abs(level - two[i]), 0) / one.length;
      }, { picture: picture.toString('base64'), a, b });
      assert.ok(same < 2, `${same} levels`);
      seen += 1;
    }
    await answer(page, 'NP');
  }
  assert.ok(seen > 0);
  await server.stop();
});

test('on a slow line the first pair comes during consent, the share is told, and no clock runs before it is seen', async () => {
  // Large enough that it comes in several parts.
  const large = questionnaire('large', (text) => text.replace('width = 128', 'width = 320').replace('height = 128', 'height = 320')
    .replace('frames = 4', 'frames = 16').replace('duration_s = 0.4', 'duration_s = 1.6'));
  const server = await serve('slow', '0', large);
  const stimuli = path.join(large.out, 'bundle/stimuli');
  const bytes = fs.statSync(path.join(stimuli, fs.readdirSync(stimuli)[0])).size;
  let page, line;
  // The practice shows a pair of the study's. Whoever meets it again where the line matters has it already, and is of no use here.
  for (let met = true; met;) {
    const context = await browser.newContext();
    page = await context.newPage();
    line = await context.newCDPSession(page);
    await line.send('Network.enable');
    const asked = [];
    page.on('request', (request) => { if (request.url().includes('/stimuli/')) asked.push(path.basename(request.url(), '.gif')); });
    await page.goto(server.address);
    await page.getByRole('button', { name: 'I agree, begin' }).waitFor();
    const practice = await page.evaluate(() => window.ISOSTUDY.first[0]);
    while (!asked.length) await page.waitForTimeout(20);
    assert.deepEqual(asked, [practice], 'the practice pair, before anybody has agreed');
    await begin(page);
    await ready(page);
    await page.waitForFunction(() => document.querySelectorAll('.half').length === 2);
    const codes = await page.evaluate(() => JSON.parse(Object.values(localStorage)[0]).form.questions);
    met = [codes[0], codes[1], codes[4]].includes(practice);
    if (met) {
      await context.close();
      continue;
    }
    while (asked.length < 3) await page.waitForTimeout(20);
    assert.deepEqual(asked, [practice, codes[0], codes[1]], 'and the next two while it is judged');
  }
  await answer(page, 'L');
  await answer(page, 'L');
  // From here on a pair takes two minutes, and three questions ahead it is not there yet, however slow this machine is.
  await page.waitForTimeout(2000);
  const throughput = (perSecond) => line.send('Network.emulateNetworkConditions', { offline: false, latency: 20, downloadThroughput: perSecond, uploadThroughput: bytes });
  await throughput(bytes / 120);
  await answer(page, 'L');
  await answer(page, 'L');
  await answer(page, 'L');
  await page.getByText(/^Loading, [1-9]\d* %$/).waitFor();
  assert.equal(await page.locator('.half').count(), 0, 'nothing of it is seen');
  const began = Date.now();
  await page.keyboard.press('1');
  assert.equal(await page.locator('#status').textContent(), 'Please wait until both pictures are loaded.');
  if (process.env.PICTURES) await page.screenshot({ path: path.join(process.env.PICTURES, 'loading.png') });
  await page.waitForTimeout(600);
  await throughput(100 * bytes);
  await page.locator('.half').first().waitFor();
  const waited = Date.now() - began;
  const at = Date.now();
  await answer(page, 'R');
  const looked = Date.now() - at;
  await page.waitForFunction(() => JSON.parse(Object.values(localStorage)[0]).answers?.[4]?.saved);
  const times = rows(await server.export()).map((line) => Number(line.rt_ms));
  assert.ok(waited > 500 && times[4] <= looked + 250, `${times[4]} ms, looked for ${looked} after ${waited}`);
  await server.stop();
});

test('a pair that cannot be loaded is tried again', async () => {
  const server = await serve('broken');
  const page = await open(server.address);
  // During consent, during the instructions, and when it is needed.
  let broken = 3;
  await page.route('**/stimuli/*', (route) => {
    broken -= 1;
    return broken >= 0 ? route.fulfill({ status: 200, contentType: 'image/gif', body: 'GIF89a' }) : route.continue();
  });
  await page.reload();
  await begin(page);
  await page.getByText('could not be loaded').waitFor();
  await answer(page, 'L');
  await server.stop();
});

test('time out of sight and dropped frames are kept', async () => {
  const server = await serve('hidden');
  const page = await open(server.address);
  await begin(page);
  await answer(page, 'L');
  await ready(page);
  const away = (hidden) => page.evaluate((now) => {
    Object.defineProperty(document, 'hidden', { configurable: true, get: () => now });
    document.dispatchEvent(new Event('visibilitychange'));
  }, hidden);
  await away(true);
  assert.equal(await page.getByRole('button', { name: 'Play' }).count(), 1, 'nothing turns unseen');
  await page.waitForTimeout(600);
  await away(false);
  await page.getByRole('button', { name: 'Pause' }).waitFor();
  await answer(page, 'R');
  await ready(page);
  // A frame lasts 100 ms here.
  await page.evaluate(() => { const until = performance.now() + 1000; while (performance.now() < until); });
  await page.waitForTimeout(100);
  await answer(page, 'L');
  await page.waitForFunction(() => JSON.parse(Object.values(localStorage)[0]).answers?.[1]?.saved);
  const [first, second] = rows(await server.export());
  assert.ok(Number(first.hidden_ms) >= 590 && Number(first.hidden_ms) < 3000 && Number(first.rt_ms) >= 1000, `${first.hidden_ms}`);
  assert.ok(second.hidden_ms === '0' && Number(second.dropped) >= 8 && Number(second.dropped) < 40, `${second.dropped}`);
  await server.stop();
});

test('a window that is too small asks for a larger one, and takes no answer', async () => {
  const page = await open(pathToFileURL(path.join(out, 'bundle/index.html')).href, { viewport: { width: 320, height: 480 } });
  await page.evaluate(() => { window.ISOSTUDY.min_surface_px = 200; });
  await page.getByLabel(/Your number/).fill('1');
  await begin(page);
  await page.getByText(/This window is too small: each picture has to be 200 pixels wide/).waitFor();
  await page.waitForTimeout(600);
  await page.keyboard.press('1');
  assert.match(await page.locator('h2').textContent(), /Practice 1/);
  assert.equal(await page.locator('.half').first().isVisible(), false);
  await page.setViewportSize({ width: 800, height: 700 });
  await answer(page, 'L');
});

test('videos are shown where there are some, both halves from one', async (t) => {
  if (spawnSync('ffmpeg', ['-version']).status !== 0) {
    t.skip('NO FFMPEG');
    return;
  }
  const moving = path.join(folder, 'videos');
  run('bundle', config, '--out', moving, '--mp4');
  const address = `${pathToFileURL(path.join(moving, 'bundle/index.html')).href}?form=2`;
  const server = await serve('moving', '0', { config, out: moving });
  // A canvas with frames of a file may not be read, one with frames from a server may.
  const watched = await open(server.address, { reducedMotion: 'reduce' });
  await begin(watched);
  await watched.getByRole('button', { name: 'Play' }).waitFor();
  const frames = () => watched.evaluate(async () => {
    const seen = new Set();
    for (let i = 0; i < 30; i += 1) {
      seen.add([...document.querySelectorAll('.half canvas')].map((half) => half.toDataURL()).join());
      await new Promise((resolve) => { setTimeout(resolve, 30); });
    }
    return seen.size;
  });
  assert.equal(await frames(), 1, 'a still pair until it is played');
  await watched.getByRole('button', { name: 'Play' }).click();
  assert.ok(await frames() > 2, 'it turns');
  await answer(watched, 'L');
  await server.stop();
  for (const options of [{}, PHONE]) {
    const page = await open(address, options);
    await begin(page);
    const given = await all(page, 'mouse');
    const answers = await page.evaluate(() => JSON.parse(Object.values(localStorage)[0]).answers);
    assert.deepEqual(answers.map(({ stimulus, choice }) => ({ code: stimulus, choice })), given);
    assert.ok(answers.every(({ screen }) => screen.shown_as === 'mp4'));
    await page.context().close();
  }
  // One that the browser cannot play gives way to the animation.
  const page = await open(address);
  await page.evaluate(() => { window.ISOSTUDY.media[0].kind = 'mov'; });
  await page.addInitScript(() => { Object.defineProperty(HTMLMediaElement.prototype, 'canPlayType', { value: () => '' }); });
  await page.reload();
  await begin(page);
  await answer(page, 'L');
  await answer(page, 'L');
  const [first] = await page.evaluate(() => JSON.parse(Object.values(localStorage)[0]).answers);
  assert.equal(first.screen.shown_as, 'gif');
});
