-- SPDX-License-Identifier: Apache-2.0
-- Light paintings (thesis 3.7.1): strokes of a drawing, flown with a light that is on along them.
--
--   local light_painting = require "mission.light_painting"
--   return light_painting.text { name = "hello", text = "HELLO", height = 2 }
--
-- A drawing is a text in a font of strokes, an SVG picture, or points. It is vertical. `base` is
-- the centre of its lower edge. Spectators look along `view_yaw_deg`.
local mission_of = require "mission.mission_of"
local drawing_times = require "mission.drawing_times"
local drawings = require "mission.drawings"
local order = require "mission.stroke_order"
local paths = require "mission.paths"
local point_mass = require "mission.point_mass"

local M = {}

local function weight(name, default, summary)
  return { name = name, type = "number", default = default, minimum = 0, summary = summary }
end

local STEP = 0.05           -- s, unless `step` says otherwise or the flight is long
local LONGEST_STEP = 0.2    -- s; coarser stages round off what is drawn
local MOST_STAGES = 3000

local DECLARATIONS = {
  { name = "text", type = "text", summary = "text to draw" },
  { name = "font", type = "text",
    summary = "Hershey font, a .jhf file; absent: the built-in capitals" },
  { name = "svg", type = "text", summary = "SVG file whose paths are drawn" },
  { name = "input", type = "text", summary = "SVG file, from the command line" },
  { name = "strokes", type = "tables", summary = "strokes to draw", table = {
    { name = "points", type = "numbers", summary = "x, y, x, y, ..., with y upwards" } } },
  { name = "height", type = "number", unit = "m", default = 2, minimum = 0.01,
    summary = "height of a capital letter, or of the picture" },
  { name = "base", type = "numbers", size = 3, unit = "m", default = { 0, 0, 2 },
    summary = "centre of the lower edge of the drawing, world" },
  { name = "view_yaw_deg", type = "number", unit = "deg", default = 90,
    summary = "viewing direction of the spectators; 90: from south to north" },
  { name = "reorder", type = "boolean", default = true,
    summary = "reorder and reverse strokes to shorten the flight" },
  { name = "gap", type = "number", unit = "s", default = 0, minimum = 0, maximum = 60,
    summary = "time at rest in the dark before each further stroke; 0: the flight does not stop" },
  { name = "facing", type = "choice", default = "east", choices = { "east", "camera" },
    summary = "where the front of the vehicle points: east, or to the camera of the exposure" },
  { name = "vehicle", type = "vehicle", default = "vehicles/solo", summary = "vehicle" },
  { name = "speed", type = "number", unit = "m/s", default = 1.5, minimum = 0.01,
    summary = "largest speed, in addition to the limits of the vehicle" },
  { name = "acceleration", type = "number", unit = "m/s^2", default = 2, minimum = 0.01,
    summary = "largest acceleration, along and across the path together" },
  { name = "rounding", type = "number", unit = "m", default = 0.015, minimum = 0, maximum = 1,
    summary = "rounding of sharp corners" },
  { name = "tolerance", type = "number", unit = "m", minimum = 1e-4,
    summary = "largest mean distance between light and stroke; absent: 1 % of height" },
  { name = "slowest", type = "number", default = 0.1, minimum = 0.01, maximum = 1,
    summary = "smallest factor on the speed that is tried" },
  { name = "step", type = "number", unit = "s", minimum = 0.005, maximum = LONGEST_STEP,
    summary = "time between stages; absent: 0.05 s, longer beyond 3000 stages" },
  { name = "weights", type = "table", summary = "weights of the cost terms", table = {
    weight("drawing", 1e4, "distance from the timed path"),
    weight("smoothness", 1e-4, "squared snap; large values round the letters (thesis, fig. 3.8 B)"),
    weight("effort", 1e-4, "force and yaw torque beyond hovering") } },
  { name = "model", type = "plugin", kind = "vehicle_model", default = "quadrotor",
    summary = "vehicle model, one that can stand still" },
  { name = "solver", type = "plugin", kind = "trajectory_solver", default = "iqp",
    summary = "trajectory solver" },
  { name = "controller", type = "text",
    summary = "plugin that flies the plan; absent: that of the vehicle, or `thesis`" },
}

