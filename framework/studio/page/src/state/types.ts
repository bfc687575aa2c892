// SPDX-License-Identifier: Apache-2.0
// The messages of the session and what is in them. SI units; radians in plans.

export type Json = null | boolean | number | string | Json[] | { [key: string]: Json };
export type JsonObject = { [key: string]: Json };
export type Vec3 = [number, number, number];

export type Change = { path: string; value: Json } | { path: string; remove: true };
export type Patch = Change[];

export interface Option {
  name: string;
  type: string;
  summary?: string;
  unit?: string;
  default?: Json;
  required?: boolean;
  minimum?: number;
  above?: number;
  maximum?: number;
  choices?: string[];
  size?: number;
  table?: Option[];
  kind?: string;
  words?: string[];
}

export interface Choice {
  name: string;
  summary?: string;
  values?: JsonObject;
  parameters?: Option[];
  extension?: string;
  loss?: string;
}

export interface MissionInfo {
  name: string;
  kind: string;
  script: string;
  editable: boolean;
  why_not?: string;
}

export interface Check {
  name: string;
  passed: boolean;
  required: boolean;
  worst?: number | null;
  limit?: number | null;
  sense?: "at_least" | "at_most";
  unit?: string;
  time?: number | null;
  detail?: string;
  skipped?: boolean | string;
}

export interface Certificate {
  passed: boolean;
  checks: Check[];
}

export interface SubjectTrack {
  name: string;
  times: number[];
  positions: Vec3[];
  height?: number;
  width?: number;
}

export interface CameraOptics {
  width: number;
  height: number;
  fx: number;
  fy: number;
  cx: number;
  cy: number;
}

export interface Passage {
  start: number;
  finish: number;
  check: string;
  value?: number;
  limit?: number;
  unit?: string;
  mend?: string;
}

export type Columns = Record<string, number[]> & { time: number[] };

export interface Plan {
  duration: number;
  columns: Columns;
  keyframes?: { time: number; position: Vec3; tolerance?: number }[];
  looks?: { time?: number; position: Vec3 }[];
  subjects?: SubjectTrack[];
  camera?: CameraOptics;
  lights?: { start: number; finish: number }[];
  strokes?: Vec3[][];          // of a light painting, as they were asked for
  passages?: Passage[];
  objective?: { term: string; cost: number }[];
  limits?: Record<string, number | [number, number]>;
  gates?: { name: string; position: Vec3; direction: Vec3; up: Vec3; radius: number;
            corners?: [number, number][] }[];
}

export type AnswerGrade = "step" | "converged" | "certified" | "rejected" | "refused";

// One of several batteries. The plan of the first one is the answer's.
export interface FleetTour {
  name: string;                // "drone 1, battery 2"
  drone: string;
  battery: number;
  start: number;               // s, after the fleet begins
  plan: Plan | null;
  certificate: Certificate | null;
}

export interface Answer {
  type: "answer";
  revision: number;
  edit: number | null;
  tab?: string | null;
  grade: AnswerGrade;
  plan?: Plan | null;
  certificate?: Certificate | null;
  message?: string;
  ms?: number;
  tours?: FleetTour[];
}

export interface WorldObstacle {
  name: string;
  shape: string;
  side?: string;
  opaque?: boolean;
  track?: { time: number; move: Vec3 }[];
  blob?: string;
}

// A region, or part of one, above a polygon with holes; m.
export interface SitePrism {
  name: string;
  corners: [number, number][];
  holes: [number, number][][];
  low: number;
  high: number;
  weight: number;
}

export interface SurfaceHole {
  area: number;
  position: Vec3;
  why: "not_chosen" | "zone" | "no_view";
}

// What a scan was planned on, and what its images will show.
export interface ScanWorld {
  region: SitePrism[];
  views: { time: number; position: Vec3; yaw: number; pitch: number; matching: boolean;
           tour?: number }[];    // of several batteries: whose, from 0
  image: number[];             // width, height, focal lengths and principal point, pixels
  first_views: Vec3[];
  footprints?: [number, number][][];    // of those, on the region's lowest level
  candidates: Vec3[];
  candidate_scores?: number[];   // of each by itself
  seconds: number[];
  score: number[];
  map?: { resolution: number; lower?: Vec3; upper?: Vec3 };    // of what was known first, m
  areas: JsonObject;
  words: string;
  prediction?: JsonObject;
  prediction_words?: string;
  surface?: string;            // blob, as prediction.ts reads it
}

