-- SPDX-License-Identifier: Apache-2.0
-- Scans by a vehicle that cannot stand still, as surveyors fly them: straight and level passes over
-- the region with images at even distances, and turns beside it. A pass is parallel to an axis of
-- the region and above the safe height. Its camera has one direction. A search within the budget
-- selects the passes, their directions and their order. One trajectory problem then passes all
-- images at their times. The views of the plan are the poses of this trajectory at these times.
local passes = require "mission.scan_passes"
local point_mass = require "mission.point_mass"
local space = require "mission.scan_space"
local words = require "mission.scan_words"
local zones = require "mission.scan_zones"

local M = {}

local RESERVE = 1.05       -- times the stall speed in a turn, as the model `fixed_wing` keeps it
local WIDER, WIDEST = 1.12, 1.5   -- radii of turns that are tried
local STEP = 0.25          -- s, between stages
local MISS_WEIGHT, JERK = 1, 1e-3

-- Options that mean nothing to a flight in passing, with what is so.
local WITHOUT = {
  start = "the flight begins at its first pass", finish = "the flight ends at its last pass",
  ["flight.smooth"] = "the flight is one trajectory, without legs between rests",
  ["flight.pause"] = "the vehicle does not stop at a view", ["flight.speed"] = "set passing.speed",
  ["flight.view_speed"] = "set passing.speed", ["flight.stray"] = "set passing.miss",
  ["tour.begin"] = "a separate search orders the passes",
  ["exploration.images"] = "an exploration stops for its images",
}

-- What is wrong before anything is flown.
function M.check(run, vehicle, in_passing)
  local o = run.options
  if not in_passing then
    for key in pairs(o.passing) do
      if run:stated("passing." .. key) then
        run:fail("passing." .. key, string.format(
          "the model '%s' takes its images at rest: choose a model that cannot stand still, such "
          .. "as fixed_wing, or remove it", o.model.type))
      end
    end
    return
  end
  for name, why in pairs(WITHOUT) do
    if run:stated(name) then
      run:fail(name, string.format("the model '%s' takes images in passing, and %s: remove it",
                                   o.model.type, why))
    end
  end
  if o.tour.solver ~= "local_search" then
    run:fail("tour.solver", string.format("the model '%s' takes images in passing, and %s: "
                                          .. "remove it", o.model.type, WITHOUT["tour.begin"]))
  end
  if not vehicle.wing then
    run:fail("model", string.format(
      "'%s' takes images in passing, and the file of vehicle '%s' has no table 'wing', which "
      .. "limits its turns", o.model.type, vehicle.name))
  end
  if not vehicle.gimbal then
    run:fail("vehicle", string.format("'%s' has no gimbal, and images in passing need a "
                                      .. "camera that looks down or sideways", vehicle.name))
  end
  local bank, speed = passes.BANK_SHARE * vehicle.wing.bank, passes.speed(run, vehicle)
  local slowest = RESERVE * vehicle.wing.stall_speed / math.sqrt(math.cos(bank))
  if speed < slowest or speed > vehicle.speed_across then
    run:fail("passing.speed", string.format(
      "%.4g m/s: expected %.4g m/s, so that it does not stall in its turns, to %.4g m/s, the "
      .. "vehicle's largest", speed, slowest, vehicle.speed_across))
  end
  if passes.height(run) < space.safe_height(run) + o.body[3] then
    run:fail("passing.height", string.format(
      "%.4g m: passes fly above safe_height and the body, %.4g m", passes.height(run),
      space.safe_height(run) + o.body[3]))
  end
  if o.ceiling and passes.height(run) > o.ceiling then
    run:fail("passing.height", string.format("%.4g m is above the ceiling, %.4g m",
                                             passes.height(run), o.ceiling))
  end
  passes.want_range(run)
end

M.air = passes.air

