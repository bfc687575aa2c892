// SPDX-License-Identifier: Apache-2.0
// What is selected, as numbers to type.
import { addedCorner, corneredItem, entryOf, nameOf, pathOfItem, retimed, timeRange, without, deleted, duplicated, reordered,
         moved, placeOfItem, slowed, type Item } from "../state/edits";
import { entries } from "../state/film";
import { copiedGate, reorderedGate, reshapedGate, turnedGate } from "../state/course";
import { siteLists, type PolygonKind } from "../state/site";
import { labelOf, type Field } from "../state/schema";
import { isObject } from "../state/document";
import { vec } from "../state/vector";
import type { Json, JsonObject, Option, Vec3 } from "../state/types";
import type { Studio } from "../studio";
import { byId, el } from "../view/dom";
import { Form } from "./form";
import { gateFields } from "./gate_fields";

const axes = ["East", "North", "Up"];
const metres = (name: string): Option =>
  ({ name, type: "number", unit: "m", required: true, minimum: -1e6, maximum: 1e6 });

function placeFields(path: string, value: Vec3, prefix = ""): Field[] {
  return axes.map((label, i) => ({
    path: `${path}#${i}`, label: `${prefix ? `${prefix} ${label.toLowerCase()}` : label}, m`,
    option: { ...metres(label), summary: "position in the world" }, value: value[i] as number,
    stated: true,
  }));
}

const AS_BEFORE = "as before";
const A_POINT = "a point";

export class Selected {
  private readonly title = byId("selected-title");
  private readonly form: Form;
  private readonly buttons = byId("selected-buttons");

  constructor(private readonly studio: Studio) {
    this.form = new Form((field, value) => this.commit(field, value), true);
    byId("selected-form").append(this.form.root);
    studio.on(["document", "standing", "selection"], () => this.show());
    studio.on(["selection"], () => this.showButtons());
    this.show();
    this.showButtons();
  }

  focus(): void {
    this.form.focus();
  }

  private show(): void {
    const { selection, document } = this.studio;
    const box = byId("selected");
    const entry = selection && entryOf(document, selection);
    box.hidden = !entry;
    if (!selection || !entry) {
      this.form.show([]);
      return;
    }
    const name = nameOf(document, selection);
    this.title.textContent = name.charAt(0).toUpperCase() + name.slice(1);
    this.form.show(this.fields(selection, entry));
  }

  private fields(item: Item, entry: JsonObject): Field[] {
    const { document, session } = this.studio;
    if (item.kind === "obstacle") return obstacleFields(`obstacles[${item.index + 1}]`, entry);
    if (item.kind === "zone" || item.kind === "closed" || item.kind === "region") {
      return this.polygonFields(item.kind, item.index);
    }
    if (item.kind === "corner") {
      const corner = placeOfItem(document, item);
      return corner ? placeFields("corner", corner).slice(0, 2) : [];
    }
    const path = pathOfItem(document, item) ?? `subjects[${item.index + 1}]`;
    const place = placeOfItem(document, item);
    const fields = place ? placeFields(path, place) : [];
    if (item.kind === "pinned" || item.kind === "forbidden") {
      const declared = session.schema.find((o) => o.name === item.kind)?.table ?? [];
      return [...fields, ...declared.filter((option) => option.type === "number").map((option): Field =>
        ({ path: `${item.kind}[${item.index + 1}].${option.name}`, label: labelOf(option.name), option,
           value: entry[option.name] ?? option.default, stated: entry[option.name] !== undefined }))];
    }
    if (item.kind === "gate") {
      const declared = session.schema.find((o) => o.name === "gates")?.table ?? [];
      return [...fields, ...gateFields(item.index, entry, declared)];
    }
    if (item.kind === "keyframe") {
      const keyframe = this.studio.film.keyframes[item.index];
      const base = `keyframes[${item.index + 1}]`;
      fields.push({
        path: `${base}.time`, label: "Time", value: keyframe ? this.studio.timeOf(item.index) : 0, stated: true,
        option: { name: "time", type: "number", unit: "s", minimum: 0, required: true,
                  summary: "when the camera passes here" },
      });
      fields.push(this.lookField(base, entry));
      const declared = session.schema.find((o) => o.name === "keyframes")?.table ?? [];
      for (const name of ["speed", "yaw_deg", "earliest", "latest", "time_weight"]) {
        const option = declared.find((o) => o.name === name);
        // Only what the keyframe states or what its timing uses.
        const used = entry[name] !== undefined ||
          (document.timing === "free" && ["earliest", "latest", "time_weight"].includes(name));
        if (option && used) {
          fields.push({ path: `${base}.${name}`, label: labelOf(name), option, value: entry[name],
                        stated: entry[name] !== undefined });
        }
      }
    }
    if (item.kind === "subject") {
      const declared = session.schema.find((o) => o.name === "subjects")?.table ?? [];
      for (const option of declared) {
        if (!["name", "height", "width", "distance", "place", "size"].includes(option.name)) continue;
        fields.push({
          path: `subjects[${item.index + 1}].${option.name}`, label: labelOf(option.name), option,
          value: entry[option.name] ?? option.default, stated: entry[option.name] !== undefined,
        });
      }
    }
    return fields;
  }

