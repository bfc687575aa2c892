// SPDX-License-Identifier: Apache-2.0
// The conversation with the server: greeting, gestures with their replay, drags, answers, and the
// way back after a lost connection. It knows no browser: sockets and clocks are handed in.
import { applied, equal } from "./document";
import { choicesIn, optionsIn } from "./installed";
import { Grades, type Standing } from "./grades";
import { tryPatch } from "./queue";
import type { Event, Link, SessionParts, Socket } from "./session_parts";
import type {
  Answer, Choices, FirstFlight, Gesture, JsonObject, MissionInfo, Option, Patch, PlanningProgress, ServerMessage,
  Welcome, World,
} from "./types";

export type { Clock, Event, Link, SessionParts, Socket } from "./session_parts";

const PREVIEW_EVERY = 40;                              // ms
const WAITS = [100, 200, 400, 800];              // ms, between attempts to connect
const CONNECT_LIMIT = 4000;                            // ms
const MOST_AFTER = 64;                                 // as many as the server lets wait

export class Session {
  readonly grades: Grades;
  link: Link = "connecting";
  private progress: PlanningProgress | null = null;
  mission: MissionInfo = { name: "", kind: "", script: "", editable: false };
  schema: Option[] = [];
  choices: Choices = {};
  world: World = {};
  firstFlight: FirstFlight | null = null;     // of a pattern that was edited since it was flown
  revision = 0;
  canUndo = false;
  canRedo = false;
  undoLabel = "";
  redoLabel = "";
  welcomed = false;
  scriptError: { message: string; line?: number } | null = null;
  private stored: JsonObject = {};
  private drag: { edit: number; patch: Patch } | null = null;
  private edits = 0;
  private sentAt = -Infinity;
  private timer: number | null = null;
  private socket: Socket | null = null;
  private attempts = 0;
  private greeted = false;
  private hungUp = 0;
  private watch: number | null = null;
  private steps: ("undo" | "redo")[] = [];   // asked for while gestures were on their way
  private readonly listeners: ((event: Event) => void)[] = [];

  constructor(private readonly parts: SessionParts) {
    this.grades = new Grades(parts.tab);
  }

  on(listener: (event: Event) => void): void {
    this.listeners.push(listener);
  }

  start(): void {
    this.open();
  }

  // What is on display: the stored document, gestures on their way, the drag under way.
  document(): JsonObject {
    const base = this.parts.queue.onto(this.stored);
    return this.drag ? tryPatch(base, this.drag.patch) : base;
  }

  // The same without the drag: what a drag is measured from.
  settled(): JsonObject {
    return this.parts.queue.onto(this.stored);
  }

  standing(): Standing {
    return this.grades.standing();
  }

  get pending(): number {
    return this.parts.queue.size;
  }

  // Whether the server refuses the token of this page: it was started anew.
  get strange(): boolean {
    return this.hungUp >= 3;
  }

  get dragging(): boolean {
    return this.drag !== null;
  }

  // The number of the state on display, for `fly` and `picture`.
  get edit(): number {
    return this.edits;
  }

  // A drag under way; sent at most every 40 ms, the newest always.
  preview(patch: Patch): void {
    if (!this.mission.editable) return;
    this.edits += 1;
    this.drag = { edit: this.edits, patch };
    this.moment();
    this.tell({ what: "document" });
    const wait = this.sentAt + PREVIEW_EVERY - this.parts.clock.now();
    if (wait <= 0) this.sendPreview();
    else if (this.timer === null) {
      this.timer = this.parts.clock.later(wait, () => this.sendPreview());
    }
  }

  private sendPreview(): void {
    if (this.timer !== null) this.parts.clock.cancel(this.timer);
    this.timer = null;
    if (!this.drag) return;
    this.sentAt = this.parts.clock.now();
    this.send({ type: "preview", edit: this.drag.edit, patch: this.drag.patch });
  }

  // The drag was dropped: nothing has changed.
  rest(): void {
    if (!this.drag) return;
    this.endDrag();
    this.moment();
    this.send({ type: "rest" });
    this.draft(null);
    this.tell({ what: "document" });
  }

  private endDrag(): void {
    if (this.timer !== null) this.parts.clock.cancel(this.timer);
    this.timer = null;
    this.drag = null;
  }

