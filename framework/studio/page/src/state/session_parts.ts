// SPDX-License-Identifier: Apache-2.0
// What a session is made with, and what it tells.
import type { GestureQueue } from "./queue";
import type { ServerMessage } from "./types";

export interface Socket {
  send(text: string): void;
  close(): void;
  onopen: (() => void) | null;
  onmessage: ((event: { data: unknown }) => void) | null;
  onclose: (() => void) | null;
}

export interface Clock {
  now(): number;                                       // ms
  later(ms: number, then: () => void): number;
  cancel(id: number): void;
}

export type Link = "connecting" | "open" | "lost";

export interface Event {
  what: "link" | "welcome" | "document" | "standing" | "world" | "note" | "flown" | "picture" |
    "wrote" | "raced" | "estimate" | "image" | "pace" | "run" | "runs" | "look" | "first_flight" |
    "backdrop" |
    "script" | "worker" | "settled";
  message?: ServerMessage;
  text?: string;
}

export interface SessionParts {
  connect(): Socket;
  clock: Clock;
  queue: GestureQueue;
  token: string;
  tab: string;
  unique(): string;
}
