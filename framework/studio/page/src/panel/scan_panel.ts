// SPDX-License-Identifier: Apache-2.0
// A scan as a list: regions, zones, where flights begin; and what its images will show, in the
// figures of `lapwing run --json`.
import { nameOf, corneredItem, sameItem, type Edit, type Item } from "../state/edits";
import { isObject } from "../state/document";
import { entries } from "../state/film";
import { figureNames, type Figure } from "../state/prediction";
import { pathOf } from "../state/samples";
import { addedPolygon, aroundSite, boxOf, estimateInWords, forbiddenView, isSite, pinnedView, pinOf, placeNames, placeOf,
         siteLists, viewAtTime, viewsOf, type PolygonKind } from "../state/site";
import { fieldsOf } from "../state/schema";
import { show } from "../state/units";
import type { FleetTour, Json, JsonObject, ScanWorld, SurfaceHole, Vec3 } from "../state/types";
import type { Studio } from "../studio";
import { byId, el, refill } from "../view/dom";
import { Form } from "./form";

const whys: Record<SurfaceHole["why"], string> = {
  not_chosen: "not chosen: no time left", zone: "only views that zones forbid",
  no_view: "no free place sees it",
};
const layers = ["views", "candidates", "first"] as const;

export class ScanPanel {
  private shown = "";
  private readonly flights = new Form((field, value) => {
    const { path, label } = field;
    this.studio.edit({ label: `Change ${label.toLowerCase()}`,
                       patch: [value === null ? { path, remove: true } : { path, value }] });
  });
  private tours: FleetTour[] = [];
  private tour = 0;
  // Where to look at, from the list of holes.
  onPlace: (place: Vec3) => void = () => undefined;

  constructor(private readonly studio: Studio, private readonly centre: () => Vec3) {
    for (const kind of Object.keys(siteLists) as PolygonKind[]) {
      byId(`add-${kind}`).addEventListener("click", () => this.add(kind));
      byId(`draw-${kind}`).addEventListener("click", () => this.draw(kind));
    }
    const figure = byId<HTMLSelectElement>("scan-figure");
    figure.append(...(Object.keys(figureNames) as Figure[]).map((name) =>
      el("option", { value: name }, figureNames[name].text)));
    figure.addEventListener("change", () => {
      studio.look.figure = figure.value as Figure;
      studio.tell("look");
    });
    for (const layer of layers) {
      const box = byId<HTMLInputElement>(`scan-${layer}`);
      box.checked = studio.look[layer];
      box.addEventListener("change", () => {
        studio.look[layer] = box.checked;
        studio.tell("look");
      });
    }
    studio.on(["document", "selection", "world", "mode", "look"], () => this.show());
    studio.on(["document", "standing"], () => this.showTours());
    studio.on(["document", "standing", "world", "time"], () => this.showView());
    byId("view-back").addEventListener("click", () => this.step(-1));
    byId("view-on").addEventListener("click", () => this.step(1));
    byId("view-pin").addEventListener("click", () => this.wish(pinnedView));
    byId("view-forbid").addEventListener("click", () => this.wish(forbiddenView));
    byId("flights").append(this.flights.root);
    this.wireBudget();
    studio.on(["document", "standing"], () => this.showFlights());
  }

  private get scan(): ScanWorld | undefined {
    return this.studio.session.world.scan;
  }

  // A square in the middle of the view; a flight zone encloses the site.
  add(kind: PolygonKind): void {
    const { studio } = this;
    const at = kind === "zone" ? aroundSite(this.scan, pathOf(studio.plan.columns)) : this.centre();
    const made = addedPolygon(studio.document, kind, at, this.scan);
    if (studio.edit(made)) studio.select({ kind, index: made.index });
  }

  // From now on a drag on the ground draws a rectangle.
  draw(kind: PolygonKind): void {
    const { studio } = this;
    const again = studio.mode === "outline" && studio.outlined === kind;
    studio.outlined = kind;
    studio.setMode("orbit");
    if (!again) studio.setMode("outline");
  }