local SLOWER = 0.8       -- speed of the next try

-- Places on the timed path at every stage.
local function places_of(timed, count, duration)
  local places, k = {}, 1
  for i = 0, count - 1 do
    local time = i * duration / (count - 1)
    while k < #timed.times - 1 and timed.times[k + 1] < time do k = k + 1 end
    local from, to = timed.times[k], timed.times[k + 1]
    local share = to > from and math.min(1, (time - from) / (to - from)) or 1
    local a, b = lapwing.vector(paths.point(timed.points, k)), paths.point(timed.points, k + 1)
    places[i + 1] = { time = time, value = a + share * (b - a) }
  end
  return places
end

-- How many stages a flight has; nil and why where they would be too many.
local function stages_of(o, duration)
  local step = o.step or math.max(STEP, duration / (MOST_STAGES - 1))
  local count = math.max(5, math.ceil(duration / step - 1e-9) + 1)
  if count <= MOST_STAGES and step <= LONGEST_STEP then return count end
  local needed = duration / (MOST_STAGES - 1)
  local text = string.format("%.4g s of flight are more than %d stages %.3g s apart", duration,
                             MOST_STAGES, math.min(step, LONGEST_STEP))
  if needed <= LONGEST_STEP then
    return nil, string.format("%s; leave step out, or set %.3g s or more", text,
                              math.ceil(1000 * needed) / 1000)
  end
  return nil, text .. "; draw smaller (height), less, or faster (speed, acceleration)"
end

-- Rad: of the view, turned about, between -pi and pi.
local function heading_of(o)
  if o.facing == "east" then return 0 end
  local yaw = math.rad(o.view_yaw_deg) + math.pi
  return math.atan(math.sin(yaw), math.cos(yaw))
end

