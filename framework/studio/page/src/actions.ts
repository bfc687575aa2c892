// SPDX-License-Identifier: Apache-2.0
// What buttons and keys do: one place for both.
import { isPainting } from "./state/painting";
import { cutAt, moved, placeOfItem, retimed } from "./state/edits";
import { actionOf } from "./state/keys";
import { isExplored, isSite } from "./state/site";
import type { Vec3 } from "./state/types";
import type { Rate, Studio } from "./studio";
import { byId, forgetColours, typing } from "./view/dom";
import { inReport } from "./view/report";
import { duplicate, order, pace, remove, TURN, turn, type Selected } from "./panel/selected";
import type { CompareDialog } from "./panel/compare";
import type { ExportDialog, FlyDialog, HelpDialog } from "./panel/dialogs";
import type { ExplorationPanel } from "./panel/exploration_panel";
import type { FilmList } from "./panel/film_list";
import type { Notices } from "./panel/notices";
import { remember } from "./panel/notices";
import type { PaintingPanel } from "./panel/painting_panel";
import type { RaceGamePanel } from "./panel/race_game";
import type { ScanPanel } from "./panel/scan_panel";

export interface Parts {
  exploration: ExplorationPanel;
  painting: PaintingPanel;
  game: RaceGamePanel;
  scan: ScanPanel;
  studio: Studio;
  selected: Selected;
  list: FilmList;
  notices: Notices;
  exports: ExportDialog;
  flying: FlyDialog;
  help: HelpDialog;
  compare: CompareDialog;
  frame(): void;
  keyframeHere(): void;
  clickMiddle(): void;
  dropLook(): boolean;
  showFilmTab(): void;
}

const STEP = 0.5, SMALL = 0.05;   // m
const SETTLES = 400;              // ms after the last key, before moves become one edit

// Moves by keys come in bursts: a burst is one drag and one edit.
class KeyMoves {
  private place: Vec3 | null = null;
  private timer = 0;

  constructor(private readonly studio: Studio) {
    studio.on(["selection"], () => this.finish());
  }

  move(by: Vec3): void {
    const { studio } = this;
    const item = studio.selection;
    if (!item || !studio.editable) return;
    const base = studio.session.settled();
    const from = this.place ?? placeOfItem(base, item);
    if (!from) return;
    this.place = [from[0] + by[0], from[1] + by[1], from[2] + by[2]];
    this.item = item;
    studio.drag(moved(base, item, this.place));
    window.clearTimeout(this.timer);
    this.timer = window.setTimeout(() => this.finish(), SETTLES);
  }

  private item: Studio["selection"] = null;

  finish(): void {
    window.clearTimeout(this.timer);
    const { place, item } = this;
    this.place = null;
    if (place && item) this.studio.edit(moved(this.studio.session.settled(), item, place));
  }

  drop(): boolean {
    if (!this.place) return false;
    window.clearTimeout(this.timer);
    this.place = null;
    this.studio.session.rest();
    return true;
  }
}

export class Actions {
  private readonly moves: KeyMoves;

  constructor(private readonly parts: Parts) {
    this.moves = new KeyMoves(parts.studio);
    window.addEventListener("keydown", (event) => this.key(event));
    const simple: Record<string, string> = {
      undo: "undo", redo: "redo", fly: "fly", export: "export", report: "report", theme: "theme",
      help: "help", place: "place", insert: "insert", "add-subject": "subject", "fly-camera": "fly-camera", "keyframe-here": "keyframe-here",
      frame: "frame", play: "play", cut: "cut", draw: "draw", margins: "margins", compare: "compare",
      "map": "map", "speeds": "speeds", "place-gate": "place", "add-gate": "insert", "race-it": "race", "place-start": "place",
    };
    for (const [id, action] of Object.entries(simple)) {
      byId(id).addEventListener("click", () => this.run(action, ""));
    }
    byId("to-start").addEventListener("click", () => this.run("ends", "Home"));
    for (const [id, key] of [["rate-half", "1"], ["rate-one", "2"], ["rate-two", "3"]] as const) {
      byId(id).addEventListener("click", () => this.run("speed", key));
    }
  }