  // What a polygon states, and both ends of its heights; of a region its weight.
  private polygonFields(kind: PolygonKind, index: number): Field[] {
    const list = siteLists[kind];
    const entry = entries(this.studio.document, list)[index];
    const declared = this.studio.session.schema.find((o) => o.name === list)?.table ?? [];
    if (!entry) return [];
    return declared.flatMap((option): Field[] => {
      // Files are the script's; a page names none.
      const asked = option.type === "number" || option.name === "name" ||
        (option.type === "text" && Boolean(entry[option.name]));
      if (!asked) return [];
      return [{ path: `${list}[${index + 1}].${option.name}`, label: labelOf(option.name), option,
                value: entry[option.name] ?? option.default,
                stated: entry[option.name] !== undefined }];
    });
  }

  private lookField(base: string, entry: JsonObject): Field {
    const names = this.studio.film.subjects.map((s) => s.name);
    const single = names.length === 1 && !entries(this.studio.document, "subjects")[0]?.name;
    const choices = [AS_BEFORE, A_POINT, ...(single ? [] : names)];
    const value = vec(entry.look_at) ? A_POINT
      : typeof entry.subject === "string" ? entry.subject : AS_BEFORE;
    return { path: `${base}#look`, label: "Looks at", value, stated: true,
             option: { name: "look", type: "choice", choices,
                       summary: "what the camera looks at from here on" } };
  }

  private commit(field: Field, value: Json): void {
    const { studio } = this;
    const item = studio.selection;
    if (!item) return;
    const [path, part] = field.path.split("#") as [string, string | undefined];
    if (part === "look") return this.look(item.index, String(value));
    if (part === "shape") {
      studio.edit(reshapedGate(studio.document, item.index, String(value)));
      return;
    }
    if (part !== undefined) {
      const place = placeOfItem(studio.document, item);
      if (place && /^[012]$/.test(part)) {
        const to = place.slice() as Vec3;
        to[Number(part)] = Number(value);
        studio.edit(item.kind === "obstacle" ? this.point(path, Number(part), Number(value))
          : moved(studio.document, item, to));
      }
      return;
    }
    if (item.kind === "keyframe" && path.endsWith(".time")) {
      this.retime(item.index, Number(value));
      return;
    }
    const name = nameOf(studio.document, item);
    const label = `${field.label} of ${name}`;
    if (value === null && item.kind === "keyframe") {
      studio.edit(without(studio.document, label, item.index, path.slice(path.lastIndexOf(".") + 1)));
    } else {
      studio.edit({ label, patch: [value === null ? { path, remove: true } : { path, value }] });
    }
  }

