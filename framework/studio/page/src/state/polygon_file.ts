// SPDX-License-Identifier: Apache-2.0
// Polygons of a GeoJSON or KML file that was dropped on the page, in degrees of WGS 84. What they
// may state beside their corners are the properties that regions and zones have.
import { isObject } from "./document";
import { entries } from "./film";
import { polygonNames, siteLists, type PolygonKind } from "./site";
import type { Edit } from "./edits";
import type { Json, JsonObject, Patch } from "./types";

export interface EarthPolygon {
  name: string;
  rings: [number, number][][];        // latitude, longitude; the outline first, then its holes
  stated: Record<string, number>;     // from, to, floor, ceiling, weight
}

const MOST = 1000;                    // polygons
const figures = ["from", "to", "floor", "ceiling", "weight"];
const wgs84 = /(CRS84|EPSG:{1,2}4326)$/;

function corner(pair: Json | undefined, where: string): [number, number] {
  const [east, north] = Array.isArray(pair) ? pair : [];
  if (typeof east !== "number" || typeof north !== "number" || !Number.isFinite(east + north)) {
    throw new Error(`${where}: expected corners [longitude, latitude]`);
  }
  if (Math.abs(east) > 180 || Math.abs(north) > 90) {
    throw new Error(`${where}: ${east}, ${north} are no longitude and latitude: bring the file to ` +
                    "WGS 84 first, as by ogr2ogr -t_srs EPSG:4326 OUT.geojson IN");
  }
  return [north, east];
}

// Without the last corner, which repeats the first.
function ringOf(ring: Json | undefined, where: string): [number, number][] {
  const corners = (Array.isArray(ring) ? ring : []).map((pair) => corner(pair, where));
  const [first, last] = [corners[0], corners[corners.length - 1]];
  if (first && last && corners.length > 1 && first[0] === last[0] && first[1] === last[1]) {
    corners.pop();
  }
  if (corners.length < 3) throw new Error(`${where}: a polygon needs at least three corners`);
  return corners;
}

function statedBy(properties: JsonObject): Record<string, number> {
  return Object.fromEntries(figures.flatMap((name) => {
    const value = properties[name];
    return typeof value === "number" && Number.isFinite(value) ? [[name, value]] : [];
  }));
}

function ofGeoJson(file: string, text: string): EarthPolygon[] {
  let root: Json;
  try {
    root = JSON.parse(text) as Json;
  } catch (error) {
    throw new Error(`${file}: no JSON: ${(error as Error).message}`);
  }
  const crs = isObject(root) && isObject(root.crs) && isObject(root.crs.properties)
    ? String(root.crs.properties.name ?? "") : "";
  if (crs && !wgs84.test(crs)) {
    throw new Error(`${file}: its reference system is ${crs}; bring it to WGS 84 first, as by ` +
                    "ogr2ogr -t_srs EPSG:4326 OUT.geojson IN");
  }
  const found: EarthPolygon[] = [];
  const take = (geometry: Json | undefined, properties: JsonObject, where: string): void => {
    if (!isObject(geometry)) return;
    const { type, coordinates, geometries } = geometry;
    const name = typeof properties.name === "string" ? properties.name : "";
    const add = (rings: Json): void => {
      found.push({ name, stated: statedBy(properties),
                   rings: (Array.isArray(rings) ? rings : []).map((ring) => ringOf(ring, where)) });
    };
    if (type === "Polygon") add(coordinates as Json);
    if (type === "MultiPolygon" && Array.isArray(coordinates)) coordinates.forEach(add);
    if (type === "GeometryCollection" && Array.isArray(geometries)) {
      geometries.forEach((one) => take(one, properties, where));
    }
  };
  const features = isObject(root) && Array.isArray(root.features) ? root.features : [root];
  features.forEach((feature, i) => {
    const where = `${file}, feature ${i + 1}`;
    if (isObject(feature) && feature.type === "Feature") {
      take(feature.geometry, isObject(feature.properties) ? feature.properties : {}, where);
    } else {
      take(feature, {}, where);
    }
  });
  return found;
}

