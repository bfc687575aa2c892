// SPDX-License-Identifier: Apache-2.0
// The feel of the film: styles, the weights as sliders, and what the objective is made of.
import { isObject } from "../state/document";
import { sliderOf, weightOf, labelOf } from "../state/schema";
import { show } from "../state/units";
import type { JsonObject, Option, Patch } from "../state/types";
import type { Studio } from "../studio";
import { byId, el } from "../view/dom";

const words: Record<string, string> = {
  keyframe: "Meet the keyframes", smoothness: "Smooth path", yaw: "Calm turning",
  effort: "Save battery", target: "Stay on the subject", target_smoothness: "Calm aim",
  gimbal: "Calm gimbal", camera: "Aim exactly", skewness: "Keep eye level",
  framing: "Keep place and size in the picture", occlusion: "Keep the view free",
  speed: "Keep the stated speed", time: "Be quick",
};

// The weight that each part of the objective belongs to, where they are not named alike.
const weightOfTerm: Record<string, string> = {
  target_keyframe: "target", target_derivative: "target_smoothness", gimbal_derivative: "gimbal",
  camera_angle: "camera", flight_time: "time", yaw_derivative: "yaw", derivative: "smoothness",
  input_effort: "effort",
};

interface Row {
  option: Option;
  slider: HTMLInputElement;
  value: HTMLElement;
  bar: HTMLElement;
  share: HTMLElement;
}

export class Feel {
  private rows: Row[] = [];

  constructor(private readonly studio: Studio) {
    studio.on(["document"], () => this.show());
    studio.on(["standing"], () => this.showCosts());
  }

  private weight(name: string): number {
    const weights = this.studio.document.weights;
    const value = isObject(weights) ? weights[name] : undefined;
    const option = this.rows.find((row) => row.option.name === name)?.option;
    return typeof value === "number" ? value
      : typeof option?.default === "number" ? option.default : 0;
  }

  private show(): void {
    const declared = this.studio.session.schema.find((o) => o.name === "weights")?.table ?? [];
    if (declared.length !== this.rows.length) this.build(declared);
    for (const { option, slider, value } of this.rows) {
      const weight = this.weight(option.name);
      if (document.activeElement !== slider || !this.studio.session.dragging) {
        slider.value = String(sliderOf(weight));
      }
      value.textContent = weight === 0 ? "off" : show(weight, 2);
      slider.setAttribute("aria-valuetext", weight === 0 ? "off" : show(weight, 2));
    }
    const styles = this.studio.session.choices.style ?? [];
    const list = byId("styles");
    if (list.childElementCount !== styles.length) {
      list.replaceChildren(...styles.map((style) => el("button", {
        type: "button", title: style.summary ?? "", onclick: () => this.apply(style.values ?? {},
          style.name),
      }, labelOf(style.name.replace(/^.*\//, "")))));
    }
    byId("style-box").hidden = styles.length === 0;
  }

  private apply(values: JsonObject, name: string): void {
    const patch: Patch = [];
    const walk = (object: JsonObject, path: string): void => {
      for (const [key, value] of Object.entries(object)) {
        const at = path ? `${path}.${key}` : key;
        if (isObject(value)) walk(value, at);
        else patch.push({ path: at, value });
      }
    };
    walk(values, "");
    this.studio.edit({ label: `Style ${name}`, patch });
  }

  private build(declared: Option[]): void {
    this.rows = declared.map((option) => {
      const label = words[option.name] ?? labelOf(option.name);
      const slider = el("input", {
        type: "range", min: "0", max: "100", step: "1", "aria-label": label,
        "data-key": `weight-${option.name}`,
      });
      const edit = (): { label: string; patch: Patch } => ({
        label: `Weight: ${label}`,
        patch: [{ path: `weights.${option.name}`, value: weightOf(Number(slider.value)) }],
      });
      slider.addEventListener("input", () => this.studio.drag(edit()));
      slider.addEventListener("change", () => this.studio.edit(edit()));
      slider.addEventListener("keydown", (event) => {
        if (event.key === "Escape" && this.studio.session.dragging) this.studio.session.rest();
      });
      return { option, slider, value: el("output", {}), bar: el("span", { class: "bar" }),
               share: el("span", { class: "share" }) };
    });
    byId("weights").replaceChildren(...this.rows.map(({ option, slider, value, bar, share }) =>
      el("label", { class: "weight", title: `${option.name}: ${option.summary ?? ""}` },
        el("span", {}, words[option.name] ?? labelOf(option.name)), value, slider,
        el("span", { class: "track" }, bar), share)));
    this.showCosts();
  }

  private showCosts(): void {
    const objective = this.studio.standing.plan?.objective ??
      this.studio.session.grades.lastPlan()?.objective ?? [];
    const total = objective.reduce((sum, part) => sum + Math.max(0, part.cost), 0);
    byId("cost-note").hidden = total <= 0;
    for (const { option, bar, share } of this.rows) {
      const cost = objective.filter(({ term }) => (weightOfTerm[term] ?? term) === option.name)
        .reduce((sum, part) => sum + Math.max(0, part.cost), 0);
      const part = total > 0 ? cost / total : 0;
      bar.style.width = `${(100 * part).toFixed(1)}%`;
      share.textContent = part >= 0.005 ? `${Math.round(100 * part)} %` : "";
    }
  }
}
