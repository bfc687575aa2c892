// SPDX-License-Identifier: Apache-2.0
// A look into the maps of an exploration: slices and voxels after the image at the play head, of the
// plan, while it is planned, of a run's folder.
import assert from "node:assert/strict";
import { centreOf, frames } from "./browser.mjs";

const PLANNED = 60000;   // ms at most

const looks = (page, what) => page.evaluate((name) => window.lapwing.looks[name], what);
const until = (page, condition, ...more) =>
  page.waitForFunction(condition, { timeout: PLANNED }, ...more);
const shownImage = (page) => page.$eval("#step-figures dd", (e) => Number.parseInt(e.textContent, 10));
const sliceAfter = (page, image) => until(page, (n) => window.lapwing.looks.slice?.image === n, image);

async function sliceOn(page, on) {
  await page.$eval("#slice-on", (e) => e.scrollIntoView({ block: "center" }));
  if (await page.$eval("#slice-on", (e) => e.checked) === on) return;
  await page.focus("#slice-on");
  await page.keyboard.press("Space");
}

// By keyboard and by mouse; slice and voxel follow the play head.
export async function lookIntoMap(page, picture) {
  await page.click("#frame");
  const image = await shownImage(page);
  await sliceOn(page, true);
  await sliceAfter(page, image);
  const slice = await looks(page, "slice");
  for (const state of ["free", "occupied", "unknown"]) assert.ok(slice.counts[state] > 0, state);
  const legend = await page.$$eval("#slice-legend li", (all) => all.map((e) =>
    [e.dataset.key, Number(e.querySelector(".when").textContent)]));
  assert.deepEqual(Object.fromEntries(legend), slice.counts);
  const { x, y } = await centreOf(page, "#world");
  await page.mouse.click(x, y);
  await until(page, "window.lapwing.looks.voxel !== null");
  const voxel = await looks(page, "voxel");
  assert.equal(voxel.image, image);
  assert.ok(Math.abs(voxel.middle[2] - slice.at) < 1e-6, "the voxel of the slice");
  const words = await page.$eval("#voxel-words", (e) => e.textContent);
  assert.match(words, /Known from(not yet|the start|image \d+)/);
  await frames(page, 2, 300);
  await picture("explore_06_slice");
  // Another image: the same slice, the same voxel.
  await page.click("#step-back");
  await sliceAfter(page, image - 1);
  await until(page, (n) => window.lapwing.looks.voxel?.image === n, image - 1);
  assert.deepEqual((await looks(page, "voxel")).key, voxel.key);
  const before = await looks(page, "slice");
  assert.ok(before.counts.unknown !== slice.counts.unknown || before.columns !== slice.columns);
  await page.click("#step-on");
  await sliceAfter(page, image);
  assert.deepEqual((await looks(page, "slice")).counts, slice.counts);
  // Across, and by the slider.
  await page.select("#slice-axis", "y");
  await until(page, "window.lapwing.looks.slice.axis === 'y'");
  const { at } = await looks(page, "slice");
  await page.focus("#slice-at");
  await page.keyboard.press("ArrowRight");
  await until(page, (was) => window.lapwing.looks.slice.at > was, at);
  await frames(page, 2, 300);
  await picture("explore_07_across");
  await page.select("#slice-axis", "z");
  await until(page, "window.lapwing.looks.slice.axis === 'z'");
  // Enter clicks on the middle of the view, Escape drops what was clicked at.
  await page.focus("#world");
  await page.keyboard.press("Escape");
  assert.equal(await looks(page, "voxel"), null);
  await page.keyboard.press("Enter");
  await until(page, "window.lapwing.looks.voxel !== null");
  await page.keyboard.press("Escape");
  await sliceOn(page, false);
  assert.equal(await looks(page, "slice"), null);
  // Without a slice the first occupied voxel under the mouse is meant: that of the trees.
  for (const [right, down] of [[0, -12], [12, -20], [100, 40], [-40, 30]]) {
    await page.mouse.click(x + right, y + down);
    await frames(page, 2, 500);
    if (await looks(page, "voxel")) break;
  }
  assert.equal((await looks(page, "voxel"))?.state, "occupied");
  await page.keyboard.press("Escape");
}

// The map as far as the planning has come, while it waits.
export async function lookIntoLive(page, picture) {
  const image = await page.evaluate("window.lapwing.live");
  await sliceOn(page, true);
  await sliceAfter(page, image);
  await frames(page, 2, 300);
  await picture("explore_08_live_slice");
  await page.click("#step-back");
  await sliceAfter(page, image - 1);
  await page.click("#step-on");
  await sliceAfter(page, image);
  await sliceOn(page, false);
}

// A run's folder has the maps of the plan that it is the run of.
export async function sliceAt(page) {
  await sliceOn(page, true);
  await sliceAfter(page, await shownImage(page));
  const { image, counts, lower, at } = await looks(page, "slice");
  await sliceOn(page, false);
  return { image, counts, lower, at };
}
