// SPDX-License-Identifier: Apache-2.0
// An exploration with the studio's own server: stepped through by mouse and by keyboard, the map as
// it grows; changed by keyboard, flown anew, certified and exported.
import assert from "node:assert/strict";
import { centreOf, studioState, type, waitGrade, waitRevision } from "./browser.mjs";
import { exported, served } from "./served.mjs";

const PLANNED = 60000;   // ms at most

const figures = (page) => page.$eval("#step-figures", (e) => e.textContent);
const grown = (page) => page.evaluate("window.lapwing.grown");

export const explore = (browser, shot) => served(browser, shot, {
  name: "an exploration with the studio's own server", picture: "explore",
  script: "examples/explore/city.lua", options: ["--set", "steps=20"],
}, async (page, studio, picture) => {
  await waitGrade(page, "certified", PLANNED);
  await page.waitForFunction("!document.querySelector('#exploration').hidden");
  await page.keyboard.press("End");
  await page.waitForFunction("window.lapwing.grown > 0");
  const all = await grown(page);
  assert.match(await figures(page), /20 of 20/);
  await page.keyboard.press("Home");
  for (let i = 0; i < 5; ++i) await page.click("#step-on");
  const { time } = await studioState(page);
  for (let i = 0; i < 3; ++i) await page.keyboard.press("]");
  assert.match(await figures(page), /8 of 20/);
  assert.ok((await studioState(page)).time > time);
  const some = await grown(page);
  assert.ok(some > 0 && some < all, `${some} of ${all} voxels`);
  await picture("explore_01_step");
  await page.click("#step-back");
  assert.ok(await grown(page) < some);
  await page.click("#explore-candidates");
  await picture("explore_02_candidates");
  // Another start by typing: flown anew.
  const { revision } = await studioState(page);
  await page.click("#tab-setup");
  await type(page, '[data-key="steps"]', "10");
  await waitRevision(page, revision + 1);
  await waitGrade(page, "certified", PLANNED);
  await page.click("#tab-film");
  await page.waitForFunction("/of 10/.test(document.querySelector('#step-figures').textContent)");
  // Another start by a click in the world, beside the version before.
  await page.evaluate(() => document.activeElement.blur());
  await page.keyboard.press("y");
  await page.waitForSelector("#compare-table td");
  const { start } = (await studioState(page)).document;
  await page.click("#place-start");
  const { x, y } = await centreOf(page, "#world");
  await page.mouse.click(x - 120, y + 90);
  await waitRevision(page, revision + 2);
  const next = (await studioState(page)).document.start;
  assert.ok(Math.hypot(next[0] - start[0], next[1] - start[1]) > 1, `${next}`);
  await page.waitForFunction("['certified', 'rejected', 'refused'].includes(window.lapwing.grade)", { timeout: PLANNED });
  await picture("explore_03_start");
  assert.match(await page.$eval("#compare-table", (e) => e.textContent), /Surface found.*Efficiency/s);
  assert.ok(await page.$("#growth-chart .kept"), "the curve of the kept version");
  await page.click("#undo");
  await waitRevision(page, revision + 3);
  await waitGrade(page, "certified", PLANNED);
  await page.click("#compare-dialog .close");
  await exported(page);
});
