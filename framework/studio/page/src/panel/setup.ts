// SPDX-License-Identifier: Apache-2.0
// What the film is flown with: vehicle, camera, solver of those installed, and every option of the
// mission with a single value, as a form by its declaration.
import { isObject } from "../state/document";
import { fieldsOf, labelOf, pluginFields, type Field } from "../state/schema";
import type { Choice, Json, JsonObject, Patch } from "../state/types";
import type { Studio } from "../studio";
import { byId } from "../view/dom";
import { Form } from "./form";

// Kinds of choices, and where the document has them.
const kinds = ["vehicle", "camera", "model", "solver", "planner", "controller"];
const flying = new Set(["vehicle", "camera"]);

// What most films are told, in plain words; all else is for who knows how films are planned. Of
// missions of other kinds it is every option that is no part of another one.
const rules: Record<string, string> = {
  margin: "Distance from obstacles", ground: "Height of the ground", speed_limit: "Speed limit",
  battery: "Longest flight", duration: "Length of the film", speed: "Speed between keyframes",
  start: "Begins", finish: "Ends", framing: "Subject in the picture",
  line_of_sight: "Free view of it", stretch: "All times, times",
};

export class Setup {
  private readonly chosen: Form;
  private readonly solver: Form;
  private readonly film: Form;
  private readonly planning: Form;

  constructor(private readonly studio: Studio) {
    const commit = (field: Field, value: Json): void => this.commit(field, value);
    this.chosen = new Form(commit);
    this.solver = new Form(commit);
    this.film = new Form(commit);
    this.planning = new Form(commit);
    byId("setup-choices").append(this.chosen.root);
    byId("setup-solver").append(this.solver.root);
    byId("setup-film").append(this.film.root);
    byId("setup-planning").append(this.planning.root);
    studio.on(["document"], () => this.show());
  }

  private show(): void {
    const { schema, choices } = this.studio.session;
    const { document } = this.studio;
    const chosen = kinds.flatMap((kind): Field[] => {
      const list = choices[kind];
      if (!list || list.length === 0) return [];
      const vehicle = this.vehicleTable();
      if (kind === "camera" && !vehicle) return [];
      const value = kind === "camera" ? vehicle?.camera : document[kind];
      const name = typeof value === "string" ? value
        : isObject(value) && typeof value.type === "string" ? value.type
          : kind === "vehicle" && isObject(value) ? "own" : "";
      const names = list.map((choice) => choice.name);
      if (!names.includes(name)) names.unshift(name);
      return [{
        path: kind, label: labelOf(kind), value: name, stated: value !== undefined,
        option: { name: kind, type: "choice", choices: names, summary: summaries(list) },
      }];
    });
    this.chosen.show(chosen.filter(({ path }) => flying.has(path)));
    this.solver.show(pluginFields(choices.solver, document.solver, "solver"));
    const shown = new Set(kinds);
    const all = fieldsOf(schema.filter((o) => !shown.has(o.name) && o.name !== "weights"), document);
    const film = this.studio.session.mission.kind === "film";
    const ruled = (field: Field): boolean => (film ? rules[field.path] !== undefined
      : !field.path.includes("."));
    this.film.show(all.filter(ruled).map((field) =>
      (film ? { ...field, label: rules[field.path] as string } : field)));
    this.planning.show([...chosen.filter(({ path }) => !flying.has(path)),
                        ...all.filter((field) => !ruled(field))]);
  }

  // A camera belongs to its vehicle: another one makes a vehicle of its own of it.
  private vehicleTable(): JsonObject | null {
    const { vehicle } = this.studio.document;
    if (isObject(vehicle)) return vehicle;
    const named = this.studio.session.choices.vehicle?.find((choice) => choice.name === vehicle);
    return named?.values ?? null;
  }

  // How another vehicle moves, where it cannot move as the one before.
  private modelFor(vehicle: string): string | null {
    const { session, document } = this.studio;
    const values = session.choices.vehicle?.find((choice) => choice.name === vehicle)?.values;
    const model = isObject(document.model) ? document.model.type : document.model;
    const installed = (name: string): string | null =>
      session.choices.model?.some((choice) => choice.name === name) && model !== name ? name : null;
    if (!values) return null;
    if (isObject(values.wing)) return installed("fixed_wing");
    if (!isObject(values.rotors)) return installed("velocity");
    return model === "velocity" || model === "fixed_wing" ? installed("quadrotor") : null;
  }

  private commit(field: Field, value: Json): void {
    const label = `Change ${field.label.toLowerCase()}`;
    const vehicle = this.vehicleTable();
    if (field.path === "camera" && vehicle) {
      this.studio.edit({ label, patch: [{ path: "vehicle", value: { ...vehicle, camera: value } }] });
      return;
    }
    if (field.path === "vehicle") {
      const patch: Patch = [{ path: "vehicle", value }];
      const model = this.modelFor(String(value));
      if (model) patch.push({ path: "model", value: model });
      this.studio.edit({ label, patch });
      return;
    }
    const { path } = field;
    this.studio.edit({ label, patch: [value === null ? { path, remove: true } : { path, value }] });
  }
}

const summaries = (list: Choice[]): string =>
  list.filter((c) => c.summary).map((c) => `${c.name}: ${c.summary}`).join("\n");
