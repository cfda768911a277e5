// A tablet that people share. Whoever is idle has left: the page returns to its start, and what was answered is still sent.
'use strict';

/** `page` has what the questionnaire shares: text, make, heading and post. `key` names what is stored; `leave` ends a session. */
window.isostudyKiosk = ({ text, make, heading, post, key, leave }) => {
  const IDLE_MS = 120000;
  // Time to say that one is still there (WCAG 2.2, 2.2.1: at least 20 seconds).
  const WARNING_MS = 20000;
  const AGAIN_MS = 15000;
  const LEFT = `${key}:left`;

  // ---- who is still there -----------------------------------------------------------------------------------------

  let timer = 0;
  let at = false;
  const dialog = make('dialog', { role: 'alertdialog' });
  document.body.append(dialog);

  function close() {
    dialog.close();
    dialog.replaceChildren();
  }

  function wait() {
    clearTimeout(timer);
    if (dialog.open) close();
    if (!at) timer = setTimeout(warn, IDLE_MS - WARNING_MS);
  }

  function warn() {
    const here = make('button', { type: 'button', className: 'main' }, text('still_here'));
    const question = heading(text('still_there'));
    dialog.setAttribute('aria-label', text('still_there'));
    dialog.replaceChildren(question, make('p', {}, text('still_there_help', { seconds: WARNING_MS / 1000 })), make('div', { className: 'row' }, here));
    dialog.showModal();
    here.focus();
    timer = setTimeout(() => {
      close();
      leave();
    }, WARNING_MS);
  }

  for (const event of ['pointerdown', 'keydown', 'wheel', 'touchmove']) {
    window.addEventListener(event, (of) => {
      // What says that somebody is there answers nothing.
      if (dialog.open) {
        of.stopPropagation();
        if (of.cancelable) of.preventDefault();
      }
      at = false;
      wait();
    }, { capture: true, passive: false });
  }

  // ---- answers of those who left ----------------------------------------------------------------------------------

  let left = stored();
  let sending = false;

  function stored() {
    try {
      return JSON.parse(localStorage.getItem(LEFT)) ?? [];
    } catch {
      return [];
    }
  }

  function store() {
    try {
      if (left.length > 0) localStorage.setItem(LEFT, JSON.stringify(left)); else localStorage.removeItem(LEFT);
    } catch {
      // They stay in memory as long as the page is open.
    }
  }

  /** Sends one session's answers. */
  async function sendOne({ token, answers, all }) {
    for (const one of answers.filter((answer) => !answer.saved)) {
      const { saved, answered, track, ...answer } = one;
      await post('api/answers', { token, ...answer });
      if (track) await post('api/cameras', { token, order: answer.order, change: answer.change, track });
      one.saved = true;
      store();
    }
    if (answers.length === all) await post('api/finish', { token });
  }

  async function send() {
    if (sending) return;
    sending = true;
    let again = false;
    for (const one of left.filter((of) => !of.refused)) {
      try {
        await sendOne(one);
        left = left.filter((other) => other !== one);
      } catch (error) {
        // What the server will never take stays in the browser's storage.
        if (error.final) one.refused = error.refusal ?? String(error.status); else again = true;
      }
      store();
    }
    sending = false;
    if (again) setTimeout(send, AGAIN_MS);
  }

  send();
  return {
    /** The start is on the screen: nobody is waited for until somebody touches it. */
    start() {
      at = true;
      wait();
    },
    /** Somebody is at the start. */
    touched() {
      at = false;
      wait();
    },
    /** Keeps a session that is left until the server has its answers. */
    keep({ token, answers, form, ended }) {
      if (ended || answers.length === 0) return;
      left.push({ token, answers, all: form.questions.length });
      store();
      send();
    },
    /** The way to the start for whoever comes next. */
    next() {
      const button = make('button', { type: 'button' }, text('next_participant'));
      button.addEventListener('click', leave);
      return button;
    },
  };
};
