// Questions about people, their rights, panels and quotas, on a phone. Run by scripts/test-browser.sh.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import test from 'node:test';
import { pathToFileURL } from 'node:url';
import { CHOICES, PHONE, all, answer, asGiven, folder, open, over, questionnaire, ready, rows, run, serious } from './walk.mjs';

const ABOUT = `
[[forms.about]]
id = "vision"
kind = "colour-vision"
screens_out = [3]
most = [2, 0, 0, 0]
[[forms.about]]
id = "tools"
kind = "multiple"
ask = "Which tools do you use?"
options = ["Pencils", "Brushes", "Computers"]
[[forms.about]]
id = "age"
kind = "number"
ask = "How old are you?"
from = 18
to = 99
optional = true
[[forms.about]]
id = "careful"
kind = "scale"
ask = "Please choose 2 here."
ends = ["low", "high"]
when = "after"
expects = 2
`;
const KEYS = `contact = "Ada Lovelace, ada@university.example"
ethics = "Board 17"
least_age = 18
retention_days = 365
comment = true
go_back = true
panel = "sona"
completion_withdrawn = "GONE-1"
completion_screened = "OTHER-2"
completion_full = "FULL-3"
`;
const SONA = 'completion = "https://example.org/credit?code={survey_code}&x=1"';
const made = questionnaire('people', (text) => text.replace('[forms]', `[forms]\n${KEYS}`).replace(/^completion = .*$/m, SONA).replace('\n[analysis]', `${ABOUT}\n[analysis]`));
const page = (address, options = PHONE) => open(address, options);

/** Chooses what is called so, and goes on. */
async function choose(on, ...names) {
  for (const name of names) await on.getByLabel(name, { exact: true }).check();
  await on.getByRole('button', { name: 'Go on' }).click();
}
const asked = (on, text) => on.getByText(text, { exact: true }).waitFor();
const fits = async (on, where) => {
  assert.deepEqual(await serious(on), [], where);
  const wide = await over(on);
  assert.ok(wide <= 0, `${where} is ${wide} px too wide`);
};
const agree = (on) => on.getByRole('button', { name: 'I agree, begin' }).click();
const stored = (on) => on.evaluate(() => localStorage.length);
/** Files of a folder that hold a text. */
const holding = (at, text) => fs.readdirSync(at).filter((name) => fs.readFileSync(path.join(at, name)).includes(text));

