// Pairs, fetched whole before they are shown, and ahead of time.
'use strict';

/**
 * What fetches a study's pairs. Each is in one file, in one or more kinds of which the browser plays the first that it can:
 * `study.media` lists them, with the bytes that every file of a kind has, and of videos the type that a browser is asked about.
 * Models are a kind of their own, of which the bytes are read.
 */
window.isostudyLoading = (study) => {
  // A page from a folder may show the files beside it, but not read them.
  const READS = location.protocol !== 'file:';
  /** Whether the browser draws models: for a page from a folder it reads none. */
  function draws() {
    if (!READS) return false;
    const context = document.createElement('canvas').getContext('webgl2');
    context?.getExtension('WEBGL_lose_context')?.loseContext();
    return Boolean(context);
  }

  const playable = (kind) => (kind.kind === 'model' ? draws() : !kind.type || document.createElement('video').canPlayType(kind.type) !== '');
  let kinds = study.media.filter(playable);
  // What draws them takes as long to load as a pair.
  if (kinds[0].kind === 'model') import('./turning.js').catch(() => {});
  // What is wanted, by code; `file` is a promise of { kind, frames, address }, of models of { kind, bytes }.
  const wanted = new Map();
  // One after the other, so that what is needed first has the line for itself.
  let line = Promise.resolve();

  /** The whole file; `entry` hears how much of it is there. */
  async function fetched(place, kind, entry) {
    const response = await fetch(place, { signal: entry.abort.signal });
    if (!response.ok) throw new Error(`${response.status}`);
    const parts = [];
    let bytes = 0;
    const reader = response.body.getReader();
    for (let part = await reader.read(); !part.done; part = await reader.read()) {
      parts.push(part.value);
      bytes += part.value.length;
      entry.share = Math.min(bytes / kind.bytes, 1);
      entry.told(entry.share);
    }
    if (bytes < kind.bytes) throw new Error(`${bytes} of ${kind.bytes} bytes`);
    return new Blob(parts, { type: kind.type ? kind.type.split(';')[0] : `image/${kind.kind}` });
  }

  function begin(code) {
    const kind = kinds[0];
    const entry = { share: 0, told: () => {}, abort: new AbortController() };
    const fetching = async () => {
      if (wanted.get(code) !== entry) throw new Error('not wanted any more');
      const place = `stimuli/${encodeURIComponent(code)}.${kind.kind === 'model' ? 'glb' : kind.kind}`;
      if (!READS) return { kind: kind.kind, frames: kind.frames, address: place };
      const whole = await fetched(place, kind, entry);
      if (kind.kind === 'model') return { kind: kind.kind, bytes: await whole.arrayBuffer() };
      return { kind: kind.kind, frames: kind.frames, address: URL.createObjectURL(whole) };
    };
    entry.file = line.then(fetching);
    // What failed is begun anew when it is asked for again.
    line = entry.file.then(() => {}, () => { if (wanted.get(code) === entry) wanted.delete(code); });
    wanted.set(code, entry);
    return entry;
  }

  /** Forgets all pairs but these. */
  function keep(codes) {
    for (const [code, entry] of wanted) {
      if (!codes.includes(code)) {
        wanted.delete(code);
        entry.abort.abort();
        entry.file.then(({ address }) => { if (READS && address) URL.revokeObjectURL(address); }, () => {});
      }
    }
  }

  return {
    /** A pair's file, when all of it is there; `told` hears which share is. Rejects where it cannot be had. */
    whole(code, told) {
      if (!wanted.has(code)) keep([]);
      const entry = wanted.get(code) ?? begin(code);
      entry.told = told;
      told(entry.share);
      return entry.file;
    },
    /** Fetches pairs that will be asked for, in this order, and forgets all others but `current`. */
    ahead(current, codes) {
      keep([current, ...codes]);
      for (const code of codes) if (!wanted.has(code)) begin(code);
    },
    /** Whether pairs are models, as far as is known. */
    models: () => kinds[0].kind === 'model',
    /** Goes on without a kind that turned out not to play; false where there is no other. */
    without(kind) {
      if (kinds[0].kind !== kind) return true;
      if (kinds.length < 2) return false;
      kinds = kinds.slice(1);
      keep([]);
      return true;
    },
  };
};
