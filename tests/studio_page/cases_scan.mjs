// SPDX-License-Identifier: Apache-2.0
// A scan with the studio's own server: a region drawn on the map, a zone moved by keyboard, planned
// and certified; its figures, its holes, the surface under a click; exported.
import assert from "node:assert/strict";
import { existsSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { centreOf, studioState, type, waitGrade, waitRevision } from "./browser.mjs";
import { exported, served } from "./served.mjs";

const PLANNED = 120000;   // ms at most
const options = ["--config", "scan/small", "--set", "resolution=1", "--set", "tour.budget=90",
                 "--set", "origin={latitude_deg: 52, longitude_deg: 4, height: 0, height_of: ellipsoid}",
                 "--set", "heights=world"];

// What the page says must be what the run says.
const words = (page) => page.$eval("#scan-words", (e) => e.textContent);

// Whether the plan has a view there.
const taken = (page, place) => page.evaluate((at) => window.lapwing.views.some((view) =>
  Math.hypot(...view.position.map((v, i) => v - at[i])) < 1e-3), place);

export const scan = (browser, shot) => served(browser, shot, {
  name: "a scan with the studio's own server", picture: "scan",
  script: "examples/scan/church.lua", options,
}, async (page, studio, picture) => {
  await waitGrade(page, "certified", PLANNED);
  await page.waitForFunction("!document.querySelector('#scan-figures').hidden && window.lapwing.surface > 0");
  await picture("scan_01_opened");
  const first = await words(page);
  assert.match(first, /will show/);
  assert.ok((await page.$$("#hole-list .hole")).length > 0);
  // From above, as a map; a region by mouse.
  await page.click("#map");
  await picture("scan_02_map");
  const { revision } = await studioState(page);
  await page.click("#draw-region");
  const { x, y } = await centreOf(page, "#world");
  await page.mouse.move(x - 60, y - 50);
  await page.mouse.down();
  for (let i = 1; i <= 8; ++i) await page.mouse.move(x - 60 + 12 * i, y - 50 + 11 * i);
  await page.mouse.up();
  await waitRevision(page, revision + 1);
  const regions = async () => (await studioState(page)).document.regions;
  assert.equal((await regions()).length, 1);
  const [drawn] = await regions();
  assert.equal(drawn.corners.length, 8);
  await waitGrade(page, "certified", PLANNED);
  await picture("scan_03_region");
  assert.notEqual(await words(page), first);
  // A corner by keyboard, and what the region counts by typing.
  await page.click('[data-key="region-0"]');
  await page.focus('[data-pin="corner-0-2"]');
  await page.keyboard.press("ArrowRight");
  await page.keyboard.press("ArrowRight");
  await waitRevision(page, revision + 2);
  assert.ok(Math.abs((await regions())[0].corners[4] - drawn.corners[4] - 1) < 1e-9);
  await page.click('[data-key="region-0"]');
  await type(page, '#selected-form [data-key$="weight"]', "2");
  await waitRevision(page, revision + 3);
  assert.equal((await regions())[0].weight, 2);
  // A zone beside it, by keyboard: planned anew, and kept.
  await page.focus("#add-closed");
  await page.keyboard.press("Enter");
  await waitRevision(page, revision + 4);
  assert.equal((await studioState(page)).document.no_fly_zones.length, 1);
  await page.keyboard.press("Escape");
  await page.click("#undo");
  await waitRevision(page, revision + 5);
  await waitGrade(page, "certified", PLANNED);
  // Polygons of a file: one of another reference system is refused, one on the earth is taken.
  const dropped = { crs: '{"type":"Polygon","coordinates":[[[84900,447500],[84910,447500],[84910,447510]]]}',
                  zone: '{"type":"Feature","properties":{"name":"pylon","ceiling":30},"geometry":{"type":' +
                    '"Polygon","coordinates":[[[4.0006,52.0003],[4.0007,52.0003],[4.0007,52.0004]]]}}' };
  const upload = async (name) => {
    const file = join(studio.dir, `${name}.geojson`);
    writeFileSync(file, dropped[name]);
    await (await page.$("#site-file")).uploadFile(file);
  };
  await page.select("#site-file-kind", "closed");
  await upload("crs");
  await page.waitForFunction(() => /EPSG:4326/.test(document.querySelector("#notes").textContent));
  await upload("zone");
  await waitRevision(page, revision + 6);
  assert.equal((await studioState(page)).document.no_fly_zones[0].name, "pylon");
  await waitGrade(page, "certified", PLANNED);
  // The world again; candidates; another figure; the surface under a click.
  await page.click("#map");
  await page.click("#scan-candidates");
  await page.select("#scan-figure", "images");
  await picture("scan_04_candidates");
  await page.click("#hole-list .hole");
  await picture("scan_05_hole");
  const world = await centreOf(page, "#world");
  await page.mouse.click(world.x, world.y);
  await page.waitForFunction(() => /image|region/.test(document.querySelector("#notes").textContent));
  // A view is pinned, and dragged by keyboard; another one is forbidden.
  const next = (await studioState(page)).revision;
  await page.evaluate(() => document.activeElement.blur());
  await page.keyboard.press("Home");
  await page.keyboard.press("]");
  assert.match(await page.$eval("#view-words", (e) => e.textContent), /^View 2 of/);
  await page.click("#view-pin");
  await waitRevision(page, next + 1);
  const [pin] = (await studioState(page)).document.pinned;
  assert.equal(pin.position.length, 3);
  await waitGrade(page, "certified", PLANNED);
  assert.ok(await taken(page, pin.position), "the plan takes the pinned view");
  await page.click('#site-list [data-key="pinned-0"]');
  await page.keyboard.press("ArrowRight");
  await waitRevision(page, next + 2);
  const [moved] = (await studioState(page)).document.pinned;
  assert.ok(Math.abs(moved.position[0] - pin.position[0] - 0.5) < 1e-9);
  await waitGrade(page, "certified", PLANNED);
  assert.ok(await taken(page, moved.position), "the plan takes it where it was dragged to");
  await picture("scan_06_pinned");
  await page.keyboard.press("Escape");
  await page.evaluate(() => document.activeElement.blur());
  await page.keyboard.press("End");
  await page.click("#view-forbid");
  await waitRevision(page, next + 3);
  assert.equal((await studioState(page)).document.forbidden.length, 1);
  await page.click("#undo");
  await waitRevision(page, next + 4);
  await waitGrade(page, "certified", PLANNED);
  // The budget is dragged: told meanwhile, planned when it is let go of.
  const slider = await page.$("#budget");
  await slider.scrollIntoView();
  const { x: left, y: above, width: wide, height: high } = await slider.boundingBox();
  const share = await slider.evaluate((e) => (e.value - e.min) / (e.max - e.min));
  const at = left + 8 + share * (wide - 16);
  await page.mouse.move(at, above + high / 2);
  await page.mouse.down();
  for (let i = 1; i <= 6; ++i) await page.mouse.move(at + 2 * i, above + high / 2);
  await page.waitForFunction(() => /^About \d+ images/.test(document.querySelector("#estimate").textContent),
                             { timeout: PLANNED });
  const estimate = await page.$eval("#estimate", (e) => e.textContent);
  await picture("scan_08_estimate");
  assert.equal((await studioState(page)).revision, next + 4);
  await page.mouse.up();
  await waitRevision(page, next + 5);
  await waitGrade(page, "certified", PLANNED);
  const images = new Set((await page.evaluate(() => window.lapwing.views))
    .map((view) => JSON.stringify([view.position, view.yaw, view.pitch]))).size;
  const said = Number(/^About (\d+)/.exec(estimate)[1]);
  assert.ok(Math.abs(said - images) <= 0.1 * images, `${estimate}, planned ${images}`);
  // Two batteries: two tours, and the second is looked at.
  await type(page, '#flights [data-key="batteries"]', "2");
  await waitRevision(page, next + 6);
  await waitGrade(page, "certified", PLANNED);
  assert.equal((await page.$$("#tour-list .tour")).length, 2);
  // Where the first tour is after a minute, the second is not.
  const flown = () => page.evaluate(() => JSON.stringify(window.lapwing.onScreen(60)));
  const other = await flown();
  await page.click('#tour-list [data-key="tour-1"]');
  await page.waitForSelector('#tour-list [data-key="tour-1"][aria-pressed="true"]');
  await page.waitForFunction((was) => JSON.stringify(window.lapwing.onScreen(60)) !== was, {}, other);
  await picture("scan_07_tours");
  await page.click("#undo");
  await waitRevision(page, next + 7);
  await waitGrade(page, "certified", PLANNED);
  assert.ok(await page.$eval("#tours", (e) => e.hidden));
  // The report is the run's, to the digit.
  await page.click("#report");
  await page.waitForFunction(() => /Written/.test(document.querySelector("#notes").textContent),
                             { timeout: PLANNED });
  const run = join(studio.dir, "out", "church", "report.html");
  assert.ok(existsSync(run), run);
  const told = await words(page);
  assert.ok(readFileSync(run, "utf8").includes(told.slice(0, 60)), told);
  await exported(page);
});
