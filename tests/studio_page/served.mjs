// SPDX-License-Identifier: Apache-2.0
// A case with the studio's own server, in a folder of its own: started, told, stopped.
import assert from "node:assert/strict";
import { statSync } from "node:fs";
import { openPage } from "./browser.mjs";
import { hasStudio, startStudio } from "./cases_film.mjs";

// Resolves to 1 if the case fails. `then` gets the page, its server and what takes pictures.
export async function served(browser, shot, { name, script, options = [], picture }, then) {
  if (!hasStudio()) {
    console.log(`skipped          ${name}: no lapwing studio`);
    return 0;
  }
  const begun = Date.now();
  const studio = await startStudio(script, null, options);
  let page = null;
  try {
    page = await openPage(browser, studio.address, { wait: false });
    await page.evaluate(() => localStorage.setItem("lapwing-hints", "off"));
    await then(page, studio, (file) => shot(page, file));
    assert.deepEqual(page.faults, []);
    assert.deepEqual(page.foreign, []);
    console.log(`ok      ${String(Date.now() - begun).padStart(5)} ms  ${name}`);
    return 0;
  } catch (error) {
    if (page) await shot(page, `${picture}_failed`);
    for (const fault of page?.faults ?? []) console.log(`        fault of the page: ${fault}`);
    console.log(`FAILED           ${name}\n        ${
      String(error.stack ?? error).split("\n").slice(0, 6).join("\n        ")}`);
    return 1;
  } finally {
    await page?.close({ runBeforeUnload: false }).catch(() => {});
    await studio.stop();
  }
}

// Exports by the dialog, which is closed again; the files, none of which is empty.
export async function exported(page, format = "csv") {
  await page.click("#export");
  await page.select("#export-format", format);
  await page.click("#export-go");
  await page.waitForSelector("#export-result .written");
  const files = await page.$$eval("#export-result code", (all) => all.map((e) => e.textContent));
  assert.ok(files.length > 0);
  for (const file of files) assert.ok(statSync(file).size > 1000, file);
  await page.click("#export-dialog .close");
  return files;
}
