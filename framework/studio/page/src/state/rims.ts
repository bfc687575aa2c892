// SPDX-License-Identifier: Apache-2.0
// The openings of gates, as the planner has them: they stand on a flat side, a corner up where
// their number is odd.

// Corners to the left and up of the middle, m, counter-clockwise. None of a ball, and of a shape
// that is not known.
export function rimsOf(shape: string, size: (name: string) => number): [number, number][] {
  const w = size("width") / 2, h = size("height") / 2;
  if (shape === "rectangle") return [[-w, -h], [w, -h], [w, h], [-w, h]];
  if (shape === "triangle") return [[-w, -h], [w, -h], [0, h]];
  const count = { pentagon: 5, hexagon: 6 }[shape];
  if (!count) return [];
  const side = size("side");
  const radius = side > 0 ? side / (2 * Math.sin(Math.PI / count)) : size("radius");
  return Array.from({ length: count }, (_, k): [number, number] => {
    const angle = -Math.PI / 2 + Math.PI / count + (2 * Math.PI * k) / count;
    return [radius * Math.cos(angle), radius * Math.sin(angle)];
  });
}
