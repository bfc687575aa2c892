// SPDX-License-Identifier: Apache-2.0
// Files dropped on the page: polygons for a scan, a picture of lines for a light painting.
import { addedStrokes, isPainting } from "../state/painting";
import { addedFromFile, polygonsIn } from "../state/polygon_file";
import { isSite, type PolygonKind } from "../state/site";
import type { Studio } from "../studio";
import { byId } from "../view/dom";
import { strokesOfSvg } from "../view/svg_strokes";
import type { Notices } from "./notices";

const MOST_BYTES = 4e6;

export function takeDropped(studio: Studio, notices: Notices): void {
  window.addEventListener("dragover", (event) => event.preventDefault());
  window.addEventListener("drop", (event) => {
    event.preventDefault();
    const [file] = event.dataTransfer?.files ?? [];
    if (file) void take(file);
  });
  byId<HTMLInputElement>("site-file").addEventListener("change", (event) => chosen(event));
  byId<HTMLInputElement>("svg-file").addEventListener("change", (event) => chosen(event));

  function chosen(event: Event): void {
    const input = event.target as HTMLInputElement;
    const [file] = input.files ?? [];
    if (file) void take(file);
    input.value = "";
  }

  async function take(file: File): Promise<void> {
    try {
      // Its bytes would not do: the server reads files that its command line names, no others.
      if (/\.tiff?$/i.test(file.name)) {
        throw new Error(`${file.name}: a backdrop is named when the studio is started: lapwing studio ${
          studio.session.mission.script} --backdrop ${file.name}`);
      }
      if (!studio.editable) throw new Error("Nothing can be edited now.");
      if (file.size > MOST_BYTES) throw new Error(`${file.name}: more than ${MOST_BYTES / 1e6} MB`);
      const text = await file.text();
      if (isSite(studio.document)) {
        const kind = byId<HTMLSelectElement>("site-file-kind").value as PolygonKind;
        studio.edit(addedFromFile(studio.document, kind, file.name, polygonsIn(file.name, text)));
      } else if (isPainting(studio.document)) {
        let strokes;
        try {
          strokes = strokesOfSvg(text);
        } catch (error) {
          throw new Error(`${file.name}: ${(error as Error).message}`);
        }
        const made = addedStrokes(studio.document, `Draw ${file.name}`, strokes);
        if (!made) throw new Error(`${file.name}: its lines have no length`);
        studio.edit(made);
      } else {
        throw new Error("A GeoJSON or KML file can be dropped on a scan, an SVG picture on a light painting.");
      }
    } catch (error) {
      notices.say((error as Error).message, "bad");
    }
  }
}
