// SPDX-License-Identifier: Apache-2.0
// Dialogs: export, flying with wind, the sheet of keys.
import { bindings, keyText } from "../state/keys";
import { exporterGroups } from "../state/installed";
import { fieldsOf } from "../state/schema";
import { show } from "../state/units";
import type { Flown, JsonObject, ServerMessage } from "../state/types";
import type { Studio } from "../studio";
import { byId, el } from "../view/dom";
import { Form } from "./form";

export function dialog(id: string): HTMLDialogElement {
  const box = byId<HTMLDialogElement>(id);
  box.querySelector(".close")?.addEventListener("click", () => box.close());
  return box;
}

export class ExportDialog {
  private readonly box = dialog("export-dialog");
  private readonly choice = byId<HTMLSelectElement>("export-format");
  private readonly uncertified = byId<HTMLInputElement>("export-uncertified");
  private readonly result = byId("export-result");
  private readonly form: Form;
  private parameters: JsonObject = {};
  private waiting = new Set<string>();

  constructor(private readonly studio: Studio) {
    this.form = new Form((field, value) => {
      if (value === null) delete this.parameters[field.path];
      else this.parameters[field.path] = value;
      this.showForm();
    });
    byId("export-form").append(this.form.root);
    this.choice.addEventListener("change", () => {
      this.parameters = {};
      this.showForm();
    });
    byId("export-go").addEventListener("click", () => this.send());
    studio.on(["standing"], () => this.showState());
    studio.session.on((event) => {
      if (event.message) this.answer(event.message);
    });
  }

  open(): void {
    const all = [...exporterGroups(this.studio.session.choices.exporters ?? []),
                 { title: "For Lapwing", choices: [
                   { name: REPORT, summary: "a folder with plan, report, pictures and log, as " +
                     "lapwing run writes it" },
                   { name: LUA, summary: "the film as it is now, as a script of its own" }] }];
    const count = all.reduce((sum, group) => sum + group.choices.length, 0);
    if (this.choice.options.length !== count) {
      this.choice.replaceChildren(...all.map(({ title, choices }) => el("optgroup", { label: title },
        ...choices.map((one) => el("option", { value: one.name },
          [one.name, one.summary].filter(Boolean).join(" \u2013 "))))));
    }
    this.result.replaceChildren();
    this.showForm();
    this.showState();
    if (!this.box.open) this.box.showModal();
    this.choice.focus();
  }

  private showForm(): void {
    const name = this.choice.value;
    const exporter = this.studio.session.choices.exporters?.find((e) => e.name === name);
    const summaries: Record<string, string> = {
      [LUA]: "The film as it is now, as a script of its own.",
      [REPORT]: "A folder with plan, report, pictures and log.",
    };
    byId("export-summary").textContent = [exporter?.summary ?? summaries[name] ?? "", exporter?.loss]
      .filter(Boolean).join(". ");
    this.form.show(fieldsOf(exporter?.parameters ?? [], this.parameters));
    this.showState();
  }

  private showState(): void {
    const certified = this.studio.standing.grade === "certified";
    const plain = this.choice.value === LUA;
    byId("export-warning").hidden = certified || plain;
    byId<HTMLButtonElement>("export-go").disabled =
      !certified && !plain && !this.uncertified.checked;
    this.uncertified.onchange = () => this.showState();
  }

  private send(): void {
    const name = this.choice.value;
    const { session } = this.studio;
    const uncertified = this.studio.standing.grade !== "certified" && this.uncertified.checked;
    const id = name === LUA ? session.ask({ type: "export_lua", id: "" })
      : name === REPORT ? session.ask({ type: "save_report", id: "" })
        : session.ask({ type: "export", id: "", format: name, ...this.studio.which, parameters: this.parameters,
                        uncertified });
    this.waiting.add(id);
    this.result.replaceChildren(el("p", { role: "status" }, "Writing\u2026"));
  }

  private answer(message: ServerMessage): void {
    if (message.type === "wrote" && this.waiting.delete(message.id)) {
      this.result.replaceChildren(writtenList(message.files, message.loss));
      this.studio.tell("look");
    } else if ((message.type === "failed" || message.type === "refused") && message.id &&
               this.waiting.delete(message.id)) {
      this.result.replaceChildren(el("p", { class: "field-error", role: "alert" }, message.why));
    }
  }
}

const LUA = "Lua script";
const REPORT = "Report";

export function writtenList(files: string[], loss: string | string[] | undefined): HTMLElement {
  const losses = (Array.isArray(loss) ? loss : [loss ?? ""]).filter(Boolean);
  return el("div", { role: "status", class: "written" },
    el("p", {}, "\u2713 Written:"),
    el("ul", {}, ...files.map((file) => el("li", {}, el("code", {}, file)))),
    ...losses.map((text) => el("p", { class: "muted" }, `${text.charAt(0).toUpperCase()}${
      text.slice(1)}${/[.!]$/.test(text) ? "" : "."}`)));
}

