-- SPDX-License-Identifier: Apache-2.0
-- What a scan can be told (readings 4.3, 4.6, 4.11 for defaults that the thesis never gives).
local exploration = require "mission.scan_exploration"
local passes = require "mission.scan_passes"

local function number(name, default, unit, summary, more)
  local entry = { name = name, type = "number", default = default, unit = unit, summary = summary }
  for key, value in pairs(more or {}) do entry[key] = value end
  return entry
end

local function integer(name, default, least, most, summary)
  return { name = name, type = "integer", default = default, minimum = least, maximum = most,
           summary = summary }
end

local function place(name, summary)
  return { name = name, type = "numbers", size = 3, unit = "m", summary = summary }
end

local POSITIVE, NOT_NEGATIVE = { above = 0, maximum = 1e6 }, { minimum = 0, maximum = 1e6 }

local VOXEL = { minimum = 0.01, maximum = 10 }

local CAMERA = {
  integer("width", 600, 1, 10000, "pixels"), integer("height", 450, 1, 10000, "pixels"),
  number("focal", 345, "px", "focal length", { above = 0, maximum = 1e5 }),
}

local PATTERN = {
  { name = "pattern", type = "choice", choices = { "circle", "crosshatch", "ellipse", "meander" },
    default = "meander", summary = "over the region" },
  number("height", nil, "m", "of flight, world; absent: 15 m above safe_height, a crosshatch 5 m",
         { maximum = 1e5 }),
  integer("views", nil, 1, 10000,
          "depth images; absent: 30, of a crosshatch as many as overlap wants, 400 at most"),
  number("pitch_deg", nil, "deg", "of the camera; a circle's looks in, no higher than this; "
         .. "absent: -60, a crosshatch's -45", { minimum = -90, maximum = 0 }),
  number("reach", nil, "m", "beyond the region; absent: 5 m, a crosshatch half its height over "
         .. "the region's floor, within the mission's reach", NOT_NEGATIVE),
}

