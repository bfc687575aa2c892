// SPDX-License-Identifier: Apache-2.0
// Tabs: one panel is shown; arrows go from tab to tab.
import { byId } from "../view/dom";

const names = ["film", "feel", "setup"];

export function showTab(name: string): void {
  for (const one of names) {
    const on = one === name;
    const tab = byId(`tab-${one}`);
    tab.setAttribute("aria-selected", String(on));
    tab.tabIndex = on ? 0 : -1;
    byId(`panel-${one}`).hidden = !on;
  }
}

export function wireTabs(): void {
  names.forEach((name) => {
    const tab = byId(`tab-${name}`);
    tab.addEventListener("click", () => showTab(name));
    tab.addEventListener("keydown", (event) => {
      const by = event.key === "ArrowRight" ? 1 : event.key === "ArrowLeft" ? -1 : 0;
      if (!by) return;
      event.preventDefault();
      const shown = names.filter((one) => !byId(`tab-${one}`).hidden);
      const next = shown[(shown.indexOf(name) + by + shown.length) % shown.length] as string;
      showTab(next);
      byId(`tab-${next}`).focus();
    });
  });
}
