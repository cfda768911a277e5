// The questionnaire. One participant, one form: consent, training, questions, end.
//
// Everything that must survive a reload is in `session`, kept in localStorage after each change. Tabs of one participant share it,
// and whichever answered first counts. Without a server answers stay there until they are downloaded; with one they are sent
// until each is acknowledged.
'use strict';

(() => {
  const study = window.ISOSTUDY;
  // Who somebody is, as far as the address says: others in the same browser have a session of their own.
  const address = new URLSearchParams(location.search);
  const given = (name) => address.get(name) ?? undefined;
  const WHO = study.server ? ['PROLIFIC_PID', 'STUDY_ID', 'SESSION_ID'] : ['form'];
  const KEY = `isostudy:${JSON.stringify([study.study, study.digest, ...WHO.map((name) => given(name) ?? null)])}`;
  // Keys are explained to those who have them.
  const TOUCH = window.matchMedia('(hover: none) and (pointer: coarse)').matches;

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

  // Ends what the view on the screen has begun: clocks, keys.
  let leave = () => {};

  /** Shows a view and moves the focus to its heading, so that a screen reader begins there. */
  function show(...children) {
    leave();
    leave = () => {};
    document.body.className = '';
    $('view').replaceChildren(...children);
    const heading = $('view').querySelector('h2');
    (heading || $('title')).focus();
  }

  function heading(text) { return make('h2', { tabIndex: -1 }, text); }

  const loading = window.isostudyLoading(study);
  const trial = window.isostudyTrial({ study, loading, make, say, heading, show, touch: TOUCH });

  // ---- what survives a reload -------------------------------------------------------------------------------------

  let session = load();

  function load() {
    try {
      return JSON.parse(localStorage.getItem(KEY));
    } catch {
      return null;
    }
  }

  function store() {
    try {
      localStorage.setItem(KEY, JSON.stringify(session));
    } catch {
      say('This browser does not let the page store your answers: do not close or reload it before the end.');
    }
  }

  /** Takes over what another tab has stored of the same form. */
  function merge() {
    const stored = load();
    if (!session || stored?.participant !== session.participant) return;
    stored.answers.forEach((theirs, i) => {
      const mine = session.answers[i];
      if (mine && mine.choice === theirs.choice) mine.saved ||= theirs.saved; else session.answers[i] = theirs;
    });
    session.trained = Math.max(session.trained, stored.trained);
    session.instructed ||= stored.instructed;
  }

  function keep() {
    merge();
    store();
  }

  /** How much of the form is done, training included. */
  function done() {
    const { form, trained, answers } = session;
    return trained < form.training.length && answers.length === 0 ? trained : form.training.length + answers.length;
  }

  // The place on the screen.
  let place = null;

  window.addEventListener('storage', (event) => {
    if (event.key !== KEY && event.key !== null) return;
    const stored = load();
    if (stored?.participant === session?.participant) {
      merge();
      if (session && place !== null && place !== done()) next();
    } else {
      session = stored;
      if (session) next(); else consent();
    }
  });

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
      error.refusal = response.headers.get('isostudy-refusal');
      // Whatever else goes wrong between here and the server may pass.
      error.final = error.refusal !== null || [400, 413, 415, 422].includes(response.status);
      error.conflict = error.final && response.status === 409;
      error.busy = response.status === 429;
      throw error;
    }
    return response.json();
  }

  /** Asks until there is a reply. `null` where there will be none, which has then been said; a conflict is the caller's. */
  async function insist(path, body) {
    for (let wait = 500; ; wait = Math.min(wait * 2, 15000)) {
      try {
        return await post(path, body);
      } catch (error) {
        if (body.token !== session?.token) return null;
        if (error.conflict) throw error;
        if (error.refusal === 'unknown-token') return forget();
        if (error.final) return refused(error);
        say('No connection. Your answers are kept here and sent as soon as there is one.');
        await new Promise((resolve) => { setTimeout(resolve, wait); });
      }
    }
  }

  let sending = null;

  /** Sends what is not acknowledged, in order; one at a time however often it is called. Returns whether all is. */
  function send() {
    sending ??= sendAll().finally(() => { sending = null; });
    return sending;
  }

  async function sendAll() {
    for (let conflict = null; session;) {
      const next = session.answers.find((answer) => !answer.saved);
      if (!next) return true;
      const { saved, answered, ...answer } = next;
      const { token } = session;
      try {
        if (!await insist('api/answers', { token, ...answer })) {
          if (session && session.token !== token) continue;
          return false;
        }
        next.saved = true;
        keep();
        if (!session.answers.some((a) => !a.saved)) say('');
      } catch (error) {
        if (!error.conflict) throw error;
        if (conflict === next.order) {
          refused(error);
          return false;
        }
        conflict = next.order;
        if (!await catchUp()) return false;
      }
    }
    return false;
  }

  /** Goes on from the answers that the server has: more of them from elsewhere, or fewer than it once had. */
  async function catchUp() {
    const state = await insist('api/state', { token: session.token });
    if (!state) return false;
    const theirs = Array.from({ length: state.answered }, (_, i) => (session.answers[i]?.saved ? session.answers[i] : { saved: true }));
    const mine = session.answers.slice(state.answered);
    const lost = mine.findIndex((answer) => !answer.choice);
    session.answers = [...theirs, ...(lost < 0 ? mine : mine.slice(0, lost)).map((answer) => ({ ...answer, saved: false }))];
    store();
    if (place !== null && place !== done()) next();
    return true;
  }

  /** The server has nothing of this session: whatever is answered here would be lost. */
  function forget() {
    const lost = session;
    localStorage.removeItem(KEY);
    session = null;
    consent(lost);
    say('The study does not know this session any more. Please begin again.');
    return null;
  }

  /** The server will never take an answer: nobody is to give more of them. */
  function refused(error) {
    const again = make('button', { type: 'button' }, 'Try again');
    again.addEventListener('click', () => location.reload());
    place = null;
    $('progress-row').hidden = true;
    show(heading('Your answers could not be saved'), make('p', { className: 'text' }, `The server says: ${error.message}. Please download your answers and tell the people who run the study.`),
      make('div', { className: 'row' }, ...downloads(session), again));
    say('');
    return null;
  }

  // ---- begin ------------------------------------------------------------------------------------------------------

  // Whether somebody has taken part before in this page, so that the number in its address is not of the next one.
  let follows = false;

  /** `lost` is a session of which the server knows nothing. */
  function consent(lost = null) {
    place = null;
    $('progress-row').hidden = true;
    const begin = make('button', { type: 'button', className: 'main' }, 'I agree, begin');
    const parts = [heading('Before you begin'), make('p', { className: 'text' }, study.consent),
      make('p', { className: 'text' }, 'With each answer is kept how it was shown: the size of this window, the pixels of the screen, mouse, touch or keys, pictures that were left out, and how long the page was out of sight. The name of your browser is not.')];
    if (study.server && WHO.some(given)) {
      parts.push(make('p', { className: 'text' }, 'The address of this page names you by an identifier of the panel that sent you. It is kept apart from your answers, to tell the panel that you took part.'));
    }
    let number = null;
    if (!study.server) {
      const input = make('input', { type: 'number', id: 'form', min: 1, max: study.forms.length, required: true, value: follows ? '' : given('form') ?? '' });
      const asked = make('div', { className: 'row' }, make('label', { htmlFor: 'form' }, `Your number, 1 to ${study.forms.length}`), input);
      asked.hidden = input.value !== '' && input.validity.valid;
      parts.push(asked);
      number = () => (input.reportValidity() ? Number(input.value) : null);
    }
    if (lost?.answers.some((answer) => answer.choice)) {
      parts.push(make('p', { className: 'text' }, 'Your earlier answers can be downloaded for the people who run the study.'), make('div', { className: 'row' }, ...downloads(lost)));
    }
    begin.addEventListener('click', async () => {
      const form = number ? number() : 0;
      if (form === null) return;
      begin.disabled = true;
      try {
        await start(form);
      } catch (error) {
        begin.disabled = false;
        say(error.final || error.busy ? error.message : 'No connection to the study. Please try again.');
      }
    });
    show(...parts, make('div', { className: 'row' }, begin));
    // What everybody is shown first, while this is read.
    loading.ahead(null, study.first.slice(0, 1));
  }

  async function start(number) {
    const at = new Date().toISOString();
    if (study.server) {
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

  // Pairs that are fetched while one is judged.
  const AHEAD = 2;

  function next() {
    const { form } = session;
    const all = form.training.length + form.questions.length;
    place = null;
    if (!session.instructed) return instructions();
    place = done();
    if (place === all) return end();
    $('progress-row').hidden = false;
    const codes = [...form.training, ...form.questions];
    const practice = place < form.training.length;
    const question = place - form.training.length;
    // What does not count is not in the bar either.
    $('progress').hidden = practice;
    $('progress').max = form.questions.length;
    $('progress').value = Math.max(question, 0);
    $('progress-text').textContent = practice ? 'This answer does not count.' : `${question + 1} of ${form.questions.length}`;
    const title = practice ? `Practice ${place + 1}` : `Question ${question + 1}`;
    leave = trial(codes[place], title, codes.slice(place + 1, place + 1 + AHEAD), (choice, times, screen) => {
      merge();
      if (place !== done()) {
        say('This question has been answered in another tab.');
      } else {
        say('');
        if (practice) session.trained += 1;
        else session.answers.push({ order: place + 1, stimulus: codes[place], choice, ...times, screen });
        keep();
      }
      if (study.server) send();
      next();
    });
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
    const how = TOUCH ? 'Tap the surfaces to see them larger, and again to go back.' : 'Answer with the buttons, the keys 1, 2 and 3, or the arrows left, down and right. Click the surfaces to see them larger, and again to go back.';
    show(heading('What to do'), make('p', { className: 'text' }, study.instructions), make('p', { className: 'text' }, `${how} You can answer as soon as you have seen one whole turn.`),
      make('div', { className: 'row' }, go));
    const { training, questions } = session.form;
    loading.ahead(null, [...training, ...questions].slice(0, 1));
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
        follows = true;
        consent();
      });
      show(heading('Thank you'), make('p', { className: 'text' }, 'That was the last question. Please download the answers and give them to the people who run the study.'),
        make('div', { className: 'row' }, ...downloads(session), again));
      return;
    }
    show(heading('Almost done'), make('p', {}, 'Your last answers are being saved.'));
    try {
      if (!await send()) return;
      const reply = await insist('api/finish', { token: session.token });
      if (!reply) return;
      const parts = [heading('Thank you'), make('p', { className: 'text' }, 'All your answers are saved. You can close this page.')];
      if (reply.completion && /^https:\/\//.test(reply.completion)) {
        parts.push(make('div', { className: 'row' }, make('a', { href: reply.completion, className: 'button main', rel: 'noreferrer' }, 'Finish')));
      } else if (reply.completion) {
        parts.push(make('p', {}, 'Your completion code: ', make('span', { className: 'code' }, reply.completion)));
      }
      show(...parts);
      say('');
    } catch (error) {
      if (!error.conflict) throw error;
      // The server lacks answers; those that are here are sent again, the others asked again.
      if (await catchUp() && place === session.form.training.length + session.form.questions.length) end();
    }
  }

  /** Links to a session's answers as files. */
  function downloads(of) {
    return window.isostudyFiles(study, of).map(({ kind, type, name, text }) => {
      const link = make('a', { className: kind === 'CSV' ? 'button main' : 'button', download: name, href: URL.createObjectURL(new Blob([text], { type })) }, `Download ${kind}`);
      link.addEventListener('click', () => {
        of.downloaded = true;
        keep();
      });
      return link;
    });
  }

  // ---- go ---------------------------------------------------------------------------------------------------------

  document.title = study.title;
  $('title').textContent = study.title;
  if (session) {
    if (study.server) send();
    next();
  } else {
    consent();
  }
})();
