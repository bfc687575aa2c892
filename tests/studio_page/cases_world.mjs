// SPDX-License-Identifier: Apache-2.0
// The world and the time: zones, subjects that are walked, margins, versions, the curve of speed,
// gamepads, far films; each by mouse and by keyboard alone.
import assert from "node:assert/strict";
import { centreOf, drag, frames, studioState, type, waitGrade, waitRevision } from "./browser.mjs";
import { keys, next } from "./cases_edit.mjs";

const wait = (ms) => new Promise((done) => setTimeout(done, ms));
const text = (page, selector) => page.$eval(selector, (e) => e.textContent);
const document = async (page) => (await studioState(page)).document;

// Pixels of one of the two openings, as they are drawn now: how many does `of` take?
async function pixels(page, opening, of) {
  return page.evaluate(async (selector, source) => {
    const taken = new Function("r", "g", "b", `return ${source}`);
    const canvas = document.getElementById("stage");
    window.lapwing.redraw();
    await window.lapwing.drawn();
    const gl = canvas.getContext("webgl2");
    const whole = canvas.getBoundingClientRect();
    const rect = document.querySelector(selector).getBoundingClientRect();
    const scale = canvas.width / whole.width;
    const w = Math.round(rect.width * scale), h = Math.round(rect.height * scale);
    const bytes = new Uint8Array(4 * w * h);
    gl.readPixels(Math.round((rect.left - whole.left) * scale),
                  Math.round((whole.bottom - rect.bottom) * scale), w, h, gl.RGBA,
                  gl.UNSIGNED_BYTE, bytes);
    let count = 0;
    for (let i = 0; i < bytes.length; i += 4) {
      if (taken(bytes[i], bytes[i + 1], bytes[i + 2])) count += 1;
    }
    return count;
  }, opening, of);
}
const GREENISH = "g > r + 25", REDDISH = "r > g + 14 && r > b + 14";

async function press(page, words) {
  const found = await page.evaluateHandle((t) =>
    [...document.querySelectorAll("#selected-buttons button")].find((b) => b.textContent === t),
  words);
  await found.asElement().click();
}

