// SPDX-License-Identifier: Apache-2.0
// Fields of forms: typed numbers with units, choices, switches. An edit ends with Enter or by
// leaving the field; what cannot be is said below it and nothing changes.
import { parseField, rangeText, textOf, type Field } from "../state/schema";
import type { Json } from "../state/types";
import { el } from "../view/dom";

export interface Entry {
  root: HTMLElement;
  // Shows another value, unless someone is typing.
  update(field: Field): void;
}

type Commit = (field: Field, value: Json) => void;

let made = 0;

export function entryFor(first: Field, commit: Commit, compact = false): Entry {
  const { option } = first;
  if (option.type === "boolean") return toggle(first, commit);
  if (option.type === "choice" && option.choices) return select(first, commit);
  return textual(first, commit, compact);
}

function frame(field: Field, id: string, ...inside: (Node | string | null)[]): HTMLElement {
  const { option } = field;
  const unit = option.unit && !field.label.includes(option.unit) ? option.unit : "";
  const hint = [option.summary, rangeText(option)].filter(Boolean).join(" \u2014 ");
  return el("div", { class: "field", title: hint },
    el("label", { htmlFor: id }, field.label), ...inside.filter((c): c is Node => c !== null),
    unit ? el("span", { class: "unit" }, unit) : null);
}

function textual(first: Field, commit: Commit, compact: boolean): Entry {
  let field = first;
  const id = `field-${++made}`;
  const error = el("p", { class: "field-error", role: "alert", hidden: true });
  const input = el("input", {
    id, type: "text", value: textOf(field), autocomplete: "off", spellcheck: false,
    "data-key": field.path,
    placeholder: field.stated || textOf(field) ? "" : "not set",
    inputMode: field.option.type === "text" ? "text" : "decimal",
  });
  const say = (text: string): void => {
    error.textContent = text;
    error.hidden = text === "";
    input.setAttribute("aria-invalid", String(text !== ""));
  };
  const done = (): void => {
    if (input.value === textOf(field)) return say("");
    const parsed = parseField(field.option, input.value);
    if ("error" in parsed) return say(parsed.error);
    say("");
    commit(field, parsed.value);
  };
  input.addEventListener("change", done);
  input.addEventListener("keydown", (event) => {
    if (event.key === "Enter") {
      done();
      input.select();
    }
    if (event.key === "Escape") {
      input.value = textOf(field);
      say("");
      input.blur();
      event.stopPropagation();
    }
    const step = event.key === "ArrowUp" ? 1 : event.key === "ArrowDown" ? -1 : 0;
    const number = Number(input.value);
    if (step && (field.option.type === "number" || field.option.type === "integer") &&
        Number.isFinite(number)) {
      event.preventDefault();
      const by = field.option.type === "integer" ? 1 : event.shiftKey ? 0.1 : 1;
      input.value = String(Math.round((number + step * by) * 1000) / 1000);
      done();
    }
  });
  const root = frame(field, id, input);
  // Three numbers of a place stand side by side.
  if (compact && /#[012]$/.test(field.path)) root.classList.add("third");
  root.append(error);
  return {
    root,
    update(next) {
      field = next;
      if (document.activeElement !== input || input.value === "") input.value = textOf(next);
      else if (error.hidden) input.value = textOf(next);
    },
  };
}

function select(first: Field, commit: Commit): Entry {
  let field = first;
  const id = `field-${++made}`;
  const input = el("select", { id, "data-key": field.path },
    ...(field.option.choices ?? []).map((choice) =>
      el("option", { value: choice },
        choice === "" ? "as the drone has it" : choice.replace(/^.*\//, "").replace(/_/g, " "))));
  input.value = String(field.value ?? "");
  input.addEventListener("change", () => commit(field, input.value === "" ? null : input.value));
  return {
    root: frame(field, id, input),
    update(next) {
      field = next;
      input.value = String(next.value ?? "");
    },
  };
}

function toggle(first: Field, commit: Commit): Entry {
  let field = first;
  const id = `field-${++made}`;
  const input = el("input", { id, type: "checkbox", checked: field.value === true,
                              "data-key": field.path });
  input.addEventListener("change", () => commit(field, input.checked));
  return {
    root: frame(field, id, input),
    update(next) {
      field = next;
      input.checked = next.value === true;
    },
  };
}

// A form that keeps its fields while their paths stay the same.
export class Form {
  readonly root = el("div", { class: "form" });
  private entries: { path: string; type: string; entry: Entry }[] = [];

  constructor(private readonly commit: Commit, private readonly compact = false) {}

  show(fields: Field[]): void {
    const same = fields.length === this.entries.length && fields.every((field, i) =>
      field.path === this.entries[i]?.path && shapeOf(field) === this.entries[i]?.type);
    if (same) {
      fields.forEach((field, i) => this.entries[i]?.entry.update(field));
      return;
    }
    this.entries = fields.map((field) => ({
      path: field.path, type: shapeOf(field), entry: entryFor(field, this.commit, this.compact),
    }));
    this.root.replaceChildren(...this.entries.map(({ entry }) => entry.root));
  }

  focus(): void {
    this.root.querySelector<HTMLElement>("input, select")?.focus();
  }
}

const shapeOf = (field: Field): string =>
  `${field.option.type}/${field.label}/${(field.option.choices ?? []).join()}`;
