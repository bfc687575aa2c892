// SPDX-License-Identifier: Apache-2.0
// The patterns of a scan's first flight as forms. A drag of the number of images draws what they
// would show before anything is flown.
import { addedFlight, changedFlight, firstFlightInWords, flightsOf, removedFlight } from
  "../state/first_flight";
import { fieldsOf } from "../state/schema";
import { isSite } from "../state/site";
import type { Option } from "../state/types";
import type { Studio } from "../studio";
import { byId, el } from "../view/dom";
import { Form } from "./form";

const MOST_VIEWS = 200, SOME_VIEWS = 30;

interface Row {
  root: HTMLElement;
  form: Form;
  views: HTMLInputElement;
}

export class FirstFlightPanel {
  private rows: Row[] = [];

  constructor(private readonly studio: Studio) {
    byId("add-pattern").addEventListener("click", () => studio.edit(addedFlight(studio.document)));
    studio.on(["document", "world", "draft"], () => this.show());
  }

  private get options(): Option[] {
    return this.studio.session.schema.find(({ name }) => name === "flights")?.table ?? [];
  }

  private show(): void {
    const { studio } = this;
    if (!isSite(studio.document)) return;
    const flights = flightsOf(studio.document);
    if (flights.length !== this.rows.length) {
      this.rows = flights.map((_, index) => this.row(index));
      byId("pattern-list").replaceChildren(...this.rows.map(({ root }) => root));
    }
    flights.forEach((flight, index) => {
      const { form, views } = this.rows[index] as Row;
      form.show(fieldsOf(this.options, flight, `flights[${index + 1}]`));
      views.value = String(typeof flight.views === "number" ? flight.views : SOME_VIEWS);
    });
    byId("pattern-hint").hidden = flights.length > 0;
    byId("first-words").textContent =
      firstFlightInWords(studio.session.firstFlight, studio.session.world.scan);
  }

  private row(index: number): Row {
    const { studio } = this;
    const form = new Form(({ path }, value) => {
      studio.edit(changedFlight(studio.document, index, path.slice(path.lastIndexOf(".") + 1), value));
    });
    const views = el("input", {
      type: "range", min: "4", max: String(MOST_VIEWS), step: "1", "data-key": `views-${index}`,
      "aria-label": `Images of pattern ${index + 1}`, title: "Drag: what the images would show is drawn; let go: flown and planned",
    });
    const edit = (from: Studio["document"]): ReturnType<typeof changedFlight> =>
      changedFlight(from, index, "views", views.valueAsNumber);
    views.addEventListener("input", () => studio.drag(edit(studio.session.settled())));
    views.addEventListener("change", () => studio.edit(edit(studio.session.settled())));
    const root = el("li", { class: "pattern" }, form.root, views,
      el("button", { type: "button", "aria-label": `Remove pattern ${index + 1}`, "data-key": `drop-${index}`,
                     onclick: () => studio.edit(removedFlight(studio.document, index)) }, "Remove"));
    return { root, form, views };
  }
}
