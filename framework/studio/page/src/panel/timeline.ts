// SPDX-License-Identifier: Apache-2.0
// The time line: ruler, play head, keyframes and cuts by their times, and below them speed,
// acceleration, thrust with their limits.
import { retimed, slowed, uncut } from "../state/edits";
import { legAt } from "../state/failures";
import { lanesOf, massOf, valueAtTime, type Lane } from "../state/samples";
import { clock, show } from "../state/units";
import type { Plan } from "../state/types";
import type { Studio } from "../studio";
import { clamp } from "../state/vector";
import { byId, colour, el, sized, whileHeld } from "../view/dom";

const LEFT = 92;          // px, names of the lanes
const RIGHT = 14;
const THRESHOLD = 3;
const NEAR = 6;           // px from a curve

export class Timeline {
  private readonly ruler = byId<HTMLCanvasElement>("ruler");
  private readonly head = byId("play-head");
  private readonly marks = byId("time-marks");
  private readonly lanes = byId<HTMLCanvasElement>("lanes");
  private limits: Plan["limits"];
  private mass: number | null = null;
  private waiting = false;
  private shownCuts = "";
  private scale = 10;      // s in the width
  // The lane of speed as it was drawn last.
  private speed: { times: number[]; values: number[]; y(value: number): number;
                   valueAt(y: number): number } | null = null;

  constructor(private readonly studio: Studio) {
    studio.on(["document", "standing"], () => this.refresh());
    studio.on(["selection"], () => this.refreshMarks());
    studio.on(["time", "playing", "look", "flown"], () => this.later());
    new ResizeObserver(() => this.refresh()).observe(this.lanes);
    this.ruler.addEventListener("pointerdown", (event) => this.scrub(event, this.ruler));
    this.lanes.addEventListener("pointerdown", (event) => {
      if (this.onCurve(event)) this.bend(event);
      else this.scrub(event, this.lanes);
    });
    this.lanes.addEventListener("pointermove", (event) => {
      if (event.buttons === 0) this.lanes.style.cursor = this.onCurve(event) ? "ns-resize" : "";
    });
    this.head.addEventListener("pointerdown", (event) => this.scrub(event, this.head));
    this.head.addEventListener("keydown", (event) => {
      const by = { ArrowLeft: -0.1, ArrowRight: 0.1, PageDown: -1, PageUp: 1 }[event.key];
      if (by === undefined || event.altKey) return;
      event.preventDefault();
      event.stopPropagation();
      studio.seek(studio.time + by);
    });
  }

  private get width(): number {
    return Math.max(50, this.lanes.clientWidth - LEFT - RIGHT);
  }

  private x(time: number): number {
    return LEFT + (time / this.scale) * this.width;
  }

  private timeAt(clientX: number): number {
    const rect = this.lanes.getBoundingClientRect();
    return ((clientX - rect.left - LEFT) / this.width) * this.scale;
  }

  private scrub(event: PointerEvent, on: HTMLElement): void {
    if (event.button !== 0) return;
    this.studio.play(false);
    this.studio.seek(this.timeAt(event.clientX));
    on.setPointerCapture(event.pointerId);
    const move = (e: PointerEvent): void => this.studio.seek(this.timeAt(e.clientX));
    const up = (): void => {
      on.removeEventListener("pointermove", move);
      on.removeEventListener("pointerup", up);
      on.removeEventListener("pointercancel", up);
    };
    on.addEventListener("pointermove", move);
    on.addEventListener("pointerup", up);
    on.addEventListener("pointercancel", up);
  }

  // Where the curve of speed is at a time, on the page.
  curvePlace(time: number): { x: number; y: number } | null {
    const { speed } = this;
    const value = speed && valueAtTime({ time: speed.times, v: speed.values }, "v", time);
    if (!speed || value === null || !Number.isFinite(value)) return null;
    const { left, top } = this.lanes.getBoundingClientRect();
    return { x: left + this.x(time), y: top + speed.y(value) };
  }

