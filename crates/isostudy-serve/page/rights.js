// What participants may do besides answering: decline, stop, and have their answers deleted.
'use strict';

/** `page` has what the questionnaire shares: study, text, make, say, heading, show, given, a name's value in the address,
 * and beside, what else a last view offers. */
window.isostudyRights = ({ study, text, make, say, heading, show, given, beside }) => {
  const line = (words) => make('p', { className: 'text' }, words);
  function button(words, act, className = '') {
    const made = make('button', { type: 'button', className }, words);
    made.addEventListener('click', () => act(made));
    return made;
  }

  /** A code to copy, or the way back to whoever sent somebody; what the address said of them is repeated there. */
  function completion(said) {
    if (!said) return [];
    if (!said.startsWith('https://')) return [make('p', {}, `${text('completion_code')} `, make('span', { className: 'code' }, said))];
    const href = said.replace(/\{(\w+)\}/g, (_, name) => encodeURIComponent(given(name) ?? ''));
    return [make('div', { className: 'row' }, make('a', { href, className: 'button main', rel: 'noreferrer' }, text('finish')))];
  }

  /** The last view of a participant. */
  function over(key, said) {
    show(heading(text('thank_you')), line(text(key)), ...completion(said), ...beside());
    say('');
  }

  return {
    completion,
    over,
    /** What people are told of the study before they agree. */
    facts() {
      const { contact, ethics, least_age: age, retention_days: days } = study;
      return [contact && text('contact', { contact }), ethics && text('ethics', { ethics }), age && text('least_age', { age }), days && text('retention', { days })]
        .filter(Boolean).map(line);
    },
    decline: () => button(text('decline'), () => over('declined', study.completion_withdrawn)),
    /** With which code a participant's answers can be deleted. */
    receipt(token) {
      const code = token.slice(0, 16).match(/.{4}/g).join('-');
      return [make('p', {}, `${text('receipt')} `, make('span', { className: 'code', id: 'receipt' }, code)), line(text('receipt_note'))];
    },
    /** Asks whether somebody wants to stop; `on` goes on. */
    stop(on, keep, remove) {
      show(heading(text('stop_question')), line(text('stop_choices')),
        make('div', { className: 'row' }, button(text('go_on'), on, 'main'), button(text('stop_keep'), keep), button(text('stop_delete'), remove)));
    },
    /** Asks for a receipt; `remove` deletes what belongs to it. */
    withdraw(remove) {
      const input = make('input', { type: 'text', id: 'code', autocomplete: 'off', spellcheck: false, required: true });
      const form = make('form', {}, make('div', { className: 'row' }, make('label', { htmlFor: 'code' }, text('receipt')), input, make('button', { type: 'submit', className: 'main' }, text('withdraw'))));
      form.addEventListener('submit', (event) => {
        event.preventDefault();
        remove(input.value);
      });
      show(heading(text('withdraw')), line(text('withdraw_note')), form);
    },
    button,
  };
};
