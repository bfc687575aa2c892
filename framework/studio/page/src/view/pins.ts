// SPDX-License-Identifier: Apache-2.0
// The pins of the world: a button at each keyframe, look-at point, subject and obstacle. A drag
// moves it on the level where it is; with Shift, up and down.
import * as THREE from "three";
import { corneredItem, entryOf, moved, nameOf, placeOfItem, sameItem, type Item } from
  "../state/edits";
import { isObject } from "../state/document";
import { entries } from "../state/film";
import { isExplored, isSite, siteLists, wishLists, type PolygonKind, type WishKind } from "../state/site";
import { cornersOf } from "../state/shapes";
import type { JsonObject, Vec3 } from "../state/types";
import type { Studio } from "../studio";
import { el, whileHeld } from "./dom";
import { level, meeting, type Stage } from "./stage";

const THRESHOLD = 3;     // px before a press is a drag
const MOST_OBSTACLES = 12;

interface Pin {
  item: Item;
  button: HTMLButtonElement;
  place: Vec3;
  where: string;      // its place on the screen; "": it is not there
}

export function itemsOf(document: JsonObject, selection: Item | null): Item[] {
  const items: Item[] = [];
  // A forest of pins hides the film: then obstacles are selected by a click on them, or in the list.
  const obstacles = entries(document, "obstacles");
  const cornered = corneredItem(document, selection);
  obstacles.forEach((_, index) => {
    const item: Item = { kind: "obstacle", index };
    if (obstacles.length <= MOST_OBSTACLES || sameItem(item, selection) ||
        sameItem(item, cornered)) items.push(item);
  });
  entries(document, "flight_zones").forEach((_, index) => items.push({ kind: "zone", index }));
  for (const kind of ["region", "closed"] as const) {
    entries(document, siteLists[kind]).forEach((_, index) => items.push({ kind, index }));
  }
  for (const kind of Object.keys(wishLists) as WishKind[]) {
    entries(document, wishLists[kind]).forEach((_, index) => items.push({ kind, index }));
  }
  if (isExplored(document)) items.push({ kind: "place", index: 0 });
  if (isSite(document)) {
    for (const index of [0, 1] as const) {
      items.push({ kind: "place", index });
      if (entries(document, "regions").length === 0) items.push({ kind: "extent", index });
    }
  }
  if (cornered && (cornered.kind === "obstacle" || cornered.kind in siteLists)) {
    cornersOf(entryOf(document, cornered)?.corners).forEach((_, point) =>
      items.push({ kind: "corner", of: cornered.kind as "obstacle" | PolygonKind,
                   index: cornered.index, point }));
  }
  entries(document, "subjects").forEach((entry, index) => {
    items.push({ kind: "subject", index });
    if (!Array.isArray(entry.track)) return;
    entry.track.filter(isObject).forEach((_, point) => {
      if (point > 0) items.push({ kind: "track", index, point });
    });
  });
  entries(document, "keyframes").forEach((entry, index) => {
    if (Array.isArray(entry.look_at)) items.push({ kind: "look", index });
  });
  entries(document, "keyframes").forEach((_, index) => items.push({ kind: "keyframe", index }));
  for (const index of [0, 1] as const) items.push({ kind: "end", index });
  entries(document, "gates").forEach((_, index) => items.push({ kind: "gate", index }));
  return items;
}

const keyOfItem = (item: Item): string => `${item.kind}-${item.index}${
  item.kind === "track" || item.kind === "corner" ? `-${item.point}` : ""}`;
const glyphs: Record<Item["kind"], string> = {
  keyframe: "", look: "\u25ce", subject: "\u25b2", obstacle: "\u25a0", track: "\u2022",
  zone: "\u25a1", corner: "\u25c6", gate: "", end: "", region: "\u25a3", closed: "\u2298",
  place: "", extent: "\u25c7", pinned: "\u2691", forbidden: "\u2715",
};

const textOf = (item: Item): string =>
  item.kind === "keyframe" || item.kind === "gate" ? String(item.index + 1)
    : item.kind === "place" ? "SH"[item.index] as string : item.kind === "end" ? "SF"[item.index] as string : glyphs[item.kind];

export class Pins {
  private pins: Pin[] = [];
  private width = 0;
  private height = 0;

