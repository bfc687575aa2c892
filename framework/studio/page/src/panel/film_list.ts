// SPDX-License-Identifier: Apache-2.0
// The film as a list: keyframes, subjects, obstacles; a click selects, the buttons add.
import { obstacleKinds, addedObstacle, corneredItem, addedSubject, inserted, nameOf, sameItem, type Item } from "../state/edits";
import { addedGate } from "../state/course";
import { entries, targetAt } from "../state/film";
import { shots, withShot, type Shot } from "../state/shots";
import { positionAt } from "../state/samples";
import { show } from "../state/units";
import type { Vec3 } from "../state/types";
import type { Studio } from "../studio";
import { byId, el, refill } from "../view/dom";

export class FilmList {
  constructor(private readonly studio: Studio, private readonly centre: () => Vec3) {
    studio.on(["document", "standing", "selection", "mode"], () => this.show());
    const kind = byId<HTMLSelectElement>("add-obstacle");
    kind.append(...obstacleKinds.map((one) => el("option", { value: one.type }, one.text)),
                el("option", { value: "flight_zone" }, "Flight zone (stay inside)"));
    kind.addEventListener("change", () => {
      const { value } = kind;
      kind.value = "";
      if (value) this.addObstacle(value);
    });
    const choice = byId<HTMLSelectElement>("shot");
    choice.append(...shots.map((shot) =>
      el("option", { value: shot.name }, `${shot.name}: ${shot.text}`)));
    choice.addEventListener("change", () => {
      const shot = shots.find((one) => one.name === choice.value);
      choice.value = "";
      if (shot) this.addShot(shot);
    });
  }

  private shown = "";

  private show(): void {
    const { studio } = this;
    const { document, film } = studio;
    for (const mode of ["place", "draw"]) {
      byId(mode).setAttribute("aria-pressed", String(studio.mode === mode));
    }
    byId("place-gate").setAttribute("aria-pressed", String(studio.mode === "place"));
    // Rows that say the same stay: one that is made again under the pointer loses the click.
    const text = JSON.stringify([
      film.keyframes.map((k) => [k.position, studio.timeOf(k.index)]), studio.selection,
      entries(document, "subjects").map((s) => s.name),
      entries(document, "obstacles").map((o) => [o.name, o.type]),
      entries(document, "flight_zones").map((o) => o.name), studio.course]);
    if (text === this.shown) return;
    this.shown = text;
    const rows = film.keyframes.map((keyframe, index) => this.row(
      { kind: "keyframe", index }, `${index + 1}`,
      keyframe.position.map((v) => show(v)).join(", "), `${show(studio.timeOf(index), 4)} s`));
    refill(byId("keyframe-list"), ...rows);
    this.showCourse();
    const others: HTMLElement[] = [];
    entries(document, "subjects").forEach((entry, index) => {
      others.push(this.row({ kind: "subject", index }, "\u25b2",
        String(entry.name || (index === 0 ? "Subject" : `Subject ${index + 1}`)), ""));
    });
    entries(document, "obstacles").forEach((entry, index) => {
      others.push(this.row({ kind: "obstacle", index }, "\u25a0",
        String(entry.name || `Obstacle ${index + 1}`), String(entry.type ?? "")));
    });
    entries(document, "flight_zones").forEach((entry, index) => {
      others.push(this.row({ kind: "zone", index }, "\u25a1",
        String(entry.name || `Flight zone ${index + 1}`), "stay inside"));
    });
    refill(byId("thing-list"), ...others);
  }

  private showCourse(): void {
    const { course, document } = this.studio;
    if (!course) return;
    const where = (place: Vec3): string => place.map((v) => show(v)).join(", ");
    const rows = course.gates.map(({ position, shape }, index) => this.row(
      { kind: "gate", index }, `${index + 1}`,
      String(entries(document, "gates")[index]?.name || where(position)), shape));
    if (course.start) rows.unshift(this.row({ kind: "end", index: 0 }, "S", where(course.start), "start"));
    if (course.finish) rows.push(this.row({ kind: "end", index: 1 }, "F", where(course.finish), "finish"));
    refill(byId("gate-list"), ...rows);
  }

  // After the selected gate, else after the last one.
  addGate(at = this.centre()): void {
    const { selection, document, course } = this.studio;
    if (!course) return;
    const after = selection?.kind === "gate" ? selection.index : course.gates.length - 1;
    const made = addedGate(document, after, at);
    if (this.studio.edit(made)) this.studio.select({ kind: "gate", index: made.index });
  }

  private row(item: Item, mark: string, text: string, more: string): HTMLElement {
    const { studio } = this;
    const chosen = sameItem(item, studio.selection) ||
      (studio.selection?.kind === "corner" && sameItem(item, corneredItem(studio.document,
                                                                          studio.selection)));
    return el("li", {}, el("button", {
      type: "button", class: `item ${item.kind}`, "aria-pressed": String(chosen),
      "data-key": `${item.kind}-${item.index}`,
      "aria-label": `${nameOf(studio.document, item)} ${more}`,
      onclick: () => {
        studio.select(item);
        if (item.kind === "keyframe") studio.seek(studio.timeOf(item.index));
      },
    }, el("span", { class: "badge" }, mark), el("span", { class: "what" }, text),
    el("span", { class: "when" }, more)));
  }

  insertAtHead(): void {
    const { studio } = this;
    const at = positionAt(studio.plan.columns, studio.time);
    if (!at) return;
    const made = inserted(studio.document, studio.time, at);
    if (studio.edit(made)) studio.select({ kind: "keyframe", index: made.index });
  }

  // Around what is filmed, else around the middle of the view.
  private addShot(shot: Shot): void {
    const { studio } = this;
    const about = targetAt(studio.film, studio.film.duration) ?? this.centre();
    const made = withShot(studio.document, shot, about);
    if (studio.edit(made)) studio.select({ kind: "keyframe", index: made.index });
  }

  addObstacle(type = "box"): void {
    const zone = type === "flight_zone";
    const index = entries(this.studio.document, zone ? "flight_zones" : "obstacles").length;
    if (this.studio.edit(addedObstacle(this.studio.document, type, this.centre()))) {
      this.studio.select({ kind: zone ? "zone" : "obstacle", index });
    }
  }

  addSubject(): void {
    const count = entries(this.studio.document, "subjects").length;
    if (this.studio.edit(addedSubject(this.studio.document, this.centre()))) {
      this.studio.select({ kind: "subject", index: count });
    }
  }
}
