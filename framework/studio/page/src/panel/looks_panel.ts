// SPDX-License-Identifier: Apache-2.0
// What one looks at of a planned scan, in words: the slice of the map, a voxel, places that were left
// out, a view.
import { axisNumber, cellColour, cellStates, imageInWords, reasonColours, reasonNames, reasonsOf,
         stateNames, viewInWords, voxelInWords, type Axis } from "../state/looks";
import { show } from "../state/units";
import type { ScanWorld, SliceAnswer } from "../state/types";
import type { Studio } from "../studio";
import { byId, el, refill } from "../view/dom";
import type { LooksView } from "../view/looks_view";

const MOST_IMAGES = 12;     // of those that see a voxel, in words
const FIRST_EXTENT = 20;    // m, either way, before the first slice has come
const SURE = 230;           // of 255, of the colours in the legend

export class LooksPanel {
  private readonly on = byId<HTMLInputElement>("slice-on");
  private readonly axis = byId<HTMLSelectElement>("slice-axis");
  private readonly at = byId<HTMLInputElement>("slice-at");

  constructor(private readonly studio: Studio, private readonly looks: LooksView) {
    this.on.addEventListener("change", () => {
      // The first time at the height of the view that is shown now.
      if (looks.explored && !this.at.dataset.seen) this.showExtent(true);
      this.slice();
    });
    this.axis.addEventListener("change", () => {
      this.showExtent(true);
      this.slice();
    });
    this.at.addEventListener("input", () => this.slice());
    const box = byId<HTMLInputElement>("scan-left-out");
    box.addEventListener("change", () => {
      studio.look.leftOut = box.checked;
      looks.askLeftOut(box.checked);
    });
    const candidate = byId<HTMLInputElement>("look-candidate");
    candidate.addEventListener("change", () => {
      const number = candidate.valueAsNumber, count = this.scan?.candidates.length ?? 0;
      if (Number.isInteger(number) && number >= 1 && number <= count) {
        return looks.askView({ candidate: number - 1 }, true);
      }
      studio.session.note(`Candidates have numbers from 1 to ${count}.`);
    });
    byId("look-view").addEventListener("click", () => looks.askViewNow());
    looks.onChange = () => {
      if (looks.slice && looks.explored) this.follow(looks.slice);
      this.show();
    };
    studio.on(["world", "episode", "document"], () => this.showExtent(false));
    this.showExtent(false);
  }

  private get scan(): ScanWorld | undefined {
    return this.studio.session.world.scan;
  }

  private slice(): void {
    this.looks.askSlice(this.on.checked
      ? { axis: this.axis.value as Axis, at: this.at.valueAsNumber } : null);
    this.show();
  }

  // The slider goes over the map, from middle to middle of its layers.
  private showExtent(anew: boolean): void {
    const map = this.scan?.map, { explored } = this.looks;
    byId("looks").hidden = !map?.lower;
    byId("map-look").hidden = !map?.lower && !explored;
    if (explored) return this.showExplored(anew);
    if (!map?.lower || !map.upper) return;
    const axis = axisNumber(this.axis.value as Axis);
    const low = map.lower[axis] + map.resolution / 2, high = map.upper[axis] - map.resolution / 2;
    const began = anew || this.at.dataset.of !== this.axis.value;
    this.at.dataset.of = this.axis.value;
    this.at.min = String(low);
    this.at.max = String(high);
    this.at.step = String(map.resolution);
    if (began) {
      const layers = Math.round((high - low) / map.resolution);
      this.at.value = String(low + Math.round(layers / 3) * map.resolution);
    }
    byId<HTMLInputElement>("look-candidate").max = String(this.scan?.candidates.length ?? 1);
    this.show();
  }

