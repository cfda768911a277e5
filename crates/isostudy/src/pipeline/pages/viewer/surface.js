// Meshes, as they come out of the page's glTF.

import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';

const LARGEST = 254;
const NONE = 255;

const surfaces = new Map();

/** The surface of an embedded file; read once. */
export function surface(file) {
  if (!surfaces.has(file)) surfaces.set(file, load(file));
  return surfaces.get(file);
}

async function load(file) {
  const bytes = await globalThis.unpacked(document.getElementById(`mesh-${file}`));
  const gltf = await new GLTFLoader().parseAsync(bytes, '');
  gltf.scene.updateMatrixWorld(true);
  let found;
  gltf.scene.traverse((object) => { if (object.isMesh) found = object; });
  const { attributes, index } = found.geometry;
  const vertices = attributes.position.count;
  // Steps to coordinates: the node moves and scales.
  const m = found.matrixWorld.elements;
  const positions = new Float32Array(3 * vertices);
  const normals = new Float32Array(3 * vertices);
  for (let v = 0; v < vertices; v += 1) {
    positions[3 * v] = attributes.position.getX(v) * m[0] + m[12];
    positions[3 * v + 1] = attributes.position.getY(v) * m[5] + m[13];
    positions[3 * v + 2] = attributes.position.getZ(v) * m[10] + m[14];
    normals.set([attributes.normal.getX(v), attributes.normal.getY(v), attributes.normal.getZ(v)], 3 * v);
  }
  const lists = {};
  for (const of of gltf.parser.json.meshes[0].extras.numbers) {
    const { array } = await gltf.parser.getDependency('accessor', of.accessor);
    lists[of.name] = Float32Array.from(array, (code) => (code === NONE ? NaN : of.most * (code / LARGEST) ** 2));
  }
  // The last vertices are copies with normals of their own: from them corners have creases, from what they are of they are smooth.
  const { copies } = gltf.parser.json.meshes[0].extras;
  const of = copies ? (await gltf.parser.getDependency('accessor', copies.accessor)).array : [];
  const own = vertices - of.length;
  const triangles = index.array.map((v) => (v < own ? v : of[v - own]));
  return { file, positions, normals, triangles, creased: index.array, distance: lists.distance, angle: lists.normal_error_deg };
}

/** Twice the inscribed over the circumscribed radius of each triangle, 0 to 1; 0 of a triangle without area. */
export function quality({ positions, triangles }) {
  const side = (i, j) => Math.hypot(
    positions[3 * i] - positions[3 * j],
    positions[3 * i + 1] - positions[3 * j + 1],
    positions[3 * i + 2] - positions[3 * j + 2],
  );
  const ratios = new Float32Array(triangles.length / 3);
  for (let t = 0; t < ratios.length; t += 1) {
    const [i, j, k] = triangles.subarray(3 * t, 3 * t + 3);
    const [a, b, c] = [side(j, k), side(k, i), side(i, j)];
    // 2 r / R by the sides alone: (b + c - a)(c + a - b)(a + b - c) / (a b c).
    ratios[t] = Math.max(0, ((b + c - a) * (c + a - b) * (a + b - c)) / (a * b * c)) || 0;
  }
  return ratios;
}
