// What the page says, in the language that was chosen.
'use strict';

/** `study.languages` has the study's languages, the first one first: `lang`, and `texts` by key. */
window.isostudyTexts = (study) => {
  let spoken = study.languages[0];

  /** A text, with what stands in its braces. */
  function text(key, values = {}) {
    return spoken.texts[key].replace(/\{(\w+)\}/g, (_, name) => values[name]);
  }

  /** A language of the study by its name, or by the first part of it: `de-AT` is `de` where that is all there is. */
  function found(lang) {
    const name = (lang ?? '').toLowerCase();
    const all = study.languages;
    return all.find((one) => one.lang.toLowerCase() === name) ?? all.find((one) => one.lang.toLowerCase() === name.split('-')[0]);
  }

  /** Goes on in this language, if the study has it. */
  function speak(lang) {
    spoken = found(lang) ?? spoken;
    document.documentElement.lang = spoken.lang;
    document.documentElement.dir = spoken.texts.direction;
    document.title = text('title');
  }

  return {
    text,
    speak,
    /** Whether the study has a language. */
    offered: (lang) => found(lang) !== undefined,
    /** The language that is spoken. */
    lang: () => spoken.lang,
    /** The first of these languages that the study has is spoken; its own first one where it has none. */
    begin: (...wanted) => speak(wanted.find(found)),
  };
};
