// SPDX-License-Identifier: Apache-2.0
// Gestures on their way: kept until the server acknowledges them, sent again after a lost
// connection under the same id, which the server applies once.
import { applied } from "./document";
import type { Gesture, JsonObject, Patch } from "./types";

export interface Store {
  read(): string | null;
  write(text: string): void;
}

export class GestureQueue {
  private waiting: Gesture[] = [];

  // `store` outlives a reload of the page.
  constructor(private readonly store: Store | null = null) {
    const text = store?.read();
    if (!text) return;
    try {
      const kept: unknown = JSON.parse(text);
      if (Array.isArray(kept)) {
        this.waiting = kept.filter((g: Partial<Gesture>): g is Gesture =>
          typeof g?.id === "string" && typeof g.base === "number" &&
          (g.type === "gesture" || g.type === "undo" || g.type === "redo"));
      }
    } catch {
      this.waiting = [];
    }
  }

  add(gesture: Gesture): void {
    this.waiting.push(gesture);
    this.keep();
  }

  // Acknowledged, or refused: whether it was one of ours.
  settle(id: string): boolean {
    const before = this.waiting.length;
    this.waiting = this.waiting.filter((gesture) => gesture.id !== id);
    if (this.waiting.length === before) return false;
    this.keep();
    return true;
  }

  get size(): number {
    return this.waiting.length;
  }

  // In the order in which they were made, to be sent again.
  all(): readonly Gesture[] {
    return this.waiting;
  }

  // The document with the patches that are still on their way. A patch that fits no longer is left
  // to the server to refuse.
  onto(document: JsonObject): JsonObject {
    let result = document;
    for (const gesture of this.waiting) {
      if (gesture.patch) result = tryPatch(result, gesture.patch);
    }
    return result;
  }

  private keep(): void {
    this.store?.write(JSON.stringify(this.waiting));
  }
}

export function tryPatch(document: JsonObject, patch: Patch): JsonObject {
  try {
    return applied(document, patch);
  } catch {
    return document;
  }
}
