// SPDX-License-Identifier: Apache-2.0
// A version that was kept beside the film as it is: its path is a ghost in the world, its figures
// stand beside those of now.
import { backTo, figuresOf, type Figure, type Version } from "../state/compare";
import { show } from "../state/units";
import type { Studio } from "../studio";
import { byId, el } from "../view/dom";
import { gradeLooks } from "./topbar";

export class CompareDialog {
  private readonly box = byId<HTMLDialogElement>("compare-dialog");
  private readonly table = byId("compare-table");
  private readonly back = byId<HTMLButtonElement>("compare-back");

  constructor(private readonly studio: Studio) {
    this.box.querySelector(".close")?.addEventListener("click", () => this.box.close());
    this.box.addEventListener("close", () => studio.keep(null));
    byId("compare-keep").addEventListener("click", () => this.keep());
    this.back.addEventListener("click", () => {
      const { kept, document } = studio;
      if (kept) studio.edit({ label: "Back to the kept version", patch: backTo(document, kept.document) });
    });
    studio.on(["standing", "document", "kept", "world"], () => { if (this.box.open) this.show(); });
  }

  // Keeps the film as it is now, the first time.
  open(): void {
    if (!this.studio.kept) this.keep();
    if (!this.box.open) this.box.show();
    this.show();
    byId("compare-keep").focus();
  }

  private keep(): void {
    const { document, standing, plan, session } = this.studio;
    this.studio.keep({ document, plan, certificate: standing.certificate, world: session.world,
                       grade: standing.grade });
  }

  private show(): void {
    const { kept, document, plan, standing, session } = this.studio;
    if (!kept) return;
    const now: Version =
      { document, plan, certificate: standing.certificate, world: session.world };
    const before = figuresOf(kept), after = figuresOf(now);
    const row = (figure: Figure, i: number): HTMLElement => el("tr", {},
      el("th", { scope: "row" }, figure.name), el("td", {}, told(figure)),
      el("td", {}, told(after[i] as Figure)));
    this.table.replaceChildren(
      el("thead", {}, el("tr", {}, el("th", { scope: "col" }, ""),
        el("th", { scope: "col" }, "Kept"), el("th", { scope: "col" }, "Now"))),
      el("tbody", {}, el("tr", {}, el("th", { scope: "row" }, "Checked"),
        el("td", {}, gradeLooks[kept.grade].word), el("td", {}, gradeLooks[standing.grade].word)),
        ...before.map(row)));
    this.back.disabled = !this.studio.editable || backTo(document, kept.document).length === 0;
  }
}

const told = ({ value, unit }: Figure): string =>
  value === null ? "\u2013" : `${show(value, 3)}${unit ? ` ${unit}` : ""}`;
