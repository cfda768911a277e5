// Pictures and films of a study's own, on a phone and by keyboard. Run by scripts/test-browser.sh.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import path from 'node:path';
import test from 'node:test';
import { crc32, deflateSync } from 'node:zlib';
import { PHONE, answer, asGiven, begin, folder, open, ready, rows, run, serious, serve } from './walk.mjs';

/** A PNG of one colour. */
function png([red, green, blue], width, height) {
  const number = (value) => { const bytes = Buffer.alloc(4); bytes.writeUInt32BE(value); return bytes; };
  const crc = (bytes) => {
    if (crc32) return crc32(bytes);
    let sum = 0xffffffff;
    for (const byte of bytes) {
      sum ^= byte;
      for (let bit = 0; bit < 8; bit += 1) sum = sum & 1 ? (sum >>> 1) ^ 0xedb88320 : sum >>> 1;
    }
    return (sum ^ 0xffffffff) >>> 0;
  };
  const chunk = (kind, content) => {
    const body = Buffer.concat([Buffer.from(kind), content]);
    return Buffer.concat([number(content.length), body, number(crc(body) >>> 0)]);
  };
  const row = Buffer.concat([Buffer.from([0]), Buffer.concat(Array(width).fill(Buffer.from([red, green, blue])))]);
  return Buffer.concat([
    Buffer.from('\x89PNG\r\n\x1a\n', 'latin1'),
    chunk('IHDR', Buffer.concat([number(width), number(height), Buffer.from([8, 2, 0, 0, 0])])),
    chunk('IDAT', deflateSync(Buffer.concat(Array(height).fill(row)))),
    chunk('IEND', Buffer.alloc(0)),
  ]);
}

const COLOURS = { a: [200, 30, 30], b: [30, 160, 30], c: [30, 30, 200] };

/** A study of three methods on one object, shown by files that end so; what is in them is made beside it. */
function study(name, ending, keys = '') {
  const made = { config: path.join(folder, `${name}.toml`), out: path.join(folder, `${name}-results`), words: ['--with-faults'] };
  const methods = Object.keys(COLOURS);
  const pairs = [['a', 'b'], ['a', 'c'], ['b', 'c']];
  fs.writeFileSync(made.config, `schema = 1
[study]
id = "${name}"
title = "Pictures"
seed = 3
[[objects]]
id = "room"
name = "Room"
${methods.map((id) => `[[methods]]\nid = "${id}"\nlabel = "Method ${id}"`).join('\n')}
[stimuli]
duration_s = 0.4
files = [${methods.map((id) => `{ configuration = "room_${id}", file = "${name}-${id}.${ending}" }`).join(', ')}]
${pairs.map(([left, right], i) => `[[comparisons]]\nquestion = "Q${i + 1}"\nleft = "room_${left}"\nright = "room_${right}"`).join('\n')}
[[groups]]
id = "all"
label = "Methods"
members = ["a", "b", "c"]
[forms]
prompt = "Which picture do you like better?"
consent = "You will see pairs of pictures."
instructions = "Look at both pictures, then choose."
participants = 12
sides = "balanced"
order = "latin-square"
names = "code-names"
controls = 0
repeats = 0
max_questions = 3
contact = "Ada Lovelace"
ethics = "Board 17"
least_age = 18
retention_days = 30
completion = "C0DE-42"
${keys}`);
  return made;
}

/** What is in the middle of each half, as red, green and blue. */
const colours = (page) => page.evaluate(() => [...document.querySelectorAll('.half')].map((half) => {
  const canvas = document.createElement('canvas');
  [canvas.width, canvas.height] = [1, 1];
  const still = half.querySelector('canvas');
  const context = canvas.getContext('2d');
  context.drawImage(still, still.width / 2, still.height / 2, 1, 1, 0, 0, 1, 1);
  return [...context.getImageData(0, 0, 1, 1).data].slice(0, 3);
}));