export const worlds = [
  ["corners of a zone dragged, added and deleted, by mouse and by keyboard",
   async ({ page, shot }) => {
     await next(page, () => page.select("#add-obstacle", "no_fly_zone"));
     const corners = async () => (await document(page)).obstacles[1].corners;
     const first = await corners();
     await next(page, () => drag(page, '[data-pin="corner-1-2"]', 40, -10));
     const dragged = await corners();
     assert.notDeepEqual(dragged.slice(4, 6), first.slice(4, 6));
     assert.deepEqual([...dragged.slice(0, 4), ...dragged.slice(6)],
                      [...first.slice(0, 4), ...first.slice(6)]);
     await shot("zone");
     await page.focus('[data-pin="corner-1-1"]');
     await next(page, () => keys(page, "ArrowRight"));
     assert.equal((await corners())[2], dragged[2] + 0.5);
     await next(page, () => keys(page, "d"));
     assert.equal((await corners()).length, 10);
     await next(page, () => keys(page, "Delete"));
     await next(page, () => page.focus('[data-pin="corner-1-0"]').then(() => keys(page, "Delete")));
     await page.focus('[data-pin="corner-1-0"]');
     await keys(page, "Delete");
     await page.waitForFunction(
       "document.querySelector('#notes').textContent.includes('three corners')");
     await page.click('[data-key="obstacle-1"]');
     await next(page, () => press(page, "Add corner"));
     assert.equal((await corners()).length, 8);
     // What the flight stays inside of.
     await next(page, () => page.select("#add-obstacle", "flight_zone"));
     assert.deepEqual((await document(page)).flight_zones[0].corners,
                      [-28, -16, 28, -16, 28, 14, -28, 14]);
     await next(page, () => type(page, '[data-key="flight_zones[1].ceiling"]', "30"));
     await page.focus('[data-key="zone-0"]');
     await next(page, () => keys(page, "Delete"));
     assert.deepEqual((await document(page)).flight_zones, []);
   }],
  ["a subject walked in real time, by mouse and by keyboard", async ({ page, shot }) => {
    await page.click('[data-pin="subject-0"]');
    await press(page, "Walk");
    const { x, y } = await centreOf(page, "#world");
    const begun = Date.now();
    await page.mouse.move(x - 100, y + 50);
    await next(page, async () => {
      await page.mouse.down();
      for (let i = 1; i <= 5; ++i) {
        await page.mouse.move(x - 100 + 24 * i, y + 50);
        await wait(120);
      }
      await shot("walked");
      await page.mouse.up();
    });
    const seconds = (Date.now() - begun) / 1000;
    const [subject] = (await document(page)).subjects;
    assert.equal(subject.position, undefined);
    const last = subject.track[subject.track.length - 1];
    assert.ok(last.time > 0.5 && last.time < seconds, `${last.time} of ${seconds}`);
    assert.notDeepEqual(last.position, subject.track[0].position);
    assert.equal(await page.evaluate("window.document.body.dataset.mode"), "orbit");
    // A second walk, from the start, with the arrows.
    await page.focus('[data-pin="subject-0"]');
    await keys(page, "Home");
    await next(page, async () => {
      await keys(page, "j", "Enter");
      await page.keyboard.down("ArrowUp");
      await frames(page, 6, 500);
      await page.keyboard.up("ArrowUp");
      await keys(page, "Enter");
    });
    const { time } = await studioState(page);
    const { track } = (await document(page)).subjects[0];
    const end = track.find((point) => Math.abs(point.time - time) < 0.02);
    assert.ok(time > 0.3 && track[0].time === 0 && end, `${time}: ${JSON.stringify(track)}`);
    const north = end.position[1] - track[0].position[1];
    assert.ok(north > 0.2 && north < 1.6 * time, `${north} m in ${time} s`);
    // Dropped by Escape, nothing is left of it.
    const before = await studioState(page);
    await keys(page, "j", "Enter");
    await frames(page, 5, 400);
    await keys(page, "Escape", "Escape");
    assert.deepEqual((await studioState(page)).document, before.document);
  }],
  ["the margin as a hull, by mouse and by keyboard", async ({ page, shot }) => {
    const bare = await pixels(page, "#world", REDDISH);
    await page.click("#margins");
    const hull = await pixels(page, "#world", REDDISH);
    assert.ok(hull > bare + 500, `${bare}, ${hull}`);
    await shot("margin");
    // It grows with the margin, and is not in the film's picture.
    const picture = await pixels(page, "#picture", REDDISH);
    await page.click("#tab-setup");
    await next(page, () => type(page, '[data-key="margin"]', "3"));
    assert.ok(await pixels(page, "#world", REDDISH) > 1.2 * hull);
    await page.focus("#world");
    await keys(page, "n");
    assert.ok(await pixels(page, "#world", REDDISH) < bare + 50);
    assert.equal(await page.$eval("#margins", (b) => b.getAttribute("aria-pressed")), "false");
    assert.ok(Math.abs(await pixels(page, "#picture", REDDISH) - picture) < 50);
  }],
  ["two versions side by side, by mouse and by keyboard", async ({ page, shot }) => {
    const first = await document(page);
    await page.click("#compare");
    const column = (n) => page.$$eval(`#compare-table tr > :nth-child(${n})`,
                                      (all) => all.map((e) => e.textContent));
    const kept = await column(2);
    assert.deepEqual(kept.slice(0, 3), ["Kept", "Certified", "20 s"]);
    assert.deepEqual((await column(3)).slice(1), kept.slice(1));
    assert.equal(await page.$eval("#compare-back", (b) => b.disabled), true);
    await next(page, () => drag(page, '[data-pin="keyframe-1"]', 0, 40));
    await waitGrade(page, "certified");
    assert.deepEqual(await column(2), kept);
    assert.notDeepEqual((await column(3)).slice(3, 4), kept.slice(3, 4));
    assert.equal(await page.evaluate("document.body.classList.contains('comparing')"), true);
    await shot("compared");
    await next(page, () => page.click("#compare-back"));
    assert.deepEqual(await document(page), first);
    await page.focus("#world");
    await keys(page, "Escape");
    await page.waitForFunction("!document.body.classList.contains('comparing')");
    await keys(page, "y");
    assert.equal(await page.evaluate("document.activeElement.id"), "compare-keep");
    await next(page, () => keys(page, "Control+z"));
    await keys(page, "Enter");            // this one is kept now
    assert.equal(await page.$eval("#compare-back", (b) => b.disabled), true);
  }],
  ["the curve of speed bent by mouse, a leg paced by keyboard", async ({ page, shot }) => {
    const at = await page.evaluate("window.lapwing.onCurve(5)");
    const bend = async (dx, dy) => {
      await page.mouse.move(at.x, at.y);
      await page.mouse.down();
      await page.mouse.move(at.x + dx, at.y + dy, { steps: 4 });
      await shot("bent");
      await page.mouse.up();
    };
    await bend(40, 2);                    // sideways it scrubs
    assert.equal((await studioState(page)).revision, 0);
    assert.ok((await studioState(page)).time > 5.3);
    const slower = await next(page, () => bend(0, 6));
    assert.ok(slower.document.keyframes[1].time > 10.3, String(slower.document.keyframes[1].time));
    const span = slower.document.keyframes[2].time - slower.document.keyframes[1].time;
    assert.ok(Math.abs(span - 10) < 0.15);
    await page.focus("#world");
    await keys(page, "]", "]");
    const faster = await next(page, () => keys(page, "Alt+PageUp"));
    assert.ok(faster.document.keyframes[1].time < slower.document.keyframes[1].time);
    const again = await next(page, () => keys(page, "Alt+PageDown"));
    assert.ok(again.document.keyframes[1].time > faster.document.keyframes[1].time);
    const now = await page.evaluate("window.lapwing.onCurve(5)");
    await page.mouse.move(now.x, now.y);
    await page.mouse.down();
    await page.mouse.move(now.x, now.y + 8, { steps: 3 });
    await page.keyboard.press("Escape");
    await page.mouse.up();
    assert.deepEqual((await studioState(page)).document, again.document);
  }],
  ["the virtual camera flown by a gamepad", async ({ page }) => {
    await page.evaluate(() => {
      const button = () => ({ value: 0, pressed: false });
      window.pad = { connected: true, axes: [0, 0, 0, 0], buttons: Array.from({ length: 16 }, button) };
      navigator.getGamepads = () => [null, window.pad];
    });
    await page.focus("#world");
    await keys(page, "v");
    const eye = () => page.evaluate("window.lapwing.eye");
    const start = await eye();
    const held = async (axes, buttons = {}) => {
      await page.evaluate((a, b) => {
        window.pad.axes = a;
        for (const [i, value] of Object.entries(b)) window.pad.buttons[i].value = value;
      }, axes, buttons);
      await frames(page, 5, 250);
      await page.evaluate(() => {
        window.pad.axes = [0, 0, 0, 0.1];      // not quite at rest, as sticks are
        for (const b of window.pad.buttons) b.value = 0;
      });
      await frames(page, 3, 40);
    };
    await held([0, -1, 0, 0], { 7: 1 });
    const on = await eye();
    assert.ok(Math.hypot(on[0] - start[0], on[1] - start[1]) > 0.5, `${start} ${on}`);
    assert.ok(on[2] > start[2] + 0.3);
    const rest = await eye();
    await wait(120);
    assert.deepEqual(await eye(), rest);
    await next(page, () => held([0, 0, 1, 0], { 0: 1 }));
    assert.equal((await document(page)).keyframes.length, 4);
    await held([0, 0, 0, 0], { 1: 1 });
    assert.equal(await page.evaluate("window.document.body.dataset.mode"), "orbit");
  }],
  ["a mend is pressed once a certificate", async ({ page, mock }) => {
    await page.click('[data-pin="keyframe-1"]');
    await next(page, () => type(page, '[data-key="keyframes[2].time"]', "3"));
    await waitGrade(page, "rejected");
    mock.state.delays.certified = 400;
    const { revision } = await studioState(page);
    await page.evaluate(() => {
      const mend = document.querySelector("#checks .mend button");
      for (let i = 0; i < 3; ++i) mend.click();
    });
    await waitRevision(page, revision + 1);
    await wait(60);
    assert.equal(mock.state.revision, revision + 1);
    assert.equal(await text(page, "#notes"), "");
  }],
  ["a keyframe kilometres away is shown with the rest", async ({ page, shot }) => {
    await page.click('[data-pin="keyframe-2"]');
    await next(page, () => type(page, "#selected-form .field input", "5000"));
    await page.focus("#world");
    await keys(page, "z");
    await wait(100);
    const box = await (await page.$("#world")).boundingBox();
    for (const time of [0, 10, 20]) {
      const at = await page.evaluate((t) => window.lapwing.onScreen(t), time);
      assert.ok(at && at.x > box.x && at.x < box.x + box.width && at.y > box.y &&
                at.y < box.y + box.height, `${time}: ${JSON.stringify(at)}`);
    }
    await shot("far");
    const sky = await page.evaluate(() =>
      getComputedStyle(document.documentElement).getPropertyValue("--sky").trim());
    const [r, g, b] = [1, 3, 5].map((i) => parseInt(sky.slice(i, i + 2), 16));
    const drawn = await pixels(page, "#world",
                               `Math.abs(r - ${r}) + Math.abs(g - ${g}) + Math.abs(b - ${b}) > 30`);
    assert.ok(drawn > 2000, String(drawn));
    await page.focus('[data-pin="keyframe-2"]');
    const { document: there } = await studioState(page);
    await next(page, () => keys(page, "ArrowRight"));
    assert.equal((await document(page)).keyframes[2].position[0],
                 there.keyframes[2].position[0] + 0.5);
  }],
  ["new things appear where one looks", async ({ page }) => {
    const { x, y } = await centreOf(page, "#world");
    await page.mouse.move(x, y);
    await page.mouse.down({ button: "right" });
    await page.mouse.move(x - 260, y - 90, { steps: 5 });
    await page.mouse.up({ button: "right" });
    await page.focus("#world");
    await next(page, () => keys(page, "o"));
    const near = async (pin, most) => {
      const at = await centreOf(page, `[data-pin="${pin}"]`);
      const away = Math.hypot(at.x - x, at.y - y);
      assert.ok(away < most, `${pin}: ${away} px`);
    };
    await near("obstacle-1", 140);
    await next(page, () => page.click("#add-subject"));
    await near("subject-1", 80);
  }],
  ["what a subject is inside of does not hide it in the picture", async ({ page, shot }) => {
    assert.ok(await pixels(page, "#picture", GREENISH) > 100);
    await shot("looked_through");
    // In the world the castle is whole, and is picked by a click.
    await page.select("#add-obstacle", "sphere");
    await waitRevision(page, 1);
    const castle = await centreOf(page, '[data-pin="obstacle-0"]');
    await page.mouse.click(castle.x - 22, castle.y - 22);
    await page.waitForFunction(
      "document.querySelector('#selected-title').textContent === 'Obstacle castle'");
    // Moved out of it, the subject is behind it, and hidden from some places.
    assert.equal((await document(page)).obstacles.length, 2);
  }],
  ["it is told when nothing can be edited any more", async ({ page, mock }) => {
    mock.tell({ type: "mission", mission: { name: "castle flyover", kind: "film",
      script: "castle.lua", editable: false, why_not: "castle.studio.yaml: mend or remove it" } });
    await page.waitForFunction("!document.querySelector('#read-only').hidden");
    assert.match(await text(page, "#read-only"), /mend or remove it/);
    await drag(page, '[data-pin="keyframe-1"]', 40, 0);
    assert.equal(mock.state.received.filter((m) => m.type === "gesture").length, 0);
    mock.tell({ type: "mission", mission: { name: "castle flyover", kind: "film",
                                            script: "castle.lua", editable: true, why_not: null } });
    await page.waitForFunction("document.querySelector('#read-only').hidden");
    await next(page, () => drag(page, '[data-pin="keyframe-1"]', 40, 0));
  }],
];
