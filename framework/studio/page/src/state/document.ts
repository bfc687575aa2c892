// SPDX-License-Identifier: Apache-2.0
// A document as plain data: reading and changing it by the paths of options. Nothing is changed in
// place: a patch makes a new document that shares what it leaves alone.
import type { Change, Json, JsonObject, Patch } from "./types";

// "keyframes[2].position" as ["keyframes", 1, "position"]; indices count from 1 in the text.
export function parsePath(path: string): (string | number)[] {
  const parts: (string | number)[] = [];
  const word = /([^.[\]]+)|\[([0-9]+)\]|(\.)/y;
  let dotted = true;
  while (word.lastIndex < path.length) {
    const at = word.lastIndex;
    const found = word.exec(path);
    if (!found) throw new Error(`path "${path}": cannot be read at character ${at + 1}`);
    if (found[3] !== undefined) {
      if (dotted) throw new Error(`path "${path}": empty name at character ${at + 1}`);
      dotted = true;
    } else if (found[2] !== undefined) {
      const index = Number(found[2]);
      if (index < 1 || (dotted && parts.length > 0)) {
        throw new Error(`path "${path}": indices count from 1 and follow a name`);
      }
      parts.push(index - 1);
      dotted = false;
    } else {
      if (!dotted) throw new Error(`path "${path}": a name follows a dot`);
      parts.push(found[1] as string);
      dotted = false;
    }
  }
  if (dotted) throw new Error(`path "${path}": a name is missing at its end`);
  return parts;
}

export function isObject(value: Json | undefined): value is JsonObject {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}

function child(value: Json | undefined, part: string | number): Json | undefined {
  if (Array.isArray(value)) return typeof part === "number" ? value[part] : undefined;
  if (isObject(value)) return typeof part === "string" ? value[part] : undefined;
  return undefined;
}

export function valueAt(document: Json, path: string): Json | undefined {
  let value: Json | undefined = document;
  for (const part of parsePath(path)) value = child(value, part);
  return value;
}

function changed(value: Json | undefined, parts: (string | number)[], change: Change): Json {
  const [part, ...rest] = parts;
  if (part === undefined) return "value" in change ? change.value : null;
  const removes = rest.length === 0 && "remove" in change;
  if (typeof part === "number") {
    const list = Array.isArray(value) ? value.slice() : [];
    if (part > list.length || (part === list.length && removes)) {
      throw new Error(`${change.path}: the list has ${list.length} entries`);
    }
    if (removes) list.splice(part, 1);
    else list[part] = changed(list[part], rest, change);
    return list;
  }
  if (value !== undefined && value !== null && !isObject(value)) {
    // A plugin's name alone becomes a table with that name.
    if (typeof value !== "string") throw new Error(`${change.path}: ${part} is inside a value`);
    value = { type: value };
  }
  const object: JsonObject = { ...(value ?? {}) };
  if (removes) delete object[part];
  else object[part] = changed(object[part], rest, change);
  return object;
}

export function applied(document: JsonObject, patch: Patch): JsonObject {
  let result: Json = document;
  for (const change of patch) result = changed(result, parsePath(change.path), change);
  return result as JsonObject;
}

export function equal(a: Json | undefined, b: Json | undefined): boolean {
  if (a === b) return true;
  if (Array.isArray(a)) {
    return Array.isArray(b) && a.length === b.length && a.every((v, i) => equal(v, b[i]));
  }
  if (!isObject(a) || !isObject(b)) return false;
  const keys = Object.keys(a);
  return keys.length === Object.keys(b).length && keys.every((key) => equal(a[key], b[key]));
}

export function numberAt(document: Json, path: string): number | undefined {
  const value = valueAt(document, path);
  return typeof value === "number" && Number.isFinite(value) ? value : undefined;
}
