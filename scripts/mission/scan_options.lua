-- SPDX-License-Identifier: Apache-2.0
-- The options of scans. Readings 4.3, 4.6 and 4.11 explain defaults that the thesis does not give.
local city = require "mission.scan_city"
local exploration = require "mission.scan_exploration"
local fleet = require "mission.scan_fleet"
local passes = require "mission.scan_passes"
local regions = require "mission.scan_regions"
local site = require "mission.scan_site"
local tiles = require "mission.scan_tiles"
local views = require "mission.scan_views"
local wishes = require "mission.scan_wishes"
local zones = require "mission.scan_zones"

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
  integer("width", 600, 1, 10000, "width of the image in pixels"),
  integer("height", 450, 1, 10000, "height of the image in pixels"),
  number("focal", 345, "px", "focal length", { above = 0, maximum = 1e5 }),
}

local PATTERN = {
  { name = "pattern", type = "choice", choices = { "circle", "crosshatch", "ellipse", "meander" },
    default = "meander", summary = "pattern of places over the region" },
  number("height", nil, "m",
         "height in the world; absent: 15 m above safe_height, for a crosshatch 5 m",
         { maximum = 1e5 }),
  integer("views", nil, 1, 10000,
          "number of depth images; absent: 30, for a crosshatch as its spacing gives, at most 400"),
  number("pitch_deg", nil, "deg", "pitch of the camera, for a circle the largest one; absent: -60, "
         .. "for a crosshatch -45", { minimum = -90, maximum = 0 }),
  number("reach", nil, "m",
         "distance beyond the region; absent: 5 m, for a crosshatch half its height "
         .. "above the floor of the region, at most `reach` of the mission", NOT_NEGATIVE),
}

