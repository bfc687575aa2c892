// SPDX-License-Identifier: Apache-2.0
// What is installed, as the page uses it: options in a list, choices with summary and parameters.
import { isObject } from "./document";
import type { Choice, Choices, Json, Option } from "./types";

type Plugins = Record<string, Record<string, { summary?: string; parameters?: Option[] }>>;

// The kind of plugin behind a name of the document.
const kinds: Record<string, string> = {
  solver: "trajectory_solver", exporters: "exporter", shapes: "shape", model: "vehicle_model",
  planner: "path_planner", controller: "controller",
};

export function optionsIn(schema: unknown): Option[] {
  if (Array.isArray(schema)) return schema as Option[];
  const options = (schema as { options?: unknown } | null)?.options;
  return Array.isArray(options) ? (options as Option[]) : [];
}

function choiceFrom(value: unknown, plugins: Plugins[string] | undefined): Choice | null {
  if (typeof value === "string") {
    const plugin = plugins?.[value];
    const choice: Choice = { name: value };
    if (plugin?.summary) choice.summary = plugin.summary;
    if (Array.isArray(plugin?.parameters)) choice.parameters = plugin.parameters;
    return choice;
  }
  if (typeof value !== "object" || value === null) return null;
  const { layer, ...rest } = value as Choice & { layer?: Json };
  if (typeof rest.name !== "string") return null;
  const named = choiceFrom(rest.name, plugins) as Choice;
  return { ...named, ...rest, ...(isObject(layer) ? { values: layer } : {}) };
}

export function choicesIn(schema: unknown, choices: unknown): Choices {
  const plugins = ((schema as { plugins?: Plugins } | null)?.plugins ?? {}) as Plugins;
  const given = (typeof choices === "object" && choices !== null ? choices : {}) as
    Record<string, unknown>;
  const result: Choices = {};
  for (const name of new Set([...Object.keys(given), ...Object.keys(kinds)])) {
    const list = given[name];
    const installed = plugins[kinds[name] ?? ""];
    const all = Array.isArray(list) ? list : Object.keys(installed ?? {});
    const made = all.map((one: unknown) => choiceFrom(one, installed))
      .filter((one): one is Choice => one !== null);
    if (made.length > 0) result[name] = made;
  }
  return result;
}

// In the order in which they are asked for: what flies it, what shows it, maps, data. Formats of
// other plugins come last.
const groups: [string, string[]][] = [
  ["For a drone", ["wpml", "litchi", "qgc_plan", "waypoints", "poly4d"]],
  ["For film and 3D programs", ["gltf", "chan", "edl", "srt"]],
  ["For maps", ["kml", "gpx", "geojson"]],
  ["Tables and recordings", ["csv", "mcap", "colmap"]],
];

export function exporterGroups(exporters: Choice[]): { title: string; choices: Choice[] }[] {
  const known = new Set(groups.flatMap(([, names]) => names));
  const all = groups.map(([title, names]) => ({
    title,
    choices: names.flatMap((name) => exporters.filter((one) => one.name === name)),
  }));
  all.push({ title: "Others", choices: exporters.filter((one) => !known.has(one.name)) });
  return all.filter((group) => group.choices.length > 0);
}
