// SPDX-License-Identifier: Apache-2.0
// Runs test/*.test.ts with `node --test`, each bundled with the modules that it reads.
import { build } from "esbuild";
import { spawnSync } from "node:child_process";
import { readdir, rm } from "node:fs/promises";

const names = (await readdir("test")).filter((name) => name.endsWith(".test.ts")).sort();
await rm(".cache/test", { recursive: true, force: true });
await build({
  entryPoints: names.map((name) => `test/${name}`),
  outdir: ".cache/test",
  outExtension: { ".js": ".mjs" },
  bundle: true,
  platform: "node",
  format: "esm",
  target: "node18",
  sourcemap: "inline",
  logLevel: "warning",
});
const built = names.map((name) => `.cache/test/${name.replace(/\.ts$/, ".mjs")}`);
const ran = spawnSync(process.execPath, ["--enable-source-maps", "--test", ...built],
                      { stdio: "inherit" });
process.exit(ran.status ?? 1);
