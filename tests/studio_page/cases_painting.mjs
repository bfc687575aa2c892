// SPDX-License-Identifier: Apache-2.0
// A light painting with the studio's own server: a stroke by mouse in place of a text, another by
// keyboard, planned, certified and exported; the long exposure as it grows.
import assert from "node:assert/strict";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { centreOf, studioState, type, waitGrade, waitRevision } from "./browser.mjs";
import { exported, served } from "./served.mjs";

const root = join(dirname(fileURLToPath(import.meta.url)), "../..");
const PLANNED = 60000;   // ms at most

const exposure = async (page) => {
  await page.waitForFunction("document.querySelector('#photo').hidden === false", { timeout: PLANNED });
  return page.$eval("#photo", (image) => image.src);
};

export const painting = (browser, shot) => served(browser, shot, {
  name: "a light painting with the studio's own server", picture: "painting",
  script: "examples/light_painting/hello.lua",
}, async (page, studio, picture) => {
  await waitGrade(page, "certified", PLANNED);
  const whole = await exposure(page);
  await picture("painting_01_opened");
  const { revision } = await studioState(page);
  await page.click("#draw-stroke");
  const { x, y } = await centreOf(page, "#world");
  await page.mouse.move(x - 60, y);
  await page.mouse.down();
  for (let i = 1; i <= 30; ++i) await page.mouse.move(x - 60 + 5 * i, y - 50 * Math.sin(i / 5));
  await page.mouse.up();
  await waitRevision(page, revision + 1);
  const drawn = (await studioState(page)).document;
  assert.equal(drawn.text, "");
  assert.equal(drawn.strokes.length, 1);
  const count = drawn.strokes[0].points.length / 2;
  assert.ok(count > 5 && count <= 31, String(count));
  await waitGrade(page, "certified", PLANNED);
  // One more by keyboard.
  await page.keyboard.press("Escape");
  await page.focus("#add-stroke");
  await page.keyboard.press("Enter");
  await waitRevision(page, revision + 2);
  assert.equal((await studioState(page)).document.strokes.length, 2);
  await waitGrade(page, "certified", PLANNED);
  const strokes = await exposure(page);
  assert.notEqual(strokes, whole);
  await picture("painting_02_strokes");
  // Half of it, half of the light.
  await page.evaluate(() => document.activeElement.blur());
  await page.keyboard.press("End");
  for (let i = 0; i < 40; ++i) await page.keyboard.press(",");
  assert.notEqual(await exposure(page), strokes);
  await picture("painting_03_half");
  await page.click('[data-key="stroke-1"] button[aria-label^="Delete"]');
  await waitRevision(page, revision + 3);
  await page.click("#undo");
  await waitRevision(page, revision + 4);
  await waitGrade(page, "certified", PLANNED);
  await orderGapsFacing(page, picture);
  // A picture of lines.
  await (await page.$("#svg-file")).uploadFile(join(root, "examples/light_painting/heart.svg"));
  await page.waitForFunction("window.lapwing.document.strokes.length === 1");
  assert.ok((await studioState(page)).document.strokes.length > 0);
  await waitGrade(page, "certified", PLANNED);
  await picture("painting_05_svg");
  await exported(page);
});

// Two strokes with a pause before the second: by keyboard; facing the camera: by mouse. The error of
// the drawing is told.
async function orderGapsFacing(page, picture) {
  const lights = () => page.$$eval("#light-list .what", (all) => all.map((e) => e.textContent));
  assert.deepEqual(await lights(), ["light", "dark", "light"]);
  assert.match(await page.$eval("#drawing-error", (e) => e.textContent),
               /^The light is [\d.]+ mm from the strokes on average as planned, [\d.]+ mm as flown; at most [\d.]+ mm/);
  const dark = async () => Number((await page.$$eval("#light-list .when", (all) => all.map((e) => e.textContent)))[1]
    .replace(" s", ""));
  const before = await dark();
  const { revision } = await studioState(page);
  await page.focus('[data-key="gap"]');
  await type(page, '[data-key="gap"]', "2");
  await waitRevision(page, revision + 1);
  await waitGrade(page, "certified", PLANNED);
  assert.ok(await dark() > Math.max(2, before), `${await dark()} s after ${before} s`);
  await page.select('[data-key="facing"]', "camera");
  await waitRevision(page, revision + 2);
  await waitGrade(page, "certified", PLANNED);
  await page.click('[data-key="reorder"]');
  await waitRevision(page, revision + 3);
  assert.equal((await studioState(page)).document.reorder, false);
  await waitGrade(page, "certified", PLANNED);
  // To the second light by its row.
  await page.click('[data-key="light-2"]');
  assert.ok((await studioState(page)).time > 2);
  await picture("painting_04_gaps");
}