local DECLARATIONS = {
  { name = "scene", type = "text", summary = "a scene of scripts/scene for the flight" },
  integer("scene_seed", 1, 0, 9007199254740991, "of the scene"),
  { name = "input", type = "text", summary = "a mesh file in place of a scene" },
  { name = "ground", type = "boolean", default = false,
    summary = "add a ground plane under the mesh" },
  number("unit", nil, "m", "that one unit of the mesh file is; absent: what it says", POSITIVE),
  { name = "up", type = "choice", default = "file", choices = { "file", "x", "y", "z" },
    summary = "axis of the mesh file that points up; file: as the file says" },
  { name = "prior", type = "table", summary = "map and mesh of an earlier flight", table = {
    { name = "map", type = "text", summary = "a map, .ot or .bt" },
    { name = "mesh", type = "text", summary = "a mesh in the map's frame" } } },
  { name = "region", type = "table", summary = "of interest; absent: the "
    .. "scene's, or a mesh's bounds and so much round them as body and a view take", table = {
    place("lower", "lowest corner, world"), place("upper", "highest corner, world") } },
  place("start", "where the tour begins; absent: the first of the first flight's views that most "
        .. "others are joined to"),
  place("finish", "where it ends; absent: where it begins"),
  number("safe_height", nil, "m", "above it the air is free, world; absent: 4 m over the region",
         { minimum = -1e5, maximum = 1e5 }),
  number("ceiling", nil, "m", "highest flight, world; absent: just over the first one",
         { maximum = 1e5 }),
  number("floor", 2, "m", "lowest flight, over the region's lower corner", NOT_NEGATIVE),
  number("reach", 20, "m", "how far round the region the tour may go", NOT_NEGATIVE),
  number("margin", 0.4, "m", "that the certificate wants kept", NOT_NEGATIVE),
  { name = "body", type = "numbers", size = 3, unit = "m", default = { 1, 1, 0.5 },
    summary = "half edges of the box that must be free" },
  number("mesh_room", 1, "m", "more that is kept from the prior mesh", NOT_NEGATIVE),
  { name = "flights", type = "tables", table = PATTERN,
    summary = "first flights, into one map; absent: a crosshatch, and a grid "
    .. "that looks down" },
  exploration.DECLARATION,
  { name = "utility", type = "plugin", kind = "utility", default = "learned",
    summary = "value of a view in an exploration" },
  { name = "camera", type = "table", table = CAMERA, summary = "of all images" },
  { name = "noise", type = "table", summary = "of measured depth", table = {
    number("dropped", 0, "", "share of pixels without a measurement", { minimum = 0, maximum = 1 }),
    number("sigma", 0, "m", "deviation", { minimum = 0, maximum = 100 }) } },
  number("range", nil, "m", "of depth and of rays; absent: 60 m, or so far that the first flight "
         .. "sees the region's floor in the middle of its images", POSITIVE),
  { name = "effort", type = "table", summary = "of computing; the plan keeps its camera", table = {
    integer("pixels", 0, 0, 10000, "a row, of the smaller images that the first flight takes and "
            .. "views are weighed by; 0: the camera's"),
    number("resolution", 0.2, "m", "edge of a voxel, where nothing else settles it", VOXEL) } },
  number("resolution", nil, "m", "edge of a voxel; absent: that of the prior's map, 0.4 m of an "
         .. "exploration, else effort.resolution", VOXEL),
  { name = "surface", type = "table", summary = "the prior mesh", table = {
    number("spacing", 0.4, "m", "between fused points", POSITIVE),
    number("cell", 0.5, "m", "of the reconstruction", POSITIVE),
    number("trim", 1, "m", "surface farther from every point is left out", POSITIVE),
    integer("stride", 2, 1, 64, "every so many pixels are fused") } },
  { name = "candidates", type = "table", summary = "candidate views", table = {
    integer("most", 2000, 1, 100000, "views"),
    integer("least", 0, 0, 100000, "where growing finds fewer, free places are drawn as well"),
    integer("directions", 3, 1, 1000, "of each place, where there are many places"),
    number("step", 1.5, "m", "between neighbours at the region", POSITIVE),
    number("step_growth", 0.2, "", "m more for every metre away from it", NOT_NEGATIVE),
    number("distance_apart", 1, "m", "or so far in angle", POSITIVE),
    number("angle_apart_deg", 15, "deg", "or so far in distance",
           { minimum = 0, maximum = 180 }) } },
  { name = "motions", type = "table", summary = "motions between views", table = {
    integer("neighbours", 12, 1, 1000, "that each view is joined with"),
    integer("among", 120, 1, 100000, "nearest views, of those whose images match"),
    number("alpha", 0.4, "", "share that matchable views see in common", { minimum = 0,
           maximum = 1 }),
    integer("coarse", 120, 1, 10000, "pixels across, of compared views") } },
  { name = "flight", type = "table", summary = "along the tour", table = {
    number("speed", 3, "m/s", "on the way", POSITIVE),
    number("view_speed", 0.5, "m/s", "near a view", POSITIVE),
    number("slow_within", 3, "m", "of a view", POSITIVE),
    number("pause", 0.5, "s", "in a view, for the image", { minimum = 0, maximum = 60 }),
    number("view_seconds", 3, "s", "that a view costs at least", { minimum = 0, maximum = 60 }),
    number("acceleration", 2, "m/s^2", "largest that is asked for", POSITIVE),
    { name = "smooth", type = "boolean", default = false,
      summary = "legs by a trajectory solver, instead of pure pursuit" },
    number("stray", 0.1, "m", "that smooth legs may leave their ways at corners", POSITIVE) } },
  { name = "model", type = "plugin", kind = "vehicle_model", default = "quadrotor",
    summary = "vehicle model; another than quadrotor needs flight.smooth, and one that cannot "
    .. "stand still takes images in passing" },
  { name = "solver", type = "plugin", kind = "trajectory_solver", default = "iqp",
    summary = "of smooth legs and of flights in passing" },
  passes.DECLARATION,
  { name = "closed_loop", type = "choice", default = "required",
    choices = { "required", "reported" }, summary = "whether the controlled flight must pass" },
  integer("rounds", 1, 1, 5, "of planning; each but the first sees what the one before flew"),
  { name = "vehicle", type = "vehicle", default = "vehicles/solo", summary = "file or table" },
  { name = "map", type = "plugin", kind = "map", default = "brick", summary = "map plugin",
    settled = { resolution = "set resolution instead", maximum_range = "set range instead" } },
  { name = "information", type = "plugin", kind = "information", default = "fronto_parallel",
    summary = "information of a view about a voxel" },
  { name = "planner", type = "plugin", kind = "path_planner", default = "rrt_connect",
    summary = "path planner, if the straight line between two views is blocked" },
  { name = "tour", type = "plugin", kind = "tour_solver", under = "solver",
    default = "local_search", summary = "solver of the tour and its parameters", table = {
      number("budget", nil, "s", "of flight; absent: 300", POSITIVE),
      number("budget_metres", nil, "m", "in place of seconds, at 3 m/s", POSITIVE),
      integer("images", 0, 0, 100000, "most images; 0 for any number"),
      number("guard", 300, "s", "of computing, of one solver; ended so, a tour may differ "
             .. "from run to run", POSITIVE),
      { name = "begin", type = "text", summary =
        "the solver whose tour local_search improves; absent: cost_benefit; or none" } } },
}

return DECLARATIONS