  private show(): void {
    const { studio } = this;
    const { document } = studio;
    if (!isSite(document)) return;
    for (const kind of Object.keys(siteLists) as PolygonKind[]) {
      byId(`draw-${kind}`).setAttribute("aria-pressed",
                                        String(studio.mode === "outline" && studio.outlined === kind));
    }
    const text = JSON.stringify([studio.selection, document.regions, document.region,
      document.no_fly_zones, document.flight_zones, document.pinned ?? null,
      document.forbidden ?? null, document.start ?? null, document.home ?? null,
      this.scan?.prediction, this.scan?.areas, studio.look.figure]);
    if (text === this.shown) return;
    this.shown = text;
    refill(byId("site-list"), ...this.rows());
    this.showFigures();
  }

  private rows(): HTMLElement[] {
    const { document } = this.studio;
    const rows: HTMLElement[] = [];
    const list = (kind: PolygonKind, mark: string): void => entries(document, siteLists[kind])
      .forEach((entry, index) => rows.push(this.row({ kind, index }, mark,
        entry.file ? String(entry.file)
          : kind === "region" && typeof entry.weight === "number" ? `weight ${show(entry.weight)}` : "")));
    list("region", "\u25a3");
    if (boxOf(document) && entries(document, "regions").length === 0) {
      rows.push(this.row({ kind: "extent", index: 0 }, "\u25c7", ""),
                this.row({ kind: "extent", index: 1 }, "\u25c7", ""));
    }
    list("closed", "\u2298");
    list("zone", "\u25a1");
    for (const [kind, mark] of [["pinned", "\u2691"], ["forbidden", "\u2715"]] as const) {
      entries(document, kind).forEach((entry, index) => rows.push(this.row({ kind, index }, mark,
        Array.isArray(entry.position) ? entry.position.map((v) => show(Number(v))).join(", ") : "")));
    }
    placeNames.forEach((name, index) => {
      const place = placeOf(document, index);
      if (place) {
        rows.push(this.row({ kind: "place", index }, (name[0] as string).toUpperCase(),
                           place.map((v) => show(v)).join(", ")));
      }
    });
    return rows;
  }

  private row(item: Item, mark: string, more: string): HTMLElement {
    const { studio } = this;
    const name = nameOf(studio.document, item);
    const chosen = sameItem(item, studio.selection) ||
      (studio.selection?.kind === "corner" &&
       sameItem(item, corneredItem(studio.document, studio.selection)));
    return el("li", {}, el("button", {
      type: "button", class: `item ${item.kind}`, "aria-pressed": String(chosen),
      "data-key": `${item.kind}-${item.index}`, "aria-label": `${name} ${more}`,
      onclick: () => studio.select(item),
    }, el("span", { class: "badge" }, mark), el("span", { class: "what" }, name),
    el("span", { class: "when" }, more)));
  }

  private showFigures(): void {
    const prediction = this.scan?.prediction;
    byId("scan-figures").hidden = !this.scan;
    if (!this.scan) return;
    byId("scan-words").textContent = this.scan.prediction_words ?? this.scan.words;
    const name = byId<HTMLSelectElement>("scan-figure").value as Figure;
    const { low, high, unit } = figureNames[name];
    byId("scan-scale").textContent = `${low} to ${high} ${unit}`.trim();
    byId("scan-scale").classList.toggle("more", name === "images" || name === "parallax_deg");
    const holes = isObject(prediction?.holes) ? prediction.holes.largest : undefined;
    refill(byId("hole-list"), ...(Array.isArray(holes) ? holes : []).map((hole: Json) =>
      this.hole(hole as unknown as SurfaceHole)));
  }

  // A drag tells what the tours would come to; let go, they are planned.
  private wireBudget(): void {
    const { studio } = this;
    const slider = byId<HTMLInputElement>("budget"), said = byId("estimate");
    const edit = (): Edit => ({ label: "Change seconds a tour",
                                patch: [{ path: "tour.budget", value: slider.valueAsNumber }] });
    slider.addEventListener("input", () => {
      byId("budget-value").textContent = `${slider.value} s`;
      studio.drag(edit());
    });
    slider.addEventListener("change", () => studio.edit(edit()));
    studio.session.on(({ what, message }) => {
      if (what === "estimate" && message?.type === "estimate") {
        said.textContent = estimateInWords(message);
      }
    });
    studio.on(["standing"], () => {
      if (studio.standing.grade !== "guess") said.textContent = "";
    });
  }

