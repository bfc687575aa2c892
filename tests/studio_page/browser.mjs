// SPDX-License-Identifier: Apache-2.0
// A browser for the tests, in software, and what a person does with it.
import puppeteer from "puppeteer-core";
import { existsSync } from "node:fs";

const places = [process.env.CHROMIUM, "/usr/bin/chromium", "/usr/bin/chromium-browser",
                "/usr/bin/google-chrome"].filter(Boolean);

export function chromium() {
  return places.find((path) => existsSync(path)) ?? null;
}

export async function startBrowser() {
  return puppeteer.launch({
    executablePath: chromium(), headless: true,
    args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader",
           "--enable-unsafe-swiftshader", "--window-size=1280,720", "--force-color-profile=srgb",
           "--disable-background-networking", "--disable-component-update", "--no-first-run"],
    defaultViewport: { width: 1280, height: 720 },
  });
}

// A tab with the page in it; every request to another host is counted, every error of the page
// remembered.
export async function openPage(browser, address, options = {}) {
  const page = await browser.newPage();
  page.foreign = [];
  page.faults = [];
  const host = new URL(address).host;
  page.on("request", (request) => {
    const url = request.url();
    if (!url.startsWith("data:") && new URL(url).host !== host) page.foreign.push(url);
  });
  page.on("pageerror", (error) => page.faults.push(String(error.stack ?? error)));
  page.on("console", (message) => {
    if (message.type() === "error" && !/WebSocket connection|ERR_CONNECTION/.test(message.text())) {
      page.faults.push(message.text());
    }
  });
  if (options.dark) {
    await page.emulateMediaFeatures([{ name: "prefers-color-scheme", value: "dark" }]);
  }
  await page.goto(address, { waitUntil: "load" });
  if (options.wait !== false) await page.waitForFunction("window.lapwing?.grade !== undefined && " +
    "document.querySelectorAll('.pin').length > 0", { timeout: 30000 });
  return page;
}

export const studioState = (page) => page.evaluate(() => ({
  grade: window.lapwing.grade, revision: window.lapwing.revision, pending: window.lapwing.pending,
  document: window.lapwing.document, time: window.lapwing.time, frames: window.lapwing.frames,
}));

export async function waitGrade(page, grade, timeout = 30000) {
  await page.waitForFunction((g) => window.lapwing.grade === g && window.lapwing.pending === 0,
                             { timeout, polling: 10 }, grade);
}

export async function waitRevision(page, revision, timeout = 30000) {
  await page.waitForFunction((r) => window.lapwing.revision >= r && window.lapwing.pending === 0,
                             { timeout, polling: 10 }, revision);
}

export async function centreOf(page, selector) {
  const box = await (await page.waitForSelector(selector, { timeout: 5000 })).boundingBox();
  if (!box) throw new Error(`${selector} is not shown`);
  return { x: box.x + box.width / 2, y: box.y + box.height / 2 };
}

export async function drag(page, selector, dx, dy, options = {}) {
  const { x, y } = await centreOf(page, selector);
  await page.mouse.move(x, y);
  await page.mouse.down();
  const steps = options.steps ?? 4;
  for (let i = 1; i <= steps; ++i) {
    await page.mouse.move(x + (dx * i) / steps, y + (dy * i) / steps);
    if (options.pause) await new Promise((done) => setTimeout(done, options.pause));
  }
  if (options.during) await options.during();
  if (!options.hold) await page.mouse.up();
}

export async function type(page, selector, text) {
  await page.click(selector, { count: 3 });
  await page.keyboard.type(text);
  await page.keyboard.press("Enter");
}

// A busy machine draws late: what is held is held for so many frames, and at least so long.
export const frames = (page, count, ms) => page.evaluate((most, least) => new Promise((done) => {
  const start = performance.now();
  let n = 0;
  const next = () => (++n < most || performance.now() - start < least
    ? requestAnimationFrame(next) : done());
  requestAnimationFrame(next);
}), count, ms);
