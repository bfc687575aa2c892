// SPDX-License-Identifier: Apache-2.0
// What is installed and what is shipped; run in the folder of the page.
import assert from "node:assert/strict";
import { existsSync, readFileSync } from "node:fs";
import { test } from "node:test";

test("lock files name packages by version and checksum, and no host", () => {
  for (const folder of [".", "../../../tests/studio_page"]) {
    const text = readFileSync(`${folder}/package-lock.json`, "utf8");
    const lock = JSON.parse(text) as { packages: Record<string, { version?: string; integrity?: string;
                                                                  resolved?: string }> };
    for (const [name, one] of Object.entries(lock.packages)) {
      if (name === "") continue;
      assert.ok(one.version && one.integrity, name);
      assert.equal(one.resolved, undefined, name);
    }
    const { dependencies, devDependencies } = JSON.parse(
      readFileSync(`${folder}/package.json`, "utf8")) as Record<string, Record<string, string>>;
    for (const version of Object.values({ ...dependencies, ...devDependencies })) {
      assert.match(version, /^\d+\.\d+\.\d+$/);
    }
  }
});

test("the licence of three.js is at the head of what is shipped", (context) => {
  if (!existsSync("dist/app.js")) return context.skip("not built");
  const head = readFileSync("dist/app.js", "utf8").slice(0, 2000);
  assert.match(head, /three\.js 0\.187\.0/);
  assert.match(head, /Permission is hereby granted/);
  assert.match(head, /AS IS/);
});

test("the page has no inline script, no inline style and no other host", () => {
  const page = readFileSync("src/index.html", "utf8");
  assert.doesNotMatch(page, /<script(?![^>]*src=)/);
  assert.doesNotMatch(page, /\sstyle=|<style|\son[a-z]+=|https?:\/\//);
});
