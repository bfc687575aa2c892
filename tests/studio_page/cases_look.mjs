// SPDX-License-Identifier: Apache-2.0
// A look into a planned scan with the studio's own server: a voxel under a click, slices of the map,
// places that were left out, the view under the mouse; each by mouse and by keyboard.
import assert from "node:assert/strict";
import { centreOf, frames, studioState, type, waitGrade, waitRevision } from "./browser.mjs";
import { served } from "./served.mjs";

const PLANNED = 120000;   // ms at most
const options = ["--config", "scan/small", "--set", "resolution=1", "--set", "tour.budget=90",
                 "--set", "map={type: brick, observations: true}",
                 "--set", "forbidden=[{position: [0, 25, 30], within: 12}]"];

const looks = (page, what) => page.evaluate((name) => window.lapwing.looks[name], what);
const until = (page, condition, ...more) =>
  page.waitForFunction(condition, { timeout: PLANNED }, ...more);
const words = (page, id) => page.$eval(`#${id}`, (e) => e.textContent);
const pageOf = (page, place) => page.evaluate((at) => window.lapwing.pageOf(at), place);
const setSlider = (page, id, value) => page.$eval(`#${id}`, (slider, to) => {
  slider.value = String(to);
  slider.dispatchEvent(new Event("input", { bubbles: true }));
}, value);
const legend = (page, id) => page.$$eval(`#${id} li[data-key]`, (all) => Object.fromEntries(
  all.map((row) => [row.dataset.key, Number(row.querySelector(".when").textContent)])));

// A voxel of the surface under a click, and one under the middle of the view by keyboard.
async function lookAtVoxels(page, picture) {
  const { x, y } = await centreOf(page, "#world");
  await page.mouse.click(x, y);
  await until(page, "window.lapwing.looks.voxel !== null");
  const voxel = await looks(page, "voxel");
  assert.equal(voxel.state, "occupied");
  assert.ok(voxel.observations > 0);
  const said = await words(page, "voxel-words");
  assert.ok(said.includes(String(Number(voxel.log_odds.toPrecision(7)))), said);
  assert.ok(said.includes(`${voxel.observations} times`), said);
  const views = await page.evaluate(() => window.lapwing.views);
  for (const { number, distance } of voxel.images) {
    const away = Math.hypot(...views[number - 1].position.map((v, i) => v - voxel.middle[i]));
    assert.ok(Math.abs(away - distance) < 1e-3, `image ${number}: ${away} and ${distance}`);
  }
  assert.equal((await page.$$("#voxel-images li")).length, Math.min(voxel.images.length, 13));
  await picture("look_01_voxel");
  await page.keyboard.press("Escape");
  assert.equal(await looks(page, "voxel"), null);
  // The same by keyboard.
  await page.focus("#world");
  await page.keyboard.press("Enter");
  await until(page, "window.lapwing.looks.voxel !== null");
  assert.deepEqual((await looks(page, "voxel")).key, voxel.key);
}

// A level by keyboard, another by the slider, and one across; cells that are clicked at.
async function lookAtSlices(page, picture) {
  await page.focus("#slice-on");
  await page.keyboard.press("Space");
  await until(page, "window.lapwing.looks.slice !== null");
  const first = await looks(page, "slice");
  await page.focus("#slice-at");
  await page.keyboard.press("ArrowRight");
  await until(page, (at) => window.lapwing.looks.slice.at === at, first.at + first.edge);
  await setSlider(page, "slice-at", 2.5);
  await until(page, "window.lapwing.looks.slice.at === 2.5");
  const slice = await looks(page, "slice");
  const counts = await legend(page, "slice-legend");
  assert.deepEqual(counts, slice.counts);
  assert.equal(Object.values(counts).reduce((a, b) => a + b), slice.columns * slice.rows);
  await picture("look_02_slice");
  // Cells in the middle of the picture: what is clicked at is what the slice shows there.
  for (const [dx, dy] of [[0, 0], [-120, 40], [160, -60]]) {
    const { x, y } = await centreOf(page, "#world");
    const before = await looks(page, "voxel");
    await page.mouse.click(x + dx, y + dy);
    await until(page, (was) => JSON.stringify(window.lapwing.looks.voxel?.key) !== was,
                JSON.stringify(before?.key));
    assert.equal((await looks(page, "voxel")).middle[2], 2.5);
  }
  await page.select("#slice-axis", "x");
  await until(page, "window.lapwing.looks.slice.axis === 'x'");
  await setSlider(page, "slice-at", 0.5);
  await until(page, "window.lapwing.looks.slice.at === 0.5");
  await picture("look_03_across");
  await page.click("#slice-on");
  assert.equal(await looks(page, "slice"), null);
}

