// The distance from a point to the nearest triangle of a mesh, by a grid of cells that list the triangles in them.

const MOST_CELLS = 1 << 21;

/** A grid over a mesh: `positions` by three, `triangles` by three. */
export class Nearest {
  constructor({ positions, triangles }) {
    this.corners = new Float64Array(3 * triangles.length);
    triangles.forEach((v, i) => this.corners.set(positions.subarray(3 * v, 3 * v + 3), 3 * i));
    const count = triangles.length / 3;
    this.low = [Infinity, Infinity, Infinity];
    const high = [-Infinity, -Infinity, -Infinity];
    for (let i = 0; i < this.corners.length; i += 1) {
      this.low[i % 3] = Math.min(this.low[i % 3], this.corners[i]);
      high[i % 3] = Math.max(high[i % 3], this.corners[i]);
    }
    const sides = high.map((end, axis) => end - this.low[axis]);
    const longest = Math.max(...sides) || 1;
    // About as many cells along a side as triangles, if they were spread over a square.
    this.edge = longest / Math.min(Math.max(Math.sqrt(count / 4), 1), 128);
    const along = () => sides.map((side) => Math.floor(side / this.edge) + 1);
    while (along().reduce((product, n) => product * n) > MOST_CELLS) this.edge *= 1.3;
    this.counts = along();
    this.fill(count);
  }

  /** Sorts triangles into cells: `starts` of each cell in `listed`. */
  fill(count) {
    const [nx, ny, nz] = this.counts;
    this.starts = new Uint32Array(nx * ny * nz + 1);
    const each = (visit) => {
      for (let t = 0; t < count; t += 1) {
        const [first, last] = this.reach(t);
        for (let z = first[2]; z <= last[2]; z += 1) {
          for (let y = first[1]; y <= last[1]; y += 1) {
            for (let x = first[0]; x <= last[0]; x += 1) visit(x + nx * (y + ny * z), t);
          }
        }
      }
    };
    each((cell) => { this.starts[cell + 1] += 1; });
    for (let cell = 0; cell < nx * ny * nz; cell += 1) this.starts[cell + 1] += this.starts[cell];
    this.listed = new Uint32Array(this.starts[nx * ny * nz]);
    const next = this.starts.slice();
    each((cell, t) => { this.listed[next[cell]] = t; next[cell] += 1; });
    this.seen = new Uint32Array(count);
    this.asked = 0;
  }

  cellOf(value, axis) {
    return Math.min(Math.max(Math.floor((value - this.low[axis]) / this.edge), 0), this.counts[axis] - 1);
  }

  /** First and last cell of a triangle's box. */
  reach(t) {
    const ends = [Math.min, Math.max].map((end) => [0, 1, 2].map((axis) => {
      const [a, b, c] = [0, 3, 6].map((corner) => this.corners[9 * t + corner + axis]);
      return this.cellOf(end(a, b, c), axis);
    }));
    return ends;
  }

  /** The distance from a point to the nearest triangle. */
  distance(x, y, z) {
    const p = [x, y, z];
    const middle = p.map((value, axis) => this.cellOf(value, axis));
    const [nx, ny] = this.counts;
    this.asked += 1;
    let best = Infinity;
    for (let r = 0; ; r += 1) {
      const first = middle.map((at) => Math.max(at - r, 0));
      const last = middle.map((at, axis) => Math.min(at + r, this.counts[axis] - 1));
      for (let k = first[2]; k <= last[2]; k += 1) {
        for (let j = first[1]; j <= last[1]; j += 1) {
          // Of a row within the shell only the ends are new.
          const inner = Math.abs(k - middle[2]) < r && Math.abs(j - middle[1]) < r;
          for (let i = first[0]; i <= last[0]; i += 1) {
            if (inner && Math.abs(i - middle[0]) < r) {
              i = Math.min(last[0], middle[0] + r - 1);
              continue;
            }
            const cell = i + nx * (j + ny * k);
            for (let place = this.starts[cell]; place < this.starts[cell + 1]; place += 1) {
              const t = this.listed[place];
              if (this.seen[t] === this.asked) continue;
              this.seen[t] = this.asked;
              best = Math.min(best, squaredDistance(this.corners, 9 * t, x, y, z));
            }
          }
        }
      }
      // What was not visited lies beyond the faces of the visited block that are not the grid's own.
      let beyond = Infinity;
      for (let axis = 0; axis < 3; axis += 1) {
        if (first[axis] > 0) beyond = Math.min(beyond, p[axis] - (this.low[axis] + first[axis] * this.edge));
        if (last[axis] < this.counts[axis] - 1) beyond = Math.min(beyond, this.low[axis] + (last[axis] + 1) * this.edge - p[axis]);
      }
      if (best <= Math.max(beyond, 0) ** 2 || beyond === Infinity) return Math.sqrt(best);
    }
  }
}

/** The squared distance from a point to the triangle whose nine coordinates begin at `at`: to the foot of the perpendicular where
    that is inside, else to the nearest edge. */
export function squaredDistance(c, at, x, y, z) {
  const [ax, ay, az] = [c[at], c[at + 1], c[at + 2]];
  const [ux, uy, uz] = [c[at + 3] - ax, c[at + 4] - ay, c[at + 5] - az];
  const [vx, vy, vz] = [c[at + 6] - ax, c[at + 7] - ay, c[at + 8] - az];
  const [px, py, pz] = [x - ax, y - ay, z - az];
  const [mx, my, mz] = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
  const squared = mx * mx + my * my + mz * mz;
  // Barycentric coordinates of the foot, from areas; without area they are no numbers, and nothing compares with them.
  const v = ((py * vz - pz * vy) * mx + (pz * vx - px * vz) * my + (px * vy - py * vx) * mz) / squared;
  const w = ((uy * pz - uz * py) * mx + (uz * px - ux * pz) * my + (ux * py - uy * px) * mz) / squared;
  if (v >= 0 && w >= 0 && v + w <= 1) return (px * mx + py * my + pz * mz) ** 2 / squared;
  return Math.min(
    toSegment(px, py, pz, ux, uy, uz),
    toSegment(px, py, pz, vx, vy, vz),
    toSegment(px - ux, py - uy, pz - uz, vx - ux, vy - uy, vz - uz),
  );
}

/** The squared distance from p to the segment from the origin to u. */
function toSegment(px, py, pz, ux, uy, uz) {
  const along = (px * ux + py * uy + pz * uz) / (ux * ux + uy * uy + uz * uz);
  // A segment without length gives NaN, and its start.
  const t = along > 0 ? Math.min(along, 1) : 0;
  return (px - t * ux) ** 2 + (py - t * uy) ** 2 + (pz - t * uz) ** 2;
}
