// SPDX-License-Identifier: Apache-2.0
// Puts the page together.
import "./app.css";
import * as THREE from "three";
import { Actions } from "./actions";
import { CertificateList } from "./panel/certificate";
import { CompareDialog } from "./panel/compare";
import { ExportDialog, FlyDialog, HelpDialog } from "./panel/dialogs";
import { Feel } from "./panel/feel";
import { FilmList } from "./panel/film_list";
import { Hints, Notices, recall } from "./panel/notices";
import { takeDropped } from "./panel/dropped";
import { ExplorationPanel } from "./panel/exploration_panel";
import { PaintingPanel } from "./panel/painting_panel";
import { RaceGamePanel } from "./panel/race_game";
import { FirstFlightPanel } from "./panel/first_flight_panel";
import { LooksPanel } from "./panel/looks_panel";
import { ScanPanel } from "./panel/scan_panel";
import { Selected } from "./panel/selected";
import { Setup } from "./panel/setup";
import { showTab, wireTabs } from "./panel/tabs";
import { Timeline } from "./panel/timeline";
import { TopBar } from "./panel/topbar";
import { trianglesIn } from "./state/blob";
import { entries } from "./state/film";
import { GestureQueue } from "./state/queue";
import { pathOf, positionAt } from "./state/samples";
import { Session, type Socket } from "./state/session";
import { labelOf } from "./state/schema";
import { prismOf, siteLists } from "./state/site";
import { trianglesOf } from "./state/shapes";
import type { JsonObject, Vec3 } from "./state/types";
import { Studio } from "./studio";
import { blob as bytesOf } from "./view/blobs";
import { byId, forgetColours } from "./view/dom";
import { inReport, recorded, tellDrawn } from "./view/report";
import { wireFraming } from "./view/framing";
import { Gates } from "./view/gates";
import { Gizmo } from "./view/gizmo";
import { Ground } from "./view/ground";
import { Hulls } from "./view/hulls";
import { keyframeHere } from "./view/look_through";
import { Lighter } from "./view/lighter";
import { Navigation } from "./view/navigate";
import { Paths } from "./view/paths";
import { Pick } from "./view/pick";
import { Pins } from "./view/pins";
import { BackdropView } from "./view/backdrop_view";
import { Preview, previewControls } from "./view/preview";
import { ExplorationView } from "./view/exploration_view";
import { PaintingView } from "./view/painting_view";
import { RaceView } from "./view/race_view";
import { LooksView } from "./view/looks_view";
import { ScanView } from "./view/scan_view";
import { SightView } from "./view/sight_view";
import { Solids } from "./view/solids";
import { Stage } from "./view/stage";
import { Walk } from "./view/walk";

const theme = recall("lapwing-theme");
if (theme === "light" || theme === "dark") document.documentElement.dataset.theme = theme;

function unique(): string {
  const bytes = crypto.getRandomValues(new Uint8Array(12));
  return Array.from(bytes, (b) => b.toString(16).padStart(2, "0")).join("");
}

function kept(key: string): string | null {
  try {
    return sessionStorage.getItem(key);
  } catch {
    return null;
  }
}

function keep(key: string, value: string): void {
  try {
    sessionStorage.setItem(key, value);
  } catch {
    // Then a reload forgets what was not sent yet.
  }
}

// A duplicated tab inherits what this one kept; it is another tab all the same.
const how = performance.getEntriesByType("navigation")[0] as PerformanceNavigationTiming | undefined;
const tab = (how?.type === "reload" ? kept("lapwing-tab") : null) ?? unique();
keep("lapwing-tab", tab);
const token = decodeURIComponent(location.hash.slice(1)).replace(/^token=/, "");
const session = new Session({
  token, tab, unique,
  queue: new GestureQueue({
    read: () => kept("lapwing-queue"), write: (text) => keep("lapwing-queue", text),
  }),
  clock: {
    now: () => performance.now(),
    later: (ms, then) => window.setTimeout(then, ms),
    cancel: (id) => window.clearTimeout(id),
  },
  connect: () => inReport ? recorded(inReport) : new WebSocket(
    `${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/session`) as Socket,
});