  private key(event: KeyboardEvent): void {
    const found = actionOf(event);
    if (!found) return;
    const open = document.querySelector("dialog[open]");
    if (found.action === "escape") {
      if (open instanceof HTMLDialogElement && !open.matches(":modal")) open.close();
      else if (!open) this.run("escape", "Escape");
      return;
    }
    if (typing(event.target) && !(event.ctrlKey && found.key !== "Ctrl+Z")) return;
    if (open?.matches(":modal")) return;
    const onControl = event.target instanceof HTMLButtonElement ||
      event.target instanceof HTMLInputElement;
    // Space and Enter belong to the button that has the focus, arrows to a slider.
    const pin = event.target instanceof HTMLElement && event.target.matches(".pin, .item");
    if (onControl && (found.key === "Space" || found.key === "Enter") && !pin) return;
    if (event.target instanceof HTMLInputElement && event.target.type === "range") return;
    if (event.target instanceof HTMLElement && event.target.getAttribute("role") === "tab" &&
        found.key.startsWith("Arrow")) return;
    if (this.run(found.action, found.key, event.shiftKey)) event.preventDefault();
  }

  // Whether it did something.
  run(action: string, key: string, shift = false): boolean {
    const { parts } = this;
    const { studio } = parts;
    const size = shift ? SMALL : STEP;
    if (inReport && this.asksServer(action)) {
      parts.notices.say("A report can be looked at. lapwing studio edits the mission.");
      return true;
    }
    if (studio.run && ["fly", "export", "report", "compare"].includes(action)) {
      parts.notices.say("A run's folder is shown: go back to the mission first.");
      return true;
    }
    if (action !== "move" && action !== "lift" && action !== "escape") this.moves.finish();
    switch (action) {
      case "play": studio.play(!studio.playing); return true;
      case "nudge":
        studio.play(false);
        studio.seek(studio.time + (key === "," ? -0.1 : 0.1));
        return true;
      case "ends": studio.seek(key === "Home" ? 0 : studio.duration); return true;
      case "speed": studio.setRate({ 1: 0.5, 2: 1, 3: 2 }[key] as Rate); return true;
      case "choose":
        if (!parts.exploration.step(key === "[" ? -1 : 1) && !parts.scan.step(key === "[" ? -1 : 1)) {
          this.choose(key === "[" ? -1 : 1);
        }
        return true;
      case "move": return this.arrow(key, size, shift);
      case "lift": return this.moveSelected([0, 0, key === "PageUp" ? size : -size]);
      case "retime": return this.retime(key === "Alt+ArrowLeft" ? -0.1 : 0.1);
      case "pace": return pace(studio, key === "Alt+PageUp" ? "faster" : "slower");
      case "walk": studio.setMode(studio.mode === "walk" ? "orbit" : "walk"); return true;
      case "map":
        if (studio.mode === "race") return true;
        if (studio.mode === "camera") studio.setMode("orbit");
        studio.map = !studio.map;
        studio.tell("look");
        return true;
      case "speeds": studio.speeds = !studio.speeds; studio.tell("look"); return true;
      case "margins": studio.margins = !studio.margins; studio.tell("look"); return true;
      case "compare": parts.compare.open(); return true;
      case "order": order(studio, key === "Alt+ArrowUp" ? -1 : 1); return true;
      case "insert":
        if (studio.course) parts.list.addGate();
        else if (isPainting(studio.document)) parts.painting.add();
        else parts.list.insertAtHead();
        return true;
      case "place": studio.setMode(studio.mode === "place" ? "orbit" : "place"); return true;
      case "draw":
        if (isPainting(studio.document)) parts.painting.draw();
        else studio.setMode(studio.mode === "draw" ? "orbit" : "draw");
        return true;
      case "shot":
        parts.showFilmTab();
        byId("shot").focus();
        return true;
      case "duplicate": duplicate(studio); return true;
      case "delete": {
        const why = remove(studio);
        if (why) parts.notices.say(why, "bad");
        return studio.selection !== null || why !== null;
      }
      case "look":
        if (studio.selection?.kind === "keyframe") studio.setMode("aim");
        else parts.notices.say("Select a keyframe first.");
        return true;
      case "type":
        if (studio.mode === "place" || studio.mode === "aim" ||
            (!studio.selection && studio.mode === "orbit" &&
             (isSite(studio.document) || isExplored(studio.document)))) {
          parts.clickMiddle();
          return true;
        }
        if (!studio.selection) return false;
        parts.showFilmTab();
        parts.selected.focus();
        return true;
      case "cut":
        studio.edit(cutAt(studio.document, studio.time, Math.min(studio.time + 1, studio.duration)));
        return true;
      case "obstacle": parts.list.addObstacle(); return true;
      case "subject": parts.list.addSubject(); return true;
      case "fly-camera":
        studio.play(false);
        studio.setMode(studio.mode === "camera" ? "orbit" : "camera");
        byId("world").focus();
        return true;
      case "keyframe-here": parts.keyframeHere(); return true;
      case "frame": studio.setMode("orbit"); parts.frame(); return true;
      case "guides": studio.guides = !studio.guides; studio.tell("look"); return true;
      case "framing": studio.framing = !studio.framing; studio.tell("look"); return true;
      case "theme": this.theme(); return true;
      case "fly": parts.flying.open(); return true;
      case "race": parts.game.open(); return studio.course !== null;
      case "export": parts.exports.open(); return true;
      case "report":
        studio.session.ask({ type: "save_report", id: "" });
        parts.notices.say("Writing the report\u2026");
        return true;
      case "undo": studio.session.undo(); return true;
      case "redo": studio.session.redo(); return true;
      case "help": parts.help.open(); return true;
      case "escape": return this.escape();
      default: return false;
    }
  }