  // A typed time that has no place between its neighbours is refused, not changed.
  private retime(index: number, time: number): void {
    const { studio } = this;
    const [earliest, latest] = timeRange(studio.document, index);
    if (time >= earliest && time <= latest) {
      studio.edit(retimed(studio.document, index, time));
      return;
    }
    const range = Number.isFinite(latest) ? `between ${earliest} s and ${latest} s`
      : `${earliest} s or later`;
    studio.session.note(`Keyframe ${index + 1} must be ${range}: beside its neighbours.`);
    studio.tell("selection");
  }

  private point(path: string, axis: number, value: number): { label: string;
    patch: { path: string; value: Json }[] } {
    const found = path.match(/\.([a-z]+)$/)?.[1] ?? "";
    const entry = this.studio.selection && entryOf(this.studio.document, this.studio.selection);
    const point = (vec(entry?.[found]) ?? [0, 0, 0]).slice() as Vec3;
    point[axis] = value;
    return { label: `Change ${found} of an obstacle`, patch: [{ path, value: point }] };
  }

  private look(index: number, value: string): void {
    const { studio } = this;
    if (value === A_POINT) {
      studio.setMode("aim");
      this.show();
      return;
    }
    const list = entries(studio.document, "keyframes").map((entry, i) => {
      if (i !== index) return entry;
      const { look_at: _l, subject: _s, ...rest } = entry;
      return value === AS_BEFORE ? rest : { ...rest, subject: value };
    });
    studio.edit({ label: `Aim keyframe ${index + 1}`, patch: [{ path: "keyframes", value: list }] });
  }

  private showButtons(): void {
    const { studio } = this;
    const item = studio.selection;
    if (!item) return this.buttons.replaceChildren();
    const button = (text: string, title: string, then: () => void,
                    name?: string): HTMLButtonElement =>
      el("button", { type: "button", title, onclick: then, "aria-label": name }, text);
    const list: HTMLButtonElement[] = [];
    if (item.kind === "keyframe") {
      list.push(button("Copy", "Duplicate this keyframe (D)", () => duplicate(studio)));
      list.push(button("\u2191", "Swap with the keyframe before (Alt + up)", () => order(studio, -1),
                       "Swap with the one before"));
      list.push(button("\u2193", "Swap with the keyframe after (Alt + down)", () => order(studio, 1),
                       "Swap with the one after"));
      list.push(button("\u00ab", "Slower: more time for the leg to this keyframe (Alt + page down)",
                       () => pace(studio, "slower"), "Slower to this keyframe"));
      list.push(button("\u00bb", "Faster: less time for the leg to this keyframe (Alt + page up)",
                       () => pace(studio, "faster"), "Faster to this keyframe"));
      list.push(button("Aim", "Click a place for the camera to look at (L)",
                       () => studio.setMode("aim")));
    }
    if (item.kind === "gate") {
      list.push(button("Copy", "A gate like this one after it (D)", () => duplicate(studio)));
      list.push(button("\u2191", "Fly it before the gate before (Alt + up)", () => order(studio, -1),
                       "Swap with the one before"));
      list.push(button("\u2193", "Fly it after the gate after (Alt + down)", () => order(studio, 1),
                       "Swap with the one after"));
      list.push(button("\u27f2", "Turn it to the left (Alt + left)", () => turn(studio, TURN),
                       "Turn to the left"));
      list.push(button("\u27f3", "Turn it to the right (Alt + right)", () => turn(studio, -TURN),
                       "Turn to the right"));
    }
    const cornered = corneredItem(studio.document, item);
    if (cornered) {
      list.push(button("Add corner", "A corner in the middle of the next side (D)",
                       () => addCorner(studio)));
    }
    if (item.kind === "subject") {
      list.push(button("Walk", "Walk its way with the mouse or the arrows, in real time (J)",
                       () => studio.setMode("walk")));
    }
    if (item.kind !== "track" && item.kind !== "end") {
      list.push(button("Delete", "Delete (Del)", () => remove(studio)));
    }
    this.buttons.replaceChildren(...list);
  }
}

