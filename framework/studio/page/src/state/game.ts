// SPDX-License-Identifier: Apache-2.0
// A race that is flown by hand: sticks from keys and gamepads, and a game whose clock goes on only
// while it is flown. The server flies; of each answer the page shows where everybody is.
import type { Edit } from "./edits";
import type { Columns, JsonObject, Raced } from "./types";
import { clamp } from "./vector";

export type Device = "arrows" | "letters" | "pad1" | "pad2";
export type Stick = [forward: number, left: number];

export const devices: { device: Device; text: string }[] = [
  { device: "arrows", text: "Arrow keys" },
  { device: "letters", text: "W A S D" },
  { device: "pad1", text: "First gamepad" },
  { device: "pad2", text: "Second gamepad" },
];

export interface Entrant {
  name: string;
  device: Device | null;       // null: computed
  weight: number;
  strength: number;            // m/s^2, of a full stick
  reach: number;               // m, that a full stick held across leads aside
  speed: number;
  handicap: number;            // s
}

// A stick is as strong as the course asks for; one that is held ends so many m aside.
const WEAKEST = 4, STRONGEST = 40;   // m/s^2
const PULL = 2.5;                    // 1/s^2, back to the course
const RIVAL = { weight: 0, strength: 10, reach: 1 };
export const ROOM = 0.3, THRUST = 0.6;   // m and share, with which a course can be flown by hand

export function strengthFor(columns: Columns): { strength: number; reach: number } {
  const { ax = [], ay = [] } = columns;
  const most = ax.reduce((worst, a, i) => Math.max(worst, Math.hypot(a, ay[i] ?? 0)), 0);
  const strength = Math.round(clamp(most, WEAKEST, STRONGEST));
  return { strength, reach: Math.round((10 * strength) / PULL) / 10 };
}

export function rival(speed: number): Entrant {
  return { name: "Computed", device: null, speed, handicap: 0, ...RIVAL };
}

// A course that leaves hands no room at its rims, made wider and slower; null where it has room.
export function roomier(document: JsonObject): Edit | null {
  const number = (name: string): number => Number(document[name] ?? 0);
  const patch: Edit["patch"] = [];
  if (number("margin") < ROOM) patch.push({ path: "margin", value: ROOM });
  if (number("thrust") > THRUST) patch.push({ path: "thrust", value: THRUST });
  return number("margin") < ROOM ? { label: "Make room for hands", patch } : null;
}

const RISE = 6;                // 1/s, of a stick that a key holds
const SLACK = 0.08;            // of a gamepad's stick, that counts as its middle
const LONGEST = 0.05;          // s of the game in one frame: a slower machine flies slower
const COUNTDOWN = 3;           // s

const keysOf: Record<"arrows" | "letters", [string, string, string, string]> = {
  arrows: ["arrowup", "arrowdown", "arrowleft", "arrowright"],
  letters: ["w", "s", "a", "d"],
};

export const gameKeys = new Set(Object.values(keysOf).flat());

// A key is all or nothing; the stick that it holds moves there in a moment.
export class KeyStick {
  private at: Stick = [0, 0];

  constructor(private readonly device: "arrows" | "letters") {}

  move(held: ReadonlySet<string>, seconds: number): Stick {
    const [forward, back, left, right] = keysOf[this.device].map((key) => Number(held.has(key))) as
      [number, number, number, number];
    const towards = (from: number, to: number): number =>
      from + clamp(to - from, -RISE * seconds, RISE * seconds);
    this.at = [towards(this.at[0], forward - back), towards(this.at[1], left - right)];
    return [...this.at];
  }
}

// Of a gamepad's first stick; axes point right and back.
export function padStick(axes: readonly number[]): Stick {
  const axis = (value: number): number => clamp(Math.abs(value) < SLACK ? 0
    : (value - Math.sign(value) * SLACK) / (1 - SLACK), -1, 1) + 0;
  return [axis(-(axes[1] ?? 0)), axis(-(axes[0] ?? 0))];
}

export type Phase = "starting" | "countdown" | "flying" | "paused" | "over" | "failed";

export interface Track {
  times: number[];
  places: [number, number, number][];
}

export class Game {
  phase: Phase = "starting";
  why = "";                    // of a pause and of a failure
  state: Raced | null = null;
  readonly tracks = new Map<string, Track>();
  private id: string | null = null;
  private time = 0;
  private last = 0;            // ms
  private began = 0;           // ms, of the countdown
  private sentAt: number | null = null;   // ms, of sticks without an answer

  constructor(private readonly sendStick: (id: string, time: number, sticks: Stick[]) => boolean) {}

  begun(id: string): void {
    this.id = id;
  }

  is(id: string | undefined): boolean {
    return id !== undefined && id === this.id;
  }

  // Once a frame; `sticks` moves the sticks by these seconds. Returns the seconds left to the start.
  frame(now: number, sticks: (seconds: number) => Stick[]): number {
    // Time goes on while an answer is waited for.
    if (this.phase === "flying" && this.sentAt !== null) return 0;
    const seconds = Math.min(LONGEST, Math.max(0, (now - this.last) / 1000));
    this.last = now;
    if (this.phase === "countdown") {
      const left = COUNTDOWN - (now - this.began) / 1000;
      if (left > 0) return left;
      this.phase = "flying";
      return 0;
    }
    if (this.phase !== "flying" || seconds <= 0 || !this.id) return 0;
    const told = sticks(seconds);
    if (!this.flying()) return 0;              // there was no stick to be read
    this.time += seconds;
    if (this.sendStick(this.id, this.time, told)) this.sentAt = now;
    else this.pause("The connection is lost.");
    return 0;
  }

  took(message: Raced, now: number): void {
    this.sentAt = null;
    this.state = message;
    for (const { name, position, end } of message.players) {
      const track = this.tracks.get(name) ?? { times: [], places: [] };
      this.tracks.set(name, track);
      if (end && track.times.length > 0) continue;
      track.times.push(message.time);
      track.places.push(position);
    }
    if (this.phase === "starting") {
      this.phase = "countdown";
      this.began = this.last = now;
    }
    if (message.result !== undefined) this.phase = "over";
  }

  fail(why: string): void {
    this.phase = "failed";
    this.why = why;
  }

  // A countdown begins again.
  pause(why: string): void {
    if (this.phase !== "flying" && this.phase !== "countdown") return;
    this.phase = "paused";
    this.why = why;
  }

  resume(now: number): void {
    if (this.phase !== "paused") return;
    this.phase = "countdown";
    this.began = now;
    this.sentAt = null;
  }

  private flying(): boolean {
    return this.phase === "flying";
  }

  get under(): boolean {
    return ["starting", "countdown", "flying", "paused"].includes(this.phase);
  }
}

// Where a flight was at a time; its last place afterwards.
export function placeOf(track: Track, time: number): [number, number, number] | null {
  let low = 0, high = track.times.length - 1;
  if (high < 0) return null;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if ((track.times[middle] as number) <= time) low = middle;
    else high = middle - 1;
  }
  const a = track.places[low] as [number, number, number];
  const b = track.places[low + 1];
  if (!b) return a;
  const from = track.times[low] as number, to = track.times[low + 1] as number;
  const share = clamp((time - from) / Math.max(to - from, 1e-9), 0, 1);
  return [0, 1, 2].map((i) => (a[i] as number) + share * ((b[i] as number) - (a[i] as number))) as
    [number, number, number];
}