  // Of an exploration the map grows: the slider goes as far as the slice's map does, and begins at
  // the height of the view.
  private showExplored(anew: boolean): void {
    const { studio, looks } = this;
    const section = byId("exploration");
    if (byId("map-look").parentElement !== section) section.append(byId("map-look"));
    byId("map-look-title").textContent = "The map after this image";
    byId("voxel-hint").textContent =
      "Click on the map or the slice for a voxel (Enter: the middle of the view).";
    if (anew || this.at.dataset.of !== this.axis.value) {
      const images = studio.episode?.images ?? [];
      const view = images[Math.max(0, (looks.explored?.image ?? 1) - 1)];
      const at = view?.position[axisNumber(this.axis.value as Axis)] ?? 0;
      this.at.dataset.of = this.axis.value;
      this.at.min = String(at - FIRST_EXTENT);
      this.at.max = String(at + FIRST_EXTENT);
      this.at.step = String(studio.episode?.resolution ?? 1);
      this.at.value = String(at);
    }
    this.show();
  }

  private follow({ axis, at, extent, edge }: SliceAnswer): void {
    if (axis !== this.axis.value) return;
    const beyond = this.at.valueAsNumber < extent[0] - edge || this.at.valueAsNumber > extent[1] + edge;
    const first = this.at.dataset.seen !== axis;      // later, what is dragged stays
    this.at.dataset.seen = axis;
    this.at.min = String(extent[0]);
    this.at.max = String(extent[1]);
    this.at.step = String(edge);
    if (beyond || first) this.at.value = String(at);
  }

  private show(): void {
    this.showSlice();
    this.showVoxel();
    this.showLeftOut();
    this.showView();
  }

  private showSlice(): void {
    const { slice } = this.looks;
    byId("slice-value").textContent = `${this.axis.value} = ${show(this.at.valueAsNumber)} m`;
    byId("slice-legend").hidden = !slice;
    if (!slice) return refill(byId("slice-legend"));
    byId("slice-value").textContent = `${slice.axis} = ${show(slice.at)} m${
      slice.image !== undefined ? `, after image ${slice.image}` : ""}${
      slice.level > 0 ? `, cells of ${show(slice.edge * 2 ** slice.level)} m` : ""}`;
    refill(byId("slice-legend"), ...cellStates.map((state) => {
      const odds = state === "free" ? 255 - SURE : SURE;
      return el("li", { "data-key": state },
                ...swatch(cellColour(state, odds), stateNames[state], slice.counts[state]));
    }));
  }

  private showVoxel(): void {
    const { voxel } = this.looks;
    byId("voxel-hint").hidden = voxel !== null;
    const images = voxel?.images ?? [];
    refill(byId("voxel-words"), ...(voxel ? voxelInWords(voxel) : []).flatMap(([name, value]) =>
      [el("dt", {}, name), el("dd", {}, value)]));
    refill(byId("voxel-images"), ...images.slice(0, MOST_IMAGES).map((image) =>
      el("li", {}, imageInWords(image))),
    images.length > MOST_IMAGES && el("li", {}, `and ${images.length - MOST_IMAGES} more`));
  }

  private showLeftOut(): void {
    const { leftOut } = this.looks;
    refill(byId("left-out-legend"), ...(leftOut ? reasonsOf(leftOut) : []).map(({ reason, count }) =>
      el("li", { "data-key": reason }, el("button", {
        type: "button", class: "swatch", "data-key": `reason-${reason}`,
        "aria-pressed": String(this.looks.draws(reason)), title: "Draw them, or not",
        onclick: () => this.looks.toggle(reason),
      }, ...swatch(reasonColours[reason], reasonNames[reason], count)))),
    leftOut !== null && leftOut.beyond > 0 &&
      el("li", {}, `and ${leftOut.beyond} places that are not listed`));
  }

  private showView(): void {
    const { view } = this.looks;
    byId("view-look").hidden = !view;
    if (!view) return;
    byId("view-look-words").textContent = viewInWords(view);
    const image = byId<HTMLImageElement>("view-look-image");
    const source = `/blob/${view.picture}`;
    if (image.getAttribute("src") !== source) image.src = source;
  }
}

function swatch([r, g, b]: readonly number[], name: string, count: number): HTMLElement[] {
  const mark = el("i");
  mark.style.background = `rgb(${r} ${g} ${b})`;
  return [mark, el("span", { class: "what" }, name), el("span", { class: "when" }, String(count))];
}
