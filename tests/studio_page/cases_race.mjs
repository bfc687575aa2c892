// SPDX-License-Identifier: Apache-2.0
// A race with the studio's own server: a gate moved by mouse, turned and copied by keyboard, planned
// and certified, exported.
import assert from "node:assert/strict";
import { statSync } from "node:fs";
import { drag, openPage, studioState, waitGrade, waitRevision } from "./browser.mjs";
import { hasStudio, startStudio } from "./cases_film.mjs";

export async function race(browser, shot) {
  if (!hasStudio()) {
    console.log("skipped          a race with the studio's own server: no lapwing studio");
    return 0;
  }
  const begun = Date.now();
  const studio = await startStudio("examples/racing/seven_gates.lua");
  let page = null;
  try {
    page = await openPage(browser, studio.address);
    await page.evaluate(() => localStorage.setItem("lapwing-hints", "off"));
    await waitGrade(page, "certified", 90000);
    await shot(page, "race_01_opened");
    assert.equal(await page.$$eval(".pin.gate", (all) => all.length), 7);
    // Controls of films are not there.
    assert.equal(await page.$eval("#insert", (e) => e.offsetParent), null);
    const gate = async (n) => (await studioState(page)).document.gates[n - 1];
    const before = await gate(2);
    await drag(page, '[data-pin="gate-1"]', 20, 10, { steps: 10, pause: 30 });
    await waitRevision(page, 1);
    assert.notDeepEqual((await gate(2)).position, before.position);
    assert.equal((await gate(2)).position[2], before.position[2]);
    await waitGrade(page, "certified", 90000);
    await shot(page, "race_02_moved");
    // By keyboard alone: the next gate is selected, turned, and copied.
    await page.focus("#world");
    await page.keyboard.press("]");
    await page.keyboard.down("Alt");
    await page.keyboard.press("ArrowLeft");
    await page.keyboard.up("Alt");
    await waitRevision(page, 2);
    assert.equal((await gate(3)).normal_yaw_deg, -115);
    await page.keyboard.press("d");
    await waitRevision(page, 3);
    assert.equal((await studioState(page)).document.gates.length, 8);
    await page.keyboard.press("Delete");
    await waitRevision(page, 4);
    assert.equal((await studioState(page)).document.gates.length, 7);
    await waitGrade(page, "certified", 90000);
    await shot(page, "race_03_turned");
    // A shape that the gate cannot have so small is told, and the course stays.
    await page.click('[data-pin="gate-6"]');
    await page.select('#selected-form select', "pentagon");
    await waitRevision(page, 5);
    assert.equal((await gate(7)).shape, "pentagon");
    await page.click("#undo");
    await waitRevision(page, 6);
    assert.equal((await gate(7)).shape, "ball");
    await waitGrade(page, "certified", 90000);
    await page.click("#export");
    await page.select("#export-format", "csv");
    await page.click("#export-go");
    await page.waitForSelector("#export-result .written");
    const files = await page.$$eval("#export-result code", (all) => all.map((e) => e.textContent));
    for (const file of files) assert.ok(statSync(file).size > 1000, file);
    assert.deepEqual(page.faults, []);
    assert.deepEqual(page.foreign, []);
    console.log(`ok      ${String(Date.now() - begun).padStart(5)} ms  a race with the studio's own server`);
    return 0;
  } catch (error) {
    if (page) await shot(page, "race_failed");
    console.log(`FAILED           a race with the studio's own server\n        ${
      String(error.stack ?? error).split("\n").slice(0, 6).join("\n        ")}`);
    return 1;
  } finally {
    await page?.close({ runBeforeUnload: false }).catch(() => {});
    await studio.stop();
  }
}