  private asksServer(action: string): boolean {
    return ["fly", "export", "report", "race", "undo", "redo"].includes(action);
  }

  private escape(): boolean {
    const { studio } = this.parts;
    if (this.moves.drop()) return true;
    if (studio.session.dragging) studio.session.rest();
    else if (studio.mode !== "orbit") studio.setMode("orbit");
    else if (studio.selection || !this.parts.dropLook()) studio.select(null);
    return true;
  }

  private moveSelected(by: Vec3): boolean {
    if (!this.parts.studio.selection) return false;
    this.moves.move(by);
    return true;
  }

  private arrow(key: string, size: number, shift: boolean): boolean {
    const { studio } = this.parts;
    const by: Record<string, Vec3> = {
      ArrowLeft: [-size, 0, 0], ArrowRight: [size, 0, 0], ArrowUp: [0, size, 0],
      ArrowDown: [0, -size, 0],
    };
    if (this.moveSelected(by[key] as Vec3)) return true;
    if (key === "ArrowLeft" || key === "ArrowRight") {
      studio.play(false);
      studio.seek(studio.time + (key === "ArrowLeft" ? -1 : 1) * (shift ? 1 : 0.1));
      return true;
    }
    return false;
  }

  private choose(by: -1 | 1): void {
    const { studio } = this.parts;
    if (studio.course) return this.chooseGate(studio.course.gates.length, by);
    const count = studio.film.keyframes.length;
    if (count === 0) return;
    const at = studio.selection?.kind === "keyframe" ? studio.selection.index : by > 0 ? -1 : count;
    const index = (at + by + count) % count;
    studio.select({ kind: "keyframe", index });
    studio.seek(studio.timeOf(index));
  }

  private chooseGate(count: number, by: -1 | 1): void {
    const { studio } = this.parts;
    if (count === 0) return;
    const at = studio.selection?.kind === "gate" ? studio.selection.index : by > 0 ? -1 : count;
    studio.select({ kind: "gate", index: (at + by + count) % count });
  }

  private retime(by: number): boolean {
    const { studio } = this.parts;
    if (studio.selection?.kind === "gate") return turn(studio, by < 0 ? TURN : -TURN);
    if (studio.selection?.kind !== "keyframe") return false;
    const { index } = studio.selection;
    const time = studio.film.keyframes[index]?.time;
    if (time !== undefined) studio.edit(retimed(studio.document, index, time + by));
    return true;
  }

  private theme(): void {
    const dark = getComputedStyle(document.documentElement).colorScheme.includes("dark");
    const next = dark ? "light" : "dark";
    document.documentElement.dataset.theme = next;
    remember("lapwing-theme", next);
    forgetColours();
    this.parts.studio.tell("look");
  }
}