const studio = new Studio(session);
const stage = new Stage(byId<HTMLCanvasElement>("stage"), byId("world"), byId("picture"));
// Before all that draws with them.
studio.on(["look"], () => stage.readPalette());
const ground = new Ground();
const solids = new Solids();
stage.scene.add(ground.group, solids.group);
new Lighter(stage, solids.opaque);
const navigation = new Navigation(studio, stage);
const gizmo = new Gizmo(studio, stage);
gizmo.controls.addEventListener("dragging-changed", () => {
  navigation.orbit.enabled = !gizmo.controls.dragging && studio.mode !== "camera";
});
new Paths(studio, stage);
new Gates(studio, stage);
const scanned = new ScanView(studio, stage);
const explored = new ExplorationView(studio, stage);
const looks = new LooksView(studio, stage);
looks.onCut = (plane) => {
  scanned.cutBy(plane);
  solids.cutBy(plane);
  explored.cutBy(plane);
};
const sights = new SightView(studio, stage);
new PaintingView(studio, stage);
new Pins(studio, stage, byId("pins"));
const pick = new Pick(studio, stage, solids, gizmo);
new Walk(studio, stage, pick);
new Preview(studio, stage);
wireFraming(studio);
byId("picture-controls").append(previewControls(studio));

new TopBar(studio);
const timeline = new Timeline(studio);
new CertificateList(studio);
new Feel(studio);
new Setup(studio);
const notices = new Notices(studio);
takeDropped(studio, notices);
const backdrop = new BackdropView(studio, stage, (text, kind) => notices.say(text, kind));
new Hints(studio);
wireTabs();

function bounds(): THREE.Box3 {
  const box = new THREE.Box3();
  for (const p of pathOf(studio.plan.columns)) box.expandByPoint(new THREE.Vector3(...p));
  for (const k of studio.film.keyframes) box.expandByPoint(new THREE.Vector3(...k.position));
  for (const g of studio.course?.gates ?? []) box.expandByPoint(new THREE.Vector3(...g.position));
  box.union(scanned.bounds()).union(explored.bounds());
  const things = solids.bounds();
  // A large map must not make the film small.
  if (box.isEmpty() || things.getSize(new THREE.Vector3()).length() <
      4 * box.getSize(new THREE.Vector3()).length()) box.union(things);
  return box;
}

// Where something new begins: where one looks.
function centre(): Vec3 {
  const [x, y] = pick.lookedAtGround();
  return [Math.round(x), Math.round(y), 0];
}

const list = new FilmList(studio, centre);
navigation.onButton = (button) => {
  if (button === "keyframe") keyframeHere(studio, stage, pick);
  else studio.setMode("orbit");
};
pick.onGate = (at) => list.addGate(at);
const scan = new ScanPanel(studio, centre);
scan.onPlace = (place) => navigation.lookAt(place);
new LooksPanel(studio, looks);
new FirstFlightPanel(studio);
pick.isView = ({ clientX, clientY }) => looks.viewAt(clientX, clientY) !== null;
pick.onNothing = (ray, at) => {
  const view = looks.viewAt(at.clientX, at.clientY);
  if (view) return looks.choose(view);
  // On a slice its own voxel is meant, not the surface behind it.
  const words = looks.askVoxel(ray) ? null : scanned.wordsAt(ray);
  if (words) notices.say(words);
};
const exploration = new ExplorationPanel(studio);
const painting = new PaintingPanel(studio);
const game = new RaceGamePanel(studio, new RaceView(studio, stage));
const selected = new Selected(studio);
new Actions({
  studio, selected, list, notices, exploration, painting, game, scan, exports: new ExportDialog(studio),
  flying: new FlyDialog(studio), help: new HelpDialog(), compare: new CompareDialog(studio),
  frame: () => navigation.frame(bounds()),
  keyframeHere: () => keyframeHere(studio, stage, pick),
  clickMiddle: () => pick.clickMiddle(),
  dropLook: () => looks.drop(),
  showFilmTab: () => showTab("film"),
});

