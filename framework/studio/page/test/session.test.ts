// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { GestureQueue } from "../src/state/queue";
import { Session, type Event, type Socket } from "../src/state/session";
import type { JsonObject, Patch } from "../src/state/types";

class Wire implements Socket {
  sent: JsonObject[] = [];
  closed = false;
  onopen: (() => void) | null = null;
  onmessage: ((event: { data: unknown }) => void) | null = null;
  onclose: (() => void) | null = null;
  send(text: string): void {
    this.sent.push(JSON.parse(text) as JsonObject);
  }
  close(): void {
    this.closed = true;
  }
  says(message: object): void {
    this.onmessage?.({ data: JSON.stringify(message) });
  }
}

// A session with sockets and a clock in the hands of the test.
function world(queue = new GestureQueue()) {
  const wires: Wire[] = [], events: Event[] = [];
  const timers: { id: number; at: number; then: () => void }[] = [];
  let now = 0, made = 0, ids = 0;
  const session = new Session({
    token: "t", tab: "me", queue, unique: () => `id${++ids}`,
    connect: () => {
      const wire = new Wire();
      wires.push(wire);
      return wire;
    },
    clock: {
      now: () => now,
      later: (ms, then) => {
        timers.push({ id: ++made, at: now + ms, then });
        return made;
      },
      cancel: (id) => {
        const at = timers.findIndex((timer) => timer.id === id);
        if (at >= 0) timers.splice(at, 1);
      },
    },
  });
  session.on((event) => events.push(event));
  const pass = (ms: number): void => {
    const end = now + ms;
    for (;;) {
      const next = timers.filter((t) => t.at <= end).sort((a, b) => a.at - b.at)[0];
      if (!next) break;
      timers.splice(timers.indexOf(next), 1);
      now = next.at;
      next.then();
    }
    now = end;
  };
  const wire = (): Wire => wires[wires.length - 1] as Wire;
  const welcome = (revision = 0, document: JsonObject | null = { duration: 20 }): void => {
    wire().onopen?.();
    wire().says({ type: "welcome", mission: { name: "f", kind: "film", script: "f.lua",
      editable: true }, document, revision, can_undo: revision > 0, can_redo: false, schema: [],
      choices: {}, world: null, answer: null });
  };
  const told = (revision: number, patch: Patch, by: string): void =>
    wire().says({ type: "document", revision, patch, by, label: "", can_undo: true, can_redo: false });
  session.start();
  return { session, wires, wire, events, pass, welcome, told };
}

const longer: Patch = [{ path: "duration", value: 30 }];
const types = (wire: Wire): unknown[] => wire.sent.map((m) => m.type);
const notes = (events: Event[]): (string | undefined)[] =>
  events.filter((e) => e.what === "note").map((e) => e.text);

test("it greets first, with the token", () => {
  const { wire, welcome, session } = world();
  assert.deepEqual(wire().sent, []);
  welcome(4);
  assert.deepEqual(wire().sent[0], { type: "hello", token: "t", tab: "me", seen: 0 });
  assert.equal(session.revision, 4);
  assert.equal(session.link, "open");
});

test("a gesture is on display at once and acknowledged once", () => {
  const { session, wire, welcome, told } = world();
  welcome();
  assert.equal(session.gesture("longer", longer), "id1");
  assert.equal(session.document().duration, 30);
  assert.equal(session.pending, 1);
  told(1, longer, "id1");
  assert.equal(session.pending, 0);
  assert.equal(session.revision, 1);
  told(1, [], "id1");
  assert.equal(session.document().duration, 30);
  assert.deepEqual(types(wire()), ["hello", "gesture"]);
});

test("an edit that changes nothing is none; one that fits nowhere is told", () => {
  const { session, wire, welcome, events } = world();
  welcome();
  assert.equal(session.gesture("same", [{ path: "duration", value: 20 }]), null);
  assert.equal(session.gesture("bad", [{ path: "keyframes[3].time", value: 1 }]), null);
  assert.match(notes(events)[0] ?? "", /0 entries/);
  assert.deepEqual(types(wire()), ["hello"]);
});

test("previews are sent at most every 40 ms, the newest always", () => {
  const { session, wire, welcome, pass } = world();
  welcome();
  for (let i = 0; i < 20; ++i) {
    session.preview([{ path: "duration", value: i }]);
    pass(5);
  }
  pass(50);
  const sent = wire().sent.filter((m) => m.type === "preview");
  assert.ok(sent.length >= 3 && sent.length <= 4, String(sent.length));
  assert.deepEqual(sent[sent.length - 1], { type: "preview", edit: 20,
    patch: [{ path: "duration", value: 19 }] });
  session.rest();
  assert.equal(session.document().duration, 20);
  assert.deepEqual(types(wire()).slice(-1), ["rest"]);
});

test("a lost connection keeps edits and sends them again under their ids", () => {
  const { session, wires, wire, welcome, told, pass } = world();
  welcome();
  session.gesture("one", longer);
  wire().onclose?.();
  assert.equal(session.link, "lost");
  session.gesture("two", [{ path: "margin", value: 1 }]);
  assert.equal(session.document().margin, 1);
  pass(100);
  assert.equal(wires.length, 2);
  // The first had arrived before the connection went.
  welcome(1, { duration: 30 });
  assert.deepEqual(wire().sent.map((m) => m.id), [undefined, "id1", "id2"]);
  told(1, [], "id1");
  told(2, [{ path: "margin", value: 1 }], "id2");
  assert.equal(session.pending, 0);
  assert.deepEqual(session.document(), { duration: 30, margin: 1 });
});

