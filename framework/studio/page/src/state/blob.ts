// SPDX-License-Identifier: Apache-2.0
// Triangles as the server stores them: the text "WLB1", then as 32-bit little-endian numbers the
// counts of vertices and triangles and 0, three floats a vertex (m), three places a triangle.
import type { Triangles } from "./shapes";

const HEADER = 16;   // bytes

export function trianglesIn(buffer: ArrayBuffer): Triangles {
  const head = new DataView(buffer);
  const text = buffer.byteLength >= HEADER
    ? String.fromCharCode(...new Uint8Array(buffer, 0, 4)) : "";
  if (text !== "WLB1") throw new Error("blob: no triangles in it");
  const vertices = head.getUint32(4, true), count = head.getUint32(8, true);
  if (HEADER + 12 * vertices + 12 * count !== buffer.byteLength) {
    throw new Error(`blob: ${vertices} vertices and ${count} triangles are not ` +
      `${buffer.byteLength} bytes`);
  }
  const positions = new Float32Array(buffer, HEADER, 3 * vertices);
  const triangles = new Uint32Array(buffer, HEADER + 12 * vertices, 3 * count);
  for (const corner of triangles) {
    if (corner >= vertices) throw new Error(`blob: vertex ${corner} of ${vertices}`);
  }
  return { positions, triangles };
}
