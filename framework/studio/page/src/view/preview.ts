// SPDX-License-Identifier: Apache-2.0
// The picture of the film camera at the play head: drawn here at once, replaced by the server's
// own while the film stands still. Above it: thirds, the horizon, the box of the subject.
import * as THREE from "three";
import { boxOf, defaultOptics, horizonOf, scaled, type View } from "../state/camera";
import { entries, subjectAt } from "../state/film";
import { viewAt } from "../state/samples";
import type { CameraOptics } from "../state/types";
import type { Studio } from "../studio";
import { byId, el, sized } from "./dom";
import { inReport } from "./report";
import type { Stage } from "./stage";

const STILL = 350;      // ms without a change, before a picture is asked for

export class Preview {
  private readonly overlay = byId<HTMLCanvasElement>("guides");
  private readonly photo = byId<HTMLImageElement>("photo");
  private readonly note = byId("photo-note");
  private readonly clockText = byId("picture-time");
  private timer = 0;
  private asked: { time: number; edit: number } | null = null;

  constructor(private readonly studio: Studio, private readonly stage: Stage) {
    studio.on(["document", "standing", "time", "playing", "look", "mode"], (topic) => {
      if (topic !== "look") this.unphoto();
      this.draw();
    });
    studio.session.on((event) => {
      if (event.what !== "picture" || event.message?.type !== "picture") return;
      const { time, blob } = event.message;
      if (!this.asked || Math.abs(time - this.asked.time) > 1e-3 || studio.playing) return;
      this.photo.onload = () => {
        this.photo.hidden = false;
        this.note.textContent = "Rendered picture";
      };
      this.photo.src = blob.startsWith("/") ? blob : `/blob/${blob}`;
    });
    this.draw();
  }

  private get optics(): CameraOptics {
    return this.studio.plan.camera ?? this.studio.session.grades.lastPlan()?.camera ??
      defaultOptics;
  }

  private unphoto(): void {
    this.photo.hidden = true;
    this.photo.onload = null;
    this.note.textContent = "";
    this.asked = null;
    window.clearTimeout(this.timer);
    const { studio } = this;
    if (studio.playing || !studio.rendered || !studio.session.welcomed) return;
    // What was explored is drawn here, as far as it had grown.
    if (studio.episode) return;
    // The server draws what has converged.
    const { grade } = studio.standing;
    if (studio.session.dragging || grade === "guess" || grade === "step" || grade === "refused") {
      return;
    }
    this.timer = window.setTimeout(() => {
      const width = Math.round(this.overlay.clientWidth);
      const height = Math.round((width * this.optics.height) / this.optics.width);
      this.asked = { time: studio.time, edit: studio.session.edit };
      if (studio.session.link === "open") {
        studio.session.ask({ type: "picture", edit: studio.session.edit, time: studio.time, ...studio.which, width,
                             height });
      }
    }, STILL);
  }

  private draw(): void {
    const { studio, stage } = this;
    const view = viewAt(studio.plan.columns, studio.time);
    const optics = this.optics;
    this.overlay.parentElement?.style.setProperty("--aspect", `${optics.width / optics.height}`);
    this.aim(view, optics);
    this.clockText.textContent = `${studio.time.toFixed(1)} s`;
    this.drawGuides(view, optics);
    stage.invalidate();
  }

  private aim(view: View | null, optics: CameraOptics): void {
    const camera = this.stage.filmCamera;
    if (!view) return;
    camera.position.set(...view.position);
    const turn = new THREE.Matrix4().makeBasis(
      new THREE.Vector3(...view.right), new THREE.Vector3(...view.down).negate(),
      new THREE.Vector3(...view.forward).negate());
    camera.quaternion.setFromRotationMatrix(turn);
    const near = 0.1, far = 20000;
    const left = (-(optics.cx + 0.5) * near) / optics.fx;
    const right = ((optics.width - 0.5 - optics.cx) * near) / optics.fx;
    const top = ((optics.cy + 0.5) * near) / optics.fy;
    const bottom = (-(optics.height - 0.5 - optics.cy) * near) / optics.fy;
    camera.near = near;
    camera.far = far;
    camera.projectionMatrix.makePerspective(left, right, top, bottom, near, far);
    camera.projectionMatrixInverse.copy(camera.projectionMatrix).invert();
    camera.updateMatrixWorld();
  }