// How an exploration went.
export interface ExplorationWorld {
  utility: string;
  end: string;
  surface: number;             // voxels there were to find; 0: nobody knows
  efficiency: number;
  per_second?: boolean;         // efficiency is the mean over the flight, else (5.6)
  resolution: number;          // m
  images: { time: number; position: Vec3; yaw: number; pitch: number; value: number;
            scored: number; observed: number | null }[];   // null while it is not known yet
  oracle: number[];            // observed by its images; empty where not compared
  candidates: { position: Vec3; direction: Vec3; value: number }[];   // at the end
  growth?: string;             // blobs, as exploration.ts reads them
  sights?: string;
}

// An image of an exploration that is being planned.
export interface TakenImage {
  type: "image";
  revision: number;
  utility: string;
  image: number;               // from 1 on
  asked: number;               // of so many
  surface: number;
  resolution: number;          // m
  time: number;
  position: Vec3;
  yaw: number;
  pitch: number;
  value: number;
  scored: number;
  observed: number | null;     // null: known at the end
  grown: number[];             // x, y, z, ... of voxels that are occupied for the first time, m
  sights: string;              // blob, of this image alone
}

// The episode of a run's folder.
export interface RunMessage {
  type: "run";
  id: string;
  folder: string;
  plan: Plan;
  certificate: Certificate | null;
  exploration: ExplorationWorld;
}

export interface World {
  scan?: ScanWorld;
  exploration?: ExplorationWorld;
  obstacles?: WorldObstacle[];
  subjects?: SubjectTrack[];
  margin?: number;
  bounds?: { lower?: Vec3; upper?: Vec3 } | null;
}

export interface Choices {
  vehicle?: Choice[];
  camera?: Choice[];
  solver?: Choice[];
  style?: Choice[];
  exporters?: Choice[];
  [other: string]: Choice[] | undefined;
}

export interface Welcome {
  type: "welcome";
  mission: MissionInfo;
  document: JsonObject | null;  // null: the script has an error
  revision: number;
  can_undo: boolean;
  can_redo: boolean;
  undo_label?: string;
  redo_label?: string;
  schema: unknown;              // read by installed.ts
  choices: unknown;
  world?: World | null;
  answer?: Answer | null;
}

export interface DocumentMessage {
  type: "document";
  revision: number;
  patch: Patch;
  by: string;
  label: string;
  can_undo: boolean;
  can_redo: boolean;
  undo_label?: string;
  redo_label?: string;
}

export interface Flown {
  type: "flown";
  edit: number | null;
  samples: { columns: Columns } | Columns;
  lost?: boolean;
  finished?: boolean;
  kept?: boolean;           // within the tolerance
  worst?: { position_error: number; time?: number; limit?: number; mean?: number } | null;
  runs?: { count: number; lost: number; kept: number; median: number; most: number };
  ways?: number[][];        // x, y, z, ... of each run
}

// What a drag of a scan comes to.
export interface Estimate {
  type: "estimate";
  edit: number;
  tab: string;
  tours?: number;            // no figures where the views of this state are not at hand
  why?: string;              // there are no figures
  changed?: boolean;         // of views of a plan with another region, other zones or starts
  images?: number;
  seconds?: number;          // of all tours
  known?: number;            // m^2 of surface
  seen?: number;
}

// Of a race that is flown by hand.
export interface Raced {
  type: "raced";
  id: string;
  time: number;              // s, from the start
  over: boolean;
  players: { name: string; by_hand: boolean; position: Vec3;
             orientation: [number, number, number, number];   // w, x, y, z; body to world
             speed: number; progress: number; deviation: number; score: number; end?: string }[];
  result?: string;           // lines, of a game that is over
  files?: string[];
}

// A first flight that is not flown yet.
export interface FirstFlight {
  type: "first_flight";
  edit: number | null;
  tab: string | null;
  level: number;                 // m, of the ground
  images: { position: Vec3; footprint: [number, number][] }[];
}