  // One finished edit. Returns its id, or null when it would change nothing.
  gesture(label: string, patch: Patch): string | null {
    if (!this.mission.editable) {
      this.tell({ what: "note", text: this.mission.why_not ?? "This mission cannot be edited." });
      this.rest();
      return null;
    }
    let after: JsonObject;
    try {
      after = applied(this.settled(), patch);
    } catch (error) {
      this.rest();
      this.tell({ what: "note", text: (error as Error).message });
      return null;
    }
    if (equal(after, this.settled())) {
      this.rest();
      return null;
    }
    this.endDrag();
    // What is on its way was there when this was made: the server must not take it for another's.
    const on = this.parts.queue.all().map((waiting) => waiting.id).slice(-MOST_AFTER);
    return this.queued({ type: "gesture", id: this.parts.unique(), base: this.revision, label,
                         patch, ...(on.length > 0 ? { after: on } : {}) });
  }

  undo(): void {
    this.step("undo", this.canUndo);
  }

  redo(): void {
    this.step("redo", this.canRedo);
  }

  private step(type: "undo" | "redo", can: boolean): void {
    if (!can && this.pending === 0) {
      this.tell({ what: "note", text: `Nothing to ${type}.` });
      return;
    }
    if (this.drag) {
      this.rest();
      return;                      // a drag is what there is to undo
    }
    this.steps.push(type);
    this.nextStep();
  }

  // Undo and redo are of the newest revision: they wait for the gestures before them.
  private nextStep(): void {
    if (this.pending > 0) return;
    const type = this.steps.shift();
    if (!type) return;
    if (type === "undo" ? this.canUndo : this.canRedo) {
      this.queued({ type, id: this.parts.unique(), base: this.revision });
    } else {
      this.steps = [];
    }
  }

  private queued(gesture: Gesture): string {
    this.parts.queue.add(gesture);
    this.moment();
    this.send(gesture as unknown as JsonObject);
    this.tell({ what: "document" });
    return gesture.id;
  }

  ask(message: JsonObject): string {
    const id = this.parts.unique();
    const sent = this.send("id" in message ? { ...message, id } : message);
    if (!sent) this.tell({ what: "note", text: "Not connected: try again in a moment." });
    return id;
  }

  // Sticks of a game, at a time of it. Whether they were sent.
  stick(id: string, time: number, sticks: [number, number][]): boolean {
    return this.send({ type: "stick", id, time, sticks });
  }

  private send(message: JsonObject | Gesture): boolean {
    if (this.link !== "open" || !this.socket) return false;
    this.socket.send(JSON.stringify(message));
    return true;
  }

  private moment(): void {
    this.grades.at({
      revision: this.revision, edit: this.drag?.edit ?? null, pending: this.parts.queue.size,
    });
  }

  // A sentence for the user.
  note(text: string): void {
    this.tell({ what: "note", text });
  }

  private tell(event: Event): void {
    for (const listener of this.listeners) listener(event);
  }

  // ---- connection ------------------------------------------------------------------------------

  private open(): void {
    const { clock } = this.parts;
    let socket: Socket;
    try {
      socket = this.parts.connect();
    } catch {
      this.again();
      return;
    }
    this.socket = socket;
    this.watch = clock.later(CONNECT_LIMIT, () => {
      if (this.link !== "open") this.dropped(socket);
    });
    socket.onopen = () => {
      this.greeted = true;
      socket.send(JSON.stringify({
        type: "hello", token: this.parts.token, tab: this.parts.tab, seen: this.revision,
      }));
    };
    socket.onmessage = (event) => {
      if (socket === this.socket) this.receive(String(event.data));
    };
    socket.onclose = () => this.dropped(socket);
  }

  private dropped(socket: Socket): void {
    if (socket !== this.socket) return;
    this.socket = null;
    socket.onclose = null;
    socket.close();
    if (this.watch !== null) this.parts.clock.cancel(this.watch);
    this.watch = null;
    // A server that takes the greeting and hangs up knows another token.
    this.hungUp = this.greeted && this.link !== "open" ? this.hungUp + 1 : 0;
    this.greeted = false;
    if (this.link !== "lost" || this.hungUp === 3) {
      this.link = "lost";
      this.tell({ what: "link" });
    }
    this.again();
  }

  private again(): void {
    const wait = WAITS[Math.min(this.attempts, WAITS.length - 1)] as number;
    this.attempts += 1;
    this.parts.clock.later(wait, () => this.open());
  }

  // ---- what comes --------------------------------------------------------------------------------