local DECLARATIONS = {
  { name = "scene", type = "text",
    summary = "scene of scripts/scene, in which the first flight takes place" },
  integer("scene_seed", 1, 0, 9007199254740991, "seed of the scene"),
  integer("scene_districts", nil, 1, 16,
          "districts along each side of the scene `town`, of 126 m each; absent: 2"),
  { name = "input", type = "text", summary = "mesh file, over which the first flight takes place; "
    .. "point cloud of `scan.of_cloud`, or raster of heights of `scan.of_terrain`" },
  { name = "ground", type = "boolean", default = false,
    summary = "add a ground plane under the mesh" },
  number("unit", nil, "m", "metres per unit of the mesh file; absent: as the file says. Of a cloud "
         .. "or raster without reference system; absent: 1", POSITIVE),
  { name = "up", type = "choice", default = "file", choices = { "file", "x", "y", "z" },
    summary = "axis of the mesh file that points up; file: as the file says" },
  { name = "prior", type = "table",
    summary = "map and mesh of an earlier flight; they need start and region", table = {
    { name = "map", type = "text", summary = "map file, .ot or .bt" },
    { name = "mesh", type = "text", summary = "mesh file, in the frame of the map" } } },
  site.DECLARATIONS[1], site.DECLARATIONS[2], city.DECLARATION,
  { name = "region", type = "table", summary = "region of interest; absent: "
    .. "that of the scene, the bounding box of the mesh and a distance around it, or that of the "
    .. "surveyor's data", table = {
    place("lower", "lowest corner, world"), place("upper", "highest corner, world") } },
  place("start", "start of the tour; absent: the view of the first flight that is connected to "
        .. "most candidates"),
  place("finish", "end of the tour; absent: its start"),
  number("safe_height", nil, "m",
         "height in the world above which the user states that the air is free; "
         .. "absent: 4 m above the region",
         { minimum = -1e5, maximum = 1e5 }),
  number("ceiling", nil, "m",
         "largest height of the tour in the world; absent: just above the first flight",
         { maximum = 1e5 }),
  number("floor", 2, "m",
         "smallest height of the tour, above the lower corner of the region", NOT_NEGATIVE),
  number("reach", 20, "m", "largest distance of the tour from the region", NOT_NEGATIVE),
  number("margin", 0.4, "m",
         "distance from map and mesh that the certificate requires", NOT_NEGATIVE),
  { name = "body", type = "numbers", size = 3, unit = "m", default = { 1, 1, 0.5 },
    summary = "half edges of the box that must be free in the map" },
  number("mesh_room", 1, "m", "additional distance from the prior mesh", NOT_NEGATIVE),
  { name = "flights", type = "tables", table = PATTERN,
    summary = "first flights, into one map; absent: a crosshatch, and a grid "
    .. "that looks down" },
  exploration.DECLARATION,
  { name = "utility", type = "plugin", kind = "utility", default = "learned",
    summary = "value of a view in an exploration" },
  { name = "camera", type = "table", table = CAMERA, summary = "camera of all images" },
  { name = "noise", type = "table", summary = "noise of the depth images", table = {
    number("dropped", 0, "", "fraction of pixels without a measurement",
           { minimum = 0, maximum = 1 }),
    number("sigma", 0, "m", "standard deviation of the depth", { minimum = 0, maximum = 100 }) } },
  number("range", nil, "m", "largest depth; absent: 60 m, up to 200 m if the first flight needs it "
         .. "to see the floor", POSITIVE),
  { name = "usable", type = "table", summary = "limits within which an image is of use to the "
    .. "model; `lapwing evaluate scan` judges by the same", table = {
    number("range", nil, "m", "largest distance of a surface; absent: 30 m for a focal length of "
           .. "345 px, in proportion to it; for images in passing, any", POSITIVE),
    number("incidence_deg", 75, "deg", "largest angle between the ray and the normal of a surface",
           { above = 0, maximum = 90 }) } },
  number("pixel_error", 0.5, "px", "standard deviation of a point's place in an image, for the "
         .. "predicted accuracy", { above = 0, maximum = 100 }),
  views.DECLARATION,
  { name = "effort", type = "table", summary = "effort of computing", table = {
    integer("pixels", 0, 0, 10000, "pixels per row in the first flight and in the evaluation of "
            .. "views; 0: those of the camera. The plan keeps the camera"),
    number("resolution", 0.2, "m", "edge of a voxel, if nothing else determines it", VOXEL) } },
  number("resolution", nil, "m", "edge of a voxel; absent: that of the prior map, 0.4 m with an "
         .. "exploration, else effort.resolution", VOXEL),
  { name = "surface", type = "table", summary = "reconstruction of the prior mesh", table = {
    number("spacing", 0.4, "m", "distance between fused points", POSITIVE),
    number("cell", 0.5, "m", "cell of the reconstruction", POSITIVE),
    number("trim", 1, "m", "surface farther than this from every point is left out", POSITIVE),
    { name = "method", type = "choice", default = "auto", choices = { "auto", "poisson", "local" },
      summary = "one field through all points, or each place from the points around it, for large "
      .. "regions; auto: poisson for up to 250,000 points" },
    integer("stride", 2, 1, 64, "fuse every n-th pixel") } },
  { name = "candidates", type = "table", summary = "candidate views", table = {
    integer("most", 2000, 1, 100000, "largest number of candidates"),
    integer("least", 0, 0, 100000, "number below which random free places are added"),
    integer("directions", 3, 1, 1000, "viewing directions per place, if there are many places"),
    number("step", 1.5, "m", "distance of neighbouring places at the region", POSITIVE),
    number("step_growth", 0.2, "",
           "growth of that distance, per metre from the region", NOT_NEGATIVE),
    number("distance_apart", 1, "m",
           "smallest distance of two candidates, unless their angle differs", POSITIVE),
    number("angle_apart_deg", 15, "deg",
           "smallest angle of two candidates, unless their place differs",
           { minimum = 0, maximum = 180 }) } },
  tiles.DECLARATION,
  { name = "motions", type = "table", summary = "motions between views", table = {
    integer("neighbours", 12, 1, 1000, "number of matching views to which a view is connected"),
    integer("among", 120, 1, 100000, "number of nearest views from which these are chosen"),
    number("alpha", 0.4, "",
           "smallest common content of connected views, (4.8)", { minimum = 0, maximum = 1 }),
    integer("coarse", 120, 1, 10000, "pixels per row of compared views") } },
  { name = "flight", type = "table", summary = "flight along the tour", table = {
    number("speed", 3, "m/s", "speed between views", POSITIVE),
    number("view_speed", 0.5, "m/s", "speed near a view", POSITIVE),
    number("slow_within", 3, "m", "distance from a view within which view_speed holds", POSITIVE),
    number("pause", 0.5, "s", "rest at a view, for the image", { minimum = 0, maximum = 60 }),
    number("view_seconds", 3, "s",
           "time added to a leg for the view at its end", { minimum = 0, maximum = 60 }),
    number("acceleration", 2, "m/s^2", "largest acceleration", POSITIVE),
    { name = "smooth", type = "boolean", default = false,
      summary = "legs by a trajectory solver, instead of pure pursuit" },
    number("stray", 0.1, "m", "largest distance of a smooth leg from its path", POSITIVE) } },
  { name = "model", type = "plugin", kind = "vehicle_model", default = "quadrotor",
    summary = "vehicle model; models other than quadrotor need flight.smooth; one that cannot "
    .. "stand still takes its images in passing" },
  { name = "solver", type = "plugin", kind = "trajectory_solver", default = "iqp",
    summary = "trajectory solver of smooth legs and of flights in passing" },
  passes.DECLARATION,
  { name = "closed_loop", type = "choice", default = "required",
    choices = { "required", "reported" },
    summary = "whether the certificate requires the simulated flight" },
  integer("rounds", 1, 1, 5, "rounds of planning in simulation"),
  { name = "vehicle", type = "vehicle", default = "vehicles/solo", summary = "vehicle" },
  { name = "map", type = "plugin", kind = "map", default = "brick", summary = "map plugin",
    settled = { resolution = "set resolution instead", maximum_range = "set range instead" } },
  { name = "information", type = "plugin", kind = "information", default = "fronto_parallel",
    summary = "information of a view about a voxel" },
  { name = "planner", type = "plugin", kind = "path_planner", default = "rrt_connect",
    summary = "path planner, if the straight line between two views is blocked" },
  { name = "tour", type = "plugin", kind = "tour_solver", under = "solver",
    default = "local_search", summary = "solver of the tour and its parameters", table = {
      number("budget", nil, "s", "flight time; absent: 300 s", POSITIVE),
      number("budget_metres", nil, "m",
             "flight time as a length at 3 m/s, in place of budget", POSITIVE),
      integer("images", 0, 0, 100000, "largest number of images; 0: any number"),
      number("guard", 300, "s", "limit of computing time of each solver; a run that it ends may "
             .. "not repeat", POSITIVE),
      { name = "begin", type = "text", summary =
        "solver whose tour local_search improves, or none; absent: the better one of cost_benefit "
        .. "and recursive_greedy; of several tours cost_benefit" } } },
}

for _, list in ipairs { regions.DECLARATIONS, zones.DECLARATIONS, wishes.DECLARATIONS,
                        fleet.DECLARATIONS } do
  table.move(list, 1, #list, #DECLARATIONS + 1, DECLARATIONS)
end

return DECLARATIONS
