// SPDX-License-Identifier: Apache-2.0
// The certificate as a list: what fails first, with its mend; a click goes to the place and second.
import { legAt, mendOf, plainName, slowerBy, sortedChecks, unhurried, verdict } from
  "../state/failures";
import { slowed } from "../state/edits";
import { show } from "../state/units";
import type { Certificate, Check } from "../state/types";
import type { Studio } from "../studio";
import { byId, el, refill } from "../view/dom";

export class CertificateList {
  private shown: Certificate | null = null;
  private readonly list = byId("checks");
  private readonly summary = byId("certificate-summary");

  constructor(private readonly studio: Studio) {
    studio.on(["standing", "document"], () => this.show());
  }

  private show(): void {
    const { certificate, grade, message } = this.studio.standing;
    // The list of a state that is no more stays readable, and is marked as old.
    this.list.classList.toggle("old", certificate === null);
    if (certificate) {
      const bad = certificate.checks.filter((c) => !c.passed && c.required && !c.skipped).length;
      const judged = certificate.checks.filter((c) => !c.skipped).length;
      this.summary.textContent = certificate.passed
        ? `All ${judged} checks passed.` : `${bad} of ${judged} checks failed.`;
    } else if (grade === "refused") {
      this.summary.textContent = message || "This cannot be planned.";
    } else {
      this.summary.textContent = this.shown ? "Being checked again\u2026" : "Not checked yet.";
    }
    // A mend is of this certificate: it is pressed once, until there is another.
    for (const mend of this.list.querySelectorAll<HTMLButtonElement>(".mend button")) {
      mend.disabled = certificate === null;
    }
    if (!certificate || certificate === this.shown) return;
    this.shown = certificate;
    refill(this.list, ...sortedChecks(certificate).map((check) => this.row(check)));
  }

  private row(check: Check): HTMLElement {
    const skipped = Boolean(check.skipped);
    const failed = !check.passed && check.required && !skipped;
    const state = skipped ? "not needed" : failed ? "failed" : check.passed ? "passed" : "reported";
    const mark = { "not needed": "\u2013", failed: "\u2717", passed: "\u2713", reported: "i" }[state];
    const told = typeof check.skipped === "string" ? check.skipped : verdict(check);
    const time = typeof check.time === "number" && !skipped ? check.time : null;
    const button = el("button", {
      type: "button", class: `check ${failed ? "fail" : skipped ? "skipped" : "pass"}`,
      "data-key": check.name,
      title: [check.name, check.detail].filter(Boolean).join(": "),
      onclick: () => { if (time !== null) this.go(time); },
    },
      el("span", { class: "mark", "aria-label": state }, mark),
      el("span", { class: "what" }, plainName(check.name)),
      time !== null ? el("span", { class: "when" }, `${show(time)} s`) : null,
      el("span", { class: "told" }, told));
    const row = el("li", {}, button);
    if (failed) row.append(this.mend(check));
    return row;
  }

  private mend(check: Check): HTMLElement {
    const text = mendOf(check);
    const row = el("div", { class: "mend" }, el("span", {}, text || check.detail || ""));
    const factor = slowerBy(check);
    const leg = legAt(this.studio.film.keyframes, check.time ?? 0);
    if (factor !== null && leg !== null && this.studio.editable) {
      const [from, to] = [leg - 1, leg].map((i) => this.studio.film.keyframes[i]);
      const pace = from && to ? unhurried(from, to, this.studio.plan.limits?.speed_across) : 1;
      const by = Math.max(factor, pace);
      row.append(el("button", {
        type: "button", class: "primary", "data-key": `mend-${check.name}`,
        onclick: () => this.studio.edit(slowed(this.studio.document, leg, by)),
      }, `Slow leg ${leg}\u2009\u2192\u2009${leg + 1} by ${by.toFixed(2)}`));
    }
    return row;
  }

  private go(time: number): void {
    this.studio.play(false);
    this.studio.seek(time);
  }
}
