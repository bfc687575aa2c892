// SPDX-License-Identifier: Apache-2.0
// A coarse stand-in for many triangles: corners of one cell of a grid become one, in their mean, and
// triangles that fall together are left out (vertex clustering: Rossignac and Borrel, "Multi-resolution
// 3D approximations for rendering complex scenes", 1993).

export interface Soup {
  place: ArrayLike<number>;    // three corners a triangle, m
  tint: ArrayLike<number>;     // their colours
}

const FINEST = 160, WIDER = 1.6;   // cells along the longest side; growth of a cell

// At most so many triangles.
export function coarseOf(soup: Soup, most: number): { place: Float32Array; tint: Uint8Array } {
  const { place } = soup;
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (let k = 0; k < place.length; ++k) {
    const v = place[k] as number, axis = k % 3;
    if (v < (low[axis] as number)) low[axis] = v;
    if (v > (high[axis] as number)) high[axis] = v;
  }
  const extent = Math.max(...high.map((v, axis) => v - (low[axis] as number)), 1e-6);
  for (let cell = extent / FINEST; ; cell *= WIDER) {
    const made = clustered(soup, low as [number, number, number], extent, cell);
    if (made.place.length / 9 <= most) return made;
  }
}

function clustered(
  { place, tint }: Soup, low: [number, number, number], extent: number, cell: number,
): { place: Float32Array; tint: Uint8Array } {
  const across = Math.ceil(extent / cell) + 1;
  const numbers = new Map<number, number>();
  const sums: number[] = [];              // x, y, z and count of each cell
  const corners = new Uint32Array(place.length / 3);
  for (let v = 0; v < corners.length; ++v) {
    const at = (axis: 0 | 1 | 2): number =>
      Math.floor(((place[3 * v + axis] as number) - low[axis]) / cell);
    const key = at(0) + across * (at(1) + across * at(2));
    let number = numbers.get(key);
    if (number === undefined) {
      number = sums.length / 4;
      numbers.set(key, number);
      sums.push(0, 0, 0, 0);
    }
    corners[v] = number;
    for (let axis = 0; axis < 3; ++axis) {
      sums[4 * number + axis] = (sums[4 * number + axis] as number) + (place[3 * v + axis] as number);
    }
    sums[4 * number + 3] = (sums[4 * number + 3] as number) + 1;
  }
  const count = sums.length / 4;
  const seen = new Set<number>();
  const kept: number[] = [];
  for (let t = 0; t + 2 < corners.length; t += 3) {
    const a = corners[t] as number, b = corners[t + 1] as number, c = corners[t + 2] as number;
    if (a === b || b === c || c === a) continue;
    // Its three cells in a turn that begins with the smallest: both sides of a sheet stay.
    const [p, q, r] = a < b && a < c ? [a, b, c] : b < c ? [b, c, a] : [c, a, b];
    const key = (p * count + q) * count + r;
    if (Number.isSafeInteger(key)) {
      if (seen.has(key)) continue;
      seen.add(key);
    }
    kept.push(t);
  }
  const out = { place: new Float32Array(9 * kept.length), tint: new Uint8Array(9 * kept.length) };
  kept.forEach((t, i) => {
    for (let corner = 0; corner < 3; ++corner) {
      const number = corners[t + corner] as number, n = sums[4 * number + 3] as number;
      for (let axis = 0; axis < 3; ++axis) {
        const to = 9 * i + 3 * corner + axis;
        out.place[to] = (sums[4 * number + axis] as number) / n;
        out.tint[to] = tint[3 * (t + corner) + axis] as number;
      }
    }
  });
  return out;
}
