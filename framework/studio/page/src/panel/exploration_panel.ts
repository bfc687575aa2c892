// SPDX-License-Identifier: Apache-2.0
// An exploration step by step: the figures of the image at the play head, and the surface that was
// found over the images, beside the oracle's.
import { imagesBy, stepFrom, stepInWords } from "../state/exploration";
import type { ExplorationWorld } from "../state/types";
import type { Studio } from "../studio";
import { byId, el, refill } from "../view/dom";

const WIDE = 220, HIGH = 90;   // px
const SVG = "http://www.w3.org/2000/svg";

function svg(name: string, attributes: Record<string, string>): SVGElement {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  return made;
}

export class ExplorationPanel {
  private drawn: unknown = null;
  private readonly head = svg("line", { class: "head", y1: "0", y2: String(HIGH) });

  constructor(private readonly studio: Studio) {
    byId("step-back").addEventListener("click", () => this.step(-1));
    byId("step-on").addEventListener("click", () => this.step(1));
    const box = byId<HTMLInputElement>("explore-candidates");
    box.addEventListener("change", () => {
      studio.look.candidates = box.checked;
      studio.tell("look");
    });
    byId("growth-chart").addEventListener("click", (event) => {
      const { told } = this;
      const rect = byId("growth-chart").getBoundingClientRect();
      if (!told || rect.width <= 0) return;
      const share = (event.clientX - rect.left) / rect.width;
      const at = Math.round(share * told.images.length);
      const time = told.images[Math.min(Math.max(at, 1), told.images.length) - 1]?.time;
      if (time !== undefined) this.seek(time);
    });
    studio.on(["world", "time", "document"], () => this.show());
    studio.on(["kept"], () => {
      this.drawn = null;
      this.show();
    });
  }

  step(by: -1 | 1): boolean {
    const { told } = this;
    if (!told || told.images.length === 0) return false;
    this.seek(stepFrom(told, this.studio.time, by));
    return true;
  }

  private seek(time: number): void {
    this.studio.play(false);
    this.studio.seek(time);
  }

  private get told(): ExplorationWorld | undefined {
    return this.studio.session.world.exploration;
  }

  private show(): void {
    const { told } = this;
    byId("exploration").hidden = !told;
    if (!told) return;
    const count = imagesBy(told, this.studio.time);
    refill(byId("step-figures"), ...stepInWords(told, count).flatMap(([name, value]) =>
      [el("dt", {}, name), el("dd", {}, value)]));
    if (this.drawn !== told) {
      this.drawn = told;
      byId("explore-end").textContent = `Utility ${told.utility}. It ended: ${told.end}.`;
      this.chart(told);
    }
    const x = String((WIDE * count) / Math.max(1, told.images.length));
    this.head.setAttribute("x1", x);
    this.head.setAttribute("x2", x);
  }

  private chart(told: ExplorationWorld): void {
    const other = this.studio.kept?.world?.exploration;
    const kept = other && other !== told ? other.images.map((i) => i.observed) : [];
    const most = Math.max(1, ...told.oracle, ...kept, ...told.images.map((i) => i.observed));
    const images = Math.max(1, told.images.length);
    const curve = (values: number[], name: string): SVGElement => svg("polyline", {
      class: name, fill: "none",
      points: [0, ...values].slice(0, images + 1).map((v, i) =>
        `${((WIDE * i) / images).toFixed(1)},${(HIGH - (HIGH - 2) * (v / most)).toFixed(1)}`).join(" "),
    });
    const chart = byId("growth-chart");
    chart.replaceChildren(
      ...(told.oracle.length > 0 ? [curve(told.oracle, "oracle")] : []),
      ...(kept.length > 0 ? [curve(kept, "kept")] : []),
      curve(told.images.map((i) => i.observed), "observed"), this.head);
  }
}
