// SPDX-License-Identifier: Apache-2.0
// Options as fields of a form: what to show, what may be typed, what it means.
import { isObject } from "./document";
import { parseQuantity, plain, type Range } from "./units";
import type { Choice, Json, JsonObject, Option } from "./types";

export interface Field {
  path: string;
  label: string;
  option: Option;
  value: Json | undefined;      // of the document, else the default
  stated: boolean;              // whether the document has it
}

export const labelOf = (name: string): string => {
  const words = name.replace(/_deg$/, "").replace(/_/g, " ");
  return words.charAt(0).toUpperCase() + words.slice(1);
};

const simple = new Set(["boolean", "integer", "number", "text", "choice", "numbers"]);

// The fields with a single value; those of tables within, with their path. Lists have editors of
// their own.
export function fieldsOf(options: Option[], document: JsonObject, prefix = ""): Field[] {
  return options.flatMap((option): Field[] => {
    const path = prefix ? `${prefix}.${option.name}` : option.name;
    const value = document[option.name];
    if (simple.has(option.type)) {
      return [{ path, label: labelOf(option.name), option, value: value ?? option.default,
                stated: value !== undefined }];
    }
    if (option.type === "table" && option.table) {
      return fieldsOf(option.table, isObject(value) ? value : {}, path);
    }
    return [];
  });
}

// What an installed plugin takes, for the forms of solver and exporter.
export function pluginFields(
  choices: Choice[] | undefined, value: Json | undefined, path: string,
): Field[] {
  const name = typeof value === "string" ? value : isObject(value) ? value.type : undefined;
  const choice = choices?.find((c) => c.name === name);
  return fieldsOf(choice?.parameters ?? [], isObject(value) ? value : {}, path);
}

export function rangeOf(option: Option): Range {
  return {
    minimum: option.minimum, maximum: option.maximum, above: option.above,
    whole: option.type === "integer",
  };
}

export function rangeText(option: Option): string {
  const unit = option.unit ? ` ${option.unit}` : "";
  const { minimum, maximum, above } = option;
  if (minimum !== undefined && maximum !== undefined) return `${minimum} to ${maximum}${unit}`;
  if (above !== undefined && maximum !== undefined) return `above ${above}, at most ${maximum}${unit}`;
  if (above !== undefined) return `above ${above}${unit}`;
  if (minimum !== undefined) return `at least ${minimum}${unit}`;
  if (maximum !== undefined) return `at most ${maximum}${unit}`;
  return option.unit ? `in ${option.unit}` : "";
}

export function textOf(field: Field): string {
  const { value } = field;
  if (value === undefined || value === null) return "";
  if (Array.isArray(value)) return value.map((v) => fieldNumber(v)).join(", ");
  return fieldNumber(value);
}

const fieldNumber = (value: Json): string =>
  typeof value !== "number" ? String(value)
    : value !== 0 && Math.abs(value) < 0.01 ? String(value) : plain(value);

// What was typed, as a value of the document; null removes it.
export function parseField(option: Option, text: string): { value: Json } | { error: string } {
  const trimmed = text.trim();
  if (trimmed === "") {
    return option.required ? { error: "This is needed." } : { value: null };
  }
  switch (option.type) {
    case "boolean":
      return { value: trimmed === "true" };
    case "choice":
      return option.choices?.includes(trimmed) ? { value: trimmed }
        : { error: `Choose one of ${(option.choices ?? []).join(", ")}.` };
    case "integer":
    case "number":
      if (option.words?.includes(trimmed)) return { value: trimmed };
      return parseQuantity(trimmed, option.unit ?? "", rangeOf(option));
    case "numbers": {
      const parts = trimmed.split(/\s*[,;]\s*|\s+(?=[-+.\d])/);
      if (option.size !== undefined && parts.length !== option.size) {
        return { error: `Type ${option.size} numbers.` };
      }
      const values: number[] = [];
      for (const part of parts) {
        const parsed = parseQuantity(part, option.unit ?? "", rangeOf(option));
        if ("error" in parsed) return parsed;
        values.push(parsed.value);
      }
      return { value: values };
    }
    default:
      return { value: trimmed };
  }
}

// A weight between its smallest and largest useful value, as a place of its slider; 0 is the left
// end. Weights span many powers of ten.
const LOWEST = -4, HIGHEST = 5;

export function sliderOf(weight: number): number {
  if (weight <= 0) return 0;
  const share = (Math.log10(weight) - LOWEST) / (HIGHEST - LOWEST);
  return Math.min(Math.max(1 + share * 99, 1), 100);
}

export function weightOf(slider: number): number {
  if (slider < 1) return 0;
  const value = Math.pow(10, LOWEST + ((slider - 1) / 99) * (HIGHEST - LOWEST));
  return Number(value.toPrecision(2));
}
