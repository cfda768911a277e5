// Walks through the endless terrain as the page in examples/browser does, and checks what it is handed: vertices in their
// chunks or next to them, triangles of vertices that there are, unit normals, and holes that reach few chunks.
// node scripts/test-terrain.mjs isostudy_browser.wasm
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";

const { instance: { exports: terrain } } = await WebAssembly.instantiate(await readFile(process.argv[2]), {});
const CHUNK = 32;

function check() {
  const id = [0, 1, 2].map(axis => terrain.chunk_id(axis));
  const [vertices, triangles] = [terrain.vertex_count(), terrain.triangle_count()];
  const memory = terrain.memory.buffer;
  const positions = new Float32Array(memory, terrain.positions(), 3 * vertices);
  const normals = new Float32Array(memory, terrain.normals(), 3 * vertices);
  assert.ok(positions.every((p, i) => p >= id[i % 3] * CHUNK - 1 && p <= (id[i % 3] + 1) * CHUNK + 1));
  for (let v = 0; v < vertices; v++) {
    assert.ok(Math.abs(Math.hypot(...normals.subarray(3 * v, 3 * v + 3)) - 1) < 1e-5);
  }
  assert.ok(new Uint32Array(memory, terrain.triangles(), 3 * triangles).every(v => v < vertices));
  return triangles;
}

let [made, triangles] = [0, 0];
for (const x of [0, -40, -4000]) {
  terrain.walk(x, 10, 0);
  while (terrain.make_next()) {
    triangles += check();
    made += 1;
  }
}
const [x, y] = [-4000, 10];
const before = terrain.height(x, y);
const touched = terrain.dig(x, y, before, 5);
assert.ok(touched >= 1 && touched <= 8, `a hole of 5 m reaches ${touched} chunks`);
assert.ok(terrain.height(x, y) < before - 4);
let anew = 0;
while (terrain.make_next()) {
  check();
  anew += 1;
}
assert.equal(anew, touched);
assert.ok(made > 200 && triangles > 100_000, `${made} chunks, ${triangles} triangles`);
console.log(`${made} chunks with ${triangles} triangles; a hole reached ${touched}`);