  private drawGuides(view: View | null, optics: CameraOptics): void {
    const context = sized(this.overlay);
    if (!context || !view) return;
    const width = this.overlay.clientWidth, height = this.overlay.clientHeight;
    if (!this.studio.guides || width < 10) return;
    const small = scaled(optics, width);
    context.lineWidth = 1;
    // A dark line beside each light one: seen on any picture.
    for (const [by, tint] of [[1.5, "rgba(0, 0, 0, 0.35)"], [0.5, "rgba(255, 255, 255, 0.75)"]] as
         const) {
      context.strokeStyle = tint;
      context.beginPath();
      for (const third of [1 / 3, 2 / 3]) {
        const x = Math.round(width * third) + by, y = Math.round(height * third) + by;
        context.moveTo(x, 0);
        context.lineTo(x, height);
        context.moveTo(0, y);
        context.lineTo(width, y);
      }
      context.stroke();
    }
    context.shadowColor = "rgba(0, 0, 0, 0.8)";
    context.shadowBlur = 2;
    const horizon = horizonOf(view, small);
    if (horizon) {
      context.strokeStyle = "#7fd3ff";
      context.setLineDash([6, 4]);
      context.beginPath();
      context.moveTo(horizon[0][0], horizon[0][1]);
      context.lineTo(horizon[1][0], horizon[1][1]);
      context.stroke();
      context.setLineDash([]);
    }
    context.font = "11px system-ui, sans-serif";
    for (const subject of this.studio.film.subjects) {
      const box = boxOf(view, small, subjectAt(subject, this.studio.time), subject.height ?? 0,
                        subject.width ?? 0);
      if (!box) continue;
      const inside = box.left >= 0 && box.top >= 0 && box.right <= width && box.bottom <= height;
      const place = this.placeOf(subject.name);
      if (place) {
        const [px, py] = [place[0] * width, place[1] * height];
        context.strokeStyle = "#f0a030";
        context.beginPath();
        context.moveTo(px - 7, py);
        context.lineTo(px + 7, py);
        context.moveTo(px, py - 7);
        context.lineTo(px, py + 7);
        context.stroke();
      }
      context.strokeStyle = inside ? "#ffffff" : "#ffb066";
      context.strokeRect(box.left, box.top, Math.max(2, box.right - box.left),
                         Math.max(2, box.bottom - box.top));
      context.fillStyle = context.strokeStyle;
      context.fillText(inside ? subject.name : `${subject.name}: partly outside`,
                       Math.max(2, box.left), Math.max(11, box.top - 4));
    }
  }

  // Where in the picture the film wants it.
  private placeOf(name: string): [number, number] | null {
    const index = this.studio.film.subjects.findIndex((s) => s.name === name);
    const place = entries(this.studio.document, "subjects")[index]?.place;
    return Array.isArray(place) && typeof place[0] === "number" && typeof place[1] === "number"
      ? [place[0], place[1]] : null;
  }
}

export function previewControls(studio: Studio): HTMLElement {
  const box = (label: string, title: string, get: () => boolean, set: (on: boolean) => void) => {
    const input = el("input", { type: "checkbox", checked: get() });
    input.addEventListener("change", () => {
      set(input.checked);
      studio.tell("look");
    });
    studio.on(["look"], () => { input.checked = get(); });
    return el("label", { title }, input, label);
  };
  const framing = el("button", {
    type: "button", id: "framing", "aria-pressed": "false",
    title: "Then click in the picture where the subject is to be, or draw a box for its size (M)",
    onclick: () => {
      studio.framing = !studio.framing;
      studio.tell("look");
    },
  }, "Place subject");
  framing.classList.add("film-only");
  studio.on(["look"], () => framing.setAttribute("aria-pressed", String(studio.framing)));
  return el("div", { class: "row" }, framing,
    box("Guides", "Thirds, horizon and the subject's box (G)", () => studio.guides,
        (on) => { studio.guides = on; }),
    !inReport && box("Rendered", "On pause ask the server for a real picture when the film stands still",
        () => studio.rendered, (on) => { studio.rendered = on; }));
}
