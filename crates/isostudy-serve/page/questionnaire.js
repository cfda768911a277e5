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
  const WHO = study.server ? [...new Set(study.panel.filter(Boolean))] : ['form'];
  const { text, speak, ...texts } = window.isostudyTexts(study);
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
    $('title').textContent = text('title');
    $('view').replaceChildren(...children);
    const heading = $('view').querySelector('h2');
    (heading || $('title')).focus();
  }

  function heading(text) { return make('h2', { tabIndex: -1 }, text); }

  const loading = window.isostudyLoading(study);
  const about = window.isostudyAbout({ text, make, say, heading, show });
  // A tablet that people share, see docs/questionnaire.md.
  const kiosk = study.server && address.has('kiosk') ? window.isostudyKiosk({ text, make, heading, post, key: KEY, leave: restart }) : null;
  const nextParticipant = () => (kiosk ? [kiosk.next()] : []);
  const rights = window.isostudyRights({ study, text, make, say, heading, show, given, beside: nextParticipant });
  const trial = window.isostudyTrial({ study, text, loading, make, say, heading, show, touch: TOUCH });

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
      say(text('cannot_store'));
    }
  }

  /** Takes over what another tab has stored of the same form. */
  function merge() {
    const stored = load();
    if (!session || stored?.participant !== session.participant) return;
    stored.answers.forEach((theirs, i) => {
      const mine = session.answers[i];
      const [newer, older] = [mine?.change ?? 0, theirs.change ?? 0];
      if (mine && newer === older && mine.choice === theirs.choice) mine.saved ||= theirs.saved;
      else if (!mine || newer <= older) session.answers[i] = theirs;
    });
    session.trained = Math.max(session.trained, stored.trained);
    session.instructed ||= stored.instructed;
    session.before = Math.max(session.before ?? 0, stored.before ?? 0);
    session.after = Math.max(session.after ?? 0, stored.after ?? 0);
    session.told = { ...stored.told, ...session.told };
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
      error.status = response.status;
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
        say(text('no_connection'));
        offline = true;
        await new Promise((resolve) => { setTimeout(resolve, wait); });
      }
    }
  }

  let sending = null;
  // Whether the page says that there is no connection.
  let offline = false;

  /** Sends what is not acknowledged, in order; one at a time however often it is called. Returns whether all is. */
  function send() {
    sending ??= sendAll().finally(() => { sending = null; });
    return sending;
  }

  async function sendAll() {
    for (let conflict = null; session;) {
      const next = session.answers.find((answer) => !answer.saved);
      if (!next) return true;
      const { saved, answered, track, ...answer } = next;
      const { token } = session;
      try {
        if (!await insist('api/answers', { token, ...answer })) {
          if (session && session.token !== token) continue;
          return false;
        }
        // After the answer, so that none waits for it, and no answer is taken for saved without it.
        if (track) {
          const { order, change } = answer;
          if (!await insist('api/cameras', { token, order, change, track })) {
            if (session && session.token !== token) continue;
            return false;
          }
          delete next.track;
        }
        next.saved = true;
        keep();
        // Nothing else that is said meanwhile goes with it.
        if (offline && !session.answers.some((a) => !a.saved)) {
          say('');
          offline = false;
        }
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
    say(text('unknown_session'));
    return null;
  }

  /** The server will never take an answer: nobody is to give more of them. */
  function refused(error) {
    const again = make('button', { type: 'button' }, text('try_again'));
    again.addEventListener('click', () => location.reload());
    place = null;
    $('progress-row').hidden = true;
    // In one word: whoever runs the study knows what it means, and the server speaks no other language.
    const reason = error.refusal ?? String(error.status);
    show(heading(text('not_saved')), make('p', { className: 'text' }, text('not_saved_help', { reason })),
      make('div', { className: 'row' }, ...downloads(session), again));
    say('');
    return null;
  }

  // ---- begin ------------------------------------------------------------------------------------------------------

  // Whether somebody has taken part before in this page, so that the number in its address is not of the next one.
  let follows = false;

  /** Whoever was here has left: the next one begins at the start, in the study's language. */
  function restart() {
    if (session) kiosk.keep(session);
    gone();
    say('');
    texts.begin(given('lang'), ...navigator.languages);
    consent();
  }

  /** `lost` is a session of which the server knows nothing. */
  function consent(lost = null) {
    place = null;
    kiosk?.start();
    $('progress-row').hidden = true;
    const begin = make('button', { type: 'button', className: 'main' }, text('begin'));
    const parts = [heading(text('before')), ...languages(lost), make('p', { className: 'text' }, text('consent')),
      make('p', { className: 'text' }, text('screen_note')), ...(study.shading ? [make('p', { className: 'text' }, text('turn_note'))] : [])];
    if (study.server && WHO.some(given)) {
      parts.push(make('p', { className: 'text' }, text('panel_note')));
    }
    let number = null;
    if (!study.server) {
      const input = make('input', { type: 'number', id: 'form', min: 1, max: study.forms.length, required: true, value: follows ? '' : given('form') ?? '' });
      const asked = make('div', { className: 'row' }, make('label', { htmlFor: 'form' }, text('your_number', { most: study.forms.length })), input);
      asked.hidden = input.value !== '' && input.validity.valid;
      parts.push(asked);
      number = () => (input.reportValidity() ? Number(input.value) : null);
    }
    if (lost?.answers.some((answer) => answer.choice)) {
      parts.push(make('p', { className: 'text' }, text('earlier_answers')), make('div', { className: 'row' }, ...downloads(lost)));
    }
    begin.addEventListener('click', async () => {
      const form = number ? number() : 0;
      if (form === null) return;
      begin.disabled = true;
      try {
        await start(form);
      } catch (error) {
        begin.disabled = false;
        if (error.refusal === 'full') rights.over('full', study.completion_full);
        else say(text(whyNot(error)));
      }
    });
    const remove = rights.button(text('withdraw'), () => withdraw());
    show(...parts, ...rights.facts(), make('div', { className: 'row' }, begin, rights.decline(), ...(study.server ? [remove] : [])));
    // What everybody is shown first, while this is read.
    loading.ahead(null, study.first.slice(0, 1));
  }

  /** The key of what to say to somebody who cannot begin. */
  function whyNot(error) {
    if (error.busy) return 'crowded';
    return { crowded: 'crowded', 'bad-identifier': 'bad_address' }[error.refusal] ?? 'unreachable';
  }

  /** Buttons for the study's languages, where it has several and the address names none of them. */
  function languages(lost) {
    if (study.languages.length < 2 || texts.offered(given('lang'))) return [];
    const button = ({ lang, texts: { language, direction } }) => {
      const choose = make('button', { type: 'button', lang, dir: direction, 'aria-pressed': String(lang === texts.lang()) }, language);
      choose.addEventListener('click', () => {
        speak(lang);
        consent(lost);
        kiosk?.touched();
      });
      return choose;
    };
    return [make('div', { className: 'row', role: 'group', 'aria-label': text('choose_language') }, ...study.languages.map(button))];
  }

  async function start(number) {
    const at = new Date().toISOString();
    if (study.server) {
      const dealt = await post('api/sessions', {
        lang: texts.lang(), prolific_pid: given(study.panel[0]), study_id: given(study.panel[1]), session_id: given(study.panel[2]),
      });
      session = { participant: dealt.participant, token: dealt.token, form: dealt.form, lang: texts.lang(), started: at, trained: 0, answers: [] };
      // Somebody who comes back in another browser goes on where the server's answers end.
      session.answers = Array.from({ length: dealt.answered }, () => ({ saved: true }));
    } else {
      const form = study.forms[number - 1];
      session = { participant: randomId(), form, lang: texts.lang(), started: at, trained: 0, answers: [] };
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
    // Whoever has answered before, in another browser, was asked then.
    if (session.answers.length === 0 && askAbout('before')) return undefined;
    if (!session.instructed) return instructions();
    place = done();
    if (place === all) return askAbout('after') ? undefined : end();
    return pair();
  }

  /** Asks the next question about the person, if one is left before or after the pairs. */
  function askAbout(when) {
    const asked = study.about.filter((one) => one.when === when);
    const question = asked[session[when] ?? 0];
    if (!question) return false;
    $('progress-row').hidden = true;
    about(question, async (value) => {
      say('');
      if (value !== null && !await tell(question, value)) return;
      session[when] = (session[when] ?? 0) + 1;
      keep();
      next();
    });
    return true;
  }

  /** Keeps an answer about the person. Returns whether questions go on: somebody may not be asked any further. */
  async function tell(question, value) {
    const screened = (question.screens_out ?? []).some((option) => value.split(';').includes(String(option)));
    let heard = { taken: screened ? 'screened' : 'kept' };
    if (study.server) {
      heard = await insist('api/about', { token: session.token, id: question.id, value });
      if (!heard) return false;
      say('');
    } else {
      session.told = { ...session.told, [question.id]: value };
    }
    if (heard.taken === 'kept') return true;
    gone();
    rights.over(heard.taken, heard.completion);
    return false;
  }

  /** Nothing of this session is left here. */
  function gone() {
    localStorage.removeItem(KEY);
    session = null;
    place = null;
    $('progress-row').hidden = true;
  }

  /** Somebody would like to stop. */
  function stop() {
    place = null;
    $('progress-row').hidden = true;
    const leaveAnswers = async () => {
      if (study.server) {
        const { token } = session;
        if (!await send()) return;
        gone();
        show(heading(text('thank_you')), make('p', { className: 'text' }, text('stopped')), ...rights.receipt(token), ...rights.completion(study.completion_withdrawn), ...nextParticipant());
      } else {
        show(heading(text('thank_you')), make('p', { className: 'text' }, text('stopped')), make('div', { className: 'row' }, ...downloads(session)));
      }
    };
    const remove = () => (study.server ? deleted(session.token.slice(0, 16)) : leaveNothing());
    rights.stop(next, leaveAnswers, remove);
  }

  function leaveNothing() {
    gone();
    rights.over('withdrawn', study.completion_withdrawn);
  }

  /** Asks for a receipt code, and deletes what belongs to it. */
  function withdraw() {
    place = null;
    $('progress-row').hidden = true;
    rights.withdraw(deleted);
  }

  /** Has the answers of a receipt deleted. */
  async function deleted(receipt) {
    const own = session && receipt.replace(/[^0-9a-z]/gi, '').toLowerCase() === session.token?.slice(0, 16);
    try {
      // Answers on their way must not arrive afterwards.
      if (own) await sending;
      await post('api/withdraw', { receipt });
      if (own || !session) leaveNothing(); else rights.over('withdrawn');
    } catch (error) {
      if (own && error.refusal === 'unknown-token') leaveNothing();
      else say(text(error.final ? 'withdraw_unknown' : 'unreachable'));
    }
  }

  /** Shows the next pair, or the last one again to somebody who went back to it. */
  function pair(back = false) {
    const { form } = session;
    const at = done() - (back ? 1 : 0);
    place = done();
    $('progress-row').hidden = false;
    const codes = [...form.training, ...form.questions];
    const practice = at < form.training.length;
    const question = at - form.training.length;
    // What does not count is not in the bar either.
    $('progress').hidden = practice;
    $('progress').max = form.questions.length;
    $('progress').value = Math.max(question, 0);
    $('progress-text').textContent = practice ? text('does_not_count') : text('progress', { number: question + 1, total: form.questions.length });
    const title = practice ? text('practice', { number: at + 1 }) : text('question', { number: question + 1 });
    // What was answered in another browser is not known here.
    const last = session.answers[question - 1];
    $('back').hidden = !study.revises || back || practice || !last?.choice;
    for (const name of ['back', 'stop']) $(name).textContent = text(name);
    leave = trial(codes[at], title, codes.slice(at + 1, at + 1 + AHEAD), (choice, times, screen, track) => {
      merge();
      if (place !== done()) {
        say(text('other_tab'));
      } else {
        say('');
        const answer = { order: at + 1, stimulus: codes[at], choice, ...times, screen, ...(track && !practice && { track }) };
        if (practice) session.trained += 1;
        else if (back) session.answers[question] = { ...answer, change: (session.answers[question].change ?? 0) + 1 };
        else session.answers.push(answer);
        keep();
      }
      if (study.server) send();
      next();
    });
    return undefined;
  }

  function instructions() {
    $('progress-row').hidden = true;
    const go = make('button', { type: 'button', className: 'main' }, text('go_on'));
    go.addEventListener('click', () => {
      session.instructed = true;
      keep();
      next();
    });
    const how = [...(loading.models() ? [text(TOUCH ? 'how_turn_touch' : 'how_turn')] : []), text(TOUCH ? 'how_touch' : 'how_keys')].join(' ');
    const soon = text(loading.models() ? 'how_soon_turned' : 'how_soon');
    show(heading(text('what_to_do')), make('p', { className: 'text' }, text('instructions')), make('p', { className: 'text' }, `${how} ${soon}`),
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
      const again = make('button', { type: 'button' }, text('next_participant'));
      again.addEventListener('click', () => {
        if (!session.downloaded && !window.confirm(text('delete_unsaved'))) return;
        localStorage.removeItem(KEY);
        session = null;
        follows = true;
        consent();
      });
      show(heading(text('thank_you')), make('p', { className: 'text' }, text('last_question')),
        make('div', { className: 'row' }, ...downloads(session), again));
      return;
    }
    show(heading(text('almost_done')), make('p', {}, text('saving_last')));
    try {
      if (!await send()) return;
      const reply = await insist('api/finish', { token: session.token });
      if (!reply) return;
      session.ended = true;
      keep();
      show(heading(text('thank_you')), make('p', { className: 'text' }, text('all_saved')), ...rights.completion(reply.completion), ...rights.receipt(session.token), ...nextParticipant());
      say('');
    } catch (error) {
      if (!error.conflict) throw error;
      // The server lacks answers; those that are here are sent again, the others asked again.
      if (await catchUp() && place === session.form.training.length + session.form.questions.length) end();
    }
  }

  /** Links to a session's answers as files. */
  function downloads(of) {
    return window.isostudyFiles(study, of).map(({ kind, type, name, text: content }) => {
      const link = make('a', { className: kind === 'CSV' ? 'button main' : 'button', download: name, href: URL.createObjectURL(new Blob([content], { type })) }, text('download', { kind }));
      link.addEventListener('click', () => {
        of.downloaded = true;
        keep();
      });
      return link;
    });
  }

  // ---- go ---------------------------------------------------------------------------------------------------------

  texts.begin(given('lang'), session?.lang, ...navigator.languages);
  $('stop').addEventListener('click', stop);
  $('back').addEventListener('click', () => pair(true));
  if (study.server && address.has('withdraw')) {
    withdraw();
  } else if (session) {
    if (study.server) send();
    next();
  } else {
    consent();
  }
})();