// Placemarks with their polygons; text alone is looked at, so that nothing in it is loaded.
function ofKml(file: string, text: string): EarthPolygon[] {
  const plain = text.replace(/<!--[^]*?-->/g, "");
  const inner = (xml: string, tag: string): string[] =>
    [...xml.matchAll(new RegExp(`<(?:\\w+:)?${tag}(?:\\s[^>]*)?>([^]*?)</(?:\\w+:)?${tag}>`, "g"))]
      .map((match) => match[1] as string);
  const ring = (xml: string, where: string): [number, number][] =>
    ringOf((inner(xml, "coordinates")[0] ?? "").trim().split(/\s+/).map((triple) =>
      triple.split(",").slice(0, 2).map(Number)), where);
  return inner(plain, "Placemark").flatMap((placemark, i) => {
    const where = `${file}, placemark ${i + 1}`;
    const name = (inner(placemark, "name")[0] ?? "").replace(/^<!\[CDATA\[|\]\]>$/g, "").trim();
    const stated: Record<string, number> = {};
    for (const key of figures) {
      const found = new RegExp(`<(?:Data|SimpleData) name="${key}"[^>]*>(?:\\s*<value>)?\\s*([-+.\\deE]+)`)
        .exec(placemark);
      if (found && Number.isFinite(Number(found[1]))) stated[key] = Number(found[1]);
    }
    return inner(placemark, "Polygon").map((polygon): EarthPolygon => ({
      name, stated, rings: [...inner(polygon, "outerBoundaryIs").slice(0, 1),
                            ...inner(polygon, "innerBoundaryIs")].map((xml) => ring(xml, where)) }));
  });
}

// Error with a sentence that names the file.
export function polygonsIn(file: string, text: string): EarthPolygon[] {
  const found = /^\s*[{[]/.test(text) ? ofGeoJson(file, text) : ofKml(file, text);
  const whole = found.filter((polygon) => polygon.rings.length > 0);
  if (whole.length === 0) {
    throw new Error(`${file}: there is no polygon in it; expected GeoJSON or KML with polygons`);
  }
  if (whole.length > MOST) throw new Error(`${file}: ${whole.length} polygons; at most ${MOST}`);
  return whole;
}

// All of them added to the document as regions, or as zones.
export function addedFromFile(document: JsonObject, kind: PolygonKind, file: string,
                              polygons: EarthPolygon[]): Edit {
  const list = siteLists[kind];
  const wanted = kind === "region" ? ["from", "to", "weight"] : ["floor", "ceiling"];
  const made = polygons.map(({ name, rings, stated }, i): JsonObject => {
    const entry: JsonObject = { name: name || `${polygonNames[kind]} ${i + 1} of ${file}`,
                                corners_deg: (rings[0] as [number, number][]).flat() };
    const holes = rings.slice(1).map((ring): JsonObject => ({ corners_deg: ring.flat() }));
    if (holes.length > 0 && kind === "region") entry.holes = holes;
    if (holes.length > 0 && kind !== "region") {
      throw new Error(`${file}: '${String(entry.name)}' has holes, and zones have none`);
    }
    for (const key of wanted) {
      const value = stated[key];
      if (value !== undefined) entry[key] = value;
    }
    return entry;
  });
  const patch: Patch = [];
  const before = entries(document, list);
  if (kind === "region" && before.length === 0 && isObject(document.region) &&
      Object.keys(document.region).length > 0) {
    patch.push({ path: "region", value: {} });
  }
  patch.push({ path: list, value: [...before, ...made] });
  return { label: `Add ${made.length} ${polygonNames[kind]}${made.length > 1 ? "s" : ""} of ${file}`,
           patch };
}