  private receive(text: string): void {
    let message: ServerMessage;
    try {
      message = JSON.parse(text) as ServerMessage;
    } catch {
      this.tell({ what: "note", text: "The server sent something that cannot be read." });
      return;
    }
    switch (message.type) {
      case "welcome": return this.welcome(message);
      case "document": return this.changed(message);
      case "answer": return this.answered(message);
      case "refused":
      case "failed": return this.refused(message);
      case "first_flight": return this.drafted(message);
      case "world":
        this.draft(null);
        this.world = message;
        return this.tell({ what: "world" });
      case "progress":
        this.progress = message;
        return this.tell({ what: "standing" });
      case "flown": return this.tell({ what: "flown", message });
      case "picture": return this.tell({ what: "picture", message });
      case "wrote": return this.tell({ what: "wrote", message });
      case "estimate":
        if (message.tab !== this.parts.tab || message.edit !== this.drag?.edit) return;
        return this.tell({ what: "estimate", message });
      case "raced":
      case "backdrop":
      case "image":
      case "pace":
      case "run":
      case "runs": return this.tell({ what: message.type, message });
      case "voxel":
      case "slice":
      case "left_out":
      case "view": return this.tell({ what: "look", message });
      case "worker": return this.tell({ what: "worker", message });
      case "remark": return this.tell({ what: "note", text: message.message });
      case "script_changed":
        this.scriptError = null;
        return this.tell({ what: "script", message });
      case "script_error":
        this.scriptError = message;
        return this.tell({ what: "script", message });
      case "script_loaded":
        this.scriptError = null;
        return this.tell({ what: "script", message });
      case "mission":
        this.mission = message.mission;
        if (!this.mission.editable) this.endDrag();
        this.moment();
        return this.tell({ what: "document" });
      default:
        return;
    }
  }

  private welcome(message: Welcome): void {
    this.stored = message.document ?? {};
    this.undoLabel = message.undo_label ?? "";
    this.redoLabel = message.redo_label ?? "";
    this.revision = message.revision;
    this.canUndo = message.can_undo;
    this.canRedo = message.can_redo;
    this.mission = message.mission;
    this.schema = optionsIn(message.schema);
    this.choices = choicesIn(message.schema, message.choices);
    if (message.world) this.world = message.world;
    this.draft(null);
    this.link = "open";
    this.hungUp = 0;
    this.greeted = false;
    this.attempts = 0;
    this.welcomed = true;
    if (this.watch !== null) this.parts.clock.cancel(this.watch);
    this.watch = null;
    // A drag that the lost server knew of is told again, like the gestures before it.
    for (const gesture of this.parts.queue.all()) this.send(gesture);
    this.moment();
    if (message.answer) this.grades.take(message.answer);
    this.tell({ what: "welcome" });
    this.tell({ what: "link" });
    this.tell({ what: "standing" });
    if (this.drag) this.sendPreview();
  }

  private changed(message: ServerMessage & { type: "document" }): void {
    const mine = this.parts.queue.settle(message.by);
    // A gesture that was applied before the connection was lost is acknowledged once more, with the
    // revision that we have already.
    if (message.revision > this.revision + 1) {
      this.socket?.close();        // something was missed: greet again
      return;
    }
    if (message.revision > this.revision) {
      try {
        this.stored = applied(this.stored, message.patch);
      } catch (error) {
        this.tell({ what: "note", text: (error as Error).message });
        this.socket?.close();      // the documents differ: greet again
        return;
      }
      this.revision = message.revision;
    }
    this.canUndo = message.can_undo;
    this.canRedo = message.can_redo;
    this.undoLabel = message.undo_label ?? "";
    this.redoLabel = message.redo_label ?? "";
    this.scriptError = null;
    this.moment();
    this.tell({ what: "document", message });
    if (mine) this.tell({ what: "settled", text: message.by });
    this.nextStep();
  }

  // What another tab drags is not shown here.
  private drafted(message: FirstFlight): void {
    const mine = message.tab === this.parts.tab && message.edit === this.drag?.edit;
    if (message.edit === null || mine) this.draft(message);
  }

  private draft(flight: FirstFlight | null): void {
    if (flight === this.firstFlight) return;
    this.firstFlight = flight;
    this.tell({ what: "first_flight" });
  }

  // How far planning has come, of the document as it is and until it has an answer.
  planning(): PlanningProgress | null {
    const { progress } = this;
    const here = progress?.revision === this.revision && this.pending === 0 && !this.drag;
    return here && ["guess", "step"].includes(this.standing().grade) ? progress : null;
  }

  private answered(message: Answer): void {
    this.progress = null;
    this.grades.take(message);
    this.tell({ what: "standing", message });
  }

  private refused(message: ServerMessage & { type: "refused" | "failed" }): void {
    if (message.id !== undefined && this.parts.queue.settle(message.id)) {
      this.steps = [];
      this.draft(null);
      this.moment();
    }
    this.tell({ what: "document" });
    if (message.edit !== undefined && this.drag && message.edit < this.drag.edit) return;
    this.tell({ what: "note", text: message.why, message });
  }
}