// ---- what is drawn of the document -----------------------------------------------------------

let framed = false;
// The document's obstacles, and what only the server knows: flight zones, the walls of a race.
function zonesOf(kind: "closed" | "zone"): JsonObject[] {
  const side = kind === "zone" ? "keep_inside" : "keep_out";
  return entries(studio.document, siteLists[kind]).map((zone, index): JsonObject =>
    ({ ...prismOf(studio.document, kind, index) ?? zone, side, opaque: false }));
}

function obstacles(): JsonObject[] {
  const own = entries(studio.document, "obstacles");
  const closed = zonesOf("closed"), open = zonesOf("zone");
  const more = (session.world.obstacles ?? []).slice(own.length);
  const told = more.map((one) => {
    const zones = one.shape !== "prism" ? [] : one.side === "keep_inside" ? open : closed;
    const zone = zones.shift();
    if (zone && trianglesOf(zone)) return zone;
    // What is scanned is drawn by its surface.
    const hidden = one.shape === "map" && scanned.covers;
    return { ...one, type: hidden ? "hidden" : one.shape, hidden } as unknown as JsonObject;
  });
  // One that the server has not heard of yet is drawn all the same.
  return [...own, ...told, ...closed, ...open];
}

studio.on(["document"], () => {
  const { kind } = session.mission;
  if (document.body.dataset.kind === kind) return;
  document.body.dataset.kind = kind;
  // How fast it is where, is what a race is planned for.
  studio.speeds = kind === "race";
  studio.tell("look");
  // Missions of other kinds are edited by their options alone.
  const listed = ["film", "race", "scan", "explore", "light_painting"].includes(kind);
  byId("tab-film").textContent = labelOf(kind || "film");
  byId("tab-film").hidden = !listed;
  byId("tab-feel").hidden = !session.schema.some((option) => option.name === "weights");
  showTab(listed ? "film" : "setup");
});
studio.on(["document", "world", "standing"], () => {
  solids.set(obstacles());
  const { subjects } = studio.film;
  solids.setSubjects(subjects.length > 0 ? subjects : studio.plan.subjects ?? [], studio.time);
  if (!framed && session.welcomed) {
    framed = pathOf(studio.plan.columns).length > 1;
    navigation.frame(bounds());
  } else if (framed && !session.dragging) {
    navigation.follow(bounds());
  }
  stage.invalidate();
});
// The surface with its predictions says more than the map beneath it.
scanned.onSurface = () => solids.set(obstacles());
studio.on(["time"], () => solids.moveTo(studio.time));
studio.on(["selection"], () => {
  solids.choose(studio.selection?.kind === "obstacle" ? studio.selection.index : null);
  if (studio.selection) showTab("film");
  stage.invalidate();
});
// After the surfaces that it is drawn around.
new Hulls(studio, stage, solids);
studio.on(["look"], () => byId("map").setAttribute("aria-pressed", String(studio.map)));
studio.on(["look"], () => byId("speeds").setAttribute("aria-pressed", String(studio.speeds)));
studio.on(["look"], () => byId("margins").setAttribute("aria-pressed", String(studio.margins)));
studio.on(["mode"], () => {
  document.body.dataset.mode = studio.mode;
  byId("fly-camera").setAttribute("aria-pressed", String(studio.mode === "camera"));
});
studio.on(["playing"], () => {
  const button = byId("play");
  button.setAttribute("aria-pressed", String(studio.playing));
  button.setAttribute("aria-label", studio.playing ? "Pause" : "Play");
  for (const [id, rate] of [["rate-half", 0.5], ["rate-one", 1], ["rate-two", 2]] as const) {
    byId(id).setAttribute("aria-checked", String(studio.rate === rate));
  }
});