// Answers to questions about the scan on display.
export interface VoxelAnswer {
  type: "voxel";
  id: string;
  key: [number, number, number];
  middle: Vec3;
  edge: number;
  state: "unknown" | "free" | "occupied" | "between";
  log_odds: number;
  observations: number | null;   // null: the map does not count them
  image?: number;                // of an exploration: so many are in the map
  known_from?: number | null;    // likewise: since which it is known; 0: since the start
  weight?: number;               // of a scan
  share?: number;                // what all images tell of it
  images?: { tour?: number; number: number; distance: number; pixels: number; mm_per_pixel: number;
            incidence_deg?: number; told: number }[];
}

export type ImageOfVoxel = NonNullable<VoxelAnswer["images"]>[number];

export interface SliceAnswer {
  type: "slice";
  id: string;
  axis: "x" | "y" | "z";
  at: number;                    // m, middle of the layer
  edge: number;                  // of a voxel
  extent: [number, number];      // m, middles of the first and the last layer of the map
  image?: number;                // of an exploration: so many are in the map
  level: number;                 // a cell has 2^level voxels either way
  lower: [number, number];
  columns: number;
  rows: number;
  counts: Record<"unknown" | "free" | "occupied" | "between", number>;   // voxels
  clamps: [number, number];      // log odds
  cells: string;                 // blob, as looks.ts reads it
}

export type LeftOutReason = "outside" | "obstacle" | "unknown" | "close" | "no_fly" | "flight_zone" |
  "pilot" | "forbidden" | "thinned" | "nothing" | "apart" | "budget" | "not_chosen";

export interface LeftOutAnswer {
  type: "left_out";
  id: string;
  reasons: { reason: LeftOutReason; count: number }[];
  beyond: number;                // places that are not listed
  places: string;                // blob
}

export interface ViewAnswer {
  type: "view";
  id: string;
  candidate: number;             // from 0
  position: Vec3;
  yaw: number;
  pitch: number;
  score: number;                 // by itself
  ways: { candidate: number; seconds: number; points: Vec3[] }[];
  voxels: number;
  told: string;                  // blob: the voxels and what it tells of them
  picture: string;               // blob: PNG
}

export type LookAnswer = VoxelAnswer | SliceAnswer | LeftOutAnswer | ViewAnswer;

// A raster beneath the scene, or why it is not there.
export interface BackdropPicture {
  type: "backdrop";
  file: string;                  // its name
  system: string;                // of its coordinates
  heights: boolean;              // drawn as hills in the light
  width: number;                 // pixels of the picture
  height: number;
  pixel: number;                 // m
  pixel_of_file: number;
  cells: number;                 // along each side
  corners: number[];             // x, y, ... of their corners, m, rows from the top
  picture: string;               // blob, as backdrop.ts reads it
}

export type BackdropMessage = BackdropPicture | { type: "backdrop"; why: string };

export interface PlanningProgress {
  type: "progress";
  revision: number;
  phase: string;
  fraction: number | null;   // of the whole
  left: number | null;       // s
}

export type ServerMessage =
  | PlanningProgress
  | Welcome
  | DocumentMessage
  | Answer
  | Flown
  | Raced
  | Estimate
  | TakenImage
  | RunMessage
  | { type: "runs"; id: string; folders: string[] }
  | { type: "pace"; paused: boolean }
  | LookAnswer
  | BackdropMessage
  | FirstFlight
  | ({ type: "world" } & World)
  | { type: "refused"; id?: string; edit?: number; why: string }
  | { type: "failed"; id?: string; edit?: number; why: string }
  | { type: "script_changed"; conflict: boolean; message: string }
  | { type: "script_error"; message: string; line?: number }
  | { type: "script_loaded" }
  | { type: "mission"; mission: MissionInfo }
  | { type: "remark"; message: string }
  | { type: "worker"; role?: string; state: "started" | "crashed" | "message"; message?: string }
  | { type: "picture"; edit: number | null; time: number; blob: string }
  | { type: "wrote"; id: string; files: string[]; loss?: string | string[] };

export interface Gesture {
  type: "gesture" | "undo" | "redo";
  id: string;
  base: number;
  label?: string;
  patch?: Patch;
  after?: string[];        // gestures on their way that it was made on top of
}
