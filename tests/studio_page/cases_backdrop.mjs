// SPDX-License-Identifier: Apache-2.0
// A GeoTIFF beneath the scene with the studio's own server: its marked pixels are seen where they
// are on the earth, by mouse and keyboard it is drawn or not, and it follows its file.
import assert from "node:assert/strict";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { inflateSync } from "node:zlib";
import { frames, waitGrade } from "./browser.mjs";
import { served } from "./served.mjs";

const LATITUDE = 52, LONGITUDE = 4, EARTH = 6378137, DEGREE = Math.PI / 180;
const SIZE = 100, METRES = 4, MARK = [57, 56];     // pixels; m on the map of Mercator
const left = EARTH * LONGITUDE * DEGREE - (SIZE / 2) * METRES;
const upper = EARTH * Math.log(Math.tan(Math.PI / 4 + (LATITUDE * DEGREE) / 2)) + (SIZE / 2) * METRES;

// Three by three pixels around the mark in one colour, the others in another.
function geotiff(marked, others) {
  const pixels = Buffer.alloc(3 * SIZE * SIZE);
  for (let k = 0; k < SIZE * SIZE; ++k) {
    const near = Math.abs((k % SIZE) - MARK[0]) <= 1 && Math.abs(Math.floor(k / SIZE) - MARK[1]) <= 1;
    pixels.set(near ? marked : others, 3 * k);
  }
  const far = [];
  let at = 8 + pixels.length;
  const put = (bytes) => {
    far.push(bytes);
    at += bytes.length;
    return at - bytes.length;
  };
  const shorts = (values) => put(Buffer.from(Uint16Array.from(values).buffer));
  const doubles = (values) => put(Buffer.from(Float64Array.from(values).buffer));
  const entries = [
    [256, 3, 1, SIZE], [257, 3, 1, SIZE], [258, 3, 3, shorts([8, 8, 8])], [259, 3, 1, 1], [262, 3, 1, 2],
    [273, 4, 1, 8], [277, 3, 1, 3], [278, 3, 1, SIZE], [279, 4, 1, pixels.length],
    [33550, 12, 3, doubles([METRES, METRES, 0])], [33922, 12, 6, doubles([0, 0, 0, left, upper, 0])],
    [34735, 3, 16, shorts([1, 1, 0, 3, 1024, 0, 1, 1, 1025, 0, 1, 1, 3072, 0, 1, 3857])]];
  const head = Buffer.from("II*\0\0\0\0\0");
  head.writeUInt32LE(at, 4);
  const table = Buffer.alloc(2 + 12 * entries.length + 4);
  table.writeUInt16LE(entries.length, 0);
  entries.forEach(([tag, type, count, value], k) => {
    table.writeUInt16LE(tag, 2 + 12 * k);
    table.writeUInt16LE(type, 4 + 12 * k);
    table.writeUInt32LE(count, 6 + 12 * k);
    table.writeUInt32LE(value, 10 + 12 * k);
  });
  return Buffer.concat([head, pixels, ...far, table]);
}

// East and north of the origin (m), by the radii of curvature of WGS 84 there.
function placeOf(x, y) {
  const longitude = (left + x * METRES) / EARTH;
  const latitude = 2 * Math.atan(Math.exp((upper - y * METRES) / EARTH)) - Math.PI / 2;
  const e2 = 0.00669437999014, s = Math.sin(LATITUDE * DEGREE), w = Math.sqrt(1 - e2 * s * s);
  return [(longitude - LONGITUDE * DEGREE) * (EARTH / w) * Math.cos(latitude),
          (latitude - LATITUDE * DEGREE) * (EARTH * (1 - e2) / w ** 3), 0];
}

// The colour of the page at a place, of a PNG of one pixel.
async function colourAt(page, { x, y }) {
  const png = Buffer.from(await page.screenshot({
    clip: { x: Math.round(x), y: Math.round(y), width: 1, height: 1 } }));
  const packed = [];
  for (let at = 8; at < png.length; at += 12 + png.readUInt32BE(at)) {
    if (png.toString("latin1", at + 4, at + 8) === "IDAT") {
      packed.push(png.subarray(at + 8, at + 8 + png.readUInt32BE(at)));
    }
  }
  return [...inflateSync(Buffer.concat(packed)).subarray(1, 4)];
}

