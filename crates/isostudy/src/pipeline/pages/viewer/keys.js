// Everything by keyboard.

/** What each key does; `does` is the name of an action. */
export const KEYS = [
  { keys: ['ArrowLeft', 'ArrowRight', 'ArrowUp', 'ArrowDown'], names: ['←', '→', '↑', '↓'], says: 'turn both meshes' },
  { keys: ['+', '=', '-'], names: ['+', '-'], says: 'move nearer or away' },
  { keys: ['1', '2', '3', '4', '5', '6', '7', '8'], names: ['1', 'to', '8'], says: 'smooth, creased, flat, wires, quality, distance, normals, difference' },
  { keys: ['[', ']'], names: ['[', ']'], says: 'coarser or finer' },
  { keys: ['r'], names: ['r'], says: 'reset the view' },
  { keys: ['?'], names: ['?'], says: 'show or close this list' },
];

/** Lists the keys for a reader. */
export function listKeys(list) {
  for (const { names, says } of KEYS) {
    const [term, meaning] = [document.createElement('dt'), document.createElement('dd')];
    for (const name of names) {
      const key = document.createElement(name === 'to' ? 'span' : 'kbd');
      key.textContent = name;
      term.append(key, ' ');
    }
    meaning.textContent = says;
    list.append(term, meaning);
  }
}

/** Calls `actions` by keys. Controls that need a key themselves keep it. */
export function onKeys(actions) {
  const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
  document.addEventListener('keydown', (event) => {
    const { key, target } = event;
    if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
    if (target.matches?.('select, input') && key !== '?') return;
    if (target.closest?.('dialog') && key !== '?') return;
    if (arrows[key]) actions.turn(...arrows[key]);
    else if (key === '+' || key === '=') actions.nearer(1);
    else if (key === '-') actions.nearer(-1);
    else if (/^[1-8]$/.test(key)) actions.mode(Number(key) - 1);
    else if (key === '[') actions.finer(-1);
    else if (key === ']') actions.finer(1);
    else if (key === 'r') actions.reset();
    else if (key === '?') actions.help();
    else return;
    event.preventDefault();
  });
}