async function lookAtPlacesLeftOut(page, picture) {
  await page.click("#frame");
  await page.focus("#scan-left-out");
  await page.keyboard.press("Space");
  await until(page, "window.lapwing.looks.leftOut !== null");
  const { reasons } = await looks(page, "leftOut");
  const shown = await legend(page, "left-out-legend");
  for (const { reason, count } of reasons) assert.equal(shown[reason] ?? 0, count, reason);
  for (const reason of ["obstacle", "forbidden", "not_chosen"]) assert.ok(shown[reason] > 0, reason);
  // Those of which there are most are drawn on demand.
  const all = Object.values(shown).reduce((a, b) => a + b);
  assert.equal(await looks(page, "drawnPlaces"), all - shown.outside - (shown.thinned ?? 0));
  await picture("look_04_left_out");
  await page.click('#left-out-legend [data-key="reason-outside"]');
  assert.equal(await looks(page, "drawnPlaces"), all - (shown.thinned ?? 0));
  await page.focus('#left-out-legend [data-key="reason-obstacle"]');
  await page.keyboard.press("Space");
  assert.equal(await looks(page, "drawnPlaces"), all - (shown.thinned ?? 0) - shown.obstacle);
  await page.click("#scan-left-out");
  assert.equal(await looks(page, "leftOut"), null);
}

// The view under the mouse; a click keeps it. A candidate by its number, the view at the play head.
async function lookAtViews(page, picture) {
  const [view] = await page.evaluate(() => window.lapwing.views.slice(2, 3));
  const at = await pageOf(page, view.position);
  await page.mouse.move(at.x + 60, at.y + 60);
  await page.mouse.move(at.x + 2, at.y + 1);
  await until(page, "window.lapwing.looks.view !== null");
  assert.deepEqual((await looks(page, "view")).position, view.position);
  await until(page, "document.querySelector('#view-look-image').naturalWidth > 0");
  await page.mouse.click(at.x + 2, at.y + 1);
  await page.mouse.move(at.x + 150, at.y + 150);
  await frames(page, 3, 300);
  assert.notEqual(await looks(page, "view"), null, "a click keeps it");
  assert.equal((await studioState(page)).time, view.time);
  await page.$eval("#view-look", (e) => e.scrollIntoView());
  const world = await centreOf(page, "#world");
  await page.mouse.move(world.x, world.y);
  for (let i = 0; i < 5; ++i) await page.mouse.wheel({ deltaY: -240 });
  await frames(page, 3, 400);
  await picture("look_05_view");
  const told = await looks(page, "view");
  assert.ok((await words(page, "view-look-words")).includes(`${told.voxels} voxels`));
  assert.ok(told.ways.length > 0);
  await page.keyboard.press("Escape");
  assert.equal(await looks(page, "view"), null);
  await type(page, "#look-candidate", "12");
  await until(page, "window.lapwing.looks.view?.candidate === 11");
  await type(page, "#look-candidate", "100000");
  await until(page, () => /numbers from 1 to 150/.test(document.querySelector("#notes").textContent));
  await page.focus("#look-view");
  await page.keyboard.press("Enter");
  await until(page, "window.lapwing.looks.view?.candidate !== 11");
}

// What the first flight's images show of the ground: as it was flown, while the number of images is
// dragged, after a pattern is changed and removed by keyboard.
async function lookAtFirstFlight(page, picture) {
  await page.click("#frame");
  await page.click("#scan-first");
  await until(page, "window.lapwing.footprints === 40");
  const { revision } = await studioState(page);
  const slider = await page.$('#pattern-list [data-key="views-1"]');
  await slider.evaluate((e) => e.scrollIntoView({ block: "center" }));
  const { x, y, width, height } = await slider.boundingBox();
  const share = await slider.evaluate((e) => (e.value - e.min) / (e.max - e.min));
  const at = x + 8 + share * (width - 16);
  await page.mouse.move(at, y + height / 2);
  await page.mouse.down();
  for (let i = 1; i <= 5; ++i) await page.mouse.move(at + 8 * i, y + height / 2);
  await until(page, "window.lapwing.firstFlight !== null && window.lapwing.footprints > 60");
  const dragged = await page.evaluate(() => window.lapwing.firstFlight.images.length);
  assert.match(await words(page, "first-words"), new RegExp(`^${dragged} images, not flown yet`));
  await picture("look_06_footprints");
  assert.equal((await studioState(page)).revision, revision, "a drag is no edit");
  // Dropped, they are those that were flown.
  await page.keyboard.press("Escape");
  await page.mouse.up();
  await type(page, '#pattern-list [data-key="flights[2].views"]', "12");
  await waitRevision(page, revision + 1);
  await until(page, "window.lapwing.footprints === 32");
  await waitGrade(page, "certified", PLANNED);
  await until(page, "window.lapwing.firstFlight === null && window.lapwing.footprints === 32");
  await page.focus('#pattern-list [data-key="drop-1"]');
  await page.keyboard.press("Enter");
  await waitRevision(page, revision + 2);
  await until(page, "window.lapwing.footprints === 20");
}

export const look = (browser, shot) => served(browser, shot, {
  name: "a look into a scan", picture: "look", script: "examples/scan/church.lua", options,
}, async (page, studio, picture) => {
  await waitGrade(page, "certified", PLANNED);
  await until(page, "window.lapwing.surface > 0");
  // Near a hole, so that voxels are to be seen.
  await page.click("#hole-list .hole");
  await page.$eval("#looks", (e) => e.scrollIntoView());
  await lookAtVoxels(page, picture);
  await lookAtSlices(page, picture);
  await lookAtPlacesLeftOut(page, picture);
  await lookAtViews(page, picture);
  await lookAtFirstFlight(page, picture);
});