  // Whether the curve of speed is there.
  private onCurve(event: MouseEvent): boolean {
    const { speed } = this;
    if (!speed || !this.studio.editable) return false;
    const place = this.curvePlace(this.timeAt(event.clientX));
    return place !== null && Math.abs(place.y - event.clientY) < NEAR;
  }

  // Up is faster, down is slower: the leg there takes as much less or more time. Sideways it scrubs.
  private bend(event: PointerEvent): void {
    const { studio, speed } = this;
    const time = this.timeAt(event.clientX);
    const leg = legAt(studio.film.keyframes, time, 0);
    if (!speed || leg === null) return this.scrub(event, this.lanes);
    const was = valueAtTime({ time: speed.times, v: speed.values }, "v", time) ?? 0;
    const base = studio.session.settled();
    const top = this.lanes.getBoundingClientRect().top;
    let bends: boolean | null = null, factor = 1;
    studio.play(false);
    studio.seek(time);
    whileHeld(this.lanes, event.pointerId, (e) => {
      const dx = Math.abs(e.clientX - event.clientX), dy = Math.abs(e.clientY - event.clientY);
      if (bends === null && Math.max(dx, dy) >= THRESHOLD) bends = dy > dx;
      if (bends === false) studio.seek(this.timeAt(e.clientX));
      if (!bends) return;
      const wanted = Math.max(speed.valueAt(e.clientY - top), 1e-3);
      factor = clamp(Math.max(was, 0.05) / wanted, 0.25, 4);
      studio.drag(slowed(base, leg, factor));
    }, (kept) => {
      if (!bends) return;
      if (kept) studio.edit(slowed(base, leg, factor));
      else studio.session.rest();
    });
  }

  private refresh(): void {
    const { plan } = this.studio.standing;
    const known = plan ?? this.studio.session.grades.lastPlan();
    if (known?.limits) this.limits = { ...known.limits };
    if (known) this.mass = massOf(known) ?? this.mass;
    // A limit that the certificate does not ask for is none.
    for (const check of this.studio.standing.certificate?.checks ?? []) {
      if (check.skipped && this.limits) delete this.limits[check.name];
    }
    const margin = this.studio.document.margin;
    if (typeof margin === "number") this.limits = { ...this.limits, margin };
    // While a time is dragged the scale stays, or the mark would run from the hand.
    if (!this.studio.session.dragging) this.scale = Math.max(1, this.studio.duration);
    this.refreshMarks();
    this.later();
  }

