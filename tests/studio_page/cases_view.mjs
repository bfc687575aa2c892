// SPDX-License-Identifier: Apache-2.0
// Looking, playing, judging and writing, each once by mouse and once by keyboard.
import assert from "node:assert/strict";
import { centreOf, drag, studioState, type, waitGrade } from "./browser.mjs";
import { keys, next } from "./cases_edit.mjs";

const wait = (ms) => new Promise((done) => setTimeout(done, ms));
const shown = (page, selector) => page.$eval(selector, (e) => !e.hidden && e.offsetParent !== null);
const text = (page, selector) => page.$eval(selector, (e) => e.textContent);

export const views = [
  ["guides that are drawn again are the same", async ({ page }) => {
    const drawn = async (reset) => {
      await page.evaluate((anew) => {
        const canvas = document.getElementById("guides");
        // Drops what earlier drawings have left.
        if (anew) canvas.setAttribute("width", String(canvas.width));
      }, reset);
      await keys(page, "g");
      await keys(page, "g");
      return page.evaluate(() => document.getElementById("guides").toDataURL());
    };
    const first = await drawn(true);
    assert.equal(await drawn(false), first);
    assert.equal(await drawn(false), first);
  }],
  ["a keyframe placed 5 km away, and brought back, stays in the view", async ({ page, shot }) => {
    for (const x of ["5 km", "0"]) {
      await page.focus('[data-pin="keyframe-1"]');
      await keys(page, "Enter");
      const { document } = await next(page, async () => {
        await keys(page, "Control+a");
        await page.keyboard.type(x);
        await keys(page, "Enter");
      });
      await page.evaluate(async () => {
        window.lapwing.redraw();
        await window.lapwing.drawn();
      });
      const pins = await page.$$eval('[data-pin^="keyframe"]', (all) => all.map((p) => !p.hidden));
      assert.deepEqual(new Set(pins), new Set([true]), `${x}: ${pins}`);
      const [eye, farthest] = await page.evaluate(() => [window.lapwing.eye, window.lapwing.farthest]);
      for (const { position } of document.keyframes) {
        const away = Math.hypot(...position.map((v, i) => v - eye[i]));
        assert.ok(away < farthest, `${away} m away, drawn to ${farthest} m`);
      }
      await shot(x === "0" ? "brought_back" : "far_away");
    }
  }],
  ["the map shows a place and what is above it as one, and is left to fly", async ({ page, shot }) => {
    await page.evaluate(() => document.activeElement.blur());
    const before = await page.evaluate("window.lapwing.eye");
    await keys(page, "e");
    const far = await page.evaluate(async () => {
      window.lapwing.redraw();
      await window.lapwing.drawn();
      const rect = document.querySelector("#world").getBoundingClientRect();
      let most = 0;
      for (let x = -40; x <= 40; x += 4) for (let y = -40; y <= 40; y += 4) {
        const [low, high] = [0, 30].map((z) => window.lapwing.pageOf([x, y, z]));
        if (low.x < rect.left || low.x > rect.right || low.y < rect.top || low.y > rect.bottom) continue;
        most = Math.max(most, Math.hypot(low.x - high.x, low.y - high.y));
      }
      return most;
    });
    assert.ok(far > 0 && far < 1, `${far} pixels apart`);
    await shot("map");
    const { revision } = await studioState(page);
    await keys(page, "k");
    await page.waitForFunction(() => /no camera position/.test(document.querySelector("#notes").textContent));
    assert.equal((await studioState(page)).revision, revision);
    const pressed = () => page.$eval("#map", (e) => e.getAttribute("aria-pressed"));
    const eye = () => page.evaluate("window.lapwing.eye");
    await keys(page, "v");
    assert.equal(await pressed(), "false");
    assert.ok((await eye())[2] < 200);
    // And from flying into the map, and back to where one was.
    await page.click("#map");
    assert.equal(await pressed(), "true");
    assert.ok((await eye())[2] > 1000);
    assert.equal(await page.$eval("#fly-camera", (e) => e.getAttribute("aria-pressed")), "false");
    await page.click("#map");
    (await eye()).forEach((v, k) => assert.ok(Math.abs(v - before[k]) < 0.01, `${v}, ${before}`));
  }],
  ["played, scrubbed and sped up by mouse", async ({ page }) => {
    await page.click("#rate-two");
    await page.click("#play");
    const start = Date.now();
    await page.waitForFunction("window.lapwing.time > 0.4");
    await page.click("#play");
    const { time } = await studioState(page);
    assert.ok(time < 2.2 * (Date.now() - start) / 1000 + 0.5, String(time));
    assert.equal(await page.$eval("#play", (b) => b.getAttribute("aria-label")), "Play");
    const box = await (await page.$("#lanes")).boundingBox();
    await page.mouse.click(box.x + 92 + (box.width - 106) / 2, box.y + 40);
    assert.ok(Math.abs((await studioState(page)).time - 10) < 0.2);
    await page.click("#to-start");
    assert.equal((await studioState(page)).time, 0);
  }, "alone"],
  ["played, scrubbed and slowed down by keyboard", async ({ page }) => {
    await page.focus("#world");
    await keys(page, "1", "Space");
    const start = Date.now();
    await page.waitForFunction("window.lapwing.time > 0.1");
    await keys(page, "Space");
    const { time } = await studioState(page);
    assert.ok(time < 0.55 * (Date.now() - start) / 1000 + 0.2, String(time));
    await keys(page, "End");
    assert.equal((await studioState(page)).time, 20);
    await keys(page, "Home", ".", ".", ",");
    assert.ok(Math.abs((await studioState(page)).time - 0.1) < 1e-9);
    await keys(page, "ArrowRight");
    assert.ok(Math.abs((await studioState(page)).time - 0.2) < 1e-9);
  }, "alone"],
  ["a time dragged by mouse, and moved by keyboard", async ({ page }) => {
    await next(page, () => drag(page, ".mark-keyframe:nth-of-type(2)", 60, 0));
    const { document } = await studioState(page);
    assert.ok(document.keyframes[1].time > 11, String(document.keyframes[1].time));
    await page.focus(".mark-keyframe:nth-of-type(3)");
    const later = await next(page, () => keys(page, "Alt+ArrowRight"));
    assert.equal(later.document.keyframes[2].time, 20.1);
    assert.equal(later.document.duration, 20.1);
  }],
  ["cut and uncut by mouse, and by keyboard", async ({ page }) => {
    let now = await next(page, () => page.click("#cut"));
    assert.deepEqual(now.document.cuts, [{ start: 0, finish: 1 }]);
    now = await next(page, () => page.click(".mark-cut"));
    assert.deepEqual(now.document.cuts, []);
    await page.focus("#world");
    now = await next(page, () => keys(page, "c"));
    assert.equal(now.document.cuts.length, 1);
    await page.focus(".mark-cut");
    now = await next(page, () => keys(page, "Enter"));
    assert.deepEqual(now.document.cuts, []);
  }],
  ["what fails is red, told, gone to and mended, by mouse", async ({ page, shot }) => {
    await page.click('[data-pin="keyframe-1"]');
    await next(page, () => type(page, '[data-key="keyframes[2].time"]', "3"));
    await waitGrade(page, "rejected");
    assert.match(await text(page, "#grade-text"), /places? on the path/);
    await page.click('#checks .check.fail[data-key="climb_speed"]');
    const { time } = await studioState(page);
    assert.ok(time > 0.5 && time < 4, String(time));
    assert.match(await text(page, ".mend"), /times slower/);
    await shot("rejected");
    const before = (await studioState(page)).document.duration;
    const mended = await next(page, () => page.click("#checks .mend button"));
    assert.ok(mended.document.duration > before);
  }],
  ["the certificate gone through by keyboard", async ({ page }) => {
    await page.focus('#checks [data-key="speed_across"]');
    await keys(page, "Enter");
    assert.ok((await studioState(page)).time > 1);
  }],
  ["flown with wind by mouse, the ghost beside it", async ({ page, mock, shot }) => {
    await page.click("#fly");
    await page.click("#fly-go");
    await page.waitForFunction("document.querySelector('#fly-result').textContent.includes('m beside')");
    const flight = mock.state.received.filter((m) => m.type === "fly").pop();
    assert.deepEqual(flight.wind.map(Math.round), [0, -3, 0]);
    assert.match(await text(page, "#fly-result"), /\u2713 Flown: at most 0\.18 m/);
    await shot("flown");
    await page.click("#fly-dialog .close");
  }],
  ["flown with wind by keyboard", async ({ page, mock }) => {
    await page.focus("#world");
    await keys(page, "f");
    await keys(page, ...Array(4).fill("ArrowRight"), "Tab", "Tab", "ArrowRight");
    await page.focus("#fly-go");
    await keys(page, "Enter");
    await page.waitForFunction("document.querySelector('#fly-result').textContent.includes('m beside')");
    const flight = mock.state.received.filter((m) => m.type === "fly").pop();
    assert.equal(flight.wind[1], -5);
    assert.match(await text(page, "#fly-result"), /Blown off the path: at most 0\.3 m/);
    assert.equal(flight.gust, 0.5);
    await keys(page, "Escape");
    assert.equal(await page.$eval("#fly-dialog", (d) => d.open), false);
  }],
  ["an uncertified film is not flown", async ({ page, mock }) => {
    await page.click('[data-pin="keyframe-1"]');
    await next(page, () => type(page, '[data-key="keyframes[2].time"]', "2"));
    await waitGrade(page, "rejected");
    await page.click("#fly");
    assert.equal(await page.$eval("#fly-go", (b) => b.disabled), true);
    assert.ok(await shown(page, "#fly-warning"));
    await page.click("#fly-dialog .close");
    await page.click("#export");
    assert.equal(await page.$eval("#export-go", (b) => b.disabled), true);
    await page.click("#export-uncertified");
    await page.click("#export-go");
    await page.waitForSelector("#export-result .written");
    assert.equal(mock.state.received.filter((m) => m.type === "export").pop().uncertified, true);
    await page.click("#export-dialog .close");
  }],
  ["weights by mouse and by keyboard, a style", async ({ page, shot }) => {
    await page.click("#tab-feel");
    const slider = await centreOf(page, '[data-key="weight-smoothness"]');
    let now = await next(page, () => page.mouse.click(slider.x + 60, slider.y));
    assert.ok(now.document.weights.smoothness > 10);
    await page.focus('[data-key="weight-yaw"]');
    now = await next(page, () => keys(page, "ArrowRight"));
    assert.ok(now.document.weights.yaw > 0.02);
    await waitGrade(page, "certified");
    const shares = await page.$$eval("#weights .share", (all) => all.map((e) => e.textContent));
    assert.ok(shares.filter(Boolean).length >= 3, shares.join());
    await shot("weights");
    now = await next(page, () => page.click("#styles button:nth-child(2)"));
    assert.equal(now.document.weights.yaw, 1);
  }],
  ["drone, camera, solver and forms, by mouse and by keyboard", async ({ page }) => {
    await page.focus("#tab-film");
    await keys(page, "ArrowRight", "ArrowRight");
    assert.ok(await shown(page, "#panel-setup"));
    let now = await next(page, () => page.select('[data-key="vehicle"]', "vehicles/phantom"));
    assert.equal(now.document.vehicle, "vehicles/phantom");
    now = await next(page, () => page.select('[data-key="camera"]', "cameras/one_inch"));
    assert.equal(now.document.vehicle.camera, "cameras/one_inch");
    await page.click("#solver-box summary");
    now = await next(page, () => type(page, '[data-key="solver.iterations"]', "30"));
    assert.equal(now.document.solver.iterations, 30);
    now = await next(page, () => type(page, '[data-key="margin"]', "80 cm"));
    assert.equal(now.document.margin, 0.8);
    await type(page, '[data-key="margin"]', "-1");
    assert.match(await text(page, "#setup-film .field-error:not([hidden])"), /at least 0/);
  }],
  ["exported by mouse, with the loss", async ({ page, mock, shot }) => {
    await page.click("#export");
    await page.select("#export-format", "chan");
    await type(page, '#export-form [data-key="rate"]', "30");
    await page.click("#export-go");
    await page.waitForSelector("#export-result .written");
    assert.match(await text(page, "#export-result"), /castle\.chan.*ground is left out/s);
    assert.deepEqual(mock.state.received.filter((m) => m.type === "export").pop().parameters,
                     { rate: 30 });
    await shot("exported");
    await page.select("#export-format", "csv");
    await type(page, '#export-form [data-key="rate"]', "13");
    await page.click("#export-go");
    await page.waitForFunction("document.querySelector('#export-result').textContent.includes('disk')");
    await page.click("#export-dialog .close");
  }],
  ["exported, reported and written as a script by keyboard", async ({ page, mock }) => {
    await page.focus("#world");
    await keys(page, "x");
    await page.select("#export-format", "gltf");
    await page.focus("#export-go");
    await keys(page, "Enter");
    await page.waitForSelector("#export-result .written");
    await page.select("#export-format", "Lua script");
    await page.focus("#export-go");
    await keys(page, "Enter");
    await page.waitForFunction("document.querySelector('#export-result').textContent.includes('lua')");
    await keys(page, "Escape");
    await page.focus("#world");
    await keys(page, "r");
    await page.waitForFunction("document.querySelector('#notes').textContent.includes('report.html')");
    assert.ok(mock.state.received.some((m) => m.type === "export_lua"));
  }],
  ["the sheet of keys by mouse and by keyboard", async ({ page, shot }) => {
    await page.click("#help");
    assert.ok((await page.$$("#help-keys dt")).length > 25);
    await shot("help");
    await keys(page, "Escape");
    await page.focus("#world");
    await keys(page, "?");
    assert.equal(await page.$eval("#help-dialog", (d) => d.open), true);
    await page.click("#help-dialog .close");
  }],
  ["light and dark, guides, everything in view, by mouse and by keyboard", async ({ page, shot }) => {
    const dark = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
    const before = await dark();
    await page.click("#theme");
    assert.notEqual(await dark(), before);
    await wait(100);
    await shot("dark");
    await page.focus("#world");
    await keys(page, "t");
    assert.equal(await dark(), before);
    const ink = () => page.evaluate(() => {
      const c = document.getElementById("guides");
      return c.getContext("2d").getImageData(0, 0, c.width, c.height).data.some((v) => v > 0);
    });
    assert.equal(await ink(), true);
    await keys(page, "g");
    assert.equal(await ink(), false);
    await page.click("#picture-controls label:nth-of-type(1) input");
    assert.equal(await ink(), true);
    const { x, y } = await centreOf(page, "#world");
    const at = () => page.$eval('[data-pin="keyframe-1"]', (e) => e.style.transform);
    const home = await at();
    await page.mouse.move(x - 150, y + 60);
    await page.mouse.wheel({ deltaY: 600 });
    await wait(150);
    assert.notEqual(await at(), home);
    await page.click("#frame");
    await wait(150);
    assert.equal(await at(), home);
    await page.mouse.move(x - 150, y + 60);
    await page.mouse.wheel({ deltaY: 600 });
    await wait(150);
    await page.focus("#world");
    await keys(page, "z");
    await wait(150);
    assert.equal(await at(), home);
  }],
  ["a picture is asked for on pause, and put away when the head moves", async ({ page, mock }) => {
    await page.waitForFunction("!document.querySelector('#photo').hidden", { timeout: 3000 });
    const asked = mock.state.received.filter((m) => m.type === "picture").pop();
    assert.ok(asked.width > 200 && asked.height > 100);
    await page.focus("#world");
    await keys(page, ".");
    assert.equal(await page.$eval("#photo", (p) => p.hidden), true);
  }],
  ["every control has a name", async ({ page }) => {
    await page.click('[data-pin="keyframe-1"]');
    const tree = await page.accessibility.snapshot({ interestingOnly: false });
    const bad = [], roles = new Set(["button", "textbox", "combobox", "slider", "checkbox", "radio",
                                     "tab", "link", "listbox", "Canvas"]);
    let count = 0;
    const walk = (node) => {
      if (roles.has(node.role)) {
        count += 1;
        if (!node.name?.trim()) bad.push(node);
      }
      for (const child of node.children ?? []) walk(child);
    };
    walk(tree);
    assert.deepEqual(bad, []);
    assert.ok(count > 40, String(count));
  }],
  ["nothing is cut off at 1280 x 720", async ({ page }) => {
    const out = await page.evaluate(() => [...document.querySelectorAll(
      ".top *, .transport *, .tools *, .list-head *, .adders *, #selected-buttons *, #selected *")]
      .filter((e) => {
        const r = e.getBoundingClientRect();
        const around = e.closest("header, aside, main, footer").getBoundingClientRect();
        return r.width > 0 && (r.right > around.right + 1 || r.left < around.left - 1 ||
          r.bottom > around.bottom + 1 || r.top < around.top - 1);
      }).map((e) => e.id || e.textContent));
    assert.deepEqual(out, []);
  }],
];
