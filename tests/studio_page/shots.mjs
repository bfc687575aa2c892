// SPDX-License-Identifier: Apache-2.0
// What a drag costs on real shots: node shots.mjs FOLDER [NAMES...]. Of every shot_*.json in the
// folder the middle keyframe is dragged for two seconds, twenty moves a second, a metre to and fro,
// and let go of. Prints a row a shot: how long a move waited for an answer of it or of a later one,
// and how the released film ended. Exit status 1 where 95 % of the moves of a shot waited for more than
// 150 ms, or a film ended without a certificate and without a reason.
import { spawn } from "node:child_process";
import { mkdtempSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import WebSocket from "ws";

const root = join(dirname(fileURLToPath(import.meta.url)), "../..");
const [folder, ...names] = process.argv.slice(2);
const SECONDS = 2, EVERY = 50, MOST = 150;       // ms
const wait = (ms) => new Promise((done) => setTimeout(done, ms));

function start(dir, data) {
  const child = spawn(join(root, "build/release/bin/lapwing"), ["studio", "film.lua", "--no-open",
    "--data", data, "--assets", join(root, "framework/studio/page/dist")], { cwd: dir });
  return new Promise((found, failed) => {
    let said = "";
    const hear = (bytes) => {
      said += bytes;
      const match = /http:\/\/(127\.0\.0\.1:\d+)\/#(\S+)/.exec(said);
      if (match) found({ child, host: match[1], token: match[2] });
    };
    child.stdout.on("data", hear);
    child.stderr.on("data", hear);
    child.on("exit", () => failed(new Error(said)));
  });
}

class Page {
  constructor({ host, token }) {
    this.socket = new WebSocket(`ws://${host}/session`, { origin: `http://${host}` });
    this.heard = [];
    this.listeners = new Set();
    this.socket.on("open", () => this.say({ type: "hello", token, tab: "t", seen: 0 }));
    this.socket.on("message", (bytes) => {
      const message = { ...JSON.parse(String(bytes)), at: performance.now() };
      for (const listener of this.listeners) listener(message);
    });
  }
  say(message) { this.socket.send(JSON.stringify(message)); }
  until(wanted, ms = 120000) {
    return new Promise((done, failed) => {
      const timer = setTimeout(() => failed(new Error("no answer")), ms);
      const listener = (message) => {
        if (!wanted(message)) return;
        clearTimeout(timer);
        this.listeners.delete(listener);
        done(message);
      };
      this.listeners.add(listener);
    });
  }
}

const ended = (m) => m.type === "answer" && m.edit === null && !["step", "converged"].includes(m.grade);
const share = (list, p) => [...list].sort((a, b) => a - b)[Math.min(list.length - 1,
  Math.floor(p * list.length))] ?? NaN;

async function measured(name) {
  const dir = mkdtempSync(join(tmpdir(), "lapwing-shots-"));
  writeFileSync(join(dir, "film.lua"), `return require("mission.film").from_file {
  name = "film", input = "${name}" }\n`);
  const studio = await start(dir, folder);
  try {
    const page = new Page(studio);
    const welcome = await page.until((m) => m.type === "welcome" && m.document);
    const first = welcome.answer && ended(welcome.answer) ? welcome.answer : await page.until(ended);
    const { keyframes } = welcome.document;
    const index = keyframes.length >> 1;
    const base = keyframes[index].position;
    const sent = [], waits = [], steps = [];
    page.listeners.add((m) => {
      if (m.type !== "answer" || m.edit === null) return;
      if (m.grade === "step" || m.grade === "converged") steps.push(m.ms);
      while (sent.length > 0 && sent[0].edit <= m.edit) waits.push(m.at - sent.shift().at);
    });
    const begun = performance.now();
    let patch = [];
    for (let edit = 1; performance.now() - begun < SECONDS * 1000; ++edit) {
      const phase = (performance.now() - begun) / (SECONDS * 1000);
      const to = [base[0] + Math.sin(2 * Math.PI * phase), base[1] + phase, base[2]];
      patch = [{ path: `keyframes[${index + 1}].position`, value: to }];
      sent.push({ edit, at: performance.now() });
      page.say({ type: "preview", edit, patch });
      await wait(EVERY);
    }
    const released = performance.now();
    const result = page.until((m) => ended(m) && m.revision === 1);
    const refused = page.until((m) => m.type === "refused");
    page.say({ type: "gesture", id: "g", base: 0, label: "", patch });
    const last = await Promise.race([result, refused]);
    result.catch(() => {});
    refused.catch(() => {});
    return { name, samples: first.plan?.columns.time.length ?? 0, keyframes: keyframes.length, waits, lost: sent.length,
             first: first.grade, grade: last.grade ?? "refused", after: last.at - released,
             why: last.message ?? last.why ?? "" };
  } finally {
    studio.child.removeAllListeners("exit");
    studio.child.kill("SIGKILL");
    await new Promise((done) => studio.child.on("exit", done));
    rmSync(dir, { recursive: true, force: true });
  }
}

const all = readdirSync(folder).filter((name) => /^shot_\d+\.json$/.test(name))
  .filter((name) => names.length === 0 || names.some((one) => name.includes(one))).sort();
let failed = 0;
console.log("shot          samples keys  answers  median    95 %  released  ended");
for (const name of all) {
  try {
    const row = await measured(name);
    const p95 = share(row.waits, 0.95);
    const told = row.grade === "certified" || row.why !== "";
    if (!(p95 <= MOST) || !told) failed += 1;
    console.log(`${name.padEnd(13)} ${String(row.samples).padStart(7)} ${String(row.keyframes).padStart(4)} ${
      String(row.waits.length).padStart(8)} ${share(row.waits, 0.5).toFixed(0).padStart(7)} ${
      p95.toFixed(0).padStart(7)} ${row.after.toFixed(0).padStart(9)}  ${row.first} -> ${row.grade} ${
      row.why.slice(0, 90)}`);
  } catch (error) {
    failed += 1;
    console.log(`${name.padEnd(13)} ${error.message.slice(0, 120)}`);
  }
}
console.log(failed === 0 ? "all within 150 ms" : `${failed} of ${all.length} not`);
process.exit(failed === 0 ? 0 : 1);
