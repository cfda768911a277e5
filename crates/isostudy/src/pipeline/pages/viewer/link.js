// What is shown, as the part of the address after #, so that a view can be kept and sent.

/** Reads what the address says; keys that it lacks are missing. */
export const read = () => Object.fromEntries(new URLSearchParams(location.hash.slice(1)));

/** Keeps what is shown, without a step in the history. */
export function write(shown) {
  const hash = `#${new URLSearchParams(shown)}`;
  if (hash !== location.hash) history.replaceState(null, '', hash);
}
