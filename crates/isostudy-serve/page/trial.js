// One question: a pair, its answers, and when they can be given.
'use strict';

/** `page` has what the questionnaire shares: study, text, loading, make, say, heading, show and touch. */
window.isostudyTrial = ({ study, text, loading, make, say, heading, show, touch }) => {
  // The answers of each way to ask: code, keys of its names side by side and one over the other, the arrow that points to it.
  const ANSWERS = {
    pairs: [['L', 'left', 'upper', 'ArrowLeft'], ['NP', 'none', 'none_stacked', 'ArrowDown'], ['R', 'right', 'lower', 'ArrowRight']],
    forced: [['L', 'left', 'upper', 'ArrowLeft'], ['R', 'right', 'lower', 'ArrowRight']],
    graded: [['LL', 'left_much', 'upper_much'], ['L', 'left_better', 'upper_better'], ['NP', 'equal', 'equal_stacked'],
      ['R', 'right_better', 'lower_better'], ['RR', 'right_much', 'lower_much']],
    ratings: Array.from({ length: study.steps ?? 0 }, (_, i) => [String(i + 1)]),
  }[study.way ?? 'pairs'] ?? [...['first', 'second', 'third', 'fourth'].slice(0, study.way === 'best-of-3' ? 3 : 4).map((key, i) => [String(i + 1), key, key]),
    ...(study.none ? [['NP', 'none_of_them', 'none_of_them']] : [])];
  // What a button says: its text, or the number of a step.
  const named = (key, i) => (key === undefined ? CHOICES[i] : text(key));
  const [CHOICES, BESIDE, STACKED] = [0, 1, 2].map((column) => ANSWERS.map((of) => of[column]));
  // The keys of each answer: by number, and by arrow.
  const KEYS = ANSWERS.map((of, i) => [String(i + 1), ...of.slice(3)]);
  // The server takes no longer time for an answer than a day.
  const LONGEST_MS = 86400000;
  // One frame moves nothing, whoever asks for less motion.
  const isStill = study.media.every(({ frames }) => frames === 1);
  const STILL = !isStill && window.matchMedia('(prefers-reduced-motion: reduce)').matches;
  const AGAIN_MS = 3000;
  // Degrees after which models have been looked at from another side, however short the time.
  const TURNED_DEG = 90;

  // What last touched the page, for browsers whose clicks do not say it.
  let pointer = 'mouse';
  document.addEventListener('pointerdown', (event) => { pointer = event.pointerType || pointer; }, true);
  const inputOf = (event) => {
    const kind = event.detail === 0 ? 'keyboard' : event.pointerType || pointer;
    return ['keyboard', 'touch', 'pen'].includes(kind) ? kind : 'mouse';
  };

  /**
   * Shows one pair. `answer` is called with the choice, its time in milliseconds since the pair was seen, and the screen it was
   * given on, and from where models were looked at. `coming` are the pairs that follow. Returns what ends the question.
   */
  return (code, title, coming, answer) => {
    const words = make('p', { className: 'wait' });
    const pair = make('div', { className: 'pair', 'data-code': code }, words);
    const pause = make('button', { type: 'button', className: 'soon', hidden: isStill }, text('play'));
    const reset = make('button', { type: 'button', hidden: true }, text('reset'));
    const larger = make('button', { type: 'button', className: 'soon', 'aria-pressed': 'false' }, text('enlarge'));
    const smaller = make('button', { type: 'button', className: 'smaller' }, text('smaller'));
    const buttons = CHOICES.map((choice, i) => make('button', { type: 'button', 'aria-disabled': 'true', 'data-choice': choice, 'aria-keyshortcuts': KEYS[i].join(' ') },
      make('span'), ...(touch || study.steps ? [] : [make('kbd', { 'aria-hidden': 'true' }, KEYS[i][0])])));
    // What the ends of a scale mean stands over its steps, and is said with them.
    const ends = study.steps ? ['scale_low', 'scale_high'] : [];
    ends.forEach((key, i) => buttons.at(-i).setAttribute('aria-label', `${CHOICES.at(-i)}, ${text(key)}`));
    const scale = make('div', { className: 'ends', 'aria-hidden': 'true', hidden: !study.steps }, ...ends.map((key) => make('span', {}, text(key))));
    const question = make('fieldset', {}, make('legend', {}, text('prompt')), scale, make('div', { className: CHOICES.length > 3 ? 'choices many' : 'choices' }, ...buttons));

    // What is on the screen, once all of it is there; since when it is seen; how long it has been seen moving.
    let shown = null;
    let seenAt = null;
    let moving = null;
    let watched = 0;
    let hiddenAt = null;
    let hidden = 0;
    let timer = 0;
    let open = false;
    let over = false;
    let small = false;
    // Whether it turns as soon as it can be seen; who asked for less motion, or paused, plays it.
    let wanted = !STILL;

    /** Why there is no answer yet. */
    function wait() {
      if (shown === null) return text('wait_loading');
      if (small) return text('wait_small');
      if (shown.model) return text('wait_turn');
      return text(moving === null ? 'wait_play' : 'wait_watch');
    }

    function unlock() {
      open = true;
      buttons.forEach((button) => button.removeAttribute('aria-disabled'));
      say(text('can_answer'));
    }

    async function play() {
      wanted = true;
      if (moving !== null || seenAt === null || small || document.hidden) return;
      try {
        await shown.play();
      } catch {
        // The browser asks for a touch first.
        stop();
        wanted = false;
        return;
      }
      if (over || moving !== null) return;
      if (document.hidden || small) {
        stop();
        return;
      }
      moving = performance.now();
      pause.textContent = text('pause');
      if (!open) {
        say('');
        timer = setTimeout(unlock, Math.max(0, study.loop_ms - watched));
      }
    }

    function stop() {
      if (moving !== null) watched += performance.now() - moving;
      moving = null;
      clearTimeout(timer);
      shown?.stop();
      pause.textContent = text('play');
    }

    /** The clock starts with the first frame that is on a screen. */
    function see() {
      const ready = () => !over && shown !== null && seenAt === null && !small && !document.hidden;
      if (!ready()) return;
      requestAnimationFrame(() => requestAnimationFrame(() => {
        if (!ready()) return;
        seenAt = performance.now();
        if (wanted) play(); else say(text('less_motion'));
      }));
    }

    /** Each surface is so many pixels wide now. */
    function laidOut(width) {
      const names = (pair.classList.contains('stacked') ? STACKED : BESIDE).map(named);
      buttons.forEach((button, i) => { button.firstChild.textContent = names[i]; });
      small = study.min_surface_px !== undefined && width < study.min_surface_px;
      pair.classList.toggle('small', small);
      if (small) {
        if (moving !== null) stop();
        words.textContent = text('too_small', { least: study.min_surface_px, width });
        pair.append(words);
      } else {
        words.remove();
        if (seenAt === null) see(); else if (wanted) play();
      }
    }

    function choose(i, input) {
      if (over) return;
      if (!open || small) {
        say(wait());
        return;
      }
      const now = performance.now();
      const rt_ms = Math.min(Math.round(now - seenAt), LONGEST_MS);
      const screen = {
        viewport_width: window.innerWidth,
        viewport_height: window.innerHeight,
        pixel_ratio: Math.round(window.devicePixelRatio * 1000) / 1000,
        input,
        hidden_ms: Math.min(Math.round(hidden), LONGEST_MS),
        ...shown.shown(),
      };
      answer(CHOICES[i], { rt_ms, answered: new Date().toISOString() }, screen, shown.model?.track(seenAt));
    }

    function enlarge(large) {
      if (shown === null || small || pair.classList.contains('large') === large) return;
      pair.classList.toggle('large', large);
      document.body.classList.toggle('larger', large);
      larger.setAttribute('aria-pressed', String(large));
      shown.layout();
      if (!large) larger.focus({ preventScroll: true });
    }

    /** Whether all of the answers is on the screen. */
    function visible() {
      const { top, bottom } = question.lastChild.getBoundingClientRect();
      return top >= 0 && bottom <= window.innerHeight + 1;
    }

    function key(event) {
      if (event.altKey || event.ctrlKey || event.metaKey || event.repeat) return;
      if (event.key === 'Escape') enlarge(false);
      const i = KEYS.findIndex((keys) => keys.includes(event.key));
      // Whoever still has to scroll to the answers does so by this key.
      if (event.key === 'ArrowDown' && !visible()) return;
      if (i >= 0) {
        event.preventDefault();
        choose(i, 'keyboard');
      }
    }

    // A tab in the background shows nothing.
    function turnedAway() {
      if (document.hidden) {
        if (seenAt !== null) hiddenAt = performance.now();
        if (moving !== null) stop();
        return;
      }
      if (hiddenAt !== null) hidden += performance.now() - hiddenAt;
      hiddenAt = null;
      if (seenAt === null) see(); else if (wanted) play();
    }

    /** Models: whoever has turned them far enough has seen them, and without WebGL there are turntables. */
    const events = {
      turned(degrees) {
        if (open || moving === null || degrees < TURNED_DEG) return;
        clearTimeout(timer);
        unlock();
      },
      lost() {
        if (over || !loading.without('model')) return;
        if (moving !== null) stop();
        shown?.leave();
        shown = null;
        [seenAt, watched, open, wanted] = [null, 0, false, !STILL];
        buttons.forEach((button) => button.setAttribute('aria-disabled', 'true'));
        [pause.hidden, reset.hidden] = [isStill, true];
        load();
      },
    };

    async function load() {
      let file = null;
      try {
        file = await loading.whole(code, (share) => {
          if (!over && shown === null) words.textContent = share > 0 ? text('loading_share', { share: Math.floor(100 * share) }) : text('loading');
        });
        if (over) return;
        const made = await window.isostudyPair(study, text, file, pair, make, laidOut, events);
        if (over) {
          made.leave();
          return;
        }
        shown = made;
        pair.append(smaller);
        pause.className = larger.className = '';
        // Nothing moves by itself.
        if (made.model) [wanted, pause.hidden, reset.hidden] = [true, true, false];
        loading.ahead(code, coming);
        see();
      } catch {
        if (over) return;
        // The other kind at once; the same again after a while.
        const other = file !== null && loading.without(file.kind);
        if (!other) {
          words.textContent = text('load_again');
          pair.replaceChildren(words);
        }
        setTimeout(() => { if (!over) load(); }, other ? 0 : AGAIN_MS);
      }
    }

    pause.addEventListener('click', () => {
      if (moving === null) {
        play();
      } else {
        wanted = false;
        stop();
      }
    });
    reset.addEventListener('click', () => shown.model.reset());
    larger.addEventListener('click', () => enlarge(true));
    pair.addEventListener('click', () => enlarge(!pair.classList.contains('large')));
    buttons.forEach((button, i) => {
      button.firstChild.textContent = named(BESIDE[i], i);
      button.addEventListener('click', (event) => choose(i, inputOf(event)));
    });
    document.addEventListener('keydown', key);
    document.addEventListener('visibilitychange', turnedAway);
    show(make('div', { className: 'row top' }, heading(title), make('div', { className: 'tools' }, larger, pause, reset)), pair, question);
    document.body.className = 'asking';
    load();
    return () => {
      over = true;
      clearTimeout(timer);
      shown?.leave();
      document.removeEventListener('keydown', key);
      document.removeEventListener('visibilitychange', turnedAway);
    };
  };
};