export class FlyDialog {
  private readonly box = dialog("fly-dialog");
  private readonly speed = byId<HTMLInputElement>("wind-speed");
  private readonly from = byId<HTMLSelectElement>("wind-from");
  private readonly gust = byId<HTMLInputElement>("wind-gust");
  private readonly result = byId("fly-result");
  private readonly mass = byId<HTMLInputElement>("fly-mass");
  private readonly runs = byId<HTMLSelectElement>("fly-runs");
  private seed = 0;
  private waiting = false;

  constructor(private readonly studio: Studio) {
    const say = (): void => {
      byId("wind-value").textContent = `${this.speed.value} m/s (${beaufort(+this.speed.value)})`;
      byId("gust-value").textContent = `${this.gust.value} m/s`;
      byId("mass-value").textContent = `\u00b1${this.mass.value} %`;
    };
    this.mass.addEventListener("input", say);
    this.speed.addEventListener("input", say);
    this.gust.addEventListener("input", say);
    say();
    byId("fly-go").addEventListener("click", () => this.send());
    this.runs.addEventListener("change", () => this.show());
    studio.on(["flown", "standing"], () => this.show());
    studio.session.on((event) => {
      if (this.waiting && event.what === "note" && event.message) {
        this.waiting = false;
        this.result.textContent = event.text ?? "";
      }
    });
  }

  // Beside the world, not above it: the ghost is to be seen.
  open(): void {
    if (!this.box.open) this.box.show();
    this.show();
    this.speed.focus();
  }

  private send(): void {
    const angle = (Number(this.from.value) * Math.PI) / 180;
    const size = Number(this.speed.value);
    // A wind from the north blows south.
    const wind = [-Math.sin(angle) * size, -Math.cos(angle) * size, 0].map((v) => v + 0);
    this.seed += 1;
    this.waiting = true;
    this.result.textContent = "Flying\u2026";
    this.studio.session.ask({ type: "fly", edit: this.studio.session.edit, ...this.studio.which, wind,
                              gust: Number(this.gust.value), seed: this.seed,
                              ...this.often() });
  }

  private often(): { runs?: number; mass?: number } {
    const runs = Number(this.runs.value);
    return runs > 1 ? { runs, mass: Number(this.mass.value) / 100 } : {};
  }

  private show(): void {
    byId<HTMLInputElement>("fly-mass").disabled = this.runs.value === "1";
    const { grade } = this.studio.standing;
    byId<HTMLButtonElement>("fly-go").disabled = grade !== "certified";
    byId("fly-warning").hidden = grade === "certified";
    const { flown } = this.studio;
    if (!flown) {
      if (!this.waiting) this.result.textContent = "";
      return;
    }
    this.waiting = false;
    this.result.replaceChildren(el("p", { class: flown.kept === false || flown.lost ? "bad" : "good" },
      flightText(flown)),
      el("p", { class: "muted" }, "The dotted path is the flown one. Press play to watch both."));
  }
}

export function flightText(flown: Flown): string {
  const { worst, runs } = flown;
  if (runs) {
    return `${runs.kept === runs.count ? "\u2713" : "\u2717"} ${runs.kept} of ${runs.count} flights kept ${
      show(worst?.limit ?? 0)} m${runs.lost > 0 ? `, ${runs.lost} were lost` : ""}. Largest distances: ${
      show(runs.median, 2)} m in the middle, ${show(runs.most, 2)} m at most.`;
  }
  if (flown.lost) return "\u2717 The drone was lost. Try less wind, or a gentler film.";
  const off = worst ? `at most ${show(worst.position_error, 2)} m beside the plan, at ${
    show(worst.time ?? 0)} s` : "";
  if (flown.kept === false) {
    return `\u2717 Blown off the path: ${off}; ${show(worst?.limit ?? 0)} m are allowed.`;
  }
  return `\u2713 Flown: ${off}.`;
}

function beaufort(speed: number): string {
  const words: [number, string][] = [[0.3, "calm"], [3.4, "light breeze"], [8, "moderate breeze"],
    [10.8, "fresh breeze"], [13.9, "strong breeze"], [99, "gale"]];
  return (words.find(([most]) => speed < most) as [number, string])[1];
}

export class HelpDialog {
  private readonly box = dialog("help-dialog");

  constructor() {
    const groups = [...new Set(bindings.map((b) => b.group))];
    byId("help-keys").append(...groups.map((group) => el("section", {},
      el("h3", {}, group),
      el("dl", {}, ...bindings.filter((b) => b.group === group).flatMap((b) => [
        el("dt", {}, ...b.keys.flatMap((key, i) => [i ? " " : "", el("kbd", {}, keyText(key))])),
        el("dd", {}, b.text)])))));
  }

  open(): void {
    if (!this.box.open) this.box.showModal();
  }
}

