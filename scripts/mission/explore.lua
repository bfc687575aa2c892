-- SPDX-License-Identifier: Apache-2.0
-- Exploration of an unknown space (thesis chapter 5). In each step the vehicle takes a depth image,
-- updates its map, scores the reachable views and moves to the best one.
--
--   local explore = require "mission.explore"
--   return explore.of_scene { name = "city", scene = "downtown" }
--   return explore.of_mesh { name = "my mesh" }           -- --set input=FILE
--
-- `utility` is the value of a view: frontier, average_entropy, proximity_count, learned,
-- learned_grid, or oracle, which knows the surface. `map` selects the map plugin only. The
-- parameters that all map plugins share are options of the mission, because a learned utility is
-- valid for one set of values only.
local depth_sensor = require "mission.depth_sensor"
local mission_of = require "mission.mission_of"
local named_scene = require "mission.named_scene"

local M = {}

local width, height, view_deg = depth_sensor.image(2000)
local range, dropped, sigma = depth_sensor.depth(0.1)
local CAMERA = {
  width, height, view_deg,
  { name = "pitch_deg", type = "number", unit = "deg", default = -10, minimum = -89, maximum = 89,
    summary = "pitch of every view, positive upwards" },
  range, dropped, sigma,
  { name = "smooth_to", type = "number", unit = "m", default = 0, minimum = 0, maximum = 100,
    summary = "standard deviation to which the noise of `sigma` is smoothed before depth is "
      .. "mapped; 0: it is not" },
  { name = "stereo_baseline", type = "number", unit = "m", above = 0,
    summary = "baseline of a stereo pair; absent: a depth camera" },
}

-- Where neither the user nor the scene says otherwise.
local STANDARD = { step = 2.5, turn_deg = 25, body = 1, clear = 6, speed = 2 }
local MARGIN = 0.4  -- times the body's edge

local MOVES = {
  { name = "step", type = "number", unit = "m", above = 0,
    summary = "step along the axes of the camera; absent: that of the scene, else 2.5 m" },
  { name = "turn_deg", type = "number", unit = "deg", minimum = 1, maximum = 180,
    summary = "turn to a neighbour; absent: that of the scene, else 25 degrees" },
  { name = "body", type = "number", unit = "m", above = 0,
    summary = "edge of the box that must be free; absent: that of the scene, else 1 m" },
  { name = "clear", type = "number", unit = "m", above = 0,
    summary = "edge of the box assumed free at the start; absent: that of the scene, else 6 m" },
  { name = "visits", type = "integer", default = 2, minimum = 1, maximum = 100,
    summary = "largest number of images from a viewpoint" },
  { name = "speed", type = "number", unit = "m/s", above = 0,
    summary = "speed between viewpoints; absent: that of the scene, else 2 m/s" },
  { name = "turn_rate_deg", type = "number", unit = "deg/s", default = 60, above = 0,
    summary = "turn rate on the spot" },
  { name = "acceleration", type = "number", unit = "m/s^2", default = 1, above = 0,
    summary = "largest acceleration of a move, which is from rest to rest" },
  { name = "turn_acceleration_deg", type = "number", unit = "deg/s^2", default = 90, above = 0,
    summary = "likewise, of a turn" },
  { name = "pause", type = "number", unit = "s", default = 0.5, minimum = 0,
    summary = "pause for an image" },
}

local SETTLED = "the exploration sets it: set "
local OPTIONS = {
  { name = "vehicle", type = "vehicle", default = "vehicles/solo", summary = "vehicle" },
  { name = "model", type = "text", refused = "an exploration plans a path from view to view, "
    .. "without the motion of a vehicle model; set moves.speed and moves.turn_rate_deg, or scan "
    .. "the place with a model (examples/scan)" },
  { name = "utility", type = "plugin", kind = "utility", default = "learned",
    summary = "value of a view" },
  { name = "map", type = "plugin", kind = "map", default = "brick", summary = "map plugin",
    settled = { resolution = SETTLED .. "resolution", hit = SETTLED .. "hit",
                miss = SETTLED .. "miss", maximum_range = SETTLED .. "camera.range",
                observations = "an exploration needs them" } },
  { name = "resolution", type = "number", unit = "m", default = 0.4, minimum = 0.01,
    maximum = 10, summary = "edge of a voxel" },
  { name = "hit", type = "number", default = 0.9, minimum = 0.501, maximum = 0.999,
    summary = "occupancy probability of a voxel with a measured point" },
  { name = "miss", type = "number", default = 0.1, minimum = 0.001, maximum = 0.499,
    summary = "occupancy probability of a voxel that a ray passed" },
  { name = "camera", type = "table", table = CAMERA, summary = "depth camera" },
  { name = "moves", type = "table", table = MOVES, summary = "moves from a viewpoint" },
  { name = "steps", type = "integer", default = 200, minimum = 1, maximum = 1000000,
    summary = "largest number of images" },
  { name = "efficiency", type = "choice", default = "images", choices = { "images", "seconds" },
    summary = "what the views are chosen for: surface per image, or per second of flight" },
  { name = "lookahead", type = "integer", default = 1, minimum = 1, maximum = 4,
    summary = "length of the evaluated view sequences; 1: the next view only" },
  { name = "margin", type = "number", unit = "m", minimum = 0,
    summary = "certified distance from obstacles of the final map; absent: 0.4 of moves.body" },
  { name = "budget", type = "number", unit = "s", above = 0,
    summary = "flight time; absent: one battery" },
  { name = "wall_clock_guard", type = "number", unit = "s", above = 0,
    summary = "limit of computing time; a run that it ends may not be repeatable" },
  { name = "compare", type = "boolean", default = true,
    summary = "run the oracle from the same start, for comparison" },
  { name = "start", type = "numbers", size = 3, unit = "m",
    summary = "start position; absent: drawn with the seed of the run" },
  { name = "start_yaw_deg", type = "number", unit = "deg", minimum = -360,
    maximum = 360, summary = "heading at the start; absent: 0" },
  { name = "lower", type = "numbers", size = 3, unit = "m",
    summary = "lower corner of the bounding box of the flight; absent: no box" },
  { name = "upper", type = "numbers", size = 3, unit = "m",
    summary = "upper corner of the bounding box of the flight" },
}

