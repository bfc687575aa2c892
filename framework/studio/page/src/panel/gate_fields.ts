// SPDX-License-Identifier: Apache-2.0
// A gate of a race as numbers to type.
import { gateShapes, gateSizes } from "../state/course";
import { labelOf, type Field } from "../state/schema";
import type { Json, JsonObject, Option } from "../state/types";

// Its place is shown by whoever shows places.
export function gateFields(index: number, entry: JsonObject, declared: Option[]): Field[] {
  const base = `gates[${index + 1}]`;
  const field = (name: string, more: Partial<Option> = {}): Field | null => {
    const option = declared.find((one) => one.name === name);
    const value: Json | undefined = entry[name];
    return option ? { path: `${base}.${name}`, label: labelOf(name), value: value ?? option.default,
                      option: { ...option, ...more }, stated: value !== undefined } : null;
  };
  const ball = entry.shape === "ball";
  const shape: Field = {
    path: `${base}#shape`, label: "Shape", value: entry.shape, stated: true,
    option: { name: "shape", type: "choice", choices: gateShapes },
  };
  const turn = ball ? [] : [
    named(field("normal_yaw_deg", { required: true }), "Heading"),
    named(field("normal_pitch_deg"), "Pitch"),
    named(field("tunnel_length"), "Tunnel"),
  ];
  return [field("name"), shape, ...gateSizes(entry).map((name) => field(name, { required: true })), ...turn]
    .filter((one): one is Field => one !== null);
}

const named = (field: Field | null, label: string): Field | null => field && { ...field, label };