/** What stands on the sides of a code's pair. */
function sides(made, ending) {
  const key = fs.readFileSync(path.join(made.out, 'key/stimuli.csv'), 'utf8').trim().split('\n').slice(1).map((line) => line.split(','));
  return Object.fromEntries(key.filter(([file]) => file.endsWith(ending)).map(([file, , left, right]) => [path.basename(file, ending), [left, right].map((id) => id.split('_')[1])]));
}

test('still pictures stand beside each other, have nothing to play, and can be answered after their time', async () => {
  const made = study('stills', 'png');
  for (const [id, colour] of Object.entries(COLOURS)) fs.writeFileSync(path.join(folder, `stills-${id}.png`), png(colour, 160, 120));
  run('bundle', made.config, '--out', made.out, '--with-faults');
  const known = sides(made, '.png');
  const server = await serve(made, 'stills-answers');
  const given = [];
  for (const options of [PHONE, { viewport: { width: 1280, height: 800 } }, { ...PHONE, reducedMotion: 'reduce' }]) {
    const page = await open(server.address, options);
    await begin(page);
    for (let i = 0; i < 3; i += 1) {
      await ready(page);
      const code = await page.locator('.pair').getAttribute('data-code');
      assert.deepEqual(await colours(page), known[code].map((id) => COLOURS[id]), code);
      assert.equal(await page.getByRole('button', { name: /^(Play|Pause)$/ }).count(), 0);
      assert.deepEqual(await page.locator('.half canvas').evaluateAll((all) => all.map((one) => one.getAttribute('aria-label'))), ['Left picture.', 'Right picture.']);
      assert.deepEqual(await serious(page), []);
      if (i === 0 && process.env.PICTURES) await page.screenshot({ path: path.join(process.env.PICTURES, `own-${options.viewport.width}.png`) });
      given.push(await answer(page, ['L', 'NP', 'R'][i], options === PHONE ? 'mouse' : { L: '1', NP: '2', R: '3' }));
    }
    await page.getByText('C0DE-42').waitFor();
  }
  const lines = rows(await server.export());
  assert.deepEqual(lines.map(asGiven), given);
  assert.ok(lines.every((line) => line.shown_as === 'png' && Number(line.rt_ms) >= 400), JSON.stringify(lines[0]));
  await server.stop();
});

const hasFfmpeg = spawnSync('ffmpeg', ['-version']).status === 0;
test('films play in step', { skip: hasFfmpeg ? false : 'NO FFMPEG' }, async () => {
  const made = study('films', 'mp4');
  for (const [id, [red, green, blue]] of Object.entries(COLOURS)) {
    const colour = `0x${[red, green, blue].map((of) => of.toString(16).padStart(2, '0')).join('')}`;
    const done = spawnSync('ffmpeg', ['-v', 'error', '-f', 'lavfi', '-i', `color=${colour}:size=160x120:rate=20:duration=0.4`, '-pix_fmt', 'yuv420p', path.join(folder, `films-${id}.mp4`)], { encoding: 'utf8' });
    assert.equal(done.status, 0, done.stderr);
  }
  run('bundle', made.config, '--out', made.out, '--with-faults');
  const known = sides(made, '.gif');
  const server = await serve(made, 'films-answers');
  const page = await open(server.address, PHONE);
  await begin(page);
  for (let i = 0; i < 3; i += 1) {
    await ready(page);
    const code = await page.locator('.pair').getAttribute('data-code');
    await page.getByRole('button', { name: 'Pause' }).click();
    const found = await colours(page);
    for (const [side, id] of known[code].entries()) {
      assert.ok(found[side].every((of, k) => Math.abs(of - COLOURS[id][k]) < 24), `${found[side]} is not ${COLOURS[id]}`);
    }
    await answer(page, 'L');
  }
  await page.getByText('C0DE-42').waitFor();
  assert.ok(['mp4', 'webm'].includes(rows(await server.export())[0].shown_as));
  await server.stop();
});
