// SPDX-License-Identifier: Apache-2.0
// What the parts of the page share: the session, and what is a tab's own: selection, play head,
// mode, view. Parts listen; nobody calls another part.
import { filmOf, type Film } from "./state/film";
import { courseGuess, courseOf, isCourse, type Course } from "./state/course";
import type { Figure } from "./state/prediction";
import type { PolygonKind } from "./state/site";
import { guessOf } from "./state/spline";
import { passagesOf } from "./state/failures";
import type { Edit, Item } from "./state/edits";
import { entryOf, sameItem } from "./state/edits";
import type { Session } from "./state/session";
import { LiveEpisode, type Sight } from "./state/exploration";
import type { ExplorationWorld, FleetTour, Flown, JsonObject, Passage, Plan, RunMessage,
              TakenImage } from "./state/types";
import type { Version } from "./state/compare";
import { standingOf, type Grade, type Standing } from "./state/grades";
import { clamp } from "./state/vector";

export type Topic = "document" | "standing" | "selection" | "time" | "mode" | "link" | "world" |
  "flown" | "look" | "playing" | "kept" | "episode" | "sight" | "draft";
export type Mode = "orbit" | "place" | "aim" | "draw" | "camera" | "walk" | "outline" | "stroke" | "race";
export type Rate = 0.5 | 1 | 2;

export class Studio {
  selection: Item | null = null;
  time = 0;
  tour = 0;                    // of several batteries, the one that is shown
  playing = false;
  rate: Rate = 1;
  mode: Mode = "orbit";
  guides = true;
  rendered = true;             // a picture by the server while paused
  framing = false;             // clicks in the picture place the subject
  margins = false;             // hulls around obstacles
  speeds = false;              // paths in the colours of their speed
  map = false;                 // the world from straight above
  outlined: PolygonKind = "region";    // what a drag draws in the mode `outline`
  // Of a scan: what is drawn, and the figure whose colours the surface has.
  readonly look: { figure: Figure; views: boolean; candidates: boolean; first: boolean;
                   rays: boolean; leftOut: boolean } =
    { figure: "accuracy_mm", views: true, candidates: false, first: false, rays: false,
      leftOut: false };
  run: RunMessage | null = null;       // the folder of a run that is shown in place of the document
  live: LiveEpisode | null = null;     // an exploration that is being planned
  paused = false;                      // likewise
  sight: Sight | null = null;          // what the last image by the play head was chosen by
  flown: Flown | null = null;
  kept: (Version & { grade: Grade }) | null = null;   // to be compared with
  private readonly listeners: { topics: Topic[]; then: (topic: Topic) => void }[] = [];
  private cached: { document: JsonObject; film: Film; guess: Plan } | null = null;
  private lastFrame = 0;
  private shownRun: Standing | null = null;
  private fleet: { tours: FleetTour[]; tour: number; shown: Standing } | null = null;

  constructor(readonly session: Session) {
    session.on((event) => {
      switch (event.what) {
        case "welcome":
          this.refresh();
          this.tell("document");
          this.tell("standing");
          this.tell("world");
          break;
        case "document":
          this.refresh();
          this.tell("document");
          this.tell("standing");
          break;
        case "standing":
          if (!["guess", "step"].includes(session.standing().grade)) this.endLive();
          this.tell("standing");
          break;
        case "image": this.take(event.message as TakenImage); break;
        case "pace":
          this.paused = (event.message as { paused: boolean }).paused;
          this.tell("episode");
          break;
        case "run": this.showRun(event.message as RunMessage); break;
        case "link": this.tell("link"); break;
        case "world": this.tell("world"); break;
        case "first_flight": this.tell("draft"); break;
        case "flown":
          this.flown = event.message as Flown;
          this.tell("flown");
          break;
        default:
      }
    });
  }

  on(topics: Topic[], then: (topic: Topic) => void): void {
    this.listeners.push({ topics, then });
  }

  tell(topic: Topic): void {
    for (const { topics, then } of this.listeners) if (topics.includes(topic)) then(topic);
  }

  // The episode that is shown: of a run's folder, of the planning under way, of the document.
  get episode(): ExplorationWorld | undefined {
    return this.run?.exploration ?? this.live?.told ?? this.session.world.exploration;
  }

  // Null: the document again.
  showRun(run: RunMessage | null): void {
    if (run === this.run) return;
    this.run = run;
    document.body.classList.toggle("run-shown", run !== null);
    this.shownRun = null;
    this.play(false);
    this.time = run ? run.plan.duration : clamp(this.time, 0, this.duration);
    for (const topic of ["standing", "episode", "time"] as const) this.tell(topic);
  }

  private take(taken: TakenImage): void {
    const { session } = this;
    if (taken.revision !== session.revision || session.pending > 0) return;
    if (taken.image === 1) this.live = new LiveEpisode(taken.revision);
    const follows = this.time >= this.duration - 1e-6;
    if (!this.live?.take(taken)) return;
    if (follows && !this.run) this.time = taken.time;
    for (const topic of ["standing", "episode", "time"] as const) this.tell(topic);
  }

