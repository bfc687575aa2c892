// SPDX-License-Identifier: Apache-2.0
// Reports of runs as files: the studio's page stands in them in place of a still picture, draws
// what was planned, and asks nobody for anything; without scripts the picture is there.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { copyFileSync, mkdtempSync, rmSync, statSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { hasStudio, lapwing } from "./cases_film.mjs";

const root = join(dirname(fileURLToPath(import.meta.url)), "../..");
const MOST_BYTES = 5e6;

// LAPWING_CHURCH=1 plans the church as the example states it, which takes minutes.
const church = process.env.LAPWING_CHURCH ? [] : ["--config", "scan/small", "--set", "resolution=1", "--set", "tour.budget=90"];
const runs = [
  { name: "explore_city", script: "examples/explore/city.lua", options: ["--set", "steps=20"],
    drawn: "window.lapwing.grown > 0" },
  { name: "church", script: "examples/scan/church.lua", options: church,
    drawn: "window.lapwing.surface > 1000" },
];

export async function report(browser, shot) {
  if (!hasStudio()) {
    console.log("skipped          reports with the studio's page: no lapwing");
    return 0;
  }
  let failed = 0;
  for (const run of runs) {
    const begun = Date.now(), dir = mkdtempSync(join(tmpdir(), "lapwing-report-"));
    try {
      const said = await shown(browser, shot, run, dir);
      console.log(`${said.padEnd(8)}${String(Date.now() - begun).padStart(5)} ms  the report of ${run.name}`);
    } catch (error) {
      failed += 1;
      console.log(`FAILED           the report of ${run.name}\n        ${
        String(error.stack ?? error).split("\n").slice(0, 6).join("\n        ")}`);
    } finally {
      rmSync(dir, { recursive: true, force: true });
    }
  }
  return failed;
}

async function shown(browser, shot, { name, script, options, drawn }, dir) {
  copyFileSync(join(root, script), join(dir, "mission.lua"));
  const made = spawnSync(lapwing(), ["run", "mission.lua", "--quiet", ...options],
                         { cwd: dir, encoding: "utf8" });
  assert.equal(made.status, 0, made.stderr);
  const file = join(dir, "out", name, "report.html"), { size } = statSync(file);
  const page = await browser.newPage();
  try {
    const asked = [], faults = [];
    page.on("request", (request) => {
      if (!request.url().startsWith("data:")) asked.push(request.url());
    });
    page.on("pageerror", (error) => faults.push(String(error.stack ?? error)));
    await page.goto(`file://${file}`, { waitUntil: "load" });
    if (!await page.$("#viewer-page")) return "skipped";   // a program without the page
    // Until it is looked at, the picture stands there.
    assert.equal(await page.$("figure.viewed iframe"), null);
    await page.$eval("figure.viewed", (e) => e.scrollIntoView());
    await page.waitForSelector("figure.viewed.drawn", { timeout: 30000 });
    const frame = await (await page.$("figure.viewed iframe")).contentFrame();
    await frame.waitForFunction(drawn, { timeout: 30000 });
    assert.equal(await frame.evaluate("window.lapwing.grade"), "certified");
    assert.equal(await page.$eval("figure.viewed img", (e) => e.checkVisibility()), false);
    // By mouse and by keyboard: another view, another moment; nothing is edited or written.
    const frames = await frame.evaluate("window.lapwing.frames");
    const world = await (await frame.$("#world")).boundingBox();
    await page.mouse.move(world.x + world.width / 2, world.y + world.height / 2);
    await page.mouse.down();
    await page.mouse.move(world.x + world.width / 2 + 60, world.y + world.height / 2 + 10, { steps: 4 });
    await page.mouse.up();
    await frame.waitForFunction((n) => window.lapwing.frames > n, {}, frames);
    const { time } = await frame.evaluate(() => ({ time: window.lapwing.time }));
    await page.keyboard.press("[");
    await frame.waitForFunction((before) => window.lapwing.time < before, {}, time);
    await page.keyboard.press("r");
    assert.match(await frame.$eval("#notes", (e) => e.textContent), /A report can be looked at/);
    assert.equal(await frame.$eval("#export", (e) => e.offsetParent), null);
    await shot(page, `report_${name}`);
    assert.deepEqual(faults, []);
    assert.deepEqual(asked, [`file://${file}`]);
    await page.emulateMediaType("print");
    assert.equal(await page.$eval("figure.viewed img", (e) => e.checkVisibility()), true);
    await page.emulateMediaType(null);
    // Without scripts.
    await page.setJavaScriptEnabled(false);
    await page.goto(`file://${file}`, { waitUntil: "load" });
    assert.ok((await (await page.$("figure.viewed img")).boundingBox()).width > 100);
  } finally {
    await page.close();
  }
  console.log(`${`bytes of the report of ${name}`.padEnd(44)} ${size}   at most ${MOST_BYTES}`);
  assert.ok(size < MOST_BYTES, String(size));
  return "ok";
}
