// SPDX-License-Identifier: Apache-2.0
// An exploration step by step: the figures of the image at the play head, and the surface that was
// found over the images, beside the oracle's.
import { imagesBy, raysInWords, stepFrom, stepInWords, type Sight } from "../state/exploration";
import { show } from "../state/units";
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
  private asked = "";          // the id of what asked for a run's folder
  private readonly head = svg("line", { class: "head", y1: "0", y2: String(HIGH) });

  constructor(private readonly studio: Studio) {
    byId("step-back").addEventListener("click", () => this.step(-1));
    byId("step-on").addEventListener("click", () => this.step(1));
    for (const [id, layer] of [["explore-candidates", "candidates"], ["explore-rays", "rays"]] as const) {
      const box = byId<HTMLInputElement>(id);
      box.addEventListener("change", () => {
        studio.look[layer] = box.checked;
        studio.tell("look");
      });
    }
    byId("pace-pause").addEventListener("click", () => this.pace(studio.paused ? "run" : "pause"));
    byId("pace-step").addEventListener("click", () => this.pace("step"));
    this.wireRuns();
    studio.on(["sight"], () => this.showSight(studio.sight));
    byId("growth-chart").addEventListener("click", (event) => {
      const { told } = this;
      const rect = byId("growth-chart").getBoundingClientRect();
      if (!told || rect.width <= 0) return;
      const share = (event.clientX - rect.left) / rect.width;
      const at = Math.round(share * told.images.length);
      const time = told.images[Math.min(Math.max(at, 1), told.images.length) - 1]?.time;
      if (time !== undefined) this.seek(time);
    });
    studio.on(["world", "time", "document", "episode"], () => this.show());
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
    return this.studio.episode;
  }

  // Of the planning under way.
  private pace(pace: "run" | "pause" | "step"): void {
    this.studio.session.ask({ type: "pace", pace });
  }

  private wireRuns(): void {
    const { studio } = this;
    const field = byId<HTMLInputElement>("run-folder"), said = byId("run-said");
    const open = (): void => {
      said.textContent = "";
      if (field.value.trim()) {
        this.asked = studio.session.ask({ type: "open_run", id: "", folder: field.value.trim() });
      } else said.textContent = "Type the name of a folder in out/.";
    };
    byId("run-open").addEventListener("click", open);
    field.addEventListener("keydown", (event) => {
      if (event.key === "Enter") open();
    });
    field.addEventListener("focus", () => studio.session.ask({ type: "list_runs", id: "" }));
    byId("run-close").addEventListener("click", () => studio.showRun(null));
    studio.session.on(({ what, message }) => {
      if (what === "note" && message?.type === "failed" && message.id === this.asked) {
        said.textContent = message.why;
      }
      if (what !== "runs" || message?.type !== "runs") return;
      refill(byId("run-folders"), ...message.folders.map((name) => el("option", { value: name })));
    });
    studio.on(["episode"], () => {
      const { run } = studio;
      byId("run-shown").hidden = !run;
      byId("run-name").textContent = run ? `Shown: ${run.folder}` : "";
    });
  }

  // Slices of the map around the view, the finest first.
  private showSight(sight: Sight | null): void {
    byId("sight").hidden = !sight;
    if (!sight) return;
    byId("sight-rays").textContent = `${raysInWords(sight)}.`;
    const strip = (slices: Uint8Array[], what: string): HTMLElement[] => slices.map((slice, level) => {
      const { points } = sight;
      const canvas = el("canvas", { width: points, height: points, role: "img", "aria-label":
        `${what}, level ${level + 1}, ${show(sight.edges[level] as number)} m across` });
      const context = canvas.getContext("2d");
      const image = context?.createImageData(points, points);
      if (context && image) {
        slice.forEach((value, i) => image.data.set([value, value, value, 255], 4 * i));
        context.putImageData(image, 0, 0);
      }
      return el("figure", {}, canvas, el("figcaption", {}, `${show(sight.edges[level] as number)} m`));
    });
    refill(byId("sight-occupancy"), ...strip(sight.occupancy, "Occupancy"));
    refill(byId("sight-certainty"), ...strip(sight.certainty, "Certainty"));
  }

  private show(): void {
    const { told } = this;
    const { live, run, paused } = this.studio;
    byId("exploration").hidden = !told;
    if (!told) return;
    const planned = live !== null && !run;
    byId("pace").hidden = !planned;
    byId("pace-pause").textContent = paused ? "Go on" : "Pause";
    byId("pace-pause").setAttribute("aria-pressed", String(paused));
    const count = imagesBy(told, this.studio.time);
    const asked = planned ? live.asked : told.images.length;
    refill(byId("step-figures"), ...stepInWords(told, count, asked).flatMap(([name, value]) =>
      [el("dt", {}, name), el("dd", {}, value)]));
    if (this.drawn !== told) {
      this.drawn = told;
      byId("explore-end").textContent = planned ? `Utility ${told.utility}. It is being planned.`
        : `Utility ${told.utility}. It ended: ${told.end}.`;
      this.chart(told, asked);
    }
    const x = String((WIDE * count) / Math.max(1, asked));
    this.head.setAttribute("x1", x);
    this.head.setAttribute("x2", x);
  }

  private chart(told: ExplorationWorld, asked: number): void {
    const { kept, run, session } = this.studio;
    // Beside the kept version; a run's folder else beside the mission's own.
    const other = kept?.world?.exploration ?? (run ? session.world.exploration : undefined);
    const found = ({ images }: ExplorationWorld): number[] => images.flatMap(({ observed }) => observed ?? []);
    const before = other && other !== told ? found(other) : [];
    const most = Math.max(1, ...told.oracle, ...before, ...found(told));
    const images = Math.max(1, asked);
    const curve = (values: number[], name: string): SVGElement => svg("polyline", {
      class: name, fill: "none",
      points: [0, ...values].slice(0, images + 1).map((v, i) =>
        `${((WIDE * i) / images).toFixed(1)},${(HIGH - (HIGH - 2) * (v / most)).toFixed(1)}`).join(" "),
    });
    const chart = byId("growth-chart");
    chart.replaceChildren(
      ...(told.oracle.length > 0 ? [curve(told.oracle, "oracle")] : []),
      ...(before.length > 0 ? [curve(before, "kept")] : []),
      curve(found(told), "observed"), this.head);
  }
}