local function options_with(more)
  local all = {}
  for _, list in ipairs { more, OPTIONS } do
    for _, declared in ipairs(list) do all[#all + 1] = declared end
  end
  return all
end

local function map_of(o)
  local made = type(o.map) == "table" and o.map or { type = o.map }
  made.resolution, made.hit, made.miss = o.resolution, o.hit, o.miss
  made.maximum_range, made.observations = o.camera.range, true
  return made
end

-- How it moves: as the user says, else as the scene recommends; and a sentence where that is so.
local function moves_of(run, surface)
  local moves, own, said = {}, surface.moves, {}
  for key, value in pairs(run.options.moves) do moves[key] = value end
  for _, key in ipairs { "step", "turn_deg", "body", "clear", "speed" } do
    if moves[key] == nil then
      moves[key] = own[key] or STANDARD[key]
      if own[key] then said[#said + 1] = string.format("%s = %.4g", key, own[key]) end
    end
  end
  if #said == 0 then return moves end
  return moves, string.format("moves that the scene '%s' recommends: %s (--set moves.KEY=VALUE "
                              .. "sets others)", surface.name, table.concat(said, ", "))
end

-- Explores the surface, and what came of it as a plan.
function M.explore(run, surface)
  local o = run.options
  local m, note = moves_of(run, surface)
  local margin = o.margin or MARGIN * m.body
  if margin > m.body / 2 then
    run:fail("margin", string.format("at most half of moves.body, %.4g m", m.body / 2))
  end
  if (o.lower == nil) ~= (o.upper == nil) then
    run:fail(o.lower and "lower" or "upper", "lower and upper belong together")
  end
  if o.start_yaw_deg and not o.start then
    run:fail("start_yaw_deg", "is the heading at the start: give both")
  end
  local vehicle = run:vehicle(o.vehicle)
  if o.budget and o.budget > vehicle.flight_time then
    run:fail("budget", string.format("%.6g s are more than one battery, %.6g s", o.budget,
                                     vehicle.flight_time))
  end
  local c = o.camera
  run:phase("exploration")
  local done = run:explore {
    surface = surface, map = map_of(o), utility = o.utility,
    camera = { width = c.width, height = c.height, view_deg = c.view_deg,
               pitch_deg = c.pitch_deg },
    range = c.range, noise = { dropped = c.dropped, sigma = c.sigma, smooth_to = c.smooth_to },
    stereo_baseline = c.stereo_baseline,
    step = m.step, turn_deg = m.turn_deg, body = m.body, clear = m.clear, visits = m.visits,
    speed = m.speed, turn_rate_deg = m.turn_rate_deg, acceleration = m.acceleration,
    turn_acceleration_deg = m.turn_acceleration_deg, pause = m.pause,
    steps = o.steps, efficiency = o.efficiency, lookahead = o.lookahead,
    budget = o.budget or vehicle.flight_time,
    wall_clock_guard = o.wall_clock_guard,
    compare = o.compare, ground = o.ground or false,
    bounds = o.lower and { { lower = o.lower, upper = o.upper } } or {},
    start = o.start and { { position = o.start, yaw = math.rad(o.start_yaw_deg or 0) } } or {},
  }
  return done:plan { vehicle = vehicle, margin = margin, note = note }
end

local function mission(given, more, surface_of)
  return mission_of("explore", options_with(more), given,
                    function(run) return M.explore(run, surface_of(run)) end)
end

-- A scene that scripts/scene makes.
---@param given lapwing.explore.of_scene
---@return lapwing.mission
function M.of_scene(given)
  return mission(given, {
    { name = "scene", type = "text", summary = "scene of scripts/scene: downtown, street, ..." },
    { name = "scene_seed", type = "integer", default = 1, minimum = 0, maximum = 9007199254740991,
      summary = "seed of the scene" },
  }, function(run) return run:surface(named_scene(run)) end)
end

-- A mesh file.
---@param given lapwing.explore.of_mesh
---@return lapwing.mission
function M.of_mesh(given)
  return mission(given, {
      { name = "input", type = "text", summary = "mesh file" },
      { name = "unit", type = "number", unit = "m", above = 0, maximum = 1e6,
        summary = "metres per unit of the mesh file; absent: as the file says" },
      { name = "up", type = "choice", default = "file", choices = { "file", "x", "y", "z" },
        summary = "axis of the mesh that points up; file: as the file says" },
      { name = "ground", type = "boolean", default = true,
        summary = "add a ground plane and explore above it; false: explore inside the mesh" },
    }, function(run)
      if not run.options.input then
        lapwing.fail("name a mesh file: --set input=PATH (.obj, .dae, .ply, ...)")
      end
      local o = run.options
      local surface = run:read_surface { file = o.input, unit = o.unit, up = o.up }
      local extent = 0
      for axis = 1, 3 do
        extent = math.max(extent, surface.upper[axis] - surface.lower[axis])
      end
      if extent < 5 * o.resolution then
        run:fail(o.unit and "unit" or "input", string.format(
          "the mesh is %.3g m across, less than five voxels of %.3g m: is its unit right?", extent,
          o.resolution))
      end
      return surface
    end)
end

return M