export function addCorner(studio: Studio): void {
  const item = studio.selection;
  const made = item && addedCorner(studio.document, item);
  const owner = corneredItem(studio.document, item);
  if (!made || !owner || !studio.edit(made)) return;
  studio.select({ kind: "corner", of: owner.kind as "obstacle" | "zone", index: owner.index,
                  point: made.point });
}

const PACE = 1.05;      // a press

// The leg to the selected keyframe; of the first, the one that follows.
export function pace(studio: Studio, how: "faster" | "slower"): boolean {
  const item = studio.selection;
  if (item?.kind !== "keyframe") return false;
  studio.edit(slowed(studio.document, Math.max(1, item.index),
                     how === "slower" ? PACE : 1 / PACE));
  return true;
}

export const TURN = 5;         // degrees, a press

// The selected gate, counter-clockwise.
export function turn(studio: Studio, by: number): boolean {
  const item = studio.selection;
  if (item?.kind !== "gate") return false;
  return studio.edit(turnedGate(studio.document, item.index, by)) !== null;
}

export function duplicate(studio: Studio): void {
  if (studio.selection?.kind === "gate") {
    const copy = copiedGate(studio.document, studio.selection.index);
    if (copy && studio.edit(copy)) studio.select({ kind: "gate", index: copy.index });
    return;
  }
  if (corneredItem(studio.document, studio.selection)) return addCorner(studio);
  if (studio.selection?.kind !== "keyframe") return;
  const made = duplicated(studio.document, studio.selection.index);
  if (made && studio.edit(made)) studio.select({ kind: "keyframe", index: made.index });
}

export function order(studio: Studio, by: -1 | 1): void {
  const item = studio.selection;
  if (item?.kind !== "keyframe" && item?.kind !== "gate") return;
  const edit = (item.kind === "gate" ? reorderedGate : reordered)(studio.document, item.index, by);
  if (edit && studio.edit(edit)) studio.select({ kind: item.kind, index: item.index + by });
}

// Says why not, where something cannot go.
export function remove(studio: Studio): string | null {
  const item = studio.selection;
  if (!item) return null;
  const edit = deleted(studio.document, item);
  if (!edit) {
    return item.kind === "corner" ? "A zone needs at least three corners."
      : item.kind === "track" ? "Walk the way of the subject anew to change its places."
        : item.kind === "gate" ? "A course needs at least one gate."
          : item.kind === "place" || item.kind === "extent"
            ? "The scan begins here, or is as large; move it."
          : item.kind === "end" ? "A course that begins or ends here keeps the place; move it."
            : "A film needs at least two keyframes.";
  }
  studio.edit(edit);
  return null;
}

function obstacleFields(base: string, entry: JsonObject): Field[] {
  const fields: Field[] = [];
  for (const [name, value] of Object.entries(entry)) {
    const place = vec(value);
    if (name === "type" || name === "track" || name === "sha256" || isObject(value)) continue;
    if (place) fields.push(...placeFields(`${base}.${name}`, place, labelOf(name)));
    else if (typeof value === "number") {
      const positive = name === "radius" || name === "height";
      fields.push({ path: `${base}.${name}`, label: labelOf(name), value, stated: true,
                    option: { name, type: "number", unit: "m", required: true,
                              ...(positive ? { above: 0 } : {}) } });
    } else if (typeof value === "boolean") {
      fields.push({ path: `${base}.${name}`, label: labelOf(name), value, stated: true,
                    option: { name, type: "boolean", summary: "hides subjects behind it" } });
    } else if (name === "side") {
      fields.push({ path: `${base}.${name}`, label: "Fly", value, stated: true,
                    option: { name, type: "choice", choices: ["keep_out", "keep_inside"] } });
    } else if (typeof value === "string") {
      fields.push({ path: `${base}.${name}`, label: labelOf(name), value, stated: true,
                    option: { name, type: "text" } });
    }
  }
  return fields;
}
