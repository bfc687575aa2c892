// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { roomier, strengthFor, Game, KeyStick, padStick, placeOf, type Stick } from "../src/state/game";
import { applied } from "../src/state/document";
import type { Raced } from "../src/state/types";

const raced = (time: number, more: Partial<Raced> = {}): Raced => ({
  type: "raced", id: "g", time, over: false, players: [{ name: "a", by_hand: true,
    position: [time, 0, 2], orientation: [1, 0, 0, 0], speed: 1, progress: time, deviation: 0,
    score: time }], ...more,
});

function begun(): { game: Game; sent: [number, Stick[]][] } {
  const sent: [number, Stick[]][] = [];
  const game = new Game((_id, time, sticks) => {
    sent.push([time, sticks]);
    return true;
  });
  game.begun("g");
  game.took(raced(0), 1000);
  return { game, sent };
}

test("a key moves the stick in a moment, and lets it back", () => {
  const stick = new KeyStick("arrows");
  const held = new Set(["arrowup", "arrowleft"]);
  const [forward, left] = stick.move(held, 0.05);
  assert.ok(forward > 0.2 && forward < 0.5 && left === forward);
  assert.deepEqual(stick.move(held, 1), [1, 1]);
  held.clear();
  assert.deepEqual(stick.move(held, 1), [0, 0]);
  assert.deepEqual(new KeyStick("letters").move(new Set(["s", "d"]), 1), [-1, -1]);
});

test("a stick is as strong as the course asks for", () => {
  assert.deepEqual(strengthFor({ time: [0, 1], ax: [3, -12], ay: [4, 16] }), { strength: 20, reach: 8 });
  assert.deepEqual(strengthFor({ time: [0] }), { strength: 4, reach: 1.6 });
});

test("a course to the rims of its gates is made roomier, once", () => {
  const course = { margin: 0.02, thrust: 1, gates: [] };
  const edit = roomier(course);
  assert.ok(edit);
  const wider = applied(course, edit.patch);
  assert.deepEqual([wider.margin, wider.thrust], [0.3, 0.6]);
  assert.equal(roomier(wider), null);
  assert.equal(roomier({ margin: 0.5, thrust: 0.9 }), null);
});

test("a gamepad's axes point right and back; their middle is wide", () => {
  assert.deepEqual(padStick([0.05, -0.02]), [0, 0]);
  assert.deepEqual(padStick([1, -1]), [1, -1]);
  assert.deepEqual(padStick([-1, 1]), [-1, 1]);
  assert.deepEqual(padStick([]), [0, 0]);
});

test("after a countdown sticks are sent one at a time, and time rises with frames", () => {
  const { game, sent } = begun();
  assert.equal(game.phase, "countdown");
  assert.ok(game.frame(2000, () => [[0, 0]]) > 0);
  game.frame(4001, () => [[0, 0]]);
  assert.equal(game.phase, "flying");
  game.frame(4017, () => [[1, 0]]);
  game.frame(4034, () => [[1, 0]]);          // the first has no answer yet
  assert.equal(sent.length, 1);
  game.took(raced(0.016), 4040);
  game.frame(4500, () => [[1, 0]]);          // a frame that took long: the game waits for it
  game.took(raced(0.066), 4505);
  game.frame(4517, () => [[1, 0]]);
  game.frame(4533, () => [[1, 0]]);          // while the answer is on its way
  game.took(raced(0.083), 4540);
  game.frame(4550, () => [[1, 0]]);          // both frames count
  assert.ok(Math.abs((sent[3]?.[0] ?? 0) - 0.116) < 1e-9, String(sent[3]?.[0]));
  assert.equal(sent.length, 4);
  assert.ok(Math.abs((sent[1]?.[0] ?? 0) - 0.066) < 1e-9);
});

test("a pause stops the clock; a countdown follows it", () => {
  const { game, sent } = begun();
  game.frame(4001, () => [[0, 0]]);
  game.pause("the gamepad is gone");
  game.frame(4100, () => [[0, 0]]);
  assert.equal(sent.length, 0);
  game.resume(5000);
  assert.equal(game.phase, "countdown");
  game.frame(8001, () => [[0, 0]]);
  game.frame(8017, () => [[0, 0]]);
  assert.ok((sent[0]?.[0] ?? 9) <= 0.05);
});

test("sticks that cannot be sent pause the game", () => {
  const game = new Game(() => false);
  game.begun("g");
  game.took(raced(0), 0);
  game.frame(3001, () => [[0, 0]]);
  game.frame(3017, () => [[0, 0]]);
  assert.equal(game.phase, "paused");
});

test("a game that is over leaves tracks, which a ghost flies", () => {
  const { game } = begun();
  game.took(raced(1), 2000);
  game.took(raced(2, { over: true, result: "a wins" }), 3000);
  assert.equal(game.phase, "over");
  const track = game.tracks.get("a");
  assert.ok(track);
  assert.deepEqual(placeOf(track, 0.5), [0.5, 0, 2]);
  assert.deepEqual(placeOf(track, 9), [2, 0, 2]);
  assert.equal(placeOf({ times: [], places: [] }, 1), null);
});