test('what people say of themselves is asked before and after, kept apart, and shared only where five say the same', async () => {
  const server = await made.serve('about');
  const one = await page(`${server.address}?survey_code=4711`);
  await one.getByText('Whom you can ask: Ada Lovelace').waitFor();
  await one.getByText('The study was approved: Board 17').waitFor();
  await one.getByText('You must be at least 18 years old.').waitFor();
  await one.getByText('for 365 days after').waitFor();
  await fits(one, 'consent');
  await agree(one);
  await asked(one, 'How well do you tell colours apart?');
  await fits(one, 'a choice');
  // Nothing was chosen yet.
  await one.getByRole('button', { name: 'Go on' }).click();
  await one.getByText('choose the last option').waitFor();
  await choose(one, 'As most people do');
  await asked(one, 'Which tools do you use?');
  await fits(one, 'several choices');
  await one.getByLabel('Pencils').check();
  await one.getByLabel('Rather not say').check();
  assert.equal(await one.getByLabel('Pencils').isChecked(), false);
  await choose(one, 'Pencils', 'Computers');
  await asked(one, 'How old are you?');
  assert.equal(await one.getByLabel('Rather not say').count(), 1);
  await one.getByRole('spinbutton').fill('7');
  await one.getByRole('button', { name: 'Go on' }).click();
  await one.getByText('choose the last option').waitFor();
  await one.getByRole('spinbutton').fill('31');
  await fits(one, 'a number');
  // Until a pair was judged nothing is written down, and a reload asks again from where it was.
  await one.reload();
  await asked(one, 'How old are you?');
  await one.getByRole('spinbutton').fill('31');
  await one.getByRole('button', { name: 'Go on' }).click();
  await one.getByRole('button', { name: 'Go on' }).click();
  await answer(one, 'L');
  const given = [];
  for (const choice of CHOICES) given.push(await answer(one, choice));
  await asked(one, 'Please choose 2 here.');
  await fits(one, 'a scale');
  await choose(one, '2');
  await asked(one, 'Is there anything that you would like to tell us?');
  await one.getByRole('textbox').fill('A comment, with "words"');
  await fits(one, 'a comment');
  await one.getByRole('button', { name: 'Go on' }).click();
  const finish = one.getByRole('link', { name: 'Finish' });
  assert.equal(await finish.getAttribute('href'), 'https://example.org/credit?code=4711&x=1');
  await fits(one, 'the end');

  // By keys alone, on a large screen: somebody who would rather say nothing.
  const two = await page(server.address, { viewport: { width: 1280, height: 800 } });
  await agree(two);
  for (const question of ['How well do you tell', 'Which tools']) {
    await two.getByText(question).waitFor();
    await two.getByLabel('Rather not say').focus();
    await two.keyboard.press('Space');
    await two.keyboard.press('Enter');
  }
  await two.getByText('How old').waitFor();
  await two.getByRole('button', { name: 'Skip' }).focus();
  await two.keyboard.press('Enter');
  await two.getByRole('button', { name: 'Go on' }).click();
  await all(two, { L: '1', NP: '2', R: '3' });
  await choose(two, '5');
  await two.getByRole('button', { name: 'Skip' }).click();
  await two.getByText('All your answers are saved').waitFor();

  const [first] = rows(await server.export());
  const about = await server.export('about.csv');
  const told = rows(about.replace('"A comment, with ""words"""', 'comment'));
  const of = Object.fromEntries(told.map(({ participant, ...said }) => [participant === first.participant ? 'one' : 'two', said]));
  assert.deepEqual(of, {
    one: { vision: 'As most people do', tools: 'Pencils; Computers', age: '31', careful: '2', attention: '1 of 1', comment: 'comment' },
    two: { vision: 'declined', tools: 'declined', age: '', careful: '5', attention: '0 of 1', comment: '' },
  });
  assert.deepEqual(rows(await server.export()).slice(0, 6).map(asGiven), given);
  assert.deepEqual(holding(server.answers, 'A comment, with').filter((name) => name.startsWith('answers')), []);
  const shownTo = JSON.parse(await server.export('shown.json'));
  assert.equal(shownTo.people.length, 2);
  assert.equal(shownTo.people[0].pairs.length, 6);
  assert.equal(shownTo.languages[0].texts.go_on, 'Go on');
  await server.stop();

  const shared = path.join(folder, 'shared-about');
  run('deidentify', made.config, '--answers', server.answers, '--out', shared);
  const open_set = fs.readFileSync(path.join(shared, 'about.csv'), 'utf8');
  assert.match(open_set, /^participant,vision,tools,age,careful,attention\n/);
  assert.ok(rows(open_set).every((row) => row.vision === 'merged' && row.age === 'merged'), open_set);
  assert.match(fs.readFileSync(path.join(shared, 'codebook.md'), 'utf8'), /fewer than 5 people/);
  assert.ok(!open_set.includes(first.participant));
});

test('who declines, or is screened out, or comes too late leaves nothing', async () => {
  const server = await made.serve('nobody');
  const one = await page(server.address);
  const sent = [];
  one.on('request', (request) => { if (request.method() === 'POST') sent.push(request.url()); });
  await one.getByRole('button', { name: 'I do not want to take part' }).click();
  await one.getByText('Nothing is kept.').waitFor();
  await one.getByText('GONE-1').waitFor();
  await fits(one, 'declined');
  assert.deepEqual([sent, await stored(one)], [[], 0]);
  await one.reload();
  await agree(one);
  await choose(one, 'Other colours are hard to tell apart');
  await one.getByText('looks for other people').waitFor();
  await one.getByText('OTHER-2').waitFor();
  assert.equal(await stored(one), 0);
  // Two people see as most do, and that is enough.
  for (let i = 0; i < 2; i += 1) {
    const other = await page(server.address);
    await agree(other);
    await choose(other, 'As most people do');
    await asked(other, 'Which tools do you use?');
  }
  await one.reload();
  await agree(one);
  await choose(one, 'As most people do');
  await one.getByText('FULL-3').waitFor();
  assert.equal(await stored(one), 0);
  const { departures, people } = JSON.parse(await server.export('shown.json'));
  assert.deepEqual([departures, people], [{ withdrawn: 0, screened_out: 1, full: 1 }, []]);
  assert.equal(rows(await server.export()).length, 0);
  await server.stop();
});

