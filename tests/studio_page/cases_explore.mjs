// SPDX-License-Identifier: Apache-2.0
// An exploration with the studio's own server: stepped through by mouse and by keyboard, the map as
// it grows; changed by keyboard, flown anew, certified and exported.
import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { studioState, type, waitGrade, waitRevision } from "./browser.mjs";
import { lookIntoLive, lookIntoMap, sliceAt } from "./cases_explored.mjs";
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
  await sights(page, picture);
  await lookIntoMap(page, picture);
  await whilePlanned(page, picture);
  await runFolder(page, studio, picture);
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
  // Where the first click meets a house, another one.
  const { x, y } = await page.evaluate((place) => window.lapwing.pageOf(place), start);
  let clicks = 0;
  for (const [right, down] of [[-85, -28], [-60, 60], [-110, 20], [-150, -40], [-30, 110]]) {
    await page.$$eval("#notes button", (all) => all.forEach((close) => close.click()));
    await page.click("#place-start");
    await page.mouse.click(x + right, y + down);
    await waitRevision(page, revision + 1 + ++clicks);
    const next = (await studioState(page)).document.start;
    assert.ok(Math.hypot(next[0] - start[0], next[1] - start[1]) > 1, `${next}`);
    await page.waitForFunction("['certified', 'rejected', 'refused'].includes(window.lapwing.grade)", { timeout: PLANNED });
    if (await page.evaluate("window.lapwing.grade") !== "refused") break;
  }
  await picture("explore_05_start");
  assert.match(await page.$eval("#compare-table", (e) => e.textContent), /Surface found.*Efficiency/s);
  assert.ok(await page.$("#growth-chart .kept"), "the curve of the kept version");
  for (let k = 1; k <= clicks; ++k) {
    await page.click("#undo");
    await waitRevision(page, revision + 1 + clicks + k);
  }
  await waitGrade(page, "certified", PLANNED);
  await page.click("#compare-dialog .close");
  await exported(page);
});

// Image by image while it is planned: it waits, takes one more by mouse and one by keyboard, goes on,
// and is ended by undo. Its figures are those of the exploration that was finished.
async function whilePlanned(page, picture) {
  const live = () => page.evaluate("window.lapwing.live");
  const { revision } = await studioState(page);
  const finished = await page.evaluate("window.lapwing.episode.images");
  await page.click("#tab-setup");
  // Pressed from within the page: a quick machine is done before a mouse has come.
  await page.evaluate(() => {
    const watch = setInterval(() => {
      if (!(window.lapwing.live > 0)) return;
      clearInterval(watch);
      document.querySelector("#pace-pause").click();
    }, 20);
  });
  await type(page, '[data-key="steps"]', "200");
  await page.click("#tab-film");
  await page.waitForFunction("window.lapwing.paused", { timeout: PLANNED });
  await still(page);
  const first = await live();
  assert.ok(first > 0 && first < 200, `${first} images`);
  assert.match(await figures(page), new RegExp(`${first} of 200`));
  assert.ok(await grown(page) > 0);
  await page.click("#pace-step");
  await page.waitForFunction((n) => window.lapwing.live === n, { timeout: PLANNED }, first + 1);
  await page.focus("#pace-step");
  await page.keyboard.press("Enter");
  await page.waitForFunction((n) => window.lapwing.live === n, { timeout: PLANNED }, first + 2);
  await still(page);
  assert.equal(await live(), first + 2);
  await picture("explore_03_live");
  await lookIntoLive(page, picture);
  const taken = await page.evaluate("window.lapwing.episode.images");
  const shared = Math.min(taken.length, finished.length);
  assert.deepEqual(taken.slice(0, shared), finished.slice(0, shared));
  await page.focus("#pace-pause");
  await page.keyboard.press("Enter");
  await page.waitForFunction((n) => window.lapwing.live > n, { timeout: PLANNED }, first + 2);
  await page.click("#pace-pause");
  await page.waitForFunction("window.lapwing.paused");
  await page.click("#undo");
  await waitRevision(page, revision + 2);
  await waitGrade(page, "certified", PLANNED);
  assert.equal(await live(), 0);
  assert.deepEqual(await page.evaluate("window.lapwing.episode.images"), finished);
}

// Until no further image comes: what was under way is told.
async function still(page) {
  for (let before = -1, now = 0; before !== now;) {
    before = now;
    await new Promise((then) => setTimeout(then, 600));
    now = await page.evaluate("window.lapwing.live");
  }
}

// What the view at the play head was chosen by.
async function sights(page, picture) {
  await page.click("#sight summary");
  assert.equal(await page.$$eval("#sight-occupancy canvas", (all) => all.length), 4);
  const slice = () => page.$$eval("#sight-certainty canvas", (all) => all.map((canvas) =>
    canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data.join()).join());
  const before = await slice();
  await page.focus("#explore-rays");
  await page.keyboard.press("Space");
  await page.waitForFunction("window.lapwing.rays > 0");
  assert.match(await page.$eval("#sight-rays", (e) => e.textContent), /of 108 rays met unknown/);
  await picture("explore_02_sight");
  await page.click("#step-on");
  await page.waitForFunction((text) => [...document.querySelectorAll("#sight-certainty canvas")].map((canvas) =>
    canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data.join()).join() !== text,
                             {}, before);
  await page.click("#explore-rays");
}

// The folder of a run is shown without planning; one of another version is refused.
async function runFolder(page, studio, picture) {
  await page.evaluate(() => document.activeElement.blur());
  await page.keyboard.press("r");
  await page.waitForFunction("/Written:.*plan.json/.test(document.querySelector('#notes').textContent)",
                             { timeout: PLANNED });
  const folder = join(studio.dir, "out/explore_city"), told = join(folder, "episode.json");
  const images = await page.evaluate("window.lapwing.episode.images");
  const { revision } = await studioState(page);
  await page.focus("#run-folder");
  await page.waitForSelector('#run-folders option[value="explore_city"]');
  await page.keyboard.type("explore_city");
  await page.keyboard.press("Enter");
  await page.waitForSelector("#run-shown:not([hidden])");
  assert.deepEqual(await page.evaluate("window.lapwing.episode.images"), images);
  await page.waitForFunction("window.lapwing.grown > 0");
  assert.equal((await studioState(page)).grade, "certified");
  assert.equal(await page.$eval("#export", (e) => e.offsetParent), null);
  await page.click("#step-back");
  assert.match(await figures(page), /19 of 20/);
  await picture("explore_04_run");
  const ofRun = await sliceAt(page);
  await page.click("#run-close");
  await page.waitForSelector("#run-shown[hidden]");
  assert.deepEqual(await sliceAt(page), ofRun);
  assert.equal((await studioState(page)).revision, revision);
  const text = readFileSync(told, "utf8");
  for (const [from, to, words] of [[/"program": "lapwing [^"]*"/, '"program": "lapwing 0.0.1"', /written by lapwing 0\.0\.1 .* this is lapwing/],
                                   [/"format": 1/, '"format": 99', /in format 99; this is .* format 1/]]) {
    writeFileSync(told, text.replace(from, to));
    await page.click("#run-open");
    await page.waitForFunction("document.querySelector('#run-said').textContent !== ''");
    assert.match(await page.$eval("#run-said", (e) => e.textContent), words);
    await page.$eval("#run-said", (e) => { e.textContent = ""; });
  }
  writeFileSync(told, text);
}