  constructor(
    private readonly studio: Studio, private readonly stage: Stage,
    private readonly layer: HTMLElement,
  ) {
    studio.on(["document", "selection", "mode"], () => this.refresh());
    stage.before(() => this.place());
    stage.onResize((width, height) => {
      this.width = width;
      this.height = height;
    });
  }

  private refresh(): void {
    const { document } = this.studio;
    const wanted = this.studio.mode === "camera" ? [] : itemsOf(document, this.studio.selection);
    const next: Pin[] = [];
    for (const item of wanted) {
      const place = placeOfItem(document, item);
      if (!place) continue;
      const had = this.pins.find((pin) => sameItem(pin.item, item));
      const button = had?.button ?? this.made(item);
      const name = nameOf(document, item);
      if (button.title !== name) {
        button.title = name;
        const where = place.map((v) => v.toFixed(1)).join(", ");
        button.setAttribute("aria-label", `${name} at ${where} m`);
      }
      const chosen = sameItem(item, this.studio.selection);
      button.setAttribute("aria-pressed", String(chosen));
      next.push({ item, button, place, where: had?.where ?? "new" });
    }
    for (const pin of this.pins) {
      if (!next.some((other) => other.button === pin.button)) pin.button.remove();
    }
    this.pins = next;
    this.stage.invalidate();
  }

  private made(item: Item): HTMLButtonElement {
    const button = el("button", {
      class: `pin ${item.kind}`, type: "button", "data-pin": keyOfItem(item),
      onclick: () => this.studio.select(item),
      onfocus: () => this.studio.select(item),
    }, textOf(item));
    button.addEventListener("pointerdown", (event) => this.press(event, item, button));
    // The gizmo beneath is not meant.
    button.addEventListener("pointermove", (event) => event.stopPropagation());
    this.layer.append(button);
    return button;
  }

  private place(): void {
    this.stage.worldCamera.updateMatrixWorld();
    for (const pin of this.pins) {
      const at = this.stage.onScreen(pin.place);
      const seen = at !== null && at.x > -20 && at.y > -20 && at.x < this.width + 20 &&
        at.y < this.height + 20;
      const where = seen ? `translate(${at.x.toFixed(1)}px, ${at.y.toFixed(1)}px)` : "";
      if (where === pin.where) continue;
      pin.where = where;
      pin.button.hidden = !seen;
      if (seen) pin.button.style.transform = where;
    }
  }

  private press(event: PointerEvent, item: Item, button: HTMLButtonElement): void {
    if (event.button !== 0) return;
    event.stopPropagation();
    const start = placeOfItem(this.studio.session.settled(), item);
    this.studio.select(item);
    if (!start || !this.studio.editable) return;
    const drag = new PinDrag(this.stage, start, event);
    let dragging = false, last: Vec3 = start;
    const base = this.studio.session.settled();
    const move = (e: PointerEvent): void => {
      if (!dragging && Math.hypot(e.clientX - event.clientX, e.clientY - event.clientY) < THRESHOLD) {
        return;
      }
      dragging = true;
      last = drag.at(e, last);
      this.studio.drag(moved(base, item, last));
    };
    whileHeld(button, event.pointerId, move, (kept) => {
      if (!dragging) return;
      if (kept) this.studio.edit(moved(base, item, last));
      else this.studio.session.rest();
    });
  }
}

// What a pointer means for a point that it took hold of.
class PinDrag {
  private readonly offset = new THREE.Vector3();

  constructor(private readonly stage: Stage, start: Vec3, event: PointerEvent) {
    const hit = this.level(event, start[2]);
    if (hit) this.offset.set(...start).sub(hit);
  }

  private level(event: PointerEvent, height: number): THREE.Vector3 | null {
    return meeting(this.stage.rayAt(event.clientX, event.clientY), level(height));
  }

  at(event: PointerEvent, now: Vec3): Vec3 {
    const ray = this.stage.rayAt(event.clientX, event.clientY);
    const from = new THREE.Vector3(...now);
    if (event.shiftKey) {
      const normal = this.stage.worldCamera.getWorldDirection(new THREE.Vector3()).setZ(0);
      if (normal.lengthSq() < 1e-6) return now;
      const plane = new THREE.Plane().setFromNormalAndCoplanarPoint(normal.normalize(), from);
      const hit = meeting(ray, plane);
      return hit ? [now[0], now[1], hit.z] : now;
    }
    const hit = this.level(event, now[2]);
    return hit ? [hit.x + this.offset.x, hit.y + this.offset.y, now[2]] : now;
  }
}