test('a receipt deletes answers at any time, and of what was deleted nothing is left in the folder', async () => {
  const server = await made.serve('receipt');
  const finished = async (code, age) => {
    const one = await page(`${server.address}?survey_code=${code}`);
    await agree(one);
    await choose(one, 'Rather not say');
    await choose(one, 'Brushes');
    await one.getByRole('spinbutton').fill(age);
    await one.getByRole('button', { name: 'Go on' }).click();
    await one.getByRole('button', { name: 'Go on' }).click();
    await all(one, 'mouse');
    await choose(one, '7');
    await one.getByRole('button', { name: 'Skip' }).click();
    await one.getByText('All your answers are saved').waitFor();
    return { page: one, receipt: await one.locator('#receipt').textContent() };
  };
  const stays = await finished('code-of-who-stays', '44.25');
  const goes = await finished('code-of-who-goes', '55.125');
  assert.match(goes.receipt, /^[0-9a-f]{4}(-[0-9a-f]{4}){3}$/);
  for (const trace of ['code-of-who-goes', '55.125', goes.receipt.replaceAll('-', '')]) assert.ok(holding(server.answers, trace).length > 0, trace);
  // In another browser, by the link on the first screen; a wrong code deletes nothing.
  const other = await page(server.address);
  await other.getByRole('button', { name: 'Delete answers' }).click();
  await fits(other, 'withdraw');
  await other.getByLabel('Your receipt code:').fill('0000-0000-0000-0000');
  await other.getByRole('button', { name: 'Delete answers' }).click();
  await other.getByText('Nothing is kept under this code.').waitFor();
  await other.goto(`${server.address}?withdraw`);
  await other.getByLabel('Your receipt code:').fill(goes.receipt.toUpperCase());
  await other.getByRole('button', { name: 'Delete answers' }).click();
  await other.getByText('Nothing of you is kept.').waitFor();
  for (const trace of ['code-of-who-goes', '55.125', goes.receipt.replaceAll('-', '')]) {
    assert.deepEqual(holding(server.answers, trace), [], trace);
    for (const file of ['answers.csv', 'about.csv', 'identities.csv', 'shown.json']) assert.ok(!(await server.export(file)).includes(trace), `${file} ${trace}`);
    assert.ok(!server.said().includes(trace), 'the log');
  }
  assert.equal(holding(server.answers, 'code-of-who-stays').length > 0, true);
  assert.equal(rows(await server.export()).length, 6);

  // Half-way, by the button of a question: first he goes on, then he leaves what he has answered, or has it deleted.
  const half = async (act) => {
    const one = await page(server.address);
    await agree(one);
    await choose(one, 'Rather not say');
    await choose(one, 'Brushes');
    await one.getByRole('button', { name: 'Skip' }).click();
    await one.getByRole('button', { name: 'Go on' }).click();
    await answer(one, 'L');
    await answer(one, 'R');
    await one.getByRole('button', { name: 'Stop' }).click();
    await fits(one, 'stop');
    await one.getByRole('button', { name: 'Go on' }).click();
    await answer(one, 'NP');
    await one.getByRole('button', { name: 'Stop', exact: true }).click();
    await one.getByRole('button', { name: act }).click();
    return one;
  };
  const left = await half('Stop and leave my answers');
  await left.getByText('are left to the study').waitFor();
  await left.getByText('GONE-1').waitFor();
  assert.match(await left.locator('#receipt').textContent(), /^[0-9a-f]{4}-/);
  assert.equal(rows(await server.export()).length, 8);
  const deleted = await half('Stop and delete my answers');
  await deleted.getByText('Nothing of you is kept.').waitFor();
  assert.deepEqual([rows(await server.export()).length, await stored(deleted)], [8, 0]);
  assert.equal(JSON.parse(await server.export('shown.json')).departures.withdrawn, 2);
  // After a restart nothing is missed.
  await server.stop();
  const again = await made.serve('receipt');
  assert.equal(rows(await again.export()).length, 8);
  await stays.page.context().close();
  await again.stop();
});