test("it tries again and again, never faster than it should", () => {
  const { wires, wire, pass } = world();
  for (let i = 0; i < 6; ++i) {
    wire().onclose?.();
    pass(1500);
  }
  assert.equal(wires.length, 7);
  pass(6000);              // a connection that never opens is given up
  assert.ok(wires.length > 7);
});

test("undo waits for the gesture before it and is of the newest revision", () => {
  const { session, wire, welcome, told } = world();
  welcome();
  session.gesture("one", longer);
  session.undo();
  assert.deepEqual(types(wire()), ["hello", "gesture"]);
  told(1, longer, "id1");
  assert.deepEqual(wire().sent[2], { type: "undo", id: "id2", base: 1 });
});

test("nothing to undo is said", () => {
  const { session, welcome, events } = world();
  welcome();
  session.undo();
  assert.deepEqual(notes(events), ["Nothing to undo."]);
});

test("a refused gesture is taken off the display, with the reason", () => {
  const { session, wire, welcome, events } = world();
  welcome();
  session.gesture("one", longer);
  wire().says({ type: "refused", id: "id1", why: "too long" });
  assert.equal(session.document().duration, 20);
  assert.deepEqual(notes(events), ["too long"]);
});

test("another tab's edit goes beneath one's own", () => {
  const { session, welcome, told } = world();
  welcome();
  session.gesture("one", longer);
  told(1, [{ path: "margin", value: 2 }], "other");
  assert.deepEqual(session.document(), { duration: 30, margin: 2 });
  assert.equal(session.pending, 1);
});

test("a missed revision makes it greet again instead of guessing", () => {
  const { wire, welcome, told } = world();
  welcome();
  told(2, longer, "other");
  assert.equal(wire().closed, true);
});

test("what may not be edited says why, and nothing is sent", () => {
  const { session, wire, events } = world();
  wire().onopen?.();
  wire().says({ type: "welcome", mission: { name: "r", kind: "race", script: "r.lua",
    editable: false, why_not: "a race" }, document: {}, revision: 0, can_undo: false,
    can_redo: false, schema: [], choices: {} });
  assert.equal(session.gesture("x", longer), null);
  session.preview(longer);
  assert.deepEqual(notes(events), ["a race"]);
  assert.deepEqual(types(wire()), ["hello"]);
});

test("a script with an error leaves an empty film until it is mended", () => {
  const { session, wire, welcome, told } = world();
  welcome(0, null);
  wire().says({ type: "script_error", message: "unexpected symbol", line: 3 });
  assert.deepEqual(session.document(), {});
  assert.equal(session.scriptError?.line, 3);
  told(1, longer, "");
  assert.equal(session.scriptError, null);
});

test("an answer does not end an error of the script; the server says when it is over", () => {
  const { session, wire, welcome } = world();
  welcome();
  wire().says({ type: "script_error", message: "unexpected symbol", line: 3 });
  session.preview(longer);
  wire().says({ type: "answer", revision: 0, edit: 1, tab: "me", grade: "refused", plan: null,
                certificate: null, message: "f.lua:3: unexpected symbol", ms: 3 });
  assert.equal(session.scriptError?.line, 3);
  wire().says({ type: "script_loaded" });
  assert.equal(session.scriptError, null);
});

test("edits made on top of those on their way name them", () => {
  const { session, wire, welcome, told } = world();
  welcome();
  session.gesture("one", longer);
  session.gesture("two", [{ path: "duration", value: 40 }]);
  session.gesture("three", [{ path: "duration", value: 50 }]);
  const sent = wire().sent.filter((m) => m.type === "gesture");
  assert.deepEqual(sent.map((m) => m.after), [undefined, ["id1"], ["id1", "id2"]]);
  told(1, longer, "id1");
  assert.equal(session.document().duration, 50);
});

test("it is told when nothing can be edited any more", () => {
  const { session, wire, welcome, events } = world();
  welcome();
  session.preview(longer);
  wire().says({ type: "mission", mission: { name: "f", kind: "race", script: "f.lua",
                                            editable: false, why_not: "a race" } });
  assert.equal(session.mission.editable, false);
  assert.equal(session.dragging, false);
  assert.equal(session.gesture("more", longer), null);
  assert.deepEqual(notes(events), ["a race"]);
});

test("what cannot be read is told and survived", () => {
  const { session, wire, welcome, events } = world();
  welcome();
  wire().onmessage?.({ data: "{" });
  wire().says({ type: "nonsense" });
  assert.equal(notes(events).length, 1);
  assert.equal(session.link, "open");
});

test("a server with another token is told from one that is away", () => {
  const { session, wire, pass } = world();
  wire().onclose?.();
  pass(5000);
  assert.equal(session.strange, false);
  for (let i = 0; i < 3; ++i) {
    wire().onopen?.();
    wire().onclose?.();
    pass(1500);
  }
  assert.equal(session.strange, true);
});
