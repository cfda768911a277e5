// Has a module of examples/small make the mesh of a ball, and checks it. node scripts/test-small.mjs MODULE.wasm
import { readFile } from "node:fs/promises";

const path = process.argv[2];
const { instance } = await WebAssembly.instantiate(await readFile(path), {});
const page = instance.exports;

const n = page.samples_per_axis();
const radius = 12.3;
const first = page.samples();
for (let z = 0; z < n; z += 1) {
  for (let y = 0; y < n; y += 1) {
    for (let x = 0; x < n; x += 1) {
      const from = [x, y, z].map((i) => i - 2 - 16);
      new Float32Array(page.memory.buffer)[first / 4 + (z * n + y) * n + x] = radius - Math.hypot(...from);
    }
  }
}

// Six times the volume that the triangles enclose, and whether they are closed and of genus 0.
const check = (name, count) => {
  const positions = new Float32Array(page.memory.buffer, page.positions(), 3 * page.vertex_count());
  const triangles = new Uint32Array(page.memory.buffer, page.triangles(), 3 * count);
  const at = (v) => positions.subarray(3 * v, 3 * v + 3);
  let volume = 0;
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [0, 1, 2].map((corner) => at(triangles[t + corner]));
    volume += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  const wanted = (4 / 3) * Math.PI * radius ** 3;
  if (count < 100 || Math.abs(volume / 6 / wanted - 1) > 0.12) {
    throw new Error(`${name}: ${count} triangles round a volume of ${volume / 6}, not ${wanted}`);
  }
  return positions.length / 3;
};

const count = page.extract();
const vertices = check("nets", count);
if (2 * vertices !== count + 4) throw new Error(`nets: ${vertices} vertices and ${count} triangles are no sphere`);
// By each method that has a name, where the module has them all.
const methods = page.method_count?.() ?? 0;
for (let method = 0; method < methods; method += 1) check(`method ${method}`, page.extract_by(method));
console.log(`${path.split("/").pop()}: a ball of ${count} triangles by nets, and by ${methods} other methods`);