  private endLive(): void {
    if (!this.live) return;
    this.live = null;
    this.paused = false;
    this.tell("episode");
  }

  private refresh(): void {
    // An edit is of the document.
    const { run, session } = this;
    if (run && (session.pending > 0 || session.dragging)) this.showRun(null);
    if (this.live && (session.pending > 0 || this.live.revision !== session.revision)) this.endLive();
    const document = this.session.document();
    const guess = isCourse(document) ? courseGuess(document) : guessOf(document);
    this.cached = { document, film: filmOf(document), guess };
    if (this.flown) {
      this.flown = null;
      this.tell("flown");
    }
    if (this.selection && !entryOf(document, this.selection)) this.select(null);
    this.time = clamp(this.time, 0, this.duration);
  }

  private get state(): { document: JsonObject; film: Film; guess: Plan } {
    if (!this.cached) this.refresh();
    return this.cached as { document: JsonObject; film: Film; guess: Plan };
  }

  get document(): JsonObject {
    return this.state.document;
  }

  get film(): Film {
    return this.state.film;
  }

  // Of a race; null of every other mission.
  get course(): Course | null {
    return isCourse(this.document) ? courseOf(this.document) : null;
  }

  get guess(): Plan {
    return this.state.guess;
  }

  // Of the tour that is shown, where there are several.
  get standing(): Standing {
    const standing = this.session.standing();
    if (this.run) return this.standingOfRun(this.run);
    if (this.live && !standing.plan) return { ...standing, grade: "step", plan: this.live.plan };
    const { tours } = standing;
    if (tours.length === 0) return standing;
    const tour = Math.min(this.tour, tours.length - 1);
    if (this.fleet?.tours !== tours || this.fleet.tour !== tour) {
      this.fleet = { tours, tour, shown: standingOf(standing, tour) };
    }
    const { plan, certificate } = this.fleet.shown;
    return { ...standing, plan, certificate };
  }

  // As the run judged it.
  private standingOfRun({ plan, certificate, folder }: RunMessage): Standing {
    return this.shownRun ??= {
      grade: certificate ? certificate.passed ? "certified" : "rejected" : "converged",
      plan, certificate, message: `The run in ${folder}, as it was judged then.`, ms: null, tours: [],
    };
  }

  // Whose plan the server is asked about.
  get which(): { tour?: number } {
    const { tours } = this.session.standing();
    return tours.length > 0 ? { tour: Math.min(this.tour, tours.length - 1) } : {};
  }

  showTour(tour: number): void {
    if (tour === this.tour) return;
    this.tour = tour;
    this.time = clamp(this.time, 0, this.duration);
    this.tell("standing");
  }

  // The best curve for the document as it is now.
  get plan(): Plan {
    return this.standing.plan ?? this.guess;
  }

  get duration(): number {
    return this.cached ? Math.max(this.plan.duration, this.cached.film.duration) : 0;
  }

  // Passages of the curve on display that fail.
  get passages(): Passage[] {
    const { plan, certificate } = this.standing;
    return plan ? passagesOf(plan, certificate) : [];
  }

  get editable(): boolean {
    return this.session.mission.editable;
  }

  // When a keyframe is passed: as the plan says, where there is one.
  timeOf(keyframe: number): number {
    const { keyframes } = this.film;
    const planned = this.standing.plan?.keyframes;
    const own = planned && planned.length === keyframes.length ? planned[keyframe]?.time : undefined;
    return own ?? keyframes[keyframe]?.time ?? 0;
  }

  select(item: Item | null): void {
    if (sameItem(item, this.selection) || (item === null && this.selection === null)) return;
    this.selection = item;
    this.tell("selection");
  }

  seek(time: number): void {
    const next = clamp(time, 0, this.duration);
    if (next === this.time) return;
    this.time = next;
    this.tell("time");
  }

  keep(version: Studio["kept"]): void {
    this.kept = version;
    this.tell("kept");
  }

  setMode(mode: Mode): void {
    if (mode === this.mode) return;
    if (this.map && (mode === "camera" || mode === "race")) {    // the map cannot be flown
      this.map = false;
      this.tell("look");
    }
    this.mode = mode;
    this.tell("mode");
  }

  play(playing: boolean): void {
    if (playing === this.playing) return;
    if (playing && this.time >= this.duration - 1e-3) this.seek(0);
    this.playing = playing;
    this.lastFrame = performance.now();
    this.tell("playing");
    if (playing) requestAnimationFrame(this.frame);
  }

  setRate(rate: Rate): void {
    this.rate = rate;
    this.tell("playing");
  }

  private readonly frame = (now: number): void => {
    if (!this.playing) return;
    const next = this.time + ((now - this.lastFrame) / 1000) * this.rate;
    this.lastFrame = now;
    this.seek(next);
    if (next >= this.duration) this.play(false);
    else requestAnimationFrame(this.frame);
  };

  // One finished edit.
  edit(edit: Edit | null): string | null {
    return edit ? this.session.gesture(edit.label, edit.patch) : null;
  }

  // A drag under way.
  drag(edit: Edit | null): void {
    if (edit) this.session.preview(edit.patch);
  }
}
