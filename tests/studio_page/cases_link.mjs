// SPDX-License-Identifier: Apache-2.0
// The page and its server: lost connections, answers in any order, scripts that change, other tabs.
import assert from "node:assert/strict";
import { drag, openPage, studioState, waitGrade, waitRevision } from "./browser.mjs";

const wait = (ms) => new Promise((done) => setTimeout(done, ms));
const text = (page, selector) => page.$eval(selector, (e) => e.textContent);

export const links = [
  ["an edit made while the connection is lost arrives once", async ({ page, mock, shot }) => {
    mock.state.deaf = true;
    await drag(page, '[data-pin="keyframe-1"]', 40, 0);
    assert.equal((await studioState(page)).pending, 1);
    mock.state.gone = true;
    mock.drop();
    await page.waitForFunction("document.body.classList.contains('lost')");
    await drag(page, '[data-pin="keyframe-2"]', -30, 0);
    assert.match(await text(page, "#link"), /2 edits are kept/);
    await shot("lost");
    mock.state.deaf = mock.state.gone = false;
    await waitRevision(page, 2);
    assert.equal(mock.state.revision, 2);
    assert.deepEqual((await studioState(page)).document, mock.state.document);
    await waitGrade(page, "certified");
    assert.equal(await page.evaluate("document.body.classList.contains('lost')"), false);
  }],
  ["an edit outlives a reload of the page", async ({ page, mock }) => {
    mock.state.deaf = true;
    await drag(page, '[data-pin="keyframe-1"]', 40, 0);
    const { document } = await studioState(page);
    mock.state.deaf = false;
    page.once("dialog", (dialog) => dialog.accept());
    await page.reload();
    await waitRevision(page, 1);
    assert.deepEqual((await studioState(page)).document, document);
    assert.deepEqual(mock.state.document, document);
  }],
  ["an edit that the server applied before the connection went is not applied again",
   async ({ page, mock }) => {
     const { tell } = mock;
     void tell;
     await drag(page, '[data-pin="keyframe-1"]', 40, 0);
     await waitRevision(page, 1);
     const id = mock.state.received.find((m) => m.type === "gesture").id;
     await page.evaluate((gesture) => sessionStorage.setItem("lapwing-queue", JSON.stringify(gesture)),
       [mock.state.received.find((m) => m.id === id)]);
     await page.reload();
     await page.waitForFunction("window.lapwing.pending === 0 && window.lapwing.revision === 1");
     assert.equal(mock.state.revision, 1);
   }],
  ["answers late and in any order are never green for another state", async ({ page, mock }) => {
    await page.evaluate(() => {
      window.greens = [];
      new MutationObserver(() => {
        const badge = document.getElementById("grade");
        if (badge.dataset.grade === "certified") {
          window.greens.push([window.lapwing.revision, window.lapwing.pending, window.lapwing.edit,
                              JSON.stringify(window.lapwing.document)]);
        }
      }).observe(document.getElementById("grade"), { attributes: true, childList: true,
                                                     subtree: true });
    });
    mock.state.shuffle = () => Math.random() * 150;
    const stored = { [mock.state.revision]: JSON.stringify(mock.state.document) };
    for (let i = 0; i < 5; ++i) {
      await drag(page, `[data-pin="keyframe-${i % 3}"]`, 12 * (i % 2 ? 1 : -1), 4, { steps: 3 });
      await waitRevision(page, i + 1);
      stored[mock.state.revision] = JSON.stringify(mock.state.document);
      await wait(30);
    }
    await wait(250);
    const greens = await page.evaluate("window.greens");
    assert.ok(greens.length > 0);
    for (const [revision, pending, edit, document] of greens) {
      assert.equal(pending, 0);
      assert.equal(document, edit === null ? stored[revision]
        : JSON.stringify(mock.state.previews[edit]));
    }
    await waitGrade(page, "certified");
  }],
  ["a drag shows guess, step, converged and certified in turn", async ({ page, mock }) => {
    Object.assign(mock.state.delays, { step: 60, converged: 140, certified: 220 });
    await page.evaluate(() => {
      window.grades = [];
      new MutationObserver(() => {
        const { grade } = document.getElementById("grade").dataset;
        if (window.grades[window.grades.length - 1] !== grade) window.grades.push(grade);
      }).observe(document.getElementById("grade"), { attributes: true });
    });
    await drag(page, '[data-pin="keyframe-1"]', 30, 0);
    await waitRevision(page, 1);
    await waitGrade(page, "certified");
    const grades = await page.evaluate("window.grades");
    assert.deepEqual(grades.slice(-4), ["guess", "step", "converged", "certified"]);
  }],
  ["certified without a certificate is not green", async ({ page, mock }) => {
    mock.tell({ type: "answer", revision: 1, edit: null, grade: "certified",
                plan: mock.state.answer.plan, certificate: null });
    mock.state.silent = true;
    await drag(page, '[data-pin="keyframe-1"]', 30, 0);
    await waitRevision(page, 1);
    mock.tell({ type: "answer", revision: 1, edit: null, tab: null, grade: "certified",
                plan: mock.state.answer.plan, certificate: null, message: "", ms: 1 });
    await wait(60);
    assert.equal((await studioState(page)).grade, "converged");
  }],
  ["a refused edit goes back, with the reason", async ({ page, mock }) => {
    mock.state.deaf = true;
    const before = (await studioState(page)).document;
    await drag(page, '[data-pin="keyframe-1"]', 30, 0);
    const gestures = () => mock.state.received.filter((m) => m.type === "gesture");
    while (gestures().length === 0) await wait(10);
    const { id } = gestures().pop();
    mock.tell({ type: "refused", id, why: "keyframes[2].position: inside the castle" });
    await page.waitForFunction("document.querySelector('#notes').textContent.includes('castle')");
    assert.deepEqual((await studioState(page)).document, before);
  }],
  ["an error in the script is told with its line, and goes when it is mended",
   async ({ page, mock, shot }) => {
     mock.tell({ type: "script_error", message: "unexpected symbol near '}'", line: 14 });
     await page.waitForFunction("document.querySelector('#banner').textContent.includes('Line 14')");
     await shot("script_error");
     // A drag is answered, and the error stands.
     await drag(page, '[data-pin="keyframe-1"]', 40, 0, { hold: true, pause: 30 });
     await page.waitForFunction("window.lapwing.grade !== 'guess'");
     assert.match(await text(page, "#banner"), /Line 14/);
     await page.keyboard.press("Escape");
     await page.mouse.up();
     assert.match(await text(page, "#banner"), /Line 14/);
     mock.tell({ type: "script_loaded" });
     await page.waitForFunction("document.querySelector('#banner').hidden");
   }],
  ["a script that changed asks: mine, theirs, both", async ({ page, mock }) => {
    mock.tell({ type: "script_changed", conflict: true, message: "keyframes[2] changed in both." });
    await page.waitForFunction("!document.querySelector('#banner').hidden");
    await page.click("#banner button:nth-of-type(3)");
    await wait(50);
    assert.deepEqual(mock.state.received.filter((m) => m.type === "resolve_script"),
                     [{ type: "resolve_script", take: "both" }]);
    assert.equal(await page.$eval("#banner", (b) => b.hidden), true);
  }],
  ["a crash of the planner is told and survived", async ({ page, mock }) => {
    mock.tell({ type: "worker", role: "solver", state: "crashed", message: "signal 11" });
    await page.waitForFunction("document.querySelector('#notes').textContent.includes('crashed')");
    await drag(page, '[data-pin="keyframe-1"]', 30, 0);
    await waitRevision(page, 1);
    await waitGrade(page, "certified");
  }],
  ["two tabs agree within 100 ms", async ({ browser, page, mock }) => {
    const other = await openPage(browser, mock.address);
    await page.bringToFront();
    const watch = (revision) => {
      window.agreed = new Promise((done) => {
        const timer = setInterval(() => {
          if (window.lapwing.revision !== revision) return;
          clearInterval(timer);
          done(Date.now());
        }, 2);
      });
    };
    const late = [];
    for (let revision = 1; revision <= 3; ++revision) {
      await Promise.all([page.evaluate(watch, revision), other.evaluate(watch, revision)]);
      await drag(page, '[data-pin="keyframe-1"]', 15, 0, { steps: 3 });
      const [mine, theirs] = await Promise.all([page.evaluate("window.agreed"),
                                                other.evaluate("window.agreed")]);
      late.push(Math.abs(mine - theirs));
    }
    // The machine may have been busy once.
    assert.ok(Math.min(...late) < 100, `${late} ms`);
    assert.deepEqual((await studioState(other)).document, (await studioState(page)).document);
    assert.notEqual((await studioState(other)).grade, "rejected");
    await other.bringToFront();
    await other.click("#undo");
    await waitRevision(other, 4);
    await page.waitForFunction("window.lapwing.revision === 4", { polling: 10 });
    await other.close();
  }, "alone"],
  ["what cannot be read does no harm", async ({ page, mock }) => {
    mock.tell("nonsense");
    mock.tell({ type: "unknown" });
    mock.tell({ type: "document", revision: 9, patch: [], by: "", label: "" });   // one was missed
    await page.waitForFunction("window.lapwing.revision === 0 && window.lapwing.pending === 0");
    await wait(300);
    await drag(page, '[data-pin="keyframe-1"]', 30, 0);
    await waitRevision(page, 1);
  }],
];
