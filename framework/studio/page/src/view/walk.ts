// SPDX-License-Identifier: Apache-2.0
// A subject walked in real time: while the mouse is held on the ground, or between two presses of
// Enter with the arrows, the film runs and the subject is where one leads it.
import { subjectAt } from "../state/film";
import { walked, type Step } from "../state/walk";
import type { JsonObject, Vec3 } from "../state/types";
import type { Studio } from "../studio";
import type { Pick } from "./pick";
import type { Stage } from "./stage";

const PACE = 1.5, RUN = 5;         // m/s by the arrows, with Shift
const SHOWN = 250;                 // ms between drags on the way
const ways: Record<string, [number, number]> = {
  ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1],
};

export class Walk {
  private base: JsonObject | null = null;      // while one walks
  private subject = 0;
  private steps: Step[] = [];
  private place: Vec3 = [0, 0, 0];
  private readonly held = new Map<string, boolean>();   // arrows, and whether they run
  private last = 0;
  private shown = 0;

  constructor(private readonly studio: Studio, private readonly stage: Stage,
              private readonly pick: Pick) {
    stage.world.addEventListener("pointerdown", (event) => this.press(event), { capture: true });
    window.addEventListener("keydown", (event) => this.key(event), { capture: true });
    window.addEventListener("keyup", (event) => this.held.delete(event.key));
    window.addEventListener("blur", () => this.held.clear());
    studio.on(["mode"], () => {
      if (studio.mode === "walk") this.choose();
      else this.drop();
    });
  }

  // Who is walked: the selected subject, else the first.
  private choose(): void {
    const { studio } = this;
    const { selection, film } = studio;
    const of = selection?.kind === "subject" || selection?.kind === "track" ? selection.index : 0;
    if (!film.subjects[of]) {
      studio.session.note("Add a subject first: then its way can be walked.");
      studio.setMode("orbit");
      return;
    }
    this.subject = of;
    studio.select({ kind: "subject", index: of });
  }

  private press(event: PointerEvent): void {
    if (this.studio.mode !== "walk" || event.button !== 0 || this.base) return;
    event.stopImmediatePropagation();
    if (!this.begin()) return;
    const { world } = this.stage;
    const lead = (e: PointerEvent): void => {
      const at = this.pick.onLevel(e, this.place[2]);
      if (at) this.place = at;
    };
    lead(event);
    world.setPointerCapture(event.pointerId);
    const end = (): void => {
      world.removeEventListener("pointermove", lead);
      world.removeEventListener("pointerup", end);
      world.removeEventListener("pointercancel", end);
      this.finish();
    };
    world.addEventListener("pointermove", lead);
    world.addEventListener("pointerup", end);
    world.addEventListener("pointercancel", end);
  }

  private key(event: KeyboardEvent): void {
    if (this.studio.mode !== "walk" || event.ctrlKey || event.metaKey || event.altKey) return;
    const way = ways[event.key];
    if (event.key === "Escape" && this.base) {
      this.drop();
    } else if (event.key === "Enter") {
      if (this.base) this.finish();
      else this.begin();
    } else if (way && this.base) {
      this.held.set(event.key, event.shiftKey);
    } else {
      return;
    }
    event.preventDefault();
    event.stopImmediatePropagation();
  }

  private begin(): boolean {
    const { studio } = this;
    const subject = studio.film.subjects[this.subject];
    if (!subject || !studio.editable) return false;
    studio.play(false);
    if (studio.time > studio.duration - 0.5) studio.seek(0);
    this.base = studio.session.settled();
    this.place = subjectAt(subject, studio.time);
    this.steps = [];
    this.last = this.shown = performance.now();
    this.held.clear();
    requestAnimationFrame(this.tick);
    return true;
  }

  private readonly tick = (now: number): void => {
    const { studio, base } = this;
    if (!base) return;
    this.step(now);
    if (now - this.shown > SHOWN) {
      this.shown = now;
      studio.drag(walked(base, this.subject, this.steps));
    }
    if (studio.time >= studio.duration) this.finish();
    else requestAnimationFrame(this.tick);
  };

  // Where the subject is now, and how far the film has run: not beyond its end.
  private step(now: number): void {
    const { studio } = this;
    const before = studio.time;
    const seconds = this.steps.length > 0 ? Math.max(0, (now - this.last) / 1000) : 0;
    const time = Math.min(before + seconds, studio.duration);
    this.last = now;
    for (const [key, runs] of this.held) {
      const [x, y] = ways[key] as [number, number];
      const by = (runs ? RUN : PACE) * (time - before);
      this.place = [this.place[0] + by * x, this.place[1] + by * y, this.place[2]];
    }
    this.steps.push({ time, place: this.place });
    studio.seek(time);
  }

  private finish(): void {
    const { studio, base } = this;
    if (base) this.step(performance.now());
    this.base = null;
    if (!base) return;
    const edit = walked(base, this.subject, this.steps);
    if (!edit) {
      studio.session.rest();
      studio.session.note("Hold the mouse, or walk on, for longer: nothing was changed.");
      return;
    }
    studio.setMode("orbit");
    studio.edit(edit);
    studio.select({ kind: "subject", index: this.subject });
  }

  private drop(): void {
    if (!this.base) return;
    this.base = null;
    this.studio.session.rest();
  }
}