  private later(): void {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.draw();
    });
  }

  // ---- keyframes and cuts ----------------------------------------------------------------------

  private refreshMarks(): void {
    const { film, selection } = this.studio;
    const wanted = film.keyframes.length;
    const buttons = [...this.marks.querySelectorAll<HTMLButtonElement>(".mark-keyframe")];
    while (buttons.length > wanted) buttons.pop()?.remove();
    while (buttons.length < wanted) buttons.push(this.madeMark(buttons.length));
    film.keyframes.forEach((keyframe, i) => {
      const button = buttons[i] as HTMLButtonElement;
      const time = this.studio.timeOf(i);
      button.style.transform = `translateX(${this.x(time).toFixed(1)}px)`;
      button.setAttribute("aria-label", `Time of keyframe ${i + 1}: ${show(time, 4)} s`);
      const chosen = selection?.kind === "keyframe" && selection.index === i;
      button.setAttribute("aria-pressed", String(chosen));
      button.classList.toggle("untimed", !keyframe.timed);
    });
    this.refreshCuts();
  }

  private refreshCuts(): void {
    const { film } = this.studio;
    const text = JSON.stringify([film.cuts, this.scale, this.width, film.duration]);
    if (text === this.shownCuts) return;
    this.shownCuts = text;
    for (const old of this.marks.querySelectorAll(".mark-cut")) old.remove();
    film.cuts.forEach((cut, i) => {
      const finish = cut.finish ?? Math.min(cut.start + 1, film.duration);
      const button = el("button", {
        class: "mark-cut", type: "button", title: "Footage left out. Click to remove this cut.",
        "aria-label": `Remove cut ${i + 1}, ${show(cut.start)} to ${show(finish)} s`,
        onclick: () => this.studio.edit(uncut(this.studio.document, i)),
      }, "cut \u2715");
      button.style.transform = `translateX(${this.x(cut.start).toFixed(1)}px)`;
      button.style.width = `${Math.max(14, this.x(finish) - this.x(cut.start)).toFixed(1)}px`;
      this.marks.append(button);
    });
  }

  private madeMark(index: number): HTMLButtonElement {
    const { studio } = this;
    const button = el("button", {
      class: "mark-keyframe", type: "button",
      title: "Drag to change the time; Alt and arrows do the same",
      onclick: () => {
        studio.select({ kind: "keyframe", index });
        studio.seek(studio.timeOf(index));
      },
      onfocus: () => studio.select({ kind: "keyframe", index }),
    }, String(index + 1));
    button.addEventListener("pointerdown", (event) => this.press(event, index, button));
    this.marks.append(button);
    return button;
  }

  private press(event: PointerEvent, index: number, button: HTMLButtonElement): void {
    if (event.button !== 0 || !this.studio.editable) return;
    const { studio } = this;
    studio.select({ kind: "keyframe", index });
    const base = studio.session.settled();
    let time: number | null = null;
    const move = (e: PointerEvent): void => {
      if (time === null && Math.abs(e.clientX - event.clientX) < THRESHOLD) return;
      time = this.timeAt(e.clientX);
      studio.drag(retimed(base, index, time));
    };
    whileHeld(button, event.pointerId, move, (kept) => {
      if (time === null) return;
      if (kept) studio.edit(retimed(base, index, time));
      else studio.session.rest();
    });
  }

  // ---- drawing ---------------------------------------------------------------------------------

  private draw(): void {
    const { studio } = this;
    this.head.style.transform = `translateX(${this.x(studio.time).toFixed(1)}px)`;
    this.head.setAttribute("aria-valuenow", studio.time.toFixed(1));
    this.head.setAttribute("aria-valuemax", studio.duration.toFixed(1));
    this.head.setAttribute("aria-valuetext", `${studio.time.toFixed(1)} seconds`);
    byId("clock").textContent = `${clock(studio.time)} / ${clock(studio.duration)}`;
    this.drawRuler();
    this.drawLanes();
  }

  private drawRuler(): void {
    const context = sized(this.ruler);
    if (!context) return;
    const height = this.ruler.clientHeight;
    context.fillStyle = colour("muted");
    context.strokeStyle = colour("line");
    context.font = "11px system-ui, sans-serif";
    context.textAlign = "center";
    const step = niceStep(this.scale / Math.max(3, this.width / 70));
    context.beginPath();
    for (let k = 0; k * step <= this.scale + 1e-9; ++k) {
      const x = Math.round(this.x(k * step)) + 0.5;
      context.moveTo(x, height - 6);
      context.lineTo(x, height);
      context.fillText(`${show(k * step, 4)}${k === 0 ? " s" : ""}`, x, height - 8);
    }
    context.stroke();
    for (const passage of this.studio.passages) {
      context.fillStyle = colour("fail");
      const x = this.x(passage.start);
      context.fillRect(x, height - 4, Math.max(3, this.x(passage.finish) - x), 4);
    }
  }

  private drawLanes(): void {
    const context = sized(this.lanes);
    if (!context) return;
    const plan = this.studio.plan;
    const all = lanesOf(plan, this.limits, this.mass);
    const most = Math.max(1, Math.floor(this.lanes.clientHeight / 25));
    const shown = all.slice(0, most);
    const height = this.lanes.clientHeight / Math.max(1, shown.length);
    context.font = "11px system-ui, sans-serif";
    shown.forEach((lane, i) => this.drawLane(context, plan.columns.time, lane, i * height, height));
    const x = Math.round(this.x(this.studio.time)) + 0.5;
    context.strokeStyle = colour("accent");
    context.beginPath();
    context.moveTo(x, 0);
    context.lineTo(x, this.lanes.clientHeight);
    context.stroke();
  }

  private drawLane(
    context: CanvasRenderingContext2D, times: number[], lane: Lane, top: number, height: number,
  ): void {
    const pad = 4;
    const near = lane.limits.filter((l) => withinReach(l.value, lane.values));
    const known = lane.values.filter(Number.isFinite);
    const all = [...known, ...near.map((l) => l.value), 0];
    let low = Math.min(...all), high = Math.max(...all);
    if (high - low < 1e-9) high = low + 1;
    const y = (v: number): number =>
      top + height - pad - ((v - low) / (high - low)) * (height - 2 * pad);
    if (lane.name === "Speed") {
      this.speed = {
        times, values: lane.values, y,
        valueAt: (at) => low + ((top + height - pad - at) / (height - 2 * pad)) * (high - low),
      };
    }
    context.strokeStyle = colour("line");
    context.strokeRect(LEFT + 0.5, Math.round(top) + 0.5, this.width, Math.round(height) - 1);
    const beyond = (v: number): boolean => lane.limits.some((l) =>
      l.most ? v > l.value * (l.value > 0 ? 1.0001 : 0.9999) : v < l.value - Math.abs(l.value) * 1e-4);
    context.setLineDash([5, 4]);
    context.strokeStyle = colour("limit");
    for (const limit of near) {
      const at = Math.round(y(limit.value)) + 0.5;
      context.beginPath();
      context.moveTo(LEFT, at);
      context.lineTo(LEFT + this.width, at);
      context.stroke();
    }
    context.setLineDash([]);
    const guess = this.studio.standing.plan === null;
    context.lineWidth = 1.6;
    let over = false;
    context.strokeStyle = colour("accent");
    context.beginPath();
    lane.values.forEach((v, i) => {
      if (!Number.isFinite(v)) return;
      const px = this.x(times[i] as number), py = y(v);
      if (!Number.isFinite(lane.values[i - 1] ?? NaN)) context.moveTo(px, py);
      else context.lineTo(px, py);
      if (beyond(v) !== over && i > 0) {
        context.stroke();
        over = !over;
        context.strokeStyle = over ? colour("fail") : colour("accent");
        context.lineWidth = over ? 3 : 1.6;
        context.setLineDash(guess && !over ? [4, 3] : []);
        context.beginPath();
        context.moveTo(px, py);
      }
    });
    context.stroke();
    context.setLineDash([]);
    context.lineWidth = 1;
    this.drawName(context, times, lane, top, height, beyond);
  }

  private drawName(
    context: CanvasRenderingContext2D, times: number[], lane: Lane, top: number, height: number,
    beyond: (v: number) => boolean,
  ): void {
    let k = times.findIndex((t) => t >= this.studio.time - 1e-9);
    if (k < 0) k = times.length - 1;
    const value = lane.values[k];
    const middle = top + height / 2;
    context.textAlign = "left";
    context.fillStyle = colour("ink");
    context.fillText(lane.name, 6, middle - 2);
    context.fillStyle = value !== undefined && beyond(value) ? colour("fail") : colour("muted");
    const limit = lane.limits[0];
    const bound = limit ? ` / ${show(limit.value)}` : "";
    context.fillText(value === undefined || !Number.isFinite(value) ? "" : `${value.toFixed(1)}${bound} ${lane.unit}`, 6,
                     middle + 10);
  }
}

// A limit that is far away would press the curve flat.
function withinReach(limit: number, values: number[]): boolean {
  const size = Math.max(...values.filter(Number.isFinite).map(Math.abs), 1e-9);
  return Math.abs(limit) <= 3 * size;
}

export function niceStep(least: number): number {
  const power = Math.pow(10, Math.floor(Math.log10(Math.max(least, 1e-6))));
  for (const m of [1, 2, 5, 10]) if (m * power >= least) return m * power;
  return 10 * power;
}