  private showBudget(): void {
    const { document, standing } = this.studio;
    const slider = byId<HTMLInputElement>("budget");
    if (this.studio.session.dragging) return;
    const tour = isObject(document.tour) ? document.tour : {};
    const most = standing.plan?.limits?.flight_time;
    slider.max = String(typeof most === "number" ? Math.round(most) : 1200);
    slider.value = String(typeof tour.budget === "number" ? tour.budget : 300);
    byId("budget-value").textContent = `${slider.value} s`;
  }

  // What is flown with: how long, how often, by how many.
  private showFlights(): void {
    const { session, document } = this.studio;
    if (!isSite(document)) return;
    this.showBudget();
    const asked = ["batteries", "drones", "accuracy"];
    this.flights.show(fieldsOf(session.schema, document).filter(({ path }) => asked.includes(path))
      .sort((a, b) => asked.indexOf(a.path) - asked.indexOf(b.path)));
  }

  // The view at the play head.
  private get views(): ScanWorld["views"] {
    return viewsOf(this.scan, this.studio.which.tour);
  }

  step(by: -1 | 1): boolean {
    const { studio, views } = this;
    if (views.length === 0) return false;
    const at = viewAtTime(views, studio.time) + by;
    studio.play(false);
    studio.seek(views[Math.min(Math.max(at, 0), views.length - 1)]?.time ?? 0);
    return true;
  }

  private wish(edit: (document: JsonObject, view: ScanWorld["views"][number]) => Edit): void {
    const view = this.views[viewAtTime(this.views, this.studio.time)];
    if (view) this.studio.edit(edit(this.studio.document, view));
  }

  private showView(): void {
    const { studio, views } = this;
    if (!isSite(studio.document)) return;
    const at = viewAtTime(views, studio.time), view = views[at];
    byId("view-now").hidden = !view;
    if (!view) return;
    byId("view-words").textContent = `View ${at + 1} of ${views.length}, ${
      view.matching ? "there to match images" : "chosen for what it shows"}: ${
      view.position.map((v) => show(v)).join(", ")} m, heading ${
      show((view.yaw * 180) / Math.PI)}\u00b0, pitch ${show((view.pitch * 180) / Math.PI)}\u00b0`;
    byId("view-pin").textContent = pinOf(studio.document, view) >= 0 ? "Let it go" : "Pin it";
  }

  private showTours(): void {
    const { studio } = this;
    const { tours } = studio.session.standing();
    byId("tours").hidden = tours.length === 0;
    if (tours === this.tours && studio.tour === this.tour) return;
    this.tours = tours;
    this.tour = studio.tour;
    refill(byId("tour-list"), ...tours.map((tour, k) => this.tourRow(tour, k)));
  }

  private tourRow({ name, start, plan }: FleetTour, k: number): HTMLElement {
    const { studio } = this;
    const views = (this.scan?.views ?? []).filter((view) => view.tour === k).length;
    const time = `${show(start / 60)}\u2013${
      show((start + (plan?.duration ?? 0)) / 60)} min`, more = `${views} images`;
    return el("li", {}, el("button", {
      type: "button", class: "item tour", "aria-pressed": String(k === studio.which.tour),
      "data-key": `tour-${k}`, "aria-label": `${name}: ${more}, ${time}`, title: `Show this tour: ${time} after the fleet begins`,
      onclick: () => studio.showTour(k),
    }, el("span", { class: "badge" }, String(k + 1)), el("span", { class: "what" }, name),
    el("span", { class: "when" }, more)));
  }

  private hole({ area, position, why }: SurfaceHole): HTMLElement {
    return el("li", {}, el("button", {
      type: "button", class: "item hole", title: "Look at it",
      "aria-label": `hole of ${show(area)} square metres: ${whys[why]}`,
      onclick: () => this.onPlace(position),
    }, el("span", { class: "badge" }, "\u25cb"), el("span", { class: "what" }, whys[why]),
    el("span", { class: "when" }, `${show(area)} m\u00b2`)));
  }
}
