// SPDX-License-Identifier: Apache-2.0
// Blobs: uint32 N (little endian), N bytes of JSON {"arrays": [{name, type, count}]}, zeros up to a
// multiple of four, then the arrays one after another.
import type { Triangles } from "./shapes";

type Array = Float32Array | Uint32Array;

export function readBlob(buffer: ArrayBuffer): Map<string, Array> {
  if (buffer.byteLength < 4) throw new Error("blob: shorter than its header");
  const size = new DataView(buffer).getUint32(0, true);
  if (4 + size > buffer.byteLength) throw new Error("blob: its header is longer than itself");
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, size))) as {
    arrays?: { name: string; type: string; count: number }[];
  };
  const arrays = new Map<string, Array>();
  let offset = Math.ceil((4 + size) / 4) * 4;
  for (const { name, type, count } of header.arrays ?? []) {
    if (!Number.isInteger(count) || count < 0 || offset + 4 * count > buffer.byteLength) {
      throw new Error(`blob: the array ${name} reaches beyond its end`);
    }
    if (type === "f32") arrays.set(name, new Float32Array(buffer, offset, count));
    else if (type === "u32") arrays.set(name, new Uint32Array(buffer, offset, count));
    else throw new Error(`blob: the array ${name} has the unknown type ${type}`);
    offset += 4 * count;
  }
  return arrays;
}

export function trianglesIn(buffer: ArrayBuffer): Triangles {
  const arrays = readBlob(buffer);
  const positions = arrays.get("positions"), triangles = arrays.get("triangles");
  if (!(positions instanceof Float32Array) || !(triangles instanceof Uint32Array)) {
    throw new Error("blob: no triangles in it");
  }
  const most = positions.length / 3;
  for (const corner of triangles) {
    if (corner >= most) throw new Error(`blob: corner ${corner} of ${most}`);
  }
  return { positions, triangles };
}