const fetched = new Map<number, string>();
studio.on(["world"], () => {
  const all = obstacles();
  session.world.obstacles?.forEach(({ blob }, i) => {
    const own = all[i];
    if (!blob || (own && trianglesOf(own)) || fetched.get(i) === blob) return;
    fetched.set(i, blob);
    bytesOf(blob)
      .then((buffer) => {
        solids.setBlob(i, trianglesIn(buffer));
        solids.set(obstacles());
        stage.invalidate();
      })
      .catch((error: Error) => {
        fetched.delete(i);
        notices.say(`An obstacle cannot be drawn: ${error.message}`, "bad");
      });
  });
});

function paint(): void {
  const p = stage.readPalette();
  ground.paint(p.ground, p.grid, p.ink);
  solids.paint({ solid: p.solid, closed: p.closed, subject: p.subject, chosen: p.chosen });
  stage.invalidate();
}
studio.on(["look"], paint);
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
  forgetColours();
  studio.tell("look");
});
paint();

session.on((event) => {
  if (event.what === "wrote" && event.message?.type === "wrote" &&
      !byId<HTMLDialogElement>("export-dialog").open) {
    notices.say(`Written: ${event.message.files.join(", ")}`, "good");
  }
});
// Another token in the same tab: greet with it.
window.addEventListener("hashchange", () => location.reload());
window.addEventListener("beforeunload", (event) => {
  if (session.pending > 0 && session.link !== "open") event.preventDefault();
});

// For the tests of the page and for those who look into it: what is on display, nothing to change.
Object.defineProperty(window, "lapwing", {
  value: Object.freeze({
    get revision() { return session.revision; },
    get pending() { return session.pending; },
    get grade() { return studio.standing.grade; },
    get document() { return studio.document; },
    get frames() { return stage.frames; },
    get frameMs() { return stage.frameMs; },
    get time() { return studio.time; },
    // Where the path is at a time, on the page.
    onScreen(time: number) {
      const at = positionAt(studio.plan.columns, time);
      const seen = at && stage.onScreen(at);
      const rect = stage.world.getBoundingClientRect();
      return seen ? { x: rect.left + seen.x, y: rect.top + seen.y } : null;
    },
    // Where the curve of speed is at a time, on the page; where the eye is, and how far it sees, m.
    onCurve: (time: number) => timeline.curvePlace(time),
    get eye() { return stage.worldCamera.position.toArray(); },
    get triangles() { return solids.triangles; },
    get surface() { return scanned.triangles; },
    get views() { return session.world.scan?.views ?? []; },
    get grown() { return explored.count; },
    get rays() { return sights.rays; },
    get episode() { return studio.episode; },
    get live() { return studio.live?.told.images.length ?? 0; },
    get paused() { return studio.paused; },
    get footprints() { return scanned.drawn; },
    get backdrop() { return backdrop.drawn; },
    backdropAt: (x: number, y: number) => backdrop.placeOf(x, y),
    get firstFlight() { return session.firstFlight; },
    get looks() {
      const { slice, voxel, view, leftOut } = looks;
      return { slice, voxel, view, leftOut, drawnPlaces: looks.drawnPlaces };
    },
    // Where a place of the world is on the page.
    pageOf(place: Vec3) {
      const seen = stage.onScreen(place), rect = stage.world.getBoundingClientRect();
      return seen ? { x: rect.left + seen.x, y: rect.top + seen.y } : null;
    },
    get game() { return game.figures; },
    get farthest() { return stage.worldCamera.far; },
    measure(on: boolean) { stage.measuring = on; },
    get edit() { return session.dragging ? session.edit : null; },
    // Resolves when the next frame is drawn.
    drawn: () => new Promise<number>((done) => stage.once(() => done(stage.frameMs))),
    redraw() { stage.invalidate(); },
    move() { stage.moved(); },
  }),
});

if (inReport) {
  studio.rendered = false;      // nobody renders
  // Once what is drawn has come.
  session.on(({ what }) => {
    if (what !== "welcome") return;
    studio.seek(studio.duration);    // all that was found
    stage.once(() => tellDrawn());
  });
}
session.start();
