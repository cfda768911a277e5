// Answers as files that a participant can download.
'use strict';

/** A session's answers as CSV and as JSON: those that are known here; of those given in another browser only the server knows. */
window.isostudyFiles = (study, session) => {
  const { participant, started, finished } = session;
  const { form } = session.form;
  const SCREEN = ['viewport_width', 'viewport_height', 'pixel_ratio', 'surface_px', 'layout', 'input', 'dropped', 'hidden_ms', 'shown_as', 'turned_deg'];
  const answers = session.answers.filter((answer) => answer.choice).map(({ order, stimulus, choice, rt_ms, answered, screen, track }) => ({
    participant, form, order, stimulus, choice, rt_ms, answered, ...screen, ...(track && { track }),
  }));
  const names = ['participant', 'form', 'order', 'stimulus', 'choice', 'rt_ms', 'answered', ...SCREEN];
  const lines = [names, ...answers.map((row) => names.map((name) => row[name] ?? ''))];
  const csv = `${lines.map((cells) => cells.join(',')).join('\r\n')}\r\n`;
  const json = JSON.stringify({ schema: 1, study: study.study, participant, form, language: session.lang, started, finished, answers, about: session.told }, null, 1);
  const file = (kind, type, text) => ({ kind, type, text, name: `${study.study}-${participant}.${kind.toLowerCase()}` });
  return [file('CSV', 'text/csv', csv), file('JSON', 'application/json', json)];
};