const pageOf = (page, place) => page.evaluate((at) => window.lapwing.pageOf(at), place);
const shown = (page) => page.evaluate(() => window.lapwing.backdrop?.file ?? null);

async function lookAt(page, studio, picture, file) {
  await waitGrade(page, "certified");
  await page.waitForFunction("window.lapwing.backdrop !== null");
  const [x, y, z] = placeOf(MARK[0] + 0.5, MARK[1] + 0.5);
  const said = await page.evaluate((at) => window.lapwing.backdropAt(at[0] + 0.5, at[1] + 0.5), MARK);
  assert.ok(Math.hypot(said[0] - x, said[1] - y) < 0.02, `${said} and ${[x, y]}`);
  assert.match(await page.$eval("#backdrop", (e) => e.title), /^photo.tif: pixels of 2\.4\d m; WGS 84/);
  await page.click("#map");
  for (const by of [-1, 1, 1]) await page.mouse.move(600 + by, 300);
  await page.mouse.wheel({ deltaY: 120 });
  await frames(page, 3, 400);
  await picture("backdrop_01_map");
  const pixel = (x1, y1) => pageOf(page, placeOf(x1, y1));
  const same = (colour, expected, what) =>
    assert.ok(colour.every((v, k) => Math.abs(v - expected[k]) <= 3), `${what}: ${colour}`);
  // Its corners, and what is a third of a pixel beyond them.
  for (const [dx, dy] of [[-1, -1], [2, -1], [2, 2], [-1, 2]]) {
    const outwards = [Math.sign(dx - 0.5) / 3, Math.sign(dy - 0.5) / 3];
    const within = await pixel(MARK[0] + dx - outwards[0], MARK[1] + dy - outwards[1]);
    const beyond = await pixel(MARK[0] + dx + outwards[0], MARK[1] + dy + outwards[1]);
    same(await colourAt(page, within), [230, 20, 20], "within");
    same(await colourAt(page, beyond), [60, 130, 60], "beyond");
  }
  // Drawn or not: by mouse, by keyboard.
  const middle = await pixel(MARK[0] + 0.5, MARK[1] + 0.5);
  await page.click("#backdrop");
  assert.equal(await shown(page), null);
  await frames(page, 2, 300);
  assert.ok((await colourAt(page, middle))[0] !== 230);
  await page.focus("#backdrop");
  await page.keyboard.press("Space");
  assert.equal(await shown(page), "photo.tif");
  // In the world it lies on the ground.
  await page.click("#map");
  await frames(page, 2, 300);
  await picture("backdrop_02_world");
  same(await colourAt(page, await pageOf(page, [x, y, z])), [230, 20, 20], "in the world");
  // The file is written anew, then it is none.
  writeFileSync(file, geotiff([20, 20, 230], [60, 130, 60]));
  await page.waitForFunction((was) => window.lapwing.backdrop && window.lapwing.backdrop.picture !== was, {},
                             await page.evaluate(() => window.lapwing.backdrop.picture));
  await frames(page, 2, 300);
  same(await colourAt(page, await pageOf(page, [x, y, z])), [20, 20, 230], "changed");
  writeFileSync(file, "no picture");
  await page.waitForFunction(() => /expected a GeoTIFF/.test(document.querySelector("#notes").textContent));
  assert.equal(await shown(page), null);
  await picture("backdrop_03_damaged");
}

export async function backdrop(browser, shot) {
  const folder = mkdtempSync(join(tmpdir(), "lapwing-backdrop-"));
  const file = join(folder, "photo.tif");
  writeFileSync(file, geotiff([230, 20, 20], [60, 130, 60]));
  const origin = `{latitude_deg: ${LATITUDE}, longitude_deg: ${LONGITUDE}, height: 0, height_of: ellipsoid}`;
  try {
    return await served(browser, shot, {
      name: "a GeoTIFF beneath the scene", picture: "backdrop",
      script: "examples/filming/castle_flyover.lua",
      options: ["--backdrop", file, "--set", `origin=${origin}`],
    }, (page, studio, picture) => lookAt(page, studio, picture, file));
  } catch (error) {
    if (!/built without/.test(error.message)) throw error;
    console.log("skipped          a GeoTIFF beneath the scene: built without GDAL or PROJ");
    return 0;
  } finally {
    rmSync(folder, { recursive: true, force: true });
  }
}
