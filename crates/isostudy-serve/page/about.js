// A question about the person: its view, and the value that was chosen.
'use strict';

/** `page` has what the questionnaire shares: text, make, say, heading and show. */
window.isostudyAbout = ({ text, make, say, heading, show }) => {
  /** An input with a label behind it. */
  function option(type, value, words) {
    const input = make('input', { type, name: 'about', value });
    return make('label', { className: 'option' }, input, make('span', {}, words));
  }

  const numbers = (from, to) => Array.from({ length: to - from + 1 }, (_, i) => from + i);

  /** What is chosen, by the values of the boxes. */
  const chosen = (form) => [...form.querySelectorAll('input[name="about"]:checked')].map((input) => input.value);

  /** The inputs of each kind, and what they say: a value, or null for nothing. */
  const KINDS = {
    options({ text: key, answers: { count, several } }) {
      const boxes = numbers(1, count).map((i) => option(several ? 'checkbox' : 'radio', String(i), text(`${key}_${i}`)));
      const none = option(several ? 'checkbox' : 'radio', '', text('rather_not'));
      // Whoever would rather not say says nothing else.
      none.addEventListener('change', ({ target }) => {
        if (several && target.checked) for (const box of boxes) box.firstChild.checked = false;
      });
      for (const box of boxes) box.addEventListener('change', () => { if (several) none.firstChild.checked = false; });
      const hint = several ? [make('p', { className: 'hint' }, text('several'))] : [];
      return { parts: [...hint, ...boxes, none], value: (form) => (chosen(form).length ? chosen(form).join(';') : null) };
    },
    scale({ text: key, answers: { from, to } }) {
      const steps = make('div', { className: 'scale' }, make('span', {}, text(`${key}_low`)), ...numbers(from, to).map((i) => option('radio', String(i), String(i))), make('span', {}, text(`${key}_high`)));
      return { parts: [steps, option('radio', '', text('rather_not'))], value: (form) => chosen(form)[0] ?? null };
    },
    number({ answers: { from, to } }) {
      const hint = text('number_range', { from, to });
      const input = make('input', { type: 'number', min: from, max: to, step: 'any', 'aria-label': hint, inputMode: 'decimal' });
      return written(input, () => (input.validity.valid ? String(input.valueAsNumber) : null), hint);
    },
    text({ text: key, answers: { longest } }) {
      const input = make('textarea', { rows: 3, maxLength: longest, 'aria-label': text(key) });
      return written(input, () => input.value.trim() || null);
    },
  };

  /** What is typed, or else the box that says nothing. */
  function written(input, typed, hint) {
    const none = option('checkbox', '', text('rather_not'));
    none.addEventListener('change', ({ target }) => { if (target.checked) input.value = ''; });
    input.addEventListener('input', () => { none.firstChild.checked = false; });
    const value = () => (none.firstChild.checked ? '' : input.value === '' ? null : typed());
    return { parts: [...(hint ? [make('p', { className: 'hint' }, hint)] : []), input, none], value };
  }

  /** Shows a question; `answer` is called with the value: empty for "rather not say", null for a question that was passed over. */
  return (question, answer) => {
    const { parts, value } = KINDS[question.answers.kind](question);
    const asked = make('fieldset', { className: 'about' }, make('legend', {}, text(question.text)), ...parts);
    const go = make('button', { type: 'submit', className: 'main' }, text('go_on'));
    const skip = make('button', { type: 'button' }, text('skip'));
    const form = make('form', { noValidate: true }, asked, make('div', { className: 'row' }, go, ...(question.optional ? [skip] : [])));
    form.addEventListener('submit', (event) => {
      event.preventDefault();
      const given = value(form);
      if (given === null) {
        say(text('about_needed'));
        return;
      }
      go.disabled = true;
      answer(given);
    });
    skip.addEventListener('click', () => answer(null));
    show(heading(text('about')), make('p', { className: 'text' }, text('about_note')), form);
  };
};
