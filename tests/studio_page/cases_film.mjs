// SPDX-License-Identifier: Apache-2.0
// A film with the studio's own server: opened, changed, certified, flown, exported, undone after a
// restart.
import assert from "node:assert/strict";
import { spawn, spawnSync } from "node:child_process";
import { copyFileSync, existsSync, mkdtempSync, readdirSync, rmSync, statSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { drag, openPage, studioState, waitGrade, waitRevision } from "./browser.mjs";

const here = dirname(fileURLToPath(import.meta.url));
const root = join(here, "../..");
const dist = join(root, "framework/studio/page/dist");

function program() {
  const words = (process.env.LAPWING_STUDIO ?? `${join(root, "build/release/bin/lapwing")} studio`)
    .split(" ");
  if (!existsSync(words[0])) return null;
  if (process.env.LAPWING_STUDIO) return words;
  const asked = spawnSync(words[0], [...words.slice(1), "--help"], { encoding: "utf8" });
  return asked.status === 0 ? words : null;
}

// The program itself, for other commands.
export const lapwing = () => program()[0];
export const hasStudio = () => program() !== null;

// In a folder of its own: journal, layer and what is written stay there.
export async function startStudio(example, folder = null, options = []) {
  const words = program();
  const dir = folder ?? mkdtempSync(join(tmpdir(), "lapwing-studio-"));
  if (!folder) copyFileSync(join(root, example), join(dir, "film.lua"));
  // The address of a studio that was killed is kept there, for the next one.
  const child = spawn(words[0], [...words.slice(1), "film.lua", "--no-open", "--assets", dist, ...options],
                      { cwd: dir, env: { ...process.env, XDG_RUNTIME_DIR: dir } });
  let said = "";
  const address = await new Promise((found, failed) => {
    const hear = (data) => {
      said += data;
      const match = /http:\/\/127\.0\.0\.1:\S+/.exec(said);
      if (match) found(match[0]);
    };
    child.stdout.on("data", hear);
    child.stderr.on("data", hear);
    child.on("exit", (code) => failed(new Error(`the studio ended with ${code}: ${said}`)));
  });
  return {
    address, dir,
    // As by the system: nothing is finished.
    kill: () => new Promise((done) => {
      child.removeAllListeners("exit");
      child.on("exit", done);
      child.kill("SIGKILL");
    }),
    stop: (keep = false) => new Promise((done) => {
      child.on("exit", () => {
        if (!keep) rmSync(dir, { recursive: true, force: true });
        done();
      });
      child.kill("SIGINT");
    }),
  };
}

// kill -9 of the server while the page is open: it finds the next one by itself, and what was edited
// meanwhile arrives.
async function killed(page, studio, started) {
  await waitGrade(page, "certified");
  const { revision } = await studioState(page);
  await studio.kill();
  await page.waitForFunction("document.body.classList.contains('lost')");
  await drag(page, '[data-pin="keyframe-2"]', 30, 0);
  assert.equal((await studioState(page)).pending, 1);
  const { document } = await studioState(page);
  const next = await startStudio(null, studio.dir);
  started(next);
  const begun = Date.now();
  assert.equal(next.address, studio.address);
  await page.waitForFunction("!document.body.classList.contains('lost')", { timeout: 30000 });
  console.log(`${"connected again after kill -9, ms".padEnd(44)} ${Date.now() - begun}   at most 2000`);
  await waitRevision(page, revision + 1);
  assert.deepEqual((await studioState(page)).document, document);
  await waitGrade(page, "certified");
  await page.click("#undo");
  await waitRevision(page, revision + 2);
}

export async function film(browser, shot) {
  if (!program()) {
    console.log("skipped          a film with the studio's own server: no lapwing studio");
    return 0;
  }
  const begun = Date.now();
  let studio = await startStudio("examples/filming/castle_flyover.lua");
  let page = null;
  try {
    page = await openPage(browser, studio.address);
    await waitGrade(page, "certified");
    console.log(`${"first certified curve after the command, ms".padEnd(44)} ${
      Date.now() - begun}   at most 2000`);
    await shot(page, "film_01_opened");
    await drag(page, '[data-pin="keyframe-1"]', 50, 20, { steps: 20, pause: 50, hold: true,
      during: () => shot(page, "film_02_dragged") });
    await page.mouse.up();
    const released = Date.now();
    await waitRevision(page, 1);
    await waitGrade(page, "certified");
    console.log(`${"certified after release, ms".padEnd(44)} ${Date.now() - released}`);
    await shot(page, "film_03_certified");
    await page.click("#play");
    await new Promise((done) => setTimeout(done, 500));
    await shot(page, "film_04_played");
    await page.click("#play");
    await page.click('[data-pin="keyframe-1"]');
    await page.click("#selected-form .field:nth-child(4) input", { count: 3 });
    await page.keyboard.type("4 s");
    await page.keyboard.press("Enter");
    await waitRevision(page, 2);
    await waitGrade(page, "rejected");
    await page.waitForSelector("#checks .check.fail");
    await shot(page, "film_05_too_fast");
    await page.click("#undo");
    await waitRevision(page, 3);
    await waitGrade(page, "certified");
    await page.click("#tab-feel");
    await shot(page, "film_06_weights");
    await page.click("#tab-film");
    await page.click("#fly");
    await page.click("#fly-go");
    await page.waitForFunction("document.querySelector('#fly-result').textContent.includes('Flown:')");
    await shot(page, "film_07_flown");
    await page.click("#fly-dialog .close");
    await page.focus("#world");
    await page.keyboard.press("v");
    await shot(page, "film_08_camera");
    await page.keyboard.press("Escape");
    await page.click("#theme");
    await shot(page, "film_09_dark");
    await page.click("#theme");
    await page.click("#export");
    await page.select("#export-format", "gltf");
    await page.click("#export-go");
    await page.waitForSelector("#export-result .written");
    await shot(page, "film_10_exported");
    const files = await page.$$eval("#export-result code", (all) => all.map((e) => e.textContent));
    for (const file of files) assert.ok(statSync(file).size > 1000, file);   // whole paths
    await page.keyboard.press("Escape");
    const { document } = await studioState(page);
    assert.deepEqual(page.faults, []);
    assert.deepEqual(page.foreign, []);
    await page.close();
    // Stopped and started again: the film is as it was, and undo goes on.
    const { dir } = studio;
    assert.ok(readdirSync(dir).includes("film.studio.yaml"));
    await studio.stop(true);
    studio = await startStudio(null, dir);
    page = await openPage(browser, studio.address);
    assert.deepEqual((await studioState(page)).document, document);
    await page.click("#undo");
    await page.waitForFunction("window.lapwing.document.keyframes[1].position[0] === 0");
    await killed(page, studio, (next) => { studio = next; });
    console.log(`ok      ${String(Date.now() - begun).padStart(5)} ms  a film with the studio's own server`);
    return 0;
  } catch (error) {
    if (page) await shot(page, "film_failed");
    console.log(`FAILED           a film with the studio's own server\n        ${
      String(error.stack ?? error).split("\n").slice(0, 6).join("\n        ")}`);
    return 1;
  } finally {
    await page?.close({ runBeforeUnload: false }).catch(() => {});
    await studio.stop();
  }
}
