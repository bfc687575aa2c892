-- SPDX-License-Identifier: Apache-2.0
-- An exploration in place of the first flight of a scan (thesis 6.1): the drone maps an unknown
-- place, and then scans with this map and its mesh, in one visit.
local meshing = require "mission.scan_meshing"
local patterns = require "mission.scan_patterns"

local M = {}

-- What a learned utility was trained with (reading 5.2); the scan's map is made the same way.
M.RESOLUTION = 0.4  -- m, unless said otherwise
local HIT, MISS, PITCH_DEG, VIEW_DEG = 0.9, 0.1, -10, 90
local WIDTH, HEIGHT = 160, 120

M.DECLARATION = { name = "exploration", type = "table",
  summary = "exploration without prior knowledge, in place of the first flight", table = {
    { name = "images", type = "integer", default = 0, minimum = 0, maximum = 100000,
      summary = "largest number of depth images; 0: no exploration" },
    { name = "budget", type = "number", unit = "s", above = 0,
      summary = "flight time; absent: one battery minus the budget of the tour" },
    { name = "range", type = "number", unit = "m", default = 20, minimum = 1, maximum = 1000,
      summary = "largest depth" },
    { name = "speed", type = "number", unit = "m/s", default = 2, above = 0,
      summary = "speed between viewpoints" },
    { name = "clear", type = "number", unit = "m", default = 6, minimum = 1, maximum = 100,
      summary = "edge of the box at the start that is assumed free" },
    { name = "start", type = "numbers", size = 3, unit = "m",
      summary = "start position; absent: drawn with the seed of the run" },
    { name = "start_yaw_deg", type = "number", unit = "deg", minimum = -360,
      maximum = 360, summary = "heading at the start; absent: 0" },
  } }

function M.wanted(run)
  return run.options.exploration.images > 0
end

-- What its options say, before anything is flown.
function M.check(run)
  local o, e = run.options, run.options.exploration
  if e.start_yaw_deg and not e.start then
    run:fail("exploration.start_yaw_deg", "is the heading at exploration.start: give both")
  end
  if e.images == 0 then
    for _, option in ipairs { "exploration.budget", "exploration.range", "exploration.speed",
                              "exploration.clear", "exploration.start", "utility" } do
      if run:stated(option) then
        run:fail(option, "needs an exploration: set exploration.images")
      end
    end
    return
  end
  if e.images == 1 then run:fail("exploration.images", "at least 2, or 0 for no exploration") end
  for _, option in ipairs { "map.hit", "map.miss" } do
    if run:stated(option) then
      run:fail(option, string.format("the map of an exploration has hit %g and miss %g: remove it",
                                     HIT, MISS))
    end
  end
  for option, given in pairs { ["prior.map"] = o.prior.map, flights = o.flights[1] } do
    if given then
      run:fail(option, "an exploration replaces flights and files of an earlier "
                       .. "flight: remove them")
    end
  end
end

-- One visit, one battery: the seconds that an exploration may take before a tour of so many.
function M.seconds(run, vehicle, tour)
  local budget = M.wanted(run) and run.options.exploration.budget
  local left = vehicle.flight_time - tour
  if left < 0 then
    run:fail("tour", string.format("a budget of %.6g s is more than one battery, %.6g s", tour,
                                   vehicle.flight_time))
  end
  if budget and budget > left then
    run:fail("exploration", string.format(
      "%.6g s of it and a tour of %.6g s are more than one battery, %.6g s: a smaller "
      .. "exploration.budget or tour.budget", budget, tour, vehicle.flight_time))
  end
  if M.wanted(run) and left == 0 then
    run:fail("exploration", string.format("a tour of %.6g s uses the whole battery",
                                          tour))
  end
  return budget or left
end

local function map_of(o, range)
  local map = {}
  for key, value in pairs(type(o.map) == "table" and o.map or { type = o.map }) do
    map[key] = value
  end
  map.resolution, map.maximum_range = o.resolution or M.RESOLUTION, range
  map.hit, map.miss = HIT, MISS
  return map
end

-- The prior with its mesh after an exploration of at most `seconds` within the box `room`, and the
-- views, the last one first. `region` is the region of the scan.
function M.knowledge(run, surface, region, room, seconds, vehicle)
  local o = run.options
  local e = o.exploration
  run:phase("exploration")
  local own = map_of(o, e.range)
  own.observations = true
  local body = 2 * math.max(table.unpack(o.body))
  local done = run:explore {
    surface = surface, map = own, utility = o.utility, steps = e.images, budget = seconds,
    camera = { width = WIDTH, height = HEIGHT, view_deg = VIEW_DEG, pitch_deg = PITCH_DEG },
    range = e.range, noise = o.noise, body = body, clear = e.clear, speed = e.speed,
    bounds = { room },
    start = e.start and { { position = e.start, yaw = math.rad(e.start_yaw_deg or 0) } } or {},
  }
  if done.images < 2 then
    run:fail("exploration", string.format("it ended after one image (of %.6g s it had): %s",
                                          seconds, done.reason))
  end
  -- The tour's certificate begins where this flight ends.
  local judged = run:certify(done:plan { vehicle = vehicle, margin = math.min(o.margin, body / 2) })
  if not judged.feasible then
    run:fail("exploration", "the exploration is not certified: " .. judged.failures[1])
  end
  local known = run:prior { map = map_of(o, e.range), spacing = o.surface.spacing,
                            range = e.range, stride = o.surface.stride }
  known:open_air { lower = done.cleared.lower, upper = done.cleared.upper, surface = surface }
  known:look { surface = surface, poses = done.views, range = e.range, noise = o.noise,
               camera = { width = WIDTH, height = HEIGHT,
                          focal = WIDTH / 2 / math.tan(math.rad(VIEW_DEG) / 2) } }
  known:reconstruct(meshing(run))
  local poses = {}
  for k = #done.views, 1, -1 do poses[#poses + 1] = done.views[k] end
  -- The tour begins where the exploration ended, with a look at what is to be scanned.
  poses[1] = patterns.looking_in(poses[1].position, region, 0)
  return known, poses, done
end

return M
