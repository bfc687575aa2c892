// SPDX-License-Identifier: Apache-2.0
// Editing, each once by mouse and once by keyboard.
import assert from "node:assert/strict";
import { centreOf, drag, frames, studioState, type, waitGrade, waitRevision } from "./browser.mjs";

const keyframes = async (page) => (await studioState(page)).document.keyframes;
const subjects = async (page) => (await studioState(page)).document.subjects;
const obstacles = async (page) => (await studioState(page)).document.obstacles;

// Presses of keys on the page itself.
async function keys(page, ...list) {
  for (const key of list) {
    const parts = key.split("+");
    for (const held of parts.slice(0, -1)) await page.keyboard.down(held);
    await page.keyboard.press(parts[parts.length - 1]);
    for (const held of parts.slice(0, -1)) await page.keyboard.up(held);
  }
}

async function next(page, then) {
  const { revision } = await studioState(page);
  await then();
  await waitRevision(page, revision + 1);
  return studioState(page);
}

export const edits = [
  ["keyframe dragged on its level by mouse", async ({ page }) => {
    const [, before] = await keyframes(page);
    await next(page, () => drag(page, '[data-pin="keyframe-1"]', 60, 20));
    const [, after] = await keyframes(page);
    assert.notDeepEqual(after.position, before.position);
    assert.equal(after.position[2], before.position[2]);
    await waitGrade(page, "certified");
  }],
  ["keyframe lifted by mouse with Shift", async ({ page }) => {
    const [, before] = await keyframes(page);
    await page.keyboard.down("Shift");
    await next(page, () => drag(page, '[data-pin="keyframe-1"]', 0, 25));
    await page.keyboard.up("Shift");
    const [, after] = await keyframes(page);
    assert.ok(after.position[2] < before.position[2]);
    assert.deepEqual(after.position.slice(0, 2), before.position.slice(0, 2));
  }],
  ["a drag dropped by Escape changes nothing", async ({ page }) => {
    const before = await studioState(page);
    await drag(page, '[data-pin="keyframe-1"]', 50, 10, { hold: true });
    assert.notDeepEqual((await studioState(page)).document, before.document);
    await page.keyboard.press("Escape");
    await page.mouse.up();
    const after = await studioState(page);
    assert.deepEqual(after.document, before.document);
    assert.equal(after.revision, before.revision);
  }],
  ["keyframe moved by arrows: a burst is one edit", async ({ page }) => {
    await page.focus('[data-pin="keyframe-1"]');
    const { revision } = await studioState(page);
    await keys(page, "ArrowRight", "ArrowRight", "ArrowUp", "PageUp");
    await waitRevision(page, revision + 1);
    const { document, revision: now } = await studioState(page);
    assert.equal(now, revision + 1);
    assert.deepEqual(document.keyframes[1].position, [1, -1.5, 14.5]);
  }],
  ["gizmo dragged along one axis by mouse", async ({ page }) => {
    await page.click('[data-pin="keyframe-1"]');
    const { x, y } = await centreOf(page, '[data-pin="keyframe-1"]');
    const [, before] = await keyframes(page);
    // The upward arrow stands above the ball.
    await page.mouse.move(x, y - 40);
    await next(page, async () => {
      await page.mouse.down();
      for (let i = 1; i <= 5; ++i) await page.mouse.move(x + 8 * i, y - 40 + 5 * i);
      await page.mouse.up();
    });
    const [, after] = await keyframes(page);
    assert.deepEqual(after.position.slice(0, 2), before.position.slice(0, 2));
    assert.notEqual(after.position[2], before.position[2]);
  }],
  ["numbers typed with units, by keyboard alone", async ({ page }) => {
    await page.focus('[data-pin="keyframe-0"]');
    await keys(page, "Enter");
    await next(page, async () => {
      await keys(page, "Control+a");
      await page.keyboard.type("-1750 cm");
      await keys(page, "Enter");
    });
    assert.equal((await keyframes(page))[0].position[0], -17.5);
  }],
  ["a wrong number is told beside its field", async ({ page }) => {
    await page.click('[data-pin="keyframe-0"]');
    const { revision } = await studioState(page);
    await type(page, '[data-key="keyframes[1].time"]', "3 kg");
    const text = await page.$eval("#selected .field-error:not([hidden])", (e) => e.textContent);
    assert.match(text, /no unit here; use s/);
    await type(page, '[data-key="keyframes[1].time"]', "25");
    await page.waitForFunction(
      () => document.body.textContent.includes("Keyframe 1 must be between 0 s and 9.8 s"));
    assert.equal((await studioState(page)).revision, revision);
  }],
  ["keyframes placed by clicks on the ground", async ({ page }) => {
    await page.click("#place");
    const { x, y } = await centreOf(page, "#world");
    await next(page, () => page.mouse.click(x - 200, y + 60));
    await keys(page, "Escape");
    const list = await keyframes(page);
    assert.equal(list.length, 4);
    assert.equal(list[3].position[2], 5);
    assert.ok(list[3].time > 20);
  }],
  ["a keyframe placed by keyboard", async ({ page }) => {
    await page.focus("#world");
    await keys(page, "p");
    await next(page, () => keys(page, "Enter"));
    await keys(page, "Escape");
    assert.equal((await keyframes(page)).length, 4);
  }],
  ["a keyframe inserted on the path by a double click", async ({ page }) => {
    const at = await pointOnPath(page, 5);
    await next(page, () => page.mouse.click(at.x, at.y, { count: 2, delay: 20 }));
    const list = await keyframes(page);
    assert.equal(list.length, 4);
    assert.ok(Math.abs(list[1].time - 5) < 0.8, String(list[1].time));
  }],
  ["a keyframe inserted at the play head by keyboard", async ({ page }) => {
    await page.focus("#play-head");
    await keys(page, ...Array(4).fill("PageUp"));
    await next(page, () => keys(page, "i"));
    assert.equal((await keyframes(page))[1].time, 4);
  }],
  ["the drone dragged along its path scrubs, with Shift it is pulled", async ({ page }) => {
    const at = await pointOnPath(page, 4), on = await pointOnPath(page, 7);
    await page.mouse.move(at.x, at.y);
    await page.mouse.down();
    await page.mouse.move(on.x, on.y, { steps: 4 });
    await page.mouse.up();
    const scrubbed = await studioState(page);
    assert.ok(Math.abs(scrubbed.time - 7) < 0.5, String(scrubbed.time));
    assert.equal(scrubbed.revision, 0);
    await page.keyboard.down("Shift");
    await page.mouse.move(at.x, at.y);
    await next(page, async () => {
      await page.mouse.down();
      await page.mouse.move(at.x - 30, at.y, { steps: 4 });
      await page.mouse.up();
    });
    await page.keyboard.up("Shift");
    assert.equal((await keyframes(page)).length, 4);
  }],
  ["keyframes drawn with the mouse", async ({ page }) => {
    await page.click("#draw");
    const { x, y } = await centreOf(page, "#world");
    await next(page, async () => {
      await page.mouse.move(x - 150, y + 40);
      await page.mouse.down();
      for (let i = 1; i <= 10; ++i) {
        await page.mouse.move(x - 150 + 16 * i, y + 40 + 30 * Math.sin(i / 1.5));
      }
      await page.mouse.up();
    });
    const count = (await keyframes(page)).length;
    assert.ok(count >= 5 && count <= 15, String(count));
  }],
  ["a shot added by keyboard, and one by mouse", async ({ page }) => {
    await page.focus("#world");
    await keys(page, "h");
    await next(page, () => page.select("#shot", "Orbit"));
    assert.equal((await keyframes(page)).length, 11);
    await page.click("#undo");
    await page.waitForFunction("window.lapwing.document.keyframes.length === 3");
    await next(page, () => page.select("#shot", "Crane"));
    assert.equal((await keyframes(page)).length, 5);
  }],
  ["duplicated, swapped and deleted by mouse", async ({ page }) => {
    await page.click('[data-key="keyframe-1"]');
    const button = async (text) => {
      for (const one of await page.$$("#selected-buttons button")) {
        if ((await one.evaluate((e) => e.textContent)) === text) return one.click();
      }
      throw new Error(`no button ${text}`);
    };
    await next(page, () => button("Copy"));
    assert.equal((await keyframes(page)).length, 4);
    await next(page, () => button("\u2191"));
    assert.deepEqual((await keyframes(page))[2].position, [0, -2, 14]);
    await next(page, () => button("Delete"));
    assert.equal((await keyframes(page)).length, 3);
  }],
  ["duplicated, swapped and deleted by keyboard", async ({ page }) => {
    await page.focus("#world");
    await keys(page, "]", "]");
    await next(page, () => keys(page, "d"));
    assert.equal((await keyframes(page)).length, 4);
    await next(page, () => keys(page, "Alt+ArrowUp"));
    assert.deepEqual((await keyframes(page))[2].position, [0, -2, 14]);
    await next(page, () => keys(page, "Delete"));
    assert.equal((await keyframes(page)).length, 3);
    await keys(page, "[");
    await next(page, () => keys(page, "Delete"));
    await keys(page, "[");
    await keys(page, "Delete");
    await page.waitForSelector("#notes .note");
    assert.equal((await keyframes(page)).length, 2);
  }],
  ["a keyframe aimed by mouse, its point dragged", async ({ page }) => {
    await page.click('[data-pin="keyframe-0"]');
    await page.evaluate(() => [...document.querySelectorAll("#selected-buttons button")]
      .find((b) => b.textContent === "Aim").click());
    const { x, y } = await centreOf(page, "#world");
    await next(page, () => page.mouse.click(x - 120, y + 60));
    const [first] = await keyframes(page);
    assert.equal(first.look_at.length, 3);
    await next(page, () => drag(page, '[data-pin="look-0"]', 30, 10));
    assert.notDeepEqual((await keyframes(page))[0].look_at, first.look_at);
  }],
  ["a keyframe aimed by keyboard, its point moved and taken away", async ({ page }) => {
    await page.focus('[data-pin="keyframe-0"]');
    await keys(page, "l");
    await next(page, () => keys(page, "Enter"));
    const [first] = await keyframes(page);
    await next(page, () => keys(page, "PageUp"));
    assert.equal((await keyframes(page))[0].look_at[2], first.look_at[2] + 0.5);
    await next(page, () => keys(page, "Delete"));
    assert.equal((await keyframes(page))[0].look_at, undefined);
  }],
  ["subject and obstacle by mouse", async ({ page }) => {
    await next(page, () => drag(page, '[data-pin="subject-0"]', 40, 10));
    assert.notEqual((await subjects(page))[0].position[0], 0);
    await next(page, () => drag(page, '[data-key="obstacle-0"]', 0, 0).then(() =>
      type(page, '[data-key="obstacles[1].radius"]', "4")));
    assert.equal((await obstacles(page))[0].radius, 4);
    await next(page, () => page.select("#add-obstacle", "no_fly_zone"));
    assert.equal((await obstacles(page))[1].corners.length, 8);
    await next(page, () => page.click("#add-subject"));
    assert.equal((await subjects(page)).length, 2);
  }],
  ["subject and obstacle by keyboard", async ({ page }) => {
    await page.focus('[data-pin="subject-0"]');
    await next(page, () => keys(page, "ArrowRight"));
    assert.deepEqual((await subjects(page))[0].position, [0.5, 0, 2]);
    await page.focus('[data-pin="obstacle-0"]');
    await next(page, () => keys(page, "Shift+ArrowUp"));
    assert.deepEqual((await obstacles(page))[0].center, [0, 0.05, 2]);
    await next(page, () => keys(page, "o"));
    await next(page, () => keys(page, "Delete"));
    assert.equal((await obstacles(page)).length, 1);
    await next(page, () => keys(page, "u"));
    assert.equal((await subjects(page)).length, 2);
  }],
  ["the subject placed in the picture by mouse and by keyboard", async ({ page }) => {
    await page.click("#framing");
    const box = await (await page.$("#picture")).boundingBox();
    await next(page, () => page.mouse.click(box.x + box.width / 3, box.y + box.height / 2));
    assert.deepEqual((await subjects(page))[0].place, [0.33, 0.5]);
    await next(page, async () => {
      await page.mouse.move(box.x + 100, box.y + 40);
      await page.mouse.down();
      await page.mouse.move(box.x + 150, box.y + 40 + box.height / 4, { steps: 3 });
      await page.mouse.up();
    });
    assert.equal((await subjects(page))[0].size, 0.25);
    await page.focus('[data-pin="subject-0"]');
    await page.focus('[data-key="subjects[1].size"]');
    await next(page, async () => {
      await keys(page, "Control+a");
      await page.keyboard.type("0.4");
      await keys(page, "Enter");
    });
    assert.equal((await subjects(page))[0].size, 0.4);
  }],
  ["the virtual camera flown by mouse, a keyframe of its view", async ({ page }) => {
    await page.click("#fly-camera");
    const { x, y } = await centreOf(page, "#world");
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 120, y, { steps: 4 });
    await page.mouse.up();
    await page.mouse.wheel({ deltaY: 300 });
    await next(page, () => page.click("#keyframe-here"));
    const made = (await keyframes(page))[3];
    assert.equal(made.look_at.length, 3);
    assert.ok(made.position[0] < -18);
    await page.click("#fly-camera");
  }],
  ["the virtual camera flown by keyboard, K makes a keyframe", async ({ page }) => {
    await page.focus("#world");
    await keys(page, "v");
    const hold = async (key) => {
      await page.keyboard.down(key);
      await frames(page, 4, 150);
      await page.keyboard.up(key);
    };
    await hold("w");
    await next(page, () => keys(page, "k"));
    const made = (await keyframes(page))[3];
    assert.ok(made.position[0] > -18, String(made.position));
    assert.equal(made.look_at, undefined, "the subject is in the middle anyway");
    await hold("e");
    await next(page, () => keys(page, "k"));
    assert.ok((await keyframes(page))[4].position[2] > made.position[2]);
    await keys(page, "Escape");
    assert.equal(await page.evaluate("document.body.dataset.mode"), "orbit");
  }],
  ["undo and redo by mouse and by keyboard", async ({ page }) => {
    const first = (await studioState(page)).document;
    const edited = await next(page, () => drag(page, '[data-pin="keyframe-2"]', 30, 0));
    const undone = await next(page, () => page.click("#undo"));
    assert.deepEqual(undone.document, first);
    const redone = await next(page, () => page.click("#redo"));
    assert.deepEqual(redone.document, edited.document);
    await page.focus("#world");
    await next(page, () => keys(page, "Control+z"));
    const again = await next(page, () => keys(page, "Control+Shift+z"));
    assert.deepEqual(again.document, edited.document);
    await waitGrade(page, "certified");
  }],
];

// The place on the page of the path at a time: where the drone is drawn.
export async function pointOnPath(page, time) {
  return page.evaluate((t) => window.lapwing.onScreen(t), time);
}

export { keys, next };
