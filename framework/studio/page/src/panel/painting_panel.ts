// SPDX-License-Identifier: Apache-2.0
// A light painting as a list of strokes that were drawn by hand, and the text in their place.
import { addedStroke, drawingErrorInWords, drawnStrokes, earlierStroke, inWorld, isPainting, lightsAndGaps,
         planeOf, reversedStroke, withoutStroke } from "../state/painting";
import { fieldsOf } from "../state/schema";
import { show } from "../state/units";
import type { Edit } from "../state/edits";
import type { Studio } from "../studio";
import { byId, el, refill } from "../view/dom";
import { Form } from "./form";

const ASKED = ["reorder", "gap", "facing"];
const STROKE = 1;   // m, of a stroke that is added by keyboard

export class PaintingPanel {
  private shown = "";
  private readonly options = new Form(({ path, label }, value) => {
    this.studio.edit({ label: `Change ${label.toLowerCase()}`,
                       patch: [value === null ? { path, remove: true } : { path, value }] });
  });

  constructor(private readonly studio: Studio) {
    byId("draw-stroke").addEventListener("click", () => this.draw());
    byId("add-stroke").addEventListener("click", () => this.add());
    const text = byId<HTMLInputElement>("painting-text");
    text.addEventListener("change", () => this.write(text.value));
    byId("painting-options").append(this.options.root);
    studio.on(["document", "mode"], () => this.show());
    studio.on(["document", "standing"], () => this.showFlight());
  }

  // From now on drags on the plane of the drawing are strokes.
  draw(): void {
    const { studio } = this;
    studio.play(false);
    studio.setMode(studio.mode === "stroke" ? "orbit" : "stroke");
  }

  // An upright stroke to the right of all others.
  add(): void {
    const { studio } = this;
    const plane = planeOf(studio.document);
    if (!plane) return;
    const right = Math.max(-STROKE / 2, ...drawnStrokes(studio.document).flat().map(([x]) => x));
    const made = addedStroke(studio.document, [inWorld(plane, [right + STROKE / 2, 0]),
                                               inWorld(plane, [right + STROKE / 2, STROKE])]);
    if (made) studio.edit(made);
  }

  private write(text: string): void {
    const { studio } = this;
    if (!text) return;
    const patch: Edit["patch"] = [{ path: "text", value: text }];
    if (drawnStrokes(studio.document).length > 0) patch.push({ path: "strokes", value: [] });
    for (const other of ["svg", "input"]) {
      if (typeof studio.document[other] === "string" && studio.document[other] !== "") {
        patch.push({ path: other, value: "" });
      }
    }
    studio.edit({ label: "Change the text", patch });
  }

  // Order and gaps as planned, and how far the light is from what was asked for.
  private showFlight(): void {
    const { studio } = this;
    if (!isPainting(studio.document)) return;
    this.options.show(fieldsOf(studio.session.schema, studio.document)
      .filter(({ path }) => ASKED.includes(path))
      .sort((a, b) => ASKED.indexOf(a.path) - ASKED.indexOf(b.path)));
    const { plan, certificate } = studio.standing;
    byId("drawing-error").textContent = drawingErrorInWords(certificate);
    refill(byId("light-list"), ...lightsAndGaps(plan).map(({ start, finish, lit }, k) =>
      el("li", {}, el("button", {
        type: "button", class: "item", "data-key": `light-${k}`, title: "To its beginning",
        onclick: () => {
          studio.play(false);
          studio.seek(start);
        },
      }, el("span", { class: "badge" }, lit ? "\u25cf" : "\u25cb"),
      el("span", { class: "what" }, lit ? "light" : "dark"),
      el("span", { class: "when" }, `${show(Math.round(100 * (finish - start)) / 100)} s`)))));
  }

  private show(): void {
    const { studio } = this;
    const { document } = studio;
    if (!isPainting(document)) return;
    byId("draw-stroke").setAttribute("aria-pressed", String(studio.mode === "stroke"));
    const text = JSON.stringify([document.strokes, document.text, document.height]);
    if (text === this.shown) return;
    this.shown = text;
    const field = byId<HTMLInputElement>("painting-text");
    field.value = typeof document.text === "string" ? document.text : "";
    refill(byId("stroke-list"), ...drawnStrokes(document).map((points, index) => {
      const length = points.reduce((sum, p, i) => {
        const before = points[i - 1];
        return sum + (before ? Math.hypot(p[0] - before[0], p[1] - before[1]) : 0);
      }, 0);
      const button = (mark: string, label: string, make: () => Edit | null): HTMLElement =>
        el("button", { type: "button", title: label, "aria-label": `${label}: stroke ${index + 1}`,
                       onclick: () => {
                         const made = make();
                         if (made) studio.edit(made);
                         else studio.session.note("A drawing needs a stroke, or a text in its place.");
                       } }, mark);
      return el("li", { class: "stroke", "data-key": `stroke-${index}` },
                el("span", { class: "what" }, `Stroke ${index + 1}`),
                el("span", { class: "when" }, `${show(Math.round(length * 100) / 100)} m`),
                button("\u2191", "Earlier", () => earlierStroke(document, index)),
                button("\u21c4", "Turn round", () => reversedStroke(document, index)),
                button("\u2715", "Delete", () => withoutStroke(document, index)));
    }));
  }
}
