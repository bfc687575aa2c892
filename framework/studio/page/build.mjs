// SPDX-License-Identifier: Apache-2.0
// Bundles the page into dist/: index.html, app.js, app.css. `--watch` keeps building.
import { build, context } from "esbuild";
import { copyFile, mkdir, readFile, rm, stat } from "node:fs/promises";

const MOST_BYTES = 1.2e6;
const files = ["index.html", "app.js", "app.css"];

// The licence of what is bundled stays in the bundle, whole.
const licence = await readFile("node_modules/three/LICENSE", "utf8");
const version = JSON.parse(await readFile("node_modules/three/package.json", "utf8")).version;
const banner = `/*!\nthree.js ${version}, parts of which are below:\n${licence}*/`;

const options = {
  entryPoints: { app: "src/main.ts" },
  outdir: "dist",
  bundle: true,
  minify: true,
  format: "iife",
  target: "es2022",
  legalComments: "none",
  banner: { js: banner },
  logLevel: "warning",
};

await rm("dist", { recursive: true, force: true });
await mkdir("dist");
await copyFile("src/index.html", "dist/index.html");
if (process.argv.includes("--watch")) {
  const watching = await context({ ...options, minify: false, sourcemap: "inline" });
  await watching.watch();
} else {
  await build(options);
  let bytes = 0;
  for (const file of files) bytes += (await stat(`dist/${file}`)).size;
  console.log(`dist: ${bytes} bytes of at most ${MOST_BYTES}`);
  if (bytes > MOST_BYTES) process.exit(1);
}
