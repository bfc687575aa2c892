// SPDX-License-Identifier: Apache-2.0
// What is measured: page ready, a frame with ten thousand voxels and a path, a step of scrubbing.
import { openPage, waitGrade } from "./browser.mjs";
import { startMock } from "./mock_server.mjs";

const median = (list) => [...list].sort((a, b) => a - b)[list.length >> 1];

// The faces of `count` voxels of half a metre that no other voxel hides: a hilly floor with towers.
export function voxelBlob(count) {
  const size = 0.5, side = Math.ceil(Math.sqrt(count / 2));
  const height = (i, j) => 1 + Math.round(1 + Math.sin(i / 5) * Math.cos(j / 7));
  const filled = new Set();
  for (let i = 0; i < side && filled.size < count; ++i) {
    for (let j = 0; j < side && filled.size < count; ++j) {
      for (let k = 0; k < height(i, j) && filled.size < count; ++k) filled.add(`${i},${j},${k}`);
    }
  }
  for (let k = 3; filled.size < count; ++k) {
    for (let i = 0; i < side && filled.size < count; i += 4) filled.add(`${i},${i},${k}`);
  }
  const faces = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];
  const points = [], triangles = [];
  for (const text of filled) {
    const cell = text.split(",").map(Number);
    for (const face of faces) {
      if (filled.has(cell.map((v, a) => v + face[a]).join())) continue;
      const axis = face.findIndex((v) => v !== 0), u = (axis + 1) % 3, w = (axis + 2) % 3;
      const at = points.length / 3;
      for (const [a, b] of [[0, 0], [1, 0], [1, 1], [0, 1]]) {
        const corner = cell.slice();
        if (face[axis] > 0) corner[axis] += 1;
        corner[u] += a;
        corner[w] += b;
        points.push((corner[0] - side / 2) * size, (corner[1] - side / 2) * size, corner[2] * size - 3);
      }
      const turn = face[axis] > 0 ? [0, 1, 2, 0, 2, 3] : [0, 2, 1, 0, 3, 2];
      triangles.push(...turn.map((k) => at + k));
    }
  }
  const bytes = Buffer.alloc(16 + 4 * points.length + 4 * triangles.length);
  bytes.write("WLB1");
  bytes.writeUInt32LE(points.length / 3, 4);
  bytes.writeUInt32LE(triangles.length / 3, 8);
  points.forEach((v, i) => bytes.writeFloatLE(v, 16 + 4 * i));
  triangles.forEach((v, i) => bytes.writeUInt32LE(v, 16 + 4 * points.length + 4 * i));
  return { bytes, voxels: filled.size };
}

// A map of so many voxels: until it is drawn, a frame in full (which may take at most so long), a
// frame while the view moves, and what the page holds.
async function large(browser, count, most) {
  const { bytes, voxels } = voxelBlob(count);
  const mock = await startMock({ world: (put) => ({
    obstacles: [{ name: "castle", shape: "sphere" }, { name: "map", shape: "map", blob: put(bytes) }],
    bounds: {} }) });
  const page = await openPage(browser, mock.address, { wait: false });
  await page.waitForFunction(() => window.lapwing?.triangles > 50000, { timeout: 60000, polling: 20 });
  const shown = await page.evaluate(async () => {
    window.lapwing.measure(true);
    window.lapwing.redraw();
    await window.lapwing.drawn();
    return performance.now();
  });
  const frames = (moving) => page.evaluate(async (move) => {
    const times = [];
    for (let i = 0; i < 8; ++i) {
      if (move) window.lapwing.move();
      else window.lapwing.redraw();
      times.push(await window.lapwing.drawn());
    }
    return times.slice(2);
  }, moving);
  await new Promise((then) => setTimeout(then, 600));
  const full = median(await frames(false));
  const moving = median(await frames(true));
  const client = await page.createCDPSession();
  const heap = await client.send("Runtime.getHeapUsage");
  const held = (heap.usedSize + (heap.backingStorageSize ?? 0)) / 2 ** 20;
  await page.close();
  await mock.stop();
  const of = `${voxels} voxels`;
  return [[`${of}: until they are drawn, ms`, shown, 5000],
          [`${of}: a frame, ms`, full, most ?? Infinity],
          [`${of}: a frame while the view moves, ms`, moving, 60],
          [`${of}: memory of scripts, MiB`, held, 1024]];
}

export async function figures(browser) {
  const { bytes, voxels } = voxelBlob(10000);
  const rows = [];
  const plain = await startMock();
  const ready = [], certified = [];
  for (let i = 0; i < 3; ++i) {
    const page = await openPage(browser, plain.address, { wait: false });
    await page.waitForFunction("document.querySelectorAll('.pin').length > 0", { polling: 5 });
    ready.push(await page.evaluate("performance.now()"));
    await waitGrade(page, "certified");
    certified.push(await page.evaluate("performance.now()"));
    await page.close();
  }
  await plain.stop();
  rows.push(["page ready, ms", median(ready), 1000]);
  rows.push(["first certified curve on the page, ms", median(certified), 2000]);

  const mock = await startMock({ world: (put) => ({
    obstacles: [{ name: "castle", shape: "sphere" }, { name: "map", shape: "map", blob: put(bytes) }],
    bounds: {} }) });
  const page = await openPage(browser, mock.address);
  await waitGrade(page, "certified");
  await page.waitForNetworkIdle({ idleTime: 300 });
  const frames = await page.evaluate(async () => {
    const times = [];
    window.lapwing.measure(true);
    for (let i = 0; i < 14; ++i) {
      window.lapwing.redraw();
      times.push(await window.lapwing.drawn());
    }
    return times.slice(4);
  });
  rows.push([`a frame with ${voxels} voxels, ms`, median(frames), 60]);
  const scrubs = await page.evaluate(async () => {
    const head = document.getElementById("play-head"), times = [];
    for (let i = 0; i < 14; ++i) {
      const start = performance.now(), drawn = window.lapwing.drawn();
      head.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowRight", bubbles: true }));
      await drawn;
      times.push(performance.now() - start);
      await new Promise((done) => setTimeout(done, 60));    // twelve a second or so
    }
    return times.slice(4);
  });
  rows.push(["a step of scrubbing, ms", median(scrubs), 50]);
  await page.close();
  await mock.stop();
  rows.push(...await large(browser, 100000, 400), ...await large(browser, 1000000, null));
  let failed = 0;
  for (const [what, value, most] of rows) {
    console.log(`${what.padEnd(44)} ${value.toFixed(1)}   at most ${most}`);
    if (value > most) failed += 1;
  }
  return failed;
}