test('the last answer can be changed, and no earlier one', async () => {
  const server = await made.serve('back');
  const one = await page(server.address);
  await agree(one);
  await choose(one, 'Rather not say');
  await choose(one, 'Brushes');
  await one.getByRole('button', { name: 'Skip' }).click();
  await one.getByRole('button', { name: 'Go on' }).click();
  await answer(one, 'L');
  assert.equal(await one.getByRole('button', { name: 'Back' }).isVisible(), false, 'nothing that counts was answered');
  const first = await answer(one, 'L');
  await one.getByRole('heading', { name: 'Question 2' }).waitFor();
  await one.getByRole('button', { name: 'Back' }).click();
  await one.getByRole('heading', { name: 'Question 1' }).waitFor();
  assert.equal(await one.getByRole('button', { name: 'Back' }).isVisible(), false);
  await fits(one, 'a question again');
  assert.deepEqual(await answer(one, 'R'), { code: first.code, choice: 'R' });
  const second = await answer(one, 'NP');
  // Without a connection, and after a reload, the change arrives as well.
  await ready(one);
  await one.route('**/api/answers', (route) => route.abort());
  await one.getByRole('button', { name: 'Back' }).click();
  await answer(one, 'L');
  await one.unroute('**/api/answers');
  await one.reload();
  for (const choice of CHOICES.slice(2)) await answer(one, choice);
  await choose(one, 'Rather not say');
  await one.getByRole('button', { name: 'Skip' }).click();
  await one.getByText('All your answers are saved').waitFor();
  const lines = rows(await server.export());
  assert.deepEqual(lines.slice(0, 2).map(asGiven), [{ code: first.code, choice: 'R' }, { code: second.code, choice: 'L' }]);
  assert.deepEqual(lines.slice(2).map((line) => line.choice), CHOICES.slice(2));
  const { people } = JSON.parse(await server.export('shown.json'));
  assert.deepEqual(people[0].pairs.map((pair) => pair.changed), [1, 1, 0, 0, 0, 0]);
  await server.stop();
});

test('from a folder, what people say of themselves is in their JSON file, and nobody leaves more than is wanted', async () => {
  const address = `${pathToFileURL(path.join(made.out, 'bundle/index.html')).href}?form=2`;
  const one = await page(address);
  await agree(one);
  await choose(one, 'As most people do');
  await choose(one, 'Pencils', 'Brushes');
  await one.getByRole('spinbutton').fill('31');
  await one.getByRole('button', { name: 'Go on' }).click();
  await one.getByRole('button', { name: 'Go on' }).click();
  const given = await all(one, 'mouse');
  await choose(one, '2');
  await one.getByRole('textbox').fill('words');
  await one.getByRole('button', { name: 'Go on' }).click();
  const download = one.waitForEvent('download');
  await one.getByRole('link', { name: 'Download JSON' }).click();
  const file = path.join(folder, 'about.json');
  await (await download).saveAs(file);
  const [joined, about] = [path.join(folder, 'about-joined.csv'), path.join(folder, 'about-joined-people.csv')];
  run('collect', made.config, file, '--out', joined, '--about', about);
  assert.deepEqual(rows(fs.readFileSync(joined, 'utf8')).map(asGiven), given);
  const [{ participant, ...said }] = rows(fs.readFileSync(about, 'utf8'));
  assert.equal(participant, rows(fs.readFileSync(joined, 'utf8'))[0].participant);
  assert.deepEqual(said, { vision: 'As most people do', tools: 'Pencils; Brushes', age: '31', careful: '2', attention: '1 of 1', comment: 'words' });

  const other = await page(`${pathToFileURL(path.join(made.out, 'bundle/index.html')).href}?form=3`);
  await agree(other);
  await choose(other, 'Other colours are hard to tell apart');
  await other.getByText('looks for other people').waitFor();
  assert.equal(await stored(other), 0);
});
