// How far each triangle of one mesh is from another mesh.

import { Nearest } from 'viewer/nearest.js';

/** Milliseconds of work before the page may do something else. */
const SLICE_MS = 40;

/** In edges of a grid's cell. */
const NOUGHT = 1e-6;

const grids = new Map();
const found = new Map();

/** The largest distance at seven points of each triangle, as for the distance to the isosurface: corners, middles of edges,
    centroid. `goOn` is asked now and then; nothing is returned once it says no. */
export async function difference(from, to, goOn) {
  const key = `${from.file} ${to.file}`;
  if (found.has(key)) return found.get(key);
  if (!grids.has(to.file)) grids.set(to.file, new Nearest(to));
  const grid = grids.get(to.file);
  const { positions: p, triangles } = from;
  const atVertices = new Float64Array(p.length / 3);
  const farthest = new Float32Array(triangles.length / 3);
  let until = performance.now() + SLICE_MS;
  const pause = async () => {
    if (performance.now() < until) return true;
    await new Promise((resolve) => { setTimeout(resolve, 0); });
    until = performance.now() + SLICE_MS;
    return goOn();
  };
  for (let v = 0; v < atVertices.length; v += 1) {
    atVertices[v] = grid.distance(p[3 * v], p[3 * v + 1], p[3 * v + 2]);
    if (v % 256 === 0 && !(await pause())) return undefined;
  }
  // Weights of the corners at the points in between.
  const inner = [[0.5, 0.5, 0], [0, 0.5, 0.5], [0.5, 0, 0.5], [1 / 3, 1 / 3, 1 / 3]];
  for (let t = 0; t < farthest.length; t += 1) {
    const [a, b, c] = [triangles[3 * t], triangles[3 * t + 1], triangles[3 * t + 2]];
    let most = Math.max(atVertices[a], atVertices[b], atVertices[c]);
    for (const [i, j, k] of inner) {
      const at = (axis) => i * p[3 * a + axis] + j * p[3 * b + axis] + k * p[3 * c + axis];
      most = Math.max(most, grid.distance(at(0), at(1), at(2)));
    }
    // What is less is rounding.
    farthest[t] = most < NOUGHT * grid.edge ? 0 : most;
    if (t % 64 === 0 && !(await pause())) return undefined;
  }
  found.set(key, farthest);
  return farthest;
}
