// Unpacks what the page holds, and starts it: a page in a file cannot load modules from beside it, so they become blobs.
'use strict';

/** The bytes of an element that holds them gzipped, in base64. */
globalThis.unpacked = async (element) => {
  const text = atob(element.textContent);
  const packed = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i += 1) packed[i] = text.charCodeAt(i);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'));
  return new Response(stream).arrayBuffer();
};

(async () => {
  const say = (text) => {
    document.querySelector('.said').textContent = text;
    document.querySelector('.stage').setAttribute('aria-busy', 'false');
  };
  try {
    if (!('DecompressionStream' in globalThis) || !HTMLScriptElement.supports?.('importmap')) {
      say('This browser is too old for the viewer: it cannot unpack meshes or name modules.');
      return;
    }
    const imports = {};
    for (const element of document.querySelectorAll('script[data-module]')) {
      const text = 'packed' in element.dataset ? await globalThis.unpacked(element) : element.textContent;
      imports[element.dataset.module] = URL.createObjectURL(new Blob([text], { type: 'text/javascript' }));
    }
    const map = document.createElement('script');
    map.type = 'importmap';
    map.textContent = JSON.stringify({ imports });
    document.head.append(map);
    await import('viewer/main.js');
  } catch (error) {
    say(`The viewer could not start: ${error.message}`);
    throw error;
  }
})();
