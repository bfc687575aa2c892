// SPDX-License-Identifier: Apache-2.0
// Drives the page in a browser: node run.mjs [--only WORDS] [--shots DIR]. Prints a row per case and
// the figures; exit status 1 if one fails, 77 where there is no Chromium.
import { mkdirSync, readdirSync, statSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { chromium, openPage, startBrowser, waitGrade } from "./browser.mjs";
import { backdrop } from "./cases_backdrop.mjs";
import { edits } from "./cases_edit.mjs";
import { explore } from "./cases_explore.mjs";
import { film } from "./cases_film.mjs";
import { look } from "./cases_look.mjs";
import { links } from "./cases_link.mjs";
import { painting } from "./cases_painting.mjs";
import { race } from "./cases_race.mjs";
import { report } from "./cases_report.mjs";
import { scan } from "./cases_scan.mjs";
import { views } from "./cases_view.mjs";
import { worlds } from "./cases_world.mjs";
import { figures } from "./figures.mjs";
import { startMock } from "./mock_server.mjs";

const here = dirname(fileURLToPath(import.meta.url));
const option = (name) => {
  const at = process.argv.indexOf(name);
  return at < 0 ? null : process.argv[at + 1];
};
const only = option("--only"), shots = option("--shots");
const MOST_SECONDS = 320;

if (!chromium()) {
  console.log("skipped: no Chromium; apt-get install chromium, or name one in CHROMIUM");
  process.exit(77);
}
if (shots) mkdirSync(shots, { recursive: true });

const start = Date.now();
// Two at a time: most of a case is waiting. Those that measure time come last, alone.
const LANES = 2;
const browsers = await Promise.all(Array.from({ length: LANES }, startBrowser));
let failed = 0, foreign = 0;
// No browser outlives its tests.
process.on("uncaughtException", async (error) => {
  console.error(error);
  await Promise.all(browsers.map((browser) => browser.close().catch(() => {})));
  process.exit(1);
});

async function run(browser, name, then) {
  const began = Date.now();
  const mock = await startMock();
  let page = null;
  try {
    page = await openPage(browser, mock.address);
    await page.evaluate(() => localStorage.setItem("lapwing-hints", "off"));
    await waitGrade(page, "certified");
    const shot = async (file) => {
      if (shots) await page.screenshot({ path: join(shots, `${file}.png`) });
    };
    await then({ browser, page, mock, shot });
    foreign += page.foreign.length;
    if (page.foreign.length > 0) throw new Error(`foreign requests: ${page.foreign}`);
    if (page.faults.length > 0) throw new Error(`faults of the page: ${page.faults.join("\n")}`);
    console.log(`ok      ${String(Date.now() - began).padStart(5)} ms  ${name}`);
  } catch (error) {
    failed += 1;
    console.log(`FAILED  ${String(Date.now() - began).padStart(5)} ms  ${name}\n        ${
      String(error.stack ?? error).split("\n").slice(0, 6).join("\n        ")}`);
    if (shots && page) await page.screenshot({ path: join(shots, `failed_${failed}.png`) });
  } finally {
    await page?.close({ runBeforeUnload: false });
    await mock.stop();
  }
}

try {
  const wanted = [...edits, ...worlds, ...views, ...links].filter(([name]) => !only || name.includes(only));
  const together = wanted.filter(([, , how]) => how !== "alone");
  await Promise.all(browsers.map(async (browser) => {
    for (let next = together.shift(); next; next = together.shift()) {
      await run(browser, next[0], next[1]);
    }
  }));
  for (const [name, then] of wanted.filter(([, , how]) => how === "alone")) {
    await run(browsers[0], name, then);
  }
  const shot = async (page, file) => {
    if (shots) await page.screenshot({ path: join(shots, `${file}.png`) });
  };
  // With servers of their own; that of the film measures times.
  const served = Object.entries({ scan, look, backdrop, race, painting, explore, report })
    .filter(([name]) => !only || only === name);
  await Promise.all(browsers.map(async (browser) => {
    for (let next = served.shift(); next; next = served.shift()) {
      const failures = await next[1](browser, shot);
      failed += failures;
    }
  }));
  await Promise.all(browsers.slice(1).map((browser) => browser.close()));
  if (!only || only === "film") failed += await film(browsers[0], shot);
  if (!only || only === "figures") failed += await figures(browsers[0]);
} finally {
  await Promise.all(browsers.map((browser) => browser.close()));
}

const dist = join(here, "../../framework/studio/page/dist");
const bytes = readdirSync(dist).reduce((sum, file) => sum + statSync(join(dist, file)).size, 0);
const seconds = (Date.now() - start) / 1000;
const rows = [["bytes of the page", bytes, 1.2e6], ["foreign requests", foreign, 0],
              ["seconds of the whole run", Math.round(seconds * 10) / 10, MOST_SECONDS]];
for (const [what, value, most] of rows) {
  console.log(`${what.padEnd(44)} ${value}   at most ${most}`);
  if (value > most) failed += 1;
}
console.log(failed === 0 ? "all passed" : `${failed} failed`);
process.exit(failed === 0 ? 0 : 1);