local function solved(run, timed, vehicle)
  local o = run.options
  local duration = timed.times[#timed.times]
  local count, too_long = stages_of(o, duration)
  if not count then return nil, too_long end
  local places = places_of(timed, count, duration)
  local p = run:problem { vehicle = vehicle, duration = duration, step = duration / (count - 1),
                          environment = {} }
  p:add_cost { type = "keyframe", name = "drawing", weight = o.weights.drawing / count,
               keyframes = places }
  point_mass.add(p, vehicle, { model = o.model,
                               smoothness = { order = 4, weight = o.weights.smoothness },
                               yaw = { weight = 1 }, effort = o.weights.effort, inputs = {} })
  point_mass.must_rest(run, p, "model", "a light painting begins and ends at rest")
  local first, last = places[1].value, places[count].value
  local heading = heading_of(o)
  p:add_constraint { type = "boundary_state", start_yaw = heading, start_position = first,
                     finish_position = last }
  local times, positions, yaws = {}, {}, {}
  for i, place in ipairs(places) do
    times[i], positions[i], yaws[i] = place.time, place.value, heading
  end
  p:guess_path { times = times, positions = positions, yaws = yaws }
  p:finish()
  return run:solve(p, o.solver), nil, duration / (count - 1)
end

local function tolerance_of(o) return o.tolerance or 0.01 * o.height end

local function plan_of(run, strokes, lights, solution, figures, notes)
  local yaw = math.rad(run.options.view_yaw_deg)
  local task = { strokes = {}, drawing_view = { math.cos(yaw), math.sin(yaw), 0 },
                 drawing_tolerance = tolerance_of(run.options) }
  for i, stroke in ipairs(strokes) do task.strokes[i] = { points = paths.flat(stroke) } end
  return run:plan { solution = solution, task = task, lights = lights,
                    figures = figures, notes = notes, controller = run.options.controller }
end

-- What a user should know of a flight that is not as asked.
local function notes_of(best, o, undrawn)
  local notes = table.move(undrawn or {}, 1, undrawn and #undrawn or 0, 1, {})
  if not o.step and best.step > STEP + 1e-9 then
    notes[#notes + 1] = string.format("stages are %.3g s apart, not %.3g s: more than %d make a "
                                      .. "flight of %.4g s slow to solve (step)", best.step, STEP,
                                      MOST_STAGES, best.solution.duration)
  end
  if best.solution.status ~= "optimal" and best.solution.status ~= "feasible" then
    notes[#notes + 1] = "the solver ended " .. best.solution.status .. ": " .. best.solution.message
  end
  if not best.kept then
    notes[#notes + 1] = string.format(
      "no flight down to %.2g of the speed keeps all strokes within %.3g m; draw larger, allow "
      .. "more (tolerance), or raise weights.drawing", best.share,
      tolerance_of(o))
  end
  return notes
end

local function painted(run)
  local o = run.options
  local vehicle = run:vehicle(o.vehicle)
  run:expect_controller("controller")
  local drawn, unit, undrawn = drawings.read(run)
  drawn = drawings.without_repeats(drawn)
  if #drawn == 0 then
    lapwing.fail("the drawing has no line"
                 .. (undrawn and #undrawn > 0 and ": " .. table.concat(undrawn, "; ") or ""))
  end
  if o.reorder then drawn = order.short(drawn) end
  local strokes = drawings.placed(drawn, unit, o)
  local fastest = 0.95 * math.min(vehicle.speed_across, vehicle.climb_speed, vehicle.descent_speed)
  local strongest = 0.9 * vehicle.acceleration_across
  local share, best = 1, nil
  while true do
    run:phase(share == 1 and "painting" or string.format("painting at %.2g of the speed", share))
    local limits = {
      rounding = o.rounding, speed = share * math.min(o.speed, fastest),
      acceleration = share ^ 2 * math.min(o.acceleration, strongest),
    }
    local timed, lights
    if o.gap > 0 then timed, lights = drawing_times.with_gaps(run, strokes, limits, o.gap)
    else timed, lights = drawing_times.at_once(run, strokes, limits) end
    local solution, too_long, step = solved(run, timed, vehicle)
    if not solution and not best then run:fail(o.step and "step" or "speed", too_long) end
    if solution then
      local plan = plan_of(run, strokes, lights, solution)
      local flown = vehicle.flies and run:fly(plan) or {}
      local certificate = run:certify(plan)
      best = { lights = lights, solution = solution, share = share, flown = flown, step = step }
      best.kept = certificate.feasible
                  and (solution.status == "optimal" or solution.status == "feasible")
    end
    local slower = share * SLOWER
    if best.kept or not solution or slower < o.slowest or run:cancelled() then
      return plan_of(run, strokes, best.lights, best.solution, {
        mean_error = best.flown.mean_drawing_error, worst_error = best.flown.worst_drawing_error,
        strokes = #strokes, speed_share = best.share,
      }, notes_of(best, o, undrawn))
    end
    share = slower
  end
end

local function mission(given)
  if type(given) == "table" and type(given.origin) == "table" and given.origin[1] then
    lapwing.fail("origin: the place of a drawing is `base`; `origin` is that of the world on the "
                 .. "earth, { latitude_deg =, longitude_deg =, height =, height_of = }")
  end
  return mission_of("light_painting", DECLARATIONS, given, painted)
end

---@type fun(given: lapwing.light_painting.text): lapwing.mission
M.text = mission
---@type fun(given: lapwing.light_painting.picture): lapwing.mission
M.picture = mission
---@type fun(given: lapwing.light_painting.strokes): lapwing.mission
M.strokes = mission

return M
