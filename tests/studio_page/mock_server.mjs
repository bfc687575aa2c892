// SPDX-License-Identifier: Apache-2.0
// A server for tests of the page alone. It speaks the protocol, plans by the page's own spline and
// judges by a few limits, and can be made late, wrong in order, silent or dead on request.
import { createServer } from "node:http";
import { createHash } from "node:crypto";
import { createRequire } from "node:module";
import { mkdirSync, readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import { WebSocketServer } from "ws";

const here = dirname(fileURLToPath(import.meta.url));
const page = join(here, "../../framework/studio/page");
const { build } = createRequire(join(page, "package.json"))("esbuild");
const types = { html: "text/html; charset=utf-8", js: "text/javascript", css: "text/css" };

// The page's own modules of films, as plain JavaScript.
let modules = null;
async function pageModules() {
  modules ??= bundled();
  return modules;
}

async function bundled() {
  mkdirSync(join(here, ".cache"), { recursive: true });
  const outfile = join(here, ".cache/modules.mjs");
  await build({
    stdin: {
      contents: 'export { guessOf } from "./src/state/spline";\n' +
        'export { applied, valueAt } from "./src/state/document";\n',
      resolveDir: page, loader: "ts",
    },
    bundle: true, format: "esm", platform: "node", outfile, logLevel: "error",
  });
  return import(`${pathToFileURL(outfile)}?${Date.now()}`);
}

export const limits = {
  speed_across: 10, climb_speed: 2.5, descent_speed: 2, acceleration_across: 4,
};

function check(name, values, limit, unit, columns) {
  let worst = -Infinity, time = 0;
  values.forEach((v, i) => { if (v > worst) { worst = v; time = columns.time[i]; } });
  return { name, group: "safety", required: true, passed: worst <= limit * 1.0001, worst, limit,
           sense: "at_most", unit, time, detail: "" };
}

function judged({ columns: c }) {
  const checks = [
    check("speed_across", c.vx.map((v, i) => Math.hypot(v, c.vy[i])), limits.speed_across, "m/s", c),
    check("climb_speed", c.vz, limits.climb_speed, "m/s", c),
    check("descent_speed", c.vz.map((v) => -v), limits.descent_speed, "m/s", c),
    check("acceleration_across", c.ax.map((v, i) => Math.hypot(v, c.ay[i])),
          limits.acceleration_across, "m/s^2", c),
    { name: "clearance", required: true, passed: true, worst: 5.8, limit: 0.5, sense: "at_least",
      unit: "m", time: 13.1, detail: "sphere 'castle'" },
    { name: "flight_zone", required: true, passed: true,
      skipped: "the environment has no flight zone" },
    { name: "yaw_rate", required: true, passed: true, worst: 0.44, limit: 1.5708, sense: "at_most",
      unit: "rad/s", time: 10.6, detail: "" },
    { name: "whole_subject", required: false, passed: false, worst: 0.8, limit: 1,
      sense: "at_least", unit: "", time: 3, detail: "" },
  ];
  return { passed: checks.every((one) => one.passed || !one.required), checks };
}

const camera = { width: 1920, height: 1080, fx: 890, fy: 890, cx: 959.5, cy: 539.5 };

export async function startMock(options = {}) {
  const { guessOf, applied } = await pageModules();
  const fixture = JSON.parse(readFileSync(join(here, "fixtures/castle.json"), "utf8"));
  const state = {
    document: options.document ?? fixture.document, revision: 0, past: [], future: [],
    seen: new Set(), delays: { step: 15, converged: 40, certified: 60 }, silent: false,
    received: [], previews: {}, writes: 0, shuffle: null, mission: options.mission,
  };
  const blobs = new Map();
  const put = (bytes) => {
    const name = createHash("sha256").update(bytes).digest("hex");
    blobs.set(name, bytes);
    return name;
  };
  const world = options.world ? options.world(put) : { obstacles: [], subjects: [], bounds: {} };

  const server = createServer((request, response) => {
    const path = request.url.split("?")[0];
    const policy = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; " +
      `connect-src 'self' ws://${request.headers.host}`;
    const send = (bytes, type) => response.writeHead(200, {
      "Content-Type": type, "Content-Security-Policy": policy, "Cache-Control": "no-store" })
      .end(bytes);
    if (path.startsWith("/blob/") && blobs.has(path.slice(6))) {
      return send(blobs.get(path.slice(6)), path.includes(state.photo) && state.photo
        ? "image/png" : "application/octet-stream");
    }
    const name = path === "/" ? "index.html" : path.slice(1);
    if (["index.html", "app.js", "app.css"].includes(name)) {
      return send(readFileSync(join(page, "dist", name)), types[name.split(".")[1]]);
    }
    return response.writeHead(path === "/favicon.ico" ? 204 : 404).end();
  });
  const sockets = new WebSocketServer({
    server, path: "/session", verifyClient: () => !state.gone,
  });
  const open = new Set();
  let newest = 0;

  const tell = (message, to = open) => {
    const text = JSON.stringify(message);
    for (const socket of to) if (socket.readyState === 1) socket.send(text);
  };

  function planOf(document) {
    const plan = guessOf(document);
    const c = plan.columns;
    c.thrust = c.ax.map((v, i) => 1.5 * Math.hypot(v, c.ay[i], c.az[i] + 9.81));
    plan.camera = camera;
    plan.limits = { ...limits, thrust_max: 28.8, thrust_min: 4 };
    plan.objective = [{ term: "smoothness", cost: 0.0028 }, { term: "gimbal_derivative", cost: 0.0017 },
                      { term: "effort", cost: 0.0015 }, { term: "yaw", cost: 0.0012 }];
    return plan;
  }

  // Step, converged and verdict, each after its delay; the newest edit alone, as the server does.
  function solve(document, head) {
    const mine = ++newest;
    const plan = planOf(document), certificate = judged(plan);
    const start = Date.now();
    const last = certificate.passed ? "certified" : "rejected";
    for (const grade of ["step", "converged", last]) {
      const delay = state.delays[grade === "rejected" ? "certified" : grade];
      setTimeout(() => {
        if (state.silent || (mine !== newest && !state.shuffle)) return;
        const answer = { type: "answer", ...head, grade, plan,
                         certificate: grade === last ? certificate : null, message: "",
                         ms: Date.now() - start };
        state.answer = answer;
        tell(answer);
      }, state.shuffle ? state.shuffle() : delay);
    }
  }

  function store(id, label, patch) {
    const before = state.document;
    state.document = applied(state.document, patch);
    state.revision += 1;
    return { before, id, label, patch };
  }

  function changed(id, label, patch) {
    tell({ type: "document", revision: state.revision, patch, by: id, label,
           can_undo: state.past.length > 0, can_redo: state.future.length > 0 });
    solve(state.document, { revision: state.revision, edit: null, tab: null });
  }

  const whole = (document) => Object.entries(document).map(([path, value]) => ({ path, value }));

  const handlers = {
    gesture(message, socket) {
      if (state.seen.has(message.id)) {
        return tell({ type: "document", revision: state.revision, patch: [], by: message.id,
                      label: message.label, can_undo: true, can_redo: false }, [socket]);
      }
      state.seen.add(message.id);
      try {
        state.past.push(store(message.id, message.label, message.patch));
      } catch (error) {
        return tell({ type: "refused", id: message.id, why: String(error.message) }, [socket]);
      }
      state.future = [];
      return changed(message.id, message.label, message.patch);
    },
    undo(message, socket) {
      const entry = state.past.pop();
      if (!entry) return tell({ type: "refused", id: message.id, why: "nothing to undo" }, [socket]);
      state.future.push({ ...entry, after: state.document });
      const patch = whole(entry.before);
      store(message.id, "undo", patch);
      return changed(message.id, `Undo: ${entry.label}`, patch);
    },
    redo(message, socket) {
      const entry = state.future.pop();
      if (!entry) return tell({ type: "refused", id: message.id, why: "nothing to redo" }, [socket]);
      const patch = whole(entry.after);
      state.past.push(store(message.id, entry.label, patch));
      return changed(message.id, `Redo: ${entry.label}`, patch);
    },
    preview(message, socket) {
      state.previews[message.edit] = applied(state.document, message.patch);
      solve(state.previews[message.edit],
            { revision: state.revision, edit: message.edit, tab: socket.tab });
    },
    rest() {
      solve(state.document, { revision: state.revision, edit: null, tab: null });
    },
    fly(message, socket) {
      const { columns } = planOf(state.document);
      const off = 0.06 * Math.hypot(...message.wind);
      const samples = { ...columns, x: columns.x.map((v, i) => v + off * Math.sin(i / 9)) };
      setTimeout(() => tell({ type: "flown", edit: message.edit, samples, lost: false,
                              finished: true, kept: off < 0.25,
                              worst: { position_error: off, time: 4.2, limit: 0.25, mean: off / 2,
                                       rotor_speed: 0.6 } }, [socket]), 30);
    },
    picture(message, socket) {
      state.photo = put(readFileSync(join(here, "fixtures/photo.png")));
      tell({ type: "picture", edit: message.edit, time: message.time, blob: state.photo }, [socket]);
    },
    export(message, socket) {
      if (message.format === "csv" && message.parameters.rate === 13) {
        return tell({ type: "failed", id: message.id, why: "csv: the disk is full" }, [socket]);
      }
      state.writes += 1;
      return tell({ type: "wrote", id: message.id, files: [`out/castle/castle.${message.format}`],
                    loss: "the ground is left out" }, [socket]);
    },
    save_report(message, socket) {
      state.writes += 1;
      tell({ type: "wrote", id: message.id, files: ["out/castle/report.html"], loss: "" }, [socket]);
    },
    export_lua(message, socket) {
      state.writes += 1;
      tell({ type: "wrote", id: message.id, files: ["castle.studio.lua"], loss: "" }, [socket]);
    },
    resolve_script() { tell({ type: "script_changed", conflict: false, message: "Resolved." }); },
  };

  sockets.on("connection", (socket) => {
    socket.on("message", (data) => {
      const message = JSON.parse(String(data));
      state.received.push(message);
      if (message.type === "hello") {
        if (message.token !== "secret") return socket.close();
        socket.tab = message.tab;
        open.add(socket);
        tell({ type: "welcome",
               mission: state.mission ?? { name: "castle flyover", kind: "film",
                                           script: "castle.lua", editable: true },
               document: state.document, revision: state.revision,
               can_undo: state.past.length > 0, can_redo: state.future.length > 0,
               schema: fixture.schema, choices: fixture.choices, world,
               answer: state.answer?.edit === null && state.answer.revision === state.revision
                 ? state.answer : null }, [socket]);
        if (!state.answer) solve(state.document, { revision: state.revision, edit: null, tab: null });
        return undefined;
      }
      if (state.deaf) return undefined;
      return handlers[message.type]?.(message, socket);
    });
    socket.on("close", () => open.delete(socket));
  });
  await new Promise((done) => server.listen(options.port ?? 0, "127.0.0.1", done));
  const { port } = server.address();
  return {
    state, tell, port, address: `http://127.0.0.1:${port}/#secret`,
    drop() { for (const socket of sockets.clients) socket.terminate(); },
    stop() {
      for (const socket of sockets.clients) socket.terminate();
      return new Promise((done) => { server.close(done); server.closeAllConnections?.(); });
    },
  };
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const mock = await startMock({ port: Number(process.env.PORT ?? 0) });
  console.log(mock.address);
}
