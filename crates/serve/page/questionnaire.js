// The questionnaire. One participant, one form: consent, training, questions, end.
//
// Everything that must survive a reload is in `session`, kept in localStorage after each change. Answers are only ever added.
// Without a server they stay there until they are downloaded; with one they are sent until each is acknowledged.
'use strict';

(() => {
  const study = window.ISOSTUDY;
  const KEY = `isostudy:${study.study}:${study.digest}`;
  const CHOICES = ['L', 'NP', 'R'];
  // The three keys of each answer: by number, and by the arrow that points to it.
  const KEYS = [['1', 'ArrowLeft'], ['2', 'ArrowDown'], ['3', 'ArrowRight']];
  const STILL = window.matchMedia('(prefers-reduced-motion: reduce)').matches;

  const $ = (id) => document.getElementById(id);
  const say = (text) => { $('status').textContent = text; };

  /** An element with properties and children. */
  function make(name, properties = {}, ...children) {
    const element = document.createElement(name);
    for (const [key, value] of Object.entries(properties)) {
      if (key in element) element[key] = value; else element.setAttribute(key, value);
    }
    element.append(...children);
    return element;
  }

  /** Shows a view and moves the focus to its heading, so that a screen reader begins there. */
  function show(...children) {
    $('view').replaceChildren(...children);
    const heading = $('view').querySelector('h2');
    (heading || $('title')).focus();
  }

  function heading(text) { return make('h2', { tabIndex: -1 }, text); }

  // ---- what survives a reload -------------------------------------------------------------------------------------

  let session = load();

  function load() {
    try {
      return JSON.parse(localStorage.getItem(KEY));
    } catch {
      return null;
    }
  }

  function keep() {
    try {
      localStorage.setItem(KEY, JSON.stringify(session));
    } catch {
      say('This browser does not let the page store your answers: do not close or reload it before the end.');
    }
  }

  function randomId() {
    const bytes = crypto.getRandomValues(new Uint8Array(8));
    return Array.from(bytes, (byte) => byte.toString(16).padStart(2, '0')).join('');
  }

  // ---- with a server ----------------------------------------------------------------------------------------------

  async function post(path, body) {
    const response = await fetch(path, {
      method: 'POST',
      headers: { 'content-type': 'application/json' },
      body: JSON.stringify(body),
    });
    if (!response.ok) {
      const error = new Error((await response.text()) || response.statusText);
      error.final = response.status >= 400 && response.status < 500 && response.status !== 429;
      throw error;
    }
    return response.json();
  }

  let sending = null;

  /** Sends what is not acknowledged, in order, until all is; one at a time however often it is called. */
  function send() {
    sending ??= sendAll().finally(() => { sending = null; });
    return sending;
  }

  async function sendAll() {
    for (let wait = 500; ;) {
      const next = session.answers.find((answer) => !answer.saved);
      if (!next) return;
      try {
        const { saved, answered, ...answer } = next;
        await post('api/answers', { token: session.token, ...answer });
        next.saved = true;
        keep();
        wait = 500;
        if (!session.answers.some((a) => !a.saved)) say('');
      } catch (error) {
        if (error.final) {
          say(`The server refused an answer: ${error.message}. Please tell the people who run the study.`);
          throw error;
        }
        say('No connection. Your answers are kept here and sent as soon as there is one.');
        await new Promise((resolve) => { setTimeout(resolve, wait); });
        wait = Math.min(wait * 2, 15000);
      }
    }
  }

  // ---- begin ------------------------------------------------------------------------------------------------------

  function consent() {
    $('progress-row').hidden = true;
    const begin = make('button', { type: 'button', className: 'main' }, 'I agree, begin');
    const parts = [heading('Before you begin'), make('p', { className: 'text' }, study.consent)];
    let number = null;
    if (!study.server) {
      const asked = Number(new URLSearchParams(location.search).get('form'));
      if (Number.isInteger(asked) && asked >= 1 && asked <= study.forms.length) {
        number = () => asked;
      } else {
        const input = make('input', { type: 'number', id: 'form', min: 1, max: study.forms.length, required: true });
        parts.push(make('div', { className: 'row' }, make('label', { htmlFor: 'form' }, `Your number, 1 to ${study.forms.length}`), input));
        number = () => (input.reportValidity() ? Number(input.value) : null);
      }
    }
    begin.addEventListener('click', async () => {
      const form = number ? number() : 0;
      if (form === null) return;
      begin.disabled = true;
      try {
        await start(form);
      } catch (error) {
        begin.disabled = false;
        say(error.final ? error.message : 'No connection to the study. Please try again.');
      }
    });
    show(...parts, make('div', { className: 'row' }, begin));
  }

  async function start(number) {
    const at = new Date().toISOString();
    if (study.server) {
      const query = new URLSearchParams(location.search);
      const given = (name) => query.get(name) ?? undefined;
      const dealt = await post('api/sessions', {
        prolific_pid: given('PROLIFIC_PID'), study_id: given('STUDY_ID'), session_id: given('SESSION_ID'),
      });
      session = { participant: dealt.participant, token: dealt.token, form: dealt.form, started: at, trained: 0, answers: [] };
      // Somebody who comes back in another browser goes on where the server's answers end.
      session.answers = Array.from({ length: dealt.answered }, () => ({ saved: true }));
    } else {
      const form = study.forms[number - 1];
      session = { participant: randomId(), form, started: at, trained: 0, answers: [] };
    }
    keep();
    say('');
    next();
  }

  // ---- the form ---------------------------------------------------------------------------------------------------

  function next() {
    const { form, trained, answers } = session;
    const all = form.training.length + form.questions.length;
    const done = trained < form.training.length && answers.length === 0 ? trained : form.training.length + answers.length;
    if (!session.instructed) return instructions();
    if (done === all) return end();
    $('progress-row').hidden = false;
    $('progress').max = all;
    $('progress').value = done;
    $('progress-text').textContent = `${done + 1} of ${all}`;
    if (done < form.training.length) {
      trial(form.training[done], `Practice ${done + 1}: this answer does not count`, () => {
        session.trained += 1;
      });
    } else {
      const place = done - form.training.length;
      trial(form.questions[place], `Question ${place + 1}`, (choice, times) => {
        session.answers.push({ order: done + 1, stimulus: form.questions[place], choice, ...times });
      });
    }
    preload(done + 1);
    return undefined;
  }

  function instructions() {
    $('progress-row').hidden = true;
    const go = make('button', { type: 'button', className: 'main' }, 'Go on');
    go.addEventListener('click', () => {
      session.instructed = true;
      keep();
      next();
    });
    const keys = 'Answer with the buttons, the keys 1, 2 and 3, or the arrows left, down and right. You can answer as soon as you have seen one whole turn.';
    show(heading('What to do'), make('p', { className: 'text' }, study.instructions), make('p', { className: 'text' }, keys),
      make('div', { className: 'row' }, go));
  }

  const source = (code) => `stimuli/${encodeURIComponent(code)}.gif`;

  function preload(place) {
    const codes = [...session.form.training, ...session.form.questions];
    if (place < codes.length) new Image().src = source(codes[place]);
  }

  /** One pair. `answer` is called once, with the choice and its times in milliseconds since the pair was on the screen. */
  function trial(code, title, answer) {
    const image = make('img', { alt: 'Two surfaces side by side, turning in step.', draggable: false });
    const still = make('canvas', { hidden: true, role: 'img', 'aria-label': 'Two surfaces side by side, stopped.' });
    const pair = make('div', { className: study.page_scale > 1 ? 'pair enlarged' : 'pair' }, image, still);
    const pause = make('button', { type: 'button' }, 'Pause');
    const buttons = CHOICES.map((choice, i) => make('button', { type: 'button', 'aria-disabled': 'true', 'data-choice': choice, 'aria-keyshortcuts': KEYS[i].join(' ') },
      study.choices[i], make('kbd', { 'aria-hidden': 'true' }, KEYS[i][0])));
    const question = make('fieldset', {}, make('legend', {}, study.prompt), make('div', { className: 'choices' }, ...buttons));

    // How long it has been seen moving; answers open at one whole turn.
    let shown = null;
    let moving = null;
    let watched = 0;
    let timer = 0;
    let open = false;
    let over = false;

    function unlock() {
      open = true;
      buttons.forEach((button) => button.removeAttribute('aria-disabled'));
      say('You can answer now.');
    }

    function play() {
      if (moving !== null || shown === null) return;
      still.hidden = true;
      image.hidden = false;
      moving = performance.now();
      pause.textContent = 'Pause';
      if (!open) timer = setTimeout(unlock, Math.max(0, study.loop_ms - watched));
    }

    function stop() {
      if (moving === null) return;
      watched += performance.now() - moving;
      moving = null;
      clearTimeout(timer);
      image.hidden = true;
      still.hidden = false;
      pause.textContent = 'Play';
    }

    function choose(i) {
      if (over) return;
      if (!open) {
        say(moving === null ? 'Please play one whole turn first.' : 'Please watch one whole turn first.');
        return;
      }
      over = true;
      document.removeEventListener('keydown', key);
      document.removeEventListener('visibilitychange', seen);
      say('');
      answer(CHOICES[i], { rt_ms: Math.round(performance.now() - shown), answered: new Date().toISOString() });
      keep();
      if (study.server) send().catch(() => {});
      next();
    }

    function key(event) {
      if (event.altKey || event.ctrlKey || event.metaKey || event.repeat) return;
      const i = KEYS.findIndex((keys) => keys.includes(event.key));
      if (i >= 0) {
        event.preventDefault();
        choose(i);
      }
    }

    // A tab in the background shows nothing.
    function seen() {
      if (document.hidden) stop(); else if (!STILL) play();
    }

    image.addEventListener('load', () => {
      const scale = study.page_scale;
      still.width = image.naturalWidth;
      still.height = image.naturalHeight;
      image.style.width = still.style.width = `${image.naturalWidth * scale}px`;
      still.getContext('2d').drawImage(image, 0, 0);
      shown = performance.now();
      image.hidden = true;
      still.hidden = false;
      pause.textContent = 'Play';
      if (!STILL && !document.hidden) play();
    });
    image.addEventListener('error', () => {
      say('The animation could not be loaded.');
      setTimeout(() => { if (!over) image.src = `${source(code)}?again=${Date.now()}`; }, 3000);
    });
    pause.addEventListener('click', () => (moving === null ? play() : stop()));
    buttons.forEach((button, i) => button.addEventListener('click', () => choose(i)));
    document.addEventListener('keydown', key);
    document.addEventListener('visibilitychange', seen);
    show(heading(title), pair, make('div', { className: 'row' }, pause), question);
    image.src = source(code);
  }

  // ---- end --------------------------------------------------------------------------------------------------------

  async function end() {
    $('progress-row').hidden = true;
    if (!study.server) {
      session.finished ??= new Date().toISOString();
      keep();
      const again = make('button', { type: 'button' }, 'Next participant');
      again.addEventListener('click', () => {
        if (!session.downloaded && !window.confirm('The answers have not been downloaded. Delete them here?')) return;
        localStorage.removeItem(KEY);
        session = null;
        consent();
      });
      show(heading('Thank you'), make('p', { className: 'text' }, 'That was the last question. Please download the answers and give them to the people who run the study.'),
        make('div', { className: 'row' }, download('CSV', 'text/csv', csv()), download('JSON', 'application/json', JSON.stringify(json(), null, 1)), again));
      return;
    }
    show(heading('Almost done'), make('p', {}, 'Your last answers are being saved.'));
    try {
      await send();
      const { completion } = await post('api/finish', { token: session.token });
      const parts = [heading('Thank you'), make('p', { className: 'text' }, 'All your answers are saved. You can close this page.')];
      if (completion && /^https:\/\//.test(completion)) {
        parts.push(make('div', { className: 'row' }, make('a', { href: completion, className: 'button main', rel: 'noreferrer' }, 'Finish')));
      } else if (completion) {
        parts.push(make('p', {}, 'Your completion code: ', make('span', { className: 'code' }, completion)));
      }
      show(...parts);
      say('');
    } catch (error) {
      if (!error.final) setTimeout(end, 2000);
    }
  }

  function rows() {
    return session.answers.map(({ order, stimulus, choice, rt_ms, answered }) => ({
      participant: session.participant, form: session.form.form, order, stimulus, choice, rt_ms, answered,
    }));
  }

  function csv() {
    const all = rows();
    const names = ['participant', 'form', 'order', 'stimulus', 'choice', 'rt_ms', 'answered'];
    return `${[names, ...all.map((row) => names.map((name) => row[name]))].map((cells) => cells.join(',')).join('\r\n')}\r\n`;
  }

  function json() {
    return { schema: 1, study: study.study, participant: session.participant, form: session.form.form, started: session.started, finished: session.finished, answers: rows() };
  }

  function download(kind, type, text) {
    const link = make('a', { className: kind === 'CSV' ? 'button main' : 'button', download: `${study.study}-${session.participant}.${kind.toLowerCase()}`,
      href: URL.createObjectURL(new Blob([text], { type })) }, `Download ${kind}`);
    link.addEventListener('click', () => {
      session.downloaded = true;
      keep();
    });
    return link;
  }

  // ---- go ---------------------------------------------------------------------------------------------------------

  document.title = study.title;
  $('title').textContent = study.title;
  if (session) {
    if (study.server) send().catch(() => {});
    next();
  } else {
    consent();
  }
})();