-- One trajectory past all images of a tour.
local function solved(run, vehicle, air, tour)
  local o, flight = run.options, tour.flight
  local steps = math.ceil(flight.duration / STEP)
  local p = run:problem { vehicle = vehicle, duration = flight.duration,
                          step = flight.duration / steps, environment = {} }
  local places = {}
  for i, image in ipairs(flight.images) do
    places[i] = { time = image.time, value = image.position }
  end
  p:add_cost { type = "keyframe", name = "images", weight = MISS_WEIGHT, keyframes = places }
  point_mass.add(p, vehicle, { model = o.model,
                               smoothness = { name = "jerk", order = 3, weight = JERK },
                               yaw = { weight = 0.02 }, inputs = { across = "extent" } })
  p:add_constraint { type = "hard_keyframe", name = "images", tolerance = o.passing.miss,
                     keyframes = places }
  if p:has_block("lateral_acceleration") then
    local level = {}
    for i, place in ipairs(places) do level[i] = { time = place.time, value = { 0 } } end
    p:add_constraint { type = "hard_keyframe", name = "level", block = "lateral_acceleration",
                       tolerance = point_mass.GRAVITY * math.tan(math.rad(o.passing.bank_deg)),
                       keyframes = level }
  end
  local size = {}
  for axis = 1, 3 do size[axis] = air.upper[axis] - air.lower[axis] end
  p:add_constraint { type = "corridor", regions = {
    { start = 0, finish = flight.duration, lower = air.lower, size = size } } }
  p:add_constraint { type = "boundary_state", start = "free", finish = "free" }
  p:guess_path { times = flight.times, positions = flight.positions, yaws = flight.yaws }
  p:finish()
  return run:solve(p, o.solver)
end

-- A tour and its solution: with wider turns where the vehicle cannot fly the tightest.
local function flown(run, vehicle, graph, air, budget, begin)
  local wider, failed = 1, nil
  while true do
    begin("tour")
    local radius = wider * passes.radius(run, vehicle)
    local tour = run:pass_tour {
      graph = graph, budget = budget, speed = passes.speed(run, vehicle), radius = radius,
      lead = passes.LEAD * passes.speed(run, vehicle), images = run.options.tour.images,
      iterations = run.options.passing.iterations }
    if tour.images < 1 then
      run:fail("tour", failed or string.format(
        "no flight of %.4g s: %s; %d images lie within the budget", budget, tour.message,
        tour.reachable))
    end
    begin("trajectory")
    local solution = solved(run, vehicle, air, tour)
    if solution.status == "optimal" or solution.status == "feasible" or run:cancelled() then
      return tour, solution
    end
    failed = string.format("no trajectory past the images of %.4g s with turns of %.4g m: %s "
                           .. "ended %s: %s", tour.seconds, radius, solution.solver,
                           solution.status, solution.message)
    wider = WIDER * wider
    if wider > WIDEST then run:fail("tour", failed) end
    print("note: " .. failed .. "; turns are made wider")
  end
end

-- The passes of the budget (s) as a plan; `begin(phase)` reports the phase.
function M.plan(run, vehicle, known, budget, begin)
  local o = run.options
  local air = passes.air(run, vehicle)
  begin("views")
  local list, spacing = passes.of(run, vehicle)
  local graph = run:pass_graph {
    prior = known, vehicle = vehicle, information = o.information, region = space.region_of(run),
    allowed = air, passes = list, rules = zones.rules(run), body = zones.body(run),
    mesh_room = o.mesh_room, camera = o.camera, across = o.effort.pixels, range = space.range(run),
    usable_range = o.usable.range, usable_incidence_deg = o.usable.incidence_deg }
  local tour, solution = flown(run, vehicle, graph, air, budget, begin)
  local notes = words.notes(run, known, nil, string.format(
    "%d passes %.3g m apart at %.4g m/s, %.4g m high", #list, spacing, passes.speed(run, vehicle),
    passes.height(run)))
  local little = words.little_used(run, tour, budget)
  notes[#notes + 1] = little
  if little then print("warning: " .. little) end
  begin("flight")
  return run:scan_plan {
    tour = tour, flight = solution, margin = zones.margin(run), budget = budget,
    closed_loop_required = o.closed_loop == "required", notes = notes,
    figures = words.figures(graph, tour, budget, tour.evaluations, nil) }
end

return M
